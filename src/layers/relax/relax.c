/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Collects the cells at the tops of flat cells, has them improved on the first
 * rank, and moves the tops on all ranks. */
#include "layers/relax/relax.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/shape.h"
#include "layers/relax/relax_parts.h"

struct search {
  const struct vg_layers *layers;
  uint8_t *mark; /* [n_column] 1: a top of a flat cell that may move. */
  pthread_mutex_t lock;
  /* Other points of these cells within the field, in the order of the threads,
   * then ascending. */
  size_t n_id, cap_id;
  uint32_t *id;
  /* Cells at these tops and points, in the order of the threads. */
  size_t n_cell, cap_cell;
  struct vg_relax_cell *cell;
};

static double shape_of(const struct vg_slice *s, const uint32_t t[4])
{
  return vg_shape(s->x[t[0]], s->x[t[1]], s->x[t[2]], s->x[t[3]]);
}

static vg_status list_points(struct search *q, const struct vg_slice *s,
                             const uint32_t t[4], struct vg_error *err)
{
  vg_status st = VG_OK;

  pthread_mutex_lock(&q->lock);
  if (vg_reserve(&q->id, &q->cap_id, q->n_id + 4, sizeof *q->id))
    st = vg_fail_memory(err, "the cells on the layers");
  for (int k = 0; k < 4 && st >= 0; k++)
    if (s->id[t[k]] >= q->layers->front.n_point) q->id[q->n_id++] = s->id[t[k]];
  pthread_mutex_unlock(&q->lock);
  return st;
}

/* Marks the tops of flat cells, and lists the other points of these cells. */
static vg_status mark_slice(void *context, const struct vg_slice *s,
                            struct vg_error *err)
{
  struct search *q = context;
  const uint32_t(*tet)[4] = (const uint32_t(*)[4])s->cell[VG_SLICE_TET];
  vg_status st = VG_OK;

  for (size_t i = 0; i < s->n_cell[VG_SLICE_TET] && st >= 0; i++) {
    uint32_t column[4];
    int n = 0;

    for (int k = 0; k < 4; k++) {
      uint32_t c = vg_relax_column_of(&q->layers->front, s->id[tet[i][k]]);

      if (c != VG_NO_INDEX && vg_relax_may_move(&q->layers->columns.column[c]))
        column[n++] = c;
    }
    if (!n || shape_of(s, tet[i]) >= VG_RELAX_FLAT) continue;
    while (n--) __atomic_store_n(&q->mark[column[n]], 1, __ATOMIC_RELAXED);
    st = list_points(q, s, tet[i], err);
  }
  return st;
}

static int by_value(const void *a, const void *b)
{
  uint32_t s = *(const uint32_t *)a, t = *(const uint32_t *)b;

  return s < t ? -1 : s > t;
}

static int is_marked(const struct search *q, uint32_t id)
{
  uint32_t c = vg_relax_column_of(&q->layers->front, id);

  if (c != VG_NO_INDEX) return q->mark[c];
  return id >= q->layers->front.n_point && q->n_id &&
         bsearch(&id, q->id, q->n_id, sizeof *q->id, by_value) != NULL;
}

static vg_status keep(struct search *q, const struct vg_slice *s,
                      const uint32_t t[4], struct vg_error *err)
{
  vg_status st = VG_OK;

  pthread_mutex_lock(&q->lock);
  if (vg_reserve(&q->cell, &q->cap_cell, q->n_cell + 1, sizeof *q->cell)) {
    st = vg_fail_memory(err, "the cells on the layers");
  } else {
    struct vg_relax_cell *c = &q->cell[q->n_cell++];

    for (int k = 0; k < 4; k++) {
      c->id[k] = s->id[t[k]];
      memcpy(c->x[k], s->x[t[k]], sizeof c->x[k]);
    }
  }
  pthread_mutex_unlock(&q->lock);
  return st;
}

/* Keeps the cells at the marked tops and the listed points. */
static vg_status keep_slice(void *context, const struct vg_slice *s,
                            struct vg_error *err)
{
  struct search *q = context;
  const uint32_t(*tet)[4] = (const uint32_t(*)[4])s->cell[VG_SLICE_TET];
  vg_status st = VG_OK;

  for (size_t i = 0; i < s->n_cell[VG_SLICE_TET] && st >= 0; i++) {
    int is_at_top = 0;

    for (int k = 0; k < 4; k++) is_at_top |= is_marked(q, s->id[tet[i][k]]);
    if (is_at_top) st = keep(q, s, tet[i], err);
  }
  return st;
}

/* Replaces *data by that of all ranks, in their order. Collective. */
static vg_status gather(struct vg_comm *comm, size_t size, size_t *n,
                        void **data, struct vg_error *err)
{
  size_t n_rank = (size_t)vg_comm_size(comm), bytes = 0;
  struct vg_bytes mine = { *n * size, *data };
  struct vg_bytes *all = vg_calloc(n_rank, sizeof *all);
  unsigned char *to = NULL;
  vg_status st = all ? VG_OK : vg_fail_memory(err, "the cells on the layers");

  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  for (size_t r = 0; r < n_rank; r++) bytes += all[r].n;
  to = vg_alloc(bytes, 1);
  if (!to) {
    st = vg_fail_memory(err, "the cells on the layers");
    goto done;
  }
  *n = bytes / size;
  free(*data);
  *data = to;
  for (size_t r = 0; r < n_rank; to += all[r++].n)
    if (all[r].n) memcpy(to, all[r].data, all[r].n);
done:
  vg_bytes_release(all, all ? n_rank : 0);
  return st;
}

/* Marks on every rank what any rank has marked. Collective. */
static vg_status share_marks(struct vg_comm *comm, struct search *q, size_t *n,
                             struct vg_error *err)
{
  size_t n_column = q->layers->columns.n_column;
  uint32_t *list = NULL;
  vg_status st = VG_OK;

  *n = 0;
  for (size_t i = 0; i < n_column; i++) *n += q->mark[i];
  list = vg_alloc(*n, sizeof *list);
  if (!list) st = vg_fail_memory(err, "the tops of the layers");
  VG_TRY(vg_comm_agree(comm, st, err));
  *n = 0;
  for (size_t i = 0; i < n_column; i++)
    if (q->mark[i]) list[(*n)++] = (uint32_t)i;
  st = gather(comm, sizeof *list, n, (void **)&list, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  for (size_t i = 0; i < *n; i++) q->mark[list[i]] = 1;
done:
  free(list);
  return st;
}

/* Lists on every rank the points that any rank has listed. Collective. */
static vg_status share_points(struct vg_comm *comm, struct search *q,
                              struct vg_error *err)
{
  size_t n = 0;
  vg_status st = gather(comm, sizeof *q->id, &q->n_id, (void **)&q->id, err);

  VG_TRY(vg_comm_agree(comm, st, err));
  if (q->n_id) qsort(q->id, q->n_id, sizeof *q->id, by_value);
  for (size_t i = 0; i < q->n_id; i++)
    if (!n || q->id[i] != q->id[n - 1]) q->id[n++] = q->id[i];
  q->n_id = n;
done:
  return st;
}

/* --- moving the tops ----------------------------------------------------- */

/* Applies the moves to the layers. The first rank of a node does it for the
 * others if they share one copy. */
static void apply(struct vg_layers *l, const struct vg_mesh *surface,
                  uint8_t *mark, size_t n, const struct vg_relax_move *move)
{
  memset(mark, 0, l->columns.n_column);
  for (size_t i = 0; i < n; i++) {
    struct vg_column *c = &l->columns.column[move[i].column];

    c->cap = move[i].cap;
    c->compressed = VG_CAUSE_CELL;
    mark[move[i].column] = 1;
  }
  for (size_t i = 0; i < l->front.n_point; i++) {
    uint32_t c = vg_relax_column_of(&l->front, (uint32_t)i);

    if (c != VG_NO_INDEX && mark[c])
      vg_column_top(&l->columns, surface, c, l->front.x[i]);
  }
}

/* Sends an array of the first rank to all. Collective. */
static vg_status send_array(struct vg_comm *comm, size_t size, size_t *n,
                            void **data, struct vg_error *err)
{
  struct vg_bytes b = { *n * size, *data };
  vg_status st;

  if (vg_comm_rank(comm)) b = (struct vg_bytes){ 0, NULL };
  VG_TRY(vg_comm_bcast(comm, 0, &b, err));
  *data = b.data;
  *n = b.n / size;
done:
  return st;
}

/* Sends the moves and the report of the first rank to all. Collective. */
static vg_status send_moves(struct vg_comm *comm, struct vg_relax_result *moved,
                            struct vg_relax_report *report,
                            struct vg_error *err)
{
  struct vg_bytes r = { sizeof *report, (unsigned char *)report };
  vg_status st;

  VG_TRY(send_array(comm, sizeof *moved->move, &moved->n_move,
                    (void **)&moved->move, err));
  VG_TRY(send_array(comm, sizeof *moved->point, &moved->n_point,
                    (void **)&moved->point, err));
  if (vg_comm_rank(comm)) r = (struct vg_bytes){ 0, NULL };
  VG_TRY(vg_comm_bcast(comm, 0, &r, err));
  if (!vg_comm_rank(comm)) return st;
  memcpy(report, r.data, sizeof *report);
  free(r.data);
done:
  return st;
}

static vg_status move_tops(struct vg_comm *comm, const struct vg_mesh *surface,
                           struct vg_layers *layers, struct search *q,
                           struct vg_relax_result *moved,
                           struct vg_relax_report *report, struct vg_error *err)
{
  const struct vg_relax_input in = { q->mark, q->n_id, q->id, q->n_cell,
                                     q->cell };
  vg_status st = VG_OK;

  if (!vg_comm_rank(comm))
    st = vg_relax_tops(surface, layers, &in, moved, report, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(send_moves(comm, moved, report, err));
  if (!layers->common.is_mapped || !vg_comm_node_rank(comm))
    apply(layers, surface, q->mark, moved->n_move, moved->move);
  st = vg_comm_agree(comm, VG_OK, err);
done:
  return st;
}

vg_status vg_layers_relax(struct vg_comm *comm, const struct vg_mesh *surface,
                          struct vg_layers *layers,
                          const struct vg_slices *field, int threads,
                          size_t *n_point, struct vg_slices_point **point,
                          struct vg_relax_report *report, struct vg_error *err)
{
  assert(field->n_boundary_point == layers->front.n_point);

  struct search q = { .layers = layers,
                      .mark = vg_calloc(layers->columns.n_column, 1),
                      .lock = PTHREAD_MUTEX_INITIALIZER };
  struct vg_relax_result moved = { 0, 0, NULL, NULL };
  size_t n_mark;
  vg_status st = q.mark ? VG_OK : vg_fail_memory(err, "the tops of the layers");

  *report = (struct vg_relax_report){ 0 };
  *n_point = 0;
  *point = NULL;
  if (st >= 0) st = vg_slices_each(field, threads, mark_slice, &q, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(share_marks(comm, &q, &n_mark, err));
  VG_TRY(share_points(comm, &q, err));
  if (!n_mark) goto done;
  st = vg_slices_each(field, threads, keep_slice, &q, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  st = gather(comm, sizeof *q.cell, &q.n_cell, (void **)&q.cell, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(move_tops(comm, surface, layers, &q, &moved, report, err));
  *n_point = moved.n_point;
  *point = moved.point;
  moved.point = NULL;
done:
  free(moved.move);
  free(moved.point);
  free(q.id);
  free(q.mark);
  free(q.cell);
  return st;
}
