/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Tables of numbers separated by commas. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "io/stream/csv.h"

static vg_status column(const char *text, const char *name, size_t *n,
                        double **v, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st;

  *v = NULL;
  assert_int_equal(vg_input_memory("t.csv", text, strlen(text), &in, err),
                   VG_OK);
  st = vg_csv_column(&in, name, n, v, err);
  vg_input_release(&in);
  return st;
}

static void reads_columns(void **state)
{
  const char text[] = "\"PointID\", \"x\" ,Mach,\" p \"\r\n"
                      "0, 1.5,\t0.25 , 1d5\r\n1,2.5,.5,-2e-3\n\n"
                      "2,3.5,inf_,7\n";
  struct vg_error err = VG_ERROR_INIT;
  char names[100];
  struct vg_input in = VG_INPUT_INIT;
  double *v;
  size_t n;

  (void)state;
  assert_int_equal(column(text, "x", &n, &v, &err), VG_OK);
  assert_int_equal(n, 3);
  assert_true(v[0] == 1.5 && v[1] == 2.5 && v[2] == 3.5);
  free(v);
  assert_int_equal(column(text, "p", &n, &v, &err), VG_OK);
  assert_true(n == 3 && v[0] == 1e5 && v[1] == -2e-3 && v[2] == 7);
  free(v);
  assert_int_equal(column(text, "Mach", &n, &v, &err), VG_ERR_FORMAT);
  assert_non_null(strstr(err.text, "line 5: 'inf_' in column 'Mach'"));
  assert_int_equal(vg_input_memory("t.csv", text, sizeof text - 1, &in, &err),
                   VG_OK);
  vg_csv_names(&in, names, sizeof names);
  assert_string_equal(names, "PointID, x, Mach, p");
  vg_csv_names(&in, names, 16);
  assert_string_equal(names, "PointID, x, ...");
  vg_input_release(&in);
}

static void refuses(const char *text, const char *name, const char *says)
{
  struct vg_error err = VG_ERROR_INIT;
  double *v;
  size_t n = 9;

  assert_int_equal(column(text, name, &n, &v, &err), VG_ERR_FORMAT);
  assert_null(v);
  assert_int_equal(n, 9);
  if (!strstr(err.text, says)) fail_msg("'%s' lacks '%s'", err.text, says);
}

static void refuses_bad_tables(void **state)
{
  (void)state;
  refuses("x,y\n1,2\n", "z", "no column named 'z'");
  refuses("x,x\n1,2\n", "x", "several columns named 'x'");
  refuses("x,y\n1,2\n3\n", "x",
          "line 3: 1 columns, but the first line names 2");
  refuses("x,y\n1,2,3\n", "x", "line 2: 3 columns");
  refuses("x,y\n", "x", "no line of numbers");
  refuses("x,y\n,2\n", "x", "line 2: '' in column 'x'");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_columns),
    cmocka_unit_test(refuses_bad_tables),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
