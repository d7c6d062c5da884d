/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Solver partitions: no stack is cut, partitions are balanced, the report is
 * correct; and the files of partitions. */
#include "io_support.h"

#include "base/bytes.h"
#include "fill_support.h"
#include "io/mesh/foam.h"
#include "run/commit/tree.h"
#include "io/mesh/format.h"
#include "io/stream/metis_part.h"
#include "io/mesh/ugrid.h"
#include "io/vgrid/vgrid.h"
#include "join_support.h"
#include "partition/solver/solver.h"
#include "parts_support.h"
#include "slices_support.h"

enum { SIDE = 10, N_HEX = SIDE * SIDE * SIDE };

struct made {
  struct model model;
  struct vg_mesh mesh;
  struct vg_join_info info;
  size_t n_cell;
  uint32_t *part;
};

static void make(struct made *m, enum vg_layer_cells cells, double growth)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report report;
  struct vg_sizing *sizing;
  uint64_t seed = 5;

  memset(m, 0, sizeof *m);
  model_sphere(&m->model, 6, 6, &seed);
  if (cells == VG_LAYER_HEX) { /* Thick enough for pairs of wall triangles. */
    m->model.layers.columns.law[0].delta1 = 0.03;
    for (size_t i = 0; i < m->model.layers.columns.n_column; i++)
      m->model.layers.columns.column[i].n += 2;
    vg_front_release(&m->model.layers.front);
    model_front(&m->model);
  }
  sizing = shape_sizing(FRONT_MESH(&m->model.layers.front, &m->model.surface),
                        growth, 0);
  assert_int_equal(fill_mesh(FRONT_MESH(&m->model.layers.front,
                                        &m->model.surface),
                             sizing, &options, &m->model.field, &report, NULL),
                   VG_OK);
  vg_sizing_free(sizing);
  assert_int_equal(vg_layers_join(&m->model.surface, &m->model.layers,
                                  &m->model.field, cells, 1, &m->mesh, &m->info,
                                  NULL),
                   VG_OK);
  m->n_cell = m->mesh.n_tet + m->mesh.n_pyr + m->mesh.n_pri + m->mesh.n_hex;
  m->part = vg_alloc(m->n_cell, sizeof *m->part);
}

static void release(struct made *m)
{
  model_release(&m->model);
  vg_mesh_release(&m->mesh);
  free(m->part);
}

/* Cells of each kind that stand on a face of these columns, as defined by
 * columns.h: no two columns share a root here. */
static void stands_on(const struct made *m, size_t face, int mixed, size_t n[3])
{
  const struct vg_columns *c = &m->model.layers.columns;
  size_t low = SIZE_MAX, high = 0, sum = 0;

  for (int k = 0; k < 3; k++) {
    size_t here = c->column[c->face[face][k]].n;

    sum += here;
    low = here < low ? here : low;
    high = here > high ? here : high;
  }
  n[0] = mixed ? high - (sum - low - high) : sum;
  n[1] = mixed ? sum - 2 * low - high : 0;
  n[2] = mixed ? low : 0;
}

/* Stacks that are in several partitions, determined from the columns. */
static size_t stacks_cut(const struct made *m, int mixed, uint64_t *n_stack,
                         uint64_t *n_cell)
{
  const size_t first[3] = { 0, m->mesh.n_tet, m->mesh.n_tet + m->mesh.n_pyr };
  size_t at[3] = { 0, 0, 0 }, cut = 0;

  *n_stack = *n_cell = 0;
  for (size_t f = 0; f < m->model.layers.columns.n_face; f++) {
    size_t n[3], all = 0;
    uint32_t part = UINT32_MAX;
    int bad = 0;

    stands_on(m, f, mixed, n);
    for (int k = 0; k < 3; k++)
      for (size_t i = 0; i < n[k]; i++, at[k]++, all++) {
        uint32_t here = m->part[first[k] + at[k]];

        bad |= part != UINT32_MAX && part != here;
        part = here;
      }
    cut += (size_t)bad;
    if (all > 1) {
      *n_stack += 1;
      *n_cell += all;
    }
  }
  assert_int_equal(at[0], m->info.n_layer_tet);
  assert_int_equal(at[1], m->info.n_layer_pyr);
  assert_int_equal(at[2], m->info.n_layer_pri);
  return cut;
}

static int by_nodes(const void *a, const void *b)
{
  return memcmp(a, b, 4 * sizeof(uint32_t));
}

/* Faces between partitions, found by sorting all faces. */
static uint64_t count_cut(const struct vg_mesh *m, const uint32_t *part)
{
  static const int side[4][3] = {
    { 1, 2, 3 }, { 0, 2, 3 }, { 0, 1, 3 }, { 0, 1, 2 }
  };
  uint32_t(*f)[5] = vg_alloc(4 * m->n_tet, sizeof *f);
  uint64_t n = 0;

  for (size_t i = 0; i < 4 * m->n_tet; i++) {
    for (int k = 0; k < 3; k++) f[i][k] = m->tet[i / 4][side[i % 4][k]];
    for (int k = 0; k < 3; k++)
      for (int j = 0; j < 2; j++)
        if (f[i][j] > f[i][j + 1]) {
          uint32_t t = f[i][j];

          f[i][j] = f[i][j + 1];
          f[i][j + 1] = t;
        }
    f[i][3] = 0;
    f[i][4] = part[i / 4];
  }
  qsort(f, 4 * m->n_tet, sizeof *f, by_nodes);
  for (size_t i = 0; i + 1 < 4 * m->n_tet; i++)
    n += !by_nodes(f[i], f[i + 1]) && f[i][4] != f[i + 1][4];
  free(f);
  return n;
}

static struct vg_solver_options parts(uint64_t n)
{
  struct vg_solver_options o = VG_SOLVER_OPTIONS_INIT;

  o.n_part = n;
  return o;
}

static void tell_apart(struct made *m, const struct vg_solver_options *o,
                       struct vg_solver_report *r)
{
  const struct vg_solver_layers l = { 1, m->info.n_layer_tet, NULL };
  struct vg_error err = VG_ERROR_INIT;

  if (vg_solver_part(&m->mesh, &l, o, "sphere", m->part, r, &err) != VG_OK)
    fail_msg("%s", err.text);
}

/* METIS is allowed 3 % over the mean; a stack of 18 cells in partitions of some
 * hundred can prevent that. */
static void check_balance(const struct made *m, uint64_t n,
                          const struct vg_solver_report *r)
{
  uint64_t *cells = vg_calloc(n, sizeof *cells), most = 0, least = UINT64_MAX;

  for (size_t i = 0; i < m->n_cell; i++) {
    assert_true(m->part[i] < n);
    cells[m->part[i]]++;
  }
  for (uint64_t p = 0; p < n; p++) {
    most = cells[p] > most ? cells[p] : most;
    least = cells[p] < least ? cells[p] : least;
  }
  assert_int_equal(r->most_cells, most);
  assert_int_equal(r->least_cells, least);
  assert_int_equal(r->n_cell, m->n_cell);
  assert_true(least > 0);
  assert_true(r->balance >= 1 && r->balance < 1.1);
  free(cells);
}

static void no_stack_is_cut(void **state)
{
  (void)state;
  needs_metis();
  for (int mixed = 0; mixed < 2; mixed++) {
    struct vg_solver_options o = parts(7);
    struct vg_solver_report r;
    struct made m;
    uint64_t n_stack, n_cell;

    make(&m, mixed ? VG_LAYER_MIXED : VG_LAYER_TETS, 1.2);
    tell_apart(&m, &o, &r);
    assert_int_equal(stacks_cut(&m, mixed, &n_stack, &n_cell), 0);
    assert_int_equal(r.n_stack, n_stack);
    assert_int_equal(r.n_stack_cell, n_cell);
    assert_false(r.has_loose);
    check_balance(&m, 7, &r);
    if (!mixed) assert_int_equal(r.n_cut, count_cut(&m.mesh, m.part));
    assert_true(r.most_near <= 6 && r.mean_near <= (double)r.most_near);
    release(&m);
  }
}

/* Whether two cells have n common nodes. */
static int touch(const uint32_t *a, size_t n_a, const uint32_t *b, size_t n_b,
                 size_t n)
{
  size_t common = 0;

  for (size_t i = 0; i < n_a * n_b; i++) common += a[i / n_b] == b[i % n_b];
  return common == n;
}

/* Hexahedra that share their lower and upper face, and the pyramids and
 * tetrahedra around the point in the middle of the last level. */
static void no_stack_of_hexahedra_is_cut(void **state)
{
  struct vg_solver_options o = parts(9);
  struct vg_solver_report r;
  struct made m;
  size_t pyr, hex, n_met = 0, n_level = 0;

  (void)state;
  needs_metis();
  make(&m, VG_LAYER_HEX, 1.2);
  pyr = m.mesh.n_tet;
  hex = pyr + m.mesh.n_pyr + m.mesh.n_pri;
  tell_apart(&m, &o, &r);
  assert_false(r.has_loose);
  for (size_t i = 0; i < m.mesh.n_hex; i++)
    for (size_t k = 0; k < m.mesh.n_hex; k++) {
      if (!touch(m.mesh.hex[i] + 4, 4, m.mesh.hex[k], 4, 4)) continue;
      assert_int_equal(m.part[hex + i], m.part[hex + k]);
      n_met++;
    }
  for (size_t i = 0; i < m.mesh.n_hex; i++)
    for (size_t k = 0; k < m.mesh.n_pyr; k++) {
      const uint32_t middle = m.mesh.pyr[k][2];

      if (!touch(m.mesh.hex[i] + 4, 4, m.mesh.pyr[k], 5, 4)) continue;
      for (size_t j = 0; j < m.mesh.n_pyr; j++)
        if (m.mesh.pyr[j][2] == middle)
          assert_int_equal(m.part[hex + i], m.part[pyr + j]);
      for (size_t j = 0; j < m.info.n_layer_tet; j++)
        if (touch(&middle, 1, m.mesh.tet[j], 4, 1))
          assert_int_equal(m.part[hex + i], m.part[j]);
      n_level++;
    }
  assert_true(n_met > 10 && n_level > 10);
  check_balance(&m, 9, &r);
  release(&m);
}

/* Clusters give ragged borders, which moving single cells straightens. */
static void clusters_keep_stacks_and_balance(void **state)
{
  struct vg_solver_options o = parts(5);
  struct vg_solver_report fine, coarse;
  struct made m;
  uint64_t n_stack, n_cell;

  (void)state;
  needs_metis();
  make(&m, VG_LAYER_TETS, 1.05);
  tell_apart(&m, &o, &fine);
  o.cluster_above = (m.n_cell - m.info.n_layer_tet) / 8;
  tell_apart(&m, &o, &coarse);
  assert_true(coarse.n_vertex < fine.n_vertex / 2);
  assert_int_equal(stacks_cut(&m, 0, &n_stack, &n_cell), 0);
  check_balance(&m, 5, &coarse);
  assert_int_equal(coarse.n_cut, count_cut(&m.mesh, m.part));
  assert_true((double)coarse.n_cut < 1.5 * (double)fine.n_cut);
  release(&m);
}

static void weights_shift_cells(void **state)
{
  struct vg_solver_options o = parts(2);
  struct vg_solver_report r;
  struct made m;
  double weight[2] = { 0, 0 };

  (void)state;
  needs_metis();
  make(&m, VG_LAYER_MIXED, 1.2);
  o.weight[2] = 5;
  tell_apart(&m, &o, &r);
  for (size_t i = 0; i < m.n_cell; i++)
    weight[m.part[i]] += i < m.mesh.n_tet + m.mesh.n_pyr ? 1 : 5;
  assert_true(weight[0] / weight[1] < 1.1 && weight[1] / weight[0] < 1.1);
  release(&m);
}

/* Isotropic cells that are wrongly counted as layer cells stand on no wall. */
static void a_wrong_number_of_layers_is_noticed(void **state)
{
  const struct vg_solver_options o = parts(4);
  struct vg_solver_layers l = { 1, 0, NULL };
  struct vg_solver_report r;
  struct made m;

  (void)state;
  needs_metis();
  make(&m, VG_LAYER_TETS, 1.5);
  l.n_tet = m.mesh.n_tet;
  assert_int_equal(vg_solver_part(&m.mesh, &l, &o, "x", m.part, &r, NULL),
                   VG_OK);
  assert_true(r.has_loose);
  assert_int_equal(r.n_stack, 0);
  assert_int_equal(vg_solver_part(&m.mesh, NULL, &o, "x", m.part, &r, NULL),
                   VG_OK);
  assert_true(r.has_loose);
  assert_int_equal(r.n_stack, 0);
  release(&m);
}

static void refuses_parts_that_cannot_be(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_solver_report r;
  struct vg_solver_options o = parts(0);
  struct made m;

  (void)state;
  needs_metis();
  make(&m, VG_LAYER_TETS, 1.5);
  assert_int_equal(vg_solver_part(&m.mesh, NULL, &o, "x", m.part, &r, &err),
                   VG_ERR_INPUT);
  o.n_part = m.n_cell + 1;
  assert_int_equal(vg_solver_part(&m.mesh, NULL, &o, "x", m.part, &r, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "request 1 to"));
  o.n_part = 1;
  assert_int_equal(vg_solver_part(&m.mesh, NULL, &o, "x", m.part, &r, &err),
                   VG_OK);
  for (size_t i = 0; i < m.n_cell; i++) assert_int_equal(m.part[i], 0);
  o.n_part = 50; /* METIS may leave some empty; here none may be */
  assert_int_equal(vg_solver_part(&m.mesh, NULL, &o, "x", m.part, &r, &err),
                   VG_OK);
  assert_true(r.least_cells > 0);
  m.mesh.n_tri--;
  o.n_part = 2;
  assert_int_equal(vg_solver_part(&m.mesh, NULL, &o, "open.ugrid", m.part, &r,
                                  &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "open.ugrid"));
  m.mesh.n_tri++;
  release(&m);
}

/* --- hexahedra ----------------------------------------------------------- */

static uint32_t corner(int i, int j, int k)
{
  return (uint32_t)((k * (SIDE + 1) + j) * (SIDE + 1) + i);
}

static void put_quad(struct vg_mesh *m, uint32_t a, uint32_t b, uint32_t c,
                     uint32_t d, uint32_t patch)
{
  const uint32_t q[4] = { a, b, c, d };

  memcpy(m->quad[m->n_quad], q, sizeof q);
  m->quad_patch[m->n_quad++] = patch;
}

/* A cube of hexahedra; patch 1 is its floor, 0 the other sides. */
static void make_cube(struct vg_mesh *m)
{
  const int n = SIDE;

  memset(m, 0, sizeof *m);
  m->n_point = (size_t)(n + 1) * (size_t)(n + 1) * (size_t)(n + 1);
  m->point = vg_calloc(m->n_point, sizeof *m->point);
  m->hex = vg_alloc(N_HEX, sizeof *m->hex);
  m->quad = vg_alloc(6 * SIDE * SIDE, sizeof *m->quad);
  m->quad_patch = vg_alloc(6 * SIDE * SIDE, sizeof *m->quad_patch);
  for (int k = 0; k <= n; k++)
    for (int j = 0; j <= n; j++)
      for (int i = 0; i <= n; i++) {
        double *x = m->point[corner(i, j, k)];

        x[0] = i, x[1] = j, x[2] = k;
      }
  for (int k = 0; k < n; k++)
    for (int j = 0; j < n; j++)
      for (int i = 0; i < n; i++) {
        uint32_t *h = m->hex[m->n_hex++];

        for (int t = 0; t < 2; t++) {
          h[4 * t] = corner(i, j, k + t);
          h[4 * t + 1] = corner(i + 1, j, k + t);
          h[4 * t + 2] = corner(i + 1, j + 1, k + t);
          h[4 * t + 3] = corner(i, j + 1, k + t);
        }
      }
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++)
      for (int t = 0; t <= n; t += n) {
        put_quad(m, corner(a, b, t), corner(a + 1, b, t),
                 corner(a + 1, b + 1, t), corner(a, b + 1, t), t == 0);
        put_quad(m, corner(a, t, b), corner(a + 1, t, b),
                 corner(a + 1, t, b + 1), corner(a, t, b + 1), 0);
        put_quad(m, corner(t, a, b), corner(t, a + 1, b),
                 corner(t, a + 1, b + 1), corner(t, a, b + 1), 0);
      }
}

static void hexahedra_stand_on_walls(void **state)
{
  static const unsigned char is_wall[2] = { 0, 1 };
  const struct vg_solver_layers l = { 0, 0, is_wall };
  const struct vg_solver_options o = parts(4);
  struct vg_solver_report r;
  struct vg_mesh m;
  uint32_t part[N_HEX];

  (void)state;
  needs_metis();
  make_cube(&m);
  assert_int_equal(vg_solver_part(&m, &l, &o, "cube", part, &r, NULL), VG_OK);
  assert_int_equal(r.n_stack, SIDE * SIDE);
  assert_int_equal(r.most_stack, SIDE);
  assert_int_equal(r.n_vertex, SIDE * SIDE);
  for (int i = SIDE * SIDE; i < N_HEX; i++)
    assert_int_equal(part[i], part[i % (SIDE * SIDE)]);
  assert_int_equal(vg_solver_part(&m, NULL, &o, "cube", part, &r, NULL), VG_OK);
  assert_int_equal(r.n_stack, 0);
  assert_int_equal(r.n_vertex, N_HEX);
  vg_mesh_release(&m);
}

/* In slices, hexahedra of the layers are joined with those below them. */
static void stack_in_slices(const struct vg_mesh *m, size_t n_slice,
                            uint32_t n_level, struct vg_solver_report *r)
{
  const struct vg_solver_options o = parts(4);
  struct vg_solver_slices *k = NULL;
  struct vg_slices parted;
  uint32_t part[N_HEX];
  struct vg_error err = VG_ERROR_INIT;
  struct cut c;

  cut_make(&c, m, n_slice, 0, NULL, 3);
  c.s.n_layer_cell[VG_SLICE_HEX] = n_level * SIDE * SIDE;
  if (vg_solver_part_slices(NULL, &c.s, &o, &parted, &k, r, &err) < 0)
    fail_msg("%s", err.text);
  assert_int_equal(vg_slices_collect_parts(&parted, 1, part, &err), VG_OK);
  for (size_t i = 0; i < N_HEX; i++) assert_in_range(part[i], 0, 3);
  for (size_t i = SIDE * SIDE; n_slice == 1 && i < n_level * SIDE * SIDE; i++)
    assert_int_equal(part[i], part[i % (SIDE * SIDE)]);
  assert_int_equal(r->n_cell, N_HEX);
  vg_solver_slices_close(k);
  cut_release(&c);
}

static void hexahedra_of_layers_are_stacked_in_slices(void **state)
{
  struct vg_solver_report r;
  struct vg_mesh m;

  (void)state;
  needs_metis();
  make_cube(&m);
  for (uint32_t n_level = 2; n_level <= SIDE; n_level += 4) {
    stack_in_slices(&m, 1, n_level, &r);
    assert_int_equal(r.n_stack, SIDE * SIDE);
    assert_int_equal(r.most_stack, n_level);
    assert_int_equal(r.n_stack_cell, n_level * SIDE * SIDE);
    assert_int_equal(r.n_vertex, N_HEX - (n_level - 1) * SIDE * SIDE);
    stack_in_slices(&m, 7, n_level, &r);
    assert_true(r.most_stack <= n_level);
  }
  stack_in_slices(&m, 1, 0, &r);
  assert_int_equal(r.n_stack, 0);
  vg_mesh_release(&m);
}

/* --- files --------------------------------------------------------------- */

static void expect_text(const char *path, const char *want)
{
  size_t n;
  unsigned char *text = io_slurp(path, &n);

  assert_int_equal(n, strlen(want));
  assert_memory_equal(text, want, n);
  free(text);
}

static void writes_parts_as_metis_does(void **state)
{
  static const uint32_t part[5] = { 0, 10, 9, 12345, 1 };
  const char *path = io_temp("x.part.12346");

  (void)state;
  assert_int_equal(vg_metis_part_write(path, 5, part, NULL), VG_OK);
  expect_text(path, "0\n10\n9\n12345\n1\n");
  assert_int_equal(vg_metis_part_bytes(5, part), 15);
  unlink(path);
}

static void writes_parts_for_openfoam(void **state)
{
  static const uint32_t part[3] = { 1, 0, 1 };
  char folder[4096], path[4200];
  struct vg_mesh m;
  size_t n;
  unsigned char *text;

  (void)state;
  io_make_t1(&m, 1);
  snprintf(folder, sizeof folder, "%s", io_temp("parts.openfoam"));
  assert_int_equal(vg_foam_write(folder, &m, NULL, NULL), VG_OK);
  assert_int_equal(vg_foam_write_parts(folder, 3, part, 2, NULL), VG_OK);
  snprintf(path, sizeof path, "%s/constant/cellDecomposition", folder);
  text = io_slurp(path, &n);
  assert_non_null(strstr((char *)text, "class       labelList;"));
  assert_non_null(strstr((char *)text, "3\n(\n1\n0\n1\n)\n"));
  free(text);
  snprintf(path, sizeof path, "%s/system/decomposeParDict", folder);
  text = io_slurp(path, &n);
  assert_non_null(strstr((char *)text, "numberOfSubdomains 2;"));
  free(text);
  vg_tree_remove(folder);
  assert_int_equal(access(folder, F_OK), -1);
  vg_mesh_release(&m);
}

static void reads_the_number_of_layer_tetrahedra(void **state)
{
  static const char *const kind[] = { "tail.b8.ugrid", "tail.lr4.ugrid",
                                      "tail.lb8l.ugrid" };
  struct vg_mesh m;
  size_t n = 7;
  int is_known = 7;

  (void)state;
  io_make_t1(&m, 1);
  for (int i = 0; i < 3; i++) {
    const char *path = io_temp(kind[i]);

    assert_int_equal(vg_ugrid_write_tail(path, &m, 1, NULL), VG_OK);
    assert_int_equal(vg_format_layer_tets(path, &is_known, &n, NULL), VG_OK);
    assert_int_equal(is_known, 1);
    assert_int_equal(n, 1);
    assert_int_equal(vg_ugrid_write(path, &m, NULL), VG_OK);
    assert_int_equal(vg_format_layer_tets(path, &is_known, &n, NULL), VG_OK);
    assert_int_equal(is_known, 0);
    unlink(path);
  }
  assert_int_equal(vg_format_layer_tets(io_temp("none.b8.ugrid"), &is_known, &n,
                                        NULL),
                   VG_ERR_IO);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(no_stack_is_cut),
    cmocka_unit_test(no_stack_of_hexahedra_is_cut),
    cmocka_unit_test(clusters_keep_stacks_and_balance),
    cmocka_unit_test(weights_shift_cells),
    cmocka_unit_test(a_wrong_number_of_layers_is_noticed),
    cmocka_unit_test(refuses_parts_that_cannot_be),
    cmocka_unit_test(hexahedra_stand_on_walls),
    cmocka_unit_test(hexahedra_of_layers_are_stacked_in_slices),
    cmocka_unit_test(writes_parts_as_metis_does),
    cmocka_unit_test(writes_parts_for_openfoam),
    cmocka_unit_test(reads_the_number_of_layer_tetrahedra),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
