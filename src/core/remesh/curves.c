/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: edges become feature edges by the angle between their faces. Loose
 * ends are extended along edges that are not quite as sharp. Short isolated
 * curves that a displacement by the tolerance could produce are dropped. Points
 * with a number of feature edges other than two, or at which the curve turns
 * sharply, become feature corners, and the chains between them feature
 * curves. */
#include "core/remesh/curves.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/graded.h"
#include "core/geometry/vector.h"

#define LEAD 0.6   /* S24: of the angle: extension of a feature curve */
#define TURN 50.0  /* degrees: larger turns are feature corners */
#define JAG 8.0    /* tolerances along a curve: base of measured turns */
#define THIN 8     /* S32: triangles lower than the tolerance to skip */
#define SPECK 20.0 /* tolerances: shorter isolated curves are dropped */

struct finder {
  struct vg_curves *c;
  const struct vg_ref *r;
  const struct vg_curves_options *o;
  uint32_t *start, *half; /* Undirected edges at each point, one half-edge for
                             each. */
  uint8_t *degree;        /* Feature edges at each point, at most 255. */
  double sharp, lead;     /* Cosines of the feature angle and of its LEAD
                             part. */
};

double vg_cosine(double degrees)
{
  double s, c;

  assert(degrees >= 0 && degrees <= 180);
  if (degrees > 90) return -vg_cosine(180 - degrees);
  vg_quarter_turn(degrees / 90, &s, &c);
  return c;
}

/* --- edges --------------------------------------------------------------- */

/* Height of the triangle of h above its longest edge. */
static double height(const struct vg_ref *r, uint32_t h)
{
  const struct vg_ref_tri *t = &r->shape[h / 3];
  double n[3], w[3], longest2;

  vg_cross(t->u, t->v, n);
  vg_sub(t->v, t->u, w);
  longest2 = fmax(vg_dot(w, w), fmax(t->uu, t->vv));
  return longest2 > 0 ? vg_norm(n) / sqrt(longest2) : 0;
}

static double length2(const struct vg_ref *r, uint32_t h)
{
  return vg_distance2(r->point[vg_ref_from(r, h)], r->point[vg_ref_to(r, h)]);
}

/* The first triangle on the side of h that defines the direction of the surface
 * there. Triangles whose heights add up to less than the tolerance are skipped:
 * points that are off by the tolerance turn such triangles arbitrarily. */
static uint32_t adjacent_face(const struct finder *f, uint32_t h)
{
  const struct vg_ref *r = f->r;
  double room = f->o->tolerance;

  for (int i = 0; i < THIN; i++) {
    uint32_t a = vg_half_next(h), b = vg_half_next(a);

    room -= height(r, h);
    if (length2(r, b) > length2(r, a)) a = b;
    if (!(room > 0) || length2(r, h) < length2(r, a) / 4 ||
        r->mate[a] == VG_REF_NONE)
      break;
    h = r->mate[a];
  }
  return h / 3;
}

/* Cosine of the angle between the faces on both sides of h; 1 if one of them is
 * too flat to have a normal. */
static double cosine(const struct finder *f, uint32_t h)
{
  const struct vg_ref *r = f->r;
  const double *a = r->shape[h / 3].n, *b = r->shape[r->mate[h] / 3].n;
  double c;

  if (vg_dot(a, a) == 0 || vg_dot(b, b) == 0) return 1;
  c = vg_dot(a, b);
  if (c > f->lead) return c;
  a = r->shape[adjacent_face(f, h)].n;
  b = r->shape[adjacent_face(f, r->mate[h])].n;
  if (vg_dot(a, a) == 0 || vg_dot(b, b) == 0) return 1;
  return fmax(c, vg_dot(a, b));
}

int vg_curves_is_hard(const struct vg_curves_options *o, const struct vg_ref *r,
                      uint32_t h)
{
  uint32_t p, q;

  if (r->mate[h] == VG_REF_NONE ||
      (o->stretch && (o->stretch[h] > 1 || o->stretch[h] < 0)))
    return 1;
  p = o->tri_patch[h / 3];
  q = o->tri_patch[r->mate[h] / 3];
  if (p == q) return 0;
  if (o->hard && (o->hard[p] || o->hard[q])) return 1;
  return o->patch[p].bc != o->patch[q].bc ||
         o->patch[p].bc_fun3d != o->patch[q].bc_fun3d;
}

static int is_kept(const struct vg_curves_options *o, const struct vg_ref *r,
                   uint32_t h)
{
  const uint32_t p = o->tri_patch[h / 3], q = o->tri_patch[r->mate[h] / 3];

  return o->kept && p != q && o->kept[p] && o->kept[q];
}

static void set_line(struct finder *f, uint32_t h, int on)
{
  uint32_t ends[2] = { vg_ref_from(f->r, h), vg_ref_to(f->r, h) };
  uint32_t m = f->r->mate[h];

  f->c->line[h] = (uint32_t)on;
  if (m != VG_REF_NONE) f->c->line[m] = (uint32_t)on;
  for (int k = 0; k < 2; k++) {
    uint8_t *d = &f->degree[ends[k]];

    if (on && *d < 255) ++*d;
    if (!on && *d) --*d;
  }
}

static int is_closed(const struct finder *f, uint32_t h)
{
  return f->o->closed && f->o->closed[h];
}

static void find_lines(struct finder *f)
{
  for (uint32_t h = 0; h < 3 * f->r->n_tri; h++) {
    uint32_t m = f->r->mate[h];

    if (m != VG_REF_NONE && m < h) continue;
    if (vg_curves_is_hard(f->o, f->r, h) ||
        (!is_closed(f, h) &&
         (cosine(f, h) < f->sharp || is_kept(f->o, f->r, h))))
      set_line(f, h, 1);
  }
}

static vg_status list_halves(struct finder *f, struct vg_error *err)
{
  const struct vg_ref *r = f->r;

  f->start = vg_calloc(r->n_point + 2, sizeof *f->start);
  f->half = vg_alloc(6 * r->n_tri, sizeof *f->half);
  f->degree = vg_calloc(r->n_point, 1);
  if (!f->start || !f->half || !f->degree)
    return vg_fail_memory(err, "the feature curves of the surface");
  /* One half-edge of each edge, listed at both ends. */
  for (int pass = 0; pass < 2; pass++) {
    for (uint32_t h = 0; h < 3 * r->n_tri; h++) {
      if (r->mate[h] != VG_REF_NONE && r->mate[h] < h) continue;
      for (int k = 0; k < 2; k++) {
        uint32_t p = k ? vg_ref_to(r, h) : vg_ref_from(r, h);

        if (!pass) f->start[p + 2]++;
        else f->half[f->start[p + 1]++] = h;
      }
    }
    if (!pass)
      for (size_t p = 1; p < r->n_point + 2; p++)
        f->start[p] += f->start[p - 1];
  }
  return VG_OK;
}

static uint32_t other_end(const struct vg_ref *r, uint32_t h, uint32_t p)
{
  return vg_ref_from(r, h) == p ? vg_ref_to(r, h) : vg_ref_from(r, h);
}

/* The feature edge at p other than h; VG_REF_NONE unless there is exactly
 * one. */
static uint32_t line_on(const struct finder *f, uint32_t p, uint32_t h)
{
  if (f->degree[p] != 2) return VG_REF_NONE;
  for (uint32_t k = f->start[p]; k < f->start[p + 1]; k++)
    if (f->half[k] != h && f->c->line[f->half[k]]) return f->half[k];
  return VG_REF_NONE;
}

static double straight(const struct vg_ref *r, uint32_t a, uint32_t b,
                       uint32_t c)
{
  double u[3], v[3];

  vg_sub(r->point[b], r->point[a], u);
  vg_sub(r->point[c], r->point[b], v);
  vg_unit(u);
  vg_unit(v);
  return vg_dot(u, v);
}

/* Extend the feature curve with the loose end p along the straightest edges
 * that are sharp enough, until it meets another one or no such edge is left. */
static void extend_curve(struct finder *f, uint32_t p)
{
  const double turn = vg_cosine(TURN);
  uint32_t last = VG_REF_NONE;

  for (uint32_t k = f->start[p]; k < f->start[p + 1]; k++)
    if (f->c->line[f->half[k]]) last = f->half[k];
  while (last != VG_REF_NONE && f->degree[p] == 1) {
    uint32_t before = other_end(f->r, last, p), best = VG_REF_NONE;
    double most = turn;

    for (uint32_t k = f->start[p]; k < f->start[p + 1]; k++) {
      uint32_t h = f->half[k];
      double s;

      if (is_closed(f, h)) return;
      if (f->c->line[h] || f->r->mate[h] == VG_REF_NONE ||
          cosine(f, h) > f->lead)
        continue;
      s = straight(f->r, before, p, other_end(f->r, h, p));
      if (s > most) most = s, best = h;
    }
    if (best == VG_REF_NONE) return;
    set_line(f, best, 1);
    p = other_end(f->r, best, p);
    last = best;
  }
}

/* Drop the curve with the loose end p if it is short and its other end is
 * loose, too. */
static void drop_speck(struct finder *f, uint32_t p)
{
  uint32_t list[64], h = VG_REF_NONE;
  double sum = 0, most = SPECK * f->o->tolerance;
  size_t n = 0;

  for (uint32_t k = f->start[p]; k < f->start[p + 1]; k++)
    if (f->c->line[f->half[k]]) h = f->half[k];
  while (h != VG_REF_NONE && n < 64) {
    uint32_t q = other_end(f->r, h, p);

    if (f->o->stretch && f->o->stretch[h] < 0) return;
    list[n++] = h;
    sum += vg_distance(f->r->point[p], f->r->point[q]);
    if (sum > most) return;
    p = q;
    h = line_on(f, q, h);
  }
  if (f->degree[p] != 1) return;
  for (size_t i = 0; i < n; i++) set_line(f, list[i], 0);
}

/* --- feature corners and curves ------------------------------------------- */

/* The first point at least `reach` along the curve that leaves p by h, or the
 * last point before the curve ends or branches. */
static uint32_t along(const struct finder *f, uint32_t p, uint32_t h,
                      double reach)
{
  double sum = 0;

  for (int i = 0; i < 64; i++) {
    uint32_t q = other_end(f->r, h, p);

    sum += vg_distance(f->r->point[p], f->r->point[q]);
    p = q;
    if (sum >= reach) break;
    h = line_on(f, q, h);
    if (h == VG_REF_NONE) break;
  }
  return p;
}

static int turns(const struct finder *f, uint32_t p)
{
  double reach = JAG * f->o->tolerance;
  uint32_t h = VG_REF_NONE, g;

  for (uint32_t k = f->start[p]; k < f->start[p + 1]; k++)
    if (f->c->line[f->half[k]]) h = f->half[k];
  g = line_on(f, p, h);
  return straight(f->r, along(f, p, h, reach), p, along(f, p, g, reach)) <
         vg_cosine(TURN);
}

static vg_status add_point(struct vg_curves *c, const struct vg_ref *r,
                           uint32_t p, struct vg_error *err)
{
  struct vg_feature_curve *k = &c->curve[c->n_curve - 1];
  double s = 0;

  if (vg_reserve(&c->point, &c->cap_point, c->n_point + 1, sizeof *c->point) ||
      vg_reserve(&c->at, &c->cap_at, c->n_point + 1, sizeof *c->at))
    return vg_fail_memory(err, "the feature curves of the surface");
  if (k->n)
    s = c->at[c->n_point - 1] +
        vg_distance(r->point[c->point[c->n_point - 1]], r->point[p]);
  c->point[c->n_point] = p;
  c->at[c->n_point++] = s;
  k->n++;
  return VG_OK;
}

/* Trace a curve from corner p along h to the next corner. */
static vg_status trace(struct finder *f, uint32_t p, uint32_t h, uint8_t *seen,
                       struct vg_error *err)
{
  struct vg_curves *c = f->c;
  vg_status st;

  if (vg_reserve(&c->curve, &c->cap_curve, c->n_curve + 1, sizeof *c->curve))
    return vg_fail_memory(err, "the feature curves of the surface");
  c->curve[c->n_curve++] = (struct vg_feature_curve){ c->n_point, 0 };
  VG_TRY(add_point(c, f->r, p, err));
  for (;;) {
    seen[h] = 1;
    p = other_end(f->r, h, p);
    VG_TRY(add_point(c, f->r, p, err));
    c->line[h] = (uint32_t)(c->n_point - c->n_curve);
    if (f->r->mate[h] != VG_REF_NONE) c->line[f->r->mate[h]] = c->line[h];
    if (c->corner[p]) break;
    h = line_on(f, p, h);
  }
  c->length += c->at[c->n_point - 1];
done:
  return st;
}

static vg_status trace_all(struct finder *f, struct vg_error *err)
{
  const struct vg_ref *r = f->r;
  uint8_t *seen = vg_calloc(3 * r->n_tri, 1);
  vg_status st = VG_OK;

  if (!seen) return vg_fail_memory(err, "the feature curves of the surface");
  /* A closed curve without a corner starts at its first point, which becomes a
   * corner. */
  for (int round = 0; round < 2; round++)
    for (uint32_t p = 0; p < r->n_point; p++) {
      if (round ? f->degree[p] != 2 || f->c->corner[p] : !f->c->corner[p])
        continue;
      for (uint32_t k = f->start[p]; k < f->start[p + 1]; k++) {
        uint32_t h = f->half[k];

        if (!f->c->line[h] || seen[h]) continue;
        f->c->corner[p] = 1;
        VG_TRY(trace(f, p, h, seen, err));
      }
    }
done:
  free(seen);
  return st;
}

static void find_corners(struct finder *f)
{
  for (uint32_t p = 0; p < f->r->n_point; p++) {
    const int is_given = p < f->o->n_still && f->o->still[p];

    if (!f->degree[p]) continue;
    f->c->corner[p] = f->degree[p] != 2 || is_given || turns(f, p);
    f->c->n_corner += f->c->corner[p];
  }
}

vg_status vg_curves_find(struct vg_curves *c, const struct vg_ref *r,
                         const struct vg_curves_options *o,
                         struct vg_error *err)
{
  assert(!c->line && !c->corner);

  struct finder f = { .c = c,
                      .r = r,
                      .o = o,
                      .sharp = vg_cosine(o->angle),
                      .lead = vg_cosine(LEAD * o->angle) };
  vg_status st = VG_OK;

  c->closed = o->closed;
  c->line = vg_calloc(3 * r->n_tri, sizeof *c->line);
  c->corner = vg_calloc(r->n_point, 1);
  if (!c->line || !c->corner)
    VG_TRY(vg_fail_memory(err, "the feature curves of the surface"));
  VG_TRY(list_halves(&f, err));
  find_lines(&f);
  for (uint32_t p = 0; p < r->n_point; p++)
    if (f.degree[p] == 1) extend_curve(&f, p);
  for (uint32_t p = 0; p < r->n_point; p++)
    if (f.degree[p] == 1) drop_speck(&f, p);
  find_corners(&f);
  VG_TRY(trace_all(&f, err));
done:
  free(f.start);
  free(f.half);
  free(f.degree);
  if (st < 0) vg_curves_release(c);
  return st;
}

void vg_curves_release(struct vg_curves *c)
{
  free(c->line);
  free(c->corner);
  free(c->curve);
  free(c->point);
  free(c->at);
  memset(c, 0, sizeof *c);
}

/* --- points on a curve ---------------------------------------------------- */

size_t vg_curve_of(const struct vg_curves *c, uint32_t number)
{
  assert(number > 0 && number <= c->n_point);

  size_t lo = 0, hi = c->n_curve;

  while (hi - lo > 1) {
    size_t mid = (lo + hi) / 2;

    if (c->curve[mid].first - mid < number) lo = mid;
    else hi = mid;
  }
  return lo;
}

double vg_curve_length(const struct vg_curves *c, size_t i)
{
  assert(i < c->n_curve);
  return c->at[c->curve[i].first + c->curve[i].n - 1];
}

/* The last point of the curve at or before s, excluding its end point. */
static size_t before(const struct vg_curves *c, size_t i, double s)
{
  size_t lo = c->curve[i].first, hi = lo + c->curve[i].n - 1;

  while (hi - lo > 1) {
    size_t mid = (lo + hi) / 2;

    if (c->at[mid] <= s) lo = mid;
    else hi = mid;
  }
  return lo;
}

void vg_curve_at(const struct vg_curves *c, const struct vg_ref *r, size_t i,
                 double s, double x[3])
{
  assert(i < c->n_curve);

  size_t k = before(c, i, s);
  const double *a = r->point[c->point[k]], *b = r->point[c->point[k + 1]];
  double t = (s - c->at[k]) / (c->at[k + 1] - c->at[k]);

  for (int d = 0; d < 3; d++) x[d] = a[d] + t * (b[d] - a[d]);
  if (t <= 0) memcpy(x, a, 3 * sizeof *x);
  if (t >= 1) memcpy(x, b, 3 * sizeof *x);
}

double vg_curve_chord(const struct vg_curves *c, const struct vg_ref *r,
                      size_t i, double s0, double s1)
{
  double a[3], b[3], u[3], uu, most = 0;

  assert(i < c->n_curve && s0 < s1);
  vg_curve_at(c, r, i, s0, a);
  vg_curve_at(c, r, i, s1, b);
  vg_sub(b, a, u);
  uu = vg_dot(u, u);
  for (size_t k = before(c, i, s0) + 1;
       c->at[k] < s1 && k < c->curve[i].first + c->curve[i].n; k++) {
    double d[3], t;

    vg_sub(r->point[c->point[k]], a, d);
    t = uu > 0 ? vg_dot(d, u) / uu : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int j = 0; j < 3; j++) d[j] -= t * u[j];
    most = fmax(most, vg_dot(d, d));
  }
  return sqrt(most);
}
