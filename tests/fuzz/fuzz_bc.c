/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "base/memory.h"
#include "io/vgrid/vgrid.h"

#define N_POINT 40

static vg_status parse(struct vg_input *in, struct vg_mesh *m,
                       struct vg_error *err)
{
  struct vg_mesh made = VG_MESH_INIT;
  struct vg_cogsg_info info = VG_COGSG_INFO_INIT;
  vg_status st = VG_OK;

  made.point = vg_calloc(N_POINT, sizeof *made.point);
  if (!made.point) return vg_fail_memory(err, "points");
  made.n_point = N_POINT;
  st = vg_bc_parse(in, N_POINT, &made, &info, err);
  if (st == VG_OK) vg_mesh_move(m, &made);
  vg_mesh_release(&made);
  return st;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(parse, data, size);
  return 0;
}
