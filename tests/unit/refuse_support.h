/* Voids that cannot be filled, for tests: this vg_grow stands before that of
 * the library. It refuses voids around a place whose front comes too near it.
 * So what is refused follows from the void alone. Header only: one program
 * per module. */
#ifndef TESTS_UNIT_REFUSE_SUPPORT_H
#define TESTS_UNIT_REFUSE_SUPPORT_H

#include <dlfcn.h>
#include <math.h>
#include <stdatomic.h>

#include "core/fill/grow.h"

/* In the box of 40,000 cells, in leaves of 2,000: cut elsewhere, the void that
 * the leaf was cut from goes; the next larger one; only the whole, at the
 * second attempt; none. near: of points of the front. */
struct refusal { double at[3], near; };
static const struct refusal refuse_once = { {0.6, 0.35, 0.2}, 0.061 };
static const struct refusal refuse_once_too = { {0.15, 0.3, 0.85}, 0.061 };
static const struct refusal refuse_twice = { {0.6, 0.2, 0.2}, 0.061 };
static const struct refusal refuse_often = { {0.4, 0.4, 0.8}, 0.07 };
static const struct refusal refuse_all = { {0.6, 0.6, 0.6}, 0.07 };

/* What is refused now. */
static struct refusal refusal[2];
static int n_refusal;
static atomic_int n_refused;

/* Solid angle of a triangle seen from x, by Van Oosterom and Strackee. */
static inline double angle_of(const struct vg_void *v, size_t f,
                              const double x[3])
{
  double d[3][3], r[3], det, dot = 0;

  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) d[i][k] = v->x[v->face[f][i]][k] - x[k];
    r[i] = sqrt(d[i][0] * d[i][0] + d[i][1] * d[i][1] + d[i][2] * d[i][2]);
  }
  det = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) +
        d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
        d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
  for (int i = 0; i < 3; i++) {
    const double *a = d[(i + 1) % 3], *b = d[(i + 2) % 3];

    dot += r[i] * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
  }
  return 2 * atan2(det, r[0] * r[1] * r[2] + dot);
}

static inline int is_refused_by(const struct refusal *r,
                                const struct vg_void *v)
{
  const double *x = r->at;
  double sum = 0, least = INFINITY;

  for (size_t f = 0; f < v->n_face; f++) sum += angle_of(v, f, x);
  if (fabs(sum) < 2 * 3.14159265) return 0;
  for (size_t p = 0; p < v->n_point; p++) {
    const double *y = v->x[p];

    least = fmin(least, hypot(hypot(y[0] - x[0], y[1] - x[1]), y[2] - x[2]));
  }
  return least < r->near;
}

static inline int is_refused(const struct vg_void *v)
{
  for (int k = 0; k < n_refusal; k++)
    if (is_refused_by(&refusal[k], v)) return 1;
  return 0;
}

vg_status vg_grow(struct vg_void *v, const struct vg_sizing *sizing,
                  const struct vg_grow_options *options,
                  struct vg_fill_report *report, struct vg_error *err)
{
  vg_status (*grow_it)(struct vg_void *, const struct vg_sizing *,
                       const struct vg_grow_options *,
                       struct vg_fill_report *, struct vg_error *);
  void *at = dlsym(RTLD_NEXT, "vg_grow");

  memcpy(&grow_it, &at, sizeof at);
  if (!is_refused(v)) return grow_it(v, sizing, options, report, err);
  atomic_fetch_add(&n_refused, 1);
  return vg_fail(err, VG_ERR_GEOMETRY, "a void is refused");
}

#endif
