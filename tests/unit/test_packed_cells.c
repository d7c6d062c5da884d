/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/packed_cells.h: every cell comes back as it was. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/hash.h"
#include "core/mesh/packed_cells.h"

enum { MOST = 133 };

/* Random cells that contain the smallest and the largest index. */
static void draw(size_t n, size_t n_point, uint32_t (*cell)[4])
{
  for (size_t k = 0; k < 4 * n; k++)
    cell[k / 4][k % 4] = (uint32_t)(vg_hash_mix(n_point + k) % n_point);
  if (!n) return;
  cell[n - 1][3] = (uint32_t)(n_point - 1);
  cell[n / 2][0] = 0;
  cell[n / 2][1] = (uint32_t)(n_point - 1);
}

static void check(size_t n, size_t n_point)
{
  static uint32_t cell[MOST][4], all[MOST + 1][4];
  struct vg_packed_cells p = { 0 };
  unsigned width = 1;

  while ((uint64_t)1 << width < n_point) width++;
  draw(n, n_point, cell);
  assert_int_equal(vg_packed_cells_new(n, (const uint32_t(*)[4])cell, n_point,
                                       &p),
                   0);
  assert_int_equal(p.width, width);
  assert_true(vg_packed_cells_bytes(&p, n) <= (4 * n * width + 7) / 8 + 16);
  memset(all, 0xee, sizeof all);
  vg_packed_cells_all(&p, n, all);
  assert_memory_equal(all, cell, n * sizeof *cell);
  assert_int_equal(all[n][0], 0xeeeeeeee);
  for (size_t c = n; c--;) {
    uint32_t v[4];

    vg_packed_cell(&p, c, v);
    assert_memory_equal(v, cell[c], sizeof v);
    assert_int_equal(vg_packed_corner(&p, 4 * c + 2), cell[c][2]);
  }
  vg_packed_cells_release(&p);
  assert_null(p.word);
}

/* All widths, and numbers of cells that end at different bits of a word. */
static void cells_come_back(void **state)
{
  (void)state;
  for (int width = 1; width <= 32; width++)
    for (size_t n = 0; n <= MOST; n += n < 20 ? 1 : 31)
      for (int less = 0; less < 2 && (!less || width > 1); less++)
        check(n, ((size_t)1 << width) - (size_t)less);
}

/* Without cells there are no bytes to release or count. */
static void an_empty_one_is_zero(void **state)
{
  struct vg_packed_cells p = { 0 };

  (void)state;
  assert_int_equal(vg_packed_cells_bytes(&p, 0), 0);
  vg_packed_cells_all(&p, 0, NULL);
  vg_packed_cells_release(&p);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(cells_come_back),
    cmocka_unit_test(an_empty_one_is_zero),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
