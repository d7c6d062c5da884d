/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Surfaces whose triangles are not Delaunay are recovered in the cells;
 * surfaces that are not a boundary are refused with a message, and nothing is
 * changed. */
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/checks.h"
#include "core/recover/boundary.h"
#include "core/recover/cdt_tetgen.h"
#include "core/recover/recover.h"
#include "fill_shapes.h"
#include "tets_support.h"
#include "parts_support.h"

#define TRI(m) (const uint32_t(*)[3])(m)->tri
#define POINT(m) (const double(*)[3])(m)->point

/* --- surfaces ----------------------------------------------------------- */

/* The triangle that has the edge from a to b. */
static size_t tri_of_edge(const struct vg_mesh *m, uint32_t a, uint32_t b,
                          int *corner)
{
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (m->tri[i][k] == a && m->tri[i][(k + 1) % 3] == b) {
        *corner = k;
        return i;
      }
  return SIZE_MAX;
}

/* Swap the edge opposite corner k of triangle i if both triangles are in one
 * plane and the new ones have the same orientation. */
static int turn_edge(struct vg_mesh *m, size_t i, int k)
{
  uint32_t a = m->tri[i][k], b = m->tri[i][(k + 1) % 3];
  uint32_t c = m->tri[i][(k + 2) % 3], d;
  double(*x)[3] = m->point, far[3];
  int other = 0;
  size_t j = tri_of_edge(m, b, a, &other);

  d = m->tri[j][(other + 2) % 3];
  if (vg_orient3d(x[a], x[b], x[c], x[d]) != 0) return 0;
  for (int axis = 0; axis < 3; axis++) far[axis] = x[a][axis] + 0.1 * axis;
  for (int axis = 0; axis < 3 && vg_orient3d(x[a], x[b], x[c], far) == 0;
       axis++)
    far[axis] += 1;
  if (vg_orient3d(x[a], x[b], x[c], far) > 0
        ? vg_orient3d(x[a], x[d], x[c], far) <= 0 ||
            vg_orient3d(x[d], x[b], x[c], far) <= 0
        : vg_orient3d(x[a], x[d], x[c], far) >= 0 ||
            vg_orient3d(x[d], x[b], x[c], far) >= 0)
    return 0;
  m->tri[i][0] = a;
  m->tri[i][1] = d;
  m->tri[i][2] = c;
  m->tri[j][0] = d;
  m->tri[j][1] = b;
  m->tri[j][2] = c;
  return 1;
}

/* n edges swapped at random: flat sides with arbitrary triangles. */
static void turn_edges(struct vg_mesh *m, int n, uint64_t seed)
{
  while (n) {
    size_t i = (size_t)(tets_random(&seed) * (double)m->n_tri);

    n -= turn_edge(m, i, (int)(3 * tets_random(&seed)));
  }
}

/* A triangular prism whose top is rotated relative to its bottom so that its
 * sides bend inwards: Schoenhardt's polyhedron, which needs an additional
 * point. */
static void twisted_prism(struct vg_mesh *m, double twist)
{
  size_t patch = vg_mesh_add_patch(m, 1, "prism");

  for (int i = 0; i < 6; i++) {
    double angle = 2 * M_PI / 3 * i + (i < 3 ? 0 : twist);

    shape_point(m, cos(angle), sin(angle), i < 3 ? 0 : 1);
  }
  shape_tri(m, 0, 1, 2, patch);
  shape_tri(m, 3, 5, 4, patch);
  for (uint32_t i = 0; i < 3; i++) {
    uint32_t j = (i + 1) % 3;

    shape_tri(m, i, 3 + j, j, patch);
    shape_tri(m, i, 3 + i, 3 + j, patch);
  }
}

static double enclosed(const struct vg_mesh *m)
{
  const double zero[3] = { 0, 0, 0 };
  double sum = 0;

  for (size_t i = 0; i < m->n_tri; i++)
    sum -= vg_orient3d(zero, m->point[m->tri[i][0]], m->point[m->tri[i][1]],
                       m->point[m->tri[i][2]]) /
           6;
  return sum;
}

/* --- invariants --------------------------------------------------------- */

static int by_corners(const void *a, const void *b)
{
  return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* The lowest corner first, with the orientation kept. */
static void put_face(uint32_t (*list)[3], size_t n, const uint32_t v[3])
{
  int low = v[1] < v[0] ? 1 : 0;

  if (v[2] < v[low]) low = 2;
  for (int k = 0; k < 3; k++) list[n][k] = v[(low + k) % 3];
}

/* The fixed faces of fluid cells are exactly the triangles, with their
 * orientation. */
static void faces_are(const struct vg_tets *t, const struct vg_mesh *m)
{
  uint32_t(*want)[3] = vg_alloc(m->n_tri, sizeof *want);
  uint32_t(*have)[3] = vg_alloc(4 * t->n_cell, sizeof *have);
  size_t n = 0;

  assert_true(want && have);
  for (size_t i = 0; i < m->n_tri; i++) put_face(want, i, m->tri[i]);
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++) {
      uint32_t v[3];

      if (t->flag[c] & (VG_DEAD | VG_OUTSIDE) || !(t->flag[c] >> i & 1))
        continue;
      for (int k = 0; k < 3; k++) v[k] = t->cell[c].v[vg_face[i][k]];
      put_face(have, n++, v);
    }
  assert_int_equal(n, m->n_tri);
  qsort(want, n, sizeof *want, by_corners);
  qsort(have, n, sizeof *have, by_corners);
  assert_memory_equal(have, want, n * sizeof *want);
  free(want);
  free(have);
}

static struct vg_boundary_report recovered(struct vg_mesh *m)
{
  struct vg_tets t = VG_TETS_INIT;
  struct vg_boundary_report r;
  struct vg_error err = VG_ERROR_INIT;
  double volume = enclosed(m);

  if (vg_boundary_tets(m->n_point, POINT(m), m->n_tri, TRI(m), NULL, &t, &r,
                       &err))
    fail_msg("%s", err.text);
  assert_int_equal(vg_tets_defects(&t), 0);
  assert_memory_equal(t.x, m->point, m->n_point * sizeof *m->point);
  faces_are(&t, m);
  assert_true(fabs(tets_volume(&t) - volume) < 1e-11 * volume);
  assert_int_equal(t.n_point,
                   m->n_point + r.n_steiner + (r.whole_void ? 0 : 8));
  assert_true(r.n_face_left <= r.n_face_lost);
  assert_int_equal(r.n_pocket > 0, r.n_face_left > 0);
  assert_true(r.n_pocket <= r.n_face_left + 3 * r.n_retry);
  assert_true(r.n_pocket_cell >= r.n_pocket);
  vg_tets_release(&t);
  vg_mesh_release(m);
  return r;
}

/* --- Delaunay surfaces -------------------------------------------------- */

static void all_faces_of_an_octahedron_are_recovered(void **state)
{
  const double centre[3] = { 0, 0, 0 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_boundary_report r;

  (void)state;
  shape_sphere(&m, 1, centre, 1, 1);
  for (size_t i = 0; i < m.n_tri; i++) { /* fluid inside */
    uint32_t keep = m.tri[i][0];

    m.tri[i][0] = m.tri[i][1];
    m.tri[i][1] = keep;
  }
  r = recovered(&m);
  assert_int_equal(r.n_face_lost + r.n_pocket + r.n_pocket_cell + r.n_retry, 0);
  assert_int_equal(r.n_steiner, 0);
  assert_int_equal(r.whole_void, 0);
}

/* --- other surfaces ----------------------------------------------------- */

static void diagonals_turned_at_random(void **state)
{
  static const int turns[4] = { 1, 20, 150, 600 };

  (void)state;
  needs_tetgen();
  for (int k = 0; k < 4; k++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_boundary_report r;

    shape_box(&m, 6, 0.5);
    turn_edges(&m, turns[k], 17);
    r = recovered(&m);
    if (turns[k] >= 150) assert_true(r.n_face_lost > 50);
    assert_true(10 * r.n_face_left <= r.n_face_lost);
  }
}

/* Coarse tubes with many points around them, their quads cut along the other
 * diagonal if requested. */
static size_t torus_loses(int nu, int nv, int other_way)
{
  struct vg_mesh m = VG_MESH_INIT;

  shape_torus(&m, nu, nv, 1, 0.4);
  for (size_t i = 0; other_way && i < m.n_tri; i += 2) {
    uint32_t c = m.tri[i][1], b = m.tri[i][2], d = m.tri[i + 1][1];

    m.tri[i][1] = d;
    m.tri[i + 1][0] = b;
    m.tri[i + 1][1] = d;
    m.tri[i + 1][2] = c;
  }
  return recovered(&m).n_face_lost;
}

static void a_torus_of_either_diagonal(void **state)
{
  (void)state;
  assert_true(torus_loses(9, 30, 0) > 20);
  assert_true(torus_loses(9, 30, 1) > 20);
}

/* TetGen 1.5.0 never ends on a pocket of this surface. */
static void a_pocket_that_tetgen_does_not_end(void **state)
{
  (void)state;
  assert_true(torus_loses(7, 20, 0) > 20);
}

static void a_twisted_prism_gets_a_point(void **state)
{
  static const double twist[3] = { 0.2, 0.5, 0.9 };

  (void)state;
  needs_tetgen();
  for (int k = 0; k < 3; k++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_boundary_report r;

    twisted_prism(&m, twist[k]);
    r = recovered(&m);
    assert_true(r.n_face_left > 0);
    assert_true(r.n_steiner >= 1);
  }
}

/* A bar 300 long, 2 wide and 0.02 thick, its flat sides triangulated
 * arbitrarily. */
static void long_slivers(void **state)
{
  const int n[3] = { 30, 2, 1 };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 300, 2, 0.02 };

  (void)state;
  needs_tetgen();
  for (uint64_t seed = 1; seed < 5; seed++) {
    struct vg_mesh m = VG_MESH_INIT;

    shape_block(&m, n, lo, hi, shape_all);
    turn_edges(&m, 60 * (int)(seed - 1), seed);
    recovered(&m);
  }
}

static void a_body_with_turned_diagonals(void **state)
{
  const double centre[3] = { 0.05, 0, 0 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 5, 1.2);
  turn_edges(&m, 100, 3);
  shape_sphere(&m, 6, centre, 1.1, 7);
  assert_true(recovered(&m).n_face_lost > 0);
}

/* The count of the report compared with a count here, face by face. */
static void lost_faces_are_counted(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_boundary_report r = { 0 };
  struct vg_inserter s;
  uint8_t *missing;
  size_t n, again = 0, n_point;

  (void)state;
  needs_tetgen();
  shape_box(&m, 4, 0.5);
  turn_edges(&m, 100, 5);
  tets_box(&t, -2, 2);
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  for (size_t p = 0; p < m.n_point; p++)
    assert_int_equal(tets_insert(&s, m.point[p], 0, 0), VG_OK);
  vg_inserter_release(&s);
  for (size_t i = 0; i < m.n_tri; i++)
    for (int k = 0; k < 3; k++) m.tri[i][k] += 8; /* after the corners */
  missing = vg_alloc(m.n_tri, 1);
  assert_non_null(missing);
  assert_int_equal(vg_boundary_fix(&t, m.n_tri, TRI(&m), missing, &n, NULL),
                   VG_OK);
  for (size_t i = 0; i < m.n_tri; i++) again += missing[i];
  assert_true(n > 0);
  assert_int_equal(n, again);
  n_point = t.n_point;
  assert_int_equal(vg_recover(&t, m.n_tri, TRI(&m), 1, 0, &r, NULL), VG_OK);
  assert_int_equal(r.n_face_lost, n);
  assert_true(r.n_pocket <= r.n_face_left && 10 * r.n_face_left < n);
  assert_int_equal(t.n_point, n_point + r.n_steiner);
  assert_int_equal(vg_tets_defects(&t), 0);
  assert_true(fabs(tets_volume(&t) - 64) < 1e-10);
  assert_int_equal(vg_boundary_fix(&t, m.n_tri, TRI(&m), missing, &n, NULL),
                   VG_OK);
  assert_int_equal(n, 0);
  assert_int_equal(vg_boundary_sides(&t, m.n_tri, TRI(&m), NULL, 0, NULL, NULL),
                   VG_OK);
  faces_are(&t, &m);
  assert_true(fabs(tets_volume(&t) - 1) < 1e-12);
  free(missing);
  vg_tets_release(&t);
  vg_mesh_release(&m);
}

static void are_same(const struct vg_tets *a, const struct vg_tets *b)
{
  assert_int_equal(a->n_cell, b->n_cell);
  assert_int_equal(a->n_point, b->n_point);
  assert_memory_equal(a->flag, b->flag, a->n_cell);
  for (size_t c = 0; c < a->n_cell; c++)
    if (!(a->flag[c] & VG_DEAD))
      assert_memory_equal(a->cell[c].v, b->cell[c].v, sizeof a->cell[c].v);
  assert_memory_equal(a->x, b->x, a->n_point * sizeof *a->x);
}

static void the_same_bytes_again(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_tets t[2] = { VG_TETS_INIT, VG_TETS_INIT };
  struct vg_boundary_report r[2];

  (void)state;
  needs_tetgen();
  shape_box(&m, 6, 0.5);
  turn_edges(&m, 300, 21);
  for (int k = 0; k < 2; k++)
    assert_int_equal(vg_boundary_tets(m.n_point, POINT(&m), m.n_tri, TRI(&m),
                                      NULL, &t[k], &r[k], NULL),
                     VG_OK);
  are_same(&t[0], &t[1]);
  vg_tets_release(&t[0]);
  vg_tets_release(&t[1]);
  vg_mesh_release(&m);
}

/* --- allocations that fail ------------------------------------------------ */

static long n_alloc, fails_at; /* 0: none */

static int fails(void)
{
  return ++n_alloc == fails_at;
}

#include "failing_calls.h"

FAILS_MEMORY

/* Without memory there is an error, or the same cells after a repetition, and
 * no pocket is closed in another way. */
static void every_allocation_fails(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_tets first = VG_TETS_INIT;
  struct vg_boundary_report r;
  long n_failed = 0, n;

  (void)state;
  needs_tetgen();
  if (VG_CHECKS_ON) skip(); /* a check without memory ends the program */
  twisted_prism(&m, 0.5);
  n_alloc = 0;
  for (fails_at = 0; fails_at <= n_alloc; fails_at++) {
    struct vg_tets t = VG_TETS_INIT;
    struct vg_error err = VG_ERROR_INIT;
    vg_status st;

    n = n_alloc;
    n_alloc = 0;
    st = vg_boundary_tets(m.n_point, POINT(&m), m.n_tri, TRI(&m), NULL,
                          fails_at ? &t : &first, &r, &err);
    if (st != VG_OK && st != VG_ERR_MEMORY)
      fail_msg("allocation %ld: status %d, %s", fails_at, st, err.text);
    n_failed += st < 0;
    if (st == VG_OK && fails_at) are_same(&t, &first);
    vg_tets_release(&t);
    if (n > n_alloc) n_alloc = n;
  }
  assert_true(n_failed > 100);
  fails_at = 0;
  vg_tets_release(&first);
  vg_mesh_release(&m);
}

/* --- refusal ------------------------------------------------------------ */

/* Captures the standard output between the two calls. */
static int divert(FILE **to)
{
  int kept;

  fflush(stdout);
  *to = tmpfile();
  kept = dup(STDOUT_FILENO);
  assert_true(*to && kept >= 0);
  assert_true(dup2(fileno(*to), STDOUT_FILENO) >= 0);
  return kept;
}

static void nothing_was_printed(int kept, FILE *to)
{
  fflush(stdout);
  assert_true(dup2(kept, STDOUT_FILENO) >= 0);
  close(kept);
  assert_int_equal(lseek(fileno(to), 0, SEEK_END), 0);
  fclose(to);
}

static void refused(struct vg_mesh *m)
{
  struct vg_tets t = VG_TETS_INIT;
  struct vg_boundary_report r;
  struct vg_error err = VG_ERROR_INIT;
  FILE *to;
  int kept = divert(&to);
  vg_status st = vg_boundary_tets(m->n_point, POINT(m), m->n_tri, TRI(m), NULL,
                                  &t, &r, &err);

  nothing_was_printed(kept, to);
  assert_int_equal(st, VG_ERR_GEOMETRY);
  assert_true(strlen(err.text) > 10);
  assert_int_equal(t.n_cell + t.n_point, 0);
  assert_null(t.cell);
  vg_mesh_release(m);
}

static void an_open_surface(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 3, 0.5);
  m.n_tri--;
  refused(&m);
}

static void one_triangle_turned_over(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  uint32_t keep;

  (void)state;
  shape_box(&m, 3, 0.5);
  keep = m.tri[20][0];
  m.tri[20][0] = m.tri[20][1];
  m.tri[20][1] = keep;
  refused(&m);
}

static void unbounded_fluid(void **state)
{
  const double centre[3] = { 0, 0, 0 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_sphere(&m, 4, centre, 1, 1);
  refused(&m);
}

static void two_points_in_one_place(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 3, 0.5);
  memcpy(m.point[7], m.point[30], sizeof *m.point);
  refused(&m);
}

/* A box through the wall of another. */
static void crossing_boxes(void **state)
{
  const int n[3] = { 3, 3, 3 };
  const double lo[3] = { 0.1, 0.13, -0.21 }, hi[3] = { 1.1, 0.33, 0.17 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 3, 0.5);
  shape_block(&m, n, lo, hi, shape_all);
  refused(&m);
}

static void many_crossing_spheres(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 4, 3);
  for (int k = 0; k < 6; k++) {
    const double centre[3] = { 0.3 * k - 1, 0.1 * k, 0.05 * k * k };

    shape_sphere(&m, 4, centre, 1, 20 + k);
  }
  refused(&m);
}

/* --- TetGen itself ------------------------------------------------------ */

static void tetgen_fails_alone(void **state)
{
  static const double x[6][3] = { { 0, 0, 0 },     { 1, 0, 0 },
                                  { 0, 1, 0 },     { 0.2, 0.2, -1 },
                                  { 0.3, 0.3, 1 }, { 2, 2, 0.5 } };
  static const uint32_t crossing[2][3] = { { 0, 1, 2 }, { 3, 4, 5 } };
  static const uint32_t fine[1][3] = { { 0, 1, 2 } };
  struct vg_cdt_job job[4] = {
    { .n = 6, .n_tri = 1, .x = x, .tri = fine },
    { .n = 6, .n_tri = 2, .x = x, .tri = crossing },
    { .n = 3, .n_tri = 1, .x = x, .tri = fine }, /* flat: no cell at all */
    { .n = 6, .n_tri = 1, .x = x, .tri = fine }
  };
  FILE *to;
  int kept = divert(&to);
  vg_status st = vg_cdt_tetgen(4, job, NULL);

  (void)state;
  needs_tetgen();
  nothing_was_printed(kept, to);
  assert_int_equal(st, VG_OK);
  for (int k = 0; k < 4; k += 3) {
    assert_int_equal(job[k].st, VG_OK);
    assert_true(job[k].n_all >= 6 && job[k].n_tet >= 3);
    assert_memory_equal(job[k].all, x, sizeof x);
  }
  assert_int_equal(job[0].n_tet, job[3].n_tet);
  assert_memory_equal(job[0].tet, job[3].tet,
                      job[0].n_tet * sizeof *job[0].tet);
  for (int k = 1; k < 3; k++) {
    assert_int_equal(job[k].st, VG_ERR_GEOMETRY);
    assert_null(job[k].all);
    assert_null(job[k].tet);
  }
  for (int k = 0; k < 4; k++) {
    free(job[k].all);
    free(job[k].tet);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(all_faces_of_an_octahedron_are_recovered),
    cmocka_unit_test(diagonals_turned_at_random),
    cmocka_unit_test(a_torus_of_either_diagonal),
    cmocka_unit_test(a_pocket_that_tetgen_does_not_end),
    cmocka_unit_test(a_twisted_prism_gets_a_point),
    cmocka_unit_test(long_slivers),
    cmocka_unit_test(a_body_with_turned_diagonals),
    cmocka_unit_test(lost_faces_are_counted),
    cmocka_unit_test(the_same_bytes_again),
    cmocka_unit_test(every_allocation_fails),
    cmocka_unit_test(an_open_surface),
    cmocka_unit_test(one_triangle_turned_over),
    cmocka_unit_test(unbounded_fluid),
    cmocka_unit_test(two_points_in_one_place),
    cmocka_unit_test(crossing_boxes),
    cmocka_unit_test(many_crossing_spheres),
    cmocka_unit_test(tetgen_fails_alone),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
