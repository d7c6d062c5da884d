/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sides, sectors and regions of surfaces on which any number of triangles share
 * an edge: random faces of tetrahedra, compared with the cells around them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/union_find.h"
#include "core/sides/sides.h"
#include "tets_support.h"

static const int edge_of[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 },
                                   { 1, 2 }, { 1, 3 }, { 2, 3 } };

/* Cells, some of whose faces are the surface. Every cell has numbers 4 c + i
 * for its corners and 6 c + e for its edges; the space outside of all cells
 * has such numbers at each point and each edge of the hull. */
struct scene {
  struct vg_tets t;
  uint32_t (*tri)[3];
  uint32_t *cell[2]; /* [n_tri] cell on the normal side and on the other */
  size_t n_tri;
  uint8_t *is_in;   /* [4 n_cell] face i of cell c is in the surface */
  uint32_t *corner; /* [4 n_cell + n_point] sets of corners */
  uint32_t *wedge;  /* [6 n_cell + n_cell 6] sets of edges */
};

static void *array(size_t n, size_t size)
{
  void *a = vg_calloc(n ? n : 1, size);

  assert_non_null(a);
  return a;
}

static int index_of(const uint32_t *v, int n, uint32_t p)
{
  for (int i = 0; i < n; i++)
    if (v[i] == p) return i;
  return -1;
}

/* Takes a share of the inner faces, some with the other orientation. */
static void choose_faces(struct scene *s, double share, uint64_t *seed)
{
  const struct vg_tets *t = &s->t;

  s->tri = array(2 * t->n_cell, sizeof *s->tri);
  for (int k = 0; k < 2; k++) s->cell[k] = array(2 * t->n_cell, 4);
  s->is_in = array(4 * t->n_cell, 1);
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; i < 4; i++) {
      const uint32_t link = t->cell[c].link[i];
      const int turn = tets_random(seed) < .5;

      if (t->flag[c] & VG_DEAD || link == VG_NONE || link < 4 * c + i ||
          tets_random(seed) >= share)
        continue;
      s->is_in[4 * c + i] = s->is_in[link] = 1;
      for (int k = 0; k < 3; k++)
        s->tri[s->n_tri][turn ? 2 - k : k] = t->cell[c].v[vg_face[i][k]];
      s->cell[turn][s->n_tri] = c;
      s->cell[!turn][s->n_tri++] = link >> 2;
    }
}

static int edge_index(const uint32_t v[4], uint32_t a, uint32_t b)
{
  const int i = index_of(v, 4, a), j = index_of(v, 4, b);

  for (int e = 0; e < 6; e++)
    if ((edge_of[e][0] == i && edge_of[e][1] == j) ||
        (edge_of[e][0] == j && edge_of[e][1] == i))
      return e;
  abort();
}

/* The number of the space outside at an edge of the hull: that of the lowest
 * cell with this edge. */
static uint32_t outside_at(const struct vg_tets *t, uint32_t a, uint32_t b)
{
  for (uint32_t c = 0; c < t->n_cell; c++)
    if (!(t->flag[c] & VG_DEAD) && index_of(t->cell[c].v, 4, a) >= 0 &&
        index_of(t->cell[c].v, 4, b) >= 0)
      return (uint32_t)(6 * t->n_cell + 6 * c) +
             (uint32_t)edge_index(t->cell[c].v, a, b);
  abort();
}

/* Unites corners and edges of cells across face i of cell c. */
static void unite_across(struct scene *s, uint32_t c, uint32_t i)
{
  const struct vg_tets *t = &s->t;
  const uint32_t *v = t->cell[c].v, link = t->cell[c].link[i], d = link >> 2;

  for (uint32_t k = 0; k < 4; k++)
    if (k != i)
      vg_union(s->corner, 4 * c + k,
               link == VG_NONE
                 ? (uint32_t)(4 * t->n_cell) + v[k]
                 : 4 * d + (uint32_t)index_of(t->cell[d].v, 4, v[k]));
  for (uint32_t e = 0; e < 6; e++) {
    const uint32_t a = v[edge_of[e][0]], b = v[edge_of[e][1]];

    if (edge_of[e][0] == (int)i || edge_of[e][1] == (int)i) continue;
    vg_union(s->wedge, 6 * c + e,
             link == VG_NONE
               ? outside_at(t, a, b)
               : 6 * d + (uint32_t)edge_index(t->cell[d].v, a, b));
  }
}

static void unite_cells(struct scene *s)
{
  const struct vg_tets *t = &s->t;
  const size_t n_corner = 4 * t->n_cell + t->n_point, n_wedge = 12 * t->n_cell;

  s->corner = array(n_corner, 4);
  s->wedge = array(n_wedge, 4);
  for (uint32_t k = 0; k < n_corner; k++) s->corner[k] = k;
  for (uint32_t k = 0; k < n_wedge; k++) s->wedge[k] = k;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; i < 4; i++)
      if (!(t->flag[c] & VG_DEAD) && !s->is_in[4 * c + i])
        unite_across(s, c, i);
}

/* The cell at half-face edge or corner e = 3 h + k. */
static uint32_t cell_at(const struct scene *s, uint32_t e)
{
  return s->cell[e / 3 % 2][e / 6];
}

static uint32_t corner_set(const struct scene *s, uint32_t e)
{
  const uint32_t c = cell_at(s, e), p = s->tri[e / 6][e % 3];

  return vg_root_of(s->corner,
                    4 * c + (uint32_t)index_of(s->t.cell[c].v, 4, p));
}

static uint32_t wedge_set(const struct scene *s, uint32_t e)
{
  const uint32_t c = cell_at(s, e), *tri = s->tri[e / 6];
  const int i = edge_index(s->t.cell[c].v, tri[e % 3], tri[(e + 1) % 3]);

  return vg_root_of(s->wedge, 6 * c + (uint32_t)i);
}

/* Neighbours look into the same wedge, and neighbour each other. */
static void expect_across(const struct scene *s, const struct vg_sides *a)
{
  for (uint32_t e = 0; e < 6 * s->n_tri; e++) {
    assert_int_equal(a->across[a->across[e]], e);
    assert_true(a->across[e] != e);
    assert_int_equal(wedge_set(s, e), wedge_set(s, a->across[e]));
  }
}

/* Sectors are the sets of corners of cells, unless surfaces touch in a point:
 * then a set may have several sectors. */
static void expect_sectors(const struct scene *s, const struct vg_sides *a,
                           const uint32_t *n_fan)
{
  uint32_t most = 0;

  for (uint32_t p = 0; p < a->n_point; p++)
    for (uint32_t i = a->first[p]; i < a->first[p + 1]; i++)
      for (uint32_t j = a->first[p]; j < a->first[p + 1]; j++)
        for (uint32_t side = 0; side < 4; side++) {
          const uint32_t ci = a->corner[i], cj = a->corner[j];
          const uint32_t g = 3 * (2 * (ci / 3) + side % 2) + ci % 3;
          const uint32_t h = 3 * (2 * (cj / 3) + side / 2) + cj % 3;
          const int is_one = a->sector[g] == a->sector[h];

          if (is_one) assert_int_equal(corner_set(s, g), corner_set(s, h));
          else if (n_fan[p] == 1)
            assert_int_not_equal(corner_set(s, g), corner_set(s, h));
        }
  for (uint32_t e = 0; e < 6 * s->n_tri; e++) {
    assert_true(a->sector[e] <= most);
    most += a->sector[e] == most;
  }
  assert_int_equal(most, a->n_sector);
}

static void expect_regions(const struct scene *s, const struct vg_sides *a)
{
  uint32_t *up = array(2 * s->n_tri, sizeof *up);
  size_t n = 0;

  for (uint32_t h = 0; h < 2 * s->n_tri; h++) up[h] = h;
  for (uint32_t e = 0; e < 6 * s->n_tri; e++)
    for (uint32_t g = 0; g < e; g++)
      if (wedge_set(s, e) == wedge_set(s, g)) vg_union(up, e / 3, g / 3);
  for (uint32_t h = 0; h < 2 * s->n_tri; h++) {
    n += up[h] == h;
    assert_int_equal(a->region[h], a->region[vg_root_of(up, h)]);
  }
  assert_int_equal(n, a->n_region);
  free(up);
}

/* Triangles are connected at a point if they share an edge there. */
static void expect_fans(const struct scene *s, const struct vg_sides *a,
                        const uint32_t *n_fan)
{
  uint32_t *up = array(3 * s->n_tri, sizeof *up);

  for (uint32_t k = 0; k < 3 * s->n_tri; k++) up[k] = k;
  for (uint32_t p = 0; p < a->n_point; p++) {
    uint32_t n = 0;

    for (uint32_t i = a->first[p]; i < a->first[p + 1]; i++)
      for (uint32_t j = a->first[p]; j < i; j++) {
        const uint32_t *u = s->tri[a->corner[i] / 3];
        const uint32_t *v = s->tri[a->corner[j] / 3];
        int common = 0;

        for (int k = 0; k < 3; k++) common += index_of(v, 3, u[k]) >= 0;
        if (common >= 2) vg_union(up, a->corner[i], a->corner[j]);
      }
    for (uint32_t i = a->first[p]; i < a->first[p + 1]; i++)
      n += up[a->corner[i]] == a->corner[i];
    assert_int_equal(n, n_fan[p]);
  }
  free(up);
}

/* Every cell is found in the sector in which it is. */
static void expect_found(const struct scene *s, const struct vg_sides *a,
                         const uint32_t *n_fan)
{
  const struct vg_tets *t = &s->t;

  for (uint32_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; i < 4 && !(t->flag[c] & VG_DEAD); i++) {
      const uint32_t *v = t->cell[c].v, p = v[i];
      uint32_t at[3], e;
      const double *x[3];

      for (int k = 0; k < 3; k++) {
        at[k] = v[(i + 1 + (uint32_t)k) % 4];
        x[k] = t->x[at[k]];
        if (!n_fan[at[k]]) at[k] = UINT32_MAX;
      }
      e = vg_sides_find(a, p, at, x);
      if (!n_fan[p]) {
        assert_int_equal(e, UINT32_MAX);
        continue;
      }
      assert_true(e < 6 * s->n_tri && s->tri[e / 6][e % 3] == p);
      assert_int_equal(corner_set(s, e), vg_root_of(s->corner, 4 * c + i));
    }
}

/* Takes over the cells. */
static void check(struct vg_tets *t, double share, uint64_t seed)
{
  struct scene s = { .t = *t };
  struct vg_sides a = VG_SIDES_INIT;
  uint32_t *n_fan = array(t->n_point, sizeof *n_fan);

  choose_faces(&s, share, &seed);
  unite_cells(&s);
  assert_int_equal(vg_sides_build(&a, s.t.n_point, (const double(*)[3])s.t.x,
                                  s.n_tri, (const uint32_t(*)[3])s.tri, NULL),
                   VG_OK);
  assert_int_equal(vg_sides_fans(&a, n_fan, NULL), VG_OK);
  expect_across(&s, &a);
  expect_fans(&s, &a, n_fan);
  expect_sectors(&s, &a, n_fan);
  expect_regions(&s, &a);
  expect_found(&s, &a, n_fan);
  vg_sides_release(&a);
  vg_tets_release(&s.t);
  free(n_fan);
  free(s.tri);
  for (int k = 0; k < 2; k++) free(s.cell[k]);
  free(s.is_in);
  free(s.corner);
  free(s.wedge);
}

static void random_cells(void **state)
{
  (void)state;
  for (uint64_t seed = 1; seed <= 30; seed++) {
    struct vg_tets t = VG_TETS_INIT;
    struct vg_inserter in;
    uint64_t draw = seed;

    tets_box(&t, -1.5, 1.5);
    assert_int_equal(vg_inserter_init(&in, &t, NULL), VG_OK);
    for (int i = 0; i < 24; i++) {
      double x[3];

      for (int k = 0; k < 3; k++) x[k] = 2 * tets_random(&draw) - 1;
      assert_int_equal(tets_insert(&in, x, 0, 0), VG_OK);
    }
    vg_inserter_release(&in);
    check(&t, .05 + .03 * (double)(seed % 30), seed);
  }
}

/* Many triangles lie in the same planes here, and edges on the same lines. */
static void cells_of_a_grid(void **state)
{
  const int n[3] = { 3, 2, 3 };

  (void)state;
  for (uint64_t seed = 1; seed <= 12; seed++) {
    struct vg_tets t = VG_TETS_INIT;

    tets_grid(&t, n);
    check(&t, .08 * (double)seed, seed);
  }
}

/* A wall that turns around a sheet which ends on it: one region of fluid on
 * each side of the sheet, and one behind the wall. */
static void a_sheet_on_a_wall(void **state)
{
  static const double x[][3] = {
    { 0, 0, 0 }, { 0, 1, 0 }, { 1, 0, 0 }, { -1, 0, 0 }, { 0, 0, 1 }
  };
  static const uint32_t tri[][3] = { { 0, 2, 1 }, { 0, 1, 3 }, { 0, 1, 4 } };
  struct vg_sides s = VG_SIDES_INIT;

  (void)state;
  assert_int_equal(vg_sides_build(&s, 5, x, 3, tri, NULL), VG_OK);
  /* All edges but one are free, so that everything is connected around them;
   * the three wedges of the common edge connect different half-faces. */
  assert_int_equal(s.n_region, 1);
  assert_int_equal(s.across[3 * 1 + 2] / 3, 3); /* both from below */
  assert_int_equal(s.across[3 * 0 + 2] / 3, 4); /* wall and sheet */
  assert_int_equal(s.across[3 * 2 + 0] / 3, 5);
  assert_int_equal(vg_edges_count(&s.edge, s.edge.of_half[2]), 3);
  vg_sides_release(&s);
}

static void nothing(void **state)
{
  struct vg_sides s = VG_SIDES_INIT;

  (void)state;
  assert_int_equal(vg_sides_build(&s, 0, NULL, 0, NULL, NULL), VG_OK);
  assert_int_equal(s.n_sector + s.n_region, 0);
  vg_sides_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(random_cells),
    cmocka_unit_test(cells_of_a_grid),
    cmocka_unit_test(a_sheet_on_a_wall),
    cmocka_unit_test(nothing),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
