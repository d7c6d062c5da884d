/* A mesh that was read goes to OpenFOAM's face table: any cells at all, which
 * must end in a table that is complete or in words. */
#include "fuzz.h"

#include "io/mesh/foam_parts.h"
#include "io/mesh/medit.h"

static void check_table(const struct vg_foam_faces *f)
{
  uint32_t code[6], neighbour[6], node[4];
  uint64_t n = 0, corner = 0;

  for (uint32_t cell = 0; cell < f->n_cell; cell++) {
    int k = vg_foam_upper(f, cell, code, neighbour);

    fuzz_expect(k >= 0 && k <= 6, "faces of a cell");
    for (int i = 0; i < k; i++) {
      fuzz_expect(code[i] >> 3 == cell, "a face of this cell");
      fuzz_expect(neighbour[i] > cell && neighbour[i] < f->n_cell,
                  "a higher neighbour");
      fuzz_expect(!i || neighbour[i - 1] <= neighbour[i], "rising");
      corner += (uint64_t)vg_foam_face_nodes(f, code[i], node);
    }
    n += (uint64_t)k;
  }
  for (size_t i = 0; i < f->m->n_tri + f->m->n_quad; i++)
    corner += (uint64_t)vg_foam_face_nodes(f, f->boundary[i], node);
  fuzz_expect(n == f->n_internal, "every inner face once");
  fuzz_expect(corner == f->n_corner, "all corners counted");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_foam_faces f = VG_FOAM_FACES_INIT;

  if (vg_input_memory("FUZZ", data, size, &in, &err) == VG_OK &&
      vg_medit_parse(&in, &m, &err) == VG_OK) {
    vg_status st = vg_foam_faces_build(&f, &m, "FUZZ", &err);

    fuzz_check_answer(st, &err);
    if (st == VG_OK) check_table(&f);
  }
  vg_foam_faces_release(&f);
  vg_mesh_release(&m);
  vg_input_release(&in);
  return 0;
}
