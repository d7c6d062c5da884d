/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/stream/metis_part.h"

#include <assert.h>

#include "io/stream/stream.h"

uint64_t vg_metis_part_bytes(size_t n, const uint32_t *part)
{
  uint64_t bytes = 2 * (uint64_t)n;

  for (size_t i = 0; i < n; i++)
    for (uint32_t p = part[i]; p > 9; p /= 10) bytes++;
  return bytes;
}

void vg_metis_part_put(struct vg_output *out, size_t n, const uint32_t *part)
{
  assert(part || !n);
  for (size_t i = 0; i < n; i++) {
    vg_output_int(out, part[i]);
    vg_output_bytes(out, "\n", 1);
  }
}

vg_status vg_metis_part_write(const char *path, size_t n, const uint32_t *part,
                              struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_open(path, &out, err);

  if (st >= 0) {
    vg_metis_part_put(&out, n, part);
    st = vg_output_commit(&out, err);
  }
  vg_output_release(&out);
  return st;
}
