/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/slices.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"

struct each {
  const struct vg_slices *s;
  vg_slice_body body;
  void *context;
  atomic_flag busy;    /* spin lock while a failure is recorded, which is
                          rare */
  atomic_size_t first; /* lowest slice that failed; n_slice if none failed */
  vg_status status;
  struct vg_error err;
};

static void note_failure(struct each *e, size_t i, vg_status st,
                         const struct vg_error *err)
{
  while (atomic_flag_test_and_set(&e->busy)) {
  }
  if (i < e->first) {
    e->first = i;
    e->status = st;
    e->err = *err;
  }
  atomic_flag_clear(&e->busy);
}

static void each_slice(void *context, size_t first, size_t end, int worker)
{
  struct each *e = context;

  (void)worker;
  for (size_t i = first; i < end && i < e->first; i++) {
    struct vg_error err = VG_ERROR_INIT;
    struct vg_slice slice;
    vg_status st = e->s->get(e->s, i, &slice, &err);

    if (st >= 0) {
      assert(slice.n_own <= slice.n_point);
      st = e->body(e->context, &slice, &err);
      e->s->put(e->s, &slice);
    }
    if (st < 0) note_failure(e, i, st, &err);
  }
}

vg_status vg_slices_each(const struct vg_slices *s, int threads,
                         vg_slice_body body, void *context,
                         struct vg_error *err)
{
  assert(s->get && s->put && body);
  assert(threads >= 0);

  struct each e = { s,          body,  context,      ATOMIC_FLAG_INIT,
                    s->n_slice, VG_OK, VG_ERROR_INIT };

  vg_parallel_for(threads, s->n_slice, 1, each_slice, &e);
  if (e.status < 0 && err) *err = e.err;
  return e.status;
}

static void collect_cells(const struct vg_slice *slice, int kind, int width,
                          uint32_t *to)
{
  size_t n = slice->n_cell[kind] * (size_t)width;

  to += slice->cell_at[kind] * (uint64_t)width;
  for (size_t i = 0; i < n; i++) to[i] = slice->id[slice->cell[kind][i]];
}

static vg_status collect_slice(void *context, const struct vg_slice *slice,
                               struct vg_error *err)
{
  struct vg_mesh *m = context;

  (void)err;
  for (size_t k = 0; k < slice->n_own; k++)
    memcpy(m->point[slice->point_at + k], slice->x[slice->own[k]],
           sizeof *m->point);
  collect_cells(slice, VG_SLICE_TET, 4, (uint32_t *)m->tet);
  collect_cells(slice, VG_SLICE_PYR, 5, (uint32_t *)m->pyr);
  collect_cells(slice, VG_SLICE_PRI, 6, (uint32_t *)m->pri);
  collect_cells(slice, VG_SLICE_HEX, 8, (uint32_t *)m->hex);
  return VG_OK;
}

vg_status vg_slices_collect(const struct vg_slices *s, int threads,
                            struct vg_mesh *out, struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  assert(s->boundary && out);
  if (s->n_point >= UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%llu points are too many for a format that needs the "
                   "mesh in one piece; write b8l.ugrid or pvtu",
                   (unsigned long long)s->n_point);
  VG_TRY(vg_mesh_copy(&m, s->boundary, err));
  m.n_point = (size_t)s->n_point;
  m.n_tet = (size_t)s->n_cell[VG_SLICE_TET];
  m.n_pyr = (size_t)s->n_cell[VG_SLICE_PYR];
  m.n_pri = (size_t)s->n_cell[VG_SLICE_PRI];
  m.n_hex = (size_t)s->n_cell[VG_SLICE_HEX];
  m.point = vg_alloc(m.n_point, sizeof *m.point);
  m.tet = vg_alloc(m.n_tet, sizeof *m.tet);
  m.pyr = vg_alloc(m.n_pyr, sizeof *m.pyr);
  m.pri = vg_alloc(m.n_pri, sizeof *m.pri);
  m.hex = vg_alloc(m.n_hex, sizeof *m.hex);
  if (!m.point || !m.tet || !m.pyr || !m.pri || !m.hex)
    st = vg_fail_memory(err, "the mesh as a whole");
  else st = vg_slices_each(s, threads, collect_slice, &m, err);
  if (st >= 0) vg_mesh_move(out, &m);
done:
  vg_mesh_release(&m);
  return st;
}

struct parts {
  const struct vg_slices *s;
  uint32_t *part;
};

static vg_status collect_parts(void *context, const struct vg_slice *slice,
                               struct vg_error *err)
{
  const struct parts *p = context;
  uint64_t first = 0;

  (void)err;
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    if (slice->n_cell[k])
      memcpy(p->part + first + slice->cell_at[k], slice->part[k],
             slice->n_cell[k] * sizeof *p->part);
    first += p->s->n_cell[k];
  }
  return VG_OK;
}

vg_status vg_slices_collect_parts(const struct vg_slices *s, int threads,
                                  uint32_t *part, struct vg_error *err)
{
  struct parts p = { s, part };

  assert(s->n_part > 0 && part);
  return vg_slices_each(s, threads, collect_parts, &p, err);
}
