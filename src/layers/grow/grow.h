/* layers/grow/grow.h: viscous layers grow on the walls of a surface, before
 * anything else is meshed. Uses core, layers/columns/layers.h. */
#ifndef VG_LAYERS_GROW_GROW_H
#define VG_LAYERS_GROW_GROW_H

#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"
#include "layers/columns/layers.h"

/** Grow layers on the walls of a closed, checked surface (triangles only).
 *
 * @param sizing  over `surface`; sets where layers end and the size of new
 *                triangles on slide patches
 * @param out     untouched on failure
 * Columns never lose their first height: where height lacks, growth is lowered
 * first, then levels, and each column says why.
 * On return every cell that the columns imply is positive, every prism among
 * them has positive corners, and the front does not touch itself.
 * Same bytes for any number of threads.
 * VG_ERR_INPUT for settings that cannot be (names the patch), VG_ERR_STOPPED,
 * VG_ERR_GEOMETRY, VG_ERR_MEMORY. */
vg_status vg_layers_grow(const struct vg_mesh *surface,
                         const struct vg_sizing *sizing,
                         const struct vg_layer_options *options,
                         struct vg_layers *out, struct vg_layer_report *report,
                         struct vg_error *err);

#endif
