/* SPDX-License-Identifier: AGPL-3.0-or-later */
/* helpers/tetgen/jobs.h: the two jobs of vanguard-tetgen. TetGen may end the
 * process during either. */
#ifndef VG_HELPERS_TETGEN_JOBS_H
#define VG_HELPERS_TETGEN_JOBS_H

#include "common/serve.h"

/** Compute the constrained Delaunay tetrahedra of the convex hull of the
 * points, with every triangle as a face of cells, and send them. way: 0 or 1,
 * first of the sets of switches to try. Returns false on failure; nothing was
 * sent then. */
bool vg_tetgen_recover(uint32_t way, const vg_serve_surface &s);

/** Fill the void on the side from which the triangles are counter-clockwise.
 * s.more has a point in each hole. Requests target edge lengths and sends the
 * cells. seconds: limit of processor time. Returns false on failure. */
bool vg_tetgen_fill(double seconds, const vg_serve_surface &s);

#endif
