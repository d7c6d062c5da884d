/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writes a mesh in slices as one .msh with the bytes of vg_gmsh_write. The
 * bounding boxes of patches need the boundary points, which are collected from
 * the slices. */
#include "core/mesh/sheets.h"
#include "io/slices/slices_parts.h"
#include "io/stream/shared_file.h"

struct gmsh {
  struct vg_gmsh file;
  const struct vg_periodic_links *links;
  struct vg_boundary_points boundary;
};

static void put_frame(const void *of, struct vg_output *out)
{
  const struct gmsh *g = of;

  vg_gmsh_put(out, &g->file);
  vg_gmsh_put_periodic(out, &g->file, g->links);
}

static void put_slice(void *of, const struct vg_slice *slice,
                      struct vg_output *out)
{
  struct gmsh *g = of;

  vg_output_order(out, 0);
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    if (!slice->n_cell[k]) continue;
    vg_gmsh_seek_cell(out, &g->file, k, slice->cell_at[k]);
    vg_gmsh_put_cells(out, &g->file, k, slice->cell_at[k], slice->n_cell[k],
                      slice->cell[k], slice->id);
  }
  if (slice->n_own) {
    vg_gmsh_seek_tags(out, &g->file, slice->point_at);
    vg_gmsh_put_tags(out, slice->point_at, slice->n_own);
    vg_gmsh_seek_points(out, &g->file, slice->point_at);
  }
  for (size_t i = 0; i < slice->n_own; i++)
    vg_output_f64(out, 3, slice->x[slice->own[i]]);
  vg_boundary_points_add(&g->boundary, slice);
}

/* On rank 0, after all slices have been written. */
static vg_status put_entities(const struct gmsh *g, struct vg_shared_file *to,
                              struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_shared(to, &out, err);

  if (st < 0) return st;
  vg_output_order(&out, 0);
  vg_output_seek(&out, g->file.at_entities);
  vg_gmsh_put_entities(&out, &g->file, (const double(*)[3])g->boundary.x);
  st = vg_output_flush(&out, err);
  vg_output_release(&out);
  return st;
}

vg_status vg_slices_write_gmsh(struct vg_comm *comm, const struct vg_slices *s,
                               const char *path,
                               const struct vg_slices_options *o,
                               struct vg_error *err)
{
  const struct vg_mesh plain = vg_slices_frame(s);
  struct vg_mesh frame;
  struct gmsh g = { .links = o->links, .boundary = { 0, NULL, NULL } };
  const struct vg_slice_file file = { path, 0, &g, put_frame, put_slice };
  struct vg_shared_file *to;
  vg_status st = vg_mesh_sheet_view(&plain, &frame, err);

  if (st >= 0) st = vg_gmsh_plan(path, &frame, &g.file, err);
  if (st >= 0) st = vg_slices_check_boundary(s, err);
  if (st >= 0) st = vg_boundary_points_new(s, &g.boundary, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_slice_file_open(&file, comm, &to, err));
  st = vg_slice_file_fill(&file, comm, s, o->threads, to, err);
  st = vg_comm_agree(comm, st, err);
  if (st >= 0) st = vg_boundary_points_share(comm, &g.boundary, err);
  if (st >= 0 && !vg_comm_rank(comm)) st = put_entities(&g, to, err);
  st = vg_shared_close(to, st, err);
done:
  vg_boundary_points_release(&g.boundary);
  vg_gmsh_release(&g.file);
  vg_mesh_sheet_view_release(&frame, &plain);
  return st;
}
