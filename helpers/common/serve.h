/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* helpers/common/serve.h: what all helper programs share: requests from
 * standard input, replies to standard output (src/base/helper/helper_format.h,
 * docs/reference/helpers.md). A helper is one process with one thread. */
#ifndef VG_HELPERS_COMMON_SERVE_H
#define VG_HELPERS_COMMON_SERVE_H

#include <stddef.h>
#include <stdint.h>

#include "base/helper/helper_format.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Answer --version and --help, and refuse to run on a terminal. Returns only
 * if there is a program on the other end; the first message has then been sent.
 * From then on this process ends when the other end closes its side, even while
 * it computes. */
void vg_serve_start(int argc, char **argv, const char *name,
                    const char *library, const char *source);

/** A triangulation: n_point points and n_tri triangles with valid indices, and
 * n_more items of a further array. free() each array. */
struct vg_serve_surface {
  size_t n_point, n_tri, n_more;
  double (*x)[3];
  uint32_t (*tri)[3];
  double (*more)[3]; /* [n_more] holes or points; for segments [2 n_more] */
};

/** Read the next request. Returns 0 at the end of input or if it is cut. */
int vg_serve_next(int fd, struct vg_helper_message *m);

/** Read the arrays of a request. Arrays grow with the bytes that arrive.
 * Returns 0, with *s empty, if the request has more than 2^31 items, is cut, or
 * a coordinate is not finite or an index out of range. */
int vg_serve_surface_read(int fd, const struct vg_helper_message *m,
                          struct vg_serve_surface *s);
void vg_serve_surface_release(struct vg_serve_surface *s);

/** Send a message. Ends the process if the other end is closed. */
void vg_serve_put(uint32_t what, uint32_t option, uint64_t n0, uint64_t n1);
void vg_serve_put_array(const void *data, size_t size);

/** Send VG_HELPER_FAILED. */
void vg_serve_fail(uint32_t cause, const char *text);

#ifdef __cplusplus
}
#endif

#endif
