/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/cut/lattice.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells within this many spacings of a line belong to its pencil. It
 * exceeds the thickness of tiles, so that tiles end at pencils and not at
 * each other. */
static const double pencil_reach = 1.3; /* C4 */
/* Minimum distance of parallel planes, in the largest spacing on them. */
static const double apart = 10; /* C5 */
/* Offsets of a plane, as shares of the load, for further attempts. */
static const double other_share[] = { 0, 0.07, -0.07, 0.15, -0.15 };
/* Blocks that exceed the leaf size by no more than this need no further cut. */
static const double leaf_slack = 1.25; /* C2 */

/* Below this number of leaves, single planes are grown one after another,
 * which costs least, since lattices have pencils and tiles have more boundary.
 * With more leaves more workers are expected, and these would wait for single
 * planes. */
static const double few_leaves = 80; /* C3 */

enum { HALVINGS = 6, PER_AXIS = 2 };

void vg_lattice_release(struct vg_lattice *l)
{
  free(l->rib);
  l->rib = NULL;
  l->n_rib = 0;
}

/* --- planes -------------------------------------------------------------- */

static double plane_at(const struct vg_load *load, int axis, int k, int n,
                       int retry)
{
  int most = (int)(sizeof other_share / sizeof *other_share);
  double share = (double)(k + 1) / (n + 1);

  return vg_load_quantile(load, axis,
                          share + other_share[retry % most] / (n + 1));
}

static void place_planes(const struct vg_load *load, int axis, int n, int retry,
                         struct vg_lattice *l)
{
  l->n[axis] = n;
  for (int k = 0; k < n; k++)
    l->at[axis][k] = plane_at(load, axis, k, n, retry);
}

/* Are all planes across the axis far enough apart? */
static int is_roomy(const struct vg_load *load, int axis,
                    const struct vg_lattice *l)
{
  for (int k = 0; k + 1 < l->n[axis]; k++) {
    double h = fmax(vg_load_coarsest(load, axis, l->at[axis][k]),
                    vg_load_coarsest(load, axis, l->at[axis][k + 1]));

    if (!(l->at[axis][k + 1] - l->at[axis][k] >= apart * h)) return 0;
  }
  return 1;
}

/* Cells in the zones of n planes across the axis; infinite if the planes are
 * too close. */
static double zone_cost(const struct vg_load *load, int axis, int n, int retry)
{
  struct vg_lattice l = { 0 };
  double sum = 0;

  place_planes(load, axis, n, retry, &l);
  if (!is_roomy(load, axis, &l)) return INFINITY;
  for (int k = 0; k < n; k++) {
    double cells = vg_load_zone(load, axis, l.at[axis][k], 1);

    if (!(cells > 0)) return INFINITY;
    sum += cells;
  }
  return sum;
}

static int bisections_wanted(const struct vg_load *load,
                             const struct vg_cut_rule *rule, int levels)
{
  int n = 0;

  if (!(rule->leaf_cells > 0)) return levels < HALVINGS ? levels : HALVINGS;
  if (load->cells < few_leaves * rule->leaf_cells)
    return load->cells > leaf_slack * rule->leaf_cells;
  while (n < HALVINGS &&
         load->cells > leaf_slack * rule->leaf_cells * (double)(1 << n))
    n++;
  return n;
}

/* The axis along which to halve the blocks next, chosen to add the fewest cells
 * to zones. */
static int next_axis(const struct vg_load *load, const struct vg_cut_rule *rule,
                     const int half[3], int retry)
{
  double least = INFINITY;
  int best = -1;

  for (int axis = 0; axis < 3; axis++) {
    int now = (1 << half[axis]) - 1, then = (1 << (half[axis] + 1)) - 1;
    double more;

    if (half[axis] == PER_AXIS) continue;
    if (rule->first_axis >= 0 && axis != rule->first_axis &&
        (rule->constant || !half[rule->first_axis]))
      continue;
    more = zone_cost(load, axis, then, retry);
    if (now) more -= zone_cost(load, axis, now, retry);
    /* the first plane across an axis is preferred to more planes across
     * another */
    if (more < least * (half[axis] && best >= 0 ? 0.8 : 1)) {
      least = more;
      best = axis;
    }
  }
  return best;
}

/* Is x outside the void, and not near its front either? */
static int is_outside(const struct vg_load *load, const double x[3])
{
  for (size_t i = 0; i < load->n; i++) {
    const struct vg_load_octant *c = &load->octant[i];
    int within = 1;

    for (int k = 0; k < 3; k++)
      within &= fabs(x[k] - (double)c->at[k]) <= (double)c->half;
    if (within) return 0;
  }
  return 1;
}

/* Growth starts and ends at a front. If the only common point of the three
 * lines is inside a body, the ends of each line are on fronts already. */
static int are_lines_apart(const struct vg_load *load,
                           const struct vg_lattice *l)
{
  const double x[3] = { l->at[0][0], l->at[1][0], l->at[2][0] };

  return l->n[0] == 1 && l->n[1] == 1 && l->n[2] == 1 && is_outside(load, x);
}

int vg_lattice_plan(const struct vg_load *load, const struct vg_cut_rule *rule,
                    int levels, int retry, struct vg_lattice *out)
{
  int want = bisections_wanted(load, rule, levels), used = 0;
  int half[3] = { 0, 0, 0 };

  assert(load && retry >= 0 && out);
  assert(rule->first_axis >= -1 && rule->first_axis < 3);
  assert(!rule->constant || rule->first_axis >= 0);
  memset(out, 0, sizeof *out);
  if (retry && want > 1) want = 1;
  for (; used < want; used++) {
    int axis = next_axis(load, rule, half, retry);

    if (axis < 0) break;
    half[axis]++;
  }
  for (int axis = 0; axis < 3; axis++)
    place_planes(load, axis, (1 << half[axis]) - 1, retry, out);
  out->lines_at_once = are_lines_apart(load, out);
  return used;
}

/* --- regions ------------------------------------------------------------- */

static void add_wall(struct vg_region *r, const double normal[3], double offset)
{
  memcpy(r->wall[r->n_wall].normal, normal, 3 * sizeof *normal);
  r->wall[r->n_wall++].offset = offset;
}

/* sign (x[axis] - at) > 0 */
static void bound(struct vg_region *r, int axis, int sign, double at)
{
  double normal[3] = { 0 };

  normal[axis] = sign;
  add_wall(r, normal, sign * at);
}

/* Walls midway to the neighbours of plane k. */
static void between(struct vg_region *r, const struct vg_lattice *l, int axis,
                    int k)
{
  const double *at = l->at[axis];

  if (k > 0) bound(r, axis, 1, 0.5 * (at[k - 1] + at[k]));
  if (k + 1 < l->n[axis]) bound(r, axis, -1, 0.5 * (at[k] + at[k + 1]));
}

/* sqrt(2) / 2, since walls have unit normals. */
static const double slope = 0.7071067811865476;

/* x[across] - at| < sign (x[along] - end): two walls at 45 degrees at the end
 * of a region, where another plane crosses. */
static void roof(struct vg_region *r, int across, double at, int along,
                 int sign, double end)
{
  for (int side = -1; side <= 1; side += 2) {
    double normal[3] = { 0 };

    normal[along] = slope * sign;
    normal[across] = slope * side;
    add_wall(r, normal, slope * (sign * end + side * at));
  }
}

/* Ends of interval k of the axis, between plane k - 1 and plane k. */
static void ends(struct vg_region *r, const struct vg_lattice *l, int along,
                 int k, int across, double at)
{
  if (k > 0) roof(r, across, at, along, 1, l->at[along][k - 1]);
  if (k < l->n[along]) roof(r, across, at, along, -1, l->at[along][k]);
}

static void cross(struct vg_region *r, int axis, double at)
{
  struct vg_plane *p = &r->plane[r->n_plane++];

  memset(p->normal, 0, sizeof p->normal);
  p->normal[axis] = 1;
  p->offset = at;
}

/* Lines along z, from end to end. */
static int line(const struct vg_lattice *l, size_t k, struct vg_region *r)
{
  int i = (int)k / l->n[1], j = (int)k % l->n[1];

  cross(r, 0, l->at[0][i]);
  cross(r, 1, l->at[1][j]);
  between(r, l, 0, i);
  between(r, l, 1, j);
  return 2;
}

static size_t segments_along(const struct vg_lattice *l, int axis)
{
  int b = (axis + 1) % 3, c = (axis + 2) % 3;

  return (size_t)((l->n[axis] + 1) * l->n[b] * l->n[c]);
}

/* Lines along x and y, between lines along z; with lines_at_once segments of
 * all lines, starting at their common point. */
static int segment(const struct vg_lattice *l, size_t k, struct vg_region *r)
{
  int along = 0, part;

  while (k >= segments_along(l, along)) k -= segments_along(l, along++);
  part = (int)(k % (size_t)(l->n[along] + 1));
  k /= (size_t)(l->n[along] + 1);
  for (int across = 0; across < 3; across++) {
    int i;

    if (across == along) continue;
    i = (int)(k % (size_t)l->n[across]);
    k /= (size_t)l->n[across];
    cross(r, across, l->at[across][i]);
    between(r, l, across, i);
    if (across != 2 || l->lines_at_once)
      ends(r, l, along, part, across, l->at[across][i]);
  }
  return along;
}

static size_t tiles_across(const struct vg_lattice *l, int axis)
{
  int b = (axis + 1) % 3, c = (axis + 2) % 3;

  return (size_t)(l->n[axis] * (l->n[b] + 1) * (l->n[c] + 1));
}

static int tile(const struct vg_lattice *l, size_t k, struct vg_region *r)
{
  int axis = 0, b, c, i, j, m;

  while (k >= tiles_across(l, axis)) k -= tiles_across(l, axis++);
  b = (axis + 1) % 3;
  c = (axis + 2) % 3;
  j = (int)k % (l->n[b] + 1);
  k /= (size_t)(l->n[b] + 1);
  m = (int)k % (l->n[c] + 1);
  i = (int)k / (l->n[c] + 1);
  cross(r, axis, l->at[axis][i]);
  between(r, l, axis, i);
  ends(r, l, b, j, axis, l->at[axis][i]);
  ends(r, l, c, m, axis, l->at[axis][i]);
  return axis;
}

/* A wall halfway between two ribs of a tile, on the given side. */
static void halfway(struct vg_region *r, const struct vg_plane *a,
                    const struct vg_plane *b, int sign)
{
  double normal[3], length = 0;

  for (int k = 0; k < 3; k++) {
    normal[k] = a->normal[k] + b->normal[k];
    length += normal[k] * normal[k];
  }
  length = sign * sqrt(length);
  for (int k = 0; k < 3; k++) normal[k] /= length;
  add_wall(r, normal, (a->offset + b->offset) / length);
}

static int rib(const struct vg_lattice *l, size_t k, struct vg_region *r)
{
  const struct vg_rib *rib = &l->rib[k], *end = l->rib + l->n_rib;
  int axis = tile(l, (size_t)rib->tile, r);

  r->plane[r->n_plane++] = rib->plane;
  if (rib > l->rib && rib[-1].tile == rib->tile)
    halfway(r, &rib[-1].plane, &rib->plane, 1);
  if (rib + 1 < end && rib[1].tile == rib->tile)
    halfway(r, &rib->plane, &rib[1].plane, -1);
  return axis;
}

/* Pieces between ribs: piece rib[i].tile + i is before rib i. */
static int piece(const struct vg_lattice *l, size_t k, struct vg_region *r)
{
  size_t n = 0, n_rib = (size_t)l->n_rib;
  int axis;

  while (n < n_rib && (size_t)l->rib[n].tile + n < k) n++;
  axis = tile(l, k - n, r);
  if (n > 0 && (size_t)l->rib[n - 1].tile == k - n)
    add_wall(r, l->rib[n - 1].plane.normal, l->rib[n - 1].plane.offset);
  if (n < n_rib && (size_t)l->rib[n].tile == k - n) {
    double normal[3];

    for (int i = 0; i < 3; i++) normal[i] = -l->rib[n].plane.normal[i];
    add_wall(r, normal, -l->rib[n].plane.offset);
  }
  return axis;
}

size_t vg_lattice_count(const struct vg_lattice *l, int stage)
{
  size_t x_y = segments_along(l, 0) + segments_along(l, 1);

  assert(stage >= 0 && stage < VG_LATTICE_STAGES);
  if (stage == 0 && l->lines_at_once) return x_y + segments_along(l, 2);
  if (stage == 0) return (size_t)(l->n[0] * l->n[1]);
  if (stage == 1) return l->lines_at_once ? 0 : x_y;
  if (stage == 2) return (size_t)l->n_rib;
  return tiles_across(l, 0) + tiles_across(l, 1) + tiles_across(l, 2) +
         (size_t)l->n_rib;
}

int vg_lattice_region(const struct vg_lattice *l, int stage, size_t k,
                      struct vg_region *r)
{
  assert(k < vg_lattice_count(l, stage) && r);
  memset(r, 0, sizeof *r);
  if (stage == VG_LATTICE_TILES) return piece(l, k, r);
  if (stage == 2) return rib(l, k, r);
  r->reach = pencil_reach;
  return stage || l->lines_at_once ? segment(l, k, r) : line(l, k, r);
}

void vg_lattice_patch(const struct vg_lattice *l, int axis, int i,
                      const double lo[3], const double hi[3],
                      struct vg_region *r)
{
  assert(axis >= 0 && axis < 3 && i >= 0 && i < l->n[axis]);
  assert(lo && hi && r);
  memset(r, 0, sizeof *r);
  cross(r, axis, l->at[axis][i]);
  between(r, l, axis, i);
  for (int k = 0; k < 3; k++) {
    if (k == axis) continue;
    bound(r, k, 1, lo[k]);
    bound(r, k, -1, hi[k]);
  }
}

/* --- blocks -------------------------------------------------------------- */

size_t vg_lattice_blocks(const struct vg_lattice *l)
{
  assert(l->n[0] >= 0 && l->n[0] <= VG_LATTICE_PLANES);
  assert(l->n[1] >= 0 && l->n[1] <= VG_LATTICE_PLANES);
  assert(l->n[2] >= 0 && l->n[2] <= VG_LATTICE_PLANES);
  return (size_t)(l->n[0] + 1) * (size_t)(l->n[1] + 1) * (size_t)(l->n[2] + 1);
}

uint32_t vg_lattice_block(const struct vg_lattice *l, const double x[3],
                          int upper)
{
  int block = 0;

  assert(upper == 0 || upper == 1);
  for (int axis = 2; axis >= 0; axis--) {
    int below = 0;

    for (int i = 0; i < l->n[axis]; i++)
      below += upper ? x[axis] >= l->at[axis][i] : x[axis] > l->at[axis][i];
    block = block * (l->n[axis] + 1) + below;
  }
  return (uint32_t)block;
}
