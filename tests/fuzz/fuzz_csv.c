/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/stream/csv.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char names[40];
  double *value = NULL;
  size_t n = 0;

  if (vg_input_memory("fuzz.csv", data, size, &in, &err) < 0) return 0;
  vg_csv_names(&in, names, sizeof names);
  fuzz_expect(memchr(names, 0, sizeof names) != NULL, "the list ends");
  if (vg_csv_column(&in, "x", &n, &value, &err) >= 0)
    fuzz_expect(n > 0 && n <= size && value, "there are values");
  else
    fuzz_expect(err.text[0] && !value, "a failure has a message and no values");
  free(value);
  vg_input_release(&in);
  return 0;
}
