/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* One file written by several ranks and threads, and its fate when one of them
 * fails. tests/unit/test_shared_file.c has the tests for one rank without
 * MPI. */
#define _GNU_SOURCE
#include "mpi_support.h"

#include <errno.h>
#include <pthread.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/stream/shared_file.h"

enum { PIECES = 4000, THREADS = 2, TOTAL = 4000 * 3999 / 2 };

static char name[256], part[300]; /* distinct for each number of ranks */

static int open_named(void **state)
{
  int bad = open_job(state);

  snprintf(name, sizeof name, "%s/shared_%d", VG_TMP_DIR, vg_comm_size(job));
  snprintf(part, sizeof part, "%s.part", name);
  return bad;
}

static int exists(const char *path)
{
  struct stat s;

  return !stat(path, &s);
}

static void meet(void)
{
  uint64_t v = 0;

  assert_int_equal(vg_comm_sum(job, 1, &v, NULL), VG_OK);
}

/* Piece i has i bytes, each of value i. */
struct writer {
  struct vg_shared_file *f;
  int number, bad;
};

static void *write_pieces(void *data)
{
  struct writer *w = data;
  int step = THREADS * vg_comm_size(job);
  unsigned char piece[PIECES];

  for (int i = THREADS * vg_comm_rank(job) + w->number; i < PIECES; i += step) {
    memset(piece, i % 251, (size_t)i);
    if (vg_shared_write(w->f, (uint64_t)i * (uint64_t)(i - 1) / 2, (uint64_t)i,
                        piece, NULL))
      w->bad++;
  }
  return NULL;
}

static void write_by_threads(struct vg_shared_file *f)
{
  struct writer w[THREADS];
  pthread_t thread[THREADS];

  for (int i = 0; i < THREADS; i++) {
    w[i] = (struct writer){ f, i, 0 };
    assert_int_equal(pthread_create(&thread[i], NULL, write_pieces, &w[i]), 0);
  }
  for (int i = 0; i < THREADS; i++) {
    pthread_join(thread[i], NULL);
    assert_int_equal(w[i].bad, 0);
  }
}

static void the_bytes_of_one_rank(void **state)
{
  unsigned char *got = vg_alloc(TOTAL + 1, 1), *at = got;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;
  FILE *file;

  (void)state;
  assert_int_equal(vg_shared_open(job, name, TOTAL, &f, &err), VG_OK);
  write_by_threads(f);
  assert_int_equal(vg_shared_close(f, VG_OK, &err), VG_OK);
  assert_false(exists(part));
  file = fopen(name, "rb");
  assert_non_null(file);
  assert_int_equal(fread(got, 1, TOTAL + 1, file), TOTAL);
  fclose(file);
  for (int i = 0; i < PIECES; i++)
    for (int k = 0; k < i; k++, at++)
      if (*at != i % 251) fail_msg("byte %d of piece %d", k, i);
  free(got);
  meet();
  if (!vg_comm_rank(job)) unlink(name);
  meet();
}

static void a_failure_on_one_rank_fails_all(void **state)
{
  int last = vg_comm_size(job) - 1;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;
  vg_status st = VG_OK;

  (void)state;
  assert_int_equal(vg_shared_open(job, name, 1000, &f, &err), VG_OK);
  if (vg_comm_rank(job) == last)
    st = vg_fail(&err, VG_ERR_MEMORY, "no memory for walls");
  assert_int_equal(vg_shared_close(f, st, &err), VG_ERR_MEMORY);
  assert_non_null(strstr(err.text, "no memory for walls"));
  meet();
  assert_false(exists(name));
  assert_false(exists(part));
}

static void a_missing_folder(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;

  (void)state;
  assert_int_equal(vg_shared_open(job, VG_TMP_DIR "/no/folder", 10, &f, &err),
                   VG_ERR_IO);
  assert_null(f);
  assert_non_null(strstr(err.text, "/no/folder.part: "));
  assert_non_null(strstr(err.text, strerror(ENOENT)));
}

/* --- full disks ---------------------------------------------------------- */

static char disk[256];

/* Done by rank 0 for all ranks; 0: not possible here. */
static int mount_small(void)
{
  double is_there = 0;

  snprintf(disk, sizeof disk, "%s/disk_%d", VG_TMP_DIR, vg_comm_size(job));
  if (!vg_comm_rank(job)) {
    mkdir(disk, 0777);
    is_there = !mount("tmpfs", disk, "tmpfs", 0, "size=1m");
    if (!is_there)
      print_message("cannot mount a small tmpfs: %s\n", strerror(errno));
  }
  assert_int_equal(vg_comm_max(job, 1, &is_there, NULL), VG_OK);
  return is_there > 0;
}

static void unmount_small(void)
{
  meet();
  if (!vg_comm_rank(job)) {
    umount(disk);
    rmdir(disk);
  }
}

static void fill(const char *path)
{
  unsigned char *data = vg_calloc(1 << 20, 1);
  FILE *f = fopen(path, "wb");

  fwrite(data, 1, 1 << 20, f);
  fclose(f);
  free(data);
}

/* Detected before anything is written. */
static void no_space_at_the_start(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;
  char path[300], left[310];
  vg_status st;
  int is_left;

  (void)state;
  if (!mount_small()) skip();
  snprintf(path, sizeof path, "%s/file", disk);
  snprintf(left, sizeof left, "%s.part", path);
  st = vg_shared_open(job, path, 1 << 21, &f, &err);
  if (st >= 0) vg_shared_close(f, st, NULL);
  meet();
  is_left = exists(left);
  unmount_small();
  assert_int_equal(st, VG_ERR_IO);
  assert_non_null(strstr(err.text, strerror(ENOSPC)));
  assert_false(is_left);
}

/* The reserved space is lost, as on a file system that cannot reserve it. */
static void no_space_while_writing(void **state)
{
  static unsigned char data[1 << 14];
  struct vg_error err = VG_ERROR_INIT;
  struct vg_shared_file *f = NULL;
  char path[300], left[310], other[300];
  vg_status st, end;

  (void)state;
  if (!mount_small()) skip();
  snprintf(path, sizeof path, "%s/file", disk);
  snprintf(left, sizeof left, "%s.part", path);
  snprintf(other, sizeof other, "%s/other", disk);
  st = vg_shared_open(job, path, 1 << 19, &f, &err);
  meet();
  if (!vg_comm_rank(job)) {
    if (truncate(left, 0)) perror(left);
    fill(other);
  }
  meet();
  st = st < 0 ? st
              : vg_shared_write(f, (uint64_t)vg_comm_rank(job) * sizeof data,
                                sizeof data, data, &err);
  end = vg_shared_close(f, st, &err);
  meet();
  assert_false(exists(path));
  unmount_small();
  assert_int_equal(st, VG_ERR_IO);
  assert_int_equal(end, VG_ERR_IO);
  assert_non_null(strstr(err.text, strerror(ENOSPC)));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_bytes_of_one_rank),
    cmocka_unit_test(a_failure_on_one_rank_fails_all),
    cmocka_unit_test(a_missing_folder),
    cmocka_unit_test(no_space_at_the_start),
    cmocka_unit_test(no_space_while_writing),
  };

  return cmocka_run_group_tests(tests, open_named, close_job);
}
