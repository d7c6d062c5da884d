/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/fill/sites.h: bits of a lattice compared with a plain table. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/fill/sites.h"

enum { HALF = 20, SIDE = 2 * HALF };

static int is_set(struct vg_sites *s, const int64_t i[3], float h)
{
  const struct vg_site_block *b = vg_sites_block(s, i, h);

  assert_non_null(b);
  assert_true(vg_site_is_in(b, i));
  return b->bit[i[0] & 7] & vg_site_bit(i) ? 1 : 0;
}

/* Set some sites around a position, for two spacings, then query all. */
static void check(int64_t x, int64_t y, int64_t z)
{
  static uint8_t set[2][SIDE][SIDE][SIDE];
  const float h[2] = { 0.5f, 0.5000001f };
  struct vg_sites s = { 0 };
  uint32_t draw = 1;

  memset(set, 0, sizeof set);
  for (int n = 0; n < 20000; n++) {
    int at[3], lattice = n & 1;
    int64_t i[3];
    struct vg_site_block *b;

    for (int k = 0; k < 3; k++) {
      draw = draw * 1664525u + 1013904223u;
      at[k] = (int)(draw >> 8) % SIDE;
    }
    i[0] = x + at[0] - HALF;
    i[1] = y + at[1] - HALF;
    i[2] = z + at[2] - HALF;
    assert_int_equal(is_set(&s, i, h[lattice]),
                     set[lattice][at[0]][at[1]][at[2]]);
    b = vg_sites_block(&s, i, h[lattice]);
    b->bit[i[0] & 7] |= vg_site_bit(i);
    set[lattice][at[0]][at[1]][at[2]] = 1;
  }
  for (int n = 0; n < 2 * SIDE * SIDE * SIDE; n++) {
    int a = n / 2 / SIDE / SIDE, b = n / 2 / SIDE % SIDE, c = n / 2 % SIDE;
    int64_t i[3] = { x + a - HALF, y + b - HALF, z + c - HALF };

    assert_int_equal(is_set(&s, i, h[n & 1]), set[n & 1][a][b][c]);
  }
  vg_sites_release(&s);
}

static void test_bits(void **state)
{
  (void)state;
  check(0, 0, 0);
  check(-1000000000, 999999999, 12345);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_bits) };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
