/* layers/expand/expand.h: columns into points and cells. Private to the files
 * of join.h.
 *
 * Points go column by column, upwards, columns in the order in which faces
 * have them; cells go face by face, upwards. So one number per column names
 * all its points, the cells and new points of a run of faces are runs, and
 * any run can be expanded alone, at the cost of the columns it stands on. */
#ifndef VG_LAYERS_EXPAND_EXPAND_H
#define VG_LAYERS_EXPAND_EXPAND_H

#include "layers/columns/columns.h"

enum { VG_FLANK, VG_INNER }; /* points on a slide patch, others */
enum { VG_KIND_TET, VG_KIND_PYR, VG_KIND_PRI, VG_N_KIND };

/* Faces that are counted together. */
#define VG_FACE_BLOCK 64

struct vg_expand {
  const struct vg_columns *columns;
  int mixed, threads;
  size_t n_block; /* of faces */
  uint16_t *mark; /* [n_column] levels, flags */
  uint32_t *foot; /* [n_column] index of the point at level 0 */
  uint32_t *base; /* [n_column] of that at level 1; those above it
                     follow. VG_NO_INDEX: no levels */
  /* First index of what belongs to a block; behind the last is the end. */
  size_t *inner;           /* [n_block + 1] points inside that its faces are
                              the first to have */
  size_t *cell[VG_N_KIND]; /* [n_block + 1], layer cells being the first */
  size_t n_point[2], n_cell[VG_N_KIND];
};

/** What the columns have: marks, n_point. */
vg_status vg_expand_open(struct vg_expand *e, const struct vg_columns *columns,
                         int mixed, int threads, struct vg_error *err);

void vg_expand_close(struct vg_expand *e);

/** Numbers of all points and cells. VG_ERR_INPUT for a column of which no
 * face is.
 * @param root   indices of the points of the surface
 * @param first  where the points of each group begin */
vg_status vg_expand_number(struct vg_expand *e, const uint32_t *root,
                           const size_t first[2], struct vg_error *err);

/** Points of levels 1 .. n of column i into x: [n]. */
void vg_expand_column(const struct vg_expand *e, const struct vg_mesh *surface,
                      size_t i, double (*x)[3]);

/** Points of levels 1 and above of all columns, or of flanks only. */
void vg_expand_points(const struct vg_expand *e, const struct vg_mesh *surface,
                      int flanks_only, double (*point)[3]);

/** Where the next cell goes. */
struct vg_cell_sink {
  uint32_t (*tet)[4];
  uint32_t (*pyr)[5];
  uint32_t (*pri)[6];
};

/** All cells of a face, whose columns have the points foot at level 0 and
 * base, base + 1, ... above, be it in the mesh or in a slice of it. */
void vg_expand_face(const struct vg_expand *e, size_t face,
                    const uint32_t foot[3], const uint32_t base[3],
                    struct vg_cell_sink *sink);

/** The cell of a face that its top is a face of; 0: it has none.
 * @param node  out: [6] k: the point of column k below its top (its root, if
 *              it has no level), 3 + k: its top
 * Returns the number of its nodes: 4, 5, 6, in the order of their kind. */
int vg_expand_top(const struct vg_expand *e, size_t face, uint32_t node[6]);

/** Boundary faces on the flank of border r: tri, quad out. */
void vg_expand_count_flank(const struct vg_expand *e, size_t r, size_t *tri,
                           size_t *quad);

/** Write them, inward, upwards. */
void vg_expand_flank(const struct vg_expand *e, size_t r, uint32_t (*tri)[3],
                     uint32_t (*quad)[4]);

#define VG_MARK_FLANK 0x8000  /* has a border */
#define VG_MARK_SHARED 0x4000 /* its root has other columns */

static inline unsigned vg_mark_n(uint16_t mark)
{
  return mark & 0x0fff;
}

static inline int vg_mark_group(uint16_t mark)
{
  return mark & VG_MARK_FLANK ? VG_FLANK : VG_INNER;
}

#endif
