/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Inner surfaces of the examples: an actuator disk; a rotor in its zone; a
 * solid with fins; a heat exchanger. */
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

/* The heat exchanger: a pipe along x in a round casing, between plane ends. */
#define PIPE_INSIDE 0.2
#define PIPE_OUTSIDE 0.3
#define CASING_RADIUS 0.5
#define CASING_LENGTH 1.5

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

static void add_zone(struct vg_demo *d, const char *name, int32_t kind,
                     const double seed[3])
{
  assert(d->n_zone < VG_DEMO_ZONES);
  snprintf(d->zone[d->n_zone].name, VG_NAME_MAX, "%s", name);
  d->zone[d->n_zone].kind = kind;
  memcpy(d->seed[d->n_zone++], seed, 3 * sizeof *seed);
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
static void add_ring(struct vg_mesh *m, uint32_t patch, const double *centre,
                     uint32_t k, double r)
{
  const size_t outer = m->n_point, m_in = 6 * ((size_t)k - 1);
  const size_t inner = k > 1 ? outer - m_in : outer - 1;

  for (uint32_t i = 0; i < 6 * k; i++)
    put_on_disk(centre, i / k, (double)(i % k) / k, r, m->point[m->n_point++]);
  for (size_t i = 0; i < 6 * k; i++) {
    const size_t side = i / k, at = i % k; /* of six sides of k edges */
    const size_t in = m_in ? inner + (side * (k - 1) + at) % m_in : inner;
    const size_t next = m_in ? inner + (side * (k - 1) + at + 1) % m_in : 0;

    add_triangle(m, patch, in, outer + i, outer + (i + 1) % (6 * k));
    if (at + 1 < k) /* not at a corner of the inner ring */
      add_triangle(m, patch, in, outer + i + 1, next);
  }
}

/* Adds a disk of n rings, with 3 n (n + 1) + 1 points and 6 n^2 triangles. The
 * points of its rim come last. */
static void add_disk(struct vg_mesh *m, const double *centre, double r,
                     uint32_t n)
{
  memcpy(m->point[m->n_point++], centre, sizeof *m->point);
  for (uint32_t k = 1; k <= n; k++) add_ring(m, 0, centre, k, r * k / n);
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

/* Joins two rings of n points at different x by `rows` rows. */
static void join_rings(struct vg_mesh *m, uint32_t patch, size_t from,
                       size_t to, size_t n, uint32_t rows)
{
  const double x0 = m->point[from][0], x1 = m->point[to][0];
  size_t before = from;

  for (uint32_t row = 1; row < rows; row++) {
    const double x = x0 + (x1 - x0) * row / rows;
    const size_t at = m->n_point;

    for (size_t i = 0; i < n; i++) {
      memcpy(m->point[m->n_point], m->point[from + i], sizeof *m->point);
      m->point[m->n_point++][0] = x;
    }
    join_rows(m, patch, before, at, n, 1);
    before = at;
  }
  join_rows(m, patch, before, to, n, 1);
}

/* Two disks of n rings and the side between them, with `rows` rows. */
static void add_cylinder(struct vg_mesh *m, uint32_t n, uint32_t rows)
{
  const double end[2][3] = { { .5 - ROTOR_HALF, .5, .5 },
                             { .5 + ROTOR_HALF, .5, .5 } };
  size_t rim[2];

  for (int k = 0; k < 2; k++) {
    add_disk(m, end[k], ROTOR_RADIUS, n);
    rim[k] = m->n_point - 6 * (size_t)n;
  }
  join_rings(m, 0, rim[0], rim[1], 6 * (size_t)n, rows);
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
  add_zone(d, "rotor", VG_ZONE_ROTATING, centre);
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
  add_zone(d, "fins", VG_ZONE_SOLID, seed);
done:
  free(l.at);
  return st;
}

/* --- a heat exchanger --------------------------------------------------------
 */

enum { CASING, HOT_IN, HOT_OUT, COLD_IN, COLD_OUT, ENDS, N_SURFACE_PATCH };

/* Rings of an end up to the inside of the pipe, to its outside, to the casing.
 */
struct rings {
  uint32_t to[3];
};

static const double ring_radius[3] = { PIPE_INSIDE, PIPE_OUTSIDE,
                                       CASING_RADIUS };

double vg_demo_exchanger_volume(void)
{
  return 3.14159265358979323846 * CASING_RADIUS * CASING_RADIUS * CASING_LENGTH;
}

static struct rings count_rings(double h)
{
  static const uint32_t least[3] = { 3, 2, 3 };
  struct rings r;

  for (int k = 0; k < 3; k++) {
    const double wide = ring_radius[k] - (k ? ring_radius[k - 1] : 0);
    const double n = wide / h + 0.5;

    r.to[k] = n < least[k] ? least[k] : n > 1000 ? 1000 : (uint32_t)n;
    if (k) r.to[k] += r.to[k - 1];
  }
  return r;
}

/* The first of the 6 k points of ring k of a disk that begins at a point. */
static size_t ring_at(size_t disk, uint32_t k)
{
  return disk + 1 + 3 * (size_t)k * (k - 1);
}

/* The end at x, with normals along x, or against it (flip). */
static void add_end(struct vg_mesh *m, const struct rings *r, double x,
                    const uint32_t patch[3], int flip)
{
  const double centre[3] = { x, 0, 0 };
  const size_t first = m->n_tri;
  uint32_t at = 0;

  memcpy(m->point[m->n_point++], centre, sizeof *m->point);
  for (uint32_t k = 1; k <= r->to[2]; k++) {
    if (k > r->to[at]) at++;
    const uint32_t from = at ? r->to[at - 1] : 0;
    const double inner = at ? ring_radius[at - 1] : 0;

    add_ring(m, patch[at], centre, k,
             inner +
               (ring_radius[at] - inner) * (k - from) / (r->to[at] - from));
  }
  for (size_t t = first; flip && t < m->n_tri; t++) {
    const uint32_t v = m->tri[t][1];

    m->tri[t][1] = m->tri[t][2];
    m->tri[t][2] = v;
  }
}

static vg_status add_surface_patches(struct vg_mesh *m, struct vg_error *err)
{
  static const struct {
    const char *name;
    int32_t bc, fun3d;
  } patch[N_SURFACE_PATCH] = {
    { "casing", 4, 4000 },      { "hot_in", 1001, 7011 },
    { "hot_out", 1002, 5051 },  { "cold_in", 1001, 7011 },
    { "cold_out", 1002, 5051 }, { "pipe_ends", 5, 3000 }
  };

  for (int i = 0; i < N_SURFACE_PATCH; i++) {
    const size_t at = vg_mesh_add_patch(m, i + 1, patch[i].name);

    if (at == SIZE_MAX) return vg_fail_memory(err, "a patch");
    m->patch[at].bc = m->patch[at].family = patch[i].bc;
    m->patch[at].bc_fun3d = patch[i].fun3d;
  }
  return VG_OK;
}

/* The sides of the pipe, with the points of ring to[k] of both ends. The fluids
 * are behind their triangles. */
static vg_status add_pipe(struct vg_demo *d, const struct rings *r,
                          uint32_t rows, struct vg_error *err)
{
  static const char *const name[2] = { "pipe_inside", "pipe_outside" };
  const struct vg_mesh *ends = &d->surface;
  const size_t n = 6 * ((size_t)r->to[0] + r->to[1]);
  const size_t disk[2] = { 0, ring_at(0, r->to[2] + 1) };
  struct vg_mesh *m = &d->sheet;
  vg_status st;

  VG_TRY(make_room(m, n * (rows + 1), 2 * n * rows, err));
  for (uint32_t k = 0; k < 2; k++) {
    const size_t n_ring = 6 * (size_t)r->to[k], from = m->n_point;

    VG_TRY(add_patch(d, name[k], err));
    m->patch[k].is_sheet = m->patch[k].is_interface = 1;
    for (int e = 0; e < 2; e++) {
      memcpy(m->point[m->n_point],
             ends->point[ring_at(disk[e ^ (k == 0)], r->to[k])],
             n_ring * sizeof *m->point);
      m->n_point += n_ring;
    }
    join_rings(m, k, from, from + n_ring, n_ring, rows);
  }
done:
  return st;
}

vg_status vg_demo_exchanger_surface(const struct vg_demo_spacing *law,
                                    struct vg_demo *d, struct vg_error *err)
{
  static const uint32_t patch[2][3] = { { HOT_IN, ENDS, COLD_OUT },
                                        { HOT_OUT, ENDS, COLD_IN } };
  static const double seed[3][3] = { { .5 * CASING_LENGTH, .04,
                                       .03 }, /* at the radii 0.05, 0.25, 0.4 */
                                     { .5 * CASING_LENGTH, .2, .15 },
                                     { .5 * CASING_LENGTH, .32, .24 } };
  const struct rings r = count_rings(law->h_max);
  const uint32_t rows = edges_along(CASING_LENGTH, law->h_max);
  const size_t n = r.to[2];
  struct vg_mesh *m = &d->surface;
  vg_status st;

  VG_TRY(make_room(m, 6 * n * (n + 1) + 2 + 6 * n * (rows - 1),
                   12 * n * (n + rows), err));
  VG_TRY(add_surface_patches(m, err));
  for (int e = 0; e < 2; e++) add_end(m, &r, e * CASING_LENGTH, patch[e], e);
  join_rings(m, CASING, ring_at(0, r.to[2]),
             ring_at(ring_at(0, r.to[2] + 1), r.to[2]), 6 * n, rows);
  VG_TRY(add_pipe(d, &r, rows, err));
  add_zone(d, "hot", VG_ZONE_FLUID, seed[0]);
  add_zone(d, "pipe", VG_ZONE_SOLID, seed[1]);
  add_zone(d, "cold", VG_ZONE_FLUID, seed[2]);
  d->walls = "casing,pipe_inside_back,pipe_outside_back";
done:
  return st;
}
