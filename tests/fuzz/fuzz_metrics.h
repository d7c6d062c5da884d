/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks of metrics that a reader accepted, for fuzzers. */
#ifndef VG_TESTS_FUZZ_METRICS_H
#define VG_TESTS_FUZZ_METRICS_H

#include "core/geometry/tensor.h"
#include "core/sizing/sizing_mesh.h"
#include "fuzz.h"

/* Metrics that pass the check are positive, and those of a mesh give a positive
 * metric at any of its points. m: NULL, or with the cells. */
static void fuzz_metrics(size_t n, struct vg_mesh *m, int components,
                         const double *value)
{
  double(*x)[3] = m ? m->point : calloc(n, sizeof *x);
  double(*metric)[6] = calloc(n, sizeof *metric), got[6];
  struct vg_size_mesh *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  if (x && metric &&
      vg_size_metrics_read("fuzz", n, (const double(*)[3])x, components,
                           VG_TENSOR_MEDIT, value, metric, &err) >= 0) {
    for (size_t i = 0; i < n; i++)
      fuzz_expect(metric[i][0] > 0 && metric[i][3] > 0 && metric[i][5] > 0,
                  "accepted metrics are positive");
    if (m &&
        vg_size_mesh_new(m, (const double(*)[6])metric, 1.2, &s, &err) >= 0)
      vg_size_mesh_map(s)->metric(vg_size_mesh_map(s)->user, x[0], got);
    vg_size_mesh_free(s);
  } else {
    fuzz_expect(err.text[0] || !x || !metric, "a failure has a message");
  }
  if (!m) free(x);
  free(metric);
}

#endif
