/* Points smoothed among cells that are only listed: as a sweep of the
 * optimisation, without the links between cells that it follows. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/optimise_parts.h"

/* Balls of the points, one after the other. */
struct balls {
  uint32_t *slot;            /* [t.n_point] place in the list, or VG_NONE */
  size_t *first;             /* [n + 2] */
  uint32_t *link;            /* 4 * cell + index of the point */
};

static void balls_release(struct balls *b)
{
  free(b->slot);
  free(b->first);
  free(b->link);
}

/* Place in the list of the points that have a cell below. */
static vg_status find_slots(const struct vg_tets *t, size_t n,
                            const uint32_t *point, float below,
                            const float *q, uint32_t *slot)
{
  uint8_t *wants = vg_calloc(t->n_point, 1);

  if (!wants) return VG_ERR_MEMORY;
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && q[c] < below; i++) wants[t->cell[c].v[i]] = 1;
  memset(slot, 0xff, t->n_point * sizeof *slot);
  for (size_t k = 0; k < n; k++)
    if (wants[point[k]]) slot[point[k]] = (uint32_t)k;
  free(wants);
  return VG_OK;
}

static vg_status balls_new(const struct vg_tets *t, size_t n,
                           const uint32_t *point, float below, const float *q,
                           struct balls *b)
{
  b->slot = vg_alloc(t->n_point, sizeof *b->slot);
  b->first = vg_calloc(n + 2, sizeof *b->first);
  if (!b->slot || !b->first) return VG_ERR_MEMORY;
  if (find_slots(t, n, point, below, q, b->slot) < 0) return VG_ERR_MEMORY;
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++) {
      uint32_t k = b->slot[t->cell[c].v[i]];

      if (k != VG_NONE) b->first[k + 2]++;
    }
  for (size_t k = 0; k < n; k++) b->first[k + 2] += b->first[k + 1];
  b->link = vg_alloc(b->first[n + 1], sizeof *b->link);
  if (!b->link) return VG_ERR_MEMORY;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t k = b->slot[t->cell[c].v[i]];

      if (k != VG_NONE) b->link[b->first[k + 1]++] = 4 * c + i;
    }
  return VG_OK;
}

/* Points with a cell that is flat in plain arithmetic are left alone: what is
 * positive cannot be told there. */
static int take_ball(struct vg_optimiser *o, const struct balls *b, size_t k,
                     float below)
{
  float worst = 2;

  o->n_ball = b->first[k + 1] - b->first[k];
  if (!o->n_ball || o->n_ball > VG_BALL_MAX) return 0;
  memcpy(o->ball, b->link + b->first[k], o->n_ball * sizeof *o->ball);
  for (size_t m = 0; m < o->n_ball; m++)
    if (o->q[o->ball[m] >> 2] < worst) worst = o->q[o->ball[m] >> 2];
  return worst > (float)VG_SHAPE_FLAT && worst < below;
}

vg_status vg_optimise_points(struct vg_tets *t, size_t n,
                             const uint32_t *point, float below, float *q,
                             struct vg_optimise_report *report,
                             struct vg_error *err)
{
  struct vg_optimiser *o = vg_calloc(1, sizeof *o);
  struct balls b = { NULL, NULL, NULL };
  vg_status st = VG_OK;

  memset(report, 0, sizeof *report);
  if (o) {
    o->t = t;
    o->q = q;
    o->report = report;
    o->vain = vg_calloc(t->n_point, 1);
    o->vain_cell = vg_calloc(t->n_cell, 1);
  }
  if (!o || !o->vain || !o->vain_cell ||
      balls_new(t, n, point, below, q, &b) < 0)
    st = vg_fail_memory(err, "optimisation");
  for (size_t k = 0; st == VG_OK && k < n; k++)
    if (take_ball(o, &b, k, below)) vg_smooth_ball(o, point[k], VG_SHAPE_AIM);
  balls_release(&b);
  if (o) {
    free(o->vain);
    free(o->vain_cell);
  }
  free(o);
  return st;
}
