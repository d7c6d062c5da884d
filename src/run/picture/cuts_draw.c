/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Draws convex polygons into the samples of a cut. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "run/picture/cuts_parts.h"

/* Distance from an edge, in samples, that the edge darkens. */
#define PEN 1.2
#define THIN (4 * PEN) /* Polygons thinner than this have fainter edges. */

static double least(double a, double b)
{
  return a < b ? a : b;
}
static double most(double a, double b)
{
  return a > b ? a : b;
}

struct tile *vg_cuts_tile(struct tile **at)
{
  struct tile *now = __atomic_load_n(at, __ATOMIC_ACQUIRE), *made;

  if (now) return now;
  made = vg_calloc(1, sizeof *made);
  if (!made) return NULL;
  pthread_mutex_init(&made->lock, NULL);
  if (__atomic_compare_exchange_n(at, &now, made, 0, __ATOMIC_ACQ_REL,
                                  __ATOMIC_ACQUIRE))
    return made;
  pthread_mutex_destroy(&made->lock);
  free(made);
  return now;
}

/* A monotonic function of the angle of d. */
static double turn(const double d[2])
{
  double sum = fabs(d[0]) + fabs(d[1]), t = sum > 0 ? d[1] / sum : 0;

  return d[0] < 0 ? 2 - t : t;
}

/* Sorts corners around their mean: the section of a convex cell is convex. */
static void order(struct polygon *g)
{
  double mean[2] = { 0, 0 }, angle[CORNERS_MAX];

  for (int i = 0; i < g->n; i++)
    for (int k = 0; k < 2; k++) mean[k] += g->p[i][k] / g->n;
  for (int i = 0; i < g->n; i++) {
    double d[2] = { g->p[i][0] - mean[0], g->p[i][1] - mean[1] };
    double p[2] = { g->p[i][0], g->p[i][1] }, a = turn(d);
    int j = i;

    for (; j && angle[j - 1] > a; j--) {
      angle[j] = angle[j - 1];
      memcpy(g->p[j], g->p[j - 1], sizeof p);
    }
    angle[j] = a;
    memcpy(g->p[j], p, sizeof p);
  }
}

/* Lines of the edges: distance = a x + b y + c, > 0 inside. */
struct lines {
  int n;
  double a[CORNERS_MAX], b[CORNERS_MAX], c[CORNERS_MAX], pen;
};

/* Twice the area over the perimeter is about the thickness of a thin polygon,
 * whose black edges would otherwise hide its colour. */
static void find_lines(const struct polygon *g, struct lines *l)
{
  double area = 0, around = 0;

  l->n = 0;
  for (int i = 0; i < g->n; i++) {
    const double *p = g->p[i], *q = g->p[(i + 1) % g->n];

    area += p[0] * q[1] - p[1] * q[0];
  }
  for (int i = 0; i < g->n; i++) {
    const double *p = g->p[i], *q = g->p[(i + 1) % g->n];
    double dx = q[0] - p[0], dy = q[1] - p[1];
    double length = sqrt(dx * dx + dy * dy);
    double scale = length > 0 ? (area < 0 ? -1 : 1) / length : 0;

    around += length;
    if (!(length > 0)) continue;
    l->a[l->n] = -dy * scale;
    l->b[l->n] = dx * scale;
    l->c[l->n] = (dy * p[0] - dx * p[1]) * scale;
    l->n++;
  }
  l->pen = around > 0 ? 2 * fabs(area) / around / THIN : 0;
  if (l->pen > 1) l->pen = 1;
}

/* Samples of a row with centres in the polygon: *from .. *to - 1. An edge
 * intersects the row at the same position for the polygons on both of its
 * sides. */
static void span(const struct polygon *g, double y, double *from, double *to)
{
  *from = INFINITY;
  *to = -INFINITY;
  for (int i = 0; i < g->n; i++) {
    const double *p = g->p[i], *q = g->p[(i + 1) % g->n];
    const double *lo = p[1] < q[1] ? p : q, *hi = p[1] < q[1] ? q : p;
    double x;

    if (!(lo[1] <= y && y < hi[1])) continue;
    x = lo[0] + (hi[0] - lo[0]) * ((y - lo[1]) / (hi[1] - lo[1]));
    *from = least(*from, x);
    *to = most(*to, x);
  }
}

static int whole(double v, int from, int to)
{
  return v < from ? from : v > to ? to : (int)v;
}

static int shade(const struct lines *l, double x, double y)
{
  double near = PEN;

  for (int i = 0; i < l->n; i++)
    near = least(near, l->a[i] * x + l->b[i] * y + l->c[i]);
  near = near < 0 ? 1 : 1 - near / PEN;
  return (int)(SHADE_MAX * near * l->pen + 0.5);
}

/* Samples of a row that no edge darkens: *from .. *to - 1. */
static void inside(const struct lines *l, double y, int *from, int *to)
{
  double lo = *from, hi = *to;

  for (int i = 0; i < l->n; i++) {
    double rest = PEN - l->b[i] * y - l->c[i];

    if (l->a[i] > 0) lo = most(lo, rest / l->a[i] - 0.5);
    else if (l->a[i] < 0) hi = least(hi, rest / l->a[i] + 0.5);
    else if (rest > 0) hi = lo;
  }
  *to = whole(floor(hi), *from, *to);
  *from = whole(ceil(lo), *from, *to);
}

/* row: of a tile that begins at x0. */
static void near_edges(uint16_t *row, int x0, int from, int to, double y,
                       const struct lines *l, uint16_t code)
{
  for (int x = from; x < to; x++) {
    uint16_t here = (uint16_t)(code | shade(l, x + 0.5, y) << 9);

    if (row[x - x0] < here) row[x - x0] = here;
  }
}

/* Range of samples that a polygon may touch; x1 and y1 are excluded. */
struct range {
  int x0, y0, x1, y1;
};

static struct range range_of(const struct polygon *g)
{
  double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };

  for (int i = 0; i < g->n; i++)
    for (int k = 0; k < 2; k++) {
      lo[k] = least(lo[k], g->p[i][k]);
      hi[k] = most(hi[k], g->p[i][k]);
    }
  return (struct range){ whole(ceil(lo[0] - 0.5), 0, SAMPLES * VG_CUT_WIDTH),
                         whole(ceil(lo[1] - 0.5), 0, SAMPLES * VG_CUT_HEIGHT),
                         whole(ceil(hi[0] - 0.5), 0, SAMPLES * VG_CUT_WIDTH),
                         whole(ceil(hi[1] - 0.5), 0, SAMPLES * VG_CUT_HEIGHT) };
}

/* Draws the part of a polygon in a tile that this thread has locked. */
static void draw_tile(struct tile *t, int tx, int ty, const struct range *r,
                      const struct polygon *g, const struct lines *l,
                      uint16_t code)
{
  int y0 = ty * TILE, x0 = tx * TILE, left = r->x0 > x0 ? r->x0 : x0;
  int right = r->x1 < x0 + TILE ? r->x1 : x0 + TILE;
  int end = r->y1 < y0 + TILE ? r->y1 : y0 + TILE;
  double from, to;

  for (int y = r->y0 > y0 ? r->y0 : y0; y < end; y++) {
    uint16_t *row = &t->code[(y - y0) * TILE];
    int first, last, in, out;

    span(g, y + 0.5, &from, &to);
    last = whole(ceil(to - 0.5), left, right);
    first = whole(ceil(from - 0.5), left, last);
    in = first;
    out = last;
    inside(l, y + 0.5, &in, &out);
    near_edges(row, x0, first, in, y + 0.5, l, code);
    for (int x = in - x0; x < out - x0; x++)
      row[x] = row[x] < code ? code : row[x];
    near_edges(row, x0, out > in ? out : in, last, y + 0.5, l, code);
  }
}

vg_status vg_cuts_draw(struct tile **tiles, struct polygon *g, uint16_t code,
                       struct vg_error *err)
{
  struct range r = range_of(g);
  struct lines l;

  if (r.x0 >= r.x1 || r.y0 >= r.y1) return VG_OK;
  order(g);
  find_lines(g, &l);
  for (int ty = r.y0 / TILE; ty <= (r.y1 - 1) / TILE; ty++)
    for (int tx = r.x0 / TILE; tx <= (r.x1 - 1) / TILE; tx++) {
      struct tile *t = vg_cuts_tile(&tiles[ty * TILES_X + tx]);

      if (!t) return vg_fail_memory(err, "pictures of cuts");
      pthread_mutex_lock(&t->lock);
      draw_tile(t, tx, ty, &r, g, &l, code);
      pthread_mutex_unlock(&t->lock);
    }
  return VG_OK;
}
