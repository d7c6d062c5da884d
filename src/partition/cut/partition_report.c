/* The fields of the decomposition's report that ranks combine when all cells
 * are numbered. Repairs combine theirs before (repair/repair.c). */
#include "partition/cut/partition.h"

#define COUNT(name, member)                                                    \
  VG_ENTRY(name, struct vg_partition_report, member, COUNT, SUM)
#define PARTING(name, member, kind, rule)                                      \
  VG_ENTRY(name, struct vg_parting_report, member, kind, rule)

static const struct vg_entry count[] = {
  COUNT("cuts", n_node),
  COUNT("pencils", n_pencil),
  COUNT("tiles", n_tile),
  COUNT(NULL, n_leaf),
  COUNT("zone_cells", n_zone_cell),
  COUNT("zones_given_up", n_blocked),
  COUNT("zones_crossing", n_crossing),
  COUNT("cuts_repeated", n_retry),
  COUNT("leaves_cut_again", n_outgrown),
  COUNT("leaves_left_large", n_uncut),
  COUNT("stages_left_open", n_open_left),
  COUNT("tasks_found", n_found),
  COUNT("parts_widened", n_widened),
  COUNT("cells_made_again", n_widened_cell),
  COUNT(NULL, n_part),
  VG_ENTRY("estimate", struct vg_partition_report, estimate, REAL, MOST),
};

const struct vg_entries vg_partition_entries = { sizeof count / sizeof *count,
                                                 count };

static const struct vg_entry parting[] = {
  PARTING("parts_asked", n_asked, COUNT, SUM),
  PARTING("parts_apart", n_apart, COUNT, SUM),
  PARTING("coarsening", coarsening, REAL, MOST),
  PARTING("coarse_cells", n_coarse, COUNT, SUM),
  PARTING("gap_parts", n_gap, COUNT, SUM),
  PARTING("octants_hold", coarse_cells, REAL, MOST),
  PARTING("interface_triangles", n_face, COUNT, SUM),
  PARTING("coarse_seconds", time[VG_PARTING_COARSE], SECONDS, MOST),
  PARTING("deal_seconds", time[VG_PARTING_GRAPH], SECONDS, MOST),
  PARTING("smooth_seconds", time[VG_PARTING_SMOOTH], SECONDS, MOST),
  PARTING("divide_seconds", time[VG_PARTING_FACES], SECONDS, MOST),
};

const struct vg_entries vg_parting_entries = { sizeof parting / sizeof *parting,
                                               parting };
