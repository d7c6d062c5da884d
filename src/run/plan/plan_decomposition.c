/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The domain decomposition with which vanguard mesh would begin, made in the
 * same way, but with the coarser sizing field of a forecast. */
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "run/plan/run_plan_parts.h"
#include "partition/advance/ways.h"
#include "run/settings/plan_options.h"

void vg_plan_decomposition_release(struct vg_plan_decomposition *q)
{
  for (size_t k = 0; q->load && k < q->n_part; k++)
    vg_load_release(&q->load[k]);
  free(q->load);
  vg_decomposition_release(&q->made);
  memset(q, 0, sizeof *q);
}

/* Compute sum and largest number of the expected cells of the subdomains that
 * are filled without cutting them. */
static vg_status weigh_parts(const struct vg_load *load,
                             struct vg_plan_decomposition *q,
                             struct vg_error *err)
{
  struct vg_front *v = vg_calloc(q->n_part, sizeof *v);
  vg_status st;

  q->load = vg_calloc(q->n_part, sizeof *q->load);
  st = v && q->load ? VG_OK : vg_fail_memory(err, "the subdomains");
  for (size_t k = 0; st == VG_OK && k < q->n_part; k++)
    v[k] = q->made.part[k].front;
  if (st == VG_OK)
    st = vg_load_split(load, q->n_part, v, 1, NULL, q->load, err);
  for (size_t k = 0; st == VG_OK && k < q->n_part; k++) {
    if (q->made.part[k].may_cut) continue;
    q->n_whole++;
    q->cells += q->load[k].cells;
    if (q->load[k].cells > q->most) q->most = q->load[k].cells;
  }
  free(v);
  return st;
}

static struct vg_decomposition_options options_of(const struct vg_plan *p)
{
  const struct vg_settings *s = &p->problem->resolved.settings;
  struct vg_decomposition_options o = vg_options_decomposition(s);

  if (!o.n_part)
    o.n_part = vg_decomposition_parts(p->load.cells,
                                      vg_options_cuts(s).leaf_cells);
  return o;
}

vg_status vg_plan_part(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_way *way = &vg_ways[p->problem->resolved.settings.decompose];
  struct vg_front f = vg_front_of(p->front);
  struct vg_decomposition_options o = options_of(p);
  double t = vg_clock();
  vg_status st;

  if (!way->maker) return VG_OK;
  f.id = vg_alloc(f.n_point, sizeof *f.id);
  if (!f.id) return vg_fail_memory(err, "the front");
  for (size_t k = 0; k < f.n_point; k++) f.id[k] = VG_POINT_ID(0, k);
  st = way->maker(&f, &p->load, p->sizing, &o, 1, NULL, &p->decomposition.made,
                  err);
  if (st == VG_OK) {
    p->decomposition.n_part = p->decomposition.made.n_part;
    p->decomposition.seconds = vg_clock() - t;
    st = weigh_parts(&p->load, &p->decomposition, err);
  }
  free(f.id);
  return st;
}

vg_status vg_plan_parted(const struct vg_plan *p, const struct vg_front *v,
                         const struct vg_cut_rule *rule,
                         struct vg_forecast *out, struct vg_error *err)
{
  const struct vg_plan_decomposition *q = &p->decomposition;
  const struct vg_settings *s = &p->problem->resolved.settings;
  struct vg_forecast_part *part = vg_calloc(q->n_part, sizeof *part);
  struct vg_forecast_decomposition all = {
    s->decompose == VG_DECOMPOSE_OCTREE ? &p->rates.octree : &p->rates.discrete,
    (double)q->made.report.n_coarse, (double)q->made.report.n_face, q->n_part,
    part
  };
  vg_status st;

  if (!part) return vg_fail_memory(err, "the forecast");
  for (size_t k = 0; k < q->n_part; k++)
    part[k] = (struct vg_forecast_part){ q->made.part[k].front, &q->load[k],
                                         q->made.part[k].may_cut };
  st = vg_forecast_parted(v, &p->load, &all, rule, (int)s->bisections,
                          &p->rates, out, err);
  free(part);
  return st;
}
