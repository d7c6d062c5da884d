/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Files written at arbitrary offsets, in a job of one rank. Under MPI:
 * tests/mpi/test_shared_file_mpi.c. */
#include <errno.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/memory.h"
#include "io/stream/shared_file.h"

#define NAME VG_TMP_DIR "/shared_file"

static int exists(const char *path)
{
  struct stat s;

  return !stat(path, &s);
}

static size_t contents(const char *path, unsigned char *to, size_t cap)
{
  FILE *f = fopen(path, "rb");
  size_t n;

  assert_non_null(f);
  n = fread(to, 1, cap, f);
  fclose(f);
  return n;
}

static void places_in_any_order(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;
  unsigned char got[32];

  (void)state;
  unlink(NAME);
  assert_int_equal(vg_shared_open(NULL, NAME, 11, &f, &err), VG_OK);
  assert_int_equal(vg_shared_write(f, 6, 5, "world", &err), VG_OK);
  assert_int_equal(vg_shared_write(f, 11, 0, NULL, &err), VG_OK);
  assert_int_equal(vg_shared_write(f, 0, 6, "hello ", &err), VG_OK);
  assert_false(exists(NAME));
  assert_int_equal(vg_shared_close(f, VG_OK, &err), VG_OK);
  assert_false(exists(NAME ".part"));
  assert_int_equal(contents(NAME, got, sizeof got), 11);
  assert_memory_equal(got, "hello world", 11);
  unlink(NAME);
}

static void no_bytes(void **state)
{
  struct vg_shared_file *f = NULL;
  unsigned char got[4];

  (void)state;
  assert_int_equal(vg_shared_open(NULL, NAME, 0, &f, NULL), VG_OK);
  assert_int_equal(vg_shared_close(f, VG_OK, NULL), VG_OK);
  assert_int_equal(contents(NAME, got, sizeof got), 0);
  unlink(NAME);
}

/* Content of an earlier, longer .part must not remain, and an earlier file must
 * stay until the new one is complete. */
static void takes_the_place_of_older_files(void **state)
{
  struct vg_shared_file *f = NULL;
  unsigned char got[32];
  FILE *old = fopen(NAME ".part", "wb");

  (void)state;
  fputs("a much longer file", old);
  fclose(old);
  old = fopen(NAME, "wb");
  fputs("old", old);
  fclose(old);
  assert_int_equal(vg_shared_open(NULL, NAME, 4, &f, NULL), VG_OK);
  assert_int_equal(vg_shared_write(f, 0, 4, "new!", NULL), VG_OK);
  assert_int_equal(contents(NAME, got, sizeof got), 3);
  assert_int_equal(vg_shared_close(f, VG_OK, NULL), VG_OK);
  assert_int_equal(contents(NAME, got, sizeof got), 4);
  assert_memory_equal(got, "new!", 4);
  unlink(NAME);
}

static void nothing_remains_after_a_failure(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;

  (void)state;
  assert_int_equal(vg_shared_open(NULL, NAME, 4, &f, &err), VG_OK);
  vg_fail(&err, VG_ERR_MEMORY, "no memory for walls");
  assert_int_equal(vg_shared_close(f, VG_ERR_MEMORY, &err), VG_ERR_MEMORY);
  assert_string_equal(err.text, "no memory for walls");
  assert_false(exists(NAME));
  assert_false(exists(NAME ".part"));
}

static void errors_name_file_and_reason(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;

  (void)state;
  assert_int_equal(vg_shared_open(NULL, VG_TMP_DIR "/no/folder", 4, &f, &err),
                   VG_ERR_IO);
  assert_null(f);
  assert_non_null(strstr(err.text, "/no/folder.part: "));
  assert_non_null(strstr(err.text, strerror(ENOENT)));
  assert_int_equal(vg_shared_open(NULL, NAME, UINT64_MAX, &f, &err), VG_ERR_IO);
  assert_null(f);
  assert_int_equal(vg_shared_open(NULL, NAME, 4, &f, &err), VG_OK);
  assert_int_equal(vg_shared_write(f, 2, 3, "abc", &err), VG_ERR_IO);
  assert_int_equal(vg_shared_write(f, UINT64_MAX, 2, "ab", &err), VG_ERR_IO);
  assert_non_null(strstr(err.text, "announced"));
  assert_int_equal(vg_shared_close(f, VG_ERR_IO, &err), VG_ERR_IO);
}

/* Another process truncates the file. */
static void checks_the_size(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;

  (void)state;
  assert_int_equal(vg_shared_open(NULL, NAME, 100, &f, &err), VG_OK);
  assert_int_equal(truncate(NAME ".part", 50), 0);
  assert_int_equal(vg_shared_close(f, VG_OK, &err), VG_ERR_IO);
  assert_non_null(strstr(err.text, "50 bytes instead of 100"));
  assert_false(exists(NAME));
  assert_false(exists(NAME ".part"));
}

/* The reserved space is lost and the disk is full: writing must report it. */
static vg_status write_late(void)
{
  static const char path[] = VG_TMP_DIR "/full_disk/late";
  unsigned char *data = vg_calloc(1 << 20, 1);
  struct vg_shared_file *f = NULL;
  FILE *other;
  vg_status st = vg_shared_open(NULL, path, 1 << 19, &f, NULL);

  if (st >= 0) {
    if (truncate(VG_TMP_DIR "/full_disk/late.part", 0)) perror("truncate");
    other = fopen(VG_TMP_DIR "/full_disk/other", "wb");
    fwrite(data, 1, 1 << 20, other);
    fclose(other);
    st = vg_shared_write(f, 0, 1 << 19, data, NULL);
    assert_int_equal(vg_shared_close(f, st, NULL), st);
  }
  assert_false(exists(path));
  free(data);
  return st;
}

static void a_full_disk(void **state)
{
  static const char dir[] = VG_TMP_DIR "/full_disk";
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;
  vg_status st, late;

  (void)state;
  mkdir(dir, 0777);
  if (mount("tmpfs", dir, "tmpfs", 0, "size=1m")) {
    print_message("cannot mount a small tmpfs: %s\n", strerror(errno));
    skip();
  }
  st = vg_shared_open(NULL, VG_TMP_DIR "/full_disk/file", 1 << 21, &f, &err);
  if (st >= 0) vg_shared_close(f, VG_OK, NULL);
  late = write_late();
  assert_false(exists(VG_TMP_DIR "/full_disk/file.part"));
  umount(dir);
  rmdir(dir);
  assert_int_equal(st, VG_ERR_IO);
  assert_non_null(strstr(err.text, "2097152 bytes"));
  assert_non_null(strstr(err.text, strerror(ENOSPC)));
  assert_int_equal(late, VG_ERR_IO);
}

/* --- from several threads ------------------------------------------------ */

enum { PIECES = 2000, PIECE = 333, THREADS = 4 };

struct writer {
  struct vg_shared_file *f;
  int number, bad;
};

static void *write_pieces(void *data)
{
  struct writer *w = data;
  unsigned char piece[PIECE];

  for (int i = w->number; i < PIECES; i += THREADS) {
    memset(piece, i % 251, sizeof piece);
    if (vg_shared_write(w->f, (uint64_t)i * PIECE, PIECE, piece, NULL))
      w->bad++;
  }
  return NULL;
}

static void from_threads(void **state)
{
  unsigned char *got = vg_alloc(PIECES + 1, PIECE);
  struct vg_shared_file *f = NULL;
  struct writer w[THREADS];
  pthread_t thread[THREADS];

  (void)state;
  assert_int_equal(vg_shared_open(NULL, NAME, PIECES * PIECE, &f, NULL), VG_OK);
  for (int i = 0; i < THREADS; i++) {
    w[i] = (struct writer){ f, i, 0 };
    assert_int_equal(pthread_create(&thread[i], NULL, write_pieces, &w[i]), 0);
  }
  for (int i = 0; i < THREADS; i++) {
    pthread_join(thread[i], NULL);
    assert_int_equal(w[i].bad, 0);
  }
  assert_int_equal(vg_shared_close(f, VG_OK, NULL), VG_OK);
  assert_int_equal(contents(NAME, got, (PIECES + 1) * PIECE), PIECES * PIECE);
  for (int i = 0; i < PIECES * PIECE; i++)
    assert_int_equal(got[i], i / PIECE % 251);
  free(got);
  unlink(NAME);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(places_in_any_order),
    cmocka_unit_test(no_bytes),
    cmocka_unit_test(takes_the_place_of_older_files),
    cmocka_unit_test(nothing_remains_after_a_failure),
    cmocka_unit_test(errors_name_file_and_reason),
    cmocka_unit_test(checks_the_size),
    cmocka_unit_test(a_full_disk),
    cmocka_unit_test(from_threads),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
