/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/gmsh_put.h: functions that write parts of a .msh file, for the serial
 * writer and for the writer of slices, in which all ranks write
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_MESH_GMSH_PUT_H
#define VG_IO_MESH_GMSH_PUT_H

#include "core/mesh/mesh.h"
#include "core/periodic/periodic.h"
#include "io/stream/patch_words.h"
#include "io/stream/stream.h"

enum { VG_GMSH_KINDS = 4 }; /* tetrahedra, pyramids, prisms, hexahedra */

/** Layout of a file; determined by counts and boundary of the frame. */
struct vg_gmsh {
  const struct vg_mesh *frame;
  char (*word)[VG_PATCH_WORD]; /* [n_patch] */
  size_t *face_first, *face;   /* from vg_boundary_by_patch */
  size_t n_surface;            /* number of patches with faces */
  int has_ids;                 /* patches keep their ids */
  size_t n_volume;             /* 1 with cells, or the number of zones */
  int32_t volume; /* number of the first volume and of its group; the others
                     follow */
  char (*volume_word)[VG_PATCH_WORD]; /* [n_volume] names of these groups */
  uint64_t n_cell[VG_GMSH_KINDS];
  /* Offsets in the file. */
  uint64_t at_entities, at_tag, at_point, at[VG_GMSH_KINDS];
  uint64_t first[VG_GMSH_KINDS]; /* tag of the first cell */
};

/** Compute the layout. Patches with is_sheet do not bound the volume
 * (vg_mesh_sheet_view). VG_ERR_INPUT: neither faces nor cells. Must be released
 * after success. */
vg_status vg_gmsh_plan(const char *path, const struct vg_mesh *frame,
                       struct vg_gmsh *g, struct vg_error *err);
void vg_gmsh_release(struct vg_gmsh *g);

/** Write the whole file. For a frame, entities, cells and points are
 * skipped. */
void vg_gmsh_put(struct vg_output *out, const struct vg_gmsh *g);

/** Write the section of entities, which contains the bounding boxes of patches,
 * at the current position, which should be at_entities.
 * @param x  coordinates of the boundary points, by their numbers in the mesh */
void vg_gmsh_put_entities(struct vg_output *out, const struct vg_gmsh *g,
                          const double (*x)[3]);

/** Number of a patch as a surface. */
int32_t vg_gmsh_tag(const struct vg_gmsh *g, size_t patch);

/** Write the section of periodic surfaces after the whole file: the image as a
 * surface whose master is the patch, with the transform and pairs of points.
 * Nothing without pairs. Call vg_output_order(out, 0) first. */
void vg_gmsh_put_periodic(struct vg_output *out, const struct vg_gmsh *g,
                          const struct vg_periodic_links *links);

/** Write tags and coordinates x [n][3] of points numbered from `point` on. In a
 * shared file, the _seek functions move to their positions first. */
void vg_gmsh_seek_tags(struct vg_output *out, const struct vg_gmsh *g,
                       uint64_t point);
void vg_gmsh_seek_points(struct vg_output *out, const struct vg_gmsh *g,
                         uint64_t point);
void vg_gmsh_put_tags(struct vg_output *out, uint64_t point, size_t n);

/** Move to a cell of a kind. */
void vg_gmsh_seek_cell(struct vg_output *out, const struct vg_gmsh *g, int kind,
                       uint64_t cell);

/** Write n cells of a kind and one zone, starting with number `cell`. Their
 * points are node,
 * or number[node] if number is not NULL. */
void vg_gmsh_put_cells(struct vg_output *out, const struct vg_gmsh *g, int kind,
                       uint64_t cell, size_t n, const uint32_t *node,
                       const uint32_t *number);

#endif
