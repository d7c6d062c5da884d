/* partition/model/rates.h: how fast is this machine? The seconds of recorded
 * tasks, as a sum over their cells and the faces of their fronts, by least
 * squares. Uses spans.h, forecast.h. */
#ifndef VG_PARTITION_MODEL_RATES_H
#define VG_PARTITION_MODEL_RATES_H

#include "partition/model/forecast.h"

/** Tasks of one kind: seconds of one core = cell * cells + face * faces. */
struct vg_rate_fit {
  char kind;
  size_t n;          /* tasks that it was found from; 0: too few */
  double cell, face; /* s, >= 0 */
  double error;      /* root mean square of the relative errors */
};

/** Fit the tasks of a kind. Each counts by its relative error, so that large
 * and small ones weigh the same (LAPACK's dgels). A record without faces, or
 * of tasks all alike, gives cells alone; one of fewer than 4 tasks nothing.
 * VG_ERR_MEMORY; VG_ERR_UNSUPPORTED where LAPACK cannot be loaded. */
vg_status vg_rates_fit(const struct vg_spans *s, char kind,
                       struct vg_rate_fit *out, struct vg_error *err);

/** The measured rates (forecast.h), with the seconds per cell and per face of
 * leaves, pencils and tiles that a record shows where it has enough of them;
 * joins and repairs stay. fit out: what was found for kinds L, P, T.
 * Errors as there. */
enum { VG_RATE_FITS = 3 };
vg_status vg_rates_of(const struct vg_spans *s,
                      struct vg_rate_fit fit[VG_RATE_FITS],
                      struct vg_rates *out, struct vg_error *err);

#endif
