/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/surface/surface_parts.h: the steps of vg_surface_check, grouped by the
 * file that defines them. Private to core and its tests. */
#ifndef VG_CORE_SURFACE_SURFACE_PARTS_H
#define VG_CORE_SURFACE_SURFACE_PARTS_H

#include "core/mesh/edges.h"
#include "core/search/box_tree.h"
#include "core/surface/surface_check.h"

/* All faces as triangles: the n_tri of the mesh, then two halves of each
 * quadrilateral. A node is the lowest index with the same coordinates, so that
 * a surface can be checked without welding it first. */
struct vg_faces {
  size_t n, n_tri, n_point;
  const double (*point)[3];
  uint32_t (*node)[3]; /* [n] Nodes of each face. */
  uint8_t *state;      /* [n] Bits below. */
};
#define VG_FACES_INIT                                                          \
  {                                                                            \
    0                                                                          \
  }

enum {
  VG_FACE_COLLAPSED = 1, /* A repeated node. */
  VG_FACE_FLAT = 2,      /* Exactly zero area, distinct nodes. */
  VG_FACE_NOT_FINITE = 4,
  VG_FACE_COPY = 8,                              /* A copy that is reported as
                                                    such. */
  VG_FACE_OUT = VG_FACE_COLLAPSED | VG_FACE_COPY /* Excluded from the
                                                    topology. */
};

/* Index of face f in vg_defect, where quadrilaterals follow the triangles. */
static inline size_t vg_faces_source(const struct vg_faces *s, size_t f)
{
  return f < s->n_tri ? f : s->n_tri + (f - s->n_tri) / 2;
}

/* surface_faces.c ---------------------------------------------------------*/

/** Build *s (empty) from m, which is borrowed. `same` is the result of
 * vg_points_same. */
vg_status vg_faces_build(struct vg_faces *s, const struct vg_mesh *m,
                         const uint32_t *same, struct vg_error *err);

void vg_faces_release(struct vg_faces *s);

/** Build the edges of the faces that belong to the topology. */
static inline vg_status vg_faces_edges(const struct vg_faces *s,
                                       struct vg_edges *e, struct vg_error *err)
{
  return vg_edges_build(e, s->n_point, s->n, (const uint32_t(*)[3])s->node,
                        s->state, VG_FACE_OUT, err);
}

/** Do the two faces of edge i run along it in the same direction? */
static inline int vg_faces_disagree(const struct vg_faces *s,
                                    const struct vg_edges *e, size_t i)
{
  return vg_edges_disagree(e, (const uint32_t(*)[3])s->node, i);
}

/** Faces with the same three nodes, collapsed ones included: (*first)[f] is the
 * lowest such face, which is f itself for most faces. The caller frees it.
 * O(n). */
vg_status vg_faces_duplicate(const struct vg_faces *s, uint32_t **first,
                             struct vg_error *err);

/** Do two faces with the same nodes face the same side? */
int vg_faces_same_side(const uint32_t a[3], const uint32_t b[3]);

/* surface_copies.c --------------------------------------------------------*/

/* Classes of faces with the same three nodes. */
enum vg_copy {
  VG_COPY_NONE, /* No other face has the same nodes. */
  VG_COPY_SKIN, /* A piece of a skin that occurs twice or more. */
  VG_COPY_WALL, /* A wall shared by two bodies: without both faces, every edge
                   of its border has two faces. */
  VG_COPY_PART, /* Such a wall, but its border has other edges as well. */
  VG_COPY_OTHER /* A wall of zero thickness. */
};

/** Classify each face: (*copy)[f] is an enum vg_copy. The caller frees it.
 *
 * @param first  result of vg_faces_duplicate
 * O(n log n). */
vg_status vg_faces_copies(const struct vg_faces *s, const uint32_t *first,
                          uint8_t **copy, struct vg_error *err);

/* surface_weld.c ----------------------------------------------------------*/

/** (*same)[p] is the lowest index with the coordinates of p; points that are
 * not finite equal only themselves. The caller frees it. O(n). */
vg_status vg_points_same(const struct vg_mesh *m, uint32_t **same,
                         struct vg_error *err);

/** (*near)[p] is the lowest index among the points that are connected with p by
 * steps of at most `tolerance` (0: equal coordinates). The caller frees it.
 * O(n). */
vg_status vg_points_near(const struct vg_mesh *m, double tolerance,
                         uint32_t **near, struct vg_error *err);

/** Returns VG_ERR_INPUT for the first boundary face or cell with a node out of
 * range, or face without a patch. */
vg_status vg_mesh_check_index(const struct vg_mesh *m, struct vg_error *err);

/** Replace node p by map[p] everywhere, drop the points with keep[p] == 0,
 * which must be unused (keep NULL: all stay), and close the gaps in the
 * numbering. Cannot fail. map is used as scratch and contains the new index of
 * every kept point afterwards. */
void vg_mesh_renumber(struct vg_mesh *m, uint32_t *map, const uint8_t *keep);

/** Drop the triangles with drop[t] != 0, keeping the order of the others. */
size_t vg_mesh_drop_tri(struct vg_mesh *m, const uint8_t *drop);

/* surface_orient.c --------------------------------------------------------*/

/** Decide which faces to turn so that neighbours agree: flip[f] ^= 1 for the
 * smaller number of faces of each component of manifold edges; in case of a tie
 * the lowest face stays. One-sided components are left unchanged. O(n). */
vg_status vg_orient_faces(const struct vg_faces *s, const struct vg_edges *e,
                          uint8_t *flip, struct vg_error *err);

/** Label the umbrellas: corners with the same (*fan)[f][k] belong to faces that
 * are connected around their node through common edges. A node of a sound
 * surface has one umbrella; where a node joins several sheets, each sheet has
 * its own. Sheets that meet in an edge share its umbrellas: there the edge is
 * the defect. The caller frees the result. O(n). */
vg_status vg_label_fans(const struct vg_faces *s, const struct vg_edges *e,
                        uint32_t (**fan)[3], struct vg_error *err);

/** Count the components connected by nodes. O(n). */
vg_status vg_count_components(const struct vg_faces *s, size_t *n_piece,
                              struct vg_error *err);

/** Number the edge-connected components by their lowest face: shell[f],
 * UINT32_MAX for faces that are VG_FACE_OUT. O(n). */
vg_status vg_label_shells(const struct vg_faces *s, const struct vg_edges *e,
                          uint32_t *shell, size_t *n_shell,
                          struct vg_error *err);

/* surface_tree.c ----------------------------------------------------------*/

/** Build the tree of the bounding boxes of the faces with state 0; its items
 * are faces. O(n log n). VG_ERR_MEMORY. */
vg_status vg_faces_tree(struct vg_box_tree *t, const struct vg_faces *s,
                        struct vg_error *err);

/* surface_intersect.c -----------------------------------------------------*/

struct vg_crossing {
  size_t n_pair;
  size_t n_listed;      /* n_pair, or 0 beyond VG_SURFACE_PAIR_MAX. */
  uint32_t (*pair)[2];  /* [n_listed] Sorted; the lower face first. */
  uint32_t *partner;    /* [n_face] Lowest face that intersects it; UINT32_MAX:
                           none. */
  uint8_t *other_shell; /* [n_shell] 1: intersects another shell. */
};
#define VG_CROSSING_INIT                                                       \
  {                                                                            \
    0                                                                          \
  }

/** Find all intersecting pairs.
 *
 * @param first  result of vg_faces_duplicate: of faces with the same nodes only
 *               the first is tested; the others are duplicates */
vg_status vg_find_crossings(struct vg_crossing *c, const struct vg_faces *s,
                            const uint32_t *first, const uint32_t (*fan)[3],
                            const struct vg_box_tree *t, const uint32_t *shell,
                            size_t n_shell, int threads,
                            const struct vg_stop *stop, struct vg_error *err);

void vg_crossing_release(struct vg_crossing *c);

/* surface_shell.c ---------------------------------------------------------*/

/* Properties and faults of a shell; bits. */
enum {
  VG_SHELL_FLAT = 1,     /* Encloses no volume. */
  VG_SHELL_MIXED = 2,    /* Neighbours disagree: the shell has no sides. */
  VG_SHELL_REVERSED = 4, /* Solid and fluid are exchanged. */
  VG_SHELL_STRAY = 8     /* Inside another shell, with the solid on the same
                            side. */
};

/** Set all members of shell[] except parent and depth, and state[] (FLAT and
 * MIXED). Faces with flip[f] count as turned. O(n). */
vg_status vg_measure_shells(struct vg_shell *shell, uint8_t *state,
                            size_t n_shell, const struct vg_faces *s,
                            const struct vg_edges *e, const uint32_t *of_face,
                            const uint8_t *flip, struct vg_error *err);

/** Set parent and depth of the closed shells by exact ray parity. */
vg_status vg_nest_shells(struct vg_shell *shell, size_t n_shell,
                         const struct vg_faces *s, const struct vg_box_tree *t,
                         const uint32_t *of_face, struct vg_error *err);

/** Check the side of each closed shell. Sets state[] (REVERSED and STRAY) and,
 * with `repair`, turn[i] for shells to turn, whose volumes change sign.
 *
 * @param crossed  [n_shell] shells that intersect others: turned only if
 *                 outermost, and never STRAY, since their nesting is
 *                 undefined */
vg_status vg_orient_shells(struct vg_shell *shell, uint8_t *state,
                           size_t n_shell, int external, int repair,
                           const uint8_t *crossed, uint8_t *turn,
                           struct vg_error *err);

#endif
