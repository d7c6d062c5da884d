/* run/settings/resolved.h: the settings of a run as they hold.
 *
 *   asked     the values of deck, options or calls; never written after parsing
 *   read      a copy, to which the files of the project add values (run/input)
 *   resolved  made once surface, domain and layers are decided: decisions
 *             stand in place of `auto`, of names and of missing conditions, so
 *             that a run with these settings makes the same mesh
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
  int grows;
};

/** What a run decided. Arrays are borrowed. */
struct vg_decisions {
  int is_remeshed, is_swapped; /* the surface */
  int flow;                    /* enum vg_flow_kind; VG_FLOW_UNKNOWN: flow,
                                  half and farfield stay */
  int axis;                    /* across the symmetry plane; -1: none */
  size_t n_patch;              /* patches of the surface as it was given */
  const struct vg_patch_row *patch;
  int has_layers; /* 1: layers grow, on walls of `grows` */
  size_t n_grows; /* in the order of the table to be */
  const struct vg_patch_grows *grows;
};

/** The settings that were read, as they hold after these decisions. *out is
 * empty and untouched on failure; vg_resolved_release. VG_ERR_MEMORY. */
vg_status vg_resolve(const struct vg_settings *read,
                     const struct vg_decisions *decided,
                     struct vg_resolved *out, struct vg_error *err);

/** The same where nothing was decided. */
vg_status vg_resolve_nothing(const struct vg_settings *read,
                             struct vg_resolved *out, struct vg_error *err);

void vg_resolved_release(struct vg_resolved *r);

/** Set flow, half and farfield as decided; arguments as in struct
 * vg_decisions. */
void vg_resolve_flow(struct vg_settings *s, int flow, int axis);

/** The files to write; the kind of cells decides what `auto` stands for. */
void vg_resolve_write(const struct vg_settings *s, char write[VG_WRITE_MAX]);

/* --- layers -------------------------------------------------------------- */

#define VG_LAYER_CAP 1.3 /* where no cap is given */

/** The row of a patch in the table `layers`, or one that leaves all to the
 * settings. */
struct vg_layer_row vg_settings_layer_row(const struct vg_settings *s,
                                          int32_t id);

/** first, or else the height that follows from y_plus; 0 where neither is
 * known. */
double vg_settings_first(const struct vg_layer_settings *l, double first,
                         double y_plus);

#endif
