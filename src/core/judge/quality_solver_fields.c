/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Quality of each cell in the terms of solvers. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/judge/quality_solver.h"

#define DEGREE 57.295779513082320877

static double cosine_of(float square)
{
  double c = sqrt(fabs((double)square));

  return square < 0 ? -c : c;
}

/* angle: in: the smallest cosine of each cell. */
static void convert(size_t n, const float *quality, float *angle, float *out)
{
  for (size_t i = 0; i < n; i++) {
    angle[i] = (float)(acos((double)angle[i]) * DEGREE);
    out[i] = (float)cosine_of(quality[i]);
  }
}

vg_status vg_mesh_solver_fields(const struct vg_mesh *m,
                                float *non_orthogonality, float *skewness,
                                float *orthogonal_quality, struct vg_error *err)
{
  const uint64_t first[VG_CELL_KINDS] = { 0 };
  size_t n = vg_mesh_n_cell(m), n_component;
  struct vg_solver_sweep *s = vg_calloc(1, sizeof *s);
  struct vg_stats *f = vg_stats_new();
  float *volume = vg_alloc(n, sizeof *volume);
  vg_status st = VG_OK;

  assert(non_orthogonality && skewness && orthogonal_quality);
  if (!s || !f || !volume) st = vg_fail_memory(err, "the quality of the cells");
  if (st < 0) goto done;
  VG_TRY(vg_solver_begin(s, m, first, volume, f, err));
  s->oblique = non_orthogonality;
  s->skewed = skewness;
  for (size_t i = 0; i < n; i++) {
    s->oblique[i] = 1;
    s->skewed[i] = 0;
  }
  vg_judge_shape(m, 0, NULL, volume, f, s);
  VG_TRY(vg_judge_faces(m, volume, f, s, NULL, &n_component, err));
  vg_solver_empty_batch(s);
  convert(n, s->quality, non_orthogonality, orthogonal_quality);
done:
  if (s) vg_solver_release(s);
  free(s);
  free(f);
  free(volume);
  return st;
}
