/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Refines interfaces to the local size by bisection, as in the original
 * method. The longest edge of a triangle is halved if it is too long, and
 * triangles split into two, three or four by their halved edges, repeatedly
 * (M.-C. Rivara, Int. J. Numer. Methods Eng. 20, 1984: angles stay above half
 * of the initial ones). */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"
#include "partition/discrete/discrete_parts.h"

/* An edge is halved while it is longer than this many times the size at its
 * midpoint. */
static const double longest = 1.5; /* D8 */
/* A coarse edge is halved a few times; more rounds than this indicate an
 * invalid size. */
enum { ROUNDS = 60 };

struct halving {
  const struct vg_coarse *c;
  const struct vg_sizing *sizing;
  struct vg_sheets *s;
  size_t n;
  uint32_t (*tri)[3]; /* [n] Triangles, by ascending face. */
  uint32_t *face;     /* [n] Face that contains each triangle. */
  double *reach; /* [c.n_front] Square of the longest front edge at a point. */
  uint32_t *middle; /* [n][3] Midpoints of halved edges, or VG_NONE. */
};

static const double *point_of(const struct halving *h, uint32_t k)
{
  size_t n = h->c->t.n_point;

  return k < n ? h->c->t.x[k] : h->s->x[k - n];
}

/* Edges at a point of the front are not halved below the longest front edge
 * there, however small the size is. Front edges stay, and triangles on them
 * would become flat. */
static vg_status find_reach(struct halving *h, struct vg_error *err)
{
  const struct vg_coarse *c = h->c;

  h->reach = vg_calloc(c->n_front, sizeof *h->reach);
  if (!h->reach) return vg_fail_memory(err, "the interfaces");
  for (size_t q = 0; q < 4 * c->t.n_cell; q++) {
    if (c->on[q / 4][q % 4] == VG_NONE) continue;
    for (int k = 0; k < 3; k++) {
      uint32_t a = c->t.cell[q / 4].v[vg_face[q % 4][k]];
      uint32_t b = c->t.cell[q / 4].v[vg_face[q % 4][(k + 1) % 3]];
      double l = vg_distance2(c->t.x[a], c->t.x[b]);

      if (l > h->reach[a]) h->reach[a] = l;
      if (l > h->reach[b]) h->reach[b] = l;
    }
  }
  return VG_OK;
}

static double length2(const struct halving *h, uint32_t half)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])h->tri;

  return vg_distance2(point_of(h, vg_half_from(tri, half)),
                      point_of(h, vg_half_to(tri, half)));
}

/* Of edges of equal length, the one with the higher index counts as longer. */
static int is_longer(const struct halving *h, const struct vg_edges *e,
                     uint32_t a, uint32_t b)
{
  double x = length2(h, a), y = length2(h, b);

  return x != y ? x > y : e->of_half[a] > e->of_half[b];
}

static int is_too_long(const struct halving *h, uint32_t half)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])h->tri;
  const uint32_t end[2] = { vg_half_from(tri, half), vg_half_to(tri, half) };
  const double *a = point_of(h, end[0]), *b = point_of(h, end[1]);
  double mid[3], most;

  for (int k = 0; k < 3; k++) mid[k] = 0.5 * (a[k] + b[k]);
  most = longest * vg_sizing_at(h->sizing, mid);
  most *= most;
  for (int k = 0; k < 2; k++)
    if (end[k] < h->c->n_front && h->reach[end[k]] > most)
      most = h->reach[end[k]];
  return vg_distance2(a, b) > most;
}

/* Marks in each triangle the longest of the edges that are too long. middle
 * out: [e->n] VG_NONE for unmarked edges. */
static void mark_long(const struct halving *h, const struct vg_edges *e,
                      uint32_t *middle)
{
  memset(middle, 0xff, e->n * sizeof *middle);
  for (uint32_t i = 0; i < h->n; i++) {
    uint32_t best = VG_NONE;

    for (uint32_t half = 3 * i; half < 3 * i + 3; half++)
      if (is_too_long(h, half) &&
          (best == VG_NONE || is_longer(h, e, half, best)))
        best = half;
    if (best != VG_NONE) middle[e->of_half[best]] = 0;
  }
}

/* Adds a midpoint to each marked edge. middle[i] becomes its index. */
static vg_status add_middles(struct halving *h, const struct vg_edges *e,
                             uint32_t *middle, size_t *n_halved,
                             struct vg_error *err)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])h->tri;

  *n_halved = 0;
  for (size_t k = 0; k < e->n; k++) {
    uint32_t half = *vg_edges_at(e, k);

    if (middle[k] == VG_NONE) continue;
    if (vg_reserve(&h->s->x, &h->s->cap_point, h->s->n_point + 1,
                   sizeof *h->s->x))
      return vg_fail_memory(err, "the interfaces");
    for (int i = 0; i < 3; i++)
      h->s->x[h->s->n_point][i] = 0.5 *
                                  (point_of(h, vg_half_from(tri, half))[i] +
                                   point_of(h, vg_half_to(tri, half))[i]);
    middle[k] = (uint32_t)(h->c->t.n_point + h->s->n_point++);
    ++*n_halved;
  }
  return VG_OK;
}

static vg_status halve_edges(struct halving *h, size_t *n_halved,
                             struct vg_error *err)
{
  size_t n_point = h->c->t.n_point + h->s->n_point;
  struct vg_edges e = VG_EDGES_INIT;
  uint32_t *middle = NULL;
  vg_status st;

  free(h->middle);
  h->middle = vg_alloc(3 * h->n, sizeof *h->middle);
  if (!h->middle) VG_TRY(vg_fail_memory(err, "the interfaces"));
  VG_TRY(vg_edges_build(&e, n_point, h->n, (const uint32_t(*)[3])h->tri, NULL,
                        0, err));
  middle = vg_alloc(e.n, sizeof *middle);
  if (!middle) VG_TRY(vg_fail_memory(err, "the interfaces"));
  mark_long(h, &e, middle);
  VG_TRY(add_middles(h, &e, middle, n_halved, err));
  for (size_t k = 0; k < 3 * h->n; k++) h->middle[k] = middle[e.of_half[k]];
done:
  vg_edges_release(&e);
  free(middle);
  return st;
}

/* Splits a triangle, keeping its orientation. */
static int split_triangle(const struct halving *h, const uint32_t v[3],
                          const uint32_t m[3], uint32_t part[4][3])
{
  int n = 0, k = 0;

  for (int i = 0; i < 3; i++) n += m[i] != VG_NONE;
  if (n == 0) {
    memcpy(part[0], v, sizeof part[0]);
    return 1;
  }
  if (n == 3) {
    for (int i = 0; i < 3; i++)
      memcpy(part[i], (uint32_t[3]){ v[i], m[i], m[(i + 2) % 3] },
             sizeof part[i]);
    memcpy(part[3], m, sizeof part[3]);
    return 4;
  }
  while (n == 1 ? m[k] == VG_NONE : m[k] != VG_NONE) k++;
  { /* k: the only halved edge, or the only edge that is not halved */
    uint32_t a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3];
    uint32_t p = m[(k + 1) % 3], q = m[(k + 2) % 3];

    if (n == 1) {
      memcpy(part[0], (uint32_t[3]){ a, m[k], c }, sizeof part[0]);
      memcpy(part[1], (uint32_t[3]){ m[k], b, c }, sizeof part[1]);
      return 2;
    }
    memcpy(part[0], (uint32_t[3]){ p, c, q }, sizeof part[0]);
    if (vg_distance2(point_of(h, a), point_of(h, p)) <=
        vg_distance2(point_of(h, b), point_of(h, q))) {
      memcpy(part[1], (uint32_t[3]){ a, p, q }, sizeof part[1]);
      memcpy(part[2], (uint32_t[3]){ a, b, p }, sizeof part[2]);
    } else {
      memcpy(part[1], (uint32_t[3]){ a, b, q }, sizeof part[1]);
      memcpy(part[2], (uint32_t[3]){ b, p, q }, sizeof part[2]);
    }
    return 3;
  }
}

static vg_status split_all(struct halving *h, struct vg_error *err)
{
  uint32_t(*to)[3] = vg_alloc(4 * h->n, sizeof *to);
  uint32_t *face = vg_alloc(4 * h->n, sizeof *face);
  size_t n = 0;

  if (!to || !face) {
    free(to);
    free(face);
    return vg_fail_memory(err, "the interfaces");
  }
  for (size_t i = 0; i < h->n; i++) {
    int n_part = split_triangle(h, h->tri[i], h->middle + 3 * i, to + n);

    for (int k = 0; k < n_part; k++) face[n++] = h->face[i];
  }
  free(h->tri);
  free(h->face);
  h->tri = to;
  h->face = face;
  h->n = n;
  return VG_OK;
}

static vg_status hand_over(const struct halving *h, size_t n_face,
                           struct vg_error *err)
{
  struct vg_sheets *s = h->s;

  s->begin = vg_calloc(n_face + 1, sizeof *s->begin);
  s->tri = vg_alloc(h->n, sizeof *s->tri);
  if (!s->begin || !s->tri) return vg_fail_memory(err, "the interfaces");
  for (size_t k = 0; k < h->n; k++) {
    memcpy(s->tri[k], h->tri[k], sizeof *s->tri);
    s->begin[h->face[k] + 1] = k + 1;
  }
  return VG_OK;
}

vg_status vg_sheets_halve(const struct vg_coarse *c,
                          const struct vg_interface *f,
                          const struct vg_sizing *sizing, struct vg_sheets *s,
                          struct vg_error *err)
{
  struct halving h = { .c = c, .sizing = sizing, .s = s, .n = f->n_face };
  size_t n_halved = 1;
  vg_status st;

  assert(!s->n_point && !s->x && !s->begin && !s->tri);
  h.tri = vg_alloc(f->n_face, sizeof *h.tri);
  h.face = vg_alloc(f->n_face, sizeof *h.face);
  st = h.tri && h.face ? find_reach(&h, err)
                       : vg_fail_memory(err, "the interfaces");
  for (size_t i = 0; st == VG_OK && i < f->n_face; i++) {
    vg_interface_corners(c, f, i, h.tri[i]);
    h.face[i] = (uint32_t)i;
  }
  for (int k = 0; st == VG_OK && n_halved && k < ROUNDS; k++) {
    st = halve_edges(&h, &n_halved, err);
    if (st == VG_OK && n_halved) st = split_all(&h, err);
  }
  if (st == VG_OK) st = hand_over(&h, f->n_face, err);
  free(h.tri);
  free(h.face);
  free(h.middle);
  free(h.reach);
  return st;
}
