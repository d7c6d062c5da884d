/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/delaunay/cell_signs.h"

#include "core/geometry/predicates.h"

unsigned vg_cell_sides(const double (*x)[3], const uint32_t v[4],
                       const double at[3], unsigned in, unsigned out)
{
  unsigned signs = in * (VG_SIDE_IN | VG_SIDE_SEES);

  for (int i = 0; i < 4; i++) {
    const uint8_t *f = vg_face[i];
    double o;

    if ((in | out) >> i & 1) continue;
    o = vg_orient3d(x[v[f[0]]], x[v[f[1]]], x[v[f[2]]], at);
    if (o >= 0) signs |= VG_SIDE_SEES << i;
    if (o > 0) signs |= VG_SIDE_IN << i;
  }
  return signs;
}

unsigned vg_cell_signs_exact(const double (*x)[3], const uint32_t v[4],
                             const double at[3], unsigned in, unsigned out)
{
  if (!(vg_insphere_exact(x[v[0]], x[v[1]], x[v[2]], x[v[3]], at) > 0))
    return 0;
  return VG_IN_SPHERE | vg_cell_sides(x, v, at, in, out);
}
