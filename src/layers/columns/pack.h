/* layers/columns/pack.h: layers as bytes, for other ranks on machines of the
 * same kind. Uses base/comm.h, layers/columns/layers.h. */
#ifndef VG_LAYERS_COLUMNS_PACK_H
#define VG_LAYERS_COLUMNS_PACK_H

#include "base/comm.h"
#include "layers/columns/layers.h"

/** All of columns and front.
 *
 * @param out  replaced on success, free(out->data); untouched on failure */
vg_status vg_layers_pack(const struct vg_layers *layers, struct vg_bytes *out,
                         struct vg_error *err);

/** The layers that were packed. VG_ERR_FORMAT for bytes that are no layers of
 * this surface: whatever they are, no index in what is returned is out of
 * range.
 *
 * @param surface  that on which they grew
 * @param out      empty before; owned by the caller, vg_layers_release */
vg_status vg_layers_unpack(const struct vg_bytes *bytes,
                           const struct vg_mesh *surface,
                           struct vg_layers *out, struct vg_error *err);

/** Show `look` the arrays of layers, one after the other, names of patches
 * aside: bytes that are the same where layers are. */
void vg_layers_show(const struct vg_layers *layers,
                    void (*look)(void *user, size_t n, const void *data),
                    void *user);

#endif
