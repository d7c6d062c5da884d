/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds the pairs of virtual faces that become stacks of hexahedra, and checks
 * the cells of any pair. Declared in layers/expand/pairs.h. */
#include "layers/expand/pairs.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/judge/quality.h"
#include "layers/expand/expand_parts.h"

#define PAIR_GRAIN 16

/* L30 */
/* Least square of the cosines between the faces of a cell in a pair of wall
 * faces and the lines from its centre to theirs: 87 degrees. */
#define CENTRED 0.0025
/* The same for a hexahedron above which the thicker ones are not tested. */
#define WELL_CENTRED 0.25

/* An edge between columns of two roots, of a virtual face that has one column
 * of one root (`single`) and two of the other. */
struct edge {
  uint32_t low, high, face, single;
};

struct search {
  struct vg_expand *e;
  const struct vg_mesh *surface;
  size_t n_edge, n_link;
  struct edge *edge;
  uint32_t (*link)[2]; /* [n_face] faces with which a face may be paired. */
  uint32_t *queue;
  uint8_t *bad; /* [n_face] 1: the cells of this pair would be bad. */
};

static uint32_t root_of(const struct vg_columns *c, uint32_t column)
{
  return c->column[column].root;
}

/* Corner of a face whose root differs from the common root of the two others;
 * -1 for a face with one root or three. */
static int single_corner(const struct vg_columns *c, const uint32_t f[3])
{
  for (int k = 0; k < 3; k++) {
    const uint32_t a = root_of(c, f[(k + 1) % 3]);

    if (a == root_of(c, f[(k + 2) % 3])) return a != root_of(c, f[k]) ? k : -1;
  }
  return -1;
}

static int by_edge(const void *a, const void *b)
{
  const struct edge *s = a, *t = b;

  if (s->low != t->low) return s->low < t->low ? -1 : 1;
  if (s->high != t->high) return s->high < t->high ? -1 : 1;
  return s->face < t->face ? -1 : s->face > t->face;
}

static void list_edges(struct search *q)
{
  const struct vg_columns *c = q->e->columns;

  for (size_t i = 0; i < c->n_face; i++) {
    const uint32_t *f = c->face[i];
    const int s = c->face_tri[i] == VG_NO_INDEX ? single_corner(c, f) : -1;

    for (int k = 1; k < 3 && s >= 0; k++) {
      const uint32_t a = f[s], b = f[(s + k) % 3];

      q->edge[q->n_edge++] = (struct edge){ a < b ? a : b, a < b ? b : a,
                                            (uint32_t)i, a };
    }
  }
  if (q->n_edge) qsort(q->edge, q->n_edge, sizeof *q->edge, by_edge);
}

static void add_link(struct search *q, uint32_t face, uint32_t other)
{
  q->link[face][q->link[face][0] != VG_NO_INDEX] = other;
}

/* Links the faces on both sides of an edge if each has one column of another
 * root there: together they are a quadrilateral of two columns of each root. */
static void link_faces(struct search *q)
{
  for (size_t i = 0; i + 1 < q->n_edge; i++) {
    const struct edge *a = &q->edge[i], *b = &q->edge[i + 1];

    if (a->low != b->low || a->high != b->high || a->single == b->single)
      continue;
    add_link(q, a->face, b->face);
    add_link(q, b->face, a->face);
  }
}

/* The only face, or the first of two faces, that could still be paired with
 * face i. *n out: number of such faces. */
static uint32_t open_link(const struct search *q, uint32_t i, int *n)
{
  uint32_t first = VG_NO_INDEX;

  *n = 0;
  for (int k = 0; k < 2; k++) {
    const uint32_t o = q->link[i][k];

    if (o == VG_NO_INDEX || q->e->partner[o] != VG_NO_INDEX) continue;
    if (first == VG_NO_INDEX) first = o;
    ++*n;
  }
  return first;
}

/* Pairs face i, and then each face that is left with a single link. The linked
 * faces of a fan are a strip, so no face at its ends stays without partner. */
static void pair_from(struct search *q, uint32_t i)
{
  size_t n = 0;

  q->queue[n++] = i;
  while (n) {
    const uint32_t f = q->queue[--n];
    int n_open;
    uint32_t g;

    if (q->e->partner[f] != VG_NO_INDEX) continue;
    g = open_link(q, f, &n_open);
    if (g == VG_NO_INDEX) continue;
    q->e->partner[f] = g;
    q->e->partner[g] = f;
    for (int k = 0; k < 4; k++) {
      const uint32_t o = q->link[k < 2 ? f : g][k % 2];

      if (o == VG_NO_INDEX || q->e->partner[o] != VG_NO_INDEX) continue;
      open_link(q, o, &n_open);
      if (n_open == 1) q->queue[n++] = o;
    }
  }
}

static void pair_faces(struct search *q)
{
  const size_t n = q->e->columns->n_face;

  for (int round = 0; round < 2; round++) /* Ends of strips; closed strips. */
    for (size_t i = 0; i < n; i++) {
      int n_open;

      if (q->e->partner[i] != VG_NO_INDEX) continue;
      open_link(q, (uint32_t)i, &n_open);
      if (n_open == 1 || (round && n_open)) pair_from(q, (uint32_t)i);
    }
}

int vg_pair_is_first(const struct vg_expand *e, size_t face)
{
  return e->partner && e->partner[face] != VG_NO_INDEX &&
         face < e->partner[face];
}

void vg_pair_ring(const struct vg_columns *c, const size_t pair[2],
                  uint32_t q[4])
{
  assert(pair[0] < c->n_face && pair[1] < c->n_face);

  const uint32_t *f = c->face[pair[0]], *g = c->face[pair[1]];
  uint32_t ring[4];
  int k = 0, j = 0, turn;

  while (f[k] == g[0] || f[k] == g[1] || f[k] == g[2]) k++;
  while (g[j] == f[0] || g[j] == f[1] || g[j] == f[2]) j++;
  ring[0] = f[k];
  ring[1] = f[(k + 1) % 3];
  ring[2] = g[j];
  ring[3] = f[(k + 2) % 3];
  turn = c->face_tri[pair[0]] == VG_NO_INDEX &&
         root_of(c, ring[0]) != root_of(c, ring[1]);
  for (int i = 0; i < 4; i++) q[i] = ring[(i + turn) % 4];
}

void vg_pair_corners(const struct vg_expand *e, size_t face, uint32_t q[4])
{
  assert(vg_pair_is_first(e, face));

  const size_t pair[2] = { face, e->partner[face] };

  vg_pair_ring(e->columns, pair, q);
}

unsigned vg_pair_levels(const struct vg_expand *e, const uint32_t q[4])
{
  unsigned low = vg_mark_n(e->mark[q[0]]);

  for (int k = 1; k < 4; k++) {
    const unsigned n = vg_mark_n(e->mark[q[k]]);

    if (n < low) low = n;
  }
  return low;
}

/* The points of a pair as a small mesh: those of column k begin at k *
 * (VG_LEVELS_MAX + 1); the last point is the middle. */
struct stack {
  double x[4 * (VG_LEVELS_MAX + 1) + 1][3];
};
#define MIDDLE (4 * (VG_LEVELS_MAX + 1))

void vg_pair_middle_of(const double (*x)[3], const uint32_t base[4],
                       unsigned low, double middle[3])
{
  assert(low > 1);
  for (int i = 0; i < 3; i++) {
    double sum = 0;

    for (int k = 0; k < 4; k++)
      for (unsigned l = low - 1; l <= low; l++) sum += x[base[k] + l - 1][i];
    middle[i] = sum / 8;
  }
}

static void load(const struct vg_expand *e, const struct vg_mesh *surface,
                 const uint32_t q[4], struct stack *s)
{
  double d[VG_LEVELS_MAX + 1];
  uint32_t base[4];

  for (uint32_t k = 0; k < 4; k++) {
    base[k] = k * (VG_LEVELS_MAX + 1) + 1;
    vg_column_points(e->columns, surface, q[k], d, s->x + base[k] - 1);
  }
  vg_pair_middle_of((const double(*)[3])s->x, base, vg_pair_levels(e, q),
                    s->x[MIDDLE]);
}

void vg_pair_middle(const struct vg_expand *e, const struct vg_mesh *surface,
                    size_t face, double x[3])
{
  const size_t other = e->partner[face];
  struct stack s;
  uint32_t q[4];

  vg_pair_corners(e, face < other ? face : other, q);
  load(e, surface, q, &s);
  memcpy(x, s.x[MIDDLE], sizeof s.x[MIDDLE]);
}

/* Most cells of a pair up to the level where its lower columns end. */
#define MOST_CELLS (VG_LEVELS_MAX + 8)

struct cells {
  uint32_t tet[MOST_CELLS][4], pyr[MOST_CELLS][5], pri[MOST_CELLS][6],
    hex[MOST_CELLS][8];
};

static int all_positive(const struct stack *s, const struct cells *c,
                        const struct vg_cell_sink *end)
{
  const double(*x)[3] = (const double(*)[3])s->x;

  for (size_t i = 0; c->tet + i < end->tet; i++)
    if (!vg_cell_positive(x, 0, c->tet[i])) return 0;
  for (size_t i = 0; c->pyr + i < end->pyr; i++)
    if (!vg_cell_positive(x, 1, c->pyr[i])) return 0;
  for (size_t i = 0; c->pri + i < end->pri; i++)
    if (!vg_cell_positive(x, 2, c->pri[i])) return 0;
  for (size_t i = 0; c->hex + i < end->hex; i++)
    if (!vg_cell_positive(x, 3, c->hex[i])) return 0;
  return 1;
}

/* Whether no centre of a cell is behind or close to one of its faces, as in
 * warped hexahedra that are thin. */
static int all_centred(const struct stack *s, const struct cells *c,
                       const struct vg_cell_sink *end)
{
  const double(*x)[3] = (const double(*)[3])s->x;

  for (size_t i = 0; c->pyr + i < end->pyr; i++)
    if (!(vg_cell_cosine2(x, 1, c->pyr[i]) >= CENTRED)) return 0;
  for (size_t i = 0; c->hex + i < end->hex; i++) {
    const double least = vg_cell_cosine2(x, 3, c->hex[i]);

    if (!(least >= CENTRED)) return 0;
    if (least >= WELL_CENTRED) break;
  }
  return 1;
}

/* All cells up to the level where the lowest column ends, with each of the ways
 * to begin at the wall. Those above are the cells of single faces, which were
 * tested when the layers grew. */
int vg_pair_is_good(const struct vg_expand *e, const struct vg_mesh *surface,
                    const size_t pair[2])
{
  static const enum vg_pair_start start[] = {
    VG_PAIR_TOGETHER, VG_PAIR_FIRST_ROOT, VG_PAIR_SECOND_ROOT, VG_PAIR_ON_WALL
  };
  const int on_wall = e->columns->face_tri[pair[0]] != VG_NO_INDEX;
  unsigned low;
  struct stack s;
  struct cells c;
  uint32_t q[4], foot[4], base[4], last[4];

  vg_pair_ring(e->columns, pair, q);
  for (int k = 0; k < 4 && !on_wall; k += 2)
    if (vg_mark_n(e->mark[q[k]]) != vg_mark_n(e->mark[q[k + 1]])) return 0;
  low = vg_pair_levels(e, q);
  if (low < 2) return 0;
  load(e, surface, q, &s);
  for (uint32_t k = 0; k < 4; k++) last[k] = k * (VG_LEVELS_MAX + 1) + low - 1;
  if (on_wall && !vg_pair_level_is_sound((const double(*)[3])s.x, last, MIDDLE))
    return 0;
  for (uint32_t k = 0; k < 4; k++) {
    foot[k] = (on_wall ? k : k / 2 * 2) * (VG_LEVELS_MAX + 1);
    base[k] = k * (VG_LEVELS_MAX + 1) + 1;
  }
  for (int i = on_wall ? VG_PAIR_ON_WALL : 0; i < (on_wall ? 4 : 3); i++) {
    struct vg_cell_sink sink = { c.tet, c.pyr, c.pri, c.hex };

    vg_expand_pair(e, pair, q, start[i], foot, base, MIDDLE, &sink);
    if (!all_positive(&s, &c, &sink) ||
        (on_wall && !all_centred(&s, &c, &sink)))
      return 0;
  }
  return 1;
}

static void test_body(void *context, size_t first, size_t end, int worker)
{
  const struct search *q = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    const size_t pair[2] = { i, q->e->partner[i] };

    q->bad[i] = vg_pair_is_first(q->e, i) &&
                !vg_pair_is_good(q->e, q->surface, pair);
  }
}

static void drop_bad(struct search *q)
{
  struct vg_expand *e = q->e;

  vg_parallel_for(e->threads, e->columns->n_face, PAIR_GRAIN, test_body, q);
  for (size_t i = 0; i < e->columns->n_face; i++) {
    if (q->bad[i]) {
      e->partner[e->partner[i]] = VG_NO_INDEX;
      e->partner[i] = VG_NO_INDEX;
    } else e->n_pair += (size_t)vg_pair_is_first(e, i);
  }
}

/* Whether the cells of an unpaired virtual face at the wall need columns that
 * are raised one at a time: those of a wedge between two roots. */
static int is_wedge(const struct vg_expand *e, size_t face)
{
  const struct vg_columns *c = e->columns;

  return c->face_tri[face] == VG_NO_INDEX && e->partner[face] == VG_NO_INDEX &&
         single_corner(c, c->face[face]) >= 0;
}

static int shares_root(const struct vg_expand *e, const uint32_t f[3], int k)
{
  return (e->mark[f[k]] & VG_MARK_SHARED) != 0;
}

/* Columns of a root whose virtual faces are in pairs, or have no other root,
 * are raised together from the wall like those of other roots: their marks are
 * removed. Those in periodic patches stay, since both patches of a pair need
 * the same. kept: [n_column] scratch, 1: the mark stays. */
static void clear_marks(struct vg_expand *e, uint8_t *kept)
{
  const struct vg_columns *c = e->columns;

  memset(kept, 0, c->n_column);
  for (size_t i = 0; i < c->n_face; i++)
    for (int k = 0; k < 3 && is_wedge(e, i); k++) kept[c->face[i][k]] = 1;
  for (size_t i = 0; i < c->n_twin; i++) kept[i] |= c->is_twin[i];
  for (size_t i = 1; i < c->n_column; i++) /* All columns of the root. */
    if (c->column[i].root == c->column[i - 1].root) kept[i] |= kept[i - 1];
  for (size_t i = c->n_column; i-- > 1;)
    if (c->column[i].root == c->column[i - 1].root) kept[i - 1] |= kept[i];
  for (size_t i = 0; i < c->n_column; i++)
    if (!kept[i]) e->mark[i] &= (uint16_t)~VG_MARK_SHARED;
}

/* Whether the cells of a face at the wall are good if its columns are raised as
 * the marks say. */
static int wall_is_good(const struct vg_expand *e,
                        const struct vg_mesh *surface, const uint32_t f[3])
{
  uint32_t tet[3][4], pyr[1][5], pri[1][6];
  const uint32_t foot[3] = { 0, 1, 2 }, base[3] = { 3, 4, 5 };
  struct vg_cell_sink s = { tet, pyr, pri, NULL };
  double x[6][3], d[VG_LEVELS_MAX + 1], column[VG_LEVELS_MAX + 1][3];
  int good = 1;

  for (int k = 0; k < 3; k++) {
    vg_column_points(e->columns, surface, f[k], d, column);
    memcpy(x[k], column[0], sizeof *x);
    memcpy(x[3 + k], column[vg_mark_n(e->mark[f[k]]) > 0], sizeof *x);
  }
  vg_expand_wall(e, f, foot, base, &s);
  for (size_t i = 0; tet + i < s.tet; i++)
    good &= vg_cell_positive((const double(*)[3])x, 0, tet[i]);
  if (s.pyr > pyr) good &= vg_cell_positive((const double(*)[3])x, 1, pyr[0]);
  if (s.pri > pri) good &= vg_cell_positive((const double(*)[3])x, 2, pri[0]);
  return good;
}

static void mark_root(struct vg_expand *e, uint32_t column)
{
  const struct vg_columns *c = e->columns;
  const uint32_t root = root_of(c, column);
  size_t i = column;

  while (i && c->column[i - 1].root == root) i--;
  for (; i < c->n_column && c->column[i].root == root; i++)
    e->mark[i] |= VG_MARK_SHARED;
}

/* Marks return where a cell at the wall would be bad without them. shared:
 * [n_column] 1: the root has several columns. */
static void restore_marks(struct vg_expand *e, const struct vg_mesh *surface,
                          const uint8_t *shared)
{
  const struct vg_columns *c = e->columns;

  for (int changed = 1; changed;) {
    changed = 0;
    for (size_t i = 0; i < c->n_face; i++) {
      const uint32_t *f = c->face[i];
      int at = -1;

      for (int k = 0; k < 3 && c->face_tri[i] != VG_NO_INDEX; k++)
        if (shared[f[k]] && !shares_root(e, f, k)) at = k;
      if (at < 0 || wall_is_good(e, surface, f)) continue;
      for (int k = 0; k < 3; k++)
        if (shared[f[k]]) mark_root(e, f[k]);
      changed = 1;
    }
  }
}

static vg_status reserve(struct search *q, struct vg_error *err)
{
  const size_t n = q->e->columns->n_face;
  size_t n_virtual = 0;

  for (size_t i = 0; i < n; i++)
    n_virtual += q->e->columns->face_tri[i] == VG_NO_INDEX;
  if (!n_virtual) return VG_OK;
  q->e->partner = vg_alloc(n, sizeof *q->e->partner);
  q->e->middle = vg_alloc(n, sizeof *q->e->middle);
  q->edge = vg_alloc(2 * n_virtual, sizeof *q->edge);
  q->link = vg_alloc(n, sizeof *q->link);
  q->queue = vg_alloc(2 * n + 4, sizeof *q->queue);
  q->bad = vg_calloc(n, 1);
  if (!q->e->partner || !q->e->middle || !q->edge || !q->link || !q->queue ||
      !q->bad)
    return vg_fail_memory(err, "the pairs of faces at fans");
  memset(q->e->partner, 0xff, n * sizeof *q->e->partner);
  memset(q->link, 0xff, n * sizeof *q->link);
  return VG_OK;
}

vg_status vg_pairs_find(struct vg_expand *e, const struct vg_mesh *surface,
                        struct vg_error *err)
{
  struct search q = { .e = e, .surface = surface };
  const size_t n = e->columns->n_column;
  uint8_t *kept = vg_alloc(n, 1), *shared = vg_alloc(n, 1);
  vg_status st = kept && shared
                 ? reserve(&q, err)
                 : vg_fail_memory(err, "the pairs of faces at fans");

  if (st >= 0 && e->partner) {
    for (size_t i = 0; i < n; i++)
      shared[i] = (e->mark[i] & VG_MARK_SHARED) != 0;
    list_edges(&q);
    link_faces(&q);
    pair_faces(&q);
    drop_bad(&q);
    clear_marks(e, kept);
    restore_marks(e, surface, shared);
  }
  free(q.edge);
  free(q.link);
  free(q.queue);
  free(q.bad);
  free(kept);
  free(shared);
  return st;
}
