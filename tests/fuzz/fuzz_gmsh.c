/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include <stdlib.h>

#include "io/cad/cad.h"
#include "io/mesh/gmsh.h"

static vg_status parse(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err)
{
  struct vg_cad_zones zones = { 0, NULL };
  vg_status st = vg_gmsh_parse_volumes(in, out, &zones, err);

  free(zones.of);
  return st;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(parse, data, size);
  return 0;
}
