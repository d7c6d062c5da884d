/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/quality_tets.h: shapes of many tetrahedra at once. Private to
 * core/judge. */
#ifndef VG_CORE_JUDGE_QUALITY_TETS_H
#define VG_CORE_JUDGE_QUALITY_TETS_H

#include "core/judge/quality_parts.h"

#define VG_TET_BATCH 128 /* multiple of VG_TET_LANES */
#define VG_TET_LANES 4

/* Each figure of a batch is an array, so that compilers vectorise the loops. */
typedef double vg_tet_figure[VG_TET_BATCH];
typedef int32_t vg_tet_bin[VG_TET_BATCH];

struct vg_tet_batch {
  size_t n;
  vg_tet_figure x[4][3]; /* corners */
  /* Results: */
  vg_tet_figure least, most; /* extreme dihedral angles, in degrees */
  vg_tet_figure volume;      /* signed; the sign is exact */
  vg_tet_figure radius_ratio, mean_ratio;
  vg_tet_figure edge;   /* root mean square edge */
  vg_tet_figure slant2; /* square of the smallest cosine of the angles between
                           the normal of a face and the direction from the
                           centre of the cell to that of the face */
  vg_tet_figure determinant; /* as in struct vg_solver_quality, if the cell has
                                four neighbours */
  vg_tet_figure doubt2;      /* for vg_tets_measure alone */
};

/** Bins of the figures of a batch in the histograms of struct vg_counts. */
struct vg_tet_bins {
  vg_tet_bin angle_min, angle_max, fine, radius_ratio;
  uint64_t below[5], above[3];
  double angle_least, angle_most, radius_ratio_least; /* extremes; 180, 0 and 1
                                                         if n is 0 */
};

/** Measure n <= VG_TET_BATCH tetrahedra of m from `first` on. All processors
 * give the same bits. */
void vg_tets_measure(const struct vg_mesh *m, size_t first, size_t n,
                     struct vg_tet_batch *b);

/** Count the batch. */
void vg_tets_count(const struct vg_tet_batch *b, struct vg_tet_bins *out);

#endif
