/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Division of large tiles by ribs. Outline: the distribution of cells in the
 * tile's zone is sampled at the octants that its plane passes through, as dots
 * of the plane. Candidate lines divide the dots evenly, either parallel to an
 * axis of the plane or as a fan from a corner of the tile, where the body may
 * be from which the spacing grows. The lines that meet the fewest cells become
 * ribs, as many as there is room for. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/cut/lattice.h"

/* C6: Cells of a piece relative to a leaf, so that a piece takes about half
 * the time. Ribs of pieces below the minimum would cost too much; pieces above
 * the maximum would keep the workers of large leaves waiting. */
static const double piece_share = 0.2, least_piece = 4000, most_piece = 12000;
/* Maximum cells of the ribs relative to their tile. */
static const double rib_share = 0.12;
/* Minimum distance of a rib, in spacings, from the walls that separate it from
 * the next rib. */
static const double room = 2.5; /* C7 */

enum { MOST_PIECES = 8 };

/* The share of an octant in the zone. */
struct dot {
  size_t tile, number;
  double x[2], half, h[2], cells; /* h: edges along the axes of the tile */
  double key;                     /* Candidate lines have a constant key. */
};

struct tile {
  int plane;   /* Axis normal to its plane. */
  int axis[2]; /* Axes in its plane. */
  double lo[2], hi[2];
  size_t n;
  struct dot *dot; /* [n] */
};

/* a x[0] + b x[1] = offset; the normal points to higher keys. */
struct line {
  double normal[2], offset;
};

/* Kinds of key: the coordinate along axis `way`, or, from 2 on, the angle at a
 * corner, as a fraction between the two sides of the tile. */
enum { WAYS = 6 };

/* The lattice that ribs are added to. */
struct ribs {
  double piece_cells; /* Cells of a piece of a tile. */
  size_t cap;
  struct vg_lattice *lattice;
  struct vg_error *err;
};

struct lines {
  double cost; /* Cells; infinite if there is no room. */
  int n;
  struct line line[MOST_PIECES - 1];
};

static void corner_of(const struct tile *t, int way, double x[2],
                      double sign[2])
{
  for (int k = 0; k < 2; k++) {
    int upper = (way - 2) >> k & 1;

    x[k] = upper ? t->hi[k] : t->lo[k];
    sign[k] = upper ? -1 : 1;
  }
}

static double key_of(const struct tile *t, int way, const double x[2])
{
  double at[2], sign[2], a, b;

  if (way < 2) return x[way];
  corner_of(t, way, at, sign);
  a = fmax(sign[0] * (x[0] - at[0]), 0);
  b = fmax(sign[1] * (x[1] - at[1]), 0);
  return a + b > 0 ? b / (a + b) : 0;
}

static struct line line_of(const struct tile *t, int way, double key)
{
  struct line l = { { way == 0, way == 1 }, key };
  double at[2], sign[2], length;

  if (way < 2) return l;
  corner_of(t, way, at, sign);
  length = sqrt(key * key + (1 - key) * (1 - key));
  l.normal[0] = -sign[0] * key / length;
  l.normal[1] = sign[1] * (1 - key) / length;
  l.offset = l.normal[0] * at[0] + l.normal[1] * at[1];
  return l;
}

static int by_key(const void *a, const void *b)
{
  const struct dot *s = a, *t = b;

  if (s->key != t->key) return s->key < t->key ? -1 : 1;
  return (s->number > t->number) - (s->number < t->number);
}

static double beyond(const struct line *l, const double x[2])
{
  return l->normal[0] * x[0] + l->normal[1] * x[1] - l->offset;
}

/* Distance of x, a position on line k, from the bisector with the next line. */
static double room_at(const struct lines *all, int k, const double x[2])
{
  double least = INFINITY;

  for (int i = k - 1; i <= k + 1; i += 2) {
    const struct line *a = &all->line[k], *b = &all->line[i];
    struct line half;
    double length;

    if (i < 0 || i >= all->n) continue;
    half.normal[0] = a->normal[0] + b->normal[0];
    half.normal[1] = a->normal[1] + b->normal[1];
    half.offset = a->offset + b->offset;
    length = sqrt(half.normal[0] * half.normal[0] +
                  half.normal[1] * half.normal[1]);
    least = fmin(least, fabs(beyond(&half, x)) / length);
  }
  return least;
}

/* Distance of x from the sides of the tile that lines do not cross. */
static double distance_to_sides(const struct tile *t, int way,
                                const double x[2])
{
  double at[2], sign[2];

  if (way < 2) return fmin(x[way] - t->lo[way], t->hi[way] - x[way]);
  corner_of(t, way, at, sign);
  return fmin(fabs(x[0] - at[0]), fabs(x[1] - at[1]));
}

/* Target edge length across a line. */
static double across(const struct dot *d, int way)
{
  return way < 2 ? d->h[way] : fmax(d->h[0], d->h[1]);
}

static void find_cost(const struct tile *t, int way, struct lines *all)
{
  all->cost = 0;
  for (size_t i = 0; i < t->n; i++)
    for (int k = 0; k < all->n; k++) {
      const struct dot *d = &t->dot[i];
      const struct line *l = &all->line[k];
      double off = beyond(l, d->x), h = across(d, way), foot[2];

      all->cost += d->cells * h / d->half *
                   fmax(1 - fabs(off) / (2 * d->half), 0);
      if (fabs(off) > d->half) continue;
      for (int j = 0; j < 2; j++) foot[j] = d->x[j] - off * l->normal[j];
      if (room_at(all, k, foot) < room * h ||
          distance_to_sides(t, way, foot) < room * h)
        all->cost = INFINITY;
    }
}

/* Lines that divide the sorted dots into n equal parts. */
static void lines_of(const struct tile *t, int way, int n, double cells,
                     struct lines *out)
{
  double sum = 0;

  out->n = 0;
  for (size_t i = 0; i + 1 < t->n && out->n + 1 < n; i++) {
    sum += t->dot[i].cells;
    if (sum * n < cells * (out->n + 1)) continue;
    out->line[out->n++] = line_of(t, way,
                                  0.5 * (t->dot[i].key + t->dot[i + 1].key));
  }
  find_cost(t, way, out);
}

static vg_status add_ribs(struct ribs *to, const struct tile *t, int tile,
                          const struct lines *all)
{
  struct vg_lattice *l = to->lattice;

  if (vg_reserve(&l->rib, &to->cap, (size_t)(l->n_rib + all->n),
                 sizeof *l->rib))
    return vg_fail_memory(to->err, "cutting a front");
  for (int k = 0; k < all->n; k++) {
    struct vg_rib *r = &l->rib[l->n_rib++];

    memset(r, 0, sizeof *r);
    r->tile = tile;
    for (int j = 0; j < 2; j++)
      r->plane.normal[t->axis[j]] = all->line[k].normal[j];
    r->plane.offset = all->line[k].offset;
  }
  return VG_OK;
}

static vg_status part_tile(struct ribs *to, struct tile *t, int number)
{
  struct lines best[MOST_PIECES + 1];
  double cells = 0;
  int most;

  for (size_t i = 0; i < t->n; i++) cells += t->dot[i].cells;
  most = (int)fmin(cells / to->piece_cells + 0.5, MOST_PIECES);
  if (most < 2) return VG_OK;
  for (int n = 2; n <= most; n++) best[n].cost = INFINITY;
  for (int way = 0; way < WAYS; way++) {
    for (size_t i = 0; i < t->n; i++)
      t->dot[i].key = key_of(t, way, t->dot[i].x);
    qsort(t->dot, t->n, sizeof *t->dot, by_key);
    for (int n = 2; n <= most; n++) {
      struct lines lines;

      lines_of(t, way, n, cells, &lines);
      if (lines.cost < best[n].cost) best[n] = lines;
    }
  }
  while (most > 1 && !(best[most].cost <= rib_share * cells)) most--;
  return most > 1 ? add_ribs(to, t, number, &best[most]) : VG_OK;
}

/* --- dots ---------------------------------------------------------------- */

static int interval_of(const struct vg_lattice *l, int axis, double x)
{
  int k = 0;

  while (k < l->n[axis] && x > l->at[axis][k]) k++;
  return k;
}

static int by_tile(const void *a, const void *b)
{
  const struct dot *s = a, *t = b;

  if (s->tile != t->tile) return s->tile < t->tile ? -1 : 1;
  return (s->number > t->number) - (s->number < t->number);
}

static vg_status find_dots(const struct vg_load *load,
                           const struct vg_lattice *l, int axis, int i,
                           size_t *n, struct dot **dot, struct vg_error *err)
{
  int b = (axis + 1) % 3, c = (axis + 2) % 3;
  size_t cap = 0;

  for (size_t k = 0; k < load->n; k++) {
    const struct vg_load_octant *q = &load->octant[k];
    double half = (double)q->half, h = (double)q->across[axis];
    double x[2] = { (double)q->at[b], (double)q->at[c] };

    if (fabs((double)q->at[axis] - l->at[axis][i]) > half) continue;
    if (vg_reserve(dot, &cap, *n + 1, sizeof **dot))
      return vg_fail_memory(err, "cutting a front");
    (*dot)[*n] = (struct dot){
      .tile = (size_t)(interval_of(l, b, x[0]) +
                       (l->n[b] + 1) * interval_of(l, c, x[1])),
      .number = k,
      .x = { x[0], x[1] },
      .half = half,
      .h = { (double)q->across[b], (double)q->across[c] },
      .cells = (double)q->cells * fmin(VG_TILE_REACH * h / half, 1)
    };
    ++*n;
  }
  qsort(*dot, *n, sizeof **dot, by_tile);
  return VG_OK;
}

static void bound_tile(const struct vg_load *load, const struct vg_lattice *l,
                       size_t number, struct tile *t)
{
  size_t m[2];

  m[0] = number % (size_t)(l->n[t->axis[0]] + 1);
  m[1] = number / (size_t)(l->n[t->axis[0]] + 1);
  for (int k = 0; k < 2; k++) {
    const double *at = l->at[t->axis[k]];
    int last = l->n[t->axis[k]];

    t->lo[k] = m[k] > 0 ? at[m[k] - 1] : vg_load_quantile(load, t->axis[k], 0);
    t->hi[k] = (int)m[k] < last ? at[m[k]]
                                : vg_load_quantile(load, t->axis[k], 1);
  }
}

/* first: number of its first tile. */
static vg_status part_plane(struct ribs *to, const struct vg_load *load,
                            int axis, int i, int first)
{
  const struct vg_lattice *l = to->lattice;
  struct tile t = { axis, { (axis + 1) % 3, (axis + 2) % 3 }, { 0 }, { 0 }, 0,
                    NULL };
  struct dot *dot = NULL;
  size_t n = 0, at = 0;
  vg_status st = find_dots(load, l, axis, i, &n, &dot, to->err);

  while (st == VG_OK && at < n) {
    size_t number = dot[at].tile;

    t.dot = &dot[at];
    for (t.n = 0; at < n && dot[at].tile == number; at++) t.n++;
    bound_tile(load, l, number, &t);
    st = part_tile(to, &t, first + (int)number);
  }
  free(dot);
  return st;
}

vg_status vg_lattice_add_ribs(const struct vg_load *load,
                              const struct vg_cut_rule *rule,
                              struct vg_lattice *l, struct vg_error *err)
{
  double piece = rule->leaf_cells > 0 ? piece_share * rule->leaf_cells
                                      : most_piece;
  struct ribs to = { fmin(fmax(piece, least_piece), most_piece), 0, l, err };
  int tile = 0;
  vg_status st = VG_OK;

  assert(!l->n_rib && !l->rib);
  for (int axis = 0; axis < 3; axis++)
    for (int i = 0; i < l->n[axis] && st == VG_OK; i++) {
      st = part_plane(&to, load, axis, i, tile);
      tile += (l->n[(axis + 1) % 3] + 1) * (l->n[(axis + 2) % 3] + 1);
    }
  return st;
}
