/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/cgns/cgns_conditions.h"

#include <string.h>

#include "io/vgrid/mapbc.h"

/* If several rows have the same word, the word is converted to the code of the
 * first. */
static const struct {
  int32_t code;
  const char *type;
} known[] = {
  { 4, "BCWallViscous" },
  { 41, "BCWallViscous" },
  { 44, "BCWallViscous" },
  { 4, "BCWallViscousHeatFlux" },
  { 4, "BCWallViscousIsothermal" },
  { 5, "BCWallInviscid" },
  { 55, "BCWallInviscid" },
  { 1, "BCSymmetryPlane" },
  { 3, "BCFarfield" },
  { 0, "BCInflowSupersonic" },
  { 2, "BCOutflowSupersonic" },
  { 1001, "BCTunnelInflow" },
  { 1002, "BCTunnelOutflow" },
  { 102, "BCInflowSubsonic" },
  { 103, "BCInflowSubsonic" },
  { 101, "BCOutflowSubsonic" },
  { 11002, "BCOutflowSubsonic" },
  { 11003, "BCOutflowSubsonic" },
};
#define N_KNOWN (sizeof known / sizeof *known)

const char *vg_cgns_condition(const struct vg_patch *p)
{
  int32_t code = p->bc;

  if (code == VG_BC_NONE) code = vg_bc_to_usm3d(p->bc_fun3d);
  for (size_t i = 0; i < N_KNOWN; i++)
    if (known[i].code == code) return known[i].type;
  return NULL;
}

void vg_cgns_take_condition(const char *type, struct vg_patch *p)
{
  for (size_t i = 0; i < N_KNOWN; i++)
    if (!strcmp(known[i].type, type)) {
      p->bc = p->family = known[i].code;
      return;
    }
}
