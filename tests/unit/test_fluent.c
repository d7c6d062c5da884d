/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Meshes for Fluent, read back by the published grammar: every side of every
 * cell occurs once, with the required orientation. */
#define _GNU_SOURCE
#include "mixed_support.h"

#include "io/mesh/fluent.h"

struct reader {
  FILE *file;
  struct mixed_side *side;
  size_t n_side;
};

/* The text that must come next in the file, ignoring blanks and line ends. */
static void expect(struct reader *r, const char *text)
{
  for (; *text; text++) {
    int c;

    do c = fgetc(r->file);
    while (c == ' ' || c == '\n');
    if (c != *text) fail_msg("'%c' where '%s' was expected", c, text);
  }
}

static uint32_t hex(struct reader *r)
{
  uint32_t v;

  assert_int_equal(fscanf(r->file, "%x", &v), 1);
  return v;
}

static void read_points(struct reader *r, const struct vg_mesh *m)
{
  expect(r, "(10(0");
  assert_int_equal(hex(r), 1);
  assert_int_equal(hex(r), m->n_point);
  expect(r, "03))(10(1");
  assert_int_equal(hex(r), 1);
  assert_int_equal(hex(r), m->n_point);
  expect(r, "13)(");
  for (size_t i = 0; i < m->n_point; i++) {
    double x[3];

    assert_int_equal(fscanf(r->file, "%lf %lf %lf", x, x + 1, x + 2), 3);
    assert_memory_equal(x, m->point[i], sizeof x);
  }
  expect(r, "))");
}

static void read_cells(struct reader *r, const struct vg_mesh *m)
{
  static const uint32_t code[4] = { 2, 5, 6, 4 };
  size_t n = mixed_n_cell(m);

  expect(r, "(12(0");
  assert_int_equal(hex(r), 1);
  assert_int_equal(hex(r), n);
  expect(r, "00))(12(2");
  assert_int_equal(hex(r), 1);
  assert_int_equal(hex(r), n);
  expect(r, "10)(");
  for (size_t i = 0; i < n; i++) {
    int kind;

    mixed_cell(m, i, &kind);
    assert_int_equal(hex(r), code[kind]);
  }
  expect(r, "))");
}

/* A side of a cell (from 1), with its nodes outward. key[3] holds the cell,
 * after the nodes of a triangle; a fourth node is in node[]. */
static void add_side(struct reader *r, uint32_t cell, int n,
                     const uint32_t *node, int is_inward)
{
  struct mixed_side *s = &r->side[r->n_side++];

  for (int k = 0; k < n; k++) s->node[k] = node[is_inward ? n - 1 - k : k] - 1;
  if (n == 3) s->node[3] = UINT32_MAX;
  memcpy(s->key, s->node, sizeof s->key);
  mixed_sort(s->key, 4);
  assert_true(cell > 0);
}

/* Check that these nodes, in outward order, are a side of the cell. */
static void check_side(const struct vg_mesh *m, uint32_t cell, int n,
                       const uint32_t *node)
{
  int kind;
  const uint32_t *c = mixed_cell(m, cell - 1, &kind);

  for (int f = 0; f < mixed_n_face[kind]; f++) {
    const int *q = mixed_face[kind][f];
    int width = q[2] == q[3] ? 3 : 4, same = 0;

    for (int turn = 0; width == n && turn < n; turn++) {
      same = 1;
      for (int k = 0; k < n; k++) same &= c[q[k]] == node[(k + turn) % n];
      if (same) return;
    }
  }
  fail_msg("no side of cell %u", cell);
}

static void take_face(struct reader *r, const struct vg_mesh *m, int n,
                      const uint32_t *node, uint32_t first, uint32_t second)
{
  uint32_t turned[4];

  for (int k = 0; k < n; k++) turned[k] = node[n - 1 - k] - 1;
  check_side(m, first, n, turned);
  add_side(r, first, n, node, 1);
  if (!second) return;
  for (int k = 0; k < n; k++) turned[k] = node[k] - 1;
  check_side(m, second, n, turned);
  add_side(r, second, n, node, 0);
}

/* Returns the number of faces. */
static size_t read_zone(struct reader *r, const struct vg_mesh *m,
                        uint32_t zone, size_t before, uint32_t type)
{
  uint32_t first, last, kind;

  expect(r, "(13(");
  assert_int_equal(hex(r), zone);
  first = hex(r);
  last = hex(r);
  assert_int_equal(first, before + 1);
  assert_int_equal(hex(r), type);
  kind = hex(r);
  expect(r, ")(");
  for (uint32_t i = first; i <= last; i++) {
    uint32_t n = kind ? kind : hex(r), node[4], cell[2];

    assert_true(n == 3 || n == 4);
    for (uint32_t k = 0; k < n; k++) node[k] = hex(r);
    for (int k = 0; k < 2; k++) cell[k] = hex(r);
    assert_int_equal(cell[1] > 0, type == 2);
    take_face(r, m, (int)n, node, cell[0], cell[1]);
  }
  expect(r, "))");
  return last - first + 1;
}

static void compare_sides(struct reader *r, const struct vg_mesh *m)
{
  struct mixed_side *all;
  size_t n = mixed_sides(m, &all);

  qsort(r->side, r->n_side, sizeof *r->side, mixed_by_key);
  assert_int_equal(n, r->n_side);
  for (size_t i = 0; i < n; i++)
    assert_memory_equal(all[i].key, r->side[i].key, sizeof all[i].key);
  free(all);
}

static void all_kinds_of_cells(void **state)
{
  static const int32_t bc[3] = { 4, 1, 3 };
  static const uint32_t type[3] = { 3, 7, 9 };
  const char *path = io_temp("all_kinds.fluent.msh");
  struct reader r = { NULL, NULL, 0 };
  struct vg_mesh m = VG_MESH_INIT;
  size_t n, total;

  (void)state;
  mixed_make(&m, 5, 4);
  for (int p = 0; p < 3; p++) m.patch[p].bc = bc[p];
  assert_int_equal(vg_fluent_write(path, &m, NULL), VG_OK);
  r.file = fopen(path, "r");
  r.side = malloc(6 * mixed_n_cell(&m) * sizeof *r.side);
  expect(&r, "(0\"Vanguard\")(23)");
  read_points(&r, &m);
  read_cells(&r, &m);
  expect(&r, "(13(0");
  assert_int_equal(hex(&r), 1);
  total = hex(&r);
  expect(&r, "00))");
  n = read_zone(&r, &m, 3, 0, 2);
  for (uint32_t p = 0; p < 3; p++) n += read_zone(&r, &m, 4 + p, n, type[p]);
  assert_int_equal(n, total);
  compare_sides(&r, &m);
  expect(&r, "(45(2fluidfluid)())(45(3interiorinterior)())");
  expect(&r, "(45(4walllow_end)())(45(5symmetrytop)())");
  expect(&r, "(45(6pressure-far-fieldpatch_13)())");
  fclose(r.file);
  free(r.side);
  unlink(path);
  vg_mesh_release(&m);
}

/* Zones of cells and inner faces have names that no patch has. */
static void zones_have_unique_names(void **state)
{
  const char *path = io_temp("zones.fluent.msh");
  struct vg_mesh m = VG_MESH_INIT;
  unsigned char *data;
  size_t n;

  (void)state;
  mixed_make(&m, 2, 2);
  strcpy(m.patch[0].name, "fluid");
  strcpy(m.patch[1].name, "interior");
  assert_int_equal(vg_fluent_write(path, &m, NULL), VG_OK);
  data = io_slurp(path, &n);
  assert_non_null(memmem(data, n, "(2 fluid fluid_1)", 17));
  assert_non_null(memmem(data, n, "(3 interior interior_1)", 23));
  assert_non_null(memmem(data, n, " fluid)()", 9));
  assert_non_null(memmem(data, n, " interior)()", 12));
  free(data);
  unlink(path);
  vg_mesh_release(&m);
}

static void refusals(void **state)
{
  const char *path = io_temp("refused.fluent.msh");
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_make_t1(&m, 0);
  assert_int_equal(vg_fluent_write(path, &m, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "no cells"));
  vg_mesh_release(&m);
  io_make_t1(&m, 1);
  m.n_tri--;
  assert_int_equal(vg_fluent_write(path, &m, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "closed"));
  m.n_tri++;
  assert_int_equal(access(path, F_OK), -1);
  assert_int_equal(vg_fluent_write("/nowhere/at/all.fluent.msh", &m, &err),
                   VG_ERR_IO);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(all_kinds_of_cells),
    cmocka_unit_test(zones_have_unique_names),
    cmocka_unit_test(refusals),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
