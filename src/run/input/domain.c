/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The flow domain: passes settings and file contents to the decision of
 * core/flow, and completes the domain. Declared in run/input/input.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/format.h"
#include "core/geometry/vector.h"
#include "core/remesh/remesh.h"
#include "io/stream/convention.h"
#include "run/input/input.h"
#include "run/input/shape_parts.h"
#include "run/input/zone_table.h"
#include "run/settings/plan_options.h"

#define FARFIELD_TRIANGLES 1e8
/* Distance from a plane, relative to the size of the surface. */
#define PLANE 1e-9
/* S110: holes of a skin, and ends of a duct, over length and over the width. */
#define HOLE 0.1
#define END 0.1
#define MANY_RIMS 100 /* Above it, all points are not compared with each. */
#define SHOWN_RIMS 3
/* S68: finest octree cells of the sizing field for a farfield along the Mach
 * cone, relative to those of the field of the cells. */
#define BOOM_COARSENESS 4

/* --- the decision -------------------------------------------------------- */

struct vg_flow_options vg_boundary_flow_options(const struct vg_boundary *b,
                                                struct vg_display *show)
{
  struct vg_flow_options o = vg_options_flow(&b->read->settings,
                                             b->read->has_cells);

  if (o.kind == VG_FLOW_UNKNOWN &&
      b->read->settings.cad.solids == VG_CAD_SOLIDS_ZONES &&
      vg_mesh_has_interfaces(&b->surface)) {
    o.kind = VG_FLOW_INTERNAL;
    o.asked_by = "cad_solids zones";
  }
  o.side = b->read->side;
  o.require_bc = b->require_bc;
  o.threads = b->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  return o;
}

static void note_cavities(struct vg_boundary *b)
{
  const struct vg_flow *f = &b->flow;

  if (f->n_cavity)
    vg_note(b->notes,
            "sealed cavities inside the bodies are not meshed: %zu with a "
            "total volume of %.4g, the largest near (%.6g, %.6g, %.6g); "
            "--regions all meshes them",
            f->n_cavity, f->cavity_volume, f->cavity_at[0], f->cavity_at[1],
            f->cavity_at[2]);
}

static void note_cap(struct vg_boundary *b)
{
  const struct vg_flow *f = &b->flow;

  if (f->cap_axis >= 0 && !f->n_cap_tri && f->kind == VG_FLOW_EXTERNAL &&
      b->read->settings.half == VG_HALF_AUTO)
    vg_note(b->notes,
            "flat cap at %c = %g: if this is a half model, --half %c removes "
            "the cap and adds the symmetry plane; if it is a complete body, "
            "--half no confirms that",
            "xyz"[f->cap_axis], f -> cap_at, "xyz"[f->cap_axis]);
}

/* An open half model has an axis, as has one whose cap was removed. */
static void note_half(struct vg_boundary *b)
{
  const int half = (int)b->read->settings.half;

  if (b->flow.root_off > 0)
    vg_note(b->notes,
            "the root of the half model is up to %.3g off the plane %c = %g; "
            "it was moved into this plane",
            b->flow.root_off, "xyz"[b->flow.axis], b -> flow.at);
  if (half == VG_HALF_AUTO || half == VG_HALF_NO || b->flow.axis >= 0) return;
  if (b->check.is_closed && half == VG_HALF_YES &&
      b->read->settings.close_holes && b->surface.n_patch > b->n_given_patch)
    vg_note(b->notes,
            "half yes has no effect, since close_holes closed all rims; --half "
            "x, y or z removes the cap in the plane of symmetry again and "
            "keeps the others");
  else if (b->check.is_closed)
    vg_note(b->notes, "setting that has no effect because the surface is "
                      "closed: half");
}

vg_status vg_boundary_decide(struct vg_boundary *b, struct vg_display *show,
                             struct vg_error *err)
{
  const struct vg_flow_options o = vg_boundary_flow_options(b, show);
  struct vg_error why = VG_ERROR_INIT;
  vg_status st = vg_flow_settle(&b->surface, &b->check, &o, &b->flow, &why);

  if (st < 0)
    return st == VG_ERR_INPUT
           ? vg_fail(err, st, "%s: %s", b->read->files.stem, why.text)
           : vg_fail(err, st, "%s", why.text);
  note_cap(b);
  note_half(b);
  note_cavities(b);
  return VG_OK;
}

/* --- open surfaces ------------------------------------------------------- */

int vg_is_only_open(const struct vg_surface_report *r)
{
  return r->count[VG_DEFECT_OPEN_EDGE] &&
         r->count[VG_DEFECT_OPEN_EDGE] == r->n_defect;
}

/* Do all triangles lie in one plane? Then no cap makes a volume of them. */
static int is_plane(const struct vg_mesh *m)
{
  double lo[3], hi[3], u[3], v[3], n[3], normal[3] = { 0, 0, 0 }, most = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    vg_sub(m->point[m->tri[i][1]], m->point[m->tri[i][0]], u);
    vg_sub(m->point[m->tri[i][2]], m->point[m->tri[i][0]], v);
    vg_cross(u, v, n);
    if (!(vg_norm(n) > most)) continue;
    most = vg_norm(n);
    for (int k = 0; k < 3; k++) normal[k] = n[k] / most;
  }
  vg_mesh_bounds(m, lo, hi);
  vg_sub(hi, lo, u);
  for (size_t i = 0; i < m->n_point; i++) {
    vg_sub(m->point[i], m->point[0], v);
    if (fabs(vg_dot(v, normal)) > PLANE * vg_norm(u)) return 0;
  }
  return most > 0;
}

/* For each rim: "0.2 wide, 24 edges, around (0, 0, 1)". */
static void list_rims(const struct vg_rim *rim, size_t n, char *text,
                      size_t size)
{
  size_t at = 0;

  *text = 0;
  for (size_t i = 0; i < n && i < SHOWN_RIMS && at + 120 < size; i++)
    at += (size_t)snprintf(text + at, size - at,
                           "%s%.4g wide, %zu edges, "
                           "around (%.6g, %.6g, %.6g)",
                           i ? "; " : "", rim[i].width, rim[i].n_edge,
                           rim[i].centre[0], rim[i].centre[1],
                           rim[i].centre[2]);
  if (n > SHOWN_RIMS) snprintf(text + at, size - at, "; ...");
}

vg_status vg_boundary_refuse_plane(const struct vg_boundary *b,
                                   struct vg_error *err)
{
  if (!is_plane(&b->surface)) return VG_OK;
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "%s: all triangles lie in one plane: such a surface bounds no "
                 "volume. Give a body, or for a mesh in two dimensions "
                 "%s",
                 b->read->files.stem,
                 vg_format_is_cad(b->read->files.surface)
                   ? "the option --cad-section yes"
                   : "the coordinates of the section in a .dat");
}

/* Whether the flow can be determined for a closed surface m if `kind` is
 * requested; UNKNOWN: with the settings as they are. */
static vg_status can_be(const struct vg_boundary *b, const struct vg_mesh *m,
                        enum vg_flow_kind kind, struct vg_display *show,
                        int *can, struct vg_error *err)
{
  struct vg_surface_check_options check = vg_options_check(&b->read->settings);
  struct vg_flow_options o = vg_boundary_flow_options(b, show);
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error why = VG_ERROR_INIT;
  struct vg_flow flow = VG_FLOW_INIT;
  struct vg_mesh copy = VG_MESH_INIT;
  vg_status st;

  check.threads = b->threads;
  check.external = -1;
  check.stop = (struct vg_stop){ vg_display_stop, show };
  if (kind != VG_FLOW_UNKNOWN) {
    o.kind = kind;
    o.asked_by = "";
  }
  VG_TRY(vg_mesh_copy(&copy, m, err));
  VG_TRY(vg_surface_check(&copy, &check, &r, err));
  *can = r.n_defect <= b->check.n_defect - b->check.count[VG_DEFECT_OPEN_EDGE];
  if (!*can) goto done;
  st = vg_flow_settle(&copy, &r, &o, &flow, &why);
  *can = st == VG_OK;
  if (st == VG_ERR_INPUT || st == VG_ERR_GEOMETRY) st = VG_OK;
  if (st < 0) vg_fail(err, st, "%s", why.text);
done:
  vg_flow_release(&flow);
  vg_surface_report_release(&r);
  vg_mesh_release(&copy);
  return st;
}

/* The flows for which caps on the rims give a closed surface without further
 * defects. */
struct caps {
  int any;      /* With the settings as they are. */
  int internal; /* With --flow internal. */
  int external;
};

static vg_status try_caps(const struct vg_boundary *b, struct vg_display *show,
                          struct caps *works, struct vg_error *err)
{
  const int is_given = b->read->settings.flow != VG_FLOW_UNKNOWN;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_cap_report r;
  vg_status st;

  vg_display_update(show, "trying to close the rims", 0, 0);
  VG_TRY(vg_mesh_copy(&m, &b->surface, err));
  st = vg_boundary_add_caps(b, &m, &r, err);
  if (st < 0) {
    if (st == VG_ERR_GEOMETRY) st = VG_OK;
    goto done;
  }
  VG_TRY(can_be(b, &m, VG_FLOW_UNKNOWN, show, &works->any, err));
  if (is_given) goto done;
  VG_TRY(can_be(b, &m, VG_FLOW_INTERNAL, show, &works->internal, err));
  if (!works->any)
    VG_TRY(can_be(b, &m, VG_FLOW_EXTERNAL, show, &works->external, err));
done:
  vg_mesh_release(&m);
  return st;
}

/* The options that close n rims. */
static void name_caps(const struct caps *works, size_t n, char *text,
                      size_t size)
{
  const char *list = n > 1 ? "cap_1, cap_2, ..." : "cap_1";

  if (works->any)
    snprintf(text, size,
             "--close-holes yes closes each rim with a cap in a patch of its "
             "own (%s%s)",
             list,
             n > 1 && works->internal ? "; in a duct with --flow internal"
                                      : "");
  else
    snprintf(text, size,
             "%s%s%s closes each rim with a cap in a patch of its own (%s)",
             works->external ? "--close-holes yes --flow external (a body)"
                             : "",
             works->external && works->internal ? " or " : "",
             works->internal ? "--close-holes yes --flow internal (a duct)"
                             : "",
             list);
}

/* Whether the surface lies on one side of the rim, as at the end of a duct. */
static int is_end(const struct vg_mesh *m, const struct vg_rim *r)
{
  double d[3], lo = 0, hi = 0;

  for (size_t i = 0; i < m->n_point; i++) {
    vg_sub(m->point[i], r->centre, d);
    lo = fmin(lo, vg_dot(d, r->normal));
    hi = fmax(hi, vg_dot(d, r->normal));
  }
  return fmin(-lo, hi) <= END * r->width;
}

/* Whether the rims are nothing but holes in the skin of a body: they are
 * narrow, and no two of them can be the ends of a duct. */
static int are_holes(const struct vg_mesh *m, const struct vg_rim *rim,
                     size_t n)
{
  const double length = vg_mesh_length(m);
  int n_end = 0;

  for (size_t i = 0; i < n; i++)
    if (rim[i].width > HOLE * length) return 0;
  if (n > MANY_RIMS) return 0;
  for (size_t i = 0; i < n && n_end < 2; i++) n_end += is_end(m, &rim[i]);
  return n_end < 2;
}

/* Open edges that face each other at the distance of a weld. */
static vg_status refuse_gap(const struct vg_boundary *b, struct vg_error *err)
{
  char remedy[60];

  if (vg_boundary_wants_inner(b))
    snprintf(remedy, sizeof remedy, "weld them in the surface file");
  else
    snprintf(remedy, sizeof remedy, "--weld %.2g closes these gaps",
             1.05 * b->rim_gap);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "%s: the surface is open, but its open edges face each other "
                 "at a distance of at most %.3g: %s",
                 b->read->files.stem, b->rim_gap, remedy);
}

vg_status vg_boundary_refuse_open(struct vg_boundary *b,
                                  struct vg_display *show, struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  struct vg_rim *rim = NULL;
  char list[400], half[160] = "", remedy[160], taken[240];
  struct caps works = { 0, 0, 0 };
  size_t n = 0;
  vg_status st = vg_boundary_refuse_plane(b, err);

  if (st < 0) return st;
  st = vg_domain_rims(&b->surface, &n, &rim, &why);
  if (b->rim_gap > 0) {
    free(rim);
    return refuse_gap(b, err);
  }
  if (st == VG_ERR_GEOMETRY) {
    vg_boundary_suggest_wrap(b, show, remedy, sizeof remedy);
    return vg_fail(err, VG_ERR_GEOMETRY, "%s: the surface is open, and %s%s",
                   b->read->files.stem, why.text, remedy);
  }
  if (st < 0) return vg_fail(err, st, "%s", why.text);
  list_rims(rim, n, list, sizeof list);
  vg_boundary_name_inner(b, taken, sizeof taken);
  if (n == 1 && rim[0].axis >= 0)
    snprintf(half, sizeof half,
             ". If it is one half of a symmetric model, cut at %c = %g, give "
             "--half %c",
             "xyz"[rim[0].axis], rim[0].centre[rim[0].axis],
             "xyz"[rim[0].axis]);
  st = try_caps(b, show, &works, err);
  if (st < 0) {
    free(rim);
    return st;
  }
  if (!works.any && !works.internal && !works.external) {
    vg_boundary_suggest_wrap(b, show, remedy, sizeof remedy);
    if (vg_boundary_suggest_inner(b, remedy, sizeof remedy)) *half = 0;
    if (*half) b->cure.wrap = 0;
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "%s: the surface is open: %zu rim%s (%s). Caps on the rims "
                 "(--close-holes) would intersect or overlap the surface%s%s%s",
                 b->read->files.stem, n, n > 1 ? "s" : "", list, half, remedy,
                 taken);
    free(rim);
    return st;
  }
  name_caps(&works, n, remedy, sizeof remedy);
  b->cure.close_holes = works.any && !*half && !*taken &&
                        are_holes(&b->surface, rim, n);
  st = vg_fail(err, VG_ERR_GEOMETRY,
               "%s: the surface is open: %zu rim%s (%s). %s%s%s",
               b->read->files.stem, n, n > 1 ? "s" : "", list, remedy, half,
               taken);
  free(rim);
  return st;
}

/* --- completing the domain ----------------------------------------------- */

/* With an edge length in a different unit the farfield could need more
 * triangles than fit in memory. */
static vg_status check_farfield(const struct vg_boundary *b,
                                const struct vg_farfield *far,
                                struct vg_error *err)
{
  double edge = far->spacing, lo[3], hi[3], size = 0, n;
  double hmax = b->read->settings.hmax * b->read->settings.scale;

  if (hmax > 0 && !(edge > 0 && edge < hmax)) edge = hmax;
  vg_mesh_bounds(&b->surface, lo, hi);
  for (int k = 0; k < 3; k++) {
    size = fmax(size, far->lengths * (hi[k] - lo[k]));
    if (far->has_box) size = fmax(size, (far->hi[k] - far->lo[k]) / 2);
  }
  if (far->kind == VG_FARFIELD_MACH)
    /* The generators of both cones are longer than the radius by `mach`. */
    size *= far->extent.radial / far->lengths * sqrt(far->extent.mach);
  if (far->size > 0) size = far->size;
  /* Area of a sphere divided by that of a triangle. */
  n = edge > 0 ? 29 * (size / edge) * (size / edge) : 0;
  if (far->kind == VG_FARFIELD_NONE || n < FARFIELD_TRIANGLES) return VG_OK;
  if (!isfinite(n))
    return vg_fail(err, VG_ERR_INPUT,
                   "the farfield of a body from (%g, %g, %g) to (%g, %g, %g) "
                   "exceeds the range of numbers; check the coordinates and "
                   "the unit",
                   lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]);
  return vg_fail(err, VG_ERR_INPUT,
                 "a farfield of size %g with edges of length %g would have "
                 "about %.2g triangles; check that its spacing and hmax are "
                 "in the unit of the surface",
                 size, edge, n);
}

static vg_status check_reach(const struct vg_boundary *b, struct vg_error *err)
{
  double lo[3], hi[3], most = 0;

  vg_mesh_bounds(&b->surface, lo, hi);
  for (int k = 0; k < 3; k++) most = fmax(most, fmax(-lo[k], hi[k]));
  if (most <= VG_COORDINATE_MAX) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: the farfield reaches from (%g, %g, %g) to (%g, %g, %g), "
                 "beyond %g; make it smaller (farfield.size, "
                 "farfield.lengths) or use another unit of length",
                 b->read->files.stem, lo[0], lo[1], lo[2], hi[0], hi[1], hi[2],
                 VG_COORDINATE_MAX);
}

struct vg_farfield vg_boundary_farfield(const struct vg_boundary *b)
{
  struct vg_settings view = b->read->settings; /* Tables are borrowed. */

  vg_resolve_flow(&view, (int)b->flow.kind, b->flow.axis);
  return vg_options_farfield(&view);
}

/* Replaces the triangles of the patches from n_own on by those of `made`, whose
 * first points are those of the body. The body keeps its triangles in their
 * order. */
static vg_status take_added(struct vg_mesh *m, struct vg_mesh *made,
                            size_t n_own, struct vg_error *err)
{
  uint32_t(*tri)[3] = vg_alloc(m->n_tri + made->n_tri, sizeof *tri);
  uint32_t *patch = vg_alloc(m->n_tri + made->n_tri, sizeof *patch);
  const struct vg_mesh *from[2] = { m, made };
  size_t n = 0;

  if (!tri || !patch) {
    free(tri);
    free(patch);
    return vg_fail_memory(err, "the farfield");
  }
  for (int i = 0; i < 2; i++)
    for (size_t t = 0; t < from[i]->n_tri; t++) {
      if ((from[i]->tri_patch[t] >= n_own) != i) continue;
      memcpy(tri[n], from[i]->tri[t], sizeof *tri);
      patch[n++] = from[i]->tri_patch[t];
    }
  free(made->tri);
  free(made->tri_patch);
  made->tri = tri;
  made->tri_patch = patch;
  made->n_tri = n;
  vg_mesh_move(m, made);
  return VG_OK;
}

/* Remeshes the added patches in the metric of a stretched field. The body and
 * the rims that it shares with them do not change. */
static vg_status stretch_added(struct vg_boundary *b, size_t n_own,
                               const struct vg_sizing *field, double spacing,
                               struct vg_display *show, struct vg_error *err)
{
  struct vg_remesh_options o = vg_options_remesh(&b->read->settings);
  struct vg_mesh made = VG_MESH_INIT;
  uint8_t *fixed = NULL;
  double lo[3], hi[3];
  vg_status st = VG_OK;

  if (!vg_sizing_is_stretched(field) || b->surface.n_patch == n_own) return st;
  vg_display_update(show, "farfield remeshing", b->domain.n_added_tri, 0);
  fixed = vg_calloc(b->surface.n_patch, 1);
  if (!fixed) return vg_fail_memory(err, "the farfield");
  memset(fixed, 1, n_own);
  vg_mesh_bounds(&b->surface, lo, hi);
  o.fixed = fixed;
  o.field = field;
  /* Only its sizes count, since a generated boundary has no shape to keep. */
  o.per_turn = VG_OUTER_PER_TURN;
  o.tolerance = VG_OUTER_TOLERANCE * vg_distance(lo, hi);
  o.scale = 1; /* `spacing` and the field are scaled */
  o.h_max = spacing > 0 ? spacing : vg_distance(lo, hi);
  o.is_requested = 0; /* `spacing` concerns the farfield alone. */
  o.h_min = fmin(o.h_min, o.h_max);
  o.threads = b->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  VG_TRY(vg_mesh_copy(&made, &b->surface, err));
  VG_TRY(vg_remesh(&made, &o, NULL, err));
  b->domain.n_added_tri -= b->surface.n_tri;
  VG_TRY(take_added(&b->surface, &made, n_own, err));
  b->domain.n_added_tri += b->surface.n_tri;
done:
  free(fixed);
  vg_mesh_release(&made);
  return st;
}

/* The sizing field for the surfaces of the domain. It covers a box beyond the
 * body, whose corners are appended to the points of the surface. */
static vg_status make_sizing(const struct vg_boundary *b,
                             const struct vg_farfield *far,
                             struct vg_sizing **out, struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  struct vg_sizing_options options = vg_boundary_sizing(b);
  struct vg_mesh all = VG_MESH_INIT, view; /* view is borrowed, except for its
                                              points. */
  vg_status st = b->inner.n_tri ? vg_boundary_with_inner(b, &all, err) : VG_OK;

  if (st < 0) return st;
  view = b->inner.n_tri ? all : b->surface;

  /* The farfield is far from the body, so the largest edge of the body does not
   * limit it. */
  if (!(options.h_max > 0)) options.h_max = INFINITY;
  options.threads = b->threads;
  if (far->kind == VG_FARFIELD_MACH) {
    options.coarseness = BOOM_COARSENESS;
    double(*point)[3] = vg_alloc(view.n_point + 2, sizeof *point);

    if (!point) VG_TRY(vg_fail_memory(err, "the sizing field"));
    memcpy(point, view.point, view.n_point * sizeof *point);
    view.point = point;
    vg_domain_bounds(&b->surface, far, view.point[view.n_point],
                     view.point[view.n_point + 1]);
    view.n_point += 2;
  }
  st = vg_boundary_measure(b, &options, s, &view, out, err);
  if (far->kind == VG_FARFIELD_MACH) free(view.point);
done:
  vg_mesh_release(&all);
  return st;
}

/* Completes the domain, and cuts inner surfaces that reach beyond it. Where
 * they reach beyond a symmetry plane, its rim crosses their edges, so that it
 * is made without them first. */
static vg_status complete_by(struct vg_boundary *b, struct vg_farfield *far,
                             const struct vg_sizing *sizing,
                             struct vg_display *show, struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT, other = VG_ERROR_INIT;
  int is_cut = 0;
  vg_status st = vg_domain_complete(&b->surface, far, sizing, &b->domain, &why);
  const int again = st == VG_ERR_GEOMETRY && b->domain.is_crossed;

  if (again) {
    far->sheets = NULL;
    st = vg_domain_complete(&b->surface, far, sizing, &b->domain, &other);
  }
  if (st < 0) return vg_fail(err, st, "%s", why.text);
  if (!b->inner.n_tri) return st;
  st = vg_boundary_cut_outer(b, sizing, far->spacing, &is_cut, show, &other);
  if (st < 0)
    return vg_fail(err, st, "%s: %s", b->read->files.stem, other.text);
  if (again && !is_cut) return vg_fail(err, VG_ERR_GEOMETRY, "%s", why.text);
  return st;
}

vg_status vg_boundary_complete(struct vg_boundary *b, struct vg_display *show,
                               struct vg_error *err)
{
  struct vg_farfield far = vg_boundary_farfield(b);
  struct vg_sizing *sizing = NULL;
  const size_t n_own = b->surface.n_patch;
  vg_status st;

  far.symmetry = b->flow.axis < 0 ? -1 : 1;
  VG_TRY(check_farfield(b, &far, err));
  VG_TRY(make_sizing(b, &far, &sizing, err));
  far.stop = (struct vg_stop){ vg_display_stop, show };
  far.sheets = b->inner.n_tri ? &b->inner : NULL;
  VG_TRY(complete_by(b, &far, sizing, show, err));
  VG_TRY(check_reach(b, err));
  VG_TRY(stretch_added(b, n_own, sizing, far.spacing, show, err));
done:
  vg_sizing_free(sizing);
  /* The message of the library has less detail. */
  return st == VG_ERR_STOPPED ? vg_display_stopped(show, err) : st;
}
