/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Numbering of the points of the mesh. The boundary is in join_boundary.c. */
#include "layers/expand/join_plan.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/mesh/copies.h"
#include "core/mesh/mesh_defects.h"

vg_status vg_join_check_field(const struct vg_front *f, uint64_t n_point,
                              uint64_t n_tri, uint64_t n_other_cell,
                              struct vg_error *err)
{
  if (n_point >= f->n_point && n_tri == f->n_face && !n_other_cell)
    return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "the field (%" PRIu64 " points, %" PRIu64 " boundary "
                 "triangles) does not fill the front of the layers (%zu "
                 "points, %zu triangles)",
                 n_point, n_tri, f->n_point, f->n_face);
}

/* Whether point i of the front is a new point of a remeshed patch. */
static int is_new(const struct vg_front *f, size_t i)
{
  return f->id[i] == VG_LAYER_NEW;
}

/* Numbers the points of the surface in use, which are the roots and the points
 * of the front. Points that are one in the mesh get one number. same:
 * [surface->n_point] the first of such points; NULL: each is alone. Returns the
 * number of points. */
static size_t number_surface(struct vg_join_plan *p, const uint32_t *same)
{
  const struct vg_front *f = p->front;
  size_t n = 0;

  memset(p->root, 0xff, p->surface->n_point * sizeof *p->root);
  for (size_t i = 0; i < p->columns->n_column; i++)
    p->root[p->columns->column[i].root] = 0;
  for (size_t i = 0; i < f->n_point; i++) {
    uint32_t v = vg_layer_point_of(f->id[i]);

    if (v != VG_NO_INDEX) p->root[v] = 0;
  }
  for (size_t i = 0; same && i < p->surface->n_point; i++)
    if (p->root[i] != VG_NO_INDEX) p->root[same[i]] = 0;
  for (size_t i = 0; i < p->surface->n_point; i++)
    if (p->root[i] != VG_NO_INDEX)
      p->root[i] = same && same[i] != i ? p->root[same[i]] : (uint32_t)n++;
  return n;
}

/* Numbers the points of the front, after the columns are numbered. */
static void number_front(struct vg_join_plan *p)
{
  const struct vg_front *f = p->front;
  const struct vg_expand *e = &p->expand;
  size_t next = p->first_new;

  for (size_t i = 0; i < f->n_point; i++) {
    uint32_t c = vg_layer_column_of(f->id[i]);
    unsigned n = c != VG_NO_INDEX ? vg_mark_n(e->mark[c]) : 0;

    if (c != VG_NO_INDEX) p->id[i] = n ? e->base[c] + n - 1 : e->foot[c];
    else if (is_new(f, i)) p->id[i] = (uint32_t)next++;
    else p->id[i] = p->root[vg_layer_point_of(f->id[i])];
  }
}

static vg_status number_points(struct vg_join_plan *p, uint64_t n_field_point,
                               struct vg_error *err)
{
  struct vg_expand *e = &p->expand;
  size_t first[2], n_new = 0;
  uint32_t *same;
  vg_status st = vg_mesh_joined_points(p->surface, &same, err);

  if (st < 0) return st;
  for (size_t i = 0; i < p->front->n_point; i++)
    n_new += (size_t)is_new(p->front, i);
  p->first_flank = number_surface(p, same);
  free(same);
  p->first_new = p->first_flank + e->n_point[VG_FLANK];
  p->first_inner = p->first_new + n_new;
  p->first_field = p->first_inner + e->n_point[VG_INNER];
  p->n_point = p->first_field + n_field_point;
  if (p->n_point > UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the mesh would have %zu points, %zu of them in the "
                   "layers, but at most %u are supported: request fewer "
                   "layers or coarsen the surface",
                   p->n_point, e->n_point[VG_FLANK] + e->n_point[VG_INNER],
                   UINT32_MAX);
  first[VG_FLANK] = p->first_flank;
  first[VG_INNER] = p->first_inner;
  st = vg_expand_number(e, p->root, first, err);
  if (st == VG_OK) number_front(p);
  return st;
}

/* Checks that the faces refer to points of the mesh, and that the boundary is
 * closed if the surface is. */
static void check_boundary(const struct vg_join_plan *p)
{
  struct vg_mesh m = p->boundary;

  m.n_point = p->n_point;
  VG_CHECK("the boundary of layers and field", vg_mesh_bad_faces(&m));
  if (VG_CHECKS_ON && !vg_mesh_open_edges(p->surface))
    VG_CHECK("the boundary of layers and field", vg_mesh_open_edges(&m));
}

vg_status vg_join_plan_open(struct vg_join_plan *p,
                            const struct vg_mesh *surface,
                            const struct vg_layers *layers,
                            uint64_t n_field_point, enum vg_layer_cells cells,
                            int threads, struct vg_error *err)
{
  vg_status st;

  memset(p, 0, sizeof *p);
  p->surface = surface;
  p->columns = &layers->columns;
  p->front = &layers->front;
  p->cells = cells;
  p->root = vg_alloc(surface->n_point, sizeof *p->root);
  p->id = vg_alloc(p->front->n_point, sizeof *p->id);
  if (!p->root || !p->id) {
    st = vg_fail_memory(err, "joining layers and field");
    goto done;
  }
  VG_TRY(vg_expand_open(&p->expand, surface, p->columns, cells, threads, err));
  VG_TRY(number_points(p, n_field_point, err));
  VG_TRY(vg_join_boundary(p, err));
  check_boundary(p);
done:
  if (st < 0) vg_join_plan_close(p);
  return st;
}

void vg_join_plan_close(struct vg_join_plan *p)
{
  vg_expand_close(&p->expand);
  free(p->root);
  free(p->id);
  vg_mesh_release(&p->boundary);
  memset(p, 0, sizeof *p);
}

void vg_join_plan_points(const struct vg_join_plan *p, int boundary_only,
                         double (*point)[3])
{
  const struct vg_mesh *s = p->surface;
  const struct vg_front *f = p->front;

  for (size_t i = 0; i < s->n_point; i++)
    if (p->root[i] != VG_NO_INDEX)
      memcpy(point[p->root[i]], s->point[i], sizeof *point);
  vg_expand_points(&p->expand, s, boundary_only, point);
  for (size_t i = 0; i < f->n_point; i++)
    if (is_new(f, i)) memcpy(point[p->id[i]], f->x[i], sizeof *point);
}

void vg_join_plan_describe(const struct vg_join_plan *p, double time,
                           struct vg_join_info *info)
{
  const struct vg_expand *e = &p->expand;

  if (!info) return;
  info->cells = p->cells;
  info->n_boundary_point = p->first_inner;
  info->n_layer_point = p->first_field;
  info->n_layer_tet = e->n_cell[VG_KIND_TET];
  info->n_layer_pyr = e->n_cell[VG_KIND_PYR];
  info->n_layer_pri = e->n_cell[VG_KIND_PRI];
  info->n_layer_hex = e->n_cell[VG_KIND_HEX];
  info->n_raised_point = e->n_point[VG_FLANK] + e->n_point[VG_INNER];
  info->wall_quads = e->wall_quads;
  info->time = time;
}

double vg_join_density(const struct vg_join_info *info)
{
  const size_t n = info->n_layer_tet + info->n_layer_pyr + info->n_layer_pri +
                   info->n_layer_hex;

  return info->n_raised_point ? (double)n / (double)info->n_raised_point : 0;
}
