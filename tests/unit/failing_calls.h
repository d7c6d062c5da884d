/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Calls that the linker replaces (--wrap=NAME): one fails if the function
 * fails() of the test says so, and is the real one otherwise. Include it after
 * fails(). */
#ifndef VG_TESTS_FAILING_CALLS_H
#define VG_TESTS_FAILING_CALLS_H

#include "base/memory.h"

#define FAILS(type, name, parameters, arguments, failure)                      \
  type __real_##name parameters;                                               \
  type __wrap_##name parameters;                                               \
  type __wrap_##name parameters                                                \
  {                                                                            \
    return fails() ? failure : __real_##name arguments;                        \
  }

/* The allocations of base/memory.h. */
#define FAILS_MEMORY                                                           \
  FAILS(void *, vg_alloc, (size_t n, size_t size), (n, size), NULL)            \
  FAILS(void *, vg_calloc, (size_t n, size_t size), (n, size), NULL)           \
  FAILS(int, vg_reserve, (void *block, size_t *cap, size_t need, size_t size), \
        (block, cap, need, size), -1)

#endif
