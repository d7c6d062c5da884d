/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Two fills at once give the same bytes as one after the other. Also run under
 * the thread sanitizer. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "cli/examples/demo.h"
#include "base/child.h"
#include "fill_shapes.h"
#include "fill_support.h"

struct job {
  const struct vg_mesh *surface;
  const struct vg_sizing *sizing;
  struct vg_mesh mesh;
  struct vg_fill_report report;
  struct vg_error err;
  vg_status st;
};

static void *work(void *data)
{
  struct job *j = data;
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;

  j->st = fill_mesh(j->surface, j->sizing, &options, &j->mesh, &j->report,
                    &j->err);
  return NULL;
}

static void run_alone(struct job *job, size_t n)
{
  for (size_t i = 0; i < n; i++) work(job + i);
}

static void run_together(struct job *job, size_t n)
{
  pthread_t thread[4];

  assert_true(n <= 4);
  for (size_t i = 0; i < n; i++)
    assert_int_equal(pthread_create(thread + i, NULL, work, job + i), 0);
  for (size_t i = 0; i < n; i++)
    assert_int_equal(pthread_join(thread[i], NULL), 0);
}

static void same_mesh(const struct job *a, const struct job *b)
{
  assert_int_equal(a->st, VG_OK);
  assert_int_equal(b->st, VG_OK);
  assert_true(a->mesh.n_tet > 0);
  assert_int_equal(a->mesh.n_point, b->mesh.n_point);
  assert_int_equal(a->mesh.n_tet, b->mesh.n_tet);
  assert_memory_equal(a->mesh.point, b->mesh.point,
                      a->mesh.n_point * sizeof *a->mesh.point);
  assert_memory_equal(a->mesh.tet, b->mesh.tet,
                      a->mesh.n_tet * sizeof *a->mesh.tet);
}

/* An example with its own sizing field. */
static struct vg_sizing *example(const char *name, size_t n_cell,
                                 struct vg_demo *d)
{
  struct vg_sizing *sizing = NULL;

  memset(d, 0, sizeof *d);
  assert_int_equal(vg_demo_make(name, n_cell, d, NULL), VG_OK);
  assert_int_equal(vg_sizing_new(&d->sizing, d->n_source, d->source,
                                 &d->surface, &sizing, NULL),
                   VG_OK);
  return sizing;
}

/* Two different voids, each with its own sizing field. */
static void two_voids_at_once(void **state)
{
  struct vg_demo demo[2];
  struct vg_sizing *sizing[2];
  struct job alone[2], together[2];

  (void)state;
  memset(alone, 0, sizeof alone);
  sizing[0] = example("box", 3000, &demo[0]);
  sizing[1] = example("box", 8000, &demo[1]);
  for (int i = 0; i < 2; i++) {
    alone[i].surface = &demo[i].surface;
    alone[i].sizing = sizing[i];
  }
  memcpy(together, alone, sizeof together);
  run_alone(alone, 2);
  run_together(together, 2);
  for (int i = 0; i < 2; i++) {
    assert_int_equal(alone[i].report.n_surface_face_lost, 0);
    same_mesh(&alone[i], &together[i]);
    vg_mesh_release(&alone[i].mesh);
    vg_mesh_release(&together[i].mesh);
    vg_sizing_free(sizing[i]);
    vg_demo_release(&demo[i]);
  }
}

/* Four fills of one surface that share one sizing field. */
static void a_field_is_shared(void **state)
{
  struct vg_demo demo;
  struct vg_sizing *sizing = example("box", 5000, &demo);
  struct job job[4], alone;

  (void)state;
  memset(&alone, 0, sizeof alone);
  alone.surface = &demo.surface;
  alone.sizing = sizing;
  for (int i = 0; i < 4; i++) job[i] = alone;
  run_alone(&alone, 1);
  run_together(job, 4);
  assert_int_equal(alone.report.n_surface_face_lost, 0);
  for (int i = 0; i < 4; i++) {
    same_mesh(&alone, &job[i]);
    vg_mesh_release(&job[i].mesh);
  }
  vg_mesh_release(&alone.mesh);
  vg_sizing_free(sizing);
  vg_demo_release(&demo);
}

/* Surfaces with triangles that TetGen must recover, in two threads. */
static void pockets_at_once(void **state)
{
  const double centre[3] = { 0.1, -0.2, 0 };
  struct vg_mesh s[2] = { VG_MESH_INIT, VG_MESH_INIT };
  struct job alone[2], together[2];

  (void)state;
  memset(alone, 0, sizeof alone);
  shape_torus(&s[0], 36, 14, 1, 0.35);
  shape_box(&s[1], 5, 4);
  shape_sphere(&s[1], 8, centre, 1, 7);
  for (int i = 0; i < 2; i++) {
    alone[i].surface = &s[i];
    alone[i].sizing = shape_sizing(&s[i], 1.3, 0);
  }
  memcpy(together, alone, sizeof together);
  run_alone(alone, 2);
  run_together(together, 2);
  for (int i = 0; i < 2; i++) {
    assert_true(alone[i].report.n_surface_face_lost > 0);
    same_mesh(&alone[i], &together[i]);
    vg_mesh_release(&alone[i].mesh);
    vg_mesh_release(&together[i].mesh);
    vg_sizing_free((struct vg_sizing *)alone[i].sizing);
    vg_mesh_release(&s[i]);
  }
}

/* The thread sanitizer's allocator does not survive a fork while threads run,
 * so TetGen's child processes come from a server, as in the program. */
int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(two_voids_at_once),
    cmocka_unit_test(a_field_is_shared),
    cmocka_unit_test(pockets_at_once),
  };

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
