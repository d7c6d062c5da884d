/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Pages of results: the report of a run, a comparison of runs, the figures of a
 * sweep. Declared in cli/serve/portal_parts.h. */
#define _GNU_SOURCE
#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/http/inside.h"
#include "base/memory.h"
#include "cli/serve/figures.h"
#include "cli/serve/page_markup.h"
#include "cli/serve/portal_parts.h"
#include "cli/serve/rows.h"
#include "run/settings/deck.h"

#define VALUE_SIZE (2 * VG_LIST_MAX + 4)

static void print_name(FILE *to, const struct vg_serve_run *run)
{
  fprintf(to, "<a href=\"./#run-%d\">Run %d</a>", run->id, run->id);
  if (!*run->title) return;
  fputs(" ", to);
  vg_markup(to, run->title);
}

static void print_heading(FILE *to, const char *what)
{
  fprintf(to, "<section class=\"wide\"><h2>%s</h2>\n", what);
}

/* --- report -------------------------------------------------------------- */

void vg_page_report(const struct vg_serve_run *run, FILE *to)
{
  char *name = vg_run_result(run, ".report.html");

  fputs("<section class=\"wide report-page\"><h2>Report of ", to);
  print_name(to, run);
  fputs("</h2>\n", to);
  if (name) {
    fprintf(to, "<p class=\"about\"><a href=\"runs/%d/file/", run->id);
    vg_markup_path(to, name);
    fprintf(to,
            "\" target=\"_blank\" rel=\"noopener\">Open in a tab of its own"
            "</a></p>\n<iframe title=\"Report of run %d\" src=\"runs/%d/file/",
            run->id, run->id);
    vg_markup_path(to, name);
    fputs("\"></iframe>\n", to);
  } else {
    fputs("<p class=\"note\">This run has no report.</p>\n", to);
  }
  fputs("</section>\n", to);
  free(name);
}

/* --- comparison ---------------------------------------------------------- */

/* The difference of a figure from that of the first run, in per cent. */
static void print_change(FILE *to, const struct vg_figure *f,
                         const json_t *first, const json_t *v)
{
  double a, b, change;
  int sign;

  if (!json_is_number(first) || !json_is_number(v)) return;
  a = json_number_value(first);
  b = json_number_value(v);
  if (!(fabs(a) > 0)) return;
  change = 100 * (b - a) / fabs(a);
  if (!(fabs(change) >= 0.05)) return;
  sign = (change > 0 ? 1 : -1) * f->is_better;
  fprintf(to, " <span class=\"change %s\">%+.1f %%</span>",
          sign > 0   ? "better"
          : sign < 0 ? "worse"
                     : "",
          change);
}

static void print_figures(FILE *to, const struct vg_compared *c)
{
  json_t *report[VG_COMPARED_MAX];

  for (size_t k = 0; k < c->n; k++) report[k] = vg_run_report(c->run[k]);
  for (size_t i = 0; i < vg_n_figure; i++) {
    const struct vg_figure *f = &vg_figure[i];
    const json_t *v[VG_COMPARED_MAX];
    int any = 0;

    for (size_t k = 0; k < c->n; k++) {
      v[k] = vg_figure_of(report[k], f->path);
      any |= v[k] && !json_is_null(v[k]);
    }
    if (!any) continue;
    fputs("<tr><th scope=\"row\">", to);
    vg_markup(to, f->name);
    fputs("</th>", to);
    for (size_t k = 0; k < c->n; k++) {
      fputs("<td>", to);
      vg_figure_print(to, f, v[k]);
      if (k) print_change(to, f, v[0], v[k]);
      fputs("</td>", to);
    }
    fputs("</tr>\n", to);
  }
  for (size_t k = 0; k < c->n; k++) json_decref(report[k]);
}

static void print_head(FILE *to, const struct vg_compared *c, const char *first)
{
  fprintf(
    to,
    "<div class=\"scroll\" tabindex=\"0\"><table class=\"compare\"><thead>"
    "<tr><th scope=\"col\">%s</th>",
    first);
  for (size_t k = 0; k < c->n; k++) {
    fputs("<th scope=\"col\">", to);
    print_name(to, c->run[k]);
    fputs("</th>", to);
  }
  fputs("</tr></thead>\n<tbody>\n", to);
}

static void print_value_row(FILE *to, const char *name,
                            char *const value[VG_COMPARED_MAX], size_t n)
{
  fputs("<tr><th scope=\"row\"><code>", to);
  vg_markup(to, name);
  fputs("</code></th>", to);
  for (size_t k = 0; k < n; k++) {
    fputs("<td>", to);
    vg_markup(to, value[k]);
    fputs("</td>", to);
  }
  fputs("</tr>\n", to);
}

static int differ(char *const value[VG_COMPARED_MAX], size_t n)
{
  for (size_t k = 1; k < n; k++)
    if (strcmp(value[0], value[k]) != 0) return 1;
  return 0;
}

/* Settings with different values; returns their number. */
static size_t print_settings(FILE *to, const struct vg_settings *s, size_t n)
{
  char text[VG_COMPARED_MAX][VALUE_SIZE], *value[VG_COMPARED_MAX];
  const char *name;
  size_t found = 0;
  int in_farfield;

  for (size_t k = 0; k < n; k++) value[k] = text[k];
  for (size_t i = 0; vg_settings_name(i, &name, &in_farfield); i++) {
    for (size_t k = 0; k < n; k++)
      if (vg_settings_get(&s[k], name, text[k], VALUE_SIZE, NULL) < 0)
        text[k][0] = 0;
    if (!differ(value, n)) continue;
    print_value_row(to, name, value, n);
    found++;
  }
  return found;
}

/* Tables with different rows; returns their number. */
static size_t print_tables(FILE *to, const struct vg_settings *s, size_t n)
{
  static const enum vg_table_kind kinds[] = {
    VG_TABLE_PATCHES, VG_TABLE_LAYERS,   VG_TABLE_SURFACE, VG_TABLE_WAKES,
    VG_TABLE_ZONES,   VG_TABLE_PERIODIC, VG_TABLE_SOURCES
  };
  size_t found = 0;

  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    char *text[VG_COMPARED_MAX] = { NULL };
    size_t size;

    for (size_t k = 0; k < n; k++) {
      FILE *one = vg_text_open(&text[k], &size);

      if (one) vg_rows_print(one, &s[k], kinds[i]);
      if (one) fclose(one);
      if (!text[k]) text[k] = strdup("");
    }
    if (differ(text, n)) {
      fprintf(to, "<tr><th scope=\"row\"><code>%s</code></th>",
              vg_settings_table(kinds[i])->name);
      /* The rows are printed with markup escaped. */
      for (size_t k = 0; k < n; k++)
        fprintf(to, "<td><pre>%s</pre></td>", text[k]);
      fputs("</tr>\n", to);
      found++;
    }
    for (size_t k = 0; k < n; k++) free(text[k]);
  }
  return found;
}

/* Read the deck of a run, which must not be a link out of its folder. */
static vg_status read_deck(const struct vg_serve_run *run,
                           struct vg_settings *s, struct vg_error *err)
{
  char *real = NULL;
  vg_status st;

  vg_settings_default(s);
  VG_TRY(vg_inside(run->dir, "run.deck", &real, err));
  st = vg_deck_read(real, s, err);
done:
  free(real);
  return st;
}

static void print_differences(FILE *to, const struct vg_compared *c)
{
  struct vg_settings s[VG_COMPARED_MAX];
  struct vg_error err = VG_ERROR_INIT;
  size_t found = 0;
  int ok = 1;

  memset(s, 0, sizeof s);
  for (size_t k = 0; k < c->n; k++)
    if (read_deck(c->run[k], &s[k], &err) < 0) ok = 0;
  print_head(to, c, "Setting");
  if (ok) found = print_settings(to, s, c->n) + print_tables(to, s, c->n);
  fputs("</tbody></table></div>\n", to);
  if (!ok) {
    fputs("<p class=\"note\">", to);
    vg_markup(to, err.text);
    fputs("</p>\n", to);
  } else if (!found) {
    fputs("<p class=\"about\">All settings are equal.</p>\n", to);
  }
  for (size_t k = 0; k < c->n; k++) vg_settings_release(&s[k]);
}

static void print_pictures(FILE *to, const struct vg_compared *c)
{
  static const char *const what[VG_PICTURES] = { "Surface", "Section" };

  for (int i = 0; i < VG_PICTURES; i++) {
    fputs("<div class=\"pair\">", to);
    for (size_t k = 0; k < c->n; k++)
      fprintf(to,
              "<figure><img src=\"runs/%d/picture/%d?t=%lld\" alt=\"%s of run "
              "%d\" width=\"864\" height=\"576\" loading=\"lazy\"><figcaption>"
              "%s, run %d</figcaption></figure>\n",
              c->run[k]->id, i, (long long)c->run[k]->ended, what[i],
              c->run[k]->id, what[i], c->run[k]->id);
    fputs("</div>\n", to);
  }
}

void vg_page_compare(const struct vg_compared *c, FILE *to)
{
  print_heading(to, "Comparison of runs");
  if (c->n < 2) {
    fputs("<p class=\"note\">Choose two to four finished runs in the list of "
          "runs.</p>\n</section>\n",
          to);
    return;
  }
  print_head(to, c, "Result");
  print_figures(to, c);
  fputs("</tbody></table></div>\n<h3>Different settings</h3>\n", to);
  print_differences(to, c);
  fputs("<h3>Pictures</h3>\n", to);
  print_pictures(to, c);
  fputs("</section>\n", to);
}

/* --- sweep --------------------------------------------------------------- */

static const struct vg_figure sweep_column[] = {
  { "ranks", "Ranks", "", -1, 0 },
  { "threads", "Threads", "", -1, 0 },
  { "leaf_cells", "Cells per subdomain", "", -1, 0 },
  { "leaves", "Subdomains", "", -1, 0 },
  { "seconds", "Time", "s", 2, -1 },
  { "speedup", "Speed-up", "", 2, 1 },
  { "efficiency", "Efficiency", "", 3, 1 },
  { "cells", "Cells", "", -1, 0 },
  { "angle_min", "Smallest angle", "degrees", 2, 1 },
  { "peak_memory_bytes", "Peak memory", "", -3, -1 },
};

static void print_cases(FILE *to, const json_t *table)
{
  const json_t *one;
  size_t i;

  fputs("<div class=\"scroll\" tabindex=\"0\"><table class=\"compare\"><thead>"
        "<tr><th scope=\"col\">Case</th><th scope=\"col\">State</th>",
        to);
  for (i = 0; i < sizeof sweep_column / sizeof *sweep_column; i++)
    fprintf(to, "<th scope=\"col\">%s</th>", sweep_column[i].name);
  fputs("</tr></thead>\n<tbody>\n", to);
  json_array_foreach(json_object_get(table, "cases"), i, one)
  {
    const char *name = json_string_value(json_object_get(one, "case"));
    const char *state = json_string_value(json_object_get(one, "state"));

    fputs("<tr><th scope=\"row\">", to);
    vg_markup(to, name ? name : "");
    fputs("</th><td>", to);
    vg_markup(to, state ? state : "");
    fputs("</td>", to);
    for (size_t c = 0; c < sizeof sweep_column / sizeof *sweep_column; c++) {
      fputs("<td>", to);
      vg_figure_print(to, &sweep_column[c],
                      json_object_get(one, sweep_column[c].path));
      fputs("</td>", to);
    }
    fputs("</tr>\n", to);
  }
  fputs("</tbody></table></div>\n", to);
}

static int is_svg(const struct dirent *e)
{
  size_t n = strlen(e->d_name);

  return *e->d_name != '.' && n > 4 && !strcmp(e->d_name + n - 4, ".svg");
}

/* Plots of all cases first, which have no '.' in their stem. */
static int plots_first(const struct dirent **a, const struct dirent **b)
{
  int x = strchr((*a)->d_name, '.') != strrchr((*a)->d_name, '.');
  int y = strchr((*b)->d_name, '.') != strrchr((*b)->d_name, '.');

  return x != y ? x - y : strcmp((*a)->d_name, (*b)->d_name);
}

static void print_plots(FILE *to, const struct vg_serve_run *run)
{
  struct dirent **list = NULL;
  char path[4096];
  int n = scandir(vg_run_path(run, "sweep", path), &list, is_svg, plots_first);

  fputs("<div class=\"pair plots\">", to);
  for (int i = 0; i < n; i++) {
    const char *name = list[i]->d_name;

    fprintf(to, "<figure><a href=\"runs/%d/file/sweep/", run->id);
    vg_markup_path(to, name);
    fprintf(to, "\"><img loading=\"lazy\" src=\"runs/%d/file/sweep/", run->id);
    vg_markup_path(to, name);
    fputs("\" alt=\"Plot ", to);
    vg_markup(to, name);
    fputs("\"></a><figcaption>", to);
    vg_markup_bytes(to, name, strlen(name) - 4);
    fputs("</figcaption></figure>\n", to);
    free(list[i]);
  }
  free(list);
  fputs("</div>\n", to);
}

void vg_page_sweep(const struct vg_serve_run *run, FILE *to)
{
  json_t *table = vg_run_report(run);
  const char *digests = json_string_value(json_object_get(table, "digests"));

  fputs("<section class=\"wide\"><h2>Sweep of ", to);
  print_name(to, run);
  fputs("</h2>\n", to);
  if (digests) {
    fputs("<p class=\"about\">Digests of equal meshes: ", to);
    vg_markup(to, digests);
    fputs("</p>\n", to);
  }
  if (table) print_cases(to, table);
  else fputs("<p class=\"note\">This sweep has no table yet.</p>\n", to);
  print_plots(to, run);
  fputs("</section>\n", to);
  json_decref(table);
}
