/* core/mesh/cell_links.h: which cells of a mesh share which faces. Uses mesh.h.
 *
 * A half-face is one face of one cell, coded as 8 * cell + face, faces as in
 * cell_faces.h; cells are numbered tetrahedra, pyramids, prisms, hexahedra in
 * their order. */
#ifndef VG_CORE_MESH_CELL_LINKS_H
#define VG_CORE_MESH_CELL_LINKS_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

struct vg_cell_links {
  const struct vg_mesh *m;                    /* borrowed */
  uint32_t n_cell, end_tet, end_pyr, end_pri; /* numbers behind each kind */
  uint32_t *link;      /* [half-faces] code of the mate, or
                          VG_NO_CELL */
  uint32_t *boundary;  /* [n_tri + n_quad] half-face on each; NULL when
                          boundary faces were not looked at */
  uint64_t n_internal; /* faces between two cells */
  uint64_t n_corner;   /* nodes of all faces that are internal or on
                          the boundary */
};
#define VG_CELL_LINKS_INIT                                                     \
  {                                                                            \
    .m = NULL                                                                  \
  }
#define VG_NO_CELL UINT32_MAX

void vg_cell_links_release(struct vg_cell_links *l);

/** Find the mate of every half-face. O(n), one pass in the order of the cells;
 * a word per half-face, and four per point until it returns.
 *
 * @param is_open  1: of a part of a mesh; half-faces without a mate have none,
 *                 and boundary faces are not looked at. 0: of a whole one;
 *                 VG_ERR_INPUT names a face of a cell, or of the boundary, that
 *                 has no mate
 * @param name     of the mesh, for messages
 * VG_ERR_UNSUPPORTED: more cells, 2^29, than codes of 32 bits name, or more
 * points or boundary faces than 2^31 - 1; VG_ERR_MEMORY. */
vg_status vg_cell_links_build(struct vg_cell_links *l, const struct vg_mesh *m,
                              int is_open, const char *name,
                              struct vg_error *err);

/** Nodes of a half-face, normal out of its cell; returns 3 or 4. */
int vg_half_face_nodes(const struct vg_cell_links *l, uint32_t code,
                       uint32_t node[4]);

/** Place of a cell's first half-face in link[]; its others follow. With the
 * number of all cells, the length of link[]. */
static inline size_t vg_first_half(const struct vg_cell_links *l, uint32_t cell)
{
  assert(cell <= l->n_cell);
  if (cell < l->end_tet) return 4 * (size_t)cell;
  if (cell < l->end_pri)
    return 4 * (size_t)l->end_tet + 5 * (size_t)(cell - l->end_tet);
  return 4 * (size_t)l->end_tet + 5 * (size_t)(l->end_pri - l->end_tet) +
         6 * (size_t)(cell - l->end_pri);
}

/** Faces of a cell. */
static inline int vg_half_faces(const struct vg_cell_links *l, uint32_t cell)
{
  assert(cell < l->n_cell);
  return cell < l->end_tet ? 4 : cell < l->end_pri ? 5 : 6;
}

/** Code of the mate of a half-face, or VG_NO_CELL. */
static inline uint32_t vg_mate(const struct vg_cell_links *l, uint32_t code)
{
  assert((int)(code & 7) < vg_half_faces(l, code >> 3));
  return l->link[vg_first_half(l, code >> 3) + (code & 7)];
}

#endif
