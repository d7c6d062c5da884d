/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/mesh/medit.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(vg_medit_parse, data, size);
  return 0;
}
