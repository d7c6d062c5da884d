/* core/quality_parts.h: what the files of quality.c share. Private.
 *
 * A judgement is made of four sweeps: points (quality.c), shape of cells
 * (quality_shape.c), faces (quality_faces.c) and edges (quality_edges.c).
 * Each adds its figures to one report; indices are known to be in range and
 * coordinates to be finite when the last three run. */
#ifndef VG_CORE_QUALITY_PARTS_H
#define VG_CORE_QUALITY_PARTS_H

#include "core/quality.h"

/** A sum that keeps what rounding takes away (Neumaier's variant of Kahan's
 * summation): totals over 1e8 cells stay good to a few ulp. */
struct vg_sum {
  double total, lost;
};

static inline void vg_sum_add(struct vg_sum *s, double x)
{
  double t = s->total + x;
  double a = s->total < 0 ? -s->total : s->total, b = x < 0 ? -x : x;

  s->lost += a >= b ? (s->total - t) + x : (x - t) + s->total;
  s->total = t;
}

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

/** Signs and sums of volumes, angles, ratios, worst cells.
 * volume out: [n_cell], signed. */
vg_status vg_judge_shape(const struct vg_mesh *m, float *volume,
                         struct vg_mesh_report *r, struct vg_error *err);

/** Conformity, components, orientation and volume ratios of neighbours. */
vg_status vg_judge_faces(const struct vg_mesh *m, const float *volume,
                         struct vg_mesh_report *r, struct vg_error *err);

/** Interior edges against the field. */
vg_status vg_judge_edges(const struct vg_mesh *m,
                         const struct vg_sizing *sizing,
                         struct vg_mesh_report *r, struct vg_error *err);

/** Volume between the origin `o` and a quadrilateral, the mean over its two
 * diagonals, so that a warped face shared by two cells cancels; six times. */
double vg_quad_cone(const double o[3], const double a[3], const double b[3],
                    const double c[3], const double d[3]);

/** Six times the volume between `o` and a triangle. */
double vg_tri_cone(const double o[3], const double a[3], const double b[3],
                   const double c[3]);

#endif
