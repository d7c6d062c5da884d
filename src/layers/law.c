#include "layers/law.h"

#include <math.h>

static double power(double x, int n)
{
  double y = 1;

  for (; n > 0; n >>= 1, x *= x)
    if (n & 1) y *= x;
  return y;
}

/* Thickness of layer j by the law alone. */
static double bare(const struct vg_law *law, int j)
{
  int k = law->n_constant > 1 ? j - law->n_constant : j - 1;

  if (k <= 0) return law->delta1;
  return law->delta1 *
         power(1 + law->rate1 * power(1 + law->rate2, k), k);
}

/* Runs through the layers: thickness of layer j, given that of j - 1. */
static double next(const struct vg_law *law, double cap, int j, double before)
{
  double t = bare(law, j);

  return j > 1 && t > cap * before ? cap * before : t;
}

void vg_law_heights(const struct vg_law *law, double cap, int n, double *d)
{
  double t = 0;

  if (cap > law->cap) cap = law->cap;
  d[0] = 0;
  for (int j = 1; j <= n; j++) {
    t = next(law, cap, j, t);
    d[j] = d[j - 1] + t;
  }
}

double vg_law_thickness(const struct vg_law *law, int j)
{
  double t = 0;

  for (int i = 1; i <= j; i++) t = next(law, law->cap, i, t);
  return t;
}

static double sum(const struct vg_law *law, double cap, int n)
{
  double total = 0, t = 0;

  for (int j = 1; j <= n; j++) {
    t = next(law, cap, j, t);
    total += t;
  }
  return total;
}

double vg_law_squeeze(const struct vg_law *law, int n, double height)
{
  double lo = 1, hi = law->cap;

  if (sum(law, hi, n) <= height) return hi;
  if (sum(law, lo, n) > height) return 0;
  /* An unlimited law still has a largest ratio among its n layers. */
  if (!isfinite(hi)) {
    hi = 2;
    while (sum(law, hi, n) <= height) hi *= 2;
  }
  for (int i = 0; i < 40; i++) {
    double mid = 0.5 * (lo + hi);

    if (sum(law, mid, n) <= height) lo = mid;
    else hi = mid;
  }
  return lo;
}

/* Friction velocity over that of the stream. */
static double friction(double reynolds)
{
  return sqrt(0.5 * 0.026 / pow(reynolds, 1.0 / 7));
}

double vg_first_height(double y_plus, double reynolds, double length)
{
  return y_plus * length / (reynolds * friction(reynolds));
}

double vg_y_plus(double y, double reynolds, double length)
{
  return y * reynolds * friction(reynolds) / length;
}

double vg_law_rate_for_total(double delta1, int n_constant, int n,
                             double total)
{
  struct vg_law law = { delta1, 0, 0, INFINITY, n_constant };
  double lo = 0, hi = 1;

  if (sum(&law, INFINITY, n) > total) return -1;
  law.rate1 = hi;
  while (sum(&law, INFINITY, n) < total && hi < 1e6) law.rate1 = hi *= 2;
  for (int i = 0; i < 60; i++) {
    law.rate1 = 0.5 * (lo + hi);
    if (sum(&law, INFINITY, n) < total) lo = law.rate1;
    else hi = law.rate1;
  }
  return 0.5 * (lo + hi);
}
