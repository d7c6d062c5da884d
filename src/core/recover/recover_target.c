/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Recovery of one edge or triangle of a surface: its obstructions are searched
 * for from its first point and removed by flips. */
#include <assert.h>

#include "core/recover/recover_flip.h"

#include "base/memory.h"
#include "core/geometry/predicates.h"

enum { SEEN_MAX = 4096, HINDRANCE_MAX = 64, WALK_MAX = 1000 };

/* Number of edge stars to examine for one edge or triangle, by depth. */
static const int budget[4] = { 60, 200, 600, 2000 }; /* K2 */

/* A face of a cell, or an edge of a cell. */
struct hindrance {
  uint32_t c, a, b;
  int i;
};

struct hindrances {
  int n;
  struct hindrance list[HINDRANCE_MAX];
};

/* --- cells of one search -------------------------------------------------- */

static void see(struct vg_flipper *f, uint32_t link)
{
  uint32_t c = link >> 2;

  if (link == VG_NONE || f->t->flag[c] & VG_TRIED || f->n_seen == SEEN_MAX)
    return;
  if (vg_reserve(&f->seen, &f->cap_seen, f->n_seen + 1, sizeof *f->seen)) {
    f->refused = 1;
    return;
  }
  f->t->flag[c] |= VG_TRIED;
  f->seen[f->n_seen++] = c;
}

static void forget(struct vg_flipper *f)
{
  for (size_t k = 0; k < f->n_seen; k++)
    f->t->flag[f->seen[k]] &= (uint8_t)~VG_TRIED;
}

/* The cell at point p in which the segment from p to q begins; found by a walk
 * from any cell at p. It has the corner q if p and q are neighbours. */
static uint32_t towards(const struct vg_flipper *f, uint32_t p, uint32_t q)
{
  const struct vg_tets *t = f->t;
  uint32_t c = f->star[p];

  for (uint32_t step = 0; c != VG_NONE && step < WALK_MAX; step++) {
    const struct vg_cell *at = &t->cell[c];
    uint32_t turn = vg_walk_turn(step), k = 0;

    for (; k < 4; k++) {
      uint32_t i = (turn + k) & 3;
      const uint8_t *g = vg_face[i];

      if (at->v[i] == p) continue;
      if (vg_orient3d(t->x[at->v[g[0]]], t->x[at->v[g[1]]], t->x[at->v[g[2]]],
                      t->x[q]) >= 0)
        continue;
      if (at->link[i] == VG_NONE) return VG_NONE;
      c = at->link[i] >> 2;
      break;
    }
    if (k == 4) return c;
  }
  return VG_NONE;
}

static int has(const struct vg_cell *c, uint32_t p)
{
  return c->v[0] == p || c->v[1] == p || c->v[2] == p || c->v[3] == p;
}

/* Find the cells from which the search starts: the one in which the edge
 * begins, or those around the first edge of the triangle. Returns 1 if one of
 * them has all points of the target, -1 if there are no such cells. */
static int start_search(struct vg_flipper *f)
{
  const struct vg_tets *t = f->t;
  uint32_t c = towards(f, f->target[0], f->target[1]);

  f->n_seen = 0;
  if (c == VG_NONE) return -1;
  see(f, 4 * c);
  if (f->n_target == 2) return has(&t->cell[c], f->target[1]);
  if (!has(&t->cell[c], f->target[1])) return -1;
  for (size_t m = 0; m < f->n_seen; m++) {
    const struct vg_cell *at = &t->cell[f->seen[m]];

    if (has(at, f->target[2])) return 1;
    for (int i = 0; i < 4; i++)
      if (at->v[i] != f->target[0] && at->v[i] != f->target[1])
        see(f, at->link[i]);
  }
  return 0;
}

/* --- obstructions --------------------------------------------------------- */

/* Faces that the edge crosses, beginning at its first point. */
static void faces_in_the_way(struct vg_flipper *f, struct hindrances *h)
{
  const struct vg_tets *t = f->t;

  for (size_t m = 0; m < f->n_seen; m++) {
    uint32_t c = f->seen[m];

    for (int i = 0; i < 4; i++) {
      const struct vg_cell *at = &t->cell[c];
      const uint8_t *g = vg_face[i];

      if (at->link[i] == VG_NONE || h->n == HINDRANCE_MAX ||
          !vg_flip_obstructs(f, at->v[g[0]], at->v[g[1]], at->v[g[2]]))
        continue;
      see(f, at->link[i]);
      if (4 * c + (uint32_t)i < at->link[i])
        h->list[h->n++] = (struct hindrance){ .c = c, .i = i };
    }
  }
}

static void add_edge(struct hindrances *h, uint32_t c, uint32_t a, uint32_t b)
{
  for (int k = 0; k < h->n; k++)
    if ((h->list[k].a == a && h->list[k].b == b) ||
        (h->list[k].a == b && h->list[k].b == a))
      return;
  if (h->n < HINDRANCE_MAX)
    h->list[h->n++] = (struct hindrance){ .c = c, .a = a, .b = b };
}

/* Edges that pierce the triangle. */
static void edges_in_the_way(struct vg_flipper *f, struct hindrances *h)
{
  const struct vg_tets *t = f->t;

  for (size_t m = 0; m < f->n_seen; m++) {
    uint32_t c = f->seen[m];

    for (int i = 0; i < 4; i++)
      for (int j = i + 1; j < 4; j++) {
        const struct vg_cell *at = &t->cell[c];

        if (!vg_flip_pierces(f, at->v[i], at->v[j])) continue;
        add_edge(h, c, at->v[i], at->v[j]);
        for (int k = 0; k < 4; k++)
          if (k != i && k != j) see(f, at->link[k]);
      }
  }
}

/* --- one step ------------------------------------------------------------- */

/* The functions below return 1 if cells have changed. */

static int flip_faces(struct vg_flipper *f, const struct hindrances *h)
{
  for (int k = 0; k < h->n; k++)
    if (vg_flip_face(f, h->list[k].c, h->list[k].i)) return 1;
  return 0;
}

static int flip_edges_of_faces(struct vg_flipper *f, const struct hindrances *h,
                               int depth)
{
  for (int k = 0; k < h->n; k++) {
    uint32_t c = h->list[k].c, v[3];

    for (int m = 0; m < 3; m++)
      v[m] = f->t->cell[c].v[vg_face[h->list[k].i][m]];
    for (int m = 0; m < 3; m++)
      if (vg_flip_edge(f, c, v[m], v[(m + 1) % 3], depth)) return 1;
  }
  return 0;
}

static int flip_edges(struct vg_flipper *f, const struct hindrances *h,
                      int depth)
{
  for (int k = 0; k < h->n; k++)
    if (vg_flip_edge(f, h->list[k].c, h->list[k].a, h->list[k].b, depth))
      return 1;
  return 0;
}

static int make(struct vg_flipper *f, int depth)
{
  int there = 0, changed = 1;

  while (!there && changed && f->budget > 0 && !f->refused) {
    struct hindrances h;

    h.n = 0;
    there = start_search(f);
    if (!there && f->n_target == 2) faces_in_the_way(f, &h);
    if (!there && f->n_target == 3) edges_in_the_way(f, &h);
    forget(f);
    if (there) break;
    if (f->n_target == 2)
      changed = flip_faces(f, &h) || flip_edges_of_faces(f, &h, depth);
    else changed = flip_edges(f, &h, depth);
  }
  return there == 1;
}

int vg_flip_has_edge(const struct vg_flipper *f, uint32_t a, uint32_t b)
{
  assert(a != b);

  uint32_t c = towards(f, a, b);

  return c != VG_NONE && has(&f->t->cell[c], b);
}

int vg_flip_make_edge(struct vg_flipper *f, uint32_t a, uint32_t b, int depth)
{
  assert(a != b && depth >= 0 && depth <= 3);
  f->n_target = 2;
  f->target[0] = a;
  f->target[1] = b;
  f->budget = budget[depth];
  return make(f, depth);
}

int vg_flip_make_tri(struct vg_flipper *f, const uint32_t v[3], int depth)
{
  assert(depth >= 0);
  assert(vg_flip_has_edge(f, v[0], v[1]));
  assert(vg_flip_has_edge(f, v[1], v[2]));
  assert(vg_flip_has_edge(f, v[2], v[0]));
  f->n_target = 3;
  for (int k = 0; k < 3; k++) f->target[k] = v[k];
  f->budget = budget[depth];
  return make(f, depth);
}
