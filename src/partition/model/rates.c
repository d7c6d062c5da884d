/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/model/rates.h"

#include <assert.h>
#include <dlfcn.h>
#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/memory.h"

enum { LEAST = 4 }; /* minimum number of tasks for a fit */

/* Rows of 1 = cell * cells / seconds + face * faces / seconds, stored by
 * columns. */
struct rows {
  size_t n;
  double *a, *b;
};

static int counts(const struct vg_span *s, char kind)
{
  return s->kind == kind && s->cpu > 0 && s->n_cell > 0;
}

static vg_status list_rows(const struct vg_spans *s, char kind, struct rows *r,
                           struct vg_error *err)
{
  size_t m = 0;

  for (size_t i = 0; i < s->n; i++) r->n += counts(&s->span[i], kind) != 0;
  if (r->n < LEAST) return VG_OK;
  r->a = vg_alloc(2 * r->n, sizeof *r->a);
  r->b = vg_alloc(r->n, sizeof *r->b);
  if (!r->a || !r->b) return vg_fail_memory(err, "the rates of a machine");
  for (size_t i = 0; i < s->n; i++) {
    const struct vg_span *t = &s->span[i];

    if (!counts(t, kind)) continue;
    r->a[m] = (double)t->n_cell / t->cpu;
    r->a[r->n + m] = (double)t->n_face / t->cpu;
    r->b[m++] = 1;
  }
  return VG_OK;
}

/* Coefficient of a fit with one column alone; 0 for an empty column. */
static double alone(const struct rows *r, const double *column)
{
  double xx = 0, xb = 0;

  for (size_t i = 0; i < r->n; i++) {
    xx += column[i] * column[i];
    xb += column[i];
  }
  return xx > 0 ? xb / xx : 0;
}

static double error_of(const struct rows *r, double cell, double face)
{
  double sum = 0;

  for (size_t i = 0; i < r->n; i++) {
    double d = cell * r->a[i] + face * r->a[r->n + i] - 1;

    sum += d * d;
  }
  return sqrt(sum / (double)r->n);
}

/* Loaded on first use (see src/CMakeLists.txt), and kept. */
static __typeof__(LAPACKE_dgels) *load_dgels(void)
{
  void *library = dlopen(VG_LAPACKE, RTLD_NOW | RTLD_LOCAL);

  return library ? (__typeof__(LAPACKE_dgels) *)dlsym(library, "LAPACKE_dgels")
                 : NULL;
}

void vg_library_lapacke(struct vg_library *out)
{
  void *library = dlopen(VG_LAPACKE, RTLD_NOW | RTLD_LOCAL);
  lapack_int v[3] = { 0, 0, 0 };
  __typeof__(LAPACKE_ilaver) *ask = library ? (__typeof__(LAPACKE_ilaver) *)
                                                dlsym(library, "LAPACKE_ilaver")
                                            : NULL;

  out->name = "LAPACKE";
  if (ask) {
    ask(&v[0], &v[1], &v[2]);
    snprintf(out->version, sizeof out->version, "%d.%d.%d", (int)v[0],
             (int)v[1], (int)v[2]);
  } else {
    snprintf(out->version, sizeof out->version,
             library ? "of unknown version" : VG_LAPACKE " was not found");
  }
}

/* Fits both rates. dgels overwrites both arrays, so it gets copies. -1: no
 * memory; 0: no valid pair. */
static int both(const struct rows *r, __typeof__(LAPACKE_dgels) *dgels,
                double *cell, double *face)
{
  double *a = vg_alloc(2 * r->n, sizeof *a), *b = vg_alloc(r->n, sizeof *b);
  int info = -1;

  if (a && b) {
    for (size_t i = 0; i < 2 * r->n; i++) a[i] = r->a[i];
    for (size_t i = 0; i < r->n; i++) b[i] = r->b[i];
    info = dgels(LAPACK_COL_MAJOR, 'N', (lapack_int)r->n, 2, 1, a,
                 (lapack_int)r->n, b, (lapack_int)r->n);
    *cell = b[0];
    *face = b[1];
  }
  free(a);
  free(b);
  if (info < 0) return -1;
  return info == 0 && *cell >= 0 && *face >= 0;
}

vg_status vg_rates_fit(const struct vg_spans *s, char kind,
                       struct vg_rate_fit *out, struct vg_error *err)
{
  assert(s && out);
  struct rows r = { 0, NULL, NULL };
  double cell = 0, face = 0;
  __typeof__(LAPACKE_dgels) *dgels;
  int found;
  vg_status st;

  *out = (struct vg_rate_fit){ .kind = kind };
  VG_TRY(list_rows(s, kind, &r, err));
  if (r.n < LEAST) goto done;
  dgels = load_dgels();
  if (!dgels) {
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "LAPACK, which fits the times of "
                 "tasks, cannot be loaded: %s",
                 dlerror());
    goto done;
  }
  found = both(&r, dgels, &cell, &face);
  if (found < 0) {
    st = vg_fail_memory(err, "the rates of a machine");
    goto done;
  }
  if (!found) { /* one of the columns has no effect, or a negative one */
    double c = alone(&r, r.a), f = alone(&r, r.a + r.n);
    int by_face = f > 0 && error_of(&r, 0, f) < error_of(&r, c, 0);

    cell = by_face ? 0 : c;
    face = by_face ? f : 0;
  }
  out->n = r.n;
  out->cell = cell;
  out->face = face;
  out->error = error_of(&r, cell, face);
done:
  free(r.a);
  free(r.b);
  return st;
}

static void take(struct vg_task_rate *rate, const struct vg_rate_fit *fit)
{
  if (!fit->n) return;
  rate->even = rate->graded = fit->cell;
  rate->face = fit->face;
}

vg_status vg_rates_of(const struct vg_spans *s,
                      struct vg_rate_fit fit[VG_RATE_FITS],
                      struct vg_error *err)
{
  static const char kind[VG_RATE_FITS] = { VG_SPAN_LEAF, VG_SPAN_PENCIL,
                                           VG_SPAN_TILE };

  assert(s && fit);
  for (int k = 0; k < VG_RATE_FITS; k++) {
    vg_status st = vg_rates_fit(s, kind[k], &fit[k], err);

    if (st < 0) return st;
  }
  return VG_OK;
}

void vg_rates_replace(struct vg_rates *r,
                      const struct vg_rate_fit fit[VG_RATE_FITS])
{
  assert(r && fit);
  take(&r->leaf, &fit[0]);
  take(&r->pencil, &fit[1]);
  take(&r->rib, &fit[1]);
  take(&r->tile, &fit[2]);
}
