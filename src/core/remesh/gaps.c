#include "core/remesh/gaps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "core/remesh/reference.h"

#define GRAIN 256         /* triangles of a block */
#define DEPTH 64
#define FACING -0.7       /* S40: cosine between the two sides of a gap */
#define H_MIN 2e-5        /* of the length */
#define H_MAX 0.04
#define MOST 1e8          /* places */

/* Places of some triangles. */
struct block {
  size_t n, cap_x, cap_h;
  double (*x)[3], *h;
  int refused;
};

struct search {
  const struct vg_ref *ref;
  double edges, h_min, h_max;
  struct block *block;
  const struct vg_stop *stop;
};

/* Width of the gap above x on triangle t, its other side into y; INFINITY:
 * there is none. */
static double gap_at(const struct search *s, size_t t, const double x[3],
                     double y[3])
{
  const double *n = s->ref->shape[t].n;
  double far;
  uint32_t other = vg_ref_ray(s->ref, x, n, s->edges * s->h_max, &far);

  if (other == VG_REF_NONE || vg_dot(s->ref->shape[other].n, n) > FACING)
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

/* A part of triangle t, halved until it is as small as its gap is wide. */
static void visit(const struct search *s, size_t t, double p[3][3], int depth,
                  struct block *b)
{
  double x[3], y[3], gap, most = 0, half[3][3], mid[3];
  int edge = 0;

  if (vg_stops(s->stop)) return;
  for (int k = 0; k < 3; k++) {
    double l = vg_distance2(p[k], p[(k + 1) % 3]);

    x[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
    if (l > most) most = l, edge = k;
  }
  gap = gap_at(s, t, x, y);
  if (depth == DEPTH ||
      sqrt(most) <= fmax(fmin(gap, s->h_max), s->edges * s->h_min)) {
    double h = fmax(gap / s->edges, s->h_min);

    if (!(h < s->h_max)) return;
    add(b, x, h);
    add(b, y, h);
    return;
  }
  for (int k = 0; k < 3; k++)
    mid[k] = (p[edge][k] + p[(edge + 1) % 3][k]) / 2;
  for (int side = 0; side < 2; side++) {
    memcpy(half, p, sizeof half);
    memcpy(half[(edge + side) % 3], mid, sizeof mid);
    visit(s, t, half, depth + 1, b);
  }
}

static void visit_blocks(void *context, size_t first, size_t end, int worker)
{
  const struct search *s = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    for (size_t t = GRAIN * i; t < GRAIN * (i + 1) && t < s->ref->n_tri; t++) {
      const struct vg_ref_tri *shape = &s->ref->shape[t];
      double p[3][3];

      if (vg_dot(shape->n, shape->n) == 0) continue;
      for (int k = 0; k < 3; k++)
        memcpy(p[k], s->ref->point[s->ref->tri[t][k]], sizeof p[k]);
      visit(s, t, p, 0, &s->block[i]);
    }
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
  double lo[3], hi[3], length = 0, area = 0;

  if (!(o->edges > 0 && o->edges <= 1e4 && o->h_min >= 0 && o->h_max >= 0))
    return vg_fail(err, VG_ERR_INPUT, "%g edges across gaps, sizes %g to %g: "
                   "one of them is out of range", o->edges, o->h_min,
                   o->h_max);
  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++) length = fmax(length, hi[k] - lo[k]);
  s->edges = o->edges;
  s->h_min = o->h_min > 0 ? o->h_min : H_MIN * length;
  s->h_max = fmax(o->h_max > 0 ? o->h_max : H_MAX * length, s->h_min);
  for (size_t t = 0; t < m->n_tri; t++) {
    double n[3];

    vg_cross(s->ref->shape[t].u, s->ref->shape[t].v, n);
    area += vg_norm(n) / 2;
  }
  if (area < MOST * s->h_max * s->h_max) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "gaps would be looked for at some %.2g "
                 "places; are sizes in the unit of the surface?",
                 area / (s->h_max * s->h_max));
}

vg_status vg_gaps_find(const struct vg_mesh *m, const struct vg_gap_options *o,
                       struct vg_gaps *out, struct vg_error *err)
{
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
