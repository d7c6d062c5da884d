/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

/* The stream itself: gzip recognised by its first bytes, tokens, lines, numbers
 * and Fortran records of any data. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT, record;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_input_memory("FUZZ", data, size, &in, &err);
  const char *text;
  size_t len, sum = 0;
  double real;
  int64_t integer;

  fuzz_check_answer(st, &err);
  if (st < 0) return 0;
  while (vg_input_token(&in, &text, &len)) {
    fuzz_expect(len > 0 && text + len <= (char *)in.data + in.size,
                "tokens are within the data");
    if (vg_parse_real(text, len, &real))
      fuzz_expect(isfinite(real), "numbers are finite");
    sum += (size_t)vg_parse_int(text, len, &integer);
  }
  in.at = 0;
  while (vg_input_line(&in, &text, &len)) sum += len;
  fuzz_expect(sum <= in.size * 2, "lines are within the data");
  for (int kind = 0; kind < 4; kind++) {
    in.at = 0;
    in.marker8 = kind & 1;
    vg_input_order(&in, kind >> 1);
    while (vg_input_left(&in) &&
           vg_input_record(&in, &record, "data", &err) == VG_OK)
      fuzz_expect(record.at <= record.size && record.size <= in.size,
                  "records are within the data");
  }
  vg_input_release(&in);
  return 0;
}
