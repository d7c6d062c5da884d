/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/vgrid/vgrid.h"

static vg_status parse(struct vg_input *in, struct vg_mesh *m,
                       struct vg_error *err)
{
  return vg_front_parse(in, NULL, m, err);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(parse, data, size);
  return 0;
}
