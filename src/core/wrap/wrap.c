#include "core/wrap/wrap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/vector.h"
#include "core/surface/surface_check.h"
#include "core/wrap/wrap_parts.h"

#define CLOSED 2.5        /* S44: triangles over area / size^2 */
#define OPEN 15.0         /* where both sides of a sheet are wrapped */
#define CRACK 1e-3        /* of the size: narrower rims are none */
#define RIM 6.0           /* sizes: length of a rim that is gone through */
#define REACH 1.5         /* S41: of the offset: farther, a gap was bridged */

static double area(const struct vg_mesh *m)
{
  double sum = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    double u[3], v[3], n[3];

    vg_sub(m->point[m->tri[i][1]], m->point[m->tri[i][0]], u);
    vg_sub(m->point[m->tri[i][2]], m->point[m->tri[i][0]], v);
    vg_cross(u, v, n);
    sum += vg_norm(n) / 2;
  }
  return sum;
}

static vg_status check(const struct vg_mesh *m, double size,
                       struct vg_error *err)
{
  if (!(size > 0) || !isfinite(size))
    return vg_fail(err, VG_ERR_INPUT, "a wrap of size %g: it must be > 0",
                   size);
  if (!m->n_tri || m->n_quad || m->n_tet || m->n_pyr || m->n_pri || m->n_hex)
    return vg_fail(err, VG_ERR_INPUT, "only triangles can be wrapped");
  for (size_t i = 0; i < m->n_tri; i++) {
    int good = m->tri_patch[i] < m->n_patch;

    for (int k = 0; k < 3; k++) good &= m->tri[i][k] < m->n_point;
    if (!good)
      return vg_fail(err, VG_ERR_INPUT, "triangle %zu: an index is out of "
                     "range", i + 1);
  }
  return VG_OK;
}

/* Length of the edges with one triangle, cracks left out. */
static vg_status measure_rims(const struct vg_mesh *in, double size,
                              double *length, struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_key *s = NULL;
  size_t n;
  vg_status st;

  *length = 0;
  VG_TRY(vg_mesh_copy(&m, in, err));
  VG_TRY(vg_surface_weld(&m, CRACK * size, NULL, NULL, err));
  n = 3 * m.n_tri;
  s = vg_alloc(n, sizeof *s);
  if (!s) VG_TRY(vg_fail_memory(err, "a wrap"));
  for (size_t i = 0; i < n; i++) {
    uint64_t a = m.tri[i / 3][i % 3], b = m.tri[i / 3][(i + 1) % 3];

    s[i] = (struct vg_key){ a < b ? a << 32 | b : b << 32 | a, 0 };
  }
  VG_TRY(vg_sort_keys(n, s, err));
  for (size_t i = 0; i < n; i++)
    if ((!i || s[i - 1].key != s[i].key)
        && (i + 1 == n || s[i].key != s[i + 1].key))
      *length += vg_distance(m.point[s[i].key >> 32],
                             m.point[(uint32_t)s[i].key]);
done:
  free(s);
  vg_mesh_release(&m);
  return st;
}

/* What would take hours is refused. */
static vg_status check_number(const struct vg_mesh *m, double size,
                              struct vg_error *err)
{
  double rims, n = CLOSED * area(m) / (size * size);
  int is_open = 0;
  vg_status st = VG_OK;

  if (n < VG_WRAP_MOST) {
    VG_TRY(measure_rims(m, size, &rims, err));
    is_open = rims > RIM * size;
    if (is_open) n *= OPEN / CLOSED;
  }
  if (n > VG_WRAP_MOST)
    return vg_fail(err, VG_ERR_INPUT, "a wrap of size %g would have some %.2g "
                   "triangles%s, and %.2g are the most; is it in the unit of "
                   "the surface? Sizes from %.2g on will do", size, n,
                   is_open ? ", as it goes through holes and lies on both "
                   "sides of the surface" : "", VG_WRAP_MOST,
                   1.05 * size * sqrt(n / VG_WRAP_MOST));
done:
  return st;
}

/* Patches that had triangles, and have none. */
static vg_status count_empty(const struct vg_mesh *before,
                             const struct vg_mesh *after, size_t *n,
                             struct vg_error *err)
{
  size_t *had = vg_calloc(before->n_patch, sizeof *had);

  *n = 0;
  if (!had) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < before->n_tri; i++) had[before->tri_patch[i]] = 1;
  for (size_t i = 0; i < after->n_tri; i++) had[after->tri_patch[i]] = 0;
  for (size_t i = 0; i < before->n_patch; i++) *n += had[i];
  free(had);
  return VG_OK;
}

/* Triangles get the patch of the nearest one of the input. */
static vg_status label(const struct vg_mesh *m, struct vg_mesh *out,
                       const struct vg_stop *stop, struct vg_wrap_report *r,
                       struct vg_error *err)
{
  size_t n = out->n_point + out->n_tri;
  double (*x)[3] = vg_alloc(2 * n, sizeof *x);
  uint32_t *near = vg_alloc(n, sizeof *near);
  vg_status st;

  if (!x || !near) VG_TRY(vg_fail_memory(err, "a wrap"));
  memcpy(x, out->point, out->n_point * sizeof *x);
  for (size_t i = 0; i < out->n_tri; i++)
    for (int k = 0; k < 3; k++)
      x[out->n_point + i][k] = (out->point[out->tri[i][0]][k]
                                + out->point[out->tri[i][1]][k]
                                + out->point[out->tri[i][2]][k]) / 3;
  VG_TRY(vg_wrap_nearest(m, n, (const double (*)[3])x, stop, x + n, near,
                         err));
  for (size_t i = 0; i < n; i++) {
    double d = vg_distance(x[i], x[n + i]);

    if (d <= r->distance) continue;
    r->distance = d;
    memcpy(r->at, x[i], sizeof r->at);
  }
  for (size_t i = 0; i < out->n_tri; i++)
    out->tri_patch[i] = m->tri_patch[near[out->n_point + i]];
done:
  free(x);
  free(near);
  return st;
}

/* Points onto the input. */
static vg_status fit(const struct vg_mesh *m, struct vg_mesh *out,
                     const struct vg_stop *stop, struct vg_wrap_report *r,
                     struct vg_error *err)
{
  const double most = REACH * r->offset;
  double (*near)[3] = vg_alloc(out->n_point, sizeof *near);
  uint32_t *tri = vg_alloc(out->n_point, sizeof *tri);
  vg_status st;

  if (!near || !tri) VG_TRY(vg_fail_memory(err, "a wrap"));
  VG_TRY(vg_wrap_nearest(m, out->n_point, (const double (*)[3])out->point,
                         stop, near, tri, err));
  VG_TRY(vg_wrap_zip(out, near, most, stop, &r->n_zip, err));
  VG_TRY(vg_wrap_fit(out, (const double (*)[3])near, most, stop, &r->n_fit,
                     err));
done:
  free(near);
  free(tri);
  return st;
}

vg_status vg_wrap(struct vg_mesh *m, double size, const struct vg_stop *stop,
                  struct vg_wrap_report *r, struct vg_error *err)
{
  struct vg_wrap_report report = { .offset = size * VG_WRAP_OFFSET };
  struct vg_mesh out = VG_MESH_INIT;
  vg_status st;

  VG_TRY(check(m, size, err));
  VG_TRY(check_number(m, size, err));
  VG_TRY(vg_wrap_cgal(m, size, report.offset, stop, &out, err));
  if (!out.n_tri) {
    st = vg_fail(err, VG_ERR_GEOMETRY, "nothing is left of a wrap of size %g: "
                 "it goes through the surface's holes; take a larger one",
                 size);
    goto done;
  }
  out.patch = m->patch;     /* borrowed, for the check */
  out.n_patch = m->n_patch;
  st = fit(m, &out, stop, &report, err);
  out.patch = NULL;
  out.n_patch = 0;
  if (st < 0) goto done;
  VG_TRY(label(m, &out, stop, &report, err));
  VG_TRY(count_empty(m, &out, &report.n_empty, err));
  out.patch = m->patch;
  out.n_patch = m->n_patch;
  m->patch = NULL;
  m->n_patch = 0;
  report.n_before = m->n_tri;
  vg_mesh_move(m, &out);
  report.n_point = m->n_point;
  *r = report;
done:
  vg_mesh_release(&out);
  return st;
}
