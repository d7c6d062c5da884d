/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include "io/mesh/medit.h"

static const char sample[] =
  "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n"
  "0 1 0 0\n0 0 1 0\nTriangles\n4\n1 2 3 1\n1 4 2 2\n1 3 4 3\n2 4 3 4\n"
  "Tetrahedra\n1\n1 2 3 4 0\nEnd\n";

/* A negative tetrahedron, faces that point out of it, sections in another
 * order, and sections to skip. */
static const char turned[] =
  "MeshVersionFormatted\n1\n\nDimension\n3\n# comment Triangles\n"
  "Triangles 2 1 3 2 1 1 2 4 2\nCorners 2 1 2\nRequiredTriangles 1 1\n"
  "NewFangled 2 1.5 -2e3\nTetrahedra 1 2 1 3 4 9\n"
  "Edges 1 1 2 5\n"
  "Vertices 4 0 0 0 7 1 0 0 7 0 1 0 7 0 0 1 7\nEnd";

static void reads_the_sample(void **state)
{
  struct vg_mesh m = VG_MESH_INIT, t1;

  (void)state;
  io_accept(vg_medit_parse, sample, &m);
  io_make_t1(&t1, 1);
  io_same(&t1, &m, 0);
  vg_mesh_release(&m);
  vg_mesh_release(&t1);
}

static void turns_cells_and_faces(void **state)
{
  static const uint32_t tri[2][3] = { { 0, 1, 2 }, { 0, 3, 1 } };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_accept(vg_medit_parse, turned, &m);
  assert_int_equal(m.n_point, 4);
  assert_int_equal(m.n_tet, 1);
  assert_int_equal(m.n_tri, 2);
  for (size_t i = 0; i < 2; i++) {
    /* Same cycle, whatever its first node. */
    size_t k = 0;

    while (k < 2 && m.tri[i][k] != 0) k++;
    for (size_t j = 0; j < 3; j++)
      assert_int_equal(m.tri[i][(k + j) % 3], tri[i][j]);
  }
  assert_int_equal(m.patch[m.tri_patch[1]].id, 2);
  vg_mesh_release(&m);
}

/* A boundary quadrilateral that runs across the diagonals of a pyramid's base
 * is not a face of the pyramid: it stays as it was read. */
static void crossed_quads_are_kept(void **state)
{
  static const uint32_t quad[4] = { 2, 0, 1, 3 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  for (int crossed = 0; crossed < 2; crossed++) {
    io_accept(
      vg_medit_parse,
      crossed ? "MeshVersionFormatted 2 Dimension 3 Vertices 5 0 0 0 0 1 0 0 0 "
                "1 1 0 0 0 1 0 0 .5 .5 1 0 Quadrilaterals 1 3 1 2 4 1 "
                "Pyramids 1 1 2 3 4 5 0 End"
              : "MeshVersionFormatted 2 Dimension 3 Vertices 5 0 0 0 0 1 0 0 0 "
                "1 1 0 0 0 1 0 0 .5 .5 1 0 Quadrilaterals 1 1 4 3 2 1 "
                "Pyramids 1 1 2 3 4 5 0 End",
      &m);
    assert_int_equal(m.n_quad, 1);
    if (crossed) assert_memory_equal(m.quad[0], quad, sizeof quad);
    else assert_int_equal(m.quad[0][1], 1); /* reversed, into the pyramid */
    vg_mesh_release(&m);
  }
}

static void surfaces_are_kept(void **state)
{
  static const uint32_t tri[3] = { 0, 2, 1 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_accept(vg_medit_parse,
            "MeshVersionFormatted 2 Dimension 3 Vertices 3 0 0 0 0 1 0 0 0 "
            "0 1 0 0 Triangles 1 1 3 2 -5 End",
            &m);
  assert_memory_equal(m.tri[0], tri, sizeof tri);
  assert_int_equal(m.patch[0].id, -5);
  vg_mesh_release(&m);
}

static void text_round_trip_is_exact(void **state)
{
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("round.mesh");

  (void)state;
  io_make_mixed(&m);
  assert_int_equal(vg_medit_write(path, &m, &err), VG_OK);
  if (vg_medit_read(path, &back, &err) != VG_OK) fail_msg("%s", err.text);
  io_same(&m, &back, 0);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

static void binary_round_trips(void **state)
{
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("round.meshb");

  (void)state;
  io_make_mixed(&m);
  assert_int_equal(vg_medit_write(path, &m, &err), VG_OK);
  if (vg_medit_read(path, &back, &err) != VG_OK) fail_msg("%s", err.text);
  io_same(&m, &back, 0);
  vg_mesh_release(&back);
  for (int version = 1; version <= 4; version++)
    for (int big = 0; big < 2; big++) {
      if (version == 1) /* single precision: use values that a float can hold */
        for (int k = 0; k < 3; k++) m.point[12][k] = 0.125 * (k + 1);
      if (vg_medit_write_binary(path, &m, version, big, &err) != VG_OK ||
          vg_medit_read(path, &back, &err) != VG_OK)
        fail_msg("%s", err.text);
      io_same(&m, &back, 0);
      vg_mesh_release(&back);
    }
  assert_int_equal(vg_medit_write_binary(path, &m, 5, 0, &err),
                   VG_ERR_UNSUPPORTED);
  vg_mesh_release(&m);
}

/* `1 2 | 3 20 3 | 4 144 4 {x y z ref} | 6 220 4 {...} | 8 252 1 {...} | 54 0`
 * in 260 bytes, as the format notes specify for T1. */
static void binary_layout_is_the_documented_one(void **state)
{
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("t1.meshb");
  unsigned char *data;
  size_t size;
  static const int32_t head[8] = { 1, 2, 3, 20, 3, 4, 144, 4 };
  static const int32_t triangles[7] = { 6, 220, 4, 1, 2, 3, 1 };
  static const int32_t tail[10] = { 8, 252, 1, 1, 2, 3, 4, 0, 54, 0 };

  (void)state;
  if (!vg_host_is_little()) skip();
  io_make_t1(&m, 1);
  assert_int_equal(vg_medit_write(path, &m, &err), VG_OK);
  data = io_slurp(path, &size);
  assert_int_equal(size, 260);
  assert_memory_equal(data, head, sizeof head);
  assert_memory_equal(data + 144, triangles, sizeof triangles);
  assert_memory_equal(data + 220, tail, sizeof tail);
  free(data);
  vg_mesh_release(&m);
}

static void pyramids_are_written_ring_first(void **state)
{
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("pyramid.mesh");
  unsigned char *data;
  size_t size;

  (void)state;
  io_make_mixed(&m);
  assert_int_equal(vg_medit_write(path, &m, &err), VG_OK);
  data = io_slurp(path, &size);
  assert_non_null(strstr((char *)data, "Pyramids\n1\n5 6 7 8 11 0\n"));
  free(data);
  vg_mesh_release(&m);
}

static void reads_gzip(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("sample.mesh.gz");

  (void)state;
  io_write_gzip(path, sample, strlen(sample));
  assert_int_equal(vg_medit_read(path, &m, &err), VG_OK);
  assert_int_equal(m.n_tet, 1);
  vg_mesh_release(&m);
}

#define HEAD "MeshVersionFormatted 2 Dimension 3 "
#define THREE "Vertices 3 0 0 0 0 1 0 0 0 0 1 0 0 "

static void refuses_broken_text(void **state)
{
  (void)state;
  io_refuse(vg_medit_parse, "hello", VG_ERR_FORMAT, "not a Medit file");
  io_refuse(vg_medit_parse, "MeshVersionFormatted 7", VG_ERR_FORMAT, "version");
  io_refuse(vg_medit_parse, "MeshVersionFormatted 2 Dimension 2 End",
            VG_ERR_UNSUPPORTED, "plane");
  io_refuse(vg_medit_parse, "MeshVersionFormatted 2 " THREE "End",
            VG_ERR_FORMAT, "before the dimension");
  io_refuse(vg_medit_parse, HEAD THREE "End", VG_ERR_INPUT, "no triangles");
  io_refuse(vg_medit_parse, HEAD THREE "Triangles 1 1 2 3 1", VG_ERR_FORMAT,
            "no 'End'");
  io_refuse(vg_medit_parse, HEAD THREE "Triangles 1 1 2 4 1 End", VG_ERR_INPUT,
            "vertex 4 is out of range");
  io_refuse(vg_medit_parse, HEAD THREE "Triangles 1 0 2 3 1 End", VG_ERR_INPUT,
            "vertex 0 is out of range");
  io_refuse(vg_medit_parse, HEAD THREE THREE "End", VG_ERR_FORMAT, "twice");
  io_refuse(vg_medit_parse, HEAD THREE "Triangles 1 1 2 3 3000000000 End",
            VG_ERR_UNSUPPORTED, "reference");
  io_refuse(vg_medit_parse, HEAD "Vertices 2000000000 0 0 0 0", VG_ERR_FORMAT,
            "truncated");
  io_refuse(vg_medit_parse, HEAD "Vertices -1", VG_ERR_FORMAT, "negative");
  io_refuse(vg_medit_parse, HEAD "Vertices 1 0 nan 0 0 Triangles 1 1 1 1 1",
            VG_ERR_FORMAT, "'nan'");
}

/* Truncate a good binary file at every length, and damage its positions. */
static void refuses_broken_binary(void **state)
{
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("broken.meshb");
  const double nan_value = __builtin_nan("");
  const int32_t far = 100000, back = 4, short_end = 100;
  unsigned char *data, *copy;
  size_t size;

  (void)state;
  io_make_t1(&m, 1);
  assert_int_equal(vg_medit_write(path, &m, &err), VG_OK);
  data = io_slurp(path, &size);
  copy = malloc(size);
  for (size_t n = 1; n < 252; n++) {
    struct vg_mesh out = VG_MESH_INIT;
    vg_status st = io_parse_bytes(vg_medit_parse, data, n, &out, &err);

    /* Complete sections only: a smaller but valid mesh. */
    if (st == VG_OK) assert_int_equal(n, 220);
    vg_mesh_release(&out);
  }
#define BREAK(at, value, code, phrase)                                         \
  (memcpy(copy, data, size), memcpy(copy + (at), &value, sizeof value),        \
   io_refuse_bytes(vg_medit_parse, copy, size, code, phrase))
  BREAK(24, far, VG_ERR_FORMAT, "truncated");
  BREAK(24, back, VG_ERR_FORMAT, "before it begins");
  BREAK(24, short_end, VG_ERR_FORMAT, "longer");
  BREAK(28, far, VG_ERR_FORMAT, "truncated");
  BREAK(32, nan_value, VG_ERR_INPUT, "point 1");
  BREAK(156, far, VG_ERR_INPUT, "vertex 100000 is out of range");
#undef BREAK
  free(copy);
  free(data);
  vg_mesh_release(&m);
}

/* Counts from the collection's table; the boundaries are closed, and normals
 * into the fluid enclose a negative volume. */
static void reads_real_files(void **state)
{
  static const struct {
    const char *name;
    size_t n_tri, n_tet;
    int n_patch;
  } file[] = {
    { "simple/cube_sphere_coarse_volume.meshb.xz", 3310, 26260, 7 },
    { "simple/cube_sphere_uniform_volume.meshb.xz", 700, 6533, 7 },
    { "transport/onera_m6_om6ste01.meshb.xz", 2446, 29822, 12 },
  };

  (void)state;
  for (size_t i = 0; i < sizeof file / sizeof *file; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;
    const char *path = io_real(file[i].name);

    if (vg_medit_read(path, &m, &err) != VG_OK) fail_msg("%s", err.text);
    assert_int_equal(m.n_tri, file[i].n_tri);
    assert_int_equal(m.n_tet, file[i].n_tet);
    assert_int_equal(m.n_patch, file[i].n_patch);
    assert_int_equal(io_bad_edges(&m), 0);
    assert_true(io_volume6(&m) < 0);
    unlink(path);
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_the_sample),
    cmocka_unit_test(turns_cells_and_faces),
    cmocka_unit_test(crossed_quads_are_kept),
    cmocka_unit_test(surfaces_are_kept),
    cmocka_unit_test(text_round_trip_is_exact),
    cmocka_unit_test(binary_round_trips),
    cmocka_unit_test(binary_layout_is_the_documented_one),
    cmocka_unit_test(pyramids_are_written_ring_first),
    cmocka_unit_test(reads_gzip),
    cmocka_unit_test(refuses_broken_text),
    cmocka_unit_test(refuses_broken_binary),
    cmocka_unit_test(reads_real_files),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
