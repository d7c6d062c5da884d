/* Fronts as tasks get them: joined, their volume, bytes and back. */
#include "io_support.h"

#include "fill_shapes.h"
#include "base/bytes.h"
#include "partition/job.h"
#include "tets_support.h"

/* A front of the triangles of m, which is released. Names are not in the order
 * of the points. */
static struct vg_front front_of(struct vg_mesh *m)
{
  struct vg_front f = VG_FRONT_INIT;

  f.n_point = m->n_point;
  f.n_face = m->n_tri;
  f.x = vg_alloc(f.n_point, sizeof *f.x);
  f.name = vg_alloc(f.n_point, sizeof *f.name);
  f.face = vg_alloc(f.n_face, sizeof *f.face);
  assert_true(f.x && f.name && f.face);
  memcpy(f.x, m->point, f.n_point * sizeof *f.x);
  memcpy(f.face, m->tri, f.n_face * sizeof *f.face);
  for (size_t k = 0; k < f.n_point; k++)
    f.name[k] = VG_POINT_NAME(7 + k % 3, 1000000 - k);
  vg_mesh_release(m);
  return f;
}

static struct vg_front block(int nx, int ny, int nz, int (*in)(const int at[3]))
{
  const int n[3] = {nx, ny, nz};
  const double lo[3] = {0, 0, 0}, hi[3] = {nx, ny, nz};
  struct vg_mesh m = VG_MESH_INIT;

  shape_block(&m, n, lo, hi, in);
  return front_of(&m);
}

/* --- joining ------------------------------------------------------------- */

static int by_name(const void *a, const void *b)
{
  return memcmp(a, b, 3 * sizeof(uint64_t));
}

/* Faces by the names of their points, the least first, sorted. */
static uint64_t (*named(const struct vg_front *f))[3]
{
  uint64_t (*t)[3] = vg_alloc(f->n_face, sizeof *t);

  assert_non_null(t);
  for (size_t i = 0; i < f->n_face; i++) {
    int low = 0;

    for (int k = 1; k < 3; k++)
      if (f->name[f->face[i][k]] < f->name[f->face[i][low]]) low = k;
    for (int k = 0; k < 3; k++) t[i][k] = f->name[f->face[i][(low + k) % 3]];
  }
  qsort(t, f->n_face, sizeof *t, by_name);
  return t;
}

static void same_front(const struct vg_front *a, const struct vg_front *b)
{
  uint64_t (*s)[3] = named(a), (*t)[3] = named(b);

  assert_int_equal(a->n_face, b->n_face);
  assert_int_equal(a->n_point, b->n_point);
  assert_memory_equal(s, t, a->n_face * sizeof *s);
  free(s);
  free(t);
}

/* Every point is used, and stands where the one of its name does. */
static void is_part_of(const struct vg_front *f, const struct vg_front *whole)
{
  uint8_t *used = vg_calloc(f->n_point, 1);

  assert_non_null(used);
  for (size_t i = 0; i < f->n_face; i++)
    for (int k = 0; k < 3; k++) {
      assert_true(f->face[i][k] < f->n_point);
      used[f->face[i][k]] = 1;
    }
  for (size_t k = 0; k < f->n_point; k++) {
    size_t w = 0;

    assert_true(used[k]);
    while (w < whole->n_point && whole->name[w] != f->name[k]) w++;
    assert_true(w < whole->n_point);
    assert_memory_equal(f->x[k], whole->x[w], sizeof *f->x);
  }
  free(used);
}

/* The faces k, k + n, ... with their points. */
static struct vg_front some_of(const struct vg_front *f, size_t k, size_t n)
{
  struct vg_front out = VG_FRONT_INIT;
  uint32_t *to = vg_calloc(f->n_point, sizeof *to);

  out.x = vg_alloc(f->n_point, sizeof *out.x);
  out.name = vg_alloc(f->n_point, sizeof *out.name);
  out.face = vg_alloc(f->n_face, sizeof *out.face);
  assert_true(to && out.x && out.name && out.face);
  for (size_t i = k; i < f->n_face; i += n, out.n_face++)
    for (int j = 0; j < 3; j++) {
      uint32_t p = f->face[i][j];

      if (!to[p]) {
        memcpy(out.x[out.n_point], f->x[p], sizeof *out.x);
        out.name[out.n_point] = f->name[p];
        to[p] = (uint32_t)++out.n_point;
      }
      out.face[out.n_face][j] = to[p] - 1;
    }
  free(to);
  return out;
}

/* Points of several parts are there once; one part has no face. */
static void parts_are_joined(void **state)
{
  struct vg_front f = block(4, 4, 3, shape_all), all = VG_FRONT_INIT;
  const size_t first[4] = {0, 2, f.n_face, 1};

  (void)state;
  for (int k = 0; k < 4; k++) {
    struct vg_front part = some_of(&f, first[k], 3);

    assert_int_equal(vg_front_append(&all, &part, NULL), VG_OK);
    is_part_of(&all, &f);
    vg_front_release(&part);
  }
  same_front(&all, &f);
  vg_front_release(&all);
  vg_front_release(&f);
}

/* --- what a front encloses ----------------------------------------------- */

static void volumes(void **state)
{
  const double centre[3] = {0.3, 0.2, -0.1};
  struct vg_mesh box = VG_MESH_INIT, body = VG_MESH_INIT;
  struct vg_front f = block(2, 3, 4, shape_all), g;

  (void)state;
  assert_true(fabs(vg_front_volume(&f) - 24) < 1e-12);
  vg_front_release(&f);
  shape_box(&box, 3, 100);
  f = front_of(&box);
  shape_sphere(&body, 24, centre, 1, 7);
  g = front_of(&body);
  /* a body's is negative, and a little less than the sphere's */
  assert_true(fabs(vg_front_volume(&g) / (-4 * M_PI / 3) - 1) < 0.01);
  assert_true(vg_front_volume(&g) > -4 * M_PI / 3);
  assert_true(fabs(vg_front_volume(&f) - 8e6) < 1e-5);
  vg_front_release(&f);
  vg_front_release(&g);
}

/* --- bytes --------------------------------------------------------------- */

static void equal_fronts(const struct vg_front *a, const struct vg_front *b,
                         int names)
{
  assert_int_equal(a->n_point, b->n_point);
  assert_int_equal(a->n_face, b->n_face);
  assert_memory_equal(a->x, b->x, a->n_point * sizeof *a->x);
  assert_memory_equal(a->face, b->face, a->n_face * sizeof *a->face);
  if (names) assert_memory_equal(a->name, b->name, a->n_point * 8);
}

static void is_refused(const void *bytes, size_t n, int names)
{
  const struct vg_front empty = VG_FRONT_INIT;
  unsigned char *copy = vg_alloc(n, 1);        /* reads beyond are seen */
  struct vg_reader r = { .n = n };
  struct vg_front f;

  assert_non_null(copy);
  if (n) memcpy(copy, bytes, n);
  r.data = copy;
  vg_front_get(&r, &f, names);
  assert_true(r.bad);
  assert_memory_equal(&f, &empty, sizeof f);
  free(copy);
}

static void fronts_as_bytes(void **state)
{
  const uint64_t huge[4] = {UINT64_MAX, (uint64_t)1 << 61, UINT32_MAX, 1 << 20};
  const uint32_t beyond[2] = {UINT32_MAX, 8};
  struct vg_front f = block(1, 1, 1, shape_all), back;

  (void)state;
  for (int names = 0; names < 2; names++) {
    struct vg_writer w = { .cap = 0 };
    struct vg_reader r = { .bad = 0 };
    unsigned char keep[12];

    vg_front_put(&w, &f, names);
    assert_false(w.refused);
    r.data = w.bytes.data;
    r.n = w.bytes.n;
    vg_front_get(&r, &back, names);
    assert_false(r.bad);
    assert_int_equal(r.at, r.n);
    equal_fronts(&f, &back, names);
    if (!names) assert_null(back.name);
    vg_front_release(&back);
    for (size_t n = 0; n < w.bytes.n; n++) is_refused(w.bytes.data, n, names);
    for (int k = 0; k < 8; k++) {
      unsigned char *at = w.bytes.data + k % 2 * 8;

      memcpy(keep, at, 8);
      memcpy(at, &huge[k / 2], 8);
      is_refused(w.bytes.data, w.bytes.n, names);
      memcpy(at, keep, 8);
    }
    for (size_t k = 0; k < 2 * f.n_face; k++) {
      unsigned char *at = w.bytes.data + 16 + f.n_point * sizeof *f.x +
                          k / 2 * sizeof *f.face + 4;

      memcpy(keep, at, 4);
      memcpy(at, &beyond[k % 2], 4);
      is_refused(w.bytes.data, w.bytes.n, names);
      memcpy(at, keep, 4);
    }
    free(w.bytes.data);
  }
  vg_front_release(&f);
}

/* Fronts one after the other; after damage nothing more is read. */
static void several_in_a_row(void **state)
{
  struct vg_front f[3] = { block(1, 1, 1, shape_all), VG_FRONT_INIT,
                           block(2, 2, 1, shape_all) }, back;
  struct vg_writer w = { .cap = 0 };
  struct vg_reader r = { .bad = 0 };

  (void)state;
  for (int k = 0; k < 3; k++) vg_front_put(&w, &f[k], 1);
  r.data = w.bytes.data;
  r.n = w.bytes.n;
  for (int k = 0; k < 3; k++) {
    vg_front_get(&r, &back, 1);
    assert_false(r.bad);
    equal_fronts(&f[k], &back, 1);
    vg_front_release(&back);
  }
  assert_int_equal(r.at, r.n);
  vg_front_get(&r, &back, 1);
  assert_true(r.bad);
  r.at = 0;                  /* bad stays bad */
  vg_front_get(&r, &back, 1);
  assert_true(r.bad);
  assert_null(back.x);
  for (int k = 0; k < 3; k++) vg_front_release(&f[k]);
  free(w.bytes.data);
}

static void changes_as_bytes(void **state)
{
  double x[2][3] = {{1, 2, 3}, {4, 5, 6}};
  uint32_t face[3][3] = {{0, 1, 2}, {9, 8, 7}, {3, 4, 10}}, gone[4] = {5, 1};
  struct vg_change c = { .blocked = 1, .serial = 77, .n_part = 9, .n_point = 2,
                         .n_face = 3, .n_gone = 4, .n_cell = 12, .n_hole = 3,
                         .volume = 0.125, .x = x, .face = face, .gone = gone };
  const struct vg_change empty = VG_CHANGE_INIT;
  struct vg_change back;
  struct vg_writer w = { .cap = 0 };

  (void)state;
  vg_change_put(&w, &c);
  assert_false(w.refused);
  for (size_t n = 0; n <= w.bytes.n; n++) {
    unsigned char *copy = vg_alloc(n, 1);
    struct vg_reader r = { .data = copy, .n = n };

    assert_non_null(copy);
    memcpy(copy, w.bytes.data, n);
    vg_change_get(&r, &back);
    free(copy);
    assert_int_equal(r.bad, n < w.bytes.n);
    if (r.bad) assert_memory_equal(&back, &empty, sizeof back);
  }
  assert_int_equal(back.blocked, 1);
  assert_int_equal(back.serial, 77);
  assert_int_equal(back.n_part, 9);
  assert_int_equal(back.n_cell, 12);
  assert_int_equal(back.n_hole, 3);
  assert_true(back.volume >= 0.125 && back.volume <= 0.125);
  assert_int_equal(back.n_point + back.n_face + back.n_gone, 9);
  assert_memory_equal(back.x, x, sizeof x);
  assert_memory_equal(back.face, face, sizeof face);
  assert_memory_equal(back.gone, gone, sizeof gone);
  vg_change_release(&back);
  assert_memory_equal(&back, &empty, sizeof back);
  free(w.bytes.data);
}

/* A blocked change has nothing in it. */
static void an_empty_change(void **state)
{
  struct vg_change c = { .blocked = 1 }, back;
  struct vg_writer w = { .cap = 0 };
  struct vg_reader r = { .bad = 0 };

  (void)state;
  vg_change_put(&w, &c);
  r.data = w.bytes.data;
  r.n = w.bytes.n;
  vg_change_get(&r, &back);
  assert_false(r.bad);
  assert_int_equal(r.at, r.n);
  assert_int_equal(back.blocked, 1);
  assert_int_equal(back.n_point + back.n_face + back.n_gone, 0);
  vg_change_release(&back);
  free(w.bytes.data);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(parts_are_joined),
    cmocka_unit_test(volumes),
    cmocka_unit_test(fronts_as_bytes),
    cmocka_unit_test(several_in_a_row),
    cmocka_unit_test(changes_as_bytes),
    cmocka_unit_test(an_empty_change),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
