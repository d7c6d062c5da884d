/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cells of wall faces, and the side faces at boundary edges, from the wall
 * upwards.
 *
 * All tetrahedra: columns are raised one at a time, by increasing number.
 * Mixed: the columns of a face are raised together, which makes a prism, or a
 * pyramid if two are raised, or a tetrahedron if one is. However, two columns
 * of one root are the same point at level 0, and a prism on a face with two
 * such columns would have five points and two quadrilaterals that share two
 * edges, which is not a valid cell. At level 0, columns with such faces are
 * therefore raised after the others, one at a time, unless the faces are in
 * pairs, which have cells of their own (pairs.h). Whichever points of the
 * face coincide, the resulting cells are tetrahedra, or cells with a repeated
 * point, which are omitted. The order depends only on the columns, so both
 * sides of a side face agree. */
#include "layers/expand/expand.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "layers/expand/expand_parts.h"
#include "layers/expand/join.h"
#include "layers/expand/pairs.h"

/* Blocks of faces that a thread takes at a time. */
#define BLOCK_GRAIN 8

/* Corners of a face by increasing column number, indexed by which of f0 < f1,
 * f1 < f2, f2 < f0 hold (bits 0, 1, 2; none or all is impossible). */
static const uint8_t rising[8][3] = {
  { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 0, 1, 2 },
  { 2, 1, 0 }, { 2, 0, 1 }, { 1, 2, 0 }, { 0, 1, 2 },
};

static const uint8_t *order_of(const uint32_t f[3])
{
  return rising[(f[0] < f[1]) | (f[1] < f[2]) << 1 | (f[2] < f[0]) << 2];
}

static inline void put_tet(struct vg_cell_sink *s, const uint32_t p[3],
                           uint32_t top)
{
  uint32_t *n = *s->tet++;

  n[0] = p[0];
  n[1] = p[1];
  n[2] = p[2];
  n[3] = top;
}

/* A solver that splits the quadrilaterals of a prism from node 0 on (0 1 2 3, 1
 * 2 3 4, 2 3 4 5) should split the quadrilaterals of neighbouring prisms in the
 * same way. An order by increasing column number would achieve that, but half
 * of the faces have the opposite orientation, in which the splits of one of two
 * edges must disagree. These edges alternate, so that the volumes of warped
 * side faces cancel. */
static int first_corner(const uint32_t f[3])
{
  const uint8_t *o = order_of(f);
  int turns_well = (o[0] + 1) % 3 == o[1];

  return turns_well || ((f[0] ^ f[1] ^ f[2]) & 1) ? o[0] : o[1];
}

static inline void put_prism(struct vg_cell_sink *s, int first,
                             const uint32_t p[3], const uint32_t h[3])
{
  uint32_t *n = *s->pri++;

  for (int k = 0; k < 3; k++) {
    n[k] = p[(first + k) % 3];
    n[3 + k] = h[(first + k) % 3];
  }
}

/* A prism in which corner w is not raised. */
static void put_pyramid(struct vg_cell_sink *s, const uint32_t p[3],
                        const uint32_t h[3], int w)
{
  uint32_t *n = *s->pyr++;
  int u = (w + 1) % 3, v = (w + 2) % 3;

  n[0] = p[u];
  n[1] = p[v];
  n[2] = p[w];
  n[3] = h[u];
  n[4] = h[v];
}

/* The lift rule for points that may coincide. */
static void lift(struct vg_cell_sink *s, uint32_t p[3], uint32_t top, int k)
{
  if (p[0] != p[1] && p[1] != p[2] && p[2] != p[0]) put_tet(s, p, top);
  p[k] = top;
}

/* Raises the corners in the mask that have the next level together; their roots
 * differ. */
static void rise_together(struct vg_cell_sink *s, const uint32_t f[3],
                          uint32_t p[3], const uint32_t h[3], unsigned mask)
{
  int n = 0, last = 0, rest = 0;

  for (int k = 0; k < 3; k++)
    if (mask >> k & 1 && h[k] != VG_NO_INDEX) n++, last = k;
    else rest = k;
  if (n == 3) put_prism(s, first_corner(f), p, h);
  else if (n == 2) put_pyramid(s, p, h, rest);
  else if (n == 1) put_tet(s, p, h[last]);
  for (int k = 0; k < 3; k++)
    if (mask >> k & 1 && h[k] != VG_NO_INDEX) p[k] = h[k];
}

/* Points p are at level 0. Corners in the mask share their root with no other
 * column, so if the mask has two of them all points differ. */
static void rise_from_wall(const uint32_t f[3], unsigned together,
                           uint32_t p[3], const uint32_t h[3],
                           struct vg_cell_sink *s)
{
  const uint8_t *order = order_of(f);

  if (together & (together - 1)) rise_together(s, f, p, h, together);
  else
    for (int k = 0; k < 3; k++)
      if (together >> k & 1 && h[k] != VG_NO_INDEX) lift(s, p, h[k], k);
  for (int i = 0; i < 3; i++) {
    int k = order[i];

    if (!(together >> k & 1) && h[k] != VG_NO_INDEX) lift(s, p, h[k], k);
  }
}

static inline void rise_one_by_one(const uint32_t f[3], uint32_t p[3],
                                   const uint32_t h[3], struct vg_cell_sink *s)
{
  const uint8_t *order = order_of(f);

  for (int i = 0; i < 3; i++) {
    int k = order[i];

    if (h[k] == VG_NO_INDEX) continue;
    put_tet(s, p, h[k]);
    p[k] = h[k];
  }
}

/* Corners of a face that are raised together from the wall, in mixed mode: no
 * mark, and no corner of the same root. */
static unsigned alone(const struct vg_expand *e, const uint32_t f[3])
{
  const struct vg_column *c = e->columns->column;
  unsigned mask = 0;

  for (int k = 0; k < 3 && e->mixed; k++) {
    const uint32_t root = c[f[k]].root;

    mask |= (unsigned)(!(e->mark[f[k]] & VG_MARK_SHARED) &&
                       root != c[f[(k + 1) % 3]].root &&
                       root != c[f[(k + 2) % 3]].root)
         << k;
  }
  return mask;
}

void vg_expand_wall(const struct vg_expand *e, const uint32_t f[3],
                    const uint32_t foot[3], const uint32_t base[3],
                    struct vg_cell_sink *s)
{
  uint32_t p[3] = { foot[0], foot[1], foot[2] }, h[3];

  for (int k = 0; k < 3; k++)
    h[k] = vg_mark_n(e->mark[f[k]]) ? base[k] : VG_NO_INDEX;
  rise_from_wall(f, alone(e, f), p, h, s);
}

int vg_expand_corners(const struct vg_expand *e, size_t face,
                      uint32_t column[4])
{
  if (!e->partner || e->partner[face] == VG_NO_INDEX) {
    memcpy(column, e->columns->face[face], 3 * sizeof *column);
    return 3;
  }
  if (!vg_pair_is_first(e, face)) return 0;
  vg_pair_corners(e, face, column);
  return 4;
}

/* How a pair begins at the wall. Columns with a mark are raised after the
 * others; if both roots have one, the lower columns are raised first, as on the
 * faces next to them. */
static enum vg_pair_start start_of(const struct vg_expand *e, size_t face,
                                   const uint32_t q[4])
{
  const int a = (e->mark[q[0]] & VG_MARK_SHARED) != 0;
  const int b = (e->mark[q[2]] & VG_MARK_SHARED) != 0;

  if (e->columns->face_tri[face] != VG_NO_INDEX) return VG_PAIR_ON_WALL;
  if (!a && !b) return VG_PAIR_TOGETHER;
  if (a != b) return b ? VG_PAIR_FIRST_ROOT : VG_PAIR_SECOND_ROOT;
  return q[0] < q[2] ? VG_PAIR_FIRST_ROOT : VG_PAIR_SECOND_ROOT;
}

static unsigned levels_of(const struct vg_expand *e, const uint32_t f[3],
                          unsigned n[3])
{
  unsigned low = VG_LEVELS_MAX;

  for (int k = 0; k < 3; k++) {
    n[k] = vg_mark_n(e->mark[f[k]]);
    if (n[k] < low) low = n[k];
  }
  return low;
}

/* n_level levels above which all three columns have a further level. */
static void whole_levels(int mixed, const uint32_t f[3], unsigned n_level,
                         uint32_t p[3], struct vg_cell_sink *s)
{
  const uint8_t *order = order_of(f);
  int first = first_corner(f);

  for (unsigned l = 0; l < n_level; l++)
    if (mixed) {
      const uint32_t h[3] = { p[0] + 1, p[1] + 1, p[2] + 1 };

      put_prism(s, first, p, h);
      memcpy(p, h, sizeof h);
    } else
      for (int i = 0; i < 3; i++) {
        uint32_t *v = &p[order[i]];

        put_tet(s, p, *v + 1);
        ++*v;
      }
}

/* Two columns of one root without levels: columns raised next to them make no
 * cells. */
static int is_edge(const uint32_t p[3])
{
  return p[0] == p[1] || p[1] == p[2] || p[2] == p[0];
}

/* Levels from l >= 1 on above which at least one column has ended. The point of
 * such a column stays, and the cells of the other columns meet there. */
static void other_levels(int mixed, const uint32_t f[3], const unsigned n[3],
                         unsigned l, uint32_t p[3], struct vg_cell_sink *s)
{
  if (is_edge(p)) return;
  for (; n[0] > l || n[1] > l || n[2] > l; l++) {
    uint32_t h[3];

    for (int k = 0; k < 3; k++) h[k] = n[k] > l ? p[k] + 1 : VG_NO_INDEX;
    if (mixed) rise_together(s, f, p, h, 7);
    else rise_one_by_one(f, p, h, s);
  }
}

/* The levels of both faces of a pair above those of its lowest column. */
static void above_pair(const struct vg_expand *e, const size_t pair[2],
                       const uint32_t q[4], const uint32_t base[4],
                       struct vg_cell_sink *s)
{
  const unsigned low = vg_pair_levels(e, q);

  for (int i = 0; i < 2; i++) {
    const uint32_t *f = e->columns->face[pair[i]];
    uint32_t p[3];
    unsigned n[3];

    levels_of(e, f, n);
    for (int k = 0; k < 3; k++) {
      int j = 0;

      while (q[j] != f[k]) j++;
      p[k] = base[j] + low - 1;
    }
    other_levels(e->mixed, f, n, low, p, s);
  }
}

static void single_face(const struct vg_expand *e, size_t face,
                        const uint32_t foot[3], const uint32_t base[3],
                        struct vg_cell_sink *s)
{
  const uint32_t *f = e->columns->face[face];
  uint32_t p[3] = { foot[0], foot[1], foot[2] }, h[3];
  unsigned n[3], low = levels_of(e, f, n);

  for (int k = 0; k < 3; k++) h[k] = n[k] ? base[k] : VG_NO_INDEX;
  rise_from_wall(f, alone(e, f), p, h, s);
  if (low > 1) whole_levels(e->mixed, f, low - 1, p, s);
  other_levels(e->mixed, f, n, low ? low : 1, p, s);
}

void vg_expand_face(const struct vg_expand *e, size_t face,
                    const uint32_t foot[4], const uint32_t base[4],
                    uint32_t middle, struct vg_cell_sink *s)
{
  assert(face < e->columns->n_face && s);

  size_t pair[2] = { face, 0 };
  uint32_t q[4];

  switch (vg_expand_corners(e, face, q)) {
  case 3: single_face(e, face, foot, base, s); break;
  case 4:
    pair[1] = e->partner[face];
    vg_expand_pair(e, pair, q, start_of(e, pair[0], q), foot, base, middle, s);
    above_pair(e, pair, q, base, s);
    break;
  }
}

/* The cell on top of a face of a pair, without columns above the lowest of the
 * pair, is a tetrahedron of the top and the middle. */
static int top_of_pair(const struct vg_expand *e, size_t face, unsigned high,
                       uint32_t node[6])
{
  static const uint32_t tet[4] = { 3, 5, 4, 6 };
  const size_t first = face < e->partner[face] ? face : e->partner[face];
  uint32_t q[4];

  vg_pair_corners(e, first, q);
  if (vg_pair_levels(e, q) < high) return 0;
  memcpy(node, tet, sizeof tet);
  return 4;
}

/* Corners at level 0, with those of one root merged. */
static void merge_roots(const struct vg_columns *c, const uint32_t f[3],
                        uint32_t p[3])
{
  for (int k = 2; k >= 0; k--) {
    p[k] = (uint32_t)k;
    for (int i = 2; i > k; i--)
      if (c->column[f[i]].root == c->column[f[k]].root) p[i] = p[k];
  }
}

/* The cell that is made last has the top. */
int vg_expand_top(const struct vg_expand *e, size_t face, uint32_t node[6])
{
  assert(face < e->columns->n_face);

  const uint32_t *f = e->columns->face[face];
  uint32_t tet[3][4], pyr[1][5], pri[1][6], p[3], h[3];
  struct vg_cell_sink s = { tet, pyr, pri, NULL };
  unsigned n[3], high = 0;

  levels_of(e, f, n);
  for (int k = 0; k < 3; k++) high = n[k] > high ? n[k] : high;
  if (!high) return 0;
  if (e->partner && e->partner[face] != VG_NO_INDEX &&
      top_of_pair(e, face, high, node))
    return 4;
  merge_roots(e->columns, f, p);
  for (int k = 0; k < 3; k++) {
    h[k] = n[k] == high ? (uint32_t)k + 3 : VG_NO_INDEX;
    if (n[k] && high > 1) p[k] = (uint32_t)k + (n[k] < high ? 3 : 0);
  }
  if (high == 1) rise_from_wall(f, alone(e, f), p, h, &s);
  else if (!is_edge(p)) {
    if (e->mixed) rise_together(&s, f, p, h, 7);
    else rise_one_by_one(f, p, h, &s);
  }
  if (s.tet > tet) memcpy(node, s.tet[-1], sizeof *tet);
  else if (s.pyr > pyr) memcpy(node, pyr, sizeof *pyr);
  else if (s.pri > pri) memcpy(node, pri, sizeof *pri);
  return s.tet > tet ? 4 : s.pyr > pyr ? 5 : s.pri > pri ? 6 : 0;
}

int vg_join_wall_cells(const struct vg_columns *c, size_t face,
                       struct vg_wall_cell cell[3])
{
  assert(face < c->n_face);

  const uint32_t *f = c->face[face];
  uint32_t tet[3][4], pyr[1][5], pri[1][6], p[3], h[3];
  struct vg_cell_sink s = { tet, pyr, pri, NULL };
  unsigned together = 0;
  int n = 0;

  merge_roots(c, f, p);
  for (int k = 0; k < 3; k++) {
    h[k] = c->column[f[k]].n ? (uint32_t)k + 3 : VG_NO_INDEX;
    together |= (unsigned)!vg_shares_root(c, f[k]) << k;
  }
  rise_from_wall(f, together, p, h, &s);
  for (; tet + n < s.tet; n++) {
    cell[n].n_node = 4;
    memcpy(cell[n].node, tet[n], sizeof tet[n]);
  }
  if (s.pyr > pyr) {
    cell[n].n_node = 5;
    memcpy(cell[n++].node, pyr, sizeof pyr);
  }
  if (s.pri > pri) {
    cell[n].n_node = 6;
    memcpy(cell[n++].node, pri, sizeof pri);
  }
  return n;
}

/* Adds the cells of the levels above `low` to the counts, for columns with n
 * levels: those that three, two or one of the columns have. */
static void count_above(int mixed, const unsigned n[3], unsigned low,
                        size_t count[VG_N_KIND])
{
  unsigned more[3], least, most, mid;

  for (int k = 0; k < 3; k++) more[k] = n[k] > low ? n[k] - low : 0;
  least = more[0] < more[1] ? more[0] : more[1];
  most = more[0] < more[1] ? more[1] : more[0];
  if (more[2] < least) least = more[2];
  if (more[2] > most) most = more[2];
  mid = more[0] + more[1] + more[2] - least - most;
  if (mixed) {
    count[VG_KIND_PRI] += least;
    count[VG_KIND_PYR] += mid - least;
    count[VG_KIND_TET] += most - mid;
  } else count[VG_KIND_TET] += least + mid + most;
}

/* Adds the cells of a pair to the counts. */
static void count_pair(const struct vg_expand *e, size_t face,
                       const uint32_t q[4], size_t count[VG_N_KIND])
{
  const size_t pair[2] = { face, e->partner[face] };
  const unsigned low = vg_pair_levels(e, q);

  count[VG_KIND_HEX] += low - 2;
  count[VG_KIND_PYR] += 5;
  count[VG_KIND_TET] += 2;
  switch (start_of(e, face, q)) {
  case VG_PAIR_ON_WALL: count[VG_KIND_HEX]++; break;
  case VG_PAIR_TOGETHER: count[VG_KIND_PRI]++; break;
  case VG_PAIR_FIRST_ROOT:
  case VG_PAIR_SECOND_ROOT:
    count[VG_KIND_PYR]++;
    count[VG_KIND_TET]++;
    break;
  }
  for (int i = 0; i < 2; i++) {
    unsigned n[3];

    levels_of(e, e->columns->face[pair[i]], n);
    count_above(1, n, low, count);
  }
}

/* Adds the cells of a single face to the counts. */
static void count_face(const struct vg_expand *e, const uint32_t f[3],
                       size_t count[VG_N_KIND])
{
  uint32_t tet[3][4], pyr[1][5], pri[1][6], p[3], h[3];
  struct vg_cell_sink s = { tet, pyr, pri, NULL };
  unsigned n[3];

  levels_of(e, f, n);
  for (int k = 0; k < 3; k++) {
    p[k] = e->foot[f[k]];
    h[k] = n[k] ? e->base[f[k]] : VG_NO_INDEX;
  }
  rise_from_wall(f, alone(e, f), p, h, &s);
  count[VG_KIND_TET] += (size_t)(s.tet - tet);
  count[VG_KIND_PYR] += (size_t)(s.pyr - pyr);
  count[VG_KIND_PRI] += (size_t)(s.pri - pri);
  if (!is_edge(p)) count_above(e->mixed, n, 1, count);
}

static void count_blocks(void *context, size_t first, size_t end, int worker)
{
  struct vg_expand *e = context;

  (void)worker;
  for (size_t b = first; b < end; b++) {
    size_t count[VG_N_KIND] = { 0 }, i = b * VG_FACE_BLOCK;
    uint32_t q[4];

    for (; i < (b + 1) * VG_FACE_BLOCK && i < e->columns->n_face; i++)
      switch (vg_expand_corners(e, i, q)) {
      case 3: count_face(e, q, count); break;
      case 4: count_pair(e, i, q, count); break;
      }
    for (int k = 0; k < VG_N_KIND; k++) e->cell[k][b] = count[k];
  }
}

/* Turns counts into first indices. */
static void add_up(struct vg_expand *e)
{
  for (int k = 0; k < VG_N_KIND; k++) {
    size_t sum = 0;

    for (size_t b = 0; b < e->n_block; b++) {
      size_t here = e->cell[k][b];

      e->cell[k][b] = sum;
      sum += here;
    }
    e->cell[k][e->n_block] = e->n_cell[k] = sum;
  }
}

void vg_expand_count(struct vg_expand *e)
{
  vg_parallel_for(e->threads, e->n_block, BLOCK_GRAIN, count_blocks, e);
  add_up(e);
}

/* Whether the columns of a boundary edge are raised together at this level. */
static int border_together(const struct vg_expand *e, const uint32_t border[2],
                           size_t level)
{
  const struct vg_column *c = e->columns->column;
  const int shared = ((e->mark[border[0]] | e->mark[border[1]]) &
                      VG_MARK_SHARED) != 0;
  const int one_root = c[border[0]].root == c[border[1]].root;

  return e->mixed && (level || !(shared || one_root));
}

/* Whether the second column of a boundary edge is raised before the first. */
static int border_second_first(const struct vg_expand *e,
                               const uint32_t border[2], size_t level)
{
  int late[2];

  for (int k = 0; k < 2; k++)
    late[k] = e->mixed && !level && e->mark[border[k]] & VG_MARK_SHARED;
  return late[0] != late[1] ? late[0] : border[1] < border[0];
}

void vg_expand_count_flank(const struct vg_expand *e, size_t r, size_t *tri,
                           size_t *quad)
{
  assert(r < e->columns->n_border && tri && quad);

  const uint32_t *border = e->columns->border[r];
  const struct vg_column *c = e->columns->column;
  size_t a = vg_mark_n(e->mark[border[0]]), b = vg_mark_n(e->mark[border[1]]);
  size_t both = a < b ? a : b;

  *tri = a + b - 2 * both;
  *quad = 0;
  for (size_t l = 0; l < both; l++)
    if (border_together(e, border, l)) ++*quad;
    else *tri += 2;
  /* The column that is raised first from a shared root makes no face. */
  if ((a || b) && c[border[0]].root == c[border[1]].root) --*tri;
}

/* Faces of one level of a side face. p: current points, in/out; h: next points;
 * first: the column that is raised first if they are raised one at a time. */
static void rise_border(uint32_t p[2], const uint32_t h[2], int first,
                        uint32_t (**to)[3])
{
  for (int i = 0; i < 2; i++) {
    int k = first ^ i;
    const uint32_t tri[3] = { p[1], p[0], h[k] };

    if (h[k] == VG_NO_INDEX) continue;
    if (p[0] != p[1]) memcpy(*(*to)++, tri, sizeof tri);
    p[k] = h[k];
  }
}

void vg_expand_flank(const struct vg_expand *e, size_t r, uint32_t (*tri)[3],
                     uint32_t (*quad)[4])
{
  assert(r < e->columns->n_border);

  const uint32_t *border = e->columns->border[r];
  unsigned a = vg_mark_n(e->mark[border[0]]), b = vg_mark_n(e->mark[border[1]]);
  uint32_t p[2] = { e->foot[border[0]], e->foot[border[1]] };

  for (unsigned l = 0; l < a || l < b; l++) {
    const uint32_t h[2] = { l < a ? e->base[border[0]] + l : VG_NO_INDEX,
                            l < b ? e->base[border[1]] + l : VG_NO_INDEX };

    if (l < a && l < b && border_together(e, border, l)) {
      const uint32_t side[4] = { p[1], p[0], h[0], h[1] };

      memcpy(*quad++, side, sizeof side);
      memcpy(p, h, sizeof h);
    } else rise_border(p, h, border_second_first(e, border, l), &tri);
  }
}
