/* layers/columns/share.h: layers that the ranks of a node have in common, and
 * a look at all of their bytes. Uses base/comm.h, layers/columns/layers.h. */
#ifndef VG_LAYERS_COLUMNS_SHARE_H
#define VG_LAYERS_COLUMNS_SHARE_H

#include "base/comm.h"
#include "layers/columns/layers.h"

/** The layers of the first rank of a node on all of its ranks, one copy of
 * them where the ranks can have memory in common (base/comm.h). From then on
 * they are only read. Collective over the node; nothing where a rank is alone
 * on it.
 *
 * @param layers  those that were grown, empty on other ranks; replaced by the
 *                common ones, vg_layers_release. Untouched on failure, which
 *                all ranks of the node have */
vg_status vg_layers_share(struct vg_comm *c, struct vg_layers *layers,
                          struct vg_error *err);

/** Show `look` the arrays of layers, one after the other, names of patches
 * aside: bytes that are the same where layers are. */
void vg_layers_show(const struct vg_layers *layers,
                    void (*look)(void *user, size_t n, const void *data),
                    void *user);

#endif
