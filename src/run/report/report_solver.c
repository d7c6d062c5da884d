/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on solver partitions. Declared in run/report/report.h. */
#include "run/common/text.h"
#include "run/report/report.h"

static void row(FILE *to, const char *name, uint64_t n, const char *more)
{
  char count[32];

  fprintf(to, "  %-24s %15s%s\n", name, vg_text_count(n, count), more);
}

void vg_report_solver_text(FILE *to, const struct vg_solver_report *r)
{
  char more[120];

  row(to, "partitions", r->n_part, "");
  row(to, "stacks of layer cells", r->n_stack,
      r->n_stack ? ", none of them cut" : "");
  if (r->n_stack) {
    row(to, "cells in stacks", r->n_stack_cell, "");
    row(to, "cells in largest stack", r->most_stack, "");
  }
  if (r->has_loose)
    fprintf(to, "  It is not known which tetrahedra belong to stacks: the "
                "file does not say, or they\n  are not in Vanguard's order. "
                "Only prisms and hexahedra were kept together.\n");
  snprintf(more, sizeof more,
           " at most, %llu at least; max/mean by weight %.4f",
           (unsigned long long)r->least_cells, r->balance);
  row(to, "cells per partition", r->most_cells, more);
  row(to, "interface faces", r->n_cut, "");
  snprintf(more, sizeof more, " at most, mean %.0f", r->mean_cut);
  row(to, "faces per partition", r->most_cut, more);
  snprintf(more, sizeof more, " at most, mean %.1f", r->mean_near);
  row(to, "neighbour partitions", r->most_near, more);
  if (r->n_moved)
    row(to, "empty after METIS", r->n_moved, ", given one stack or cell each");
  fprintf(to,
          "  METIS: graph of %s vertices partitioned in %.2f s, built in %.2f "
          "s\n",
          vg_text_count(r->n_vertex, more), r->time_metis, r->time_graph);
}

json_t *vg_report_solver_json(const struct vg_solver_report *r)
{
  return json_pack(
    "{s:I s:I s:I s:I s:I s:b s:I s:f s:I s:I s:I s:I s:f s:I s:f s:I s:f s:f}",
    "parts", (json_int_t)r->n_part, "cells", (json_int_t)r->n_cell, "stacks",
    (json_int_t)r->n_stack, "stack_cells", (json_int_t)r->n_stack_cell,
    "largest_stack", (json_int_t)r->most_stack, "tetrahedra_in_stacks_known",
    !r->has_loose, "graph_vertices", (json_int_t)r->n_vertex, "balance",
    r->balance, "most_cells", (json_int_t)r->most_cells, "least_cells",
    (json_int_t)r->least_cells, "cut_faces", (json_int_t)r->n_cut,
    "most_cut_faces", (json_int_t)r->most_cut, "mean_cut_faces", r->mean_cut,
    "most_neighbours", (json_int_t)r->most_near, "mean_neighbours",
    r->mean_near, "filled_up", (json_int_t)r->n_moved, "seconds_graph",
    r->time_graph, "seconds_metis", r->time_metis);
}
