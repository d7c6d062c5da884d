/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"
#include "fuzz_metrics.h"

#include "io/mesh/vtu_read.h"

/* Values with the cells in which they are interpolated. */
static void read_values(struct vg_input *in, const char *section,
                        const char *name)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double *v = NULL;
  int n = 0;

  if (vg_vtu_values_parse(in, section, name, &m, &n, &v, &err) >= 0) {
    fuzz_expect(m.n_point > 0 && v && n >= 1 && n <= 9, "points and values");
    for (size_t i = 0; i < m.n_tet; i++)
      for (int k = 0; k < 4; k++)
        fuzz_expect(m.tet[i][k] < m.n_point, "nodes of tetrahedra exist");
    for (size_t i = 0; i < m.n_tri; i++)
      for (int k = 0; k < 3; k++)
        fuzz_expect(m.tri[i][k] < m.n_point, "nodes of triangles exist");
    if (*section == 'P' && (n == 6 || n == 9))
      fuzz_metrics(m.n_point, &m, n, v);
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

  if (vg_input_memory("fuzz.vtu", data, size, &in, &err) < 0) return 0;
  read_values(&in, "PointData", "size");
  read_values(&in, "PointData", "metric");
  read_values(&in, "CellData", "size");
  vg_input_release(&in);
  return 0;
}
