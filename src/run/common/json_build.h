/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/common/json_build.h: documents of Jansson that are complete or not
 * written. Uses jansson.
 *
 * A document is built by hundreds of calls. Without memory, Jansson returns
 * NULL for a value, and refuses to put NULL into an object or an array: the
 * document would lack a member. Therefore the calls that put values record a
 * lack of memory for their thread, and the calls that write a document fail
 * after it. */
#ifndef VG_RUN_COMMON_JSON_BUILD_H
#define VG_RUN_COMMON_JSON_BUILD_H

#include <jansson.h>

/** Records the lack of memory if `status`, the answer of a call of Jansson, is
 * a failure with ENOMEM. Returns `status`. Threads: safe. */
int vg_json_kept(int status);

/** json_dumps; NULL also if a value of any document was lost in this thread. */
char *vg_json_text(const json_t *o, size_t flags);

/** Called before the documents of a new request of the portal, or of a call of
 * the library. */
void vg_json_forget(void);

/** json_dumpf with the same condition: prints nothing, and vg_print_is_lost
 * (run/common/text.h) is true. */
int vg_json_dump(const json_t *o, FILE *to, size_t flags);

/** The number in o at a path of keys, each in the object of the one before; NAN
 * without such a number. o may be NULL. key: ends with NULL. */
double vg_json_number_at(const json_t *o, const char *const *key);
#define vg_json_number(o, ...)                                                 \
  vg_json_number_at(o, (const char *const[]){ __VA_ARGS__, NULL })

#define json_object_set_new(o, name, value)                                    \
  vg_json_kept(json_object_set_new(o, name, value))
#define json_object_set(o, name, value)                                        \
  vg_json_kept(json_object_set(o, name, value))
#define json_object_update(o, other) vg_json_kept(json_object_update(o, other))
#define json_array_append_new(o, value)                                        \
  vg_json_kept(json_array_append_new(o, value))
#define json_dumps(o, flags) vg_json_text(o, flags)
#define json_dumpf(o, to, flags) vg_json_dump(o, to, flags)

#endif
