/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/delaunay/insert.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "base/tri_key.h"
#include "core/delaunay/cell_signs.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"

enum {
  CUT_MAX = 16, /* K5: number of times that a cavity may be cut back */
  GROW_MAX = 3  /* K57: in metrics, number of times that it first grows through
                   hidden faces */
};

vg_status vg_inserter_init(struct vg_inserter *s, struct vg_tets *t,
                           struct vg_error *err)
{
  assert(s && t);
  memset(s, 0, sizeof *s);
  s->t = t;
  s->last = VG_NONE;
  s->cap_local = t->cap_point;
  s->local = vg_calloc(s->cap_local, sizeof *s->local);
  return s->local ? VG_OK : vg_fail_memory(err, "the cavity table");
}

void vg_inserter_release(struct vg_inserter *s)
{
  free(s->cell);
  free(s->tried);
  free(s->face);
  free(s->local);
  memset(s, 0, sizeof *s);
}

/* --- the cavity ----------------------------------------------------------- */

/* Reserve space for the entries that one cell of the cavity can add to the
 * lists. */
static int make_room(struct vg_inserter *s)
{
  return (s->n_cell + 4 > s->cap_cell &&
          vg_reserve(&s->cell, &s->cap_cell, s->n_cell + 4, sizeof *s->cell)) ||
         (s->n_tried + 4 > s->cap_tried &&
          vg_reserve(&s->tried, &s->cap_tried, s->n_tried + 4,
                     sizeof *s->tried)) ||
         (s->n_face + 4 > s->cap_face &&
          vg_reserve(&s->face, &s->cap_face, s->n_face + 4, sizeof *s->face));
}

static int add_tried(struct vg_inserter *s, uint32_t c)
{
  if (vg_reserve(&s->tried, &s->cap_tried, s->n_tried + 1, sizeof *s->tried))
    return -1;
  s->t->flag[c] |= VG_TRIED;
  s->tried[s->n_tried++] = c;
  return 0;
}

/* Add face i of a cell of the cavity, with the flags and signs of the cell. */
VG_WITHIN void add_face(struct vg_inserter *s, const struct vg_cell *cell,
                        int i, uint8_t flag, unsigned signs)
{
  struct vg_cavity_face *f = &s->face[s->n_face++];

  assert(s->n_face <= s->cap_face);
  for (int k = 0; k < 3; k++) f->v[k] = cell->v[vg_face[i][k]];
  f->link = cell->link[i];
  f->fixed = flag >> i & 1;
  f->hidden = !(signs & VG_SIDE_IN << i);
  f->outside = flag & VG_OUTSIDE;
}

static void clear_marks(struct vg_inserter *s)
{
  for (size_t k = 0; k < s->n_cell; k++)
    s->t->flag[s->cell[k].at] &= (uint8_t)~VG_MARK;
  for (size_t k = 0; k < s->n_tried; k++)
    s->t->flag[s->tried[k]] &= (uint8_t)~VG_TRIED;
  s->n_cell = s->n_tried = s->n_face = 0;
}

/* Remove the faces from `first` on that turned out to be inside the cavity. */
static void drop_faces(struct vg_inserter *s, size_t first)
{
  size_t n = first;

  for (size_t k = first; k < s->n_face; k++) {
    struct vg_cavity_face f = s->face[k];

    if (f.fixed || f.link == VG_NONE || !(s->t->flag[f.link >> 2] & VG_MARK))
      s->face[n++] = f;
  }
  s->n_face = n;
}

/* Four lanes are passed by address: without AVX, they fit no register. */
VG_WITHIN double sum4(const vg_d4 *a)
{
  return ((*a)[0] + (*a)[2]) + ((*a)[1] + (*a)[3]);
}

/* An upper bound of the magnitudes of a. */
VG_WITHIN double bound4(const vg_d4 *a)
{
  const vg_l4 all = { INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX };
  const vg_d4 magnitude = (vg_d4)((vg_l4)*a & all);

  return sum4(&magnitude);
}

/* As vg_cell_signs, with the sphere in a metric M: the determinant is the sum
 * of the orientations of the point and the faces, each multiplied by a squared
 * distance in M. The operations, and so the result, are the same with and
 * without AVX2. */
VG_WITHIN unsigned metric_signs(const struct vg_inserter *s,
                                const uint32_t v[4], const double p[3])
{
  const double(*x)[3] = (const double(*)[3])s->t->x;
  const double *a = x[v[0]], *b = x[v[1]], *c = x[v[2]], *d = x[v[3]];
  const unsigned all = 0xf * VG_SIDE_SEES;
  vg_d4 px = (vg_d4){ a[0], b[0], c[0], d[0] } - p[0];
  vg_d4 py = (vg_d4){ a[1], b[1], c[1], d[1] } - p[1];
  vg_d4 pz = (vg_d4){ a[2], b[2], c[2], d[2] } - p[2];
  /* As in vg_cell_view. */
  vg_d4 next = px * VG_TURN4(py, 1, 2, 3, 0) - VG_TURN4(px, 1, 2, 3, 0) * py;
  vg_d4 far = px * VG_TURN4(py, 2, 3, 0, 1) - VG_TURN4(px, 2, 3, 0, 1) * py;
  vg_d4 o = (VG_TURN4(pz, 3, 0, 1, 2) * VG_TURN4(next, 1, 2, 3, 0) -
             VG_TURN4(pz, 2, 3, 0, 1) * VG_TURN4(far, 1, 2, 3, 0) +
             VG_TURN4(pz, 1, 2, 3, 0) * VG_TURN4(next, 2, 3, 0, 1)) *
            (vg_d4){ 1, -1, 1, -1 },
        term;
  double flat = 5.4e-15 * bound4(&px) * bound4(&py) * bound4(&pz), m[6], det;
  unsigned in = 0, out = 0, signs;

  for (int k = 0; k < 6; k++) /* K46 */
    m[k] = 3 * s->metric[s->point].m[k] + s->metric[v[0]].m[k] +
           s->metric[v[1]].m[k] + s->metric[v[2]].m[k] + s->metric[v[3]].m[k];
  term = o * (px * (m[0] * px + 2 * (m[1] * py + m[2] * pz)) +
              py * (m[3] * py + 2 * m[4] * pz) + m[5] * pz * pz);
  det = sum4(&term);
  for (int i = 0; i < 4; i++) {
    in |= (unsigned)(o[i] > flat) << i;
    out |= (unsigned)(o[i] < -flat) << i;
  }
  if (!(det > 0) && out) return 0;
  signs = in == 0xf ? in * (VG_SIDE_IN | VG_SIDE_SEES)
                    : vg_cell_sides(x, v, p, in, out);
  /* A cell that contains the point is in the cavity whatever rounding makes of
   * the determinant. */
  return det > 0 || (signs & all) == all ? VG_IN_SPHERE | signs : 0;
}

/* Signs of a cell that is in the cavity if it contains the point. */
static unsigned signs_within(const struct vg_inserter *s, const uint32_t v[4],
                             const double p[3])
{
  const unsigned all = 0xf * VG_SIDE_SEES;
  unsigned signs = vg_cell_sides((const double(*)[3])s->t->x, v, p, 0, 0);

  return (signs & all) == all ? VG_IN_SPHERE | signs : 0;
}

/* Signs of the point and a cell (core/delaunay/cell_signs.h). */
VG_WITHIN unsigned signs_of(const struct vg_inserter *s, const uint32_t v[4],
                            const double p[3], int is_wide)
{
  const double(*x)[3] = (const double(*)[3])s->t->x;
  const vg_d2 both[3] = { { p[0], p[0] }, { p[1], p[1] }, { p[2], p[2] } };

  if (s->is_least) return signs_within(s, v, p);
  if (s->metric) return metric_signs(s, v, p);
#ifdef VG_WIDE
  if (is_wide) return vg_cell_signs_wide(x, v, p);
#endif
  (void)is_wide;
  return vg_cell_signs(x, v, both);
}

/* Find all cells that can be reached from those in the list, and the faces
 * around them. Cells that were marked TRIED before stay out. The search only
 * crosses faces that the point sees: among Delaunay cells this reaches every
 * cell of the cavity. Where recovery has left slivers with huge circumspheres,
 * it prevents the search from running through all of them. */
VG_WITHIN int flood_with(struct vg_inserter *s, const double p[3], int is_wide)
{
  const struct vg_cell *cells = s->t->cell;
  uint8_t *flag = s->t->flag;
  size_t late = SIZE_MAX; /* first face that may still turn out to be inside */

  for (size_t k = 0; k < s->n_cell; k++) {
    struct vg_cavity_cell c = s->cell[k];
    const struct vg_cell *cell = &cells[c.at];
    uint8_t own = flag[c.at];

    assert(own & VG_MARK && !(own & VG_DEAD));
    if (make_room(s)) return -1;
    for (int i = 0; i < 4; i++) {
      uint32_t link = cell->link[i], other = link >> 2;

      if (link != VG_NONE && !(own >> i & 1) && !(flag[other] & VG_TRIED)) {
        if (flag[other] & VG_MARK) continue;
        if (c.signs & VG_SIDE_SEES << i) {
          unsigned signs = signs_of(s, cells[other].v, p, is_wide);

          flag[other] |= signs & VG_IN_SPHERE ? VG_MARK : VG_TRIED;
          if (signs & VG_IN_SPHERE) {
            s->cell[s->n_cell++] = (struct vg_cavity_cell){ other, signs };
            vg_tets_prefetch(s->t, other);
            continue;
          }
          s->tried[s->n_tried++] = other;
        } else if (s->n_face < late) {
          late = s->n_face;
        }
      }
      add_face(s, cell, i, own, c.signs);
    }
  }
  if (late < s->n_face) drop_faces(s, late);
  return 0;
}

#ifdef VG_WIDE
static VG_WIDE int flood_wide(struct vg_inserter *s, const double p[3])
{
  return flood_with(s, p, 1);
}
#endif

/* Four lanes at once if the processor supports AVX2. The signs are exact, and
 * so the same. */
static int flood(struct vg_inserter *s, const double p[3])
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) return flood_wide(s, p);
#endif
  return flood_with(s, p, 0);
}

static int start_flood(struct vg_inserter *s, uint32_t seed, const double p[3])
{
  const uint32_t *v = s->t->cell[seed].v;
  unsigned signs = signs_of(s, v, p, 0);

  if (!(signs & VG_IN_SPHERE))
    signs = vg_cell_sides((const double(*)[3])s->t->x, v, p, 0, 0);
  if (make_room(s)) return -1;
  s->t->flag[seed] |= VG_MARK;
  vg_tets_prefetch(s->t, seed);
  s->cell[s->n_cell++] = (struct vg_cavity_cell){ seed, signs };
  return flood(s, p);
}

/* The cavity cell in front of face f. */
static uint32_t cell_before(const struct vg_inserter *s, size_t f)
{
  const struct vg_cavity_face *face = &s->face[f];

  if (face->link != VG_NONE)
    return s->t->cell[face->link >> 2].link[face->link & 3] >> 2;
  for (size_t k = 0; k < s->n_cell; k++) {
    const struct vg_cell *c = &s->t->cell[s->cell[k].at];

    for (int i = 0; i < 4; i++)
      if (c->link[i] == VG_NONE && c->v[vg_face[i][0]] == face->v[0] &&
          c->v[vg_face[i][1]] == face->v[1] &&
          c->v[vg_face[i][2]] == face->v[2])
        return s->cell[k].at;
  }
  return VG_NONE;
}

/* Exclude the cells in front of all hidden faces, and flood again from the
 * seed. Returns 0: done; 1: a face of the seed itself is hidden; 2: no face is
 * hidden. */
static int cut_back(struct vg_inserter *s, const double p[3])
{
  uint32_t seed = s->cell[0].at;
  size_t n_tried = s->n_tried;

  for (size_t f = 0; f < s->n_face; f++) {
    uint32_t out;

    if (!s->face[f].hidden) continue;
    out = cell_before(s, f);
    if (out == seed || out == VG_NONE) return 1;
    if (!(s->t->flag[out] & VG_TRIED) && add_tried(s, out)) return -1;
  }
  if (s->n_tried == n_tried) return 2;
  for (size_t k = 0; k < s->n_cell; k++)
    s->t->flag[s->cell[k].at] &= (uint8_t)~VG_MARK;
  s->n_cell = s->n_face = 0;
  return start_flood(s, seed, p);
}

/* Add the cells behind hidden faces, and all that are reached from them. The
 * point sees the cell in front of such a face only through the cell behind it:
 *
 *         a
 *      -------
 *         b
 *         p
 *
 * Cell a is in the cavity, and cell b is not. Among Delaunay cells, the sphere
 * of b would contain p, too.
 *
 * Returns 0: done; 1: no cell was added. */
static int grow(struct vg_inserter *s, const double p[3])
{
  uint8_t *flag = s->t->flag;
  size_t n = s->n_cell;

  for (size_t f = 0; f < s->n_face; f++) {
    const struct vg_cavity_face *face = &s->face[f];
    uint32_t out = face->link >> 2;

    if (!face->hidden || face->fixed || face->link == VG_NONE ||
        flag[out] & VG_MARK)
      continue;
    if (make_room(s)) return -1;
    flag[out] = (uint8_t)((flag[out] & ~VG_TRIED) | VG_MARK);
    s->cell[s->n_cell++] = (struct vg_cavity_cell){
      out,
      vg_cell_sides((const double(*)[3])s->t->x, s->t->cell[out].v, p, 0, 0)
    };
  }
  if (s->n_cell == n) return 1;
  s->n_face = 0;
  return flood(s, p);
}

static int grow_local(struct vg_inserter *s)
{
  size_t old = s->cap_local;

  if (s->t->n_point <= old) return 0;
  if (vg_reserve(&s->local, &s->cap_local, s->t->n_point, sizeof *s->local))
    return -1;
  memset(s->local + old, 0, (s->cap_local - old) * sizeof *s->local);
  return 0;
}

/* Number the vertices of the cavity in the order of their appearance. n_vertex
 * stays 0 if there are too many for the table. */
static void number_vertices(struct vg_inserter *s)
{
  uint32_t n = 0;

  s->n_vertex = 0;
  for (size_t k = 0; k < s->n_face; k++) {
    struct vg_cavity_face *f = &s->face[k];

    for (int i = 0; i < 3; i++) {
      uint32_t v = f->v[i], at = s->local[v];

      if (at >= n || s->vertex[at] != v) {
        if (n == VG_CAVITY_TABLE) return;
        at = s->local[v] = n;
        s->vertex[n++] = v;
      }
      f->at[i] = (uint8_t)at;
    }
  }
  s->n_vertex = n;
}

/* --- acceptance of the point ---------------------------------------------- */

/* Is the height of x over the face below the clearance? Compares squares. The
 * clearance is relative to the root mean square of the edges, or to `most` (0:
 * no limit) if that is shorter, as it is above a needle. */
static int too_low(const double a[3], const double b[3], const double c[3],
                   const double x[3], double clearance, double most)
{
  double u[3], v[3], w[3], n[3], dot, n2, e2;

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_sub(x, a, w);
  vg_cross(u, v, n);
  dot = vg_dot(n, w);
  n2 = vg_dot(n, n);
  e2 = (vg_distance2(a, b) + vg_distance2(b, c) + vg_distance2(c, a)) / 3;
  if (most > 0 && e2 > most * most) e2 = most * most;
  return dot * dot < clearance * clearance * e2 * n2;
}

/* The same in a metric with the given inverse, in which the normal n has the
 * squared length n' M^(-1) n, up to a factor that the height has, too. */
static int too_low_in(const double m[6], const double inverse[6],
                      const double a[3], const double b[3], const double c[3],
                      const double x[3], double clearance, double most)
{
  double u[3], v[3], w[3], n[3], dot, e2;

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_sub(x, a, w);
  vg_cross(u, v, n);
  dot = vg_dot(n, w);
  e2 = vg_tensor_form(m, u) + vg_tensor_form(m, v);
  vg_sub(u, v, w);
  e2 = (e2 + vg_tensor_form(m, w)) / 3;
  if (most > 0 && e2 > most * most) e2 = most * most;
  return dot * dot < clearance * clearance * e2 * vg_tensor_form(inverse, n);
}

/* Squared distance of point v from x. */
static double apart2(const struct vg_inserter *s, uint32_t v, const double x[3])
{
  double d[3];

  if (!s->metric) return vg_distance2(s->t->x[v], x);
  vg_sub(s->t->x[v], x, d);
  return vg_tensor_form(s->metric[s->point].m, d);
}

static int too_near(const struct vg_inserter *s, const double x[3],
                    double nearest)
{
  double least = nearest * nearest;

  for (uint32_t i = 0; i < s->n_vertex; i++)
    if (apart2(s, s->vertex[i], x) < least) return 1;
  for (size_t k = 0; k < s->n_face && !s->n_vertex; k++)
    for (int i = 0; i < 3; i++)
      if (apart2(s, s->face[k].v[i], x) < least) return 1;
  return 0;
}

static int too_low_anywhere(const struct vg_inserter *s, const double x[3],
                            double clearance, double most)
{
  const double(*at)[3] = (const double(*)[3])s->t->x;
  const double *m = s->metric ? s->metric[s->point].m : NULL;
  double inverse[6] = { 0 }; /* of m; zeros without a metric */

  if (m) vg_tensor_invert(m, inverse);
  for (size_t k = 0; k < s->n_face && clearance > 0; k++) {
    const uint32_t *v = s->face[k].v;

    if (!s->face[k].fixed) continue;
    if (m ? too_low_in(m, inverse, at[v[0]], at[v[1]], at[v[2]], x, clearance,
                       most)
          : too_low(at[v[0]], at[v[1]], at[v[2]], x, clearance, most))
      return 1;
  }
  return 0;
}

static int is_on_hull(const struct vg_inserter *s, uint32_t v)
{
  if (s->n_vertex) {
    uint32_t at = s->local[v];

    return at < s->n_vertex && s->vertex[at] == v;
  }
  for (size_t k = 0; k < s->n_face; k++)
    for (int i = 0; i < 3; i++)
      if (s->face[k].v[i] == v) return 1;
  return 0;
}

/* Are all cells of a vertex in the cavity, so that it would lose them? This
 * cannot happen among Delaunay cells, but among cells made in metrics. */
static int swallows(const struct vg_inserter *s)
{
  for (size_t k = 0; k < s->n_cell; k++)
    for (int i = 0; i < 4; i++)
      if (!is_on_hull(s, s->t->cell[s->cell[k].at].v[i])) return 1;
  return 0;
}

/* --- refilling ------------------------------------------------------------ */

/* Make a cell in front of each face of the cavity. The link of the face
 * becomes the number of that cell instead of the cell behind the face. */
static void make_cells(struct vg_inserter *s, uint32_t p)
{
  struct vg_tets *t = s->t;
  size_t used = 0;

  for (size_t k = 0; k < s->n_face; k++) {
    struct vg_cavity_face *f = &s->face[k];
    uint32_t c = used < s->n_cell ? s->cell[used++].at : vg_tets_alloc_cell(t);
    struct vg_cell *cell = &t->cell[c];

    cell->v[0] = f->v[0];
    cell->v[1] = f->v[1];
    cell->v[2] = f->v[2];
    cell->v[3] = p;
    assert(f->v[0] != p && f->v[1] != p && f->v[2] != p && !f->hidden);
    t->flag[c] = (uint8_t)(f->outside | f->fixed << 3);
    cell->link[3] = f->link;
    if (f->link != VG_NONE) t->cell[f->link >> 2].link[f->link & 3] = 4 * c + 3;
    f->link = c;
    s->last = c;
    if (s->star)
      for (int i = 0; i < 4; i++) s->star[cell->v[i]] = c;
  }
  /* A star-shaped cavity with n vertices has 2n - 4 faces and at least n - 3
   * cells. There can be fewer faces than cells only around flat cells. */
  while (used < s->n_cell) vg_tets_free_cell(t, s->cell[used++].at);
}

/* Each edge of the cavity's hull has two faces, which run along it in opposite
 * directions. */
static void link_by_table(struct vg_inserter *s)
{
  for (size_t k = 0; k < s->n_face; k++) {
    const struct vg_cavity_face *f = &s->face[k];

    for (uint32_t i = 0; i < 3; i++)
      s->table[f->at[(i + 1) % 3]][f->at[(i + 2) % 3]] = 4 * f->link + i;
  }
  for (size_t k = 0; k < s->n_face; k++) {
    const struct vg_cavity_face *f = &s->face[k];
    uint32_t *link = s->t->cell[f->link].link;

    for (int i = 0; i < 3; i++)
      link[i] = s->table[f->at[(i + 2) % 3]][f->at[(i + 1) % 3]];
  }
}

/* Key of the edge opposite corner half % 3 of face half / 3 of the cavity. */
static uint64_t hull_edge(const struct vg_inserter *s, uint32_t half)
{
  const uint32_t *v = s->face[half / 3].v;

  return vg_edge_key(v[(half + 1) % 3], v[(half + 2) % 3]);
}

/* Link to the face of a new cell at that edge. */
static uint32_t hull_link(const struct vg_inserter *s, uint32_t half)
{
  return 4 * s->face[half / 3].link + half % 3;
}

/* Link the new cells of a cavity with many vertices. edge: an empty table with
 * enough space for the edges. */
static void link_by_edges(struct vg_inserter *s, const struct vg_table *edge)
{
  for (uint32_t half = 0; half < 3 * s->n_face; half++) {
    uint64_t key = hull_edge(s, half);
    uint32_t *at;

    VG_TABLE_FIND(edge, at, vg_hash_1(key), hull_edge(s, *at) == key);
    if (*at == VG_TABLE_FREE) *at = half;
    else vg_tets_connect(s->t, hull_link(s, *at), hull_link(s, half));
  }
}

vg_status vg_insert(struct vg_inserter *s, uint32_t p, uint32_t at,
                    double clearance, double nearest, struct vg_error *err)
{
  assert(p < s->t->cap_point && at < s->t->n_cell);
  assert(!(s->t->flag[at] & VG_DEAD));
  assert(clearance >= 0 && nearest >= 0);

  struct vg_tets *t = s->t;
  double x[3];
  struct vg_table edge = VG_TABLE_INIT;
  int state;

  memcpy(x, t->x[p], sizeof x);
  s->point = p;
  state = start_flood(s, at, x);
  if (!state && grow_local(s)) state = -1;
  if (!state) number_vertices(s);
  if (!state && nearest > 0) state = too_near(s, x, nearest);
  for (int cut = 0; !state; cut++) {
    if (cut) number_vertices(s);
    state = s->metric && cut < GROW_MAX ? grow(s, x) : 1;
    if (state > 0) state = cut == CUT_MAX ? 1 : cut_back(s, x);
  }
  if (state == 2) state = too_low_anywhere(s, x, clearance, 2 * nearest);
  if (!state && s->metric) state = swallows(s);
  if (!state && ((!s->n_vertex && vg_table_init(&edge, 2 * s->n_face)) ||
                 vg_tets_reserve_cells(t, s->n_face) ||
                 vg_reserve(&t->free, &t->cap_free, t->n_free + s->n_cell,
                            sizeof *t->free)))
    state = -1;
  if (state) {
    vg_table_release(&edge);
    clear_marks(s);
    return state > 0 ? VG_BLOCKED
                     : vg_fail_memory(err, "the cells of the volume mesh");
  }
  make_cells(s, p);
  if (s->n_vertex) {
    link_by_table(s);
  } else {
    link_by_edges(s, &edge);
    vg_table_release(&edge);
  }
  for (size_t k = 0; k < s->n_tried; k++)
    t->flag[s->tried[k]] &= (uint8_t)~VG_TRIED;
  s->n_cell = s->n_tried = s->n_face = 0;
  return VG_OK;
}
