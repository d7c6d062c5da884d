/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on viscous layers. Declared in run/report/report.h. */
#include <math.h>
#include <string.h>

#include "run/common/text.h"
#include "run/layers/layers.h"
#include "run/report/report.h"
#include "run/report/report_parts.h"

#define FIRST_SHOWN                                                            \
  1e-3 /* relative difference of first heights from which a                    \
          patch is listed */

static const struct vg_patch *patch_of(const struct vg_mesh *surface,
                                       const struct vg_patch_layers *w)
{
  return &surface->patch[w->patch];
}

/* The first two columns of every table: "   3 wing            ", or "all" if
 * there is no surface. */
static void row_name(FILE *to, const struct vg_mesh *surface,
                     const struct vg_patch_layers *w)
{
  char name[VG_NAME_MAX];

  if (surface)
    fprintf(to, "  %5d %s", (int)patch_of(surface, w)->id,
            vg_text_column(patch_of(surface, w)->name, 16, name, sizeof name));
  else fprintf(to, "  %5s %-16s", "all", "");
}

static void put_cover(FILE *to, const struct vg_mesh *surface,
                      const struct vg_patch_layers *w)
{
  char count[32];

  row_name(to, surface, w);
  fprintf(to, " %11s  %13.2f  %15.2f  %11.2f  %10.0f %6.1f %5.0f",
          vg_text_count(w->n_face, count), w->full, w->uncompressed, w->any,
          w->level.min, w->level.mean, w->level.max);
}

static void row_cover(FILE *to, const struct vg_mesh *surface,
                      const struct vg_patch_layers *w)
{
  put_cover(to, surface, w);
  fputc('\n', to);
}

/* Where inner surfaces limit columns: also the coverage of the other faces. */
static void row_cover_inner(FILE *to, const struct vg_mesh *surface,
                            const struct vg_patch_layers *w)
{
  put_cover(to, surface, w);
  fprintf(to, "  %22.2f\n", w->full_inside);
}

/* The most frequent cause of fewer or thinner layers. */
static const char *main_cause(const struct vg_patch_layers *w)
{
  int most = VG_CAUSE_SIZE;
  size_t n = w->n_bare;

  for (int c = VG_CAUSE_PROXIMITY; c < VG_CAUSE_N; c++)
    if (w->cause[c] + w->compressed[c] > n) {
      n = w->cause[c] + w->compressed[c];
      most = c;
    }
  return n ? vg_layer_cause_name((enum vg_layer_cause)most) : "";
}

static void row_height(FILE *to, const struct vg_mesh *surface,
                       const struct vg_patch_layers *w)
{
  row_name(to, surface, w);
  fprintf(to, " %11.3f %15.3f %18.2f   %s\n", w->share_mean, w->share_low,
          w->share_area, main_cause(w));
}

static void row_first(FILE *to, const struct vg_mesh *surface,
                      const struct vg_patch_layers *w)
{
  row_name(to, surface, w);
  fprintf(to, " %11.4g %10.4g %10.4g %10.4g %8.3f\n", w->asked.mean,
          w->first.min, w->first.mean, w->first.max, 100 * w->first_error);
}

static void row_total(FILE *to, const struct vg_mesh *surface,
                      const struct vg_patch_layers *w)
{
  row_name(to, surface, w);
  fprintf(to, " %11.3g %9.3g %9.3g %12.3f %6.3f", w->total.min, w->total.mean,
          w->total.max, w->growth.mean, w->growth.max);
  if (w->y_plus.max > 0)
    fprintf(to, " %8.2f %6.2f %6.2f", w->y_plus.min, w->y_plus.mean,
            w->y_plus.max);
  fprintf(to, "\n");
}

/* First heights are equal on most patches: only those are listed whose
 * requested height differs from the overall mean, or which deviate from it. */
static int is_first_special(const struct vg_layer_stage *s,
                            const struct vg_patch_layers *w)
{
  return s->n_wall == 1 || w->first_error > FIRST_SHOWN ||
         fabs(w->asked.mean - s->all.asked.mean) >
           FIRST_SHOWN * s->all.asked.mean;
}

static int is_limited(const struct vg_layer_stage *s,
                      const struct vg_patch_layers *w)
{
  return s->n_wall == 1 || w->share_area < 100;
}

static int has_tops(const struct vg_layer_stage *s,
                    const struct vg_patch_layers *w)
{
  (void)s;
  return w->n_top > 0;
}

static int is_any(const struct vg_layer_stage *s,
                  const struct vg_patch_layers *w)
{
  (void)s;
  (void)w;
  return 1;
}

static void row_top(FILE *to, const struct vg_mesh *surface,
                    const struct vg_patch_layers *w)
{
  row_name(to, surface, w);
  fprintf(to, " %11.2f %15.2f %8.2f\n", w->top_ratio[0], w->top_ratio[1],
          w->top_ratio[2]);
}

typedef void (*row_writer)(FILE *to, const struct vg_mesh *surface,
                           const struct vg_patch_layers *w);

typedef int (*row_chooser)(const struct vg_layer_stage *s,
                           const struct vg_patch_layers *w);

static void table(FILE *to, const struct vg_layer_stage *s,
                  const struct vg_mesh *surface, const char *title,
                  const char *head, row_writer row, row_chooser choose)
{
  size_t n = 0;

  fprintf(to, "\n  %s\n  %5s %-16s %s\n", title, "patch", "name", head);
  for (size_t i = 0; i < s->n_wall; i++)
    if (choose(s, &s->wall[i]) && n++ < VG_SHOWN_PATCHES)
      row(to, surface, &s->wall[i]);
  if (n > VG_SHOWN_PATCHES)
    fprintf(to,
            "  ... and %zu more patches (the JSON report lists all of them)\n",
            n - VG_SHOWN_PATCHES);
  if (s->n_wall > 1) row(to, NULL, &s->all);
}

static void row_y_plus(FILE *to, const struct vg_mesh *surface,
                       const struct vg_patch_layers *w,
                       const struct vg_y_plus_patch *y)
{
  const struct vg_y_plus_range *range[2] = { &y->before, &y->after };
  char wanted[16] = "";

  row_name(to, surface, w);
  if (!isnan(y->wanted)) snprintf(wanted, sizeof wanted, "%.4g", y->wanted);
  fprintf(to, " %9s", wanted);
  for (int i = 0; i < 2; i++)
    fprintf(to, "  %7.3f %7.3f %7.3f %6.1f", range[i]->min, range[i]->median,
            range[i]->max, range[i]->within);
  fprintf(to, "\n");
}

/* y+ with the skin friction of a solution. */
static void y_plus(FILE *to, const struct vg_layer_stage *s,
                   const struct vg_mesh *surface)
{
  if (!s->y_plus) return;
  fprintf(to,
          "\n  y+ of the first heights with the skin friction of the solution "
          "(%%: share of the\n  points within %g to %g of the request): by "
          "y_plus alone, and in this mesh\n  %5s %-16s %9s  %7s %7s %7s %6s  "
          "%7s %7s %7s %6s\n",
          VG_Y_PLUS_LOW, VG_Y_PLUS_HIGH, "patch", "name", "requested", "min",
          "median", "max", "%", "min", "median", "max", "%");
  for (size_t i = 0; i < s->n_wall && i < VG_SHOWN_PATCHES; i++)
    row_y_plus(to, surface, &s->wall[i], &s->y_plus[i]);
  if (s->n_wall > VG_SHOWN_PATCHES)
    fprintf(to,
            "  ... and %zu more patches (the JSON report lists all of them)\n",
            s->n_wall - VG_SHOWN_PATCHES);
  if (s->n_wall > 1) row_y_plus(to, NULL, &s->all, &s->y_plus[s->n_wall]);
}

/* Print the counts that are not zero, as in "proximity 12, corner 3"; returns
 * how many there are. */
static int cause_words(FILE *to, const char *lead, const size_t *count)
{
  char n[32];
  int shown = 0;

  for (int c = VG_CAUSE_PROXIMITY; c < VG_CAUSE_N; c++)
    if (count[c])
      fprintf(to, "%s%s %s", shown++ ? ", " : lead,
              vg_layer_cause_name((enum vg_layer_cause)c),
              vg_text_count(count[c], n));
  return shown;
}

void vg_report_layers_note(const struct vg_layer_stage *s,
                           const struct vg_mesh *surface,
                           struct vg_notes *notes)
{
  char list[12 * VG_SHOWN_ITEMS + 8] = "";
  size_t n = 0, at = 0;
  double first = 0;

  for (size_t i = 0; i < s->n_wall; i++) {
    const struct vg_patch_layers *w = &s->wall[i];

    if (!w->n_face || w->n_bare < w->n_face) continue;
    if (n++ < VG_SHOWN_ITEMS)
      at += (size_t)snprintf(list + at, sizeof list - at, " %d",
                             (int)patch_of(surface, w)->id);
    if (n == VG_SHOWN_ITEMS + 1) snprintf(list + at, sizeof list - at, " ...");
    first = fmax(first, s->request[w->patch].law.delta1);
  }
  if (n)
    vg_note(notes,
            "no layers on %zu of %zu walls (patch%s%s): the first "
            "height, %g, exceeds layer_end times the local edge length; is it "
            "in the unit of the surface?",
            n, s->n_wall, n > 1 ? "es" : "", list, first);
}

static void causes(FILE *to, const struct vg_layer_stage *s,
                   const struct vg_mesh *surface)
{
  size_t shown = 0;
  char count[32];

  for (size_t i = 0; i < s->n_wall && shown < VG_SHOWN_PATCHES; i++) {
    const struct vg_patch_layers *w = &s->wall[i];
    size_t bare = w->n_bare, sum = bare;

    for (int c = VG_CAUSE_PROXIMITY; c < VG_CAUSE_N; c++)
      sum += w->cause[c] + w->compressed[c];
    if (!sum) continue;
    if (!shown++)
      fprintf(to, "\n  Wall faces with fewer or thinner layers than "
                  "requested, by cause\n");
    row_name(to, surface, w);
    if (cause_words(to, " fewer: ", w->cause)) fprintf(to, ";");
    if (cause_words(to, " thinner: ", w->compressed) && bare) fprintf(to, ";");
    if (bare)
      fprintf(to,
              " none: %s (first height exceeds layer_end times the edge "
              "length)",
              vg_text_count(bare, count));
    fprintf(to, "\n");
  }
}

static unsigned long long rate(size_t n, double seconds)
{
  return seconds > 0 ? (unsigned long long)((double)n / seconds) : 0;
}

static void times(FILE *to, const struct vg_layer_stage *s)
{
  const struct vg_layer_report *r = &s->report;
  char a[32], b[32];

  fprintf(to,
          "\n  time (s): topology %.2f, directions %.2f, heights %.2f, "
          "clearance %.2f,\n  slide patches %.2f, total %.2f (%s columns/s, "
          "%s layer cells/s); measurement %.2f, front %.2f, tops lowered after "
          "the fill %.2f\n",
          r->time_topology, r->time_direction, r->time_height, r->time_clear,
          r->time_slide, r->time_total,
          vg_text_count(rate(r->n_column, r->time_total), a),
          vg_text_count(rate(r->n_cell, r->time_total), b), s->time_measure,
          s->join.time, s->time_relax);
}

static void sizes(FILE *to, const struct vg_layer_stage *s)
{
  const struct vg_layer_report *r = &s->report;
  const struct vg_join_info *j = &s->join;
  char a[32], b[32], c[32], d[32];

  fprintf(to, "  %s columns on %s wall points, %s wall triangles",
          vg_text_count(r->n_column, a), vg_text_count(r->n_wall_point, b),
          vg_text_count(r->n_wall_tri, c));
  if (r->n_virtual_face)
    fprintf(to, ", %s faces in fans", vg_text_count(r->n_virtual_face, a));
  fprintf(to, "\n  layer cells: %s tetrahedra, %s prisms, %s pyramids",
          vg_text_count(j->n_layer_tet, a), vg_text_count(j->n_layer_pri, b),
          vg_text_count(j->n_layer_pyr, c));
  if (j->n_layer_hex)
    fprintf(to, ", %s hexahedra", vg_text_count(j->n_layer_hex, a));
  fputc('\n', to);
  if (j->cells == VG_LAYER_HEX)
    fprintf(to,
            "  quadrilaterals: %.1f %% of the area of the walls; layer cells "
            "per point: %.2f\n",
            100 * j->wall_quads, vg_join_density(j));
  if (j->cells == VG_LAYER_HEX && !(j->wall_quads > 0))
    fputs(
      "  no hexahedra: the layers are too few or too thin compared with "
      "the edges of\n  the wall for a transition level, or the triangles "
      "do not pair; those of sheets and\n  interfaces never do, and those of "
      "baffles only with layers on both sides\n",
      to);
  fprintf(to,
          "  rounds of height reduction until free of collisions: %zu; slide "
          "patches remeshed: %zu, %s triangles\n",
          r->n_round, r->n_slide_patch, vg_text_count(r->n_slide_tri, a));
  if (s->relax.n_flat)
    fprintf(to,
            "  field cells on the layers with an angle below 10 or above 170 "
            "degrees: %s after the\n  fill, %s after lowering the tops of %s "
            "columns and moving %s points\n",
            vg_text_count(s->relax.n_flat, a),
            vg_text_count(s->relax.n_left, b),
            vg_text_count(s->relax.n_column, c),
            vg_text_count(s->relax.n_point, d));
  if (r->n_many_faces)
    fprintf(to,
            "  columns with more than %d faces, for which not all rays are "
            "traced: %zu\n",
            VG_AHEAD_FACES, r->n_many_faces);
}

#define COVER                                                                  \
  "      faces  full layers %  at growth law %  any layer %  levels min  "     \
  " mean   max"

void vg_report_layers_text(FILE *to, const struct vg_layer_stage *s,
                           const struct vg_mesh *surface)
{
  const char *with_y_plus = "height: min      mean       max growth: mean    "
                            "max  y+: min   mean    max";
  const char *without = "height: min      mean       max growth: mean    max";
  const int is_inner = s->all.cause[VG_CAUSE_INNER] > 0;
  char a[32], b[32];

  sizes(to, s);
  table(to, s, surface, "Coverage of the wall faces",
        is_inner ? COVER "  full off free edges %" : COVER,
        is_inner ? row_cover_inner : row_cover, is_any);
  table(to, s, surface, "Total height / growth-law height",
        "       mean  5th percentile   % of area >= 0.9  limited by",
        row_height, is_limited);
  table(to, s, surface, "First height (length unit of the surface)",
        "  requested        min       mean        max  error %", row_first,
        is_first_special);
  table(to, s, surface,
        "Total height (length unit of the surface) and growth ratio",
        s->all.y_plus.max > 0 ? with_y_plus : without, row_total, is_any);
  y_plus(to, s, surface);
  table(to, s, surface, "Volume ratio of the cells across the layer tops",
        "     median 95th percentile      max", row_top, has_tops);
  causes(to, s, surface);
  fprintf(to,
          "\n  smallest angle of a top face %.1f degrees; complete prisms %s, "
          "of these with a non-positive corner %s\n",
          s->judgement.top_angle_min, vg_text_count(s->judgement.n_prism, a),
          vg_text_count(s->judgement.n_bad_corner, b));
  times(to, s);
}

void vg_report_missed_text(FILE *to, const struct vg_layer_stage *s,
                           const struct vg_mesh *surface)
{
  for (size_t i = 0; i < s->n_missed; i++) {
    const struct vg_limit_missed *m = &s->missed[i];
    const struct vg_patch *p = &surface->patch[m->patch];

    fprintf(to, "limit not met: patch %d%s%s: ", (int)p->id,
            *p->name ? " " : "", p->name);
    if (isnan(m->wanted)) fprintf(to, "layers are requested, ");
    else fprintf(to, "%s is %.10g%s, ", m->name, m->wanted, m->unit);
    if (m->is_bare) fprintf(to, "but the patch has no layers\n");
    else fprintf(to, "reached %.10g%s\n", m->got, m->unit);
  }
}

static json_t *range(const struct vg_range *r)
{
  return json_pack("{s:o s:o s:o}", "min", vg_json_real(r->min), "mean",
                   vg_json_real(r->mean), "max", vg_json_real(r->max));
}

static json_t *causes_json(const size_t *count)
{
  json_t *o = json_object();

  for (int c = 0; c < VG_CAUSE_N; c++)
    json_object_set_new(o, vg_layer_cause_name((enum vg_layer_cause)c),
                        vg_json_count(count[c]));
  return o;
}

static json_t *wall_json(const struct vg_patch_layers *w)
{
  const struct {
    const char *name;
    const struct vg_range *r;
  } ranges[] = {
    { "first_requested", &w->asked }, { "first", &w->first },
    { "levels", &w->level },          { "total", &w->total },
    { "growth", &w->growth },         { "y_plus", &w->y_plus },
  };
  json_t *o = json_object();

  json_object_set_new(o, "faces", vg_json_count(w->n_face));
  json_object_set_new(o, "points", vg_json_count(w->n_point));
  json_object_set_new(o, "bare_faces", vg_json_count(w->n_bare));
  json_object_set_new(o, "percent_full", vg_json_real(w->full));
  json_object_set_new(o, "percent_full_off_free_edges",
                      vg_json_real(w->full_inside));
  json_object_set_new(o, "percent_uncompressed", vg_json_real(w->uncompressed));
  json_object_set_new(o, "percent_any", vg_json_real(w->any));
  json_object_set_new(o, "height_over_growth_law",
                      json_pack("{s:o s:o s:o}", "mean",
                                vg_json_real(w->share_mean), "percentile_5",
                                vg_json_real(w->share_low),
                                "percent_area_above_0.9",
                                vg_json_real(w->share_area)));
  for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
    json_object_set_new(o, ranges[i].name, range(ranges[i].r));
  json_object_set_new(o, "top_volume_ratio",
                      json_pack("{s:o s:o s:o s:o s:[f,f,f]}", "faces",
                                vg_json_count(w->n_top), "median",
                                vg_json_real(w->top_ratio[0]), "percentile_95",
                                vg_json_real(w->top_ratio[1]), "max",
                                vg_json_real(w->top_ratio[2]), "max_at",
                                w->top_at[0], w->top_at[1], w->top_at[2]));
  json_object_set_new(o, "first_error_percent",
                      vg_json_real(100 * w->first_error));
  json_object_set_new(o, "fewer_by_cause", causes_json(w->cause));
  json_object_set_new(o, "thinner_by_cause", causes_json(w->compressed));
  return o;
}

static json_t *walls_json(const struct vg_layer_stage *s,
                          const struct vg_mesh *surface)
{
  json_t *list = json_array();

  for (size_t i = 0; i < s->n_wall; i++) {
    const struct vg_patch *p = patch_of(surface, &s->wall[i]);
    json_t *o = wall_json(&s->wall[i]);

    json_object_set_new(o, "patch", json_integer(p->id));
    json_object_set_new(o, "name", vg_text_json(p->name));
    json_object_set_new(o, "wall_by",
                        json_string(
                          vg_wall_reason_name(s->reason[s->wall[i].patch])));
    json_array_append_new(list, o);
  }
  return list;
}

static json_t *y_plus_range(const struct vg_y_plus_range *r)
{
  return json_pack("{s:o s:o s:o s:o}", "min", vg_json_real(r->min), "median",
                   vg_json_real(r->median), "max", vg_json_real(r->max),
                   "percent_within", vg_json_real(r->within));
}

static json_t *y_plus_json(const struct vg_layer_stage *s,
                           const struct vg_mesh *surface)
{
  json_t *list = json_array();

  for (size_t i = 0; i <= s->n_wall; i++) {
    const struct vg_y_plus_patch *y = &s->y_plus[i];
    const int is_all = i == s->n_wall;

    json_array_append_new(
      list,
      json_pack("{s:o s:o s:o s:o s:o}", "patch",
                is_all ? json_null()
                       : json_integer(patch_of(surface, &s->wall[i])->id),
                "requested", vg_json_real(y->wanted), "points",
                vg_json_count(y->n_point), "before", y_plus_range(&y->before),
                "after", y_plus_range(&y->after)));
  }
  return list;
}

static json_t *missed_json(const struct vg_layer_stage *s,
                           const struct vg_mesh *surface)
{
  json_t *list = json_array();

  for (size_t i = 0; i < s->n_missed; i++) {
    const struct vg_limit_missed *m = &s->missed[i];
    const struct vg_patch *p = &surface->patch[m->patch];

    json_array_append_new(
      list, json_pack("{s:i s:o s:s s:o s:o}", "patch", (int)p->id, "name",
                      vg_text_json(p->name), "limit", m->name, "required",
                      vg_json_real(m->wanted), "got",
                      m->is_bare ? json_null() : vg_json_real(m->got)));
  }
  return list;
}

static json_t *seconds_json(const struct vg_layer_stage *s)
{
  const struct vg_layer_report *r = &s->report;

  return json_pack("{s:f s:f s:f s:f s:f s:f s:f s:f s:f}", "topology",
                   r->time_topology, "directions", r->time_direction, "heights",
                   r->time_height, "clearance", r->time_clear, "slide",
                   r->time_slide, "total", r->time_total, "measure",
                   s->time_measure, "join", s->join.time, "relax",
                   s->time_relax);
}

json_t *vg_report_layers_json(const struct vg_layer_stage *s,
                              const struct vg_mesh *surface)
{
  const struct vg_layer_report *r = &s->report;
  const struct {
    const char *name;
    size_t n;
  } row[] = {
    { "wall_points", r->n_wall_point },
    { "wall_triangles", r->n_wall_tri },
    { "columns", r->n_column },
    { "virtual_faces", r->n_virtual_face },
    { "points", r->n_layer_point },
    { "tetrahedra", s->join.n_layer_tet },
    { "pyramids", s->join.n_layer_pyr },
    { "prisms", s->join.n_layer_pri },
    { "hexahedra", s->join.n_layer_hex },
    { "tetrahedra_if_subdivided", r->n_cell },
    { "rounds", r->n_round },
    { "columns_of_many_faces", r->n_many_faces },
    { "slide_patches", r->n_slide_patch },
    { "flat_cells_after_fill", s->relax.n_flat },
    { "flat_cells_left", s->relax.n_left },
    { "columns_lowered_after_fill", s->relax.n_column },
    { "points_moved_after_fill", s->relax.n_point },
    { "slide_triangles", r->n_slide_tri },
    { "complete_prisms", s->judgement.n_prism },
    { "prisms_with_bad_corner", s->judgement.n_bad_corner },
    { "edges_with_level_steps", s->judgement.n_step },
  };
  json_t *o = json_object();

  for (size_t i = 0; i < sizeof row / sizeof *row; i++)
    json_object_set_new(o, row[i].name, vg_json_count(row[i].n));
  json_object_set_new(o, "top_angle_min",
                      vg_json_real(s->judgement.top_angle_min));
  json_object_set_new(o, "reynolds", vg_json_real(s->reynolds));
  json_object_set_new(o, "reference_length", vg_json_real(s->length));
  json_object_set_new(o, "columns_by_cause", causes_json(r->cause));
  json_object_set_new(o, "columns_compressed_by_cause",
                      causes_json(r->compressed));
  json_object_set_new(o, "patches", walls_json(s, surface));
  json_object_set_new(o, "all", wall_json(&s->all));
  if (s->y_plus)
    json_object_set_new(o, "y_plus_of_solution", y_plus_json(s, surface));
  json_object_set_new(o, "limits_met", json_boolean(!s->n_missed));
  json_object_set_new(o, "limits_missed", missed_json(s, surface));
  json_object_set_new(o, "seconds", seconds_json(s));
  json_object_set_new(o, "percent_wall_quadrilaterals",
                      vg_json_real(100 * s->join.wall_quads));
  json_object_set_new(o, "cells_per_point",
                      vg_json_real(vg_join_density(&s->join)));
  json_object_set_new(o, "columns_per_second",
                      vg_json_count(rate(r->n_column, r->time_total)));
  json_object_set_new(o, "cells_per_second",
                      vg_json_count(rate(r->n_cell, r->time_total)));
  return o;
}
