/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A sphere as the body of a domain. Header only; uses cmocka. */
#ifndef TESTS_UNIT_BALL_SUPPORT_H
#define TESTS_UNIT_BALL_SUPPORT_H

#include "core/domain/farfield.h"

static inline double even(void *user, const double x[3])
{
  (void)x;
  return *(double *)user;
}

/* A sphere of radius 1 with edges of length h, whole (half = -1) or half, with
 * normals outward. */
static inline struct vg_mesh ball(const double centre[3], int half, double h)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_border border = VG_BORDER_INIT;
  const struct vg_size_function law = { .at = even, .user = &h };
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_mesh_add_patch(&m, 7, "ball"), 0);
  assert_int_equal(vg_add_sphere(&m, centre, 1, half, 0, &law, 0, &border,
                                 &err),
                   VG_OK);
  vg_border_release(&border);
  return m;
}

#endif
