/* core/remesh/job.h: what vg_remesh works on: the reference with its lines and
 * sizes. Private to core/remesh. */
#ifndef VG_CORE_REMESH_JOB_H
#define VG_CORE_REMESH_JOB_H

#include "core/remesh/clean.h"
#include "core/remesh/curves.h"
#include "core/remesh/remesh.h"
#include "core/remesh/strips.h"

#define VG_JOB_RELATIVE 0.05  /* of the size: tolerance */

struct vg_remesh_job {
  const struct vg_mesh *whole;  /* as given, or without its small faults */
  const struct vg_mesh *given;  /* the same, or with strips that are closed */
  const struct vg_remesh_options *o;
  struct vg_remesh_options own;  /* of the surface without faults */
  double *own_cap, *own_stretch;
  struct vg_mesh base;      /* that of `whole`, once changed */
  struct vg_remesh_report r;
  struct vg_ref ref;
  struct vg_curves curves;
  struct vg_strips strips;  /* closed ones; then given is their mesh */
  double *strip_cap;        /* cap with strips; or NULL */
  double *cap;              /* [n_tri] largest size, or NULL */
  double *point_cap;        /* [n_point] the same, with strips; or NULL */
  double *stretch;          /* [3 n_tri] that of the options, with strips */
  double jag;               /* tolerance of lines, the same at any scale */
  double far;               /* larger sizes are on an outer boundary only;
                               0: there is none */
  struct vg_source *source; /* those of the options, then spots */
  size_t n_source, cap_source;
  uint8_t *keep;            /* [whole->n_point] corners of given triangles that
                               stay as they are; NULL: none. Strips are then
                               not closed */
  size_t n_keep;            /* such points */
  int is_all_kept;          /* there is nothing more to keep where triangles
                               meet */
  size_t n_flat;            /* edges of flat triangles that were swapped */
  size_t n_fault[2];        /* intersections of the new surface, last time and
                               now */
  int is_cut;               /* long edges of lines are cut */
  int no_cuts;              /* they are not to be cut any more */
  int looks;                /* nothing is changed */
};

/** Settle lengths and sources, and build the reference. VG_ERR_INPUT for a
 * surface or options that are out of range; VG_ERR_MEMORY, VG_ERR_STOPPED. */
vg_status vg_job_prepare(struct vg_remesh_job *j, struct vg_error *err);

/** Build the reference with its lines and sizes; closes: with strips closed
 * that are narrower than the tolerance. */
vg_status vg_job_set_reference(struct vg_remesh_job *j, int closes,
                               struct vg_error *err);

/** Begin again with the given surface m and its options, cutting no edges. */
vg_status vg_job_restart(struct vg_remesh_job *j, const struct vg_mesh *m,
                         const struct vg_remesh_options *o,
                         struct vg_error *err);

/** Empty it. */
void vg_job_release_reference(struct vg_remesh_job *j);

/** Empty all but the report's list. */
void vg_job_release(struct vg_remesh_job *j);

#endif
