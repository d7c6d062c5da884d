/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/flow/half.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/domain/planar.h"
#include "core/geometry/vector.h"

#define ZERO 1e-3 /* F4: of the length: a plane this near is at 0 */
/* F6 */
#define FLAT 0.9 /* cosine of 26 degrees: inclination of an uneven root */
#define FOLD 0.7 /* cosine of 45 degrees: a wall has smaller folds */
#define WALL 0.3 /* cosine of 73 degrees: a wall next to an uneven root */
#define OWN 0.9  /* of its area in the cap: a patch that is the cap */

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

/* Largest distance of a point of triangle t from the plane. */
static double off_plane(const struct vg_mesh *m, size_t t, int axis, double at)
{
  double off = 0;

  for (int k = 0; k < 3; k++)
    off = fmax(off, fabs(m->point[m->tri[t][k]][axis] - at));
  return off;
}

/* Cosine of the angle between triangle t and the plane. */
static double cosine(const struct vg_mesh *m, size_t t, int axis)
{
  const uint32_t *v = m->tri[t];
  double u[3], w[3], n[3], size;

  vg_sub(m->point[v[1]], m->point[v[0]], u);
  vg_sub(m->point[v[2]], m->point[v[0]], w);
  vg_cross(u, w, n);
  size = vg_norm(n);
  return size > 0 ? fabs(n[axis]) / size : 0;
}

/* Mark the triangles in the plane of the cap; with symmetry_only, only those of
 * symmetry planes. */
static void mark_cap(const struct vg_mesh *m, double near, int symmetry_only,
                     struct vg_flow_cap *cap)
{
  cap->n_tri = 0;
  for (size_t t = 0; t < m->n_tri; t++) {
    cap->tri[t] = off_plane(m, t, cap->axis, cap->at) <= near &&
                  (!symmetry_only ||
                   vg_flow_role_of(&m->patch[m->tri_patch[t]]) ==
                     VG_ROLE_SYMMETRY);
    cap->n_tri += cap->tri[t];
  }
}

/* --- uneven roots -------------------------------------------------------- */

struct root {
  const struct vg_mesh *m;
  struct vg_flow_cap *cap;
  double near, wide; /* Tolerances of planes and of roots. */
  uint32_t *up;      /* [n_point] Parts that points belong to. */
  uint8_t *far;      /* [n_point] Part with a point farther away than wide. */
  uint8_t *on_cap;   /* [n_point] */
  uint8_t *patch;    /* [n_patch] Patch that is partly in the cap, and within
                        the tolerance. */
};

static int is_within(const struct root *r, size_t t)
{
  return off_plane(r->m, t, r->cap->axis, r->cap->at) <= r->wide;
}

/* Join the points of each triangle that are not marked; then mark parts that
 * are farther away than wide. Triangles of the cap do not count. */
static void find_parts(struct root *r)
{
  const struct vg_mesh *m = r->m;

  memset(r->far, 0, m->n_point);
  for (uint32_t i = 0; i < m->n_point; i++) r->up[i] = i;
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && !r->cap->tri[t]; k++) {
      const uint32_t a = m->tri[t][k], b = m->tri[t][(k + 1) % 3];

      if (!r->on_cap[a] && !r->on_cap[b]) vg_union(r->up, a, b);
    }
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && !r->cap->tri[t] && !is_within(r, t); k++)
      if (!r->on_cap[m->tri[t][k]]) r->far[vg_root_of(r->up, m->tri[t][k])] = 1;
}

static int is_far(struct root *r, size_t t)
{
  for (int k = 0; k < 3; k++) {
    const uint32_t i = r->m->tri[t][k];

    if (!r->on_cap[i] && r->far[vg_root_of(r->up, i)]) return 1;
  }
  return !is_within(r, t);
}

static void mark_points(struct root *r)
{
  for (size_t t = 0; t < r->m->n_tri; t++)
    for (int k = 0; k < 3 && r->cap->tri[t]; k++)
      r->on_cap[r->m->tri[t][k]] = 1;
}

/* Mark the cap of an uneven root: triangles at the end of the body; those
 * within the tolerance that are nearly parallel to the plane; patches to which
 * these belong and that are within the tolerance; and what these enclose. A
 * body that is within the tolerance as a whole is no part of a root. */
static void mark_uneven(struct root *r, double end, uint8_t *body)
{
  const struct vg_mesh *m = r->m;
  struct vg_flow_cap *cap = r->cap;

  memset(cap->tri, 0, m->n_tri);
  memset(r->on_cap, 0, m->n_point);
  memset(r->patch, 1, m->n_patch);
  find_parts(r);
  for (size_t t = 0; t < m->n_tri; t++) {
    body[t] = (uint8_t)is_far(r, t);
    if (!body[t] || !is_within(r, t)) r->patch[m->tri_patch[t]] = 0;
  }
  for (size_t t = 0; t < m->n_tri; t++) {
    uint8_t *state = &r->patch[m->tri_patch[t]];

    cap->tri[t] = off_plane(m, t, cap->axis, end) <= r->near ||
                  (body[t] && is_within(r, t) &&
                   cosine(m, t, cap->axis) >= FLAT);
    if (cap->tri[t] && *state) *state = 2;
  }
  for (size_t t = 0; t < m->n_tri; t++)
    cap->tri[t] |= r->patch[m->tri_patch[t]] == 2;
  mark_points(r);
  find_parts(r);
  cap->n_tri = 0;
  for (size_t t = 0; t < m->n_tri; t++) {
    cap->tri[t] |= body[t] && !is_far(r, t);
    cap->n_tri += cap->tri[t];
  }
  mark_points(r);
}

static vg_status mark_root(const struct vg_mesh *m, double end, double near,
                           double wide, struct vg_flow_cap *cap,
                           struct vg_error *err)
{
  struct root r = { m, cap, near, wide, NULL, NULL, NULL, NULL };
  uint8_t *body = vg_alloc(m->n_tri, 1);
  vg_status st = VG_OK;

  cap->at = fabs(end) <= wide ? 0 : end;
  r.up = vg_alloc(m->n_point, sizeof *r.up);
  r.far = vg_alloc(m->n_point, 1);
  r.on_cap = vg_alloc(m->n_point, 1);
  r.patch = vg_alloc(m->n_patch, 1);
  if (!body || !r.up || !r.far || !r.on_cap || !r.patch)
    VG_TRY(vg_fail_memory(err, "the cap of a half model"));
  mark_uneven(&r, end, body);
done:
  free(body);
  free(r.up);
  free(r.far);
  free(r.on_cap);
  free(r.patch);
  return st;
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

static double area_of(const struct vg_mesh *m, size_t t)
{
  const uint32_t *v = m->tri[t];

  return vg_triangle_area(m->point[v[0]], m->point[v[1]], m->point[v[2]]);
}

/* Mark the points of the cap. Returns the distance by which it is uneven. */
static double points_of_cap(const struct vg_mesh *m,
                            const struct vg_flow_cap *cap, uint8_t *on_cap)
{
  double lo = INFINITY, hi = -INFINITY;

  for (size_t t = 0; t < m->n_tri; t++)
    for (int i = 0; i < 3 && cap->tri[t]; i++) {
      const double x = m->point[m->tri[t][i]][cap->axis];

      on_cap[m->tri[t][i]] = 1;
      lo = fmin(lo, x);
      hi = fmax(hi, x);
    }
  return hi - lo;
}

/* Triangle t is next to the cap and was not taken for a part of it. */
static vg_status refuse_root(const struct vg_mesh *m, size_t t,
                             const struct vg_flow_cap *cap, double wide,
                             struct vg_error *err)
{
  const int k = cap->axis;
  const double *x = m->point[m->tri[t][0]];

  for (int i = 1; i < 3; i++) {
    const double *y = m->point[m->tri[t][i]];

    if (fabs(y[k] - cap->at) > fabs(x[k] - cap->at)) x = y;
  }
  return vg_fail(err, VG_ERR_INPUT,
                 "half %c: the cap at the root is uneven: point (%.9g, %.9g, "
                 "%.9g) is %.3g off the plane %c = %g, and its triangle may "
                 "belong to the cap or to the wall next to it. Move the points "
                 "of the root into the plane%s",
                 "xyz"[k], x[0], x[1], x[2], fabs(x[k] - cap->at), "xyz"[k],
                 cap -> at,
                 fabs(x[k] - cap->at) <= wide
                   ? ", or give the cap a patch of its own"
                   : "");
}

/* Triangle t has an edge on the cap, but is not in it: the point beyond that
 * edge. */
static uint32_t apex_of(const uint32_t t[3], const uint8_t *on_cap)
{
  for (int i = 0; i < 3; i++)
    if (!on_cap[t[i]]) return t[i];
  return t[0];
}

/* Do triangles a and b have a common edge, at which they meet smoothly? */
static int is_smooth(const struct vg_mesh *m, size_t a, size_t b)
{
  double n[2][3], u[3], w[3];
  int common = 0;

  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) common += m->tri[a][i] == m->tri[b][k];
  for (int i = 0; i < 2; i++) {
    const uint32_t *v = m->tri[i ? b : a];

    vg_sub(m->point[v[1]], m->point[v[0]], u);
    vg_sub(m->point[v[2]], m->point[v[0]], w);
    vg_cross(u, w, n[i]);
  }
  return common == 2 &&
         vg_dot(n[0], n[1]) >= FOLD * vg_norm(n[0]) * vg_norm(n[1]);
}

/* Of a set of triangles next to the cap, remove those that continue in the
 * surface. at: [n_point] triangle with that apex; SIZE_MAX: none. */
static void drop_walls(const struct vg_mesh *m, const struct vg_flow_cap *cap,
                       size_t *at)
{
  for (size_t t = 0; t < m->n_tri; t++)
    for (int i = 0; i < 3 && !cap->tri[t]; i++) {
      size_t *s = &at[m->tri[t][i]];

      if (*s != SIZE_MAX && *s != t && is_smooth(m, t, *s)) *s = SIZE_MAX;
    }
}

/* Refuse a root of which only a part would be removed: with a triangle next to
 * it that is no clear wall of the body, or with a triangle of the patch that is
 * the cap. */
static vg_status check_root(const struct vg_mesh *m, double near, double wide,
                            const struct vg_flow_cap *cap, struct vg_error *err)
{
  uint8_t *on_cap = vg_calloc(m->n_point, 1);
  double(*area)[2] = vg_calloc(m->n_patch, sizeof *area);
  size_t *at = vg_alloc(m->n_point, sizeof *at);
  vg_status st = VG_OK;
  int is_uneven;

  if (!on_cap || !area || !at)
    VG_TRY(vg_fail_memory(err, "the cap of a half model"));
  memset(at, 0xff, m->n_point * sizeof *at);
  is_uneven = points_of_cap(m, cap, on_cap) > near;
  for (size_t t = 0; t < m->n_tri; t++)
    area[m->tri_patch[t]][cap->tri[t]] += area_of(m, t);
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t *v = m->tri[t];
    const double *a = area[m->tri_patch[t]];

    if (cap->tri[t] || on_cap[v[0]] + on_cap[v[1]] + on_cap[v[2]] < 2) continue;
    if (a[1] > OWN * (a[0] + a[1])) VG_TRY(refuse_root(m, t, cap, wide, err));
    if (off_plane(m, t, cap->axis, cap->at) > wide ||
        cosine(m, t, cap->axis) < WALL)
      continue;
    if (is_uneven) VG_TRY(refuse_root(m, t, cap, wide, err));
    at[apex_of(v, on_cap)] = t;
  }
  drop_walls(m, cap, at);
  for (size_t i = 0; i < m->n_point; i++)
    if (at[i] != SIZE_MAX) VG_TRY(refuse_root(m, at[i], cap, wide, err));
done:
  free(on_cap);
  free(area);
  free(at);
  return st;
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
    const double x = end ? b.hi[k] : b.lo[k];
    double area = 0;
    int half;

    if (end ? b.lo[k] >= -wide : b.hi[k] <= wide) continue;
    VG_TRY(mark_root(m, x, near, wide, cap, err));
    if (!cap->n_tri) continue;
    VG_TRY(is_half(m, cap, wide, 1, &half, err));
    for (size_t t = 0; t < m->n_tri && half; t++)
      if (cap->tri[t]) area += area_of(m, t);
    if (area > 0 && fabs(x) <= wide) area = INFINITY;
    if (!half || area <= best) continue;
    best = area;
    at = x;
  }
  *found = best > 0;
  if (!*found) goto done;
  VG_TRY(mark_root(m, at, near, wide, cap, err));
  VG_TRY(check_root(m, near, wide, cap, err));
  cap->at = fabs(at) <= near ? 0 : at;
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
      mark_cap(m, near, !pass, cap);
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
  uint32_t *image = vg_alloc(n, sizeof *image);
  uint8_t *rim = vg_calloc(n, 1);
  vg_status st = VG_OK;

  if (!image || !rim) VG_TRY(vg_fail_memory(err, "the mirror image"));
  VG_TRY(vg_domain_mark_open(m, rim, err));
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
    if (rim[i]) continue;
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
  free(rim);
  free(image);
  return st;
}
