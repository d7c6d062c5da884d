/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/section/section_surface.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define SQRT3_HALF 0.8660254037844386

/* --- strips -------------------------------------------------------------- */

/* Closed loops of points. */
struct loops {
  size_t n_point, cap;
  double (*x)[2];
  size_t n, *end; /* Index after the last point of each loop. */
};

static void release_loops(struct loops *l)
{
  free(l->x);
  free(l->end);
}

/* Geometric mean of the least and the largest edge, so that the triangles of
 * the strip are not flatter than necessary. */
static double width_of(const struct loops *l)
{
  double least = INFINITY, most = 0;

  for (size_t e = 0, first = 0; e < l->n; first = l->end[e++])
    for (size_t i = first; i < l->end[e]; i++) {
      const double *a = l->x[i], *b = l->x[i + 1 < l->end[e] ? i + 1 : first];
      const double dx = b[0] - a[0], dy = b[1] - a[1];

      least = fmin(least, sqrt(dx * dx + dy * dy));
      most = fmax(most, sqrt(dx * dx + dy * dy));
    }
  return sqrt(least * most);
}

/* Two triangles on the edge a b of the plane, with the fluid on its right.
 * Diagonals alternate, so that columns have neighbours alike on both sides. */
static void put_strip(struct vg_mesh *m, uint32_t a, uint32_t b, uint32_t half,
                      uint32_t patch, int is_odd)
{
  const uint32_t q[4] = { a, b, b + half, a + half };
  static const int corner[2][2][3] = { { { 0, 1, 2 }, { 0, 2, 3 } },
                                       { { 0, 1, 3 }, { 1, 2, 3 } } };

  for (int t = 0; t < 2; t++) {
    for (int k = 0; k < 3; k++) m->tri[m->n_tri][k] = q[corner[is_odd][t][k]];
    m->tri_patch[m->n_tri++] = patch;
  }
}

/* Replaces points and triangles of m by those of the strips of the loops, one
 * patch for each. */
static vg_status make_strip(const struct loops *l, double width,
                            struct vg_mesh *m, struct vg_error *err)
{
  const size_t n = l->n_point;
  double(*point)[3] = vg_alloc(2 * n, sizeof *point);
  uint32_t(*tri)[3] = vg_alloc(2 * n, sizeof *tri);
  uint32_t *patch = vg_alloc(2 * n, sizeof *patch);

  assert(l->n == m->n_patch);
  if (!point || !tri || !patch || n >= UINT32_MAX / 2) {
    free(point);
    free(tri);
    free(patch);
    return vg_fail_memory(err, "the walls of a section");
  }
  free(m->point);
  free(m->tri);
  free(m->tri_patch);
  m->point = point;
  m->tri = tri;
  m->tri_patch = patch;
  m->n_point = 2 * n;
  m->n_tri = 0;
  for (size_t i = 0; i < 2 * n; i++) {
    point[i][0] = l->x[i < n ? i : i - n][0];
    point[i][1] = l->x[i < n ? i : i - n][1];
    point[i][2] = i < n ? 0 : width;
  }
  for (size_t e = 0, first = 0; e < l->n; first = l->end[e++])
    for (size_t i = first; i < l->end[e]; i++)
      put_strip(m, (uint32_t)i, (uint32_t)(i + 1 < l->end[e] ? i + 1 : first),
                (uint32_t)n, (uint32_t)e, (int)(i & 1));
  return VG_OK;
}

/* The loops of a strip: the patches follow each other. */
static vg_status loops_of(const struct vg_mesh *strip, struct loops *l,
                          struct vg_error *err)
{
  l->n_point = strip->n_point / 2;
  l->n = strip->n_patch;
  l->x = vg_alloc(l->n_point, sizeof *l->x);
  l->end = vg_calloc(l->n, sizeof *l->end);
  if (!l->x || !l->end) return vg_fail_memory(err, "the walls of a section");
  for (size_t i = 0; i < l->n_point; i++)
    memcpy(l->x[i], strip->point[i], sizeof *l->x);
  for (size_t t = 0; t < strip->n_tri; t++)
    l->end[strip->tri_patch[t]] = t / 2 + 1;
  return VG_OK;
}

/* Titles become names of patches, which are one word. */
static void name_patch(const struct vg_section *s, size_t e,
                       struct vg_patch *patch)
{
  const char *title = s->element[e].name;

  *patch = (struct vg_patch){ .id = (int32_t)e + 1,
                              .bc = VG_BC_NONE,
                              .bc_fun3d = VG_BC_NONE };
  if (!*title && s->n == 1) snprintf(patch->name, VG_NAME_MAX, "aerofoil");
  else if (!*title) snprintf(patch->name, VG_NAME_MAX, "element_%zu", e + 1);
  else snprintf(patch->name, VG_NAME_MAX, "%s", title);
  for (char *c = patch->name; *c; c++)
    if (isspace((unsigned char)*c)) *c = '_';
}

vg_status vg_section_strip(const struct vg_section *s, struct vg_mesh *out,
                           struct vg_error *err)
{
  struct loops l = { .n_point = s->n_point, .x = s->x, .n = s->n };
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  l.end = vg_alloc(s->n, sizeof *l.end);
  m.patch = vg_alloc(s->n, sizeof *m.patch);
  if (!l.end || !m.patch) {
    st = vg_fail_memory(err, "the walls of a section");
    goto done;
  }
  m.n_patch = s->n;
  for (size_t e = 0; e < s->n; e++) {
    l.end[e] = s->element[e].first + s->element[e].n;
    name_patch(s, e, &m.patch[e]);
  }
  VG_TRY(make_strip(&l, width_of(&l), &m, err));
  vg_mesh_move(out, &m);
done:
  free(l.end);
  vg_mesh_release(&m);
  return st;
}

/* --- edges of the requested length --------------------------------------- */

static vg_status check_start(const struct vg_outline *c, const char *name,
                             struct vg_error *err)
{
  size_t at = 0;

  while (at < c->n && c->corner[at] <= 0) at++;
  if (at == c->n || c->corner[0] || c->base[0] != SIZE_MAX) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "section %s: the first point (%.6g, %.6g) is not the trailing "
                 "edge, as in Selig's and Lednicer's order: the curve is "
                 "smooth there, and has a corner at (%.6g, %.6g). Begin with "
                 "the point at the trailing edge",
                 name, c->x[0][0], c->x[0][1], c->x[at][0], c->x[at][1]);
}

static void describe(const struct vg_outline *c, size_t n_edge,
                     struct vg_section_found *found)
{
  *found = (struct vg_section_found){ .n_corner = c->n_corner,
                                      .n_edge = n_edge,
                                      .chord = c->chord,
                                      .start = { c->x[0][0], c->x[0][1] },
                                      .is_corner = c->corner[0] != 0,
                                      .turn = c->turn };
  memcpy(found->at, c->x[c->turns_at], sizeof found->at);
  if (c->base[0] != SIZE_MAX) found->base = vg_outline_base(c);
}

static vg_status divide_loop(const struct loops *from, size_t first, size_t n,
                             const char *name, struct vg_outline_sizes sizes,
                             const struct vg_section_shares *shares,
                             struct loops *to, struct vg_section_found *found,
                             struct vg_error *err)
{
  struct vg_outline c = VG_OUTLINE_INIT;
  double(*x)[2] = NULL;
  size_t n_x = 0;
  vg_status st;

  VG_TRY(vg_outline_new(n, (const double(*)[2])from->x + first, &c, err));
  VG_TRY(check_start(&c, name, err));
  sizes.corner = fmax(shares->corner * c.chord,
                      shares->corner > 0 ? sizes.smallest : 0);
  sizes.nose = fmax(shares->nose * c.chord,
                    shares->nose > 0 ? sizes.smallest : 0);
  VG_TRY(vg_outline_divide(&c, &sizes, &n_x, &x, err));
  if (vg_reserve(&to->x, &to->cap, to->n_point + n_x, sizeof *to->x)) {
    st = vg_fail_memory(err, "the edges of a section");
    goto done;
  }
  memcpy(to->x + to->n_point, x, n_x * sizeof *x);
  to->n_point += n_x;
  describe(&c, n_x, found);
done:
  free(x);
  vg_outline_release(&c);
  return st;
}

vg_status vg_section_divide(struct vg_mesh *strip,
                            const struct vg_outline_sizes *sizes,
                            const struct vg_section_shares *shares,
                            struct vg_section_found *found,
                            struct vg_error *err)
{
  struct loops from = { 0 }, to = { 0 };
  vg_status st;

  VG_TRY(loops_of(strip, &from, err));
  to.end = vg_alloc(from.n, sizeof *to.end);
  if (!to.end) {
    st = vg_fail_memory(err, "the edges of a section");
    goto done;
  }
  for (size_t e = 0, first = 0; e < from.n; first = from.end[e++]) {
    VG_TRY(divide_loop(&from, first, from.end[e] - first, strip->patch[e].name,
                       *sizes, shares, &to, &found[e], err));
    to.end[to.n++] = to.n_point;
  }
  st = make_strip(&to, width_of(&to), strip, err);
done:
  release_loops(&from);
  release_loops(&to);
  return st;
}

/* --- sizes --------------------------------------------------------------- */

size_t vg_section_points(const struct vg_mesh *slab)
{
  size_t n = 0;

  while (n < slab->n_point && slab->point[n][2] == 0) n++;
  return n;
}

vg_status vg_section_sizes(const struct vg_mesh *surface, struct vg_mesh *out,
                           struct vg_error *err)
{
  const size_t n = vg_section_points(surface);
  struct vg_mesh view = { .patch = surface->patch,
                          .n_patch = surface->n_patch };
  size_t n_edge = 0;

  view.point = vg_alloc(2 * n + 2, sizeof *view.point);
  view.tri = vg_alloc(n, sizeof *view.tri);
  view.tri_patch = vg_alloc(n, sizeof *view.tri_patch);
  if (!view.point || !view.tri || !view.tri_patch) {
    free(view.point);
    free(view.tri);
    free(view.tri_patch);
    return vg_fail_memory(err, "the sizes of a section");
  }
  memcpy(view.point, surface->point, n * sizeof *view.point);
  for (size_t t = 0; t < surface->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      const uint32_t a = surface->tri[t][k], b = surface->tri[t][(k + 1) % 3];
      const uint32_t o = surface->tri[t][(k + 2) % 3];
      const double *p, *q;
      double *top, len;

      if (a >= n || b >= n || surface->point[o][2] == 0) continue;
      assert(n_edge < n);
      p = view.point[a];
      q = view.point[b];
      len = sqrt((q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]));
      top = view.point[n + n_edge];
      top[0] = 0.5 * (p[0] + q[0]);
      top[1] = 0.5 * (p[1] + q[1]);
      top[2] = SQRT3_HALF * len;
      view.tri[n_edge][0] = a;
      view.tri[n_edge][1] = b;
      view.tri[n_edge][2] = (uint32_t)(n + n_edge);
      view.tri_patch[n_edge++] = surface->tri_patch[t];
    }
  view.n_point = n + n_edge;
  view.n_tri = n_edge;
  *out = view;
  return VG_OK;
}
