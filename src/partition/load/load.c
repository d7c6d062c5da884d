/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: an octree is refined until its nodes are a few target edges wide.
 * Nodes that are completely outside are dropped immediately. Several threads
 * process branches, whose octants are joined in the order of the tree. */
#include "partition/load/load.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "partition/load/load_tree.h"

/* Width limit of an octant in target edges, without and with the front passing.
 */
#define WIDE_FREE 3.0 /* C14 */
#define WIDE_FRONT 2.0
/* In large meshes the limits are raised to have about MANY_OCTANTS octants, or
 * one per EDGES_MOST cubes of the target edge. The mesh size is estimated from
 * nodes of width WIDE_ROUGH. A leaf fills the share FILLED of the cube of its
 * width limit on average. */
#define MANY_OCTANTS 40000.0
#define EDGES_MOST 280.0
#define WIDE_ROUGH 12.0
#define FILLED 0.35
/* More octants, of 2,500 cells each, indicate an error in the sizes. */
#define OCTANTS_MOST 4000000
/* With fewer octants than this, narrower ones are tried, down to LEAST edges.
 */
#define FEW_OCTANTS 64
#define LEAST 1.0
/* From this gradient on, VG_LOAD_GRADED applies in full. */
#define GRADIENT 0.05 /* C15 */
/* If h changes by more than this times itself across an octant, the density is
 * summed over the parts of the octant, to this depth. */
#define STEEP 1.2 /* C16 */
#define STEEP_DEPTH 4
/* A sizing field whose gradient exceeds HIDES can have small edges that no
 * sample of an octant meets. Such an octant is refined while its smallest h is
 * below the share HIDDEN of the mean. */
#define HIDES 0.5
#define HIDDEN 0.5
/* Parts narrower than this many of their smallest edges are never divided. */
#define CLOSE 0.25
/* Cells next to a front have its edge length. Away from the front they grow by
 * no more than this per length, however fast the sizing field grows. */
#define PACE 1.5
/* Between this gradient and PACE, the share that VG_LOAD_GRADED adds falls to
 * zero. */
#define PACE_FROM 1.0
/* Minimum of cells per face of the front, as in meshes where nearly all points
 * are on the front. */
#define CELLS_PER_FACE 1.5
/* An octant with more triangles than this contains details that its density
 * need not resolve. */
#define CROWD 400
/* Positions of the root octant that are tried when volumes do not agree. */
#define PLACES 3

/* --- octants of a branch ---------------------------------------------------
 */

struct octants {
  size_t n, cap;
  struct vg_load_octant *octant;
};

struct maker {
  const struct vg_load_tree *tree;
  const struct vg_sizing *sizing;
  /* Sizes that cells next to the front can follow, where the sizing field
   * is steeper; else NULL. */
  const struct vg_sizing *pace;
  int is_steep; /* 1: the sizing field has steep gradients. */
  int is_stretched;
  double per_cube;
  double narrow, wide; /* Divisor and factor of the width limits. */
  size_t n_branch, cap_branch, large;
  _Atomic size_t *emitted; /* Octants of all branches. */
  struct branch {
    struct vg_load_node node;
    uint32_t *item; /* [node.n] */
    struct octants out;
    double crossed; /* Sum of squared volumes of the crossed octants. */
    int refused;
  } * branch;
};

/* Of a node: mean of 1 / h^3, the same with the correction for the gradient,
 * and the gradient. */
struct density {
  double cubes, cells, slope;
};

static double edge_at(const struct maker *m, const double x[3])
{
  const double h = vg_sizing_at(m->sizing, x);

  return m->pace ? fmin(h, vg_sizing_at(m->pace, x)) : h;
}

/* Density in an octant around mid, by a four-point rule that is exact for
 * quadratics. */
static struct density density_around(const struct maker *m, const double mid[3],
                                     double half)
{
  static const int sign[4][3] = {
    { 1, 1, 1 }, { 1, -1, -1 }, { -1, 1, -1 }, { -1, -1, 1 }
  };
  const double off = 0.57735026918962576 * half;
  double sum = 0, g[3] = { 0, 0, 0 }, gg = 0, slope, graded;

  for (int i = 0; i < 4; i++) {
    double x[3], h;

    for (int k = 0; k < 3; k++) x[k] = mid[k] + sign[i][k] * off;
    h = edge_at(m, x);
    sum += 1 / (h * h * h);
    for (int k = 0; k < 3; k++) g[k] += sign[i][k] * h;
  }
  for (int k = 0; k < 3; k++) gg += g[k] * g[k];
  slope = sqrt(gg) / (4 * off);
  sum /= 4;
  graded = m->is_stretched
           ? 0
           : fmin(slope / GRADIENT, 1) *
               fmax(0, fmin((PACE - slope) / (PACE - PACE_FROM), 1));
  return (struct density){ sum, sum * (1 + VG_LOAD_GRADED * graded), slope };
}

/* Centre of a node; returns half its side. */
static double middle_of(const struct maker *m, const struct vg_load_node *node,
                        double mid[3])
{
  const struct vg_load_tree *t = m->tree;
  const double half = 0.5 * vg_load_side(node) * t->unit;

  for (int k = 0; k < 3; k++) mid[k] = t->lo[k] + node->at[k] * t->unit + half;
  return half;
}

static struct density mean_density(const struct maker *m,
                                   const struct vg_load_node *node)
{
  double mid[3], half = middle_of(m, node, mid);

  return density_around(m, mid, half);
}

/* Is the change of h across an octant so large that the rule misses the cells
 * near its finest end? */
static int is_steep(struct density d, double half)
{
  const double change = 2 * half * d.slope;

  return change * change * change * d.cubes > STEEP * STEEP * STEEP;
}

/* Does an octant contain edges that are much smaller than its density shows,
 * and is it wider than `wide` of them? */
static int hides(const struct maker *m, const double mid[3], double half,
                 double density, double wide)
{
  double lo[3], x[3], least;

  if (!m->is_steep) return 0;
  for (int k = 0; k < 3; k++) lo[k] = mid[k] - half;
  least = vg_sizing_least(m->sizing, lo, 2 * half, x);
  return 2 * half > wide * least &&
         least * least * least * density < HIDDEN * HIDDEN * HIDDEN;
}

/* Density of an octant, summed over its parts. left: cubes of the target edge
 * up to which the sum matters; with more of them the node is divided in any
 * case. */
static struct density add_up(const struct maker *m, const double mid[3],
                             double half, int depth, double *left)
{
  struct density sum = density_around(m, mid, half);

  if (*left < 0 || ((depth <= 0 || !is_steep(sum, half)) &&
                    !hides(m, mid, half, sum.cubes, CLOSE))) {
    *left -= 8 * half * half * half * sum.cubes;
    return sum;
  }
  sum = (struct density){ 0, 0, 0 };
  for (int o = 0; o < 8; o++) {
    struct density d;
    double x[3];

    for (int k = 0; k < 3; k++)
      x[k] = mid[k] + (o >> k & 1 ? 0.5 : -0.5) * half;
    d = add_up(m, x, 0.5 * half, depth - 1, left);
    sum.cubes += d.cubes / 8;
    sum.cells += d.cells / 8;
  }
  return sum;
}

/* Upper limit of the cubes of the target edge in a leaf. */
static double most_in(const struct maker *m, const struct vg_load_node *node)
{
  const double wide = m->wide * (node->n ? WIDE_FRONT : WIDE_FREE) / m->narrow;

  return wide * wide * wide;
}

/* Octant root to single precision, which is sufficient for h. */
static double cube_root(double x)
{
  int e;
  double f = frexp(x, &e), y;

  while (e % 3) {
    f *= 0.5;
    e++;
  }
  y = 0.5 + 0.5 * f;
  for (int i = 0; i < 6; i++) y -= (y - f / (y * y)) / 3;
  return ldexp(y, e / 3);
}

/* Density in an octant with a steep gradient, as the mean over the octants
 * around its inside samples. Returns the number of inside samples. */
static int sample_steep(const struct maker *m, const struct vg_load_node *node,
                        const int32_t owner[VG_LOAD_SAMPLES],
                        struct density *density)
{
  const struct vg_load_tree *t = m->tree;
  const double half = 0.25 * vg_load_side(node) * t->unit;
  struct density sum = { 0, 0, density->slope };
  double left = node->level < VG_LOAD_LEVELS ? 1.01 * most_in(m, node)
                                             : INFINITY;
  int inside = 0;

  for (int i = 0; i < VG_LOAD_SAMPLES; i++) {
    struct density d;
    double x[3];

    if (owner[i] < 1) continue;
    for (int k = 0; k < 3; k++)
      x[k] = t->lo[k] + node->at[k] * t->unit + (i >> k & 1 ? 3 : 1) * half;
    d = add_up(m, x, half, STEEP_DEPTH - 1, &left);
    sum.cubes += d.cubes;
    sum.cells += d.cells;
    inside++;
  }
  if (inside) {
    sum.cubes /= inside;
    sum.cells /= inside;
    *density = sum;
  }
  return inside;
}

/* Samples an octant that the front passes through: returns the number of inside
 * samples, and the density at them. Unbiased for octants of any width. */
static int sample(const struct maker *m, const struct vg_load_stack *s,
                  const struct vg_load_node *node, struct density *density)
{
  const struct vg_load_tree *t = m->tree;
  const double more = density->cells / density->cubes;
  int32_t owner[VG_LOAD_SAMPLES] = { 1, 1, 1, 1, 1, 1, 1, 1 };
  uint32_t at[3];
  double sum = 0, mid[3], half;
  int inside = 0;

  if (node->n) vg_load_sample(t, s, node, owner, at);
  half = middle_of(m, node, mid);
  if (is_steep(*density, half) || hides(m, mid, half, density->cubes, CLOSE))
    return sample_steep(m, node, owner, density);
  if (!node->n) return VG_LOAD_SAMPLES;
  for (int i = 0; i < VG_LOAD_SAMPLES; i++) {
    double x[3], h;

    if (owner[i] < 1) continue;
    for (int k = 0; k < 3; k++) {
      const uint32_t p = at[k] + (i >> k & 1 ? vg_load_side(node) / 2 : 0);

      x[k] = t->lo[k] + p * t->unit;
    }
    h = edge_at(m, x);
    sum += 1 / (h * h * h);
    inside++;
  }
  if (inside) {
    density->cubes = sum / inside;
    density->cells = more * density->cubes;
  }
  return inside;
}

/* Distances across the axes, in proportion to those at the centre. */
static void set_across(const struct maker *m, const double mid[3],
                       struct vg_load_octant *c)
{
  for (int k = 0; k < 3; k++) {
    const double axis[3] = { k == 0, k == 1, k == 2 };

    c->across[k] = c->h;
    if (vg_sizing_is_stretched(m->sizing))
      c->across[k] *= (float)(vg_sizing_across(m->sizing, mid, axis) /
                              vg_sizing_at(m->sizing, mid));
  }
}

static int emit(const struct maker *m, struct branch *b,
                const struct vg_load_node *node, struct density density,
                int inside)
{
  const struct vg_load_tree *t = m->tree;
  const double side = vg_load_side(node) * t->unit;
  const double volume = side * side * side;
  struct vg_load_octant *c;
  double mid[3];

  if (node->n) b->crossed += volume * volume;
  if (!inside) return 0;
  if (atomic_fetch_add(m->emitted, 1) >= OCTANTS_MOST) return -1;
  if (vg_reserve(&b->out.octant, &b->out.cap, b->out.n + 1, sizeof *c))
    return -1;
  c = &b->out.octant[b->out.n++];
  middle_of(m, node, mid);
  for (int k = 0; k < 3; k++) c->at[k] = (float)mid[k];
  c->half = (float)(0.5 * side);
  c->h = (float)(1 / cube_root(density.cubes));
  set_across(m, mid, c);
  c->part = (float)inside / VG_LOAD_SAMPLES;
  c->cells = (float)(m->per_cube * density.cells * volume * (double)c->part);
  return 0;
}

static int is_leaf(const struct maker *m, const struct vg_load_node *node,
                   double density)
{
  const double side = vg_load_side(node) * m->tree->unit;

  return node->level >= VG_LOAD_LEVELS ||
         (node->n <= CROWD && side * side * side * density <= most_in(m, node));
}

static int refine(const struct maker *m, struct branch *b,
                  struct vg_load_stack *s, const struct vg_load_node *node)
{
  const size_t keep = s->n;
  struct vg_load_node part[8];
  struct density density;
  int bad = 0;

  if (!node->n && node->owner < 1) return 0;
  density = mean_density(m, node);
  if (is_leaf(m, node, density.cubes)) {
    const int inside = sample(m, s, node, &density);

    if (is_leaf(m, node, density.cubes))
      return emit(m, b, node, density, inside);
  }
  if (vg_load_octants(m->tree, s, node, part, 1)) return -1;
  for (int o = 0; o < 8 && !bad; o++) bad = refine(m, b, s, &part[o]);
  s->n = keep;
  return bad;
}

static void refine_part(void *context, size_t first, size_t end, int worker)
{
  const struct maker *m = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct branch *b = &m->branch[i];
    struct vg_load_stack s = VG_LOAD_STACK_INIT;

    s.item = b->item;
    s.n = s.cap = b->node.n;
    b->node.first = 0;
    b->refused = refine(m, b, &s, &b->node);
    b->item = NULL;
    vg_load_stack_release(&s);
  }
}

/* --- branches ------------------------------------------------------------ */

static int add_branch(struct maker *m, const struct vg_load_stack *s,
                      const struct vg_load_node *node)
{
  struct branch *b;

  if (vg_reserve(&m->branch, &m->cap_branch, m->n_branch + 1,
                 sizeof *m->branch))
    return -1;
  b = &m->branch[m->n_branch];
  memset(b, 0, sizeof *b);
  b->node = *node;
  b->item = vg_alloc(node->n, sizeof *b->item);
  if (!b->item) return -1;
  m->n_branch++;
  if (node->n)
    memcpy(b->item, s->item + node->first, node->n * sizeof *b->item);
  return 0;
}

/* Finds branches in the order of the tree, none with a large share of the
 * front. */
static int plan(struct maker *m, struct vg_load_stack *s,
                const struct vg_load_node *node, int threads)
{
  const size_t keep = s->n;
  struct vg_load_node part[8];
  int bad = 0;

  if (!node->n && node->owner < 1) return 0;
  if ((node->n <= m->large && node->level) ||
      is_leaf(m, node, mean_density(m, node).cubes))
    return add_branch(m, s, node);
  if (vg_load_octants(m->tree, s, node, part, threads)) return -1;
  for (int o = 0; o < 8 && !bad; o++) bad = plan(m, s, &part[o], threads);
  s->n = keep;
  return bad;
}

static int plan_all(struct maker *m, int threads)
{
  const size_t n = m->tree->n_tri;
  struct vg_load_stack s = VG_LOAD_STACK_INIT;
  struct vg_load_node root = { .n = n };
  int bad = vg_reserve(&s.item, &s.cap, 2 * n, sizeof *s.item);

  for (size_t i = 0; i < n && !bad; i++) s.item[i] = (uint32_t)i;
  s.n = n;
  if (!bad) bad = plan(m, &s, &root, threads);
  vg_load_stack_release(&s);
  return bad;
}

struct rough_job {
  const struct maker *m;
  double *sum; /* [branch] */
  /* cubes of the target edge found so far; at ROUGH_MOST the search stops,
   * since the width limits would not change any more. */
  _Atomic uint64_t seen;
};
#define ROUGH_MOST (MANY_OCTANTS * EDGES_MOST)

/* Cubes of the target edge in a node, whether inside the void or not. */
static double rough(struct rough_job *job, const struct vg_load_node *node)
{
  const struct maker *m = job->m;
  const double side = vg_load_side(node) * m->tree->unit;
  const double n = mean_density(m, node).cubes * side * side * side;
  struct vg_load_node part = *node;
  double sum = 0, mid[3], half;

  half = middle_of(m, node, mid);
  if (node->level >= VG_LOAD_LEVELS ||
      (n <= WIDE_ROUGH * WIDE_ROUGH * WIDE_ROUGH &&
       !hides(m, mid, half, n / (side * side * side), WIDE_ROUGH))) {
    atomic_fetch_add(&job->seen, (uint64_t)fmin(n, ROUGH_MOST));
    return n;
  }
  part.level++;
  for (int o = 0; o < 8 && (double)job->seen < ROUGH_MOST; o++) {
    for (int k = 0; k < 3; k++)
      part.at[k] = node->at[k] + (o >> k & 1 ? vg_load_side(&part) : 0);
    sum += rough(job, &part);
  }
  return sum;
}

static void rough_part(void *context, size_t first, size_t end, int worker)
{
  struct rough_job *job = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    job->sum[i] = rough(job, &job->m->branch[i].node);
}

/* Chooses the width limits for an acceptable number of octants. */
static int widen(struct maker *m, int threads)
{
  struct rough_job job = { m, vg_alloc(m->n_branch, sizeof *job.sum), 0 };
  double sum = 0, wide;

  if (!job.sum) return -1;
  vg_parallel_for(threads, m->n_branch, 1, rough_part, &job);
  for (size_t i = 0; i < m->n_branch; i++) sum += job.sum[i];
  free(job.sum);
  if ((double)job.seen >= ROUGH_MOST) sum = ROUGH_MOST;
  sum = fmin(sum / MANY_OCTANTS, EDGES_MOST);
  wide = cube_root(sum / FILLED) / WIDE_FREE;
  m->wide = wide > 1 ? wide : 1;
  return 0;
}

/* Joins all octants in order. crossed: see struct branch. */
static int join(const struct maker *m, struct vg_load *out, double *crossed)
{
  size_t n = 0;

  for (size_t i = 0; i < m->n_branch; i++) {
    if (m->branch[i].refused) return -1;
    n += m->branch[i].out.n;
  }
  out->octant = vg_alloc(n, sizeof *out->octant);
  if (!out->octant) return -1;
  out->n = 0;
  *crossed = 0;
  for (size_t i = 0; i < m->n_branch; i++) {
    const struct octants *c = &m->branch[i].out;

    if (c->n) memcpy(out->octant + out->n, c->octant, c->n * sizeof *c->octant);
    out->n += c->n;
    *crossed += m->branch[i].crossed;
  }
  return 0;
}

static int make(struct maker *m, int threads, struct vg_load *out,
                double *crossed)
{
  int bad;

  m->n_branch = 0;
  m->wide = 1;
  *m->emitted = 0;
  bad = plan_all(m, threads) || (m->n_branch && widen(m, threads));
  if (!bad) {
    vg_parallel_for(threads, m->n_branch, 1, refine_part, m);
    bad = join(m, out, crossed);
  }
  for (size_t i = 0; i < m->n_branch; i++) {
    free(m->branch[i].item);
    free(m->branch[i].out.octant);
  }
  return bad;
}

/* --- the complete load --------------------------------------------------- */

/* Places the root octant with margins such that planes of the lattice are
 * unlikely to coincide with planes of the front. */
static void place_root(struct vg_load_tree *t, const double lo[3],
                       const double hi[3], int place)
{
  static const double room[PLACES][3] = { { 0.381966, 0.414214, 0.302776 },
                                          { 0.618034, 0.236068, 0.561553 },
                                          { 0.192582, 0.732051, 0.449490 } };
  double extent = 0, side;
  int e;

  for (int k = 0; k < 3; k++)
    if (hi[k] - lo[k] > extent) extent = hi[k] - lo[k];
  frexp(1.02 * extent, &e);
  side = ldexp(1, e);
  t->unit = ldexp(side, -VG_LOAD_BITS);
  for (int k = 0; k < 3; k++) {
    const double x = lo[k] - (side - (hi[k] - lo[k])) * room[place][k];

    t->lo[k] = floor(x / t->unit) * t->unit;
  }
}

/* A void that no sample has hit gets one octant of its volume. */
static int lone_octant(const struct maker *m, const double lo[3],
                       const double hi[3], double volume, struct vg_load *l)
{
  struct vg_load_octant *c = vg_alloc(1, sizeof *c);
  double x[3], side = 0, h;

  if (!c) return -1;
  for (int k = 0; k < 3; k++) {
    x[k] = 0.5 * (lo[k] + hi[k]);
    c->at[k] = (float)x[k];
    if (hi[k] - lo[k] > side) side = hi[k] - lo[k];
  }
  h = edge_at(m, x);
  c->half = (float)(0.5 * side);
  c->h = (float)h;
  set_across(m, x, c);
  c->part = (float)(volume / (side * side * side));
  c->cells = (float)(m->per_cube * volume / (h * h * h));
  free(l->octant);
  l->octant = c;
  l->n = 1;
  l->cells = (double)c->cells;
  return 0;
}

static vg_status refused(const struct maker *m, struct vg_error *err)
{
  if (atomic_load(m->emitted) <= OCTANTS_MOST)
    return vg_fail_memory(err, "the load estimate");
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the sizes require more than %.0f "
                 "billion cells; check that hmin, hmax and the sources have "
                 "the unit of the surface",
                 OCTANTS_MOST * EDGES_MOST * m->per_cube * 1e-9);
}

/* Builds the load with several positions of the root octant and keeps the best;
 * nearly always the first one suffices. */
static vg_status build(struct maker *m, struct vg_load_tree *t,
                       const struct vg_front *v, double volume, int threads,
                       struct vg_load *out, struct vg_error *err)
{
  double lo[3], hi[3], best = INFINITY;

  vg_load_box(v, lo, hi);
  for (int place = 0; place < PLACES; place++) {
    struct vg_load l = VG_LOAD_INIT;
    double crossed = 0, off;
    vg_status st;
    int bad;

    place_root(t, lo, hi, place);
    st = vg_load_tree_new(t, 1, v, threads, err);
    if (st < 0) return st;
    bad = make(m, threads, &l, &crossed);
    vg_load_tree_release(t);
    if (bad) return refused(m, err);
    memcpy(l.lo, t->lo, sizeof l.lo);
    l.unit = t->unit;
    off = fabs(vg_load_parts(&l) - volume);
    if (off < best) {
      vg_load_release(out);
      *out = l;
      best = off;
    } else vg_load_release(&l);
    /* possible error of samples of 1/8 of an octant, with a margin */
    if (off <= 0.01 * volume + 0.5 * sqrt(crossed)) break;
  }
  if (!out->n && lone_octant(m, lo, hi, volume, out))
    return vg_fail_memory(err, "the load estimate");
  return VG_OK;
}

/* The sizing field that the edges of the front alone give, if the requested
 * one grows faster than cells can follow. */
static vg_status find_pace(const struct vg_front *v,
                           const struct vg_sizing *sizing, int threads,
                           struct vg_sizing **out, struct vg_error *err)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  if (vg_sizing_growth(sizing) <= PACE) return VG_OK;
  o.growth = 1 + PACE;
  o.h_max = INFINITY;
  o.threads = threads;
  m.n_point = v->n_point;
  m.point = v->x;
  m.n_tri = v->n_face;
  m.tri = v->face;
  return vg_sizing_new(&o, 0, NULL, &m, out, err);
}

/* Scales the cells up to at least this number. */
static void raise_to(struct vg_load *l, double least)
{
  const double by = least / l->cells;

  if (!(l->cells > 0 && by > 1)) return;
  l->cells = 0;
  for (size_t i = 0; i < l->n; i++) {
    l->octant[i].cells *= (float)by;
    l->cells += (double)l->octant[i].cells;
  }
}

vg_status vg_load_new(const struct vg_front *v, const struct vg_sizing *sizing,
                      double cells_per_cube, int threads, struct vg_load *out,
                      struct vg_error *err)
{
  assert(sizing && out && cells_per_cube > 0 && threads >= 0);
  struct vg_load_tree t = { .unit = 1 };
  _Atomic size_t emitted = 0;
  struct vg_sizing *pace = NULL;
  struct maker m = { .tree = &t,
                     .sizing = sizing,
                     .is_steep = vg_sizing_slope(sizing) > HIDES,
                     .is_stretched = vg_sizing_is_stretched(sizing),
                     .per_cube = cells_per_cube,
                     .narrow = 1,
                     .emitted = &emitted };
  struct vg_load l = VG_LOAD_INIT;
  const double volume = vg_load_volume(v);
  vg_status st = VG_OK;

  m.large = v->n_face / 64 + 1024;
  if (!(volume > 0) || !v->n_face) {
    *out = l;
    return VG_OK;
  }
  st = find_pace(v, sizing, threads, &pace, err);
  m.pace = pace;
  for (; st == VG_OK; m.narrow *= 2) {
    vg_load_release(&l);
    st = build(&m, &t, v, volume, threads, &l, err);
    if (l.n >= FEW_OCTANTS || WIDE_FREE / m.narrow <= LEAST) break;
  }
  free(m.branch);
  vg_sizing_free(pace);
  if (st < 0) {
    vg_load_release(&l);
    return st;
  }
  vg_load_fit(&l, volume);
  raise_to(&l, CELLS_PER_FACE * (double)v->n_face);
  st = vg_load_index(&l, threads, err);
  if (st < 0) vg_load_release(&l);
  else *out = l;
  return st;
}
