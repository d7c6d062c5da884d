/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Surfaces for the tests of core/remesh. */
#ifndef VG_TESTS_REMESH_SHAPES_H
#define VG_TESTS_REMESH_SHAPES_H

#include <math.h>

#include "grow.h"
#include "io_support.h"

#include "core/geometry/vector.h"
#include "core/mesh/mesh.h"
#include "core/surface/surface_check.h"

static inline uint32_t shape_point(struct vg_mesh *m, double x, double y,
                                   double z)
{
  GROW(m->point, m->n_point);
  m->point[m->n_point][0] = x;
  m->point[m->n_point][1] = y;
  m->point[m->n_point][2] = z;
  return (uint32_t)m->n_point++;
}

static inline void shape_tri(struct vg_mesh *m, uint32_t a, uint32_t b,
                             uint32_t c, uint32_t patch)
{
  const uint32_t t[3] = { a, b, c };

  GROW(m->tri, m->n_tri);
  GROW(m->tri_patch, m->n_tri);
  memcpy(m->tri[m->n_tri], t, sizeof t);
  m->tri_patch[m->n_tri++] = patch;
}

/* Merge points with equal coordinates, as readers of triangle soups do. */
static inline void shape_weld(struct vg_mesh *m)
{
  struct vg_surface_check_options o = { .repair = 1,
                                        .external = 1,
                                        .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_surface_check(m, &o, &r, &err) < 0) fail_msg("%s", err.text);
  vg_surface_report_release(&r);
}

/* A box with n[] divisions along its axes, a patch for each side. */
static inline void shape_box(struct vg_mesh *m, const double size[3],
                             const uint32_t n[3])
{
  for (uint32_t s = 0; s < 6; s++) {
    uint32_t axis = s / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    uint32_t first = (uint32_t)m->n_point;

    vg_mesh_add_patch(m, (int32_t)s + 1, NULL);
    for (uint32_t j = 0; j <= n[v]; j++)
      for (uint32_t i = 0; i <= n[u]; i++) {
        double x[3];

        x[axis] = s % 2 ? size[axis] : 0;
        x[u] = i < n[u] ? size[u] * i / n[u] : size[u];
        x[v] = j < n[v] ? size[v] * j / n[v] : size[v];
        shape_point(m, x[0], x[1], x[2]);
      }
    for (uint32_t j = 0; j < n[v]; j++)
      for (uint32_t i = 0; i < n[u]; i++) {
        uint32_t a = first + j * (n[u] + 1) + i, b = a + 1;
        uint32_t d = a + n[u] + 1, c = d + 1;

        shape_tri(m, a, s % 2 ? b : c, s % 2 ? c : b, s);
        shape_tri(m, a, s % 2 ? c : d, s % 2 ? d : c, s);
      }
  }
  shape_weld(m);
}

/* An ellipsoid of n rings of 2 n points, patches by the sign of x. */
static inline void shape_ball(struct vg_mesh *m, const double r[3], uint32_t n)
{
  uint32_t first = (uint32_t)m->n_point, k = 2 * n;

  vg_mesh_add_patch(m, 1, "aft");
  vg_mesh_add_patch(m, 2, "fore");
  for (uint32_t j = 0; j <= n; j++)
    for (uint32_t i = 0; i < k; i++) {
      double a = M_PI * j / n, b = 2 * M_PI * i / k;
      double s = j % n ? sin(a) : 0; /* poles are one point */

      shape_point(m, r[0] * s * cos(b), r[1] * s * sin(b), r[2] * cos(a));
    }
  for (uint32_t j = 0; j < n; j++)
    for (uint32_t i = 0; i < k; i++) {
      uint32_t a = first + j * k + i, b = first + j * k + (i + 1) % k;
      uint32_t patch = i < k / 4 || i >= 3 * k / 4;

      if (j) shape_tri(m, a, a + k, b, patch);
      if (j + 1 < n) shape_tri(m, b, a + k, b + k, patch);
    }
  shape_weld(m);
}

/* Closed except for `open` edges, oriented, without intersections. */
static inline void shape_expect_sound(struct vg_mesh *m, size_t open)
{
  struct vg_surface_check_options o = { .threads = 1, .external = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char text[512];

  if (vg_surface_check(m, &o, &r, &err) < 0) fail_msg("%s", err.text);
  for (size_t i = 0; i < r.n_defect; i++) {
    vg_defect_text(m, &r.defect[i], text, sizeof text);
    if (!open || r.defect[i].kind != VG_DEFECT_OPEN_EDGE) fail_msg("%s", text);
  }
  if (open) assert_true(r.count[VG_DEFECT_OPEN_EDGE] > 0);
  vg_surface_report_release(&r);
}

static inline double shape_area(const struct vg_mesh *m, size_t patch)
{
  double sum = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    double u[3], v[3], n[3];

    if (patch != SIZE_MAX && m->tri_patch[t] != patch) continue;
    vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], u);
    vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], v);
    vg_cross(u, v, n);
    sum += vg_norm(n) / 2;
  }
  return sum;
}

#endif
