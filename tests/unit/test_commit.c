/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/commit: all files appear, or none, whatever fails and whenever the power
 * does. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <fts.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "commit_calls.h"
#include "run/commit/commit.h"
#include "run/commit/tree.h"

/* In a scratch folder. */
#define ROOT "commit"
#define REPLAY "commit_replay"
#define NAME "case"
#define HIDDEN ".vanguard-" NAME

__attribute__((noinline)) static const char *in(const char *a, const char *b)
{
  static char path[8][1000];
  static int turn;

  turn = (turn + 1) % 8;
  snprintf(path[turn], sizeof path[turn], "%s/%s", a, b);
  return path[turn];
}

static int exists(const char *path)
{
  struct stat s;

  return !lstat(path, &s);
}

static void put(const char *path, const char *text)
{
  FILE *f = fopen(path, "w");

  assert_non_null(f);
  fputs(text, f);
  assert_int_equal(fclose(f), 0);
}

static int by_name(const FTSENT **a, const FTSENT **b)
{
  return strcmp((*a)->fts_name, (*b)->fts_name);
}

/* Names and contents of all files but those of hidden folders; to be freed. */
static char *contents(const char *root)
{
  char *const paths[] = { (char *)root, NULL };
  FTS *tree = fts_open(paths, FTS_PHYSICAL | FTS_NOCHDIR, by_name);
  char *text = NULL, block[400];
  size_t size, n;
  FILE *to = open_memstream(&text, &size), *f;
  FTSENT *e;

  while ((e = fts_read(tree))) {
    if (e->fts_level == 1 && e->fts_name[0] == '.') fts_set(tree, e, FTS_SKIP);
    else if (e->fts_info != FTS_DP)
      fprintf(to, "%s%s", e->fts_path + strlen(root),
              e->fts_info == FTS_D ? "/\n" : ": ");
    if (e->fts_info != FTS_F) continue;
    f = fopen(e->fts_path, "r");
    n = f ? fread(block, 1, sizeof block - 1, f) : 0;
    block[n] = 0;
    fprintf(to, "%s\n", block);
    if (f) fclose(f);
  }
  fts_close(tree);
  fclose(to);
  return text;
}

/* --- random sets of files ------------------------------------------------ */

enum { MOST = 6 };

struct set {
  unsigned seed;
  int n;
  struct item {
    enum vg_move_kind kind;
    int had_old, n_file; /* n_file: of a folder */
    char path[40];
  } item[MOST];
};

static unsigned pick(unsigned *state, unsigned n)
{
  *state = *state * 1664525u + 1013904223u;
  return (*state >> 16) % n;
}

static struct set make_set(unsigned seed)
{
  struct set s = { .seed = seed };
  unsigned state = seed;

  s.n = 1 + (int)pick(&state, MOST);
  for (int i = 0; i < s.n; i++) {
    struct item *t = &s.item[i];

    t->kind = (enum vg_move_kind)pick(&state, 3);
    t->had_old = pick(&state, 4) > 0;
    t->n_file = (int)pick(&state, 3);
    snprintf(t->path, sizeof t->path, "%sitem %d",
             pick(&state, 2) ? "sub/" : "", i);
  }
  return s;
}

static void put_item(const struct item *t, const char *path, const char *text)
{
  char name[20];

  if (t->kind == VG_MOVE_FILE || (t->kind == VG_MOVE_REMOVE && t->n_file)) {
    put(path, text);
    return;
  }
  assert_int_equal(mkdir(path, 0777), 0);
  for (int k = 0; k < t->n_file; k++) {
    snprintf(name, sizeof name, "%s%d", text, k);
    put(in(path, name), text);
  }
}

static void make_old(const struct set *s, const char *root)
{
  vg_tree_remove(root);
  assert_int_equal(mkdir(root, 0777), 0);
  assert_int_equal(mkdir(in(root, "sub"), 0777), 0);
  put(in(root, "other"), "of somebody else");
  for (int i = 0; i < s->n; i++)
    if (s->item[i].had_old)
      put_item(&s->item[i], in(root, s->item[i].path), "old");
}

/* Names of files that stay in use in the next four calls. The files are
 * written by the calls that are counted. */
static vg_status put_new(const struct set *s, struct vg_commit *c,
                         struct vg_error *err)
{
  vg_status st = VG_OK;

  for (int i = 0; i < s->n && st >= 0; i++) {
    const struct item *t = &s->item[i];
    char name[20];
    struct vg_journal none = { 0 };

    snprintf(name, sizeof name, "new %d", i);
    st = vg_commit_add(c, t->kind, t->kind == VG_MOVE_REMOVE ? "" : name,
                       t->path, err);
    if (st < 0 || t->kind == VG_MOVE_REMOVE) continue;
    if (t->kind == VG_MOVE_FILE)
      st = vg_journal_write(&none, in(c->fresh, name), err);
    else if (mkdir(in(c->fresh, name), 0777))
      st = vg_fail(err, VG_ERR_IO, "a folder: %s", strerror(errno));
    else
      for (int k = 0; k <= t->n_file && st >= 0; k++)
        st = vg_journal_write(&none, in(in(c->fresh, name), k ? "a" : "b"),
                              err);
  }
  return st;
}

static vg_status run(const struct set *s, const char *root,
                     struct vg_error *err)
{
  struct vg_commit c;
  vg_status st = vg_commit_open(root, NAME, NULL, NULL, &c, err);

  if (st < 0) return st;
  st = put_new(s, &c, err);
  if (st >= 0) st = vg_commit_run(&c, err);
  vg_commit_close(&c);
  return st;
}

struct states {
  char *old, *new;
};

static struct states states_of(const struct set *s)
{
  struct vg_error err = VG_ERROR_INIT;
  struct states is;

  calls_reset();
  make_old(s, ROOT);
  is.old = contents(ROOT);
  if (run(s, ROOT, &err) < 0) fail_msg("%s", err.text);
  is.new = contents(ROOT);
  assert_false(exists(ROOT "/" HIDDEN));
  return is;
}

static void free_states(struct states *is)
{
  free(is->old);
  free(is->new);
}

/* -1: the old files; 1: the new ones; 2: both are the same. */
static int state_of(const char *root, const struct states *is)
{
  char *now = contents(root);
  int is_old = !strcmp(now, is->old), is_new = !strcmp(now, is->new);

  if (!is_old && !is_new)
    print_error("neither the old files:\n%snor the new ones:\n%sbut:\n%s",
                is->old, is->new, now);
  free(now);
  return is_old && is_new ? 2 : is_old ? -1 : is_new ? 1 : 0;
}

/* The next run opens its hidden folder, and ends. */
static vg_status recover(const char *root, struct vg_error *err)
{
  struct vg_commit c;
  vg_status st = vg_commit_open(root, NAME, NULL, NULL, &c, err);

  if (st >= 0) vg_commit_close(&c);
  return st;
}

static void recovers(const char *root, const struct states *is, unsigned seed,
                     long at)
{
  struct vg_error err = VG_ERROR_INIT;

  calls_reset();
  if (recover(root, &err) < 0)
    fail_msg("set %u, call %ld: %s", seed, at, err.text);
  if (!state_of(root, is)) fail_msg("set %u, call %ld", seed, at);
  if (exists(in(root, HIDDEN)))
    fail_msg("set %u, call %ld: a hidden folder is left", seed, at);
}

/* The kinds of file systems. */
static void set_system(unsigned k)
{
  static const int link[] = { EPERM, ENOSYS, EOPNOTSUPP, EMLINK, EACCES };
  static const int exchange[] = { EINVAL, ENOSYS, EOPNOTSUPP };
  static const int folder_sync[] = { 0, EINVAL, ENOSYS, EOPNOTSUPP, EBADF };

  calls.no_link = k % 2 ? link[k / 2 % 5] : 0;
  calls.no_exchange = k / 2 % 2 ? exchange[k / 4 % 3] : 0;
  calls.no_folder_sync = folder_sync[k % 5];
}

/* --- every call fails ---------------------------------------------------- */

/* One call fails: the status tells which files are there. */
static int one_fails(const struct set *s, const struct states *is, long at)
{
  static const int error[] = {
    EIO, ENOSPC, EACCES, EINTR, 0, EOPNOTSUPP, EPERM
  };
  struct vg_error err = VG_ERROR_INIT;
  int now, went_on;
  vg_status st;

  make_old(s, ROOT);
  calls_reset();
  calls.fail_at = at;
  calls.error = error[(at + (long)s->seed) % 7];
  st = run(s, ROOT, &err);
  went_on = calls.n >= at;
  calls_reset();
  now = state_of(ROOT, is);
  if (!(st < 0 ? now == -1 || now == 2 : now > 0))
    fail_msg("set %u, call %ld: status %d, '%s', state %d", s->seed, at, st,
             err.text, now);
  if (st < 0) assert_true(*err.text);
  recovers(ROOT, is, s->seed, at);
  return went_on;
}

/* One call fails, and all calls from another one on, as on a disk that is gone;
 * and again during the recovery. */
static void all_fail(const struct set *s, const struct states *is, long at,
                     long from, long again)
{
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  make_old(s, ROOT);
  calls_reset();
  calls.fail_at = at;
  calls.fails_from = from;
  calls.error = EROFS;
  st = run(s, ROOT, &err);
  if (st < 0) assert_true(*err.text);
  for (int k = 0; again && k < 2; k++) {
    calls_reset();
    calls.fail_at = again + 3 * k;
    calls.fails_from = k ? 0 : again + at % 7;
    calls.error = EIO;
    (void)recover(ROOT, NULL);
  }
  recovers(ROOT, is, s->seed, at);
  if (st >= 0) assert_true(state_of(ROOT, is) > 0);
}

static void every_call_fails(void **state)
{
  (void)state;
  for (unsigned seed = 1; seed <= 12; seed++) {
    struct set s = make_set(seed);
    struct states is;

    set_system(seed);
    is = states_of(&s);
    for (long at = 1; one_fails(&s, &is, at); at++) {
      all_fail(&s, &is, at, at, 0);
      for (long gap = 2; gap < 12; gap++)
        all_fail(&s, &is, at, at + gap, gap % 3 ? 0 : 7 * at % 53);
      all_fail(&s, &is, at, at, 1 + (5 * at + (long)seed) % 53);
    }
    free_states(&is);
  }
  set_system(0);
}

/* --- power loss ---------------------------------------------------------- */

static void fail_after(const char *what, unsigned seed, size_t n, unsigned way)
{
  fail_msg("set %u, %zu calls, way %u: %s", seed, n, way, what);
}

/* The power fails after n of `done` calls. In some ways a call of the recovery
 * fails, so that it must undo. */
static void lose_power(const struct set *s, const struct states *is, size_t n,
                       size_t done, unsigned way)
{
  struct vg_error err = VG_ERROR_INIT;

  make_old(s, REPLAY);
  calls_replay(REPLAY, n, way);
  if (way % 2 && n < done) {
    calls.n = 0;
    calls.fail_at = 1 + (long)((n + way + s->seed) % 23);
    calls.error = EIO;
    (void)recover(REPLAY, NULL);
    calls.fail_at = 0;
  }
  if (recover(REPLAY, &err) < 0) fail_after(err.text, s->seed, n, way);
  if (!state_of(REPLAY, is)) fail_after("mixed", s->seed, n, way);
  if (n == done && state_of(REPLAY, is) < 0)
    fail_after("not on the disk", s->seed, n, way);
  if (exists(REPLAY "/" HIDDEN))
    fail_after("a hidden folder is left", s->seed, n, way);
}

static void power_is_lost(void **state)
{
  (void)state;
  for (unsigned seed = 1; seed <= 10; seed++) {
    struct set s = make_set(seed);
    struct states is;
    size_t done;

    set_system(seed);
    calls.no_folder_sync = 0; /* only certain names are kept */
    is = states_of(&s);
    make_old(&s, ROOT);
    calls_reset();
    calls.root = ROOT;
    assert_int_equal(run(&s, ROOT, NULL), VG_OK);
    calls.root = NULL;
    done = calls_recorded();
    for (size_t n = 0; n <= done; n++)
      for (unsigned way = 0; way < 40; way++) lose_power(&s, &is, n, done, way);
    free_states(&is);
  }
  set_system(0);
  calls_reset();
  vg_tree_remove(REPLAY);
}

/* --- refusals ------------------------------------------------------------ */

static struct vg_commit open_root(void)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_commit c;

  calls_reset();
  if (vg_commit_open(ROOT, NAME, NULL, NULL, &c, &err) < 0)
    fail_msg("%s", err.text);
  return c;
}

static void kinds_must_fit(void **state)
{
  static const char *const to[2] = { "a folder", "a file" };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int k = 0; k < 2; k++) {
    struct set none = { .n = 0 };
    struct vg_commit c;

    make_old(&none, ROOT);
    put(ROOT "/a file", "old");
    put(ROOT "/first", "old");
    assert_int_equal(mkdir(ROOT "/a folder", 0777), 0);
    c = open_root();
    put(in(c.fresh, "first"), "new");
    if (k) assert_int_equal(mkdir(in(c.fresh, "x"), 0777), 0);
    else put(in(c.fresh, "x"), "new");
    vg_commit_add(&c, VG_MOVE_FILE, "first", "first", NULL);
    vg_commit_add(&c, k ? VG_MOVE_FOLDER : VG_MOVE_FILE, "x", to[k], NULL);
    assert_int_equal(vg_commit_run(&c, &err), VG_ERR_IO);
    assert_non_null(strstr(err.text, to[k]));
    vg_commit_close(&c);
    assert_false(exists(ROOT "/" HIDDEN));
  }
}

static void a_second_process_is_refused(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct set none = { .n = 0 };
  struct vg_commit c, second;
  char process[40];

  (void)state;
  snprintf(process, sizeof process, "process %ld, started 2", (long)getpid());
  make_old(&none, ROOT);
  for (int k = 0; k < 2; k++) {
    calls.no_lock = k ? ENOLCK : 0;
    c = open_root();
    assert_int_equal(vg_commit_open(ROOT, NAME, NULL, NULL, &second, &err),
                     VG_ERR_INPUT);
    assert_non_null(strstr(err.text, "another run is writing case.*"));
    assert_non_null(strstr(err.text, "host "));
    assert_non_null(strstr(err.text, process));
    assert_int_equal(vg_commit_open(ROOT, "other", NULL, NULL, &second, &err),
                     VG_OK); /* other names */
    vg_commit_close(&second);
    vg_commit_sweep(ROOT, NULL, NULL, NULL);
    assert_true(exists(c.fresh));
    vg_commit_close(&c);
  }
  calls.no_lock = 0;
}

/* A process that ends without vg_commit_close. */
static void leave_behind(const char *name)
{
  pid_t child = fork();
  struct vg_commit c;

  if (!child) {
    if (vg_commit_open(ROOT, name, NULL, NULL, &c, NULL) < 0) _exit(1);
    put(in(c.fresh, "x"), "half");
    _exit(0);
  }
  waitpid(child, NULL, 0);
}

static char told[2000];

static void tell(void *user, const char *text)
{
  (void)user;
  snprintf(told, sizeof told, "%s", text);
}

static void remains_are_removed(void **state)
{
  struct set none = { .n = 0 };
  struct vg_commit c;

  (void)state;
  make_old(&none, ROOT);
  for (int k = 0; k < 2; k++) {
    calls.no_lock = k ? ENOLCK : 0;
    leave_behind(NAME);
    leave_behind("second");
    *told = 0;
    assert_int_equal(vg_commit_open(ROOT, NAME, tell, NULL, &c, NULL), VG_OK);
    assert_non_null(strstr(told, "removed " ROOT "/" HIDDEN));
    assert_false(exists(in(c.fresh, "x")));
    *told = 0;
    vg_commit_sweep(ROOT, NULL, tell, NULL);
    assert_non_null(strstr(told, "removed " ROOT "/.vanguard-second"));
    assert_false(exists(ROOT "/.vanguard-second"));
    vg_commit_close(&c);
    assert_false(exists(ROOT "/" HIDDEN));
  }
  calls.no_lock = 0;
}

/* Without locks, a process of another host may be alive. */
static void another_host_without_locks(void **state)
{
  struct set none = { .n = 0 };
  struct vg_error err = VG_ERROR_INIT;
  struct vg_commit c;

  (void)state;
  make_old(&none, ROOT);
  leave_behind(NAME);
  put(ROOT "/" HIDDEN "/lock", "host elsewhere, process 1, started then\n");
  calls.no_lock = ENOLCK;
  assert_int_equal(vg_commit_open(ROOT, NAME, NULL, NULL, &c, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "host elsewhere, process 1"));
  assert_true(exists(ROOT "/" HIDDEN "/new/x"));
  calls.no_lock = 0;
  assert_int_equal(recover(ROOT, &err), VG_OK);
  assert_false(exists(ROOT "/" HIDDEN));
}

static void interrupted_moves_are_noted(void **state)
{
  struct set s = make_set(3);
  struct states is = states_of(&s);
  int completed = 0, restored = 0;

  (void)state;
  for (long at = 1; at < 200; at++) {
    make_old(&s, ROOT);
    calls_reset();
    calls.fails_from = at;
    calls.error = EIO;
    (void)run(&s, ROOT, NULL);
    calls_reset();
    *told = 0;
    struct vg_commit c;
    assert_int_equal(vg_commit_open(ROOT, NAME, tell, NULL, &c, NULL), VG_OK);
    vg_commit_close(&c);
    completed += strstr(told, "were completed") != NULL;
    restored += strstr(told, "were restored") != NULL;
  }
  assert_true(completed > 0);
  (void)restored;
  free_states(&is);
}

/* --- locks ---------------------------------------------------------------- */

static int n_replaced, is_by_link;

/* The lock file is replaced between open and flock, by a file or by a symbolic
 * link to one on another disk. */
static void replace(const char *path)
{
  if (n_replaced++) return;
  put(VG_TMP_DIR "/lock of test_commit", "");
  put(ROOT "/lock", "");
  if (is_by_link) {
    assert_int_equal(unlink(path), 0);
    assert_int_equal(symlink(VG_TMP_DIR "/lock of test_commit", path), 0);
  } else assert_int_equal(rename(ROOT "/lock", path), 0);
}

static void a_replaced_lock_is_taken_again(void **state)
{
  struct vg_commit c;

  (void)state;
  for (is_by_link = 0; is_by_link < 2; is_by_link++) {
    make_old(&(struct set){ .n = 0 }, ROOT);
    calls_reset();
    n_replaced = 0;
    calls.before_lock = replace;
    assert_int_equal(vg_commit_open(ROOT, NAME, NULL, NULL, &c, NULL), VG_OK);
    assert_int_equal(n_replaced, 2);
    vg_commit_close(&c);
  }
  calls_reset();
  unlink(VG_TMP_DIR "/lock of test_commit");
}

static void a_lock_without_a_name(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_commit c;
  int fd;

  (void)state;
  make_old(&(struct set){ .n = 0 }, ROOT);
  calls_reset();
  assert_int_equal(mkdir(ROOT "/" HIDDEN, 0777), 0);
  put(ROOT "/" HIDDEN "/lock", "");
  fd = open(ROOT "/" HIDDEN "/lock", O_RDWR);
  assert_int_equal(flock(fd, LOCK_EX), 0);
  assert_int_equal(vg_commit_open(ROOT, NAME, NULL, NULL, &c, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "(an unknown process)"));
  close(fd);
}

/* Remains are removed, or stay whole, whatever fails. */
static void every_call_of_a_sweep_fails(void **state)
{
  static const int error[] = { EIO, ENOENT, EPERM };
  struct vg_commit c;
  long n = 1;

  (void)state;
  for (int k = 0; k < 6; k++) {
    for (long at = 1; at <= n; at++) {
      make_old(&(struct set){ .n = 0 }, ROOT);
      calls_reset();
      calls.no_lock = k % 2 ? ENOLCK : 0;
      leave_behind("second");
      assert_int_equal(mkdir(ROOT "/.vanguard-empty", 0777), 0);
      c = open_root();
      calls.n = 0;
      calls.fail_at = at;
      calls.error = error[k / 2];
      vg_commit_sweep(ROOT, &c, NULL, NULL);
      if (calls.n > n) n = calls.n;
      calls_reset();
      assert_true(exists(c.fresh));
      assert_true(exists(ROOT "/other"));
      vg_commit_close(&c);
      vg_commit_sweep(ROOT, NULL, NULL, NULL);
      /* Without locks, this process may hold it. */
      if (!calls.no_lock && exists(ROOT "/.vanguard-second/lock"))
        fail_msg("call %ld, error %d: remains", at, error[k / 2]);
    }
  }
  calls.no_lock = 0;
}

/* --- moves ---------------------------------------------------------------- */

static void vanish(void)
{
  vg_tree_remove(ROOT "/sub");
  assert_int_equal(mkdir(ROOT "/sub", 0777), 0);
}

/* Another program removes the old files before they are moved. */
static void old_files_vanish(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_commit c;

  (void)state;
  for (int k = 0; k < 4; k++) {
    set_system((unsigned)k);
    make_old(&(struct set){ .n = 0 }, ROOT);
    put(ROOT "/sub/f", "old");
    assert_int_equal(mkdir(ROOT "/sub/d", 0777), 0);
    c = open_root();
    calls.before_journal = vanish;
    put(in(c.fresh, "f"), "new");
    assert_int_equal(mkdir(in(c.fresh, "d"), 0777), 0);
    vg_commit_add(&c, VG_MOVE_FILE, "f", "sub/f", NULL);
    vg_commit_add(&c, VG_MOVE_FOLDER, "d", "sub/d", NULL);
    if (vg_commit_run(&c, &err) < 0) fail_msg("%s", err.text);
    vg_commit_close(&c);
    assert_true(exists(ROOT "/sub/f") && exists(ROOT "/sub/d"));
    assert_false(exists(ROOT "/" HIDDEN));
  }
  calls_reset();
  set_system(0);
}

/* The journal of moves to be undone, of which the disk has nothing. */
static void nothing_to_undo(void **state)
{
  struct vg_journal j = { 0 };

  (void)state;
  make_old(&(struct set){ .n = 0 }, ROOT);
  calls_reset();
  leave_behind(NAME);
  for (int had_old = 0; had_old < 2; had_old++)
    for (int kind = VG_MOVE_FILE; kind <= VG_MOVE_REMOVE; kind++) {
      vg_journal_add(&j, (enum vg_move_kind)kind, "a", "b", NULL);
      j.move[j.n - 1].had_old = had_old;
    }
  assert_int_equal(vg_journal_write(&j, ROOT "/" HIDDEN "/undo", NULL), VG_OK);
  vg_journal_release(&j);
  assert_int_equal(recover(ROOT, NULL), VG_OK);
  assert_false(exists(ROOT "/" HIDDEN) || exists(ROOT "/b"));
  assert_true(exists(ROOT "/other"));
}

/* The target is an absolute path, and the folder is the current one. */
static void absolute_targets(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_commit c = { .hidden = NULL };
  char here[400], to[440];

  (void)state;
  vg_commit_close(&c); /* not open */
  make_old(&(struct set){ .n = 0 }, ROOT);
  calls_reset();
  assert_non_null(getcwd(here, sizeof here));
  assert_int_equal(chdir(ROOT), 0);
  for (int k = 0; k < 2; k++) {
    assert_int_equal(vg_commit_open(".", NAME, NULL, NULL, &c, &err), VG_OK);
    put(in(c.fresh, "x"), "new");
    snprintf(to, sizeof to, "%s/" ROOT "/far", here);
    vg_commit_add(&c, VG_MOVE_FILE, "x", k ? "sub" : to, NULL);
    assert_int_equal(vg_commit_run(&c, &err), k ? VG_ERR_IO : VG_OK);
    vg_commit_close(&c);
  }
  assert_true(exists("far"));
  assert_memory_equal(err.text, "sub: a folder exists", 20);
  assert_int_equal(chdir(here), 0);
}

/* --- the journal --------------------------------------------------------- */

static void journals(void **state)
{
  struct vg_journal j = { 0 }, back = { 0 };
  char *text;
  size_t size;
  FILE *f;

  (void)state;
  make_old(&(struct set){ .n = 0 }, ROOT);
  vg_journal_add(&j, VG_MOVE_FILE, "a\nb", "/c d\n", NULL);
  vg_journal_add(&j, VG_MOVE_REMOVE, "", "end", NULL);
  j.move[0].had_old = 1;
  j.move[0].ino = 12345678901234ull;
  assert_int_equal(vg_journal_write(&j, ROOT "/journal", NULL), VG_OK);
  assert_int_equal(vg_journal_read(ROOT "/journal", &back, NULL), VG_OK);
  assert_int_equal(back.n, 2);
  assert_string_equal(back.move[0].from, "a\nb");
  assert_string_equal(back.move[0].to, "/c d\n");
  assert_int_equal(back.move[0].had_old, 1);
  assert_true(back.move[0].ino == j.move[0].ino);
  assert_int_equal(back.move[1].kind, VG_MOVE_REMOVE);
  vg_journal_release(&back);
  vg_journal_release(&j);
  f = fopen(ROOT "/journal", "r");
  text = calloc(400, 1);
  size = fread(text, 1, 399, f);
  fclose(f);
  for (size_t n = 0; n < size; n++) { /* cut anywhere */
    f = fopen(ROOT "/journal", "w");
    fwrite(text, 1, n, f);
    fclose(f);
    assert_int_equal(vg_journal_read(ROOT "/journal", &back, NULL),
                     VG_ERR_FORMAT);
    assert_int_equal(back.n, 0);
  }
  free(text);
  assert_int_equal(vg_journal_read(ROOT "/absent", &back, NULL), VG_ERR_IO);
}

/* A damaged journal: nothing is removed, and the message names it. */
static void damaged_journals_are_refused(void **state)
{
  static const char *const text[] = {
    "vanguard commit 1\n0 7\nend\n",
    "vanguard commit 2\nend\n-------",
    "vanguard",
    "vanguard commit 1\n-1 0 0 1 1\na\nb\nend\n",
    "vanguard commit 1\n3 0 0 1 1\na\nb\nend\n",
    "vanguard commit 1\n0 0 0 1 1 \na\nb\nend\n",
    "vanguard commit 1\n0 0 0 99 1\na\nb\nend\n",
    "vanguard commit 1\n0 0 0 1 99\na\nb\nend\n",
    "vanguard commit 1\n0 0 0 1 6\na\nb\nend\n",
    "vanguard commit 1\n0 0 0 2 1\na\nb\nend\n",
    "vanguard commit 1\n0 0 0 1 2\na\nb\nend\n",
  };
  struct vg_error err = VG_ERROR_INIT;
  struct vg_journal j = { 0 };

  (void)state;
  make_old(&(struct set){ .n = 0 }, ROOT);
  leave_behind(NAME);
  for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
    put(ROOT "/" HIDDEN "/journal", text[i]);
    assert_int_equal(recover(ROOT, &err), VG_ERR_FORMAT);
    assert_non_null(strstr(err.text, HIDDEN "/journal: is damaged"));
    assert_true(exists(ROOT "/" HIDDEN "/new/x"));
    *told = 0;
    vg_commit_sweep(ROOT, NULL, tell, NULL);
    assert_non_null(strstr(told, "is damaged"));
    assert_true(exists(ROOT "/" HIDDEN "/new/x"));
  }
  for (int k = 0; k < 2; k++) { /* a zero byte in a path */
    FILE *f = fopen(ROOT "/journal", "w");

    fwrite(k ? "vanguard commit 1\n0 0 0 1 1\na\n\0\nend\n"
             : "vanguard commit 1\n0 0 0 1 1\n\0\nb\nend\n",
           1, 37, f);
    fclose(f);
    assert_int_equal(vg_journal_read(ROOT "/journal", &j, &err), VG_ERR_FORMAT);
  }
  vg_tree_remove(ROOT);
}

/* In memory if possible: the test makes a million files. */
static void enter_scratch(char path[400])
{
  snprintf(path, 400, "/dev/shm/vanguard-test-commit-%ld", (long)getpid());
  if (mkdir(path, 0777))
    snprintf(path, 400, "%s/commit_scratch", VG_TMP_DIR), mkdir(path, 0777);
  if (chdir(path)) exit(1);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_call_fails),
    cmocka_unit_test(power_is_lost),
    cmocka_unit_test(kinds_must_fit),
    cmocka_unit_test(a_second_process_is_refused),
    cmocka_unit_test(remains_are_removed),
    cmocka_unit_test(another_host_without_locks),
    cmocka_unit_test(interrupted_moves_are_noted),
    cmocka_unit_test(a_replaced_lock_is_taken_again),
    cmocka_unit_test(a_lock_without_a_name),
    cmocka_unit_test(every_call_of_a_sweep_fails),
    cmocka_unit_test(old_files_vanish),
    cmocka_unit_test(nothing_to_undo),
    cmocka_unit_test(absolute_targets),
    cmocka_unit_test(journals),
    cmocka_unit_test(damaged_journals_are_refused),
  };
  char scratch[400];
  int failed;

  enter_scratch(scratch);
  failed = cmocka_run_group_tests(tests, NULL, NULL);
  calls_reset();
  vg_tree_remove(scratch);
  return failed;
}
