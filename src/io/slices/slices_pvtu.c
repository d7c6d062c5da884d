/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* .pvtu: a mesh in slices as pieces, each in a file of its own. A piece is a
 * sequence of slices in the order of the mesh. Each slice has copies of all its
 * points, so that nothing has to be matched between slices. */
#define _GNU_SOURCE
#include <assert.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "io/slices/slices_parts.h"
#include "io/stream/shared_file.h"

#define PIECE_CELLS 2000000u
#define BLOCK 4096

/* The last field is only used if the mesh has solver partitions. */
static const struct vg_vtu_field field[3] = {
  { "subdomain", VG_VTU_CELL, VG_VTU_INT32, 1, NULL },
  { "kind", VG_VTU_CELL, VG_VTU_INT32, 1, NULL },
  { VG_VTU_SOLVER_PART, VG_VTU_CELL, VG_VTU_INT32, 1, NULL }
};

/* A slice with cells on any rank; every rank has the list of all of them. */
struct entry {
  uint64_t before; /* number of cells in the mesh before it, which identifies
                      it */
  uint64_t n_point, n_cell[VG_SLICE_KINDS];
  /* its piece, and its offsets there */
  uint64_t piece, point_at, cell_at, node_at;
};

struct piece {
  char *path;
  struct vg_mesh mesh; /* frame of the file */
  size_t n_field;
  struct vg_vtu_places at;
  struct vg_shared_file *to;
  int is_placed; /* the file has its final name */
};

struct pieces {
  size_t n_entry, n_piece, n_field;
  struct entry *entry; /* in the order of the mesh */
  struct piece *piece;
};

char *vg_slices_piece(const char *stem, size_t k)
{
  char *path;

  assert(stem);
  return asprintf(&path, "%s_%zu.vtu", stem, k) < 0 ? NULL : path;
}

/* --- the list of slices --- */

static uint64_t name_of(const struct vg_slice *slice)
{
  uint64_t n = 0;

  for (int k = 0; k < VG_SLICE_KINDS; k++) n += slice->cell_at[k];
  return n;
}

static int by_name(const void *a, const void *b)
{
  const struct entry *p = a, *q = b;

  return (p->before > q->before) - (p->before < q->before);
}

struct list {
  atomic_size_t n;
  struct entry *entry; /* has space for all slices of this rank */
};

static vg_status list_slice(void *context, const struct vg_slice *slice,
                            struct vg_error *err)
{
  struct list *l = context;
  struct entry e = { .before = name_of(slice), .n_point = slice->n_point };
  size_t n = 0;

  (void)err;
  for (int k = 0; k < VG_SLICE_KINDS; k++) n += e.n_cell[k] = slice->n_cell[k];
  if (n) l->entry[atomic_fetch_add(&l->n, 1)] = e;
  return VG_OK;
}

static vg_status join_lists(struct pieces *p, size_t n_rank,
                            const struct vg_bytes *list, struct vg_error *err)
{
  size_t n = 0;

  for (size_t r = 0; r < n_rank; r++) n += list[r].n / sizeof *p->entry;
  p->entry = vg_alloc(n, sizeof *p->entry);
  if (!p->entry) return vg_fail_memory(err, "the list of slices");
  for (size_t r = 0; r < n_rank; r++) {
    if (list[r].n) memcpy(p->entry + p->n_entry, list[r].data, list[r].n);
    p->n_entry += list[r].n / sizeof *p->entry;
  }
  qsort(p->entry, n, sizeof *p->entry, by_name);
  return VG_OK;
}

static vg_status list_all(struct vg_comm *comm, const struct vg_slices *s,
                          int threads, struct pieces *p, struct vg_error *err)
{
  size_t n_rank = (size_t)vg_comm_size(comm);
  struct list l = { 0, vg_alloc(s->n_slice, sizeof *l.entry) };
  struct vg_bytes mine, *all = vg_calloc(n_rank, sizeof *all);
  vg_status st = l.entry && all
                 ? vg_slices_each(s, threads, list_slice, &l, err)
                 : vg_fail_memory(err, "the list of slices");

  st = vg_comm_agree(comm, st, err);
  mine = (struct vg_bytes){ l.n * sizeof *l.entry, (unsigned char *)l.entry };
  if (st >= 0) st = vg_comm_allgather(comm, &mine, all, err);
  if (st >= 0) st = join_lists(p, n_rank, all, err);
  vg_bytes_release(all, n_rank);
  free(l.entry);
  return st;
}

/* --- positions of slices --- */

static void add_to_piece(struct vg_mesh *m, struct entry *e)
{
  e->point_at = m->n_point;
  e->cell_at = vg_mesh_n_cell(m);
  e->node_at = 4 * m->n_tet + 5 * m->n_pyr + 6 * m->n_pri + 8 * m->n_hex;
  m->n_point += e->n_point;
  m->n_tet += e->n_cell[VG_SLICE_TET];
  m->n_pyr += e->n_cell[VG_SLICE_PYR];
  m->n_pri += e->n_cell[VG_SLICE_PRI];
  m->n_hex += e->n_cell[VG_SLICE_HEX];
}

static void put_frame(const void *of, struct vg_output *out)
{
  const struct piece *piece = of;

  vg_vtu_put(out, &piece->mesh, field, piece->n_field);
}

static vg_status plan(struct pieces *p, const char *stem, uint64_t run,
                      struct vg_error *err)
{
  uint64_t last = UINT64_MAX;

  for (size_t i = 0; i < p->n_entry; i++) {
    p->n_piece += p->entry[i].before / run != last;
    last = p->entry[i].before / run;
    p->entry[i].piece = p->n_piece - 1;
  }
  p->piece = vg_calloc(p->n_piece, sizeof *p->piece);
  if (!p->piece) return vg_fail_memory(err, "the pieces of a .pvtu");
  for (size_t i = 0; i < p->n_entry; i++)
    add_to_piece(&p->piece[p->entry[i].piece].mesh, &p->entry[i]);
  for (size_t k = 0; k < p->n_piece; k++) {
    p->piece[k].n_field = p->n_field;
    if (!(p->piece[k].path = vg_slices_piece(stem, k)))
      return vg_fail_memory(err, "the output paths");
  }
  return VG_OK;
}

static vg_status open_pieces(struct vg_comm *comm, struct pieces *p,
                             struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t k = 0; k < p->n_piece && st >= 0; k++) {
    struct piece *piece = &p->piece[k];
    struct vg_slice_file f = { piece->path, 0, piece, put_frame, NULL };
    uint64_t size = 0;

    st = vg_slice_file_size(&f, &size, err);
    st = vg_comm_agree(comm, st, err);
    if (st < 0) return st;
    vg_vtu_find(&piece->mesh, size, field, piece->n_field, &piece->at);
    st = vg_shared_open(comm, piece->path, size, &piece->to, err);
    if (st < 0) piece->to = NULL;
  }
  return st;
}

/* --- contents of pieces --- */

static void put_number(struct vg_output *out, uint64_t at, size_t n, int32_t v)
{
  int32_t block[BLOCK];

  for (size_t i = 0; i < BLOCK && i < n; i++) block[i] = v;
  vg_output_seek(out, at);
  for (size_t i = 0, m; i < n; i += m) {
    m = n - i < BLOCK ? n - i : BLOCK;
    vg_output_bytes(out, block, m * sizeof *block);
  }
}

static void put_slice(const struct piece *piece, const struct entry *e,
                      const struct vg_slice *slice, struct vg_output *out)
{
  uint64_t first = e->cell_at, first_node = e->node_at;

  vg_output_seek(out, piece->at.points + 24 * e->point_at);
  vg_output_f64(out, 3 * slice->n_point, *slice->x);
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    const struct vg_vtu_cells c = { k,         slice->n_cell[k], slice->cell[k],
                                    NULL,      e->point_at,      first,
                                    first_node };

    if (c.n) vg_vtu_put_cells(out, &piece->at, &c);
    if (c.n && piece->n_field > 2) {
      vg_output_seek(out, piece->at.field[2] + 4 * first);
      vg_output_bytes(out, slice->part[k], 4 * c.n);
    }
    first += c.n;
    first_node += c.n * vg_slice_width[k];
  }
  put_number(out, piece->at.field[0] + 4 * e->cell_at,
             (size_t)(first - e->cell_at), (int32_t)slice->domain);
  put_number(out, piece->at.field[1] + 4 * e->cell_at,
             (size_t)(first - e->cell_at), slice->kind);
}

static vg_status fill_slice(void *context, const struct vg_slice *slice,
                            struct vg_error *err)
{
  const struct pieces *p = context;
  const struct entry key = { .before = name_of(slice) }, *e;
  const struct piece *piece;
  struct vg_output out = VG_OUTPUT_INIT;
  size_t n = 0;
  vg_status st;

  for (int k = 0; k < VG_SLICE_KINDS; k++) n += slice->n_cell[k];
  if (!n) return VG_OK;
  e = bsearch(&key, p->entry, p->n_entry, sizeof key, by_name);
  piece = &p->piece[e->piece];
  st = vg_output_shared(piece->to, &out, err);
  if (st >= 0) {
    put_slice(piece, e, slice, &out);
    st = vg_output_flush(&out, err);
  }
  vg_output_release(&out);
  return st;
}

static vg_status fill(struct vg_comm *comm, const struct vg_slices *s,
                      int threads, struct pieces *p, struct vg_error *err)
{
  for (size_t k = 0; k < p->n_piece && !vg_comm_rank(comm); k++) {
    struct vg_output out = VG_OUTPUT_INIT;
    vg_status st = vg_output_shared(p->piece[k].to, &out, err);

    if (st >= 0) {
      put_frame(&p->piece[k], &out);
      st = vg_output_flush(&out, err);
    }
    vg_output_release(&out);
    if (st < 0) return st;
  }
  return vg_slices_each(s, threads, fill_slice, p, err);
}

/* --- the file that lists the pieces --- */

static vg_status write_list(const struct pieces *p, const char *stem,
                            struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *path;
  vg_status st;

  if (asprintf(&path, "%s.pvtu", stem) < 0)
    return vg_fail_memory(err, "the output paths");
  st = vg_output_open(path, &out, err);
  free(path);
  if (st < 0) return st;
  vg_output_format(&out,
                   "<?xml version=\"1.0\"?>\n"
                   "<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" "
                   "byte_order=\"%s\" header_type=\"UInt64\">\n"
                   " <PUnstructuredGrid GhostLevel=\"0\">\n"
                   "  <PPoints>\n   <PDataArray type=\"Float64\" "
                   "Name=\"Points\" NumberOfComponents=\"3\"/>\n"
                   "  </PPoints>\n  <PCellData>\n",
                   vg_host_is_little() ? "LittleEndian" : "BigEndian");
  for (size_t i = 0; i < p->n_field; i++)
    vg_output_format(&out,
                     "   <PDataArray type=\"Int32\" Name=\"%s\" "
                     "NumberOfComponents=\"1\"/>\n",
                     field[i].name);
  vg_output_text(&out, "  </PCellData>\n");
  for (size_t k = 0; k < p->n_piece; k++) {
    const char *slash = strrchr(p->piece[k].path, '/');

    vg_output_text(&out, "  <Piece Source=\"");
    vg_output_markup(&out, slash ? slash + 1 : p->piece[k].path);
    vg_output_text(&out, "\"/>\n");
  }
  vg_output_text(&out, " </PUnstructuredGrid>\n</VTKFile>\n");
  return vg_output_commit(&out, err);
}

/* Rename all pieces to their final names, or remove them all. Collective. */
static vg_status close_pieces(struct vg_comm *comm, struct pieces *p,
                              const char *stem, vg_status st,
                              struct vg_error *err)
{
  for (size_t k = 0; k < p->n_piece; k++) {
    vg_status closed;

    if (!p->piece[k].to) continue;
    closed = vg_shared_close(p->piece[k].to, st, st < 0 ? NULL : err);
    p->piece[k].is_placed = closed >= 0;
    if (st >= 0) st = closed;
  }
  if (st >= 0 && !vg_comm_rank(comm)) st = write_list(p, stem, err);
  st = vg_comm_agree(comm, st, err);
  for (size_t k = 0; k < p->n_piece && st < 0; k++)
    if (p->piece[k].is_placed && !vg_comm_rank(comm)) unlink(p->piece[k].path);
  return st;
}

vg_status vg_slices_write_pvtu(struct vg_comm *comm, const struct vg_slices *s,
                               const char *stem,
                               const struct vg_slices_options *o,
                               struct vg_error *err)
{
  struct pieces p = { .n_field = s->n_part ? 3 : 2 };
  vg_status st = list_all(comm, s, o->threads, &p, err);

  if (st >= 0)
    st = plan(&p, stem, o->piece_cells ? o->piece_cells : PIECE_CELLS, err);
  st = vg_comm_agree(comm, st, err);
  if (st >= 0) {
    st = open_pieces(comm, &p, err);
    if (st >= 0) st = fill(comm, s, o->threads, &p, err);
    st = close_pieces(comm, &p, stem, st, err);
  }
  for (size_t k = 0; k < p.n_piece && p.piece; k++) free(p.piece[k].path);
  free(p.piece);
  free(p.entry);
  return st;
}
