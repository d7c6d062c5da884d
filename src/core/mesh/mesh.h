/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/mesh.h: the mesh that readers fill, the mesher consumes and
 * produces, and writers store. A surface is a mesh without cells. Uses base
 * only.
 *
 * Conventions inside the program (readers convert from the conventions of
 * their file format):
 *   - indices are 0-based and 32-bit within one mesh;
 *   - boundary faces point INTO the fluid (right-hand normal), as in VGRID;
 *   - cells have UGRID's node order: tet 0 1 2 counter-clockwise seen from 3;
 *     pyramid base 0 3 4 1 with apex 2; prism 0 1 2 below 3 4 5; hex 0..3
 *     below 4..7 (formats.md 2.3). All cells have positive volume. */
#ifndef VG_CORE_MESH_MESH_H
#define VG_CORE_MESH_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#define VG_NAME_MAX 80

/* Boundary conditions are stored as codes of both solvers. 0 is a valid USM3D
 * code, so "not given" has a value of its own. */
#define VG_BC_NONE INT32_MIN

/* Magnitudes of coordinates that are not 0. Predicates are exact for them
 * (core/geometry/predicates.h), and squares of lengths between 1e-17 and 1e18
 * are normal numbers in single precision, in which point placement, load and
 * clearance compare distances. */
#define VG_COORDINATE_MIN 1e-45
#define VG_COORDINATE_MAX 1e15

/* Part of an inner surface, which has fluid on both sides. */
enum { VG_INNER_NOT, VG_INNER_FRONT, VG_INNER_BACK };

#define VG_SHEET_GONE 2

/** A named part of the boundary. */
struct vg_patch {
  int32_t id;           /* number in the files; any value, unique */
  int32_t bc;           /* USM3D code (formats.md 1.4), or VG_BC_NONE */
  int32_t bc_fun3d;     /* FUN3D code, or VG_BC_NONE */
  int32_t family;       /* VGRID family column; equal to bc if unknown */
  int32_t inner;        /* VG_INNER_...: side of an inner surface; its other
                           side has the same triangles, reversed */
  int32_t is_sheet;     /* 1: an inner surface through which the mesh is
                           connected (core/mesh/sheets.h); VG_SHEET_GONE: a
                           patch without triangles that goes away with the
                           sheets */
  int32_t is_split;     /* 1: a sheet with layers: until the mesh is complete,
                           its sides have points of their own, as those of a
                           baffle */
  int32_t is_interface; /* 1: a sheet that separates zones, or a wall between a
                           zone and one without cells */
  char name[VG_NAME_MAX]; /* empty if the file gives no name */
};

/** Is p a side of an interface whose sides are both parts of the boundary
 * (core/mesh/double_faces.h)? The back follows its front. */
static inline int vg_patch_is_sliding(const struct vg_patch *p)
{
  return p->is_interface && p->inner && !p->is_sheet;
}

/* Kinds of zones. */
enum { VG_ZONE_FLUID, VG_ZONE_ROTATING, VG_ZONE_POROUS, VG_ZONE_SOLID };

/** A named part of the cells (core/mesh/zones.h). */
struct vg_zone {
  int32_t id;         /* number in the files, unique, > 0 */
  int32_t kind;       /* VG_ZONE_... */
  uint64_t n_cell[4]; /* tetrahedra, pyramids, prisms, hexahedra */
  char name[VG_NAME_MAX];
};

struct vg_mesh {
  size_t n_point, n_tri, n_quad, n_tet, n_pyr, n_pri, n_hex, n_patch;
  double (*point)[3];     /* [n_point], length unit of the input */
  uint32_t (*tri)[3];     /* [n_tri] boundary triangles */
  uint32_t (*quad)[4];    /* [n_quad] boundary quadrilaterals */
  uint32_t *tri_patch;    /* [n_tri] index into patch[] */
  uint32_t *quad_patch;   /* [n_quad] index into patch[] */
  uint32_t (*tet)[4];     /* [n_tet] */
  uint32_t (*pyr)[5];     /* [n_pyr] */
  uint32_t (*pri)[6];     /* [n_pri] */
  uint32_t (*hex)[8];     /* [n_hex] */
  struct vg_patch *patch; /* [n_patch] */
  /* Sheets: named faces between two cells. They are not in tri. */
  size_t n_sheet_tri, n_sheet;
  uint32_t (*sheet_tri)[3]; /* [n_sheet_tri] of any orientation */
  uint32_t *sheet_of;       /* [n_sheet_tri] index into sheet[] */
  struct vg_patch *sheet;   /* [n_sheet] numbers and names */
  /* Zones: cells of each kind are in the order of their zones. */
  size_t n_zone;
  struct vg_zone *zone; /* [n_zone]; 0: all cells are one nameless zone */
  int is_resorted; /* 1: the cells of a file were not in the order of zones */
};
#define VG_MESH_INIT                                                           \
  {                                                                            \
    0                                                                          \
  } /* releasing this is a no-op */

/** Free all arrays and leave *m empty. Accepts an empty mesh. */
void vg_mesh_release(struct vg_mesh *m);

/** Move *from into *to: `to` is released first, and `from` is left empty. */
void vg_mesh_move(struct vg_mesh *to, struct vg_mesh *from);

/** Deep copy of `from` into the empty mesh *to. VG_ERR_MEMORY if memory is
 * refused. */
vg_status vg_mesh_copy(struct vg_mesh *to, const struct vg_mesh *from,
                       struct vg_error *err);

/** Index in m->patch of the patch with number id, or SIZE_MAX. */
size_t vg_mesh_find_patch(const struct vg_mesh *m, int32_t id);

/** Index of patch `id`. If there is no such patch, it is appended with the
 * given name (NULL: "") and no boundary condition. SIZE_MAX if memory is
 * refused. */
size_t vg_mesh_add_patch(struct vg_mesh *m, int32_t id, const char *name);

/** Lower and upper corner of the bounding box of all points; both zero for an
 * empty mesh. */
void vg_mesh_bounds(const struct vg_mesh *m, double lo[3], double hi[3]);

/** Number of cells of all kinds. */
static inline size_t vg_mesh_n_cell(const struct vg_mesh *m)
{
  return m->n_tet + m->n_pyr + m->n_pri + m->n_hex;
}

/** Nodes of the cells of a kind, one cell after the other. 0: tetrahedra, 1:
 * pyramids, 2: prisms, 3: hexahedra. */
static inline uint32_t *vg_mesh_nodes(const struct vg_mesh *m, int kind)
{
  uint32_t *const cell[4] = { (uint32_t *)m->tet, (uint32_t *)m->pyr,
                              (uint32_t *)m->pri, (uint32_t *)m->hex };

  return cell[kind];
}

/** Longest side of the bounding box of all points; 0 for an empty mesh. */
double vg_mesh_length(const struct vg_mesh *m);

/** Highest number of a patch or sheet, at least 0. */
int32_t vg_mesh_last_id(const struct vg_mesh *m);

#endif
