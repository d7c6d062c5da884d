/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/vgrid/vgrid.h"

static void check(const struct vg_project *p)
{
  for (size_t i = 0; i < p->n_curve; i++)
    fuzz_indices(p->curve[i].point, p->curve[i].n, p->n_point,
                 "points of curves");
  for (size_t i = 0; i < p->n_shape; i++)
    for (size_t k = 0; k < p->shape[i].n; k++) {
      int32_t c = p->shape[i].curve[k];

      fuzz_expect(c && c > -INT32_MAX && (size_t)abs(c) <= p->n_curve,
                  "patches refer to existing curves");
    }
  for (size_t i = 0; i < p->n_point; i++)
    for (int k = 0; k < 3; k++)
      fuzz_expect(isfinite(p->point[i][k]), "finite coordinates");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_project p = VG_PROJECT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_input_memory("FUZZ", data, size, &in, &err);

  if (st == VG_OK) st = vg_d3m_parse(&in, &p, &err);
  fuzz_check_answer(st, &err);
  if (st == VG_OK) check(&p);
  vg_project_release(&p);
  vg_input_release(&in);
  return 0;
}
