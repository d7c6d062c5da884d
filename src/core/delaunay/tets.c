/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/delaunay/tets.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "base/table.h"
#include "base/tri_key.h"
#include "base/wide.h"
#include "core/delaunay/cell_signs.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/predicates.h"

const uint8_t vg_face[4][3] = {
  { 1, 3, 2 }, { 0, 2, 3 }, { 0, 3, 1 }, { 0, 1, 2 }
};

void vg_tets_release(struct vg_tets *t)
{
  free(t->x);
  free(t->cell);
  free(t->flag);
  free(t->free);
  memset(t, 0, sizeof *t);
}

int vg_tets_reserve_points(struct vg_tets *t, size_t n)
{
  return vg_reserve(&t->x, &t->cap_point, t->n_point + n, sizeof *t->x);
}

int vg_tets_reserve_cells(struct vg_tets *t, size_t n)
{
  size_t cap = t->cap_cell, need;

  if (t->n_free >= n) return 0;
  need = t->n_cell + n - t->n_free;
  if (need <= cap) return 0;
  if (need >= VG_CELL_MAX) return -1;
  if (vg_reserve(&t->cell, &cap, need, sizeof *t->cell)) return -1;
  cap = t->cap_cell;
  if (vg_reserve(&t->flag, &cap, need, sizeof *t->flag)) return -1;
  t->cap_cell = cap;
  return 0;
}

int vg_tets_free_cell(struct vg_tets *t, uint32_t cell)
{
  assert(cell < t->n_cell);
  if (vg_reserve(&t->free, &t->cap_free, t->n_free + 1, sizeof *t->free))
    return -1;
  t->flag[cell] = VG_DEAD;
  t->free[t->n_free++] = cell;
  return 0;
}

/* --- links ---------------------------------------------------------------- */

static struct vg_tri_key face_key(const struct vg_cell *c, uint32_t i)
{
  const uint32_t v[3] = { c->v[vg_face[i][0]], c->v[vg_face[i][1]],
                          c->v[vg_face[i][2]] };

  return vg_tri_key(v);
}

static int has_key(const struct vg_tets *t, uint32_t half,
                   struct vg_tri_key key)
{
  return vg_tri_key_same(face_key(&t->cell[half >> 2], half & 3), key);
}

/* The first half of a face enters the table, and the second one is linked with
 * it. A third half is an error. */
static vg_status link_faces(struct vg_tets *t, const struct vg_table *table,
                            struct vg_error *err)
{
  for (uint32_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & VG_DEAD) continue;
    for (uint32_t i = 0; i < 4; i++) {
      struct vg_tri_key key;
      uint32_t *at;

      if (t->cell[c].link[i] != VG_NONE) continue;
      key = face_key(&t->cell[c], i);
      VG_TABLE_FIND(table, at, vg_tri_key_hash(key), has_key(t, *at, key));
      if (*at == VG_TABLE_FREE) {
        *at = 4 * c + i;
        continue;
      }
      if (t->cell[*at >> 2].link[*at & 3] != VG_NONE)
        return vg_fail(err, VG_ERR_GEOMETRY,
                       "the face with points %u %u %u has more than two cells",
                       (uint32_t)(key.low >> 32) + 1, (uint32_t)key.low + 1,
                       key.high + 1);
      vg_tets_connect(t, *at, 4 * c + i);
    }
  }
  return VG_OK;
}

static vg_status link_with_table(struct vg_tets *t, size_t n_entry,
                                 struct vg_error *err)
{
  struct vg_table table;
  vg_status st;

  assert(t->n_cell < VG_CELL_MAX);
  if (vg_table_init(&table, n_entry))
    return vg_fail_memory(err, "the neighbour table");
  st = link_faces(t, &table, err);
  vg_table_release(&table);
  return st;
}

/* Of the 4 n_cell halves, one of each inner face and all halves on the hull
 * enter the table. */
vg_status vg_tets_link(struct vg_tets *t, struct vg_error *err)
{
  for (size_t c = 0; c < t->n_cell; c++)
    memset(t->cell[c].link, 0xff, sizeof t->cell[c].link);
  return link_with_table(t, 5 * t->n_cell / 2, err);
}

vg_status vg_tets_link_open(struct vg_tets *t, struct vg_error *err)
{
  size_t n = 0;

  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++) n += t->cell[c].link[i] == VG_NONE;
  return link_with_table(t, n, err);
}

vg_status vg_tets_from_cells(struct vg_tets *t, size_t n_point, double (*x)[3],
                             size_t n_cell, const uint32_t (*v)[4],
                             struct vg_error *err)
{
  assert(!t->n_point && !t->n_cell && !t->n_free);
  assert(x && (v || !n_cell));
  t->x = x;
  t->n_point = t->cap_point = n_point;
  if (vg_tets_reserve_cells(t, n_cell))
    return vg_fail_memory(err, "tetrahedra");
  for (size_t c = 0; c < n_cell; c++) {
    struct vg_cell *cell = &t->cell[c];
    const double *at = x[v[c][0]];
    double sign = vg_orient3d(at, x[v[c][1]], x[v[c][2]], x[v[c][3]]);

    if (sign == 0)
      return vg_fail(err, VG_ERR_GEOMETRY, "a flat cell at (%g %g %g)", at[0],
                     at[1], at[2]);
    memcpy(cell->v, v[c], sizeof cell->v);
    if (sign < 0) {
      cell->v[0] = v[c][1];
      cell->v[1] = v[c][0];
    }
    t->flag[c] = 0;
  }
  t->n_cell = n_cell;
  return vg_tets_link(t, err);
}

/* --- location ------------------------------------------------------------- */

static uint32_t search_all(const struct vg_tets *t, const double x[3])
{
  for (uint32_t c = 0; c < t->n_cell; c++) {
    const uint32_t *v = t->cell[c].v;
    int i = 0;

    if (t->flag[c] & VG_DEAD) continue;
    for (; i < 4; i++)
      if (vg_orient3d(t->x[v[vg_face[i][0]]], t->x[v[vg_face[i][1]]],
                      t->x[v[vg_face[i][2]]], x) < 0)
        break;
    if (i == 4) return c;
  }
  return VG_NONE;
}

/* Faces of cell c on whose outer side x is certainly, and on whose inner side
 * or plane. Without AVX2 all faces are left to exact tests. */
VG_WITHIN void view(const struct vg_tets *t, uint32_t c, const double x[3],
                    unsigned *in, unsigned *out, int is_wide)
{
  *in = *out = 0;
#ifdef VG_WIDE
  if (is_wide) {
    struct vg_cell_view v;

    vg_cell_view((const double(*)[3])t->x, t->cell[c].v, x, &v);
    *in = v.in;
    *out = v.out;
  }
#endif
  (void)t;
  (void)c;
  (void)x;
  (void)is_wide;
}

/* Is x strictly on the outer side of face i of a cell? */
static inline int is_beyond(const struct vg_tets *t, const struct vg_cell *cell,
                            uint32_t i, const double x[3])
{
  const uint8_t *f = vg_face[i];

  return vg_orient3d(t->x[cell->v[f[0]]], t->x[cell->v[f[1]]],
                     t->x[cell->v[f[2]]], x) < 0;
}

/* Steps of a walk whose turns follow the golden ratio. Where the mesh is not
 * Delaunay, they may repeat in step with a cycle of cells; those of later steps
 * have no such order, so that the walk leaves every cycle. */
enum { EVEN_STEPS = 4096 };

/* The first of the faces (bits) in the order of step `step` of a walk. */
static inline uint32_t first_face(unsigned faces, uint32_t step)
{
  uint32_t turn = step < EVEN_STEPS ? vg_walk_turn(step)
                                    : (uint32_t)(vg_hash_mix(step) >> 62);

  return (turn + (uint32_t)__builtin_ctz((faces | faces << 4) >> turn)) & 3;
}

/* The walk of vg_tets_locate. *c in: start; out: the cell. Returns 0 if the
 * walk was too long. */
VG_WITHIN int walk_with(const struct vg_tets *t, uint32_t *c, const double x[3],
                        int is_wide)
{
  uint32_t most = 4096 + (uint32_t)(t->n_cell / 64);
  unsigned back = 0; /* bit of the face through which the walk came */

  /* A walk along a sheet of many points is long, but shorter than a search
   * through all cells. */
  for (uint32_t step = 0; step < most; step++) {
    const struct vg_cell *cell = &t->cell[*c];
    unsigned in, out, left;
    uint32_t i;

    view(t, *c, x, &in, &out, is_wide);
    out &= ~back;
    for (left = 0xf & ~(in | back); left; left &= ~(1u << i)) {
      i = first_face(left, step);
      if (out >> i & 1 || is_beyond(t, cell, i, x)) break;
    }
    if (!left) return 1;
    *c = cell->link[i] == VG_NONE ? VG_NONE : cell->link[i] >> 2;
    if (*c == VG_NONE) return 1;
    back = 1u << (cell->link[i] & 3);
  }
  return 0;
}

#ifdef VG_WIDE
static VG_WIDE int walk_wide(const struct vg_tets *t, uint32_t *c,
                             const double x[3])
{
  return walk_with(t, c, x, 1);
}
#endif

/* All faces of a cell at once if the processor supports AVX2. */
static int walk(const struct vg_tets *t, uint32_t *c, const double x[3])
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) return walk_wide(t, c, x);
#endif
  return walk_with(t, c, x, 0);
}

uint32_t vg_tets_locate(const struct vg_tets *t, uint32_t start,
                        const double x[3])
{
  assert(start < t->n_cell && !(t->flag[start] & VG_DEAD));

  uint32_t c = start;

  return walk(t, &c, x) ? c : search_all(t, x);
}

/* --- housekeeping --------------------------------------------------------- */

/* to[old] = new number of each point, VG_NONE for unused points from n_keep
 * on. Reorders t->x accordingly. */
static vg_status order_points(struct vg_tets *t, size_t n_keep, uint32_t *to,
                              struct vg_error *err)
{
  size_t n = t->n_point - n_keep, used = n_keep;
  uint32_t *order = vg_alloc(n, sizeof *order);
  double(*x)[3] = vg_alloc(n, sizeof *x);
  vg_status st = VG_OK;

  if (!order || !x) st = vg_fail_memory(err, "renumbering points");
  for (size_t c = 0; st == VG_OK && c < t->n_cell; c++)
    for (int i = 0; i < 4 && !(t->flag[c] & (VG_DEAD | VG_OUTSIDE)); i++)
      to[t->cell[c].v[i]] = 0;
  for (size_t p = 0; st == VG_OK && p < n_keep; p++) to[p] = (uint32_t)p;
  if (st == VG_OK) {
    memcpy(x, t->x + n_keep, n * sizeof *x);
    st = vg_hilbert_order(n, (const double(*)[3])x, order, err);
  }
  for (size_t k = 0; st == VG_OK && k < n; k++) {
    size_t p = n_keep + order[k];

    if (to[p] == VG_NONE) continue;
    memcpy(t->x[used], x[order[k]], sizeof *x);
    to[p] = (uint32_t)used++;
  }
  if (st == VG_OK) t->n_point = used;
  free(order);
  free(x);
  return st;
}

/* to[old] = new number of each cell, VG_NONE for removed ones: counting sort
 * by the highest point. Returns the number of remaining cells. */
static size_t order_cells(const struct vg_tets *t, uint32_t *start,
                          uint32_t *to)
{
  size_t n = 0;

  for (size_t c = 0; c < t->n_cell; c++) {
    const uint32_t *v = t->cell[c].v;
    uint32_t top = v[0];

    for (int i = 1; i < 4; i++) top = v[i] > top ? v[i] : top;
    to[c] = t->flag[c] & (VG_DEAD | VG_OUTSIDE) ? VG_NONE : top;
    if (to[c] != VG_NONE) start[top + 1]++;
  }
  for (size_t p = 0; p < t->n_point; p++) start[p + 1] += start[p];
  for (size_t c = 0; c < t->n_cell; c++)
    if (to[c] != VG_NONE) {
      to[c] = start[to[c]]++;
      n++;
    }
  return n;
}

static void move_cells(struct vg_tets *t, size_t n, const uint32_t *to,
                       struct vg_cell *cell, uint8_t *flag)
{
  for (size_t c = 0; c < t->n_cell; c++) {
    struct vg_cell at = t->cell[c];

    if (to[c] == VG_NONE) continue;
    for (int i = 0; i < 4; i++) {
      uint32_t other = at.link[i] == VG_NONE ? VG_NONE : to[at.link[i] >> 2];

      at.link[i] = other == VG_NONE ? VG_NONE : 4 * other + (at.link[i] & 3);
    }
    cell[to[c]] = at;
    flag[to[c]] = t->flag[c];
  }
  free(t->cell);
  free(t->flag);
  t->cell = cell;
  t->flag = flag;
  t->n_cell = t->cap_cell = n;
  t->n_free = 0;
}

vg_status vg_tets_compact(struct vg_tets *t, size_t n_keep,
                          struct vg_error *err)
{
  assert(n_keep <= t->n_point);

  uint32_t *point = vg_alloc(t->n_point, sizeof *point), *start = NULL;
  uint32_t *to = vg_alloc(t->n_cell, sizeof *to);
  struct vg_cell *cell = NULL;
  uint8_t *flag = NULL;
  size_t n;
  vg_status st = VG_OK;

  VG_CHECK("the insertion of points", vg_tets_defects(t));
  if (!point || !to) {
    st = vg_fail_memory(err, "renumbering cells");
    goto done;
  }
  memset(point, 0xff, t->n_point * sizeof *point);
  VG_TRY(order_points(t, n_keep, point, err));
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++)
      if (!(t->flag[c] & (VG_DEAD | VG_OUTSIDE)))
        t->cell[c].v[i] = point[t->cell[c].v[i]];
  start = vg_calloc(t->n_point + 1, sizeof *start);
  if (start) {
    n = order_cells(t, start, to);
    cell = vg_alloc(n, sizeof *cell);
    flag = vg_alloc(n, sizeof *flag);
  }
  if (!cell || !flag) {
    free(cell);
    free(flag);
    st = vg_fail_memory(err, "renumbering cells");
    goto done;
  }
  move_cells(t, n, to, cell, flag);
  VG_CHECK("the renumbering of cells", vg_tets_defects(t));
done:
  free(point);
  free(to);
  free(start);
  return st;
}

size_t vg_tets_inverted(const struct vg_tets *t)
{
  size_t bad = 0;

  for (size_t c = 0; c < t->n_cell; c++) {
    const uint32_t *v = t->cell[c].v;

    bad += !(t->flag[c] & VG_DEAD) &&
           !(vg_orient3d(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]) > 0);
  }
  return bad;
}

size_t vg_tets_defects(const struct vg_tets *t)
{
  size_t bad = vg_tets_inverted(t);

  for (uint32_t c = 0; c < t->n_cell; c++) {
    const struct vg_cell *cell = &t->cell[c];

    if (t->flag[c] & VG_DEAD) continue;
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t l = cell->link[i];

      if (l == VG_NONE) continue;
      bad += t->cell[l >> 2].link[l & 3] != 4 * c + i ||
             !has_key(t, l, face_key(cell, i)) || t->flag[l >> 2] & VG_DEAD ||
             (!((t->flag[c] ^ t->flag[l >> 2]) & VG_OUTSIDE) &&
              (t->flag[c] >> i & 1) != (t->flag[l >> 2] >> (l & 3) & 1));
    }
  }
  return bad;
}
