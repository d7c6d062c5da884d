/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Helper programs that are missing, foreign, damaged, that crash and that hang:
 * each is refused or ended with its reason, and the tests go on. The helpers
 * here are shell scripts; cli/cases/helpers.sh uses the real ones. */
#define _GNU_SOURCE
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/helper/helper.h"
#include "base/parallel.h"
#include "core/recover/cdt_tetgen.h"

#define FOLDER VG_TMP_DIR "/helpers of a test"
#define PROGRAM FOLDER "/vanguard-tetgen"

static const double points[4][3] = {
  { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
};
static const uint32_t triangle[1][3] = { { 0, 1, 2 } };

/* --- helpers -------------------------------------------------------------- */

static void put_file(const char *path, const void *data, size_t size, int mode)
{
  FILE *to = fopen(path, "w");

  assert_non_null(to);
  assert_int_equal(fwrite(data, 1, size, to), size);
  assert_int_equal(fclose(to), 0);
  assert_int_equal(chmod(path, (mode_t)mode), 0);
}

/* A helper that counts its starts, sends `size` bytes and runs `then`. */
static void put_helper(const void *first, size_t size, const char *then)
{
  char script[4096];

  mkdir(FOLDER, 0755);
  put_file(FOLDER "/bytes", first, size, 0644);
  snprintf(script, sizeof script,
           "#!/bin/sh\nprintf x >>'%s/starts'\ncat '%s/bytes'\n%s\n", FOLDER,
           FOLDER, then);
  unlink(FOLDER "/starts");
  put_file(PROGRAM, script, strlen(script), 0755);
  vg_helper_set_folder("");
  vg_helper_set_folder(FOLDER);
}

static struct vg_helper_hello hello(void)
{
  struct vg_helper_hello h = { .order = VG_HELPER_ORDER,
                               .format = VG_HELPER_FORMAT,
                               .name = "vanguard-tetgen",
                               .library = "Script 1",
                               .source = "0123456789abcdef" };

  memcpy(h.magic, VG_HELPER_MAGIC, sizeof h.magic);
  return h;
}

static void refused(const char *reason)
{
  struct vg_helper h;

  vg_helper_find(VG_HELPER_TETGEN, &h);
  assert_false(h.is_found);
  assert_string_equal(h.identity, "none");
  assert_true(h.is_unusable == !strstr(reason, "is not in the folder"));
  if (!strstr(h.why, reason)) fail_msg("'%s' lacks '%s'", h.why, reason);
}

/* The status of a job that the helper gets. */
static vg_status job_status(vg_status expected)
{
  struct vg_cdt_job job = { .n = 4, .n_tri = 1, .x = points, .tri = triangle };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_cdt_tetgen(1, &job, &err);

  if (st != expected) fail_msg("status %d: %s", st, err.text);
  free(job.all);
  free(job.tet);
  return job.st;
}

/* --- tests ---------------------------------------------------------------- */

static void missing(void **state)
{
  (void)state;
  vg_helper_set_folder(VG_TMP_DIR "/no such folder");
  refused("is not in the folder");
  assert_int_equal(job_status(VG_BLOCKED), VG_ERR_GEOMETRY);
}

static void foreign(void **state)
{
  struct vg_helper_hello h = hello();

  (void)state;
  put_helper("hello, world", 12, "");
  refused("it ended when it was started");
  h.magic[0] = 'X';
  put_helper(&h, sizeof h, "");
  refused("not a helper program of Vanguard");
  h = hello();
  h.order = 0x04030201;
  put_helper(&h, sizeof h, "");
  refused("byte order");
  h = hello();
  h.format++;
  put_helper(&h, sizeof h, "");
  refused("another version of the message format");
  h = hello();
  snprintf(h.name, sizeof h.name, "vanguard-wrap");
  put_helper(&h, sizeof h, "");
  refused("another helper program");
  h = hello();
  memset(h.library, 'x', sizeof h.library); /* no end */
  put_helper(&h, sizeof h, "");
  refused("damaged");
}

static void not_executable(void **state)
{
  struct vg_helper_hello h = hello();
  struct vg_helper found;

  (void)state;
  put_helper(&h, sizeof h, "");
  chmod(PROGRAM, 0644);
  if (!access(PROGRAM, X_OK)) return; /* some systems allow it to root */
  refused("must not execute");
  assert_int_equal(job_status(VG_ERR_IO), VG_ERR_GEOMETRY);
  chmod(PROGRAM, 0755); /* the failure is not remembered */
  vg_helper_find(VG_HELPER_TETGEN, &found);
  assert_true(found.is_found);
}

static void identified(void **state)
{
  struct vg_helper_hello first = hello();
  struct vg_helper h;

  (void)state;
  put_helper(&first, sizeof first, "");
  vg_helper_find(VG_HELPER_TETGEN, &h);
  assert_true(h.is_found);
  assert_string_equal(h.path, PROGRAM);
  assert_string_equal(h.identity, "Script 1, vanguard-tetgen 0123456789abcdef, "
                                  "format 3");
}

/* A helper that is killed says nothing about the triangles. It starts for its
 * test, for the job and for the repetition of the job. */
static void killed(void **state)
{
  static const char *const end[] = { "kill -KILL $$", "kill -SEGV $$",
                                     "exit 1" };
  struct vg_helper_hello h = hello();

  (void)state;
  for (size_t i = 0; i < sizeof end / sizeof *end; i++) {
    struct stat s;

    put_helper(&h, sizeof h, end[i]);
    assert_int_equal(job_status(VG_ERR_IO), VG_ERR_GEOMETRY);
    assert_int_equal(stat(FOLDER "/starts", &s), 0);
    assert_int_equal(s.st_size, 3);
  }
}

struct reply {
  struct vg_helper_hello h;
  struct vg_helper_message m;
  uint32_t tet[4];
};

/* Only the library's failure on the triangles lets the caller go on; a crash
 * must happen twice. */
static void failures(void **state)
{
  static const struct {
    uint32_t cause;
    vg_status expected;
  } row[] = {
    { VG_HELPER_CRASHED, VG_OK },
    { VG_HELPER_NO_MEMORY, VG_ERR_MEMORY },
    { VG_HELPER_TIME, VG_ERR_IO },
  };
  struct reply all = { .h = hello(), .m = { .what = VG_HELPER_NONE } };

  (void)state;
  put_helper(&all, sizeof all.h + sizeof all.m, "");
  assert_int_equal(job_status(VG_OK), VG_ERR_GEOMETRY);
  all.m.what = VG_HELPER_FAILED;
  for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
    all.m.option = row[i].cause;
    put_helper(&all, sizeof all.h + sizeof all.m, "cat >/dev/null");
    assert_int_equal(job_status(row[i].expected), VG_ERR_GEOMETRY);
  }
}

/* The repetition of a job that got no answer has the same result. */
static void repeated(void **state)
{
  struct reply all = { .h = hello(),
                       .m = { .what = VG_HELPER_CELLS, .n = { 0, 1 } },
                       .tet = { 0, 1, 2, 3 } };
  char script[512];

  (void)state;
  snprintf(script, sizeof script,
           "[ $(wc -c <'%s/starts') = 2 ] && exit 1\n"
           "cat '%s/rest'; cat >/dev/null",
           FOLDER, FOLDER);
  put_helper(&all.h, sizeof all.h, script);
  put_file(FOLDER "/rest", &all.m, sizeof all - sizeof all.h, 0644);
  assert_int_equal(job_status(VG_OK), VG_OK);
}

static void wrong_answers(void **state)
{
  static const struct vg_helper_message wrong[] = {
    { .what = 99 },
    { .what = VG_HELPER_CELLS, .n = { UINT64_MAX, 1 } },
    { .what = VG_HELPER_CELLS, .n = { 1, 1u << 31 } }, /* and nothing more */
    { .what = VG_HELPER_CELLS, .n = { 0, 1 } },
  };
  struct reply all = { .h = hello(),
                       .tet = { 0, 1, 2, 4 } }; /* there is no point 4 */

  (void)state;
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    all.m = wrong[i];
    put_helper(&all, sizeof all, "cat >/dev/null");
    if (i == 2) put_helper(&all, sizeof all.h + sizeof all.m, "");
    assert_int_equal(job_status(i < 3 ? VG_ERR_IO : VG_OK), VG_ERR_GEOMETRY);
  }
  all.tet[3] = 3;
  put_helper(&all, sizeof all, "cat >/dev/null");
  assert_int_equal(job_status(VG_OK), VG_OK);
}

static int at_once(void *calls)
{
  return ++*(int *)calls > 2;
}

/* A helper that never answers is left after the time limit or on request. */
static void hangs(void **state)
{
  struct vg_helper_hello first = hello();
  int calls = 0;
  const struct vg_stop stop = { at_once, &calls };
  struct vg_child c;
  struct vg_link l;
  char byte;

  (void)state;
  put_helper(&first, sizeof first, "exec sleep 1000");
  assert_int_equal(vg_helper_open(VG_HELPER_TETGEN, NULL, 0.3, &c, &l, NULL),
                   VG_OK);
  assert_int_equal(vg_link_get(&l, &byte, 1), 0);
  assert_int_equal(l.state, VG_LINK_SILENT);
  vg_helper_close(&c);
  assert_int_equal(vg_helper_open(VG_HELPER_TETGEN, NULL, 60, &c, &l, NULL),
                   VG_OK);
  l.stop = &stop;
  assert_int_equal(vg_link_get(&l, &byte, 1), 0);
  assert_int_equal(l.state, VG_LINK_STOPPED);
  vg_helper_close(&c);
}

/* A mesh must not come from two helpers. */
static void replaced(void **state)
{
  struct vg_helper_hello h = hello();
  struct vg_helper found;

  (void)state;
  put_helper(&h, sizeof h, "");
  vg_helper_find(VG_HELPER_TETGEN, &found);
  assert_true(found.is_found);
  snprintf(h.source, sizeof h.source, "another");
  put_file(FOLDER "/bytes", &h, sizeof h, 0644);
  job_status(VG_ERR_IO);
  unlink(PROGRAM);
  job_status(VG_ERR_IO);
}

static void look(void *context, size_t first, size_t end, int worker)
{
  int *found = context;
  struct vg_helper h;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    vg_helper_find(VG_HELPER_TETGEN, &h);
    found[i] = h.is_found;
  }
}

enum { N_LOOK = 64 };

/* A run in another thread, which has another folder. */
static void *run_elsewhere(void *context)
{
  vg_helper_set_folder(VG_TMP_DIR "/no such folder");
  vg_parallel_for(3, N_LOOK, 1, look, context);
  return NULL;
}

/* Two runs in one process: each has its own folder, in all of its threads. */
static void each_run_has_its_folder(void **state)
{
  struct vg_helper_hello first = hello();
  int here[N_LOOK], there[N_LOOK];
  pthread_t thread;

  (void)state;
  put_helper(&first, sizeof first, "");
  assert_int_equal(pthread_create(&thread, NULL, run_elsewhere, there), 0);
  for (int k = 0; k < 20; k++) {
    vg_parallel_for(3, N_LOOK, 1, look, here);
    for (int i = 0; i < N_LOOK; i++) assert_true(here[i]);
  }
  assert_int_equal(pthread_join(thread, NULL), 0);
  for (int i = 0; i < N_LOOK; i++) assert_false(there[i]);
  vg_parallel_for(3, N_LOOK, 1, look, here);
  for (int i = 0; i < N_LOOK; i++) assert_true(here[i]);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(each_run_has_its_folder),
    cmocka_unit_test(missing),
    cmocka_unit_test(foreign),
    cmocka_unit_test(not_executable),
    cmocka_unit_test(identified),
    cmocka_unit_test(killed),
    cmocka_unit_test(failures),
    cmocka_unit_test(repeated),
    cmocka_unit_test(wrong_answers),
    cmocka_unit_test(hangs),
    cmocka_unit_test(replaced),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
