/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/flow/half.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/farfield.h"
#include "core/domain/open_edges.h"
#include "core/domain/planar.h"
#include "core/geometry/vector.h"

#define ZERO 1e-3 /* F4: of the length: a plane this near is at 0 */
#define FLAT 0.7  /* cosine of 45 degrees: inclination of an uneven root */
#define WALL 0.3  /* cosine of 73 degrees: a wall next to an uneven root */

void vg_flow_cap_release(struct vg_flow_cap *cap)
{
  free(cap->tri);
  memset(cap, 0, sizeof *cap);
  cap->axis = -1;
}

struct box {
  double lo[3], hi[3], length;
};

static struct box box_of(const struct vg_mesh *m)
{
  struct box b;

  vg_mesh_bounds(m, b.lo, b.hi);
  b.length = 0;
  for (int k = 0; k < 3; k++) b.length = fmax(b.length, b.hi[k] - b.lo[k]);
  return b;
}

/* Is the triangle in the plane? Points of a triangle that is nearly parallel to
 * it may be as far away as `wide`. */
static int is_in_plane(const struct vg_mesh *m, size_t t, int axis, double at,
                       double near, double wide)
{
  const uint32_t *v = m->tri[t];
  double off = 0, u[3], w[3], n[3];

  for (int k = 0; k < 3; k++) off = fmax(off, fabs(m->point[v[k]][axis] - at));
  if (off <= near || off > wide) return off <= near;
  vg_sub(m->point[v[1]], m->point[v[0]], u);
  vg_sub(m->point[v[2]], m->point[v[0]], w);
  vg_cross(u, w, n);
  return fabs(n[axis]) >= FLAT * vg_norm(n);
}

/* Mark the triangles in the plane of the cap, as is_in_plane; with
 * symmetry_only, only those of symmetry planes. */
static void mark_cap(const struct vg_mesh *m, double near, double wide,
                     int symmetry_only, struct vg_flow_cap *cap)
{
  cap->n_tri = 0;
  for (size_t t = 0; t < m->n_tri; t++) {
    cap->tri[t] = is_in_plane(m, t, cap->axis, cap->at, near, wide) &&
                  (!symmetry_only ||
                   vg_flow_role_of(&m->patch[m->tri_patch[t]]) ==
                     VG_ROLE_SYMMETRY);
    cap->n_tri += cap->tri[t];
  }
}

/* Copy m without the cap; its points stay. */
static vg_status without_cap(const struct vg_mesh *m,
                             const struct vg_flow_cap *cap, struct vg_mesh *out,
                             struct vg_error *err)
{
  size_t n = 0;
  vg_status st = vg_mesh_copy(out, m, err);

  if (st < 0) return st;
  for (size_t t = 0; t < m->n_tri; t++) {
    if (cap->tri[t]) continue;
    memcpy(out->tri[n], m->tri[t], sizeof *out->tri);
    out->tri_patch[n++] = m->tri_patch[t];
  }
  out->n_tri = n;
  return VG_OK;
}

/* Does the surface continue steeply from the plane of the cap? And does the cap
 * look like a root, unless the user says so? */
static vg_status is_half(const struct vg_mesh *m, const struct vg_flow_cap *cap,
                         double near, int is_given, int *half,
                         struct vg_error *err)
{
  struct vg_mesh open = VG_MESH_INIT;
  vg_status st;

  *half = 0;
  VG_TRY(without_cap(m, cap, &open, err));
  *half = vg_domain_is_steep(&open, cap->axis, cap->at, near);
  if (*half && !is_given)
    VG_TRY(vg_flow_looks_like_root(m, &open, cap, half, err));
done:
  vg_mesh_release(&open);
  return st;
}

/* Are all triangles of symmetry planes in the cap? */
static int has_symmetry(const struct vg_mesh *m, const struct vg_flow_cap *cap)
{
  for (size_t t = 0; t < m->n_tri; t++)
    if (!cap->tri[t] &&
        vg_flow_role_of(&m->patch[m->tri_patch[t]]) == VG_ROLE_SYMMETRY)
      return 0;
  return cap->n_tri > 0;
}

/* The cap at an end of axis k that the user names: the one at 0; or that at the
 * end next to 0, since the other one is a tip; or, if the body is on both sides
 * of 0, the larger one. */
static vg_status find_given(const struct vg_mesh *m, int k,
                            struct vg_flow_cap *cap, int *found,
                            struct vg_error *err)
{
  const struct box b = box_of(m);
  const double near = VG_HALF_NEAR * b.length, wide = VG_ROOT_OFF * b.length;
  double best = -1, at = 0;
  vg_status st = VG_OK;

  cap->axis = k;
  for (int end = 0; end < 2; end++) {
    double area = 0;
    int half;

    cap->at = end ? b.hi[k] : b.lo[k];
    if (end ? b.lo[k] >= -wide : b.hi[k] <= wide) continue;
    mark_cap(m, near, wide, 0, cap);
    if (!cap->n_tri) continue;
    VG_TRY(is_half(m, cap, wide, 1, &half, err));
    for (size_t t = 0; t < m->n_tri && half; t++)
      if (cap->tri[t])
        area += vg_triangle_area(m->point[m->tri[t][0]], m->point[m->tri[t][1]],
                                 m->point[m->tri[t][2]]);
    if (area > 0 && fabs(cap->at) <= wide) area = INFINITY;
    if (!half || area <= best) continue;
    best = area;
    at = cap->at;
  }
  *found = best > 0;
  cap->at = at;
  if (*found) mark_cap(m, near, wide, 0, cap);
  if (fabs(at) <= near) cap->at = 0;
done:
  return st;
}

vg_status vg_flow_find_cap(const struct vg_mesh *m, enum vg_flow_half half,
                           struct vg_flow_cap *cap, int *by_condition,
                           struct vg_error *err)
{
  assert(cap && by_condition);

  const struct box b = box_of(m);
  const double near = VG_HALF_NEAR * b.length;
  int found = 0;
  vg_status st = VG_OK;

  *by_condition = 0;
  cap->tri = vg_alloc(m->n_tri, 1);
  if (!cap->tri) VG_TRY(vg_fail_memory(err, "the cap of a half model"));
  for (int pass = 0; pass < 2 && !found; pass++)
    for (int end = 0; end < 6 && !found; end++) {
      const int axis = (end / 2 + 1) % 3; /* y first: the most common */

      if (half >= VG_HALF_X && (pass || axis != (int)half - VG_HALF_X))
        continue;
      cap->axis = axis;
      cap->at = end % 2 ? b.hi[axis] : b.lo[axis];
      if (fabs(cap->at) <= near) cap->at = 0;
      if (pass && fabs(cap->at) > ZERO * b.length) continue;
      if (!(b.hi[axis] - b.lo[axis] > 4 * near)) continue;
      mark_cap(m, near, near, !pass, cap);
      if (!cap->n_tri) continue;
      if (!pass) found = *by_condition = has_symmetry(m, cap);
      else VG_TRY(is_half(m, cap, near, 0, &found, err));
    }
  if (!found && half >= VG_HALF_X)
    VG_TRY(find_given(m, (int)half - VG_HALF_X, cap, &found, err));
done:
  if (!found) vg_flow_cap_release(cap);
  return st;
}

vg_status vg_flow_mirror(const struct vg_mesh *m, int axis, double at,
                         struct vg_mesh *out, struct vg_error *err)
{
  assert(axis >= 0 && axis < 3 && !out->point && !out->tri);

  const size_t n = m->n_point;
  struct vg_border rim = VG_BORDER_INIT;
  uint32_t *image = vg_calloc(n, sizeof *image);
  vg_status st = VG_OK;

  if (!image) VG_TRY(vg_fail_memory(err, "the mirror image"));
  VG_TRY(vg_open_edges(m, &rim, err));
  for (size_t i = 0; i < 2 * rim.n; i++) image[rim.edge[i / 2][i % 2]] = 1;
  out->point = vg_alloc(2 * n, sizeof *out->point);
  out->tri = vg_alloc(2 * m->n_tri, sizeof *out->tri);
  out->tri_patch = vg_alloc(2 * m->n_tri, sizeof *out->tri_patch);
  out->patch = vg_alloc(m->n_patch, sizeof *out->patch);
  if (!out->point || !out->tri || !out->tri_patch || !out->patch)
    VG_TRY(vg_fail_memory(err, "the mirror image"));
  memcpy(out->point, m->point, n * sizeof *out->point);
  memcpy(out->patch, m->patch, m->n_patch * sizeof *out->patch);
  out->n_patch = m->n_patch;
  out->n_point = n;
  for (size_t i = 0; i < n; i++) {
    double *x = out->point[out->n_point];

    if (image[i]) {
      image[i] = (uint32_t)i;
      continue;
    }
    memcpy(x, m->point[i], sizeof *out->point);
    x[axis] = 2 * at - x[axis];
    image[i] = (uint32_t)out->n_point++;
  }
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t *v = m->tri[t];
    uint32_t *w = out->tri[m->n_tri + t];

    memcpy(out->tri[t], v, sizeof *out->tri);
    w[0] = image[v[0]];
    w[1] = image[v[2]];
    w[2] = image[v[1]];
    out->tri_patch[t] = out->tri_patch[m->n_tri + t] = m->tri_patch[t];
  }
  out->n_tri = 2 * m->n_tri;
done:
  vg_border_release(&rim);
  free(image);
  return st;
}
