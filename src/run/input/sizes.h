/* run/input/sizes.h: sizes out of a file, such as a solver's estimate of the
 * error leads to. Uses core/sizing/sizing_map.h, run/input/input.h. */
#ifndef VG_RUN_INPUT_SIZES_H
#define VG_RUN_INPUT_SIZES_H

#include "run/input/input.h"

/** Read the file that the setting `sizes` names, if any, and the mesh at whose
 * points its values are, into r->samples; r->map is then theirs.
 *
 * Between the points of a cell sizes are linear, where the cell is large for
 * them; elsewhere they grow from the points. VG_ERR_INPUT: no mesh beside it,
 * more than one, another number of points, a value that is no size, or a map
 * that is there already. */
vg_status vg_read_sizes(struct vg_read *r, struct vg_error *err);

/** Where the setting gap_edges asks for it: sizes from gaps between surfaces
 * into b->gaps. b->map becomes the smaller of those and of the sizes that were
 * read. Called for the closed surface, before it is remeshed; a note tells. */
vg_status vg_boundary_gaps(struct vg_boundary *b, struct vg_display *show,
                           struct vg_error *err);

/** Free the sizes of gaps and restore b->map. Does nothing without gaps. */
void vg_boundary_forget_gaps(struct vg_boundary *b);

/** Free the sizes of gaps and of the file that `sizes` names. */
void vg_problem_forget_sizes(struct vg_problem *p);

#endif
