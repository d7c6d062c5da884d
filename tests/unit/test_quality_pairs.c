/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The mesh check of tetrahedra alone: faces are matched in the order of cells
 * (core/judge/quality_pairs.c), with many faces waiting and in columns of
 * layers. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "core/judge/quality_parts.h"

static struct vg_mesh room_for(size_t n_point, size_t n_tet, size_t n_tri)
{
  struct vg_mesh m = VG_MESH_INIT;

  m.n_point = n_point;
  m.n_tet = n_tet;
  m.n_tri = n_tri;
  m.point = vg_calloc(n_point, sizeof *m.point);
  m.tet = vg_calloc(n_tet, sizeof *m.tet);
  m.tri = vg_calloc(n_tri, sizeof *m.tri);
  m.tri_patch = vg_calloc(n_tri, sizeof *m.tri_patch);
  assert_true(m.point && m.tet && m.tri && m.tri_patch);
  assert_true(vg_mesh_add_patch(&m, 1, "wall") == 0);
  return m;
}

static struct vg_mesh_report judge(const struct vg_mesh *m)
{
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_mesh_judge(m, NULL, &r, &err), VG_OK);
  return r;
}

static void turn_over(uint32_t t[4])
{
  uint32_t first = t[0];

  t[0] = t[1];
  t[1] = first;
}

/* n separate pairs of tetrahedra, each with a common face. The second ones come
 * when all first ones wait, and the boundary after them. */
static struct vg_mesh pairs_apart(uint32_t n)
{
  static const double x[5][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, -1 }
  };
  static const uint32_t tri[6][3] = { { 0, 3, 1 }, { 1, 3, 2 }, { 2, 3, 0 },
                                      { 0, 1, 4 }, { 1, 2, 4 }, { 2, 0, 4 } };
  struct vg_mesh m = room_for(5 * n, 2 * n, 6 * n);

  for (uint32_t i = 0; i < n; i++) {
    const uint32_t first[4] = { 0, 1, 2, 3 }, second[4] = { 0, 2, 1, 4 };

    for (uint32_t k = 0; k < 5; k++)
      for (int d = 0; d < 3; d++)
        m.point[5 * i + k][d] = x[k][d] + (d ? 0 : 2 * (double)i);
    for (int k = 0; k < 4; k++) {
      m.tet[i][k] = 5 * i + first[k];
      m.tet[n + i][k] = 5 * i + second[k];
    }
    for (int k = 0; k < 18; k++)
      m.tri[6 * i + (uint32_t)k / 3][k % 3] = 5 * i + tri[k / 3][k % 3];
  }
  return m;
}

static void many_faces_may_wait(void **state)
{
  const uint32_t n = 6000;
  struct vg_mesh m = pairs_apart(n);
  struct vg_mesh_report r = judge(&m);

  (void)state;
  assert_true(r.is_valid);
  assert_int_equal(r.n_inner_face, n);
  assert_int_equal(r.n_component, n);
  assert_true(fabs(r.volume - n / 3.) < 1e-9);
  turn_over(m.tet[n + 17]);
  r = judge(&m);
  assert_int_equal(r.not_positive, 1);
  assert_int_equal(r.same_side_face, 1);
  assert_int_equal(r.outward_boundary, 3);
  assert_int_equal(r.n_component, n);
  m.n_tri -= 4; /* of the last pair */
  r = judge(&m);
  assert_int_equal(r.open_face, 4);
  vg_mesh_release(&m);
}

#define LEVELS 6
#define RAISED (3 * LEVELS)

/* A column: its corners are raised in turn, and each time a cell is placed on
 * the previous one. Point numbers are spread by `by`, prime to 21. */
static struct vg_mesh column(uint32_t by)
{
  struct vg_mesh m = room_for(21, RAISED, 2 * RAISED + 2);
  uint32_t top[3] = { 0, by % 21, 2 * by % 21 };
  uint32_t(*t)[3] = m.tri;

  for (uint32_t i = 0; i < 21; i++) {
    double *x = m.point[i * by % 21];

    x[0] = i % 3 == 1;
    x[1] = i % 3 == 2;
    x[2] = i / 3;
  }
  memcpy(t++, top, sizeof top);
  for (uint32_t i = 0; i < RAISED; i++) {
    uint32_t k = i % 3, next = (i + 3) * by % 21;
    uint32_t a = top[(k + 1) % 3], b = top[(k + 2) % 3];

    memcpy(m.tet[i], top, sizeof top);
    m.tet[i][3] = next;
    memcpy(t++, (uint32_t[3]){ top[k], next, a }, sizeof *t);
    memcpy(t++, (uint32_t[3]){ top[k], b, next }, sizeof *t);
    top[k] = next;
  }
  memcpy(t, (uint32_t[3]){ top[0], top[2], top[1] }, sizeof *t);
  return m;
}

static void cells_of_a_column_are_matched(void **state)
{
  (void)state;
  for (uint32_t by = 1; by < 21; by++) {
    struct vg_mesh m;
    struct vg_mesh_report r;

    if (by % 3 == 0 || by % 7 == 0) continue;
    m = column(by);
    r = judge(&m);
    assert_true(r.is_valid);
    assert_int_equal(r.n_inner_face, RAISED - 1);
    assert_true(fabs(r.volume - LEVELS / 2.) < 1e-12);
    for (size_t i = 0; i < RAISED; i++) {
      int n_inner = 2 - (i == 0) - (i == RAISED - 1);

      turn_over(m.tet[i]);
      r = judge(&m);
      assert_int_equal(r.not_positive, 1);
      assert_int_equal(r.same_side_face, n_inner);
      assert_int_equal(r.outward_boundary, 4 - n_inner);
      assert_int_equal(r.open_face + r.crowded_face + r.orphan_boundary, 0);
      turn_over(m.tet[i]);
    }
    vg_mesh_release(&m);
  }
}

/* --- columns on a triangulated square ------------------------------------- */

#define SIDE 9 /* Wall points per side of the square. */
#define MOST_LEVELS 7

static uint64_t seed;

static uint32_t random_below(uint32_t n)
{
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)(seed >> 33) % n;
}

/* Columns with different numbers of levels. In each level, the points of a
 * triangle are raised in the order of their numbers. */
struct block {
  uint32_t levels[SIDE * SIDE];
  struct vg_mesh m;
};

static uint32_t point_at(uint32_t wall, uint32_t level)
{
  return wall + SIDE * SIDE * level;
}

static void raise_triangle(struct block *b, const uint32_t wall[3])
{
  uint32_t at[3] = { 0, 0, 0 };

  for (uint32_t l = 0; l < MOST_LEVELS; l++)
    for (uint32_t w = 0; w < SIDE * SIDE; w++)
      for (int k = 0; k < 3; k++) {
        uint32_t *t = b->m.tet[b->m.n_tet];

        if (wall[k] != w || l >= b->levels[w]) continue;
        for (int i = 0; i < 3; i++) t[i] = point_at(wall[i], at[i]);
        t[3] = point_at(w, ++at[k]);
        b->m.n_tet++;
      }
}

static void make_block(struct block *b)
{
  const size_t most = 2 * (SIDE - 1) * (SIDE - 1);

  b->m = room_for(SIDE * SIDE * (MOST_LEVELS + 1), most * 3 * MOST_LEVELS, 0);
  b->m.n_tet = 0;
  for (uint32_t w = 0; w < SIDE * SIDE; w++)
    b->levels[w] = random_below(MOST_LEVELS + 1);
  for (uint32_t i = 0; i < b->m.n_point; i++) {
    b->m.point[i][0] = i % SIDE;
    b->m.point[i][1] = i / SIDE % SIDE;
    b->m.point[i][2] = i / (SIDE * SIDE) * (1 + 0.01 * random_below(10));
  }
  for (uint32_t y = 0; y + 1 < SIDE; y++)
    for (uint32_t x = 0; x + 1 < SIDE; x++) {
      uint32_t o = x + SIDE * y;

      raise_triangle(b, (uint32_t[3]){ o, o + 1, o + SIDE + 1 });
      raise_triangle(b, (uint32_t[3]){ o, o + SIDE + 1, o + SIDE });
    }
}

/* Random order, in which no columns are recognised. */
static void shuffle(struct vg_mesh *m)
{
  for (size_t i = m->n_tet; i-- > 1;) {
    size_t j = random_below((uint32_t)i + 1);
    uint32_t t[4];

    memcpy(t, m->tet[i], sizeof t);
    memcpy(m->tet[i], m->tet[j], sizeof t);
    memcpy(m->tet[j], t, sizeof t);
  }
}

/* Order of faces by their nodes, for qsort. */
static int by_nodes(const void *a, const void *b)
{
  return memcmp(a, b, sizeof(uint32_t[4]));
}

/* The sides without a partner: sorted nodes, and parity as the last entry. */
static uint32_t (*list_sides(const struct vg_unpaired *u))[4]
{
  uint32_t(*list)[4] = vg_alloc(u->n_face, sizeof *list);

  assert_non_null(list);
  for (size_t i = 0; i < u->n_face; i++) {
    memcpy(list[i], u->face[i].node, sizeof *list);
    list[i][3] = vg_order3(list[i]);
  }
  qsort(list, u->n_face, sizeof *list, by_nodes);
  return list;
}

static void pair(const struct vg_mesh *m, struct vg_stats *f,
                 struct vg_unpaired *u, size_t *n_component)
{
  float *volume = vg_alloc(m->n_tet, sizeof *volume);
  struct vg_error err = VG_ERROR_INIT;

  assert_non_null(volume);
  vg_judge_shape(m, 0, NULL, volume, f, NULL);
  assert_true(vg_faces_can_pair(m, u));
  assert_int_equal(vg_judge_faces(m, volume, f, NULL, u, n_component, &err),
                   VG_OK);
  free(volume);
}

/* Defects: turned and missing cells. */
static void spoil(struct vg_mesh *m, uint32_t n)
{
  for (; n; n--) {
    uint32_t at = random_below((uint32_t)m->n_tet);

    if (n % 2) turn_over(m->tet[at]);
    else memcpy(m->tet[at], m->tet[--m->n_tet], sizeof *m->tet);
  }
}

static void columns_are_matched_like_single_cells(void **state)
{
  (void)state;
  for (seed = 1; seed < 40; seed++) {
    uint64_t first = seed;
    struct block b;
    struct vg_stats *f[2] = { vg_stats_new(), vg_stats_new() };
    struct vg_unpaired u[2] = { { .n_face = 0 }, { .n_face = 0 } };
    uint32_t(*side[2])[4];
    size_t n_component[2];

    assert_true(f[0] && f[1]);
    make_block(&b);
    spoil(&b.m, (uint32_t)first % 7);
    for (int k = 0; k < 2; k++) {
      if (k) shuffle(&b.m);
      pair(&b.m, f[k], &u[k], &n_component[k]);
      side[k] = list_sides(&u[k]);
    }
    assert_int_equal(n_component[0], n_component[1]);
    assert_int_equal(u[0].n_face, u[1].n_face);
    assert_memory_equal(side[0], side[1], u[0].n_face * sizeof **side);
    /* the limbs of the sums that follow depend on the order */
    assert_memory_equal(&f[0]->n, &f[1]->n, offsetof(struct vg_counts, volume));
    for (int k = 0; k < 2; k++) {
      vg_unpaired_release(&u[k]);
      free(side[k]);
      free(f[k]);
    }
    vg_mesh_release(&b.m);
    seed = first;
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(many_faces_may_wait),
    cmocka_unit_test(cells_of_a_column_are_matched),
    cmocka_unit_test(columns_are_matched_like_single_cells),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
