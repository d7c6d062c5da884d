/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/common/json_file.h: writes JSON files. Uses jansson, io/stream. */
#ifndef VG_RUN_COMMON_JSON_FILE_H
#define VG_RUN_COMMON_JSON_FILE_H

#include <stdio.h>

#include "base/status.h"
#include "run/common/json_build.h"

/** Writes o, indented, to path. The file appears only when it is complete.
 *
 * @param o     borrowed
 * @param what  its name in messages: "the report"
 *
 * VG_ERR_MEMORY, also if o is NULL; VG_ERR_IO: an existing file of that name is
 * unchanged. */
vg_status vg_json_write(const char *path, const json_t *o, const char *what,
                        struct vg_error *err);

/** Prints o, indented, and a line feed. The caller finds errors of writing with
 * ferror.
 *
 * @param flags  further flags of jansson, such as vg_json_digits
 *
 * VG_ERR_MEMORY, also if o is NULL. */
vg_status vg_json_print(FILE *to, const json_t *o, size_t flags,
                        const char *what, struct vg_error *err);

/** Flags for json_dumpf (JSON_REAL_PRECISION) with which it writes every real
 * of a document exactly, with as few digits as possible: 0.1, not
 * 0.10000000000000001. */
size_t vg_json_digits(const json_t *o);

#endif
