/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/commands/check_surface.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "cli/common/cli.h"
#include "core/surface/surface_quality.h"
#include "io/mesh/format.h"
#include "io/mesh/vtu.h"
#include "run/common/text.h"
#include "run/layers/layers.h"
#include "run/report/report.h"
#include "run/settings/plan_options.h"

struct findings {
  int has_lines; /* 1: feature curves were traced, which some defects
                    prevent */
  struct vg_remesh_report lines;
  struct vg_mesh other;             /* the surface to compare with */
  struct vg_remesh_distance off[2]; /* of this surface from the other, and of
                              the other from this one */
  double *face; /* [n_tri] distance of each triangle from the other surface, or
                   NULL */
};

static void release(struct findings *f)
{
  vg_remesh_report_release(&f->lines);
  vg_mesh_release(&f->other);
  free(f->face);
}

/* Feature curves can be traced if the only defects are open edges. */
static int can_be_followed(const struct vg_mesh *m,
                           const struct vg_surface_report *r)
{
  return m->n_tri && !m->n_quad && r->count[VG_DEFECT_OPEN_EDGE] == r->n_defect;
}

/* Trace the feature curves. The remesher may reject a surface without defects;
 * this is not an error here. */
static vg_status trace_curves(struct vg_boundary *b, struct findings *f,
                              struct vg_error *err)
{
  struct vg_remesh_options o = vg_options_remesh(&b->read->settings);
  struct vg_error why = VG_ERROR_INIT;
  struct vg_sizing *field = NULL;
  vg_status st;

  if (b->read->is_section || !can_be_followed(&b->surface, &b->check))
    return VG_OK;
  st = vg_boundary_field(b, b->read->settings.n_source,
                         b->read->settings.source, &field, err);
  if (st < 0) return st;
  o.field = field;
  o.h_max = vg_boundary_largest_edge(b, o.h_max);
  o.threads = 0;
  st = vg_remesh_judge(&b->surface, &o, &f->lines, &why);
  vg_sizing_free(field);
  f->has_lines = st >= 0;
  if (st == VG_ERR_MEMORY) return vg_fail_memory(err, "the feature curves");
  if (st < 0)
    vg_note(b->notes, "feature curves were not examined: %s", why.text);
  return VG_OK;
}

static vg_status compare(const struct vg_check_surface *a,
                         const struct vg_mesh *m, struct findings *f,
                         struct vg_error *err)
{
  struct vg_read_info info = { 0 };
  vg_status st;

  if (!a->against) return VG_OK;
  VG_TRY(vg_surface_read(a->against, &f->other, &info, err));
  if (f->other.n_quad || m->n_quad)
    VG_TRY(vg_fail(err, VG_ERR_INPUT,
                   "%s: distances can be measured between "
                   "triangles only, but one of the surfaces has quadrilaterals",
                   a->against));
  f->face = vg_alloc(m->n_tri, sizeof *f->face);
  if (!f->face) VG_TRY(vg_fail_memory(err, "the distances"));
  VG_TRY(vg_remesh_measure(m, &f->other, 0, NULL, f->face, f->off, err));
done:
  return st;
}

/* Quality is defined for triangles only, so quadrilaterals are rejected. */
static vg_status write_vtu(const struct vg_check_surface *a,
                           const struct vg_mesh *m, const struct findings *f,
                           struct vg_error *err)
{
  double *angle;
  struct vg_vtu_field field[3] = {
    { "smallest_angle", VG_VTU_CELL, VG_VTU_FLOAT64, 1, NULL },
    { "radius_ratio", VG_VTU_CELL, VG_VTU_FLOAT64, 1, NULL },
    { "distance", VG_VTU_CELL, VG_VTU_FLOAT64, 1, f->face }
  };
  vg_status st;

  if (!a->vtu) return VG_OK;
  if (m->n_quad)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: only the quality of triangles can be "
                   "written, but %s has quadrilaterals",
                   a->vtu, a->file);
  angle = vg_alloc(2 * m->n_tri, sizeof *angle);
  if (!angle) return vg_fail_memory(err, "the angles");
  vg_surface_shapes(m, angle, angle + m->n_tri);
  field[0].data = angle;
  field[1].data = angle + m->n_tri;
  vg_display_end_at_once(0);
  st = vg_vtu_write_boundary(a->vtu, m, field, f->face ? 3 : 2, err);
  if (st >= 0 && !a->json) printf("  quality of the triangles: %s\n", a->vtu);
  free(angle);
  return st;
}

static vg_status write_defects(const struct vg_check_surface *a,
                               const struct vg_mesh *m,
                               const struct vg_surface_report *r,
                               struct vg_error *err)
{
  vg_status st;

  if (!a->defects || !r->n_defect) return VG_OK;
  vg_display_end_at_once(0);
  st = vg_write_defects(a->defects, m, r, err);
  if (st >= 0 && !a->json) printf("  all faces with defects: %s\n", a->defects);
  return st;
}

/* Whether vanguard mesh adds a farfield to this surface. */
static int adds_farfield(const struct vg_boundary *b)
{
  return b->flow.kind == VG_FLOW_EXTERNAL &&
         b->read->settings.farfield.kind != VG_DOMAIN_NONE;
}

static void print_json(const struct vg_check_surface *a,
                       const struct vg_boundary *b, const struct findings *f,
                       const json_t *body, vg_status st,
                       const struct vg_error *err)
{
  json_t *o = json_pack(
    "{s:s s:o s:b s:o s:O s:o s:o s:o s:o}", "vanguard", VG_VERSION, "file",
    vg_text_json(a->file), "ok", st >= 0, "flow",
    vg_report_flow_json(&b->flow, adds_farfield(b)), "surface", body, "remesh",
    vg_report_remesh_json(&b->remeshing, &b->surface), "notes",
    vg_report_notes_json(b->notes), "lines",
    f->has_lines ? vg_report_lines_json(&f->lines, a->has_deck) : json_null(),
    "against",
    a->against ? vg_report_distances_json(a->against, f->off) : json_null());

  *a->written = 1;
  if (st < 0) vg_report_error_json(o, err);
  json_object_set_new(o, "patches", vg_report_patches_json(&b->surface));
  json_object_set_new(o, "size", vg_report_size_json(&b->surface));
  json_dumpf(o, stdout, JSON_INDENT(2));
  printf("\n");
  json_decref(o);
}

/* The walls of a section, without the triangles of their strip. */
static void print_section(const struct vg_boundary *b)
{
  const struct vg_mesh *m = &b->surface;
  double lo[3], hi[3];

  vg_mesh_bounds(m, lo, hi);
  printf("\nSection\n  bounding box             %g %g to %g %g\n", lo[0], lo[1],
         hi[0], hi[1]);
  printf("  %12s  %12s  %12s  element\n", "edges", "shortest", "longest");
  for (size_t i = 0, t = 0; i < m->n_patch; i++) {
    double least = INFINITY, most = 0;
    char name[VG_NAME_MAX];
    size_t n = 0;

    /* Two triangles on each edge; the first one begins with its ends. */
    for (; t < m->n_tri && m->tri_patch[t] == i; t += 2, n++) {
      const double *p = m->point[m->tri[t][0]], *q = m->point[m->tri[t][1]];
      const double length = sqrt((q[0] - p[0]) * (q[0] - p[0]) +
                                 (q[1] - p[1]) * (q[1] - p[1]));

      least = fmin(least, length);
      most = fmax(most, length);
    }
    printf("  %12zu  %12.4g  %12.4g  %s\n", n, least, most,
           vg_text_clean(m->patch[i].name, name, sizeof name));
  }
}

static vg_status print_text(const struct vg_check_surface *a,
                            const struct vg_boundary *b,
                            const struct findings *f, struct vg_error *err)
{
  vg_status st;

  printf("%s: %s\n\n", a->file,
         b->read->is_section ? "plane section" : "surface");
  vg_report_flow_text(stdout, &b->flow, adds_farfield(b));
  for (size_t i = 0; i < b->notes->n; i++)
    printf("  note: %s\n", b->notes->text[i]);
  if (b->read->is_section) {
    print_section(b);
    return VG_OK;
  }
  printf("\nSurface\n");
  vg_report_size_text(stdout, &b->surface);
  VG_TRY(vg_report_patches_text(stdout, &b->surface, err));
  vg_report_remesh_text(stdout, &b->remeshing);
  vg_report_surface_text(stdout, &b->surface, &b->check, b->read->unit,
                         vg_boundary_is_stretched(b), VG_SHOWN_DEFECTS);
  if (f->has_lines) vg_report_lines_text(stdout, &f->lines, a->has_deck);
  if (a->against) vg_report_distances_text(stdout, a->against, f->off);
  if (!b->check.n_defect)
    printf("  no defects%s\n",
           b->inner.n_tri ? " without the inner surfaces" : "");
done:
  return st;
}

/* Examine the surface itself, before the domain is completed. */
static vg_status examine(const struct vg_check_surface *a,
                         struct vg_boundary *b, struct findings *f,
                         struct vg_display *show, struct vg_error *err)
{
  vg_status st;

  VG_TRY(trace_curves(b, f, err));
  VG_TRY(compare(a, &b->surface, f, err));
  vg_display_clear(show);
  if (!a->json) VG_TRY(print_text(a, b, f, err));
  VG_TRY(write_defects(a, &b->surface, &b->check, err));
  VG_TRY(write_vtu(a, &b->surface, f, err));
done:
  return st;
}

/* The remaining steps of vanguard mesh before it generates cells. */
static vg_status finish(struct vg_boundary *b, struct vg_display *show,
                        struct vg_error *err)
{
  struct vg_layer_stage layers = { 0 };
  vg_status st;

  VG_TRY(vg_boundary_close(b, show, err));
  st = vg_layer_stage_plan(&layers, b, err);
done:
  vg_layer_stage_release(&layers);
  return st;
}

static json_t *body_of(const struct vg_boundary *b)
{
  return b->read->is_section
         ? vg_report_defects_json(&b->surface, &b->check, b->read->unit,
                                  VG_LISTED_DEFECTS)
         : vg_report_surface_json(&b->surface, &b->check, b->read->unit,
                                  VG_LISTED_DEFECTS);
}

/* Defects that are found only when the surface is closed, as of inner surfaces
 * or next to an added boundary. They replace *body. */
static vg_status examine_closed(const struct vg_check_surface *a,
                                const struct vg_boundary *b, json_t **body,
                                struct vg_error *err)
{
  json_decref(*body);
  *body = body_of(b);
  if (!a->json) {
    printf("\nClosed surface\n");
    vg_report_surface_text(stdout, &b->surface, &b->check, b->read->unit,
                           vg_boundary_is_stretched(b), VG_SHOWN_DEFECTS);
  }
  return write_defects(a, &b->surface, &b->check, err);
}

/* The last line for a surface that vanguard mesh accepts, and why defects that
 * were listed do not prevent it. */
static void print_accepted(const char *what, const struct vg_flow *f,
                           size_t n_open, size_t n_defect)
{
  int closes = n_open && f->kind == VG_FLOW_EXTERNAL && f->axis >= 0;

  printf("  vanguard mesh accepts this %s", what);
  if (closes)
    printf(": the symmetry plane %c = %g closes its %zu open edges",
           "xyz"[f->axis], f -> at, n_open);
  if (n_defect > (closes ? n_open : 0))
    printf("%s the %sdefects listed are those of the input, and are removed "
           "before it is meshed",
           closes ? ";" : ":", closes ? "other " : "");
  printf("\n");
}

vg_status vg_check_surface(const struct vg_check_surface *a,
                           struct vg_problem *p, struct vg_display *show,
                           struct vg_error *err)
{
  const struct vg_shape_options o = { .threads = (int)p->asked.threads };
  struct vg_boundary *b = &p->boundary;
  struct vg_error why = VG_ERROR_INIT;
  struct findings f = { 0 };
  json_t *body = NULL;
  size_t n_note, n_open, n_defect, n_tri;
  vg_status st = vg_boundary_shape(&p->read, &o, show, b, &why), shape = st;

  if (st < 0 && !b->check.face_kinds) {
    st = vg_fail(err, st, "%s", why.text);
    goto done;
  }
  VG_TRY(examine(a, b, &f, show, err));
  body = body_of(b);
  n_note = p->notes.n;
  n_open = b->check.count[VG_DEFECT_OPEN_EDGE];
  n_defect = b->check.n_defect;
  n_tri = b->surface.n_tri;
  if (shape >= 0) shape = finish(b, show, &why);
  vg_problem_note_unused(p, 0, 1u << VG_USE_VOLUME);
  vg_display_clear(show);
  for (size_t i = n_note; !a->json && i < p->notes.n; i++)
    printf("  note: %s\n", p->notes.text[i]);
  if (shape < 0 && b->check.n_defect && b->surface.n_tri != n_tri)
    VG_TRY(examine_closed(a, b, &body, err));
  if (a->json) print_json(a, b, &f, body, shape, &why);
  if (shape < 0) st = vg_fail(err, shape, "%s", why.text);
  else if (!a->json)
    print_accepted(p->read.is_section ? "section" : "surface", &b->flow, n_open,
                   n_defect);
done:
  json_decref(body);
  release(&f);
  return st;
}
