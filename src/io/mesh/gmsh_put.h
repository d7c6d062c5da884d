/* io/mesh/gmsh_put.h: the parts of a .msh file, for its writer and for that of
 * meshes in slices, which has them written by all ranks
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_MESH_GMSH_PUT_H
#define VG_IO_MESH_GMSH_PUT_H

#include "core/mesh/mesh.h"
#include "io/stream/patch_words.h"
#include "io/stream/stream.h"

enum { VG_GMSH_KINDS = 4 }; /* tetrahedra, pyramids, prisms, hexahedra */

/** Layout of a file: follows from counts and boundary of the frame. */
struct vg_gmsh {
  const struct vg_mesh *frame;
  char (*word)[VG_PATCH_WORD]; /* [n_patch] */
  size_t *face_first, *face;   /* vg_boundary_by_patch */
  size_t n_surface;            /* patches with faces */
  int has_ids;                 /* patches keep their numbers */
  uint64_t n_cell[VG_GMSH_KINDS];
  /* where in the file they begin */
  uint64_t at_entities, at_tag, at_point, at[VG_GMSH_KINDS];
  uint64_t first[VG_GMSH_KINDS]; /* tag of the first cell */
};

/** VG_ERR_INPUT: neither faces nor cells. On success to be released. */
vg_status vg_gmsh_plan(const char *path, const struct vg_mesh *frame,
                       struct vg_gmsh *g, struct vg_error *err);
void vg_gmsh_release(struct vg_gmsh *g);

/** The whole file; of a frame entities, cells and points are skipped. */
void vg_gmsh_put(struct vg_output *out, const struct vg_gmsh *g);

/** The section of entities, which has the boxes of patches, where the output
 * stands, which should be at_entities.
 * @param x  points of the boundary faces, by the mesh's numbers */
void vg_gmsh_put_entities(struct vg_output *out, const struct vg_gmsh *g,
                          const double (*x)[3]);

/** Points numbered from `point` on, x [n][3]: their tags and coordinates. Of a
 * shared file the output goes to their places. */
void vg_gmsh_seek_tags(struct vg_output *out, const struct vg_gmsh *g,
                       uint64_t point);
void vg_gmsh_seek_points(struct vg_output *out, const struct vg_gmsh *g,
                         uint64_t point);
void vg_gmsh_put_tags(struct vg_output *out, uint64_t point, size_t n);

/** Go to a cell of a kind. */
void vg_gmsh_seek_cell(struct vg_output *out, const struct vg_gmsh *g, int kind,
                       uint64_t cell);

/** n cells of a kind from `cell` on with the points node, number[node] where
 * number is not NULL. */
void vg_gmsh_put_cells(struct vg_output *out, const struct vg_gmsh *g, int kind,
                       uint64_t cell, size_t n, const uint32_t *node,
                       const uint32_t *number);

#endif
