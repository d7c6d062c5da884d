/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: all points move at once, since neighbours move by nearly the same
 * vector. Points of bad triangles are then moved back, until no triangle is
 * bad, and so are points of triangles that intersect. If triangles still
 * intersect, increasing numbers of rings of points around them are moved back.
 * The given surface is sound, so this terminates. */
#include "core/remesh/put_back.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "core/remesh/metric.h"
#include "core/remesh/reference.h"
#include "core/surface/surface_check.h"

#define GRAIN 1024
#define TURN 0.5 /* S28: cosine: no triangle turns by more */
#define SLIVER                                                                 \
  0.12           /* (sin 20 degrees)^2: smaller angles may not shrink by LOSS */
#define LOSS 0.7 /* of the squared sine */
#define TIGHT 3  /* rounds without rings; each later one doubles the rings */
#define ROUNDS 9 /* rounds, after which all points are moved back */

/* --- nearest triangles ---------------------------------------------------- */

struct locating {
  const struct vg_ref *ref;
  const double (*x)[3];
  uint32_t *tri;
  double (*foot)[3];
  const struct vg_stop *stop;
};

/* Hints are reused within a chunk. Chunk bounds do not depend on the number of
 * threads. */
static void locate(void *context, size_t first, size_t end, int worker)
{
  const struct locating *l = context;
  uint32_t hint = VG_REF_NONE;

  (void)worker;
  if (vg_stops(l->stop)) return;
  for (size_t i = first; i < end; i++) {
    vg_ref_nearest(l->ref, l->x[i], NULL, &hint, l->foot[i]);
    l->tri[i] = hint;
  }
}

vg_status vg_remesh_locate(const struct vg_mesh *on, size_t n,
                           const double (*x)[3], int threads,
                           const struct vg_stop *stop, uint32_t *tri,
                           double (*foot)[3], struct vg_error *err)
{
  struct vg_ref ref = VG_REF_INIT;
  struct locating l = { &ref, x, tri, foot, stop };
  vg_status st;

  assert((x && tri && foot) || !n);
  if (!on->n_tri)
    return vg_fail(err, VG_ERR_INPUT,
                   "the surface to which points are "
                   "projected has no triangles");
  st = vg_ref_build_tree(&ref, on, stop, err);
  if (st >= 0) vg_parallel_for(threads, n, GRAIN, locate, &l);
  if (st >= 0) st = vg_stopped(stop, err);
  vg_ref_release(&ref);
  return st;
}

/* --- moving points back --------------------------------------------------- */

struct moving {
  struct vg_mesh *m;
  const double (*from)[3];
  uint8_t *stays;
  uint8_t *ring; /* [n_point] Ring number around intersecting triangles, from 1;
                    0: in no ring. */
  size_t n_refused;
};

static size_t return_point(struct moving *k, uint32_t p)
{
  if (k->stays[p]) return 0;
  k->stays[p] = 1;
  k->n_refused += vg_distance2(k->m->point[p], k->from[p]) > 0;
  memcpy(k->m->point[p], k->from[p], sizeof *k->from);
  return 1;
}

static size_t return_corners(struct moving *k, size_t t)
{
  size_t n = 0;

  for (int i = 0; i < 3; i++) n += return_point(k, k->m->tri[t][i]);
  return n;
}

/* Move back the points in the first n rings around the marked points. */
static void return_rings(struct moving *k, uint8_t n)
{
  for (uint8_t ring = 1; ring <= n; ring++)
    for (size_t t = 0; t < k->m->n_tri; t++) {
      const uint32_t *v = k->m->tri[t];

      if (k->ring[v[0]] != ring && k->ring[v[1]] != ring &&
          k->ring[v[2]] != ring)
        continue;
      for (int i = 0; i < 3; i++)
        if (!k->ring[v[i]]) k->ring[v[i]] = (uint8_t)(ring + 1);
    }
  for (uint32_t p = 0; p < k->m->n_point; p++)
    if (k->ring[p]) return_point(k, p);
}

static void normal(const double (*x)[3], const uint32_t *v, double n[3])
{
  double a[3], b[3];

  vg_sub(x[v[1]], x[v[0]], a);
  vg_sub(x[v[2]], x[v[0]], b);
  vg_cross(a, b, n);
}

static int is_bad(const struct moving *k, size_t t)
{
  const uint32_t *v = k->m->tri[t];
  const double(*x)[3] = (const double(*)[3])k->m->point;
  double before[3], after[3], was, is;

  if (k->stays[v[0]] && k->stays[v[1]] && k->stays[v[2]]) return 0;
  normal(k->from, v, before);
  normal(x, v, after);
  if (vg_dot(before, after) <= TURN * vg_norm(before) * vg_norm(after))
    return 1;
  is = vg_form_shape(NULL, x[v[0]], x[v[1]], x[v[2]]);
  was = vg_form_shape(NULL, k->from[v[0]], k->from[v[1]], k->from[v[2]]);
  return is < SLIVER && is < LOSS * was;
}

static void return_bad(struct moving *k)
{
  for (size_t n = 1; n;) {
    n = 0;
    for (size_t t = 0; t < k->m->n_tri; t++)
      if (is_bad(k, t)) n += return_corners(k, t);
  }
}

static vg_status return_meeting(struct moving *k, int rings, int threads,
                                const struct vg_stop *stop, size_t *n,
                                struct vg_error *err)
{
  const struct vg_surface_check_options o = {
    .threads = threads, .stop = stop ? *stop : (struct vg_stop){ NULL, NULL }
  };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  vg_status st = vg_surface_check(k->m, &o, &r, err);

  *n = 0;
  memset(k->ring, 0, k->m->n_point);
  for (size_t i = 0; st >= 0 && i < r.n_defect; i++)
    for (int j = 0; j < 2; j++) {
      const size_t f = r.defect[i].face[j];

      if ((r.defect[i].kind != VG_DEFECT_INTERSECTION &&
           r.defect[i].kind != VG_DEFECT_DEGENERATE_TRIANGLE &&
           r.defect[i].kind != VG_DEFECT_NONMANIFOLD_EDGE &&
           r.defect[i].kind != VG_DEFECT_DUPLICATE_TRIANGLE) ||
          f == SIZE_MAX)
        continue;
      *n += return_corners(k, f);
      for (int c = 0; c < 3; c++) k->ring[k->m->tri[f][c]] = 1;
    }
  if (*n && rings) return_rings(k, rings);
  vg_surface_report_release(&r);
  return st;
}

vg_status vg_remesh_put_back(struct vg_mesh *m, const double (*to)[3],
                             int threads, const struct vg_stop *stop,
                             uint8_t *stays, size_t *n_refused,
                             struct vg_error *err)
{
  assert((to && stays) || !m->n_point);
  assert(n_refused && threads >= 0);

  double(*from)[3] = vg_alloc(m->n_point, sizeof *from);
  struct moving k = { m, (const double(*)[3])from, stays,
                      vg_alloc(m->n_point, 1), 0 };
  size_t n = 1;
  vg_status st = VG_OK;

  if (!from || !k.ring) {
    free(from);
    free(k.ring);
    return vg_fail_memory(err, "the points of the surface");
  }
  memcpy(from, m->point, m->n_point * sizeof *from);
  for (size_t p = 0; p < m->n_point; p++)
    if (!stays[p]) memcpy(m->point[p], to[p], sizeof *to);
  for (int round = 0; n; round++) {
    if (round == ROUNDS)
      for (uint32_t p = 0; p < m->n_point; p++) return_point(&k, p);
    return_bad(&k);
    VG_TRY(return_meeting(&k, round < TIGHT ? 0 : 1 << (round - TIGHT), threads,
                          stop, &n, err));
  }
  *n_refused = k.n_refused;
done:
  if (st < 0) memcpy(m->point, from, m->n_point * sizeof *from);
  free(from);
  free(k.ring);
  return st;
}
