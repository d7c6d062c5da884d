/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/input/cones.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/domain/planar.h"
#include "core/flow/flow.h"
#include "run/settings/plan_options.h"

/* S67: margin of the cones in body lengths, before the foremost and behind the
 * rearmost one that touches the body: at a distance, the bow shock is ahead of
 * its Mach cone and the tail shock behind. */
#define MARGIN 0.1

/* The body and its axis. */
struct body {
  double lo[3], hi[3], length;
  double axis[3], centre[3]; /* The axis passes through the centre. */
  uint8_t *is_body;          /* [n_patch] owned. */
};

int vg_patch_is_outer(const struct vg_patch *p)
{
  return p->bc == 0 || p->bc == 1 || p->bc == 2 || p->bc == 3 ||
         (p->bc_fun3d >= 5000 && p->bc_fun3d <= 5050) ||
         (p->bc_fun3d >= 6661 && p->bc_fun3d <= 6663);
}

static int has_axis(const struct vg_source *s)
{
  return vg_distance2(s->p0, s->p1) > 0;
}

static void measure(const struct vg_mesh *m, struct body *b)
{
  for (int k = 0; k < 3; k++) {
    b->lo[k] = INFINITY;
    b->hi[k] = -INFINITY;
  }
  for (size_t i = 0; i < 3 * m->n_tri + 4 * m->n_quad; i++) {
    const size_t f = i < 3 * m->n_tri ? i / 3 : (i - 3 * m->n_tri) / 4;
    const double *x = i < 3 * m->n_tri
                      ? m->point[m->tri[f][i % 3]]
                      : m->point[m->quad[f][(i - 3 * m->n_tri) % 4]];

    if (!b->is_body[i < 3 * m->n_tri ? m->tri_patch[f] : m->quad_patch[f]])
      continue;
    for (int k = 0; k < 3; k++) {
      b->lo[k] = fmin(b->lo[k], x[k]);
      b->hi[k] = fmax(b->hi[k], x[k]);
    }
  }
  for (int k = 0; k < 3; k++) b->length = fmax(b->length, b->hi[k] - b->lo[k]);
}

/* The plane of the open edges. Open edges can be found where neighbours agree
 * in orientation, as they do after the repair, which comes later: if they
 * disagree, a repaired copy is examined. A surface that cannot be repaired has
 * no such plane; its check lists the defects. */
static vg_status find_cut(const struct vg_read *r, int *axis, double *at,
                          struct vg_error *err)
{
  const int symmetry = vg_options_farfield(&r->settings).symmetry;
  struct vg_surface_check_options o = vg_options_check(&r->settings);
  struct vg_surface_report found = VG_SURFACE_REPORT_INIT;
  struct vg_mesh copy = VG_MESH_INIT;
  struct vg_error why = VG_ERROR_INIT;
  vg_status st = vg_domain_half(&r->surface, symmetry, axis, at, &why);

  if (st != VG_ERR_GEOMETRY)
    return st < 0 ? vg_fail(err, st, "%s", why.text) : st;
  *axis = -1;
  o.external = -1;
  o.threads = (int)r->settings.threads;
  VG_TRY(vg_mesh_copy(&copy, &r->surface, err));
  VG_TRY(vg_surface_check(&copy, &o, &found, err));
  if (found.count[VG_DEFECT_ORIENTATION] ||
      found.count[VG_DEFECT_NONMANIFOLD_EDGE])
    goto done;
  st = vg_domain_half(&copy, symmetry, axis, at, err);
done:
  vg_surface_report_release(&found);
  vg_mesh_release(&copy);
  return st;
}

/* The symmetry plane of a half model: that of its open edges, or else the end
 * of the body nearest to 0 along the axis of the setting `half`. */
static vg_status find_half(const struct vg_read *r, const struct body *b,
                           int *axis, double *at, struct vg_error *err)
{
  const enum vg_flow_half half = (enum vg_flow_half)r->settings.half;
  vg_status st = find_cut(r, axis, at, err);

  if (st < 0 || *axis >= 0 || half < VG_HALF_X) return st;
  *axis = (int)half - VG_HALF_X;
  *at = fabs(b->lo[*axis]) < fabs(b->hi[*axis]) ? b->lo[*axis] : b->hi[*axis];
  return VG_OK;
}

static vg_status find_body(const struct vg_read *r, struct body *b,
                           struct vg_error *err)
{
  const struct vg_mesh *m = &r->surface;
  const struct vg_farfield_row *f = &r->settings.farfield;
  double at = 0;
  int axis = -1;
  vg_status st;

  b->is_body = vg_calloc(m->n_patch, 1);
  if (!b->is_body) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < m->n_patch; i++)
    b->is_body[i] = !vg_patch_is_outer(&m->patch[i]);
  measure(m, b);
  if (!(b->length > 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "sources of kind machcone: the surface has no patch of a "
                   "body; give their points (x0 y0 z0, x1 y1 z1)");
  VG_TRY(find_half(r, b, &axis, &at, err));
  for (int k = 0; k < 3; k++) {
    b->axis[k] = isnan(f->flow[k]) ? k == 0 : f->flow[k];
    b->centre[k] = isnan(f->centre[k]) ? 0.5 * (b->lo[k] + b->hi[k])
                                       : f->centre[k];
  }
  if (axis >= 0) b->centre[axis] = at;
  if (!(vg_unit(b->axis) > 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: the direction ux uy uz of the flow is zero; give "
                   "a vector that is not");
done:
  return st;
}

/* Set the points of the source to the apexes of the first and the last cone
 * that touch the body. A point of the body at z and r disturbs the flow between
 * the cones with apexes at z - r cot and z + r cot. */
static void place(const struct vg_mesh *m, const struct body *b,
                  struct vg_source *s)
{
  const double cot = sqrt((s->mach - 1) * (s->mach + 1));
  double first = INFINITY, last = -INFINITY;

  for (size_t i = 0; i < 3 * m->n_tri + 4 * m->n_quad; i++) {
    const size_t f = i < 3 * m->n_tri ? i / 3 : (i - 3 * m->n_tri) / 4;
    const double *x = i < 3 * m->n_tri
                      ? m->point[m->tri[f][i % 3]]
                      : m->point[m->quad[f][(i - 3 * m->n_tri) % 4]];
    double d[3], z, r;

    if (!b->is_body[i < 3 * m->n_tri ? m->tri_patch[f] : m->quad_patch[f]])
      continue;
    vg_sub(x, b->centre, d);
    z = vg_dot(d, b->axis);
    r = sqrt(fmax(0, vg_dot(d, d) - z * z));
    first = fmin(first, z - r * cot);
    last = fmax(last, z + r * cot);
  }
  first -= MARGIN * b->length;
  last += MARGIN * b->length;
  for (int k = 0; k < 3; k++) {
    s->p0[k] = b->centre[k] + first * b->axis[k];
    s->p1[k] = b->centre[k] + last * b->axis[k];
  }
}

static vg_status complete(const struct vg_read *r, size_t i,
                          const struct body *b, struct vg_error *err)
{
  const struct vg_farfield far = vg_options_farfield(&r->settings);
  const int is_mach = far.kind == VG_FARFIELD_MACH;
  const struct vg_farfield plain = VG_FARFIELD_INIT;
  struct vg_source *s = &r->settings.source[i];

  if (s->mach == 0 && is_mach) s->mach = far.extent.mach;
  if (s->mach == 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "source %zu (machcone) has no Mach number; give the column "
                   "mach, or farfield mach",
                   i + 1);
  if (s->r0 == 0 && is_mach)
    s->r0 = b->length * (isnan(far.extent.radial) ? plain.extent.radial
                                                  : far.extent.radial);
  if (s->r0 == 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "source %zu (machcone) has no radius; give the column r0, "
                   "the distance from the axis at which the cones end, or "
                   "farfield mach",
                   i + 1);
  if (s->stretch == 0) s->stretch = 1;
  if (!has_axis(s)) place(&r->surface, b, s);
  vg_note(r->notes,
          "source %zu: Mach cones at M %g with apexes from (%.6g, %.6g, %.6g) "
          "to (%.6g, %.6g, %.6g), up to %.6g from the axis; %.6g to %.6g "
          "across, %g times that along them",
          i + 1, s->mach, s->p0[0], s->p0[1], s->p0[2], s->p1[0], s->p1[1],
          s->p1[2], s->r0, s->h0, s->h1, s->stretch);
  return VG_OK;
}

vg_status vg_read_place_cones(struct vg_read *r, struct vg_error *err)
{
  struct body b = { .is_body = NULL };
  vg_status st = VG_OK;

  for (size_t i = 0; i < r->settings.n_source; i++) {
    if (r->settings.source[i].kind != VG_SOURCE_MACHCONE) continue;
    if (!b.is_body) VG_TRY(find_body(r, &b, err));
    VG_TRY(complete(r, i, &b, err));
  }
done:
  free(b.is_body);
  return st;
}
