/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* bench/peers.h: functions shared by the files of vg_bench_peers. */
#ifndef VG_BENCH_PEERS_H
#define VG_BENCH_PEERS_H

#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"

/** Read the TetGen mesh STEM.node, STEM.ele. Its boundary is that of `surface`,
 * whose points are the first points of the mesh. */
vg_status peer_read_tetgen(const char *stem, const struct vg_mesh *surface,
                           struct vg_mesh *out, struct vg_error *err);

/** Read triangles and tetrahedra of a binary Gmsh file of format 2.2. */
vg_status peer_read_msh(const char *path, struct vg_mesh *out,
                        struct vg_error *err);

/** Points whose Delaunay tetrahedra carry the field by linear interpolation:
 * the corners of an octree over the box lo, hi (a little enlarged) whose
 * cells are at most `cells` target lengths wide, or twice that where the
 * field is uniform. Caller frees *point, *size. */
vg_status peer_sample(const struct vg_sizing *sizing, const double lo[3],
                      const double hi[3], double cells, size_t *n,
                      double (**point)[3], double **size, struct vg_error *err);

/** Write STEM.b.node and STEM.b.mtr, a background mesh for TetGen without its
 * tetrahedra (`tetgen STEM.b.node` makes these). */
vg_status peer_write_background(const char *stem, size_t n,
                                const double (*point)[3], const double *size,
                                struct vg_error *err);

/** Convert STEM.b.node, .b.ele, .b.mtr to a Gmsh view STEM.pos. */
vg_status peer_write_view(const char *stem, struct vg_error *err);

#endif
