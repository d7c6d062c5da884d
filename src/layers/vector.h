/* layers/vector.h: three-vectors. Private to layers. */
#ifndef VG_LAYERS_VECTOR_H
#define VG_LAYERS_VECTOR_H

#include <math.h>

static inline double vg_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vg_norm(const double a[3])
{
  return sqrt(vg_dot(a, a));
}

static inline void vg_sub(const double a[3], const double b[3], double out[3])
{
  for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

static inline void vg_cross(const double a[3], const double b[3],
                            double out[3])
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/** Scale to length 1; the length it had (0: left as it is). */
static inline double vg_unit(double a[3])
{
  double l = vg_norm(a);

  if (l > 0) for (int k = 0; k < 3; k++) a[k] /= l;
  return l;
}

static inline double vg_distance(const double a[3], const double b[3])
{
  double d[3];

  vg_sub(a, b, d);
  return vg_norm(d);
}

/** Six times the volume of the tetrahedron o, a, b, c. */
static inline double vg_det(const double o[3], const double a[3],
                            const double b[3], const double c[3])
{
  double u[3], v[3], w[3], x[3];

  vg_sub(a, o, u);
  vg_sub(b, o, v);
  vg_sub(c, o, w);
  vg_cross(u, v, x);
  return vg_dot(x, w);
}

#endif
