/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The five changes: split, collapse, swap, move and slide. Each collects the
 * old and the new triangles, has them checked, the cheapest test first, and
 * only then modifies the surface. */
#include "core/remesh/work_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

#define GAIN 1.02 /* least gain of a swap, in squared sines */
#define STUCK                                                                  \
  3.0 /* S37: target lengths: such edges ignore the relative tolerance */
#define NEARBY                                                                 \
  2.5 /* target lengths: shorter edges take their midpoint's size from their   \
         ends */
#define STRAY                                                                  \
  0.1 /* of the edge or size: farther projections have gone astray */
#define ALMOST 0.95 /* of the shape, tested before a point is projected */
#define FLAT2                                                                  \
  1e-8 /* S33: (sin 0.006 degrees)^2: no split creates flatter triangles */
#define SPLIT_LOSS 0.2 /* S23: least shape after a split, of that before */

/* --- bookkeeping --------------------------------------------------------- */

static void attach(struct vg_tris *w, uint32_t h, uint32_t mate, uint32_t edge)
{
  w->mate[h] = mate;
  w->edge[h] = edge;
  if (mate == VG_REF_NONE) return;
  w->mate[mate] = h;
  w->edge[mate] = edge;
}

static void set_tri(struct vg_tris *w, uint32_t t, uint32_t a, uint32_t b,
                    uint32_t c)
{
  const uint32_t p[3] = { a, b, c };

  for (uint32_t k = 0; k < 3; k++) {
    w->tri[t][k] = p[k];
    w->point[p[k]].half = 3 * t + k;
    w->point[p[k]].changed = ++w->clock;
  }
  w->stamp[t] = w->clock;
}

static uint32_t new_tri(struct vg_tris *w)
{
  uint32_t t;

  if (w->n_spare) return w->spare[--w->n_spare];
  if (vg_reserve(&w->tri, &w->cap_tri, w->n_tri + 1, sizeof *w->tri) ||
      vg_reserve(&w->mate, &w->cap_mate, 3 * w->n_tri + 3, sizeof *w->mate) ||
      vg_reserve(&w->edge, &w->cap_edge, 3 * w->n_tri + 3, sizeof *w->edge) ||
      vg_reserve(&w->stamp, &w->cap_stamp, w->n_tri + 1, sizeof *w->stamp) ||
      vg_reserve(&w->first, &w->cap_first, w->n_tri + 1, sizeof *w->first)) {
    w->failed = 1;
    return VG_REF_NONE;
  }
  t = (uint32_t)w->n_tri++;
  /* As a removed triangle: it stays one if there is no memory for the next. */
  memset(w->tri[t], 0, sizeof w->tri[t]);
  memset(w->mate + 3 * t, 0, 3 * sizeof *w->mate);
  memset(w->edge + 3 * t, 0, 3 * sizeof *w->edge);
  w->stamp[t] = 0;
  w->first[t] = VG_REF_NONE;
  return t;
}

static void remove_tri(struct vg_tris *w, uint32_t t)
{
  if (vg_reserve(&w->spare, &w->cap_spare, w->n_spare + 1, sizeof *w->spare))
    w->failed = 1;
  else w->spare[w->n_spare++] = t;
  w->tri[t][1] = w->tri[t][2] = w->tri[t][0];
}

static void normal_of(const struct vg_tris *w, uint32_t t, double n[3])
{
  double u[3], v[3], m[3];

  vg_sub(w->point[w->tri[t][1]].x, w->point[w->tri[t][0]].x, u);
  vg_sub(w->point[w->tri[t][2]].x, w->point[w->tri[t][0]].x, v);
  vg_cross(u, v, m);
  for (int k = 0; k < 3; k++) n[k] += m[k];
}

/* --- split --------------------------------------------------------------- */

static void middle_of(const struct vg_tris *w, uint32_t h, const double *at,
                      struct vg_tris_point *p, double *s)
{
  const double *a = vg_tris_at(w, vg_tris_from(w, h));
  const double *b = vg_tris_at(w, vg_tris_to(w, h));
  double n[3] = { 0, 0, 0 }, x[3];
  const double *n_or_any;

  if (w->edge[h]) {
    const struct vg_tris_line *l = &w->line[w->edge[h] - 1];

    *s = at ? *at : (l->at[0] + l->at[1]) / 2;
    vg_curve_at(w->curves, w->ref, l->curve, *s, p->x);
    return;
  }
  normal_of(w, h / 3, n);
  normal_of(w, w->mate[h] / 3, n);
  for (int k = 0; k < 3; k++) x[k] = (a[k] + b[k]) / 2;
  n_or_any = vg_unit(n) > 0 ? n : NULL;
  if (!(vg_ref_project(w->ref, x, n_or_any, &p->home, p->x) <=
        STRAY * vg_distance(a, b)))
    vg_ref_nearest(w->ref, x, n_or_any, &p->home, p->x);
}

static int split_fits(const struct vg_tris *w, uint32_t h,
                      const struct vg_tris_point *m, struct vg_cavity *c)
{
  const double ratio = vg_tris_ratio(w, h);
  double shape = 1;
  int face = !w->edge[h];

  c->on_curve = !face;
  for (int side = 0; side < 2; side++) {
    const struct vg_tris_point *a, *b, *o;

    if (side) h = w->mate[h];
    if (h == VG_REF_NONE) break;
    vg_cavity_narrow(w, c, vg_tris_from(w, vg_half_prev(h)));
    a = &w->point[vg_tris_from(w, h)];
    b = &w->point[vg_tris_to(w, h)];
    o = &w->point[vg_tris_from(w, vg_half_prev(h))];
    c->was[c->n_new] = c->was[c->n_new + 1] = (uint16_t)c->n_old;
    c->old[c->n_old++] = h / 3;
    shape = fmin(shape, vg_tris_shape(w, a, b, o));
    vg_cavity_add(c, a, m, o, side ? 2 : face + 2);
    vg_cavity_add(c, m, b, o, side ? 0 : face);
  }
  vg_cavity_measure(w, c);
  if (ratio > STUCK) c->tolerance = fmax(c->tolerance, w->tolerance);
  /* A feature edge that cannot be split where it is needed stays too long for
   * good. */
  return c->shape > (face ? SPLIT_LOSS : 0.01) * shape &&
         (!face || c->shape >= fmin(shape, FLAT2)) && vg_cavity_fits(w, c);
}

/* Between the ends of a long edge sizes may be smaller than at its ends. */
static void size_between(const struct vg_tris *w, uint32_t h,
                         struct vg_tris_point *p)
{
  const uint32_t end[2] = { vg_tris_from(w, h), vg_tris_to(w, h) };

  vg_tris_ask(w, p,
              vg_tris_ratio(w, h) < NEARBY
                ? vg_tris_size_near(w, p->x, p->home, 2, end, &p->by)
                : vg_tris_size(w, p->x, &p->by));
}

static uint32_t add_point(struct vg_tris *w, const struct vg_tris_point *p)
{
  if (w->n_point > UINT32_MAX - 2 ||
      vg_reserve(&w->point, &w->cap_point, w->n_point + 1, sizeof *w->point)) {
    w->failed = 1;
    return VG_REF_NONE;
  }
  w->point[w->n_point] = *p;
  return (uint32_t)w->n_point++;
}

/* Split the feature edge of h at arc length s by point m. Returns the part in
 * the first half of h; *second is the other. */
static uint32_t split_line(struct vg_tris *w, uint32_t h, uint32_t m, double s,
                           uint32_t *second)
{
  uint32_t i = w->edge[h] - 1, j = (uint32_t)w->n_line;
  int forward = w->line[i].end[0] == vg_tris_from(w, h);

  if (w->line[i].end[0] == w->line[i].end[1]) forward = 1;
  w->line[w->n_line++] = w->line[i];
  w->line[i].end[1] = w->line[j].end[0] = m;
  w->line[i].at[1] = w->line[j].at[0] = s;
  *second = (forward ? j : i) + 1;
  return (forward ? i : j) + 1;
}

/* Insert m into the edge of h. t[0] and t[1] are the halves of its triangle,
 * t[2] and t[3] those of the opposite one, each in the order along its own
 * half-edge. */
static void stitch(struct vg_tris *w, uint32_t h, uint32_t m, const uint32_t *t,
                   const uint32_t *e)
{
  const uint32_t end[2] = { vg_tris_from(w, h), vg_tris_to(w, h) };
  const uint32_t half[2] = { h, w->mate[h] };

  for (int side = 0; side < 2 && half[side] != VG_REF_NONE; side++) {
    uint32_t k = half[side], t0 = t[2 * side], t1 = t[2 * side + 1];
    uint32_t o = vg_tris_from(w, vg_half_prev(k));
    uint32_t h1 = vg_half_next(k), h2 = vg_half_prev(k);
    uint32_t m1 = w->mate[h1], e1 = w->edge[h1];
    uint32_t m2 = w->mate[h2], e2 = w->edge[h2];

    set_tri(w, t0, end[side], m, o);
    set_tri(w, t1, m, end[!side], o);
    attach(w, 3 * t1 + 1, m1, e1);
    attach(w, 3 * t0 + 2, m2, e2);
    attach(w, 3 * t0 + 1, 3 * t1 + 2, 0);
  }
  if (half[1] == VG_REF_NONE) {
    attach(w, 3 * t[0], VG_REF_NONE, e[0]);
    attach(w, 3 * t[1], VG_REF_NONE, e[1]);
  } else {
    attach(w, 3 * t[0], 3 * t[3], e[0]);
    attach(w, 3 * t[1], 3 * t[2], e[1]);
  }
}

uint32_t vg_tris_split(struct vg_tris *w, uint32_t h, const double *at)
{
  assert(h < 3 * w->n_tri && !vg_tris_removed(w, h / 3));

  struct vg_cavity c;
  uint32_t a = vg_tris_from(w, h), b = vg_tris_to(w, h), m, t[4], e[2];
  struct vg_tris_point p = w->point[a];
  double s = 0;

  if (vg_tris_ends(w) || vg_tris_stays(w, h)) return VG_REF_NONE;
  if (w->budget && w->n_split >= w->budget) {
    w->is_over = w->ends = 1;
    return VG_REF_NONE;
  }
  vg_cavity_begin(w, &c, a);
  vg_cavity_narrow(w, &c, b);
  middle_of(w, h, at, &p, &s);
  p.kind = w->edge[h] ? VG_WORK_CURVE : VG_WORK_FACE;
  p.frozen = p.kept = p.goes = 0;
  p.given = VG_REF_NONE;
  for (int k = 0; vg_tris_is_stretched(w) && k < 6; k++)
    p.asked.form[k] = (p.asked.form[k] + w->point[b].asked.form[k]) / 2;
  c.hint = p.home;
  if (!split_fits(w, h, &p, &c)) return VG_REF_NONE;
  if (w->edge[h] &&
      vg_reserve(&w->line, &w->cap_line, w->n_line + 1, sizeof *w->line))
    w->failed = 1;
  size_between(w, h, &p);
  m = w->failed ? VG_REF_NONE : add_point(w, &p);
  for (size_t i = 0; i < c.n_old; i++) {
    t[2 * i] = c.old[i];
    t[2 * i + 1] = new_tri(w);
  }
  if (w->failed) return VG_REF_NONE;
  e[0] = e[1] = 0;
  if (w->edge[h]) e[0] = split_line(w, h, m, s, &e[1]);
  stitch(w, h, m, t, e);
  vg_cavity_settle(w, &c, t);
  w->n_split++;
  return m;
}

/* --- collapse ------------------------------------------------------------ */

/* The feature edge at curve point v other than that of h. */
static uint32_t other_line(const struct vg_tris *w, const uint32_t *ring,
                           size_t n, uint32_t line)
{
  for (size_t i = 0; i < n; i++) {
    uint32_t in = w->edge[vg_half_prev(ring[i])], out = w->edge[ring[i]];

    if (out && out != line) return out;
    if (in && in != line) return in;
  }
  return 0;
}

/* A point of a curve may only move along the curve, and only if the new chord
 * stays near it. */
static int curve_fits(const struct vg_tris *w, uint32_t h, const uint32_t *ring,
                      size_t n, double tolerance)
{
  const struct vg_tris_line *a, *b;
  uint32_t u = vg_tris_to(w, h), other;

  if (!w->edge[h]) return 0;
  other = other_line(w, ring, n, w->edge[h]);
  if (!other) return 0;
  a = &w->line[w->edge[h] - 1];
  b = &w->line[other - 1];
  if (a->curve != b->curve || b->end[0] == u || b->end[1] == u ||
      a->end[0] == a->end[1] || b->end[0] == b->end[1])
    return 0;
  return vg_curve_chord(w->curves, w->ref, a->curve, fmin(a->at[0], b->at[0]),
                        fmax(a->at[1], b->at[1])) <= tolerance;
}

/* Link condition: the ends of h share only the corners opposite h as
 * neighbours. */
static int link_fits(const struct vg_tris *w, uint32_t h, const uint32_t *ring,
                     size_t n, int open)
{
  uint32_t u = vg_tris_to(w, h), other[VG_WORK_RING];
  size_t n_other, common = 0, wanted = w->mate[h] == VG_REF_NONE ? 1 : 2;
  int other_open;

  n_other = vg_tris_ring(w, u, other, &other_open);
  if (!n_other || n + n_other < 7) return 0;
  for (size_t i = 0; i < n; i++)
    for (int end = 0; end < (open && i + 1 == n ? 2 : 1); end++) {
      uint32_t p = end ? vg_tris_from(w, vg_half_prev(ring[i]))
                       : vg_tris_to(w, ring[i]);
      int found = 0;

      for (size_t k = 0; k < n_other && !found; k++)
        found = vg_tris_to(w, other[k]) == p ||
                (other_open && k + 1 == n_other &&
                 vg_tris_from(w, vg_half_prev(other[k])) == p);
      common += (size_t)found;
    }
  return common == wanted;
}

/* May all new edges from u to neighbours of v be created? */
static int joins_fit(const struct vg_tris *w, uint32_t h, const uint32_t *ring,
                     size_t n, int open)
{
  const uint32_t u = vg_tris_to(w, h), g = w->mate[h];
  const uint32_t o = vg_tris_from(w, vg_half_prev(h));
  const uint32_t q = g == VG_REF_NONE ? u : vg_tris_from(w, vg_half_prev(g));

  if (w->point[u].frozen == VG_WORK_FANS) return 0;
  for (size_t i = 0; i < n; i++)
    for (int end = 0; end < (open && i + 1 == n ? 2 : 1); end++) {
      uint32_t p = end ? vg_tris_from(w, vg_half_prev(ring[i]))
                       : vg_tris_to(w, ring[i]);

      if (p != u && p != o && p != q && !vg_tris_may_join(w, p, u)) return 0;
    }
  return 1;
}

static int collapse_fits(const struct vg_tris *w, uint32_t h,
                         const uint32_t *ring, size_t n, double most,
                         double shape, struct vg_cavity *c)
{
  uint32_t v = vg_tris_from(w, h), u = vg_tris_to(w, h);
  const struct vg_tris_point *pu = &w->point[u];
  double before = 1, longest = most, l;

  c->on_curve = w->point[v].kind == VG_WORK_CURVE;
  for (size_t i = 0; i < n; i++) {
    c->old[c->n_old++] = ring[i] / 3;
    vg_cavity_narrow(w, c, vg_tris_to(w, ring[i]));
    before = fmin(before, vg_tris_tri_shape(w, ring[i] / 3));
    longest = fmax(longest, vg_tris_ratio(w, ring[i]));
  }
  for (size_t i = 0; i < n; i++) {
    uint32_t a = vg_tris_to(w, ring[i]);
    uint32_t b = vg_tris_from(w, vg_half_prev(ring[i]));
    const struct vg_tris_point *pa = &w->point[a], *pb = &w->point[b];

    if (a == u || b == u) continue;
    l = vg_tris_length(w, pu, pa);
    if (l > longest) return 0;
    /* Edge u a is new unless a is next to the collapsed edge; feature edges are
     * checked elsewhere. */
    c->was[c->n_new] = (uint16_t)i;
    vg_cavity_add(c, pu, pa, pb, w->edge[ring[i]] ? 0 : 1);
  }
  if (!c->n_new) return 0;
  vg_cavity_measure(w, c);
  if (!(c->shape >= fmin(before, shape))) return 0;
  c->fresh = w->point[v].given;
  return vg_cavity_fits(w, c);
}

static void collapse(struct vg_tris *w, uint32_t h, const uint32_t *ring,
                     size_t n, const struct vg_cavity *c)
{
  uint32_t u = vg_tris_to(w, h), g = w->mate[h], t[VG_WORK_RING], n_t = 0;
  uint32_t go[2] = { h, g }, keep[VG_WORK_RING], n_keep = 0, v;

  v = vg_tris_from(w, h);
  if (w->point[v].kind == VG_WORK_CURVE) {
    struct vg_tris_line *a = &w->line[w->edge[h] - 1], *b;
    int last = a->end[1] == u;

    b = &w->line[other_line(w, ring, n, w->edge[h]) - 1];
    b->end[last] = u;
    b->at[last] = a->at[last];
    a->end[0] = a->end[1] = u; /* The feature edge is removed. */
    a->at[0] = a->at[1];
  }
  for (size_t i = 0; i < n; i++) {
    uint32_t f = ring[i] / 3;

    if (f == h / 3 || (g != VG_REF_NONE && f == g / 3)) continue;
    keep[n_keep++] = ring[i];
    t[n_t++] = f;
  }
  for (int side = 0; side < 2; side++) {
    uint32_t k = go[side], p, q, edge;

    if (k == VG_REF_NONE) continue;
    p = w->mate[vg_half_next(k)];
    q = w->mate[vg_half_prev(k)];
    edge = w->edge[vg_half_next(k)] ? w->edge[vg_half_next(k)]
                                    : w->edge[vg_half_prev(k)];
    if (p != VG_REF_NONE) attach(w, p, q, edge);
    else attach(w, q, p, edge);
  }
  for (uint32_t i = 0; i < n_keep; i++) w->tri[keep[i] / 3][keep[i] % 3] = u;
  for (uint32_t i = 0; i < n_keep; i++) {
    uint32_t f = keep[i] / 3;

    set_tri(w, f, w->tri[f][0], w->tri[f][1], w->tri[f][2]);
  }
  vg_cavity_settle(w, c, t);
  remove_tri(w, h / 3);
  if (g != VG_REF_NONE) remove_tri(w, g / 3);
  w->point[v].half = VG_REF_NONE;
  w->n_collapse++;
}

int vg_tris_collapse(struct vg_tris *w, uint32_t h, double most, double shape)
{
  assert(h < 3 * w->n_tri && !vg_tris_removed(w, h / 3));

  struct vg_cavity c;
  uint32_t ring[VG_WORK_RING], v = vg_tris_from(w, h), k = h, g = w->mate[h];
  size_t n;
  int open;

  if (vg_tris_ends(w) || w->point[v].kind == VG_WORK_CORNER ||
      w->point[v].frozen || w->point[v].kept)
    return 0;
  n = vg_tris_ring(w, v, ring, &open);
  if (!n) return 0;
  if (w->edge[h] && w->point[v].kind == VG_WORK_FACE) return 0;
  vg_cavity_begin(w, &c, v);
  if (w->point[v].kind == VG_WORK_CURVE &&
      !curve_fits(w, h, ring, n, c.tolerance))
    return 0;
  /* If both other sides of a removed triangle are feature edges, they would
   * become one edge. */
  for (int side = 0; side < 2 && k != VG_REF_NONE; side++, k = g) {
    uint32_t p = vg_half_next(k), q = vg_half_prev(k);

    if (w->edge[p] && w->edge[q]) return 0;
    if ((vg_tris_is_border(w, p) && w->edge[q]) ||
        (vg_tris_is_border(w, q) && w->edge[p]))
      return 0;
    if (w->mate[p] == VG_REF_NONE && w->mate[q] == VG_REF_NONE) return 0;
  }
  if (!joins_fit(w, h, ring, n, open) || !link_fits(w, h, ring, n, open) ||
      !collapse_fits(w, h, ring, n, most, shape, &c))
    return 0;
  collapse(w, h, ring, n, &c);
  return 1;
}

/* --- swap ---------------------------------------------------------------- */

int vg_tris_swap(struct vg_tris *w, uint32_t h)
{
  assert(h < 3 * w->n_tri && !vg_tris_removed(w, h / 3));

  struct vg_cavity c;
  uint32_t g = w->mate[h], ring[VG_WORK_RING], t[2] = { h / 3, g / 3 };
  uint32_t p[4], out[4], m[4], e[4];
  const struct vg_tris_point *x[4];
  double before;
  size_t n;
  int open;

  if (vg_tris_ends(w) || g == VG_REF_NONE || w->edge[h] || vg_tris_stays(w, h))
    return 0;
  p[0] = vg_tris_from(w, h);
  p[1] = vg_tris_to(w, h);
  p[2] = vg_tris_from(w, vg_half_prev(h));
  p[3] = vg_tris_from(w, vg_half_prev(g));
  for (int k = 0; k < 4; k++) x[k] = &w->point[p[k]];
  vg_cavity_begin(w, &c, p[0]);
  for (int k = 1; k < 4; k++) vg_cavity_narrow(w, &c, p[k]);
  c.old[c.n_old++] = h / 3;
  c.old[c.n_old++] = g / 3;
  vg_cavity_add(&c, x[2], x[0], x[3], 4);
  vg_cavity_add(&c, x[3], x[1], x[2], 0);
  before = fmin(vg_tris_shape(w, x[0], x[1], x[2]),
                vg_tris_shape(w, x[0], x[1], x[3]));
  vg_cavity_measure(w, &c);
  if (!(c.shape > GAIN * before) || p[2] == p[3] ||
      !vg_tris_may_join(w, p[2], p[3]))
    return 0;
  n = vg_tris_ring(w, p[2], ring, &open);
  if (!n || n + 1 >= VG_WORK_RING) return 0;
  for (size_t i = 0; i < n; i++)
    if (vg_tris_to(w, ring[i]) == p[3] ||
        vg_tris_from(w, vg_half_prev(ring[i])) == p[3])
      return 0;
  n = vg_tris_ring(w, p[3], ring, &open);
  if (!n || n + 1 >= VG_WORK_RING || !vg_cavity_fits(w, &c)) return 0;
  out[0] = vg_half_next(h); /* 1 2 */
  out[1] = vg_half_prev(h); /* 2 0 */
  out[2] = vg_half_next(g); /* 0 3 */
  out[3] = vg_half_prev(g); /* 3 1 */
  for (int k = 0; k < 4; k++) m[k] = w->mate[out[k]], e[k] = w->edge[out[k]];
  set_tri(w, t[0], p[2], p[0], p[3]);
  set_tri(w, t[1], p[3], p[1], p[2]);
  attach(w, 3 * t[0], m[1], e[1]);
  attach(w, 3 * t[0] + 1, m[2], e[2]);
  attach(w, 3 * t[1], m[3], e[3]);
  attach(w, 3 * t[1] + 1, m[0], e[0]);
  attach(w, 3 * t[0] + 2, 3 * t[1] + 2, 0);
  vg_cavity_settle(w, &c, t);
  w->n_swap++;
  return 1;
}

/* --- move ---------------------------------------------------------------- */

/* Replace p by q, and update the clocks, sizes and samples around it. */
static void settle_move(struct vg_tris *w, uint32_t p, const uint32_t *ring,
                        const struct vg_cavity *c, struct vg_tris_point *q)
{
  uint32_t near[VG_WORK_RING + 2];
  size_t n = 0;

  for (size_t i = 0; i < c->n_old; i++) near[n++] = vg_tris_to(w, ring[i]);
  if (w->mate[ring[0]] == VG_REF_NONE)
    near[n++] = vg_tris_from(w, vg_half_prev(ring[c->n_old - 1]));
  near[n++] = p;
  q->given = VG_REF_NONE;
  vg_tris_ask(w, q, vg_tris_size_near(w, q->x, q->home, n, near, &q->by));
  w->point[p] = *q;
  for (size_t i = 0; i < n; i++) w->point[near[i]].changed = ++w->clock;
  for (size_t i = 0; i < c->n_old; i++) w->stamp[c->old[i]] = w->clock;
  vg_cavity_settle(w, c, c->old);
  w->n_move++;
}

/* The triangles around p after it is replaced by q. Returns the least shape
 * that they have now. */
static double move_cavity(const struct vg_tris *w, uint32_t p, size_t n,
                          const uint32_t *ring, const struct vg_tris_point *q,
                          struct vg_cavity *c)
{
  double before = 1;

  vg_cavity_begin(w, c, p);
  for (size_t i = 0; i < n; i++) {
    c->was[i] = (uint16_t)i;
    c->old[c->n_old++] = ring[i] / 3;
    vg_cavity_narrow(w, c, vg_tris_to(w, ring[i]));
    before = fmin(before, vg_tris_tri_shape(w, ring[i] / 3));
    vg_cavity_add(c, q, &w->point[vg_tris_to(w, ring[i])],
                  &w->point[vg_tris_from(w, vg_half_prev(ring[i]))],
                  w->edge[ring[i]] ? 0 : 1);
  }
  c->fresh = w->point[p].given;
  return before;
}

int vg_tris_move(struct vg_tris *w, uint32_t p, const double x[3], double shape)
{
  assert(p < w->n_point);

  struct vg_cavity c;
  struct vg_tris_point q = w->point[p];
  uint32_t ring[VG_WORK_RING];
  double n[3] = { 0, 0, 0 }, before;
  size_t n_ring;
  int open;

  if (vg_tris_ends(w) || w->point[p].kind != VG_WORK_FACE ||
      w->point[p].frozen || w->point[p].kept)
    return 0;
  n_ring = vg_tris_ring(w, p, ring, &open);
  if (!n_ring) return 0;
  for (size_t i = 0; i < n_ring; i++) normal_of(w, ring[i] / 3, n);
  if (!(vg_unit(n) > 0)) return 0;
  memcpy(q.x, x, sizeof q.x);
  before = fmin(shape, move_cavity(w, p, n_ring, ring, &q, &c));
  vg_cavity_measure(w, &c); /* approximately and cheaply first, then exactly */
  if (!(c.shape > ALMOST * before) ||
      !(vg_ref_project(w->ref, x, n, &q.home, q.x) <=
        STRAY * vg_tris_largest(w, &q)))
    return 0;
  c.hint = q.home;
  vg_cavity_measure(w, &c);
  if (!(c.shape > before) || !vg_cavity_fits(w, &c)) return 0;
  settle_move(w, p, ring, &c, &q);
  return 1;
}

/* --- slide --------------------------------------------------------------- */

/* The feature edges that end and begin at p along their curve. */
static int lines_at(const struct vg_tris *w, uint32_t p, size_t n,
                    const uint32_t *ring, uint32_t line[2])
{
  const struct vg_tris_line *a, *b;
  uint32_t first = other_line(w, ring, n, 0), second;

  second = first ? other_line(w, ring, n, first) : 0;
  if (!second) return 0;
  a = &w->line[first - 1];
  line[a->end[0] == p] = first - 1;
  line[a->end[0] != p] = second - 1;
  a = &w->line[line[0]];
  b = &w->line[line[1]];
  return a->curve == b->curve && a->end[1] == p && b->end[0] == p &&
         a->end[0] != p && b->end[1] != p && a->at[1] == b->at[0];
}

int vg_tris_span(const struct vg_tris *w, uint32_t p, struct vg_tris_span *s)
{
  uint32_t ring[VG_WORK_RING];
  size_t n;
  int open;

  assert(p < w->n_point && s);
  if (w->point[p].kind != VG_WORK_CURVE || w->point[p].frozen ||
      w->point[p].kept)
    return 0;
  n = vg_tris_ring(w, p, ring, &open);
  if (!n || !lines_at(w, p, n, ring, s->line)) return 0;
  s->curve = w->line[s->line[0]].curve;
  s->lo = w->line[s->line[0]].at[0];
  s->at = w->line[s->line[0]].at[1];
  s->hi = w->line[s->line[1]].at[1];
  return 1;
}

int vg_tris_slide(struct vg_tris *w, uint32_t p, double at, double shape)
{
  assert(p < w->n_point);

  struct vg_tris_point q = w->point[p];
  struct vg_tris_span s;
  struct vg_cavity c;
  uint32_t ring[VG_WORK_RING];
  double before, foot[3];
  size_t n;
  int open;

  if (!vg_tris_span(w, p, &s) || !(at > s.lo && at < s.hi)) return 0;
  n = vg_tris_ring(w, p, ring, &open);
  vg_curve_at(w->curves, w->ref, s.curve, at, q.x);
  before = fmin(shape, move_cavity(w, p, n, ring, &q, &c));
  if (open) vg_cavity_narrow(w, &c, vg_tris_from(w, vg_half_prev(ring[n - 1])));
  c.on_curve = 1;
  vg_cavity_measure(w, &c);
  if (!(c.shape > before) ||
      !(vg_curve_chord(w->curves, w->ref, s.curve, s.lo, at) <= c.tolerance) ||
      !(vg_curve_chord(w->curves, w->ref, s.curve, at, s.hi) <= c.tolerance) ||
      !vg_cavity_fits(w, &c))
    return 0;
  vg_ref_nearest(w->ref, q.x, NULL, &q.home, foot);
  settle_move(w, p, ring, &c, &q);
  w->line[s.line[0]].at[1] = w->line[s.line[1]].at[0] = at;
  return 1;
}
