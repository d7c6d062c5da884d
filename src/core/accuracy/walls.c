/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Distance from the walls of a mesh. */
#include "core/accuracy/walls.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/nearest.h"
#include "core/geometry/vector.h"
#include "core/judge/face_shape.h"

/* Cosine of the largest angle, 20 degrees, between the normals of a triangle
 * and of its corners where a wall is smooth, and between the interpolated
 * normal and the direction from the nearest point of the wall. */
#define SMOOTH 0.94

void vg_wall_search_release(struct vg_wall_search *s)
{
  free(s->centre);
  free(s->tri);
  free(s->normal);
  free(s->is_smooth);
  vg_box_tree_release(&s->tree);
  memset(s, 0, sizeof *s);
}

static vg_status no_memory(struct vg_error *err)
{
  return vg_fail_memory(err, "the search for the nearest wall");
}

static void add_triangle(struct vg_wall_search *s, uint32_t a, uint32_t b,
                         uint32_t c)
{
  const uint32_t node[3] = { a, b, c };

  memcpy(s->tri[s->n++], node, sizeof node);
}

static void add_quad(struct vg_wall_search *s, const uint32_t v[4])
{
  uint32_t middle = (uint32_t)(s->m->n_point + s->n_centre);
  struct vg_face_shape shape;
  double x[4][3];

  for (int i = 0; i < 4; i++) memcpy(x[i], s->m->point[v[i]], sizeof x[i]);
  vg_face_shape((const double(*)[3])x, 4, &shape);
  memcpy(s->centre[s->n_centre++], shape.centre, sizeof shape.centre);
  for (int i = 0; i < 4; i++) add_triangle(s, v[i], v[(i + 1) % 4], middle);
}

static vg_status list_triangles(struct vg_wall_search *s,
                                const uint8_t *is_wall, struct vg_error *err)
{
  const struct vg_mesh *m = s->m;
  size_t n = 0, n_quad = 0;

  for (size_t t = 0; t < m->n_tri; t++) n += is_wall[m->tri_patch[t]];
  for (size_t q = 0; q < m->n_quad; q++) n_quad += is_wall[m->quad_patch[q]];
  n += 4 * n_quad;
  if (m->n_point + n_quad > UINT32_MAX || n > UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the walls have too many faces for the check of accuracy");
  s->centre = vg_alloc(n_quad, sizeof *s->centre);
  s->tri = vg_alloc(n, sizeof *s->tri);
  s->normal = vg_alloc(n, sizeof *s->normal);
  s->is_smooth = vg_alloc(n, sizeof *s->is_smooth);
  if (!s->centre || !s->tri || !s->normal || !s->is_smooth)
    return no_memory(err);
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t *v = m->tri[t];

    if (is_wall[m->tri_patch[t]]) add_triangle(s, v[0], v[1], v[2]);
  }
  for (size_t q = 0; q < m->n_quad; q++)
    if (is_wall[m->quad_patch[q]]) add_quad(s, m->quad[q]);
  assert(s->n == n);
  return VG_OK;
}

/* Unit normal of a triangle; returns its area. */
static double normal_of(const struct vg_wall_search *s, size_t t, double n[3])
{
  const uint32_t *v = s->tri[t];
  const double *x = vg_wall_corner(s, v[0]);
  double a[3], b[3];

  vg_sub(vg_wall_corner(s, v[1]), x, a);
  vg_sub(vg_wall_corner(s, v[2]), x, b);
  vg_cross(a, b, n);
  return 0.5 * vg_unit(n);
}

/* Angle at corner k, with which the normal of the triangle counts there. */
static double angle_at(const struct vg_wall_search *s, size_t t, int k)
{
  const uint32_t *v = s->tri[t];
  const double *x = vg_wall_corner(s, v[k]);
  double a[3], b[3], n[3];

  vg_sub(vg_wall_corner(s, v[(k + 1) % 3]), x, a);
  vg_sub(vg_wall_corner(s, v[(k + 2) % 3]), x, b);
  vg_cross(a, b, n);
  return atan2(vg_norm(n), vg_dot(a, b));
}

static vg_status find_normals(struct vg_wall_search *s, struct vg_error *err)
{
  double(*sum)[3] = vg_calloc(s->m->n_point + s->n_centre, sizeof *sum), n[3];

  if (!sum) return no_memory(err);
  for (size_t t = 0; t < s->n; t++) {
    if (!(normal_of(s, t, n) > 0)) continue;
    for (int k = 0; k < 3; k++) {
      double w = angle_at(s, t, k);

      for (int i = 0; i < 3; i++) sum[s->tri[t][k]][i] += w * n[i];
    }
  }
  for (size_t t = 0; t < s->n; t++) {
    normal_of(s, t, n);
    s->is_smooth[t] = 1;
    for (int k = 0; k < 3; k++) {
      double u[3];

      memcpy(u, sum[s->tri[t][k]], sizeof u);
      vg_unit(u);
      if (!(vg_dot(u, n) >= SMOOTH)) s->is_smooth[t] = 0;
      for (int i = 0; i < 3; i++) s->normal[t][k][i] = (float)u[i];
    }
  }
  free(sum);
  return VG_OK;
}

vg_status vg_wall_search_open(struct vg_wall_search *s, const struct vg_mesh *m,
                              const uint8_t *is_wall, struct vg_error *err)
{
  struct vg_box *box = NULL;
  vg_status st;

  s->m = m;
  VG_TRY(list_triangles(s, is_wall, err));
  VG_TRY(find_normals(s, err));
  box = vg_alloc(s->n, sizeof *box);
  if (!box) VG_TRY(no_memory(err));
  for (size_t t = 0; t < s->n; t++) {
    box[t] = (struct vg_box)VG_BOX_EMPTY;
    for (int k = 0; k < 3; k++)
      vg_box_add(&box[t], vg_wall_corner(s, s->tri[t][k]));
  }
  VG_TRY(vg_box_tree_build_items(&s->tree, s->n, box, NULL, err));
  if (s->n) {
    const struct vg_box *all = vg_box_tree_node(&s->tree, 0);

    s->least = 1e-12 * vg_distance(all->lo, all->hi);
  }
done:
  free(box);
  return st;
}

struct search {
  const struct vg_wall_search *s;
  const double *x;
  double d2;
  uint32_t tri;
};

static int enter(void *context, size_t node, double d2)
{
  struct search *f = context;

  (void)node;
  return d2 <= f->d2;
}

/* Of equally near triangles, the first one is found. */
static void leaf(void *context, size_t node)
{
  struct search *f = context;
  const struct vg_box_tree *tree = &f->s->tree;

  for (size_t i = vg_box_tree_first(tree, node);
       i < vg_box_tree_end(tree, node); i++) {
    uint32_t t = tree->item[i];
    const uint32_t *v = f->s->tri[t];
    double d2;

    if (vg_box_distance2(&tree->box[i], f->x) > f->d2) continue;
    d2 = vg_to_triangle2(f->x, vg_wall_corner(f->s, v[0]),
                         vg_wall_corner(f->s, v[1]),
                         vg_wall_corner(f->s, v[2]));
    if (d2 < f->d2 || (d2 == f->d2 && t < f->tri)) {
      f->d2 = d2;
      f->tri = t;
    }
  }
}

void vg_wall_search_ask(const struct vg_wall_search *s, struct vg_place *p)
{
  struct search f = { s, p->x, INFINITY, UINT32_MAX };
  const uint32_t *v;
  double w[3], to[3];

  memset(p->normal, 0, sizeof p->normal);
  vg_box_tree_approach(&s->tree, p->x, enter, leaf, &f);
  p->distance = sqrt(f.d2);
  if (f.tri == UINT32_MAX) return;
  if (p->distance < s->least) p->distance = 0;
  if (!s->is_smooth[f.tri]) return;
  v = s->tri[f.tri];
  vg_nearest_weights(p->x, vg_wall_corner(s, v[0]), vg_wall_corner(s, v[1]),
                     vg_wall_corner(s, v[2]), w);
  memcpy(to, p->x, sizeof to);
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 3; i++) {
      p->normal[i] += w[k] * (double)s->normal[f.tri][k][i];
      to[i] -= w[k] * vg_wall_corner(s, v[k])[i];
    }
  vg_unit(p->normal);
  if (!(vg_dot(to, p->normal) >= SMOOTH * p->distance))
    memset(p->normal, 0, sizeof p->normal);
}
