/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/http: each call for files and memory of an upload fails once. A file is
 * there with all its bytes and was reported, or it is absent; the folder has no
 * other files afterwards. The linker replaces the calls. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
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

#include "cli/http/inside.h"
#include "cli/http/upload.h"

#define ROOT VG_TMP_DIR "/uploads"

/* --- calls that fail ------------------------------------------------------ */

enum { HALF = 0, NONE = -1 };

static struct {
  long n, at;      /* calls so far; the call that fails, from 1, or 0 */
  int error;       /* errno; of a write: HALF of the bytes, or NONE */
  int no_exchange; /* 1: a file system without RENAME_NOREPLACE */
} faults;

static int fails(void)
{
  if (++faults.n != faults.at) return 0;
  errno = faults.error > 0 ? faults.error : EIO;
  return 1;
}

#include "failing_calls.h"

FAILS(char *, strdup, (const char *text), (text), NULL)
FAILS(char *, realpath, (const char *path, char *real), (path, real), NULL)
FAILS(int, mkostemp, (char *path, int flags), (path, flags), -1)
FAILS(int, fchmod, (int fd, mode_t mode), (fd, mode), -1)
FAILS(int, fsync, (int fd), (fd), -1)
FAILS(int, link, (const char *a, const char *b), (a, b), -1)
FAILS(ssize_t, write, (int fd, const void *data, size_t n), (fd, data, n),
      (faults.error == NONE   ? 0
       : faults.error == HALF ? __real_write(fd, data, n / 2)
                              : -1))

int __real_close(int fd);
int __wrap_close(int fd);
int __wrap_close(int fd)
{
  int fault = fails(), error = errno, result = __real_close(fd);

  errno = error;
  return fault ? -1 : result;
}

int __real_renameat2(int da, const char *a, int db, const char *b,
                     unsigned how);
int __wrap_renameat2(int da, const char *a, int db, const char *b,
                     unsigned how);
int __wrap_renameat2(int da, const char *a, int db, const char *b, unsigned how)
{
  if (fails()) return -1;
  errno = EINVAL;
  return faults.no_exchange ? -1 : __real_renameat2(da, a, db, b, how);
}

int __wrap_asprintf(char **text, const char *format, ...);
int __wrap_asprintf(char **text, const char *format, ...)
{
  va_list args;
  int n;

  if (fails()) return -1;
  va_start(args, format);
  n = vasprintf(text, format, args);
  va_end(args);
  return n;
}

/* --- two uploads ---------------------------------------------------------- */

static const char *const name[2] = { "first.stl", "second.stl" };
static const char text[] = "solid with all its bytes";

/* The number of files that have a name of ours; all are whole. */
static int count_files(void)
{
  DIR *d = opendir(ROOT);
  const struct dirent *e;
  int n = 0;

  assert_non_null(d);
  while ((e = readdir(d))) {
    char path[600], bytes[100];
    FILE *f;

    if (!strcmp(e->d_name, ".") || !strcmp(e->d_name, "..")) continue;
    if (strcmp(e->d_name, name[0]) && strcmp(e->d_name, name[1]))
      fail_msg("%s is left (call %ld)", e->d_name, faults.at);
    snprintf(path, sizeof path, ROOT "/%s", e->d_name);
    f = fopen(path, "r");
    assert_non_null(f);
    assert_int_equal(fread(bytes, 1, sizeof bytes, f), sizeof text);
    assert_memory_equal(bytes, text, sizeof text);
    fclose(f);
    n++;
  }
  closedir(d);
  return n;
}

static void clean(void)
{
  mkdir(ROOT, 0777);
  for (int k = 0; k < 2; k++) {
    char path[600];

    snprintf(path, sizeof path, ROOT "/%s", name[k]);
    unlink(path);
  }
}

static vg_status upload(struct vg_upload *u, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (int k = 0; k < 2 && st >= 0; k++) {
    st = vg_upload_begin(u, ROOT, "", name[k], err);
    if (st >= 0) st = vg_upload_put(u, text, 10, 1000, err);
    if (st >= 0) st = vg_upload_put(u, text + 10, sizeof text - 10, 1000, err);
  }
  return st < 0 ? st : vg_upload_commit(u, err);
}

static void every_call_fails(void **state)
{
  static const int error[] = { EIO, EINTR, EEXIST, HALF, NONE };

  (void)state;
  for (int k = 0; k < 10; k++) {
    long n = 0;

    memset(&faults, 0, sizeof faults);
    faults.no_exchange = k % 2;
    faults.error = error[k / 2];
    for (faults.at = 0; faults.at <= n; faults.at++) {
      struct vg_upload u = VG_UPLOAD_INIT;
      struct vg_error err = VG_ERROR_INIT;
      int n_whole;
      vg_status st;

      clean();
      faults.n = 0;
      st = upload(&u, &err);
      if (faults.n > n) n = faults.n;
      if (st < 0) assert_true(*err.text);
      assert_int_equal(st < 0, u.n_whole < 2);
      if (!faults.at) assert_int_equal(st, VG_OK);
      n_whole = u.n_whole;
      vg_upload_release(&u);
      assert_int_equal(count_files(), n_whole);
    }
    assert_true(n > 20);
  }
  memset(&faults, 0, sizeof faults);
  clean();
}

/* --- refusals ------------------------------------------------------------- */

static void a_name_that_is_taken(void **state)
{
  (void)state;
  for (faults.no_exchange = 0; faults.no_exchange < 2; faults.no_exchange++)
    for (int later = 0; later < 2; later++) {
      struct vg_upload u = VG_UPLOAD_INIT;
      struct vg_error err = VG_ERROR_INIT;
      FILE *f;
      vg_status st = VG_OK;

      clean();
      if (later) st = vg_upload_begin(&u, ROOT, "", name[0], &err);
      assert_int_equal(st, VG_OK);
      f = fopen(ROOT "/first.stl", "w");
      assert_non_null(f);
      fwrite(text, 1, sizeof text, f);
      fclose(f);
      st = later ? vg_upload_commit(&u, &err)
                 : vg_upload_begin(&u, ROOT, "", name[0], &err);
      assert_int_equal(st, VG_ERR_INPUT);
      assert_non_null(strstr(err.text, "already exists"));
      vg_upload_release(&u);
      assert_int_equal(count_files(), 1);
    }
  clean();
  faults.no_exchange = 0;
}

static void too_many_bytes(void **state)
{
  struct vg_upload u = VG_UPLOAD_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  clean();
  assert_int_equal(vg_upload_begin(&u, ROOT, "", name[0], &err), VG_OK);
  assert_int_equal(vg_upload_put(&u, text, 10, 9, &err), VG_ERR_INPUT);
  assert_int_equal(vg_upload_put(&u, text, 10, 15, &err), VG_OK);
  assert_int_equal(vg_upload_put(&u, text, 10, 15, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "15 bytes"));
  vg_upload_release(&u);
  assert_int_equal(count_files(), 0);
  assert_int_equal(vg_upload_commit(&u, &err), VG_OK); /* none is open */
}

static void names_and_paths(void **state)
{
  static char long_name[202];
  static const char *const bad[] = { "..",   ".",   "a//b", "/a",  "a/..",
                                     "a/./", "a\n", "\x7f", "\xff" };
  static const char *const wrong[] = { "",     ".a", "-a",   "a/b",
                                       "a\\b", "\n", "\xff", long_name };
  static const char *const absent[] = { "ab", "a/bc", "..a", ".a" };
  struct vg_upload u = VG_UPLOAD_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char *real = NULL;

  (void)state;
  clean();
  memset(long_name, 'a', 201);
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
    assert_int_equal(vg_upload_begin(&u, ROOT, "", wrong[i], &err),
                     VG_ERR_INPUT);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    assert_int_equal(vg_inside(ROOT, bad[i], &real, &err), VG_ERR_INPUT);
  for (size_t i = 0; i < sizeof absent / sizeof *absent; i++)
    assert_int_equal(vg_inside(ROOT, absent[i], &real, &err), VG_ERR_IO);
  assert_int_equal(symlink("/", ROOT "/out"), 0);
  assert_int_equal(vg_inside(ROOT, "out", &real, &err), VG_ERR_INPUT);
  unlink(ROOT "/out");
  assert_null(real);
  assert_false(vg_inside_holds("/", "a"));
  assert_true(vg_inside_holds("/", "/a"));
  assert_true(vg_inside_holds("/a", "/a"));
  assert_false(vg_inside_holds("/a", "/ab"));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_call_fails),
    cmocka_unit_test(a_name_that_is_taken),
    cmocka_unit_test(too_many_bytes),
    cmocka_unit_test(names_and_paths),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
