/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include "io/mesh/vtu.h"

/* A parsed file: attributes by plain text search, arrays by the offsets that
 * they declare. */
struct vtu {
  unsigned char *data;
  size_t size, raw; /* raw: first byte after the '_' */
};

static struct vtu load(const char *path)
{
  struct vtu v;
  const char *mark = "<AppendedData encoding=\"raw\">\n_";
  char *at;

  v.data = io_slurp(path, &v.size);
  at = strstr((char *)v.data, mark);
  assert_non_null(at);
  v.raw = (size_t)((unsigned char *)at - v.data) + strlen(mark);
  assert_memory_equal(v.data + v.size - 11, "</VTKFile>\n", 11);
  return v;
}

/* Data of a named array; *bytes is the length stored before them. */
static const void *array(const struct vtu *v, const char *type,
                         const char *name, size_t *bytes)
{
  char text[200];
  const char *at;
  uint64_t n;
  size_t offset;

  snprintf(text, sizeof text, "<DataArray type=\"%s\" Name=\"%s\"", type, name);
  at = strstr((const char *)v->data, text);
  if (!at) fail_msg("no array %s %s", type, name);
  at = strstr(at, "offset=\"");
  offset = (size_t)strtoull(at + 8, NULL, 10);
  assert_true(v->raw + offset + 8 <= v->size);
  memcpy(&n, v->data + v->raw + offset, sizeof n);
  assert_true(n <= v->size - v->raw - offset - 8);
  *bytes = (size_t)n;
  return v->data + v->raw + offset + 8;
}

static void expect_array(const struct vtu *v, const char *type,
                         const char *name, const void *want, size_t n)
{
  size_t bytes;
  const void *got = array(v, type, name, &bytes);

  assert_int_equal(bytes, n);
  assert_memory_equal(got, want, n);
}

static void writes_the_documented_layout(void **state)
{
  static const int64_t connectivity[4] = { 0, 1, 2, 3 }, offset = 4;
  static const unsigned char type = 10;
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("t1.vtu");
  struct vtu v;

  (void)state;
  io_make_t1(&m, 1);
  assert_int_equal(vg_vtu_write(path, &m, NULL, 0, &err), VG_OK);
  v = load(path);
  assert_non_null(strstr((char *)v.data, "NumberOfPoints=\"4\" "
                                         "NumberOfCells=\"1\""));
  assert_non_null(strstr((char *)v.data, "header_type=\"UInt64\""));
  assert_non_null(strstr((char *)v.data, "offset=\"104\""));
  assert_non_null(strstr((char *)v.data, "offset=\"144\""));
  assert_non_null(strstr((char *)v.data, "offset=\"160\""));
  expect_array(&v, "Float64", "Points", m.point, 96);
  expect_array(&v, "Int64", "connectivity", connectivity, 32);
  expect_array(&v, "Int64", "offsets", &offset, 8);
  expect_array(&v, "UInt8", "types", &type, 1);
  free(v.data);
  vg_mesh_release(&m);
}

static void writes_every_cell_in_vtk_order(void **state)
{
  static const int64_t connectivity[23] = { 5,  6, 10, 11, 7, 4, 5, 6,
                                            10, 8, 1,  2,  9, 5, 6, 0,
                                            1,  2, 3,  4,  5, 6, 7 };
  static const int64_t offsets[4] = { 4, 9, 15, 23 };
  static const unsigned char types[4] = { 10, 14, 13, 12 };
  static const float quality[4] = { 0.25f, 1, 2, 3 };
  static const int32_t level[4] = { 4, -3, 2, 1 };
  double vector[13][3];
  struct vg_vtu_field field[3] = {
    { "quality", VG_VTU_CELL, VG_VTU_FLOAT32, 1, quality },
    { "direction", VG_VTU_POINT, VG_VTU_FLOAT64, 3, vector },
    { "level", VG_VTU_CELL, VG_VTU_INT32, 0, level },
  };
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("mixed.vtu");
  struct vtu v;

  (void)state;
  for (int i = 0; i < 39; i++) vector[i / 3][i % 3] = i * 0.1;
  io_make_mixed(&m);
  if (vg_vtu_write(path, &m, field, 3, &err) != VG_OK) fail_msg("%s", err.text);
  v = load(path);
  expect_array(&v, "Int64", "connectivity", connectivity, sizeof connectivity);
  expect_array(&v, "Int64", "offsets", offsets, sizeof offsets);
  expect_array(&v, "UInt8", "types", types, sizeof types);
  expect_array(&v, "Float32", "quality", quality, sizeof quality);
  expect_array(&v, "Float64", "direction", vector, sizeof vector);
  expect_array(&v, "Int32", "level", level, sizeof level);
  free(v.data);
  vg_mesh_release(&m);
}

/* Points that no boundary face uses are left out, also of point fields. */
static void writes_the_boundary_alone(void **state)
{
  static const int64_t connectivity[18] = { 1, 7, 2, 4, 6, 8, 0, 1, 2,
                                            3, 0, 4, 5, 1, 0, 3, 6, 4 };
  static const int32_t patch[5] = { -7, 20, -7, 3, 20 };
  static const unsigned char types[5] = { 5, 5, 9, 9, 9 };
  /* Points 6, 9, 11, 12 are not used: 7, 8, 10 become 6, 7, 8. */
  static const int32_t kept[9] = { 0, 1, 2, 3, 4, 5, 7, 8, 10 };
  int32_t number[13];
  struct vg_vtu_field field = { "number", VG_VTU_POINT, VG_VTU_INT32, 1,
                                number };
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("boundary.vtu");
  struct vtu v;

  (void)state;
  for (int i = 0; i < 13; i++) number[i] = i;
  io_make_mixed(&m);
  if (vg_vtu_write_boundary(path, &m, &field, 1, &err) != VG_OK)
    fail_msg("%s", err.text);
  v = load(path);
  expect_array(&v, "Int64", "connectivity", connectivity, sizeof connectivity);
  expect_array(&v, "Int32", "patch", patch, sizeof patch);
  expect_array(&v, "UInt8", "types", types, sizeof types);
  expect_array(&v, "Int32", "number", kept, sizeof kept);
  free(v.data);
  vg_mesh_release(&m);
}

static void a_surface_is_written_as_a_surface(void **state)
{
  static const int32_t patch[4] = { 1, 2, 3, 4 };
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("surface.vtu");
  struct vtu v;

  (void)state;
  io_make_t1(&m, 0);
  assert_int_equal(vg_vtu_write(path, &m, NULL, 0, &err), VG_OK);
  v = load(path);
  expect_array(&v, "Int32", "patch", patch, sizeof patch);
  expect_array(&v, "Float64", "Points", m.point, 96);
  free(v.data);
  vg_mesh_release(&m);
}

static void writes_loose_triangles(void **state)
{
  static const double point[3][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } };
  static const uint32_t tri[1][3] = { { 0, 1, 2 } };
  static const int32_t kind[1] = { 7 };
  struct vg_vtu_field field = { "kind", VG_VTU_CELL, VG_VTU_INT32, 1, kind };
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("loose.vtu");
  struct vtu v;

  (void)state;
  assert_int_equal(vg_vtu_write_triangles(path, 3, point, 1, tri, &field, 1,
                                          &err),
                   VG_OK);
  v = load(path);
  expect_array(&v, "Int32", "kind", kind, sizeof kind);
  free(v.data);
  assert_int_equal(vg_vtu_write_triangles(path, 0, NULL, 0, NULL, NULL, 0,
                                          &err),
                   VG_OK);
  v = load(path);
  free(v.data);
}

static void refuses_bad_names_and_places(void **state)
{
  static const int32_t kind[1] = { 7 };
  struct vg_vtu_field field = { "a\"b", VG_VTU_CELL, VG_VTU_INT32, 1, kind };
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  io_make_t1(&m, 1);
  assert_int_equal(vg_vtu_write(io_temp("name.vtu"), &m, &field, 1, &err),
                   VG_ERR_INPUT);
  field.name = "";
  assert_int_equal(vg_vtu_write(io_temp("name.vtu"), &m, &field, 1, &err),
                   VG_ERR_INPUT);
  assert_int_equal(access(io_temp("name.vtu"), F_OK), -1);
  assert_int_equal(vg_vtu_write(io_temp("no/such/folder.vtu"), &m, NULL, 0,
                                &err),
                   VG_ERR_IO);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(writes_the_documented_layout),
    cmocka_unit_test(writes_every_cell_in_vtk_order),
    cmocka_unit_test(writes_the_boundary_alone),
    cmocka_unit_test(a_surface_is_written_as_a_surface),
    cmocka_unit_test(writes_loose_triangles),
    cmocka_unit_test(refuses_bad_names_and_places),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
