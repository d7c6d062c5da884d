/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Continuation of the predicates in predicates.h for the calls that their
 * filter cannot decide, in steps:
 *   0. For spheres: the formula of the filter in long double with a 64-bit
 *      mantissa, where the target has it. Points on a round surface differ from
 *      a sphere by the rounding of their coordinates, which this resolves.
 *   1. Double-double arithmetic on the (exact) coordinate differences, with an
 *      error bound of about 1e-30 times the permanent. A determinant below that
 *      bound is nearly always exactly zero.
 *   2. Expansions: sums of doubles that do not overlap, sorted by increasing
 *      magnitude, without zeros; the empty expansion is 0. The sign of the last
 *      component is the sign of the whole. */
#include "core/geometry/predicates.h"

#include <assert.h>
#include <float.h>
#include <string.h>

#define U 1.1102230246251565e-16 /* 2^-53, half an ulp of 1 */

/* Exact sum, difference and product: x + y equals the result, |y| <= ulp/2.
 * (Knuth, Dekker, Veltkamp; products without fma so that every target takes
 * the same path.) */
static inline void two_sum(double a, double b, double *x, double *y)
{
  double s = a + b, v = s - a;

  *y = (a - (s - v)) + (b - v);
  *x = s;
}

static inline void fast_two_sum(double a, double b, double *x, double *y)
{
  double s = a + b;

  *y = b - (s - a);
  *x = s;
}

static inline void split(double a, double *hi, double *lo)
{
  double c = 134217729.0 * a; /* 2^27 + 1 */

  *hi = c - (c - a);
  *lo = a - *hi;
}

static inline void two_product(double a, double b, double *x, double *y)
{
  double p = a * b, ah, al, bh, bl;

  split(a, &ah, &al);
  split(b, &bh, &bl);
  *y = al * bl - (((p - ah * bh) - al * bh) - ah * bl);
  *x = p;
}

/* Double-double arithmetic. Error per operation: below 4 u^2 relative to the
 * sum of the magnitudes of the operands (add, sub), below 8 u^2 relative to
 * the product. */
struct dd {
  double hi, lo;
};

static inline struct dd dd_diff(double a, double b)
{
  struct dd r;

  two_sum(a, -b, &r.hi, &r.lo);
  return r;
}

static inline struct dd dd_add(struct dd a, struct dd b)
{
  struct dd r;
  double s, t;

  two_sum(a.hi, b.hi, &s, &t);
  fast_two_sum(s, t + (a.lo + b.lo), &r.hi, &r.lo);
  return r;
}

static inline struct dd dd_sub(struct dd a, struct dd b)
{
  struct dd n = { -b.hi, -b.lo };

  return dd_add(a, n);
}

static inline struct dd dd_mul(struct dd a, struct dd b)
{
  struct dd r;
  double p, t;

  two_product(a.hi, b.hi, &p, &t);
  fast_two_sum(p, t + (a.hi * b.lo + a.lo * b.hi), &r.hi, &r.lo);
  return r;
}

/* a * b - c * d */
static inline struct dd dd_minor(struct dd a, struct dd b, struct dd c,
                                 struct dd d)
{
  return dd_sub(dd_mul(a, b), dd_mul(c, d));
}

/* Does the next component of the merged expansions e and f come from e? */
static inline int from_e(int i, int m, const double *e, int j, int n,
                         const double *f)
{
  return j >= n || (i < m && fabs(e[i]) < fabs(f[j]));
}

/* h = e + f. Returns the length of h, at most m + n. h must not overlap e or
 * f. The first component starts the sum instead of being added to 0, and its
 * error term is not examined. The bound on the length therefore holds even if
 * products overflowed and components are infinite or NaN. */
static int ex_sum(int m, const double *e, int n, const double *f, double *h)
{
  int i = 0, j = 0, k = 0;
  double q, r;

  if (m + n == 0) return 0;
  q = from_e(i, m, e, j, n, f) ? e[i++] : f[j++];
  while (i < m || j < n) {
    double g = from_e(i, m, e, j, n, f) ? e[i++] : f[j++];

    two_sum(q, g, &q, &r);
    if (r != 0) h[k++] = r;
  }
  if (q != 0) h[k++] = q;
  return k;
}

/* h = b e. Returns the length of h, at most 2 m. */
static int ex_scale(int m, const double *e, double b, double *h)
{
  int k = 0;
  double q, t, s, r;

  if (!m || b == 0) return 0;
  two_product(e[0], b, &q, &r);
  if (r != 0) h[k++] = r;
  for (int i = 1; i < m; i++) {
    double p;

    two_product(e[i], b, &p, &t);
    two_sum(q, t, &s, &r);
    if (r != 0) h[k++] = r;
    fast_two_sum(p, s, &q, &r);
    if (r != 0) h[k++] = r;
  }
  if (q != 0) h[k++] = q;
  return k;
}

/* h = a - b, at most two components. */
static int ex_diff(double a, double b, double *h)
{
  double x, y;
  int k = 0;

  two_sum(a, -b, &x, &y);
  if (y != 0) h[k++] = y;
  if (x != 0) h[k++] = x;
  return k;
}

/* h = e f, where f has at most two components and e at most 16: up to 64. */
static int ex_mul(int m, const double *e, int n, const double *f, double *h)
{
  double t[2][32];
  int k[2] = { 0, 0 };

  for (int i = 0; i < n; i++) k[i] = ex_scale(m, e, f[i], t[i]);
  return ex_sum(k[0], t[0], k[1], t[1], h);
}

static double ex_sign(int m, const double *e)
{
  return m ? e[m - 1] : 0;
}

/* Coordinate differences to one point, as expansions. */
struct vec {
  double e[3][2];
  int n[3];
};

static struct vec vec_diff(const double *a, const double *b, int dim)
{
  struct vec v;

  memset(&v, 0, sizeof v);
  for (int k = 0; k < dim; k++) v.n[k] = ex_diff(a[k], b[k], v.e[k]);
  return v;
}

static int vec_is_short(const struct vec *v)
{
  return v->n[0] < 2 && v->n[1] < 2 && v->n[2] < 2;
}

/* h[16] = p_i q_j - p_j q_i */
static int vec_minor(const struct vec *p, const struct vec *q, int i, int j,
                     double *h)
{
  double s[8], t[8];
  int m = ex_mul(p->n[i], p->e[i], q->n[j], q->e[j], s);
  int n = ex_mul(p->n[j], p->e[j], q->n[i], q->e[i], t);

  for (int k = 0; k < n; k++) t[k] = -t[k];
  return ex_sum(m, s, n, t, h);
}

static double orient3d_expansion(const double *a, const double *b,
                                 const double *c, const double *d)
{
  struct vec p = vec_diff(b, a, 3), q = vec_diff(c, a, 3);
  struct vec r = vec_diff(d, a, 3);
  double minor[16], term[3][64], s[128], h[192];
  int n[3], m;

  for (int k = 0; k < 3; k++) {
    m = vec_minor(&p, &q, (k + 1) % 3, (k + 2) % 3, minor);
    n[k] = ex_mul(m, minor, r.n[k], r.e[k], term[k]);
  }
  m = ex_sum(n[0], term[0], n[1], term[1], s);
  m = ex_sum(m, s, n[2], term[2], h);
  return ex_sign(m, h);
}

/* Are all coordinates of a point finite? For assertions. */
#define FINITE3(x) (isfinite((x)[0]) && isfinite((x)[1]) && isfinite((x)[2]))
#define FINITE2(x) (isfinite((x)[0]) && isfinite((x)[1]))

double vg_orient3d_exact(const double a[3], const double b[3],
                         const double c[3], const double d[3])
{
  struct dd p[3], q[3], r[3], det = { 0, 0 };
  double per = 0;

  assert(FINITE3(a) && FINITE3(b) && FINITE3(c) && FINITE3(d));
  for (int k = 0; k < 3; k++) {
    if (a[k] == b[k] && a[k] == c[k] && a[k] == d[k])
      return 0; /* A plane normal to an axis is common. */
    p[k] = dd_diff(b[k], a[k]);
    q[k] = dd_diff(c[k], a[k]);
    r[k] = dd_diff(d[k], a[k]);
  }
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;

    det = dd_add(det, dd_mul(r[k], dd_minor(p[i], q[j], p[j], q[i])));
    per += fabs(r[k].hi) * (fabs(p[i].hi * q[j].hi) + fabs(p[j].hi * q[i].hi));
  }
  if (per == 0) return 0;
  /* To first order 8 + 4 + 8 + 3 * 4 = 32 u^2 per; doubled for safety. */
  if (fabs(det.hi) > (64 * U * U) * per) return det.hi;
  return orient3d_expansion(a, b, c, d);
}

/* h[24] = determinant of the rows p, q, r of plain doubles. */
static int det3(const double *p, const double *q, const double *r, double *h)
{
  double minor[4], s[2], t[2], term[3][8], sum[16];
  int n[3], m;

  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3, ns, nt;

    ns = ex_scale(1, &p[i], q[j], s);
    nt = ex_scale(1, &p[j], -q[i], t);
    m = ex_sum(ns, s, nt, t, minor);
    n[k] = ex_scale(m, minor, r[k], term[k]);
  }
  m = ex_sum(n[0], term[0], n[1], term[1], sum);
  return ex_sum(m, sum, n[2], term[2], h);
}

/* h[12 m] = e (x^2 + y^2 + z^2), m <= 96. */
static int ex_lift(int m, const double *e, const double *p, double *h)
{
  double s[192], t[3][384], u[768];
  int n[3];

  for (int k = 0; k < 3; k++)
    n[k] = ex_scale(ex_scale(m, e, p[k], s), s, p[k], t[k]);
  m = ex_sum(n[0], t[0], n[1], t[1], u);
  return ex_sum(m, u, n[2], t[2], h);
}

/* The lifted 4x4 determinant for differences p[] that are exact doubles,
 * expanded along the lifts. */
static double insphere_short(double p[4][3])
{
  double minor[24], term[288], sum[2][1152];
  int n = 0, now = 0;

  for (int i = 0; i < 4; i++) {
    const double *r[3];
    int m, at = 0;

    for (int j = 0; j < 4; j++)
      if (j != i) r[at++] = p[j];
    m = det3(r[0], r[1], r[2], minor);
    m = ex_lift(m, minor, p[i], term);
    if (i & 1)
      for (int k = 0; k < m; k++) term[k] = -term[k];
    n = ex_sum(n, sum[now], m, term, sum[!now]);
    now = !now;
  }
  return ex_sign(n, sum[now]);
}

/* h[96] = determinant of the rows (x y z 1) of four points. */
static int det4(const double *const p[4], double *h)
{
  double sum[2][96], term[24];
  int n = 0, now = 0;

  for (int i = 0; i < 4; i++) {
    const double *r[3];
    int m, at = 0;

    for (int j = 0; j < 4; j++)
      if (j != i) r[at++] = p[j];
    m = det3(r[0], r[1], r[2], term);
    if (!(i & 1))
      for (int k = 0; k < m; k++) term[k] = -term[k];
    n = ex_sum(n, sum[now], m, term, sum[!now]);
    now = !now;
  }
  memcpy(h, sum[now], (size_t)n * sizeof *h);
  return n;
}

/* As insphere_short, for arbitrary points: a 5x5 determinant of the
 * coordinates themselves, since products of two-component differences would be
 * longer. */
static double insphere_long(const double *const p[5])
{
  double minor[96], term[1152], sum[2][5760];
  int n = 0, now = 0;

  for (int i = 0; i < 5; i++) {
    const double *r[4];
    int m, at = 0;

    for (int j = 0; j < 5; j++)
      if (j != i) r[at++] = p[j];
    m = det4(r, minor);
    m = ex_lift(m, minor, p[i], term);
    if (i & 1)
      for (int k = 0; k < m; k++) term[k] = -term[k];
    n = ex_sum(n, sum[now], m, term, sum[!now]);
    now = !now;
  }
  return ex_sign(n, sum[now]);
}

/* The lifted determinant in double-double arithmetic, expanded along the lifts
 * over 3x3 determinants of the differences to the fifth point. */
static double insphere_dd(const double *const p[5])
{
  struct dd v[4][3], lift, det = { 0, 0 };

  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++) v[i][k] = dd_diff(p[i][k], p[4][k]);
  for (int i = 0; i < 4; i++) {
    struct dd *q = v[i == 0], *r = v[i < 2 ? 2 : 1], *s = v[i < 3 ? 3 : 2];
    struct dd d3 = { 0, 0 };

    for (int k = 0; k < 3; k++) {
      int l = (k + 1) % 3, m = (k + 2) % 3;

      d3 = dd_add(d3, dd_mul(q[k], dd_minor(r[l], s[m], r[m], s[l])));
    }
    lift = dd_add(dd_mul(v[i][0], v[i][0]), dd_mul(v[i][1], v[i][1]));
    lift = dd_add(lift, dd_mul(v[i][2], v[i][2]));
    lift = dd_mul(lift, d3);
    det = i & 1 ? dd_sub(det, lift) : dd_add(det, lift);
  }
  return det.hi;
}

/* Sum over the lifts times the permanents. The error bounds scale with it. */
static double insphere_permanent(double v[4][3])
{
  double per = 0;

  for (int i = 0; i < 4; i++) {
    double *q = v[i == 0], *r = v[i < 2 ? 2 : 1], *s = v[i < 3 ? 3 : 2];
    double p3 = 0;

    for (int k = 0; k < 3; k++) {
      int l = (k + 1) % 3, m = (k + 2) % 3;

      p3 += fabs(q[k]) * (fabs(r[l] * s[m]) + fabs(r[m] * s[l]));
    }
    per += p3 * (v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
  }
  return per;
}

#if LDBL_MANT_DIG == 64
/* The formula of vg_insphere in long double. */
static double insphere_64(const double *const p[5])
{
  long double v[4][3], l[4], ab, bc, cd, da, ac, bd;

  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < 3; k++) v[i][k] = (long double)p[i][k] - p[4][k];
    l[i] = v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2];
  }
  ab = v[0][0] * v[1][1] - v[1][0] * v[0][1];
  bc = v[1][0] * v[2][1] - v[2][0] * v[1][1];
  cd = v[2][0] * v[3][1] - v[3][0] * v[2][1];
  da = v[3][0] * v[0][1] - v[0][0] * v[3][1];
  ac = v[0][0] * v[2][1] - v[2][0] * v[0][1];
  bd = v[1][0] * v[3][1] - v[3][0] * v[1][1];
  return (double)((l[2] * (v[3][2] * ab + v[0][2] * bd + v[1][2] * da) -
                   l[3] * (v[0][2] * bc - v[1][2] * ac + v[2][2] * ab)) +
                  (l[0] * (v[1][2] * cd - v[2][2] * bd + v[3][2] * bc) -
                   l[1] * (v[2][2] * da + v[3][2] * ac + v[0][2] * cd)));
}
#endif

double vg_insphere_exact(const double a[3], const double b[3],
                         const double c[3], const double d[3],
                         const double e[3])
{
  const double *const p[5] = { a, b, c, d, e };
  double v[4][3], per, det;
  int is_short = 1;

  assert(FINITE3(a) && FINITE3(b) && FINITE3(c) && FINITE3(d) && FINITE3(e));
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++) v[i][k] = p[i][k] - e[k];
  per = insphere_permanent(v);
  if (per == 0) return 0;
#if LDBL_MANT_DIG == 64
  /* (16 + 224 u) u times the permanent with u = 2^-64, with a margin for the
   * rounding of the permanent, which is summed in double. */
  det = insphere_64(p);
  if (fabs(det) > 17 * (0x1p-64 * per)) return det;
#endif
  /* To first order 8 + 4 + 8 + 12 for the 3x3 determinant, 8 + 8 for the lift,
   * 8 for their product and 16 for the sum: 72 u^2 per; more than tripled for
   * safety. */
  det = insphere_dd(p);
  if (fabs(det) > (256 * U * U) * per) return det;
  for (int i = 0; i < 4; i++) {
    struct vec w = vec_diff(p[i], e, 3);

    is_short = is_short && vec_is_short(&w);
  }
  return is_short ? insphere_short(v) : insphere_long(p);
}

double vg_orient2d_exact(const double a[2], const double b[2],
                         const double c[2])
{
  struct vec p = vec_diff(b, a, 2), q = vec_diff(c, a, 2);
  double h[16];

  assert(FINITE2(a) && FINITE2(b) && FINITE2(c));
  return ex_sign(vec_minor(&p, &q, 0, 1, h), h);
}

/* h[512] = e (x^2 + y^2) for two-component x, y and m <= 16: 64 components
 * after one factor, 256 after both. */
static int lift2(int m, const double *e, const struct vec *p, double *h)
{
  double s[64], t[2][128], u[2][256];
  int n[2];

  for (int k = 0; k < 2; k++) {
    int ns = ex_mul(m, e, p->n[k], p->e[k], s), nt[2] = { 0, 0 };

    for (int i = 0; i < p->n[k]; i++) nt[i] = ex_scale(ns, s, p->e[k][i], t[i]);
    n[k] = ex_sum(nt[0], t[0], nt[1], t[1], u[k]);
  }
  return ex_sum(n[0], u[0], n[1], u[1], h);
}

static double incircle_expansion(const struct vec v[3])
{
  double minor[16], term[3][512], s[1024], h[1536];
  int n[3], m;

  for (int k = 0; k < 3; k++) {
    m = vec_minor(&v[(k + 1) % 3], &v[(k + 2) % 3], 0, 1, minor);
    n[k] = lift2(m, minor, &v[k], term[k]);
  }
  m = ex_sum(n[0], term[0], n[1], term[1], s);
  m = ex_sum(m, s, n[2], term[2], h);
  return ex_sign(m, h);
}

double vg_incircle_exact(const double a[2], const double b[2],
                         const double c[2], const double d[2])
{
  const double *const p[3] = { a, b, c };
  struct dd q[3][2], lift, det = { 0, 0 };
  struct vec v[3];
  double per = 0;

  assert(FINITE2(a) && FINITE2(b) && FINITE2(c) && FINITE2(d));
  for (int i = 0; i < 3; i++) {
    v[i] = vec_diff(p[i], d, 2);
    for (int k = 0; k < 2; k++) q[i][k] = dd_diff(p[i][k], d[k]);
  }
  for (int k = 0; k < 3; k++) {
    struct dd *r = q[(k + 1) % 3], *s = q[(k + 2) % 3];

    lift = dd_add(dd_mul(q[k][0], q[k][0]), dd_mul(q[k][1], q[k][1]));
    det = dd_add(det, dd_mul(lift, dd_minor(r[0], s[1], r[1], s[0])));
    per += lift.hi * (fabs(r[0].hi * s[1].hi) + fabs(r[1].hi * s[0].hi));
  }
  if (per == 0) return 0;
  /* To first order 8 + 4 + 8 + 4 + 8 + 12 = 44 u^2 per; nearly tripled. */
  if (fabs(det.hi) > (128 * U * U) * per) return det.hi;
  return incircle_expansion(v);
}
