/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* VTK's XML with a size at each point, in every permitted encoding. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <zlib.h>

#include "io/mesh/vtu.h"
#include "io/mesh/vtu_read.h"

enum { N = 5 };

static const double point[N][3] = {
  { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0.25, 0.5, -2 }
};
static const double size_of[N] = { 0.5, 0.25, 2, 1, 0.125 };

struct bytes {
  size_t n;
  unsigned char data[4096];
};

static void put(struct bytes *b, const void *v, size_t n)
{
  assert_true(b->n + n <= sizeof b->data);
  memcpy(b->data + b->n, v, n);
  b->n += n;
}

static void put_text(struct bytes *b, const char *s)
{
  put(b, s, strlen(s));
}

static void put_number(struct bytes *b, uint64_t v, int wide, int big)
{
  for (int k = 0; k < (wide ? 8 : 4); k++)
    put(b,
        &(unsigned char){
          (unsigned char)(v >> 8 * (big ? (wide ? 7 : 3) - k : k)) },
        1);
}

static void put_base64(struct bytes *b, const struct bytes *from)
{
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                              "abcdefghijklmnopqrstuvwxyz0123456789+/";

  for (size_t i = 0; i < from->n; i += 3) {
    uint32_t bits = 0;

    for (size_t k = 0; k < 3; k++)
      bits = bits << 8 | (i + k < from->n ? from->data[i + k] : 0);
    for (size_t k = 0; k < 4; k++)
      put(b, i + k > from->n ? "=" : &digit[bits >> (18 - 6 * k) & 63], 1);
  }
}

/* An encoding. */
struct way {
  int width, wide, big, packed, base64, appended;
};

static void put_values(struct bytes *b, const struct way *w, size_t n,
                       const double *v)
{
  for (size_t i = 0; i < n; i++) {
    float narrow = (float)v[i];
    uint64_t bits = 0;
    uint32_t few;

    memcpy(&bits, &v[i], 8);
    memcpy(&few, &narrow, 4);
    put_number(b, w->width == 8 ? bits : few, w->width == 8, w->big);
  }
}

/* The values of an array as stored in the file. */
static void encode(struct bytes *b, const struct way *w, size_t n,
                   const double *v)
{
  struct bytes raw = { .n = 0 }, head = { .n = 0 }, data = { .n = 0 };
  size_t block = 24; /* bytes, to have several blocks */

  put_values(&raw, w, n, v);
  if (w->packed) {
    size_t n_block = (raw.n + block - 1) / block;

    put_number(&head, n_block, w->wide, w->big);
    put_number(&head, block, w->wide, w->big);
    put_number(&head, raw.n % block, w->wide, w->big);
    for (size_t i = 0; i < n_block; i++) {
      size_t left = raw.n - i * block, take = left < block ? left : block;
      unsigned char packed[200];
      uLongf size = sizeof packed;

      assert_int_equal(compress(packed, &size, raw.data + i * block, take),
                       Z_OK);
      put_number(&head, size, w->wide, w->big);
      put(&data, packed, size);
    }
  } else {
    put_number(&data, raw.n, w->wide, w->big);
    put(&data, raw.data, raw.n);
  }
  if (w->base64) {
    put_base64(b, &head);
    put_base64(b, &data);
  } else {
    put(b, head.data, head.n);
    put(b, data.data, data.n);
  }
}

static void put_array(struct bytes *b, const struct way *w, const char *name,
                      int components, const double *v, struct bytes *appended)
{
  char text[300];

  snprintf(text, sizeof text,
           "<DataArray type=\"Float%d\" Name=\"%s\" "
           "NumberOfComponents=\"%d\" format=\"%s\" offset=\"%zu\"",
           8 * w->width, name, components, w->appended ? "appended" : "binary",
           appended->n);
  put_text(b, text);
  put_text(b, w->appended ? "/>\n" : ">\n  ");
  encode(w->appended ? appended : b, w, N * (size_t)components, v);
  if (!w->appended) put_text(b, "\n</DataArray>\n");
}

static struct bytes write_file(const struct way *w)
{
  struct bytes b = { .n = 0 }, appended = { .n = 0 };
  char text[400];
  double other[N] = { 7, 7, 7, 7, 7 };

  snprintf(text, sizeof text,
           "<?xml version=\"1.0\"?>\n<VTKFile "
           "type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" "
           "header_type=\"%s\"%s>\n<UnstructuredGrid>\n"
           "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"0\">\n<PointData>\n",
           w->big ? "BigEndian" : "LittleEndian", w->wide ? "UInt64" : "UInt32",
           w->packed ? " compressor=\"vtkZLibDataCompressor\"" : "", N);
  put_text(&b, text);
  put_array(&b, w, "other size", 1, other, &appended);
  put_array(&b, w, "size", 1, size_of, &appended);
  put_text(&b, "</PointData>\n<Points>\n");
  put_array(&b, w, "Points", 3, point[0], &appended);
  put_text(&b, "</Points>\n</Piece>\n</UnstructuredGrid>\n");
  if (w->appended) {
    put_text(&b, w->base64 ? "<AppendedData encoding=\"base64\">\n _"
                           : "<AppendedData encoding=\"raw\">\n _");
    put(&b, appended.data, appended.n);
    put_text(&b, "\n</AppendedData>\n");
  }
  put_text(&b, "</VTKFile>\n");
  return b;
}

static vg_status parse(const void *data, size_t size, size_t *n,
                       double (**x)[3], double **v, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st = vg_input_memory("t.vtu", data, size, &in, err);
  int components = 0;

  *x = NULL;
  *v = NULL;
  if (st >= 0)
    st = vg_vtu_values_parse(&in, "PointData", "size", &m, &components, v, err);
  if (st >= 0) assert_int_equal(components, 1);
  *n = m.n_point;
  *x = m.point;
  m.point = NULL;
  vg_mesh_release(&m);
  vg_input_release(&in);
  return st;
}

static void accept(const struct bytes *b)
{
  struct vg_error err = VG_ERROR_INIT;
  double(*x)[3], *v;
  size_t n;

  if (parse(b->data, b->n, &n, &x, &v, &err) < 0) fail_msg("%s", err.text);
  assert_int_equal(n, N);
  assert_memory_equal(x, point, sizeof point);
  assert_memory_equal(v, size_of, sizeof size_of);
  free(x);
  free(v);
}

static void reads_every_way(void **state)
{
  (void)state;
  for (int i = 0; i < 64; i++) {
    struct way w = { i & 1 ? 8 : 4, i >> 1 & 1, i >> 2 & 1,
                     i >> 3 & 1,    i >> 4 & 1, i >> 5 & 1 };
    struct bytes b;

    if (!w.appended && !w.base64) continue; /* raw is appended only */
    b = write_file(&w);
    accept(&b);
  }
}

#define HEAD "<VTKFile byte_order=\"LittleEndian\"><Piece NumberOfPoints=\"5\">"
#define POINTS                                                                 \
  "<Points><DataArray type=\"Float32\" format=\"ascii\" "                      \
  "NumberOfComponents=\"3\"> 0 0 0 1 0 0\n0 1 0 0 0 1 .25 .5 -2 "              \
  "</DataArray></Points>"
#define SIZES(text)                                                            \
  "<PointData><DataArray type=\"Float64\" Name=\"size\" "                      \
  "format=\"ascii\">" text "</DataArray></PointData>"

static void reads_text(void **state)
{
  struct bytes b = { .n = 0 };

  (void)state;
  put_text(&b, HEAD POINTS SIZES("0.5 .25 2\n1 0.125") "</Piece></VTKFile>");
  accept(&b);
}

/* foamToVTK of OpenFOAM writes attributes in single quotes. */
static void reads_single_quotes(void **state)
{
  struct bytes b = { .n = 0 };

  (void)state;
  put_text(&b, HEAD POINTS SIZES("0.5 .25 2\n1 0.125") "</Piece></VTKFile>");
  for (size_t i = 0; i < b.n; i++)
    if (b.data[i] == '"') b.data[i] = '\'';
  accept(&b);
}

/* A file with a tetrahedron and a triangle. */
struct metric_file {
  const char *metric, *nodes, *types;
};

static void put_ascii(struct bytes *b, const char *attributes, const char *data)
{
  put_text(b, "<DataArray format=\"ascii\" ");
  put_text(b, attributes);
  put_text(b, ">");
  put_text(b, data);
  put_text(b, "</DataArray>");
}

static void put_metric_file(struct bytes *b, const struct metric_file *f)
{
  put_text(b,
           "<VTKFile byte_order=\"LittleEndian\">"
           "<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">" POINTS "<Cells>");
  put_ascii(b, "type=\"Int64\" Name=\"connectivity\"", f->nodes);
  put_ascii(b, "type=\"Int32\" Name=\"offsets\"", "4 7");
  put_ascii(b, "type=\"UInt8\" Name=\"types\"", f->types);
  put_text(b, "</Cells><PointData>");
  put_ascii(b, "type=\"Float64\" Name=\"metric\" NumberOfComponents=\"6\"",
            f->metric);
  put_text(b, "</PointData></Piece></VTKFile>");
}

#define FIVE "1 1 1 0 0 0 2 1 1 0 0 0 3 1 1 0 0 0 4 1 1 0 0 0 5 1 1 .5 0 0"

static vg_status parse_metric(const struct metric_file *f, struct vg_mesh *m,
                              int *n, double **v, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  struct bytes b = { .n = 0 };
  vg_status st;

  put_metric_file(&b, f);
  st = vg_input_memory("t.vtu", b.data, b.n, &in, err);
  *v = NULL;
  *m = (struct vg_mesh)VG_MESH_INIT;
  if (st >= 0) {
    assert_true(vg_vtu_has_array(&in, "PointData", "metric"));
    assert_false(vg_vtu_has_array(&in, "PointData", "size"));
    st = vg_vtu_values_parse(&in, "PointData", "metric", m, n, v, err);
  }
  vg_input_release(&in);
  return st;
}

static void reads_metrics_and_cells(void **state)
{
  const struct metric_file f = { FIVE, "0 1 2 3 1 2 4", "10 5" };
  const uint32_t tet[4] = { 0, 1, 2, 3 }, tri[3] = { 1, 2, 4 };
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;
  double *v;
  int n = 0;

  (void)state;
  if (parse_metric(&f, &m, &n, &v, &err) < 0) fail_msg("%s", err.text);
  assert_int_equal(n, 6);
  assert_int_equal(m.n_point, N);
  assert_int_equal(m.n_tet, 1);
  assert_memory_equal(m.tet[0], tet, sizeof tet);
  assert_int_equal(m.n_tri, 1);
  assert_memory_equal(m.tri[0], tri, sizeof tri);
  assert_true(v[0] == 1 && v[6] == 2 && v[27] == 0.5);
  free(v);
  vg_mesh_release(&m);
}

static void refuses_bad_cells(void **state)
{
  static const struct {
    struct metric_file file;
    const char *says;
  } bad[] = {
    { { FIVE, "0 1 2 5 1 2 4", "10 5" }, "cell 1 uses point 6" },
    { { FIVE, "0 1 2 3 1 2 4", "12 5" }, "has 4 nodes, not 8" },
    { { FIVE, "0 1 2 3 1 2", "10 5" }, "is not a number" },
    { { "1 1 1 0 0 0", "0 1 2 3 1 2 4", "10 5" }, "is not a number" },
  };

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    struct vg_error err = VG_ERROR_INIT;
    struct vg_mesh m;
    double *v;
    int n;

    assert_true(parse_metric(&bad[i].file, &m, &n, &v, &err) < 0);
    assert_true(!v && !m.point);
    if (!strstr(err.text, bad[i].says)) fail_msg("%s", err.text);
  }
}

static void reads_its_own_output(void **state)
{
  const struct vg_vtu_field field = { "size", VG_VTU_POINT, VG_VTU_FLOAT64, 1,
                                      size_of };
  const uint32_t tri[1][3] = { { 0, 1, 2 } };
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double(*x)[3], *v;
  size_t n;

  (void)state;
  assert_int_equal(vg_vtu_write_triangles(VG_TMP_DIR "/sizes.vtu", N, point, 1,
                                          tri, &field, 1, &err),
                   VG_OK);
  assert_int_equal(vg_input_open(VG_TMP_DIR "/sizes.vtu", &in, &err), VG_OK);
  if (parse(in.data, in.size, &n, &x, &v, &err) < 0) fail_msg("%s", err.text);
  assert_int_equal(n, N);
  assert_memory_equal(v, size_of, sizeof size_of);
  free(x);
  free(v);
  vg_input_release(&in);
}

static void damage_is_never_read_as_data(void **state)
{
  struct way w = { 8, 1, 0, 1, 1, 0 };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int k = 0; k < 2; k++, w.appended = 1, w.base64 = 0) {
    struct bytes b = write_file(&w);

    for (size_t size = 1; size + 40 < b.n; size += 3) {
      double(*x)[3], *v;
      size_t n;

      if (parse(b.data, size, &n, &x, &v, &err) < 0) {
        assert_true(!x && !v);
        continue;
      }
      free(x);
      free(v);
      assert_true(size + 120 > b.n); /* all arrays were complete */
    }
  }
}

static void refuses(const char *text, vg_status want, const char *word)
{
  struct vg_error err = VG_ERROR_INIT;
  char whole[2000];
  double(*x)[3], *v;
  size_t n;

  snprintf(whole, sizeof whole, "%s</VTKFile>", text);
  assert_int_equal(parse(whole, strlen(whole), &n, &x, &v, &err), want);
  if (!strstr(err.text, word)) fail_msg("'%s' lacks '%s'", err.text, word);
  assert_true(!x && !v);
}

static void refuses_unsupported_files(void **state)
{
  (void)state;
  refuses("solid", VG_ERR_FORMAT, "no <VTKFile>");
  refuses("<VTKFile></VTKFile>", VG_ERR_FORMAT, "no <Piece>");
  refuses("<VTKFile compressor=\"vtkLZ4DataCompressor\">", VG_ERR_UNSUPPORTED,
          "LZ4");
  refuses("<VTKFile><Piece NumberOfPoints=\"0\">", VG_ERR_FORMAT,
          "NumberOfPoints");
  refuses("<VTKFile><Piece NumberOfPoints=\"4000000000\">" POINTS,
          VG_ERR_FORMAT, "truncated");
  refuses(HEAD "<Piece NumberOfPoints=\"5\">", VG_ERR_UNSUPPORTED, "pieces");
  refuses(HEAD POINTS, VG_ERR_FORMAT, "no array 'size'");
  refuses(HEAD SIZES("1 1 1 1 1"), VG_ERR_FORMAT, "no array in <Points>");
  refuses(HEAD POINTS SIZES("1 1 1 1"), VG_ERR_FORMAT, "value 5 of 5");
  refuses(HEAD POINTS "<PointData><DataArray type=\"Int32\" Name=\"size\" "
                      "format=\"ascii\">1 1 1 1 1</DataArray></PointData>",
          VG_ERR_UNSUPPORTED, "'Int32'");
  refuses(HEAD POINTS
          "<PointData><DataArray type=\"Float64\" Name=\"size\" "
          "NumberOfComponents=\"10\" format=\"ascii\"></DataArray></PointData>",
          VG_ERR_FORMAT, "10 components");
  refuses(HEAD POINTS "<PointData><DataArray type=\"Float64\" Name=\"size\" "
                      "format=\"appended\" offset=\"9\"/></PointData>",
          VG_ERR_FORMAT, "are missing");
  refuses(HEAD POINTS "<PointData><DataArray type=\"Float64\" Name=\"size\" "
                      "format=\"binary\">AAAA</DataArray></PointData>",
          VG_ERR_FORMAT, "not as long");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_every_way),
    cmocka_unit_test(reads_text),
    cmocka_unit_test(reads_single_quotes),
    cmocka_unit_test(reads_metrics_and_cells),
    cmocka_unit_test(refuses_bad_cells),
    cmocka_unit_test(reads_its_own_output),
    cmocka_unit_test(damage_is_never_read_as_data),
    cmocka_unit_test(refuses_unsupported_files),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
