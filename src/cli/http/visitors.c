/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/http/visitors.h"

#include <assert.h>
#include <stddef.h>
#include <sys/socket.h>

#include "base/clock.h"
#include "cli/http/http.h"

void vg_visitors_init(struct vg_visitors *v)
{
  *v = (struct vg_visitors){ .end = &v->first };
}

void vg_visitors_remove(struct vg_visitors *v, struct vg_visitor *own)
{
  if (!own->link) return;
  *own->link = own->next;
  if (own->next) own->next->link = own->link;
  else v->end = own->link;
  own->link = NULL;
  v->n--;
}

/* The server then closes the connection. */
static void shut_first(struct vg_visitors *v)
{
  shutdown(v->first->fd, SHUT_RDWR);
  vg_visitors_remove(v, v->first);
}

void vg_visitors_add(struct vg_visitors *v, struct vg_visitor *own, int fd)
{
  assert(fd >= 0);
  *own = (struct vg_visitor){ .link = v->end, .fd = fd, .since = vg_clock() };
  *v->end = own;
  v->end = &own->next;
  if (++v->n > VG_HTTP_VISITORS) shut_first(v);
}

void vg_visitors_expire(struct vg_visitors *v, double before)
{
  while (v->first && v->first->since < before) shut_first(v);
}
