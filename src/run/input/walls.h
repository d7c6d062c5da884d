/* run/input/walls.h: on which patches layers grow. Uses run/input/input.h. */
#ifndef VG_RUN_INPUT_WALLS_H
#define VG_RUN_INPUT_WALLS_H

#include <stdint.h>

#include "run/input/input.h"

/** Why a patch is a wall, for the report. */
enum vg_wall_reason {
  VG_WALL_NOT,
  VG_WALL_SETTING,   /* the layers table or the list of walls */
  VG_WALL_CLASS,     /* meshing class 2 of the .d3m */
  VG_WALL_CONDITION, /* a viscous condition */
  VG_WALL_BODY       /* no patch has a condition: bodies, and the sides of
                        ducts */
};

/** In words. Static string. */
const char *vg_wall_reason_name(enum vg_wall_reason reason);

/** 1 for a condition of a viscous wall, in either solver's codes, or the name
 * BCWallViscous. */
int vg_is_viscous(const struct vg_patch *p);

/** The walls of a boundary. The layers table decides, then the lists
 * `walls` and `slip`, then meshing class and condition; a body without any
 * condition is all wall when layers are asked for.
 *
 * @param reason  out: [b->surface.n_patch]
 * @param n_wall  out
 * VG_ERR_INPUT for a patch that is not there, for contradictions, and when
 * layers are asked for and there is no wall: the message lists the patches
 * and says what to do. */
vg_status vg_walls_find(const struct vg_boundary *b,
                        enum vg_wall_reason *reason, size_t *n_wall,
                        struct vg_error *err);

/** Swap and collapse edges of the closed surface as settings say; `auto` does
 * so where a wall has slivers, on which layers would invert, and without layers
 * where the surface has flat triangles. With a note, and b->is_swapped.
 * @param reason  [n_patch] of the walls; NULL: no layers grow */
vg_status vg_walls_swap(struct vg_boundary *b,
                        const enum vg_wall_reason *reason,
                        struct vg_error *err);

/** 1 when a row sets a limit. */
int vg_has_limits(const struct vg_layer_limits *l);

/** 1 when settings ask for layers, be it by a limit on them: then a missing
 * wall or height is an error, not a note. */
int vg_walls_asked(const struct vg_settings *s);

#endif
