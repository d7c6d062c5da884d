/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Loops over threads, alone and in their callers. Also run under the thread
 * sanitizer. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/parallel.h"
#include "join_support.h"

struct tally {
  size_t n, grain;
  unsigned char *seen;  /* [n] */
  int threads, *worker; /* [n] */
  int bad[64];          /* by worker */
};

static void visit(void *context, size_t first, size_t end, int worker)
{
  struct tally *t = context;

  if (worker < 0 || worker >= (t->threads ? t->threads : vg_cores())) abort();
  if (first % t->grain || end <= first || end > t->n ||
      (end - first != t->grain && end != t->n))
    t->bad[worker]++;
  for (size_t i = first; i < end; i++) {
    t->seen[i]++;
    t->worker[i] = worker;
  }
}

static void check_loop(size_t n, size_t grain, int threads)
{
  struct tally t = { .n = n, .grain = grain ? grain : 1, .threads = threads };

  t.seen = vg_calloc(n, 1);
  t.worker = vg_calloc(n, sizeof *t.worker);
  vg_parallel_for(threads, n, grain, visit, &t);
  for (size_t i = 0; i < n; i++) assert_int_equal(t.seen[i], 1);
  for (int i = 0; i < 64; i++) assert_int_equal(t.bad[i], 0);
  free(t.seen);
  free(t.worker);
}

static void every_item_once(void **state)
{
  static const size_t n[] = { 0, 1, 2, 7, 64, 1000, 4097 };
  static const size_t grain[] = { 0, 1, 3, 64, 5000, SIZE_MAX };

  (void)state;
  for (size_t i = 0; i < sizeof n / sizeof *n; i++)
    for (size_t k = 0; k < sizeof grain / sizeof *grain; k++)
      for (int threads = 0; threads < 6; threads++)
        check_loop(n[i], grain[k], threads);
}

static void *loop_in_thread(void *data)
{
  (void)data;
  for (int i = 0; i < 20; i++) check_loop(1000, 16, 3);
  return NULL;
}

static void loops_in_several_threads(void **state)
{
  pthread_t thread[3];

  (void)state;
  for (int i = 0; i < 3; i++)
    assert_int_equal(pthread_create(&thread[i], NULL, loop_in_thread, NULL), 0);
  for (int i = 0; i < 3; i++)
    assert_int_equal(pthread_join(thread[i], NULL), 0);
}

static void inner(void *context, size_t first, size_t end, int worker)
{
  size_t *sum = context;

  (void)worker;
  for (size_t i = first; i < end; i++) sum[i] = i;
}

static void outer(void *context, size_t first, size_t end, int worker)
{
  size_t(*sum)[100] = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    vg_parallel_for(2, 100, 7, inner, sum[i]);
}

static void a_loop_in_a_loop(void **state)
{
  size_t sum[10][100];

  (void)state;
  memset(sum, 0xff, sizeof sum);
  vg_parallel_for(3, 10, 1, outer, sum);
  for (int i = 0; i < 10; i++)
    for (size_t k = 0; k < 100; k++) assert_int_equal(sum[i][k], k);
}

static void at_least_one_core(void **state)
{
  (void)state;
  assert_true(vg_cores() >= 1);
}

static void same_bytes(const void *a, const void *b, size_t n, size_t size)
{
  if (n) assert_memory_equal(a, b, n * size);
}

/* Layers of a sphere, enough for several chunks of columns and of faces. */
static void layers_are_joined(void **state)
{
  uint64_t seed = 3;
  struct model m;

  (void)state;
  model_sphere(&m, 40, 4, &seed);
  assert_int_equal(vg_mesh_copy(&m.field,
                                FRONT_MESH(&m.layers.front, &m.surface), NULL),
                   VG_OK);
  for (int cells = VG_LAYER_TETS; cells <= VG_LAYER_HEX; cells++) {
    struct vg_mesh mesh[3] = { VG_MESH_INIT, VG_MESH_INIT, VG_MESH_INIT };

    for (int i = 0; i < 3; i++) {
      assert_int_equal(vg_layers_join(&m.surface, &m.layers, &m.field,
                                      (enum vg_layer_cells)cells, i + 1,
                                      &mesh[i], NULL, NULL),
                       VG_OK);
      assert_int_equal(mesh[i].n_tet, mesh[0].n_tet);
      assert_int_equal(mesh[i].n_pri, mesh[0].n_pri);
      assert_int_equal(mesh[i].n_pyr, mesh[0].n_pyr);
      assert_int_equal(mesh[i].n_hex, mesh[0].n_hex);
      same_bytes(mesh[0].hex, mesh[i].hex, mesh[0].n_hex, 32);
      same_bytes(mesh[0].point, mesh[i].point, mesh[0].n_point, 24);
      same_bytes(mesh[0].tet, mesh[i].tet, mesh[0].n_tet, 16);
      same_bytes(mesh[0].pri, mesh[i].pri, mesh[0].n_pri, 24);
      same_bytes(mesh[0].pyr, mesh[i].pyr, mesh[0].n_pyr, 20);
    }
    for (int i = 0; i < 3; i++) vg_mesh_release(&mesh[i]);
  }
  model_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_item_once),
    cmocka_unit_test(loops_in_several_threads),
    cmocka_unit_test(a_loop_in_a_loop),
    cmocka_unit_test(at_least_one_core),
    cmocka_unit_test(layers_are_joined),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
