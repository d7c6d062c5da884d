/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Which cells of the octree are split? A cell is split if trilinear
 * interpolation between its corners would miss the field by more than
 * TOLERANCE, but not below the spacing found in it (floor times that spacing):
 * within such a cell the field varies by a few per cent only.
 *
 * Size tensors are tested in the same way, by the error of edge lengths. Their
 * smallest spacing may be much less than the distance over which the field
 * changes, so a cell is not split because of a small spacing alone. Instead, a
 * stretched source is also sampled where it is nearest to the cell, so that no
 * source is missed. */
#include <math.h>
#include <string.h>

#include "core/geometry/tensor.h"
#include "core/sizing/sizing_build.h"

#define TOLERANCE 0.03 /* H1 */
#define MAP_CELLS 32   /* H7 */

/* H14: where the growth around a stretched source begins, the field has a kink.
 * To follow it to 5 %, the octree would need cells of the smallest size on the
 * whole shape, many times as many as the mesh has there. */
#define TENSOR_TOLERANCE 0.05
#define KINK_TOLERANCE 0.15

void vg_octree_family_start(struct vg_octree_family *y,
                            const struct vg_octree_cell *c)
{
  vg_octree_place(y->b, vg_octree_corner(y->b, c), y->reach.mid);
  for (int k = 0; k < 3; k++) y->reach.mid[k] += y->side;
  vg_bvh_reach_clear(&y->reach, y->side, 0.25f * c->floor);
}

void vg_octree_family_clear(struct vg_octree_family *y)
{
  for (int i = 0; i < 125; i++) y->face[i] = NAN;
  for (int i = 0; i < 125 && y->b->tensor; i++) y->tensor[i].least = NAN;
}

static void place(const struct vg_octree_family *y,
                  const struct vg_octree_cell *c, int i, double x[3])
{
  const uint32_t *from = vg_octree_corner(y->b, c);
  uint32_t q[3];
  int at[3];

  vg_octree_lattice(i, at);
  for (int k = 0; k < 3; k++) q[k] = from[k] + y->half * (uint32_t)at[k];
  vg_octree_place(y->b, q, x);
}

float vg_octree_sample(struct vg_octree_family *y,
                       const struct vg_octree_cell *c, int i)
{
  uint32_t hint = c->hint;
  double x[3];

  place(y, c, i, x);
  return (float)vg_stat_at(y->b->f, x, &y->reach, &hint);
}

void vg_octree_sample_tensor(struct vg_octree_family *y,
                             const struct vg_octree_cell *c, int i,
                             struct vg_size *out, float *iso)
{
  uint32_t hint = c->hint;
  double x[3];

  place(y, c, i, x);
  vg_stat_tensor_at(y->b->f, x, &y->reach, &hint, out, iso);
}

/* Place of the centre of a face in the lattice of the family. */
static int face_slot(int sibling, int i)
{
  static const int wide[3] = { 1, 5, 25 };
  int at[3], slot = 0;

  vg_octree_lattice(i, at);
  for (int k = 0; k < 3; k++)
    slot += wide[k] * (at[k] + 2 * (sibling >> k & 1));
  return slot;
}

/* Field at the centre of a face, which siblings share. */
static float sample_face(struct vg_octree_family *y,
                         const struct vg_octree_cell *c, int sibling, int i)
{
  float *at = y->face + face_slot(sibling, i);

  if (isnan(*at)) *at = vg_octree_sample(y, c, i);
  return *at;
}

/* Mean of the corners on face (axis, end); of all corners if axis < 0. */
static float corner_mean(const float h[8], int axis, int end)
{
  float sum = 0;

  for (int i = 0; i < 8; i++)
    if (axis < 0 || (i >> axis & 1) == end) sum += h[i];
  return axis < 0 ? sum / 8 : sum / 4;
}

static int misses(float interpolated, float exact)
{
  return fabsf(interpolated - exact) > (float)TOLERANCE * exact;
}

static int face_point(int face)
{
  static const int stride[3] = { 1, 3, 9 };

  return 13 + stride[face / 2] * (face % 2 ? 1 : -1);
}

static int test_cell(struct vg_octree_family *y, const struct vg_octree_cell *c,
                     int sibling, const float h[8], float *centre)
{
  *centre = vg_octree_sample(y, c, 13);
  if (misses(corner_mean(h, -1, 0), *centre)) return 1;
  for (int i = 0; i < 6; i++)
    if (misses(corner_mean(h, i / 2, i % 2),
               sample_face(y, c, sibling, face_point(i))))
      return 1;
  return 0;
}

/* A map without known bounds is sampled everywhere (H7). */
static int is_unsampled(const struct vg_octree_build *b, double side)
{
  const struct vg_size_map *map = b->f->set.map ? b->f->set.map
                                                : b->f->set.metric;

  return map && !map->least && MAP_CELLS * side > VG_OCTREE_TOP * b->unit;
}

static int wants_split_size(struct vg_octree_family *y,
                            struct vg_octree_cell *c, int sibling,
                            float *centre)
{
  const struct vg_octree_build *b = y->b;
  float h[8], low = INFINITY;
  double lo[3], hi[3];
  int by_sources;

  if (is_unsampled(b, y->side)) return 1;
  if (y->side <= b->floor * (double)c->floor) return 0;
  vg_octree_place(b, vg_octree_corner(b, c), lo);
  for (int k = 0; k < 3; k++) hi[k] = lo[k] + y->side;
  c->floor = (float)vg_stat_floor(b->f, lo, y->side, &y->reach, &c->hint,
                                  &by_sources);
  c->rest = by_sources ? c->floor : c->floor * b->surface;
  if (y->side <= b->floor * (double)c->rest) return 0;
  if (!b->f->set.n_mean && b->f->h_max <= c->floor * (1 + TOLERANCE)) return 0;
  for (int i = 0; i < 8; i++) {
    h[i] = b->point[c->corner[i]].h;
    if (h[i] < low) low = h[i];
  }
  if (low > c->floor * (1 + 2 * TOLERANCE)) return 1;
  if (!vg_source_resolved(&b->f->set, lo, hi, y->side)) return 1;
  return test_cell(y, c, sibling, h, centre);
}

/* --- size tensors --------------------------------------------------------- */

/* A cell with size tensors at its corners. */
struct tensor_cell {
  struct vg_octree_family *y;
  struct vg_octree_cell *cell;
  double lo[3], hi[3];
  const struct vg_size *corner[8];
  double least, most;    /* range of sizes at the corners, and at the samples so
                            far */
  struct vg_size centre; /* field at the centre, if it is known */
  int is_known;
};

/* Trilinear size tensor at the position f, from 0 to 1. */
static void interpolate(const struct tensor_cell *c, const double f[3],
                        double h[6])
{
  for (int k = 0; k < 6; k++) h[k] = 0;
  for (int i = 0; i < 8; i++) {
    double w = 1;

    for (int k = 0; k < 3; k++) w *= i >> k & 1 ? f[k] : 1 - f[k];
    for (int k = 0; k < 6; k++) h[k] += w * (double)c->corner[i]->h[k];
  }
}

int vg_octree_has_kinks(const struct vg_octree_build *b)
{
  return !b->f->set.metric && !b->f->set.mean_is_stretched;
}

double vg_octree_tolerance(const struct vg_octree_build *b)
{
  return vg_octree_has_kinks(b) ? KINK_TOLERANCE : TENSOR_TOLERANCE;
}

static int misses_tensor(const struct tensor_cell *c,
                         const double interpolated[6],
                         const struct vg_size *exact)
{
  double h[6];

  for (int k = 0; k < 6; k++) h[k] = (double)exact->h[k];
  return vg_size_error(interpolated, h) > vg_octree_tolerance(c->y->b);
}

static const struct vg_size *centre_of(struct tensor_cell *c)
{
  if (!c->is_known)
    vg_octree_sample_tensor(c->y, c->cell, 13, &c->centre, NULL);
  c->is_known = 1;
  return &c->centre;
}

/* Does the interpolation miss the source where it is near? */
static int misses_source(void *context, const struct vg_stretched *s)
{
  struct tensor_cell *c = context;
  double x[3], f[3], h[6], source[6];
  struct vg_size_axes a;
  struct vg_size found;
  const struct vg_size *exact = &found;
  int is_centre;

  is_centre = vg_stretched_near(s, c->lo, c->hi, x);
  for (int k = 0; k < 3; k++) f[k] = (x[k] - c->lo[k]) / c->y->side;
  interpolate(c, f, h);
  vg_stretched_at(s, x, &a);
  vg_size_axes_tensor(&a, source);
  if (vg_size_is_within(h, source, vg_octree_tolerance(c->y->b))) return 0;
  if (is_centre) exact = centre_of(c);
  else
    vg_stat_tensor_at(c->y->b->f, x, &c->y->reach, &c->cell->hint, &found,
                      NULL);
  c->least = fmin(c->least, (double)exact->least);
  return misses_tensor(c, h, exact);
}

/* Isotropic sources, the surface and a map with known bounds must not be missed
 * either. Returns whether one of them requires a split. */
static int misses_floor(struct tensor_cell *c)
{
  const struct vg_octree_build *b = c->y->b;
  const struct vg_size_map *map = b->f->set.metric;
  struct vg_octree_cell *cell = c->cell;
  double floor, rest, low = INFINITY;
  int by_sources;

  for (int i = 0; i < 8; i++)
    low = fmin(low, (double)b->point[cell->corner[i]].h);
  floor = vg_stat_floor(b->f, c->lo, c->y->side, &c->y->reach, &cell->hint,
                        &by_sources);
  rest = by_sources ? floor : floor * (double)b->surface;
  cell->floor = (float)fmin(floor, c->least);
  if (floor < c->most && low > floor * (1 + 2 * TOLERANCE) &&
      c->y->side > b->floor * rest) {
    cell->rest = (float)rest;
    return 1;
  }
  if (!map || !map->least) return 0;
  floor = vg_stat_clamp(b->f, map->least(map->user, c->lo, c->hi));
  cell->floor = fminf(cell->floor, (float)floor);
  cell->rest = (float)floor;
  return floor * (1 + 2 * TOLERANCE) < c->least &&
         c->y->side > b->floor * floor;
}

static int misses_samples(struct tensor_cell *c, int sibling)
{
  double h[6];

  interpolate(c, (const double[3]){ 0.5, 0.5, 0.5 }, h);
  if (misses_tensor(c, h, centre_of(c))) return 1;
  for (int i = 0; i < 6; i++) {
    int at = face_point(i);
    double f[3] = { 0.5, 0.5, 0.5 };
    struct vg_size *exact = c->y->tensor + face_slot(sibling, at);

    f[i / 2] = i % 2;
    if (isnan(exact->least))
      vg_octree_sample_tensor(c->y, c->cell, at, exact, NULL);
    interpolate(c, f, h);
    if (misses_tensor(c, h, exact)) return 1;
  }
  return 0;
}

/* Edges that are short enough for a source at the corners are so in the whole
 * cell. */
static int misses_sources(struct tensor_cell *c)
{
  const struct vg_stretched_groups *all = &c->y->b->f->set.groups;
  double h[8][6];
  int is_missed = 0;

  for (int i = 0; i < 8 && all->n; i++)
    for (int k = 0; k < 6; k++) h[i][k] = (double)c->corner[i]->h[k];
  for (size_t i = 0; i < all->n && !is_missed; i++)
    is_missed = vg_stretched_group_finer(all->item + i, c->lo, c->hi, c->most,
                                         8, (const double(*)[6])h,
                                         vg_octree_tolerance(c->y->b),
                                         misses_source, c);
  return is_missed;
}

static int wants_split_tensor(struct tensor_cell *c, int sibling)
{
  const struct vg_octree_build *b = c->y->b;
  const struct vg_source_set *set = &b->f->set;
  int is_missed;

  if (is_unsampled(b, c->y->side)) return 1;
  if (misses_floor(c)) return 1;
  is_missed = misses_sources(c);
  c->cell->floor = fminf(c->cell->floor, (float)c->least);
  c->cell->rest = (float)c->least;
  if (c->y->side <= b->floor * c->least) return 0;
  return is_missed || !vg_source_resolved(set, c->lo, c->hi, c->y->side) ||
         misses_samples(c, sibling);
}

int vg_octree_wants_split(struct vg_octree_family *y, struct vg_octree_cell *c,
                          int sibling, float *centre)
{
  const struct vg_octree_build *b = y->b;
  struct tensor_cell t = { .y = y, .cell = c, .least = INFINITY };
  double mid[6];

  if (!b->tensor) return wants_split_size(y, c, sibling, centre);
  vg_octree_place(b, vg_octree_corner(b, c), t.lo);
  for (int k = 0; k < 3; k++) t.hi[k] = t.lo[k] + y->side;
  for (int i = 0; i < 8; i++) {
    t.corner[i] = b->tensor + c->corner[i];
    t.least = fmin(t.least, (double)t.corner[i]->least);
    t.most = fmax(t.most, (double)t.corner[i]->most);
  }
  interpolate(&t, (const double[3]){ 0.5, 0.5, 0.5 }, mid);
  *centre = (float)(y->side * y->side * y->side / vg_tensor_det(mid));
  if (y->side <= b->floor * (double)c->floor) return 0;
  return wants_split_tensor(&t, sibling);
}
