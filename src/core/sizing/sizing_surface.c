/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_surface.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing_bvh.h"

#define GRAIN 4096 /* points or faces per thread and step */

/* Ratio of the longest edge to the spacing above which the centroid of a face
 * is not a sample. */
#define STRETCHED 3.0 /* H4 */

/* 4 / sqrt(3): squared edge of the equilateral triangle of area 1. */
#define EQUILATERAL 2.3094010767585034

/* Sums at a point. Each face adds its two edges at the point. */
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
                   "repair the surface",
                   i + 1, p[0], p[1], p[2]);
  }
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (m->tri[i][k] >= m->n_point)
        return vg_fail(err, VG_ERR_INPUT,
                       "surface triangle %zu uses point %zu, but there are "
                       "%zu points; repair the surface",
                       i + 1, (size_t)m->tri[i][k] + 1, m->n_point);
  for (size_t i = 0; i < m->n_quad; i++)
    for (int k = 0; k < 4; k++)
      if (m->quad[i][k] >= m->n_point)
        return vg_fail(err, VG_ERR_INPUT,
                       "surface quadrilateral %zu uses point %zu, but there "
                       "are %zu points; repair the surface",
                       i + 1, (size_t)m->quad[i][k] + 1, m->n_point);
  return VG_OK;
}

static double area(const double a[3], const double b[3], const double c[3])
{
  double u[3], v[3], n[3];

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_cross(u, v, n);
  return 0.5 * vg_norm(n);
}

/* Edges of zero length belong to degenerate faces and are ignored. */
static void add_face(const struct vg_mesh *m, const uint32_t *v, int n,
                     struct sum *sum)
{
  double whole = area(m->point[v[0]], m->point[v[1]], m->point[v[2]]);

  if (n == 4) /* as two triangles; each point gets half of it */
    whole = 0.5 *
            (whole + area(m->point[v[0]], m->point[v[2]], m->point[v[3]]));
  for (int i = 0; i < n; i++) {
    struct sum *a = sum + v[i], *b = sum + v[(i + 1) % n];
    double edge = vg_distance(m->point[v[i]], m->point[v[(i + 1) % n]]);

    a->area += whole;
    a->n_face++;
    if (!(edge > 0)) continue;
    a->inverse += 1 / edge;
    b->inverse += 1 / edge;
    a->n_edge++;
    b->n_edge++;
  }
}

/* H9: smallest spacing at a point, relative to the edge of an equilateral
 * triangle with the mean area there. It prevents sliver triangles from
 * requesting their short edge. */
#define LEAST_SHARE 0.25

static double point_size(const struct sum *s)
{
  double h = s->n_edge / s->inverse;
  double least = LEAST_SHARE * sqrt(EQUILATERAL * s->area / s->n_face);

  return h > least ? h : least;
}

/* Corners of face i, triangles before quadrilaterals. Returns their number. */
static int corners(const struct vg_mesh *m, size_t i, const uint32_t **v)
{
  *v = i < m->n_tri ? m->tri[i] : m->quad[i - m->n_tri];
  return i < m->n_tri ? 3 : 4;
}

static void set_centroid(const struct vg_mesh *m, size_t face,
                         const struct vg_samples *s)
{
  double *p = s->p[m->n_point + face], h = 0, longest = 0;
  const uint32_t *v;
  int n = corners(m, face, &v);

  for (int k = 0; k < 3; k++) p[k] = 0;
  s->h[m->n_point + face] = 0;
  for (int i = 0; i < n; i++) {
    const double *a = m->point[v[i]];
    double edge = vg_distance(a, m->point[v[(i + 1) % n]]);

    if (!(s->h[v[i]] > 0)) return;
    h += s->h[v[i]] / n;
    if (edge > longest) longest = edge;
    for (int k = 0; k < 3; k++) p[k] += a[k] / n;
  }
  if (longest > STRETCHED * h) return;
  s->h[m->n_point + face] = h;
}

struct making {
  const struct vg_mesh *m;
  const struct sum *sum;
  const struct vg_samples *s;
};

static void point_body(void *context, size_t first, size_t end, int worker)
{
  const struct making *a = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    memcpy(a->s->p[i], a->m->point[i], sizeof *a->s->p);
    a->s->h[i] = a->sum[i].n_edge ? point_size(a->sum + i) : 0;
  }
}

static void centroid_body(void *context, size_t first, size_t end, int worker)
{
  const struct making *a = context;

  (void)worker;
  for (size_t i = first; i < end; i++) set_centroid(a->m, i, a->s);
}

vg_status vg_samples_make(const struct vg_mesh *m, int threads,
                          struct vg_samples *out, struct vg_error *err)
{
  size_t n = m->n_point + m->n_tri + m->n_quad;
  struct sum *sum = vg_calloc(m->n_point, sizeof *sum);
  struct making a = { m, sum, out };

  *out = (struct vg_samples){ vg_alloc(n, sizeof *out->p),
                              vg_alloc(n, sizeof *out->h), n, 0 };
  if (!sum || !out->p || !out->h) {
    free(sum);
    vg_samples_release(out);
    return vg_fail_memory(err, "the spacings on the surface");
  }
  for (size_t i = 0; i < m->n_tri; i++) add_face(m, m->tri[i], 3, sum);
  for (size_t i = 0; i < m->n_quad; i++) add_face(m, m->quad[i], 4, sum);
  vg_parallel_for(threads, m->n_point, GRAIN, point_body, &a);
  vg_parallel_for(threads, m->n_tri + m->n_quad, GRAIN, centroid_body, &a);
  for (size_t i = 0; i < n; i++) out->n_sized += out->h[i] > 0;
  free(sum);
  return VG_OK;
}

/* Samples without influence. Let c be the value of a sample's cone at its tip,
 * (1 -+ offset) h. Sample i is above sample j everywhere if c_j + slope |p_i
 * p_j| <= c_i and h_j < h_i. The condition from below is analogous, with both
 * of its slopes. The relation is transitive, so the remaining samples give the
 * same field as all samples. MARGIN ensures this in single precision. */
#define MARGIN 1e-5

struct thinning {
  const struct vg_mesh *m;
  const struct vg_samples *s;
  _Atomic unsigned char *idle;
  double slope, keep; /* slope of the growth, and value at the tip relative
                         to h */
  double steep, rise; /* from below: the same beyond the knee; otherwise
                         equal to slope and keep */
};

static void compare(const struct thinning *t, size_t i, size_t j)
{
  double c, far, h[2] = { t->s->h[i], t->s->h[j] };
  size_t low = h[0] < h[1] ? i : j, high = low == i ? j : i;

  if (!(h[0] > 0 && h[1] > 0)) return;
  c = t->keep * fabs(h[0] - h[1]);
  c -= MARGIN * (h[0] + h[1]);
  far = vg_distance(t->s->p[i], t->s->p[j]);
  if (!(c > 0) || c < t->slope * far) return;
  c = t->rise * fabs(h[0] - h[1]) - MARGIN * (h[0] + h[1]);
  if (c < t->steep * far) return;
  atomic_store_explicit(t->idle + (t->keep < 1 ? high : low), 1,
                        memory_order_relaxed);
}

static void thin_body(void *context, size_t first, size_t end, int worker)
{
  const struct thinning *t = context;

  (void)worker;
  for (size_t f = first; f < end; f++) {
    const uint32_t *v;
    int n = corners(t->m, f, &v);

    for (int i = 0; i < n; i++) {
      compare(t, v[i], v[(i + 1) % n]);
      compare(t, v[i], t->m->n_point + f);
    }
  }
}

vg_status vg_samples_thin(const struct vg_mesh *m, const struct vg_samples *all,
                          double slope, int below, int threads,
                          struct vg_samples *out, struct vg_error *err)
{
  double offset = vg_bvh_offset(slope);
  struct thinning t = {
    m,     all,       vg_calloc(all->n, sizeof *t.idle), slope, 1 - offset,
    slope, 1 - offset
  };

  if (below) {
    t.keep = 1 + offset;
    t.steep = vg_bvh_steep(slope);
    t.rise = vg_bvh_rise(slope);
  }
  out->n = 0;
  out->p = vg_alloc(all->n_sized, sizeof *out->p);
  out->h = vg_alloc(all->n_sized, sizeof *out->h);
  if (!t.idle || !out->p || !out->h) {
    free(t.idle);
    vg_samples_release(out);
    return vg_fail_memory(err, "the spacings on the surface");
  }
  vg_parallel_for(threads, m->n_tri + m->n_quad, GRAIN, thin_body, &t);
  for (size_t i = 0; i < all->n; i++) {
    if (!(all->h[i] > 0) ||
        atomic_load_explicit(t.idle + i, memory_order_relaxed))
      continue;
    memcpy(out->p[out->n], all->p[i], sizeof *out->p);
    out->h[out->n++] = all->h[i];
  }
  out->n_sized = out->n;
  free(t.idle);
  return VG_OK;
}

void vg_samples_release(struct vg_samples *s)
{
  free(s->p);
  free(s->h);
  memset(s, 0, sizeof *s);
}
