/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/plane_mesh.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_plane_mesh_release(struct vg_plane_mesh *m)
{
  free(m->x);
  free(m->tri);
  free(m->quad);
  free(m->edge);
  free(m->edge_patch);
  free(m->patch);
  memset(m, 0, sizeof *m);
}

static vg_status allocate(const struct vg_plane_mesh *m, struct vg_mesh *out,
                          struct vg_error *err)
{
  const size_t n_quad = 2 * m->n_quad + m->n_edge;

  out->point = vg_alloc(2 * m->n_point, sizeof *out->point);
  out->tri = vg_alloc(2 * m->n_tri, sizeof *out->tri);
  out->tri_patch = vg_alloc(2 * m->n_tri, sizeof *out->tri_patch);
  out->quad = vg_alloc(n_quad, sizeof *out->quad);
  out->quad_patch = vg_alloc(n_quad, sizeof *out->quad_patch);
  out->pri = vg_alloc(m->n_tri, sizeof *out->pri);
  out->hex = vg_alloc(m->n_quad, sizeof *out->hex);
  out->patch = vg_alloc(m->n_patch + 2, sizeof *out->patch);
  if (!out->point || !out->tri || !out->tri_patch || !out->quad ||
      !out->quad_patch || !out->pri || !out->hex || !out->patch)
    return vg_fail_memory(err, "the mesh one cell thick");
  return VG_OK;
}

static void put_points(const struct vg_plane_mesh *m, int axis, double width,
                       struct vg_mesh *out)
{
  out->n_point = 2 * m->n_point;
  for (size_t i = 0; i < out->n_point; i++) {
    const int is_far = i >= m->n_point;
    const double *x = m->x[is_far ? i - m->n_point : i];

    out->point[i][0] = x[0];
    out->point[i][3 - axis] = x[1];
    /* A rotation about x, so that cells keep their orientation. */
    out->point[i][axis] = is_far == (axis == 2) ? width : 0;
  }
}

/* Cells, and their faces in both planes. */
static void put_cells(const struct vg_plane_mesh *m, struct vg_mesh *out)
{
  const uint32_t n = (uint32_t)m->n_point;
  const uint32_t patch = (uint32_t)m->n_patch;

  out->n_pri = m->n_tri;
  out->n_hex = m->n_quad;
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++) {
      out->pri[i][k] = out->tri[2 * i][k] = m->tri[i][k];
      out->pri[i][k + 3] = out->tri[2 * i + 1][2 - k] = n + m->tri[i][k];
    }
  for (size_t i = 0; i < m->n_quad; i++)
    for (int k = 0; k < 4; k++) {
      out->hex[i][k] = out->quad[2 * i][k] = m->quad[i][k];
      out->hex[i][k + 4] = out->quad[2 * i + 1][3 - k] = n + m->quad[i][k];
    }
  out->n_tri = 2 * m->n_tri;
  out->n_quad = 2 * m->n_quad;
  for (size_t i = 0; i < out->n_tri; i++)
    out->tri_patch[i] = patch + (uint32_t)(i & 1);
  for (size_t i = 0; i < out->n_quad; i++)
    out->quad_patch[i] = patch + (uint32_t)(i & 1);
}

static void put_edges(const struct vg_plane_mesh *m, struct vg_mesh *out)
{
  const uint32_t n = (uint32_t)m->n_point;

  for (size_t i = 0; i < m->n_edge; i++) {
    const uint32_t a = m->edge[i][0], b = m->edge[i][1];
    const uint32_t quad[4] = { b, a, n + a, n + b };

    memcpy(out->quad[out->n_quad], quad, sizeof quad);
    out->quad_patch[out->n_quad++] = m->edge_patch[i];
  }
}

vg_status vg_plane_mesh_extrude(const struct vg_plane_mesh *m, int axis,
                                double width, const struct vg_patch plane[2],
                                struct vg_mesh *out, struct vg_error *err)
{
  assert((axis == 1 || axis == 2) && width > 0);

  struct vg_mesh made = VG_MESH_INIT;
  vg_status st;

  if (m->n_point >= UINT32_MAX / 2)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the mesh has more than 4 billion points; coarsen it");
  VG_TRY(allocate(m, &made, err));
  put_points(m, axis, width, &made);
  put_cells(m, &made);
  put_edges(m, &made);
  memcpy(made.patch, m->patch, m->n_patch * sizeof *made.patch);
  memcpy(made.patch + m->n_patch, plane, 2 * sizeof *plane);
  made.n_patch = m->n_patch + 2;
  *out = made;
  return VG_OK;
done:
  vg_mesh_release(&made);
  return st;
}
