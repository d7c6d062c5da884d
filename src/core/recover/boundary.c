/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/recover/boundary.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "core/geometry/predicates.h"
#include "core/recover/boundary_parts.h"
#include "core/recover/cdt_tetgen.h"
#include "core/recover/recover.h"

/* --- surface triangles among the cell faces ------------------------------- */

/* Of two opposite triangles with the same corners, which are the sides of a
 * sheet in the fluid, only the first one is in the table. */
struct tri_table {
  struct vg_table table;
  const uint32_t (*tri)[3];
  uint32_t *twin; /* [number of triangles] the opposite triangle of one in the
                     table, or VG_NONE; NULL: no twins */
  size_t n_twin;
};

/* The hash does not depend on the order of the corners, so that a search need
 * not sort them. */
static uint64_t hash3(const uint32_t v[3])
{
  uint64_t a = v[0], b = v[1], c = v[2];

  return vg_hash_1((a + b + c) * VG_GOLDEN ^ (a * b + b * c + c * a));
}

/* 1: same orientation, -1: opposite orientation, 0: different points. */
static int same_triangle(const uint32_t a[3], const uint32_t b[3])
{
  for (int k = 0; k < 3; k++) {
    if (a[k] != b[0]) continue;
    if (a[(k + 1) % 3] == b[1] && a[(k + 2) % 3] == b[2]) return 1;
    if (a[(k + 1) % 3] == b[2] && a[(k + 2) % 3] == b[1]) return -1;
  }
  return 0;
}

static int add_twin(struct tri_table *t, size_t n, uint32_t i, uint32_t twin)
{
  if (!t->twin) {
    t->twin = vg_alloc(n, sizeof *t->twin);
    if (!t->twin) return -1;
    memset(t->twin, 0xff, n * sizeof *t->twin);
  }
  t->twin[i] = twin;
  t->n_twin++;
  return 0;
}

static vg_status tri_table_init(struct tri_table *t, size_t n,
                                const uint32_t (*tri)[3], struct vg_error *err)
{
  t->tri = tri;
  t->twin = NULL;
  t->n_twin = 0;
  if (vg_table_init(&t->table, n))
    return vg_fail_memory(err, "the surface table");
  for (uint32_t i = 0; i < n; i++) {
    uint32_t *at;

    VG_TABLE_FIND(&t->table, at, hash3(tri[i]),
                  same_triangle(tri[i], tri[*at]) < 0);
    if (*at == VG_TABLE_FREE) *at = i;
    else if (add_twin(t, n, *at, i))
      return vg_fail_memory(err, "the surface table");
  }
  return VG_OK;
}

static void tri_table_release(struct tri_table *t)
{
  vg_table_release(&t->table);
  free(t->twin);
}

static int has_twin(const struct tri_table *t, uint32_t i)
{
  return t->twin && t->twin[i] != VG_NONE;
}

static uint32_t tri_table_find(const struct tri_table *t, const uint32_t v[3],
                               int *sense)
{
  uint32_t *at;

  VG_TABLE_FIND(&t->table, at, hash3(v),
                (*sense = same_triangle(v, t->tri[*at])));
  return *at;
}

vg_status vg_boundary_fix(struct vg_tets *t, size_t n_tri,
                          const uint32_t (*tri)[3], uint8_t *missing,
                          size_t *n_missing, struct vg_error *err)
{
  assert(n_missing && (tri || !n_tri));

  struct tri_table table;
  uint8_t *found = vg_calloc(n_tri, 1);
  vg_status st = tri_table_init(&table, n_tri, tri, err);

  *n_missing = n_tri - table.n_twin;
  if (!found && st == VG_OK) st = vg_fail_memory(err, "the surface table");
  for (uint32_t c = 0; st == VG_OK && c < t->n_cell; c++) {
    if (t->flag[c] & VG_DEAD) continue;
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t link = t->cell[c].link[i], v[3], at;
      int sense;

      if (link < 4 * c + i) continue; /* handled from the other cell */
      for (int k = 0; k < 3; k++) v[k] = t->cell[c].v[vg_face[i][k]];
      at = tri_table_find(&table, v, &sense);
      if (at == VG_NONE) continue;
      t->flag[c] |= (uint8_t)(1 << i);
      if (link != VG_NONE) t->flag[link >> 2] |= (uint8_t)(1 << (link & 3));
      *n_missing -= !found[at];
      found[at] = 1;
    }
  }
  for (uint32_t i = 0; table.n_twin && st == VG_OK && i < n_tri; i++)
    if (has_twin(&table, i)) found[table.twin[i]] = 1;
  for (size_t i = 0; missing && st == VG_OK && i < n_tri; i++)
    missing[i] = !found[i];
  free(found);
  tri_table_release(&table);
  return st;
}

/* --- fluid and solid side ------------------------------------------------- */

enum { SIDE_UNKNOWN, SIDE_FLUID, SIDE_SOLID };

struct sides {
  struct vg_tets *t;
  const struct vg_region_cache *cache; /* NULL: no restriction */
  double band;                         /* sides are determined within this
                                          band of the region */
  int is_strict;                       /* 1: a contradiction is an error */
  uint32_t corner;                     /* first corner of the box */
  int is_local;    /* 1: do not spread over cells with a corner of the box */
  uint8_t *side;   /* [n_cell] */
  uint8_t *front;  /* [n_cell] bit i: face i is a surface triangle that faces
                      the cell; bit 4 + i: a triangle that faces away */
  uint8_t *near;   /* [n_cell] cached result of matters(). Bit i: face i is
                      in the band; bit 4 + i: it is not */
  uint32_t *queue; /* [n_cell] cells with a known side, in the order in which
                      it became known */
  size_t n_queue, next;
};

/* Is face i of cell c within the band where sides are determined? The result
 * is cached for both cells of the face. */
static int matters(const struct sides *s, uint32_t c, int i)
{
  const uint32_t *v = s->t->cell[c].v;
  const uint8_t *f = vg_face[i];
  uint32_t tri[3] = { v[f[0]], v[f[1]], v[f[2]] }, link = s->t->cell[c].link[i];
  int known = s->cache ? s->near[c] >> i & 0x11 : 1;

  if (known) return known & 1;
  known = vg_region_cache_meets(s->cache, tri, s->band) ? 1 : 0x10;
  s->near[c] |= (uint8_t)(known << i);
  if (link != VG_NONE) s->near[link >> 2] |= (uint8_t)(known << (link & 3));
  return known & 1;
}

/* Set another band. Cached results are discarded, except for the bits in keep.
 */
static void set_band(struct sides *s, double band, uint8_t keep)
{
  s->band = band;
  for (size_t c = 0; c < s->t->n_cell && s->cache; c++) s->near[c] &= keep;
}

static void set_side(struct sides *s, uint32_t c, uint8_t is)
{
  s->side[c] = is;
  s->queue[s->n_queue++] = c;
}

static void find_front(struct sides *s, const struct tri_table *table)
{
  const struct vg_tets *t = s->t;

  for (uint32_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; t->flag[c] & VG_FIXED_FACES && i < 4; i++) {
      uint32_t link = t->cell[c].link[i], v[3], at;
      int sense = 0;

      if (!(t->flag[c] >> i & 1) || link < 4 * c + i) continue;
      for (int k = 0; k < 3; k++) v[k] = t->cell[c].v[vg_face[i][k]];
      at = tri_table_find(table, v, &sense);
      if (at == VG_NONE) continue;
      if (has_twin(table, at)) sense = 0;
      s->front[c] |= (uint8_t)((sense >= 0 ? 1 : 0x10) << i);
      if (link != VG_NONE)
        s->front[link >> 2] |= (uint8_t)((sense > 0 ? 0x10 : 1) << (link & 3));
    }
}

/* Seeds: the cells on both sides of every surface triangle. */
static vg_status seed_sides(struct sides *s, struct vg_error *err)
{
  const struct vg_tets *t = s->t;

  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; s->front[c] && i < 4; i++) {
      const double *x = t->x[t->cell[c].v[vg_face[i][0]]];
      uint8_t is = s->front[c] >> i & 1 ? SIDE_FLUID : SIDE_SOLID;

      if (!(s->front[c] >> i & 0x11) || (s->side[c] && !s->is_strict) ||
          !matters(s, c, i))
        continue;
      if (s->side[c] == SIDE_UNKNOWN) set_side(s, c, is);
      else if (s->side[c] != is && s->is_strict)
        return vg_fail(err, VG_ERR_GEOMETRY,
                       "the surface turns inside out at point %u "
                       "(%g %g %g); run 'vanguard check' on it",
                       t->cell[c].v[vg_face[i][0]] + 1, x[0], x[1], x[2]);
    }
  return VG_OK;
}

/* Does cell c have a corner of the box around all points? */
static int is_around(const struct sides *s, uint32_t c)
{
  const uint32_t *v = s->t->cell[c].v;

  for (int i = 0; i < 4; i++)
    if (v[i] - s->corner < 8) return 1;
  return 0;
}

static vg_status spread_over(struct sides *s, uint32_t c, int i,
                             struct vg_error *err)
{
  struct vg_tets *t = s->t;
  uint32_t link = t->cell[c].link[i], other = link >> 2;
  const double *x = t->x[t->cell[c].v[0]];
  uint8_t is = link == VG_NONE ? SIDE_SOLID : s->side[other];

  if (t->flag[c] >> i & 1 || is == s->side[c] || (is && !s->is_strict) ||
      !matters(s, c, i))
    return VG_OK;
  if (is == SIDE_UNKNOWN) {
    if (s->is_local && is_around(s, other)) return VG_OK;
    set_side(s, other, s->side[c]);
    return VG_OK;
  }
  if (link == VG_NONE)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "the fluid is not enclosed near (%g %g %g): the outer "
                   "boundary must point inward",
                   x[0], x[1], x[2]);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "fluid and solid meet without a surface between them near "
                 "(%g %g %g); run 'vanguard check' on the surface",
                 x[0], x[1], x[2]);
}

static vg_status spread_sides(struct sides *s, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (; st == VG_OK && s->next < s->n_queue; s->next++)
    for (int i = 0; st == VG_OK && i < 4; i++)
      st = spread_over(s, s->queue[s->next], i, err);
  return st;
}

/* --- sides by straight walks -----------------------------------------------
 */

/* Sides are determined in this number of bands of growing width (K29). */
enum { BANDS = 4 };

/* Walks end after this number of cells. */
enum { MOST_STEPS = 512 };

/* Cells that a walk went through, from the first one on. */
struct walk {
  double from[3], to[3];
  uint32_t n, cell[MOST_STEPS];
};

static int passes(const struct walk *w, const double *a, const double *b,
                  const double *c)
{
  double u = vg_orient3d(w->from, w->to, a, b);
  double v = vg_orient3d(w->from, w->to, b, c);
  double x = vg_orient3d(w->from, w->to, c, a);

  return (u >= 0 && v >= 0 && x >= 0) || (u <= 0 && v <= 0 && x <= 0);
}

/* The face by which a straight walk leaves cell c, which it entered by `link`;
 * -1: the walk ends in c. */
static int way_out(const struct vg_tets *t, const struct walk *w, uint32_t c,
                   uint32_t link)
{
  const struct vg_cell *cell = &t->cell[c];
  int out = -1;

  for (int i = 0; i < 4; i++) {
    const double *x[3];

    if (link != VG_NONE && cell->link[i] == link) continue;
    for (int k = 0; k < 3; k++) x[k] = t->x[cell->v[vg_face[i][k]]];
    if (vg_orient3d(x[0], x[1], x[2], w->to) >= 0) continue;
    out = i;
    if (passes(w, x[0], x[1], x[2])) break;
  }
  return out;
}

/* Side of cell c, by the first surface triangle, or the first cell with a
 * known side, that the walk comes to. */
static uint8_t walk(const struct sides *s, struct walk *w, uint32_t c)
{
  uint32_t link = VG_NONE;

  for (w->n = 0; w->n < MOST_STEPS && !s->side[c];) {
    int i = way_out(s->t, w, c, link);

    w->cell[w->n++] = c;
    if (i < 0) return SIDE_UNKNOWN;
    if (s->front[c] >> i & 1) return SIDE_FLUID;
    if (s->front[c] >> i & 0x10) return SIDE_SOLID;
    if (s->t->cell[c].link[i] == VG_NONE) return SIDE_UNKNOWN;
    link = 4 * c + (uint32_t)i;
    c = s->t->cell[c].link[i] >> 2;
  }
  return s->side[c];
}

/* Start in cell c next to the corner that is nearest to the region, in
 * spacings. Returns 0 if all corners are beyond the band. */
static int start_walk(const struct sides *s, struct walk *w, uint32_t c)
{
  const struct vg_tets *t = s->t;
  const uint32_t *v = t->cell[c].v;
  double least = vg_region_band(s->cache->region, s->band);
  int best = -1;

  for (int i = 0; i < 4; i++) {
    double far = vg_region_cache_far(s->cache, v[i]);

    if (far > least) continue;
    least = far;
    best = i;
  }
  if (best < 0) return 0;
  for (int k = 0; k < 3; k++) {
    double middle = (t->x[v[0]][k] + t->x[v[1]][k] + t->x[v[2]][k] +
                     t->x[v[3]][k]) /
                    4;

    w->from[k] = t->x[v[best]][k] + (middle - t->x[v[best]][k]) / 64;
  }
  vg_region_foot(s->cache->region, w->from, w->to);
  return 1;
}

/* Determine the sides of the cells in the band of a plane by walks to it, those
 * near it first. All points on a walk have the same foot, and all front faces
 * within the band are known, so the walk meets every surface between the cell
 * and the plane, and the side that it finds is certain. A plane along a thin
 * body needs this: there the spacing and with it the band grow quickly away
 * from the body, and cells reach from the rim of the known front at the body to
 * points far away. If sides spread around that rim, such cells become solid,
 * and the faces between them and the fluid keep points and cells away from the
 * plane. Pencils do without, since edges there are no shorter with walks. */
static void walk_to_region(struct sides *s)
{
  double reach = s->cache->region->reach;
  struct walk w;

  if (s->cache->region->n_plane != 1) return;
  for (int k = 1; k <= BANDS; k++) {
    s->band = (reach + VG_BAND_FLUID) * k / BANDS - reach;
    for (uint32_t c = 0; c < s->t->n_cell; c++) {
      uint8_t is;

      if (s->side[c] || s->t->flag[c] & VG_DEAD ||
          (s->is_local && is_around(s, c)) || !start_walk(s, &w, c))
        continue;
      is = walk(s, &w, c);
      for (uint32_t m = 0; is && m < w.n; m++)
        if (!s->is_local || !is_around(s, w.cell[m]))
          set_side(s, w.cell[m], is);
    }
  }
}

/* --- sides that spread ---------------------------------------------------- */

static vg_status spread_in_bands(struct sides *s, struct vg_error *err)
{
  double reach = s->cache->region->reach;
  vg_status st = VG_OK;

  for (int k = 1; k <= BANDS; k++) {
    /* The first band may be narrower than the previous last one. */
    set_band(s,
             k < BANDS ? (reach + VG_BAND_FLUID) * k / BANDS - reach
                       : VG_BAND_FLUID,
             k == 1 ? 0 : 0x0f);
    s->next = 0;
    VG_TRY(seed_sides(s, err));
    VG_TRY(spread_sides(s, err));
  }
done:
  return st;
}

/* Determine the sides. On the region itself every front face is known, so
 * sides that spread along the region are certain, and so are sides found by
 * walks to it. The remaining cells have no corner in the band. Sides spread to
 * them over bands of growing width. Where sides contradict each other because
 * faces are missing, the side nearest to the region wins: far from the region,
 * the front continues beyond the known faces, and sides may leak around the
 * rim of the known part. Cells with a corner of the box extend around the whole
 * front, past all rims. They are only included in a second round, when the
 * sides between are determined. */
static vg_status tell_sides(struct sides *s, struct vg_error *err)
{
  double reach = s->cache ? s->cache->region->reach : 0;
  vg_status st;

  s->band = s->cache ? -reach + 1e-6 : 0;
  s->is_strict = 1;
  VG_TRY(seed_sides(s, err));
  VG_TRY(spread_sides(s, err));
  if (!s->cache) goto done;
  s->is_strict = 0;
  s->is_local = 1;
  walk_to_region(s);
  VG_TRY(spread_in_bands(s, err));
  s->is_local = 0;
  walk_to_region(s);
  VG_TRY(spread_in_bands(s, err));
done:
  return st;
}

static int meets_region(const struct sides *s, uint32_t c)
{
  for (int i = 0; i < 4; i++)
    if (matters(s, c, i)) return 1;
  return 0;
}

/* Handle the cells that were not reached in a region. Those away from the
 * region count as fluid, so that they do not hinder insertion, but faces
 * between them and known solid cells are fixed, since there is no surface
 * between the two. Cells that meet the region but were not reached have no
 * front nearby that could determine their side. They count as solid, so that
 * no cells are made there. */
static void wall_off(struct sides *s)
{
  struct vg_tets *t = s->t;

  set_band(s, VG_BAND_PLACE, 0);
  for (uint32_t c = 0; c < t->n_cell; c++)
    if (s->side[c] == SIDE_UNKNOWN && !(t->flag[c] & VG_DEAD))
      s->side[c] = meets_region(s, c) ? SIDE_SOLID : SIDE_FLUID;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && s->side[c] == SIDE_SOLID; i++) {
      uint32_t link = t->cell[c].link[i];

      if (link == VG_NONE || s->side[link >> 2] == SIDE_SOLID) continue;
      t->flag[c] |= (uint8_t)(1 << i);
      t->flag[link >> 2] |= (uint8_t)(1 << (link & 3));
    }
}

vg_status vg_boundary_sides(struct vg_tets *t, size_t n_tri,
                            const uint32_t (*tri)[3],
                            const struct vg_region *region, size_t corner,
                            const struct vg_sizing *sizing,
                            struct vg_error *err)
{
  struct tri_table table = { 0 };
  struct vg_region_cache cache = { 0 };
  struct sides s = { .t = t,
                     .cache = region ? &cache : NULL,
                     .corner = (uint32_t)corner };
  size_t n_fluid = 0;
  vg_status st = VG_OK;

  assert(t->n_cell > 0 && (tri || !n_tri));
  assert(!region || (sizing && corner + 8 <= t->n_point));
  s.side = vg_calloc(t->n_cell, 1);
  s.front = vg_calloc(t->n_cell, 1);
  s.near = vg_calloc(region ? t->n_cell : 1, 1);
  s.queue = vg_alloc(t->n_cell, sizeof *s.queue);
  if (!s.side || !s.front || !s.near || !s.queue)
    st = vg_fail_memory(err, "boundary recovery");
  if (st == VG_OK) st = tri_table_init(&table, n_tri, tri, err);
  if (st == VG_OK && region)
    st = vg_region_cache_init(&cache, region, sizing, t->n_point,
                              (const double(*)[3])t->x, err);
  if (st == VG_OK) find_front(&s, &table);
  if (st == VG_OK) st = tell_sides(&s, err);
  if (st == VG_OK && region) wall_off(&s);
  for (size_t c = 0; st == VG_OK && c < t->n_cell; c++) {
    if (s.side[c] == SIDE_FLUID) n_fluid++;
    else t->flag[c] |= VG_OUTSIDE;
  }
  if (st == VG_OK && !n_fluid)
    st = vg_fail(err, VG_ERR_GEOMETRY, "the surface encloses no fluid");
  free(s.side);
  free(s.front);
  free(s.near);
  free(s.queue);
  vg_region_cache_release(&cache);
  tri_table_release(&table);
  return st;
}

/* --- the whole void at once ----------------------------------------------- */

/* Triangles without the second ones of opposite pairs. Freed by the caller. */
static vg_status one_of_each(size_t n_tri, const uint32_t (*tri)[3],
                             uint32_t (**out)[3], size_t *n_out,
                             struct vg_error *err)
{
  struct tri_table table;
  uint32_t(*one)[3] = vg_alloc(n_tri, sizeof *one);
  vg_status st = tri_table_init(&table, n_tri, tri, err);
  int sense;

  if (!one && st == VG_OK) st = vg_fail_memory(err, "the surface table");
  *n_out = 0;
  for (uint32_t i = 0; st == VG_OK && i < n_tri; i++) {
    const uint32_t at = tri_table_find(&table, tri[i], &sense);

    if (!has_twin(&table, at) || table.twin[at] != i)
      memcpy(one[(*n_out)++], tri[i], sizeof *one);
  }
  tri_table_release(&table);
  if (st == VG_OK) *out = one;
  else free(one);
  return st;
}

static vg_status whole_void(size_t n, const double (*x)[3], size_t n_tri,
                            const uint32_t (*tri)[3], struct vg_tets *out,
                            struct vg_boundary_report *report,
                            struct vg_error *err)
{
  struct vg_cdt_job job = { .n = n, .n_tri = n_tri, .x = x, .tri = tri };
  size_t n_missing = n_tri;
  struct vg_error why = VG_ERROR_INIT;
  vg_status st = vg_cdt_tetgen(1, &job, &why);

  if (st == VG_BLOCKED)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "%zu of %zu surface triangles could not be recovered by "
                   "flips alone: %s",
                   report->n_face_left, n_tri, why.text);
  if (st < 0) return vg_fail(err, st, "%s", why.text);
  report->whole_void = 1;
  if (job.st == VG_OK) {
    report->n_steiner = job.n_all - n;
    report->n_pocket = 1;
    report->n_pocket_cell = job.n_tet;
    st = vg_tets_from_cells(out, job.n_all, job.all, job.n_tet,
                            (const uint32_t(*)[4])job.tet, err);
    free(job.tet);
    VG_TRY(st);
    VG_TRY(vg_boundary_fix(out, n_tri, tri, NULL, &n_missing, err));
  }
  if (n_missing)
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "%zu of %zu surface triangles could not be recovered; run "
                 "'vanguard check' on the surface",
                 n_missing, n_tri);
done:
  return st;
}

/* Number of triangles that are not fixed faces; SIZE_MAX if memory is refused.
 */
static size_t not_fixed(struct vg_tets *t, size_t n_tri,
                        const uint32_t (*tri)[3])
{
  size_t n_missing = SIZE_MAX;

  return vg_boundary_fix(t, n_tri, tri, NULL, &n_missing, NULL) < 0 ? SIZE_MAX
                                                                    : n_missing;
}

/* Cells in which every triangle is a face, before sides are determined. In a
 * metric, points in the void help, unless one of them is in a triangle or too
 * near to it. */
static vg_status recover(const struct vg_boundary_input *in,
                         struct vg_tets *out, struct vg_boundary_report *report,
                         struct vg_error *err)
{
  int is_stretched = vg_boundary_is_stretched(in);
  vg_status st = VG_OK;

  for (int inner = is_stretched; inner >= 0; inner--) {
    vg_tets_release(out);
    st = vg_boundary_cells(out, in, inner, err);
    if (st == VG_OK)
      st = vg_recover(out, in->n_tri, in->tri, !is_stretched, inner, report,
                      err);
    if (st != VG_ERR_GEOMETRY) break;
  }
  return st;
}

vg_status vg_boundary_tets(size_t n, const double (*x)[3], size_t n_tri,
                           const uint32_t (*tri)[3],
                           const struct vg_sizing *sizing, struct vg_tets *out,
                           struct vg_boundary_report *report,
                           struct vg_error *err)
{
  const struct vg_boundary_input in = { n, n_tri, x, tri, sizing, NULL };
  uint32_t(*one)[3] = NULL;
  size_t n_one = 0;
  vg_status st;

  assert(n > 0 && x && tri && report);
  assert(!out->n_point && !out->n_cell);
  memset(report, 0, sizeof *report);
  st = recover(&in, out, report, err);
  if (st == VG_ERR_GEOMETRY) {
    vg_tets_release(out);
    VG_TRY(one_of_each(n_tri, tri, &one, &n_one, err));
    st = whole_void(n, x, n_one, (const uint32_t(*)[3])one, out, report, err);
  }
  VG_TRY(st);
  VG_TRY(vg_boundary_sides(out, n_tri, tri, NULL, 0, NULL, err));
  VG_CHECK("boundary recovery", vg_tets_defects(out));
  VG_CHECK("boundary recovery", not_fixed(out, n_tri, tri));
done:
  free(one);
  if (st < 0) vg_tets_release(out);
  return st;
}

vg_status vg_boundary_open(size_t n, const double (*x)[3], size_t n_tri,
                           const uint32_t (*tri)[3],
                           const struct vg_region *region,
                           const struct vg_sizing *sizing, struct vg_tets *out,
                           struct vg_boundary_report *report,
                           struct vg_error *err)
{
  const struct vg_boundary_input in = { n, n_tri, x, tri, sizing, region };
  vg_status st;

  assert(n > 0 && x && tri && report && region && sizing);
  assert(!out->n_point && !out->n_cell);
  memset(report, 0, sizeof *report);
  VG_TRY(recover(&in, out, report, err));
  VG_TRY(vg_boundary_sides(out, n_tri, tri, region, n, sizing, err));
  VG_CHECK("boundary recovery", vg_tets_defects(out));
  VG_CHECK("boundary recovery", not_fixed(out, n_tri, tri));
done:
  if (st < 0) vg_tets_release(out);
  return st;
}
