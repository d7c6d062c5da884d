/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/columns/columns.h: viscous layers stored as columns. Uses
 * core/mesh/mesh.h, layers/columns/growth_law.h.
 *
 * A column stands on a wall point and has levels 0 (the wall) to n. Its cells
 * are not stored: the lift rule derives them from the faces (triangles of three
 * columns). For levels l = 0, 1, ... the rule visits the three columns of a
 * face in order of increasing column number and raises each one with l < n.
 * Each raise makes one tetrahedron of positive volume from four points: the
 * column at l, the same column at l + 1, and the other two columns at their
 * current levels. Three raises make a prism:
 *
 *             c1         at l + 1:  a1 b1 c1        columns a < b < c
 *            /| \
 *          a1-+--b1      1. raise a:  a0 b0 c0 a1
 *          |  c0 |       2. raise b:  a1 b0 c0 b1
 *          | /  \|       3. raise c:  a1 b1 c0 c1
 *          a0---b0
 *
 *          a1            Where column c has ended, only a and b are raised:
 *          | \           two tetrahedra, which together are a pyramid on the
 *          |  b1         quadrilateral a0 b0 b1 a1 with its apex c0.
 *          |  | \        Where b and c have ended, one tetrahedron is left.
 *          a0-b0-c0
 *
 * When all columns of a face have reached their n, one triangle is left on top,
 * the top of the face. There is one top per wall face, so the tops form a
 * conforming triangulation. Neighbouring columns may differ by any number of
 * levels; only the slope of the tops between them is bounded
 * (layers/grow/grow_parts.h).
 *
 * At a convex edge a point may have several columns, a fan. Virtual faces lie
 * between them: triangles of columns of which two or three have the same root,
 * with zero area at level 0. The lift rule applies to virtual faces as well.
 * Cells with a repeated point are omitted (at level 0 all columns of one root
 * are the same point). The faces of such a cell coincide in pairs, so the mesh
 * remains conforming. */
#ifndef VG_LAYERS_COLUMNS_COLUMNS_H
#define VG_LAYERS_COLUMNS_COLUMNS_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"
#include "layers/columns/growth_law.h"

#define VG_NO_INDEX UINT32_MAX

/** Why a column has fewer or thinner layers than its growth law requests: a row
 * per cause. ROW(NAME, KEY, TEXT, RED, GREEN, BLUE): enum VG_CAUSE_NAME, name
 * in reports and files, explanation, colour in pictures. The first two are no
 * restrictions: all requested layers were grown, or they ended at the local
 * edge length, as intended. New causes are appended, since numbers are part of
 * files and of the library. */
#define VG_LAYER_CAUSES(ROW)                                                   \
  ROW(NONE, "none", "full layers", 176, 208, 190)                              \
  ROW(SIZE, "size", "ended at the local edge length, as intended", 176, 208,   \
      190)                                                                     \
  ROW(PROXIMITY, "proximity", "proximity to an opposite surface", 230, 159, 0) \
  ROW(CORNER, "corner", "columns converge in a concave corner", 160, 110, 190) \
  ROW(VISIBILITY, "visibility", "no direction sees all faces of the point",    \
      200, 40, 50)                                                             \
  ROW(CELL, "cell", "a cell would be inverted or flat", 130, 70, 40)           \
  ROW(COLLISION, "collision",                                                  \
      "tops or side faces of the layers would intersect", 0, 114, 178)         \
  ROW(SLIDE, "slide", "the wall meets a slide patch at too flat an angle",     \
      240, 100, 150)                                                           \
  ROW(NEIGHBOUR, "neighbour", "lower layers are requested next to it", 90,     \
      190, 210)                                                                \
  ROW(GRADATION, "gradation", "the local edge length is smaller next to it",   \
      150, 150, 60)                                                            \
  ROW(INNER, "inner", "free edge of an inner surface, or one without layers",  \
      120, 190, 80)

enum vg_layer_cause {
#define ROW(name, key, text, red, green, blue) VG_CAUSE_##name,
  VG_LAYER_CAUSES(ROW)
#undef ROW
    VG_CAUSE_N
};

/** Name of a cause in reports: "none", "size", ... Static string. */
const char *vg_layer_cause_name(enum vg_layer_cause cause);

struct vg_column {
  uint32_t root;     /* Wall point on which the column stands. */
  uint32_t law;      /* Index into vg_columns.law. */
  uint32_t slide[2]; /* Patches in which the column slides, the first one in
                        [0]; VG_NO_INDEX: none. */
  double dir[3];     /* Level l >= 1 is at root + shift + dir * height(l).
                        Length 1 to 2. */
  double shift[3];   /* Offset that places the first point delta1 away from the
                        wall in corners where dir alone cannot. The first height
                        is thus kept even if the levels above are straightened.
                        0 for most columns. */
  double cap;        /* Largest growth ratio of this column: that of its law, or
                        less where it was compressed (vg_growth_law_heights). */
  size_t bent;       /* SIZE_MAX: the column is straight. Otherwise levels 0 ..
                        n are at vg_columns.path[bent ..] (curved slide
                        patches). */
  uint16_t n;        /* Number of levels. */
  uint16_t n_wanted; /* Levels that the growth law and the local size request,
                        before any limit. */
  uint8_t cause;     /* enum vg_layer_cause: what reduced n below n_fit. */
  uint8_t compressed; /* enum vg_layer_cause: what reduced cap below that of the
                       law; VG_CAUSE_NONE if nothing did. */
  uint16_t n_fit;     /* Requested levels: n_wanted or, in a column whose height
                         is limited, but not by the request of another patch,
                         and into which these would fit, the smaller number
                         that layer_jump asks for. */
};
_Static_assert(sizeof(struct vg_column) == 88, "columns have no padding");

struct vg_columns {
  size_t n_column, n_face, n_border, n_law, n_path;
  struct vg_column *column; /* [n_column], sorted by root; the columns of one
                               root are sorted by position around it. */
  uint32_t (*face)[3];      /* [n_face] columns, counter-clockwise seen from the
                               fluid. The faces of wall triangles come first (in
                               triangle order while layers grow, then along a
                               Hilbert curve), followed by the virtual faces. */
  uint32_t *face_tri;       /* [n_face] triangle of the surface; VG_NO_INDEX for
                               a virtual face. */
  uint32_t (*border)[2];    /* [n_border] boundary edges, with the orientation
                               of their only face; both columns slide in
                               border_patch. */
  uint32_t *border_patch; /* [n_border] slide patch of each boundary edge. Where
                             a fan meets a slide patch, an edge between two
                             columns of one root is also a boundary edge. */
  struct vg_growth_law *law; /* [n_law] growth laws. */
  double (*path)[3];         /* [n_path] points of bent columns. */
  size_t n_twin;             /* n_column, or 0 without periodic patches. */
  uint8_t *is_twin; /* [n_twin] 1: the column slides in a periodic patch. */
};
#define VG_COLUMNS_INIT                                                        \
  {                                                                            \
    0                                                                          \
  }

void vg_columns_release(struct vg_columns *c);

/** Whether column i belongs to a fan. */
static inline int vg_shares_root(const struct vg_columns *c, size_t i)
{
  assert(i < c->n_column);

  uint32_t root = c->column[i].root;

  return (i && c->column[i - 1].root == root) ||
         (i + 1 < c->n_column && c->column[i + 1].root == root);
}

/** Writes to x the point of a straight column at height h, 0 or one of its
 * levels, above its root. Every place that computes a point of a column uses
 * this function, so that all agree to the last bit. */
void vg_column_at(const struct vg_column *c, const double root[3], double h,
                  double x[3]);

/** Writes the points of levels 0 .. column[i].n to x. In a straight column,
 * every coordinate in which both dir and shift are 0 equals that of the root
 * to the last bit. d: scratch for vg_growth_law_heights, [VG_LEVELS_MAX + 1].
 */
void vg_column_points(const struct vg_columns *c, const struct vg_mesh *m,
                      size_t i, double *d, double (*x)[3]);

/** Only the top point of column i. */
void vg_column_top(const struct vg_columns *c, const struct vg_mesh *m,
                   size_t i, double x[3]);

#endif
