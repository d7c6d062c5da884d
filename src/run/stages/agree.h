/* run/stages/agree.h: nodes that make surface, layers and sizes each for itself
 * must make the same. Uses partition/store, layers, core. */
#ifndef VG_RUN_STAGES_AGREE_H
#define VG_RUN_STAGES_AGREE_H

#include "base/comm.h"
#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"
#include "layers/columns/layers.h"

/* What can differ; VG_AGREE_NOTHING for the test below. */
enum vg_agree {
  VG_AGREE_SURFACE,
  VG_AGREE_LAYERS,
  VG_AGREE_SIZES,
  VG_AGREE_N,
  VG_AGREE_NOTHING = VG_AGREE_N
};

/** "surface", "layers", "sizes"; NULL beyond. Static. */
const char *vg_agree_name(enum vg_agree what);

/** Whether all ranks have the same, by digests; of the ranks of a node the
 * first speaks for all, who got copies. Collective, after these are shared.
 *
 * @param layers  NULL: none
 * @param change  what the last node takes for changed, to show what happens
 * VG_ERR_REMOTE on all ranks, with the rank, its host and what differs. Costs
 * one reading of it on several nodes, nothing on one. */
vg_status vg_run_agree(struct vg_comm *c, const struct vg_mesh *surface,
                       const struct vg_layers *layers,
                       const struct vg_sizing *sizing, enum vg_agree change,
                       struct vg_error *err);

#endif
