/* core/remesh/clean.h: small faults of a reference removed before its lines are
 * found. Private to core/remesh. */
#ifndef VG_CORE_REMESH_CLEAN_H
#define VG_CORE_REMESH_CLEAN_H

#include "core/remesh/curves.h"

struct vg_clean_options {
  double tolerance;         /* largest distance between the surfaces */
  const struct vg_curves_options *lines;  /* which edges are hard */
  int threads;
  struct vg_stop stop;
};

/* The reference without its small faults. Points and triangles keep their
 * order. */
struct vg_clean {
  struct vg_mesh mesh;      /* empty: nothing was changed */
  uint32_t *point_from;     /* [mesh.n_point] number before */
  uint32_t *tri_from;       /* [mesh.n_tri] the same; corners keep their
                               places */
  size_t n_flap;            /* pairs of opposite triangles on the same points
                               that were dropped */
  size_t n_collapse;        /* edges that were collapsed */
  size_t n_crossing[2];     /* pairs of triangles that intersect each other,
                               before and after */
  double depth, at[3];      /* the deepest such pair before: how far the two
                               triangles reach through each other, and where */
};
#define VG_CLEAN_INIT { .mesh = VG_MESH_INIT }

/** Of a surface that has faults: drop thin triangles that lie back to back,
 * collapse edges far below the tolerance, which no new edge could follow, and
 * edges below the tolerance at triangles that intersect each other, and move
 * points of thin places apart, as long as the tolerance hides it. A sound
 * surface is better left alone: a collapse across a thin edge makes sheets intersect.
 *
 * Edges of three triangles, and neighbours of opposite orientation, stop the
 * work: c is then empty, and vg_ref_set_faces says what is wrong.
 * m is untouched. O(n log n) for each sweep. VG_ERR_MEMORY, VG_ERR_STOPPED. */
vg_status vg_clean_find(const struct vg_mesh *m,
                        const struct vg_clean_options *o, struct vg_clean *c,
                        struct vg_error *err);

void vg_clean_release(struct vg_clean *c);

#endif
