/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Closed surfaces for the tests of the fill: blocks of boxes, spheres, a torus.
 * Normals point into the fluid. Header only: one program per module. */
#ifndef TESTS_UNIT_FILL_SHAPES_H
#define TESTS_UNIT_FILL_SHAPES_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "grow.h"

#include "base/memory.h"
#include "core/fill/fill.h"
#include "core/judge/quality.h"

static inline void shape_need(const void *p)
{
  if (!p) abort();
}

/* A front with patches as a mesh with the surface's patches, valid in this
 * block. */
#define FRONT_MESH(front, surface)                                             \
  ((struct vg_mesh[1]){ vg_front_mesh((front), (surface)) })

static inline uint32_t shape_point(struct vg_mesh *m, double x, double y,
                                   double z)
{
  GROW(m->point, m->n_point);
  shape_need(m->point);
  m->point[m->n_point][0] = x;
  m->point[m->n_point][1] = y;
  m->point[m->n_point][2] = z;
  return (uint32_t)m->n_point++;
}

static inline void shape_tri(struct vg_mesh *m, uint32_t a, uint32_t b,
                             uint32_t c, size_t patch)
{
  GROW(m->tri, m->n_tri);
  GROW(m->tri_patch, m->n_tri);
  shape_need(m->tri);
  shape_need(m->tri_patch);
  m->tri[m->n_tri][0] = a;
  m->tri[m->n_tri][1] = b;
  m->tri[m->n_tri][2] = c;
  m->tri_patch[m->n_tri++] = (uint32_t)patch;
}

/* The boundary of those boxes of an n[0] x n[1] x n[2] block between lo and hi
 * for which `in` returns 1, with a patch for each of the six directions. */
static inline void shape_block(struct vg_mesh *m, const int n[3],
                               const double lo[3], const double hi[3],
                               int (*in)(const int at[3]))
{
  size_t row = (size_t)n[0] + 1, plane = row * ((size_t)n[1] + 1);
  uint32_t *id = vg_calloc(plane * ((size_t)n[2] + 1), sizeof *id);

  shape_need(id);
  for (int f = 0; f < 6 * n[0] * n[1] * n[2]; f++) {
    int cell = f / 6, d = f % 3, side = f % 6 / 3;
    int at[3] = { cell % n[0], cell / n[0] % n[1], cell / n[0] / n[1] };
    int by[3] = { at[0], at[1], at[2] };
    uint32_t q[4];

    by[d] += side ? 1 : -1;
    if (!in(at)) continue;
    if (by[d] >= 0 && by[d] < n[d] && in(by)) continue;
    for (int k = 0; k < 4; k++) {
      int c[3] = { at[0], at[1], at[2] };
      size_t where;

      c[d] += side;
      c[(d + 1) % 3] += k == 1 || k == 2;
      c[(d + 2) % 3] += k > 1;
      where = (size_t)c[0] + row * (size_t)c[1] + plane * (size_t)c[2];
      if (!id[where]) {
        double x[3];

        for (int j = 0; j < 3; j++)
          x[j] = lo[j] + (hi[j] - lo[j]) * c[j] / n[j];
        id[where] = shape_point(m, x[0], x[1], x[2]) + 1;
      }
      q[side ? 3 - k : k] = id[where] - 1;
    }
    if ((at[0] + at[1] + at[2]) % 2) {
      shape_tri(m, q[0], q[1], q[2], (size_t)(2 * d + side));
      shape_tri(m, q[0], q[2], q[3], (size_t)(2 * d + side));
    } else {
      shape_tri(m, q[0], q[1], q[3], (size_t)(2 * d + side));
      shape_tri(m, q[1], q[2], q[3], (size_t)(2 * d + side));
    }
  }
  free(id);
  for (int32_t i = 0; i < 6; i++) vg_mesh_add_patch(m, 11 + i, "side");
}

static inline int shape_all(const int at[3])
{
  (void)at;
  return 1;
}

static inline void shape_box(struct vg_mesh *m, int n, double half)
{
  const int count[3] = { n, n, n };
  const double lo[3] = { -half, -half, -half }, hi[3] = { half, half, half };

  shape_block(m, count, lo, hi, shape_all);
}

/* A body: an octahedron whose faces are divided into n x n triangles and
 * projected onto a sphere. Its coordinates need only square roots. */
static inline void shape_sphere(struct vg_mesh *m, int n,
                                const double centre[3], double radius,
                                int32_t patch_id)
{
  size_t patch = vg_mesh_add_patch(m, patch_id, "body");
  int side = 2 * n + 1;
  uint32_t *id = vg_calloc((size_t)side * (size_t)side * (size_t)side,
                           sizeof *id);

  shape_need(id);
  for (int f = 0; f < 8 * n * n; f++) {
    int octant = f / (n * n), i = f % (n * n) / n, j = f % n;
    int s[3] = { octant & 1 ? -1 : 1, octant & 2 ? -1 : 1,
                 octant & 4 ? -1 : 1 };
    int odd = s[0] * s[1] * s[2] < 0;

    for (int up = 0; up < 2; up++) {
      int corner[3][2] = { { i + up, j + up }, { i + 1, j }, { i, j + 1 } };
      uint32_t t[3];

      if (i + j + up >= n) continue;
      if (up) {
        corner[1][0] = i;
        corner[1][1] = j + 1;
        corner[2][0] = i + 1;
        corner[2][1] = j;
      }
      for (int k = 0; k < 3; k++) {
        int a[3] = { s[0] * corner[k][0], s[1] * corner[k][1],
                     s[2] * (n - corner[k][0] - corner[k][1]) };
        size_t at = (size_t)((a[0] + n) + side * (a[1] + n) +
                             side * side * (a[2] + n));
        double r = sqrt((double)(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]));

        if (!id[at])
          id[at] = shape_point(m, centre[0] + radius * a[0] / r,
                               centre[1] + radius * a[1] / r,
                               centre[2] + radius * a[2] / r) +
                   1;
        t[k] = id[at] - 1;
      }
      if (odd) shape_tri(m, t[0], t[2], t[1], patch);
      else shape_tri(m, t[0], t[1], t[2], patch);
    }
  }
  free(id);
}

/* The inside of a torus around the z axis; nu x nv quads. */
static inline void shape_torus(struct vg_mesh *m, int nu, int nv, double big,
                               double small)
{
  size_t patch = vg_mesh_add_patch(m, 1, "torus");

  for (int i = 0; i < nu; i++)
    for (int j = 0; j < nv; j++) {
      double u = 2 * M_PI * i / nu, v = 2 * M_PI * j / nv;

      shape_point(m, (big + small * cos(v)) * cos(u),
                  (big + small * cos(v)) * sin(u), small * sin(v));
    }
  for (int i = 0; i < nu; i++)
    for (int j = 0; j < nv; j++) {
      uint32_t a = (uint32_t)(i * nv + j);
      uint32_t b = (uint32_t)((i + 1) % nu * nv + j);
      uint32_t c = (uint32_t)((i + 1) % nu * nv + (j + 1) % nv);
      uint32_t d = (uint32_t)(i * nv + (j + 1) % nv);

      shape_tri(m, a, c, b, patch);
      shape_tri(m, a, d, c, patch);
    }
}

/* The sizing field that grows from the surface, at most h_max (0: no limit). */
static inline struct vg_sizing *shape_sizing(const struct vg_mesh *m,
                                             double growth, double h_max)
{
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *sizing = NULL;

  options.growth = growth;
  options.h_max = h_max;
  if (vg_sizing_new(&options, 0, NULL, m, &sizing, NULL) < 0) abort();
  return sizing;
}

#endif
