/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/model/rates.h: how fast is this machine? The times of traced tasks
 * are fitted, by least squares, as a sum over their cells and the faces of
 * their fronts. Uses spans.h, forecast.h. */
#ifndef VG_PARTITION_MODEL_RATES_H
#define VG_PARTITION_MODEL_RATES_H

#include "base/library.h"
#include "partition/model/forecast.h"

/** Fit for one kind: seconds of one core = cell * cells + face * faces. */
struct vg_rate_fit {
  char kind;
  size_t n;          /* Number of tasks in the fit; 0: too few. */
  double cell, face; /* s per cell and per face, >= 0. */
  double error;      /* Root mean square of the relative errors. */
};

/** Fits the tasks of a kind. The relative errors are minimised, so that
 * large and small tasks have the same weight (LAPACK's dgels). A trace
 * without faces, or of equal tasks, gives the rate per cell only; fewer
 * than 4 tasks give nothing. VG_ERR_MEMORY; VG_ERR_UNSUPPORTED if LAPACK
 * cannot be loaded. */
vg_status vg_rates_fit(const struct vg_spans *s, char kind,
                       struct vg_rate_fit *out, struct vg_error *err);

/** Fits the kinds L, P and T. Errors as of vg_rates_fit. */
enum { VG_RATE_FITS = 3 };
vg_status vg_rates_of(const struct vg_spans *s,
                      struct vg_rate_fit fit[VG_RATE_FITS],
                      struct vg_error *err);

/** Replaces the seconds per cell and per face of leaves, pencils and tiles by
 * those of a fit that had enough tasks; joins and repairs are unchanged. */
void vg_rates_replace(struct vg_rates *r,
                      const struct vg_rate_fit fit[VG_RATE_FITS]);

/** The library is loaded for this. */
void vg_library_lapacke(struct vg_library *out);

#endif
