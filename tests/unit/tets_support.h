/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cells for the tests of the kernel, and their invariants. Header only: one
 * program per module. */
#ifndef TESTS_UNIT_TETS_SUPPORT_H
#define TESTS_UNIT_TETS_SUPPORT_H

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/delaunay/insert.h"
#include "core/delaunay/tets.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/predicates.h"

/* Uniform in [0, 1), the same on every machine. */
static inline double tets_random(uint64_t *seed)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1p-53;
}

/* The eight corners of the cube from lo to hi, and five cells. */
static inline void tets_box(struct vg_tets *t, double lo, double hi)
{
  static const uint32_t cell[5][4] = { { 0, 1, 2, 4 },
                                       { 3, 2, 1, 7 },
                                       { 5, 4, 7, 1 },
                                       { 6, 7, 4, 2 },
                                       { 1, 2, 4, 7 } };
  double(*x)[3] = vg_alloc(8, sizeof *x);

  if (!x) abort();
  for (int p = 0; p < 8; p++)
    for (int k = 0; k < 3; k++) x[p][k] = p >> k & 1 ? hi : lo;
  if (vg_tets_from_cells(t, 8, x, 5, cell, NULL) != VG_OK) abort();
}

/* nx x ny x nz unit cubes of six cells each, which share a long diagonal: all
 * corners of a cube are on one sphere. */
static inline void tets_grid(struct vg_tets *t, const int n[3])
{
  static const int path[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 },
                                  { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
  int step[3] = { 1, n[0] + 1, (n[0] + 1) * (n[1] + 1) };
  size_t np = (size_t)(step[2] * (n[2] + 1));
  size_t nc = 6 * (size_t)(n[0] * n[1] * n[2]), at = 0;
  double(*x)[3] = vg_alloc(np, sizeof *x);
  uint32_t(*v)[4] = vg_alloc(nc, sizeof *v);

  if (!x || !v) abort();
  for (int p = 0; p < (int)np; p++) {
    x[p][0] = p % step[1];
    x[p][1] = p / step[1] % (n[1] + 1);
    x[p][2] = p / step[2];
  }
  for (int c = 0; c < n[0] * n[1] * n[2]; c++)
    for (int k = 0; k < 6; k++, at++) {
      int p = c % n[0] + c / n[0] % n[1] * step[1] + c / n[0] / n[1] * step[2];

      for (int i = 0; i < 4; i++) {
        v[at][i] = (uint32_t)p;
        if (i < 3) p += step[path[k][i]];
      }
    }
  if (vg_tets_from_cells(t, np, x, nc, (const uint32_t(*)[4])v, NULL) != VG_OK)
    abort();
  free(v);
}

/* Append x to the points of the inserter's cells and insert it. */
static inline vg_status tets_insert(struct vg_inserter *s, const double x[3],
                                    double clearance, double nearest)
{
  struct vg_tets *t = s->t;
  uint32_t start = 0, at;
  vg_status st;

  while (t->flag[start] & VG_DEAD) start++;
  at = vg_tets_locate(t, s->last == VG_NONE ? start : s->last, x);
  if (at == VG_NONE || vg_tets_reserve_points(t, 1)) abort();
  memcpy(t->x[t->n_point], x, sizeof *t->x);
  st = vg_insert(s, (uint32_t)t->n_point, at, clearance, nearest, NULL);
  if (st == VG_OK) t->n_point++;
  return st;
}

/* Volume of the live cells that are not outside. */
static inline double tets_volume(const struct vg_tets *t)
{
  double sum = 0;

  for (size_t c = 0; c < t->n_cell; c++) {
    const uint32_t *v = t->cell[c].v;

    if (t->flag[c] & (VG_DEAD | VG_OUTSIDE)) continue;
    sum += vg_orient3d(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]) / 6;
  }
  return sum;
}

static inline size_t tets_live(const struct vg_tets *t)
{
  size_t n = 0;

  for (size_t c = 0; c < t->n_cell; c++) n += !(t->flag[c] & VG_DEAD);
  return n;
}

/* Number of faces that are neither constrained nor Delaunay: an opposite vertex
 * is inside the sphere of the other cell. */
static inline size_t tets_not_delaunay(const struct vg_tets *t)
{
  size_t bad = 0;

  for (size_t c = 0; c < t->n_cell; c++) {
    const uint32_t *v = t->cell[c].v;

    if (t->flag[c] & VG_DEAD) continue;
    for (int i = 0; i < 4; i++) {
      uint32_t link = t->cell[c].link[i];

      if (link == VG_NONE || t->flag[c] >> i & 1) continue;
      bad += vg_insphere(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]],
                         t->x[t->cell[link >> 2].v[link & 3]]) > 0;
    }
  }
  return bad;
}

#endif
