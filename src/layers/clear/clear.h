/* layers/clear/clear.h: keeping layers clear of other surfaces and of each
 * other. Uses core, columns.h, topology.h. */
#ifndef VG_LAYERS_CLEAR_CLEAR_H
#define VG_LAYERS_CLEAR_CLEAR_H

#include "layers/columns/layers.h"
#include "layers/topology/topology.h"

/** Height that each column may take because of what stands in front of it:
 * `gap` times the distance along dir (a unit step is a height of 1) to the
 * nearest triangle of the surface, be it within the cone of 45 degrees about
 * dir with its apex at the root, or on the line along dir from the centre of
 * one of the column's faces. Not counted are triangles
 *   - that share a point with the column's faces, or lie in a patch that it
 *     slides in;
 *   - that it does not head for: normal . dir > -0.2 |dir|;
 *   - of which the columns grow in nearly the same direction (mean . dir >
 *     0.3, of unit vectors): the two sides of a concave edge, once the
 *     directions there are turned;
 *   - beside it (in the cone, but on no line) in a patch that any column
 *     slides in, such as a symmetry plane next to its border.
 * So next to a concave edge narrower than a right angle it is the directions
 * that decide: columns square to their walls are limited in proportion to
 * their distance from the edge (0.15 of it at 30 degrees and gap 0.4), those
 * turned along its bisector are not.
 *
 * Lines start at the first VG_AHEAD_FACES faces of a column; beyond, the cone
 * has to do.
 *
 * @param gap      > 0, else VG_ERR_INPUT
 * @param reach    [n_column] height wanted, as a multiple of dir
 * @param allowed  out: [n_column] <= reach; equal where nothing is near
 * Uses root, dir and slide of the columns, not their levels; of the topology
 * first and corner. Same bits for any number of threads. About 0.5
 * microseconds per column. */
vg_status vg_clear_ahead(const struct vg_mesh *surface,
                         const struct vg_columns *columns,
                         const struct vg_topology *topology, double gap,
                         int threads, const double *reach, double *allowed,
                         struct vg_error *err);

/** Columns of which a top touches something it must not. Exact; touching is
 * enough. A top may not touch
 *   - a top that shares no column with it, or, where one does, anywhere else
 *     (columns of one root are one as long as they have no level);
 *   - a triangle of the surface that carries no face, but for those of slide
 *     patches that a column of its face slides in.
 * Flanks of borders of one slide patch may not overlap within it, nor reach a
 * border without a level. A top without area touches itself.
 *
 * @param is_slide  [surface->n_patch] 1: will be re-meshed
 * @param active    [n_column] columns that moved since the last call, or NULL:
 *                  all; pairs of faces without an active column are skipped
 * @param bad       out: [n_column] 1 for each column with n > 0 of a face
 *                  that touches, active or not; 0 for all others
 * Faces whose columns have no level are the wall itself and are not tested
 * against each other. Same result for any number of threads. */
vg_status vg_clear_tops(const struct vg_mesh *surface,
                        const struct vg_columns *columns,
                        const uint8_t *is_slide, const uint8_t *active,
                        int threads, uint8_t *bad, size_t *n_bad,
                        struct vg_error *err);

#endif
