/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Repairs: gathers cells by cluster, repairs them, and puts them back as
 * pieces. */
#include "partition/repair/repair.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/clock.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/predicates.h"
#include "partition/repair/repair_parts.h"

/* Maximum number of balls per cluster, with a few hundred cells each. The
 * remaining balls are processed in further rounds. */
enum { MOST_BALLS = 100, ROUNDS = 3 }; /* R6 */

/* Cells of a piece that belong to clusters. */
struct picks {
  size_t n, cap;
  struct vg_key *at; /* [n] Cells by cluster. */
  size_t n_taken, cap_taken;
  /* [n_taken] Cells that also have a corner in the balls of a further
   * cluster, by the cluster that has them. */
  struct vg_key *taken;
  vg_status st;
};

static void picks_release(struct picks *s)
{
  free(s->at);
  free(s->taken);
  memset(s, 0, sizeof *s);
}

/* State of one round. */
struct repair {
  struct vg_partition *p;
  struct vg_owners owners;
  struct vg_spot_grid balls;
  struct picks *pick; /* [n_piece] */
  size_t n_block, cap_block;
  struct vg_cluster_cells *block;     /* Cells of the clusters of this rank, by
                                         cluster and path. */
  struct vg_repair_boundary boundary; /* Boundary triangles between their
                                         points. */
  size_t n_job;
  size_t *first;                /* [n_job + 1] First block. */
  struct vg_repaired *repaired; /* [n_job] */
  struct vg_span *span;         /* [n_job] */
  vg_status *st;                /* [n_job] */
  uint64_t *better;             /* [n_cluster] Improved, on any rank. */
  size_t number;                /* Clusters of earlier rounds. */
  struct vg_spans *spans;       /* Tasks of this rank. */
};

static void repair_free(struct repair *r)
{
  for (size_t k = 0; r->pick && k < r->p->n_piece; k++)
    picks_release(&r->pick[k]);
  for (size_t k = 0; k < r->n_block; k++)
    vg_cluster_cells_release(&r->block[k]);
  for (size_t k = 0; r->repaired && k < r->n_job; k++)
    vg_repaired_release(&r->repaired[k]);
  free(r->pick);
  free(r->block);
  free(r->first);
  free(r->repaired);
  free(r->span);
  free(r->st);
  free(r->better);
  free(r->owners.at);
  vg_spot_grid_release(&r->balls);
  vg_repair_boundary_release(&r->boundary);
}

/* --- selection of cells -------------------------------------------------- */

static int add(size_t *n, size_t *cap, struct vg_key **list, uint32_t cluster,
               size_t cell)
{
  if (vg_reserve(list, cap, *n + 1, sizeof **list)) return -1;
  (*list)[(*n)++] = (struct vg_key){ cluster, (uint32_t)cell };
  return 0;
}

/* A cell with corners in the balls of two clusters belongs to the first one. */
static vg_status pick_in(const struct vg_piece *q, const uint32_t *in,
                         struct picks *s)
{
  for (size_t c = 0; c < q->n_cell; c++) {
    uint32_t v[4], least = VG_NO_CLUSTER, all = VG_NO_CLUSTER;
    int taken = 0;

    vg_piece_cell(q, c, v);
    for (int i = 0; i < 4; i++) {
      all &= in[v[i]];
      if (in[v[i]] < least) least = in[v[i]];
    }
    if (all == VG_NO_CLUSTER) continue;
    for (int i = 0; i < 4; i++)
      taken |= in[v[i]] != least && in[v[i]] != VG_NO_CLUSTER;
    if (add(&s->n, &s->cap, &s->at, least, c) ||
        (taken && add(&s->n_taken, &s->cap_taken, &s->taken, least, c)))
      return VG_ERR_MEMORY;
  }
  return vg_sort_keys(s->n, s->at, NULL);
}

static void pick_body(void *context, size_t first, size_t end, int worker)
{
  struct repair *r = context;

  (void)worker;
  for (size_t k = first; k < end; k++) {
    const struct vg_piece *q = &r->p->piece[k];
    size_t n = q->n_in + q->n_point;
    uint32_t *in = vg_alloc(n, sizeof *in), all = VG_NO_CLUSTER;

    for (size_t i = 0; in && i < n; i++) {
      in[i] = vg_spot_grid_at(&r->balls, q->x[i]);
      all &= in[i];
    }
    if (!in) r->pick[k].st = VG_ERR_MEMORY;
    else if (all != VG_NO_CLUSTER) r->pick[k].st = pick_in(q, in, &r->pick[k]);
    free(in);
  }
}

static vg_status pick(struct repair *r, struct vg_error *err)
{
  size_t n = r->p->n_piece;

  r->pick = vg_calloc(n, sizeof *r->pick);
  if (!r->pick) return vg_fail_memory(err, "repairs");
  vg_parallel_for(r->p->options.threads, n, 1, pick_body, r);
  for (size_t k = 0; k < n; k++)
    if (r->pick[k].st < 0) return vg_fail_memory(err, "repairs");
  return VG_OK;
}

/* --- transfer to the repairing ranks ------------------------------------- */

static uint64_t name_of(const struct vg_piece *q, uint32_t v)
{
  return v < q->n_in ? q->in[v] : VG_POINT_ID(q->serial, v - q->n_in);
}

/* Sends corners in the ball of a further cluster, which does not get the cell
 * and must therefore hold these points fixed. */
static void put_taken(struct repair *r, const struct vg_piece *q,
                      const struct vg_key *taken, struct vg_outbox *post)
{
  uint32_t corner[4];

  vg_piece_cell(q, taken->index, corner);
  for (int i = 0; i < 4; i++) {
    uint32_t v = corner[i], cluster = vg_spot_grid_at(&r->balls, q->x[v]);
    uint64_t name = name_of(q, v);
    uint8_t hold = 1;
    struct vg_cluster_cells b = { .cluster = cluster,
                                  .n_point = 1,
                                  .name = &name,
                                  .x = &q->x[v],
                                  .hold = &hold };

    if (cluster == VG_NO_CLUSTER || cluster == taken->key) continue;
    memcpy(b.path, q->path, sizeof b.path);
    vg_cluster_cells_put(&post->to[cluster % (uint32_t)r->p->size], &b);
  }
}

/* Makes the block of one cluster: pick [n]. number: [n points],
 * VG_NO_CLUSTER. */
static void fill_block(const struct vg_piece *q, size_t n,
                       const struct vg_key *pick, uint32_t *number,
                       struct vg_cluster_cells *b)
{
  uint32_t v[4];

  b->cluster = (uint32_t)pick->key;
  b->n_point = 0;
  b->n_cell = n;
  memcpy(b->path, q->path, sizeof b->path);
  for (size_t c = 0; c < n; c++) {
    vg_piece_cell(q, pick[c].index, v);
    for (int i = 0; i < 4; i++) {
      if (number[v[i]] == VG_NO_CLUSTER) {
        b->name[b->n_point] = name_of(q, v[i]);
        memcpy(b->x[b->n_point], q->x[v[i]], sizeof *b->x);
        number[v[i]] = (uint32_t)b->n_point++;
      }
      b->cell[c][i] = number[v[i]];
    }
  }
  for (size_t c = 0; c < n; c++) {
    vg_piece_cell(q, pick[c].index, v);
    for (int i = 0; i < 4; i++) number[v[i]] = VG_NO_CLUSTER;
  }
}

static vg_status put_piece(struct repair *r, size_t k, struct vg_outbox *post,
                           struct vg_error *err)
{
  const struct vg_piece *q = &r->p->piece[k];
  const struct picks *s = &r->pick[k];
  size_t n_point = q->n_in + q->n_point, most = 4 * s->n;
  uint32_t *number = vg_alloc(n_point, sizeof *number);
  struct vg_cluster_cells b = { 0 };

  b.name = vg_alloc(most, sizeof *b.name);
  b.x = vg_alloc(most, sizeof *b.x);
  b.hold = vg_calloc(most, 1);
  b.cell = vg_alloc(s->n, sizeof *b.cell);
  if (!number || !b.name || !b.x || !b.hold || !b.cell) {
    free(number);
    vg_cluster_cells_release(&b);
    return vg_fail_memory(err, "repairs");
  }
  memset(number, 0xff, n_point * sizeof *number);
  for (size_t first = 0, end; first < s->n; first = end) {
    for (end = first; end < s->n && s->at[end].key == s->at[first].key; end++) {
    }
    fill_block(q, end - first, &s->at[first], number, &b);
    vg_cluster_cells_put(&post->to[b.cluster % (uint32_t)r->p->size], &b);
  }
  for (size_t c = 0; c < s->n_taken; c++) put_taken(r, q, &s->taken[c], post);
  free(number);
  vg_cluster_cells_release(&b);
  return VG_OK;
}

/* Blocks without cells come last: their points have no cells, so their order
 * does not matter. */
static int by_path(const void *a, const void *b)
{
  const struct vg_cluster_cells *s = a, *t = b;

  if (s->cluster != t->cluster) return s->cluster < t->cluster ? -1 : 1;
  if (!s->n_cell != !t->n_cell) return s->n_cell ? -1 : 1;
  return strcmp(s->path, t->path);
}

static vg_status take_blocks(struct repair *r, const struct vg_bytes *from,
                             struct vg_error *err)
{
  for (int k = 0; k < r->p->size; k++) {
    struct vg_reader in = { .data = from[k].data, .n = from[k].n };

    while (in.at < in.n) {
      if (vg_reserve(&r->block, &r->cap_block, r->n_block + 1,
                     sizeof *r->block))
        return vg_fail_memory(err, "repairs");
      vg_cluster_cells_get(&in, &r->block[r->n_block]);
      if (in.bad) return vg_fail_damaged(err, "repairs");
      r->n_block++;
    }
  }
  if (r->n_block) qsort(r->block, r->n_block, sizeof *r->block, by_path);
  r->first = vg_alloc(r->n_block + 1, sizeof *r->first);
  if (!r->first) return vg_fail_memory(err, "repairs");
  for (size_t k = 0; k < r->n_block; k++)
    if (!k || r->block[k].cluster != r->block[k - 1].cluster)
      r->first[r->n_job++] = k;
  r->first[r->n_job] = r->n_block;
  r->repaired = vg_calloc(r->n_job, sizeof *r->repaired);
  r->span = vg_calloc(r->n_job, sizeof *r->span);
  r->st = vg_calloc(r->n_job, sizeof *r->st);
  return r->repaired && r->span && r->st ? VG_OK
                                         : vg_fail_memory(err, "repairs");
}

static vg_status send_cells(struct repair *r, struct vg_comm *comm,
                            struct vg_error *err)
{
  struct vg_outbox post = { 0 };
  struct vg_bytes *from = NULL;
  vg_status st = pick(r, err);

  if (st == VG_OK) st = vg_outbox_new(&post, r->p->size, err);
  for (size_t k = 0; st == VG_OK && k < r->p->n_piece; k++)
    if (r->pick[k].n) st = put_piece(r, k, &post, err);
  st = vg_outbox_send(&post, comm, st, &from, err);
  if (st == VG_OK) st = take_blocks(r, from, err);
  vg_bytes_release(from, (size_t)r->p->size);
  return st;
}

/* --- repairs ------------------------------------------------------------- */

static void cluster_body(void *context, size_t first, size_t end, int worker)
{
  struct repair *r = context;

  for (size_t k = first; k < end; k++) {
    const struct vg_cluster_cells *b = &r->block[r->first[k]];

    vg_repair_begin(&r->span[k], worker);
    r->st[k] = vg_repair_cluster(r->first[k + 1] - r->first[k], b, &r->balls,
                                 &r->boundary, r->p->sizing, &r->repaired[k],
                                 NULL);
    vg_repair_end(&r->span[k], "", r->number + b->cluster,
                  r->repaired[k].n_cell);
  }
}

static vg_status repair_clusters(struct repair *r, struct vg_error *err)
{
  vg_status st = vg_repair_boundary_new(&r->p->doubled, &r->p->boundary,
                                        r->n_block, r->block, &r->boundary,
                                        err);

  if (st < 0) return st;
  vg_parallel_for(r->p->options.threads, r->n_job, 1, cluster_body, r);
  for (size_t k = 0; k < r->n_job; k++) {
    if (r->st[k] < 0)
      return vg_fail(err, r->st[k],
                     "cells at interfaces could not be "
                     "repaired: %s",
                     vg_status_name(r->st[k]));
    VG_TRY(vg_spans_add(r->spans, &r->span[k], err));
  }
done:
  return st;
}

/* Combines, over all ranks, which clusters were improved, and their
 * statistics. */
static vg_status share_outcomes(struct repair *r, struct vg_comm *comm,
                                struct vg_error *err)
{
  struct vg_partition_report *to = &r->p->report;
  size_t n = r->balls.n_cluster;
  vg_status st;

  r->better = vg_calloc(n, sizeof *r->better);
  st = vg_comm_agree(comm, r->better ? VG_OK : vg_fail_memory(err, "repairs"),
                     err);
  if (st < 0) return st;
  for (size_t k = 0; k < r->n_job; k++) {
    const struct vg_repaired *m = &r->repaired[k];

    r->better[r->block[r->first[k]].cluster] = (uint64_t)m->better;
    to->n_repair_cell += m->n_cell;
    to->n_repair_bad += m->n_bad;
    to->n_repair_bad_left += m->n_bad_left;
    if (m->worst < to->repair_worst) to->repair_worst = m->worst;
    if (m->worst_left < to->repair_worst_left)
      to->repair_worst_left = m->worst_left;
  }
  if (n) st = vg_comm_sum(comm, n, r->better, err);
  to->n_repair += n;
  for (size_t k = 0; st == VG_OK && k < n; k++) to->n_repaired += r->better[k];
  return st;
}

/* --- putting back -------------------------------------------------------- */

/* Drops cells that clusters took, and points of others that are no longer
 * used. */
static vg_status shrink(struct vg_piece *q, const struct picks *s,
                        const uint64_t *better, struct vg_error *err)
{
  struct vg_edit e = { .gone = vg_calloc(q->n_cell, 1) };
  vg_status st = e.gone ? VG_OK : VG_ERR_MEMORY;

  for (size_t k = 0; st == VG_OK && k < s->n; k++)
    e.gone[s->at[k].index] = (uint8_t)better[s->at[k].key];
  if (st == VG_OK) st = vg_piece_edit(q, &e);
  vg_edit_release(&e);
  return st == VG_OK ? st : vg_fail_memory(err, "repairs");
}

static vg_status remove_cells(struct repair *r, struct vg_error *err)
{
  for (size_t k = 0; k < r->p->n_piece; k++) {
    const struct picks *s = &r->pick[k];
    size_t n = 0;
    vg_status st;

    while (n < s->n && !r->better[s->at[n].key]) n++;
    if (n == s->n) continue;
    st = shrink(&r->p->piece[k], s, r->better, err);
    if (st < 0) return st;
  }
  return VG_OK;
}

/* A moved point, for its owner. */
struct move {
  uint64_t name;
  double x[3];
};

static void put_moves(const struct repair *r, struct vg_outbox *post)
{
  for (size_t k = 0; k < r->n_job; k++) {
    const struct vg_repaired *m = &r->repaired[k];

    for (size_t i = 0; m->better && i < m->n_moved; i++) {
      const struct vg_owner *o = vg_owners_find(&r->owners, m->moved[i]);
      struct move move = { m->moved[i],
                           { m->x[i][0], m->x[i][1], m->x[i][2] } };

      if (o) vg_put(&post->to[o->rank], 1, sizeof move, &move);
    }
  }
}

static void take_moves(const struct repair *r, const struct vg_bytes *from)
{
  struct move move;

  for (int k = 0; k < r->p->size; k++)
    for (size_t at = 0; at + sizeof move <= from[k].n; at += sizeof move) {
      const struct vg_owner *o;
      struct vg_piece *q;

      memcpy(&move, from[k].data + at, sizeof move);
      o = vg_owners_find(&r->owners, move.name);
      q = &r->p->piece[o->piece];
      memcpy(q->x[q->n_in + (uint32_t)move.name], move.x, sizeof move.x);
    }
}

static vg_status add_pieces(struct repair *r, struct vg_error *err)
{
  struct vg_partition *p = r->p;

  if (vg_reserve(&p->piece, &p->cap_piece, p->n_piece + r->n_job,
                 sizeof *p->piece))
    return vg_fail_memory(err, "repairs");
  for (size_t k = 0; k < r->n_job; k++) {
    struct vg_piece *q = &r->repaired[k].piece;

    if (!r->repaired[k].better) continue;
    q->kind = VG_SPAN_REPAIR;
    q->serial = vg_partition_serial(p);
    snprintf(q->path, sizeof q->path, "R%06zu",
             r->number + r->block[r->first[k]].cluster);
    p->piece[p->n_piece++] = *q;
    memset(q, 0, sizeof *q);
  }
  return VG_OK;
}

static vg_status put_back(struct repair *r, struct vg_comm *comm,
                          struct vg_error *err)
{
  struct vg_outbox post = { 0 };
  struct vg_bytes *from = NULL;
  vg_status st = remove_cells(r, err);

  if (st == VG_OK) st = vg_outbox_new(&post, r->p->size, err);
  if (st == VG_OK) put_moves(r, &post);
  st = vg_outbox_send(&post, comm, st, &from, err);
  if (st < 0) return st;
  take_moves(r, from);
  vg_bytes_release(from, (size_t)r->p->size);
  /* the picks refer to the previous pieces */
  for (size_t k = 0; k < r->p->n_piece; k++) picks_release(&r->pick[k]);
  free(r->pick);
  r->pick = NULL;
  return vg_comm_agree(comm, add_pieces(r, err), err);
}

/* --- all rounds ---------------------------------------------------------- */

static vg_status round_of(struct repair *r, struct vg_comm *comm, size_t n,
                          const struct vg_spot *spot, struct vg_error *err)
{
  vg_status st = vg_comm_agree(
    comm, vg_spot_grid_new(n, spot, MOST_BALLS, &r->balls, err), err);

  if (st == VG_OK) st = vg_comm_agree(comm, send_cells(r, comm, err), err);
  if (st == VG_OK) st = vg_comm_agree(comm, repair_clusters(r, err), err);
  if (st == VG_OK) st = share_outcomes(r, comm, err);
  return st == VG_OK ? put_back(r, comm, err) : st;
}

/* Lists the balls for the next round: those that this round left over and,
 * after the first round, large ones around cells that stayed bad. */
static vg_status next_round(struct repair *r, struct vg_comm *comm, int first,
                            size_t *n, struct vg_spot **spot,
                            struct vg_error *err)
{
  struct vg_writer w = { .cap = 0 };
  struct vg_spot *more = NULL;
  vg_status st;

  for (size_t k = 0; r->p->rank == 0 && k < r->balls.n; k++)
    if (r->balls.cluster[k] == VG_NO_CLUSTER)
      vg_put(&w, 1, sizeof **spot, &(*spot)[k]);
  for (size_t k = 0; first && k < r->n_job; k++)
    vg_put(&w, r->repaired[k].n_spot, sizeof **spot, r->repaired[k].spot);
  st = vg_spots_gather(&w, r->p->size, comm, n, &more, err);
  free(w.bytes.data);
  free(*spot);
  *spot = more;
  return st;
}

static vg_status all_rounds(struct vg_partition *p, struct vg_comm *comm,
                            struct vg_spans *spans, struct vg_error *err)
{
  struct vg_spot *spot = NULL;
  size_t n = 0, number = 0;
  vg_status st = VG_OK;

  for (int k = 0; st == VG_OK && k < ROUNDS && (!k || n); k++) {
    struct repair r = { .p = p, .number = number, .spans = spans };

    vg_partition_tell(p, "interface repair", (size_t)k, ROUNDS);
    st = vg_owners_gather(p, comm, &r.owners, err);
    if (st == VG_OK && !k && r.owners.n > 1)
      st = vg_repair_smooth(p, comm, &r.owners, spans, &n, &spot, err);
    if (st == VG_OK && n) {
      st = round_of(&r, comm, n, spot, err);
      number += r.balls.n_cluster;
      if (st == VG_OK && k + 1 < ROUNDS)
        st = next_round(&r, comm, !k, &n, &spot, err);
    }
    repair_free(&r);
  }
  free(spot);
  return st;
}

/* Members that ranks combine: sums and extremes. */
#define ROW(member, kind, rule)                                                \
  VG_ENTRY(NULL, struct vg_partition_report, member, kind, rule)
static const struct vg_entry entry[] = {
  ROW(n_repair_cell, COUNT, SUM),      ROW(n_repair_bad, COUNT, SUM),
  ROW(n_repair_bad_left, COUNT, SUM),  ROW(n_repair_moved, COUNT, SUM),
  ROW(n_repair_swapped, COUNT, SUM),   ROW(repair_worst, REAL, LEAST),
  ROW(repair_worst_left, REAL, LEAST),
};
static const struct vg_entries fields = { sizeof entry / sizeof *entry, entry };

/* Counts the cells of this rank's pieces that are not positive or have a point
 * that is out of range. */
static size_t bad_cells(const struct vg_partition *p)
{
  size_t bad = 0;

  for (size_t k = 0; k < p->n_piece; k++) {
    const struct vg_piece *q = &p->piece[k];

    for (size_t c = 0; c < q->n_cell; c++) {
      uint32_t v[4];
      int is_in = 1;

      vg_piece_cell(q, c, v);
      for (int i = 0; i < 4; i++) is_in &= v[i] < q->n_in + q->n_point;
      bad += !is_in ||
             !(vg_orient3d(q->x[v[0]], q->x[v[1]], q->x[v[2]], q->x[v[3]]) > 0);
    }
  }
  return bad;
}

vg_status vg_partition_repair(struct vg_partition *p, struct vg_comm *comm,
                              struct vg_spans *spans, struct vg_error *err)
{
  assert(p);

  struct vg_spans own = VG_SPANS_INIT;
  double t0 = vg_clock();
  vg_status st;

  /* regular tetrahedron, if there is nothing to do */
  p->report.repair_worst = p->report.repair_worst_left = 8.0 / 9;
  VG_CHECK("the tasks of the partition", bad_cells(p));
  st = all_rounds(p, comm, &own, err);
  if (st == VG_OK) VG_CHECK("repairs at interfaces", bad_cells(p));
  if (st == VG_OK) st = vg_entries_agree(&fields, &p->report, comm, err);
  if (st == VG_OK && spans)
    st = vg_repair_record(p, comm, t0, &own, spans, err);
  vg_spans_release(&own);
  p->report.repair = vg_clock() - t0;
  return st;
}
