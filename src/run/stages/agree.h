/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/stages/agree.h: checks that the nodes, each of which computes surface,
 * layers and sizes itself, have obtained the same result, and that all ranks
 * have the same helper programs. Uses partition/store, layers, core. */
#ifndef VG_RUN_STAGES_AGREE_H
#define VG_RUN_STAGES_AGREE_H

#include "base/comm.h"
#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"
#include "layers/columns/layers.h"

/* Data that can differ; VG_AGREE_NOTHING is for the test below. */
enum vg_agree {
  VG_AGREE_SURFACE,
  VG_AGREE_LAYERS,
  VG_AGREE_SIZES,
  VG_AGREE_N,
  VG_AGREE_NOTHING = VG_AGREE_N
};

/** "surface", "layers", "sizes"; NULL for other values. Static string. */
const char *vg_agree_name(enum vg_agree what);

/** Compares the data of all ranks by digests. The first rank of a node
 * represents the others, which have copies. Collective; call it after the data
 * were shared.
 *
 * @param layers  NULL: no layers
 * @param change  data that the last node pretends to have changed, for tests
 *
 * VG_ERR_REMOTE on all ranks, naming the rank, its host and the data that
 * differ. Costs one pass over the data on several nodes, and nothing on one. */
vg_status vg_run_agree(struct vg_comm *c, const struct vg_mesh *surface,
                       const struct vg_layers *layers,
                       const struct vg_sizing *sizing, enum vg_agree change,
                       struct vg_error *err);

/** Searches the helper programs on every rank. Collective; call it before a
 * helper is needed. VG_ERR_IO: vanguard-tetgen is installed, but cannot be used
 * (runs that need vanguard-wrap stop by themselves); VG_ERR_REMOTE: ranks have
 * different helpers. Costs some milliseconds. */
vg_status vg_run_helpers(struct vg_comm *c, struct vg_error *err);

#endif
