/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The calls of run/stages/output*.c in test_output: the linker replaces those
 * for memory, the writers and those between ranks by functions that count each
 * call and fail the requested one. The helpers have fixed names, and the walls
 * with layers are an empty file. */
#ifndef VG_TESTS_OUTPUT_CALLS_H
#define VG_TESTS_OUTPUT_CALLS_H

struct calls {
  int is_on;       /* 1: calls are counted, and fail */
  long n, at;      /* calls so far; the call that fails, from 1, or 0 */
  int is_sticky;   /* 1: all calls from `at` on fail */
  int is_guest;    /* 1: this process is rank 1, on which writers do nothing */
  int has_no_cgns; /* 1: a build without CGNS */
};
extern struct calls calls;

void calls_reset(void);

#endif
