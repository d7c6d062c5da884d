/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Welds open edges whose ends are next to those of another open edge because
 * the two parts of the surface were rounded differently: see surface_check.h.
 *
 * Tolerances are tried in levels that increase by factors of ten. On each level
 * the ends of the edges that are still open are grouped by distance, and two
 * edges between the same two groups are partners: their ends are merged. A
 * small gap is thus closed before a larger distance near it, such as the
 * thickness of a trailing edge, can be mistaken for a gap. */
#include "core/surface/surface_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"

#define SHARE 0.1 /* S61: largest gap over the shortest edge there */
#define LEVEL_LEAST                                                            \
  1e-15 /* of the largest coordinate: first tolerance; less is not resolved */
#define LEVEL_STEP 10

struct rim_edge {
  uint32_t end[2]; /* Points of the mesh. */
  uint32_t key[2]; /* Groups of its ends on the current level. */
};

struct rims {
  const struct vg_mesh *m;
  uint32_t *up;          /* [n_point] Union-find of points that are merged. */
  double *shortest;      /* [n_point] Shortest edge at each point. */
  struct rim_edge *edge; /* [n_edge] Edges still open. */
  size_t n_edge, n_matched;
  double least;   /* First tolerance. */
  double gap;     /* Largest distance of merged ends. */
  uint8_t *used;  /* [n_point] 1: grouped on the current level. */
  uint32_t *near; /* [n_point] Group on the current level. */
};

static void rims_release(struct rims *r)
{
  free(r->up);
  free(r->shortest);
  free(r->edge);
  free(r->used);
  free(r->near);
}

static void measure_edges(struct rims *r, const struct vg_faces *s)
{
  for (size_t i = 0; i < r->m->n_point; i++) r->shortest[i] = INFINITY;
  for (size_t f = 0; f < s->n; f++) {
    if (s->state[f] & VG_FACE_COLLAPSED) continue;
    for (int k = 0; k < 3; k++) {
      uint32_t a = s->node[f][k], b = s->node[f][(k + 1) % 3];
      double h = vg_distance(r->m->point[a], r->m->point[b]);

      if (h < r->shortest[a]) r->shortest[a] = h;
      if (h < r->shortest[b]) r->shortest[b] = h;
    }
  }
}

static vg_status list_open_edges(struct rims *r, const struct vg_faces *s,
                                 struct vg_error *err)
{
  struct vg_edges e = VG_EDGES_INIT;
  size_t n = 0;
  vg_status st = vg_faces_edges(s, &e, err);

  if (st < 0) return st;
  for (size_t i = 0; i < e.n; i++) n += e.start[i + 1] - e.start[i] == 1;
  r->edge = vg_alloc(n, sizeof *r->edge);
  if (!r->edge) st = vg_fail_memory(err, "the open edges");
  for (size_t i = 0; i < e.n && st == VG_OK; i++) {
    uint32_t h = e.half[e.start[i]];

    if (e.start[i + 1] - e.start[i] != 1) continue;
    r->edge[r->n_edge].end[0] = s->node[h / 3][h % 3];
    r->edge[r->n_edge++].end[1] = s->node[h / 3][(h + 1) % 3];
  }
  vg_edges_release(&e);
  return st;
}

static vg_status rims_init(struct rims *r, const struct vg_mesh *m,
                           struct vg_error *err)
{
  struct vg_faces s = VG_FACES_INIT;
  double lo[3], hi[3];
  vg_status st;

  r->m = m;
  VG_TRY(vg_mesh_check_index(m, err));
  VG_TRY(vg_points_same(m, &r->up, err));
  VG_TRY(vg_faces_build(&s, m, r->up, err));
  r->shortest = vg_alloc(m->n_point, sizeof *r->shortest);
  r->used = vg_alloc(m->n_point, 1);
  r->near = vg_alloc(m->n_point, sizeof *r->near);
  if (!r->shortest || !r->used || !r->near)
    VG_TRY(vg_fail_memory(err, "the open edges"));
  measure_edges(r, &s);
  VG_TRY(list_open_edges(r, &s, err));
  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++)
    r->least = fmax(r->least, LEVEL_LEAST * fmax(-lo[k], hi[k]));
done:
  vg_faces_release(&s);
  return st;
}

/* Set the groups of the n points `number`, where map[] is their grouping by
 * distance. Points that were merged on a lower level are in the same group. */
static void take_groups(struct rims *r, const uint32_t *number,
                        const uint32_t *map, size_t n)
{
  for (size_t i = 0; i < n; i++)
    r->near[vg_root_of(r->up, number[i])] = UINT32_MAX;
  for (size_t i = 0; i < n; i++) r->near[number[i]] = number[map[i]];
  for (size_t i = 0; i < n; i++) {
    uint32_t p = number[i], root = vg_root_of(r->up, p);

    if (r->near[root] == UINT32_MAX) r->near[root] = r->near[p];
    else vg_union(r->near, p, root);
  }
}

/* Group the ends of open edges that are long compared with the tolerance.
 * r->near becomes the group of each end, identified by its lowest point. */
static vg_status group_ends(struct rims *r, double tolerance,
                            struct vg_error *err)
{
  struct vg_mesh ends = VG_MESH_INIT;
  uint32_t *map = NULL, *number = NULL;
  vg_status st = VG_OK;

  memset(r->used, 0, r->m->n_point);
  for (size_t i = 0; i < r->n_edge; i++)
    for (int k = 0; k < 2; k++) {
      uint32_t p = r->edge[i].end[k];

      r->used[p] = tolerance <= SHARE * r->shortest[p];
    }
  ends.point = vg_alloc(2 * r->n_edge, sizeof *ends.point);
  number = vg_alloc(2 * r->n_edge, sizeof *number);
  if (!ends.point || !number)
    VG_TRY(vg_fail_memory(err, "the ends of open edges"));
  for (size_t p = 0; p < r->m->n_point; p++) {
    if (!r->used[p]) continue;
    memcpy(ends.point[ends.n_point], r->m->point[p], sizeof *ends.point);
    number[ends.n_point++] = (uint32_t)p;
  }
  VG_TRY(vg_points_near(&ends, tolerance, &map, err));
  take_groups(r, number, map, ends.n_point);
done:
  vg_mesh_release(&ends);
  free(number);
  free(map);
  return st;
}

static int by_key(const void *a, const void *b)
{
  const struct rim_edge *p = a, *q = b;

  for (int k = 0; k < 2; k++)
    if (p->key[k] != q->key[k]) return p->key[k] < q->key[k] ? -1 : 1;
  for (int k = 0; k < 2; k++)
    if (p->end[k] != q->end[k]) return p->end[k] < q->end[k] ? -1 : 1;
  return 0;
}

/* Move the edges that this level can match to the front, sorted by their
 * groups. */
static size_t sort_edges(struct rims *r)
{
  size_t n = 0;

  for (size_t i = 0; i < r->n_edge; i++) {
    struct rim_edge e = r->edge[i];
    uint32_t a, b;

    if (!r->used[e.end[0]] || !r->used[e.end[1]]) continue;
    a = vg_root_of(r->near, e.end[0]);
    b = vg_root_of(r->near, e.end[1]);
    if (a == b) continue;
    e.key[0] = a < b ? a : b;
    e.key[1] = a < b ? b : a;
    r->edge[i] = r->edge[n];
    r->edge[n++] = e;
  }
  if (n) qsort(r->edge, n, sizeof *r->edge, by_key);
  return n;
}

static void match(struct rims *r, const struct rim_edge *e,
                  const struct rim_edge *f)
{
  int turned = vg_root_of(r->near, e->end[0]) != vg_root_of(r->near, f->end[0]);

  for (int k = 0; k < 2; k++) {
    uint32_t a = e->end[k], b = f->end[k ^ turned];
    double d = vg_distance(r->m->point[a], r->m->point[b]);

    if (d > r->gap) r->gap = d;
    vg_union(r->up, a, b);
  }
  r->n_matched += 2;
}

static vg_status match_level(struct rims *r, double tolerance,
                             struct vg_error *err)
{
  size_t n, left = 0;
  vg_status st = group_ends(r, tolerance, err);

  if (st < 0) return st;
  n = sort_edges(r);
  for (size_t i = 0, to; i < n; i = to) {
    for (to = i + 1; to < n; to++)
      if (r->edge[to].key[0] != r->edge[i].key[0] ||
          r->edge[to].key[1] != r->edge[i].key[1])
        break;
    if (to - i == 2) {
      match(r, &r->edge[i], &r->edge[i + 1]);
    } else {
      memmove(r->edge + left, r->edge + i, (to - i) * sizeof *r->edge);
      left += to - i;
    }
  }
  memmove(r->edge + left, r->edge + n, (r->n_edge - n) * sizeof *r->edge);
  r->n_edge -= n - left;
  return VG_OK;
}

/* Match on all levels up to the tolerance `most`, which is the last level. */
static vg_status match_levels(struct rims *r, double most, struct vg_error *err)
{
  double t = r->least;
  vg_status st = VG_OK;

  if (!isfinite(t) || !(t > 0)) return VG_OK;
  for (; t < most && r->n_edge > 1 && st >= 0; t *= LEVEL_STEP)
    st = match_level(r, t, err);
  if (r->n_edge > 1 && st >= 0) st = match_level(r, most, err);
  return st;
}

vg_status vg_surface_rim_gap(const struct vg_mesh *m,
                             const struct vg_surface_report *report,
                             double *gap, size_t *n_edge, struct vg_error *err)
{
  struct rims r = { .gap = 0 };
  double most = 0;
  vg_status st = VG_OK;

  assert(gap && n_edge);
  if (report && !report->count[VG_DEFECT_OPEN_EDGE]) goto done;
  VG_TRY(rims_init(&r, m, err));
  for (size_t i = 0; i < r.n_edge; i++)
    for (int k = 0; k < 2; k++) {
      double h = SHARE * r.shortest[r.edge[i].end[k]];

      if (isfinite(h) && h > most) most = h;
    }
  VG_TRY(match_levels(&r, most, err));
done:
  if (st >= 0) {
    *gap = r.n_matched ? fmax(r.gap, r.least) * (1 + 1e-9) : 0;
    *n_edge = r.n_matched;
  }
  rims_release(&r);
  return st;
}

vg_status vg_surface_weld_rims(struct vg_mesh *m, double tolerance,
                               size_t *n_merged, size_t *n_edge,
                               struct vg_error *err)
{
  struct rims r = { .gap = 0 };
  uint8_t *drop = NULL;
  size_t n_point = m->n_point;
  vg_status st;

  if (!(tolerance > 0) || isinf(tolerance))
    return vg_fail(err, VG_ERR_INPUT,
                   "weld tolerance %g: give a positive "
                   "distance",
                   tolerance);
  VG_TRY(rims_init(&r, m, err));
  VG_TRY(match_levels(&r, tolerance, err));
  if (r.n_matched) {
    drop = vg_calloc(m->n_tri, 1);
    if (!drop) VG_TRY(vg_fail_memory(err, "a list of triangles"));
    for (size_t i = 0; i < n_point; i++)
      r.up[i] = vg_root_of(r.up, (uint32_t)i);
    for (size_t t = 0; t < m->n_tri; t++) {
      uint32_t a = r.up[m->tri[t][0]], b = r.up[m->tri[t][1]];
      uint32_t c = r.up[m->tri[t][2]];

      drop[t] = a == b || b == c || c == a;
    }
    vg_mesh_drop_tri(m, drop);
    vg_mesh_renumber(m, r.up, NULL);
  }
  if (n_merged) *n_merged = n_point - m->n_point;
  if (n_edge) *n_edge = r.n_matched;
done:
  rims_release(&r);
  free(drop);
  return st;
}
