/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "output_calls.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/helper/helper.h"
#include "base/memory.h"
#include "io/mesh/foam.h"
#include "io/mesh/format.h"
#include "io/mesh/ugrid.h"
#include "io/periodic/periodic_cfg.h"
#include "io/plane/plane.h"
#include "io/slices/slices.h"
#include "io/stream/sheet_file.h"
#include "io/vgrid/mapbc.h"
#include "partition/store/store.h"
#include "run/commit/commit.h"
#include "run/layers/layers.h"
#include "run/settings/deck.h"

struct calls calls;

void calls_reset(void)
{
  memset(&calls, 0, sizeof calls);
}

static int fails(void)
{
  if (!calls.is_on) return 0;
  ++calls.n;
  if (!calls.at || calls.n < calls.at) return 0;
  if (calls.n > calls.at && !calls.is_sticky) return 0;
  errno = EIO;
  return 1;
}

/* --- memory and files ----------------------------------------------------- */

#include "failing_calls.h"

FAILS(char *, strdup, (const char *text), (text), NULL)
FAILS(char *, strndup, (const char *text, size_t n), (text, n), NULL)
FAILS_MEMORY
FAILS(char *, vg_slices_piece, (const char *stem, size_t k), (stem, k), NULL)
FAILS(int, vg_digest_file, (int fd, struct vg_digest *d, uint64_t *bytes),
      (fd, d, bytes), -1)

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

int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...)
{
  va_list args;
  mode_t mode = 0;

  if (flags & O_CREAT) {
    va_start(args, flags);
    mode = va_arg(args, mode_t);
    va_end(args);
  }
  return fails() ? -1 : __real_open(path, flags, mode);
}

/* Replaces that of the C library; test_commit tests the use of it. */
int fsync(int fd)
{
  (void)fd;
  return 0;
}

/* --- writers and ranks ---------------------------------------------------- */

#define STATUS(name, parameters, arguments)                                    \
  vg_status __real_##name parameters;                                          \
  vg_status __wrap_##name parameters;                                          \
  vg_status __wrap_##name parameters                                           \
  {                                                                            \
    if (fails()) return vg_fail(err, VG_ERR_IO, "no " #name);                  \
    return calls.is_guest ? VG_OK : __real_##name arguments;                   \
  }

STATUS(vg_slices_ugrid_open,
       (struct vg_comm * comm, const struct vg_slices *s, const char *path,
        const struct vg_slices_options *o, struct vg_slices_ugrid **out,
        struct vg_error *err),
       (comm, s, path, o, out, err))
STATUS(vg_slices_ugrid_put,
       (void *ugrid, const struct vg_slice *slice, struct vg_error *err),
       (ugrid, slice, err))
STATUS(vg_slices_write_with,
       (struct vg_comm * comm, const struct vg_slices *s, const char *stem,
        const char *form, const struct vg_slices_options *o,
        struct vg_error *err),
       (comm, s, stem, form, o, err))
STATUS(vg_slices_boundary,
       (struct vg_comm * comm, const struct vg_slices *s, int threads,
        struct vg_mesh *out, struct vg_error *err),
       (comm, s, threads, out, err))
STATUS(vg_slices_gather,
       (struct vg_comm * comm, const struct vg_slices *s, int threads,
        struct vg_mesh *out, uint32_t **part, struct vg_error *err),
       (comm, s, threads, out, part, err))
STATUS(vg_format_write,
       (const char *path, const struct vg_mesh *m, struct vg_error *err),
       (path, m, err))
STATUS(vg_ugrid_write_tail,
       (const char *path, const struct vg_mesh *m, uint64_t n,
        struct vg_error *err),
       (path, m, n, err))
STATUS(vg_foam_write,
       (const char *path, const struct vg_mesh *m,
        const struct vg_foam_options *o, struct vg_error *err),
       (path, m, o, err))
STATUS(vg_foam_write_parts,
       (const char *path, size_t n, const uint32_t *part, size_t n_part,
        struct vg_error *err),
       (path, n, part, n_part, err))
STATUS(vg_mapbc_write,
       (const char *path, const struct vg_mesh *m, enum vg_mapbc_layout layout,
        const char *title, size_t *n_unset, struct vg_error *err),
       (path, m, layout, title, n_unset, err))
STATUS(vg_mapbc_write_output,
       (const char *path, const struct vg_mesh *m, const char *title,
        size_t *n_unset, struct vg_error *err),
       (path, m, title, n_unset, err))
STATUS(vg_mapbc_is_output, (const char *path, int *is, struct vg_error *err),
       (path, is, err))
STATUS(vg_mapbc_read,
       (const char *path, struct vg_mapbc *out, struct vg_error *err),
       (path, out, err))
STATUS(vg_plane_write,
       (const char *path, const char *word, const struct vg_plane_mesh *m,
        struct vg_error *err),
       (path, word, m, err))
STATUS(vg_sheet_file_write,
       (const char *path, const struct vg_mesh *m, uint64_t n_point,
        uint64_t n_cell, struct vg_error *err),
       (path, m, n_point, n_cell, err))
STATUS(vg_periodic_cfg_write,
       (const char *path, const struct vg_mesh *m, size_t n,
        const struct vg_periodic *pair, struct vg_error *err),
       (path, m, n, pair, err))
STATUS(vg_deck_write,
       (const char *path, const struct vg_settings *s, const char *comment,
        enum vg_deck_form part, struct vg_error *err),
       (path, s, comment, part, err))
STATUS(vg_periodic_match,
       (const struct vg_mesh *m, const struct vg_periodic *p, double tolerance,
        struct vg_periodic_match *out, struct vg_error *err),
       (m, p, tolerance, out, err))
STATUS(vg_commit_open,
       (const char *dir, const char *name, vg_commit_note *note, void *user,
        struct vg_commit *out, struct vg_error *err),
       (dir, name, note, user, out, err))
STATUS(vg_commit_add,
       (struct vg_commit * c, enum vg_move_kind kind, const char *from,
        const char *to, struct vg_error *err),
       (c, kind, from, to, err))

/* The status of the other ranks may be worse. */
vg_status __wrap_vg_comm_agree(struct vg_comm *c, vg_status mine,
                               struct vg_error *err);
vg_status __wrap_vg_comm_agree(struct vg_comm *c, vg_status mine,
                               struct vg_error *err)
{
  (void)c;
  if (mine >= 0 && fails())
    return vg_fail(err, VG_ERR_IO, "another rank failed");
  return mine;
}

int __real_vg_comm_rank(const struct vg_comm *c);
int __wrap_vg_comm_rank(const struct vg_comm *c);
int __wrap_vg_comm_rank(const struct vg_comm *c)
{
  return calls.is_guest ? 1 : __real_vg_comm_rank(c);
}

vg_status __wrap_vg_comm_bcast(struct vg_comm *c, int root, struct vg_bytes *b,
                               struct vg_error *err);
vg_status __wrap_vg_comm_bcast(struct vg_comm *c, int root, struct vg_bytes *b,
                               struct vg_error *err)
{
  static const char folder[sizeof(struct vg_periodic)] = "hidden/new";

  (void)c;
  (void)root;
  if (fails()) return vg_fail(err, VG_ERR_IO, "no broadcast");
  if (!calls.is_guest) return VG_OK; /* Guests get a folder, and a pair. */
  b->n = sizeof folder;
  b->data = __real_vg_alloc(1, b->n);
  memcpy(b->data, folder, b->n);
  return VG_OK;
}

vg_status __real_vg_slices_ugrid_close(struct vg_slices_ugrid *u, vg_status st,
                                       struct vg_error *err);
vg_status __wrap_vg_slices_ugrid_close(struct vg_slices_ugrid *u, vg_status st,
                                       struct vg_error *err);
vg_status __wrap_vg_slices_ugrid_close(struct vg_slices_ugrid *u, vg_status st,
                                       struct vg_error *err)
{
  return calls.is_guest ? st : __real_vg_slices_ugrid_close(u, st, err);
}

/* --- what these sources do not need --------------------------------------- */

int __real_vg_cgns_is_built(void);
int __wrap_vg_cgns_is_built(void);
int __wrap_vg_cgns_is_built(void)
{
  return !calls.has_no_cgns && __real_vg_cgns_is_built();
}

void __wrap_vg_helper_find(enum vg_helper_kind kind, struct vg_helper *out);
void __wrap_vg_helper_find(enum vg_helper_kind kind, struct vg_helper *out)
{
  (void)kind;
  *out = (struct vg_helper){ .name = "helper", .identity = "none" };
}

vg_status __wrap_vg_layer_stage_write(const struct vg_layer_stage *s,
                                      const struct vg_mesh *surface,
                                      const char *path, struct vg_error *err);
vg_status __wrap_vg_layer_stage_write(const struct vg_layer_stage *s,
                                      const struct vg_mesh *surface,
                                      const char *path, struct vg_error *err)
{
  FILE *f = fails() ? NULL : fopen(path, "w");

  (void)s;
  (void)surface;
  if (!f) return vg_fail(err, VG_ERR_IO, "no walls");
  fclose(f);
  return VG_OK;
}
