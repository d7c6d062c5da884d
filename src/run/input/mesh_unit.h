/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/mesh_unit.h: the unit of the mesh, and lengths with a unit. Private
 * to run/input. */
#ifndef VG_RUN_INPUT_MESH_UNIT_H
#define VG_RUN_INPUT_MESH_UNIT_H

#include "run/input/input.h"

/** Converts the lengths of r->settings as far as the settings state the unit of
 * the mesh. Called before the surface is read. VG_ERR_INPUT if the unit of the
 * mesh is needed, and the file cannot state it. */
vg_status vg_units_begin(struct vg_read *r, struct vg_error *err);

/** Converts the coordinates of the surface if the settings request it, and the
 * remaining lengths. r->unit: in, the unit of a CAD file on the ranks that read
 * it; out, that of the mesh. Collective. VG_ERR_INPUT. */
vg_status vg_units_end(struct vg_read *r, struct vg_comm *comm,
                       struct vg_error *err);

/** A length of the surface file in the unit of the mesh. */
double vg_units_of_file(const struct vg_read *r, double x);

/** Of a .surf: reads first heights at its points into r->heights, and marks
 * transparent patches of r->surface as sheets. (heights.c) */
vg_status vg_read_surf_settings(struct vg_read *r, struct vg_error *err);

#endif
