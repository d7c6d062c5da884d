/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outcomes of finished tasks are found again, completely or not at all;
 * directories of other runs are refused with a message. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <ftw.h>
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/parallel.h"
#include "partition/store/store.h"

#define RUN_DIR VG_TMP_DIR "/store_run"

static const struct vg_digest zero = { { 0, 0 } };

/* --- support ------------------------------------------------------------- */

static int remove_one(const char *path, const struct stat *s, int flag,
                      struct FTW *f)
{
  (void)s;
  (void)flag;
  (void)f;
  return remove(path);
}

static int clean(void **state)
{
  (void)state;
  nftw(RUN_DIR, remove_one, 16, FTW_DEPTH | FTW_PHYS);
  return 0;
}

static struct vg_digest key_of(uint64_t k)
{
  return vg_digest_of(zero, sizeof k, &k);
}

static struct vg_store_options options_of(uint64_t job, int resume)
{
  return (struct vg_store_options){ .dir = RUN_DIR,
                                    .job = key_of(job),
                                    .what = job == 1 ? "first" : "second",
                                    .resume = resume };
}

static struct vg_store *opened(uint64_t job, int resume)
{
  struct vg_store_options o = options_of(job, resume);
  struct vg_error err = VG_ERROR_INIT;
  struct vg_store *s = NULL;

  if (vg_store_open(NULL, &o, &s, &err) != VG_OK) fail_msg("%s", err.text);
  assert_non_null(s);
  return s;
}

/* All words must be in the message; no store is returned. */
static void refused(const struct vg_store_options *o, vg_status st,
                    const char *const *word)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_store *s = NULL;

  assert_int_equal(vg_store_open(NULL, o, &s, &err), st);
  assert_null(s);
  for (; *word; word++)
    if (!strstr(err.text, *word))
      fail_msg("'%s' is not in: %s", *word, err.text);
}
#define REFUSED(o, st, ...)                                                    \
  refused(o, st, (const char *const[]){ __VA_ARGS__, NULL })

static int is_there(struct vg_store *s, uint64_t k, size_t n, const void *data)
{
  struct vg_bytes b = { 0, NULL };
  vg_status st = vg_store_find(s, key_of(k), &b, NULL);
  int same = st == VG_OK && b.n == n && !memcmp(b.data, data, n);

  assert_true(st == VG_OK || st == VG_BLOCKED);
  assert_true(st == VG_BLOCKED || same);
  free(b.data);
  return same;
}

static struct vg_store_report report_of(struct vg_store *s)
{
  struct vg_store_report r;

  vg_store_state(s, &r);
  return r;
}

static char found_path[512];

static int find_one(const char *path, const struct stat *s, int flag,
                    struct FTW *f)
{
  (void)s;
  if (flag != FTW_F || strlen(path + f->base) != 32) return 0;
  snprintf(found_path, sizeof found_path, "%s", path);
  return 1;
}

/* The file of the only record. */
static const char *record_path(void)
{
  assert_int_equal(nftw(RUN_DIR, find_one, 16, FTW_PHYS), 1);
  return found_path;
}

static size_t read_file(const char *path, unsigned char *data, size_t size)
{
  FILE *f = fopen(path, "rb");
  size_t n;

  assert_non_null(f);
  n = fread(data, 1, size, f);
  fclose(f);
  return n;
}

static void write_file(const char *path, const void *data, size_t n)
{
  FILE *f = fopen(path, "wb");

  assert_non_null(f);
  assert_int_equal(fwrite(data, 1, n, f), n);
  assert_int_equal(fclose(f), 0);
}

/* --- digest -------------------------------------------------------------- */

static int digests_equal(struct vg_digest a, struct vg_digest b)
{
  return a.word[0] == b.word[0] && a.word[1] == b.word[1];
}

static void digest_depends_on_every_bit(void **state)
{
  unsigned char data[300];
  struct vg_digest d, other;

  (void)state;
  for (size_t i = 0; i < sizeof data; i++) data[i] = (unsigned char)(i * 7);
  d = vg_digest_of(zero, sizeof data, data);
  assert_true(digests_equal(d, vg_digest_of(zero, sizeof data, data)));
  assert_false(digests_equal(d, vg_digest_of(zero, sizeof data - 1, data)));
  for (size_t i = 0; i < 8 * sizeof data; i++) {
    data[i / 8] ^= (unsigned char)(1 << i % 8);
    other = vg_digest_of(zero, sizeof data, data);
    assert_true(d.word[0] != other.word[0] && d.word[1] != other.word[1]);
    data[i / 8] ^= (unsigned char)(1 << i % 8);
  }
  for (int bit = 0; bit < 128; bit++) {
    struct vg_digest seed = zero;

    seed.word[bit / 64] = (uint64_t)1 << bit % 64;
    other = vg_digest_of(seed, sizeof data, data);
    assert_true(d.word[0] != other.word[0] && d.word[1] != other.word[1]);
  }
  assert_false(
    digests_equal(vg_digest_of(vg_digest_of(zero, 2, "ab"), 1, "c"),
                  vg_digest_of(vg_digest_of(zero, 1, "a"), 2, "bc")));
  assert_false(digests_equal(vg_digest_of(zero, 0, NULL), zero));
}

/* --- records ------------------------------------------------------------- */

static void kept_and_found(void **state)
{
  static unsigned char data[70000];
  struct vg_store *s = opened(1, 0);
  struct stat info;

  (void)state;
  for (size_t i = 0; i < sizeof data; i++) data[i] = (unsigned char)(i * i);
  for (uint64_t k = 0; k < 300; k++) {
    assert_false(is_there(s, k, 0, data));
    vg_store_keep(s, key_of(k), (size_t)(k * 233), data);
  }
  vg_store_keep(s, key_of(5), 1165, data); /* again */
  for (uint64_t k = 0; k < 300; k++)
    assert_true(is_there(s, k, (size_t)(k * 233), data));
  assert_int_equal(report_of(s).n_kept, 301);
  assert_int_equal(report_of(s).n_found, 300);
  assert_int_equal(report_of(s).n_damaged, 0);
  assert_string_equal(report_of(s).stopped, "");
  vg_store_close(s, 0);

  s = opened(1, 1);
  for (uint64_t k = 0; k < 300; k++)
    assert_true(is_there(s, k, (size_t)(k * 233), data));
  assert_int_equal(report_of(s).n_kept, 0);
  vg_store_close(s, 1);
  assert_int_equal(stat(RUN_DIR, &info), -1);
}

/* Every bit of every byte flipped, every shorter length, and extra bytes. */
static void a_damaged_record_is_ignored(void **state)
{
  unsigned char whole[256], bad[257];
  struct vg_store *s = opened(1, 0);
  uint64_t damaged = 0;
  size_t n;

  (void)state;
  vg_store_keep(s, key_of(1), 40, "0123456789012345678901234567890123456789");
  n = read_file(record_path(), whole, sizeof whole);
  assert_true(n > 40 && n < sizeof whole);
  for (size_t i = 0; i < 8 * n + n + 1; i++) {
    memcpy(bad, whole, n);
    bad[n] = 0;
    if (i < 8 * n) bad[i / 8] ^= (unsigned char)(1 << i % 8);
    write_file(found_path, bad, i < 8 * n ? n : i < 9 * n ? i - 8 * n : n + 1);
    assert_false(is_there(s, 1, 40, whole + n - 40));
    assert_int_equal(report_of(s).n_damaged, ++damaged);
    assert_int_equal(access(found_path, F_OK), -1);
  }
  write_file(found_path, whole, n);
  assert_true(is_there(s, 1, 40, whole + n - 40));
  vg_store_close(s, 1);
}

/* Folders and files of others where the store has its own. */
static void strange_files(void **state)
{
  struct vg_store *s = opened(1, 0);
  char path[600], *slash;

  (void)state;
  vg_store_keep(s, key_of(1), 3, "abc");
  snprintf(path, sizeof path, "%sx", record_path());
  write_file(path, "x", 1);
  vg_store_close(s, 0);
  s = opened(1, 1);
  assert_int_equal(access(path, F_OK), 0); /* is not one of its files */
  assert_int_equal(unlink(path), 0);
  path[strlen(path) - 1] = 0;
  assert_int_equal(unlink(path), 0);
  assert_int_equal(mkdir(path, 0777), 0);
  assert_false(is_there(s, 1, 3, "abc"));
  assert_int_equal(report_of(s).n_damaged, 1);
  assert_int_equal(rmdir(path), 0);
  slash = strrchr(path, '/');
  *slash = 0;
  assert_int_equal(rmdir(path), 0);
  write_file(path, "x", 1);
  assert_false(is_there(s, 1, 3, "abc"));
  assert_int_equal(report_of(s).n_damaged, 1);
  assert_int_equal(unlink(path), 0);
  vg_store_close(s, 1);
  vg_store_close(NULL, 1);
}

/* A complete record, but under the name of another. */
static void a_record_with_a_different_key(void **state)
{
  struct vg_store *s = opened(1, 0);
  char first[512];

  (void)state;
  vg_store_keep(s, key_of(1), 3, "abc");
  snprintf(first, sizeof first, "%s", record_path());
  vg_store_keep(s, key_of(2), 3, "def");
  unlink(first);
  assert_int_equal(link(record_path(), first), 0);
  assert_false(is_there(s, 1, 3, "abc"));
  assert_true(is_there(s, 2, 3, "def"));
  vg_store_close(s, 1);
}

static void many(void *context, size_t first, size_t end, int worker)
{
  unsigned char data[2000];

  (void)worker;
  for (size_t i = first; i < end; i++) {
    memset(data, (int)(i % 50), sizeof data);
    vg_store_keep(context, key_of(i % 50), sizeof data, data);
    (void)is_there(context, i % 50, sizeof data, data);
  }
}

static void several_threads(void **state)
{
  struct vg_store *s = opened(1, 0);

  (void)state;
  vg_parallel_for(4, 400, 1, many, s);
  assert_int_equal(report_of(s).n_kept, 400);
  assert_int_equal(report_of(s).n_found, 400);
  assert_int_equal(report_of(s).n_damaged, 0);
  vg_store_close(s, 1);
}

/* --- ownership of the directory ------------------------------------------ */

static void another_run_is_refused(void **state)
{
  struct vg_store_options o = options_of(2, 0);
  struct vg_store *s = opened(1, 0);

  (void)state;
  vg_store_keep(s, key_of(7), 3, "abc");
  vg_store_close(s, 0);
  REFUSED(&o, VG_ERR_INPUT, RUN_DIR, "first", "second", "another run", "choose",
          "1 finished");
  o.resume = 1;
  REFUSED(&o, VG_ERR_INPUT, RUN_DIR, "first", "second", "changed", "restore");
  o = options_of(1, 0);
  REFUSED(&o, VG_ERR_INPUT, RUN_DIR, "first", "resume it", "same run");
  s = opened(1, 1); /* still there after all this */
  assert_true(is_there(s, 7, 3, "abc"));
  vg_store_close(s, 1);
}

static void empty_run_directories_can_be_replaced(void **state)
{
  struct vg_store *s = opened(1, 0);

  (void)state;
  vg_store_close(s, 0);
  vg_store_close(opened(1, 1), 0);
  vg_store_close(opened(2, 0), 0);
  vg_store_close(opened(2, 1), 1);
  vg_store_close(NULL, 1);
}

static void nothing_to_resume(void **state)
{
  struct vg_store_options o = options_of(1, 1);

  (void)state;
  REFUSED(&o, VG_ERR_INPUT, RUN_DIR, "run directory does not exist",
          "without resuming");
  assert_int_equal(access(RUN_DIR, F_OK), -1);
  assert_int_equal(mkdir(RUN_DIR, 0777), 0);
  REFUSED(&o, VG_ERR_INPUT, RUN_DIR, "holds no run", "without resuming");
  assert_int_equal(rmdir(RUN_DIR), 0); /* nothing was left in it */
}

static void a_damaged_note(void **state)
{
  static char long_line[400] =
    "vanguard run 1\njob=00112233445566778899aabbccddeeff\nwhat=";
  static const char *const text[] = {
    "",
    "\n",
    "vanguard run 1\n",
    "vanguard run 1\njob=0123\nwhat=x\n",
    "vanguard run 2\njob=00112233445566778899aabbccddeeff\nwhat=x\n",
    "vanguard run 1\njob=00112233445566778899aabbccddeeff\nwhat=x",
    "vanguard run 1\njob=00112233445566778899aabbccddeeff\nwhere=x\n",
    long_line
  };
  struct vg_store_options o = options_of(1, 1);

  (void)state;
  memset(long_line + strlen(long_line), 'x', 300);
  strcat(long_line, "\n");
  vg_store_close(opened(1, 0), 0);
  for (size_t k = 0; k < sizeof text / sizeof *text; k++) {
    write_file(RUN_DIR "/run.txt", text[k], strlen(text[k]));
    REFUSED(&o, VG_ERR_FORMAT, RUN_DIR "/run.txt", "damaged", "remove");
  }
}

static void records_without_a_note(void **state)
{
  struct vg_store_options o = options_of(1, 0);
  struct vg_store *s = opened(1, 0);

  (void)state;
  vg_store_keep(s, key_of(1), 1, "x");
  vg_store_close(s, 0);
  assert_int_equal(unlink(RUN_DIR "/run.txt"), 0);
  REFUSED(&o, VG_ERR_INPUT, RUN_DIR, "1 finished", "remove");
}

static void an_unwritable_path(void **state)
{
  struct vg_store_options o = options_of(1, 0);

  (void)state;
  write_file(RUN_DIR, "x", 1);
  REFUSED(&o, VG_ERR_IO, RUN_DIR, "Not a directory", "choose another");
  o.dir = RUN_DIR "/below/it";
  REFUSED(&o, VG_ERR_IO, RUN_DIR, "Not a directory", "choose another");
  assert_int_equal(unlink(RUN_DIR), 0);
  o.dir = "";
  REFUSED(&o, VG_ERR_IO, "No such file or directory", "choose another");
  o.dir = "/proc/self/store";
  REFUSED(&o, VG_ERR_IO, "/proc/self/store", "choose another");
}

/* Settings that cannot be compared: the refusal has none. */
static void settings_that_are_lost(void **state)
{
  struct vg_store_options o = options_of(1, 0);
  struct vg_store *s = NULL;
  struct vg_error err;
  static char many[1 << 20];

  (void)state;
  o.what = NULL;
  o.settings = "a=1";
  assert_int_equal(vg_store_open(NULL, &o, &s, NULL), VG_OK);
  vg_store_keep(s, key_of(1), 1, "x");
  vg_store_close(s, 0);
  o = options_of(2, 1);
  o.settings = "no value\na=1\nb=2\na=3";
  REFUSED(&o, VG_ERR_INPUT, "b was not known, is 2; a was 1, is 3; restore");
  write_file(RUN_DIR "/run.settings", "", 0);
  REFUSED(&o, VG_ERR_INPUT, "a was not known, is 1; b was not known");
  memset(many, 'x', sizeof many);
  write_file(RUN_DIR "/run.settings", many, sizeof many);
  for (int k = 0; k < 2; k++) {
    if (k) assert_int_equal(unlink(RUN_DIR "/run.settings"), 0);
    assert_int_equal(vg_store_open(NULL, &o, &s, &err), VG_ERR_INPUT);
    assert_null(strstr(err.text, "was not known"));
  }
}

/* A refusal names the settings that differ, and no others. */
static void settings_side_by_side(void **state)
{
  struct vg_store_options o = options_of(1, 0);
  struct vg_store *s = NULL;
  struct vg_error err = VG_ERROR_INIT;
  char many[9000] = "";

  (void)state;
  o.settings = "growth=1.2\nhmax=0\nwalls=3-12\n";
  assert_int_equal(vg_store_open(NULL, &o, &s, NULL), VG_OK);
  vg_store_keep(s, key_of(1), 1, "x");
  vg_store_close(s, 0);
  o = options_of(2, 1);
  o.settings = "hmax=0\ngrowth=1.25\nwalls=3-1\nscale=2\nhm=0\n";
  REFUSED(&o, VG_ERR_INPUT, "growth was 1.2, is 1.25; ",
          "walls was 3-12, is 3-1; ", "scale was not known, is 2; ",
          "hm was not known");
  assert_int_equal(vg_store_open(NULL, &o, &s, &err), VG_ERR_INPUT);
  assert_null(strstr(err.text, "hmax"));
  o.resume = 0;
  REFUSED(&o, VG_ERR_INPUT, "of another run", "growth was 1.2, is 1.25; ");
  for (int k = 0; k < 300; k++)
    snprintf(many + strlen(many), 30, "name%d=value\n", k);
  o.settings = many;
  REFUSED(&o, VG_ERR_INPUT, "name0 was", "more; choose another directory");
  o = options_of(1, 1); /* the job digest decides, whatever the lines contain */
  o.settings = "growth=3";
  assert_int_equal(vg_store_open(NULL, &o, &s, NULL), VG_OK);
  vg_store_close(s, 1);
  assert_int_equal(access(RUN_DIR, F_OK), -1);
}

static void folders_above_and_other_files(void **state)
{
  struct vg_store_options o = options_of(1, 0);
  struct vg_store *s = NULL;

  (void)state;
  o.dir = RUN_DIR "/a/b/";
  o.what = "two\nlines";
  assert_int_equal(vg_store_open(NULL, &o, &s, NULL), VG_OK);
  vg_store_keep(s, key_of(1), 1, "x");
  write_file(RUN_DIR "/a/b/notes", "x", 1);
  write_file(RUN_DIR "/a/b/records/notes", "x", 1);
  vg_store_close(s, 1);
  assert_int_equal(access(RUN_DIR "/a/b/run.txt", F_OK), -1);
  assert_int_equal(access(RUN_DIR "/a/b/run.lock", F_OK), -1);
  assert_int_equal(unlink(RUN_DIR "/a/b/records/notes"), 0);
  assert_int_equal(rmdir(RUN_DIR "/a/b/records"), 0); /* no record is left */
  assert_int_equal(unlink(RUN_DIR "/a/b/notes"), 0);
}

/* Another process holds the directory. After it is killed it no longer does,
 * and its incomplete files are gone. */
static void one_run_at_a_time(void **state)
{
  struct vg_store_options o = options_of(1, 1);
  struct vg_store *s;
  char process[64], half[600];
  int ends[2];
  pid_t pid;
  char c = 0;

  (void)state;
  assert_int_equal(pipe(ends), 0);
  pid = fork();
  assert_true(pid >= 0); /* kill would take -1 for all processes */
  if (pid == 0) {
    s = opened(1, 0);
    vg_store_keep(s, key_of(1), 3, "abc");
    if (write(ends[1], &c, 1) != 1) _exit(1);
    alarm(60); /* ends it if an assertion fails */
    pause();
    _exit(0);
  }
  assert_int_equal(read(ends[0], &c, 1), 1);
  snprintf(process, sizeof process, "process %ld, started ", (long)pid);
  REFUSED(&o, VG_ERR_INPUT, RUN_DIR, "another run is using", "host ", process,
          "wait");
  o = options_of(2, 0);
  REFUSED(&o, VG_ERR_INPUT, RUN_DIR, "another run is using", process);
  kill(pid, SIGKILL);
  assert_int_equal(waitpid(pid, NULL, 0), pid);
  snprintf(half, sizeof half, "%s.0.1.part", record_path());
  write_file(half, "half", 4);
  s = opened(1, 1);
  assert_int_equal(access(half, F_OK), -1);
  assert_true(is_there(s, 1, 3, "abc"));
  vg_store_close(s, 1);
  close(ends[0]);
  close(ends[1]);
}

/* --- limits -------------------------------------------------------------- */

static void a_limit(void **state)
{
  static const char data[1000];
  struct vg_store_options o = options_of(1, 0);
  struct vg_store *s = NULL;

  (void)state;
  o.limit = 3500;
  for (int resumed = 0; resumed < 2; resumed++) {
    o.resume = resumed;
    assert_int_equal(vg_store_open(NULL, &o, &s, NULL), VG_OK);
    for (uint64_t k = 10u * (unsigned)resumed; k < 10; k++)
      vg_store_keep(s, key_of(k), sizeof data, data);
    vg_store_keep(s, key_of(11), 400, data);
    assert_int_equal(report_of(s).n_kept, resumed ? 0 : 3);
    assert_true(report_of(s).bytes_kept <= o.limit);
    assert_non_null(strstr(report_of(s).stopped, "limit of 3500 bytes"));
    assert_true(is_there(s, 2, sizeof data, data));
    assert_false(is_there(s, 3, sizeof data, data));
    vg_store_keep(s, key_of(12), SIZE_MAX, data);
    vg_store_close(s, 0);
  }
  o.limit = 100; /* less than there is */
  assert_int_equal(vg_store_open(NULL, &o, &s, NULL), VG_OK);
  vg_store_keep(s, key_of(13), 1, data);
  assert_non_null(strstr(report_of(s).stopped, "limit of 100 bytes"));
  vg_store_close(s, 1);
}

static int count_one(const char *path, const struct stat *s, int flag,
                     struct FTW *f)
{
  if (flag == FTW_F && strstr(path + f->base, ".part")) return 1;
  return flag == FTW_F && strlen(path + f->base) == 32 && s->st_size < 300000;
}

/* Records of 300 kB until the disk is full. */
static void fill_up(struct vg_store *s, const char *reason)
{
  static unsigned char data[300000];
  struct vg_store_report r;

  for (uint64_t k = 0; k < 10; k++) {
    memset(data, (int)k, sizeof data);
    vg_store_keep(s, key_of(k), sizeof data, data);
  }
  r = report_of(s);
  assert_true(r.n_kept < 10);
  if (!strstr(r.stopped, reason) || !strstr(r.stopped, RUN_DIR))
    fail_msg("%s", r.stopped);
  assert_int_equal(nftw(RUN_DIR, count_one, 16, FTW_PHYS), 0);
  for (uint64_t k = 0; k < 10; k++) {
    memset(data, (int)k, sizeof data);
    assert_int_equal(is_there(s, k, sizeof data, data), k < r.n_kept);
  }
}

/* The shell's file size limit ends writes half-way, like a full disk. */
static void an_incomplete_write(void **state)
{
  struct rlimit before, small;
  struct vg_store *s = opened(1, 0);

  (void)state;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  small = before;
  small.rlim_cur = 100000;
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  fill_up(s, "File too large");
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
  vg_store_close(s, 1);
}

/* In a separate mount namespace, if that is permitted. */
static void a_full_disk(void **state)
{
  struct vg_store *s;

  (void)state;
  if (unshare(CLONE_NEWNS) ||
      mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) ||
      mkdir(RUN_DIR, 0777) || mount("none", RUN_DIR, "tmpfs", 0, "size=1M")) {
    print_message("no permission to mount a small disk: skipped\n");
    skip();
  }
  s = opened(1, 0);
  fill_up(s, "No space left on device");
  assert_true(report_of(s).n_kept > 0);
  vg_store_close(s, 1);
  assert_int_equal(umount(RUN_DIR), 0);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, clean, clean)
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(digest_depends_on_every_bit),
    TEST(kept_and_found),
    TEST(a_damaged_record_is_ignored),
    TEST(strange_files),
    TEST(a_record_with_a_different_key),
    TEST(several_threads),
    TEST(another_run_is_refused),
    TEST(empty_run_directories_can_be_replaced),
    TEST(nothing_to_resume),
    TEST(a_damaged_note),
    TEST(records_without_a_note),
    TEST(an_unwritable_path),
    TEST(settings_that_are_lost),
    TEST(settings_side_by_side),
    TEST(folders_above_and_other_files),
    TEST(one_run_at_a_time),
    TEST(a_limit),
    TEST(an_incomplete_write),
    TEST(a_full_disk),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
