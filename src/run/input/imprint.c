/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cuts inner surfaces that cross other surfaces. The common curves become edges
 * of both, and parts outside the fluid are removed. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/planar.h"
#include "core/geometry/vector.h"
#include "core/junction/junction.h"
#include "core/remesh/remesh.h"
#include "core/sizing/sizing.h"
#include "core/wrap/unite.h"
#include "run/input/shape_parts.h"
#include "run/settings/plan_options.h"

#define SNAP 1e-5 /* S106: of the length of the walls */
#define ROOM 0.05 /* S116: around a farfield, of its length */

/* Inner surfaces that overlap in one plane share no curve along which they
 * could be divided. */
static vg_status refuse_overlap(const struct vg_boundary *b,
                                const struct vg_mesh *all,
                                const struct vg_defect *d, struct vg_error *err)
{
  const struct vg_patch *p[2];
  double x[2][3][3];

  for (int i = 0; i < 2; i++) {
    if (d->face[i] < b->surface.n_tri) return VG_OK;
    p[i] = &all->patch[all->tri_patch[d->face[i]]];
    for (int k = 0; k < 3; k++)
      memcpy(x[i][k], all->point[all->tri[d->face[i]][k]], sizeof x[i][k]);
  }
  if (p[0] == p[1] ||
      !vg_junction_overlap((const double(*)[3])x[0], (const double(*)[3])x[1],
                           SNAP * vg_boundary_length(b)))
    return VG_OK;
  return vg_fail(
    err, VG_ERR_GEOMETRY,
    "patches %d %s and %d %s, inner surfaces, overlap in one plane "
    "at (%g, %g, %g): remove the common part from one of them, or "
    "move one of them out of the plane",
    (int)p[0]->id, p[0]->name, (int)p[1]->id, p[1]->name, d->at[0], d->at[1],
    d->at[2]);
}

/* Does an inner surface of `all` intersect a wall or another one? first: the
 * first such pair of triangles; may be NULL. VG_ERR_GEOMETRY: two of them
 * overlap. */
static vg_status find_crossings(const struct vg_boundary *b,
                                struct vg_mesh *all, struct vg_display *show,
                                int *any, struct vg_defect *first,
                                struct vg_error *err)
{
  struct vg_surface_check_options o = vg_inner_check_options(b, show);
  struct vg_surface_report r = { .n_defect = 0 };
  vg_status st;

  VG_TRY(vg_surface_check(all, &o, &r, err));
  *any = 0;
  for (size_t i = 0; i < r.n_defect; i++) {
    const struct vg_defect *d = &r.defect[i];

    if (d->kind != VG_DEFECT_INTERSECTION ||
        (d->face[0] < b->surface.n_tri && d->face[1] < b->surface.n_tri))
      continue;
    if (!*any && first) *first = *d;
    *any = 1;
    VG_TRY(refuse_overlap(b, all, d, err));
  }
done:
  vg_surface_report_release(&r);
  return st;
}

/* The half space of a half model whose symmetry plane is generated. */
static struct vg_junction_half half_of(const struct vg_boundary *b)
{
  struct vg_junction_half h = { b->flow.axis, 0, b->flow.at };
  double lo[3], hi[3];

  vg_mesh_bounds(&b->surface, lo, hi);
  if (h.axis >= 0) h.is_above = hi[h.axis] - h.at > h.at - lo[h.axis];
  return h;
}

static int reaches_beyond(const struct vg_boundary *b,
                          const struct vg_junction_half *h)
{
  if (h->axis < 0) return 0;
  for (size_t i = 0; i < 3 * b->inner.n_tri; i++) {
    const double d = b->inner.point[b->inner.tri[i / 3][i % 3]][h->axis] -
                     h->at;

    if (h->is_above ? d < 0 : d > 0) return 1;
  }
  return 0;
}

/* Points of inner surfaces next to the symmetry plane move into it, as those of
 * the walls do: a border along the plane would be cut where it crosses the
 * plane within rounding. */
static void flatten_inner(struct vg_boundary *b,
                          const struct vg_junction_half *h)
{
  const double near = SNAP * vg_boundary_length(b);

  for (size_t i = 0; i < b->inner.n_point && h->axis >= 0; i++)
    if (fabs(b->inner.point[i][h->axis] - h->at) <= near)
      b->inner.point[i][h->axis] = h->at;
}

static vg_status copy_patches(const struct vg_mesh *from, struct vg_mesh *to,
                              struct vg_error *err)
{
  to->patch = vg_alloc(from->n_patch, sizeof *to->patch);
  if (!to->patch) return vg_fail_memory(err, "the patches");
  memcpy(to->patch, from->patch, from->n_patch * sizeof *from->patch);
  to->n_patch = from->n_patch;
  return VG_OK;
}

/* The walls and the pieces of inner surfaces, with points of their own. n_wall:
 * out, triangles of walls. */
static vg_status gather(const struct vg_boundary *b, const struct vg_mesh *all,
                        double near, struct vg_mesh *out, size_t *n_wall,
                        struct vg_error *err)
{
  struct vg_junctions j = VG_JUNCTIONS_INIT;
  struct vg_junction_piece p = VG_JUNCTION_PIECE_INIT;
  struct vg_growing_mesh to = VG_GROWING_MESH_INIT;
  struct vg_growing_mesh sheets = VG_GROWING_MESH_INIT;
  struct vg_mesh walls = VG_MESH_INIT;
  size_t n_moved;
  vg_status st;

  VG_TRY(vg_junctions_find(all, b->surface.n_tri, &j, err));
  for (uint32_t i = 1; i < j.n_piece; i++) {
    VG_TRY(vg_junctions_piece(&j, i, &p, err));
    VG_TRY(vg_grow_mesh(&sheets, &p.mesh, err));
    vg_junction_piece_release(&p);
  }
  VG_TRY(vg_mesh_copy(&walls, &b->surface, err));
  VG_TRY(vg_junction_snap(&walls, &sheets.m, near, &n_moved, err));
  if (n_moved)
    vg_note(b->notes,
            "%zu points of inner surfaces were moved by at most %.3g onto "
            "sharp edges next to them",
            n_moved, near);
  *n_wall = walls.n_tri;
  VG_TRY(vg_grow_mesh(&to, &walls, err));
  VG_TRY(vg_grow_mesh(&to, &sheets.m, err));
  VG_TRY(copy_patches(all, &to.m, err));
  vg_mesh_move(out, &to.m);
done:
  vg_junction_piece_release(&p);
  vg_junctions_release(&j);
  vg_mesh_release(&to.m);
  vg_mesh_release(&sheets.m);
  vg_mesh_release(&walls);
  return st;
}

/* A patch that is lost as a whole was not meant to be. */
static vg_status check_patches(const struct vg_boundary *b,
                               const struct vg_mesh *m, size_t n_wall,
                               struct vg_error *err)
{
  uint8_t *has = vg_calloc(m->n_patch, 1);
  vg_status st = VG_OK;

  if (!has) return vg_fail_memory(err, "the patches");
  for (size_t t = n_wall; t < m->n_tri; t++) has[m->tri_patch[t]] = 1;
  for (size_t t = 0; t < b->inner.n_tri && st >= 0; t++) {
    const struct vg_patch *p = &m->patch[b->inner.tri_patch[t]];

    if (!has[b->inner.tri_patch[t]])
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "patch %d%s%s, an inner surface, is inside a body or beyond "
                   "the symmetry plane as a whole; move it into the fluid, or "
                   "remove it from the surface",
                   (int)p->id, *p->name ? " " : "", p->name);
  }
  free(has);
  return st;
}

/* Points that only triangles of one part have are copied to it. */
static vg_status select_part(const struct vg_mesh *m, size_t first, size_t end,
                             struct vg_mesh *to, struct vg_error *err)
{
  uint32_t *number = vg_alloc(m->n_point, sizeof *number);
  const size_t n = end - first;

  to->point = vg_alloc(3 * n, sizeof *to->point);
  to->tri = vg_alloc(n, sizeof *to->tri);
  to->tri_patch = vg_alloc(n, sizeof *to->tri_patch);
  if (!number || !to->point || !to->tri || !to->tri_patch) {
    free(number);
    return vg_fail_memory(err, "the inner surfaces");
  }
  memset(number, 0xff, m->n_point * sizeof *number);
  for (size_t t = first; t < end; t++) {
    for (int k = 0; k < 3; k++) {
      uint32_t *at = &number[m->tri[t][k]];

      if (*at == UINT32_MAX) {
        *at = (uint32_t)to->n_point;
        memcpy(to->point[to->n_point++], m->point[m->tri[t][k]],
               sizeof *m->point);
      }
      to->tri[to->n_tri][k] = *at;
    }
    to->tri_patch[to->n_tri++] = m->tri_patch[t];
  }
  free(number);
  return VG_OK;
}

/* Replaces surface and inner surfaces of b by the parts of m. */
static vg_status put(struct vg_boundary *b, struct vg_mesh *m, size_t n_wall,
                     struct vg_error *err)
{
  struct vg_mesh wall = VG_MESH_INIT, inner = VG_MESH_INIT;
  vg_status st;

  VG_TRY(select_part(m, 0, n_wall, &wall, err));
  VG_TRY(select_part(m, n_wall, m->n_tri, &inner, err));
  wall.patch = m->patch;
  wall.n_patch = m->n_patch;
  m->patch = NULL;
  m->n_patch = 0;
  vg_mesh_move(&b->surface, &wall);
  vg_mesh_move(&b->inner, &inner);
done:
  vg_mesh_release(&wall);
  vg_mesh_release(&inner);
  return st;
}

static vg_status cut(struct vg_boundary *b, struct vg_mesh *all, int crosses,
                     const struct vg_junction_half *half, double near,
                     struct vg_display *show, struct vg_error *err)
{
  const struct vg_stop stop = { vg_display_stop, show };
  const size_t n_given = b->inner.n_tri;
  struct vg_mesh m = VG_MESH_INIT;
  size_t n_wall;
  double lost = 0;
  vg_status st;

  VG_TRY(gather(b, all, near, &m, &n_wall, err));
  if (crosses) st = vg_imprint(&m, n_wall, &stop, &n_wall, err);
  if (st == VG_BLOCKED)
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "inner surfaces cross other surfaces, and the common curves "
                 "cannot be found, because one of them is not a manifold");
  VG_TRY(st);
  if (half->axis >= 0) VG_TRY(vg_junction_clip(&m, n_wall, half, &lost, err));
  VG_TRY(vg_surface_merge_points(&m, err));
  n_wall = vg_junction_drop_flat(&m, n_wall);
  VG_TRY(vg_junction_mend(&m, &n_wall, near, err));
  VG_TRY(vg_junction_drop_solid(&m, n_wall, &lost, err));
  VG_TRY(check_patches(b, &m, n_wall, err));
  VG_TRY(put(b, &m, n_wall, err));
  vg_note(b->notes,
          "inner surfaces were cut where they cross other surfaces or the "
          "symmetry plane: %zu triangles became %zu; parts inside bodies or "
          "outside the domain, of area %.6g, were removed",
          n_given, b->inner.n_tri, lost);
done:
  vg_mesh_release(&m);
  return st;
}

/* --- farfields that are not made yet ------------------------------------- */

static vg_status refuse_beyond(const struct vg_boundary *b, const char *where,
                               const double x[3], uint32_t patch,
                               const double lo[3], const double hi[3],
                               struct vg_error *err)
{
  const struct vg_patch *p = &b->surface.patch[patch];

  return vg_fail(err, VG_ERR_GEOMETRY,
                 "patch %d%s%s, an inner surface, %s at (%g, %g, %g); the "
                 "generated boundary reaches from (%g, %g, %g) to "
                 "(%g, %g, %g): make the farfield larger (table farfield: "
                 "size or lengths; upstream, downstream or radial with kind "
                 "mach)%s",
                 (int)p->id, *p->name ? " " : "", p->name, where, x[0], x[1],
                 x[2], lo[0], lo[1], lo[2], hi[0], hi[1], hi[2],
                 b->is_remeshed
                   ? ", or move the inner surface"
                   : ", let the inner surface end before it, or set "
                     "remesh_surface to yes, which cuts it there");
}

/* Refuses a patch of inner surfaces that lies beyond the box around the domain
 * as a whole. */
static vg_status check_reach(const struct vg_boundary *b, const double lo[3],
                             const double hi[3], struct vg_error *err)
{
  const struct vg_mesh *m = &b->inner;
  uint8_t *has = vg_calloc(b->surface.n_patch, 1);
  vg_status st = VG_OK;

  if (!has) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < 3 * m->n_tri; i++) {
    const double *x = m->point[m->tri[i / 3][i % 3]];

    has[m->tri_patch[i / 3]] |= x[0] > lo[0] && x[0] < hi[0] && x[1] > lo[1] &&
                                x[1] < hi[1] && x[2] > lo[2] && x[2] < hi[2];
  }
  for (size_t t = 0; t < m->n_tri && st >= 0; t++)
    if (!has[m->tri_patch[t]])
      st = refuse_beyond(b, "lies beyond the generated boundary as a whole",
                         m->point[m->tri[t][0]], m->tri_patch[t], lo, hi, err);
  free(has);
  return st;
}

/* The box around the domain with the generated farfield, which is made coarsely
 * for that. has: out: 0: the domain has no generated farfield, or it cannot be
 * made. */
static vg_status farfield_box(const struct vg_boundary *b, int *has,
                              double lo[3], double hi[3], struct vg_error *err)
{
  struct vg_farfield far = vg_boundary_farfield(b);
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error why = VG_ERROR_INIT;
  vg_status st;

  *has = 0;
  if (b->flow.kind != VG_FLOW_EXTERNAL || far.kind == VG_FARFIELD_NONE)
    return VG_OK;
  far.symmetry = b->flow.axis < 0 ? -1 : 1;
  if (!(far.spacing > 0)) far.spacing = 1e3 * vg_boundary_length(b);
  VG_TRY(vg_mesh_copy(&m, &b->surface, err));
  st = vg_domain_complete(&m, &far, NULL, NULL, &why);
  *has = st >= 0;
  if (*has) vg_mesh_bounds(&m, lo, hi);
  st = st == VG_ERR_MEMORY ? vg_fail(err, st, "%s", why.text) : VG_OK;
done:
  vg_mesh_release(&m);
  return st;
}

/* Cuts inner surfaces off at a box a little larger than the farfield, so that
 * what is far beyond it is not remeshed. */
static vg_status clip_far(struct vg_boundary *b, struct vg_error *err)
{
  struct vg_mesh *m = &b->inner;
  double lo[3], hi[3], lost = 0;
  int has;
  vg_status st = farfield_box(b, &has, lo, hi, err);

  if (st < 0 || !has) return st;
  VG_TRY(check_reach(b, lo, hi, err));
  for (int k = 0; k < 6; k++) {
    const double more = ROOM * (hi[k / 2] - lo[k / 2]);
    const struct vg_junction_half half = { k / 2, !(k % 2),
                                           k % 2 ? hi[k / 2] + more
                                                 : lo[k / 2] - more };

    VG_TRY(vg_junction_clip(m, 0, &half, &lost, err));
  }
  if (!(lost > 0)) goto done;
  vg_note(b->notes,
          "parts of inner surfaces far beyond the generated farfield, of area "
          "%.6g, were removed",
          lost);
  st = vg_surface_merge_points(m, err);
done:
  return st;
}

vg_status vg_boundary_imprint(struct vg_boundary *b, int *is_cut,
                              struct vg_display *show, struct vg_error *err)
{
  struct vg_mesh all = VG_MESH_INIT;
  struct vg_junction_half half;
  double off;
  int crosses;
  vg_status st = VG_OK;

  assert(b->inner.n_tri);
  *is_cut = 0;
  vg_display_update(show, "inner surfaces", b->inner.n_tri, 0);
  if (b->flow.axis >= 0)
    VG_TRY(vg_domain_flatten(&b->surface, b->flow.axis, b->flow.at, &off, err));
  VG_TRY(clip_far(b, err));
  half = half_of(b);
  flatten_inner(b, &half);
  VG_TRY(vg_boundary_with_inner(b, &all, err));
  VG_TRY(vg_inner_orient_all(b, &all, err));
  VG_TRY(find_crossings(b, &all, show, &crosses, NULL, err));
  if (!crosses && !reaches_beyond(b, &half)) goto done;
  VG_TRY(cut(b, &all, crosses, &half, SNAP * vg_boundary_length(b), show, err));
  *is_cut = 1;
done:
  vg_mesh_release(&all);
  return st;
}

/* --- the generated outer boundary ---------------------------------------- */

/* The surface of a boundary that was completed, and the parts of it. */
struct outer {
  struct vg_boundary view; /* Its surface is the part that was added, whose
                              patches are those of the boundary. */
  struct vg_mesh body;     /* The rest; without patches. */
};

static vg_status open_outer(const struct vg_boundary *b, struct outer *o,
                            struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  const size_t n_body = m->n_tri - b->domain.n_added_tri;
  vg_status st;

  o->view = *b;
  o->view.surface = o->view.inner = o->body = (struct vg_mesh)VG_MESH_INIT;
  VG_TRY(select_part(m, 0, n_body, &o->body, err));
  VG_TRY(select_part(m, n_body, m->n_tri, &o->view.surface, err));
  VG_TRY(vg_mesh_copy(&o->view.inner, &b->inner, err));
  VG_TRY(copy_patches(m, &o->view.surface, err));
done:
  return st;
}

static void release_outer(struct outer *o)
{
  vg_mesh_release(&o->view.surface);
  vg_mesh_release(&o->view.inner);
  vg_mesh_release(&o->body);
}

/* Appends the outer boundary to the rest of the surface, which it replaces. */
static vg_status join_outer(struct vg_boundary *b, const struct vg_mesh *body,
                            const struct vg_mesh *added, struct vg_error *err)
{
  struct vg_growing_mesh to = VG_GROWING_MESH_INIT;
  vg_status st;

  VG_TRY(vg_grow_mesh(&to, body, err));
  VG_TRY(vg_grow_mesh(&to, added, err));
  VG_TRY(vg_surface_merge_points(&to.m, err));
  to.m.patch = b->surface.patch;
  to.m.n_patch = b->surface.n_patch;
  b->surface.patch = NULL;
  b->surface.n_patch = 0;
  vg_mesh_move(&b->surface, &to.m);
  b->domain.n_added_tri = added->n_tri;
done:
  vg_mesh_release(&to.m);
  return st;
}

/* Marks the points of the outer boundary on rims that it shares with the rest,
 * and takes over marks and sizes of the surface. */
static void mark_added(const struct vg_boundary *b,
                       const struct vg_sizing *sizing, const uint8_t *on_body,
                       const struct vg_inner_lines *l, const double *from,
                       const struct vg_mesh *added, uint8_t *still, double *cap)
{
  const size_t n_body = b->surface.n_tri - added->n_tri;
  const double scale = b->read->settings.scale;

  for (size_t i = 0; i < 3 * added->n_tri; i++) {
    const uint32_t p = b->surface.tri[n_body + i / 3][i % 3];
    const uint32_t q = added->tri[i / 3][i % 3];

    still[q] = on_body[p] ? VG_REMESH_KEPT : l->still ? l->still[p] : 0;
    cap[q] = fmin(from ? scale * from[p] : INFINITY,
                  vg_sizing_at(sizing, added->point[q]));
  }
}

/* Sizes are those of the field: a generated boundary has no shape to keep. */
static struct vg_remesh_options outer_options(const struct vg_boundary *b,
                                              double spacing,
                                              struct vg_display *show)
{
  struct vg_remesh_options o = vg_options_remesh(&b->read->settings);
  double lo[3], hi[3], side = 0;

  vg_mesh_bounds(&b->surface, lo, hi);
  for (int k = 0; k < 3; k++) side = fmax(side, hi[k] - lo[k]);
  o.n_source = 0;
  o.accuracy = 0;
  o.per_turn = VG_OUTER_PER_TURN;
  o.tolerance = VG_OUTER_TOLERANCE * vg_distance(lo, hi);
  o.scale = 1; /* `spacing` and the field are scaled */
  o.h_max = spacing > 0 ? fmin(spacing, side / 8) : side / 8;
  o.h_min = fmin(o.h_min, o.h_max);
  o.is_requested = 1;
  o.is_body = 1;
  o.threads = b->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  return o;
}

/* Remeshes the outer boundary, whose rims with the rest stay, and then the
 * inner surfaces, which take over the points of the common curves. */
static vg_status remesh_outer(struct vg_boundary *b,
                              const struct vg_sizing *sizing, double spacing,
                              struct vg_display *show, struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  const size_t n_body = m->n_tri - b->domain.n_added_tri;
  struct vg_remesh_options o = outer_options(b, spacing, show);
  struct vg_inner_lines l = VG_INNER_LINES_INIT;
  struct vg_mesh body = VG_MESH_INIT, added = VG_MESH_INIT;
  double *stretch = NULL, *from = NULL, *cap = NULL;
  uint8_t *on_body = vg_calloc(m->n_point, 1), *still = NULL;
  vg_status st;

  if (!on_body) return vg_fail_memory(err, "the farfield");
  VG_TRY(vg_inner_lines_find(b, &l, &stretch, &from, err));
  VG_TRY(select_part(m, 0, n_body, &body, err));
  VG_TRY(select_part(m, n_body, m->n_tri, &added, err));
  for (size_t i = 0; i < 3 * n_body; i++) on_body[m->tri[i / 3][i % 3]] = 1;
  still = vg_calloc(added.n_point, 1);
  cap = vg_alloc(added.n_point, sizeof *cap);
  if (!still || !cap) VG_TRY(vg_fail_memory(err, "the farfield"));
  mark_added(b, sizing, on_body, &l, from, &added, still, cap);
  VG_TRY(copy_patches(m, &added, err));
  o.still = still;
  o.cap = cap;
  o.stretch = stretch ? stretch + 3 * n_body : NULL;
  VG_TRY(vg_remesh(&added, &o, NULL, err));
  VG_TRY(join_outer(b, &body, &added, err));
  if (l.still) VG_TRY(vg_junctions_trace(&l.junctions, 0, &b->surface, err));
  VG_TRY(vg_inner_lines_remesh(b, &l, show, err));
done:
  vg_inner_lines_release(&l);
  vg_mesh_release(&body);
  vg_mesh_release(&added);
  free(on_body);
  free(still);
  free(cap);
  free(stretch);
  free(from);
  return st;
}

vg_status vg_boundary_cut_outer(struct vg_boundary *b,
                                const struct vg_sizing *sizing, double spacing,
                                int *is_cut, struct vg_display *show,
                                struct vg_error *err)
{
  const struct vg_junction_half none = { .axis = -1 };
  struct outer o;
  struct vg_mesh all = VG_MESH_INIT;
  struct vg_defect first;
  double lo[3], hi[3];
  vg_status st;

  VG_TRY(open_outer(b, &o, err));
  vg_mesh_bounds(&b->surface, lo, hi);
  VG_TRY(check_reach(b, lo, hi, err));
  VG_TRY(vg_boundary_with_inner(&o.view, &all, err));
  VG_TRY(find_crossings(&o.view, &all, show, is_cut, &first, err));
  if (!*is_cut) goto done;
  if (!b->remeshing.is_done) {
    const size_t t = first.face[0] < first.face[1] ? first.face[1]
                                                   : first.face[0];

    VG_TRY(refuse_beyond(b, "crosses the generated boundary", first.at,
                         all.tri_patch[t], lo, hi, err));
  }
  VG_TRY(
    cut(&o.view, &all, 1, &none, SNAP * vg_mesh_length(&o.body), show, err));
  VG_TRY(join_outer(b, &o.body, &o.view.surface, err));
  vg_mesh_move(&b->inner, &o.view.inner);
  st = remesh_outer(b, sizing, spacing, show, err);
done:
  release_outer(&o);
  vg_mesh_release(&all);
  return st;
}
