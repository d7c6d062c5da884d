/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Improves triangles without adding points. A copy of the triangles is changed
 * and then tested for intersections. Points of intersecting triangles are
 * locked, and the changes start again from the input. Every round locks more
 * points, so that the rounds end. */
#include "core/surface/surface_swap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/geometry/triangles.h"
#include "core/mesh/mesh_defects.h"
#include "core/search/box_pairs.h"
#include "core/surface/surface_parts.h"
#include "core/surface/surface_swap_parts.h"

#define ROUNDS 16 /* then the surface stays unchanged */
#define PASSES 8  /* of collapses, each followed by swaps */

struct job {
  struct vg_swapper w;
  const struct vg_mesh *m;
  struct vg_error *err;
  uint32_t *same; /* [n_point] Identity map: no points are merged. */
  struct vg_faces s;
  struct vg_edges e;
  struct vg_box_tree tree;
  uint32_t (*fan)[3];
  size_t n_locked; /* Points locked in this round. */
};

static void release_topology(struct job *j)
{
  vg_faces_release(&j->s);
  vg_edges_release(&j->e);
  vg_box_tree_release(&j->tree);
  free(j->fan);
  j->fan = NULL;
}

static void release(struct job *j)
{
  struct vg_swapper *w = &j->w;

  release_topology(j);
  free(j->same);
  free(w->tri);
  free(w->mate);
  free(w->moved);
  free(w->changed);
  free(w->locked);
  free(w->removed);
  free(w->queue);
  free(w->queued);
  free(w->mark);
}

/* --- input ---------------------------------------------------------------- */

/* By its series: cos() may differ between machines. */
static double cosine_of(double degrees)
{
  double x = degrees * (3.14159265358979323846 / 180), term = 1, sum = 1;

  for (int k = 1; k < 12; k++) {
    term *= -x * x / ((2 * k - 1) * (2 * k));
    sum += term;
  }
  return sum;
}

static vg_status check_options(const struct vg_swap_options *o,
                               struct vg_error *err)
{
  if (!(o->distance >= 0) || isinf(o->distance))
    return vg_fail(err, VG_ERR_INPUT,
                   "swaps may move the surface by %g of the length of a "
                   "triangle: this fraction must be 0 or a small positive "
                   "number",
                   o->distance);
  if (!(o->angle >= 0 && o->angle < 90))
    return vg_fail(err, VG_ERR_INPUT,
                   "swaps may turn normals by %g degrees: this angle must be "
                   "at least 0 and less than 90",
                   o->angle);
  if (!(o->short_edge >= 0 && o->short_edge < 1))
    return vg_fail(err, VG_ERR_INPUT,
                   "edges count as short below %g of the length of their "
                   "neighbours: this fraction must be at least 0 and less "
                   "than 1",
                   o->short_edge);
  return VG_OK;
}

static vg_status check_kind(const struct vg_mesh *m, struct vg_error *err)
{
  if (m->n_quad)
    return vg_fail(err, VG_ERR_INPUT,
                   "the surface has %zu quadrilaterals: "
                   "only triangles can be swapped, split them first",
                   m->n_quad);
  if (m->n_tet || m->n_pyr || m->n_pri || m->n_hex)
    return vg_fail(err, VG_ERR_INPUT,
                   "the mesh has cells: the triangles of "
                   "its boundary cannot be swapped");
  return vg_mesh_check_index(m, err);
}

static vg_status allocate(struct job *j)
{
  struct vg_swapper *w = &j->w;
  size_t n = w->n_tri;

  w->tri = vg_alloc(n, sizeof *w->tri);
  w->mate = vg_alloc(n, 3 * sizeof *w->mate);
  w->moved = vg_alloc(n, sizeof *w->moved);
  w->changed = vg_alloc(n, 1);
  w->queue = vg_alloc(n, 3 * sizeof *w->queue);
  w->queued = vg_calloc(n, 3);
  w->locked = vg_calloc(w->n_point, 1);
  w->removed = vg_alloc(w->n_point, 1);
  w->mark = vg_calloc(w->n_point, sizeof *w->mark);
  j->same = vg_alloc(w->n_point, sizeof *j->same);
  if (!w->tri || !w->mate || !w->moved || !w->changed || !w->queue ||
      !w->queued || !w->locked || !w->removed || !w->mark || !j->same)
    return vg_fail_memory(j->err, "the swaps of the surface");
  for (size_t p = 0; p < w->n_point; p++) j->same[p] = (uint32_t)p;
  return VG_OK;
}

/* Faces and edges of the current triangles. */
static vg_status build_topology(struct job *j)
{
  struct vg_mesh view = *j->m;
  vg_status st;

  release_topology(j);
  view.tri = j->w.tri;
  VG_TRY(vg_faces_build(&j->s, &view, j->same, j->err));
  VG_TRY(vg_faces_edges(&j->s, &j->e, j->err));
done:
  return st;
}

static vg_status refuse_edge(const struct job *j, size_t edge, uint32_t n)
{
  uint32_t h = j->e.half[j->e.start[edge]];
  const double *p = j->m->point[vg_swap_from(&j->w, h)];
  const double *q = j->m->point[vg_swap_from(&j->w, vg_half_next(h))];

  return vg_fail(j->err, VG_ERR_INPUT,
                 "triangle %u: its edge at (%g %g %g) "
                 "%s: repair the surface before its triangles are swapped",
                 (unsigned)(h / 3 + 1), .5 * p[0] + .5 * q[0],
                 .5 * p[1] + .5 * q[1], .5 * p[2] + .5 * q[2],
                 n == 1   ? "has no neighbour"
                 : n == 2 ? "has a neighbour of opposite orientation"
                          : "has more than one neighbour");
}

static vg_status check_faces(const struct job *j)
{
  for (size_t t = 0; t < j->s.n; t++)
    if (j->s.state[t] & (VG_FACE_COLLAPSED | VG_FACE_NOT_FINITE)) {
      const double *p = j->m->point[j->m->tri[t][0]];

      return vg_fail(j->err, VG_ERR_INPUT,
                     "triangle %zu at (%g %g %g) %s: "
                     "repair the surface before its triangles are swapped",
                     t + 1, p[0], p[1], p[2],
                     j->s.state[t] & VG_FACE_COLLAPSED
                       ? "has a node twice"
                       : "has a node that is not finite");
    }
  return VG_OK;
}

static vg_status pair_halves(struct job *j)
{
  for (size_t i = 0; i < j->e.n; i++) {
    uint32_t at = j->e.start[i], n = j->e.start[i + 1] - at;

    if (n != 2 || vg_faces_disagree(&j->s, &j->e, i))
      return refuse_edge(j, i, n);
    vg_half_pair(&j->w, j->e.half[at], j->e.half[at + 1]);
  }
  return VG_OK;
}

static vg_status begin(struct job *j)
{
  struct vg_swapper *w = &j->w;
  vg_status st = VG_OK;

  memcpy(w->tri, j->m->tri, w->n_tri * sizeof *w->tri);
  memset(w->changed, 0, w->n_tri);
  memset(w->removed, 0, w->n_point);
  for (size_t t = 0; t < w->n_tri; t++) w->moved[t] = 0;
  w->n_swapped = w->n_collapsed = 0;
  w->moved_max = w->moved_relative = 0;
  w->head = w->n_queue = 0;
  memset(w->queued, 0, 3 * w->n_tri);
  VG_TRY(build_topology(j));
  VG_TRY(check_faces(j));
  VG_TRY(pair_halves(j));
done:
  return st;
}

/* --- test for intersections ----------------------------------------------- */

static void lock(struct job *j, uint32_t t)
{
  struct vg_swapper *w = &j->w;

  if (!w->changed[t]) return;
  for (int k = 0; k < 3; k++) {
    j->n_locked += !w->locked[w->tri[t][k]];
    w->locked[w->tri[t][k]] = 1;
  }
}

static vg_status test_pair(void *context, int worker, uint32_t f, uint32_t g)
{
  struct job *j = context;
  const uint32_t(*fan)[3] = (const uint32_t(*)[3])j->fan;

  (void)worker;
  if (!j->w.changed[f] && !j->w.changed[g]) return VG_OK;
  if (!vg_triangles_meet(j->s.point, j->s.node[f], j->s.node[g], fan[f],
                         fan[g]))
    return VG_OK;
  lock(j, f);
  lock(j, g);
  return VG_OK;
}

/* Lock points at edges that occur twice, where the surface touches itself at a
 * node. */
static void test_edges(struct job *j)
{
  for (size_t i = 0; i < j->e.n; i++) {
    uint32_t at = j->e.start[i], end = j->e.start[i + 1];

    if (end - at == 2) continue;
    for (; at < end; at++) lock(j, j->e.half[at] / 3);
  }
}

static void test_faces(struct job *j)
{
  for (uint32_t t = 0; t < j->s.n; t++)
    if (j->s.state[t] & VG_FACE_FLAT) lock(j, t);
}

/* Lock the points of changed triangles that intersect any other triangle. */
static vg_status test(struct job *j)
{
  vg_status st;

  j->n_locked = 0;
  VG_TRY(build_topology(j));
  test_faces(j);
  test_edges(j);
  VG_TRY(vg_label_fans(&j->s, &j->e, &j->fan, j->err));
  VG_TRY(vg_faces_tree(&j->tree, &j->s, j->err));
  VG_TRY(vg_box_tree_pairs(&j->tree, 1, test_pair, j));
done:
  return st;
}

/* --- all rounds ----------------------------------------------------------- */

static void count_slivers(const struct vg_swapper *w, size_t *n_cap,
                          size_t *n_needle)
{
  *n_cap = *n_needle = 0;
  for (size_t t = 0; t < w->n_tri; t++) {
    struct vg_tri_shape s;

    if (vg_tri_removed(w, t)) continue;
    vg_tri_shape_of(w->point[w->tri[t][0]], w->point[w->tri[t][1]],
                    w->point[w->tri[t][2]], &s);
    if (vg_tri_shape_sound(&s)) continue;
    if (vg_tri_shape_cap(&s)) ++*n_cap;
    else ++*n_needle;
  }
}

static void swap_all(struct vg_swapper *w, int caps_only)
{
  w->caps_only = caps_only;
  for (uint32_t h = 0; h < 3 * w->n_tri; h++)
    if (h < w->mate[h]) vg_swap_push(w, h);
  vg_swap_edges(w);
}

/* Short edges and caps come first: they need most of the permitted movement,
 * and collapsing the apex of a cap moves the surface less than swapping its
 * edge. */
static vg_status change(struct job *j)
{
  size_t n = 0;
  vg_status st = VG_OK;

  if (j->w.o->collapse) VG_TRY(vg_swap_points(&j->w, &n, j->err));
  swap_all(&j->w, 1);
  swap_all(&j->w, 0);
  for (int i = 0; i < PASSES && j->w.o->collapse; i++) {
    VG_TRY(vg_swap_points(&j->w, &n, j->err));
    if (!n) break;
    vg_swap_edges(&j->w);
  }
done:
  return st;
}

/* Compute the improved triangles in j->w, with up to ROUNDS attempts. */
static vg_status improve(struct job *j)
{
  vg_status st = VG_OK;

  for (int round = 0; round < ROUNDS; round++) {
    VG_TRY(begin(j));
    VG_TRY(change(j));
    if (!j->w.n_swapped && !j->w.n_collapsed) goto done;
    VG_TRY(test(j));
    if (!j->n_locked) goto done;
  }
  memset(j->w.locked, 1, j->w.n_point);
  VG_TRY(begin(j));
done:
  return st;
}

static void commit(struct job *j, struct vg_mesh *m)
{
  struct vg_swapper *w = &j->w;
  uint8_t *drop = w->changed;

  memcpy(m->tri, w->tri, m->n_tri * sizeof *m->tri);
  if (!w->n_collapsed) return;
  for (size_t t = 0; t < w->n_tri; t++) drop[t] = vg_tri_removed(w, t);
  vg_mesh_drop_tri(m, drop);
  for (size_t p = 0; p < w->n_point; p++) w->removed[p] = !w->removed[p];
  vg_mesh_renumber(m, j->same, w->removed); /* now: points to keep */
}

static void report(const struct vg_swapper *w, struct vg_swap_report *r)
{
  r->n_swapped = w->n_swapped;
  r->n_collapsed = w->n_collapsed;
  r->moved = w->moved_max;
  r->moved_relative = w->moved_relative;
  for (size_t p = 0; p < w->n_point; p++) r->n_kept += w->locked[p];
  count_slivers(w, &r->n_cap[1], &r->n_needle[1]);
}

vg_status vg_surface_swap(struct vg_mesh *m, const struct vg_swap_options *o,
                          struct vg_swap_report *r, struct vg_error *err)
{
  struct vg_swap_report found = VG_SWAP_REPORT_INIT;
  struct job j;
  int is_closed;
  vg_status st;

  memset(&j, 0, sizeof j);
  VG_TRY(check_options(o, err));
  VG_TRY(check_kind(m, err));
  j.m = m;
  j.err = err;
  j.w.o = o;
  j.w.cosine = cosine_of(o->angle);
  j.w.n_point = m->n_point;
  j.w.n_tri = m->n_tri;
  j.w.point = (const double(*)[3])m->point;
  j.w.patch = m->tri_patch;
  VG_TRY(allocate(&j));
  if (m->n_tri) {
    memcpy(j.w.tri, m->tri, m->n_tri * sizeof *m->tri);
    count_slivers(&j.w, &found.n_cap[0], &found.n_needle[0]);
    VG_TRY(improve(&j));
    report(&j.w, &found);
    is_closed = VG_CHECKS_ON && !vg_mesh_open_edges(m);
    commit(&j, m);
    if (is_closed) VG_CHECK("the swaps of a surface", vg_mesh_open_edges(m));
  }
  if (r) *r = found;
done:
  release(&j);
  return st;
}
