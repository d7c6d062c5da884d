/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cgns/cgns_conditions.h: boundary conditions of CGNS (SIDS, BCType_t).
 * Private to its module. */
#ifndef VG_IO_CGNS_CONDITIONS_H
#define VG_IO_CGNS_CONDITIONS_H

#include "core/mesh/mesh.h"

/** Descriptor_t of a Family_t with the number of its patch, as text. */
#define VG_CGNS_NUMBER "PatchNumber"
#define VG_CGNS_KIND "ZoneKind"

/** BCType_t of a patch ("BCWallViscous", ...); NULL if it has no condition, or
 * one without a counterpart. */
const char *vg_cgns_condition(const struct vg_patch *p);

/** Set the condition of a patch from a BCType_t, as USM3D's code. Types without
 * a counterpart do not change it. */
void vg_cgns_take_condition(const char *type, struct vg_patch *p);

#endif
