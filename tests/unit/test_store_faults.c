/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Every call for files and memory of partition/store fails once, with each
 * error and with half of its bytes: records are whole or absent, failures have
 * a message, and the directory can be used afterwards. The linker replaces the
 * calls. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

#include "partition/store/store.h"

#define RUN_DIR VG_TMP_DIR "/store_faults/a/b"

/* --- calls that fail ------------------------------------------------------ */

enum call {
  OPEN,
  OPENAT,
  READ,
  PREAD,
  WRITE,
  CLOSE,
  RENAME,
  FSTAT,
  FSTATAT,
  SEEK,
  OPENDIR,
  READDIR,
  MKDIR,
  MKDIRAT,
  RMDIR,
  UNLINKAT,
  STRDUP,
  ALLOC,
  CALLOC,
  MUTEX,
  SUM,
  AGREE,
  N_CALL
};

enum { HALF = 0, NONE = -1 };

static struct {
  enum call what;
  long n[N_CALL];      /* calls since the start */
  long at;             /* the call that fails, from 1; 0: no call */
  int is_lasting;      /* 1: all calls for files fail from it on */
  int error;           /* errno; HALF of the bytes, NONE of them */
  struct vg_store *in; /* a store for which another thread fails, too */
} faults;

static void fail_again(void);

static int fails(enum call what)
{
  faults.n[what]++;
  if (faults.is_lasting && faults.at && faults.n[faults.what] >= faults.at &&
      what < STRDUP) {
    errno = EIO;
    return 1;
  }
  if (what != faults.what || faults.n[what] != faults.at) return 0;
  if (faults.in) fail_again();
  errno = faults.error;
  return 1;
}

#define WRAP(type, name, parameters, arguments, what, failure)                 \
  type __real_##name parameters;                                               \
  type __wrap_##name parameters;                                               \
  type __wrap_##name parameters                                                \
  {                                                                            \
    return fails(what) ? failure : __real_##name arguments;                    \
  }

#define LESS(call) (faults.error == NONE ? 0 : faults.error == HALF ? call : -1)

WRAP(ssize_t, read, (int fd, void *to, size_t n), (fd, to, n), READ,
     LESS(__real_read(fd, to, n / 2)))
WRAP(ssize_t, pread, (int fd, void *to, size_t n, off_t at), (fd, to, n, at),
     PREAD, LESS(__real_pread(fd, to, n / 2, at)))
WRAP(ssize_t, write, (int fd, const void *from, size_t n), (fd, from, n), WRITE,
     LESS(__real_write(fd, from, n / 2)))
WRAP(vg_status, vg_comm_sum,
     (struct vg_comm * c, size_t n, uint64_t *v, struct vg_error *err),
     (c, n, v, err), SUM, vg_fail(err, VG_ERR_IO, "a rank is lost"))
WRAP(vg_status, vg_comm_agree,
     (struct vg_comm * c, vg_status mine, struct vg_error *err), (c, mine, err),
     AGREE, vg_fail(err, VG_ERR_IO, "a rank is lost"))
WRAP(int, renameat, (int a, const char *from, int b, const char *to),
     (a, from, b, to), RENAME, -1)
WRAP(int, fstat, (int fd, struct stat *s), (fd, s), FSTAT, -1)
WRAP(int, fstatat, (int fd, const char *p, struct stat *s, int f),
     (fd, p, s, f), FSTATAT, -1)
WRAP(off_t, lseek, (int fd, off_t at, int from), (fd, at, from), SEEK, -1)
WRAP(DIR *, fdopendir, (int fd), (fd), OPENDIR, NULL)
WRAP(struct dirent *, readdir, (DIR * d), (d), READDIR, NULL)
WRAP(int, mkdir, (const char *p, mode_t m), (p, m), MKDIR, -1)
WRAP(int, mkdirat, (int fd, const char *p, mode_t m), (fd, p, m), MKDIRAT, -1)
WRAP(int, rmdir, (const char *p), (p), RMDIR, -1)
WRAP(int, unlinkat, (int fd, const char *p, int f), (fd, p, f), UNLINKAT, -1)
WRAP(char *, strdup, (const char *s), (s), STRDUP, NULL)
WRAP(void *, vg_alloc, (size_t n, size_t size), (n, size), ALLOC, NULL)
WRAP(void *, vg_calloc, (size_t n, size_t size), (n, size), CALLOC, NULL)
WRAP(int, pthread_mutex_init,
     (pthread_mutex_t * m, const pthread_mutexattr_t *a), (m, a), MUTEX, ENOMEM)

/* A failed close has closed the file. */
int __real_close(int fd);
int __wrap_close(int fd);
int __wrap_close(int fd)
{
  int fault = fails(CLOSE), error = errno, result = __real_close(fd);

  errno = error;
  return fault ? -1 : result;
}

int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...)
{
  return fails(OPEN) ? -1 : __real_open(path, flags, 0666);
}

int __real_openat(int at, const char *path, int flags, ...);
int __wrap_openat(int at, const char *path, int flags, ...);
/* A walk opens 256 folders, of which most are absent: they do not count. */
int __wrap_openat(int at, const char *path, int flags, ...)
{
  if (!(flags & O_CREAT) && strlen(path) == strlen("records/00") &&
      faccessat(at, path, F_OK, 0))
    return -1;
  return fails(OPENAT) ? -1 : __real_openat(at, path, flags, 0666);
}

/* --- a run, and one that continues it ------------------------------------- */

enum { N_RECORD = 3, BYTES = 301 };

static const struct vg_digest zero = { { 0, 0 } };

static struct vg_digest key_of(uint64_t k)
{
  return vg_digest_of(zero, sizeof k, &k);
}

static vg_status open_store(uint64_t job, int resume, struct vg_store **s)
{
  const struct vg_store_options o = { .dir = RUN_DIR,
                                      .job = key_of(job),
                                      .what = job ? "first" : NULL,
                                      .settings = job == 1 ? "a=1\nb=2\n"
                                                           : "a=1\nc=3\n",
                                      .resume = resume };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_store_open(NULL, &o, s, &err);

  if (st < 0) {
    assert_null(*s);
    assert_true(err.text[0] != 0);
  }
  return st;
}

static void record_of(unsigned char *data, int k)
{
  for (int i = 0; i < BYTES; i++) data[i] = (unsigned char)(i * (k + 3));
}

/* Records are whole, absent, or cannot be read, with a message. Returns the
 * number of those that were found. */
static int found(struct vg_store *s)
{
  unsigned char data[BYTES];
  int n = 0;

  for (int k = 0; k < N_RECORD; k++) {
    struct vg_bytes b = { 0, NULL };
    struct vg_error err = VG_ERROR_INIT;
    vg_status st = vg_store_find(s, key_of((uint64_t)k), &b, &err);

    record_of(data, k);
    if (st == VG_OK) assert_int_equal(b.n, BYTES);
    if (st == VG_OK) assert_memory_equal(b.data, data, BYTES);
    if (st < 0) assert_true(err.text[0] != 0);
    n += st == VG_OK;
    free(b.data);
  }
  return n;
}

static int remove_one(const char *path, const struct stat *s, int flag,
                      struct FTW *f)
{
  (void)s;
  (void)flag;
  (void)f;
  return remove(path);
}

/* The digest of a file is that of the first call, or the call fails. */
static void digest_of_a_file(void)
{
  static struct vg_digest first;
  struct vg_digest d;
  uint64_t bytes;
  int fd = memfd_create("digest", 0);

  assert_true(fd >= 0);
  assert_int_equal(__real_write(fd, RUN_DIR, sizeof RUN_DIR), sizeof RUN_DIR);
  assert_int_equal(__real_lseek(fd, 0, SEEK_SET), 0);
  /* A read of no bytes is the end of the file. */
  if (!vg_digest_file(fd, &d, &bytes) && faults.error != NONE) {
    if (!faults.at) first = d;
    assert_memory_equal(&d, &first, sizeof d);
    assert_int_equal(bytes, sizeof RUN_DIR);
  }
  __real_close(fd);
}

static void scenario(void)
{
  unsigned char data[BYTES];
  struct vg_store *s = NULL;
  struct vg_store_report r;
  struct vg_error err = VG_ERROR_INIT;

  digest_of_a_file();
  record_of(data, 0);
  if (open_store(1, 0, &s) == VG_OK) {
    vg_store_keep(s, key_of(0), BYTES, data);
    vg_store_close(s, 1);
  }
  s = NULL;
  if (open_store(1, 0, &s) == VG_OK) {
    for (int k = 0; k < N_RECORD; k++) {
      record_of(data, k);
      vg_store_keep(s, key_of((uint64_t)k), BYTES, data);
    }
    vg_store_state(s, &r);
    assert_true(r.n_kept == N_RECORD || r.stopped[0]);
    vg_store_close(s, 0);
  }
  s = NULL;
  if (open_store(2, 1, &s) == VG_OK) vg_store_close(s, 0);
  s = NULL;
  if (vg_store_has_run(RUN_DIR, &err) < 0) assert_true(err.text[0] != 0);
  if (open_store(1, 1, &s) == VG_OK) {
    found(s);
    vg_store_close(s, 0);
  }
}

/* Without faults: the kept records are found, and the directory goes. Returns
 * their number. */
static int continued(void)
{
  struct vg_store *s = NULL;
  struct vg_error err = VG_ERROR_INIT;
  int resume = vg_store_has_run(RUN_DIR, &err) == VG_OK, n = 0;

  if (open_store(1, resume, &s) == VG_OK) {
    n = found(s);
    vg_store_close(s, 1);
  }
  nftw(VG_TMP_DIR "/store_faults", remove_one, 16, FTW_DEPTH | FTW_PHYS);
  return n;
}

/* Fail each call of this kind in turn, alone or with all later calls; of many
 * calls, which are those of walks through 256 folders, about every hundredth.
 */
static void fail_each(enum call what, int error, int is_lasting)
{
  long n_call = 0;

  for (long at = 0; at <= n_call; at++) {
    memset(&faults, 0, sizeof faults);
    mkdir(VG_TMP_DIR "/store_faults", 0777);
    faults.what = what;
    memset(faults.n, 0, sizeof faults.n);
    faults.error = error;
    faults.is_lasting = is_lasting;
    faults.at = at;
    scenario();
    if (faults.n[what] > n_call) n_call = faults.n[what];
    faults.at = 0;
    assert_in_range(continued(), 0, N_RECORD);
  }
  if (!n_call) fail_msg("call %d is never made", (int)what);
}

static void undisturbed(void **state)
{
  (void)state;
  nftw(VG_TMP_DIR "/store_faults", remove_one, 16, FTW_DEPTH | FTW_PHYS);
  memset(&faults, 0, sizeof faults);
  mkdir(VG_TMP_DIR "/store_faults", 0777);
  scenario();
  assert_int_equal(continued(), N_RECORD);
}

static void every_call_fails(void **state)
{
  static const int error[] = { EIO, EINTR, ENOENT, HALF, NONE };

  (void)state;
  for (int what = 0; what < N_CALL; what++) {
    for (size_t i = 0; i < sizeof error / sizeof *error; i++)
      fail_each((enum call)what, error[i], 0);
    fail_each((enum call)what, EIO, 1);
  }
}

static void fail_again(void)
{
  struct vg_store *s = faults.in;

  faults.in = NULL;
  faults.at++;
  vg_store_keep(s, key_of(8), 1, "x");
}

/* Two threads: the first failure is the reason that is reported. */
static void two_records_fail(void **state)
{
  struct vg_store *s = NULL;
  struct vg_store_report r;

  (void)state;
  memset(&faults, 0, sizeof faults);
  mkdir(VG_TMP_DIR "/store_faults", 0777);
  assert_int_equal(open_store(1, 0, &s), VG_OK);
  memset(faults.n, 0, sizeof faults.n);
  faults.what = WRITE;
  faults.error = ENOSPC;
  faults.in = s;
  faults.at = 1;
  vg_store_keep(s, key_of(7), 1, "x");
  faults.at = 0;
  vg_store_state(s, &r);
  assert_int_equal(r.n_kept, 0);
  assert_non_null(strstr(r.stopped, "No space left"));
  vg_store_close(s, 1);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(undisturbed),
    cmocka_unit_test(every_call_fails),
    cmocka_unit_test(two_records_fail),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
