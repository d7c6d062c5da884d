/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writes a mesh in slices as one .su2 with the bytes of vg_su2_write. */
#include "io/slices/slices_parts.h"

static void put_frame(const void *of, struct vg_output *out)
{
  vg_su2_put(out, of);
}

static void put_slice(void *of, const struct vg_slice *slice,
                      struct vg_output *out)
{
  const struct vg_su2 *s = of;

  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    if (slice->n_cell[k]) vg_su2_seek_cell(out, s, k, slice->cell_at[k]);
    for (size_t i = 0; i < slice->n_cell[k]; i++)
      vg_su2_put_cell(out, s, k, slice->cell_at[k] + i,
                      slice->cell[k] + i * vg_slice_width[k], slice->id);
  }
  if (slice->n_own) vg_su2_seek_point(out, s, slice->point_at);
  for (size_t i = 0; i < slice->n_own; i++)
    vg_su2_put_point(out, s, slice->point_at + i, slice->x[slice->own[i]]);
}

vg_status vg_slices_write_su2(struct vg_comm *comm, const struct vg_slices *s,
                              const char *path, int threads,
                              struct vg_error *err)
{
  const struct vg_mesh frame = vg_slices_frame(s);
  struct vg_su2 su2;
  const struct vg_slice_file file = { path, 0, &su2, put_frame, put_slice };
  vg_status st = vg_comm_agree(comm, vg_su2_plan(path, &frame, &su2, err), err);

  if (st >= 0) st = vg_slice_file_write(&file, comm, s, threads, err);
  vg_su2_release(&su2);
  return st;
}
