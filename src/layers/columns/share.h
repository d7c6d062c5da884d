/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/columns/share.h: layers in memory shared by the ranks of a node, and
 * access to all their bytes. Uses base/comm.h, layers/columns/layers.h. */
#ifndef VG_LAYERS_COLUMNS_SHARE_H
#define VG_LAYERS_COLUMNS_SHARE_H

#include "base/comm.h"
#include "layers/columns/layers.h"

/** Shares the layers of the first rank of a node with all its ranks, as a
 * single copy where the ranks can share memory (base/comm.h). Afterwards, only
 * layers/relax changes them, on one rank of each node. Collective over the
 * node; does nothing if the rank is alone on its node.
 *
 * @param layers  the grown layers, empty on other ranks. Replaced by the shared
 *                layers, to be released by vg_layers_release; untouched on
 *                failure, which all ranks of the node report */
vg_status vg_layers_share(struct vg_comm *c, struct vg_layers *layers,
                          struct vg_error *err);

/** Calls `look` for each array of the layers in turn, without the patch names.
 * Equal layers yield equal bytes. */
void vg_layers_show(const struct vg_layers *layers,
                    void (*look)(void *user, size_t n, const void *data),
                    void *user);

#endif
