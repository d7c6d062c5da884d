/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/resolved.h: the three stages of the settings of a run.
 *
 *   asked     the requested values of deck, options or calls; not changed
 *             after parsing
 *   read      a copy with the values that the files of the project add
 *             (run/input)
 *   resolved  made once surface, domain and layers are decided: the decisions
 *             replace `auto`, names and missing conditions, so that a run with
 *             these settings makes the same mesh
 *
 * Meshing, output files and reports use the resolved settings. */
#ifndef VG_RUN_SETTINGS_RESOLVED_H
#define VG_RUN_SETTINGS_RESOLVED_H

#include "run/settings/settings.h"

/** Resolved settings. Immutable once vg_resolve has made them. */
struct vg_resolved {
  struct vg_settings settings;
};
#define VG_RESOLVED_INIT                                                       \
  {                                                                            \
    VG_SETTINGS_INIT                                                           \
  }

/** Whether layers grow on a patch. */
struct vg_patch_grows {
  int32_t id;
  int32_t like; /* The patch whose row applies if id has none. */
  int grows;
  int
    is_extended; /* 1: it is no wall, but layers of a wall continue over it. */
};

/** Decisions of a run. Arrays are borrowed. */
struct vg_decisions {
  int is_remeshed, is_swapped; /* the surface */
  int flow;                    /* enum vg_flow_kind; VG_FLOW_UNKNOWN: flow,
                                  half and farfield are kept */
  int axis;                    /* normal to the symmetry plane; -1: none */
  size_t n_patch;              /* patches of the input surface */
  const struct vg_patch_row *patch;
  int has_layers; /* 1: layers grow, on the patches in `grows` */
  size_t n_grows; /* in the order of the resulting table */
  const struct vg_patch_grows *grows;
};

/** Resolve the settings `read` with these decisions. *out must be empty, is
 * unchanged on failure, and is freed by vg_resolved_release. VG_ERR_MEMORY. */
vg_status vg_resolve(const struct vg_settings *read,
                     const struct vg_decisions *decided,
                     struct vg_resolved *out, struct vg_error *err);

/** As vg_resolve, without any decisions. */
vg_status vg_resolve_nothing(const struct vg_settings *read,
                             struct vg_resolved *out, struct vg_error *err);

void vg_resolved_release(struct vg_resolved *r);

/** Set flow, half and farfield to the decisions; arguments as in struct
 * vg_decisions. */
void vg_resolve_flow(struct vg_settings *s, int flow, int axis);

/** Store the output formats in `write`; `auto` depends on the cell types. */
void vg_resolve_write(const struct vg_settings *s, char write[VG_WRITE_MAX]);

/* --- layers -------------------------------------------------------------- */

#define VG_LAYER_CAP 1.3 /* if no cap is given */

/** The row of a patch in the table `layers`, or a default row, which leaves
 * every value to the global settings. */
struct vg_layer_row vg_settings_layer_row(const struct vg_settings *s,
                                          int32_t id);

/** The row of patch id or, if it has none, that of patch `like` with its number
 * replaced. */
struct vg_layer_row vg_settings_layer_row_like(const struct vg_settings *s,
                                               int32_t id, int32_t like);

/** `first` if it is given, else the height that follows from y_plus; 0 if
 * neither is known. */
double vg_settings_first(const struct vg_layer_settings *l, double first,
                         double y_plus);

#endif
