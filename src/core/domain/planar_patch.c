/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/planar_patch.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/planar.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing.h"

static double size_of_field(void *user, const double x[3])
{
  return vg_sizing_at(user, x);
}

struct vg_size_function vg_size_function_of(const struct vg_sizing *sizing)
{
  return (struct vg_size_function){ .at = size_of_field,
                                    .user = (void *)sizing };
}

/* Largest distance of a point from the plane, of the extent of the patch. */
#define FLATNESS 1e-6

/* axis >= 0: the plane in which that coordinate equals `at`. The in-plane
 * coordinates are the other two, in the order for which the normal is +axis or
 * -axis. */
struct frame {
  int axis, iu, iv;
  double at, o[3], u[3], v[3], n[3];
  double flatness; /* Largest distance of points from the plane, of the
                      extent. */
  const struct vg_size_function *size;
};

static void to_plane(const struct frame *f, const double x[3], double p[2])
{
  const double d[3] = { x[0] - f->o[0], x[1] - f->o[1], x[2] - f->o[2] };

  if (f->axis >= 0) {
    p[0] = x[f->iu];
    p[1] = x[f->iv];
  } else {
    p[0] = vg_dot(d, f->u);
    p[1] = vg_dot(d, f->v);
  }
}

static void to_space(const struct frame *f, const double p[2], double x[3])
{
  if (f->axis >= 0) {
    x[f->axis] = f->at;
    x[f->iu] = p[0];
    x[f->iv] = p[1];
    return;
  }
  for (int k = 0; k < 3; k++) x[k] = f->o[k] + p[0] * f->u[k] + p[1] * f->v[k];
}

static double size_in_plane(void *user, const double p[2])
{
  const struct frame *f = user;
  double x[3];

  to_space(f, p, x);
  return f->size->at(f->size->user, x);
}

/* Axis along which all points have exactly the same coordinate, or -1. */
static int shared_axis(const struct vg_mesh *m, size_t n_edge,
                       const uint32_t (*edge)[2], const double n[3])
{
  for (int k = 0; k < 3; k++) {
    size_t i = 0;

    while (i < n_edge && m->point[edge[i][0]][k] == m->point[edge[0][0]][k] &&
           m->point[edge[i][1]][k] == m->point[edge[0][0]][k])
      i++;
    if (i == n_edge && fabs(n[k]) > 0.5) return k;
  }
  return -1;
}

static vg_status make_frame(const struct vg_mesh *m, size_t n_edge,
                            const uint32_t (*edge)[2], struct frame *f,
                            struct vg_error *err)
{
  double n[3] = { 0 }, extent = 0, len, c[3];
  int low;

  memcpy(f->o, m->point[edge[0][0]], sizeof f->o);
  for (size_t i = 0; i < n_edge; i++) { /* Newell: twice the area vector */
    double a[3], b[3];

    for (int k = 0; k < 3; k++) {
      a[k] = m->point[edge[i][0]][k] - f->o[k];
      b[k] = m->point[edge[i][1]][k] - f->o[k];
      extent = fmax(extent, fabs(a[k]));
    }
    vg_cross(a, b, c);
    for (int k = 0; k < 3; k++) n[k] += c[k];
  }
  len = sqrt(vg_dot(n, n));
  if (!(len > 0))
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "plane patch near (%.9g, %.9g, "
                   "%.9g): its boundary encloses no area",
                   f->o[0], f->o[1], f->o[2]);
  for (int k = 0; k < 3; k++) f->n[k] = n[k] / len;
  f->axis = shared_axis(m, n_edge, edge, f->n);
  if (f->axis >= 0) {
    f->at = f->o[f->axis];
    f->iu = (f->axis + 1) % 3;
    f->iv = (f->axis + 2) % 3;
    if (f->n[f->axis] < 0) {
      f->iu = (f->axis + 2) % 3;
      f->iv = (f->axis + 1) % 3;
    }
    return VG_OK;
  }
  low = fabs(f->n[0]) < fabs(f->n[1]) ? 0 : 1;
  if (fabs(f->n[2]) < fabs(f->n[low])) low = 2;
  memset(c, 0, sizeof c);
  c[low] = 1;
  vg_cross(c, f->n, f->u);
  len = sqrt(vg_dot(f->u, f->u));
  for (int k = 0; k < 3; k++) f->u[k] /= len;
  vg_cross(f->n, f->u, f->v);
  for (size_t i = 0; i < n_edge; i++) {
    const double *x = m->point[edge[i][0]];
    const double d[3] = { x[0] - f->o[0], x[1] - f->o[1], x[2] - f->o[2] };

    if (fabs(vg_dot(d, f->n)) > f->flatness * extent)
      return vg_fail(err, VG_ERR_GEOMETRY,
                     "patch with a curved boundary: "
                     "point (%.9g, %.9g, %.9g) is %.3g off its plane; only "
                     "planar patches are triangulated, give a surface mesh",
                     x[0], x[1], x[2], fabs(vg_dot(d, f->n)));
  }
  return VG_OK;
}

/* Region with local point numbers: to_mesh[local] is the point of the mesh. */
struct local {
  size_t n;
  uint32_t *number, *to_mesh, (*edge)[2];
  double (*p)[2];
};

static vg_status make_local(const struct vg_mesh *m, size_t n_edge,
                            const uint32_t (*edge)[2], const struct frame *f,
                            struct local *l, struct vg_error *err)
{
  l->number = vg_alloc(m->n_point, sizeof *l->number);
  l->to_mesh = vg_alloc(2 * n_edge, sizeof *l->to_mesh);
  l->edge = vg_alloc(n_edge, sizeof *l->edge);
  l->p = vg_alloc(2 * n_edge, sizeof *l->p);
  if (!l->number || !l->to_mesh || !l->edge || !l->p)
    return vg_fail_memory(err, "a plane patch");
  memset(l->number, 0xff, m->n_point * sizeof *l->number);
  for (size_t i = 0; i < 2 * n_edge; i++) {
    const uint32_t v = edge[i / 2][i % 2];

    if (l->number[v] == UINT32_MAX) {
      to_plane(f, m->point[v], l->p[l->n]);
      l->to_mesh[l->n] = v;
      l->number[v] = (uint32_t)l->n++;
    }
    l->edge[i / 2][i % 2] = l->number[v];
  }
  return VG_OK;
}

static vg_status append(struct vg_mesh *m, const struct frame *f,
                        const struct local *l, size_t n_new,
                        const double (*add)[2], size_t n_tri,
                        const uint32_t (*tri)[3], uint32_t patch,
                        struct vg_error *err)
{
  double(*point)[3];
  uint32_t(*list)[3], *of;

  if (n_new > UINT32_MAX - 1 - m->n_point)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "surface: too many points");
  point = vg_realloc(m->point, m->n_point + n_new, sizeof *point);
  if (point) m->point = point;
  list = vg_realloc(m->tri, m->n_tri + n_tri, sizeof *list);
  if (list) m->tri = list;
  of = vg_realloc(m->tri_patch, m->n_tri + n_tri, sizeof *of);
  if (of) m->tri_patch = of;
  if (!point || !list || !of) return vg_fail_memory(err, "a plane patch");
  for (size_t i = 0; i < n_new; i++) to_space(f, add[i], point[m->n_point + i]);
  for (size_t i = 0; i < n_tri; i++) {
    for (int k = 0; k < 3; k++)
      list[m->n_tri + i][k] = tri[i][k] < l->n
                              ? l->to_mesh[tri[i][k]]
                              : (uint32_t)(m->n_point + (tri[i][k] - l->n));
    of[m->n_tri + i] = patch;
  }
  m->n_point += n_new;
  m->n_tri += n_tri;
  return VG_OK;
}

vg_status vg_planar_patch(struct vg_mesh *m, size_t n_edge,
                          const uint32_t (*edge)[2],
                          const struct vg_size_function *size, uint32_t patch,
                          struct vg_error *err)
{
  assert((edge || !n_edge) && size->at && patch < m->n_patch);
  return vg_planar_patch_near(m, n_edge, edge, size, FLATNESS, patch, err);
}

vg_status vg_planar_patch_near(struct vg_mesh *m, size_t n_edge,
                               const uint32_t (*edge)[2],
                               const struct vg_size_function *size,
                               double flatness, uint32_t patch,
                               struct vg_error *err)
{
  vg_status st;
  struct frame f = { .size = size, .flatness = flatness };
  const struct vg_planar_law law = { .at = size_in_plane,
                                     .user = &f,
                                     .stop = size->stop };
  struct local l = { 0 };
  size_t n_new = 0, n_tri = 0;
  double(*add)[2] = NULL;
  uint32_t(*tri)[3] = NULL;

  assert((edge || !n_edge) && size->at && flatness >= 0);
  assert(patch < m->n_patch);
  if (n_edge < 3)
    return vg_fail(err, VG_ERR_INPUT,
                   "plane patch with %zu boundary "
                   "segments; a closed loop needs at least 3",
                   n_edge);
  VG_TRY(make_frame(m, n_edge, edge, &f, err));
  VG_TRY(make_local(m, n_edge, edge, &f, &l, err));
  VG_TRY(vg_planar_mesh(l.n, (const double(*)[2])l.p, n_edge,
                        (const uint32_t(*)[2])l.edge, &law, &n_new, &add,
                        &n_tri, &tri, err));
  st = append(m, &f, &l, n_new, (const double(*)[2])add, n_tri,
              (const uint32_t(*)[3])tri, patch, err);
done:
  free(l.number);
  free(l.to_mesh);
  free(l.edge);
  free(l.p);
  free(add);
  free(tri);
  return st;
}
