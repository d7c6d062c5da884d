/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Load estimates that take long: meshes of a million cells, real surfaces. */
#include "load_support.h"

#include "io/mesh/ugrid.h"

/* Where the sizing field grows faster than cells can, the number of cells
 * follows from the edges of the front, not from the size in a large octant next
 * to it. */
static void steep_fields_do_not_outrun_the_front(void **state)
{
  (void)state;
  compare_with_mesh("sphere", 200000, 2, 1.15);
  compare_with_mesh("sphere", 1000000, 2.5, 1.2);
  compare_with_mesh("sphere", 500000, 4, 1.2);
  compare_with_mesh("sphere", 1000000, 4, 1.2);
}

/* As a domain or, if there are only walls, the interior of the walls. */
static void check_real(const char *name)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  const char *path = io_real(name);
  vg_status st = vg_ugrid_read(path, &m, NULL, &err);
  struct vg_front front;
  int is_inside_out;
  struct vg_load l;
  struct scene s;

  if (!strncmp(path, VG_TMP_DIR, strlen(VG_TMP_DIR))) remove(path);
  if (st < 0) fail_msg("%s: %s", name, err.text);
  front = vg_front_of(&m);
  is_inside_out = vg_front_volume(&front) < 0;
  for (size_t i = 0; is_inside_out && i < m.n_tri; i++) {
    const uint32_t a = m.tri[i][0];

    m.tri[i][0] = m.tri[i][1];
    m.tri[i][1] = a;
  }
  make_scene(&s, &m, 0);
  estimate(&s, 2, &l);
  print_message("%s: %zu triangles, %zu octants, %.0f cells, volume %.4f\n",
                name, s.front.n_face, l.n, l.cells, sampled(&l) / s.volume);
  check_volume(&s, &l);
  vg_load_release(&l);
  release_scene(&s);
}

static void real_surfaces_keep_their_volume(void **state)
{
  (void)state;
  check_real("transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz");
  check_real("transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz");
  check_real("bizjet/falcon_full_mirrored.lb8.ugrid.xz");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(steep_fields_do_not_outrun_the_front),
    cmocka_unit_test(real_surfaces_keep_their_volume),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
