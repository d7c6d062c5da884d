/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "mixed_support.h"

#include "io/mesh/ugrid.h"

static const char *const suffix[] = { "ugrid",      "b8.ugrid",   "lb8.ugrid",
                                      "b4.ugrid",   "lb4.ugrid",  "r8.ugrid",
                                      "lr8.ugrid",  "r4.ugrid",   "lr4.ugrid",
                                      "b8l.ugrid",  "lb8l.ugrid", "b8.ugrid64",
                                      "lb8.ugrid64" };
#define N_SUFFIX (sizeof suffix / sizeof suffix[0])

static const char t1_text[] =
  "4 4 0 1 0 0 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 2 3\n1 4 2\n1 3 4\n2 4 3\n"
  "1\n2\n3\n4\n1 2 3 4\n";

static vg_status parse_text(struct vg_input *in, struct vg_mesh *m,
                            struct vg_error *err)
{
  struct vg_ugrid_kind kind;

  assert_true(vg_ugrid_kind("ugrid", &kind));
  return vg_ugrid_parse(in, &kind, m, NULL, err);
}

static vg_status parse_b8(struct vg_input *in, struct vg_mesh *m,
                          struct vg_error *err)
{
  struct vg_ugrid_kind kind;

  assert_true(vg_ugrid_kind("b8.ugrid", &kind));
  return vg_ugrid_parse(in, &kind, m, NULL, err);
}

static const char *path_of(const char *stem, const char *kind)
{
  char name[64];

  snprintf(name, sizeof name, "%s.%s", stem, kind);
  return io_temp(name);
}

static void knows_its_names(void **state)
{
  struct vg_ugrid_kind k;

  (void)state;
  assert_true(vg_ugrid_kind("/a.b8/x.ugrid", &k) && k.is_text);
  assert_true(vg_ugrid_kind("x.B8.UGRID", &k) && !k.is_text && k.is_big);
  assert_true(vg_ugrid_kind("x.lb8l.ugrid.gz", &k) && k.int_size == 8);
  assert_false(k.is_big);
  assert_true(vg_ugrid_kind("x.lr4.ugrid", &k) && k.is_record);
  assert_int_equal(k.real_size, 4);
  assert_true(vg_ugrid_kind("x.lb8.ugrid64", &k) && k.int_size == 8);
  assert_true(vg_ugrid_kind("x.c9.ugrid", &k) && k.is_text);
  assert_false(vg_ugrid_kind("x.ugrid64", &k));
  assert_false(vg_ugrid_kind("x.r8.ugrid64", &k));
  assert_false(vg_ugrid_kind("ugri", &k));
  assert_false(vg_ugrid_kind("xugrid", &k));
  assert_false(vg_ugrid_kind("", &k));
}

static void reads_the_sample(void **state)
{
  struct vg_mesh m = VG_MESH_INIT, t1;

  (void)state;
  io_accept(parse_text, t1_text, &m);
  io_make_t1(&t1, 1);
  io_same(&t1, &m, 1);
  vg_mesh_release(&m);
  vg_mesh_release(&t1);
}

/* Layout of formats.md 2.2 in both byte orders, byte by byte. */
static void writes_t1_byte_for_byte(void **state)
{
  struct vg_mesh t1;
  struct vg_error err = VG_ERROR_INIT;
  unsigned char *data;
  size_t size;

  (void)state;
  io_make_t1(&t1, 1);
  for (int big = 0; big < 2; big++) {
    const char *path = path_of("t1", big ? "b8.ugrid" : "lb8.ugrid");
    static const int32_t counts[7] = { 4, 4, 0, 1, 0, 0, 0 };
    static const int32_t tail[20] = { 1, 2, 3, 1, 4, 2, 1, 3, 4, 2,
                                      4, 3, 1, 2, 3, 4, 1, 2, 3, 4 };
    unsigned char want[28 + 96 + 80];
    size_t n = 0;

    for (int k = 0; k < 7; k++, n += 4)
      for (int b = 0; b < 4; b++)
        want[n + (size_t)b] = (unsigned char)((uint32_t)counts[k] >>
                                              8 * (big ? 3 - b : b));
    for (int k = 0; k < 12; k++, n += 8) {
      uint64_t bits;

      memcpy(&bits, (double *)t1.point + k, 8);
      for (int b = 0; b < 8; b++)
        want[n + (size_t)b] = (unsigned char)(bits >> 8 * (big ? 7 - b : b));
    }
    for (int k = 0; k < 20; k++, n += 4)
      for (int b = 0; b < 4; b++)
        want[n + (size_t)b] = (unsigned char)((uint32_t)tail[k] >>
                                              8 * (big ? 3 - b : b));
    assert_int_equal(vg_ugrid_write(path, &t1, &err), VG_OK);
    data = io_slurp(path, &size);
    assert_int_equal(size, sizeof want);
    assert_memory_equal(data, want, size);
    free(data);
    unlink(path);
  }
  vg_mesh_release(&t1);
}

/* Every kind of cell and face, every variant of the file. The coordinates are
 * first rounded to single precision if the file does that. */
static void every_variant_round_trips(void **state)
{
  (void)state;
  for (size_t i = 0; i < N_SUFFIX; i++) {
    const char *path = path_of("mixed", suffix[i]);
    struct vg_mesh m, back = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;
    struct vg_turned turned;
    uint64_t count[7];

    io_make_mixed(&m);
    if (strchr(suffix[i], '4') && !strstr(suffix[i], "64"))
      for (size_t p = 0; p < m.n_point; p++)
        for (int k = 0; k < 3; k++) {
          /* volatile: gcc 12 -O3 loses the rounding of such a loop. */
          volatile float narrow = (float)m.point[p][k];

          m.point[p][k] = narrow;
        }
    if (vg_ugrid_write(path, &m, &err) != VG_OK) fail_msg("%s", err.text);
    if (vg_ugrid_read(path, &back, &turned, &err) != VG_OK)
      fail_msg("%s", err.text);
    io_same(&m, &back, 0);
    assert_int_equal(turned.cell, 0);
    assert_int_equal(turned.face, 0);
    assert_int_equal(turned.loose_face, 0);
    assert_int_equal(vg_ugrid_peek(path, count, &err), VG_OK);
    assert_true(count[0] == 13 && count[2] == 3 && count[6] == 1);
    unlink(path);
    vg_mesh_release(&m);
    vg_mesh_release(&back);
  }
}

static void surfaces_round_trip(void **state)
{
  (void)state;
  for (size_t i = 0; i < N_SUFFIX; i++) {
    const char *path = path_of("surface", suffix[i]);
    struct vg_mesh m, back = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;

    io_make_t1(&m, 0);
    assert_int_equal(vg_ugrid_write(path, &m, &err), VG_OK);
    if (vg_ugrid_read(path, &back, NULL, &err) != VG_OK)
      fail_msg("%s", err.text);
    io_same(&m, &back, 0);
    unlink(path);
    vg_mesh_release(&m);
    vg_mesh_release(&back);
  }
}

static void mirrored_cells_and_faces_are_turned(void **state)
{
  const char *path = path_of("turned", "b8.ugrid");
  struct vg_mesh m, back = VG_MESH_INIT, again = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_turned turned;

  (void)state;
  io_make_mixed(&m);
  for (size_t p = 0; p < m.n_point; p++) m.point[p][0] *= -1;
  assert_int_equal(vg_ugrid_write(path, &m, &err), VG_OK);
  assert_int_equal(vg_ugrid_read(path, &back, &turned, &err), VG_OK);
  assert_int_equal(turned.cell, 4);
  assert_int_equal(turned.face, 5);
  assert_int_equal(turned.loose_face, 0);
  assert_int_equal(vg_ugrid_write(path, &back, &err), VG_OK);
  assert_int_equal(vg_ugrid_read(path, &again, &turned, &err), VG_OK);
  assert_int_equal(turned.cell + turned.face, 0);
  io_same(&back, &again, 0);
  unlink(path);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
  vg_mesh_release(&again);
}

static void a_misspelt_name_gets_a_suggestion(void **state)
{
  static const struct {
    const char *as, *named, *phrase;
  } cases[] = {
    { "lb8.ugrid", "b8.ugrid", "rename it to .lb8.ugrid" },
    { "b8.ugrid", "lb8.ugrid", "rename it to .b8.ugrid" },
    { "b8.ugrid", "b4.ugrid", "rename it to .b8.ugrid" },
    { "lb4.ugrid", "lb8.ugrid", "rename it to .lb4.ugrid" },
    { "r8.ugrid", "b8.ugrid", "rename it to .r8.ugrid" },
    { "b8.ugrid", "r8.ugrid", "rename it to .b8.ugrid" },
    { "b8l.ugrid", "b8.ugrid", "rename it to .b8l.ugrid" },
    { "ugrid", "b8.ugrid", "holds text" },
    { "b8.ugrid", "ugrid", "binary" },
  };
  struct vg_mesh m, back = VG_MESH_INIT;

  (void)state;
  io_make_mixed(&m);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const char *from = path_of("wrong", cases[i].as);
    const char *to = path_of("wrong_to", cases[i].named);
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(vg_ugrid_write(from, &m, &err), VG_OK);
    assert_int_equal(rename(from, to), 0);
    assert_int_equal(vg_ugrid_read(to, &back, NULL, &err), VG_ERR_FORMAT);
    if (!strstr(err.text, cases[i].phrase) || !strstr(err.text, to))
      fail_msg("%s has no '%s'", err.text, cases[i].phrase);
    assert_null(back.point);
    unlink(to);
  }
  vg_mesh_release(&m);
}

static void tails_are_ignored(void **state)
{
  const char *path = path_of("tail", "lb8.ugrid");
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  unsigned char *data;
  size_t size;

  (void)state;
  io_make_t1(&m, 1);
  assert_int_equal(vg_ugrid_write(path, &m, &err), VG_OK);
  data = io_slurp(path, &size);
  data = realloc(data, size + 12);
  memset(data + size, 0, 12);
  for (size_t more = 1; more <= 12; more++) {
    io_write_file(path, data, size + more);
    assert_int_equal(vg_ugrid_read(path, &back, NULL, &err), VG_OK);
    io_same(&m, &back, 0);
    vg_mesh_release(&back);
  }
  io_write_gzip(path, data, size);
  assert_int_equal(vg_ugrid_read(path, &back, NULL, &err), VG_OK);
  io_same(&m, &back, 0);
  free(data);
  unlink(path);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

/* The tail follows the data written without it, in the kind's own integers and
 * records, and readers ignore it. */
static void the_number_of_layer_tetrahedra_follows(void **state)
{
  static const struct {
    const char *suffix;
    size_t size, at;
    int big;
  } kind[] = { { "b8.ugrid", 4, 0, 1 },   { "lb8.ugrid", 4, 0, 0 },
               { "lb4.ugrid", 4, 0, 0 },  { "b8l.ugrid", 8, 0, 1 },
               { "lb8l.ugrid", 8, 0, 0 }, { "r8.ugrid", 12, 4, 1 },
               { "lr4.ugrid", 12, 4, 0 }, { "ugrid", 3, 0, 0 } };
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  mixed_make(&m, 3, 2);
  for (size_t i = 0; i < sizeof kind / sizeof *kind; i++) {
    const char *path = path_of("tail", kind[i].suffix);
    size_t plain, size, value = 0, width = kind[i].size == 8 ? 8 : 4;
    unsigned char *a, *b;

    assert_int_equal(vg_ugrid_write(path, &m, &err), VG_OK);
    a = io_slurp(path, &plain);
    assert_int_equal(vg_ugrid_write_tail(path, &m, 11, &err), VG_OK);
    b = io_slurp(path, &size);
    assert_int_equal(size, plain + kind[i].size);
    assert_memory_equal(a, b, plain);
    if (kind[i].size == 3) {
      assert_string_equal((char *)b + plain, "11\n");
    } else {
      for (size_t k = 0; k < width; k++)
        value = value << 8 |
                b[plain + kind[i].at + (kind[i].big ? k : width - 1 - k)];
      assert_int_equal(value, 11);
    }
    if (vg_ugrid_read(path, &back, NULL, &err)) fail_msg("%s", err.text);
    assert_int_equal(back.n_tet, m.n_tet);
    vg_mesh_release(&back);
    free(a);
    free(b);
    unlink(path);
  }
  assert_int_equal(vg_ugrid_write_tail(path_of("tail", "b8.ugrid"), &m, 13,
                                       &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "13 layer tetrahedra"));
  assert_true(access(path_of("tail", "b8.ugrid"), F_OK) != 0);
  vg_mesh_release(&m);
}

/* The faces of mixed_support.h, coded independently, close a mesh of all kinds
 * and point out of it; the reader finds nothing to reverse. */
static void a_closed_mesh_of_all_kinds_is_right(void **state)
{
  const char *path = path_of("closed", "b8.ugrid");
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_turned turned;

  (void)state;
  mixed_make(&m, 4, 3);
  assert_int_equal(vg_ugrid_write(path, &m, &err), VG_OK);
  assert_int_equal(vg_ugrid_read(path, &back, &turned, &err), VG_OK);
  assert_int_equal(turned.cell + turned.face + turned.loose_face, 0);
  io_same(&m, &back, 0);
  unlink(path);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

static void bad_values_are_named(void **state)
{
  (void)state;
  io_refuse(parse_text, "4 4 0 1 0 0", VG_ERR_FORMAT, "hexahedra");
  io_refuse(parse_text, "-4 4 0 1 0 0 0", VG_ERR_FORMAT, "number of points");
  io_refuse(parse_text, "4000000000 4 0 1 0 0 0 1 2 3", VG_ERR_FORMAT,
            "truncated");
  io_refuse(parse_text, "99999999999 4 0 1 0 0 0", VG_ERR_FORMAT,
            "99999999999");
  io_refuse(parse_text, "3 1 0 0 0 0 0\n0 0 0\n1 0 nan\n0 1 0\n1 2 3\n1\n",
            VG_ERR_FORMAT, "case:3:");
  io_refuse(parse_text, "3 1 0 0 0 0 0\n0 0 0\n1 0 0\n0 1 0\n1 2 4\n1\n",
            VG_ERR_INPUT, "triangle 1 refers to point 4");
  io_refuse(parse_text, "3 1 0 0 0 0 0\n0 0 0\n1 0 0\n0 1 0\n1 2 0\n1\n",
            VG_ERR_INPUT, "points are numbered 1 to 3");
  io_refuse(parse_text, "3 1 0 0 0 0 0\n0 0 0\n1 0 0\n0 1 0\n1 2 3\n9e9\n",
            VG_ERR_FORMAT, "surface tag");
  io_refuse(parse_b8, "", VG_ERR_FORMAT, "empty");
}

static void binary_values_are_checked(void **state)
{
  const char *path = path_of("bad", "b8.ugrid");
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  unsigned char *data;
  size_t size;

  (void)state;
  io_make_t1(&m, 1);
  assert_int_equal(vg_ugrid_write(path, &m, &err), VG_OK);
  data = io_slurp(path, &size);
  data[28 + 24 + 8] = 0x7f; /* y of point 2 */
  data[28 + 24 + 9] = 0xf8;
  io_refuse_bytes(parse_b8, data, size, VG_ERR_INPUT,
                  "coordinate y of point 2 is not a finite");
  data[28 + 24 + 8] = data[28 + 24 + 9] = 0;
  data[size - 1] = 5;
  io_refuse_bytes(parse_b8, data, size, VG_ERR_INPUT,
                  "tetrahedron 1 refers to point 5");
  data[size - 1] = 0;
  io_refuse_bytes(parse_b8, data, size, VG_ERR_INPUT,
                  "tetrahedron 1 refers to point 0");
  /* A count that the file cannot hold, up to values that overflow. */
  for (int k = 0; k < 7; k++) {
    unsigned char old[4];

    memcpy(old, data + 4 * k, 4);
    memset(data + 4 * k, 0x7f, 4);
    io_refuse_bytes(parse_b8, data, size, VG_ERR_FORMAT, "truncated");
    memset(data + 4 * k, 0xff, 4);
    io_refuse_bytes(parse_b8, data, size, VG_ERR_FORMAT, "truncated");
    memcpy(data + 4 * k, old, 4);
  }
  free(data);
  unlink(path);
  vg_mesh_release(&m);
}

static void try_bytes(const char *kind_name, const unsigned char *data,
                      size_t size, int must_fail)
{
  struct vg_ugrid_kind kind;
  struct vg_input in = VG_INPUT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_true(vg_ugrid_kind(kind_name, &kind));
  if (vg_input_memory("case", data, size, &in, &err) == VG_OK) {
    vg_status st = vg_ugrid_parse(&in, &kind, &m, NULL, &err);

    assert_true(st < 0 || !must_fail);
    assert_true(st == VG_OK || err.text[0]);
    if (st < 0) assert_null(m.point);
  }
  vg_input_release(&in);
  vg_mesh_release(&m);
}

/* Truncated at every byte and with bytes modified: an answer, never a crash
 * (the sanitizers watch). Truncated binary files must be refused. */
static void survives_damage(void **state)
{
  (void)state;
  for (size_t i = 0; i < N_SUFFIX; i++) {
    const char *path = path_of("damage", suffix[i]);
    struct vg_mesh m;
    struct vg_error err = VG_ERROR_INIT;
    unsigned char *data, *work;
    size_t size;
    uint32_t seed = 12345;

    io_make_mixed(&m);
    assert_int_equal(vg_ugrid_write(path, &m, &err), VG_OK);
    data = io_slurp(path, &size);
    work = malloc(size);
    for (size_t cut = 0; cut < size; cut++)
      try_bytes(suffix[i], data, cut, i > 0);
    for (int turn = 0; turn < 2000; turn++) {
      memcpy(work, data, size);
      for (int k = 0; k < 1 + turn % 3; k++) {
        seed = seed * 1664525u + 1013904223u;
        work[(seed >> 8) % size] = (unsigned char)(seed >> 24);
      }
      try_bytes(suffix[i], work, size, 0);
    }
    free(data);
    free(work);
    unlink(path);
    vg_mesh_release(&m);
  }
}

static void many_tags_cost_no_quadratic_time(void **state)
{
  const size_t n = 300000;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  int32_t *tag = malloc(n * sizeof *tag);

  (void)state;
  m.n_tri = n;
  for (size_t i = 0; i < n; i++) tag[i] = (int32_t)(i * 2654435761u);
  assert_int_equal(vg_patches_from_tags(&m, tag, &err), VG_OK);
  assert_int_equal(m.n_patch, n);
  for (size_t i = 0; i < n; i++)
    assert_int_equal(m.patch[m.tri_patch[i]].id, tag[i]);
  for (size_t i = 1; i < n; i++) assert_true(m.patch[i].id > m.patch[i - 1].id);
  m.n_tri = 0;
  vg_mesh_release(&m);
  free(tag);
}

static void reads_real_files(void **state)
{
  static const struct {
    const char *name;
    size_t n_tri, n_tet, n_pri;
  } files[] = {
    { "transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz", 33298, 0, 0 },
    { "transport/dlr_f6_wbnp_half_medium.lb8.ugrid.xz", 111410, 0, 0 },
    { "transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz", 22278, 0, 0 },
    { "bizjet/falcon_full_mirrored.lb8.ugrid.xz", 74754, 0, 0 },
    { "bizjet/p180_avanti_full.lb8.ugrid.xz", 72546, 0, 0 },
    { "supersonic/low_boom_sst_full.lb8.ugrid.xz", 42832, 0, 0 },
    { "supersonic/concorde_full.lb8.ugrid.xz", 67102, 0, 0 },
    { "supersonic/f16_full.lb8.ugrid.xz", 72718, 0, 0 },
    { "supersonic/tmx1242_wing_body.lb8.ugrid.xz", 30856, 0, 0 },
    { "supersonic/tnd6480_delta_wing_body.lb8.ugrid.xz", 91444, 0, 0 },
    { "highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz", 34688, 0, 0 },
    { "highlift/30p30n_swept_wing_in_box_medium.lb8.ugrid.xz", 109758, 0, 0 },
    { "simple/hemisphere_cylinder_farfield.lb8.ugrid.xz", 5308, 0, 0 },
    { "simple/cone_cone.lb8.ugrid.xz", 1682, 0, 0 },
    { "simple/cape_cigar_viscous_volume.lb8.ugrid.xz", 2710, 38604, 85900 },
  };

  (void)state;
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    const char *path = io_real(files[i].name);
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;
    struct vg_turned turned;

    if (vg_ugrid_read(path, &m, &turned, &err) != VG_OK)
      fail_msg("%s", err.text);
    assert_int_equal(m.n_tri, files[i].n_tri);
    assert_int_equal(m.n_tet, files[i].n_tet);
    assert_int_equal(m.n_pri, files[i].n_pri);
    assert_true(m.n_patch > 0);
    assert_int_equal(turned.cell + turned.face + turned.loose_face, 0);
    assert_int_equal(io_bad_edges(&m), 0);
    vg_mesh_release(&m);
    unlink(path);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(knows_its_names),
    cmocka_unit_test(reads_the_sample),
    cmocka_unit_test(writes_t1_byte_for_byte),
    cmocka_unit_test(every_variant_round_trips),
    cmocka_unit_test(surfaces_round_trip),
    cmocka_unit_test(mirrored_cells_and_faces_are_turned),
    cmocka_unit_test(a_misspelt_name_gets_a_suggestion),
    cmocka_unit_test(tails_are_ignored),
    cmocka_unit_test(the_number_of_layer_tetrahedra_follows),
    cmocka_unit_test(a_closed_mesh_of_all_kinds_is_right),
    cmocka_unit_test(bad_values_are_named),
    cmocka_unit_test(binary_values_are_checked),
    cmocka_unit_test(survives_damage),
    cmocka_unit_test(many_tags_cost_no_quadratic_time),
    cmocka_unit_test(reads_real_files),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
