/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/vgrid/vgrid.h"

static const uint8_t *bc_data;
static size_t bc_size;

static vg_status parse(struct vg_input *in, struct vg_mesh *m,
                       struct vg_error *err)
{
  struct vg_input bc = VG_INPUT_INIT;
  vg_status st = VG_OK;

  if (bc_size) st = vg_input_memory("FUZZ.bc", bc_data, bc_size, &bc, err);
  if (st == VG_OK)
    st = vg_cogsg_parse(in, bc_size ? &bc : NULL, m, NULL, NULL, err);
  vg_input_release(&bc);
  return st;
}

/* First byte: length of the .bc file, which follows; then the .cogsg. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  if (!size || size - 1 < data[0]) return 0;
  bc_size = data[0];
  bc_data = data + 1;
  fuzz_mesh(parse, data + 1 + bc_size, size - 1 - bc_size);
  return 0;
}
