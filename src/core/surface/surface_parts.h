/* core/surface/surface_parts.h: the steps of vg_surface_check, each in the file
 * named above its functions. Private to core and its tests. */
#ifndef VG_CORE_SURFACE_SURFACE_PARTS_H
#define VG_CORE_SURFACE_SURFACE_PARTS_H

#include "core/mesh/edges.h"
#include "core/search/box_tree.h"
#include "core/surface/surface_check.h"

/* All faces as triangles: the n_tri of the mesh, then two halves of each
 * quadrilateral. Nodes are the lowest index with the same coordinates, so
 * that a surface need not be welded to be judged. */
struct vg_faces {
  size_t n, n_tri, n_point;
  const double (*point)[3];
  uint32_t (*node)[3]; /* [n] */
  uint8_t *state;      /* [n] bits below */
};
#define VG_FACES_INIT                                                          \
  {                                                                            \
    0                                                                          \
  }

enum {
  VG_FACE_COLLAPSED = 1, /* a repeated node */
  VG_FACE_FLAT = 2,      /* exactly zero area, nodes distinct */
  VG_FACE_NOT_FINITE = 4,
  VG_FACE_COPY = 8, /* a copy that is reported as such */
  VG_FACE_OUT = VG_FACE_COLLAPSED | VG_FACE_COPY /* no part of the topology */
};

/* Index of face f as vg_defect counts: quadrilaterals after the triangles. */
static inline size_t vg_faces_source(const struct vg_faces *s, size_t f)
{
  return f < s->n_tri ? f : s->n_tri + (f - s->n_tri) / 2;
}

/* surface_faces.c ---------------------------------------------------------*/

/** Build *s (empty) over m, which is borrowed; `same` as from
 * vg_points_same. */
vg_status vg_faces_build(struct vg_faces *s, const struct vg_mesh *m,
                         const uint32_t *same, struct vg_error *err);

void vg_faces_release(struct vg_faces *s);

/** Edges of the faces that are part of the topology. */
static inline vg_status vg_faces_edges(const struct vg_faces *s,
                                       struct vg_edges *e, struct vg_error *err)
{
  return vg_edges_build(e, s->n_point, s->n, (const uint32_t(*)[3])s->node,
                        s->state, VG_FACE_OUT, err);
}

/** The faces of edge i, which has two, run along it the same way. */
static inline int vg_faces_disagree(const struct vg_faces *s,
                                    const struct vg_edges *e, size_t i)
{
  return vg_edges_disagree(e, (const uint32_t(*)[3])s->node, i);
}

/** Faces of the same three nodes: (*first)[f] is the lowest such face, f
 * itself for most, collapsed ones included. The caller frees it. O(n). */
vg_status vg_faces_duplicate(const struct vg_faces *s, uint32_t **first,
                             struct vg_error *err);

/** Whether two faces with the same nodes look to the same side. */
int vg_faces_same_side(const uint32_t a[3], const uint32_t b[3]);

/* surface_copies.c --------------------------------------------------------*/

/* What faces with the same three nodes are. */
enum vg_copy {
  VG_COPY_NONE, /* no other face has the nodes */
  VG_COPY_SKIN, /* a piece of a skin that is there twice or more */
  VG_COPY_WALL, /* a wall that two bodies share: without both faces
                   every edge of its border has two faces */
  VG_COPY_PART, /* such a wall, but the border has other edges */
  VG_COPY_OTHER /* a wall without thickness */
};

/** (*copy)[f], an enum vg_copy, for each face; the caller frees it.
 * @param first  as from vg_faces_duplicate
 * O(n log n). */
vg_status vg_faces_copies(const struct vg_faces *s, const uint32_t *first,
                          uint8_t **copy, struct vg_error *err);

/* surface_weld.c ----------------------------------------------------------*/

/** (*same)[p] is the lowest index with the coordinates of p; points that are
 * not finite equal only themselves. The caller frees it. O(n). */
vg_status vg_points_same(const struct vg_mesh *m, uint32_t **same,
                         struct vg_error *err);

/** (*near)[p] is the lowest index of the points that are connected with p by
 * steps of at most `tolerance` (0: equal coordinates). The caller frees it.
 * O(n). */
vg_status vg_points_near(const struct vg_mesh *m, double tolerance,
                         uint32_t **near, struct vg_error *err);

/** VG_ERR_INPUT naming the first boundary face or cell with a node that is
 * no point, or face without a patch. */
vg_status vg_mesh_check_index(const struct vg_mesh *m, struct vg_error *err);

/** Replace node p by map[p] everywhere, drop the points with keep[p] == 0
 * (none is used any more; keep NULL: all stay) and close the gaps. Cannot fail;
 * map is used as scratch and holds the new index of every kept point
 * afterwards. */
void vg_mesh_renumber(struct vg_mesh *m, uint32_t *map, const uint8_t *keep);

/** Drop the triangles with drop[t] != 0, keeping the order of the others. */
size_t vg_mesh_drop_tri(struct vg_mesh *m, const uint8_t *drop);

/* surface_orient.c --------------------------------------------------------*/

/** Decide which faces to turn so that neighbours agree: flip[f] ^= 1 for the
 * fewer faces of each two-manifold component, the one with the lowest face
 * staying on a tie; one-sided components are left as they are. O(n). */
vg_status vg_orient_faces(const struct vg_faces *s, const struct vg_edges *e,
                          uint8_t *flip, struct vg_error *err);

/** (*fan)[f][k]: corners with the same number belong to faces that hang
 * together around their node through common edges. A node of a clean surface
 * has one fan; where a node joins several sheets, each has its own. Sheets
 * that meet in an edge share its fans: the edge is the defect. The caller
 * frees it. O(n). */
vg_status vg_label_fans(const struct vg_faces *s, const struct vg_edges *e,
                        uint32_t (**fan)[3], struct vg_error *err);

/** Number of components connected by nodes. O(n). */
vg_status vg_count_components(const struct vg_faces *s, size_t *n_piece,
                              struct vg_error *err);

/** Number the edge-connected components by their lowest face: shell[f],
 * UINT32_MAX for faces that are VG_FACE_OUT. O(n). */
vg_status vg_label_shells(const struct vg_faces *s, const struct vg_edges *e,
                          uint32_t *shell, size_t *n_shell,
                          struct vg_error *err);

/* surface_tree.c ----------------------------------------------------------*/

/** Tree over the boxes of the faces whose state is 0; its items are faces.
 * O(n log n). VG_ERR_MEMORY. */
vg_status vg_faces_tree(struct vg_box_tree *t, const struct vg_faces *s,
                        struct vg_error *err);

/* surface_intersect.c -----------------------------------------------------*/

struct vg_crossing {
  size_t n_pair;
  size_t n_listed;      /* n_pair, or 0 beyond VG_SURFACE_PAIR_MAX */
  uint32_t (*pair)[2];  /* [n_listed] lower face first, sorted */
  uint32_t *partner;    /* [n_face] lowest face met, UINT32_MAX: none */
  uint8_t *other_shell; /* [n_shell] meets another shell */
};
#define VG_CROSSING_INIT                                                       \
  {                                                                            \
    0                                                                          \
  }

/** @param first  as from vg_faces_duplicate: of faces with the same nodes only
 *                the first takes part; the others are duplicates */
vg_status vg_find_crossings(struct vg_crossing *c, const struct vg_faces *s,
                            const uint32_t *first, const uint32_t (*fan)[3],
                            const struct vg_box_tree *t, const uint32_t *shell,
                            size_t n_shell, int threads,
                            const struct vg_stop *stop, struct vg_error *err);

void vg_crossing_release(struct vg_crossing *c);

/* surface_shell.c ---------------------------------------------------------*/

/* What is known of a shell, or wrong with it; bits. */
enum {
  VG_SHELL_FLAT = 1,     /* encloses no volume */
  VG_SHELL_MIXED = 2,    /* neighbours disagree: it has no sides */
  VG_SHELL_REVERSED = 4, /* solid and fluid exchanged */
  VG_SHELL_STRAY = 8     /* within another, solid on the same side */
};

/** All of shell[] but parent and depth, and state[] (FLAT and MIXED); faces
 * with flip[f] count as turned. O(n). */
vg_status vg_measure_shells(struct vg_shell *shell, uint8_t *state,
                            size_t n_shell, const struct vg_faces *s,
                            const struct vg_edges *e, const uint32_t *of_face,
                            const uint8_t *flip, struct vg_error *err);

/** parent and depth of the closed shells by exact ray parity. */
vg_status vg_nest_shells(struct vg_shell *shell, size_t n_shell,
                         const struct vg_faces *s, const struct vg_box_tree *t,
                         const uint32_t *of_face, struct vg_error *err);

/** Judge the side of each closed shell: state[] (REVERSED and STRAY), and
 * when `repair`, turn[i] for those to turn; their volume changes sign.
 * @param crossed  [n_shell] shells that meet another: only turned when
 *                 outermost and never called stray, since where they lie is
 *                 not defined */
vg_status vg_orient_shells(struct vg_shell *shell, uint8_t *state,
                           size_t n_shell, int external, int repair,
                           const uint8_t *crossed, uint8_t *turn,
                           struct vg_error *err);

#endif
