/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writes a mesh in slices as one .fluent.msh with the bytes of vg_fluent_write.
 *
 * A face is written with the numbers of the cells on its two sides. Faces
 * within a slice are matched locally. The other faces, and those of the
 * boundary, are matched by their points (base/rendezvous.h), and each side
 * receives the cell of the other. Internal faces are sorted by their lower
 * cells, so those of one slice and kind are contiguous in the file. All ranks
 * compute their offset from the counts of all slices. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/rendezvous.h"
#include "core/mesh/cell_links.h"
#include "io/mesh/fluent.h"
#include "io/slices/slices_parts.h"
#include "io/stream/boundary.h"
#include "io/stream/shared_file.h"

/* One side of a face (a half-face), to be matched with the other. */
struct half {
  uint32_t node[4]; /* ascending; the last one of a triangle is UINT32_MAX */
  uint32_t cell;    /* number in the mesh, from 1; 0: a boundary face */
  uint32_t rank, slice, code; /* rank, slice and code in the cell links of
                                 the slice; for a boundary face BOUNDARY and
                                 its position in `order` */
};
#define BOUNDARY UINT32_MAX

/* Reply to a half-face: the cell on the other side. own: its own cell. Both are
 * counted from 0. */
struct reply {
  uint32_t slice, code, cell, own;
};

/* Internal faces whose lower cells belong to one slice and kind. */
struct run {
  uint64_t kind, cell, n, at;
};

struct served {
  struct run run[VG_SLICE_KINDS];
  size_t first, n; /* replies[first .. first + n - 1] are for this slice */
};

struct worker {
  struct vg_items half, *replies; /* replies: [size], by receiving rank */
  uint64_t n_quad, n_open;
  uint32_t open[4]; /* nodes of a face that has no other side */
  vg_status st;
  struct vg_error err;
};

struct writing {
  struct vg_comm *comm;
  const struct vg_slices *s;
  int rank, size, threads;
  struct vg_mesh frame;
  struct vg_fluent layout;
  const struct vg_periodic_links *links;
  size_t *start, *order;          /* boundary faces by patch, from the layout */
  uint64_t first[VG_SLICE_KINDS]; /* first cell of each kind in the mesh */
  uint64_t n_internal, n_quad;
  size_t begin, end;     /* boundary faces that this rank writes */
  uint32_t *cell;        /* [end - begin] their cells, counted from 0 */
  struct served *served; /* [n_slice] */
  struct vg_items
    replies;             /* replies (struct reply), sorted by slice and code */
  struct worker *worker; /* [threads] */
  struct vg_shared_file *to;
};

/* --- a slice ------------------------------------------------------------- */

/* Build the links between the cells of a slice that share faces; local
 * numbers. */
static vg_status link_slice(const struct vg_slice *s, struct vg_mesh *m,
                            struct vg_cell_links *l, struct vg_error *err)
{
  memset(m, 0, sizeof *m);
  m->n_point = s->n_point;
  m->n_tet = s->n_cell[VG_SLICE_TET];
  m->n_pyr = s->n_cell[VG_SLICE_PYR];
  m->n_pri = s->n_cell[VG_SLICE_PRI];
  m->n_hex = s->n_cell[VG_SLICE_HEX];
  m->tet = (uint32_t(*)[4])(uintptr_t)s->cell[VG_SLICE_TET];
  m->pyr = (uint32_t(*)[5])(uintptr_t)s->cell[VG_SLICE_PYR];
  m->pri = (uint32_t(*)[6])(uintptr_t)s->cell[VG_SLICE_PRI];
  m->hex = (uint32_t(*)[8])(uintptr_t)s->cell[VG_SLICE_HEX];
  return vg_cell_links_build(l, m, 1, "a slice of the mesh", err);
}

static int kind_of(const struct vg_cell_links *l, uint32_t cell)
{
  return cell < l->end_tet ? VG_SLICE_TET
       : cell < l->end_pyr ? VG_SLICE_PYR
       : cell < l->end_pri ? VG_SLICE_PRI
                           : VG_SLICE_HEX;
}

/* Number in the mesh of a cell of the slice. */
static uint32_t number_of(const struct writing *w, const struct vg_slice *s,
                          const struct vg_cell_links *l, uint32_t cell)
{
  const uint32_t first[VG_SLICE_KINDS] = { 0, l->end_tet, l->end_pyr,
                                           l->end_pri };
  int kind = kind_of(l, cell);

  return (uint32_t)(w->first[kind] + s->cell_at[kind] + (cell - first[kind]));
}

static void set_key(uint32_t key[4], int n, const uint32_t *node)
{
  key[3] = UINT32_MAX;
  for (int i = 0; i < n; i++) {
    int k = i;

    for (; k && key[k - 1] > node[i]; k--) key[k] = key[k - 1];
    key[k] = node[i];
  }
}

static struct half *add_half(struct worker *to, int n, const uint32_t *node)
{
  struct half *h = vg_items_add(&to->half, sizeof *h);

  if (h) set_key(h->node, n, node);
  else to->st = vg_fail_memory(&to->err, "the faces between slices");
  return h;
}

/* --- matching of faces --------------------------------------------------- */

static void find_mates(struct writing *w, size_t i, const struct vg_slice *s,
                       const struct vg_cell_links *l, struct worker *to)
{
  for (int k = 0; k < VG_SLICE_KINDS; k++)
    w->served[i].run[k] = (struct run){ (uint64_t)k, s->cell_at[k], 0, 0 };
  for (uint32_t cell = 0; cell < l->n_cell; cell++) {
    size_t at = vg_first_half(l, cell);
    int n_face = vg_half_faces(l, cell);
    struct run *run = &w->served[i].run[kind_of(l, cell)];

    for (int f = 0; f < n_face; f++) {
      uint32_t code = cell << 3 | (uint32_t)f, node[4], mate = l->link[at++];
      int n;
      struct half *h;

      if (mate != VG_NO_CELL && mate >> 3 < cell) continue;
      n = vg_half_face_nodes(l, code, node);
      if (mate != VG_NO_CELL) {
        run->n++;
        to->n_quad += n == 4;
        continue;
      }
      for (int k = 0; k < n; k++) node[k] = s->id[node[k]];
      h = add_half(to, n, node);
      if (!h) return;
      h->cell = number_of(w, s, l, cell) + 1;
      h->rank = (uint32_t)w->rank;
      h->slice = (uint32_t)i;
      h->code = code;
    }
  }
}

/* Call `body` with slice i and its cell links. */
static void with_slice(struct writing *w, size_t i, struct worker *to,
                       void (*body)(struct writing *w, size_t i,
                                    const struct vg_slice *s,
                                    const struct vg_cell_links *l,
                                    struct worker *to))
{
  struct vg_cell_links l = VG_CELL_LINKS_INIT;
  struct vg_slice s;
  struct vg_mesh m;

  if (to->st < 0) return;
  to->st = w->s->get(w->s, i, &s, &to->err);
  if (to->st < 0) return;
  to->st = link_slice(&s, &m, &l, &to->err);
  if (to->st >= 0) body(w, i, &s, &l, to);
  vg_cell_links_release(&l);
  w->s->put(w->s, &s);
}

static void find_body(void *context, size_t first, size_t end, int worker)
{
  struct writing *w = context;

  for (size_t i = first; i < end; i++) {
    struct worker *to = &w->worker[worker];

    with_slice(w, i, to, find_mates);
  }
}

/* Add the boundary faces that this rank writes, which need their cells. */
static void add_boundary(struct writing *w)
{
  const struct vg_mesh *m = &w->frame;

  for (size_t at = w->begin; at < w->end; at++) {
    size_t i = w->order[at];
    struct half *h = i < m->n_tri
                     ? add_half(w->worker, 3, m->tri[i])
                     : add_half(w->worker, 4, m->quad[i - m->n_tri]);

    if (!h) return;
    h->cell = 0;
    h->rank = (uint32_t)w->rank;
    h->slice = BOUNDARY;
    h->code = (uint32_t)at;
  }
}

static void tell(struct worker *w, const struct half *to,
                 const struct half *mate)
{
  struct reply *t = vg_items_add(&w->replies[to->rank], sizeof *t);

  if (t)
    *t = (struct reply){ to->slice, to->code, mate->cell - 1, to->cell - 1 };
  else w->st = vg_fail_memory(&w->err, "the faces between slices");
}

static void meet(void *context, const unsigned char *item, size_t n, int worker)
{
  const struct writing *w = context;
  struct worker *to = &w->worker[worker];
  struct half h[2];

  memcpy(h, item, (n < 2 ? n : 2) * sizeof *h);
  if (n != 2 || !(h[0].cell || h[1].cell)) {
    if (!to->n_open++ || memcmp(h->node, to->open, sizeof to->open) < 0)
      memcpy(to->open, h->node, sizeof to->open);
    return;
  }
  to->n_quad += h->node[3] != UINT32_MAX && h[0].cell && h[1].cell;
  for (int k = 0; k < 2; k++)
    if (h[1 - k].cell) tell(to, &h[k], &h[1 - k]);
}

/* --- replies ------------------------------------------------------------- */

static int compare_replies(const void *a, const void *b)
{
  const struct reply *x = a, *y = b;

  if (x->slice != y->slice) return x->slice < y->slice ? -1 : 1;
  return (x->code > y->code) - (x->code < y->code);
}

static vg_status worst(const struct writing *w, struct vg_error *err)
{
  for (int i = 0; i < w->threads; i++)
    if (w->worker[i].st < 0) {
      if (err) *err = w->worker[i].err;
      return w->worker[i].st;
    }
  return VG_OK;
}

/* Send each rank the replies for its half-faces. Collective. */
static vg_status exchange(struct writing *w, struct vg_error *err)
{
  size_t size = (size_t)w->size;
  struct vg_bytes *to = vg_calloc(size, sizeof *to);
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  vg_status st = to && from ? VG_OK
                            : vg_fail_memory(err, "the faces between slices");

  for (size_t r = 0; r < size && st >= 0; r++) {
    struct vg_items all = { 0 };

    for (int t = 0; t < w->threads && st >= 0; t++)
      st = vg_items_append(&all, &w->worker[t].replies[r], sizeof(struct reply),
                           err);
    to[r] = (struct vg_bytes){ all.n * sizeof(struct reply), all.data };
  }
  VG_TRY(vg_comm_agree(w->comm, st, err));
  VG_TRY(vg_comm_exchange(w->comm, to, from, err));
  for (size_t r = 0; r < size && st >= 0; r++) {
    const struct vg_items got = { from[r].n / sizeof(struct reply), 0,
                                  from[r].data };

    st = vg_items_append(&w->replies, &got, sizeof(struct reply), err);
  }
  st = vg_comm_agree(w->comm, st, err);
done:
  vg_bytes_release(to, to ? size : 0);
  vg_bytes_release(from, from ? size : 0);
  return st;
}

/* Sort the replies by slice, and count the faces for which the half-face
 * belongs to the lower cell. */
static void take_replies(struct writing *w)
{
  struct reply *t = (struct reply *)w->replies.data;

  if (w->replies.n) qsort(t, w->replies.n, sizeof *t, compare_replies);
  for (size_t i = 0; i < w->replies.n; i++) {
    struct served *s;
    int kind = VG_SLICE_KINDS - 1;

    if (t[i].slice == BOUNDARY) {
      w->cell[t[i].code - w->begin] = t[i].cell;
      continue;
    }
    s = &w->served[t[i].slice];
    if (!s->n++) s->first = i;
    while (t[i].own < w->first[kind]) kind--;
    s->run[kind].n += t[i].cell > t[i].own;
  }
}

/* --- offsets ------------------------------------------------------------- */

static int compare_run(const void *a, const void *b)
{
  const struct run *x = a, *y = b;

  if (x->kind != y->kind) return x->kind < y->kind ? -1 : 1;
  if (x->cell != y->cell) return x->cell < y->cell ? -1 : 1;
  return (x->n > y->n) - (x->n < y->n); /* runs without faces first */
}

/* Gather the runs of all ranks in order, and compute their offsets.
 * Collective. */
static vg_status gather_runs(struct writing *w, struct vg_items *all,
                             struct vg_error *err)
{
  size_t size = (size_t)w->size, n = w->s->n_slice * VG_SLICE_KINDS;
  struct run *mine = vg_alloc(n, sizeof *mine), *r;
  struct vg_bytes b = { n * sizeof *mine, (unsigned char *)mine };
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  uint64_t at = 0;
  vg_status st = mine && from ? VG_OK
                              : vg_fail_memory(err, "the offsets of faces");

  VG_TRY(vg_comm_agree(w->comm, st, err));
  for (size_t i = 0; i < n; i++)
    mine[i] = w->served[i / VG_SLICE_KINDS].run[i % VG_SLICE_KINDS];
  VG_TRY(vg_comm_allgather(w->comm, &b, from, err));
  for (size_t k = 0; k < size && st >= 0; k++) {
    const struct vg_items got = { from[k].n / sizeof *r, 0, from[k].data };

    st = vg_items_append(all, &got, sizeof *r, err);
  }
  VG_TRY(vg_comm_agree(w->comm, st, err));
  r = (struct run *)all->data;
  if (all->n) qsort(r, all->n, sizeof *r, compare_run);
  for (size_t i = 0; i < all->n; at += r[i++].n) r[i].at = at;
  w->n_internal = at;
done:
  vg_bytes_release(from, from ? size : 0);
  free(mine);
  return st;
}

static vg_status find_places(struct writing *w, struct vg_error *err)
{
  struct vg_items all = { 0 };
  vg_status st = gather_runs(w, &all, err);

  for (size_t i = 0; i < w->s->n_slice && st >= 0; i++)
    for (int k = 0; k < VG_SLICE_KINDS; k++) {
      struct run *run = &w->served[i].run[k];
      const struct run *found = bsearch(run, all.data, all.n, sizeof *run,
                                        compare_run);

      run->at = found->at;
    }
  vg_items_release(&all);
  return st;
}

/* --- writing ------------------------------------------------------------- */

static void put_frame(const void *of, struct vg_output *out)
{
  struct writing *const *w = of;

  vg_fluent_put_frame(out, &(*w)->layout);
}

/* Faces of a cell whose other cell has a higher number, sorted by that number,
 * as vg_foam_upper. *t: next reply for the slice. */
static int find_upper(const struct writing *w, const struct vg_slice *s,
                      const struct vg_cell_links *l, uint32_t cell,
                      const struct reply **t, const struct reply *end,
                      uint32_t code[6], uint32_t mate[6])
{
  size_t at = vg_first_half(l, cell);
  int n_face = vg_half_faces(l, cell), n = 0;

  for (int f = 0; f < n_face; f++) {
    uint32_t link = l->link[at + (size_t)f], here = cell << 3 | (uint32_t)f;
    uint32_t v = 0;
    int k = n, is_upper;

    if (link != VG_NO_CELL) {
      is_upper = link >> 3 > cell;
      if (is_upper) v = number_of(w, s, l, link >> 3);
    } else {
      is_upper = *t < end && (*t)->code == here;
      if (is_upper) {
        v = (*t)->cell;
        is_upper = v > (*t)->own;
        ++*t;
      }
    }
    if (!is_upper) continue;
    for (; k > 0 && mate[k - 1] > v; k--) {
      code[k] = code[k - 1];
      mate[k] = mate[k - 1];
    }
    code[k] = here;
    mate[k] = v;
    n++;
  }
  return n;
}

static void put_faces(const struct writing *w, size_t i,
                      const struct vg_slice *s, const struct vg_cell_links *l,
                      struct vg_output *out)
{
  const struct served *mine = &w->served[i];
  const struct reply *t = (const struct reply *)w->replies.data + mine->first;
  const struct reply *end = t + mine->n;
  uint32_t code[6], mate[6], node[4];
  int last = -1;

  for (uint32_t cell = 0; cell < l->n_cell; cell++) {
    int n = find_upper(w, s, l, cell, &t, end, code, mate);
    int kind = kind_of(l, cell);

    if (kind != last)
      vg_fluent_seek_internal(out, &w->layout, mine->run[kind].at);
    last = kind;
    for (int f = 0; f < n; f++) {
      int n_node = vg_half_face_nodes(l, code[f], node);

      for (int k = 0; k < n_node; k++) node[k] = s->id[node[k]];
      vg_fluent_put_internal(out, &w->layout, n_node, node,
                             number_of(w, s, l, cell), mate[f]);
    }
  }
}

static void put_slice(struct writing *w, size_t i, const struct vg_slice *s,
                      const struct vg_cell_links *l, struct worker *to)
{
  struct vg_output out = VG_OUTPUT_INIT;

  to->st = vg_output_shared(w->to, &out, &to->err);
  if (to->st < 0) return;
  if (s->n_own) vg_fluent_seek_point(&out, &w->layout, s->point_at);
  for (size_t k = 0; k < s->n_own; k++)
    vg_fluent_put_point(&out, s->x[s->own[k]]);
  for (int k = 0; k < VG_SLICE_KINDS; k++)
    if (s->n_cell[k])
      vg_fluent_put_kinds(&out, &w->layout, k, s->cell_at[k], s->n_cell[k]);
  put_faces(w, i, s, l, &out);
  to->st = vg_output_flush(&out, &to->err);
  vg_output_release(&out);
}

static void put_body(void *context, size_t first, size_t end, int worker)
{
  struct writing *w = context;

  for (size_t i = first; i < end; i++)
    with_slice(w, i, &w->worker[worker], put_slice);
}

/* The boundary faces that a rank writes are contiguous in `order`, and in the
 * file except for the headers of zones. */
static vg_status put_boundary(const struct writing *w, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_shared(w->to, &out, err);

  for (size_t at = w->begin, p = 0; at < w->end && st >= 0; at++) {
    if (at == w->begin || at == w->start[p + 1]) {
      while (w->start[p + 1] <= at) p++;
      vg_fluent_seek_boundary(&out, &w->layout, at);
    }
    vg_fluent_put_boundary(&out, &w->layout, at, w->cell[at - w->begin]);
  }
  if (st >= 0) st = vg_output_flush(&out, err);
  vg_output_release(&out);
  return st;
}

/* --- all ----------------------------------------------------------------- */

static vg_status prepare(struct writing *w, struct vg_error *err)
{
  size_t n_face = w->frame.n_tri + w->frame.n_quad, size = (size_t)w->size;
  vg_status st = vg_boundary_by_patch(&w->frame, &w->start, &w->order, err);

  if (st < 0) return st;
  w->begin = n_face * (size_t)w->rank / size;
  w->end = n_face * ((size_t)w->rank + 1) / size;
  w->cell = vg_calloc(w->end - w->begin, sizeof *w->cell);
  w->served = vg_calloc(w->s->n_slice, sizeof *w->served);
  w->worker = vg_calloc((size_t)w->threads, sizeof *w->worker);
  if (!w->cell || !w->served || !w->worker)
    return vg_fail_memory(err, "a file in slices");
  for (int t = 0; t < w->threads; t++) {
    w->worker[t].replies = vg_calloc(size, sizeof *w->worker[t].replies);
    if (!w->worker[t].replies) return vg_fail_memory(err, "a file in slices");
  }
  return VG_OK;
}

/* Sum the counts of all ranks, and check that every face has two sides.
 * Collective. */
struct sums {
  uint64_t n_quad, n_open;
  uint32_t open[4];
};

static vg_status add_sums(struct writing *w, const char *path,
                          struct vg_error *err)
{
  size_t size = (size_t)w->size;
  struct sums mine = { 0 }, all = { 0 };
  struct vg_bytes b = { sizeof mine, (unsigned char *)&mine };
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  vg_status st = from ? VG_OK : vg_fail_memory(err, "the offsets of faces");

  VG_TRY(vg_comm_agree(w->comm, st, err));
  for (int t = 0; t < w->threads; t++) {
    mine.n_quad += w->worker[t].n_quad;
    if (w->worker[t].n_open && !mine.n_open)
      memcpy(mine.open, w->worker[t].open, sizeof mine.open);
    mine.n_open += w->worker[t].n_open;
  }
  VG_TRY(vg_comm_allgather(w->comm, &b, from, err));
  for (size_t r = 0; r < size; r++) {
    const struct sums *got = (const struct sums *)from[r].data;

    all.n_quad += got->n_quad;
    if (got->n_open && !all.n_open)
      memcpy(all.open, got->open, sizeof all.open);
    all.n_open += got->n_open;
  }
  w->n_quad = all.n_quad;
  if (all.n_open)
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: cells and boundary are not closed: %llu faces have no "
                 "other side, or more than one; the first has points %lu, "
                 "%lu, %lu",
                 path, (unsigned long long)all.n_open, all.open[0] + 1ul,
                 all.open[1] + 1ul, all.open[2] + 1ul);
done:
  vg_bytes_release(from, from ? size : 0);
  return st;
}

/* Find the cells on both sides of all faces. Collective. */
static vg_status match(struct writing *w, const char *path,
                       struct vg_error *err)
{
  const struct vg_rendezvous m = { .comm = w->comm,
                                   .threads = w->threads,
                                   .size = sizeof(struct half),
                                   .key = sizeof((struct half *)0)->node,
                                   .group = meet,
                                   .context = w };
  vg_status st;

  vg_parallel_for(w->threads, w->s->n_slice, 1, find_body, w);
  add_boundary(w);
  VG_TRY(vg_comm_agree(w->comm, worst(w, err), err));
  VG_TRY(vg_rendezvous_run(&m, &w->worker->half, (size_t)w->threads,
                           sizeof *w->worker, err));
  VG_TRY(vg_comm_agree(w->comm, worst(w, err), err));
  VG_TRY(add_sums(w, path, err));
  VG_TRY(exchange(w, err));
  take_replies(w);
  st = find_places(w, err);
done:
  return st;
}

static vg_status write_file(struct writing *w, const char *path,
                            struct vg_error *err)
{
  const struct vg_slice_file file = { path, 0, &w, put_frame, NULL };
  vg_status st = vg_fluent_plan(path, &w->frame, w->n_internal, w->n_quad,
                                &w->layout, err);

  w->layout.links = w->links;
  if (st >= 0 && w->links) st = vg_fluent_number_faces(&w->layout, err);
  VG_TRY(vg_comm_agree(w->comm, st, err));
  VG_TRY(vg_slice_file_open(&file, w->comm, &w->to, err));
  if (!w->rank) st = vg_slice_file_put(&file, w->to, NULL, err);
  if (st >= 0) st = put_boundary(w, err);
  if (st >= 0) {
    vg_parallel_for(w->threads, w->s->n_slice, 1, put_body, w);
    st = worst(w, err);
  }
  st = vg_shared_close(w->to, st, err);
done:
  return st;
}

static void release(struct writing *w)
{
  for (int t = 0; w->worker && t < w->threads; t++) {
    for (int r = 0; w->worker[t].replies && r < w->size; r++)
      vg_items_release(&w->worker[t].replies[r]);
    free(w->worker[t].replies);
    vg_items_release(&w->worker[t].half);
  }
  free(w->worker);
  free(w->served);
  free(w->cell);
  free(w->start);
  free(w->order);
  vg_items_release(&w->replies);
  vg_fluent_release(&w->layout);
}

vg_status vg_slices_write_fluent(struct vg_comm *comm,
                                 const struct vg_slices *s, const char *path,
                                 const struct vg_slices_options *o,
                                 struct vg_error *err)
{
  struct writing w = { .comm = comm,
                       .s = s,
                       .rank = vg_comm_rank(comm),
                       .size = vg_comm_size(comm),
                       .threads = o->threads > 0 ? o->threads : vg_cores(),
                       .links = o->links,
                       .frame = vg_slices_frame(s) };
  vg_status st;

  if (s->boundary->n_sheet)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: a distributed mesh with sheets cannot be written in "
                   "this form",
                   path);
  for (int k = 1; k < VG_SLICE_KINDS; k++)
    w.first[k] = w.first[k - 1] + s->n_cell[k - 1];
  VG_TRY(vg_comm_agree(comm, prepare(&w, err), err));
  VG_TRY(match(&w, path, err));
  st = write_file(&w, path, err);
done:
  release(&w);
  return st;
}
