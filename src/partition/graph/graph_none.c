/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Stub of partition/graph/graph.h in a build without METIS. */
#include <string.h>

#include "partition/graph/graph.h"

int vg_graph_is_built(void)
{
  return 0;
}

vg_status vg_graph_part(const struct vg_graph *g,
                        const struct vg_graph_options *options, uint32_t *part,
                        struct vg_error *err)
{
  (void)g, (void)options, (void)part;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "this build cannot partition graphs, because it was "
                 "configured without METIS (CMake option VG_METIS): install "
                 "libmetis-dev and configure again, or use decompose "
                 "advancing and solver_parts 0");
}

void vg_library_metis(struct vg_library *out)
{
  out->name = "METIS";
  strcpy(out->version, VG_NOT_IN_BUILD " (VG_METIS=OFF)");
}
