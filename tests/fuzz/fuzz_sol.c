/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"
#include "fuzz_metrics.h"

#include "io/mesh/sol.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double *value = NULL;
  size_t n = 0;
  int components = 0;

  if (vg_input_memory("fuzz.sol", data, size, &in, &err) < 0) return 0;
  if (vg_sol_parse(&in, &n, &components, &value, &err) >= 0) {
    fuzz_expect(n > 0 && value, "there are values");
    fuzz_expect(components == 1 || components == 6, "scalars or metrics");
    for (size_t i = 0; i < n && components == 1; i++)
      fuzz_expect(isfinite(value[i]), "finite values");
    if (components == 6) fuzz_metrics(n, NULL, components, value);
  } else {
    fuzz_expect(err.text[0] && !value, "a failure has a message and no values");
  }
  free(value);
  vg_input_release(&in);
  return 0;
}
