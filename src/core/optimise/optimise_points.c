/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Removal and insertion of points for bad cells that neither swaps nor
 * smoothing improve (Klingner, Shewchuk, "Aggressive tetrahedral mesh
 * improvement", 2007). Both are only accepted if the worst cell improves. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/optimise/optimise_parts.h"

/* K41: factor by which a removal or insertion must improve the worst shape,
 * and smallest fraction of the height that is tried for a point above a face.
 */
static const double gain = 1.01, least_share = 0.2;

/* K52: least length, in a metric, of the edges at a point for a bad cell. */
static const double least_length = 0.45;

static double worth(double old)
{
  return old < VG_SHAPE_FLAT ? VG_SHAPE_FLAT : old * gain;
}

/* --- edge collapse -------------------------------------------------------- */

struct merger {
  int n_new;
  uint32_t v[VG_OLD_MAX][4];
  float q[VG_OLD_MAX];
};

/* Cell k of the ball of p with p moved onto its neighbour `to`, and its shape.
 * Returns 0 if the cell disappears because `to` is one of its corners. */
static int move_cell(const struct vg_optimiser *o, size_t k, uint32_t to,
                     uint32_t w[4], double *q)
{
  const uint32_t *v = o->t->cell[o->ball[k] >> 2].v;

  if (v[0] == to || v[1] == to || v[2] == to || v[3] == to) return 0;
  memcpy(w, v, 4 * sizeof *w);
  w[o->ball[k] & 3] = to;
  *q = vg_shape_of(o, w[0], w[1], w[2], w[3]);
  return 1;
}

/* The ball of p with p moved onto its neighbour `to`. Returns 0 if the cells
 * are not better than `need`. */
static int plan_merge(const struct vg_optimiser *o, uint32_t to, double need,
                      struct merger *m, double *worst)
{
  m->n_new = 0;
  *worst = 2;
  for (size_t k = 0; k < o->n_ball; k++) {
    double q;

    if (!move_cell(o, k, to, m->v[m->n_new], &q)) continue;
    if (q <= need) return 0;
    if (q < *worst) *worst = q;
    m->q[m->n_new++] = (float)q;
  }
  return m->n_new > 0;
}

/* As plan_merge, for a ball with `most` flat cells: fewer flat cells remain,
 * and all cells are positive. This removes groups of adjacent flat cells, as
 * they occur between collinear points, one by one. Returns the number of flat
 * cells, or `most` if the collapse is rejected. */
static int plan_flat_merge(const struct vg_optimiser *o, uint32_t to, int most,
                           struct merger *m)
{
  const struct vg_tets *t = o->t;
  int n_flat = 0;

  m->n_new = 0;
  for (size_t k = 0; k < o->n_ball; k++) {
    const uint32_t *w = m->v[m->n_new];
    double q;

    if (!move_cell(o, k, to, m->v[m->n_new], &q)) continue;
    n_flat += q < VG_SHAPE_FLAT;
    if (n_flat >= most ||
        (q < VG_SHAPE_FLAT &&
         !(vg_orient3d(t->x[w[0]], t->x[w[1]], t->x[w[2]], t->x[w[3]]) > 0)))
      return most;
    m->q[m->n_new++] = (float)q;
  }
  return m->n_new > 0 ? n_flat : most;
}

/* The points that share an edge with the centre of the ball, each once. */
static int neighbours(const struct vg_optimiser *o, uint32_t *to)
{
  int n = 0;

  for (size_t k = 0; k < o->n_ball; k++)
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t v = o->t->cell[o->ball[k] >> 2].v[i];
      int m = 0;

      if (i == (o->ball[k] & 3)) continue;
      while (m < n && to[m] != v) m++;
      if (m == n) to[n++] = v;
    }
  return n;
}

static int merge_point(struct vg_optimiser *o, uint32_t p)
{
  struct merger plan[2];
  uint32_t old[VG_OLD_MAX], to[3 * VG_OLD_MAX];
  double need = 2, worst;
  int best = -1, now = 0, n_flat = 0, n;

  if (p < o->n_keep || o->failed[p] & VG_FAILED_COLLAPSE) return 0;
  o->failed[p] |= VG_FAILED_COLLAPSE;
  if (!vg_ball(o, p) || o->n_ball > VG_OLD_MAX) return 0;
  for (size_t k = 0; k < o->n_ball; k++) {
    old[k] = o->ball[k] >> 2;
    n_flat += o->q[old[k]] < VG_SHAPE_FLAT;
    if (o->q[old[k]] < need) need = o->q[old[k]];
  }
  need = worth(need);
  n = neighbours(o, to);
  for (int k = 0; k < n; k++) {
    if (!plan_merge(o, to[k], need, &plan[now], &worst)) continue;
    need = worst;
    best = now;
    now = !now;
  }
  for (int k = 0; k < n && need <= VG_SHAPE_FLAT && n_flat > 1; k++) {
    int left = plan_flat_merge(o, to[k], n_flat, &plan[now]);

    if (left == n_flat) continue;
    n_flat = left;
    best = now;
    now = !now;
  }
  if (best < 0) return 0;
  if (vg_replace(o, (int)o->n_ball, old, plan[best].n_new,
                 (const uint32_t(*)[4])plan[best].v, plan[best].q, NULL))
    return 0;
  o->star[p] = VG_NONE;
  o->report->n_collapse++;
  return 1;
}

/* Is an edge from `to` to a point of the ball of p longer than `most`? */
static int stretches(const struct vg_optimiser *o, uint32_t p, uint32_t to,
                     double most)
{
  for (size_t k = 0; k < o->n_ball; k++)
    for (int i = 0; i < 4; i++) {
      uint32_t v = o->t->cell[o->ball[k] >> 2].v[i];

      if (v != p && v != to &&
          vg_metrics_length(o->metrics, o->t, v, to) > most)
        return 1;
    }
  return 0;
}

int vg_merge_onto(struct vg_optimiser *o, uint32_t p, uint32_t to, double need,
                  double most)
{
  struct merger plan;
  uint32_t old[VG_OLD_MAX];
  double worst, now = 1;

  if (p < o->n_keep || !vg_ball(o, p) || o->n_ball > VG_OLD_MAX) return 0;
  for (size_t k = 0; k < o->n_ball; k++) {
    old[k] = o->ball[k] >> 2;
    now = fmin(now, o->q[old[k]]);
  }
  if (!plan_merge(o, to, fmin(need, now), &plan, &worst) ||
      stretches(o, p, to, most) ||
      vg_replace(o, (int)o->n_ball, old, plan.n_new,
                 (const uint32_t(*)[4])plan.v, plan.q, NULL))
    return 0;
  o->star[p] = VG_NONE;
  o->report->n_collapse++;
  return 1;
}

int vg_collapse(struct vg_optimiser *o, uint32_t c)
{
  uint32_t v[4];

  assert(c < o->t->n_cell && !(o->t->flag[c] & VG_DEAD));
  memcpy(v, o->t->cell[c].v, sizeof v);
  for (int i = 0; i < 4; i++)
    if (merge_point(o, v[i])) return 1;
  return 0;
}

/* --- insertion of a point ------------------------------------------------- */

/* Over stretched boundary triangles, a point needs a large cavity. */
enum { CAVITY_MAX = 44 }; /* K27 */

/* Limit of the number of cells that are examined to insert points: per
 * existing cell, and in addition. Aircraft with sliver triangles take 20
 * (F-16) to 16 (low-boom) per cell, others hardly any, an aerofoil meshed with
 * slivers only 340. */
enum { SPEND_PER_CELL = 24, SPEND_FREELY = 100000 }; /* K30 */

struct cavity {
  int n_old, n_new;
  uint32_t old[VG_OLD_MAX];
  uint32_t v[VG_NEW_MAX][4];
  uint32_t from[VG_NEW_MAX]; /* faces of the cavity, as links */
  float q[VG_NEW_MAX];
};

size_t vg_split_budget(const struct vg_tets *t)
{
  return SPEND_FREELY + SPEND_PER_CELL * (size_t)t->n_cell;
}

static int in_cavity(const struct cavity *h, uint32_t c)
{
  for (int k = 0; k < h->n_old; k++)
    if (h->old[k] == c) return 1;
  return 0;
}

/* Remove the face between cell `c`, which has joined the cavity, and a cell
 * that joined before. Returns 0 if a fixed face separates the two. */
static int drop_shared(const struct vg_tets *t, uint32_t c, struct cavity *h)
{
  for (int m = 0; m < h->n_new;) {
    uint32_t from = h->from[m], link = t->cell[from >> 2].link[from & 3];

    if (link == VG_NONE || link >> 2 != c) {
      m++;
      continue;
    }
    if (t->flag[c] >> (link & 3) & 1) return 0;
    h->n_new--;
    memcpy(h->v[m], h->v[h->n_new], sizeof h->v[m]);
    h->q[m] = h->q[h->n_new];
    h->from[m] = h->from[h->n_new];
  }
  return 1;
}

/* Connect the faces of the cavity to the point that is tried. A face that makes
 * a cell no better than `need` is opened: the cell behind it joins the cavity.
 * Returns 0 if this fails. */
static int open_cavity(struct vg_optimiser *o, double need, struct cavity *h)
{
  const struct vg_tets *t = o->t;
  const uint32_t p = (uint32_t)t->n_point;

  h->n_new = 0;
  for (int k = 0; k < h->n_old; k++) {
    uint32_t c = h->old[k];

    o->spent++;
    if (!drop_shared(t, c, h)) return 0;
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t link = t->cell[c].link[i], *w;
      const uint8_t *f = vg_face[i];
      double q;

      if (link != VG_NONE && in_cavity(h, link >> 2)) {
        if (t->flag[c] >> i & 1) return 0;
        continue;
      }
      if (h->n_new == VG_NEW_MAX) return 0;
      w = h->v[h->n_new];
      for (int j = 0; j < 3; j++) w[j] = t->cell[c].v[f[j]];
      q = vg_shape_of(o, w[0], w[1], w[2], p);
      if (q > need) {
        h->from[h->n_new] = 4 * c + i;
        h->q[h->n_new++] = (float)q;
        continue;
      }
      if (link == VG_NONE || t->flag[c] >> i & 1 || h->n_old == CAVITY_MAX)
        return 0;
      h->old[h->n_old++] = link >> 2;
    }
  }
  return 1;
}

static int is_kept(const struct cavity *h, uint32_t p)
{
  for (int m = 0; m < h->n_new; m++)
    if (h->v[m][0] == p || h->v[m][1] == p || h->v[m][2] == p) return 1;
  return 0;
}

/* Points of the old cells that are not corners of new cells lose their stars.
 * Returns 0, and changes nothing, if such a point may not be removed: with
 * is_flat, any field point may be. */
static int swallow(struct vg_optimiser *o, const struct cavity *h, int is_flat)
{
  uint32_t lost[4 * VG_OLD_MAX];
  int n = 0;

  for (int k = 0; k < h->n_old; k++)
    for (int i = 0; i < 4; i++) {
      uint32_t p = o->t->cell[h->old[k]].v[i];

      if (is_kept(h, p)) continue;
      if (!is_flat || p < o->n_keep) return 0;
      lost[n++] = p;
    }
  for (int k = 0; k < n; k++) o->star[lost[k]] = VG_NONE;
  return 1;
}

int vg_try_point(struct vg_optimiser *o, const double x[3])
{
  struct vg_tets *t = o->t;
  size_t p = t->n_point;

  if (vg_tets_reserve_points(t, 1) ||
      vg_reserve(&o->star, &o->cap_star, p + 1, sizeof *o->star) ||
      vg_reserve(&o->failed, &o->cap_failed, p + 1, sizeof *o->failed) ||
      (o->metrics && vg_metrics_reserve(o->metrics, p + 1))) {
    o->refused = 1;
    return -1;
  }
  memcpy(t->x[p], x, sizeof *t->x);
  if (o->metrics) vg_metric_at(o->metrics->sizing, x, &o->metrics->at[p]);
  return 0;
}

static int put_point(struct vg_optimiser *o, struct cavity *h, int is_flat)
{
  struct vg_tets *t = o->t;
  uint32_t p = (uint32_t)t->n_point;

  if (!swallow(o, h, is_flat)) return 0;
  for (int k = 0; k < h->n_new; k++) h->v[k][3] = p;
  if (vg_replace(o, h->n_old, h->old, h->n_new, (const uint32_t(*)[4])h->v,
                 h->q, NULL))
    return 0;
  t->n_point++;
  o->report->n_split++;
  return 1;
}

/* Is a corner of the cavity nearer to the point that is tried than `least`? */
static int is_crowded(const struct vg_optimiser *o, const struct cavity *h,
                      double least)
{
  for (int k = 0; k < h->n_new; k++)
    for (int i = 0; i < 3; i++)
      if (vg_metrics_length(o->metrics, o->t, h->v[k][i],
                            (uint32_t)o->t->n_point) < least)
        return 1;
  return 0;
}

/* The same for corner ring[k] of the cells around an edge. */
static int is_ring_crowded(const struct vg_optimiser *o, int n,
                           const uint32_t *ring, double least)
{
  for (int k = 0; k < n; k++)
    if (vg_metrics_length(o->metrics, o->t, ring[k], (uint32_t)o->t->n_point) <
        least)
      return 1;
  return 0;
}

static int split_at(struct vg_optimiser *o, uint32_t c, const double x[3],
                    double aim)
{
  struct cavity h;
  /* In a metric, flat cells over dents of a rounded boundary often need a
   * cavity that contains all cells of a field point. */
  int is_flat = o->metrics && o->q[c] < VG_SHAPE_FLAT;

  h.n_old = 1;
  h.old[0] = c;
  if (vg_try_point(o, x) || !open_cavity(o, worth(o->q[c]), &h) ||
      (o->metrics && !is_flat && is_crowded(o, &h, least_length)) ||
      !put_point(o, &h, is_flat))
    return 0;
  for (int k = 0; k < 3 && vg_smooth(o, (uint32_t)o->t->n_point - 1, aim);
       k++) {
  }
  return 1;
}

int vg_split_edge(struct vg_optimiser *o, uint32_t c, uint32_t a, uint32_t b,
                  double share, double least)
{
  struct cavity h;
  uint32_t ring[VG_OLD_MAX];
  double x[3], worst = 1;

  h.n_old = vg_cavity_ring(o->t, c, a, b, CAVITY_MAX, 0, h.old, ring);
  if (!h.n_old) return 0;
  for (int k = 0; k < h.n_old; k++) worst = fmin(worst, o->q[h.old[k]]);
  for (int k = 0; k < 3; k++) x[k] = 0.5 * (o->t->x[a][k] + o->t->x[b][k]);
  /* No corner of these cells may disappear into the cavity, so that nearly all
   * attempts that fail do so before it is opened. */
  return !vg_try_point(o, x) && !is_ring_crowded(o, h.n_old, ring, least) &&
         open_cavity(o, share * worst, &h) && !is_crowded(o, &h, least) &&
         put_point(o, &h, 0);
}

static void centre(const struct vg_tets *t, uint32_t c, const double share[4],
                   double x[3])
{
  for (int k = 0; k < 3; k++) {
    x[k] = 0;
    for (int i = 0; i < 4; i++) x[k] += share[i] * t->x[t->cell[c].v[i]][k];
  }
}

/* A position above the centroid of face i of cell c. Its height is `share`
 * times the square root of twice the area of the face; 0.88 gives a regular
 * tetrahedron. */
static void above(const struct vg_optimiser *o, uint32_t c, int i, double share,
                  double x[3])
{
  const struct vg_tets *t = o->t;
  const uint32_t *v = t->cell[c].v;
  const double *a = t->x[v[vg_face[i][0]]], *b = t->x[v[vg_face[i][1]]];
  const double *d = t->x[v[vg_face[i][2]]];
  double e[3], f[3], n[3], size;

  vg_sub(b, a, e);
  vg_sub(d, a, f);
  vg_cross(e, f, n);
  size = sqrt(o->metrics ? vg_metric_normal(vg_metrics_finest(o->metrics, v), n)
                         : vg_norm(n));
  for (int k = 0; k < 3; k++)
    x[k] = (a[k] + b[k] + d[k]) / 3 + (size > 0 ? share * n[k] / size : 0);
}

/* Split a cell on a fixed face: insert a point above that face, far enough
 * from it, in a cavity that is opened as needed. */
static int split_above(struct vg_optimiser *o, uint32_t c, double aim)
{
  double x[3];

  for (int i = 0; i < 4; i++) {
    if (!(o->t->flag[c] >> i & 1)) continue;
    for (double share = 1; share > least_share; share *= 0.5) {
      above(o, c, i, share, x);
      if (split_at(o, c, x, aim)) return 1;
    }
  }
  return 0;
}

/* Further positions are tried: the centroids of the cell's neighbours (for a
 * flat cell on the boundary) and of the cell, and for the worst cells the
 * midpoints of its edges. */
int vg_split(struct vg_optimiser *o, uint32_t c, double aim)
{
  assert(c < o->t->n_cell && !(o->t->flag[c] & VG_DEAD));
  static const double share[7][4] = { { .25, .25, .25, .25 }, { .5, .5, 0, 0 },
                                      { .5, 0, .5, 0 },       { .5, 0, 0, .5 },
                                      { 0, .5, .5, 0 },       { 0, .5, 0, .5 },
                                      { 0, 0, .5, .5 } };
  int n = o->q[c] < o->level->worst ? 7 : 1;
  double x[3];

  if (o->failed_cell[c] & VG_FAILED_SPLIT || o->spent > o->budget) return 0;
  if (split_above(o, c, aim)) return 1;
  for (int i = 0; i < 4; i++) {
    uint32_t link = o->t->cell[c].link[i];

    if (link == VG_NONE || o->t->flag[c] >> i & 1) continue;
    centre(o->t, link >> 2, share[0], x);
    if (split_at(o, c, x, aim)) return 1;
  }
  for (int k = 0; k < n; k++) {
    centre(o->t, c, share[k], x);
    if (split_at(o, c, x, aim)) return 1;
  }
  o->failed_cell[c] |= VG_FAILED_SPLIT;
  return 0;
}
