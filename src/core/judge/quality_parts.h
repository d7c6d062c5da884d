/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/quality_parts.h: declarations shared by the files of quality.c
 * and judge_slices.c. Private.
 *
 * A mesh check consists of four sweeps: points (quality.c), shape of cells
 * (quality_shape.c), faces (quality_faces.c) and edges (quality_edges.c). In a
 * metric, a fifth sweep measures the cells in it (quality_metric.c). All of
 * them add to one set of figures. These are integers, exact sums and extremes,
 * and may thus be added up in any order. All sweeps but the first run only if
 * all indices are in range and all coordinates are finite. */
#ifndef VG_CORE_JUDGE_QUALITY_PARTS_H
#define VG_CORE_JUDGE_QUALITY_PARTS_H

#include <string.h>

#include "core/geometry/exact_sum.h"
#include "core/judge/quality.h"

/* The smallest angles are also counted in bins of 0.01 degree, for
 * percentiles. */
#define VG_FINE_PER_DEGREE 100
#define VG_N_FINE (180 * VG_FINE_PER_DEGREE + 1)

/* Ratios are counted in bins of equal exponent and leading mantissa bits:
 * 1/256 relative width, from 1 to the largest float. */
#define VG_RATIO_SHIFT 15
#define VG_ONE_BITS 0x3F800000u
#define VG_N_RATIO ((0x7F800000u - VG_ONE_BITS) >> VG_RATIO_SHIFT)

/** Figures that are added up. All members are uint64_t, so that they can be
 * summed over ranks as an array. Names as in struct vg_mesh_report. */
struct vg_counts {
  uint64_t bad_index, not_finite, unused_point, duplicate_point;
  uint64_t not_positive, open_face, crowded_face, same_side_face;
  uint64_t orphan_boundary, outward_boundary, n_inner_face;
  uint64_t n_point, n_cell, n_tet, n_edge, edge_within;
  uint64_t below[5], above[3];
  uint64_t angle_min[VG_HIST_ANGLE], angle_max[VG_HIST_ANGLE];
  uint64_t radius_ratio[VG_HIST_UNIT], edge[VG_HIST_UNIT];
  uint64_t fine[VG_N_FINE], ratio[VG_N_RATIO];
  uint64_t n_length, within[3], length[VG_HIST_LENGTH];
  uint64_t n_metric_cell, metric_below[2], metric_ratio[VG_HIST_UNIT];
  uint64_t flat[VG_FLAT_CAUSES], flat_interface[VG_FLAT_CAUSES];
  uint64_t flat_spanning[VG_FLAT_CAUSES], flat_needle[VG_FLAT_CAUSES];
  struct vg_exact volume, sum_radius, sum_mean, sum_edge, sum_length;
  struct vg_exact sum_metric_ratio, complexity;
  /* Quality in the terms of solvers: numbers of faces between cells and on the
   * boundary, of those beyond limits, and histograms. */
  uint64_t n_joined, n_border, n_weight, n_volume_ratio, n_determinant;
  uint64_t solver_angle[VG_HIST_ANGLE], skewness[VG_HIST_SKEW];
  uint64_t quality[VG_HIST_UNIT];
  uint64_t sum_cosine,
    sum_quality; /* two's complement, units of 1 / VG_FIXED */
  /* Median dual. */
  uint64_t n_dual_face, n_dual_point, n_dual_opposed, dual_below[3];
};

/* Cosines are added up as integers of this unit: 2^33 of them fit. */
#define VG_FIXED 1073741824.0 /* 2^30 */

/** Extremes in the metric and in the terms of solvers; smallest values are
 * stored as the largest of their negatives, so that all extremes of ranks are
 * combined in the same way. */
enum {
  VG_MOST_SHORT,
  VG_MOST_LONG,
  VG_MOST_DISTORTED,
  VG_MOST_OBLIQUE, /* cosine of the non-orthogonality */
  VG_MOST_SKEWED,
  VG_MOST_LOPSIDED, /* weight */
  VG_MOST_UNEQUAL,  /* volume ratio */
  VG_MOST_SINGULAR, /* determinant */
  VG_MOST_SLANTED,  /* orthogonal quality */
  VG_MOST_N
};

/* Lists of the worst places of the median dual follow those of solvers. */
#define VG_PLACES_DUAL VG_WORST_LISTS
#define VG_PLACES_LISTS (VG_WORST_LISTS + (int)VG_WORST_DUAL_LISTS)

/** The worst places of one kind: sorted by value, the lowest first, then by
 * cell and position. */
struct vg_places {
  struct vg_worst_place place[VG_WORST];
  size_t n;
};

struct vg_stats {
  struct vg_counts n;
  double angle_min, angle_max, radius_ratio_min;
  double most[VG_MOST_N];
  struct vg_worst_cell worst[VG_WORST]; /* sorted by angle, then by cell */
  size_t n_worst;
  /* Values: cosine of the angle, negative skewness, orthogonal quality; for the
   * median dual, orthogonality in degrees, negative volume
   * ratio. */
  struct vg_places places[VG_PLACES_LISTS];
};

/** Figures of an empty mesh; NULL if memory is refused. Release with free(). */
struct vg_stats *vg_stats_new(void);

void vg_stats_add(struct vg_stats *f, const struct vg_stats *more);

/** Add a cell to the list of the worst cells if it is one of them. */
void vg_stats_worst(struct vg_stats *f, const struct vg_worst_cell *w);

/** Add a place to the list if it is one of the worst. */
void vg_places_add(struct vg_places *list, const struct vg_worst_place *p);

/** Could a place with this value be one of the worst? */
static inline int vg_places_admit(const struct vg_places *list, double value)
{
  return list->n < VG_WORST || value <= list->place[VG_WORST - 1].value;
}

/** Count a face with n_cell cells and n_boundary boundary faces. same_side:
 * there are two in total and both have the same winding. Returns whether the
 * face joins two cells. */
int vg_stats_face(struct vg_stats *f, size_t n_cell, size_t n_boundary,
                  int same_side);

/** Count two cells of volumes v and w that share a face. */
static inline void vg_stats_ratio(struct vg_stats *f, float v, float w)
{
  float ratio;
  uint32_t bits;

  if (!(v > 0) || !(w > 0)) return;
  ratio = v > w ? v / w : w / v;
  memcpy(&bits, &ratio, sizeof bits);
  bits = (bits - VG_ONE_BITS) >> VG_RATIO_SHIFT;
  f->n.ratio[bits < VG_N_RATIO ? bits : VG_N_RATIO - 1]++;
}

/** Count an edge whose length is `ratio` times its target. */
void vg_stats_edge(struct vg_stats *f, double ratio);

/** Count an edge of this length in the metric. */
void vg_stats_length(struct vg_stats *f, double length);

/** Groups of figures that a report includes on request. */
enum {
  VG_HAS_SIZING = 1, /* edges, compared with the sizing field */
  VG_HAS_METRIC = 2, /* figures in the metric */
  VG_HAS_FLAT = 4,   /* causes of flat cells */
  VG_HAS_SOLVER = 8, /* quality in the terms of solvers */
  VG_HAS_DUAL = 16   /* orthogonality of the median dual */
};

/** Fill the report, except for `enclosed` and the members that depend on it.
 *
 * @param has  sum of VG_HAS_... */
void vg_stats_report(const struct vg_stats *f, size_t n_component, int has,
                     struct vg_mesh_report *r);

/** Fill the figures in the metric. */
void vg_stats_report_metric(const struct vg_stats *f,
                            struct vg_metric_report *r);

/** Fill the figures in the terms of solvers. */
void vg_stats_report_solver(const struct vg_stats *f,
                            struct vg_solver_quality *q);

/** Fill the figures of the median dual. */
void vg_stats_report_dual(const struct vg_stats *f, struct vg_dual_quality *q);

/** Compute the volume error from r->volume and r->enclosed, and whether the
 * mesh is valid. The figures in the terms of solvers and those of the median
 * dual are only kept if it is. */
void vg_report_conclude(struct vg_mesh_report *r);

/** Faces of one kind of cell, with normals out of the cell. The first n_tri of
 * the n_face faces are triangles (fourth entry unused), the others quads. */
struct vg_cell_faces {
  int n_node, n_face, n_tri;
  uint8_t node[6][4];
};

enum { VG_CELL_TET, VG_CELL_PYR, VG_CELL_PRI, VG_CELL_HEX, VG_CELL_KINDS };

extern const struct vg_cell_faces vg_cell_faces[VG_CELL_KINDS];

/** The cells of one kind: [n][n_node], and the index of the first one among all
 * cells (tets, pyramids, prisms, hexes). */
struct vg_cells {
  const uint32_t *node;
  size_t n, first;
};

struct vg_cells vg_mesh_cells(const struct vg_mesh *m, int kind);

/** Number of nodes of cells and boundary faces that are not valid points;
 * number of points with coordinates that are not finite. */
size_t vg_count_bad_index(const struct vg_mesh *m);
size_t vg_count_not_finite(size_t n, const double (*x)[3]);

/** Set used[i] = 1 for the points of cells. */
void vg_mark_used(const struct vg_mesh *m, uint8_t *used);

/** Volume enclosed by the boundary of m, positive if its faces point inwards.
 * lo, hi: bounding box of all points. */
double vg_enclosed_volume(const struct vg_mesh *m, const double lo[3],
                          const double hi[3]);

/** The points of a part of a mesh, for the classification of flat cells. */
struct vg_flat_part {
  const struct vg_flat *flat;
  const uint32_t *id;     /* point of the mesh by point of the part */
  uint64_t own_at, n_own; /* points of the mesh that belong to the part */
  int is_interface;       /* 1: all points that are not on the boundary count
                             as interface points; 0: those of other parts */
};

struct vg_solver_sweep; /* core/judge/quality_solver.h */

/** Measure signs and sums of volumes, angles, ratios, and the worst cells.
 *
 * @param first   number of the first tetrahedron, for the list of the worst
 *                cells
 * @param part    NULL: do not classify flat cells
 * @param volume  out: [n_cell], signed
 * @param solver  NULL, or gets the figures that a tetrahedron has by itself */
void vg_judge_shape(const struct vg_mesh *m, size_t first,
                    const struct vg_flat_part *part, float *volume,
                    struct vg_stats *f, struct vg_solver_sweep *solver);

/** Metrics at the points of a mesh or slice, evaluated when they are first
 * needed. Threads: one. */
struct vg_judged_point {
  double m[6];
  double size; /* det(M)^(-1/6); 0: not yet evaluated */
};
struct vg_point_metrics {
  const struct vg_sizing *sizing;
  const struct vg_mesh *m;
  size_t first;               /* first tetrahedron to be measured */
  struct vg_judged_point *at; /* [m->n_point] */
};

/** Metrics of the field at the points of m, to measure its tetrahedra from
 * `first` on; VG_ERR_MEMORY. The mesh is borrowed. */
vg_status vg_point_metrics_init(struct vg_point_metrics *p,
                                const struct vg_sizing *sizing,
                                const struct vg_mesh *m, size_t first,
                                struct vg_error *err);
void vg_point_metrics_release(struct vg_point_metrics *p);

/** Length of the edge a b in the metric. Exchanging a and b gives the same
 * bits. */
double vg_length_in_metric(struct vg_point_metrics *p, uint32_t a, uint32_t b);

/** Measure tetrahedra in the metric: mean ratios, complexity. */
void vg_judge_metric(struct vg_point_metrics *p, struct vg_stats *f);

/** Faces of a part of a mesh that have no neighbour in it, or too many. */
struct vg_unpaired_face {
  uint32_t node[4];   /* outward winding; VG_NO_NODE: not a quad */
  uint32_t component; /* component of its cell: 0 .. n_component - 1 */
  uint32_t cell;      /* its cell */
  float volume;       /* volume of its cell */
};
struct vg_unpaired_edge {
  uint32_t node[2];
  double ratio; /* length / target, or length in the metric */
};

struct vg_unpaired {
  size_t n_face, cap_face, n_edge, cap_edge;
  struct vg_unpaired_face *face;
  struct vg_unpaired_edge *edge; /* edges of these faces, each once; in a
                                    metric only those of tetrahedra */
  /* NULL, or selects faces with two cells that must also be listed. */
  int (*is_shared)(const void *context, const uint32_t node[4]);
  const void *context;
};
#define VG_NO_NODE UINT32_MAX

void vg_unpaired_release(struct vg_unpaired *unpaired);

/** Check conformity, components, orientation and volume ratios of neighbours.
 *
 * @param solver    NULL, or measures the faces that are matched
 * @param unpaired  NULL: m is a mesh with its boundary. Otherwise m is a part
 *                  of a mesh, and the faces to be matched with other parts are
 *                  listed here */
vg_status vg_judge_faces(const struct vg_mesh *m, const float *volume,
                         struct vg_stats *f, struct vg_solver_sweep *solver,
                         struct vg_unpaired *unpaired, size_t *n_component,
                         struct vg_error *err);

/** Can vg_pair_faces handle a mesh, or a part of one? It must consist of
 * tetrahedra, without a selection of faces (is_shared). */
int vg_faces_can_pair(const struct vg_mesh *m,
                      const struct vg_unpaired *unpaired);

/** As vg_judge_faces, for meshes in which each face has two sides.
 *
 * @param parent  in/out: [n_tet] components: initially each cell its own
 *
 * VG_BLOCKED: some faces of a whole mesh do not have two sides; only parent
 * was modified. For a part of a mesh, sides without a partner are listed in
 * unpaired. */
vg_status vg_pair_faces(const struct vg_mesh *m, const float *volume,
                        struct vg_stats *f, struct vg_solver_sweep *solver,
                        struct vg_unpaired *unpaired, uint32_t *parent,
                        struct vg_error *err);

/** Compare edges with the sizing field, except edges of boundary faces. With
 * unpaired: except edges of unpaired faces, which are listed.
 *
 * @param metrics  not NULL: edges of tetrahedra are measured in the metric
 *                 instead, and the lengths of all of them are counted,
 *                 including those of boundary faces */
vg_status vg_judge_edges(const struct vg_mesh *m,
                         const struct vg_sizing *sizing,
                         struct vg_point_metrics *metrics, struct vg_stats *f,
                         struct vg_unpaired *unpaired, struct vg_error *err);

#endif
