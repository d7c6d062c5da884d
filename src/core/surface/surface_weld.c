/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Merges points that coincide, and renumbers after points and triangles were
 * merged or dropped. */
#include "core/surface/surface_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "base/union_find.h"

#define NONE UINT32_MAX

static int equal3(const double a[3], const double b[3])
{
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static int finite3(const double p[3])
{
  return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

/* Slot that contains an index i with key[i] equal to x, or the free slot where
 * such an index belongs. */
static uint32_t *find(const struct vg_table *t, const double (*key)[3],
                      const double x[3])
{
  uint32_t *at;

  VG_TABLE_FIND(t, at, vg_hash_point(x), equal3(key[*at], x));
  return at;
}

vg_status vg_points_same(const struct vg_mesh *m, uint32_t **same,
                         struct vg_error *err)
{
  const double(*point)[3] = (const double(*)[3])m->point;
  struct vg_table t;
  uint32_t *map;

  if (m->n_point >= NONE)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "%zu points: the limit is %u",
                   m->n_point, (unsigned)NONE - 1);
  if (vg_table_init(&t, m->n_point))
    return vg_fail_memory(err, "a point table");
  map = vg_alloc(m->n_point, sizeof *map);
  if (!map) {
    vg_table_release(&t);
    return vg_fail_memory(err, "a point map");
  }
  for (size_t i = 0; i < m->n_point; i++) {
    uint32_t *slot;

    map[i] = (uint32_t)i;
    if (!finite3(point[i])) continue;
    slot = find(&t, point, point[i]);
    if (*slot == VG_TABLE_FREE) *slot = (uint32_t)i;
    map[i] = *slot;
  }
  vg_table_release(&t);
  *same = map;
  return VG_OK;
}

/* --- within a tolerance -------------------------------------------------- */

/* Cells whose diagonal is the tolerance, in blocks of BLOCK^3 cells. An empty
 * block excludes many cells with a single look-up. */
#define BLOCK 16
#define REACH 2  /* cells: points farther apart are not within reach */
#define CROWD 62 /* cells in reach, of which half are examined */

struct grid {
  struct vg_table cell, block; /* First point of each. */
  double (*key)[3];            /* [n] Integer coordinates of the cell of each
                                  point. */
  double (*block_key)[3];      /* [n] Block of each point that is the first of
                                  its cell. */
  uint32_t *next;              /* [n] Next point in the same cell. */
  uint32_t *next_cell;         /* [n] First point of the next cell in the
                                  block. */
  uint32_t *n_cell;            /* [n] > 0 for the first point of a cell; for the
                                  first point of a block, the number of its
                                  cells. */
  const double (*point)[3];
  double limit2;
};

static void link_cells(const struct grid *g, uint32_t *map, uint32_t a,
                       uint32_t b)
{
  if (vg_root_of(map, a) == vg_root_of(map, b)) return;
  for (uint32_t i = a; i != NONE; i = g->next[i])
    for (uint32_t j = b; j != NONE; j = g->next[j]) {
      const double *p = g->point[i], *q = g->point[j];
      double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];

      if (x * x + y * y + z * z <= g->limit2) {
        vg_union(map, a, b);
        return;
      }
    }
}

/* Examine half of the 124 cells in reach; the other half examines this cell. */
static void link_by_cell(const struct grid *g, uint32_t *map, uint32_t a)
{
  for (int o = 63; o < 125; o++) {
    const double *k = g->key[a];
    double x[3] = { k[0] + o / 25 - REACH, k[1] + o / 5 % 5 - REACH,
                    k[2] + o % 5 - REACH };
    uint32_t b = *find(&g->cell, (const double(*)[3])g->key, x);

    if (b != NONE) link_cells(g, map, a, b);
  }
}

static int in_reach(const double a[3], const double b[3])
{
  return fabs(a[0] - b[0]) <= REACH && fabs(a[1] - b[1]) <= REACH &&
         fabs(a[2] - b[2]) <= REACH;
}

/* Block o (0..7) of those within reach of cell `key`. Returns 0 if it is the
 * same as an earlier one. */
static int block_in_reach(const double key[3], int o, double block[3])
{
  for (int k = 0; k < 3; k++) {
    double lo = floor((key[k] - REACH) / BLOCK);
    double hi = floor((key[k] + REACH) / BLOCK);

    if (o >> k & 1 && hi == lo) return 0;
    block[k] = o >> k & 1 ? hi : lo;
  }
  return 1;
}

/* Follow the list of cells of each block within reach; if a list is long, look
 * up single cells instead. */
static void link_neighbours(const struct grid *g, uint32_t *map, uint32_t a)
{
  uint32_t first[8];
  int n = 0;

  for (int o = 0; o < 8; o++) {
    double x[3];
    uint32_t b;

    if (!block_in_reach(g->key[a], o, x)) continue;
    b = *find(&g->block, (const double(*)[3])g->block_key, x);
    if (b == NONE) continue;
    if (g->n_cell[b] > CROWD) {
      link_by_cell(g, map, a);
      return;
    }
    first[n++] = b;
  }
  while (n--)
    for (uint32_t b = first[n]; b != NONE; b = g->next_cell[b])
      if (b != a && in_reach(g->key[a], g->key[b])) link_cells(g, map, a, b);
}

static void enter_block(struct grid *g, uint32_t i)
{
  uint32_t *slot;

  for (int k = 0; k < 3; k++) g->block_key[i][k] = floor(g->key[i][k] / BLOCK);
  slot = find(&g->block, (const double(*)[3])g->block_key, g->block_key[i]);
  g->next_cell[i] = NONE;
  g->n_cell[i] = 1;
  if (*slot == VG_TABLE_FREE) {
    *slot = i;
  } else {
    g->next_cell[i] = g->next_cell[*slot];
    g->next_cell[*slot] = i;
    g->n_cell[*slot]++;
  }
}

/* Points in the same cell are within the tolerance of each other and are
 * chained at once, so that each cell costs one search per neighbour. */
static void link_grid(struct grid *g, uint32_t *map, size_t n, double side)
{
  for (uint32_t i = 0; i < n; i++) {
    uint32_t *slot;

    if (map[i] != i || !finite3(g->point[i])) continue;
    for (int k = 0; k < 3; k++) g->key[i][k] = floor(g->point[i][k] / side);
    slot = find(&g->cell, (const double(*)[3])g->key, g->key[i]);
    g->next[i] = NONE;
    if (*slot == VG_TABLE_FREE) {
      *slot = i;
      enter_block(g, i);
    } else {
      map[i] = *slot;
      g->next[i] = g->next[*slot];
      g->next[*slot] = i;
    }
  }
  for (uint32_t i = 0; i < n; i++)
    if (g->n_cell[i]) link_neighbours(g, map, i);
  for (size_t i = 0; i < n; i++) map[i] = vg_root_of(map, (uint32_t)i);
}

static double largest_coordinate(const struct vg_mesh *m)
{
  double most = 0;

  for (size_t i = 0; i < m->n_point; i++)
    for (int k = 0; k < 3; k++)
      if (isfinite(m->point[i][k]) && fabs(m->point[i][k]) > most)
        most = fabs(m->point[i][k]);
  return most;
}

/* On entry map[] contains the exact merges. */
static vg_status link_near(const struct vg_mesh *m, double tolerance,
                           uint32_t *map, struct vg_error *err)
{
  size_t n = m->n_point;
  struct grid g;
  vg_status st = VG_OK;
  int bad;

  /* Coordinates do not resolve such a distance. */
  if (tolerance < 1e-15 * largest_coordinate(m)) return VG_OK;
  memset(&g, 0, sizeof g);
  g.point = (const double(*)[3])m->point;
  g.limit2 = tolerance * tolerance;
  g.key = vg_alloc(n, sizeof *g.key);
  g.block_key = vg_alloc(n, sizeof *g.block_key);
  g.next = vg_alloc(n, sizeof *g.next);
  g.next_cell = vg_alloc(n, sizeof *g.next_cell);
  g.n_cell = vg_calloc(n, sizeof *g.n_cell);
  bad = vg_table_init(&g.cell, n) + vg_table_init(&g.block, n);
  if (bad || !g.key || !g.block_key || !g.next || !g.next_cell || !g.n_cell)
    st = vg_fail_memory(err, "the weld grid");
  else link_grid(&g, map, n, 0.577 * tolerance); /* 1 / sqrt(3), rounded down */
  free(g.key);
  free(g.block_key);
  free(g.next);
  free(g.next_cell);
  free(g.n_cell);
  vg_table_release(&g.cell);
  vg_table_release(&g.block);
  return st;
}

vg_status vg_points_near(const struct vg_mesh *m, double tolerance,
                         uint32_t **near, struct vg_error *err)
{
  assert(near && tolerance >= 0);

  uint32_t *map = NULL;
  vg_status st = vg_points_same(m, &map, err);

  if (st >= 0 && tolerance > 0) st = link_near(m, tolerance, map, err);
  if (st < 0) free(map);
  else *near = map;
  return st;
}

/* --- renumbering --------------------------------------------------------- */

static size_t bad_index(const uint32_t *node, size_t n, size_t width,
                        size_t n_point)
{
  for (size_t i = 0; i < n * width; i++)
    if (node[i] >= n_point) return i / width;
  return SIZE_MAX;
}

vg_status vg_mesh_check_index(const struct vg_mesh *m, struct vg_error *err)
{
  const struct {
    const char *name;
    const uint32_t *node;
    size_t n, width;
  } list[] = {
    { "triangle", (uint32_t *)m->tri, m->n_tri, 3 },
    { "quadrilateral", (uint32_t *)m->quad, m->n_quad, 4 },
    { "tetrahedron", (uint32_t *)m->tet, m->n_tet, 4 },
    { "pyramid", (uint32_t *)m->pyr, m->n_pyr, 5 },
    { "prism", (uint32_t *)m->pri, m->n_pri, 6 },
    { "hexahedron", (uint32_t *)m->hex, m->n_hex, 8 },
  };

  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    size_t at = bad_index(list[k].node, list[k].n, list[k].width, m->n_point);

    if (at != SIZE_MAX)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s %zu has a node outside the range of the %zu points: "
                     "the file is damaged",
                     list[k].name, at + 1, m->n_point);
  }
  for (size_t i = 0; i < m->n_tri + m->n_quad; i++) {
    int is_tri = i < m->n_tri;
    uint32_t p = is_tri ? m->tri_patch[i] : m->quad_patch[i - m->n_tri];

    if (p >= m->n_patch)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s %zu belongs to none of the %zu "
                     "patches",
                     is_tri ? "triangle" : "quadrilateral",
                     is_tri ? i + 1 : i - m->n_tri + 1, m->n_patch);
  }
  return VG_OK;
}

static void renumber(uint32_t *node, size_t n, const uint32_t *map)
{
  for (size_t i = 0; i < n; i++) node[i] = map[node[i]];
}

void vg_mesh_renumber(struct vg_mesh *m, uint32_t *map, const uint8_t *keep)
{
  uint32_t n = 0;

  assert(map || !m->n_point);
  for (size_t i = 0; i < m->n_point; i++) {
    if (map[i] != i) {
      map[i] = map[map[i]]; /* lower, hence final */
    } else if (keep && !keep[i]) {
      map[i] = NONE;
    } else {
      memmove(m->point[n], m->point[i], sizeof *m->point);
      map[i] = n++;
    }
  }
  m->n_point = n;
  renumber((uint32_t *)m->tri, 3 * m->n_tri, map);
  renumber((uint32_t *)m->quad, 4 * m->n_quad, map);
  renumber((uint32_t *)m->tet, 4 * m->n_tet, map);
  renumber((uint32_t *)m->pyr, 5 * m->n_pyr, map);
  renumber((uint32_t *)m->pri, 6 * m->n_pri, map);
  renumber((uint32_t *)m->hex, 8 * m->n_hex, map);
}

size_t vg_mesh_drop_tri(struct vg_mesh *m, const uint8_t *drop)
{
  assert(drop || !m->n_tri);

  size_t n = 0, before = m->n_tri;

  for (size_t t = 0; t < before; t++) {
    if (drop[t]) continue;
    memmove(m->tri[n], m->tri[t], sizeof *m->tri);
    m->tri_patch[n++] = m->tri_patch[t];
  }
  m->n_tri = n;
  return before - n;
}

vg_status vg_surface_weld(struct vg_mesh *m, double tolerance, size_t *n_merged,
                          size_t *n_dropped, struct vg_error *err)
{
  uint32_t *map = NULL;
  uint8_t *drop = NULL;
  size_t n_point = m->n_point, dropped;
  vg_status st = VG_OK;

  if (!(tolerance >= 0) || isinf(tolerance))
    return vg_fail(err, VG_ERR_INPUT,
                   "weld tolerance %g: give 0 (points with "
                   "equal coordinates) or a positive distance",
                   tolerance);
  VG_TRY(vg_mesh_check_index(m, err));
  VG_TRY(vg_points_near(m, tolerance, &map, err));
  drop = vg_alloc(m->n_tri, 1);
  if (!drop) VG_TRY(vg_fail_memory(err, "a list of triangles"));
  for (size_t t = 0; t < m->n_tri; t++) {
    uint32_t a = map[m->tri[t][0]], b = map[m->tri[t][1]];
    uint32_t c = map[m->tri[t][2]];

    drop[t] = a == b || b == c || c == a;
  }
  dropped = vg_mesh_drop_tri(m, drop);
  vg_mesh_renumber(m, map, NULL);
  if (n_merged) *n_merged = n_point - m->n_point;
  if (n_dropped) *n_dropped = dropped;
done:
  free(map);
  free(drop);
  return st;
}

vg_status vg_surface_merge_points(struct vg_mesh *m, struct vg_error *err)
{
  uint8_t *used = vg_calloc(m->n_point, 1);
  uint32_t *map = NULL;
  vg_status st = used ? vg_points_same(m, &map, err)
                      : vg_fail_memory(err, "the points of the surface");

  if (st >= 0) {
    for (size_t i = 0; i < m->n_tri; i++)
      for (int k = 0; k < 3; k++) used[map[m->tri[i][k]]] = 1;
    for (size_t i = 0; i < m->n_quad; i++)
      for (int k = 0; k < 4; k++) used[map[m->quad[i][k]]] = 1;
    vg_mesh_renumber(m, map, used);
  }
  free(map);
  free(used);
  return st;
}
