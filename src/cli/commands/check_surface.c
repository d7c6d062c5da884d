#include "cli/commands/check_surface.h"

#include <stdlib.h>

#include "base/memory.h"
#include "core/surface/surface_quality.h"
#include "io/mesh/format.h"
#include "io/mesh/vtu.h"
#include "run/common/text.h"
#include "run/report/report.h"

/* What is found out. */
struct findings {
  struct vg_surface_report r;
  int external, is_half;
  int has_lines;            /* lines, of a surface without other defects */
  struct vg_remesh_report lines;
  struct vg_mesh other;     /* of `against` */
  struct vg_remesh_distance off[2];  /* from it, it from this */
  double *face;             /* [n_tri] of the first, or NULL */
};

static void release(struct findings *f)
{
  vg_surface_report_release(&f->r);
  vg_remesh_report_release(&f->lines);
  vg_mesh_release(&f->other);
  free(f->face);
}

/* Its lines can be followed: no edge has three faces. */
static int can_be_followed(const struct vg_mesh *m,
                           const struct vg_surface_report *r)
{
  return m->n_tri && !m->n_quad &&
         r->count[VG_DEFECT_OPEN_EDGE] == r->n_defect;
}

/* A surface may be sound and yet beyond what can be asked for on it. */
static vg_status look_at_lines(const struct vg_settings *s,
                               const struct vg_mesh *m, struct findings *f,
                               struct vg_notes *notes, struct vg_error *err)
{
  struct vg_remesh_options o = vg_remesh_options_of(s);
  struct vg_error why = VG_ERROR_INIT;
  vg_status st;

  if (!can_be_followed(m, &f->r)) return VG_OK;
  o.threads = 0;
  st = vg_remesh_judge(m, &o, &f->lines, &why);
  f->has_lines = st >= 0;
  if (st == VG_ERR_MEMORY) return vg_fail_memory(err, "the lines");
  if (st < 0) vg_note(notes, "lines were not looked at: %s", why.text);
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
    VG_TRY(vg_fail(err, VG_ERR_INPUT, "%s: distances are measured between "
                   "triangles; a surface here has quadrilaterals",
                   a->against));
  f->face = vg_alloc(m->n_tri, sizeof *f->face);
  if (!f->face) VG_TRY(vg_fail_memory(err, "the distances"));
  VG_TRY(vg_remesh_measure(m, &f->other, 0, NULL, f->face, f->off,
                           err));
done:
  return st;
}

/* Arrays of triangles alone are written: quadrilaterals have no angles. */
static vg_status write_vtu(const struct vg_check_surface *a,
                           const struct vg_mesh *m, const struct findings *f,
                           struct vg_error *err)
{
  double *angle;
  struct vg_vtu_field field[3] = {
    { "smallest_angle", VG_VTU_CELL, VG_VTU_FLOAT64, 1, NULL },
    { "radius_ratio", VG_VTU_CELL, VG_VTU_FLOAT64, 1, NULL },
    { "distance", VG_VTU_CELL, VG_VTU_FLOAT64, 1, f->face } };
  vg_status st;

  if (!a->vtu) return VG_OK;
  if (m->n_quad)
    return vg_fail(err, VG_ERR_INPUT, "%s: the quality of triangles is "
                   "written; %s has quadrilaterals", a->vtu, a->file);
  angle = vg_alloc(2 * m->n_tri, sizeof *angle);
  if (!angle) return vg_fail_memory(err, "the angles");
  vg_surface_shapes(m, angle, angle + m->n_tri);
  field[0].data = angle;
  field[1].data = angle + m->n_tri;
  vg_display_end_at_once(0);
  st = vg_vtu_write_boundary(a->vtu, m, field, f->face ? 3 : 2, err);
  if (st >= 0 && !a->json)
    printf("  quality of each triangle: %s\n", a->vtu);
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
  if (st >= 0 && !a->json)
    printf("  all faces with a defect: %s\n", a->defects);
  return st;
}

static json_t *notes_json(const struct vg_notes *notes)
{
  json_t *list = json_array();

  for (size_t i = 0; i < notes->n; i++)
    json_array_append_new(list, vg_text_json(notes->text[i]));
  return list;
}

static void print_json(const struct vg_check_surface *a,
                       const struct vg_mesh *m, const struct findings *f,
                       const struct vg_notes *notes)
{
  json_t *o = json_pack("{s:o s:b s:s s:o s:o s:o s:o s:o s:o}", "file",
    vg_text_json(a->file), "ok", f->is_half || !f->r.n_defect, "taken_as",
    f->is_half ? "half" : f->external ? "bodies" : "domain", "size",
    vg_report_size_json(m), "patches", vg_report_patches_json(m), "notes",
    notes_json(notes), "surface",
    vg_report_surface_json(m, &f->r, VG_SHOWN_DEFECTS), "lines",
    f->has_lines ? vg_report_lines_json(&f->lines, a->has_deck) : json_null(),
    "against", a->against ? vg_report_distances_json(a->against, f->off)
                          : json_null());

  json_dumpf(o, stdout, JSON_INDENT(2));
  printf("\n");
  json_decref(o);
}

static vg_status print_text(const struct vg_check_surface *a,
                            const struct vg_mesh *m, const struct findings *f,
                            const struct vg_notes *notes, struct vg_error *err)
{
  vg_status st;

  printf("%s: surface, %s\n", a->file,
         f->is_half ? "taken as half of bodies in a fluid around them"
         : f->external ? "taken as bodies in a fluid around them"
         : "taken as the boundary of a fluid inside it");
  vg_report_size_text(stdout, m);
  VG_TRY(vg_report_patches_text(stdout, m, err));
  vg_report_surface_text(stdout, m, &f->r,
                         f->is_half ? 0 : VG_SHOWN_DEFECTS);
  if (f->has_lines) vg_report_lines_text(stdout, &f->lines, a->has_deck);
  if (a->against) vg_report_distances_text(stdout, a->against, f->off);
  for (size_t i = 0; i < notes->n; i++)
    printf("  note: %s\n", notes->text[i]);
  if (!f->r.n_defect) printf("  no defects\n");
done:
  return st;
}

vg_status vg_check_surface(const struct vg_check_surface *a,
                           const struct vg_settings *s, struct vg_mesh *m,
                           struct vg_notes *notes, struct vg_error *err)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct findings f = { .external = -1 };
  vg_status st;

  o.require_bc = vg_surface_has_conditions(m);
  VG_TRY(vg_surface_examine(m, &o, &f.external, &f.r, notes, err));
  if (f.external) VG_TRY(vg_surface_half(m, &f.r, notes, &f.is_half, err));
  VG_TRY(look_at_lines(s, m, &f, notes, err));
  VG_TRY(compare(a, m, &f, err));
  if (a->json) print_json(a, m, &f, notes);
  else VG_TRY(print_text(a, m, &f, notes, err));
  VG_TRY(write_defects(a, m, &f.r, err));
  VG_TRY(write_vtu(a, m, &f, err));
  if (f.r.n_defect && !f.is_half)
    st = vg_fail(err, VG_ERR_GEOMETRY, "%s: the surface has %zu defects",
                 a->file, f.r.n_defect);
  else if (!m->n_tri)
    st = vg_fail(err, VG_ERR_GEOMETRY, "%s: no surface is left: all its "
                 "triangles are degenerate", a->file);
done:
  release(&f);
  return st;
}
