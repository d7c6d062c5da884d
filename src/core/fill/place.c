/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/fill/place.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/buckets.h"
#include "base/hash.h"
#include "base/memory.h"
#include "core/fill/hgrid.h"
#include "core/fill/sites.h"
#include "core/geometry/vector.h"

/* Side of the cubic pattern relative to the spacing: the mean edge of a
 * body-centred cubic lattice of side 1 is (8 sqrt(3)/2 + 6) / 14 = 0.923. */
static const double lattice = 1.083; /* K9 */
/* Least distance between points, relative to the spacing of the later one. */
static const double exclusion = 0.66; /* K10 */
/* Least distance in a region, where fronts from all sides meet after a few
 * steps and leave shorter cells than in a void. It does not apply to points
 * proposed by the front itself: a missing point next to its long faces makes a
 * bad cell. */
static const double exclusion_region = 0.68; /* K11 */
/* Number of proposals from the front from which exclusion_region applies. */
static const int far_from_front = 2;
/* Least distance between points of the lattice and others, where the sizing
 * field is uniform. */
static const double exclusion_level = 0.72; /* K12 */
/* Height of the apex over a surface face: regular tetrahedron. */
static const double apex = 0.8165;

/* Points may propose others from this much farther away than points are
 * placed, in spacings: steps of the pattern lead this far across planes normal
 * to an axis. */
static const double sideways = 0.65; /* K13 */

/* A sizing field that changes by less than this share over one edge counts as
 * uniform. */
static const double uniform_within = 1e-3; /* K14 */

/* A proposal with a point nearer than this share of the exclusion distance is
 * rejected before the spacing at its position is evaluated. */
static const double exclusion_early = 0.9; /* K35 */
/* Square of the distance within which a point proposes sites of the lattice,
 * in units of half the pattern's side. The neighbours are at distances sqrt(3)
 * and 2. */
static const double neighbour2 = 4.84; /* K36: distance 2.2 */
/* Range of the random displacements of lattice points, in units of half the
 * side. */
static const double shaken = 2e-4; /* K37 */
/* Radius of the list of surrounding points, relative to the distance to a
 * proposed position plus the exclusion distance there: for a point where the
 * sizing field is uniform, and for a face. */
static const double list_level = 1.05, list_face = 1.1; /* K38 */

enum { N_BUCKET = 8192, BUCKET_ZERO = 4096 };

struct placer {
  const struct vg_tets *t;
  const struct vg_sizing *sizing;
  const struct vg_region *region;
  size_t n, cap, cap_h, cap_cell, cap_steps;
  double (*x)[3]; /* [n] points of t first */
  float *h;
  uint32_t *cell;          /* cell of t that contains the point */
  uint8_t *steps;          /* number of proposals from the front to the
                              point. Points of the front and points proposed
                              by its faces have 0; UINT8_MAX: that many or
                              more */
  uint8_t *open;           /* [t.n_point] bit i: direction i of the pattern does
                              not lead behind all faces of the point */
  struct vg_buckets queue; /* surface faces first, then points */
  size_t n_face;
  uint32_t *face; /* surface faces, as links 4 * cell + face */
  struct vg_hgrid near;
  int is_listed;         /* `near` lists the points around the present point */
  int now;               /* steps of the points that are proposed now */
  struct vg_sites sites; /* lattice sites that are occupied or rejected for
                            good */
};

/* --- queue ---------------------------------------------------------------- */

/* Eight buckets per doubling of the spacing; first in, first out. */
static int bucket_of(double h)
{
  static const double step[8] = { 0.5,
                                  0.5452538663326288,
                                  0.5946035575013605,
                                  0.6484197773255048,
                                  0.7071067811865476,
                                  0.7711054127039704,
                                  0.8408964152537145,
                                  0.9170040432046712 };
  int e, k = 7;
  double m = frexp(h, &e);

  while (k && m < step[k]) k--;
  return 8 * e + k + BUCKET_ZERO;
}

static void push(struct placer *p, uint32_t item, double h)
{
  vg_buckets_push(&p->queue, bucket_of(h), item);
}

/* --- proposals ------------------------------------------------------------ */

static int reserve(struct placer *p, size_t n)
{
  return vg_reserve(&p->x, &p->cap, n, sizeof *p->x) ||
         vg_reserve(&p->h, &p->cap_h, n, sizeof *p->h) ||
         vg_reserve(&p->cell, &p->cap_cell, n, sizeof *p->cell) ||
         vg_reserve(&p->steps, &p->cap_steps, n, sizeof *p->steps) ||
         vg_buckets_reserve(&p->queue, p->n_face + n);
}

/* Should points be placed at x? h: the spacing at a position at most `off`
 * away from x. */
static int is_wanted(const struct placer *p, const double x[3], double h,
                     double off)
{
  return !p->region ||
         vg_region_near_by(p->region, p->sizing, x, VG_BAND_PLACE, h, off);
}

/* Place a point at c + d, unless it is outside. h: its spacing, which is that
 * of a position at most `off` away. */
static int stand(struct placer *p, const double c[3], const double d[3],
                 double h, double off, uint32_t start)
{
  double x[3] = { c[0] + d[0], c[1] + d[1], c[2] + d[2] };
  uint32_t cell, point = (uint32_t)p->n;

  if (!is_wanted(p, x, h, off)) return 0;
  cell = vg_tets_locate(p->t, start, x);
  if (cell == VG_NONE || p->t->flag[cell] & VG_OUTSIDE) return 0;
  if (reserve(p, p->n + 1)) return -1;
  memcpy(p->x[point], x, sizeof x);
  p->h[point] = (float)h;
  p->cell[point] = cell;
  p->steps[point] = (uint8_t)p->now;
  p->n++;
  if (vg_hgrid_add(&p->near, x, h)) return -1;
  push(p, (uint32_t)p->n_face + point, h);
  vg_hgrid_note(&p->near, d);
  return 0;
}

/* d out: unit * length, where length is the mean of the spacings at c (h) and
 * at the end of unit * h. Returns the latter. */
static double aim(const struct placer *p, const double c[3],
                  const double unit[3], double h, double d[3])
{
  double x[3], there;

  for (int k = 0; k < 3; k++) x[k] = c[k] + unit[k] * h;
  there = vg_sizing_at(p->sizing, x);
  for (int k = 0; k < 3; k++) d[k] = unit[k] * 0.5 * (h + there);
  return there;
}

/* Propose the point c + unit * length, with the length as in aim(). */
static int propose(struct placer *p, const double c[3], const double unit[3],
                   double h, uint32_t start)
{
  int is_far = p->region && p->now >= far_from_front;
  double d[3], there;

  for (int k = 0; k < 3; k++) d[k] = unit[k] * h;
  if (vg_hgrid_count(&p->near, d, exclusion_early * exclusion * h)) return 0;
  there = aim(p, c, unit, h, d);
  if (vg_hgrid_count(&p->near, d,
                     (is_far ? exclusion_region : exclusion) * there))
    return 0;
  return stand(p, c, d, there, fabs(there - h), start);
}

static const double pattern[8][3] = { { .5, .5, .5 },  { -.5, -.5, -.5 },
                                      { .5, .5, -.5 }, { -.5, -.5, .5 },
                                      { .5, -.5, .5 }, { -.5, .5, -.5 },
                                      { -.5, .5, .5 }, { .5, -.5, -.5 } };

static int is_uniform(const struct placer *p, const double x[3], double h)
{
  return fabs(vg_sizing_at(p->sizing, x) - h) <= uniform_within * h;
}

/* Does the sizing field change along all axes? */
static int is_graded(const struct placer *p, const double c[3])
{
  double g[3];

  vg_sizing_gradient_at(p->sizing, c, g);
  return fmin(fabs(g[0]), fmin(fabs(g[1]), fabs(g[2]))) > 2 * uniform_within;
}

/* In how many of six directions does the sizing field keep its value? In none
 * where it is graded, so that no other values are needed there. */
static int level_around(const struct placer *p, const double c[3], double h)
{
  int n = 0;

  if (is_graded(p, c)) return 0;
  for (int k = 0; k < 3; k++)
    for (int side = -1; side <= 1; side += 2) {
      double x[3] = { c[0], c[1], c[2] };

      x[k] += side * h;
      n += is_uniform(p, x, h);
    }
  return n;
}

/* A displacement of up to 1e-4, fixed for each point of the lattice. Without
 * it, points would lie on common spheres and planes while the lattice is being
 * built, and every predicate would need exact arithmetic. */
static double shake(const int64_t i[3], int k)
{
  uint64_t mix = vg_hash_mix(
    vg_hash_3((uint64_t)i[0], (uint64_t)i[1], (uint64_t)i[2]) + (uint64_t)k);

  return ((double)(mix & 0xffff) / 65536 - 0.5) * shaken;
}

/* List the points around point c, once for all its proposals. */
static void list_around(struct placer *p, const double c[3], double h)
{
  if (p->is_listed) return;
  vg_hgrid_gather(&p->near, c, h, (lattice + exclusion_level) * list_level * h);
  p->is_listed = 1;
}

/* Propose site i of the lattice. Returns 1 if the site is settled, so that no
 * other point need propose it: it is occupied or rejected for good. */
static int propose_site(struct placer *p, const double c[3], double h,
                        const int64_t i[3], uint32_t start, int everywhere)
{
  double half = 0.5 * lattice * h, d[3], x[3];

  for (int k = 0; k < 3; k++) {
    x[k] = half * ((double)i[k] + shake(i, k));
    d[k] = x[k] - c[k];
  }
  if (vg_dot(d, d) > neighbour2 * half * half) return 0;
  list_around(p, c, h);
  if (vg_hgrid_count(&p->near, d, exclusion_level * h)) return 1;
  if (!everywhere && !is_uniform(p, x, h)) return 0;
  return stand(p, c, d, h, 0, start) ? -1 : 1;
}

/* Where the sizing field is uniform, neighbours are points of one body-centred
 * cubic lattice through the origin, so that fronts that started anywhere meet
 * without defects. In units of half the side, the coordinates of a lattice
 * point are all even or all odd. */
static int grow_level(struct placer *p, const double c[3], double h,
                      uint32_t start, int everywhere)
{
  double half = 0.5 * lattice * h;
  int64_t base[3], i[3];

  for (int k = 0; k < 3; k++) base[k] = (int64_t)floor(c[k] / half + 0.5);
  for (i[0] = base[0] - 2; i[0] <= base[0] + 2; i[0]++)
    for (i[1] = base[1] - 2; i[1] <= base[1] + 2; i[1]++) {
      if ((i[0] ^ i[1]) & 1) continue;
      for (i[2] = base[2] - 2; i[2] <= base[2] + 2; i[2]++)
        if (!((i[0] ^ i[2]) & 1) &&
            propose_site(p, c, h, i, start, everywhere) < 0)
          return -1;
    }
  return 0;
}

/* Index of the lattice site at x, where the spacing is h. Returns 0 if there
 * is no site at x, or if it is too far from the origin for the index. */
static int find_site(const double x[3], double h, int64_t i[3])
{
  double half = 0.5 * lattice * h;

  for (int k = 0; k < 3; k++) {
    double at = floor(x[k] / half + 0.5);

    if (!(fabs(at) < 1e9) || fabs(x[k] - half * at) > uniform_within * half)
      return 0;
    i[k] = (int64_t)at;
  }
  return !((i[0] ^ i[1]) & 1) && !((i[0] ^ i[2]) & 1);
}

/* As grow_level, from a point of the lattice: proposes its neighbouring sites
 * that are not settled, in the same order. */
static int grow_site(struct placer *p, const double c[3], double h,
                     const int64_t base[3], uint32_t start, int everywhere)
{
  static const int8_t step[14][3] = {
    { -2, 0, 0 }, { -1, -1, -1 }, { -1, -1, 1 }, { -1, 1, -1 }, { -1, 1, 1 },
    { 0, -2, 0 }, { 0, 0, -2 },   { 0, 0, 2 },   { 0, 2, 0 },   { 1, -1, -1 },
    { 1, -1, 1 }, { 1, 1, -1 },   { 1, 1, 1 },   { 2, 0, 0 }
  };
  struct vg_site_block *b = NULL;

  for (int j = 0; j < 14; j++) {
    int64_t i[3] = { base[0] + step[j][0], base[1] + step[j][1],
                     base[2] + step[j][2] };
    int done;

    if (!b || !vg_site_is_in(b, i)) b = vg_sites_block(&p->sites, i, (float)h);
    if (!b) return -1;
    if (b->bit[i[0] & 7] & vg_site_bit(i)) continue;
    done = propose_site(p, c, h, i, start, everywhere);
    if (done < 0) return -1;
    if (done) b->bit[i[0] & 7] |= vg_site_bit(i);
  }
  return 0;
}

static int grow_point(struct placer *p, uint32_t point)
{
  double c[3], h = p->h[point];
  uint32_t start = p->cell[point];
  int64_t site[3];
  int level, bad = 0;

  memcpy(c, p->x[point], sizeof c);
  p->is_listed = 0;
  p->now = p->steps[point] < UINT8_MAX ? p->steps[point] + 1 : UINT8_MAX;
  level = level_around(p, c, h);
  if (level)
    bad = find_site(c, h, site) ? grow_site(p, c, h, site, start, level == 6)
                                : grow_level(p, c, h, start, level == 6);
  if (bad || level == 6) return bad;
  list_around(p, c, h);
  for (int i = 0; i < 8; i++) {
    double unit[3];

    if (point < p->t->n_point && !(p->open[point] >> i & 1)) continue;
    for (int k = 0; k < 3; k++) unit[k] = lattice * pattern[i][k];
    if (propose(p, c, unit, h, start)) return -1;
  }
  return 0;
}

/* A face whose corners are all lattice points belongs to a separator zone. Its
 * points continue the lattice, which an apex would only disturb. */
static int grow_face(struct placer *p, uint32_t link)
{
  const struct vg_cell *cell = &p->t->cell[link >> 2];
  const double *v[3];
  double a[3], b[3], n[3], c[3], unit[3], length, h;
  int64_t site[3];

  for (int k = 0; k < 3; k++) v[k] = p->t->x[cell->v[vg_face[link & 3][k]]];
  for (int k = 0; k < 3; k++) c[k] = (v[0][k] + v[1][k] + v[2][k]) / 3;
  vg_sub(v[1], v[0], a);
  vg_sub(v[2], v[0], b);
  vg_cross(a, b, n);
  length = vg_norm(n);
  if (!(length > 0)) return 0;
  for (int k = 0; k < 3; k++) unit[k] = apex * n[k] / length;
  h = vg_sizing_at(p->sizing, c);
  if (find_site(v[0], h, site) && find_site(v[1], h, site) &&
      find_site(v[2], h, site))
    return 0;
  if (p->region) { /* avoids the search if no point is wanted */
    double d[3], there = aim(p, c, unit, h, d);

    for (int k = 0; k < 3; k++) d[k] += c[k];
    if (!is_wanted(p, d, there, fabs(there - h))) return 0;
  }
  p->now = 0;
  vg_hgrid_gather(&p->near, c, h, (apex + exclusion) * list_face * h);
  return propose(p, c, unit, h, link >> 2);
}

/* --- seeds ---------------------------------------------------------------- */

/* Each cell of a grid gets one seed. The side of its cells is between half of
 * this and this, in units of the spacing. */
static const double seed_cell = 8; /* K15 */
/* The advancing points reach all finer parts of the sizing field while the
 * spacing falls by no more than this per unit length. They step over parts
 * with a steeper gradient. */
static const double steepest = 0.5; /* K16 */
/* Where the spacing is less than `hidden` times that of the seed of a cell,
 * the finer part therefore gets seeds of its own. There are no such seeds on
 * the slope to a still finer part, where the spacing falls by `falls` over
 * half its length. */
static const double hidden = 0.5, falls = 0.1;

struct seeder {
  const struct vg_sizing *sizing;
  const struct vg_region *region;
  struct vg_placed *out;
  size_t cap;
};

static int add_seed(struct seeder *s, const double x[3])
{
  if (vg_reserve(&s->out->x, &s->cap, s->out->n + 1, sizeof *s->out->x))
    return -1;
  memcpy(s->out->x[s->out->n++], x, sizeof *s->out->x);
  return 0;
}

/* Move x to the lattice with spacing h if the sizing field is uniform around
 * it. */
static void snap_to_lattice(const struct vg_sizing *sizing, double h,
                            double x[3])
{
  double a = lattice * h, to[3], step[3];

  for (int k = 0; k < 3; k++) to[k] = a * floor(x[k] / a + 0.5);
  for (int k = 0; k < 3; k++)
    for (int side = -1; side <= 1; side += 2) {
      memcpy(step, to, sizeof step);
      step[k] += 2 * side * h;
      if (fabs(vg_sizing_at(sizing, step) - h) > uniform_within * h) return;
    }
  memcpy(x, to, sizeof to);
}

/* Does the cube intersect the planes of the region, between its walls? If so,
 * its centre x is moved onto the planes. */
static int on_region(const struct vg_region *r, double side, double x[3])
{
  double foot[3];

  for (int i = 0; i < r->n_wall; i++) {
    const double *n = r->wall[i].normal;

    if (vg_plane_side(&r->wall[i], x) <
        -0.5 * side * (fabs(n[0]) + fabs(n[1]) + fabs(n[2])))
      return 0;
  }
  vg_region_foot(r, x, foot);
  for (int k = 0; k < 3; k++)
    if (fabs(foot[k] - x[k]) > 0.5 * side) return 0;
  memcpy(x, foot, sizeof foot);
  return 1;
}

static void octant_of(const double lo[3], double side, int octant,
                      double child[3])
{
  for (int k = 0; k < 3; k++)
    child[k] = lo[k] + (octant >> k & 1 ? 0.5 * side : 0);
}

static int seed(struct seeder *s, const double lo[3], double side)
{
  double x[3], h, child[3];

  for (int k = 0; k < 3; k++) x[k] = lo[k] + 0.5 * side;
  if (s->region && !on_region(s->region, side, x)) return 0;
  h = vg_sizing_at(s->sizing, x);
  if (side <= seed_cell * h) {
    snap_to_lattice(s->sizing, h, x);
    return add_seed(s, x);
  }
  for (int octant = 0; octant < 8; octant++) {
    octant_of(lo, side, octant, child);
    if (seed(s, child, 0.5 * side)) return -1;
  }
  return 0;
}

/* May the cube contain points to be placed? */
static int near_region(const struct seeder *s, const double mid[3], double side)
{
  const struct vg_region *r = s->region;
  double foot[3], least, most, h, reach;

  vg_region_foot(r, mid, foot);
  vg_sizing_range(s->sizing, &least, &most);
  h = vg_sizing_at(s->sizing, foot) +
      0.8660254037844387 * side * vg_sizing_slope(s->sizing);
  reach = vg_region_band(r, VG_BAND_PLACE) * fmin(h, most);
  for (int i = 0; i < r->n_plane + r->n_wall; i++) {
    const struct vg_plane *p = i < r->n_plane ? &r->plane[i]
                                              : &r->wall[i - r->n_plane];
    const double *n = p->normal;
    double d = vg_plane_side(p, mid);
    double far = reach + 0.5 * side * (fabs(n[0]) + fabs(n[1]) + fabs(n[2]));

    if (d < -far || (i < r->n_plane && d > far)) return 0;
  }
  return 1;
}

/* Is a seed needed at x, where the spacing is h? */
static int is_dip(const struct seeder *s, const double x[3], double h)
{
  if (s->region && !vg_region_near(s->region, s->sizing, x, VG_BAND_PLACE))
    return 0;
  for (int k = 0; k < 3; k++)
    for (int side = -1; side <= 1; side += 2) {
      double y[3] = { x[0], x[1], x[2] };

      y[k] += 0.5 * side * h;
      if (vg_sizing_at(s->sizing, y) < (1 - falls) * h) return 0;
    }
  return 1;
}

/* Place a seed in each cube where the sizing field is hidden by a coarser one;
 * cubes are as small as those of other seeds. below: seeds are placed where
 * the spacing is less than this; 0: no enclosing cube has its seed yet. In a
 * region, the position of the finest spacing may be too far away, so that
 * other positions are tried. Returns 1 if the cube has a seed now. */
static int seed_hidden(struct seeder *s, const double lo[3], double side,
                       double below)
{
  double x[3], mid[3], child[3], least, h;
  int is_small;

  for (int k = 0; k < 3; k++) mid[k] = lo[k] + 0.5 * side;
  if (s->region && !near_region(s, mid, side)) return 0;
  least = vg_sizing_least(s->sizing, lo, side, x);
  h = vg_sizing_at(s->sizing, mid);
  if (!(below > 0) && side <= seed_cell * h) below = hidden * h;
  if (below > 0 && least >= below) return 0;
  is_small = below > 0 && side <= seed_cell * least;
  if (is_small) {
    snap_to_lattice(s->sizing, least, x);
    if (is_dip(s, x, least)) return add_seed(s, x) ? -1 : 1;
    if (!s->region || side <= least) return 0;
  }
  for (int octant = 0; octant < 8; octant++) {
    int got;

    octant_of(lo, side, octant, child);
    got = seed_hidden(s, child, 0.5 * side, below);
    if (got < 0 || (got && is_small)) return got;
  }
  return 0;
}

vg_status vg_place_seeds(size_t n, const double (*x)[3],
                         const struct vg_sizing *sizing,
                         const struct vg_region *region, struct vg_placed *out,
                         struct vg_error *err)
{
  struct seeder s = { sizing, region, out, 0 };
  double lo[3] = { 0 }, side = 0;

  assert(sizing && out && (x || !n));
  memset(out, 0, sizeof *out);
  for (int k = 0; k < 3; k++) {
    double hi = n ? x[0][k] : 0;

    lo[k] = hi;
    for (size_t i = 0; i < n; i++) {
      if (x[i][k] < lo[k]) lo[k] = x[i][k];
      if (x[i][k] > hi) hi = x[i][k];
    }
    if (hi - lo[k] > side) side = hi - lo[k];
  }
  if (!(side > 0) ||
      (!seed(&s, lo, side) && (vg_sizing_slope(sizing) <= steepest ||
                               seed_hidden(&s, lo, side, 0) >= 0)))
    return VG_OK;
  vg_placed_release(out);
  return vg_fail_memory(err, "placing points");
}

/* --- the front ------------------------------------------------------------ */

/* May a point or face at x propose points near the region? */
static int may_propose(const struct placer *p, const double x[3], double h)
{
  return !p->region || vg_region_near_by(p->region, p->sizing, x,
                                         VG_BAND_PLACE + sideways, h, 0);
}

/* Bit i: direction i of the pattern leads in front of the face with normal n.
 */
static unsigned open_by(const double n[3])
{
  unsigned bits = 0;

  for (unsigned i = 0; i < 8; i++)
    bits |= (unsigned)(vg_dot(n, pattern[i]) > 0) << i;
  return bits;
}

/* Points without a face, i.e. seeds, count as far from the front. */
static void start_steps(struct placer *p)
{
  const struct vg_tets *t = p->t;

  memset(p->steps, UINT8_MAX, p->n * sizeof *p->steps);
  memset(p->open, UINT8_MAX, t->n_point * sizeof *p->open);
  for (size_t i = 0; i < p->n_face; i++) {
    const struct vg_cell *cell = &t->cell[p->face[i] >> 2];
    const uint8_t *f = vg_face[p->face[i] & 3];
    double a[3], b[3], n[3];
    unsigned open;

    vg_sub(t->x[cell->v[f[1]]], t->x[cell->v[f[0]]], a);
    vg_sub(t->x[cell->v[f[2]]], t->x[cell->v[f[0]]], b);
    vg_cross(a, b, n);
    open = open_by(n);
    for (int k = 0; k < 3; k++) {
      uint32_t v = cell->v[f[k]];

      p->open[v] = (uint8_t)(p->steps[v] ? open : p->open[v] | open);
      p->steps[v] = 0;
    }
  }
}

static int start_points(struct placer *p)
{
  const struct vg_tets *t = p->t;

  memcpy(p->x, t->x, t->n_point * sizeof *t->x);
  p->n = t->n_point;
  start_steps(p);
  for (size_t i = 0; i < p->n; i++) p->cell[i] = VG_NONE;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int k = 0; k < 4 && !(t->flag[c] & (VG_OUTSIDE | VG_DEAD)); k++)
      p->cell[t->cell[c].v[k]] = c;
  for (uint32_t i = 0; i < p->n; i++) {
    p->h[i] = (float)vg_sizing_at(p->sizing, p->x[i]);
    if (vg_hgrid_add(&p->near, p->x[i], p->h[i])) return -1;
    if (p->cell[i] != VG_NONE && may_propose(p, p->x[i], p->h[i]))
      push(p, (uint32_t)p->n_face + i, p->h[i]);
  }
  return 0;
}

static int start_faces(struct placer *p)
{
  const struct vg_tets *t = p->t;
  size_t n = 0;

  for (size_t c = 0; c < t->n_cell; c++)
    if (!(t->flag[c] & (VG_OUTSIDE | VG_DEAD)))
      n += (size_t)__builtin_popcount(t->flag[c] & VG_FIXED_FACES);
  p->face = vg_alloc(n, sizeof *p->face);
  p->open = vg_alloc(t->n_point, sizeof *p->open);
  if (!p->face || !p->open) return -1;
  p->n_face = n;
  n = 0;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; i < 4; i++)
      if (!(t->flag[c] & (VG_OUTSIDE | VG_DEAD)) && t->flag[c] >> i & 1)
        p->face[n++] = 4 * c + i;
  return reserve(p, t->n_point);
}

/* Faces are pushed first, so that they come before points of equal spacing. */
static int push_faces(struct placer *p)
{
  for (uint32_t i = 0; i < p->n_face; i++) {
    const struct vg_cell *cell = &p->t->cell[p->face[i] >> 2];
    double c[3] = { 0 }, h;

    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        c[k] += p->t->x[cell->v[vg_face[p->face[i] & 3][j]]][k] / 3;
    h = vg_sizing_at(p->sizing, c);
    if (may_propose(p, c, h)) push(p, i, h);
  }
  return 0;
}

static void release(struct placer *p)
{
  free(p->x);
  free(p->h);
  free(p->cell);
  free(p->steps);
  free(p->open);
  vg_buckets_release(&p->queue);
  free(p->face);
  vg_hgrid_release(&p->near);
  vg_sites_release(&p->sites);
  free(p);
}

static struct placer *start(const struct vg_tets *t,
                            const struct vg_sizing *sizing,
                            const struct vg_region *region)
{
  struct placer *p = vg_calloc(1, sizeof *p);
  double origin[3] = { 0 }, h_min, h_max;

  if (!p) return NULL;
  p->t = t;
  p->sizing = sizing;
  p->region = region;
  if (t->n_point) memcpy(origin, t->x[0], sizeof origin);
  vg_sizing_range(sizing, &h_min, &h_max);
  if (vg_buckets_init(&p->queue, N_BUCKET) ||
      vg_hgrid_init(&p->near, origin, h_min, h_max, vg_sizing_slope(sizing)) ||
      start_faces(p) || push_faces(p) || start_points(p)) {
    release(p);
    return NULL;
  }
  return p;
}

void vg_placed_release(struct vg_placed *p)
{
  assert(p);
  free(p->x);
  free(p->h);
  memset(p, 0, sizeof *p);
}

vg_status vg_place(const struct vg_tets *t, const struct vg_sizing *sizing,
                   const struct vg_region *region, size_t limit,
                   struct vg_placed *out, struct vg_error *err)
{
  assert(t->n_cell > 0 && sizing && out);

  struct placer *p = start(t, sizing, region);
  uint32_t item;
  int bad = 0;

  if (!p) return vg_fail_memory(err, "placing points");
  while (!bad && (item = vg_buckets_pop(&p->queue)) != VG_NONE) {
    bad = item < p->n_face ? grow_face(p, p->face[item])
                           : grow_point(p, item - (uint32_t)p->n_face);
    if (limit && p->n - t->n_point > limit) break;
  }
  if (bad || (limit && p->n - t->n_point > limit)) {
    release(p);
    return bad ? vg_fail_memory(err, "placing points")
               : vg_fail(err, VG_ERR_UNSUPPORTED,
                         "more than %zu field points are needed; use a "
                         "coarser spacing or raise the limit",
                         limit);
  }
  out->n = p->n - t->n_point;
  out->n_cut = p->near.n_cut;
  memmove(p->x, p->x + t->n_point, out->n * sizeof *p->x);
  memmove(p->h, p->h + t->n_point, out->n * sizeof *p->h);
  out->x = p->x;
  out->h = p->h;
  p->x = NULL;
  p->h = NULL;
  release(p);
  return VG_OK;
}
