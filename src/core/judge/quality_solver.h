/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/quality_solver.h: quality in the terms of solvers. Private to
 * core/judge.
 *
 * The definitions are those of struct vg_solver_quality. OpenFOAM's are found
 * in the source of its mesh checks (primitiveMeshTools, polyMeshCheck), that of
 * the orthogonal quality in the user's guide of Ansys Fluent ("Mesh Quality").
 *
 * A sweep belongs to one mesh or slice. The cells get their own figures first
 * (quality_shape.c). Then each face is measured as soon as it is matched, while
 * its cells are in the cache. A face is described by the lower one of its two
 * cells: its corners are taken in the order of this cell. The figures are
 * therefore the same, bit by bit, whether a face is matched within a slice or
 * between two of them. */
#ifndef VG_CORE_JUDGE_QUALITY_SOLVER_H
#define VG_CORE_JUDGE_QUALITY_SOLVER_H

#include "core/judge/quality_parts.h"

#define VG_SOLVER_BATCH 64 /* triangles that are measured at once */

/* Triangles between two cells: the lower cell and the other one; positions of
 * both cells and their shares, as in struct vg_face_end, and the corners. */
struct vg_solver_batch {
  size_t n;
  uint32_t cell[2][VG_SOLVER_BATCH];
  uint8_t face[2][VG_SOLVER_BATCH]; /* unless both are tetrahedra */
  double x[5][3][VG_SOLVER_BATCH], share[2][VG_SOLVER_BATCH];
  double cosine[VG_SOLVER_BATCH], skewness[VG_SOLVER_BATCH];
  double weight[VG_SOLVER_BATCH];
  float volume[2][VG_SOLVER_BATCH]; /* of both cells */
  float quality[VG_SOLVER_BATCH];   /* square of the cosine, with its sign */
  double ratio[VG_SOLVER_BATCH];    /* volume ratio */
  int32_t angle_bin[VG_SOLVER_BATCH], skewness_bin[VG_SOLVER_BATCH];
};

/* A cell that is not a tetrahedron. */
struct vg_cell_middle {
  double at[3]; /* centre */
  float volume;
};

struct vg_solver_sweep {
  const struct vg_mesh *m;
  size_t n_cell;
  uint64_t first[VG_CELL_KINDS]; /* number in the mesh of the first cell */
  struct vg_stats *f;
  const float *volume; /* [n_cell] of tetrahedra */
  /* Per cell: square of the smallest cosine so far, with its sign (NAN: counted
   * elsewhere); determinant if no face is on the boundary; bit j:
   * face j is on the boundary. */
  float *quality, *determinant;
  uint8_t *border;
  struct vg_cell_middle *middle; /* [n_cell - n_tet] */
  size_t room[4];                /* of these arrays */
  /* NULL, or per cell the smallest cosine of the non-orthogonality and the
   * largest skewness of its faces; borrowed. */
  float *oblique, *skewed;
  struct vg_solver_batch batch;
};

/** One side of a face between slices. */
struct vg_solver_side {
  double corner[4][3]; /* of the face, outward; then the fourth corner of a
                          tetrahedron */
  double centre[3];    /* of the cell */
  uint32_t cell[2];    /* number of the cell in the mesh: low and high word */
  float quality;       /* as in vg_solver_sweep, of the other faces */
  float volume;        /* volume of the cell */
  uint32_t n_open;     /* number of faces of the cell between slices */
  uint8_t is_triangle, is_tet, unused[2];
};

/** A cell of which several faces lie between slices, with its figure according
 * to one of them. */
struct vg_solver_cell {
  uint32_t cell[2];
  double centre[3];
  float quality;
};

/** Begin a sweep over m, which is borrowed, as is f. *s is zeroed, or has been
 * used for another sweep, whose memory it uses again. volume: as in
 * vg_judge_shape, borrowed. VG_ERR_MEMORY. */
vg_status vg_solver_begin(struct vg_solver_sweep *s, const struct vg_mesh *m,
                          const uint64_t first[VG_CELL_KINDS],
                          const float *volume, struct vg_stats *f,
                          struct vg_error *err);
void vg_solver_release(struct vg_solver_sweep *s);

/** Memory of the arrays of a sweep over m. */
size_t vg_solver_bytes(const struct vg_mesh *m);

/** Measure the cells that are not tetrahedra. */
void vg_solver_measure_mixed(struct vg_solver_sweep *s);

/** Measure the faces of the batch. */
void vg_solver_empty_batch(struct vg_solver_sweep *s);

/** Measure the common face of two cells, a < b, of which at least one is not a
 * tetrahedron. */
void vg_solver_join_mixed(struct vg_solver_sweep *s, uint32_t a, uint32_t b);

/** Measure the common face of two cells. */
static inline void vg_solver_join(struct vg_solver_sweep *s, uint32_t a,
                                  uint32_t b)
{
  uint32_t lo = a < b ? a : b, hi = a < b ? b : a;
  struct vg_solver_batch *to = &s->batch;

  if (hi >= s->m->n_tet) {
    vg_solver_join_mixed(s, lo, hi);
    return;
  }
  to->cell[0][to->n] = lo;
  to->cell[1][to->n] = hi;
  if (++to->n == VG_SOLVER_BATCH) vg_solver_empty_batch(s);
}

/** Measure a boundary face of a cell; node[3] is VG_NO_NODE for a triangle. */
void vg_solver_bound(struct vg_solver_sweep *s, uint32_t cell,
                     const uint32_t node[4]);

/** Count all cells, after all faces. Cells with n_open[i] > 0 faces in other
 * slices are left to vg_solver_meet, except for their determinant.
 *
 * @param n_open  [n_cell], or NULL */
void vg_solver_finish(struct vg_solver_sweep *s, const uint8_t *n_open);

/** Describe a face between slices, after the faces within the slice. */
void vg_solver_side(const struct vg_solver_sweep *s, uint32_t cell,
                    const uint32_t node[4], uint32_t n_open,
                    struct vg_solver_side *out);

/** Measure a face between slices. Cells without other such faces are counted,
 * the *n others are listed. */
void vg_solver_meet(struct vg_stats *f, const struct vg_solver_side *a,
                    const struct vg_solver_side *b,
                    struct vg_solver_cell rest[2], int *n);

/** Count the cell of which these are all records. */
void vg_solver_meet_cell(struct vg_stats *f, const struct vg_solver_cell *c,
                         size_t n);

#endif
