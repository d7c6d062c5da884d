/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Projects (.d3m) and surface fronts (.front) of VGRID. */
#include "io_support.h"

#include <math.h>

#include "io/vgrid/vgrid.h"

/* T1 as a project (formats.md 1.6), with a different value for each field of
 * its source. */
static const char t1_d3m[] =
  "#VGRID VERSION\n3.6\n#Project Name\nT1\n#\n"
  "               1 (grid)\n            0.15 (rate1)\n"
  "            0.02 (rate2)\n           0.001 (delt1)\n"
  "             100 (nlayr)\n               0 (rstrt)\n"
  "               1 (ifact)\n               1 (vfact)\n"
  "               0 (strch)\n               4 (npoli)\n"
  "               6 (nline)\n               4 (nptch)\n"
  "               1 (ms)\n              20 (ni)\n"
  "          250000 (mboun)\n         2500000 (mpoin)\n#\n"
  "#No.              X-coor            Y-Coor            Z-Coor\n"
  "1                0.0000000e+00    0.0000000e+00    0.0000000e+00\n"
  "2                1.0000000e+00    0.0000000e+00    0.0000000e+00\n"
  "3                0.0000000e+00    1.0000000e+00    0.0000000e+00\n"
  "4                0.0000000e+00    0.0000000e+00    1.0000000e+00\n#\n"
  "       1       2       1       2\n\n       2       2       2       3\n\n"
  "       3       2       1       3\n\n       4       2       1       4\n\n"
  "       5       2       2       4\n\n       6       2       3       4\n#\n"
  "       1       1       3       0       2 viscous_surface\n"
  "                               1       2      -3\n\n"
  "       2       1       3       0       1 char_in/outflow\n"
  "                               4      -5      -1\n\n"
  "       3       1       3       0       1 char_in/outflow\n"
  "                               3       6      -4\n\n"
  "       4       1       3       0       1 char_in/outflow\n"
  "                               5      -6      -2\n#\n"
  "source_number    1                all\n"
  "0                0                                 (type, stretching)\n"
  "1                0                0                (an bn alpha)\n"
  "0.2              0.3                               (S SP point 1)\n"
  "0.001            0.15             0.02             (delta1 rate1 rate2)\n"
  "0.4              0.5                               (S SP point 2)\n"
  "0.002            0.16             0.03             (delta1 rate1 rate2)\n"
  "1                0                0                (U)\n"
  "0                2                0                (P)\n"
  "0                0                -1               (point 1)\n"
  "0                0                3                (point 2)\n";

/* Its surface, one triangle per patch, as VGRID would write it. */
static const char t1_front[] =
  "      npoit      nelet    npoif    nface    nboun    nfacs    nbouc\n"
  "          4          0        4        4        4        4        4"
  "        0          0          0          4\n"
  "       1       1       2       3\n       2       1       4       2\n"
  "       3       1       3       4\n       4       2       4       3\n"
  "       1  0.000000000000E+00  0.000000000000E+00  0.000000000000E+00\n"
  "       2  0.100000000000E+01  0.000000000000E+00  0.000000000000E+00\n"
  "       3  0.000000000000E+00  0.100000000000E+01  0.000000000000E+00\n"
  "       4  0.000000000000E+00  0.000000000000E+00  0.100000000000E+01\n"
  "       1       1\n       2       2\n       3       3\n       4       4\n"
  "  -3   1   1   1\n"
  "       1       2       3       4\n       1       2       3       4\n"
  "       6\n"
  "       1       2       1       1       2       3       2       3       3"
  "       4       4       4\n"
  "          4          4\n           1\n";

static vg_status parse_d3m(const char *text, size_t n, struct vg_project *p,
                           struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_memory("case", text, n, &in, err);

  if (st == VG_OK) st = vg_d3m_parse(&in, p, err);
  vg_input_release(&in);
  return st;
}

static vg_status parse_front(const char *text, size_t n,
                             const struct vg_project *p, struct vg_mesh *m,
                             struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_memory("case", text, n, &in, err);

  if (st == VG_OK) st = vg_front_parse(&in, p, m, err);
  vg_input_release(&in);
  return st;
}

static void accept_d3m(const char *text, struct vg_project *p)
{
  struct vg_error err = VG_ERROR_INIT;

  if (parse_d3m(text, strlen(text), p, &err)) fail_msg("%s", err.text);
}

static void check_t1(const struct vg_project *p)
{
  static const int32_t loop[4][3] = {
    { 1, 2, -3 }, { 4, -5, -1 }, { 3, 6, -4 }, { 5, -6, -2 }
  };
  const struct vg_source *s = p->source;

  assert_string_equal(p->name, "T1");
  assert_int_equal(p->grid, 1);
  assert_true(p->layer.delta1 == 0.001 && p->layer.rate1 == 0.15);
  assert_true(p->layer.rate2 == 0.02 && p->layer.n_max == 100);
  assert_true(p->ifact == 1 && p->vfact == 1);
  assert_int_equal(p->n_background, 20);
  assert_int_equal(p->n_point, 4);
  assert_true(p->point[3][2] == 1);
  assert_int_equal(p->n_curve, 6);
  assert_int_equal(p->curve[5].point[0], 2);
  assert_int_equal(p->curve[5].point[1], 3);
  assert_int_equal(p->n_shape, 4);
  for (int i = 0; i < 4; i++) {
    assert_int_equal(p->shape[i].patch.id, i + 1);
    assert_int_equal(p->shape[i].patch.bc, VG_BC_NONE);
    assert_int_equal(p->shape[i].n, 3);
    assert_memory_equal(p->shape[i].curve, loop[i], sizeof loop[i]);
  }
  assert_int_equal(p->shape[0].meshing_class, 2);
  assert_string_equal(p->shape[1].patch.name, "char_in/outflow");
  assert_int_equal(p->n_source, 1);
  assert_int_equal(s->kind, VG_SOURCE_VGRID_NODE);
  assert_true(s->h0 == 0.2 && s->sp0 == 0.3 && s->h1 == 0.4 && s->an == 1);
  assert_true(s->layer0[1] == 0.15 && s->layer1[2] == 0.03);
  assert_true(s->u[0] == 1 && s->p[1] == 2 && s->p0[2] == -1 && s->p1[2] == 3);
  assert_string_equal(s->group, "all");
}

static void reads_the_worked_example(void **state)
{
  struct vg_project p = VG_PROJECT_INIT;

  (void)state;
  accept_d3m(t1_d3m, &p);
  check_t1(&p);
  vg_project_release(&p);
}

static void writes_what_it_read(void **state)
{
  const char *path = io_temp("front_t1.d3m");
  struct vg_project p = VG_PROJECT_INIT, back = VG_PROJECT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  accept_d3m(t1_d3m, &p);
  p.point[3][2] = 1.0 / 3;
  p.source->h0 = 1.0 / 3;
  if (vg_d3m_write(path, &p, &err)) fail_msg("%s", err.text);
  if (vg_d3m_read(path, &back, &err)) fail_msg("%s", err.text);
  /* Coordinates and sources are written with eleven digits. */
  assert_true(fabs(back.point[3][2] - 1.0 / 3) < 1e-11);
  assert_true(fabs(back.source->h0 - 1.0 / 3) < 1e-11);
  back.point[3][2] = 1;
  back.source->h0 = 0.2;
  check_t1(&back);
  p.source->kind = VG_SOURCE_BOX;
  assert_int_equal(vg_d3m_write(path, &p, &err), VG_ERR_UNSUPPORTED);
  unlink(path);
  vg_project_release(&p);
  vg_project_release(&back);
}

/* The text with the first occurrence of `from` replaced. */
static char *replaced(const char *text, const char *from, const char *to)
{
  const char *at = strstr(text, from);
  char *made = malloc(strlen(text) + strlen(to) + 1);

  assert_non_null(at);
  sprintf(made, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
  return made;
}

static void bad_projects_are_named(void **state)
{
  static const struct {
    const char *from, *to, *phrase;
    vg_status code;
  } cases[] = {
    { "             100 (nlayr)", "many", "nlayr", VG_ERR_FORMAT },
    { "               1 (ifact)", " 0 ", "ifact must be positive",
      VG_ERR_FORMAT },
    { "               4 (npoli)", " 999999999999 ", "npoli", VG_ERR_FORMAT },
    { "               6 (nline)", " -6 ", "nline", VG_ERR_FORMAT },
    { "               6 (nline)", " 7 ", "curve", VG_ERR_FORMAT },
    { "\n4                0", "\n3                0", "occurs twice",
      VG_ERR_INPUT },
    { "       6       2       3       4", " 6 2 3 9 ", "point 9",
      VG_ERR_FORMAT },
    { "       6       2       3       4", " 6 1 3 ", "curve 6 has 1",
      VG_ERR_FORMAT },
    { "       6       2       3       4", " 6 99999999 3 ", "curve 6",
      VG_ERR_FORMAT },
    { "1       2      -3", "1       2       3", "does not close",
      VG_ERR_FORMAT },
    { "1       2      -3", "1       2      -8", "curve -8", VG_ERR_FORMAT },
    { "0.2              0.3", "0 0", "must be positive", VG_ERR_FORMAT },
    { "1                0                0                (an", "0 0 0 (an",
      "an must be positive", VG_ERR_FORMAT },
    { "0                0                                 (type", "2 0 (type",
      "type 2", VG_ERR_UNSUPPORTED },
    { "source_number", "sauce", "source_number", VG_ERR_FORMAT },
    { "1.0000000e+00\n#", "nan\n#", "coordinate", VG_ERR_FORMAT },
  };

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char *text = replaced(t1_d3m, cases[i].from, cases[i].to);
    struct vg_project p = VG_PROJECT_INIT;
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(parse_d3m(text, strlen(text), &p, &err), cases[i].code);
    if (!strstr(err.text, cases[i].phrase) || !strstr(err.text, "case"))
      fail_msg("'%s' has no '%s'", err.text, cases[i].phrase);
    assert_null(p.point);
    free(text);
  }
}

static void curves_may_wrap_and_sides_may_have_several(void **state)
{
  char *a = replaced(t1_d3m, "       6       2       3       4",
                     "       6       2       3\n       4");
  char *b = replaced(a, "       1       1       3       0       2 viscous",
                     "       1       1       2       0       2 viscous");
  char *c = replaced(b, "1       2      -3\n", "1       2\n      -3\n");
  struct vg_project p = VG_PROJECT_INIT;

  (void)state;
  accept_d3m(c, &p);
  assert_int_equal(p.curve[5].n, 2);
  assert_int_equal(p.shape[0].n, 3);
  assert_int_equal(p.shape[0].n_side, 2);
  vg_project_release(&p);
  free(a);
  free(b);
  free(c);
}

static void faces_get_the_patches_of_the_project(void **state)
{
  struct vg_project p = VG_PROJECT_INIT;
  struct vg_mesh m = VG_MESH_INIT, t1;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  accept_d3m(t1_d3m, &p);
  if (parse_front(t1_front, sizeof t1_front - 1, &p, &m, &err))
    fail_msg("%s", err.text);
  io_make_t1(&t1, 0);
  io_same(&t1, &m, 0);
  assert_string_equal(m.patch[0].name, "viscous_surface");
  vg_mesh_release(&m);
  /* Without a project: regions, numbered by their first faces. */
  assert_int_equal(parse_front(t1_front, sizeof t1_front - 1, NULL, &m, &err),
                   VG_OK);
  io_same(&t1, &m, 0);
  vg_mesh_release(&m);
  vg_mesh_release(&t1);
  vg_project_release(&p);
}

/* Two half discs bounded by the same loop of curves differ only in direction,
 * and two curves have the same ends. The front is a lens of four faces. */
static void patches_inside_one_loop_are_told_apart(void **state)
{
  static const double at[4][3] = {
    { -1, 0, 0 }, { 0, -1, 0 }, { 1, 0, 0 }, { 0, 1, 0 }
  };
  /* Upper side 7, lower side 9; curve 1 through point 1, curve 2 through point
   * 3. */
  uint32_t curve[2][3] = { { 0, 1, 2 }, { 0, 3, 2 } };
  int32_t loop[2][2] = { { 1, -2 }, { 2, -1 } };
  double point[5][3] = {
    { -1, 0, 0 }, { 0, -1, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0.1 }
  };
  uint32_t tri[6][3] = { { 0, 1, 4 }, { 1, 2, 4 }, { 2, 3, 4 },
                         { 3, 0, 4 }, { 0, 3, 2 }, { 0, 2, 1 } };
  uint32_t edge[4][2] = { { 0, 1 }, { 1, 2 }, { 0, 3 }, { 3, 2 } }, patch[6];
  struct vg_curve curves[2] = { { 1, 3, curve[0] }, { 2, 3, curve[1] } };
  struct vg_patch_shape shape[2] = {
    { .patch = { .id = 7 }, .n = 2, .curve = loop[0] },
    { .patch = { .id = 9 }, .n = 2, .curve = loop[1] }
  };
  struct vg_project p = VG_PROJECT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  p.n_point = 4;
  p.point = (double(*)[3])at;
  p.n_curve = 2;
  p.curve = curves;
  p.n_shape = 2;
  p.shape = shape;
  m.n_point = 5;
  m.point = point;
  m.n_tri = 6;
  m.tri = tri;
  m.tri_patch = malloc(sizeof patch);
  if (vg_front_patches(&m, 4, (const uint32_t(*)[2])edge, &p, "case", &err))
    fail_msg("%s", err.text);
  assert_int_equal(m.n_patch, 2);
  for (int f = 0; f < 6; f++)
    assert_int_equal(m.patch[m.tri_patch[f]].id, f < 4 ? 7 : 9);
  free(m.tri_patch);
  free(m.quad_patch);
  free(m.patch);
}

static void bad_fronts_are_named(void **state)
{
  static const struct {
    const char *from, *to, *phrase;
    vg_status code;
  } cases[] = {
    { "          4          0        4        4", "4 9 4 4",
      "front of a volume run", VG_ERR_UNSUPPORTED },
    { "          4          0        4        4", "4 0 0 0", "run",
      VG_ERR_UNSUPPORTED },
    { "          4          0        4        4", "x 0 4 4", "counts",
      VG_ERR_FORMAT },
    { "          4          0        4        4        4        4",
      "4 0 4 99999999 4 99999999", "truncated", VG_ERR_FORMAT },
    { "       2       1       4       2", " 2 1 5 2", "node of a face is 5",
      VG_ERR_INPUT },
    { "       2  0.1000", "       3  0.1000", "expected point 2",
      VG_ERR_FORMAT },
    { "       6\n", "       0\n", "curve edges is 0", VG_ERR_FORMAT },
    { "       6\n", "99999999\n", "curve edges is 99999999", VG_ERR_FORMAT },
    { "       1       2       1       1       2       3       2",
      "       1       2       1       1       2       1       2",
      "do not belong together", VG_ERR_INPUT },
    { "0.100000000000E+01\n       1       1", "0.110000000000E+01\n 1 1",
      "end of curve 4", VG_ERR_INPUT },
  };
  struct vg_project p = VG_PROJECT_INIT;

  (void)state;
  accept_d3m(t1_d3m, &p);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char *text = replaced(t1_front, cases[i].from, cases[i].to);
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;
    vg_status st = parse_front(text, strlen(text), &p, &m, &err);

    if (st != cases[i].code || !strstr(err.text, cases[i].phrase) ||
        !strstr(err.text, "case"))
      fail_msg("%zu: %d '%s' has no '%s'", i, st, err.text, cases[i].phrase);
    assert_null(m.point);
    free(text);
  }
  vg_project_release(&p);
}

static void survives_damage(void **state)
{
  struct vg_project p = VG_PROJECT_INIT, q = VG_PROJECT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char work[sizeof t1_d3m > sizeof t1_front ? sizeof t1_d3m : sizeof t1_front];
  uint32_t seed = 3;

  (void)state;
  accept_d3m(t1_d3m, &p);
  for (size_t cut = 0; cut < sizeof t1_front - 1; cut++) {
    vg_status st = parse_front(t1_front, cut, &p, &m, &err);

    /* The last two lines are not needed. */
    if (st == VG_OK) assert_true(cut > sizeof t1_front - 50);
    vg_mesh_release(&m);
  }
  for (size_t cut = 0; cut < sizeof t1_d3m - 1; cut++) {
    parse_d3m(t1_d3m, cut, &q, &err);
    vg_project_release(&q);
  }
  for (int turn = 0; turn < 20000; turn++) {
    int is_front = turn & 1;
    size_t n = is_front ? sizeof t1_front - 1 : sizeof t1_d3m - 1;

    memcpy(work, is_front ? t1_front : t1_d3m, n);
    for (int k = 0; k < 1 + turn % 3; k++) {
      seed = seed * 1664525u + 1013904223u;
      work[(seed >> 8) % n] = turn & 2 ? (char)(seed >> 24)
                                       : (char)('0' + (seed >> 24) % 10);
    }
    if (is_front) parse_front(work, n, turn & 4 ? &p : NULL, &m, &err);
    else parse_d3m(work, n, &q, &err);
    vg_mesh_release(&m);
    vg_project_release(&q);
  }
  vg_project_release(&p);
}

static int compare_face(const void *a, const void *b)
{
  return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* Nodes rotated so that the lowest comes first, and the patch number. */
static uint32_t (*sorted_faces(const struct vg_mesh *m))[4]
{
  uint32_t(*face)[4] = malloc(m->n_tri * sizeof *face);

  for (size_t f = 0; f < m->n_tri; f++) {
    const uint32_t *t = m->tri[f];
    int low = t[0] < t[1] ? t[0] < t[2] ? 0 : 2 : t[1] < t[2] ? 1 : 2;

    for (int k = 0; k < 3; k++) face[f][k] = t[(low + k) % 3];
    face[f][3] = (uint32_t)m->patch[m->tri_patch[f]].id;
  }
  qsort(face, m->n_tri, sizeof *face, compare_face);
  return face;
}

/* VGRID's own project. Its .bc lists the final surface: two patches as in the
 * front, four remeshed on the same points (formats.md 1.8). */
static void patches_of_the_real_front_are_those_of_its_bc(void **state)
{
  char d3m[1024], front[1024];
  struct vg_project p = VG_PROJECT_INIT;
  struct vg_mesh surface = VG_MESH_INIT, volume = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint32_t(*a)[4], (*b)[4];
  size_t n_common = 0, per_patch[7] = { 0 }, in_bc[7] = { 0 };

  (void)state;
  snprintf(d3m, sizeof d3m, "%s", io_real("vgrid_box/box.d3m"));
  snprintf(front, sizeof front, "%s", io_real("vgrid_box/box.front"));
  if (vg_d3m_read(d3m, &p, &err)) fail_msg("%s", err.text);
  assert_int_equal(p.n_source, 8);
  assert_int_equal(p.n_curve, 12);
  if (vg_front_read(front, &p, &surface, &err)) fail_msg("%s", err.text);
  if (vg_cogsg_read(io_real("vgrid_box/box.cogsg"), &volume, NULL, NULL, &err))
    fail_msg("%s", err.text);
  assert_int_equal(surface.n_tri, 6810);
  assert_int_equal(surface.n_patch, 6);
  assert_int_equal(io_bad_edges(&surface), 0);
  assert_true(io_volume6(&surface) < 0); /* inward */
  a = sorted_faces(&surface);
  b = sorted_faces(&volume);
  for (size_t i = 0, j = 0; i < 6810 && j < 6810;) {
    int c = compare_face(a[i], b[j]);

    if (!c) {
      assert_int_equal(a[i][3], b[j][3]);
      n_common++;
      per_patch[a[i][3]]++;
    }
    i += c <= 0;
    j += c >= 0;
  }
  for (size_t j = 0; j < 6810; j++) in_bc[b[j][3]]++;
  print_message("%zu shared faces\n", n_common);
  /* The floor (viscous) and the opposite side are the unchanged patches. */
  assert_int_equal(per_patch[3], in_bc[3]);
  assert_int_equal(per_patch[4], in_bc[4]);
  assert_true(n_common < 6810);
  free(a);
  free(b);
  vg_mesh_release(&surface);
  vg_mesh_release(&volume);
  vg_project_release(&p);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_the_worked_example),
    cmocka_unit_test(writes_what_it_read),
    cmocka_unit_test(bad_projects_are_named),
    cmocka_unit_test(curves_may_wrap_and_sides_may_have_several),
    cmocka_unit_test(faces_get_the_patches_of_the_project),
    cmocka_unit_test(patches_inside_one_loop_are_told_apart),
    cmocka_unit_test(bad_fronts_are_named),
    cmocka_unit_test(survives_damage),
    cmocka_unit_test(patches_of_the_real_front_are_those_of_its_bc),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
