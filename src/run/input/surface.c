/* From triangles as read to the closed boundary of a fluid. Declared in
 * run/input/input.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/surface/envelope.h"
#include "core/wrap/wrap.h"
#include "io/mesh/vtu.h"
#include "io/stream/convention.h"
#include "run/input/input.h"
#include "run/input/sizes.h"
#include "run/settings/deck.h"

#define SHOWN_PATCHES 20   /* numbers in a note */
#define FARFIELD_TRIANGLES 1e8

/* Codes of patches that bound a fluid from outside: freestream, outflow,
 * characteristic and internal-flow ends. */
static int is_outer_condition(const struct vg_patch *p)
{
  if (p->bc == 0 || p->bc == 2 || p->bc == 3) return 1;
  if (p->bc == 1001 || p->bc == 1002) return 1;
  return p->bc_fun3d >= 5000 && p->bc_fun3d < 6000;
}

/* Six times the volume enclosed, by the divergence theorem about the first
 * point. Only its sign is used, far from zero for real bodies. */
static double signed_volume(const struct vg_mesh *m)
{
  const double *o = m->n_point ? m->point[0] : NULL;
  double sum = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    double v[3][3];

    for (int k = 0; k < 3; k++) vg_sub(m->point[m->tri[i][k]], o, v[k]);
    sum += vg_triple(v[0], v[1], v[2]);
  }
  return sum;
}

static int looks_external(const struct vg_mesh *m)
{
  for (size_t i = 0; i < m->n_patch; i++)
    if (is_outer_condition(&m->patch[i])) return 0;
  return signed_volume(m) > 0;
}

/* Bodies inside an outer shell: the surface is the whole domain. Nesting
 * means nothing where shells cross. */
static int has_nested_shells(const struct vg_surface_report *r)
{
  if (r->count[VG_DEFECT_INTERSECTION]) return 0;
  for (size_t i = 0; i < r->n_shell; i++)
    if (r->shell[i].depth > 0) return 1;
  return 0;
}

int vg_surface_has_conditions(const struct vg_mesh *m)
{
  for (size_t i = 0; i < m->n_patch; i++)
    if (m->patch[i].bc != VG_BC_NONE) return 1;
  return 0;
}

/* Numbers of the patches that lie in the outer part, as " 1 2 3". */
static vg_status outer_patches(const struct vg_mesh *m, const uint8_t *outer,
                               char *list, size_t size, struct vg_error *err)
{
  size_t (*n)[2] = vg_calloc(m->n_patch, sizeof *n), at = 0, shown = 0;

  if (!n) return vg_fail_memory(err, "the patches");
  *list = 0;
  for (size_t i = 0; i < m->n_tri; i++) n[m->tri_patch[i]][outer[i]]++;
  for (size_t i = 0; i < m->n_patch && at < size; i++) {
    if (n[i][1] <= n[i][0]) continue;
    if (shown++ < SHOWN_PATCHES)
      at += (size_t)snprintf(list + at, size - at, " %d",
                             (int)m->patch[i].id);
    else if (shown == SHOWN_PATCHES + 1)
      at += (size_t)snprintf(list + at, size - at, " ...");
  }
  free(n);
  return VG_OK;
}

/* One shell with normals outward: a body, unless its shape says that it is
 * the boundary of a fluid around a body. */
static vg_status is_whole_domain(const struct vg_mesh *m,
                                 const struct vg_surface_report *r,
                                 struct vg_notes *notes, int *whole,
                                 struct vg_error *err)
{
  struct vg_envelope e;
  uint8_t *outer;
  char list[12 * SHOWN_PATCHES + 8];
  vg_status st;

  *whole = 0;
  if (r->n_shell != 1 || !r->is_closed || r->n_defect || m->n_quad)
    return VG_OK;
  outer = vg_alloc(m->n_tri, 1);
  if (!outer) return vg_fail_memory(err, "the surface");
  VG_TRY(vg_envelope_measure(m, outer, &e, err));
  *whole = e.is_domain;
  if (!e.is_domain) goto done;
  VG_TRY(outer_patches(m, outer, list, sizeof list, err));
  vg_note(notes, "the surface was taken as the boundary of a whole flow "
          "domain, though its normals point out of it: %zu triangles (most of "
          "patches%s) are a convex outer boundary that covers at least "
          "%.0f %% of every view along x, y and z, and the others stand "
          "inside it (--farfield sphere: it is a body in open air)", e.n_outer,
          list, 100 * fmin(e.covered, 1));
done:
  free(outer);
  return st;
}

vg_status vg_surface_examine(struct vg_mesh *m,
                             const struct vg_surface_check_options *options,
                             int *external, struct vg_surface_report *r,
                             struct vg_notes *notes, struct vg_error *err)
{
  struct vg_surface_check_options o = *options;
  int find_out = *external < 0, inside = 0;
  vg_status st;

  o.external = find_out ? looks_external(m) : *external;
  VG_TRY(vg_surface_check(m, &o, r, err));
  if (find_out && o.external) {
    inside = has_nested_shells(r);
    if (!inside) VG_TRY(is_whole_domain(m, r, notes, &inside, err));
  }
  if (inside && !(o.repair && vg_surface_turn(m, r))) {
    o.external = 0;
    vg_surface_report_release(r);
    VG_TRY(vg_surface_check(m, &o, r, err));
  }
  *external = o.external && !inside;
done:
  return st;
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

static vg_status check(struct vg_problem *p, int *external,
                       struct vg_display *show, struct vg_error *err)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;

  o.repair = p->settings.repair;
  o.require_bc = p->require_bc;
  o.threads = p->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  vg_surface_report_release(&p->check);
  return vg_surface_examine(&p->surface, &o, external, &p->check, &p->notes,
                            err);
}

static vg_status defects(const struct vg_problem *p, struct vg_error *err)
{
  if (!p->check.n_defect && !p->surface.n_tri)
    return vg_fail(err, VG_ERR_GEOMETRY, "%s: no surface is left: all its "
                   "triangles are degenerate", p->files.stem);
  if (!p->check.n_defect) return VG_OK;
  return vg_fail(err, VG_ERR_GEOMETRY, "%s: the surface has %zu defects and "
                 "cannot bound a mesh", p->files.stem, p->check.n_defect);
}

/* A half body: open edges, and nothing else is wrong. */
static int is_only_open(const struct vg_surface_report *r)
{
  return r->count[VG_DEFECT_OPEN_EDGE] &&
         r->count[VG_DEFECT_OPEN_EDGE] == r->n_defect;
}

vg_status vg_surface_half(const struct vg_mesh *m,
                          const struct vg_surface_report *r,
                          struct vg_notes *notes, int *is_half,
                          struct vg_error *err)
{
  int axis;
  double at;
  vg_status st;

  *is_half = 0;
  if (!is_only_open(r)) return VG_OK;
  VG_TRY(vg_domain_half(m, &axis, &at, err));
  *is_half = axis >= 0;
  if (*is_half)
    vg_note(notes, "%zu open edges, all at %c = %.9g: the surface is half of "
            "a symmetric body, to which vanguard mesh adds the plane",
            r->n_defect, "xyz"[axis], at);
done:
  return st;
}

/* An edge in another unit would ask for more triangles than fit anywhere. */
static vg_status check_farfield(const struct vg_problem *p,
                                const struct vg_farfield *far,
                                struct vg_error *err)
{
  double edge = far->spacing, lo[3], hi[3], size = 0, n;
  double hmax = p->settings.hmax * p->settings.scale;

  if (hmax > 0 && !(edge > 0 && edge < hmax)) edge = hmax;
  vg_mesh_bounds(&p->surface, lo, hi);
  for (int k = 0; k < 3; k++) {
    size = fmax(size, far->lengths * (hi[k] - lo[k]));
    if (far->has_box) size = fmax(size, (far->hi[k] - far->lo[k]) / 2);
  }
  if (far->size > 0) size = far->size;
  /* The area of a sphere over that of a triangle. */
  n = edge > 0 ? 29 * (size / edge) * (size / edge) : 0;
  if (far->kind == VG_FARFIELD_NONE || n < FARFIELD_TRIANGLES) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "a farfield of size %g with edges of %g "
                 "has some %.2g triangles; are its spacing and hmax in the "
                 "unit of the surface?", size, edge, n);
}

static vg_status complete(struct vg_problem *p, struct vg_display *show,
                          struct vg_error *err)
{
  struct vg_settings *s = &p->settings;
  struct vg_sizing_options options = vg_problem_sizing(p);
  struct vg_farfield far;
  struct vg_sizing *sizing = NULL;
  int assumed = s->farfield.kind == VG_DOMAIN_AUTO;
  vg_status st;

  if (assumed) s->farfield.kind = VG_DOMAIN_SPHERE;
  far = vg_settings_farfield(s);
  VG_TRY(check_farfield(p, &far, err));
  /* What is built here lies away from the body, whose own largest edge is no
   * limit for it. */
  if (!(options.h_max > 0)) options.h_max = INFINITY;
  options.threads = p->threads;
  VG_TRY(vg_sizing_new(&options, s->n_source, s->source, &p->surface, &sizing,
                       err));
  far.stop = vg_display_stop;
  far.user = show;
  VG_TRY(vg_domain_complete(&p->surface, &far, sizing, &p->domain, err));
  if (assumed)
    vg_note(&p->notes, "the surface was taken as a body in open air: a "
            "spherical farfield of radius %g body lengths was put around it "
            "(--farfield none: the surface is the whole domain)",
            far.lengths);
done:
  vg_sizing_free(sizing);
  /* the library's message says less */
  return st < 0 && vg_display_stop(show) ? vg_display_stopped(show, err) : st;
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

  for (size_t i = 0; i < p->surface.n_patch; i++) {
    const struct vg_patch *patch = &p->surface.patch[i];

    if (patch->bc != VG_BC_NONE || patch->bc_fun3d != VG_BC_NONE) continue;
    if (n++ < SHOWN_PATCHES)
      at += (size_t)snprintf(list + at, sizeof list - at, " %d",
                             (int)patch->id);
  }
  if (n)
    vg_note(&p->notes, "%zu patch%s no boundary condition (number%s%s), "
            "written as inviscid (5, FUN3D 3000): give conditions in a .mapbc "
            "file or the deck", n, n > 1 ? "es have" : " has", list,
            n > SHOWN_PATCHES ? " ..." : "");
}

static vg_status close_body(struct vg_problem *p, struct vg_display *show,
                            struct vg_error *err)
{
  int external = 0;
  vg_status st = VG_OK;

  if (p->check.n_defect && !is_only_open(&p->check)) return defects(p, err);
  vg_display_update(show, "farfield", 0, 0);
  VG_TRY(complete(p, show, err));
  vg_display_update(show, "check", p->surface.n_tri, 0);
  VG_TRY(check(p, &external, show, err));
  VG_TRY(defects(p, err));
done:
  return st;
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
  vg_note(&p->notes, "holes of the surface that were closed: %zu, with %zu "
          "triangles", n_hole, n_tri);
done:
  vg_sizing_free(sizing);
  return st;
}

/* An outer boundary would be all that is left of what it encloses. */
static vg_status wrap(struct vg_problem *p, struct vg_display *show,
                      struct vg_error *err)
{
  const struct vg_stop stop = { vg_display_stop, show };
  double size = p->settings.wrap;
  struct vg_wrap_report r = { 0 };
  vg_status st = VG_OK;

  for (size_t i = 0; i < p->surface.n_patch; i++)
    if (is_outer_condition(&p->surface.patch[i]))
      return vg_fail(err, VG_ERR_INPUT, "wrap: patch %d has a condition of an "
                     "outer boundary; only bodies can be wrapped, leave that "
                     "patch out of the surface (a farfield is added)",
                     (int)p->surface.patch[i].id);
  vg_display_update(show, "wrap", p->surface.n_tri, 0);
  VG_TRY(vg_wrap(&p->surface, size, &stop, &r, err));
  vg_note(&p->notes, "the surface was wrapped: %zu triangles by %zu; of %zu "
          "points %zu lie on them, others about %.3g away; put together where "
          "two sides meet in an edge: %zu; gaps narrower than %g were bridged; "
          "the farthest is %.3g away, at (%.6g, %.6g, %.6g); patches follow "
          "the nearest triangle, left without any: %zu",
          r.n_before, p->surface.n_tri, r.n_point, r.n_fit, r.offset, r.n_zip,
          size,
          r.distance, r.at[0], r.at[1], r.at[2], r.n_empty);
done:
  return st;
}

vg_status vg_problem_shape(struct vg_problem *p, struct vg_display *show,
                           struct vg_error *err)
{
  struct vg_settings *s = &p->settings;
  vg_status st = VG_OK;

  vg_mesh_keep_boundary(&p->surface);
  p->require_bc = vg_surface_has_conditions(&p->surface);
  VG_TRY(split_quads(&p->surface, &p->notes, err));
  VG_TRY(resolve_patches(p, err));
  if (s->wrap > 0) VG_TRY(wrap(p, show, err));
  if (s->weld > 0)
    VG_TRY(vg_surface_weld(&p->surface, s->weld, &p->n_welded, &p->n_dropped,
                           err));
  if (s->close_holes) VG_TRY(close_holes(p, err));
  p->external = s->farfield.kind == VG_DOMAIN_AUTO
                ? -1 : s->farfield.kind != VG_DOMAIN_NONE;
  vg_display_update(show, "check", p->surface.n_tri, 0);
  VG_TRY(check(p, &p->external, show, err));
  s->remesh = vg_problem_is_renewed(p) ? VG_ANSWER_YES : VG_ANSWER_NO;
  if (!p->check.n_defect || is_only_open(&p->check))
    VG_TRY(vg_problem_gaps(p, show, err));
  if (s->remesh == VG_ANSWER_YES) {
    if (p->check.n_defect && !is_only_open(&p->check)) return defects(p, err);
    VG_TRY(vg_problem_renew(p, show, err));
  }
  p->is_shaped = 1;
done:
  /* the library's message says less */
  return st == VG_ERR_STOPPED ? vg_display_stopped(show, err) : st;
}

vg_status vg_problem_close(struct vg_problem *p, struct vg_display *show,
                           struct vg_error *err)
{
  struct vg_settings *s = &p->settings;
  vg_status st = VG_OK;

  if (!p->is_shaped) VG_TRY(vg_problem_shape(p, show, err));
  if (p->renewal.is_done) {
    vg_display_update(show, "check", p->surface.n_tri, 0);
    VG_TRY(check(p, &p->external, show, err));
  }
  if (p->surface_only && (!p->check.n_defect || is_only_open(&p->check)))
    return VG_OK;
  if (p->external) {
    st = close_body(p, show, err);
    goto done;
  }
  s->farfield.kind = VG_DOMAIN_NONE;
  VG_TRY(defects(p, err));
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
