/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/topology/topology_wall.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum role { INERT, WALL, SLIDE };

/* All triangles around wall points, and data needed only during the build. */
struct rings {
  uint8_t *role;    /* [n_patch] enum role. */
  uint32_t *id;     /* [surface n_point] wall point or VG_NO_INDEX. */
  uint32_t *face;   /* [surface n_tri] wall face or VG_NO_INDEX. */
  uint32_t *first;  /* [wall n_point + 1] offsets into corner[]. */
  uint32_t *corner; /* 3 * triangle of the surface + k. */
};

void vg_wall_release(struct vg_wall *w)
{
  free(w->point);
  free(w->tri);
  free(w->face);
  free(w->opposite);
  free(w->border);
  free(w->border_patch);
  free(w->slide);
  free(w->start);
  free(w->blocked);
  memset(w, 0, sizeof *w);
}

static void rings_release(struct rings *r)
{
  free(r->role);
  free(r->id);
  free(r->face);
  free(r->first);
  free(r->corner);
}

static vg_status find_roles(const struct vg_mesh *m, const uint8_t *is_wall,
                            size_t n_slide, const struct vg_slide *slide,
                            struct rings *r, struct vg_error *err)
{
  if (m->n_tri > UINT32_MAX / 12)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the surface has %zu triangles, but layers support at most "
                   "%u; coarsen the surface",
                   m->n_tri, UINT32_MAX / 12);
  r->role = vg_calloc(m->n_patch, sizeof *r->role);
  r->id = vg_alloc(m->n_point, sizeof *r->id);
  r->face = vg_alloc(m->n_tri, sizeof *r->face);
  if (!r->role || !r->id || !r->face)
    return vg_fail_memory(err, "the patches of the walls");
  memset(r->id, 0xff, m->n_point * sizeof *r->id);
  memset(r->face, 0xff, m->n_tri * sizeof *r->face);
  for (size_t i = 0; i < n_slide; i++) r->role[slide[i].patch] = SLIDE;
  for (size_t i = 0; i < m->n_patch; i++)
    if (is_wall[i]) r->role[i] = WALL;
  return VG_OK;
}

/* Numbers points and faces of the walls in the order of the surface. */
static vg_status number(struct vg_wall *w, struct rings *r,
                        struct vg_error *err)
{
  const struct vg_mesh *m = w->surface;
  size_t n = 0;

  for (size_t t = 0; t < m->n_tri; t++)
    if (r->role[m->tri_patch[t]] == WALL) {
      r->face[t] = (uint32_t)w->n_face++;
      for (int k = 0; k < 3; k++) r->id[m->tri[t][k]] = 0;
    }
  for (size_t p = 0; p < m->n_point; p++) w->n_point += r->id[p] == 0;
  w->point = vg_alloc(w->n_point, sizeof *w->point);
  w->tri = vg_alloc(w->n_face, sizeof *w->tri);
  w->face = vg_alloc(w->n_face, sizeof *w->face);
  w->opposite = vg_alloc(3 * w->n_face, sizeof *w->opposite);
  w->slide = vg_alloc(w->n_point, sizeof *w->slide);
  w->start = vg_alloc(w->n_point, sizeof *w->start);
  w->blocked = vg_calloc(w->n_point, sizeof *w->blocked);
  if (!w->point || !w->tri || !w->face || !w->opposite || !w->slide ||
      !w->start || !w->blocked)
    return vg_fail_memory(err, "the points of the walls");
  for (size_t p = 0; p < m->n_point; p++)
    if (r->id[p] == 0) {
      w->point[n] = (uint32_t)p;
      r->id[p] = (uint32_t)n++;
    }
  for (size_t t = 0; t < m->n_tri; t++) {
    uint32_t f = r->face[t];

    if (f == VG_NO_INDEX) continue;
    w->tri[f] = (uint32_t)t;
    for (int k = 0; k < 3; k++) w->face[f][k] = r->id[m->tri[t][k]];
  }
  return VG_OK;
}

/* Corners of all triangles around wall points, by counting sort. */
static vg_status collect_rings(const struct vg_wall *w, struct rings *r,
                               struct vg_error *err)
{
  const struct vg_mesh *m = w->surface;

  r->first = vg_calloc(w->n_point + 2, sizeof *r->first);
  if (!r->first) return vg_fail_memory(err, "the rings of wall points");
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++)
      if (r->id[m->tri[t][k]] != VG_NO_INDEX)
        r->first[r->id[m->tri[t][k]] + 2]++;
  for (size_t i = 2; i <= w->n_point + 1; i++) r->first[i] += r->first[i - 1];
  r->corner = vg_alloc(r->first[w->n_point + 1], sizeof *r->corner);
  if (!r->corner) return vg_fail_memory(err, "the rings of wall points");
  for (size_t t = 0; t < m->n_tri; t++)
    for (uint32_t k = 0; k < 3; k++) {
      uint32_t id = r->id[m->tri[t][k]];

      if (id != VG_NO_INDEX)
        r->corner[r->first[id + 1]++] = 3 * (uint32_t)t + k;
    }
  return VG_OK;
}

/* Half-edge of the surface from b to a (wall points); VG_NO_INDEX unless there
 * is exactly one. Searches the shorter of the two rings, so that points with
 * many neighbours cost no more than others. */
static uint32_t find_reverse(const struct vg_wall *w, const struct rings *r,
                             uint32_t a, uint32_t b)
{
  const struct vg_mesh *m = w->surface;
  int at_a = r->first[a + 1] - r->first[a] < r->first[b + 1] - r->first[b];
  uint32_t at = at_a ? a : b, other = w->point[at_a ? b : a];
  uint32_t found = VG_NO_INDEX;

  for (uint32_t i = r->first[at]; i < r->first[at + 1]; i++) {
    uint32_t h = r->corner[i];
    uint32_t to = at_a ? vg_half_prev(h) : vg_half_next(h);

    if (m->tri[to / 3][to % 3] != other) continue;
    if (found != VG_NO_INDEX) return VG_NO_INDEX;
    found = at_a ? to : h;
  }
  return found;
}

static int is_inner(const struct vg_mesh *m, size_t tri)
{
  return m->patch[m->tri_patch[tri]].inner != VG_INNER_NOT;
}

/* Whether half-edges h and g of the surface, which are opposite, belong to the
 * two sides of one triangle: the free edge of an inner surface. */
static int is_free_edge(const struct vg_mesh *m, uint32_t h, uint32_t g)
{
  const double *a, *b;

  if (!is_inner(m, h / 3) || !is_inner(m, g / 3)) return 0;
  h = vg_half_prev(h);
  g = vg_half_prev(g);
  a = m->point[m->tri[h / 3][h % 3]];
  b = m->point[m->tri[g / 3][g % 3]];
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void block(struct vg_wall *w, size_t p, enum vg_layer_cause why)
{
  if (w->blocked[p] != VG_CAUSE_INNER) w->blocked[p] = (uint8_t)why;
}

static vg_status find_opposites(struct vg_wall *w, const struct rings *r,
                                struct vg_error *err)
{
  const struct vg_mesh *m = w->surface;
  size_t cap_half = 0, cap_patch = 0;

  for (uint32_t h = 0; h < 3 * w->n_face; h++) {
    uint32_t a = w->face[h / 3][h % 3];
    uint32_t next = vg_half_next(h), b = w->face[h / 3][next % 3];
    uint32_t g = find_reverse(w, r, a, b), patch, face;

    w->opposite[h] = VG_NO_INDEX;
    if (g == VG_NO_INDEX) {
      block(w, a, VG_CAUSE_SLIDE);
      block(w, b, VG_CAUSE_SLIDE);
      continue;
    }
    if (is_free_edge(m, 3 * w->tri[h / 3] + h % 3, g)) {
      block(w, a, VG_CAUSE_INNER);
      block(w, b, VG_CAUSE_INNER);
    }
    face = r->face[g / 3];
    patch = m->tri_patch[g / 3];
    if (face != VG_NO_INDEX) w->opposite[h] = 3 * face + g % 3;
    if (r->role[patch] != SLIDE) continue;
    if (vg_reserve(&w->border, &cap_half, w->n_border + 1, sizeof *w->border) <
          0 ||
        vg_reserve(&w->border_patch, &cap_patch, w->n_border + 1,
                   sizeof *w->border_patch) < 0)
      return vg_fail_memory(err, "the boundary edges of the walls");
    w->border[w->n_border] = h;
    w->border_patch[w->n_border++] = patch;
  }
  return VG_OK;
}

/* Adds a slide patch to the sorted patches of point p. */
static void add_slide(struct vg_wall *w, size_t p, uint32_t patch)
{
  uint32_t *s = w->slide[p];

  if (s[0] == patch || s[1] == patch) return;
  if (s[1] != VG_NO_INDEX) block(w, p, VG_CAUSE_SLIDE);
  if (patch < s[0]) {
    s[1] = s[0];
    s[0] = patch;
  } else if (patch < s[1]) {
    s[1] = patch;
  }
}

/* Finds the slide patches of a point, the start of its ring of wall faces, and
 * whether there is only one such ring. */
static void visit_point(struct vg_wall *w, const struct rings *r, size_t p)
{
  const struct vg_mesh *m = w->surface;
  size_t n_corner = 0, n_seen = 0;
  uint32_t h, start = VG_NO_INDEX;
  int is_open = 0;

  w->slide[p][0] = w->slide[p][1] = VG_NO_INDEX;
  for (uint32_t i = r->first[p]; i < r->first[p + 1]; i++) {
    uint32_t t = r->corner[i] / 3, patch = m->tri_patch[t];

    if (r->role[patch] == SLIDE) add_slide(w, p, patch);
    else if (r->role[patch] == INERT)
      block(w, p, is_inner(m, t) ? VG_CAUSE_INNER : VG_CAUSE_SLIDE);
    if (r->face[t] == VG_NO_INDEX) continue;
    h = 3 * r->face[t] + r->corner[i] % 3;
    n_corner++;
    if (start == VG_NO_INDEX || (!is_open && w->opposite[h] == VG_NO_INDEX)) {
      start = h;
      is_open = w->opposite[h] == VG_NO_INDEX;
    }
  }
  w->start[p] = h = start;
  do {
    n_seen++;
    h = vg_wall_turn(w, h);
  } while (h != VG_NO_INDEX && h != start && n_seen < n_corner);
  if (n_seen != n_corner || (h != VG_NO_INDEX && h != start)) {
    block(w, p, VG_CAUSE_SLIDE);
  } else if (h == start && n_corner < r->first[p + 1] - r->first[p]) {
    block(w, p, VG_CAUSE_SLIDE); /* Another sheet touches a closed ring. */
  }
}

vg_status vg_wall_build(const struct vg_mesh *surface, const uint8_t *is_wall,
                        size_t n_slide, const struct vg_slide *slide,
                        struct vg_wall *out, struct vg_error *err)
{
  vg_status st = VG_OK;
  struct vg_wall w = VG_WALL_INIT;
  struct rings r = { NULL, NULL, NULL, NULL, NULL };

  assert(!out->point && !out->face);
  assert(is_wall || !surface->n_patch);
  w.surface = surface;
  VG_TRY(find_roles(surface, is_wall, n_slide, slide, &r, err));
  VG_TRY(number(&w, &r, err));
  VG_TRY(collect_rings(&w, &r, err));
  VG_TRY(find_opposites(&w, &r, err));
  for (size_t p = 0; p < w.n_point; p++) visit_point(&w, &r, p);
  *out = w;
  w = (struct vg_wall)VG_WALL_INIT;
done:
  vg_wall_release(&w);
  rings_release(&r);
  return st;
}
