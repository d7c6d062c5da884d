/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Closes the ends of a wrap at sharp edges of zero thickness, which are as wide
 * as twice its offset.
 *
 * A triangle whose corners have collinear targets is removed by merging the two
 * corners whose targets are nearest to each other. In each round no two of
 * these changes affect the same triangle. All changes are undone if triangles
 * intersect afterwards. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/surface/surface_check.h"
#include "core/wrap/wrap_parts.h"

#define FLAT 0.02 /* S42: height over longest edge of collinear targets */
#define TURN 0.3  /* cosine of the largest turn of other triangles */
#define ROUNDS 64

struct zip {
  struct vg_mesh *m;
  double (*near)[3];
  size_t *first; /* [n_point + 1] */
  uint32_t *at;  /* [3 n_tri] Triangles sorted by point. */
  uint8_t *busy; /* [n_point] 1: one of its triangles has changed. */
  uint8_t *gone; /* [n_tri] 1: removed. */
  size_t n;
};

static void normal(const struct zip *z, const uint32_t v[3], double n[3])
{
  double a[3], b[3];

  vg_sub(z->near[v[1]], z->near[v[0]], a);
  vg_sub(z->near[v[2]], z->near[v[0]], b);
  vg_cross(a, b, n);
}

static int is_flat(const struct zip *z, const uint32_t v[3])
{
  double n[3], longest2 = 0;

  normal(z, v, n);
  for (int k = 0; k < 3; k++)
    longest2 = fmax(longest2,
                    vg_distance2(z->near[v[k]], z->near[v[(k + 1) % 3]]));
  return vg_norm(n) <= FLAT * longest2;
}

/* Sort the remaining triangles by point. */
static void list_triangles(struct zip *z)
{
  const struct vg_mesh *m = z->m;

  memset(z->first, 0, (m->n_point + 1) * sizeof *z->first);
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    if (!z->gone[i / 3]) z->first[m->tri[i / 3][i % 3]]++;
  for (size_t p = 0; p < m->n_point; p++) z->first[p + 1] += z->first[p];
  for (size_t i = 3 * m->n_tri; i-- > 0;) /* ends become starts */
    if (!z->gone[i / 3])
      z->at[--z->first[m->tri[i / 3][i % 3]]] = (uint32_t)(i / 3);
}

static int has(const uint32_t v[3], uint32_t p)
{
  return v[0] == p || v[1] == p || v[2] == p;
}

/* Link condition: a and b share exactly two neighbours, those opposite their
 * edge. */
static int link_fits(const struct zip *z, uint32_t a, uint32_t b)
{
  size_t n = 0;

  for (size_t i = z->first[a]; i < z->first[a + 1]; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t q = z->m->tri[z->at[i]][k];
      int found = 0;

      if (q == a || q == b) continue;
      for (size_t j = z->first[b]; j < z->first[b + 1]; j++)
        found |= has(z->m->tri[z->at[j]], q);
      n += (size_t)found;
    }
  return n == 4; /* each is in two triangles of a */
}

/* Can a replace b in the remaining triangles of b: does none of them fold or
 * become flat that is not flat now, and has none changed in this round? */
static int ring_fits(const struct zip *z, uint32_t a, uint32_t b)
{
  for (size_t i = z->first[b]; i < z->first[b + 1]; i++) {
    const uint32_t *v = z->m->tri[z->at[i]];
    uint32_t w[3];
    double before[3], after[3];

    for (int k = 0; k < 3; k++) {
      if (z->busy[v[k]]) return 0;
      w[k] = v[k] == b ? a : v[k];
    }
    if (has(v, a) || is_flat(z, v)) continue;
    if (is_flat(z, w)) return 0;
    normal(z, v, before);
    normal(z, w, after);
    if (!(vg_dot(before, after) > TURN * vg_norm(before) * vg_norm(after)))
      return 0;
  }
  return 1;
}

static int merge_points(struct zip *z, uint32_t a, uint32_t b)
{
  if (z->busy[a] || z->busy[b] || !link_fits(z, a, b) || !ring_fits(z, a, b))
    return 0;
  for (int side = 0; side < 2; side++) {
    uint32_t p = side ? b : a;

    for (size_t i = z->first[p]; i < z->first[p + 1]; i++)
      for (int k = 0; k < 3; k++) z->busy[z->m->tri[z->at[i]][k]] = 1;
  }
  for (size_t i = z->first[b]; i < z->first[b + 1]; i++) {
    uint32_t *v = z->m->tri[z->at[i]];

    if (has(v, a)) z->gone[z->at[i]] = 1;
    for (int k = 0; k < 3; k++)
      if (v[k] == b) v[k] = a;
  }
  memcpy(z->m->point[a], z->near[a], sizeof *z->near);
  z->n++;
  return 1;
}

/* Remove triangle t by merging the ends of one of its sides, the shortest
 * first, in either direction. */
static int remove_triangle(struct zip *z, size_t t)
{
  uint32_t v[3];
  int order[3] = { 0, 1, 2 };
  double l[3];

  memcpy(v, z->m->tri[t], sizeof v);
  for (int k = 0; k < 3; k++)
    l[k] = vg_distance2(z->near[v[k]], z->near[v[(k + 1) % 3]]);
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2 - i; k++)
      if (l[order[k]] > l[order[k + 1]]) {
        int o = order[k];

        order[k] = order[k + 1];
        order[k + 1] = o;
      }
  for (int i = 0; i < 2; i++) {
    uint32_t a = v[order[i]], b = v[(order[i] + 1) % 3];

    if (merge_points(z, a, b) || merge_points(z, b, a)) return 1;
  }
  return 0;
}

/* Drop removed triangles and points without triangles. */
static void compact(struct zip *z)
{
  struct vg_mesh *m = z->m;
  uint32_t *number = z->at, n_point = 0;
  size_t n_tri = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    if (z->gone[t]) continue;
    memmove(m->tri[n_tri++], m->tri[t], sizeof *m->tri);
  }
  m->n_tri = n_tri; /* patches are not assigned yet */
  memset(z->busy, 0, m->n_point);
  for (size_t i = 0; i < 3 * n_tri; i++) z->busy[m->tri[i / 3][i % 3]] = 1;
  for (uint32_t p = 0; p < m->n_point; p++) {
    if (!z->busy[p]) continue;
    memmove(m->point[n_point], m->point[p], sizeof *m->point);
    memmove(z->near[n_point], z->near[p], sizeof *z->near);
    number[p] = n_point++;
  }
  m->n_point = n_point;
  for (size_t i = 0; i < 3 * n_tri; i++)
    m->tri[i / 3][i % 3] = number[m->tri[i / 3][i % 3]];
}

static vg_status is_sound(struct vg_mesh *m, const struct vg_stop *stop,
                          int *sound, struct vg_error *err)
{
  struct vg_surface_check_options o = { .external = 1, .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  vg_status st;

  if (stop) o.stop = *stop;
  st = vg_surface_check(m, &o, &r, err);
  *sound = !r.n_defect;
  vg_surface_report_release(&r);
  return st;
}

static vg_status zip_all(struct zip *z, const struct vg_stop *stop,
                         struct vg_error *err)
{
  size_t before = SIZE_MAX;

  for (int round = 0; z->n != before && round < ROUNDS; round++) {
    before = z->n;
    if (vg_stops(stop)) return vg_stopped(stop, err);
    list_triangles(z);
    memset(z->busy, 0, z->m->n_point);
    for (size_t t = 0; t < z->m->n_tri; t++)
      if (!z->gone[t] && is_flat(z, z->m->tri[t])) remove_triangle(z, t);
  }
  return VG_OK;
}

vg_status vg_wrap_zip(struct vg_mesh *m, double (*near)[3], double most,
                      const struct vg_stop *stop, size_t *n,
                      struct vg_error *err)
{
  assert((near || !m->n_point) && most >= 0 && n);

  const size_t n_point = m->n_point, n_tri = m->n_tri;
  struct zip z = { .m = m, .near = near };
  double(*point)[3] = vg_alloc(n_point, sizeof *point);
  double(*place)[3] = vg_alloc(n_point, sizeof *place);
  uint32_t(*tri)[3] = vg_alloc(n_tri, sizeof *tri);
  int sound = 1;
  vg_status st;

  *n = 0;
  z.first = vg_alloc(m->n_point + 1, sizeof *z.first);
  z.at = vg_alloc(3 * m->n_tri, sizeof *z.at);
  z.busy = vg_alloc(m->n_point, 1);
  z.gone = vg_calloc(m->n_tri, 1);
  if (!point || !place || !tri || !z.first || !z.at || !z.busy || !z.gone)
    VG_TRY(vg_fail_memory(err, "a wrap"));
  for (size_t p = 0; p < m->n_point; p++)
    if (!(vg_distance(near[p], m->point[p]) <= most))
      memcpy(near[p], m->point[p], sizeof *near);
  memcpy(place, near, n_point * sizeof *place);
  memcpy(point, m->point, n_point * sizeof *point);
  memcpy(tri, m->tri, n_tri * sizeof *tri);
  VG_TRY(zip_all(&z, stop, err));
  if (!z.n) goto done;
  compact(&z);
  VG_TRY(is_sound(m, stop, &sound, err));
  *n = sound ? z.n : 0;
  if (sound) goto done;
  memcpy(near, place, n_point * sizeof *place);
  memcpy(m->point, point, n_point * sizeof *point);
  memcpy(m->tri, tri, n_tri * sizeof *tri);
  m->n_point = n_point;
  m->n_tri = n_tri;
done:
  free(point);
  free(place);
  free(tri);
  free(z.first);
  free(z.at);
  free(z.busy);
  free(z.gone);
  return st;
}
