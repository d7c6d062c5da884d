/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: octants, their subdomains, patches between subdomains, triangles on
 * patches; then the fronts that these form, which are checked before they are
 * returned. */
#include "partition/octree/octree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "partition/octree/octree_parts.h"

/* Automatic maximum width of octants in sizes, and the maximum number of
 * octants worthwhile. */
#define NARROW 4.0 /* O3 */
#define MANY 5e5
/* Narrower octants would have sides of less than two triangles. */
#define LEAST 2.0

/* Relative tolerance of volumes for rounding: they are sums of some millions
 * of terms of similar size. */
#define ROUNDING 1e-8

struct maker {
  const struct vg_front *front;
  const struct vg_load *load;
  const struct vg_sizing *sizing;
  const struct vg_decomposition_options *options;
  const struct vg_engine *engine;
  uint32_t serial;
  struct vg_octants t;
  uint32_t *gap; /* [front->n_face] */
  struct vg_patches patches;
  struct vg_interfaces faces;
  struct vg_decomposition out;
  double spent; /* Clock at the end of the previous step. */
};

/* Adds the time since the previous step. */
static void note_time(struct maker *m, int step)
{
  const double now = vg_clock();

  m->out.report.time[step] += now - m->spent;
  m->spent = now;
}

/* --- octants ------------------------------------------------------------- */

static size_t n_free(const struct vg_octants *t)
{
  size_t n = 0;

  for (size_t l = 0; l < t->n_leaf; l++)
    n += t->octant[t->leaf[l]].state == VG_OCTANT_FREE;
  return n;
}

/* Chooses narrow octants, which leave least to the gap region; wider ones in
 * meshes so large that there would be too many. */
static double choose_width(const struct maker *m)
{
  const double per_cube = m->options->cells_per_cube;
  double wide = NARROW;

  if (m->options->coarsening > 0) return m->options->coarsening;
  /* minimum cells per cube, which has half the width: an eighth */
  while (m->load->cells > MANY * per_cube / 8 * wide * wide * wide)
    wide *= 1.25;
  return wide;
}

static vg_status make_octants(struct maker *m, struct vg_error *err)
{
  const double wide = choose_width(m);
  vg_status st;

  m->out.report.coarsening = wide;
  st = vg_octants_make(m->front, m->load, m->sizing, wide, m->engine, &m->t,
                       err);
  note_time(m, VG_DECOMPOSITION_COARSE);
  if (st != VG_OK) return st;
  st = vg_octants_part(&m->t, m->front, m->sizing, m->load->cells, m->options,
                       m->gap, err);
  note_time(m, VG_DECOMPOSITION_GRAPH);
  return st;
}

/* --- fronts -------------------------------------------------------------- */

struct filler {
  struct maker *m;
  struct vg_part *part;
  uint32_t *own, *new; /* [front, interface points] Their index in the
                          subdomain, or VG_OCTANT_NONE. */
};

static uint32_t take_point(struct filler *f, uint32_t *number,
                           const double x[3], uint64_t name)
{
  struct vg_front *to = &f->part->front;

  if (*number == VG_OCTANT_NONE) {
    memcpy(to->x[to->n_point], x, sizeof *to->x);
    to->id[to->n_point] = name;
    *number = (uint32_t)to->n_point++;
  }
  return *number;
}

static vg_status make_room(struct vg_part *p, size_t n_face,
                           struct vg_error *err)
{
  struct vg_front *to = &p->front;

  to->face = vg_alloc(n_face, sizeof *to->face);
  to->x = vg_alloc(n_face, 3 * sizeof *to->x);
  to->id = vg_alloc(n_face, 3 * sizeof *to->id);
  return to->face && to->x && to->id
         ? VG_OK
         : vg_fail_memory(err, "the front of a subdomain");
}

static void give_back(struct vg_front *f)
{
  void *x = vg_realloc(f->x, f->n_point, sizeof *f->x);
  void *name = vg_realloc(f->id, f->n_point, sizeof *f->id);

  if (x) f->x = x;
  if (name) f->id = name;
}

/* Takes the interface triangles of a patch, seen from above or from below. */
static void take_patch(struct filler *f, size_t patch, int above)
{
  struct maker *m = f->m;
  struct vg_front *to = &f->part->front;

  for (size_t i = m->faces.begin[patch]; i < m->faces.begin[patch + 1]; i++) {
    uint32_t *face = to->face[to->n_face++];

    for (int j = 0; j < 3; j++) {
      const uint32_t v = m->faces.tri[i][above ? j : 2 - j];

      face[j] = take_point(f, &f->new[v], m->faces.x[v],
                           VG_POINT_ID(m->serial, v));
    }
  }
}

static void take_triangle(struct filler *f, size_t i)
{
  const struct vg_front *from = f->m->front;
  struct vg_front *to = &f->part->front;
  uint32_t *face = to->face[to->n_face++];

  for (int j = 0; j < 3; j++) {
    const uint32_t v = from->face[i][j];

    face[j] = take_point(f, &f->own[v], from->x[v], from->id[v]);
  }
}

/* Lists of the patches, then triangles, of each subdomain. */
struct bounds {
  size_t *begin;  /* [subdomains + 2] */
  uint32_t *item; /* Patches: 2 i + 1 if the subdomain is above; then
                     triangles, 2 (patches + i). */
};

static vg_status list_bounds(const struct maker *m, size_t n, struct bounds *b,
                             struct vg_error *err)
{
  const size_t n_patch = m->patches.n;

  b->begin = vg_calloc(n + 2, sizeof *b->begin);
  b->item = vg_alloc(2 * n_patch + m->front->n_face, sizeof *b->item);
  if (!b->begin || !b->item) return vg_fail_memory(err, "the subdomains");
  for (int fill = 0; fill < 2; fill++) {
    for (size_t i = 0; i < n_patch; i++)
      for (int k = 0; k < 2; k++) {
        const uint32_t id = m->patches.patch[i].id[k];

        if (fill) b->item[b->begin[id + 1]++] = (uint32_t)(2 * i) + (uint32_t)k;
        else b->begin[id + 2]++;
      }
    for (size_t i = 0; i < m->front->n_face; i++) {
      if (m->gap[i] == UINT32_MAX)
        return vg_fail(err, VG_ERR_GEOMETRY,
                       "triangle %zu of the front is "
                       "in no octant",
                       i + 1);
      if (fill)
        b->item[b->begin[m->gap[i] + 1]++] = (uint32_t)(2 * (n_patch + i));
      else b->begin[m->gap[i] + 2]++;
    }
    for (size_t k = 2; !fill && k < n + 2; k++) b->begin[k] += b->begin[k - 1];
  }
  return VG_OK;
}

static vg_status fill_part(struct filler *f, const struct bounds *b, size_t k,
                           struct vg_error *err)
{
  const struct maker *m = f->m;
  const size_t n_patch = m->patches.n;
  size_t n_face = 0;
  vg_status st;

  for (size_t i = b->begin[k]; i < b->begin[k + 1]; i++) {
    const size_t at = b->item[i] >> 1;

    n_face += at < n_patch ? m->faces.begin[at + 1] - m->faces.begin[at] : 1;
  }
  st = make_room(f->part, n_face, err);
  if (st < 0) return st;
  memset(f->own, 0xff, m->front->n_point * sizeof *f->own);
  memset(f->new, 0xff, m->faces.n_point * sizeof *f->new);
  for (size_t i = b->begin[k]; i < b->begin[k + 1]; i++) {
    const size_t at = b->item[i] >> 1;

    if (at < n_patch) take_patch(f, at, b->item[i] & 1);
    else take_triangle(f, at - n_patch);
  }
  give_back(&f->part->front);
  return VG_OK;
}

static vg_status fill_parts(struct maker *m, struct vg_error *err)
{
  struct vg_decomposition *out = &m->out;
  const size_t n = m->t.n_part + m->t.n_gap;
  struct bounds b = { NULL, NULL };
  struct filler f = { .m = m };
  vg_status st;

  f.own = vg_alloc(m->front->n_point, sizeof *f.own);
  f.new = vg_alloc(m->faces.n_point, sizeof *f.new);
  out->part = vg_calloc(n, sizeof *out->part);
  if (!f.own || !f.new || !out->part) {
    st = vg_fail_memory(err, "the subdomains");
    goto done;
  }
  out->n_part = n;
  VG_TRY(list_bounds(m, n, &b, err));
  for (size_t k = 0; k < n; k++) {
    f.part = &out->part[k];
    f.part->may_cut = k >= m->t.n_part;
    VG_TRY(fill_part(&f, &b, k, err));
  }
  out->n_point = m->faces.n_point;
  out->x = m->faces.x;
  m->faces.x = NULL;
done:
  free(f.own);
  free(f.new);
  free(b.begin);
  free(b.item);
  return st;
}

/* --- checks -------------------------------------------------------------- */

/* Adds the volumes of the octants of each subdomain; 0 for the gap region. */
static void add_octants(const struct vg_octants *t, double *volume)
{
  for (size_t l = 0; l < t->n_leaf; l++) {
    const struct vg_octant *o = &t->octant[t->leaf[l]];
    const double side = vg_octant_side(o) * t->unit;

    if (o->id < t->n_part) volume[o->id] += side * side * side;
  }
}

static vg_status check(const struct maker *m, struct vg_error *err)
{
  const struct vg_decomposition *p = &m->out;
  const double whole = vg_load_volume(m->front);
  double *octants = vg_calloc(p->n_part, sizeof *octants), sum = 0;
  vg_status st = octants ? VG_OK : vg_fail_memory(err, "the subdomains");

  if (st == VG_OK) add_octants(&m->t, octants);
  for (size_t k = 0; st == VG_OK && k < p->n_part; k++) {
    const double volume = vg_load_volume(&p->part[k].front);
    const size_t bad = vg_front_open_edges(&p->part[k].front);

    sum += volume;
    if (bad == SIZE_MAX) st = vg_fail_memory(err, "the check of subdomains");
    else if (bad)
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "subdomain %zu of %zu of the octree is "
                   "not closed at %zu edges; check that the front is closed",
                   k + 1, p->n_part, bad);
    else if (k < m->t.n_part ? fabs(volume - octants[k]) > ROUNDING * whole
                             : !(volume > -ROUNDING * whole))
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "subdomain %zu of %zu of the octree has a "
                   "volume of %g instead of %g; check that the front is closed",
                   k + 1, p->n_part, volume, octants[k]);
  }
  if (st == VG_OK && !(fabs(sum - whole) <= ROUNDING * whole))
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "the subdomains of the octree have a volume of "
                 "%.9g, the void has %.9g; check that its front is closed",
                 sum, whole);
  free(octants);
  return st;
}

/* --- all steps ----------------------------------------------------------- */

static vg_status check_options(const struct vg_decomposition_options *o,
                               struct vg_error *err)
{
  if (o->h_refine)
    return vg_fail(err, VG_ERR_INPUT,
                   "the octree decomposition has no coarse faces whose "
                   "edges could be halved; set interfaces to remesh");
  if (o->coarsening != 0 &&
      !(o->coarsening >= LEAST && isfinite(o->coarsening)))
    return vg_fail(err, VG_ERR_INPUT,
                   "a coarsening of %g is too small: octants are at "
                   "least %g sizes wide; omit it for the automatic value",
                   o->coarsening, LEAST);
  return VG_OK;
}

static void note_parts(struct maker *m)
{
  struct vg_decomposition_report *r = &m->out.report;

  r->n_coarse = n_free(&m->t);
  r->n_apart = m->t.n_apart;
  r->n_asked = (uint64_t)m->options->n_part;
  r->n_face = m->patches.n ? m->faces.begin[m->patches.n] : 0;
  r->n_gap = m->t.n_gap;
  r->coarse_cells = m->t.cells;
  r->other_seconds = m->t.other_seconds;
}

static vg_status make(struct maker *m, struct vg_error *err)
{
  vg_status st;

  m->spent = vg_clock();
  m->gap = vg_alloc(m->front->n_face, sizeof *m->gap);
  if (!m->gap) return vg_fail_memory(err, "the subdomains");
  st = make_octants(m, err);
  if (st == VG_OK) st = vg_patches_make(&m->t, &m->patches, err);
  if (st == VG_OK)
    st = vg_interfaces_make(&m->t, &m->patches, m->sizing, m->engine, &m->faces,
                            err);
  if (st == VG_OK) st = fill_parts(m, err);
  if (st == VG_OK) st = check(m, err);
  note_time(m, VG_DECOMPOSITION_FACES);
  if (st == VG_OK) note_parts(m);
  return st;
}

vg_status vg_octree_part(const struct vg_front *front,
                         const struct vg_load *load,
                         const struct vg_sizing *sizing,
                         const struct vg_decomposition_options *o,
                         uint32_t serial, const struct vg_engine *e,
                         struct vg_decomposition *out, struct vg_error *err)
{
  struct maker m = { .front = front,
                     .load = load,
                     .sizing = sizing,
                     .options = o,
                     .engine = e,
                     .serial = serial };
  vg_status st = check_options(o, err);

  assert(front && sizing && !out->n_point && !out->n_part && !out->part);
  if (st < 0) return st;
  if (!(load->cells > 0) || !(load->unit > 0))
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "the void of %zu triangles encloses "
                   "nothing",
                   front->n_face);
  st = vg_decomposition_check_options(o, load->cells, err);
  if (st < 0) return st;
  st = make(&m, err);
  if (st == VG_OK) *out = m.out;
  else vg_decomposition_release(&m.out);
  vg_octants_release(&m.t);
  vg_patches_release(&m.patches);
  vg_interfaces_release(&m.faces);
  free(m.gap);
  return st;
}
