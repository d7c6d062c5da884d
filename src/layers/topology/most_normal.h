/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/topology/most_normal.h: the most normal direction of several faces.
 *
 * Among all w with w . n_i >= 1 for the normals n_i, the shortest is chosen.
 * Its direction is the most normal one, argmax_v min_i v . n_i. Its length is
 * the height factor that keeps the offset of every face at 1 or more.
 * Algorithm: at most three normals are active, and w = sum c_i n_i over them,
 * with sum_j (n_i . n_j) c_j = 1 and c >= 0. */
#ifndef VG_LAYERS_TOPOLOGY_MOST_NORMAL_H
#define VG_LAYERS_TOPOLOGY_MOST_NORMAL_H

/** Shortest w for k normals (unit vectors, or their projections onto a plane).
 * Returns 1, or 0 if no direction sees all faces. */
int vg_most_normal(int k, const double (*n)[3], double w[3]);

#endif
