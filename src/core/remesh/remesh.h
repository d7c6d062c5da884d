/* core/remesh/remesh.h: a surface of triangles made anew to size.
 *
 * Points are put in and taken away, edges swapped and points moved along the
 * surface until edges are as long as asked (after Botsch and Kobbelt, "A
 * remeshing approach to multiresolution modeling", SGP 2004). Every change is
 * held against the surface as given before it is made: it may not leave the
 * tolerance, fold, or come nearer to another part of the surface than to its
 * own. Two surfaces of triangles are farthest apart at points of one of them or
 * where their edges cross, and all of these are looked at: no part of either is
 * farther from the other than the tolerance over the cosine of half the ridge
 * angle, since at a fold the nearer of its sides counts. Of edges over
 * triangles that turn away by 45 degrees the middle alone is looked at. */
#ifndef VG_CORE_REMESH_REMESH_H
#define VG_CORE_REMESH_REMESH_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"

struct vg_remesh_options {
  double tolerance;     /* largest distance between the surfaces; 0: 1e-4
                           of the body's length; nowhere more than 0.05 of
                           the size */
  double accuracy;      /* how far what is given may be from the shape that
                           it stands for: a tolerance of 0 is no less, and
                           its shape asks for no sizes near that */
  double feature_angle; /* degrees between faces, from which on their edge
                         is a ridge and stays */
  double per_turn;      /* edges round a full circle */
  double h_min, h_max;  /* 0: 2e-4 and 0.02 of the body's length; of the
                           outer boundary of a whole domain, 0.04 of its
                           own */
  double growth;        /* > 1, of sizes along the surface */
  size_t n_source;      /* sources of sizes, as the volume uses them */
  const struct vg_source *source;
  double scale; /* factor on all sizes: h_min, h_max, those of the
                   shape and of the sources, on growth - 1 and on
                   the tolerance; above 1 its square on that, as
                   arcs rise so */
  const struct vg_size_map *map; /* sizes besides; or NULL */
  const double *cap;     /* [n_point] of m: largest size there; or NULL */
  const double *across;  /* [n_patch] edges across its strips; NULL: 1 */
  const double *stretch; /* [3 n_tri] of edge 3 t + k, from corner k of
                            triangle t on, the same on both sides: such an
                            edge stays as a line, and new edges along it are
                            so many times as long as across it, which fades
                            out around; 0 to VG_REMESH_STRETCH, 1 and less:
                            not; or NULL */
  int is_body;           /* 1: a body in open air, never the boundary of a
                            whole domain */
  int is_reference;      /* 1: the surface may intersect itself and have
                            degenerate triangles, as tessellations of CAD
                            do: faults that the tolerance hides are removed
                            before anything else, and only the new surface
                            is judged */
  const uint8_t *hard;   /* [n_patch] all borders of the patch stay; or
                            NULL */
  int threads;           /* 0: one per core; the same bytes for any */
  struct vg_stop stop;   /* asked before every change */
};
#define VG_REMESH_STRETCH 20
#define VG_REMESH_OPTIONS_INIT                                                 \
  {                                                                            \
    .feature_angle = 40, .per_turn = 24, .growth = 1.2, .scale = 1,            \
    .threads = 1                                                               \
  }

/* What keeps a triangle from a better shape. */
enum vg_remesh_cause {
  VG_REMESH_CORNER,  /* it lies between two lines from one point */
  VG_REMESH_STRIP,   /* its points are on lines that are close */
  VG_REMESH_LINE,    /* it stands on a line whose points stay */
  VG_REMESH_SURFACE, /* the surface bends too much to change it */
  VG_REMESH_N
};

#define VG_REMESH_BAD 20.0 /* degrees: triangles below are listed */

struct vg_remesh_bad {
  size_t face;
  double angle, at[3];
  enum vg_remesh_cause cause;
};

#define VG_REMESH_ASPECTS 5

struct vg_remesh_report {
  double length, tolerance, h_min, h_max; /* what was settled */
  size_t n_tri[2], n_point[2];            /* before, after */
  size_t n_corner, n_line;                /* corners and lines: all are kept */
  double line_length[2];
  size_t n_closed;      /* pieces of lines that are none any more: strips
                           between them and another line were narrower
                           than the tolerance */
  size_t n_left;        /* such pieces that are lines still, as triangles
                           met when they were closed */
  size_t n_clean;       /* with is_reference: edges of the given surface
                           below the tolerance that were collapsed */
  size_t n_crossing[2]; /* the same: pairs of given triangles that
                           intersect each other, as given and after the
                           repair of those that the tolerance hides */
  double crossing_depth, crossing_at[3]; /* the deepest of the first ones */
  size_t n_kept;     /* given triangles that stay as they are, since new
                        ones met there */
  double kept_at[3]; /* the first of them */
  double closed_length, closed_width, closed_at[3]; /* of all; the widest */
  size_t n_split, n_collapse, n_swap, n_move;
  int n_round;               /* 1, and one more for each time that triangles
                                met and sizes there were halved */
  size_t n_edge, n_edge_fit; /* edges; those within a factor sqrt 2 of what
                              is asked for */
  size_t n_aspect[VG_REMESH_ASPECTS]; /* triangles by how many times as long
                              edges are asked for one way as the other, up to
                              1.5, 3, 6, 12 and more. All angles here are as
                              if these were not stretched */
  double aspect_most, angle_min;
  size_t cause[VG_REMESH_N];
  size_t n_bad;
  struct vg_remesh_bad *bad; /* [n_bad] owned, by face */
};
#define VG_REMESH_REPORT_INIT                                                  \
  {                                                                            \
    0                                                                          \
  }

void vg_remesh_report_release(struct vg_remesh_report *r);

/** Triangles of m in the order of a Hilbert curve, points as triangles use
 * them first: vg_remesh_measure is fastest where neighbours are near each
 * other. What vg_remesh makes depends on the order. Numbers change, nothing
 * else. VG_ERR_MEMORY: untouched. O(n). */
vg_status vg_remesh_arrange(struct vg_mesh *m, struct vg_error *err);

/** Make the triangles of m anew. m is closed but for open rims, oriented and
 * free of intersections (core/surface/surface_check.h); so is what comes out,
 * by the same check.
 *
 * Lines stay: ridges, open rims, borders between patches of different
 * conditions and hard ones; so do corners, in their places. Of two lines with a
 * strip between them that is narrower than the tolerance one is enough: pieces
 * of the shorter are given up there, but for rims and borders. Patches keep
 * their number and order; where the surface goes on smoothly their borders are
 * led along the edges of new triangles.
 *
 * @param r  released first; may be NULL
 * Untouched on failure. VG_ERR_INPUT for a surface with quadrilaterals, edges
 * of three faces or faces that disagree, or options out of range;
 * VG_ERR_GEOMETRY where triangles meet whatever is tried; VG_ERR_STOPPED;
 * VG_ERR_MEMORY. Re-entrant. About O(n log n). */
vg_status vg_remesh(struct vg_mesh *m, const struct vg_remesh_options *o,
                    struct vg_remesh_report *r, struct vg_error *err);

/** What vg_remesh would report of a surface that is as it should be already:
 * its lines and corners, edges against what is asked for, bad triangles with
 * their causes. No change is counted. Conditions, errors and cost as there. */
vg_status vg_remesh_judge(const struct vg_mesh *m,
                          const struct vg_remesh_options *o,
                          struct vg_remesh_report *r, struct vg_error *err);

/** "corner", "strip", ... Static. */
const char *vg_remesh_cause_name(enum vg_remesh_cause c);

/** Distance of one surface from another, at points and middles of edges: it is
 * largest at a point of either or where their edges cross. */
struct vg_remesh_distance {
  double most, at[3]; /* largest, and where */
  double most_99;     /* 99 % are below */
};

/** Both ways: d[0] of a from b, d[1] of b from a.
 *
 * @param stop  may be NULL
 * @param face  out: [a->n_tri] the largest at each; may be NULL
 * O(n log n). VG_ERR_INPUT as vg_remesh, VG_ERR_STOPPED. */
vg_status vg_remesh_measure(const struct vg_mesh *a, const struct vg_mesh *b,
                            int threads, const struct vg_stop *stop,
                            double *face, struct vg_remesh_distance d[2],
                            struct vg_error *err);

#endif
