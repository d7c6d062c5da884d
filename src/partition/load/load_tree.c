/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: the owner of a point follows from a point with a known owner and
 * the triangles that a path of axis-parallel segments crosses: +1 where the
 * path runs along a normal, -1 against it. A path within a node meets only
 * triangles of the node's own list, so no search is needed. Signs are exact. A
 * point that projects onto an edge counts for one of the two triangles of the
 * edge (symbolic perturbation by e, e^2). */
#include "partition/load/load_tree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/predicates.h"
#include "core/geometry/volume.h"

enum { GRAIN = 1 << 14, FIT_PASSES = 4 };

/* A relative volume error above this is corrected, by the octants that the
 * front crosses if that is possible, else by all octants equally. */
#define FITS 1e-5

/* --- fronts -------------------------------------------------------------- */

double vg_load_volume(const struct vg_front *v)
{
  const double *o = v->n_face ? v->x[v->face[0][0]] : NULL;

  /* Normals point inwards. */
  return -vg_enclosed6(v->n_face, (const uint32_t(*)[3])v->face,
                       (const double(*)[3])v->x, o) /
         6;
}

void vg_load_box(const struct vg_front *v, double lo[3], double hi[3])
{
  for (int k = 0; k < 3; k++) {
    lo[k] = INFINITY;
    hi[k] = -INFINITY;
  }
  for (size_t i = 0; i < v->n_face; i++)
    for (int j = 0; j < 3; j++) {
      const double *x = v->x[v->face[i][j]];

      for (int k = 0; k < 3; k++) {
        if (x[k] < lo[k]) lo[k] = x[k];
        if (x[k] > hi[k]) hi[k] = x[k];
      }
    }
}

struct enter_job {
  const struct vg_load_tree *t;
  uint32_t child;
  size_t at;
};

static uint32_t to_lattice(double x)
{
  if (!(x > 0)) return 0;
  return x < 0x1p31 ? (uint32_t)x : (uint32_t)INT32_MAX;
}

static void enter_part(void *context, size_t first, size_t end, int worker)
{
  const struct enter_job *job = context;
  const struct vg_load_tree *t = job->t;
  const struct vg_front *v = &t->child[job->child];
  const double scale = 1 / t->unit;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_load_tri *tri = &t->tri[job->at + i];
    const double *a = v->x[v->face[i][0]], *b = v->x[v->face[i][1]];
    const double *c = v->x[v->face[i][2]];

    tri->child = job->child;
    tri->face = (uint32_t)i;
    for (int k = 0; k < 3; k++) {
      double lo = a[k] < b[k] ? a[k] : b[k], hi = a[k] < b[k] ? b[k] : a[k];

      if (c[k] < lo) lo = c[k];
      if (c[k] > hi) hi = c[k];
      tri->lo[k] = to_lattice((lo - t->lo[k]) * scale);
      tri->hi[k] = to_lattice((hi - t->lo[k]) * scale);
    }
  }
}

vg_status vg_load_tree_new(struct vg_load_tree *t, size_t n,
                           const struct vg_front *child, int threads,
                           struct vg_error *err)
{
  struct enter_job job = { t, 0, 0 };

  assert(t->unit > 0 && (child || !n) && threads >= 0);
  t->child = child;
  t->n_tri = 0;
  for (size_t c = 0; c < n; c++) t->n_tri += child[c].n_face;
  t->tri = t->n_tri < UINT32_MAX && n < INT32_MAX
           ? vg_alloc(t->n_tri, sizeof *t->tri)
           : NULL;
  if (!t->tri) return vg_fail_memory(err, "the load estimate");
  for (size_t c = 0; c < n; c++) {
    job.child = (uint32_t)c;
    vg_parallel_for(threads, child[c].n_face, GRAIN, enter_part, &job);
    job.at += child[c].n_face;
  }
  return VG_OK;
}

void vg_load_tree_release(struct vg_load_tree *t)
{
  free(t->tri);
  t->tri = NULL;
}

void vg_load_stack_release(struct vg_load_stack *s)
{
  free(s->item);
  free(s->mask);
  memset(s, 0, sizeof *s);
}

/* --- crossings ----------------------------------------------------------- */

/* The side of ab on which p lies in the plane of axes u and v. 0: the edge
 * projects to a point. */
static int side_of(const double *a, const double *b, const double p[2], int u,
                   int v)
{
  const double pa[2] = { a[u], a[v] }, pb[2] = { b[u], b[v] };
  const double s = vg_orient2d(pa, pb, p);

  if (s < 0 || s > 0) return s > 0 ? 1 : -1;
  if (a[v] < b[v] || a[v] > b[v]) return a[v] > b[v] ? 1 : -1;
  return (b[u] > a[u]) - (b[u] < a[u]);
}

/* Crossing of one triangle by the step from lattice point p to p[axis] = to:
 * +1 into the void, -1 out of it, 0 no crossing. */
static int crossing(const struct vg_load_tree *t, const struct vg_load_tri *tri,
                    int axis, const uint32_t p[3], uint32_t to)
{
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const struct vg_front *f = &t->child[tri->child];
  const uint32_t *face = f->face[tri->face];
  const double *a = f->x[face[0]], *b = f->x[face[1]], *c = f->x[face[2]];
  double x[3], y[3], q[2];
  int s;

  for (int k = 0; k < 3; k++) y[k] = x[k] = t->lo[k] + p[k] * t->unit;
  y[axis] = t->lo[axis] + to * t->unit;
  q[0] = x[u];
  q[1] = x[v];
  s = side_of(a, b, q, u, v);
  if (!s || side_of(b, c, q, u, v) != s || side_of(c, a, q, u, v) != s)
    return 0;
  /* s is the sign of the normal along the axis */
  if (s * vg_orient3d(a, b, c, x) < 0)
    return s * vg_orient3d(a, b, c, y) < 0 ? 0 : s;
  return 0;
}

/* Change of owner along that step, over the triangles of a list. */
static int32_t along(const struct vg_load_tree *t, const uint32_t *list,
                     size_t n, int axis, const uint32_t p[3], uint32_t to)
{
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int32_t sum = 0;

  for (size_t i = 0; i < n; i++) {
    const struct vg_load_tri *tri = &t->tri[list[i]];

    if (tri->lo[u] > p[u] || tri->hi[u] < p[u] || tri->lo[v] > p[v] ||
        tri->hi[v] < p[v] || tri->lo[axis] > to || tri->hi[axis] < p[axis])
      continue;
    sum += crossing(t, tri, axis, p, to) * (int32_t)(tri->child + 1);
  }
  return sum;
}

/* --- nodes --------------------------------------------------------------- */

/* Octants that a triangle's box touches, as a bit mask. */
static uint8_t octant_mask(const struct vg_load_tri *tri, const uint32_t mid[3])
{
  static const uint8_t low[3] = { 0x55, 0x33, 0x0f };
  uint8_t mask = 0xff;

  for (int k = 0; k < 3; k++) {
    if (tri->lo[k] > mid[k]) mask &= (uint8_t)~low[k];
    if (tri->hi[k] < mid[k]) mask &= low[k];
  }
  return mask;
}

struct mask_job {
  const struct vg_load_tree *t;
  const uint32_t *list, *mid;
  uint8_t *mask;
};

static void mask_part(void *context, size_t first, size_t end, int worker)
{
  const struct mask_job *job = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    job->mask[i] = octant_mask(&job->t->tri[job->list[i]], job->mid);
}

/* Pushes the lists of the octants. */
static int distribute(const struct vg_load_tree *t, struct vg_load_stack *s,
                      const struct vg_load_node *node,
                      struct vg_load_node out[8], int threads)
{
  struct mask_job job = { t, NULL, out[7].at, NULL };
  size_t all = 0, at[8];

  if (vg_reserve(&s->mask, &s->cap_mask, node->n, 1)) return -1;
  job.list = s->item + node->first;
  job.mask = s->mask;
  if (node->n < 2 * GRAIN) mask_part(&job, 0, node->n, 0);
  else vg_parallel_for(threads, node->n, GRAIN, mask_part, &job);
  for (size_t i = 0; i < node->n; i++)
    for (unsigned m = s->mask[i]; m; m &= m - 1) out[__builtin_ctz(m)].n++;
  for (int o = 0; o < 8; o++) {
    at[o] = out[o].first = s->n + all;
    all += out[o].n;
  }
  if (vg_reserve(&s->item, &s->cap, s->n + all, sizeof *s->item)) return -1;
  for (size_t i = 0; i < node->n; i++)
    for (unsigned m = s->mask[i]; m; m &= m - 1)
      s->item[at[__builtin_ctz(m)]++] = s->item[node->first + i];
  s->n += all;
  return 0;
}

int vg_load_octants(const struct vg_load_tree *t, struct vg_load_stack *s,
                    const struct vg_load_node *node, struct vg_load_node out[8],
                    int threads)
{
  const uint32_t half = vg_load_side(node) / 2;

  for (int o = 0; o < 8; o++) {
    out[o] = (struct vg_load_node){ .level = node->level + 1,
                                    .owner = node->owner };
    for (int k = 0; k < 3; k++)
      out[o].at[k] = node->at[k] + (o >> k & 1 ? half : 0);
  }
  if (!node->n) return 0;
  if (distribute(t, s, node, out, threads)) return -1;
  /* along the edges of octants, each with the list of the octant it starts
   * from */
  for (int o = 1; o < 8; o++) {
    const int axis = o >> 2 ? 2 : o >> 1 ? 1 : 0, from = o ^ 1 << axis;

    out[o].owner = out[from].owner + along(t, s->item + out[from].first,
                                           out[from].n, axis, out[from].at,
                                           out[o].at[axis]);
  }
  return 0;
}

/* --- samples ------------------------------------------------------------- */

/* A pseudorandom number from the position of a node: mixing after Steele, Lea
 * and Flood, "Fast splittable pseudorandom number generators" (2014). */
static uint64_t scatter(const struct vg_load_node *node)
{
  uint64_t z = 0;

  for (int k = 0; k < 3; k++) {
    z += node->at[k] + VG_GOLDEN;
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    z ^= z >> 31;
  }
  return z;
}

void vg_load_sample(const struct vg_load_tree *t, const struct vg_load_stack *s,
                    const struct vg_load_node *node,
                    int32_t owner[VG_LOAD_SAMPLES], uint32_t at[3])
{
  const uint32_t half = vg_load_side(node) / 2;
  const uint32_t *list = s->item + node->first;
  const uint64_t z = scatter(node);
  uint32_t p[3] = { node->at[0], node->at[1], node->at[2] };
  int32_t own = node->owner;

  for (int k = 0; k < 3; k++) {
    /* 21 bits each: a fraction of half a node, never 0 */
    const uint64_t share = 2 * (z >> 21 * k & 0xfffff) + 1;
    const uint32_t to = p[k] + (uint32_t)(share * half >> 21);

    own += along(t, list, node->n, k, p, to);
    p[k] = to;
  }
  owner[0] = own;
  memcpy(at, p, sizeof p);
  for (int o = 1; o < 8; o++) {
    const int axis = o >> 2 ? 2 : o >> 1 ? 1 : 0, from = o ^ 1 << axis;
    uint32_t q[3];

    for (int k = 0; k < 3; k++) q[k] = p[k] + (from >> k & 1 ? half : 0);
    owner[o] = owner[from] + along(t, list, node->n, axis, q, q[axis] + half);
  }
}

/* --- volumes ------------------------------------------------------------- */

static double octant_volume(const struct vg_load_octant *c)
{
  return 8 * (double)c->half * (double)c->half * (double)c->half;
}

void vg_load_copy_frame(const struct vg_load *from, struct vg_load *to)
{
  memcpy(to->lo, from->lo, sizeof to->lo);
  to->unit = from->unit;
  to->is_block = from->is_block;
  memcpy(to->from, from->from, sizeof to->from);
  memcpy(to->to, from->to, sizeof to->to);
}

double vg_load_parts(const struct vg_load *l)
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++)
    sum += octant_volume(&l->octant[i]) * (double)l->octant[i].part;
  return sum;
}

static void multiply(struct vg_load_octant *c, double factor)
{
  c->part = (float)((double)c->part * factor);
  c->cells = (float)((double)c->cells * factor);
}

/* Least squares: the fraction p of an octant is assumed to have a squared error
 * of p (1 - p). The missing volume is therefore distributed by the octant's
 * volume times that; most of it goes to large octants, which have the large
 * errors. */
static void fit_parts(struct vg_load *l, double missing)
{
  double weight = 0;

  for (size_t i = 0; i < l->n; i++) {
    const double v = octant_volume(&l->octant[i]),
                 p = (double)l->octant[i].part;

    weight += v * v * p * (1 - p);
  }
  for (size_t i = 0; i < l->n && weight > 0; i++) {
    const double v = octant_volume(&l->octant[i]),
                 p = (double)l->octant[i].part;
    const double f = 1 + missing * v * (1 - p) / weight;

    multiply(&l->octant[i], fmin(fmax(f, 0.5), 1 / p));
  }
}

void vg_load_fit(struct vg_load *l, double volume)
{
  assert(volume >= 0);

  double sum = vg_load_parts(l);

  for (int pass = 0; pass < FIT_PASSES && volume > 0; pass++) {
    if (fabs(volume - sum) <= FITS * volume) break;
    fit_parts(l, volume - sum);
    sum = vg_load_parts(l);
  }
  l->cells = 0;
  for (size_t i = 0; i < l->n; i++) {
    if (volume > 0 && fabs(volume - sum) > FITS * volume)
      multiply(&l->octant[i], volume / sum);
    l->cells += (double)l->octant[i].cells;
  }
}
