/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Ends a run before its fill if the memory of a node does not suffice. */
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "run/common/free_memory.h"
#include "partition/model/memory_stages.h"
#include "run/stages/run.h"

/* M11: a forecast may exceed the free memory by this factor, since it may be
 * too high, and other programs end. The limit that a user gives has none. */
#define TOLERANCE 1.25

/* M11: share of the cells in separators, above all that occur. */
#define MOST_SEPARATED 0.5

static const char *const stage_name[VG_MEMORY_STAGES] = {
  "the surface", "the sizing field", "the fill", "the mesh check"
};

/* Bytes of this node: until the end of the run, and beyond those in use. */
struct need {
  double all, more;
  enum vg_memory_stage stage;
};

static struct need need_of(const struct vg_run_admission *a,
                           const struct vg_memory_counts *c)
{
  const struct vg_run *r = a->run;
  const double n = vg_comm_node_size(r->comm);
  const double shared = vg_memory_shared(c);
  double stage[VG_MEMORY_STAGES], heap, own;
  struct need need = { 0, 0, VG_MEMORY_FILL };

  vg_memory_stages(c, r->size, r->threads, stage);
  if (stage[VG_MEMORY_CHECK] > stage[VG_MEMORY_FILL])
    need.stage = VG_MEMORY_CHECK;
  own = fmax(0, vg_used_memory(&heap) - shared);
  need.all = shared + n * (own + stage[need.stage]);
  need.more = fmax(0, n * stage[need.stage] - heap);
  return need;
}

/* With max_memory the figure counts, otherwise the free memory. */
static int fits(const struct vg_run_admission *a, const struct need *need,
                double free_bytes)
{
  const double limit = a->settings->max_memory * 1e9;

  return limit > 0 ? need->all <= limit : need->more <= TOLERANCE * free_bytes;
}

/* least: "at least " if the need is a lower bound, otherwise "". */
static vg_status refuse(const struct vg_run_admission *a,
                        const struct need *need, double cells,
                        const char *least, double free_bytes,
                        struct vg_error *err)
{
  const double limit = a->settings->max_memory;
  char have[80];

  if (limit > 0)
    snprintf(have, sizeof have, "--max-memory allows %.3g GB", limit);
  else
    snprintf(have, sizeof have, "%.3g GB are free and %.3g GB in use",
             free_bytes / 1e9, (need->all - need->more) / 1e9);
  return vg_fail(err, VG_ERR_MEMORY,
                 "the mesh would have about %.3g cells outside the layers and "
                 "need %s%.3g GB on each node in %s, but %s; use larger sizes "
                 "or more nodes (`vanguard plan` forecasts both), or set "
                 "--max-memory to the memory that may be used",
                 cells, least, need->all / 1e9, stage_name[need->stage], have);
}

/* Cells of the largest subdomain and of the separators. The forecast of the
 * tasks takes time and is made only where its result may matter. */
static vg_status count_tasks(const struct vg_run_admission *a,
                             const struct vg_front *front,
                             const struct vg_load *load,
                             const struct vg_cut_rule *rule,
                             struct vg_memory_counts *c, struct vg_error *err)
{
  const struct vg_rates rates = c->is_stretched ? vg_rates_in_metric()
                                                : vg_rates_measured;
  struct vg_forecast o = VG_FORECAST_INIT;
  double n[3] = { 0, 0, 0 };
  vg_status st = VG_OK;

  if (load && !a->is_parted) {
    st = vg_forecast_new(front, load, rule, (int)a->settings->bisections,
                         &rates, &o, err);
    if (st >= 0) {
      vg_memory_of_tasks(&o, c);
      n[0] = c->largest_leaf;
      n[1] = c->separator_cells;
      n[2] = (double)c->n_leaf;
    }
    vg_forecast_release(&o);
  }
  st = vg_comm_agree(a->run->comm, st, err);
  if (st >= 0 && !a->is_parted) st = vg_comm_max(a->run->comm, 3, n, err);
  if (st < 0 || a->is_parted) return st;
  c->largest_leaf = n[0];
  c->separator_cells = n[1];
  c->n_leaf = (size_t)n[2];
  return VG_OK;
}

/* Refuses without the cells of separators and of the largest subdomain, which
 * only the forecast of the tasks gives. leads: this rank decides for its node.
 * *is_large: 1 on all ranks if one of them has refused. */
static vg_status refuse_at_once(const struct vg_run_admission *a,
                                struct vg_memory_counts c, int leads,
                                double free_bytes, int *is_large,
                                struct vg_error *err)
{
  double large = 0;
  struct need need;
  vg_status st;

  c.n_leaf = 0;
  c.largest_leaf = c.separator_cells = 0;
  need = need_of(a, &c);
  leads = leads && !fits(a, &need, free_bytes);
  large = leads;
  VG_TRY(vg_comm_max(a->run->comm, 1, &large, err));
  *is_large = large > 0;
  if (leads) st = refuse(a, &need, c.cells, "at least ", free_bytes, err);
done:
  return st;
}

vg_status vg_run_admit(const void *admission, const struct vg_front *front,
                       const struct vg_load *load,
                       const struct vg_cut_rule *rule, struct vg_error *err)
{
  const struct vg_run_admission *a = admission;
  const int leads = vg_comm_node_rank(a->run->comm) == 0;
  const double free_bytes = leads ? vg_free_memory("") : INFINITY;
  struct vg_memory_counts c = a->counts;
  struct need need;
  double is_near = 0;
  int is_large = 0;
  vg_status st;

  assert(rule);
  c.cells = load ? load->cells : 0;
  VG_TRY(vg_comm_max(a->run->comm, 1, &c.cells, err));
  c.n_leaf = SIZE_MAX;
  c.largest_leaf = rule->leaf_cells > 0 ? fmin(c.cells, 2 * rule->leaf_cells)
                                        : c.cells;
  c.separator_cells = MOST_SEPARATED * c.cells;
  need = need_of(a, &c);
  if (leads) is_near = !fits(a, &need, free_bytes);
  VG_TRY(vg_comm_max(a->run->comm, 1, &is_near, err));
  if (!(is_near > 0)) goto done;
  VG_TRY(refuse_at_once(a, c, leads, free_bytes, &is_large, err));
  if (is_large) goto done;
  VG_TRY(count_tasks(a, front, load, rule, &c, err));
  need = need_of(a, &c);
  if (leads && !fits(a, &need, free_bytes))
    st = refuse(a, &need, c.cells, "", free_bytes, err);
done:
  return st;
}
