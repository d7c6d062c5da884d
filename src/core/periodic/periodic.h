/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/periodic/periodic.h: pairs of patches, of which the second is the image
 * of the first by a translation or a rotation. */
#ifndef VG_CORE_PERIODIC_PERIODIC_H
#define VG_CORE_PERIODIC_PERIODIC_H

#include "core/mesh/mesh.h"

/** A pair and its transform. All lengths in the unit of the mesh. */
struct vg_periodic {
  int32_t patch, image; /* numbers of the patches */
  int is_rotation;
  int n;                     /* a rotation by 1 / n turns; 0: another one */
  double shift[3];           /* of a translation */
  double axis[3], centre[3]; /* of a rotation: unit vector, point */
  double cosine, sine;       /* of its angle, right-handed about axis */
  size_t n_face;             /* faces of each patch */
  double distance;           /* largest distance of a point of `image` from
                                its place before it was moved there */
};

/** Image of the point x, in plain arithmetic. */
void vg_periodic_image(const struct vg_periodic *p, const double x[3],
                       double out[3]);

/** Image of the vector v; its original if `is_back`. */
void vg_periodic_vector(const struct vg_periodic *p, int is_back,
                        const double v[3], double out[3]);

/** Angles in radians about x, y and z, in this order, that give the rotation
 * together; with libm, for files. 0 for translations. */
void vg_periodic_angles(const struct vg_periodic *p, double angle[3]);

/** The angle of a rotation in degrees, for reports; from -180 to 180. */
double vg_periodic_degrees(const struct vg_periodic *p);

/* S100: angles and components that are exact except for rounding. */
#define VG_PERIODIC_DEGREES 1e-3
#define VG_PERIODIC_MOST 360
#define VG_PERIODIC_ZERO 1e-6
/* S103: largest distance between a point and its image on a settled surface and
 * in a finished mesh, as a share of the extent of the pair. */
#define VG_PERIODIC_EXACT 1e-10
/* S120: largest distance of corners of triangulated CAD faces under a transform
 * from their areas, as a share of the extent of the pair. */
#define VG_PERIODIC_ROUGH 2e-3

/** The reverse: from the image to the patch. */
struct vg_periodic vg_periodic_reverse(const struct vg_periodic *p);

/** Sets cosine, sine and n for an angle in degrees, from -180 to 180.
 * Angles within VG_PERIODIC_DEGREES of 360 / n, n = 2 to VG_PERIODIC_MOST,
 * become that fraction of a turn. */
void vg_periodic_turn(struct vg_periodic *p, double degrees);

/** Finds the transform from the areas and centroids of the patches of p: a
 * translation if their mean normals are opposite, else a rotation. Coordinates
 * of axis and centre below VG_PERIODIC_ZERO (relative) become 0. The transform
 * is a guess until vg_periodic_match succeeds. Returns 0 if no transform is
 * found. O(n). */
int vg_periodic_find(const struct vg_mesh *m, struct vg_periodic *p);

#define VG_PERIODIC_NONE UINT32_MAX

/** The points and faces of a pair. */
struct vg_periodic_match {
  size_t n_point[2], n_face[2]; /* of the patch and of its image */
  double area[2];
  double distance; /* largest distance of the image of a point of the patch
                      from the nearest point of the image patch */
  uint32_t worst;  /* that point; VG_PERIODIC_NONE: the patch has none */
  size_t n_off;    /* points without a partner, or that share one */
  size_t n_bad;    /* faces without a partner of opposite orientation; counted
                      if n_off is 0 */
  uint32_t *point; /* [m->n_point] owned: partner of each point of the patch;
                      VG_PERIODIC_NONE for other points */
  uint32_t
    *face; /* [n_tri + n_quad] owned: partner of each face of the patch,
              quadrilaterals after triangles; VG_PERIODIC_NONE for others */
};
#define VG_PERIODIC_MATCH_INIT                                                 \
  {                                                                            \
    .point = NULL                                                              \
  } /* releasing this is a no-op */

/** Matches points within `tolerance`, and within a tenth of the shortest edge
 * at the partner; then faces. A point of both patches, on the axis, is its own
 * partner. The pair matches if the counts are equal, and n_off and n_bad are
 * 0. O(n log n). VG_ERR_MEMORY. */
vg_status vg_periodic_match(const struct vg_mesh *m,
                            const struct vg_periodic *p, double tolerance,
                            struct vg_periodic_match *out,
                            struct vg_error *err);

/** Pairs of patches of a mesh, with their points and faces, for writers. */
struct vg_periodic_links {
  size_t n, n_point;                     /* pairs; points of the matches */
  const struct vg_periodic *pair;        /* [n] */
  const struct vg_periodic_match *match; /* [n] */
};

int vg_periodic_matches(const struct vg_periodic_match *match);

void vg_periodic_match_release(struct vg_periodic_match *match);

/** Replaces the shift of a translation by the median of the differences between
 * partners in each coordinate, which is exact if most coordinates are.
 * VG_ERR_MEMORY. */
vg_status vg_periodic_refine(const struct vg_mesh *m, struct vg_periodic *p,
                             const struct vg_periodic_match *match,
                             struct vg_error *err);

/** Replaces axis, centre and angle of a rotation by those of the rigid motion
 * that takes the points nearest to their partners, in the sum of squared
 * distances (Horn, J. Opt. Soc. Am. A 4, 1987). Nothing changes if the points
 * are on one line. */
void vg_periodic_refine_turn(const struct vg_mesh *m, struct vg_periodic *p,
                             const struct vg_periodic_match *match);

/** Moves the points of the image patch to their places, those on the axis
 * excepted. Sets p->distance and p->n_face. Returns the number of points that
 * moved. */
size_t vg_periodic_apply(struct vg_mesh *m, struct vg_periodic *p,
                         const struct vg_periodic_match *match);

/** Renumbers the points of a surface, so that the points of both patches of a
 * pair are in the same order: each point follows the first of its images.
 * Faces keep their order. Sets *is_changed if points got other numbers; the
 * matches then refer to the former ones. O(n log n). VG_ERR_MEMORY.
 * @param match  [n] of all pairs, successful */
vg_status vg_periodic_order(struct vg_mesh *m, size_t n,
                            const struct vg_periodic_match *match,
                            int *is_changed, struct vg_error *err);

/** Diagonal of the box of both patches. */
double vg_periodic_extent(const struct vg_mesh *m, const struct vg_periodic *p);

#endif
