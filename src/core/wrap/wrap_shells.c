/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The shells of a wrap: removes those that bound no body, and appends the outer
 * boundaries that were kept. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/surface/surface_check.h"
#include "core/wrap/wrap_parts.h"

vg_status vg_wrap_select(struct vg_mesh *m, const uint8_t *stays,
                         struct vg_error *err)
{
  assert(stays || !m->n_tri);

  uint32_t *number = vg_alloc(m->n_point, sizeof *number);
  size_t n = 0;

  if (!number) return vg_fail_memory(err, "a wrap");
  memset(number, 0xff, m->n_point * sizeof *number);
  for (size_t i = 0; i < m->n_tri; i++) {
    if (!stays[i]) continue;
    for (int k = 0; k < 3; k++) number[m->tri[i][k]] = 0;
    memmove(m->tri[n], m->tri[i], sizeof m->tri[i]);
    m->tri_patch[n++] = m->tri_patch[i];
  }
  m->n_tri = n;
  n = 0;
  for (size_t i = 0; i < m->n_point; i++) {
    if (number[i] == UINT32_MAX) continue;
    memmove(m->point[n], m->point[i], sizeof m->point[i]);
    number[i] = (uint32_t)n++;
  }
  m->n_point = n;
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++) m->tri[i][k] = number[m->tri[i][k]];
  free(number);
  return VG_OK;
}

static vg_status examine(struct vg_mesh *m, const struct vg_stop *stop,
                         struct vg_surface_report *r, struct vg_error *err)
{
  struct vg_surface_check_options o = { .external = 1, .threads = 1 };

  if (stop) o.stop = *stop;
  return vg_surface_check(m, &o, r, err);
}

vg_status vg_wrap_prune(struct vg_mesh *m, const struct vg_stop *stop,
                        struct vg_wrap_report *r, struct vg_error *err)
{
  assert(m && r);

  const double least = r->offset * r->offset * r->offset;
  struct vg_surface_report found = VG_SURFACE_REPORT_INIT;
  uint8_t *stays = NULL;
  size_t n = 0;
  vg_status st;

  VG_TRY(examine(m, stop, &found, err));
  stays = vg_alloc(m->n_tri, 1);
  if (!stays) VG_TRY(vg_fail_memory(err, "a wrap"));
  for (size_t i = 0; i < found.n_shell; i++) {
    const struct vg_shell *s = &found.shell[i];

    if (s->depth > 0) r->n_cavity++;
    else if (!(s->volume >= least)) r->n_crumb++;
    else continue;
    n++;
  }
  if (!n) goto done;
  for (size_t i = 0; i < m->n_tri; i++) {
    const struct vg_shell *s = &found.shell[found.tri_shell[i]];

    stays[i] = s->depth == 0 && s->volume >= least;
  }
  VG_TRY(vg_wrap_select(m, stays, err));
done:
  free(stays);
  vg_surface_report_release(&found);
  return st;
}

/* --- kept boundaries ----------------------------------------------------- */

static vg_status append(struct vg_mesh *m, const struct vg_mesh *other,
                        struct vg_error *err)
{
  size_t n_point = m->n_point + other->n_point;
  size_t n_tri = m->n_tri + other->n_tri;
  double(*point)[3] = vg_realloc(m->point, n_point, sizeof *point);
  uint32_t(*tri)[3], *patch;

  if (point) m->point = point;
  tri = vg_realloc(m->tri, n_tri, sizeof *tri);
  if (tri) m->tri = tri;
  patch = vg_realloc(m->tri_patch, n_tri, sizeof *patch);
  if (patch) m->tri_patch = patch;
  if (!point || !tri || !patch) return vg_fail_memory(err, "a wrap");
  memcpy(point + m->n_point, other->point, other->n_point * sizeof *point);
  memcpy(patch + m->n_tri, other->tri_patch, other->n_tri * sizeof *patch);
  for (size_t i = 0; i < other->n_tri; i++)
    for (int k = 0; k < 3; k++)
      tri[m->n_tri + i][k] = (uint32_t)(m->n_point + other->tri[i][k]);
  m->n_point = n_point;
  m->n_tri = n_tri;
  return VG_OK;
}

/* Fail if the wrap, which is the first n faces, intersects the kept
 * boundary. */
static vg_status check_meeting(const struct vg_mesh *m, size_t n,
                               const struct vg_surface_report *r,
                               struct vg_error *err)
{
  for (size_t i = 0; i < r->n_defect; i++) {
    const struct vg_defect *d = &r->defect[i];

    if (d->kind != VG_DEFECT_INTERSECTION ||
        (d->face[0] < n) == (d->face[1] < n))
      continue;
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "the wrap meets the outer boundary that is kept (patch "
                   "%d), at (%.6g, %.6g, %.6g): take a smaller size if there "
                   "is a gap between the two, or remove the part of the body "
                   "outside the boundary",
                   (int)m->patch[m->tri_patch[d->face[d->face[0] < n]]].id,
                   d->at[0], d->at[1], d->at[2]);
  }
  return VG_OK;
}

/* Fail if a shell of the wrap is not inside an odd number of kept shells. */
static vg_status check_leaving(const struct vg_mesh *m, size_t n,
                               const struct vg_surface_report *r,
                               struct vg_error *err)
{
  size_t n_around = 0;

  for (size_t i = 0; i < r->n_shell; i++)
    n_around += r->shell[i].face >= n && r->shell[i].is_closed;
  for (size_t i = 0; i < r->n_shell && n_around; i++) {
    const struct vg_shell *s = &r->shell[i];
    const double *x = m->point[m->tri[s->face][0]];

    if (s->face < n && s->depth % 2 == 0)
      return vg_fail(err, VG_ERR_GEOMETRY,
                     "a wrapped body lies outside the outer boundary that is "
                     "kept, at (%.6g, %.6g, %.6g): remove it from the surface",
                     x[0], x[1], x[2]);
  }
  return VG_OK;
}

vg_status vg_wrap_join(const struct vg_mesh *m, const uint8_t *keep,
                       const struct vg_stop *stop, struct vg_mesh *out,
                       struct vg_error *err)
{
  struct vg_mesh kept = VG_MESH_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  size_t n = out->n_tri;
  vg_status st;

  VG_TRY(vg_mesh_copy(&kept, m, err));
  VG_TRY(vg_wrap_select(&kept, keep, err));
  VG_TRY(append(out, &kept, err));
  out->patch = m->patch; /* borrowed for the check */
  out->n_patch = m->n_patch;
  st = examine(out, stop, &r, err);
  if (st >= 0) st = check_meeting(out, n, &r, err);
  if (st >= 0) st = check_leaving(out, n, &r, err);
  out->patch = NULL;
  out->n_patch = 0;
done:
  vg_surface_report_release(&r);
  vg_mesh_release(&kept);
  return st;
}
