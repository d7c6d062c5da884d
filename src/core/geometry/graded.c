/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/geometry/graded.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

enum { PER_STEP = 4 }; /* samples of the spacing per step */

struct sampled {
  size_t n, cap_s, cap_f;
  double *s, *f; /* f: number of steps up to s, as a real number */
};

static vg_status sample(double len, double (*size)(void *, double), void *user,
                        struct sampled *a, struct vg_error *err)
{
  double s = 0, f = 0, h = size(user, 0);

  for (;;) {
    double ds = h / PER_STEP, next, h_next;

    if (!(h > len * 1e-8))
      return vg_fail(err, VG_ERR_INPUT,
                     "a curve of length %g would need "
                     "edges of length %g; check the spacing on it",
                     len, h);
    if (vg_reserve(&a->s, &a->cap_s, a->n + 1, sizeof *a->s) ||
        vg_reserve(&a->f, &a->cap_f, a->n + 1, sizeof *a->f))
      return vg_fail_memory(err, "the points of a curve");
    a->s[a->n] = s;
    a->f[a->n++] = f;
    if (s >= len) return VG_OK;
    if (ds > len / 16) ds = len / 16;
    next = len - s < 1.5 * ds ? len : s + ds;
    h_next = size(user, next);
    if (!(h_next > len * 1e-8)) h_next = 0;
    f += (next - s) * 0.5 * (1 / h + (h_next > 0 ? 1 / h_next : 1 / h));
    s = next;
    h = h_next;
  }
}

vg_status vg_graded_steps(double len, double (*size)(void *user, double s),
                          void *user, size_t least, size_t *n, double **s,
                          struct vg_error *err)
{
  assert(size && n && s);
  assert(least >= 1);

  struct sampled a = { 0 };
  double *out, total;
  size_t count, k = 0;
  vg_status st = sample(len, size, user, &a, err);

  if (st != VG_OK) goto done;
  total = a.f[a.n - 1];
  count = (size_t)(total + 0.5);
  if (count < least) count = least;
  out = vg_alloc(count + 1, sizeof *out);
  if (!out) {
    st = vg_fail_memory(err, "the points of a curve");
    goto done;
  }
  for (size_t i = 0; i < count; i++) {
    const double f = total * ((double)i / (double)count);

    while (k + 2 < a.n && a.f[k + 1] <= f) k++;
    out[i] = a.s[k] +
             (a.s[k + 1] - a.s[k]) * (f - a.f[k]) / (a.f[k + 1] - a.f[k]);
  }
  out[0] = 0;
  out[count] = len;
  *n = count;
  *s = out;
done:
  free(a.s);
  free(a.f);
  return st;
}

/* Taylor series up to the 15th power for angles below an eighth of a turn; the
 * truncation error is below 1e-17. */
static void series(double x, double *sine, double *cosine)
{
  const double q = x * x;
  double s = 1, c = 1;

  for (int k = 8; k >= 1; k--) {
    s = 1 - q / (2 * k * (2 * k + 1)) * s;
    c = 1 - q / (2 * k * (2 * k - 1)) * c;
  }
  *sine = x * s;
  *cosine = c;
}

void vg_quarter_turn(double x, double *sine, double *cosine)
{
  const double right_angle = 1.57079632679489661923;

  assert(x >= 0 && x <= 1);
  if (x <= 0.5) series(right_angle * x, sine, cosine);
  else series(right_angle * (1 - x), cosine, sine);
}
