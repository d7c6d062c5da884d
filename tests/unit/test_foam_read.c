/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* OpenFOAM's cases are read back, with fields, and values in the cells become
 * values at the points. */
#include "mixed_support.h"

#include <math.h>
#include <sys/stat.h>

#include "core/hessian/point_values.h"
#include "io/foam/foam_read.h"
#include "io/mesh/foam.h"
#include "run/commit/tree.h"

static void near(double value, double expected, double tolerance)
{
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.17g instead of %.17g", value, expected);
}

static char *in_case(const char *dir, const char *file)
{
  static char path[4][4400];
  static int turn;

  turn = (turn + 1) % 4;
  snprintf(path[turn], sizeof path[turn], "%s/%s", dir, file);
  return path[turn];
}

static void write_text(const char *dir, const char *file, const char *text)
{
  FILE *f = fopen(in_case(dir, file), "wb");

  assert_non_null(f);
  fputs(text, f);
  assert_int_equal(fclose(f), 0);
}

static void write_case(const char *dir, const struct vg_mesh *m, int is_ascii)
{
  struct vg_foam_options as = { .is_ascii = is_ascii };
  struct vg_error err = VG_ERROR_INIT;

  vg_tree_remove(dir);
  if (vg_foam_write(dir, m, &as, &err)) fail_msg("%s", err.text);
}

static void read_case(const char *dir, struct vg_foam_case *c)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_foam_case_read(dir, c, &err)) fail_msg("%s", err.text);
}

/* The same cells: each has the nodes of the other, and they are valid, which
 * their sides being each other's opposite says. */
static void same_cells(const struct vg_mesh *a, const struct vg_mesh *b,
                       const uint32_t *number)
{
  struct mixed_side *s;
  size_t n;

  assert_int_equal(a->n_tet, b->n_tet);
  assert_int_equal(a->n_pyr, b->n_pyr);
  assert_int_equal(a->n_pri, b->n_pri);
  assert_int_equal(a->n_hex, b->n_hex);
  for (size_t i = 0; i < mixed_n_cell(a); i++) {
    int kind, other;
    uint32_t u[8], v[8];
    const uint32_t *p = mixed_cell(a, i, &kind);
    const uint32_t *q = mixed_cell(b, number[i], &other);

    memcpy(u, p, sizeof *u * (size_t)mixed_width[kind]);
    memcpy(v, q, sizeof *v * (size_t)mixed_width[other]);
    assert_int_equal(kind, other);
    mixed_sort(u, mixed_width[kind]);
    mixed_sort(v, mixed_width[kind]);
    assert_memory_equal(u, v, sizeof *u * (size_t)mixed_width[kind]);
  }
  n = mixed_sides(b, &s);
  for (size_t i = 0; i + 1 < n; i++)
    if (!mixed_by_key(s + i, s + i + 1)) /* opposite turns of the same nodes */
      assert_memory_not_equal(s[i].node, s[i + 1].node, sizeof s->node);
  free(s);
}

static void a_case_is_read_back(void **state)
{
  const char *dir = io_temp("read.openfoam");
  struct vg_mesh m;

  (void)state;
  mixed_make(&m, 4, 3);
  for (int is_ascii = 0; is_ascii < 2; is_ascii++) {
    struct vg_foam_case c = VG_FOAM_CASE_INIT;
    char boundary[4400];

    write_case(dir, &m, is_ascii);
    snprintf(boundary, sizeof boundary, "%s/constant/polyMesh", dir);
    assert_true(vg_foam_is_case(dir));
    assert_false(vg_foam_is_case(boundary));
    read_case(dir, &c);
    assert_int_equal(c.m.n_point, m.n_point);
    assert_memory_equal(c.m.point, m.point, m.n_point * sizeof *m.point);
    assert_int_equal(c.n_cell, mixed_n_cell(&m));
    same_cells(&m, &c.m, c.cell);
    assert_int_equal(c.m.n_patch, 3);
    assert_int_equal(c.m.n_tri, m.n_tri);
    assert_int_equal(c.m.n_quad, m.n_quad);
    assert_string_equal(c.m.patch[0].name, "low_end");
    assert_string_equal(c.time, "");
    vg_foam_case_release(&c);
  }
  vg_tree_remove(dir);
  vg_mesh_release(&m);
}

static double linear(const double x[3])
{
  return 3 * x[0] - 2 * x[1] + 0.5 * x[2] + 7;
}

/* The centre of a tetrahedron, of a parallelepiped and of half of one is the
 * mean of its corners. */
static void centre_of(const struct vg_mesh *m, size_t cell, double x[3])
{
  int kind;
  const uint32_t *node = mixed_cell(m, cell, &kind);

  for (int k = 0; k < 3; k++) {
    x[k] = 0;
    for (int i = 0; i < mixed_width[kind]; i++)
      x[k] += m->point[node[i]][k] / mixed_width[kind];
  }
  if (kind == 1) /* a quarter of the height, not a fifth */
    for (int k = 0; k < 3; k++) {
      double base = 0;

      for (int i = 0; i < 5; i++)
        if (i != 2) base += m->point[node[i]][k] / 4;
      x[k] = base + (m->point[node[2]][k] - base) / 4;
    }
}

/* Columns of sheared cubes, in which all centres are known. */
static void linear_functions_are_exact(void **state)
{
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  double *cell, *point, x[3];

  (void)state;
  mixed_make(&m, 3, 3);
  for (size_t p = 0; p < m.n_point; p++)
    for (int k = 0; k < 3; k++) m.point[p][k] = 0;
  for (uint32_t i = 0; i < 4 * 16; i++) {
    m.point[i][0] = i % 4 + 0.3 * (i / 16);
    m.point[i][1] = i / 4 % 4;
    m.point[i][2] = i / 16;
  }
  for (size_t c = 0; c < m.n_pyr; c++) { /* apexes in the middle of cubes */
    double *top = m.point[m.pyr[c][2]];
    int n = 0;

    if (c % 5) continue;
    for (int k = 0; k < 3; k++) top[k] = 0;
    for (size_t q = c; q < c + 5; q++)
      for (int i = 0; i < 5; i++)
        if (i != 2) {
          for (int k = 0; k < 3; k++) top[k] += m.point[m.pyr[q][i]][k];
          n++;
        }
    for (int k = 0; k < 3; k++) top[k] /= n;
  }
  cell = malloc(mixed_n_cell(&m) * sizeof *cell);
  point = malloc(m.n_point * sizeof *point);
  for (size_t c = 0; c < mixed_n_cell(&m); c++) {
    centre_of(&m, c, x);
    cell[c] = linear(x);
  }
  assert_int_equal(vg_point_values(&m, cell, point, &err), VG_OK);
  for (size_t p = 0; p < m.n_point; p++)
    near(point[p], linear(m.point[p]), 1e-10);
  free(cell);
  free(point);
  vg_mesh_release(&m);
}

/* A single hexahedron: one value, which all its points take. */
static void one_cell_is_constant(void **state)
{
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  double cell[10], *point;

  (void)state;
  mixed_make(&m, 1, 1);
  for (int i = 0; i < 10; i++) cell[i] = -4;
  point = malloc(m.n_point * sizeof *point);
  assert_int_equal(vg_point_values(&m, cell, point, &err), VG_OK);
  for (size_t p = 0; p < m.n_point; p++) near(point[p], -4, 1e-13);
  free(point);
  vg_mesh_release(&m);
}

#define HEAD(class, format)                                                    \
  "/* a comment { */\nFoamFile\n{\n version 2.0; // another }\n"               \
  " format " format                                                            \
  ";\n class " class ";\n object p;\n}\n"                                      \
                     "#include \"x\" ;\ndimensions [0 2 -2 0 0 0 0];\n"

static void refuse(const struct vg_foam_case *c, const char *name,
                   vg_status code, const char *phrase)
{
  struct vg_error err = VG_ERROR_INIT;
  double *value = NULL;
  int n;

  assert_int_equal(vg_foam_field_read(c, name, &n, &value, &err), code);
  assert_null(value);
  if (!strstr(err.text, phrase)) fail_msg("%s: no '%s'", err.text, phrase);
}

static void fields(void **state)
{
  const char *dir = io_temp("fields.openfoam");
  struct vg_foam_case c = VG_FOAM_CASE_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;
  char text[4000], list[2000] = "";
  double *value;
  FILE *f;
  int n;

  (void)state;
  mixed_make(&m, 1, 1);
  write_case(dir, &m, 0);
  for (size_t i = 0; i < 10; i++)
    snprintf(list + strlen(list), sizeof list - strlen(list), "%g\n",
             0.5 * (double)i);
  mkdir(in_case(dir, "0"), 0777);
  mkdir(in_case(dir, "0.orig"), 0777);
  mkdir(in_case(dir, "10"), 0777);
  mkdir(in_case(dir, "9.5"), 0777);
  snprintf(text, sizeof text,
           "%sinternalField nonuniform List<scalar>\n10\n(\n%s)\n;\n",
           HEAD("volScalarField", "ascii"), list);
  write_text(dir, "10/p", text);
  write_text(dir, "10/U",
             HEAD("volVectorField", "ascii") "internalField uniform (1 2 3);");
  write_text(dir, "10/phi",
             HEAD("surfaceScalarField", "ascii") "internalField uniform 1;");
  write_text(dir, "10/short",
             HEAD("volScalarField",
                  "ascii") "internalField nonuniform List<scalar> 2(1 2);");
  write_text(dir, "10/other",
             HEAD("volScalarField",
                  "ascii") "internalField nonuniform List<vector> 0();");
  write_text(dir, "10/cut",
             HEAD("volScalarField", "ascii") "internalField nonuniform "
                                             "List<scalar> 10(1 2 3");
  f = fopen(in_case(dir, "10/b"), "wb");
  fputs(HEAD("volScalarField", "binary"), f);
  fputs("internalField nonuniform List<scalar> 10(", f);
  for (int i = 0; i < 10; i++) {
    double v = 1.25 * i;

    fwrite(&v, sizeof v, 1, f);
  }
  fputs(");", f);
  fclose(f);

  read_case(dir, &c);
  assert_string_equal(strrchr(c.time, '/'), "/10");
  assert_int_equal(vg_foam_field_read(&c, "p", &n, &value, &err), VG_OK);
  assert_int_equal(n, 1);
  for (size_t i = 0; i < 10; i++) near(value[c.cell[i]], 0.5 * (double)i, 0);
  free(value);
  assert_int_equal(vg_foam_field_read(&c, "b", &n, &value, &err), VG_OK);
  for (size_t i = 0; i < 10; i++) near(value[c.cell[i]], 1.25 * (double)i, 0);
  free(value);
  assert_int_equal(vg_foam_field_read(&c, "U", &n, &value, &err), VG_OK);
  assert_int_equal(n, 3);
  for (size_t i = 0; i < 30; i++) near(value[i], 1 + (double)(i % 3), 0);
  free(value);
  refuse(&c, "Ma", VG_ERR_INPUT, "U, b, cut, other, p, phi, short");
  refuse(&c, "", VG_ERR_INPUT, "--field");
  refuse(&c, "phi", VG_ERR_INPUT, "surfaceScalarField");
  refuse(&c, "short", VG_ERR_FORMAT, "the mesh has 10 cells");
  refuse(&c, "other", VG_ERR_FORMAT, "List<vector>");
  refuse(&c, "cut", VG_ERR_FORMAT, "truncated");
  vg_foam_case_release(&c);
  read_case(in_case(dir, "9.5"), &c);
  refuse(&c, "p", VG_ERR_INPUT, "none");
  vg_foam_case_release(&c);
  vg_tree_remove(dir);
  vg_mesh_release(&m);
}

static void refuse_case(const char *dir, const char *file, const char *text,
                        vg_status code, const char *phrase)
{
  struct vg_foam_case c = VG_FOAM_CASE_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;

  mixed_make(&m, 1, 1);
  write_case(dir, &m, 1);
  write_text(dir, file, text);
  assert_int_equal(vg_foam_case_read(dir, &c, &err), code);
  if (!strstr(err.text, phrase)) fail_msg("%s: no '%s'", err.text, phrase);
  vg_foam_case_release(&c);
  vg_mesh_release(&m);
}

#define LIST(class) "FoamFile { format ascii; class " class "; }\n"

static void damaged_meshes_are_refused(void **state)
{
  const char *dir = io_temp("damaged.openfoam");

  (void)state;
  refuse_case(dir, "constant/polyMesh/points", "7 ((0 0 0))", VG_ERR_FORMAT,
              "FoamFile");
  refuse_case(dir, "constant/polyMesh/points",
              LIST("vectorField") "1000000 ((0 0 0))", VG_ERR_FORMAT,
              "truncated");
  refuse_case(dir, "constant/polyMesh/points",
              LIST("vectorField") "1 ((0 0 nan))", VG_ERR_FORMAT, "finite");
  refuse_case(dir, "constant/polyMesh/faces", LIST("faceList") "1 (3(0 1 99))",
              VG_ERR_FORMAT, "99");
  refuse_case(dir, "constant/polyMesh/owner", LIST("labelList") "3 (0 0 0)",
              VG_ERR_FORMAT, "owners");
  refuse_case(dir, "constant/polyMesh/neighbour", LIST("labelList") "1 (-5)",
              VG_ERR_FORMAT, "-5");
  refuse_case(dir, "constant/polyMesh/neighbour", LIST("labelList") "0()",
              VG_ERR_FORMAT, "cover");
  refuse_case(dir, "constant/polyMesh/boundary",
              LIST("polyBoundaryMesh") "1 (a { type wall; nFaces 3; "
                                       "startFace 0; })",
              VG_ERR_FORMAT, "cover");
  refuse_case(dir, "constant/polyMesh/boundary",
              LIST("polyBoundaryMesh") "1 (a { type wall;", VG_ERR_FORMAT,
              "no end");
  vg_tree_remove(dir);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_case_is_read_back),
    cmocka_unit_test(linear_functions_are_exact),
    cmocka_unit_test(one_cell_is_constant),
    cmocka_unit_test(fields),
    cmocka_unit_test(damaged_meshes_are_refused),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
