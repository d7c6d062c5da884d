/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The surface check on real geometry, clean and dirty: the figures that come
 * with the data (open and non-manifold edges, intersecting pairs, shells),
 * which were found with other programs. */
#include "io_support.h"

#include "core/surface/surface_check.h"
#include "io/mesh/medit.h"
#include "io/mesh/obj.h"
#include "io/mesh/stl.h"
#include "io/mesh/tri.h"
#include "io/mesh/ugrid.h"

static vg_status read_any(const char *path, struct vg_mesh *m,
                          struct vg_error *err)
{
  if (strstr(path, ".ugrid")) return vg_ugrid_read(path, m, NULL, err);
  if (strstr(path, ".meshb")) return vg_medit_read(path, m, err);
  if (strstr(path, ".obj")) return vg_obj_read(path, m, err);
  if (strstr(path, ".stl")) return vg_stl_read(path, m, err);
  return vg_tri_read(path, m, err);
}

/* Read a file of the data folder; skips the test if it is missing. */
static void read_real(const char *name, struct vg_mesh *m)
{
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_real(name);
  vg_status st = read_any(path, m, &err);

  if (!strncmp(path, VG_TMP_DIR, strlen(VG_TMP_DIR))) remove(path);
  if (st < 0) fail_msg("%s: %s", name, err.text);
}

struct figures {
  const char *name; /* in VG_DATA_DIR */
  int is_domain;    /* complete boundary, else bodies */
  size_t n_piece, open, nonmanifold, orientation, meet, duplicate;
};

static const struct figures clean[] = {
  { "transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz", 1, 1, 0, 0, 0, 0, 0 },
  { "transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz", 1, 1, 0, 0, 0, 0, 0 },
  { "transport/onera_m6_om6ste01.meshb.xz", 1, 1, 0, 0, 0, 0, 0 },
  { "bizjet/falcon_full_mirrored.lb8.ugrid.xz", 0, 1, 0, 0, 0, 0, 0 },
  { "bizjet/p180_avanti_full.lb8.ugrid.xz", 0, 1, 0, 0, 0, 0, 0 },
  { "supersonic/low_boom_sst_full.lb8.ugrid.xz", 0, 2, 0, 0, 0, 0, 0 },
  { "supersonic/concorde_full.lb8.ugrid.xz", 0, 7, 0, 0, 0, 0, 0 },
  { "supersonic/f16_full.lb8.ugrid.xz", 0, 1, 0, 0, 0, 0, 0 },
  { "supersonic/tmx1242_wing_body.lb8.ugrid.xz", 0, 1, 0, 0, 0, 0, 0 },
  { "highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz", 1, 1, 0, 0, 0, 0,
    0 },
  { "simple/cube_sphere_coarse_volume.meshb.xz", 1, 1, 0, 0, 0, 0, 0 },
  { "simple/cape_bullet.tri.xz", 0, 1, 0, 0, 0, 0, 0 },
  { "simple/cape_cigar_viscous_volume.lb8.ugrid.xz", 1, 2, 0, 0, 0, 0, 0 },
  { "simple/cape_ellipsoid.lr4.tri", 0, 1, 0, 0, 0, 0, 0 },
  { "simple/hemisphere_cylinder_farfield.lb8.ugrid.xz", 1, 1, 0, 0, 0, 0, 0 },
  { "simple/cone_cone.lb8.ugrid.xz", 1, 1, 0, 0, 0, 0, 0 },
};

static const struct figures dirty[] = {
  { "dirty/motorbike.obj.gz", 0, 4, 49, 100089, 0, 0, 67326 },
  { "dirty/drivaer_fastback_body.obj.gz", 0, 1, 0, 33, 0, 0, 0 },
  { "dirty/toy_airplane_with_holes.obj.xz", 0, 1, 341, 0, 0, 0, 0 },
  { "dirty/three_plugs.bin.tri.xz", 0, 3, 0, 0, 0, 704, 0 },
  { "dirty/f16_components_overlapping.stl.xz", 0, 11, 110, 0, 0, 2122, 0 },
  { "dirty/openvsp_cfdmesh_lowboom.tri.xz", 0, 2, 3, 0, 0, 0, 0 },
  { "dirty/openvsp_cfdmesh_concorde.tri.xz", 0, 13, 113, 0, 550, 35, 0 },
};

/* Without the repair: the figures are those of the welded input surface. */
static void check_figures(const struct figures *x)
{
  struct vg_surface_check_options o = { .external = !x->is_domain,
                                        .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  read_real(x->name, &m);
  if (vg_surface_check(&m, &o, &r, &err) < 0)
    fail_msg("%s: %s", x->name, err.text);
  assert_int_equal(r.count[VG_DEFECT_OPEN_EDGE], x->open);
  assert_int_equal(r.count[VG_DEFECT_NONMANIFOLD_EDGE], x->nonmanifold);
  assert_int_equal(r.count[VG_DEFECT_ORIENTATION], x->orientation);
  assert_int_equal(r.count[VG_DEFECT_INTERSECTION], x->meet);
  assert_int_equal(r.count[VG_DEFECT_DUPLICATE_TRIANGLE], x->duplicate);
  assert_int_equal(r.count[VG_DEFECT_DEGENERATE_TRIANGLE], 0);
  assert_int_equal(r.n_piece, x->n_piece);
  assert_int_equal(r.is_closed, !x->open && !x->nonmanifold);
  vg_surface_report_release(&r);
  vg_mesh_release(&m);
}

/* After the repair there are no findings. The boundary of a domain points into
 * the fluid and bodies point out of the solid, whatever the file had. */
static void check_repair(const struct figures *x)
{
  struct vg_surface_check_options o = { .repair = 1,
                                        .external = !x->is_domain,
                                        .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  read_real(x->name, &m);
  if (vg_surface_check(&m, &o, &r, &err) < 0)
    fail_msg("%s: %s", x->name, err.text);
  assert_int_equal(r.n_defect, 0);
  assert_true(r.is_closed);
  assert_int_equal(r.n_shell, x->n_piece);
  for (size_t i = 0; i < r.n_shell; i++) {
    const struct vg_shell *s = &r.shell[i];

    assert_true((s->volume > 0) == ((s->depth & 1) == x->is_domain));
  }
  vg_surface_report_release(&r);
  vg_mesh_release(&m);
}

static void gives_the_figures_of_clean_data(void **unused)
{
  (void)unused;
  for (size_t i = 0; i < sizeof clean / sizeof *clean; i++) {
    check_figures(&clean[i]);
    check_repair(&clean[i]);
  }
}

static void gives_the_figures_of_dirty_data(void **unused)
{
  (void)unused;
  for (size_t i = 0; i < sizeof dirty / sizeof *dirty; i++)
    check_figures(&dirty[i]);
}

/* The seams of the F-16's parts close within 1e-6, as its notes say. */
static void closes_seams_within_a_tolerance(void **unused)
{
  struct vg_surface_check_options o = { .repair = 1,
                                        .external = 1,
                                        .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t n_merged, n_dropped;

  (void)unused;
  read_real("dirty/f16_components_overlapping.stl.xz", &m);
  assert_int_equal(vg_surface_weld(&m, 1e-6, &n_merged, &n_dropped, &err),
                   VG_OK);
  assert_true(n_merged > 0);
  assert_int_equal(vg_surface_check(&m, &o, &r, &err), VG_OK);
  assert_true(r.is_closed);
  assert_int_equal(r.n_shell, 11);
  assert_true(r.count[VG_DEFECT_INTERSECTION] > 2000);
  vg_surface_report_release(&r);
  vg_mesh_release(&m);
}

/* The same surface gives the same report, byte for byte. */
static void repeats_itself(void **unused)
{
  struct vg_surface_check_options o = { .repair = 1,
                                        .external = 1,
                                        .threads = 1 };
  struct vg_surface_report r[2];
  struct vg_mesh m[2];
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  memset(r, 0, sizeof r);
  memset(m, 0, sizeof m);
  for (int i = 0; i < 2; i++) {
    read_real("dirty/openvsp_cfdmesh_concorde.tri.xz", &m[i]);
    assert_int_equal(vg_surface_check(&m[i], &o, &r[i], &err), VG_OK);
  }
  assert_true(r[0].n_flipped > 0 && r[0].n_defect > 0);
  assert_int_equal(r[0].n_defect, r[1].n_defect);
  assert_memory_equal(r[0].defect, r[1].defect,
                      r[0].n_defect * sizeof *r[0].defect);
  assert_memory_equal(m[0].tri, m[1].tri, m[0].n_tri * sizeof *m[0].tri);
  for (int i = 0; i < 2; i++) {
    vg_surface_report_release(&r[i]);
    vg_mesh_release(&m[i]);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(gives_the_figures_of_clean_data),
    cmocka_unit_test(gives_the_figures_of_dirty_data),
    cmocka_unit_test(closes_seams_within_a_tolerance),
    cmocka_unit_test(repeats_itself),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
