/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/progress.h: progress reports of long operations. base/stop.h lets the
 * caller stop them. */
#ifndef VG_BASE_PROGRESS_H
#define VG_BASE_PROGRESS_H

#include <stddef.h>

struct vg_progress {
  /* stage: a static string; expected: 0 if not known. The pointer may be
   * NULL. */
  void (*tell)(void *user, const char *stage, size_t done, size_t expected);
  void *user;
};

static inline void vg_tell(const struct vg_progress *p, const char *stage,
                           size_t done, size_t expected)
{
  if (p->tell) p->tell(p->user, stage, done, expected);
}

#endif
