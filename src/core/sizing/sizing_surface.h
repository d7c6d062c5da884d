/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_surface.h: spacings prescribed by a boundary
 * triangulation. Internal to core/sizing. Uses core/mesh/mesh.h. */
#ifndef VG_CORE_SIZING_SIZING_SURFACE_H
#define VG_CORE_SIZING_SIZING_SURFACE_H

#include "core/mesh/mesh.h"

/** Points with a spacing each; released with vg_samples_release. */
struct vg_samples {
  double (*p)[3], *h;
  size_t n;
  size_t n_sized; /* number of samples with h > 0; entries with h = 0 are
                     ignored */
};
#define VG_SAMPLES_INIT                                                        \
  {                                                                            \
    0                                                                          \
  }

/** Refuse points that are not finite, and faces that refer to nonexistent
 * points. */
vg_status vg_samples_check(const struct vg_mesh *m, struct vg_error *err);

/** Samples of a checked surface: its points, then the centroids of its faces,
 * both in the order of the mesh, triangles before quadrilaterals. The spacing
 * at a point is the harmonic mean of its edges, so that a few long edges do
 * not outweigh the short ones: a cell on a stretched face has good angles only
 * if its apex is about a short edge away. The spacing is at least a quarter of
 * the edge of an equilateral triangle with the mean area around the point, so
 * that sliver triangles and single tiny edges cannot cause an excessive number
 * of cells.
 *
 * A centroid has the mean spacing of its corners and closes the gap between
 * them. Strongly stretched faces have no such sample: along their long edges
 * the spacing may grow away from the corners. */
vg_status vg_samples_make(const struct vg_mesh *m, int threads,
                          struct vg_samples *out, struct vg_error *err);

/** Select the samples of a surface that can influence the growth (sizing_bvh.h)
 * with a given slope, from above or from below. A sample whose spacing differs
 * from a neighbour's by more than the growth between them has no influence. */
vg_status vg_samples_thin(const struct vg_mesh *m, const struct vg_samples *all,
                          double slope, int below, int threads,
                          struct vg_samples *out, struct vg_error *err);

void vg_samples_release(struct vg_samples *s);

#endif
