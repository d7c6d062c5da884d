/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/remesh.h: remeshes a surface triangulation to target edge
 * lengths.
 *
 * Edges are split, collapsed and swapped and points moved along the surface
 * until edges have their target length (after Botsch and Kobbelt, "A remeshing
 * approach to multiresolution modeling", SGP 2004). Every change is checked
 * against the input surface before it is made: the result must stay within the
 * tolerance, must not fold, and must not come nearer to another part of the
 * surface than to its own. The distance of two triangulated surfaces is largest
 * at points of one of them or where their edges cross, and both are checked: no
 * part of either surface is farther from the other than the tolerance divided
 * by the cosine of half the feature angle, since at a fold the nearer of its
 * sides counts. If an edge passes over triangles that are turned away by 45
 * degrees, only its midpoint is checked. */
#ifndef VG_CORE_REMESH_REMESH_H
#define VG_CORE_REMESH_REMESH_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"

/** Which attempts are made while new triangles intersect. */
enum vg_remesh_course {
  VG_REMESH_ALL,
  VG_REMESH_FIRST, /* Only those that keep all borders and thin edges. */
  VG_REMESH_OTHERS /* Only the others. */
};

struct vg_remesh_options {
  double tolerance;     /* Largest distance between the surfaces. 0: 1e-4 of the
                           length of the body. It is limited to 0.05 of the
                           local size, and to 0.0075 of the width of a patch
                           that keeps its borders. */
  double accuracy;      /* Distance within which the input approximates the true
                           shape. The default tolerance is not smaller, and the
                           shape requests no sizes close to it. */
  double feature_angle; /* Feature angle: edges whose faces meet at this angle
                         in degrees or more are preserved. */
  double per_turn;      /* Edges around a full circle. */
  double h_min, h_max;  /* Bounds of the size. 0: 2e-4 and 0.02 of the length of
                           the body; on the outer boundary of a whole domain
                           h_max is 0.04 of the length of the domain. */
  int is_requested;     /* 1: h_max was requested for the surface and applies to
                           bodies inside a given domain, too. 0: their sizes
                           are at most 0.02 of their length. */
  double growth;        /* > 1; growth of sizes along the surface. */
  double most_tri;      /* Largest number of new triangles; 0: no limit but that
                           of the numbering. */
  size_t n_source;      /* Sources of the sizing field, the same as for the
                           volume. */
  const struct vg_source *source;
  double scale;                  /* Factor on all sizes (h_min, h_max, sizes
                                    from the shape and from sources), on growth
                                    - 1 and on the tolerance. Above 1 the
                                    tolerance is multiplied by its square, like
                                    the sagitta of arcs. */
  const struct vg_size_map *map; /* Additional sizes; may be NULL. */
  const struct vg_sizing *field; /* Stretched sizing field: edges follow its
                                    metric where it is finer than the sizes
                                    that the surface requests. Replaces sources
                                    and map, which it must contain. NULL: sizes
                                    are equal in all directions. */
  const double *cap;             /* [n_point] of m: largest size at each point;
                                    may be NULL. */
  const double *across;          /* [n_patch] Edges across narrow strips; NULL:
                                    1. */
  const double *stretch;         /* [3 n_tri] For edge 3 t + k from corner k of
                                    triangle t, equal on both sides: a stretched
                                    edge becomes a feature edge, and new edges
                                    along it are this many times as long as
                                    across it; the ratio fades out with
                                    distance. 0 to VG_REMESH_STRETCH; 1 or less:
                                    not stretched, VG_REMESH_FEATURE: a feature
                                    edge that is not stretched. May be NULL. */
  const uint8_t *still;          /* [n_point] VG_REMESH_STILL, VG_REMESH_KEPT:
                                    points that stay; 0: others. NULL: none. */
  int is_body;                   /* 1: a body in open air, never the boundary of
                                    a whole domain. */
  int is_reference;              /* 1: the surface may intersect itself and have
                                    degenerate triangles, like tessellations of
                                    CAD. Faults smaller than the tolerance are
                                    removed first, and only the remeshed surface
                                    is checked. */
  const uint8_t *hard;           /* [n_patch] 1: all borders of the patch are
                                    fixed; may be NULL. */
  enum vg_remesh_course course;
  int keeps_borders;    /* 1: so are the borders of other patches, unless
                           they are so narrow that this takes many
                           triangles. */
  const uint8_t *fixed; /* [n_patch] 1: the triangles of the patch are
                           kept unchanged. Strips are then not closed,
                           and faults of the input not removed
                           (is_reference 0). May be NULL. */
  int threads;          /* 0: one per core. The result is bitwise
                           independent of it. */
  struct vg_stop stop;  /* Polled before every change. */
};
#define VG_REMESH_STRETCH 20
#define VG_REMESH_FEATURE (-1)

/* Points that stay where they are. STILL: a feature corner, if the point is on
 * a feature curve. KEPT: feature edges between two such points stay, too, and
 * narrow strips are not closed. Not together with is_reference or fixed. */
enum { VG_REMESH_STILL = 1, VG_REMESH_KEPT };

#define VG_REMESH_OPTIONS_INIT                                                 \
  {                                                                            \
    .feature_angle = 40, .per_turn = 24, .growth = 1.2, .scale = 1,            \
    .threads = 1                                                               \
  }

/* Reasons that keep a triangle from a better shape. */
enum vg_remesh_cause {
  VG_REMESH_CORNER,  /* It lies between two feature edges from one point. */
  VG_REMESH_STRIP,   /* Its points are on feature curves close to each other. */
  VG_REMESH_LINE,    /* One of its edges is a feature edge whose points are
                        fixed. */
  VG_REMESH_SURFACE, /* The surface is too curved to change it. */
  VG_REMESH_N
};

#define VG_REMESH_BAD 20.0 /* degrees: smaller angles are listed */

struct vg_remesh_bad {
  size_t face;
  double angle, at[3];
  enum vg_remesh_cause cause;
};

#define VG_REMESH_ASPECTS 5

struct vg_remesh_report {
  double length, tolerance, h_min, h_max; /* Values used. */
  double far; /* On the outer boundary of a whole domain the tolerance is 0.05
                 of the size where the size exceeds this; 0: there is no outer
                 boundary. */
  size_t n_tri[2], n_point[2]; /* Before, after. */
  int keeps_borders;           /* Borders between patches were feature edges. */
  size_t n_corner, n_line;     /* Feature corners and curves; all are
                                  preserved. */
  double line_length[2];
  /* Pieces of feature curves that were dropped, because the strip between them
   * and another curve was narrower than the tolerance. */
  size_t n_closed;
  /* Pieces that remained feature curves although their strip is that narrow,
   * because closing it made triangles intersect. */
  size_t n_left;
  size_t n_clean; /* With is_reference: input edges below the tolerance that
                     were collapsed. */
  /* With is_reference: pairs of input triangles that intersect each other, in
   * the input and after the repair of those that the tolerance hides. */
  size_t n_crossing[2];
  double crossing_depth, crossing_at[3]; /* Depth and location of the deepest
                                            intersection of the input. */
  size_t n_kept;                         /* Input triangles that were kept
                                            because new ones intersected
                                            there. */
  double kept_at[3];                     /* The first of them. */
  /* Of closed pieces: total length; width and location of the widest strip. */
  double closed_length, closed_width, closed_at[3];
  size_t n_split, n_collapse, n_swap, n_move;
  int n_round;                        /* Number of attempts: 1, plus 1 for each
                                         time that sizes were halved at
                                         intersecting triangles. */
  size_t n_edge, n_edge_fit;          /* Edges; those within a factor of sqrt 2
                                         of their target length. */
  size_t n_aspect[VG_REMESH_ASPECTS]; /* Triangles by the ratio of target
                                         lengths in two directions: up to 1.5,
                                         3, 6, 12 and more. All angles of the
                                         report are measured in the metric, that
                                         is, as if edges were not stretched. */
  double aspect_most, angle_min;
  size_t cause[VG_REMESH_N];
  size_t n_intersection; /* VG_BLOCKED: left by the last attempt. */
  size_t n_bad;
  struct vg_remesh_bad *bad; /* [n_bad] Owned; ordered by face. */
};
#define VG_REMESH_REPORT_INIT                                                  \
  {                                                                            \
    0                                                                          \
  }

void vg_remesh_report_release(struct vg_remesh_report *r);

/** Renumber the triangles of m along a Hilbert curve, and the points in the
 * order in which triangles use them. vg_remesh_measure is fastest if neighbours
 * have similar numbers. The result of vg_remesh depends on the numbering.
 * Nothing but the numbers changes. VG_ERR_MEMORY: untouched. O(n). */
vg_status vg_remesh_arrange(struct vg_mesh *m, struct vg_error *err);

/** Remesh m, which must be closed except for open rims, oriented and free of
 * intersections (core/surface/surface_check.h). The result passes the same
 * check.
 *
 * Feature curves are preserved: sharp edges, open rims, borders between patches
 * of different conditions and fixed patch borders. Feature corners keep their
 * positions. If two feature curves run closer together than the tolerance,
 * pieces of the shorter one are dropped, except for rims, fixed borders and
 * thin edges (strips.h). Triangles along thin edges are stretched. Patches keep
 * their number and order; smooth patch borders follow the edges of new
 * triangles. Points that remain keep their order.
 *
 * @param r  released first; may be NULL
 * Untouched on failure. VG_ERR_INPUT for a surface with quadrilaterals, edges
 * of three faces or neighbours of opposite orientation, or options out of
 * range; VG_ERR_GEOMETRY if triangles intersect in all attempts;
 * VG_BLOCKED in place of it for VG_REMESH_FIRST: r then has n_intersection;
 * VG_ERR_STOPPED; VG_ERR_MEMORY. Re-entrant. About O(n log n). */
vg_status vg_remesh(struct vg_mesh *m, const struct vg_remesh_options *o,
                    struct vg_remesh_report *r, struct vg_error *err);

/** Report on a surface without changing it: its feature curves and corners, the
 * ratio of edges to their target lengths, and bad triangles with their causes.
 * No changes are counted. Requirements, errors and cost as for vg_remesh. */
vg_status vg_remesh_judge(const struct vg_mesh *m,
                          const struct vg_remesh_options *o,
                          struct vg_remesh_report *r, struct vg_error *err);

/** The target edge lengths of vg_remesh at the points of m, as the shape
 * requests them; sources and maps of sizes do not count.
 *
 * @param size  out: [m->n_point] already multiplied by o->scale
 * Requirements, errors and cost as for vg_remesh_judge. */
vg_status vg_remesh_sizes(const struct vg_mesh *m,
                          const struct vg_remesh_options *o, double *size,
                          struct vg_error *err);

/** Name of a cause: "corner", "strip", ... Static. */
const char *vg_remesh_cause_name(enum vg_remesh_cause c);

/** Distance of one surface from another, at its points and edge midpoints. The
 * maximum is at a point of either surface or where edges of both cross. */
struct vg_remesh_distance {
  double most, at[3]; /* Largest distance, and its location. */
  double most_99;     /* 99th percentile. */
};

/** Measure in both directions: d[0] from a to b, d[1] from b to a.
 *
 * @param stop  may be NULL
 * @param face  out: [a->n_tri] largest distance at each triangle; may be NULL
 * O(n log n). VG_ERR_INPUT as for vg_remesh, VG_ERR_STOPPED. */
vg_status vg_remesh_measure(const struct vg_mesh *a, const struct vg_mesh *b,
                            int threads, const struct vg_stop *stop,
                            double *face, struct vg_remesh_distance d[2],
                            struct vg_error *err);

#endif
