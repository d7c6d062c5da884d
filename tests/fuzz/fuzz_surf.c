/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/mesh/aflr.h"

static struct vg_aflr settings;

static vg_status parse(struct vg_input *in, struct vg_mesh *m,
                       struct vg_error *err)
{
  vg_status st = vg_aflr_surf_parse(in, m, &settings, err);

  if (st < 0) {
    fuzz_expect(!settings.n && !settings.patch, "settings are untouched");
    return st;
  }
  fuzz_expect(settings.n == m->n_patch, "settings of every patch");
  fuzz_expect(!settings.spacing || settings.n_point == m->n_point,
              "a spacing at every point");
  for (size_t i = 0; i < settings.n; i++) {
    const struct vg_aflr_patch *p = settings.patch + i;

    fuzz_expect(p->id == m->patch[i].id, "settings in the order of patches");
    fuzz_expect(p->spacing >= 0 && p->thickness >= 0, "lengths");
    fuzz_expect(p->is_viscous == (p->flag < 0 && p->flag != VG_AFLR_NONE),
                "layers by the flag");
  }
  return st;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(parse, data, size);
  vg_aflr_release(&settings);
  return 0;
}
