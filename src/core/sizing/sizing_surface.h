/* core/sizing/sizing_surface.h: sizes that a boundary triangulation prescribes.
 * Internal to core/sizing. Uses core/mesh/mesh.h. */
#ifndef VG_CORE_SIZING_SIZING_SURFACE_H
#define VG_CORE_SIZING_SIZING_SURFACE_H

#include "core/mesh/mesh.h"

/** Points with a size each; released with vg_samples_release. */
struct vg_samples {
  double (*p)[3], *h;
  size_t n;
  size_t n_sized; /* the others have size 0 and are none */
};
#define VG_SAMPLES_INIT                                                        \
  {                                                                            \
    0                                                                          \
  }

/** Refuse points that are not finite and faces of points that do not exist. */
vg_status vg_samples_check(const struct vg_mesh *m, struct vg_error *err);

/** Samples of a checked surface: its points, and the centroids of faces, all
 * of them in the order of the mesh, triangles before quadrilaterals. The
 * size at a point is the harmonic mean of the edges at it, so that a few
 * long edges do not hide the short ones: a cell on a stretched face has good
 * angles only if its apex is about a short edge away. But it is never less
 * than a quarter of the equilateral edge of the mean area around, so that
 * needles and single tiny edges cannot demand an explosion of cells.
 *
 * A centroid has the mean size of its corners and closes the gap between
 * them. Much stretched faces have no such sample: along their long edges
 * sizes may grow away from the corners. */
vg_status vg_samples_make(const struct vg_mesh *m, int threads,
                          struct vg_samples *out, struct vg_error *err);

/** Those of all samples of a surface that the growth (sizing_bvh.h) by slope
 * from above, or from below, can depend on: one whose size differs from a
 * neighbour's by more than the growth between them is never felt. */
vg_status vg_samples_thin(const struct vg_mesh *m, const struct vg_samples *all,
                          double slope, int below, int threads,
                          struct vg_samples *out, struct vg_error *err);

void vg_samples_release(struct vg_samples *s);

#endif
