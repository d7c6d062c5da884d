/* Two fills at once: the same bytes as one after the other. Meant to be run
 * under the thread sanitizer too. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "fill_shapes.h"

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

  j->st = vg_fill(j->surface, j->sizing, &options, &j->mesh, &j->report,
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

/* Two different voids, each with a field of its own. */
static void two_voids_at_once(void **state)
{
  const double centre[3] = { 0.1, -0.2, 0 };
  struct vg_mesh s[2] = { VG_MESH_INIT, VG_MESH_INIT };
  struct vg_sizing *sizing[2];
  struct job alone[2], together[2];

  (void)state;
  memset(alone, 0, sizeof alone);
  shape_torus(&s[0], 36, 14, 1, 0.35);
  shape_box(&s[1], 5, 4);
  shape_sphere(&s[1], 8, centre, 1, 7);
  for (int i = 0; i < 2; i++) {
    sizing[i] = shape_sizing(&s[i], 1.3, 0);
    alone[i].surface = &s[i];
    alone[i].sizing = sizing[i];
  }
  memcpy(together, alone, sizeof together);
  run_alone(alone, 2);
  run_together(together, 2);
  for (int i = 0; i < 2; i++) {
    same_mesh(&alone[i], &together[i]);
    vg_mesh_release(&alone[i].mesh);
    vg_mesh_release(&together[i].mesh);
    vg_sizing_free(sizing[i]);
    vg_mesh_release(&s[i]);
  }
}

/* Four fills of one surface that share one field. */
static void a_field_is_shared(void **state)
{
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_sizing *sizing;
  struct job job[4], alone;

  (void)state;
  shape_box(&s, 7, 0.5);
  sizing = shape_sizing(&s, 1.2, 0.1);
  memset(&alone, 0, sizeof alone);
  alone.surface = &s;
  alone.sizing = sizing;
  for (int i = 0; i < 4; i++) job[i] = alone;
  run_alone(&alone, 1);
  run_together(job, 4);
  for (int i = 0; i < 4; i++) {
    same_mesh(&alone, &job[i]);
    vg_mesh_release(&job[i].mesh);
  }
  vg_mesh_release(&alone.mesh);
  vg_sizing_free(sizing);
  vg_mesh_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(two_voids_at_once),
    cmocka_unit_test(a_field_is_shared),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
