/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/quality_pairs_parts.h: matching of the faces of tetrahedra in the
 * order of the cells. Private to quality_pairs.c and quality_columns.c. */
#ifndef VG_CORE_JUDGE_QUALITY_PAIRS_PARTS_H
#define VG_CORE_JUDGE_QUALITY_PAIRS_PARTS_H

#include "core/judge/quality_solver.h"
#include "core/judge/waiting_faces.h"

/* One side of a column of cells: a strip of triangles between two of its three
 * lines of points. */
struct vg_strip {
  uint32_t cell, n; /* First cell of the column, number of cells in the strip's
                       column whose raised line is known. */
  uint32_t side;    /* The line that is not at the strip: 0, 1, 2. */
};

struct vg_pairing {
  const struct vg_mesh *m;
  const float *volume;
  struct vg_stats *f;
  struct vg_solver_sweep *solver; /* may be NULL */
  uint32_t *parent;               /* [n_cell] components */
  size_t n_cell;
  /* Owners of faces: 2 * (cell, or n_cell + boundary face) + side. */
  struct vg_waiting face;
  /* The first faces of strips, with numbers of strips as owners. */
  struct vg_waiting first;
  struct vg_strip *strip;
  size_t n_strip, cap_strip;
  int refused, is_odd; /* Memory was refused; two boundary faces matched. */
};

/** Compare two cells that share a face. */
static inline void vg_pairing_join(const struct vg_pairing *p, uint32_t a,
                                   uint32_t b)
{
  vg_stats_ratio(p->f, p->volume[a], p->volume[b]);
  if (p->solver) vg_solver_join(p->solver, a, b);
}

/** Match the face, or let it wait. */
void vg_pairing_add(struct vg_pairing *p, const struct vg_face *f);

/** Number of cells of the column that begins with this cell: each cell stands
 * on the previous one. At least 1. */
size_t vg_column_length(const struct vg_mesh *m, size_t cell);

/** Match the faces of a column of n > 1 cells, whose faces have not been added
 * before, with each other and with those of other columns. */
void vg_pairing_add_column(struct vg_pairing *p, size_t cell, size_t n);

/** Add the faces of the strips without a partner one by one. */
void vg_pairing_end_columns(struct vg_pairing *p);

/** Faces of a tetrahedron, each opposite the k-th lowest node. */
void vg_faces_of_tet(const uint32_t node[4], uint32_t cell,
                     struct vg_face f[4]);

#endif
