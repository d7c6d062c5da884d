/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesher/fill_with.h: other meshers (mesher.h) that fill voids in child
 * processes (base/child.h): TetGen, HXT of gmsh, plug-ins. */
#ifndef VG_CORE_MESHER_FILL_WITH_H
#define VG_CORE_MESHER_FILL_WITH_H

#include "core/fill/fill.h"
#include "core/sizing/sizing.h"

/** An available mesher, and the processes that have loaded it. */
struct vg_mesher_pool;

/** Open a mesher by its name: "tetgen", "hxt" (from the installed gmsh library,
 * if there is one), or the path of a plug-in.
 *
 * A child process loads it as a test. VG_ERR_UNSUPPORTED, with the reason and
 * a remedy, if there is no such library, it has no vg_mesher_plugin, it has
 * another version of the interface, or it ends the process that loads it. */
vg_status vg_mesher_open(const char *name, struct vg_mesher_pool **out,
                         struct vg_error *err);

/** Accepts NULL. No void may be in progress. */
void vg_mesher_close(struct vg_mesher_pool *p);

/** Fill the void within a front as vg_fill_front does without a region, but
 * with the pool's mesher, which ignores options->sweeps.
 *
 * The result is checked: points must be finite and used; every triangle of the
 * front must be the face of exactly one cell, on its inner side, and every
 * other face that of two cells on its two sides; all volumes must be positive
 * (exactly), and their sum must be that of the front.
 *
 * Returns VG_NOT_BETTER if the cells fail the check or the mesher made none:
 * *out is unchanged, and *report counts the reason (n_other_...).
 * VG_ERR_STOPPED. VG_ERR_UNSUPPORTED if options->point_limit is exceeded.
 * Threads: any number of voids at a time. */
vg_status vg_mesher_fill(struct vg_mesher_pool *p, const struct vg_front *front,
                         const struct vg_sizing *sizing,
                         const struct vg_fill_options *options,
                         struct vg_filled *out, struct vg_fill_report *report,
                         struct vg_error *err);

/** Set the time limit for a void: seconds of processor time, and additional
 * seconds per triangle of a front. A void is also aborted after ten times that
 * without any message from the mesher. */
void vg_mesher_set_time_limit(struct vg_mesher_pool *p, double seconds,
                              double seconds_each);

/** The check of vg_mesher_fill alone. Cells may have either orientation and are
 * made positive; new points that no cell uses are removed.
 *
 * @param n_front  number of points of the front, which come first in x: [*n]
 * @param n        in/out: number of all points
 * @param wrong    out: the defect found, a static string; NULL: none
 *
 * Returns VG_OK, or VG_NOT_BETTER if a defect was found; VG_ERR_MEMORY. O(n).
 */
vg_status vg_mesher_check(size_t n_front, size_t n_face,
                          const uint32_t (*face)[3], size_t *n, double (*x)[3],
                          size_t n_cell, uint32_t (*cell)[4],
                          const char **wrong, struct vg_error *err);

#endif
