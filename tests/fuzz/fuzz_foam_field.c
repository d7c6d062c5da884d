/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A field of an OpenFOAM case for a mesh of eight cells. */
#include "fuzz.h"

#include "io/foam/foam_read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double *value = NULL;
  volatile double sum = 0; /* every value is read */
  int n = 0;

  if (vg_input_memory("FUZZ", data, size, &in, &err) == VG_OK) {
    vg_status st = vg_foam_field_parse(&in, 8, &n, &value, &err);

    fuzz_check_answer(st, &err);
    fuzz_expect(st < 0 ? !value : n >= 1 && n <= 9, "values and components");
    for (int i = 0; value && i < 8 * n; i++) sum += value[i];
    (void)sum;
  }
  free(value);
  vg_input_release(&in);
  return 0;
}
