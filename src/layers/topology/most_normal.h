/* layers/topology/most_normal.h: the direction that serves several faces best.
 *
 * Of all w with w . n_i >= 1 for the normals n_i take the shortest. Its
 * direction is the most normal one, argmax_v min_i v . n_i, and its length
 * the height factor that keeps every face's offset at 1 or more (algorithm:
 * at most three normals are active; w = sum c_i n_i over them with
 * sum_j (n_i . n_j) c_j = 1 and c >= 0). */
#ifndef VG_LAYERS_TOPOLOGY_MOST_NORMAL_H
#define VG_LAYERS_TOPOLOGY_MOST_NORMAL_H

/** Shortest w for k normals (unit, or their projections into a plane).
 * Returns 1, or 0 when there is none: no direction sees all faces. */
int vg_most_normal(int k, const double (*n)[3], double w[3]);

#endif
