/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Columns, faces and boundary edges of walls, with and without fans. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "layers/topology/most_normal.h"
#include "layers/topology/topology.h"
#include "topology_shapes.h"

#define LEVELS 3

struct made {
  struct vg_mesh m;
  size_t n_slide;
  struct vg_slide *slide;
  struct vg_columns c;
  struct vg_topology t;
};
#define MADE_INIT                                                              \
  {                                                                            \
    VG_MESH_INIT, 0, NULL, VG_COLUMNS_INIT, VG_TOPOLOGY_INIT                   \
  }

static void made_release(struct made *s)
{
  vg_mesh_release(&s->m);
  free(s->slide);
  vg_columns_release(&s->c);
  vg_topology_release(&s->t);
}

/* Walls are the patches whose bits are set; slide patches those that touch
 * them, or only those of `slides`. */
static void build(struct made *s, unsigned walls, unsigned slides,
                  double fan_angle)
{
  uint8_t is_wall[32] = { 0 };
  struct vg_error err = VG_ERROR_INIT;
  size_t n = 0;

  for (size_t i = 0; i < s->m.n_patch; i++) is_wall[i] = walls >> i & 1;
  assert_int_equal(vg_slides_find(&s->m, is_wall, &s->n_slide, &s->slide, &err),
                   VG_OK);
  for (size_t i = 0; i < s->n_slide; i++)
    if (slides >> s->slide[i].patch & 1) s->slide[n++] = s->slide[i];
  s->n_slide = n;
  if (vg_topology_build(&s->m, is_wall, n, s->slide, fan_angle, NULL, &s->c,
                        &s->t, &err) != VG_OK)
    fail_msg("%s", err.text);
}

/* Checks -------------------------------------------------------------------*/

struct edge {
  uint32_t a, b, face;
};

static int by_ends(const void *x, const void *y)
{
  const struct edge *p = x, *q = y;

  if (p->a != q->a) return p->a < q->a ? -1 : 1;
  return p->b < q->b ? -1 : p->b > q->b;
}

static int is_border(const struct vg_columns *c, uint32_t a, uint32_t b)
{
  int found = 0;

  for (size_t i = 0; i < c->n_border; i++)
    found += c->border[i][0] == a && c->border[i][1] == b;
  return found;
}

/* Every directed edge occurs once, with its reverse unless it is a boundary
 * edge; returns the Euler characteristic. */
static int check_complex(const struct vg_columns *c)
{
  size_t n = 3 * c->n_face, n_open = 0;
  struct edge *e = vg_alloc(n, sizeof *e);

  assert_non_null(e);
  for (uint32_t h = 0; h < n; h++)
    e[h] = (struct edge){ c->face[h / 3][h % 3], c->face[h / 3][(h + 1) % 3],
                          h / 3 };
  qsort(e, n, sizeof *e, by_ends);
  for (size_t i = 0; i < n; i++) {
    struct edge back = { e[i].b, e[i].a, 0 };
    int has_back = bsearch(&back, e, n, sizeof *e, by_ends) != NULL;

    assert_int_not_equal(e[i].a, e[i].b);
    if (i) assert_int_not_equal(by_ends(&e[i - 1], &e[i]), 0);
    assert_int_equal(is_border(c, e[i].a, e[i].b), !has_back);
    n_open += !has_back;
  }
  assert_int_equal(n_open, c->n_border);
  free(e);
  return (int)c->n_column - (int)((n + n_open) / 2) + (int)c->n_face;
}

/* Lists compared with their definition. */
static void check_lists(const struct made *s)
{
  const struct vg_columns *c = &s->c;
  size_t n_corner = 0, n_pair = 0;

  for (uint32_t i = 0; i < c->n_column; i++) {
    for (uint32_t j = s->t.first[i]; j < s->t.first[i + 1]; j++) {
      uint32_t h = s->t.corner[j];

      assert_int_equal(c->face[h / 3][h % 3], i);
      if (j > s->t.first[i]) assert_true(s->t.corner[j - 1] / 3 < h / 3);
      n_corner++;
    }
    for (uint32_t j = s->t.near_first[i]; j < s->t.near_first[i + 1]; j++) {
      if (j > s->t.near_first[i]) assert_true(s->t.near[j - 1] < s->t.near[j]);
      n_pair++;
    }
    if (i) assert_true(c->column[i - 1].root <= c->column[i].root);
    assert_true(s->t.preset[i] == (vg_norm(c->column[i].dir) > 0));
    if (s->t.preset[i])
      assert_true(fabs(vg_norm(c->column[i].dir) - 1) < 1e-12);
    assert_true(c->column[i].bent == SIZE_MAX);
  }
  assert_int_equal(n_corner, 3 * c->n_face);
  assert_int_equal(n_pair, 2 * (size_t)((3 * c->n_face + c->n_border) / 2));
  for (size_t f = 0; f < c->n_face; f++) {
    uint32_t tri = c->face_tri[f];

    if (tri == VG_NO_INDEX) continue;
    if (f) assert_true(c->face_tri[f - 1] < tri);
    for (int k = 0; k < 3; k++)
      assert_int_equal(c->column[c->face[f][k]].root, s->m.tri[tri][k]);
  }
}

/* Directions of all other columns as the growth would choose them: the most
 * normal direction, within the slide planes. */
static void direct(struct made *s)
{
  double n[256][3], v[3];

  for (size_t i = 0; i < s->c.n_column; i++) {
    struct vg_column *col = &s->c.column[i];
    double plane[2][3];
    int k = 0, n_plane = 0;

    for (size_t j = 0; j < s->n_slide; j++)
      for (int x = 0; x < 2; x++)
        if (col->slide[x] == s->slide[j].patch)
          memcpy(plane[n_plane++], s->slide[j].normal, sizeof *plane);
    if (s->t.preset[i]) {
      for (int x = 0; x < n_plane; x++)
        assert_true(fabs(vg_dot(col->dir, plane[x])) < 1e-12);
      continue;
    }
    for (uint32_t j = s->t.first[i]; j < s->t.first[i + 1]; j++) {
      uint32_t tri = s->c.face_tri[s->t.corner[j] / 3];
      double a[3], b[3];

      if (tri == VG_NO_INDEX) continue;
      assert_true(k < 256);
      vg_sub(s->m.point[s->m.tri[tri][1]], s->m.point[s->m.tri[tri][0]], a);
      vg_sub(s->m.point[s->m.tri[tri][2]], s->m.point[s->m.tri[tri][0]], b);
      vg_cross(a, b, n[k]);
      vg_unit(n[k]);
      for (int x = 0; x < n_plane; x++) {
        double d = vg_dot(n[k], plane[x]);

        for (int y = 0; y < 3; y++) n[k][y] -= d * plane[x][y];
      }
      k++;
    }
    assert_true(vg_most_normal(k, (const double(*)[3])n, v));
    vg_unit(v);
    memcpy(col->dir, v, sizeof v);
  }
}

struct tri {
  uint32_t v[3]; /* sorted */
  int sign;
};

static int by_points(const void *x, const void *y)
{
  return memcmp(((const struct tri *)x)->v, ((const struct tri *)y)->v,
                sizeof((const struct tri *)x)->v);
}

static void add_tri(struct tri *list, size_t *n, uint32_t a, uint32_t b,
                    uint32_t c)
{
  struct tri t = { { a, b, c }, 1 };

  for (int i = 0; i < 3; i++) {
    int k = i == 1;
    uint32_t x = t.v[k];

    if (x <= t.v[k + 1]) continue;
    t.v[k] = t.v[k + 1];
    t.v[k + 1] = x;
    t.sign = -t.sign;
  }
  list[(*n)++] = t;
}

static uint32_t stand(const struct vg_columns *c, uint32_t column, int level)
{
  return level ? (uint32_t)(1000000 + column * (LEVELS + 1)) + (uint32_t)level
               : c->column[column].root;
}

static void place(const struct made *s, uint32_t column, int level, double step,
                  double x[3])
{
  const struct vg_column *col = &s->c.column[column];

  for (int k = 0; k < 3; k++)
    x[k] = s->m.point[col->root][k] + level * step * col->dir[k];
}

/* The cells of one face by the lift rule, with their faces added to the list.
 * Cells with a repeated point do not exist. Returns their volume. */
static double lift(const struct made *s, size_t f, double step,
                   struct tri *list, size_t *n)
{
  const struct vg_columns *c = &s->c;
  int at[3] = { 0, 0, 0 }, order[3] = { 0, 1, 2 };
  double volume = 0;

  for (int i = 0; i < 3; i++) {
    int k = i == 1, o = order[k];

    if (c->face[f][o] <= c->face[f][order[k + 1]]) continue;
    order[k] = order[k + 1];
    order[k + 1] = o;
  }
  for (int l = 0; l < LEVELS; l++)
    for (int i = 0; i < 3; i++) {
      int k = order[i];
      uint32_t v[4];
      double x[4][3], six;

      if (c->column[c->face[f][k]].n <= l) continue;
      for (int j = 0; j < 3; j++) {
        v[j] = stand(c, c->face[f][j], at[j]);
        place(s, c->face[f][j], at[j], step, x[j]);
      }
      v[3] = stand(c, c->face[f][k], ++at[k]);
      place(s, c->face[f][k], at[k], step, x[3]);
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
      six = vg_det(x[0], x[1], x[2], x[3]);
      assert_true(six > 0);
      volume += six / 6;
      add_tri(list, n, v[0], v[2], v[1]);
      add_tri(list, n, v[0], v[1], v[3]);
      add_tri(list, n, v[1], v[2], v[3]);
      add_tri(list, n, v[2], v[0], v[3]);
    }
  return volume;
}

/* Expand all faces and cancel the shared ones. The remaining faces must be the
 * walls (below columns with levels), the tops, and the side faces at boundary
 * edges. Removes the walls and the tops, too, and returns the number of
 * remaining side faces. */
static size_t check_cells(struct made *s, double step, double *volume)
{
  const struct vg_columns *c = &s->c;
  size_t n = 0, left = 0;
  struct tri *list = vg_alloc(c->n_face * (12 * LEVELS + 2), sizeof *list);

  assert_non_null(list);
  *volume = 0;
  for (size_t f = 0; f < c->n_face; f++) {
    uint32_t root[3], top[3];

    *volume += lift(s, f, step, list, &n);
    for (int k = 0; k < 3; k++) {
      root[k] = c->column[c->face[f][k]].root;
      top[k] = stand(c, c->face[f][k], c->column[c->face[f][k]].n);
    }
    /* The reverse of the outside, so that everything cancels except side
     * faces. */
    if (c->face_tri[f] != VG_NO_INDEX)
      add_tri(list, &n, root[0], root[1], root[2]);
    if (top[0] != top[1] && top[1] != top[2] && top[2] != top[0])
      add_tri(list, &n, top[0], top[2], top[1]);
  }
  qsort(list, n, sizeof *list, by_points);
  for (size_t i = 0, j; i < n; i = j) {
    int sum = 0;

    for (j = i; j < n && by_points(&list[i], &list[j]) == 0; j++)
      sum += list[j].sign;
    assert_true(sum >= -1 && sum <= 1);
    left += sum != 0;
  }
  free(list);
  return left;
}

/* low or low + 1 at random: neighbours differ by one at most. Columns of one
 * root have the same. */
static void set_levels(struct made *s, int low)
{
  for (size_t i = 0; i < s->c.n_column; i++) {
    size_t seed = s->c.column[i].root;

    s->c.column[i].n = (uint16_t)((size_t)low +
                                  (seed * seed * 7 + seed / 3) % 2);
  }
}

static void set_full(struct made *s)
{
  for (size_t i = 0; i < s->c.n_column; i++) s->c.column[i].n = LEVELS;
}

/* All checks; returns the Euler characteristic of the tops. A boundary edge has
 * a side of LEVELS quads, two triangles each; the lowest one is a triangle if
 * both columns have the same root. */
static int check(struct made *s, double step)
{
  int euler = check_complex(&s->c);
  size_t n_flank = 2 * LEVELS * s->c.n_border;
  double volume;

  check_lists(s);
  direct(s);
  set_full(s);
  for (size_t i = 0; i < s->c.n_border; i++)
    n_flank -= s->c.column[s->c.border[i][0]].root ==
               s->c.column[s->c.border[i][1]].root;
  assert_int_equal(check_cells(s, step, &volume), n_flank);
  assert_true(volume > 0);
  for (int low = 0; low < LEVELS; low++) {
    set_levels(s, low);
    n_flank = check_cells(s, 1e-3 * step, &volume);
    if (!s->c.n_border) assert_int_equal(n_flank, 0);
  }
  set_full(s);
  return euler;
}

/* Tests --------------------------------------------------------------------*/

static void a_sphere_has_a_column_per_point(void **state)
{
  const double o[3] = { 0, 0, 0 };
  struct made s = MADE_INIT;

  (void)state;
  shape_sphere(&s.m, 6, o, 1, 1);
  build(&s, 1, ~0u, 180);
  assert_int_equal(s.c.n_column, s.m.n_point);
  assert_int_equal(s.c.n_face, s.m.n_tri);
  assert_int_equal(s.c.n_border, 0);
  assert_int_equal(check(&s, 0.05), 2);
  for (size_t i = 0; i < s.c.n_column; i++) {
    assert_int_equal(s.c.column[i].cause, 0);
    assert_true(s.c.column[i].slide[0] == VG_NO_INDEX);
  }
  made_release(&s);
}

static void a_half_body_slides_on_its_plane(void **state)
{
  struct made s = MADE_INIT;
  double at[16][2];
  size_t n_sliding = 0;

  (void)state;
  ring(16, at);
  extrude(&s.m, 16, (const double(*)[2])at, 4, 1, 0);
  build(&s, 1, ~0u, 180);
  assert_int_equal(s.c.n_column, 16 * 5 + 1);
  assert_int_equal(s.c.n_border, 16);
  for (size_t i = 0; i < s.c.n_border; i++)
    assert_int_equal(s.c.border_patch[i], 1);
  for (size_t i = 0; i < s.c.n_column; i++) {
    int sliding = s.m.point[s.c.column[i].root][1] == 0;

    n_sliding += s.c.column[i].slide[0] == 1;
    assert_true((s.c.column[i].slide[0] == 1) == sliding);
    assert_true(s.c.column[i].slide[1] == VG_NO_INDEX);
    assert_int_equal(s.c.column[i].cause, 0);
  }
  assert_int_equal(n_sliding, 16);
  assert_int_equal(check(&s, 0.01), 1);
  made_release(&s);
}

static void a_floor_slides_in_four_sides(void **state)
{
  struct made s = MADE_INIT;
  size_t n_two = 0;

  (void)state;
  shape_box(&s.m, 4, 1);
  build(&s, 1u << 4, ~0u, 180);
  assert_int_equal(s.n_slide, 4);
  assert_int_equal(s.c.n_column, 25);
  assert_int_equal(s.c.n_face, 32);
  assert_int_equal(s.c.n_border, 16);
  for (size_t i = 0; i < s.c.n_column; i++) {
    const double *x = s.m.point[s.c.column[i].root];
    uint32_t a = fabs(x[0]) == 1 ? (x[0] > 0 ? 1 : 0) : VG_NO_INDEX;
    uint32_t b = fabs(x[1]) == 1 ? (x[1] > 0 ? 3 : 2) : VG_NO_INDEX;

    assert_true(s.c.column[i].slide[0] == (a < b ? a : b));
    assert_true(s.c.column[i].slide[1] == (a < b ? b : a));
    n_two += a != VG_NO_INDEX && b != VG_NO_INDEX;
    assert_int_equal(s.c.column[i].cause, 0);
  }
  assert_int_equal(n_two, 4);
  assert_int_equal(check(&s, 0.1), 1);
  made_release(&s);
}

static void the_edge_to_an_inert_patch_is_blocked(void **state)
{
  struct made s = MADE_INIT;

  (void)state;
  shape_box(&s.m, 4, 1);
  build(&s, 1u << 4, 1u << 0 | 1u << 2, 180); /* x = 1, y = 1 do not slide */
  assert_int_equal(s.c.n_border, 8);
  for (size_t i = 0; i < s.c.n_column; i++) {
    const double *x = s.m.point[s.c.column[i].root];

    assert_int_equal(s.c.column[i].cause,
                     x[0] == 1 || x[1] == 1 ? VG_CAUSE_SLIDE : VG_CAUSE_NONE);
  }
  made_release(&s);
}

/* Two octahedra that share a point. */
static void a_pinched_point_is_blocked(void **state)
{
  struct made s = MADE_INIT;
  const double at[2][3] = { { -1, 0, 0 }, { 1, 0, 0 } };
  uint32_t keep = VG_NO_INDEX;
  size_t n = 0;

  (void)state;
  shape_sphere(&s.m, 1, at[0], 1, 1);
  shape_sphere(&s.m, 1, at[1], 1, 1);
  for (uint32_t i = 0; i < s.m.n_point; i++)
    if (fabs(s.m.point[i][0]) < 0.5 && fabs(s.m.point[i][1]) < 0.5 &&
        fabs(s.m.point[i][2]) < 0.5) {
      for (size_t t = 0; keep != VG_NO_INDEX && t < s.m.n_tri; t++)
        for (int k = 0; k < 3; k++)
          if (s.m.tri[t][k] == i) s.m.tri[t][k] = keep;
      if (keep == VG_NO_INDEX) keep = i;
    }
  build(&s, 1, ~0u, 60);
  for (size_t i = 0; i < s.c.n_column; i++) {
    assert_int_equal(s.c.column[i].cause, s.c.column[i].root == keep
                                            ? VG_CAUSE_SLIDE
                                            : VG_CAUSE_NONE);
    n += s.c.column[i].root == keep;
  }
  assert_int_equal(n, 1);
  made_release(&s);
}

static size_t columns_at(const struct made *s, double x, double y, double z)
{
  size_t n = 0;

  for (size_t i = 0; i < s->c.n_column; i++) {
    const double *p = s->m.point[s->c.column[i].root];

    n += fabs(p[0] - x) + fabs(p[1] - y) + fabs(p[2] - z) < 1e-9;
  }
  return n;
}

static void a_cube_has_fans_at_edges_and_corners(void **state)
{
  struct made s = MADE_INIT;

  (void)state;
  extrude(&s.m, 4, square, 2, 0, 0);
  build(&s, 1, ~0u, 60);
  /* 90 degrees: three steps. Edge: two sectors, two between them. Corner: nine
   * columns around and one in the middle. */
  assert_int_equal(columns_at(&s, 1, 0.5, 1), 4);
  assert_int_equal(columns_at(&s, 1, 1, 1), 10);
  assert_int_equal(columns_at(&s, 0, 1, 0), 1);
  assert_int_equal(s.c.n_column, 8 * 10 + 4 * 4 + 2);
  assert_int_equal(check(&s, 0.1), 2);
  made_release(&s);
}

static void fans_fill_the_space_about_an_edge(void **state)
{
  struct made s = MADE_INIT;
  const double h = LEVELS * 0.01;
  const double area = 2 * 4 + 4 * 2, edges = 4 * (2 + 2 + 1);
  const double quarter = 1.5 * sin(M_PI / 6); /* three chords, radius 1 */
  double volume;

  (void)state;
  extrude(&s.m, 4, square, 2, 0, 0);
  build(&s, 1, ~0u, 60);
  check(&s, 0.01);
  check_cells(&s, 0.01, &volume);
  /* Faces and edges of the 2 x 1 x 2 block exactly; its eight corners are
   * inside a ball of this height. */
  volume -= area * h + edges * quarter * h * h;
  assert_true(volume > 0 && volume < 4 * M_PI / 3 * h * h * h);
  made_release(&s);
}

static void a_wedge_keeps_one_column_without_fans(void **state)
{
  struct made s = MADE_INIT;

  (void)state;
  extrude(&s.m, 8, wedge, 4, 1, 0);
  build(&s, 1, ~0u, 180);
  assert_int_equal(s.c.n_column, 8 * 5 + 1);
  assert_int_equal(s.c.n_border, 8);
  made_release(&s);
}

static void a_wedge_has_a_fan_down_to_its_plane(void **state)
{
  struct made s = MADE_INIT;

  (void)state;
  extrude(&s.m, 8, wedge, 4, 1, 0);
  build(&s, 1, ~0u, 130);
  /* 174 degrees: five steps of 34.8 would do, but halves have to match. */
  assert_true(columns_at(&s, 1.5, 0.5, 0) >= 6);
  assert_int_equal(columns_at(&s, 1.5, 0.5, 0), columns_at(&s, 1.5, 0, 0));
  assert_int_equal(columns_at(&s, 0.5, 0.5, 0.0524), 1);
  assert_int_equal(s.c.n_border, 8 + columns_at(&s, 1.5, 0, 0) - 1);
  for (size_t i = 0; i < s.c.n_column; i++)
    if (s.m.point[s.c.column[i].root][1] == 0) {
      assert_int_equal(s.c.column[i].slide[0], 1);
      assert_true(s.c.column[i].dir[1] == 0);
    }
  assert_int_equal(check(&s, 0.01), 1);
  made_release(&s);
}

/* Swept back and forth, up to 45 degrees: the fan turns in the plane. */
static void a_swept_wedge_keeps_its_fan_in_the_plane(void **state)
{
  (void)state;
  for (int sweep = -4; sweep <= 4; sweep++) {
    struct made s = MADE_INIT;

    extrude(&s.m, 8, wedge, 4, 1, 0);
    for (size_t i = 0; i < 8 * 5 + 1; i++)
      s.m.point[i][0] += 0.25 * sweep * s.m.point[i][1];
    build(&s, 1, ~0u, 130);
    assert_int_equal(s.c.n_border, 8 + columns_at(&s, 1.5, 0, 0) - 1);
    assert_true(columns_at(&s, 1.5, 0, 0) >= 6);
    assert_int_equal(check(&s, 0.01), 1);
    made_release(&s);
  }
}

/* The end of a sharp edge at a sharp tip: a corner of three sectors. */
static void a_wedge_has_a_corner_at_its_tip(void **state)
{
  struct made s = MADE_INIT;

  (void)state;
  extrude(&s.m, 8, wedge, 4, 0, 0);
  build(&s, 1, ~0u, 60);
  assert_true(columns_at(&s, 1.5, 1, 0) >= 11);
  assert_int_equal(check(&s, 1e-3), 2);
  made_release(&s);
}

/* A ridge that flattens out inside the wall ends in a point with one column, to
 * which the fan of the previous point tapers. */
static void a_ridge_that_ends_tapers(void **state)
{
  struct made s = MADE_INIT;

  (void)state;
  extrude(&s.m, 8, wedge, 4, 1, 0);
  for (int j = 0; j <= 4; j++) s.m.point[8 * j + 5][0] -= 0.225 * j;
  build(&s, 1, ~0u, 130);
  assert_true(columns_at(&s, 1.5, 0, 0) > 2);
  assert_int_equal(columns_at(&s, 0.6, 1, 0), 1);
  assert_int_equal(check(&s, 1e-3), 1);
  made_release(&s);
}

/* A sharp edge (1, y > 0, 0) that opens into a narrow base (y < 0): at the
 * point between, three sectors are in one plane and leave no gap. */
static void a_base_that_closes_needs_no_centre(void **state)
{
  static const double at[9][3] = {
    { 0, -1, 1 },     { 0, 1, 1 }, { 0, 1, -1 }, { 0, -1, -1 }, { 1, -1, 0.05 },
    { 1, -1, -0.05 }, { 1, 0, 0 }, { 1, 1, 0 },  { 0, 0, 0 }
  };
  static const uint32_t tri[14][3] = { { 0, 4, 6 }, { 0, 6, 1 }, { 1, 6, 7 },
                                       { 3, 6, 5 }, { 3, 2, 6 }, { 2, 7, 6 },
                                       { 4, 5, 6 }, { 1, 7, 2 }, { 0, 3, 5 },
                                       { 0, 5, 4 }, { 8, 0, 1 }, { 8, 1, 2 },
                                       { 8, 2, 3 }, { 8, 3, 0 } };
  struct made s = MADE_INIT;

  (void)state;
  vg_mesh_add_patch(&s.m, 1, "body");
  for (int i = 0; i < 9; i++) shape_point(&s.m, at[i][0], at[i][1], at[i][2]);
  for (int i = 0; i < 14; i++)
    shape_tri(&s.m, tri[i][0], tri[i][1], tri[i][2], 0);
  build(&s, 1, ~0u, 35);
  /* 45 degrees to the base and on: two steps each. */
  assert_int_equal(columns_at(&s, 1, 0, 0), 5);
  assert_int_equal(check(&s, 1e-3), 2);
  made_release(&s);
}

static void a_thin_plate_has_fans_all_around(void **state)
{
  struct made s = MADE_INIT;

  (void)state;
  extrude(&s.m, 4, plate, 5, 0, 0);
  build(&s, 1, ~0u, 60);
  assert_int_equal(columns_at(&s, 1, 1, 0.005), 10);
  assert_int_equal(columns_at(&s, 1, 0.4, 0.005), 4);
  assert_int_equal(check(&s, 0.01), 2);
  made_release(&s);
}

static void a_cone_has_a_fan_about_its_base(void **state)
{
  struct made s = MADE_INIT;
  double at[24][2];

  (void)state;
  ring(24, at);
  extrude(&s.m, 24, (const double(*)[2])at, 1, 0, 1);
  build(&s, 1, ~0u, 60);
  assert_int_equal(columns_at(&s, 0, 1, 0), 1);
  assert_int_equal(columns_at(&s, 1, 0, 0), 5); /* 135 degrees: 4 steps */
  assert_int_equal(check(&s, 0.02), 2);
  made_release(&s);
}

/* A pyramid: the apex is a corner of four sectors. */
static void a_pyramid_has_a_fan_at_its_apex(void **state)
{
  struct made s = MADE_INIT;

  (void)state;
  extrude(&s.m, 4, square, 1, 0, 1);
  build(&s, 1, ~0u, 40);
  assert_true(columns_at(&s, 0, 1, 0) >= 9);
  assert_int_equal(check(&s, 0.05), 2);
  made_release(&s);
}

static int same(const void *a, const void *b, size_t n, size_t size)
{
  return n == 0 || memcmp(a, b, n * size) == 0;
}

/* With an angle of 0 only points where the visibility of one column is too low
 * have fans: of two pyramids the tip of the slender one, and no corner of its
 * base. */
static void fans_stand_where_they_are_needed(void **state)
{
  static const double slender[4][2] = {
    { -0.01, -0.01 }, { -0.01, 0.01 }, { 0.01, 0.01 }, { 0.01, -0.01 }
  };

  (void)state;
  for (int k = 0; k < 2; k++) {
    struct made s = MADE_INIT;

    extrude(&s.m, 4, k ? slender : square, 1, 0, 1);
    build(&s, 1, ~0u, 0);
    if (k) assert_true(columns_at(&s, 0, 1, 0) > 4);
    else assert_int_equal(columns_at(&s, 0, 1, 0), 1);
    assert_int_equal(s.c.n_column - columns_at(&s, 0, 1, 0), 5);
    assert_int_equal(check(&s, 0.001), 2);
    made_release(&s);
  }
}

/* Sharp edges have fans unless the edges of the wall along them are long, here
 * 200 times as long as in the first case. Edges at right angles have fans only
 * in a chain with sharp ones: around the end of the wedge, not around a block.
 */
static void sharp_edges_have_fans(void **state)
{
  struct made s = MADE_INIT, t = MADE_INIT, u = MADE_INIT;

  (void)state;
  extrude(&s.m, 8, wedge, 64, 1, 0);
  build(&s, 1, ~0u, VG_FANS_SHARP);
  assert_true(columns_at(&s, 1.5, 0.5, 0) >= 5);
  assert_true(columns_at(&s, 0.5, 1, 0.0524) > 1);
  assert_int_equal(columns_at(&s, 0.5, 0.5, 0.0524), 1);
  check(&s, 0.01);
  made_release(&s);

  extrude(&t.m, 8, wedge, 64, 1, 0);
  for (size_t i = 0; i < t.m.n_point; i++) t.m.point[i][1] *= 200;
  build(&t, 1, ~0u, VG_FANS_SHARP);
  assert_int_equal(columns_at(&t, 1.5, 100, 0), 1);
  made_release(&t);

  extrude(&u.m, 4, square, 2, 0, 0);
  build(&u, 1, ~0u, VG_FANS_SHARP);
  assert_int_equal(u.c.n_column, u.m.n_point);
  made_release(&u);
}

static void the_same_bytes_twice(void **state)
{
  struct made s = MADE_INIT, t = MADE_INIT;

  (void)state;
  extrude(&s.m, 8, wedge, 4, 1, 0);
  extrude(&t.m, 8, wedge, 4, 1, 0);
  build(&s, 1, ~0u, 60);
  build(&t, 1, ~0u, 60);
  assert_int_equal(s.c.n_column, t.c.n_column);
  assert_int_equal(s.c.n_face, t.c.n_face);
  assert_int_equal(s.c.n_border, t.c.n_border);
  for (size_t i = 0; i < s.c.n_column; i++) {
    assert_int_equal(s.c.column[i].root, t.c.column[i].root);
    assert_true(same(s.c.column[i].dir, t.c.column[i].dir, 3, 8));
  }
  assert_true(same(s.c.face, t.c.face, s.c.n_face, sizeof *s.c.face));
  assert_true(same(s.c.border, t.c.border, s.c.n_border, sizeof *s.c.border));
  assert_true(same(s.t.corner, t.t.corner, 3 * s.c.n_face, 4));
  assert_true(same(s.t.near, t.t.near, s.t.near_first[s.c.n_column], 4));
  made_release(&s);
  made_release(&t);
}

static void bad_angles_are_refused(void **state)
{
  struct made s = MADE_INIT;
  const uint8_t wall[6] = { 1, 1, 1, 1, 1, 1 };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  shape_box(&s.m, 2, 1);
  assert_int_equal(vg_topology_build(&s.m, wall, 0, NULL, -0.5, NULL, &s.c,
                                     &s.t, &err),
                   VG_ERR_INPUT);
  assert_int_equal(vg_topology_build(&s.m, wall, 0, NULL, NAN, NULL, &s.c, &s.t,
                                     &err),
                   VG_ERR_INPUT);
  assert_null(s.c.column);
  made_release(&s);
}

/* Walls seen from inside have concave edges only: no fans. */
static void concave_edges_have_no_fans(void **state)
{
  struct made s = MADE_INIT;

  (void)state;
  shape_box(&s.m, 3, 1);
  build(&s, 0x3f, ~0u, 30);
  assert_int_equal(s.c.n_column, s.m.n_point);
  assert_int_equal(s.c.n_face, s.m.n_tri);
  made_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_sphere_has_a_column_per_point),
    cmocka_unit_test(a_half_body_slides_on_its_plane),
    cmocka_unit_test(a_floor_slides_in_four_sides),
    cmocka_unit_test(the_edge_to_an_inert_patch_is_blocked),
    cmocka_unit_test(a_pinched_point_is_blocked),
    cmocka_unit_test(a_cube_has_fans_at_edges_and_corners),
    cmocka_unit_test(fans_fill_the_space_about_an_edge),
    cmocka_unit_test(a_wedge_keeps_one_column_without_fans),
    cmocka_unit_test(a_wedge_has_a_fan_down_to_its_plane),
    cmocka_unit_test(a_swept_wedge_keeps_its_fan_in_the_plane),
    cmocka_unit_test(a_wedge_has_a_corner_at_its_tip),
    cmocka_unit_test(a_ridge_that_ends_tapers),
    cmocka_unit_test(a_base_that_closes_needs_no_centre),
    cmocka_unit_test(a_thin_plate_has_fans_all_around),
    cmocka_unit_test(a_cone_has_a_fan_about_its_base),
    cmocka_unit_test(a_pyramid_has_a_fan_at_its_apex),
    cmocka_unit_test(fans_stand_where_they_are_needed),
    cmocka_unit_test(sharp_edges_have_fans),
    cmocka_unit_test(the_same_bytes_twice),
    cmocka_unit_test(bad_angles_are_refused),
    cmocka_unit_test(concave_edges_have_no_fans),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
