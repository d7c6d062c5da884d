/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks of stages: which states are defects, and how a program ends that has
 * one. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/checks.h"
#include "core/mesh/mesh_defects.h"
#include "tets_support.h"

/* Run `body` in a child process. Returns its signal; text [n] receives its
 * standard error. */
static int signal_of(void (*body)(void), char *text, size_t n)
{
  int end[2], status;
  size_t got = 0;
  ssize_t more;
  pid_t pid;

  assert_int_equal(pipe(end), 0);
  fflush(NULL);
  pid = fork();
  assert_true(pid >= 0);
  if (!pid) {
    signal(SIGABRT, SIG_DFL);
    dup2(end[1], STDERR_FILENO);
    close(end[0]);
    close(end[1]);
    body();
    _exit(0);
  }
  close(end[1]);
  while (got + 1 < n && (more = read(end[0], text + got, n - got - 1)) > 0)
    got += (size_t)more;
  text[got] = 0;
  close(end[0]);
  assert_int_equal(waitpid(pid, &status, 0), pid);
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

static void no_defects(void)
{
  vg_check_none("a stage", "count()", 0);
}

static void three_defects(void)
{
  vg_check_none("a stage", "count()", 3);
}

static void a_failed_check_names_its_stage_and_aborts(void **state)
{
  char text[512];

  (void)state;
  assert_int_equal(signal_of(no_defects, text, sizeof text), 0);
  assert_string_equal(text, "");
  assert_int_equal(signal_of(three_defects, text, sizeof text), SIGABRT);
  assert_non_null(strstr(text, "a stage"));
  assert_non_null(strstr(text, "count() is 3"));
}

/* A box of five cells whose links name a wrong neighbour. */
static void compact_damaged_cells(void)
{
  struct vg_tets t = VG_TETS_INIT;

  tets_box(&t, 0, 1);
  for (int i = 0; i < 4; i++) t.cell[4].link[i] ^= 1;
  vg_tets_compact(&t, t.n_point, NULL);
  vg_tets_release(&t);
}

static void a_stage_checks_its_result(void **state)
{
  char text[512];

  (void)state;
  assert_int_equal(signal_of(compact_damaged_cells, text, sizeof text),
                   VG_CHECKS_ON ? SIGABRT : 0);
  if (VG_CHECKS_ON) assert_non_null(strstr(text, "the insertion of points"));
}

static void inverted_cells_are_counted(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  uint32_t v;

  (void)state;
  tets_box(&t, 0, 1);
  assert_int_equal(vg_tets_inverted(&t), 0);
  v = t.cell[2].v[0];
  t.cell[2].v[0] = t.cell[2].v[1];
  t.cell[2].v[1] = v;
  assert_int_equal(vg_tets_inverted(&t), 1);
  t.flag[2] |= VG_DEAD;
  assert_int_equal(vg_tets_inverted(&t), 0);
  vg_tets_release(&t);
}

/* --- boundary faces ------------------------------------------------------ */

/* The surfaces of a tetrahedron and of a pyramid. */
static void open_edges_are_counted(void **state)
{
  double point[5][3] = { { 0 } };
  uint32_t tri[4][3] = { { 0, 2, 1 }, { 0, 1, 3 }, { 1, 2, 3 }, { 2, 0, 3 } };
  uint32_t side[4][3] = { { 0, 1, 4 }, { 1, 2, 4 }, { 2, 3, 4 }, { 3, 0, 4 } };
  uint32_t quad[1][4] = { { 0, 3, 2, 1 } };
  struct vg_mesh m = { .n_point = 4, .n_tri = 4, .point = point, .tri = tri };

  (void)state;
  assert_int_equal(vg_mesh_open_edges(&m), 0);
  m.n_tri = 3;
  assert_int_equal(vg_mesh_open_edges(&m), 3);
  m.n_tri = 4;
  tri[3][0] = 0;
  tri[3][1] = 2; /* reversed */
  assert_int_equal(vg_mesh_open_edges(&m), 3);
  m = (struct vg_mesh){ .n_point = 5,
                        .n_tri = 4,
                        .n_quad = 1,
                        .point = point,
                        .tri = side,
                        .quad = quad };
  assert_int_equal(vg_mesh_open_edges(&m), 0);
  m.n_quad = 0;
  assert_int_equal(vg_mesh_open_edges(&m), 4);
}

static void nodes_and_patches_out_of_range_are_counted(void **state)
{
  uint32_t tri[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } }, patch[2] = { 0, 0 };
  struct vg_mesh m = {
    .n_point = 4, .n_tri = 2, .tri = tri, .tri_patch = patch, .n_patch = 1
  };

  (void)state;
  assert_int_equal(vg_mesh_bad_faces(&m), 0);
  tri[1][2] = 4;
  assert_int_equal(vg_mesh_bad_faces(&m), 1);
  patch[0] = 1;
  assert_int_equal(vg_mesh_bad_faces(&m), 2);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_failed_check_names_its_stage_and_aborts),
    cmocka_unit_test(a_stage_checks_its_result),
    cmocka_unit_test(inverted_cells_are_counted),
    cmocka_unit_test(open_edges_are_counted),
    cmocka_unit_test(nodes_and_patches_out_of_range_are_counted),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
