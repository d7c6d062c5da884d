/* core/domain/planar.h: triangulation of planar regions to the local spacing by
 * a two-dimensional advancing front, and the domains built from it: planar
 * patches of a project, farfields, symmetry planes. */
#ifndef VG_CORE_DOMAIN_PLANAR_H
#define VG_CORE_DOMAIN_PLANAR_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/domain/project.h"
#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"

/** Target edge length at a point of a plane. */
struct vg_planar_law {
  double (*at)(void *user, const double x[2]);
  void *user;
  struct vg_stop stop; /* asked now and then */
};

/** Triangulate a plane region bounded by closed loops of segments.
 *
 * @param n, p       points in the plane's own 2-D coordinates
 * @param n_edge     boundary segments; region on their LEFT; several loops,
 *                   holes and touching loops allowed
 * @param law        target edge length
 * @param n_new, add out: points added inside, owned by the caller
 * @param n_tri, tri out: counter-clockwise triangles over the n + n_new
 *                   points, owned by the caller
 * Boundary segments are kept as they are. No minimum angle is promised where
 * the boundary itself is sharp. Same bytes for the same input.
 * VG_ERR_GEOMETRY names the first pair of crossing segments;
 * VG_ERR_STOPPED. */
vg_status vg_planar_mesh(size_t n, const double (*p)[2], size_t n_edge,
                         const uint32_t (*edge)[2],
                         const struct vg_planar_law *law, size_t *n_new,
                         double (**add)[2], size_t *n_tri, uint32_t (**tri)[3],
                         struct vg_error *err);

/** Surface of a project made of planar patches: curves are marched as VGRID
 * does (formats.md 1.7), then each patch is triangulated.
 * Point order as VGRID's: configuration points, curve points, others.
 * @param stop  asked now and then; NULL: never. VG_ERR_STOPPED */
vg_status vg_project_surface(const struct vg_project *project,
                             const struct vg_sizing *sizing,
                             const struct vg_stop *stop, struct vg_mesh *out,
                             struct vg_error *err);

enum vg_farfield_kind { VG_FARFIELD_NONE, VG_FARFIELD_SPHERE, VG_FARFIELD_BOX };

struct vg_farfield {
  enum vg_farfield_kind kind;
  double size;      /* radius or half width; 0: `lengths` times body */
  double lengths;   /* in body lengths (longest side of the bounding
                       box), default 20 */
  double centre[3]; /* used when has_centre */
  int has_centre;
  double lo[3], hi[3]; /* box corners, used when has_box */
  int has_box;
  int symmetry;        /* open edges in one plane: 0: are where a half body
                          was cut if they look so (symmetry.h), else a hole;
                          1: are; -1: are not */
  double spacing;      /* edge length on the farfield; 0: from the growth
                          of the field */
  struct vg_stop stop; /* asked now and then */
};
#define VG_FARFIELD_INIT                                                       \
  {                                                                            \
    VG_FARFIELD_SPHERE, 0, 20, { 0 }, 0, { 0 }, { 0 }, 0, 0, 0,                \
    {                                                                          \
      NULL, NULL                                                               \
    }                                                                          \
  }

struct vg_domain_report {
  int added_farfield, added_symmetry;
  int symmetry_axis; /* 0 x, 1 y, 2 z; -1 none */
  double symmetry_at;
  size_t n_added_tri;
};

/** Whether the surface is a half model: all its open edges lie in a coordinate
 * plane, x[*axis] = *at, at an end of it. Costs a sort of the edges.
 *
 * @param symmetry  as in vg_farfield: 0 also asks core/domain/symmetry.h
 * whether half of a symmetric body was cut off there; 1: it was; -1: the answer
 * is no
 * @param axis      out: -1 where it is no half model */
vg_status vg_domain_half(const struct vg_mesh *surface, int symmetry, int *axis,
                         double *at, struct vg_error *err);

/** A closed loop of open edges. */
struct vg_rim {
  size_t n_edge;
  double centre[3]; /* of its bounding box */
  double width;     /* longest side of that box */
  int axis;         /* coordinate axis across which it is flat; -1 */
};

/** The rims of a surface, in the order of their first points; the caller frees
 * *rim. VG_ERR_GEOMETRY where rims meet in a point: the message names it. */
vg_status vg_domain_rims(const struct vg_mesh *surface, size_t *n,
                         struct vg_rim **rim, struct vg_error *err);

/** Close the holes of a surface with nearly plane rims (within 5 % of their
 * extent), triangulated to the sizes of the field; each gets a patch of its
 * own, cap_1, cap_2, ..., with the lowest free ids and no condition. The rims
 * of a half model stay open: those in a coordinate plane at one end, unless
 * there are such rims at the opposite end too. VG_ERR_GEOMETRY, naming the
 * hole, where rims meet or are not plane; surface is then unchanged. What was
 * closed may cross the surface: check it.
 * @param symmetry  as in vg_domain_half
 * @param n_hole, n_tri  out: holes closed, triangles added */
vg_status vg_domain_close_holes(struct vg_mesh *surface, int symmetry,
                                const struct vg_sizing *sizing, size_t *n_hole,
                                size_t *n_tri, struct vg_error *err);

/** Complete a surface to a closed fluid boundary. Without a farfield only the
 * symmetry plane of a half domain is added.
 *
 * A closed body gets a farfield around it; a half body (symmetry above) whose
 * open edges all lie in one coordinate plane gets that symmetry plane,
 * triangulated around its footprint, and half a farfield. New patches get new
 * ids, the names "farfield" and "symmetry" and the conditions 3 and 1 (USM3D),
 * 5000 and 666x (FUN3D). Body triangles must point into the fluid. Points in
 * the plane keep its coordinate to the last bit. */
vg_status vg_domain_complete(struct vg_mesh *surface,
                             const struct vg_farfield *farfield,
                             const struct vg_sizing *sizing,
                             struct vg_domain_report *report,
                             struct vg_error *err);

#endif
