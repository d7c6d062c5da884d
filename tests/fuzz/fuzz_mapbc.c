/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/vgrid/mapbc.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_mapbc b = VG_MAPBC_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_input_memory("FUZZ", data, size, &in, &err);

  if (st == VG_OK) st = vg_mapbc_parse(&in, &b, &err);
  fuzz_check_answer(st, &err);
  for (size_t i = 0; i < b.n; i++)
    fuzz_expect(memchr(b.entry[i].name, 0, VG_NAME_MAX) != NULL,
                "names are terminated");
  vg_mapbc_release(&b);
  vg_input_release(&in);
  return 0;
}
