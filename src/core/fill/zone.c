/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Selection of the cells that a region keeps: those along a plane (a separator
 * zone) or along a line (an edge separator, pencil). */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/fill/fill_parts.h"
#include "core/geometry/shape.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/metric/metrics.h"
#include "core/optimise/optimise.h"

/* Band for a plane without walls, which may use the whole known part of the
 * front; large surface triangles need that. Regions with adjacent regions use
 * a narrower band. */
static const double whole_band = VG_BAND_FRONT - 0.2;
/* Dents are not filled with cells of a worse shape than this (dihedral angles
 * of about 30 and 150 degrees). */
static const double dent = 0.25; /* K20 */
/* A cell of this shape (angles of 1 and 179 degrees) on the front, below a
 * cell that becomes final, would be the only cell that can fill the slit
 * between the two. */
static const double slit = 0.0003; /* K34 */
/* Cells with edges longer than this many spacings are not accepted in an edge
 * separator. */
static const double overlong = 4; /* K21 */

struct zone {
  struct vg_filling *g;
  uint8_t *at; /* [t.n_point] bits 2 i and 2 i + 1: the point is not below
                  and not above plane i; NULL: cells within reach belong to
                  the region, too */
  size_t cap_at;
  double band;    /* width within which the front is known */
  uint8_t *known; /* [t.n_point] 1: within that band */
  size_t cap_known;
};

static int is_corner(const struct zone *z, uint32_t p)
{
  return p >= z->g->front->n_point && p < z->g->front->n_point + 8;
}

static int all_four(const struct zone *z, const uint8_t *flag, uint32_t c)
{
  const uint32_t *v = z->g->t.cell[c].v;

  return flag[v[0]] && flag[v[1]] && flag[v[2]] && flag[v[3]];
}

/* Set z->at: the sides of the planes on which the points from `first` on
 * are. */
static vg_status find_point_sides(struct zone *z, size_t first,
                                  struct vg_error *err)
{
  const struct vg_tets *t = &z->g->t;
  const struct vg_region *r = z->g->region;

  if (r->reach > 0) return VG_OK;
  if (vg_reserve(&z->at, &z->cap_at, t->n_point, 1))
    return vg_fail_memory(err, "the points of a zone");
  for (size_t p = first; p < t->n_point; p++) {
    z->at[p] = 0;
    for (int i = 0; i < r->n_plane; i++) {
      double s = vg_plane_side(&r->plane[i], t->x[p]);

      z->at[p] |= (uint8_t)(((s >= 0) | (s <= 0) << 1) << 2 * i);
    }
  }
  return VG_OK;
}

/* The same for z->known. */
static vg_status find_known(struct zone *z, size_t first, struct vg_error *err)
{
  const struct vg_tets *t = &z->g->t;

  if (vg_reserve(&z->known, &z->cap_known, t->n_point, 1))
    return vg_fail_memory(err, "the points of a zone");
  for (size_t p = first; p < t->n_point; p++)
    z->known[p] = !is_corner(z, (uint32_t)p) &&
                  vg_region_near(z->g->region, z->g->sizing, t->x[p], z->band);
  return VG_OK;
}

/* Is the longest edge of cell c much longer than the spacing at it, and not an
 * edge of the front? Where the spacing grows away from a line, points are
 * placed in the shape of a trumpet; the cells across the space around it have
 * no points inside yet. */
static int is_overlong(const struct zone *z, uint32_t c)
{
  const struct vg_tets *t = &z->g->t;
  const uint32_t *v = t->cell[c].v;
  double most = 0, middle[3] = { 0 }, edge[3] = { 0 }, stretch[6], h;
  int is_new = 0;

  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++) {
      double d2 = vg_distance2(t->x[v[i]], t->x[v[j]]);

      if (d2 <= most) continue;
      most = d2;
      is_new = v[i] >= z->g->front->n_point || v[j] >= z->g->front->n_point;
      for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (t->x[v[i]][k] + t->x[v[j]][k]);
      vg_sub(t->x[v[i]], t->x[v[j]], edge);
    }
  if (vg_sizing_is_stretched(z->g->sizing)) {
    vg_sizing_stretch_at(z->g->sizing, middle, stretch);
    vg_tensor_apply(stretch, edge, edge);
    return is_new && vg_dot(edge, edge) > overlong * overlong;
  }
  h = vg_sizing_at(z->g->sizing, middle);
  return is_new && most > overlong * overlong * h * h;
}

/* Does cell c belong to the region? Most cells do not cross a plane, which is
 * checked before any distance is computed. Overlong cells that are within
 * reach but do not cross all planes are left to the void. */
static int belongs(const struct zone *z, uint32_t c)
{
  const struct vg_tets *t = &z->g->t;
  const uint32_t *v = t->cell[c].v;
  const uint8_t *at = z->at;
  struct vg_region r = *z->g->region;

  if (at && (at[v[0]] | at[v[1]] | at[v[2]] | at[v[3]]) !=
              (1 << 2 * z->g->region->n_plane) - 1)
    return 0;
  if (!vg_region_has_cell(&r, z->g->sizing, t->x[v[0]], t->x[v[1]], t->x[v[2]],
                          t->x[v[3]]))
    return 0;
  if (!(r.reach > 0) || !is_overlong(z, c)) return 1;
  r.reach = 0;
  return vg_region_has_cell(&r, z->g->sizing, t->x[v[0]], t->x[v[1]],
                            t->x[v[2]], t->x[v[3]]);
}

/* Fix the faces between fluid cells and all others. */
static void fix_faces(struct vg_tets *t)
{
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && !(t->flag[c] & (VG_DEAD | VG_OUTSIDE)); i++) {
      uint32_t link = t->cell[c].link[i];

      if (link == VG_NONE || t->flag[link >> 2] & VG_OUTSIDE)
        t->flag[c] |= (uint8_t)(1 << i);
    }
}

/* --- holes ---------------------------------------------------------------- */

/* Is cell c a hole: a cell of the region that cannot be kept, because it has a
 * corner around which the front is not known? */
static int is_hole(const struct zone *z, uint32_t c)
{
  return !(z->g->t.flag[c] & (VG_DEAD | VG_OUTSIDE)) &&
         !all_four(z, z->known, c) && belongs(z, c);
}

static size_t count_holes(const struct zone *z)
{
  size_t n = 0;

  for (uint32_t c = 0; c < z->g->t.n_cell; c++) n += (size_t)is_hole(z, c);
  return n;
}

/* K53: passes of swaps that remove holes, and the largest shape of a cell that
 * is swapped; least distance of a point in a hole from other points. */
enum { HOLE_PASSES = 3 };
static const float hole_shape = 0.45F;
static const double hole_distance = 0.45;

/* Swap bad cells until the number of holes, which is n_hole, does not
 * decrease. */
static vg_status swap_holes(const struct zone *z, struct vg_metrics *metrics,
                            size_t n_hole, struct vg_error *err)
{
  struct vg_tets *t = &z->g->t;
  struct vg_optimise_report r = { 0 };
  size_t before = SIZE_MAX;
  float *q = vg_alloc(t->n_cell, sizeof *q);
  vg_status st = q ? VG_OK : vg_fail_memory(err, "the points of a zone");

  for (uint32_t c = 0; st == VG_OK && c < t->n_cell; c++)
    q[c] = t->flag[c] & (VG_DEAD | VG_OUTSIDE)
           ? 1
           : (float)vg_metrics_shape(metrics, t, t->cell[c].v);
  for (int k = 0; st == VG_OK && n_hole && n_hole < before && k < HOLE_PASSES;
       k++) {
    st = vg_optimise_swaps(t, hole_shape, metrics, &q, &r, err);
    z->g->report->n_flip += r.n_flip;
    before = n_hole;
    n_hole = count_holes(z);
  }
  free(q);
  return st;
}

/* A position within hole c: one length from the centre of its known corners
 * towards the others, at most halfway. Returns 0 if no corner is known. */
static int inside_hole(const struct zone *z, uint32_t c, double x[3])
{
  const struct vg_tets *t = &z->g->t;
  const uint32_t *v = t->cell[c].v;
  double mean[2][3] = { { 0 } }, d[3], e[3], stretch[6], share;
  int n[2] = { 0, 0 };

  for (int i = 0; i < 4; i++) {
    int is = z->known[v[i]];

    n[is]++;
    for (int k = 0; k < 3; k++) mean[is][k] += t->x[v[i]][k];
  }
  if (!n[1]) return 0;
  for (int k = 0; k < 3; k++) {
    mean[1][k] /= n[1];
    d[k] = mean[0][k] / n[0] - mean[1][k];
  }
  vg_sizing_stretch_at(z->g->sizing, mean[1], stretch);
  vg_tensor_apply(stretch, d, e);
  share = fmin(0.5, 1 / vg_norm(e));
  for (int k = 0; k < 3; k++) x[k] = mean[1][k] + share * d[k];
  return 1;
}

/* Insert a point into each hole whose surroundings are coarse enough. */
static vg_status split_holes(struct zone *z, struct vg_metrics *metrics,
                             struct vg_error *err)
{
  struct vg_tets *t = &z->g->t;
  struct vg_inserter s;
  vg_status st = vg_inserter_init(&s, t, err);

  for (uint32_t c = 0; st >= 0 && c < t->n_cell; c++) {
    size_t first = t->n_point;
    struct vg_point_metric m;
    double x[3];

    if (!is_hole(z, c) || !inside_hole(z, c, x)) continue;
    vg_metric_at(z->g->sizing, x, &m);
    st = vg_metrics_insert(metrics, &s, x, &m, c, hole_distance, hole_distance,
                           err);
    if (st != VG_OK) continue;
    z->g->report->n_inserted++;
    st = find_point_sides(z, first, err);
    if (st == VG_OK) st = find_known(z, first, err);
  }
  vg_inserter_release(&s);
  return st < 0 ? st : VG_OK;
}

/* In a metric, the cavity of a point is found in a mean of metrics. Slivers
 * between a distant corner and placed points may stay outside all cavities,
 * across cells that are dense otherwise. Swaps remove most of them; others get
 * a point, and swaps follow again. */
static vg_status close_holes(struct zone *z, struct vg_error *err)
{
  struct vg_metrics metrics = { .sizing = z->g->sizing };
  size_t n_hole = count_holes(z);
  vg_status st = VG_OK;

  if (!n_hole) return VG_OK;
  if (vg_metrics_add(&metrics, &z->g->t, 0, z->g->t.n_point))
    st = vg_fail_memory(err, "the points of a zone");
  if (st == VG_OK) st = swap_holes(z, &metrics, n_hole, err);
  if (st == VG_OK && count_holes(z)) {
    st = split_holes(z, &metrics, err);
    if (st == VG_OK) st = swap_holes(z, &metrics, count_holes(z), err);
  }
  vg_metrics_release(&metrics);
  return st;
}

vg_status vg_zone_narrow(struct vg_filling *g, struct vg_error *err)
{
  const struct vg_region *r = g->region;
  struct vg_tets *t = &g->t;
  struct zone z = { .g = g };
  vg_status st = find_point_sides(&z, 0, err);

  assert(r && (r->n_plane > 0 || r->n_wall > 0));
  assert(t->n_point >= g->front->n_point + 8);
  z.band = r->n_plane > 1 || r->n_wall ? VG_BAND_FLUID : whole_band;
  if (st == VG_OK) st = find_known(&z, 0, err);
  if (st == VG_OK && vg_sizing_is_stretched(g->sizing))
    st = close_holes(&z, err);
  if (st < 0) goto done;
  for (uint32_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & (VG_DEAD | VG_OUTSIDE) || all_four(&z, z.known, c))
      continue;
    t->flag[c] |= VG_OUTSIDE;
    g->out.n_hole += (size_t)belongs(&z, c);
  }
  fix_faces(t);
done:
  free(z.at);
  free(z.known);
  return st;
}

/* --- cells that are kept -------------------------------------------------- */

static double shares_of_spacing(const struct vg_sizing *sizing,
                                const double *const x[4])
{
  double e[3][3], middle[3], h;

  for (int i = 0; i < 3; i++) vg_sub(x[i + 1], x[0], e[i]);
  for (int k = 0; k < 3; k++)
    middle[k] = (x[0][k] + x[1][k] + x[2][k] + x[3][k]) / 4;
  h = vg_sizing_at(sizing, middle);
  return vg_triple(e[0], e[1], e[2]) / 6 / (h * h * h);
}

static void take(struct zone *z, uint32_t c)
{
  struct vg_tets *t = &z->g->t;
  const double *x[4];

  for (int i = 0; i < 4; i++) x[i] = t->x[t->cell[c].v[i]];
  t->flag[c] |= VG_MARK;
  z->g->out.n_cell++;
  z->g->out.volume += shares_of_spacing(z->g->sizing, x);
}

static int is_within(const struct zone *z, uint32_t c)
{
  const struct vg_tets *t = &z->g->t;

  for (int i = 0; i < 4; i++)
    if (!vg_region_within(z->g->region, t->x[t->cell[c].v[i]])) return 0;
  return 1;
}

/* Shape of a cell; in a metric, that of its image under the stretch at its
 * first corner. */
static double shape_of(const struct zone *z, uint32_t c)
{
  const struct vg_tets *t = &z->g->t;
  const uint32_t *v = t->cell[c].v;
  double stretch[6], x[4][3] = { { 0 } };

  if (!vg_sizing_is_stretched(z->g->sizing))
    return vg_shape(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]);
  vg_sizing_stretch_at(z->g->sizing, t->x[v[0]], stretch);
  for (int i = 1; i < 4; i++) {
    vg_sub(t->x[v[i]], t->x[v[0]], x[i]);
    vg_tensor_apply(stretch, x[i], x[i]);
  }
  return vg_shape(x[0], x[1], x[2], x[3]);
}

/* Does the circumsphere of cell c lie where points are placed? A larger sphere
 * would contain points that are placed later, because the cell is larger than
 * the final cells there. */
static int is_settled(const struct zone *z, uint32_t c)
{
  const double(*x)[3] = (const double(*)[3])z->g->t.x;
  const uint32_t *v = z->g->t.cell[c].v;
  const struct vg_region *region = z->g->region;
  double e[3][3], n[3][3], d[3], d2[3], det, r, middle[3], t[6];
  int is_stretched = vg_sizing_is_stretched(z->g->sizing);

  if (is_stretched) vg_sizing_stretch_at(z->g->sizing, x[v[0]], t);
  for (int i = 0; i < 3; i++) {
    vg_sub(x[v[i + 1]], x[v[0]], e[i]);
    if (is_stretched) vg_tensor_apply(t, e[i], e[i]);
    d2[i] = vg_dot(e[i], e[i]);
  }
  for (int i = 0; i < 3; i++) vg_cross(e[(i + 1) % 3], e[(i + 2) % 3], n[i]);
  det = vg_dot(e[0], n[0]);
  for (int k = 0; k < 3; k++)
    d[k] = (d2[0] * n[0][k] + d2[1] * n[1][k] + d2[2] * n[2][k]) / det / 2;
  r = vg_norm(d);
  if (is_stretched) {
    vg_tensor_invert(t, t);
    vg_tensor_apply(t, d, d);
  }
  for (int k = 0; k < 3; k++) middle[k] = x[v[0]][k] + d[k];
  if (!is_stretched) r /= vg_region_spacing(region, z->g->sizing, middle);
  return vg_region_near(region, z->g->sizing, middle, VG_BAND_PLACE - r);
}

static void leave(struct zone *z, uint32_t c)
{
  struct vg_tets *t = &z->g->t;
  const double *x[4];

  for (int i = 0; i < 4; i++) x[i] = t->x[t->cell[c].v[i]];
  t->flag[c] &= (uint8_t)~VG_MARK;
  z->g->out.n_cell--;
  z->g->out.n_hole++;
  z->g->out.volume -= shares_of_spacing(z->g->sizing, x);
}

/* Leave cells above a flat cell on the front to the void if they could not be
 * improved. The void then has room there. */
static void leave_no_slits(struct zone *z)
{
  struct vg_tets *t = &z->g->t;

  for (uint32_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & (VG_DEAD | VG_OUTSIDE | VG_MARK) ||
        !(t->flag[c] & VG_FIXED_FACES) || shape_of(z, c) >= slit)
      continue;
    for (int i = 0; i < 4; i++) {
      uint32_t link = t->cell[c].link[i];

      if (!(t->flag[c] >> i & 1) && link != VG_NONE &&
          t->flag[link >> 2] & VG_MARK)
        leave(z, link >> 2);
    }
  }
}

/* Keep the cells that belong to the region, and the cells that fill dents
 * between these without a further point, which makes the front smoother. Cells
 * that would leave a slit are not kept. */
vg_status vg_zone_choose(struct vg_filling *g, struct vg_error *err)
{
  struct zone z = { .g = g };
  struct vg_tets *t = &g->t;
  uint8_t *used = vg_calloc(t->n_point, 1);
  vg_status st = used ? find_point_sides(&z, 0, err)
                      : vg_fail_memory(err, "the points of a zone");

  assert(g->region && !g->out.n_cell);
  if (st < 0) goto done;
  for (uint32_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & VG_DEAD || !belongs(&z, c)) continue;
    take(&z, c);
    for (int i = 0; i < 4; i++) used[t->cell[c].v[i]] = 1;
  }
  for (uint32_t c = 0; c < t->n_cell; c++)
    if (!(t->flag[c] & (VG_DEAD | VG_MARK)) && all_four(&z, used, c) &&
        is_within(&z, c) && shape_of(&z, c) > dent && is_settled(&z, c))
      take(&z, c);
  leave_no_slits(&z);
done:
  free(z.at);
  free(used);
  return st;
}
