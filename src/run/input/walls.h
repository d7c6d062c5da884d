/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/walls.h: determines the patches on which layers grow. Uses
 * run/input/input.h. */
#ifndef VG_RUN_INPUT_WALLS_H
#define VG_RUN_INPUT_WALLS_H

#include <stdint.h>

#include "run/input/input.h"

/** Why a patch is a wall, for the report. */
enum vg_wall_reason {
  VG_WALL_NOT,
  VG_WALL_SETTING,   /* The layers table or the list of walls. */
  VG_WALL_CLASS,     /* Meshing class 2 of the .d3m. */
  VG_WALL_CONDITION, /* A viscous boundary condition. */
  VG_WALL_BODY,      /* No patch has a condition: bodies, and the sides of
                        ducts. */
  VG_WALL_EXTENDED   /* No wall, but layers of a wall in the same plane
                        continue over it. */
};

/** Name of the reason. Static string. */
const char *vg_wall_reason_name(enum vg_wall_reason reason);

/** 1 for a condition of a viscous wall, in the codes of either solver, or the
 * name BCWallViscous. */
int vg_is_viscous(const struct vg_patch *p);

/** Finds the walls of a boundary. The layers table decides first, then the
 * lists `walls` and `slip`, then meshing class and condition. If layers are
 * requested, a body without any condition is a wall as a whole. The back of an
 * inner surface is a wall if its front is, unless it is named itself.
 *
 * @param reason  out: [b->surface.n_patch]
 * @param n_wall  out
 *
 * VG_ERR_INPUT for a patch that does not exist, for contradictions, and if
 * layers are requested but there is no wall: the message lists the patches and
 * gives a remedy. */
vg_status vg_walls_find(const struct vg_boundary *b,
                        enum vg_wall_reason *reason, size_t *n_wall,
                        struct vg_error *err);

/** Row of the layers table for patch i of m. The back of an inner surface
 * without a row has that of its front, with its own number. */
struct vg_layer_row vg_wall_layer_row(const struct vg_settings *s,
                                      const struct vg_mesh *m, size_t i);

/** Finds patches without layers in the plane of a wall, over which the layers
 * of the wall continue (vg_slides_extend). Patches with `grow` no in the layers
 * table and patches that this program added stay without layers.
 *
 * @param reason  in, out: [b->surface.n_patch] VG_WALL_EXTENDED for these
 *                patches
 * @param from    out: [b->surface.n_patch] the wall, or VG_NO_INDEX
 */
vg_status vg_walls_extend(const struct vg_boundary *b,
                          enum vg_wall_reason *reason, uint32_t *from,
                          struct vg_error *err);

/** Swaps and collapses edges of the closed surface as the settings request.
 * `auto` does so if a wall has slivers, on which layers would invert, and
 * without layers if the surface has flat triangles. Adds a note and sets
 * b->is_swapped.
 * @param reason  [n_patch] of the walls; NULL: no layers grow */
vg_status vg_walls_swap(struct vg_boundary *b,
                        const enum vg_wall_reason *reason,
                        struct vg_error *err);

/** 1 if a row sets a limit. */
int vg_has_limits(const struct vg_layer_limits *l);

/** 1 if settings request layers, even if only by a limit on them: a missing
 * wall or height is then an error and not a note. */
int vg_walls_asked(const struct vg_settings *s);

#endif
