/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/section/section_surface.h: the surfaces of a mesh in two dimensions.
 *
 * A section becomes a strip: walls between the planes z = 0 and z = width, two
 * triangles on each edge. The slab is the strip with a farfield and the two
 * planes, patches "back" (z = 0) and "front". On it layers grow as on any
 * surface, with columns that slide in the planes:
 *
 *     front    +-----+-----+            The first half of the points of strips,
 *            / |\    |    /|            and of walls and farfield of a slab, is
 *           /  |  \  |  /  |  walls     in the plane z = 0. The other half has
 *     back +   +-----+-----+            the same order.
 *
 * The mesh is that of the plane z = 0. Uses core, io/section. */
#ifndef VG_RUN_SECTION_SECTION_SURFACE_H
#define VG_RUN_SECTION_SECTION_SURFACE_H

#include "core/curve/curve.h"
#include "core/domain/planar_patch.h"
#include "core/mesh/mesh.h"
#include "io/section/section.h"

/** The strip of the given points, with a patch for each element: "aerofoil" or
 * "element_2" if it has no title. VG_ERR_MEMORY. */
vg_status vg_section_strip(const struct vg_section *s, struct vg_mesh *out,
                           struct vg_error *err);

/** Shares of the local chord, the largest distance of a point of an element
 * from its first point, the trailing edge. */
struct vg_section_shares {
  double nose, corner; /* 0: not given. */
};

/** Features of the curve of an element. */
struct vg_section_found {
  size_t n_corner, n_edge;
  double chord, base; /* base: length of a blunt trailing edge; 0: sharp or
                         smooth. */
  double start[2];    /* First point. */
  int is_corner;      /* 1: the first point is a corner. */
  double turn, at[2]; /* Largest turn at a smooth point, in radians; and where.
                       */
};

/** Replaces the points of a strip by those of the curves through them with the
 * requested edges (core/curve/curve.h). A blunt trailing edge has
 * sizes->n_base edges.
 *
 * @param sizes  corner and nose are not used
 * @param found  out: [strip->n_patch]
 * VG_ERR_INPUT: the first point of an element with corners is not its trailing
 * edge; the message gives the corner. VG_ERR_MEMORY. */
vg_status vg_section_divide(struct vg_mesh *strip,
                            const struct vg_outline_sizes *sizes,
                            const struct vg_section_shares *shares,
                            struct vg_section_found *found,
                            struct vg_error *err);

enum vg_section_shape {
  VG_SECTION_CIRCLE,
  VG_SECTION_BOX,
  VG_SECTION_C,     /* Half circle upstream, straight downstream. */
  VG_SECTION_TUNNEL /* Box with walls below and above. */
};

/** A closed boundary around the section. */
struct vg_section_outer {
  enum vg_section_shape shape;
  double centre[2], radius; /* Circle and C. */
  double lo[2], hi[2];      /* Box and tunnel; C: hi[0] is its end. */
};

/** Completes a strip to a slab by a farfield and the two planes, which are
 * triangulated. Patches are added: farfield, or lower, upper, inlet and outlet
 * of a tunnel; then the planes.
 *
 * @param size  edge lengths on the farfield and in the planes
 * VG_ERR_INPUT: the boundary does not contain the section; an element has the
 * name of a patch of the tunnel. VG_ERR_GEOMETRY,
 * VG_ERR_STOPPED, VG_ERR_MEMORY. On failure the strip is unchanged. */
vg_status vg_section_close(struct vg_mesh *strip,
                           const struct vg_section_outer *outer,
                           const struct vg_size_function *size,
                           struct vg_error *err);

/** The slot between two elements that is narrowest relative to the edge at one
 * of its points; width INFINITY: one element only. */
struct vg_section_slot {
  double width, edge, at[2];
  uint32_t patch[2];
};

/** O(n log n) for n edges. VG_ERR_MEMORY. */
vg_status vg_section_slot_find(const struct vg_mesh *strip,
                               struct vg_section_slot *out,
                               struct vg_error *err);

/** Triangles that request the edge lengths of walls and farfield in a sizing
 * field: an equilateral one on each edge in the plane z = 0. *out has points,
 * tri, tri_patch of its own, with room for two more points; its patches are
 * those of the surface, borrowed.
 * VG_ERR_MEMORY. */
vg_status vg_section_sizes(const struct vg_mesh *surface, struct vg_mesh *out,
                           struct vg_error *err);

/** Number of points in the plane z = 0 on walls and farfield. */
size_t vg_section_points(const struct vg_mesh *slab);

#endif
