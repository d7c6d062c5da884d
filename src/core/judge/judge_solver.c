/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Quality in the terms of solvers, in slices. The faces on the boundary are
 * found in a table, so that each slice measures its cells and all faces but
 * those between slices. The two sides of such a face meet, and the cells that
 * have several of them after that. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/judge/judge_slices_parts.h"

/* Least number of sides that a thread hands over at once. */
enum { HANDED_SIDES = 1 << 12 };

struct side_item {
  uint32_t node[4]; /* as in struct vg_face_item */
  struct vg_solver_side side;
};

static void bound_key(const struct vg_mesh *b, size_t i,
                      struct vg_face_item *out)
{
  uint32_t node[4];

  if (i < b->n_tri) {
    memcpy(node, b->tri[i], sizeof *b->tri);
    node[3] = VG_NO_NODE;
  } else memcpy(node, b->quad[i - b->n_tri], sizeof *b->quad);
  vg_face_item_set(out, node);
}

static int is_bound(const struct vg_mesh *b, size_t i, const uint32_t node[4])
{
  struct vg_face_item f;

  bound_key(b, i, &f);
  return !memcmp(f.node, node, sizeof f.node);
}

/* The slot of a face of the boundary. */
static uint32_t *find_bound(const struct vg_slices_judgement *j,
                            const uint32_t node[4])
{
  uint32_t *at;

  VG_TABLE_FIND(&j->bound, at, vg_rendezvous_hash(node, 4 * sizeof *node),
                is_bound(j->s->boundary, *at, node));
  return at;
}

vg_status vg_judge_solver_init(struct vg_slices_judgement *j,
                               struct vg_error *err)
{
  const struct vg_mesh *b = j->s->boundary;
  size_t n = b->n_tri + b->n_quad;

  if (vg_table_init(&j->bound, n))
    return vg_fail_memory(err, "the faces of the boundary");
  for (size_t i = 0; i < n; i++) {
    struct vg_face_item f;
    uint32_t *at;

    bound_key(b, i, &f);
    at = find_bound(j, f.node);
    if (*at == VG_TABLE_FREE) *at = (uint32_t)i;
  }
  return VG_OK;
}

void vg_judge_solver_release(struct vg_slices_judgement *j)
{
  vg_table_release(&j->bound);
  vg_waiting_items_release(&j->waiting_side);
  for (int i = 0; i < j->n_worker; i++) {
    vg_solver_release(&j->worker[i].solver);
    vg_item_blocks_release(&j->worker[i].side);
    vg_item_blocks_release(&j->worker[i].rest);
  }
}

size_t vg_judge_solver_bytes(const struct vg_slices_judgement *j)
{
  size_t n = j->waiting_side.most * sizeof(struct side_item) +
             (size_t)(j->bound.end - j->bound.slot) * sizeof *j->bound.slot;

  for (int i = 0; i < j->n_worker; i++)
    n += vg_item_blocks_n(&j->worker[i].side) * sizeof(struct side_item) +
         vg_item_blocks_n(&j->worker[i].rest) * sizeof(struct vg_solver_cell);
  return n;
}

/* --- sides of faces ------------------------------------------------------- */

static int is_pair(const void *context, const unsigned char *item, size_t n)
{
  (void)context;
  (void)item;
  return n == 2;
}

/* A face without exactly two sides belongs to an invalid mesh, for which the
 * figures are not reported. */
static void meet_side(void *context, const unsigned char *item, size_t n,
                      int worker)
{
  struct vg_slices_judgement *j = context;
  struct vg_judge_worker *w = &j->worker[worker];
  const struct side_item *s = (const void *)item;
  struct vg_solver_cell rest[2];
  int n_rest = 0;

  if (n != 2) return;
  vg_solver_meet(w->figures[VG_JUDGED_WHOLE], &s[0].side, &s[1].side, rest,
                 &n_rest);
  for (int i = 0; i < n_rest; i++) {
    struct vg_solver_cell *to = vg_item_blocks_add(&w->rest, sizeof *to);

    if (to) *to = rest[i];
    else w->st = vg_fail_memory(&w->err, "the cells between slices");
  }
}

static void meet_rest(void *context, const unsigned char *item, size_t n,
                      int worker)
{
  struct vg_slices_judgement *j = context;

  vg_solver_meet_cell(j->worker[worker].figures[VG_JUDGED_WHOLE],
                      (const void *)item, n);
}

static vg_status thin(struct vg_slices_judgement *j, int worker,
                      struct vg_error *err)
{
  struct vg_judge_worker *w = &j->worker[worker];
  struct vg_rendezvous m = {
    j->comm, 1,      sizeof(struct side_item), 4 * sizeof(uint32_t), meet_side,
    j,       is_pair
  };
  struct vg_item_blocks all;
  vg_status st;

  if (vg_item_blocks_n(&w->side) < HANDED_SIDES) return VG_OK;
  st = vg_waiting_items_add(&j->waiting_side, &w->side, &all, err);
  if (st < 0 || !all.n_block) return st;
  st = vg_rendezvous_thin(&m, worker, &all, err);
  if (st >= 0) st = w->st;
  if (st >= 0) return vg_waiting_items_return(&j->waiting_side, &all, err);
  vg_item_blocks_release(&all);
  return st;
}

/* Is it a face of the boundary, whose points come first? */
static int on_boundary(const struct vg_slices_judgement *j,
                       const uint32_t node[4])
{
  for (int i = 0; i < 4; i++)
    if (node[i] >= j->n_place && node[i] != VG_NO_NODE) return 0;
  return *find_bound(j, node) != VG_TABLE_FREE;
}

static void global_key(const struct vg_slice *s, const uint32_t local[4],
                       uint32_t node[4])
{
  struct vg_face_item f;
  uint32_t id[4];

  for (int c = 0; c < 4; c++)
    id[c] = local[c] == VG_NO_NODE ? VG_NO_NODE : s->id[local[c]];
  vg_face_item_set(&f, id);
  memcpy(node, f.node, sizeof f.node);
}

int vg_judge_on_boundary(const struct vg_slices_judgement *j,
                         const struct vg_slice *s, const uint32_t local[4])
{
  uint32_t node[4];

  global_key(s, local, node);
  return on_boundary(j, node);
}

vg_status vg_judge_solver_slice(struct vg_slices_judgement *j, int worker,
                                const struct vg_slice *s,
                                struct vg_solver_sweep *sweep,
                                const struct vg_unpaired *unpaired,
                                struct vg_error *err)
{
  struct vg_judge_worker *w = &j->worker[worker];
  uint8_t *n_open = vg_calloc(sweep->n_cell, 1);
  vg_status st = VG_OK;

  if (!n_open) return vg_fail_memory(err, "the cells between slices");
  for (size_t i = 0; i < unpaired->n_face; i++) {
    const struct vg_unpaired_face *f = &unpaired->face[i];
    uint32_t node[4];

    global_key(s, f->node, node);
    if (on_boundary(j, node)) vg_solver_bound(sweep, f->cell, f->node);
    else n_open[f->cell]++;
  }
  vg_solver_finish(sweep, n_open);
  for (size_t i = 0; i < unpaired->n_face; i++) {
    const struct vg_unpaired_face *f = &unpaired->face[i];
    struct side_item *to;
    uint32_t node[4];

    if (!n_open[f->cell]) continue;
    global_key(s, f->node, node);
    if (on_boundary(j, node)) continue;
    to = vg_item_blocks_add(&w->side, sizeof *to);
    if (!to) {
      st = vg_fail_memory(err, "the faces between slices");
      goto done;
    }
    memcpy(to->node, node, sizeof node);
    vg_solver_side(sweep, f->cell, f->node, n_open[f->cell], &to->side);
  }
  st = thin(j, worker, err);
done:
  free(n_open);
  return st;
}

vg_status vg_judge_solver_match(struct vg_slices_judgement *j,
                                struct vg_error *err)
{
  struct vg_rendezvous side = { j->comm,
                                j->threads,
                                sizeof(struct side_item),
                                4 * sizeof(uint32_t),
                                meet_side,
                                j,
                                is_pair };
  struct vg_rendezvous cell = { j->comm,
                                j->threads,
                                sizeof(struct vg_solver_cell),
                                2 * sizeof(uint32_t),
                                meet_rest,
                                j,
                                NULL };
  vg_status st = vg_item_blocks_join(&j->worker[0].side, &j->waiting_side.items,
                                     err);

  VG_TRY(vg_comm_agree(j->comm, st, err));
  VG_TRY(vg_rendezvous_blocks(&side, &j->worker[0].side, (size_t)j->n_worker,
                              sizeof *j->worker, err));
  for (int i = 0; i < j->n_worker && st >= 0; i++)
    if (j->worker[i].st < 0) {
      st = j->worker[i].st;
      if (err) *err = j->worker[i].err;
    }
  VG_TRY(vg_comm_agree(j->comm, st, err));
  st = vg_rendezvous_blocks(&cell, &j->worker[0].rest, (size_t)j->n_worker,
                            sizeof *j->worker, err);
done:
  return st;
}

vg_status vg_judge_solver_gather(struct vg_comm *comm, struct vg_stats *f,
                                 struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(comm);
  struct vg_places own[VG_PLACES_LISTS];
  struct vg_bytes mine = { sizeof own, (unsigned char *)own };
  struct vg_bytes *all = vg_calloc(size, sizeof *all);
  vg_status st = all ? VG_OK : vg_fail_memory(err, "the worst places");

  memcpy(own, f->places, sizeof own);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  memset(f->places, 0, sizeof f->places);
  for (size_t r = 0; r < size; r++) {
    struct vg_places list[VG_PLACES_LISTS];

    assert(all[r].n == sizeof list);
    memcpy(list, all[r].data, sizeof list);
    for (int k = 0; k < VG_PLACES_LISTS; k++)
      for (size_t i = 0; i < list[k].n; i++)
        vg_places_add(&f->places[k], &list[k].place[i]);
  }
done:
  vg_bytes_release(all, size);
  return st;
}
