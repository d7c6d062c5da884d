/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Matching of faces by columns of cells, which layers consist of.
 *
 * A column has three lines of points, one for each of the first three nodes of
 * its cells. Each cell raises one line: its fourth node is the next point of
 * that line, and takes the place of the line's node in the next cell. The cell
 * thus shares a face with the next one, and has a face on each of the two sides
 * at the raised line. The faces on a side form a strip from the first cell
 * upwards. A neighbouring column has the same strip in the same order, so that
 * only the first faces of strips are searched. The other ones are compared in
 * turn until they differ, and those that remain are added one by one. The line
 * that the last cell raises is not known; its faces, except the lowest one, are
 * added one by one, too. */
#include <assert.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/judge/quality_pairs_parts.h"

/* The line that a cell raises, if the cell `is` stands on it. */
static inline uint32_t raised(const uint32_t was[4], const uint32_t is[4])
{
  return is[0] != was[0] ? 0 : is[1] != was[1] ? 1 : 2;
}

static int stands_on(const uint32_t is[4], const uint32_t was[4])
{
  return (is[0] == was[0]) + (is[1] == was[1]) + (is[2] == was[2]) == 2 &&
         is[raised(was, is)] == was[3];
}

size_t vg_column_length(const struct vg_mesh *m, size_t cell)
{
  size_t end = cell + 1;

  while (end < m->n_tet && stands_on(m->tet[end], m->tet[end - 1])) end++;
  return end - cell;
}

/* --- strips --------------------------------------------------------------- */

/* A face of a strip: from the raised line's node to the fourth node of the cell
 * and to the other line's node. */
struct rung {
  uint32_t from, to, other;
  uint32_t owner; /* 2 * cell + side, as in quality_pairs.c for the order from,
                     to, other. */
};

/* Find the next face of the strip. Returns 0 at its end. In vg_faces_of_tet, a
 * face opposite the node in position k has side k & 1 in the order of the
 * positions. From that follows side 1 in the order from, to, other if `other`
 * is the line after the raised one, in cyclic order. */
static inline int next_rung(const struct vg_mesh *m, struct vg_strip *s,
                            struct rung *r)
{
  uint32_t before = (s->side + 1) % 3;

  while (s->n) {
    const uint32_t *node = m->tet[s->cell];
    uint32_t line = raised(node, m->tet[s->cell + 1]);
    uint32_t cell = s->cell++, other = 3 - line - s->side;

    s->n--;
    if (line == s->side) continue;
    *r = (struct rung){ node[line], node[3], node[other],
                        2 * cell + (line == before) };
    return 1;
  }
  return 0;
}

/* The face as it is entered in tables. */
static struct vg_face face_of(const struct rung *r)
{
  uint32_t v[3] = { r->from, r->to, r->other };
  uint32_t owner = r->owner ^ vg_order3(v);

  return (struct vg_face){ (uint64_t)v[0] << 32 | v[1], v[2], owner };
}

static void add_rung(struct vg_pairing *p, const struct rung *r)
{
  struct vg_face f = face_of(r);

  vg_pairing_add(p, &f);
}

static void add_strip(struct vg_pairing *p, struct vg_strip s)
{
  struct rung r;

  while (!p->face.refused && next_rung(p->m, &s, &r)) add_rung(p, &r);
}

static inline int is_same(const struct rung *a, const struct rung *b)
{
  return a->from == b->from && a->to == b->to && a->other == b->other;
}

/* Match two strips from their first faces on. */
static void match(struct vg_pairing *p, struct vg_strip a, struct vg_strip b)
{
  struct vg_counts *n = &p->f->n;
  struct rung r, q;
  uint32_t first = a.cell, second = b.cell;
  int more, other = 0;
  size_t n_same = 0;

  while ((more = next_rung(p->m, &a, &r)) &&
         (other = next_rung(p->m, &b, &q)) && is_same(&r, &q)) {
    n->same_side_face += !((r.owner ^ q.owner) & 1);
    vg_pairing_join(p, r.owner >> 1, q.owner >> 1);
    n_same++;
    other = 0;
  }
  n->n_inner_face += n_same;
  if (n_same) vg_union(p->parent, first, second);
  if (more) add_rung(p, &r);
  if (other) add_rung(p, &q);
  add_strip(p, a);
  add_strip(p, b);
}

static void add_side(struct vg_pairing *p, struct vg_strip s)
{
  struct vg_strip rest = s;
  struct rung r;
  struct vg_face first;
  uint32_t other;

  if (!next_rung(p->m, &rest, &r)) return;
  /* Before `first`, which would refer to a strip that is not kept. */
  if (vg_reserve(&p->strip, &p->cap_strip, p->n_strip + 1, sizeof *p->strip)) {
    p->refused = 1;
    return;
  }
  first = face_of(&r);
  first.owner = (uint32_t)p->n_strip;
  other = vg_waiting_meet(&p->first, &first);
  if (other != VG_NOBODY) match(p, p->strip[other], s);
  else p->strip[p->n_strip++] = s;
}

void vg_pairing_end_columns(struct vg_pairing *p)
{
  for (size_t i = 0; i <= p->first.mask; i++)
    for (int k = 0; k < VG_FACE_SLOTS && !p->face.refused; k++)
      if (p->first.bucket[i].high[k] != VG_NOBODY)
        add_strip(p, p->strip[p->first.bucket[i].owner[k]]);
}

/* --- columns -------------------------------------------------------------- */

/* Add the face of a tetrahedron opposite a node. */
static void add_opposite(struct vg_pairing *p, size_t cell, uint32_t node)
{
  const uint32_t *n = p->m->tet[cell];
  struct vg_face f[4];
  int lower = 0;

  for (int k = 0; k < 4; k++) lower += n[k] < node;
  vg_faces_of_tet(n, (uint32_t)cell, f);
  vg_pairing_add(p, &f[3 - lower]);
}

/* The common faces of consecutive cells always have them on both sides: the
 * face opposite a node of the lower cell has the same nodes in the same
 * positions as that opposite the fourth node of the upper one, with the fourth
 * node of the lower cell in place of the missing one, which reverses it. */
void vg_pairing_add_column(struct vg_pairing *p, size_t cell, size_t n)
{
  const struct vg_mesh *m = p->m;
  size_t last = cell + n - 1;

  assert(n > 1 && last < m->n_tet);
  for (size_t i = cell; i < last; i++) {
    p->parent[i + 1] = (uint32_t)cell;
    vg_pairing_join(p, (uint32_t)i, (uint32_t)i + 1);
  }
  p->f->n.n_inner_face += n - 1;
  add_opposite(p, cell, m->tet[cell][3]);
  for (uint32_t side = 0; side < 3; side++)
    add_side(p, (struct vg_strip){ (uint32_t)cell, (uint32_t)n - 1, side });
  for (int k = 0; k < 3; k++) add_opposite(p, last, m->tet[last][k]);
}
