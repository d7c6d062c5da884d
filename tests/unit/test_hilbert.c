/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/hilbert.h: interleaved bits, compared one by one. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/hash.h"
#include "core/geometry/hilbert.h"

static uint64_t by_bits(uint64_t q, int n_bit, int step)
{
  uint64_t out = 0;

  for (int i = 0; i < n_bit; i++) out |= (q >> i & 1) << step * i;
  return out;
}

static void interleaves(void **state)
{
  uint64_t q = 1;

  (void)state;
  for (int i = 0; i < 1000; i++) {
    q = vg_hash_mix(q + VG_GOLDEN);
    assert_true(vg_interleave2(q >> 32) == by_bits(q >> 32, 32, 2));
    assert_true(vg_interleave3(q >> 43) == by_bits(q >> 43, 21, 3));
  }
  assert_true(vg_interleave2(UINT32_MAX) == by_bits(UINT32_MAX, 32, 2));
  assert_true(vg_interleave3(0x1fffff) == by_bits(0x1fffff, 21, 3));
}

/* Consecutive cells along the curve share a side. */
static void walks_from_cell_to_cell(void **state)
{
  const double lo[3] = { 0, 0, 0 };
  static int at[512][3];

  (void)state;
  for (int i = 0; i < 512; i++) {
    double x[3] = { (i >> 6) + 0.5, (i >> 3 & 7) + 0.5, (i & 7) + 0.5 };
    uint64_t key = vg_hilbert_key(x, lo, (1 << 20) / 8.) >> 51;

    assert_true(key < 512);
    for (int k = 0; k < 3; k++) at[key][k] = (int)x[k];
  }
  for (int i = 1; i < 512; i++) {
    int steps = 0;

    for (int k = 0; k < 3; k++) steps += abs(at[i][k] - at[i - 1][k]);
    assert_int_equal(steps, 1);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(interleaves),
    cmocka_unit_test(walks_from_cell_to_cell),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
