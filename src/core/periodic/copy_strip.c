/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Changes of the triangles along a border. Declared in
 * core/periodic/copy_parts.h. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/periodic/copy_parts.h"

#define NONE VG_PERIODIC_NONE
#define MOST_RING 64 /* most points around a removed one */

/* --- triangles at points -------------------------------------------------- */

static void link(struct vg_border_strip *s, uint32_t t)
{
  struct vg_strip_triangle *tri = &s->tri[t];

  for (uint32_t k = 0; k < 3; k++) {
    tri->next[k] = s->head[tri->point[k]];
    s->head[tri->point[k]] = 3 * t + k;
  }
}

static void unlink_triangle(struct vg_border_strip *s, uint32_t t)
{
  const struct vg_strip_triangle *tri = &s->tri[t];

  for (uint32_t k = 0; k < 3; k++) {
    uint32_t *at = &s->head[tri->point[k]];

    while (*at != 3 * t + k) at = &s->tri[*at / 3].next[*at % 3];
    *at = tri->next[k];
  }
}

/* The triangle with the half-edge from u to v; NONE: no triangle has it. */
static uint32_t find(const struct vg_border_strip *s, uint32_t u, uint32_t v)
{
  for (uint32_t c = s->head[u]; c != NONE; c = s->tri[c / 3].next[c % 3])
    if (s->tri[c / 3].point[(c + 1) % 3] == v) return c / 3;
  return NONE;
}

static uint32_t third(const uint32_t t[3], uint32_t u, uint32_t v)
{
  for (int k = 0; k < 3; k++)
    if (t[k] != u && t[k] != v) return t[k];
  return NONE;
}

static vg_status add_triangle(struct vg_border_strip *s, const uint32_t v[3],
                              uint32_t patch, uint32_t origin,
                              struct vg_error *err)
{
  struct vg_strip_triangle *t;

  if (vg_reserve(&s->tri, &s->cap_tri, s->n_tri + 1, sizeof *s->tri) < 0)
    return vg_fail_memory(err, "the periodic patches");
  t = &s->tri[s->n_tri];
  memcpy(t->point, v, sizeof t->point);
  t->patch = patch;
  t->origin = origin;
  t->is_gone = 0;
  link(s, (uint32_t)s->n_tri++);
  return VG_OK;
}

static vg_status add_point(struct vg_border_strip *s, const double x[3],
                           struct vg_error *err)
{
  if (vg_reserve(&s->point, &s->cap_point, s->n_point + 1, sizeof *s->point) <
        0 ||
      vg_reserve(&s->head, &s->cap_head, s->n_point + 1, sizeof *s->head) < 0)
    return vg_fail_memory(err, "the periodic patches");
  memcpy(s->point[s->n_point], x, sizeof *s->point);
  s->head[s->n_point++] = NONE;
  return VG_OK;
}

vg_status vg_strip_start(struct vg_border_strip *s, const struct vg_mesh *m,
                         uint32_t without, struct vg_error *err)
{
  vg_status st = VG_OK;

  memset(s, 0, sizeof *s);
  for (size_t i = 0; i < m->n_point; i++)
    VG_TRY(add_point(s, m->point[i], err));
  for (uint32_t t = 0; t < m->n_tri; t++)
    if (m->tri_patch[t] != without)
      VG_TRY(add_triangle(s, m->tri[t], m->tri_patch[t], t, err));
done:
  return st;
}

void vg_strip_release(struct vg_border_strip *s)
{
  free(s->point);
  free(s->head);
  free(s->tri);
  memset(s, 0, sizeof *s);
}

/* --- insertion ------------------------------------------------------------ */

/* Gives triangle t other points. */
static void put(struct vg_border_strip *s, uint32_t t, const uint32_t v[3])
{
  unlink_triangle(s, t);
  memcpy(s->tri[t].point, v, sizeof s->tri[t].point);
  link(s, t);
}

vg_status vg_strip_insert(struct vg_border_strip *s, uint32_t u, uint32_t v,
                          const double x[3], struct vg_error *err)
{
  const uint32_t t = find(s, u, v), p = (uint32_t)s->n_point;
  uint32_t o;
  vg_status st = add_point(s, x, err);

  if (st < 0 || t == NONE) return st;
  o = third(s->tri[t].point, u, v);
  put(s, t, (uint32_t[3]){ u, p, o });
  return add_triangle(s, (uint32_t[3]){ p, v, o }, s->tri[t].patch,
                      s->tri[t].origin, err);
}

/* --- removal -------------------------------------------------------------- */

/* The polygon that remains without a point: its points counter-clockwise, and
 * in the plane; and the triangles at the point. */
struct ring {
  size_t n, n_tri;
  uint32_t point[MOST_RING], tri[MOST_RING];
  double x[MOST_RING][2];
};

static double det2(const double a[2], const double b[2], const double c[2])
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* The triangles at b, from the one at l to the one at r. */
static int gather(const struct vg_border_strip *s, uint32_t l, uint32_t b,
                  uint32_t r, struct ring *q)
{
  uint32_t x = l, reversed[MOST_RING];

  q->n = q->n_tri = 0;
  while (x != r) {
    const uint32_t t = find(s, x, b);

    if (t == NONE || q->n_tri + 3 > MOST_RING) return 0;
    reversed[q->n_tri] = x;
    q->tri[q->n_tri++] = t;
    x = third(s->tri[t].point, x, b);
  }
  q->point[q->n++] = l;
  q->point[q->n++] = r;
  for (size_t k = q->n_tri; k-- > 1;) q->point[q->n++] = reversed[k];
  return q->n > 2;
}

static void flatten(const struct vg_border_strip *s, struct ring *q)
{
  double n[3] = { 0 }, u[3], v[3], c[3], d[3];

  for (size_t k = 0; k < q->n_tri; k++) {
    const uint32_t *t = s->tri[q->tri[k]].point;

    vg_sub(s->point[t[1]], s->point[t[0]], u);
    vg_sub(s->point[t[2]], s->point[t[0]], v);
    vg_cross(u, v, c);
    for (int i = 0; i < 3; i++) n[i] += c[i];
  }
  vg_unit(n);
  vg_normals(n, u, v);
  for (size_t k = 0; k < q->n; k++) {
    vg_sub(s->point[q->point[k]], s->point[q->point[0]], d);
    q->x[k][0] = vg_dot(d, u);
    q->x[k][1] = vg_dot(d, v);
  }
}

/* Twice the area over the sum of the squared edges; 0 or less: no ear. */
static double ear(const struct ring *q, size_t k)
{
  const size_t a = k ? k - 1 : q->n - 1, c = k + 1 < q->n ? k + 1 : 0;
  const double *x[3] = { q->x[a], q->x[k], q->x[c] };
  double sum = 0;
  const double area = det2(x[0], x[1], x[2]);

  for (size_t i = 0; i < q->n && area > 0; i++) {
    if (i == a || i == k || i == c) continue;
    if (det2(x[0], x[1], q->x[i]) >= 0 && det2(x[1], x[2], q->x[i]) >= 0 &&
        det2(x[2], x[0], q->x[i]) >= 0)
      return 0;
  }
  for (int i = 0; i < 3; i++) {
    const double *y = x[i], *z = x[(i + 1) % 3];

    sum += (z[0] - y[0]) * (z[0] - y[0]) + (z[1] - y[1]) * (z[1] - y[1]);
  }
  return area / sum;
}

/* Cuts the best ear off until nothing is left. */
static int cut_ears(struct ring *q, uint32_t (*out)[3])
{
  size_t n = 0;

  while (q->n > 2) {
    double best = 0;
    size_t at = 0;

    for (size_t k = 0; k < q->n; k++) {
      const double quality = ear(q, k);

      if (quality > best) {
        best = quality;
        at = k;
      }
    }
    if (!(best > 0)) return 0;
    out[n][0] = q->point[at ? at - 1 : q->n - 1];
    out[n][1] = q->point[at];
    out[n++][2] = q->point[at + 1 < q->n ? at + 1 : 0];
    memmove(&q->point[at], &q->point[at + 1],
            (q->n - at - 1) * sizeof *q->point);
    memmove(&q->x[at], &q->x[at + 1], (q->n - at - 1) * sizeof *q->x);
    q->n--;
  }
  return 1;
}

int vg_strip_remove(struct vg_border_strip *s, uint32_t l, uint32_t b,
                    uint32_t r)
{
  uint32_t out[MOST_RING][3];
  struct ring q;

  assert(l != b && b != r);
  if (s->head[b] == NONE) return 1;
  if (l == r || !gather(s, l, b, r, &q)) return 0;
  flatten(s, &q);
  if (!cut_ears(&q, out)) return 0;
  /* There is one triangle less. */
  for (size_t k = 0; k + 1 < q.n_tri; k++) put(s, q.tri[k], out[k]);
  unlink_triangle(s, q.tri[q.n_tri - 1]);
  s->tri[q.tri[q.n_tri - 1]].is_gone = 1;
  return s->head[b] == NONE;
}
