/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/table.h, base/hash.h, base/tri_key.h: tables compared with plain
 * lists. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/hash.h"
#include "base/table.h"
#include "base/tri_key.h"

enum { KEYS = 3000 };

struct keys {
  uint64_t key[KEYS];
  uint32_t n;
  int crowded; /* all keys have the same hash */
};

static uint64_t hash_of(const void *of, uint32_t item)
{
  const struct keys *k = of;

  return k->crowded ? UINT64_MAX : vg_hash_1(k->key[item]);
}

static uint32_t *find(const struct vg_table *t, const struct keys *k,
                      uint64_t key)
{
  uint32_t *at;

  VG_TABLE_FIND(t, at, k->crowded ? UINT64_MAX : vg_hash_1(key),
                k->key[*at] == key);
  return at;
}

static uint32_t place_in(const struct keys *k, uint64_t key)
{
  uint32_t i = 0;

  while (i < k->n && k->key[i] != key) i++;
  return i < k->n ? i : VG_TABLE_FREE;
}

static size_t n_slot(const struct vg_table *t)
{
  return (size_t)(t->end - t->slot);
}

/* Random keys, each inserted if it is new. */
static void draw_keys(int n, uint64_t among, int crowded)
{
  static struct keys k;
  struct vg_table t = VG_TABLE_INIT;
  uint64_t draw = 1;

  k.n = 0;
  k.crowded = crowded;
  for (int i = 0; i < n; i++) {
    uint64_t key;
    uint32_t *at;

    draw = vg_hash_mix(draw + VG_GOLDEN);
    key = draw % among << 7;
    assert_int_equal(vg_table_reserve(&t, k.n + 1, hash_of, &k), 0);
    assert_true(n_slot(&t) >= 2 * (size_t)(k.n + 1));
    assert_true(n_slot(&t) <= 16 || n_slot(&t) < 8 * (size_t)(k.n + 1));
    at = find(&t, &k, key);
    assert_int_equal(*at, place_in(&k, key));
    if (*at != VG_TABLE_FREE) continue;
    *at = k.n;
    k.key[k.n++] = key;
  }
  for (uint32_t i = 0; i < k.n; i++)
    assert_int_equal(*find(&t, &k, k.key[i]), i);
  assert_int_equal(*find(&t, &k, 1), VG_TABLE_FREE);
  vg_table_clear(&t);
  for (uint32_t i = 0; i < k.n; i++)
    assert_int_equal(*find(&t, &k, k.key[i]), VG_TABLE_FREE);
  vg_table_release(&t);
  vg_table_release(&t);
}

static void agrees_with_a_plain_list(void **state)
{
  (void)state;
  draw_keys(2000, 50, 0);
  draw_keys(KEYS, UINT64_MAX >> 7, 0);
}

/* All in one run of slots, which begins at the last slot. */
static void survives_equal_hashes(void **state)
{
  (void)state;
  draw_keys(500, UINT64_MAX >> 7, 1);
}

static void refuses(void **state)
{
  struct keys k = { .n = 0 };
  struct vg_table t = VG_TABLE_INIT;
  const uint32_t *slot;

  (void)state;
  assert_int_equal(vg_table_init(&t, (size_t)UINT32_MAX + 1), -1);
  assert_int_equal(vg_table_init(&t, SIZE_MAX), -1);
  assert_null(t.slot);
  assert_int_equal(vg_table_init(&t, 0), 0);
  *find(&t, &k, 5) = k.n;
  k.key[k.n++] = 5;
  slot = t.slot;
  assert_int_equal(vg_table_reserve(&t, SIZE_MAX / 2 + 1, hash_of, &k), -1);
  assert_ptr_equal(t.slot, slot);
  assert_int_equal(*find(&t, &k, 5), 0);
  vg_table_release(&t);
}

/* Meshes depend on these values. */
static void hashes_stay(void **state)
{
  const double x[3] = { 0, 1, -2.5 }, y[3] = { -0.0, 1, -2.5 };

  (void)state;
  assert_true(vg_hash_mix(0) == 0);
  assert_true(vg_hash_mix(1) == UINT64_C(0xD6E8FEB8B0B1032B));
  assert_true(vg_hash_mix(VG_GOLDEN) == UINT64_C(0x17FB89EE9DCAB42A));
  assert_true(vg_hash_3(1, 2, 3) == VG_GOLDEN + 2 * VG_HASH_2 + 3 * VG_HASH_3);
  assert_true(vg_hash_point(x) == vg_hash_point(y));
}

enum { BITS = 14, HALF = 1 << (BITS - 1) };

/* Numbers of a mesh are consecutive. 8192 random keys would reach 16384 (1 -
 * exp(-1/2)) = 6447 of 16384 slots; keys with a pattern reach at least 0.8 of
 * that, so that searches stay short. */
static void reach_slots(uint64_t (*key)(uint64_t i))
{
  static uint8_t hit[1 << BITS];
  int n = 0;

  memset(hit, 0, sizeof hit);
  for (uint64_t i = 0; i < HALF; i++) hit[vg_hash_1(key(i)) >> (64 - BITS)] = 1;
  for (int i = 0; i < 1 << BITS; i++) n += hit[i];
  assert_true(n > 0.8 * 6447);
}

static uint64_t rising(uint64_t i)
{
  return i;
}
static uint64_t edges(uint64_t i)
{
  return i << 32 | (i + 1);
}
static uint64_t names(uint64_t i)
{
  return (i >> 7) << 32 | (i & 127);
}

static uint64_t cubes(uint64_t i)
{
  return (i >> 9) << 42 | (i >> 4 & 31) << 21 | (i & 15);
}

static void spreads_patterns(void **state)
{
  (void)state;
  reach_slots(rising);
  reach_slots(edges);
  reach_slots(names);
  reach_slots(cubes);
}

static void keys_of_triangles(void **state)
{
  const uint32_t order[6][3] = { { 7, 8, 9 }, { 8, 9, 7 }, { 9, 7, 8 },
                                 { 8, 7, 9 }, { 7, 9, 8 }, { 9, 8, 7 } };

  (void)state;
  for (int i = 0; i < 6; i++) {
    uint32_t v[3] = { order[i][0], order[i][1], order[i][2] };
    struct vg_tri_key key = vg_tri_key(v);

    assert_true(key.low == ((uint64_t)7 << 32 | 8) && key.high == 9);
    assert_int_equal(vg_order3(v), i >= 3);
    assert_true(v[0] == 7 && v[1] == 8 && v[2] == 9);
    v[1] = 6;
    assert_false(vg_tri_key_same(vg_tri_key(v), key));
  }
  assert_true(vg_edge_key(3, 4) == vg_edge_key(4, 3));
  assert_true(vg_edge_key(4, 3) == ((uint64_t)3 << 32 | 4));
}

/* All orders of four numbers, and whether they are odd. */
static void four_numbers_are_sorted(void **state)
{
  (void)state;
  for (int i = 0; i < 256; i++) {
    uint32_t v[4] = { i & 3, i >> 2 & 3, i >> 4 & 3, i >> 6 };
    uint32_t odd = 0;
    int all = 0;

    for (int k = 0; k < 4; k++) {
      all |= 1 << v[k];
      for (int j = k + 1; j < 4; j++) odd ^= v[k] > v[j];
    }
    if (all != 15) continue;
    assert_int_equal(vg_order4(v), odd);
    for (uint32_t k = 0; k < 4; k++) assert_int_equal(v[k], k);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(agrees_with_a_plain_list),
    cmocka_unit_test(survives_equal_hashes),
    cmocka_unit_test(refuses),
    cmocka_unit_test(hashes_stay),
    cmocka_unit_test(spreads_patterns),
    cmocka_unit_test(keys_of_triangles),
    cmocka_unit_test(four_numbers_are_sorted),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
