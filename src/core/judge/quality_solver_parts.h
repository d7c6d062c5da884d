/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/quality_solver_parts.h: figures of one face. Private to
 * quality_solver.c and quality_solver_faces.c. */
#ifndef VG_CORE_JUDGE_QUALITY_SOLVER_PARTS_H
#define VG_CORE_JUDGE_QUALITY_SOLVER_PARTS_H

#include <math.h>

#include "core/judge/face_shape.h"
#include "core/judge/quality_solver.h"

struct vg_face_figures {
  double cosine, skewness, weight;
};

/* A cell at a face: its centre and 1, or the corner of a tetrahedron opposite
 * the face and 1/4, since the centre of the tetrahedron has a quarter of the
 * distance of this corner from the centre of the face. */
struct vg_face_end {
  double at[3], share;
};

/** Figures of a face; the area vector points from the first cell to the second
 * one. */
void vg_face_measure(const struct vg_face_end end[2], const double x[4][3],
                     int n, const struct vg_face_shape *shape,
                     struct vg_face_figures *out);

/** Skewness of a boundary face of a cell. */
double vg_face_border_skewness(const double cell[3], const double x[4][3],
                               int n, const struct vg_face_shape *shape);

/** Sums and extremes over a batch. */
struct vg_solver_sums {
  double cosine_least, skewness_most, weight_least, ratio_least;
  double cosine;                     /* sum of vg_fixed */
  uint64_t n_weight, n_volume_ratio; /* numbers below the limits */
};

/** Measure the triangles of the batch. All processors give the same bits. */
void vg_solver_measure_batch(struct vg_solver_batch *b,
                             struct vg_solver_sums *sums);

/** Bin of the angle with this cosine, of 5 degrees. */
int vg_angle_bin(double cosine);

/** A number between -1 and 1, rounded to an integer multiple of 1 / VG_FIXED,
 * in this unit: 2^22 of them can be added without rounding. */
static inline double vg_fixed(double x)
{
  const double shift = 6755399441055744.0; /* 1.5 * 2^52 */

  return (x * VG_FIXED + shift) - shift;
}

/** Smaller volume over the larger one. */
static inline double vg_volume_ratio(float v, float w)
{
  float low = v < w ? v : w, high = v < w ? w : v, ratio = low / high;

  return (double)ratio;
}

/** Square of a cosine, with its sign. */
static inline float vg_signed_square(double cosine)
{
  return (float)(cosine * fabs(cosine));
}

#endif
