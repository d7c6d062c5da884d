/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "base/helper/link.h"

#include <assert.h>
#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/memory.h"

#define POLL_MS 100
#define FIRST_BYTES 65536 /* of an array before any of it has arrived */

/* Wait until the socket can be read or written. */
static int await(struct vg_link *l, short event)
{
  const double end = vg_clock() + l->silence;
  struct pollfd p = { l->fd, event, 0 };

  while (l->state == VG_LINK_OPEN) {
    int n = poll(&p, 1, POLL_MS);

    if (n > 0) return 1;
    if (n < 0 && errno != EINTR) l->state = VG_LINK_ENDED;
    else if (vg_stops(l->stop)) l->state = VG_LINK_STOPPED;
    else if (vg_clock() > end) l->state = VG_LINK_SILENT;
  }
  return 0;
}

int vg_link_put(struct vg_link *l, const void *data, size_t size)
{
  const char *at = data;

  assert(l && (data || !size));
  while (size) {
    ssize_t n;

    if (!await(l, POLLOUT)) return 0;
    n = send(l->fd, at, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (n <= 0) {
      l->state = VG_LINK_ENDED;
      return 0;
    }
    at += n;
    size -= (size_t)n;
  }
  return l->state == VG_LINK_OPEN;
}

int vg_link_get(struct vg_link *l, void *data, size_t size)
{
  char *at = data;

  assert(l && (data || !size));
  while (size) {
    ssize_t n;

    if (!await(l, POLLIN)) return 0;
    n = read(l->fd, at, size);
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (n <= 0) {
      l->state = VG_LINK_ENDED;
      return 0;
    }
    at += n;
    size -= (size_t)n;
  }
  return l->state == VG_LINK_OPEN;
}

void *vg_link_get_array(struct vg_link *l, size_t n, size_t size)
{
  size_t have = 0, room = FIRST_BYTES / size + 1;
  char *all;

  assert(l && size);
  if (room > n) room = n;
  all = vg_alloc(room, size);
  while (all) {
    char *more;

    if (!vg_link_get(l, all + have * size, (room - have) * size)) break;
    if (room == n) return all;
    have = room;
    room = n / 2 > room ? 2 * room : n;
    more = vg_realloc(all, room, size);
    if (!more) break;
    all = more;
  }
  if (l->state == VG_LINK_OPEN) l->state = VG_LINK_NO_MEMORY;
  free(all);
  return NULL;
}
