#include "core/sizing_octree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"

/* The octree is made level by level. A cell is split where trilinear
 * interpolation between its corners would miss the field by more than
 * TOLERANCE, but not below the size found in it (FLOOR of it, adjusted to the
 * growth rate): there the field varies by a few per cent only.
 *
 * A split makes up to 19 new points: middles of 12 edges and 6 faces, and the
 * centre. A middle that is a corner of all cells around it is sampled; one
 * that is not, because a neighbour is not split, hangs: it takes the mean of
 * the ends of its edge or the corners of its face, which is what the
 * neighbour's interpolation gives there, so the result is continuous. Parents
 * of a hanging point are older points, so one pass in order settles all. */
#define TOLERANCE 0.03
#define FLOOR 1.25
#define SLOPPY_POINT 0.004
#define SLOPPY_BOX 0.02
#define POINT_MAX (UINT32_MAX - 1)
#define TOP (1u << VG_OCTREE_DEPTH)
#define GRAIN 128       /* cells or points that a thread takes at a time */

struct cell {
  uint32_t at[3];       /* lower corner, in units of the finest cell */
  uint32_t corner[8];   /* points */
  uint32_t child;       /* first of eight; 0: leaf */
  uint32_t hint;        /* for the search of near samples */
  float floor;          /* no value within is smaller */
};

struct point {
  uint32_t at[3];       /* in units of the finest cell */
  uint32_t parent[4];   /* of a middle: ends of the edge, corners of the face */
  uint32_t hint;
  float h;              /* NAN until known */
  uint8_t n_parent;     /* 0: corner of the root or centre; 2 or 4 */
  uint8_t n_cell;       /* split cells that have it as a middle */
  uint8_t hangs;
};

struct build {
  const struct vg_field *f;
  struct cell *cell;
  struct point *point;
  float *source;        /* [n_point] sources alone; NULL where not needed */
  /* Hash table of the points of a level, 0: free, else index + 1. A middle
   * is odd in units of its level's half side, so no older point is there. */
  uint32_t *slot;
  size_t first_point;   /* of the level */
  size_t n_cell, n_point, cap_cell, cap_point, n_slot, max_cell;
  double lo[3], unit, floor;
  int threads;
};

/* The field. */

static double clamp(const struct vg_field *f, double h)
{
  h = h < f->h_max ? h : f->h_max;
  return h > f->h_min ? h : f->h_min;
}

/* The surface's bounds applied to the sources' size at x. The upper bound is
 * only searched below what is there already, which spares most of it. */
static double combine(const struct vg_field *f, const double x[3],
                      double source, uint32_t *hint)
{
  double h = source < f->h_max ? source : f->h_max;

  if (f->near) {
    if (source < f->h_max) h = vg_near_below(f->near, x, h, SLOPPY_POINT);
    h = vg_near_above(f->near, x, x, h, SLOPPY_POINT, hint);
  }
  return clamp(f, h);
}

double vg_field_at(const struct vg_field *f, const double x[3],
                   uint32_t *hint)
{
  return combine(f, x, vg_source_at(&f->set, x), hint);
}

/* Lower bound of the field within a cube, but for SLOPPY_BOX of it; of VGRID's
 * mean an estimate from the centre, which is good in a cube that resolves its
 * sources. */
static double field_floor(const struct vg_field *f, const double lo[3],
                          double side, uint32_t *hint)
{
  double hi[3], mid[3], h;

  for (int k = 0; k < 3; k++) {
    hi[k] = lo[k] + side;
    mid[k] = lo[k] + 0.5 * side;
  }
  h = vg_source_floor(&f->set, lo, hi);
  if (f->set.n_mean) {
    double mean = vg_source_mean(f->set.n_mean, f->set.mean, mid);

    h = mean < h ? mean : h;
  }
  if (f->near && h < f->h_max) {
    double fall = 0.8660254037844387 * side * f->slope;

    h = vg_near_below(f->near, mid, h + fall, SLOPPY_BOX) - fall;
  }
  h = h < f->h_max ? h : f->h_max;
  if (f->near) h = vg_near_above(f->near, lo, hi, h, SLOPPY_BOX, hint);
  return clamp(f, h);
}

/* Points. */

static void point_place(const struct build *b, const struct point *p,
                        double x[3])
{
  for (int k = 0; k < 3; k++) x[k] = b->lo[k] + p->at[k] * b->unit;
}

static size_t hash(const struct build *b, const uint32_t at[3])
{
  uint64_t v = (uint64_t)at[0] * 0x9e3779b97f4a7c15ull;

  v = (v ^ v >> 29 ^ at[1]) * 0xbf58476d1ce4e5b9ull;
  v = (v ^ v >> 32 ^ at[2]) * 0x94d049bb133111ebull;
  return (size_t)(v >> 24) & (b->n_slot - 1);
}

static void enter(struct build *b, size_t index)
{
  size_t s = hash(b, b->point[index].at);

  while (b->slot[s]) s = (s + 1) & (b->n_slot - 1);
  b->slot[s] = (uint32_t)index + 1;
}

/* Room for n points of the level without more than half of it taken. */
static int grow_table(struct build *b, size_t n)
{
  size_t n_slot = b->n_slot ? b->n_slot : 64;
  uint32_t *slot;

  while (n_slot < 2 * n) n_slot *= 2;
  slot = vg_calloc(n_slot, sizeof *slot);
  if (!slot) return -1;
  free(b->slot);
  b->slot = slot;
  b->n_slot = n_slot;
  for (size_t i = b->first_point; i < b->n_point; i++) enter(b, i);
  return 0;
}

/* An empty table for a level where n cells are split; where all neighbours
 * are, that makes seven points each. */
static int start_level(struct build *b, size_t n)
{
  free(b->slot);
  b->slot = NULL;
  b->n_slot = 0;
  b->first_point = b->n_point;
  return grow_table(b, 8 * n + 19);
}

/* Index of the point at a lattice position, made when it is new; UINT32_MAX
 * when memory is refused. */
static uint32_t find_point(struct build *b, const uint32_t at[3])
{
  struct point *p;
  size_t s;

  if (2 * (b->n_point + 1 - b->first_point) > b->n_slot &&
      grow_table(b, b->n_slot))
    return UINT32_MAX;
  for (s = hash(b, at); b->slot[s]; s = (s + 1) & (b->n_slot - 1))
    if (!memcmp(b->point[b->slot[s] - 1].at, at, sizeof p->at))
      return b->slot[s] - 1;
  if (b->n_point >= POINT_MAX ||
      vg_reserve(&b->point, &b->cap_point, b->n_point + 1, sizeof *b->point))
    return UINT32_MAX;
  p = b->point + b->n_point;
  memset(p, 0, sizeof *p);
  memcpy(p->at, at, sizeof p->at);
  p->h = NAN;
  b->slot[s] = (uint32_t)++b->n_point;
  return b->slot[s] - 1;
}

/* Decisions. */

static float sample(const struct build *b, const struct cell *c, double side,
                    const double at[3])
{
  uint32_t hint = c->hint;
  double x[3];

  for (int k = 0; k < 3; k++)
    x[k] = b->lo[k] + c->at[k] * b->unit + at[k] * side;
  return (float)vg_field_at(b->f, x, &hint);
}

/* Mean of the corners that lie on face (axis, end); of all where axis < 0. */
static float corner_mean(const float h[8], int axis, int end)
{
  float sum = 0;

  for (int i = 0; i < 8; i++)
    if (axis < 0 || (i >> axis & 1) == end) sum += h[i];
  return axis < 0 ? sum / 8 : sum / 4;
}

static int misses(float interpolated, float exact)
{
  return fabsf(interpolated - exact) > (float)TOLERANCE * exact;
}

/* Samples of the centre [0] and the faces [1..6] of a cell, NAN where the
 * first miss made the others needless. */
static int test_cell(const struct build *b, const struct cell *c, double side,
                     const float h[8], float test[7])
{
  double at[3] = { 0.5, 0.5, 0.5 };

  test[0] = sample(b, c, side, at);
  if (misses(corner_mean(h, -1, 0), test[0])) return 1;
  for (int i = 0; i < 6; i++) {
    at[0] = at[1] = at[2] = 0.5;
    at[i / 2] = i % 2;
    test[i + 1] = sample(b, c, side, at);
    if (misses(corner_mean(h, i / 2, i % 2), test[i + 1])) return 1;
  }
  return 0;
}

static int wants_split(const struct build *b, struct cell *c, double side,
                       float test[7])
{
  float h[8], low = INFINITY;
  double lo[3], hi[3];

  for (int k = 0; k < 7; k++) test[k] = NAN;
  if (side <= b->floor * (double)c->floor) return 0;
  for (int k = 0; k < 3; k++) {
    lo[k] = b->lo[k] + c->at[k] * b->unit;
    hi[k] = lo[k] + side;
  }
  c->floor = (float)field_floor(b->f, lo, side, &c->hint);
  if (side <= b->floor * (double)c->floor) return 0;
  if (!b->f->set.n_mean && b->f->h_max <= c->floor * (1 + TOLERANCE))
    return 0;
  for (int i = 0; i < 8; i++) {
    h[i] = b->point[c->corner[i]].h;
    if (h[i] < low) low = h[i];
  }
  if (low > c->floor * (1 + 2 * TOLERANCE)) return 1;
  if (!vg_source_resolved(&b->f->set, lo, hi, side)) return 1;
  return test_cell(b, c, side, h, test);
}

/* Splitting. */

/* Point i of the 3 x 3 x 3 lattice of a cell, x fastest; corners have only
 * even coordinates. Parents of a middle are what its odd coordinates span. */
static uint32_t make_point(struct build *b, const struct cell *c,
                           uint32_t half, int i)
{
  const int at[3] = { i % 3, i / 3 % 3, i / 9 };
  uint32_t q[3], n = 0, index;
  struct point *p;
  int odd = 0;

  for (int k = 0; k < 3; k++) {
    q[k] = c->at[k] + half * (uint32_t)at[k];
    odd += at[k] == 1;
  }
  if (!odd)
    return c->corner[at[0] / 2 + at[1] / 2 * 2 + at[2] / 2 * 4];
  index = find_point(b, q);
  if (index == UINT32_MAX) return index;
  p = b->point + index;
  if (!p->n_cell++) p->hint = c->hint;
  if (p->n_parent || odd == 3) return index;
  for (int j = 0; j < 8 && n < 4; j++) {
    int on = 1;

    for (int k = 0; k < 3; k++)
      on = on && (at[k] == 1 || at[k] / 2 == (j >> k & 1));
    if (on) p->parent[n++] = c->corner[j];
  }
  p->n_parent = (uint8_t)n;
  return index;
}

/* Where the points of a cell will be looked for is far apart in memory: have
 * all of it fetched at once. */
static void fetch_points(const struct build *b, const struct cell *c,
                         uint32_t half)
{
  size_t at[19];
  int n = 0;

  for (int i = 1; i < 26; i++) {
    uint32_t q[3] = { c->at[0] + half * (uint32_t)(i % 3),
                      c->at[1] + half * (uint32_t)(i / 3 % 3),
                      c->at[2] + half * (uint32_t)(i / 9) };

    if (i % 3 != 1 && i / 3 % 3 != 1 && i / 9 != 1) continue;
    at[n] = hash(b, q);
    __builtin_prefetch(b->slot + at[n++]);
  }
  while (n--)
    if (b->slot[at[n]]) __builtin_prefetch(b->point + b->slot[at[n]] - 1);
}

static int split(struct build *b, size_t index, uint32_t half,
                 const float test[7])
{
  static const int tested[7] = { 13, 12, 14, 10, 16, 4, 22 };
  struct cell c = b->cell[index];
  uint32_t id[27];

  fetch_points(b, &c, half);
  for (int i = 0; i < 27; i++)
    if ((id[i] = make_point(b, &c, half, i)) == UINT32_MAX) return -1;
  for (int i = 0; i < 7; i++)
    if (test[i] == test[i]) b->point[id[tested[i]]].h = test[i];
  if (vg_reserve(&b->cell, &b->cap_cell, b->n_cell + 8, sizeof *b->cell))
    return -1;
  b->cell[index].child = (uint32_t)b->n_cell;
  for (int j = 0; j < 8; j++) {
    struct cell *d = b->cell + b->n_cell++;
    int base = (j & 1) + (j >> 1 & 1) * 3 + (j >> 2) * 9;

    *d = c;
    d->child = 0;
    for (int k = 0; k < 3; k++) d->at[k] += half * (uint32_t)(j >> k & 1);
    for (int i = 0; i < 8; i++)
      d->corner[i] = id[base + (i & 1) + (i >> 1 & 1) * 3 + (i >> 2) * 9];
  }
  return 0;
}

/* Cells that have a middle in common when all of them are split. */
static unsigned full_count(const struct point *p)
{
  unsigned n = p->n_parent == 2 ? 4 : p->n_parent == 4 ? 2 : 1;
  unsigned on_side = 0;

  if (!p->n_parent) return 0;
  for (int k = 0; k < 3; k++) on_side += p->at[k] == 0 || p->at[k] == TOP;
  return n >> on_side;
}

/* Parents are corners of cells that this level has split: points of levels
 * before, known by now. So points need not wait for each other. */
static void settle_body(void *context, size_t first, size_t end, int worker)
{
  struct build *b = context;

  (void)worker;
  for (size_t i = b->first_point + first; i < b->first_point + end; i++) {
    struct point *p = b->point + i;
    double x[3], sum = 0;

    p->hangs = p->n_cell < full_count(p);
    if (p->hangs) {
      for (int k = 0; k < p->n_parent; k++)
        sum += (double)b->point[p->parent[k]].h;
      p->h = (float)(sum / p->n_parent);
    } else if (!(p->h == p->h)) {
      point_place(b, p, x);
      p->h = (float)vg_field_at(b->f, x, &p->hint);
    }
  }
}

/* The points of the level. */
static void settle(struct build *b)
{
  vg_parallel_for(b->threads, b->n_point - b->first_point, GRAIN, settle_body,
                  b);
}

/* A level: cells from first on. */
struct level {
  struct build *b;
  size_t first;
  double side;
  uint8_t *mark;        /* by cell: split */
  float (*test)[7];
};

static void decide_body(void *context, size_t first, size_t end, int worker)
{
  const struct level *l = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    l->mark[i] = (uint8_t)wants_split(l->b, l->b->cell + l->first + i,
                                      l->side, l->test[i]);
}

/* Which of the cells first..last are split. Where the tree would become too
 * large for its limit the floor rises: a coarser field, but one that covers
 * everything alike. */
static size_t decide(struct level *l, size_t last)
{
  struct build *b = l->b;
  size_t n = 0;

  vg_parallel_for(b->threads, last - l->first, GRAIN, decide_body, l);
  for (size_t i = 0; i < last - l->first; i++) n += l->mark[i];
  while (n && last + 8 * n > b->max_cell) {
    b->floor *= 1.25;
    n = 0;
    for (size_t i = 0; i < last - l->first; i++) {
      if (l->side <= b->floor * (double)b->cell[l->first + i].floor)
        l->mark[i] = 0;
      n += l->mark[i];
    }
  }
  return n;
}

static int split_level(struct level *l, uint32_t half, size_t last)
{
  size_t n = decide(l, last);

  if (start_level(l->b, n)) return -1;
  for (size_t i = 0; n && i < last - l->first; i++)
    if (l->mark[i] && split(l->b, l->first + i, half, l->test[i])) return -1;
  settle(l->b);
  return 0;
}

static int grow_level(struct build *b, int level, size_t first, size_t last)
{
  struct level l = { b, first, b->unit * (TOP >> level),
                     vg_alloc(last - first, sizeof *l.mark),
                     vg_alloc(last - first, sizeof *l.test) };
  int bad = !l.mark || !l.test ||
            split_level(&l, TOP >> (level + 1), last);

  free(l.mark);
  free(l.test);
  return bad ? -1 : 0;
}

static int grow(struct build *b)
{
  size_t first = 0, last = 1;

  if (vg_reserve(&b->cell, &b->cap_cell, 1, sizeof *b->cell)) return -1;
  memset(b->cell, 0, sizeof *b->cell);
  b->n_cell = 1;
  if (start_level(b, 1)) return -1;
  for (int i = 0; i < 8; i++) {
    uint32_t at[3] = { (i & 1) * TOP, (i >> 1 & 1) * TOP, (i >> 2) * TOP };

    b->cell->corner[i] = find_point(b, at);
    if (b->cell->corner[i] == UINT32_MAX) return -1;
  }
  settle(b);
  for (int level = 0; level < VG_OCTREE_DEPTH && first < last; level++) {
    if (grow_level(b, level, first, last)) return -1;
    first = last;
    last = b->n_cell;
  }
  return 0;
}

/* Gradient. Laws of sources may be steeper than the growth rate, so their
 * values at the points are lowered until no two corners of a leaf differ by
 * more than the slope times their distance. Lowering is monotone: whatever
 * the order, it ends in the same greatest values that satisfy all. */

static int lower_corners(const struct build *b, const struct cell *c,
                         double side)
{
  static const unsigned char apart[8] = { 0, 1, 1, 2, 1, 2, 2, 3 };
  float reach[4], h[8], low = INFINITY, high = 0;
  int changed = 0;

  for (int k = 0; k < 4; k++)
    reach[k] = (float)(b->f->slope * side * sqrt((double)k));
  for (int i = 0; i < 8; i++) {
    h[i] = b->source[c->corner[i]];
    low = h[i] < low ? h[i] : low;
    high = h[i] > high ? h[i] : high;
  }
  if (high <= low + reach[1]) return 0;
  for (int i = 0; i < 8; i++)
    for (int j = 0; j < 8; j++) {
      float most = h[i] + reach[apart[i ^ j]];

      if (h[j] <= most) continue;
      h[j] = most;
      changed = 1;
    }
  for (int i = 0; changed && i < 8; i++) b->source[c->corner[i]] = h[i];
  return changed;
}

static int sweep(const struct build *b, uint32_t at, double side, int flip)
{
  const struct cell *c = b->cell + at;
  int changed = 0;

  if (!c->child) return lower_corners(b, c, side);
  for (uint32_t j = 0; j < 8; j++)
    changed |= sweep(b, c->child + (flip ? 7 - j : j), 0.5 * side, flip);
  return changed;
}

static void source_body(void *context, size_t first, size_t end, int worker)
{
  struct build *b = context;
  double x[3];

  (void)worker;
  for (size_t i = first; i < end; i++) {
    point_place(b, b->point + i, x);
    b->source[i] = (float)clamp(b->f, vg_source_at(&b->f->set, x));
  }
}

struct lowered {
  struct build *b;
  const float *before;
};

static void renew_body(void *context, size_t first, size_t end, int worker)
{
  const struct lowered *l = context;
  struct build *b = l->b;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct point *p = b->point + i;
    double x[3];

    if (p->hangs || b->source[i] == l->before[i]) continue;
    point_place(b, p, x);
    p->h = (float)combine(b->f, x, (double)b->source[i], &p->hint);
  }
}

/* The field at points whose sources were lowered, and at hanging ones, whose
 * parents may hang too: in order. */
static void renew(struct build *b, const float *before)
{
  struct lowered l = { b, before };

  vg_parallel_for(b->threads, b->n_point, GRAIN, renew_body, &l);
  for (size_t i = 0; i < b->n_point; i++) {
    struct point *p = b->point + i;
    double sum = 0;

    if (!p->hangs) continue;
    for (int k = 0; k < p->n_parent; k++)
      sum += (double)b->point[p->parent[k]].h;
    p->h = (float)(sum / p->n_parent);
  }
}

static int limit_gradient(struct build *b)
{
  float *before = vg_alloc(b->n_point, sizeof *before);
  int flip = 0, any = 0;

  b->source = vg_alloc(b->n_point, sizeof *b->source);
  if (!b->source || !before) {
    free(before);
    return -1;
  }
  vg_parallel_for(b->threads, b->n_point, GRAIN, source_body, b);
  memcpy(before, b->source, b->n_point * sizeof *before);
  while (sweep(b, 0, b->unit * TOP, flip)) {
    flip = !flip;
    any = 1;
  }
  if (any) renew(b, before);
  free(before);
  return 0;
}

/* The compact tree, in depth-first order: near in space, near in memory. */

static uint32_t emit(const struct build *b, uint32_t at, struct vg_octree *t)
{
  const struct cell *c = b->cell + at;
  size_t index;

  if (!c->child) {
    for (int i = 0; i < 8; i++)
      t->leaf[t->n_leaf][i] = b->point[c->corner[i]].h;
    return VG_OCTREE_LEAF | (uint32_t)t->n_leaf++;
  }
  index = t->n_split++;
  for (uint32_t j = 0; j < 8; j++)
    t->child[index][j] = emit(b, c->child + j, t);
  return (uint32_t)index;
}

static int compact(const struct build *b, struct vg_octree *t)
{
  size_t n_split = b->n_cell / 8;

  t->child = vg_alloc(n_split, sizeof *t->child);
  t->leaf = vg_alloc(b->n_cell - n_split, sizeof *t->leaf);
  if (!t->child || !t->leaf) return -1;
  t->root = emit(b, 0, t);
  return 0;
}

vg_status vg_octree_build(const struct vg_field *f, const double lo[3],
                          double side, size_t max_leaf, int threads,
                          struct vg_octree *out, struct vg_error *err)
{
  struct build b = { .f = f, .unit = side / TOP, .max_cell = max_leaf,
                     .threads = threads };
  int bad;

  if (b.max_cell > VG_OCTREE_LEAF / 2) b.max_cell = VG_OCTREE_LEAF / 2;
  b.floor = FLOOR * sqrt(0.2 / f->slope);
  if (b.floor > 2) b.floor = 2;
  for (int k = 0; k < 3; k++) b.lo[k] = out->lo[k] = lo[k];
  out->side = side;
  bad = grow(&b);
  if (!bad && f->set.n_bounded + f->set.n_mean) bad = limit_gradient(&b);
  if (!bad) bad = compact(&b, out);
  free(b.cell);
  free(b.point);
  free(b.source);
  free(b.slot);
  if (!bad) return VG_OK;
  vg_octree_release(out);
  return vg_fail_memory(err, "the octree of sizes");
}

void vg_octree_release(struct vg_octree *t)
{
  free(t->child);
  free(t->leaf);
  memset(t, 0, sizeof *t);
}

/* Evaluation. */

double vg_octree_at(const struct vg_octree *t, const double x[3],
                    double *outside)
{
  double f[3], d2 = 0, scale = 1, a, b, c, d;
  uint32_t at[3], e = t->root;
  int bit = VG_OCTREE_DEPTH;
  const float *h;

  for (int k = 0; k < 3; k++) {
    double u = (x[k] - t->lo[k]) / t->side, v = u > 0 ? u < 1 ? u : 1 : 0;

    d2 += (u - v) * (u - v);
    f[k] = v;
    at[k] = (uint32_t)(v * TOP);
    if (at[k] >= TOP) at[k] = TOP - 1;
  }
  while (!(e & VG_OCTREE_LEAF)) {
    bit--;
    e = t->child[e][(at[0] >> bit & 1) | (at[1] >> bit & 1) << 1 |
                    (at[2] >> bit & 1) << 2];
  }
  scale = (double)(TOP >> bit);
  for (int k = 0; k < 3; k++) f[k] = f[k] * scale - (double)(at[k] >> bit);
  h = t->leaf[e & ~VG_OCTREE_LEAF];
  a = (double)h[0] + f[0] * ((double)h[1] - (double)h[0]);
  b = (double)h[2] + f[0] * ((double)h[3] - (double)h[2]);
  c = (double)h[4] + f[0] * ((double)h[5] - (double)h[4]);
  d = (double)h[6] + f[0] * ((double)h[7] - (double)h[6]);
  a += f[1] * (b - a);
  c += f[1] * (d - c);
  *outside = d2 > 0 ? sqrt(d2) * t->side : 0;
  return a + f[2] * (c - a);
}
