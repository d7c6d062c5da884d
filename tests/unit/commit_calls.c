/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "commit_calls.h"

#include <errno.h>
#include <fcntl.h>
#include <fts.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

enum { MAX_OPS = 4000, PATH = 300, MAX_FILES = 400 };

struct calls calls;

enum kind {
  CREATE,
  WRITE,
  SYNC,
  SYNC_FOLDER,
  RENAME,
  EXCHANGE,
  LINK,
  UNLINK,
  MKDIR,
  RMDIR
};

static struct op {
  enum kind kind;
  char a[PATH], b[PATH]; /* relative to the root; b: target */
  ino_t ino;             /* of a file, or a folder that is made */
  off_t at;
  size_t n;
  char *data;
} op[MAX_OPS];
static size_t n_op;

/* NAME is replaced by __wrap_NAME, which may call __real_NAME. */
#define WRAPPED(type, name, ...)                                               \
  type __real_##name(__VA_ARGS__);                                             \
  type __wrap_##name(__VA_ARGS__);

WRAPPED(int, open, const char *path, int flags, ...)
WRAPPED(ssize_t, write, int fd, const void *data, size_t n)
WRAPPED(ssize_t, pwrite, int fd, const void *data, size_t n, off_t at)
WRAPPED(int, fsync, int fd)
WRAPPED(int, fstat, int fd, struct stat *s)
WRAPPED(int, flock, int fd, int how)
WRAPPED(int, rename, const char *a, const char *b)
WRAPPED(int, renameat2, int da, const char *a, int db, const char *b,
        unsigned flags)
WRAPPED(int, link, const char *a, const char *b)
WRAPPED(int, unlink, const char *a)
WRAPPED(int, openat, int at, const char *path, int flags, ...)
WRAPPED(int, unlinkat, int at, const char *a, int flags)
WRAPPED(int, mkdir, const char *a, mode_t mode)
WRAPPED(int, rmdir, const char *a)
WRAPPED(int, close, int fd)
WRAPPED(int, asprintf, char **text, const char *format, ...)
WRAPPED(FTSENT *, fts_read, FTS *tree)

void calls_reset(void)
{
  while (n_op) free(op[--n_op].data);
  calls.n = calls.fail_at = calls.fails_from = 0;
  calls.before_lock = NULL;
  calls.before_journal = NULL;
  calls.root = NULL;
}

size_t calls_recorded(void)
{
  return n_op;
}

/* 1: this call fails. */
static int fails(void)
{
  ++calls.n;
  if (calls.n != calls.fail_at &&
      !(calls.fails_from && calls.n >= calls.fails_from))
    return 0;
  errno = calls.error ? calls.error : EIO;
  return 1;
}

/* -1 with this errno, or 0 if it is 0. */
static int refuses(int error)
{
  if (error) errno = error;
  return error ? -1 : 0;
}

static void path_of(int fd, char path[2 * PATH])
{
  char link[64];
  ssize_t n;

  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  n = readlink(link, path, 2 * PATH - 1);
  path[n > 0 ? n : 0] = 0;
}

/* --- recording ----------------------------------------------------------- */

static int cut_root(const char *path, char out[PATH])
{
  size_t n = strlen(calls.root);

  out[0] = 0;
  if (strncmp(path, calls.root, n) != 0) return 0;
  snprintf(out, PATH, "%s", path[n] == '/' ? path + n + 1 : path + n);
  return 1;
}

static struct op *record(enum kind kind, const char *a, const char *b)
{
  struct op *o = op + n_op;

  if (!calls.root || n_op == MAX_OPS) return NULL;
  memset(o, 0, sizeof *o);
  o->kind = kind;
  if (a && !cut_root(a, o->a)) return NULL;
  if (b && !cut_root(b, o->b)) return NULL;
  n_op++;
  return o;
}

static ino_t inode(int fd)
{
  struct stat s;

  return __real_fstat(fd, &s) ? 0 : s.st_ino;
}

static int recorded(int result, enum kind kind, const char *a, const char *b)
{
  if (!result) record(kind, a, b);
  return result;
}

/* --- the calls ----------------------------------------------------------- */

int __wrap_open(const char *path, int flags, ...)
{
  va_list args;
  mode_t mode = 0;
  int fd, is_new = access(path, F_OK) != 0;
  struct op *o;

  if (flags & O_CREAT) {
    va_start(args, flags);
    mode = va_arg(args, mode_t);
    va_end(args);
  }
  if (fails()) return -1;
  fd = __real_open(path, flags, mode);
  if (fd >= 0 && flags & O_CREAT && is_new && (o = record(CREATE, path, NULL)))
    o->ino = inode(fd);
  return fd;
}

/* Of the calls with a folder, those for locks are recorded. */
static int is_lock(int at, const char *path)
{
  size_t n = strlen(path);

  return at == AT_FDCWD && n > 5 && !strcmp(path + n - 5, "/lock");
}

int __wrap_openat(int at, const char *path, int flags, ...)
{
  va_list args;
  mode_t mode = 0;

  if (flags & O_CREAT) {
    va_start(args, flags);
    mode = va_arg(args, mode_t);
    va_end(args);
  }
  if (is_lock(at, path)) return __wrap_open(path, flags, mode);
  return fails() ? -1 : __real_openat(at, path, flags, mode);
}

static void record_write(int fd, const void *data, ssize_t n, off_t at)
{
  struct op *o = n > 0 ? record(WRITE, NULL, NULL) : NULL;

  if (!o) return;
  o->ino = inode(fd);
  o->at = at;
  o->n = (size_t)n;
  o->data = malloc(o->n);
  memcpy(o->data, data, o->n);
}

ssize_t __wrap_write(int fd, const void *data, size_t n)
{
  off_t at = lseek(fd, 0, SEEK_CUR);
  ssize_t put;

  if (fails()) return calls.error ? -1 : 0;
  put = __real_write(fd, data, n);
  record_write(fd, data, put, at);
  return put;
}

ssize_t __wrap_pwrite(int fd, const void *data, size_t n, off_t at)
{
  ssize_t put;

  if (fails()) return calls.error ? -1 : 0;
  put = __real_pwrite(fd, data, n, at);
  record_write(fd, data, put, at);
  return put;
}

int __wrap_fsync(int fd)
{
  char path[2 * PATH], here[PATH];
  struct stat s;
  struct op *o;

  if (fails()) return -1;
  if (__real_fstat(fd, &s)) return 0;
  if (S_ISDIR(s.st_mode) && refuses(calls.no_folder_sync)) return -1;
  if (!calls.root) return 0;
  if (!S_ISDIR(s.st_mode)) {
    if ((o = record(SYNC, NULL, NULL))) o->ino = s.st_ino;
    return 0;
  }
  path_of(fd, path);
  if (getcwd(here, sizeof here) && !strncmp(path, here, strlen(here)))
    record(SYNC_FOLDER, path + strlen(here) + 1, NULL);
  return 0;
}

int __wrap_flock(int fd, int how)
{
  char path[2 * PATH];

  if (fails() || refuses(calls.no_lock)) return -1;
  path_of(fd, path);
  if (calls.before_lock) calls.before_lock(path);
  return __real_flock(fd, how);
}

int __wrap_rename(const char *a, const char *b)
{
  const char *name = strrchr(b, '/');

  if (fails()) return -1;
  if (calls.before_journal && name && !strcmp(name, "/journal"))
    calls.before_journal();
  return recorded(__real_rename(a, b), RENAME, a, b);
}

int __wrap_renameat2(int da, const char *a, int db, const char *b,
                     unsigned flags)
{
  if (fails() || refuses(calls.no_exchange)) return -1;
  return recorded(__real_renameat2(da, a, db, b, flags), EXCHANGE, a, b);
}

int __wrap_link(const char *a, const char *b)
{
  if (fails() || refuses(calls.no_link)) return -1;
  return recorded(__real_link(a, b), LINK, a, b);
}

int __wrap_unlinkat(int at, const char *a, int flags)
{
  if (is_lock(at, a)) return __wrap_unlink(a);
  return fails() ? -1 : __real_unlinkat(at, a, flags);
}

int __wrap_unlink(const char *a)
{
  return fails() ? -1 : recorded(__real_unlink(a), UNLINK, a, NULL);
}

int __wrap_mkdir(const char *a, mode_t mode)
{
  struct stat s;
  struct op *o;

  if (fails() || __real_mkdir(a, mode)) return -1;
  if ((o = record(MKDIR, a, NULL)) && !stat(a, &s)) o->ino = s.st_ino;
  return 0;
}

int __wrap_rmdir(const char *a)
{
  return fails() ? -1 : recorded(__real_rmdir(a), RMDIR, a, NULL);
}

/* --- calls that are not recorded ------------------------------------------ */

#include "failing_calls.h"

FAILS(int, ftruncate, (int fd, off_t n), (fd, n), -1)
FAILS(int, lstat, (const char *path, struct stat *s), (path, s), -1)
FAILS(int, fstat, (int fd, struct stat *s), (fd, s), -1)
FAILS(int, kill, (pid_t process, int signal), (process, signal), -1)
FAILS(int, fstatat, (int at, const char *path, struct stat *s, int flags),
      (at, path, s, flags), -1)
FAILS(ssize_t, getdents64, (int fd, void *to, size_t n), (fd, to, n), -1)
FAILS(FILE *, fopen, (const char *path, const char *how), (path, how), NULL)
FAILS(int, ferror, (FILE * f), (f), 1)
FAILS(FTS *, fts_open,
      (char *const *path, int how,
       int (*order)(const FTSENT **, const FTSENT **)),
      (path, how, order), NULL)
FAILS(char *, strdup, (const char *text), (text), NULL)
FAILS(FILE *, vg_text_open, (char **text, size_t *n), (text, n), NULL)
FAILS(int, vg_reserve, (void *block, size_t *cap, size_t need, size_t size),
      (block, cap, need, size), -1)
FAILS(struct tm *, localtime_r, (const time_t *t, struct tm *to), (t, to), NULL)

/* A failed close has closed the file. */
int __wrap_close(int fd)
{
  int fault = fails(), error = errno, result = __real_close(fd);

  errno = error;
  return fault ? -1 : result;
}

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

/* A file or folder that cannot be looked up. */
FTSENT *__wrap_fts_read(FTS *tree)
{
  FTSENT *e = __real_fts_read(tree);

  if (!e || !fails()) return e;
  e->fts_errno = errno;
  e->fts_info = e->fts_info == FTS_F ? FTS_NS : FTS_DNR;
  return e;
}

/* --- replay -------------------------------------------------------------- */

static unsigned next_random(unsigned *state)
{
  *state = *state * 1664525u + 1013904223u;
  return *state >> 16;
}

static int is_in_folder(const char *path, const char *folder)
{
  const char *slash = strrchr(path, '/');
  size_t n = slash ? (size_t)(slash - path) : 0;

  return strlen(folder) == n && !strncmp(path, folder, n);
}

/* Is the effect of call i on the disk after n calls? */
static int is_certain(size_t i, size_t n)
{
  const char *name = *op[i].b ? op[i].b : op[i].a;

  for (size_t j = i + 1; j < n; j++) {
    if (op[i].kind == WRITE && op[j].kind == SYNC && op[j].ino == op[i].ino)
      return 1;
    if (op[i].kind != WRITE && op[j].kind == SYNC_FOLDER &&
        is_in_folder(name, op[j].a))
      return 1;
  }
  return 0;
}

static int file[MAX_FILES];
static ino_t inode_of[MAX_FILES]; /* as recorded */
static size_t n_file;
static ino_t folder[MAX_FILES][2]; /* inodes: as recorded, in the replay */
static size_t n_folder;

/* A journal names inodes of folders. */
static char *translate(const struct op *o, size_t *size)
{
  static const char first[] = "vanguard commit";
  char *text = strndup(o->data, o->n), number[32], other[32];

  *size = o->n;
  if (o->n < sizeof first || memcmp(o->data, first, sizeof first - 1) != 0)
    return memcpy(text, o->data, o->n);
  for (size_t k = 0; k < n_folder; k++) {
    char *at, *next;

    snprintf(number, sizeof number, " %llu ", (unsigned long long)folder[k][0]);
    snprintf(other, sizeof other, " %llu ", (unsigned long long)folder[k][1]);
    at = strstr(text, number);
    if (!at) continue;
    *size = (size_t)asprintf(&next, "%.*s%s%s", (int)(at - text), text, other,
                             at + strlen(number));
    free(text);
    text = next;
  }
  return text;
}

/* share: the part that is not torn off, from 0 to 1 */
static void replay_write(const struct op *o, double share)
{
  size_t n;
  char *text;

  for (size_t k = n_file; k-- > 0;)
    if (inode_of[k] == o->ino) {
      text = translate(o, &n);
      n = (size_t)(share * (double)n);
      if (file[k] >= 0) (void)!__real_pwrite(file[k], text, n, o->at);
      free(text);
      return;
    }
}

static void replay_mkdir(const char *path, const struct op *o)
{
  struct stat s;

  if (__real_mkdir(path, 0777) || stat(path, &s) || n_folder == MAX_FILES)
    return;
  folder[n_folder][0] = o->ino;
  folder[n_folder++][1] = s.st_ino;
}

/* Calls that depend on a lost one fail. */
static void replay_one(const char *root, const struct op *o, int is_kept,
                       double share)
{
  char a[2 * PATH], b[2 * PATH];

  snprintf(a, sizeof a, "%s/%s", root, o->a);
  snprintf(b, sizeof b, "%s/%s", root, o->b);
  if (o->kind == CREATE && n_file < MAX_FILES) {
    inode_of[n_file] = o->ino;
    file[n_file++] = is_kept ? __real_open(a, O_RDWR | O_CREAT | O_TRUNC, 0666)
                             : -1;
  }
  if (!is_kept) return;
  if (o->kind == WRITE) replay_write(o, share);
  if (o->kind == RENAME) (void)!__real_rename(a, b);
  if (o->kind == EXCHANGE)
    (void)!__real_renameat2(AT_FDCWD, a, AT_FDCWD, b, RENAME_EXCHANGE);
  if (o->kind == LINK) (void)!__real_link(a, b);
  if (o->kind == UNLINK) (void)!__real_unlink(a);
  if (o->kind == MKDIR) replay_mkdir(a, o);
  if (o->kind == RMDIR) (void)!__real_rmdir(a);
}

void calls_replay(const char *root, size_t n, unsigned way)
{
  unsigned state = 7919 * way + (unsigned)n;

  n_file = n_folder = 0;
  for (size_t i = 0; i < n; i++) {
    double share = 1;
    int is_kept = way == 1 || is_certain(i, n);

    if (!is_kept && way > 1) {
      is_kept = next_random(&state) % 2;
      if (next_random(&state) % 2)
        share = (double)(next_random(&state) % 1000) / 1000;
    }
    replay_one(root, op + i, is_kept, share);
  }
  while (n_file)
    if (file[--n_file] >= 0) close(file[n_file]);
}
