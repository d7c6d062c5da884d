/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Medit's .sol and .solb. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "io/mesh/sol.h"

static vg_status parse(const void *data, size_t size, size_t *n, double **v,
                       struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_memory("t.sol", data, size, &in, err);

  *v = NULL;
  int components = 0;

  if (st >= 0) st = vg_sol_parse(&in, n, &components, v, err);
  if (st >= 0) assert_int_equal(components, 1);
  vg_input_release(&in);
  return st;
}

static void reads_text(void **state)
{
  const char text[] = "MeshVersionFormatted\n2\n# sizes\nDimension 3\n"
                      "Iterations 1 7\nSolAtVertices 3 1 1 0.5 1d-3\n2\nEnd\n";
  struct vg_error err = VG_ERROR_INIT;
  double *v;
  size_t n;

  (void)state;
  assert_int_equal(parse(text, sizeof text - 1, &n, &v, &err), VG_OK);
  assert_int_equal(n, 3);
  assert_true(v[0] == 0.5 && v[1] == 1e-3 && v[2] == 2);
  free(v);
}

static void reads_metrics(void **state)
{
  const char text[] = "MeshVersionFormatted 2 Dimension 3 SolAtVertices 2\n"
                      "1 3\n1 2 3 4 5 6\n1 0 1 0 0 1e4\nEnd\n";
  const double want[12] = { 1, 2, 3, 4, 5, 6, 1, 0, 1, 0, 0, 1e4 };
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double *v = NULL;
  size_t n = 0;
  int components = 0;

  (void)state;
  assert_int_equal(vg_input_memory("t.sol", text, sizeof text - 1, &in, &err),
                   VG_OK);
  assert_int_equal(vg_sol_parse(&in, &n, &components, &v, &err), VG_OK);
  assert_int_equal(n, 2);
  assert_int_equal(components, 6);
  assert_memory_equal(v, want, sizeof want);
  free(v);
  vg_input_release(&in);
}

/* --- binary, as libMeshb writes it --- */

struct bytes {
  size_t n;
  unsigned char data[256];
};

static void put(struct bytes *b, const void *v, size_t size, int big)
{
  const unsigned char *from = v;

  for (size_t i = 0; i < size; i++)
    b->data[b->n++] = from[big == vg_host_is_little() ? size - 1 - i : i];
}

static void put_int(struct bytes *b, int64_t v, int wide, int big)
{
  int32_t narrow = (int32_t)v;

  if (wide) put(b, &v, 8, big);
  else put(b, &narrow, 4, big);
}

/* n_value: 3 scalars at 3 vertices, or one metric of 6 components. */
static struct bytes binary(int version, int big, int64_t n, int n_value)
{
  const double value[6] = { 0.5, 0.25, 2, 3, 4, 5 };
  struct bytes b = { 0, { 0 } };
  int wide = version >= 3;
  int64_t head = 4 + (wide ? 8 : 4);

  put_int(&b, 1, 0, big);
  put_int(&b, version, 0, big);
  put_int(&b, 3, 0, big);
  put_int(&b, 8 + head + 4, wide, big);
  put_int(&b, 3, 0, big);
  put_int(&b, 62, 0, big);
  put_int(&b,
          (int64_t)b.n - 4 + head + (version == 4 ? 8 : 4) + 8 +
            n_value * (version == 1 ? 4 : 8),
          wide, big);
  put_int(&b, n, version == 4, big);
  put_int(&b, 1, 0, big);
  put_int(&b, n_value == 6 ? 3 : 1, 0, big);
  for (int i = 0; i < n_value; i++) {
    float f = (float)value[i];

    if (version == 1) put(&b, &f, 4, big);
    else put(&b, &value[i], 8, big);
  }
  put_int(&b, 54, 0, big);
  put_int(&b, 0, wide, big);
  return b;
}

static void reads_binary_metrics(void **state)
{
  (void)state;
  for (int version = 1; version <= 4; version++)
    for (int big = 0; big < 2; big++) {
      struct bytes b = binary(version, big, 1, 6);
      struct vg_input in = VG_INPUT_INIT;
      struct vg_error err = VG_ERROR_INIT;
      double *v = NULL;
      size_t n = 0;
      int components = 0;

      assert_int_equal(vg_input_memory("t.solb", b.data, b.n, &in, &err),
                       VG_OK);
      if (vg_sol_parse(&in, &n, &components, &v, &err) < 0)
        fail_msg("%s", err.text);
      assert_true(n == 1 && components == 6);
      assert_true(v[0] == 0.5 && v[2] == 2 && v[5] == 5);
      free(v);
      vg_input_release(&in);
    }
}

static void reads_binary(void **state)
{
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int version = 1; version <= 4; version++)
    for (int big = 0; big < 2; big++) {
      struct bytes b = binary(version, big, 3, 3);
      double *v;
      size_t n;

      if (parse(b.data, b.n, &n, &v, &err) < 0) fail_msg("%s", err.text);
      assert_int_equal(n, 3);
      assert_true(v[0] == 0.5 && v[1] == 0.25 && v[2] == 2);
      free(v);
    }
}

static void every_truncation_is_refused(void **state)
{
  struct bytes b = binary(2, 0, 3, 3);
  struct vg_error err = VG_ERROR_INIT;
  double *v;
  size_t n;

  (void)state;
  for (size_t size = 1; size < b.n - 8; size++) {
    assert_true(parse(b.data, size, &n, &v, &err) < 0);
    assert_null(v);
  }
  b = binary(4, 1, (int64_t)1 << 33, 3);
  assert_int_equal(parse(b.data, b.n, &n, &v, &err), VG_ERR_FORMAT);
  b = binary(3, 0, 1000000, 3);
  assert_int_equal(parse(b.data, b.n, &n, &v, &err), VG_ERR_FORMAT);
  assert_non_null(strstr(err.text, "truncated"));
}

static void refuses(const char *text, vg_status want, const char *word)
{
  struct vg_error err = VG_ERROR_INIT;
  double *v;
  size_t n;

  assert_int_equal(parse(text, strlen(text), &n, &v, &err), want);
  if (!strstr(err.text, word)) fail_msg("'%s' lacks '%s'", err.text, word);
  assert_null(v);
}

#define HEAD "MeshVersionFormatted 2\nDimension 3\n"

static void refuses_unsupported_files(void **state)
{
  (void)state;
  refuses("solid", VG_ERR_FORMAT, "MeshVersionFormatted");
  refuses("MeshVersionFormatted 5", VG_ERR_FORMAT, "version");
  refuses("MeshVersionFormatted 2\nDimension 2\n", VG_ERR_UNSUPPORTED,
          "dimension 2");
  refuses("MeshVersionFormatted 2\nDimension 4\n", VG_ERR_FORMAT, "nor 3");
  refuses("MeshVersionFormatted 2\nSolAtVertices 1 1 1 1", VG_ERR_FORMAT,
          "before the dimension");
  refuses(HEAD "End", VG_ERR_FORMAT, "no SolAtVertices");
  refuses(HEAD "SolAtVertices 1\n1 2\n1 0 1\nEnd", VG_ERR_UNSUPPORTED,
          "kind 2, a vector");
  refuses(HEAD "SolAtVertices 1\n2 1 1\n1 2\nEnd", VG_ERR_UNSUPPORTED,
          "has 2 fields");
  refuses(HEAD "SolAtVertices 2\n1 3\n1.00 0.00 1.00 0 0 1.00\n1 0 1\nEnd",
          VG_ERR_FORMAT, "number 4 of 6 at vertex 2 of 2");
  refuses(HEAD "SolAtVertices 1 1 1 nan\nEnd", VG_ERR_FORMAT, "a value");
  refuses(HEAD "SolAtVertices 2 1 1 1\n", VG_ERR_FORMAT, "t.sol");
  refuses(HEAD "SolAtVertices 0 1 1\nEnd", VG_ERR_FORMAT, "not positive");
  refuses(HEAD "SolAtVertices 1 1 1 1\nSolAtVertices 1 1 1 1\nEnd",
          VG_ERR_FORMAT, "twice");
  refuses(HEAD "SolAtVertices 4000000000 1 1 1\nEnd", VG_ERR_FORMAT,
          "truncated");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_text),
    cmocka_unit_test(reads_metrics),
    cmocka_unit_test(reads_binary),
    cmocka_unit_test(reads_binary_metrics),
    cmocka_unit_test(every_truncation_is_refused),
    cmocka_unit_test(refuses_unsupported_files),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
