/* run/stages/pictures.h: what is drawn of a mesh while its slices are at hand,
 * for PROJECT.report.html. Uses run/picture. */
#ifndef VG_RUN_STAGES_PICTURES_H
#define VG_RUN_STAGES_PICTURES_H

#include "core/judge/quality.h"
#include "run/picture/body.h"
#include "run/picture/worst.h"

#define VG_RUN_WORST 3 /* cells that are drawn */

struct vg_run_pictures {
  int is_on; /* wanted; everything else is empty without */
  struct vg_cut_plan plan;
  struct vg_cuts *cuts; /* on rank 0 those of all, once gathered */
  struct vg_around worst[VG_RUN_WORST]; /* on rank 0 */
  uint64_t put_time; /* nanoseconds of all threads, drawing */
  double time;       /* seconds of this rank */
};

/** Choose cuts. Collective; the same on all ranks.
 * @param columns  NULL: no layers */
vg_status vg_run_pictures_plan(struct vg_run_pictures *r, struct vg_comm *comm,
                               const struct vg_mesh *surface,
                               const struct vg_columns *columns,
                               struct vg_error *err);

/** A vg_slice_body: draws the slice. */
vg_status vg_run_pictures_put(void *pictures, const struct vg_slice *slice,
                              struct vg_error *err);

/** Cuts to rank 0, and the surroundings of the worst cells. Collective.
 * @param field    slices of the field, whose tetrahedra follow `before` others
 *                 in the numbers of the report */
vg_status vg_run_pictures_gather(struct vg_run_pictures *r,
                                 struct vg_comm *comm,
                                 const struct vg_slices *field, uint64_t before,
                                 int threads,
                                 const struct vg_mesh_report *report,
                                 struct vg_error *err);

void vg_run_pictures_release(struct vg_run_pictures *r);

#endif
