/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/surface/surface_check.h: checks whether a triangulation can bound a
 * mesh, and repairs it. */
#ifndef VG_CORE_SURFACE_SURFACE_CHECK_H
#define VG_CORE_SURFACE_SURFACE_CHECK_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

enum vg_defect_kind {
  VG_DEFECT_OPEN_EDGE,        /* An edge with one triangle. */
  VG_DEFECT_NONMANIFOLD_EDGE, /* An edge with three or more triangles. */
  VG_DEFECT_ORIENTATION,      /* Neighbours of opposite orientation, not
                                 repaired. */
  VG_DEFECT_DUPLICATE_POINT,  /* Two points with the same coordinates. */
  VG_DEFECT_UNUSED_POINT,
  VG_DEFECT_DEGENERATE_TRIANGLE, /* A repeated node, or exactly zero area. */
  VG_DEFECT_DUPLICATE_TRIANGLE,
  VG_DEFECT_SHARED_WALL,  /* Two triangles of touching bodies have the same
                             points. */
  VG_DEFECT_INTERSECTION, /* Two triangles cross or overlap. */
  VG_DEFECT_SHELL,        /* Wrong nesting of closed shells. */
  VG_DEFECT_NO_BC,        /* A patch without a boundary condition. */
  VG_DEFECT_NOT_FINITE,   /* A NaN or infinite coordinate. */
  VG_DEFECT_QUAD,         /* A quadrilateral: only triangles can be meshed. */
  VG_DEFECT_N
};

/** One finding. Faces and points are indices into the mesh after the repair;
 * quadrilateral q counts as face n_tri + q. SIZE_MAX: none. */
struct vg_defect {
  enum vg_defect_kind kind;
  size_t face[2];
  size_t point[2];
  double at[3]; /* Location. */
};

struct vg_shell {   /* One edge-connected component. */
  size_t n_tri;     /* Number of triangles; a quadrilateral counts as two. */
  size_t face;      /* Its first face. */
  size_t n_flipped; /* Its faces turned by the repair. */
  int is_closed;    /* 1: every edge has exactly two faces. Parent and depth are
                       determined among closed shells only. */
  double volume;    /* Signed volume; > 0: normals point out of the shell. */
  size_t parent;    /* Shell directly around it; SIZE_MAX: none. */
  int depth;        /* Number of shells around it; 0: outermost. */
  double lo[3], hi[3];
};

struct vg_surface_report {
  size_t count[VG_DEFECT_N]; /* Number of findings by kind, in the mesh after
                                the repair. */
  size_t n_defect, cap_defect;
  /* Findings, sorted by kind, then face. Beyond VG_SURFACE_PAIR_MAX
   * intersecting pairs only one is listed per intersecting face, with its first
   * partner; `count` remains exact. */
  struct vg_defect *defect;
  uint32_t *face_kinds;                  /* [n_tri + n_quad] Bit 1 << kind for
                                            every finding that involves the
                                            face. */
  size_t n_flipped;                      /* Triangles turned by the repair. */
  size_t n_removed_point, n_removed_tri; /* Points and triangles removed by the
                                            repair. */
  size_t n_removed_wall;                 /* Triangles of walls shared by
                                            touching bodies, removed by the
                                            repair. */
  int shells_reoriented;                 /* 1: every closed shell was turned as
                                            a whole. */
  size_t n_piece;                        /* Components connected by nodes. */
  size_t n_shell;                        /* Components connected by edges. */
  struct vg_shell *shell;
  uint32_t *tri_shell; /* [n_tri] Shell of each triangle. */
  int is_closed;       /* 1: no open or non-manifold edges. */
};
#define VG_SURFACE_REPORT_INIT                                                 \
  {                                                                            \
    0                                                                          \
  }
#define VG_SURFACE_PAIR_MAX 262144

struct vg_surface_check_options {
  int repair;      /* 1: orient, drop unused or duplicate points and triangles
                      where unambiguous. */
  int keeps_walls; /* 1: the repair leaves walls shared by touching bodies,
                      which are reported. */
  int require_bc;  /* 1: report patches without a condition. */
  int external;    /* 1: the closed shells are bodies in a fluid that a farfield
                      will enclose: normals of outermost shells must point
                      outwards, into the fluid. 0: outermost shells bound the
                      fluid from outside (normals inwards). -1: not known; the
                      sides of shells are neither checked nor changed. */
  int threads;     /* 0: one per core. The result does not depend on it. */
  struct vg_stop stop;
};
#define VG_SURFACE_CHECK_OPTIONS_INIT                                          \
  {                                                                            \
    .repair = 1, .threads = 1                                                  \
  }

/** Find (and with `repair` correct) defects of the boundary faces of m.
 *
 * The repair merges points with the same coordinates and drops unused points,
 * triangles with a repeated node, and copies of a triangle: triangles with the
 * same nodes and side, and the second copy of a piece of the skin that faces
 * the other side. The first copy stays, whatever the patches. Both faces of a
 * wall shared by two bodies are dropped if the bodies then have a common closed
 * skin. The repair makes neighbours agree, turning the smaller number of faces,
 * and turns closed shells to the side that `external` requires. A shell nested
 * deeper than the boundary of the fluid is never turned: the data do not tell
 * whether it is a cavity or a stray body.
 *
 * Each fault counts once. Copies that are reported are excluded from the tests
 * of edges and shells; of faces with the same nodes one is tested for
 * intersections.
 *
 * Intersections are pairs of triangles with a common point that is not on a
 * common node or edge. The test is exact; touching counts; degenerate triangles
 * are excluded. A node is common only to faces that are connected around it
 * through edges. Sheets that meet in a node therefore touch, and a non-manifold
 * edge in which sheets meet is a finding of its own. If m has cells, points
 * used by cells only count as used.
 *
 * @param m       changed only by the repair; untouched on failure
 * @param report  released first; empty on failure
 * O(n log n + intersections) while no node has very many faces (all pairs at a
 * node are tested); memory about 250 bytes per triangle, plus a copy of m for
 * the repair.
 * Returns VG_OK also if defects remain: see report->n_defect. VG_ERR_INPUT for
 * a node or patch index out of range, VG_ERR_UNSUPPORTED beyond 1.4e9
 * triangles, VG_ERR_STOPPED, VG_ERR_MEMORY. Threads: re-entrant. */
vg_status vg_surface_check(struct vg_mesh *m,
                           const struct vg_surface_check_options *options,
                           struct vg_surface_report *report,
                           struct vg_error *err);

void vg_surface_report_release(struct vg_surface_report *r);

/** Describe a finding in one line: patch, face (1-based), coordinates,
 * remedy. */
void vg_defect_text(const struct vg_mesh *m, const struct vg_defect *d,
                    char *text, size_t size);

/** Name of a kind: "open edge", ... Static string. */
const char *vg_defect_name(enum vg_defect_kind kind);

/** Heading for the findings of a kind: "open edges", ... Static string. */
const char *vg_defect_heading(enum vg_defect_kind kind);

/** Merge points that coincide: exactly for tolerance 0 (0 and -0 are equal),
 * else within it (single linkage on a grid; the lowest index is kept), and
 * renumber. Triangles that collapse are dropped; cells are only renumbered.
 * Counts may be NULL. O(n). On failure m is untouched: VG_ERR_INPUT for a
 * tolerance that is negative or not finite or an index out of range,
 * VG_ERR_MEMORY. */
vg_status vg_surface_weld(struct vg_mesh *m, double tolerance, size_t *n_merged,
                          size_t *n_dropped, struct vg_error *err);

/** Merge points with the same coordinates, of which the lowest index is kept,
 * and remove points that no face uses. Triangles keep their order, also those
 * that collapse. Points keep their order. m has no cells. O(n). VG_ERR_MEMORY.
 */
vg_status vg_surface_merge_points(struct vg_mesh *m, struct vg_error *err);

/** Find gaps between parts of a surface that coincide except for rounding: open
 * edges both ends of which are next to the ends of another open edge (a
 * partner), closer than a tenth of the shortest edge there. The rim of a hole
 * has no partners.
 *
 * @param r       report on m; without open edges nothing is done; NULL: not
 *                known
 * @param gap     out: smallest tolerance with which vg_surface_weld_rims closes
 *                all of them (rounded up by a factor of 1 + 1e-9); 0: no
 *                partners
 * @param n_edge  out: open edges that have a partner
 * O(n log n). On failure outputs are untouched: VG_ERR_INPUT for an index out
 * of range, VG_ERR_UNSUPPORTED, VG_ERR_MEMORY. */
vg_status vg_surface_rim_gap(const struct vg_mesh *m,
                             const struct vg_surface_report *r, double *gap,
                             size_t *n_edge, struct vg_error *err);

/** Merge the ends of open edges that are partners within `tolerance`; the point
 * with the lowest index keeps its position. If there is such a pair, points
 * with equal coordinates are merged as well. No other point moves, and the
 * edges of a hole stay open. Triangles that collapse are dropped. An existing
 * report becomes invalid.
 *
 * @param n_merged  out, may be NULL: points removed
 * @param n_edge    out, may be NULL: open edges that found a partner
 * O(n log n). On failure m is untouched: VG_ERR_INPUT for a tolerance that is
 * not positive and finite or an index out of range, VG_ERR_UNSUPPORTED,
 * VG_ERR_MEMORY. */
vg_status vg_surface_weld_rims(struct vg_mesh *m, double tolerance,
                               size_t *n_merged, size_t *n_edge,
                               struct vg_error *err);

#endif
