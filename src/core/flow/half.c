/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/flow/half.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/planar.h"
#include "core/geometry/vector.h"

#define NEAR 1e-5 /* S5: of the length: points this near are in a plane */
#define ZERO 1e-3 /* F4: of the length: a plane this near is at 0 */

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

static int is_in_plane(const struct vg_mesh *m, size_t t, int axis, double at,
                       double near)
{
  for (int k = 0; k < 3; k++)
    if (fabs(m->point[m->tri[t][k]][axis] - at) > near) return 0;
  return 1;
}

/* Mark the triangles in the plane; with symmetry_only, only those of symmetry
 * planes. */
static void mark_cap(const struct vg_mesh *m, int axis, double at, double near,
                     int symmetry_only, struct vg_flow_cap *cap)
{
  cap->axis = axis;
  cap->at = at;
  cap->n_tri = 0;
  for (size_t t = 0; t < m->n_tri; t++) {
    cap->tri[t] = is_in_plane(m, t, axis, at, near) &&
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

/* Does the surface meet the plane of the cap like half of a symmetric body? */
static vg_status is_half(const struct vg_mesh *m, const struct vg_flow_cap *cap,
                         int *half, struct vg_error *err)
{
  struct vg_mesh open = VG_MESH_INIT;
  int axis = -1;
  double at;
  vg_status st;

  *half = 0;
  VG_TRY(without_cap(m, cap, &open, err));
  if (open.n_tri) VG_TRY(vg_domain_half(&open, 0, &axis, &at, err));
  *half = axis == cap->axis;
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

vg_status vg_flow_find_cap(const struct vg_mesh *m, enum vg_flow_half half,
                           struct vg_flow_cap *cap, int *by_condition,
                           struct vg_error *err)
{
  assert(cap && by_condition);

  const struct box b = box_of(m);
  const double near = NEAR * b.length;
  int found = 0;
  vg_status st = VG_OK;

  *by_condition = 0;
  cap->tri = vg_alloc(m->n_tri, 1);
  if (!cap->tri) VG_TRY(vg_fail_memory(err, "the cap of a half model"));
  for (int pass = 0; pass < 2 && !found; pass++)
    for (int end = 0; end < 6 && !found; end++) {
      const int axis = (end / 2 + 1) % 3; /* y first: the most common */
      double at = end % 2 ? b.hi[axis] : b.lo[axis];

      if (fabs(at) <= near) at = 0;
      if (half >= VG_HALF_X && axis != (int)half - VG_HALF_X) continue;
      if (pass && half < VG_HALF_X && fabs(at) > ZERO * b.length) continue;
      if (!(b.hi[axis] - b.lo[axis] > 4 * near)) continue;
      mark_cap(m, axis, at, near, !pass, cap);
      if (!cap->n_tri) continue;
      if (!pass) found = *by_condition = has_symmetry(m, cap);
      else VG_TRY(is_half(m, cap, &found, err));
    }
done:
  if (!found) vg_flow_cap_release(cap);
  return st;
}

vg_status vg_flow_mirror(const struct vg_mesh *m, int axis, double at,
                         struct vg_mesh *out, struct vg_error *err)
{
  assert(axis >= 0 && axis < 3 && !out->point && !out->tri);

  const double near = NEAR * box_of(m).length;
  const size_t n = m->n_point;
  uint32_t *image = vg_alloc(n, sizeof *image);
  vg_status st = image ? VG_OK : vg_fail_memory(err, "the mirror image");

  if (st < 0) goto done;
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

    image[i] = (uint32_t)i;
    if (fabs(m->point[i][axis] - at) <= near) continue;
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
  free(image);
  return st;
}
