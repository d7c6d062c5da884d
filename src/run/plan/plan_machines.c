/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The forecast tasks of a run replayed on the requested machines. */
#include <math.h>

#include "base/memory.h"
#include "run/plan/run_plan_parts.h"

/* Least efficiency of the best machine if there is no target. */
#define EFFICIENT 0.8

double vg_plan_phase(const struct vg_plan *p, const struct vg_plan_row *r,
                     enum vg_phase phase, double parts[3])
{
  double alone, by_node, one = p->phase[phase], sum = 0;

  vg_phase_shares(phase, &alone, &by_node);
  for (int k = 0; k < 3; k++) {
    struct vg_machine m = p->o->machine;
    double s = one * (k == 0 ? alone : k == 1 ? by_node : 1 - alone - by_node);

    m.ranks = r->ranks;
    m.threads = r->threads;
    m.ranks_per_node = r->ranks_per_node;
    m.serial = k == 0 ? s : 0;
    m.by_node = k == 1 ? s : 0;
    m.by_all = k == 2 ? s : 0;
    parts[k] = vg_model_outside(&m);
    sum += parts[k];
  }
  return sum;
}

static vg_status run_on(const struct vg_plan *p, const struct vg_forecast *o,
                        int ranks, int threads, int ranks_per_node,
                        struct vg_plan_row *row, struct vg_error *err)
{
  struct vg_machine m = p->o->machine;
  double outside = 0;
  vg_status st;

  m.cyclic = p->problem->resolved.settings.cyclic;
  m.ranks = row->ranks = ranks;
  m.threads = row->threads = threads;
  m.ranks_per_node = row->ranks_per_node = ranks_per_node;
  st = vg_model_replay(&o->spans, &m, &row->tasks, NULL, err);
  if (st < 0) return st;
  row->wall = row->tasks.wall;
  for (int k = 0; k < VG_PHASE_N; k++) {
    double parts[3];

    row->wall += vg_plan_phase(p, row, (enum vg_phase)k, parts);
    outside += p->phase[k];
  }
  row->speedup = (row->tasks.work + outside / m.rate) / row->wall;
  row->efficiency = row->speedup / ranks / threads;
  vg_plan_memory(p, o, ranks, threads, row->stage);
  row->memory = 0;
  for (int i = 0; i < VG_MEMORY_STAGES; i++)
    row->memory = fmax(row->memory, row->stage[i]);
  return VG_OK;
}

/* Choose the fewest workers that meet the target or, without a target, the most
 * workers that are efficient. */
static void choose(struct vg_plan *p)
{
  double target = p->o->target;

  p->best = SIZE_MAX;
  for (size_t i = 0; i < p->n_row; i++) {
    const struct vg_plan_row *r = &p->row[i];
    const struct vg_plan_row *b = p->best == SIZE_MAX ? NULL : &p->row[p->best];
    long n = (long)r->ranks * r->threads;
    long most = b ? (long)b->ranks * b->threads : 0;
    int fits = target > 0 ? r->wall <= target : r->efficiency >= EFFICIENT;
    int better = !b || (target > 0 ? n < most : n > most) ||
                 (n == most && r->wall < b->wall);

    if (fits && better) p->best = i;
  }
}

/* Forecasts with other leaf sizes on the chosen machine, or on the largest.
 * Sizes that give more than LEAVES_MOST leaves are omitted: their forecasts
 * take minutes. */
#define LEAVES_MOST 10000
static vg_status try_leaves(struct vg_plan *p, struct vg_error *err)
{
  static const double sizes[VG_PLAN_LEAVES] = { 4e4, 7e4, 1e5,   1.5e5,
                                                2e5, 3e5, 4.5e5, 7e5 };
  const struct vg_plan_row
    *at = &p->row[p->best == SIZE_MAX ? p->n_row - 1 : p->best];
  vg_status st = VG_OK;

  for (int i = 0; st >= 0 && i < VG_PLAN_LEAVES; i++) {
    struct vg_forecast o = VG_FORECAST_INIT;

    if (p->load.cells > LEAVES_MOST * sizes[i]) continue;
    st = vg_plan_tasks(p, sizes[i], &o, err);
    if (st >= 0)
      st = run_on(p, &o, at->ranks, at->threads, at->ranks_per_node,
                  &p->leaf[p->n_leaf].row, err);
    p->leaf[p->n_leaf].cells = sizes[i];
    p->leaf[p->n_leaf].n = o.n_leaf;
    vg_forecast_release(&o);
    if (st < 0) break;
    if (p->leaf[p->n_leaf].row.wall < p->leaf[p->best_leaf].row.wall)
      p->best_leaf = p->n_leaf;
    p->n_leaf++;
  }
  return st;
}

vg_status vg_plan_machines(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_plan_request *o = p->o;
  vg_status st;

  p->row = vg_alloc(o->ranks.n * (o->threads.n + (size_t)o->cores),
                    sizeof *p->row);
  if (!p->row) return vg_fail_memory(err, "the forecast");
  for (size_t t = 0; !o->cores && t < o->threads.n; t++)
    for (size_t r = 0; r < o->ranks.n; r++) {
      VG_TRY(run_on(p, &p->forecast, (int)o->ranks.v[r], (int)o->threads.v[t],
                    o->machine.ranks_per_node, &p->row[p->n_row], err));
      p->n_row++;
    }
  for (size_t r = 0; o->cores && r < o->ranks.n; r++)
    for (int k = 1; k <= o->cores; k++) {
      if (o->cores % k) continue;
      VG_TRY(run_on(p, &p->forecast, (int)o->ranks.v[r] * k, o->cores / k, k,
                    &p->row[p->n_row], err));
      p->n_row++;
    }
  choose(p);
  st = p->decomposition.n_part || o->no_leaves ? VG_OK : try_leaves(p, err);
done:
  return st;
}
