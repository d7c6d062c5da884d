/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_tensor.h: size tensors H = M^(-1/2) (core/geometry/
 * tensor.h): their growth, order and intersection. Internal to core/sizing. */
#ifndef VG_CORE_SIZING_SIZING_TENSOR_H
#define VG_CORE_SIZING_SIZING_TENSOR_H

/* H12: share of the growth that is measured in the metric; the other part is
 * measured in physical space. */
#define VG_GROWTH_IN_METRIC 0.875

/** A size tensor of the field. */
struct vg_size {
  float h[6];
  float least, most; /* bounds on its eigenvalues */
};

/** Smaller and larger of two numbers that are not NaN. Compilers call libm for
 * fmin and fmax. */
static inline double vg_lesser(double a, double b)
{
  return a < b ? a : b;
}

static inline double vg_greater(double a, double b)
{
  return a > b ? a : b;
}

/** A size tensor by its eigenvalues and orthonormal eigenvectors. If the sizes
 * are equal, the vectors have no meaning. */
struct vg_size_axes {
  double size[3], axis[3][3];
};

/** Eigenvalues and eigenvectors of a size tensor, or of a metric M, whose
 * eigenvalues may be 0: the sizes are INFINITY then. */
void vg_size_axes_of(const double h[6], struct vg_size_axes *a);
void vg_size_axes_of_metric(const double m[6], struct vg_size_axes *a);

/** The size tensor, or its metric. */
void vg_size_axes_tensor(const struct vg_size_axes *a, double h[6]);
void vg_size_axes_metric(const struct vg_size_axes *a, double m[6]);

static inline int vg_size_axes_are_equal(const struct vg_size_axes *a)
{
  return a->size[0] == a->size[1] && a->size[0] == a->size[2];
}

static inline double vg_size_axes_least(const struct vg_size_axes *a)
{
  return vg_lesser(vg_lesser(a->size[0], a->size[1]), a->size[2]);
}

static inline double vg_size_axes_most(const struct vg_size_axes *a)
{
  return vg_greater(vg_greater(a->size[0], a->size[1]), a->size[2]);
}

/** out = the size tensor h, grown over the vector `way` at a rate of 1 + slope.
 * Over the distance d, which is l edges of h,
 *   out = h (1 + q slope l) + (1 - q) slope d I,  q = VG_GROWTH_IN_METRIC.
 * This is h + slope d if h is isotropic. For small d, it is the law of Alauzet
 * (Finite Elem. Anal. Des. 46, 2010) in mixed space, which multiplies the two
 * terms; their sum needs no eigenvalues. out may be h. */
void vg_size_grow(const double h[6], const double way[3], double slope,
                  double out[6]);

/** Do all edges that have length 1 in h have a length of at most 1 + within in
 * the size tensor `most`? */
int vg_size_is_within(const double h[6], const double most[6], double within);

/** out = the size tensor of the intersection of the metrics of a and b. out may
 * be a or b. */
void vg_size_intersect(const double a[6], const double b[6], double out[6]);

/** Metric of a size tensor. out may be h. */
void vg_size_metric(const double h[6], double m[6]);

/** Limits of the eigenvalues of a size tensor. */
struct vg_size_limits {
  double least, most; /* > 0 and finite */
  double aspect;      /* largest ratio of two eigenvalues, >= 1: large ones are
                         reduced */
};

/** Limit the sizes. range out: the smallest and the largest one. Returns
 * whether one changed. */
int vg_size_axes_limit(struct vg_size_axes *a, const struct vg_size_limits *l,
                       double range[2]);

/** Size tensor of a metric, with limited eigenvalues. m may have eigenvalues of
 * 0. out may be m. range as above. */
void vg_size_from_metric(const double m[6], const struct vg_size_limits *l,
                         double out[6], double range[2]);

/** Limit the eigenvalues of a size tensor. range as above. */
void vg_size_limit(double h[6], const struct vg_size_limits *l,
                   double range[2]);

/** Largest component of H_exact^(-1) H - I: the relative error of edge lengths
 * in h. */
double vg_size_error(const double h[6], const double exact[6]);

/** Geometric mean of the eigenvalues. */
double vg_size_mean(const double h[6]);

/** Is the tensor a multiple of I, exactly? */
int vg_size_is_uniform(const float h[6]);

#endif
