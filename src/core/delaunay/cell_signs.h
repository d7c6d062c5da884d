/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/delaunay/cell_signs.h: is a point inside the circumsphere of a cell,
 * and on which side of the cell's faces is it? Both are computed together: the
 * insphere determinant is the sum of the cell's four orientations with the
 * point, each multiplied by a squared distance. Decides as
 * core/geometry/predicates.h, but in SIMD lanes. Uses
 * core/delaunay/tets.h. */
#ifndef VG_CORE_DELAUNAY_CELL_SIGNS_H
#define VG_CORE_DELAUNAY_CELL_SIGNS_H

#include <math.h>
#include <stdint.h>

#include "base/wide.h"
#include "core/delaunay/tets.h"

#if defined __x86_64__ && !defined VG_PORTABLE
#include <immintrin.h>
#endif

/* Two lanes, in the vector syntax of GCC and Clang for any processor. */
typedef double vg_d2 __attribute__((vector_size(16)));
typedef int64_t vg_l2 __attribute__((vector_size(16)));

/* Four lanes; two registers without AVX2. */
typedef double vg_d4 __attribute__((vector_size(32)));
typedef int64_t vg_l4 __attribute__((vector_size(32)));

#define VG_PICK4(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#define VG_TURN4(a, ...) __builtin_shufflevector(a, a, __VA_ARGS__)

enum {                      /* result for a point and a positive cell */
       VG_SIDE_IN = 0x01,   /* times 1 << i: strictly on the inner side of
                               face i */
       VG_SIDE_SEES = 0x10, /* times 1 << i: on the inner side of face i or
                               in its plane */
       VG_IN_SPHERE = 0x100 /* strictly inside the sphere; if this is clear,
                               so are all others */
};

/* Reorder bits from lane order, 0 2 1 3, to face order. */
static inline unsigned vg_lane_faces(unsigned m)
{
  return (m & 9) | (m & 2) << 1 | (m & 4) >> 1;
}

static inline vg_d2 vg_max2(vg_d2 a, vg_d2 b)
{
#if defined __x86_64__ && !defined VG_PORTABLE
  return _mm_max_pd(a, b);
#else
  return (vg_d2){ a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1] };
#endif
}

/* Bits 0 and 1: the lanes of a comparison result. */
static inline unsigned vg_lanes2(vg_l2 m)
{
#if defined __x86_64__ && !defined VG_PORTABLE
  return (unsigned)_mm_movemask_pd((__m128d)m);
#else
  return (unsigned)((m[0] & 1) | (m[1] & 2));
#endif
}

/* Per lane, the larger magnitude of a and b. */
static inline vg_d2 vg_abs_max2(vg_d2 a, vg_d2 b)
{
  const vg_l2 all = { INT64_MAX, INT64_MAX };

  return vg_max2((vg_d2)((vg_l2)a & all), (vg_d2)((vg_l2)b & all));
}

static inline vg_d2 vg_swap2(vg_d2 a)
{
  return (vg_d2){ a[1], a[0] };
}

/* (b, a) of (a, b), the first lane negated. */
static inline vg_d2 vg_turn2(vg_d2 a)
{
  return (vg_d2)((vg_l2)vg_swap2(a) ^ (vg_l2){ INT64_MIN, 0 });
}

/* The larger lane of a and the larger lane of b. */
static inline vg_d2 vg_across2(vg_d2 a, vg_d2 b)
{
  return vg_max2((vg_d2){ a[0], b[0] }, (vg_d2){ a[1], b[1] });
}

/** Signs of a point and the faces of cell v with corners in x. in, out: faces
 * of which the point is already known to be on the inner or the outer side. */
unsigned vg_cell_sides(const double (*x)[3], const uint32_t v[4],
                       const double at[3], unsigned in, unsigned out);

/* Exact fallback if rounding leaves the sphere test undecided. */
unsigned vg_cell_signs_exact(const double (*x)[3], const uint32_t v[4],
                             const double at[3], unsigned in, unsigned out);

/** Signs of a point and cell v with corners in x. e: the coordinates of the
 * point, each in both lanes. */
static inline unsigned vg_cell_signs(const double (*x)[3], const uint32_t v[4],
                                     const vg_d2 e[3])
{
  const double *a = x[v[0]], *b = x[v[1]], *c = x[v[2]], *d = x[v[3]];
  /* Vertices 0 and 2, and 1 and 3, relative to e. */
  vg_d2 px = (vg_d2){ a[0], c[0] } - e[0], qx = (vg_d2){ b[0], d[0] } - e[0];
  vg_d2 py = (vg_d2){ a[1], c[1] } - e[1], qy = (vg_d2){ b[1], d[1] } - e[1];
  vg_d2 pz = (vg_d2){ a[2], c[2] } - e[2], qz = (vg_d2){ b[2], d[2] } - e[2];
  vg_d2 pl = px * px + py * py + pz * pz, ql = qx * qx + qy * qy + qz * qz;
  /* Minors of x and y: of vertices 2 3 and 0 1, 1 2 and 3 0, 0 2 and 1 3. */
  vg_d2 near = vg_swap2(px * qy - qx * py);
  vg_d2 next = qx * vg_swap2(py) - vg_swap2(px) * qy;
  vg_d2 far = (vg_d2){ px[0], qx[0] } * (vg_d2){ py[1], qy[1] } -
              (vg_d2){ px[1], qx[1] } * (vg_d2){ py[0], qy[0] };
  vg_d2 even = qz * near + vg_turn2(pz) * far[1] + vg_swap2(qz) * next;
  vg_d2 odd = vg_turn2(qz) * far[0] -
              (vg_swap2(pz) * vg_swap2(next) + pz * near);
  vg_d2 sum = pl * even + ql * odd;
  vg_d2 xy = vg_across2(vg_abs_max2(px, qx), vg_abs_max2(py, qy));
  vg_d2 most = vg_across2(vg_abs_max2(pz, qz), vg_max2(pl, ql)) * xy;
  /* Errors as in core/geometry/predicates.h: 384 u = 4.263e-14 for the sphere;
   * for an orientation 8 u times at most 6 products, 48 u = 5.329e-15. */
  double det = sum[0] + sum[1], flat = 5.4e-15 * most[0] * xy[1];
  const double at[3] = { e[0][0], e[1][0], e[2][0] };
  int is_sure = fabs(det) > 4.27e-14 * most[0] * most[1];
  unsigned in, out;

  if (is_sure && !(det > 0)) return 0;
  in = vg_lane_faces(vg_lanes2(even > flat) | vg_lanes2(odd > flat) << 2);
  out = vg_lanes2(even < -flat) | vg_lanes2(odd < -flat) << 2;
  out = vg_lane_faces(out);
  if (!is_sure) return vg_cell_signs_exact(x, v, at, in, out);
  if ((in | out) != 0xf) return VG_IN_SPHERE | vg_cell_sides(x, v, at, in, out);
  return VG_IN_SPHERE | in * (VG_SIDE_IN | VG_SIDE_SEES);
}

#ifdef VG_WIDE
/* A point of three coordinates; the fourth lane is 0. */
static inline VG_WIDE vg_d4 vg_load3(const double x[3])
{
  return (vg_d4)_mm256_maskload_pd(x, (__m256i)(vg_l4){ -1, -1, -1, 0 });
}

/* Per lane, the magnitude of a. */
static inline VG_WIDE vg_d4 vg_abs4(vg_d4 a)
{
  return (vg_d4)((vg_l4)a &
                 (vg_l4){ INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX });
}

/** A cell seen from a point, with a vertex, or the face opposite it, in each of
 * four lanes. */
struct vg_cell_view {
  vg_d4 x, y, z;    /* the vertices relative to the point */
  vg_d4 o;          /* orientations of the faces and the point */
  vg_d4 most;       /* largest magnitudes of x, y, z in lanes 0 to 2 */
  double cube;      /* their product */
  unsigned in, out; /* bit i: the point is certainly on the inner or the outer
                       side of face i */
};

static inline VG_WIDE void vg_cell_view(const double (*x)[3],
                                        const uint32_t v[4], const double at[3],
                                        struct vg_cell_view *c)
{
  vg_d4 e = vg_load3(at);
  vg_d4 pa = vg_load3(x[v[0]]) - e, pb = vg_load3(x[v[1]]) - e;
  vg_d4 pc = vg_load3(x[v[2]]) - e, pd = vg_load3(x[v[3]]) - e;
  vg_d4 ab = VG_PICK4(pa, pb, 0, 4, 2, 6), cd = VG_PICK4(pc, pd, 0, 4, 2, 6);
  vg_d4 ab1 = VG_PICK4(pa, pb, 1, 5, 3, 7), cd1 = VG_PICK4(pc, pd, 1, 5, 3, 7);
  vg_d4 px = VG_PICK4(ab, cd, 0, 1, 4, 5), pz = VG_PICK4(ab, cd, 2, 3, 6, 7);
  vg_d4 py = VG_PICK4(ab1, cd1, 0, 1, 4, 5);
  /* Minors of x and y, of the vertex and the next one, and the one after it. */
  vg_d4 next = px * VG_TURN4(py, 1, 2, 3, 0) - VG_TURN4(px, 1, 2, 3, 0) * py;
  vg_d4 far = px * VG_TURN4(py, 2, 3, 0, 1) - VG_TURN4(px, 2, 3, 0, 1) * py;
  /* Orientations; those of faces 1 and 3 have the opposite sign. */
  vg_d4 o = VG_TURN4(pz, 3, 0, 1, 2) * VG_TURN4(next, 1, 2, 3, 0) -
            VG_TURN4(pz, 2, 3, 0, 1) * VG_TURN4(far, 1, 2, 3, 0) +
            VG_TURN4(pz, 1, 2, 3, 0) * VG_TURN4(next, 2, 3, 0, 1);
  double flat;

  c->x = px;
  c->y = py;
  c->z = pz;
  c->o = (vg_d4)((vg_l4)o ^ (vg_l4){ 0, INT64_MIN, 0, INT64_MIN });
  c->most = _mm256_max_pd(_mm256_max_pd(vg_abs4(pa), vg_abs4(pb)),
                          _mm256_max_pd(vg_abs4(pc), vg_abs4(pd)));
  c->cube = c->most[0] * c->most[1] * c->most[2];
  flat = 5.4e-15 * c->cube;
  c->in = (unsigned)_mm256_movemask_pd((__m256d)(c->o > flat));
  c->out = (unsigned)_mm256_movemask_pd((__m256d)(c->o < -flat));
}

/** As vg_cell_signs. at: the point. Rounding differs, but not the result, which
 * is exact. */
static inline VG_WIDE unsigned vg_cell_signs_wide(const double (*x)[3],
                                                  const uint32_t v[4],
                                                  const double at[3])
{
  struct vg_cell_view c;
  vg_d4 l, sum;
  double det;

  vg_cell_view(x, v, at, &c);
  l = c.x * c.x + c.y * c.y + c.z * c.z;
  sum = l * c.o;
  det = (sum[0] + sum[2]) + (sum[1] + sum[3]);
  l = _mm256_max_pd(l, VG_TURN4(l, 2, 3, 0, 1));
  if (!(fabs(det) > 4.27e-14 * c.cube * (l[0] > l[1] ? l[0] : l[1])))
    return vg_cell_signs_exact(x, v, at, c.in, c.out);
  if (!(det > 0)) return 0;
  if ((c.in | c.out) != 0xf)
    return VG_IN_SPHERE | vg_cell_sides(x, v, at, c.in, c.out);
  return VG_IN_SPHERE | c.in * (VG_SIDE_IN | VG_SIDE_SEES);
}
#endif

#endif
