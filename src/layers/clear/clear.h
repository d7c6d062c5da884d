/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/clear/clear.h: keeps layers free of collisions with other surfaces and
 * with each other. Uses core, columns.h, topology.h. */
#ifndef VG_LAYERS_CLEAR_CLEAR_H
#define VG_LAYERS_CLEAR_CLEAR_H

#include "layers/columns/layers.h"
#include "layers/topology/topology.h"

/** Largest height of each column that the opposite surface permits: `gap`
 * times the distance along dir (a unit step is a height of 1) to the nearest
 * triangle of the surface that is within the cone of 45 degrees about dir with
 * its apex at the root, or on the line along dir from the centre of a face of
 * the column. These triangles are ignored:
 * - those that share a point with the faces of the column, or the place of one
 *   on an inner surface, or lie in a patch in which the column slides;
 * - those that the column does not approach: normal . dir > -0.2 |dir|;
 * - those whose columns grow in nearly the same direction (mean . dir > 0.3,
 *   for unit vectors): the two sides of a concave edge, once the directions
 *   there are turned;
 * - those in the cone, but on none of the lines, in a patch in which any column
 *   slides, such as a symmetry plane next to its boundary.
 *
 * At a concave edge narrower than a right angle the limit therefore depends on
 * the directions: columns normal to their walls are limited in proportion to
 * their distance from the edge (0.15 of it at 30 degrees and gap 0.4), while
 * columns turned towards the bisector are not limited.
 *
 * Lines start at the first VG_AHEAD_FACES faces of a column; beyond that number
 * only the cone is tested.
 *
 * @param gap      > 0, else VG_ERR_INPUT
 * @param reach    [n_column] requested height, as a multiple of dir
 * @param allowed  out: [n_column] <= reach; equal where nothing is near
 *
 * Uses root, dir and slide of the columns, but not their levels, and first and
 * corner of the topology. The result is bitwise independent of the number of
 * threads. About 0.5 microseconds per column. */
vg_status vg_clear_ahead(const struct vg_mesh *surface,
                         const struct vg_columns *columns,
                         const struct vg_topology *topology, double gap,
                         int threads, const double *reach, double *allowed,
                         struct vg_error *err);

/** Finds the columns of tops that touch something. Exact; touching is enough. A
 * top must not touch
 * - a top that shares no column with it; tops that share a column must not
 *   touch anywhere else (columns of one root, or of the copies of a point on
 *   the sides of an inner surface, count as one column while they have no
 *   level);
 * - a triangle of the surface without layers, except in slide patches in which
 *   a column of its face slides.
 * Side faces in one slide patch must not overlap within it, nor touch a
 * boundary edge whose columns have no level. A top without area counts as
 * touching itself.
 *
 * @param is_slide  [surface->n_patch] 1: the patch will be remeshed
 * @param active    [n_column] columns that moved since the last call, or NULL:
 *                  all; pairs of faces without an active column are skipped
 * @param margin    [n_column], or NULL: 0. Tops are tested after each one was
 *                  raised along dir by its margin, at most by its height:
 *
 *                      ----.----.----    tops of one front
 *                          :    :        margin
 *                          :    :        margin of the other front
 *                      ----'----'----    tops of the other front
 *
 *                  Side faces are not tested then, and a top without area is
 *                  no contact. This test does not replace the one without a
 *                  margin, because two raised tops may have passed through each
 *                  other
 * @param bad       out: [n_column] 1 for each column with n > 0 of a face that
 *                  touches, active or not; 0 for all others
 *
 * Faces whose columns have no level are part of the wall and are not tested
 * against each other. The result is independent of the number of threads. */
vg_status vg_clear_tops(const struct vg_mesh *surface,
                        const struct vg_columns *columns,
                        const uint8_t *is_slide, const uint8_t *active,
                        const double *margin, int threads, uint8_t *bad,
                        size_t *n_bad, struct vg_error *err);

#endif
