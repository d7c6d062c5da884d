/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/graph/bisect.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"

struct item {
  double at;
  uint32_t k;
};

struct bisection {
  const double (*x)[3];
  const double *weight;
  struct item *item;
  uint32_t *part;
};

static int by_place(const void *a, const void *b)
{
  const struct item *p = a, *q = b;

  if (p->at != q->at) return p->at < q->at ? -1 : 1;
  return (p->k > q->k) - (p->k < q->k);
}

static int longest_axis(const struct bisection *b, size_t first, size_t end)
{
  double most = -1;
  int axis = 0;

  for (int k = 0; k < 3; k++) {
    double lo = b->x[b->item[first].k][k], hi = lo;

    for (size_t i = first; i < end; i++) {
      const double x = b->x[b->item[i].k][k];

      if (x < lo) lo = x;
      if (x > hi) hi = x;
    }
    if (hi - lo > most) {
      most = hi - lo;
      axis = k;
    }
  }
  return axis;
}

/* Divide items first .. end - 1, at least n of them, into subdomains at .. at
 * + n - 1. */
static void bisect(const struct bisection *b, size_t first, size_t end,
                   size_t n, uint32_t at)
{
  const size_t below = n / 2;
  double sum = 0, half = 0;
  size_t cut = first;
  int axis;

  if (n < 2) {
    for (size_t i = first; i < end; i++) b->part[b->item[i].k] = at;
    return;
  }
  axis = longest_axis(b, first, end);
  for (size_t i = first; i < end; i++) {
    b->item[i].at = b->x[b->item[i].k][axis];
    sum += b->weight[b->item[i].k];
  }
  qsort(b->item + first, end - first, sizeof *b->item, by_place);
  sum *= (double)below / (double)n;
  while (cut < end - (n - below)) {
    const double w = b->weight[b->item[cut].k];

    if (cut - first >= below && half + 0.5 * w > sum) break;
    half += w;
    cut++;
  }
  bisect(b, first, cut, below, at);
  bisect(b, cut, end, n - below, at + (uint32_t)below);
}

vg_status vg_bisect(size_t n, const double (*x)[3], const double *weight,
                    int n_part, uint32_t *part, struct vg_error *err)
{
  struct bisection b = { x, weight, vg_alloc(n, sizeof *b.item), part };

  assert((x && weight && part) || !n);
  if (n_part < 1 || (size_t)n_part > n) {
    free(b.item);
    return vg_fail(err, VG_ERR_INPUT,
                   "%zu items cannot be divided into %d subdomains", n, n_part);
  }
  if (!b.item) return vg_fail_memory(err, "a bisection");
  for (size_t i = 0; i < n; i++) b.item[i].k = (uint32_t)i;
  bisect(&b, 0, n, (size_t)n_part, 0);
  free(b.item);
  for (size_t i = 0; i < n; i++) assert(part[i] < (uint32_t)n_part);
  return VG_OK;
}
