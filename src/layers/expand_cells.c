/* Cells of faces and flanks of rims, one level at a time.
 *
 * All tetrahedra: columns rise one by one, by rising number. Mixed: they rise
 * together, which makes a prism, a pyramid over the two that rise or one
 * tetrahedron. But two columns of one root are one point at level 0, and a
 * prism over a face with two of them has five points and two quadrilaterals
 * that share two edges: no cell. So, at level 0, columns that share their root
 * rise after the others, one by one: whatever of the face's points is equal,
 * what they leave are tetrahedra, or cells with a repeated point that vanish.
 * The columns alone decide, so both sides of a flank agree. */
#include "layers/expand.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "layers/join.h"

/* Where the next cell goes. */
struct sink {
  uint32_t (*tet)[4];
  uint32_t (*pyr)[5];
  uint32_t (*pri)[6];
};

struct level {
  const struct vg_expand *e;
  size_t level;
  const uint32_t *low, *high;  /* [n_column] points at this and the next */
  struct vg_mesh *m;
  uint8_t *bad;                /* [n_block] has a face with a jump */
};

/* Corners of a face by rising column, by which of f0 < f1, f1 < f2, f2 < f0
 * hold (bits 0, 1, 2; none or all cannot be). */
static const uint8_t rising[8][3] = {
  {0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {0, 1, 2},
  {2, 1, 0}, {2, 0, 1}, {1, 2, 0}, {0, 1, 2},
};

static const uint8_t *order_of(const uint32_t f[3])
{
  return rising[(f[0] < f[1]) | (f[1] < f[2]) << 1 | (f[2] < f[0]) << 2];
}

static inline void put_tet(struct sink *s, const uint32_t p[3], uint32_t top)
{
  uint32_t *n = *s->tet++;

  n[0] = p[0];
  n[1] = p[1];
  n[2] = p[2];
  n[3] = top;
}

/* Who splits a prism's quadrilaterals from node 0 on (0 1 2 3, 1 2 3 4,
 * 2 3 4 5) should agree with his neighbours. By rising columns he would, but
 * half of the faces turn the other way round; there one of two edges must
 * disagree, and they take turns, so that warped sides add up to nothing. */
static int first_corner(const uint32_t f[3])
{
  const uint8_t *o = order_of(f);
  int turns_well = (o[0] + 1) % 3 == o[1];

  return turns_well || ((f[0] ^ f[1] ^ f[2]) & 1) ? o[0] : o[1];
}

static void put_prism(struct sink *s, const uint32_t f[3], const uint32_t p[3],
                      const uint32_t h[3])
{
  uint32_t *n = *s->pri++;
  int first = first_corner(f);

  for (int k = 0; k < 3; k++) {
    n[k] = p[(first + k) % 3];
    n[3 + k] = h[(first + k) % 3];
  }
}

/* A prism of which corner w does not rise. */
static void put_pyramid(struct sink *s, const uint32_t p[3],
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

/* The lift rule where points may be equal. */
static void lift(struct sink *s, uint32_t p[3], uint32_t top, int k)
{
  if (p[0] != p[1] && p[1] != p[2] && p[2] != p[0]) put_tet(s, p, top);
  p[k] = top;
}

/* Corners of the mask that rise rise together; their roots differ. */
static void rise_together(struct sink *s, const uint32_t f[3], uint32_t p[3],
                          const uint32_t h[3], unsigned mask)
{
  int n = 0, last = 0, rest = 0;

  for (int k = 0; k < 3; k++)
    if (mask >> k & 1 && h[k] != VG_NO_INDEX) n++, last = k;
    else rest = k;
  if (n == 3) put_prism(s, f, p, h);
  else if (n == 2) put_pyramid(s, p, h, rest);
  else if (n == 1) put_tet(s, p, h[last]);
  for (int k = 0; k < 3; k++)
    if (mask >> k & 1 && h[k] != VG_NO_INDEX) p[k] = h[k];
}

/* Points p stand at level 0; corners in the mask share their root with no
 * other column, so with two of them all points differ. */
static void rise_from_wall(const uint32_t f[3], unsigned together,
                           uint32_t p[3], const uint32_t h[3], struct sink *s)
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
                                   const uint32_t h[3], struct sink *s)
{
  const uint8_t *order = order_of(f);

  for (int i = 0; i < 3; i++) {
    int k = order[i];

    if (h[k] == VG_NO_INDEX) continue;
    put_tet(s, p, h[k]);
    p[k] = h[k];
  }
}

/* Cells of one face at the present level. */
static inline void rise(const struct level *l, size_t face, struct sink *s)
{
  const uint32_t *f = l->e->columns->face[face];
  uint32_t p[3] = { l->low[f[0]], l->low[f[1]], l->low[f[2]] };
  const uint32_t h[3] = { l->high[f[0]], l->high[f[1]], l->high[f[2]] };
  unsigned together = 0;

  if (!l->level) {
    for (int k = 0; k < 3 && l->e->mixed; k++)
      together |= (unsigned)!(l->e->mark[f[k]] & VG_MARK_SHARED) << k;
    rise_from_wall(f, together, p, h, s);
  }
  else if (l->e->mixed) rise_together(s, f, p, h, 7);
  else rise_one_by_one(f, p, h, s);
}

int vg_join_wall_cells(const struct vg_columns *c, size_t face,
                       struct vg_wall_cell cell[3])
{
  const uint32_t *f = c->face[face];
  uint32_t tet[3][4], pyr[1][5], pri[1][6], p[3], h[3];
  struct sink s = { tet, pyr, pri };
  unsigned together = 0;
  int n = 0;

  for (int k = 2; k >= 0; k--) {
    p[k] = (uint32_t)k;
    for (int i = 2; i > k; i--)
      if (c->column[f[i]].root == c->column[f[k]].root) p[i] = p[k];
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

static void fill_block(void *context, size_t first, size_t end, int worker)
{
  const struct level *l = context;
  const struct vg_expand *e = l->e;
  size_t at = l->level * e->n_block + first / VG_FACE_BLOCK, n = 0;
  struct sink s = { NULL, NULL, NULL };

  (void)worker;
  for (int k = 0; k < VG_N_KIND; k++) n += e->cell[k][at + 1] - e->cell[k][at];
  if (!n) return;
  if (e->n_cell[VG_KIND_TET]) s.tet = l->m->tet + e->cell[VG_KIND_TET][at];
  if (e->n_cell[VG_KIND_PYR]) s.pyr = l->m->pyr + e->cell[VG_KIND_PYR][at];
  if (e->n_cell[VG_KIND_PRI]) s.pri = l->m->pri + e->cell[VG_KIND_PRI][at];
  for (size_t i = first; i < end; i++) rise(l, i, &s);
}

/* Levels of a face: `whole` of three rising columns, then one level of `part`
 * rising ones, 0 to 2. -1: neighbours differ by more. */
static int levels_of(const struct vg_expand *e, size_t face, unsigned *whole)
{
  const uint32_t *f = e->columns->face[face];
  unsigned a = vg_mark_n(e->mark[f[0]]), b = vg_mark_n(e->mark[f[1]]),
           c = vg_mark_n(e->mark[f[2]]);
  unsigned low = a < b ? a : b;

  if (c < low) low = c;
  *whole = low;
  if (a > low + 1 || b > low + 1 || c > low + 1) return -1;
  return (int)(a + b + c - 3 * low);
}

static void count_wall(const struct level *l, size_t face, size_t *count)
{
  uint32_t tet[3][4], pyr[1][5], pri[1][6];
  struct sink s = { tet, pyr, pri };

  rise(l, face, &s);
  count[VG_KIND_TET] += (size_t)(s.tet - tet);
  count[VG_KIND_PYR] += (size_t)(s.pyr - pyr);
  count[VG_KIND_PRI] += (size_t)(s.pri - pri);
}

static void count_block(void *context, size_t first, size_t end, int worker)
{
  const struct level *l = context;
  const struct vg_expand *e = l->e;
  size_t count[VG_LEVELS_MAX + 1][3] = {{0}}, wall[VG_N_KIND] = {0}, whole = 0;
  size_t block = first / VG_FACE_BLOCK;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    unsigned low;
    int part = levels_of(e, i, &low);

    if (part < 0) l->bad[block] = 1;
    else count[low][part]++;
    count_wall(l, i, wall);
  }
  for (size_t k = e->n_level; k-- > 0;) {
    size_t at = k * e->n_block + block, one = count[k][1], two = count[k][2];

    whole += count[k + 1][0] + count[k + 1][1] + count[k + 1][2];
    e->cell[VG_KIND_TET][at] = e->mixed ? one : 3 * whole + 2 * two + one;
    e->cell[VG_KIND_PYR][at] = e->mixed ? two : 0;
    e->cell[VG_KIND_PRI][at] = e->mixed ? whole : 0;
  }
  for (int k = 0; k < VG_N_KIND && e->n_level; k++)
    e->cell[k][block] = wall[k];
}

static vg_status report_jump(const struct vg_expand *e, struct vg_error *err)
{
  const struct vg_columns *c = e->columns;

  for (size_t i = 0; i < c->n_face; i++) {
    const uint32_t *f = c->face[i];
    unsigned low;

    if (levels_of(e, i, &low) >= 0) continue;
    return vg_fail(err, VG_ERR_INPUT,
                   "the columns on points %zu, %zu and %zu have %u, %u and %u "
                   "levels; neighbours may differ by one",
                   (size_t)c->column[f[0]].root + 1,
                   (size_t)c->column[f[1]].root + 1,
                   (size_t)c->column[f[2]].root + 1, c->column[f[0]].n,
                   c->column[f[1]].n, c->column[f[2]].n);
  }
  return VG_OK;
}

static void add_up(struct vg_expand *e)
{
  size_t n = e->n_level * e->n_block;

  for (int k = 0; k < VG_N_KIND; k++) {
    size_t sum = 0;

    for (size_t i = 0; i < n; i++) {
      size_t here = e->cell[k][i];

      e->cell[k][i] = sum;
      sum += here;
    }
    e->cell[k][n] = e->n_cell[k] = sum;
  }
}

static void stand_on_wall(const struct vg_expand *e, const uint32_t *root,
                          uint32_t *low)
{
  for (size_t i = 0; i < e->columns->n_column; i++)
    low[i] = root[e->columns->column[i].root];
}

vg_status vg_expand_count(struct vg_expand *e, const uint32_t *root,
                          struct vg_error *err)
{
  size_t n_column = e->columns->n_column, bad = 0;
  uint32_t *low = vg_alloc(n_column, sizeof *low);
  uint32_t *high = vg_alloc(n_column, sizeof *high);
  struct level l = { e, 0, low, high, NULL, vg_calloc(e->n_block, 1) };
  int refused = !low || !high || !l.bad;

  for (int k = 0; k < VG_N_KIND; k++) {
    e->cell[k] = vg_calloc(e->n_level * e->n_block + 1, sizeof *e->cell[k]);
    refused |= !e->cell[k];
  }
  if (!refused && e->n_level) {
    stand_on_wall(e, root, low);
    vg_expand_level(e, 1, high);
    vg_parallel_for(e->threads, e->columns->n_face, VG_FACE_BLOCK,
                    count_block, &l);
    for (size_t i = 0; i < e->n_block; i++) bad += l.bad[i];
    add_up(e);
  }
  free(low);
  free(high);
  free(l.bad);
  if (refused) return vg_fail_memory(err, "the numbers of the layer cells");
  return bad ? report_jump(e, err) : VG_OK;
}

/* Columns of a rim rise together at this level. */
static int rim_together(const struct vg_expand *e, const uint32_t rim[2],
                        size_t level)
{
  unsigned shared = (e->mark[rim[0]] | e->mark[rim[1]]) & VG_MARK_SHARED;

  return e->mixed && (level || !shared);
}

/* The second column of a rim rises before the first. */
static int rim_second_first(const struct vg_expand *e, const uint32_t rim[2],
                            size_t level)
{
  int late[2];

  for (int k = 0; k < 2; k++)
    late[k] = e->mixed && !level && e->mark[rim[k]] & VG_MARK_SHARED;
  return late[0] != late[1] ? late[0] : rim[1] < rim[0];
}

void vg_expand_flank(const struct vg_expand *e, size_t r, size_t *tri,
                     size_t *quad)
{
  const uint32_t *rim = e->columns->rim[r];
  const struct vg_column *c = e->columns->column;
  size_t a = vg_mark_n(e->mark[rim[0]]), b = vg_mark_n(e->mark[rim[1]]);
  size_t both = a < b ? a : b;

  *tri = a + b - 2 * both;
  *quad = 0;
  for (size_t l = 0; l < both; l++)
    if (rim_together(e, rim, l)) ++*quad;
    else *tri += 2;
  /* What rises first from a common root makes no face. */
  if ((a || b) && c[rim[0]].root == c[rim[1]].root) --*tri;
}

/* Inward faces of the flank of rim r at the present level. */
static void rise_rim(const struct level *l, size_t r, size_t *tri_at,
                     size_t *quad_at)
{
  const uint32_t *rim = l->e->columns->rim[r];
  uint32_t p[2] = { l->low[rim[0]], l->low[rim[1]] };
  const uint32_t h[2] = { l->high[rim[0]], l->high[rim[1]] };
  int first = rim_second_first(l->e, rim, l->level);

  if (h[0] != VG_NO_INDEX && h[1] != VG_NO_INDEX &&
      rim_together(l->e, rim, l->level)) {
    const uint32_t quad[4] = { p[1], p[0], h[0], h[1] };

    memcpy(l->m->quad[quad_at[r]++], quad, sizeof quad);
    return;
  }
  for (int i = 0; i < 2; i++) {
    int k = first ^ i;
    const uint32_t tri[3] = { p[1], p[0], h[k] };

    if (h[k] == VG_NO_INDEX) continue;
    if (p[0] != p[1]) memcpy(l->m->tri[tri_at[r]++], tri, sizeof tri);
    p[k] = h[k];
  }
}

vg_status vg_expand_cells(const struct vg_expand *e, const uint32_t *root,
                          struct vg_mesh *m, size_t *tri_at, size_t *quad_at,
                          struct vg_error *err)
{
  const struct vg_columns *c = e->columns;
  uint32_t *low = vg_alloc(c->n_column, sizeof *low);
  uint32_t *high = vg_alloc(c->n_column, sizeof *high);
  vg_status st = VG_OK;

  if (!low || !high) {
    st = vg_fail_memory(err, "the points of two levels");
    goto done;
  }
  stand_on_wall(e, root, low);
  for (size_t i = 0; i < e->n_level; i++) {
    struct level l = { e, i, low, high, m, NULL };
    uint32_t *swap = low;

    vg_expand_level(e, i + 1, high);
    vg_parallel_for(e->threads, c->n_face, VG_FACE_BLOCK, fill_block, &l);
    for (size_t r = 0; r < c->n_rim; r++) rise_rim(&l, r, tri_at, quad_at);
    low = high;
    high = swap;
  }
done:
  free(low);
  free(high);
  return st;
}
