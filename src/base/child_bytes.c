/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Bytes over a child's socket, from either end: base/child.h. Helper programs
 * contain this file, and may use pipes instead of the socket. */
#include <assert.h>
#include <errno.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/child.h"

int vg_child_put(int fd, const void *data, size_t size)
{
  const char *at = data;

  assert(data || !size);
  while (size) {
    ssize_t n = send(fd, at, size, MSG_NOSIGNAL);

    if (n < 0 && errno == ENOTSOCK) n = write(fd, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return 0;
    at += n;
    size -= (size_t)n;
  }
  return 1;
}

int vg_child_get(int fd, void *data, size_t size)
{
  char *at = data;

  assert(data || !size);
  while (size) {
    ssize_t n = read(fd, at, size);

    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return 0;
    at += n;
    size -= (size_t)n;
  }
  return 1;
}
