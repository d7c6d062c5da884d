/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: octants are in octree order. The same order applies to positions:
 * the highest bit in which two positions differ along some axis decides. The
 * octant of a position is therefore found by bisection. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/load/load_tree.h"

/* An octant in the integer lattice of the octree. */
struct place {
  uint32_t at[3], side; /* at: lower corner. */
  uint32_t octant;
};

struct vg_load_finder {
  double lo[3], unit;
  size_t n;
  struct place *place; /* [n] In octree order. */
};

void vg_load_finder_free(struct vg_load_finder *f)
{
  if (!f) return;
  free(f->place);
  free(f);
}

/* Compares two positions: the axis whose coordinates differ in the highest bit
 * decides, and among several such axes the last one (load_tree.h counts
 * octants x first). */
static int by_order(const uint32_t a[3], const uint32_t b[3])
{
  uint32_t most = 0;
  int axis = 0;

  for (int k = 0; k < 3; k++) {
    const uint32_t d = a[k] ^ b[k];

    if (d >= most || d >= (most ^ d)) { /* its highest bit is not lower */
      most = d;
      axis = k;
    }
  }
  return (a[axis] > b[axis]) - (a[axis] < b[axis]);
}

static int by_place(const void *a, const void *b)
{
  return by_order(((const struct place *)a)->at, ((const struct place *)b)->at);
}

/* Octants are kept in single precision; their sides are powers of two and their
 * corners multiples of them. Returns 0 if the octant is not in the octree. */
static int place_of(const struct vg_load *l, size_t i, struct place *p)
{
  const struct vg_load_octant *c = &l->octant[i];
  const double side = 2 * (double)c->half / l->unit;
  int e;

  if (!(side >= 1 && side < 0x1p31)) return 0;
  if (frexp(side, &e) > 0.75) e++;
  p->side = (uint32_t)1 << (e - 1);
  p->octant = (uint32_t)i;
  for (int k = 0; k < 3; k++) {
    const double at = ((double)c->at[k] - (double)c->half - l->lo[k]) /
                      l->unit / p->side;

    if (!(at > -0.5 && at * p->side < 0x1p31 - 0.5)) return 0;
    p->at[k] = (uint32_t)floor(at + 0.5) * p->side;
  }
  return 1;
}

vg_status vg_load_finder_new(const struct vg_load *l,
                             struct vg_load_finder **out, struct vg_error *err)
{
  assert(out);

  struct vg_load_finder *f = vg_calloc(1, sizeof *f);

  if (f) f->place = vg_alloc(l->n, sizeof *f->place);
  if (!f || !f->place) {
    vg_load_finder_free(f);
    return vg_fail_memory(err, "the load estimate");
  }
  memcpy(f->lo, l->lo, sizeof f->lo);
  f->unit = l->unit;
  for (size_t i = 0; i < l->n; i++)
    f->n += place_of(l, i, &f->place[f->n]) != 0;
  if (f->n) qsort(f->place, f->n, sizeof *f->place, by_place);
  *out = f;
  return VG_OK;
}

size_t vg_load_find(const struct vg_load_finder *f, const double x[3])
{
  assert(f);

  size_t low = 0, high = f->n;
  uint32_t at[3];

  for (int k = 0; k < 3; k++) {
    const double p = (x[k] - f->lo[k]) / f->unit;

    if (!(p >= 0 && p < 0x1p31)) return SIZE_MAX;
    at[k] = (uint32_t)p;
  }
  while (low < high) { /* the last octant that is not behind the position */
    const size_t mid = low + (high - low) / 2;

    if (by_order(f->place[mid].at, at) <= 0) low = mid + 1;
    else high = mid;
  }
  if (!low) return SIZE_MAX;
  for (int k = 0; k < 3; k++)
    if (at[k] - f->place[low - 1].at[k] >= f->place[low - 1].side)
      return SIZE_MAX;
  return f->place[low - 1].octant;
}
