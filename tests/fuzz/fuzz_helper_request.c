/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Requests to helper programs, as the helpers read them. */
#include "fuzz.h"

#include <sys/socket.h>
#include <unistd.h>

#include "common/serve.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_helper_message m;
  struct vg_serve_surface s;
  int ends[2];

  if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends)) return 0;
  if (send(ends[1], data, size, MSG_NOSIGNAL) == (ssize_t)size) {
    shutdown(ends[1], SHUT_WR);
    while (vg_serve_next(ends[0], &m) &&
           vg_serve_surface_read(ends[0], &m, &s)) {
      if (s.n_tri) fuzz_indices(s.tri[0], 3 * s.n_tri, s.n_point, "triangles");
      for (size_t i = 0; i < s.n_point; i++)
        for (int k = 0; k < 3; k++)
          fuzz_expect(isfinite(s.x[i][k]), "finite coordinates");
      vg_serve_surface_release(&s);
    }
  }
  close(ends[0]);
  close(ends[1]);
  return 0;
}
