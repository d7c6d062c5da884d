/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/planar.h: triangulates planar regions with a given edge length by
 * a two-dimensional advancing front, and builds surfaces from them: planar
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
  struct vg_stop stop; /* Polled regularly. */
  int splits; /* 1: points are added where angles stay small, closer than the
                 target edge length */
};

/** Triangulate a plane region bounded by closed loops of segments.
 *
 * @param n, p         points in the 2-D coordinates of the plane
 * @param n_edge       boundary segments, with the region on their LEFT; several
 *                     loops, holes, touching loops and slits, of which the
 *                     segments occur in both directions, are allowed
 * @param law          target edge length
 * @param n_new, add   out: points added inside, owned by the caller
 * @param n_tri, tri   out: counter-clockwise triangles over the n + n_new
 *                     points, owned by the caller
 * Boundary segments are not changed. There is no minimum angle where the
 * boundary itself is sharp. The result is bitwise reproducible. VG_ERR_GEOMETRY
 * names the first pair of crossing segments; VG_ERR_STOPPED. */
vg_status vg_planar_mesh(size_t n, const double (*p)[2], size_t n_edge,
                         const uint32_t (*edge)[2],
                         const struct vg_planar_law *law, size_t *n_new,
                         double (**add)[2], size_t *n_tri, uint32_t (**tri)[3],
                         struct vg_error *err);

/** Build the surface of a project of planar patches: curves are marched as in
 * VGRID (formats.md 1.7), then each patch is triangulated. Points are in the
 * order of VGRID: configuration points, curve points, others.
 *
 * @param stop  polled regularly; NULL: never. VG_ERR_STOPPED */
vg_status vg_project_surface(const struct vg_project *project,
                             const struct vg_sizing *sizing,
                             const struct vg_stop *stop, struct vg_mesh *out,
                             struct vg_error *err);

enum vg_farfield_kind {
  VG_FARFIELD_NONE,
  VG_FARFIELD_SPHERE,
  VG_FARFIELD_BOX,
  VG_FARFIELD_MACH
};

/** A boundary swept along the Mach cone, for sonic booms. Its inflow and
 * outflow faces are parallel to the Mach cone, so that shocks run along them:
 *
 *                      ______________
 *                     /             /   radius
 *        flow -->    /   /<shock   /
 *                   /   /         /
 *         upstream |  <body>     | downstream     <- axis, caps
 *
 * The cone has the half angle asin(1 / mach). Lengths are in body lengths. */
struct vg_mach_extent {
  double mach;       /* Mach number of the flow, above 1. */
  double flow[3];    /* Direction of the flow, not normalised. */
  double upstream;   /* From the upstream cap to the foremost point. */
  double downstream; /* From the rearmost point to the downstream cap. */
  double radial;     /* Radius of the domain. */
};

struct vg_farfield {
  enum vg_farfield_kind kind;
  double size;      /* Radius or half width; 0: `lengths` times the body
                       length. */
  double lengths;   /* In body lengths (longest side of the bounding box);
                       default 20. */
  double centre[3]; /* Used if has_centre is set. */
  int has_centre;
  double lo[3], hi[3]; /* Box corners, used if has_box is set. */
  int has_box;
  int symmetry;        /* Meaning of open edges in one plane. 0: the cut of a
                          half body if they look like one (symmetry.h), else a
                          hole; 1: the cut of a half body; 2: that, and it may
                          deviate from the plane by VG_ROOT_OFF of the body
                          length; -1: a hole. */
  double spacing;      /* Edge length on the farfield; 0: from the growth of the
                          sizing field. */
  struct vg_stop stop; /* Polled regularly. */
  struct vg_mesh *sheets; /* Inner surfaces along which the symmetry plane is
                             cut; their points near it are moved into it.
                             NULL: none. */
  struct vg_mach_extent extent; /* Used by VG_FARFIELD_MACH, with `centre` as a
                                   point of the axis. */
};
#define VG_FARFIELD_INIT                                                       \
  {                                                                            \
    .kind = VG_FARFIELD_SPHERE, .lengths = 20, .extent = {                     \
      .flow = { 1, 0, 0 },                                                     \
      .upstream = 0.5,                                                         \
      .downstream = 1,                                                         \
      .radial = 5                                                              \
    }                                                                          \
  }

struct vg_domain_report {
  int added_farfield, added_symmetry;
  int symmetry_axis; /* 0 x, 1 y, 2 z; -1 none. */
  double symmetry_at;
  size_t n_added_tri;
  int is_crossed; /* 1, with a failure: the symmetry plane cannot be made with
                     the edges of sheets, which may cross its rim. */
};

/* Of the body length: open edges of a given half model this near to a plane are
 * those of an uneven root, whose plane is at 0 or touches the outermost of
 * them. */
#define VG_ROOT_OFF 1e-3 /* S87 */

/** Is the surface a half model: are all its open edges in a coordinate plane
 * x[*axis] = *at at an end of it? The cost is that of sorting the edges.
 *
 * @param symmetry  as in vg_farfield: 0 also requires that the opening looks
 *                  like the cut of a symmetric body (core/domain/symmetry.h);
 *                  1, 2: it is the cut; -1: it is not
 * @param axis      out: -1 if the surface is not a half model */
vg_status vg_domain_half(const struct vg_mesh *surface, int symmetry, int *axis,
                         double *at, struct vg_error *err);

/** Mark the points of open edges. open: [surface->n_point] 0 on entry. */
vg_status vg_domain_mark_open(const struct vg_mesh *surface, uint8_t *open,
                              struct vg_error *err);

/** Move the points of open edges into the plane x[axis] = at. off: out, the
 * largest distance. */
vg_status vg_domain_flatten(struct vg_mesh *surface, int axis, double at,
                            double *off, struct vg_error *err);

/** Does the surface meet the plane x[axis] = at steeply along most of its edges
 * there, as where a body continues into its mirror image? 0 if no edge is
 * within the tolerance. */
int vg_domain_is_steep(const struct vg_mesh *m, int axis, double at,
                       double tolerance);

/** A closed loop of open edges. */
struct vg_rim {
  size_t n_edge;
  double centre[3]; /* Centre of its bounding box. */
  double width;     /* Longest side of its bounding box. */
  int axis;         /* Coordinate axis across which it is flat; -1: none. */
  double normal[3]; /* Unit normal of its plane; 0 if it has none. */
};

/** Find the rims of a surface, in the order of their first points. The caller
 * frees *rim. VG_ERR_GEOMETRY if rims meet in a point, which the message
 * names. */
vg_status vg_domain_rims(const struct vg_mesh *surface, size_t *n,
                         struct vg_rim **rim, struct vg_error *err);

/** Caps that were added. */
struct vg_cap_report {
  size_t n, n_tri; /* caps and their triangles */
  size_t n_curved; /* caps on rims that lie in no plane to within 1e-3 of
                      their extent */
};

/** Close the holes of a surface that have nearly plane rims (within 5 % of
 * their extent). The caps are triangulated with the sizes of the field. Each
 * gets a patch of its own, cap_1, cap_2, ..., with an id above all others and
 * without a condition. The rims of a half model stay open: those in a
 * coordinate plane at one end, unless there are such rims at the opposite end,
 * too. VG_ERR_GEOMETRY, naming the hole, if rims meet or are not plane; the
 * surface is then unchanged. Caps may intersect the surface: check the result.
 *
 * @param symmetry  as in vg_domain_half
 * @param report    out */
vg_status vg_domain_close_holes(struct vg_mesh *surface, int symmetry,
                                const struct vg_sizing *sizing,
                                struct vg_cap_report *report,
                                struct vg_error *err);

/** Box around the surface and, if the farfield is swept along the Mach cone,
 * around that, with a margin of a tenth. The sizes on such a farfield are those
 * of sources beyond the body, so the sizing field must cover it.
 *
 * @param surface  at least one point
 * Extents that vg_domain_complete refuses leave the box of the surface. */
void vg_domain_bounds(const struct vg_mesh *surface,
                      const struct vg_farfield *farfield, double lo[3],
                      double hi[3]);

/** Complete a surface to a closed boundary of the fluid. Without a farfield
 * only the symmetry plane of a half domain is added.
 *
 * A closed body gets a farfield around it. A half body (see `symmetry`) whose
 * open edges are all in one coordinate plane gets that symmetry plane,
 * triangulated around its footprint, and half a farfield. New patches get new
 * ids, the names "farfield" and "symmetry" and the conditions 3 and 1 (USM3D),
 * 5000 and 666x (FUN3D). Triangles of the body must point into the fluid.
 * Points in the plane have its coordinate exactly, to the last bit.
 * VG_ERR_INPUT, VG_ERR_GEOMETRY: the farfield cannot contain the body; the
 * message gives the extent that would. */
vg_status vg_domain_complete(struct vg_mesh *surface,
                             const struct vg_farfield *farfield,
                             const struct vg_sizing *sizing,
                             struct vg_domain_report *report,
                             struct vg_error *err);

#endif
