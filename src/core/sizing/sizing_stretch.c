/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_stretch.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing_shape.h"

enum { PROJECTIONS = 4 };

static int is_vgrid(const struct vg_source *s)
{
  return s->kind == VG_SOURCE_VGRID_NODE || s->kind == VG_SOURCE_VGRID_LINE;
}

/* Is the stretching that of a VGRID file, with a flag instead of a ratio? */
static int has_flag(const struct vg_source *s)
{
  return is_vgrid(s) && s->stretch == 1;
}

const char *vg_source_stretch_defect(const struct vg_source *s)
{
  const double *axis = has_flag(s) ? s->p : s->u;

  if (s->kind == VG_SOURCE_MACHCONE) return NULL; /* vg_mach_cone_defect */
  if (!isfinite(s->stretch) || s->stretch < 0)
    return "its stretching is negative or not finite; 0 means none";
  if (s->stretch == 0 || (s->stretch == 1 && !is_vgrid(s))) return NULL;
  if (!isfinite(vg_dot(axis, axis)) || !(vg_dot(axis, axis) > 0))
    return has_flag(s) ? "its stretching vector P (px, py, pz) has no length; "
                         "give a direction, or 0 as stretching flag"
                       : "its stretching direction (ux, uy, uz) has no "
                         "length; give a vector, or 0 as stretch";
  if (!has_flag(s)) return NULL;
  if (!(s->sp0 > 0 && isfinite(s->sp0)))
    return "its secondary spacing SP (sp0) is not positive; give a length, or "
           "0 as stretching flag";
  if (s->kind == VG_SOURCE_VGRID_LINE && !(s->sp1 > 0 && isfinite(s->sp1)))
    return "its secondary spacing SP at point 2 (sp1) is not positive; give a "
           "length, or 0 as stretching flag";
  return NULL;
}

int vg_source_stretch(const struct vg_source *s, double axis[3],
                      double ratio[2])
{
  int by_flag = has_flag(s);

  ratio[0] = ratio[1] = 1;
  if (s->stretch == 0) return 0;
  if (s->kind == VG_SOURCE_MACHCONE) { /* Its axes depend on the point. */
    vg_sub(s->p1, s->p0, axis);
    vg_unit(axis);
    ratio[0] = ratio[1] = s->stretch;
    return s->stretch != 1;
  }
  memcpy(axis, by_flag ? s->p : s->u, 3 * sizeof *axis);
  if (!(vg_unit(axis) > 0)) return 0;
  if (by_flag) {
    ratio[0] = s->sp0 / s->h0;
    ratio[1] = s->kind == VG_SOURCE_VGRID_LINE ? s->sp1 / s->h1 : ratio[0];
  } else {
    ratio[0] = ratio[1] = s->stretch;
  }
  return ratio[0] != 1 || ratio[1] != 1;
}

int vg_source_is_stretched(const struct vg_source *s)
{
  double axis[3], ratio[2];

  return vg_source_stretch(s, axis, ratio);
}

void vg_stretched_prepare(struct vg_stretched *s)
{
  double thin = fmin(1, fmin(s->ratio[0], s->ratio[1]));
  double wide = fmax(1, fmax(s->ratio[0], s->ratio[1]));

  vg_normals(s->axis[0], s->axis[1], s->axis[2]);
  if (s->law.kind == VG_SOURCE_MACHCONE)
    vg_mach_cones_prepare(&s->law, s->slope, &s->cones);
  s->least = fmin(s->law.h0 * fmin(1, s->ratio[0]),
                  s->law.h1 * fmin(1, s->ratio[1]));
  s->rise = s->slope *
            (1 - VG_GROWTH_IN_METRIC + VG_GROWTH_IN_METRIC * thin / wide);
}

/* Size tensor of a source with one axis. */
static void shape_at(const struct vg_stretched *s, const double x[3],
                     struct vg_size_axes *a)
{
  double way[3], t, d = vg_shape_way(&s->law, x, &t, way), size, along;
  double l2, factor, more;

  size = s->law.h0 + t * (s->law.h1 - s->law.h0);
  along = size * (s->ratio[0] + t * (s->ratio[1] - s->ratio[0]));
  l2 = vg_dot(way, s->axis[0]) * vg_dot(way, s->axis[0]);
  l2 = l2 / (along * along) + fmax(d * d - l2, 0) / (size * size);
  factor = 1 + VG_GROWTH_IN_METRIC * s->slope * sqrt(l2);
  more = (1 - VG_GROWTH_IN_METRIC) * s->slope * d;
  a->size[0] = factor * along + more;
  a->size[1] = a->size[2] = factor * size + more;
  memcpy(a->axis, s->axis, sizeof a->axis);
}

void vg_stretched_at(const struct vg_stretched *s, const double x[3],
                     struct vg_size_axes *a)
{
  if (s->law.kind == VG_SOURCE_MACHCONE) vg_mach_cones_axes(&s->cones, x, a);
  else shape_at(s, x, a);
}

static double shape_way(const struct vg_stretched *s, const double x[3],
                        double way[3])
{
  double t;

  return s->law.kind == VG_SOURCE_MACHCONE
         ? vg_mach_cones_way(&s->cones, x, &t, way)
         : vg_shape_way(&s->law, x, &t, way);
}

double vg_stretched_floor(const struct vg_stretched *s, const double lo[3],
                          const double hi[3])
{
  double d2 = 0;

  for (int k = 0; k < 3; k++) {
    double d = vg_greater(vg_greater(s->lo[k] - hi[k], lo[k] - s->hi[k]), 0);

    d2 += d * d;
  }
  return s->least + s->rise * sqrt(d2);
}

int vg_stretched_near(const struct vg_stretched *s, const double lo[3],
                      const double hi[3], double x[3])
{
  double way[3];

  for (int k = 0; k < 3; k++) x[k] = 0.5 * (lo[k] + hi[k]);
  for (int i = 0; i < PROJECTIONS; i++) {
    if (!(shape_way(s, x, way) > 0)) return i == 0;
    for (int k = 0; k < 3; k++)
      x[k] = vg_lesser(vg_greater(x[k] - way[k], lo[k]), hi[k]);
  }
  return 0;
}

/* --- groups: bounds --------------------------------------------------------
 */

/* Bounds are reduced, and boxes enlarged relative to their coordinates, by more
 * than rounding. */
#define ROUNDING 1e-9
#define BOX_ROUNDING 1e-13

static struct vg_stretched_bound *node_at(const struct vg_stretched_group *g,
                                          size_t i)
{
  return (struct vg_stretched_bound *)(void *)vg_box_tree_node(&g->tree, i);
}

/* Sizes along and across the axis at the squared distance d2, or less. */
static void floor_at(const struct vg_stretched_bound *b, double d2,
                     double size[2])
{
  const double d = sqrt(d2);

  for (int k = 0; k < 2; k++)
    size[k] = (1 - ROUNDING) * (b->size[k] + b->rise[k] * d);
}

/* Box around the box lo..hi in the coordinates of the group. */
static void frame_box(const struct vg_stretched_group *g, const double lo[3],
                      const double hi[3], struct vg_box *out)
{
  for (int k = 0; k < 3; k++) {
    double mid = 0, half = 0, far = 0;

    for (int j = 0; j < 3; j++) {
      mid += g->frame[k][j] * 0.5 * (lo[j] + hi[j]);
      half += fabs(g->frame[k][j]) * 0.5 * (hi[j] - lo[j]);
      far += fabs(g->frame[k][j]) * fmax(fabs(lo[j]), fabs(hi[j]));
    }
    half += BOX_ROUNDING * far;
    out->lo[k] = mid - half;
    out->hi[k] = mid + half;
  }
}

/* Corners of a shape whose hull, enlarged by the radius, is the shape. */
static int corners(const struct vg_source *s, const double *corner[3])
{
  corner[0] = s->p0;
  corner[1] = s->p1;
  corner[2] = s->p2;
  if (s->kind == VG_SOURCE_TRIANGLE) return 3;
  return s->kind == VG_SOURCE_LINE || s->kind == VG_SOURCE_VGRID_LINE ||
             s->kind == VG_SOURCE_CYLINDER
         ? 2
         : 1;
}

static void shape_box(const struct vg_stretched_group *g,
                      const struct vg_stretched *s, struct vg_box *out)
{
  const double *corner[3];
  const double r = fmax(s->law.r0,
                        s->law.kind == VG_SOURCE_CYLINDER ? s->law.r1 : 0);
  const int n = corners(&s->law, corner);

  if (s->law.kind == VG_SOURCE_BOX) {
    frame_box(g, s->lo, s->hi, out);
    return;
  }
  *out = (struct vg_box)VG_BOX_EMPTY;
  for (int i = 0; i < n; i++) {
    struct vg_box b;

    frame_box(g, corner[i], corner[i], &b);
    vg_box_join(out, &b);
  }
  for (int k = 0; k < 3; k++) {
    out->lo[k] -= r * vg_norm(g->frame[k]);
    out->hi[k] += r * vg_norm(g->frame[k]);
  }
}

/* At the distance d in these coordinates, a source is at least d / h of its
 * largest edges away, and at least `near` d. */
static void bound_source(const struct vg_stretched_group *g, double near,
                         const struct vg_stretched *s,
                         struct vg_stretched_bound *b)
{
  const double h = fmin(s->law.h0, s->law.h1),
               most = fmax(s->law.h0, s->law.h1);

  shape_box(g, s, &b->box);
  b->size[0] = h * fmin(s->ratio[0], s->ratio[1]);
  b->size[1] = h;
  for (int k = 0; k < 2; k++)
    b->rise[k] = s->slope * (VG_GROWTH_IN_METRIC * b->size[k] / most +
                             (1 - VG_GROWTH_IN_METRIC) * near);
}

static void set_frame(struct vg_stretched_group *g)
{
  double ratio = 0;

  memcpy(g->frame, g->source->axis, sizeof g->frame);
  for (size_t i = 0; i < g->n; i++)
    for (int k = 0; k < 2; k++) ratio = fmax(ratio, g->source[i].ratio[k]);
  for (int k = 0; k < 3; k++) g->frame[0][k] /= ratio;
  for (size_t i = 0; i < g->n; i++)
    bound_source(g, fmin(1, ratio), &g->source[i], &g->bound[i]);
}

static void join_bound(struct vg_stretched_bound *a,
                       const struct vg_stretched_bound *b)
{
  for (int k = 0; k < 2; k++) {
    a->size[k] = vg_lesser(a->size[k], b->size[k]);
    a->rise[k] = vg_lesser(a->rise[k], b->rise[k]);
  }
}

static void fill_nodes(struct vg_stretched_group *g)
{
  for (size_t i = 2 * g->tree.first_leaf + 1; i-- > 0;) {
    struct vg_stretched_bound *b = node_at(g, i);

    for (int k = 0; k < 2; k++) b->size[k] = b->rise[k] = INFINITY;
    if (i < g->tree.first_leaf)
      for (size_t k = 1; k < 3; k++) join_bound(b, node_at(g, 2 * i + k));
    else
      for (size_t k = vg_box_tree_first(&g->tree, i);
           k < vg_box_tree_end(&g->tree, i); k++)
        join_bound(b, &g->bound[k]);
  }
}

/* The order of the leaves is that of the sources: neighbours in a table are
 * mostly neighbours in space. */
static vg_status make_tree(struct vg_stretched_group *g, struct vg_error *err)
{
  struct vg_box *box = vg_alloc(g->n, sizeof *box);
  uint32_t *order = vg_alloc(g->n, sizeof *order);
  vg_status st = VG_OK;

  assert(g->n <= UINT32_MAX);
  g->bound = vg_alloc(g->n, sizeof *g->bound);
  if (!box || !order || !g->bound) VG_TRY(vg_fail_memory(err, "the sources"));
  set_frame(g);
  for (size_t i = 0; i < g->n; i++) {
    box[i] = g->bound[i].box;
    order[i] = (uint32_t)i;
  }
  VG_TRY(vg_box_tree_build(&g->tree, g->n, box, order, sizeof *g->bound, err));
  fill_nodes(g);
done:
  free(box);
  free(order);
  return st;
}

/* --- groups --------------------------------------------------------------- */

/* A source while it is sorted. */
struct member {
  struct vg_stretched source;
  size_t at, first; /* its position, and that of the first of its group */
};

static int by_axis(const void *pa, const void *pb)
{
  const struct member *a = pa, *b = pb;
  const int a_turns = a->source.law.kind == VG_SOURCE_MACHCONE;
  const int b_turns = b->source.law.kind == VG_SOURCE_MACHCONE;

  if (a_turns != b_turns) return a_turns - b_turns;
  for (int k = 0; k < 3 && !a_turns; k++) {
    const double u = a->source.axis[0][k], v = b->source.axis[0][k];

    if (u != v) return u < v ? -1 : 1;
  }
  return (a->at > b->at) - (a->at < b->at);
}

static int by_group(const void *pa, const void *pb)
{
  const struct member *a = pa, *b = pb;

  if (a->first != b->first) return a->first < b->first ? -1 : 1;
  return (a->at > b->at) - (a->at < b->at);
}

static int is_same_group(const struct vg_stretched *a,
                         const struct vg_stretched *b)
{
  return a->law.kind != VG_SOURCE_MACHCONE &&
         b->law.kind != VG_SOURCE_MACHCONE &&
         !memcmp(a->axis[0], b->axis[0], sizeof a->axis[0]);
}

static vg_status sort(size_t n, struct vg_stretched *s, struct vg_error *err)
{
  struct member *m = vg_alloc(n, sizeof *m);

  if (!m) return vg_fail_memory(err, "the sources");
  for (size_t i = 0; i < n; i++) m[i] = (struct member){ s[i], i, i };
  qsort(m, n, sizeof *m, by_axis);
  for (size_t i = 1; i < n; i++)
    if (is_same_group(&m[i].source, &m[i - 1].source))
      m[i].first = m[i - 1].first;
  qsort(m, n, sizeof *m, by_group);
  for (size_t i = 0; i < n; i++) s[i] = m[i].source;
  free(m);
  return VG_OK;
}

vg_status vg_stretched_groups_make(size_t n, struct vg_stretched *s,
                                   struct vg_stretched_groups *out,
                                   struct vg_error *err)
{
  struct vg_stretched_groups made = { 0 };
  vg_status st;

  assert(!out->n);
  if (!n) return VG_OK;
  VG_TRY(sort(n, s, err));
  made.item = vg_calloc(n, sizeof *made.item);
  if (!made.item) VG_TRY(vg_fail_memory(err, "the sources"));
  for (size_t i = 0; i < n; i++) {
    if (!i || !is_same_group(&s[i], &s[i - 1]))
      made.item[made.n++].source = &s[i];
    made.item[made.n - 1].n++;
  }
  for (size_t i = 0; i < made.n; i++)
    if (made.item[i].n > 1) VG_TRY(make_tree(&made.item[i], err));
  *out = made;
  made = (struct vg_stretched_groups){ 0 };
done:
  vg_stretched_groups_release(&made);
  return st;
}

void vg_stretched_groups_release(struct vg_stretched_groups *g)
{
  for (size_t i = 0; i < g->n; i++) {
    vg_box_tree_release(&g->item[i].tree);
    free(g->item[i].bound);
  }
  free(g->item);
  *g = (struct vg_stretched_groups){ 0 };
}

/* --- sizes at a point ----------------------------------------------------- */

struct nearest {
  const struct vg_stretched_group *g;
  const double *x; /* the point, and in the coordinates of the group */
  double place[3];
  double size[2];         /* smallest ones so far, along and across */
  struct vg_size_axes *a; /* its axes */
};

static int may_lower(const struct nearest *n,
                     const struct vg_stretched_bound *b, double d2)
{
  double size[2];

  floor_at(b, d2, size);
  return size[0] < n->size[0] || size[1] < n->size[1];
}

static int enter(void *context, size_t i, double d2)
{
  const struct nearest *n = context;

  return may_lower(n, node_at(n->g, i), d2);
}

static void leaf(void *context, size_t i)
{
  struct nearest *n = context;
  const struct vg_box_tree *t = &n->g->tree;

  for (size_t k = vg_box_tree_first(t, i); k < vg_box_tree_end(t, i); k++) {
    const struct vg_stretched_bound *b = &n->g->bound[k];

    if (!may_lower(n, b, vg_box_distance2(&b->box, n->place))) continue;
    vg_stretched_at(&n->g->source[k], n->x, n->a);
    for (int j = 0; j < 2; j++)
      n->size[j] = vg_lesser(n->size[j], n->a->size[j]);
  }
}

int vg_stretched_group_at(const struct vg_stretched_group *g, const double x[3],
                          double most, struct vg_size_axes *a)
{
  struct nearest n = { .g = g, .x = x, .size = { most, most }, .a = a };

  if (g->n == 1) {
    if (vg_stretched_floor(g->source, x, x) >= most) return 0;
    vg_stretched_at(g->source, x, a);
    return 1;
  }
  for (int k = 0; k < 3; k++) n.place[k] = vg_dot(g->frame[k], x);
  vg_box_tree_approach(&g->tree, n.place, enter, leaf, &n);
  if (!(n.size[0] < most || n.size[1] < most)) return 0;
  memcpy(a->axis, g->source->axis, sizeof a->axis);
  a->size[0] = n.size[0];
  a->size[1] = a->size[2] = n.size[1];
  return 1;
}

/* --- sources finer than tensors ------------------------------------------- */

struct finer {
  const struct vg_stretched_group *g;
  struct vg_box box;
  double most, within;
  size_t n;
  const double (*h)[6];
  int (*visit)(void *context, const struct vg_stretched *s);
  void *context;
};

/* May sizes of at least this floor be smaller than a tensor? The tensors are
 * compared with that of the floor, in the box. */
static int may_be_finer(const struct finer *f,
                        const struct vg_stretched_bound *b)
{
  struct vg_size_axes a;
  double size[2], h[6];

  floor_at(b, vg_box_gap2(&b->box, &f->box), size);
  if (vg_lesser(size[0], size[1]) >= f->most) return 0;
  memcpy(a.axis, f->g->source->axis, sizeof a.axis);
  a.size[0] = size[0];
  a.size[1] = a.size[2] = size[1];
  vg_size_axes_tensor(&a, h);
  for (size_t i = 0; i < f->n; i++)
    if (!vg_size_is_within(f->h[i], h, f->within)) return 1;
  return 0;
}

static int enter_finer(void *context, size_t i)
{
  const struct finer *f = context;

  return may_be_finer(f, node_at(f->g, i));
}

static int leaf_finer(void *context, size_t i)
{
  const struct finer *f = context;
  const struct vg_box_tree *t = &f->g->tree;
  int found = 0;

  for (size_t k = vg_box_tree_first(t, i); k < vg_box_tree_end(t, i) && !found;
       k++)
    if (may_be_finer(f, &f->g->bound[k]))
      found = f->visit(f->context, &f->g->source[k]);
  return found;
}

int vg_stretched_group_finer(
  const struct vg_stretched_group *g, const double lo[3], const double hi[3],
  double most, size_t n, const double (*h)[6], double within,
  int (*visit)(void *context, const struct vg_stretched *s), void *context)
{
  struct finer f = { .g = g,
                     .most = most,
                     .within = (1 - ROUNDING) * within,
                     .n = n,
                     .h = h,
                     .visit = visit,
                     .context = context };

  if (g->n == 1)
    return vg_stretched_floor(g->source, lo, hi) < most
           ? visit(context, g->source)
           : 0;
  frame_box(g, lo, hi, &f.box);
  return vg_box_tree_visit(&g->tree, enter_finer, leaf_finer, &f);
}
