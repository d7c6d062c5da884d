/* Outline: an octree is refined until its nodes are a few target edges wide;
 * what is wholly outside is dropped where it is found. Branches are worked on
 * by several threads; their octants are joined in the order of the tree. */
#include "partition/load/load.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "partition/load/load_tree.h"

/* Widest octant in target edges, free and where the front passes. */
#define WIDE_FREE 3.0 /* C14 */
#define WIDE_FRONT 2.0
/* In large meshes they are wider, to have about this many octants, or one for
 * so many cubes of the target edge. Nodes this wide tell how large a mesh is; a
 * leaf fills its width's octant on average. */
#define MANY_OCTANTS 40000.0
#define EDGES_MOST 280.0
#define WIDE_ROUGH 12.0
#define FILLED 0.35
/* More octants, of 2,500 cells each, are a mistake in the sizes. */
#define OCTANTS_MOST 4000000
/* With fewer octants than this, narrower ones are tried, down to LEAST edges.
 */
#define FEW_OCTANTS 64
#define LEAST 1.0
/* From this gradient on VG_LOAD_GRADED counts in full. */
#define GRADIENT 0.05 /* C15 */
/* Where h changes by more than this times itself across an octant, the octant's
 * parts are added up, to this depth. */
#define STEEP 1.2 /* C16 */
#define STEEP_DEPTH 4
/* A field whose gradient is more than HIDES can have edges that no sample of an
 * octant shows: it is looked at closer while the least is below this share. */
#define HIDES 0.5
#define HIDDEN 0.5
/* Narrower parts, in the least edge, are never divided. */
#define CLOSE 0.25
/* Cells next to a front follow its edges: away from it theirs grow by no more
 * than this for each length, however fast the field lets them. */
#define PACE 1.5
/* From here to PACE the share that VG_LOAD_GRADED adds goes down to none. */
#define PACE_FROM 1.0
/* Cells for each face of the front at least: what meshes have in which hardly
 * a point is away from the front. */
#define CELLS_PER_FACE 1.5
/* An octant with more triangles holds details that its density need not know.
 */
#define CROWD 400
/* Places of the root octant that are tried when volumes do not agree. */
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
  const struct vg_sizing *pace; /* what cells next to the front can follow,
                               where the field is steeper; else NULL */
  int is_steep;                 /* the field is, somewhere */
  double per_cube;
  double narrow, wide; /* divides, multiplies the widths allowed */
  size_t n_branch, cap_branch, large;
  _Atomic size_t *emitted; /* octants of all branches */
  struct branch {
    struct vg_load_node node;
    uint32_t *item; /* [node.n] */
    struct octants out;
    double crossed; /* sum of squares of volumes, octants crossed */
    int refused;
  } * branch;
};

/* Of a node: mean of 1 / h^3, that times the correction for a gradient, and
 * the gradient. */
struct density {
  double cubes, cells, slope;
};

static double edge_at(const struct maker *m, const double x[3])
{
  const double h = vg_sizing_at(m->sizing, x);

  return m->pace ? fmin(h, vg_sizing_at(m->pace, x)) : h;
}

/* Of an octant around mid. A rule of four points, exact for quadratics. */
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
  graded = fmin(slope / GRADIENT, 1) *
           fmax(0, fmin((PACE - slope) / (PACE - PACE_FROM), 1));
  return (struct density){ sum, sum * (1 + VG_LOAD_GRADED * graded), slope };
}

/* Its middle; returns half its side. */
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

/* Whether h changes so much across an octant that the rule misses what is near
 * its finest end. */
static int is_steep(struct density d, double half)
{
  const double change = 2 * half * d.slope;

  return change * change * change * d.cubes > STEEP * STEEP * STEEP;
}

/* Whether there are edges in an octant that are much finer than its density
 * shows, and of which it is more than `wide` wide. */
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

/* The same from parts of the octant. left: cubes of the target edge that
 * matter; where there are more, the node is divided in any case. */
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

/* Most cubes of the target edge that a leaf has. */
static double most_in(const struct maker *m, const struct vg_load_node *node)
{
  const double wide = m->wide * (node->n ? WIDE_FRONT : WIDE_FREE) / m->narrow;

  return wide * wide * wide;
}

/* Octant root to single precision: h is of no use beyond. */
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

/* The parts of an octant around samples of it that lie inside, of all of one
 * that is: how many, and the density there. */
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

/* Samples of an octant that the front passes: how many are inside, and the
 * density there. Without bias, however wide the octant is. */
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

static int emit(const struct maker *m, struct branch *b,
                const struct vg_load_node *node, struct density density,
                int inside)
{
  const struct vg_load_tree *t = m->tree;
  const double side = vg_load_side(node) * t->unit;
  const double volume = side * side * side;
  struct vg_load_octant *c;

  if (node->n) b->crossed += volume * volume;
  if (!inside) return 0;
  if (atomic_fetch_add(m->emitted, 1) >= OCTANTS_MOST) return -1;
  if (vg_reserve(&b->out.octant, &b->out.cap, b->out.n + 1, sizeof *c))
    return -1;
  c = &b->out.octant[b->out.n++];
  for (int k = 0; k < 3; k++)
    c->at[k] = (float)(t->lo[k] + node->at[k] * t->unit + 0.5 * side);
  c->half = (float)(0.5 * side);
  c->h = (float)(1 / cube_root(density.cubes));
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

/* Branches in the order of the tree, none with a large share of the front. */
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
  double *sum;           /* [branch] */
  _Atomic uint64_t seen; /* whole octants of all; from ROUGH_MOST on no more
                            are looked for: widths would be the same */
};
#define ROUGH_MOST (MANY_OCTANTS * EDGES_MOST)

/* cubes of the target edge in a node, whatever is the void. */
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

/* Choose the widths for a tolerable number of octants. */
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

/* All octants in order. crossed: see struct branch. */
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

/* --- the whole ----------------------------------------------------------- */

/* A root octant with room to spare, at a place where planes of the lattice are
 * unlikely to lie in planes of the front. */
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

/* A void that no sample has hit: one octant of its volume. */
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
    return vg_fail_memory(err, "the estimate of cells");
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the sizes ask for more than %.0f "
                 "billion cells; are hmin, hmax and the sources in the unit of "
                 "the surface?",
                 OCTANTS_MOST * EDGES_MOST * m->per_cube * 1e-9);
}

/* The best of several places of the root octant; nearly always the first. */
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
    /* what samples of 1/8 of an octant may be wrong by, and a bit */
    if (off <= 0.01 * volume + 0.5 * sqrt(crossed)) break;
  }
  if (!out->n && lone_octant(m, lo, hi, volume, out))
    return vg_fail_memory(err, "the estimate of cells");
  return VG_OK;
}

/* The field of sizes that the front alone asks for, if it is left faster than
 * cells can follow. */
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

/* To no fewer cells than this. */
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
