/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Swaps: a face is replaced by an edge (2-3), or an edge by the best
 * triangulation of the polygon around it (3-2, 4-4, ... by dynamic
 * programming: Shewchuk, "Two discrete optimization algorithms for the
 * topological improvement of tetrahedral meshes", 2002). A swap is made if the
 * worst cell of the new configuration is better than the worst cell of the old
 * one. */
#include <assert.h>
#include <math.h>

#include "core/geometry/vector.h"
#include "core/optimise/optimise_parts.h"

/* Smallest gain that justifies a swap; also prevents rounding from causing
 * endless swaps. */
static const double gain = 1.0001; /* K41 */

static double worth(double old)
{
  return old < VG_SHAPE_FLAT ? VG_SHAPE_FLAT : old * gain;
}

/* --- face removal: 2 cells to 3 ------------------------------------------- */

static int swap_face(struct vg_optimiser *o, uint32_t c, int i)
{
  const struct vg_tets *t = o->t;
  uint32_t link = t->cell[c].link[i], other = link >> 2, old[2] = { c, other };
  uint32_t a, b, v[3][4];
  double need;
  float q[3];

  if (link == VG_NONE || t->flag[c] >> i & 1) return 0;
  need = worth(o->q[c] < o->q[other] ? o->q[c] : o->q[other]);
  a = t->cell[c].v[i];
  b = t->cell[other].v[link & 3];
  for (int k = 0; k < 3; k++) {
    uint32_t from = t->cell[c].v[vg_face[i][k]];
    uint32_t to = t->cell[c].v[vg_face[i][(k + 1) % 3]];
    double s = vg_shape_of(o, from, to, b, a);

    if (s <= need) return 0;
    q[k] = (float)s;
    v[k][0] = from;
    v[k][1] = to;
    v[k][2] = b;
    v[k][3] = a;
  }
  if (vg_replace(o, 2, old, 3, (const uint32_t(*)[4])v, q, NULL)) return 0;
  o->report->n_flip++;
  return 1;
}

/* --- edge removal --------------------------------------------------------- */

struct ring_plan {
  const struct vg_optimiser *o;
  uint32_t a, b, ring[VG_SHELL_MAX];
  double need;
  double best[VG_SHELL_MAX][VG_SHELL_MAX]; /* for the polygon i..j */
  int split[VG_SHELL_MAX][VG_SHELL_MAX];
  int n_new;
  uint32_t v[2 * VG_SHELL_MAX][4];
  float q[2 * VG_SHELL_MAX];
};

/* Shape of the worse of the two cells on triangle i k j of the ring. */
static double triangle_shape(const struct ring_plan *r, int i, int k, int j)
{
  const uint32_t *v = r->ring;
  double lo = vg_shape_of(r->o, v[i], v[k], v[j], r->b), hi;

  if (lo <= r->need) return 0;
  hi = vg_shape_of(r->o, v[i], v[j], v[k], r->a);
  return hi < lo ? hi : lo;
}

/* Best triangulation of every sub-polygon, short ones first. */
static int plan_ring(struct ring_plan *r, int n)
{
  for (int i = 0; i + 1 < n; i++) r->best[i][i + 1] = 1;
  for (int span = 2; span < n; span++)
    for (int i = 0; i + span < n; i++) {
      int j = i + span;

      r->best[i][j] = 0;
      for (int k = i + 1; k < j; k++) {
        double q = r->best[i][k] < r->best[k][j] ? r->best[i][k]
                                                 : r->best[k][j];

        if (q <= r->need || q <= r->best[i][j]) continue;
        {
          double s = triangle_shape(r, i, k, j);

          if (s < q) q = s;
        }
        if (q <= r->need || q <= r->best[i][j]) continue;
        r->best[i][j] = q;
        r->split[i][j] = k;
      }
    }
  return r->best[0][n - 1] > r->need;
}

static void emit(struct ring_plan *r, uint32_t a, uint32_t b, uint32_t c,
                 uint32_t d)
{
  r->q[r->n_new] = (float)vg_shape_of(r->o, a, b, c, d);
  r->v[r->n_new][0] = a;
  r->v[r->n_new][1] = b;
  r->v[r->n_new][2] = c;
  r->v[r->n_new++][3] = d;
}

static void emit_polygon(struct ring_plan *r, int i, int j)
{
  int k;

  if (j - i < 2) return;
  k = r->split[i][j];
  emit(r, r->ring[i], r->ring[k], r->ring[j], r->b);
  emit(r, r->ring[i], r->ring[j], r->ring[k], r->a);
  emit_polygon(r, i, k);
  emit_polygon(r, k, j);
}

static int remove_edge(struct vg_optimiser *o, uint32_t c, int i, int j)
{
  struct ring_plan r;
  uint32_t cell[VG_SHELL_MAX];
  double worst;
  int n;

  r.o = o;
  r.a = o->t->cell[c].v[i];
  r.b = o->t->cell[c].v[j];
  n = vg_cavity_ring(o->t, c, r.a, r.b, VG_SHELL_MAX, 0, cell, r.ring);
  if (n < 3) return 0;
  worst = o->q[cell[0]];
  for (int k = 1; k < n; k++)
    if (o->q[cell[k]] < worst) worst = o->q[cell[k]];
  r.need = worth(worst);
  if (!plan_ring(&r, n)) return 0;
  r.n_new = 0;
  emit_polygon(&r, 0, n - 1);
  if (vg_replace(o, n, cell, r.n_new, (const uint32_t(*)[4])r.v, r.q, NULL))
    return 0;
  o->report->n_flip++;
  return 1;
}

/* Would the removal of the edge between the faces with normals n and m, which
 * point into the cell, leave a better shape than `need` at the opposite edge,
 * which joins these faces? The removal divides the angle there in two, of which
 * the smaller one has at most the squared sine (1 - cos) / 2. */
static int may_divide(const double n[3], const double m[3], double need)
{
  double minus_cos = vg_dot(n, m), most = 1 - 2 * need;

  return minus_cos > 0 || most < 0 ||
         minus_cos * minus_cos < most * most * vg_dot(n, n) * vg_dot(m, m);
}

/* The same in a metric M. inner, n2, m2: the products n' M^(-1) m of the
 * normals with each other and with themselves. Half of the angle a at the
 * opposite edge leaves a cube of the mean ratio of at most
 * 8 sin^2 a / (3 - cos a)^2. */
static int may_divide_in_metric(double inner, double n2, double m2, double need)
{
  double cosine = -inner / sqrt(n2 * m2), half;

  if (!(cosine > -7.0 / 9)) return 1; /* half is above that of a regular cell */
  half = 3 - sqrt(0.5 * (1 + cosine));
  return 4 * (1 - cosine) > need * half * half;
}

/* Normals of the faces of cell c, which point into it. */
static void face_normals(const struct vg_tets *t, uint32_t c, double n[4][3])
{
  const uint32_t *v = t->cell[c].v;
  double a[3], b[3];

  for (int i = 0; i < 4; i++) {
    const double *from = t->x[v[vg_face[i][0]]];

    vg_sub(t->x[v[vg_face[i][1]]], from, a);
    vg_sub(t->x[v[vg_face[i][2]]], from, b);
    vg_cross(a, b, n[i]);
  }
}

static unsigned edges_in_metric(const struct vg_optimiser *o, uint32_t c)
{
  double n[4][3], mn[4][3], square[4], inverse[6], need = worth(o->q[c]);
  unsigned bits = 0;

  vg_tensor_invert(vg_metrics_finest(o->metrics, o->t->cell[c].v)->m, inverse);
  face_normals(o->t, c, n);
  for (int i = 0; i < 4; i++) {
    vg_tensor_apply(inverse, n[i], mn[i]);
    square[i] = vg_dot(n[i], mn[i]);
  }
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++)
      bits |= (unsigned)may_divide_in_metric(vg_dot(n[i], mn[j]), square[i],
                                             square[j], need)
           << (4 * i + j);
  return bits;
}

/* Bits 4 i + j: the edge of corners i < j may be removed. */
static unsigned edges_to_remove(const struct vg_optimiser *o, uint32_t c)
{
  double n[4][3], need = worth(o->q[c]);
  unsigned bits = 0;

  if (o->metrics) return edges_in_metric(o, c);
  if (need >= 0.5) return ~0u;
  face_normals(o->t, c, n);
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++)
      bits |= (unsigned)may_divide(n[i], n[j], need) << (4 * i + j);
  return bits;
}

int vg_swap(struct vg_optimiser *o, uint32_t c)
{
  assert(c < o->t->n_cell);
  unsigned edges = edges_to_remove(o, c);

  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++)
      if (edges >> (4 * i + j) & 1 && remove_edge(o, c, i, j)) return 1;
  for (int i = 0; i < 4; i++)
    if (swap_face(o, c, i)) return 1;
  return 0;
}
