/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The fields of the kernel's report. */
#include "core/fill/fill.h"

#define ROW(name, member, kind)                                                \
  VG_ENTRY(name, struct vg_fill_report, member, kind, SUM)

static const struct vg_entry entry[] = {
  ROW("triangles_recovered", n_surface_face_lost, COUNT),
  ROW("pockets", n_pocket, COUNT),
  ROW("pocket_cells", n_pocket_cell, COUNT),
  ROW("pockets_without_tetgen", n_unassisted, COUNT),
  ROW("retries", n_retry, COUNT),
  ROW("steiner_points", n_steiner, COUNT),
  ROW("placed", n_placed, COUNT),
  ROW("subdomains_by_other_mesher", n_other, COUNT),
  ROW("cells_by_other_mesher", n_other_cell, COUNT),
  ROW("subdomains_returned", n_other_failed, COUNT),
  ROW("subdomains_crashed", n_other_ended, COUNT),
  ROW("subdomains_invalid", n_other_wrong, COUNT),
  ROW("inserted", n_inserted, COUNT),
  ROW("refused", n_refused, COUNT),
  ROW("smoothed", n_smoothed, COUNT),
  ROW("swapped", n_flip, COUNT),
  ROW("collapsed", n_collapse, COUNT),
  ROW("split", n_split, COUNT),
  ROW("flip_lists_truncated", n_list_cut, COUNT),
  ROW("bad_cells_left", n_left, COUNT),
  ROW("whole_void", whole_void, FLAG),
  VG_ENTRY(NULL, struct vg_fill_report, bytes, REAL, MOST),
  ROW("other_mesher", time_other, SECONDS),
  ROW("boundary", time_boundary, SECONDS),
  ROW("place", time_place, SECONDS),
  ROW("insert", time_insert, SECONDS),
  ROW("optimise", time_optimise, SECONDS),
  ROW("total", time_total, SECONDS),
};

const struct vg_entries vg_fill_entries = { sizeof entry / sizeof *entry,
                                            entry };
