/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Numbers the points and cells of all ranks: tasks in the order of their
 * paths, each with its points and cells in its own order. One exchange of
 * counts. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/cut/node.h"

/* The counts of one task, as exchanged between ranks. */
struct share {
  char path[VG_PATH_MAX];
  uint32_t serial, index; /* index: among the pieces of its rank. */
  uint64_t n_point, n_cell;
  uint64_t rank;
};

static int by_path(const void *a, const void *b)
{
  const struct share *s = a, *t = b;
  int order = strcmp(s->path, t->path);

  return order ? order : s->serial < t->serial ? -1 : 1;
}

static int by_serial(const void *a, const void *b)
{
  const struct vg_place_of *s = a, *t = b;

  return s->serial < t->serial ? -1 : s->serial > t->serial;
}

static vg_status list_own(const struct vg_partition *p, struct vg_bytes *out,
                          struct vg_error *err)
{
  struct share *s = vg_calloc(p->n_piece, sizeof *s);

  if (!s) return vg_fail_memory(err, "numbering the mesh");
  for (size_t k = 0; k < p->n_piece; k++) {
    memcpy(s[k].path, p->piece[k].path, sizeof s[k].path);
    s[k].serial = p->piece[k].serial;
    s[k].index = (uint32_t)k;
    s[k].n_point = p->piece[k].n_point;
    s[k].n_cell = p->piece[k].n_cell;
    s[k].rank = (uint64_t)p->rank;
  }
  out->n = p->n_piece * sizeof *s;
  out->data = (unsigned char *)s;
  return VG_OK;
}

/* Gathers the shares of all ranks, sorted by path. */
static vg_status gather(const struct vg_partition *p, struct vg_comm *comm,
                        struct share **out, size_t *n, struct vg_error *err)
{
  struct vg_bytes mine = { 0, NULL };
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  size_t bytes = 0;
  vg_status st = all ? list_own(p, &mine, err)
                     : vg_fail_memory(err, "numbering the mesh");

  *out = NULL;
  *n = 0;
  st = vg_comm_agree(comm, st, err);
  if (st == VG_OK) st = vg_comm_allgather(comm, &mine, all, err);
  for (int r = 0; st == VG_OK && r < p->size; r++) bytes += all[r].n;
  if (st == VG_OK) {
    *out = vg_alloc(bytes, 1);
    if (!*out) st = vg_fail_memory(err, "numbering the mesh");
  }
  for (int r = 0; st == VG_OK && r < p->size; r++)
    if (all[r].n) {
      memcpy(*out + *n, all[r].data, all[r].n);
      *n += all[r].n / sizeof **out;
    }
  vg_bytes_release(all, (size_t)p->size);
  free(mine.data);
  if (st == VG_OK && *n) qsort(*out, *n, sizeof **out, by_path);
  return st;
}

static vg_status number(struct vg_partition *p, size_t n, const struct share *s,
                        struct vg_error *err)
{
  uint64_t point = p->boundary.n_point, cell = 0;

  p->place = vg_alloc(n, sizeof *p->place);
  p->point_at = vg_alloc(p->n_piece, sizeof *p->point_at);
  p->cell_at = vg_alloc(p->n_piece, sizeof *p->cell_at);
  p->domain = vg_alloc(p->n_piece, sizeof *p->domain);
  if (!p->place || !p->point_at || !p->cell_at || !p->domain)
    return vg_fail_memory(err, "numbering the mesh");
  for (size_t k = 0; k < n; k++) {
    assert(!k || strcmp(s[k - 1].path, s[k].path) != 0);
    p->place[k].serial = s[k].serial;
    p->place[k].point = point;
    if (s[k].rank == (uint64_t)p->rank) {
      p->point_at[s[k].index] = point;
      p->cell_at[s[k].index] = cell;
      p->domain[s[k].index] = (uint32_t)(k + 1);
    }
    point += s[k].n_point;
    cell += s[k].n_cell;
  }
  p->n_place = n;
  if (n) qsort(p->place, n, sizeof *p->place, by_serial);
  p->slices.n_point = point;
  p->slices.n_cell[VG_SLICE_TET] = cell;
  if (point <= UINT32_MAX) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the mesh would have %llu points, "
                 "but at most %u can be numbered: use a coarser spacing",
                 (unsigned long long)point, UINT32_MAX);
}

/* --- serving slices ------------------------------------------------------ */

static uint32_t id_of(const struct vg_partition *p, uint64_t id)
{
  struct vg_place_of key = { .serial = (uint32_t)(id >> 32) };
  const struct vg_place_of *at;

  if (!key.serial) return (uint32_t)id;
  at = bsearch(&key, p->place, p->n_place, sizeof key, by_serial);
  return at ? (uint32_t)(at->point + (uint32_t)id) : UINT32_MAX;
}

static int kind_of(char kind)
{
  return kind == VG_SPAN_LEAF ? 1 : kind == VG_SPAN_REPAIR ? 3 : 2;
}

/* The slice without cells that owns the points of the front. */
static void serve_front(const struct vg_partition *p, struct vg_slice *out)
{
  out->n_point = out->n_own = p->boundary.n_point;
  out->x = (const double(*)[3])p->boundary.point;
  out->id = out->own = p->front_id;
}

static vg_status serve_piece(const struct vg_partition *p, size_t i,
                             struct vg_slice *out, struct vg_error *err)
{
  const struct vg_piece *piece = &p->piece[i];
  uint32_t *id, *own, (*cell)[4];

  out->n_point = piece->n_in + piece->n_point;
  out->n_own = piece->n_point;
  /* one block: cells, then numbers of points */
  cell = vg_alloc(4 * piece->n_cell + out->n_point + out->n_own, sizeof *id);
  if (!cell) return vg_fail_memory(err, "a slice of the mesh");
  vg_packed_cells_all(&piece->cell, piece->n_cell, cell);
  id = cell[piece->n_cell];
  own = id + out->n_point;
  for (size_t k = 0; k < piece->n_in; k++) id[k] = id_of(p, piece->in[k]);
  for (size_t k = 0; k < piece->n_point; k++) {
    id[piece->n_in + k] = (uint32_t)(p->point_at[i] + k);
    own[k] = (uint32_t)(piece->n_in + k);
  }
  out->x = (const double(*)[3])piece->x;
  out->id = id;
  out->own = own;
  out->point_at = p->point_at[i];
  out->cell_at[VG_SLICE_TET] = p->cell_at[i];
  out->n_cell[VG_SLICE_TET] = piece->n_cell;
  out->cell[VG_SLICE_TET] = cell[0];
  out->keep = cell;
  out->domain = p->domain[i];
  out->kind = (uint8_t)kind_of(piece->kind);
  return VG_OK;
}

static vg_status serve(const struct vg_slices *s, size_t i,
                       struct vg_slice *out, struct vg_error *err)
{
  const struct vg_partition *p = s->user;
  vg_status st;

  memset(out, 0, sizeof *out);
  if (p->rank == 0 && i-- == 0) {
    serve_front(p, out);
    return VG_OK;
  }
  st = serve_piece(p, i, out, err);
  if (st < 0 || !p->doubled.first) return st;
  st = vg_doubled_slice(&p->doubled, out, err);
  if (st < 0) free(out->keep);
  return st;
}

static void put_back(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s;
  free(slice->keep);
  slice->keep = NULL;
}

static vg_status open_slices(struct vg_partition *p, struct vg_error *err)
{
  struct vg_slices *s = &p->slices;

  p->boundary_faces = p->boundary; /* arrays are borrowed */
  p->boundary_faces.n_point = 0;
  p->boundary_faces.point = NULL;
  p->front_id = vg_alloc(p->boundary.n_point, sizeof *p->front_id);
  if (!p->front_id) return vg_fail_memory(err, "numbering the mesh");
  for (size_t k = 0; k < p->boundary.n_point; k++) p->front_id[k] = (uint32_t)k;
  s->n_boundary_point = p->boundary.n_point;
  s->n_copy = vg_doubled_copies(&p->doubled);
  s->boundary = &p->boundary_faces;
  s->n_slice = p->n_piece + (p->rank == 0);
  for (size_t k = 0; k < p->n_piece; k++) s->n_served += p->piece[k].n_cell;
  s->get = serve;
  s->put = put_back;
  s->user = p;
  return VG_OK;
}

vg_status vg_partition_number(struct vg_partition *p, struct vg_comm *comm,
                              struct vg_error *err)
{
  struct share *s = NULL;
  size_t n;
  vg_status st;

  assert(p->rank == vg_comm_rank(comm) && p->size == vg_comm_size(comm));
  VG_TRY(vg_comm_agree(comm, gather(p, comm, &s, &n, err), err));
  st = number(p, n, s, err);
  if (st == VG_OK) st = open_slices(p, err);
  st = vg_comm_agree(comm, st, err);
done:
  free(s);
  return st;
}

/* --- moving points ------------------------------------------------------- */

static int by_id(const void *a, const void *b)
{
  const struct vg_slices_point *s = a, *t = b;

  return s->id < t->id ? -1 : s->id > t->id;
}

void vg_partition_move_points(struct vg_partition *p, size_t n,
                              const struct vg_slices_point *point)
{
  for (size_t i = 0; i < p->n_piece && n; i++) {
    struct vg_piece *q = &p->piece[i];

    for (size_t k = 0; k < q->n_in + q->n_point; k++) {
      const struct vg_slices_point key = {
        .id = k < q->n_in ? id_of(p, q->in[k]) : p->point_at[i] + k - q->n_in
      };
      const struct vg_slices_point *at;

      if (key.id < point[0].id || key.id > point[n - 1].id) continue;
      at = bsearch(&key, point, n, sizeof key, by_id);
      if (at) memcpy(q->x[k], at->x, sizeof *q->x);
    }
  }
}
