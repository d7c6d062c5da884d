/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A mesh of all kinds of cells, to be cut into slices: that of mixed_support.h
 * with the points of the boundary first. The hexahedra, which stand on the
 * wall, count as its layers. Header only. */
#ifndef TESTS_UNIT_MIXED_CUT_H
#define TESTS_UNIT_MIXED_CUT_H

#include "mixed_support.h"
#include "slices_support.h"

static inline void mixed_renumber(size_t n, uint32_t *node, const uint32_t *to)
{
  for (size_t i = 0; i < n; i++) node[i] = to[node[i]];
}

/* Returns the number of points of the boundary, which get the first numbers. */
static inline size_t mixed_boundary_first(struct vg_mesh *m)
{
  uint8_t *on = vg_calloc(m->n_point, 1);
  uint32_t *to = vg_alloc(m->n_point, sizeof *to);
  double(*x)[3] = vg_alloc(m->n_point, sizeof *x);
  uint32_t n = 0, end;

  for (size_t i = 0; i < 3 * m->n_tri; i++) on[m->tri[i / 3][i % 3]] = 1;
  for (size_t i = 0; i < 4 * m->n_quad; i++) on[m->quad[i / 4][i % 4]] = 1;
  for (size_t i = 0; i < m->n_point; i++)
    if (on[i]) to[i] = n++;
  end = n;
  for (size_t i = 0; i < m->n_point; i++)
    if (!on[i]) to[i] = n++;
  for (size_t i = 0; i < m->n_point; i++)
    memcpy(x[to[i]], m->point[i], sizeof *x);
  free(m->point);
  m->point = x;
  mixed_renumber(3 * m->n_tri, (uint32_t *)m->tri, to);
  mixed_renumber(4 * m->n_quad, (uint32_t *)m->quad, to);
  mixed_renumber(4 * m->n_tet, (uint32_t *)m->tet, to);
  mixed_renumber(5 * m->n_pyr, (uint32_t *)m->pyr, to);
  mixed_renumber(6 * m->n_pri, (uint32_t *)m->pri, to);
  mixed_renumber(8 * m->n_hex, (uint32_t *)m->hex, to);
  free(on);
  free(to);
  return end;
}

static inline void mixed_cut_mesh(struct vg_mesh *m, struct vg_join_info *info)
{
  mixed_make(m, 12, 10);
  memset(info, 0, sizeof *info);
  info->n_boundary_point = mixed_boundary_first(m);
  info->n_layer_point = info->n_boundary_point;
}

#endif
