/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: octants are assigned to the blocks of a lattice by position, in
 * chunks that threads share. All octants are counted first and then written, so
 * that their order in a block is the parent's order. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/engine/engine.h"
#include "partition/load/load.h"
#include "partition/load/load_tree.h"

enum { CHUNK = 4096 };

/* Thinner slices of an octant are ignored. */
#define SLICE 1e-3

struct distribution {
  const struct vg_load *parent;
  const int *n;
  const double *const *at;
  double reach, correction;
  size_t n_block, n_chunk;
  size_t
    *count; /* [n_chunk][n_block] Number of octants, later their offsets. */
  struct vg_load *out;
  int is_counting;
};

/* --- octants ---------------------------------------------------------------
 */

/* Fraction of an octant's cells in block k of an axis, without separator zones.
 */
static double slice(const struct distribution *d,
                    const struct vg_load_octant *c, int axis, int k)
{
  const struct vg_load *l = d->parent;
  const double *at = d->at[axis], zone = d->reach * (double)c->across[axis];
  double lo = (double)c->at[axis] - (double)c->half;
  double hi = (double)c->at[axis] + (double)c->half, from, to;

  if (l->is_block) {
    lo = fmax(lo, l->from[axis]);
    hi = fmin(hi, l->to[axis]);
  }
  from = k > 0 ? fmax(lo, at[k - 1] + zone) : lo;
  to = k < d->n[axis] ? fmin(hi, at[k] - zone) : hi;
  return hi > lo ? (to - from) / (hi - lo) : from <= to;
}

/* Blocks first .. end - 1 of an axis that an octant touches. */
static void find_range(const struct distribution *d,
                       const struct vg_load_octant *c, int axis, int *first,
                       int *end)
{
  const double lo = (double)c->at[axis] - (double)c->half;
  const double hi = (double)c->at[axis] + (double)c->half;
  int k = 0;

  while (k < d->n[axis] && d->at[axis][k] <= lo) k++;
  *first = k;
  while (k < d->n[axis] && d->at[axis][k] < hi) k++;
  *end = k + 1;
}

static void put(struct distribution *d, size_t *count, size_t block,
                const struct vg_load_octant *c, double part)
{
  struct vg_load_octant *to;

  if (!d->is_counting) {
    to = &d->out[block].octant[count[block]];
    *to = *c;
    to->part = (float)(part * (double)c->part);
    to->cells = (float)(d->correction * part * (double)c->cells);
  }
  count[block]++;
}

static void distribute_octant(struct distribution *d, size_t *count,
                              const struct vg_load_octant *c)
{
  const size_t nx = (size_t)d->n[0] + 1, ny = (size_t)d->n[1] + 1;
  int first[3], end[3];

  for (int k = 0; k < 3; k++) find_range(d, c, k, &first[k], &end[k]);
  for (int m = first[2]; m < end[2]; m++) {
    const double z = slice(d, c, 2, m);

    if (z < SLICE) continue;
    for (int j = first[1]; j < end[1]; j++) {
      const double y = slice(d, c, 1, j);

      if (y < SLICE) continue;
      for (int i = first[0]; i < end[0]; i++) {
        const double x = slice(d, c, 0, i);

        if (x >= SLICE)
          put(d, count, (size_t)i + nx * ((size_t)j + ny * (size_t)m), c,
              x * y * z);
      }
    }
  }
}

static void distribute_chunk(void *context, size_t first, size_t end,
                             int worker)
{
  struct distribution *d = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    size_t a = i * CHUNK, b = a + CHUNK;

    if (b > d->parent->n) b = d->parent->n;
    for (; a < b; a++)
      distribute_octant(d, d->count + i * d->n_block, &d->parent->octant[a]);
  }
}

/* --- blocks -------------------------------------------------------------- */

static void bound(const struct distribution *d, size_t block, struct vg_load *l)
{
  vg_load_copy_frame(d->parent, l);
  for (int k = 0; k < 3; k++) {
    const size_t n = (size_t)d->n[k] + 1, i = block % n;

    block /= n;
    if (!d->parent->is_block) {
      l->from[k] = -INFINITY;
      l->to[k] = INFINITY;
    }
    if (i > 0) l->from[k] = fmax(l->from[k], d->at[k][i - 1]);
    if (i + 1 < n) l->to[k] = fmin(l->to[k], d->at[k][i]);
  }
  l->is_block = 1;
}

/* Turns counts into offsets and allocates the blocks. */
static int make_room(struct distribution *d)
{
  for (size_t b = 0; b < d->n_block; b++) {
    struct vg_load *l = &d->out[b];

    for (size_t i = 0; i < d->n_chunk; i++) {
      const size_t n = d->count[i * d->n_block + b];

      d->count[i * d->n_block + b] = l->n;
      l->n += n;
    }
    bound(d, b, l);
    if (!l->n) continue;
    l->octant = vg_alloc(l->n, sizeof *l->octant);
    if (!l->octant) return -1;
  }
  return 0;
}

static size_t blocks_of(const int n[3])
{
  return (size_t)(n[0] + 1) * (size_t)(n[1] + 1) * (size_t)(n[2] + 1);
}

static void release_all(struct vg_load *l, size_t n)
{
  for (size_t i = 0; l && i < n; i++) vg_load_release(&l[i]);
  free(l);
}

/* Distributes the octants. Returns loads without index and sum, or NULL. */
static struct vg_load *distribute(struct distribution *d,
                                  const struct vg_engine *e)
{
  d->n_block = blocks_of(d->n);
  d->n_chunk = (d->parent->n + CHUNK - 1) / CHUNK;
  d->out = vg_calloc(d->n_block, sizeof *d->out);
  d->count = vg_calloc(d->n_chunk * d->n_block + 1, sizeof *d->count);
  d->is_counting = 1;
  if (d->out && d->count) {
    vg_engine_loop(e, d->n_chunk, 1, distribute_chunk, d);
    if (!make_room(d)) {
      d->is_counting = 0;
      vg_engine_loop(e, d->n_chunk, 1, distribute_chunk, d);
      free(d->count);
      return d->out;
    }
  }
  free(d->count);
  release_all(d->out, d->n_block);
  return NULL;
}

struct finish {
  struct vg_load *l;
  int *bad;
};

static void finish_part(void *context, size_t first, size_t end, int worker)
{
  const struct finish *f = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_load *l = &f->l[i];

    for (size_t k = 0; k < l->n; k++) l->cells += (double)l->octant[k].cells;
    f->bad[i] = vg_load_index(l, 1, NULL) < 0;
  }
}

/* Computes sums and indices. */
static int finish(struct vg_load *l, size_t n, const struct vg_engine *e)
{
  struct finish f = { l, vg_calloc(n, sizeof *f.bad) };
  int bad = f.bad == NULL;

  if (f.bad) vg_engine_loop(e, n, 1, finish_part, &f);
  for (size_t i = 0; f.bad && i < n; i++) bad |= f.bad[i];
  free(f.bad);
  return bad;
}

vg_status vg_load_split_blocks(const struct vg_load *parent, const int n[3],
                               const double *const at[3], double reach,
                               double correction, const struct vg_engine *e,
                               struct vg_load *out, struct vg_error *err)
{
  assert(n[0] >= 0 && n[1] >= 0 && n[2] >= 0 && out);
  assert(reach >= 0 && correction > 0);

  struct distribution d = {
    .parent = parent, .n = n, .at = at, .reach = reach, .correction = correction
  };
  struct vg_load *made = distribute(&d, e);

  if (!made || finish(made, d.n_block, e)) {
    release_all(made, made ? d.n_block : 0);
    return vg_fail_memory(err, "the load estimate");
  }
  memcpy(out, made, d.n_block * sizeof *out);
  free(made);
  return VG_OK;
}
