/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/accuracy/schemes.h: discretisation schemes on control volumes. Private
 * to core/accuracy. */
#ifndef VG_CORE_ACCURACY_SCHEMES_H
#define VG_CORE_ACCURACY_SCHEMES_H

#include "core/accuracy/volumes.h"

/** Values of a function at the unknowns, and, if these are in the cells, at the
 * centres of the faces on the boundary. */
struct vg_values {
  const struct vg_volumes *v;
  double *at;     /* [n] */
  double *border; /* [n_border] */
};

/** Gradients at volume i by the schemes before VG_SCHEME_VISCOUS. Returns 1 if
 * a stencil of least squares does not determine all components, which are 0
 * then. Threads: safe, as the next function. */
int vg_scheme_gradients(const struct vg_values *f, size_t i,
                        double gradient[VG_SCHEME_VISCOUS][3]);

/** The Laplacian at volume i. gradient: [n] of all volumes. Returns 0 if the
 * volume has no equation: its unknown is on the boundary. */
int vg_scheme_laplacian(const struct vg_values *f, size_t i,
                        const double (*gradient)[3], double *out);

#endif
