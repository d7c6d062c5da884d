/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Zones of the cells of a slice: sets of cells by their points, and a face or a
 * place for each set. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"
#include "core/mesh/cell_faces.h"
#include "core/mesh/copies.h"
#include "core/sides/zone_parts.h"

/* --- interfaces ------------------------------------------------------------
 */

/* Zones on both sides of the interfaces of the surface, in the order of their
 * triangles. */
static vg_status take_sides(struct vg_zone_faces *f, struct vg_error *err)
{
  const struct vg_mesh *s = f->z->surface;
  uint32_t *first = NULL, *other = vg_alloc(s->n_tri, sizeof *other);
  size_t n = 0;
  vg_status st = other ? VG_OK : vg_fail_memory(err, "the zones");

  VG_TRY(st);
  VG_TRY(vg_mesh_inner_points(s, &first, err));
  VG_TRY(vg_mesh_inner_pairs(s, first, other, err));
  for (size_t t = 0; t < s->n_tri; t++) {
    const struct vg_patch *p = &s->patch[s->tri_patch[t]];

    if (!p->is_interface || p->inner != VG_INNER_FRONT) continue;
    assert(n < f->m.n_sheet_tri && other[t] != UINT32_MAX);
    f->zone[n][0] = f->z->of[t];
    f->zone[n++][1] = f->z->of[other[t]];
  }
  assert(n == f->m.n_sheet_tri);
done:
  free(first);
  free(other);
  return st;
}

vg_status vg_zone_faces_new(const struct vg_zone_map *z,
                            const struct vg_mesh *boundary,
                            struct vg_zone_faces *f, struct vg_error *err)
{
  const size_t n = boundary->n_sheet_tri;
  vg_status st = VG_OK;

  f->z = z;
  f->m.sheet_tri = vg_alloc(n, sizeof *f->m.sheet_tri);
  f->zone = vg_alloc(n, sizeof *f->zone);
  if (!f->m.sheet_tri || !f->zone) VG_TRY(vg_fail_memory(err, "the zones"));
  for (size_t t = 0; t < n; t++)
    if (boundary->sheet[boundary->sheet_of[t]].is_interface)
      memcpy(f->m.sheet_tri[f->m.n_sheet_tri++], boundary->sheet_tri[t],
             sizeof *f->m.sheet_tri);
  VG_TRY(take_sides(f, err));
  st = vg_sheet_table_new(&f->table, &f->m, err);
done:
  if (st < 0) vg_zone_faces_release(f);
  return st;
}

void vg_zone_faces_release(struct vg_zone_faces *f)
{
  vg_sheet_table_release(&f->table);
  vg_mesh_release(&f->m);
  free(f->zone);
  memset(f, 0, sizeof *f);
}

/* --- cells of a slice -------------------------------------------------------
 */

#define NO_ZONE UINT32_MAX

/* Cells of a slice. Set k < n_point: cells with point k; set n_point + c: cell
 * c of which all points are on interfaces. */
struct cells {
  const struct vg_zone_faces *f;
  const struct vg_slice *slice;
  uint32_t *up;   /* [n_point + n_cell] sets */
  uint32_t *zone; /* [n_point + n_cell] zones of the roots */
  double *most;   /* [n_point + n_cell] largest cell of each root so far */
  size_t n_point, n_cell;
};

typedef vg_status (*cell_body)(struct cells *s, int kind, size_t c,
                               const uint32_t *node, struct vg_error *err);

/* Calls body for each cell c of the slice. */
static vg_status each(struct cells *s, cell_body body, struct vg_error *err)
{
  vg_status st = VG_OK;
  size_t c = 0;

  for (int kind = 0; kind < VG_SLICE_KINDS; kind++)
    for (size_t i = 0; i < s->slice->n_cell[kind] && st >= 0; i++)
      st = body(s, kind, c++, s->slice->cell[kind] + i * vg_slice_width[kind],
                err);
  return st;
}

static int is_on(const struct cells *s, uint32_t local)
{
  return vg_sheet_table_on(&s->f->table, s->slice->id[local]);
}

/* A set to which the cell belongs. */
static uint32_t set_of(const struct cells *s, int kind, size_t c,
                       const uint32_t *node)
{
  for (int k = 0; k < vg_slice_width[kind]; k++)
    if (!is_on(s, node[k])) return vg_root_of(s->up, node[k]);
  return (uint32_t)(s->n_point + c);
}

static vg_status join(struct cells *s, int kind, size_t c, const uint32_t *node,
                      struct vg_error *err)
{
  const uint32_t set = set_of(s, kind, c, node);

  (void)err;
  for (int k = 0; k < vg_slice_width[kind]; k++)
    if (!is_on(s, node[k])) vg_union(s->up, set, node[k]);
  return VG_OK;
}

static void middle(const struct cells *s, int kind, const uint32_t *node,
                   double x[3])
{
  const int n = vg_slice_width[kind];

  for (int d = 0; d < 3; d++) {
    x[d] = 0;
    for (int k = 0; k < n; k++) x[d] += s->slice->x[node[k]][d] / n;
  }
}

static vg_status set_zone(struct cells *s, uint32_t set, uint32_t zone,
                          int kind, const uint32_t *node, struct vg_error *err)
{
  double x[3];

  if (s->zone[set] == NO_ZONE) s->zone[set] = zone;
  if (s->zone[set] == zone) return VG_OK;
  middle(s, kind, node, x);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "cells near (%g, %g, %g) are connected and in two zones; "
                 "please report this with the project files",
                 x[0], x[1], x[2]);
}

/* Faces on interfaces, seen from the cell. */
static vg_status meet(struct cells *s, int kind, size_t c, const uint32_t *node,
                      struct vg_error *err)
{
  vg_status st = VG_OK;
  int n = 0;

  for (int k = 0; k < vg_slice_width[kind]; k++) n += is_on(s, node[k]);
  for (int i = 0; n > 2 && i < vg_cell_faces[kind].n_face && st >= 0; i++) {
    const unsigned char *face = vg_cell_faces[kind].face[i];
    uint32_t v[3], t;
    int is_same;

    if (face[2] != face[3]) continue;
    for (int k = 0; k < 3; k++) v[k] = s->slice->id[node[face[k]]];
    t = vg_sheet_table_find(&s->f->table, v, &is_same);
    if (t != UINT32_MAX)
      st = set_zone(s, set_of(s, kind, c, node), s->f->zone[t][!is_same], kind,
                    node, err);
  }
  return st;
}

/* Sixfold volume of the tetrahedron of the first corners of a cell, which is
 * enough to tell large cells from flat ones. */
static double size_of(const struct cells *s, int kind, const uint32_t *node)
{
  static const unsigned char corner[VG_SLICE_KINDS][4] = {
    { 0, 1, 2, 3 }, { 0, 3, 4, 2 }, { 0, 1, 2, 3 }, { 0, 1, 3, 4 }
  };
  const double(*x)[3] = s->slice->x;
  const unsigned char *c = corner[kind];
  double u[3], v[3], w[3];

  vg_sub(x[node[c[1]]], x[node[c[0]]], u);
  vg_sub(x[node[c[2]]], x[node[c[0]]], v);
  vg_sub(x[node[c[3]]], x[node[c[0]]], w);
  return fabs(vg_triple(u, v, w));
}

static vg_status measure(struct cells *s, int kind, size_t c,
                         const uint32_t *node, struct vg_error *err)
{
  const uint32_t set = set_of(s, kind, c, node);
  const double size = size_of(s, kind, node);

  (void)err;
  if (size > s->most[set]) s->most[set] = size;
  return VG_OK;
}

/* The place of the largest cell of a set that has no face on an interface. */
static vg_status locate(struct cells *s, int kind, size_t c,
                        const uint32_t *node, struct vg_error *err)
{
  const uint32_t set = set_of(s, kind, c, node);
  double x[3], y[3];
  uint32_t zone;

  if (s->zone[set] != NO_ZONE || size_of(s, kind, node) < s->most[set])
    return VG_OK;
  middle(s, kind, node, x);
  zone = vg_zone_map_at(s->f->z, x);
  for (int k = 0; zone >= VG_ZONE_ON && k < vg_slice_width[kind]; k++) {
    for (int d = 0; d < 3; d++) y[d] = .7 * x[d] + .3 * s->slice->x[node[k]][d];
    zone = vg_zone_map_at(s->f->z, y);
  }
  if (zone < VG_ZONE_ON) return set_zone(s, set, zone, kind, node, err);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "the zone of the cells near (%g, %g, %g) is not known; please "
                 "report this with the project files",
                 x[0], x[1], x[2]);
}

vg_status vg_zone_of_cells(const struct vg_zone_faces *f,
                           const struct vg_slice *slice, uint16_t *of,
                           struct vg_error *err)
{
  struct cells s = { .f = f, .slice = slice, .n_point = slice->n_point };
  size_t n, c = 0;
  vg_status st;

  for (int k = 0; k < VG_SLICE_KINDS; k++) s.n_cell += slice->n_cell[k];
  n = s.n_point + s.n_cell;
  s.up = vg_alloc(n, sizeof *s.up);
  s.zone = vg_alloc(n, sizeof *s.zone);
  s.most = vg_calloc(n, sizeof *s.most);
  if (!s.up || !s.zone || !s.most) VG_TRY(vg_fail_memory(err, "the zones"));
  for (uint32_t k = 0; k < n; k++) {
    s.up[k] = k;
    s.zone[k] = NO_ZONE;
  }
  VG_TRY(each(&s, join, err));
  VG_TRY(each(&s, meet, err));
  VG_TRY(each(&s, measure, err));
  VG_TRY(each(&s, locate, err));
  for (int kind = 0; kind < VG_SLICE_KINDS; kind++)
    for (size_t i = 0; i < slice->n_cell[kind]; i++, c++)
      of[c] = (uint16_t)s.zone[set_of(
        &s, kind, c, slice->cell[kind] + i * vg_slice_width[kind])];
done:
  free(s.up);
  free(s.zone);
  free(s.most);
  return st;
}
