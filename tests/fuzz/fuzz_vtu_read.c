/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/mesh/vtu_read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double(*x)[3] = NULL, *v = NULL;
  size_t n = 0;

  if (vg_input_memory("fuzz.vtu", data, size, &in, &err) < 0) return 0;
  if (vg_vtu_points_parse(&in, "size", &n, &x, &v, &err) >= 0) {
    fuzz_expect(n > 0 && x && v, "points and values");
    for (size_t i = 0; i < n; i++)
      fuzz_expect(isfinite(v[i]) && isfinite(x[i][0]) && isfinite(x[i][1]) &&
                    isfinite(x[i][2]),
                  "finite numbers");
  } else {
    fuzz_expect(err.text[0] && !x && !v,
                "a failure has a message and no values");
  }
  free(x);
  free(v);
  vg_input_release(&in);
  return 0;
}
