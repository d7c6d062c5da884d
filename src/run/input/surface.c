/* From triangles as read to the closed boundary of a fluid. Declared in
 * run/input/input.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/vtu.h"
#include "io/stream/convention.h"
#include "run/input/shape_parts.h"
#include "run/input/sizes.h"
#include "run/settings/deck.h"

#define SHOWN_PATCHES 20   /* numbers in a note */
#define ROUNDING 1e-9      /* S62: of the length: gaps between rims that are
                              rounding of coordinates */

int vg_surface_has_conditions(const struct vg_mesh *m)
{
  for (size_t i = 0; i < m->n_patch; i++)
    if (m->patch[i].bc != VG_BC_NONE) return 1;
  return 0;
}

/* The fill takes triangles only. */
static vg_status split_quads(struct vg_mesh *m, struct vg_notes *notes,
                             struct vg_error *err)
{
  size_t n = m->n_tri + 2 * m->n_quad;
  uint32_t (*tri)[3], *patch;

  if (!m->n_quad) return VG_OK;
  tri = vg_realloc(m->tri, n, sizeof *tri);
  if (tri) m->tri = tri;
  patch = vg_realloc(m->tri_patch, n, sizeof *patch);
  if (patch) m->tri_patch = patch;
  if (!tri || !patch) return vg_fail_memory(err, "the surface");
  for (size_t i = 0; i < m->n_quad; i++) {
    const uint32_t *q = m->quad[i];
    const uint32_t half[2][3] = { { q[0], q[1], q[2] }, { q[0], q[2], q[3] } };

    memcpy(tri + m->n_tri, half, sizeof half);
    patch[m->n_tri] = patch[m->n_tri + 1] = m->quad_patch[i];
    m->n_tri += 2;
  }
  vg_note(notes, "%zu quadrilaterals of the surface were split into "
          "triangles", m->n_quad);
  free(m->quad);
  free(m->quad_patch);
  m->quad = NULL;
  m->quad_patch = NULL;
  m->n_quad = 0;
  return VG_OK;
}

/* Notes on triangles that the repair removed: the next check finds none. */
static void note_removed(struct vg_problem *p)
{
  if (p->check.n_removed_wall)
    vg_note(&p->notes, "%zu triangles of walls that touching bodies shared "
            "were removed, so that the bodies have one skin",
            p->check.n_removed_wall);
  if (p->check.n_removed_tri)
    vg_note(&p->notes, "%zu duplicate or degenerate triangles were removed",
            p->check.n_removed_tri);
}

/* external: as in vg_surface_check_options. */
static vg_status check(struct vg_problem *p, int external,
                       struct vg_display *show, struct vg_error *err)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  vg_status st;

  o.repair = p->settings.repair;
  o.require_bc = p->require_bc;
  o.external = external;
  o.threads = p->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  vg_display_update(show, "check", p->surface.n_tri, 0);
  st = vg_surface_check(&p->surface, &o, &p->check, err);
  if (st >= 0) note_removed(p);
  return st;
}

static vg_status defects(const struct vg_problem *p, struct vg_display *show,
                         struct vg_error *err)
{
  char remedy[120];

  if (!p->check.n_defect && !p->surface.n_tri)
    return vg_fail(err, VG_ERR_GEOMETRY, "%s: no surface is left: all its "
                   "triangles are degenerate", p->files.stem);
  if (!p->check.n_defect) return VG_OK;
  vg_problem_suggest_wrap(p, show, remedy, sizeof remedy);
  return vg_fail(err, VG_ERR_GEOMETRY, "%s: the surface has %zu defects and "
                 "cannot bound a mesh%s", p->files.stem, p->check.n_defect,
                 remedy);
}

/* Names and conditions of the patches as they are now, for the resolved
 * settings; what is added later comes by itself when the run is repeated. */
static vg_status resolve_patches(struct vg_problem *p, struct vg_error *err)
{
  struct vg_settings *s = &p->settings, old = *s;
  vg_status st;

  s->patch = NULL;
  s->n_patch = s->cap_patch = 0;
  st = vg_deck_patches_of(&p->surface, s, err);
  for (size_t i = 0; i < old.n_patch && st >= 0; i++) {
    size_t at = vg_mesh_find_patch(&p->surface, old.patch[i].id);

    if (at != SIZE_MAX) s->patch[at].hard = old.patch[i].hard;
  }
  free(old.patch);
  return st;
}

void vg_problem_note_unset(struct vg_problem *p)
{
  char list[12 * SHOWN_PATCHES + 8] = "";
  size_t n = 0, at = 0;
  uint8_t *has_faces = vg_calloc(p->surface.n_patch, 1);

  if (!has_faces) return;   /* as a note for which there is no memory */
  for (size_t i = 0; i < p->surface.n_tri; i++)
    has_faces[p->surface.tri_patch[i]] = 1;
  for (size_t i = 0; i < p->surface.n_patch; i++) {
    const struct vg_patch *patch = &p->surface.patch[i];

    if (patch->bc != VG_BC_NONE || patch->bc_fun3d != VG_BC_NONE
        || !has_faces[i]) continue;
    if (n++ < SHOWN_PATCHES)
      at += (size_t)snprintf(list + at, sizeof list - at, " %d",
                             (int)patch->id);
  }
  if (n)
    vg_note(&p->notes, "%zu patch%s no boundary condition (number%s%s), "
            "written as inviscid (5, FUN3D 3000): give conditions in a .mapbc "
            "file or the deck", n, n > 1 ? "es have" : " has", list,
            n > SHOWN_PATCHES ? " ..." : "");
  free(has_faces);
}

static vg_status close_holes(struct vg_problem *p, struct vg_error *err)
{
  struct vg_sizing_options options = vg_problem_sizing(p);
  struct vg_sizing *sizing = NULL;
  size_t n_hole, n_tri;
  vg_status st;

  options.threads = p->threads;
  VG_TRY(vg_sizing_new(&options, p->settings.n_source, p->settings.source,
                       &p->surface, &sizing, err));
  VG_TRY(vg_domain_close_holes(&p->surface,
                               vg_settings_farfield(&p->settings).symmetry,
                               sizing, &n_hole, &n_tri, err));
  if (n_hole)
    vg_note(&p->notes, "holes of the surface that were closed (close_holes): "
            "%zu, with %zu triangles in patches %d to %d, named cap_1 to "
            "cap_%zu", n_hole, n_tri,
            (int)p->surface.patch[p->n_given_patch].id,
            (int)p->surface.patch[p->surface.n_patch - 1].id, n_hole);
done:
  vg_sizing_free(sizing);
  return st;
}

/* Bodies are wrapped; outer boundaries stay as they are. */
static vg_status wrap(struct vg_problem *p, struct vg_display *show,
                      struct vg_error *err)
{
  const struct vg_flow_options o = vg_problem_flow_options(p, show);
  uint8_t *outer = NULL;
  size_t n = 0;
  vg_status st;

  outer = vg_alloc(p->surface.n_tri, 1);
  if (!outer) VG_TRY(vg_fail_memory(err, "the outer boundary"));
  VG_TRY(vg_flow_outer(&p->surface, &p->check, &o, outer, &n, err));
  VG_TRY(vg_problem_wrap(p, n ? outer : NULL, show, err));
done:
  free(outer);
  return st;
}

/* Rims that coincide but for rounding are welded; for wider gaps the refusal
 * of an open surface names the tolerance. */
static vg_status weld_rims(struct vg_problem *p, struct vg_display *show,
                           struct vg_error *err)
{
  double lo[3], hi[3], length = 0;
  size_t n_edge, n_point = 0;
  vg_status st = VG_OK;

  p->rim_gap = 0;
  if (!p->check.count[VG_DEFECT_OPEN_EDGE] || !p->settings.repair)
    return VG_OK;
  VG_TRY(vg_surface_rim_gap(&p->surface, &p->check, &p->rim_gap, &n_edge, err));
  vg_mesh_bounds(&p->surface, lo, hi);
  for (int k = 0; k < 3; k++) length = fmax(length, hi[k] - lo[k]);
  if (!(p->rim_gap > 0)) goto done;
  VG_TRY(vg_surface_weld_rims(&p->surface, ROUNDING * length, &n_point, &n_edge,
                              err));
  if (!n_point) goto done;
  vg_note(&p->notes, "%zu open edges coincide with others but for rounding: "
          "they were welded, %zu points merged", n_edge, n_point);
  VG_TRY(check(p, -1, show, err));
  VG_TRY(vg_surface_rim_gap(&p->surface, &p->check, &p->rim_gap, &n_edge, err));
done:
  return st;
}

/* Close the surface as far as settings ask for it, and check it. */
static vg_status close_surface(struct vg_problem *p, struct vg_display *show,
                               struct vg_error *err)
{
  const struct vg_settings *s = &p->settings;
  vg_status st = VG_OK;

  if (s->weld > 0)
    VG_TRY(vg_surface_weld(&p->surface, s->weld, &p->n_welded, &p->n_dropped,
                           err));
  VG_TRY(check(p, -1, show, err));
  VG_TRY(weld_rims(p, show, err));
  if (s->close_holes && p->check.count[VG_DEFECT_OPEN_EDGE]) {
    /* Rims are followed along triangles that agree, as the check left them. */
    p->n_given_patch = p->surface.n_patch;
    VG_TRY(close_holes(p, err));
    VG_TRY(vg_problem_patch_table(p, 1, err));
    VG_TRY(resolve_patches(p, err));
    VG_TRY(check(p, -1, show, err));
  }
  if (!(s->wrap > 0)) goto done;
  VG_TRY(wrap(p, show, err));
  VG_TRY(check(p, -1, show, err));
done:
  return st;
}

/* Defects that the remesher tolerates, since the new surface is judged. Edges
 * of four triangles are tolerated where triangles lie back to back. */
int vg_surface_is_reference(const struct vg_surface_report *r)
{
  const size_t n_double = r->count[VG_DEFECT_DUPLICATE_TRIANGLE];

  return r->n_defect == r->count[VG_DEFECT_OPEN_EDGE]
                        + r->count[VG_DEFECT_INTERSECTION]
                        + r->count[VG_DEFECT_DEGENERATE_TRIANGLE]
                        + r->count[VG_DEFECT_SHELL] + n_double
                        + (n_double ? r->count[VG_DEFECT_NONMANIFOLD_EDGE] : 0);
}

/* Remeshed by another rank, which has the CAD model. */
static int is_made_elsewhere(const struct vg_problem *p)
{
  return p->is_read && !p->model.cad;
}

/* Open, and no half model; vanguard surface takes it as it is. */
static int is_open_for_good(const struct vg_problem *p)
{
  const size_t *n = p->check.count;

  return !p->surface_only && p->flow.axis < 0 && n[VG_DEFECT_OPEN_EDGE]
         && !n[VG_DEFECT_NONMANIFOLD_EDGE] && !n[VG_DEFECT_ORIENTATION];
}

/* One tessellation of the surface: closed, decided, remeshed. */
static vg_status shape(struct vg_problem *p, struct vg_display *show,
                       struct vg_error *err)
{
  const int is_renewed = p->settings.remesh == VG_ANSWER_YES;
  struct vg_error why = VG_ERROR_INIT;
  char remedy[120] = "";
  vg_status st;

  VG_TRY(split_quads(&p->surface, &p->notes, err));
  VG_TRY(resolve_patches(p, err));
  VG_TRY(close_surface(p, show, err));
  if (!p->surface.n_tri) return defects(p, show, err);
  VG_TRY(vg_problem_decide(p, show, err));
  if (!p->check.n_defect || vg_is_only_open(&p->check))
    VG_TRY(vg_problem_gaps(p, show, err));
  if (is_open_for_good(p)) return vg_problem_refuse_open(p, show, err);
  if (!is_renewed || is_made_elsewhere(p)) goto done;
  if (!vg_surface_is_reference(&p->check)) return defects(p, show, err);
  st = vg_problem_renew(p, show, &why);
  if (st < 0) {
    if (st == VG_ERR_GEOMETRY)
      vg_problem_suggest_wrap(p, show, remedy, sizeof remedy);
    st = vg_fail(err, st, "%s: %s%s", p->files.stem, why.text, remedy);
  }
done:
  return st;
}

/* State of the problem before the first tessellation, for the next one. */
struct given {
  int flow, half, farfield;
  size_t n_note, n_patch;
  struct vg_patch *patch;   /* [n_patch] owned */
};

static vg_status take_given(const struct vg_problem *p, struct given *g,
                            struct vg_error *err)
{
  *g = (struct given){ p->settings.flow, p->settings.half,
    p->settings.farfield.kind, p->notes.n, p->surface.n_patch, NULL };
  g->patch = vg_alloc(g->n_patch, sizeof *g->patch);
  if (!g->patch) return vg_fail_memory(err, "the patches");
  if (g->n_patch)
    memcpy(g->patch, p->surface.patch, g->n_patch * sizeof *g->patch);
  return VG_OK;
}

static void put_back_given(struct vg_problem *p, const struct given *g)
{
  p->settings.flow = g->flow;
  p->settings.half = g->half;
  p->settings.farfield.kind = g->farfield;
  p->n_given_patch = 0;
  vg_flow_release(&p->flow);
}

vg_status vg_problem_shape(struct vg_problem *p, struct vg_display *show,
                           struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  struct given g = { .patch = NULL };
  vg_status st, next;

  vg_mesh_keep_boundary(&p->surface);
  p->require_bc = vg_surface_has_conditions(&p->surface);
  vg_problem_note_slivers(p);
  p->settings.remesh = vg_problem_is_renewed(p) ? VG_ANSWER_YES
                                                : VG_ANSWER_NO;
  VG_TRY(take_given(p, &g, err));
  st = shape(p, show, &why);
  for (size_t i = 0; st == VG_ERR_GEOMETRY && !is_open_for_good(p); i++) {
    struct vg_error again = VG_ERROR_INIT;

    next = vg_problem_tessellate(p, i, g.patch, g.n_patch, g.n_note,
                                 show, &again);
    if (next == VG_BLOCKED) break;
    if (next < 0) {
      st = vg_fail(err, next, "%s", again.text);
      goto done;
    }
    put_back_given(p, &g);
    st = shape(p, show, &again);
    if (st < 0 && st != VG_ERR_GEOMETRY) why = again;
  }
  if (st < 0) *err = why;
  p->is_shaped = st >= 0;
done:
  free(g.patch);
  /* the library's message says less */
  return st == VG_ERR_STOPPED ? vg_display_stopped(show, err) : st;
}

/* Add farfield and symmetry plane, and check the whole boundary. */
static vg_status complete(struct vg_problem *p, struct vg_display *show,
                          struct vg_error *err)
{
  vg_status st;

  vg_display_update(show, "farfield", 0, 0);
  VG_TRY(vg_problem_complete(p, show, err));
  VG_TRY(check(p, 0, show, err));
  VG_TRY(defects(p, show, err));
done:
  return st;
}

vg_status vg_problem_close(struct vg_problem *p, struct vg_display *show,
                           struct vg_error *err)
{
  int is_open;
  vg_status st = VG_OK;

  if (!p->is_shaped) VG_TRY(vg_problem_shape(p, show, err));
  if (p->renewal.is_done)
    VG_TRY(check(p, p->flow.kind == VG_FLOW_UNKNOWN ? -1
                    : p->flow.kind == VG_FLOW_EXTERNAL, show, err));
  is_open = vg_is_only_open(&p->check);
  if (p->surface_only && (!p->check.n_defect || is_open)) return VG_OK;
  if (is_open && p->flow.axis < 0)
    st = vg_problem_refuse_open(p, show, err);
  else if (p->check.n_defect && !is_open)
    st = defects(p, show, err);
  else if (p->flow.kind == VG_FLOW_EXTERNAL || is_open)
    st = complete(p, show, err);
  else
    st = defects(p, show, err);
done:
  return st == VG_ERR_STOPPED ? vg_display_stopped(show, err) : st;
}

/* Face f of the report as one or two triangles (quadrilaterals come after
 * the triangles). */
static size_t face_triangles(const struct vg_mesh *m, size_t f,
                             uint32_t out[2][3])
{
  const uint32_t *q;

  if (f < m->n_tri) {
    memcpy(out[0], m->tri[f], sizeof out[0]);
    return 1;
  }
  q = m->quad[f - m->n_tri];
  for (int k = 0; k < 3; k++) {
    out[0][k] = q[k];
    out[1][k] = q[k ? k + 1 : 0];
  }
  return 2;
}

vg_status vg_write_defects(const char *path, const struct vg_mesh *m,
                           const struct vg_surface_report *r,
                           struct vg_error *err)
{
  size_t room = 4 * r->n_defect, n = 0;
  uint32_t (*tri)[3] = vg_alloc(room, sizeof *tri);
  int32_t *kind = vg_alloc(room, sizeof *kind);
  int32_t *patch = vg_alloc(room, sizeof *patch);
  vg_status st = VG_OK;

  if (!tri || !kind || !patch) {
    st = vg_fail_memory(err, "the list of defects");
    goto done;
  }
  for (size_t i = 0; i < r->n_defect; i++)
    for (int k = 0; k < 2; k++) {
      size_t f = r->defect[i].face[k], count;

      if (f == SIZE_MAX) continue;
      count = face_triangles(m, f, tri + n);
      for (; count; count--, n++) {
        kind[n] = (int32_t)r->defect[i].kind;
        patch[n] = m->patch[f < m->n_tri ? m->tri_patch[f]
                                         : m->quad_patch[f - m->n_tri]].id;
      }
    }
  {
    const struct vg_vtu_field field[] = {
      { "defect", VG_VTU_CELL, VG_VTU_INT32, 1, kind },
      { "patch", VG_VTU_CELL, VG_VTU_INT32, 1, patch },
    };

    st = vg_vtu_write_triangles(path, m->n_point,
                                (const double (*)[3])m->point, n,
                                (const uint32_t (*)[3])tri, field, 2, err);
  }
done:
  free(tri);
  free(kind);
  free(patch);
  return st;
}
