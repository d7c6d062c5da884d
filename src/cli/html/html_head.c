/* The top of the page: what the run was, and what one has to know first. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/version.h"
#include "cli/html/assets.h"
#include "cli/html/page.h"

/* Nothing is loaded from anywhere, and the browser is told so. */
static const char policy[] =
  "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
  "img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline' "
  "'unsafe-eval'\">\n";

void vg_html_head(struct page *p)
{
  const struct vg_problem *q = p->h->problem;

  vg_page_markup(p, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
    "<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
    "content=\"width=device-width, initial-scale=1\">\n"
    "<meta name=\"color-scheme\" content=\"light dark\">\n");
  vg_page_markup(p, policy);
  vg_page_markup(p, "<meta name=\"generator\" content=\"Vanguard " VG_VERSION
                    "\">\n<title>");
  vg_page_text(p, q->settings.title);
  vg_page_markup(p, "</title>\n<style>\n");
  vg_output_bytes(&p->out, vg_asset_report_css, vg_asset_report_css_size);
  vg_page_markup(p, "</style>\n</head>\n<body>\n<header>\n"
                    "<p class=\"over\">Vanguard mesh report</p>\n<h1>");
  vg_page_text(p, q->settings.title);
  vg_page_markup(p, "</h1>\n<p class=\"badges\">");
  vg_page_markup(p, json_is_true(vg_page_json(p, "mesh.valid"))
    ? "<span class=\"badge good\">valid mesh</span>"
    : "<span class=\"badge bad\">not valid</span>");
  if (p->h->layers->n_missed)
    vg_page_format(p, " <span class=\"badge bad\">%zu limit%s on the layers "
                   "not met</span>", p->h->layers->n_missed,
                   p->h->layers->n_missed > 1 ? "s" : "");
  vg_page_markup(p, "</p>\n</header>\n<main>\n\n");
}

/* --- what to know first -------------------------------------------------- */

enum weight { WEIGHT_NOTE, WEIGHT_WARN, WEIGHT_BAD };

static void begin(struct page *p, enum weight weight)
{
  static const char *const name[] = { "note", "warn", "bad" };
  static const char *const word[] = { "Note", "Changed", "Missed" };

  vg_page_format(p, "<li class=\"%s\"><b>%s</b> <span>", name[weight],
                 word[weight]);
}

static void end(struct page *p)
{
  vg_page_markup(p, "</span></li>\n");
}

static int count_line(struct page *p, enum weight weight, uint64_t n,
                      const char *one, const char *many)
{
  if (!n) return 0;
  begin(p, weight);
  vg_page_count(p, n);
  vg_page_format(p, " %s", n == 1 ? one : many);
  end(p);
  return 1;
}

static int missed(struct page *p)
{
  const struct vg_layer_stage *s = p->h->layers;

  for (size_t i = 0; i < s->n_missed; i++) {
    const struct vg_limit_missed *m = &s->missed[i];
    const struct vg_patch *patch = &p->h->problem->surface.patch[m->patch];

    begin(p, WEIGHT_BAD);
    vg_page_format(p, "patch %d ", (int)patch->id);
    vg_page_text(p, patch->name);
    vg_page_format(p, ": %s is ", m->name);
    vg_page_real(p, m->wanted, 10);
    vg_page_format(p, "%s, reached ", m->unit);
    vg_page_real(p, m->got, 10);
    vg_page_markup(p, m->unit);
    end(p);
  }
  return s->n_missed > 0;
}

/* Walls that lack layers, the worst one named. */
static int layers_short(struct page *p)
{
  const struct vg_layer_stage *s = p->h->layers;
  const struct vg_patch_layers *worst = NULL;

  if (!p->has_layers || s->all.full >= 100) return 0;
  for (size_t i = 0; i < s->n_wall; i++)
    if (!worst || s->wall[i].full < worst->full) worst = &s->wall[i];
  begin(p, WEIGHT_BAD);
  vg_page_fixed(p, 100 - s->all.full, 2);
  vg_page_markup(p, " % of the walls' faces have fewer layers than law and "
                    "local size ask for");
  if (worst && s->n_wall > 1) {
    const struct vg_patch *patch = &p->h->problem->surface.patch[worst->patch];

    vg_page_format(p, ", most on patch %d ", (int)patch->id);
    vg_page_text(p, patch->name);
    vg_page_markup(p, " (");
    vg_page_fixed(p, 100 - worst->full, 2);
    vg_page_markup(p, " %)");
  }
  vg_page_markup(p, "; <a href=\"#layers\">causes are below</a>");
  end(p);
  return 1;
}

static int surface_changed(struct page *p)
{
  const struct vg_problem *q = p->h->problem;
  uint64_t swept = (uint64_t)vg_page_number(p, "surface.removed_triangles");
  int n = 0;

  n += count_line(p, WEIGHT_WARN, q->n_dropped, "triangle of the input was "
                  "dropped by the weld", "triangles of the input were dropped "
                  "by the weld");
  n += count_line(p, WEIGHT_WARN, swept, "triangle was removed by the repair",
                  "triangles were removed by the repair");
  n += count_line(p, WEIGHT_WARN,
                  (uint64_t)vg_page_number(p, "surface.flipped"),
                  "triangle was turned over",
                  "triangles were turned over");
  n += count_line(p, WEIGHT_NOTE, q->n_welded,
                  "point was merged with another",
                  "points were merged with others");
  if (q->domain.added_symmetry || q->domain.added_farfield) {
    begin(p, WEIGHT_NOTE);
    vg_page_markup(p, "to the body were added: ");
    if (q->domain.added_symmetry) {
      vg_page_format(p, "a symmetry plane at %c = ",
                     "xyz"[q->domain.symmetry_axis]);
      vg_page_real(p, q->domain.symmetry_at, 6);
      if (q->domain.added_farfield) vg_page_markup(p, " and ");
    }
    if (q->domain.added_farfield) vg_page_markup(p, "a farfield");
    vg_page_format(p, ", of %zu triangles", q->domain.n_added_tri);
    end(p);
    n++;
  }
  return n;
}

static int mesh_lines(struct page *p)
{
  const struct vg_mesh_report *r = p->has_layers ? &p->h->run->field_judge
                                                 : &p->h->run->judge;
  int n = 0;

  if (r->below[0] > 0) {
    begin(p, WEIGHT_WARN);
    vg_page_fixed(p, r->below[0], 4);
    vg_page_format(p, " %% of the %s have an angle below 5 degrees; <a "
                   "href=\"#worst\">the worst are shown</a>",
                   p->has_layers ? "field's cells" : "cells");
    end(p);
    n++;
  }
  n += count_line(p, WEIGHT_NOTE,
                  (uint64_t)vg_page_number(p, "partition.parts_widened"),
                  "part of the field could not be filled, and was filled "
                  "together with what is beside it", "parts of the field "
                  "could not be filled, and were filled together with what "
                  "is beside them");
  n += count_line(p, WEIGHT_NOTE,
                  (uint64_t)vg_page_number(p, "fill.steiner_points"),
                  "point was added to recover the boundary",
                  "points were added to recover the boundary");
  return n;
}

void vg_html_first(struct page *p)
{
  const struct vg_notes *notes = &p->h->problem->notes;
  int n = 0;

  vg_page_section(p, "first", "To know first");
  vg_page_markup(p, "<ul class=\"first\">\n");
  n += missed(p);
  n += layers_short(p);
  n += surface_changed(p);
  n += mesh_lines(p);
  for (size_t i = 0; i < notes->n; i++) {
    begin(p, WEIGHT_NOTE);
    vg_page_text(p, notes->text[i]);
    end(p);
    n++;
  }
  if (!n)
    vg_page_markup(p, "<li class=\"good\"><b>All</b> <span>as asked: nothing "
                      "was missed, dropped, closed or assumed.</span></li>\n");
  vg_page_markup(p, "</ul>\n");
  vg_page_end_section(p);
}

/* --- the figures that everybody asks for --------------------------------- */

static void tile_begin(struct page *p)
{
  vg_page_markup(p, "<div><b>");
}

static void tile_end(struct page *p, const char *name)
{
  vg_page_format(p, "</b><span>%s</span></div>\n", name);
}

static void tile(struct page *p, uint64_t n, const char *name)
{
  if (!n) return;
  tile_begin(p);
  vg_page_count(p, n);
  tile_end(p, name);
}

void vg_html_tiles(struct page *p)
{
  const struct vg_slices *m = &p->h->run->slices;
  const struct vg_mesh_report *r = p->has_layers ? &p->h->run->field_judge
                                                 : &p->h->run->judge;

  vg_page_markup(p, "<div class=\"tiles\">\n");
  tile(p, vg_run_cells(p->h->run),
       m->n_cell[VG_SLICE_TET] < vg_run_cells(p->h->run) ? "cells"
                                                         : "tetrahedra");
  tile(p, m->n_point, "points");
  if (m->n_cell[VG_SLICE_TET] < vg_run_cells(p->h->run))
    tile(p, m->n_cell[VG_SLICE_TET], "tetrahedra");
  tile(p, m->n_cell[VG_SLICE_PRI], "prisms");
  tile(p, m->n_cell[VG_SLICE_PYR], "pyramids");
  if (p->has_layers) {
    tile_begin(p);
    vg_page_fixed(p, p->h->layers->all.full, 2);
    vg_page_markup(p, " %");
    tile_end(p, "wall faces with all layers");
    tile_begin(p);
    vg_page_real(p, p->h->layers->all.first.mean, 4);
    tile_end(p, "first height, mean");
  }
  tile_begin(p);
  vg_page_fixed(p, r->angle_min, 1);
  vg_page_markup(p, "&deg;");
  tile_end(p, p->has_layers ? "smallest angle of the field"
                            : "smallest angle");
  tile_begin(p);
  vg_page_fixed(p, r->radius_ratio_mean, 3);
  tile_end(p, "radius ratio, mean");
  vg_page_markup(p, "</div>\n\n");
}
