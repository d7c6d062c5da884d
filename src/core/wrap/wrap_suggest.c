/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds a size for a wrap by trial. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/geometry/vector.h"
#include "core/wrap/wrap_parts.h"

#define TRIANGLES 1e4 /* S71: of the first size tried */
#define COARSER 1.6   /* S71: from one size to the next */
#define COARSEST 0.25 /* S71: of the longest side: the body would be lost */

/* Round to two digits, as a user would type it. */
static double rounded(double size)
{
  char text[32];

  snprintf(text, sizeof text, "%.1e", size);
  return strtod(text, NULL);
}

static vg_status try_size(const struct vg_mesh *m, double size,
                          const struct vg_stop *stop, struct vg_error *err)
{
  struct vg_wrap_options o = { .size = size };
  struct vg_wrap_report r;
  struct vg_mesh copy = VG_MESH_INIT;
  vg_status st;

  if (stop) o.stop = *stop;
  VG_TRY(vg_mesh_copy(&copy, m, err));
  VG_TRY(vg_wrap(&copy, &o, &r, err));
done:
  vg_mesh_release(&copy);
  return st;
}

vg_status vg_wrap_suggest(const struct vg_mesh *m, const struct vg_stop *stop,
                          double *size, enum vg_wrap_reason *reason,
                          struct vg_error *err)
{
  struct vg_wrap_options o = { .size = 1 };
  struct vg_wrap_forecast f;
  double lo[3], hi[3], longest = 0, first, s;
  vg_status st;

  VG_TRY(vg_wrap_foresee(m, &o, &f, err));
  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++) longest = fmax(longest, hi[k] - lo[k]);
  first = s = rounded(sqrt(f.area * VG_WRAP_CLOSED / TRIANGLES));
  for (; s < COARSEST * longest; s = rounded(COARSER * s)) {
    st = try_size(m, s, stop, err);
    if (st == VG_ERR_GEOMETRY) continue;
    VG_TRY(st);
    *size = s;
    *reason = s > first ? VG_WRAP_HOLES : VG_WRAP_FITS;
    goto done;
  }
  *size = 0;
  *reason = VG_WRAP_SHEETS;
  st = VG_OK;
done:
  return st;
}
