/* layers/measure/measure.h: what the layers are, measured on their points, not
 * taken from what was asked. Uses core, layers.h. */
#ifndef VG_LAYERS_MEASURE_MEASURE_H
#define VG_LAYERS_MEASURE_MEASURE_H

#include "layers/columns/layers.h"

/** Whether a is the worse of two columns of a point or face, the one whose
 * cause counts: short of the levels it wanted where the other is not, else of
 * fewer levels. */
int vg_column_is_worse(const struct vg_column *a, const struct vg_column *b);

/** As much for compressed: compressed where the other is not, else by more. */
int vg_column_is_tighter(const struct vg_column *a, const struct vg_column *b);

/** Per point of a wall, for pictures and reports. Arrays [n], owned. */
struct vg_wall_fields {
  size_t n;
  uint32_t *point;             /* point of the surface, rising */
  int32_t *level, *wanted;     /* least over its columns */
  double *first, *asked;       /* wall distance of the first point (to the
                                  triangles at the root, exact geometry), and
                                  the law's delta1, of the column that misses it
                                  most; 0 when no column has a level */
  double *total;               /* wall distance of the top, least over columns:
                                  to the triangles at the root and on from there
                                  as long as they come nearer */
  double *share;               /* height of the top over that of all levels at
                                  the law's growth, along the column; least over
                                  columns. 1 where the law asks for none */
  double *growth;              /* largest ratio of neighbouring layers; 1 for a
                                  single layer, 0 for none */
  int32_t *cause, *compressed; /* of the worst column, of the tightest */
};
#define VG_WALL_FIELDS_INIT                                                    \
  {                                                                            \
    .n = 0                                                                     \
  }

void vg_wall_fields_release(struct vg_wall_fields *w);

/** Fields over all points that have columns. Cost: about 2 us per column of
 * 40 levels. VG_ERR_INPUT for a column of more than VG_LEVELS_MAX levels. */
vg_status vg_layers_fields(const struct vg_mesh *surface,
                           const struct vg_columns *columns, int threads,
                           struct vg_wall_fields *out, struct vg_error *err);

struct vg_range {
  double min, mean, max;
};

/** One wall patch; ranges over its points with at least one level. Points on
 * the border of two patches belong to both. */
struct vg_patch_layers {
  uint32_t patch;
  size_t n_face, n_point;
  size_t n_bare;       /* faces for which law and local size ask for no
                          level, so that they have all of them */
  double full;         /* % of faces of which all columns have the levels
                          that law and local size ask for; it and all
                          other shares are 0 where no face has a level */
  double uncompressed; /* % of faces that are full at the law's growth */
  double any;          /* % of faces with at least one level at all three
                          corners */
  struct vg_range asked, first, level, total, growth;
  /* Height reached over the law's, by area, of a face the mean of its
   * corners: mean; what 5 % of the area stay below, to 0.001; % of the area
   * that has 0.9 of it or more. */
  double share_mean, share_low, share_area;
  double first_error;     /* largest |first - asked| / asked */
  struct vg_range y_plus; /* over faces with a level at all corners, mean of
                             the three first heights; 0 when no Reynolds
                             number is given */
  /* Volumes of the cells on both sides of the tops, larger over smaller, by
   * vg_layers_tops: n_top of them; median, what 5 % exceed, largest, and the
   * middle of the face of the largest. */
  size_t n_top;
  double top_ratio[3], top_at[3];
  size_t cause[VG_CAUSE_N];      /* faces, by the worst of their columns */
  size_t compressed[VG_CAUSE_N]; /* faces, by the tightest of them */
};

/** All wall patches by rising patch, and the sum over all in *all. out: owned
 * by the caller (free). reynolds, length: see vg_y_plus; 0: no y+.
 * all may be NULL. Its patch is VG_NO_INDEX, and border points count once. */
vg_status vg_layers_patches(const struct vg_mesh *surface,
                            const struct vg_columns *columns,
                            const struct vg_wall_fields *fields,
                            double reynolds, double length, size_t *n,
                            struct vg_patch_layers **out,
                            struct vg_patch_layers *all, struct vg_error *err);

/** How cells change in size across the tops: n_top, top_ratio and top_at of
 * patches; faces of fans count in *all only.
 *
 * @param ratio  [columns->n_face] of vg_layer_slices_tops
 * @param wall   [n] of vg_layers_patches */
vg_status vg_layers_tops(const struct vg_mesh *surface,
                         const struct vg_columns *columns, const double *ratio,
                         size_t n, struct vg_patch_layers *wall,
                         struct vg_patch_layers *all, struct vg_error *err);

/** What is wrong with the cells that columns imply, as tetrahedra and as mixed
 * cells: n_negative, n_bad_corner, n_bad_pyramid, n_bad_wall_tet and
 * n_off_plane are zero when all is valid. Cells that vanish (see columns.h) do
 * not count. Signs of volumes are exact. */
struct vg_layer_judgement {
  size_t n_cell, n_negative;         /* tetrahedra by the lift rule, those of no
                                        positive volume */
  size_t n_prism, n_bad_corner;      /* whole prisms, those with a corner of no
                                        positive volume */
  size_t n_pyramid, n_bad_pyramid;   /* where two columns of a face rise
                                       together; those with a base corner of no
                                       such volume */
  size_t n_wall_tet, n_bad_wall_tet; /* what mixed output makes at level 0
                                     where columns share a root; those of no
                                     such volume */
  size_t n_step;        /* edges whose levels differ by 2 or more */
  size_t n_off_plane;   /* columns whose points leave a slide plane
                           with an axis by one bit */
  double top_angle_min; /* smallest angle of a top, degrees; 180
                              when there is none */
};

/** Judge all faces, virtual ones included.
 * Cost: about 7 determinants per prism. Same result for any threads.
 * team: NULL, or those who judge together.
 * VG_ERR_INPUT for a column of more than VG_LEVELS_MAX levels. */
vg_status vg_layers_judge(const struct vg_mesh *surface,
                          const struct vg_columns *columns, int threads,
                          struct vg_team *team, struct vg_layer_judgement *out,
                          struct vg_error *err);

#endif
