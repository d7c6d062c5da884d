/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/gaps.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "core/remesh/reference.h"

#define GRAIN 256 /* triangles per task */
#define DEPTH 64
#define FACING -0.7 /* S40: largest cosine between the sides of a gap */
#define H_MIN 2e-5  /* default, of the length of the surface */
#define H_MAX 0.04
#define MOST 1e8 /* largest number of sample places */
/* S60: samples of a forecast, and most of them if gaps are narrow. */
#define SAMPLES 1e5
#define SAMPLES_MOST 1e6
#define FINE 1e4       /* least ratio of the limit to one sample's share */
#define TRIANGLE 0.433 /* area of a triangle of edge 1 */
#define PLACE                                                                  \
  0.15 /* of the squared width: area per place on one side of a gap */

/* Places on a group of triangles, or their forecast. */
struct block {
  size_t n, cap_x, cap_h;
  double (*x)[3], *h;
  int refused;
  double n_tri, n_place, narrowest, at[3];
  uint32_t patch[2];
};

struct search {
  const struct vg_ref *ref;
  const struct vg_mesh *m;
  double edges, h_min, h_max;
  double coarse, fine; /* Sample spacing of a forecast. */
  double most_tri, most_place;
  struct block *block;
  const struct vg_stop *stop;
};

/* Width of the gap above x on triangle t. Sets y to the point opposite x, and
 * *other to its triangle. INFINITY if no surface faces x within reach. */
static double gap_at(const struct search *s, size_t t, const double x[3],
                     double y[3], uint32_t *other)
{
  const double *n = s->ref->shape[t].n;
  double far;

  *other = vg_ref_ray(s->ref, x, n, s->edges * s->h_max, &far);
  if (*other == VG_REF_NONE || vg_dot(s->ref->shape[*other].n, n) > FACING)
    return INFINITY;
  for (int k = 0; k < 3; k++) y[k] = x[k] + far * n[k];
  return far;
}

static void add(struct block *b, const double x[3], double h)
{
  if (b->refused || vg_reserve(&b->x, &b->cap_x, b->n + 1, sizeof *b->x) ||
      vg_reserve(&b->h, &b->cap_h, b->n + 1, sizeof *b->h)) {
    b->refused = 1;
    return;
  }
  memcpy(b->x[b->n], x, sizeof *b->x);
  b->h[b->n++] = h;
}

/* Centroid x and length of the longest edge of part p of a triangle; *edge is
 * the number of that edge. */
static double measure(double p[3][3], double x[3], int *edge)
{
  double most = 0;

  *edge = 0;
  for (int k = 0; k < 3; k++) {
    double l = vg_distance2(p[k], p[(k + 1) % 3]);

    x[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
    if (l > most) most = l, *edge = k;
  }
  return sqrt(most);
}

static void halve(double p[3][3], int edge, int side, double half[3][3])
{
  double mid[3];

  for (int k = 0; k < 3; k++) mid[k] = (p[edge][k] + p[(edge + 1) % 3][k]) / 2;
  memcpy(half, p, 9 * sizeof **p);
  memcpy(half[(edge + side) % 3], mid, sizeof mid);
}

/* Edge length of the parts at which a gap of this width is sampled. */
static double part_size(const struct search *s, double gap)
{
  return fmax(fmin(gap, s->h_max), s->edges * s->h_min);
}

/* Bisect a part of triangle t until it is as small as the gap there is wide,
 * and add a place for it. */
static void visit(const struct search *s, size_t t, double p[3][3], int depth,
                  struct block *b)
{
  double x[3], y[3], gap, size, half[3][3];
  uint32_t other;
  int edge;

  if (vg_stops(s->stop)) return;
  size = measure(p, x, &edge);
  gap = gap_at(s, t, x, y, &other);
  if (depth == DEPTH || size <= part_size(s, gap)) {
    double h = fmax(gap / s->edges, s->h_min);

    if (!(h < s->h_max)) return;
    add(b, x, h);
    add(b, y, h);
    return;
  }
  for (int side = 0; side < 2; side++) {
    halve(p, edge, side, half);
    visit(s, t, half, depth + 1, b);
  }
}

static double area_of(double p[3][3])
{
  double u[3], v[3], n[3];

  vg_sub(p[1], p[0], u);
  vg_sub(p[2], p[0], v);
  vg_cross(u, v, n);
  return vg_norm(n) / 2;
}

/* Forecast the places in a part of triangle t, by one gap width for the whole
 * part. */
static void forecast(const struct search *s, size_t t, double p[3][3],
                     int depth, struct block *b)
{
  double x[3], y[3], gap, h, size, part, half[3][3], n_tri = 0, n_place = 0;
  uint32_t other;
  int edge, is_small;

  if (vg_stops(s->stop)) return;
  size = measure(p, x, &edge);
  gap = gap_at(s, t, x, y, &other);
  h = fmax(gap / s->edges, s->h_min);
  part = part_size(s, gap);
  if (h < s->h_max) {
    n_tri = area_of(p) / (TRIANGLE * h * h);
    n_place = area_of(p) / (PLACE * part * part);
  }
  is_small = FINE * n_tri < s->most_tri && FINE * n_place < s->most_place;
  if (depth == DEPTH || size <= part || size <= s->fine ||
      (size <= s->coarse && is_small)) {
    b->n_tri += n_tri;
    b->n_place += n_place;
    if (!(n_tri > 0) || !(gap < b->narrowest)) return;
    b->narrowest = gap;
    memcpy(b->at, x, sizeof b->at);
    b->patch[0] = s->m->tri_patch[t];
    b->patch[1] = s->m->tri_patch[other];
    return;
  }
  for (int side = 0; side < 2; side++) {
    halve(p, edge, side, half);
    forecast(s, t, half, depth + 1, b);
  }
}

/* Apply `to_part` to every triangle of block i with a positive area. */
static void each_triangle(const struct search *s, size_t i,
                          void (*to_part)(const struct search *s, size_t t,
                                          double p[3][3], int depth,
                                          struct block *b))
{
  for (size_t t = GRAIN * i; t < GRAIN * (i + 1) && t < s->ref->n_tri; t++) {
    const struct vg_ref_tri *shape = &s->ref->shape[t];
    double p[3][3];

    if (vg_dot(shape->n, shape->n) == 0) continue;
    for (int k = 0; k < 3; k++)
      memcpy(p[k], s->ref->point[s->ref->tri[t][k]], sizeof p[k]);
    to_part(s, t, p, 0, &s->block[i]);
  }
}

static void forecast_blocks(void *context, size_t first, size_t end, int worker)
{
  const struct search *s = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    s->block[i].narrowest = INFINITY;
    each_triangle(s, i, forecast);
  }
}

/* Returns 1 if the forecast exceeds a limit; *out then contains the
 * forecast. */
static int is_too_much(const struct search *s, size_t n_block, int threads,
                       struct vg_gaps *out)
{
  struct vg_gaps sum = VG_GAPS_INIT;

  vg_parallel_for(threads, n_block, 1, forecast_blocks, (void *)s);
  sum.narrowest = INFINITY;
  for (size_t i = 0; i < n_block; i++) {
    const struct block *b = &s->block[i];

    sum.n_tri += b->n_tri;
    sum.n_place += b->n_place;
    if (!(b->narrowest < sum.narrowest)) continue;
    sum.narrowest = b->narrowest;
    memcpy(sum.at, b->at, sizeof sum.at);
    memcpy(sum.patch, b->patch, sizeof sum.patch);
  }
  *out = sum;
  return sum.n_tri > s->most_tri || sum.n_place > s->most_place;
}

static void visit_blocks(void *context, size_t first, size_t end, int worker)
{
  const struct search *s = context;

  (void)worker;
  for (size_t i = first; i < end; i++) each_triangle(s, i, visit);
}

static vg_status gather(const struct block *block, size_t n_block,
                        struct vg_gaps *out, struct vg_error *err)
{
  size_t n = 0;

  for (size_t i = 0; i < n_block; i++) {
    if (block[i].refused) return vg_fail_memory(err, "the gaps");
    n += block[i].n;
  }
  if (!n) return VG_OK;
  out->x = vg_alloc(n, sizeof *out->x);
  out->h = vg_alloc(n, sizeof *out->h);
  if (!out->x || !out->h) return vg_fail_memory(err, "the gaps");
  for (size_t i = 0; i < n_block; i++) {
    if (!block[i].n) continue;
    memcpy(out->x + out->n, block[i].x, block[i].n * sizeof *out->x);
    memcpy(out->h + out->n, block[i].h, block[i].n * sizeof *out->h);
    out->n += block[i].n;
  }
  for (size_t i = 0; i + 1 < n; i += 2) {
    double width = vg_distance(out->x[i], out->x[i + 1]);

    if (i && !(width < out->narrowest)) continue;
    out->narrowest = width;
    memcpy(out->at, out->x[i], sizeof out->at);
  }
  return VG_OK;
}

static vg_status settle(const struct vg_mesh *m, const struct vg_gap_options *o,
                        struct search *s, struct vg_error *err)
{
  double length, area = 0;

  if (!(o->edges > 0 && o->edges <= 1e4 && o->h_min >= 0 && o->h_max >= 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "gaps: one of %g edges across gaps and sizes %g to %g is "
                   "out of range",
                   o->edges, o->h_min, o->h_max);
  length = vg_mesh_length(m);
  s->edges = o->edges;
  s->h_min = o->h_min > 0 ? o->h_min : H_MIN * length;
  s->h_max = fmax(o->h_max > 0 ? o->h_max : H_MAX * length, s->h_min);
  for (size_t t = 0; t < m->n_tri; t++) {
    double n[3];

    vg_cross(s->ref->shape[t].u, s->ref->shape[t].v, n);
    area += vg_norm(n) / 2;
  }
  s->m = m;
  s->coarse = sqrt(area / SAMPLES);
  s->fine = sqrt(area / SAMPLES_MOST);
  s->most_tri = o->most_tri > 0 ? o->most_tri : INFINITY;
  s->most_place = o->most_place > 0 ? o->most_place : INFINITY;
  if (area < MOST * s->h_max * s->h_max) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "the search for gaps would need some %.2g sample points; "
                 "check that sizes are in the unit of the surface",
                 area / (s->h_max * s->h_max));
}

vg_status vg_gaps_find(const struct vg_mesh *m, const struct vg_gap_options *o,
                       struct vg_gaps *out, struct vg_error *err)
{
  assert(m && o && !out->n && !out->x);

  struct vg_ref ref = VG_REF_INIT;
  struct search s = { .ref = &ref, .stop = &o->stop };
  struct vg_gaps found = VG_GAPS_INIT;
  size_t n_block = (m->n_tri + GRAIN - 1) / GRAIN;
  vg_status st;

  if (!m->n_tri) return VG_OK;
  VG_TRY(vg_ref_build(&ref, m, s.stop, err));
  VG_TRY(vg_stopped(s.stop, err));
  VG_TRY(settle(m, o, &s, err));
  s.block = vg_calloc(n_block, sizeof *s.block);
  if (!s.block) VG_TRY(vg_fail_memory(err, "the gaps"));
  if (is_too_much(&s, n_block, o->threads, &found)) {
    VG_TRY(vg_stopped(s.stop, err));
    *out = found;
    st = VG_BLOCKED;
    goto done;
  }
  VG_TRY(vg_stopped(s.stop, err));
  vg_parallel_for(o->threads, n_block, 1, visit_blocks, &s);
  VG_TRY(vg_stopped(s.stop, err));
  VG_TRY(gather(s.block, n_block, &found, err));
  *out = found;
  found = (struct vg_gaps)VG_GAPS_INIT;
done:
  for (size_t i = 0; s.block && i < n_block; i++) {
    free(s.block[i].x);
    free(s.block[i].h);
  }
  free(s.block);
  vg_gaps_release(&found);
  vg_ref_release(&ref);
  return st;
}

void vg_gaps_release(struct vg_gaps *g)
{
  free(g->x);
  free(g->h);
  *g = (struct vg_gaps)VG_GAPS_INIT;
}
