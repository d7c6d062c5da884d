/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The top of the page: title, flow domain, summary and key figures. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/version.h"
#include "cli/html/assets.h"
#include "cli/html/page.h"

/* The page loads nothing, and the policy makes the browser enforce it. */
static const char policy[] =
  "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
  "img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\">"
  "\n";

/* The flow domain and its evidence. */
static void flow(struct page *p)
{
  const struct vg_boundary *q = &p->h->problem->boundary;
  char statement[VG_FLOW_TEXT];

  vg_flow_statement(&q->flow, q->domain.added_farfield, statement);
  vg_page_markup(p, "<p><b>");
  vg_page_text(p, statement);
  vg_page_markup(p, ".</b> Evidence: ");
  for (int i = 0; i < q->flow.n_evidence; i++) {
    if (i) vg_page_markup(p, "; ");
    vg_page_text(p, q->flow.evidence[i]);
  }
  vg_page_markup(p, ".</p>\n");
}

void vg_html_head(struct page *p)
{
  const struct vg_problem *q = p->h->problem;
  size_t n;

  vg_page_markup(p, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
                    "<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
                    "content=\"width=device-width, initial-scale=1\">\n"
                    "<meta name=\"color-scheme\" content=\"light dark\">\n");
  vg_page_markup(p, policy);
  vg_page_markup(p, "<meta name=\"generator\" content=\"Vanguard " VG_VERSION
                    "\">\n<title>");
  vg_page_text(p, q->asked.title);
  vg_page_markup(p, "</title>\n<style>\n");
  vg_output_bytes(&p->out, vg_asset_report_css, vg_asset_report_css_size);
  vg_page_markup(p, "</style>\n</head>\n<body>\n<header>\n"
                    "<p class=\"over\">Vanguard mesh report</p>\n<h1>");
  vg_page_text(p, q->asked.title);
  vg_page_markup(p, "</h1>\n<p class=\"badges\">");
  vg_page_markup(p, json_is_true(vg_page_json(p, "mesh.valid"))
                      ? "<span class=\"badge good\">valid mesh</span>"
                      : "<span class=\"badge bad\">not valid</span>");
  if (p->h->layers->n_missed)
    vg_page_format(p,
                   " <span class=\"badge bad\">%zu limit%s on the layers "
                   "not met</span>",
                   p->h->layers->n_missed,
                   p->h->layers->n_missed > 1 ? "s" : "");
  n = json_array_size(vg_page_json(p, "limits_missed"));
  if (n)
    vg_page_format(p,
                   " <span class=\"badge bad\">%zu limit%s on the mesh "
                   "not met</span>",
                   n, n > 1 ? "s" : "");
  vg_page_markup(p, "</p>\n");
  flow(p);
  vg_page_markup(p, "</header>\n<main>\n\n");
}

/* --- summary ------------------------------------------------------------- */

/* The list is sorted by weight: the functions below are called once for each
 * weight, and begin() rejects the lines of other weights. */
enum weight { WEIGHT_BAD, WEIGHT_LOOK, WEIGHT_CHANGED, WEIGHT_NOTE, WEIGHTS };

struct list {
  struct page *p;
  enum weight now;
  int n;
};

static int begin(struct list *l, enum weight weight)
{
  static const char *const name[] = { "bad", "warn", "warn", "note" };
  static const char *const word[] = { "Not met", "Check", "Changed", "Note" };

  if (weight != l->now) return 0;
  l->n++;
  vg_page_format(l->p, "<li class=\"%s\"><b>%s</b> <span>", name[weight],
                 word[weight]);
  return 1;
}

static void end(struct list *l)
{
  vg_page_markup(l->p, "</span></li>\n");
}

static void count_line(struct list *l, enum weight weight, uint64_t n,
                       const char *one, const char *many)
{
  if (!n || !begin(l, weight)) return;
  vg_page_count(l->p, n);
  vg_page_format(l->p, " %s", n == 1 ? one : many);
  end(l);
}

/* `word` is "Patch" or "patch". */
static void patch_words(struct page *p, const char *word, uint32_t patch)
{
  const struct vg_patch *of = &p->h->problem->boundary.surface.patch[patch];

  vg_page_format(p, "%s %d ", word, (int)of->id);
  vg_page_text(p, of->name);
}

static void missed(struct list *l)
{
  const struct vg_layer_stage *s = l->p->h->layers;

  for (size_t i = 0; i < s->n_missed; i++) {
    const struct vg_limit_missed *m = &s->missed[i];

    if (!begin(l, WEIGHT_BAD)) return;
    patch_words(l->p, "Patch", m->patch);
    if (isnan(m->wanted)) vg_page_markup(l->p, ": layers are requested");
    else {
      vg_page_format(l->p, ": %s is ", m->name);
      vg_page_real(l->p, m->wanted, 10);
      vg_page_markup(l->p, m->unit);
    }
    vg_page_markup(l->p, m->is_bare ? ", but it has no layers" : ", reached ");
    if (!m->is_bare) {
      vg_page_real(l->p, m->got, 10);
      vg_page_markup(l->p, m->unit);
    }
    end(l);
  }
}

static void mesh_missed(struct list *l)
{
  const json_t *all = vg_page_json(l->p, "limits_missed");

  for (size_t i = 0; i < json_array_size(all); i++) {
    const json_t *m = json_array_get(all, i);

    if (!begin(l, WEIGHT_BAD)) return;
    vg_page_format(l->p, "Mesh: %s is ",
                   json_string_value(json_object_get(m, "limit")));
    vg_page_real(l->p, json_number_value(json_object_get(m, "required")), 10);
    vg_page_markup(l->p, ", reached ");
    vg_page_real(l->p, json_number_value(json_object_get(m, "got")), 10);
    end(l);
  }
}

/* Walls with fewer or lower layers than requested, and the worst one. */
static void layers_short(struct list *l)
{
  const struct vg_layer_stage *s = l->p->h->layers;
  const struct vg_patch_layers *fewest = &s->all, *lowest = &s->all;
  struct page *p = l->p;

  if (!p->has_layers) return;
  for (size_t i = 0; i < s->n_wall; i++) {
    if (s->wall[i].full < fewest->full) fewest = &s->wall[i];
    if (s->wall[i].share_mean < lowest->share_mean) lowest = &s->wall[i];
  }
  if (s->all.full < 100 && begin(l, WEIGHT_BAD)) {
    vg_page_fixed(p, 100 - s->all.full, 2);
    vg_page_markup(p, " % of the wall faces have fewer layers than the "
                      "growth law and the local edge length require");
    if (fewest->patch != VG_NO_INDEX) {
      vg_page_markup(p, "; the largest percentage is on ");
      patch_words(p, "patch", fewest->patch);
    }
    vg_page_markup(p, " (<a href=\"#layers\">see causes</a>).");
    end(l);
  }
  if (s->all.share_area < 100 && begin(l, WEIGHT_LOOK)) {
    vg_page_markup(p, "On ");
    vg_page_fixed(p, 100 - s->all.share_area, 2);
    vg_page_markup(p, " % of the wall area the layers are lower than 0.9 of "
                      "the growth-law height. The mean height is ");
    vg_page_fixed(p, s->all.share_mean, 3);
    vg_page_markup(p, " of it");
    if (lowest->patch != VG_NO_INDEX) {
      vg_page_markup(p, "; the lowest mean is ");
      vg_page_fixed(p, lowest->share_mean, 3);
      vg_page_markup(p, " on ");
      patch_words(p, "patch", lowest->patch);
    }
    vg_page_markup(p, " (<a href=\"#layers\">see causes</a>).");
    end(l);
  }
}

static void added(struct list *l)
{
  const struct vg_domain_report *d = &l->p->h->problem->boundary.domain;

  if (!d->added_symmetry && !d->added_farfield) return;
  if (!begin(l, WEIGHT_CHANGED)) return;
  vg_page_markup(l->p, "The domain was completed with ");
  if (d->added_symmetry) {
    vg_page_format(l->p, "a symmetry plane at %c = ", "xyz"[d->symmetry_axis]);
    vg_page_real(l->p, d->symmetry_at, 6);
    if (d->added_farfield) vg_page_markup(l->p, " and ");
  }
  if (d->added_farfield) vg_page_markup(l->p, "a farfield");
  vg_page_format(l->p, " (%zu triangles).", d->n_added_tri);
  end(l);
}

static void surface_changed(struct list *l)
{
  const struct vg_boundary *q = &l->p->h->problem->boundary;
  uint64_t removed = (uint64_t)vg_page_number(l->p,
                                              "surface.removed_triangles");
  uint64_t flipped = (uint64_t)vg_page_number(l->p, "surface.flipped");
  int all = flipped >= q->surface.n_tri;

  count_line(l, WEIGHT_CHANGED, q->n_dropped,
             "triangle of the input collapsed when points were merged, and was "
             "removed.",
             "triangles of the input collapsed when points were merged, and "
             "were removed.");
  count_line(l, WEIGHT_CHANGED, removed,
             "duplicate or degenerate triangle was removed.",
             "duplicate or degenerate triangles were removed.");
  count_line(l, all ? WEIGHT_NOTE : WEIGHT_CHANGED, flipped,
             "triangle was reversed for a consistent orientation.",
             all
               ? "triangles were reversed: the whole surface, so that normals "
                 "point into the fluid."
               : "triangles were reversed for a consistent orientation.");
  count_line(l, WEIGHT_NOTE, q->n_welded, "point was merged with another one.",
             "points were merged with others.");
  added(l);
}

static void mesh_lines(struct list *l)
{
  struct page *p = l->p;
  const struct vg_mesh_report *r = p->has_layers ? &p->h->run->field_judge
                                                 : &p->h->run->judge;

  if (r->below[0] > 0 && begin(l, WEIGHT_LOOK)) {
    vg_page_real(p, r->below[0], 3);
    vg_page_format(p,
                   " %% of the %s have a dihedral angle below 5 degrees; the "
                   "smallest is ",
                   p->has_layers ? "cells outside the layers" : "cells");
    vg_page_real(p, r->angle_min, 3);
    vg_page_markup(p, "&deg; (<a href=\"#worst\">see the worst cells</a>).");
    end(l);
  }
  count_line(l, WEIGHT_NOTE,
             (uint64_t)vg_page_number(p, "partition.subdomains_extended"),
             "subdomain could not be filled and was filled together with its "
             "neighbours.",
             "subdomains could not be filled and were filled together with "
             "their neighbours.");
  count_line(l, WEIGHT_NOTE, (uint64_t)vg_page_number(p, "fill.steiner_points"),
             "interior point was added by boundary recovery.",
             "interior points were added by boundary recovery.");
}

void vg_html_first(struct page *p)
{
  const struct vg_notes *notes = &p->h->problem->notes;
  struct list l = { .p = p };

  vg_page_section(p, "first", "Summary");
  vg_page_markup(p, "<ul class=\"first\">\n");
  for (l.now = WEIGHT_BAD; l.now < WEIGHTS; l.now++) {
    missed(&l);
    mesh_missed(&l);
    layers_short(&l);
    surface_changed(&l);
    mesh_lines(&l);
    for (size_t i = 0; i < notes->n && begin(&l, WEIGHT_NOTE); i++) {
      vg_page_text(p, notes->text[i]);
      end(&l);
    }
  }
  if (!l.n)
    vg_page_markup(p, "<li class=\"good\"><b>As requested</b> <span>All limits "
                      "are met, and nothing was removed, closed or "
                      "assumed.</span></li>\n");
  vg_page_markup(p, "</ul>\n");
  vg_page_end_section(p);
}

/* --- key figures --------------------------------------------------------- */

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

static void wall_quads(struct page *p)
{
  const struct vg_join_info *j = &p->h->layers->join;

  tile_begin(p);
  vg_page_fixed(p, 100 * j->wall_quads, 1);
  vg_page_markup(p, " %");
  tile_end(p, "wall area in quadrilaterals");
  tile_begin(p);
  vg_page_fixed(p, vg_join_density(j), 2);
  tile_end(p, "layer cells per point of the layers");
}

static void angle_tiles(struct page *p)
{
  const struct vg_mesh_report *r = p->has_layers ? &p->h->run->field_judge
                                                 : &p->h->run->judge;
  const int is_section = p->h->problem->read.is_section;

  tile_begin(p);
  vg_page_real(p, is_section ? p->h->run->plane.angle_min : r->angle_min, 3);
  vg_page_markup(p, "&deg;");
  tile_end(p, is_section ? "smallest angle of a triangle outside the layers"
              : p->has_layers ? "smallest dihedral angle outside the layers"
                              : "smallest dihedral angle");
  if (is_section) return;
  tile_begin(p);
  vg_page_fixed(p, r->radius_ratio_mean, 3);
  tile_end(p, "mean radius ratio");
}

void vg_html_tiles(struct page *p)
{
  const struct vg_slices *m = &p->h->run->slices;

  vg_page_markup(p, "<div class=\"tiles\">\n");
  tile(p, vg_run_cells(p->h->run),
       m->n_cell[VG_SLICE_TET] < vg_run_cells(p->h->run) ? "cells"
                                                         : "tetrahedra");
  tile(p, m->n_point, "points");
  if (m->n_cell[VG_SLICE_TET] < vg_run_cells(p->h->run))
    tile(p, m->n_cell[VG_SLICE_TET], "tetrahedra");
  tile(p, m->n_cell[VG_SLICE_PRI], "prisms");
  tile(p, m->n_cell[VG_SLICE_HEX], "hexahedra");
  tile(p, m->n_cell[VG_SLICE_PYR], "pyramids");
  if (p->has_layers) {
    tile_begin(p);
    vg_page_fixed(p, p->h->layers->all.full, 2);
    vg_page_markup(p, " %");
    tile_end(p, "wall faces with full layers");
    if (p->h->layers->join.cells == VG_LAYER_HEX) wall_quads(p);
    tile_begin(p);
    vg_page_real(p, p->h->layers->all.first.mean, 4);
    tile_end(p, "mean first height");
  }
  angle_tiles(p);
  vg_page_markup(p, "</div>\n\n");
}
