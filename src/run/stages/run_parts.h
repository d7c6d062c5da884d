/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/stages/run_parts.h: steps of vg_run_mesh that meshes of surfaces and of
 * plane sections share. Private to run/stages. */
#ifndef VG_RUN_STAGES_RUN_PARTS_H
#define VG_RUN_STAGES_RUN_PARTS_H

#include "run/stages/run.h"

/** 1 on the first rank of a node, which makes sizing field and layers on the
 * cores of all ranks of its node. */
int vg_run_leads_node(const struct vg_run *r);

/** Number of threads for that; binds the rank to the cores of the node until
 * vg_comm_bind_node(r->comm, 0). */
int vg_run_node_threads(struct vg_run *r, const struct vg_settings *s);

/** Shares the data made by the first rank of the node, with status st, with its
 * other ranks. layers: NULL without layers. Collective. */
vg_status vg_run_share_with_node(struct vg_run *r, vg_status st,
                                 struct vg_layers *layers,
                                 struct vg_display *show,
                                 struct vg_sizing **sizing,
                                 struct vg_error *err);

/** Builds the sizing field over a boundary. */
vg_status vg_run_measure_sizes(struct vg_run *r, const struct vg_problem *p,
                               const struct vg_mesh *boundary,
                               double coarseness, int threads,
                               struct vg_team *team, struct vg_display *show,
                               struct vg_sizing **sizing, struct vg_error *err);

/** Checks the mesh r->slices and writes the files that are written slice by
 * slice. Edges are compared with the sizing field only outside the layers,
 * where sizes are isotropic. layers: NULL without layers. Collective.
 * VG_ERR_GEOMETRY: the mesh is invalid, and its files are removed. */
vg_status vg_run_judge(struct vg_run *r, const struct vg_problem *p,
                       const struct vg_layers *layers,
                       const struct vg_sizing *sizing, struct vg_display *show,
                       struct vg_error *err);

/** run/stages/run_section.c: sizing field, layers and mesh of a plane section.
 * Every rank makes the mesh, which is of the order of the surface; rank 0
 * serves it. Collective. */
vg_status vg_run_section(struct vg_run *r, const struct vg_problem *p,
                         struct vg_layer_stage *layers, struct vg_display *show,
                         struct vg_error *err);

#endif
