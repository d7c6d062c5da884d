/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Runs of the library that are stopped while they read CAD, mesh and write: no
 * later phase begins, and no file is left. */
#define _GNU_SOURCE
#include <dirent.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <cmocka.h>

#include "api/vanguard.h"

#define FOLDER VG_TMP_DIR "/stopped"

/* --- a box ---------------------------------------------------------------- */

enum { SIDE = 6, N_TRI = 12 * SIDE * SIDE };

static double x[8 * N_TRI][3];
static uint32_t tri[N_TRI][3];
static size_t n_point;

static uint32_t point_of(const double at[3])
{
  for (size_t i = 0; i < n_point; i++)
    if (!memcmp(x[i], at, sizeof x[i])) return (uint32_t)i;
  memcpy(x[n_point], at, sizeof *x);
  return (uint32_t)n_point++;
}

/* Normals point in: the box is the domain. */
static void make_box(void)
{
  size_t n = 0;

  for (int face = 0; face < 6; face++)
    for (int i = 0; i < SIDE * SIDE; i++) {
      int a = face / 2, b = (a + 1) % 3, d = (a + 2) % 3, flip = face % 2;
      uint32_t p[4];

      for (int k = 0; k < 4; k++) {
        double at[3];

        at[a] = flip;
        at[b] = (i % SIDE + (k == 1 || k == 2)) / (double)SIDE;
        at[d] = (i / SIDE + (k > 1)) / (double)SIDE;
        p[k] = point_of(at);
      }
      for (int h = 0; h < 2; h++, n++) {
        tri[n][0] = p[0];
        tri[n][1] = p[1 + h + flip];
        tri[n][2] = p[2 + h - flip];
      }
    }
}

static vanguard_job *new_box(void)
{
  vanguard_job *job;

  assert_int_equal(vanguard_new(VANGUARD_ABI, &job), 0);
  assert_int_equal(vanguard_surface(job, "box", n_point, x[0], N_TRI, tri[0],
                                    NULL),
                   0);
  assert_int_equal(vanguard_set(job, "hmax", "0.03"), 0);
  return job;
}

/* As vanguard_mesh; skips the test in a build without TetGen, which recovers
 * two triangles of the box, and frees the job then. */
static vanguard_status mesh(vanguard_job *job, vanguard_progress *progress,
                            void *user)
{
  vanguard_status st = vanguard_mesh(job, progress, user);

  if (st == VANGUARD_ERR_GEOMETRY &&
      strstr(vanguard_message(job), "vanguard-tetgen")) {
    vanguard_free(job);
    skip();
  }
  return st;
}

/* --- while a phase runs --------------------------------------------------- */

struct watch {
  const char *stop_at;
  int is_asked, n_later;
};

static int stop_at(void *user, const char *phase, uint64_t done,
                   uint64_t expected)
{
  struct watch *w = user;

  (void)done, (void)expected;
  if (!strcmp(phase, w->stop_at)) w->is_asked = 1;
  else if (w->is_asked) w->n_later++;
  return w->is_asked;
}

static void it_stops_in_every_phase(void **state)
{
  static const char *const phase[] = { "read", "surface check", "sizing field",
                                       "fill", "numbering",     "mesh check" };
  vanguard_job *job = new_box();

  (void)state;
  for (size_t i = 0; i < sizeof phase / sizeof *phase; i++) {
    struct watch w = { .stop_at = phase[i] };

    assert_int_equal(mesh(job, stop_at, &w), VANGUARD_ERR_STOPPED);
    assert_true(w.is_asked);
    assert_int_equal(w.n_later, 0);
  }
  vanguard_free(job);
}

static void a_forecast_stops_in_every_phase(void **state)
{
  static const char *const phase[] = { "read", "surface check", "sizing field",
                                       "forecast" };
  struct vanguard_forecast f = VANGUARD_INIT(f);
  vanguard_job *job = new_box();

  (void)state;
  for (size_t i = 0; i < sizeof phase / sizeof *phase; i++) {
    struct watch w = { .stop_at = phase[i] };

    assert_int_equal(vanguard_forecast(job, 1, 1, stop_at, &w, &f),
                     VANGUARD_ERR_STOPPED);
    assert_true(w.is_asked);
    assert_int_equal(w.n_later, 0);
    assert_true(f.n_cell == 0);
  }
  assert_int_equal(vanguard_forecast(job, 1, 1, NULL, NULL, &f), 0);
  assert_true(f.n_cell > 1000);
  vanguard_free(job);
}

/* Reading CAD is one call of another library, in a child process. */
static void it_stops_while_cad_is_read(void **state)
{
  struct watch w = { .stop_at = "read" };
  vanguard_job *job;
  vanguard_status st;

  (void)state;
  assert_int_equal(vanguard_new(VANGUARD_ABI, &job), 0);
  assert_int_equal(vanguard_open(job, VG_EXAMPLES "/wing_from_cad/wing.step",
                                 VG_EXAMPLES "/wing_from_cad/half_wing.deck"),
                   0);
  st = vanguard_mesh(job, stop_at, &w);
  if (st == VANGUARD_ERR_UNSUPPORTED) skip(); /* built without CAD */
  assert_int_equal(st, VANGUARD_ERR_STOPPED);
  assert_int_equal(w.n_later, 0);
  vanguard_free(job);
}

/* --- while files are written ---------------------------------------------- */

static vanguard_job *written;

static void on_signal(int number)
{
  (void)number;
  vanguard_cancel(written);
}

/* Number of files in the folder, which are removed if `clear`. */
static int n_files(int clear)
{
  DIR *d = opendir(FOLDER);
  struct dirent *e;
  char path[4096];
  int n = 0;

  assert_non_null(d);
  while ((e = readdir(d))) {
    if (!strcmp(e->d_name, ".") || !strcmp(e->d_name, "..")) continue;
    snprintf(path, sizeof path, "%s/%s", FOLDER, e->d_name);
    n++;
    if (clear) remove(path);
  }
  closedir(d);
  return n;
}

/* The signal comes after some milliseconds of processor time, of which the
 * files need far more. */
static void it_stops_while_files_are_written(void **state)
{
  struct itimerval soon = { { 0, 1000 }, { 0, 1000 } }, never = { 0 };
  struct sigaction a = { .sa_handler = on_signal, .sa_flags = SA_RESTART };
  vanguard_status st;

  (void)state;
  mkdir(FOLDER, 0755);
  n_files(1);
  written = new_box();
  assert_int_equal(mesh(written, NULL, NULL), 0);
  assert_int_equal(sigaction(SIGPROF, &a, NULL), 0);
  setitimer(ITIMER_PROF, &soon, NULL);
  st = vanguard_write(written, FOLDER "/box", "vtu,su2,b8.ugrid,cogsg,msh");
  setitimer(ITIMER_PROF, &never, NULL);
  assert_int_equal(st, VANGUARD_ERR_STOPPED);
  assert_int_equal(n_files(0), 0);
  assert_int_equal(vanguard_write(written, FOLDER "/box", "vtu"), 0);
  assert_true(n_files(1) > 0);
  vanguard_free(written);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(it_stops_in_every_phase),
    cmocka_unit_test(a_forecast_stops_in_every_phase),
    cmocka_unit_test(it_stops_while_cad_is_read),
    cmocka_unit_test(it_stops_while_files_are_written),
  };

  make_box();
  return cmocka_run_group_tests(tests, NULL, NULL);
}
