/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/fill/hgrid.h: search for the points around a position. A spatial hash
 * with the level of the local spacing in its key, so that a query accesses few
 * cells for any range of spacings. Uses base only.
 *
 * A query collects the points around a centre once, in single precision
 * relative to the centre. Any number of positions can then be tested against
 * that list. */
#ifndef VG_CORE_FILL_HGRID_H
#define VG_CORE_FILL_HGRID_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "base/table.h"

enum {
  VG_HGRID_MAX = 2048,
  VG_HGRID_CELLS = 4096,
  VG_HGRID_PAGE = 8,
  VG_HGRID_REACH = 4
};

struct vg_hgrid_page { /* some points of a cell, relative to its corner;
                          unused entries are 0 */
  uint32_t next, n;
  float x[3][VG_HGRID_PAGE];
};

struct vg_hgrid {
  double lo[3];           /* origin of the cells */
  double slope;           /* bound on the gradient of the spacing */
  int level_lo, level_hi; /* range of levels of the spacing */
  struct vg_table table;  /* blocks by level and position */
  size_t n_block, cap_block;
  struct vg_hgrid_block { /* 4 x 4 x 4 cells */
    uint64_t used;        /* bit i: cell i contains points */
    int64_t at[3];        /* position on its level, in units of 4 cells */
    int level;
    uint32_t page[64]; /* first page of each cell */
  } * block;
  size_t n_page, cap_page;
  struct vg_hgrid_page *page;
  size_t n_cell; /* cells found by the current query */
  struct vg_hgrid_cell {
    uint32_t page;
    float d[3];
  } cell[VG_HGRID_CELLS + 64];
  uint64_t pick[256]; /* the bits of the index, in ascending order, one in a
                         byte: lanes of a page to be listed */
  size_t n_cut;       /* number of queries whose list was truncated */
  size_t n;           /* the list: [3][n], relative to the centre */
  float x[3][VG_HGRID_MAX + VG_HGRID_PAGE];
};

/** Initialise *s, which must be zeroed. h_min, h_max: range of spacings.
 * Returns 0, or -1 if memory is refused. */
int vg_hgrid_init(struct vg_hgrid *s, const double lo[3], double h_min,
                  double h_max, double slope);

void vg_hgrid_release(struct vg_hgrid *s);

/** Add a point at x, where the spacing is h. Returns 0, or -1 if memory is
 * refused. */
int vg_hgrid_add(struct vg_hgrid *s, const double x[3], double h);

/** List the points within r of c, where the spacing is h, and r at most
 * VG_HGRID_REACH times that. The list is truncated
 * (n_cut) if there are more than VG_HGRID_MAX points, or more than
 * VG_HGRID_CELLS cells with points. */
void vg_hgrid_gather(struct vg_hgrid *s, const double c[3], double h, double r);

/** Add a point at c + d to the current list. */
static inline void vg_hgrid_note(struct vg_hgrid *s, const double d[3])
{
  assert(s->n <= VG_HGRID_MAX);
  if (s->n == VG_HGRID_MAX) return;
  for (int k = 0; k < 3; k++) s->x[k][s->n] = (float)d[k];
  s->n++;
}

/** Number of listed points that are nearer than r to c + d. */
int vg_hgrid_count(const struct vg_hgrid *s, const double d[3], double r);

#endif
