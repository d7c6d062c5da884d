/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: points that are extreme in many directions represent the convex
 * hull. Each triangle is on the hull or off it, and union-find over the edges
 * joins triangles of either kind into pieces. The largest piece on the hull is
 * compared with the silhouettes of the hull, every piece off the hull with its
 * lid. A closed surface has vector area 0, so the lid of a piece has the same
 * vector area as the piece. */
#include "core/surface/envelope.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"

#define REACH 3 /* directions: integer points on the faces of a cube */
#define N_DIRECTION (7 * 7 * 7 - 5 * 5 * 5)
#define BOX 64    /* points per box */
#define SLACK 0.1 /* of the longest edge: rounding, chords, diagonals */

struct piece {
  double area, vector[3];
  size_t n;
};

struct envelope {
  const struct vg_mesh *m;
  size_t n_extreme;
  uint32_t extreme[N_DIRECTION];
  uint8_t *on;         /* [n_tri] 1: on the hull. */
  uint32_t *root;      /* [n_tri] Union-find; then the piece of each
                          triangle. */
  struct piece *piece; /* [n_tri] Data of a piece, at its root. */
  double sign;         /* -1 if normals point inwards. */
};

/* Twice the vector area, pointing outwards. Returns the squared longest
 * edge. */
static double face(const struct envelope *e, size_t i, double n[3])
{
  const double *p[3];
  double u[3][3], longest = 0;

  for (int k = 0; k < 3; k++) p[k] = e->m->point[e->m->tri[i][k]];
  for (int k = 0; k < 3; k++) {
    for (int c = 0; c < 3; c++) u[k][c] = p[(k + 1) % 3][c] - p[k][c];
    if (vg_dot(u[k], u[k]) > longest) longest = vg_dot(u[k], u[k]);
  }
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;

    n[c] = e->sign * (u[0][a] * u[1][b] - u[0][b] * u[1][a]);
  }
  return longest;
}

/* Bounding boxes of consecutive points, most of which are neighbours. */
struct box {
  double lo[3], hi[3];
};

static void find_boxes(const struct vg_mesh *m, size_t n, struct box *box)
{
  for (size_t i = 0; i < n; i++) {
    box[i] = (struct box){ { INFINITY, INFINITY, INFINITY },
                           { -INFINITY, -INFINITY, -INFINITY } };
    for (size_t p = BOX * i; p < m->n_point && p < BOX * (i + 1); p++)
      for (int c = 0; c < 3; c++) {
        if (m->point[p][c] < box[i].lo[c]) box[i].lo[c] = m->point[p][c];
        if (m->point[p][c] > box[i].hi[c]) box[i].hi[c] = m->point[p][c];
      }
  }
}

/* The first of the points that are farthest along d, starting from point `at`.
 * No point of a box is farther than its corner, even with rounding. */
static uint32_t extreme(const struct vg_mesh *m, size_t n_box,
                        const struct box *box, const double d[3], uint32_t at)
{
  double best = vg_dot(d, m->point[at]);

  for (size_t i = 0; i < n_box; i++) {
    double most[3];

    for (int c = 0; c < 3; c++)
      most[c] = d[c] > 0 ? box[i].hi[c] : box[i].lo[c];
    if (!(vg_dot(d, most) >= best)) continue;
    for (size_t p = BOX * i; p < m->n_point && p < BOX * (i + 1); p++) {
      const double s = vg_dot(d, m->point[p]);

      if (s > best || (s == best && p < at)) best = s, at = (uint32_t)p;
    }
  }
  return at;
}

static vg_status find_extremes(struct envelope *e, struct vg_error *err)
{
  const size_t n = (e->m->n_point + BOX - 1) / BOX;
  struct box *box = vg_alloc(n, sizeof *box);
  uint32_t at = 0; /* next directions are similar: a good start */

  if (!box) return vg_fail_memory(err, "the pieces of the surface");
  find_boxes(e->m, n, box);
  for (int i = -REACH; i <= REACH; i++)
    for (int j = -REACH; j <= REACH; j++)
      for (int k = -REACH; k <= REACH; k++) {
        const double d[3] = { i, j, k };

        if (abs(i) != REACH && abs(j) != REACH && abs(k) != REACH) continue;
        at = extreme(e->m, n, box, d, at);
        e->extreme[e->n_extreme++] = at;
      }
  free(box);
  return VG_OK;
}

/* Is triangle i on the hull?
 *
 * @param above  in: extreme point above the previous triangle, tested first;
 *               out: the one tested last */
static int is_on_hull(const struct envelope *e, size_t i, size_t *above)
{
  const double *o = e->m->point[e->m->tri[i][0]];
  double n[3], most;
  size_t k = *above;

  most = face(e, i, n);
  most = SLACK * sqrt(most * vg_dot(n, n));
  for (size_t j = 0; j < e->n_extreme; j++) {
    const double *x = e->m->point[e->extreme[k]];
    const double d[3] = { x[0] - o[0], x[1] - o[1], x[2] - o[2] };

    *above = k;
    if (vg_dot(d, n) > most) return 0;
    if (++k == e->n_extreme) k = 0;
  }
  return 1;
}

/* --- pieces -------------------------------------------------------------- */

static vg_status join_pieces(struct envelope *e, struct vg_error *err)
{
  struct vg_edges edges = VG_EDGES_INIT;
  vg_status st = vg_edges_build(&edges, e->m->n_point, e->m->n_tri,
                                (const uint32_t(*)[3])e->m->tri, NULL, 0, err);

  if (st < 0) return st;
  for (size_t i = 0; i < edges.n; i++)
    for (uint32_t k = 1; k < vg_edges_count(&edges, i); k++) {
      const uint32_t *h = vg_edges_at(&edges, i) + k - 1;

      if (e->on[h[0] / 3] == e->on[h[1] / 3])
        vg_union(e->root, h[1] / 3, h[0] / 3);
    }
  vg_edges_release(&edges);
  return VG_OK;
}

static void measure_pieces(struct envelope *e)
{
  for (uint32_t i = 0; i < e->m->n_tri; i++) {
    struct piece *p = &e->piece[e->root[i] = vg_root_of(e->root, i)];
    double n[3];

    face(e, i, n);
    p->area += sqrt(vg_dot(n, n));
    for (int c = 0; c < 3; c++) p->vector[c] += n[c];
    p->n++;
  }
}

/* --- silhouettes --------------------------------------------------------- */

static int by_position(const void *pa, const void *pb)
{
  const double *a = pa, *b = pb;

  if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
  return (a[1] > b[1]) - (a[1] < b[1]);
}

static double turn(const double a[2], const double b[2], const double c[2])
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Twice the area of the convex hull of sorted points: lower and upper monotone
 * chains, summed as triangles with the first point. */
static double hull_area(size_t n, const double (*p)[2])
{
  double chain[N_DIRECTION][2], sum = 0;

  for (int way = 1; way >= -1; way -= 2) {
    size_t k = 0;

    for (size_t i = 0; i < n; i++) {
      while (k > 1 && way * turn(chain[k - 2], chain[k - 1], p[i]) <= 0) k--;
      memcpy(chain[k++], p[i], sizeof chain[0]);
    }
    for (size_t i = 1; i + 1 < k; i++)
      sum += way * turn(chain[0], chain[i], chain[i + 1]);
  }
  return sum;
}

/* The least fraction of the silhouette that a piece covers, over six views. */
static double least_cover(const struct envelope *e, uint32_t piece)
{
  double seen[6] = { 0 }, least = INFINITY;

  for (size_t i = 0; i < e->m->n_tri; i++) {
    double n[3];

    if (e->root[i] != piece) continue;
    face(e, i, n);
    for (int k = 0; k < 3; k++) seen[2 * k + (n[k] > 0)] += fabs(n[k]);
  }
  for (int k = 0; k < 3; k++) {
    double p[N_DIRECTION][2], area;

    for (size_t i = 0; i < e->n_extreme; i++) {
      p[i][0] = e->m->point[e->extreme[i]][(k + 1) % 3];
      p[i][1] = e->m->point[e->extreme[i]][(k + 2) % 3];
    }
    qsort(p, e->n_extreme, sizeof *p, by_position);
    area = hull_area(e->n_extreme, (const double(*)[2])p);
    for (int s = 0; s < 2; s++)
      if (!(seen[2 * k + s] >= least * area))
        least = area > 0 ? seen[2 * k + s] / area : 0;
  }
  return least;
}

static void judge(const struct envelope *e, uint8_t *outer,
                  struct vg_envelope *out)
{
  uint32_t main = UINT32_MAX;

  for (uint32_t i = 0; i < e->m->n_tri; i++) {
    const struct piece *p = &e->piece[i];
    const double lid = sqrt(vg_dot(p->vector, p->vector));

    if (!p->n) continue;
    if (e->on[i]) {
      if (main == UINT32_MAX || p->area > e->piece[main].area) main = i;
    } else if (p->area > out->depth * lid) {
      out->depth = p->area / lid;
      out->n_pocket_tri = p->n;
    }
  }
  for (size_t i = 0; outer && i < e->m->n_tri; i++)
    outer[i] = e->root[i] == main;
  if (main == UINT32_MAX) return;
  out->n_outer = e->piece[main].n;
  out->covered = least_cover(e, main);
  out->is_domain = out->covered >= VG_ENVELOPE_COVERED &&
                   out->depth >= VG_ENVELOPE_DEPTH;
}

/* Six times the volume enclosed by the triangles, relative to the first
 * point. */
static double signed_volume(const struct envelope *e)
{
  const double *o = e->m->point[0];
  double sum = 0;

  for (size_t i = 0; i < e->m->n_tri; i++) {
    const double *x = e->m->point[e->m->tri[i][0]];
    const double d[3] = { x[0] - o[0], x[1] - o[1], x[2] - o[2] };
    double n[3];

    face(e, i, n);
    sum += vg_dot(d, n);
  }
  return sum;
}

vg_status vg_envelope_measure(const struct vg_mesh *m, uint8_t *outer,
                              struct vg_envelope *out, struct vg_error *err)
{
  struct envelope e = { .m = m, .sign = 1 };
  struct vg_envelope found = { 0 };
  size_t above = 0;
  vg_status st = VG_OK;

  assert(m && out);
  if (m->n_tri) {
    e.on = vg_alloc(m->n_tri, 1);
    e.root = vg_alloc(m->n_tri, sizeof *e.root);
    e.piece = vg_calloc(m->n_tri, sizeof *e.piece);
    if (!e.on || !e.root || !e.piece)
      VG_TRY(vg_fail_memory(err, "the pieces of the surface"));
    if (signed_volume(&e) < 0) e.sign = -1;
    VG_TRY(find_extremes(&e, err));
    for (uint32_t i = 0; i < m->n_tri; i++) {
      e.on[i] = (uint8_t)is_on_hull(&e, i, &above);
      e.root[i] = i;
    }
    VG_TRY(join_pieces(&e, err));
    measure_pieces(&e);
    judge(&e, outer, &found);
  }
  *out = found;
done:
  free(e.on);
  free(e.root);
  free(e.piece);
  return st;
}
