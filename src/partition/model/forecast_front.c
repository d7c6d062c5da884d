/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The coarse front of a forecast, and the effect of separator zones on it. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "partition/model/forecast_parts.h"

/* Cells of a pencil reach this many spacings to each side of both of its
 * planes (like VG_TILE_FILLED), and cells of a rib; measured over boxes and
 * spheres. */
static const double pencil_reach = 1.9, rib_reach = 0.5; /* M4 */

void vg_subdomain_release(struct vg_subdomain *p)
{
  vg_load_release(&p->load);
  free(p->front.bit);
  memset(&p->front, 0, sizeof p->front);
}

double vg_bins_faces(const struct vg_bins *f)
{
  double sum = 0;

  for (size_t i = 0; i < f->n; i++) sum += (double)f->bit[i].n;
  return sum;
}

vg_status vg_bins_add(struct vg_bins *f, const struct vg_bin *b,
                      struct vg_error *err)
{
  if (vg_reserve(&f->bit, &f->cap, f->n + 1, sizeof *f->bit))
    return vg_fail_memory(err, "a forecast");
  f->bit[f->n++] = *b;
  return VG_OK;
}

/* Cells in a share of an octant. */
void vg_amount_add(struct vg_amount *a, const struct vg_load_octant *c,
                   double share)
{
  assert(share >= 0);

  double side = 2 * (double)c->half / (double)c->h, cells = (double)c->cells;
  double octants = (double)c->part * side * side * side;
  double more = octants > 0 ? cells / (octants * VG_LOAD_CELLS_PER_CUBE) - 1
                            : 0;

  a->cells += share * cells;
  a->graded += share * cells * fmin(fmax(more / VG_LOAD_GRADED, 0), 1);
}

/* Axis of a plane of a lattice. */
static int axis_of(const struct vg_plane *p)
{
  return p->normal[0] > 0.5 ? 0 : p->normal[1] > 0.5 ? 1 : 2;
}

static double side_of_plane(const struct vg_plane *p, const float x[3])
{
  return p->normal[0] * (double)x[0] + p->normal[1] * (double)x[1] +
         p->normal[2] * (double)x[2] - p->offset;
}

/* Half the extent of an octant normal to a plane. */
static double half_across(const struct vg_load_octant *c,
                          const struct vg_plane *p)
{
  return (double)c->half *
         (fabs(p->normal[0]) + fabs(p->normal[1]) + fabs(p->normal[2]));
}

/* Fraction of the octant within `width` of the plane. */
static double overlap(const struct vg_load_octant *c, const struct vg_plane *p,
                      double width)
{
  double x = side_of_plane(p, c->at), half = half_across(c, p);

  /* Most octants are far from the plane. */
  if (x - half >= width || x + half <= -width) return 0;
  return (fmin(x + half, width) - fmax(x - half, -width)) / (2 * half);
}

/* Spacings from its planes that a zone's cells reach. */
static double reach_of(const struct vg_region *r)
{
  return r->n_plane == 1 ? VG_TILE_FILLED
       : r->reach > 0    ? pencil_reach
                         : rib_reach;
}

/* Target edge length of a bin across a plane of a lattice. */
static double across(const struct vg_bin *b, const struct vg_plane *p)
{
  return (double)b->across[axis_of(p)];
}

/* Is the foot of x on the planes within the walls? If x is a bin, it may be
 * `band` of its target edges outside of them. */
static int is_over(const struct vg_region *r, const float x[3],
                   const struct vg_bin *b, double band)
{
  double at[3] = { (double)x[0], (double)x[1], (double)x[2] }, foot[3];

  vg_region_foot(r, at, foot);
  for (int k = 0; k < r->n_wall; k++) {
    const double beyond = b ? band * across(b, &r->wall[k]) : 0;

    if (!(vg_dot(r->wall[k].normal, foot) > r->wall[k].offset - beyond))
      return 0;
  }
  return 1;
}

/* Is the bin within `band` target edges of all planes, and within the walls or
 * at most `beyond` target edges outside of them? */
static int is_near(const struct vg_region *r, const struct vg_bin *b,
                   double band, double beyond)
{
  for (int k = 0; k < r->n_plane; k++)
    if (fabs(side_of_plane(&r->plane[k], b->x)) >
        band * across(b, &r->plane[k]))
      return 0;
  return is_over(r, b->x, b, beyond);
}

/* Area of a face of the octant's cells in a plane, relative to an equilateral
 * triangle of edge 1. A unit cube of the metric has the volume h^3, and extends
 * by `distance` across the plane. */
static double face_area(const struct vg_load_octant *c, double distance)
{
  const double h = (double)c->h;

  return h * h * h / distance;
}

/* Adds the faces that a zone leaves where it passes through the octant: on both
 * sides of its plane, or all around a pencil. */
static vg_status add_sides(const struct vg_load_octant *c,
                           const struct vg_region *r, struct vg_bins *f,
                           struct vg_error *err)
{
  const double side = 2 * (double)c->half, part = (double)c->part;
  const double first = vg_load_across(c, r->plane[0].normal);
  const double reach = reach_of(r) * first;
  double area = face_area(c, first);
  struct vg_bin b = { .n = 0 };
  vg_status st = VG_OK;

  memcpy(b.x, c->at, sizeof b.x);
  memcpy(b.across, c->across, sizeof b.across);
  if (r->n_plane > 1) {
    const double second = vg_load_across(c, r->plane[1].normal);
    double at[3] = { (double)b.x[0], (double)b.x[1], (double)b.x[2] }, foot[3];

    vg_region_foot(r, at, foot);
    for (int k = 0; k < 3; k++) b.x[k] = (float)foot[k];
    /* two sides of each kind, with the same number of faces */
    b.n = (float)(VG_FACES_PER_SQUARE * part * side * 8 * reach_of(r) * second /
                  area);
    area = (first + second) / (2 * second) * area;
    b.h = (float)sqrt(area);
    return vg_bins_add(f, &b, err);
  }
  b.h = (float)sqrt(area);
  b.n = (float)(VG_FACES_PER_SQUARE * part * side * side / area);
  for (int sign = -1; st >= 0 && sign <= 1; sign += 2) {
    b.x[axis_of(&r->plane[0])] = (float)(r->plane[0].offset +
                                         sign * 1.01 * reach);
    st = vg_bins_add(f, &b, err);
  }
  return st;
}

/* Removes the front that a zone has covered. */
void vg_bins_cover(struct vg_bins *f, size_t n, const struct vg_region *r)
{
  assert(n <= f->n);

  size_t left = 0;

  for (size_t i = 0; i < f->n; i++)
    if (i >= n || !is_near(r, &f->bit[i], reach_of(r), 0))
      f->bit[left++] = f->bit[i];
  f->n = left;
}

double vg_bins_near(const struct vg_bins *f, size_t n,
                    const struct vg_region *r)
{
  assert(n <= f->n);

  double band = vg_region_band(r, VG_BAND_FRONT), sum = 0;

  for (size_t i = 0; i < n; i++)
    if (is_near(r, &f->bit[i], band, VG_BAND_FRONT)) sum += (double)f->bit[i].n;
  return sum;
}

/* Removes the cells of the region from the load. If the zone has a front, its
 * side faces are added. */
vg_status vg_bins_take(struct vg_subdomain *p, const struct vg_region *r,
                       struct vg_bins *made, struct vg_amount *a,
                       struct vg_error *err)
{
  vg_status st = VG_OK;

  *a = (struct vg_amount){ 0, 0 };
  for (size_t i = 0; st >= 0 && i < p->load.n; i++) {
    struct vg_load_octant *c = &p->load.octant[i];
    double reach = reach_of(r), share = 1;
    int passes = 1;

    for (int k = 0; share > 0 && k < r->n_plane; k++)
      share *= overlap(c, &r->plane[k],
                       reach * vg_load_across(c, r->plane[k].normal));
    if (!(share > 0) || !is_over(r, c->at, NULL, 0)) continue;
    for (int k = 0; k < r->n_plane; k++)
      passes &= fabs(side_of_plane(&r->plane[k], c->at)) <=
                half_across(c, &r->plane[k]);
    if (passes) st = add_sides(c, r, made, err);
    vg_amount_add(a, c, share);
    c->cells *= (float)(1 - share);
    c->part *= (float)(1 - share);
  }
  return st;
}
