/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/slices/slices_parts.h"
#include "io/stream/shared_file.h"

#define BLOCK 3840 /* a multiple of 3, 4, 5, 6 and 8 */

struct vg_slices_ugrid {
  struct vg_ugrid_kind kind;
  struct vg_mesh mesh; /* frame of the file */
  uint64_t count[7];
  size_t n_layer_tet;
  const size_t *tail; /* NULL: no tail */
  struct vg_slice_file file;
  struct vg_shared_file *to;
  struct vg_comm *comm;
  /* For 4-byte reals, the effects of rounding are recorded. Points that
   * coincide while cells stay positive are on the boundary, on two sides of a
   * thin body. */
  int is_narrow;
  atomic_flag busy; /* spin lock of `narrow` */
  struct vg_narrow narrow;
  struct vg_boundary_points boundary;
};

static void put_frame(const void *of, struct vg_output *out)
{
  const struct vg_slices_ugrid *u = of;

  vg_ugrid_put(out, &u->kind, &u->mesh, u->tail);
}

static void put_points(const struct vg_slices_ugrid *u,
                       const struct vg_slice *slice, struct vg_output *out)
{
  double x[BLOCK / 3][3];

  vg_ugrid_seek(out, &u->kind, u->count, 0, slice->point_at);
  for (size_t k = 0, n; k < slice->n_own; k += n) {
    n = slice->n_own - k < BLOCK / 3 ? slice->n_own - k : BLOCK / 3;
    vg_slice_points(slice, k, n, x);
    vg_ugrid_put_points(out, &u->kind, n, (const double(*)[3])x);
  }
}

static void put_cells(const struct vg_slices_ugrid *u,
                      const struct vg_slice *slice, int kind,
                      struct vg_output *out)
{
  const uint32_t *node = slice->cell[kind];
  size_t n = vg_slice_width[kind] * slice->n_cell[kind];
  uint32_t block[BLOCK];

  vg_ugrid_seek(out, &u->kind, u->count, 3 + kind, slice->cell_at[kind]);
  for (size_t i = 0, m; i < n; i += m) {
    m = n - i < BLOCK ? n - i : BLOCK;
    for (size_t k = 0; k < m; k++) block[k] = slice->id[node[i + k]];
    vg_ugrid_put_nodes(out, &u->kind, m, block);
  }
}

static void put_slice(void *of, const struct vg_slice *slice,
                      struct vg_output *out)
{
  const struct vg_slices_ugrid *u = of;

  put_points(u, slice, out);
  for (int k = 0; k < VG_SLICE_KINDS; k++) put_cells(u, slice, k, out);
}

/* --- rounding ------------------------------------------------------------ */

static vg_status note_rounded(struct vg_slices_ugrid *u,
                              const struct vg_slice *slice,
                              struct vg_error *err)
{
  double(*rounded)[3] = vg_alloc(slice->n_point, sizeof *rounded);
  struct vg_narrow n = VG_NARROW_INIT;

  if (!rounded) return vg_fail_memory(err, "the points of a slice");
  vg_narrow_round(slice->n_point, slice->x, rounded);
  for (int k = 0; k < VG_SLICE_KINDS; k++)
    vg_narrow_cells(slice->x, (const double(*)[3])rounded, k, slice->n_cell[k],
                    slice->cell[k], slice->cell_at[k], &n);
  free(rounded);
  vg_boundary_points_add(&u->boundary, slice);
  /* held for a few stores only */
  while (atomic_flag_test_and_set(&u->busy)) continue;
  vg_narrow_add(&u->narrow, &n);
  atomic_flag_clear(&u->busy);
  return VG_OK;
}

/* Collective. */
static vg_status accept_rounded(struct vg_slices_ugrid *u, vg_status st,
                                struct vg_error *err)
{
  VG_TRY(vg_comm_agree(u->comm, st, err));
  VG_TRY(vg_narrow_share(u->comm, &u->narrow, err));
  VG_TRY(vg_boundary_points_share(u->comm, &u->boundary, err));
  VG_TRY(vg_narrow_points(u->boundary.n, (const double(*)[3])u->boundary.x,
                          &u->narrow, err));
  st = vg_ugrid_accept(&u->kind, &u->narrow, err);
done:
  return st;
}

static void release(struct vg_slices_ugrid *u)
{
  if (u) vg_boundary_points_release(&u->boundary);
  free(u);
}

/* --- the file ------------------------------------------------------------ */

int vg_slices_is_ugrid(const char *form)
{
  struct vg_ugrid_kind kind;

  return vg_ugrid_kind(form, &kind) && !kind.is_text;
}

static vg_status new_ugrid(const struct vg_slices *s, const char *path,
                           const struct vg_slices_options *o,
                           struct vg_slices_ugrid **out, struct vg_error *err)
{
  struct vg_slices_ugrid *u = vg_calloc(1, sizeof *u);
  vg_status st;

  if (!u) return vg_fail_memory(err, "a file in slices");
  u->mesh = vg_slices_frame(s);
  u->count[0] = s->n_point;
  u->count[1] = u->mesh.n_tri;
  u->count[2] = u->mesh.n_quad;
  for (int k = 0; k < VG_SLICE_KINDS; k++) u->count[3 + k] = s->n_cell[k];
  u->n_layer_tet = (size_t)s->n_layer_cell[VG_SLICE_TET];
  if (o->tail) u->tail = &u->n_layer_tet;
  u->file = (struct vg_slice_file){ path, o->record_limit, u, put_frame,
                                    put_slice };
  vg_ugrid_kind(path, &u->kind);
  st = vg_ugrid_check(path, &u->kind, &u->mesh, u->tail, err);
  if (st >= 0 && u->kind.real_size == 4) {
    u->is_narrow = 1;
    atomic_flag_clear(&u->busy);
    st = vg_boundary_points_new(s, &u->boundary, err);
  }
  if (st < 0) release(u);
  else *out = u;
  return st;
}

vg_status vg_slices_ugrid_open(struct vg_comm *comm, const struct vg_slices *s,
                               const char *path,
                               const struct vg_slices_options *o,
                               struct vg_slices_ugrid **out,
                               struct vg_error *err)
{
  assert(path && o && out);

  struct vg_slices_ugrid *u = NULL;
  vg_status st = vg_comm_agree(comm, new_ugrid(s, path, o, &u, err), err);

  if (st >= 0) st = vg_slice_file_open(&u->file, comm, &u->to, err);
  if (st < 0) {
    release(u);
    return st;
  }
  u->comm = comm;
  if (!vg_comm_rank(comm)) st = vg_slice_file_put(&u->file, u->to, NULL, err);
  st = vg_comm_agree(comm, st, err);
  if (st < 0) return vg_slices_ugrid_close(u, st, err);
  u->file.path = NULL; /* owned by the caller */
  *out = u;
  return VG_OK;
}

vg_status vg_slices_ugrid_put(void *ugrid, const struct vg_slice *slice,
                              struct vg_error *err)
{
  assert(ugrid && slice);

  struct vg_slices_ugrid *u = ugrid;
  vg_status st = u->is_narrow ? note_rounded(u, slice, err) : VG_OK;

  return st < 0 ? st : vg_slice_file_put(&u->file, u->to, slice, err);
}

vg_status vg_slices_ugrid_close(struct vg_slices_ugrid *u, vg_status st,
                                struct vg_error *err)
{
  if (u->is_narrow) st = accept_rounded(u, st, err);
  st = vg_shared_close(u->to, st, err);
  release(u);
  return st;
}
