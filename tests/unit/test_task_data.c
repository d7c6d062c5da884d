/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Fronts of tasks: components where voids touch, splitting and joining, checks,
 * volume, serialization. */
#include "io_support.h"

#include "base/bytes.h"
#include "fill_shapes.h"
#include "front_parts.h"
#include "partition/cut/task_data.h"
#include "tets_support.h"

/* A front of the triangles of m, which is released. Ids are not in the order of
 * the points. */
static struct vg_front front_of(struct vg_mesh *m)
{
  struct vg_front f = VG_FRONT_INIT;

  f.n_point = m->n_point;
  f.n_face = m->n_tri;
  f.x = vg_alloc(f.n_point, sizeof *f.x);
  f.id = vg_alloc(f.n_point, sizeof *f.id);
  f.face = vg_alloc(f.n_face, sizeof *f.face);
  assert_true(f.x && f.id && f.face);
  memcpy(f.x, m->point, f.n_point * sizeof *f.x);
  memcpy(f.face, m->tri, f.n_face * sizeof *f.face);
  for (size_t k = 0; k < f.n_point; k++)
    f.id[k] = VG_POINT_ID(7 + k % 3, 1000000 - k);
  vg_mesh_release(m);
  return f;
}

static struct vg_front block(int nx, int ny, int nz, int (*in)(const int at[3]))
{
  const int n[3] = { nx, ny, nz };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { nx, ny, nz };
  struct vg_mesh m = VG_MESH_INIT;

  shape_block(&m, n, lo, hi, in);
  return front_of(&m);
}

/* Rotated and stretched, so that nothing is along an axis. */
static void turn(struct vg_front *f)
{
  for (size_t k = 0; k < f->n_point; k++) {
    double *x = f->x[k];
    double y[3] = { 0.6 * x[0] - 0.8 * x[1], 0.8 * x[0] + 0.6 * x[1], x[2] };

    x[0] = 0.28 * y[0] - 0.96 * y[2] + 0.1 * y[1];
    x[1] = y[1];
    x[2] = 0.96 * y[0] + 0.28 * y[2];
  }
}

/* Rotate the corners of each face. */
static void turn_faces(struct vg_front *f)
{
  for (size_t i = 0; i < f->n_face; i++)
    for (size_t k = 0; k < i % 3; k++) {
      uint32_t first = f->face[i][0];

      f->face[i][0] = f->face[i][1];
      f->face[i][1] = f->face[i][2];
      f->face[i][2] = first;
    }
}

static uint32_t *parts_of(const struct vg_front *f, size_t *n)
{
  uint32_t *part = vg_alloc(f->n_face, sizeof *part), next = 0;

  assert_non_null(part);
  assert_int_equal(front_parts(f, part, n, NULL), VG_OK);
  for (size_t i = 0; i < f->n_face; i++) { /* by their first faces */
    assert_true(part[i] <= next);
    next += part[i] == next;
  }
  assert_int_equal(next, *n);
  return part;
}

/* Expected number of components, for either orientation of the front. */
static void parts_are(struct vg_front f, size_t want)
{
  for (int k = 0; k < 3; k++) {
    size_t n;
    uint32_t *part = parts_of(&f, &n);

    assert_int_equal(n, want);
    free(part);
    if (k == 0) turn(&f);
    else turn_faces(&f);
  }
  vg_front_release(&f);
}

/* --- components ---------------------------------------------------------- */

static int two_apart(const int at[3])
{
  return at[0] != 1;
}

static int two_at_an_edge(const int at[3])
{
  return at[0] == at[1];
}

static int two_at_a_point(const int at[3])
{
  return at[0] == at[1] && at[1] == at[2];
}

static int every_other(const int at[3])
{
  return (at[0] + at[1] + at[2]) % 2 == 0;
}

static int is_body(const int at[3])
{
  return at[2] == 1 && (at[0] == 1 || at[0] == 2) && at[0] == at[1];
}

static int around_two_bodies(const int at[3])
{
  return !is_body(at);
}

static int a_passage_wide(const int at[3])
{
  return !(at[0] == 1 && at[1] == 0);
}

static void connected_components_are_counted(void **state)
{
  (void)state;
  parts_are(block(2, 3, 1, shape_all), 1);
  parts_are(block(3, 1, 1, two_apart), 2);
  parts_are(block(3, 2, 1, a_passage_wide), 1);
}

/* Edges with four faces: voids that touch there are separate components. */
static void parts_that_touch(void **state)
{
  (void)state;
  parts_are(block(2, 2, 1, two_at_an_edge), 2);
  parts_are(block(2, 2, 2, two_at_a_point), 2);
  parts_are(block(3, 3, 1, every_other), 5);
  parts_are(block(4, 4, 4, every_other), 32);
  parts_are(block(5, 4, 3, every_other), 30);
}

/* Two bodies that touch in an edge are one shell of the void around them. */
static void bodies_that_touch(void **state)
{
  struct vg_front f = block(4, 4, 3, around_two_bodies);
  size_t n, size[2] = { 0, 0 };
  uint32_t *part = parts_of(&f, &n);

  (void)state;
  assert_int_equal(n, 2);
  for (size_t i = 0; i < f.n_face; i++) size[part[i]]++;
  assert_int_equal(size[0] < size[1] ? size[0] : size[1], 24);
  free(part);
  parts_are(f, 2);
}

static void a_sphere_in_a_box(void **state)
{
  const double centre[3] = { 0.1, 0, 0 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 4, 3);
  shape_sphere(&m, 6, centre, 1, 7);
  parts_are(front_of(&m), 2);
}

static void an_empty_front_has_no_components(void **state)
{
  struct vg_front f = VG_FRONT_INIT;
  size_t n = 5;

  (void)state;
  assert_int_equal(front_parts(&f, NULL, &n, NULL), VG_OK);
  assert_int_equal(n, 0);
}

/* --- splitting and joining ----------------------------------------------- */

static int by_name(const void *a, const void *b)
{
  return memcmp(a, b, 3 * sizeof(uint64_t));
}

/* Faces by the ids of their points, the least first, sorted. */
static uint64_t (*named(const struct vg_front *f))[3]
{
  uint64_t(*t)[3] = vg_alloc(f->n_face, sizeof *t);

  assert_non_null(t);
  for (size_t i = 0; i < f->n_face; i++) {
    int low = 0;

    for (int k = 1; k < 3; k++)
      if (f->id[f->face[i][k]] < f->id[f->face[i][low]]) low = k;
    for (int k = 0; k < 3; k++) t[i][k] = f->id[f->face[i][(low + k) % 3]];
  }
  qsort(t, f->n_face, sizeof *t, by_name);
  return t;
}

static void same_front(const struct vg_front *a, const struct vg_front *b)
{
  uint64_t(*s)[3] = named(a), (*t)[3] = named(b);

  assert_int_equal(a->n_face, b->n_face);
  assert_int_equal(a->n_point, b->n_point);
  assert_memory_equal(s, t, a->n_face * sizeof *s);
  free(s);
  free(t);
}

/* Every point is used, and has the position of the point with its id. */
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
    while (w < whole->n_point && whole->id[w] != f->id[k]) w++;
    assert_true(w < whole->n_point);
    assert_memory_equal(f->x[k], whole->x[w], sizeof *f->x);
  }
  free(used);
}

static int is_closed(const struct vg_front *f)
{
  return !vg_front_open_edges(f);
}

/* Split into components and joined again. */
static void split_and_join(struct vg_front f)
{
  struct vg_front all = VG_FRONT_INIT, *out;
  size_t n, n_face = 0;
  uint32_t *part = parts_of(&f, &n);
  double volume = 0;

  out = vg_calloc(n, sizeof *out);
  assert_non_null(out);
  assert_int_equal(front_split(&f, part, n, out, NULL), VG_OK);
  for (size_t k = 0; k < n; k++) {
    is_part_of(&out[k], &f);
    assert_true(is_closed(&out[k]));
    n_face += out[k].n_face;
    volume += vg_front_volume(&out[k]);
    assert_int_equal(vg_front_append(&all, &out[k], NULL), VG_OK);
    is_part_of(&all, &f);
    vg_front_release(&out[k]);
  }
  assert_int_equal(n_face, f.n_face);
  assert_true(fabs(volume - vg_front_volume(&f)) < 1e-12 * fabs(volume));
  same_front(&all, &f);
  vg_front_release(&all);
  vg_front_release(&f);
  free(out);
  free(part);
}

static void parts_are_split_and_joined(void **state)
{
  const double centre[3] = { 0.1, 0, 0 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 4, 3);
  shape_sphere(&m, 6, centre, 1, 7);
  split_and_join(front_of(&m));
  split_and_join(block(2, 2, 1, two_at_an_edge));
  split_and_join(block(4, 4, 4, every_other)); /* points of 8 components */
  split_and_join(block(4, 4, 3, around_two_bodies));
}

/* Parts may have no faces. */
static void an_empty_part(void **state)
{
  struct vg_front f = block(1, 1, 1, shape_all), out[3];
  uint32_t *part = vg_calloc(f.n_face, sizeof *part);

  (void)state;
  assert_non_null(part);
  for (size_t i = 0; i < f.n_face; i++) part[i] = 2 * (i > 5);
  assert_int_equal(front_split(&f, part, 3, out, NULL), VG_OK);
  assert_int_equal(out[0].n_face, 6);
  assert_int_equal(out[1].n_face + out[1].n_point, 0);
  assert_int_equal(out[2].n_face, 6);
  for (int k = 1; k < 3; k++)
    assert_int_equal(vg_front_append(&out[0], &out[k], NULL), VG_OK);
  same_front(&out[0], &f);
  for (int k = 0; k < 3; k++) vg_front_release(&out[k]);
  vg_front_release(&f);
  free(part);
}

/* --- checks -------------------------------------------------------------- */

static void check_says(const struct vg_front *f, const char *words)
{
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_front_check(f, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, words));
}

static void a_check_names_what_is_wrong(void **state)
{
  const struct vg_front empty = VG_FRONT_INIT;
  struct vg_front f = block(2, 3, 4, shape_all);
  size_t n = f.n_face;
  uint32_t keep = f.face[4][1];

  (void)state;
  assert_int_equal(vg_front_check(&empty, NULL), VG_OK);
  assert_int_equal(vg_front_check(&f, NULL), VG_OK);
  f.face[4][1] = (uint32_t)f.n_point;
  check_says(&f, "triangle 5 ");
  f.face[4][1] = UINT32_MAX;
  check_says(&f, "triangle 5 ");
  f.face[4][1] = keep;
  for (size_t i = 0; i < n; i++) /* point 7 is point 8 */
    for (int k = 0; k < 3; k++) f.face[i][k] += f.face[i][k] == 6;
  check_says(&f, "point 7 ");
  f.n_face = 0;
  check_says(&f, "point 1 ");
  vg_front_release(&f);
}

static void open_edges_are_counted(void **state)
{
  struct vg_front f = block(2, 3, 4, shape_all);
  struct vg_front touching = block(2, 2, 1, two_at_an_edge);
  const struct vg_front empty = VG_FRONT_INIT;
  uint32_t keep = f.face[9][0];

  (void)state;
  assert_int_equal(vg_front_open_edges(&empty), 0);
  assert_int_equal(vg_front_open_edges(&f), 0);
  assert_int_equal(vg_front_open_edges(&touching), 0);
  f.n_face--;
  assert_int_equal(vg_front_open_edges(&f), 3);
  f.n_face++;
  f.face[9][0] = f.face[9][1]; /* reversed */
  f.face[9][1] = keep;
  assert_int_equal(vg_front_open_edges(&f), 3);
  vg_front_release(&f);
  vg_front_release(&touching);
}

/* --- enclosed volume ----------------------------------------------------- */

static void volumes(void **state)
{
  const double centre[3] = { 0.3, 0.2, -0.1 };
  struct vg_mesh box = VG_MESH_INIT, body = VG_MESH_INIT;
  struct vg_front f = block(2, 3, 4, shape_all), g;

  (void)state;
  assert_true(fabs(vg_front_volume(&f) - 24) < 1e-12);
  vg_front_release(&f);
  shape_box(&box, 3, 100);
  f = front_of(&box);
  shape_sphere(&body, 24, centre, 1, 7);
  g = front_of(&body);
  /* a body's is negative, and slightly smaller than the sphere's */
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
  if (names) assert_memory_equal(a->id, b->id, a->n_point * 8);
}

static void is_refused(const void *bytes, size_t n, int names)
{
  const struct vg_front empty = VG_FRONT_INIT;
  unsigned char *copy = vg_alloc(
    n, 1); /* so that reads beyond the end are detected */
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
  const uint64_t huge[4] = { UINT64_MAX, (uint64_t)1 << 61, UINT32_MAX,
                             1 << 20 };
  const uint32_t beyond[2] = { UINT32_MAX, 8 };
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
    if (!names) assert_null(back.id);
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

/* Several fronts in a row; after damage nothing more is read. */
static void several_in_a_row(void **state)
{
  struct vg_front f[3] = { block(1, 1, 1, shape_all), VG_FRONT_INIT,
                           block(2, 2, 1, two_at_an_edge) },
                  back;
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
  r.at = 0; /* bad stays bad */
  vg_front_get(&r, &back, 1);
  assert_true(r.bad);
  assert_null(back.x);
  for (int k = 0; k < 3; k++) vg_front_release(&f[k]);
  free(w.bytes.data);
}

static void changes_as_bytes(void **state)
{
  double x[2][3] = { { 1, 2, 3 }, { 4, 5, 6 } };
  uint32_t face[3][3] = { { 0, 1, 2 }, { 9, 8, 7 }, { 3, 4, 10 } };
  uint32_t consumed[4] = { 1, 5, 6, 8 };
  struct vg_change c = { .blocked = 1,
                         .serial = 77,
                         .n_part = 9,
                         .made = { .n_point = 2,
                                   .n_face = 3,
                                   .n_consumed = 4,
                                   .n_cell = 12,
                                   .n_hole = 3,
                                   .volume = 0.125,
                                   .x = x,
                                   .face = face,
                                   .consumed = consumed } };
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
  assert_int_equal(back.made.n_cell, 12);
  assert_null(back.made.cell);
  assert_int_equal(back.made.n_hole, 3);
  assert_true(back.made.volume >= 0.125 && back.made.volume <= 0.125);
  assert_int_equal(back.made.n_point, 2);
  assert_int_equal(back.made.n_face, 3);
  assert_int_equal(back.made.n_consumed, 4);
  assert_memory_equal(back.made.x, x, sizeof x);
  assert_memory_equal(back.made.face, face, sizeof face);
  assert_memory_equal(back.made.consumed, consumed, sizeof consumed);
  vg_change_release(&back);
  assert_memory_equal(&back, &empty, sizeof back);
  free(w.bytes.data);
}

/* A blocked change is empty. */
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
  assert_int_equal(back.made.n_point + back.made.n_face + back.made.n_consumed,
                   0);
  vg_change_release(&back);
  free(w.bytes.data);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(connected_components_are_counted),
    cmocka_unit_test(parts_that_touch),
    cmocka_unit_test(bodies_that_touch),
    cmocka_unit_test(a_sphere_in_a_box),
    cmocka_unit_test(an_empty_front_has_no_components),
    cmocka_unit_test(parts_are_split_and_joined),
    cmocka_unit_test(an_empty_part),
    cmocka_unit_test(a_check_names_what_is_wrong),
    cmocka_unit_test(open_edges_are_counted),
    cmocka_unit_test(volumes),
    cmocka_unit_test(fronts_as_bytes),
    cmocka_unit_test(several_in_a_row),
    cmocka_unit_test(changes_as_bytes),
    cmocka_unit_test(an_empty_change),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
