/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/foam/foam_mesh.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/cell_faces.h"

enum { MOST_FACES = 6, MOST_NODES = 8, NONE = -1 };

/* The faces of each cell, and the kind of each cell. */
struct cells {
  const char *name;
  const struct vg_foam_lists *l;
  size_t *first;       /* [n_cell + 1] into face */
  uint32_t *face;      /* 2 * face + 1 if the cell is its neighbour */
  unsigned char *kind; /* [n_cell] 0 .. 3 */
};

void vg_foam_lists_release(struct vg_foam_lists *l)
{
  free(l->point);
  free(l->first);
  free(l->corner);
  free(l->owner);
  free(l->neighbour);
  free(l->patch);
  *l = (struct vg_foam_lists)VG_FOAM_LISTS_INIT;
}

static vg_status collect(struct cells *c, struct vg_error *err)
{
  const struct vg_foam_lists *l = c->l;

  c->first = vg_calloc(l->n_cell + 2, sizeof *c->first);
  c->face = vg_alloc(l->n_face + l->n_inner, sizeof *c->face);
  c->kind = vg_alloc(l->n_cell, 1);
  if (!c->first || !c->face || !c->kind)
    return vg_fail_memory(err, "the cells of an OpenFOAM mesh");
  /* first[i + 1] is where the next face of cell i goes, and at the end where
   * those of the next cell begin. */
  for (size_t f = 0; f < l->n_face; f++) c->first[l->owner[f] + 2]++;
  for (size_t f = 0; f < l->n_inner; f++) c->first[l->neighbour[f] + 2]++;
  for (size_t i = 2; i < l->n_cell + 2; i++) c->first[i] += c->first[i - 1];
  for (size_t f = 0; f < l->n_face; f++) {
    c->face[c->first[l->owner[f] + 1]++] = (uint32_t)(2 * f);
    if (f < l->n_inner)
      c->face[c->first[l->neighbour[f] + 1]++] = (uint32_t)(2 * f + 1);
  }
  return VG_OK;
}

static int width(const struct vg_foam_lists *l, size_t face)
{
  return (int)(l->first[face + 1] - l->first[face]);
}

/* Corner k of a face of a cell, counted so that the normal points into it. */
static uint32_t corner(const struct vg_foam_lists *l, uint32_t code, int k)
{
  const size_t face = code >> 1;
  const int n = width(l, face), i = ((k % n) + n) % n;

  return l->corner[l->first[face] + (size_t)(code & 1 ? i : n - 1 - i)];
}

/* The kind of the cell with these numbers of triangles and quadrilaterals. */
static int kind_of(int n_tri, int n_quad)
{
  static const int faces[4][2] = { { 4, 0 }, { 4, 1 }, { 2, 3 }, { 0, 6 } };

  for (int k = 0; k < 4; k++)
    if (faces[k][0] == n_tri && faces[k][1] == n_quad) return k;
  return NONE;
}

static vg_status classify(struct cells *c, size_t cell, struct vg_error *err)
{
  const struct vg_foam_lists *l = c->l;
  const size_t n = c->first[cell + 1] - c->first[cell];
  int count[2] = { 0, 0 }, kind = NONE;

  for (size_t i = 0; i < n && n <= MOST_FACES; i++) {
    const int w = width(l, c->face[c->first[cell] + i] >> 1);

    if (w == 3 || w == 4) count[w - 3]++;
  }
  if ((size_t)(count[0] + count[1]) == n) kind = kind_of(count[0], count[1]);
  if (kind != NONE) {
    c->kind[cell] = (unsigned char)kind;
    return VG_OK;
  }
  if (!n)
    return vg_fail(err, VG_ERR_FORMAT, "%s: cell %zu has no faces", c->name,
                   cell);
  {
    const double *x = l->point +
                      3 * (size_t)corner(l, c->face[c->first[cell]], 0);

    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: cell %zu, at (%g %g %g), has %zu faces, %d of them "
                   "triangles and %d quadrilaterals; only tetrahedra, "
                   "pyramids, prisms and hexahedra are read",
                   c->name, cell, x[0], x[1], x[2], n, count[0], count[1]);
  }
}

/* The corner that an edge of the cell joins to `from`, beyond the base:
 *
 *     to .------.     the face contains the edge base[k] base[k + 1],
 *        | face |     whose ends are neighbours of corners that are not
 *   from .------.     in the base
 */
static uint32_t above(const struct cells *c, size_t cell, uint32_t base, int k)
{
  const struct vg_foam_lists *l = c->l;
  const uint32_t a = corner(l, base, k), b = corner(l, base, k + 1);

  for (size_t i = c->first[cell]; i < c->first[cell + 1]; i++) {
    const uint32_t code = c->face[i];
    const int n = width(l, code >> 1);

    for (int j = 0; j < n && code != base; j++)
      if (corner(l, code, j) == b && corner(l, code, j + 1) == a)
        return corner(l, code, j + 2);
  }
  return UINT32_MAX;
}

/* Nodes of a cell in the order of core/mesh/mesh.h. Returns 0 if its faces do
 * not form a closed cell of its kind. */
static int order(const struct cells *c, size_t cell, uint32_t node[MOST_NODES])
{
  static const int base_node[4][4] = {
    { 0, 1, 2, 0 }, { 0, 3, 4, 1 }, { 0, 1, 2, 0 }, { 0, 1, 2, 3 }
  };
  static const int top_node[4][4] = {
    { 3, 3, 3, 0 }, { 2, 2, 2, 2 }, { 3, 4, 5, 0 }, { 4, 5, 6, 7 }
  };
  const int kind = c->kind[cell], n = kind == 0 || kind == 2 ? 3 : 4;
  const int width_of_cell = vg_cell_faces[kind].width;
  size_t i = c->first[cell];
  uint32_t base;

  while (width(c->l, c->face[i] >> 1) != n) i++;
  base = c->face[i];
  for (int k = 0; k < MOST_NODES; k++) node[k] = UINT32_MAX;
  for (int k = 0; k < n; k++) {
    uint32_t up = above(c, cell, base, k), *to = node + top_node[kind][k];

    node[base_node[kind][k]] = corner(c->l, base, k);
    if (*to != UINT32_MAX && *to != up) return 0;
    *to = up;
  }
  for (int k = 0; k < width_of_cell; k++)
    for (int j = 0; j <= k; j++)
      if (node[k] == UINT32_MAX || (j < k && node[j] == node[k])) return 0;
  return 1;
}

static vg_status alloc_cells(struct vg_mesh *m, const size_t n[4],
                             struct vg_error *err)
{
  m->tet = vg_alloc(n[0], sizeof *m->tet);
  m->pyr = vg_alloc(n[1], sizeof *m->pyr);
  m->pri = vg_alloc(n[2], sizeof *m->pri);
  m->hex = vg_alloc(n[3], sizeof *m->hex);
  if (!m->tet || !m->pyr || !m->pri || !m->hex)
    return vg_fail_memory(err, "the cells of an OpenFOAM mesh");
  m->n_tet = n[0];
  m->n_pyr = n[1];
  m->n_pri = n[2];
  m->n_hex = n[3];
  return VG_OK;
}

static vg_status put_cells(struct cells *c, struct vg_mesh *m, uint32_t *number,
                           struct vg_error *err)
{
  size_t n[4] = { 0 }, at[4], start[4];
  vg_status st = VG_OK;

  for (size_t i = 0; i < c->l->n_cell; i++) {
    VG_TRY(classify(c, i, err));
    n[c->kind[i]]++;
  }
  VG_TRY(alloc_cells(m, n, err));
  for (int k = 0; k < 4; k++) {
    at[k] = 0;
    start[k] = k ? start[k - 1] + n[k - 1] : 0;
  }
  for (size_t i = 0; i < c->l->n_cell; i++) {
    const int k = c->kind[i], w = vg_cell_faces[k].width;
    uint32_t node[MOST_NODES];

    if (!order(c, i, node))
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s: the faces of cell %zu do not close it", c->name, i);
    memcpy(vg_mesh_nodes(m, k) + (size_t)w * at[k], node,
           (size_t)w * sizeof *node);
    number[i] = (uint32_t)(start[k] + at[k]++);
  }
done:
  return st;
}

/* Boundary faces, which point into the fluid as seen from their owner. */
static vg_status put_boundary(const struct cells *c, struct vg_mesh *m,
                              struct vg_error *err)
{
  const struct vg_foam_lists *l = c->l;
  const size_t n = l->n_face - l->n_inner;

  m->tri = vg_alloc(n, sizeof *m->tri);
  m->tri_patch = vg_alloc(n, sizeof *m->tri_patch);
  m->quad = vg_alloc(n, sizeof *m->quad);
  m->quad_patch = vg_alloc(n, sizeof *m->quad_patch);
  if (!m->tri || !m->tri_patch || !m->quad || !m->quad_patch)
    return vg_fail_memory(err, "the boundary of an OpenFOAM mesh");
  for (size_t p = 0; p < l->n_patch; p++) {
    if (vg_mesh_add_patch(m, (int32_t)(p + 1), l->patch[p].name) == SIZE_MAX)
      return vg_fail_memory(err, "the patches of an OpenFOAM mesh");
    for (size_t i = 0; i < l->patch[p].n; i++) {
      const size_t f = l->patch[p].start + i;
      const int w = width(l, f);
      uint32_t *to = w == 3 ? m->tri[m->n_tri] : m->quad[m->n_quad];

      for (int k = 0; k < w; k++) to[k] = corner(l, (uint32_t)(2 * f), k);
      if (w == 3) m->tri_patch[m->n_tri++] = (uint32_t)p;
      else m->quad_patch[m->n_quad++] = (uint32_t)p;
    }
  }
  return VG_OK;
}

vg_status vg_foam_mesh(const char *name, struct vg_foam_lists *l,
                       struct vg_mesh *m, uint32_t **cell, struct vg_error *err)
{
  struct cells c = { .name = name, .l = l };
  vg_status st;

  *cell = vg_alloc(l->n_cell, sizeof **cell);
  if (!*cell) return vg_fail_memory(err, "the cells of an OpenFOAM mesh");
  VG_TRY(collect(&c, err));
  VG_TRY(put_cells(&c, m, *cell, err));
  VG_TRY(put_boundary(&c, m, err));
  m->point = (double(*)[3])l->point;
  m->n_point = l->n_point;
  l->point = NULL;
done:
  free(c.first);
  free(c.face);
  free(c.kind);
  if (st < 0) {
    free(*cell);
    *cell = NULL;
  }
  return st;
}
