/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Second derivatives by two projections. */
#include "core/hessian/hessian.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/cell_edges.h"
#include "core/mesh/cell_faces.h"
#include "core/mesh/cell_links.h"
#include "core/mesh/edges.h"
#include "core/mesh/slices.h"

/* Edges from a point of the first ring to those whose Hessians it takes. */
enum { NEAR = 3 };

/* Rows of a tensor in its six components. */
static const int row[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };

static const struct kind {
  int n_face, n_edge;
  const unsigned char (*face)[4], (*edge)[2];
} kinds[VG_SLICE_KINDS] = { { 4, 6, vg_tet_face, vg_tet_edge },
                            { 5, 8, vg_pyr_face, vg_pyr_edge },
                            { 5, 9, vg_pri_face, vg_pri_edge },
                            { 6, 12, vg_hex_face, vg_hex_edge } };

static vg_status no_memory(struct vg_error *err)
{
  return vg_fail_memory(err, "the Hessians of a solution");
}

/* Cells of a kind. */
static const uint32_t *cells_of(const struct vg_mesh *m, int kind, size_t *n)
{
  switch (kind) {
  case VG_SLICE_TET: *n = m->n_tet; return *n ? m->tet[0] : NULL;
  case VG_SLICE_PYR: *n = m->n_pyr; return *n ? m->pyr[0] : NULL;
  case VG_SLICE_PRI: *n = m->n_pri; return *n ? m->pri[0] : NULL;
  default: *n = m->n_hex; return *n ? m->hex[0] : NULL;
  }
}

/* Those of them that are in the part. */
static const uint32_t *part_of(const struct vg_estimate *e, int kind, size_t *n)
{
  const uint32_t *node = cells_of(e->m, kind, n);

  if (kind != VG_SLICE_TET || !*n) return node;
  *n -= e->first_tet;
  return node + 4 * e->first_tet;
}

/* --- gradients ------------------------------------------------------------ */

/* Add a triangle with corners a, b, c, relative to a point of the cell, and
 * values at them: area times mean value, and volume. */
static void add_triangle(const double a[3], const double b[3],
                         const double c[3], double value, double sum[3],
                         double *volume)
{
  double u[3], v[3], area[3];

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_cross(u, v, area);
  for (int k = 0; k < 3; k++) {
    sum[k] -= area[k] / 2 * value; /* the normals point into the cell */
    *volume -= area[k] * (a[k] + b[k] + c[k]) / 18;
  }
}

/* Add a quadrilateral as four triangles around its centre. */
static void add_quad(const double x[4][3], const double value[4], double sum[3],
                     double *volume)
{
  double centre[3], middle = 0;

  for (int k = 0; k < 3; k++)
    centre[k] = (x[0][k] + x[1][k] + x[2][k] + x[3][k]) / 4;
  for (int i = 0; i < 4; i++) middle += value[i] / 4;
  for (int i = 0; i < 4; i++) {
    int j = (i + 1) % 4;

    add_triangle(x[i], x[j], centre, (value[i] + value[j] + middle) / 3, sum,
                 volume);
  }
}

/* Gradient of a cell times its volume, by Gauss's theorem, exact for linear
 * functions. value: NULL, or with a distance of `stride`. Returns the volume.
 */
static double gradient_of(const struct vg_mesh *m, const struct kind *kind,
                          const uint32_t *node, const double *value,
                          size_t stride, double sum[3])
{
  const double *origin = m->point[node[0]];
  const double least = value ? value[stride * node[0]] : 0;
  double volume = 0;

  memset(sum, 0, 3 * sizeof *sum);
  for (int f = 0; f < kind->n_face; f++) {
    const unsigned char *corner = kind->face[f];
    double x[4][3], v[4];

    for (int i = 0; i < 4; i++) {
      uint32_t p = node[corner[i]];

      vg_sub(m->point[p], origin, x[i]);
      v[i] = value ? value[stride * p] - least : 0;
    }
    if (corner[3] != corner[2])
      add_quad((const double(*)[3])x, v, sum, &volume);
    else add_triangle(x[0], x[1], x[2], (v[0] + v[1] + v[2]) / 3, sum, &volume);
  }
  return volume;
}

/* Gradients at the points. */
static void project(const struct vg_estimate *e, const double *value,
                    size_t stride, double (*out)[3])
{
  const struct vg_mesh *m = e->m;

  memset(out, 0, m->n_point * sizeof *out);
  for (int k = 0; k < e->n_kind; k++) {
    const int width = vg_slice_width[k];
    size_t n;
    const uint32_t *node = part_of(e, k, &n);

    for (size_t i = 0; i < n; i++, node += width) {
      double sum[3];

      if (!(gradient_of(m, &kinds[k], node, value, stride, sum) > 0)) continue;
      for (int j = 0; j < width; j++)
        for (int c = 0; c < 3; c++) out[node[j]][c] += sum[c] / width;
    }
  }
  for (size_t p = 0; p < m->n_point; p++)
    for (int c = 0; c < 3 && e->volume[p] > 0; c++) out[p][c] /= e->volume[p];
}

/* --- the part of the mesh ------------------------------------------------- */

static void measure_volumes(struct vg_estimate *e)
{
  const struct vg_mesh *m = e->m;

  for (int k = 0; k < e->n_kind; k++) {
    const int width = vg_slice_width[k];
    double unused[3];
    size_t n;
    const uint32_t *node = part_of(e, k, &n);

    for (size_t i = 0; i < n; i++, node += width) {
      double volume = gradient_of(m, &kinds[k], node, NULL, 0, unused);

      for (int j = 0; j < width && volume > 0; j++)
        e->volume[node[j]] += volume / width;
    }
  }
  e->n_left_out = e->first_tet;
  if (e->n_kind == 1) e->n_left_out += m->n_pyr + m->n_pri + m->n_hex;
}

static vg_status find_edges(struct vg_estimate *e, struct vg_error *err)
{
  const struct vg_mesh *m = e->m;
  struct vg_edges edges = VG_EDGES_INIT;
  size_t n_side = 6 * m->n_tet + 8 * m->n_pyr + 9 * m->n_pri + 12 * m->n_hex;
  uint32_t(*side)[2];
  vg_status st = VG_OK;

  if (n_side > UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the mesh has %zu edges of cells, but at most 2^32 - 1 are "
                   "supported",
                   n_side);
  side = vg_alloc(n_side, sizeof *side);
  if (!side) return no_memory(err);
  n_side = 0;
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    size_t n;
    const uint32_t *node = cells_of(m, k, &n);

    for (size_t i = 0; i < n; i++, node += vg_slice_width[k])
      for (int j = 0; j < kinds[k].n_edge; j++, n_side++)
        for (int c = 0; c < 2; c++) side[n_side][c] = node[kinds[k].edge[j][c]];
  }
  VG_TRY(vg_edges_build_sides(&edges, m->n_point, n_side,
                              (const uint32_t(*)[2])side, err));
  e->edge = vg_alloc(edges.n, sizeof *e->edge);
  if (!e->edge) st = no_memory(err);
  for (size_t i = 0; i < edges.n && e->edge; i++)
    memcpy(e->edge[i], side[*vg_edges_at(&edges, i)], sizeof *e->edge);
  e->n_edge = edges.n;
done:
  free(side);
  vg_edges_release(&edges);
  return st;
}

static int is_part(const struct vg_estimate *e, const struct vg_cell_links *l,
                   uint32_t cell)
{
  return cell >= e->first_tet && (e->n_kind > 1 || cell < l->end_tet);
}

/* Points of faces that are not between two cells of the part. */
static vg_status find_border(struct vg_estimate *e, struct vg_error *err)
{
  struct vg_cell_links l = VG_CELL_LINKS_INIT;
  vg_status st = vg_cell_links_build(&l, e->m, 1, "the mesh", err);

  if (st < 0) return st;
  memset(e->ring, 2, e->m->n_point);
  for (uint32_t c = 0; c < l.n_cell; c++)
    for (int j = 0; j < vg_half_faces(&l, c); j++) {
      uint32_t code = 8 * c + (uint32_t)j, mate = vg_mate(&l, code), node[4];
      int n;

      if (is_part(e, &l, c) && mate != VG_NO_CELL && is_part(e, &l, mate >> 3))
        continue;
      n = vg_half_face_nodes(&l, code, node);
      for (int i = 0; i < n; i++) e->ring[node[i]] = 0;
    }
  vg_cell_links_release(&l);
  for (size_t p = 0; p < e->m->n_point; p++)
    if (!(e->volume[p] > 0)) e->ring[p] = 0;
  for (size_t i = 0; i < e->n_edge; i++)
    for (int k = 0; k < 2; k++)
      if (!e->ring[e->edge[i][k]] && e->ring[e->edge[i][!k]] == 2)
        e->ring[e->edge[i][!k]] = 1;
  return VG_OK;
}

void vg_estimate_release(struct vg_estimate *e)
{
  free(e->volume);
  free(e->ring);
  free(e->edge);
  *e = (struct vg_estimate)VG_ESTIMATE_INIT;
}

vg_status vg_estimate_open(struct vg_estimate *e, const struct vg_mesh *m,
                           size_t n_layer, struct vg_error *err)
{
  size_t inside = 0;
  int positive = 0;
  vg_status st = VG_OK;

  assert(e && m && n_layer <= m->n_tet);
  *e = (struct vg_estimate){ .m = m,
                             .n_kind = m->n_tet > n_layer ? 1 : VG_SLICE_KINDS,
                             .first_tet = n_layer };
  if (!vg_mesh_n_cell(m))
    return vg_fail(err, VG_ERR_INPUT,
                   "the mesh of the solution has no volume cells");
  e->volume = vg_calloc(m->n_point, sizeof *e->volume);
  e->ring = vg_calloc(m->n_point, 1);
  if (!e->volume || !e->ring) {
    st = no_memory(err);
    goto done;
  }
  measure_volumes(e);
  VG_TRY(find_edges(e, err));
  VG_TRY(find_border(e, err));
  for (size_t p = 0; p < m->n_point; p++) {
    inside += e->ring[p] != 0;
    positive |= e->volume[p] > 0;
  }
  if (!positive)
    st = vg_fail(err, VG_ERR_INPUT,
                 "no cell has a positive volume; the order of the nodes is "
                 "mirrored");
  else if (!inside)
    st = vg_fail(err, VG_ERR_INPUT,
                 "all points outside of layers are on the boundary, where "
                 "second derivatives cannot be estimated: without %zu layer "
                 "cells, the mesh is less than two cells wide",
                 e->n_left_out);
done:
  if (st < 0) vg_estimate_release(e);
  return st;
}

/* --- points without an estimate of their own ------------------------------ */

struct spread {
  const struct vg_estimate *e;
  double (*h)[6];
  uint8_t *known; /* [n_point] 1: has a Hessian */
  uint32_t *n;    /* [n_point] neighbours in the sum */
};

/* Give unknown points of the ring `least` and further inside the mean of their
 * known neighbours. Returns the number of points. */
static size_t spread_once(struct spread *s, int least)
{
  const struct vg_estimate *e = s->e;
  size_t n_new = 0;

  memset(s->n, 0, e->m->n_point * sizeof *s->n);
  for (size_t i = 0; i < e->n_edge; i++)
    for (int k = 0; k < 2; k++) {
      uint32_t from = e->edge[i][k], to = e->edge[i][!k];

      if (!s->known[from] || s->known[to] || e->ring[to] < least) continue;
      for (int c = 0; c < 6; c++) s->h[to][c] += s->h[from][c];
      s->n[to]++;
    }
  for (size_t p = 0; p < e->m->n_point; p++) {
    if (!s->n[p]) continue;
    for (int k = 0; k < 6; k++) s->h[p][k] /= s->n[p];
    s->known[p] = 1;
    n_new++;
  }
  return n_new;
}

/* The gradient on the boundary is one-sided, and its error falls on the
 * Hessians of the next points. These keep their own only where no better ones
 * are near. */
static vg_status spread(const struct vg_estimate *e, double (*h)[6],
                        struct vg_error *err)
{
  const size_t n = e->m->n_point;
  struct spread s = { e, h, vg_calloc(n, 1), vg_calloc(n, sizeof *s.n) };
  double(*own)[6] = vg_alloc(n, sizeof *own);
  vg_status st = VG_OK;

  if (!s.known || !s.n || !own) {
    st = no_memory(err);
    goto done;
  }
  memcpy(own, h, n * sizeof *own);
  for (size_t p = 0; p < n; p++) {
    s.known[p] = e->ring[p] == 2;
    if (!s.known[p]) memset(h[p], 0, sizeof h[p]);
  }
  for (int k = 0; k < NEAR && spread_once(&s, 1); k++) {
  }
  for (size_t p = 0; p < n; p++)
    if (e->ring[p] == 1 && !s.known[p]) {
      memcpy(h[p], own[p], sizeof h[p]);
      s.known[p] = 1;
    }
  while (spread_once(&s, 0)) {
  }
done:
  free(own);
  free(s.known);
  free(s.n);
  return st;
}

vg_status vg_hessian(const struct vg_estimate *e, const double *value,
                     double (*hessian)[6], struct vg_error *err)
{
  const size_t n = e->m->n_point;
  double(*first)[3] = vg_alloc(n, sizeof *first);
  double(*second)[3] = vg_alloc(n, sizeof *second);
  vg_status st = VG_OK;

  assert(value && hessian);
  if (!first || !second) {
    st = no_memory(err);
    goto done;
  }
  project(e, value, 1, first);
  memset(hessian, 0, n * sizeof *hessian);
  for (int k = 0; k < 3; k++) {
    project(e, &first[0][k], 3, second);
    for (size_t p = 0; p < n; p++)
      for (int j = 0; j < 3; j++)
        hessian[p][row[k][j]] += j == k ? second[p][j] : second[p][j] / 2;
  }
  st = spread(e, hessian, err);
done:
  free(first);
  free(second);
  return st;
}
