/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* From the triangles read to the closed boundary of a fluid. Declared in
 * run/input/input.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/vtu.h"
#include "io/stream/convention.h"
#include "io/vgrid/mapbc.h"
#include "run/input/shape_parts.h"
#include "run/input/sizes.h"
#include "run/input/zone_table.h"
#include "run/settings/deck.h"
#include "run/settings/patch_names.h"
#include "run/settings/plan_options.h"

/* Smallest side of the box of a surface: seven orders of magnitude remain for
 * edges whose squares are normal numbers in single precision. */
#define EXTENT_MIN 1e-10
#define SHOWN_PATCHES 20 /* Most patch numbers in a note. */
/* S62: share of the length below which gaps between rims are due to the
 * rounding of coordinates. */
#define ROUNDING 1e-9

/* Whether any patch has a condition; all patches should have one then. */
static int has_conditions(const struct vg_mesh *m)
{
  for (size_t i = 0; i < m->n_patch; i++)
    if (m->patch[i].bc != VG_BC_NONE) return 1;
  return 0;
}

static int is_unset(const struct vg_patch *p)
{
  return p->bc == VG_BC_NONE && p->bc_fun3d == VG_BC_NONE;
}

vg_status vg_split_quads(struct vg_mesh *m, struct vg_error *err)
{
  size_t n = m->n_tri + 2 * m->n_quad;
  uint32_t(*tri)[3], *patch;

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
  free(m->quad);
  free(m->quad_patch);
  m->quad = NULL;
  m->quad_patch = NULL;
  m->n_quad = 0;
  return VG_OK;
}

/* The kernel accepts only triangles. */
static vg_status split_quads(struct vg_mesh *m, struct vg_notes *notes,
                             struct vg_error *err)
{
  const size_t n = m->n_quad;
  vg_status st = vg_split_quads(m, err);

  if (st >= 0 && n)
    vg_note(notes,
            "%zu quadrilaterals of the surface were split into triangles", n);
  return st;
}

/* Notes on triangles that the repair turned or removed, since the next check no
 * longer finds them. */
static void note_repairs(struct vg_boundary *b, int external)
{
  if (b->check.n_flipped && external < 0)
    vg_note(b->notes,
            "%zu triangles were reversed for a consistent orientation",
            b->check.n_flipped);
  if (b->check.n_removed_wall)
    vg_note(b->notes,
            "%zu triangles of walls shared by touching bodies were removed, "
            "so that the bodies share one surface",
            b->check.n_removed_wall);
  if (b->check.n_removed_tri)
    vg_note(b->notes, "%zu duplicate or degenerate triangles were removed",
            b->check.n_removed_tri);
}

/* external, keeps_walls: as in vg_surface_check_options. */
static vg_status check_as(struct vg_boundary *b, int external, int keeps_walls,
                          struct vg_display *show, struct vg_error *err)
{
  struct vg_surface_check_options o = vg_options_check(&b->read->settings);
  vg_status st;

  o.require_bc = b->require_bc;
  o.external = external;
  o.keeps_walls = keeps_walls;
  o.threads = b->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  vg_display_update(show, "surface check", b->surface.n_tri, 0);
  st = vg_surface_check(&b->surface, &o, &b->check, err);
  if (st >= 0) note_repairs(b, external);
  return st;
}

static vg_status check(struct vg_boundary *b, int external,
                       struct vg_display *show, struct vg_error *err)
{
  return check_as(b, external, 0, show, err);
}

static vg_status defects(struct vg_boundary *b, struct vg_display *show,
                         struct vg_error *err)
{
  char remedy[200];

  if (!b->check.n_defect && !b->surface.n_tri)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "%s: no surface is left, because all its triangles are "
                   "degenerate; check the units and the weld tolerance",
                   b->read->files.stem);
  if (!b->check.n_defect) return VG_OK;
  vg_boundary_suggest_wrap(b, show, remedy, sizeof remedy);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "%s: the surface has %zu defects and "
                 "cannot bound a mesh%s",
                 b->read->files.stem, b->check.n_defect, remedy);
}

/* Takes the rows of the current patches; patches added later are added again
 * when the run is repeated. The n rows of `old` determine which borders are
 * fixed. */
static vg_status take_rows(struct vg_boundary *b, size_t n,
                           const struct vg_patch_row *old, struct vg_error *err)
{
  struct vg_settings view = VG_SETTINGS_INIT;
  vg_status st = vg_deck_patches_of(&b->surface, &view, err);

  if (st < 0) {
    vg_settings_release(&view);
    return st;
  }
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < view.n_patch; k++)
      if (view.patch[k].id == old[i].id) {
        view.patch[k].hard = old[i].hard;
        view.patch[k].role = old[i].role;
      }
  free(b->row);
  b->row = view.patch;
  b->n_row = view.n_patch;
  return VG_OK;
}

/* Inlets and outlets that the decided flow recognised by their names. Returns
 * their number. */
static size_t give_openings(struct vg_boundary *b)
{
  size_t n = 0;

  if (b->flow.kind != VG_FLOW_INTERNAL) return 0;
  for (size_t i = 0; i < b->surface.n_patch; i++) {
    struct vg_patch *patch = &b->surface.patch[i];
    const enum vg_flow_role role = vg_flow_role_of(patch);

    if (!is_unset(patch) || (role != VG_ROLE_INLET && role != VG_ROLE_OUTLET))
      continue;
    patch->bc = patch->family = role == VG_ROLE_INLET ? 1001 : 1002;
    patch->bc_fun3d = vg_bc_to_fun3d(patch->bc, -1);
    vg_note(b->notes,
            "patch %d (%s) has no boundary condition and is written as %s (%d, "
            "FUN3D %d) because of its name",
            (int)patch->id, patch->name,
            role == VG_ROLE_INLET ? "inflow" : "outflow", (int)patch->bc,
            (int)patch->bc_fun3d);
    n++;
  }
  return n;
}

/* A boundary on which some patches have conditions needs them on all. */
vg_status vg_boundary_finish_conditions(struct vg_boundary *b,
                                        struct vg_error *err)
{
  char list[12 * SHOWN_PATCHES + 8] = "";
  size_t n = 0, at = 0;
  const int is_partly_set = give_openings(b) > 0 ||
                            b->read->settings.n_periodic;
  uint8_t *has_faces;
  const vg_status st = vg_pairs_give_conditions(&b->read->settings, &b->surface,
                                                err);

  if (st < 0) return st;
  has_faces = vg_calloc(b->surface.n_patch, 1);
  if (!has_faces) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < b->surface.n_tri; i++)
    has_faces[b->surface.tri_patch[i]] = 1;
  for (size_t i = 0; i < b->surface.n_patch; i++) {
    struct vg_patch *patch = &b->surface.patch[i];

    if (!is_unset(patch) || !has_faces[i] || patch->is_sheet) continue;
    if (n++ < SHOWN_PATCHES)
      at += (size_t)snprintf(list + at, sizeof list - at, " %d",
                             (int)patch->id);
    /* An interface in the boundary is a wall of a zone without cells. */
    if (!is_partly_set && !patch->is_interface) continue;
    patch->bc = patch->family = 5;
    patch->bc_fun3d = 3000;
  }
  if (n)
    vg_note(b->notes,
            "%zu patch%s no boundary condition (number%s%s) and will be "
            "written as inviscid (5, FUN3D 3000): set conditions in a .mapbc "
            "file or in the deck",
            n, n > 1 ? "es have" : " has", list,
            n > SHOWN_PATCHES ? " ..." : "");
  free(has_faces);
  return VG_OK;
}

struct vg_sizing_options vg_boundary_sizing(const struct vg_boundary *b)
{
  return vg_options_sizing(&b->read->settings, b->map);
}

vg_status vg_boundary_add_caps(const struct vg_boundary *b, struct vg_mesh *m,
                               struct vg_cap_report *report,
                               struct vg_error *err)
{
  struct vg_sizing_options options = vg_boundary_sizing(b);
  struct vg_sizing *sizing = NULL;
  vg_status st;

  options.threads = b->threads;
  VG_TRY(vg_sizing_new(&options, b->read->settings.n_source,
                       b->read->settings.source, m, &sizing, err));
  VG_TRY(vg_domain_close_holes(m,
                               vg_options_farfield(&b->read->settings).symmetry,
                               sizing, report, err));
done:
  vg_sizing_free(sizing);
  return st;
}

static vg_status close_holes(struct vg_boundary *b, struct vg_error *err)
{
  struct vg_cap_report r;
  vg_status st;

  VG_TRY(vg_boundary_refuse_plane(b, err));
  VG_TRY(vg_boundary_add_caps(b, &b->surface, &r, err));
  if (r.n)
    vg_note(b->notes,
            "holes of the surface closed (close_holes): %zu, with %zu "
            "triangles in patches %d to %d, named cap_1 to cap_%zu",
            r.n, r.n_tri, (int)b->surface.patch[b->n_given_patch].id,
            (int)b->surface.patch[b->surface.n_patch - 1].id, r.n);
  if (r.n_curved)
    vg_note(b->notes,
            "caps on rims that lie in no plane, such as the common rim of two "
            "missing sides: %zu; check that the body is meant to end there",
            r.n_curved);
done:
  return st;
}

/* Bodies are wrapped; outer boundaries are kept. */
static vg_status wrap(struct vg_boundary *b, struct vg_display *show,
                      struct vg_error *err)
{
  const struct vg_flow_options o = vg_boundary_flow_options(b, show);
  uint8_t *outer = NULL;
  size_t n = 0;
  vg_status st;

  outer = vg_alloc(b->surface.n_tri, 1);
  if (!outer) VG_TRY(vg_fail_memory(err, "the outer boundary"));
  VG_TRY(vg_flow_outer(&b->surface, &b->check, &o, outer, &n, err));
  VG_TRY(vg_boundary_wrap(b, n ? outer : NULL, show, err));
done:
  free(outer);
  return st;
}

/* Welds rims that coincide except for rounding. For wider gaps, the error
 * message for an open surface names the tolerance. */
static vg_status weld_rims(struct vg_boundary *b, struct vg_display *show,
                           struct vg_error *err)
{
  size_t n_edge, n_point = 0;
  vg_status st = VG_OK;

  b->rim_gap = 0;
  if (!b->check.count[VG_DEFECT_OPEN_EDGE] || !b->read->settings.repair)
    return VG_OK;
  VG_TRY(vg_surface_rim_gap(&b->surface, &b->check, &b->rim_gap, &n_edge, err));
  if (!(b->rim_gap > 0)) goto done;
  VG_TRY(vg_surface_weld_rims(&b->surface,
                              ROUNDING * vg_mesh_length(&b->surface), &n_point,
                              &n_edge, err));
  if (!n_point) goto done;
  vg_note(b->notes,
          "%zu open edges coincide with others except for rounding: they were "
          "welded, and %zu points were merged",
          n_edge, n_point);
  VG_TRY(check(b, -1, show, err));
  VG_TRY(vg_surface_rim_gap(&b->surface, &b->check, &b->rim_gap, &n_edge, err));
done:
  return st;
}

/* Unites bodies that meet. Returns VG_BLOCKED, with nothing changed, if no
 * bodies can be united. */
static vg_status unite(struct vg_boundary *b, struct vg_display *show,
                       struct vg_error *err)
{
  vg_status st;

  if (!b->read->settings.repair || b->read->settings.wrap > 0 ||
      !b->check.n_defect)
    return VG_BLOCKED;
  VG_TRY(vg_boundary_unite(b, show, err));
  if (st == VG_OK) VG_TRY(check(b, -1, show, err));
done:
  return st;
}

/* Checks the surface. Walls shared as a whole by touching bodies are removed.
 * If that leaves defects, because bodies share parts of walls, too, they are
 * united with all their walls. */
static vg_status check_bodies(struct vg_boundary *b, struct vg_display *show,
                              struct vg_error *err)
{
  const size_t n_note = b->notes->n;
  struct vg_mesh whole = VG_MESH_INIT;
  vg_status st;

  VG_TRY(check_as(b, -1, 1, show, err));
  if (!b->check.count[VG_DEFECT_SHARED_WALL]) goto done;
  VG_TRY(vg_mesh_copy(&whole, &b->surface, err));
  VG_TRY(check(b, -1, show, err));
  if (!b->check.n_defect) goto done;
  while (b->notes->n > n_note) free(b->notes->text[--b->notes->n]);
  vg_mesh_move(&b->surface, &whole);
  VG_TRY(check_as(b, -1, 1, show, err));
  VG_TRY(unite(b, show, err));
  if (st == VG_BLOCKED) VG_TRY(check(b, -1, show, err));
done:
  vg_mesh_release(&whole);
  return st;
}

/* Closes the surface as far as the settings request it, and checks it. */
static vg_status close_surface(struct vg_boundary *b, struct vg_display *show,
                               struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  vg_status st = VG_OK;

  if (s->weld > 0)
    VG_TRY(
      vg_surface_weld(&b->surface, s->weld, &b->n_welded, &b->n_dropped, err));
  VG_TRY(check_bodies(b, show, err));
  VG_TRY(weld_rims(b, show, err));
  if (s->close_holes && b->check.count[VG_DEFECT_OPEN_EDGE]) {
    /* Rims are followed along consistently oriented triangles, as left by the
     * check. */
    b->n_given_patch = b->surface.n_patch;
    VG_TRY(close_holes(b, err));
    VG_TRY(vg_patch_table_apply(b->n_row, b->row, 0, &b->surface, err));
    VG_TRY(take_rows(b, b->n_row, b->row, err));
    VG_TRY(check(b, -1, show, err));
  }
  if (s->wrap > 0) {
    VG_TRY(wrap(b, show, err));
    VG_TRY(check(b, -1, show, err));
  } else {
    VG_TRY(unite(b, show, err));
    st = VG_OK;
  }
done:
  return st;
}

/* Whether the remesher tolerates all defects, since its result is checked.
 * Edges of four triangles are tolerated where triangles lie back to back. */
static int is_reference(const struct vg_surface_report *r)
{
  const size_t n_double = r->count[VG_DEFECT_DUPLICATE_TRIANGLE];

  return r->n_defect ==
         r->count[VG_DEFECT_OPEN_EDGE] + r->count[VG_DEFECT_INTERSECTION] +
           r->count[VG_DEFECT_DEGENERATE_TRIANGLE] + r->count[VG_DEFECT_SHELL] +
           n_double + (n_double ? r->count[VG_DEFECT_NONMANIFOLD_EDGE] : 0);
}

/* Whether the surface is open and not a half model. */
static int is_open_for_good(const struct vg_boundary *b,
                            const struct vg_shape_options *o)
{
  const size_t *n = b->check.count;

  return !o->remesh_open && b->flow.axis < 0 && n[VG_DEFECT_OPEN_EDGE] &&
         !n[VG_DEFECT_NONMANIFOLD_EDGE] && !n[VG_DEFECT_ORIENTATION];
}

/* A sound tessellation that nobody asked to remesh stays as given if new
 * triangles would intersect. */
static vg_status keep_given(struct vg_boundary *b, const struct vg_error *why)
{
  if (b->model.cad || b->check.n_defect ||
      b->read->settings.remesh != VG_ANSWER_AUTO)
    return VG_ERR_GEOMETRY;
  vg_remeshing_release(&b->remeshing);
  b->is_remeshed = 0;
  vg_note(b->notes, "the surface stays as given, since %s", why->text);
  return VG_OK;
}

/* Cuts inner surfaces that cross walls. */
static vg_status imprint(struct vg_boundary *b, struct vg_display *show,
                         struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  int is_cut;
  vg_status st = vg_boundary_imprint(b, &is_cut, show, &why);

  if (st < 0) return vg_fail(err, st, "%s: %s", b->read->files.stem, why.text);
  return is_cut ? check(b, b->flow.kind == VG_FLOW_EXTERNAL, show, err) : VG_OK;
}

/* One tessellation of the surface: closes it, decides the flow, remeshes it. */
static vg_status shape(struct vg_boundary *b, const struct vg_shape_options *o,
                       struct vg_display *show, struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  struct vg_error why = VG_ERROR_INIT;
  char remedy[120] = "";
  vg_status st;

  VG_TRY(split_quads(&b->surface, b->notes, err));
  VG_TRY(b->row ? take_rows(b, b->n_row, b->row, err)
                : take_rows(b, s->n_patch, s->patch, err));
  VG_TRY(close_surface(b, show, err));
  if (!b->surface.n_tri) return defects(b, show, err);
  VG_TRY(vg_boundary_decide(b, show, err));
  if (!b->check.n_defect || vg_is_only_open(&b->check))
    VG_TRY(vg_boundary_gaps(b, show, err));
  if (is_open_for_good(b, o)) return vg_boundary_refuse_open(b, show, err);
  if (!b->is_remeshed || o->has_maker) goto done;
  if (!is_reference(&b->check)) return defects(b, show, err);
  if (b->inner.n_tri) VG_TRY(imprint(b, show, err));
  st = vg_boundary_remesh(b, show, &why);
  if (st == VG_ERR_INPUT && b->check.count[VG_DEFECT_NONMANIFOLD_EDGE])
    return defects(b, show, err);
  if (st == VG_ERR_GEOMETRY) st = keep_given(b, &why);
  if (st < 0) {
    if (st == VG_ERR_GEOMETRY)
      vg_boundary_suggest_wrap(b, show, remedy, sizeof remedy);
    st = vg_fail(err, st, "%s: %s%s", b->read->files.stem, why.text, remedy);
  }
done:
  return st;
}

/* Names and conditions before the first tessellation, for the next one. */
struct given {
  size_t n_note, n_patch;
  struct vg_patch *patch; /* [n_patch] owned. */
};

static vg_status take_given(const struct vg_boundary *b, struct given *g,
                            struct vg_error *err)
{
  *g = (struct given){ b->notes->n, b->surface.n_patch, NULL };
  g->patch = vg_alloc(g->n_patch, sizeof *g->patch);
  if (!g->patch) return vg_fail_memory(err, "the patches");
  if (g->n_patch)
    memcpy(g->patch, b->surface.patch, g->n_patch * sizeof *g->patch);
  return VG_OK;
}

/* Whether shells cross each other. No other tessellation changes that. */
static int shells_cross(const struct vg_boundary *b)
{
  const struct vg_surface_report *r = &b->check;

  for (size_t i = 0; i < r->n_defect; i++) {
    const struct vg_defect *d = &r->defect[i];

    if (d->kind == VG_DEFECT_INTERSECTION && d->face[0] < b->surface.n_tri &&
        d->face[1] < b->surface.n_tri &&
        r->tri_shell[d->face[0]] != r->tri_shell[d->face[1]])
      return 1;
  }
  return 0;
}

/* Completes the message on a surface that no tessellation made valid. */
static vg_status refuse(struct vg_boundary *b, const struct vg_error *why,
                        struct vg_display *show, struct vg_error *err)
{
  char remedy[200];

  b->remedy = VG_REMEDY_NOW;
  vg_boundary_suggest_wrap(b, show, remedy, sizeof remedy);
  return vg_fail(err, VG_ERR_GEOMETRY, "%s%s", why->text, remedy);
}

/* Uses the first tessellation that leads to a valid surface. A remedy is
 * searched for once, at the end. */
static vg_status try_shapes(struct vg_boundary *b,
                            const struct vg_shape_options *o,
                            struct vg_display *show, struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  struct given g = { .patch = NULL };
  vg_status st, next;

  VG_TRY(take_given(b, &g, err));
  if (b->model.cad) b->remedy = VG_REMEDY_LATER;
  st = shape(b, o, show, &why);
  for (size_t i = 0; st == VG_ERR_GEOMETRY && !is_open_for_good(b, o); i++) {
    struct vg_error again = VG_ERROR_INIT;

    if (shells_cross(b) && (i || b->model.surface.n_solid < 2)) break;
    next = vg_boundary_tessellate(b, i, g.patch, g.n_patch, g.n_note, show,
                                  &again);
    if (next == VG_BLOCKED) break;
    /* A tessellation that does not cover the faces is no surface to try. */
    if (next == VG_ERR_GEOMETRY) continue;
    if (next < 0) {
      st = vg_fail(err, next, "%s", again.text);
      goto done;
    }
    b->n_given_patch = 0;
    vg_flow_release(&b->flow);
    st = shape(b, o, show, &again);
    if (st < 0 && st != VG_ERR_GEOMETRY) why = again;
  }
  if (st == VG_ERR_GEOMETRY && b->remedy == VG_REMEDY_ASKED)
    st = refuse(b, &why, show, err);
  else if (st < 0) *err = why;
done:
  free(g.patch);
  return st;
}

/* The unit of length may have changed since the file was read. */
static vg_status check_range(const struct vg_boundary *b, struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  const char *name = b->read->files.stem;
  const double side = vg_mesh_length(m);
  double lo[3], hi[3];

  if (side == 0 || side >= EXTENT_MIN)
    return vg_check_points(name, m->n_point, (const double(*)[3])m->point, err);
  vg_mesh_bounds(m, lo, hi);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: all points are within a box of side %g, from "
                 "(%g, %g, %g) to (%g, %g, %g); a surface must be at least %g "
                 "long; check the byte order or use a smaller unit of length",
                 name, side, lo[0], lo[1], lo[2], hi[0], hi[1], hi[2],
                 EXTENT_MIN);
}

/* Periodic patches stay images of each other. */
static vg_status refuse_periodic(const struct vg_boundary *b,
                                 struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const char *what = b->read->is_section ? "the input is a plane section"
                   : s->wrap > 0         ? "wrap is given"
                   : vg_boundary_wants_inner(b)
                     ? "baffles, sheets or interfaces are given"
                   : s->swap == VG_ANSWER_YES ? "surface_swap is yes"
                                              : NULL;

  if (!s->n_periodic || !what) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: the table periodic requires patches that are images of "
                 "each other in a closed surface, but %s; change this, or "
                 "remove the table",
                 b->read->files.stem, what);
}

vg_status vg_boundary_shape(struct vg_read *read,
                            const struct vg_shape_options *o,
                            struct vg_display *show, struct vg_boundary *b,
                            struct vg_error *err)
{
  vg_status st;

  b->read = read;
  b->notes = read->notes;
  b->threads = o->threads;
  b->map = read->map;
  vg_mesh_move(&b->surface, &read->surface);
  b->model = read->model;
  read->model = (struct vg_cad_model)VG_CAD_MODEL_INIT;
  vg_mesh_keep_boundary(&b->surface);
  VG_TRY(check_range(b, err));
  b->require_bc = has_conditions(&b->surface);
  b->is_remeshed = vg_read_is_remeshed(read, &b->surface);
  VG_TRY(refuse_periodic(b, err));
  if (b->require_bc)
    VG_TRY(vg_pairs_give_conditions(&read->settings, &b->surface, err));
  if (read->is_section) {
    b->is_remeshed = 0;
    VG_TRY(vg_boundary_divide_section(b, show, err));
    st = take_rows(b, 0, NULL, err);
    goto done;
  }
  VG_TRY(vg_boundary_refuse_plane_farfield(read, err));
  if (vg_boundary_wants_inner(b)) {
    VG_TRY(split_quads(&b->surface, b->notes, err));
    VG_TRY(vg_boundary_take_inner(b, &read->settings, err));
  }
  vg_boundary_note_slivers(b);
  st = try_shapes(b, o, show, err);
done:
  /* The message of the library has less detail. */
  return st == VG_ERR_STOPPED ? vg_display_stopped(show, err) : st;
}

/* Adds farfield and symmetry plane, and checks the complete boundary. */
static vg_status complete(struct vg_boundary *b, struct vg_display *show,
                          struct vg_error *err)
{
  vg_status st;

  vg_display_update(show, "farfield", 0, 0);
  VG_TRY(vg_boundary_complete(b, show, err));
  VG_TRY(check(b, 0, show, err));
  VG_TRY(defects(b, show, err));
done:
  return st;
}

/* Checks a remeshed surface again, with the decided flow. */
static vg_status check_again(struct vg_boundary *b, struct vg_display *show,
                             struct vg_error *err)
{
  if (!b->remeshing.is_done) return VG_OK;
  return check(b,
               b->flow.kind == VG_FLOW_UNKNOWN
                 ? -1
                 : b->flow.kind == VG_FLOW_EXTERNAL,
               show, err);
}

/* Makes periodic patches equal. */
static vg_status settle_periodic(struct vg_boundary *b, struct vg_display *show,
                                 struct vg_error *err)
{
  size_t n_moved;
  int is_changed;
  vg_status st = vg_pairs_settle(&b->read->settings, &b->surface, &b->pairs,
                                 &n_moved, &is_changed, err);

  if (st < 0 || !is_changed) return st;
  if (n_moved)
    vg_note(b->notes,
            "periodic patches: %zu points were moved to the images of others",
            n_moved);
  VG_TRY(check(b, 0, show, err));
  st = defects(b, show, err);
done:
  return st;
}

vg_status vg_boundary_close(struct vg_boundary *b, struct vg_display *show,
                            struct vg_error *err)
{
  int is_open;
  vg_status st;

  if (b->read->is_section) {
    VG_TRY(vg_boundary_close_section(b, show, err));
    VG_TRY(check(b, 0, show, err));
    return defects(b, show, err);
  }
  VG_TRY(check_again(b, show, err));
  is_open = vg_is_only_open(&b->check);
  if (is_open && b->flow.axis < 0) st = vg_boundary_refuse_open(b, show, err);
  else if (b->check.n_defect && !is_open) st = defects(b, show, err);
  else if (b->flow.kind == VG_FLOW_EXTERNAL || is_open)
    st = complete(b, show, err);
  else st = defects(b, show, err);
  if (st >= 0 && b->inner.n_tri) {
    VG_TRY(vg_boundary_put_inner(b, show, err));
    st = defects(b, show, err);
  }
  if (st >= 0) st = vg_zones_check(b, err);
  if (st >= 0) st = settle_periodic(b, show, err);
done:
  return st == VG_ERR_STOPPED ? vg_display_stopped(show, err) : st;
}

vg_status vg_boundary_check(struct vg_boundary *b, struct vg_display *show,
                            struct vg_error *err)
{
  vg_status st = check_again(b, show, err);

  if (st >= 0 && b->check.n_defect && !vg_is_only_open(&b->check))
    st = defects(b, show, err);
  return st == VG_ERR_STOPPED ? vg_display_stopped(show, err) : st;
}

const struct vg_mesh *vg_problem_surface(const struct vg_problem *p)
{
  return p->boundary.read ? &p->boundary.surface : &p->read.surface;
}

/* Face f of the report as one or two triangles (quadrilaterals follow the
 * triangles). */
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
  uint32_t(*tri)[3] = vg_alloc(room, sizeof *tri);
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
        patch[n] =
          m->patch[f < m->n_tri ? m->tri_patch[f] : m->quad_patch[f - m->n_tri]]
            .id;
      }
    }
  {
    const struct vg_vtu_field field[] = {
      { "defect", VG_VTU_CELL, VG_VTU_INT32, 1, kind },
      { "patch", VG_VTU_CELL, VG_VTU_INT32, 1, patch },
    };

    st = vg_vtu_write_triangles(path, m->n_point, (const double(*)[3])m->point,
                                n, (const uint32_t(*)[3])tri, field, 2, err);
  }
done:
  free(tri);
  free(kind);
  free(patch);
  return st;
}
