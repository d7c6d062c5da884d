/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Periodic patches on random triangulations: the transform is found, points and
 * faces are matched one to one, and faults are reported. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/periodic/periodic.h"

enum { N = 9, SQUARES = N * N, POINTS = (N + 1) * (N + 1) };

static uint64_t state;

static double random_in(double lo, double hi)
{
  state = state * 6364136223846793005u + 1442695040888963407u;
  return lo + (hi - lo) * (double)(state >> 11) / 9007199254740992.0;
}

/* Shuffled numbers 0 .. n - 1. */
static void shuffle(size_t n, size_t *to)
{
  for (size_t i = 0; i < n; i++) {
    const size_t k = (size_t)random_in(0, (double)i + 0.999);

    to[i] = to[k];
    to[k] = i;
  }
}

/* Patches 3 and 8: a wavy surface with random points and diagonals, and its
 * image by p, moved by up to `noise`, with reversed triangles. Points and
 * triangles are in random order. */
static void make(struct vg_mesh *m, const struct vg_periodic *p, double noise)
{
  const struct vg_patch patch[2] = { { .id = 3 }, { .id = 8 } };
  size_t point[2 * POINTS], tri[4 * SQUARES], at = 0;

  *m = (struct vg_mesh)VG_MESH_INIT;
  m->n_point = 2 * POINTS;
  m->n_tri = 4 * SQUARES;
  m->n_patch = 2;
  m->point = vg_alloc(m->n_point, sizeof *m->point);
  m->tri = vg_alloc(m->n_tri, sizeof *m->tri);
  m->tri_patch = vg_alloc(m->n_tri, sizeof *m->tri_patch);
  m->patch = vg_alloc(2, sizeof *m->patch);
  memcpy(m->patch, patch, sizeof patch);
  shuffle(m->n_point, point);
  shuffle(m->n_tri, tri);
  for (size_t i = 0; i < POINTS; i++) {
    const double u = (double)(i / (N + 1)) + random_in(-.2, .2);
    const double v = (double)(i % (N + 1)) + random_in(-.2, .2);
    double *x = m->point[point[i]], *y = m->point[point[POINTS + i]];

    x[0] = 4 + u;
    x[1] = 0.1 * sin(u) + 0.02 * u * v;
    x[2] = v;
    vg_periodic_image(p, x, y);
    for (int k = 0; k < 3; k++) y[k] += random_in(-noise, noise);
  }
  for (size_t s = 0; s < SQUARES; s++) {
    const size_t a = s / N * (N + 1) + s % N, c = a + N + 2;
    const size_t q[2][2][3] = { { { a, a + 1, c }, { a, c, c - 1 } },
                                { { a, a + 1, c - 1 }, { a + 1, c, c - 1 } } };
    const int diagonal = random_in(0, 1) < .5;

    for (int t = 0; t < 2; t++)
      for (int side = 0; side < 2; side++, at++)
        for (int k = 0; k < 3; k++) {
          const size_t node = q[diagonal][t][side ? 2 - k : k];

          m->tri_patch[tri[at]] = (uint32_t)side;
          m->tri[tri[at]][k] = (uint32_t)point[node + (side ? POINTS : 0)];
        }
  }
}

/* A random translation, or a rotation by 1 / n turns. */
static struct vg_periodic transform(int n)
{
  struct vg_periodic p = { .patch = 3, .image = 8, .is_rotation = n > 0 };

  for (int k = 0; k < 3; k++) {
    p.shift[k] = random_in(-20, 20);
    p.axis[k] = k == 2 ? 1 : random_in(-.3, .3);
    p.centre[k] = random_in(-1, 1);
  }
  vg_unit(p.axis);
  if (n) vg_periodic_turn(&p, (n % 2 ? 360. : -360.) / n);
  return p;
}

static void turns(void **unused)
{
  struct vg_periodic p = { .is_rotation = 1 };

  (void)unused;
  for (double a = -180; a <= 180; a += 0.37) {
    const double x = a * 3.14159265358979323846 / 180;

    vg_periodic_turn(&p, a);
    assert_true(fabs(p.sine - sin(x)) < 2e-5 && fabs(p.cosine - cos(x)) < 2e-5);
    assert_true(fabs(p.sine * p.sine + p.cosine * p.cosine - 1) < 1e-15);
    assert_true(fabs(vg_periodic_degrees(&p) - a) <= VG_PERIODIC_DEGREES ||
                fabs(fabs(a) - 180) < 1e-3);
  }
  for (int n = 2; n <= VG_PERIODIC_MOST; n++) {
    vg_periodic_turn(&p, 360. / n + 5e-4);
    assert_int_equal(p.n, n);
    assert_true(fabs(p.sine - sin(2 * 3.14159265358979323846 / n)) < 1e-15);
  }
  vg_periodic_turn(&p, -90);
  assert_true(p.cosine == 0 && p.sine == -1 && p.n == 4);
  vg_periodic_turn(&p, 51.43);
  assert_int_equal(p.n, 0);
}

static void found(void **unused)
{
  (void)unused;
  for (int i = 0; i < 60; i++) {
    struct vg_periodic_match r;
    struct vg_periodic want, p = { .patch = 3, .image = 8 };
    struct vg_mesh m;

    state = (uint64_t)i;
    want = transform(i % 12 < 2 ? 0 : i % 12);
    make(&m, &want, i % 2 ? 1e-7 : 0);
    assert_true(vg_periodic_find(&m, &p));
    assert_int_equal(p.is_rotation, want.is_rotation);
    if (p.is_rotation) assert_int_equal(p.n, want.n);
    assert_int_equal(vg_periodic_match(&m, &p, 1e-4, &r, NULL), VG_OK);
    assert_true(vg_periodic_matches(&r));
    assert_true(r.distance < 1e-5);
    assert_int_equal(r.n_face[0], 2 * SQUARES);
    vg_periodic_apply(&m, &p, &r);
    assert_int_equal(p.n_face, 2 * SQUARES);
    vg_periodic_match_release(&r);
    assert_int_equal(vg_periodic_match(&m, &p, 0, &r, NULL), VG_OK);
    assert_true(vg_periodic_matches(&r) && r.distance == 0);
    for (size_t f = 0; f < m.n_tri; f++)
      assert_int_equal(r.face[f] != VG_PERIODIC_NONE, !m.tri_patch[f]);
    vg_periodic_match_release(&r);
    vg_mesh_release(&m);
  }
}

/* The median of the differences is exact where most of them are. */
static void refined(void **unused)
{
  struct vg_periodic want = { .patch = 3, .image = 8, .shift = { 0, 16, 0 } };
  struct vg_periodic p = { .patch = 3, .image = 8 };
  struct vg_periodic_match r;
  struct vg_mesh m;

  (void)unused;
  state = 7;
  make(&m, &want, 0);
  for (size_t f = 0; f < m.n_tri; f += 40) m.point[m.tri[f][0]][1] += 1e-7;
  assert_true(vg_periodic_find(&m, &p));
  assert_int_equal(vg_periodic_match(&m, &p, 1e-4, &r, NULL), VG_OK);
  assert_int_equal(vg_periodic_refine(&m, &p, &r, NULL), VG_OK);
  assert_true(p.shift[0] == 0 && fabs(p.shift[1] - 16) < 1e-14 &&
              p.shift[2] == 0);
  vg_periodic_match_release(&r);
  vg_mesh_release(&m);
}

static void faults(void **unused)
{
  (void)unused;
  for (int i = 0; i < 5; i++) {
    struct vg_periodic want, p;
    struct vg_periodic_match r;
    struct vg_mesh m;
    size_t f = 0;

    state = 100 + (uint64_t)i;
    want = p = transform(i % 2 ? 7 : 0);
    make(&m, &want, 0);
    while (m.tri_patch[f] != 1) f++;
    if (i == 0) m.point[m.tri[f][0]][1] += 0.01; /* a point is off */
    if (i == 1)
      memcpy(m.tri[f], (uint32_t[3]){ m.tri[f][1], m.tri[f][0], m.tri[f][2] },
             sizeof *m.tri);        /* a face is reversed */
    if (i == 2) m.tri_patch[f] = 0; /* one face less */
    if (i == 3) p.centre[0] += 0.5; /* another axis */
    if (i == 4) p.patch = 5;        /* no such patch */
    assert_int_equal(vg_periodic_match(&m, &p, 1e-4, &r, NULL), VG_OK);
    assert_false(vg_periodic_matches(&r));
    if (i == 0) assert_true(r.n_off && fabs(r.distance - 0.01) < 1e-3);
    if (i == 1) assert_true(!r.n_off && r.n_bad == 1);
    if (i == 3) assert_int_equal(r.n_off, POINTS);
    if (i == 4) assert_true(r.worst == VG_PERIODIC_NONE);
    if (i == 4) assert_false(vg_periodic_find(&m, &p));
    vg_periodic_match_release(&r);
    vg_mesh_release(&m);
  }
}

/* Points of two pairs that share edges, in a box of squares: points and images
 * are in the same order, also along the edge that both pairs move. */
static void ordered(void **unused)
{
  enum { M = 4, SIDE = (M + 1) * (M + 1) };
  const struct vg_periodic pair[2] = {
    { .patch = 1, .image = 2, .shift = { 1, 0, 0 } },
    { .patch = 3, .image = 4, .shift = { 0, 1, 0 } }
  };

  (void)unused;
  for (int s = 0; s < 20; s++) {
    struct vg_periodic_match r[2];
    struct vg_mesh m = VG_MESH_INIT;
    size_t at[SIDE * (M + 1)];
    int is_changed;

    state = (uint64_t)s;
    m.n_point = SIDE * (M + 1);
    m.point = vg_alloc(m.n_point, sizeof *m.point);
    m.tri = vg_alloc(8 * M * M, sizeof *m.tri);
    m.tri_patch = vg_alloc(8 * M * M, sizeof *m.tri_patch);
    for (int32_t i = 1; i <= 4; i++) vg_mesh_add_patch(&m, i, NULL);
    shuffle(m.n_point, at);
    for (size_t i = 0; i < m.n_point; i++) {
      const size_t n[3] = { i % (M + 1), i / (M + 1) % (M + 1), i / SIDE };

      for (int k = 0; k < 3; k++) m.point[at[i]][k] = (double)n[k] / M;
    }
    for (uint32_t p = 0; p < 4; p++)
      for (size_t q = 0; q < M * M; q++) {
        const size_t along = p < 2 ? M + 1 : 1, across = p < 2 ? 1 : M + 1;
        const size_t a = p % 2 * M * across + q % M * along + q / M * SIDE;
        const size_t v[4] = { a, a + along, a + along + SIDE, a + SIDE };

        for (int t = 0; t < 2; t++) {
          for (int k = 0; k < 3; k++) {
            const int c = k ? k + t : 0;

            m.tri[m.n_tri][p % 2 ? 2 - k : k] = (uint32_t)at[v[c]];
          }
          m.tri_patch[m.n_tri++] = p;
        }
      }
    for (int p = 0; p < 2; p++) {
      assert_int_equal(vg_periodic_match(&m, &pair[p], 1e-9, &r[p], NULL),
                       VG_OK);
      assert_true(vg_periodic_matches(&r[p]));
    }
    assert_int_equal(vg_periodic_order(&m, 2, r, &is_changed, NULL), VG_OK);
    assert_true(is_changed);
    for (int p = 0; p < 2; p++) {
      vg_periodic_match_release(&r[p]);
      assert_int_equal(vg_periodic_match(&m, &pair[p], 0, &r[p], NULL), VG_OK);
      assert_true(vg_periodic_matches(&r[p]));
      for (size_t e = 0; e < 3 * m.n_tri; e++) {
        const uint32_t a = m.tri[e / 3][e % 3], b = m.tri[e / 3][(e + 1) % 3];

        if (m.tri_patch[e / 3] != 2 * (uint32_t)p) continue;
        assert_int_equal(a < b, r[p].point[a] < r[p].point[b]);
      }
      vg_periodic_match_release(&r[p]);
    }
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(turns),   cmocka_unit_test(found),
    cmocka_unit_test(refined), cmocka_unit_test(ordered),
    cmocka_unit_test(faults),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
