/* layers/columns/growth_law.h: how thick each layer is. Uses base only.
 *
 * VGRID's law, delta_j = delta1 (1 + r1 (1 + r2)^(j-1))^(j-1) for the
 * thickness of layer j >= 1 (formats.md 1.8), contains the geometric one:
 * r1 = ratio - 1, r2 = 0. Two things are added to it: the first `n_constant`
 * layers have thickness delta1 (the law starts behind them), and no layer is
 * thicker than `cap` times the one below it. */
#ifndef VG_LAYERS_COLUMNS_GROWTH_LAW_H
#define VG_LAYERS_COLUMNS_GROWTH_LAW_H

#include <stddef.h>
#include <stdint.h>

#define VG_LEVELS_MAX 250 /* levels of a column */

struct vg_growth_law {
  double delta1;       /* first layer, length unit of the input, > 0 */
  double rate1, rate2; /* >= 0 */
  double cap;          /* largest ratio of neighbouring layers, >= 1;
                          INFINITY: none (VGRID) */
  int64_t n_constant;  /* first layers of equal thickness, >= 1 */
};
_Static_assert(sizeof(struct vg_growth_law) == 40,
               "laws have no padding: they are sent, and compared, as bytes");
#define VG_GROWTH_LAW_INIT                                                     \
  {                                                                            \
    0, 0.2, 0, 1.3, 1                                                          \
  }

/** Wall distances d[0] = 0 .. d[n] of the layer tops, with the cap lowered to
 * `cap` (a column that had to be compressed; INFINITY: the law's own). By
 * repeated multiplication: no libm, the same bits everywhere. O(n log n). */
void vg_growth_law_heights(const struct vg_growth_law *law, double cap, int n,
                           double *d);

/** Largest cap (to 1e-8) in [1, law's own] under which n layers are together no
 * higher than `height`; 0 when even layers of equal thickness are higher. */
double vg_growth_law_compress(const struct vg_growth_law *law, int n,
                              double height);

/** First height from y+: the flat-plate estimate with turbulent skin friction
 * c_f = 0.026 / Re^(1/7) (White, Viscous Fluid Flow), for which the first
 * point lies at y = y+ L / (Re sqrt(c_f / 2)). Re per reference length L. */
double vg_first_height(double y_plus, double reynolds, double length);

/** The inverse: y+ of a point at distance y. */
double vg_y_plus(double y, double reynolds, double length);

/** Rate (r1, with r2 = 0) for which n layers reach `total`; < 0 when n layers
 * of delta1 are higher already, INFINITY when none does (all n of constant
 * thickness, or a rate beyond 1e6). Within 1e-12 relative. */
double vg_growth_law_rate_for_total(double delta1, int n_constant, int n,
                                    double total);

/** Layers of a member of a grid family, in which sizes are `scale` times as
 * large as in the first one. */
enum vg_growth_law_rule {
  VG_GROWTH_LAW_KEPT, /* as they are */
  VG_GROWTH_LAW_EVEN, /* ratios to the power of scale: as many times more layers
                  as there are edges along the wall */
  VG_GROWTH_LAW_WORKSHOP /* ratios as the AIAA Drag Prediction Workshops give
                     them: of scales 1, 2/3, 1/2, 2/5, 1/3, 2/7 their logarithm
                     is 2/3 of the one before, 1.16, 1.104, 1.068, 1.045, 1.030,
                     1.020 */
};

/** To what power ratios go: > 0, 1 for VG_GROWTH_LAW_KEPT. scale > 0. Plain
 * arithmetic. */
double vg_growth_law_power(enum vg_growth_law_rule rule, double scale);

/** x^e, x > 0 and e finite, but for rounding; by plain arithmetic and sqrt. */
double vg_real_power(double x, double e);

/** The law of that member: first height times scale, constant layers and the
 * number n of layers (0: none given) over it, so that they reach as high;
 * ratios and cap to the power. */
void vg_growth_law_scale(struct vg_growth_law *law,
                         enum vg_growth_law_rule rule, double scale, int *n);

#endif
