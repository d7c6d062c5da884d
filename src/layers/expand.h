/* layers/expand.h: columns into points and cells. Private to the files of
 * join.h.
 *
 * Order of everything: level by level, within one by rising column or face.
 * So a point's index is the number of those before it, and needs no table:
 * columns are counted by chunk and level, and two arrays, of the level that
 * cells stand on and of the next, follow the levels upwards. */
#ifndef VG_LAYERS_EXPAND_H
#define VG_LAYERS_EXPAND_H

#include "layers/columns.h"

enum { VG_FLANK, VG_INNER };               /* points on a slide patch, others */
enum { VG_KIND_TET, VG_KIND_PYR, VG_KIND_PRI, VG_N_KIND };

struct vg_expand {
  const struct vg_columns *columns;
  int mixed, threads;
  size_t n_level;          /* of the highest column */
  size_t n_chunk;          /* of columns */
  size_t n_block;          /* of faces */
  uint16_t *mark;          /* [n_column] levels, flags */
  /* First index by group or kind, then level, then chunk; the entry behind
   * the last of a group or kind is its end. */
  size_t *point[2];        /* [n_level * n_chunk + 1], of levels from 1 */
  size_t *cell[VG_N_KIND]; /* [n_level * n_block + 1] */
  size_t n_point[2], n_cell[VG_N_KIND];
};

/** What the columns have: marks and n_point, point[] counted from 0. */
vg_status vg_expand_open(struct vg_expand *e, const struct vg_columns *columns,
                         int mixed, int threads, struct vg_error *err);

void vg_expand_close(struct vg_expand *e);

/** Let the points of a group begin at index `first`. */
void vg_expand_place(struct vg_expand *e, int group, size_t first);

/** Points of levels 1 and above into point; top out: [n_column] index of the
 * highest, which is root[column.root] without levels. */
void vg_expand_points(const struct vg_expand *e, const struct vg_mesh *surface,
                      const uint32_t *root, double (*point)[3], uint32_t *top);

/** n_cell and cell[], layer cells being the first of their kind.
 * @param root  indices of the points of the surface */
vg_status vg_expand_count(struct vg_expand *e, const uint32_t *root,
                          struct vg_error *err);

/** Boundary faces on the flank of rim r: tri, quad out. */
void vg_expand_flank(const struct vg_expand *e, size_t r, size_t *tri,
                     size_t *quad);

/** Write all cells and flanks into m.
 * @param tri_at, quad_at  in/out: [n_rim] where the faces of a rim begin; ends
 *                         up behind them */
vg_status vg_expand_cells(const struct vg_expand *e, const uint32_t *root,
                          struct vg_mesh *m, size_t *tri_at, size_t *quad_at,
                          struct vg_error *err);

/** Indices of the points of level l >= 1 into id: [n_column], VG_NO_INDEX for
 * columns that end below. */
void vg_expand_level(const struct vg_expand *e, size_t l, uint32_t *id);

#define VG_MARK_FLANK 0x8000   /* has a rim */
#define VG_MARK_SHARED 0x4000  /* its root has other columns */

static inline unsigned vg_mark_n(uint16_t mark) { return mark & 0x0fff; }

#define VG_COLUMN_CHUNK 2048
#define VG_FACE_BLOCK 2048

#endif
