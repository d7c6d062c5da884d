/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/examples/demo.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/examples/demo_aerofoil.h"
#include "cli/examples/demo_parts.h"
#include "core/domain/farfield.h"

#define FARFIELD 20.0 /* radius or half width, body lengths or chords */
/* Largest factor on the spacings below that still resolves the geometry. */
#define FACTOR_MAX 12.0
/* Relative accuracy of the estimate, and largest number of iterations. */
#define FIT_CLOSE 0.02
#define FIT_TURNS 5
/* The same for a field of size tensors, on a coarser octree: it takes seconds,
 * and the two estimates differ by 3 % (measured). */
#define FIT_TURNS_STRETCHED 2
#define FIT_COARSENESS 4
/* Instead of VG_DEMO_GRADED, for the passage, most of which has the largest
 * spacing: 9.7 to 10.4 cells per cube at 5 million to 90 thousand cells. */
#define PASSAGE_GRADED 1.12
/* Sphere in a box, as in the comparisons of docs/lab/performance.md. */
#define SPHERE_FINE 0.02
#define SPHERE_COARSE 1.5

enum kind { BOX, SPHERE, WING, BOOM, PASSAGE, EXCHANGER };

static const struct vg_demo_case cases[] = {
  { "box", "unit cube, uniform spacing", 100000 },
  { "sphere", "sphere in a box 20 times its size", 500000 },
  { "wing", "swept tapered wing, blunt trailing edge", 1000000 },
  { "wing-half", "half model of wing, on a symmetry plane", 500000 },
  { "wing-sharp", "swept tapered wing, sharp trailing edge", 1000000 },
  { "wing-sharp-half", "half model of wing-sharp, on a symmetry plane",
    500000 },
  { "boom", "body of revolution at Mach 1.6, with its sonic boom", 300000 },
  { "boom-half", "half model of boom, on a symmetry plane", 250000 },
  { "disk", "sphere behind an actuator disk, which is a sheet", 300000 },
  { "rotor", "impeller in a rotating zone of a box", 100000 },
  { "fins", "solid with fins, a zone of a box", 100000 },
  { "exchanger", "two fluids on both sides of a pipe, three zones", 100000 },
  { "passage", "turbine blade with a tip gap, between periodic sides", 100000 },
};

enum { N_ENTRY = sizeof cases / sizeof *cases };

/* In the order of cases[]. */
static const struct entry {
  enum kind kind;
  struct vg_demo_wing wing;
  /* Adds sheets, or NULL. */
  vg_status (*sheets)(const struct vg_demo_spacing *law, struct vg_demo *d,
                      struct vg_error *err);
} entries[N_ENTRY] = {
  { BOX, { 0, 0 }, NULL },
  { SPHERE, { 0, 0 }, NULL },
  { WING, { 0, 0 }, NULL },
  { WING, { 0, 1 }, NULL },
  { WING, { 1, 0 }, NULL },
  { WING, { 1, 1 }, NULL },
  { BOOM, { 0, 0 }, NULL },
  { BOOM, { 0, 1 }, NULL },
  { SPHERE, { 0, 0 }, vg_demo_add_disk },
  { BOX, { 0, 0 }, vg_demo_add_rotor },
  { BOX, { 0, 0 }, vg_demo_add_fins },
  { EXCHANGER, { 0, 0 }, NULL },
  { PASSAGE, { 0, 0 }, NULL },
};

const struct vg_demo_case *vg_demo_cases(size_t *n)
{
  *n = N_ENTRY;
  return cases;
}

void vg_demo_release(struct vg_demo *d)
{
  vg_mesh_release(&d->surface);
  vg_mesh_release(&d->sheet);
  free(d->source);
  memset(d, 0, sizeof *d);
}

double vg_demo_size(void *user, const double x[3])
{
  const struct vg_demo_spacing *law = user;
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  double h;

  o.growth = law->growth;
  h = vg_sizing_sources_at(&o, law->n, law->source, x);
  return h < law->h_max ? h : law->h_max;
}

/* --- estimate ------------------------------------------------------------ */

struct estimate {
  double (*size)(void *, const double *);
  int (*inside)(void *, const double *);
  void *user;
};

/* Blocks are halved until they are at most this many edges long, and integrated
 * with two Gauss points along each axis: over such a block h changes by about
 * its own value. */
#define BLOCK_EDGES 3.0
#define GAUSS 0.28867513459481288225 /* 1 / (2 sqrt(3)) */

static double count_leaf(const struct estimate *e, const double mid[3],
                         const double size[3])
{
  double sum = 0;

  for (int c = 0; c < 8; c++) {
    double x[3], h;

    for (int k = 0; k < 3; k++)
      x[k] = mid[k] + (c >> k & 1 ? GAUSS : -GAUSS) * size[k];
    if (e->inside && !e->inside(e->user, x)) continue;
    h = e->size(e->user, x);
    sum += 1 / (h * h * h);
  }
  return sum / 8 * size[0] * size[1] * size[2];
}

static double count_block(const struct estimate *e, const double lo[3],
                          const double size[3], int depth)
{
  double mid[3], half[3], longest = 0, sum = 0;

  for (int k = 0; k < 3; k++) {
    half[k] = 0.5 * size[k];
    mid[k] = lo[k] + half[k];
    longest = fmax(longest, size[k]);
  }
  if (depth == 0 || longest <= BLOCK_EDGES * e->size(e->user, mid))
    return count_leaf(e, mid, size);
  for (int c = 0; c < 8; c++) {
    double corner[3];

    for (int k = 0; k < 3; k++) corner[k] = c >> k & 1 ? mid[k] : lo[k];
    sum += count_block(e, corner, half, depth - 1);
  }
  return sum;
}

/* Integral of 1 / h^3 over the part of a box where `inside` is not 0 (NULL: the
 * whole box), with h = size(user, x) > 0. Multiplied by the cells per cube, it
 * is the number of cells for the sizing field h. */
static double cubes(const double lo[3], const double hi[3],
                    double (*size)(void *user, const double x[3]),
                    int (*inside)(void *user, const double x[3]), void *user)
{
  const struct estimate e = { size, inside, user };
  const double side[3] = { hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2] };

  return count_block(&e, lo, side, 24);
}

/* --- spacings ------------------------------------------------------------ */

/* A case with its spacings multiplied by a factor. */
struct scaled {
  const struct entry *entry;
  double factor;
  struct vg_demo_spacing law;
  struct vg_sizing *field; /* borrowed; set while its cells are counted */
};

static void make_law(struct scaled *s)
{
  struct vg_demo_spacing *law = &s->law;
  const double f = s->factor;

  memset(law, 0, sizeof *law);
  law->growth = 1.2;
  law->n = 1;
  switch (s->entry->kind) {
  case EXCHANGER:
    law->n = 0;
    law->h_max = f;
    break;
  case BOX:
    law->h_max = f;
    law->source[0].kind = VG_SOURCE_BOX;
    for (int k = 0; k < 3; k++) law->source[0].p1[k] = 1;
    law->source[0].h0 = law->source[0].h1 = f;
    break;
  case SPHERE:
    law->h_max = SPHERE_COARSE * f;
    law->source[0].kind = VG_SOURCE_SPHERE;
    law->source[0].r0 = 1;
    law->source[0].h0 = law->source[0].h1 = SPHERE_FINE * f;
    break;
  case WING:
    vg_demo_wing_law(&s->entry->wing, f, law);
    law->h_max = 0.2 * FARFIELD * (f < 1 ? f : 1);
    break;
  case BOOM: vg_demo_boom_law(f, law); break;
  case PASSAGE: vg_demo_passage_law(f, law); break;
  }
  for (size_t i = 0; i < law->n; i++) law->source[i].an = 1;
}

static double field_size(void *user, const double x[3])
{
  const struct scaled *s = user;

  return vg_sizing_at(s->field, x);
}

static double scaled_size(void *user, const double x[3])
{
  struct scaled *s = user;

  return vg_demo_size(&s->law, x);
}

static int in_fluid(void *user, const double x[3])
{
  const struct scaled *s = user;
  const double rr = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];

  if (s->entry->kind == BOX) return 1;
  if (s->entry->kind == SPHERE) return rr > 1;
  if (s->entry->kind == BOOM) return vg_demo_boom_holds(x);
  if (s->entry->kind == PASSAGE) return vg_demo_passage_holds(x);
  return rr < FARFIELD * FARFIELD && !vg_demo_wing_holds(&s->entry->wing, x);
}

/* Number of cells of a graded case with this sizing field. */
static double n_cell_of(struct scaled *s,
                        double (*size)(void *user, const double x[3]))
{
  double lo[3] = { -FARFIELD, s->entry->wing.is_half ? 0 : -FARFIELD,
                   -FARFIELD };
  double hi[3] = { FARFIELD, FARFIELD, FARFIELD };

  if (s->entry->kind == BOOM) vg_demo_boom_box(s->entry->wing.is_half, lo, hi);
  if (s->entry->kind == PASSAGE) vg_demo_passage_box(lo, hi);
  return VG_DEMO_CELLS_PER_CUBE *
         (s->entry->kind == PASSAGE ? PASSAGE_GRADED : VG_DEMO_GRADED) *
         cubes(lo, hi, size, in_fluid, s);
}

/* Volume of a case with uniform spacing; 0: others. */
static double uniform_volume(const struct entry *e)
{
  return e->kind == BOX       ? 1
       : e->kind == EXCHANGER ? vg_demo_exchanger_volume()
                              : 0;
}

static double law_estimate(struct scaled *s)
{
  make_law(s);
  return n_cell_of(s, scaled_size);
}

static double cube_root(double x)
{
  double y = 1;

  for (int i = 0; i < 200; i++) y = (2 * y + x / (y * y)) / 3;
  return y;
}

/* Fit the factor to the number of cells, starting from the factor of s. The
 * number of cells is proportional to a power of 1 / factor between 1 and 3, so
 * a step by the cube root of the ratio never overshoots. */
static double fit_factor(struct scaled *s, double n_cell)
{
  const double volume = uniform_volume(s->entry);
  const double most = s->entry->kind == BOX ? 0.5 : 0.07;
  double n = 0;

  if (volume > 0) {
    s->factor = cube_root(VG_DEMO_CELLS_PER_CUBE * volume / n_cell);
    if (s->factor > most) s->factor = most;
    make_law(s);
    return VG_DEMO_CELLS_PER_CUBE * volume /
           (s->factor * s->factor * s->factor);
  }
  for (int i = 0; i < 30; i++) {
    double step;

    n = law_estimate(s);
    step = cube_root(n / n_cell);
    if (fabs(step - 1) < 0.003) break;
    if (s->factor * step > FACTOR_MAX) {
      if (s->factor == FACTOR_MAX) break;
      step = FACTOR_MAX / s->factor;
    }
    s->factor *= step;
  }
  make_law(s);
  return n;
}

/* --- surfaces ------------------------------------------------------------ */

static vg_status name_patch(struct vg_mesh *m, int32_t id, const char *name,
                            int32_t bc, int32_t bc_fun3d, struct vg_error *err)
{
  const size_t at = vg_mesh_add_patch(m, id, name);

  if (at == SIZE_MAX) return vg_fail_memory(err, "a patch");
  m->patch[at].bc = m->patch[at].family = bc;
  m->patch[at].bc_fun3d = bc_fun3d;
  return VG_OK;
}

static vg_status box_surface(const struct scaled *s, struct vg_mesh *m,
                             struct vg_error *err)
{
  static const char *const name[6] = { "x-min", "x-max", "y-min",
                                       "y-max", "z-min", "z-max" };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 1, 1, 1 };
  const uint32_t patch[6] = { 0, 1, 2, 3, 4, 5 };
  const struct vg_size_function law = { .at = vg_demo_size,
                                        .user = (void *)&s->law };
  vg_status st;

  for (int i = 0; i < 6; i++)
    VG_TRY(name_patch(m, i + 1, name[i], 3, 5000, err));
  st = vg_add_box(m, lo, hi, -1, &law, patch, NULL, err);
done:
  return st;
}

static vg_status sphere_surface(const struct scaled *s, struct vg_mesh *m,
                                struct vg_error *err)
{
  const double centre[3] = { 0, 0, 0 };
  const struct vg_size_function law = { .at = vg_demo_size,
                                        .user = (void *)&s->law };
  vg_status st = name_patch(m, 1, "sphere", 4, 4000, err);

  if (st == VG_OK) st = vg_add_sphere(m, centre, 1, -1, 0, &law, 0, NULL, err);
  return st;
}

static vg_status add_farfield(const struct scaled *s, struct vg_demo *d,
                              struct vg_error *err)
{
  const struct vg_size_function law = { .at = vg_demo_size,
                                        .user = (void *)&s->law };
  struct vg_farfield far = VG_FARFIELD_INIT;

  far.size = FARFIELD;
  far.has_centre = 1;
  far.kind = s->entry->kind == SPHERE ? VG_FARFIELD_BOX : VG_FARFIELD_SPHERE;
  if (s->entry->kind == BOOM) far = d->farfield = vg_demo_boom_farfield();
  return vg_domain_complete_by(&d->surface, &far, &law, NULL, err);
}

/* Set all members of *d but n_cell from the spacings of s. */
static vg_status build(const struct scaled *s, struct vg_demo *d,
                       struct vg_error *err)
{
  vg_status st;

  vg_demo_release(d);
  d->sizing = (struct vg_sizing_options)VG_SIZING_OPTIONS_INIT;
  d->sizing.growth = s->law.growth;
  d->sizing.h_max = s->law.h_max;
  d->source = vg_alloc(s->law.n, sizeof *d->source);
  if (!d->source) return vg_fail_memory(err, "the sources");
  memcpy(d->source, s->law.source, s->law.n * sizeof *d->source);
  d->n_source = s->law.n;
  switch (s->entry->kind) {
  case BOX: return box_surface(s, &d->surface, err);
  case EXCHANGER: return vg_demo_exchanger_surface(&s->law, d, err);
  case PASSAGE:
    d->periodic[0] = "lo";
    d->periodic[1] = "hi";
    return vg_demo_passage_surface(&s->law, &d->surface, err);
  case SPHERE: st = sphere_surface(s, &d->surface, err); break;
  case BOOM:
    st = vg_demo_boom_surface(s->entry->wing.is_half, &s->law, &d->surface,
                              err);
    break;
  default:
    st = vg_demo_wing_surface(&s->entry->wing, &s->law, &d->surface, err);
  }
  if (st != VG_OK) return st;
  d->n_body_tri = d->surface.n_tri;
  d->n_body_point = d->surface.n_point;
  return add_farfield(s, d, err);
}

/* Estimate with the sizing field, which also depends on the edges of the
 * surface: near leading edges and on coarse spheres, cells are smaller than the
 * sources require. */
static vg_status field_estimate(struct scaled *s, const struct vg_demo *d,
                                double *n_cell, struct vg_error *err)
{
  struct vg_sizing_options o = d->sizing;
  vg_status st;

  if (s->entry->kind == BOOM) {
    o.coarseness = FIT_COARSENESS;
    o.threads = 0;
  }
  st = vg_sizing_new(&o, d->n_source, d->source, &d->surface, &s->field, err);
  if (st < 0) return st;
  *n_cell = n_cell_of(s, field_size);
  vg_sizing_free(s->field);
  s->field = NULL;
  return VG_OK;
}

/* Correct the requested number by the error of the previous estimate; two or
 * three iterations suffice. */
static vg_status make(struct scaled *s, double n_cell, struct vg_demo *d,
                      struct vg_error *err)
{
  const int n_turn = s->entry->kind == BOOM ? FIT_TURNS_STRETCHED : FIT_TURNS;
  const int is_uniform = uniform_volume(s->entry) > 0;
  double ask = n_cell, n = 0;
  vg_status st = VG_OK;

  s->factor = FACTOR_MAX;
  if (is_uniform) {
    n = fit_factor(s, n_cell);
    VG_TRY(build(s, d, err));
  }
  for (int turn = 0; !is_uniform && turn < n_turn; turn++) {
    fit_factor(s, ask);
    VG_TRY(build(s, d, err));
    VG_TRY(field_estimate(s, d, &n, err));
    if (fabs(n / n_cell - 1) < FIT_CLOSE || s->factor == FACTOR_MAX) break;
    ask *= n_cell / n;
  }
  d->n_cell = n;
done:
  return st;
}

static vg_status unknown(const char *name, struct vg_error *err)
{
  const struct vg_demo_case *section;
  char list[256] = "";
  size_t at = 0, n;

  for (size_t i = 0; i < N_ENTRY; i++)
    at += (size_t)snprintf(list + at, sizeof list - at, "%s%s", i ? ", " : "",
                           cases[i].name);
  section = vg_demo_sections(&n);
  for (size_t i = 0; i < n; i++)
    at += (size_t)snprintf(list + at, sizeof list - at, ", %s",
                           section[i].name);
  return vg_fail(err, VG_ERR_USAGE, "unknown example '%s'; the examples are %s",
                 name, list);
}

vg_status vg_demo_make(const char *name, size_t n_cell, struct vg_demo *out,
                       struct vg_error *err)
{
  struct scaled s = { 0 };
  struct vg_demo d = VG_DEMO_INIT;
  vg_status st;

  for (size_t i = 0; i < N_ENTRY; i++)
    if (!strcmp(cases[i].name, name)) s.entry = &entries[i];
  if (!s.entry) return unknown(name, err);
  if (n_cell > 2000000000)
    return vg_fail(err, VG_ERR_INPUT,
                   "%zu cells are more than a mesh can "
                   "number; request at most 2000000000",
                   n_cell);
  if (!n_cell) n_cell = cases[s.entry - entries].n_cell;
  st = make(&s, (double)n_cell, &d, err);
  if (st == VG_OK && s.entry->sheets) st = s.entry->sheets(&s.law, &d, err);
  if (st == VG_OK) {
    *out = d;
    d = (struct vg_demo)VG_DEMO_INIT;
  }
  vg_demo_release(&d);
  return st;
}
