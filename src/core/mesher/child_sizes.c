/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Target edge lengths from the other side of a socket. Asking for each of them
 * would take longer than the meshing. They are therefore cached on an octree
 * over the box of the front and interpolated trilinearly. Cells are split if
 * they are longer than the smallest length at their corners. The children of a
 * cell are requested together when a point in the cell is first looked up. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/child.h"
#include "base/memory.h"
#include "core/mesher/mesher_parts.h"

#define DEPTH 40 /* more levels than doubles can resolve */

struct node {
  uint32_t child; /* first of eight children; 0: not split (yet) */
  float h[8];     /* lengths at its corners, x first */
};

struct vg_child_sizes {
  int in, out; /* descriptors of the parent's answers and of questions */
  double lo[3], side;
  struct node *node;
  size_t n, room;
};

static void ask(const struct vg_child_sizes *s, size_t n, const double (*x)[3],
                double *h)
{
  const struct vg_helper_message w = { .what = VG_HELPER_SIZES, .n = { n } };
  struct vg_helper_message a;

  if (!vg_child_put(s->out, &w, sizeof w) ||
      !vg_child_put(s->out, x, n * sizeof *x) ||
      !vg_child_get(s->in, &a, sizeof a) || a.what != VG_HELPER_LENGTHS ||
      a.n[0] != n || !vg_child_get(s->in, h, n * sizeof *h))
    _exit(1);
}

static void find_box(struct vg_child_sizes *s, const struct vg_mesher_front *f)
{
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (int k = 0; k < 3; k++) s->lo[k] = INFINITY;
  for (size_t i = 0; i < f->n_point; i++)
    for (int k = 0; k < 3; k++) {
      s->lo[k] = fmin(s->lo[k], f->x[i][k]);
      hi[k] = fmax(hi[k], f->x[i][k]);
    }
  for (int k = 0; k < 3; k++) s->side = fmax(s->side, hi[k] - s->lo[k]);
}

void vg_child_sizes_free(struct vg_child_sizes *s)
{
  if (s) free(s->node);
  free(s);
}

struct vg_child_sizes *vg_child_sizes_new(int in, int out,
                                          const struct vg_mesher_front *f)
{
  struct vg_child_sizes *s = vg_calloc(1, sizeof *s);
  double x[8][3], h[8];

  assert(in >= 0 && out >= 0 && f && f->n_point);
  if (!s || vg_reserve(&s->node, &s->room, 1, sizeof *s->node)) {
    vg_child_sizes_free(s);
    return NULL;
  }
  s->in = in;
  s->out = out;
  find_box(s, f);
  for (int c = 0; c < 8; c++)
    for (int k = 0; k < 3; k++) x[c][k] = s->lo[k] + (c >> k & 1) * s->side;
  ask(s, 8, (const double(*)[3])x, h);
  s->n = 1;
  s->node[0].child = 0;
  for (int c = 0; c < 8; c++) s->node[0].h[c] = (float)h[c];
  return s;
}

static int wants_split(const struct node *at, double side)
{
  float least = at->h[0];

  for (int c = 1; c < 8; c++) least = at->h[c] < least ? at->h[c] : least;
  return side > (double)least;
}

/* The corners of the children form a grid of 27 points. */
static void split(struct vg_child_sizes *s, uint32_t node, const double lo[3],
                  double side)
{
  double x[27][3], h[27];

  for (int c = 0, i = 0; i < 27; i++) {
    c = i;
    for (int k = 0; k < 3; k++, c /= 3) x[i][k] = lo[k] + c % 3 * (side / 2);
  }
  ask(s, 27, (const double(*)[3])x, h);
  if (s->n > UINT32_MAX - 8 ||
      vg_reserve(&s->node, &s->room, s->n + 8, sizeof *s->node))
    _exit(1);
  for (int c = 0; c < 8; c++) {
    struct node *to = &s->node[s->n + (size_t)c];

    to->child = 0;
    for (int v = 0; v < 8; v++)
      to->h[v] = (float)
        h[(c & 1) + (v & 1) + 3 * ((c >> 1 & 1) + (v >> 1 & 1)) +
          9 * ((c >> 2) + (v >> 2))];
  }
  s->node[node].child = (uint32_t)s->n;
  s->n += 8;
}

static double mean(const struct node *at, const double t[3])
{
  double sum = 0;

  for (int c = 0; c < 8; c++) {
    double w = at->h[c];

    for (int k = 0; k < 3; k++) w *= c >> k & 1 ? t[k] : 1 - t[k];
    sum += w;
  }
  return sum;
}

static double look_up(struct vg_child_sizes *s, const double x[3])
{
  double lo[3], t[3], side = s->side;
  uint32_t node = 0;

  memcpy(lo, s->lo, sizeof lo);
  for (int depth = 0;; depth++) {
    int c = 0;

    for (int k = 0; k < 3; k++) {
      t[k] = side > 0 ? (x[k] - lo[k]) / side : 0;
      t[k] = t[k] > 0 ? t[k] < 1 ? t[k] : 1 : 0;
    }
    if (depth == DEPTH || !wants_split(&s->node[node], side))
      return mean(&s->node[node], t);
    if (!s->node[node].child) split(s, node, lo, side);
    side /= 2;
    for (int k = 0; k < 3; k++)
      if (t[k] >= 0.5) {
        c |= 1 << k;
        lo[k] += side;
      }
    node = s->node[node].child + (uint32_t)c;
  }
}

void vg_child_sizes_at(void *sizes, size_t n, const double (*x)[3], double *h)
{
  for (size_t i = 0; i < n; i++) h[i] = look_up(sizes, x[i]);
}
