/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writes METIS's .part file for a mesh in slices. Its lines have different
 * lengths, so all ranks first exchange the sizes of their text. */
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "io/stream/metis_part.h"
#include "io/slices/slices_parts.h"

/* Cells of one kind in a slice. */
struct run {
  uint64_t kind, cell_at; /* kind, and number of its first cell */
  uint64_t bytes;         /* bytes of its lines; later their offset */
};

struct part_file {
  struct run *run; /* [n] runs of all ranks, in order */
  size_t n;
  uint64_t size;
};

static int by_place(const void *a, const void *b)
{
  const struct run *p = a, *q = b;

  if (p->kind != q->kind) return p->kind < q->kind ? -1 : 1;
  return (p->cell_at > q->cell_at) - (p->cell_at < q->cell_at);
}

static vg_status list_slice(void *context, const struct vg_slice *slice,
                            struct vg_error *err)
{
  struct vg_writer *list = context;

  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    const struct run r = { (uint64_t)k, slice->cell_at[k],
                           vg_metis_part_bytes(slice->n_cell[k],
                                               slice->part[k]) };

    if (slice->n_cell[k]) vg_put(list, 1, sizeof r, &r);
  }
  return list->refused ? vg_fail_memory(err, "the list of slices") : VG_OK;
}

static vg_status join_lists(struct part_file *f, size_t n_rank,
                            const struct vg_bytes *list, struct vg_error *err)
{
  struct vg_writer all = { .cap = 0 };

  for (size_t r = 0; r < n_rank; r++) vg_put(&all, list[r].n, 1, list[r].data);
  f->run = (void *)all.bytes.data;
  f->n = all.bytes.n / sizeof *f->run;
  if (all.refused) return vg_fail_memory(err, "the list of slices");
  if (f->n) qsort(f->run, f->n, sizeof *f->run, by_place);
  for (size_t i = 0; i < f->n; i++) {
    uint64_t here = f->run[i].bytes;

    f->run[i].bytes = f->size;
    f->size += here;
  }
  return VG_OK;
}

static vg_status list_all(struct vg_comm *comm, const struct vg_slices *s,
                          struct part_file *f, struct vg_error *err)
{
  size_t n_rank = (size_t)vg_comm_size(comm);
  struct vg_bytes *all = vg_calloc(n_rank, sizeof *all);
  struct vg_writer mine = { .cap = 0 };
  vg_status st = all ? vg_slices_each(s, 1, list_slice, &mine, err)
                     : vg_fail_memory(err, "the list of slices");

  st = vg_comm_agree(comm, st, err);
  if (st >= 0) st = vg_comm_allgather(comm, &mine.bytes, all, err);
  if (st >= 0) st = join_lists(f, n_rank, all, err);
  vg_bytes_release(all, all ? n_rank : 0);
  free(mine.bytes.data);
  return vg_comm_agree(comm, st, err);
}

static void put_frame(const void *of, struct vg_output *out)
{
  const struct part_file *f = of;

  vg_output_skip(out, f->size);
}

static void put_slice(void *of, const struct vg_slice *slice,
                      struct vg_output *out)
{
  const struct part_file *f = of;

  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    const struct run key = { (uint64_t)k, slice->cell_at[k], 0 }, *r;

    if (!slice->n_cell[k]) continue;
    r = bsearch(&key, f->run, f->n, sizeof key, by_place);
    vg_output_seek(out, r->bytes);
    vg_metis_part_put(out, slice->n_cell[k], slice->part[k]);
  }
}

vg_status vg_slices_write_part(struct vg_comm *comm, const struct vg_slices *s,
                               const char *path, int threads,
                               struct vg_error *err)
{
  struct part_file f = { NULL, 0, 0 };
  struct vg_slice_file file = { path, 0, &f, put_frame, put_slice };
  vg_status st;

  if (!s->n_part)
    return vg_fail(err, VG_ERR_INPUT, "%s: the mesh has no solver partitions",
                   path);
  st = list_all(comm, s, &f, err);
  if (st >= 0) st = vg_slice_file_write(&file, comm, s, threads, err);
  free(f.run);
  return st;
}
