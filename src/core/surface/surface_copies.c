/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Classifies regions of faces with the same three nodes. A region consists of
 * such faces that are connected through common edges. The other faces at its
 * border distinguish a duplicated piece of a skin (one other face at each edge)
 * from a wall shared by two bodies (two others), whatever the orientation in
 * the file. */
#include "core/surface/surface_parts.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/union_find.h"

/* Edges on the border of a region, and properties of its groups; bits. */
enum {
  BORDER_NONE = 1, /* An edge without any other face. */
  BORDER_ONE = 2,
  BORDER_TWO = 4,
  BORDER_MORE = 8,
  NOT_PAIRS = 16, /* Three or more faces with the same nodes. */
  OPPOSITE = 32   /* Two faces that face opposite sides. */
};

struct regions {
  const struct vg_faces *s;
  const uint32_t *first;
  uint32_t *n;     /* [s->n] Number of faces with the nodes of each first
                      face. */
  uint32_t *up;    /* [s->n] Union-find of first faces. */
  uint8_t *border; /* [s->n] Bits above, at the roots. */
};

static int is_multiple(const struct regions *x, uint32_t h)
{
  return x->n[x->first[h / 3]] > 1;
}

/* Join the groups at one edge. All edges are joined before borders are
 * examined, so that the roots are final. */
static void join_edge(struct regions *x, const struct vg_edges *e, size_t edge)
{
  uint32_t last = UINT32_MAX;

  for (uint32_t i = e->start[edge]; i < e->start[edge + 1]; i++) {
    if (!is_multiple(x, e->half[i])) continue;
    if (last != UINT32_MAX) vg_union(x->up, last, x->first[e->half[i] / 3]);
    last = x->first[e->half[i] / 3];
  }
}

/* An edge in which two or more groups of a region meet is not on its border,
 * unless there are single faces at the edge. */
static void inspect_edge(struct regions *x, const struct vg_edges *e,
                         size_t edge)
{
  static const uint8_t border[] = { BORDER_NONE, BORDER_ONE, BORDER_TWO,
                                    BORDER_MORE };
  size_t n_single = 0, n_group = 0;
  uint32_t root = UINT32_MAX;

  for (uint32_t i = e->start[edge]; i < e->start[edge + 1]; i++) {
    uint32_t f = e->half[i] / 3;

    if (!is_multiple(x, e->half[i])) {
      n_single++;
    } else if (x->first[f] == f) {
      n_group++;
      root = vg_root_of(x->up, f);
    }
  }
  if (root == UINT32_MAX || (n_group > 1 && !n_single)) return;
  x->border[root] |= border[n_single < 3 ? n_single : 3];
}

static enum vg_copy class_of(uint8_t bits)
{
  const uint8_t border = bits &
                         (BORDER_NONE | BORDER_ONE | BORDER_TWO | BORDER_MORE);

  if (border == BORDER_TWO && !(bits & NOT_PAIRS)) return VG_COPY_WALL;
  if (border & (BORDER_TWO | BORDER_MORE))
    return border & BORDER_NONE ? VG_COPY_OTHER : VG_COPY_PART;
  if (border == BORDER_NONE && bits & OPPOSITE) return VG_COPY_OTHER;
  return VG_COPY_SKIN;
}

static vg_status allocate(struct regions *x, uint8_t **copy,
                          struct vg_error *err)
{
  size_t n = x->s->n;

  x->n = vg_calloc(n, sizeof *x->n);
  x->up = vg_alloc(n, sizeof *x->up);
  x->border = vg_calloc(n, 1);
  *copy = vg_calloc(n, 1);
  if (x->n && x->up && x->border && *copy) return VG_OK;
  free(*copy);
  *copy = NULL;
  return vg_fail_memory(err, "the doubled triangles");
}

static void inspect_groups(struct regions *x)
{
  const struct vg_faces *s = x->s;

  for (uint32_t f = 0; f < s->n; f++) {
    uint32_t g = x->first[f], root = vg_root_of(x->up, g);

    if (g == f) continue;
    if (x->n[g] > 2) x->border[root] |= NOT_PAIRS;
    if (!vg_faces_same_side(s->node[g], s->node[f]))
      x->border[root] |= OPPOSITE;
  }
}

vg_status vg_faces_copies(const struct vg_faces *s, const uint32_t *first,
                          uint8_t **copy, struct vg_error *err)
{
  struct regions x = { .s = s, .first = first };
  struct vg_edges e = VG_EDGES_INIT;
  uint8_t *out = NULL;
  vg_status st;

  assert((first || !s->n) && copy);
  VG_TRY(allocate(&x, &out, err));
  VG_TRY(vg_faces_edges(s, &e, err));
  for (uint32_t f = 0; f < s->n; f++) {
    x.up[f] = f;
    if (!(s->state[f] & VG_FACE_OUT)) x.n[first[f]]++;
  }
  for (size_t i = 0; i < e.n; i++) join_edge(&x, &e, i);
  inspect_groups(&x);
  for (size_t i = 0; i < e.n; i++) inspect_edge(&x, &e, i);
  for (uint32_t f = 0; f < s->n; f++)
    if (!(s->state[f] & VG_FACE_OUT) && x.n[first[f]] > 1)
      out[f] = (uint8_t)class_of(x.border[vg_root_of(x.up, first[f])]);
  *copy = out;
  out = NULL;
done:
  vg_edges_release(&e);
  free(x.n);
  free(x.up);
  free(x.border);
  free(out);
  return st;
}
