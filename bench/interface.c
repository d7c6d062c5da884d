/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* interface CASE CELLS LEAF [THREADS [PARTS [remesh|h-refine|octree
 * [metis|rcb]]]]: are cells near interfaces as good as all cells?
 *
 * CASE: a case of `vanguard demo` with about CELLS cells, or a file with a
 * closed surface, which is not modified. It is filled in leaves of LEAF cells.
 * Points that a separator made and that have cells of other tasks are on
 * interfaces. A cell made by repairs is assigned to the task of its location,
 * which follows from the tasks that made its corners, because the tasks whose
 * cells it replaces are not recorded. With PARTS the void is decomposed by
 * `discrete` or `octree`; LEAF should then be large enough not to cut the gap
 * region of `octree`. In this case points that a leaf made or adopted, and that
 * have cells of other leaves, are on interfaces; cells made by repairs are
 * ignored.
 * Prints one line each for all cells, for those within two rings of an
 * interface, and for the others; then for all and the near ones among the inner
 * cells. These have no corner on the surface, where the angles differ and near
 * which interfaces have fewer cells. In each line: number; smallest dihedral
 * angle of a cell: minimum, 1st and 5th percentile, mean; largest: 95th and
 * 99th percentile; mean edge over the target: mean, 1st, 50th and 99th
 * percentile. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "cli/examples/demo.h"
#include "base/child.h"
#include "core/surface/surface_check.h"
#include "io/mesh/format.h"
#include "partition/advance/advance.h"
#include "partition/advance/ways.h"

enum { BINS = 1800, N_SIZE = 4000, LEAF = 1, ZONE = 2, REPAIR = 3 };

#define MIXED UINT32_MAX /* the point has cells of two tasks */
#define NOBODY (UINT32_MAX - 1)

static const double degree = 57.29577951308232;

static double cpu(void)
{
  struct timespec t;

  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void must(vg_status st, const struct vg_error *err)
{
  if (st == VG_OK) return;
  fprintf(stderr, "interface: %s\n", err->text);
  exit(1);
}

struct share {
  size_t n, low[BINS + 1], high[BINS + 1], size[N_SIZE + 1];
  double least, sum_low, sum_size;
};

struct census {
  const struct vg_sizing *sizing;
  uint32_t *task;            /* [n_point] task of the cells at the point */
  uint32_t *maker;           /* [n_point] task that made it, or NOBODY */
  uint8_t *kind;             /* [n_point] kind of that task */
  uint8_t *ring;             /* [n_point] rings from an interface, + 1 */
  int now;                   /* ring being marked */
  int has_parts;             /* no separators: leaves meet at interfaces */
  uint64_t n_boundary_point; /* the first points */
  struct share all, near, rest, inner, inner_near;
};

/* --- rings --------------------------------------------------------------- */

static vg_status note_makers(void *context, const struct vg_slice *s,
                             struct vg_error *err)
{
  struct census *k = context;

  (void)err;
  for (size_t p = s->point_at; p < s->point_at + s->n_own; p++) {
    k->maker[p] = p < k->n_boundary_point ? NOBODY : s->domain;
    k->kind[p] = s->kind;
  }
  return VG_OK;
}

/* The task in whose region a cell of a repair is, derived from its corners:
 * points of a leaf have cells of that leaf, and cells that only have points of
 * one separator are assigned to that separator. MIXED: points of several
 * tasks. */
static uint32_t place_of(const struct census *k, const uint32_t *id,
                         const uint32_t *v)
{
  uint32_t leaf = NOBODY, zone = NOBODY;

  for (int i = 0; i < 4; i++) {
    uint64_t p = id[v[i]];
    uint32_t *of = k->kind[p] == LEAF ? &leaf : &zone;

    if (k->maker[p] == NOBODY || k->kind[p] == REPAIR) continue;
    if (*of == NOBODY) *of = k->maker[p];
    else if (*of != k->maker[p]) *of = MIXED;
  }
  return leaf == NOBODY ? zone : leaf;
}

/* A separator cell made by a swap may have a corner that a leaf made; that
 * corner is on the other side of the interface. */
static vg_status mark(void *context, const struct vg_slice *s,
                      struct vg_error *err)
{
  struct census *k = context;
  const uint32_t *v = s->cell[VG_SLICE_TET];

  (void)err;
  if (k->has_parts && s->kind == REPAIR) return VG_OK;
  for (size_t c = 0; c < s->n_cell[VG_SLICE_TET]; c++, v += 4) {
    uint32_t of = place_of(k, s->id, v);
    int beyond = 0;

    for (int i = 0; i < 4; i++) beyond |= k->kind[s->id[v[i]]] == LEAF;
    if (s->kind != REPAIR && !(s->kind == ZONE && beyond)) of = s->domain;
    for (int i = 0; of != NOBODY && i < 4; i++) {
      uint32_t *t = &k->task[s->id[v[i]]];

      if (*t == NOBODY) *t = of;
      else if (*t != of) *t = MIXED;
    }
  }
  return VG_OK;
}

/* All cells at a point of a separator may come from repairs or swaps. */
static int on_interface(const struct census *k, size_t p)
{
  return k->kind[p] == (k->has_parts ? LEAF : ZONE) && k->task[p] != NOBODY &&
         k->task[p] != k->maker[p];
}

static vg_status widen(void *context, const struct vg_slice *s,
                       struct vg_error *err)
{
  struct census *k = context;
  const uint32_t *v = s->cell[VG_SLICE_TET];

  (void)err;
  for (size_t c = 0; c < s->n_cell[VG_SLICE_TET]; c++, v += 4) {
    int beside = 0;

    for (int i = 0; i < 4; i++) {
      uint8_t r = k->ring[s->id[v[i]]];

      beside |= r && r <= k->now;
    }
    for (int i = 0; beside && i < 4; i++)
      if (!k->ring[s->id[v[i]]]) k->ring[s->id[v[i]]] = (uint8_t)(k->now + 1);
  }
  return VG_OK;
}

/* --- figures ------------------------------------------------------------- */

static void area(const double *a, const double *b, const double *c, double n[3])
{
  for (int k = 0; k < 3; k++) {
    int l = (k + 1) % 3, m = (k + 2) % 3;

    n[k] = (b[l] - a[l]) * (c[m] - a[m]) - (b[m] - a[m]) * (c[l] - a[l]);
  }
}

/* Smallest and largest dihedral angle, degrees. */
static void angles(const double *const x[4], double *low, double *high)
{
  double n[4][3], length[4];

  area(x[1], x[3], x[2], n[0]);
  area(x[0], x[2], x[3], n[1]);
  area(x[0], x[3], x[1], n[2]);
  area(x[0], x[1], x[2], n[3]);
  for (int i = 0; i < 4; i++)
    length[i] = sqrt(n[i][0] * n[i][0] + n[i][1] * n[i][1] + n[i][2] * n[i][2]);
  *low = 180;
  *high = 0;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++) {
      double dot = n[i][0] * n[j][0] + n[i][1] * n[j][1] + n[i][2] * n[j][2];
      double a = acos(fmax(-1, fmin(1, -dot / (length[i] * length[j]))));

      *low = fmin(*low, a * degree);
      *high = fmax(*high, a * degree);
    }
}

static double edge_over_target(const struct vg_sizing *sizing,
                               const double *const x[4])
{
  double middle[3], sum = 0;

  for (int k = 0; k < 3; k++)
    middle[k] = (x[0][k] + x[1][k] + x[2][k] + x[3][k]) / 4;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++) {
      double d[3] = { x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2] };

      sum += sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
  return sum / 6 / vg_sizing_at(sizing, middle);
}

static void count(struct share *s, double low, double high, double size)
{
  s->n++;
  s->low[(int)(low * BINS / 180)]++;
  s->high[(int)(high * BINS / 180)]++;
  s->size[(int)fmin(N_SIZE, size * N_SIZE / 4)]++;
  s->least = fmin(s->least, low);
  s->sum_low += low;
  s->sum_size += size;
}

static vg_status tally(void *context, const struct vg_slice *s,
                       struct vg_error *err)
{
  struct census *k = context;
  const uint32_t *v = s->cell[VG_SLICE_TET];

  (void)err;
  for (size_t c = 0; c < s->n_cell[VG_SLICE_TET]; c++, v += 4) {
    const double *x[4];
    double low, high, size;
    int near = 0, inner = 1;

    for (int i = 0; i < 4; i++) {
      uint8_t ring = k->ring[s->id[v[i]]];

      x[i] = s->x[v[i]];
      inner &= s->id[v[i]] >= k->n_boundary_point;
      near |= ring && ring <= k->now;
    }
    angles(x, &low, &high);
    size = edge_over_target(k->sizing, x);
    count(&k->all, low, high, size);
    count(near ? &k->near : &k->rest, low, high, size);
    if (inner) count(&k->inner, low, high, size);
    if (inner && near) count(&k->inner_near, low, high, size);
  }
  return VG_OK;
}

static double part(const size_t *bin, size_t n_bin, size_t n, double share,
                   double width)
{
  double sum = 0;

  for (size_t k = 0; k < n_bin; k++) {
    sum += (double)bin[k];
    if (sum >= share * (double)n) return ((double)k + 0.5) * width;
  }
  return (double)n_bin * width;
}

static void show(const char *name, const struct share *s)
{
  double w = 180.0 / BINS, z = 4.0 / N_SIZE, n = s->n ? (double)s->n : 1;

  printf("%-5s %10zu cells  angle min %6.2f 1%% %6.2f 5%% %6.2f mean %6.2f  "
         "largest 95%% %.2f 99%% %.2f  edge/target mean %.3f 1%% %.4f "
         "50%% %.4f 99%% %.4f\n",
         name, s->n, s->least, part(s->low, BINS + 1, s->n, 0.01, w),
         part(s->low, BINS + 1, s->n, 0.05, w), s->sum_low / n,
         part(s->high, BINS + 1, s->n, 0.95, w),
         part(s->high, BINS + 1, s->n, 0.99, w), s->sum_size / n,
         part(s->size, N_SIZE + 1, s->n, 0.01, z),
         part(s->size, N_SIZE + 1, s->n, 0.50, z),
         part(s->size, N_SIZE + 1, s->n, 0.99, z));
}

/* Cells with a corner on an interface are the first ring, cells that share a
 * point with these the second. One rank, one thread: marks are not atomic. */
static void measure(const struct vg_slices *s, const struct vg_sizing *sizing,
                    int has_parts)
{
  struct census *k = vg_calloc(1, sizeof *k);
  struct vg_error err = VG_ERROR_INIT;

  if (!k) exit(1);
  k->sizing = sizing;
  k->has_parts = has_parts;
  k->task = vg_alloc(s->n_point, sizeof *k->task);
  k->maker = vg_alloc(s->n_point, sizeof *k->maker);
  k->kind = vg_calloc(s->n_point, 1);
  k->ring = vg_calloc(s->n_point, 1);
  if (!k->task || !k->maker || !k->kind || !k->ring) exit(1);
  k->n_boundary_point = s->n_boundary_point;
  k->all.least = k->near.least = k->rest.least = 180;
  k->inner.least = k->inner_near.least = 180;
  for (size_t p = 0; p < s->n_point; p++) k->task[p] = k->maker[p] = NOBODY;
  must(vg_slices_each(s, 1, note_makers, k, &err), &err);
  must(vg_slices_each(s, 1, mark, k, &err), &err);
  for (size_t p = s->n_boundary_point; p < s->n_point; p++)
    k->ring[p] = (uint8_t)on_interface(k, p);
  k->now = 1;
  must(vg_slices_each(s, 1, widen, k, &err), &err);
  k->now = 2;
  must(vg_slices_each(s, 1, tally, k, &err), &err);
  show("all", &k->all);
  show("near", &k->near);
  show("other", &k->rest);
  show("inner", &k->inner);
  show("near", &k->inner_near);
  free(k->task);
  free(k->maker);
  free(k->kind);
  free(k->ring);
  free(k);
}

/* --- the mesh ------------------------------------------------------------ */

static void load(const char *name, double cells, struct vg_demo *d)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;

  if (!strchr(name, '.')) {
    must(vg_demo_make(name, (size_t)cells, d, &err), &err);
    return;
  }
  must(vg_surface_read(name, &d->surface, NULL, &err), &err);
  must(vg_surface_check(&d->surface, &o, &r, &err), &err);
  vg_surface_report_release(&r);
  d->sizing = (struct vg_sizing_options)VG_SIZING_OPTIONS_INIT;
}

static double angle(double shape)
{
  return asin(sqrt(fmax(0, shape))) * degree;
}

/* PARTS [INTERFACES [PARTITIONER]] */
static void decompose(int n, char **word, struct vg_partition_options *o)
{
  int is_octree = n > 1 && !strcmp(word[1], "octree");

  o->maker = vg_ways[is_octree ? VG_DECOMPOSE_OCTREE : VG_DECOMPOSE_DISCRETE]
               .maker;
  o->decomposition.n_part = atoi(word[0]);
  o->decomposition.h_refine = n > 1 && !strcmp(word[1], "h-refine");
  if (n > 2 && !strcmp(word[2], "rcb"))
    o->decomposition.partitioner = VG_PARTITIONER_RCB;
}

int main(int argc, char **argv)
{
  struct vg_demo d = VG_DEMO_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_sizing *sizing = NULL;
  struct vg_partition_options o = VG_PARTITION_OPTIONS_INIT;
  struct vg_partition_report r = { 0 };
  struct vg_spans spans = VG_SPANS_INIT;
  struct vg_partition *p = NULL;
  double t0;

  if (argc < 4) {
    fprintf(stderr, "usage: interface CASE|FILE CELLS LEAF [THREADS [PARTS "
                    "[remesh|h-refine|octree [metis|rcb]]]]\n");
    return 2;
  }
  must(vg_child_server_start(&err), &err);
  load(argv[1], atof(argv[2]), &d);
  must(vg_sizing_new(&d.sizing, d.n_source, d.source, &d.surface, &sizing,
                     &err),
       &err);
  o.rule.leaf_cells = atof(argv[3]);
  o.threads = argc > 4 ? atoi(argv[4]) : 1;
  if (argc > 5) decompose(argc - 5, argv + 5, &o);
  t0 = cpu();
  must(vg_partition_grow(NULL, &d.surface, sizing, &o, &p, &r, &spans, &err),
       &err);
  printf("%s: %llu leaves, %.2f s cpu\nacross interfaces %llu swaps, %llu "
         "points moved\nrepair %.3f s: %llu of %llu regions "
         "better, %llu cells, %llu bad, %llu left, worst %.2f, %.2f left\n",
         argv[1], (unsigned long long)r.n_leaf, cpu() - t0,
         (unsigned long long)r.n_repair_swapped,
         (unsigned long long)r.n_repair_moved, r.repair,
         (unsigned long long)r.n_repaired, (unsigned long long)r.n_repair,
         (unsigned long long)r.n_repair_cell,
         (unsigned long long)r.n_repair_bad,
         (unsigned long long)r.n_repair_bad_left, angle(r.repair_worst),
         angle(r.repair_worst_left));
  measure(vg_partition_slices(p), sizing, o.maker != NULL);
  vg_partition_free(p);
  vg_spans_release(&spans);
  vg_sizing_free(sizing);
  vg_demo_release(&d);
  return 0;
}
