/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/accuracy/accuracy_parts.h: declarations shared by the files of
 * accuracy.c. Private. */
#ifndef VG_CORE_ACCURACY_ACCURACY_PARTS_H
#define VG_CORE_ACCURACY_ACCURACY_PARTS_H

#include "core/accuracy/schemes.h"
#include "core/accuracy/walls.h"

#define VG_NO_PATCH UINT32_MAX

/** Largest y+ of the layers. */
#define VG_LAYERS_Y_PLUS 1000.0

/** Parts of the mesh that are disjoint; the other zones unite them. */
enum { VG_ZONES_APART = VG_ZONE_LAYERS };

/** Measurement on the control volumes of one kind. */
struct vg_measurement {
  const struct vg_mesh *m;
  const struct vg_cell_links *links;
  const struct vg_wall_search *walls;
  const uint8_t *is_wall; /* [n_patch] */
  struct vg_field_scale scale;
  int threads, only_walls; /* only_walls 1: the wall profile alone */
  struct vg_volumes volumes;
  struct vg_place *place;  /* [n] positions of the unknowns */
  struct vg_place *border; /* [n_border] if they are in the cells */
  uint8_t *zone;           /* [n] */
  uint32_t *patch;         /* [n] lowest wall patch at the volume */
  struct vg_values values; /* of the present function */
  double (*gradient)[3];   /* [n] by VG_SCHEME_WLSQ */
};

/** Find places and zones of the control volumes, which have been built. */
vg_status vg_measurement_open(struct vg_measurement *k, struct vg_error *err);
void vg_measurement_release(struct vg_measurement *k);

/** Measure all functions. */
vg_status vg_measure_fields(struct vg_measurement *k,
                            struct vg_accuracy_report *r, struct vg_error *err);

/** Give the unknowns the values of a function. */
void vg_measure_values(struct vg_measurement *k, enum vg_accuracy_field field);

/** Measure the walls, with the values of the wall profile. r->patch: prepared
 * for all walls. */
vg_status vg_measure_walls(struct vg_measurement *k,
                           struct vg_accuracy_report *r, struct vg_error *err);

/** Measure with given scales. without_reference. */
vg_status vg_accuracy_measure_with(const struct vg_mesh *m,
                                   const struct vg_accuracy_options *o,
                                   int only_walls, struct vg_accuracy_report *r,
                                   struct vg_error *err);

/** Measure the structured meshes that correspond to the report. */
vg_status vg_accuracy_compare(const struct vg_accuracy_options *o,
                              struct vg_accuracy_report *r,
                              struct vg_error *err);

#endif
