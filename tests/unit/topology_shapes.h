/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Bodies with sharp edges for the tests of columns. */
#ifndef TESTS_UNIT_TOPOLOGY_SHAPES_H
#define TESTS_UNIT_TOPOLOGY_SHAPES_H

#include "fill_shapes.h"

/* A cylinder along y over a polygon in the xz plane that runs clockwise seen
 * from +y, from y = 0 to 1 in n_y steps; patch 0. `root` 0: closed by a cap at
 * y = 0; 1: open onto a plane (patch 1), with a dome (patch 2) around all.
 * apex: the end at y = 1 is the point (0, 1, 0), without sides between. */
static inline void extrude(struct vg_mesh *m, int n, const double (*at)[2],
                           int n_y, int root, int apex)
{
  uint32_t end, low, far;
  int rows = apex ? 1 : n_y + 1;

  vg_mesh_add_patch(m, 1, "body");
  vg_mesh_add_patch(m, 2, "plane");
  vg_mesh_add_patch(m, 3, "far");
  for (int j = 0; j < rows; j++)
    for (int i = 0; i < n; i++)
      shape_point(m, at[i][0], (double)j / n_y, at[i][1]);
  end = shape_point(m, 0, 1, 0);
  for (int j = 0; j + 1 < rows; j++)
    for (int i = 0; i < n; i++) {
      uint32_t a = (uint32_t)(j * n + i), b = (uint32_t)(j * n + (i + 1) % n);
      uint32_t up = (uint32_t)n;

      shape_tri(m, a, b, b + up, 0);
      shape_tri(m, a, b + up, a + up, 0);
    }
  for (int i = 0; i < n; i++)
    shape_tri(m, (uint32_t)((rows - 1) * n + i),
              (uint32_t)((rows - 1) * n + (i + 1) % n), end, 0);
  if (!root) {
    low = shape_point(m, 0, 0, 0);
    for (int i = 0; i < n; i++)
      shape_tri(m, (uint32_t)((i + 1) % n), (uint32_t)i, low, 0);
    return;
  }
  low = (uint32_t)m->n_point;
  for (int i = 0; i < n; i++) shape_point(m, 20 * at[i][0], 0, 20 * at[i][1]);
  far = shape_point(m, 0, 20, 0);
  for (int i = 0; i < n; i++) {
    uint32_t a = (uint32_t)i, b = (uint32_t)((i + 1) % n);

    shape_tri(m, b, a, low + a, 1);
    shape_tri(m, b, low + a, low + b, 1);
    shape_tri(m, low + b, low + a, far, 2);
  }
}

static inline void ring(int n, double (*at)[2])
{
  for (int i = 0; i < n; i++) {
    at[i][0] = cos(2 * M_PI * i / n);
    at[i][1] = -sin(2 * M_PI * i / n);
  }
}

static const double square[4][2] = {
  { -1, -1 }, { -1, 1 }, { 1, 1 }, { 1, -1 }
};
static const double plate[4][2] = {
  { -1, -0.005 }, { -1, 0.005 }, { 1, 0.005 }, { 1, -0.005 }
};
static const double wedge[8][2] = { /* 6 degrees at x = 1.5 */
                                    { -1, -0.12 },    { -1.2, 0 },
                                    { -1, 0.12 },     { -0.5, 0.1048 },
                                    { 0.5, 0.0524 },  { 1.5, 0 },
                                    { 0.5, -0.0524 }, { -0.5, -0.1048 }
};

#endif
