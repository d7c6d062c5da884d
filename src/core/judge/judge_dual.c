/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Orthogonality of the median dual, in slices. The parts of a dual face between
 * slices meet first. Each complete one is a part of the control volumes of its
 * points, whose parts meet after that. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/judge/dual.h"
#include "core/judge/judge_slices_parts.h"

vg_status vg_judge_dual_slice(struct vg_slices_judgement *j, int worker,
                              const struct vg_slice *s,
                              const struct vg_mesh *view, struct vg_stats *f,
                              const struct vg_unpaired *unpaired,
                              struct vg_error *err)
{
  struct vg_judge_worker *w = &j->worker[worker];
  uint8_t *is_open = vg_calloc(s->n_point, 1);
  const struct vg_dual_shared shared = { is_open, s->id, &w->dual_face,
                                         &w->dual_point };
  vg_status st;

  if (!is_open) return vg_fail_memory(err, "the median dual");
  for (size_t i = 0; i < unpaired->n_face; i++) {
    const uint32_t *node = unpaired->face[i].node;

    if (vg_judge_on_boundary(j, s, node)) continue;
    for (int c = 0; c < 4; c++)
      if (node[c] != VG_NO_NODE) is_open[node[c]] = 1;
  }
  st = vg_dual_measure(view, &shared, f, err);
  free(is_open);
  return st;
}

static void meet_face(void *context, const unsigned char *item, size_t n,
                      int worker)
{
  struct vg_slices_judgement *j = context;
  struct vg_judge_worker *w = &j->worker[worker];
  const struct vg_dual_face *part = (const void *)item;
  struct vg_dual_face face = part[0];
  double sum[3];

  for (size_t i = 1; i < n; i++) vg_grid_sum_join(&face.area, &part[i].area);
  vg_dual_count_face(w->figures[VG_JUDGED_WHOLE], &face, sum);
  for (int k = 0; k < 2; k++) {
    struct vg_dual_point *p = vg_item_blocks_add(&w->dual_point, sizeof *p);

    if (!p) {
      w->st = vg_fail_memory(&w->err, "the median dual");
      return;
    }
    memset(p, 0, sizeof *p);
    p->range[0] = INFINITY;
    p->node = face.node[k];
    memcpy(p->x, face.x[k], sizeof p->x);
    vg_grid_sum_add(&p->sum, sum);
  }
}

static void meet_point(void *context, const unsigned char *item, size_t n,
                       int worker)
{
  struct vg_slices_judgement *j = context;
  const struct vg_dual_point *part = (const void *)item;
  struct vg_dual_point p = part[0];

  for (size_t i = 1; i < n; i++) {
    vg_grid_sum_join(&p.sum, &part[i].sum);
    p.range[0] = fminf(p.range[0], part[i].range[0]);
    p.range[1] = fmaxf(p.range[1], part[i].range[1]);
  }
  vg_dual_count_point(j->worker[worker].figures[VG_JUDGED_WHOLE], &p);
}

vg_status vg_judge_dual_match(struct vg_slices_judgement *j,
                              struct vg_error *err)
{
  struct vg_rendezvous face = { j->comm,
                                j->threads,
                                sizeof(struct vg_dual_face),
                                2 * sizeof(uint32_t),
                                meet_face,
                                j,
                                NULL };
  struct vg_rendezvous point = { j->comm,
                                 j->threads,
                                 sizeof(struct vg_dual_point),
                                 sizeof(uint32_t),
                                 meet_point,
                                 j,
                                 NULL };
  vg_status st;

  VG_TRY(vg_rendezvous_blocks(&face, &j->worker[0].dual_face,
                              (size_t)j->n_worker, sizeof *j->worker, err));
  for (int i = 0; i < j->n_worker && st >= 0; i++)
    if (j->worker[i].st < 0) {
      st = j->worker[i].st;
      if (err) *err = j->worker[i].err;
    }
  VG_TRY(vg_comm_agree(j->comm, st, err));
  vg_judge_note_bytes(j, 0);
  st = vg_rendezvous_blocks(&point, &j->worker[0].dual_point,
                            (size_t)j->n_worker, sizeof *j->worker, err);
done:
  return st;
}

void vg_judge_dual_release(struct vg_slices_judgement *j)
{
  for (int i = 0; i < j->n_worker; i++) {
    vg_item_blocks_release(&j->worker[i].dual_face);
    vg_item_blocks_release(&j->worker[i].dual_point);
  }
}

size_t vg_judge_dual_bytes(const struct vg_slices_judgement *j)
{
  size_t n = 0;

  for (int i = 0; i < j->n_worker; i++)
    n += vg_item_blocks_n(&j->worker[i].dual_face) *
           sizeof(struct vg_dual_face) +
         vg_item_blocks_n(&j->worker[i].dual_point) *
           sizeof(struct vg_dual_point);
  return n;
}
