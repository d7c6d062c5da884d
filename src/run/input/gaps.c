/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sizes from gaps between facing surfaces, combined with those of a file or the
 * calling program. Declared in run/input/sizes.h. */
#include "core/remesh/gaps.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/tensor.h"
#include "run/input/shape_parts.h"
#include "run/input/sizes.h"
#include "run/settings/plan_options.h"

/* S60: most samples from gaps. */
#define MOST_PLACE 2e7

struct vg_gap_sizes {
  struct vg_size_samples *samples;
  const struct vg_size_map *gaps, *other; /* other: NULL if there were no other
                                             sizes. */
  struct vg_size_map map;                 /* The smaller of both sizes. */
};

static double at(void *user, const double x[3])
{
  const struct vg_gap_sizes *g = user;

  return fmin(g->gaps->at(g->gaps->user, x), g->other->at(g->other->user, x));
}

static double least(void *user, const double lo[3], const double hi[3])
{
  const struct vg_gap_sizes *g = user;

  return fmin(g->gaps->least(g->gaps->user, lo, hi),
              g->other->least(g->other->user, lo, hi));
}

/* The metric of the other map, intersected with the size of the gaps. */
static void metric(void *user, const double x[3], double m[6])
{
  const struct vg_gap_sizes *g = user;
  double h = g->gaps->at(g->gaps->user, x), gap[6];

  g->other->metric(g->other->user, x, m);
  vg_tensor_uniform(1 / (h * h), gap);
  vg_metric_intersect(gap, m, m);
}

/* The other map may have no lower bound. */
static void join_maps(struct vg_gap_sizes *g, const struct vg_size_map *other)
{
  g->gaps = vg_size_samples_map(g->samples);
  g->other = other;
  g->map = *g->gaps;
  if (!other) return;
  g->map = (struct vg_size_map){ .at = at,
                                 .metric = other->metric ? metric : NULL,
                                 .user = g,
                                 .least = other->least ? least : NULL,
                                 .most = other->most > 0
                                         ? fmax(other->most, g->gaps->most)
                                         : 0 };
}

static vg_status make(struct vg_boundary *b, const struct vg_gaps *found,
                      struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  struct vg_gap_sizes *g = vg_calloc(1, sizeof *g);
  vg_status st;

  if (!g) return vg_fail_memory(err, "the gaps");
  st = vg_size_samples_new(found->n, (const double(*)[3])found->x, found->h,
                           vg_options_growth(s), b->threads, &g->samples, err);
  if (st < 0) {
    free(g);
    return st;
  }
  join_maps(g, b->map);
  b->gaps = g;
  b->map = &g->map;
  return VG_OK;
}

static void patch_text(const struct vg_patch *p, char *text, size_t size)
{
  snprintf(text, size, "%d%s%s%s", (int)p->id, *p->name ? " (" : "", p->name,
           *p->name ? ")" : "");
}

static vg_status too_many(const struct vg_boundary *b, const struct vg_gaps *g,
                          double most_tri, struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const int is_tri = b->is_remeshed && g->n_tri > most_tri;
  char one[VG_NAME_MAX + 24], two[VG_NAME_MAX + 24];

  patch_text(&b->surface.patch[g->patch[0]], one, sizeof one);
  patch_text(&b->surface.patch[g->patch[1]], two, sizeof two);
  return vg_fail(err, VG_ERR_INPUT,
                 "gap_edges %g needs about %.2g %s in gaps, but the limit is "
                 "%.9g%s; the narrowest gap is %.4g wide, between patches %s "
                 "and %s at (%.6g, %.6g, %.6g). Reduce gap_edges, increase "
                 "hmin, or close the gap%s%s",
                 s->gap_edges, is_tri ? g->n_tri : g->n_place,
                 is_tri ? "surface triangles" : "size samples",
                 is_tri ? most_tri : MOST_PLACE,
                 is_tri && s->max_cells ? " (max_cells)" : "", g->narrowest,
                 one, two, g->at[0], g->at[1], g->at[2],
                 *s->baffles ? "" : " (--wrap)",
                 is_tri && s->max_cells ? "; or increase max_cells" : "");
}

/* The cells of a section are in the plane z = 0 of its strip. */
static void flatten(struct vg_gaps *found)
{
  for (size_t i = 0; i < found->n; i++) found->x[i][2] = 0;
  found->at[2] = 0;
}

vg_status vg_boundary_gaps(struct vg_boundary *b, struct vg_display *show,
                           struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  struct vg_gaps found = VG_GAPS_INIT;
  struct vg_gap_options o = vg_options_gaps(s, b->is_remeshed);
  vg_status st;

  if (!(s->gap_edges > 0) || b->gaps) return VG_OK;
  vg_display_update(show, "gaps", b->surface.n_tri, 0);
  o.most_place = MOST_PLACE;
  o.threads = b->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  VG_TRY(vg_gaps_find(&b->surface, &o, &found, err));
  if (st == VG_BLOCKED) VG_TRY(too_many(b, &found, o.most_tri, err));
  if (b->read->is_section) flatten(&found);
  if (found.n)
    vg_note(b->notes,
            "gap_edges %g: limits edge lengths at %zu places in gaps; the "
            "narrowest gap is %.4g wide, at (%.6g, %.6g, %.6g)%s",
            s->gap_edges, found.n, found.narrowest, found.at[0], found.at[1],
            found.at[2],
            b->is_remeshed || b->read->is_section ? ""
            : vg_read_keeps_triangles(b->read)
              ? "; the surface is not remeshed, so cells between its coarse "
                "faces cannot become small (give one with shorter edges there)"
              : "; the surface is not remeshed, so cells between its coarse "
                "faces cannot become small (remesh_surface yes remeshes it)");
  else
    vg_note(b->notes, "setting that has no effect because no gap is narrow "
                      "enough: gap_edges");
  if (found.n) VG_TRY(make(b, &found, err));
  st = vg_display_stopped(show, err);
done:
  vg_gaps_release(&found);
  return st;
}

void vg_boundary_forget_gaps(struct vg_boundary *b)
{
  if (!b->gaps) return;
  b->map = b->gaps->other;
  vg_size_samples_free(b->gaps->samples);
  free(b->gaps);
  b->gaps = NULL;
}
