/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/common/ranges.h: lists of numbers as entered by users: "1,2,4", "3:7",
 * "0:100:20", "1:512:x2" (each number is twice the previous one), and
 * combinations separated by commas. */
#ifndef VG_RUN_COMMON_RANGES_H
#define VG_RUN_COMMON_RANGES_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/** Most numbers in a list. */
#define VG_RANGE_MAX 4096

struct vg_range_list {
  size_t n, cap;
  int64_t *v;
};
#define VG_RANGE_INIT                                                          \
  {                                                                            \
    0, 0, NULL                                                                 \
  }

/** Parses a whole number, also in the form 2e6 or 1.5e6; 1 on success. */
int vg_parse_count(const char *text, size_t len, int64_t *out);

void vg_range_release(struct vg_range_list *r);

/** Numbers from lo to hi in the given order, each once.
 * @param what  name of the option, for messages
 * @param out   replaced; untouched on failure
 *
 * VG_ERR_INPUT for invalid text. */
vg_status vg_range_parse(const char *what, const char *text, int64_t lo,
                         int64_t hi, struct vg_range_list *out,
                         struct vg_error *err);

#endif
