/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Columns built by hand for the tests of join: a hipped roof whose ridges have
 * fans, under an apex, with a cone of cells filling the rest. Header only. */
#ifndef TESTS_UNIT_JOIN_SUPPORT_H
#define TESTS_UNIT_JOIN_SUPPORT_H

#include "fill_shapes.h"
#include "grow.h"
#include "layers/expand/join.h"

struct model {
  struct vg_mesh surface, field;
  struct vg_layers layers;
  uint32_t apex;
  size_t room_column, room_face, room_border;
};

#define MODEL_WALL 1 /* patch; 0, 2, 3, ... are those of the cone */

static inline void model_release(struct model *m)
{
  vg_mesh_release(&m->surface);
  vg_mesh_release(&m->field);
  vg_columns_release(&m->layers.columns);
  vg_front_release(&m->layers.front);
  memset(m, 0, sizeof *m);
}

static inline uint32_t model_column(struct model *m, uint32_t root,
                                    const double dir[3])
{
  struct vg_columns *c = &m->layers.columns;
  struct vg_column *column;

  if (vg_reserve(&c->column, &m->room_column, c->n_column + 1,
                 sizeof *c->column))
    abort();
  column = &c->column[c->n_column];
  memset(column, 0, sizeof *column);
  column->root = root;
  column->slide[0] = column->slide[1] = VG_NO_INDEX;
  memcpy(column->dir, dir, sizeof column->dir);
  column->cap = INFINITY;
  column->bent = SIZE_MAX;
  return (uint32_t)c->n_column++;
}

/* Virtual if tri is VG_NO_INDEX. */
static inline void model_face(struct model *m, uint32_t a, uint32_t b,
                              uint32_t c, uint32_t tri)
{
  struct vg_columns *s = &m->layers.columns;
  size_t room = m->room_face;

  if (vg_reserve(&s->face, &room, s->n_face + 1, sizeof *s->face)) abort();
  if (vg_reserve(&s->face_tri, &m->room_face, s->n_face + 1,
                 sizeof *s->face_tri))
    abort();
  s->face[s->n_face][0] = a;
  s->face[s->n_face][1] = b;
  s->face[s->n_face][2] = c;
  s->face_tri[s->n_face++] = tri;
}

/* A wall triangle on three columns. */
static inline void model_wall(struct model *m, uint32_t a, uint32_t b,
                              uint32_t c)
{
  const struct vg_column *col = m->layers.columns.column;

  model_face(m, a, b, c, (uint32_t)m->surface.n_tri);
  shape_tri(&m->surface, col[a].root, col[b].root, col[c].root, MODEL_WALL);
}

/* Virtual faces between the fans p and q at the ends of a ridge; each bit of
 * `turn` selects the fan that advances. */
static inline void model_strip(struct model *m, const uint32_t *p, int np,
                               const uint32_t *q, int nq, uint32_t turn)
{
  int i = 0, j = 0;

  while (i < np - 1 || j < nq - 1) {
    int on_q = j < nq - 1 && (i == np - 1 || turn & 1);

    turn >>= 1;
    if (on_q) model_face(m, p[i], q[j], q[j + 1], VG_NO_INDEX);
    else model_face(m, p[i], q[j], p[i + 1], VG_NO_INDEX);
    if (on_q) j++;
    else i++;
  }
}

static inline int model_cmp_edge(const void *a, const void *b)
{
  const uint32_t *p = a, *q = b;

  for (int k = 0; k < 2; k++)
    if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
  return 0;
}

/* Directed edges of triangles, sorted. */
static inline uint32_t (*model_edges(size_t n, uint32_t (*tri)[3]))[2]
{
  uint32_t(*edge)[2] = vg_alloc(3 * n, sizeof *edge);

  shape_need(edge);
  for (size_t i = 0; i < 3 * n; i++) {
    edge[i][0] = tri[i / 3][i % 3];
    edge[i][1] = tri[i / 3][(i + 1) % 3];
  }
  qsort(edge, 3 * n, sizeof *edge, model_cmp_edge);
  return edge;
}

/* Rims: edges of faces without a neighbour; the cone over them. */
static inline void model_rims(struct model *m,
                              uint32_t (*patch)(const double x[3],
                                                const double y[3]))
{
  struct vg_columns *c = &m->layers.columns;
  uint32_t(*edge)[2] = model_edges(c->n_face, c->face);

  m->apex = shape_point(&m->surface, 0, 0, 5);
  for (size_t i = 0; i < 3 * c->n_face; i++) {
    const uint32_t *e = edge[i], back[2] = { e[1], e[0] };
    size_t room = m->room_border;
    uint32_t a = c->column[e[0]].root, b = c->column[e[1]].root, q;

    if (bsearch(back, edge, 3 * c->n_face, sizeof *edge, model_cmp_edge))
      continue;
    q = patch(m->surface.point[a], m->surface.point[b]);
    if (vg_reserve(&c->border, &room, c->n_border + 1, sizeof *c->border))
      abort();
    if (vg_reserve(&c->border_patch, &m->room_border, c->n_border + 1,
                   sizeof *c->border_patch))
      abort();
    memcpy(c->border[c->n_border], e, sizeof *c->border);
    c->border_patch[c->n_border++] = q;
    for (int k = 0; k < 2; k++) {
      uint32_t *slide = c->column[e[k]].slide;

      if (slide[0] != q) slide[slide[0] != VG_NO_INDEX] = q;
    }
    if (a != b) shape_tri(&m->surface, b, a, m->apex, q);
  }
  free(edge);
}

/* The growth law of all columns. */
static inline void model_law(struct model *m, double delta1)
{
  struct vg_columns *c = &m->layers.columns;

  c->law = vg_alloc(1, sizeof *c->law);
  shape_need(c->law);
  c->law[0] = (struct vg_growth_law)VG_GROWTH_LAW_INIT;
  c->law[0].delta1 = delta1;
  c->n_law = 1;
}

/* A fan in which only some columns rise can leave a front that touches itself.
 * Therefore lower all columns of such a fan to 0; with `all`, lower those of
 * every fan to the lowest. Returns whether a column changed. */
static inline int model_even(struct model *m, int all)
{
  struct vg_column *c = m->layers.columns.column;
  size_t n = m->layers.columns.n_column, end;
  int changed = 0;

  for (size_t i = 0; i < n; i = end) {
    uint16_t low = c[i].n;

    for (end = i; end < n && c[end].root == c[i].root; end++)
      if (c[end].n < low) low = c[end].n;
    for (size_t k = i; k < end; k++) {
      if (c[k].n == low || (low && !all)) continue;
      c[k].n = low;
      changed = 1;
    }
  }
  return changed;
}

/* Lower levels until neighbours differ by one at most. */
static inline void model_relax(struct model *m)
{
  struct vg_columns *c = &m->layers.columns;
  int changed = 1;

  while (changed) {
    changed = 0;
    for (size_t i = 0; i < 3 * c->n_face; i++) {
      struct vg_column *a = &c->column[c->face[i / 3][i % 3]];
      struct vg_column *b = &c->column[c->face[i / 3][(i + 1) % 3]];

      if (a->n > b->n + 1) a->n = (uint16_t)(b->n + 1), changed = 1;
      if (b->n > a->n + 1) b->n = (uint16_t)(a->n + 1), changed = 1;
    }
  }
}

static inline uint32_t model_front_point(struct model *m, const double x[3],
                                         uint64_t id)
{
  struct vg_front *f = &m->layers.front;
  size_t n = f->n_point;

  GROW(f->id, n);
  GROW(f->x, n);
  shape_need(f->id);
  shape_need(f->x);
  f->id[n] = id;
  memcpy(f->x[n], x, sizeof *f->x);
  return (uint32_t)f->n_point++;
}

static inline void model_front_tri(struct model *m, const uint32_t t[3],
                                   uint32_t patch, uint32_t face)
{
  struct vg_front *f = &m->layers.front;

  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return;
  GROW(f->face, f->n_face);
  GROW(f->patch, f->n_face);
  GROW(f->face_id, f->n_face);
  shape_need(f->face);
  shape_need(f->patch);
  shape_need(f->face_id);
  memcpy(f->face[f->n_face], t, sizeof *f->face);
  f->patch[f->n_face] = patch;
  f->face_id[f->n_face++] = face;
}

/* The front point of each column into top, of each other point into point. */
static inline void model_front_points(struct model *m, uint32_t *top,
                                      uint32_t *point)
{
  const struct vg_columns *c = &m->layers.columns;

  memset(point, 0xff, m->surface.n_point * sizeof *point);
  for (size_t i = 0; i < m->surface.n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (m->surface.tri_patch[i] != MODEL_WALL)
        point[m->surface.tri[i][k]] = 0;
  for (size_t i = 0; i < c->n_column; i++)
    point[c->column[i].root] = VG_NO_INDEX;
  for (size_t i = 0; i < c->n_column; i++)
    if (!c->column[i].n) point[c->column[i].root] = 0;
  for (size_t i = 0; i < m->surface.n_point; i++)
    if (point[i] != VG_NO_INDEX)
      point[i] = model_front_point(m, m->surface.point[i],
                                   vg_layer_point_id((uint32_t)i));
  for (size_t i = 0; i < c->n_column; i++) {
    double x[3];

    vg_column_top(c, &m->surface, i, x);
    top[i] = c->column[i].n
             ? model_front_point(m, x, vg_layer_top_id((uint32_t)i))
             : point[c->column[i].root];
  }
}

/* Whether columns with levels slide in patch q, which is then remeshed. */
static inline int model_is_raised(const struct vg_columns *c, uint32_t q)
{
  int is_raised = 0;

  for (size_t i = 0; i < 2 * c->n_border; i++)
    is_raised |= c->border_patch[i / 2] == q &&
                 c->column[c->border[i / 2][i % 2]].n;
  return is_raised;
}

/* The front: tops, and the cone over the boundary edges, or other triangles
 * unchanged. */
static inline void model_front(struct model *m)
{
  const struct vg_columns *c = &m->layers.columns;
  uint32_t *top = vg_alloc(c->n_column, sizeof *top);
  uint32_t *point = vg_alloc(m->surface.n_point, sizeof *point);
  struct vg_front *f = &m->layers.front;
  size_t n_raised = 0;

  shape_need(top);
  shape_need(point);
  model_front_points(m, top, point);
  for (size_t i = 0; i < c->n_face; i++) {
    uint32_t t[3] = { top[c->face[i][0]], top[c->face[i][1]],
                      top[c->face[i][2]] };

    model_front_tri(m, t, MODEL_WALL, (uint32_t)i);
  }
  for (size_t r = 0; r < c->n_border; r++)
    n_raised += model_is_raised(c, c->border_patch[r]);
  /* Remeshed patches have their own points. */
  if (n_raised && n_raised == c->n_border) f->id[point[m->apex]] = VG_LAYER_NEW;
  for (size_t r = 0; r < c->n_border; r++) {
    uint32_t t[3] = { top[c->border[r][1]], top[c->border[r][0]],
                      point[m->apex] };

    model_front_tri(m, t, c->border_patch[r], VG_NO_INDEX);
  }
  for (size_t i = 0; i < m->surface.n_tri && !c->n_border; i++) {
    uint32_t t[3];

    for (int k = 0; k < 3; k++) t[k] = point[m->surface.tri[i][k]];
    if (m->surface.tri_patch[i] != MODEL_WALL)
      model_front_tri(m, t, m->surface.tri_patch[i], VG_NO_INDEX);
  }
  free(top);
  free(point);
}

/* Whether each edge of the front joins two triangles. */
static inline int model_front_is_manifold(const struct model *m)
{
  const struct vg_front *f = &m->layers.front;
  uint32_t(*edge)[2] = model_edges(f->n_face, f->face);
  int fine = 1;

  for (size_t i = 0; i < 3 * f->n_face; i++) {
    const uint32_t back[2] = { edge[i][1], edge[i][0] };

    if (i && !model_cmp_edge(edge[i], edge[i - 1])) fine = 0;
    if (!bsearch(back, edge, 3 * f->n_face, sizeof *edge, model_cmp_edge))
      fine = 0;
  }
  free(edge);
  return fine;
}

/* Cells that fill the front: the cone over the tops. */
static inline void model_field(struct model *m)
{
  const struct vg_front *f = &m->layers.front;
  uint32_t apex = VG_NO_INDEX;

  if (vg_mesh_copy(&m->field, FRONT_MESH(f, &m->surface), NULL) < 0) abort();
  m->field.tet = vg_alloc(f->n_face, sizeof *m->field.tet);
  shape_need(m->field.tet);
  for (size_t i = 0; i < f->n_point; i++)
    if (f->x[i][2] == 5) apex = (uint32_t)i;
  for (size_t i = 0; i < f->n_face; i++) {
    uint32_t *t = m->field.tet[m->field.n_tet];

    if (f->face_id[i] == VG_NO_INDEX) continue;
    memcpy(t, f->face[i], 3 * sizeof *t);
    t[3] = apex;
    m->field.n_tet++;
  }
}

/* Reproducible random numbers; no two tests share a state. */
static inline uint32_t model_random(uint64_t *state)
{
  *state = *state * UINT64_C(6364136223846793005) +
           UINT64_C(1442695040888963407);
  return (uint32_t)(*state >> 33);
}

/* A sphere with columns of random levels, in a box without layers. */
static inline void model_sphere(struct model *m, int n, int most,
                                uint64_t *state)
{
  static const double centre[3] = { 0.1, 0, -0.2 };
  struct vg_columns *c = &m->layers.columns;
  size_t first_point, first_tri;

  memset(m, 0, sizeof *m);
  vg_mesh_add_patch(&m->surface, 5, "");
  vg_mesh_add_patch(&m->surface, 40, "wall");
  shape_box(&m->surface, 3, 3);
  first_point = m->surface.n_point;
  first_tri = m->surface.n_tri;
  /* the helper numbers the patches of the box from 0: move them past the
   * wall */
  for (size_t i = 0; i < first_tri; i++) m->surface.tri_patch[i] += 2;
  shape_sphere(&m->surface, n, centre, 1, 40);
  for (size_t i = first_point; i < m->surface.n_point; i++) {
    double dir[3];

    for (int k = 0; k < 3; k++) dir[k] = m->surface.point[i][k] - centre[k];
    model_column(m, (uint32_t)i, dir);
    c->column[i - first_point].n = (uint16_t)(model_random(state) %
                                              (uint32_t)(most + 1));
  }
  for (size_t i = first_tri; i < m->surface.n_tri; i++) {
    const uint32_t *t = m->surface.tri[i];
    uint32_t f = (uint32_t)first_point;

    model_face(m, t[0] - f, t[1] - f, t[2] - f, (uint32_t)i);
  }
  model_law(m, 0.01);
  model_relax(m);
  model_front(m);
}

#define ROOF_MAX 9 /* points per side */
#define ROOF_FAN 4
#define ROOF_SLOPE 0.6

struct roof {
  int n;      /* squares per side, even */
  int n_each; /* columns of each fan; 0: random numbers */
  int fan[ROOF_MAX * ROOF_MAX][4 * ROOF_FAN]; /* columns of a point */
  int n_fan[ROOF_MAX * ROOF_MAX];
  int sector[ROOF_MAX * ROOF_MAX][5]; /* index in fan of each sector's column */
};

static inline uint32_t roof_side(const double x[3], const double y[3])
{
  double u = x[0] + y[0], v = x[1] + y[1];

  if (fabs(u) > fabs(v)) return u > 0 ? 0 : 2;
  return v > 0 ? 3 : 4;
}

static inline void roof_normal(double turn, double dir[3])
{
  double a = turn * M_PI / 2;
  /* Between the sides the edge of the roof is less steep. */
  double s = ROOF_SLOPE / (fabs(cos(a)) + fabs(sin(a)));
  double r = sqrt(1 + s * s);

  dir[0] = s * cos(a) / r;
  dir[1] = s * sin(a) / r;
  dir[2] = 1 / r;
}

/* Columns of grid point g, at dx, dy from the middle: east is sector 0. */
static inline void roof_columns(struct model *m, struct roof *r, int g, int dx,
                                int dy, uint32_t root, uint64_t *state)
{
  static const double up[3] = { 0, 0, 1 };
  double dir[3];
  int ridge = dx > 0 ? (dy > 0 ? 0 : 3) : (dy > 0 ? 1 : 2);
  int n = r->n_each ? r->n_each : 1 + (int)(model_random(state) % ROOF_FAN),
      side;

  memset(r->sector[g], 0, sizeof r->sector[g]);
  r->n_fan[g] = 0;
  if (!dx && !dy && n > 1) {
    for (side = 0; side < 4; side++) {
      n = r->n_each ? r->n_each - 1
                    : 1 + (int)(model_random(state) % (ROOF_FAN - 1));
      r->sector[g][side] = r->n_fan[g];
      for (int i = 0; i < n; i++) {
        roof_normal(side + (double)i / n, dir);
        r->fan[g][r->n_fan[g]++] = (int)model_column(m, root, dir);
      }
    }
    r->sector[g][4] = r->n_fan[g];
    return;
  }
  if (abs(dx) == abs(dy) && (dx || dy) && n > 1) {
    for (int i = 0; i < n; i++) {
      roof_normal(ridge + i / (n - 1.0), dir);
      r->fan[g][r->n_fan[g]++] = (int)model_column(m, root, dir);
    }
    r->sector[g][(ridge + 1) % 4] = n - 1;
    return;
  }
  side = abs(dx) > abs(dy) ? (dx > 0 ? 0 : 2) : (dy > 0 ? 1 : 3);
  if (abs(dx) != abs(dy)) roof_normal(side, dir);
  else if (dx) roof_normal(ridge + 0.5, dir);
  r->fan[g][r->n_fan[g]++] = (int)model_column(m, root, dx || dy ? dir : up);
}

/* The columns of point g from sector k to the next, in order. */
static inline int roof_chain(const struct roof *r, int g, int middle, int k,
                             uint32_t *chain)
{
  int n = 0;

  if (!middle || r->n_fan[g] == 1) {
    for (; n < r->n_fan[g]; n++) chain[n] = (uint32_t)r->fan[g][n];
    return n;
  }
  for (int i = r->sector[g][k]; i <= r->sector[g][k + 1]; i++)
    chain[n++] = (uint32_t)r->fan[g][i % r->n_fan[g]];
  return n;
}

static inline void roof_triangle(struct model *m, const struct roof *r,
                                 const int at[3][2])
{
  int w = r->n + 1, x = 0, y = 0, side;
  uint32_t c[3];

  for (int k = 0; k < 3; k++) {
    x += 2 * at[k][0] - r->n;
    y += 2 * at[k][1] - r->n;
  }
  side = abs(x) > abs(y) ? (x > 0 ? 0 : 2) : (y > 0 ? 1 : 3);
  for (int k = 0; k < 3; k++) {
    int g = at[k][0] + w * at[k][1];

    c[k] = (uint32_t)r->fan[g][r->sector[g][side]];
  }
  model_wall(m, c[0], c[1], c[2]);
}

static inline void roof_walls(struct model *m, const struct roof *r)
{
  for (int j = 0; j < r->n; j++)
    for (int i = 0; i < r->n; i++) {
      int up = (2 * i + 1 - r->n) * (2 * j + 1 - r->n) > 0;
      const int q[4][2] = {
        { i, j }, { i + 1, j }, { i + 1, j + 1 }, { i, j + 1 }
      };
      int t[3][2];

      for (int half = 0; half < 2; half++) {
        memcpy(t[0], q[up ? 0 : 1], sizeof t[0]);
        memcpy(t[1], q[up ? 1 + half : 2 + half], sizeof t[1]);
        memcpy(t[2], q[up ? 2 + half : (3 + half) % 4], sizeof t[2]);
        roof_triangle(m, r, (const int(*)[2])t);
      }
    }
}

static inline void roof_ridges(struct model *m, const struct roof *r,
                               uint64_t *state)
{
  static const int step[4][2] = { { 1, 1 }, { -1, 1 }, { -1, -1 }, { 1, -1 } };
  int h = r->n / 2, w = r->n + 1, middle = h + w * h;

  for (int k = 0; k < 4; k++)
    for (int i = 0; i < h; i++) {
      int a = middle + i * (step[k][0] + w * step[k][1]);
      int b = a + step[k][0] + w * step[k][1];
      uint32_t p[ROOF_FAN + 2], q[ROOF_FAN + 2];
      int np = roof_chain(r, a, !i, k, p), nq = roof_chain(r, b, 0, k, q);

      model_strip(m, p, np, q, nq, model_random(state));
    }
  for (int i = 1; i + 1 < r->n_fan[middle]; i++)
    model_face(m, (uint32_t)r->fan[middle][0], (uint32_t)r->fan[middle][i],
               (uint32_t)r->fan[middle][i + 1], VG_NO_INDEX);
}

/* A hipped roof over the unit square with points in random order, fans along
 * its four ridges and on its top, with n_each columns of equal or random
 * height, and at most `most` levels. */
static inline void model_roof(struct model *m, int n, int n_each, int most,
                              uint64_t *state)
{
  static struct roof roof;
  struct roof *r = &roof;
  int w = n + 1, order[ROOF_MAX * ROOF_MAX];

  memset(m, 0, sizeof *m);
  r->n = n;
  r->n_each = n_each;
  for (int i = 0; i < w * w; i++) {
    int j = (int)(model_random(state) % (uint32_t)(i + 1));

    order[i] = order[j];
    order[j] = i;
  }
  for (int32_t q = 0; q < 5; q++) vg_mesh_add_patch(&m->surface, 7 - q, "p");
  for (int i = 0; i < w * w; i++) {
    int g = order[i], dx = g % w - n / 2, dy = g / w - n / 2;
    double x = (double)dx / n, y = (double)dy / n;

    roof_columns(m, r, g, dx, dy,
                 shape_point(&m->surface, x, y,
                             -ROOF_SLOPE * fmax(fabs(x), fabs(y))),
                 state);
  }
  roof_walls(m, r);
  roof_ridges(m, r, state);
  model_rims(m, roof_side);
  model_law(m, 0.001);
  for (size_t i = 0; i < m->layers.columns.n_column; i++)
    m->layers.columns.column[i].n = (uint16_t)(model_random(state) %
                                               (uint32_t)(most + 1));
  do model_relax(m);
  while (model_even(m, n_each > 0));
}

#endif
