/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The farfield of a section, and the two planes. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/graded.h"
#include "run/section/section_surface.h"

#define QUARTER 1.5707963267948966
/* Share of the radius of a farfield that the section may reach. */
#define REACH 0.9 /* S98 */

enum {
  SIDE_MIN = 4, /* Least number of edges on a quarter of a circle or a side of
                   a box. */
  SIDES = 5
};

/* A part of the outer boundary: a quarter of a circle or a side of a box. */
struct side {
  const struct vg_section_outer *outer;
  const struct vg_size_function *size;
  int is_arc, k;
  double length;
};

/* Side i of the boundary, counter-clockwise. The left side of a C is an arc of
 * two quarters. */
static struct side side_of(const struct vg_section_outer *o,
                           const struct vg_size_function *size, int i)
{
  struct side s = { .outer = o, .size = size, .k = i };

  s.is_arc = o->shape == VG_SECTION_CIRCLE ||
             (o->shape == VG_SECTION_C && i > 2);
  if (o->shape == VG_SECTION_C && i > 2) s.k = i - 2;
  s.length = s.is_arc ? QUARTER * o->radius : o->hi[i & 1] - o->lo[i & 1];
  return s;
}

static int n_side(const struct vg_section_outer *o)
{
  return o->shape == VG_SECTION_C ? 5 : 4;
}

static void at_side(const struct side *o, double u, double x[2])
{
  const struct vg_section_outer *b = o->outer;
  double sine, cosine;

  if (!o->is_arc) {
    const double *corner[2][2] = { { &b->lo[0], &b->hi[0] },
                                   { &b->lo[1], &b->hi[1] } };
    const int moves = o->k & 1, from = o->k >> 1; /* Axis, and its end. */
    const double p = *corner[moves][from], q = *corner[moves][!from];

    x[moves] = p + u * (q - p);
    x[!moves] = *corner[!moves][moves ? !from : from];
    return;
  }
  vg_quarter_turn(u, &sine, &cosine);
  x[0] = b->centre[0] + b->radius * (o->k == 0   ? cosine
                                     : o->k == 1 ? -sine
                                     : o->k == 2 ? -cosine
                                                 : sine);
  x[1] = b->centre[1] + b->radius * (o->k == 0   ? sine
                                     : o->k == 1 ? cosine
                                     : o->k == 2 ? -sine
                                                 : -cosine);
}

static double size_on_side(void *user, double s)
{
  const struct side *o = user;
  double x[3] = { 0, 0, 0 };

  if (vg_stops(&o->size->stop)) return 0;
  at_side(o, s / o->length, x);
  return o->size->at(o->size->user, x);
}

/* Points of the outer boundary, counter-clockwise; end[i]: after side i. */
static vg_status make_outer(const struct vg_section_outer *outer,
                            const struct vg_size_function *size, size_t *n,
                            double (**x)[2], size_t end[SIDES],
                            struct vg_error *err)
{
  size_t cap = 0, n_step;
  double *step;
  vg_status st;

  for (int k = 0; k < n_side(outer); k++) {
    struct side o = side_of(outer, size, k);

    st = vg_graded_steps(o.length, size_on_side, &o, SIDE_MIN, &n_step, &step,
                         err);
    if (st < 0)
      return vg_stops(&size->stop) ? vg_fail(err, VG_ERR_STOPPED, "interrupted")
                                   : st;
    if (vg_reserve(x, &cap, *n + n_step, sizeof **x)) {
      free(step);
      return vg_fail_memory(err, "the farfield");
    }
    for (size_t i = 0; i < n_step; i++)
      at_side(&o, step[i] / o.length, (*x)[(*n)++]);
    free(step);
    end[k] = *n;
  }
  return VG_OK;
}

/* Whether x is inside; a circle has a margin. */
static int is_inside(const struct vg_section_outer *o, const double x[2])
{
  const double d[2] = { x[0] - o->centre[0], x[1] - o->centre[1] };
  const double r = REACH * o->radius;
  int in_box = 1;

  for (int k = 0; k < 2; k++) in_box &= x[k] > o->lo[k] && x[k] < o->hi[k];
  switch (o->shape) {
  case VG_SECTION_BOX:
  case VG_SECTION_TUNNEL: return in_box;
  case VG_SECTION_C:
    if (d[0] > 0) return d[0] < r && fabs(d[1]) < r;
    break;
  case VG_SECTION_CIRCLE: break;
  }
  return d[0] * d[0] + d[1] * d[1] <= r * r;
}

static vg_status check_reach(const struct vg_mesh *strip,
                             const struct vg_section_outer *o,
                             struct vg_error *err)
{
  const int is_round = o->shape == VG_SECTION_CIRCLE ||
                       o->shape == VG_SECTION_C;
  double lo[3], hi[3], radius = 0;
  int bad = 0;

  vg_mesh_bounds(strip, lo, hi);
  for (size_t i = 0; i < strip->n_point; i++) {
    const double *p = strip->point[i];
    const double d[2] = { p[0] - o->centre[0], p[1] - o->centre[1] };

    radius = fmax(radius, sqrt(d[0] * d[0] + d[1] * d[1]));
    bad |= !is_inside(o, p);
  }
  if (!bad) return VG_OK;
  if (!is_round)
    return vg_fail(err, VG_ERR_INPUT,
                   "the farfield %s from (%g, %g) to (%g, %g) does not "
                   "contain the section, which reaches from (%g, %g) to (%g, "
                   "%g); make it larger",
                   o->shape == VG_SECTION_BOX ? "box" : "tunnel", o->lo[0],
                   o->lo[1], o->hi[0], o->hi[1], lo[0], lo[1], hi[0], hi[1]);
  return vg_fail(err, VG_ERR_INPUT,
                 "the farfield of radius %g around (%g, %g) does not contain "
                 "the section with a margin of a tenth; it needs a radius of "
                 "at least %.4g",
                 o->radius, o->centre[0], o->centre[1], radius / REACH);
}

static size_t add_patch(struct vg_mesh *m, const char *name, int32_t bc,
                        int32_t fun3d)
{
  const int32_t id = vg_mesh_last_id(m);
  size_t at;

  at = vg_mesh_add_patch(m, id + 1, name);
  if (at == SIZE_MAX) return at;
  m->patch[at].bc = m->patch[at].family = bc;
  m->patch[at].bc_fun3d = fun3d;
  return at;
}

/* Walls and farfield in both planes. */
static vg_status place_points(const struct vg_mesh *strip, size_t n_outer,
                              const double (*outer)[2], struct vg_mesh *m,
                              struct vg_error *err)
{
  const size_t n_wall = strip->n_point / 2, n = n_wall + n_outer;
  const double width = strip->point[n_wall][2];

  m->point = vg_alloc(2 * n, sizeof *m->point);
  m->tri = vg_alloc(strip->n_tri + 2 * n_outer, sizeof *m->tri);
  m->tri_patch = vg_alloc(strip->n_tri + 2 * n_outer, sizeof *m->tri_patch);
  if (!m->point || !m->tri || !m->tri_patch || n >= UINT32_MAX / 2)
    return vg_fail_memory(err, "the slab of a section");
  m->n_point = 2 * n;
  for (size_t i = 0; i < 2 * n; i++) {
    const size_t k = i % n;
    const double *x = k < n_wall ? strip->point[k] : outer[k - n_wall];

    m->point[i][0] = x[0];
    m->point[i][1] = x[1];
    m->point[i][2] = i < n ? 0 : width;
  }
  m->n_tri = strip->n_tri;
  for (size_t t = 0; t < m->n_tri; t++) {
    m->tri_patch[t] = strip->tri_patch[t];
    for (int k = 0; k < 3; k++) {
      const uint32_t v = strip->tri[t][k];

      m->tri[t][k] = v < n_wall ? v : (uint32_t)(v + n_outer);
    }
  }
  return VG_OK;
}

/* The edges of the strips in the plane z = 0, with the fluid on their left. */
static size_t list_edges(const struct vg_mesh *m, uint32_t (*edge)[2])
{
  const size_t n = m->n_point / 2;
  size_t n_edge = 0;

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      const uint32_t a = m->tri[t][k], b = m->tri[t][(k + 1) % 3];

      if (a >= n || b >= n) continue;
      edge[n_edge][0] = b;
      edge[n_edge++][1] = a;
    }
  return n_edge;
}

/* The triangles of the plane z = 0, from `first` on, in the other plane. */
static vg_status mirror(struct vg_mesh *m, size_t n_strip, size_t first,
                        uint32_t patch, struct vg_error *err)
{
  const size_t n_tri = m->n_tri - first, n_new = m->n_point - 2 * n_strip;
  const double width = m->point[n_strip][2];
  size_t cap[3] = { m->n_point, m->n_tri, m->n_tri };

  if (m->n_point + n_new >= UINT32_MAX ||
      vg_reserve(&m->point, &cap[0], m->n_point + n_new, sizeof *m->point) ||
      vg_reserve(&m->tri, &cap[1], m->n_tri + n_tri, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &cap[2], m->n_tri + n_tri,
                 sizeof *m->tri_patch))
    return vg_fail_memory(err, "the planes of a section");
  for (size_t i = 0; i < n_new; i++) {
    memcpy(m->point[m->n_point + i], m->point[2 * n_strip + i],
           sizeof *m->point);
    m->point[m->n_point + i][2] = width;
  }
  m->n_point += n_new;
  for (size_t t = 0; t < n_tri; t++, m->n_tri++) {
    for (int k = 0; k < 3; k++) {
      const uint32_t v = m->tri[first + t][2 - k];

      m->tri[m->n_tri][k] = (uint32_t)(v + (v < n_strip ? n_strip : n_new));
    }
    m->tri_patch[m->n_tri] = patch;
  }
  return VG_OK;
}

/* end, patch: of the sides. */
static void put_outer(struct vg_mesh *m, size_t n_wall, size_t n_outer,
                      const size_t end[SIDES], const uint32_t patch[SIDES])
{
  const uint32_t half = (uint32_t)(n_wall + n_outer);

  for (uint32_t i = 0, side = 0; i < n_outer; i++) {
    const uint32_t a = (uint32_t)n_wall + i;
    const uint32_t b = (uint32_t)n_wall + (i + 1 < n_outer ? i + 1 : 0);
    const uint32_t tri[2][3] = { { b, a, half + a },
                                 { b, half + a, half + b } };

    while (i >= end[side]) side++;
    memcpy(m->tri + m->n_tri, tri, sizeof tri);
    m->tri_patch[m->n_tri++] = patch[side];
    m->tri_patch[m->n_tri++] = patch[side];
  }
}

static int has_patch(const struct vg_mesh *m, const char *name)
{
  for (size_t i = 0; i < m->n_patch; i++)
    if (!strcmp(m->patch[i].name, name)) return 1;
  return 0;
}

static vg_status refuse_name(const char *name, const char *what,
                             struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "an element of the section has the name %s, which a %s has; "
                 "rename the element",
                 name, what);
}

/* The patches of the sides, then the planes. */
static vg_status add_patches(const struct vg_mesh *strip,
                             const struct vg_section_outer *outer,
                             struct vg_mesh *m, uint32_t side[SIDES],
                             uint32_t plane[2], struct vg_error *err)
{
  static const struct added {
    const char *name;
    int32_t bc, fun3d;
    int side;
  } tunnel[] = { { "lower", VG_BC_NONE, VG_BC_NONE, 0 },
                 { "upper", VG_BC_NONE, VG_BC_NONE, 2 },
                 { "inlet", 3, 5000, 3 },
                 { "outlet", 3, 5000, 1 } },
    farfield = { "farfield", 3, 5000, 0 },
    planes[] = { { "back", 1, 6663, 0 }, { "front", 1, 6663, 1 } };
  const int is_tunnel = outer->shape == VG_SECTION_TUNNEL;
  const struct added *list = is_tunnel ? tunnel : &farfield;
  size_t at;

  m->patch = vg_alloc(strip->n_patch, sizeof *m->patch);
  if (!m->patch) return vg_fail_memory(err, "the patches");
  m->n_patch = strip->n_patch;
  memcpy(m->patch, strip->patch, m->n_patch * sizeof *m->patch);
  for (int i = 0; i < (is_tunnel ? 4 : 1); i++) {
    if (has_patch(strip, list[i].name))
      return refuse_name(list[i].name, "side of the farfield", err);
    at = add_patch(m, list[i].name, list[i].bc, list[i].fun3d);
    if (at == SIZE_MAX) return vg_fail_memory(err, "the patches");
    if (is_tunnel) side[list[i].side] = (uint32_t)at;
    for (int k = 0; k < SIDES && !is_tunnel; k++) side[k] = (uint32_t)at;
  }
  for (int i = 0; i < 2; i++) {
    if (has_patch(strip, planes[i].name))
      return refuse_name(planes[i].name, "symmetry plane", err);
    at = add_patch(m, planes[i].name, planes[i].bc, planes[i].fun3d);
    if (at == SIZE_MAX) return vg_fail_memory(err, "the patches");
    plane[i] = (uint32_t)at;
  }
  return VG_OK;
}

/* The planes z = 0 and z = width of walls and farfield. */
static vg_status put_planes(struct vg_mesh *m,
                            const struct vg_size_function *size, size_t back,
                            size_t front, struct vg_error *err)
{
  const size_t n_strip = m->n_point / 2, first = m->n_tri;
  uint32_t(*edge)[2] = vg_alloc(n_strip, sizeof *edge);
  vg_status st;

  if (!edge) return vg_fail_memory(err, "the planes of a section");
  st = vg_planar_patch(m, list_edges(m, edge), (const uint32_t(*)[2])edge, size,
                       (uint32_t)back, err);
  free(edge);
  return st < 0 ? st : mirror(m, n_strip, first, (uint32_t)front, err);
}

vg_status vg_section_close(struct vg_mesh *strip,
                           const struct vg_section_outer *outer,
                           const struct vg_size_function *size,
                           struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  double(*x)[2] = NULL;
  size_t n = 0, end[SIDES];
  uint32_t side[SIDES], plane[2];
  vg_status st;

  VG_TRY(check_reach(strip, outer, err));
  VG_TRY(make_outer(outer, size, &n, &x, end, err));
  VG_TRY(place_points(strip, n, (const double(*)[2])x, &m, err));
  VG_TRY(add_patches(strip, outer, &m, side, plane, err));
  put_outer(&m, strip->n_point / 2, n, end, side);
  VG_TRY(put_planes(&m, size, plane[0], plane[1], err));
  vg_mesh_move(strip, &m);
done:
  free(x);
  vg_mesh_release(&m);
  return st;
}
