/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Shells of a void, determined from the edges of its front. Where more than
 * two triangles meet at an edge, two neighbouring triangles with the void
 * between them belong to the same shell. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/mesher/mesher_parts.h"

struct edge {
  uint32_t v[2], face; /* v[0] < v[1] */
  int is_along;        /* face runs from v[0] to v[1] */
  double angle;        /* position around an edge with more than two
                          triangles, relative to the first one: 0 to 4, one
                          unit per quarter turn */
};

struct work {
  const struct vg_mesher_front *f;
  struct edge *edge;       /* [3 n_face] */
  uint32_t *shell, *piece; /* [n_face] forests of base/union_find.h */
};

void vg_mesher_shells_release(struct vg_mesher_shells *s)
{
  free(s->of);
  free(s->piece);
  free(s->shell_of);
  free(s->is_hollow);
  free(s->largest);
  memset(s, 0, sizeof *s);
}

void vg_mesher_normal(const struct vg_mesher_front *f, size_t face, double n[3])
{
  const double *a = f->x[f->face[face][0]], *b = f->x[f->face[face][1]];
  const double *c = f->x[f->face[face][2]];

  assert(face < f->n_face && n);
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;

    n[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
  }
}

static int by_points(const void *a, const void *b)
{
  const struct edge *x = a, *y = b;

  if (x->v[0] != y->v[0]) return x->v[0] < y->v[0] ? -1 : 1;
  if (x->v[1] != y->v[1]) return x->v[1] < y->v[1] ? -1 : 1;
  return (x->face > y->face) - (x->face < y->face);
}

static int by_angle(const void *a, const void *b)
{
  const struct edge *x = a, *y = b;

  if (x->angle < y->angle) return -1;
  return x->angle > y->angle ? 1 : (x->face > y->face) - (x->face < y->face);
}

/* A monotone function of the angle (x, y), cheaper than the angle itself. */
static double turn(double x, double y)
{
  double sum = fabs(x) + fabs(y), t = sum > 0 ? y / sum : 0;

  return x < 0 ? 2 - t : t < 0 ? 4 + t : t;
}

static void cross(const double a[3], const double b[3], double n[3])
{
  for (int k = 0; k < 3; k++)
    n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Vector from the edge to the third point of a triangle, perpendicular to the
 * edge. */
static void arm(const struct vg_mesher_front *f, const struct edge *e,
                const double along[3], double out[3])
{
  const uint32_t *v = f->face[e->face];
  uint32_t third = v[0] ^ v[1] ^ v[2] ^ e->v[0] ^ e->v[1];
  double share;

  for (int k = 0; k < 3; k++) out[k] = f->x[third][k] - f->x[e->v[0]][k];
  share = dot(out, along);
  for (int k = 0; k < 3; k++) out[k] -= share * along[k];
}

/* Around the edge, the void lies after a triangle that runs along it, and
 * before the next triangle. */
static void pair_around(const struct work *w, struct edge *e, size_t n)
{
  double along[3], u[3], v[3], at[3], length;

  for (int k = 0; k < 3; k++)
    along[k] = w->f->x[e->v[1]][k] - w->f->x[e->v[0]][k];
  length = sqrt(dot(along, along));
  for (int k = 0; k < 3 && length > 0; k++) along[k] /= length;
  arm(w->f, e, along, u);
  cross(along, u, v);
  e->angle = 0;
  for (size_t i = 1; i < n; i++) {
    arm(w->f, e + i, along, at);
    e[i].angle = turn(dot(at, u), dot(at, v));
  }
  qsort(e, n, sizeof *e, by_angle);
  for (size_t i = 0; i < n; i++)
    if (e[i].is_along) vg_union(w->shell, e[i].face, e[(i + 1) % n].face);
}

static void join(const struct work *w)
{
  size_t n = 3 * w->f->n_face, end;

  for (uint32_t i = 0; i < w->f->n_face; i++) w->shell[i] = w->piece[i] = i;
  for (size_t i = 0; i < n; i++) {
    uint32_t a = w->f->face[i / 3][i % 3], b = w->f->face[i / 3][(i + 1) % 3];

    w->edge[i] = (struct edge){
      { a < b ? a : b, a < b ? b : a }, (uint32_t)(i / 3), a < b, 0
    };
  }
  qsort(w->edge, n, sizeof *w->edge, by_points);
  for (size_t i = 0; i < n; i = end) {
    struct edge *e = w->edge + i;

    for (end = i + 1; end < n && w->edge[end].v[0] == e->v[0] &&
                      w->edge[end].v[1] == e->v[1];
         end++) {
    }
    if (end > i + 2) {
      pair_around(w, e, end - i);
    } else if (end == i + 2) {
      vg_union(w->shell, e[0].face, e[1].face);
      vg_union(w->piece, e[0].face, e[1].face);
    }
  }
}

/* Number the sets in the order of their lowest faces. */
static size_t number(uint32_t *up, size_t n, uint32_t *to)
{
  size_t next = 0;

  for (uint32_t i = 0; i < n; i++) {
    uint32_t root = vg_root_of(up, i);

    to[i] = root == i ? (uint32_t)next++ : to[root];
  }
  return next;
}

/* Normals point into the void, so out of a hollow shell. */
static void measure(const struct vg_mesher_front *f, struct vg_mesher_shells *s,
                    double (*sum)[2])
{
  for (size_t i = 0; i < f->n_face; i++) {
    const double *a = f->x[f->face[i][0]];
    double n[3], area2 = 0, *of = sum[s->of[i]];

    vg_mesher_normal(f, i, n);
    for (int k = 0; k < 3; k++) {
      of[0] += n[k] * (a[k] - f->x[0][k]);
      area2 += n[k] * n[k];
    }
    if (area2 <= of[1]) continue;
    of[1] = area2;
    s->largest[s->of[i]] = i;
  }
  for (size_t k = 0; k < s->n; k++) {
    s->is_hollow[k] = sum[k][0] > 0;
    s->n_hollow += s->is_hollow[k];
  }
}

static int describe(const struct work *w, struct vg_mesher_shells *s)
{
  double(*sum)[2];

  join(w);
  s->n = number(w->shell, w->f->n_face, s->of);
  s->n_piece = number(w->piece, w->f->n_face, s->piece);
  sum = vg_calloc(s->n, sizeof *sum);
  s->is_hollow = vg_calloc(s->n, sizeof *s->is_hollow);
  s->largest = vg_calloc(s->n, sizeof *s->largest);
  s->shell_of = vg_calloc(s->n_piece, sizeof *s->shell_of);
  if (!sum || !s->is_hollow || !s->largest || !s->shell_of) {
    free(sum);
    return -1;
  }
  for (size_t i = 0; i < w->f->n_face; i++) s->shell_of[s->piece[i]] = s->of[i];
  measure(w->f, s, sum);
  free(sum);
  return 0;
}

int vg_mesher_find_shells(const struct vg_mesher_front *f,
                          struct vg_mesher_shells *out)
{
  struct work w = { f, vg_alloc(f->n_face, 3 * sizeof *w.edge),
                    vg_alloc(f->n_face, sizeof *w.shell),
                    vg_alloc(f->n_face, sizeof *w.piece) };
  struct vg_mesher_shells s = { 0 };
  int bad;

  assert(f && out);
  s.of = vg_alloc(f->n_face, sizeof *s.of);
  s.piece = vg_alloc(f->n_face, sizeof *s.piece);
  bad = !w.edge || !w.shell || !w.piece || !s.of || !s.piece ||
        describe(&w, &s);
  free(w.edge);
  free(w.shell);
  free(w.piece);
  if (bad) vg_mesher_shells_release(&s);
  else *out = s;
  return bad ? -1 : 0;
}
