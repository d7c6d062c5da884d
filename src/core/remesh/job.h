/* core/remesh/job.h: what vg_remesh works on: the reference with its lines and
 * sizes. Private to core/remesh. */
#ifndef VG_CORE_REMESH_JOB_H
#define VG_CORE_REMESH_JOB_H

#include "core/remesh/curves.h"
#include "core/remesh/remesh.h"
#include "core/remesh/strips.h"

#define VG_JOB_RELATIVE 0.05 /* of the size: tolerance */

struct vg_remesh_job {
  const struct vg_mesh *whole; /* as given, or without its small faults */
  const struct vg_mesh *given; /* the same, or with strips that are closed */
  const struct vg_remesh_options *o;
  struct vg_remesh_options own; /* of the surface without faults */
  double *own_cap, *own_stretch;
  struct vg_mesh base; /* that of `whole`, once changed */
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
                               0: no outer boundary */
  struct vg_source *source; /* those of the options, then spots */
  size_t n_source, cap_source;
  uint8_t *keep;     /* [whole->n_point] corners of given triangles that
                        stay as they are; NULL: none. Strips are then
                        not closed */
  size_t n_keep;     /* such points */
  int is_all_kept;   /* there is nothing more to keep where triangles
                        meet */
  size_t n_flat;     /* edges of flat triangles that were swapped */
  size_t n_fault[2]; /* intersections of the new surface, last time and
                        now */
  int is_cut;        /* long edges of lines are cut */
  int no_cuts;       /* they are not to be cut any more */
  int looks;         /* nothing is changed */
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

/* --- faults of the given surface and the new one (clean.c, flat.c) ------- */

struct vg_clean_options {
  double tolerance; /* largest distance between the surfaces */
  const struct vg_curves_options *lines; /* which edges are hard */
  int threads;
  struct vg_stop stop;
};

/* The reference without its small faults. Points and triangles keep their
 * order. */
struct vg_clean {
  struct vg_mesh mesh;  /* empty: nothing was changed */
  uint32_t *point_from; /* [mesh.n_point] number before */
  uint32_t *tri_from;   /* [mesh.n_tri] the same; corners keep their
                           places */
  size_t n_swap;        /* longest edges of flat triangles that were
                           swapped */
  size_t n_flap;        /* pairs of opposite triangles on the same points
                           that were dropped */
  size_t n_collapse;    /* edges that were collapsed */
  size_t n_crossing[2]; /* pairs of triangles that intersect each other,
                           before and after */
  double depth, at[3];  /* the deepest such pair before: how far the two
                           triangles reach through each other, and where */
};
#define VG_CLEAN_INIT                                                          \
  {                                                                            \
    .mesh = VG_MESH_INIT                                                       \
  }

/** Repair a surface that has faults, as far as the tolerance hides it. Thin
 * triangles that lie back to back are dropped. Edges far below the tolerance
 * are collapsed, since no new edge could follow them, and so are edges below
 * the tolerance at triangles that intersect each other. The longest edges of
 * flat triangles are swapped. Points of thin places are moved apart. A sound
 * surface is better left alone: a collapse across a thin edge makes sheets
 * intersect.
 *
 * Edges of three triangles, and neighbours of opposite orientation, stop the
 * work: c is then empty, and vg_ref_set_faces says what is wrong.
 * m is untouched. O(n log n) for each sweep. VG_ERR_MEMORY, VG_ERR_STOPPED. */
vg_status vg_clean_find(const struct vg_mesh *m,
                        const struct vg_clean_options *o, struct vg_clean *c,
                        struct vg_error *err);

void vg_clean_release(struct vg_clean *c);

struct vg_flat_limit {
  double height; /* largest height of a triangle that is flat */
  double far;    /* longer edges are on an outer boundary, where
                    the height is a share of the edge; 0: there is
                    none */
};

/** Swap the longest edge of triangles whose three corners are nearly on a line.
 * The edge may be part of a line that stays: its two new pieces are within the
 * limit of it, and the flat triangle joins the patch of its neighbour.
 *
 * @param n      out: edges swapped
 * O(n), and O(n log n) for each sweep where there are any. VG_ERR_INPUT for a
 * surface that is not manifold or not oriented; VG_ERR_MEMORY. Untouched on
 * failure. */
vg_status vg_flat_swap(struct vg_mesh *m, const struct vg_flat_limit *limit,
                       size_t *n, struct vg_error *err);

#endif
