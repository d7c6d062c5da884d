/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/plan/run_plan.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "layers/expand/join.h"
#include "partition/advance/advance.h"
#include "partition/advance/ways.h"
#include "run/plan/run_plan_parts.h"
#include "run/common/free_memory.h"
#include "run/report/report.h"
#include "run/settings/plan_options.h"

/* Layers on more wall points than this are estimated, not grown. */
#define GROW_LIMIT 50000
/* Seconds on one core; docs/lab/performance-parallel.md, "Model". */
static const double spread_per_cell = 0.35e-6; /* number, judge, encode */
static const double digest_per_byte = 0.4e-9;  /* digest of the files */

/* Add the time since `start` to a phase: a run does the same work. */
static void count_time(struct vg_plan *p, enum vg_phase phase, double start)
{
  p->phase[phase] += vg_clock_process() - start;
}

/* The surface with its flow domain and the plan of the layers, as those of
 * vanguard mesh. A process that needed more memory before only has its present
 * memory as a measure. */
static vg_status make_surface(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_shape_options shape = { .threads = p->o->workers };
  const double before = vg_report_peak_memory(), start = vg_clock_process();
  struct vg_problem *q = p->problem;
  double heap;
  vg_status st;

  VG_TRY(vg_boundary_shape(&q->read, &shape, p->show, &q->boundary, err));
  q->boundary.threads = p->o->workers;
  VG_TRY(vg_boundary_close(&q->boundary, p->show, err));
  VG_TRY(vg_layer_stage_plan(p->layers, &q->boundary, err));
  VG_TRY(vg_problem_settle(q, p->layers, err));
  count_time(p, VG_PHASE_CHECK, start);
  p->surface_peak = vg_report_peak_memory();
  if (!(p->surface_peak > before)) p->surface_peak = vg_used_memory(&heap);
  st = vg_display_stopped(p->show, err);
done:
  return st;
}

/* Build the sizing field and add its time to the phase. finer: factor on that
 * time if the field of the run is finer. */
static vg_status measure_sizes(struct vg_plan *p, const struct vg_mesh *m,
                               double coarseness, double finer,
                               struct vg_error *err)
{
  const struct vg_settings *s = &p->problem->resolved.settings;
  struct vg_sizing_options options = vg_boundary_sizing(&p->problem->boundary);
  double start = vg_clock_process();
  vg_status st;

  options.coarseness = coarseness;
  options.threads = p->o->workers;
  vg_display_update(p->show, "sizing field", 0, 0);
  vg_sizing_free(p->sizing);
  p->sizing = NULL;
  st = vg_boundary_measure(&p->problem->boundary, &options, s, m, &p->sizing,
                           err);
  p->phase[VG_PHASE_SIZES] += finer * (vg_clock_process() - start);
  return st < 0 ? st : vg_display_stopped(p->show, err);
}

/* The sizing field of the front. Most leaves of an octree of sizes are near the
 * surface, so that a coarser one has a quarter of the leaves of the run's. An
 * octree of size tensors has no such ratio: its leaves follow the change of the
 * tensors, and their number has a limit (H13). The forecast builds it as the
 * run does. */
static vg_status measure_front(struct vg_plan *p, struct vg_error *err)
{
  const double coarseness = vg_boundary_is_stretched(&p->problem->boundary)
                            ? 1
                            : VG_PLAN_COARSENESS;

  p->finer = coarseness * coarseness;
  return measure_sizes(p, p->front, coarseness, p->finer, err);
}

static vg_status count_wall_points(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_mesh *m = &p->problem->boundary.surface;
  uint8_t *on = vg_calloc(m->n_point, 1);

  if (!on) return vg_fail_memory(err, "the walls");
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (p->layers->reason[m->tri_patch[i]] != VG_WALL_NOT)
        on[m->tri[i][k]] = 1;
  for (size_t i = 0; i < m->n_point; i++) p->n_wall_point += on[i];
  free(on);
  return VG_OK;
}

/* Number of layer cells in mixed output: exact if the layers were grown. */
static vg_status count_joined(struct vg_plan *p, struct vg_error *err)
{
  const enum vg_layer_cells cells = (enum vg_layer_cells)
                                      p->problem->resolved.settings.cells;
  uint64_t n = 0;
  vg_status st;

  p->layer_join = p->layer_tet / 3;
  if (!p->is_grown || cells == VG_LAYER_TETS) return VG_OK;
  st = vg_layers_count(&p->problem->boundary.surface, &p->layers->layers, cells,
                       p->o->workers, &n, err);
  p->layer_join = (double)n;
  return st;
}

static vg_status make_layers(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_mesh *surface = &p->problem->boundary.surface;
  struct vg_mesh view = VG_MESH_INIT;
  double start;
  vg_status st;

  VG_TRY(vg_layer_stage_sizes(p->layers, &p->problem->boundary, &view, err));
  VG_TRY(measure_sizes(p, &view, VG_LAYERS_COARSENESS, 1, err));
  VG_TRY(count_wall_points(p, err));
  /* The front of estimated layers may intersect itself, so a decomposition
   * that needs the front requires grown layers. */
  p->is_grown = p->n_wall_point < GROW_LIMIT ||
                vg_ways[p->problem->resolved.settings.decompose].maker;
  start = vg_clock_process();
  if (p->is_grown) {
    p->layers->options.threads = p->o->workers;
    VG_TRY(vg_layer_stage_grow(p->layers, surface, p->sizing, p->show, err));
    p->layer_tet = (double)p->layers->report.n_cell;
    p->layer_point = (double)p->layers->report.n_layer_point;
    p->grown = vg_front_mesh(&p->layers->layers.front, surface);
    p->front = &p->grown;
  } else {
    VG_TRY(vg_plan_lift(p, err));
  }
  VG_TRY(count_joined(p, err));
  count_time(p, VG_PHASE_LAYERS, start);
  st = measure_front(p, err);
done:
  free(view.tri);
  free(view.tri_patch);
  return st;
}

/* --- the mesh ------------------------------------------------------------ */

static void count_mesh(struct vg_plan *p)
{
  double faces = (double)p->front->n_tri, field = p->load.cells;

  p->tet = field;
  if (p->problem->resolved.settings.cells != VG_LAYER_TETS)
    p->prism = p->layer_join;
  else p->tet += p->layer_tet;
  p->cell = p->tet + p->prism;
  p->point = vg_forecast_points(field, faces) + p->layer_point;
}

vg_status vg_plan_tasks(const struct vg_plan *p, double leaf_cells,
                        struct vg_forecast *out, struct vg_error *err)
{
  const struct vg_front v = vg_front_of(p->front);
  struct vg_cut_rule rule = p->rule;

  rule.leaf_cells = leaf_cells;
  if (p->decomposition.n_part) return vg_plan_parted(p, &v, &rule, out, err);
  return vg_forecast_new(&v, &p->load, &rule,
                         (int)p->problem->resolved.settings.bisections,
                         &p->rates, out, err);
}

void vg_plan_begin(struct vg_plan *p)
{
  p->start = vg_clock_process();
}

vg_status vg_plan_make(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_settings *s = &p->problem->resolved.settings;
  struct vg_front v;
  vg_status st;

  assert(p->o && p->problem && p->layers && p->show);
  count_time(p, VG_PHASE_READ, p->start);
  VG_TRY(make_surface(p, err));
  p->front = &p->problem->boundary.surface;
  if (p->layers->is_on) VG_TRY(make_layers(p, err));
  else VG_TRY(measure_front(p, err));
  VG_TRY(vg_boundary_effects(&p->problem->boundary, p->front, p->sizing,
                             &p->effects, err));
  vg_effects_note(&p->effects, p->front, &p->problem->resolved.settings,
                  &p->problem->notes);
  v = vg_front_of(p->front);
  VG_TRY(vg_display_stopped(p->show, err));
  vg_display_update(p->show, "forecast", 0, 0);
  VG_TRY(vg_load_new(&v, p->sizing, VG_LOAD_CELLS_PER_CUBE,
                     p->o->workers ? p->o->workers : vg_cores(), &p->load,
                     err));
  VG_TRY(vg_display_stopped(p->show, err));
  p->rates = vg_sizing_is_stretched(p->sizing) ? vg_rates_in_metric()
                                               : vg_rates_measured;
  vg_rates_replace(&p->rates, p->o->fit);
  VG_TRY(vg_plan_part(p, err));
  VG_TRY(vg_display_stopped(p->show, err));
  if (p->o->serial >= 0) {
    memset(p->phase, 0, sizeof p->phase);
    p->phase[VG_PHASE_READ] = p->o->serial;
  }
  p->rule = vg_options_cuts(s);
  p->rule.leaf_cells = vg_decomposition_leaf_cells(
    p->load.cells, vg_options_decomposition(s).n_part,
    vg_ways[s->decompose].maker != NULL, p->rule.leaf_cells);
  VG_TRY(vg_plan_tasks(p, p->rule.leaf_cells, &p->forecast, err));
  count_mesh(p);
  p->shared = vg_plan_shared(p);
  p->phase[VG_PHASE_JUDGE] = (p->o->spread_per_cell > 0 ? p->o->spread_per_cell
                                                        : spread_per_cell) *
                             p->cell;
  p->phase[VG_PHASE_WRITE] = digest_per_byte * vg_plan_bytes_all(p);
  st = vg_plan_machines(p, err);
done:
  return st;
}

void vg_plan_release(struct vg_plan *p)
{
  vg_forecast_release(&p->forecast);
  vg_plan_decomposition_release(&p->decomposition);
  vg_load_release(&p->load);
  vg_effects_release(&p->effects);
  vg_sizing_free(p->sizing);
  vg_mesh_release(&p->lifted);
  free(p->row);
}
