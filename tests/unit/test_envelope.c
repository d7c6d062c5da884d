/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Body or flow domain: known shapes, the examples, and real geometry. */
#include "io_support.h"

#include <string.h>

#include "cli/examples/demo.h"
#include "core/surface/envelope.h"
#include "fill_shapes.h"
#include "io/mesh/format.h"

static struct vg_envelope measure(const struct vg_mesh *m)
{
  struct vg_envelope e;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_envelope_measure(m, NULL, &e, &err) < 0) fail_msg("%s", err.text);
  return e;
}

/* The same for either orientation of the shell. */
static struct vg_envelope measure_both(struct vg_mesh *m)
{
  struct vg_envelope a = measure(m), b;

  for (size_t i = 0; i < m->n_tri; i++) {
    uint32_t swap = m->tri[i][1];

    m->tri[i][1] = m->tri[i][2];
    m->tri[i][2] = swap;
  }
  b = measure(m);
  assert_int_equal(a.n_outer, b.n_outer);
  assert_int_equal(a.is_domain, b.is_domain);
  /* sums of the same terms with other signs */
  assert_true(fabs(a.covered - b.covered) < 1e-12);
  vg_mesh_release(m);
  return a;
}

static struct vg_envelope measure_block(int nx, int ny, int nz,
                                        int (*in)(const int at[3]))
{
  const int n[3] = { nx, ny, nz };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { nx, ny, nz };
  struct vg_mesh m = VG_MESH_INIT;

  shape_block(&m, n, lo, hi, in);
  return measure_both(&m);
}

static void convex_shapes_are_not_domains(void **state)
{
  const double centre[3] = { 0, 0, 0 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_envelope e = measure_block(4, 5, 6, shape_all);

  (void)state;
  assert_true(e.depth == 0 && !e.is_domain);
  /* every triangle, every view complete */
  assert_int_equal(e.n_outer, 2 * 2 * (20 + 24 + 30));
  assert_true(fabs(e.covered - 1) < 1e-12);
  shape_sphere(&m, 12, centre, 1, 1);
  e = measure_both(&m);
  assert_true(!e.is_domain && e.covered > 0.95);
}

static int room_with_a_block(const int at[3])
{
  return at[0] < 4 || at[0] >= 6 || at[1] < 4 || at[1] >= 6 || at[2] >= 3;
}

static void a_block_in_a_room(void **state)
{
  struct vg_envelope e = measure_block(10, 10, 8, room_with_a_block);

  (void)state;
  assert_true(e.is_domain);
  /* the floor lacks 4 of 100; the block has 4 + 4 * 6 over an opening of 4 */
  assert_true(fabs(e.covered - 0.96) < 1e-12);
  assert_true(fabs(e.depth - 7) < 1e-12);
  assert_int_equal(e.n_pocket_tri, 2 * (4 + 4 * 6));
}

static int with_a_groove(const int at[3])
{
  return at[0] != 4 || (at[1] > 0 && at[1] < 5 && at[2] > 0 && at[2] < 5);
}

static int plane_of_blocks(const int at[3])
{
  int fuselage = at[1] >= 9 && at[1] < 12, wing = at[0] >= 8 && at[0] < 12;

  return (fuselage || wing) && (fuselage || at[2] == 1);
}

static void bodies_with_cavities_are_not_domains(void **state)
{
  struct vg_envelope e = measure_block(9, 6, 6, with_a_groove);

  (void)state;
  /* the groove divides the outer surface: it is invisible from one end */
  assert_true(!e.is_domain && e.covered < 0.1);
  e = measure_block(20, 21, 3, plane_of_blocks);
  assert_true(!e.is_domain && e.covered < 0.5);
}

static void examples_are_domains(void **state)
{
  const char *name[] = { "wing-half", "wing-sharp-half" };

  (void)state;
  for (int i = 0; i < 2; i++) {
    struct vg_demo d = VG_DEMO_INIT;
    struct vg_error err = VG_ERROR_INIT;
    struct vg_envelope e;
    uint8_t *outer;

    if (vg_demo_make(name[i], 300000, &d, &err) < 0) fail_msg("%s", err.text);
    outer = calloc(d.surface.n_tri, 1);
    assert_int_equal(vg_envelope_measure(&d.surface, outer, &e, &err), VG_OK);
    assert_true(e.is_domain);
    assert_int_equal(e.n_pocket_tri, d.n_body_tri);
    assert_int_equal(e.n_outer, d.surface.n_tri - d.n_body_tri);
    for (size_t t = 0; t < d.surface.n_tri; t++)
      assert_int_equal(outer[t], t >= d.n_body_tri);
    free(outer);
    vg_demo_release(&d);
  }
}

static void real_geometry(void **state)
{
  static const struct {
    const char *name;
    int is_domain;
  } list[] = {
    { "transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz", 1 },
    { "transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz", 1 },
    { "highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz", 1 },
    { "simple/hemisphere_cylinder_farfield.lb8.ugrid.xz", 1 },
    { "bizjet/falcon_full_mirrored.lb8.ugrid.xz", 0 },
    { "bizjet/p180_avanti_full.lb8.ugrid.xz", 0 },
    { "supersonic/f16_full.lb8.ugrid.xz", 0 },
    { "supersonic/tmx1242_wing_body.lb8.ugrid.xz", 0 },
    { "supersonic/tnd6480_delta_wing_body.lb8.ugrid.xz", 0 },
    { "simple/cape_bullet.tri.xz", 0 },
    { "simple/cape_ellipsoid.lr4.tri", 0 },
  };

  (void)state;
  for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
    const char *path = io_real(list[i].name);
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;
    struct vg_envelope e;

    if (vg_format_read(path, &m, &err) < 0) fail_msg("%s", err.text);
    if (!strncmp(path, VG_TMP_DIR, strlen(VG_TMP_DIR))) remove(path);
    e = measure(&m);
    if (e.is_domain != list[i].is_domain)
      fail_msg("%s: covered %g, depth %g", list[i].name, e.covered, e.depth);
    /* no case is near the limit */
    assert_true(e.is_domain ? e.covered > 0.8 && e.depth > 1.5
                            : e.covered < 0.1 || e.depth < 1.1);
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(convex_shapes_are_not_domains),
    cmocka_unit_test(a_block_in_a_room),
    cmocka_unit_test(bodies_with_cavities_are_not_domains),
    cmocka_unit_test(examples_are_domains),
    cmocka_unit_test(real_geometry),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
