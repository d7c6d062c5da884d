/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/geometry/tensor.h"

#include <assert.h>
#include <float.h>
#include <stdint.h>
#include <string.h>

#include "core/geometry/vector.h"

/* Sweeps of Jacobi rotations: convergence is quadratic, so that rounding is
 * reached after at most six. */
enum { SWEEPS = 12 };

/* Smaller components off the diagonal, relative to those on it, change no
 * eigenvalue: their effect is of the second order. */
#define NEGLIGIBLE 1e-17

/* Rotate rows and columns p and q of a, so that a[p][q] vanishes, and the
 * vectors with them. */
static void rotate(double a[3][3], double v[3][3], int p, int q)
{
  int r = 3 - p - q;
  double theta, t, c, s, arp, arq;

  if (a[p][q] == 0) return;
  theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  t = 1 / (fabs(theta) + sqrt(theta * theta + 1));
  if (theta < 0) t = -t;
  c = 1 / sqrt(t * t + 1);
  s = t * c;
  a[p][p] -= t * a[p][q];
  a[q][q] += t * a[p][q];
  a[p][q] = a[q][p] = 0;
  arp = a[r][p];
  arq = a[r][q];
  a[r][p] = a[p][r] = c * arp - s * arq;
  a[r][q] = a[q][r] = s * arp + c * arq;
  for (int k = 0; k < 3; k++) {
    double vp = v[p][k], vq = v[q][k];

    v[p][k] = c * vp - s * vq;
    v[q][k] = s * vp + c * vq;
  }
}

static void exchange(double value[3], double vector[3][3], int i, int j)
{
  double kept = value[i], v[3];

  if (value[i] <= value[j]) return;
  value[i] = value[j];
  value[j] = kept;
  memcpy(v, vector[i], sizeof v);
  memcpy(vector[i], vector[j], sizeof v);
  memcpy(vector[j], v, sizeof v);
}

void vg_tensor_eigen(const double a[6], double value[3], double vector[3][3])
{
  double m[3][3] = { { a[0], a[1], a[2] },
                     { a[1], a[3], a[4] },
                     { a[2], a[4], a[5] } };

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) vector[i][j] = i == j;
  for (int k = 0; k < SWEEPS; k++) {
    double off = fabs(m[0][1]) + fabs(m[0][2]) + fabs(m[1][2]);
    double size = fabs(m[0][0]) + fabs(m[1][1]) + fabs(m[2][2]);

    if (!(off > NEGLIGIBLE * size)) break;
    rotate(m, vector, 0, 1);
    rotate(m, vector, 0, 2);
    rotate(m, vector, 1, 2);
  }
  for (int k = 0; k < 3; k++) value[k] = m[k][k];
  exchange(value, vector, 0, 1);
  exchange(value, vector, 1, 2);
  exchange(value, vector, 0, 1);
}

/* A third of the bits of x, with the bias of the exponent restored, is within
 * 6 % of the root. Each of Halley's steps cubes the error. */
double vg_cube_root(double x)
{
  static const uint64_t bias = 0x2a9f789300000000; /* 2/3 of that of a double */
  uint64_t bits;
  double y;

  assert(x > 0);
  if (x < DBL_MIN) return vg_cube_root(x * 0x1p54) * 0x1p-18;
  memcpy(&bits, &x, sizeof bits);
  bits = bits / 3 + bias;
  memcpy(&y, &bits, sizeof y);
  for (int k = 0; k < 3; k++) {
    double y3 = y * y * y;

    y *= (y3 + 2 * x) / (2 * y3 + x);
  }
  return y;
}

void vg_tensor_from_eigen(const double value[3], const double vector[3][3],
                          double a[6])
{
  int n = 0;

  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      double sum = 0;

      for (int k = 0; k < 3; k++) sum += value[k] * vector[k][i] * vector[k][j];
      a[n++] = sum;
    }
}

void vg_tensor_root(const double a[6], double out[6])
{
  double value[3], vector[3][3];

  if (a[1] == 0 && a[2] == 0 && a[4] == 0) {
    for (int k = 0; k < 6; k++) out[k] = sqrt(a[k]);
    return;
  }
  vg_tensor_eigen(a, value, vector);
  for (int k = 0; k < 3; k++) value[k] = sqrt(fmax(value[k], 0));
  vg_tensor_from_eigen(value, (const double(*)[3])vector, out);
}

/* out = s m s for symmetric s and m. */
static void congruent(const double s[6], const double m[6], double out[6])
{
  static const int at[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
  double sm[3][3];
  int n = 0;

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      sm[i][j] = 0;
      for (int k = 0; k < 3; k++) sm[i][j] += s[at[i][k]] * m[at[k][j]];
    }
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      out[n] = 0;
      for (int k = 0; k < 3; k++) out[n] += sm[i][k] * s[at[k][j]];
      n++;
    }
}

void vg_metric_intersect(const double a[6], const double b[6], double out[6])
{
  double t[6], h[6], reduced[6], value[3], vector[3][3];
  int finer = 0;

  vg_tensor_root(a, t);
  if (!(vg_tensor_invert(t, h) > 0)) { /* a requires nothing finite */
    memmove(out, b, sizeof t);
    return;
  }
  congruent(h, b, reduced);
  vg_tensor_eigen(reduced, value, vector);
  for (int k = 0; k < 3; k++) {
    finer += value[k] > 1;
    value[k] = fmax(value[k], 1);
  }
  if (!finer) {
    memmove(out, a, sizeof t);
    return;
  }
  vg_tensor_from_eigen(value, (const double(*)[3])vector, reduced);
  congruent(t, reduced, out);
}

/* The logarithmic mean is between the geometric mean g and the arithmetic
 * mean m, as (2 g + m) / 3, whose error is of the fourth order in the
 * logarithm of the ratio; halved by roots where the ratio is large:
 * L(a, b) = (sqrt a + sqrt b) / 2 * L(sqrt a, sqrt b). */
double vg_log_mean(double a, double b)
{
  double factor = 1;

  assert(a >= 0 && b >= 0);
  for (int k = 0; k < 6 && (a > 1.5 * b || b > 1.5 * a); k++) {
    a = sqrt(a);
    b = sqrt(b);
    factor *= 0.5 * (a + b);
  }
  return factor * (2 * sqrt(a * b) + 0.5 * (a + b)) / 3;
}

double vg_metric_length(const double a[6], const double b[6], const double v[3])
{
  return vg_log_mean(sqrt(fmax(vg_tensor_form(a, v), 0)),
                     sqrt(fmax(vg_tensor_form(b, v), 0)));
}
