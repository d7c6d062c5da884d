/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Replies of helper programs, as the program reads them: the first message,
 * cells of vanguard-tetgen, a surface of vanguard-wrap. */
#include "fuzz.h"

#include <sys/socket.h>
#include <unistd.h>

#include "base/helper/helper.h"
#include "core/recover/cdt_tetgen.h"
#include "core/wrap/wrap_parts.h"

static void check_hello(struct vg_link *l)
{
  struct vg_helper_hello h;

  if (!vg_link_get(l, &h, sizeof h)) return;
  if (vg_helper_hello_wrong(&h, "vanguard-tetgen")) return;
  fuzz_expect(strnlen(h.library, sizeof h.library) < sizeof h.library &&
                strnlen(h.source, sizeof h.source) < sizeof h.source,
              "texts are terminated");
}

static void check_cells(struct vg_link *l)
{
  static const double x[4][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
  };
  static const uint32_t tri[1][3] = { { 0, 1, 2 } };
  struct vg_cdt_job job = {
    .n = 4, .n_tri = 1, .x = x, .tri = tri, .st = VG_ERR_GEOMETRY
  };

  if (vg_cdt_receive(&job, l, NULL) == VG_OK && job.st == VG_OK) {
    fuzz_expect(job.n_all >= 4, "a job is answered");
    if (job.n_tet)
      fuzz_indices(job.tet[0], 4 * job.n_tet, job.n_all, "tetrahedra");
  } else {
    fuzz_expect(!job.all && !job.tet, "out is untouched");
  }
  free(job.all);
  free(job.tet);
}

static void check_surface(struct vg_link *l)
{
  struct vg_helper_message m;
  struct vg_mesh out = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  if (!vg_link_get(l, &m, sizeof m)) return;
  if (vg_wrap_receive_surface(l, m.n[0], m.n[1], &out, &err) == VG_OK &&
      out.n_tri)
    fuzz_indices(out.tri[0], 3 * out.n_tri, out.n_point, "triangles");
  vg_mesh_release(&out);
}

/* The first byte selects the reader. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static void (*const reader[])(struct vg_link *) = { check_hello, check_cells,
                                                      check_surface };
  struct vg_link l = { .silence = 1 };
  int ends[2];

  if (!size || socketpair(AF_UNIX, SOCK_STREAM, 0, ends)) return 0;
  l.fd = ends[0];
  /* smaller than the buffer of a socket (-max_len) */
  if (send(ends[1], data + 1, size - 1, MSG_NOSIGNAL) == (ssize_t)size - 1) {
    shutdown(ends[1], SHUT_WR);
    reader[*data % 3](&l);
  }
  close(ends[0]);
  close(ends[1]);
  return 0;
}
