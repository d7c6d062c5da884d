/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds flat patches and ends of shells. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/flow/evidence.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"

/* F1 */
#define FLAT 1e-4  /* of the shell's length: deviation of a flat patch */
#define STEEP 0.7  /* cosine between a wall and the plane of an end */
#define LEVEL 1e-6 /* 1 - cosine between a flush opening and its wall */
#define MOSTLY 0.7 /* least share of the border that meets it steeply */
#define LARGE                                                                  \
  1e-3 /* of the total area: least area of an opening without name */

static void normal_of(const struct vg_mesh *m, size_t t, double n[3])
{
  double u[3], v[3];

  vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], u);
  vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], v);
  vg_cross(u, v, n);
}

static void add_normals(const struct vg_mesh *m,
                        const struct vg_surface_report *r,
                        struct vg_flow_patch *patch)
{
  for (size_t t = 0; t < m->n_tri; t++) {
    struct vg_flow_patch *p = &patch[m->tri_patch[t]];
    double n[3];

    normal_of(m, t, n);
    if (!p->is_used) p->shell = r->tri_shell[t];
    p->is_used = 1;
    p->area += vg_norm(n) / 2;
    for (int k = 0; k < 3; k++) p->normal[k] += n[k];
  }
}

/* Range of the points of a patch, and of its shell, along its normal. */
struct range {
  double lo, hi, shell_lo, shell_hi;
};

static void widen(double x, double *lo, double *hi)
{
  if (x < *lo) *lo = x;
  if (x > *hi) *hi = x;
}

/* Measure the patches that may be ends. They are few, so that each can afford a
 * loop over all triangles. */
static void measure_flat(const struct vg_mesh *m,
                         const struct vg_surface_report *r,
                         struct vg_flow_patch *p, size_t at)
{
  const struct vg_shell *s = &r->shell[p->shell];
  struct range g = { INFINITY, -INFINITY, INFINITY, -INFINITY };
  double unit[3], length = 0;
  const double size = vg_norm(p->normal);

  for (int k = 0; k < 3; k++) {
    length = fmax(length, s->hi[k] - s->lo[k]);
    unit[k] = p->normal[k] / size;
  }
  for (size_t t = 0; t < m->n_tri; t++) {
    const int is_own = m->tri_patch[t] == at;

    if (!is_own && r->tri_shell[t] != p->shell) continue;
    for (int k = 0; k < 3; k++) {
      const double x = vg_dot(unit, m->point[m->tri[t][k]]);

      if (is_own) widen(x, &g.lo, &g.hi);
      widen(x, &g.shell_lo, &g.shell_hi);
    }
  }
  p->is_flat = g.hi - g.lo <= FLAT * length;
  p->plane = 0.5 * (g.lo + g.hi);
  p->is_end = p->is_flat && (g.shell_hi - p->plane <= FLAT * length ||
                             p->plane - g.shell_lo <= FLAT * length);
}

/* Length of the border of a patch, of its steep part, and of the part where the
 * wall continues the patch. */
struct border {
  double all, steep, level;
};

static void add_border(const struct vg_mesh *m, size_t at, size_t adjacent,
                       double length, const struct vg_flow_patch *patch,
                       struct border *border)
{
  const uint32_t own = m->tri_patch[at];
  double n[3], cosine;

  if (!patch[own].is_end) return;
  normal_of(m, adjacent, n);
  border[own].all += length;
  cosine = vg_dot(n, patch[own].normal) /
           (vg_norm(n) * vg_norm(patch[own].normal));
  if (fabs(cosine) <= STEEP) border[own].steep += length;
  if (cosine >= 1 - LEVEL) border[own].level += length;
}

/* Flat patches on the outermost planes with steep borders are ends; those with
 * level borders are flush. */
static vg_status find_ends(const struct vg_mesh *m, struct vg_flow_patch *patch,
                           struct vg_error *err)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])m->tri;
  struct border *border = vg_calloc(m->n_patch, sizeof *border);
  struct vg_edges e = VG_EDGES_INIT;
  vg_status st = VG_OK;

  if (!border) VG_TRY(vg_fail_memory(err, "the ends of the surface"));
  VG_TRY(vg_edges_build(&e, m->n_point, m->n_tri, tri, NULL, 0, err));
  for (size_t i = 0; i < e.n; i++)
    for (uint32_t k = 1; k < vg_edges_count(&e, i); k++) {
      const uint32_t *h = vg_edges_at(&e, i) + k - 1;
      const size_t s = h[0] / 3, t = h[1] / 3;
      double length;

      if (m->tri_patch[s] == m->tri_patch[t]) continue;
      length = vg_distance(m->point[vg_half_from(tri, h[0])],
                           m->point[vg_half_to(tri, h[0])]);
      add_border(m, s, t, length, patch, border);
      add_border(m, t, s, length, patch, border);
    }
  for (size_t i = 0; i < m->n_patch; i++) {
    patch[i].is_flush = patch[i].is_end && border[i].all > 0 &&
                        border[i].level >= MOSTLY * border[i].all;
    patch[i].is_end &= border[i].all > 0 &&
                       border[i].steep >= MOSTLY * border[i].all;
  }
done:
  vg_edges_release(&e);
  free(border);
  return st;
}

/* Is the location of the patch evidence? It is for openings and symmetry planes
 * and, next to named walls, for patches without condition and name. The area of
 * a flat patch is half the length of the sum of its normals. */
static int may_be_end(const struct vg_flow_patch *p, int has_walls, double area)
{
  if (!p->is_used || p->shell == UINT32_MAX ||
      vg_norm(p->normal) < 2 * p->area * (1 - FLAT))
    return 0;
  if (p->role == VG_ROLE_NONE) return has_walls && p->area >= LARGE * area;
  return p->role == VG_ROLE_INLET || p->role == VG_ROLE_OUTLET ||
         p->role == VG_ROLE_SYMMETRY;
}

vg_status vg_flow_patches(const struct vg_mesh *m,
                          const struct vg_surface_report *r,
                          struct vg_flow_patch **out, struct vg_error *err)
{
  struct vg_flow_patch *patch = vg_calloc(m->n_patch, sizeof *patch);
  double area = 0;
  int any = 0, has_walls = 0;
  vg_status st = VG_OK;

  if (!patch) return vg_fail_memory(err, "the patches");
  add_normals(m, r, patch);
  for (size_t i = 0; i < m->n_patch; i++) {
    struct vg_flow_patch *p = &patch[i];

    p->role = vg_flow_role_of(&m->patch[i]);
    p->has_condition = m->patch[i].bc != VG_BC_NONE ||
                       m->patch[i].bc_fun3d != VG_BC_NONE;
    has_walls |= p->is_used && p->role == VG_ROLE_WALL;
    area += p->area;
  }
  for (size_t i = 0; i < m->n_patch; i++) {
    if (!may_be_end(&patch[i], has_walls, area)) continue;
    measure_flat(m, r, &patch[i], i);
    any |= patch[i].is_end;
  }
  if (any) st = find_ends(m, patch, err);
  if (st < 0) free(patch);
  else *out = patch;
  return st;
}
