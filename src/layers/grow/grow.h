/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/grow/grow.h: grows viscous layers on the walls of a surface before the
 * rest of the volume is meshed. Uses core, layers/columns/layers.h. */
#ifndef VG_LAYERS_GROW_GROW_H
#define VG_LAYERS_GROW_GROW_H

#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"
#include "layers/columns/layers.h"

/** Grows layers on the walls of a closed, checked surface (triangles only).
 *
 * @param sizing  over `surface`; determines where layers end and the size of
 *                new triangles in slide patches
 * @param out     untouched on failure
 *
 * Columns always keep their first height. Where there is too little room,
 * growth is reduced first and levels are dropped only then, and each column
 * records the cause. On success every cell of the columns has positive volume,
 * every prism has positive corner volumes, and the front does not touch itself.
 * The result is bitwise independent of the number of threads.
 *
 * Returns VG_ERR_INPUT for invalid settings (the message names the patch),
 * VG_ERR_STOPPED, VG_ERR_GEOMETRY or VG_ERR_MEMORY. */
vg_status vg_layers_grow(const struct vg_mesh *surface,
                         const struct vg_sizing *sizing,
                         const struct vg_layer_options *options,
                         struct vg_layers *out, struct vg_layer_report *report,
                         struct vg_error *err);

#endif
