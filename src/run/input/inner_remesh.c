/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Remeshes inner surfaces after the walls. Each piece takes over the points of
 * the edges that it shares with those before it (core/junction/junction.h). */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/sides/inner.h"
#include "run/input/shape_parts.h"
#include "run/settings/plan_options.h"

#define TOLERANCE 1e-4 /* S20: of the length of the walls */
#define H_MIN 2e-4     /* the same */

double vg_boundary_length(const struct vg_boundary *b)
{
  return vg_mesh_length(&b->surface);
}

vg_status vg_inner_orient_all(const struct vg_boundary *b, struct vg_mesh *all,
                              struct vg_error *err)
{
  uint8_t *is_inner = vg_calloc(all->n_patch, 1);
  struct vg_inner_report r;
  vg_status st;

  if (!is_inner) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < all->n_patch; i++)
    is_inner[i] = all->patch[i].inner == VG_INNER_FRONT;
  st = vg_inner_turn(all, is_inner, &r, err);
  if (st >= 0 && r.n_turned)
    vg_note(b->notes, VG_INNER_TURNED, r.n_turned, r.turned_at[0],
            r.turned_at[1], r.turned_at[2]);
  free(is_inner);
  return st;
}

/* Sizes that inner surfaces request by their shape, [points of all]: their
 * junctions must be as fine. */
static vg_status add_sizes(const struct vg_boundary *b,
                           struct vg_inner_lines *l, uint32_t i,
                           struct vg_error *err)
{
  const struct vg_junctions *j = &l->junctions;
  struct vg_junction_piece p = VG_JUNCTION_PIECE_INIT;
  struct vg_remesh_options o = vg_options_remesh(&b->read->settings);
  const double length = vg_boundary_length(b);
  double *size = NULL;
  size_t n = 0;
  vg_status st;

  VG_TRY(vg_junctions_piece(j, i, &p, err));
  size = vg_alloc(p.mesh.n_point, sizeof *size);
  if (!size) VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  o.is_body = 1;
  o.stretch = p.stretch;
  if (!(o.tolerance > 0)) o.tolerance = TOLERANCE * length;
  if (!(o.h_max > 0)) o.h_max = length;
  if (!(o.h_min > 0)) o.h_min = fmin(H_MIN * length, o.h_max);
  VG_TRY(vg_remesh_sizes(&p.mesh, &o, size, err));
  for (size_t t = 0; t < l->all.n_tri; t++) {
    if (j->piece[t] != i) continue;
    for (int k = 0; k < 3; k++) {
      double *to = &l->size[l->all.tri[t][k]];

      *to = fmin(*to, size[p.mesh.tri[n][k]] / o.scale);
    }
    n++;
  }
done:
  free(size);
  vg_junction_piece_release(&p);
  return st;
}

static vg_status find_sizes(const struct vg_boundary *b,
                            struct vg_inner_lines *l, double **cap,
                            struct vg_error *err)
{
  const struct vg_mesh *walls = &b->surface;
  vg_status st = VG_OK;

  l->size = vg_alloc(l->all.n_point, sizeof *l->size);
  if (!l->size) return vg_fail_memory(err, "the inner surfaces");
  for (size_t p = 0; p < l->all.n_point; p++) l->size[p] = INFINITY;
  for (uint32_t i = 1; i < l->junctions.n_piece; i++)
    VG_TRY(add_sizes(b, l, i, err));
  l->junctions.size = l->size;
  if (!*cap) {
    *cap = vg_alloc(walls->n_point, sizeof **cap);
    if (!*cap) VG_TRY(vg_fail_memory(err, "the sizes on the surface"));
    for (size_t p = 0; p < walls->n_point; p++) (*cap)[p] = INFINITY;
  }
  for (size_t i = 0; i < 3 * walls->n_tri; i++) {
    double *to = &(*cap)[walls->tri[i / 3][i % 3]];

    *to = fmin(*to, l->size[l->all.tri[i / 3][i % 3]]);
  }
done:
  return st;
}

vg_status vg_inner_lines_find(const struct vg_boundary *b,
                              struct vg_inner_lines *l, double **stretch,
                              double **cap, struct vg_error *err)
{
  const size_t n = 3 * b->surface.n_tri;
  vg_status st;

  if (!b->inner.n_tri) return VG_OK;
  VG_TRY(vg_boundary_with_inner(b, &l->all, err));
  VG_TRY(vg_inner_orient_all(b, &l->all, err));
  VG_TRY(vg_junctions_find(&l->all, b->surface.n_tri, &l->junctions, err));
  if (!l->junctions.n_edge) goto done;
  l->still = vg_calloc(b->surface.n_point, 1);
  if (!*stretch) *stretch = vg_calloc(n, sizeof **stretch);
  if (!l->still || !*stretch) VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  vg_junctions_mark(&l->junctions, &b->surface, *stretch, l->still);
  st = find_sizes(b, l, cap, err);
done:
  return st;
}

void vg_inner_lines_release(struct vg_inner_lines *l)
{
  vg_junctions_release(&l->junctions);
  vg_mesh_release(&l->all);
  free(l->still);
  free(l->size);
  l->still = NULL;
  l->size = NULL;
}

/* Sizes and tolerance of the walls. */
static struct vg_remesh_options options(const struct vg_boundary *b,
                                        const struct vg_junction_piece *p,
                                        struct vg_display *show)
{
  const struct vg_remesh_report *r = &b->remeshing.report;
  struct vg_remesh_options o = vg_options_remesh(&b->read->settings);

  o.tolerance = r->tolerance / (o.scale * fmax(o.scale, 1));
  o.h_max = (r->far > 0 ? r->far : r->h_max) / o.scale;
  o.h_min = r->h_min / o.scale;
  o.map = b->map;
  o.cap = p->cap;
  o.stretch = p->stretch;
  o.still = p->still;
  o.is_body = 1;
  o.threads = b->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  return o;
}

vg_status vg_grow_mesh(struct vg_growing_mesh *to, const struct vg_mesh *m,
                       struct vg_error *err)
{
  const size_t n_point = to->m.n_point + m->n_point;
  const size_t n_tri = to->m.n_tri + m->n_tri;

  if (vg_reserve(&to->m.point, &to->cap[0], n_point, sizeof *m->point) ||
      vg_reserve(&to->m.tri, &to->cap[1], n_tri, sizeof *m->tri) ||
      vg_reserve(&to->m.tri_patch, &to->cap[2], n_tri, sizeof *m->tri_patch))
    return vg_fail_memory(err, "the inner surfaces");
  if (m->n_point)
    memcpy(to->m.point + to->m.n_point, m->point,
           m->n_point * sizeof *m->point);
  for (size_t t = 0; t < m->n_tri; t++) {
    for (int k = 0; k < 3; k++)
      to->m.tri[to->m.n_tri + t][k] = m->tri[t][k] + (uint32_t)to->m.n_point;
    to->m.tri_patch[to->m.n_tri + t] = m->tri_patch[t];
  }
  to->m.n_point = n_point;
  to->m.n_tri = n_tri;
  return VG_OK;
}

static vg_status remesh_piece(const struct vg_boundary *b,
                              struct vg_inner_lines *l, uint32_t i,
                              struct vg_growing_mesh *to,
                              struct vg_display *show, struct vg_error *err)
{
  struct vg_junction_piece p = VG_JUNCTION_PIECE_INIT;
  struct vg_error why = VG_ERROR_INIT;
  struct vg_remesh_options o;
  const struct vg_patch *patch;
  vg_status st;

  VG_TRY(vg_junctions_piece(&l->junctions, i, &p, err));
  o = options(b, &p, show);
  patch = &b->surface.patch[p.patch];
  st = vg_remesh(&p.mesh, &o, NULL, &why);
  if (st < 0)
    VG_TRY(vg_fail(err, st, "patch %d%s%s, an inner surface: %s",
                   (int)patch->id, *patch->name ? " " : "", patch->name,
                   why.text));
  VG_TRY(vg_junctions_trace(&l->junctions, i, &p.mesh, err));
  VG_TRY(vg_grow_mesh(to, &p.mesh, err));
done:
  vg_junction_piece_release(&p);
  return st;
}

vg_status vg_inner_lines_remesh(struct vg_boundary *b, struct vg_inner_lines *l,
                                struct vg_display *show, struct vg_error *err)
{
  const size_t n = b->inner.n_tri;
  struct vg_growing_mesh made = VG_GROWING_MESH_INIT;
  vg_status st = VG_OK;

  if (!n) return VG_OK;
  vg_display_update(show, "inner surfaces", n, 0);
  vg_junctions_place(&l->junctions, &b->surface);
  for (uint32_t i = 1; i < l->junctions.n_piece; i++)
    VG_TRY(remesh_piece(b, l, i, &made, show, err));
  vg_note(b->notes,
          "the inner surfaces were remeshed: %zu triangles, %zu before; curves "
          "along which they share edges with other surfaces: %zu",
          made.m.n_tri, n, l->junctions.n);
  vg_mesh_move(&b->inner, &made.m);
done:
  vg_mesh_release(&made.m);
  return st;
}

/* Backs are the last patches while their triangles are apart. */
vg_status vg_boundary_single_sides(const struct vg_boundary *b,
                                   struct vg_mesh *out, struct vg_error *err)
{
  vg_status st = b->inner.n_tri ? vg_boundary_with_inner(b, out, err)
                                : vg_mesh_copy(out, &b->surface, err);

  while (st >= 0 && b->inner.n_tri && out->n_patch &&
         out->patch[out->n_patch - 1].inner == VG_INNER_BACK)
    out->n_patch--;
  return st;
}
