/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds the surface opposite each column: triangles that face the column,
 * within a cone of 45 degrees. Bounding boxes of triangles and of their normals
 * exclude everything in most places, which is determined for groups of
 * neighbouring columns at once.
 *
 * A triangle T limits a column with unit direction u unless
 * - T shares a point with the faces of the column, or a place, if both sides of
 *   an inner surface have copies of it, or lies in a patch in which the column
 *   slides;
 * - T does not face the column: n(T) . u > -0.2. The column would hit such a
 *   triangle from behind, or only after a long way. At a concave edge, where
 *   directions turn until they leave both walls, T is such a triangle although
 *   it is as near as the edge;
 * - the columns of T grow in nearly the same direction, m . u > 0.3 for their
 *   mean m. Both then belong to one stack at a concave edge narrower than a
 *   right angle, whose columns are nearly parallel. Without this exception the
 *   distance to the other wall, which vanishes towards the edge, would end the
 *   layers there;
 * - T lies in a patch in which other columns slide, and is only in the cone.
 *   Such a patch is tested with rays only, because the neighbouring stack
 *   stands on it and must not be kept away from it.
 * The distance to all other triangles is measured along u. It does not prove
 * that columns do not collide, but gives a good initial height: vg_clear_tops
 * is exact. */
#include "layers/clear/clear_ahead.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "core/geometry/vector.h"

#define FACING 0.2 /* L10 */
#define SAME_STACK 0.3
#define SQRT_2 1.41421356237309505

enum { GRAIN = 512, STACK = 96, TEAM = 16, LEAF_MAX = 64 };

/* One column. Lengths are along u, in the unit of the surface. */
struct query {
  const struct vg_ahead *x;
  uint32_t column;
  double root[3], u[3];
  double reach;           /* Nothing farther matters; decreases during the
                             search. */
  double lowest, highest; /* Range of the starting points of the rays along u,
                             below and above the root. */
  double widest;          /* Squared distance of the farthest starting point
                             from the root. */
  double back;            /* Distance below the root at which the apex of a cone
                             that contains all rays lies. */
  int n_centre;
  double centre[VG_AHEAD_FACES][3]; /* Centres of the faces, relative to the
                                       root. */
};

/* --- one triangle -------------------------------------------------------- */

static uint32_t place_of(const struct vg_ahead *x, uint32_t point)
{
  return x->first ? x->first[point] : point;
}

static int shares_point(const struct query *q, const uint32_t tri[3])
{
  const struct vg_columns *c = q->x->columns;
  const struct vg_topology *y = q->x->topology;
  uint32_t t[3];

  for (int k = 0; k < 3; k++) t[k] = place_of(q->x, tri[k]);

  for (uint32_t i = y->first[q->column]; i < y->first[q->column + 1]; i++) {
    const uint32_t *face = c->face[y->corner[i] / 3];

    for (int k = 0; k < 3; k++) {
      uint32_t root = place_of(q->x, c->column[face[k]].root);

      if (root == t[0] || root == t[1] || root == t[2]) return 1;
    }
  }
  return 0;
}

/* Whether the columns of triangle t grow in the same direction as that of the
 * query. */
static int same_stack(const struct query *q, uint32_t t)
{
  const struct vg_ahead *x = q->x;
  uint32_t f = x->face_of[t];
  double sum[3] = { 0, 0, 0 };

  for (int k = 0; k < 3; k++) {
    uint32_t p = x->surface->tri[t][k];

    if (f != VG_NO_INDEX)
      vg_add_direction(&x->columns->column[x->columns->face[f][k]], sum);
    else
      for (uint32_t i = x->column_of[p]; i < x->column_of[p + 1]; i++)
        vg_add_direction(&x->columns->column[i], sum);
  }
  return vg_dot(sum, q->u) > SAME_STACK * sqrt(vg_dot(sum, sum));
}

/* Least distance along u, at most the reach, at which a line from the centre of
 * a face passes through the triangle (corners p, unit normal n). */
static double nearest_on_lines(const struct query *q, const double (*p)[3],
                               const double n[3])
{
  double c[3], near = q->reach, along, off, far = 0;

  /* Most triangles are too far to the side for all lines. */
  for (int k = 0; k < 3; k++) c[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
  for (int j = 0; j < 3; j++) {
    double d[3] = { p[j][0] - c[0], p[j][1] - c[1], p[j][2] - c[2] };

    far = fmax(far, vg_dot(d, d));
  }
  along = vg_dot(c, q->u);
  off = vg_dot(c, c) - along * along;
  if (off > 2.01 * (q->widest + far)) return near;
  for (int j = 0; j < q->n_centre; j++)
    vg_line_hits(q->centre[j], q->u, p, n, &near);
  return near;
}

/* Whether the triangle (corners p) is out of reach or outside the cone that
 * contains all rays. The cone lies on one side of each plane along a generator;
 * only the plane towards the triangle is tested. */
static int is_aside(const struct query *q, const double (*p)[3])
{
  double a[3], c[3], along, off, m = q->reach + q->highest;

  for (int j = 0; j < 3; j++) a[j] = vg_dot(p[j], q->u);
  if (a[0] > m && a[1] > m && a[2] > m) return 1;
  along = (a[0] + a[1] + a[2]) / 3;
  for (int k = 0; k < 3; k++)
    c[k] = (p[0][k] + p[1][k] + p[2][k]) / 3 - along * q->u[k];
  off = sqrt(vg_dot(c, c));
  for (int j = 0; j < 3; j++)
    if (!(vg_dot(p[j], c) > 1.00001 * off * (a[j] + q->back))) return 0;
  return 1;
}

/* Reduces the reach to the distance of the triangle at position i of the
 * tree. */
static void consider(struct query *q, size_t i)
{
  static const double root[3] = { 0, 0, 0 };
  const struct vg_ahead *x = q->x;
  const struct vg_column *c = &x->columns->column[q->column];
  const uint32_t *t = x->boxes.tri[i];
  uint32_t patch = x->surface->tri_patch[x->boxes.item[i]];
  double p[3][3], e[3], f[3], n[3], l, near, s;

  if (patch == c->slide[0] || patch == c->slide[1]) return;
  for (int j = 0; j < 3; j++)
    for (int k = 0; k < 3; k++)
      p[j][k] = x->surface->point[t[j]][k] - q->root[k];
  if (is_aside(q, (const double(*)[3])p)) return;
  for (int k = 0; k < 3; k++) {
    e[k] = p[1][k] - p[0][k];
    f[k] = p[2][k] - p[0][k];
  }
  vg_cross(e, f, n);
  l = sqrt(vg_dot(n, n));
  if (!(l > 0)) return;
  for (int k = 0; k < 3; k++) n[k] /= l;
  near = q->reach;
  if (x->slid[patch]) vg_line_hits(root, q->u, (const double(*)[3])p, n, &near);
  else near = vg_nearest_in_cone(q->u, (const double(*)[3])p, n, q->reach);
  s = nearest_on_lines(q, (const double(*)[3])p, n);
  if (s < near) near = s;
  if (near < q->reach && !shares_point(q, t) &&
      !same_stack(q, x->boxes.item[i]))
    q->reach = near;
}

/* --- search in the tree -------------------------------------------------- */

/* The query in the precision of the boxes. */
struct cone {
  float root[3], u[3], lo, hi, back, slack;
};

static inline vg_f4 all4(float x)
{
  return (vg_f4){ x, x, x, x };
}

/* Children that contain a normal n with n . u < -FACING + spread. */
static inline vg_i4 facing4(const struct vg_normal_boxes *s, int h,
                            const float u[3], float spread)
{
  vg_f4 least = all4(0);

  for (int k = 0; k < 3; k++)
    least += s->mid[k].v[h] * all4(u[k]) - s->half[k].v[h] * all4(fabsf(u[k]));
  return least <= all4(spread - (float)FACING + 1e-5f);
}

/* Children whose bounding spheres touch the cone with its apex `back` below the
 * root, and whose boxes lie between lo and hi along it; *first: where the boxes
 * begin. */
static inline vg_i4 in_cone4(const struct vg_box8 *n,
                             const struct vg_normal_boxes *s, int h,
                             const struct cone *c, vg_f4 *first)
{
  vg_f4 along = all4(0), half = all4(0), far = all4(0), reach;

  for (int k = 0; k < 3; k++) {
    vg_f4 lo = n->lo[k].v[h], hi = n->hi[k].v[h];
    vg_f4 mid = 0.5f * (lo + hi) - all4(c->root[k]);

    along += mid * all4(c->u[k]);
    half += 0.5f * (hi - lo) * all4(fabsf(c->u[k]));
    far += mid * mid;
  }
  half += all4(c->slack);
  *first = along - half;
  /* The distance from the cone of a point at height z and distance d from the
   * axis is (d - z) / sqrt 2. */
  reach = along + all4(c->back) + 1.4143f * s->radius.v[h] + all4(c->slack);
  return (along + half >= all4(c->lo)) & (*first <= all4(c->hi)) &
         (reach >= all4(0)) &
         (far - along * along <= reach * reach * 1.00001f) &
         facing4(s, h, c->u, 0);
}

static inline unsigned in_cone(const struct vg_ahead *x, size_t node,
                               const struct cone *c, union vg_f8 *first)
{
  const struct vg_box8 *n = &x->boxes.node[node];
  const struct vg_normal_boxes *s = &x->sides[node];

  return vg_lanes(in_cone4(n, s, 0, c, &first->v[0]),
                  in_cone4(n, s, 1, c, &first->v[1]));
}

static void cone_of(const struct query *q, struct cone *c)
{
  const struct vg_boxes *b = &q->x->boxes;

  for (int k = 0; k < 3; k++) {
    c->root[k] = (float)(q->root[k] - b->origin[k]);
    c->u[k] = (float)q->u[k];
  }
  c->lo = (float)q->lowest;
  c->hi = (float)(q->reach + q->highest);
  c->back = (float)q->back;
  /* Rounding: 2^-24 of the coordinates, and a small multiple of that in
   * sums. */
  c->slack = 1e-6f * b->extent;
}

static void look_into_leaf(struct query *q, size_t leaf, struct cone *c)
{
  union vg_f8 first;
  unsigned mask;

  c->hi = (float)(q->reach + q->highest);
  mask = in_cone(q->x, leaf, c, &first);
  for (; mask; mask &= mask - 1) {
    size_t i = 8 * leaf + (size_t)__builtin_ctz(mask);
    const float *n = q->x->normal[i];

    if (n[0] * c->u[0] + n[1] * c->u[1] + n[2] * c->u[2] < -(float)FACING)
      consider(q, i);
  }
}

/* Visits the whole tree, nearest boxes first, so that the reach shrinks
 * early. */
static void walk(struct query *q, struct cone *c)
{
  const struct vg_boxes *b = &q->x->boxes;
  struct {
    int level;
    float first;
    size_t at;
  } stack[STACK] = { { b->n_level - 1, -INFINITY, 0 } };
  int depth = 1;

  while (depth--) {
    int level = stack[depth].level, bottom = depth;
    size_t at = stack[depth].at;
    union vg_f8 first;
    unsigned mask;

    c->hi = (float)(q->reach + q->highest);
    if (stack[depth].first > c->hi) continue;
    if (!level) {
      look_into_leaf(q, at, c);
      continue;
    }
    mask = in_cone(q->x, b->first[level] + at, c, &first);
    for (; mask; mask &= mask - 1) {
      int i = __builtin_ctz(mask), j = depth++;

      for (; j > bottom && stack[j - 1].first < first.f[i]; j--)
        stack[j] = stack[j - 1];
      stack[j].level = level - 1;
      stack[j].first = first.f[i];
      stack[j].at = 8 * at + (size_t)i;
    }
  }
}

/* --- columns ------------------------------------------------------------- */

/* Centres of the faces, from which further rays start. */
static void find_centres(struct query *q)
{
  const struct vg_columns *c = q->x->columns;
  const struct vg_topology *y = q->x->topology;

  q->n_centre = 0;
  q->lowest = q->highest = q->widest = 0;
  for (uint32_t i = y->first[q->column]; i < y->first[q->column + 1]; i++) {
    const uint32_t *face = c->face[y->corner[i] / 3];
    double *x = q->centre[q->n_centre], s, w;

    /* For points with more faces the cone must suffice. */
    if (q->n_centre == VG_AHEAD_FACES) break;
    memset(x, 0, sizeof q->centre[0]);
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        x[k] += q->x->surface->point[c->column[face[j]].root][k];
    for (int k = 0; k < 3; k++) x[k] = x[k] / 3 - q->root[k];
    s = vg_dot(x, q->u);
    w = vg_dot(x, x);
    if (s < q->lowest) q->lowest = s;
    if (s > q->highest) q->highest = s;
    if (w > q->widest) q->widest = w;
    q->n_centre++;
  }
  q->back = SQRT_2 * sqrt(q->widest);
}

/* Returns 0 if the column needs no search. */
static int start_query(struct query *q, uint32_t i)
{
  const struct vg_ahead *x = q->x;
  const struct vg_column *c = &x->columns->column[i];
  double l = sqrt(vg_dot(c->dir, c->dir));

  x->allowed[i] = x->reach[i];
  if (!(l > 0 && isfinite(l) && x->reach[i] > 0)) return 0;
  q->column = i;
  for (int k = 0; k < 3; k++) {
    q->root[k] = x->surface->point[c->root][k];
    q->u[k] = c->dir[k] / l;
  }
  q->reach = x->reach[i] * l / x->gap;
  find_centres(q);
  return 1;
}

static void end_query(const struct query *q, double wanted)
{
  const struct vg_ahead *x = q->x;
  const double *d = x->columns->column[q->column].dir;
  double h = x->gap * q->reach / sqrt(vg_dot(d, d));

  if (q->reach < wanted && h < x->reach[q->column]) x->allowed[q->column] = h;
}

/* Queries of neighbouring columns, with the bounding box of their cones, and
 * their directions within `spread` of u. */
struct team {
  int n;
  struct query query[TEAM];
  float lo[3], hi[3], u[3], spread;
};

static void gather_team(struct team *t, const struct vg_boxes *b)
{
  double u[3] = { 0, 0, 0 }, l, spread = 0;

  for (int k = 0; k < 3; k++) {
    double lo = INFINITY, hi = -INFINITY;

    for (int i = 0; i < t->n; i++) {
      const struct query *q = &t->query[i];
      /* A cone of height h extends at most h sideways from its axis. */
      double h = q->reach + q->highest + q->back;
      double s = sqrt(fmax(0, 1 - q->u[k] * q->u[k]));
      double apex = q->root[k] - b->origin[k] - q->back * q->u[k];

      u[k] += q->u[k];
      lo = fmin(lo, fmin(apex, apex + h * (q->u[k] - s)));
      hi = fmax(hi, fmax(apex, apex + h * (q->u[k] + s)));
    }
    l = 1e-6 * (b->extent + (hi - lo));
    t->lo[k] = (float)(lo - l);
    t->hi[k] = (float)(hi + l);
  }
  l = sqrt(vg_dot(u, u));
  for (int k = 0; k < 3; k++) {
    u[k] = l > 0 ? u[k] / l : 0;
    t->u[k] = (float)u[k];
  }
  for (int i = 0; i < t->n; i++) {
    double d = 0;

    for (int k = 0; k < 3; k++)
      d += (t->query[i].u[k] - u[k]) * (t->query[i].u[k] - u[k]);
    if (d > spread) spread = d;
  }
  t->spread = (float)sqrt(spread);
}

static inline unsigned in_team(const struct vg_ahead *x, size_t node,
                               const struct team *t)
{
  const struct vg_box8 *n = &x->boxes.node[node];
  vg_i4 m[2];

  for (int h = 0; h < 2; h++) {
    m[h] = facing4(&x->sides[node], h, t->u, t->spread);
    for (int k = 0; k < 3; k++)
      m[h] &= (n->lo[k].v[h] <= all4(t->hi[k])) &
              (n->hi[k].v[h] >= all4(t->lo[k]));
  }
  return vg_lanes(m[0], m[1]);
}

/* Leaves that any query of the team may have to visit; LEAF_MAX + 1: too many
 * to list. */
static int leaves_of_team(const struct vg_ahead *x, const struct team *t,
                          size_t leaf[LEAF_MAX])
{
  const struct vg_boxes *b = &x->boxes;
  struct {
    int level;
    size_t at;
  } stack[STACK] = { { b->n_level - 1, 0 } };
  int depth = 1, n = 0;

  while (depth--) {
    int level = stack[depth].level;
    size_t at = stack[depth].at;
    unsigned mask = in_team(x, b->first[level] + at, t);

    if (!level) {
      if (!mask) continue;
      if (n == LEAF_MAX) return LEAF_MAX + 1;
      leaf[n++] = at;
      continue;
    }
    for (; mask; mask &= mask - 1) {
      stack[depth].level = level - 1;
      stack[depth++].at = 8 * at + (size_t)__builtin_ctz(mask);
    }
  }
  return n;
}

static void ask(const struct vg_ahead *x, struct team *t)
{
  size_t leaf[LEAF_MAX];
  int n;

  if (!t->n) return;
  gather_team(t, &x->boxes);
  n = leaves_of_team(x, t, leaf);
  for (int i = 0; i < t->n && n; i++) {
    struct query *q = &t->query[i];
    double wanted = q->reach;
    struct cone c;

    cone_of(q, &c);
    if (n > LEAF_MAX) walk(q, &c);
    else
      for (int j = 0; j < n; j++) look_into_leaf(q, leaf[j], &c);
    end_query(q, wanted);
  }
}

static void look_ahead(void *context, size_t first, size_t end, int worker)
{
  const struct vg_ahead *x = context;
  struct team t;

  (void)worker;
  for (size_t i = first; i < end; i += TEAM) {
    t.n = 0;
    for (size_t j = i; j < end && j < i + TEAM; j++) {
      t.query[t.n].x = x;
      t.n += start_query(&t.query[t.n], x->order[j]);
    }
    ask(x, &t);
  }
}

/* --- entry point --------------------------------------------------------- */

vg_status vg_clear_ahead(const struct vg_mesh *surface,
                         const struct vg_columns *columns,
                         const struct vg_topology *topology, double gap,
                         int threads, const double *reach, double *allowed,
                         struct vg_error *err)
{
  struct vg_ahead x = { .surface = surface,
                        .columns = columns,
                        .topology = topology,
                        .gap = gap,
                        .reach = reach,
                        .allowed = allowed };
  vg_status st;

  assert(reach || !columns->n_column);
  assert(allowed || !columns->n_column);
  assert(threads >= 0);
  if (!(gap > 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "the gap share of layers is %g; it must be more than 0, "
                   "since layers would have no room otherwise (setting "
                   "layer_gap)",
                   gap);
  st = vg_ahead_prepare(&x, threads, err);
  if (st == VG_OK && x.boxes.n)
    vg_parallel_for(threads, columns->n_column, GRAIN, look_ahead, &x);
  vg_ahead_release(&x);
  return st;
}
