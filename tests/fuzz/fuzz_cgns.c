/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/cgns/cgns.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(vg_cgns_parse, data, size);
  return 0;
}
