/* SPDX-License-Identifier: AGPL-3.0-or-later */
/* vanguard-tetgen: TetGen as a helper program of Vanguard. */
#include <new>

#include <unistd.h>

#include "tetgen/jobs.h"

extern "C" const char vg_source_digest[];

namespace
{

const int no_memory = 1; /* thrown by TetGen; other numbers are failures */

/* Returns false if the process cannot go on. TetGen starts from another state
 * after a void, so that a process fills only one. */
bool answer(const vg_helper_message &m)
{
  vg_serve_surface s;
  bool good = false;

  if (m.what != VG_HELPER_RECOVER && m.what != VG_HELPER_FILL) return false;
  if (!vg_serve_surface_read(STDIN_FILENO, &m, &s)) return false;
  try {
    good = m.what == VG_HELPER_RECOVER ? vg_tetgen_recover(m.option, s)
                                       : vg_tetgen_fill(m.value[0], s);
    if (!good) vg_serve_put(VG_HELPER_NONE, 0, 0, 0);
  } catch (const std::bad_alloc &) {
    vg_serve_fail(VG_HELPER_NO_MEMORY, "");
  } catch (int what) {
    if (what == no_memory) vg_serve_fail(VG_HELPER_NO_MEMORY, "");
    else vg_serve_put(VG_HELPER_NONE, 0, 0, 0);
  }
  vg_serve_surface_release(&s);
  return good && m.what == VG_HELPER_RECOVER;
}

} // namespace

int main(int argc, char **argv)
{
  vg_helper_message m;

  /* tetgen.h has no constant for the version. */
  vg_serve_start(argc, argv, "vanguard-tetgen", "TetGen " VG_TETGEN_VERSION,
                 vg_source_digest);
  while (vg_serve_next(STDIN_FILENO, &m))
    if (!answer(m)) _exit(1);
  _exit(0);
}
