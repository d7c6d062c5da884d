/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Uses signs of determinants only (the idea of Guigue and Devillers, J.
 * Graphics Tools 8, 2003): two triangles intersect if and only if an edge of
 * one intersects the other. Shared nodes are recognised first, by their
 * indices. */
#include "core/geometry/triangles.h"

#include <assert.h>

#include "core/geometry/predicates.h"

static int sign(double x)
{
  return (x > 0) - (x < 0);
}

static int side(const double *a, const double *b, const double *c,
                const double *d)
{
  return sign(vg_orient3d(a, b, c, d));
}

/* --- coplanar triangles --------------------------------------------------- */

struct plane {
  int i, j; /* coordinates kept by the projection */
};

static int turn(struct plane e, const double *a, const double *b,
                const double *c)
{
  double p[2] = { a[e.i], a[e.j] }, q[2] = { b[e.i], b[e.j] };
  double r[2] = { c[e.i], c[e.j] };

  return sign(vg_orient2d(p, q, r));
}

/* The coordinate projection in which the triangle has the largest area, up to
 * rounding; always one in which its area is nonzero. */
static struct plane plane_of(const double *const t[3])
{
  static const struct plane list[3] = { { 1, 2 }, { 2, 0 }, { 0, 1 } };
  double size[3];
  int most = 0;

  for (int k = 0; k < 3; k++) {
    int i = list[k].i, j = list[k].j;

    size[k] = fabs((t[1][i] - t[0][i]) * (t[2][j] - t[0][j]) -
                   (t[1][j] - t[0][j]) * (t[2][i] - t[0][i]));
    if (size[k] > size[most]) most = k;
  }
  for (int k = 0; k < 2 && !turn(list[most], t[0], t[1], t[2]); k++)
    most = (most + 1) % 3;
  return list[most];
}

static int between(double a, double b, double x)
{
  return a < b ? a <= x && x <= b : b <= x && x <= a;
}

/* Is x, which lies on the line through a and b, within the segment? */
static int on_segment(struct plane e, const double *a, const double *b,
                      const double *x)
{
  return between(a[e.i], b[e.i], x[e.i]) && between(a[e.j], b[e.j], x[e.j]);
}

static int segments_meet(struct plane e, const double *a, const double *b,
                         const double *c, const double *d)
{
  int abc = turn(e, a, b, c), abd = turn(e, a, b, d);
  int cda = turn(e, c, d, a), cdb = turn(e, c, d, b);

  if (!abc && !abd)
    return on_segment(e, a, b, c) || on_segment(e, a, b, d) ||
           on_segment(e, c, d, a);
  return abc * abd <= 0 && cda * cdb <= 0;
}

static int inside(struct plane e, const double *const t[3], const double *x)
{
  int a = turn(e, t[0], t[1], x), b = turn(e, t[1], t[2], x);
  int c = turn(e, t[2], t[0], x);

  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

static int segment_in_plane(const double *p, const double *q,
                            const double *const t[3])
{
  struct plane e = plane_of(t);

  if (inside(e, t, p) || inside(e, t, q)) return 1;
  for (int k = 0; k < 3; k++)
    if (segments_meet(e, p, q, t[k], t[(k + 1) % 3])) return 1;
  return 0;
}

/* --- separation in a projection ------------------------------------------- */

/* Triangles whose projections are disjoint are disjoint. This test decides
 * most pairs on a smooth surface more cheaply than orientation tests in space.
 * It also decides nearly all pairs on a flat surface, where the determinants
 * in space are exactly zero and therefore expensive. */

/* Does an edge of a separate the triangles, with a on one side and b strictly
 * on the other? */
static int edge_parts(struct plane e, const double *const a[3],
                      const double *const b[3])
{
  int own = turn(e, a[0], a[1], a[2]);

  for (int k = 0; k < 3; k++) {
    const double *p = a[k], *q = a[(k + 1) % 3];

    if (own * turn(e, p, q, b[0]) < 0 && own * turn(e, p, q, b[1]) < 0 &&
        own * turn(e, p, q, b[2]) < 0)
      return 1;
  }
  return 0;
}

/* Is x on the ray from o through p? All three points are collinear. */
static int on_ray(struct plane e, const double *o, const double *p,
                  const double *x)
{
  return !on_segment(e, p, x, o);
}

/* Does the line through the shared node a[0] = b[0] and a[far] separate the
 * triangles? The third corner of a must be strictly on one side and b on the
 * other. A corner of b may lie on the line if it is on the opposite side of
 * the shared node. */
static int line_parts(struct plane e, const double *const a[3], int far,
                      const double *const b[3])
{
  int own = turn(e, a[0], a[far], a[3 - far]);
  int s = own * turn(e, a[0], a[far], b[1]);
  int t = own * turn(e, a[0], a[far], b[2]);

  if (!own || s > 0 || t > 0 || (!s && !t)) return 0;
  return !(!s && on_ray(e, a[0], a[far], b[1])) &&
         !(!t && on_ray(e, a[0], a[far], b[2]));
}

static int node_parts(struct plane e, const double *const a[3],
                      const double *const b[3])
{
  return line_parts(e, a, 1, b) || line_parts(e, a, 2, b) ||
         line_parts(e, b, 1, a) || line_parts(e, b, 2, a);
}

/* --- in space ------------------------------------------------------------- */

/* Does the closed segment p q intersect the closed triangle t? sp and sq are
 * the sides of the plane of t on which p and q lie. */
static int segment_meets(const double *p, const double *q, int sp, int sq,
                         const double *const t[3])
{
  int a, b, c;

  if (sp * sq > 0) return 0;
  if (!sp && !sq) return segment_in_plane(p, q, t);
  a = side(p, q, t[0], t[1]);
  b = side(p, q, t[1], t[2]);
  if (a * b < 0) return 0;
  c = side(p, q, t[2], t[0]);
  return a * c >= 0 && b * c >= 0;
}

/* Triangles without a shared node. */
static int apart_meet(const double *const a[3], const double *const b[3])
{
  struct plane e = plane_of(a);
  int sa[3], sb[3];

  if (edge_parts(e, a, b) || edge_parts(e, b, a)) return 0;
  for (int k = 0; k < 3; k++) sb[k] = side(a[0], a[1], a[2], b[k]);
  if (sb[0] && sb[0] == sb[1] && sb[0] == sb[2]) return 0;
  for (int k = 0; k < 3; k++) sa[k] = side(b[0], b[1], b[2], a[k]);
  if (sa[0] && sa[0] == sa[1] && sa[0] == sa[2]) return 0;
  for (int k = 0; k < 3; k++) {
    int l = (k + 1) % 3;

    if (segment_meets(b[k], b[l], sb[k], sb[l], a)) return 1;
    if (segment_meets(a[k], a[l], sa[k], sa[l], b)) return 1;
  }
  return 0;
}

/* Triangles that share the node a[0] = b[0]. Their intersection is convex and
 * contains this node. If it is more than the node, it reaches the edge of a or
 * of b that is opposite the node. */
static int at_node_meet(const double *const a[3], const double *const b[3])
{
  int sa1, sa2, sb1, sb2;

  if (node_parts(plane_of(a), a, b)) return 0;
  sb1 = side(a[0], a[1], a[2], b[1]);
  sb2 = side(a[0], a[1], a[2], b[2]);
  if (sb1 * sb2 > 0) return 0;
  sa1 = side(b[0], b[1], b[2], a[1]);
  sa2 = side(b[0], b[1], b[2], a[2]);
  if (sa1 * sa2 > 0) return 0;
  return segment_meets(b[1], b[2], sb1, sb2, a) ||
         segment_meets(a[1], a[2], sa1, sa2, b);
}

/* Triangles that share the edge a[0] a[1]. They overlap if they are folded
 * flat onto each other. */
static int at_edge_meet(const double *const a[3], const double *const b[3])
{
  struct plane e = plane_of(a);

  return turn(e, a[0], a[1], a[2]) == turn(e, a[0], a[1], b[2]) &&
         !side(a[0], a[1], a[2], b[2]);
}

int vg_triangles_meet(const double (*point)[3], const uint32_t a[3],
                      const uint32_t b[3], const uint32_t fan_a[3],
                      const uint32_t fan_b[3])
{
  const double *p[3], *q[3];
  int common_a = 0, common_b = 0, n = 0;

  assert(a[0] != a[1] && a[1] != a[2] && a[2] != a[0]);
  assert(b[0] != b[1] && b[1] != b[2] && b[2] != b[0]);
  /* Move shared corners to the front, in the order of a. A node of both
   * triangles whose umbrellas differ is a point where two sheets touch, so the
   * triangles intersect. */
  for (int k = 0; k < 3; k++)
    for (int l = 0; l < 3; l++) {
      if (a[k] != b[l]) continue;
      if (fan_a[k] != fan_b[l]) return 1;
      p[n] = q[n] = point[a[k]];
      n++;
      common_a |= 1 << k;
      common_b |= 1 << l;
    }
  if (n == 3) return 1;
  for (int k = 0, i = n, j = n; k < 3; k++) {
    if (!(common_a >> k & 1)) p[i++] = point[a[k]];
    if (!(common_b >> k & 1)) q[j++] = point[b[k]];
  }
  if (n == 2) return at_edge_meet(p, q);
  return n ? at_node_meet(p, q) : apart_meet(p, q);
}
