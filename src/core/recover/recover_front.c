/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Queries of the flips about the surface: its edges and triangles, and
 * obstructions of an edge or triangle to be recovered. */
#include "core/recover/recover_flip.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"

/* --- edges and triangles -------------------------------------------------- */

static uint32_t find(const uint32_t *list, uint32_t from, uint32_t to,
                     uint32_t x)
{
  while (from < to && list[from] != x) from++;
  return from < to ? from : VG_NONE;
}

uint32_t vg_flip_edge_at(const struct vg_flip_front *s, uint32_t a, uint32_t b)
{
  uint32_t low = a < b ? a : b, high = a < b ? b : a;

  assert(a != b && a < s->n_point && b < s->n_point);
  if (high >= s->n_point) return VG_NONE;
  return find(s->edge, s->first_edge[low], s->first_edge[low + 1], high);
}

static uint32_t lowest(const uint32_t v[3])
{
  uint32_t low = v[0] < v[1] ? v[0] : v[1];

  return low < v[2] ? low : v[2];
}

int vg_flip_is_tri(const struct vg_flip_front *s, const uint32_t v[3])
{
  assert(v[0] != v[1] && v[1] != v[2] && v[2] != v[0]);

  uint32_t low = lowest(v);

  if (v[0] >= s->n_point || v[1] >= s->n_point || v[2] >= s->n_point) return 0;
  for (uint32_t k = s->first_tri[low]; k < s->first_tri[low + 1]; k++) {
    const uint32_t *w = s->tri[s->of_point[k]];
    int same = 0;

    for (int i = 0; i < 3; i++)
      same += w[i] == v[0] || w[i] == v[1] || w[i] == v[2];
    if (same == 3) return 1;
  }
  return 0;
}

/* Remove duplicates: an edge of two triangles was entered twice. */
static void drop_doubles(struct vg_flip_front *s)
{
  uint32_t n = 0, from = 0;

  for (size_t p = 0; p < s->n_point; p++) {
    uint32_t to = s->first_edge[p + 1], begin = n;

    for (; from < to; from++)
      if (find(s->edge, begin, n, s->edge[from]) == VG_NONE)
        s->edge[n++] = s->edge[from];
    s->first_edge[p] = begin;
  }
  s->first_edge[s->n_point] = n;
}

vg_status vg_flip_front_init(struct vg_flip_front *s, size_t n_point,
                             size_t n_tri, const uint32_t (*tri)[3],
                             struct vg_error *err)
{
  assert(s && (tri || !n_tri));
  s->n_point = n_point;
  s->tri = tri;
  s->first_edge = vg_calloc(n_point + 2, sizeof *s->first_edge);
  s->first_tri = vg_calloc(n_point + 2, sizeof *s->first_tri);
  s->edge = vg_alloc(3 * n_tri, sizeof *s->edge);
  s->of_point = vg_alloc(n_tri, sizeof *s->of_point);
  if (!s->first_edge || !s->first_tri || !s->edge || !s->of_point)
    return vg_fail_memory(err, "boundary recovery");
  for (size_t m = 0; m < n_tri; m++) {
    s->first_tri[lowest(tri[m]) + 2]++;
    for (int k = 0; k < 3; k++) {
      uint32_t a = tri[m][k], b = tri[m][(k + 1) % 3];

      s->first_edge[(a < b ? a : b) + 2]++;
    }
  }
  for (size_t p = 0; p < n_point; p++) {
    s->first_edge[p + 2] += s->first_edge[p + 1];
    s->first_tri[p + 2] += s->first_tri[p + 1];
  }
  for (size_t m = 0; m < n_tri; m++) {
    s->of_point[s->first_tri[lowest(tri[m]) + 1]++] = (uint32_t)m;
    for (int k = 0; k < 3; k++) {
      uint32_t a = tri[m][k], b = tri[m][(k + 1) % 3];

      s->edge[s->first_edge[(a < b ? a : b) + 1]++] = a < b ? b : a;
    }
  }
  drop_doubles(s);
  return VG_OK;
}

void vg_flip_front_release(struct vg_flip_front *s)
{
  free(s->first_edge);
  free(s->first_tri);
  free(s->edge);
  free(s->of_point);
  memset(s, 0, sizeof *s);
}

/* --- obstructions --------------------------------------------------------- */

static double side(const struct vg_tets *t, uint32_t a, uint32_t b, uint32_t c,
                   uint32_t d)
{
  return vg_orient3d(t->x[a], t->x[b], t->x[c], t->x[d]);
}

/* Are the triangle end y z and the edge end - other coplanar, and does the
 * edge leave the triangle through y z? Since all points are in one plane, the
 * test is made in the projection along the largest component of the triangle's
 * normal. */
static int crosses_in_plane(const struct vg_tets *t, uint32_t end,
                            uint32_t other, uint32_t y, uint32_t z)
{
  const double *x[4] = { t->x[end], t->x[other], t->x[y], t->x[z] };
  double p[4][2], most = -1, turn, left, right, beyond;
  int u = 0, v = 1;

  if (side(t, end, other, y, z) != 0) return 0;
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    double n = fabs((x[2][i] - x[0][i]) * (x[3][j] - x[0][j]) -
                    (x[2][j] - x[0][j]) * (x[3][i] - x[0][i]));

    if (n <= most) continue;
    most = n;
    u = i;
    v = j;
  }
  for (int k = 0; k < 4; k++) {
    p[k][0] = x[k][u];
    p[k][1] = x[k][v];
  }
  turn = vg_orient2d(p[0], p[2], p[3]);
  left = vg_orient2d(p[0], p[2], p[1]);
  right = vg_orient2d(p[0], p[1], p[3]);
  beyond = vg_orient2d(p[2], p[1], p[3]);
  if (turn > 0) return left >= 0 && right >= 0 && beyond > 0;
  return left <= 0 && right <= 0 && beyond < 0;
}

int vg_flip_obstructs(const struct vg_flipper *f, uint32_t x, uint32_t y,
                      uint32_t z)
{
  assert(f->n_target == 2 || f->n_target == 3);

  const struct vg_tets *t = f->t;
  uint32_t a = f->target[0], b = f->target[1], v[3] = { x, y, z };
  double above, below, s[3];
  int n_end = 0, end = 0;

  if (f->n_target != 2) return 0;
  for (int k = 0; k < 3; k++)
    if (v[k] == a || v[k] == b) {
      n_end++;
      end = k;
    }
  if (n_end > 1) return 0;
  if (n_end)
    return crosses_in_plane(t, v[end], v[end] == a ? b : a, v[(end + 1) % 3],
                            v[(end + 2) % 3]);
  above = side(t, x, y, z, a);
  below = side(t, x, y, z, b);
  if ((above > 0 && below > 0) || (above < 0 && below < 0)) return 0;
  s[0] = side(t, a, b, x, y);
  s[1] = side(t, a, b, y, z);
  s[2] = side(t, a, b, z, x);
  return (s[0] >= 0 && s[1] >= 0 && s[2] >= 0) ||
         (s[0] <= 0 && s[1] <= 0 && s[2] <= 0);
}

int vg_flip_pierces(const struct vg_flipper *f, uint32_t p, uint32_t q)
{
  assert(p != q);

  const struct vg_tets *t = f->t;
  const uint32_t *v = f->target;
  double above, below, s[3];

  if (f->n_target != 3 || p == v[0] || p == v[1] || p == v[2] || q == v[0] ||
      q == v[1] || q == v[2])
    return 0;
  above = side(t, v[0], v[1], v[2], p);
  below = side(t, v[0], v[1], v[2], q);
  if ((above >= 0 && below >= 0) || (above <= 0 && below <= 0)) return 0;
  s[0] = side(t, p, q, v[0], v[1]);
  s[1] = side(t, p, q, v[1], v[2]);
  s[2] = side(t, p, q, v[2], v[0]);
  return (s[0] >= 0 && s[1] >= 0 && s[2] >= 0) ||
         (s[0] <= 0 && s[1] <= 0 && s[2] <= 0);
}
