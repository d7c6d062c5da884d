#include "partition/forecast.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/model.h"

/* Measured: docs/performance.md, Model. */
const struct vg_rates vg_rates_measured = {
  .pencil = { 0, 1.6e-6, 2.9e-6, 5e-6, 0, 0, 0 },
  .rib = { 0, 5.5e-6, 10.5e-6, 5e-6, 0, 0, 0 },
  .tile = { 0, 2.5e-6, 4.6e-6, 1.9e-6, 0, 0, 0 },
  .leaf = { 0, 1e-6, 1.6e-6, 2.3e-6, 0, 0, 0 },
  .closing = { 2.5e-3, 0, 0, 0, 0, 0, 0 },
  .repair = { 0, 0.2e-6, 1.9e-6, 0, 0, 0, 0 },
  .plan = { 0, 0, 0, 0.021e-6, 0, 0.12e-6, 0.98 },
  .join = { 0, 0, 0, 0.04e-6, 0, 0.12e-6, 0.98 },
  .close = { 0, 0, 0, 0.025e-6, 0.3e-3, 0, 0.98 },
  .split = { 0, 0, 0, 0.045e-6, 0, 0, 0.98 },
};

/* Loops over fewer faces are of one chunk or two (node_split.c). */
static const double loop_faces = 5000;

/* Where three planes meet, so many places are left where parts hang together,
 * with so many faces beside them; their cells, some 200, count as the tiles'. */
static const double places_per_corner = 0.5, place_faces = 900;

/* Cells of a zone reach this many spacings to each side of its plane, those of
 * a pencil of both of its planes: as measured over boxes and spheres. */
static const double tile_reach = 0.57, pencil_reach = 1.9;
static const double rib_reach = 0.5;

/* Faces of a triangle's own spacing to a square of it, 4 / sqrt(3). */
static const double faces_per_square = 2.309;

/* Where spacing varies a load has this share more cells to a cube of it
 * (load.c); there they cost more as well. */
static const double graded_more = 0.21;

/* Bytes of a front per face: three indices, half a point and its name. */
static const double bytes_per_face = 28;

/* As node.h and node_split.c have them. */
enum { RETRIES = 5 };
static const double small_share = 0.02, not_parted = 0.9;

/* A stretch of front: n faces about x. */
struct bit { float x[3], h, n; };

struct front { size_t n, cap; struct bit *bit; };

/* Cells, and how many of them lie where spacing varies. */
struct amount { double cells, graded; };

/* A void on its way down the tree. */
struct part {
  struct vg_load load;
  struct front front;
  double lo[3], hi[3];
  char path[VG_PATH_MAX];
  size_t parent;
  int depth, levels, retry;
};

struct forecast {
  struct vg_outlook *out;
  double n_handed, handed;   /* tasks since the last join, faces they got */
  struct amount zones;       /* made by pencils and tiles */
  char leaf[VG_PATH_MAX];    /* one of the leaves */
  const struct vg_cut_rule *rule;
  const struct vg_rates *rates;
  struct vg_error *err;
};

void vg_outlook_release(struct vg_outlook *o)
{
  free(o->node);
  vg_spans_release(&o->spans);
  memset(o, 0, sizeof *o);
}

/* Inner points have 6 cells each in the lattice that fills make (12 in a cube
 * of two points), points on the boundary fewer, as measured. */
double vg_outlook_points(double cells, double faces)
{
  return cells / 6 + 0.2 * faces;
}

static void part_release(struct part *p)
{
  vg_load_release(&p->load);
  free(p->front.bit);
  memset(&p->front, 0, sizeof p->front);
}

static double faces_of(const struct front *f)
{
  double sum = 0;

  for (size_t i = 0; i < f->n; i++) sum += (double)f->bit[i].n;
  return sum;
}

static vg_status add_bit(struct front *f, const struct bit *b,
                         struct vg_error *err)
{
  if (vg_reserve(&f->bit, &f->cap, f->n + 1, sizeof *f->bit))
    return vg_fail_memory(err, "a forecast");
  f->bit[f->n++] = *b;
  return VG_OK;
}

/* --- tasks --------------------------------------------------------------- */

/* Of a share of a cube. */
static void add_amount(struct amount *a, const struct vg_load_cube *c,
                       double share)
{
  double side = 2 * (double)c->half / (double)c->h, cells = (double)c->cells;
  double cubes = (double)c->part * side * side * side;
  double more = cubes > 0 ? cells / (cubes * VG_LOAD_CELLS_PER_CUBE) - 1 : 0;

  a->cells += share * cells;
  a->graded += share * cells * fmin(fmax(more / graded_more, 0), 1);
}

static struct amount amount_of(const struct vg_load *l)
{
  struct amount a = {0, 0};

  for (size_t i = 0; i < l->n; i++) add_amount(&a, &l->cube[i], 1);
  return a;
}

static double seconds(const struct vg_task_rate *r, struct amount a,
                      double faces)
{
  return r->task + r->even * (a.cells - a.graded) + r->graded * a.graded +
         r->face * faces;
}

/* a: what it makes; for joins what is in the void. */
static vg_status add_task(struct forecast *c, const char *path,
                          const char *after, char kind,
                          const struct vg_task_rate *rate, struct amount a,
                          double faces, double cubes)
{
  struct vg_spans *s = &c->out->spans;
  int makes = kind != VG_SPAN_JOIN;
  struct vg_span span = { .kind = kind, .estimate = a.cells };

  snprintf(span.path, sizeof span.path, "%s", path);
  snprintf(span.after, sizeof span.after, "%s", after);
  span.cpu = seconds(rate, makes ? a : (struct amount){0, 0}, faces);
  if (faces > loop_faces)
    span.loops = rate->loops * (1 - loop_faces / faces) * span.cpu;
  if (makes) span.n_cell = (uint64_t)(a.cells + 0.5);
  span.bytes_in = (uint64_t)(bytes_per_face * faces +
                             cubes * sizeof(struct vg_load_cube));
  if (kind == VG_SPAN_PENCIL || kind == VG_SPAN_TILE)
    span.bytes_out = span.bytes_in;
  return vg_spans_add(s, &span, c->err);
}

/* --- zones --------------------------------------------------------------- */

/* The axis of a plane of a lattice. */
static int axis_of(const struct vg_plane *p)
{
  return p->normal[0] > 0.5 ? 0 : p->normal[1] > 0.5 ? 1 : 2;
}

static double side_of_plane(const struct vg_plane *p, const float x[3])
{
  return p->normal[0] * (double)x[0] + p->normal[1] * (double)x[1] +
         p->normal[2] * (double)x[2] - p->offset;
}

/* Half the extent of a cube across a plane. */
static double half_across(const struct vg_load_cube *c,
                          const struct vg_plane *p)
{
  return (double)c->half *
         (fabs(p->normal[0]) + fabs(p->normal[1]) + fabs(p->normal[2]));
}

/* Part of the cube within `width` of the plane. */
static double overlap(const struct vg_load_cube *c, const struct vg_plane *p,
                      double width)
{
  double x = side_of_plane(p, c->at), half = half_across(c, p);
  double lo = fmax(x - half, -width), hi = fmin(x + half, width);

  return hi > lo ? (hi - lo) / (2 * half) : 0;
}

/* Spacings from its planes that a zone's cells reach. */
static double reach_of(const struct vg_region *r)
{
  return r->n_plane == 1 ? tile_reach : r->reach > 0 ? pencil_reach
                                                     : rib_reach;
}

/* Is the foot of x on the planes within the walls, moved out by `band`? */
static int is_over(const struct vg_region *r, const float x[3], double band)
{
  double at[3] = {(double)x[0], (double)x[1], (double)x[2]}, foot[3];

  vg_region_foot(r, at, foot);
  for (int k = 0; k < r->n_wall; k++) {
    const double *n = r->wall[k].normal;

    if (!(n[0] * foot[0] + n[1] * foot[1] + n[2] * foot[2] >
          r->wall[k].offset - band))
      return 0;
  }
  return 1;
}

static int is_near(const struct vg_region *r, const float x[3], double band)
{
  for (int k = 0; k < r->n_plane; k++)
    if (fabs(side_of_plane(&r->plane[k], x)) > band) return 0;
  return 1;
}

/* Faces that a zone leaves where it passes the cube: on both sides of its
 * plane, or all around a pencil. */
static vg_status add_sides(const struct vg_load_cube *c,
                           const struct vg_region *r, struct front *f,
                           struct vg_error *err)
{
  double side = 2 * (double)c->half, h = (double)c->h;
  double reach = reach_of(r) * h;
  double area = (double)c->part * side * side;
  struct bit b = { .h = c->h };
  vg_status st = VG_OK;

  memcpy(b.x, c->at, sizeof b.x);
  if (r->n_plane > 1) {
    double at[3] = {(double)b.x[0], (double)b.x[1], (double)b.x[2]}, foot[3];

    vg_region_foot(r, at, foot);
    for (int k = 0; k < 3; k++) b.x[k] = (float)foot[k];
    area = (double)c->part * side * 8 * reach;
    b.n = (float)(area * faces_per_square / (h * h));
    return add_bit(f, &b, err);
  }
  b.n = (float)(area * faces_per_square / (h * h));
  for (int sign = -1; st >= 0 && sign <= 1; sign += 2) {
    b.x[axis_of(&r->plane[0])] =
      (float)(r->plane[0].offset + sign * 1.01 * reach);
    st = add_bit(f, &b, err);
  }
  return st;
}

/* Front that a zone has closed in. */
static void cover(struct front *f, size_t n, const struct vg_region *r)
{
  double reach = reach_of(r);
  size_t left = 0;

  for (size_t i = 0; i < f->n; i++)
    if (i >= n || !is_near(r, f->bit[i].x, reach * (double)f->bit[i].h) ||
        !is_over(r, f->bit[i].x, 0))
      f->bit[left++] = f->bit[i];
  f->n = left;
}

static double faces_near(const struct front *f, size_t n,
                         const struct vg_region *r)
{
  double band = vg_region_band(r, VG_BAND_FRONT), sum = 0;

  for (size_t i = 0; i < n; i++) {
    const struct bit *b = &f->bit[i];

    if (is_near(r, b->x, band * (double)b->h) &&
        is_over(r, b->x, VG_BAND_FRONT * (double)b->h))
      sum += (double)b->n;
  }
  return sum;
}

/* Cells of the region leave the load and, if it has a front, make sides. */
static vg_status take(struct part *p, const struct vg_region *r,
                      struct front *made, struct amount *a,
                      struct vg_error *err)
{
  vg_status st = VG_OK;

  *a = (struct amount){0, 0};
  for (size_t i = 0; st >= 0 && i < p->load.n; i++) {
    struct vg_load_cube *c = &p->load.cube[i];
    double reach = reach_of(r), share = 1;
    int passes = 1;

    for (int k = 0; share > 0 && k < r->n_plane; k++)
      share *= overlap(c, &r->plane[k], reach * (double)c->h);
    if (!(share > 0) || !is_over(r, c->at, 0)) continue;
    for (int k = 0; k < r->n_plane; k++)
      passes &= fabs(side_of_plane(&r->plane[k], c->at)) <=
                half_across(c, &r->plane[k]);
    if (passes) st = add_sides(c, r, made, err);
    add_amount(a, c, share);
    c->cells *= (float)(1 - share);
    c->part *= (float)(1 - share);
  }
  return st;
}

/* The zones of a stage. All see the front that the stage before left.
 * after in: the task that makes them; out: one of them, if there is any. */
static vg_status grow_stage(struct forecast *c, struct part *p,
                            const struct vg_lattice *l, int stage,
                            size_t *n_pencil, char *after)
{
  size_t count = vg_lattice_count(l, stage), n_front = p->front.n;
  char maker[VG_PATH_MAX], path[VG_PATH_MAX];
  struct front made = { .n = 0 };
  vg_status st = VG_OK;

  snprintf(maker, sizeof maker, "%s", after);
  for (size_t k = 0; k < count; k++) {
    char kind = stage < VG_LATTICE_TILES ? VG_SPAN_PENCIL : VG_SPAN_TILE;
    const struct vg_task_rate *rate = kind == VG_SPAN_TILE ? &c->rates->tile
                                      : stage < 2 ? &c->rates->pencil
                                                  : &c->rates->rib;
    struct amount a;
    struct vg_region r;
    double faces;

    vg_lattice_region(l, stage, k, &r);
    VG_TRY(take(p, &r, &made, &a, c->err));
    faces = faces_near(&p->front, n_front, &r);
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
    c->out->zone_cells += a.cells;
    c->zones.cells += a.cells;
    c->zones.graded += a.graded;
  }
  for (size_t k = 0; k < count; k++) {
    struct vg_region r;

    vg_lattice_region(l, stage, k, &r);
    cover(&p->front, p->front.n, &r);
  }
  for (size_t i = 0; st >= 0 && i < made.n; i++)
    st = add_bit(&p->front, &made.bit[i], c->err);
done:
  free(made.bit);
  return st;
}

/* --- blocks -------------------------------------------------------------- */

struct blocks {
  const struct vg_lattice *l;
  size_t n;
  struct part *part;         /* [n] x first */
};

static int side_of(const struct vg_lattice *l, int axis, double x)
{
  int k = 0;

  while (k < l->n[axis] && x > l->at[axis][k]) k++;
  return k;
}

static struct part *block_at(struct blocks *b, const int at[3])
{
  return &b->part[at[0] + (b->l->n[0] + 1) *
                  (at[1] + (b->l->n[1] + 1) * at[2])];
}

static vg_status share_load(struct blocks *b, const struct vg_load *load,
                            struct vg_error *err)
{
  const double *const at[3] = { b->l->at[0], b->l->at[1], b->l->at[2] };
  struct vg_load *out = vg_calloc(b->n, sizeof *out);
  vg_status st = out ? VG_OK : vg_fail_memory(err, "a forecast");

  if (st >= 0)
    st = vg_load_split_blocks(load, b->l->n, at, 0, 1, NULL, out, err);
  for (size_t i = 0; st >= 0 && i < b->n; i++) b->part[i].load = out[i];
  free(out);
  return st;
}

static vg_status share_front(struct blocks *b, const struct front *f,
                             struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; st >= 0 && i < f->n; i++) {
    int at[3];

    for (int k = 0; k < 3; k++)
      at[k] = side_of(b->l, k, (double)f->bit[i].x[k]);
    st = add_bit(&block_at(b, at)->front, &f->bit[i], err);
  }
  return st;
}

static void set_box(const struct blocks *b, const struct part *from, size_t i)
{
  struct part *p = &b->part[i];

  for (int k = 0; k < 3; k++) {
    int n = b->l->n[k], at = (int)(i % (size_t)(n + 1));

    i /= (size_t)(n + 1);
    p->lo[k] = at > 0 ? b->l->at[k][at - 1] : from->lo[k];
    p->hi[k] = at < n ? b->l->at[k][at] : from->hi[k];
  }
}

static void blocks_release(struct blocks *b)
{
  for (size_t i = 0; i < b->n; i++) part_release(&b->part[i]);
  free(b->part);
}

static vg_status open_blocks(struct blocks *b, const struct vg_lattice *l,
                             struct part *p, struct vg_error *err)
{
  vg_status st;

  b->l = l;
  b->n = (size_t)((l->n[0] + 1) * (l->n[1] + 1) * (l->n[2] + 1));
  b->part = vg_calloc(b->n, sizeof *b->part);
  if (!b->part) {
    b->n = 0;
    return vg_fail_memory(err, "a forecast");
  }
  st = share_load(b, &p->load, err);
  if (st >= 0) st = share_front(b, &p->front, err);
  for (size_t i = 0; i < b->n; i++) set_box(b, p, i);
  return st;
}

/* --- the tree ------------------------------------------------------------ */

static vg_status add_node(struct forecast *c, const struct part *p,
                          const struct vg_lattice *l, size_t *index)
{
  struct vg_outlook *o = c->out;
  struct vg_outlook_node *n;

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
  n->faces = faces_of(&p->front);
  if (l) n->lattice = *l;
  n->lattice.n_rib = 0;
  n->lattice.rib = NULL;
  if (p->parent != SIZE_MAX) o->node[p->parent].n_child++;
  return VG_OK;
}

static vg_status add_leaf(struct forecast *c, const struct part *p,
                          struct amount a, const char *after)
{
  char path[VG_PATH_MAX];
  size_t index = 0;
  vg_status st;

  VG_TRY(add_node(c, p, NULL, &index));
  c->out->n_leaf++;
  snprintf(path, sizeof path, "%.*sL", VG_PATH_MAX - 2, p->path);
  st = add_task(c, path, after, VG_SPAN_LEAF, &c->rates->leaf, a,
                c->out->node[index].faces, (double)p->load.n);
  memcpy(c->leaf, path, sizeof path);
done:
  return st;
}

/* Cells beside interfaces get better when all leaves are there: as many tasks
 * as zones, each with an equal share of their cells. */
static vg_status add_repairs(struct forecast *c)
{
  size_t n = c->out->n_pencil + c->out->n_tile;
  char path[VG_PATH_MAX];
  vg_status st = VG_OK;

  for (size_t k = 0; st >= 0 && k < n && c->leaf[0]; k++) {
    struct amount a = { c->zones.cells / (double)n,
                        c->zones.graded / (double)n };

    snprintf(path, sizeof path, "0R%zu", k);
    st = add_task(c, path, c->leaf, VG_SPAN_REPAIR, &c->rates->repair, a,
                  a.cells, 0);
  }
  return st;
}

static vg_status add_join(struct forecast *c, const struct part *p, int number,
                          const struct vg_task_rate *rate, char *after)
{
  char path[VG_PATH_MAX];
  vg_status st;

  snprintf(path, sizeof path, "%.*sJ%d", VG_PATH_MAX - 14, p->path, number);
  st = add_task(c, path, after, VG_SPAN_JOIN, rate,
                (struct amount){p->load.cells, 0}, faces_of(&p->front),
                (double)p->load.n);
  memcpy(after, path, sizeof path);
  c->n_handed = c->handed = 0;
  return st;
}

/* What a join, the span `index`, spends on the tasks that it makes. */
static void pay_tasks(struct forecast *c, size_t index,
                      const struct vg_task_rate *rate)
{
  struct vg_span *join = &c->out->spans.span[index];
  double share = join->cpu > 0 ? join->loops / join->cpu : 0;
  double took = rate->made * c->n_handed + rate->hand * c->handed;

  join->cpu += took;
  join->loops += share * took;
}

/* Where three planes meet parts may still hang together. */
static vg_status close_places(struct forecast *c, const struct part *p,
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
                  (struct amount){0, 0}, place_faces, 0);
    memcpy(after, path, sizeof path);
    c->n_handed++;
    c->out->n_tile++;
  }
  return st;
}

/* Joins and zones of a void. */
static vg_status grow_zones(struct forecast *c, struct part *p,
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
    last = stage + 1 < VG_LATTICE_STAGES ? &r->join
           : stage < VG_LATTICE_STAGES && has_corners ? &r->close
                                                      : &r->split;
    join = c->out->spans.n;
    VG_TRY(add_join(c, p, n_join++, last, after));
  }
done:
  return st;
}

static vg_status go_down(struct forecast *c, struct part *p,
                         const char *after);

/* Small voids are filled together. */
static vg_status add_rest(struct forecast *c, const struct part *from,
                          size_t parent, struct blocks *b, double least,
                          const char *after)
{
  struct part rest = { .parent = parent, .depth = from->depth + 1 };
  struct amount a = {0, 0};
  vg_status st = VG_OK;

  snprintf(rest.path, sizeof rest.path, "%.*s.r", VG_PATH_MAX - 8,
           from->path);
  memcpy(rest.lo, from->lo, sizeof rest.lo);
  memcpy(rest.hi, from->hi, sizeof rest.hi);
  for (size_t i = 0; st >= 0 && i < b->n; i++) {
    struct part *p = &b->part[i];

    if (p->load.cells >= least) continue;
    rest.load.cells += p->load.cells;
    for (size_t k = 0; k < p->load.n; k++)
      add_amount(&a, &p->load.cube[k], 1);
    rest.load.n += p->load.n;
    for (size_t k = 0; st >= 0 && k < p->front.n; k++)
      st = add_bit(&rest.front, &p->front.bit[k], c->err);
  }
  if (st >= 0 && rest.load.cells > 0) st = add_leaf(c, &rest, a, after);
  free(rest.front.bit);
  return st;
}

static vg_status add_children(struct forecast *c, const struct part *from,
                              size_t parent, struct blocks *b, int used,
                              const char *after)
{
  double sum = 0, least = small_share * c->rule->leaf_cells;
  size_t number = 0;
  vg_status st = VG_OK;

  for (size_t i = 0; i < b->n; i++) sum += b->part[i].load.cells;
  for (size_t i = 0; st >= 0 && i < b->n; i++) {
    struct part *p = &b->part[i];

    if (!(p->load.cells > 0)) continue;
    snprintf(p->path, sizeof p->path, "%.*s.%zu", VG_PATH_MAX - 24,
             from->path, number++);
    if (p->load.cells < least) continue;
    p->parent = parent;
    p->depth = from->depth + 1;
    p->levels = from->levels > used ? from->levels - used : 0;
    if (p->load.cells > not_parted * sum) {
      p->levels = from->levels;
      p->retry = from->retry + 1;
    }
    st = go_down(c, p, after);
    part_release(p);
  }
  return st < 0 ? st : add_rest(c, from, parent, b, least, after);
}

static vg_status cut(struct forecast *c, struct part *p,
                     const struct vg_lattice *l, int used, const char *maker)
{
  struct blocks b = { .n = 0 };
  double before = c->out->zone_cells;
  char after[VG_PATH_MAX];
  size_t index = 0;
  vg_status st;

  snprintf(after, sizeof after, "%s", maker);
  VG_TRY(add_node(c, p, l, &index));
  VG_TRY(grow_zones(c, p, l, after));
  c->out->node[index].zone = c->out->zone_cells - before;
  VG_TRY(open_blocks(&b, l, p, c->err));
  part_release(p);
  st = add_children(c, p, index, &b, used, after);
done:
  blocks_release(&b);
  return st;
}

static vg_status go_down(struct forecast *c, struct part *p,
                         const char *after)
{
  struct vg_lattice l;
  vg_status st = VG_OK;
  int used = 0;

  if (p->retry < RETRIES && strlen(p->path) + 8 < VG_PATH_MAX)
    used = vg_lattice_plan(&p->load, c->rule, p->levels, p->retry, &l);
  if (used <= 0) return add_leaf(c, p, amount_of(&p->load), after);
  if (!p->retry) st = vg_lattice_add_ribs(&p->load, c->rule, &l, c->err);
  if (st >= 0) st = cut(c, p, &l, used, after);
  vg_lattice_release(&l);
  return st;
}

/* --- the whole ----------------------------------------------------------- */

/* One task after the other, as they were made. */
static void line_up(struct vg_spans *s)
{
  for (size_t i = 0; i < s->n; i++) {
    s->span[i].start = s->wall;
    s->span[i].end = s->wall += s->span[i].cpu;
  }
}

static vg_status add_surface(const struct vg_void *v, struct part *p,
                             struct vg_error *err)
{
  p->front.bit = vg_alloc(v->n_face, sizeof *p->front.bit);
  if (!p->front.bit) return vg_fail_memory(err, "a forecast");
  p->front.cap = p->front.n = v->n_face;
  for (size_t i = 0; i < v->n_face; i++) {
    const double *a = v->x[v->face[i][0]], *b = v->x[v->face[i][1]];
    const double *d = v->x[v->face[i][2]];
    struct bit *f = &p->front.bit[i];
    double u[3], w[3], n[3];

    for (int k = 0; k < 3; k++) {
      f->x[k] = (float)((a[k] + b[k] + d[k]) / 3);
      u[k] = b[k] - a[k];
      w[k] = d[k] - a[k];
    }
    n[0] = u[1] * w[2] - u[2] * w[1];
    n[1] = u[2] * w[0] - u[0] * w[2];
    n[2] = u[0] * w[1] - u[1] * w[0];
    f->n = 1;
    f->h = (float)sqrt(0.5 * faces_per_square *
                       sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]));
  }
  return VG_OK;
}

static vg_status add_load(const struct vg_load *load, struct part *p,
                          struct vg_error *err)
{
  p->load = *load;
  p->load.index = NULL;
  p->load.cube = vg_alloc(load->n, sizeof *p->load.cube);
  if (!p->load.cube) {
    p->load.n = 0;
    return vg_fail_memory(err, "a forecast");
  }
  if (load->n)
    memcpy(p->load.cube, load->cube, load->n * sizeof *load->cube);
  for (int k = 0; k < 3; k++) {
    p->lo[k] = INFINITY;
    p->hi[k] = -INFINITY;
  }
  for (size_t i = 0; i < load->n; i++)
    for (int k = 0; k < 3; k++) {
      double x = (double)load->cube[i].at[k], half = (double)load->cube[i].half;

      p->lo[k] = fmin(p->lo[k], x - half);
      p->hi[k] = fmax(p->hi[k], x + half);
    }
  return vg_load_index(&p->load, 1, err);
}

vg_status vg_outlook_new(const struct vg_void *v, const struct vg_load *load,
                         const struct vg_cut_rule *rule, int levels,
                         const struct vg_rates *rates, struct vg_outlook *out,
                         struct vg_error *err)
{
  struct vg_outlook o = VG_OUTLOOK_INIT;
  struct forecast c = { .out = &o, .rule = rule, .rates = rates, .err = err };
  struct part root = { .path = "0", .parent = SIZE_MAX, .levels = levels };
  vg_status st;

  o.cells = load->cells;
  VG_TRY(add_load(load, &root, err));
  VG_TRY(add_surface(v, &root, err));
  VG_TRY(go_down(&c, &root, ""));
  VG_TRY(add_repairs(&c));
  line_up(&o.spans);
  vg_spans_sort(&o.spans);
  o.spans.n_rank = o.spans.n_thread = 1;
  vg_outlook_release(out);
  *out = o;
  memset(&o, 0, sizeof o);
done:
  part_release(&root);
  vg_outlook_release(&o);
  return st;
}
