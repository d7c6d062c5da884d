/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A mesh in memory, cut at random into slices with local numbers, as a server
 * of core/mesh/slices.h; for the tests of functions that read slices. Header
 * only. Slice g of the cut is served by rank g % size. */
#ifndef TESTS_UNIT_SLICES_SUPPORT_H
#define TESTS_UNIT_SLICES_SUPPORT_H

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/slices.h"
#include "fill_support.h"
#include "join_support.h"

struct cut {
  const struct vg_mesh *mesh;
  struct vg_mesh boundary; /* borrows from mesh */
  size_t n;                /* slices of the whole cut */
  size_t (*end)[5];        /* [n] index past the last point, tet, pyr, pri,
                              hex */
  int rank, size;
  size_t bad; /* slice that cannot be read; SIZE_MAX: none */
  struct vg_slices s;
};

static inline const uint32_t *cut_cells(const struct vg_mesh *m, int kind)
{
  const uint32_t *const cell[VG_SLICE_KINDS] = { (uint32_t *)m->tet,
                                                 (uint32_t *)m->pyr,
                                                 (uint32_t *)m->pri,
                                                 (uint32_t *)m->hex };

  return cell[kind];
}

static inline int cut_compare(const void *a, const void *b)
{
  size_t x = *(const size_t *)a, y = *(const size_t *)b;

  return (x > y) - (x < y);
}

/* One block of memory for all arrays of a slice. */
struct cut_keep {
  uint32_t *local; /* [points of the mesh] + 1 */
  uint32_t *id, *own, *cell[VG_SLICE_KINDS];
  double (*x)[3];
};

static inline uint32_t cut_local(const struct cut *c, struct cut_keep *k,
                                 struct vg_slice *out, uint32_t p)
{
  if (!k->local[p]) {
    memcpy(k->x[out->n_point], c->mesh->point[p], sizeof *k->x);
    k->id[out->n_point] = p;
    k->local[p] = (uint32_t)++out->n_point;
  }
  return k->local[p] - 1;
}

static inline vg_status cut_get(const struct vg_slices *s, size_t i,
                                struct vg_slice *out, struct vg_error *err)
{
  static const size_t width[VG_SLICE_KINDS] = { 4, 5, 6, 8 };
  const struct cut *c = s->user;
  size_t g = (size_t)c->rank + i * (size_t)c->size, from[5] = { 0 };
  struct cut_keep *k = vg_calloc(1, sizeof *k);

  if (g == c->bad) {
    free(k);
    return vg_fail(err, VG_ERR_IO, "slice %zu is bad", g);
  }
  if (g) memcpy(from, c->end[g - 1], sizeof from);
  memset(out, 0, sizeof *out);
  k->local = vg_calloc(c->mesh->n_point, sizeof *k->local);
  k->id = vg_alloc(c->mesh->n_point, sizeof *k->id);
  k->x = vg_alloc(c->mesh->n_point, sizeof *k->x);
  for (int kind = 0; kind < VG_SLICE_KINDS; kind++) {
    size_t n = c->end[g][kind + 1] - from[kind + 1];
    const uint32_t *node = cut_cells(c->mesh, kind) +
                           width[kind] * from[kind + 1];

    k->cell[kind] = vg_alloc(n, width[kind] * sizeof **k->cell);
    out->cell_at[kind] = from[kind + 1];
    out->n_cell[kind] = n;
    /* backwards, so that the order of the mesh is not preserved */
    for (size_t j = n * width[kind]; j-- > 0;)
      k->cell[kind][j] = cut_local(c, k, out, node[j]);
    out->cell[kind] = k->cell[kind];
  }
  out->point_at = from[0];
  out->n_own = c->end[g][0] - from[0];
  k->own = vg_alloc(out->n_own, sizeof *k->own);
  for (size_t j = 0; j < out->n_own; j++)
    k->own[j] = cut_local(c, k, out, (uint32_t)(from[0] + j));
  out->x = (const double(*)[3])k->x;
  out->id = k->id;
  out->own = k->own;
  out->domain = (uint32_t)(g * 7 % 13);
  out->kind = (uint8_t)(g % 4);
  out->keep = k;
  return VG_OK;
}

static inline void cut_put(const struct vg_slices *s, struct vg_slice *slice)
{
  struct cut_keep *k = slice->keep;

  (void)s;
  for (int kind = 0; kind < VG_SLICE_KINDS; kind++) free(k->cell[kind]);
  free(k->local);
  free(k->id);
  free(k->own);
  free(k->x);
  free(k);
}

/* Cut m into n slices; some may be empty. info NULL: no layers, and the first
 * n_boundary points are on the boundary. */
static inline void cut_make(struct cut *c, const struct vg_mesh *m, size_t n,
                            size_t n_boundary, const struct vg_join_info *info,
                            uint64_t seed)
{
  const size_t total[5] = { m->n_point, m->n_tet, m->n_pyr, m->n_pri,
                            m->n_hex };
  size_t *at = vg_alloc(n, sizeof *at);

  memset(c, 0, sizeof *c);
  c->mesh = m;
  c->n = n;
  c->size = 1;
  c->bad = SIZE_MAX;
  c->end = vg_alloc(n, sizeof *c->end);
  for (int k = 0; k < 5; k++) {
    for (size_t i = 0; i < n; i++) at[i] = model_random(&seed) % (total[k] + 1);
    at[n - 1] = total[k];
    qsort(at, n, sizeof *at, cut_compare);
    for (size_t i = 0; i < n; i++) c->end[i][k] = at[i];
  }
  free(at);
  c->boundary = *m;
  c->boundary.point = NULL;
  c->boundary.n_point = 0;
  c->boundary.n_tet = c->boundary.n_pyr = 0;
  c->boundary.n_pri = c->boundary.n_hex = 0;
  c->boundary.tet = NULL;
  c->boundary.pyr = NULL;
  c->boundary.pri = NULL;
  c->boundary.hex = NULL;
  c->s = (struct vg_slices){
    .n_point = m->n_point,
    .n_cell = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex },
    .n_boundary_point = info ? info->n_boundary_point : n_boundary,
    .boundary = &c->boundary,
    .n_slice = n,
    .get = cut_get,
    .put = cut_put,
    .user = c
  };
  if (!info) return;
  c->s.n_layer_point = info->n_layer_point;
  c->s.n_layer_cell[VG_SLICE_TET] = info->n_layer_tet;
  c->s.n_layer_cell[VG_SLICE_PYR] = info->n_layer_pyr;
  c->s.n_layer_cell[VG_SLICE_PRI] = info->n_layer_pri;
  c->s.n_layer_cell[VG_SLICE_HEX] = info->n_layer_hex;
}

/* Serve only the slices of this rank. */
static inline void cut_deal(struct cut *c, int rank, int size)
{
  c->rank = rank;
  c->size = size;
  c->s.n_slice = (c->n + (size_t)(size - 1 - rank)) / (size_t)size;
}

static inline void cut_release(struct cut *c)
{
  free(c->end);
  memset(c, 0, sizeof *c);
}

/* A sphere with layers in a box, all tetrahedra or mixed. With layers of prisms
 * the boundary gets two quadrilaterals, for the writers only. */
static inline void cut_mesh(struct vg_mesh *out, struct vg_join_info *info,
                            enum vg_layer_cells cells)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report report;
  struct vg_sizing *sizing;
  struct model m;
  uint64_t seed = 5;

  model_sphere(&m, 6, 6, &seed);
  sizing = shape_sizing(FRONT_MESH(&m.layers.front, &m.surface), 1.5, 0);
  if (fill_mesh(FRONT_MESH(&m.layers.front, &m.surface), sizing, &options,
                &m.field, &report, NULL) < 0)
    abort();
  vg_sizing_free(sizing);
  if (vg_layers_join(&m.surface, &m.layers, &m.field, cells, 1, out, info,
                     NULL) < 0)
    abort();
  model_release(&m);
  if (cells == VG_LAYER_TETS) return;
  out->n_quad = 2;
  out->quad = vg_alloc(2, sizeof *out->quad);
  out->quad_patch = vg_calloc(2, sizeof *out->quad_patch);
  shape_need(out->quad);
  shape_need(out->quad_patch);
  for (uint32_t k = 0; k < 8; k++) out->quad[k / 4][k % 4] = 3 * k;
}

/* Formats of faces require a closed boundary: remove these quadrilaterals.
 * Returns their number, so that they can be restored. */
static inline size_t cut_close(struct vg_mesh *m, const char *form)
{
  size_t n = m->n_quad;

  if (!strcmp(form, "fluent.msh")) m->n_quad = 0;
  return n;
}

#endif
