/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard plan: forecasts mesh and run of a project from the surface and the
 * sizing field only. */
#include "cli/plan/plan_estimate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "core/geometry/vector.h"
#include "partition/advance/advance.h"
#include "partition/advance/ways.h"
#include "run/report/report.h"
#include "run/settings/plan_options.h"

/* Layers on more wall points than this are estimated, not grown. */
#define GROW_LIMIT 50000
/* Least efficiency of the best machine if there is no target. */
#define EFFICIENT 0.8
/* Seconds on one core; docs/lab/performance-parallel.md, "Model". */
static const double spread_per_cell = 0.35e-6; /* number, judge, encode */
static const double digest_per_byte = 0.4e-9;  /* digest of the files */
static const double layer_per_cell = 0.1e-6;   /* growing and measuring */

/* --- estimated layers ---------------------------------------------------- */

struct lift {
  const struct vg_layer_stage *s;
  const struct vg_mesh *m;
  const struct vg_sizing *sizing;
  double (*normal)[3]; /* [n_point] */
  double *edge;        /* [n_point] sum, then mean of its edge lengths */
  uint32_t *n_edge;    /* [n_point] */
  uint32_t *patch;     /* [n_point] the wall whose growth law applies */
  uint16_t *level;     /* [n_point] */
};

static int is_wall(const struct lift *l, size_t tri)
{
  return l->s->reason[l->m->tri_patch[tri]] != VG_WALL_NOT;
}

static void add_triangle(struct lift *l, size_t i)
{
  const uint32_t *t = l->m->tri[i], patch = l->m->tri_patch[i];
  const struct vg_layer_request *q = l->s->request;
  double d[3][3], n[3];

  for (int k = 0; k < 3; k++) {
    vg_sub(l->m->point[t[(k + 1) % 3]], l->m->point[t[k]], d[k]);
    l->edge[t[k]] += vg_norm(d[k]);
    l->n_edge[t[k]]++;
  }
  vg_cross(d[0], d[1], n);
  for (int k = 0; k < 3; k++) {
    uint32_t *rules = &l->patch[t[k]];

    for (int j = 0; j < 3; j++) l->normal[t[k]][j] += n[j];
    if (*rules == VG_NO_INDEX || q[patch].law.delta1 < q[*rules].law.delta1)
      *rules = patch;
  }
}

/* The place x at height d above point i, and the target edge length along the
 * normal there. */
static double size_above(const struct lift *l, size_t i, double length,
                         double d, double x[3])
{
  const double *v = l->normal[i];
  double n[3];

  for (int k = 0; k < 3; k++) n[k] = v[k] / length;
  for (int k = 0; k < 3; k++) x[k] = l->m->point[i][k] + n[k] * d;
  return vg_sizing_is_stretched(l->sizing) ? vg_sizing_along(l->sizing, x, n)
                                           : vg_sizing_at(l->sizing, x);
}

/* Stack layers at a point by the rule of the layer module: until the next one
 * would be thicker than the local edge length, at the wall and at the top. In a
 * stretched field, edges of the wall are no measure of it. */
static void lift_point(struct lift *l, size_t i, double x[3])
{
  const struct vg_layer_request *q = &l->s->request[l->patch[i]];
  const struct vg_layer_options *o = &l->s->options;
  const int is_stretched = vg_sizing_is_stretched(l->sizing);
  double d[VG_LEVELS_MAX + 1], length;
  int n = 0, most = q->n_max > 0 && q->n_max < VG_LEVELS_MAX ? q->n_max
                                                             : VG_LEVELS_MAX;
  struct vg_growth_law law = q->law;

  if (o->law_at) o->law_at(o->law_user, l->m->point[i], &law);
  length = vg_norm(l->normal[i]);
  if (!(length > 0) || !(law.delta1 > 0)) return;
  vg_growth_law_heights(&law, INFINITY, most, d);
  while (n < most && !(q->total > 0 && d[n + 1] > q->total)) {
    const double h = is_stretched ? size_above(l, i, length, d[n + 1], x)
                                  : l->edge[i];

    if (!q->n_exact && !(d[n + 1] - d[n] <= o->end * h)) break;
    n++;
  }
  for (;; n--) {
    const double h = size_above(l, i, length, d[n], x);

    if (n == 0 || q->n_exact || d[n] - d[n - 1] <= o->end * h) break;
  }
  l->level[i] = (uint16_t)n;
}

static void measure_lift(struct vg_plan *p, struct lift *l)
{
  for (size_t i = 0; i < l->m->n_tri; i++)
    if (is_wall(l, i)) add_triangle(l, i);
  for (size_t i = 0; i < l->m->n_point; i++) {
    if (l->patch[i] == VG_NO_INDEX) continue;
    l->edge[i] /= l->n_edge[i];
    lift_point(l, i, p->lifted.point[i]);
    p->layer_point += l->level[i];
  }
  for (size_t i = 0; i < l->m->n_tri; i++)
    for (int k = 0; k < 3 && is_wall(l, i); k++)
      p->layer_tet += l->level[l->m->tri[i][k]];
}

/* Move the walls to the tops of the layers. The result approximates the front
 * that remains to be filled. */
static vg_status estimate_layers(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_mesh *m = &p->problem.boundary.surface;
  struct lift l = { .s = &p->layers, .m = m, .sizing = p->sizing };
  vg_status st;

  VG_TRY(vg_mesh_copy(&p->lifted, m, err));
  l.normal = vg_calloc(m->n_point, sizeof *l.normal);
  l.edge = vg_calloc(m->n_point, sizeof *l.edge);
  l.n_edge = vg_calloc(m->n_point, sizeof *l.n_edge);
  l.patch = vg_alloc(m->n_point, sizeof *l.patch);
  l.level = vg_calloc(m->n_point, sizeof *l.level);
  if (!l.normal || !l.edge || !l.n_edge || !l.patch || !l.level) {
    st = vg_fail_memory(err, "the layers");
    goto done;
  }
  memset(l.patch, 0xff, m->n_point * sizeof *l.patch);
  measure_lift(p, &l);
  p->phase[VG_PHASE_LAYERS] += layer_per_cell * p->layer_tet;
  p->front = &p->lifted;
done:
  free(l.normal);
  free(l.edge);
  free(l.n_edge);
  free(l.patch);
  free(l.level);
  return st;
}

static vg_status count_wall_points(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_mesh *m = &p->problem.boundary.surface;
  uint8_t *on = vg_calloc(m->n_point, 1);

  if (!on) return vg_fail_memory(err, "the walls");
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (p->layers.reason[m->tri_patch[i]] != VG_WALL_NOT)
        on[m->tri[i][k]] = 1;
  for (size_t i = 0; i < m->n_point; i++) p->n_wall_point += on[i];
  free(on);
  return VG_OK;
}

/* --- surface and sizing field -------------------------------------------- */

/* Add the time since `start` to a phase: a run does the same work. */
static void count_time(struct vg_plan *p, enum vg_phase phase, double start)
{
  p->phase[phase] += vg_clock_process() - start;
}

static vg_status read_project(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_plan_options *o = p->o;
  const struct vg_shape_options all_cores = { .threads = 0 };
  struct vg_problem *q = &p->problem;
  double start = vg_clock_process();
  vg_status st;

  vg_display_update(&p->show, "read", 0, 0);
  VG_TRY(vg_problem_open(q, o->project, o->deck, err));
  VG_TRY(vg_cli_apply(&o->kept, &q->asked, err));
  VG_TRY(vg_problem_read(q, NULL, &p->show, err));
  count_time(p, VG_PHASE_READ, start);
  start = vg_clock_process();
  VG_TRY(vg_boundary_shape(&q->read, &all_cores, &p->show, &q->boundary, err));
  VG_TRY(vg_boundary_close(&q->boundary, &p->show, err));
  VG_TRY(vg_layer_stage_plan(&p->layers, &q->boundary, err));
  st = vg_problem_settle(q, &p->layers, err);
  count_time(p, VG_PHASE_CHECK, start);
done:
  return st;
}

/* Build the sizing field and add its time to the phase. finer: factor on that
 * time if the field of the run is finer. */
static vg_status measure_sizes(struct vg_plan *p, const struct vg_mesh *m,
                               double coarseness, double finer,
                               struct vg_error *err)
{
  const struct vg_settings *s = &p->problem.resolved.settings;
  struct vg_sizing_options options = vg_boundary_sizing(&p->problem.boundary);
  double start = vg_clock_process();
  vg_status st;

  options.coarseness = coarseness;
  options.threads = 0;
  vg_display_update(&p->show, "sizing field", 0, 0);
  vg_sizing_free(p->sizing);
  p->sizing = NULL;
  st = vg_boundary_measure(&p->problem.boundary, &options, s, m, &p->sizing,
                           err);
  p->phase[VG_PHASE_SIZES] += finer * (vg_clock_process() - start);
  return st;
}

/* The sizing field of the front. Most leaves of an octree of sizes are near the
 * surface, so that a coarser one has a quarter of the leaves of the run's. An
 * octree of size tensors has no such ratio: its leaves follow the change of the
 * tensors, and their number has a limit (H13). The forecast builds it as the
 * run does. */
static vg_status measure_front(struct vg_plan *p, struct vg_error *err)
{
  const double coarseness = vg_boundary_is_stretched(&p->problem.boundary)
                            ? 1
                            : VG_PLAN_COARSENESS;

  p->finer = coarseness * coarseness;
  return measure_sizes(p, p->front, coarseness, p->finer, err);
}

static vg_status make_layers(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_mesh *surface = &p->problem.boundary.surface;
  struct vg_mesh view = VG_MESH_INIT;
  double start;
  vg_status st;

  VG_TRY(vg_layer_stage_sizes(&p->layers, &p->problem.boundary, &view, err));
  VG_TRY(measure_sizes(p, &view, VG_LAYERS_COARSENESS, 1, err));
  VG_TRY(count_wall_points(p, err));
  /* The front of estimated layers may intersect itself, so a decomposition
   * that needs the front requires grown layers. */
  p->is_grown = p->n_wall_point < GROW_LIMIT ||
                vg_ways[p->problem.resolved.settings.decompose].maker;
  start = vg_clock_process();
  if (p->is_grown) {
    p->layers.options.threads = 0;
    VG_TRY(vg_layer_stage_grow(&p->layers, surface, p->sizing, &p->show, err));
    p->layer_tet = (double)p->layers.report.n_cell;
    p->layer_point = (double)p->layers.report.n_layer_point;
    p->grown = vg_front_mesh(&p->layers.layers.front, surface);
    p->front = &p->grown;
  } else {
    VG_TRY(estimate_layers(p, err));
  }
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
  if (p->problem.resolved.settings.cells == VG_LAYER_MIXED)
    p->prism = p->layer_tet / 3;
  else p->tet += p->layer_tet;
  p->cell = p->tet + p->prism;
  p->point = vg_forecast_points(field, faces) + p->layer_point;
}

static double bytes_written(const struct vg_plan *p)
{
  char list[VG_WRITE_MAX], *save = NULL;
  double sum = 0;

  memcpy(list, p->problem.resolved.settings.write, sizeof list);
  for (char *word = strtok_r(list, " ,", &save); word;
       word = strtok_r(NULL, " ,", &save))
    sum += vg_plan_bytes(p, word);
  return sum;
}

/* --- the run ------------------------------------------------------------- */

static vg_status forecast(const struct vg_plan *p, double leaf_cells,
                          struct vg_forecast *out, struct vg_error *err)
{
  const struct vg_front v = vg_front_of(p->front);
  struct vg_cut_rule rule = p->rule;

  rule.leaf_cells = leaf_cells;
  if (p->decomposition.n_part) return vg_plan_parted(p, &v, &rule, out, err);
  return vg_forecast_new(&v, &p->load, &rule,
                         (int)p->problem.resolved.settings.bisections,
                         &p->rates, out, err);
}

/* Fit the rates to the given record. */
static vg_status learn_rates(struct vg_plan *p, struct vg_error *err)
{
  struct vg_timeline t = VG_TIMELINE_INIT;
  struct vg_machine m = VG_MACHINE_INIT;
  vg_status st = VG_OK;

  p->spread_per_cell = spread_per_cell;
  if (!p->o->rates) return VG_OK;
  VG_TRY(vg_timeline_read(p->o->rates, &t, err));
  VG_TRY(vg_rates_of(&t.spans, p->fit, err));
  vg_timeline_outside(&t, &m);
  if (t.n_cell) p->spread_per_cell = m.by_all / (double)t.n_cell;
done:
  vg_timeline_release(&t);
  return st;
}

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

  m.cyclic = p->problem.resolved.settings.cyclic;
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

/* Forecasts with other leaf sizes on the chosen machine, or on the largest. */
static vg_status try_leaves(struct vg_plan *p, struct vg_error *err)
{
  static const double sizes[VG_PLAN_LEAVES] = { 4e4, 7e4, 1e5,   1.5e5,
                                                2e5, 3e5, 4.5e5, 7e5 };
  const struct vg_plan_row
    *at = &p->row[p->best == SIZE_MAX ? p->n_row - 1 : p->best];
  vg_status st = VG_OK;

  for (int i = 0; st >= 0 && i < VG_PLAN_LEAVES; i++) {
    struct vg_forecast o = VG_FORECAST_INIT;

    st = forecast(p, sizes[i], &o, err);
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

static vg_status run_all(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_plan_options *o = p->o;
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
  st = p->decomposition.n_part ? VG_OK : try_leaves(p, err);
done:
  return st;
}

/* Read and check the surface and make the sizing field as vanguard mesh does,
 * grow or estimate the layers, and forecast the run. */
static vg_status make(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_settings *s = &p->problem.resolved.settings;
  struct vg_front v;
  vg_status st;

  VG_TRY(learn_rates(p, err));
  p->program = vg_report_peak_memory();
  VG_TRY(read_project(p, err));
  p->surface_peak = vg_report_peak_memory();
  p->front = &p->problem.boundary.surface;
  if (p->layers.is_on) VG_TRY(make_layers(p, err));
  else VG_TRY(measure_front(p, err));
  VG_TRY(vg_boundary_effects(&p->problem.boundary, p->front, p->sizing,
                             &p->effects, err));
  vg_effects_note(&p->effects, p->front, &p->problem.resolved.settings,
                  &p->problem.notes);
  v = vg_front_of(p->front);
  vg_display_update(&p->show, "forecast", 0, 0);
  VG_TRY(vg_load_new(&v, p->sizing, VG_LOAD_CELLS_PER_CUBE, vg_cores(),
                     &p->load, err));
  p->rates = vg_sizing_is_stretched(p->sizing) ? vg_rates_in_metric()
                                               : vg_rates_measured;
  vg_rates_replace(&p->rates, p->fit);
  VG_TRY(vg_plan_part(p, err));
  if (p->o->serial >= 0) {
    memset(p->phase, 0, sizeof p->phase);
    p->phase[VG_PHASE_READ] = p->o->serial;
  }
  p->rule = vg_options_cuts(s);
  p->rule.leaf_cells = vg_decomposition_leaf_cells(
    p->load.cells, vg_options_decomposition(s).n_part,
    vg_ways[s->decompose].maker != NULL, p->rule.leaf_cells);
  VG_TRY(forecast(p, p->rule.leaf_cells, &p->forecast, err));
  count_mesh(p);
  p->shared = vg_plan_shared(p);
  p->phase[VG_PHASE_JUDGE] = p->spread_per_cell * p->cell;
  p->phase[VG_PHASE_WRITE] = digest_per_byte * bytes_written(p);
  st = run_all(p, err);
done:
  return st;
}

static void release(struct vg_plan *p)
{
  vg_forecast_release(&p->forecast);
  vg_plan_decomposition_release(&p->decomposition);
  vg_load_release(&p->load);
  vg_effects_release(&p->effects);
  vg_sizing_free(p->sizing);
  vg_mesh_release(&p->lifted);
  vg_layer_stage_release(&p->layers);
  vg_problem_release(&p->problem);
  free(p->row);
}

int vg_plan_estimate(const struct vg_plan_options *o)
{
  struct vg_plan p = { .o = o, .problem = VG_PROBLEM_INIT };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_display_init(&p.show, o->quiet);
  vg_display_end_at_once(1);
  st = make(&p, &err);
  vg_display_end_at_once(0);
  vg_display_clear(&p.show);
  if (st >= 0 && o->json) st = vg_plan_json(&p, &err);
  else if (st >= 0) vg_plan_text(&p);
  if (st >= 0 && o->plot) st = vg_plan_draw(&p, &err);
  release(&p);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
