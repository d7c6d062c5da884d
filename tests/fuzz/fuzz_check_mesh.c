/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "core/judge/quality.h"
#include "io/mesh/medit.h"

/* The step after reading a volume mesh: the check of validity and quality. */
static vg_status parse(struct vg_input *in, struct vg_mesh *m,
                       struct vg_error *err)
{
  struct vg_mesh_report r;
  vg_status st = vg_medit_parse(in, m, err);

  if (st < 0 || !(m->n_tet + m->n_pyr + m->n_pri + m->n_hex)) return st;
  memset(&r, 0, sizeof r);
  st = vg_mesh_judge(m, NULL, &r, err);
  fuzz_expect(st == VG_OK, "a mesh can be checked");
  return st;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(parse, data, size);
  return 0;
}
