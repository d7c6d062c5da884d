/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* CAD, read through the child process in which Open CASCADE runs; files:
 * ../cad. */
#include "io_support.h"

#include <math.h>

#include "base/child.h"
#include "core/geometry/volume.h"
#include "core/surface/surface_check.h"
#include "io/cad/cad.h"
#include "io/mesh/format.h"

#define FILE_OF(name) VG_CAD_FILES "/" name

struct notes {
  char text[8192];
};

static void take_note(void *user, const char *text)
{
  struct notes *n = user;
  size_t at = strlen(n->text);

  snprintf(n->text + at, sizeof n->text - at, "%s\n", text);
}

static int needs_cad(void **state)
{
  (void)state;
  if (vg_cad_is_built()) return 0;
  print_message("built without Open CASCADE: skipped\n");
  exit(77);
}

static struct vg_cad_options options(struct notes *n)
{
  struct vg_cad_options o = VG_CAD_OPTIONS_INIT;

  n->text[0] = 0;
  o.note = take_note;
  o.user = n;
  return o;
}

/* Through the table of formats, with notes. */
static void read_file(const char *path, const struct vg_cad_options *o,
                      struct vg_mesh *m)
{
  struct vg_read_info info = { .cad = o };
  struct vg_error err = VG_ERROR_INIT;

  if (vg_surface_read(path, m, &info, &err)) fail_msg("%s", err.text);
}

static void says(const struct notes *n, const char *text)
{
  if (!strstr(n->text, text)) fail_msg("'%s' lacks '%s'", n->text, text);
}

/* Closed, without defects, with this number of shells. */
static void is_sound(struct vg_mesh *m, size_t shells)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t n_point = m->n_point;

  o.external = 1;
  if (vg_surface_check(m, &o, &r, &err)) fail_msg("%s", err.text);
  assert_int_equal(r.n_defect, 0);
  assert_int_equal(r.n_shell, shells);
  assert_int_equal(r.n_flipped, 0); /* outward normals from the solid at once */
  assert_int_equal(m->n_point, n_point); /* shared by topology already */
  vg_surface_report_release(&r);
}

static void near(double a, double b, double tolerance)
{
  if (!(fabs(a - b) <= tolerance)) fail_msg("%.17g is not %.17g", a, b);
}

static void bounds_are(const struct vg_mesh *m, double x, double y, double z)
{
  double lo[3], hi[3];

  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++) near(lo[k], 0, 1e-9 * x);
  near(hi[0], x, 1e-9 * x);
  near(hi[1], y, 1e-9 * y);
  near(hi[2], z, 1e-9 * z);
}

static void step_has_names_and_units(void **state)
{
  static const char *const name[] = { "sides",          "sides",
                                      "front and back", "front and back",
                                      "ends",           "ends" };
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);
  double lo[3], hi[3];

  (void)state;
  read_file(FILE_OF("box.step"), &o, &m);
  assert_int_equal(m.n_point, 8);
  assert_int_equal(m.n_tri, 12);
  assert_int_equal(m.n_patch, 6);
  for (size_t i = 0; i < 6; i++) {
    assert_int_equal(m.patch[i].id, i + 1);
    assert_int_equal(m.patch[i].bc, VG_BC_NONE);
    assert_string_equal(m.patch[i].name, name[i]);
  }
  bounds_are(&m, 1, 2, 3);
  is_sound(&m, 1);
  says(&n, "lengths are in m, the file's unit");
  vg_mesh_release(&m);
  o = options(&n);
  o.unit = VG_CAD_UNIT_MM;
  read_file(FILE_OF("box.step"), &o, &m);
  bounds_are(&m, 1000, 2000, 3000);
  says(&n, "were converted to mm");
  vg_mesh_release(&m);
  o = options(&n);
  o.unit = VG_CAD_UNIT_INCH;
  read_file(FILE_OF("loose.igs"), &o, &m);
  says(&n, "were converted to inch");
  vg_mesh_bounds(&m, lo, hi);
  near(hi[2], 3 / 25.4, 1e-6); /* of 3 mm, with gaps */
  vg_mesh_release(&m);
}

static void patches_follow_the_chosen_attribute(void **state)
{
  static const struct {
    enum vg_cad_patches by;
    size_t n;
    const char *first;
  } cases[] = { { VG_CAD_BY_FACE, 5, "upper" },
                { VG_CAD_BY_NAME, 5, "upper" },
                { VG_CAD_BY_LAYER, 2, "SKIN" },
                { VG_CAD_BY_COLOUR, 2, "#" },
                { VG_CAD_BY_PART, 1, "half wing" } };
  struct notes n;

  (void)state;
  for (size_t i = 0; i < 5; i++) {
    struct vg_cad_options o = options(&n);
    struct vg_mesh m = VG_MESH_INIT;

    o.patches = (int32_t)cases[i].by;
    read_file(FILE_OF("wing.step"), &o, &m);
    assert_int_equal(m.n_patch, cases[i].n);
    assert_memory_equal(m.patch[0].name, cases[i].first,
                        strlen(cases[i].first));
    is_sound(&m, 1);
    vg_mesh_release(&m);
  }
}

static void parts_stand_where_the_assembly_puts_them(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);

  (void)state;
  o.patches = VG_CAD_BY_PART;
  read_file(FILE_OF("assembly.step"), &o, &m);
  bounds_are(&m, 6, 2, 3);
  is_sound(&m, 2);
  assert_string_equal(m.patch[0].name, "brick");
  vg_mesh_release(&m);
}

static void finer_is_nearer(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  size_t before = 0;

  (void)state;
  for (double angle = 40; angle > 9; angle /= 2) {
    struct vg_cad_options o = options(&n);

    o.angle = angle;
    read_file(FILE_OF("wing.step"), &o, &m);
    assert_true(m.n_tri > before);
    before = m.n_tri;
    is_sound(&m, 1);
    vg_mesh_release(&m);
  }
}

/* --- faults -------------------------------------------------------------- */

static void loose_faces_are_sewn(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);
  double lo[3], hi[3];

  (void)state;
  read_file(FILE_OF("loose.igs"), &o, &m);
  assert_int_equal(m.n_patch, 6);
  says(&n, "lengths are in m, the file's unit");
  vg_mesh_bounds(&m, lo, hi);
  near(hi[2], 0.003, 1e-9);
  says(&n, "24 edges belonged to one face only");
  says(&n, "joined 24 of them");
  assert_int_equal(m.n_point, 8);
  vg_mesh_release(&m);
}

/* A cylinder whose face is bounded by curves in space only. */
static void missing_curves_of_parameters_are_made(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);
  double lo[3], hi[3];

  (void)state;
  read_file(FILE_OF("bare.brep"), &o, &m);
  assert_int_equal(m.n_patch, 3);
  says(&n, "face 1 has no parameter-space curves along its boundary");
  is_sound(&m, 1);
  vg_mesh_bounds(&m, lo, hi);
  near(hi[0], 1, 1e-12);
  near(hi[2], 2, 1e-12);
  vg_mesh_release(&m);
}

static void a_duplicate_face_is_removed(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);

  (void)state;
  read_file(FILE_OF("doubled.brep"), &o, &m);
  assert_int_equal(m.n_patch, 6);
  says(&n, "face 7 at (0.5, 0, 1.5) duplicates face 3 and was dropped");
  says(&n, "no unit of length");
  is_sound(&m, 1);
  vg_mesh_release(&m);
}

/* --- solids that touch --------------------------------------------------- */

static struct vg_cad *parse_file(const char *path, enum vg_cad_kind kind,
                                 const struct vg_cad_options *o,
                                 struct vg_cad_surface *s);

/* One closed shell with the volume of the union. */
static void solids_that_touch_are_united(void **state)
{
  static const struct {
    const char *path;
    size_t patches;
    double volume;
    const char *note;
  } cases[] = {
    { FILE_OF("stacked.brep"), 10, 8, "2 solids touch or overlap" },
    { FILE_OF("glued.brep"), 10, 8, "2 solids touch or overlap" },
    /* a peg whose end is a wall as a whole, and its side in part; its end is a
     * face of each solid, or the same face of both */
    { FILE_OF("peg.brep"), 8, 8 + M_PI / 4, "2 solids touch or overlap" },
    { FILE_OF("peg_glued.brep"), 8, 8 + M_PI / 4, "2 solids touch or overlap" },
    { FILE_OF("leaning.brep"), 11, 8, "2 solids touch or overlap" },
    { FILE_OF("crossing.brep"), 12, 10.125, "2 solids touch or overlap" },
    /* cylinders with radii of 1 and 0.997 */
    { FILE_OF("stages.brep"), 5, M_PI * (1 + 0.997 * 0.997),
      "2 solids touch or overlap" }
  };

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
    struct notes n;
    struct vg_cad_options o = options(&n);
    struct vg_cad *c = parse_file(cases[i].path, VG_CAD_BREP, &o, &s);

    says(&n, cases[i].note);
    assert_int_equal(s.mesh.n_patch, cases[i].patches);
    assert_int_equal(s.is_solid, 1);
    near(s.volume, cases[i].volume, 1e-9);
    is_sound(&s.mesh, 1);
    vg_cad_surface_release(&s);
    vg_cad_close(c);
  }
}

/* Volume inside the triangles of the patches that are not interfaces. */
static double outer_volume(const struct vg_mesh *m)
{
  double sum = 0;

  for (size_t t = 0; t < m->n_tri; t++)
    if (!m->patch[m->tri_patch[t]].is_interface)
      sum += vg_enclosed6(1, (const uint32_t(*)[3])m->tri + t,
                          (const double(*)[3])m->point, m->point[0]) /
             6;
  return sum;
}

/* Solids as zones: the faces between two of them are one patch. */
static void solids_are_zones(void **state)
{
  static const struct {
    const char *path;
    double volume;
    const char *note;
  } cases[] = {
    { FILE_OF("stacked.brep"), 8, "faces between two of them: 1" },
    { FILE_OF("glued.brep"), 8, "faces between two of them: 1" },
    { FILE_OF("leaning.brep"), 8, "faces between two of them: 1" },
    { FILE_OF("peg_glued.brep"), 8 + M_PI / 4, "faces between two of them: 2" },
    { FILE_OF("peg.brep"), 8 + M_PI / 4, "faces between two of them: 2" },
    { FILE_OF("filled.brep"), 64, "faces between two of them: 6" },
  };

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
    struct notes n;
    struct vg_cad_options o = options(&n);
    struct vg_cad *c;
    size_t n_interface = 0;

    o.solids = VG_CAD_SOLIDS_ZONES;
    c = parse_file(cases[i].path, VG_CAD_BREP, &o, &s);
    says(&n, cases[i].note);
    for (size_t p = 0; p < s.mesh.n_patch; p++)
      if (s.mesh.patch[p].is_interface) {
        n_interface++;
        assert_string_equal(s.mesh.patch[p].name, "solid_1_to_solid_2");
      }
    assert_int_equal(n_interface, 1);
    assert_int_equal(s.zones.n, 2);
    assert_string_equal(s.zones.of[0].name, "solid_1");
    assert_string_equal(s.zones.of[1].name, "solid_2");
    near(fabs(outer_volume(&s.mesh)), cases[i].volume, 0.02);
    vg_cad_surface_release(&s);
    vg_cad_close(c);
  }
}

static void some_solids_are_no_zones(void **state)
{
  static const struct {
    const char *path, *text;
  } cases[] = { { FILE_OF("inside.brep"), "overlap" },
                { FILE_OF("crossing.brep"), "overlap" },
                { FILE_OF("box.brep"), "solids in it: 1;" },
                { FILE_OF("ring.brep"), "solids in it: 0;" } };

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;
    struct notes n;
    struct vg_cad_options o = options(&n);
    int unit;

    o.solids = VG_CAD_SOLIDS_ZONES;
    assert_int_equal(vg_cad_read(cases[i].path, VG_CAD_BREP, &o, NULL, &m,
                                 &unit, NULL, &err),
                     VG_ERR_INPUT);
    assert_non_null(strstr(err.text, cases[i].text));
    assert_int_equal(m.n_tri, 0);
  }
}

/* Points are projected to all pieces of a face that the union divided. */
static void pieces_of_a_face_have_its_number(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);
  struct vg_cad *c = parse_file(FILE_OF("crossing.brep"), VG_CAD_BREP, &o, &s);
  struct vg_error err = VG_ERROR_INIT;
  uint32_t *tri = calloc(s.mesh.n_tri, sizeof *tri);
  double(*x)[3] = calloc(s.mesh.n_tri, sizeof *x);
  double *d = calloc(s.mesh.n_tri, sizeof *d);

  (void)state;
  for (size_t t = 0; t < s.mesh.n_tri; t++) {
    tri[t] = (uint32_t)t;
    assert_true(s.tri_face[t] >= 1 && s.tri_face[t] <= 12);
    assert_int_equal(s.mesh.patch[s.mesh.tri_patch[t]].id, s.tri_face[t]);
    for (int k = 0; k < 3; k++)
      for (int j = 0; j < 3; j++)
        x[t][k] += s.mesh.point[s.mesh.tri[t][j]][k] / 3;
  }
  for (int by_face = 0; by_face < 2; by_face++) {
    if (vg_cad_project(c, by_face ? VG_CAD_ON_FACES : VG_CAD_ON_TRIANGLES,
                       s.mesh.n_tri, by_face ? s.tri_face : tri, x, d, &err))
      fail_msg("%s", err.text);
    for (size_t t = 0; t < s.mesh.n_tri; t++) near(d[t], 0, 1e-12);
  }
  free(tri);
  free(x);
  free(d);
  vg_cad_surface_release(&s);
  vg_cad_close(c);
}

/* The larger solid may be the fluid: the inner one must not disappear. */
static void a_solid_that_contains_another_stays(void **state)
{
  static const struct {
    const char *path;
    size_t patches;
  } cases[] = { { FILE_OF("inside.brep"), 12 },
                { FILE_OF("filled.brep"), 12 } };

  (void)state;
  for (size_t i = 0; i < 2; i++) {
    struct notes n;
    struct vg_cad_options o = options(&n);
    struct vg_mesh m = VG_MESH_INIT;

    read_file(cases[i].path, &o, &m);
    says(&n, "contains another one and was not united");
    assert_int_equal(m.n_patch, cases[i].patches);
    vg_mesh_release(&m);
  }
}

/* The curve of the apex of this cone in the parameter plane is 25.4 times as
 * far away. */
static void wrong_curves_of_a_cone_are_computed(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);
  struct vg_cad *c = parse_file(FILE_OF("cone.brep"), VG_CAD_BREP, &o, &s);
  struct vg_surface_check_options check = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  says(&n, "face 1 has wrong parameter-space curves along its boundary, at "
           "(-0.5, ");
  assert_int_equal(s.is_solid, 1);
  near(s.volume, M_PI, 1e-6);
  near(s.area[0], M_PI * sqrt(10), 1e-3);
  is_sound(&s.mesh, 1);
  assert_int_equal(vg_surface_check(&s.mesh, &check, &r, &err), VG_OK);
  assert_int_equal(r.n_defect, 0);
  near(fabs(r.shell[0].volume), M_PI, 0.02);
  vg_surface_report_release(&r);
  vg_cad_surface_release(&s);
  vg_cad_close(c);
}

/* The inner rim of this plane face turns the wrong way. */
static void a_face_covered_in_part_is_an_error(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_input in = VG_INPUT_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);
  struct vg_error err = VG_ERROR_INIT;
  struct vg_cad *c;

  (void)state;
  assert_int_equal(vg_input_open(FILE_OF("ring.brep"), &in, &err), VG_OK);
  assert_int_equal(vg_cad_open(&c, &err), VG_OK);
  assert_int_equal(vg_cad_parse(c, &in, VG_CAD_BREP, &o, &s, &err),
                   VG_ERR_GEOMETRY);
  assert_non_null(strstr(err.text, "the triangles of face 1 at (0, 0, 0) have "
                                   "an area of 9, but the face itself 25"));
  vg_cad_close(c);
  vg_input_release(&in);
}

static void a_rocket_of_ten_solids_is_one_shell(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);

  (void)state;
  read_file(io_real("field/rocket_touching_solids.step.gz"), &o, &m);
  says(&n, "7 solids touch or overlap and were united");
  is_sound(&m, 1);
  vg_mesh_release(&m);
}

/* --- faces without a solid ----------------------------------------------- */

/* Six faces of a box with gaps of 2e-5, three of them reversed. */
static void wide_gaps_are_sewn_and_faces_turned(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);
  struct vg_cad *c = parse_file(FILE_OF("gaps.brep"), VG_CAD_BREP, &o, &s);
  struct vg_surface_check_options check = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  says(&n, "sewing with a tolerance of 3.74e-05 joined 24 of them, for "
           "example at (");
  says(&n, "3 faces that do not belong to a solid were reversed");
  assert_int_equal(s.is_solid, 0);
  near(s.volume, 6, 1e-4);
  assert_int_equal(vg_surface_check(&s.mesh, &check, &r, &err), VG_OK);
  assert_int_equal(r.n_defect, 0);
  assert_true(r.n_flipped == 0 || r.n_flipped == s.mesh.n_tri);
  vg_surface_report_release(&r);
  vg_cad_surface_release(&s);
  o = options(&n);
  o.tolerance = 1e-7; /* used as given */
  vg_cad_close(c);
  c = parse_file(FILE_OF("gaps.brep"), VG_CAD_BREP, &o, &s);
  says(&n, "the gap is wider than 1e-07");
  assert_true(isnan(s.volume));
  vg_cad_surface_release(&s);
  vg_cad_close(c);
}

static void a_missing_face_is_named(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);

  (void)state;
  read_file(FILE_OF("missing.brep"), &o, &m);
  says(&n, "4 edges belong to one face only, the first to face 1");
  assert_int_equal(m.n_patch, 5);
  vg_mesh_release(&m);
}

static void intersecting_bodies_are_reported_by_the_check(void **state)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options cad = options(&n);
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  read_file(FILE_OF("crossing_faces.brep"), &cad, &m);
  assert_int_equal(vg_surface_check(&m, &o, &r, &err), VG_OK);
  assert_true(r.count[VG_DEFECT_INTERSECTION] > 0);
  vg_surface_report_release(&r);
  vg_mesh_release(&m);
}

/* A failure with this code, whose message has this phrase and the file's
 * name. */
static void refuses(struct vg_cad *c, const void *data, size_t size,
                    enum vg_cad_kind kind, vg_status code, const char *phrase)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  const struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  assert_int_equal(vg_input_memory("case", data, size, &in, &err), VG_OK);
  st = vg_cad_parse(c, &in, kind, &o, &s, &err);
  if (st != code || !strstr(err.text, phrase) || !strstr(err.text, "case"))
    fail_msg("status %d instead of %d, '%s' has no '%s'", st, code, err.text,
             phrase);
  assert_null(s.mesh.point);
  vg_input_release(&in);
}

static void load(const char *path, struct vg_input *in)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_input_open(path, in, &err)) fail_msg("%s", err.text);
}

static void files_that_are_not_cad_are_refused(void **state)
{
  int unit;
  struct vg_input in = VG_INPUT_INIT;
  struct vg_cad *c = NULL;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  assert_int_equal(vg_cad_open(&c, &err), VG_OK);
  refuses(c, "solid x", 7, VG_CAD_STEP, VG_ERR_FORMAT, "not a STEP file");
  refuses(c, "solid x", 7, VG_CAD_IGES, VG_ERR_FORMAT, "not an IGES file");
  refuses(c, "solid x", 7, VG_CAD_BREP, VG_ERR_FORMAT, "not a BREP file");
  refuses(c, "ISO-10303-21;\nEND-ISO-10303-21;\n", 32, VG_CAD_STEP,
          VG_ERR_FORMAT, "STEP");
  load(FILE_OF("edges.brep"), &in);
  refuses(c, in.data, in.size, VG_CAD_BREP, VG_ERR_INPUT, "no faces");
  vg_input_release(&in);
  vg_cad_close(c);
  assert_int_equal(vg_cad_read("absent.step", VG_CAD_STEP, NULL, NULL, &m,
                               &unit, NULL, &err),
                   VG_ERR_IO);
}

/* Text of other programs after the BREP, as Engineering Sketch Pad writes
 * it. */
static void text_after_a_brep_is_accepted(void **state)
{
  static const char tail[] = "\n##EGADS HEADER FILE-REV 1 ##\n1 1 8 12 6 1\n"
                             "#FACE 0.0 attribute *\n";
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  const struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  struct vg_input in = VG_INPUT_INIT, all = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_cad *c = NULL;
  char *text;

  (void)state;
  load(FILE_OF("box.brep"), &in);
  text = malloc(in.size + sizeof tail);
  memcpy(text, in.data, in.size);
  memcpy(text + in.size, tail, sizeof tail);
  assert_int_equal(vg_cad_open(&c, &err), VG_OK);
  assert_int_equal(vg_input_memory("case", text, in.size + sizeof tail - 1,
                                   &all, &err),
                   VG_OK);
  if (vg_cad_parse(c, &all, VG_CAD_BREP, &o, &s, &err))
    fail_msg("%s", err.text);
  assert_int_equal(s.mesh.n_tri, 12);
  vg_cad_surface_release(&s);
  vg_input_release(&all);
  /* Truncated within the BREP, with the text after it. */
  memcpy(text + in.size - 300, tail, sizeof tail);
  refuses(c, text, in.size - 300 + sizeof tail - 1, VG_CAD_BREP, VG_ERR_FORMAT,
          "truncated");
  free(text);
  vg_input_release(&in);
  vg_cad_close(c);
}

static void egads_is_a_suffix(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  read_file(FILE_OF("box.egads"), NULL, &m);
  assert_int_equal(m.n_tri, 12);
  is_sound(&m, 1);
  vg_mesh_release(&m);
}

static void truncated_input_is_refused(void **state)
{
  static const struct {
    const char *path;
    enum vg_cad_kind kind;
    const char *phrase;
  } cases[] = { { FILE_OF("box.step"), VG_CAD_STEP, "truncated" },
                { FILE_OF("loose.igs"), VG_CAD_IGES, "truncated" },
                { FILE_OF("box.brep"), VG_CAD_BREP, "truncated" } };
  struct vg_error err = VG_ERROR_INIT;
  struct vg_cad *c = NULL;

  (void)state;
  assert_int_equal(vg_cad_open(&c, &err), VG_OK);
  for (size_t i = 0; i < 3; i++) {
    struct vg_input in = VG_INPUT_INIT;

    load(cases[i].path, &in);
    for (size_t k = 1; k < 8; k++)
      refuses(c, in.data, in.size * k / 8, cases[i].kind, VG_ERR_FORMAT,
              cases[i].phrase);
    vg_input_release(&in);
  }
  vg_cad_close(c);
}

/* Whatever Open CASCADE makes of damaged files, there is an answer, and an
 * answer to the next file. */
static void damaged_files_get_an_answer(void **state)
{
  static const char *const path[] = { FILE_OF("box.step"), FILE_OF("loose.igs"),
                                      FILE_OF("box.brep") };
  static const enum vg_cad_kind kind[] = { VG_CAD_STEP, VG_CAD_IGES,
                                           VG_CAD_BREP };
  struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_cad *c = NULL;

  (void)state;
  o.seconds = 20;
  assert_int_equal(vg_cad_open(&c, &err), VG_OK);
  for (size_t i = 0; i < 3; i++) {
    struct vg_input in = VG_INPUT_INIT;

    load(path[i], &in);
    for (size_t at = 100; at + 100 < in.size; at += in.size / 40) {
      struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
      unsigned char was = in.data[at];
      vg_status st;

      in.data[at] = was == '1' ? '7' : '1';
      err = (struct vg_error)VG_ERROR_INIT;
      st = vg_cad_parse(c, &in, kind[i], &o, &s, &err);
      if (st != VG_OK && !strstr(err.text, path[i]))
        fail_msg("status %d: '%s'", st, err.text);
      assert_true(st == VG_OK || !s.mesh.point);
      vg_cad_surface_release(&s);
      in.data[at] = was;
    }
    vg_input_release(&in);
  }
  vg_cad_close(c);
}

static int at_once(void *user)
{
  (void)user;
  return 1;
}

static void stops_on_request_and_at_the_time_limit(void **state)
{
  int unit;
  struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  o.stop.ask = at_once;
  assert_int_equal(vg_cad_read(FILE_OF("wing.step"), VG_CAD_STEP, &o, NULL, &m,
                               &unit, NULL, &err),
                   VG_ERR_STOPPED);
  assert_non_null(strstr(err.text, "stopped"));
  o.stop.ask = NULL;
  o.seconds = 0.2; /* of about a minute's work */
  o.angle = 1;
  o.chord = 1e-7;
  assert_int_equal(vg_cad_read(FILE_OF("wing.step"), VG_CAD_STEP, &o, NULL, &m,
                               &unit, NULL, &err),
                   VG_ERR_IO);
  assert_non_null(strstr(err.text, "time limit of 0.2 s"));
  assert_null(m.point);
}

/* --- reproducibility ----------------------------------------------------- */

static void bytes_are_the_same(void **state)
{
  struct vg_mesh a = VG_MESH_INIT, b = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  read_file(FILE_OF("wing.step"), NULL, &a);
  if (vg_child_server_start(&err)) fail_msg("%s", err.text);
  read_file(FILE_OF("wing.step"), NULL, &b);
  vg_child_server_stop();
  assert_int_equal(a.n_point, b.n_point);
  assert_int_equal(a.n_tri, b.n_tri);
  assert_memory_equal(a.point, b.point, a.n_point * sizeof *a.point);
  assert_memory_equal(a.tri, b.tri, a.n_tri * sizeof *a.tri);
  assert_memory_equal(a.tri_patch, b.tri_patch, a.n_tri * sizeof *a.tri_patch);
  vg_mesh_release(&a);
  vg_mesh_release(&b);
}

/* --- back to faces and curves -------------------------------------------- */

static struct vg_cad *parse_file(const char *path, enum vg_cad_kind kind,
                                 const struct vg_cad_options *o,
                                 struct vg_cad_surface *s)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_cad *c = NULL;

  load(path, &in);
  if (vg_cad_open(&c, &err) || vg_cad_parse(c, &in, kind, o, s, &err))
    fail_msg("%s", err.text);
  vg_input_release(&in);
  return c;
}

static struct vg_cad *open_file(const char *path, enum vg_cad_kind kind,
                                struct vg_cad_surface *s)
{
  const struct vg_cad_options o = VG_CAD_OPTIONS_INIT;

  return parse_file(path, kind, &o, s);
}

static void same_surface(const struct vg_cad_surface *a,
                         const struct vg_cad_surface *b)
{
  assert_int_equal(a->mesh.n_point, b->mesh.n_point);
  assert_int_equal(a->mesh.n_tri, b->mesh.n_tri);
  assert_int_equal(a->n_segment, b->n_segment);
  assert_memory_equal(a->mesh.point, b->mesh.point,
                      a->mesh.n_point * sizeof *a->mesh.point);
  assert_memory_equal(a->mesh.tri, b->mesh.tri,
                      a->mesh.n_tri * sizeof *a->mesh.tri);
  assert_memory_equal(a->segment, b->segment,
                      a->n_segment * sizeof *a->segment);
  near(a->volume, b->volume, 0);
  assert_int_equal(a->is_solid, b->is_solid);
}

/* Coarse, fine and coarse again: the result equals that of a fresh child with
 * these options. */
static void retessellation_equals_a_fresh_read(void **state)
{
  const double angle[] = { 30, 8, 30 };
  struct vg_cad_surface first = VG_CAD_SURFACE_INIT;
  struct vg_cad *c = open_file(FILE_OF("wing.step"), VG_CAD_STEP, &first);
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int i = 0; i < 3; i++) {
    struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
    struct vg_cad_surface s = VG_CAD_SURFACE_INIT, fresh = VG_CAD_SURFACE_INIT;
    uint32_t last;
    double x[3], d;

    o.angle = angle[i];
    if (vg_cad_again(c, &o, &s, &err)) fail_msg("%s", err.text);
    vg_cad_close(parse_file(FILE_OF("wing.step"), VG_CAD_STEP, &o, &fresh));
    same_surface(&s, &fresh);
    last = (uint32_t)s.mesh.n_tri - 1; /* triangles are the new ones */
    memcpy(x, s.mesh.point[s.mesh.tri[last][0]], sizeof x);
    if (vg_cad_project(c, VG_CAD_ON_TRIANGLES, 1, &last, &x, &d, &err))
      fail_msg("%s", err.text);
    near(d, 0, 1e-4);
    last++;
    assert_int_equal(vg_cad_project(c, VG_CAD_ON_TRIANGLES, 1, &last, &x, &d,
                                    &err),
                     VG_ERR_INPUT);
    vg_cad_surface_release(&s);
    vg_cad_surface_release(&fresh);
  }
  vg_cad_surface_release(&first);
  vg_cad_close(c);
  assert_int_equal(vg_cad_open(&c, &err), VG_OK);
  assert_int_equal(vg_cad_again(c, &(struct vg_cad_options)VG_CAD_OPTIONS_INIT,
                                &first, &err),
                   VG_ERR_INPUT);
  vg_cad_close(c);
}

static size_t count_short(const struct vg_mesh *m, double least)
{
  size_t n = 0;

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      const double *a = m->point[m->tri[t][k]];
      const double *b = m->point[m->tri[t][(k + 1) % 3]];
      double d2 = 0;

      for (int j = 0; j < 3; j++) d2 += (a[j] - b[j]) * (a[j] - b[j]);
      n += d2 < least * least;
    }
  return n;
}

/* The wing is 2.5 m long; its faces have corners that are 10 mm apart. */
static void short_edges_collapse(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  size_t without, with;

  (void)state;
  o.angle = 3;
  vg_cad_close(parse_file(FILE_OF("wing.step"), VG_CAD_STEP, &o, &s));
  without = count_short(&s.mesh, 2);
  vg_cad_surface_release(&s);
  o.least = 2;
  vg_cad_close(parse_file(FILE_OF("wing.step"), VG_CAD_STEP, &o, &s));
  with = count_short(&s.mesh, 2);
  is_sound(&s.mesh, 1);
  if (!(without > 100 && with * 10 < without))
    fail_msg("%zu edges shorter than 2 mm, %zu with a least edge length",
             without, with);
  vg_cad_surface_release(&s);
}

/* No triangle of the wing is in the cap at its root, face 4. */
static void wing_triangles_stay_out_of_the_root_cap(void **state)
{
  struct vg_surface_check_options check = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  o.chord = 3e-4;
  o.angle = 8;
  vg_cad_close(
    parse_file(io_real("field/onera_m6_root_cap.igs.gz"), VG_CAD_IGES, &o, &s));
  assert_int_equal(vg_surface_check(&s.mesh, &check, &r, &err), VG_OK);
  for (size_t i = 0; i < r.n_defect; i++)
    for (int k = 0; k < 2; k++)
      if (r.defect[i].face[k] < s.mesh.n_tri)
        assert_int_not_equal(s.tri_face[r.defect[i].face[k]], 4);
  assert_int_equal(r.count[VG_DEFECT_OPEN_EDGE], 0);
  assert_int_equal(r.count[VG_DEFECT_NONMANIFOLD_EDGE], 0);
  vg_surface_report_release(&r);
  vg_cad_surface_release(&s);
}

/* Exact volume of a wing with splines; that of its triangles is close. */
static void volume_is_exact(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_surface_check_options check = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  o.chord = 1e-4;
  o.angle = 4;
  vg_cad_close(parse_file(io_real("field/vtol_wing_thin_te.step.gz"),
                          VG_CAD_STEP, &o, &s));
  assert_int_equal(vg_surface_check(&s.mesh, &check, &r, &err), VG_OK);
  assert_int_equal(s.is_solid, 1);
  near(fabs(r.shell[0].volume), s.volume, 1e-3 * s.volume);
  vg_surface_report_release(&r);
  vg_cad_surface_release(&s);
}

static void points_go_to_the_faces_of_a_box(void **state)
{
  /* face 3 is y = 0 of the box 1 x 2 x 3 */
  const uint32_t face[3] = { 3, 3, 3 };
  double p[3][3] = { { 0.5, -1, 1 }, { 2, -1, 1 }, { 0.25, 0, 2.5 } };
  const double to[3][3] = { { 0.5, 0, 1 }, { 1, 0, 1 }, { 0.25, 0, 2.5 } };
  double d[3];
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_cad *c = open_file(FILE_OF("box.brep"), VG_CAD_BREP, &s);
  struct vg_error err = VG_ERROR_INIT;
  const uint32_t absent = 7;

  (void)state;
  if (vg_cad_project(c, VG_CAD_ON_FACES, 3, face, p, d, &err))
    fail_msg("%s", err.text);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) near(p[i][k], to[i][k], 1e-12);
  near(d[0], 1, 1e-12);
  near(d[1], sqrt(2), 1e-12);
  near(d[2], 0, 1e-12);
  assert_int_equal(vg_cad_project(c, VG_CAD_ON_FACES, 1, &absent, p, d, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "no face 7"));
  assert_int_equal(s.n_segment, 12);
  vg_cad_surface_release(&s);
  vg_cad_close(c);
}

/* The middle of a triangle's edge is within chord and angle of the face; a
 * point on the face does not move. */
static void points_go_to_the_faces_of_a_wing(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_cad *c = open_file(FILE_OF("wing.step"), VG_CAD_STEP, &s);
  const struct vg_mesh *m = &s.mesh;
  double(*p)[3] = calloc(m->n_tri, sizeof *p), *d = calloc(m->n_tri, 8);
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      p[i][k] = (m->point[m->tri[i][0]][k] + m->point[m->tri[i][1]][k]) / 2;
  if (vg_cad_project(c, VG_CAD_ON_FACES, m->n_tri, s.tri_face, p, d, &err))
    fail_msg("%s", err.text);
  for (size_t i = 0; i < m->n_tri; i++) assert_true(d[i] < 5); /* 0.5 % */
  if (vg_cad_project(c, VG_CAD_ON_FACES, m->n_tri, s.tri_face, p, d, &err))
    fail_msg("%s", err.text);
  for (size_t i = 0; i < m->n_tri; i++) assert_true(d[i] < 1e-5);
  free(p);
  free(d);
  vg_cad_surface_release(&s);
  vg_cad_close(c);
}

/* With a starting triangle: the same points. */
static void points_go_to_faces_by_triangles(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_cad *c = open_file(FILE_OF("wing.step"), VG_CAD_STEP, &s);
  const struct vg_mesh *m = &s.mesh;
  double(*p[2])[3], *d[2];
  uint32_t *tri = calloc(m->n_tri, sizeof *tri);
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int j = 0; j < 2; j++) {
    p[j] = calloc(m->n_tri, sizeof *p[j]);
    d[j] = calloc(m->n_tri, sizeof *d[j]);
    for (size_t i = 0; i < m->n_tri; i++) {
      tri[i] = (uint32_t)i;
      for (int k = 0; k < 3; k++)
        p[j][i][k] = (m->point[m->tri[i][0]][k] + m->point[m->tri[i][1]][k] +
                      m->point[m->tri[i][2]][k]) /
                     3;
    }
    if (vg_cad_project(c, j ? VG_CAD_ON_TRIANGLES : VG_CAD_ON_FACES, m->n_tri,
                       j ? tri : s.tri_face, p[j], d[j], &err))
      fail_msg("%s", err.text);
  }
  for (size_t i = 0; i < m->n_tri; i++) { /* of 2500 mm */
    near(d[0][i], d[1][i], 1e-6);
    for (int k = 0; k < 3; k++) near(p[0][i][k], p[1][i][k], 1e-3);
  }
  tri[0] = (uint32_t)m->n_tri;
  assert_int_equal(vg_cad_project(c, VG_CAD_ON_TRIANGLES, 1, tri, p[0], d[0],
                                  &err),
                   VG_ERR_INPUT);
  for (int j = 0; j < 2; j++) {
    free(p[j]);
    free(d[j]);
  }
  free(tri);
  vg_cad_surface_release(&s);
  vg_cad_close(c);
}

static void points_go_to_curves(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_cad *c = open_file(FILE_OF("wing.step"), VG_CAD_STEP, &s);
  double(*p)[3] = calloc(s.n_segment, sizeof *p), *d = calloc(s.n_segment, 8);
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_true(s.n_segment > 50);
  for (size_t i = 0; i < s.n_segment; i++)
    memcpy(p[i], s.mesh.point[s.segment[i][1]], sizeof *p);
  if (vg_cad_project(c, VG_CAD_ON_CURVES, s.n_segment, s.segment_curve, p, d,
                     &err))
    fail_msg("%s", err.text);
  for (size_t i = 0; i < s.n_segment; i++) assert_true(d[i] < 1e-4);
  for (size_t i = 0; i < s.n_segment; i++) p[i][0] += 10000;
  if (vg_cad_project(c, VG_CAD_ON_CURVES, s.n_segment, s.segment_curve, p, NULL,
                     &err))
    fail_msg("%s", err.text);
  for (size_t i = 0; i < s.n_segment; i++) assert_true(p[i][0] < 1101);
  free(p);
  free(d);
  vg_cad_surface_release(&s);
  vg_cad_close(c);
}

/* --- real geometry ------------------------------------------------------- */

static void the_doubled_face_of_dlr_f6(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);

  (void)state;
  read_file(io_real("transport/dlr_f6_wbnp_half.brep.xz"), &o, &m);
  says(&n, "face 130 at");
  says(&n, "duplicates face 123 and was dropped");
  assert_int_equal(m.n_patch, 129);
  is_sound(&m, 1);
  vg_mesh_release(&m);
}

static void real_step_files_are_closed(void **state)
{
  static const struct {
    const char *path;
    size_t patches;
  } cases[] = { { "transport/onera_m6_sharp_te_farfield.stp.xz", 12 },
                { "simple/hemisphere_cylinder_farfield.stp", 5 },
                { "simple/cone_cone.step", 5 },
                { "simple/cube_cylinder.step", 7 } };

  (void)state;
  for (size_t i = 0; i < 4; i++)
    for (int fine = 0; fine < 2; fine++) {
      struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
      struct vg_mesh m = VG_MESH_INIT;

      if (fine) {
        o.angle = 8;
        o.chord = 5e-4;
      }
      read_file(io_real(cases[i].path), &o, &m);
      assert_int_equal(m.n_patch, cases[i].patches);
      is_sound(&m, 1);
      vg_mesh_release(&m);
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(step_has_names_and_units),
    cmocka_unit_test(patches_follow_the_chosen_attribute),
    cmocka_unit_test(parts_stand_where_the_assembly_puts_them),
    cmocka_unit_test(finer_is_nearer),
    cmocka_unit_test(loose_faces_are_sewn),
    cmocka_unit_test(missing_curves_of_parameters_are_made),
    cmocka_unit_test(a_duplicate_face_is_removed),
    cmocka_unit_test(solids_that_touch_are_united),
    cmocka_unit_test(solids_are_zones),
    cmocka_unit_test(some_solids_are_no_zones),
    cmocka_unit_test(wrong_curves_of_a_cone_are_computed),
    cmocka_unit_test(a_face_covered_in_part_is_an_error),
    cmocka_unit_test(pieces_of_a_face_have_its_number),
    cmocka_unit_test(a_solid_that_contains_another_stays),
    cmocka_unit_test(a_rocket_of_ten_solids_is_one_shell),
    cmocka_unit_test(wide_gaps_are_sewn_and_faces_turned),
    cmocka_unit_test(retessellation_equals_a_fresh_read),
    cmocka_unit_test(short_edges_collapse),
    cmocka_unit_test(wing_triangles_stay_out_of_the_root_cap),
    cmocka_unit_test(volume_is_exact),
    cmocka_unit_test(text_after_a_brep_is_accepted),
    cmocka_unit_test(egads_is_a_suffix),
    cmocka_unit_test(a_missing_face_is_named),
    cmocka_unit_test(intersecting_bodies_are_reported_by_the_check),
    cmocka_unit_test(files_that_are_not_cad_are_refused),
    cmocka_unit_test(truncated_input_is_refused),
    cmocka_unit_test(damaged_files_get_an_answer),
    cmocka_unit_test(stops_on_request_and_at_the_time_limit),
    cmocka_unit_test(bytes_are_the_same),
    cmocka_unit_test(points_go_to_the_faces_of_a_box),
    cmocka_unit_test(points_go_to_the_faces_of_a_wing),
    cmocka_unit_test(points_go_to_faces_by_triangles),
    cmocka_unit_test(points_go_to_curves),
    cmocka_unit_test(the_doubled_face_of_dlr_f6),
    cmocka_unit_test(real_step_files_are_closed),
  };

  return cmocka_run_group_tests(tests, needs_cad, NULL);
}
