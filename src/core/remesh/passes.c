#include "core/remesh/passes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/graded.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/vector.h"

#define TOO_LONG 1.5      /* no collapse makes edges of more sizes */
#define ANGLE2 0.0669873  /* (sin 15 degrees)^2: no collapse below */
#define FINE2 0.45        /* (sin 42 degrees)^2: good enough */
#define ROUNDS 12

/* --- curves -------------------------------------------------------------- */

struct curve_size {
  const struct vg_work *w;
  size_t curve;
};

static double size_along(void *user, double s)
{
  const struct curve_size *c = user;
  const struct vg_work *w = c->w;
  double x[3];

  vg_curve_at(w->curves, w->ref, c->curve, s, x);
  return vg_work_size(w, x, VG_REF_NONE);
}

/* A half-edge of the line i; VG_REF_NONE: not found. */
static uint32_t half_of(const struct vg_work *w, uint32_t i)
{
  for (int k = 0; k < 2; k++) {
    uint32_t ring[VG_WORK_RING];
    int open;
    size_t n = vg_work_ring(w, w->line[i].end[k], ring, &open);

    for (size_t j = 0; j < n; j++) {
      if (w->edge[ring[j]] == i + 1) return ring[j];
      if (w->edge[vg_work_prev(ring[j])] == i + 1)
        return vg_work_prev(ring[j]);
    }
  }
  return VG_REF_NONE;
}

/* Put points into curve i, whose lines are first .. end - 1, and mark those
 * that stay. */
static vg_status divide(struct vg_work *w, size_t i, uint32_t first,
                        uint32_t end, uint8_t **stays, size_t *cap,
                        struct vg_error *err)
{
  struct curve_size user = { w, i };
  const double len = vg_curve_length(w->curves, i);
  int loop = w->line[first].end[0] == w->line[end - 1].end[1];
  double *s = NULL;
  size_t n;
  uint32_t cur = first, base = first;
  vg_status st;

  VG_TRY(vg_graded_steps(len, size_along, &user, loop ? 3 : 1, &n, &s, err));
  for (size_t k = 1; k < n; k++) {
    double slack = 0.02 * fmin(s[k] - s[k - 1], s[k + 1] - s[k]);
    uint32_t m = VG_REF_NONE, h;

    while (w->line[cur].at[1] < s[k] - slack && base + 1 < end) cur = ++base;
    if (w->line[cur].at[1] <= s[k] + slack) m = w->line[cur].end[1];
    else if (w->line[cur].at[0] >= s[k] - slack) m = w->line[cur].end[0];
    else if ((h = half_of(w, cur)) != VG_REF_NONE) {
      uint32_t n_line = (uint32_t)w->n_line;

      m = vg_work_split(w, h, &s[k]);
      if (m != VG_REF_NONE) cur = n_line;   /* the second half */
    }
    if (m == VG_REF_NONE) continue;
    if (m >= *cap) {
      size_t old = *cap;

      if (vg_reserve(stays, cap, m + 1, 1)) {
        st = vg_fail_memory(err, "the curves of the surface");
        goto done;
      }
      memset(*stays + old, 0, *cap - old);
    }
    (*stays)[m] = 1;
  }
done:
  free(s);
  return w->failed && st >= 0 ? vg_fail_memory(err, "the new surface") : st;
}

/* Towards that neighbour on the curve that is nearer. */
static int take_away(struct vg_work *w, uint32_t p)
{
  uint32_t ring[VG_WORK_RING], h[2], n_h = 0;
  int open;
  size_t n = vg_work_ring(w, p, ring, &open);

  for (size_t i = 0; i < n && n_h < 2; i++)
    if (w->edge[ring[i]]) h[n_h++] = ring[i];
  if (n_h == 2 && vg_work_ratio(w, h[1]) < vg_work_ratio(w, h[0])) {
    uint32_t g = h[0];

    h[0] = h[1];
    h[1] = g;
  }
  for (uint32_t i = 0; i < n_h; i++)
    if (vg_work_collapse(w, h[i], INFINITY, 0)) return 1;
  return 0;
}

vg_status vg_pass_curves(struct vg_work *w, struct vg_error *err)
{
  size_t cap = w->n_point, n_given = w->n_point, line = 0, n = 1;
  uint8_t *stays = vg_calloc(cap, 1);
  vg_status st = VG_OK;

  if (!stays) return vg_fail_memory(err, "the curves of the surface");
  for (size_t i = 0; i < w->curves->n_curve; i++) {
    size_t end = line + w->curves->curve[i].n - 1;

    VG_TRY(divide(w, i, (uint32_t)line, (uint32_t)end, &stays, &cap, err));
    line = end;
  }
  for (int round = 0; n && round < 4; round++) {
    n = 0;
    for (uint32_t p = 0; p < n_given; p++)
      if (w->point[p].kind == VG_WORK_CURVE && !stays[p]
          && w->point[p].half != VG_REF_NONE) n += (size_t)take_away(w, p);
    n += vg_pass_swap(w);
  }
  if (w->failed) st = vg_fail_memory(err, "the new surface");
done:
  free(stays);
  return st;
}

/* --- edges by length ----------------------------------------------------- */

/* Edges with a ratio beyond the bounds, by rising ratio: of positive doubles
 * the bits rise with the values. */
static vg_status edges_by_ratio(const struct vg_work *w, double lo, double hi,
                                int falls, struct vg_key **key, size_t *n,
                                struct vg_error *err)
{
  size_t cap = 0;

  *key = NULL;
  *n = 0;
  for (uint32_t h = 0; h < 3 * w->n_tri; h++) {
    double r;
    uint64_t bits;

    if (vg_work_removed(w, h / 3)
        || (w->mate[h] != VG_REF_NONE && w->mate[h] < h)) continue;
    r = vg_work_ratio(w, h);
    if (r >= lo && r <= hi) continue;
    memcpy(&bits, &r, sizeof bits);
    if (vg_reserve(key, &cap, *n + 1, sizeof **key))
      return vg_fail_memory(err, "the edges of the surface");
    (*key)[(*n)++] = (struct vg_key){ falls ? ~bits : bits, h };
  }
  return *n ? vg_sort_keys(*n, *key, err) : VG_OK;
}

static int try_collapse(struct vg_work *w, uint32_t h, double most)
{
  uint32_t g = w->mate[h];

  /* From the less bound end; equal ones, the one with the smaller size. */
  if (g != VG_REF_NONE) {
    const struct vg_work_point *a = &w->point[vg_work_from(w, h)];
    const struct vg_work_point *b = &w->point[vg_work_to(w, h)];

    if (a->kind > b->kind) {
      uint32_t k = h;

      h = g;
      g = k;
    }
  }
  return vg_work_collapse(w, h, most, ANGLE2)
         || (g != VG_REF_NONE && vg_work_collapse(w, g, most, ANGLE2));
}

vg_status vg_pass_collapse(struct vg_work *w, double least, double most,
                           size_t *n, struct vg_error *err)
{
  vg_status st = VG_OK;
  struct vg_key *key = NULL;
  size_t n_key, done = 1;

  *n = 0;
  for (int round = 0; done && round < ROUNDS; round++) {
    done = 0;
    free(key);
    VG_TRY(edges_by_ratio(w, least, INFINITY, 0, &key, &n_key, err));
    for (size_t i = 0; i < n_key; i++) {
      uint32_t h = key[i].index;

      if (vg_work_removed(w, h / 3) || vg_work_ratio(w, h) >= least) continue;
      done += (size_t)try_collapse(w, h, most);
    }
    *n += done;
    if (8 * done < n_key) done = 0;
    vg_pass_swap(w);
  }
  if (w->failed) st = vg_fail_memory(err, "the new surface");
done:
  free(key);
  return st;
}

/* Of both of its triangles: needles are cut across, not along. */
static int is_longest(const struct vg_work *w, uint32_t h)
{
  const double l = 0.999 * vg_work_ratio(w, h);

  for (int side = 0; side < 2; side++, h = w->mate[h]) {
    if (h == VG_REF_NONE) break;
    if (vg_work_ratio(w, vg_work_next(h)) > l
        || vg_work_ratio(w, vg_work_prev(h)) > l) return 0;
  }
  return 1;
}

vg_status vg_pass_split(struct vg_work *w, double most, int across, size_t *n,
                        struct vg_error *err)
{
  vg_status st = VG_OK;
  struct vg_key *key = NULL;
  size_t n_key, done = 1;

  *n = 0;
  for (int round = 0; done && round < ROUNDS; round++) {
    done = 0;
    free(key);
    VG_TRY(edges_by_ratio(w, 0, most, 1, &key, &n_key, err));
    for (size_t i = 0; i < n_key; i++) {
      uint32_t h = key[i].index;

      if (vg_work_removed(w, h / 3) || vg_work_ratio(w, h) <= most
          || (across && !is_longest(w, h))) continue;
      done += vg_work_split(w, h, NULL) != VG_REF_NONE;
    }
    *n += done;
    vg_pass_swap(w);
  }
  if (w->failed) st = vg_fail_memory(err, "the new surface");
done:
  free(key);
  return st;
}

/* --- swap ---------------------------------------------------------------- */

size_t vg_pass_swap(struct vg_work *w)
{
  size_t n = 0, now = 1;

  for (int round = 0; now && round < ROUNDS; round++) {
    const uint64_t before = w->swapped;

    now = 0;
    w->swapped = w->clock;
    for (uint32_t h = 0; h < 3 * w->n_tri; h++) {
      uint32_t g = w->mate[h];

      if (vg_work_removed(w, h / 3) || g == VG_REF_NONE || g < h
          || w->edge[h]) continue;
      if (w->point[vg_work_from(w, h)].changed <= before
          && w->point[vg_work_to(w, h)].changed <= before
          && w->point[vg_work_from(w, vg_work_prev(h))].changed <= before
          && w->point[vg_work_from(w, vg_work_prev(g))].changed <= before)
        continue;
      now += (size_t)vg_work_swap(w, h);
    }
    n += now;
    if (200 * now < w->n_tri / 100) now = 0;
  }
  return n;
}

/* --- smooth -------------------------------------------------------------- */

/* Mean of the places where p would make its triangles equilateral, seen from
 * the edges across. */
static int better_place(const struct vg_work *w, uint32_t p, double x[3],
                        double *worst)
{
  uint32_t ring[VG_WORK_RING];
  int open;
  size_t n = vg_work_ring(w, p, ring, &open);
  double sum = 0;

  if (!n || open) return 0;
  *worst = 1;
  memset(x, 0, 3 * sizeof *x);
  for (size_t i = 0; i < n; i++) {
    const double *a = vg_work_at(w, vg_work_to(w, ring[i]));
    const double *b = vg_work_at(w, vg_work_from(w, vg_work_prev(ring[i])));
    const double *o = vg_work_at(w, p);
    double e[3], d[3], mid[3], l2, along, high, weight;
    double shape = vg_work_shape(o, a, b);

    *worst = fmin(*worst, shape);
    vg_sub(b, a, e);
    l2 = vg_dot(e, e);
    for (int k = 0; k < 3; k++) mid[k] = (a[k] + b[k]) / 2;
    vg_sub(o, mid, d);
    along = vg_dot(d, e) / l2;
    for (int k = 0; k < 3; k++) d[k] -= along * e[k];
    high = vg_norm(d);
    if (!(high > 0)) continue;
    weight = 1 / (0.05 + shape);
    for (int k = 0; k < 3; k++)
      x[k] += weight * (mid[k] + d[k] * 0.8660254037844386 * sqrt(l2) / high);
    sum += weight;
  }
  if (!(sum > 0)) return 0;
  for (int k = 0; k < 3; k++) x[k] /= sum;
  return 1;
}

static int smooth_point(struct vg_work *w, uint32_t p)
{
  double x[3], worst, step = 1;
  const double *o = w->point[p].x;

  if (w->point[p].tried > w->point[p].changed) return 0;
  w->point[p].tried = ++w->clock;
  if (!better_place(w, p, x, &worst)) return 0;
  for (int i = 0; i < 2; i++, step /= 2) {
    double y[3];

    for (int k = 0; k < 3; k++) y[k] = o[k] + step * (x[k] - o[k]);
    if (vg_distance(y, o) < 0.01 * w->point[p].size) return 0;
    if (vg_work_move(w, p, y, worst > FINE2 ? worst
                     : worst + 0.02 * (1 - worst))) return 1;
  }
  return 0;
}

size_t vg_pass_smooth(struct vg_work *w, int sweeps)
{
  size_t n = 0;

  for (int i = 0; i < sweeps; i++)
    for (uint32_t p = 0; p < w->n_point; p++)
      if (w->point[p].half != VG_REF_NONE
          && w->point[p].kind == VG_WORK_FACE) n += (size_t)smooth_point(w, p);
  return n;
}

/* --- polish -------------------------------------------------------------- */

/* Try places around p, nearer and nearer, for its worst triangle. */
static int search_place(struct vg_work *w, uint32_t p)
{
  static const double way[8][2] = {
    { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 }, { 0.7, 0.7 }, { -0.7, 0.7 },
    { 0.7, -0.7 }, { -0.7, -0.7 } };
  const uint32_t h = w->point[p].half;
  double u[3], v[3], n[3], x[3], step = 0.2 * w->point[p].size;
  int moved = 0;

  if (w->point[p].kind != VG_WORK_FACE) return 0;
  vg_sub(vg_work_at(w, vg_work_to(w, h)), vg_work_at(w, p), u);
  vg_sub(vg_work_at(w, vg_work_from(w, vg_work_prev(h))), vg_work_at(w, p),
         v);
  vg_cross(u, v, n);
  if (!(vg_unit(u) > 0) || !(vg_unit(n) > 0)) return 0;
  vg_cross(n, u, v);
  for (int i = 0; i < 3; i++, step /= 3)
    for (int k = 0; k < 8; k++) {
      for (int d = 0; d < 3; d++)
        x[d] = w->point[p].x[d] + step * (way[k][0] * u[d] + way[k][1] * v[d]);
      moved += vg_work_move(w, p, x, 1);
    }
  return moved;
}

static int polish_tri(struct vg_work *w, uint32_t t)
{
  uint32_t order[3] = { 3 * t, 3 * t + 1, 3 * t + 2 };
  double shape = vg_work_tri_shape(w, t);

  for (int i = 0; i < 2; i++)       /* by length */
    for (int k = 0; k < 2 - i; k++)
      if (vg_work_ratio(w, order[k]) > vg_work_ratio(w, order[k + 1])) {
        uint32_t h = order[k];

        order[k] = order[k + 1];
        order[k + 1] = h;
      }
  for (int k = 2; k >= 0; k--)
    if (vg_work_swap(w, order[k])) return 1;
  for (int k = 0; k < 3; k++)
    if (search_place(w, w->tri[t][k]) && vg_work_tri_shape(w, t) > 1.1 * shape)
      return 1;
  for (int k = 0; k < 2; k++) {
    uint32_t h = order[k], g = w->mate[h];

    if (vg_work_ratio(w, h) > 1) break;
    if (vg_work_collapse(w, h, TOO_LONG + 0.2, 1)
        || (g != VG_REF_NONE && vg_work_collapse(w, g, TOO_LONG + 0.2, 1)))
      return 1;
  }
  return 0;
}

vg_status vg_pass_polish(struct vg_work *w, double shape, size_t *n,
                         struct vg_error *err)
{
  *n = 0;
  for (uint32_t t = 0; t < w->n_tri; t++)
    if (!vg_work_removed(w, t) && vg_work_tri_shape(w, t) < shape)
      *n += (size_t)polish_tri(w, t);
  return w->failed ? vg_fail_memory(err, "the new surface") : VG_OK;
}
