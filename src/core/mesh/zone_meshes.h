/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/zone_meshes.h: the zones of a mesh as meshes of their own, for
 * solvers that have a mesh for each zone. Uses zones.h and sheets.h.
 *
 * An interface becomes two patches for each pair of zones that it separates:
 * one of the zone into which its triangles look, and one of the zone behind
 * them. Both have the same triangles, of opposite orientation, whose points
 * have the same coordinates. */
#ifndef VG_CORE_MESH_ZONE_MESHES_H
#define VG_CORE_MESH_ZONE_MESHES_H

#include "core/mesh/zones.h"

/** The two zones on both sides of triangles of an interface. */
struct vg_zone_pair {
  uint32_t zone[2]; /* before the triangles, and behind them */
  uint32_t sheet;   /* of the mesh */
};

struct vg_zone_parts {
  const struct vg_mesh *m;   /* borrowed */
  size_t n_pair;             /* in the order of sheets and zones */
  struct vg_zone_pair *pair; /* [n_pair] */
  size_t n_patch;            /* m->n_patch + 2 n_pair */
  struct vg_patch *patch;    /* [n_patch] those of m, then front and back of
                                each pair: NAME and NAME_back */
  uint32_t *face_zone;       /* [m->n_tri + m->n_quad] of boundary faces */
  uint32_t (*side)[2];       /* [m->n_sheet_tri] of vg_mesh_zone_sides */
  uint32_t *pair_of;         /* [m->n_sheet_tri]; UINT32_MAX: within a zone */
  uint32_t *number;          /* [m->n_point] scratch of vg_zone_part */
};
#define VG_ZONE_PARTS_INIT                                                     \
  {                                                                            \
    .m = NULL                                                                  \
  }

/** Find the zone of each face of m, which has zones and must stay valid.
 * VG_ERR_INPUT, with the place: a face of the boundary belongs to no cell.
 * VG_ERR_MEMORY. *p is empty on failure. O(n log n). */
vg_status vg_zone_parts_new(const struct vg_mesh *m, struct vg_zone_parts *p,
                            struct vg_error *err);
void vg_zone_parts_release(struct vg_zone_parts *p);

/** Zone z as a mesh: its cells and points in their order, and all patches, of
 * which some may have no faces. *out is replaced on success. O(size of m).
 * VG_ERR_MEMORY. Threads: one at a time for each p. */
vg_status vg_zone_part(struct vg_zone_parts *p, size_t z, struct vg_mesh *out,
                       struct vg_error *err);

#endif
