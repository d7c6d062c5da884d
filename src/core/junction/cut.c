/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Parts of inner surfaces that are outside the fluid: beyond the plane of a
 * half model, or inside bodies. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"
#include "core/junction/junction.h"
#include "core/sides/sides.h"

/* S107: share of the edges with walls that slivers may see from the wrong side.
 */
#define MIXED 0.01

static double area_of(const struct vg_mesh *m, size_t t)
{
  const uint32_t *v = m->tri[t];

  return vg_triangle_area(m->point[v[0]], m->point[v[1]], m->point[v[2]]);
}

/* --- half models -----------------------------------------------------------
 */

struct clipper {
  struct vg_mesh *m;
  const struct vg_junction_half *half;
  size_t cap_point, cap_tri, cap_patch;
};

/* Distance from the plane, into the domain. */
static double depth(const struct clipper *c, uint32_t p)
{
  const double d = c->m->point[p][c->half->axis] - c->half->at;

  return c->half->is_above ? d : -d;
}

/* Appends the point of the edge from p to q in the plane, the same one for both
 * directions. */
static vg_status cut_edge(struct clipper *c, uint32_t p, uint32_t q,
                          uint32_t *made, struct vg_error *err)
{
  struct vg_mesh *m = c->m;
  const uint32_t a = p < q ? p : q, b = p < q ? q : p;
  const double t = depth(c, a) / (depth(c, a) - depth(c, b));
  double *x;

  if (vg_reserve(&m->point, &c->cap_point, m->n_point + 1, sizeof *m->point))
    return vg_fail_memory(err, "the inner surfaces");
  x = m->point[m->n_point];
  for (int d = 0; d < 3; d++)
    x[d] = (1 - t) * m->point[a][d] + t * m->point[b][d];
  x[c->half->axis] = c->half->at;
  *made = (uint32_t)m->n_point++;
  return VG_OK;
}

static vg_status add_triangle(struct clipper *c, const uint32_t v[3],
                              uint32_t patch, struct vg_error *err)
{
  struct vg_mesh *m = c->m;

  if (vg_reserve(&m->tri, &c->cap_tri, m->n_tri + 1, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &c->cap_patch, m->n_tri + 1,
                 sizeof *m->tri_patch))
    return vg_fail_memory(err, "the inner surfaces");
  memcpy(m->tri[m->n_tri], v, sizeof *m->tri);
  m->tri_patch[m->n_tri++] = patch;
  return VG_OK;
}

/* Replaces triangle t, of which a part is beyond the plane, by its part in the
 * domain: *stays 0, or triangle t and perhaps another one at the end. */
static vg_status clip(struct clipper *c, size_t t, int *stays,
                      struct vg_error *err)
{
  const uint32_t v[3] = { c->m->tri[t][0], c->m->tri[t][1], c->m->tri[t][2] };
  uint32_t p[4];
  int n = 0;
  vg_status st = VG_OK;

  for (int k = 0; k < 3; k++) {
    const uint32_t a = v[k], b = v[(k + 1) % 3];

    if (depth(c, a) >= 0) p[n++] = a;
    if ((depth(c, a) > 0 && depth(c, b) < 0) ||
        (depth(c, a) < 0 && depth(c, b) > 0))
      VG_TRY(cut_edge(c, a, b, &p[n++], err));
  }
  *stays = n > 2;
  if (n < 3) goto done;
  memcpy(c->m->tri[t], p, sizeof *c->m->tri);
  if (n == 4)
    VG_TRY(add_triangle(c, (const uint32_t[3]){ p[0], p[2], p[3] },
                        c->m->tri_patch[t], err));
done:
  return st;
}

/* Drops triangles from `first` on, in order. */
static void drop(struct vg_mesh *m, size_t first, const uint8_t *goes)
{
  size_t n = first;

  for (size_t t = first; t < m->n_tri; t++) {
    if (goes[t]) continue;
    memmove(m->tri[n], m->tri[t], sizeof *m->tri);
    m->tri_patch[n++] = m->tri_patch[t];
  }
  m->n_tri = n;
}

vg_status vg_junction_clip(struct vg_mesh *m, size_t n_wall,
                           const struct vg_junction_half *half, double *lost,
                           struct vg_error *err)
{
  struct clipper c = { m, half, m->n_point, m->n_tri, m->n_tri };
  const size_t n = m->n_tri;
  uint8_t *goes = vg_calloc(2 * n, 1);
  double before = 0, after = 0;
  vg_status st = VG_OK;

  if (!goes) return vg_fail_memory(err, "the inner surfaces");
  for (size_t t = n_wall; t < n; t++) {
    double least = 0;
    int stays;

    for (int k = 0; k < 3; k++) {
      const double d = depth(&c, m->tri[t][k]);

      if (d < least) least = d;
    }
    if (!(least < 0)) continue;
    before += area_of(m, t);
    VG_TRY(clip(&c, t, &stays, err));
    goes[t] = !stays;
    if (stays) after += area_of(m, t);
  }
  for (size_t t = n; t < m->n_tri; t++) after += area_of(m, t);
  *lost += before - after;
done:
  drop(m, n_wall, goes);
  free(goes);
  return st;
}

size_t vg_junction_drop_flat(struct vg_mesh *m, size_t n_wall)
{
  size_t n = 0, n_left = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t *v = m->tri[t];

    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    n_left += t < n_wall;
    memmove(m->tri[n], v, sizeof *m->tri);
    m->tri_patch[n++] = m->tri_patch[t];
  }
  m->n_tri = n;
  return n_left;
}

/* --- bodies ----------------------------------------------------------------
 */

struct solid {
  const struct vg_mesh *m;
  size_t n_wall;
  struct vg_sides s;
  uint32_t *up;       /* [n_tri] union-find */
  double (*touch)[2]; /* [n_tri] for roots: length of edges at which they meet
                         the front of walls, and the back */
  uint32_t *at;       /* [n_tri] for roots: a triangle at the back of a wall */
};

/* Joins triangles of inner surfaces at edges that no wall has. */
static void join(struct solid *f)
{
  const struct vg_edges *e = &f->s.edge;

  for (size_t i = 0; i < e->n; i++) {
    const uint32_t *h = vg_edges_at(e, i);
    const uint32_t n = vg_edges_count(e, i);
    int has_wall = 0;

    for (uint32_t k = 0; k < n; k++) has_wall |= h[k] / 3 < f->n_wall;
    for (uint32_t k = 1; k < n && !has_wall; k++)
      vg_union(f->up, h[0] / 3, h[k] / 3);
  }
}

/* Length of edge e of a half-face. */
static double edge_length(const struct vg_mesh *m, uint32_t e)
{
  const uint32_t *v = m->tri[e / 6];

  return vg_distance(m->point[v[e % 3]], m->point[v[(e % 3 + 1) % 3]]);
}

static void find_sides(struct solid *f)
{
  const uint32_t *across = f->s.across;

  for (size_t e = 6 * f->n_wall; e < 6 * f->m->n_tri; e++) {
    const uint32_t g = across[e] / 3;
    const uint32_t root = vg_root_of(f->up, (uint32_t)(e / 6));

    if (g / 2 >= f->n_wall) continue;
    f->touch[root][g % 2] += edge_length(f->m, (uint32_t)e);
    if (g % 2) f->at[root] = (uint32_t)(e / 6);
  }
}

static vg_status refuse(const struct solid *f, uint32_t t, struct vg_error *err)
{
  const struct vg_mesh *m = f->m;
  const struct vg_patch *p = &m->patch[m->tri_patch[t]];
  double x[3];

  for (int d = 0; d < 3; d++)
    x[d] = (m->point[m->tri[t][0]][d] + m->point[m->tri[t][1]][d] +
            m->point[m->tri[t][2]][d]) /
           3;
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "patch %d%s%s, an inner surface, passes from the fluid into a "
                 "body near (%g, %g, %g) without crossing the surface; it may "
                 "pass through a hole, or end next to the surface: let it "
                 "reach into the body, or let both share edges",
                 (int)p->id, *p->name ? " " : "", p->name, x[0], x[1], x[2]);
}

vg_status vg_junction_drop_solid(struct vg_mesh *m, size_t n_wall, double *lost,
                                 struct vg_error *err)
{
  struct solid f = { .m = m, .n_wall = n_wall };
  uint8_t *goes = vg_calloc(m->n_tri, 1);
  vg_status st;

  f.up = vg_alloc(m->n_tri, sizeof *f.up);
  f.touch = vg_calloc(m->n_tri, sizeof *f.touch);
  f.at = vg_alloc(m->n_tri, sizeof *f.at);
  if (!goes || !f.up || !f.touch || !f.at)
    VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  VG_TRY(vg_sides_build(&f.s, m->n_point, (const double(*)[3])m->point,
                        m->n_tri, (const uint32_t(*)[3])m->tri, err));
  for (size_t t = 0; t < m->n_tri; t++) f.up[t] = (uint32_t)t;
  join(&f);
  find_sides(&f);
  for (size_t t = n_wall; t < m->n_tri; t++) {
    const uint32_t root = vg_root_of(f.up, (uint32_t)t);
    const double *l = f.touch[root];

    if (fmin(l[0], l[1]) > MIXED * (l[0] + l[1]))
      VG_TRY(refuse(&f, f.at[root], err));
    goes[t] = l[1] > l[0];
    if (goes[t]) *lost += area_of(m, t);
  }
  drop(m, n_wall, goes);
done:
  vg_sides_release(&f.s);
  free(goes);
  free(f.up);
  free(f.touch);
  free(f.at);
  return st;
}
