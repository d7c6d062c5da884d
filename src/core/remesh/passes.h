/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/passes.h: the remeshing passes, sequences of local changes.
 * Private to core/remesh. */
#ifndef VG_CORE_REMESH_PASSES_H
#define VG_CORE_REMESH_PASSES_H

#include "core/remesh/work.h"

/** Divide the curves of a surface that has not been changed yet by size. Points
 * that are not needed are marked for removal. */
vg_status vg_pass_divide(struct vg_tris *w, int threads, struct vg_error *err);

/** Remove the marked points of curves. */
void vg_pass_curves(struct vg_tris *w);

/** Which edges may be split. */
enum vg_split {
  VG_SPLIT_ALL,
  VG_SPLIT_NEAR,    /* Edges that are much too long wait until they are the
                       longest of both their triangles. */
  VG_SPLIT_LONGEST, /* Only the longest edges of both their triangles, in
                       a single round. */
};

/** vg_pass_collapse collapses edges shorter than `least` target lengths, the
 * shortest first; vg_pass_split splits those longer than `most`, the longest
 * first. Each is followed by swaps.
 *
 * @param n  out: number of changes */
vg_status vg_pass_collapse(struct vg_tris *w, double least, double most,
                           size_t *n, struct vg_error *err);
vg_status vg_pass_split(struct vg_tris *w, double most, enum vg_split which,
                        size_t *n, struct vg_error *err);

/** Swap edges while that improves triangles. Returns the number of swaps. */
size_t vg_pass_swap(struct vg_tris *w);

/** Move points of faces to positions where their triangles are more nearly
 * equilateral, for a number of sweeps. Returns the number of moves. */
size_t vg_pass_smooth(struct vg_tris *w, int sweeps);

/** Slide points of curves to positions where both adjacent feature edges have
 * the same length in the metric, for a number of sweeps. Returns the number of
 * moves. */
size_t vg_pass_even(struct vg_tris *w, int sweeps);

/** Apply all kinds of changes to triangles with a smallest angle below that of
 * `shape` (squared sine). */
vg_status vg_pass_polish(struct vg_tris *w, double shape, size_t *n,
                         struct vg_error *err);

#endif
