/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: find the open edges of the body. Without open edges it gets a whole
 * farfield. If all of them are in one coordinate plane, they are moved exactly
 * into it; half a farfield is added whose border is in the plane, and the plane
 * is triangulated between that border and the footprint of the body. */
#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/domain/farfield.h"
#include "core/domain/mach.h"
#include "core/domain/open_edges.h"
#include "core/domain/planar.h"
#include "core/domain/slits.h"
#include "core/domain/symmetry.h"
#include "core/geometry/volume.h"
#include "core/mesh/mesh_defects.h"

/* Largest distance of the body from the centre over the farfield's radius. The
 * chords of the triangulated sphere come this close to the centre. */
#define FARFIELD_ROOM 0.9 /* S10 */

struct domain {
  struct vg_mesh m;
  const struct vg_farfield *farfield;
  const struct vg_size_function *law;
  double lo[3], hi[3], length; /* Of the body. */
  double centre[3], radius;
  struct vg_mach mach; /* Used by VG_FARFIELD_MACH. */
  int axis, side; /* Symmetry: axis (-1: none), and the side of the body (1:
                     above). */
  double at;
  struct vg_border open; /* Directed as the closing surface runs along them. */
  int is_crossed;        /* as in vg_domain_report */
};

static void measure(struct domain *d)
{
  vg_mesh_bounds(&d->m, d->lo, d->hi);
  for (int k = 0; k < 3; k++) d->length = fmax(d->length, d->hi[k] - d->lo[k]);
}

/* --- symmetry plane ------------------------------------------------------- */

static void open_range(const struct domain *d, int k, double *lo, double *hi)
{
  *lo = INFINITY;
  *hi = -INFINITY;
  for (size_t i = 0; i < d->open.n; i++) {
    const double x = d->m.point[d->open.edge[i][0]][k];

    if (x < *lo) *lo = x;
    if (x > *hi) *hi = x;
  }
}

/* Are all points of the body other than those of open edges, each of which
 * begins one edge, on one side of 0, and further away from it than tol? */
static int is_clear_of_zero(const struct domain *d, int k, double tol)
{
  const double sign = d->hi[k] > -d->lo[k] ? 1 : -1;
  size_t n = 0, n_open = 0;

  for (size_t i = 0; i < d->m.n_point; i++) n += sign * d->m.point[i][k] <= tol;
  for (size_t i = 0; i < d->open.n; i++)
    n_open += sign * d->m.point[d->open.edge[i][0]][k] <= tol;
  return n <= n_open;
}

/* Coordinate axis across which the open edges are flat and the body is on one
 * side; -1 if no axis fits. */
static int symmetry_axis(const struct domain *d, double tol)
{
  for (int i = 0; i < 3; i++) {
    const int k = (i + 1) % 3; /* y first: the most common */
    double lo, hi;

    open_range(d, k, &lo, &hi);
    if (hi - lo <= tol && d->hi[k] - d->lo[k] > 4 * tol &&
        (lo - d->lo[k] <= tol || d->hi[k] - hi <= tol))
      return k;
  }
  return -1;
}

/* Axis of the plane at 0 from which no open edge is further away than `wide`
 * and no other point nearer than tol; -1 if no axis fits. */
static int axis_of_zero(const struct domain *d, double tol, double wide)
{
  for (int i = 0; i < 3; i++) {
    const int k = (i + 1) % 3;
    double lo, hi;

    open_range(d, k, &lo, &hi);
    if (lo >= -wide && hi <= wide && d->hi[k] - d->lo[k] > 4 * wide &&
        is_clear_of_zero(d, k, tol))
      return k;
  }
  return -1;
}

/* Fail for open edges that are in a plane but not the cut of a half body. */
static vg_status refuse_hole(const struct domain *d, struct vg_error *err)
{
  double lo[3], hi[3], centre[3], width = 0;

  for (int k = 0; k < 3; k++) {
    open_range(d, k, &lo[k], &hi[k]);
    centre[k] = 0.5 * (lo[k] + hi[k]);
    width = fmax(width, hi[k] - lo[k]);
  }
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "the surface has a hole: %zu open edges around (%.9g, %.9g, "
                 "%.9g), %.4g wide, in a body %.4g long; close it "
                 "(close_holes yes). If the body is half of a symmetric one, "
                 "cut at %c = %.9g, set half yes",
                 d->open.n, centre[0], centre[1], centre[2], width, d->length,
                 "xyz"[d->axis], d -> at);
}

/* Set the plane of the open edges: axis (-1 if they are not in a plane) and
 * at. */
static void find_plane(struct domain *d, int symmetry)
{
  const double tol = VG_PLANE_TOLERANCE * d->length;
  const double wide = VG_ROOT_OFF * d->length;
  double lo, hi;

  d->axis = d->open.n ? symmetry_axis(d, tol) : -1;
  if (d->open.n && d->axis < 0 && symmetry > 1) {
    d->axis = axis_of_zero(d, tol, wide);
    if (d->axis < 0) d->axis = symmetry_axis(d, wide);
  }
  if (d->axis < 0) return;
  open_range(d, d->axis, &lo, &hi);
  d->at = hi - lo > tol && d->hi[d->axis] - hi < lo - d->lo[d->axis] ? hi : lo;
  if ((fabs(lo) <= tol && fabs(hi) <= tol) ||
      (symmetry > 1 && fabs(lo) <= wide && fabs(hi) <= wide &&
       is_clear_of_zero(d, d->axis, tol)))
    d->at = 0;
}

/* Move the points of open edges into the plane. Returns the largest distance.
 */
static double flatten(struct vg_mesh *m, const struct vg_border *open, int axis,
                      double at)
{
  double off = 0;

  for (size_t i = 0; i < 2 * open->n; i++) {
    double *x = m->point[open->edge[i / 2][i % 2]];

    off = fmax(off, fabs(x[axis] - at));
    x[axis] = at;
  }
  return off;
}

vg_status vg_domain_flatten(struct vg_mesh *surface, int axis, double at,
                            double *off, struct vg_error *err)
{
  struct vg_border open = VG_BORDER_INIT;
  vg_status st = vg_open_edges(surface, &open, err);

  assert(axis >= 0 && axis < 3 && off);
  if (st >= 0) *off = flatten(surface, &open, axis, at);
  vg_border_release(&open);
  return st;
}

vg_status vg_domain_mark_open(const struct vg_mesh *surface, uint8_t *open,
                              struct vg_error *err)
{
  struct vg_border edges = VG_BORDER_INIT;
  vg_status st = vg_open_edges(surface, &edges, err);

  for (size_t i = 0; i < 2 * edges.n && st >= 0; i++)
    open[edges.edge[i / 2][i % 2]] = 1;
  vg_border_release(&edges);
  return st;
}

static vg_status find_symmetry(struct domain *d, struct vg_error *err)
{
  const double *x;

  find_plane(d, d->farfield->symmetry);
  if (!d->open.n) return VG_OK;
  x = d->m.point[d->open.edge[0][0]];
  if (d->axis < 0)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "the surface has %zu open edges that "
                   "do not lie in one coordinate plane at an end of the body "
                   "(one starts at (%.9g, %.9g, %.9g)); close the surface "
                   "(close_holes yes), or cut a half model along x, y or z = "
                   "constant",
                   d->open.n, x[0], x[1], x[2]);
  if (d->farfield->symmetry < 0 ||
      (!d->farfield->symmetry &&
       !vg_is_symmetry(&d->m, &d->open, d->axis, d->at)))
    return refuse_hole(d, err);
  d->side = d->hi[d->axis] - d->at > d->at - d->lo[d->axis];
  flatten(&d->m, &d->open, d->axis, d->at);
  for (size_t i = 0; i < d->m.n_point; i++) {
    x = d->m.point[i];
    if (d->side ? x[d->axis] < d->at : x[d->axis] > d->at)
      return vg_fail(err, VG_ERR_GEOMETRY,
                     "point %zu (%.9g, %.9g, %.9g) lies beyond the symmetry "
                     "plane %c = %.9g of the open edges; move it onto the "
                     "plane or cut it off",
                     i + 1, x[0], x[1], x[2], "xyz"[d->axis], d -> at);
  }
  return VG_OK;
}

/* The fluid must be outside the body: six times the volume enclosed by its
 * triangles, relative to a point of the symmetry plane, must be positive. */
static vg_status check_orientation(const struct domain *d, struct vg_error *err)
{
  const struct vg_mesh *m = &d->m;
  double sum = 0, o[3];

  for (int k = 0; k < 3; k++) o[k] = 0.5 * (d->lo[k] + d->hi[k]);
  if (d->axis >= 0) o[d->axis] = d->at;
  for (size_t i = 0; i < m->n_tri + 2 * m->n_quad; i++) {
    const uint32_t *q = i < m->n_tri ? m->tri[i] : m->quad[(i - m->n_tri) / 2];
    const int second = i >= m->n_tri && (i - m->n_tri) % 2;
    const double *p[3] = { m->point[q[0]], m->point[q[second ? 2 : 1]],
                           m->point[q[second ? 3 : 2]] };

    sum += vg_tri_cone(o, p[0], p[1], p[2]);
  }
  if (sum > 0) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "the triangles of the surface point into the body, not into "
                 "the fluid: either the surface already is a whole flow "
                 "domain, which needs no farfield (farfield none), or it "
                 "must be turned inside out");
}

/* --- farfield ------------------------------------------------------------- */

static double domain_size(void *user, const double x[3])
{
  const struct domain *d = user;
  double h = d->farfield->spacing > 0 ? d->farfield->spacing : INFINITY;

  if (d->law) {
    const double s = d->law->at(d->law->user, x);

    if (s < h) h = s;
  }
  /* At least 4 edges per radius, so that a farfield is round and its sides are
   * resolved. */
  if (d->farfield->kind == VG_FARFIELD_MACH)
    return fmin(h, vg_mach_edge(&d->mach, x));
  return h < d->radius / 4 ? h : d->radius / 4;
}

static vg_status place_farfield(struct domain *d, struct vg_error *err)
{
  const struct vg_farfield *f = d->farfield;

  if (!(f->size >= 0) || !isfinite(f->size) ||
      (f->size == 0 && !(f->lengths > 0 && isfinite(f->lengths))))
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: size %g, %g body lengths; "
                   "one of them must be a positive number",
                   f->size, f->lengths);
  if (!(f->spacing >= 0) || (f->spacing == 0 && !d->law))
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: the spacing %g is not a "
                   "positive length",
                   f->spacing);
  d->radius = f->size > 0 ? f->size : f->lengths * d->length;
  for (int k = 0; k < 3; k++)
    d->centre[k] = f->has_centre ? f->centre[k] : 0.5 * (d->lo[k] + d->hi[k]);
  if (d->axis >= 0) d->centre[d->axis] = d->at;
  return VG_OK;
}

static vg_status outside(const struct domain *d, size_t i, struct vg_error *err)
{
  const double *x = d->m.point[i];

  return vg_fail(err, VG_ERR_GEOMETRY,
                 "point %zu (%.9g, %.9g, %.9g) of the "
                 "body is not well inside the farfield; enlarge it (body "
                 "length %.9g)",
                 i + 1, x[0], x[1], x[2], d->length);
}

static vg_status add_sphere(struct domain *d, uint32_t patch,
                            struct vg_border *border, struct vg_error *err)
{
  const struct vg_size_function law = { domain_size, d, d->farfield->stop };
  const double most = FARFIELD_ROOM * d->radius;

  for (size_t i = 0; i < d->m.n_point; i++) {
    const double *x = d->m.point[i];
    double rr = 0;

    for (int k = 0; k < 3; k++)
      rr += (x[k] - d->centre[k]) * (x[k] - d->centre[k]);
    if (!(rr < most * most)) return outside(d, i, err);
  }
  return vg_add_sphere(&d->m, d->centre, d->radius,
                       d->axis < 0 ? -1 : 2 * d->axis + d->side, 1, &law, patch,
                       border, err);
}

static vg_status add_box(struct domain *d, uint32_t patch,
                         struct vg_border *border, struct vg_error *err)
{
  const struct vg_farfield *f = d->farfield;
  const struct vg_size_function law = { domain_size, d, d->farfield->stop };
  const uint32_t of[6] = { patch, patch, patch, patch, patch, patch };
  const int open = d->axis < 0 ? -1 : 2 * d->axis + !d->side;
  double lo[3], hi[3];

  d->radius = INFINITY;
  for (int k = 0; k < 3; k++) {
    const double half = f->size > 0 ? f->size : f->lengths * d->length;

    lo[k] = f->has_box ? f->lo[k] : d->centre[k] - half;
    hi[k] = f->has_box ? f->hi[k] : d->centre[k] + half;
    if (k == d->axis) *(d->side ? &lo[k] : &hi[k]) = d->at;
    if (!(hi[k] > lo[k]))
      return vg_fail(err, VG_ERR_INPUT,
                     "farfield box: %c from %g to %g is "
                     "empty",
                     "xyz"[k], lo[k], hi[k]);
    d->radius = fmin(d->radius, 0.5 * (hi[k] - lo[k]));
  }
  for (size_t i = 0; i < d->m.n_point; i++)
    for (int k = 0; k < 3; k++) {
      const double x = d->m.point[i][k];

      if ((open != 2 * k && !(x > lo[k])) ||
          (open != 2 * k + 1 && !(x < hi[k])))
        return outside(d, i, err);
    }
  return vg_add_box(&d->m, lo, hi, open, &law, of, border, err);
}

static vg_status add_mach(struct domain *d, uint32_t patch,
                          struct vg_border *border, struct vg_error *err)
{
  const struct vg_size_function law = { domain_size, d, d->farfield->stop };
  vg_status st = vg_mach_place(&d->m, &d->farfield->extent, d->length,
                               d->centre,
                               d->axis < 0 ? -1 : 2 * d->axis + d->side,
                               &d->mach, err);

  if (st < 0) return st;
  return vg_add_revolution(&d->m, &d->mach.shape, &law, patch, border, err);
}

/* --- patches ------------------------------------------------------------- */

static vg_status add_patch(struct vg_mesh *m, const char *name, int32_t bc,
                           int32_t bc_fun3d, uint32_t *at, struct vg_error *err)
{
  const int32_t id = vg_mesh_last_id(m);
  size_t i;

  if (id == INT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "patch number %" PRId32 " is the largest possible and "
                   "leaves none for the %s; renumber "
                   "the patches",
                   id, name);
  i = vg_mesh_add_patch(m, id + 1, name);
  if (i == SIZE_MAX) return vg_fail_memory(err, "a patch");
  m->patch[i].bc = m->patch[i].family = bc;
  m->patch[i].bc_fun3d = bc_fun3d;
  *at = (uint32_t)i;
  return VG_OK;
}

static vg_status add_symmetry(struct domain *d, struct vg_border *border,
                              struct vg_error *err)
{
  const struct vg_size_function law = { domain_size, d, d->farfield->stop };
  const struct vg_slit_plane plane = { d->axis, d->side, d->at,
                                       VG_PLANE_TOLERANCE * d->length };
  struct vg_error inner = VG_ERROR_INIT;
  uint32_t patch = 0;
  vg_status st;

  VG_TRY(add_patch(&d->m, "symmetry", 1, 6661 + d->axis, &patch, err));
  for (size_t i = 0; i < d->open.n; i++)
    VG_TRY(vg_border_add(border, d->open.edge[i][0], d->open.edge[i][1], err));
  if (d->farfield->sheets)
    VG_TRY(vg_add_slits(&d->m, d->farfield->sheets, &plane, border, err));
  st = vg_planar_patch(&d->m, border->n, (const uint32_t(*)[2])border->edge,
                       &law, patch, &inner);
  d->is_crossed = st == VG_ERR_GEOMETRY && d->farfield->sheets;
  if (st < 0)
    st = vg_fail(err, st, "symmetry plane %c = %.9g: %s", "xyz"[d->axis],
                 d -> at, inner.text);
done:
  return st;
}

static vg_status build(struct domain *d, struct vg_error *err)
{
  struct vg_border border = VG_BORDER_INIT;
  uint32_t patch = 0;
  vg_status st;

  VG_TRY(vg_open_edges(&d->m, &d->open, err));
  VG_TRY(find_symmetry(d, err));
  if (d->farfield->kind == VG_FARFIELD_NONE) {
    /* The outer boundary is given, and is open along the symmetry plane,
     * too. */
    d->radius = d->length;
    if (d->axis >= 0) VG_TRY(add_symmetry(d, &border, err));
    goto done;
  }
  VG_TRY(check_orientation(d, err));
  VG_TRY(place_farfield(d, err));
  VG_TRY(add_patch(&d->m, "farfield", 3, 5000, &patch, err));
  switch (d->farfield->kind) {
  case VG_FARFIELD_MACH: st = add_mach(d, patch, &border, err); break;
  case VG_FARFIELD_BOX: st = add_box(d, patch, &border, err); break;
  default: st = add_sphere(d, patch, &border, err);
  }
  VG_TRY(st);
  if (d->axis >= 0) VG_TRY(add_symmetry(d, &border, err));
done:
  vg_border_release(&border);
  return st;
}

void vg_domain_bounds(const struct vg_mesh *surface,
                      const struct vg_farfield *farfield, double lo[3],
                      double hi[3])
{
  double centre[3], length = 0;
  struct vg_mach mach;

  vg_mesh_bounds(surface, lo, hi);
  if (farfield->kind != VG_FARFIELD_MACH) return;
  for (int k = 0; k < 3; k++) {
    centre[k] = farfield->has_centre ? farfield->centre[k]
                                     : 0.5 * (lo[k] + hi[k]);
    length = fmax(length, hi[k] - lo[k]);
  }
  if (!(length > 0) || vg_mach_place(surface, &farfield->extent, length, centre,
                                     -1, &mach, NULL) < 0)
    return;
  vg_mach_bounds(&mach, lo, hi);
  for (int k = 0; k < 3; k++) {
    const double more = 0.1 * (hi[k] - lo[k]);

    lo[k] -= more;
    hi[k] += more;
  }
}

vg_status vg_domain_half(const struct vg_mesh *surface, int symmetry, int *axis,
                         double *at, struct vg_error *err)
{
  assert(symmetry >= -1 && symmetry <= 2 && axis && at);

  struct domain d = { .m = *surface };
  vg_status st;

  measure(&d);
  VG_TRY(vg_open_edges(&d.m, &d.open, err));
  find_plane(&d, symmetry);
  *at = d.at;
  *axis = d.axis;
  if (symmetry < 0 || (!symmetry && d.axis >= 0 &&
                       !vg_is_symmetry(&d.m, &d.open, d.axis, d.at)))
    *axis = -1;
done:
  vg_border_release(&d.open);
  return st;
}

vg_status vg_domain_complete_by(struct vg_mesh *surface,
                                const struct vg_farfield *farfield,
                                const struct vg_size_function *law,
                                struct vg_domain_report *report,
                                struct vg_error *err)
{
  struct domain d = { .farfield = farfield, .law = law, .axis = -1 };
  vg_status st;

  assert(law || farfield->spacing > 0 || farfield->kind == VG_FARFIELD_NONE);
  if (!surface->n_tri && !surface->n_quad)
    return vg_fail(err, VG_ERR_INPUT,
                   "the surface has no triangles: there is "
                   "no body to put a farfield around");
  VG_TRY(vg_mesh_copy(&d.m, surface, err));
  measure(&d);
  st = build(&d, err);
  if (report) report->is_crossed = d.is_crossed;
  VG_TRY(st);
  if (report) {
    report->added_farfield = farfield->kind != VG_FARFIELD_NONE;
    report->added_symmetry = d.axis >= 0;
    report->symmetry_axis = d.axis;
    report->symmetry_at = d.at;
    report->n_added_tri = d.m.n_tri - surface->n_tri;
  }
  VG_CHECK("the completion of the domain", vg_mesh_open_edges(&d.m));
  vg_mesh_move(surface, &d.m);
done:
  vg_mesh_release(&d.m);
  vg_border_release(&d.open);
  return st;
}

vg_status vg_domain_complete(struct vg_mesh *surface,
                             const struct vg_farfield *farfield,
                             const struct vg_sizing *sizing,
                             struct vg_domain_report *report,
                             struct vg_error *err)
{
  const struct vg_size_function law = vg_size_function_of(sizing);

  return vg_domain_complete_by(surface, farfield, sizing ? &law : NULL, report,
                               err);
}
