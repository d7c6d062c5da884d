/* core/mesher/fill_with.h: voids filled by other meshers (mesher.h), in
 * processes of their own (base/child.h): TetGen, gmsh's HXT, plug-ins. */
#ifndef VG_CORE_MESHER_FILL_WITH_H
#define VG_CORE_MESHER_FILL_WITH_H

#include "core/fill/fill.h"
#include "core/sizing/sizing.h"

/** A mesher that is ready, and the processes that have loaded it. */
struct vg_mesher_pool;

/** By its name: "tetgen", "hxt" (of the gmsh library that is installed, when
 * there is one), or the path of a plug-in.
 *
 * A child loads it for a try. VG_ERR_UNSUPPORTED, with what is wrong and what
 * to do: no such library, no vg_mesher_plugin in it, another version of the
 * interface, or it ends the process that loads it. */
vg_status vg_mesher_open(const char *name, struct vg_mesher_pool **out,
                         struct vg_error *err);

/** Accepts NULL. No void may be under way. */
void vg_mesher_close(struct vg_mesher_pool *p);

/** Fill the void within a front, as vg_fill_front does without a region, but
 * by the pool's mesher, which does not use options->sweeps.
 *
 * What comes back is checked: points finite and used, every triangle of the
 * front the face of one cell on its inner side, every other face that of two
 * cells on both sides of it, all volumes positive (exactly), their sum that of
 * the front.
 * Returns VG_NOT_BETTER when the cells do not pass, or the mesher made none:
 * *out is untouched, and *report counts why (n_other_...); VG_ERR_STOPPED;
 * VG_ERR_UNSUPPORTED beyond options->point_limit.
 * Threads: any number of voids at a time. */
vg_status vg_mesher_fill(struct vg_mesher_pool *p, const struct vg_front *front,
                         const struct vg_sizing *sizing,
                         const struct vg_fill_options *options,
                         struct vg_filled *out, struct vg_fill_report *report,
                         struct vg_error *err);

/** Seconds on the processor, and more for each triangle of a front, after which
 * a void is given up; ten times as long without a sign of life, too. */
void vg_mesher_patience(struct vg_mesher_pool *p, double seconds,
                        double seconds_each);

/** The check alone, of cells in either orientation, which are made positive;
 * new points that no cell uses are taken out.
 *
 * @param n_front  points of the front, the first ones of x: [*n]
 * @param n        in/out: points in all
 * @param wrong    out: what is wrong with them, a static string; NULL: nothing
 * Returns VG_OK, or VG_NOT_BETTER when something is; VG_ERR_MEMORY. O(n). */
vg_status vg_mesher_check(size_t n_front, size_t n_face,
                          const uint32_t (*face)[3], size_t *n, double (*x)[3],
                          size_t n_cell, uint32_t (*cell)[4],
                          const char **wrong, struct vg_error *err);

#endif
