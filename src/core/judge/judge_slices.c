/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Check of a mesh in slices: distributes the work and assembles the report. */
#include "core/judge/judge_slices.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/judge/judge_slices_parts.h"

#define MOST_WORKERS 256 /* limit of vg_parallel_for */

/* Number of waiting faces from which they are matched early: 4 MB. */
#define LEAST_WAITING ((size_t)1 << 17)

/* The same for the sides of faces that are measured for solvers: 5 MB. */
#define LEAST_WAITING_SIDES ((size_t)1 << 15)

/* --- preparation ---------------------------------------------------------- */

static vg_status make_workers(struct vg_slices_judgement *j,
                              struct vg_error *err)
{
  int n = j->threads > 0 ? j->threads : vg_cores();

  if (n > MOST_WORKERS) n = MOST_WORKERS;
  j->worker = vg_calloc((size_t)n, sizeof *j->worker);
  if (!j->worker) return vg_fail_memory(err, "the figures of slices");
  j->threads = j->n_worker = n;
  for (int i = 0; i < n; i++) {
    struct vg_judge_worker *w = &j->worker[i];

    for (int k = 0; k < 3; k++) {
      w->lo[k] = INFINITY;
      w->hi[k] = -INFINITY;
    }
    for (int q = 0; q < j->n_judged; q++) {
      w->figures[q] = vg_stats_new();
      if (!w->figures[q]) return vg_fail_memory(err, "the figures of slices");
    }
  }
  return VG_OK;
}

static size_t behind_last(const uint32_t *node, size_t n, uint64_t n_point)
{
  size_t end = 0;

  for (size_t i = 0; i < n; i++)
    if (node[i] >= end && node[i] < n_point) end = (size_t)node[i] + 1;
  return end;
}

/* Space for the positions of the boundary's points, which every rank needs;
 * not yet known. */
static vg_status make_places(struct vg_slices_judgement *j,
                             struct vg_error *err)
{
  const struct vg_mesh *b = j->s->boundary;
  size_t tri = behind_last((const uint32_t *)b->tri, 3 * b->n_tri,
                           j->s->n_point);
  size_t quad = behind_last((const uint32_t *)b->quad, 4 * b->n_quad,
                            j->s->n_point);

  j->n_place = tri > quad ? tri : quad;
  j->place = vg_alloc(j->n_place, sizeof *j->place);
  if (!j->place) return vg_fail_memory(err, "the points of the boundary");
  for (size_t i = 0; i < j->n_place; i++)
    for (int k = 0; k < 3; k++) j->place[i][k] = -INFINITY;
  return VG_OK;
}

static vg_status prepare(struct vg_slices_judgement *j, struct vg_error *err)
{
  vg_status st;

  if (j->s->n_point > UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%llu points are too many for the mesh check (limit 2^32)",
                   (unsigned long long)j->s->n_point);
  VG_TRY(make_workers(j, err));
  VG_TRY(make_places(j, err));
  VG_TRY(vg_judge_solver_init(j, err));
  j->n_word = (size_t)(j->s->n_point / 64 + 1);
  for (int q = 0; q < j->n_judged; q++) {
    j->used[q] = vg_calloc(j->n_word, sizeof *j->used[q]);
    if (!j->used[q]) st = VG_ERR_MEMORY;
  }
  if (st < 0) st = vg_fail_memory(err, "the points in use");
done:
  return st;
}

static void release(struct vg_slices_judgement *j)
{
  for (int i = 0; i < j->n_worker; i++) {
    struct vg_judge_worker *w = &j->worker[i];

    vg_item_blocks_release(&w->face);
    vg_item_blocks_release(&w->edge);
    vg_item_blocks_release(&w->place);
    vg_items_release(&w->crowd);
    vg_items_release(&w->suspect);
    for (int q = 0; q < VG_JUDGED; q++) {
      free(w->figures[q]);
      free(w->parent[q]);
    }
  }
  vg_judge_solver_release(j);
  vg_judge_dual_release(j);
  free(j->worker);
  for (int q = 0; q < VG_JUDGED; q++) free(j->used[q]);
  free(j->place);
  vg_waiting_items_release(&j->waiting);
  free(j->suspect);
}

void vg_judge_note_bytes(struct vg_slices_judgement *j, size_t more)
{
  size_t n = more + j->n_place * sizeof *j->place +
             (size_t)j->n_judged * j->n_word * sizeof **j->used +
             j->waiting.most * sizeof(struct vg_face_item) +
             vg_judge_solver_bytes(j) + vg_judge_dual_bytes(j);

  for (int i = 0; i < j->n_worker; i++) {
    const struct vg_judge_worker *w = &j->worker[i];

    n += vg_item_blocks_n(&w->face) * sizeof(struct vg_face_item) +
         vg_item_blocks_n(&w->edge) * sizeof(struct vg_edge_item) +
         vg_item_blocks_n(&w->place) * sizeof(uint64_t);
  }
  if (n > j->bytes) j->bytes = n;
}

/* --- slices --------------------------------------------------------------- */

static vg_status judge_all_slices(struct vg_slices_judgement *j,
                                  struct vg_error *err)
{
  vg_parallel_for(j->threads, j->s->n_slice, 1, vg_judge_some_slices, j);
  for (int i = 0; i < j->n_worker; i++) {
    struct vg_judge_worker *w = &j->worker[i];

    /* From here on the first figures are those of the whole mesh. */
    if (j->n_judged > 1)
      vg_stats_add(w->figures[VG_JUDGED_WHOLE], w->figures[VG_JUDGED_FIELD]);
    if (w->st >= 0) continue;
    if (err) *err = w->err;
    return w->st;
  }
  return VG_OK;
}

/* Counts over all ranks that decide whether the check can continue. */
struct census {
  uint64_t n_point, n_cell[VG_SLICE_KINDS], bad_index, not_finite;
};

static vg_status take_census(struct vg_slices_judgement *j, struct census *c,
                             struct vg_error *err)
{
  const struct vg_slices *s = j->s;
  vg_status st;

  memset(c, 0, sizeof *c);
  if (!vg_comm_rank(j->comm)) {
    struct vg_mesh b = *s->boundary;

    b.n_point = (size_t)s->n_point;
    b.n_tet = b.n_pyr = b.n_pri = b.n_hex = 0;
    j->worker[0].figures[VG_JUDGED_WHOLE]->n.bad_index += vg_count_bad_index(
      &b);
  }
  for (int i = 0; i < j->n_worker; i++) {
    const struct vg_judge_worker *w = &j->worker[i];
    const struct vg_counts *n = &w->figures[VG_JUDGED_WHOLE]->n;

    c->n_point += n->n_point;
    c->bad_index += n->bad_index;
    c->not_finite += n->not_finite;
    for (int k = 0; k < VG_SLICE_KINDS; k++) c->n_cell[k] += w->n_cell[k];
  }
  st = vg_comm_sum(j->comm, sizeof *c / sizeof(uint64_t), (uint64_t *)c, err);
  if (st < 0) return st;
  if (c->n_point == s->n_point &&
      !memcmp(c->n_cell, s->n_cell, sizeof c->n_cell))
    return VG_OK;
  return vg_fail(
    err, VG_ERR_INPUT,
    "the slices own %llu points, %llu "
    "tetrahedra, %llu pyramids, %llu prisms and %llu hexahedra, but the mesh "
    "has %llu, %llu, %llu, %llu and %llu",
    (unsigned long long)c->n_point, (unsigned long long)c->n_cell[0],
    (unsigned long long)c->n_cell[1], (unsigned long long)c->n_cell[2],
    (unsigned long long)c->n_cell[3], (unsigned long long)s->n_point,
    (unsigned long long)s->n_cell[0], (unsigned long long)s->n_cell[1],
    (unsigned long long)s->n_cell[2], (unsigned long long)s->n_cell[3]);
}

static uint64_t n_cells(const struct census *c)
{
  uint64_t n = 0;

  for (int k = 0; k < VG_SLICE_KINDS; k++) n += c->n_cell[k];
  return n;
}

/* Find the numbers of the components of this rank in the mesh. */
static vg_status number_slices(struct vg_slices_judgement *j,
                               struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(j->comm);
  size_t me = (size_t)vg_comm_rank(j->comm);
  uint64_t *n = vg_calloc(size + 1, sizeof *n);
  vg_status st = VG_OK;

  if (!n) st = vg_fail_memory(err, "the components of the mesh");
  VG_TRY(vg_comm_agree(j->comm, st, err));
  n[me] = atomic_load(&j->n_here);
  for (int i = 0; i < j->n_worker; i++)
    n[size] += j->worker[i].n_field_component;
  VG_TRY(vg_comm_sum(j->comm, size + 1, n, err));
  for (size_t r = 0; r < size; r++) {
    if (r == me) j->first_here = j->n_all;
    j->n_all += n[r];
  }
  j->n_all_field = n[size];
  if (j->n_all > UINT32_MAX)
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the mesh has too many "
                 "components for the mesh check (limit 2^32)");
done:
  free(n);
  return st;
}

static vg_status make_parents(struct vg_slices_judgement *j,
                              struct vg_error *err)
{
  for (int i = 0; i < j->n_worker; i++)
    for (int q = 0; q < j->n_judged; q++) {
      struct vg_judge_worker *w = &j->worker[i];
      uint32_t *parent = vg_alloc((size_t)j->n_all, sizeof *parent);
      uint32_t first = (uint32_t)j->first_here;

      if (!parent) return vg_fail_memory(err, "the components of the mesh");
      for (uint32_t k = 0; k < j->n_all; k++) parent[k] = k;
      /* what thinning has united already */
      for (uint32_t k = 0; k < w->n_parent; k++)
        parent[first + k] = first + w->parent[q][k];
      free(w->parent[q]);
      w->parent[q] = parent;
    }
  return VG_OK;
}

/* --- points in use -------------------------------------------------------- */

static size_t first_word(const struct vg_slices_judgement *j, int rank)
{
  return (size_t)((uint64_t)j->n_word * (uint64_t)rank /
                  (uint64_t)vg_comm_size(j->comm));
}

/* Each rank receives its share of the words of all ranks. */
static vg_status unite_used(struct vg_slices_judgement *j, uint64_t *used,
                            struct vg_error *err)
{
  int size = vg_comm_size(j->comm);
  size_t first = first_word(j, vg_comm_rank(j->comm));
  struct vg_bytes *to = vg_calloc((size_t)size, sizeof *to);
  struct vg_bytes *from = vg_calloc((size_t)size, sizeof *from);
  vg_status st = VG_OK;

  if (!to || !from) st = vg_fail_memory(err, "the points in use");
  VG_TRY(vg_comm_agree(j->comm, st, err));
  for (int r = 0; r < size; r++) {
    size_t at = first_word(j, r);

    to[r].data = (unsigned char *)(used + at);
    to[r].n = (first_word(j, r + 1) - at) * sizeof *used;
  }
  VG_TRY(vg_comm_exchange(j->comm, to, from, err));
  for (int r = 0; r < size; r++)
    for (size_t i = 0; i < from[r].n / sizeof *used; i++) {
      uint64_t word;

      memcpy(&word, from[r].data + i * sizeof word, sizeof word);
      used[first + i] |= word;
    }
done:
  vg_bytes_release(from, size);
  free(to);
  return st;
}

static vg_status count_used(struct vg_slices_judgement *j, struct vg_error *err)
{
  int me = vg_comm_rank(j->comm);
  size_t first = first_word(j, me), end = first_word(j, me + 1);
  vg_status st = VG_OK;

  for (int q = 0; q < j->n_judged; q++) {
    struct vg_counts *n = &j->worker[0].figures[q]->n;
    uint64_t n_used = 0, n_here = 64 * (uint64_t)(end - first);

    if (vg_comm_size(j->comm) > 1) VG_TRY(unite_used(j, j->used[q], err));
    for (size_t i = first; i < end; i++)
      n_used += (uint64_t)__builtin_popcountll(j->used[q][i]);
    /* the last word has more bits than there are points */
    if (end == j->n_word && end > first)
      n_here -= 64 * (uint64_t)j->n_word - j->s->n_point;
    if (q == VG_JUDGED_WHOLE) {
      n->unused_point = n_here - n_used;
      continue;
    }
    /* The field's points are those that its cells use. */
    for (int i = 0; i < j->n_worker; i++)
      j->worker[i].figures[q]->n.n_point = 0;
    n->n_point = n_used;
  }
done:
  return st;
}

/* --- sums and reports ----------------------------------------------------- */

static vg_status gather_worst(struct vg_comm *comm, struct vg_stats *f,
                              struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(comm);
  struct vg_worst_cell own[VG_WORST];
  struct vg_bytes mine = { f->n_worst * sizeof *own, (unsigned char *)own };
  struct vg_bytes *all = vg_calloc(size, sizeof *all);
  vg_status st = all ? VG_OK : vg_fail_memory(err, "the worst cells");

  memcpy(own, f->worst, sizeof own);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  f->n_worst = 0;
  for (size_t r = 0; r < size; r++)
    for (size_t i = 0; i < all[r].n / sizeof *own; i++) {
      struct vg_worst_cell w;

      memcpy(&w, all[r].data + i * sizeof w, sizeof w);
      vg_stats_worst(f, &w);
    }
done:
  vg_bytes_release(all, size);
  return st;
}

/* Add the figures of all threads and ranks to those of the first worker. */
static vg_status sum_stats(struct vg_slices_judgement *j, int q,
                           struct vg_error *err)
{
  struct vg_stats *f = j->worker[0].figures[q];
  double extreme[3 + VG_MOST_N];
  vg_status st;

  for (int i = 1; i < j->n_worker; i++)
    vg_stats_add(f, j->worker[i].figures[q]);
  if (vg_comm_size(j->comm) == 1) return VG_OK;
  extreme[0] = -f->angle_min;
  extreme[1] = f->angle_max;
  extreme[2] = -f->radius_ratio_min;
  memcpy(extreme + 3, f->most, sizeof f->most);
  VG_TRY(vg_comm_sum(j->comm, sizeof f->n / sizeof(uint64_t), (uint64_t *)&f->n,
                     err));
  VG_TRY(vg_comm_max(j->comm, 3 + VG_MOST_N, extreme, err));
  VG_TRY(gather_worst(j->comm, f, err));
  VG_TRY(vg_judge_solver_gather(j->comm, f, err));
  f->angle_min = -extreme[0];
  f->angle_max = extreme[1];
  f->radius_ratio_min = -extreme[2];
  memcpy(f->most, extreme + 3, sizeof f->most);
done:
  return st;
}

static vg_status enclose(struct vg_slices_judgement *j, double *enclosed,
                         struct vg_error *err)
{
  struct vg_mesh b = *j->s->boundary;
  double box[6], lo[3];
  vg_status st;

  for (int k = 0; k < 6; k++) box[k] = -INFINITY;
  for (int i = 0; i < j->n_worker; i++)
    for (int k = 0; k < 3; k++) {
      box[k] = fmax(box[k], -j->worker[i].lo[k]);
      box[3 + k] = fmax(box[3 + k], j->worker[i].hi[k]);
    }
  VG_TRY(vg_comm_max(j->comm, 6, box, err));
  VG_TRY(vg_comm_max(j->comm, 3 * j->n_place, (double *)j->place, err));
  for (int k = 0; k < 3; k++) lo[k] = -box[k];
  b.point = j->place;
  *enclosed = vg_enclosed_volume(&b, lo, box + 3);
done:
  return st;
}

/* Difference of a count from the expected one. */
static size_t missing(size_t n, uint64_t expected)
{
  return (size_t)(n > expected ? n - expected : expected - n);
}

static void report_all(struct vg_slices_judgement *j, const size_t *n_component,
                       uint64_t front_faces, double enclosed,
                       struct vg_mesh_report *r)
{
  int has = (j->sizing ? VG_HAS_SIZING : 0) |
            (j->in_metric ? VG_HAS_METRIC : 0) | (j->flat ? VG_HAS_FLAT : 0);

  for (int q = 0; q < j->n_judged; q++)
    vg_stats_report(j->worker[0].figures[q], n_component[q],
                    (j->edges_of == q ? has : 0) |
                      (q == VG_JUDGED_WHOLE ? VG_HAS_SOLVER : 0) |
                      (q == VG_JUDGED_WHOLE && j->has_dual ? VG_HAS_DUAL : 0),
                    &r[q]);
  r[VG_JUDGED_WHOLE].enclosed = enclosed;
  r[VG_JUDGED_WHOLE].duplicate_point = missing(
    r[VG_JUDGED_WHOLE].duplicate_point, j->s->n_copy);
  r[VG_JUDGED_WHOLE].bytes_shared = j->bytes;
  for (int i = 0; i < j->n_worker; i++)
    r[VG_JUDGED_WHOLE].bytes_slices += j->worker[i].slice_bytes;
  vg_report_conclude(&r[VG_JUDGED_WHOLE]);
  if (j->n_judged == 1) return;
  r += VG_JUDGED_FIELD;
  r->open_face = missing(r->open_face, front_faces);
  r->enclosed = r->volume;
  vg_report_conclude(r);
}

/* With bad indices or coordinates no other figure is meaningful. */
static vg_status report_unsound(struct vg_slices_judgement *j,
                                struct vg_mesh_report *r, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (int q = 0; q < j->n_judged; q++) {
    const struct vg_counts *n = &j->worker[0].figures[q]->n;

    VG_TRY(sum_stats(j, q, err));
    memset(&r[q], 0, sizeof r[q]);
    r[q].n_point = (size_t)n->n_point;
    r[q].n_cell = (size_t)n->n_cell;
    r[q].bad_index = (size_t)n->bad_index;
    r[q].not_finite = (size_t)n->not_finite;
  }
done:
  return st;
}

static vg_status judge(struct vg_slices_judgement *j, uint64_t front_faces,
                       struct vg_mesh_report *r, struct vg_error *err)
{
  size_t n_component[VG_JUDGED] = { 0, 0 };
  struct census c;
  double enclosed = 0;
  vg_status st = judge_all_slices(j, err);

  VG_TRY(vg_comm_agree(j->comm, st, err));
  vg_judge_note_bytes(j, 0);
  VG_TRY(take_census(j, &c, err));
  if (c.bad_index || c.not_finite || !n_cells(&c))
    return report_unsound(j, r, err);
  VG_TRY(number_slices(j, err));
  st = make_parents(j, err);
  VG_TRY(vg_comm_agree(j->comm, st, err));
  VG_TRY(vg_judge_match(j, err));
  VG_TRY(vg_judge_components(j, n_component, err));
  VG_TRY(count_used(j, err));
  for (int q = 0; q < j->n_judged; q++) VG_TRY(sum_stats(j, q, err));
  VG_TRY(enclose(j, &enclosed, err));
  report_all(j, n_component, front_faces, enclosed, r);
done:
  return st;
}

/* --- suspect faces -------------------------------------------------------- */

static vg_status pack_suspects(struct vg_slices_judgement *j,
                               struct vg_bytes *mine, struct vg_error *err)
{
  const size_t size = sizeof(struct vg_face_key);
  size_t n = 0;

  for (int i = 0; i < j->n_worker; i++) n += size * j->worker[i].suspect.n;
  mine->data = vg_alloc(n, 1);
  if (!mine->data) return vg_fail_memory(err, "the faces between slices");
  for (int i = 0; i < j->n_worker; i++) {
    const struct vg_items *s = &j->worker[i].suspect;

    if (s->n) memcpy(mine->data + mine->n, s->data, size * s->n);
    mine->n += size * s->n;
  }
  return VG_OK;
}

static vg_status unpack_suspects(const struct vg_bytes *all, size_t size,
                                 size_t *n, struct vg_face_key **key,
                                 struct vg_error *err)
{
  size_t n_byte = 0;

  for (size_t r = 0; r < size; r++) n_byte += all[r].n;
  *key = vg_alloc(n_byte, 1);
  if (!*key) return vg_fail_memory(err, "the faces between slices");
  for (size_t r = 0, at = 0; r < size; at += all[r++].n)
    if (all[r].n) memcpy((unsigned char *)*key + at, all[r].data, all[r].n);
  *n = n_byte / sizeof **key;
  qsort(*key, *n, sizeof **key, vg_face_key_order);
  return VG_OK;
}

/* Gather the suspect faces of all ranks. Each is listed once, because all its
 * items were compared on one rank. */
static vg_status gather_suspects(struct vg_slices_judgement *j, size_t *n,
                                 struct vg_face_key **key, struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(j->comm);
  struct vg_bytes mine = { 0, NULL };
  struct vg_bytes *all = vg_calloc(size, sizeof *all);
  vg_status st = all ? pack_suspects(j, &mine, err)
                     : vg_fail_memory(err, "the faces between slices");

  VG_TRY(vg_comm_agree(j->comm, st, err));
  VG_TRY(vg_comm_allgather(j->comm, &mine, all, err));
  st = unpack_suspects(all, size, n, key, err);
  st = vg_comm_agree(j->comm, st, err);
done:
  vg_bytes_release(all, size);
  free(mine.data);
  return st;
}

/* Repeat the check if there are suspect faces. Slices then leave these faces
 * unmatched, so that they are matched with those of all slices. This only
 * happens for invalid meshes. */
static vg_status judge_again(struct vg_slices_judgement *j,
                             uint64_t front_faces, struct vg_mesh_report *r,
                             struct vg_error *err)
{
  struct vg_slices_judgement again = { .comm = j->comm,
                                       .s = j->s,
                                       .sizing = j->sizing,
                                       .threads = j->threads,
                                       .n_judged = j->n_judged,
                                       .has_dual = j->has_dual,
                                       .in_metric = j->in_metric,
                                       .edges_of = j->edges_of,
                                       .flat = j->flat };
  vg_status st;

  vg_waiting_items_init(&again.waiting, LEAST_WAITING);
  vg_waiting_items_init(&again.waiting_side, LEAST_WAITING_SIDES);
  VG_TRY(gather_suspects(j, &again.n_suspect, &again.suspect, err));
  if (!again.n_suspect) goto done;
  st = prepare(&again, err);
  VG_TRY(vg_comm_agree(j->comm, st, err));
  VG_TRY(judge(&again, front_faces, r, err));
done:
  release(&again);
  return st;
}

vg_status vg_slices_judge(struct vg_comm *comm, const struct vg_slices *s,
                          uint64_t front_faces, const struct vg_sizing *sizing,
                          int threads, struct vg_mesh_report *whole,
                          struct vg_mesh_report *field, struct vg_error *err)
{
  return vg_slices_judge_with(comm, s, front_faces, sizing, threads, NULL, 0,
                              NULL, NULL, whole, field, err);
}

vg_status vg_slices_judge_with(
  struct vg_comm *comm, const struct vg_slices *s, uint64_t front_faces,
  const struct vg_sizing *sizing, int threads, const struct vg_flat *flat,
  int has_dual, vg_slice_body body, void *context, struct vg_mesh_report *whole,
  struct vg_mesh_report *field, struct vg_error *err)
{
  assert(s->boundary && whole);
  assert(threads >= 0);
  struct vg_slices_judgement j = {
    .comm = comm,
    .s = s,
    .sizing = sizing,
    .threads = threads,
    .flat = flat,
    .has_dual = has_dual,
    .body = body,
    .context = context,
    .n_judged = field ? VG_JUDGED : 1,
    .in_metric = sizing && vg_sizing_is_stretched(sizing),
    .edges_of = field ? VG_JUDGED_FIELD : VG_JUDGED_WHOLE
  };
  struct vg_mesh_report r[VG_JUDGED];
  vg_status st;

  vg_waiting_items_init(&j.waiting, LEAST_WAITING);
  vg_waiting_items_init(&j.waiting_side, LEAST_WAITING_SIDES);
  st = prepare(&j, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(judge(&j, front_faces, r, err));
  VG_TRY(judge_again(&j, front_faces, r, err));
  *whole = r[VG_JUDGED_WHOLE];
  if (field) *field = r[VG_JUDGED_FIELD];
done:
  release(&j);
  return st;
}
