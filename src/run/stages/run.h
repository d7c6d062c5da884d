/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/stages/run.h: the stages of vanguard mesh from a closed surface to files,
 * on all ranks. Uses partition, layers. */
#ifndef VG_RUN_STAGES_RUN_H
#define VG_RUN_STAGES_RUN_H

#include <stdio.h>

#include "base/comm.h"
#include "core/judge/judge_slices.h"
#include "core/judge/plane_quality.h"
#include "core/judge/sheet_sides.h"
#include "core/judge/zone_quality.h"
#include "core/sides/zone_cells.h"
#include "layers/expand/slices.h"
#include "partition/advance/advance.h"
#include "partition/model/memory_stages.h"
#include "partition/repair/near.h"
#include "partition/solver/solver.h"
#include "run/common/json_build.h"
#include "run/input/input.h"
#include "run/layers/layers.h"
#include "run/input/source_effect.h"
#include "run/section/section_mesh.h"
#include "run/stages/agree.h"
#include "run/stages/output.h"
#include "run/stages/pictures.h"

/** Options that do not change the mesh. */
struct vg_run_options {
  const char *dir; /* Run directory for finished tasks, or NULL. */
  int resume, keep;
  int near;           /* 1: measure the cells near interfaces. */
  double fail_leaves; /* As in the options of partition. */
  int fail_rounds;
  uint64_t limit, shuffle;
  uint64_t node_ranks;  /* Ranks treated as a node; 0: the actual nodes. */
  enum vg_agree change; /* Data that the last node pretends to have changed. */
};

/* Stages of a run, in their order, after which its memory is measured. */
enum vg_run_stage {
  VG_STAGE_SURFACE,
  VG_STAGE_SIZES, /* Sizing field and layers. */
  VG_STAGE_FILL,
  VG_STAGE_CHECK,
  VG_STAGE_WRITE,
  VG_STAGES
};

/* Bytes of data on this rank. */
struct vg_memory_parts {
  size_t surface; /* Triangles and points of the surface. */
  size_t columns; /* Columns of the layers and the front above them. */
  size_t sizes;   /* Sizing field. */
  size_t numbers; /* Numbers of the points of the layers, the boundary of the
                     mesh, and the search for causes of flat cells. */
  double peak[VG_STAGES]; /* Peak memory of the process up to the end of the
                             stage. */
};

struct vg_run {
  struct vg_run_options options;
  struct vg_outputs *outputs;      /* Written in part during the mesh check;
                                      NULL: no files. */
  struct vg_run_pictures pictures; /* Drawn at the same time, for the
                                      outputs. */
  struct vg_comm *comm;            /* NULL: one rank without a launcher. */
  int rank, size, threads;
  const char *decomposition; /* Static; method by which the field was
                                decomposed. */
  int cyclic;                /* 1: leaves were assigned statically. */
  struct vg_partition *field;
  struct vg_partition_report partition;
  struct vg_near_report near; /* If requested. */
  struct vg_spans spans;
  struct vg_store *store;
  struct vg_store_report stored;
  struct vg_layer_slices *layers; /* NULL without layers. */
  struct vg_section_mesh section; /* The mesh of a plane section; empty for a
                                     surface in space. */
  struct vg_plane_report plane;
  struct vg_slices slices;        /* The mesh. */
  struct vg_mesh parted_boundary; /* Its boundary and its sheets, if it has
                                     sheets and no layers. */
  struct vg_sheet_report *sheets; /* [n_sheet] findings about sheets. */
  struct vg_slices unsorted;      /* The mesh before its cells were sorted by
                                     zones, if it has zones. */
  struct vg_zone_slices *zones;
  double periodic_distance; /* Largest distance between periodic points. */
  struct vg_zone_report *zone_report; /* [n_zone] figures of the zones. */
  struct vg_zone_limit *zone_limit;   /* [n_zone] their requested sizes. */
  struct vg_slices parted; /* With solver partitions, if requested. */
  struct vg_solver_slices *parts;
  struct vg_solver_report solver;
  uint64_t n_field_cell;
  struct vg_mesh_report judge, field_judge; /* Of the whole mesh; with layers,
                                               also of the field. */
  struct vg_effects effects;                /* On rank 0. */
  size_t n_probe;
  struct vg_wake_probe *probe; /* [n_probe] owned; lines across the wakes. */
  double time_size, time_layers, time_judge;
  double time_put;  /* Writing files during the mesh check. */
  double time_fill; /* Cuts, leaves and repairs. */
  double time_near; /* Measuring the cells near interfaces. */
  double time_parts;
  size_t common; /* Bytes of surface, layers and sizing field, of which a
                    node has one copy. */
  double memory; /* Bytes of the rank with the largest memory. */
  enum vg_run_stage memory_stage; /* Stage in which this rank needed them. */
  struct vg_memory_parts memory_of;
  double memory_sum; /* Sum over all ranks, with data shared on a node counted
                        once. */
};

/** Closes the surface, plans its layers and swaps its slivers. Done by the
 * first rank of each node on the cores of all its ranks; the other ranks
 * receive the surface and whether layers grow, their notes and reports are
 * empty, and their resolved settings are those read. Collective. */
vg_status vg_run_surface(struct vg_run *r, struct vg_problem *p,
                         struct vg_layer_stage *layers, struct vg_display *show,
                         struct vg_error *err);

/** Builds sizing field, layers and field, checks the mesh, and writes the files
 * of r->outputs that are written slice by slice. Collective; the mesh is
 * r->slices. The boundary of p and the layers must exist as long as the
 * mesh. */
vg_status vg_run_mesh(struct vg_run *r, const struct vg_problem *p,
                      struct vg_layer_stage *layers, struct vg_display *show,
                      struct vg_error *err);

/** With --resume: checks that the run directory contains a run, before anything
 * is read. Whether it matches this run is checked later. Collective. */
vg_status vg_run_resumable(struct vg_run *r, struct vg_error *err);

/** The mesh as it is written. */
const struct vg_slices *vg_run_slices(const struct vg_run *r);

/** run/stages/run_periodic.c: checks the periodic patches above the layers,
 * before the fill. Collective. VG_ERR_GEOMETRY as below. */
vg_status vg_run_verify_front(const struct vg_run *r,
                              const struct vg_problem *p,
                              const struct vg_mesh *front,
                              struct vg_error *err);

/** run/stages/run_periodic.c: checks the periodic patches of r->slices.
 * Collective. VG_ERR_GEOMETRY if they are not images of each other. */
vg_status vg_run_verify_periodic(struct vg_run *r, const struct vg_problem *p,
                                 struct vg_error *err);

/** run/stages/run_zones.c: sorts the cells of r->slices by zones, if the
 * surface has interfaces. Collective. */
vg_status vg_run_sort_zones(struct vg_run *r, const struct vg_problem *p,
                            struct vg_error *err);

/** run/stages/run_zones.c: the figures of the zones in q, in r->zone_report.
 * Collective. */
vg_status vg_run_judge_zones(struct vg_run *r, const struct vg_zone_quality *q,
                             struct vg_error *err);

/** run/stages/run_zones.c: a note for each zone whose cells are larger than its
 * hmax, and the same as a list. surface: as for vg_run_sort_zones. */
void vg_run_note_zones(const struct vg_run *r, const struct vg_mesh *surface,
                       struct vg_notes *notes);
json_t *vg_run_zones_json(const struct vg_run *r,
                          const struct vg_mesh *surface);

/** Number of cells of all kinds. */
uint64_t vg_run_cells(const struct vg_run *r);

/** Determines the peak memory of any rank with its stage and parts, and that of
 * all ranks together, after the last stage. Collective. */
vg_status vg_run_memory(struct vg_run *r, struct vg_error *err);

/** Collective. success: remove the data kept for a resume. */
void vg_run_release(struct vg_run *r, int success);

/** run/stages/run_settings.c: digest of all resolved settings that affect the
 * mesh (vg_param.keeps_mesh is 0), with the contents of a plug-in mesher.
 * VG_ERR_MEMORY. */
vg_status vg_run_settings_digest(const struct vg_settings *s,
                                 struct vg_digest *d, struct vg_error *err);

/** The same settings as lines name=value for vg_store_options; freed by the
 * caller. NULL: no memory. */
char *vg_run_settings(const struct vg_settings *s,
                      const struct vg_mesh *boundary);

/** Digest of the plug-in mesher; returns 0 if the mesher is not a plug-in or
 * cannot be read. */
int vg_run_mesher_digest(const struct vg_settings *s, struct vg_digest *d);

/** What vg_run_admit must know. */
struct vg_run_admission {
  const struct vg_run *run;
  const struct vg_settings *settings;
  struct vg_memory_counts counts; /* Without cells and subdomains. */
  int is_parted; /* 1: the void is decomposed before any of it is filled. */
};

/** run/stages/admit.c: VG_ERR_MEMORY if the forecast of the memory exceeds
 * max_memory, or else the free memory of the node by more than a tolerance.
 * As the option `admit` of the partition. Collective. */
vg_status vg_run_admit(const void *admission, const struct vg_front *front,
                       const struct vg_load *load,
                       const struct vg_cut_rule *rule, struct vg_error *err);

/** run/stages/report_memory.c: measures surface, layers (NULL: none) and sizing
 * field, in r->memory_of. */
void vg_run_measure(struct vg_run *r, const struct vg_mesh *surface,
                    const struct vg_layers *layers,
                    const struct vg_sizing *sizing);

/** Measures the peak memory of this rank at the end of a stage. */
void vg_run_stage_ends(struct vg_run *r, enum vg_run_stage stage);

/** Peak memory, the stage in which it occurred, and the parts that were in
 * memory then, each of the rank that had most of it. */
void vg_report_memory_text(FILE *to, const struct vg_run *r);
json_t *vg_report_memory_json(const struct vg_run *r);

/** run/stages/report_partition.c: cuts, tasks, balance. */
void vg_report_partition_text(FILE *to, const struct vg_run *r);
json_t *vg_report_partition_json(const struct vg_run *r);

#endif
