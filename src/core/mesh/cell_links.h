/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/cell_links.h: which cells of a mesh share which faces. Uses
 * mesh.h.
 *
 * A half-face is one face of one cell. Its code is 8 * cell + face, with faces
 * numbered as in cell_faces.h and cells numbered in the order tetrahedra,
 * pyramids, prisms, hexahedra. */
#ifndef VG_CORE_MESH_CELL_LINKS_H
#define VG_CORE_MESH_CELL_LINKS_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

struct vg_cell_links {
  const struct vg_mesh *m;                    /* borrowed */
  uint32_t n_cell, end_tet, end_pyr, end_pri; /* end of the numbers of each
                                                 kind */
  uint32_t *link;      /* [half-faces] code of the mate, or VG_NO_CELL */
  uint32_t *boundary;  /* [n_tri + n_quad] half-face on each boundary face;
                          NULL if is_open */
  uint64_t n_internal; /* faces between two cells */
  uint64_t n_corner;   /* total number of nodes of all faces that are
                          internal or on the boundary */
};
#define VG_CELL_LINKS_INIT                                                     \
  {                                                                            \
    .m = NULL                                                                  \
  }
#define VG_NO_CELL UINT32_MAX

void vg_cell_links_release(struct vg_cell_links *l);

/** Find the mate of every half-face. O(n), one pass in the order of the cells.
 * Memory: one word per half-face, and during the call four per point.
 *
 * @param is_open  1: m is a part of a mesh; half-faces may lack a mate, and
 *                 boundary faces are ignored. 0: m is a whole mesh;
 *                 VG_ERR_INPUT names a cell face or boundary face without a
 *                 mate
 * @param name     name of the mesh, for messages
 *
 * VG_ERR_UNSUPPORTED: more than the 2^29 cells that 32-bit codes can name, or
 * more than 2^31 - 1 points or boundary faces. VG_ERR_MEMORY. */
vg_status vg_cell_links_build(struct vg_cell_links *l, const struct vg_mesh *m,
                              int is_open, const char *name,
                              struct vg_error *err);

/** Nodes of a half-face, with the normal out of its cell. Returns 3 or 4. */
int vg_half_face_nodes(const struct vg_cell_links *l, uint32_t code,
                       uint32_t node[4]);

/** Index of the first half-face of a cell in link[]; its other half-faces
 * follow. For cell = n_cell this is the length of link[]. */
static inline size_t vg_first_half(const struct vg_cell_links *l, uint32_t cell)
{
  assert(cell <= l->n_cell);
  if (cell < l->end_tet) return 4 * (size_t)cell;
  if (cell < l->end_pri)
    return 4 * (size_t)l->end_tet + 5 * (size_t)(cell - l->end_tet);
  return 4 * (size_t)l->end_tet + 5 * (size_t)(l->end_pri - l->end_tet) +
         6 * (size_t)(cell - l->end_pri);
}

/** Number of faces of a cell. */
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
