/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writes a mesh in slices as one .cgns with the bytes of vg_cgns_write. Rank 0
 * lays out the file and writes nodes and faces; it sends the offsets of the
 * arrays to the other ranks. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/sheets.h"
#include "io/slices/slices_parts.h"

#define BLOCK 4096

static void put_frame(const void *of, struct vg_output *out)
{
  const struct vg_cgns *c = of;

  if (c->between) vg_cgns_put(out, c);
  else vg_output_skip(out, c->places.size);
}

static void put_axis(const struct vg_cgns *c, const struct vg_slice *slice,
                     int axis, struct vg_output *out)
{
  double block[BLOCK];

  vg_cgns_seek_x(out, &c->places, axis, slice->point_at);
  for (size_t i = 0, n; i < slice->n_own; i += n) {
    n = slice->n_own - i < BLOCK ? slice->n_own - i : BLOCK;
    for (size_t k = 0; k < n; k++) block[k] = slice->x[slice->own[i + k]][axis];
    vg_output_f64(out, n, block);
  }
}

static void put_slice(void *of, const struct vg_slice *slice,
                      struct vg_output *out)
{
  const struct vg_cgns *c = of;

  vg_output_order(out, 0);
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    if (!slice->n_cell[k]) continue;
    vg_cgns_seek_cell(out, &c->places, k, slice->cell_at[k]);
    vg_cgns_put_cells(out, &c->places, k, slice->n_cell[k], slice->cell[k],
                      slice->id);
  }
  for (int axis = 0; axis < 3 && slice->n_own; axis++)
    put_axis(c, slice, axis, out);
}

/* Send the offsets that rank 0 has determined to all ranks. Collective. */
static vg_status share_places(struct vg_comm *comm, struct vg_cgns_places *p,
                              struct vg_error *err)
{
  struct vg_bytes b = { sizeof *p, NULL };
  vg_status st = VG_OK;

  if (!vg_comm_rank(comm)) {
    b.data = vg_alloc(1, sizeof *p);
    if (b.data) memcpy(b.data, p, sizeof *p);
    else st = vg_fail_memory(err, "the offsets in a CGNS file");
  }
  st = vg_comm_agree(comm, st, err);
  if (st >= 0) st = vg_comm_bcast(comm, 0, &b, err);
  if (st >= 0) memcpy(p, b.data, sizeof *p);
  free(b.data);
  return st;
}

vg_status vg_slices_write_cgns(struct vg_comm *comm, const struct vg_slices *s,
                               const char *path,
                               const struct vg_slices_options *o,
                               struct vg_error *err)
{
  const struct vg_mesh plain = vg_slices_frame(s);
  struct vg_mesh frame;
  struct vg_cgns c = { .frame = &frame };
  const struct vg_slice_file file = { path, 0, &c, put_frame, put_slice };
  vg_status st;

  if (s->boundary->n_zone)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: a distributed mesh with zones cannot be written in "
                   "this form; collect it first",
                   path);
  st = vg_mesh_sheet_view(&plain, &frame, err);

  if (st >= 0 && !vg_comm_rank(comm))
    st = vg_cgns_plan(path, &frame,
                      &(struct vg_cgns_options){ .links = o->links }, &c, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(share_places(comm, &c.places, err));
  st = vg_slice_file_write(&file, comm, s, o->threads, err);
done:
  vg_cgns_release(&c);
  vg_mesh_sheet_view_release(&frame, &plain);
  return st;
}
