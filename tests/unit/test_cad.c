/* CAD through the child that Open CASCADE runs in; files: ../cad. */
#include "io_support.h"

#include <math.h>

#include "base/child.h"
#include "core/surface/surface_check.h"
#include "io/cad/cad.h"
#include "io/mesh/format.h"

#define FILE_OF(name) VG_CAD_FILES "/" name

struct notes { char text[8192]; };

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

/* Closed, without defects, of so many shells. */
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
  assert_int_equal(r.n_flipped, 0);         /* out of the solid at once */
  assert_int_equal(m->n_point, n_point);    /* shared by topology already */
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
  static const char *const name[] = { "sides", "sides", "front and back",
                                      "front and back", "ends", "ends" };
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
  near(hi[2], 3 / 25.4, 1e-6);              /* of 3 mm, with gaps */
  vg_mesh_release(&m);
}

static void patches_follow_words(void **state)
{
  static const struct {
    enum vg_cad_patches by;
    size_t n;
    const char *first;
  } cases[] = { { VG_CAD_BY_FACE, 5, "upper" }, { VG_CAD_BY_NAME, 5, "upper" },
                { VG_CAD_BY_LAYER, 2, "SKIN" }, { VG_CAD_BY_COLOUR, 2, "#" },
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
  says(&n, "24 edges had one face only");
  says(&n, "24 of them found a partner");
  assert_int_equal(m.n_point, 8);
  vg_mesh_release(&m);
}

/* A cylinder whose face is bounded by curves in space alone. */
static void missing_curves_of_parameters_are_made(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);
  double lo[3], hi[3];

  (void)state;
  read_file(FILE_OF("bare.brep"), &o, &m);
  assert_int_equal(m.n_patch, 3);
  says(&n, "face 1 lacks the curves of its rim");
  is_sound(&m, 1);
  vg_mesh_bounds(&m, lo, hi);
  near(hi[0], 1, 1e-12);
  near(hi[2], 2, 1e-12);
  vg_mesh_release(&m);
}

static void a_doubled_face_goes(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);

  (void)state;
  read_file(FILE_OF("doubled.brep"), &o, &m);
  assert_int_equal(m.n_patch, 6);
  says(&n, "face 7 at (0.5, 0, 1.5) repeats face 3 and was dropped");
  says(&n, "no unit of length");
  is_sound(&m, 1);
  vg_mesh_release(&m);
}

static void a_missing_face_is_named(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);

  (void)state;
  read_file(FILE_OF("missing.brep"), &o, &m);
  says(&n, "4 edges have one face only, the first is of face 1");
  assert_int_equal(m.n_patch, 5);
  vg_mesh_release(&m);
}

static void crossing_bodies_are_for_the_check(void **state)
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

/* A failure of this kind with this phrase and the file's name. */
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

static void what_is_no_cad_is_refused(void **state)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_cad *c = NULL;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  assert_int_equal(vg_cad_open(&c, &err), VG_OK);
  refuses(c, "solid x", 7, VG_CAD_STEP, VG_ERR_FORMAT, "no STEP file");
  refuses(c, "solid x", 7, VG_CAD_IGES, VG_ERR_FORMAT, "no IGES file");
  refuses(c, "solid x", 7, VG_CAD_BREP, VG_ERR_FORMAT, "no BREP file");
  refuses(c, "ISO-10303-21;\nEND-ISO-10303-21;\n", 32, VG_CAD_STEP,
          VG_ERR_FORMAT, "STEP");
  load(FILE_OF("edges.brep"), &in);
  refuses(c, in.data, in.size, VG_CAD_BREP, VG_ERR_INPUT, "no faces");
  vg_input_release(&in);
  vg_cad_close(c);
  assert_int_equal(vg_cad_read("absent.step", VG_CAD_STEP, NULL, NULL, &m,
                               &err), VG_ERR_IO);
}

static void what_is_cut_short_is_refused(void **state)
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

/* Whatever Open CASCADE makes of damage: an answer, and a next one. */
static void damage_gets_an_answer(void **state)
{
  static const char *const path[] = { FILE_OF("box.step"),
                                      FILE_OF("loose.igs"),
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

static void patience_ends(void **state)
{
  struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  o.stop = at_once;
  assert_int_equal(vg_cad_read(FILE_OF("wing.step"), VG_CAD_STEP, &o, NULL,
                               &m, &err), VG_ERR_IO);
  assert_non_null(strstr(err.text, "stopped"));
  o.stop = NULL;
  o.seconds = 0.2;           /* of about a minute's work */
  o.angle = 1;
  o.chord = 1e-7;
  assert_int_equal(vg_cad_read(FILE_OF("wing.step"), VG_CAD_STEP, &o, NULL,
                               &m, &err), VG_ERR_GEOMETRY);
  assert_non_null(strstr(err.text, "given up after 0.2 s"));
  assert_null(m.point);
}

/* --- the same for everybody ---------------------------------------------- */

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

static struct vg_cad *open_file(const char *path, enum vg_cad_kind kind,
                                struct vg_cad_surface *s)
{
  const struct vg_cad_options o = VG_CAD_OPTIONS_INIT;
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_cad *c = NULL;

  load(path, &in);
  if (vg_cad_open(&c, &err) || vg_cad_parse(c, &in, kind, &o, s, &err))
    fail_msg("%s", err.text);
  vg_input_release(&in);
  return c;
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

/* The middle of a triangle's edge lies within chord and angle of the face; on
 * the face it stays where it is. */
static void points_go_to_the_faces_of_a_wing(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_cad *c = open_file(FILE_OF("wing.step"), VG_CAD_STEP, &s);
  const struct vg_mesh *m = &s.mesh;
  double (*p)[3] = calloc(m->n_tri, sizeof *p), *d = calloc(m->n_tri, 8);
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      p[i][k] = (m->point[m->tri[i][0]][k] + m->point[m->tri[i][1]][k]) / 2;
  if (vg_cad_project(c, VG_CAD_ON_FACES, m->n_tri, s.tri_face, p, d, &err))
    fail_msg("%s", err.text);
  for (size_t i = 0; i < m->n_tri; i++) assert_true(d[i] < 5);  /* 0.5 % */
  if (vg_cad_project(c, VG_CAD_ON_FACES, m->n_tri, s.tri_face, p, d, &err))
    fail_msg("%s", err.text);
  for (size_t i = 0; i < m->n_tri; i++) assert_true(d[i] < 1e-5);
  free(p);
  free(d);
  vg_cad_surface_release(&s);
  vg_cad_close(c);
}

/* With a triangle to begin with: the same places. */
static void points_go_to_faces_by_triangles(void **state)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_cad *c = open_file(FILE_OF("wing.step"), VG_CAD_STEP, &s);
  const struct vg_mesh *m = &s.mesh;
  double (*p[2])[3], *d[2];
  uint32_t *tri = calloc(m->n_tri, sizeof *tri);
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int j = 0; j < 2; j++) {
    p[j] = calloc(m->n_tri, sizeof *p[j]);
    d[j] = calloc(m->n_tri, sizeof *d[j]);
    for (size_t i = 0; i < m->n_tri; i++) {
      tri[i] = (uint32_t)i;
      for (int k = 0; k < 3; k++)
        p[j][i][k] = (m->point[m->tri[i][0]][k] + m->point[m->tri[i][1]][k]
                      + m->point[m->tri[i][2]][k]) / 3;
    }
    if (vg_cad_project(c, j ? VG_CAD_ON_TRIANGLES : VG_CAD_ON_FACES, m->n_tri,
                       j ? tri : s.tri_face, p[j], d[j], &err))
      fail_msg("%s", err.text);
  }
  for (size_t i = 0; i < m->n_tri; i++) {     /* of 2500 mm */
    near(d[0][i], d[1][i], 1e-6);
    for (int k = 0; k < 3; k++) near(p[0][i][k], p[1][i][k], 1e-3);
  }
  tri[0] = (uint32_t)m->n_tri;
  assert_int_equal(vg_cad_project(c, VG_CAD_ON_TRIANGLES, 1, tri, p[0], d[0],
                                  &err), VG_ERR_INPUT);
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
  double (*p)[3] = calloc(s.n_segment, sizeof *p), *d = calloc(s.n_segment, 8);
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_true(s.n_segment > 50);
  for (size_t i = 0; i < s.n_segment; i++)
    memcpy(p[i], s.mesh.point[s.segment[i][1]], sizeof *p);
  if (vg_cad_project(c, VG_CAD_ON_CURVES, s.n_segment, s.segment_curve, p, d,
                     &err)) fail_msg("%s", err.text);
  for (size_t i = 0; i < s.n_segment; i++) assert_true(d[i] < 1e-4);
  for (size_t i = 0; i < s.n_segment; i++) p[i][0] += 10000;
  if (vg_cad_project(c, VG_CAD_ON_CURVES, s.n_segment, s.segment_curve, p,
                     NULL, &err)) fail_msg("%s", err.text);
  for (size_t i = 0; i < s.n_segment; i++) assert_true(p[i][0] < 1101);
  free(p);
  free(d);
  vg_cad_surface_release(&s);
  vg_cad_close(c);
}

/* --- real ones ----------------------------------------------------------- */

static void the_doubled_face_of_dlr_f6(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct notes n;
  struct vg_cad_options o = options(&n);

  (void)state;
  read_file(io_real("transport/dlr_f6_wbnp_half.brep.xz"), &o, &m);
  says(&n, "face 130 at");
  says(&n, "repeats face 123 and was dropped");
  assert_int_equal(m.n_patch, 129);
  is_sound(&m, 1);
  vg_mesh_release(&m);
}

static void real_step_files_are_closed(void **state)
{
  static const struct { const char *path; size_t patches; } cases[] = {
    { "transport/onera_m6_sharp_te_farfield.stp.xz", 12 },
    { "simple/hemisphere_cylinder_farfield.stp", 5 },
    { "simple/cone_cone.step", 5 }, { "simple/cube_cylinder.step", 7 } };

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
    cmocka_unit_test(patches_follow_words),
    cmocka_unit_test(parts_stand_where_the_assembly_puts_them),
    cmocka_unit_test(finer_is_nearer),
    cmocka_unit_test(loose_faces_are_sewn),
    cmocka_unit_test(missing_curves_of_parameters_are_made),
    cmocka_unit_test(a_doubled_face_goes),
    cmocka_unit_test(a_missing_face_is_named),
    cmocka_unit_test(crossing_bodies_are_for_the_check),
    cmocka_unit_test(what_is_no_cad_is_refused),
    cmocka_unit_test(what_is_cut_short_is_refused),
    cmocka_unit_test(damage_gets_an_answer),
    cmocka_unit_test(patience_ends),
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
