/* core/mesher/mesher.h: what a mesher has to be to fill voids for Vanguard. It
 * stands alone, installed as vanguard/mesher.h, for plug-ins in C and C++: a
 * shared library that exports vg_mesher_plugin works with `vanguard mesh
 * --mesher ./it.so`.
 *
 * A mesher gets a closed front and the sizes wanted within, and returns
 * tetrahedra that fill it, with points of its own inside and none on the front,
 * whose triangles stay as they are. It runs in a process of its own for each
 * void: it may keep state, print (nothing is seen of it), and crash. What it
 * returns is checked face by face and by volume; where it fails, returns
 * nonsense or never ends, the void is filled by Vanguard's own kernel, and the
 * report counts it.
 *
 * What it makes has to follow from what it is given alone: no clocks, no
 * addresses, no random numbers but from a fixed seed, no threads that race.
 * Otherwise meshes are valid, but differ from run to run. */
#ifndef VG_CORE_MESHER_MESHER_H
#define VG_CORE_MESHER_MESHER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Of this interface. A plug-in of another version is refused. */
#define VG_MESHER_VERSION 1

/** Name of the function that a plug-in exports. */
#define VG_MESHER_SYMBOL "vg_mesher_plugin"

/** What is to be filled: closed, free of intersections, perhaps of several
 * shells; triangles turn counter-clockwise seen from within. Borrowed. */
struct vg_mesher_front {
  size_t n_point, n_face;
  const double (*x)[3];      /* [n_point], each used by a triangle */
  const uint32_t (*face)[3]; /* [n_face] from 0 */
};

/** Edge lengths wanted. */
struct vg_mesher_sizes {
  /** h out: [n] > 0, at the points x [n][3]; outside of the front's box those
   * of its nearest place. Smooth. Interpolated, within a few per cent.
   * Cost: below a microsecond each. One thread at a time. */
  void (*at)(void *user, size_t n, const double (*x)[3], double *h);
  void *user;
};

/** What it was filled with. Arrays are the mesher's, from its fill to its
 * release. */
struct vg_mesher_cells {
  size_t n_point, n_cell;
  double (*x)[3];      /* [n_point] new points, inside */
  uint32_t (*cell)[4]; /* [n_cell] the front's points, then n_point more
                          that are new; in either orientation */
};

struct vg_mesher {
  uint32_t version; /* VG_MESHER_VERSION */
  const char *name;
  /** 0: filled. Anything else: could not; out is not looked at. */
  int (*fill)(const struct vg_mesher_front *front,
              const struct vg_mesher_sizes *sizes, struct vg_mesher_cells *out);
  void (*release)(struct vg_mesher_cells *cells); /* may be NULL */
};

/** What a plug-in exports. The mesher lasts as long as the process. */
const struct vg_mesher *vg_mesher_plugin(void);

#ifdef __cplusplus
}
#endif

#endif
