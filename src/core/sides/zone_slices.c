/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Slices of a mesh by zones: slice k of the new mesh has the cells of one zone
 * in a slice of the old one. The first of them owns the points of that slice.
 */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/sides/zone_cells.h"
#include "core/sides/zone_parts.h"

/* A slice of the new mesh. */
struct part {
  size_t slice; /* of the old mesh */
  uint32_t zone;
  int is_first; /* it owns the points */
  uint64_t at[VG_SLICE_KINDS], n[VG_SLICE_KINDS];
};

struct vg_zone_slices {
  const struct vg_slices *s; /* the old mesh */
  struct vg_mesh boundary;
  uint16_t **of;                 /* [s->n_slice] zone of each cell of a slice */
  uint64_t (*n)[VG_SLICE_KINDS]; /* [s->n_slice * n_zone] cells */
  uint64_t (*at)[VG_SLICE_KINDS]; /* [s->n_slice] first cells, old numbers */
  struct part *part;
  size_t n_part, n_zone;
};

void vg_zone_slices_close(struct vg_zone_slices *z)
{
  if (!z) return;
  for (size_t i = 0; z->of && i < z->s->n_slice; i++) free(z->of[i]);
  free(z->of);
  free(z->n);
  free(z->at);
  free(z->part);
  vg_mesh_release(&z->boundary);
  free(z);
}

/* --- zones of all cells ----------------------------------------------------
 */

struct finding {
  struct vg_zone_slices *z;
  const struct vg_zone_faces *faces;
  vg_status *st;        /* [n_slice] */
  struct vg_error *err; /* [n_slice] */
};

static vg_status find_in(const struct finding *f, size_t i,
                         const struct vg_slice *slice, struct vg_error *err)
{
  struct vg_zone_slices *z = f->z;
  size_t n = 0, c = 0;
  vg_status st;

  for (int k = 0; k < VG_SLICE_KINDS; k++) n += slice->n_cell[k];
  z->of[i] = vg_alloc(n, sizeof *z->of[i]);
  if (!z->of[i]) return vg_fail_memory(err, "the zones");
  st = vg_zone_of_cells(f->faces, slice, z->of[i], err);
  for (int k = 0; k < VG_SLICE_KINDS && st >= 0; k++) {
    z->at[i][k] = slice->cell_at[k];
    for (size_t j = 0; j < slice->n_cell[k]; j++)
      z->n[i * z->n_zone + z->of[i][c++]][k]++;
  }
  return st;
}

static void find_some(void *context, size_t first, size_t end, int worker)
{
  struct finding *f = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_slice slice;

    f->st[i] = f->z->s->get(f->z->s, i, &slice, &f->err[i]);
    if (f->st[i] < 0) continue;
    f->st[i] = find_in(f, i, &slice, &f->err[i]);
    f->z->s->put(f->z->s, &slice);
  }
}

static vg_status find_zones(struct vg_zone_slices *z,
                            const struct vg_zone_map *map, int threads,
                            struct vg_error *err)
{
  const size_t n = z->s->n_slice;
  struct vg_zone_faces faces = { .z = NULL };
  struct finding f = { .z = z, .faces = &faces };
  vg_status st = VG_OK;

  z->of = vg_calloc(n, sizeof *z->of);
  z->n = vg_calloc(n * z->n_zone, sizeof *z->n);
  z->at = vg_calloc(n, sizeof *z->at);
  f.st = vg_calloc(n, sizeof *f.st);
  f.err = vg_calloc(n, sizeof *f.err);
  if (!z->of || !z->n || !z->at || !f.st || !f.err)
    VG_TRY(vg_fail_memory(err, "the zones"));
  VG_TRY(vg_zone_faces_new(map, z->s->boundary, &faces, err));
  vg_parallel_for(threads, n, 1, find_some, &f);
  for (size_t i = 0; i < n && st >= 0; i++) {
    st = f.st[i];
    if (st < 0 && err) *err = f.err[i];
  }
done:
  vg_zone_faces_release(&faces);
  free(f.st);
  free(f.err);
  return st;
}

/* --- numbers ----------------------------------------------------------------
 */

/* The cells of a kind and a zone in a slice of the old mesh. */
struct share {
  uint64_t at; /* first cell of the slice, old number */
  uint64_t n;
  uint32_t kind, zone;
  uint32_t rank, slice;
};

static int by_number(const void *a, const void *b)
{
  const struct share *p = a, *q = b;

  if (p->kind != q->kind) return p->kind < q->kind ? -1 : 1;
  if (p->zone != q->zone) return p->zone < q->zone ? -1 : 1;
  return p->at < q->at ? -1 : p->at > q->at;
}

static vg_status list_shares(const struct vg_zone_slices *z, int rank,
                             struct vg_bytes *out, struct vg_error *err)
{
  const size_t most = z->s->n_slice * z->n_zone * VG_SLICE_KINDS;
  struct share *list = vg_calloc(most, sizeof *list);
  size_t n = 0;

  if (!list) return vg_fail_memory(err, "the zones");
  for (size_t i = 0; i < z->s->n_slice; i++)
    for (uint32_t k = 0; k < VG_SLICE_KINDS; k++)
      for (uint32_t zone = 0; zone < z->n_zone; zone++) {
        const uint64_t count = z->n[i * z->n_zone + zone][k];

        if (count)
          list[n++] = (struct share){
            z->at[i][k], count, k, zone, (uint32_t)rank, (uint32_t)i
          };
      }
  out->n = n * sizeof *list;
  out->data = (unsigned char *)list;
  return VG_OK;
}

/* Slices of the new mesh: for each old slice, its zones that have cells. */
static vg_status list_parts(struct vg_zone_slices *z, struct vg_error *err)
{
  z->part = vg_calloc(z->s->n_slice * z->n_zone, sizeof *z->part);
  if (!z->part) return vg_fail_memory(err, "the zones");
  for (size_t i = 0; i < z->s->n_slice; i++) {
    int has_part = 0;

    for (uint32_t zone = 0; zone < z->n_zone; zone++) {
      const uint64_t *n = z->n[i * z->n_zone + zone];
      struct part *p = &z->part[z->n_part];
      const int is_last = zone + 1 == z->n_zone && !has_part;

      if (!(n[0] + n[1] + n[2] + n[3]) && !is_last) continue;
      p->slice = i;
      p->zone = zone;
      p->is_first = !has_part;
      memcpy(p->n, n, sizeof p->n);
      has_part = 1;
      z->n_part++;
    }
  }
  return VG_OK;
}

static int by_slice(const void *a, const void *b)
{
  const struct part *p = a, *q = b;

  if (p->slice != q->slice) return p->slice < q->slice ? -1 : 1;
  return p->zone < q->zone ? -1 : p->zone > q->zone;
}

/* Numbers the cells: by kinds, zones, and old numbers. all: sorted */
static void number(struct vg_zone_slices *z, const struct share *all, size_t n,
                   int rank)
{
  uint64_t at = 0;

  for (size_t k = 0; k < n; k++) {
    const struct share *a = &all[k];
    const struct part key = { .slice = a->slice, .zone = a->zone };

    if (!k || a[-1].kind != a->kind) at = 0;
    z->boundary.zone[a->zone].n_cell[a->kind] += a->n;
    if (a->rank == (uint32_t)rank) {
      struct part *p = bsearch(&key, z->part, z->n_part, sizeof *z->part,
                               by_slice);

      assert(p);
      p->at[a->kind] = at;
    }
    at += a->n;
  }
}

static vg_status number_cells(struct vg_zone_slices *z, struct vg_comm *comm,
                              struct vg_error *err)
{
  const size_t size = (size_t)vg_comm_size(comm);
  const int rank = vg_comm_rank(comm);
  struct vg_bytes mine = { 0, NULL };
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  struct share *all = NULL;
  size_t bytes = 0, n = 0;
  vg_status st = from ? list_shares(z, rank, &mine, err)
                      : vg_fail_memory(err, "the zones");

  if (st >= 0) st = list_parts(z, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, from, err));
  for (size_t r = 0; r < size; r++) bytes += from[r].n;
  all = vg_alloc(bytes, 1);
  if (!all) st = vg_fail_memory(err, "the zones");
  VG_TRY(vg_comm_agree(comm, st, err));
  for (size_t r = 0; r < size; r++) {
    if (from[r].n) memcpy(all + n, from[r].data, from[r].n);
    n += from[r].n / sizeof *all;
  }
  if (n) qsort(all, n, sizeof *all, by_number);
  number(z, all, n, rank);
done:
  free(all);
  free(mine.data);
  vg_bytes_release(from, from ? size : 0);
  return st;
}

/* --- serving slices ---------------------------------------------------------
 */

/* What a slice of the new mesh keeps. */
struct kept {
  struct vg_slice old;
  uint32_t *node; /* cells of all kinds */
};

/* Takes the cells of the zone of p. */
static void take_cells(const struct vg_zone_slices *z, const struct part *p,
                       struct kept *k, struct vg_slice *out)
{
  const uint16_t *of = z->of[p->slice];
  uint32_t *to = k->node;

  for (int kind = 0; kind < VG_SLICE_KINDS; kind++) {
    const size_t width = vg_slice_width[kind];

    out->cell_at[kind] = p->at[kind];
    out->n_cell[kind] = (size_t)p->n[kind];
    out->cell[kind] = to;
    for (size_t c = 0; c < k->old.n_cell[kind]; c++) {
      if (*of++ != p->zone) continue;
      memcpy(to, k->old.cell[kind] + c * width, width * sizeof *to);
      to += width;
    }
  }
}

static vg_status get(const struct vg_slices *s, size_t i, struct vg_slice *out,
                     struct vg_error *err)
{
  const struct vg_zone_slices *z = s->user;
  const struct part *p = &z->part[i];
  struct kept *k = vg_calloc(1, sizeof *k);
  size_t n = 0;
  vg_status st;

  if (!k) return vg_fail_memory(err, "a slice of the mesh");
  for (int kind = 0; kind < VG_SLICE_KINDS; kind++)
    n += (size_t)p->n[kind] * vg_slice_width[kind];
  st = z->s->get(z->s, p->slice, &k->old, err);
  if (st < 0) {
    free(k);
    return st;
  }
  k->node = vg_alloc(n, sizeof *k->node);
  if (!k->node) {
    z->s->put(z->s, &k->old);
    free(k);
    return vg_fail_memory(err, "a slice of the mesh");
  }
  *out = k->old;
  out->keep = k;
  if (!p->is_first) out->n_own = 0;
  take_cells(z, p, k, out);
  return VG_OK;
}

static void put(const struct vg_slices *s, struct vg_slice *slice)
{
  const struct vg_zone_slices *z = s->user;
  struct kept *k = slice->keep;

  z->s->put(z->s, &k->old);
  free(k->node);
  free(k);
  slice->keep = NULL;
}

/* --- whole ------------------------------------------------------------------
 */

static vg_status begin(struct vg_zone_slices *z, const struct vg_zone_map *map,
                       struct vg_error *err)
{
  vg_status st;

  assert(!z->s->n_part && !z->s->boundary->n_zone);
  VG_TRY(vg_mesh_copy(&z->boundary, z->s->boundary, err));
  z->boundary.zone = vg_alloc(map->n, sizeof *map->zone);
  if (!z->boundary.zone) return vg_fail_memory(err, "the zones");
  memcpy(z->boundary.zone, map->zone, map->n * sizeof *map->zone);
  z->boundary.n_zone = z->n_zone = map->n;
done:
  return st;
}

vg_status vg_zone_slices_open(struct vg_comm *comm,
                              const struct vg_zone_map *map,
                              const struct vg_slices *s, int threads,
                              struct vg_slices *out,
                              struct vg_zone_slices **keep,
                              struct vg_error *err)
{
  struct vg_zone_slices *z = vg_calloc(1, sizeof *z);
  vg_status st = z ? VG_OK : vg_fail_memory(err, "the zones");

  if (z) z->s = s;
  if (z) st = begin(z, map, err);
  if (st >= 0) st = find_zones(z, map, threads, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(number_cells(z, comm, err));
  *out = *s;
  memset(out->n_layer_cell, 0, sizeof out->n_layer_cell);
  out->boundary = &z->boundary;
  out->n_slice = z->n_part;
  out->get = get;
  out->put = put;
  out->user = z;
  *keep = z;
  z = NULL;
done:
  vg_zone_slices_close(z);
  return st;
}
