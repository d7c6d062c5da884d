/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on volume meshes and the volume fill. Declared in
 * run/report/report.h. */
#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#include "run/common/text.h"
#include "run/report/report.h"
#include "run/report/report_parts.h"

#define BAR_WIDTH 40

/* The peak of getrusage survives exec: it contains the memory of the program
 * that started this one. It serves where there is no /proc. */
double vg_report_peak_memory(void)
{
  FILE *f = fopen("/proc/self/status", "r");
  char line[128];
  double kilobytes = 0;
  struct rusage use;

  while (f && fgets(line, sizeof line, f))
    if (sscanf(line, "VmHWM: %lf", &kilobytes) == 1) break;
  if (f) fclose(f);
  if (!(kilobytes > 0) && !getrusage(RUSAGE_SELF, &use))
    kilobytes = (double)use.ru_maxrss;
  return 1024 * kilobytes;
}

/* Row i of the validity checks: its JSON key, and its name in texts. *key is
 * NULL past the last row. */
static size_t validity(const struct vg_mesh_report *r, int i, const char **key,
                       const char **name)
{
  const struct {
    const char *key, *name;
    size_t n;
  } row[] = {
    { "indices out of range", "indices out of range", r->bad_index },
    { "points not finite", "non-finite points", r->not_finite },
    { "unused points", "unused points", r->unused_point },
    { "duplicate points", "duplicate points", r->duplicate_point },
    { "cells not positive", "cells of zero or negative volume",
      r->not_positive },
    { "open faces", "faces without neighbour", r->open_face },
    { "faces of three cells", "faces of three or more cells", r->crowded_face },
    { "neighbours on one side", "faces with overlapping cells",
      r->same_side_face },
    { "boundary without cell", "boundary faces without cell",
      r->orphan_boundary },
    { "boundary outward", "boundary faces facing outward",
      r->outward_boundary },
  };

  if (i >= (int)(sizeof row / sizeof *row)) {
    *key = *name = NULL;
    return 0;
  }
  *key = row[i].key;
  *name = row[i].name;
  return row[i].n;
}

void vg_report_bars(FILE *to, const char *title, size_t n, const size_t *hist,
                    const double *limit, int digits)
{
  size_t total = 0, most = 0, first = n, end = 0;
  char bar[BAR_WIDTH + 1], count[32];

  for (size_t i = 0; i < n; i++) {
    total += hist[i];
    if (hist[i] > most) most = hist[i];
    if (hist[i] && first == n) first = i;
    if (hist[i]) end = i + 1;
  }
  if (!total) return;
  fprintf(to, "\n  %s\n", title);
  for (size_t i = first; i < end; i++) {
    size_t len = (size_t)(BAR_WIDTH * (double)hist[i] / (double)most + 0.5);

    memset(bar, '#', len);
    bar[len] = 0;
    fprintf(to, "  %6.*f - %6.*f %13s %7.3f %%  %s\n", digits, limit[i], digits,
            limit[i + 1], vg_text_count(hist[i], count),
            100.0 * (double)hist[i] / (double)total, bar);
  }
}

/* A histogram with bins of equal width from 0. */
static void bars(FILE *to, const char *title, const size_t *hist, size_t n,
                 double width, int digits)
{
  double limit[VG_HIST_ANGLE + 1];

  assert(n <= VG_HIST_ANGLE);
  for (size_t i = 0; i <= n; i++) limit[i] = width * (double)i;
  vg_report_bars(to, title, n, hist, limit, digits);
}

static void validity_text(FILE *to, const struct vg_mesh_report *r)
{
  const char *key, *name;
  char count[32];

  fprintf(to, "  validity: %s\n", r->is_valid ? "valid" : "NOT VALID");
  for (int i = 0;; i++) {
    size_t n = validity(r, i, &key, &name);

    if (!key) break;
    if (n) fprintf(to, "    %-32s %13s\n", name, vg_text_count(n, count));
  }
  fprintf(to,
          "  volume: sum of cells %.10g, enclosed by the boundary %.10g, "
          "difference %.2g\n",
          r->volume, r->enclosed, r->volume_error);
  fprintf(to, "  connected regions: %zu\n", r->n_component);
}

void vg_report_faults(const struct vg_mesh_report *r, char *text, size_t size)
{
  const char *key, *name;
  size_t at = 0;

  snprintf(text, size,
           "the sum of the cell volumes differs from the enclosed "
           "volume by %.2g",
           r->volume_error);
  for (int i = 0;; i++) {
    size_t n = validity(r, i, &key, &name);

    if (!key) break;
    if (n && at < size)
      at += (size_t)snprintf(text + at, size - at, "%s%zu %s", at ? ", " : "",
                             n, name);
  }
}

static void quality_text(FILE *to, const struct vg_mesh_report *r)
{
  fprintf(to,
          "  dihedral angles (degrees): smallest %.2f, largest %.2f; 1st "
          "percentile of each cell's smallest %.2f\n",
          r->angle_min, r->angle_max, r->angle_min_p1);
  fprintf(to,
          "  cells with an angle below 5, 10, 15, 20, 30 degrees: %.4f %.4f "
          "%.4f %.4f %.4f %%\n",
          r->below[0], r->below[1], r->below[2], r->below[3], r->below[4]);
  fprintf(to,
          "  cells with an angle above 150, 160, 170 degrees:     %.4f %.4f "
          "%.4f %%\n",
          r->above[0], r->above[1], r->above[2]);
  fprintf(to,
          "  radius ratio (3 r/R): mean %.4f, smallest %.4f; mean ratio: "
          "mean %.4f\n",
          r->radius_ratio_mean, r->radius_ratio_min, r->mean_ratio_mean);
  fprintf(to,
          "  volume ratio of neighbouring cells: median %.2f, 95th percentile "
          "%.2f, largest %.1f\n",
          r->volume_ratio[0], r->volume_ratio[1], r->volume_ratio[2]);
  fprintf(to, "  mean edge length: %.6g\n", r->edge_length);
  if (r->has_sizing)
    fprintf(to,
            "  edge length / target edge length: mean %.3f; between 0.7 and "
            "1.5: %.2f %%\n",
            r->edge_mean, r->edge_within);
}

void vg_report_whole_text(FILE *to, const struct vg_mesh_report *r)
{
  validity_text(to, r);
  fprintf(to,
          "  volume ratio of neighbouring cells: median %.2f, 95th percentile "
          "%.2f, largest %.1f\n",
          r->volume_ratio[0], r->volume_ratio[1], r->volume_ratio[2]);
  if (r->has_solver) vg_report_volumes_text(to, &r->solver);
  if (r->has_dual) vg_report_dual_text(to, &r->dual);
}

static void flat_text(FILE *to, const struct vg_mesh_report *r)
{
  size_t n = 0;
  char count[32], a[32], b[32], d[32];

  for (int c = 0; c < VG_FLAT_CAUSES; c++) n += r->flat[c].n;
  if (!r->has_flat || !n) return;
  fprintf(
    to,
    "  cells with an angle below %g degrees by the kinds of their points: "
    "%s\n  %-35s %10s %14s %9s %11s\n",
    VG_FLAT_LIMIT, vg_text_count(n, count), "", "cells", "at interfaces",
    "spanning", "on needles");
  for (int c = 0; c < VG_FLAT_CAUSES; c++) {
    const struct vg_flat_count *f = &r->flat[c];

    if (f->n)
      fprintf(to, "    %-33s %10s %14s %9s %11s\n",
              vg_flat_cause_name((enum vg_flat_cause)c),
              vg_text_count(f->n, count), vg_text_count(f->at_interface, a),
              vg_text_count(f->spanning, b), vg_text_count(f->needle, d));
  }
}

void vg_report_mesh_text(FILE *to, const struct vg_mesh_report *r, int full)
{
  validity_text(to, r);
  quality_text(to, r);
  if (r->has_metric) vg_report_metric_text(to, &r->metric);
  if (r->has_solver) vg_report_volumes_text(to, &r->solver);
  if (r->has_dual) vg_report_dual_text(to, &r->dual);
  flat_text(to, r);
  if (!full) return;
  bars(to, "Smallest dihedral angle of each cell (degrees)", r->hist_angle_min,
       VG_HIST_ANGLE, 5, 0);
  bars(to, "Largest dihedral angle of each cell (degrees)", r->hist_angle_max,
       VG_HIST_ANGLE, 5, 0);
  bars(to, "Radius ratio (3 r/R)", r->hist_radius_ratio, VG_HIST_UNIT, 0.05, 2);
  if (r->has_metric) vg_report_metric_bars(to, &r->metric);
  else if (r->has_sizing)
    bars(to, "Edge length / target edge length", r->hist_edge, VG_HIST_UNIT,
         0.1, 1);
  if (r->has_solver) vg_report_volumes_bars(to, &r->solver);
  if (r->has_dual) vg_report_dual_places(to, &r->dual);
  if (r->n_worst) fprintf(to, "\n  Worst cells\n");
  for (size_t i = 0; i < r->n_worst; i++)
    fprintf(to, "    cell %zu: smallest angle %.2f degrees at (%g, %g, %g)\n",
            r->worst[i].cell + 1, r->worst[i].value, r->worst[i].at[0],
            r->worst[i].at[1], r->worst[i].at[2]);
}

static json_t *worst_json(const struct vg_mesh_report *r)
{
  json_t *list = json_array();

  for (size_t i = 0; i < r->n_worst; i++) {
    json_t *one = json_object();

    json_object_set_new(one, "cell",
                        json_integer((json_int_t)r->worst[i].cell + 1));
    json_object_set_new(one, "angle_min", vg_json_real(r->worst[i].value));
    json_object_set_new(one, "at", vg_json_reals(r->worst[i].at, 3));
    json_array_append_new(list, one);
  }
  return list;
}

static json_t *points_json(const struct vg_flat_points *p,
                           const struct vg_mesh *patches)
{
  json_t *list = json_array();

  for (int k = 0; k < 4; k++) {
    json_t *one = json_object();
    const char *kind = vg_point_kind_name((enum vg_point_kind)p->kind[k]);

    json_object_set_new(one, "kind", json_string(kind));
    if (p->patch[k] < patches->n_patch) {
      const struct vg_patch *patch = &patches->patch[p->patch[k]];

      json_object_set_new(one, "patch", json_integer(patch->id));
      json_object_set_new(one, "name", vg_text_json(patch->name));
    }
    json_array_append_new(list, one);
  }
  return list;
}

static json_t *flat_worst_json(const struct vg_mesh_report *r,
                               const struct vg_mesh *patches)
{
  json_t *list = json_array();

  for (size_t i = 0; i < r->n_worst; i++) {
    const struct vg_worst_cell *w = &r->worst[i];
    json_t *one;

    if (w->points.kind[0] == VG_POINT_UNKNOWN) continue;
    one = json_object();
    json_object_set_new(one, "angle", vg_json_real(w->value));
    json_object_set_new(one, "at", vg_json_reals(w->at, 3));
    json_object_set_new(one, "points", points_json(&w->points, patches));
    json_array_append_new(list, one);
  }
  return list;
}

static json_t *flat_json(const struct vg_mesh_report *r,
                         const struct vg_mesh *patches)
{
  json_t *o = json_object(), *causes = json_object();
  json_int_t n = 0;

  for (int c = 0; c < VG_FLAT_CAUSES; c++) {
    const struct vg_flat_count *f = &r->flat[c];

    n += (json_int_t)f->n;
    json_object_set_new(causes, vg_flat_cause_key((enum vg_flat_cause)c),
                        json_pack("{s:I s:I s:I s:I}", "cells",
                                  (json_int_t)f->n, "at_interfaces",
                                  (json_int_t)f->at_interface, "spanning",
                                  (json_int_t)f->spanning, "on_needles",
                                  (json_int_t)f->needle));
  }
  json_object_set_new(o, "limit", vg_json_real(VG_FLAT_LIMIT));
  json_object_set_new(o, "cells", json_integer(n));
  json_object_set_new(o, "by_cause", causes);
  json_object_set_new(o, "worst", flat_worst_json(r, patches));
  return o;
}

static json_t *validity_json(const struct vg_mesh_report *r)
{
  json_t *o = json_object();
  const char *key, *name;

  for (int i = 0;; i++) {
    size_t n = validity(r, i, &key, &name);

    if (!key) break;
    json_object_set_new(o, key, json_integer((json_int_t)n));
  }
  return o;
}

static json_t *edges_json(const struct vg_mesh_report *r)
{
  json_t *o;

  if (!r->has_sizing) return json_null();
  o = json_object();
  json_object_set_new(o, "mean", vg_json_real(r->edge_mean));
  json_object_set_new(o, "percent_within", vg_json_real(r->edge_within));
  json_object_set_new(o, "histogram",
                      vg_json_counts(r->hist_edge, VG_HIST_UNIT));
  return o;
}

json_t *vg_report_mesh_json(const struct vg_mesh_report *r,
                            const struct vg_mesh *patches)
{
  json_t *o = json_object();

  json_object_set_new(o, "valid", json_boolean(r->is_valid));
  json_object_set_new(o, "validity", validity_json(r));
  json_object_set_new(o, "points", json_integer((json_int_t)r->n_point));
  json_object_set_new(o, "cells", json_integer((json_int_t)r->n_cell));
  json_object_set_new(o, "regions", json_integer((json_int_t)r->n_component));
  json_object_set_new(o, "volume", vg_json_real(r->volume));
  json_object_set_new(o, "enclosed", vg_json_real(r->enclosed));
  json_object_set_new(o, "volume_error", vg_json_real(r->volume_error));
  json_object_set_new(o, "angle_min", vg_json_real(r->angle_min));
  json_object_set_new(o, "angle_max", vg_json_real(r->angle_max));
  json_object_set_new(o, "angle_min_p1", vg_json_real(r->angle_min_p1));
  json_object_set_new(o, "percent_below_5_10_15_20_30",
                      vg_json_reals(r->below, 5));
  json_object_set_new(o, "percent_above_150_160_170",
                      vg_json_reals(r->above, 3));
  json_object_set_new(o, "radius_ratio_mean",
                      vg_json_real(r->radius_ratio_mean));
  json_object_set_new(o, "radius_ratio_min", vg_json_real(r->radius_ratio_min));
  json_object_set_new(o, "mean_ratio_mean", vg_json_real(r->mean_ratio_mean));
  json_object_set_new(o, "edge_length", vg_json_real(r->edge_length));
  json_object_set_new(o, "volume_ratio_median_95_max",
                      vg_json_reals(r->volume_ratio, 3));
  json_object_set_new(o, "histogram_angle_min",
                      vg_json_counts(r->hist_angle_min, VG_HIST_ANGLE));
  json_object_set_new(o, "histogram_angle_max",
                      vg_json_counts(r->hist_angle_max, VG_HIST_ANGLE));
  json_object_set_new(o, "histogram_radius_ratio",
                      vg_json_counts(r->hist_radius_ratio, VG_HIST_UNIT));
  json_object_set_new(o, "edges", edges_json(r));
  if (r->has_metric)
    json_object_set_new(o, "metric", vg_report_metric_json(&r->metric));
  if (r->has_solver)
    json_object_set_new(o, "solver_quality",
                        vg_report_volumes_json(&r->solver));
  if (r->has_dual)
    json_object_set_new(o, "median_dual", vg_report_dual_json(&r->dual));
  json_object_set_new(o, "worst", worst_json(r));
  if (r->has_flat) json_object_set_new(o, "flat_cells", flat_json(r, patches));
  return o;
}

static void other_text(FILE *to, const struct vg_fill_report *r)
{
  size_t back = r->n_other_failed + r->n_other_ended + r->n_other_wrong;
  char a[32], b[32], c[32];

  if (!r->n_other && !back) return;
  fprintf(to,
          "  subdomains filled by the selected mesher: %s, %s cells in %.2f s "
          "(%s cells/s)\n",
          vg_text_count(r->n_other, a), vg_text_count(r->n_other_cell, b),
          r->time_other,
          vg_text_count((unsigned long long)(r->time_other > 0
                                               ? (double)r->n_other_cell /
                                                   r->time_other
                                               : 0),
                        c));
  if (back)
    fprintf(to,
            "  subdomains filled by the built-in mesher instead: %zu "
            "(%zu rejected by the selected\n  mesher, %zu crashed, "
            "%zu with an invalid result)\n",
            back, r->n_other_failed, r->n_other_ended, r->n_other_wrong);
}

void vg_report_fill_text(FILE *to, const struct vg_fill_report *r,
                         size_t n_cell)
{
  char a[32], b[32], c[32];
  double rate = r->time_total > 0 ? (double)n_cell / r->time_total : 0;

  fprintf(to, "  interior points: inserted %s, rejected %s\n",
          vg_text_count(r->n_inserted, a), vg_text_count(r->n_refused, b));
  fprintf(to,
          "  boundary recovery: triangles recovered %s; pockets closed %s "
          "with %zu cells, retries %zu%s\n",
          vg_text_count(r->n_surface_face_lost, a),
          vg_text_count(r->n_pocket, b), r->n_pocket_cell, r->n_retry,
          r->whole_void ? "; a whole subdomain was meshed by TetGen" : "");
  if (r->n_unassisted)
    fprintf(to,
            "  pockets that were left open because vanguard-tetgen is missing: "
            "%zu (the domain was\n  cut elsewhere)\n",
            r->n_unassisted);
  other_text(to, r);
  if (r->n_list_cut)
    fprintf(to,
            "  points with more neighbours than are examined: %zu (some "
            "may be too close to each other)\n",
            r->n_list_cut);
  if (r->n_steiner)
    fprintf(to, "  points added to recover the boundary: %zu\n", r->n_steiner);
  fprintf(to,
          "  optimisation: smoothed %s, swapped %s, collapsed %s, split "
          "%zu\n",
          vg_text_count(r->n_smoothed, a), vg_text_count(r->n_flip, b),
          vg_text_count(r->n_collapse, c), r->n_split);
  if (r->n_left)
    fprintf(to,
            "  poor cells for which no point insertion was attempted, since "
            "the limit was reached: %s\n",
            vg_text_count(r->n_left, a));
  fprintf(to,
          "  time (s): boundary recovery %.2f, point placement %.2f, insertion "
          "%.2f, optimisation %.2f,\n  total %.2f (%s cells/s)\n",
          r->time_boundary, r->time_place, r->time_insert, r->time_optimise,
          r->time_total, vg_text_count((unsigned long long)rate, a));
}

void vg_report_entries(json_t *o, json_t *seconds, const struct vg_entries *l,
                       const void *report)
{
  for (size_t k = 0; k < l->n; k++) {
    const struct vg_entry *f = &l->entry[k];

    if (!f->name) continue;
    if (f->type == VG_ENTRY_REAL || f->type == VG_ENTRY_SECONDS)
      json_object_set_new(f->type == VG_ENTRY_SECONDS ? seconds : o, f->name,
                          json_real(vg_entry_real(f, report)));
    else if (f->type == VG_ENTRY_FLAG)
      json_object_set_new(o, f->name, json_boolean(vg_entry_count(f, report)));
    else
      json_object_set_new(o, f->name,
                          json_integer((json_int_t)vg_entry_count(f, report)));
  }
}

json_t *vg_report_fill_json(const struct vg_fill_report *r, size_t n_cell)
{
  json_t *o = json_object(), *seconds = json_object();

  vg_report_entries(o, seconds, &vg_fill_entries, r);
  json_object_set_new(o, "seconds", seconds);
  json_object_set_new(o, "cells_per_second",
                      vg_json_real(r->time_total > 0
                                     ? (double)n_cell / r->time_total
                                     : 0));
  return o;
}
