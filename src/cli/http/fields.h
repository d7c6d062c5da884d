/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/http/fields.h: the named values of forms and queries. */
#ifndef VG_CLI_HTTP_FIELDS_H
#define VG_CLI_HTTP_FIELDS_H

#include <stddef.h>

#include "base/status.h"

/* Limits of a request: number of fields, and bytes of names and values. A form
 * has some 120 fields, of which the tables of a deck are the longest. */
enum { VG_FIELDS_MAX = 400, VG_FIELDS_BYTES = 1 << 20 };

struct vg_fields {
  size_t n, cap, bytes;
  struct vg_form_field {
    char *name, *value;
    size_t size;
  } * item;
};
#define VG_FIELDS_INIT                                                         \
  {                                                                            \
    0, 0, 0, NULL                                                              \
  }

void vg_fields_release(struct vg_fields *f);

/** Add size bytes at `offset` of the value of `name`; offset 0 begins a new
 * field. VG_ERR_INPUT: a limit is exceeded, the piece does not continue the
 * previous one, or it contains a zero byte. */
vg_status vg_fields_put(struct vg_fields *f, const char *name, const char *data,
                        size_t offset, size_t size, struct vg_error *err);

/** The first value of `name`, or NULL. Borrowed. */
const char *vg_fields_get(const struct vg_fields *f, const char *name);

/** As vg_fields_get, but "" instead of NULL. */
const char *vg_fields_text(const struct vg_fields *f, const char *name);

/** An integer from lo to hi; `otherwise` if the field is absent or empty. The
 * message of VG_ERR_INPUT names `what`. */
vg_status vg_fields_count(const struct vg_fields *f, const char *name,
                          const char *what, int lo, int hi, int otherwise,
                          int *out, struct vg_error *err);

#endif
