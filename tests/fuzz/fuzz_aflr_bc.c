/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz_aflr.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  return fuzz_aflr(data, size, vg_aflr_bc_parse);
}
