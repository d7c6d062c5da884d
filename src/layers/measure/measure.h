/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/measure/measure.h: properties of the layers, measured on their points
 * and not taken from the requested values. Uses core, layers.h. */
#ifndef VG_LAYERS_MEASURE_MEASURE_H
#define VG_LAYERS_MEASURE_MEASURE_H

#include "core/periodic/periodic.h"
#include "layers/columns/layers.h"

/** Whether a is the worse of two columns of a point or face, whose cause is
 * reported: the column with fewer levels than wanted if the other one is
 * complete, otherwise the column with fewer levels. */
int vg_column_is_worse(const struct vg_column *a, const struct vg_column *b);

/** In the same way for compression: the compressed column if the other one is
 * not, otherwise the more compressed one. */
int vg_column_is_tighter(const struct vg_column *a, const struct vg_column *b);

/** Fields at the points of walls, for pictures and reports. Arrays [n],
 * owned. */
struct vg_wall_fields {
  size_t n;
  uint32_t *point;         /* Points of the surface, sorted. */
  int32_t *level, *wanted; /* Least value over the columns of the point. */
  double *first, *asked;   /* Wall distance of the first point (from the
                              triangles at the root, by exact geometry) and
                              delta1 of the law, for the column with the
                              largest deviation; 0 if no column has a
                              level. */
  double *total;           /* Wall distance of the top, least over the
                              columns: from the triangles at the root, and
                              from their neighbours as long as these are
                              nearer. */
  double *share;           /* Height of the top relative to that of all levels
                              at the growth law, along the column; least over
                              the columns. 0 for a column without levels. */
  double *growth;          /* Largest ratio of neighbouring layers; 1 for a
                              single layer, 0 for none. */
  int32_t *cause, *compressed; /* Cause of the worst column, and cause of
                                compression of the most compressed column. */
};
#define VG_WALL_FIELDS_INIT                                                    \
  {                                                                            \
    .n = 0                                                                     \
  }

void vg_wall_fields_release(struct vg_wall_fields *w);

/** Computes the fields at all points with columns. Cost: about 2 us per column
 * of 40 levels. VG_ERR_INPUT for a column of more than VG_LEVELS_MAX levels.
 * @param periodic  [n_periodic] pairs of the surface, through which walls
 *                  continue; they match to rounding (VG_ERR_GEOMETRY) */
vg_status vg_layers_fields(const struct vg_mesh *surface,
                           const struct vg_columns *columns, size_t n_periodic,
                           const struct vg_periodic *periodic, int threads,
                           struct vg_wall_fields *out, struct vg_error *err);

struct vg_range {
  double min, mean, max;
};

/** One wall patch. Ranges are over its points with at least one level. Points
 * on the border of two patches belong to both. */
struct vg_patch_layers {
  uint32_t patch;
  size_t n_face, n_point;
  size_t n_bare;      /* Faces without layers because growth law and local size
                         request no level at a corner. */
  double full;        /* % of faces with layers, all of whose columns have the
                         levels that growth law and local size request. */
  double full_inside; /* The same, as % of the faces that neither a free edge of
                         an inner surface nor one without layers limits. */
  double uncompressed; /* % of faces that are full at the growth law. */
  double any;          /* % of faces with at least one level at all three
                          corners. */
  struct vg_range asked, first, level, total, growth;
  /* Height relative to that of the growth law, weighted by area, with the mean
   * of its corners for each face: mean; value that 5 % of the area is below, to
   * 0.001; % of the area with at least 0.9. */
  double share_mean, share_low, share_area;
  double first_error;     /* Largest |first - asked| / asked. */
  struct vg_range y_plus; /* Over faces with a level at all corners, from the
                             mean of the three first heights; 0 if no Reynolds
                             number is given. */
  /* Ratios of the volumes of the two cells at each of the n_top tops, larger
   * over smaller, from vg_layers_tops: median, value that 5 % exceed, largest;
   * and the centre of the face with the largest. */
  size_t n_top;
  double top_ratio[3], top_at[3];
  size_t cause[VG_CAUSE_N];      /* Number of faces by the cause of their worst
                                    column. */
  size_t compressed[VG_CAUSE_N]; /* Number of faces by the cause of their most
                                  compressed column. */
};

/** Statistics of all wall patches, sorted by patch, and of all patches together
 * in *all. out: owned by the caller (free). reynolds, length: see vg_y_plus;
 * 0: no y+. all may be NULL; its patch is VG_NO_INDEX, and points on borders
 * count once. */
vg_status vg_layers_patches(const struct vg_mesh *surface,
                            const struct vg_columns *columns,
                            const struct vg_wall_fields *fields,
                            double reynolds, double length, size_t *n,
                            struct vg_patch_layers **out,
                            struct vg_patch_layers *all, struct vg_error *err);

/** Volume ratios across the tops of the layers: n_top, top_ratio and top_at of
 * the patches. Faces of fans count only in *all.
 *
 * @param ratio  [columns->n_face] from vg_layer_slices_tops
 * @param wall   [n] from vg_layers_patches */
vg_status vg_layers_tops(const struct vg_mesh *surface,
                         const struct vg_columns *columns, const double *ratio,
                         size_t n, struct vg_patch_layers *wall,
                         struct vg_patch_layers *all, struct vg_error *err);

/** Defects of the cells of columns, as tetrahedra and as mixed cells.
 * n_negative, n_bad_corner, n_bad_pyramid, n_bad_wall_tet and n_off_plane are
 * zero if all cells are valid. Omitted cells (see columns.h) do not count.
 * Signs of volumes are exact. */
struct vg_layer_judgement {
  size_t n_cell, n_negative;         /* Tetrahedra by the lift rule; those
                                        without positive volume. */
  size_t n_prism, n_bad_corner;      /* Complete prisms; those with a corner
                                        tetrahedron without positive volume. */
  size_t n_pyramid, n_bad_pyramid;   /* Pyramids where two columns of a face
                                        have a further level; those with a base
                                        corner without positive volume. */
  size_t n_wall_tet, n_bad_wall_tet; /* Tetrahedra of mixed output at level 0
                                        where columns share a root; those
                                        without positive volume. */
  size_t n_step;        /* Edges whose columns differ by 2 or more levels. */
  size_t n_off_plane;   /* Columns with a point that is not bitwise in a
                           slide plane with an axis. */
  double top_angle_min; /* Smallest angle of a top in degrees; 180 if there
                              is no top. */
};

/** Checks all faces, including virtual ones. Cost: about 7 determinants per
 * prism. The result is independent of the number of threads. team: ranks that
 * share the work, or NULL. VG_ERR_INPUT for a column of more than
 * VG_LEVELS_MAX levels. */
vg_status vg_layers_judge(const struct vg_mesh *surface,
                          const struct vg_columns *columns, int threads,
                          struct vg_team *team, struct vg_layer_judgement *out,
                          struct vg_error *err);

#endif
