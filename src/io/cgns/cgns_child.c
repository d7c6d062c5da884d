/* The HDF5 library at work in a process of its own, which a damaged file may
 * end: io/cgns/cgns.h. The child inherits the bytes of the file, and leaves
 * the mesh in memory that both have in common. */
#define _GNU_SOURCE
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/memory.h"
#include "io/cgns/cgns.h"
#include "io/cgns/cgns_read.h"

/* Seconds of one core: HDF5 reads a megabyte in some milliseconds, but may
 * run in circles. */
#define SECONDS(bytes) (60 + (bytes) / 1000000)

struct answer {
  vg_status st;
  struct vg_error err;
  struct vg_mesh m;          /* counts; pointers mean nothing */
};

/* Arrays of a mesh, in the order in which they are handed over. */
enum { N_ARRAY = 10 };

struct array { void **at; size_t n, size; };

static void list_arrays(struct vg_mesh *m, struct array list[N_ARRAY])
{
  const struct array all[N_ARRAY] = {
#define ARRAY(array, count) { (void **)&m->array, m->count, sizeof *m->array }
    ARRAY(point, n_point), ARRAY(tri, n_tri), ARRAY(quad, n_quad),
    ARRAY(tri_patch, n_tri), ARRAY(quad_patch, n_quad), ARRAY(tet, n_tet),
    ARRAY(pyr, n_pyr), ARRAY(pri, n_pri), ARRAY(hex, n_hex),
    ARRAY(patch, n_patch)
#undef ARRAY
  };

  memcpy(list, all, sizeof all);
}

/* --- the child --- */

static int put_all(int fd, const void *data, size_t n)
{
  const char *at = data;

  while (n) {
    ssize_t put = write(fd, at, n);

    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return 0;
    at += put;
    n -= (size_t)put;
  }
  return 1;
}

/* Signals as at the start of a program: the parent's handlers are not ours. */
static void set_limits(pid_t parent, size_t bytes)
{
  static const int reset[] = { SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2,
                               SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL };
  struct rlimit seconds = { SECONDS(bytes), SECONDS(bytes) + 1 };
  struct rlimit none = { 0, 0 };

  for (size_t k = 0; k < sizeof reset / sizeof *reset; k++)
    signal(reset[k], SIG_DFL);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  setrlimit(RLIMIT_CPU, &seconds);
  setrlimit(RLIMIT_CORE, &none);
}

__attribute__((noreturn))
static void be_child(pid_t parent, int fd, struct vg_input *in)
{
  struct answer a = { VG_OK, VG_ERROR_INIT, VG_MESH_INIT };
  struct array list[N_ARRAY];
  int good;

  set_limits(parent, in->size);
  a.st = vg_cgns_take(in, &a.m, &a.err);
  good = put_all(fd, &a, sizeof a);
  list_arrays(&a.m, list);
  for (int i = 0; i < N_ARRAY && good && a.st == VG_OK; i++)
    good = put_all(fd, *list[i].at, list[i].n * list[i].size);
  _exit(!good);
}

/* --- the parent --- */

static int get_all(int fd, off_t *at, void *data, size_t n)
{
  char *to = data;

  while (n) {
    ssize_t got = pread(fd, to, n, *at);

    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return 0;
    to += got;
    *at += got;
    n -= (size_t)got;
  }
  return 1;
}

static vg_status take_answer(int fd, const char *path, struct vg_mesh *out,
                             struct vg_error *err)
{
  struct answer a;
  struct array list[N_ARRAY];
  off_t at = 0;
  vg_status st = VG_OK;

  if (!get_all(fd, &at, &a, sizeof a))
    return vg_fail(err, VG_ERR_MEMORY, "%s: no memory for the mesh", path);
  if (a.st < 0) {
    if (err) *err = a.err;
    return a.st;
  }
  list_arrays(&a.m, list);
  for (int i = 0; i < N_ARRAY; i++) *list[i].at = NULL;
  for (int i = 0; i < N_ARRAY && st == VG_OK; i++) {
    if (!list[i].n) continue;
    *list[i].at = vg_alloc(list[i].n, list[i].size);
    if (!*list[i].at ||
        !get_all(fd, &at, *list[i].at, list[i].n * list[i].size))
      st = vg_fail(err, VG_ERR_MEMORY, "%s: no memory for the mesh", path);
  }
  if (st == VG_OK) vg_mesh_move(out, &a.m);
  vg_mesh_release(&a.m);
  return st;
}

static vg_status wait_for(pid_t pid, const char *path, struct vg_error *err)
{
  int status = 0;

  while (waitpid(pid, &status, 0) < 0)
    if (errno != EINTR)
      return vg_fail(err, VG_ERR_IO, "%s: the process that reads it is lost: "
                     "%s", path, strerror(errno));
  if (WIFEXITED(status) && !WEXITSTATUS(status)) return VG_OK;
  if (WIFEXITED(status))
    return vg_fail(err, VG_ERR_MEMORY, "%s: no memory for the mesh", path);
  return vg_fail(err, VG_ERR_FORMAT, "%s: the HDF5 library came to grief over "
                 "it (%s): the file is damaged", path,
                 strsignal(WTERMSIG(status)));
}

static vg_status read_apart(struct vg_input *in, struct vg_mesh *out,
                            struct vg_error *err)
{
  int fd = memfd_create("vanguard-cgns", MFD_CLOEXEC);
  pid_t parent = getpid(), pid = fd < 0 ? -1 : fork();
  vg_status st;

  if (pid == 0) be_child(parent, fd, in);
  if (pid < 0) {
    st = vg_fail(err, VG_ERR_MEMORY, "%s: the system refuses a process to read "
                 "it: %s", in->path, strerror(errno));
  } else {
    st = wait_for(pid, in->path, err);
    if (st == VG_OK) st = take_answer(fd, in->path, out, err);
  }
  if (fd >= 0) close(fd);
  return st;
}

/* HDF5 files begin with their mark, or behind a block of somebody's own. */
static int is_hdf5(const struct vg_input *in)
{
  static const char mark[8] = "\x89HDF\r\n\x1a\n";

  for (size_t at = 0; at + sizeof mark <= in->size; at = at ? 2 * at : 512)
    if (!memcmp(in->data + at, mark, sizeof mark)) return 1;
  return 0;
}

vg_status vg_cgns_parse(struct vg_input *in, struct vg_mesh *out,
                        struct vg_error *err)
{
  static const char adf[] = "ADF Database";

  if (is_hdf5(in)) return read_apart(in, out, err);
  if (memmem(in->data, in->size < 64 ? in->size : 64, adf, sizeof adf - 1))
    return vg_fail(err, VG_ERR_UNSUPPORTED, "%s: CGNS in ADF; convert it to "
                   "HDF5 with `adf2hdf FILE NEW` of the CGNS tools", in->path);
  return vg_fail(err, VG_ERR_FORMAT, "%s: not a CGNS file: neither HDF5 nor "
                 "ADF", in->path);
}

vg_status vg_cgns_read(const char *path, struct vg_mesh *out,
                       struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st == VG_OK) st = vg_cgns_parse(&in, out, err);
  vg_input_release(&in);
  return st;
}
