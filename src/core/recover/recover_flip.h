/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/recover/recover_flip.h: flips that recover an edge or a triangle of a
 * surface among tetrahedra on its points. Edges and faces of the surface that
 * are already present are preserved.
 *
 * An edge is removed by the best triangulation of the polygon around it. If
 * there is no valid triangulation, adjacent edges are removed first, to a
 * bounded depth (the n-to-m flips of H. Si, "TetGen, a Delaunay-based quality
 * tetrahedral mesh generator", ACM TOMS 41(2), 2015). The number of
 * obstructions (faces or edges that intersect the target) is counted with
 * exact signs and never increases. Among equal alternatives, the shape of the
 * cells decides. */
#ifndef VG_CORE_RECOVER_RECOVER_FLIP_H
#define VG_CORE_RECOVER_RECOVER_FLIP_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"

enum {
  VG_FLIP_RING = 24
}; /* largest number of cells around a removable
      edge */

struct vg_flip_front { /* edges and triangles, sorted by their lowest point */
  size_t n_point;
  const uint32_t (*tri)[3];
  uint32_t *first_edge; /* [n_point + 1] */
  uint32_t *edge;       /* higher end of each edge */
  uint32_t *first_tri;  /* [n_point + 1] */
  uint32_t *of_point;   /* index of each triangle */
};

struct vg_flipper {
  struct vg_tets *t;
  struct vg_flip_front front;
  uint32_t *star; /* [front.n_point] a cell of each point */
  int n_target;   /* 2: recover an edge, 3: recover a triangle */
  uint32_t target[3];
  int budget;      /* number of edge stars that may still be examined */
  size_t n_change; /* number of flips so far */
  int refused;     /* memory was refused */
  size_t n_seen, cap_seen;
  uint32_t *seen; /* cells of the current search, flagged VG_TRIED */
};

/* --- the surface (recover_front.c) ---------------------------------------- */

vg_status vg_flip_front_init(struct vg_flip_front *s, size_t n_point,
                             size_t n_tri, const uint32_t (*tri)[3],
                             struct vg_error *err);
void vg_flip_front_release(struct vg_flip_front *s);

/** Index of an edge in s->edge, VG_NONE if there is no such edge. */
uint32_t vg_flip_edge_at(const struct vg_flip_front *s, uint32_t a, uint32_t b);
int vg_flip_is_tri(const struct vg_flip_front *s, const uint32_t v[3]);

/** Does the target edge intersect triangle x y z elsewhere than at the ends of
 * the edge? */
int vg_flip_obstructs(const struct vg_flipper *f, uint32_t x, uint32_t y,
                      uint32_t z);

/** Does edge p q pierce the target triangle? */
int vg_flip_pierces(const struct vg_flipper *f, uint32_t p, uint32_t q);

/* --- flips (recover_flip.c) ----------------------------------------------- */

/** Remove face i of cell c (2 cells to 3), or the edge between points a and b
 * of cell c, if this reduces the number of obstructions. depth: how far
 * adjacent edges may be removed first. Returns 1 if cells have changed: there
 * are fewer obstructions, or adjacent edges were removed without adding any. */
int vg_flip_face(struct vg_flipper *f, uint32_t c, int i);
int vg_flip_edge(struct vg_flipper *f, uint32_t c, uint32_t a, uint32_t b,
                 int depth);

/* --- recovery of edges and triangles (recover_target.c) ------------------- */

/** Does the edge exist? */
int vg_flip_has_edge(const struct vg_flipper *f, uint32_t a, uint32_t b);

/** Try to recover an edge. Returns 1 if it exists now. depth: as for
 * vg_flip_edge, at most 3. */
int vg_flip_make_edge(struct vg_flipper *f, uint32_t a, uint32_t b, int depth);

/** Try to recover a triangle, all edges of which must exist. Returns 1 if the
 * triangle exists now. */
int vg_flip_make_tri(struct vg_flipper *f, const uint32_t v[3], int depth);

/* --- recovery of all triangles (recover_flips.c) -------------------------- */

/** Recover missing triangles by flips, as far as possible. Triangles that exist
 * must be fixed faces, and remain so; links are maintained. missing:
 * [*n_missing] triangles that are still missing remain in the list, in order.
 */
vg_status vg_recover_flips(struct vg_tets *t, size_t n_tri,
                           const uint32_t (*tri)[3], size_t *n_missing,
                           uint32_t *missing, struct vg_error *err);

#endif
