/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/topology/topology_wall.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/sides/sides.h"

enum role { INERT, WALL, SLIDE };

/* Data needed only during the build. */
struct build {
  uint8_t *role;         /* [n_patch] enum role. */
  uint32_t *id;          /* [surface n_point] wall point or VG_NO_INDEX. */
  uint32_t *face;        /* [surface n_tri] wall face or VG_NO_INDEX. */
  struct vg_sides sides; /* Of the surface; the fluid is on side 0. */
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
  free(w->cause);
  memset(w, 0, sizeof *w);
}

static void build_release(struct build *b)
{
  free(b->role);
  free(b->id);
  free(b->face);
  vg_sides_release(&b->sides);
}

static vg_status find_roles(const struct vg_mesh *m, const uint8_t *is_wall,
                            size_t n_slide, const struct vg_slide *slide,
                            struct build *b, struct vg_error *err)
{
  if (m->n_tri > UINT32_MAX / 12)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the surface has %zu triangles, but layers support at most "
                   "%u; coarsen the surface",
                   m->n_tri, UINT32_MAX / 12);
  b->role = vg_calloc(m->n_patch, sizeof *b->role);
  b->id = vg_alloc(m->n_point, sizeof *b->id);
  b->face = vg_alloc(m->n_tri, sizeof *b->face);
  if (!b->role || !b->id || !b->face)
    return vg_fail_memory(err, "the patches of the walls");
  memset(b->id, 0xff, m->n_point * sizeof *b->id);
  memset(b->face, 0xff, m->n_tri * sizeof *b->face);
  for (size_t i = 0; i < n_slide; i++) b->role[slide[i].patch] = SLIDE;
  for (size_t i = 0; i < m->n_patch; i++)
    if (is_wall[i]) b->role[i] = WALL;
  return VG_OK;
}

/* Numbers points and faces of the walls in the order of the surface. */
static vg_status number(struct vg_wall *w, struct build *b,
                        struct vg_error *err)
{
  const struct vg_mesh *m = w->surface;
  size_t n = 0;

  for (size_t t = 0; t < m->n_tri; t++)
    if (b->role[m->tri_patch[t]] == WALL) {
      b->face[t] = (uint32_t)w->n_face++;
      for (int k = 0; k < 3; k++) b->id[m->tri[t][k]] = 0;
    }
  for (size_t p = 0; p < m->n_point; p++) w->n_point += b->id[p] == 0;
  w->point = vg_alloc(w->n_point, sizeof *w->point);
  w->tri = vg_alloc(w->n_face, sizeof *w->tri);
  w->face = vg_alloc(w->n_face, sizeof *w->face);
  w->opposite = vg_alloc(3 * w->n_face, sizeof *w->opposite);
  w->slide = vg_alloc(w->n_point, sizeof *w->slide);
  w->start = vg_alloc(w->n_point, sizeof *w->start);
  w->cause = vg_calloc(w->n_point, sizeof *w->cause);
  if (!w->point || !w->tri || !w->face || !w->opposite || !w->slide ||
      !w->start || !w->cause)
    return vg_fail_memory(err, "the points of the walls");
  for (size_t p = 0; p < m->n_point; p++)
    if (b->id[p] == 0) {
      w->point[n] = (uint32_t)p;
      b->id[p] = (uint32_t)n++;
    }
  for (size_t t = 0; t < m->n_tri; t++) {
    uint32_t f = b->face[t];

    if (f == VG_NO_INDEX) continue;
    w->tri[f] = (uint32_t)t;
    for (int k = 0; k < 3; k++) w->face[f][k] = b->id[m->tri[t][k]];
  }
  return VG_OK;
}

/* The half-edge of the surface across half-edge h of a triangle, seen from the
 * fluid; VG_NO_INDEX at an edge with more than two triangles. */
static uint32_t across(const struct vg_sides *s, uint32_t h)
{
  uint32_t g;

  if (vg_edges_count(&s->edge, s->edge.of_half[h]) != 2) return VG_NO_INDEX;
  g = s->across[vg_sides_corner(h, 0)];
  return 3 * (g / 6) + g % 3;
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

static void limit(struct vg_wall *w, size_t p, enum vg_layer_cause cause)
{
  if (w->cause[p] != VG_CAUSE_INNER) w->cause[p] = (uint8_t)cause;
}

static vg_status find_opposites(struct vg_wall *w, const struct build *b,
                                struct vg_error *err)
{
  const struct vg_mesh *m = w->surface;
  size_t cap_half = 0, cap_patch = 0;

  for (uint32_t h = 0; h < 3 * w->n_face; h++) {
    const uint32_t at = 3 * w->tri[h / 3] + h % 3, next = vg_half_next(h);
    const uint32_t g = across(&b->sides, at);
    const int is_shared = g == VG_NO_INDEX;
    uint32_t patch, face;

    w->opposite[h] = VG_NO_INDEX;
    if (is_shared || is_free_edge(m, at, g))
      for (int k = 0; k < 2; k++)
        limit(w, w->face[h / 3][(k ? next : h) % 3],
              is_shared ? VG_CAUSE_SLIDE : VG_CAUSE_INNER);
    if (is_shared) continue;
    face = b->face[g / 3];
    patch = m->tri_patch[g / 3];
    if (face != VG_NO_INDEX) w->opposite[h] = 3 * face + g % 3;
    if (b->role[patch] != SLIDE) continue;
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
  if (s[1] != VG_NO_INDEX) limit(w, p, VG_CAUSE_SLIDE);
  if (patch < s[0]) {
    s[1] = s[0];
    s[0] = patch;
  } else if (patch < s[1]) {
    s[1] = patch;
  }
}

/* Finds the slide patches of a point and the start of its ring of wall faces.
 * All its triangles must be in one sector, and its walls in one ring. */
static void visit_point(struct vg_wall *w, const struct build *b, size_t p)
{
  const struct vg_mesh *m = w->surface;
  const struct vg_sides *s = &b->sides;
  const uint32_t *corner = s->corner + s->first[w->point[p]];
  const uint32_t *end = s->corner + s->first[w->point[p] + 1];
  const uint32_t sector = s->sector[vg_sides_corner(*corner, 0)];
  int n_end = 0;

  w->slide[p][0] = w->slide[p][1] = w->start[p] = VG_NO_INDEX;
  for (; corner < end; corner++) {
    const uint32_t t = *corner / 3, patch = m->tri_patch[t];
    uint32_t h;

    if (s->sector[vg_sides_corner(*corner, 0)] != sector)
      limit(w, p, VG_CAUSE_SLIDE);
    if (b->role[patch] == SLIDE) add_slide(w, p, patch);
    else if (b->role[patch] == INERT)
      limit(w, p, is_inner(m, t) ? VG_CAUSE_INNER : VG_CAUSE_SLIDE);
    if (b->role[patch] != WALL) continue;
    h = 3 * b->face[t] + *corner % 3;
    if (w->start[p] == VG_NO_INDEX || (!n_end && w->opposite[h] == VG_NO_INDEX))
      w->start[p] = h;
    n_end += w->opposite[h] == VG_NO_INDEX;
  }
  if (n_end > 1) limit(w, p, VG_CAUSE_SLIDE);
}

vg_status vg_wall_build(const struct vg_mesh *surface, const uint8_t *is_wall,
                        size_t n_slide, const struct vg_slide *slide,
                        struct vg_wall *out, struct vg_error *err)
{
  vg_status st = VG_OK;
  struct vg_wall w = VG_WALL_INIT;
  struct build b = { NULL, NULL, NULL, VG_SIDES_INIT };

  assert(!out->point && !out->face);
  assert(is_wall || !surface->n_patch);
  w.surface = surface;
  VG_TRY(find_roles(surface, is_wall, n_slide, slide, &b, err));
  VG_TRY(number(&w, &b, err));
  VG_TRY(vg_sides_build(&b.sides, surface->n_point,
                        (const double(*)[3])surface->point, surface->n_tri,
                        (const uint32_t(*)[3])surface->tri, err));
  VG_TRY(find_opposites(&w, &b, err));
  for (size_t p = 0; p < w.n_point; p++) visit_point(&w, &b, p);
  *out = w;
  w = (struct vg_wall)VG_WALL_INIT;
done:
  vg_wall_release(&w);
  build_release(&b);
  return st;
}
