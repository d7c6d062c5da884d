/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Families with the laws of a workshop: their levels, the options of a level,
 * and the tables of requested and reached figures. Declared in
 * cli/sweep/sweep.h. */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/common/process.h"
#include "cli/sweep/sweep.h"
#include "io/stream/stream.h"
#include "run/common/json_build.h"

enum { LEVELS = 6 };

/* Edge lengths relative to the first level, y+ and growth of the layers;
 * sources of the figures: docs/reference/sweep.md. */
struct level {
  double scale, y_plus, growth;
};

static const struct named {
  const char *name;
  char first; /* name of the first level */
  struct level level[LEVELS];
  double edge[LEVELS]; /* spacing at leading and trailing edges, % of the local
                          chord; 0: that of the deck */
} named[VG_FAMILY_N] = { [VG_FAMILY_DPW] = { "dpw",
                                             '1',
                                             { { 1, 1, 1.16 },
                                               { 2. / 3, 2. / 3, 1.104 },
                                               { 0.5, 0.5, 1.068 },
                                               { 0.4, 0.4, 1.045 },
                                               { 1. / 3, 1. / 3, 1.03 },
                                               { 2. / 7, 2. / 7, 1.02 } },
                                             { 0 } },
                         [VG_FAMILY_HLPW] = {
                           "hlpw",
                           'A',
                           { { 1, 2.25, 1.25 },
                             { 2. / 3, 1.5, 1.16 },
                             { 4. / 9, 1, 1.10 },
                             { 1. / 3, 0.75, 1.07 },
                             { 2. / 9, 0.5, 1.05 },
                             { 4. / 27, 1. / 3, 1.03 } },
                           { 0.225, 0.15, 0.1, 0.075, 0.05, 0.033 } } };

/* --- levels -------------------------------------------------------------- */

static vg_status refuse(const char *what, const char *text,
                        const struct named *f, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: '%s' is no list of levels of the family %s; its levels "
                 "are %c to %c, as in %s:%c-%c or %s:%c,%c",
                 what, text, f->name, f->first, f->first + LEVELS - 1, f->name,
                 f->first, f->first + 2, f->name, f->first, f->first + 1);
}

/* Levels such as "A-F" or "1,3-5" as a list of numbers from 1. */
static vg_status take_levels(const char *what, const char *text,
                             const struct named *f, struct vg_range_list *out,
                             struct vg_error *err)
{
  char list[4 * LEVELS + 1] = "";
  const char *at = text;
  size_t n = 0;

  for (;;) {
    const int from = *at ? *at++ - f->first : -1;
    int to = from;

    if (*at == '-' && *++at) to = *at++ - f->first;
    if (from < 0 || to < from || to >= LEVELS || n == LEVELS) break;
    n++;
    snprintf(list + strlen(list), sizeof list - strlen(list), "%d:%d%s",
             from + 1, to + 1, *at == ',' ? "," : "");
    if (!*at) return vg_range_parse(what, list, 1, LEVELS, out, err);
    if (*at++ != ',') break;
  }
  return refuse(what, text, f, err);
}

vg_status vg_sweep_take_family(const char *what, const char *text,
                               struct vg_sweep_options *o, struct vg_error *err)
{
  const char *colon = strchr(text, ':');

  o->rule = VG_FAMILY_PLAIN;
  for (int k = VG_FAMILY_PLAIN + 1; k < VG_FAMILY_N; k++) {
    const struct named *f = &named[k];

    if (!colon || strlen(f->name) != (size_t)(colon - text) ||
        strncmp(text, f->name, (size_t)(colon - text)))
      continue;
    o->rule = (enum vg_family_rule)k;
    return take_levels(what, colon + 1, f, &o->family, err);
  }
  if (*text >= 'a' && *text <= 'z')
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: '%s' is no family; give levels such as 1:3, or dpw:1-6 "
                   "or hlpw:A-F with the laws of a workshop",
                   what, text);
  return vg_range_parse(what, text, 1, 100, &o->family, err);
}

vg_status vg_sweep_take_planned(const char *text, struct vg_sweep_options *o,
                                struct vg_error *err)
{
  vg_status st;

  if (o->rule == VG_FAMILY_PLAIN)
    return vg_fail(err, VG_ERR_INPUT,
                   "--planned needs a family with the laws of a workshop, as "
                   "in --family dpw:1-6 or hlpw:A-F");
  if (o->is_plane)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "--planned: %s is a plane section, which vanguard plan does "
                   "not accept; leave --planned out, so that all levels are "
                   "meshed",
                   o->project);
  st = take_levels("--planned", text, &named[o->rule], &o->planned, err);
  for (size_t i = 0; i < o->planned.n && st >= 0; i++)
    if (!vg_sweep_is_in(&o->family, o->planned.v[i]))
      st = vg_fail(err, VG_ERR_INPUT,
                   "--planned: level %c is not in --family; add it there",
                   named[o->rule].first + (int)o->planned.v[i] - 1);
  return st;
}

int vg_sweep_is_in(const struct vg_range_list *list, int64_t v)
{
  for (size_t i = 0; i < list->n; i++)
    if (list->v[i] == v) return 1;
  return 0;
}

static const struct level *level_of(const struct vg_sweep_options *o,
                                    int64_t level)
{
  return &named[o->rule].level[level - 1];
}

double vg_sweep_scale(const struct vg_sweep_options *o, int64_t level)
{
  return o->rule == VG_FAMILY_PLAIN ? 2 / ((double)level + 1)
                                    : level_of(o, level)->scale;
}

void vg_sweep_level_name(const struct vg_sweep_options *o, int64_t level,
                         char name[24])
{
  const struct named *f = &named[o->rule];

  if (o->rule == VG_FAMILY_PLAIN) snprintf(name, 24, "f%lld", (long long)level);
  else snprintf(name, 24, "%s%c", f->name, f->first + (int)level - 1);
}

vg_status vg_sweep_check_named(const struct vg_sweep_options *o,
                               struct vg_error *err)
{
  if (o->rule == VG_FAMILY_PLAIN || (o->reynolds > 0 && o->length > 0))
    return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "the family %s sets y+ and a farfield of %d chords, which "
                 "need reynolds and reference_length; give both in the deck",
                 named[o->rule].name, VG_FAMILY_FARFIELD);
}

static vg_status add_real(struct vg_words *w, const char *option, double v,
                          struct vg_error *err)
{
  char text[40];
  vg_status st = vg_words_add(w, option, err);

  snprintf(text, sizeof text, "%.17g", v);
  return st < 0 ? st : vg_words_add(w, text, err);
}

vg_status vg_sweep_add_named(struct vg_words *w,
                             const struct vg_sweep_options *o, int64_t level,
                             struct vg_error *err)
{
  const struct level *l = level_of(o, level);
  vg_status st;

  VG_TRY(add_real(w, "--scale", o->scale * l->scale, err));
  VG_TRY(vg_words_add(w, "--scale-layers", err));
  VG_TRY(vg_words_add(w, "no", err));
  VG_TRY(add_real(w, "--y-plus", l->y_plus, err));
  VG_TRY(add_real(w, "--ratio", l->growth, err));
  if (o->sets_farfield)
    VG_TRY(add_real(w, "--farfield-size", VG_FAMILY_FARFIELD * o->length, err));
  VG_TRY(vg_words_add(w, "--write", err));
  st = vg_words_add(w, "b8.ugrid,mapbc,cgns", err);
done:
  return st;
}

/* --- figures ------------------------------------------------------------- */

static const char *const figure_names[VG_FIGURE_N] = { "nodes",
                                                       "cells",
                                                       "tetrahedra",
                                                       "pyramids",
                                                       "prisms",
                                                       "hexahedra",
                                                       "boundary_nodes",
                                                       "boundary_triangles",
                                                       "boundary_quads",
                                                       "layer_cells",
                                                       "first_height",
                                                       "y_plus",
                                                       "growth_max",
                                                       "percent_full_layers",
                                                       "farfield_chords",
                                                       "lead_requested",
                                                       "lead",
                                                       "trail_requested",
                                                       "trail",
                                                       "root_requested",
                                                       "root",
                                                       "tip_requested",
                                                       "tip" };

/* Half of the largest extent of the boundary, in reference lengths. */
static double farfield(const json_t *report, double length)
{
  const json_t *box = json_object_get(report, "input");
  double most = NAN;

  for (size_t k = 0; k < 3; k++) {
    const json_t *lo = json_array_get(json_object_get(box, "lower"), k);
    const json_t *hi = json_array_get(json_object_get(box, "upper"), k);

    if (json_is_number(lo) && json_is_number(hi))
      most = fmax(most, json_number_value(hi) - json_number_value(lo));
  }
  return 0.5 * most / length;
}

void vg_sweep_figures(const json_t *report, const struct vg_sweep_options *o,
                      struct vg_sweep_case *c)
{
  static const char *const size[] = { "points",
                                      "cells",
                                      "tetrahedra",
                                      "pyramids",
                                      "prisms",
                                      "hexahedra",
                                      "boundary_points",
                                      "boundary_triangles",
                                      "boundary_quadrilaterals" };
  static const char *const kind[] = { "tetrahedra", "pyramids", "prisms",
                                      "hexahedra" };
  static const char *const place[] = { "leading_edges", "trailing_edges",
                                       "roots", "tips" };
  const json_t *layers = json_object_get(report, "layers");
  double *f = c->figure;

  for (int k = 0; k <= VG_FIGURE_BOUNDARY_QUADS; k++)
    f[k] = vg_json_number(report, "size", size[k]);
  f[VG_FIGURE_LAYER_CELLS] = 0;
  for (int k = 0; k < 4; k++)
    f[VG_FIGURE_LAYER_CELLS] += vg_json_number(layers, kind[k]);
  if (o->is_plane)
    f[VG_FIGURE_LAYER_CELLS] = vg_json_number(report, "plane",
                                              "quadrilaterals") +
                               vg_json_number(report, "plane",
                                              "layer_triangles");
  f[VG_FIGURE_FIRST] = vg_json_number(layers, "all", "first", "mean");
  f[VG_FIGURE_Y_PLUS] = vg_json_number(layers, "all", "y_plus", "mean");
  f[VG_FIGURE_GROWTH] = vg_json_number(layers, "all", "growth", "max");
  f[VG_FIGURE_FULL] = vg_json_number(layers, "all", "percent_full");
  f[VG_FIGURE_FARFIELD] = farfield(report, o->length);
  for (int k = 0; k < 4; k++) {
    f[VG_FIGURE_LEAD_ASKED + 2 * k] = vg_json_number(report, "remesh", place[k],
                                                     "requested_percent");
    f[VG_FIGURE_LEAD + 2 * k] = vg_json_number(report, "remesh", place[k],
                                               "reached_percent");
  }
}

void vg_sweep_estimates(const json_t *plan, struct vg_sweep_case *c)
{
  double *f = c->figure;

  f[VG_FIGURE_NODES] = vg_json_number(plan, "mesh", "points");
  f[VG_FIGURE_CELLS] = vg_json_number(plan, "mesh", "cells");
  f[VG_FIGURE_TETRAHEDRA] = vg_json_number(plan, "mesh", "tetrahedra");
  f[VG_FIGURE_PRISMS] = vg_json_number(plan, "mesh", "prisms");
  f[VG_FIGURE_LAYER_CELLS] = f[VG_FIGURE_CELLS] -
                             vg_json_number(plan, "mesh", "field_cells");
}

/* --- tables -------------------------------------------------------------- */

/* Rows of the table of requested and reached figures. */
enum {
  ROW_Y_PLUS,
  ROW_GROWTH,
  ROW_LEAD,
  ROW_TRAIL,
  ROW_ROOT,
  ROW_TIP,
  ROW_FARFIELD,
  ROW_FULL,
  ROW_RATIO,
  ROW_N
};
static const char *const row_names[ROW_N] = {
  "y+ of the first layer",
  "growth ratio of the layers",
  "leading edges (% of the chord)",
  "trailing edges (% of the chord)",
  "root (% of the semispan)",
  "tip (% of the semispan)",
  "farfield (reference lengths)",
  "full layers (% of wall faces)",
  "cells / those of the level before"
};

/* Ratio of the number of cells to that of the level before that the laws of
 * both levels request. Cells outside the layers follow the cube of the edge
 * lengths. Cells in the layers follow their square and the number of layers:
 * first heights and edge lengths have the same ratio, so that the number of
 * layers from one to the other is inversely proportional to the logarithm of
 * the growth. */
static double cells_ratio(const struct vg_sweep *s, size_t i)
{
  const struct vg_sweep_case *p = vg_sweep_before(s, i);
  const struct level *to = level_of(s->o, s->item[i].family), *from;
  double finer, more, share;

  if (!p) return NAN;
  from = level_of(s->o, p->family);
  finer = from->scale / to->scale;
  more = s->o->layer_count ? 1 : log(from->growth) / log(to->growth);
  share = p->figure[VG_FIGURE_LAYER_CELLS] / p->figure[VG_FIGURE_CELLS];
  if (!isfinite(share)) share = 0; /* no layers */
  return finer * (s->o->is_plane ? 1 : finer) *
         (share * more + (1 - share) * finer);
}

/* Spacing that the workshop requests, or else the deck. */
static double edge_spacing(const struct vg_sweep *s, size_t i, int asked)
{
  const double law = named[s->o->rule].edge[s->item[i].family - 1];

  return law > 0 ? law : s->item[i].figure[asked];
}

static double requested(const struct vg_sweep *s, size_t i, int row)
{
  const struct level *l = level_of(s->o, s->item[i].family);

  switch (row) {
  case ROW_Y_PLUS: return l->y_plus;
  case ROW_GROWTH: return l->growth;
  case ROW_LEAD: return edge_spacing(s, i, VG_FIGURE_LEAD_ASKED);
  case ROW_TRAIL: return edge_spacing(s, i, VG_FIGURE_TRAIL_ASKED);
  case ROW_ROOT: return s->item[i].figure[VG_FIGURE_ROOT_ASKED];
  case ROW_TIP: return s->item[i].figure[VG_FIGURE_TIP_ASKED];
  case ROW_FARFIELD: return VG_FAMILY_FARFIELD;
  case ROW_FULL: return 100;
  default: return cells_ratio(s, i);
  }
}

static double reached(const struct vg_sweep *s, size_t i, int row)
{
  static const int figure[ROW_N] = {
    VG_FIGURE_Y_PLUS,   VG_FIGURE_GROWTH, VG_FIGURE_LEAD,
    VG_FIGURE_TRAIL,    VG_FIGURE_ROOT,   VG_FIGURE_TIP,
    VG_FIGURE_FARFIELD, VG_FIGURE_FULL,   -1
  };
  const struct vg_sweep_case *c = &s->item[i], *p = vg_sweep_before(s, i);

  if (figure[row] >= 0) return c->figure[figure[row]];
  return p ? c->figure[VG_FIGURE_CELLS] / p->figure[VG_FIGURE_CELLS] : NAN;
}

static void print(FILE *to, double v)
{
  if (isfinite(v)) fprintf(to, " %10.5g", v);
  else fprintf(to, " %10s", "-");
}

void vg_sweep_named_text(FILE *to, const struct vg_sweep *s)
{
  if (s->o->rule == VG_FAMILY_PLAIN) return;
  fprintf(to, "\n%-34s %-9s", "requirement", "");
  for (size_t i = 0; i < s->n; i++) {
    char name[24];

    vg_sweep_level_name(s->o, s->item[i].family, name);
    fprintf(to, " %9s%c", name, s->item[i].is_planned ? '*' : ' ');
  }
  fprintf(to, "\n");
  for (int row = 0; row < ROW_N; row++)
    for (int k = 0; k < 2; k++) {
      fprintf(to, "%-34s %-9s", k ? "" : row_names[row],
              k ? "reached" : "requested");
      for (size_t i = 0; i < s->n; i++)
        print(to, k ? reached(s, i, row) : requested(s, i, row));
      fprintf(to, "\n");
    }
  for (int k = 0; k < VG_FIGURE_N; k++) {
    fprintf(to, "%-34s %-9s", figure_names[k], "");
    for (size_t i = 0; i < s->n; i++) print(to, s->item[i].figure[k]);
    fprintf(to, "\n");
  }
  if (s->o->planned.n)
    fprintf(to, "* planned, not meshed: numbers of cells and nodes are "
                "estimates\n");
}

static void put_real(struct vg_output *out, double v)
{
  vg_output_text(out, ",");
  if (isfinite(v)) vg_output_real(out, v);
}

static vg_status put_csv(struct vg_output *out, const struct vg_sweep *s,
                         struct vg_error *err)
{
  (void)err;
  vg_output_text(out, "level,state,scale,y_plus_requested,growth_requested,"
                      "cells_ratio_requested,cells_ratio");
  for (int k = 0; k < VG_FIGURE_N; k++)
    vg_output_format(out, ",%s", figure_names[k]);
  vg_output_text(out, "\n");
  for (size_t i = 0; i < s->n; i++) {
    const struct vg_sweep_case *c = &s->item[i];
    char name[24];

    vg_sweep_level_name(s->o, c->family, name);
    vg_output_format(out, "%s,%s", name,
                     !c->is_done     ? "failed"
                     : c->is_planned ? "planned"
                                     : "meshed");
    put_real(out, vg_sweep_scale(s->o, c->family));
    put_real(out, requested(s, i, ROW_Y_PLUS));
    put_real(out, requested(s, i, ROW_GROWTH));
    put_real(out, requested(s, i, ROW_RATIO));
    put_real(out, reached(s, i, ROW_RATIO));
    for (int k = 0; k < VG_FIGURE_N; k++) put_real(out, c->figure[k]);
    vg_output_text(out, "\n");
  }
  return VG_OK;
}

static vg_status put_page(struct vg_output *out, const struct vg_sweep *s,
                          struct vg_error *err)
{
  char *text = NULL;
  size_t size;
  FILE *to = vg_text_open(&text, &size);

  if (!to) return vg_fail_memory(err, "the page of a family");
  vg_sweep_named_text(to, s);
  if (fclose(to)) return vg_fail_memory(err, "the page of a family");
  vg_output_text(out, "<!DOCTYPE html>\n<html lang=\"en\"><head><meta "
                      "charset=\"utf-8\"><title>Grid metrics</title></head>\n"
                      "<body><h1>Grid metrics of the family ");
  vg_output_text(out, named[s->o->rule].name);
  vg_output_text(out, "</h1>\n<pre>");
  vg_output_markup(out, text);
  vg_output_text(out, "</pre></body></html>\n");
  free(text);
  return VG_OK;
}

static vg_status write_one(const struct vg_sweep *s, const char *name,
                           vg_status (*put)(struct vg_output *,
                                            const struct vg_sweep *,
                                            struct vg_error *),
                           struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *path = NULL;
  vg_status st;

  if (asprintf(&path, "%s/%s", s->o->dir, name) < 0)
    return vg_fail_memory(err, "a path");
  VG_TRY(vg_output_open(path, &out, err));
  VG_TRY(put(&out, s, err));
  VG_TRY(vg_output_commit(&out, err));
done:
  vg_output_release(&out);
  free(path);
  return st;
}

vg_status vg_sweep_named_write(const struct vg_sweep *s, struct vg_error *err)
{
  vg_status st;

  if (s->o->rule == VG_FAMILY_PLAIN) return VG_OK;
  st = write_one(s, "metrics.csv", put_csv, err);
  return st < 0 ? st : write_one(s, "metrics.html", put_page, err);
}
