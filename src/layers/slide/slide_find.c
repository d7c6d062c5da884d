/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds the patches that touch walls, and their normals. */
#include "layers/slide/slide.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

/* Largest distance of a point from the plane of a plane patch, relative to the
 * extent of the patch. */
#define FLATNESS 1e-6 /* L17 */

/* Properties of a patch after one pass over its triangles. */
struct shape {
  double area[3], lo[3], hi[3], first[3], inside[3], weight;
  size_t n_tri;
  int found; /* Shares an edge with a wall. */
};

static void area_vector(const struct vg_mesh *m, size_t t, double n[3])
{
  const double *o = m->point[m->tri[t][0]];
  double a[3], b[3];

  for (int k = 0; k < 3; k++) {
    a[k] = m->point[m->tri[t][1]][k] - o[k];
    b[k] = m->point[m->tri[t][2]][k] - o[k];
  }
  vg_cross(a, b, n);
}

/* Marks patches that share an edge with a wall. Edges of walls are stored by
 * their first point and looked up from the other side. */
static vg_status mark_touched(const struct vg_mesh *m, const uint8_t *is_wall,
                              struct shape *shape, struct vg_error *err)
{
  size_t *first = vg_calloc(m->n_point + 2, sizeof *first), n = 0;
  uint32_t *to = NULL;
  vg_status st = VG_OK;

  for (size_t t = 0; first && t < m->n_tri; t++)
    for (int k = 0; is_wall[m->tri_patch[t]] && k < 3; k++, n++)
      first[m->tri[t][k] + 2]++;
  to = vg_alloc(n, sizeof *to);
  if (!first || !to) {
    st = vg_fail_memory(err, "the edges of walls");
    goto done;
  }
  for (size_t p = 0; p < m->n_point; p++) first[p + 2] += first[p + 1];
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; is_wall[m->tri_patch[t]] && k < 3; k++)
      to[first[m->tri[t][k] + 1]++] = m->tri[t][(k + 1) % 3];
  for (size_t t = 0; t < m->n_tri; t++) {
    if (is_wall[m->tri_patch[t]]) continue;
    for (int k = 0; k < 3; k++) {
      const uint32_t b = m->tri[t][k], a = m->tri[t][(k + 1) % 3];

      for (size_t i = first[a]; i < first[a + 1]; i++)
        if (to[i] == b) shape[m->tri_patch[t]].found = 1;
    }
  }
done:
  free(first);
  free(to);
  return st;
}

static void measure(const struct vg_mesh *m, struct shape *shape)
{
  for (size_t i = 0; i < m->n_patch; i++)
    for (int k = 0; k < 3; k++) {
      shape[i].lo[k] = INFINITY;
      shape[i].hi[k] = -INFINITY;
    }
  for (size_t t = 0; t < m->n_tri; t++) {
    struct shape *s = &shape[m->tri_patch[t]];
    double n[3], w;

    if (!s->found) continue;
    area_vector(m, t, n);
    w = sqrt(vg_dot(n, n));
    if (!(s->weight > 0)) memcpy(s->first, n, sizeof n);
    s->weight += w;
    s->n_tri++;
    for (int k = 0; k < 3; k++) s->area[k] += n[k];
    for (int j = 0; j < 3; j++) {
      const double *x = m->point[m->tri[t][j]];

      for (int k = 0; k < 3; k++) {
        s->inside[k] += w * x[k] / 3;
        s->lo[k] = fmin(s->lo[k], x[k]);
        s->hi[k] = fmax(s->hi[k], x[k]);
      }
    }
  }
}

static double extent_of(const struct shape *s)
{
  double extent = 0;

  for (int k = 0; k < 3; k++) extent = fmax(extent, s->hi[k] - s->lo[k]);
  return extent;
}

/* Axis along which a patch is thinner than the tolerance, or -1. */
static int thin_axis(const struct shape *s)
{
  for (int k = 0; k < 3; k++)
    if (s->hi[k] - s->lo[k] <= FLATNESS * extent_of(s) &&
        fabs(s->area[k]) > 0.9 * s->weight)
      return k;
  return -1;
}

/* A patch that closes on itself has no mean normal, so any of its normals is
 * used. A plane that is normal to an axis except for noise gets the axis as its
 * normal, so that columns that slide in it do not drift along the axis. */
static void start(const struct shape *s, uint32_t patch, struct vg_slide *out)
{
  const int thin = thin_axis(s);
  double centre[3];

  memset(out, 0, sizeof *out);
  out->patch = patch;
  out->axis = -1;
  out->is_plane = s->weight > 0;
  memcpy(out->normal, s->area, sizeof out->normal);
  if (vg_dot(s->area, s->area) <= 1e-16 * s->weight * s->weight ||
      !(vg_unit(out->normal) > 0)) {
    memcpy(out->normal, s->first, sizeof out->normal);
    if (!(vg_unit(out->normal) > 0)) out->normal[2] = 1;
  }
  for (int k = 0; k < 3; k++) {
    centre[k] = s->weight > 0 ? s->inside[k] / s->weight : s->lo[k];
    if (thin >= 0) out->normal[k] = k != thin ? 0 : s->area[k] < 0 ? -1 : 1;
  }
  if (thin >= 0 && s->lo[thin] == s->hi[thin]) out->axis = thin;
  out->at = out->axis >= 0 ? out->normal[out->axis] * s->lo[out->axis]
                           : vg_dot(out->normal, centre);
}

static int compare_value(const void *a, const void *b)
{
  const double p = *(const double *)a, q = *(const double *)b;

  return (p > q) - (p < q);
}

/* A noisy plane normal to an axis is placed at the median coordinate of its
 * points. */
static vg_status settle_planes(const struct vg_mesh *m,
                               const struct shape *shape, size_t n,
                               struct vg_slide *slide, struct vg_error *err)
{
  for (size_t i = 0; i < n; i++) {
    const int k = thin_axis(&shape[slide[i].patch]);
    double *x;
    size_t n_x = 0;

    if (k < 0 || slide[i].axis >= 0) continue;
    x = vg_alloc(3 * shape[slide[i].patch].n_tri, sizeof *x);
    if (!x) return vg_fail_memory(err, "slide patches");
    for (size_t t = 0; t < m->n_tri; t++)
      for (int j = 0; m->tri_patch[t] == slide[i].patch && j < 3; j++)
        x[n_x++] = m->point[m->tri[t][j]][k];
    qsort(x, n_x, sizeof *x, compare_value);
    slide[i].at = slide[i].normal[k] * x[n_x / 2];
    free(x);
  }
  return VG_OK;
}

/* Clears is_plane where a point is too far from the plane or a triangle is
 * turned over. */
static void check_planes(const struct vg_mesh *m, const struct shape *shape,
                         const uint32_t *slide_of, struct vg_slide *slide)
{
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t i = slide_of[m->tri_patch[t]];
    const struct shape *e = &shape[m->tri_patch[t]];
    struct vg_slide *s;
    double extent, n[3];

    if (i == VG_NO_INDEX) continue;
    s = &slide[i];
    area_vector(m, t, n);
    if (vg_dot(n, s->normal) < 0) s->is_plane = 0;
    extent = extent_of(e);
    for (int k = 0; s->axis < 0 && k < 3; k++)
      if (fabs(vg_dot(m->point[m->tri[t][k]], s->normal) - s->at) >
          FLATNESS * extent)
        s->is_plane = 0;
  }
}

/* atan(t), 0 <= t, without libm, so that results do not depend on it. Three
 * half-angle steps leave less than 0.2, where seven terms are accurate to
 * 1e-12. */
static double arc_tangent(double t)
{
  double s, sum;

  if (t > 1) return 1.57079632679489661923 - arc_tangent(1 / t);
  for (int i = 0; i < 3; i++) t /= 1 + sqrt(1 + t * t);
  s = t * t;
  sum = 1 -
        s * (1. / 3 -
             s * (1. / 5 -
                  s * (1. / 7 - s * (1. / 9 - s * (1. / 11 - s * (1. / 13))))));
  return 8 * t * sum;
}

/* Adds the normal of triangle t times its angle at corner k. */
static void add_corner(const struct vg_mesh *m, size_t t, int k, double n[3])
{
  const double *o = m->point[m->tri[t][k]];
  double a[3], b[3], c[3], area, angle;

  for (int j = 0; j < 3; j++) {
    a[j] = m->point[m->tri[t][(k + 1) % 3]][j] - o[j];
    b[j] = m->point[m->tri[t][(k + 2) % 3]][j] - o[j];
  }
  vg_cross(a, b, c);
  area = sqrt(vg_dot(c, c));
  if (!(area > 0)) return;
  angle = 2 * arc_tangent(area /
                          (sqrt(vg_dot(a, a) * vg_dot(b, b)) + vg_dot(a, b)));
  for (int j = 0; j < 3; j++) n[j] += angle * c[j] / area;
}

static int compare(const void *a, const void *b)
{
  const uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;

  return (p > q) - (p < q);
}

static size_t find(const uint32_t *list, size_t n, uint32_t p)
{
  size_t lo = 0;

  while (n > 1) {
    const size_t half = n / 2;

    if (list[lo + half] <= p) lo += half;
    n -= half;
  }
  return n && list[lo] == p ? lo : SIZE_MAX;
}

static size_t unique(uint32_t *list, size_t n)
{
  size_t kept = 0;

  qsort(list, n, sizeof *list, compare);
  for (size_t i = 0; i < n; i++)
    if (!kept || list[kept - 1] != list[i]) list[kept++] = list[i];
  return kept;
}

/* Slide patches and the tables of the curved ones in one block. The lists hold
 * at most 3 n_tri points; the normals come first because they need the larger
 * alignment. */
static struct vg_slide *with_tables(const struct vg_mesh *m, size_t n,
                                    const struct vg_slide *slide,
                                    const struct shape *shape,
                                    const uint32_t *slide_of)
{
  size_t room = 0, at = 0;
  struct vg_slide *out;
  double(*normal)[3];
  uint32_t *list;

  for (size_t i = 0; i < n; i++)
    if (!slide[i].is_plane) room += 3 * shape[slide[i].patch].n_tri;
  out = vg_calloc(1, n * sizeof *out + room * (sizeof *normal + sizeof *list));
  if (!out) return NULL;
  memcpy(out, slide, n * sizeof *out);
  normal = (double(*)[3])(void *)(out + n);
  list = (uint32_t *)(void *)(normal + room);
  for (size_t i = 0; i < n; i++) {
    if (out[i].is_plane) continue;
    out[i].vertex = list + at;
    out[i].vertex_normal = (const double(*)[3])(normal + at);
    at += 3 * shape[out[i].patch].n_tri;
  }
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t i = slide_of[m->tri_patch[t]];

    if (i == VG_NO_INDEX || out[i].is_plane) continue;
    for (int k = 0; k < 3; k++)
      list[(size_t)(out[i].vertex - list) + out[i].n_vertex++] = m->tri[t][k];
  }
  for (size_t i = 0; i < n; i++)
    if (!out[i].is_plane)
      out[i].n_vertex = unique(list + (out[i].vertex - list), out[i].n_vertex);
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t i = slide_of[m->tri_patch[t]];

    if (i == VG_NO_INDEX || out[i].is_plane) continue;
    for (int k = 0; k < 3; k++)
      add_corner(m, t, k,
                 normal[(size_t)(out[i].vertex - list) +
                        find(out[i].vertex, out[i].n_vertex, m->tri[t][k])]);
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < out[i].n_vertex; j++) {
      double *v = normal[(size_t)(out[i].vertex - list) + j];

      if (!(vg_unit(v) > 0)) memcpy(v, out[i].normal, sizeof out[i].normal);
    }
  return out;
}

vg_status vg_slides_find(const struct vg_mesh *surface, const uint8_t *is_wall,
                         size_t *n, struct vg_slide **out, struct vg_error *err)
{
  assert((is_wall || !surface->n_patch) && n && out);

  struct shape *shape = vg_calloc(surface->n_patch, sizeof *shape);
  struct vg_slide *slide = vg_calloc(surface->n_patch, sizeof *slide);
  uint32_t *slide_of = vg_alloc(surface->n_patch, sizeof *slide_of);
  struct vg_slide *found = NULL;
  size_t n_found = 0;
  vg_status st = VG_OK;

  if (!shape || !slide || !slide_of) {
    st = vg_fail_memory(err, "slide patches");
    goto done;
  }
  VG_TRY(mark_touched(surface, is_wall, shape, err));
  measure(surface, shape);
  for (size_t i = 0; i < surface->n_patch; i++) {
    slide_of[i] = VG_NO_INDEX;
    if (!shape[i].found || surface->patch[i].inner != VG_INNER_NOT) continue;
    slide_of[i] = (uint32_t)n_found;
    start(&shape[i], (uint32_t)i, &slide[n_found++]);
  }
  VG_TRY(settle_planes(surface, shape, n_found, slide, err));
  check_planes(surface, shape, slide_of, slide);
  if (n_found) {
    found = with_tables(surface, n_found, slide, shape, slide_of);
    if (!found) {
      st = vg_fail_memory(err, "slide patches");
      goto done;
    }
  }
  *n = n_found;
  *out = found;
done:
  free(shape);
  free(slide);
  free(slide_of);
  return st;
}

void vg_slide_normal(const struct vg_slide *s, const struct vg_mesh *surface,
                     uint32_t p, double normal[3])
{
  double n[3] = { 0 };

  assert(p < surface->n_point && s->patch < surface->n_patch);
  memcpy(normal, s->normal, sizeof s->normal);
  if (s->is_plane) return;
  if (s->n_vertex) {
    const size_t i = find(s->vertex, s->n_vertex, p);

    if (i != SIZE_MAX) memcpy(normal, s->vertex_normal[i], sizeof n);
    return;
  }
  for (size_t t = 0; t < surface->n_tri; t++)
    for (int k = 0; surface->tri_patch[t] == s->patch && k < 3; k++)
      if (surface->tri[t][k] == p) add_corner(surface, t, k, n);
  if (vg_unit(n) > 0) memcpy(normal, n, sizeof n);
}
