/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Collects a mesh in slices on rank 0, for writers of whole meshes. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "io/slices/slices.h"

/* Bytes that all ranks together send to rank 0 at once: large enough for fast
 * messages, small in comparison with the mesh. */
#define ROUND_BYTES (256u << 20)

struct gathering {
  struct vg_comm *comm;
  const struct vg_slices *s;
  struct vg_mesh *mesh; /* on rank 0 */
  uint32_t *part;       /* on rank 0, or NULL */
  size_t next;          /* first slice of this rank that has not been sent */
};

/* A slice as bytes: its own points and its cells, with numbers of the mesh. */
static void pack(const struct vg_slice *slice, int has_parts,
                 struct vg_writer *to)
{
  const uint64_t n_own = slice->n_own;

  vg_put(to, 1, sizeof slice->point_at, &slice->point_at);
  vg_put(to, 1, sizeof n_own, &n_own);
  for (size_t k = 0; k < slice->n_own; k++)
    vg_put(to, 1, sizeof *slice->x, slice->x[slice->own[k]]);
  for (int kind = 0; kind < VG_SLICE_KINDS; kind++) {
    const uint64_t n = slice->n_cell[kind];

    vg_put(to, 1, sizeof slice->cell_at[kind], &slice->cell_at[kind]);
    vg_put(to, 1, sizeof n, &n);
    for (size_t i = 0; i < n * vg_slice_width[kind]; i++)
      vg_put(to, 1, sizeof *slice->id, &slice->id[slice->cell[kind][i]]);
    if (has_parts) vg_put(to, n, sizeof *slice->part[kind], slice->part[kind]);
  }
}

/* Pack slices until the share of this rank in a round is full. */
static vg_status pack_round(struct gathering *g, struct vg_writer *to,
                            struct vg_error *err)
{
  const size_t share = ROUND_BYTES / (size_t)vg_comm_size(g->comm);
  vg_status st = VG_OK;

  if (!vg_comm_rank(g->comm)) return VG_OK;
  while (g->next < g->s->n_slice && to->bytes.n < share && st >= 0) {
    struct vg_slice slice;

    st = g->s->get(g->s, g->next, &slice, err);
    if (st < 0) break;
    pack(&slice, g->s->n_part > 0, to);
    g->s->put(g->s, &slice);
    g->next++;
    if (to->refused) st = vg_fail_memory(err, "slices of the mesh");
  }
  return st;
}

/* Copy a block of `n` items to their place, if it lies in the array. */
static void place(struct vg_reader *from, uint64_t at, uint64_t n,
                  uint64_t total, size_t size, void *to)
{
  if (n > total || at > total - n) from->bad = 1;
  else vg_get(from, n, size, (char *)to + at * size);
}

static vg_status unpack(struct gathering *g, const struct vg_bytes *from,
                        struct vg_error *err)
{
  struct vg_reader r = { from->data, from->n, 0, 0 };
  struct vg_mesh *m = g->mesh;
  void *const cell[VG_SLICE_KINDS] = { m->tet, m->pyr, m->pri, m->hex };

  while (!r.bad && r.at < r.n) {
    uint64_t at = 0, n = 0, first = 0;

    vg_get(&r, 1, sizeof at, &at);
    vg_get(&r, 1, sizeof n, &n);
    place(&r, at, n, g->s->n_point, sizeof *m->point, m->point);
    for (int kind = 0; kind < VG_SLICE_KINDS && !r.bad; kind++) {
      const uint64_t total = g->s->n_cell[kind];

      vg_get(&r, 1, sizeof at, &at);
      vg_get(&r, 1, sizeof n, &n);
      place(&r, at, n, total, vg_slice_width[kind] * sizeof(uint32_t),
            cell[kind]);
      if (g->s->n_part)
        place(&r, at, n, total, sizeof *g->part, g->part + first);
      first += total;
    }
  }
  return r.bad ? vg_fail_damaged(err, "slices of the mesh") : VG_OK;
}

/* One round; *left: slices of all ranks that have not been sent. */
static vg_status exchange(struct gathering *g, uint64_t *left,
                          struct vg_error *err)
{
  const size_t n_rank = (size_t)vg_comm_size(g->comm);
  struct vg_bytes *to = vg_calloc(n_rank, sizeof *to);
  struct vg_bytes *from = vg_calloc(n_rank, sizeof *from);
  struct vg_writer w = { 0 };
  vg_status st = to && from ? pack_round(g, &w, err)
                            : vg_fail_memory(err, "slices of the mesh");

  VG_TRY(vg_comm_agree(g->comm, st, err));
  to[0] = w.bytes;
  VG_TRY(vg_comm_exchange(g->comm, to, from, err));
  for (size_t k = 1; k < n_rank && st >= 0 && !vg_comm_rank(g->comm); k++)
    st = unpack(g, &from[k], err);
  VG_TRY(vg_comm_agree(g->comm, st, err));
  *left = vg_comm_rank(g->comm) ? g->s->n_slice - g->next : 0;
  st = vg_comm_sum(g->comm, 1, left, err);
done:
  free(w.bytes.data);
  free(to);
  vg_bytes_release(from, from ? n_rank : 0);
  return st;
}

static vg_status collect_own(struct gathering *g, int threads,
                             struct vg_error *err)
{
  const uint64_t *n = g->s->n_cell;
  vg_status st;

  if (vg_comm_rank(g->comm)) return VG_OK;
  VG_TRY(vg_slices_collect(g->s, threads, g->mesh, err));
  if (!g->s->n_part) return VG_OK;
  g->part = vg_alloc((size_t)(n[VG_SLICE_TET] + n[VG_SLICE_PYR] +
                              n[VG_SLICE_PRI] + n[VG_SLICE_HEX]),
                     sizeof *g->part);
  st = g->part ? vg_slices_collect_parts(g->s, threads, g->part, err)
               : vg_fail_memory(err, "the solver partitions of the mesh");
done:
  return st;
}

vg_status vg_slices_gather(struct vg_comm *comm, const struct vg_slices *s,
                           int threads, struct vg_mesh *out, uint32_t **part,
                           struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct gathering g = { .comm = comm, .s = s, .mesh = &m };
  uint64_t left = vg_comm_size(comm) > 1;
  vg_status st;

  assert(out && part);
  VG_TRY(vg_comm_agree(comm, collect_own(&g, threads, err), err));
  while (left) VG_TRY(exchange(&g, &left, err));
  vg_mesh_move(out, &m);
  *part = g.part;
  g.part = NULL;
done:
  free(g.part);
  vg_mesh_release(&m);
  return st;
}
