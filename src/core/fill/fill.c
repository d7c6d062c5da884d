#include "core/fill/fill.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/fill/grow.h"

static vg_status all_points_used(const struct vg_mesh *m,
                                 struct vg_error *err)
{
  uint8_t *used = vg_calloc(m->n_point, 1);
  size_t p = 0;

  if (!used) return vg_fail_memory(err, "the front");
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++) used[m->tri[i][k]] = 1;
  while (p < m->n_point && used[p]) p++;
  free(used);
  if (p == m->n_point) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "point %zu (%g %g %g) is in no triangle; remove it", p + 1,
                 m->point[p][0], m->point[p][1], m->point[p][2]);
}

/* The void's arrays become the mesh's; the boundary is copied. */
static vg_status to_mesh(struct vg_void *v, const struct vg_mesh *surface,
                         struct vg_mesh *out, struct vg_error *err)
{
  struct vg_mesh bare = *surface, m = VG_MESH_INIT;
  vg_status st;

  bare.n_point = bare.n_tet = bare.n_pyr = bare.n_pri = bare.n_hex = 0;
  bare.n_quad = 0;
  VG_TRY(vg_mesh_copy(&m, &bare, err));
  m.point = v->x;
  m.n_point = v->n_point;
  m.tet = v->cell;
  m.n_tet = v->n_cell;
  v->x = NULL;
  v->cell = NULL;
  vg_mesh_move(out, &m);
done:
  return st;
}

/* Field points make five cells each and more: beyond this many the limit on
 * cells cannot be kept, which is known before most of the work is done. */
static size_t most_points(uint64_t max_cells)
{
  if (!max_cells) return 0;
  return max_cells < 5 ? 1 : (size_t)(max_cells / 5);
}

static vg_status within_limit(const struct vg_void *v, uint64_t max_cells,
                              struct vg_error *err)
{
  if (!max_cells || v->n_cell <= max_cells) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED, "the mesh has %zu cells, %" PRIu64
                 " are allowed; use a coarser spacing or raise the limit",
                 v->n_cell, max_cells);
}

vg_status vg_fill(const struct vg_mesh *surface, const struct vg_sizing *sizing,
                  const struct vg_fill_options *options, struct vg_mesh *out,
                  struct vg_fill_report *report, struct vg_error *err)
{
  struct vg_void v = VG_VOID_INIT;
  struct vg_grow_options grow = VG_GROW_OPTIONS_INIT;
  vg_status st;

  memset(report, 0, sizeof *report);
  grow.sweeps = options->optimise;
  grow.point_limit = most_points(options->max_cells);
  grow.progress = options->progress;
  grow.user = options->user;
  if (!surface->n_tri)
    return vg_fail(err, VG_ERR_GEOMETRY, "the surface has no triangles: it "
                   "encloses nothing to fill");
  VG_TRY(vg_void_from_mesh(&v, surface, err));
  VG_TRY(all_points_used(surface, err));
  st = vg_grow(&v, sizing, &grow, report, err);
  if (st != VG_OK) goto done;
  VG_TRY(within_limit(&v, options->max_cells, err));
  st = to_mesh(&v, surface, out, err);
done:
  vg_void_release(&v);
  return st;
}
