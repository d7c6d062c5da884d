#include "core/wrap/wrap.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/wrap/wrap_parts.h"

#define MOST_TRIANGLES 1e8
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
  double n;

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
  n = 4 * area(m) / (size * size);
  if (n > MOST_TRIANGLES)
    return vg_fail(err, VG_ERR_INPUT, "a wrap of size %g would have some %.2g "
                   "triangles; is it in the unit of the surface?", size, n);
  return VG_OK;
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

vg_status vg_wrap(struct vg_mesh *m, double size, const struct vg_stop *stop,
                  struct vg_wrap_report *r, struct vg_error *err)
{
  struct vg_wrap_report report = { .offset = size * VG_WRAP_OFFSET };
  struct vg_mesh out = VG_MESH_INIT;
  double (*near)[3] = NULL;
  vg_status st;

  VG_TRY(check(m, size, err));
  VG_TRY(vg_wrap_cgal(m, size, report.offset, stop, &out, &near, err));
  if (!out.n_tri) {
    st = vg_fail(err, VG_ERR_GEOMETRY, "nothing is left of a wrap of size %g: "
                 "it goes through the surface's holes; take a larger one",
                 size);
    goto done;
  }
  out.patch = m->patch;     /* borrowed, for the check */
  out.n_patch = m->n_patch;
  st = vg_wrap_fit(&out, (const double (*)[3])near, REACH * report.offset,
                   stop, &report.n_fit, err);
  out.patch = NULL;
  out.n_patch = 0;
  if (st < 0) goto done;
  VG_TRY(vg_wrap_label(m, &out, stop, &report, err));
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
  free(near);
  vg_mesh_release(&out);
  return st;
}
