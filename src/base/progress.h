/* base/progress.h: how work that takes long says how far it is. Asking it to
 * stop is another matter: base/stop.h. */
#ifndef VG_BASE_PROGRESS_H
#define VG_BASE_PROGRESS_H

#include <stddef.h>

struct vg_progress {
  /* stage: a static string; expected 0: not known. NULL: nobody listens. */
  void (*tell)(void *user, const char *stage, size_t done, size_t expected);
  void *user;
};

static inline void vg_tell(const struct vg_progress *p, const char *stage,
                           size_t done, size_t expected)
{
  if (p->tell) p->tell(p->user, stage, done, expected);
}

#endif
