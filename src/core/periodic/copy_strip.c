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
  for (uint32_t k = 0; k < 3; k++) {
    s->next[3 * t + k] = s->head[s->tri[t][k]];
    s->head[s->tri[t][k]] = 3 * t + k;
  }
}

static void unlink_triangle(struct vg_border_strip *s, uint32_t t)
{
  for (uint32_t k = 0; k < 3; k++) {
    uint32_t *at = &s->head[s->tri[t][k]];

    while (*at != 3 * t + k) at = &s->next[*at];
    *at = s->next[*at];
  }
}

/* The triangle with the half-edge from u to v; NONE: no triangle has it. */
static uint32_t find(const struct vg_border_strip *s, uint32_t u, uint32_t v)
{
  for (uint32_t c = s->head[u]; c != NONE; c = s->next[c])
    if (s->tri[c / 3][(c + 1) % 3] == v && c % 3 != 2) return c / 3;
    else if (c % 3 == 2 && s->tri[c / 3][0] == v) return c / 3;
  return NONE;
}

static uint32_t third(const uint32_t t[3], uint32_t u, uint32_t v)
{
  for (int k = 0; k < 3; k++)
    if (t[k] != u && t[k] != v) return t[k];
  return NONE;
}

static vg_status add_triangle(struct vg_border_strip *s, const uint32_t v[3],
                              uint32_t like, struct vg_error *err)
{
  size_t cap = s->cap_tri;
  const size_t n = s->n_tri + 1;

  if (n > cap) {
    const size_t cap_new = n + n / 8 + 16;
    void *tri = vg_realloc(s->tri, cap_new, sizeof *s->tri);
    void *patch, *origin, *gone, *next;

    if (tri) s->tri = tri;
    patch = vg_realloc(s->patch, cap_new, sizeof *s->patch);
    if (patch) s->patch = patch;
    origin = vg_realloc(s->origin, cap_new, sizeof *s->origin);
    if (origin) s->origin = origin;
    gone = vg_realloc(s->is_gone, cap_new, 1);
    if (gone) s->is_gone = gone;
    next = vg_realloc(s->next, 3 * cap_new, sizeof *s->next);
    if (next) s->next = next;
    if (!tri || !patch || !origin || !gone || !next)
      return vg_fail_memory(err, "the periodic patches");
    s->cap_tri = cap_new;
  }
  memcpy(s->tri[s->n_tri], v, sizeof *s->tri);
  s->patch[s->n_tri] = s->patch[like];
  s->origin[s->n_tri] = s->origin[like];
  s->is_gone[s->n_tri] = 0;
  link(s, (uint32_t)s->n_tri++);
  return VG_OK;
}

static vg_status add_point(struct vg_border_strip *s, const double x[3],
                           struct vg_error *err)
{
  if (vg_reserve(&s->point, &s->cap_point, s->n_point + 1, sizeof *s->point) <
        0 ||
      vg_reserve(&s->head, &s->cap_next, s->n_point + 1, sizeof *s->head) < 0)
    return vg_fail_memory(err, "the periodic patches");
  memcpy(s->point[s->n_point], x, sizeof *s->point);
  s->head[s->n_point++] = NONE;
  return VG_OK;
}

vg_status vg_strip_start(struct vg_border_strip *s, const struct vg_mesh *m,
                         uint32_t without, struct vg_error *err)
{
  memset(s, 0, sizeof *s);
  s->n_point = s->cap_point = s->cap_next = m->n_point;
  s->cap_tri = m->n_tri;
  s->point = vg_alloc(m->n_point, sizeof *s->point);
  s->head = vg_alloc(m->n_point, sizeof *s->head);
  s->tri = vg_alloc(m->n_tri, sizeof *s->tri);
  s->patch = vg_alloc(m->n_tri, sizeof *s->patch);
  s->origin = vg_alloc(m->n_tri, sizeof *s->origin);
  s->is_gone = vg_calloc(m->n_tri, 1);
  s->next = vg_alloc(3 * m->n_tri, sizeof *s->next);
  if (!s->point || !s->head || !s->tri || !s->patch || !s->origin ||
      !s->is_gone || !s->next)
    return vg_fail_memory(err, "the periodic patches");
  memcpy(s->point, m->point, m->n_point * sizeof *s->point);
  for (size_t i = 0; i < m->n_point; i++) s->head[i] = NONE;
  for (uint32_t t = 0; t < m->n_tri; t++) {
    if (m->tri_patch[t] == without) continue;
    memcpy(s->tri[s->n_tri], m->tri[t], sizeof *s->tri);
    s->patch[s->n_tri] = m->tri_patch[t];
    s->origin[s->n_tri] = t;
    link(s, (uint32_t)s->n_tri++);
  }
  return VG_OK;
}

void vg_strip_release(struct vg_border_strip *s)
{
  free(s->point);
  free(s->head);
  free(s->tri);
  free(s->patch);
  free(s->origin);
  free(s->is_gone);
  free(s->next);
  memset(s, 0, sizeof *s);
}

/* --- insertion ------------------------------------------------------------ */

vg_status vg_strip_insert(struct vg_border_strip *s, uint32_t u, uint32_t v,
                          const double x[3], struct vg_error *err)
{
  const uint32_t t = find(s, u, v), p = (uint32_t)s->n_point;
  uint32_t o;
  vg_status st;

  VG_TRY(add_point(s, x, err));
  if (t == NONE) goto done;
  o = third(s->tri[t], u, v);
  unlink_triangle(s, t);
  memcpy(s->tri[t], (uint32_t[3]){ u, p, o }, sizeof s->tri[t]);
  link(s, t);
  VG_TRY(add_triangle(s, (uint32_t[3]){ p, v, o }, t, err));
done:
  return st;
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
    x = third(s->tri[t], x, b);
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
    const uint32_t *t = s->tri[q->tri[k]];

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
  for (size_t k = 0; k < q.n_tri; k++) unlink_triangle(s, q.tri[k]);
  /* There is one triangle less. */
  for (size_t k = 0; k + 1 < q.n_tri; k++) {
    memcpy(s->tri[q.tri[k]], out[k], sizeof *s->tri);
    link(s, q.tri[k]);
  }
  s->is_gone[q.tri[q.n_tri - 1]] = 1;
  return s->head[b] == NONE;
}
