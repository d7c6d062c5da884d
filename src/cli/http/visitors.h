/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/http/visitors.h: connections that have not yet sent a request with the
 * token, or anything else that the handler trusts. There are few places for
 * them, each for a short time, so that they cannot keep the owner out however
 * slowly they send. */
#ifndef VG_CLI_HTTP_VISITORS_H
#define VG_CLI_HTTP_VISITORS_H

struct vg_visitor {
  struct vg_visitor *next, **link; /* link NULL: no longer in the list */
  int fd;
  double since; /* vg_clock() */
};

/* Oldest first. */
struct vg_visitors {
  struct vg_visitor *first, **end;
  int n;
};

void vg_visitors_init(struct vg_visitors *v);

/** Add a connection; borrows *own until vg_visitors_remove. The oldest one is
 * shut if there are more than VG_HTTP_VISITORS. */
void vg_visitors_add(struct vg_visitors *v, struct vg_visitor *own, int fd);

/** The connection is trusted or closed. May be called again. */
void vg_visitors_remove(struct vg_visitors *v, struct vg_visitor *own);

/** Shut the connections that were added before this time. */
void vg_visitors_expire(struct vg_visitors *v, double before);

#endif
