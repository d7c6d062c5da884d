/* core/surface/surface_check.h: is this triangulation fit to bound a mesh? */
#ifndef VG_CORE_SURFACE_SURFACE_CHECK_H
#define VG_CORE_SURFACE_SURFACE_CHECK_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

enum vg_defect_kind {
  VG_DEFECT_OPEN_EDGE,        /* an edge with one triangle */
  VG_DEFECT_NONMANIFOLD_EDGE, /* an edge with three or more */
  VG_DEFECT_ORIENTATION,      /* neighbours that disagree, not repaired */
  VG_DEFECT_DUPLICATE_POINT,  /* two points at the same coordinates */
  VG_DEFECT_UNUSED_POINT,
  VG_DEFECT_DEGENERATE_TRIANGLE, /* repeated node or exactly zero area */
  VG_DEFECT_DUPLICATE_TRIANGLE,
  VG_DEFECT_SHARED_WALL,  /* two triangles of touching bodies have the
                             same points */
  VG_DEFECT_INTERSECTION, /* two triangles cross or overlap */
  VG_DEFECT_SHELL,        /* nesting of closed shells is wrong */
  VG_DEFECT_NO_BC,        /* patch without boundary condition */
  VG_DEFECT_NOT_FINITE,   /* NaN or infinite coordinate */
  VG_DEFECT_QUAD,         /* quadrilateral: the fill takes triangles */
  VG_DEFECT_N
};

/** One finding. Faces and points are indices into the mesh after the repair,
 * quadrilateral q counting as face n_tri + q; SIZE_MAX: none. */
struct vg_defect {
  enum vg_defect_kind kind;
  size_t face[2];
  size_t point[2];
  double at[3]; /* where */
};

struct vg_shell { /* one edge-connected component */
  size_t n_tri;   /* a quadrilateral counts as two */
  size_t face;    /* the first of its faces */
  int is_closed;  /* every edge has exactly two faces; parent and
                     depth are found among closed shells only */
  double volume;  /* signed; > 0: normals point out of it */
  size_t parent;  /* shell directly around it; SIZE_MAX: none */
  int depth;      /* 0 outermost */
  double lo[3], hi[3];
};

struct vg_surface_report {
  size_t count[VG_DEFECT_N]; /* all findings by kind, in the mesh as the
                                repair leaves it */
  size_t n_defect, cap_defect;
  struct vg_defect *defect; /* every finding, sorted by kind, then face;
                               but beyond VG_SURFACE_PAIR_MAX intersecting
                               pairs one per face that intersects, with
                               its first partner: count stays true */
  uint32_t *face_kinds;     /* [n_tri + n_quad] bit 1 << kind for every
                               finding that touches the face */
  size_t n_flipped;         /* triangles turned by the repair */
  size_t n_removed_point, n_removed_tri; /* removed by the repair */
  size_t n_removed_wall; /* triangles of walls that touching bodies
                            shared, removed by the repair */
  int shells_reoriented; /* every closed shell was turned as a whole */
  size_t n_piece;        /* components connected by nodes */
  size_t n_shell;        /* components connected by edges */
  struct vg_shell *shell;
  uint32_t *tri_shell; /* [n_tri] */
  int is_closed;       /* no open or non-manifold edge */
};
#define VG_SURFACE_REPORT_INIT                                                 \
  {                                                                            \
    0                                                                          \
  }
#define VG_SURFACE_PAIR_MAX 262144

struct vg_surface_check_options {
  int repair;     /* orient, drop unused/duplicate points and
                     triangles where no guess is needed */
  int require_bc; /* report patches without a condition */
  int external;   /* the closed shells are bodies in a fluid
                     that a farfield will enclose: an outermost
                     shell must have its normals outward (into
                     the fluid). 0: outermost shells bound the
                     fluid from outside (normals inward). -1: not
                     known, the sides of shells are neither
                     judged nor changed */
  int threads;    /* 0: one per core; the same result for any */
  struct vg_stop stop;
};
#define VG_SURFACE_CHECK_OPTIONS_INIT                                          \
  {                                                                            \
    .repair = 1, .threads = 1                                                  \
  }

/** Find (and with `repair` fix) the defects of the boundary faces of m.
 *
 * The repair merges points with the same coordinates, drops unused points,
 * triangles with a repeated node and copies of a triangle (same nodes and
 * side, or a second copy of a piece of the skin that looks to the other side;
 * the first stays, whatever their patches), and both faces of a wall that two
 * bodies share where the bodies then have a common closed skin. It makes
 * neighbours agree (the fewer faces are turned) and turns closed shells to
 * the side that `external` asks for. A shell nested deeper
 * than the fluid's own boundary is never turned: whether it is a cavity or a
 * stray body is not ours to guess.
 *
 * Each fault counts once. Copies that are reported take no part in edges and
 * shells; of faces with the same nodes one takes part in intersections.
 *
 * Intersections: pairs of triangles with a point in common that is not on a
 * common node or edge; exact, touching counts, degenerate ones excepted. A
 * node is common only to faces that are connected around it through edges:
 * sheets that meet in a node touch; the non-manifold edge in which sheets
 * meet is a finding of its own.
 * With cells in m, points that only cells use are not unused.
 *
 * @param m       changed only by the repair; untouched on failure
 * @param report  released first; empty on failure
 * O(n log n + intersections) while no node has very many faces (pairs at one
 * node are all tested); memory about 250 bytes per triangle, a copy of m for
 * the repair not counted.
 * Returns VG_OK also when defects remain: look at report->n_defect.
 * VG_ERR_INPUT for a node or patch index out of range, VG_ERR_UNSUPPORTED
 * beyond 1.4e9 triangles, VG_ERR_STOPPED, VG_ERR_MEMORY. Threads: re-entrant.
 */
vg_status vg_surface_check(struct vg_mesh *m,
                           const struct vg_surface_check_options *options,
                           struct vg_surface_report *report,
                           struct vg_error *err);

void vg_surface_report_release(struct vg_surface_report *r);

/** One line for a person: patch, face (1-based), coordinates, what to do. */
void vg_defect_text(const struct vg_mesh *m, const struct vg_defect *d,
                    char *text, size_t size);

/** Name of a kind: "open edge", ... Static string. */
const char *vg_defect_name(enum vg_defect_kind kind);

/** Merge points that coincide: exactly for tolerance 0 (0 and -0 are the
 * same), else within it (single linkage on a grid, lowest index kept), and
 * renumber. Triangles that collapse are dropped; cells are only renumbered.
 * Counts may be NULL. O(n). On failure m is untouched: VG_ERR_INPUT for a
 * tolerance that is negative or not finite or an index out of range,
 * VG_ERR_MEMORY. */
vg_status vg_surface_weld(struct vg_mesh *m, double tolerance, size_t *n_merged,
                          size_t *n_dropped, struct vg_error *err);

/** Gaps between parts of a surface that coincide but for rounding: open edges
 * of which both ends lie next to the ends of another open edge, and nearer than
 * a tenth of the shortest edge there. The rim of a hole has no such partners.
 *
 * @param r       of m; without open edges nothing is done; NULL: not known
 * @param gap     out: smallest tolerance at which vg_surface_weld_rims closes
 *                all of them (rounded up by 1e-9 of itself); 0: no partners
 * @param n_edge  out: open edges that have a partner
 * O(n log n). On failure outputs are untouched: VG_ERR_INPUT for an index out
 * of range, VG_ERR_UNSUPPORTED, VG_ERR_MEMORY. */
vg_status vg_surface_rim_gap(const struct vg_mesh *m,
                             const struct vg_surface_report *r, double *gap,
                             size_t *n_edge, struct vg_error *err);

/** Merge the ends of open edges that are partners within `tolerance`; the point
 * of the lowest index keeps its place. Points with equal coordinates become one
 * as well where there is such a pair. No other point moves, and the edges of a
 * hole stay open. Triangles that collapse are dropped; a report is out of date.
 *
 * @param n_merged  out, may be NULL: points that are gone
 * @param n_edge    out, may be NULL: open edges that found a partner
 * O(n log n). On failure m is untouched: VG_ERR_INPUT for a tolerance that is
 * not positive and finite or an index out of range, VG_ERR_UNSUPPORTED,
 * VG_ERR_MEMORY. */
vg_status vg_surface_weld_rims(struct vg_mesh *m, double tolerance,
                               size_t *n_merged, size_t *n_edge,
                               struct vg_error *err);

#endif
