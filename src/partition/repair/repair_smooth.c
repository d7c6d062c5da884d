/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Swaps and smoothing across interfaces, and the bad cells that remain there.
 *
 * A task can move neither the points of its front nor, in a zone, the points
 * that it leaves to others, and it cannot swap across that front. This is done
 * here afterwards. Each piece sends its cells with corners among the points of
 * another piece (halos) to the rank of that piece. The owner smooths its
 * points there. The other points of those cells are then smoothed, each in its
 * own piece. Finally the owner swaps cells that are not good, and smooths
 * again. In a region of uniform size the first pass is enough.
 *
 * Of two points of different zones that share a cell, in the first pass the
 * point of the zone with the earlier path may move, in the second pass that of
 * the later path. Swaps are made only among cells that no other zone may
 * change. Owners are therefore independent of each other, and the result is
 * independent of ranks. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/delaunay/tets.h"
#include "partition/repair/repair_parts.h"

/* Sizes count as uniform when fewer than one in this many cells at interfaces
 * would be swapped: it is one in 50 on a box, and one in 8 where sizes vary. */
enum { LEVEL = 30 }; /* R5 */

enum { FIND, SMOOTH, ADJACENT, SWAP, N_SPAN };

/* State of a piece. */
struct outcome {
  size_t n_halo;
  struct vg_halo *halo; /* [n_halo] Its cells around points of other pieces. */
  size_t n_hit;
  uint32_t *hit;   /* [n_hit] Its cells with a corner on an interface. */
  uint8_t *moved;  /* [n_point] or NULL: no halos. */
  uint8_t *shared; /* [n_point] Interface points of a zone, or NULL. */
  struct vg_spots bad;
  size_t n_moved, n_swap;
  size_t n_cell, n_fair;       /* Cells around its points; those that would be
                                  swapped. */
  struct vg_edit edit;         /* Swapped cells. */
  struct vg_span span[N_SPAN]; /* Trace of the steps for it. */
  vg_status st;
};

struct smoothing {
  struct vg_partition *p;
  const struct vg_owners *owners;
  const struct vg_repair_levels *level;
  int first;           /* 1: the first of two passes. */
  struct outcome *out; /* [n_piece] */
  size_t n_far, cap_far;
  struct vg_halo *far; /* [n_far] From other ranks. */
  size_t n_halo;
  struct vg_halo **halo; /* [n_halo] Around points of this rank, by owner and
                            by the path of the piece that has the cells. */
  size_t *first_halo;    /* [n_piece + 1] First halo of each piece. */
};

static void smoothing_free(struct smoothing *s)
{
  for (size_t k = 0; s->out && k < s->p->n_piece; k++) {
    struct outcome *o = &s->out[k];

    for (size_t i = 0; i < o->n_halo; i++) vg_halo_release(&o->halo[i]);
    free(o->halo);
    free(o->moved);
    free(o->shared);
    free(o->hit);
    free(o->bad.at);
    vg_edit_release(&o->edit);
  }
  for (size_t i = 0; i < s->n_far; i++) vg_halo_release(&s->far[i]);
  free(s->out);
  free(s->far);
  free(s->halo);
  free(s->first_halo);
}

/* --- sending halos to the owners ----------------------------------------- */

static void halo_body(void *context, size_t first, size_t end, int worker)
{
  struct smoothing *s = context;

  for (size_t k = first; k < end; k++) {
    struct outcome *o = &s->out[k];
    const struct vg_piece *q = &s->p->piece[k];

    vg_repair_begin(&o->span[FIND], worker);
    o->st = vg_halos_of(s->p, k, s->owners, &o->n_halo, &o->halo, &o->n_hit,
                        &o->hit);
    vg_repair_end(&o->span[FIND], "C", q->serial, q->n_cell);
  }
}

static vg_status agreed(const struct smoothing *s, struct vg_error *err)
{
  for (size_t k = 0; k < s->p->n_piece; k++)
    if (s->out[k].st < 0) return vg_fail_memory(err, "repairs");
  return VG_OK;
}

static vg_status make_halos(struct smoothing *s, struct vg_outbox *post,
                            struct vg_error *err)
{
  vg_status st;

  s->out = vg_calloc(s->p->n_piece, sizeof *s->out);
  if (!s->out) return vg_fail_memory(err, "repairs");
  vg_parallel_for(s->p->options.threads, s->p->n_piece, 1, halo_body, s);
  st = agreed(s, err);
  if (st == VG_OK) st = vg_outbox_new(post, s->p->size, err);
  for (size_t k = 0; st == VG_OK && k < s->p->n_piece; k++)
    for (size_t i = 0; i < s->out[k].n_halo; i++) {
      const struct vg_halo *halo = &s->out[k].halo[i];

      if (halo->to != (uint32_t)s->p->rank)
        vg_halo_put(&post->to[halo->to], halo);
      else s->n_halo++;
    }
  return st;
}

static vg_status take_far(struct smoothing *s, const struct vg_bytes *from,
                          struct vg_error *err)
{
  for (int r = 0; r < s->p->size; r++) {
    struct vg_reader in = { .data = from[r].data, .n = from[r].n };

    while (in.at < in.n) {
      if (vg_reserve(&s->far, &s->cap_far, s->n_far + 1, sizeof *s->far))
        return vg_fail_memory(err, "repairs");
      vg_halo_get(&in, &s->far[s->n_far]);
      if (in.bad) return vg_fail_damaged(err, "repairs");
      s->n_far++;
    }
  }
  return VG_OK;
}

static int by_owner(const void *a, const void *b)
{
  const struct vg_halo *s = *(struct vg_halo *const *)a;
  const struct vg_halo *t = *(struct vg_halo *const *)b;

  if (s->owner != t->owner) return s->owner < t->owner ? -1 : 1;
  return s->order < t->order ? -1 : s->order > t->order;
}

/* Sorts the halos by owner; those of this rank stay where they are. */
static vg_status sort_halos(struct smoothing *s, struct vg_error *err)
{
  size_t n = 0, n_piece = s->p->n_piece;

  s->n_halo += s->n_far;
  s->halo = vg_alloc(s->n_halo, sizeof *s->halo);
  s->first_halo = vg_calloc(n_piece + 1, sizeof *s->first_halo);
  if (!s->halo || !s->first_halo) return vg_fail_memory(err, "repairs");
  for (size_t k = 0; k < n_piece; k++)
    for (size_t i = 0; i < s->out[k].n_halo; i++) {
      struct vg_halo *halo = &s->out[k].halo[i];

      if (halo->to == (uint32_t)s->p->rank) s->halo[n++] = halo;
    }
  for (size_t i = 0; i < s->n_far; i++) s->halo[n++] = &s->far[i];
  if (n) qsort(s->halo, n, sizeof *s->halo, by_owner);
  for (size_t i = 0; i < n; i++) s->first_halo[s->halo[i]->owner + 1] = i + 1;
  for (size_t k = 0; k < n_piece; k++)
    if (s->first_halo[k + 1] < s->first_halo[k])
      s->first_halo[k + 1] = s->first_halo[k];
  return VG_OK;
}

static vg_status send_halos(struct smoothing *s, struct vg_comm *comm,
                            struct vg_error *err)
{
  struct vg_outbox post = { 0 };
  struct vg_bytes *from = NULL;
  vg_status st = make_halos(s, &post, err);

  st = vg_outbox_send(&post, comm, st, &from, err);
  if (st < 0) return st;
  st = take_far(s, from, err);
  if (st == VG_OK) st = sort_halos(s, err);
  vg_bytes_release(from, (size_t)s->p->size);
  return vg_comm_agree(comm, st, err);
}

/* --- smoothing of one owner ---------------------------------------------- */

static vg_status smooth(struct vg_overlap *f,
                        const struct vg_repair_levels *level,
                        struct outcome *out)
{
  struct vg_optimise_report r;
  size_t n_in = f->q->n_in;

  f->t.flag = vg_calloc(f->t.n_cell, 1);
  if (!f->t.flag ||
      vg_optimise_points(&f->t, f->n_point, f->point,
                         f->first ? level->smooth : level->adjacent, f->sizing,
                         f->metrics, f->shape, &r, NULL) < 0)
    return VG_ERR_MEMORY;
  for (size_t i = 0; i < f->n_point; i++) {
    uint32_t v = f->point[i];
    double *x = f->q->x[v];

    if (!memcmp(x, f->t.x[v], sizeof *f->t.x)) continue;
    memcpy(x, f->t.x[v], sizeof *f->t.x);
    out->moved[v - n_in] = 1;
    out->n_moved++;
  }
  return VG_OK;
}

/* Lists bad cells, and counts the cells that would be swapped. */
static vg_status list_bad(const struct vg_overlap *f,
                          const struct vg_repair_levels *level,
                          struct outcome *out)
{
  out->n_cell = f->t.n_cell;
  out->n_fair = 0;
  for (size_t c = 0; c < f->t.n_cell; c++) {
    const uint32_t *v = f->t.cell[c].v;
    const double *x[4];

    out->n_fair += f->shape[c] < level->swap;
    if (f->kind[c] & VG_OVERLAP_CLAIMED || f->shape[c] >= level->target)
      continue;
    for (int i = 0; i < 4; i++) x[i] = f->t.x[v[i]];
    if (vg_spots_add(&out->bad, f->sizing, x, f->shape[c]) < 0)
      return VG_ERR_MEMORY;
  }
  return VG_OK;
}

/* Adds the cells at a zone's own interface points to those at points of other
 * pieces, and keeps the marks of these points. */
static vg_status keep_hits(struct vg_overlap *f, struct outcome *out)
{
  size_t n = out->n_hit, k = 0, m = 0, n_all = 0;
  uint32_t *all = vg_alloc(n + f->n_own, sizeof *all);

  if (!all) return VG_ERR_MEMORY;
  while (k < n || m < f->n_own) {
    uint32_t a = k < n ? out->hit[k] : UINT32_MAX;
    uint32_t b = m < f->n_own ? f->place[m] : UINT32_MAX;

    k += a <= b;
    m += b <= a;
    all[n_all++] = a < b ? a : b;
  }
  free(out->hit);
  out->hit = all;
  out->n_hit = n_all;
  out->shared = f->shared;
  f->shared = NULL;
  return VG_OK;
}

static vg_status smooth_piece(const struct smoothing *s, size_t k,
                              struct outcome *out)
{
  const struct vg_piece *q = &s->p->piece[k];
  struct vg_overlap f = { .q = q,
                          .sizing = s->p->sizing,
                          .halo = s->halo + s->first_halo[k],
                          .n_halo = s->first_halo[k + 1] - s->first_halo[k],
                          .self = vg_owners_find(s->owners,
                                                 VG_POINT_ID(q->serial, 0)) };
  vg_status st;

  free(out->moved);
  out->moved = vg_calloc(q->n_point, 1);
  st = out->moved ? vg_overlap_new(&f, s->owners, s->first) : VG_ERR_MEMORY;
  if (st == VG_OK && !s->first && f.self->is_zone)
    st = vg_overlap_swap(&f, &out->edit, &out->n_swap);
  if (st == VG_OK) st = smooth(&f, s->level, out);
  if (st == VG_OK) st = list_bad(&f, s->level, out);
  if (st == VG_OK && out->n_swap) st = vg_overlap_take(&f, &out->edit);
  if (st == VG_OK && s->first && f.self->is_zone) st = keep_hits(&f, out);
  vg_overlap_release(&f);
  return st;
}

static void smooth_body(void *context, size_t first, size_t end, int worker)
{
  struct smoothing *s = context;

  for (size_t k = first; k < end; k++) {
    struct outcome *o = &s->out[k];
    struct vg_span *span = &o->span[s->first ? SMOOTH : SWAP];
    size_t before = o->n_moved;

    if (s->first_halo[k + 1] == s->first_halo[k]) continue;
    vg_repair_begin(span, worker);
    o->st = smooth_piece(s, k, o);
    vg_repair_end(span, s->first ? "S" : "W", s->p->piece[k].serial,
                  o->n_moved - before);
  }
}

/* --- returning updates --------------------------------------------------- */

/* New coordinates of a point that belongs to another piece. */
struct update {
  uint32_t piece, vertex;
  double x[3];
};

/* The owner's answer to a halo: moved points and replaced cells. */
static void put_updates(const struct smoothing *s, const struct vg_halo *halo,
                        struct vg_writer *w)
{
  const struct vg_piece *q = &s->p->piece[halo->owner];
  const uint8_t *moved = s->out[halo->owner].moved;
  uint32_t head[3] = { halo->from, 0, halo->n_gone };

  for (size_t i = 0; i < halo->n_known; i++) head[1] += moved[halo->known[i]];
  if (!head[1] && !head[2]) return;
  vg_put(w, 3, sizeof *head, head);
  for (size_t i = 0; i < halo->n_known; i++) {
    struct update n = { .piece = halo->from, .vertex = halo->vertex[i] };

    if (!moved[halo->known[i]]) continue;
    memcpy(n.x, q->x[q->n_in + halo->known[i]], sizeof n.x);
    vg_put(w, 1, sizeof n, &n);
  }
  vg_put(w, halo->n_gone, sizeof *halo->place, halo->place);
}

static vg_status drop_cells(struct smoothing *s, uint32_t piece, size_t n,
                            const uint32_t *cell)
{
  struct vg_edit *e = &s->out[piece].edit;

  if (n && !e->gone) e->gone = vg_calloc(s->p->piece[piece].n_cell, 1);
  if (n && !e->gone) return VG_ERR_MEMORY;
  for (size_t k = 0; k < n; k++) e->gone[cell[k]] = 1;
  return VG_OK;
}

static int is_vertex(const struct vg_partition *p, uint32_t piece,
                     uint32_t vertex)
{
  return piece < p->n_piece &&
         vertex < p->piece[piece].n_in + p->piece[piece].n_point;
}

static vg_status take_updates(struct smoothing *s, const struct vg_bytes *from,
                              struct vg_error *err)
{
  for (int r = 0; r < s->p->size; r++) {
    struct vg_reader in = { .data = from[r].data, .n = from[r].n };

    while (in.at < in.n) {
      uint32_t head[3] = { 0 }, *cell;
      struct update n;
      vg_status st;

      vg_get(&in, 3, sizeof *head, head);
      for (uint32_t k = 0; k < head[1]; k++) {
        vg_get(&in, 1, sizeof n, &n);
        if (in.bad || !is_vertex(s->p, n.piece, n.vertex))
          return vg_fail_damaged(err, "repairs");
        memcpy(s->p->piece[n.piece].x[n.vertex], n.x, sizeof n.x);
      }
      cell = vg_get_array(&in, head[2], sizeof *cell);
      st = in.bad ? vg_fail_damaged(err, "repairs")
                  : drop_cells(s, head[0], head[2], cell);
      free(cell);
      if (st < 0) return in.bad ? st : vg_fail_memory(err, "repairs");
    }
  }
  return VG_OK;
}

/* Updates on this rank: no other thread writes to these vertices. */
static void put_back_body(void *context, size_t first, size_t end, int worker)
{
  struct smoothing *s = context;

  (void)worker;
  for (size_t k = first; k < end; k++) {
    const struct vg_halo *halo = s->halo[k];
    const struct vg_piece *q = &s->p->piece[halo->owner];
    const struct vg_piece *to = &s->p->piece[halo->from];

    if (halo->rank != (uint32_t)s->p->rank) continue;
    for (size_t i = 0; i < halo->n_known; i++)
      if (s->out[halo->owner].moved[halo->known[i]])
        memcpy(to->x[halo->vertex[i]], q->x[q->n_in + halo->known[i]],
               sizeof *to->x);
  }
}

static vg_status send_back(struct smoothing *s, struct vg_comm *comm,
                           vg_status st, struct vg_error *err)
{
  struct vg_outbox post = { 0 };
  struct vg_bytes *from = NULL;

  if (st == VG_OK) st = vg_outbox_new(&post, s->p->size, err);
  for (size_t i = 0; st == VG_OK && i < s->n_far; i++)
    put_updates(s, &s->far[i], &post.to[s->far[i].rank]);
  st = vg_outbox_send(&post, comm, st, &from, err);
  if (st < 0) return st;
  vg_parallel_for(s->p->options.threads, s->n_halo, 16, put_back_body, s);
  st = take_updates(s, from, err);
  vg_bytes_release(from, (size_t)s->p->size);
  for (size_t k = 0; st == VG_OK && k < s->n_halo; k++)
    if (s->halo[k]->rank == (uint32_t)s->p->rank &&
        drop_cells(s, s->halo[k]->from, s->halo[k]->n_gone, s->halo[k]->place) <
          0)
      st = vg_fail_memory(err, "repairs");
  return st;
}

/* --- between the two passes ---------------------------------------------- */

static void adjacent_body(void *context, size_t first, size_t end, int worker)
{
  struct smoothing *s = context;

  for (size_t k = first; k < end; k++) {
    struct outcome *o = &s->out[k];
    const struct vg_piece *q = &s->p->piece[k];

    o->bad.n = 0;
    if (!o->n_halo && !o->n_hit) continue;
    vg_repair_begin(&o->span[ADJACENT], worker);
    o->st = vg_repair_adjacent(q, s->p->sizing, o->n_hit, o->hit, o->shared,
                               &o->bad);
    for (size_t i = 0; i < o->n_halo; i++) vg_halo_refresh(q, &o->halo[i]);
    vg_repair_end(&o->span[ADJACENT], "B", q->serial, o->n_hit);
  }
}

/* Updates the halos of other ranks, which arrive in the order in which their
 * rank has them. */
static vg_status refresh_far(struct smoothing *s, const struct vg_bytes *from)
{
  struct vg_reader in = { 0 };

  for (size_t i = 0; i < s->n_far; i++) {
    struct vg_halo *halo = &s->far[i];

    if (!i || halo->rank != halo[-1].rank)
      in = (struct vg_reader){ .data = from[halo->rank].data,
                               .n = from[halo->rank].n };
    vg_get(&in, halo->n_other, sizeof *halo->x, halo->x);
    if (in.bad) return VG_ERR_FORMAT;
  }
  return VG_OK;
}

static vg_status go_between(struct smoothing *s, struct vg_comm *comm,
                            struct vg_error *err)
{
  struct vg_outbox post = { 0 };
  struct vg_bytes *from = NULL;
  vg_status st;

  vg_parallel_for(s->p->options.threads, s->p->n_piece, 1, adjacent_body, s);
  st = agreed(s, err);
  if (st == VG_OK) st = vg_outbox_new(&post, s->p->size, err);
  for (size_t k = 0; st == VG_OK && k < s->p->n_piece; k++)
    for (size_t i = 0; i < s->out[k].n_halo; i++) {
      const struct vg_halo *halo = &s->out[k].halo[i];

      if (halo->to != (uint32_t)s->p->rank)
        vg_put(&post.to[halo->to], halo->n_other, sizeof *halo->x, halo->x);
    }
  st = vg_outbox_send(&post, comm, st, &from, err);
  if (st < 0) return st;
  if (refresh_far(s, from) < 0) st = vg_fail_damaged(err, "repairs");
  vg_bytes_release(from, (size_t)s->p->size);
  return vg_comm_agree(comm, st, err);
}

/* --- all steps ----------------------------------------------------------- */

static void edit_body(void *context, size_t first, size_t end, int worker)
{
  struct smoothing *s = context;

  (void)worker;
  for (size_t k = first; k < end; k++)
    if (s->out[k].edit.gone)
      s->out[k].st = vg_piece_edit(&s->p->piece[k], &s->out[k].edit);
}

static vg_status once(struct smoothing *s, int first, struct vg_comm *comm,
                      struct vg_error *err)
{
  vg_status st;

  s->first = first;
  vg_parallel_for(s->p->options.threads, s->p->n_piece, 1, smooth_body, s);
  st = send_back(s, comm, agreed(s, err), err);
  return vg_comm_agree(comm, st, err);
}

/* Are the sizes uniform, so that one sweep is sufficient? */
static vg_status is_uniform(const struct smoothing *s, struct vg_comm *comm,
                            int *level, struct vg_error *err)
{
  uint64_t n[2] = { 0, 0 };
  vg_status st;

  for (size_t k = 0; k < s->p->n_piece; k++) {
    n[0] += s->out[k].n_fair;
    n[1] += s->out[k].n_cell;
  }
  st = vg_comm_sum(comm, 2, n, err);
  *level = n[0] * LEVEL < n[1];
  return st;
}

static vg_status report(const struct smoothing *s, struct vg_spans *spans,
                        struct vg_writer *w, struct vg_error *err)
{
  struct vg_partition_report *r = &s->p->report;
  vg_status st = VG_OK;

  for (size_t k = 0; k < s->p->n_piece; k++) {
    const struct outcome *o = &s->out[k];

    r->n_repair_moved += o->n_moved;
    r->n_repair_swapped += o->n_swap;
    vg_put(w, o->bad.n, sizeof *o->bad.at, o->bad.at);
    for (int i = 0; i < N_SPAN; i++)
      if (o->span[i].kind) VG_TRY(vg_spans_add(spans, &o->span[i], err));
  }
done:
  return st;
}

vg_status vg_repair_smooth(struct vg_partition *p, struct vg_comm *comm,
                           const struct vg_owners *owners,
                           struct vg_spans *spans, size_t *n,
                           struct vg_spot **out, struct vg_error *err)
{
  struct smoothing s = { .p = p,
                         .owners = owners,
                         .level = vg_repair_levels(p->sizing) };
  struct vg_writer w = { .cap = 0 };
  int level = 1;
  vg_status st = send_halos(&s, comm, err);

  *n = 0;
  if (st == VG_OK) st = once(&s, 1, comm, err);
  if (st == VG_OK) st = is_uniform(&s, comm, &level, err);
  if (st == VG_OK && !level) {
    st = go_between(&s, comm, err);
    if (st == VG_OK) st = once(&s, 0, comm, err);
  }
  if (st == VG_OK) {
    vg_parallel_for(p->options.threads, p->n_piece, 1, edit_body, &s);
    st = agreed(&s, err);
    if (st == VG_OK) st = report(&s, spans, &w, err);
    st = vg_comm_agree(comm, st, err);
  }
  if (st == VG_OK) st = vg_spots_gather(&w, p->size, comm, n, out, err);
  free(w.bytes.data);
  smoothing_free(&s);
  return st;
}
