/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Control volumes around points or of cells. */
#include "core/accuracy/volumes.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/judge/face_shape.h"

/* Codes of entries have 32 bits. */
#define MOST_FACES ((size_t)1 << 30)

static vg_status no_memory(struct vg_error *err)
{
  return vg_fail_memory(err, "the control volumes");
}

void vg_volumes_release(struct vg_volumes *v)
{
  free(v->x);
  free(v->volume);
  free(v->side);
  free(v->area);
  free(v->weight);
  free(v->owner);
  free(v->out);
  free(v->at);
  free(v->corner);
  free(v->first);
  free(v->entry);
  memset(v, 0, sizeof *v);
}

int vg_volume_nodes(const struct vg_cell_links *l, uint32_t cell,
                    const uint32_t **node)
{
  const struct vg_mesh *m = l->m;

  assert(cell < l->n_cell);
  if (cell < l->end_tet) *node = m->tet[cell];
  else if (cell < l->end_pyr) *node = m->pyr[cell - l->end_tet];
  else if (cell < l->end_pri) *node = m->pri[cell - l->end_pyr];
  else *node = m->hex[cell - l->end_pri];
  return cell < l->end_tet ? 4
       : cell < l->end_pyr ? 5
       : cell < l->end_pri ? 6
                           : 8;
}

static vg_status add_face(struct vg_volumes *v, uint32_t a, uint32_t b,
                          const double area[3], double weight,
                          struct vg_error *err)
{
  size_t n = v->n_face;

  if (n == MOST_FACES)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the mesh has more than 2^30 faces of control volumes, "
                   "which is too many for the check of accuracy");
  if (vg_reserve(&v->side, &v->room[0], n + 1, sizeof *v->side) ||
      vg_reserve(&v->area, &v->room[1], n + 1, sizeof *v->area) ||
      vg_reserve(&v->weight, &v->room[2], n + 1, sizeof *v->weight))
    return no_memory(err);
  v->side[n][0] = a;
  v->side[n][1] = b;
  memcpy(v->area[n], area, sizeof v->area[n]);
  v->weight[n] = weight;
  v->n_face++;
  return VG_OK;
}

/* List the faces at each volume, in ascending order of their numbers. */
static vg_status link_faces(struct vg_volumes *v, struct vg_error *err)
{
  size_t n_entry = 2 * v->n_face + v->n_border, *at;

  v->first = vg_calloc(v->n + 2, sizeof *v->first);
  v->entry = vg_alloc(n_entry, sizeof *v->entry);
  if (!v->first || !v->entry) return no_memory(err);
  at = v->first + 1; /* at[i] becomes the end of i, the beginning of i + 1 */
  for (int pass = 0; pass < 2; pass++) {
    for (size_t e = 0; e < n_entry; e++) {
      uint32_t i = e < 2 * v->n_face ? v->side[e / 2][e % 2]
                                     : v->owner[e - 2 * v->n_face];

      if (pass) v->entry[at[i]++] = (uint32_t)e;
      else at[i + 1]++;
    }
    for (size_t i = 1; i <= v->n && !pass; i++) at[i] += at[i - 1];
  }
  return VG_OK;
}

static vg_status make_room(struct vg_volumes *v, size_t n, size_t n_border,
                           struct vg_error *err)
{
  v->n = n;
  v->n_border = n_border;
  v->x = vg_calloc(n, sizeof *v->x);
  v->volume = vg_calloc(n, sizeof *v->volume);
  v->owner = vg_alloc(n_border, sizeof *v->owner);
  v->out = vg_alloc(n_border, sizeof *v->out);
  return v->x && v->volume && v->owner && v->out ? VG_OK : no_memory(err);
}

/* --- cells ---------------------------------------------------------------- */

/* Shape of a half-face, with the area vector out of its cell. */
static void shape_of(const struct vg_cell_links *l, uint32_t code,
                     struct vg_face_shape *out)
{
  uint32_t node[4];
  double x[4][3] = { { 0 } };
  int n = vg_half_face_nodes(l, code, node);

  for (int i = 0; i < n; i++) memcpy(x[i], l->m->point[node[i]], sizeof x[i]);
  vg_face_shape((const double(*)[3])x, n, out);
}

static void measure_cell(struct vg_volumes *v, const struct vg_cell_links *l,
                         uint32_t cell)
{
  struct vg_face_shape shape[6];
  int n = vg_half_faces(l, cell);

  for (int j = 0; j < n; j++) shape_of(l, 8 * cell + (uint32_t)j, &shape[j]);
  v->volume[cell] = vg_faces_middle(shape, n, v->x[cell]) / 3;
}

static vg_status join_cells(struct vg_volumes *v, const struct vg_cell_links *l,
                            uint32_t code, struct vg_error *err)
{
  uint32_t a = code >> 3, b = vg_mate(l, code) >> 3;
  struct vg_face_shape shape;
  double to[2][3], part[2], sum;

  shape_of(l, code, &shape);
  vg_sub(shape.centre, v->x[a], to[0]);
  vg_sub(v->x[b], shape.centre, to[1]);
  for (int k = 0; k < 2; k++) part[k] = fabs(vg_dot(shape.area, to[k]));
  sum = part[0] + part[1];
  return add_face(v, a, b, shape.area, sum > 0 ? part[0] / sum : 0.5, err);
}

vg_status vg_volumes_cells(struct vg_volumes *v, const struct vg_cell_links *l,
                           struct vg_error *err)
{
  size_t n_border = l->m->n_tri + l->m->n_quad;
  vg_status st;

  v->in = VG_IN_CELLS;
  VG_TRY(make_room(v, l->n_cell, n_border, err));
  v->at = vg_alloc(n_border, sizeof *v->at);
  if (!v->at) return no_memory(err);
  for (uint32_t c = 0; c < l->n_cell; c++) measure_cell(v, l, c);
  for (uint32_t c = 0; c < l->n_cell; c++)
    for (int j = 0, n = vg_half_faces(l, c); j < n; j++) {
      uint32_t code = 8 * c + (uint32_t)j, mate = vg_mate(l, code);

      if (mate != VG_NO_CELL && mate > code)
        VG_TRY(join_cells(v, l, code, err));
    }
  for (size_t b = 0; b < n_border; b++) {
    struct vg_face_shape shape;

    shape_of(l, l->boundary[b], &shape);
    v->owner[b] = l->boundary[b] >> 3;
    memcpy(v->out[b], shape.area, sizeof v->out[b]);
    memcpy(v->at[b], shape.centre, sizeof v->at[b]);
  }
  st = link_faces(v, err);
done:
  return st;
}

/* --- median dual ---------------------------------------------------------- */

struct dual {
  struct vg_volumes *v;
  const struct vg_cell_links *l;
  size_t *end;    /* [n_point + 2] ends of the cells at each point */
  uint32_t *cell; /* cells at points */
  uint32_t *slot; /* [n_point] number of the edge from the present point to this
                     one, counted from `from`, + 1; 0: none */
  size_t from;    /* first edge of the present point */
};

static vg_status enter_cells(struct dual *d, struct vg_error *err)
{
  const struct vg_cell_links *l = d->l;
  const struct vg_mesh *m = l->m;
  size_t n_corner = 4 * m->n_tet + 5 * m->n_pyr + 6 * m->n_pri + 8 * m->n_hex;
  size_t *at;

  d->end = vg_calloc(m->n_point + 2, sizeof *d->end);
  d->cell = vg_alloc(n_corner, sizeof *d->cell);
  d->slot = vg_calloc(m->n_point, sizeof *d->slot);
  if (!d->end || !d->cell || !d->slot) return no_memory(err);
  at = d->end + 1;
  for (int pass = 0; pass < 2; pass++) {
    for (uint32_t c = 0; c < l->n_cell; c++) {
      const uint32_t *node;

      for (int n = vg_volume_nodes(l, c, &node); n > 0; n--)
        if (pass) d->cell[at[node[n - 1]]++] = c;
        else at[node[n - 1] + 1]++;
    }
    for (size_t v = 1; v <= m->n_point && !pass; v++) at[v] += at[v - 1];
  }
  return VG_OK;
}

static void mean_of(const struct vg_mesh *m, const uint32_t *node, int n,
                    double out[3])
{
  for (int k = 0; k < 3; k++) {
    out[k] = 0;
    for (int i = 0; i < n; i++) out[k] += m->point[node[i]][k];
    out[k] /= n;
  }
}

/* Add the triangle between the middle of edge a b, the centre f of a face that
 * runs from a to b, and the centre g of its cell. */
static vg_status add_part(struct dual *d, uint32_t a, uint32_t b,
                          const double f[3], const double g[3],
                          struct vg_error *err)
{
  const struct vg_mesh *m = d->l->m;
  uint32_t to = a < b ? b : a;
  double middle[3], p[3], q[3], edge[3], area[3], volume;
  size_t at;

  if (!d->slot[to]) {
    const double none[3] = { 0, 0, 0 };
    vg_status st = add_face(d->v, a < b ? a : b, to, none, 0.5, err);

    if (st < 0) return st;
    d->slot[to] = (uint32_t)(d->v->n_face - d->from);
  }
  at = d->from + d->slot[to] - 1;
  for (int k = 0; k < 3; k++)
    middle[k] = 0.5 * (m->point[a][k] + m->point[b][k]);
  vg_sub(g, middle, p);
  vg_sub(f, middle, q);
  vg_sub(m->point[b], m->point[a], edge);
  vg_cross(p, q, area);
  volume = vg_dot(area, edge) / 12;
  d->v->volume[a] += volume;
  d->v->volume[b] += volume;
  for (int k = 0; k < 3; k++)
    d->v->area[at][k] += (a < b ? 0.5 : -0.5) * area[k];
  return VG_OK;
}

/* The edges from point v to higher points, in one of its cells. */
static vg_status add_cell(struct dual *d, uint32_t v, uint32_t cell,
                          struct vg_error *err)
{
  const uint32_t *corner;
  const int n_corner = vg_volume_nodes(d->l, cell, &corner);
  double g[3];
  vg_status st = VG_OK;

  mean_of(d->l->m, corner, n_corner, g);
  for (int j = 0; j < vg_half_faces(d->l, cell); j++) {
    uint32_t node[4];
    int n = vg_half_face_nodes(d->l, 8 * cell + (uint32_t)j, node);
    double f[3];

    mean_of(d->l->m, node, n, f);
    for (int i = 0; i < n && st >= 0; i++) {
      uint32_t a = node[i], b = node[(i + 1) % n];

      if ((a < b ? a : b) == v) st = add_part(d, a, b, f, g, err);
    }
  }
  return st;
}

static vg_status add_edges(struct dual *d, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (uint32_t v = 0; v < d->l->m->n_point && st >= 0; v++) {
    d->from = d->v->n_face;
    for (size_t i = d->end[v]; i < d->end[v + 1] && st >= 0; i++)
      st = add_cell(d, v, d->cell[i], err);
    for (size_t f = d->from; f < d->v->n_face; f++)
      d->slot[d->v->side[f][1]] = 0;
  }
  return st;
}

/* The part of a boundary face that belongs to corner i: a third of a triangle,
 * or the quarter of a quadrilateral between the middles of its sides. Boundary
 * faces point into the fluid. */
static void bound(struct vg_volumes *v, const struct vg_mesh *m,
                  const uint32_t *node, int n, int i, size_t at)
{
  const double *x = m->point[node[i]];
  double side[2][3], centre[3], area[3];

  mean_of(m, node, n, centre);
  vg_sub(m->point[node[(i + 1) % n]], x, side[0]);
  vg_sub(m->point[node[(i + n - 1) % n]], x, side[1]);
  if (n == 4) { /* diagonals of the quarter: to the centre, and across */
    double along[3], across[3];

    vg_sub(centre, x, along);
    for (int k = 0; k < 3; k++) across[k] = 0.5 * (side[1][k] - side[0][k]);
    vg_cross(along, across, area);
  } else {
    vg_cross(side[0], side[1], area);
  }
  for (int k = 0; k < 3; k++)
    v->out[at][k] = -area[k] * (n == 4 ? 0.5 : 1 / 6.);
  v->owner[at] = node[i];
  for (int k = 0; k < 4; k++)
    v->corner[at][k] = k < n ? node[(i + k) % n] : VG_NO_CELL;
}

vg_status vg_volumes_dual(struct vg_volumes *v, const struct vg_cell_links *l,
                          struct vg_error *err)
{
  const struct vg_mesh *m = l->m;
  const size_t n_border = 3 * m->n_tri + 4 * m->n_quad;
  struct dual d = { .v = v, .l = l };
  vg_status st;

  v->in = VG_IN_NODES;
  VG_TRY(make_room(v, m->n_point, n_border, err));
  v->corner = vg_alloc(n_border, sizeof *v->corner);
  if (!v->corner) VG_TRY(no_memory(err));
  if (m->n_point) memcpy(v->x, m->point, m->n_point * sizeof *v->x);
  VG_TRY(enter_cells(&d, err));
  VG_TRY(add_edges(&d, err));
  for (size_t b = 0; b < n_border; b++)
    if (b < 3 * m->n_tri) bound(v, m, m->tri[b / 3], 3, (int)(b % 3), b);
    else {
      size_t q = b - 3 * m->n_tri;

      bound(v, m, m->quad[q / 4], 4, (int)(q % 4), b);
    }
  st = link_faces(v, err);
done:
  free(d.end);
  free(d.cell);
  free(d.slot);
  return st;
}
