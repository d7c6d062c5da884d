/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/gmsh_parts.h: patches of a Gmsh file. Private to io/mesh. */
#ifndef VG_IO_MESH_GMSH_PARTS_H
#define VG_IO_MESH_GMSH_PARTS_H

#include "core/mesh/mesh.h"

/* The name of a physical group of surfaces or volumes. */
struct vg_gmsh_name {
  int dimension;
  int64_t tag; /* number of the group */
  char text[VG_NAME_MAX];
};

/* The surface of a face, or the volume of a cell, and its physical group; 0: it
 * is not in a group. */
struct vg_gmsh_group {
  int64_t surface, physical;
};

/* A volume and a surface that bounds it. */
struct vg_gmsh_side {
  int64_t surface, volume;
};

/** The physical group of a surface or volume; 0: none.
 * @param group  [n] sorted by surface */
int64_t vg_gmsh_physical(const struct vg_gmsh_group *group, size_t n,
                         int64_t surface);

/** Interfaces and zones of a surface mesh (vg_gmsh_read_volumes).
 *
 * @param face    of triangles [m->n_tri], of quadrilaterals [m->n_quad]
 * @param group   [n_group] of the volumes, sorted
 * @param side    [n_side] sorted here
 * @param zones   in: empty
 * VG_ERR_INPUT, VG_ERR_MEMORY; VG_ERR_UNSUPPORTED: no number is left for an
 * interface. */
vg_status vg_gmsh_set_volumes(struct vg_mesh *m,
                              struct vg_gmsh_group *const face[2],
                              size_t n_group, const struct vg_gmsh_group *group,
                              size_t n_side, struct vg_gmsh_side *side,
                              size_t n_name, const struct vg_gmsh_name *name,
                              const char *path, struct vg_cad_zones *zones,
                              struct vg_error *err);

/** Create the patches of a mesh. Their ids are the physical groups if any face
 * has one, otherwise the surfaces.
 *
 * @param face  of triangles [m->n_tri], of quadrilaterals [m->n_quad]
 * @param name  [n_name] names of groups
 * VG_ERR_UNSUPPORTED: a number exceeds 32 bits; VG_ERR_MEMORY. */
vg_status vg_gmsh_set_patches(struct vg_mesh *m,
                              struct vg_gmsh_group *const face[2],
                              size_t n_name, const struct vg_gmsh_name *name,
                              const char *path, struct vg_error *err);

/** Create the zones of a mesh from the volumes of its cells, by the same rules;
 * a mesh whose cells have one number has none.
 * @param cell  of tetrahedra, pyramids, prisms, hexahedra, [n] each
 * Cells are sorted by their zones. Errors as vg_gmsh_set_patches. */
vg_status vg_gmsh_set_zones(struct vg_mesh *m,
                            struct vg_gmsh_group *const cell[4], size_t n_name,
                            const struct vg_gmsh_name *name, const char *path,
                            struct vg_error *err);

#endif
