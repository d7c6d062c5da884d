/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/wrap/wrap.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/mesh_defects.h"
#include "core/wrap/wrap_parts.h"

#define REACH 1.5 /* S41: of the offset: farther away a gap was bridged */

static vg_status check(const struct vg_mesh *m, double size,
                       struct vg_error *err)
{
  if (!(size > 0) || !isfinite(size))
    return vg_fail(err, VG_ERR_INPUT,
                   "wrap size %g: it must be positive and finite", size);
  if (!m->n_tri || m->n_quad || m->n_tet || m->n_pyr || m->n_pri || m->n_hex)
    return vg_fail(err, VG_ERR_INPUT, "only triangles can be wrapped");
  for (size_t i = 0; i < m->n_tri; i++) {
    int good = m->tri_patch[i] < m->n_patch;

    for (int k = 0; k < 3; k++) good &= m->tri[i][k] < m->n_point;
    if (!good)
      return vg_fail(err, VG_ERR_INPUT,
                     "triangle %zu: a point or patch index is out of range",
                     i + 1);
  }
  return VG_OK;
}

/* Refuse wraps that would take hours. */
static vg_status check_number(const struct vg_wrap_rims *rims, double size,
                              struct vg_error *err)
{
  struct vg_wrap_forecast f = vg_wrap_count(rims, size);

  if (f.triangles <= VG_WRAP_MOST) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "a wrap of size %g would have some %.2g triangles%s, which "
                 "exceeds the limit of %.2g; is the size in the unit of the "
                 "surface? Sizes from %.2g upwards are possible",
                 size, f.triangles,
                 f.n_open ? ", because it may go through holes and cover "
                            "both sides of the surface"
                          : "",
                 VG_WRAP_MOST, 1.05 * size * sqrt(f.triangles / VG_WRAP_MOST));
}

/* Find the patches that had triangles before and have none after the wrap. */
static vg_status find_empty(const struct vg_mesh *before,
                            const struct vg_mesh *after, uint8_t *empty,
                            size_t *n, struct vg_error *err)
{
  uint8_t *had = vg_calloc(before->n_patch, sizeof *had);

  *n = 0;
  if (!had) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < before->n_tri; i++) had[before->tri_patch[i]] = 1;
  for (size_t i = 0; i < after->n_tri; i++) had[after->tri_patch[i]] = 0;
  for (size_t i = 0; i < before->n_patch; i++) *n += had[i];
  if (empty) memcpy(empty, had, before->n_patch);
  free(had);
  return VG_OK;
}

/* Assign each triangle the patch of the input triangle nearest to its centroid.
 * Also measures the distance from the input. */
static vg_status label(const struct vg_mesh *m, struct vg_mesh *out,
                       const struct vg_stop *stop, struct vg_wrap_report *r,
                       struct vg_error *err)
{
  size_t n = out->n_point + out->n_tri;
  double(*x)[3] = vg_alloc(2 * n, sizeof *x);
  uint32_t *near = vg_alloc(n, sizeof *near);
  vg_status st;

  if (!x || !near) VG_TRY(vg_fail_memory(err, "a wrap"));
  memcpy(x, out->point, out->n_point * sizeof *x);
  for (size_t i = 0; i < out->n_tri; i++)
    for (int k = 0; k < 3; k++)
      x[out->n_point + i][k] = (out->point[out->tri[i][0]][k] +
                                out->point[out->tri[i][1]][k] +
                                out->point[out->tri[i][2]][k]) /
                               3;
  VG_TRY(vg_wrap_nearest(m, n, (const double(*)[3])x, stop, x + n, near, err));
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

/* Move the points onto the input. */
static vg_status fit(const struct vg_mesh *m, struct vg_mesh *out,
                     const struct vg_stop *stop, struct vg_wrap_report *r,
                     struct vg_error *err)
{
  const double most = REACH * r->offset;
  double(*near)[3] = vg_alloc(out->n_point, sizeof *near);
  uint32_t *tri = vg_alloc(out->n_point, sizeof *tri);
  vg_status st;

  if (!near || !tri) VG_TRY(vg_fail_memory(err, "a wrap"));
  VG_TRY(vg_wrap_nearest(m, out->n_point, (const double(*)[3])out->point, stop,
                         near, tri, err));
  VG_TRY(vg_wrap_zip(out, near, most, stop, &r->n_zip, err));
  VG_TRY(
    vg_wrap_fit(out, (const double(*)[3])near, most, stop, &r->n_fit, err));
done:
  free(near);
  free(tri);
  return st;
}

/* Select the triangles to wrap: all except those of outer boundaries. */
static vg_status take_bodies(const struct vg_mesh *m, const uint8_t *keep,
                             struct vg_mesh *in, struct vg_error *err)
{
  uint8_t *stays = vg_alloc(m->n_tri, 1);
  vg_status st;

  if (!stays) VG_TRY(vg_fail_memory(err, "a wrap"));
  for (size_t i = 0; i < m->n_tri; i++) stays[i] = !keep || !keep[i];
  VG_TRY(vg_mesh_copy(in, m, err));
  VG_TRY(vg_wrap_select(in, stays, err));
  if (!in->n_tri)
    st = vg_fail(err, VG_ERR_INPUT,
                 "nothing to wrap: all triangles belong to "
                 "an outer boundary");
done:
  free(stays);
  return st;
}

/* Nothing is left of a wrap if it goes through the holes of the surface, or if
 * the body is small compared with the size. */
static vg_status refuse_empty(const struct vg_mesh *in, double size,
                              const struct vg_wrap_forecast *f,
                              struct vg_error *err)
{
  const double extent = vg_mesh_length(in);

  if (!f->n_open || size > extent)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "nothing is left of a wrap of size %g, since the body is "
                   "only %.3g long; take a smaller size",
                   size, extent);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "nothing is left of a wrap of size %g: it goes through the "
                 "holes of the surface; take a larger size",
                 size);
}

/* Make the wrap of `in`, without patches. */
static vg_status make(const struct vg_mesh *in, const struct vg_wrap_options *o,
                      struct vg_mesh *out, struct vg_wrap_report *r,
                      struct vg_error *err)
{
  const struct vg_stop *stop = &o->stop;
  struct vg_wrap_rims rims = { .n_part = 0 };
  struct vg_wrap_forecast f;
  vg_status st;

  VG_TRY(vg_wrap_rims_find(in, o->size, &rims, err));
  VG_TRY(vg_wrap_refuse_open(&rims, o->size, stop, err));
  VG_TRY(check_number(&rims, o->size, err));
  f = vg_wrap_count(&rims, o->size);
  r->widest = f.widest;
  memcpy(r->widest_at, f.at, sizeof f.at);
  VG_TRY(vg_wrap_cgal(in, o, (size_t)f.triangles / 2, out, err));
  out->patch = in->patch; /* borrowed for checks */
  out->n_patch = in->n_patch;
  st = vg_wrap_prune(out, stop, r, err);
  if (st >= 0 && out->n_tri) st = fit(in, out, stop, r, err);
  if (st >= 0 && out->n_tri) st = vg_wrap_prune(out, stop, r, err);
  out->patch = NULL;
  out->n_patch = 0;
  if (st < 0) goto done;
  if (!out->n_tri) {
    st = refuse_empty(in, o->size, &f, err);
    goto done;
  }
  VG_CHECK("the wrapping of a surface", vg_mesh_open_edges(out));
  VG_TRY(label(in, out, stop, r, err));
  VG_TRY(vg_wrap_compare(&rims, out, o->size, stop, r, err));
done:
  vg_wrap_rims_release(&rims);
  return st;
}

vg_status vg_wrap(struct vg_mesh *m, const struct vg_wrap_options *o,
                  struct vg_wrap_report *r, struct vg_error *err)
{
  assert(m && o && r);

  struct vg_wrap_report report = { .offset = o->size * VG_WRAP_OFFSET };
  struct vg_mesh in = VG_MESH_INIT, out = VG_MESH_INIT;
  vg_status st;

  VG_TRY(check(m, o->size, err));
  VG_TRY(take_bodies(m, o->keep, &in, err));
  VG_TRY(make(&in, o, &out, &report, err));
  report.n_before = in.n_tri;
  report.n_kept = m->n_tri - in.n_tri;
  report.n_point = out.n_point;
  if (report.n_kept) VG_TRY(vg_wrap_join(m, o->keep, &o->stop, &out, err));
  VG_TRY(find_empty(m, &out, o->empty, &report.n_empty, err));
  out.patch = m->patch;
  out.n_patch = m->n_patch;
  m->patch = NULL;
  m->n_patch = 0;
  vg_mesh_move(m, &out);
  *r = report;
done:
  vg_mesh_release(&in);
  vg_mesh_release(&out);
  return st;
}

vg_status vg_wrap_foresee(const struct vg_mesh *m,
                          const struct vg_wrap_options *o,
                          struct vg_wrap_forecast *f, struct vg_error *err)
{
  struct vg_wrap_rims rims = { .n_part = 0 };
  struct vg_mesh in = VG_MESH_INIT;
  vg_status st;

  assert(m && o && f);
  VG_TRY(check(m, o->size, err));
  VG_TRY(take_bodies(m, o->keep, &in, err));
  VG_TRY(vg_wrap_rims_find(&in, o->size, &rims, err));
  *f = vg_wrap_count(&rims, o->size);
done:
  vg_wrap_rims_release(&rims);
  vg_mesh_release(&in);
  return st;
}
