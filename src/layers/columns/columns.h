/* layers/columns/columns.h: layers as columns. Uses core/mesh/mesh.h,
 * layers/columns/growth_law.h.
 *
 * A column stands on a wall point and has levels 0 (the wall) to n. Cells are
 * implied: for every face (a triangle of three columns), for levels l = 0, 1,
 * ...: of its columns by rising number, each with l < n is raised, which
 * makes one tetrahedron (v at l, v at l + 1, the two others where they stand
 * now) of positive volume: the lift rule. What is left on top is the face
 * with each column at its own n: the top, one triangle per face, so tops are
 * as conforming as the wall is. Neighbours may differ by any number of levels;
 * what is bounded is the slope of the tops between them
 * (layers/grow/grow_parts.h).
 *
 * At a convex edge a point may have several columns, a fan. Between them lie
 * virtual faces: triangles of columns with two or three equal roots, of no
 * area at level 0. The lift rule holds for them; cells with a repeated point
 * (all columns of one root are one point at level 0) vanish, and the faces
 * of such a cell fall together in pairs, so conformity stays. */
#ifndef VG_LAYERS_COLUMNS_COLUMNS_H
#define VG_LAYERS_COLUMNS_COLUMNS_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"
#include "layers/columns/growth_law.h"

#define VG_NO_INDEX UINT32_MAX

/** Why a column has fewer or thinner layers than the law asks for. */
enum vg_layer_cause {
  VG_CAUSE_NONE,       /* all layers that were asked for */
  VG_CAUSE_SIZE,       /* ended as thick as the local cell: as intended */
  VG_CAUSE_PROXIMITY,  /* another surface stands in front of it */
  VG_CAUSE_CORNER,     /* columns converge in a concave corner */
  VG_CAUSE_VISIBILITY, /* no direction sees all faces at the point */
  VG_CAUSE_CELL,       /* a cell would be inverted or too flat */
  VG_CAUSE_COLLISION,  /* tops or flanks would cross */
  VG_CAUSE_SLIDE,      /* meets a slide patch at too flat an angle, or the
                          patch could not be re-meshed around it */
  VG_CAUSE_N
};

/** One word for reports: "none", "size", ... Static string. */
const char *vg_layer_cause_name(enum vg_layer_cause cause);

struct vg_column {
  uint32_t root;      /* point of the surface */
  uint32_t law;       /* index into vg_columns.law */
  uint32_t slide[2];  /* patches it slides in, VG_NO_INDEX: none; [0] first */
  double dir[3];      /* level l >= 1 stands at root + shift + dir *
                         height(l); length 1 to 2 */
  double shift[3];    /* what makes the first point delta1 away from the
                         wall, in corners where dir alone does not: so the
                         layers above may be straightened out and the first
                         height is kept. 0 for most */
  double cap;         /* growth of this column: the law's, or less where it
                         was compressed (vg_growth_law_heights) */
  size_t bent;        /* SIZE_MAX: straight. Else levels 0 .. n are
                         vg_columns.path[bent ..] (curved slide patches) */
  uint16_t n;         /* levels */
  uint16_t n_wanted;  /* by law and local size, before anything limited it */
  uint8_t cause;      /* enum vg_layer_cause: what set n below n_wanted */
  uint8_t compressed; /* enum vg_layer_cause: what set cap below the law's;
                       VG_CAUSE_NONE: nothing did */
  uint8_t unused[2];  /* 0: columns are sent, and compared, as bytes */
};
_Static_assert(sizeof(struct vg_column) == 88, "columns have no padding");

struct vg_columns {
  size_t n_column, n_face, n_border, n_law, n_path;
  struct vg_column *column; /* [n_column] by rising root; those of one root by
                               rising position around it */
  uint32_t (*face)[3];      /* [n_face] columns, counter-clockwise seen from
                               the fluid; first those of triangles (by rising
                               triangle while layers grow, then along a
                               Hilbert curve), then the virtual ones */
  uint32_t *face_tri;       /* [n_face] triangle of the surface; virtual:
                               VG_NO_INDEX */
  uint32_t (*border)[2];    /* [n_border] edges of one face, in its direction;
                                 both columns slide in ... */
  uint32_t *border_patch; /* [n_border] ... this patch. An edge between columns
                              of one root is a border too where a fan meets a
                              slide patch */
  struct vg_growth_law *law; /* [n_law] */
  double (*path)[3];         /* [n_path] */
};
#define VG_COLUMNS_INIT                                                        \
  {                                                                            \
    0                                                                          \
  }

void vg_columns_release(struct vg_columns *c);

/** Whether column i is one of a fan. */
static inline int vg_shares_root(const struct vg_columns *c, size_t i)
{
  assert(i < c->n_column);

  uint32_t root = c->column[i].root;

  return (i && c->column[i - 1].root == root) ||
         (i + 1 < c->n_column && c->column[i + 1].root == root);
}

/** Points of levels 0 .. column[i].n into x. Where dir and shift have a
 * component of 0, straight columns keep that of the root to the last bit.
 * d: scratch for vg_growth_law_heights, [VG_LEVELS_MAX + 1]. */
void vg_column_points(const struct vg_columns *c, const struct vg_mesh *m,
                      size_t i, double *d, double (*x)[3]);

/** The top point of column i alone. */
void vg_column_top(const struct vg_columns *c, const struct vg_mesh *m,
                   size_t i, double x[3]);

#endif
