/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/model/forecast_parts.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "partition/model/model.h"

/* M1: measured, see docs/lab/performance-parallel.md, "Model". */
const struct vg_rates vg_rates_measured = {
  .pencil = { 0, 1.3e-6, 2.5e-6, 4.2e-6, 0, 0, 0 },
  .rib = { 0, 3.9e-6, 9.6e-6, 4.2e-6, 0, 0, 0 },
  .tile = { 0, 1.7e-6, 4.3e-6, 1.6e-6, 0, 0, 0 },
  .leaf = { 0, 0.8e-6, 1.5e-6, 1.85e-6, 0, 0, 0 },
  .closing = { 2.5e-3, 0, 0, 0, 0, 0, 0 },
  .repair = { 0, 0.2e-6, 1.9e-6, 0, 0, 0, 0 },
  .plan = { 0, 0, 0, 0.021e-6, 0, 0.12e-6, 0.98 },
  .join = { 0, 0, 0, 0.04e-6, 0, 0.12e-6, 0.98 },
  .close = { 0, 0, 0, 0.025e-6, 0.3e-3, 0, 0.98 },
  .split = { 0, 0, 0, 0.045e-6, 0, 0, 0.98 },
  .discrete = { 0, 3.3e-6, 3.5e-6, 0.47, 6.7e-6, 5e-6 }, /* M9 */
  .octree = { 1.6e-6, 23e-6, 1.9e-6, 0.45, 9.5e-6, 0 },
};

/* M10: the tasks that take longer in a metric; seconds per cell and per face.
 */
static const struct {
  double pencil[2], tile[2], leaf[2], repair[2];
} metric = { { 20e-6, 18e-6 }, { 18e-6, 16e-6 }, { 4.5e-6, 6e-6 }, { 9e-6 } };

static struct vg_task_rate rate_of(const double per[2])
{
  return (
    struct vg_task_rate){ .even = per[0], .graded = per[0], .face = per[1] };
}

struct vg_rates vg_rates_in_metric(void)
{
  struct vg_rates r = vg_rates_measured;

  r.pencil = r.rib = rate_of(metric.pencil);
  r.tile = rate_of(metric.tile);
  r.leaf = rate_of(metric.leaf);
  r.repair = rate_of(metric.repair);
  return r;
}

/* Loops over fewer faces have only one or two chunks (node_split.c). */
static const double loop_faces = 5000; /* M2 */

/* Number of places per crossing of three planes where subdomains stay
 * connected, and the faces next to each; their cells, about 200, count as the
 * tiles' cells. */
static const double places_per_corner = 0.5, place_faces = 900; /* M3 */

/* Bytes of a front per face: three indices, half a point and half a global
 * id. */
static const double bytes_per_face = 28;

/* Cells per leaf of a coarse mesh (advance/coarse.c). */
static const double coarse_leaf = 20000; /* D10 */

static const struct vg_task_rate no_time = { .task = 0 };

/* If zones leave less than one cell of a block, there is no void. */
static const double least_void = 1;

struct forecast {
  struct vg_forecast *out;
  double n_handed, handed; /* Tasks since the last join, and the faces sent
                              to them. */
  struct vg_amount zones;  /* Cells of pencils and tiles. */
  char leaf[VG_PATH_MAX];  /* Path of one of the leaves. */
  const struct vg_cut_rule *rule;
  const struct vg_rates *rates;
  struct vg_error *err;
};

void vg_forecast_release(struct vg_forecast *o)
{
  free(o->node);
  vg_spans_release(&o->spans);
  memset(o, 0, sizeof *o);
}

/* Inner points have 6 cells each in the bcc lattice of the kernel (12 in an
 * octant of two points), points on the boundary fewer, as measured. */
double vg_forecast_points(double cells, double faces)
{
  assert(cells >= 0 && faces >= 0);
  return cells / 6 + 0.2 * faces;
}

/* --- tasks --------------------------------------------------------------- */

static struct vg_amount amount_of(const struct vg_load *l)
{
  struct vg_amount a = { 0, 0 };

  for (size_t i = 0; i < l->n; i++) vg_amount_add(&a, &l->octant[i], 1);
  return a;
}

static double seconds(const struct vg_task_rate *r, struct vg_amount a,
                      double faces)
{
  return r->task + r->even * (a.cells - a.graded) + r->graded * a.graded +
         r->face * faces;
}

/* a: cells that it makes; for joins the cells in the void. */
static vg_status add_task(struct forecast *c, const char *path,
                          const char *after, char kind,
                          const struct vg_task_rate *rate, struct vg_amount a,
                          double faces, double octants)
{
  struct vg_spans *s = &c->out->spans;
  int makes = kind != VG_SPAN_JOIN;
  struct vg_span span = { .kind = kind, .estimate = a.cells };

  snprintf(span.path, sizeof span.path, "%s", path);
  snprintf(span.after, sizeof span.after, "%s", after);
  span.cpu = seconds(rate, makes ? a : (struct vg_amount){ 0, 0 }, faces);
  if (faces > loop_faces)
    span.loops = rate->loops * (1 - loop_faces / faces) * span.cpu;
  if (makes) span.n_cell = (uint64_t)(a.cells + 0.5);
  span.bytes_in = (uint64_t)(bytes_per_face * faces +
                             octants * sizeof(struct vg_load_octant));
  if (kind == VG_SPAN_PENCIL || kind == VG_SPAN_TILE)
    span.bytes_out = span.bytes_in;
  return vg_spans_add(s, &span, c->err);
}
/* --- the tree ------------------------------------------------------------ */

static vg_status add_node(struct forecast *c, const struct vg_subdomain *p,
                          const struct vg_lattice *l, size_t *index)
{
  struct vg_forecast *o = c->out;
  struct vg_forecast_node *n;

  if (vg_reserve(&o->node, &o->cap_node, o->n_node + 1, sizeof *o->node))
    return vg_fail_memory(c->err, "a forecast");
  *index = o->n_node;
  n = &o->node[o->n_node++];
  memset(n, 0, sizeof *n);
  memcpy(n->path, p->path, sizeof n->path);
  memcpy(n->lo, p->lo, sizeof n->lo);
  memcpy(n->hi, p->hi, sizeof n->hi);
  n->parent = p->parent;
  n->depth = p->depth;
  n->cells = p->load.cells;
  n->faces = vg_bins_faces(&p->front);
  if (l) n->lattice = *l;
  n->lattice.n_rib = 0;
  n->lattice.rib = NULL;
  if (p->parent != SIZE_MAX) o->node[p->parent].n_child++;
  return VG_OK;
}

static double volume_of(const struct vg_load *l)
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++) {
    double side = 2 * (double)l->octant[i].half;

    sum += (double)l->octant[i].part * side * side * side;
  }
  return sum;
}

/* The estimate of vg_front_work (cut/task_data.h). */
static double work_of(const struct vg_bins *f, double volume)
{
  double faces = vg_bins_faces(f), area = 0;

  for (size_t i = 0; i < f->n; i++) {
    double h = (double)f->bit[i].h;

    area += (double)f->bit[i].n * h * h / VG_FACES_PER_SQUARE;
  }
  return area > 0 ? volume * faces / area : 0;
}

static vg_status add_leaf(struct forecast *c, const struct vg_subdomain *p,
                          struct vg_amount a, double volume, const char *after)
{
  char path[VG_PATH_MAX];
  size_t index = 0;
  vg_status st;

  VG_TRY(add_node(c, p, NULL, &index));
  c->out->n_leaf++;
  snprintf(path, sizeof path, "%.*sL", VG_PATH_MAX - 2, p->path);
  st = add_task(c, path, after, VG_SPAN_LEAF, &c->rates->leaf, a,
                c->out->node[index].faces, (double)p->load.n);
  if (st >= 0)
    c->out->spans.span[c->out->spans.n - 1].work = work_of(&p->front, volume);
  memcpy(c->leaf, path, sizeof path);
done:
  return st;
}

/* Repairs at interfaces follow after all leaves: one task per zone, each with
 * an equal share of the zones' cells, and one per subdomain with an equal
 * share of the interface triangles. */
static vg_status add_repairs(struct forecast *c,
                             const struct vg_forecast_decomposition *q)
{
  size_t n = c->out->n_pencil + c->out->n_tile, n_part = q ? q->n : 0;
  struct vg_task_rate side = { .face = q ? q->rate->repair : 0 };
  char path[VG_PATH_MAX];
  vg_status st = VG_OK;

  for (size_t k = 0; st >= 0 && k < n && c->leaf[0]; k++) {
    struct vg_amount a = { c->zones.cells / (double)n,
                           c->zones.graded / (double)n };

    snprintf(path, sizeof path, "0R%zu", k);
    st = add_task(c, path, c->leaf, VG_SPAN_REPAIR, &c->rates->repair, a,
                  a.cells, 0);
  }
  for (size_t k = 0; st >= 0 && k < n_part && c->leaf[0]; k++) {
    snprintf(path, sizeof path, "0R%zu", n + k);
    st = add_task(c, path, c->leaf, VG_SPAN_REPAIR, &side,
                  (struct vg_amount){ 0, 0 }, q->sides / (double)n_part, 0);
  }
  return st;
}

static vg_status add_join(struct forecast *c, const struct vg_subdomain *p,
                          int number, const struct vg_task_rate *rate,
                          char *after)
{
  char path[VG_PATH_MAX];
  vg_status st;

  snprintf(path, sizeof path, "%.*sJ%d", VG_PATH_MAX - 14, p->path, number);
  st = add_task(c, path, after, VG_SPAN_JOIN, rate,
                (struct vg_amount){ p->load.cells, 0 },
                vg_bins_faces(&p->front), (double)p->load.n);
  memcpy(after, path, sizeof path);
  c->n_handed = c->handed = 0;
  return st;
}

/* Adds the time that a join, the span `index`, spends on the tasks that it
 * creates. */
static void pay_tasks(struct forecast *c, size_t index,
                      const struct vg_task_rate *rate)
{
  struct vg_span *join = &c->out->spans.span[index];
  double share = join->cpu > 0 ? join->loops / join->cpu : 0;
  double took = rate->made * c->n_handed + rate->hand * c->handed;

  join->cpu += took;
  join->loops += share * took;
}

/* The zones of a stage, all of which get the front that the previous stage
 * left. after in: the task that creates them; out: one of them, if there are
 * any. */
static vg_status grow_stage(struct forecast *c, struct vg_subdomain *p,
                            const struct vg_lattice *l, int stage,
                            size_t *n_pencil, char *after)
{
  size_t count = vg_lattice_count(l, stage), n_front = p->front.n;
  char maker[VG_PATH_MAX], path[VG_PATH_MAX];
  struct vg_bins made = { .n = 0 };
  vg_status st = VG_OK;

  snprintf(maker, sizeof maker, "%s", after);
  for (size_t k = 0; k < count; k++) {
    char kind = stage < VG_LATTICE_TILES ? VG_SPAN_PENCIL : VG_SPAN_TILE;
    const struct vg_task_rate *rate = kind == VG_SPAN_TILE ? &c->rates->tile
                                    : stage < 2            ? &c->rates->pencil
                                                           : &c->rates->rib;
    struct vg_amount a;
    struct vg_region r;
    double faces;

    vg_lattice_region(l, stage, k, &r);
    VG_TRY(vg_bins_take(p, &r, &made, &a, c->err));
    faces = vg_bins_near(&p->front, n_front, &r);
    if (!(a.cells >= 1) || !(faces > 0)) continue;
    snprintf(path, sizeof path, "%.*s%c%zu", VG_PATH_MAX - 24, p->path, kind,
             kind == VG_SPAN_PENCIL ? *n_pencil : k);
    *n_pencil += kind == VG_SPAN_PENCIL;
    VG_TRY(add_task(c, path, maker, kind, rate, a, faces, 0));
    memcpy(after, path, sizeof path);
    c->n_handed++;
    c->handed += faces;
    c->out->n_pencil += kind == VG_SPAN_PENCIL;
    c->out->n_tile += kind == VG_SPAN_TILE;
    c->out->separator_cells += a.cells;
    c->zones.cells += a.cells;
    c->zones.graded += a.graded;
  }
  for (size_t k = 0; k < count; k++) {
    struct vg_region r;

    vg_lattice_region(l, stage, k, &r);
    vg_bins_cover(&p->front, p->front.n, &r);
  }
  for (size_t i = 0; st >= 0 && i < made.n; i++)
    st = vg_bins_add(&p->front, &made.bit[i], c->err);
done:
  free(made.bit);
  return st;
}

/* Subdomains may stay connected where three planes meet. */
static vg_status close_places(struct forecast *c, const struct vg_subdomain *p,
                              const struct vg_lattice *l, char *after)
{
  double corners = (double)l->n[0] * l->n[1] * l->n[2];
  size_t n = (size_t)ceil(places_per_corner * corners);
  char maker[VG_PATH_MAX], path[VG_PATH_MAX];
  vg_status st = VG_OK;

  snprintf(maker, sizeof maker, "%s", after);
  for (size_t k = 0; st >= 0 && k < n; k++) {
    snprintf(path, sizeof path, "%.*sT%zu", VG_PATH_MAX - 24, p->path,
             vg_lattice_count(l, VG_LATTICE_STAGES - 1) + k);
    st = add_task(c, path, maker, VG_SPAN_TILE, &c->rates->closing,
                  (struct vg_amount){ 0, 0 }, place_faces, 0);
    memcpy(after, path, sizeof path);
    c->n_handed++;
    c->out->n_tile++;
  }
  return st;
}

/* Joins and zones of a void. */
static vg_status grow_zones(struct forecast *c, struct vg_subdomain *p,
                            const struct vg_lattice *l, char *after)
{
  int has_corners = l->n[0] && l->n[1] && l->n[2], n_join = 0;
  const struct vg_rates *r = c->rates;
  const struct vg_task_rate *last = &r->plan;
  size_t n_pencil = 0, join = c->out->spans.n;
  vg_status st;

  VG_TRY(add_join(c, p, n_join++, last, after));
  for (int stage = 0; stage <= VG_LATTICE_STAGES; stage++) {
    size_t n = c->out->spans.n;

    if (stage < VG_LATTICE_STAGES)
      VG_TRY(grow_stage(c, p, l, stage, &n_pencil, after));
    else VG_TRY(close_places(c, p, l, after));
    if (c->out->spans.n == n) continue;
    pay_tasks(c, join, last);
    last = stage + 1 < VG_LATTICE_STAGES            ? &r->join
         : stage < VG_LATTICE_STAGES && has_corners ? &r->close
                                                    : &r->split;
    join = c->out->spans.n;
    VG_TRY(add_join(c, p, n_join++, last, after));
  }
done:
  return st;
}

static vg_status go_down(struct forecast *c, struct vg_subdomain *p,
                         const char *after);

/* Small voids are filled together. */
static vg_status add_rest(struct forecast *c, const struct vg_subdomain *from,
                          size_t parent, struct vg_blocks *b, double least,
                          const char *after)
{
  struct vg_subdomain rest = { .parent = parent, .depth = from->depth + 1 };
  struct vg_amount a = { 0, 0 };
  double volume = 0;
  vg_status st = VG_OK;

  snprintf(rest.path, sizeof rest.path, "%.*s.r", VG_PATH_MAX - 8, from->path);
  memcpy(rest.lo, from->lo, sizeof rest.lo);
  memcpy(rest.hi, from->hi, sizeof rest.hi);
  for (size_t i = 0; st >= 0 && i < b->n; i++) {
    struct vg_subdomain *p = &b->part[i];

    if (p->load.cells >= least) continue;
    rest.load.cells += p->load.cells;
    volume += volume_of(&p->load);
    for (size_t k = 0; k < p->load.n; k++)
      vg_amount_add(&a, &p->load.octant[k], 1);
    rest.load.n += p->load.n;
    for (size_t k = 0; st >= 0 && k < p->front.n; k++)
      st = vg_bins_add(&rest.front, &p->front.bit[k], c->err);
  }
  if (st >= 0 && rest.load.cells >= least_void)
    st = add_leaf(c, &rest, a, volume, after);
  free(rest.front.bit);
  return st;
}

static vg_status add_children(struct forecast *c,
                              const struct vg_subdomain *from, size_t parent,
                              struct vg_blocks *b, int used, const char *after)
{
  double sum = 0,
         least = fmax(VG_SMALL_SHARE * c->rule->leaf_cells, least_void);
  size_t number = 0;
  vg_status st = VG_OK;

  for (size_t i = 0; i < b->n; i++) sum += b->part[i].load.cells;
  for (size_t i = 0; st >= 0 && i < b->n; i++) {
    struct vg_subdomain *p = &b->part[i];

    if (!(p->load.cells > 0)) continue;
    snprintf(p->path, sizeof p->path, "%.*s.%zu", VG_PATH_MAX - 24, from->path,
             number++);
    if (p->load.cells < least) continue;
    p->parent = parent;
    p->depth = from->depth + 1;
    p->levels = from->levels > used ? from->levels - used : 0;
    if (p->load.cells > VG_NOT_PARTED * sum) {
      p->levels = from->levels;
      p->retry = from->retry + 1;
    }
    st = go_down(c, p, after);
    vg_subdomain_release(p);
  }
  return st < 0 ? st : add_rest(c, from, parent, b, least, after);
}

static vg_status cut(struct forecast *c, struct vg_subdomain *p,
                     const struct vg_lattice *l, int used, const char *maker)
{
  struct vg_blocks b = { .n = 0 };
  double before = c->out->separator_cells;
  char after[VG_PATH_MAX];
  size_t index = 0;
  vg_status st;

  snprintf(after, sizeof after, "%s", maker);
  VG_TRY(add_node(c, p, l, &index));
  VG_TRY(grow_zones(c, p, l, after));
  c->out->node[index].zone = c->out->separator_cells - before;
  VG_TRY(vg_blocks_open(&b, l, p, c->err));
  vg_subdomain_release(p);
  st = add_children(c, p, index, &b, used, after);
done:
  vg_blocks_release(&b);
  return st;
}

static vg_status go_down(struct forecast *c, struct vg_subdomain *p,
                         const char *after)
{
  struct vg_lattice l;
  vg_status st = VG_OK;
  int used = 0;

  if (p->retry < VG_RETRIES && strlen(p->path) <= VG_PATH_CUT)
    used = vg_lattice_plan(&p->load, c->rule, p->levels, p->retry, &l);
  if (used <= 0)
    return add_leaf(c, p, amount_of(&p->load), volume_of(&p->load), after);
  if (!p->retry) st = vg_lattice_add_ribs(&p->load, c->rule, &l, c->err);
  if (st >= 0) st = cut(c, p, &l, used, after);
  vg_lattice_release(&l);
  return st;
}

/* --- the whole forecast -------------------------------------------------- */

/* Places the tasks one after the other, in the order of creation. */
static void line_up(struct vg_spans *s)
{
  for (size_t i = 0; i < s->n; i++) {
    s->span[i].start = s->wall;
    s->span[i].end = s->wall += s->span[i].cpu;
  }
}

static int is_stretched(const struct vg_load *l)
{
  for (size_t i = 0; i < l->n; i++)
    for (int k = 0; k < 3; k++)
      if (l->octant[i].across[k] != l->octant[i].h) return 1;
  return 0;
}

/* The octant into which a face at x points; NULL: none near it. */
static const struct vg_load_octant *octant_at(const struct vg_load *l,
                                              const struct vg_load_finder *f,
                                              const struct vg_bin *b,
                                              const double normal[3])
{
  const double step = (double)b->h / vg_norm(normal);

  for (int i = 0; i < 4; i++) {
    double x[3];
    size_t at;

    for (int k = 0; k < 3; k++) x[k] = (double)b->x[k] + i * step * normal[k];
    at = vg_load_find(f, x);
    if (at != SIZE_MAX) return &l->octant[at];
  }
  return NULL;
}

static vg_status add_surface(const struct vg_front *v, struct vg_subdomain *p,
                             struct vg_error *err)
{
  struct vg_load_finder *finder = NULL;
  vg_status st = VG_OK;

  p->front.bit = vg_alloc(v->n_face, sizeof *p->front.bit);
  if (!p->front.bit) return vg_fail_memory(err, "a forecast");
  if (is_stretched(&p->load)) st = vg_load_finder_new(&p->load, &finder, err);
  if (st < 0) return st;
  p->front.cap = p->front.n = v->n_face;
  for (size_t i = 0; i < v->n_face; i++) {
    const double *a = v->x[v->face[i][0]], *b = v->x[v->face[i][1]];
    const double *d = v->x[v->face[i][2]];
    const struct vg_load_octant *c = NULL;
    struct vg_bin *f = &p->front.bit[i];
    double u[3], w[3], n[3];

    for (int k = 0; k < 3; k++) f->x[k] = (float)((a[k] + b[k] + d[k]) / 3);
    vg_sub(b, a, u);
    vg_sub(d, a, w);
    vg_cross(u, w, n);
    f->n = 1;
    f->h = (float)sqrt(0.5 * VG_FACES_PER_SQUARE * vg_norm(n));
    for (int k = 0; k < 3; k++) f->across[k] = f->h;
    if (finder) c = octant_at(&p->load, finder, f, n);
    if (c) memcpy(f->across, c->across, sizeof f->across);
  }
  vg_load_finder_free(finder);
  return VG_OK;
}

static vg_status add_load(const struct vg_load *load, struct vg_subdomain *p,
                          struct vg_error *err)
{
  p->load = *load;
  p->load.index = NULL;
  p->load.octant = vg_alloc(load->n, sizeof *p->load.octant);
  if (!p->load.octant) {
    p->load.n = 0;
    return vg_fail_memory(err, "a forecast");
  }
  if (load->n)
    memcpy(p->load.octant, load->octant, load->n * sizeof *load->octant);
  for (int k = 0; k < 3; k++) {
    p->lo[k] = INFINITY;
    p->hi[k] = -INFINITY;
  }
  for (size_t i = 0; i < load->n; i++)
    for (int k = 0; k < 3; k++) {
      double x = (double)load->octant[i].at[k],
             half = (double)load->octant[i].half;

      p->lo[k] = fmin(p->lo[k], x - half);
      p->hi[k] = fmax(p->hi[k], x + half);
    }
  return vg_load_index(&p->load, 1, err);
}

/* A coarse mesh that all workers make: equal leaves, and a repair task that
 * waits for them. Its cuts are included in the rate. */
static vg_status add_coarse(struct forecast *c,
                            const struct vg_forecast_decomposition *q)
{
  size_t n = (size_t)ceil(q->coarse / coarse_leaf);
  struct vg_task_rate rate = { .task = q->rate->mesh * q->coarse / (double)n };
  struct vg_amount a = { q->coarse / (double)n, 0 };
  char path[VG_PATH_MAX];
  vg_status st;

  VG_TRY(add_task(c, "1J0", "", VG_SPAN_JOIN, &no_time, a, 0, 0));
  for (size_t k = 0; k < n; k++) {
    snprintf(path, sizeof path, "1.%zuL", k);
    VG_TRY(add_task(c, path, "1J0", VG_SPAN_LEAF, &rate, a, 0, 0));
    c->out->spans.span[c->out->spans.n - 1].n_cell = 0; /* no cells of the
                                                           final mesh */
  }
  st = add_task(c, "1R0", "1.0L", VG_SPAN_REPAIR, &no_time,
                (struct vg_amount){ 0, 0 }, 0, 0);
done:
  return st;
}

/* The task that makes the subdomains, without zones. */
static vg_status add_maker(struct forecast *c, const struct vg_subdomain *root,
                           const struct vg_forecast_decomposition *q)
{
  int has_mesh = q->rate->mesh > 0 && q->coarse > 0;
  struct vg_span *made;
  vg_status st = has_mesh ? add_coarse(c, q) : VG_OK;

  if (st >= 0)
    st = add_task(c, "0J0", has_mesh ? "1R0" : "", VG_SPAN_JOIN, &no_time,
                  (struct vg_amount){ root->load.cells, 0 },
                  vg_bins_faces(&root->front), (double)root->load.n);
  if (st < 0) return st;
  made = &c->out->spans.span[c->out->spans.n - 1];
  made->cpu = q->rate->face * vg_bins_faces(&root->front) +
              q->rate->coarse * q->coarse + q->rate->side * q->sides;
  made->loops = q->rate->loops * made->cpu;
  return VG_OK;
}

static vg_status add_part(struct forecast *c, const struct vg_subdomain *root,
                          const struct vg_forecast_part *from, size_t number)
{
  struct vg_subdomain p = { .parent = 0, .depth = 1, .levels = root->levels };
  vg_status st;

  snprintf(p.path, sizeof p.path, "0.%zu", number);
  VG_TRY(add_load(from->load, &p, c->err));
  VG_TRY(add_surface(&from->v, &p, c->err));
  st = from->may_cut
       ? go_down(c, &p, "0J0")
       : add_leaf(c, &p, amount_of(&p.load), volume_of(&p.load), "0J0");
done:
  vg_subdomain_release(&p);
  return st;
}

static vg_status add_parts(struct forecast *c, struct vg_subdomain *root,
                           const struct vg_forecast_decomposition *q)
{
  size_t index = 0;
  vg_status st;

  VG_TRY(add_node(c, root, NULL, &index));
  VG_TRY(add_maker(c, root, q));
  for (size_t k = 0; st >= 0 && k < q->n; k++)
    st = add_part(c, root, &q->part[k], k);
done:
  return st;
}

vg_status vg_forecast_parted(
  const struct vg_front *v, const struct vg_load *load,
  const struct vg_forecast_decomposition *decomposition,
  const struct vg_cut_rule *rule, int levels, const struct vg_rates *rates,
  struct vg_forecast *out, struct vg_error *err)
{
  struct vg_forecast o = VG_FORECAST_INIT;
  struct forecast c = { .out = &o, .rule = rule, .rates = rates, .err = err };
  struct vg_subdomain root = { .path = "0",
                               .parent = SIZE_MAX,
                               .levels = levels };
  vg_status st;

  assert(rule && rates && out && levels >= 0);
  o.cells = load->cells;
  VG_TRY(add_load(load, &root, err));
  VG_TRY(add_surface(v, &root, err));
  if (decomposition) VG_TRY(add_parts(&c, &root, decomposition));
  else VG_TRY(go_down(&c, &root, ""));
  VG_TRY(add_repairs(&c, decomposition));
  line_up(&o.spans);
  vg_spans_sort(&o.spans);
  o.spans.n_rank = o.spans.n_thread = 1;
  vg_forecast_release(out);
  *out = o;
  memset(&o, 0, sizeof o);
done:
  vg_subdomain_release(&root);
  vg_forecast_release(&o);
  return st;
}

vg_status vg_forecast_new(const struct vg_front *v, const struct vg_load *load,
                          const struct vg_cut_rule *rule, int levels,
                          const struct vg_rates *rates, struct vg_forecast *out,
                          struct vg_error *err)
{
  assert(rule && rates && out && levels >= 0);
  return vg_forecast_parted(v, load, NULL, rule, levels, rates, out, err);
}
