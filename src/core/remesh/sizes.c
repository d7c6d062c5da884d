/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/sizes.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/remesh/metric.h"
#include "core/remesh/strips.h"

#define SMOOTH 2 /* sweeps that average curvature over neighbours */
#define AROUND 3 /* S36: rings of triangles around a closed strip */
/* S76: least number of points at which a field is sampled. */
#define SAMPLES 65536
#define LEVELS 8   /* most levels with enlarged sizes */
#define FLOOR 0.02 /* S26: of the size without strips: least size */

/* Curvature tensor of a triangle, the sum over its edges, and its area. */
struct bend {
  double t[6], area;
};

/* Angle of a sine and cosine by plain arithmetic, without libm: from the
 * tangent t of half the angle by atan(t) ~ t (pi / 4 + 0.273 (1 - t)) for t <=
 * 1. */
static double angle_of(double sine, double cosine)
{
  double t = cosine > -1 ? sine / (1 + cosine) : 1e3;
  double s = t <= 1 ? t : 1 / t;
  double a = s * (0.7853981633974483 + 0.273 * (1 - s));

  return 2 * (t <= 1 ? a : 1.5707963267948966 - a);
}

/* --- curvature of faces -------------------------------------------------- */

/* Cohen-Steiner and Morvan, "Restricted Delaunay triangulations and normal
 * cycle", 2003: an edge contributes its dihedral angle as curvature across the
 * edge. The sum is taken per triangle, so that faces beyond a feature edge,
 * such as a large plane, do not contribute. */
static void add_edge(const struct vg_ref *r, uint32_t h, struct bend *bend)
{
  const double *n = r->shape[h / 3].n, *m = r->shape[r->mate[h] / 3].n;
  const uint32_t side[2] = { h / 3, r->mate[h] / 3 };
  double e[3], w[3], l, angle, k;
  uint32_t a = vg_ref_from(r, h), b = vg_ref_to(r, h);

  if (vg_dot(n, n) == 0 || vg_dot(m, m) == 0) return;
  vg_sub(r->point[b], r->point[a], e);
  l = vg_unit(e);
  vg_cross(n, m, w);
  angle = angle_of(vg_norm(w), vg_dot(n, m));
  if (vg_dot(w, e) < 0) angle = -angle;
  k = angle * l / 2; /* half of it to either side */
  for (int i = 0; i < 2; i++) {
    double *t = bend[side[i]].t;

    t[0] += k * e[0] * e[0];
    t[1] += k * e[1] * e[1];
    t[2] += k * e[2] * e[2];
    t[3] += k * e[0] * e[1];
    t[4] += k * e[1] * e[2];
    t[5] += k * e[2] * e[0];
  }
}

static void add_bend(struct bend *to, const struct bend *b, double share)
{
  for (int k = 0; k < 6; k++) to->t[k] += share * b->t[k];
  to->area += share * b->area;
}

/* Sum each tensor over a triangle and its neighbours, except across feature
 * edges. */
static void spread(const struct vg_ref *r, const struct vg_curves *c,
                   const struct bend *from, struct bend *to)
{
  memcpy(to, from, r->n_tri * sizeof *to);
  for (uint32_t h = 0; h < 3 * r->n_tri; h++)
    if (!c->line[h] && r->mate[h] != VG_REF_NONE)
      add_bend(&to[h / 3], &from[r->mate[h] / 3], 0.5);
}

/* The larger principal curvature, from trace and norm. */
static double curvature(const struct bend *b)
{
  double trace, norm2 = 0, rest;

  if (!(b->area > 0)) return 0;
  trace = fabs(b->t[0] + b->t[1] + b->t[2]);
  for (int k = 0; k < 6; k++) norm2 += (k < 3 ? 1 : 2) * b->t[k] * b->t[k];
  rest = 2 * norm2 - trace * trace;
  return (trace + (rest > 0 ? sqrt(rest) : 0)) / (2 * b->area);
}

static double arc_size(const struct vg_ref *r, const struct vg_sizes_options *o,
                       double curvature, const uint8_t *far, uint32_t p)
{
  const double chord = r->fine_at
                       ? fmin(o->chord, VG_SIZES_CHORD * r->fine_at[p])
                       : o->chord;
  double h;

  if (!(curvature > 0)) return o->h_max;
  h = 2 * M_PI / (curvature * o->per_turn);
  return far[p] ? h : fmin(h, sqrt(8 * chord / curvature));
}

/* Curvature of the faces from feature edge h around its start point to the next
 * feature edge. */
static double sector(const struct vg_ref *r, const struct vg_curves *c,
                     const struct bend *bend, uint32_t h)
{
  struct bend sum = { { 0 }, 0 };

  for (;;) {
    const uint32_t g = vg_half_prev(h);

    add_bend(&sum, &bend[h / 3], 1);
    if (c->line[g] || r->mate[g] == VG_REF_NONE) break;
    h = r->mate[g];
  }
  return curvature(&sum);
}

/* Sizes at points: from all triangles around the point together, but at a
 * feature edge from the side with the largest curvature. */
static vg_status by_triangles(struct vg_ref *r, const struct vg_curves *c,
                              const struct vg_sizes_options *o,
                              const struct bend *bend, const uint8_t *far,
                              struct vg_error *err)
{
  struct bend *sum = vg_calloc(r->n_point, sizeof *sum);

  if (!sum) return vg_fail_memory(err, "the curvature of the surface");
  for (size_t p = 0; p < r->n_point; p++) r->size[p] = INFINITY;
  for (uint32_t h = 0; h < 3 * r->n_tri; h++) {
    uint32_t p = r->tri[h / 3][h % 3];

    add_bend(&sum[p], &bend[h / 3], 1);
    if (c->line[h])
      r->size[p] = fmin(r->size[p],
                        arc_size(r, o, sector(r, c, bend, h), far, p));
  }
  for (size_t p = 0; p < r->n_point; p++) {
    if (!(r->size[p] < INFINITY))
      r->size[p] = arc_size(r, o, curvature(&sum[p]), far, p);
    r->size[p] = fmin(r->size[p], o->h_max);
  }
  free(sum);
  return VG_OK;
}

static vg_status by_faces(struct vg_ref *r, const struct vg_curves *c,
                          const struct vg_sizes_options *o, const uint8_t *far,
                          struct vg_error *err)
{
  struct bend *b = vg_calloc(r->n_tri, sizeof *b);
  struct bend *s = vg_alloc(r->n_tri, sizeof *s), *swap;
  vg_status st = VG_OK;

  if (!b || !s) VG_TRY(vg_fail_memory(err, "the curvature of the surface"));
  for (size_t t = 0; t < r->n_tri; t++) {
    double n[3];

    vg_cross(r->shape[t].u, r->shape[t].v, n);
    b[t].area = vg_norm(n) / 2;
  }
  for (uint32_t h = 0; h < 3 * r->n_tri; h++)
    if (r->mate[h] != VG_REF_NONE && h < r->mate[h] && !c->line[h] &&
        !(c->closed && c->closed[h]))
      add_edge(r, h, b);
  for (int i = 0; i < SMOOTH; i++) {
    spread(r, c, b, s);
    swap = b;
    b = s;
    s = swap;
    VG_TRY(vg_stopped(&o->stop, err));
  }
  VG_TRY(by_triangles(r, c, o, b, far, err));
done:
  free(b);
  free(s);
  return st;
}

/* --- feature curves and narrow strips ------------------------------------- */

static void by_curves(struct vg_ref *r, const struct vg_curves *c,
                      const struct vg_sizes_options *o, const uint8_t *far)
{
  for (size_t i = 0; i < c->n_curve; i++)
    for (size_t k = c->curve[i].first + 1;
         k + 1 < c->curve[i].first + c->curve[i].n; k++) {
      double u[3], v[3], w[3], lu, lv, angle;

      vg_sub(r->point[c->point[k]], r->point[c->point[k - 1]], u);
      vg_sub(r->point[c->point[k + 1]], r->point[c->point[k]], v);
      lu = vg_unit(u);
      lv = vg_unit(v);
      vg_cross(u, v, w);
      angle = angle_of(vg_norm(w), vg_dot(u, v));
      /* A jag smaller than the tolerance is not an arc. */
      if (angle * fmin(lu, lv) < o->chord) continue;
      r->size[c->point[k]] = fmin(r->size[c->point[k]],
                                  arc_size(r, o, 2 * angle / (lu + lv), far,
                                           c->point[k]));
    }
}

/* Least size at a strip of width w in surroundings of the given size. The
 * thinner the edge of a body is, the more it is like a sharp edge, which asks
 * for none. */
static double floor_of(double plain, double w, int is_edge)
{
  const double least = FLOOR * plain;

  return is_edge && w < least ? fmin(least * sqrt(least / w), plain) : least;
}

/* Size at a strip: its width times `strip`, divided by the number of edges
 * requested across it. */
static void by_strip(struct vg_ref *r, const struct vg_curves *c, uint32_t h,
                     double strip, double across, double h_shape)
{
  static const double share[3] = { 0.1, 0.5, 0.9 };
  const double factor = strip / across;
  const double *a = vg_ref_at(r, h), *b = vg_ref_at(r, vg_half_next(h));
  uint32_t end[2] = { vg_ref_from(r, h), vg_ref_to(r, h) };

  for (int i = 0; i < 3; i++) {
    const double most = fmax(r->plain[end[0]], r->plain[end[1]]);
    struct vg_strip_end far_end;
    double x[3], w;
    int is_edge;

    for (int k = 0; k < 3; k++) x[k] = a[k] + share[i] * (b[k] - a[k]);
    w = factor * vg_strip_width(r, c, h, x, most / factor, &far_end);
    if (!(w <= most)) continue;
    is_edge = !(across > 1) && vg_strip_is_edge(r, h, far_end.half);
    for (int k = 0; k < 2; k++)
      if (i != (k ? 0 : 2) && w < r->size[end[k]])
        r->size[end[k]] = fmax(
          w,
          fmin(r->plain[end[k]],
               fmax(floor_of(r->plain[end[k]], w, is_edge), h_shape) / across));
  }
}

/* Find the points all of whose triangles are on an outer boundary. */
static void find_far(const struct vg_ref *r, const double *cap, uint8_t *far)
{
  memset(far, cap != NULL, r->n_point);
  for (size_t t = 0; cap && t < r->n_tri; t++)
    for (int k = 0; k < 3; k++)
      if (cap[t] < INFINITY) far[r->tri[t][k]] = 0;
}

/* Mark the triangles whose sizes are reduced by strips, and those around closed
 * edges. */
static vg_status mark_strips(struct vg_ref *r, const struct vg_curves *c,
                             struct vg_error *err)
{
  const uint32_t n = (uint32_t)(3 * r->n_tri);
  uint8_t *near;

  for (uint32_t h = 0; h < n; h++) {
    uint32_t p = r->tri[h / 3][h % 3];

    if (r->size[p] < r->plain[p]) r->strip[h / 3] = VG_REF_STRIP;
  }
  if (!c->closed) return VG_OK;
  near = vg_calloc(r->n_point, 1);
  if (!near) return vg_fail_memory(err, "the sizes on the surface");
  for (int ring = 0; ring < AROUND; ring++) {
    for (uint32_t h = 0; h < n; h++)
      if (ring ? r->strip[h / 3] == VG_REF_CLOSED : c->closed[h])
        near[vg_ref_from(r, h)] = near[vg_ref_to(r, h)] = 1;
    for (uint32_t h = 0; h < n; h++)
      if (near[r->tri[h / 3][h % 3]]) r->strip[h / 3] = VG_REF_CLOSED;
  }
  free(near);
  return VG_OK;
}

vg_status vg_sizes_make(struct vg_ref *r, const struct vg_curves *c,
                        const struct vg_sizes_options *o, struct vg_error *err)
{
  assert(o->h_max >= o->h_min && isfinite(o->h_max));
  assert(o->growth >= 1);

  uint8_t *far = vg_alloc(r->n_point, 1);
  vg_status st = VG_OK;

  r->slope = o->growth - 1;
  r->size = vg_alloc(r->n_point, sizeof *r->size);
  r->plain = vg_alloc(r->n_point, sizeof *r->plain);
  r->strip = vg_calloc(r->n_tri, 1);
  if (!r->size || !r->plain || !r->strip || !far)
    VG_TRY(vg_fail_memory(err, "the sizes on the surface"));
  find_far(r, o->cap, far);
  VG_TRY(by_faces(r, c, o, far, err));
  VG_TRY(vg_stopped(&o->stop, err));
  by_curves(r, c, o, far);
  for (size_t p = 0; p < r->n_point; p++)
    r->size[p] = fmax(r->size[p], fmin(o->h_shape, o->h_max));
  for (size_t t = 0; o->cap && t < r->n_tri; t++)
    for (int k = 0; k < 3; k++)
      r->size[r->tri[t][k]] = fmin(r->size[r->tri[t][k]], o->cap[t]);
  for (size_t p = 0; o->point_cap && p < r->n_point; p++)
    r->size[p] = fmin(r->size[p], o->point_cap[p]);
  for (size_t p = 0; p < r->n_point; p++)
    r->size[p] = fmin(o->h_max, fmax(o->h_min, r->size[p]));
  memcpy(r->plain, r->size, r->n_point * sizeof *r->plain);
  for (uint32_t h = 0; h < 3 * r->n_tri; h++)
    if (c->line[h] && !vg_stops(&o->stop))
      by_strip(r, c, h, o->strip,
               o->across ? o->across[o->tri_patch[h / 3]] : 1, o->h_shape);
  for (size_t p = 0; p < r->n_point; p++)
    r->size[p] = fmax(o->h_min, r->size[p]);
  vg_ref_sizes(r);
  VG_TRY(vg_stopped(&o->stop, err));
  VG_TRY(mark_strips(r, c, err));
done:
  free(far);
  return st;
}

/* --- the sizes of a field ------------------------------------------------- */

/* Sizes are sampled at the centroids of n * n triangles in each triangle. */
static double triangles_in(const struct vg_ref *r, uint32_t t, int n,
                           const struct vg_sizing *field, double h_max)
{
  const struct vg_ref_tri *s = &r->shape[t];
  const uint32_t *v = r->tri[t];
  double sum = 0, area[3];

  for (int i = 0; i < n; i++)
    for (int k = 0; k < 2 * (n - i) - 1; k++) {
      const double a = (i + (1 + k % 2) / 3.0) / n;
      const double b = (k / 2 + (1 + k % 2) / 3.0) / n;
      struct vg_metric m;
      double x[3];

      for (int d = 0; d < 3; d++) x[d] = s->a[d] + a * s->u[d] + b * s->v[d];
      m.size = fmin(h_max, (1 - a - b) * r->size[v[0]] + a * r->size[v[1]] +
                             b * r->size[v[2]]);
      vg_follow_field(field, x, s->n, 1, 0, &m);
      sum += sqrt(vg_form_area2(m.form, s->n)) / (m.size * m.size);
    }
  vg_cross(s->u, s->v, area);
  return sum / (n * n) * vg_norm(area) / 0.8660254037844386;
}

int vg_sizes_levels(const struct vg_ref *r, const struct vg_sizing *field,
                    double h_max)
{
  const double each = SAMPLES / (double)r->n_tri;
  double n = 0, most = 4 * (double)r->n_tri;
  int level = 0;

  if (!field) return 0;
  for (uint32_t t = 0; t < r->n_tri; t++)
    n += triangles_in(r, t, each > 1 ? (int)ceil(sqrt(each)) : 1, field, h_max);
  for (; level < LEVELS && n > most; n /= 4) level++;
  return level;
}
