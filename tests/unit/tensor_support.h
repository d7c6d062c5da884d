/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Random numbers and frames, and the constant metric, for tests of tensors and
 * metrics. */
#ifndef TESTS_UNIT_TENSOR_SUPPORT_H
#define TESTS_UNIT_TENSOR_SUPPORT_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"

/* State of random_in, which a program may set first. */
static uint64_t random_state = 88172645463325252u;

/* The next number of a xorshift generator, from lo to hi. */
static inline double random_in(double lo, double hi)
{
  random_state ^= random_state << 13;
  random_state ^= random_state >> 7;
  random_state ^= random_state << 17;
  return lo + (hi - lo) * (double)(random_state >> 11) / 9007199254740992.0;
}

/* Three orthonormal vectors. */
static inline void random_frame(double v[3][3])
{
  for (int k = 0; k < 3; k++) v[0][k] = random_in(-1, 1);
  for (int k = 0; k < 3; k++) v[1][k] = random_in(-1, 1);
  vg_unit(v[0]);
  vg_cross(v[0], v[1], v[2]);
  vg_unit(v[2]);
  vg_cross(v[2], v[0], v[1]);
}

/* A struct vg_size_map of the metric user[6], which is the same everywhere. */
static inline void constant_metric(void *user, const double x[3], double m[6])
{
  (void)x;
  memcpy(m, user, 6 * sizeof *m);
}

static inline double constant_size(void *user, const double x[3])
{
  (void)x;
  return 1 / vg_cube_root(sqrt(vg_tensor_det(user)));
}

#endif
