#include "core/optimise.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/hilbert.h"
#include "core/optimise_parts.h"

/* As vg_shape. Cells below `aim` (dihedral angles below 25 or above 155
 * degrees) are worked on one by one; `good` (45, 135) cells are not touched. */
static const double aim = 0.1786;
static const float good = 0.5;

static vg_status start(struct vg_optimiser *o, struct vg_tets *t,
                       struct vg_error *err)
{
  o->t = t;
  o->star = vg_alloc(t->n_point, sizeof *o->star);
  o->cap_star = t->n_point;
  if (o->star) memset(o->star, 0xff, t->n_point * sizeof *o->star);
  if (!o->star || vg_reserve(&o->q, &o->cap_q, t->cap_cell, sizeof *o->q))
    return vg_fail_memory(err, "optimisation");
  for (uint32_t c = 0; c < t->n_cell; c++) {
    o->q[c] = 1;
    if (t->flag[c] & (VG_DEAD | VG_OUTSIDE)) continue;
    o->q[c] = (float)vg_cell_shape(t, c);
    for (int i = 0; i < 4; i++) o->star[t->cell[c].v[i]] = c;
  }
  return VG_OK;
}

static int is_live(const struct vg_tets *t, uint32_t c)
{
  return !(t->flag[c] & (VG_DEAD | VG_OUTSIDE));
}

/* least[p]: shape of the worst cell around p. */
static void worst_around(const struct vg_optimiser *o, float *least)
{
  const struct vg_tets *t = o->t;

  for (size_t p = 0; p < t->n_point; p++) least[p] = 2;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && is_live(t, c); i++)
      if (o->q[c] < least[t->cell[c].v[i]])
        least[t->cell[c].v[i]] = o->q[c];
}

/* Points whose cells are all good are left where they are: in a level field
 * that is nearly all of them. */
static vg_status sweep(struct vg_optimiser *o, struct vg_error *err)
{
  struct vg_tets *t = o->t;
  float *least = vg_alloc(t->n_point, sizeof *least);

  if (!least) return vg_fail_memory(err, "optimisation");
  worst_around(o, least);
  for (uint32_t p = (uint32_t)o->n_fixed; p < t->n_point; p++)
    if (least[p] < good) vg_smooth(o, p, aim);
  free(least);
  for (uint32_t c = 0; c < t->n_cell; c++)
    if (is_live(t, c) && o->q[c] < aim) vg_swap(o, c);
  return VG_OK;
}

/* The cells below aim, worst first. */
static vg_status list_bad(const struct vg_optimiser *o, size_t *n,
                          struct vg_key **list, struct vg_error *err)
{
  const struct vg_tets *t = o->t;
  size_t k = 0;

  *n = 0;
  for (uint32_t c = 0; c < t->n_cell; c++)
    *n += is_live(t, c) && o->q[c] < aim;
  *list = vg_alloc(*n, sizeof **list);
  if (!*list) return vg_fail_memory(err, "optimisation");
  for (uint32_t c = 0; c < t->n_cell; c++)
    if (is_live(t, c) && o->q[c] < aim) {
      double q = o->q[c] > 0 ? o->q[c] : 0;

      (*list)[k].key = (uint64_t)(q * (1 << 20));
      (*list)[k++].index = c;
    }
  return vg_sort_keys(*n, *list, err);
}

/* One bad cell: the cheapest step that helps. */
static int mend_cell(struct vg_optimiser *o, uint32_t c)
{
  int better = 0;

  if (vg_swap(o, c)) return 1;
  for (int i = 0; i < 4 && o->q[c] < aim; i++)
    better |= vg_smooth(o, o->t->cell[c].v[i], aim);
  if (better) return 1;
  return vg_collapse(o, c) || vg_split(o, c, aim);
}

static vg_status mend(struct vg_optimiser *o, size_t *n_better,
                      struct vg_error *err)
{
  struct vg_key *list = NULL;
  size_t n;
  vg_status st = list_bad(o, &n, &list, err);

  *n_better = 0;
  for (size_t k = 0; st == VG_OK && k < n; k++) {
    uint32_t c = list[k].index;

    if (is_live(o->t, c) && o->q[c] < aim)
      *n_better += (size_t)mend_cell(o, c);
  }
  free(list);
  return st;
}

vg_status vg_optimise(struct vg_tets *t, size_t n_fixed,
                      const struct vg_sizing *sizing, int sweeps,
                      struct vg_optimise_report *report, struct vg_error *err)
{
  struct vg_optimiser *o = vg_calloc(1, sizeof *o);
  size_t n_better = 1;
  vg_status st;

  (void)sizing;
  memset(report, 0, sizeof *report);
  if (!o) return vg_fail_memory(err, "optimisation");
  o->n_fixed = n_fixed;
  o->report = report;
  st = start(o, t, err);
  for (int k = 0; st == VG_OK && k < sweeps; k++) st = sweep(o, err);
  for (int k = 0; st == VG_OK && k < 8 && n_better; k++)
    st = mend(o, &n_better, err);
  if (st == VG_OK && o->refused) st = vg_fail_memory(err, "optimisation");
  free(o->q);
  free(o->star);
  free(o);
  return st;
}
