/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/helper/link.h: a stream socket to another process that may crash, hang
 * or send anything. Every transfer ends on a request to stop, or when the
 * process has transferred nothing for a given time. */
#ifndef VG_BASE_LINK_H
#define VG_BASE_LINK_H

#include <stddef.h>

#include "base/stop.h"

#ifdef __cplusplus
extern "C" {
#endif

enum vg_link_state {
  VG_LINK_OPEN,
  VG_LINK_ENDED,    /* the other process closed the socket */
  VG_LINK_SILENT,   /* it transferred nothing for `silence` seconds */
  VG_LINK_STOPPED,  /* `stop` requested the end */
  VG_LINK_NO_MEMORY /* no memory for an array */
};

struct vg_link {
  int fd;
  double silence;             /* seconds; a limit for processes that hang */
  const struct vg_stop *stop; /* polled ten times a second; may be NULL */
  enum vg_link_state state;   /* VG_LINK_OPEN: all transfers succeeded */
};

/** Send or receive all of these bytes. Returns 1, or 0 if the transfer failed,
 * with the reason in l->state; all later transfers then fail, too. Never raises
 * SIGPIPE. Threads: one at a time for each link. */
int vg_link_put(struct vg_link *l, const void *data, size_t size);
int vg_link_get(struct vg_link *l, void *data, size_t size);

/** Receive n items of `size` bytes into a new array, which the caller frees.
 * The array grows with the bytes that arrive, so that an absurd n does not
 * exhaust the memory. Returns NULL on failure. */
void *vg_link_get_array(struct vg_link *l, size_t n, size_t size);

#ifdef __cplusplus
}
#endif

#endif
