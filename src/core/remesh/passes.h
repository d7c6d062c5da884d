/* core/remesh/passes.h: what is changed, in which order. Private to
 * core/remesh. */
#ifndef VG_CORE_REMESH_PASSES_H
#define VG_CORE_REMESH_PASSES_H

#include "core/remesh/work.h"

/** Divide the curves of a surface not changed yet by size: points that are
 * not needed are marked to go. */
vg_status vg_pass_divide(struct vg_tris *w, int threads, struct vg_error *err);

/** Take points of curves away that are marked. */
void vg_pass_curves(struct vg_tris *w);

/** Collapse edges shorter than `least` sizes, shortest first, and split those
 * longer than `most`, longest first; each with swaps after it. *n: changes.
 * across: only edges that are the longest of both their triangles, each once.
 * */
vg_status vg_pass_collapse(struct vg_tris *w, double least, double most,
                           size_t *n, struct vg_error *err);
vg_status vg_pass_split(struct vg_tris *w, double most, int across, size_t *n,
                        struct vg_error *err);

/** Swap whatever gets better, until nothing does. */
size_t vg_pass_swap(struct vg_tris *w);

/** Points of faces towards where their triangles are equilateral; sweeps. */
size_t vg_pass_smooth(struct vg_tris *w, int sweeps);

/** All changes at triangles with an angle below that of `shape`. */
vg_status vg_pass_polish(struct vg_tris *w, double shape, size_t *n,
                         struct vg_error *err);

#endif
