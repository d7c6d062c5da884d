/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/expand.h: expands columns into points and cells. Private to the
 * files of join.h.
 *
 * Points are ordered by column and level, with the columns in the order in
 * which the faces first refer to them. Cells are ordered by face and level.
 * Therefore one number per column identifies all its points, consecutive faces
 * have consecutive cells and new points, and any run of faces can be expanded
 * alone, at the cost of the columns that it refers to. */
#ifndef VG_LAYERS_EXPAND_EXPAND_H
#define VG_LAYERS_EXPAND_EXPAND_H

#include "layers/columns/columns.h"
#include "layers/expand/join.h"

enum { VG_FLANK, VG_INNER }; /* Points on a slide patch, and all others. */
enum { VG_KIND_TET, VG_KIND_PYR, VG_KIND_PRI, VG_KIND_HEX, VG_N_KIND };

/* Number of faces that are counted together. */
#define VG_FACE_BLOCK 64

struct vg_expand {
  const struct vg_columns *columns;
  int mixed, threads;
  size_t n_block; /* Number of blocks of faces. */
  uint16_t *mark; /* [n_column] levels and flags. */
  uint32_t *foot; /* [n_column] index of the point at level 0. */
  uint32_t *base; /* [n_column] index of the point at level 1; those of higher
                     levels follow. VG_NO_INDEX: no levels. */
  /* First index of each block; the entry behind the last block is the end. */
  size_t *inner;           /* [n_block + 1] inner points that the faces of the
                              block are the first to use. */
  size_t *cell[VG_N_KIND]; /* [n_block + 1] cells; layer cells come first. */
  size_t n_point[2], n_cell[VG_N_KIND];
  /* Pairs of faces that make hexahedra (pairs.h); NULL: none. */
  size_t n_pair;
  double wall_quads; /* Share of the area of the walls in pairs. */
  uint32_t *partner; /* [columns->n_face] the other face; VG_NO_INDEX: none. */
  uint32_t *middle;  /* [columns->n_face] of the first face of a pair: index of
                        the point in its middle. */
};

/** Sets the marks of the columns and n_point, and finds the pairs. */
vg_status vg_expand_open(struct vg_expand *e, const struct vg_mesh *surface,
                         const struct vg_columns *columns,
                         enum vg_layer_cells cells, int threads,
                         struct vg_error *err);

void vg_expand_close(struct vg_expand *e);

/** Numbers all points and cells. VG_ERR_INPUT if a column with levels has no
 * face.
 * @param root   indices of the points of the surface
 * @param first  index of the first point of each group */
vg_status vg_expand_number(struct vg_expand *e, const uint32_t *root,
                           const size_t first[2], struct vg_error *err);

/** Writes the points of levels 1 .. n of column i to x: [n]. */
void vg_expand_column(const struct vg_expand *e, const struct vg_mesh *surface,
                      size_t i, double (*x)[3]);

/** Points of levels 1 and above of all columns, and the middles of pairs; or
 * only those of columns on side faces. */
void vg_expand_points(const struct vg_expand *e, const struct vg_mesh *surface,
                      int flanks_only, double (*point)[3]);

/** Where the next cell of each kind is written. */
struct vg_cell_sink {
  uint32_t (*tet)[4];
  uint32_t (*pyr)[5];
  uint32_t (*pri)[6];
  uint32_t (*hex)[8];
};

/** Columns whose points the cells of a face use. Returns their number: 3, those
 * of the face; 4 for the first face of a pair, which makes the cells of both;
 * or 0 for the second. */
int vg_expand_corners(const struct vg_expand *e, size_t face,
                      uint32_t column[4]);

/** Makes all cells of a face whose columns (vg_expand_corners) have the points
 * foot at level 0 and base, base + 1, ... above. The numbers may be those of
 * the mesh or of a slice. middle: point in the middle of a pair. */
void vg_expand_face(const struct vg_expand *e, size_t face,
                    const uint32_t foot[4], const uint32_t base[4],
                    uint32_t middle, struct vg_cell_sink *sink);

/** The cell whose face is the top of a face. Returns the number of its nodes
 * (4, 5 or 6, in the node order of its kind), or 0 if the face has no cell.
 * @param node  out: [6] k: point of column k below its top (its root, if it has
 *              no level), 3 + k: its top, 6: middle of the pair of the face */
int vg_expand_top(const struct vg_expand *e, size_t face, uint32_t node[6]);

/** Number of triangles and quadrilaterals on the side face at boundary edge
 * r. */
void vg_expand_count_flank(const struct vg_expand *e, size_t r, size_t *tri,
                           size_t *quad);

/** Writes them, oriented into the fluid, from the wall upwards. */
void vg_expand_flank(const struct vg_expand *e, size_t r, uint32_t (*tri)[3],
                     uint32_t (*quad)[4]);

#define VG_MARK_FLANK 0x8000 /* The column has a boundary edge. */
/* The column shares its root with other columns, and they are raised from the
 * wall one at a time. */
#define VG_MARK_SHARED 0x4000

static inline unsigned vg_mark_n(uint16_t mark)
{
  return mark & 0x0fff;
}

static inline int vg_mark_group(uint16_t mark)
{
  return mark & VG_MARK_FLANK ? VG_FLANK : VG_INNER;
}

#endif
