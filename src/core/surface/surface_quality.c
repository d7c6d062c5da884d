/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/surface/surface_quality.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "core/surface/surface_swap_parts.h"

#define BINS 600 /* of 0.1 degrees */

/* Radius ratio 2 r / R of a triangle: 16 A^2 over the product of its perimeter
 * and its three edges. */
static double ratio_of(const struct vg_tri_shape *s)
{
  double a = sqrt(s->longest2), b = sqrt(s->middle2), c = sqrt(s->shortest2);
  double product = (a + b + c) * a * b * c;

  return product > 0 ? 4 * s->area * s->area / product : 0;
}

/* Insert the triangle into the list of the worst, after those that are no
 * better. */
static void keep_worst(const struct vg_mesh *m, size_t face, double angle,
                       int is_cap, struct vg_surface_quality *q)
{
  const uint32_t *t = m->tri[face];
  struct vg_worst_face w = { face, angle, { 0, 0, 0 }, is_cap };
  size_t i = q->n_worst;

  if (i == VG_WORST_FACES) {
    if (!(angle < q->worst[i - 1].angle)) return;
    i--;
  } else q->n_worst++;
  for (; i && angle < q->worst[i - 1].angle; i--) q->worst[i] = q->worst[i - 1];
  for (int k = 0; k < 3; k++)
    w.at[k] = m->point[t[0]][k] / 3 + m->point[t[1]][k] / 3 +
              m->point[t[2]][k] / 3;
  q->worst[i] = w;
}

static double percentile(const size_t *bin, size_t n)
{
  size_t seen = 0;
  int i = 0;

  while (i < BINS - 1 && 100 * (seen + bin[i]) < n) seen += bin[i++];
  return 0.1 * i;
}

void vg_surface_quality(const struct vg_mesh *m, struct vg_surface_quality *q)
{
  static const double limit[4] = { 5, 10, 20, 30 };
  size_t bin[BINS] = { 0 }, below[4] = { 0 };

  assert(m && q);
  memset(q, 0, sizeof *q);
  q->angle_min = 60;
  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t *t = m->tri[i];
    struct vg_tri_shape s;
    double angle;

    vg_tri_shape_of(m->point[t[0]], m->point[t[1]], m->point[t[2]], &s);
    angle = asin(fmin(sqrt(s.sine2), 1)) * (180 / M_PI);
    if (!isfinite(s.area) || !isfinite(s.longest2) || !isfinite(angle))
      continue;
    q->n++;
    q->angle_min = fmin(q->angle_min, angle);
    q->ratio_mean += ratio_of(&s);
    q->edge_mean += (sqrt(s.longest2) + sqrt(s.middle2) + sqrt(s.shortest2)) /
                    3;
    bin[(int)fmin(10 * angle, BINS - 1)]++;
    for (int k = 0; k < 4; k++) below[k] += angle < limit[k];
    if (vg_tri_shape_sound(&s)) continue;
    q->n_cap += (size_t)vg_tri_shape_cap(&s);
    q->n_needle += (size_t)!vg_tri_shape_cap(&s);
    keep_worst(m, i, angle, vg_tri_shape_cap(&s), q);
  }
  q->angle_min *= q->n > 0;
  if (!q->n) return;
  q->angle_min_p1 = percentile(bin, q->n);
  q->ratio_mean /= (double)q->n;
  q->edge_mean /= (double)q->n;
  for (int k = 0; k < 4; k++)
    q->below[k] = 100 * (double)below[k] / (double)q->n;
}

void vg_surface_shapes(const struct vg_mesh *m, double *angle, double *ratio)
{
  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t *t = m->tri[i];
    struct vg_tri_shape s;

    vg_tri_shape_of(m->point[t[0]], m->point[t[1]], m->point[t[2]], &s);
    if (angle) angle[i] = asin(fmin(sqrt(s.sine2), 1)) * (180 / M_PI);
    if (ratio) ratio[i] = ratio_of(&s);
  }
}
