/* Outline: cubes are dealt out to the blocks of a lattice by where they are,
 * in chunks that threads share: first all are counted, then written, so their
 * order in a block is the parent's. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "partition/load.h"
#include "partition/load_tree.h"

enum { CHUNK = 4096 };

/* Thinner slices of a cube are nothing. */
#define SLICE 1e-3

/* Cells within so many target edges of a plane are those of its zone, as
 * measured over boxes; volumes of fronts tell what is left exactly. */
#define ZONE_REACH 0.68

struct deal {
  const struct vg_load *parent;
  const int *n;
  const double *const *at;
  double reach, correction;
  size_t n_block, n_chunk;
  size_t *count;             /* [n_chunk][n_block] cubes, then their places */
  struct vg_load *out;
  int is_counting;
};

/* --- cubes --------------------------------------------------------------- */

/* Part of a cube's cells in block k of an axis, zones left out. */
static double slice(const struct deal *d, const struct vg_load_cube *c,
                    int axis, int k)
{
  const struct vg_load *l = d->parent;
  const double *at = d->at[axis], zone = d->reach * (double)c->h;
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

/* Blocks of an axis, first .. end - 1, that a cube touches. */
static void find_range(const struct deal *d, const struct vg_load_cube *c,
                       int axis, int *first, int *end)
{
  const double lo = (double)c->at[axis] - (double)c->half;
  const double hi = (double)c->at[axis] + (double)c->half;
  int k = 0;

  while (k < d->n[axis] && d->at[axis][k] <= lo) k++;
  *first = k;
  while (k < d->n[axis] && d->at[axis][k] < hi) k++;
  *end = k + 1;
}

static void put(struct deal *d, size_t *count, size_t block,
                const struct vg_load_cube *c, double part)
{
  struct vg_load_cube *to;

  if (!d->is_counting) {
    to = &d->out[block].cube[count[block]];
    *to = *c;
    to->part = (float)(part * (double)c->part);
    to->cells = (float)(d->correction * part * (double)c->cells);
  }
  count[block]++;
}

static void deal_cube(struct deal *d, size_t *count,
                      const struct vg_load_cube *c)
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

static void deal_part(void *context, size_t first, size_t end, int worker)
{
  struct deal *d = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    size_t a = i * CHUNK, b = a + CHUNK;

    if (b > d->parent->n) b = d->parent->n;
    for (; a < b; a++)
      deal_cube(d, d->count + i * d->n_block, &d->parent->cube[a]);
  }
}

/* --- blocks -------------------------------------------------------------- */

static void bound(const struct deal *d, size_t block, struct vg_load *l)
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

/* Counts become places, and blocks get room. */
static int make_room(struct deal *d)
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
    l->cube = vg_alloc(l->n, sizeof *l->cube);
    if (!l->cube) return -1;
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

/* Loads without index or sum, or NULL. */
static struct vg_load *deal_out(struct deal *d, int threads)
{
  d->n_block = blocks_of(d->n);
  d->n_chunk = (d->parent->n + CHUNK - 1) / CHUNK;
  d->out = vg_calloc(d->n_block, sizeof *d->out);
  d->count = vg_calloc(d->n_chunk * d->n_block + 1, sizeof *d->count);
  d->is_counting = 1;
  if (d->out && d->count) {
    vg_parallel_for(threads, d->n_chunk, 1, deal_part, d);
    if (!make_room(d)) {
      d->is_counting = 0;
      vg_parallel_for(threads, d->n_chunk, 1, deal_part, d);
      free(d->count);
      return d->out;
    }
  }
  free(d->count);
  release_all(d->out, d->n_block);
  return NULL;
}

struct finish { struct vg_load *l; double *volume; int *bad; };

/* Sums and index of loads without; volume: to be fitted to, or NULL. */
static void finish_part(void *context, size_t first, size_t end, int worker)
{
  const struct finish *f = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_load *l = &f->l[i];

    if (l->index) continue;
    if (f->volume) vg_load_fit(l, f->volume[i]);
    else {
      l->cells = 0;
      for (size_t k = 0; k < l->n; k++) l->cells += (double)l->cube[k].cells;
    }
    f->bad[i] = vg_load_index(l, 1, NULL) < 0;
  }
}

static int finish(struct vg_load *l, size_t n, double *volume, int threads)
{
  struct finish f = { l, volume, vg_calloc(n, sizeof *f.bad) };
  int bad = f.bad == NULL;

  if (f.bad) vg_parallel_for(threads, n, 1, finish_part, &f);
  for (size_t i = 0; f.bad && i < n; i++) bad |= f.bad[i];
  free(f.bad);
  return bad;
}

vg_status vg_load_split_blocks(const struct vg_load *parent, const int n[3],
                               const double *const at[3], double reach,
                               double correction, int threads,
                               struct vg_load *out, struct vg_error *err)
{
  struct deal d = { .parent = parent, .n = n, .at = at, .reach = reach,
                    .correction = correction };
  struct vg_load *made = deal_out(&d, threads);

  if (!made || finish(made, d.n_block, NULL, threads)) {
    release_all(made, made ? d.n_block : 0);
    return vg_fail_memory(err, "the estimate of cells");
  }
  memcpy(out, made, d.n_block * sizeof *out);
  free(made);
  return VG_OK;
}

/* --- children ------------------------------------------------------------ */

#define MANY SIZE_MAX        /* in more than one block */

struct family {
  struct deal d;
  const struct vg_void *child;
  size_t n;
  size_t *block;             /* [n] a child's, or MANY */
  double *volume;            /* [n] */
  size_t *n_child;           /* [n_block] in the block alone */
};

/* Between which planes is [lo, hi]? -1: on both sides of one. */
static int place(const struct deal *d, int axis, double lo, double hi)
{
  int k = 0;

  while (k < d->n[axis] && d->at[axis][k] <= lo) k++;
  return k < d->n[axis] && hi > d->at[axis][k] ? -1 : k;
}

static void measure_part(void *context, size_t first, size_t end, int worker)
{
  struct family *f = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    double lo[3], hi[3];
    size_t block = 0, stride = 1;

    f->volume[i] = vg_load_volume(&f->child[i]);
    vg_load_box(&f->child[i], lo, hi);
    for (int k = 0; k < 3 && block != MANY; k++) {
      const int at = place(&f->d, k, lo[k], hi[k]);

      if (at < 0) block = MANY;
      else block += stride * (size_t)at;
      stride *= (size_t)f->d.n[k] + 1;
    }
    f->block[i] = f->child[i].n_face ? block : MANY;
  }
}

/* All children that are given `block`, by their fronts, out of a load. */
static vg_status by_front(const struct family *f, size_t block,
                          const struct vg_load *from, double correction,
                          struct vg_load *out, struct vg_error *err)
{
  struct vg_void *v = vg_alloc(f->n, sizeof *v);
  struct vg_load *part = vg_calloc(f->n, sizeof *part);
  size_t n = 0;
  vg_status st = VG_OK;

  if (!v || !part) st = vg_fail_memory(err, "the estimate of cells");
  for (size_t i = 0; st == VG_OK && i < f->n; i++)
    if (f->block[i] == block) v[n++] = f->child[i];
  if (st == VG_OK && n)
    st = vg_load_split(from, n, v, correction, part, err);
  for (size_t i = 0, k = 0; st == VG_OK && k < n; i++)
    if (f->block[i] == block) out[i] = part[k++];
  free(v);
  free(part);
  return st;
}

/* Give blocks to children that are alone in them; share out the rest. */
static vg_status hand_out(struct family *f, struct vg_load *made,
                          struct vg_load *out, struct vg_error *err)
{
  vg_status st = by_front(f, MANY, f->d.parent, f->d.correction, out, err);

  for (size_t i = 0; st == VG_OK && i < f->n; i++) {
    const size_t b = f->block[i];

    if (b == MANY || f->n_child[b] == 1) continue;
    if (f->n_child[b] > 1) st = by_front(f, b, &made[b], 1, out, err);
    f->n_child[b] = 0;             /* done, for all of them */
  }
  for (size_t i = 0; st == VG_OK && i < f->n; i++) {
    const size_t b = f->block[i];

    if (b == MANY || f->n_child[b] != 1) continue;
    out[i] = made[b];
    memset(&made[b], 0, sizeof made[b]);
  }
  return st;
}

vg_status vg_load_split_lattice(const struct vg_load *parent, const int n[3],
                                const double *const at[3], size_t n_child,
                                const struct vg_void *child,
                                double correction, int threads,
                                struct vg_load *out, struct vg_error *err)
{
  struct family f = { .d = { .parent = parent, .n = n, .at = at,
                             .reach = ZONE_REACH, .correction = correction },
                      .child = child, .n = n_child };
  struct vg_load *made = deal_out(&f.d, threads);
  struct vg_load *part = vg_calloc(n_child, sizeof *part);
  vg_status st = VG_OK;

  f.block = vg_alloc(n_child, sizeof *f.block);
  f.volume = vg_alloc(n_child, sizeof *f.volume);
  f.n_child = vg_calloc(f.d.n_block, sizeof *f.n_child);
  if (!made || !part || !f.block || !f.volume || !f.n_child) {
    st = vg_fail_memory(err, "the estimate of cells");
    goto done;
  }
  vg_parallel_for(threads, n_child, 1, measure_part, &f);
  for (size_t i = 0; i < n_child; i++) {
    if (f.block[i] != MANY && !made[f.block[i]].n) f.block[i] = MANY;
    if (f.block[i] != MANY) f.n_child[f.block[i]]++;
  }
  VG_TRY(hand_out(&f, made, part, err));
  if (finish(part, n_child, f.volume, threads)) {
    st = vg_fail_memory(err, "the estimate of cells");
    goto done;
  }
  memcpy(out, part, n_child * sizeof *out);
  memset(part, 0, n_child * sizeof *part);
done:
  release_all(part, part ? n_child : 0);
  release_all(made, made ? f.d.n_block : 0);
  free(f.block);
  free(f.volume);
  free(f.n_child);
  return st;
}
