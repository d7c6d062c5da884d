/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/picture/worst.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

struct search {
  size_t n;
  const uint64_t *id;
  struct vg_around *out;
};

static int touches(const uint32_t *a, const uint32_t *b)
{
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++)
      if (a[i] == b[j]) return 1;
  return 0;
}

static void put(const struct vg_slice *s, const uint32_t *node,
                struct vg_around *to)
{
  for (int k = 0; k < 4; k++)
    memcpy(to->cell[to->n][k], s->x[node[k]], sizeof s->x[0]);
  to->n++;
}

static vg_status look(const struct vg_slice *s, size_t at, struct vg_around *to,
                      struct vg_error *err)
{
  const uint32_t *cell = s->cell[VG_SLICE_TET], *it = cell + 4 * at;

  to->cell = vg_alloc(VG_AROUND_MAX, sizeof *to->cell);
  if (!to->cell) return vg_fail_memory(err, "the worst cells");
  put(s, it, to);
  for (size_t i = 0; i < s->n_cell[VG_SLICE_TET]; i++)
    if (i != at && to->n < VG_AROUND_MAX && touches(it, cell + 4 * i))
      put(s, cell + 4 * i, to);
  return VG_OK;
}

/* A cell is in one slice, so threads do not write the same entry. */
static vg_status search_slice(void *context, const struct vg_slice *s,
                              struct vg_error *err)
{
  const struct search *q = context;
  vg_status st = VG_OK;

  for (size_t k = 0; k < q->n && st >= 0; k++)
    if (q->id[k] >= s->cell_at[VG_SLICE_TET] &&
        q->id[k] - s->cell_at[VG_SLICE_TET] < s->n_cell[VG_SLICE_TET])
      st = look(s, (size_t)(q->id[k] - s->cell_at[VG_SLICE_TET]), &q->out[k],
                err);
  return st;
}

/* Packs the index of each entry and its cells. */
static vg_status pack(size_t n, const struct vg_around *a, struct vg_bytes *b,
                      struct vg_error *err)
{
  size_t bytes = 0, at = 0;

  for (size_t k = 0; k < n; k++)
    if (a[k].n) bytes += 2 * sizeof(size_t) + a[k].n * sizeof *a[k].cell;
  b->data = vg_alloc(bytes, 1);
  if (!b->data) return vg_fail_memory(err, "the worst cells");
  b->n = bytes;
  for (size_t k = 0; k < n; k++) {
    const size_t head[2] = { k, a[k].n };

    if (!a[k].n) continue;
    memcpy(b->data + at, head, sizeof head);
    at += sizeof head;
    memcpy(b->data + at, a[k].cell, a[k].n * sizeof *a[k].cell);
    at += a[k].n * sizeof *a[k].cell;
  }
  return VG_OK;
}

static vg_status unpack(const struct vg_bytes *b, struct vg_around *a,
                        struct vg_error *err)
{
  for (size_t at = 0; at < b->n;) {
    size_t head[2];

    memcpy(head, b->data + at, sizeof head);
    at += sizeof head;
    a += head[0];
    a->cell = vg_alloc(head[1], sizeof *a->cell);
    if (!a->cell) return vg_fail_memory(err, "the worst cells");
    a->n = head[1];
    memcpy(a->cell, b->data + at, a->n * sizeof *a->cell);
    at += a->n * sizeof *a->cell;
    a -= head[0];
  }
  return VG_OK;
}

vg_status vg_around_find(struct vg_comm *comm, const struct vg_slices *s,
                         int threads, size_t n, const uint64_t *id,
                         struct vg_around *out, struct vg_error *err)
{
  struct search q = { n, id, out };
  size_t size = (size_t)vg_comm_size(comm);
  int rank = vg_comm_rank(comm);
  struct vg_bytes *to = vg_calloc(size, sizeof *to);
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  vg_status st = to && from ? VG_OK : vg_fail_memory(err, "the worst cells");

  assert((id && out) || !n);
  memset(out, 0, n * sizeof *out);
  if (st >= 0) st = vg_slices_each(s, threads, search_slice, &q, err);
  if (st >= 0 && rank) st = pack(n, out, &to[0], err);
  VG_TRY(vg_comm_agree(comm, st, err));
  if (size > 1) VG_TRY(vg_comm_exchange(comm, to, from, err));
  for (size_t i = 0; i < size && st >= 0 && !rank; i++)
    st = unpack(&from[i], out, err);
  st = vg_comm_agree(comm, st, err);
done:
  if (rank || st < 0) vg_around_release(out, n);
  vg_bytes_release(to, to ? size : 0);
  vg_bytes_release(from, from ? size : 0);
  return st;
}

void vg_around_release(struct vg_around *a, size_t n)
{
  for (size_t i = 0; i < n; i++) {
    free(a[i].cell);
    a[i] = (struct vg_around){ 0, NULL };
  }
}
