/* io/cgns/cgns_conditions.h: conditions of patches as CGNS has them (SIDS,
 * BCType_t). Private to its module. */
#ifndef VG_IO_CGNS_CONDITIONS_H
#define VG_IO_CGNS_CONDITIONS_H

#include "core/mesh/mesh.h"

/** "BCWallViscous", ... of a patch; NULL: it has none, or one without
 * counterpart. */
const char *vg_cgns_condition(const struct vg_patch *p);

/** The condition of a BCType_t, as USM3D's code; what has no counterpart
 * changes nothing. */
void vg_cgns_take_condition(const char *type, struct vg_patch *p);

#endif
