/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: the triangles of a piece get points of their own, one for each
 * umbrella. On divided junctions, the new points are inserted, and the old ones
 * removed. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"
#include "core/junction/junction_parts.h"
#include "core/mesh/edges.h"
#include "core/remesh/remesh.h"

#define SAME 1e-9 /* of the length of a curve: a point is there already */

/* A point on a curve of the piece. */
struct stop {
  uint32_t point;
  double at;
  int is_new; /* 1: it belongs to the division. */
};

struct line {
  uint64_t key;
  int is_divided;
};

struct builder {
  const struct vg_junctions *j;
  struct vg_junction_piece *p;
  uint32_t piece;
  size_t n;
  uint32_t *tri;  /* [n] Triangles of j->m. */
  uint32_t *up;   /* [3 n] union-find over corners. */
  uint32_t *from; /* [n_from] First points: points of j->m. */
  size_t n_from;
  uint32_t (*end)[2]; /* [j->n_edge] Points of the edges of junctions. */
  struct vg_junction_sheet s;
  struct stop *stop; /* [n_stop] On one curve. */
  size_t n_stop, cap_stop;
  struct line *line; /* [n_line] Edges of junctions. */
  size_t n_line, cap_line;
  uint32_t *node; /* [n_node] Ends of junctions. */
  size_t n_node, cap_node;
};

/* --- triangles and points --------------------------------------------------
 */

static uint32_t given(const struct builder *b, uint32_t corner)
{
  return b->j->m->tri[b->tri[corner / 3]][corner % 3];
}

static vg_status list_triangles(struct builder *b, struct vg_error *err)
{
  const struct vg_junctions *j = b->j;

  for (size_t t = 0; t < j->m->n_tri; t++) b->n += j->piece[t] == b->piece;
  b->tri = vg_alloc(b->n, sizeof *b->tri);
  b->up = vg_alloc(3 * b->n, sizeof *b->up);
  b->end = vg_alloc(j->n_edge, sizeof *b->end);
  if (!b->tri || !b->up || !b->end)
    return vg_fail_memory(err, "the junctions of inner surfaces");
  if (j->n_edge) memset(b->end, 0xff, j->n_edge * sizeof *b->end);
  b->n = 0;
  for (size_t t = 0; t < j->m->n_tri; t++)
    if (j->piece[t] == b->piece) b->tri[b->n++] = (uint32_t)t;
  b->p->patch = j->m->tri_patch[b->tri[0]];
  return VG_OK;
}

/* Joins the corners of triangles that continue each other across an edge. */
static vg_status join_corners(struct builder *b, struct vg_error *err)
{
  const uint32_t(*tri)[3];
  struct vg_edges e = VG_EDGES_INIT;
  uint32_t(*own)[3] = vg_alloc(b->n, sizeof *own);
  vg_status st;

  if (!own) return vg_fail_memory(err, "the junctions of inner surfaces");
  for (uint32_t k = 0; k < 3 * b->n; k++) own[k / 3][k % 3] = given(b, k);
  tri = (const uint32_t(*)[3])own;
  VG_TRY(vg_edges_build(&e, b->j->m->n_point, b->n, tri, NULL, 0, err));
  for (uint32_t k = 0; k < 3 * b->n; k++) b->up[k] = k;
  for (size_t i = 0; i < e.n; i++) {
    const uint32_t *h = vg_edges_at(&e, i);

    if (vg_edges_count(&e, i) != 2 || vg_edges_disagree(&e, tri, i)) continue;
    vg_union(b->up, h[0], vg_half_next(h[1]));
    vg_union(b->up, vg_half_next(h[0]), h[1]);
  }
done:
  vg_edges_release(&e);
  free(own);
  return st;
}

static vg_status make_mesh(struct builder *b, struct vg_error *err)
{
  const struct vg_mesh *from = b->j->m;
  struct vg_mesh *m = &b->p->mesh;
  uint32_t *number = vg_alloc(3 * b->n, sizeof *number);

  m->point = vg_alloc(3 * b->n, sizeof *m->point);
  m->tri = vg_alloc(b->n, sizeof *m->tri);
  m->tri_patch = vg_alloc(b->n, sizeof *m->tri_patch);
  m->patch = vg_alloc(from->n_patch, sizeof *m->patch);
  b->from = vg_alloc(3 * b->n, sizeof *b->from);
  if (!b->from || !number || !m->point || !m->tri || !m->tri_patch ||
      !m->patch) {
    free(number);
    return vg_fail_memory(err, "the junctions of inner surfaces");
  }
  memcpy(m->patch, from->patch, from->n_patch * sizeof *m->patch);
  m->n_patch = from->n_patch;
  m->n_tri = b->n;
  for (uint32_t k = 0; k < 3 * b->n; k++) {
    const uint32_t root = vg_root_of(b->up, k);

    if (root == k) {
      number[k] = (uint32_t)m->n_point;
      b->from[m->n_point] = given(b, k);
      memcpy(m->point[m->n_point++], from->point[given(b, k)],
             sizeof *m->point);
    }
    m->tri[k / 3][k % 3] = number[root];
    m->tri_patch[k / 3] = b->p->patch;
  }
  b->n_from = m->n_point;
  free(number);
  return VG_OK;
}

static vg_status refuse(const struct builder *b, const double x[3],
                        const char *what, struct vg_error *err)
{
  const struct vg_patch *p = &b->j->m->patch[b->p->patch];

  return vg_fail(err, VG_ERR_GEOMETRY,
                 "patch %d%s%s, an inner surface, cannot be remeshed: near "
                 "(%g, %g, %g) %s, or set remesh_surface to no",
                 (int)p->id, *p->name ? " " : "", p->name, x[0], x[1], x[2],
                 what);
}

/* Finds the points of the edges of junctions. */
static vg_status find_ends(struct builder *b, struct vg_error *err)
{
  const struct vg_mesh *m = &b->p->mesh;

  for (uint32_t h = 0; h < 3 * b->n; h++) {
    const uint32_t g = vg_half_next(h);
    const int low = given(b, h) > given(b, g);
    const uint32_t a = m->tri[h / 3][h % 3], c = m->tri[g / 3][g % 3];
    const size_t i = vg_junction_edge(b->j, given(b, h), given(b, g));
    uint32_t *end;

    if (i == SIZE_MAX) continue;
    end = b->end[i];
    if (end[0] == VG_JUNCTION_NONE) {
      end[low] = a;
      end[!low] = c;
    } else if (end[low] != a || end[!low] != c) {
      return refuse(b, m->point[a],
                    "it touches itself along an edge; give its parts patches "
                    "of their own",
                    err);
    }
  }
  return VG_OK;
}

/* --- divisions -------------------------------------------------------------
 */

static vg_status add_stop(struct builder *b, size_t at, const struct stop *s,
                          struct vg_error *err)
{
  if (vg_reserve(&b->stop, &b->cap_stop, b->n_stop + 1, sizeof *b->stop))
    return vg_fail_memory(err, "the junctions of inner surfaces");
  memmove(b->stop + at + 1, b->stop + at, (b->n_stop++ - at) * sizeof *b->stop);
  b->stop[at] = *s;
  return VG_OK;
}

/* The points of a curve. *has: 1: the piece has this curve. */
static vg_status list_stops(struct builder *b, const struct vg_junction *c,
                            int *has, struct vg_error *err)
{
  const struct vg_junctions *j = b->j;
  const uint32_t *p = j->point + c->first;
  uint32_t last = VG_JUNCTION_NONE;
  vg_status st = VG_OK;

  b->n_stop = 0;
  *has = 0;
  for (size_t k = 0; k + 1 < c->n; k++) {
    const uint32_t *end = b->end[vg_junction_edge(j, p[k], p[k + 1])];
    const int low = p[k] > p[k + 1];

    if (end[0] == VG_JUNCTION_NONE) return VG_OK;
    if (k && end[low] != last)
      return refuse(b, j->m->point[p[k]],
                    "it touches itself in a point; give its parts patches of "
                    "their own",
                    err);
    last = end[!low];
    if (!k) VG_TRY(add_stop(b, 0, &(struct stop){ end[low], 0, 0 }, err));
    VG_TRY(add_stop(b, k + 1,
                    &(struct stop){ last, j->at[c->first + k + 1], 0 }, err));
  }
  *has = 1;
done:
  return st;
}

/* Inserts new point i of the division, behind the stop before it. */
static vg_status insert(struct builder *b, size_t i, double length,
                        size_t *before, struct vg_error *err)
{
  const struct vg_junctions *j = b->j;
  const double s = j->made_at[i];
  struct stop made = { .at = s, .is_new = 1 };
  size_t k = *before;
  double x[3], t;
  vg_status st;

  while (k + 2 < b->n_stop && b->stop[k + 1].at < s - SAME * length) k++;
  for (int e = 0; e < 2; e++)
    if (fabs(b->stop[k + (size_t)e].at - s) <= SAME * length &&
        !b->stop[k + (size_t)e].is_new) {
      *before = k + (size_t)e;
      b->stop[*before].is_new = 1;
      return VG_OK;
    }
  t = (s - b->stop[k].at) / (b->stop[k + 1].at - b->stop[k].at);
  for (int d = 0; d < 3; d++)
    x[d] = (1 - t) * b->s.m->point[b->stop[k].point][d] +
           t * b->s.m->point[b->stop[k + 1].point][d];
  VG_TRY(vg_junction_split(&b->s, b->stop[k].point, b->stop[k + 1].point, x,
                           &made.point, err));
  VG_TRY(add_stop(b, k + 1, &made, err));
  *before = k + 1;
done:
  return st;
}

/* Removes the old points, as long as there are some that can be removed. */
static vg_status remove_old(struct builder *b, struct vg_error *err)
{
  size_t left = 1, n;

  for (int any = 1; left && any;) {
    any = 0;
    left = 0;
    n = 1;
    for (size_t i = 1; i < b->n_stop; i++) {
      const struct stop *s = &b->stop[i];

      if (!s->is_new) {
        if (vg_junction_drop(&b->s, b->stop[n - 1].point, s->point,
                             b->stop[i + 1].point)) {
          any = 1;
          continue;
        }
        left++;
      }
      b->stop[n++] = *s;
    }
    b->n_stop = n;
  }
  for (size_t i = 1; left && i < b->n_stop; i++)
    if (!b->stop[i].is_new)
      return refuse(b, b->s.m->point[b->stop[i].point],
                    "its triangles would fold if it had the edges of the "
                    "surface that it touches; give it smaller triangles there, "
                    "or a smaller surface_size",
                    err);
  return VG_OK;
}

static vg_status add_line(struct builder *b, uint32_t p, uint32_t q,
                          int is_divided, struct vg_error *err)
{
  if (vg_reserve(&b->line, &b->cap_line, b->n_line + 1, sizeof *b->line))
    return vg_fail_memory(err, "the junctions of inner surfaces");
  b->line[b->n_line++] = (struct line){ vg_edge_key(p, q), is_divided };
  return VG_OK;
}

/* Takes over the division of a curve, whose points are in b->stop. */
static vg_status divide(struct builder *b, const struct vg_junction *c,
                        struct vg_error *err)
{
  const struct vg_junctions *j = b->j;
  const double length = j->at[c->first + c->n - 1];
  size_t before = 0;
  vg_status st;

  for (size_t i = 0; i < c->n_made; i++)
    VG_TRY(insert(b, c->made + i, length, &before, err));
  for (size_t i = 0, k = 0; i < b->n_stop; i++)
    if (b->stop[i].is_new)
      memcpy(b->s.m->point[b->stop[i].point], j->made_x[c->made + k++],
             sizeof *b->s.m->point);
  VG_TRY(remove_old(b, err));
done:
  return st;
}

static vg_status divide_all(struct builder *b, struct vg_error *err)
{
  const struct vg_junctions *j = b->j;
  vg_status st = VG_OK;
  int has;

  for (size_t i = 0; i < j->n; i++) {
    VG_TRY(list_stops(b, &j->curve[i], &has, err));
    if (!has) continue;
    if (j->curve[i].n_made) VG_TRY(divide(b, &j->curve[i], err));
    if (vg_reserve(&b->node, &b->cap_node, b->n_node + 2, sizeof *b->node))
      VG_TRY(vg_fail_memory(err, "the junctions of inner surfaces"));
    b->node[b->n_node++] = b->stop[0].point;
    b->node[b->n_node++] = b->stop[b->n_stop - 1].point;
    for (size_t k = 0; k + 1 < b->n_stop; k++)
      VG_TRY(add_line(b, b->stop[k].point, b->stop[k + 1].point,
                      j->curve[i].n_made > 0, err));
  }
done:
  return st;
}

/* --- marks -----------------------------------------------------------------
 */

/* Keys are the first members of lines. */
static const struct line *line_of(const struct builder *b, uint32_t p,
                                  uint32_t q)
{
  const uint64_t key = vg_edge_key(p, q);

  return b->n_line ? bsearch(&key, b->line, b->n_line, sizeof *b->line,
                             vg_compare_edge_keys)
                   : NULL;
}

static void sort_lines(struct builder *b)
{
  if (b->n_line)
    qsort(b->line, b->n_line, sizeof *b->line, vg_compare_edge_keys);
}

/* Marks the points of divided junctions, and the ends of the others. */
static vg_status mark_points(struct builder *b, struct vg_error *err)
{
  struct vg_junction_piece *p = b->p;
  const struct vg_mesh *m = &p->mesh;

  p->still = vg_calloc(m->n_point, sizeof *p->still);
  p->cap = vg_alloc(m->n_point, sizeof *p->cap);
  if (!p->still || !p->cap)
    return vg_fail_memory(err, "the junctions of inner surfaces");
  for (size_t i = 0; i < m->n_point; i++)
    p->cap[i] = b->j->size && i < b->n_from ? b->j->size[b->from[i]] : INFINITY;
  for (size_t i = 0; i < b->n_line; i++) {
    const uint32_t v[2] = { (uint32_t)(b->line[i].key >> 32),
                            (uint32_t)b->line[i].key };
    const double length = vg_distance(m->point[v[0]], m->point[v[1]]);

    for (int k = 0; k < 2 && b->line[i].is_divided; k++) {
      double *cap = &p->cap[v[k]];

      *cap = p->still[v[k]] ? (*cap + length) / 2 : length;
      p->still[v[k]] = VG_REMESH_KEPT;
    }
  }
  for (size_t i = 0; i < b->n_node; i++)
    if (!p->still[b->node[i]]) p->still[b->node[i]] = VG_REMESH_STILL;
  return VG_OK;
}

static int is_gone(const struct vg_mesh *m, size_t t)
{
  return m->tri[t][0] == m->tri[t][1];
}

/* Splits rims and junctions without a division between two points that stay:
 * they would stay, too. */
static vg_status split_kept(struct builder *b, struct vg_error *err)
{
  struct vg_mesh *m = &b->p->mesh;
  const uint8_t *still = b->p->still;
  struct vg_edges e = VG_EDGES_INIT;
  uint8_t *gone = vg_calloc(m->n_tri, 1);
  uint32_t(*cut)[2] = NULL, made;
  size_t n = 0;
  vg_status st = gone ? VG_OK : vg_fail_memory(err, "the inner surfaces");

  VG_TRY(st);
  for (size_t t = 0; t < m->n_tri; t++) gone[t] = (uint8_t)is_gone(m, t);
  VG_TRY(vg_edges_build(&e, m->n_point, m->n_tri, (const uint32_t(*)[3])m->tri,
                        gone, 1, err));
  cut = vg_alloc(e.n, sizeof *cut);
  if (!cut) VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  for (size_t i = 0; i < e.n; i++) {
    const uint32_t h = vg_edges_at(&e, i)[0], g = vg_half_next(h);
    const uint32_t p = m->tri[h / 3][h % 3], q = m->tri[g / 3][g % 3];
    const struct line *l = line_of(b, p, q);

    if (still[p] != VG_REMESH_KEPT || still[q] != VG_REMESH_KEPT ||
        (l ? l->is_divided : vg_edges_count(&e, i) != 1))
      continue;
    cut[n][0] = p;
    cut[n++][1] = q;
  }
  for (size_t i = 0; i < n; i++) {
    const struct line *l = line_of(b, cut[i][0], cut[i][1]);
    double x[3];

    for (int d = 0; d < 3; d++)
      x[d] = (m->point[cut[i][0]][d] + m->point[cut[i][1]][d]) / 2;
    VG_TRY(vg_junction_split(&b->s, cut[i][0], cut[i][1], x, &made, err));
    if (!l) continue;
    for (int k = 0; k < 2; k++) VG_TRY(add_line(b, cut[i][k], made, 0, err));
    sort_lines(b);
  }
done:
  vg_edges_release(&e);
  free(gone);
  free(cut);
  return st;
}

/* Points of splits have no marks. */
static vg_status extend_marks(struct builder *b, size_t n, struct vg_error *err)
{
  struct vg_junction_piece *p = b->p;
  const size_t n_point = p->mesh.n_point;
  uint8_t *still = vg_realloc(p->still, n_point, sizeof *still);
  double *cap;

  if (still) p->still = still;
  cap = vg_realloc(p->cap, n_point, sizeof *cap);
  if (cap) p->cap = cap;
  if (!still || !cap)
    return vg_fail_memory(err, "the junctions of inner surfaces");
  for (; n < n_point; n++) {
    still[n] = 0;
    cap[n] = INFINITY;
  }
  return VG_OK;
}

/* Drops removed triangles, and points without triangles. */
static vg_status compact(struct builder *b, struct vg_error *err)
{
  struct vg_junction_piece *p = b->p;
  struct vg_mesh *m = &p->mesh;
  uint32_t *to = vg_alloc(m->n_point, sizeof *to);
  size_t n = 0;

  p->stretch = vg_calloc(3 * m->n_tri, sizeof *p->stretch);
  if (!to || !p->stretch) {
    free(to);
    return vg_fail_memory(err, "the junctions of inner surfaces");
  }
  memset(to, 0xff, m->n_point * sizeof *to);
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t v[3] = { m->tri[t][0], m->tri[t][1], m->tri[t][2] };

    if (v[0] == v[1]) continue;
    for (int k = 0; k < 3; k++) {
      to[v[k]] = 0;
      if (line_of(b, v[k], v[(k + 1) % 3]))
        p->stretch[3 * n + (size_t)k] = VG_REMESH_FEATURE;
    }
    memcpy(m->tri[n++], v, sizeof v);
  }
  m->n_tri = n;
  n = 0;
  for (size_t i = 0; i < m->n_point; i++) {
    if (to[i]) continue;
    memmove(m->point[n], m->point[i], sizeof *m->point);
    p->still[n] = p->still[i];
    p->cap[n] = p->cap[i];
    to[i] = (uint32_t)n++;
  }
  m->n_point = n;
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) m->tri[t][k] = to[m->tri[t][k]];
  free(to);
  return VG_OK;
}

vg_status vg_junctions_piece(const struct vg_junctions *j, uint32_t i,
                             struct vg_junction_piece *p, struct vg_error *err)
{
  struct builder b = { .j = j, .p = p, .piece = i };
  size_t n;
  vg_status st;

  assert(i > 0 && i < j->n_piece && !p->mesh.n_tri);
  VG_TRY(list_triangles(&b, err));
  VG_TRY(join_corners(&b, err));
  VG_TRY(make_mesh(&b, err));
  VG_TRY(find_ends(&b, err));
  VG_TRY(vg_junction_sheet_open(&b.s, &p->mesh, err));
  VG_TRY(divide_all(&b, err));
  sort_lines(&b);
  VG_TRY(mark_points(&b, err));
  n = p->mesh.n_point;
  VG_TRY(split_kept(&b, err));
  VG_TRY(extend_marks(&b, n, err));
  VG_TRY(compact(&b, err));
done:
  vg_junction_sheet_release(&b.s);
  free(b.tri);
  free(b.up);
  free(b.from);
  free(b.end);
  free(b.stop);
  free(b.line);
  free(b.node);
  return st;
}

void vg_junction_piece_release(struct vg_junction_piece *p)
{
  vg_mesh_release(&p->mesh);
  free(p->stretch);
  free(p->still);
  free(p->cap);
  *p = (struct vg_junction_piece)VG_JUNCTION_PIECE_INIT;
}
