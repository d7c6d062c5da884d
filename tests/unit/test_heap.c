/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/heap.h and base/buckets.h, compared with a list that is searched. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/buckets.h"
#include "base/hash.h"
#include "base/heap.h"

enum { MOST = 500 };

struct item {
  double key;
  uint32_t number;
};

static int before(const struct item *a, const struct item *b)
{
  if (a->key != b->key) return a->key < b->key;
  return a->number < b->number;
}

VG_HEAP_DEFINE(item, struct item, before)

static size_t first_of(const struct item *list, size_t n)
{
  size_t first = 0;

  for (size_t i = 1; i < n; i++)
    if (before(&list[i], &list[first])) first = i;
  return first;
}

/* Items are inserted and removed at random; there are few different keys, so
 * that the item number often decides. */
static void leave_in_order(void **state)
{
  static struct item heap[MOST], list[MOST];
  size_t n = 0, n_list = 0;
  uint64_t draw = 1;

  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    draw = vg_hash_mix(draw + VG_GOLDEN);
    if (n < MOST && (!n || draw >> 40 & 1)) {
      struct item it = { (double)(draw % 20), i };

      item_push(heap, &n, it);
      list[n_list++] = it;
    } else {
      size_t first = first_of(list, n_list);
      struct item it = item_pop(heap, &n);

      assert_int_equal(it.number, list[first].number);
      assert_true(it.key == list[first].key);
      list[first] = list[--n_list];
    }
    assert_int_equal(n, n_list);
    if (n) assert_int_equal(heap[0].number, list[first_of(list, n)].number);
  }
}

/* Rising, falling and equal keys, all sizes up to 40. */
static void leave_sorted(void **state)
{
  struct item heap[40], last;

  (void)state;
  for (uint32_t most = 1; most <= 40; most++)
    for (int kind = 0; kind < 3; kind++) {
      size_t n = 0;

      for (uint32_t i = 0; i < most; i++)
        item_push(heap, &n,
                  (struct item){ kind == 0   ? i
                                 : kind == 1 ? -1. * i
                                             : 0,
                                 i });
      last = item_pop(heap, &n);
      while (n) {
        struct item next = item_pop(heap, &n);

        assert_true(before(&last, &next));
        last = next;
      }
    }
}

/* The first item of the lowest class; the list is in the order of arrival. */
static size_t lowest_of(const int *class, const uint32_t *item, size_t n)
{
  size_t lowest = 0;

  for (size_t i = 1; i < n; i++)
    if (class[item[i]] < class[item[lowest]]) lowest = i;
  return lowest;
}

/* Items are inserted and removed at random, some repeatedly; classes beyond the
 * ends too. */
static void classes_one_after_another(void **state)
{
  static int class[MOST];
  static uint32_t list[MOST], spare[MOST];
  struct vg_buckets b = { .n = 0 };
  size_t n = 0, n_spare = 0;
  uint64_t draw = 1;

  (void)state;
  assert_int_equal(vg_buckets_init(&b, 10), 0);
  for (uint32_t i = 0; i < MOST; i++) {
    assert_int_equal(vg_buckets_reserve(&b, i + 1), 0);
    spare[n_spare++] = i;
  }
  for (int i = 0; i < 20000; i++) {
    draw = vg_hash_mix(draw + VG_GOLDEN);
    if (n_spare && (!n || draw >> 40 & 1)) {
      uint32_t item = spare[--n_spare];
      int wanted = (int)(draw % 14) - 2;

      vg_buckets_push(&b, wanted, item);
      class[item] = wanted < 0 ? 0 : wanted > 9 ? 9 : wanted;
      list[n++] = item;
    } else {
      size_t at = lowest_of(class, list, n);

      assert_int_equal(vg_buckets_pop(&b), list[at]);
      spare[n_spare++] = list[at];
      for (n--; at < n; at++) list[at] = list[at + 1];
    }
  }
  for (; n; n--) assert_true(vg_buckets_pop(&b) != VG_BUCKETS_NONE);
  assert_true(vg_buckets_pop(&b) == VG_BUCKETS_NONE);
  vg_buckets_release(&b);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(leave_in_order),
    cmocka_unit_test(leave_sorted),
    cmocka_unit_test(classes_one_after_another),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
