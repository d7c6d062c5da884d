/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"
#include "fuzz_metrics.h"

#include "io/mesh/vtu_read.h"

/* Metrics with the cells in which they are interpolated. */
static void read_metrics(struct vg_input *in)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double *v = NULL;
  int n = 0;

  if (vg_vtu_values_parse(in, "metric", &m, &n, &v, &err) >= 0) {
    fuzz_expect(m.n_point > 0 && v && n >= 1 && n <= 9, "points and values");
    for (size_t i = 0; i < m.n_tet; i++)
      for (int k = 0; k < 4; k++)
        fuzz_expect(m.tet[i][k] < m.n_point, "nodes of tetrahedra exist");
    if (n == 6 || n == 9) fuzz_metrics(m.n_point, &m, n, v);
  } else {
    fuzz_expect(err.text[0] && !v && !m.point,
                "a failure has a message and no values");
  }
  free(v);
  vg_mesh_release(&m);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double(*x)[3] = NULL, *v = NULL;
  size_t n = 0;

  if (vg_input_memory("fuzz.vtu", data, size, &in, &err) < 0) return 0;
  if (vg_vtu_points_parse(&in, "size", &n, &x, &v, &err) >= 0) {
    fuzz_expect(n > 0 && x && v, "points and values");
    for (size_t i = 0; i < n; i++)
      fuzz_expect(isfinite(v[i]) && isfinite(x[i][0]) && isfinite(x[i][1]) &&
                    isfinite(x[i][2]),
                  "finite numbers");
  } else {
    fuzz_expect(err.text[0] && !x && !v,
                "a failure has a message and no values");
  }
  free(x);
  free(v);
  read_metrics(&in);
  vg_input_release(&in);
  return 0;
}
