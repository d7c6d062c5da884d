/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Parts and rims of the input: the holes through which a wrap can enter. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"
#include "core/surface/surface_check.h"
#include "core/wrap/wrap_parts.h"

#define OPEN 15.0    /* S44: VG_WRAP_CLOSED of a sheet wrapped on both sides */
#define SECONDS 3e-4 /* per triangle */
#define CRACK 1e-3   /* of the size: narrower cracks are welded */
#define EDGE 0.05    /* of the mean edge: wider cracks are not welded */
#define POCKET                                                                 \
  1.5 /* S70: area over that of the lids; 1: flat sheet, 2: half a sphere */
#define CERTAIN 4.0 /* S70: sizes: a ball goes through a wider rim */

static uint32_t root(uint32_t *up, uint32_t i)
{
  while (up[i] != i) i = up[i] = up[up[i]];
  return i;
}

/* The lower number becomes the root. */
static void unite(uint32_t *up, uint32_t a, uint32_t b)
{
  a = root(up, a);
  b = root(up, b);
  if (a < b) up[b] = a;
  else up[a] = b;
}

static double cross_norm(const double a[3], const double b[3],
                         const double c[3])
{
  double u[3], v[3], n[3];

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_cross(u, v, n);
  return vg_norm(n);
}

static double mean_edge(const struct vg_mesh *m)
{
  double sum = 0;

  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      sum += vg_distance(m->point[m->tri[i][k]],
                         m->point[m->tri[i][(k + 1) % 3]]);
  return sum / (3 * (double)m->n_tri);
}

/* Find the parts connected by edges, and the rim edges as 3 * triangle + k. */
static vg_status connect(struct vg_wrap_rims *r, uint32_t *rim, size_t *n_rim,
                         struct vg_error *err)
{
  const struct vg_mesh *m = &r->m;
  struct vg_edges e = VG_EDGES_INIT;
  vg_status st;

  VG_TRY(vg_edges_build(&e, m->n_point, m->n_tri, (const uint32_t(*)[3])m->tri,
                        NULL, 0, err));
  for (size_t i = 0; i < m->n_tri; i++) r->part_of[i] = (uint32_t)i;
  for (size_t i = 0; i < e.n; i++) {
    const uint32_t n = vg_edges_count(&e, i), *h = vg_edges_at(&e, i);

    for (uint32_t k = 1; k < n; k++) unite(r->part_of, h[0] / 3, h[k] / 3);
    if (n == 1) rim[(*n_rim)++] = h[0];
  }
  for (size_t i = 0; i < m->n_tri; i++)
    r->part_of[i] = root(r->part_of, (uint32_t)i);
  /* Number the parts in the order of their first triangles, which are the
   * roots. */
  for (size_t i = 0; i < m->n_tri; i++)
    r->part_of[i] = r->part_of[i] == i ? (uint32_t)r->n_part++
                                       : r->part_of[r->part_of[i]];
done:
  vg_edges_release(&e);
  return st;
}

/* A connected set of rim edges. */
struct rim {
  double length, area, middle[3];
  uint32_t part;
};

static const double *end_of(const struct vg_mesh *m, uint32_t edge, uint32_t k)
{
  return m->point[m->tri[edge / 3][(edge + k) % 3]];
}

/* Node number of end_of. (edge + k) % 3 is valid because 3 divides 3 *
 * triangle. */
static uint32_t node_of(const struct vg_mesh *m, uint32_t edge, uint32_t k)
{
  return m->tri[edge / 3][(edge + k) % 3];
}

/* Two passes over the edges: first the centres of the rims, then the areas of
 * the fans of triangles that close them. */
static void measure_rims(const struct vg_mesh *m, const uint32_t *part_of,
                         const uint32_t *edge, size_t n, uint32_t *up,
                         struct rim *rim)
{
  for (size_t i = 0; i < n; i++)
    unite(up, node_of(m, edge[i], 0), node_of(m, edge[i], 1));
  for (size_t i = 0; i < n; i++) {
    const double *a = end_of(m, edge[i], 0), *b = end_of(m, edge[i], 1);
    struct rim *x = &rim[root(up, node_of(m, edge[i], 0))];
    double length = vg_distance(a, b);

    for (int k = 0; k < 3; k++) x->middle[k] += length * (a[k] + b[k]) / 2;
    x->length += length;
    x->part = part_of[edge[i] / 3];
  }
  for (size_t i = 0; i < n; i++) {
    struct rim *x = &rim[root(up, node_of(m, edge[i], 0))];
    double c[3];

    if (!(x->length > 0)) continue;
    for (int k = 0; k < 3; k++) c[k] = x->middle[k] / x->length;
    x->area += cross_norm(c, end_of(m, edge[i], 0), end_of(m, edge[i], 1)) / 2;
  }
}

/* The width is the diameter of a circle whose ratio of area to length is that
 * of the rim. */
static void add_rim(struct vg_wrap_part *part, const struct rim *x)
{
  double width = 4 * x->area / x->length;

  part->lid += x->area;
  if (!(width > part->widest)) return;
  part->widest = width;
  for (int k = 0; k < 3; k++) part->at[k] = x->middle[k] / x->length;
}

static vg_status measure_parts(struct vg_wrap_rims *r, const uint32_t *edge,
                               size_t n, struct vg_error *err)
{
  const struct vg_mesh *m = &r->m;
  uint32_t *up = vg_alloc(m->n_point, sizeof *up);
  struct rim *rim = vg_calloc(m->n_point, sizeof *rim);
  vg_status st = VG_OK;

  r->part = vg_calloc(r->n_part, sizeof *r->part);
  if (!up || !rim || !r->part) VG_TRY(vg_fail_memory(err, "a wrap"));
  for (size_t i = 0; i < m->n_tri; i++)
    r->part[r->part_of[i]].area += cross_norm(m->point[m->tri[i][0]],
                                              m->point[m->tri[i][1]],
                                              m->point[m->tri[i][2]]) /
                                   2;
  for (size_t i = 0; i < m->n_point; i++) up[i] = (uint32_t)i;
  measure_rims(m, r->part_of, edge, n, up, rim);
  for (size_t i = 0; i < m->n_point; i++)
    if (rim[i].length > 0) add_rim(&r->part[rim[i].part], &rim[i]);
  for (size_t i = 0; i < r->n_part; i++)
    r->part[i].is_pocket = r->part[i].widest > 0 &&
                           r->part[i].area > POCKET * r->part[i].lid;
done:
  free(up);
  free(rim);
  return st;
}

vg_status vg_wrap_rims_find(const struct vg_mesh *m, double size,
                            struct vg_wrap_rims *r, struct vg_error *err)
{
  uint32_t *rim = NULL;
  size_t n_rim = 0;
  vg_status st;

  assert(size > 0 && !r->part && !r->part_of);
  VG_TRY(vg_mesh_copy(&r->m, m, err));
  VG_TRY(vg_surface_weld(&r->m, fmin(CRACK * size, EDGE * mean_edge(m)), NULL,
                         NULL, err));
  r->part_of = vg_alloc(r->m.n_tri, sizeof *r->part_of);
  rim = vg_alloc(3 * r->m.n_tri, sizeof *rim);
  if (!r->part_of || !rim) VG_TRY(vg_fail_memory(err, "a wrap"));
  VG_TRY(connect(r, rim, &n_rim, err));
  VG_TRY(measure_parts(r, rim, n_rim, err));
done:
  free(rim);
  return st;
}

void vg_wrap_rims_release(struct vg_wrap_rims *r)
{
  vg_mesh_release(&r->m);
  free(r->part_of);
  free(r->part);
  memset(r, 0, sizeof *r);
}

struct vg_wrap_forecast vg_wrap_count(const struct vg_wrap_rims *r, double size)
{
  assert(size > 0);

  struct vg_wrap_forecast f = { .n_part = r->n_part };

  for (size_t i = 0; i < r->n_part; i++) {
    const struct vg_wrap_part *p = &r->part[i];

    f.area += p->area;
    f.triangles += (p->widest > size ? OPEN : VG_WRAP_CLOSED) * p->area;
    f.n_open += p->widest > 0;
    if (!p->is_pocket || !(p->widest > f.widest)) continue;
    f.widest = p->widest;
    memcpy(f.at, p->at, sizeof f.at);
  }
  f.triangles /= size * size;
  f.seconds = SECONDS * f.triangles;
  return f;
}

vg_status vg_wrap_refuse_open(const struct vg_wrap_rims *r, double size,
                              const struct vg_stop *stop, struct vg_error *err)
{
  const struct vg_wrap_part *p = r->part;
  double foot[1][3];
  uint32_t tri;
  vg_status st;

  if (r->n_part != 1 || !p->is_pocket || !(p->widest > CERTAIN * size))
    return VG_OK;
  VG_TRY(vg_wrap_nearest(&r->m, 1, (const double(*)[3]) & p->at, stop, foot,
                         &tri, err));
  if (vg_distance(p->at, foot[0]) > size)
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "a wrap of size %g would go through the "
                 "holes of the surface and become a hollow shell with fluid "
                 "inside it: holes are up to %.3g wide, the widest at (%.6g, "
                 "%.6g, %.6g). Close them (close_holes yes), or take a wrap of "
                 "size > %.3g, which closes them",
                 size, p->widest, p->at[0], p->at[1], p->at[2], p->widest);
done:
  return st;
}
