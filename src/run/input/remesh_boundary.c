/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Remeshes the surface as the settings request. If one tessellation of a CAD
 * model leads to no valid surface, others are tried in a fixed order. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/geometry/volume.h"
#include "core/wrap/wrap.h"
#include "io/mesh/format.h"
#include "run/input/shape_parts.h"
#include "run/input/share.h"
#include "run/settings/plan_options.h"

#define SLIVER2 0.03015369 /* S49: (sin 10 degrees)^2 */
#define NEEDLE 5.0         /* S56: degrees */
/* Share of the triangles; a larger share of needles is repaired. */
#define MANY 1e-3
/* Share of the triangles; above it a tessellation is remeshed. */
#define MOST 0.2 /* S49 */
/* Largest relative difference between areas of a patch and of its CAD faces. */
#define AREA_NEAR 0.05

/* S49: tessellations after the first, as factors on its chord and angle.
 * Coarser ones come first, whose sheets do not cross at cusps, then a finer
 * one, whose sheets separate where chords are larger than the thickness of a
 * body. */
static const double again[][2] = { { 7, 2 }, { 30, 3 }, { 0.1, 0.6 } };
#define TRIES (sizeof again / sizeof *again)

/* --- which surfaces are remeshed ----------------------------------------- */

/* Whether the smallest angle is below 10 degrees. */
static int is_sliver(const struct vg_mesh *m, const uint32_t v[3])
{
  double e[3][3], l[3], n[3], least;

  for (int k = 0; k < 3; k++) {
    vg_sub(m->point[v[(k + 1) % 3]], m->point[v[k]], e[k]);
    l[k] = vg_dot(e[k], e[k]);
  }
  vg_cross(e[0], e[1], n);
  least = fmin(l[0], fmin(l[1], l[2]));
  return vg_dot(n, n) * least <= SLIVER2 * l[0] * l[1] * l[2];
}

/* Share of the triangles with an angle below 10 degrees. */
static double sliver_share(const struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t t = 0; t < m->n_tri; t++) n += (size_t)is_sliver(m, m->tri[t]);
  return m->n_tri ? (double)n / (double)m->n_tri : 0;
}

static int is_tessellation(const struct vg_read *r)
{
  return !*r->files.front && !(r->settings.wrap > 0) && !r->heights.n &&
       *r->files.surface && vg_format_is_tessellation(r->files.surface);
}

int vg_read_is_cad(const struct vg_read *r)
{
  return !*r->files.front && vg_format_is_cad(r->files.surface);
}

int vg_read_is_remeshed(const struct vg_read *r, const struct vg_mesh *surface)
{
  if (r->is_section) return 0;
  if (r->settings.remesh != VG_ANSWER_AUTO)
    return r->settings.remesh == VG_ANSWER_YES;
  if (is_tessellation(r))
    return !vg_read_keeps_triangles(r) && !r->settings.n_periodic &&
           sliver_share(surface) > MOST;
  return vg_read_is_cad(r) && !(r->settings.wrap > 0);
}

void vg_boundary_note_slivers(struct vg_boundary *b)
{
  const double share = sliver_share(&b->surface);
  const char *inner = vg_read_keeps_triangles(b->read);
  const char *keeps = inner                        ? inner
                    : b->read->settings.n_periodic ? "periodic patches"
                                                   : NULL;

  if (b->read->settings.remesh != VG_ANSWER_AUTO || !(share > MOST)) return;
  if (b->is_remeshed)
    vg_note(b->notes,
            "%.0f %% of the triangles have an angle below 10 degrees: the "
            "surface is treated as a tessellation and is remeshed "
            "(--remesh-surface no keeps it unchanged)",
            100 * share);
  else if (keeps)
    vg_note(b->notes,
            "%.0f %% of the triangles have an angle below 10 degrees, and so "
            "will the cells on them: a surface with %s is not remeshed; %s",
            100 * share, keeps,
            inner ? "--remesh-surface yes remeshes walls and inner surfaces"
                  : "--remesh-surface yes remeshes it");
  else if (!(b->read->settings.wrap > 0) && !vg_boundary_is_stretched(b))
    vg_note(b->notes,
            "%.0f %% of the triangles have an angle below 10 degrees, and so "
            "will the cells on them: --remesh-surface yes remeshes the surface",
            100 * share);
}

/* --- the remeshed surface ------------------------------------------------ */

/* *hard: [n_patch], NULL if no patch has a fixed border. */
static vg_status hard_patches(const struct vg_boundary *b, uint8_t **hard,
                              struct vg_error *err)
{
  for (size_t i = 0; i < b->n_row; i++) {
    const struct vg_patch_row *row = &b->row[i];
    size_t at = vg_mesh_find_patch(&b->surface, row->id);

    if (!row->hard || at == SIZE_MAX) continue;
    if (!*hard) *hard = vg_calloc(b->surface.n_patch, 1);
    if (!*hard) return vg_fail_memory(err, "the patches");
    (*hard)[at] = 1;
  }
  return VG_OK;
}

static void areas(const struct vg_mesh *m, int after, double *area)
{
  for (size_t t = 0; t < m->n_tri; t++)
    area[2 * m->tri_patch[t] + (size_t)after] += vg_triangle_area(
      m->point[m->tri[t][0]], m->point[m->tri[t][1]], m->point[m->tri[t][2]]);
}

/* Is the surface the whole CAD model, of which nothing was cut off, dropped,
 * capped or united? */
static int is_whole_model(const struct vg_boundary *b)
{
  return b->model.cad && b->flow.kind != VG_FLOW_UNKNOWN && b->flow.axis < 0 &&
         !b->flow.n_cavity && !b->n_given_patch && !b->is_united;
}

/* Area of patch i of the given mesh: of its CAD faces, if known. A sum over
 * faces that overlap each other is not the area of the patch. */
static double given_area(const struct vg_boundary *b, size_t i, double area)
{
  const struct vg_cad_surface *s = &b->model.surface;
  const double exact = is_whole_model(b) && s->area && i < s->mesh.n_patch
                       ? s->area[i]
                       : NAN;

  return fabs(exact - area) <= AREA_NEAR * area ? exact : area;
}

/* Areas of the given patches. They are those of the first attempt, since the
 * tessellations of later attempts may be coarse. */
static vg_status given_areas(struct vg_boundary *b, const struct vg_mesh *given,
                             double *area, struct vg_error *err)
{
  struct vg_patch_areas *a = &b->given_area;

  areas(given, 0, area);
  if (!a->n) {
    a->id = vg_alloc(given->n_patch, sizeof *a->id);
    a->area = vg_alloc(given->n_patch, sizeof *a->area);
    if (!a->id || !a->area) return vg_fail_memory(err, "the patches");
    for (; a->n < given->n_patch; a->n++) {
      a->id[a->n] = given->patch[a->n].id;
      a->area[a->n] = given_area(b, a->n, area[2 * a->n]);
      area[2 * a->n] = a->area[a->n];
    }
    return VG_OK;
  }
  for (size_t i = 0; i < a->n; i++) {
    const size_t at = vg_mesh_find_patch(given, a->id[i]);

    if (at != SIZE_MAX) area[2 * at] = a->area[i];
  }
  return VG_OK;
}

static vg_status start_areas(struct vg_boundary *b, const struct vg_mesh *given,
                             struct vg_error *err)
{
  struct vg_remeshing *r = &b->remeshing;

  r->n_patch = given->n_patch;
  r->area = vg_calloc(2 * r->n_patch, sizeof *r->area);
  if (!r->area) return vg_fail_memory(err, "the patches");
  return given_areas(b, given, r->area, err);
}

struct remesh_request {
  const uint8_t *hard; /* [n_patch] May be NULL. */
  const struct vg_surface_sizes *sizes;
  const struct vg_inner_lines *lines;
};

static vg_status remesh(struct vg_boundary *b, const struct remesh_request *q,
                        int is_reference, enum vg_remesh_course course,
                        struct vg_display *show, struct vg_error *err)
{
  const struct vg_surface_sizes *sizes = q->sizes;
  struct vg_remesh_options o = vg_options_remesh(&b->read->settings);

  o.n_source = sizes->n_source;
  o.source = sizes->source;
  o.map = b->map;
  o.field = sizes->field;
  o.h_max = vg_boundary_largest_edge(b, o.h_max);
  o.hard = q->hard;
  o.keeps_borders = vg_read_is_cad(b->read);
  o.course = course;
  o.is_body = b->flow.kind == VG_FLOW_EXTERNAL;
  o.is_reference = is_reference;
  o.cap = sizes->cap;
  o.across = sizes->across;
  o.stretch = sizes->stretch;
  o.still = q->lines->still;
  o.threads = b->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  return vg_remesh(&b->surface, &o, &b->remeshing.report, err);
}

/* Volumes of the remeshed surface and of the CAD model. Integrated about a
 * corner, so that numbers are small wherever the body is. */
static void take_volumes(struct vg_boundary *b)
{
  const struct vg_mesh *m = &b->surface;

  b->remeshing.volume[0] = b->remeshing.volume[1] = NAN;
  if (!is_whole_model(b) || !m->n_tri) return;
  b->remeshing.volume[0] = fabs(vg_enclosed6(m->n_tri,
                                             (const uint32_t(*)[3])m->tri,
                                             (const double(*)[3])m->point,
                                             m->point[0])) /
                           6;
  b->remeshing.volume[1] = b->model.surface.volume;
}

static size_t n_needle(const struct vg_remesh_report *r)
{
  size_t n = 0;

  for (size_t i = 0; i < r->n_bad; i++) n += r->bad[i].angle < NEEDLE;
  return n;
}

/* A remeshed surface with its report. */
struct made {
  struct vg_mesh surface;
  struct vg_remesh_report report;
};

static void release_made(struct made *d)
{
  vg_mesh_release(&d->surface);
  vg_remesh_report_release(&d->report);
}

/* Exchange the surface and report of b with d. */
static void exchange(struct vg_boundary *b, struct made *d)
{
  const struct made other = *d;

  d->surface = b->surface;
  d->report = b->remeshing.report;
  b->surface = other.surface;
  b->remeshing.report = other.report;
}

static int has_few_needles(const struct vg_boundary *b)
{
  return (double)n_needle(&b->remeshing.report) <=
         MANY * (double)b->surface.n_tri;
}

/* A tessellation without defects is remeshed directly. If this fails or yields
 * many needles, because its own needles are feature edges too, it is repaired
 * like a tessellation with defects. The result with fewer needles is kept. If
 * both fail, the other attempts start from the one with fewer intersections. */
static vg_status remesh_tessellation(struct vg_boundary *b,
                                     const struct vg_mesh *given,
                                     const struct remesh_request *q,
                                     struct vg_display *show,
                                     struct vg_error *err)
{
  struct made first = { .surface = VG_MESH_INIT };
  size_t n_direct, n_repaired;
  vg_status st, direct;

  VG_TRY(direct = remesh(b, q, 0, VG_REMESH_FIRST, show, err));
  if (direct == VG_OK && has_few_needles(b)) goto done;
  n_direct = b->remeshing.report.n_intersection;
  exchange(b, &first);
  VG_TRY(vg_mesh_copy(&b->surface, given, err));
  st = remesh(b, q, 1, VG_REMESH_FIRST, show, err);
  if (st < 0 && st != VG_ERR_GEOMETRY) goto done;
  n_repaired = st == VG_BLOCKED ? b->remeshing.report.n_intersection : SIZE_MAX;
  if (direct == VG_OK && (st != VG_OK || n_needle(&b->remeshing.report) >=
                                           n_needle(&first.report)))
    exchange(b, &first);
  else if (st != VG_OK)
    VG_TRY(remesh(b, q, n_repaired < n_direct, VG_REMESH_OTHERS, show, err));
  st = VG_OK;
done:
  release_made(&first);
  return st;
}

static vg_status measure(struct vg_boundary *b, struct vg_mesh *given,
                         struct vg_display *show, struct vg_error *err)
{
  const struct vg_stop stop = { vg_display_stop, show };
  struct vg_remeshing *r = &b->remeshing;
  vg_status st;

  r->face = vg_alloc(b->surface.n_tri, sizeof *r->face);
  if (!r->face) return vg_fail_memory(err, "the distances");
  VG_TRY(vg_remesh_arrange(given, err));
  VG_TRY(vg_remesh_measure(&b->surface, given, b->threads, &stop, r->face,
                           r->off, err));
done:
  return st;
}

static void note_faults(struct vg_boundary *b)
{
  const struct vg_remesh_report *r = &b->remeshing.report;

  if (r->n_crossing[0])
    vg_note(b->notes,
            "the input surface intersects itself in %zu pairs of triangles, "
            "by at most %.3g, at (%.6g, %.6g, %.6g); the remeshed surface, "
            "which is within %.3g of it, does not",
            r->n_crossing[0], r->crossing_depth, r->crossing_at[0],
            r->crossing_at[1], r->crossing_at[2], r->tolerance);
  if (r->n_kept)
    vg_note(b->notes,
            "%zu triangles were kept unchanged because new triangles would "
            "intersect there; the first are near (%.6g, %.6g, %.6g)",
            r->n_kept, r->kept_at[0], r->kept_at[1], r->kept_at[2]);
  if (vg_read_is_cad(b->read) && !b->model.cad)
    vg_note(b->notes,
            "points are not projected onto the CAD model, since the surface "
            "has inner surfaces: it deviates from the model by the chord error "
            "of the triangulation in addition (cad_chord)");
}

static void note_remeshing(struct vg_boundary *b)
{
  const struct vg_remeshing *r = &b->remeshing;
  char outer[120] = "";

  if (r->report.far > 0)
    snprintf(outer, sizeof outer,
             ", or 0.05 of the edge length where edges of the outer boundary "
             "are longer than %.3g",
             r->report.far);
  vg_note(b->notes,
          "the surface was remeshed (remesh_surface): %zu triangles, %zu "
          "before; largest distance between both surfaces %.3g, tolerance "
          "%.3g%s",
          r->report.n_tri[1], r->report.n_tri[0],
          r->off[0].most > r->off[1].most ? r->off[0].most : r->off[1].most,
          r->report.tolerance, outer);
}

/* Relative change of a patch's area above which it is reported. */
#define AREA_CHANGE 0.01

/* Patches that are narrower than the tolerance, or have borders that were not
 * kept, change their areas. */
static void note_areas(struct vg_boundary *b)
{
  const struct vg_remeshing *r = &b->remeshing;
  size_t n = 0, at = 0;
  double most = 0;

  for (size_t i = 0; i < r->n_patch; i++) {
    const double old = r->area[2 * i], change = r->area[2 * i + 1] / old - 1;

    if (!(old > 0) || fabs(change) <= AREA_CHANGE) continue;
    n++;
    if (fabs(change) <= fabs(most)) continue;
    most = change;
    at = i;
  }
  if (n)
    vg_note(b->notes,
            "remeshing changed the area of %zu patch%s by more than 1 %%, that "
            "of patch %d by %.3g %%: the borders of a patch move if it is "
            "narrower than the tolerance (surface_tolerance) or very narrow "
            "compared with the edges, or if triangles along the borders would "
            "intersect (column hard of the table patches preserves them)",
            n, n > 1 ? "es" : "", (int)b->surface.patch[at].id, 100 * most);
}

/* Part of surface_size below which the longest edge is reported. */
#define SHORT 0.5

/* The tolerance also limits edges: between the facets of a coarse
 * tessellation, longer edges would leave the input surface. */
static void note_size(struct vg_boundary *b)
{
  const double asked = b->read->settings.surface_size * b->read->settings.scale;
  const struct vg_mesh *m = &b->surface;
  double most = 0;

  for (size_t t = 0; t < m->n_tri && asked > 0; t++)
    for (int k = 0; k < 3; k++)
      most = fmax(most, vg_distance(m->point[m->tri[t][k]],
                                    m->point[m->tri[t][(k + 1) % 3]]));
  if (asked > 0 && most < SHORT * asked)
    vg_note(b->notes,
            "surface_size allows edges of %.3g, but the longest edge is %.3g: "
            "curvature, gaps, sources or the tolerance %.3g require shorter "
            "edges (surface_tolerance, edges_per_turn)",
            asked, most, b->remeshing.report.tolerance);
}

/* --- periodic patches ----------------------------------------------------- */

/* The transforms, on the surface before it is remeshed. */
static vg_status find_pairs(const struct vg_boundary *b,
                            struct vg_display *show, struct vg_pairs *pairs,
                            struct vg_error *err)
{
  const struct vg_stop stop = { vg_display_stop, show };
  const struct vg_settings *s = &b->read->settings;
  const double chord = vg_read_is_cad(b->read) ? vg_options_cad(s, 1).chord : 0;

  return vg_pairs_locate(s, &b->surface, chord, b->threads, &stop, pairs, err);
}

/* The report by the new triangles: those of the image have the values of their
 * originals. `at` of their entries are places of the originals. */
static vg_status follow_report(struct vg_remeshing *r, size_t n,
                               const uint32_t *origin, struct vg_error *err)
{
  struct vg_remesh_report *q = &r->report;
  double *face = vg_alloc(n, sizeof *face);
  uint32_t *of = vg_calloc(q->n_tri[1], sizeof *of);
  struct vg_remesh_bad *bad = NULL;
  size_t n_bad = 0, cap = 0;
  vg_status st = VG_OK;

  if (!face || !of) VG_TRY(vg_fail_memory(err, "the remeshed surface"));
  for (size_t i = 0; i < q->n_bad; i++) of[q->bad[i].face] = (uint32_t)i + 1;
  for (size_t t = 0; t < n; t++) {
    const uint32_t i = of[origin[t]];

    face[t] = r->face[origin[t]];
    if (!i) continue;
    if (vg_reserve(&bad, &cap, n_bad + 1, sizeof *bad) < 0)
      VG_TRY(vg_fail_memory(err, "the remeshed surface"));
    bad[n_bad] = q->bad[i - 1];
    bad[n_bad++].face = t;
  }
  free(r->face);
  free(q->bad);
  r->face = face;
  q->bad = bad;
  q->n_bad = n_bad;
  q->n_tri[1] = n;
  face = NULL;
  bad = NULL;
done:
  free(face);
  free(of);
  free(bad);
  return st;
}

/* Makes the second patch of each pair the image of the first one. */
static vg_status copy_pairs(struct vg_boundary *b, const struct vg_pairs *pairs,
                            struct vg_error *err)
{
  uint32_t *origin = NULL;
  size_t n_changed;
  vg_status st;

  if (!pairs->n) return VG_OK;
  VG_TRY(vg_pairs_copy(pairs, &b->surface, &origin, &n_changed, err));
  VG_TRY(follow_report(&b->remeshing, b->surface.n_tri, origin, err));
  b->remeshing.report.n_point[1] = b->surface.n_point;
  vg_note(b->notes,
          "periodic patches: %zu second patch%s got the images of the new "
          "triangles of the first; %zu points of borders were inserted or "
          "removed for them",
          pairs->n, pairs->n > 1 ? "es" : "", n_changed);
done:
  free(origin);
  return st;
}

vg_status vg_boundary_remesh(struct vg_boundary *b, struct vg_display *show,
                             struct vg_error *err)
{
  struct vg_remeshing *r = &b->remeshing;
  struct vg_surface_sizes sizes = { 0 };
  struct vg_inner_lines lines = VG_INNER_LINES_INIT;
  struct remesh_request q;
  const int has_defects = b->check.n_defect >
                          b->check.count[VG_DEFECT_OPEN_EDGE];
  struct vg_mesh given = VG_MESH_INIT;
  struct vg_pairs pairs = VG_PAIRS_INIT;
  uint8_t *hard = NULL;
  double t = vg_display_now();
  vg_status st;

  if (b->read->heights.n)
    return vg_fail(err, VG_ERR_INPUT,
                   "first heights are given at points of the surface, but "
                   "remesh_surface replaces these points: give the heights by "
                   "patch, or set remesh_surface to no");
  vg_display_update(show, "surface remeshing", b->surface.n_tri, 0);
  VG_TRY(vg_mesh_copy(&given, &b->surface, err));
  VG_TRY(start_areas(b, &given, err));
  VG_TRY(hard_patches(b, &hard, err));
  VG_TRY(find_pairs(b, show, &pairs, err));
  VG_TRY(vg_surface_sizes_make(b, &sizes, err));
  VG_TRY(vg_boundary_field(b, sizes.n_source, sizes.source, &sizes.field, err));
  VG_TRY(vg_inner_lines_find(b, &lines, &sizes.stretch, &sizes.cap, err));
  q = (struct remesh_request){ hard, &sizes, &lines };
  VG_TRY(
    b->model.cad && !has_defects && !lines.still
      ? remesh_tessellation(b, &given, &q, show, err)
      : remesh(b, &q, has_defects && !lines.still, VG_REMESH_ALL, show, err));
  if (lines.still)
    VG_TRY(vg_junctions_trace(&lines.junctions, 0, &b->surface, err));
  r->seconds = vg_display_now() - t;
  VG_TRY(measure(b, &given, show, err));
  r->is_done = 1;
  vg_display_update(show, "projection", b->surface.n_tri, 0);
  if (b->model.cad) VG_TRY(vg_boundary_put_back(b, show, err));
  VG_TRY(vg_inner_lines_remesh(b, &lines, show, err));
  VG_TRY(copy_pairs(b, &pairs, err));
  take_volumes(b);
  areas(&b->surface, 1, r->area);
  VG_TRY(vg_surface_spacing_measure(b, r, err));
  note_faults(b);
  note_remeshing(b);
  note_areas(b);
  note_size(b);
done:
  vg_inner_lines_release(&lines);
  vg_surface_sizes_release(&sizes);
  vg_pairs_release(&pairs);
  free(hard);
  vg_mesh_release(&given);
  return st;
}

/* --- other tessellations ------------------------------------------------- */

/* Copies names and conditions from the patches with the same numbers. */
static void keep_conditions(const struct vg_mesh *from, struct vg_mesh *to)
{
  for (size_t i = 0; i < to->n_patch; i++) {
    const size_t at = vg_mesh_find_patch(from, to->patch[i].id);

    if (at != SIZE_MAX) to->patch[i] = from->patch[at];
  }
}

/* Replaces the surface by a new tessellation m; notes from n_note on referred
 * to the previous one. */
static void take_surface(struct vg_boundary *b, struct vg_mesh *m,
                         const struct vg_mesh *given, size_t n_note)
{
  keep_conditions(given, m);
  vg_mesh_move(&b->surface, m);
  vg_remeshing_release(&b->remeshing);
  while (b->notes->n > n_note) free(b->notes->text[--b->notes->n]);
}

/* Reads the file again without uniting its solids. */
static vg_status take_solids(struct vg_boundary *b, const struct vg_mesh *given,
                             size_t n_note, struct vg_display *show,
                             struct vg_error *err)
{
  struct vg_cad_options cad = vg_options_cad(&b->read->settings, 1);
  struct vg_cad_model model = VG_CAD_MODEL_INIT;
  struct vg_read_info info = { .cad = &cad, .model = &model, .mapbc = NULL };
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  cad.stop = (struct vg_stop){ vg_display_stop, show };
  cad.keeps_solids = 1;
  vg_display_update(show, "tessellation of its solids", 0, 0);
  VG_TRY(vg_surface_read(b->read->files.surface, &m, &info, err));
  take_surface(b, &m, given, n_note);
  vg_cad_model_release(&b->model);
  b->model = model;
  vg_note(b->notes,
          "the union of %zu solids by Open CASCADE did not give a valid "
          "surface; the solids were triangulated one by one",
          model.surface.n_solid);
  return VG_OK;
done:
  vg_cad_model_release(&model);
  vg_mesh_release(&m);
  return st;
}

vg_status vg_boundary_tessellate(struct vg_boundary *b, size_t i,
                                 const struct vg_patch *patch, size_t n_patch,
                                 size_t n_note, struct vg_display *show,
                                 struct vg_error *err)
{
  const struct vg_mesh given = { .n_patch = n_patch,
                                 .patch = (struct vg_patch *)(uintptr_t)patch };
  struct vg_cad_options cad = vg_options_cad(&b->read->settings, 1);
  struct vg_cad_surface fresh = VG_CAD_SURFACE_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  if (!b->model.cad) return VG_BLOCKED;
  if (b->model.surface.n_solid > 1 && i == 0)
    return take_solids(b, &given, n_note, show, err);
  if (b->model.surface.n_solid > 1) i--;
  if (i >= TRIES) return VG_BLOCKED;
  cad.stop = (struct vg_stop){ vg_display_stop, show };
  cad.chord = fmin(cad.chord * again[i][0], 0.1);
  cad.angle = fmin(fmax(cad.angle * again[i][1], 2), 30);
  vg_display_update(show, "tessellation", 0, 0);
  VG_TRY(vg_cad_again(b->model.cad, &cad, &fresh, err));
  VG_TRY(vg_mesh_copy(&m, &fresh.mesh, err));
  take_surface(b, &m, &given, n_note);
  vg_cad_surface_release(&b->model.surface);
  b->model.surface = fresh;
  vg_note(b->notes,
          "the first tessellation of the CAD model did not give a valid "
          "surface; it was repeated with a chord error of %.2g and an angle "
          "of %.3g degrees (cad_chord, cad_angle)",
          cad.chord, cad.angle);
  return VG_OK;
done:
  vg_cad_surface_release(&fresh);
  vg_mesh_release(&m);
  return st;
}

void vg_remeshing_release(struct vg_remeshing *r)
{
  vg_remesh_report_release(&r->report);
  free(r->face);
  free(r->area);
  free(r->row);
  memset(r, 0, sizeof *r);
}

/* With inner surfaces points are not projected, so that all ranks can remesh.
 */
int vg_problem_has_maker(const struct vg_problem *p, struct vg_comm *comm)
{
  return vg_read_is_by_first(&p->read, comm) &&
         !vg_read_keeps_triangles(&p->read) &&
         vg_read_is_remeshed(&p->read, vg_problem_surface(p));
}

vg_status vg_problem_share(struct vg_problem *p, struct vg_comm *comm,
                           int is_maker, vg_status st, struct vg_error *err)
{
  struct vg_boundary *b = &p->boundary;

  if (!vg_problem_has_maker(p, comm)) return vg_comm_agree(comm, st, err);
  st = vg_surface_bcast(comm, is_maker, st, &b->surface, err);
  if (st >= 0 && vg_comm_rank(comm)) b->remeshing.is_done = is_maker;
  return st;
}
