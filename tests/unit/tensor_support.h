/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Random numbers and frames for tests of tensors and metrics. */
#ifndef TESTS_UNIT_TENSOR_SUPPORT_H
#define TESTS_UNIT_TENSOR_SUPPORT_H

#include <stdint.h>

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

#endif
