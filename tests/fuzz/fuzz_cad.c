/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* CAD, read through the child process in which Open CASCADE runs. The result is
 * not checked, but there must be an answer, and a child for the next input. */
#include "fuzz.h"

#include "io/cad/cad.h"

static enum vg_cad_kind kind_of(const uint8_t *data, size_t size)
{
  if (size >= 4 && !memcmp(data, "ISO-", 4)) return VG_CAD_STEP;
  return size > 72 && data[72] == 'S' ? VG_CAD_IGES : VG_CAD_BREP;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static struct vg_cad *cad;
  struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT, empty = VG_CAD_SURFACE_INIT;
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  if (!vg_cad_is_built()) return 0;
  if (!cad)
    fuzz_expect(vg_cad_open(&cad, &err) == VG_OK, "a child process starts");
  o.seconds = 4;
  st = vg_input_memory("FUZZ", data, size, &in, &err);
  if (st == VG_OK)
    st = vg_cad_parse(cad, &in, kind_of(data, size), &o, &s, &err);
  fuzz_check_answer(st, &err);
  if (st == VG_OK) {
    fuzz_check_mesh(&s.mesh);
    fuzz_indices(s.segment ? s.segment[0] : NULL, 2 * s.n_segment,
                 s.mesh.n_point, "segments");
  } else {
    fuzz_expect(!memcmp(&s, &empty, sizeof s), "out is untouched");
  }
  vg_cad_surface_release(&s);
  vg_input_release(&in);
  return 0;
}
