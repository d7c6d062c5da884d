/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cuts inner surfaces that cross other surfaces. The common curves become edges
 * of both, and parts outside the fluid are removed. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/planar.h"
#include "core/junction/junction.h"
#include "core/wrap/unite.h"
#include "run/input/shape_parts.h"
#include "run/settings/plan_options.h"

#define SNAP 1e-5 /* S106: of the length of the walls */

/* Does an inner surface of `all` intersect a wall or another one? */
static vg_status find_crossings(const struct vg_boundary *b,
                                struct vg_mesh *all, struct vg_display *show,
                                int *any, struct vg_error *err)
{
  struct vg_surface_check_options o = vg_inner_check_options(b, show);
  struct vg_surface_report r = { .n_defect = 0 };
  vg_status st;

  VG_TRY(vg_surface_check(all, &o, &r, err));
  *any = 0;
  for (size_t i = 0; i < r.n_defect; i++)
    *any |= r.defect[i].kind == VG_DEFECT_INTERSECTION &&
            (r.defect[i].face[0] >= b->surface.n_tri ||
             r.defect[i].face[1] >= b->surface.n_tri);
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

/* The walls and the pieces of inner surfaces, with points of their own. n_wall:
 * out, triangles of walls. */
static vg_status gather(const struct vg_boundary *b, const struct vg_mesh *all,
                        struct vg_mesh *out, size_t *n_wall,
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
  VG_TRY(vg_junction_snap(&walls, &sheets.m, SNAP * vg_boundary_length(b),
                          &n_moved, err));
  if (n_moved)
    vg_note(b->notes,
            "%zu points of inner surfaces were moved by at most %.3g onto "
            "sharp edges next to them",
            n_moved, SNAP * vg_boundary_length(b));
  *n_wall = walls.n_tri;
  VG_TRY(vg_grow_mesh(&to, &walls, err));
  VG_TRY(vg_grow_mesh(&to, &sheets.m, err));
  to.m.patch = vg_alloc(all->n_patch, sizeof *to.m.patch);
  if (!to.m.patch) VG_TRY(vg_fail_memory(err, "the patches"));
  memcpy(to.m.patch, all->patch, all->n_patch * sizeof *all->patch);
  to.m.n_patch = all->n_patch;
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
                     const struct vg_junction_half *half,
                     struct vg_display *show, struct vg_error *err)
{
  const struct vg_stop stop = { vg_display_stop, show };
  const size_t n_given = b->inner.n_tri;
  struct vg_mesh m = VG_MESH_INIT;
  size_t n_wall;
  double lost = 0;
  vg_status st;

  VG_TRY(gather(b, all, &m, &n_wall, err));
  if (crosses) st = vg_imprint(&m, n_wall, &stop, &n_wall, err);
  if (st == VG_BLOCKED)
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "inner surfaces cross other surfaces, and the common curves "
                 "cannot be found, because one of them is not a manifold");
  VG_TRY(st);
  if (half->axis >= 0) VG_TRY(vg_junction_clip(&m, n_wall, half, &lost, err));
  VG_TRY(vg_surface_merge_points(&m, err));
  n_wall = vg_junction_drop_flat(&m, n_wall);
  VG_TRY(vg_junction_drop_solid(&m, n_wall, &lost, err));
  VG_TRY(check_patches(b, &m, n_wall, err));
  VG_TRY(put(b, &m, n_wall, err));
  vg_note(b->notes,
          "inner surfaces were cut where they cross other surfaces or the "
          "symmetry plane: %zu triangles became %zu; parts inside bodies or "
          "beyond the plane, of area %.6g, were removed",
          n_given, b->inner.n_tri, lost);
done:
  vg_mesh_release(&m);
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
  half = half_of(b);
  flatten_inner(b, &half);
  VG_TRY(vg_boundary_with_inner(b, &all, err));
  VG_TRY(vg_inner_orient_all(b, &all, err));
  VG_TRY(find_crossings(b, &all, show, &crosses, err));
  if (!crosses && !reaches_beyond(b, &half)) goto done;
  VG_TRY(cut(b, &all, crosses, &half, show, err));
  *is_cut = 1;
done:
  vg_mesh_release(&all);
  return st;
}
