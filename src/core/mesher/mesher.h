/* SPDX-License-Identifier: BSD-2-Clause */
/* core/mesher/mesher.h: interface of meshers that fill voids for Vanguard.
 * This header is self-contained and installed as vanguard/mesher.h, for
 * plug-ins in C and C++: a shared library that exports vg_mesher_plugin can be
 * used with `vanguard mesh --mesher ./it.so`.
 *
 * A mesher gets a closed front and target edge lengths inside. It returns
 * tetrahedra that fill the front. It may add points inside but not on the
 * front, whose triangles must be preserved. It runs in a separate process for
 * each void. It may therefore keep state, print (the output is discarded), and
 * crash. Its result is checked face by face and by volume. If it fails,
 * returns an invalid mesh or does not terminate, Vanguard's own kernel fills
 * the void, and the report counts it.
 *
 * The result must depend on the input only: a mesher must not use clocks,
 * addresses, random numbers without a fixed seed, or threads with race
 * conditions. Otherwise meshes are valid but differ from run to run. */
#ifndef VG_CORE_MESHER_MESHER_H
#define VG_CORE_MESHER_MESHER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Version of this interface. A plug-in with another version is refused. */
#define VG_MESHER_VERSION 1

/** Name of the function that a plug-in exports. */
#define VG_MESHER_SYMBOL "vg_mesher_plugin"

/** The front to fill: closed, free of intersections, possibly with several
 * shells. Triangles are counter-clockwise seen from the void. Borrowed. */
struct vg_mesher_front {
  size_t n_point, n_face;
  const double (*x)[3];      /* [n_point], each is used by a triangle */
  const uint32_t (*face)[3]; /* [n_face] indices from 0 */
};

/** Target edge lengths. */
struct vg_mesher_sizes {
  /** h out: [n] > 0, at the points x [n][3]. Outside the box of the front, the
   * value at the nearest point of the box is used. Smooth. Interpolated with
   * errors of a few per cent. Cost: below a microsecond per point. One thread
   * at a time. */
  void (*at)(void *user, size_t n, const double (*x)[3], double *h);
  void *user;
};

/** The result. The arrays belong to the mesher, from its fill to its release.
 */
struct vg_mesher_cells {
  size_t n_point, n_cell;
  double (*x)[3];      /* [n_point] new points, inside the front */
  uint32_t (*cell)[4]; /* [n_cell] indices: first the front's points, then
                          the new ones; either orientation */
};

struct vg_mesher {
  uint32_t version; /* VG_MESHER_VERSION */
  const char *name;
  /** Returns 0 if the front was filled. Any other value means failure; out is
   * ignored then. */
  int (*fill)(const struct vg_mesher_front *front,
              const struct vg_mesher_sizes *sizes, struct vg_mesher_cells *out);
  void (*release)(struct vg_mesher_cells *cells); /* may be NULL */
};

/** Function that a plug-in exports. The mesher must be valid as long as the
 * process exists. */
const struct vg_mesher *vg_mesher_plugin(void);

#ifdef __cplusplus
}
#endif

#endif
