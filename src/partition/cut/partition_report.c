/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Members of the decomposition's report that ranks combine when all cells are
 * numbered. Repairs combine theirs earlier (repair/repair.c). */
#include "partition/cut/partition.h"

#define COUNT(name, member)                                                    \
  VG_ENTRY(name, struct vg_partition_report, member, COUNT, SUM)
#define DECOMPOSITION(name, member, kind, rule)                                \
  VG_ENTRY(name, struct vg_decomposition_report, member, kind, rule)

static const struct vg_entry count[] = {
  COUNT("cuts", n_node),
  COUNT("pencils", n_pencil),
  COUNT("tiles", n_tile),
  COUNT(NULL, n_leaf),
  COUNT("separator_cells", n_zone_cell),
  COUNT("separators_failed", n_blocked),
  COUNT("separators_intersecting", n_crossing),
  COUNT("recuts", n_retry),
  COUNT("leaves_subdivided_again", n_outgrown),
  COUNT("leaves_left_overloaded", n_uncut),
  COUNT("stages_incomplete", n_open_left),
  COUNT("tasks_resumed", n_found),
  COUNT("subdomains_extended", n_widened),
  COUNT("cells_regenerated", n_widened_cell),
  COUNT(NULL, n_part),
  VG_ENTRY(NULL, struct vg_partition_report, cell_bytes, REAL, MOST),
  VG_ENTRY("estimate", struct vg_partition_report, estimate, REAL, MOST),
};

const struct vg_entries vg_partition_entries = { sizeof count / sizeof *count,
                                                 count };

static const struct vg_entry decomposition[] = {
  DECOMPOSITION("parts_asked", n_asked, COUNT, SUM),
  DECOMPOSITION("parts_apart", n_apart, COUNT, SUM),
  DECOMPOSITION("coarsening", coarsening, REAL, MOST),
  DECOMPOSITION("coarse_cells", n_coarse, COUNT, SUM),
  DECOMPOSITION("gap_parts", n_gap, COUNT, SUM),
  DECOMPOSITION("octants_hold", coarse_cells, REAL, MOST),
  DECOMPOSITION("interface_triangles", n_face, COUNT, SUM),
  DECOMPOSITION("coarse_seconds", time[VG_DECOMPOSITION_COARSE], SECONDS, MOST),
  DECOMPOSITION("deal_seconds", time[VG_DECOMPOSITION_GRAPH], SECONDS, MOST),
  DECOMPOSITION("smooth_seconds", time[VG_DECOMPOSITION_SMOOTH], SECONDS, MOST),
  DECOMPOSITION("divide_seconds", time[VG_DECOMPOSITION_FACES], SECONDS, MOST),
};

const struct vg_entries vg_decomposition_entries = {
  sizeof decomposition / sizeof *decomposition, decomposition
};
