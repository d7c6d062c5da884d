/* core/recover/recover_flip.h: flips that make way for an edge or a triangle of
 * a surface among tetrahedra on its points. Edges and faces of the surface that
 * are there already stay.
 *
 * An edge is removed by the best triangulation of the ring around it; where
 * the ring has none, adjacent edges go first, to a bounded depth (the n-to-m
 * flips of H. Si, "TetGen, a Delaunay-based quality tetrahedral mesh
 * generator", ACM TOMS 41(2), 2015). What is in the way of an edge or a
 * triangle is counted by exact signs, and never grows; the shape of the cells
 * decides between equals. */
#ifndef VG_CORE_RECOVER_RECOVER_FLIP_H
#define VG_CORE_RECOVER_RECOVER_FLIP_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"

enum { VG_FLIP_RING = 24 }; /* cells around an edge that can be removed */

struct vg_flip_front { /* edges and triangles by their lowest point */
  size_t n_point;
  const uint32_t (*tri)[3];
  uint32_t *first_edge; /* [n_point + 1] */
  uint32_t *edge;       /* higher ends */
  uint32_t *first_tri;  /* [n_point + 1] */
  uint32_t *of_point;   /* triangles */
};

struct vg_flipper {
  struct vg_tets *t;
  struct vg_flip_front front;
  uint32_t *star; /* [front.n_point] a cell of each point */
  int n_target;   /* 2: an edge, 3: a triangle is to appear */
  uint32_t target[3];
  int budget;      /* rings that may still be looked at */
  size_t n_change; /* flips so far */
  int refused;     /* memory was refused */
  size_t n_seen, cap_seen;
  uint32_t *seen; /* cells of one search, flagged VG_TRIED */
};

/* --- the surface (recover_front.c) --------------------------------------- */

vg_status vg_flip_front_init(struct vg_flip_front *s, size_t n_point,
                             size_t n_tri, const uint32_t (*tri)[3],
                             struct vg_error *err);
void vg_flip_front_release(struct vg_flip_front *s);

/** Place of an edge in s->edge, VG_NONE where there is none. */
uint32_t vg_flip_edge_at(const struct vg_flip_front *s, uint32_t a, uint32_t b);
int vg_flip_is_tri(const struct vg_flip_front *s, const uint32_t v[3]);

/** Is triangle x y z in the way of the edge that is to appear: does that meet
 * it elsewhere than in its own ends? */
int vg_flip_obstructs(const struct vg_flipper *f, uint32_t x, uint32_t y,
                      uint32_t z);

/** Does edge p q pierce the triangle that is to appear? */
int vg_flip_pierces(const struct vg_flipper *f, uint32_t p, uint32_t q);

/* --- flips (recover_flip.c) ---------------------------------------------- */

/** Remove face i of cell c (2 cells to 3), or the edge between points a and b
 * of cell c, if that leaves less in the way of the target.
 * depth: how far edges beside the edge may go first.
 * Returns 1 when cells have changed: less is in the way, or edges beside the
 * edge are gone and no more is. */
int vg_flip_face(struct vg_flipper *f, uint32_t c, int i);
int vg_flip_edge(struct vg_flipper *f, uint32_t c, uint32_t a, uint32_t b,
                 int depth);

/* --- edges and triangles put in (recover_target.c) --------------------------
 * */

/** Is the edge there? */
int vg_flip_has_edge(const struct vg_flipper *f, uint32_t a, uint32_t b);

/** 1 when the edge is there now. depth: as for vg_flip_edge, at most 3. */
int vg_flip_make_edge(struct vg_flipper *f, uint32_t a, uint32_t b, int depth);

/** 1 when the triangle is there now; its edges must be. */
int vg_flip_make_tri(struct vg_flipper *f, const uint32_t v[3], int depth);

/* --- all of them (recover_flips.c) --------------------------------------- */

/** Make as many of the missing triangles faces of t as flips can. Those that
 * are there have to be fixed faces, and stay; links are kept up.
 * missing: [*n_missing] what is left stays in the list, in order. */
vg_status vg_recover_flips(struct vg_tets *t, size_t n_tri,
                           const uint32_t (*tri)[3], size_t *n_missing,
                           uint32_t *missing, struct vg_error *err);

#endif
