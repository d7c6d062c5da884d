/* core/judge/quality_parts.h: what the files of quality.c and judge_slices.c
 * share. Private.
 *
 * A judgement is made of four sweeps: points (quality.c), shape of cells
 * (quality_shape.c), faces (quality_faces.c) and edges (quality_edges.c).
 * Each adds to one set of figures, which are integers, exact sums and extremes
 * and may thus be added up in any order; indices are known to be in range and
 * coordinates to be finite when the last three run. */
#ifndef VG_CORE_JUDGE_QUALITY_PARTS_H
#define VG_CORE_JUDGE_QUALITY_PARTS_H

#include "core/geometry/exact_sum.h"
#include "core/judge/quality.h"

/* Smallest angles are also counted in bins of 0.01 degree: percentiles. */
#define VG_FINE_PER_DEGREE 100
#define VG_N_FINE (180 * VG_FINE_PER_DEGREE + 1)

/* Ratios are counted in bins of equal exponent and leading mantissa bits:
 * 1/256 relative width, from 1 to the largest float. */
#define VG_RATIO_SHIFT 15
#define VG_ONE_BITS 0x3F800000u
#define VG_N_RATIO ((0x7F800000u - VG_ONE_BITS) >> VG_RATIO_SHIFT)

/** What adds up. Nothing but uint64_t, so that an array of them may be summed
 * over ranks. Names as in struct vg_mesh_report. */
struct vg_counts {
  uint64_t bad_index, not_finite, unused_point, duplicate_point;
  uint64_t not_positive, open_face, crowded_face, same_side_face;
  uint64_t orphan_boundary, outward_boundary, n_inner_face;
  uint64_t n_point, n_cell, n_tet, n_edge, edge_within;
  uint64_t below[5], above[3];
  uint64_t angle_min[VG_HIST_ANGLE], angle_max[VG_HIST_ANGLE];
  uint64_t radius_ratio[VG_HIST_UNIT], edge[VG_HIST_UNIT];
  uint64_t fine[VG_N_FINE], ratio[VG_N_RATIO];
  struct vg_exact volume, sum_radius, sum_mean, sum_edge, sum_length;
};

struct vg_stats {
  struct vg_counts n;
  double angle_min, angle_max, radius_ratio_min;
  struct vg_worst_cell worst[VG_WORST]; /* by angle, then by cell */
  size_t n_worst;
};

/** Figures of nothing; NULL when memory is refused. free() it. */
struct vg_stats *vg_stats_new(void);

void vg_stats_add(struct vg_stats *f, const struct vg_stats *more);

/** Enter a cell where it is among the worst. */
void vg_stats_worst(struct vg_stats *f, const struct vg_worst_cell *w);

/** A face of n_cell cells and n_boundary boundary faces; same_side: when
 * these are two, both wind the same way. Returns whether it joins two cells. */
int vg_stats_face(struct vg_stats *f, size_t n_cell, size_t n_boundary,
                  int same_side);

/** Two cells of volumes v and w share a face. */
void vg_stats_ratio(struct vg_stats *f, float v, float w);

/** An edge whose length is `ratio` times its target. */
void vg_stats_edge(struct vg_stats *f, double ratio);

/** Everything but `enclosed` and what follows from it.
 * has_sizing: figures of edges, too. */
void vg_stats_report(const struct vg_stats *f, size_t n_component,
                     int has_sizing, struct vg_mesh_report *r);

/** With r->volume and r->enclosed known: their difference, and whether the
 * mesh is valid. */
void vg_report_conclude(struct vg_mesh_report *r);

/** Faces of one kind of cell, normals out of the cell: n_face of them, the
 * first n_tri are triangles (fourth entry unused), the others quads. */
struct vg_cell_faces {
  int n_node, n_face, n_tri;
  uint8_t node[6][4];
};

enum { VG_CELL_TET, VG_CELL_PYR, VG_CELL_PRI, VG_CELL_HEX, VG_CELL_KINDS };

extern const struct vg_cell_faces vg_cell_faces[VG_CELL_KINDS];

/** The cells of one kind: [n][n_node] and the index of the first among all
 * cells (tets, pyramids, prisms, hexes). */
struct vg_cells {
  const uint32_t *node;
  size_t n, first;
};

struct vg_cells vg_mesh_cells(const struct vg_mesh *m, int kind);

/** Nodes of cells and boundary faces that are no points; points with
 * coordinates that are not finite. */
size_t vg_count_bad_index(const struct vg_mesh *m);
size_t vg_count_not_finite(size_t n, const double (*x)[3]);

/** used[i] = 1 for points of cells. */
void vg_mark_used(const struct vg_mesh *m, uint8_t *used);

/** What the boundary of m encloses, positive where its faces point inwards;
 * lo, hi: corners of the box of all points. */
double vg_enclosed_volume(const struct vg_mesh *m, const double lo[3],
                          const double hi[3]);

/** Signs and sums of volumes, angles, ratios, worst cells.
 * @param first   number of the first tetrahedron, for the list of the worst
 * @param volume  out: [n_cell], signed */
void vg_judge_shape(const struct vg_mesh *m, size_t first, float *volume,
                    struct vg_stats *f);

/** Faces of a part of a mesh that have no, or too many, neighbours in it. */
struct vg_unpaired_face {
  uint32_t node[4];   /* outwards around the face; VG_NO_NODE: no quad */
  uint32_t component; /* of its cell: 0 .. n_component - 1 */
  float volume;       /* of its cell */
};
struct vg_unpaired_edge {
  uint32_t node[2];
  double ratio;
};

struct vg_unpaired {
  size_t n_face, cap_face, n_edge, cap_edge;
  struct vg_unpaired_face *face;
  struct vg_unpaired_edge *edge; /* their edges, each once: length / target */
  /* NULL, or which faces of two cells are to be listed, too. */
  int (*is_shared)(const void *context, const uint32_t node[4]);
  const void *context;
};
#define VG_NO_NODE UINT32_MAX

void vg_unpaired_release(struct vg_unpaired *unpaired);

/** Conformity, components, orientation and volume ratios of neighbours.
 * @param unpaired  NULL: m is a mesh with its boundary. Else m is a part of
 * one,
 *               and the faces that others have to match are listed here */
vg_status vg_judge_faces(const struct vg_mesh *m, const float *volume,
                         struct vg_stats *f, struct vg_unpaired *unpaired,
                         size_t *n_component, struct vg_error *err);

/** Whether vg_pair_faces does for a mesh or a part of one: tetrahedra, whose
 * unpaired faces are not given. */
int vg_faces_can_pair(const struct vg_mesh *m,
                      const struct vg_unpaired *unpaired);

/** As vg_judge_faces, where each face has two sides.
 * @param parent  in/out: [n_tet] components: each cell its own
 * VG_BLOCKED: some faces of a whole mesh have not; nothing but parent was
 * touched. Of a part, sides that find no other are listed in unpaired. */
vg_status vg_pair_faces(const struct vg_mesh *m, const float *volume,
                        struct vg_stats *f, struct vg_unpaired *unpaired,
                        uint32_t *parent, struct vg_error *err);

/** Edges against the field: those that are not of boundary faces. With unpaired
 * faces: those that are not of these, whose edges are listed. */
vg_status vg_judge_edges(const struct vg_mesh *m,
                         const struct vg_sizing *sizing, struct vg_stats *f,
                         struct vg_unpaired *unpaired, struct vg_error *err);

#endif
