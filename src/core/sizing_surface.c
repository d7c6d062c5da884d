#include "core/sizing_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Ratio of the longest edge to the size above which the centroid of a face
 * is no sample. */
#define STRETCHED 3.0

/* 4 / sqrt(3): squared edge of the equilateral triangle of area 1. */
#define EQUILATERAL 2.3094010767585034

/* What is summed at a point. Each face adds both of its edges there. */
struct sum {
  double inverse, area;
  uint32_t n_edge, n_face;
};

vg_status vg_samples_check(const struct vg_mesh *m, struct vg_error *err)
{
  for (size_t i = 0; i < m->n_point; i++) {
    const double *p = m->point[i];

    if (isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])) continue;
    return vg_fail(err, VG_ERR_INPUT,
                   "surface point %zu is at (%g, %g, %g): not finite; "
                   "repair the surface", i + 1, p[0], p[1], p[2]);
  }
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (m->tri[i][k] >= m->n_point)
        return vg_fail(err, VG_ERR_INPUT,
                       "surface triangle %zu uses point %zu of %zu; repair "
                       "the surface", i + 1, (size_t)m->tri[i][k] + 1,
                       m->n_point);
  for (size_t i = 0; i < m->n_quad; i++)
    for (int k = 0; k < 4; k++)
      if (m->quad[i][k] >= m->n_point)
        return vg_fail(err, VG_ERR_INPUT,
                       "surface quadrilateral %zu uses point %zu of %zu; "
                       "repair the surface", i + 1,
                       (size_t)m->quad[i][k] + 1, m->n_point);
  return VG_OK;
}

static double length(const double a[3], const double b[3])
{
  double d2 = 0;

  for (int k = 0; k < 3; k++) d2 += (b[k] - a[k]) * (b[k] - a[k]);
  return sqrt(d2);
}

static double area(const double a[3], const double b[3], const double c[3])
{
  double u[3], v[3], n2 = 0;

  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
  }
  for (int k = 0; k < 3; k++) {
    double n = u[(k + 1) % 3] * v[(k + 2) % 3] -
               u[(k + 2) % 3] * v[(k + 1) % 3];

    n2 += n * n;
  }
  return 0.5 * sqrt(n2);
}

/* Edges of no length belong to degenerate faces and say nothing. */
static void add_face(const struct vg_mesh *m, const uint32_t *v, int n,
                     struct sum *sum)
{
  double whole = area(m->point[v[0]], m->point[v[1]], m->point[v[2]]);

  if (n == 4) /* as two triangles; each point then sees half of it */
    whole = 0.5 * (whole +
                   area(m->point[v[0]], m->point[v[2]], m->point[v[3]]));
  for (int i = 0; i < n; i++) {
    struct sum *a = sum + v[i], *b = sum + v[(i + 1) % n];
    double edge = length(m->point[v[i]], m->point[v[(i + 1) % n]]);

    a->area += whole;
    a->n_face++;
    if (!(edge > 0)) continue;
    a->inverse += 1 / edge;
    b->inverse += 1 / edge;
    a->n_edge++;
    b->n_edge++;
  }
}

static double point_size(const struct sum *s)
{
  double h = s->n_edge / s->inverse;
  double least = 0.25 * sqrt(EQUILATERAL * s->area / s->n_face);

  return h > least ? h : least;
}

static void add_centroid(const struct vg_mesh *m, const uint32_t *v, int n,
                         const struct sum *sum, struct vg_samples *out)
{
  double p[3] = { 0, 0, 0 }, h = 0, longest = 0;

  for (int i = 0; i < n; i++) {
    const double *a = m->point[v[i]];
    double edge = length(a, m->point[v[(i + 1) % n]]);

    if (!sum[v[i]].n_edge) return;
    h += point_size(sum + v[i]) / n;
    if (edge > longest) longest = edge;
    for (int k = 0; k < 3; k++) p[k] += a[k] / n;
  }
  if (longest > STRETCHED * h) return;
  memcpy(out->p[out->n], p, sizeof p);
  out->h[out->n++] = h;
}

vg_status vg_samples_make(const struct vg_mesh *m, struct vg_samples *out,
                          struct vg_error *err)
{
  size_t n = m->n_point + m->n_tri + m->n_quad;
  struct sum *sum = vg_calloc(m->n_point, sizeof *sum);

  out->n = 0;
  out->p = vg_alloc(n, sizeof *out->p);
  out->h = vg_alloc(n, sizeof *out->h);
  if (!sum || !out->p || !out->h) {
    free(sum);
    vg_samples_release(out);
    return vg_fail_memory(err, "the sizes on the surface");
  }
  for (size_t i = 0; i < m->n_tri; i++) add_face(m, m->tri[i], 3, sum);
  for (size_t i = 0; i < m->n_quad; i++) add_face(m, m->quad[i], 4, sum);
  for (size_t i = 0; i < m->n_point; i++) {
    if (!sum[i].n_edge) continue;
    memcpy(out->p[out->n], m->point[i], sizeof *out->p);
    out->h[out->n++] = point_size(sum + i);
  }
  for (size_t i = 0; i < m->n_tri; i++)
    add_centroid(m, m->tri[i], 3, sum, out);
  for (size_t i = 0; i < m->n_quad; i++)
    add_centroid(m, m->quad[i], 4, sum, out);
  free(sum);
  return VG_OK;
}

void vg_samples_release(struct vg_samples *s)
{
  free(s->p);
  free(s->h);
  memset(s, 0, sizeof *s);
}
