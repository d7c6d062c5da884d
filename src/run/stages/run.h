/* run/stages/run.h: the stages of vanguard mesh between a closed surface and
 * files, by all ranks together. Uses partition, layers. */
#ifndef VG_RUN_STAGES_RUN_H
#define VG_RUN_STAGES_RUN_H

#include <jansson.h>
#include <stdio.h>

#include "base/comm.h"
#include "core/judge/judge_slices.h"
#include "layers/expand/slices.h"
#include "partition/advance/advance.h"
#include "partition/repair/near.h"
#include "partition/solver/solver.h"
#include "run/input/input.h"
#include "run/input/layers.h"
#include "run/input/source_effect.h"
#include "run/stages/agree.h"
#include "run/stages/output.h"
#include "run/stages/pictures.h"

/** What does not change the mesh. */
struct vg_run_options {
  const char *dir; /* where finished tasks are kept, or NULL */
  int resume, keep;
  int near;           /* 1: look at the cells near interfaces */
  double fail_leaves; /* of partition options */
  int fail_rounds;
  uint64_t limit, shuffle;
  uint64_t node_ranks;  /* ranks taken for a node; 0: as they are */
  enum vg_agree change; /* what the last node takes for changed */
};

struct vg_run {
  struct vg_run_options options;
  struct vg_outputs *outputs;      /* written in part while the mesh is judged;
                                     NULL: none are */
  struct vg_run_pictures pictures; /* drawn then too, for the outputs */
  struct vg_comm *comm;            /* NULL: one rank without a launcher */
  int rank, size, threads;
  const char *decomposition; /* static; how the field was decomposed */
  int cyclic;                /* 1: its parts were dealt out beforehand */
  struct vg_partition *field;
  struct vg_partition_report partition;
  struct vg_near_report near; /* where asked for */
  struct vg_spans spans;
  struct vg_store *store;
  struct vg_store_report stored;
  struct vg_layer_slices *layers; /* NULL without layers */
  struct vg_slices slices;        /* the mesh */
  struct vg_slices parted; /* with parts for the solver, where asked for */
  struct vg_solver_slices *parts;
  struct vg_solver_report solver;
  uint64_t n_field_cell;
  struct vg_mesh_report judge, field_judge; /* of all; with layers: of the
                                                field */
  struct vg_effects effects;                /* of rank 0 */
  double time_size, time_layers, time_judge;
  double time_put;  /* files written while slices are judged */
  double time_fill; /* cuts, leaves and repairs */
  double time_near; /* looking at the cells near interfaces */
  double time_parts;
  size_t common;     /* bytes of surface, layers and sizes, one copy on
                        the node */
  double memory;     /* bytes, of the rank that needs most */
  double memory_sum; /* of all, what a node has in common once */
};

/** Close the surface as read, settle its layers and swap its slivers. By the
 * first rank of each node on the cores of all; the others get the surface and
 * whether layers grow; their notes and reports are empty, and their resolved
 * settings those that were read. Collective. */
vg_status vg_run_surface(struct vg_run *r, struct vg_problem *p,
                         struct vg_layer_stage *layers, struct vg_display *show,
                         struct vg_error *err);

/** Sizes, layers, field, judgement, and what of r->outputs is written slice
 * by slice. Collective; the mesh is r->slices.
 * The boundary of p and layers are needed as long as it is. */
vg_status vg_run_mesh(struct vg_run *r, const struct vg_problem *p,
                      struct vg_layer_stage *layers, struct vg_display *show,
                      struct vg_error *err);

/** With --resume: that the run directory has a run, before anything is read.
 * Whether it is this one shows later. Collective. */
vg_status vg_run_resumable(struct vg_run *r, struct vg_error *err);

/** The mesh as it is written. */
const struct vg_slices *vg_run_slices(const struct vg_run *r);

/** Cells of all kinds. */
uint64_t vg_run_cells(const struct vg_run *r);

/** Largest memory so far of any rank, and of all together. Collective. */
vg_status vg_run_memory(struct vg_run *r, struct vg_error *err);

/** Collective. success: what was kept for a resume is removed. */
void vg_run_release(struct vg_run *r, int success);

/** run/stages/run_settings.c: the digest of all resolved settings that decide
 * the mesh (vg_param.keeps_mesh is 0), with the contents of a plug-in mesher.
 * VG_ERR_MEMORY. */
vg_status vg_run_settings_digest(const struct vg_settings *s,
                                 struct vg_digest *d, struct vg_error *err);

/** The same settings as lines of name=value for vg_store_options; the caller
 * frees them. NULL: no memory. */
char *vg_run_settings(const struct vg_settings *s,
                      const struct vg_mesh *boundary);

/** Digest of the plug-in that is to mesh; 0: it is none, or cannot be read. */
int vg_run_mesher_digest(const struct vg_settings *s, struct vg_digest *d);

/** run/stages/report_partition.c: cuts, tasks, balance. */
void vg_report_partition_text(FILE *to, const struct vg_run *r);
json_t *vg_report_partition_json(const struct vg_run *r);

#endif
