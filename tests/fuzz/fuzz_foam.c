/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The mesh that was read is converted to the table of faces from which OpenFOAM
 * files and solver partitions are made. Any cells must give a complete table or
 * an error message. */
#include "fuzz.h"

#include "core/mesh/cell_links.h"
#include "io/mesh/medit.h"

static void check_table(const struct vg_cell_links *f, int is_open)
{
  uint32_t node[4];
  uint64_t n = 0, corner = 0;

  for (uint32_t cell = 0; cell < f->n_cell; cell++)
    for (int i = 0; i < vg_half_faces(f, cell); i++) {
      uint32_t code = cell << 3 | (uint32_t)i, mate = vg_mate(f, code);

      if (mate == VG_NO_CELL) continue;
      fuzz_expect(mate >> 3 < f->n_cell && mate >> 3 != cell, "a neighbour");
      fuzz_expect(vg_mate(f, mate) == code, "the mate of the mate");
      if (mate < code) continue;
      corner += (uint64_t)vg_half_face_nodes(f, code, node);
      n++;
    }
  for (size_t i = 0; !is_open && i < f->m->n_tri + f->m->n_quad; i++)
    corner += (uint64_t)vg_half_face_nodes(f, f->boundary[i], node);
  fuzz_expect(n == f->n_internal, "every internal face is listed once");
  fuzz_expect(corner == f->n_corner, "all corners are counted");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_cell_links f = VG_CELL_LINKS_INIT;

  if (vg_input_memory("FUZZ", data, size, &in, &err) == VG_OK &&
      vg_medit_parse(&in, &m, &err) == VG_OK)
    for (int is_open = 0; is_open < 2; is_open++) {
      vg_status st = vg_cell_links_build(&f, &m, is_open, "FUZZ", &err);

      fuzz_check_answer(st, &err);
      if (st == VG_OK) check_table(&f, is_open);
      vg_cell_links_release(&f);
    }
  vg_mesh_release(&m);
  vg_input_release(&in);
  return 0;
}
