/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_probes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"
#include "core/geometry/vector.h"

/* Factor on radii: keeps sample points off the border, where their side is
 * undefined. */
#define WITHIN 0.999

void vg_probes_release(struct vg_probes *p)
{
  free(p->item);
  memset(p, 0, sizeof *p);
}

/* Add the sample point x + far * way. */
static void put(struct vg_probes *p, uint32_t i, const double x[3], double far,
                const double way[3])
{
  struct vg_probe *q;

  if (vg_reserve(&p->item, &p->cap, p->n + 1, sizeof *p->item)) {
    p->refused = 1;
    return;
  }
  q = p->item + p->n++;
  *q = (struct vg_probe){ .source = i };
  for (int k = 0; k < 3; k++) q->x[k] = x[k] + far * way[k];
}

static void put_at(struct vg_probes *p, uint32_t i, const double x[3])
{
  put(p, i, x, 0, x);
}

/* The six directions along the axes, then the eight diagonals between them. */
static void make_way(int i, double way[3])
{
  const double third = 0.57735026918962576;

  for (int k = 0; k < 3; k++) {
    if (i < 6) way[k] = i / 2 == k ? i % 2 ? 1 : -1 : 0;
    else way[k] = (i - 6) >> k & 1 ? third : -third;
  }
}

static void put_ball(struct vg_probes *p, const struct vg_source *s, uint32_t i,
                     int is_fine)
{
  put_at(p, i, s->p0);
  for (int w = 0; w < (is_fine ? 14 : 6) && s->r0 > 0; w++) {
    double way[3];

    make_way(w, way);
    put(p, i, s->p0, WITHIN * s->r0, way);
    if (is_fine) put(p, i, s->p0, 0.5 * s->r0, way);
  }
}

/* Two directions perpendicular to d. */
static void cross_ways(const double d[3], double way[2][3])
{
  int thin = 0;

  for (int k = 1; k < 3; k++)
    if (fabs(d[k]) < fabs(d[thin])) thin = k;
  for (int w = 0; w < 2; w++) {
    double axis[3] = { 0, 0, 0 }, length = 0;
    const double *b = w ? way[0] : axis;

    axis[thin] = 1;
    for (int k = 0; k < 3; k++) {
      int m = (k + 1) % 3, n = (k + 2) % 3;

      way[w][k] = d[m] * b[n] - d[n] * b[m];
      length += way[w][k] * way[w][k];
    }
    for (int k = 0; k < 3 && length > 0; k++) way[w][k] /= sqrt(length);
  }
}

static void put_tube(struct vg_probes *p, const struct vg_source *s, uint32_t i,
                     int is_fine)
{
  int is_cone = s->kind == VG_SOURCE_CYLINDER, n = is_fine ? 16 : 4;
  double d[3], way[2][3];

  for (int k = 0; k < 3; k++) d[k] = s->p1[k] - s->p0[k];
  cross_ways(d, way);
  for (int j = 0; j <= n; j++) {
    double t = 0.5 + WITHIN * ((double)j / n - 0.5), x[3];
    double r = WITHIN * (is_cone ? s->r0 + t * (s->r1 - s->r0) : s->r0);

    for (int k = 0; k < 3; k++) x[k] = s->p0[k] + t * d[k];
    put_at(p, i, x);
    for (int w = 0; w < 4 && r > 0; w++)
      put(p, i, x, w % 2 ? r : -r, way[w / 2]);
  }
}

/* Points at three radii of cones with some apexes. */
static void put_cones(struct vg_probes *p, const struct vg_source *s,
                      uint32_t i, int is_fine)
{
  const double cot = sqrt((s->mach - 1) * (s->mach + 1));
  const int n = is_fine ? 8 : 2, n_radius = 3;
  double d[3], axis[3], way[2][3];

  for (int k = 0; k < 3; k++) axis[k] = d[k] = s->p1[k] - s->p0[k];
  vg_unit(axis);
  cross_ways(d, way);
  for (int j = 0; j <= n; j++)
    for (int l = 1; l <= n_radius; l++) {
      const double t = 0.5 + WITHIN * ((double)j / n - 0.5);
      const double r = WITHIN * s->r0 * l / n_radius;
      double x[3];

      for (int k = 0; k < 3; k++)
        x[k] = s->p0[k] + t * d[k] + r * cot * axis[k];
      for (int w = 0; w < 4; w++) put(p, i, x, w % 2 ? r : -r, way[w / 2]);
    }
}

static void put_triangle(struct vg_probes *p, const struct vg_source *s,
                         uint32_t i, int is_fine)
{
  const int n = is_fine ? 4 : 2;
  double normal[3], length = 0;

  for (int k = 0; k < 3; k++) {
    int a = (k + 1) % 3, b = (k + 2) % 3;

    normal[k] = (s->p1[a] - s->p0[a]) * (s->p2[b] - s->p0[b]) -
                (s->p1[b] - s->p0[b]) * (s->p2[a] - s->p0[a]);
    length += normal[k] * normal[k];
  }
  for (int k = 0; k < 3 && length > 0; k++) normal[k] /= sqrt(length);
  for (int a = 0; a <= n; a++)
    for (int b = 0; a + b <= n; b++) {
      double x[3];

      for (int k = 0; k < 3; k++)
        x[k] = (a * s->p0[k] + b * s->p1[k] + (n - a - b) * s->p2[k]) / n;
      put_at(p, i, x);
      if (!(s->r0 > 0)) continue;
      put(p, i, x, WITHIN * s->r0, normal);
      put(p, i, x, -WITHIN * s->r0, normal);
    }
}

static void put_box(struct vg_probes *p, const struct vg_source *s, uint32_t i,
                    int is_fine)
{
  const int n = is_fine ? 5 : 3;

  for (int j = 0; j < n * n * n; j++) {
    const int at[3] = { j % n, j / n % n, j / n / n };
    double x[3];

    for (int k = 0; k < 3; k++) {
      double t = 0.5 + WITHIN * ((double)at[k] / (n - 1) - 0.5);

      x[k] = s->p0[k] + t * (s->p1[k] - s->p0[k]);
    }
    put_at(p, i, x);
  }
}

void vg_probes_shape(struct vg_probes *p, const struct vg_source *s, uint32_t i,
                     int is_fine)
{
  switch (s->kind) {
  case VG_SOURCE_VGRID_NODE: put_at(p, i, s->p0); break;
  case VG_SOURCE_POINT:
  case VG_SOURCE_SPHERE: put_ball(p, s, i, is_fine); break;
  case VG_SOURCE_VGRID_LINE:
  case VG_SOURCE_LINE:
  case VG_SOURCE_CYLINDER: put_tube(p, s, i, is_fine); break;
  case VG_SOURCE_TRIANGLE: put_triangle(p, s, i, is_fine); break;
  case VG_SOURCE_BOX: put_box(p, s, i, is_fine); break;
  case VG_SOURCE_MACHCONE: put_cones(p, s, i, is_fine); break;
  }
}

void vg_probes_around(struct vg_probes *p, size_t from, size_t to, double far)
{
  for (size_t j = from; j < to; j++)
    for (int w = 0; w < 6; w++) {
      double x[3], way[3];

      memcpy(x, p->item[j].x, sizeof x);
      make_way(w, way);
      put(p, p->item[j].source, x, far, way);
    }
}

/* Rays. Seen along x, an edge counts for a sample point if it spans the y of
 * the point (half open) and passes above its z. Edges are evaluated from their
 * lower end, so that both faces of an edge agree. */

struct ray {
  double y, z;
  uint32_t place;
};

static int by_y(const void *a, const void *b)
{
  const struct ray *r = a, *s = b;

  if (r->y != s->y) return r->y < s->y ? -1 : 1;
  return r->place < s->place ? -1 : r->place > s->place;
}

static int is_hit(const double *const v[3], const struct ray *r)
{
  const double at[2] = { r->y, r->z };
  int hit = 0;

  for (int k = 0; k < 3; k++) {
    const double *a = v[k], *b = v[(k + 1) % 3];
    int from = a[1] <= r->y;

    if (from == (b[1] <= r->y)) continue;
    hit ^= vg_orient2d(from ? a + 1 : b + 1, from ? b + 1 : a + 1, at) < 0;
  }
  return hit;
}

static size_t first_ray(const struct ray *ray, size_t n, double y)
{
  size_t lo = 0;

  while (n) {
    size_t half = n / 2;

    if (ray[lo + half].y < y) {
      lo += half + 1;
      n -= half + 1;
    } else {
      n = half;
    }
  }
  return lo;
}

static void cross_face(struct vg_probes *p, const struct ray *ray,
                       const double *const v[3])
{
  double lo[3], hi[3];

  for (int k = 0; k < 3; k++) {
    lo[k] = fmin(fmin(v[0][k], v[1][k]), v[2][k]);
    hi[k] = fmax(fmax(v[0][k], v[1][k]), v[2][k]);
  }
  for (size_t i = first_ray(ray, p->n, lo[1]); i < p->n; i++) {
    struct vg_probe *q = p->item + ray[i].place;
    double side;
    int from_behind;

    if (ray[i].y >= hi[1]) break;
    if (ray[i].z < lo[2] || ray[i].z > hi[2] || q->x[0] > hi[0] ||
        !is_hit(v, ray + i))
      continue;
    side = vg_orient3d(v[0], v[1], v[2], q->x);
    from_behind = vg_orient2d(v[0] + 1, v[1] + 1, v[2] + 1) > 0;
    if (from_behind && side < 0) q->crossings++;
    if (!from_behind && side > 0) q->crossings--;
  }
}

vg_status vg_probes_cross(struct vg_probes *p, const struct vg_mesh *m,
                          struct vg_error *err)
{
  struct ray *ray = vg_alloc(p->n, sizeof *ray);

  if (!ray) return vg_fail_memory(err, "the sample points of sources");
  for (size_t i = 0; i < p->n; i++) {
    struct vg_probe *q = p->item + i;

    q->crossings = 0;
    ray[i] = (struct ray){ q->x[1], q->x[2], (uint32_t)i };
  }
  qsort(ray, p->n, sizeof *ray, by_y);
  for (size_t i = 0; i < m->n_tri; i++) {
    const double *const v[3] = { m->point[m->tri[i][0]], m->point[m->tri[i][1]],
                                 m->point[m->tri[i][2]] };

    cross_face(p, ray, v);
  }
  free(ray);
  return VG_OK;
}
