/* base/stop.h: how work that takes long is asked to stop before it is done. */
#ifndef VG_BASE_STOP_H
#define VG_BASE_STOP_H

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Asked often, on any thread, some thousand times a second: cheap. Once it has
 * said so it says so ever after. */
struct vg_stop {
  int (*ask)(void *user); /* anything but 0: end; NULL: never */
  void *user;
};

/** s may be NULL: never. */
static inline int vg_stops(const struct vg_stop *s)
{
  return s && s->ask && s->ask(s->user);
}

/** VG_ERR_STOPPED then, with a message. */
static inline vg_status vg_stopped(const struct vg_stop *s,
                                   struct vg_error *err)
{
  if (!vg_stops(s)) return VG_OK;
  return vg_fail(err, VG_ERR_STOPPED, "stopped before it was done, as asked");
}

#ifdef __cplusplus
}
#endif

#endif
