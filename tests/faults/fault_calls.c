/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Loaded with LD_PRELOAD: one call of the C library fails, chosen by the stack
 * from which it is called.
 *
 * A call counts if its caller is a program or library of Vanguard, directly or
 * through the C library, the C++ library, Jansson or zlib. Its site is a hash
 * of the function and of the VG_FAULT_DEPTH nearest return addresses in code of
 * Vanguard; the same address several times in a row (a recursion) counts once.
 * Sites do not depend on addresses of a process, on threads or on timing.
 *
 *   VG_FAULT_RECORD  file to which each process appends its sites, one a line:
 *                    hash, function, module+offset of each frame
 *   VG_FAULT_SITE    the first call at this site, in any of the processes of a
 *                    run, fails
 *   VG_FAULT_STATE   file of 8 bytes that the processes of the run share: its
 *                    first byte is 1 after the failure
 *   VG_FAULT_STICKY  1: all later calls of the same class fail, too
 *
 * fsync succeeds without an effect, as the runs are many. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_FRAMES = 40, MAX_DEPTH = 16, MAX_RANGES = 200, TABLE = 1 << 16 };

enum owner { OTHER, OURS, TRANSPARENT };

/* Classes of calls for sticky failures. Calls that only clean up, or only
 * read, fail once at most: a program whose cleanup fails can leave files. */
enum class { MEMORY, FILES, PROCESSES, ONCE };

static struct range {
  uintptr_t from, to;
  uintptr_t base;
  char name[64];
  enum owner owner;
} range[MAX_RANGES];
static atomic_int n_range;
static pthread_mutex_t range_lock = PTHREAD_MUTEX_INITIALIZER;
static unsigned long long n_added;

static int is_ready, depth = 4, record_fd = -1, is_sticky;
static uint64_t chosen;
static atomic_uchar *state; /* [0]: failed; [1]: its class */
static _Atomic uint64_t seen[TABLE];
static __thread int is_busy __attribute__((tls_model("initial-exec")));

void *__libc_malloc(size_t n);
void *__libc_calloc(size_t n, size_t size);
void *__libc_realloc(void *block, size_t n);
void *__libc_memalign(size_t alignment, size_t n);

/* --- modules ------------------------------------------------------------- */

static enum owner owner_of(const char *name, const char *self)
{
  static const char *const through[] = { "libc.so",    "libstdc++",
                                         "libpthread", "libjansson",
                                         "libz.so",    "libgcc_s" };

  if (!strncmp(name, self, strlen(self))) return TRANSPARENT;
  if (!strncmp(name, "vanguard", 8) || !strncmp(name, "libvanguard", 11) ||
      !strncmp(name, "libvg_", 6) || !strncmp(name, "fault_", 6))
    return OURS;
  for (size_t i = 0; i < sizeof through / sizeof *through; i++)
    if (!strncmp(name, through[i], strlen(through[i]))) return TRANSPARENT;
  return OTHER;
}

static int add_module(struct dl_phdr_info *info, size_t size, void *data)
{
  const char *path = info->dlpi_name, *name;
  char exe[256];
  ssize_t n;

  (void)size;
  (void)data;
  n_added = info->dlpi_adds;
  if (!*path) {
    n = readlink("/proc/self/exe", exe, sizeof exe - 1);
    exe[n > 0 ? n : 0] = 0;
    path = exe;
  }
  name = strrchr(path, '/');
  name = name ? name + 1 : path;
  for (int i = 0; i < info->dlpi_phnum; i++) {
    const ElfW(Phdr) *p = info->dlpi_phdr + i;
    int k = n_range;

    if (p->p_type != PT_LOAD || !(p->p_flags & PF_X) || k == MAX_RANGES)
      continue;
    range[k].base = info->dlpi_addr;
    range[k].from = info->dlpi_addr + p->p_vaddr;
    range[k].to = range[k].from + p->p_memsz;
    snprintf(range[k].name, sizeof range[k].name, "%.60s", name);
    range[k].owner = owner_of(name, "fault_calls.so");
    n_range = k + 1;
  }
  return 0;
}

static const struct range *find_in_list(uintptr_t address)
{
  for (int i = 0, n = n_range; i < n; i++)
    if (address >= range[i].from && address < range[i].to) return range + i;
  return NULL;
}

static int count_modules(struct dl_phdr_info *info, size_t size, void *data)
{
  (void)size;
  *(unsigned long long *)data = info->dlpi_adds;
  return 1;
}

/* NULL: in no module, as generated code. */
static const struct range *find_range(uintptr_t address)
{
  const struct range *r = find_in_list(address);
  unsigned long long now = 0;

  if (r) return r;
  pthread_mutex_lock(&range_lock);
  dl_iterate_phdr(count_modules, &now);
  if (now != n_added) dl_iterate_phdr(add_module, NULL);
  pthread_mutex_unlock(&range_lock);
  return find_in_list(address);
}

/* --- sites --------------------------------------------------------------- */

static uint64_t mix(uint64_t hash, uint64_t value)
{
  hash = (hash ^ value) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 29);
}

static uint64_t mix_text(uint64_t hash, const char *text)
{
  while (*text) hash = mix(hash, (unsigned char)*text++);
  return hash;
}

static int is_new(uint64_t hash)
{
  for (size_t k = hash % TABLE, tries = 0; tries < TABLE; tries++) {
    uint64_t old = 0;

    if (atomic_compare_exchange_strong(seen + k, &old, hash)) return 1;
    if (old == hash) return 0;
    k = (k + 1) % TABLE;
  }
  return 0;
}

static void record(uint64_t hash, const char *function,
                   const struct range *const *module, const uintptr_t *at,
                   int n)
{
  char line[1024];
  int used;

  if (!is_new(hash)) return;
  used = snprintf(line, sizeof line, "%016llx %s", (unsigned long long)hash,
                  function);
  for (int i = 0; i < n; i++)
    used += snprintf(line + used, sizeof line - (size_t)used, " %s+%llx",
                     module[i]->name,
                     (unsigned long long)(at[i] - module[i]->base));
  line[used++] = '\n';
  (void)!write(record_fd, line, (size_t)used);
}

/* Hash of the site, or 0 if the call does not count. */
static uint64_t site(const char *function)
{
  void *frame[MAX_FRAMES];
  const struct range *module[MAX_DEPTH];
  uintptr_t at[MAX_DEPTH];
  uint64_t hash = mix_text(1, function);
  int n = backtrace(frame, MAX_FRAMES), n_own = 0;

  for (int i = 0; i < n && n_own < depth; i++) {
    /* within the call, also if it is the last instruction of its function */
    uintptr_t address = (uintptr_t)frame[i] - 1;
    const struct range *r = find_range(address);

    if (r && r->owner == TRANSPARENT) continue;
    if (!r || r->owner == OTHER) {
      if (!n_own) return 0;
      continue;
    }
    if (n_own && at[n_own - 1] == address) continue;
    module[n_own] = r;
    at[n_own++] = address;
    hash = mix(mix_text(hash, r->name), address - r->base);
  }
  if (!n_own) return 0;
  hash += !hash;
  if (record_fd >= 0) record(hash, function, module, at, n_own);
  return hash;
}

/* 1: the call fails. `caller` is its return address. */
static int fails(const char *function, enum class class, int error,
                 void *caller)
{
  const struct range *r;
  uint64_t hash;
  int answer = 0;

  if (!is_ready || is_busy || (!chosen && record_fd < 0)) return 0;
  if (state && state[0] && (!is_sticky || state[1] != class)) return 0;
  if (chosen && class == ONCE && state[0]) return 0;
  is_busy = 1;
  r = find_range((uintptr_t)caller - 1);
  if (r && r->owner != OTHER && (hash = site(function))) {
    if (state && state[0]) answer = 1;
    else if (chosen && hash == chosen) {
      state[1] = (unsigned char)class;
      answer = !atomic_exchange(state, 1) || is_sticky;
    }
  }
  is_busy = 0;
  if (answer) errno = error;
  return answer;
}

__attribute__((constructor)) static void start(void)
{
  const char *text;
  void *frame[4];
  int fd;

  is_busy = 1;
  backtrace(frame, 4); /* loads the unwinder */
  dl_iterate_phdr(add_module, NULL);
  if ((text = getenv("VG_FAULT_DEPTH"))) depth = atoi(text);
  if (depth < 1 || depth > MAX_DEPTH) depth = MAX_DEPTH;
  if ((text = getenv("VG_FAULT_STICKY"))) is_sticky = atoi(text);
  if ((text = getenv("VG_FAULT_RECORD"))) {
    fd = open(text, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    record_fd = fd < 0 ? -1 : fcntl(fd, F_DUPFD_CLOEXEC, 900);
    if (fd >= 0) close(fd);
  }
  if ((text = getenv("VG_FAULT_STATE")) &&
      (fd = open(text, O_RDWR | O_CLOEXEC)) >= 0) {
    state = mmap(NULL, 8, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    close(fd);
    if (state != MAP_FAILED && (text = getenv("VG_FAULT_SITE")))
      chosen = strtoull(text, NULL, 16);
    else state = NULL;
  }
  is_busy = 0;
  is_ready = 1;
}

/* --- the calls ----------------------------------------------------------- */

#define FAILS(class, error)                                                    \
  fails(__func__, class, error, __builtin_return_address(0))

/* A function of the C library by its name. */
#define REAL(function)                                                         \
  static __typeof__(function) *real;                                           \
  if (!real) {                                                                 \
    int was_busy = is_busy;                                                    \
    is_busy = 1;                                                               \
    real = dlsym(RTLD_NEXT, #function);                                        \
    is_busy = was_busy;                                                        \
  }

/* The error flag of the stream is set, as ferror(3) must find it. */
static int stream_fails(FILE *file)
{
  enum { ERROR_SEEN = 0x20 }; /* _IO_ERR_SEEN of glibc */

  file->_flags |= ERROR_SEEN;
  return 1;
}

void *malloc(size_t n)
{
  return FAILS(MEMORY, ENOMEM) ? NULL : __libc_malloc(n);
}

void *calloc(size_t n, size_t size)
{
  return FAILS(MEMORY, ENOMEM) ? NULL : __libc_calloc(n, size);
}

void *realloc(void *block, size_t n)
{
  return FAILS(MEMORY, ENOMEM) ? NULL : __libc_realloc(block, n);
}

void *aligned_alloc(size_t alignment, size_t n)
{
  return FAILS(MEMORY, ENOMEM) ? NULL : __libc_memalign(alignment, n);
}

int posix_memalign(void **block, size_t alignment, size_t n)
{
  if (FAILS(MEMORY, ENOMEM)) return ENOMEM;
  *block = __libc_memalign(alignment, n);
  return *block ? 0 : ENOMEM;
}

void *mmap(void *at, size_t n, int protection, int flags, int fd, off_t offset)
{
  REAL(mmap)
  if (FAILS(MEMORY, ENOMEM)) return MAP_FAILED;
  return real(at, n, protection, flags, fd, offset);
}

int memfd_create(const char *name, unsigned flags)
{
  REAL(memfd_create)
  return FAILS(MEMORY, EMFILE) ? -1 : real(name, flags);
}

static mode_t mode_of(int flags, va_list args)
{
  return flags & (O_CREAT | O_TMPFILE) ? va_arg(args, mode_t) : 0;
}

/* Files that are only read, and folders, which are opened for their removal. */
static enum class class_of(int flags) {
  return (flags & O_ACCMODE) == O_RDONLY ? ONCE : FILES;
}

int open(const char *path, int flags, ...)
{
  va_list args;
  mode_t mode;

  REAL(open)
  va_start(args, flags);
  mode = mode_of(flags, args);
  va_end(args);
  return FAILS(class_of(flags), EIO) ? -1 : real(path, flags, mode);
}

int openat(int folder, const char *path, int flags, ...)
{
  va_list args;
  mode_t mode;

  REAL(openat)
  va_start(args, flags);
  mode = mode_of(flags, args);
  va_end(args);
  return FAILS(class_of(flags), EIO) ? -1 : real(folder, path, flags, mode);
}

FILE *fopen(const char *path, const char *how)
{
  REAL(fopen)
  return FAILS(FILES, EIO) ? NULL : real(path, how);
}

DIR *opendir(const char *path)
{
  REAL(opendir)
  return FAILS(ONCE, EIO) ? NULL : real(path);
}

DIR *fdopendir(int fd)
{
  REAL(fdopendir)
  return FAILS(ONCE, EIO) ? NULL : real(fd);
}

ssize_t read(int fd, void *data, size_t n)
{
  REAL(read)
  return FAILS(ONCE, EIO) ? -1 : real(fd, data, n);
}

ssize_t pread(int fd, void *data, size_t n, off_t at)
{
  REAL(pread)
  return FAILS(ONCE, EIO) ? -1 : real(fd, data, n, at);
}

size_t fread(void *data, size_t size, size_t n, FILE *file)
{
  REAL(fread)
  return FAILS(ONCE, EIO) && stream_fails(file) ? 0 : real(data, size, n, file);
}

ssize_t write(int fd, const void *data, size_t n)
{
  REAL(write)
  return fd != STDERR_FILENO && FAILS(FILES, ENOSPC) ? -1 : real(fd, data, n);
}

ssize_t pwrite(int fd, const void *data, size_t n, off_t at)
{
  REAL(pwrite)
  return FAILS(FILES, ENOSPC) ? -1 : real(fd, data, n, at);
}

size_t fwrite(const void *data, size_t size, size_t n, FILE *file)
{
  REAL(fwrite)
  if (file != stderr && FAILS(FILES, ENOSPC) && stream_fails(file)) return 0;
  return real(data, size, n, file);
}

int fflush(FILE *file)
{
  REAL(fflush)
  if (file && file != stderr && FAILS(FILES, ENOSPC) && stream_fails(file))
    return EOF;
  return real(file);
}

int fclose(FILE *file)
{
  int fails_now = FAILS(ONCE, ENOSPC), status;

  REAL(fclose)
  status = real(file);
  if (!fails_now) return status;
  errno = ENOSPC;
  return EOF;
}

int close(int fd)
{
  int fails_now = FAILS(ONCE, EIO), status;

  REAL(close)
  status = real(fd);
  if (!fails_now) return status;
  errno = EIO;
  return -1;
}

int fsync(int fd)
{
  (void)fd;
  return FAILS(FILES, EIO) ? -1 : 0;
}

int ftruncate(int fd, off_t n)
{
  REAL(ftruncate)
  return FAILS(FILES, ENOSPC) ? -1 : real(fd, n);
}

int fallocate(int fd, int how, off_t from, off_t n)
{
  REAL(fallocate)
  return FAILS(FILES, ENOSPC) ? -1 : real(fd, how, from, n);
}

int mkdir(const char *path, mode_t mode)
{
  REAL(mkdir)
  return FAILS(FILES, ENOSPC) ? -1 : real(path, mode);
}

int mkdirat(int folder, const char *path, mode_t mode)
{
  REAL(mkdirat)
  return FAILS(FILES, ENOSPC) ? -1 : real(folder, path, mode);
}

int mkstemp(char *path)
{
  REAL(mkstemp)
  return FAILS(FILES, ENOSPC) ? -1 : real(path);
}

int mkostemp(char *path, int flags)
{
  REAL(mkostemp)
  return FAILS(FILES, ENOSPC) ? -1 : real(path, flags);
}

int rename(const char *a, const char *b)
{
  REAL(rename)
  return FAILS(FILES, EIO) ? -1 : real(a, b);
}

int renameat(int da, const char *a, int db, const char *b)
{
  REAL(renameat)
  return FAILS(FILES, EIO) ? -1 : real(da, a, db, b);
}

int renameat2(int da, const char *a, int db, const char *b, unsigned flags)
{
  REAL(renameat2)
  return FAILS(FILES, EIO) ? -1 : real(da, a, db, b, flags);
}

int link(const char *a, const char *b)
{
  REAL(link)
  return FAILS(FILES, EIO) ? -1 : real(a, b);
}

int unlink(const char *path)
{
  REAL(unlink)
  return FAILS(ONCE, EIO) ? -1 : real(path);
}

int unlinkat(int folder, const char *path, int flags)
{
  REAL(unlinkat)
  return FAILS(ONCE, EIO) ? -1 : real(folder, path, flags);
}

int rmdir(const char *path)
{
  REAL(rmdir)
  return FAILS(ONCE, EIO) ? -1 : real(path);
}

pid_t fork(void)
{
  REAL(fork)
  return FAILS(PROCESSES, EAGAIN) ? -1 : real();
}

int pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                   void *(*run)(void *), void *data)
{
  REAL(pthread_create)
  return FAILS(PROCESSES, EAGAIN) ? EAGAIN
                                  : real(thread, attributes, run, data);
}

int pipe2(int fd[2], int flags)
{
  REAL(pipe2)
  return FAILS(PROCESSES, EMFILE) ? -1 : real(fd, flags);
}

int socketpair(int domain, int type, int protocol, int fd[2])
{
  REAL(socketpair)
  return FAILS(PROCESSES, EMFILE) ? -1 : real(domain, type, protocol, fd);
}
