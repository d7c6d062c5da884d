/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds a size for a wrap by trial. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/wrap/wrap_parts.h"

#define TRIANGLES 1e4 /* S71: of the first size tried */
#define COARSER 1.6   /* S71: from one size to the next */
#define COARSEST 0.25 /* S71: of the longest side: the body would be lost */
#define POINTS 15000  /* S71: three times those of TRIANGLES */
#define FAR 20.0      /* of the extent of all other points */
#define FAR_POINTS 3  /* four points may be a farfield */

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
  struct vg_wrap_options o = { .size = size, .most = POINTS };
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

/* The point with flag 1 that is farthest from the mean of those points. */
static uint32_t farthest(const struct vg_mesh *m, const uint8_t *flag)
{
  double mean[3] = { 0, 0, 0 }, most = -1, n = 0;
  uint32_t far = 0;

  for (size_t i = 0; i < m->n_point; n += flag[i++] == 1)
    for (int k = 0; k < 3 && flag[i] == 1; k++) mean[k] += m->point[i][k];
  for (int k = 0; k < 3; k++) mean[k] /= n;
  for (size_t i = 0; i < m->n_point; i++) {
    double d = flag[i] == 1 ? vg_distance(m->point[i], mean) : -1;

    if (!(d > most)) continue;
    most = d;
    far = (uint32_t)i;
  }
  return far;
}

/* Is the point far from the box of the points with flag 1? */
static int is_far(const struct vg_mesh *m, const uint8_t *flag, uint32_t point)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY }, middle[3];
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (size_t i = 0; i < m->n_point; i++)
    for (int k = 0; k < 3 && flag[i] == 1; k++) {
      lo[k] = fmin(lo[k], m->point[i][k]);
      hi[k] = fmax(hi[k], m->point[i][k]);
    }
  for (int k = 0; k < 3; k++) middle[k] = (lo[k] + hi[k]) / 2;
  return vg_distance(m->point[point], middle) > FAR * vg_distance(lo, hi);
}

int vg_wrap_far_point(const struct vg_mesh *m, uint32_t *point, size_t *tri)
{
  uint8_t *flag = vg_calloc(m->n_point, 1); /* 1: used; 2: set aside */
  int found = 0;

  if (!flag) return -1;
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++) flag[m->tri[i][k]] = 1;
  for (int n = 0; n < FAR_POINTS && !found; n++) {
    *point = farthest(m, flag);
    flag[*point] = 2;
    found = is_far(m, flag, *point);
  }
  for (size_t i = m->n_tri; i-- > 0 && found;)
    for (int k = 0; k < 3; k++)
      if (m->tri[i][k] == *point) *tri = i;
  free(flag);
  return found;
}

vg_status vg_wrap_suggest(const struct vg_mesh *m, const struct vg_stop *stop,
                          double *size, enum vg_wrap_reason *reason,
                          struct vg_error *err)
{
  struct vg_wrap_options o = { .size = 1 };
  struct vg_wrap_forecast f;
  double longest, first, s;
  vg_status st;

  VG_TRY(vg_wrap_foresee(m, &o, &f, err));
  longest = vg_mesh_length(m);
  first = s = rounded(sqrt(f.area * VG_WRAP_CLOSED / TRIANGLES));
  for (; s < COARSEST * longest; s = rounded(COARSER * s)) {
    st = try_size(m, s, stop, err);
    if (st == VG_ERR_GEOMETRY || st == VG_ERR_INPUT) continue;
    VG_TRY(st);
    *size = s;
    *reason = s > first ? VG_WRAP_HOLES : VG_WRAP_FITS;
    goto done;
  }
  if (st == VG_ERR_INPUT) goto done;
  *size = 0;
  *reason = VG_WRAP_SHEETS;
  st = VG_OK;
done:
  return st;
}
