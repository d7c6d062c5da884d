/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/quality.h: check of a finished mesh: validity and element
 * quality. */
#ifndef VG_CORE_JUDGE_QUALITY_H
#define VG_CORE_JUDGE_QUALITY_H

#include <stddef.h>
#include <stdint.h>

#include "core/judge/flat_cells.h"
#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"

#define VG_HIST_ANGLE 36 /* bins of 5 degrees */
#define VG_HIST_UNIT 20  /* bins of 0.05 */
#define VG_HIST_SKEW 20  /* bins of 0.25 */
#define VG_WORST 10

/* Lengths in the metric are counted in bins of equal ratio, twelve per octave,
 * from 2^-5 to 2^5; shorter and longer edges are in the first and last bin. */
#define VG_PER_OCTAVE 12
#define VG_LENGTH_LOWEST 0.03125
#define VG_HIST_LENGTH (10 * VG_PER_OCTAVE)

struct vg_worst_cell {
  size_t cell;                  /* 0-based: tets, pyramids, prisms, hexes */
  double value, at[3];          /* minimum dihedral in degrees, centroid */
  struct vg_flat_points points; /* of a flat cell, if has_flat */
};

/* A face or cell with one of the worst figures for solvers. */
struct vg_worst_place {
  size_t cell;         /* 0-based, as in struct vg_worst_cell; the lower one of
                          both cells of a face */
  double value, at[3]; /* figure; centre of the face or cell */
};

/* Limits beyond which checkMesh of OpenFOAM counts a face or cell. */
#define VG_LIMIT_ANGLE 70.0 /* degrees */
#define VG_LIMIT_SKEWNESS 4.0
#define VG_LIMIT_WEIGHT 0.05
#define VG_LIMIT_VOLUME_RATIO 0.01
#define VG_LIMIT_DETERMINANT 0.001

/* Figures that have a list of worst places. */
enum { VG_WORST_ANGLE, VG_WORST_SKEWNESS, VG_WORST_QUALITY, VG_WORST_LISTS };

/* Quality in the terms of solvers with unknowns in the cells. A is the area
 * vector of a face, f the vector from the centre of a cell to that of its face,
 * c the vector to the centre of its neighbour. Centres, areas and volumes are
 * computed as in OpenFOAM: a quadrilateral consists of the triangles around the
 * mean of its corners, a cell of the pyramids from its faces to the mean of
 * their centres. */
struct vg_solver_quality {
  size_t n_face, n_boundary_face; /* between cells; on the boundary */
  /* Non-orthogonality of faces between cells: angle between A and c, in
   * degrees. The mean is that of the cosines, as an angle. */
  double angle_max, angle_mean;
  size_t n_angle; /* number above VG_LIMIT_ANGLE */
  /* Skewness of all faces: distance from the centre of the face to the point
   * where c passes through it, over the extent of the face in this direction
   * or 0.2 |c|, whichever is larger. On the boundary c is along A, of length
   * f A / |A|, and 0.4 takes the place of 0.2. */
  double skewness_max;
  size_t n_skewness;
  /* Weight of the linear interpolation on a face between cells: the smaller one
   * of the distances of both centres from the face along A, over their sum. */
  double weight_min;
  size_t n_weight;
  double volume_ratio_min; /* smaller volume over larger one, of neighbours */
  size_t n_volume_ratio;
  /* Determinant of sum A A^T / (mean |A|)^2 over the faces of a cell that have
   * a neighbour, over 8: 1 for a cube. */
  double determinant_min;
  size_t n_determinant;
  /* Orthogonal quality of Fluent: the smallest cosine of the angles between A
   * and f, and between A and c, of the faces of a cell. */
  double quality_min, quality_mean;
  size_t hist_angle[VG_HIST_ANGLE]; /* bins of 5 degrees */
  size_t hist_skewness[VG_HIST_SKEW], hist_quality[VG_HIST_UNIT];
  struct vg_worst_place worst[VG_WORST_LISTS][VG_WORST];
  size_t n_worst[VG_WORST_LISTS];
};

/* Lists of worst places of the median dual. */
enum {
  VG_WORST_DUAL_POINT,
  VG_WORST_DUAL_FACE,
  VG_WORST_DUAL_VOLUME,
  VG_WORST_DUAL_LISTS
};

/* Orthogonality of the median dual, for solvers with unknowns in the points.
 * The dual face of an edge consists of the triangles from the middle of the
 * edge to the centres of the faces and cells around it, which are the means of
 * their corners. Its orthogonality is 90 degrees minus the angle between its
 * area vector and the edge. That of a point is the mean over its dual faces,
 * weighted by their areas, as in SU2. Its volume ratio is that of the largest
 * and smallest of the tetrahedra that make up its control volume, between the
 * point and the triangles. */
struct vg_dual_quality {
  size_t n_face, n_point; /* dual faces (edges of cells), control volumes */
  size_t n_opposed;       /* dual faces with an orthogonality of 0 or less */
  double face_min, point_min; /* degrees */
  double volume_ratio_max;
  double below[3]; /* % of points below 1, 10, 20 degrees */
  /* cell: the point, and the lower point of an edge; at: the point, and the
   * middle of the edge. */
  struct vg_worst_place worst[VG_WORST_DUAL_LISTS][VG_WORST];
  size_t n_worst[VG_WORST_DUAL_LISTS];
};

/* Numbers of flat cells (core/judge/flat_cells.h) of one cause. */
struct vg_flat_count {
  size_t n;
  size_t at_interface, spanning, needle; /* of these: as in struct
                                            vg_flat_class */
};

/* Figures in the metric of the sizing field, of the tetrahedra that are
 * checked. Mean ratios are 12 (3V)^(2/3) / sum of squared edges, with volume
 * and edges measured in the metric of the corner where cells are smallest. */
struct vg_metric_report {
  size_t n_edge, n_cell;
  double length_min, length_max;
  double within[3]; /* % of edges with lengths within 0.7 to 1.4,
                       1/sqrt 2 to sqrt 2, 0.5 to 2 */
  double mean_ratio_mean, mean_ratio_min;
  double below[2];   /* % of cells with mean ratios below 0.1, 0.2 */
  double complexity; /* integral of sqrt(det M) over the cells */
  double ideal;      /* number of regular tetrahedra of edge length 1
                        with the volume of the mesh in the metric */
  size_t hist_length[VG_HIST_LENGTH];
  size_t hist_mean_ratio[VG_HIST_UNIT];
};

struct vg_mesh_report {
  /* Validity: all zero in a valid mesh. */
  size_t bad_index, unused_point, not_finite, duplicate_point;
  size_t not_positive;     /* cells of zero or negative volume */
  size_t open_face;        /* cell faces without a neighbour or boundary face */
  size_t crowded_face;     /* faces with more than two cells */
  size_t same_side_face;   /* neighbours on the same side of their face */
  size_t orphan_boundary;  /* boundary faces without a cell */
  size_t outward_boundary; /* boundary faces that point out of the fluid */
  size_t n_component;      /* face-connected components of cells */
  double volume, enclosed, volume_error;
  int is_valid;
  /* Size. */
  size_t n_point, n_cell, n_inner_face;
  /* Quality of tetrahedra; angles are dihedral, in degrees. */
  double angle_min, angle_max;
  double angle_min_p1; /* 1st percentile of the smallest angle per cell */
  double below[5];     /* % of cells with smallest angle below 5 10 15 20 30 */
  double above[3];     /* % of cells with largest angle above 150 160 170 */
  double radius_ratio_mean, radius_ratio_min; /* 3 r_in / R_circ */
  double mean_ratio_mean; /* 12 (3V)^(2/3) / sum of squared edges */
  double edge_length;     /* mean over cells of the root mean square edge */
  double volume_ratio[3]; /* of face neighbours: median, 95 %, maximum */
  size_t hist_angle_min[VG_HIST_ANGLE], hist_angle_max[VG_HIST_ANGLE];
  size_t hist_radius_ratio[VG_HIST_UNIT];
  struct vg_worst_cell worst[VG_WORST];
  size_t n_worst;
  /* Memory of the check of slices on this rank, in bytes: data that is shared
   * by slices, at the most, and the slices in work, each with the largest
   * number of points and cells. */
  size_t bytes_shared, bytes_slices;
  /* Flat cells by cause (if has_flat). */
  int has_flat;
  struct vg_flat_count flat[VG_FLAT_CAUSES];
  /* Interior edges compared with the sizing field (if has_sizing). */
  int has_sizing;
  double edge_mean;               /* mean of length / target */
  double edge_within;             /* % within [0.7, 1.5] of the target */
  size_t hist_edge[VG_HIST_UNIT]; /* length / target, bins of 0.1 */
  /* Figures in the metric (if has_metric). */
  int has_metric;
  struct vg_metric_report metric;
  /* Quality in the terms of solvers (if has_solver): of a whole valid mesh. */
  int has_solver;
  struct vg_solver_quality solver;
  /* Orthogonality of the median dual (if has_dual): of a whole valid mesh, on
   * request. */
  int has_dual;
  struct vg_dual_quality dual;
};

/** Check m. sizing may be NULL. The target length of an edge is the sizing
 * field at its midpoint. If the field is stretched, the length in the metric
 * (vg_metric_length) takes the place of length / target, edges are those of
 * tetrahedra, and the report has figures in the metric. Extreme angles are
 * computed with libm and only used for reporting. Cost: O(n) memory for one
 * face table, O(n log n) time or better; in a metric, 56 bytes per point more;
 * 9 bytes per tetrahedron and 41 per other cell for the quality in the terms of
 * solvers.
 * VG_ERR_MEMORY if memory is refused; an invalid mesh is VG_OK with is_valid 0.
 */
vg_status vg_mesh_judge(const struct vg_mesh *m, const struct vg_sizing *sizing,
                        struct vg_mesh_report *report, struct vg_error *err);

/** As vg_mesh_judge with a stretched field, for any field: the metric of an
 * isotropic field is 1 / h^2 times the identity.
 *
 * @param n_layer  number of tetrahedra of layers, which are the first ones of m
 *                 and are not compared with the field */
vg_status vg_mesh_judge_in_metric(const struct vg_mesh *m, size_t n_layer,
                                  const struct vg_sizing *sizing,
                                  struct vg_mesh_report *report,
                                  struct vg_error *err);

/** Add the orthogonality of the median dual to the report on m. No effect if m
 * is not valid. Cost: O(n) time; 4 bytes per corner of a cell and 72 per point.
 * VG_ERR_MEMORY. VG_ERR_UNSUPPORTED for 2^32 corners of cells. */
vg_status vg_mesh_judge_dual(const struct vg_mesh *m,
                             struct vg_mesh_report *report,
                             struct vg_error *err);

/** Does the mesh check regard a cell as positive? The exact sign of the volume
 * for a tetrahedron; for other cells, the signs of the volume and of the
 * tetrahedra at all corners.
 *
 * @param kind  0 tetrahedron, 1 pyramid, 2 prism, 3 hexahedron
 * @param node  its points in x */
int vg_cell_positive(const double (*x)[3], int kind, const uint32_t *node);

/** Least square, with its sign, of the cosines between the area vectors of the
 * faces of a pyramid, prism or hexahedron and the lines from its centre to
 * theirs: the square of the orthogonal quality of the cell by itself. If it is
 * not positive, the centre is behind a face. Arguments as for
 * vg_cell_positive. */
double vg_cell_cosine2(const double (*x)[3], int kind, const uint32_t *node);

/** Signed volume of a cell as used by the mesh check: a quadrilateral counts as
 * the mean of its two triangulations. Arguments as for vg_cell_positive. */
double vg_cell_volume(const double (*x)[3], int kind, const uint32_t *node);

/** Quality of each cell of a valid mesh in the terms of solvers, for output:
 * largest non-orthogonality in degrees and largest skewness of its faces, and
 * orthogonal quality. Each is [number of cells]: tets, pyramids, prisms, hexes.
 * Cost and memory as vg_mesh_judge. VG_ERR_MEMORY. */
vg_status vg_mesh_solver_fields(const struct vg_mesh *m,
                                float *non_orthogonality, float *skewness,
                                float *orthogonal_quality,
                                struct vg_error *err);

/** Quality of each tetrahedron, for output: smallest dihedral angle in degrees
 * and radius ratio. Each is [n_tet] and may be NULL. */
void vg_mesh_cell_quality(const struct vg_mesh *m, float *angle_min,
                          float *radius_ratio);

#endif
