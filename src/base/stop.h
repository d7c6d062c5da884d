/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/stop.h: lets the caller stop a long operation before it is complete. */
#ifndef VG_BASE_STOP_H
#define VG_BASE_STOP_H

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Request to stop. It is polled by any thread, some thousand times a second, so
 * it must be cheap. Once it has returned non-zero it must keep doing so. */
struct vg_stop {
  int (*ask)(void *user); /* returns non-zero to stop; NULL: never stop */
  void *user;
};

/** Should the operation stop? s may be NULL: never. */
static inline int vg_stops(const struct vg_stop *s)
{
  return s && s->ask && s->ask(s->user);
}

/** VG_ERR_STOPPED, with a message, if the operation should stop. */
static inline vg_status vg_stopped(const struct vg_stop *s,
                                   struct vg_error *err)
{
  if (!vg_stops(s)) return VG_OK;
  return vg_fail(err, VG_ERR_STOPPED,
                 "stopped on request before it was complete");
}

#ifdef __cplusplus
}
#endif

#endif
