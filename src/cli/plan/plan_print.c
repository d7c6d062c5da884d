/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Output of the forecast of a project: text, JSON, plot. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "cli/plan/plan_output.h"
#include "cli/plot/plot.h"
#include "partition/advance/ways.h"
#include "run/common/json_build.h"
#include "run/common/json_file.h"
#include "run/common/text.h"
#include "run/report/report.h"

/* --- text ---------------------------------------------------------------- */

static const char *count(double n, char text[32])
{
  return vg_text_count((unsigned long long)(n + 0.5), text);
}

static const char *bytes(double n, char text[32])
{
  if (n < 1e9) snprintf(text, 32, "%.1f MB", n / 1e6);
  else snprintf(text, 32, "%.2f GB", n / 1e9);
  return text;
}

static void print_mesh(const struct vg_plan *p)
{
  const struct vg_notes *notes = &p->problem->notes;
  char a[32];

  printf("%s\n\nExpected mesh\n", p->problem->asked.title);
  printf("  %-24s %15s\n", "cells", count(p->cell, a));
  if (p->layers->is_on) {
    printf("  %-24s %15s  %s\n", "  in layers",
           count(p->prism > 0 ? p->prism : p->layer_tet, a),
           p->is_grown ? "(layers were grown)"
                       : "(estimated from walls and growth law)");
    printf("  %-24s %15s\n", "  outside the layers", count(p->load.cells, a));
    printf("  %-24s %15s\n", "wall points", count((double)p->n_wall_point, a));
  }
  printf("  %-24s %15s\n", "points", count(p->point, a));
  if (p->layers->is_on)
    printf("  %-24s %15s\n", "  in layers", count(p->layer_point, a));
  printf("  %-24s %15s\n", "triangles of the front",
         count((double)p->front->n_tri, a));
  for (size_t i = 0; i < notes->n; i++) printf("  note: %s\n", notes->text[i]);
}

static void print_files(const struct vg_plan *p)
{
  char list[VG_WRITE_MAX], *save = NULL, text[32];

  printf("\nFiles\n");
  memcpy(list, p->problem->resolved.settings.write, sizeof list);
  for (char *word = strtok_r(list, " ,", &save); word;
       word = strtok_r(NULL, " ,", &save)) {
    double size = vg_plan_bytes(p, word);

    printf("  %-24s %15s\n", word, size > 0 ? bytes(size, text) : "small");
  }
}

static void print_planes(const struct vg_lattice *l)
{
  for (int axis = 0; axis < 3; axis++) {
    if (!l->n[axis]) continue;
    printf("  %c =", 'x' + axis);
    for (int k = 0; k < l->n[axis]; k++) printf(" %.6g", l->at[axis][k]);
  }
}

/* Print the leaves of a node in one line. */
static void print_leaves(const struct vg_forecast *o, size_t parent, int indent)
{
  double least = INFINITY, most = 0;
  char a[32], b[32];
  size_t n = 0;

  for (size_t i = parent + 1; i < o->n_node; i++) {
    const struct vg_forecast_node *c = &o->node[i];

    if (c->parent != parent || !vg_forecast_is_leaf(c)) continue;
    least = fmin(least, c->cells);
    most = fmax(most, c->cells);
    n++;
  }
  if (!n) return;
  printf("  %*s%zu %s %s", 2 * indent, "", n,
         n > 1 ? "leaves:" : "leaf:", count(least, a));
  if (n > 1) printf(" to %s", count(most, b));
  printf(" cells\n");
}

static void print_number(size_t n, const char *what)
{
  printf("%zu %s%s", n, what, n == 1 ? "" : "s");
}

/* Largest over mean number of expected cells in leaves. Fragments, which are
 * filled together, are excluded as in the report of a run. */
static double balance(const struct vg_forecast *o)
{
  double most = 0, sum = 0, n = 0;

  for (size_t i = 0; i < o->n_node; i++) {
    const struct vg_forecast_node *c = &o->node[i];
    size_t length = strlen(c->path);

    if (!vg_forecast_is_leaf(c) ||
        (length > 2 && !strcmp(c->path + length - 2, ".r")))
      continue;
    most = fmax(most, c->cells);
    sum += c->cells;
    n++;
  }
  return sum > 0 ? most * n / sum : 1;
}

static void print_decomposition(const struct vg_plan *p)
{
  const struct vg_plan_decomposition *q = &p->decomposition;
  const struct vg_decomposition_report *r = &q->made.report;
  const char *way = vg_ways[p->problem->resolved.settings.decompose].name;
  char a[32], b[32], c[32];

  if (!q->n_part) return;
  printf("\nSubdomains\n");
  printf("  %s: %s subdomains filled without cuts, with %s cells, ", way,
         count((double)q->n_whole, a), count(q->cells, b));
  printf("max/mean %.2f\n  %s %s, coarsening %.2f, %s interface triangles, "
         "made here in %.2f s\n",
         q->n_whole ? q->most * (double)q->n_whole / q->cells : 1,
         count((double)r->n_coarse, a), r->n_gap ? "octants" : "coarse cells",
         r->coarsening, count((double)r->n_face, c), q->seconds);
  if (r->n_gap)
    printf("  and %s of the gap region at the front, which planes may cut\n",
           count((double)r->n_gap, a));
}

/* Number of voids that are cut by planes. */
static size_t cuts(const struct vg_plan *p)
{
  const struct vg_forecast *o = &p->forecast;

  return o->n_node - o->n_leaf - (p->decomposition.n_part > 0);
}

static void print_tree(const struct vg_plan *p, const struct vg_plan_options *o)
{
  const struct vg_forecast *f = &p->forecast;
  char a[32], b[32];

  printf("\nDomain decomposition\n  ");
  print_number(cuts(p), "cut");
  printf(" into ");
  if (f->n_leaf == 1) printf("1 leaf; ");
  else printf("%zu leaves; ", f->n_leaf);
  print_number(f->n_pencil, "edge separator");
  printf(" and ");
  print_number(f->n_tile, "face separator");
  printf(" with %s cells (%.1f %%);\n  cells per leaf: max/mean %.2f\n",
         count(f->separator_cells, a),
         f->cells > 0 ? 100 * f->separator_cells / f->cells : 0, balance(f));
  for (size_t i = 0; i < f->n_node; i++) {
    const struct vg_forecast_node *n = &f->node[i];

    if (n->depth >= o->depth || (vg_forecast_is_leaf(n) && i)) continue;
    printf("  %*s%s: %s cells, %s in separators", 2 * n->depth, "", n->path,
           count(n->cells, a), count(n->zone, b));
    print_planes(&n->lattice);
    printf("\n");
    print_leaves(f, i, n->depth + 1);
  }
}

static void print_row(const struct vg_plan_row *r)
{
  printf("  %5d %7d %7d %10.2f %9.2f %11.1f %10.2f %9.2f %10.3f %9.3f %5.1f "
         "%5.1f %9.0f\n",
         r->ranks, r->threads, r->ranks * r->threads, r->wall, r->speedup,
         100 * r->efficiency, r->tasks.wall, r->tasks.speedup,
         r->tasks.critical, r->tasks.cuts_wall, 100 * r->tasks.cuts,
         100 * r->tasks.cuts_extra, r->memory / 1e6);
}

static void print_best(const struct vg_plan *p, const struct vg_plan_options *o)
{
  const struct vg_plan_row *r;
  const char *why = "most workers with at least 80 % efficiency";
  char text[64] = "", cells[32];

  if (p->best == SIZE_MAX) {
    if (o->target > 0)
      printf("\nNo machine in the list takes %g s or less.\n", o->target);
    else printf("\nNo machine in the list reaches 80 %% efficiency.\n");
    r = &p->row[p->n_row - 1];
    snprintf(text, sizeof text, "Times with");
  } else {
    r = &p->row[p->best];
    if (o->target > 0) why = "fewest workers that meet the target";
    printf("\nBest: %d rank%s x %d thread%s, %.2f s (%s)\n", r->ranks,
           r->ranks > 1 ? "s" : "", r->threads, r->threads > 1 ? "s" : "",
           r->wall, why);
    snprintf(text, sizeof text, "Times with");
  }
  if (o->cores)
    printf("Start: mpirun -n %d --map-by ppr:%d:node:PE=%d vanguard mesh -p %s "
           "--threads %d\n",
           r->ranks, r->ranks_per_node, r->threads, o->project, r->threads);
  if (!p->n_leaf) return;
  printf("%s %d x %d by leaf_cells:\n   leaf_cells  leaves    time, s   tasks, "
         "s\n",
         text, r->ranks, r->threads);
  for (size_t i = 0; i < p->n_leaf; i++)
    printf("  %11s %7zu %10.2f %10.2f%s\n", count(p->leaf[i].cells, cells),
           p->leaf[i].n, p->leaf[i].row.wall, p->leaf[i].row.tasks.wall,
           i == p->best_leaf ? "  best" : "");
}

/* The resource that limits a phase: the portion that takes longest. */
static const char *limit_of(const double parts[3])
{
  static const char *const names[3] = { "one thread", "the cores of a node",
                                        "all cores" };
  int most = 0;

  for (int k = 1; k < 3; k++)
    if (parts[k] > parts[most]) most = k;
  return names[most];
}

/* What limits the tasks; a chain of tasks takes the same time on any number of
 * these cores. */
static const char *limit_of_tasks(const struct vg_plan_row *r)
{
  return r->tasks.critical > 0.8 * r->tasks.wall ? "critical path of tasks"
       : r->tasks.idle > 0.2                     ? "too few or too large tasks"
                                                 : "all cores";
}

static const struct vg_plan_row *row_of_limits(const struct vg_plan *p)
{
  return &p->row[p->best == SIZE_MAX ? p->n_row - 1 : p->best];
}

static void print_limits(const struct vg_plan *p)
{
  const struct vg_plan_row *r = row_of_limits(p);

  printf("\nPhases with %d x %d\n  phase          one core, s    time, s  "
         "limited by\n",
         r->ranks, r->threads);
  for (int k = 0; k < VG_PHASE_N; k++) {
    double parts[3], there = vg_plan_phase(p, r, (enum vg_phase)k, parts);

    if (k == VG_PHASE_ENGINE)
      printf("  %-13s %12.2f %10.2f  %s\n", "cut+fill", r->tasks.work,
             r->tasks.wall, limit_of_tasks(r));
    else if (p->phase[k] > 0)
      printf("  %-13s %12.2f %10.2f  %s\n", vg_phase_label((enum vg_phase)k),
             p->phase[k], there, limit_of(parts));
  }
}

static const char *const memory_stage[VG_MEMORY_STAGES] = {
  "surface", "sizing field and layers", "fill", "mesh check and files"
};

static void print_memory(const struct vg_plan *p)
{
  const struct vg_plan_row *r = row_of_limits(p);
  char text[32];

  printf("\nMemory of a rank with %d x %d\n", r->ranks, r->threads);
  for (int i = 0; i < VG_MEMORY_STAGES; i++)
    printf("  %-24s %15s\n", memory_stage[i], bytes(r->stage[i], text));
  printf("  %-24s %15s\n", "one copy per node", bytes(p->shared, text));
}

static const char *kind_name(char kind)
{
  return kind == VG_SPAN_LEAF   ? "leaves"
       : kind == VG_SPAN_PENCIL ? "pencils"
                                : "tiles";
}

static void print_rates(const struct vg_plan *p,
                        const struct vg_plan_options *o)
{
  if (!o->rates) return;
  printf("\nTask times, fitted to %s\n", o->rates);
  for (int k = 0; k < VG_RATE_FITS; k++) {
    const struct vg_rate_fit *f = &p->o->fit[k];

    if (f->n)
      printf("  %-8s %.3f us per cell, %.3f us per face of the front; %zu "
             "tasks, error %.0f %%\n",
             kind_name(f->kind), 1e6 * f->cell, 1e6 * f->face, f->n,
             100 * f->error);
    else printf("  %-8s too few tasks in the timeline\n", kind_name(f->kind));
  }
}

static double outside(const struct vg_plan *p)
{
  double sum = 0;

  for (int k = 0; k < VG_PHASE_N; k++) sum += p->phase[k];
  return sum;
}

void vg_plan_text(const struct vg_plan *p, const struct vg_plan_options *o)
{
  print_mesh(p);
  print_files(p);
  print_decomposition(p);
  print_tree(p, o);
  print_rates(p, o);
  printf(
    "\nForecast: on one core %.2f s outside the tasks and %.2f s in tasks, of "
    "which %.2f s in loops\n  of front updates (joins), which idle threads of "
    "a rank share\n",
    outside(p), p->forecast.spans.wall, vg_spans_loops(&p->forecast.spans));
  printf("  ranks threads workers       time  speed-up  efficiency      tasks "
         " speed-up   critical  cuts end  cuts extra  MB/rank\n");
  printf("                               s                     %%          s  "
         "                  s         s     %%     %%\n");
  for (size_t i = 0; i < p->n_row; i++) print_row(&p->row[i]);
  print_limits(p);
  print_memory(p);
  print_best(p, o);
}

/* --- JSON ---------------------------------------------------------------- */

static json_t *row_json(const struct vg_plan_row *r)
{
  json_t *o = json_pack(
    "{s:i s:i s:i s:i s:f s:f s:f s:f s:{s:f s:f s:f s:f s:f "
    "s:f s:f s:f}}",
    "ranks", r->ranks, "threads", r->threads, "ranks_per_node",
    r->ranks_per_node, "workers", r->ranks * r->threads, "seconds", r->wall,
    "speedup", r->speedup, "efficiency", r->efficiency, "memory_bytes",
    r->memory, "tasks", "seconds", r->tasks.wall, "speedup", r->tasks.speedup,
    "critical", r->tasks.critical, "cuts", r->tasks.cuts, "cuts_extra",
    r->tasks.cuts_extra, "cuts_end", r->tasks.cuts_wall, "idle", r->tasks.idle,
    "bytes_sent", r->tasks.bytes);
  json_t *memory = json_object();

  for (int i = 0; i < VG_MEMORY_STAGES; i++)
    json_object_set_new(memory, vg_memory_stage_name((enum vg_memory_stage)i),
                        json_real(r->stage[i]));
  json_object_set_new(o, "memory_stages", memory);
  return o;
}

static json_t *node_json(const struct vg_forecast_node *n)
{
  json_t *o = json_pack("{s:s s:f s:f s:f s:[f,f,f] s:[f,f,f]}", "path",
                        n->path, "cells", n->cells, "separator_cells", n->zone,
                        "front_faces", n->faces, "lo", n->lo[0], n->lo[1],
                        n->lo[2], "hi", n->hi[0], n->hi[1], n->hi[2]);
  json_t *planes = json_object();

  for (int axis = 0; axis < 3; axis++) {
    const char name[2] = { (char)('x' + axis), 0 };
    json_t *list = json_array();

    for (int k = 0; k < n->lattice.n[axis]; k++)
      json_array_append_new(list, json_real(n->lattice.at[axis][k]));
    if (n->lattice.n[axis]) json_object_set(planes, name, list);
    json_decref(list);
  }
  json_object_set_new(o, "leaf", json_boolean(vg_forecast_is_leaf(n)));
  if (!vg_forecast_is_leaf(n)) json_object_set(o, "planes", planes);
  json_decref(planes);
  return o;
}

static json_t *mesh_json(const struct vg_plan *p)
{
  json_t *o = json_pack("{s:f s:f s:f s:f s:f}", "cells", p->cell, "points",
                        p->point, "tetrahedra", p->tet, "prisms", p->prism,
                        "field_cells", p->load.cells);

  if (!p->layers->is_on) return o;
  json_object_set_new(o, "layers",
                      json_pack("{s:f s:f s:s s:I}", "tetrahedra", p->layer_tet,
                                "points", p->layer_point, "source",
                                p->is_grown ? "grown" : "estimated",
                                "wall_points", (json_int_t)p->n_wall_point));
  return o;
}

static json_t *files_json(const struct vg_plan *p)
{
  char list[VG_WRITE_MAX], *save = NULL;
  json_t *o = json_object();

  memcpy(list, p->problem->resolved.settings.write, sizeof list);
  for (char *word = strtok_r(list, " ,", &save); word;
       word = strtok_r(NULL, " ,", &save))
    json_object_set_new(o, word, json_real(vg_plan_bytes(p, word)));
  return o;
}

static json_t *decomposition_json(const struct vg_plan *p)
{
  const struct vg_plan_decomposition *q = &p->decomposition;

  return json_pack("{s:s s:I s:I s:I s:f s:f s:f s:I s:I s:f}", "way",
                   vg_ways[p->problem->resolved.settings.decompose].name,
                   "parts", (json_int_t)q->n_part, "complete_subdomains",
                   (json_int_t)q->n_whole, "gap_parts",
                   (json_int_t)q->made.report.n_gap, "whole_cells", q->cells,
                   "most_cells", q->most, "coarsening",
                   q->made.report.coarsening, "coarse_cells",
                   (json_int_t)q->made.report.n_coarse, "interface_triangles",
                   (json_int_t)q->made.report.n_face, "seconds", q->seconds);
}

static json_t *tree_json(const struct vg_plan *p)
{
  const struct vg_forecast *t = &p->forecast;
  json_t *o = json_pack("{s:f s:I s:I s:I s:I s:f}", "balance", balance(t),
                        "cuts", (json_int_t)cuts(p), "leaves",
                        (json_int_t)t->n_leaf, "pencils",
                        (json_int_t)t->n_pencil, "tiles", (json_int_t)t->n_tile,
                        "separator_cells", t->separator_cells);
  json_t *list = json_array();

  for (size_t i = 0; i < t->n_node; i++)
    json_array_append_new(list, node_json(&t->node[i]));
  json_object_set_new(o, "nodes", list);
  return o;
}

static json_t *rates_json(const struct vg_plan *p)
{
  json_t *list = json_array();

  for (int k = 0; k < VG_RATE_FITS; k++)
    if (p->o->fit[k].n)
      json_array_append_new(list,
                            json_pack("{s:s s:I s:f s:f s:f}", "tasks",
                                      kind_name(p->o->fit[k].kind), "n",
                                      (json_int_t)p->o->fit[k].n,
                                      "seconds_per_cell", p->o->fit[k].cell,
                                      "seconds_per_face", p->o->fit[k].face,
                                      "error", p->o->fit[k].error));
  return list;
}

static json_t *leaves_json(const struct vg_plan *p)
{
  json_t *list = json_array();

  for (size_t i = 0; i < p->n_leaf; i++)
    json_array_append_new(list, json_pack("{s:f s:I s:f s:f}", "leaf_cells",
                                          p->leaf[i].cells, "leaves",
                                          (json_int_t)p->leaf[i].n, "seconds",
                                          p->leaf[i].row.wall, "tasks_seconds",
                                          p->leaf[i].row.tasks.wall));
  return list;
}

/* Phases on the best machine; without a best one, on the largest machine. */
static json_t *limits_json(const struct vg_plan *p)
{
  const struct vg_plan_row *r = row_of_limits(p);
  json_t *list = json_array();

  for (int k = 0; k < VG_PHASE_N; k++) {
    double parts[3], there = vg_plan_phase(p, r, (enum vg_phase)k, parts);
    int tasks = k == VG_PHASE_ENGINE;

    if (!tasks && !(p->phase[k] > 0)) continue;
    json_array_append_new(
      list,
      json_pack("{s:s s:f s:f s:s}", "phase", vg_phase_name((enum vg_phase)k),
                "one_core", tasks ? r->tasks.work : p->phase[k], "seconds",
                tasks ? r->tasks.wall : there, "limited_by",
                tasks ? limit_of_tasks(r) : limit_of(parts)));
  }
  return list;
}

vg_status vg_plan_json(const struct vg_plan *p, struct vg_error *err)
{
  json_t *o = json_object(), *rows = json_array();
  vg_status st;

  json_object_set_new(o, "title", vg_text_json(p->problem->asked.title));
  json_object_set_new(o, "mesh", mesh_json(p));
  json_object_set_new(o, "sources",
                      vg_effects_json(&p->effects, p->front,
                                      &p->problem->resolved.settings));
  json_object_set_new(o, "files", files_json(p));
  json_object_set_new(o, "memory", json_pack("{s:f}", "shared", p->shared));
  if (p->decomposition.n_part)
    json_object_set_new(o, "decomposition", decomposition_json(p));
  json_object_set_new(o, "tree", tree_json(p));
  json_object_set_new(o, "rates", rates_json(p));
  json_object_set_new(o, "one_core",
                      json_pack("{s:f s:f s:f}", "outside", outside(p), "tasks",
                                p->forecast.spans.wall, "loops",
                                vg_spans_loops(&p->forecast.spans)));
  json_object_set_new(o, "phases", limits_json(p));
  for (size_t i = 0; i < p->n_row; i++)
    json_array_append_new(rows, row_json(&p->row[i]));
  json_object_set_new(o, "forecast", rows);
  if (p->best != SIZE_MAX)
    json_object_set_new(o, "best", row_json(&p->row[p->best]));
  json_object_set_new(o, "leaf_sizes", leaves_json(p));
  if (p->n_leaf)
    json_object_set_new(o, "best_leaf_cells",
                        json_real(p->leaf[p->best_leaf].cells));
  st = vg_json_print(stdout, o, 0, "the forecast", err);
  json_decref(o);
  return st;
}

/* --- figure -------------------------------------------------------------- */

static int by_workers(const void *a, const void *b)
{
  const struct vg_plan_row *s = a, *t = b;
  int n = s->ranks * s->threads, m = t->ranks * t->threads;

  return n != m ? n - m : s->ranks - t->ranks;
}

vg_status vg_plan_draw(const struct vg_plan *p, const char *plot,
                       struct vg_error *err)
{
  size_t n = p->n_row;
  struct vg_plan_row *row = vg_alloc(n, sizeof *row);
  double *v = vg_alloc(3 * n, sizeof *v);
  struct vg_plot_series line[] = { { "whole run", 0, 1, n, v, v + n },
                                   { "tasks", 1, 1, n, v, v + 2 * n } };
  vg_status st;

  if (!v || !row) {
    st = vg_fail_memory(err, "a figure");
    goto done;
  }
  memcpy(row, p->row, n * sizeof *row);
  qsort(row, n, sizeof *row, by_workers);
  for (size_t i = 0; i < n; i++) {
    v[i] = row[i].ranks * row[i].threads;
    v[n + i] = row[i].speedup;
    v[2 * n + i] = row[i].tasks.speedup;
  }
  st = vg_plot_speedup(plot, p->problem->asked.title, "forecast from the load",
                       2, line, err);
done:
  free(row);
  free(v);
  return st;
}
