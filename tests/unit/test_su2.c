/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Meshes for SU2, read back by the published grammar and by VTK's kinds. */
#include "mixed_support.h"

#include "io/mesh/su2.h"

/* --- a reader of the written files, independent of the writer --- */

struct reader {
  FILE *file;
  char word[200];
};

static void expect(struct reader *r, const char *key)
{
  if (fscanf(r->file, "%199s", r->word) != 1 || strcmp(r->word, key) != 0)
    fail_msg("%s, not %s", r->word, key);
}

static size_t number(struct reader *r)
{
  size_t n;

  assert_int_equal(fscanf(r->file, "%zu", &n), 1);
  return n;
}

/* Faces by VTK's kinds of cells; a triangle repeats its last node. */
static const struct vtk_kind {
  size_t code;
  int n_node, n_face, face[6][4];
} vtk_kinds[] = {
  { 10,
    4,
    4,
    { { 0, 1, 3, 3 }, { 1, 2, 3, 3 }, { 2, 0, 3, 3 }, { 0, 2, 1, 1 } } },
  { 14,
    5,
    5,
    { { 0, 3, 2, 1 },
      { 0, 1, 4, 4 },
      { 1, 2, 4, 4 },
      { 2, 3, 4, 4 },
      { 3, 0, 4, 4 } } },
  { 13,
    6,
    5,
    { { 0, 1, 2, 2 },
      { 3, 5, 4, 4 },
      { 0, 3, 4, 1 },
      { 1, 4, 5, 2 },
      { 2, 5, 3, 0 } } },
  { 12,
    8,
    6,
    { { 0, 4, 7, 3 },
      { 1, 2, 6, 5 },
      { 0, 1, 5, 4 },
      { 3, 7, 6, 2 },
      { 0, 3, 2, 1 },
      { 4, 5, 6, 7 } } },
};

static void take_side(const uint32_t *node, const int *face,
                      struct mixed_side *s)
{
  for (int k = 0; k < 4; k++) s->node[k] = s->key[k] = node[face[k]];
  if (face[2] == face[3]) s->node[3] = s->key[3] = UINT32_MAX;
  mixed_sort(s->key, 4);
}

/* Sides of all cells, outward in VTK's convention. */
static size_t read_cells(struct reader *r, size_t n_point,
                         struct mixed_side **out)
{
  size_t n_cell, n = 0;
  struct mixed_side *s;

  expect(r, "NDIME=");
  assert_int_equal(number(r), 3);
  expect(r, "NELEM=");
  n_cell = number(r);
  s = malloc(6 * n_cell * sizeof *s);
  for (size_t i = 0; i < n_cell; i++) {
    const struct vtk_kind *k = vtk_kinds;
    size_t code = number(r);
    uint32_t node[8];

    while (k->code != code) assert_true(++k < vtk_kinds + 4);
    for (int j = 0; j < k->n_node; j++) {
      node[j] = (uint32_t)number(r);
      assert_true(node[j] < n_point);
    }
    assert_int_equal(number(r), i);
    for (int f = 0; f < k->n_face; f++) take_side(node, k->face[f], &s[n++]);
  }
  *out = s;
  return n;
}

static void read_points(struct reader *r, const struct vg_mesh *m)
{
  expect(r, "NPOIN=");
  assert_int_equal(number(r), m->n_point);
  for (size_t i = 0; i < m->n_point; i++) {
    double x[3];

    assert_int_equal(fscanf(r->file, "%lf %lf %lf", x, x + 1, x + 2), 3);
    assert_memory_equal(x, m->point[i], sizeof x);
    assert_int_equal(number(r), i);
  }
}

/* Every side has one other: of a cell, or a face of a marker. */
static void check_sides(struct mixed_side *s, size_t n)
{
  qsort(s, n, sizeof *s, mixed_by_key);
  assert_int_equal(n % 2, 0);
  for (size_t i = 0; i < n; i += 2) {
    assert_int_equal(mixed_by_key(s + i, s + i + 1), 0);
    assert_true(i + 2 == n || mixed_by_key(s + i + 1, s + i + 2) != 0);
  }
}

static size_t read_markers(struct reader *r, const char *const *name,
                           struct mixed_side *s, size_t n)
{
  size_t n_mark;

  expect(r, "NMARK=");
  n_mark = number(r);
  for (size_t i = 0; i < n_mark; i++) {
    size_t n_face;

    expect(r, "MARKER_TAG=");
    expect(r, name[i]);
    expect(r, "MARKER_ELEMS=");
    n_face = number(r);
    assert_true(n_face > 0);
    for (size_t f = 0; f < n_face; f++) {
      static const int corner[4] = { 0, 1, 2, 3 }, three[4] = { 0, 1, 2, 2 };
      size_t code = number(r);
      uint32_t node[4];

      assert_true(code == 5 || code == 9);
      for (int k = 0; k < (code == 5 ? 3 : 4); k++)
        node[k] = (uint32_t)number(r);
      take_side(node, code == 5 ? three : corner, &s[n++]);
    }
  }
  assert_int_equal(fscanf(r->file, "%199s", r->word), EOF);
  return n;
}

static void all_kinds_of_cells(void **state)
{
  static const char *const given[3] = { "left wing", "left wing", "" };
  static const char *const name[3] = { "left_wing", "left_wing_12",
                                       "patch_13" };
  const char *path = io_temp("all_kinds.su2");
  struct vg_mesh m = VG_MESH_INIT;
  struct mixed_side *s;
  struct reader r = { NULL, "" };
  size_t n;

  (void)state;
  mixed_make(&m, 5, 4);
  for (int k = 0; k < 3; k++)
    snprintf(m.patch[k].name, VG_NAME_MAX, "%s", given[k]);
  assert_int_equal(vg_su2_write(path, &m, NULL), VG_OK);
  r.file = fopen(path, "r");
  assert_non_null(r.file);
  n = read_cells(&r, m.n_point, &s);
  s = realloc(s, (n + m.n_tri + m.n_quad) * sizeof *s);
  read_points(&r, &m);
  n = read_markers(&r, name, s, n);
  check_sides(s, n);
  free(s);
  fclose(r.file);
  unlink(path);
  vg_mesh_release(&m);
}

static void refusals(void **state)
{
  const char *path = io_temp("refused.su2");
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_make_t1(&m, 0);
  assert_int_equal(vg_su2_write(path, &m, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "no cells"));
  assert_int_equal(access(path, F_OK), -1);
  vg_mesh_release(&m);
  mixed_make(&m, 2, 2);
  assert_int_equal(vg_su2_write("/nowhere/at/all.su2", &m, &err), VG_ERR_IO);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(all_kinds_of_cells),
    cmocka_unit_test(refusals),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
