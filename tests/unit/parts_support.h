/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Tests of optional parts are skipped in builds without them. */
#ifndef VG_TESTS_PARTS_SUPPORT_H
#define VG_TESTS_PARTS_SUPPORT_H

#include "base/helper/helper.h"
#include "partition/graph/graph.h"

static inline void needs_tetgen(void)
{
  struct vg_helper h;

  vg_helper_find(VG_HELPER_TETGEN, &h);
  if (h.is_found) return;
  print_message("%s: skipped\n", h.why);
  skip();
}

static inline void needs_metis(void)
{
  if (vg_graph_is_built()) return;
  print_message("built without METIS: skipped\n");
  skip();
}

#endif
