/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/mesh/stl.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(vg_stl_parse, data, size);
  return 0;
}
