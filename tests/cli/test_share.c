/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A surface is packed into bytes and unpacked. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "run/input/share.h"

static double point[4][3] = {
  { 0, 0, -0.0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1e-300 }
};
static uint32_t tri[4][3] = {
  { 0, 1, 2 }, { 0, 3, 1 }, { 1, 3, 2 }, { 0, 2, 3 }
};
static uint32_t tri_patch[4] = { 0, 1, 1, 0 };
static struct vg_patch patch[2] = { { 7, 3, 5000, 3, 0, 0, 0, 0, "far" },
                                    { -2, VG_BC_NONE, 4000, 4, 0, 0, 0, 0,
                                      "wing" } };

static struct vg_bytes packed(void)
{
  struct vg_mesh m = { .n_point = 4,
                       .n_tri = 4,
                       .n_patch = 2,
                       .point = point,
                       .tri = tri,
                       .tri_patch = tri_patch,
                       .patch = patch };
  struct vg_bytes b = { 0, NULL };
  struct vg_error err = VG_ERROR_INIT;

  if (vg_surface_pack(&m, 5, &b, &err) < 0) fail_msg("%s", err.text);
  return b;
}

static void comes_back_bit_by_bit(void **state)
{
  struct vg_bytes b = packed();
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint64_t number = 0;

  (void)state;
  assert_int_equal(vg_surface_unpack(&b, &m, &number, &err), VG_OK);
  assert_int_equal(number, 5);
  assert_int_equal(m.n_point, 4);
  assert_int_equal(m.n_tri, 4);
  assert_int_equal(m.n_patch, 2);
  assert_memory_equal(m.point, point, sizeof point);
  assert_memory_equal(m.tri, tri, sizeof tri);
  assert_memory_equal(m.tri_patch, tri_patch, sizeof tri_patch);
  assert_memory_equal(m.patch, patch, sizeof patch);
  vg_mesh_release(&m);
  free(b.data);
}

static void refuses(struct vg_bytes b)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint64_t number = 9;

  assert_int_equal(vg_surface_unpack(&b, &m, &number, &err), VG_ERR_FORMAT);
  assert_int_equal(number, 9);
  assert_null(m.point);
}

static void invalid_bytes_are_refused(void **state)
{
  struct vg_bytes b = packed();
  const uint64_t many = UINT64_MAX / 16;
  const uint32_t none = 4;
  size_t tri_at = 4 * sizeof(uint64_t) + sizeof point;
  unsigned char was[sizeof many];

  (void)state;
  for (size_t n = 0; n < b.n; n += 9) refuses((struct vg_bytes){ n, b.data });
  for (int k = 0; k < 3; k++) { /* counts */
    memcpy(was, b.data + 8 * k, sizeof was);
    memcpy(b.data + 8 * k, &many, sizeof many);
    refuses(b);
    memcpy(b.data + 8 * k, was, sizeof was);
  }
  memcpy(b.data + tri_at, &none, sizeof none);
  refuses(b);
  free(b.data);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(comes_back_bit_by_bit),
    cmocka_unit_test(invalid_bytes_are_refused),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
