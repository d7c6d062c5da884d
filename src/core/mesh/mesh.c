/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/mesh.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_mesh_release(struct vg_mesh *m)
{
  assert(m);
  free(m->point);
  free(m->tri);
  free(m->quad);
  free(m->tri_patch);
  free(m->quad_patch);
  free(m->tet);
  free(m->pyr);
  free(m->pri);
  free(m->hex);
  free(m->patch);
  free(m->sheet_tri);
  free(m->sheet_of);
  free(m->sheet);
  free(m->zone);
  memset(m, 0, sizeof *m);
}

void vg_mesh_move(struct vg_mesh *to, struct vg_mesh *from)
{
  assert(to && from && to != from);
  vg_mesh_release(to);
  *to = *from;
  memset(from, 0, sizeof *from);
}

static void *copy(const void *from, size_t n, size_t size, int *bad)
{
  void *to;

  if (!n) return NULL;
  to = vg_alloc(n, size);
  if (to) memcpy(to, from, n * size);
  else *bad = 1;
  return to;
}

vg_status vg_mesh_copy(struct vg_mesh *to, const struct vg_mesh *from,
                       struct vg_error *err)
{
  int bad = 0;

  assert(to != from);
  assert(!to->n_point && !to->point && !to->patch);
  *to = *from;
#define COPY(array, n)                                                         \
  to->array = copy(from->array, from->n, sizeof *from->array, &bad)
  COPY(point, n_point);
  COPY(tri, n_tri);
  COPY(quad, n_quad);
  COPY(tri_patch, n_tri);
  COPY(quad_patch, n_quad);
  COPY(tet, n_tet);
  COPY(pyr, n_pyr);
  COPY(pri, n_pri);
  COPY(hex, n_hex);
  COPY(patch, n_patch);
  COPY(sheet_tri, n_sheet_tri);
  COPY(sheet_of, n_sheet_tri);
  COPY(sheet, n_sheet);
  COPY(zone, n_zone);
#undef COPY
  if (!bad) return VG_OK;
  vg_mesh_release(to);
  return vg_fail_memory(err, "a copy of the mesh");
}

size_t vg_mesh_find_patch(const struct vg_mesh *m, int32_t id)
{
  for (size_t i = 0; i < m->n_patch; i++)
    if (m->patch[i].id == id) return i;
  return SIZE_MAX;
}

size_t vg_mesh_add_patch(struct vg_mesh *m, int32_t id, const char *name)
{
  size_t at = vg_mesh_find_patch(m, id);
  struct vg_patch *list;

  if (at != SIZE_MAX) return at;
  list = vg_realloc(m->patch, m->n_patch + 1, sizeof *list);
  if (!list) return SIZE_MAX;
  m->patch = list;
  list += m->n_patch;
  memset(list, 0, sizeof *list);
  list->id = id;
  list->bc = list->bc_fun3d = list->family = VG_BC_NONE;
  snprintf(list->name, sizeof list->name, "%s", name ? name : "");
  return m->n_patch++;
}

void vg_mesh_bounds(const struct vg_mesh *m, double lo[3], double hi[3])
{
  assert(m->point || !m->n_point);
  for (int k = 0; k < 3; k++) lo[k] = hi[k] = m->n_point ? m->point[0][k] : 0;
  for (size_t i = 1; i < m->n_point; i++)
    for (int k = 0; k < 3; k++) {
      if (m->point[i][k] < lo[k]) lo[k] = m->point[i][k];
      if (m->point[i][k] > hi[k]) hi[k] = m->point[i][k];
    }
}

double vg_mesh_length(const struct vg_mesh *m)
{
  double lo[3], hi[3], length = 0;

  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++) length = fmax(length, hi[k] - lo[k]);
  return length;
}

int32_t vg_mesh_last_id(const struct vg_mesh *m)
{
  int32_t last = 0;

  for (size_t i = 0; i < m->n_patch; i++)
    if (m->patch[i].id > last) last = m->patch[i].id;
  for (size_t i = 0; i < m->n_sheet; i++)
    if (m->sheet[i].id > last) last = m->sheet[i].id;
  return last;
}
