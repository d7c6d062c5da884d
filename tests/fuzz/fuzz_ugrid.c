/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/mesh/ugrid.h"

static struct vg_ugrid_kind kind;

static vg_status parse(struct vg_input *in, struct vg_mesh *m,
                       struct vg_error *err)
{
  return vg_ugrid_parse(in, &kind, m, NULL, err);
}

/* The format normally follows from the file name; here the first byte encodes
 * it: bit 0 text, 1 real*4, 2 integer*8, 3 records, 4 big-endian. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  if (!size) return 0;
  kind.is_text = *data & 1;
  kind.real_size = *data & 2 ? 4 : 8;
  kind.int_size = *data & 4 ? 8 : 4;
  kind.is_record = !!(*data & 8);
  kind.is_big = !!(*data & 16);
  if (kind.int_size == 8 && (kind.is_record || kind.real_size == 4)) return 0;
  fuzz_mesh(parse, data + 1, size - 1);
  return 0;
}
