/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include "io/vgrid/vgrid.h"

/* T1 as formats.md 1.2 prints it, with VGRID's one trailing record. */
static const unsigned char t1_cogsg[172] = {
  0, 0, 0, 0x30, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 1,    0,    0,    0, 4,
  0, 0, 0, 4,    0,    0,    0,    0,    0, 0, 0, 0,    0,    0,    0, 0,
  0, 0, 0, 0,    0,    0,    0,    1,    0, 0, 0, 2,    0,    0,    0, 3,
  0, 0, 0, 4,    0,    0,    0,    0x30, 0, 0, 0, 0x60, 0,    0,    0, 0,
  0, 0, 0, 0,    0x3f, 0xf0, 0,    0,    0, 0, 0, 0,    0,    0,    0, 0,
  0, 0, 0, 0,    0,    0,    0,    0,    0, 0, 0, 0,    0,    0,    0, 0,
  0, 0, 0, 0,    0,    0,    0,    0,    0, 0, 0, 0,    0x3f, 0xf0, 0, 0,
  0, 0, 0, 0,    0,    0,    0,    0,    0, 0, 0, 0,    0,    0,    0, 0,
  0, 0, 0, 0,    0,    0,    0,    0,    0, 0, 0, 0,    0,    0,    0, 0,
  0, 0, 0, 0,    0x3f, 0xf0, 0,    0,    0, 0, 0, 0,    0,    0,    0, 0x60,
  0, 0, 0, 4,    0,    0,    0,    0,    0, 0, 0, 4
};

/* The same mesh; four patches of one face, so that all points are shared. */
static const char t1_bc[] = "       4       4       4       1\n"
                            " Triangle   Surface Patch       Nodes\n"
                            "       1       1       1       2       3\n"
                            "       2       2       1       4       2\n"
                            "       3       3       1       3       4\n"
                            "       4       4       2       4       3\n";

static vg_status parse_pair(const void *cogsg, size_t n, const void *bc,
                            size_t n_bc, struct vg_mesh *m,
                            struct vg_cogsg_info *info, struct vg_error *err)
{
  struct vg_input a = VG_INPUT_INIT, b = VG_INPUT_INIT;
  vg_status st = vg_input_memory("case.cogsg", cogsg, n, &a, err);

  if (st == VG_OK) st = vg_input_memory("case.bc", bc, n_bc, &b, err);
  if (st == VG_OK) st = vg_cogsg_parse(&a, &b, m, info, NULL, err);
  vg_input_release(&a);
  vg_input_release(&b);
  return st;
}

static void unlink_triple(const char *stem)
{
  static const char *const part[] = { "cogsg", "bc", "mapbc" };
  char name[4200];

  for (int i = 0; i < 3; i++) {
    snprintf(name, sizeof name, "%s.%s", stem, part[i]);
    unlink(name);
  }
}

static const char *with(const char *stem, const char *suffix)
{
  static char name[4200];

  snprintf(name, sizeof name, "%s%s", stem, suffix);
  return name;
}

static void compare_file(const char *path, const void *want, size_t n)
{
  size_t size;
  unsigned char *data = io_slurp(path, &size);

  assert_int_equal(size, n);
  assert_memory_equal(data, want, n);
  free(data);
}

static void writes_t1_byte_for_byte(void **state)
{
  const char *stem = io_temp("vgrid_t1");
  struct vg_cogsg_info info = VG_COGSG_INFO_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;
  size_t size, n_unset;
  unsigned char *two;

  (void)state;
  io_make_t1(&m, 1);
  info.n_trailing = 1;
  if (vg_cogsg_write(stem, &m, &info, 0, &n_unset, &err))
    fail_msg("%s", err.text);
  assert_int_equal(n_unset, 4);
  compare_file(with(stem, ".cogsg"), t1_cogsg, sizeof t1_cogsg);
  compare_file(with(stem, ".bc"), t1_bc, sizeof t1_bc - 1);
  /* By default there are two trailing records. */
  assert_int_equal(vg_cogsg_write(stem, &m, NULL, 0, NULL, &err), VG_OK);
  two = io_slurp(with(stem, ".cogsg"), &size);
  assert_int_equal(size, sizeof t1_cogsg + 12);
  assert_memory_equal(two, t1_cogsg, sizeof t1_cogsg);
  assert_memory_equal(two + sizeof t1_cogsg, t1_cogsg + 160, 12);
  free(two);
  unlink_triple(stem);
  vg_mesh_release(&m);
}

static void reads_t1(void **state)
{
  struct vg_mesh m = VG_MESH_INIT, t1;
  struct vg_cogsg_info info;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  if (parse_pair(t1_cogsg, sizeof t1_cogsg, t1_bc, sizeof t1_bc - 1, &m, &info,
                 &err))
    fail_msg("%s", err.text);
  io_make_t1(&t1, 1);
  io_same(&t1, &m, 1);
  assert_int_equal(info.inew, -1);
  assert_int_equal(info.n_boundary, 4);
  assert_int_equal(info.n_curve_point, 4);
  assert_int_equal(info.n_trailing, 1);
  assert_int_equal(info.igrid, 1);
  vg_mesh_release(&m);
  vg_mesh_release(&t1);
}

static void put(unsigned char **at, uint64_t v, int size, int big)
{
  for (int b = 0; b < size; b++)
    *(*at)++ = (unsigned char)(v >> 8 * (big ? size - 1 - b : b));
}

static void put_real(unsigned char **at, double v, int size, int big)
{
  float narrow = (float)v;
  uint32_t w;
  uint64_t d;

  memcpy(&w, &narrow, 4);
  memcpy(&d, &v, 8);
  put(at, size == 4 ? w : d, size, big);
}

/* The other layouts that readers should accept: little-endian, reals and tc in
 * single precision, markers of eight bytes. */
static void reads_other_layouts(void **state)
{
  struct vg_mesh t1;

  (void)state;
  io_make_t1(&t1, 1);
  for (int turn = 0; turn < 16; turn++) {
    int big = turn & 1, marker = turn & 2 ? 8 : 4, tc = turn & 4 ? 4 : 8;
    int real = turn & 8 ? 4 : 8;
    static const uint32_t head[10] = { UINT32_MAX, 1, 4, 4, 0, 0 };
    unsigned char data[400], *at = data;
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;
    uint64_t first = 24 + (uint64_t)tc + 16, second = 12 * (uint64_t)real;

    put(&at, first, marker, big);
    for (int i = 0; i < 6; i++) put(&at, head[i], 4, big);
    put_real(&at, 0, tc, big);
    for (uint32_t i = 1; i <= 4; i++) put(&at, i, 4, big);
    put(&at, first, marker, big);
    put(&at, second, marker, big);
    for (int k = 0; k < 3; k++)
      for (int i = 0; i < 4; i++) put_real(&at, t1.point[i][k], real, big);
    put(&at, second, marker, big);
    if (parse_pair(data, (size_t)(at - data), t1_bc, sizeof t1_bc - 1, &m, NULL,
                   &err))
      fail_msg("turn %d: %s", turn, err.text);
    io_same(&t1, &m, 1);
    vg_mesh_release(&m);
  }
  vg_mesh_release(&t1);
}

/* n x n x n cubes of six tetrahedra; patch of a boundary face: its side. The
 * points are numbered in scrambled order if stride is not 1. */
static void make_box(struct vg_mesh *m, uint32_t n, uint32_t stride)
{
  static const int order[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 },
                                   { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
  uint32_t w = n + 1, count = w * w * w, step[3] = { 1, w, w * w };
  size_t n_tet = 6 * (size_t)n * n * n, n_tri = 12 * (size_t)n * n, t = 0;

  memset(m, 0, sizeof *m);
  m->point = malloc(count * sizeof *m->point);
  m->tet = malloc(n_tet * sizeof *m->tet);
  m->tri = malloc(n_tri * sizeof *m->tri);
  m->tri_patch = malloc(n_tri * sizeof *m->tri_patch);
  m->n_point = count;
#define AT(i) ((uint32_t)((uint64_t)(i)*stride % count))
  for (uint32_t i = 0; i < count; i++) {
    m->point[AT(i)][0] = i % w;
    m->point[AT(i)][1] = i / w % w;
    m->point[AT(i)][2] = i / w / w;
  }
  for (uint32_t i = 0; i < count; i++) {
    if (i % w == n || i / w % w == n || i / w / w == n) continue;
    for (int k = 0; k < 6; k++) {
      uint32_t a = i, b = a + step[order[k][0]], c = b + step[order[k][1]];
      uint32_t d = c + step[order[k][2]];
      uint32_t *tet = m->tet[t++];

      tet[0] = AT(a);
      tet[1] = AT(k < 3 ? b : c);
      tet[2] = AT(k < 3 ? c : b);
      tet[3] = AT(d);
    }
  }
  m->n_tet = n_tet;
  for (int k = 0; k < 6; k++) vg_mesh_add_patch(m, k + 1, NULL);
  for (uint32_t axis = 0; axis < 3; axis++)
    for (uint32_t side = 0; side < 2; side++)
      for (uint32_t i = 0; i < count; i++) {
        uint32_t p[3] = { i % w, i / w % w, i / w / w };
        uint32_t u = step[(axis + 1) % 3], v = step[(axis + 2) % 3];

        if (p[axis] != side * n || p[(axis + 1) % 3] == n ||
            p[(axis + 2) % 3] == n)
          continue;
        for (int half = 0; half < 2; half++) {
          uint32_t b = half ? i + u + v : i + u, c = half ? i + v : i + u + v;

          m->tri[m->n_tri][0] = AT(i);
          m->tri[m->n_tri][1] = AT(side ? c : b);
          m->tri[m->n_tri][2] = AT(side ? b : c);
          m->tri_patch[m->n_tri++] = 2 * axis + side;
        }
      }
#undef AT
}

static int compare_point(const void *a, const void *b)
{
  return memcmp(a, b, 3 * sizeof(double));
}

/* The same cells and faces, by coordinates, in the same order. */
static void same_geometry(const struct vg_mesh *a, const struct vg_mesh *b)
{
  assert_int_equal(a->n_tet, b->n_tet);
  assert_int_equal(a->n_tri, b->n_tri);
  for (size_t i = 0; i < a->n_tet; i++)
    for (int k = 0; k < 4; k++)
      assert_int_equal(compare_point(a->point[a->tet[i][k]],
                                     b->point[b->tet[i][k]]),
                       0);
  for (size_t i = 0; i < a->n_tri; i++) {
    assert_int_equal(a->patch[a->tri_patch[i]].id,
                     b->patch[b->tri_patch[i]].id);
    for (int k = 0; k < 3; k++)
      assert_int_equal(compare_point(a->point[a->tri[i][k]],
                                     b->point[b->tri[i][k]]),
                       0);
  }
}

/* Number of sides of the box of n cubes that contain a point. */
static int n_side(const double p[3], double n)
{
  int s = 0;

  for (int k = 0; k < 3; k++) s += p[k] == 0 || p[k] == n;
  return s;
}

static void points_are_put_in_vgrids_order(void **state)
{
  const char *stem = io_temp("vgrid_order");
  struct vg_mesh m, back = VG_MESH_INIT, again = VG_MESH_INIT;
  struct vg_cogsg_info info, info2;
  struct vg_turned turned;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  make_box(&m, 5, 101); /* 216 points, 101 prime to it */
  if (vg_cogsg_write(stem, &m, NULL, 0, NULL, &err)) fail_msg("%s", err.text);
  if (vg_cogsg_read(with(stem, ".cogsg"), &back, &info, &turned, &err))
    fail_msg("%s", err.text);
  assert_int_equal(turned.cell + turned.face + turned.loose_face, 0);
  assert_int_equal(info.n_curve_point, 8 + 12 * 4);
  assert_int_equal(info.n_boundary, 216 - 64);
  same_geometry(&m, &back);
  for (size_t i = 0; i < back.n_point; i++)
    assert_int_equal(n_side(back.point[i], 5), i < 8     ? 3
                                               : i < 56  ? 2
                                               : i < 152 ? 1
                                                         : 0);
  /* Along a curve each point is next to the previous one; twelve curves begin
   * next to a corner. */
  int starts = 0;
  for (size_t i = 8; i < 56; i++) {
    double d = 0;

    for (int k = 0; k < 3; k++)
      d += (back.point[i][k] - back.point[i - 1][k]) *
           (back.point[i][k] - back.point[i - 1][k]);
    starts += d != 1;
  }
  assert_true(starts <= 12);
  /* A mesh that is in order keeps its numbers. */
  assert_int_equal(vg_cogsg_write(stem, &back, NULL, 0, NULL, &err), VG_OK);
  assert_int_equal(vg_cogsg_read(stem, &again, &info2, NULL, &err), VG_ERR_IO);
  assert_int_equal(vg_cogsg_read(with(stem, ".cogsg"), &again, &info2, NULL,
                                 &err),
                   VG_OK);
  io_same(&back, &again, 1);
  unlink_triple(stem);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
  vg_mesh_release(&again);
}

/* Records cut at 20 bytes: markers of formats.md 1.1 in the file, and the same
 * mesh when it is read. */
static void subrecords_are_written_and_joined(void **state)
{
  const char *stem = io_temp("vgrid_sub");
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_cogsg_info info;
  struct vg_error err = VG_ERROR_INIT;
  unsigned char *data;
  size_t size;

  (void)state;
  make_box(&m, 2, 1);
  assert_int_equal(vg_cogsg_write(stem, &m, NULL, 20, NULL, &err), VG_OK);
  data = io_slurp(with(stem, ".cogsg"), &size);
  /* 48 cells: 800 bytes in 40 parts; 27 points: 648 bytes in 33 parts. */
  assert_int_equal(size, 800 + 40 * 8 + 648 + 33 * 8 + 2 * 12);
  assert_memory_equal(data, "\xff\xff\xff\xec", 4);
  assert_memory_equal(data + 24, "\0\0\0\x14\xff\xff\xff\xec", 8);
  free(data);
  if (vg_cogsg_read(with(stem, ".cogsg"), &back, &info, NULL, &err))
    fail_msg("%s", err.text);
  same_geometry(&m, &back);
  assert_int_equal(info.n_trailing, 2);
  unlink_triple(stem);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

static void refuses_other_cells(void **state)
{
  const char *stem = io_temp("vgrid_mixed");
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  io_make_mixed(&m);
  assert_int_equal(vg_cogsg_write(stem, &m, NULL, 0, NULL, &err),
                   VG_ERR_UNSUPPORTED);
  assert_non_null(strstr(err.text, "tetrahedra"));
  assert_int_equal(access(with(stem, ".cogsg"), F_OK), -1);
  assert_int_equal(access(with(stem, ".cogsg.part"), F_OK), -1);
  vg_mesh_release(&m);
}

static void expect(const unsigned char *cogsg, size_t n, const char *bc,
                   vg_status code, const char *phrase)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = parse_pair(cogsg, n, bc, strlen(bc), &m, NULL, &err);

  if (st != code || !strstr(err.text, phrase) || !strstr(err.text, "case."))
    fail_msg("%d instead of %d: '%s' has no '%s'", st, code, err.text, phrase);
  assert_null(m.point);
}

static void bad_headers_are_named(void **state)
{
  unsigned char d[sizeof t1_cogsg];

  (void)state;
#define CHANGE(at, value) (memcpy(d, t1_cogsg, sizeof d), d[at] = (value))
  CHANGE(3, 0x31);
  expect(d, sizeof d, t1_bc, VG_ERR_FORMAT, "marker");
  CHANGE(8, 0x7f);
  expect(d, sizeof d, t1_bc, VG_ERR_FORMAT, "marker");
  CHANGE(15, 5);
  expect(d, sizeof d, t1_bc, VG_ERR_FORMAT, "coordinates");
  CHANGE(12, 0x80);
  expect(d, sizeof d, t1_bc, VG_ERR_FORMAT, "negative");
  CHANGE(19, 5);
  expect(d, sizeof d, t1_bc, VG_ERR_FORMAT, "more boundary points");
  CHANGE(27, 2);
  expect(d, sizeof d, t1_bc, VG_ERR_FORMAT, "more layer cells");
  CHANGE(39, 0);
  expect(d, sizeof d, t1_bc, VG_ERR_INPUT, "cell 1 refers to point 0");
  CHANGE(39, 5);
  expect(d, sizeof d, t1_bc, VG_ERR_INPUT, "cell 1 refers to point 5");
  CHANGE(55, 0);
  expect(d, sizeof d, t1_bc, VG_ERR_FORMAT, "markers");
#undef CHANGE
}

static void bad_bc_files_are_named(void **state)
{
  static const struct {
    const char *bc, *phrase;
    vg_status code;
  } cases[] = {
    { "wall 1 0.1\n", "AFLR", VG_ERR_FORMAT },
    { "4 4 4\n1\n", "four integers", VG_ERR_FORMAT },
    { "4 4 4 1\ntitle\n1 1 1 2 3\n", "truncated", VG_ERR_FORMAT },
    { "99999999999 4 4 1\ntitle\n1 1 1 2 3\n", "truncated", VG_ERR_FORMAT },
    { "-1 4 4 1\ntitle\n1 1 1 2 3\n", "truncated", VG_ERR_FORMAT },
    { "1 4 4 1\ntitle\n1 1 1 2 5\n", "face 1 refers to point 5", VG_ERR_INPUT },
    { "1 4 4 1\ntitle\n1 1 1 2 x\n", "case.bc:3:", VG_ERR_FORMAT },
    { "1 4 4 1\ntitle\n1 5000000000 1 2 3\n", "32 bits", VG_ERR_FORMAT },
  };

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    expect(t1_cogsg, sizeof t1_cogsg, cases[i].bc, cases[i].code,
           cases[i].phrase);
}

static void the_bc_must_be_in_the_same_folder(void **state)
{
  const char *path = io_temp("vgrid_alone.cogsg");
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  io_write_file(path, t1_cogsg, sizeof t1_cogsg);
  assert_int_equal(vg_cogsg_read(path, &m, NULL, NULL, &err), VG_ERR_IO);
  assert_non_null(strstr(err.text, "vgrid_alone.bc"));
  unlink(path);
}

static void survives_damage(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  unsigned char work[sizeof t1_cogsg];
  char text[sizeof t1_bc];
  uint32_t seed = 99;

  (void)state;
  for (size_t cut = 0; cut < sizeof t1_cogsg; cut++) {
    vg_status st = parse_pair(t1_cogsg, cut, t1_bc, sizeof t1_bc - 1, &m, NULL,
                              &err);

    /* The data after the coordinates are not needed. */
    if (st == VG_OK) assert_true(cut >= 160);
    vg_mesh_release(&m);
  }
  for (size_t cut = 0; cut + 1 < sizeof t1_bc; cut++) {
    parse_pair(t1_cogsg, sizeof t1_cogsg, t1_bc, cut, &m, NULL, &err);
    vg_mesh_release(&m);
  }
  for (int turn = 0; turn < 20000; turn++) {
    memcpy(work, t1_cogsg, sizeof work);
    memcpy(text, t1_bc, sizeof text);
    for (int k = 0; k < 1 + turn % 3; k++) {
      seed = seed * 1664525u + 1013904223u;
      if (turn & 4) text[(seed >> 8) % (sizeof text - 1)] = (char)(seed >> 24);
      else work[(seed >> 8) % sizeof work] = (unsigned char)(seed >> 24);
    }
    parse_pair(work, sizeof work, text, sizeof text - 1, &m, NULL, &err);
    vg_mesh_release(&m);
  }
}

/* VGRID's own file, read and written: the same bytes (formats.md 1.2). */
static void reproduces_box(void **state)
{
  char bc[1024];
  const char *path = io_real("vgrid_box/box.cogsg");
  const char *stem = io_temp("vgrid_box");
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_cogsg_info info;
  struct vg_turned turned;
  struct vg_error err = VG_ERROR_INIT;
  unsigned char *want;
  size_t size;

  (void)state;
  if (vg_cogsg_read(path, &m, &info, &turned, &err)) fail_msg("%s", err.text);
  assert_int_equal(m.n_tet, 63926);
  assert_int_equal(m.n_point, 12440);
  assert_int_equal(m.n_tri, 6810);
  assert_int_equal(m.n_patch, 6);
  assert_int_equal(info.n_boundary, 3407);
  assert_int_equal(info.n_layer_point, 10907);
  assert_int_equal(info.n_layer_cell, 51564);
  assert_int_equal(info.n_curve_point, 284);
  assert_int_equal(info.n_trailing, 1);
  assert_int_equal(turned.cell + turned.face + turned.loose_face, 0);
  if (vg_cogsg_write(stem, &m, &info, 0, NULL, &err)) fail_msg("%s", err.text);
  want = io_slurp(path, &size);
  compare_file(with(stem, ".cogsg"), want, size);
  free(want);
  snprintf(bc, sizeof bc, "%s", io_real("vgrid_box/box.bc"));
  want = io_slurp(bc, &size);
  compare_file(with(stem, ".bc"), want, size);
  free(want);
  unlink_triple(stem);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(writes_t1_byte_for_byte),
    cmocka_unit_test(reads_t1),
    cmocka_unit_test(reads_other_layouts),
    cmocka_unit_test(points_are_put_in_vgrids_order),
    cmocka_unit_test(subrecords_are_written_and_joined),
    cmocka_unit_test(refuses_other_cells),
    cmocka_unit_test(bad_headers_are_named),
    cmocka_unit_test(bad_bc_files_are_named),
    cmocka_unit_test(the_bc_must_be_in_the_same_folder),
    cmocka_unit_test(survives_damage),
    cmocka_unit_test(reproduces_box),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
