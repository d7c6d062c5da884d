/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Other meshers: their result is accepted only if it fills the front; whatever
 * they do to their process affects no other. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/child.h"
#include "core/geometry/predicates.h"
#include "core/mesher/fill_with.h"
#include "core/mesher/mesher_parts.h"
#include "fill_shapes.h"
#include "fill_support.h"
#include "parts_support.h"

static struct vg_sizing *sizing;
static struct vg_mesh surface[2];
static struct vg_front box, hollow; /* a box; one around a sphere */

static int set_up(void **state)
{
  static const double centre[3] = { 0.1, 0, -0.2 };

  (void)state;
  for (int i = 0; i < 2; i++) shape_box(&surface[i], 4, 3);
  shape_sphere(&surface[1], 6, centre, 1, 40);
  sizing = shape_sizing(&surface[1], 1.2, 0);
  box = vg_front_of(&surface[0]);
  hollow = vg_front_of(&surface[1]);
  return 0;
}

static int tear_down(void **state)
{
  (void)state;
  for (int i = 0; i < 2; i++) vg_mesh_release(&surface[i]);
  vg_sizing_free(sizing);
  return 0;
}

static const char *plugin(const char *name)
{
  static char path[4096];

  snprintf(path, sizeof path, "%s/mesher_%s.so", VG_TMP_DIR, name);
  return path;
}

static const char *bad(int number)
{
  char name[32];

  snprintf(name, sizeof name, "bad_%d", number);
  return plugin(name);
}

static struct vg_mesher_pool *open_mesher(const char *name)
{
  struct vg_mesher_pool *p = NULL;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_mesher_open(name, &p, &err) != VG_OK) fail_msg("%s", err.text);
  return p;
}

/* A result is returned only with VG_OK. */
static vg_status fill(struct vg_mesher_pool *p, const struct vg_front *front,
                      const struct vg_fill_options *o, struct vg_filled *out,
                      struct vg_fill_report *r)
{
  const struct vg_fill_options plain = VG_FILL_OPTIONS_INIT;
  const struct vg_filled empty = VG_FILLED_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  *out = empty;
  st = vg_mesher_fill(p, front, sizing, o ? o : &plain, out, r, &err);
  if (st != VG_OK) assert_memory_equal(out, &empty, sizeof empty);
  return st;
}

/* --- the check ----------------------------------------------------------- */

struct sample {
  size_t n_front, n, n_cell;
  double (*x)[3];
  uint32_t (*cell)[4];
};

/* The kernel's result for the hollow void. */
static void take_sample(struct sample *s)
{
  const struct vg_fill_options o = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report r = { 0 };
  struct vg_mesh m = VG_MESH_INIT;

  assert_int_equal(fill_mesh(&surface[1], sizing, &o, &m, &r, NULL), VG_OK);
  *s = (struct sample){ hollow.n_point, m.n_point, m.n_tet, m.point, m.tet };
  m.point = NULL;
  m.tet = NULL;
  vg_mesh_release(&m);
}

static const char *check(struct sample *s)
{
  const char *wrong;
  vg_status st = vg_mesher_check(s->n_front, hollow.n_face,
                                 (const uint32_t(*)[3])hollow.face, &s->n, s->x,
                                 s->n_cell, s->cell, &wrong, NULL);

  assert_int_equal(st, wrong ? VG_NOT_BETTER : VG_OK);
  return wrong;
}

static void accepts_cells_that_fill_the_front(void **state)
{
  struct sample s;
  size_t n;

  (void)state;
  take_sample(&s);
  n = s.n;
  for (size_t c = 0; c < s.n_cell; c += 3) { /* reversed */
    uint32_t t = s.cell[c][1];

    s.cell[c][1] = s.cell[c][2];
    s.cell[c][2] = t;
  }
  assert_null(check(&s));
  for (size_t c = 0; c < s.n_cell; c++)
    assert_true(vg_orient3d(s.x[s.cell[c][0]], s.x[s.cell[c][1]],
                            s.x[s.cell[c][2]], s.x[s.cell[c][3]]) > 0);
  /* an unused point is removed */
  for (size_t c = 0; c < s.n_cell; c++)
    for (int k = 0; k < 4; k++) s.cell[c][k] += s.cell[c][k] >= s.n_front;
  s.x = realloc(s.x, (n + 1) * sizeof *s.x);
  memmove(s.x + s.n_front + 1, s.x + s.n_front, (n - s.n_front) * sizeof *s.x);
  s.n = n + 1;
  assert_null(check(&s));
  assert_int_equal(s.n, n);
  free(s.x);
  free(s.cell);
}

/* One cell of a good sample changed in one way. */
static void refuses_damaged_samples(void **state)
{
  static const char *const words[] = { "face to face", "not finite",
                                       "does not exist", "flat" };

  (void)state;
  for (int way = 0; way < 6; way++) {
    struct sample s;
    const char *wrong;

    take_sample(&s);
    if (way == 0) s.n_cell--;
    if (way == 1) s.x[s.n - 1][0] = INFINITY;
    if (way == 2) s.cell[5][1] = (uint32_t)s.n;
    if (way == 3) s.cell[5][1] = s.cell[5][0];
    /* inverted cells are reversed, and are then on the wrong side of a face */
    if (way == 4) s.x[s.n - 1][0] += 0.7;
    if (way == 5) s.n_cell = 0;
    wrong = check(&s);
    assert_non_null(wrong);
    if (way < 4) assert_non_null(strstr(wrong, words[way]));
    free(s.x);
    free(s.cell);
  }
}

/* A front as a tetrahedron filled from outside: all faces match. */
static void refuses_cells_outside_the_front(void **state)
{
  static const uint32_t face[4][3] = {
    { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 }
  };
  double x[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  uint32_t cell[1][4] = { { 0, 1, 2, 3 } };
  const char *wrong;
  size_t n = 4;

  (void)state;
  assert_int_equal(vg_mesher_check(4, 4, face, &n, x, 1, cell, &wrong, NULL),
                   VG_NOT_BETTER);
  assert_non_null(strstr(wrong, "outside"));
}

/* --- meshers ------------------------------------------------------------- */

static void the_example_fills_a_box(void **state)
{
  struct vg_mesher_pool *p = open_mesher(plugin("star"));
  struct vg_fill_report r = { 0 };
  struct vg_filled f;

  (void)state;
  for (int k = 0; k < 3; k++) { /* the process is used again */
    assert_int_equal(fill(p, &box, NULL, &f, &r), VG_OK);
    assert_int_equal(f.n_cell, box.n_face);
    assert_int_equal(f.n_point, 1);
    assert_int_equal(f.n_face + f.n_consumed, 0);
    assert_int_equal(vg_filled_defects(&box, &f, 0), 0);
    assert_int_equal(r.n_other, k + 1);
    vg_filled_release(&f);
  }
  /* and reports where it cannot fill */
  assert_int_equal(fill(p, &hollow, NULL, &f, &r), VG_NOT_BETTER);
  assert_int_equal(r.n_other_failed, 1);
  vg_mesher_close(p);
}

/* A mesher that uses sizes makes half to twice the cells of the kernel, and the
 * same cells each time. */
static void fills_by_size(const char *name)
{
  struct vg_mesher_pool *p = open_mesher(name);
  struct vg_fill_report r = { 0 };
  struct vg_filled f, again;
  struct sample s;

  take_sample(&s);
  assert_int_equal(fill(p, &hollow, NULL, &f, &r), VG_OK);
  assert_int_equal(r.n_other_cell, f.n_cell);
  assert_int_equal(vg_filled_defects(&hollow, &f, 0), 0);
  assert_true(f.n_cell > s.n_cell / 2 && f.n_cell < 2 * s.n_cell);
  assert_int_equal(fill(p, &hollow, NULL, &again, &r), VG_OK);
  assert_int_equal(f.n_cell, again.n_cell);
  assert_int_equal(f.n_point, again.n_point);
  assert_memory_equal(f.cell, again.cell, f.n_cell * sizeof *f.cell);
  assert_memory_equal(f.x, again.x, f.n_point * sizeof *f.x);
  vg_filled_release(&f);
  vg_filled_release(&again);
  free(s.x);
  free(s.cell);
  vg_mesher_close(p);
}

static void tetgen_fills_around_a_hollow(void **state)
{
  (void)state;
  needs_tetgen();
  fills_by_size("tetgen");
}

/* gmsh's library does not work together with ASan, whose allocator it would
 * use: its voids are filled by the kernel. */
static void hxt_works_where_available(void **state)
{
  struct vg_mesher_pool *p = NULL;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
#ifdef __SANITIZE_ADDRESS__
  skip();
#endif
  if (vg_mesher_open("hxt", &p, &err) != VG_OK) {
    assert_int_equal(err.code, VG_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "libgmsh"));
    skip();
  }
  vg_mesher_close(p);
  fills_by_size("hxt");
}

/* Two boxes that share an edge, and one box inside another: components of a
 * void are distinguished by the space between two triangles. */
static void tells_shells_that_touch(void **state)
{
  static const uint32_t tet[4][3] = {
    { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 }
  };
  double x[6][3] = { { 0, 0, 0 }, { 1, 0, 0 },  { 0, 1, 0 },
                     { 0, 0, 1 }, { 0, -1, 0 }, { 0, 0, -1 } };
  uint32_t face[8][3];
  struct vg_mesher_front f = { 6, 8, (const double(*)[3])x,
                               (const uint32_t(*)[3])face };
  static const uint32_t name[2][4] = { { 0, 1, 2, 3 }, { 0, 1, 4, 5 } };
  struct vg_mesher_shells s;

  (void)state;
  for (int i = 0; i < 8; i++) /* into the tetrahedra */
    for (int k = 0; k < 3; k++) face[i][k] = name[i / 4][tet[i % 4][2 - k]];
  assert_int_equal(vg_mesher_find_shells(&f, &s), 0);
  assert_int_equal(s.n, 2);
  assert_int_equal(s.n_hollow, 0);
  assert_int_equal(s.n_piece, 2);
  for (int i = 0; i < 8; i++) assert_int_equal(s.of[i], i / 4);
  vg_mesher_shells_release(&s);
  for (int i = 0; i < 8; i++) { /* out of them: they are the hollows */
    uint32_t t = face[i][0];

    face[i][0] = face[i][1];
    face[i][1] = t;
  }
  assert_int_equal(vg_mesher_find_shells(&f, &s), 0);
  assert_int_equal(s.n, 1);
  assert_int_equal(s.n_piece, 2);
  assert_int_equal(s.n_hollow, 1);
  vg_mesher_shells_release(&s);
}

/* --- faulty ones --------------------------------------------------------- */

static void refuses_files_that_are_not_plugins(void **state)
{
  static const struct {
    int number;
    const char *word;
  } row[] = {
    { 1, "vg_mesher_plugin" },  { 2, "version 2" },         { 3, "ended" },
    { 4, "returns no mesher" }, { 99, "cannot be loaded" },
  };
  struct vg_mesher_pool *p = NULL;

  (void)state;
  for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(vg_mesher_open(bad(row[i].number), &p, &err),
                     VG_ERR_UNSUPPORTED);
    if (!strstr(err.text, row[i].word)) fail_msg("%s", err.text);
    if (!strstr(err.text, bad(row[i].number))) fail_msg("%s", err.text);
    assert_null(p);
  }
}

/* The kernel fills a void if the mesher crashes (5) or returns a wrong result.
 * A mesher that ends, hangs or sleeps (6 to 8) has not answered. */
static void stops_using_plugins_that_fail(void **state)
{
  (void)state;
  for (int k = 5; k <= 15; k++) {
    const int is_lost = k >= 6 && k <= 8;
    struct vg_mesher_pool *p = open_mesher(bad(k));
    struct vg_fill_report r = { 0 };
    struct vg_filled f;

    vg_mesher_set_time_limit(p, 0.05, 0);
    for (int again = 0; again < 2; again++)
      assert_int_equal(fill(p, &box, NULL, &f, &r),
                       is_lost ? VG_ERR_IO : VG_NOT_BETTER);
    assert_int_equal(r.n_other_ended, k == 5 ? 2 : 0);
    assert_int_equal(r.n_other_wrong, k == 5 || is_lost ? 0 : 2);
    assert_int_equal(r.n_other, 0);
    vg_mesher_close(p);
  }
}

static int at_once(void *user)
{
  (void)user;
  return 1;
}

static void stops_and_keeps_limits(void **state)
{
  struct vg_mesher_pool *p;
  struct vg_fill_options o = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report r = { 0 };
  struct vg_filled f;

  (void)state;
  needs_tetgen();
  p = open_mesher(bad(8)); /* sleeps */
  o.stop.ask = at_once;
  assert_int_equal(fill(p, &box, &o, &f, &r), VG_ERR_STOPPED);
  vg_mesher_close(p);
  p = open_mesher("tetgen");
  o.stop.ask = NULL;
  o.point_limit = 3;
  assert_int_equal(fill(p, &hollow, &o, &f, &r), VG_ERR_UNSUPPORTED);
  vg_mesher_close(p);
}

/* --- sizes across a socket ----------------------------------------------- */

static void *answer(void *fd)
{
  struct vg_helper_message w;

  while (vg_child_get(*(int *)fd, &w, sizeof w)) {
    size_t n = w.n[0];
    double(*x)[3] = malloc(n * sizeof *x), *h = malloc(n * sizeof *h);

    assert_int_equal(w.what, VG_HELPER_SIZES);
    vg_child_get(*(int *)fd, x, n * sizeof *x);
    vg_sizing_eval(sizing, n, (const double(*)[3])x, h);
    w.what = VG_HELPER_LENGTHS;
    vg_child_put(*(int *)fd, &w, sizeof w);
    vg_child_put(*(int *)fd, h, n * sizeof *h);
    free(x);
    free(h);
  }
  return NULL;
}

/* The gradient is 0.2, and corners are one spacing apart. There a size that is
 * linear except at creases has an error of a few per cent. */
static void sizes_are_those_of_the_field(void **state)
{
  const struct vg_mesher_front f = { hollow.n_point, hollow.n_face,
                                     (const double(*)[3])hollow.x,
                                     (const uint32_t(*)[3])hollow.face };
  struct vg_child_sizes *s;
  pthread_t thread;
  uint32_t seed = 1;
  int ends[2];

  (void)state;
  assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  assert_int_equal(pthread_create(&thread, NULL, answer, &ends[1]), 0);
  s = vg_child_sizes_new(ends[0], ends[0], &f);
  assert_non_null(s);
  for (int i = 0; i < 5000; i++) {
    double x[1][3], h, want;

    for (int k = 0; k < 3; k++) {
      seed = seed * 1664525 + 1013904223;
      x[0][k] = 6 * (seed >> 8) / 16777216.0 - 3;
    }
    vg_child_sizes_at(s, 1, (const double(*)[3])x, &h);
    want = vg_sizing_at(sizing, x[0]);
    if (!(fabs(h - want) < 0.12 * want)) fail_msg("%g for %g", h, want);
  }
  shutdown(ends[0], SHUT_RDWR);
  pthread_join(thread, NULL);
  close(ends[0]);
  close(ends[1]);
  vg_child_sizes_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(accepts_cells_that_fill_the_front),
    cmocka_unit_test(refuses_damaged_samples),
    cmocka_unit_test(refuses_cells_outside_the_front),
    cmocka_unit_test(the_example_fills_a_box),
    cmocka_unit_test(tetgen_fills_around_a_hollow),
    cmocka_unit_test(hxt_works_where_available),
    cmocka_unit_test(tells_shells_that_touch),
    cmocka_unit_test(refuses_files_that_are_not_plugins),
    cmocka_unit_test(stops_using_plugins_that_fail),
    cmocka_unit_test(stops_and_keeps_limits),
    cmocka_unit_test(sizes_are_those_of_the_field),
  };
  int bad_tests;

  if (vg_child_server_start(NULL) < 0) return 1;
  bad_tests = cmocka_run_group_tests(tests, set_up, tear_down);
  vg_child_server_stop();
  return bad_tests;
}
