/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "core/mesh/zones.h"
#include "io/stream/sheet_file.h"

/* The sheets of a mesh of four points and one cell. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_input_memory("FUZZ", data, size, &in, &err);

  m.n_point = 4;
  m.n_tet = 1;
  if (st == VG_OK) st = vg_sheet_file_parse(&in, &m, &err);
  fuzz_check_answer(st, &err);
  for (size_t t = 0; t < m.n_tri; t++) {
    fuzz_expect(m.tri_patch[t] < m.n_patch, "triangles have a sheet");
    for (int k = 0; k < 3; k++)
      fuzz_expect(m.tri[t][k] < 4, "points are in range");
  }
  for (size_t i = 0; i < m.n_patch; i++)
    fuzz_expect(memchr(m.patch[i].name, 0, VG_NAME_MAX) != NULL,
                "names are terminated");
  for (int k = 0; k < VG_ZONE_KINDS && m.n_zone; k++)
    fuzz_expect(vg_mesh_zone_start(&m, m.n_zone, k) == (k == 0),
                "every cell is in a zone");
  for (size_t z = 0; z < m.n_zone; z++)
    fuzz_expect(m.zone[z].id > 0 && m.zone[z].kind >= 0 &&
                  m.zone[z].kind < VG_ZONE_KINDS &&
                  memchr(m.zone[z].name, 0, VG_NAME_MAX),
                "zones have numbers, kinds and names");
  vg_mesh_release(&m);
  vg_input_release(&in);
  return 0;
}
