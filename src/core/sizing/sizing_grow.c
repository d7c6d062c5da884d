/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/tensor.h"
#include "core/sizing/sizing_build.h"

/* The octree is built level by level (sizing_split.c decides which cells are
 * split). A split creates up to 19 new points: midpoints of 12 edges and 6
 * faces, and the centre. A midpoint that is a corner of all cells around it is
 * sampled. If a neighbour is not split, the midpoint hangs: it takes the mean
 * of the ends of its edge or of the corners of its face. This equals the
 * neighbour's interpolation there, so the result is continuous. The parents of
 * a hanging point are corners of split cells, i.e. points of earlier levels.
 *
 * Cells find their neighbours through those of their parents. A midpoint
 * shared by several cells therefore belongs to the first of them, and each
 * cell counts its own midpoints: no table of points is searched, and threads
 * share no data. */
#define NONE UINT32_MAX
#define POINT_MAX (UINT32_MAX - 1)
#define FAMILIES 16 /* families of eight cells per thread and step */

/* Initial capacity. Blocks of tens of megabytes grow by remapping, smaller
 * ones by copies, which a single thread would make. */
#define ROOM ((size_t)1 << 20)

/* Neighbours of a split cell that share one of its midpoints, as directions,
 * and the index of the midpoint in their lattices of 3 x 3 x 3 points. */
struct share {
  uint8_t n, way[3], at[3];
};

struct level {
  struct vg_octree_build *b;
  size_t first, n; /* cells */
  uint32_t half;   /* half the side of a cell */
  double side;
  uint8_t *mark; /* [n] 1: cell is split */
  float *centre; /* [n] field at the centre, NAN if not evaluated; of a field
                    of size tensors, the number of points in the cell */
  size_t n_split;
  uint32_t *which;             /* [n_split] split cells */
  uint32_t (*around)[27];      /* [n_split] cells by direction, the cell
                                  itself at 13; only across faces and edges */
  const uint32_t (*above)[27]; /* around[] of the parents */
  uint32_t *own;               /* [n_split] bit mask of the midpoints that it
                                  owns */
  uint32_t *base;              /* [n_split + 1] first point of each */
  struct share share[27];
};

static const int stride[3] = { 1, 3, 9 };

/* The root has no siblings. */
static void decide_body(void *context, size_t first, size_t end, int worker)
{
  const struct level *l = context;
  struct vg_octree_build *b = l->b;
  struct vg_octree_family y;

  (void)worker;
  vg_octree_family_open(&y, b, l->half, l->side);
  for (size_t k = first; k < end; k++) {
    vg_octree_family_start(&y, b->cell + l->first + 8 * k);
    vg_octree_family_clear(&y);
    for (size_t i = 8 * k; i < 8 * k + 8 && i < l->n; i++) {
      l->centre[i] = NAN;
      l->mark[i] = (uint8_t)vg_octree_wants_split(&y, b->cell + l->first + i,
                                                  (int)(i % 8), l->centre + i);
    }
  }
}

/* H13: a field of size tensors may have one cell per point of the mesh. Their
 * number follows from the sizes at the corners of this level's cells. */
static void raise_limit(const struct level *l)
{
  struct vg_octree_build *b = l->b;
  double n = 0;

  for (size_t i = 0; i < l->n; i++) n += (double)l->centre[i];
  if (n > (double)b->max_cell)
    b->max_cell = n < VG_OCTREE_LEAF / 4 ? (size_t)n : VG_OCTREE_LEAF / 4;
}

/* Points in a cell if its largest corner applied everywhere. */
static double fewest_points(const struct level *l, size_t cell)
{
  const struct vg_octree_build *b = l->b;
  double most = 0;

  for (int i = 0; i < 8; i++) {
    double h[6];

    for (int k = 0; k < 6; k++)
      h[k] = (double)b->tensor[b->cell[cell].corner[i]].h[k];
    most = vg_greater(most, vg_tensor_det(h));
  }
  return l->side * l->side * l->side / most;
}

#define RESOLVED 1e-10 /* least size, as a part of the root cube */

static vg_status refuse_tiny(const struct level *l, size_t cell,
                             struct vg_error *err)
{
  const struct vg_octree_build *b = l->b;
  const double side = b->unit * VG_OCTREE_TOP;

  for (int i = 0; i < 8; i++) {
    const uint32_t p = b->cell[cell].corner[i];
    const double h = (double)b->tensor[p].least;
    double x[3];

    if (h >= RESOLVED * side) continue;
    vg_octree_place(b, b->point[p].at, x);
    return vg_fail(err, VG_ERR_INPUT,
                   "the sizes request %.3g near %g %g %g, which coordinates of "
                   "a domain of %.3g do not resolve; correct the sizes there, "
                   "or give a smallest size (hmin)",
                   h, x[0], x[1], x[2], side);
  }
  return VG_OK;
}

/* A request for far more points than any mesh can have would fill the memory
 * with cells of the octree, long before the forecast could refuse it. */
static vg_status refuse_excess(const struct level *l, struct vg_error *err)
{
  const struct vg_octree_build *b = l->b;
  double n = 0, densest = 0, x[3];
  vg_status st = VG_OK;
  size_t where = l->first;

  for (size_t i = l->first; i < l->first + l->n; i++) {
    double one = fewest_points(l, i);

    VG_TRY(refuse_tiny(l, i, err));
    n += one;
    if (one > densest) where = i;
    densest = vg_greater(densest, one);
  }
  if (n <= b->most_points) return VG_OK;
  vg_octree_place(b, vg_octree_corner(b, b->cell + where), x);
  st = vg_fail(err, VG_ERR_INPUT,
               "the sizes request more than %.2g points, most of them near "
               "%g %g %g (size %.3g); correct the sizes there, give a "
               "smallest size (hmin), or raise max_cells",
               n, x[0], x[1], x[2],
               cbrt(l->side * l->side * l->side / densest));
done:
  return st;
}

/* Decide which cells are split. If the tree would exceed its limit, the floor
 * rises: the field becomes coarser, but uniformly everywhere. */
static vg_status decide(struct level *l, struct vg_error *err)
{
  struct vg_octree_build *b = l->b;
  const struct vg_team_out out[] = {
    { b->cell + l->first, 8 * sizeof *b->cell, 0, NULL },
    { l->mark, 8 * sizeof *l->mark, 0, NULL },
    { l->centre, 8 * sizeof *l->centre, 0, NULL }
  };
  vg_status st;
  size_t n = 0;

  st = vg_team_for(b->team, b->threads, (l->n + 7) / 8, FAMILIES, decide_body,
                   l, sizeof out / sizeof *out, out, err);
  if (st < 0) return st;
  for (size_t i = 0; i < l->n; i++) n += l->mark[i];
  if (b->tensor) {
    raise_limit(l);
    VG_TRY(refuse_excess(l, err));
  }
  while (n && b->n_cell + 8 * n > b->max_cell) {
    b->floor *= 1.25;
    n = 0;
    for (size_t i = 0; i < l->n; i++) {
      if (l->side <= b->floor * (double)b->cell[l->first + i].rest)
        l->mark[i] = 0;
      n += l->mark[i];
    }
  }
  l->n_split = n;
done:
  return st;
}

/* --- splitting ------------------------------------------------------------ */

static uint32_t neighbour(const struct level *l, size_t cell, const int d[3])
{
  size_t of_level = cell - l->first;
  uint32_t parent, child = 0;
  int way = 13;

  if (!l->above) return NONE;
  for (int k = 0; k < 3; k++) {
    int v = (int)(of_level % 8 >> k & 1) + d[k];

    way += v < 0 ? -stride[k] : v > 1 ? stride[k] : 0;
    child |= (uint32_t)(v & 1) << k;
  }
  parent = l->above[of_level / 8][way];
  if (parent == NONE || !l->b->cell[parent].child) return NONE;
  return l->b->cell[parent].child + child;
}

static void around_body(void *context, size_t first, size_t end, int worker)
{
  const struct level *l = context;

  (void)worker;
  for (size_t s = first; s < end; s++) {
    l->b->cell[l->which[s]].child = (uint32_t)(l->b->n_cell + 8 * s);
    for (int way = 0; way < 27; way++) {
      int d[3], off = 0;

      vg_octree_lattice(way, d);
      for (int k = 0; k < 3; k++) off += --d[k] != 0;
      l->around[s][way] = off < 3 ? neighbour(l, l->which[s], d) : NONE;
    }
    l->around[s][13] = l->which[s];
  }
}

/* Midpoints have one coordinate that is odd, or two. The centre has three, and
 * is not shared. */
static void make_shares(struct level *l)
{
  for (int i = 0; i < 27; i++) {
    int at[3], axis[3], n = 0;

    vg_octree_lattice(i, at);
    for (int k = 0; k < 3; k++)
      if (at[k] != 1) axis[n++] = k;
    l->share[i] = (struct share){ .n = 0 };
    for (int some = 1; n < 3 && some < 1 << n; some++) {
      struct share *s = l->share + i;
      int way = 13, there = i;

      for (int k = 0; k < n; k++)
        if (some >> k & 1) {
          int sign = at[axis[k]] - 1;

          way += sign * stride[axis[k]];
          there -= 2 * sign * stride[axis[k]];
        }
      s->way[s->n] = (uint8_t)way;
      s->at[s->n++] = (uint8_t)there;
    }
  }
}

/* Number of splits that have midpoint i of split s, and the first of them. */
struct sharing {
  size_t first;
  int at; /* index of the midpoint in its lattice */
  unsigned n;
};

static struct sharing find_sharing(const struct level *l, size_t s, int i)
{
  const struct vg_octree_build *b = l->b;
  const struct share *all = l->share + i;
  struct sharing found = { s, i, 1 };

  for (int k = 0; k < all->n; k++) {
    uint32_t cell = l->around[s][all->way[k]];
    size_t other;

    if (cell == NONE || !b->cell[cell].child) continue;
    found.n++;
    other = (b->cell[cell].child - b->n_cell) / 8;
    if (other > found.first) continue;
    found.first = other;
    found.at = all->at[k];
  }
  return found;
}

static int is_corner(int i)
{
  int at[3];

  vg_octree_lattice(i, at);
  return at[0] != 1 && at[1] != 1 && at[2] != 1;
}

static void own_body(void *context, size_t first, size_t end, int worker)
{
  const struct level *l = context;

  (void)worker;
  for (size_t s = first; s < end; s++) {
    l->own[s] = 0;
    for (int i = 0; i < 27; i++)
      if (!is_corner(i) && find_sharing(l, s, i).first == s)
        l->own[s] |= 1u << i;
  }
}

/* Number of cells inside the root that share a midpoint if all of them are
 * split. */
static unsigned full_count(const struct vg_octree_point *p)
{
  unsigned n = p->n_parent == 2 ? 4 : 2, on_side = 0;

  for (int k = 0; k < 3; k++)
    on_side += p->at[k] == 0 || p->at[k] == VG_OCTREE_TOP;
  return n >> on_side;
}

/* Create midpoint i, which split s owns. If it hangs, its parents span its odd
 * coordinates. They are points of earlier levels, so their values are known. */
static void make_point(const struct level *l, struct vg_octree_family *y,
                       size_t s, int i, unsigned n_cell,
                       struct vg_octree_point *p)
{
  struct vg_octree_build *b = l->b;
  const struct vg_octree_cell *c = b->cell + l->which[s];
  const uint32_t *from = vg_octree_corner(b, c);
  float known = l->centre[l->which[s] - l->first];
  int at[3];

  vg_octree_lattice(i, at);
  *p = (struct vg_octree_point){ .hint = c->hint };
  for (int k = 0; k < 3; k++) p->at[k] = from[k] + l->half * (uint32_t)at[k];
  for (int j = 0; j < 8 && i != 13; j++) {
    int on = 1;

    for (int k = 0; k < 3; k++)
      on = on && (at[k] == 1 || at[k] / 2 == (j >> k & 1));
    if (on && p->n_parent < 4) p->parent[p->n_parent++] = c->corner[j];
  }
  if (i == 13 || n_cell >= full_count(p)) p->n_parent = 0;
  if (p->n_parent) p->h = vg_octree_hanging_size(b, p);
  if (b->tensor) {
    struct vg_size *tensor = b->tensor + (p - b->point);

    if (p->n_parent) vg_octree_hanging_tensor(b, p, tensor);
    else vg_octree_sample_tensor(y, c, i, tensor, &p->h);
  } else if (!p->n_parent) {
    p->h = i == 13 && !isnan(known) ? known : vg_octree_sample(y, c, i);
  }
}

static void make_children(const struct level *l, size_t s,
                          const uint32_t id[27])
{
  struct vg_octree_build *b = l->b;
  const struct vg_octree_cell *c = b->cell + l->which[s];

  for (int j = 0; j < 8; j++) {
    struct vg_octree_cell *d = b->cell + c->child + j;
    int base = (j & 1) + (j >> 1 & 1) * 3 + (j >> 2) * 9;

    *d = *c;
    d->child = 0;
    for (int i = 0; i < 8; i++)
      d->corner[i] = id[base + (i & 1) + (i >> 1 & 1) * 3 + (i >> 2) * 9];
  }
}

static void split_body(void *context, size_t first, size_t end, int worker)
{
  const struct level *l = context;
  struct vg_octree_build *b = l->b;
  struct vg_octree_family y;
  size_t family = SIZE_MAX;

  (void)worker;
  vg_octree_family_open(&y, b, l->half, l->side);
  for (size_t s = first; s < end; s++) {
    const struct vg_octree_cell *c = b->cell + l->which[s];
    uint32_t id[27], next = l->base[s];
    size_t first_cell = l->first + (l->which[s] - l->first) / 8 * 8;

    if (first_cell != family) vg_octree_family_start(&y, b->cell + first_cell);
    family = first_cell;
    for (int j = 0; j < 8; j++)
      id[2 * (j & 1) + 6 * (j >> 1 & 1) + 18 * (j >> 2)] = c->corner[j];
    for (int i = 0; i < 27; i++) {
      struct sharing all;

      if (is_corner(i)) continue;
      all = find_sharing(l, s, i);
      id[i] = l->base[all.first] + (uint32_t)__builtin_popcount(
                                     l->own[all.first] & ((1u << all.at) - 1));
      if (all.first != s) continue;
      make_point(l, &y, s, i, all.n, b->point + next++);
    }
    make_children(l, s, id);
  }
}

/* Number the splits, their points and their children. */
static int number_splits(struct level *l)
{
  struct vg_octree_build *b = l->b;
  size_t n = 0, n_point = b->n_point;

  for (size_t i = 0; i < l->n; i++)
    if (l->mark[i]) l->which[n++] = (uint32_t)(l->first + i);
  vg_parallel_for(b->threads, n, VG_OCTREE_GRAIN, around_body, l);
  vg_parallel_for(b->threads, n, VG_OCTREE_GRAIN, own_body, l);
  for (size_t s = 0; s < n; s++) {
    l->base[s] = (uint32_t)n_point;
    n_point += (size_t)__builtin_popcount(l->own[s]);
    if (n_point > POINT_MAX) return -1;
  }
  l->base[n] = (uint32_t)n_point;
  if (vg_reserve(&b->point, &b->cap_point, n_point, sizeof *b->point) ||
      vg_reserve(&b->cell, &b->cap_cell, b->n_cell + 8 * n, sizeof *b->cell) ||
      (b->tensor &&
       vg_reserve(&b->tensor, &b->cap_tensor, n_point, sizeof *b->tensor)))
    return -1;
  b->n_point = n_point;
  return 0;
}

static vg_status split(struct level *l, struct vg_error *err)
{
  struct vg_octree_build *b = l->b;
  const struct vg_team_out out[] = {
    { b->cell + b->n_cell, 8 * sizeof *b->cell, 0, NULL },
    { b->point, sizeof *b->point, 0, l->base },
    { b->tensor, sizeof *b->tensor, 0, l->base }
  };
  vg_status st = vg_team_for(b->team, b->threads, l->n_split, FAMILIES,
                             split_body, l, b->tensor ? 3 : 2, out, err);

  b->n_cell += 8 * l->n_split;
  return st;
}

static vg_status split_level(struct level *l, struct vg_error *err)
{
  vg_status st = decide(l, err);

  if (st < 0) return st;
  l->which = vg_alloc(l->n_split, sizeof *l->which);
  l->around = vg_alloc(l->n_split, sizeof *l->around);
  l->own = vg_alloc(l->n_split, sizeof *l->own);
  l->base = vg_alloc(l->n_split + 1, sizeof *l->base);
  if (!l->which || !l->around || !l->own || !l->base || number_splits(l))
    st = vg_fail_memory(err, "the octree of the sizing field");
  else st = split(l, err);
  free(l->which);
  free(l->own);
  free(l->base);
  return st;
}

/* *above: around[] of the level above, replaced by that of this level. */
static vg_status grow_level(struct vg_octree_build *b, int level,
                            uint32_t (**above)[27], struct vg_error *err)
{
  size_t first = b->level[level], n = b->level[level + 1] - first;
  uint32_t half = VG_OCTREE_TOP >> (level + 1);
  struct level l = { .b = b,
                     .first = first,
                     .n = n,
                     .half = half,
                     .side = b->unit * 2 * half,
                     .mark = vg_alloc(n, sizeof *l.mark),
                     .centre = vg_alloc(n, sizeof *l.centre),
                     .above = (const uint32_t(*)[27]) * above };
  vg_status st;

  make_shares(&l);
  st = l.mark && l.centre
       ? split_level(&l, err)
       : vg_fail_memory(err, "the octree of the sizing field");
  free(l.mark);
  free(l.centre);
  free(*above);
  *above = l.around;
  return st;
}

static int make_root(struct vg_octree_build *b)
{
  if (vg_reserve(&b->cell, &b->cap_cell, ROOM, sizeof *b->cell) ||
      vg_reserve(&b->point, &b->cap_point, ROOM, sizeof *b->point) ||
      (b->f->is_stretched &&
       vg_reserve(&b->tensor, &b->cap_tensor, ROOM, sizeof *b->tensor)))
    return -1;
  memset(b->cell, 0, sizeof *b->cell);
  b->n_cell = 1;
  for (uint32_t i = 0; i < 8; i++) {
    struct vg_octree_point *p = b->point + b->n_point++;
    double x[3];

    *p = (struct vg_octree_point){ .hint = 0 };
    for (int k = 0; k < 3; k++) p->at[k] = (i >> k & 1) * VG_OCTREE_TOP;
    vg_octree_place(b, p->at, x);
    if (b->tensor)
      vg_stat_tensor_at(b->f, x, NULL, &p->hint, b->tensor + i, &p->h);
    else p->h = (float)vg_stat_at(b->f, x, NULL, &p->hint);
    b->cell->corner[i] = i;
  }
  return 0;
}

vg_status vg_octree_grow(struct vg_octree_build *b, struct vg_error *err)
{
  uint32_t(*above)[27] = NULL;
  vg_status st = VG_OK;

  if (make_root(b))
    return vg_fail_memory(err, "the octree of the sizing field");
  b->level[1] = 1;
  b->n_level = 1;
  while (st >= 0 && b->n_level <= VG_OCTREE_DEPTH) {
    st = grow_level(b, b->n_level - 1, &above, err);
    if (b->n_cell == b->level[b->n_level]) break;
    b->level[++b->n_level] = b->n_cell;
  }
  free(above);
  return st;
}
