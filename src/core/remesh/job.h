/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/job.h: the data that vg_remesh works on: the reference surface
 * with its feature curves and sizing field. Private to core/remesh. */
#ifndef VG_CORE_REMESH_JOB_H
#define VG_CORE_REMESH_JOB_H

#include "core/remesh/curves.h"
#include "core/remesh/remesh.h"
#include "core/remesh/strips.h"

#define VG_JOB_RELATIVE 0.05 /* tolerance, of the size */

struct vg_remesh_job {
  const struct vg_mesh *whole; /* Input surface, or the same without its small
                                  faults. */
  const struct vg_mesh *given; /* The same, or strips.mesh if strips are
                                  closed. */
  const struct vg_remesh_options *o;
  struct vg_remesh_options own; /* Options for `base`. */
  double *own_cap, *own_stretch;
  uint8_t *own_still;
  int has_kept;  /* o->still has VG_REMESH_KEPT. */
  uint8_t *kept; /* [n_patch] Patches that keep their borders; may be NULL. */
  double *width; /* [n_patch] Widths of the patches; NULL with `kept`. */
  struct vg_mesh base; /* Storage of `whole` once it is not the input
                          surface. */
  struct vg_remesh_report r;
  struct vg_ref ref;
  struct vg_curves curves;
  struct vg_strips strips;  /* Closed strips; `given` is then strips.mesh. */
  double *strip_cap;        /* Largest sizes for strips.mesh; may be NULL. */
  double *cap;              /* [n_tri] Largest size; may be NULL. */
  double *point_cap;        /* [n_point] Largest size for strips.mesh; may be
                               NULL. */
  double *stretch;          /* [3 n_tri] options.stretch for strips.mesh. */
  double *along;            /* [3 given->n_tri] The same, with the edges along
                               thin strips; NULL: no thin strips. */
  double jag;               /* Tolerance of feature curves; independent of the
                               scale. */
  double far;               /* Sizes above this occur on an outer boundary only;
                               0: there is no outer boundary. */
  struct vg_source *source; /* Sources of the options, followed by sources added
                               at intersections. */
  size_t n_source, cap_source;
  uint8_t *keep;     /* [whole->n_point] VG_WORK_KEPT, VG_WORK_FIXED: corner of
                        input triangles that are kept unchanged; VG_WORK_LINE:
                        end of feature edges that are; NULL: none. Strips are
                        then not closed. */
  size_t n_keep;     /* Number of such points. */
  double n_expected; /* Number of new triangles by the sizes. */
  int is_all_kept;   /* The last search found no further input triangles to
                        keep. */
  size_t n_flat;     /* Swapped edges of flat triangles. */
  size_t n_fault[2]; /* Intersections of the remeshed surface in the previous
                        and the last attempt. */
  int is_cut;        /* Long feature edges were split. */
  int no_cuts;       /* Long feature edges must not be split. */
  int frees_borders; /* A restart does not keep borders between patches. */
  int closes_edges;  /* A restart closes all strips below the tolerance. */
  int looks;         /* Measure only: the surface is not changed. */
};

/** Set lengths and sources, and build the reference. VG_ERR_INPUT for a surface
 * or options out of range; VG_ERR_MEMORY, VG_ERR_STOPPED. */
vg_status vg_job_prepare(struct vg_remesh_job *j, struct vg_error *err);

/** Build the reference with its feature curves and sizes. If `closes` is set,
 * strips narrower than the tolerance are closed. */
vg_status vg_job_set_reference(struct vg_remesh_job *j, int closes,
                               struct vg_error *err);

/** Start again from the given surface m and options o. With no_cuts feature
 * edges are not split. */
vg_status vg_job_restart(struct vg_remesh_job *j, const struct vg_mesh *m,
                         const struct vg_remesh_options *o, int no_cuts,
                         struct vg_error *err);

/** Release the reference, its feature curves, sizes and strips. */
void vg_job_release_reference(struct vg_remesh_job *j);

/** Release everything except the list in the report. */
void vg_job_release(struct vg_remesh_job *j);

/* --- faults of the input and of the remeshed surface (clean.c, flat.c) ---- */

struct vg_clean_options {
  double tolerance;                      /* Largest distance between the
                                            surfaces. */
  const struct vg_curves_options *lines; /* Options that define the fixed
                                            edges. */
  int threads;
  struct vg_stop stop;
};

/* The reference surface without its small faults. Points and triangles keep
 * their order. */
struct vg_clean {
  struct vg_mesh mesh;  /* Empty: nothing was changed. */
  uint32_t *point_from; /* [mesh.n_point] Number of each point in the input. */
  uint32_t *tri_from;   /* [mesh.n_tri] Number of each triangle in the input,
                           whose corners keep their positions 0 to 2. */
  size_t n_swap;        /* Number of swapped longest edges of flat triangles. */
  size_t n_flap;        /* Number of dropped pairs of opposite triangles on the
                           same points. */
  size_t n_collapse;    /* Number of collapsed edges. */
  size_t n_crossing[2]; /* Number of pairs of triangles that intersect each
                           other, before and after. */
  double depth, at[3];  /* The deepest such pair before: the depth to which the
                           two triangles reach through each other, and its
                           location. */
};
#define VG_CLEAN_INIT                                                          \
  {                                                                            \
    .mesh = VG_MESH_INIT                                                       \
  }

/** Repair faults of a surface that are smaller than the tolerance. Pairs of
 * thin triangles that lie back to back are dropped. Edges far below the
 * tolerance are collapsed, since no new edge could follow them, and so are
 * edges below the tolerance at triangles that intersect each other. The longest
 * edges of flat triangles are swapped. Points of thin regions are moved apart.
 * Do not apply this to a sound surface: a collapse across a thin edge makes its
 * sheets intersect.
 *
 * For edges of three triangles, or neighbours of opposite orientation, nothing
 * is repaired and c is empty; vg_ref_set_faces then reports the fault.
 * m is not modified. O(n log n) per sweep. VG_ERR_MEMORY, VG_ERR_STOPPED. */
vg_status vg_clean_find(const struct vg_mesh *m,
                        const struct vg_clean_options *o, struct vg_clean *c,
                        struct vg_error *err);

void vg_clean_release(struct vg_clean *c);

struct vg_flat_limit {
  double height; /* Largest height of a flat triangle. */
  double far;    /* Longer edges are on an outer boundary, where the largest
                    height is a fraction of the edge; 0: there is no outer
                    boundary. */
};

/** Swap the longest edge of each triangle whose corners are nearly collinear.
 * This may be a feature edge: its two new pieces deviate from it by less than
 * the limit, and the flat triangle joins the patch of its neighbour.
 *
 * @param n      out: number of swapped edges
 * O(n), plus O(n log n) for each sweep if there are flat triangles.
 * VG_ERR_INPUT for a surface that is not manifold or not oriented;
 * VG_ERR_MEMORY. Untouched on failure. */
vg_status vg_flat_swap(struct vg_mesh *m, const struct vg_flat_limit *limit,
                       size_t *n, struct vg_error *err);

#endif
