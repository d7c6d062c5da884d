/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/sizes.h: sizes from a file, such as those from the error estimate
 * of a flow solver, and from gaps. Uses core/sizing/sizing_map.h,
 * run/input/input.h. */
#ifndef VG_RUN_INPUT_SIZES_H
#define VG_RUN_INPUT_SIZES_H

#include "run/input/input.h"

/** Reads the file of the setting `sizes`, if any, and the mesh whose points its
 * values refer to, into r->samples; r->map then refers to them.
 *
 * Within a cell that is large compared to its sizes, sizes are interpolated
 * linearly between its points; elsewhere they grow from the points.
 * VG_ERR_INPUT: no mesh next to the file, more than one, a different number of
 * points, a value that is not a size, or an existing map. */
vg_status vg_read_sizes(struct vg_read *r, struct vg_error *err);

/** The files next to STEM.sol that can be its mesh: the first two, to be freed,
 * or NULL. VG_ERR_MEMORY: both are NULL. */
vg_status vg_sizes_meshes(const char *path, char *found[2],
                          struct vg_error *err);

/** The mesh next to STEM.sol: the only file of the stem that can be read.
 * *out: to be freed. VG_ERR_INPUT: no such file, or several. */
vg_status vg_sizes_find_mesh(const char *path, char **out,
                             struct vg_error *err);

/** Adds a note if some of the metrics, which an earlier note mentions, have an
 * aspect above aspect_max. */
void vg_note_aspects(struct vg_notes *notes, size_t n,
                     const double (*metric)[6], double aspect_max);

/** If the setting gap_edges requests it, computes sizes from gaps between
 * surfaces into b->gaps. b->map becomes the smaller of these and of the sizes
 * read. Called for the closed surface before it is remeshed; adds a note. */
vg_status vg_boundary_gaps(struct vg_boundary *b, struct vg_display *show,
                           struct vg_error *err);

/** Frees the sizes of gaps and restores b->map. Does nothing without gaps. */
void vg_boundary_forget_gaps(struct vg_boundary *b);

/** Frees the sizes of gaps and of the file that `sizes` names. */
void vg_problem_forget_sizes(struct vg_problem *p);

#endif
