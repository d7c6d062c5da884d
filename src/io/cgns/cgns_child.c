/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Runs the HDF5 library in a child process, which a damaged file may crash or
 * keep in an endless loop; see io/cgns/cgns.h. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/child.h"
#include "base/memory.h"
#include "io/cgns/cgns.h"
#include "io/cgns/cgns_read.h"

/* Limit of CPU time in seconds. HDF5 reads a megabyte in some milliseconds, but
 * may enter an endless loop. */
#define SECONDS(bytes) (60 + (bytes) / 1000000)

struct answer {
  vg_status st;
  struct vg_error err;
  struct vg_mesh m; /* only the counts are used, not the pointers */
  size_t n_value;   /* [points], or 0 without a field */
};

/* Arrays of a mesh, in the order in which they are sent. */
enum { N_ARRAY = 11 };

struct array {
  void **at;
  size_t n, size;
};

static void list_arrays(struct vg_mesh *m, struct array list[N_ARRAY])
{
  const struct array all[N_ARRAY] = {
#define ARRAY(array, count) { (void **)&m->array, m->count, sizeof *m->array }
    ARRAY(point, n_point),   ARRAY(tri, n_tri),         ARRAY(quad, n_quad),
    ARRAY(tri_patch, n_tri), ARRAY(quad_patch, n_quad), ARRAY(tet, n_tet),
    ARRAY(pyr, n_pyr),       ARRAY(pri, n_pri),         ARRAY(hex, n_hex),
    ARRAY(patch, n_patch),   ARRAY(zone, n_zone)
#undef ARRAY
  };

  memcpy(list, all, sizeof all);
}

/* --- the child --- */

struct question {
  size_t n_path, size, n_field;
};

/* Receive the path and the bytes of the file, and the name of the field, if
 * one is asked for. */
static int get_input(int fd, struct vg_input *in, char **field)
{
  struct question q;
  char *path;
  void *data;
  int good;

  if (!vg_child_get(fd, &q, sizeof q)) return 0;
  path = vg_alloc(q.n_path, 1);
  data = vg_alloc(q.size, 1);
  *field = q.n_field ? vg_alloc(q.n_field, 1) : NULL;
  good = path && data && (*field || !q.n_field) &&
         vg_child_get(fd, path, q.n_path) && vg_child_get(fd, data, q.size) &&
         (!*field || vg_child_get(fd, *field, q.n_field));
  if (good) {
    in->path = path;
    in->data = data;
    in->size = q.size;
  }
  return good;
}

__attribute__((noreturn)) static void serve(int fd)
{
  struct vg_input in = VG_INPUT_INIT;
  struct answer a = { VG_OK, VG_ERROR_INIT, VG_MESH_INIT, 0 };
  struct array list[N_ARRAY];
  const struct rlimit no_file = { 0, 0 };
  struct rlimit seconds;
  char *field;
  double *value = NULL;
  int good;

  if (!get_input(fd, &in, &field)) _exit(1);
  seconds.rlim_cur = seconds.rlim_max = SECONDS(in.size);
  setrlimit(RLIMIT_CPU, &seconds);
  setrlimit(RLIMIT_NOFILE, &no_file); /* HDF5 opens no other file */
  a.st = vg_cgns_take(&in, &a.m, &a.err);
  if (a.st == VG_OK && field) {
    a.st = vg_cgns_take_solution(&in, field, a.m.n_point, &value, &a.err);
    a.n_value = a.m.n_point;
  }
  good = vg_child_put(fd, &a, sizeof a);
  list_arrays(&a.m, list);
  for (int i = 0; i < N_ARRAY && good && a.st == VG_OK; i++)
    good = vg_child_put(fd, *list[i].at, list[i].n * list[i].size);
  if (good && a.st == VG_OK)
    good = vg_child_put(fd, value, a.n_value * sizeof *value);
  _exit(!good);
}

/* --- the parent --- */

static vg_status is_lost(const char *path, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: the HDF5 library crashed while reading the file: it "
                 "is damaged, or there is not enough memory",
                 path);
}

/* value: NULL without a field. */
static vg_status take_answer(int fd, const char *path, struct vg_mesh *out,
                             double **value, struct vg_error *err)
{
  struct answer a;
  struct array list[N_ARRAY];
  vg_status st = VG_OK;

  if (!vg_child_get(fd, &a, sizeof a)) return is_lost(path, err);
  if (a.st < 0) {
    if (err) *err = a.err;
    return a.st;
  }
  list_arrays(&a.m, list);
  for (int i = 0; i < N_ARRAY; i++) *list[i].at = NULL;
  for (int i = 0; i < N_ARRAY && st == VG_OK; i++) {
    if (!list[i].n) continue;
    *list[i].at = vg_alloc(list[i].n, list[i].size);
    if (!*list[i].at) st = vg_fail_memory(err, path);
    else if (!vg_child_get(fd, *list[i].at, list[i].n * list[i].size))
      st = is_lost(path, err);
  }
  if (st == VG_OK && value) {
    *value = vg_alloc(a.n_value, sizeof **value);
    if (!*value) st = vg_fail_memory(err, path);
    else if (!vg_child_get(fd, *value, a.n_value * sizeof **value)) {
      free(*value);
      st = is_lost(path, err);
    }
  }
  if (st == VG_OK) vg_mesh_move(out, &a.m);
  vg_mesh_release(&a.m);
  return st;
}

static vg_status read_apart(struct vg_input *in, const char *field,
                            struct vg_mesh *out, double **value,
                            struct vg_error *err)
{
  struct question q = { strlen(in->path) + 1, in->size,
                        field ? strlen(field) + 1 : 0 };
  struct vg_child c;
  vg_status st;

  if (vg_child_open(serve, &c) < 0)
    return vg_fail(err, VG_ERR_MEMORY,
                   "%s: the system refuses to start a process that reads "
                   "the file",
                   in->path);
  if (vg_child_put(c.fd, &q, sizeof q) &&
      vg_child_put(c.fd, in->path, q.n_path) &&
      vg_child_put(c.fd, in->data, q.size) &&
      (!field || vg_child_put(c.fd, field, q.n_field)))
    st = take_answer(c.fd, in->path, out, value, err);
  else st = is_lost(in->path, err);
  vg_child_close(&c);
  return st;
}

/* HDF5 files begin with a signature, or contain it after a user block. */
static int is_hdf5(const struct vg_input *in)
{
  static const char mark[8] = "\x89HDF\r\n\x1a\n";

  for (size_t at = 0; at + sizeof mark <= in->size; at = at ? 2 * at : 512)
    if (!memcmp(in->data + at, mark, sizeof mark)) return 1;
  return 0;
}

static vg_status parse(struct vg_input *in, const char *field,
                       struct vg_mesh *out, double **value,
                       struct vg_error *err)
{
  static const char adf[] = "ADF Database";

  if (is_hdf5(in)) return read_apart(in, field, out, value, err);
  if (memmem(in->data, in->size < 64 ? in->size : 64, adf, sizeof adf - 1))
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: this CGNS file is in ADF, not in HDF5; convert it "
                   "with `adf2hdf FILE NEW.cgns` (Debian's package "
                   "cgns-convert), or with `cgnsconvert -h FILE NEW.cgns`, "
                   "and use NEW.cgns instead",
                   in->path);
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: this is not a CGNS file: neither HDF5 nor ADF", in->path);
}

vg_status vg_cgns_parse(struct vg_input *in, struct vg_mesh *out,
                        struct vg_error *err)
{
  return parse(in, NULL, out, NULL, err);
}

vg_status vg_cgns_solution_parse(struct vg_input *in, const char *name,
                                 struct vg_mesh *out, double **value,
                                 struct vg_error *err)
{
  return parse(in, name, out, value, err);
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
