/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/stages/pictures.h: pictures of a mesh, drawn while its slices are in
 * memory, for PROJECT.report.html. Uses run/picture. */
#ifndef VG_RUN_STAGES_PICTURES_H
#define VG_RUN_STAGES_PICTURES_H

#include "core/judge/quality.h"
#include "run/picture/body.h"
#include "run/picture/worst.h"

#define VG_RUN_WORST 3 /* Number of worst cells that are drawn. */

struct vg_run_pictures {
  int is_on; /* Pictures are requested; otherwise all other members are
                empty. */
  int axis;  /* 1, 2: normal of a mesh one cell thick, which is drawn at `at`
                only; 0: a mesh in space. */
  double at;
  struct vg_cut_plan plan;
  struct vg_cuts *cuts; /* On rank 0 the cuts of all ranks, once gathered. */
  struct vg_around worst[VG_RUN_WORST]; /* On rank 0. */
  uint64_t put_time; /* Nanoseconds spent drawing, over all threads. */
  double time;       /* Seconds of this rank. */
};

/** Chooses the cuts. Collective; the same on all ranks.
 * @param columns  NULL: no layers */
vg_status vg_run_pictures_plan(struct vg_run_pictures *r, struct vg_comm *comm,
                               const struct vg_mesh *surface,
                               const struct vg_columns *columns,
                               struct vg_error *err);

/** Draws the slice; a vg_slice_body. */
vg_status vg_run_pictures_put(void *pictures, const struct vg_slice *slice,
                              struct vg_error *err);

/** Gathers the cuts and the surroundings of the worst cells on rank 0.
 * Collective.
 * @param field    slices of the field, whose tetrahedra follow `before` others
 *                 in the numbering of the report */
vg_status vg_run_pictures_gather(struct vg_run_pictures *r,
                                 struct vg_comm *comm,
                                 const struct vg_slices *field, uint64_t before,
                                 int threads,
                                 const struct vg_mesh_report *report,
                                 struct vg_error *err);

void vg_run_pictures_release(struct vg_run_pictures *r);

#endif
