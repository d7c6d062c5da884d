/* Recursive coordinate bisection: across the longest side of the box of what is
 * left, where weight stands to weight as parts do to parts. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "partition/discrete/discrete_parts.h"

struct item { double at; uint32_t index; };

struct bisection {
  const double (*x)[3];
  const double *weight;
  uint32_t *part;
  struct item *item;         /* [n] */
};

static int by_place(const void *a, const void *b)
{
  const struct item *s = a, *t = b;

  if (s->at != t->at) return s->at < t->at ? -1 : 1;
  return (s->index > t->index) - (s->index < t->index);
}

static int longest_axis(const struct bisection *b, size_t n,
                        const struct item *item)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };
  int axis = 0;

  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      lo[k] = fmin(lo[k], b->x[item[i].index][k]);
      hi[k] = fmax(hi[k], b->x[item[i].index][k]);
    }
  for (int k = 1; k < 3; k++)
    if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
  return axis;
}

/* Items below the cut: at least one for each part on both sides. */
static size_t cut(const struct bisection *b, size_t n, struct item *item,
                  int n_low, int n_part)
{
  int axis = longest_axis(b, n, item);
  double sum = 0, below = 0;
  size_t k = 0, most = n - (size_t)(n_part - n_low);

  for (size_t i = 0; i < n; i++) {
    item[i].at = b->x[item[i].index][axis];
    sum += b->weight[item[i].index];
  }
  qsort(item, n, sizeof *item, by_place);
  while (k < most && (k < (size_t)n_low ||
         below + 0.5 * b->weight[item[k].index] < sum * n_low / n_part))
    below += b->weight[item[k++].index];
  return k;
}

static void bisect(const struct bisection *b, size_t n, struct item *item,
                   int n_part, uint32_t first)
{
  while (n_part > 1) {
    int n_low = n_part / 2;
    size_t k = cut(b, n, item, n_low, n_part);

    bisect(b, k, item, n_low, first);
    item += k;
    n -= k;
    first += (uint32_t)n_low;
    n_part -= n_low;
  }
  for (size_t i = 0; i < n; i++) b->part[item[i].index] = first;
}

vg_status vg_bisect(size_t n, const double (*x)[3], const double *weight,
                    int n_part, uint32_t *part, struct vg_error *err)
{
  struct bisection b = { x, weight, part, vg_alloc(n, sizeof *b.item) };

  if (!b.item) return vg_fail_memory(err, "dealing out the coarse mesh");
  for (size_t i = 0; i < n; i++) b.item[i].index = (uint32_t)i;
  bisect(&b, n, b.item, n_part, 0);
  free(b.item);
  return VG_OK;
}
