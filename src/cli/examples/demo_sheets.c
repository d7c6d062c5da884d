/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Inner surfaces of the examples: an actuator disk; a rotor in its zone; a
 * solid with fins. */
#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/examples/demo_parts.h"

/* Place and radius of the actuator disk ahead of the sphere. */
#define DISK_X (-2.0)
#define DISK_RADIUS 1.5

/* The rotating zone: a cylinder along x around the centre of the box, and the
 * blades in it: from radius to radius, and their chord, at 45 degrees. */
#define ROTOR_RADIUS 0.3
#define ROTOR_HALF 0.15
#define BLADE_FROM 0.05
#define BLADE_TO 0.22
#define BLADE_CHORD 0.16

/* The solid: a plate of 5 x 5 x 1 units with three fins of 5 x 1 x 3, from a
 * corner. */
#define FIN_UNIT 0.08
#define FIN_X 0.3
#define FIN_Z 0.34
#define FIN_FACES 178 /* squares of its surface */

static vg_status make_room(struct vg_mesh *m, size_t n_point, size_t n_tri,
                           struct vg_error *err)
{
  m->point = vg_alloc(n_point, sizeof *m->point);
  m->tri = vg_alloc(n_tri, sizeof *m->tri);
  m->tri_patch = vg_calloc(n_tri, sizeof *m->tri_patch);
  return m->point && m->tri && m->tri_patch
         ? VG_OK
         : vg_fail_memory(err, "the sheets of an example");
}

static vg_status add_patch(struct vg_demo *d, const char *name,
                           struct vg_error *err)
{
  struct vg_mesh *m = &d->sheet;
  const size_t at = vg_mesh_add_patch(
    m, (int32_t)(d->surface.n_patch + m->n_patch) + 1, name);

  return at == SIZE_MAX ? vg_fail_memory(err, "a patch") : VG_OK;
}

static void add_triangle(struct vg_mesh *m, uint32_t patch, size_t a, size_t b,
                         size_t c)
{
  const uint32_t v[3] = { (uint32_t)a, (uint32_t)b, (uint32_t)c };

  memcpy(m->tri[m->n_tri], v, sizeof v);
  m->tri_patch[m->n_tri++] = patch;
}

/* --- disks ------------------------------------------------------------------
 */

/* The point at radius r of a disk in the direction of a point of a hexagon,
 * which is at a share of one of its sides. centre[3] */
static void put_on_disk(const double *centre, uint32_t side, double share,
                        double r, double x[3])
{
  static const double high = 0.86602540378443864676; /* sqrt(3) / 2 */
  const double corner[7][2] = { { 1, 0 },  { .5, high },   { -.5, high },
                                { -1, 0 }, { -.5, -high }, { .5, -high },
                                { 1, 0 } };
  const double *from = corner[side], *to = corner[side + 1];
  const double y = from[0] + share * (to[0] - from[0]);
  const double z = from[1] + share * (to[1] - from[1]);
  const double length = sqrt(y * y + z * z);

  x[0] = centre[0];
  x[1] = centre[1] + r * y / length;
  x[2] = centre[2] + r * z / length;
}

/* Adds ring k of a disk, at radius r: its 6 k points, and the triangles to ring
 * k - 1, whose points come last. */
static void add_ring(struct vg_mesh *m, const double *centre, uint32_t k,
                     double r)
{
  const size_t outer = m->n_point, m_in = 6 * ((size_t)k - 1);
  const size_t inner = k > 1 ? outer - m_in : outer - 1;

  for (uint32_t i = 0; i < 6 * k; i++)
    put_on_disk(centre, i / k, (double)(i % k) / k, r, m->point[m->n_point++]);
  for (size_t i = 0; i < 6 * k; i++) {
    const size_t side = i / k, at = i % k; /* of six sides of k edges */
    const size_t in = m_in ? inner + (side * (k - 1) + at) % m_in : inner;
    const size_t next = m_in ? inner + (side * (k - 1) + at + 1) % m_in : 0;

    add_triangle(m, 0, in, outer + i, outer + (i + 1) % (6 * k));
    if (at + 1 < k) /* not at a corner of the inner ring */
      add_triangle(m, 0, in, outer + i + 1, next);
  }
}

/* Adds a disk of n rings, with 3 n (n + 1) + 1 points and 6 n^2 triangles. The
 * points of its rim come last. */
static void add_disk(struct vg_mesh *m, const double *centre, double r,
                     uint32_t n)
{
  memcpy(m->point[m->n_point++], centre, sizeof *m->point);
  for (uint32_t k = 1; k <= n; k++) add_ring(m, centre, k, r * k / n);
}

static uint32_t edges_along(double length, double size)
{
  const double n = length / size;

  return n < 4 ? 4 : n > 4000 ? 4000 : (uint32_t)n;
}

vg_status vg_demo_add_disk(const struct vg_demo_spacing *law, struct vg_demo *d,
                           struct vg_error *err)
{
  static const double centre[3] = { DISK_X, 0, 0 };
  const double size = vg_demo_size((void *)(uintptr_t)law, centre);
  const uint32_t n = edges_along(DISK_RADIUS, size);
  struct vg_mesh *m = &d->sheet;
  vg_status st;

  VG_TRY(make_room(m, 3 * (size_t)n * (n + 1) + 1, 6 * (size_t)n * n, err));
  VG_TRY(add_patch(d, "disk", err));
  m->patch[0].is_sheet = 1;
  add_disk(m, centre, DISK_RADIUS, n);
done:
  return st;
}

/* --- a rotor ----------------------------------------------------------------
 */

/* Joins two rows of points: n quadrilaterals, closed if `around`. */
static void join_rows(struct vg_mesh *m, uint32_t patch, size_t a, size_t b,
                      size_t n, int around)
{
  for (size_t i = 0; i < n; i++) {
    const size_t j = around && i + 1 == n ? 0 : i + 1;

    add_triangle(m, patch, a + i, b + i, b + j);
    add_triangle(m, patch, a + i, b + j, a + j);
  }
}

/* Two disks of n rings and the side between them, with `rows` rows. */
static void add_cylinder(struct vg_mesh *m, uint32_t n, uint32_t rows)
{
  const double end[2][3] = { { .5 - ROTOR_HALF, .5, .5 },
                             { .5 + ROTOR_HALF, .5, .5 } };
  size_t rim[2], before;

  for (int k = 0; k < 2; k++) {
    add_disk(m, end[k], ROTOR_RADIUS, n);
    rim[k] = m->n_point - 6 * (size_t)n;
  }
  before = rim[0];
  for (uint32_t row = 1; row < rows; row++) {
    const double x = end[0][0] + (end[1][0] - end[0][0]) * row / rows;
    const size_t at = m->n_point;

    for (size_t i = 0; i < 6 * (size_t)n; i++) {
      memcpy(m->point[m->n_point], m->point[rim[0] + i], sizeof *m->point);
      m->point[m->n_point++][0] = x;
    }
    join_rows(m, 0, before, at, 6 * (size_t)n, 1);
    before = at;
  }
  join_rows(m, 0, before, rim[1], 6 * (size_t)n, 1);
}

/* The blade in the direction (y, z), of n_along by n_across quadrilaterals. */
static void add_blade(struct vg_mesh *m, double y, double z, uint32_t n_along,
                      uint32_t n_across)
{
  static const double half = 0.70710678118654752440; /* sqrt(1 / 2) */

  for (uint32_t k = 0; k <= n_across; k++) {
    const double s = half * BLADE_CHORD * ((double)k / n_across - .5);
    const size_t at = m->n_point;

    for (uint32_t i = 0; i <= n_along; i++) {
      const double r = BLADE_FROM + (BLADE_TO - BLADE_FROM) * i / n_along;
      double *x = m->point[m->n_point++];

      x[0] = .5 + s;
      x[1] = .5 + r * y - s * z;
      x[2] = .5 + r * z + s * y;
    }
    if (k) join_rows(m, 1, at - n_along - 1, at, n_along, 0);
  }
}

vg_status vg_demo_add_rotor(const struct vg_demo_spacing *law,
                            struct vg_demo *d, struct vg_error *err)
{
  static const double centre[3] = { .5, .5, .5 };
  const double h = vg_demo_size((void *)(uintptr_t)law, centre);
  const uint32_t n = edges_along(ROTOR_RADIUS, h);
  const uint32_t rows = edges_along(2 * ROTOR_HALF, h);
  const uint32_t along = edges_along(BLADE_TO - BLADE_FROM, h);
  const uint32_t across = edges_along(BLADE_CHORD, h);
  struct vg_mesh *m = &d->sheet;
  vg_status st;

  VG_TRY(make_room(m,
                   6 * (size_t)n * (n + 1 + rows) + 2 +
                     4 * ((size_t)along + 1) * (across + 1),
                   12 * (size_t)n * (n + rows) + 8 * (size_t)along * across,
                   err));
  VG_TRY(add_patch(d, "rotor", err));
  VG_TRY(add_patch(d, "blades", err));
  m->patch[0].is_sheet = m->patch[0].is_interface = 1;
  m->patch[1].bc = m->patch[1].family = 4;
  m->patch[1].bc_fun3d = 4000;
  add_cylinder(m, n, rows);
  for (int k = 0; k < 4; k++)
    add_blade(m, (k == 0) - (k == 2), (k == 1) - (k == 3), along, across);
  snprintf(d->zone.name, VG_NAME_MAX, "rotor");
  d->zone.kind = VG_ZONE_ROTATING;
  memcpy(d->seed, centre, sizeof centre);
done:
  return st;
}

/* --- a solid with fins -------------------------------------------------------
 */

/* A lattice of n cubes per unit, with 5 x 5 x 4 units. */
struct lattice {
  int32_t n;
  uint32_t *at; /* [(5 n + 1)^2 (4 n + 1)] numbers of its points in the mesh, or
                   UINT32_MAX */
  struct vg_mesh *m;
};

/* Whether a cube is in the solid; c[3]: its indices, of which one may be
 * outside of the lattice. */
static int in_solid(const struct lattice *l, const int32_t *c)
{
  for (int k = 0; k < 3; k++)
    if (c[k] < 0 || c[k] >= (k < 2 ? 5 : 4) * l->n) return 0;
  return c[2] < l->n || c[1] / l->n % 2 == 0;
}

static size_t lattice_point(struct lattice *l, const int32_t *c)
{
  const size_t row = 5 * (size_t)l->n + 1;
  uint32_t
    *at = &l->at[((size_t)c[2] * row + (size_t)c[1]) * row + (size_t)c[0]];

  if (*at == UINT32_MAX) {
    double *x = l->m->point[l->m->n_point];

    for (int k = 0; k < 3; k++)
      x[k] = (k < 2 ? FIN_X : FIN_Z) + FIN_UNIT * c[k] / l->n;
    *at = (uint32_t)l->m->n_point++;
  }
  return *at;
}

/* Adds the square between a cube and its neighbour along an axis. */
static void add_square(struct lattice *l, const int32_t *cube, int axis,
                       int side)
{
  static const int corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
  size_t v[4];

  for (int i = 0; i < 4; i++) {
    int32_t c[3] = { cube[0], cube[1], cube[2] };

    c[axis] += side;
    c[(axis + 1) % 3] += corner[side ? i : 3 - i][0];
    c[(axis + 2) % 3] += corner[side ? i : 3 - i][1];
    v[i] = lattice_point(l, c);
  }
  add_triangle(l->m, 0, v[0], v[1], v[2]);
  add_triangle(l->m, 0, v[0], v[2], v[3]);
}

static void add_solid(struct lattice *l)
{
  int32_t c[3];

  for (c[2] = 0; c[2] < 4 * l->n; c[2]++)
    for (c[1] = 0; c[1] < 5 * l->n; c[1]++)
      for (c[0] = 0; c[0] < 5 * l->n; c[0]++)
        for (int k = 0; k < 6 && in_solid(l, c); k++) {
          int32_t next[3] = { c[0], c[1], c[2] };

          next[k / 2] += k % 2 ? 1 : -1;
          if (!in_solid(l, next)) add_square(l, c, k / 2, k % 2);
        }
}

vg_status vg_demo_add_fins(const struct vg_demo_spacing *law, struct vg_demo *d,
                           struct vg_error *err)
{
  static const double seed[3] = { .5, .5, FIN_Z + .5 * FIN_UNIT };
  const double per_unit = FIN_UNIT / vg_demo_size((void *)(uintptr_t)law, seed);
  struct lattice l = { .m = &d->sheet };
  size_t row, n_face;
  vg_status st;

  l.n = per_unit < 2 ? 2 : per_unit > 200 ? 200 : (int32_t)per_unit;
  row = 5 * (size_t)l.n + 1;
  n_face = FIN_FACES * (size_t)l.n * (size_t)l.n;
  VG_TRY(make_room(l.m, n_face + 2, 2 * n_face, err));
  VG_TRY(add_patch(d, "fins", err));
  l.at = vg_alloc(row * row * (4 * (size_t)l.n + 1), sizeof *l.at);
  if (!l.at) return vg_fail_memory(err, "the lattice of an example");
  memset(l.at, 0xff, row * row * (4 * (size_t)l.n + 1) * sizeof *l.at);
  add_solid(&l);
  assert(l.m->n_tri == 2 * n_face && l.m->n_point == n_face + 2);
  l.m->patch[0].is_sheet = l.m->patch[0].is_interface = 1;
  snprintf(d->zone.name, VG_NAME_MAX, "fins");
  d->zone.kind = VG_ZONE_SOLID;
  memcpy(d->seed, seed, sizeof seed);
done:
  free(l.at);
  return st;
}
