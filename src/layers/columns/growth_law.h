/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/columns/growth_law.h: growth law, the thickness of each layer. Uses
 * base only.
 *
 * VGRID's law gives the thickness of layer j >= 1 (formats.md 1.8) as delta_j =
 * delta1 (1 + r1 (1 + r2)^(j-1))^(j-1). Geometric growth is the special case r1
 * = ratio - 1, r2 = 0. There are two extensions: the first `n_constant` layers
 * have the thickness delta1 (the law starts above them), and no layer is
 * thicker than `cap` times the layer below it. */
#ifndef VG_LAYERS_COLUMNS_GROWTH_LAW_H
#define VG_LAYERS_COLUMNS_GROWTH_LAW_H

#include <stddef.h>
#include <stdint.h>

#define VG_LEVELS_MAX 250 /* Most levels of a column. */

struct vg_growth_law {
  double delta1;       /* Thickness of the first layer, length unit of the
                          input, > 0. */
  double rate1, rate2; /* Growth rates r1 and r2, >= 0. */
  double cap;          /* Largest ratio of neighbouring layers, >= 1; INFINITY:
                          no limit (VGRID). */
  int64_t n_constant;  /* Number of first layers of equal thickness, >= 1. */
};
_Static_assert(sizeof(struct vg_growth_law) == 40,
               "laws have no padding: they are sent, and compared, as bytes");
#define VG_GROWTH_LAW_INIT                                                     \
  {                                                                            \
    0, 0.2, 0, 1.3, 1                                                          \
  }

/** Wall distances d[0] = 0 .. d[n] of the tops of the layers. `cap` replaces
 * that of the law if it is lower, in a column that is compressed (INFINITY:
 * use that of the law). Computed by repeated multiplication without libm, so
 * the result is bitwise the same on all machines. O(n log n). */
void vg_growth_law_heights(const struct vg_growth_law *law, double cap, int n,
                           double *d);

/** Largest cap in [1, that of the law], to 1e-8, for which n layers are not
 * higher than `height`; 0 if even layers of equal thickness are higher. */
double vg_growth_law_compress(const struct vg_growth_law *law, int n,
                              double height);

/** First height for a given y+, by the flat-plate estimate with turbulent skin
 * friction c_f = 0.026 / Re^(1/7) (White, Viscous Fluid Flow): y = y+ L / (Re
 * sqrt(c_f / 2)). Re is based on the reference length L. */
double vg_first_height(double y_plus, double reynolds, double length);

/** The inverse: y+ of a point at wall distance y. */
double vg_y_plus(double y, double reynolds, double length);

/** The same where the skin friction coefficient c_f = tau_w / (rho U^2 / 2) is
 * known: y Re sqrt(c_f / 2) / L. */
double vg_y_plus_at(double y, double reynolds, double length, double c_f);

/** Growth rate (r1, with r2 = 0) for which n layers have the height `total`,
 * with a relative error below 1e-12. Returns a negative value if n layers of
 * thickness delta1 are already higher, and INFINITY if no rate suffices (all n
 * layers have constant thickness, or the rate would exceed 1e6). */
double vg_growth_law_rate_for_total(double delta1, int n_constant, int n,
                                    double total);

/** How the layers change with the member of a grid family, whose sizes are
 * `scale` times those of the first member. */
enum vg_growth_law_rule {
  VG_GROWTH_LAW_KEPT, /* The layers are not changed. */
  VG_GROWTH_LAW_EVEN, /* Ratios are raised to the power `scale`: the number of
                  layers increases by the same factor as the number of edges
                  along the wall. */
  VG_GROWTH_LAW_WORKSHOP /* Ratios as in the AIAA Drag Prediction
                     Workshops: 1.16, 1.104, 1.068, 1.045, 1.030, 1.020 for the
                     scales 1, 2/3, 1/2, 2/5, 1/3, 2/7. The logarithm of each
                     ratio is 2/3 of the previous one. */
};

/** Exponent applied to the ratios: > 0, and 1 for VG_GROWTH_LAW_KEPT. scale >
 * 0. Uses basic arithmetic only. */
double vg_growth_law_power(enum vg_growth_law_rule rule, double scale);

/** x^e for x > 0 and finite e, up to rounding, by basic arithmetic and sqrt. */
double vg_real_power(double x, double e);

/** Scales a law for a member of a family: multiplies the first height by
 * `scale`, divides the number of constant layers by it, and raises ratios and
 * cap to the exponent of the rule. The number n of layers (0: not given) is
 * divided by that exponent, so that the layers keep their height. */
void vg_growth_law_scale(struct vg_growth_law *law,
                         enum vg_growth_law_rule rule, double scale, int *n);

#endif
