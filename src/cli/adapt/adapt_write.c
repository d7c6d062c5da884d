/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Table, plots and page of a loop. */
#define _GNU_SOURCE
#include "cli/adapt/adapt.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/plot/svg.h"
#include "io/stream/csv.h"
#include "run/common/folder.h"
#include "run/common/text.h"

/* Names of all output quantities, in the order in which they first occur. */
struct names {
  size_t n;
  const char *name[VG_ADAPT_OUTPUTS];
};

static const double *output_of(const struct vg_adapt_cycle *c, const char *name)
{
  for (size_t i = 0; i < c->n_output; i++)
    if (!strcmp(c->output[i].name, name)) return &c->output[i].value;
  return NULL;
}

static struct names names_of(const struct vg_adapt *a)
{
  struct names all = { 0 };

  for (size_t i = 0; i < a->n; i++)
    for (size_t k = 0; k < a->cycle[i].n_output; k++) {
      const char *name = a->cycle[i].output[k].name;
      size_t at = 0;

      while (at < all.n && strcmp(all.name[at], name)) at++;
      if (at == all.n && at < VG_ADAPT_OUTPUTS) all.name[all.n++] = name;
    }
  return all;
}

/* Cells over the requested number beyond which there is a note. */
#define MANY 1.3
#define FEW 0.75

int vg_adapt_note(const struct vg_adapt *a, const struct vg_adapt_cycle *c,
                  int k, char note[VG_ADAPT_NOTE])
{
  const double ratio = c->field_cells / c->requested;
  double growth, aspect_max;

  *note = 0;
  if (k == 0 && c->exit_status && c->is_done[VG_ADAPT_MESH])
    snprintf(note, VG_ADAPT_NOTE,
             "the mesh of cycle %d does not meet a limit; its report says "
             "which",
             c->number);
  if (k == 1 && c->attempt > 1 && c->is_done[VG_ADAPT_MESH]) {
    vg_adapt_attempt(&a->o->row, c->attempt, &growth, &aspect_max);
    snprintf(note, VG_ADAPT_NOTE,
             "cycle %d: no mesh could be made by the requested metric; that "
             "of attempt %d has growth %g and aspect_max %g",
             c->number, c->attempt, growth, aspect_max);
  }
  if (k == 2 && (ratio > MANY || ratio < FEW))
    snprintf(
      note, VG_ADAPT_NOTE,
      "cycle %d: %.2g times the requested cells: hmax, sources, gaps and "
      "the surface of the deck apply together with the metric",
      c->number, ratio);
  return k < 3;
}

/* --- text and .csv -------------------------------------------------------- */

static const char *count(double v, char text[32])
{
  return v >= 0 ? vg_text_count((unsigned long long)(v + 0.5), text) : "-";
}

void vg_adapt_print(FILE *to, const struct vg_adapt *a)
{
  const struct names all = names_of(a);
  char text[3][32], note[VG_ADAPT_NOTE];

  fprintf(to, "cycle    requested        cells       points  angle  mesh s "
              "solver s");
  for (size_t k = 0; k < all.n; k++) fprintf(to, " %14s", all.name[k]);
  fprintf(to, "\n");
  for (size_t i = 0; i < a->n; i++) {
    const struct vg_adapt_cycle *c = &a->cycle[i];

    if (!c->is_done[VG_ADAPT_MESH]) break;
    fprintf(to, "%5d %12s %12s %12s %6.2f %7.1f", c->number,
            count(c->requested, text[0]), count(c->cells, text[1]),
            count(c->points, text[2]), c->angle_min, c->seconds[VG_ADAPT_MESH]);
    if (c->is_done[VG_ADAPT_SOLVE])
      fprintf(to, " %8.1f", c->seconds[VG_ADAPT_SOLVE]);
    else fprintf(to, " %8s", "-");
    for (size_t k = 0; k < all.n; k++) {
      const double *v = output_of(c, all.name[k]);

      if (v) fprintf(to, " %14.7g", *v);
      else fprintf(to, " %14s", "-");
    }
    fprintf(to, "\n");
  }
  for (size_t i = 0; i < a->n; i++)
    for (int k = 0; vg_adapt_note(a, &a->cycle[i], k, note); k++)
      if (*note) fprintf(to, "  note: %s\n", note);
}

static void put_real(struct vg_output *out, double v)
{
  vg_output_text(out, ",");
  if (isfinite(v)) vg_output_real(out, v);
}

vg_status vg_adapt_write_csv(const struct vg_adapt *a, struct vg_error *err)
{
  const struct names all = names_of(a);
  struct vg_output out = VG_OUTPUT_INIT;
  char *path = NULL;
  vg_status st;

  VG_TRY(vg_folder_path(a->dir, "adapt.csv", &path, err));
  VG_TRY(vg_output_open(path, &out, err));
  vg_output_text(&out, "cycle,requested_cells,cells,points,field_cells,"
                       "angle_min,attempt,metric_seconds,mesh_seconds,"
                       "solver_seconds");
  for (size_t k = 0; k < all.n; k++) {
    vg_output_text(&out, ",");
    vg_csv_put(&out, all.name[k]);
  }
  vg_output_text(&out, "\n");
  for (size_t i = 0; i < a->n && a->cycle[i].is_done[VG_ADAPT_MESH]; i++) {
    const struct vg_adapt_cycle *c = &a->cycle[i];
    const double real[] = { c->requested,   c->cells,     c->points,
                            c->field_cells, c->angle_min, c->attempt };

    vg_output_format(&out, "%d", c->number);
    for (size_t k = 0; k < sizeof real / sizeof *real; k++)
      put_real(&out, real[k]);
    for (int k = 0; k < VG_ADAPT_N; k++)
      put_real(&out, c->is_done[k] ? c->seconds[k] : NAN);
    for (size_t k = 0; k < all.n; k++) {
      const double *v = output_of(c, all.name[k]);

      put_real(&out, v ? *v : NAN);
    }
    vg_output_text(&out, "\n");
  }
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  free(path);
  return st;
}

/* --- plots ---------------------------------------------------------------- */

#define WIDTH 560.0
#define HEIGHT 300.0

static double abscissa(const struct vg_adapt_cycle *c)
{
  return pow(c->cells, -2.0 / 3);
}

/* Values become differences from the last one in per cent, unless it is 0. */
static const char *relate(size_t n, double (*at)[2])
{
  const double last = at[n - 1][1];

  if (!(fabs(last) > 0)) return "value";
  for (size_t i = 0; i < n; i++) at[i][1] = 100 * (at[i][1] / last - 1);
  return "difference from the last cycle (%)";
}

/* Cycles from right to left: the limit of infinitely many cells is at 0. */
static void draw(struct vg_svg *svg, const struct vg_adapt *a, const char *name,
                 double (*at)[2])
{
  double first = 0, lo = INFINITY, hi = -INFINITY;
  const char *label;
  struct vg_axis x, y;
  size_t n = 0;

  for (size_t i = 0; i < a->n; i++) {
    const double *v = output_of(&a->cycle[i], name);

    if (!v || !(a->cycle[i].cells > 0)) continue;
    if (!(first > 0)) first = abscissa(&a->cycle[i]);
    at[n][0] = abscissa(&a->cycle[i]) / first;
    at[n++][1] = *v;
  }
  if (!n) return;
  label = relate(n, at);
  for (size_t i = 0; i < n; i++) {
    lo = fmin(lo, at[i][1]);
    hi = fmax(hi, at[i][1]);
  }
  x = vg_axis_linear(1, 5, 90, WIDTH - 30);
  y = vg_axis_range(lo, hi, 5, HEIGHT - 60, 50);
  vg_axis_draw_y(svg, &y, x.from, x.to, label);
  vg_axis_draw_x(svg, &x, y.from, y.to,
                 "(cells / cells of the first cycle)^(-2/3)");
  for (size_t i = 0; i < n; i++) {
    at[i][0] = vg_axis_at(&x, fmin(at[i][0], x.hi));
    at[i][1] = vg_axis_at(&y, at[i][1]);
    vg_svg_dot(svg, at[i][0], at[i][1], 4, VG_SVG_BLUE);
  }
  if (n > 1) vg_svg_polyline(svg, n, (const double(*)[2])at, VG_SVG_BLUE, 2, 0);
}

static vg_status plot(const struct vg_adapt *a, const char *name,
                      const char *path, struct vg_error *err)
{
  struct vg_svg svg = VG_SVG_INIT;
  double(*at)[2] = vg_alloc(a->n, sizeof *at);
  vg_status st;

  if (!at) return vg_fail_memory(err, "a figure");
  VG_TRY(vg_svg_open(path, WIDTH, HEIGHT, name, "", &svg, err));
  draw(&svg, a, name, at);
  st = vg_svg_close(&svg, err);
done:
  vg_svg_release(&svg);
  free(at);
  return st;
}

/* --- page ----------------------------------------------------------------- */

static const char style[] =
  "body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:70em;"
  "padding:0 1em;color:#222}table{border-collapse:collapse}"
  "td,th{padding:.2em .8em;text-align:right;border-bottom:1px solid #ddd}"
  "figure{display:inline-block;margin:1em 1em 0 0}";

/* A cell of the table; a dash if the number is not known. */
static void put_cell(struct vg_output *to, double v, int is_count)
{
  char text[32];

  if (!isfinite(v)) strcpy(text, "-");
  else if (is_count) count(v, text);
  else snprintf(text, sizeof text, "%.7g", v);
  vg_output_format(to, "<td>%s</td>", text);
}

static void put_row(struct vg_output *to, const struct vg_adapt_cycle *c,
                    const struct names *all)
{
  vg_output_format(to, "<tr><td><a href=\"cycle-%d/\">%d</a></td>", c->number,
                   c->number);
  put_cell(to, c->requested, 1);
  put_cell(to, c->cells, 1);
  put_cell(to, c->points, 1);
  put_cell(to, c->angle_min, 0);
  put_cell(to, c->seconds[VG_ADAPT_MESH], 0);
  put_cell(to, c->is_done[VG_ADAPT_SOLVE] ? c->seconds[VG_ADAPT_SOLVE] : NAN,
           0);
  for (size_t k = 0; k < all->n; k++) {
    const double *v = output_of(c, all->name[k]);

    put_cell(to, v ? *v : NAN, 0);
  }
  vg_output_text(to, "</tr>\n");
}

static void put_table(struct vg_output *to, const struct vg_adapt *a,
                      const struct names *all)
{
  vg_output_text(to, "<table><tr><th>cycle</th><th>cells requested</th>"
                     "<th>cells</th><th>points</th><th>smallest angle</th>"
                     "<th>mesh, s</th><th>solver, s</th>");
  for (size_t k = 0; k < all->n; k++) {
    vg_output_text(to, "<th>");
    vg_output_markup(to, all->name[k]);
    vg_output_text(to, "</th>");
  }
  vg_output_text(to, "</tr>\n");
  for (size_t i = 0; i < a->n && a->cycle[i].is_done[VG_ADAPT_MESH]; i++)
    put_row(to, &a->cycle[i], all);
  vg_output_text(to, "</table>\n");
}

static void put_notes(struct vg_output *to, const struct vg_adapt *a)
{
  char note[VG_ADAPT_NOTE];

  for (size_t i = 0; i < a->n; i++)
    for (int k = 0; vg_adapt_note(a, &a->cycle[i], k, note); k++)
      if (*note) vg_output_format(to, "<p>%s.</p>\n", note);
}

static vg_status put_figure(struct vg_output *to, const struct vg_adapt *a,
                            const char *name, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  char *path = NULL;
  vg_status st;

  VG_TRY(vg_folder_path(a->dir, "adapt.svg", &path, err));
  VG_TRY(plot(a, name, path, err));
  VG_TRY(vg_input_open(path, &in, err));
  vg_output_text(to, "<figure>");
  vg_output_text(to, (const char *)in.data);
  vg_output_text(to, "</figure>\n");
done:
  if (path) remove(path);
  vg_input_release(&in);
  free(path);
  return st;
}

static vg_status put_page(struct vg_output *to, const struct vg_adapt *a,
                          struct vg_error *err)
{
  const struct names all = names_of(a);
  vg_status st = VG_OK;

  vg_output_text(to, "<!DOCTYPE html>\n<html lang=\"en\"><head>"
                     "<meta charset=\"utf-8\"><title>Adaptation: ");
  vg_output_markup(to, a->stem);
  vg_output_format(to, "</title><style>%s</style></head><body>\n<h1>", style);
  vg_output_text(to, "Adaptation: ");
  vg_output_markup(to, a->stem);
  vg_output_text(to, "</h1>\n<p>Solver: <code>");
  vg_output_markup(to, a->o->row.solver);
  vg_output_text(to, "</code>. Fields of the metric: <code>");
  vg_output_markup(to, a->o->row.field);
  vg_output_text(to, "</code>.</p>\n");
  put_table(to, a, &all);
  put_notes(to, a);
  for (size_t k = 0; k < all.n && st >= 0; k++)
    st = put_figure(to, a, all.name[k], err);
  vg_output_text(to, "</body></html>\n");
  return st;
}

vg_status vg_adapt_write_page(const struct vg_adapt *a, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *path = NULL;
  vg_status st;

  VG_TRY(vg_folder_path(a->dir, "adapt.html", &path, err));
  VG_TRY(vg_output_open(path, &out, err));
  VG_TRY(put_page(&out, a, err));
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  free(path);
  return st;
}
