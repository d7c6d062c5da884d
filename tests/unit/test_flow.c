/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The side of a surface on which the fluid is. Every kind of surface for which
 * the answer was once wrong, and random ones, with shells reversed at
 * random. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/domain/farfield.h"
#include "core/flow/flow.h"
#include "core/flow/verdict.h"

/* --- shapes -------------------------------------------------------------- */

static double even(void *user, const double x[3])
{
  (void)x;
  return *(double *)user;
}

static uint32_t patch_of(struct vg_mesh *m, const char *name, int32_t bc)
{
  size_t i = vg_mesh_add_patch(m, (int32_t)m->n_patch + 1, name);

  assert_true(i != SIZE_MAX);
  m->patch[i].bc = bc;
  return (uint32_t)i;
}

static void turn(struct vg_mesh *m, size_t from)
{
  for (size_t t = from; t < m->n_tri; t++) {
    uint32_t v = m->tri[t][1];

    m->tri[t][1] = m->tri[t][2];
    m->tri[t][2] = v;
  }
}

/* A ball of radius r, normals outward; half as in vg_add_sphere. */
static void add_ball(struct vg_mesh *m, double x, double y, double z, double r,
                     int half, const char *name)
{
  double h = 0.4 * r;
  const double centre[3] = { x, y, z };
  const struct vg_size_function law = { .at = even, .user = &h };
  struct vg_border border = VG_BORDER_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const uint32_t p = patch_of(m, name, VG_BC_NONE);

  assert_int_equal(vg_add_sphere(m, centre, r, half, 0, &law, p, &border, &err),
                   VG_OK);
  vg_border_release(&border);
}

static int box_edges = 4; /* along the longest side of a box */

/* A box with six patches, normals inward; open as in vg_add_box. */
static void add_box(struct vg_mesh *m, const double lo[3], const double hi[3],
                    int open, const char *const name[6], const int32_t *bc)
{
  double h = 0;
  const struct vg_size_function law = { .at = even, .user = &h };
  struct vg_border border = VG_BORDER_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint32_t p[6];

  for (int k = 0; k < 3; k++) h = fmax(h, (hi[k] - lo[k]) / box_edges);
  for (int i = 0; i < 6; i++)
    p[i] = patch_of(m, name[i], bc ? bc[i] : VG_BC_NONE);
  assert_int_equal(vg_add_box(m, lo, hi, open, &law, p, &border, &err), VG_OK);
  vg_border_release(&border);
}

static const char *const bare[6] = { "", "", "", "", "", "" };
static const char *const ends[6] = { "inlet", "outlet", "wall",
                                     "wall",  "wall",   "wall" };
static const char *const hull[6] = { "wall", "wall", "wall",
                                     "wall", "wall", "wall" };

static void add_cube(struct vg_mesh *m, double half, const char *const name[6],
                     const int32_t *bc)
{
  const double lo[3] = { -half, -half, -half }, hi[3] = { half, half, half };

  add_box(m, lo, hi, -1, name, bc);
}

/* --- the decision -------------------------------------------------------- */

static double volume(const struct vg_mesh *m)
{
  double sum = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    const double *a = m->point[m->tri[i][0]], *b = m->point[m->tri[i][1]],
                 *c = m->point[m->tri[i][2]];

    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) +
           a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

struct answer {
  vg_status st;
  struct vg_flow flow;
  struct vg_error err;
  double volume; /* of the remaining triangles, by their normals */
};

/* m is released. */
static struct answer ask_with(struct vg_mesh *m,
                              const struct vg_flow_options *o)
{
  const struct vg_surface_check_options c = { .repair = 1,
                                              .external = -1,
                                              .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct answer a = { .flow = VG_FLOW_INIT, .err = VG_ERROR_INIT };

  assert_int_equal(vg_surface_check(m, &c, &r, &a.err), VG_OK);
  a.st = vg_flow_settle(m, &r, o, &a.flow, &a.err);
  a.volume = volume(m);
  if (a.st == VG_OK) {
    const int known = a.flow.kind != VG_FLOW_UNKNOWN && a.flow.axis < 0;
    const struct vg_surface_check_options last = {
      .threads = 1, .external = a.flow.kind == VG_FLOW_EXTERNAL
    };

    /* The check agrees with the triangles that were reversed and dropped. */
    assert_int_equal(vg_surface_check(m, &last, &r, &a.err), VG_OK);
    if (known && !o->all_regions) assert_int_equal(r.n_defect, 0);
  }
  free(a.flow.on_outer);
  a.flow.on_outer = NULL;
  vg_surface_report_release(&r);
  vg_mesh_release(m);
  return a;
}

static const struct vg_flow_options plain = { .repair = 1, .threads = 1 };

static struct answer ask(struct vg_mesh *m)
{
  return ask_with(m, &plain);
}

static void is_kind(const struct answer *a, enum vg_flow_kind kind)
{
  if (a->st < 0) fail_msg("%s", a->err.text);
  assert_int_equal(a->flow.kind, kind);
}

/* Two possible readings, both reported with the options that select them. */
static void is_refused(const struct answer *a)
{
  assert_int_equal(a->st, VG_ERR_INPUT);
  assert_non_null(strstr(a->err.text, "--flow external"));
  assert_non_null(strstr(a->err.text, "--flow internal"));
}

/* --- bodies -------------------------------------------------------------- */

static void a_body_is_never_meshed_inside(void **state)
{
  (void)state;
  for (int inward = 0; inward < 2; inward++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;

    add_ball(&m, 0, 0, 0, 1, -1, "");
    if (inward) turn(&m, 0);
    a = ask(&m);
    is_kind(&a, VG_FLOW_EXTERNAL);
    assert_true(a.volume > 0);
    assert_int_equal(a.flow.n_body, 1);
  }
}

/* In formats that define the orientation it determines the side of the
 * fluid. */
static void orientation_counts_where_it_is_defined(void **state)
{
  const struct vg_flow_options trust = { .repair = 1,
                                         .threads = 1,
                                         .side = VG_SIDE_USUAL };
  const int32_t walls[6] = { 4, 4, 4, 4, 4, 4 };
  struct vg_mesh m = VG_MESH_INIT;
  struct answer a;

  (void)state;
  add_ball(&m, 0, 0, 0, 1, -1, "");
  turn(&m, 0);
  a = ask_with(&m, &trust);
  is_kind(&a, VG_FLOW_INTERNAL);
  assert_true(a.volume < 0);
  add_ball(&m, 0, 0, 0, 1, -1, "");
  a = ask_with(&m, &trust);
  is_kind(&a, VG_FLOW_EXTERNAL);
  /* A body all of whose walls have conditions, inside out. */
  add_cube(&m, 1, bare, walls);
  a = ask_with(&m, &trust);
  is_refused(&a);
}

static void sealed_cavities_are_dropped(void **state)
{
  const struct vg_flow_options all = { .repair = 1,
                                       .threads = 1,
                                       .all_regions = 1 };

  (void)state;
  for (int way = 0; way < 4; way++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;
    size_t n;

    add_ball(&m, 0, 0, 0, 1, -1, "skin");
    if (way & 1) turn(&m, 0);
    n = m.n_tri;
    add_ball(&m, 0, 0, 0, 0.9, -1, "cavity");
    if (way & 2) turn(&m, n);
    a = ask(&m);
    is_kind(&a, VG_FLOW_EXTERNAL);
    assert_int_equal(a.flow.n_cavity, 1);
    assert_true(a.flow.cavity_volume > 2 && a.flow.cavity_volume < 3.1);
    assert_true(a.volume > 3.5); /* the skin alone */
  }
  {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;

    add_ball(&m, 0, 0, 0, 1, -1, "skin");
    add_ball(&m, 0, 0, 0, 0.9, -1, "cavity");
    a = ask_with(&m, &all);
    is_kind(&a, VG_FLOW_EXTERNAL);
    assert_int_equal(a.flow.n_cavity, 0);
    assert_true(a.volume > 0.5 && a.volume < 1.5); /* skin less cavity */
  }
}

/* --- outer boundaries ---------------------------------------------------- */

static void a_tunnel_keeps_its_ball(void **state)
{
  static const char *const tunnel[6] = { "tunnel", "tunnel", "tunnel",
                                         "tunnel", "tunnel", "tunnel" };

  (void)state;
  for (int way = 0; way < 8; way++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;
    size_t n;

    add_cube(&m, 3, way & 4 ? tunnel : bare, NULL);
    if (way & 1) turn(&m, 0);
    n = m.n_tri;
    add_ball(&m, 0, 0.5, 0, 0.9, -1, "ball");
    if (way & 2) turn(&m, n);
    a = ask(&m);
    is_kind(&a, VG_FLOW_INTERNAL);
    assert_int_equal(a.flow.n_outer, 1);
    assert_int_equal(a.flow.n_body, 1);
    assert_int_equal(a.flow.n_cavity, 0);
    assert_true(a.volume < -212 && a.volume > -214);
  }
}

/* Few triangles that enclose almost no volume are a defect of the surface. */
static void bubbles_are_left_out(void **state)
{
  static const double x[4][3] = {
    { 0, 0, 0 }, { .01, 0, 0 }, { 0, .01, 0 }, { 0, 0, .01 }
  };
  static const uint32_t t[4][3] = {
    { 0, 2, 1 }, { 0, 1, 3 }, { 1, 2, 3 }, { 0, 3, 2 }
  };
  struct vg_mesh m = VG_MESH_INIT;
  struct answer a;
  uint32_t p;

  (void)state;
  add_ball(&m, 0, 0, 0, 1, -1, "");
  p = patch_of(&m, "", VG_BC_NONE);
  m.point = realloc(m.point, (m.n_point + 4) * sizeof *m.point);
  m.tri = realloc(m.tri, (m.n_tri + 4) * sizeof *m.tri);
  m.tri_patch = realloc(m.tri_patch, (m.n_tri + 4) * sizeof *m.tri_patch);
  memcpy(m.point + m.n_point, x, sizeof x);
  for (int i = 0; i < 4; i++, m.n_tri++) {
    for (int k = 0; k < 3; k++)
      m.tri[m.n_tri][k] = (uint32_t)m.n_point + t[i][k];
    m.tri_patch[m.n_tri] = p;
  }
  m.n_point += 4;
  a = ask(&m);
  is_kind(&a, VG_FLOW_EXTERNAL);
  assert_int_equal(a.flow.n_cavity, 1);
  assert_true(a.volume > 3.5);
}

/* A block on the floor of a room: its patch is not part of the outer boundary.
 * A ball with the same block would be a body with a hole. */
static void a_room_keeps_its_block(void **state)
{
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 1, 1, 1 };
  const char *const room[6] = { "a", "b", "c", "d", "floor", "e" };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_flow f = VG_FLOW_INIT;
  const struct vg_surface_check_options c = { .repair = 1,
                                              .external = -1,
                                              .threads = 1 };
  struct vg_error err = VG_ERROR_INIT;
  uint32_t block;
  size_t n = 0;

  (void)state;
  box_edges = 12;
  add_box(&m, lo, hi, -1, room, NULL);
  box_edges = 4;
  block = patch_of(&m, "block", VG_BC_NONE);
  /* The points of the floor inside the rim of a square are lifted. */
  for (size_t i = 0; i < m.n_point; i++) {
    double *x = m.point[i];

    if (x[2] == 0 && fabs(x[0] - 0.5) < 0.2 && fabs(x[1] - 0.5) < 0.2) {
      x[2] = 0.4;
      n++;
    }
  }
  assert_true(n > 0);
  for (size_t t = 0; t < m.n_tri; t++)
    for (int k = 0; k < 3; k++)
      if (m.tri_patch[t] == 4 && m.point[m.tri[t][k]][2] > 0)
        m.tri_patch[t] = block;
  assert_int_equal(vg_surface_check(&m, &c, &r, &err), VG_OK);
  assert_int_equal(vg_flow_settle(&m, &r, &plain, &f, &err), VG_OK);
  assert_int_equal(f.kind, VG_FLOW_INTERNAL);
  for (size_t i = 0; i < 6; i++) assert_int_equal(f.on_outer[i], 1);
  assert_int_equal(f.on_outer[block], 0);
  vg_flow_release(&f);
  vg_surface_report_release(&r);
  vg_mesh_release(&m);
}

/* A thick hollow block, or a box that contains something large. */
static void doubtful_contents_are_refused(void **state)
{
  const struct vg_flow_options external = { .repair = 1,
                                            .threads = 1,
                                            .kind = VG_FLOW_EXTERNAL,
                                            .asked_by = "flow external" };
  const struct vg_flow_options internal = { .repair = 1,
                                            .threads = 1,
                                            .kind = VG_FLOW_INTERNAL,
                                            .asked_by = "flow internal" };
  struct vg_mesh m = VG_MESH_INIT;
  struct answer a;

  (void)state;
  add_cube(&m, 1, bare, NULL);
  add_cube(&m, 0.4, bare, NULL);
  a = ask(&m);
  is_refused(&a);
  add_ball(&m, 0, 0, 0, 1, -1, "");
  add_ball(&m, 0, 0, 0, 0.3, -1, "");
  a = ask(&m);
  is_refused(&a);
  add_cube(&m, 1, bare, NULL);
  add_cube(&m, 0.4, bare, NULL);
  a = ask_with(&m, &external);
  is_kind(&a, VG_FLOW_EXTERNAL);
  assert_true(fabs(a.volume - 8) < 1e-9);
  add_cube(&m, 1, bare, NULL);
  add_cube(&m, 0.4, bare, NULL);
  a = ask_with(&m, &internal);
  is_kind(&a, VG_FLOW_INTERNAL);
  assert_true(fabs(a.volume + 8 - 0.512) < 1e-9);
}

/* Conditions of both solvers, and names, count equally. */
static void ducts_are_internal(void **state)
{
  static const int32_t code[][6] = { { VG_BC_NONE, VG_BC_NONE, VG_BC_NONE,
                                       VG_BC_NONE, VG_BC_NONE, VG_BC_NONE },
                                     { 102, 101, 4, 4, 4, 4 },
                                     { 7011, 7012, 4000, 4000, 4000, 4000 },
                                     { 7036, 5051, 4000, 4000, 4000, 4000 },
                                     { 103, 1002, 4, 4, 4, 4 },
                                     { 3, 3, 4, 4, 4, 4 },
                                     { 5000, 5000, 4000, 4000, 4000, 4000 } };

  (void)state;
  for (size_t i = 0; i < sizeof code / sizeof *code; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;

    add_cube(&m, 1, i ? bare : ends, code[i]);
    if (i & 1) turn(&m, 0);
    a = ask(&m);
    is_kind(&a, VG_FLOW_INTERNAL);
    assert_true(fabs(a.volume + 8) < 1e-9);
    if (i < 5) assert_int_equal(a.flow.n_inlet + a.flow.n_outlet, 2);
  }
}

static void walls_with_bare_ends_are_refused(void **state)
{
  static const char *const some[6] = { "",     "cap_1", "wall",
                                       "wall", "wall",  "wall" };
  struct vg_mesh m = VG_MESH_INIT;
  struct answer a;

  (void)state;
  add_cube(&m, 1, some, NULL);
  a = ask(&m);
  is_refused(&a);
  add_cube(&m, 1, hull, NULL);
  a = ask(&m);
  is_kind(&a, VG_FLOW_EXTERNAL);
  add_cube(&m, 1, bare, NULL);
  a = ask(&m);
  is_kind(&a, VG_FLOW_EXTERNAL);
}

/* Inlet and outlet inside the silhouette: a box with a pocket at either end. */
static void engine_faces_do_not_make_a_duct(void **state)
{
  struct vg_flow_shell s = { .is_closed = 1, .n_opening = 2 };
  char why[VG_FLOW_TEXT];

  (void)state;
  assert_int_equal(vg_flow_judge(&s, 0, why), VG_FLOW_BODY);
  s.n_opening_end = 1;
  assert_int_equal(vg_flow_judge(&s, 0, why), VG_FLOW_EITHER);
  s.n_opening_end = 2;
  assert_int_equal(vg_flow_judge(&s, 0, why), VG_FLOW_OUTER);
  s.n_opening = s.n_opening_end = 1; /* the nozzle of a rocket */
  assert_int_equal(vg_flow_judge(&s, 0, why), VG_FLOW_EITHER);
}

/* Give the triangles of a cube at x = side with |y| and |z| below 0.6 to a
 * patch of their own. */
static void imprint(struct vg_mesh *m, double side, const char *name)
{
  const uint32_t patch = patch_of(m, name, VG_BC_NONE);

  for (size_t t = 0; t < m->n_tri; t++) {
    int inside = 1;

    for (int k = 0; k < 3; k++) {
      const double *x = m->point[m->tri[t][k]];

      inside &= fabs(x[0] - side) < 1e-9 && fabs(x[1]) < 0.6 &&
                fabs(x[2]) < 0.6;
    }
    if (inside) m->tri_patch[t] = patch;
  }
}

static void flush_openings_make_a_room(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct answer a;

  (void)state;
  add_cube(&m, 1, hull, NULL);
  imprint(&m, -1, "inlet");
  imprint(&m, 1, "outlet");
  a = ask(&m);
  is_kind(&a, VG_FLOW_INTERNAL);
  add_cube(&m, 1, hull, NULL); /* both in one wall */
  imprint(&m, 1, "inlet");
  for (size_t t = 0; t < m.n_tri; t++) {
    const double *x = m.point[m.tri[t][0]];

    if (m.patch[m.tri_patch[t]].name[0] == 'i' && x[1] > 0.2)
      m.tri_patch[t] = patch_of(&m, "outlet", VG_BC_NONE);
  }
  a = ask(&m);
  is_kind(&a, VG_FLOW_INTERNAL);
  add_cube(&m, 1, hull, NULL); /* a single one */
  imprint(&m, 1, "outlet");
  a = ask(&m);
  is_refused(&a);
}

static void several_regions_are_refused(void **state)
{
  const struct vg_flow_options all = { .repair = 1,
                                       .threads = 1,
                                       .all_regions = 1 };
  const double lo[3] = { 5, 5, 5 }, hi[3] = { 6, 6, 6 };

  (void)state;
  for (int way = 0; way < 2; way++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;

    add_cube(&m, 1, ends, NULL);
    add_box(&m, lo, hi, -1, ends, NULL);
    a = ask_with(&m, way ? &all : &plain);
    if (way) is_kind(&a, VG_FLOW_INTERNAL);
    else assert_non_null(strstr(a.err.text, "--regions all"));
    assert_int_equal(a.st, way ? VG_OK : VG_ERR_INPUT);
  }
  {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;

    /* A duct next to a body is a contradiction. */
    add_cube(&m, 1, ends, NULL);
    add_box(&m, lo, hi, -1, bare, NULL);
    a = ask(&m);
    is_refused(&a);
  }
}

/* --- half models --------------------------------------------------------- */

static void open_half_models_are_turned(void **state)
{
  (void)state;
  for (int half = 0; half < 6; half++)
    for (int inward = 0; inward < 2; inward++) {
      struct vg_mesh m = VG_MESH_INIT;
      struct answer a;

      add_ball(&m, 0, 0, 0, 1, half, "");
      if (inward) turn(&m, 0);
      a = ask(&m);
      is_kind(&a, VG_FLOW_EXTERNAL);
      assert_int_equal(a.flow.axis, half / 2);
      assert_true(a.flow.at == 0 && a.flow.n_body == 1);
      assert_true(a.volume > 0); /* the cut passes through the origin */
    }
}

/* The rims of skin and cavity are both in the symmetry plane. */
static void a_hollow_half_model_loses_its_cavity(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct answer a;

  (void)state;
  add_ball(&m, 0, 0, 0, 1, 3, "skin");
  add_ball(&m, 0, 0, 0, 0.8, 3, "cavity");
  a = ask(&m);
  is_kind(&a, VG_FLOW_EXTERNAL);
  assert_int_equal(a.flow.axis, 1);
  assert_int_equal(a.flow.n_cavity, 1);
  assert_true(a.flow.cavity_volume > 0.7 && a.flow.cavity_volume < 1.1);
  assert_true(a.volume > 1.7);
}

/* Outer boundary and body, both open along the symmetry plane. */
static void a_half_domain_is_internal(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct answer a;

  (void)state;
  add_ball(&m, 0, 0, 0, 20, 3, "farfield");
  add_ball(&m, 0, 0, 0, 1, 3, "body");
  a = ask(&m);
  is_kind(&a, VG_FLOW_INTERNAL);
  assert_int_equal(a.flow.axis, 1);
  assert_true(a.flow.n_body == 1 && a.flow.n_outer == 1);
  assert_true(a.volume < -1e4);
}

/* One shell: half a ball of radius 10 around half a ball of radius r, and the
 * plane y = 0 between their rims. Normals point into the room. */
static struct vg_mesh half_room(double r)
{
  const double centre[3] = { 0, 0, 0 };
  double h = 2;
  const struct vg_size_function law = { .at = even, .user = &h };
  struct vg_border border = VG_BORDER_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  uint32_t p = patch_of(&m, "", VG_BC_NONE);

  assert_int_equal(vg_add_sphere(&m, centre, 10, 3, 1, &law, p, &border, &err),
                   VG_OK);
  h = 0.4 * r;
  p = patch_of(&m, "", VG_BC_NONE);
  assert_int_equal(vg_add_sphere(&m, centre, r, 3, 0, &law, p, &border, &err),
                   VG_OK);
  h = 2;
  p = patch_of(&m, "", VG_BC_NONE);
  if (vg_planar_patch(&m, border.n, (const uint32_t(*)[2])border.edge, &law, p,
                      &err) < 0)
    fail_msg("%s", err.text);
  vg_border_release(&border);
  return m;
}

/* Part of a sphere with a pocket is a domain around a half body, for either
 * direction of its normals. The same shape of an ellipsoid is a body with a
 * dent. */
static void half_a_ball_around_half_a_body(void **state)
{
  const double exact = 2 * 3.14159265358979 / 3 * (1000 - 8);

  (void)state;
  for (int way = 0; way < 4; way++) {
    struct vg_mesh m = half_room(2);
    const int is_round = way < 2;
    struct answer a;

    for (size_t i = 0; i < m.n_point && !is_round; i++) m.point[i][0] *= 1.2;
    if (way % 2) turn(&m, 0);
    a = ask(&m);
    is_kind(&a, is_round ? VG_FLOW_INTERNAL : VG_FLOW_EXTERNAL);
    /* Chords of a fifth of the radius are inside the spheres: 1.4 % less. */
    assert_true(fabs(a.volume / (is_round ? -exact : 1.2 * exact) - 1) < 0.02);
  }
}

static struct vg_mesh capped(int32_t bc)
{
  struct vg_mesh m = VG_MESH_INIT;
  const double lo[3] = { -1, 0, -1 }, hi[3] = { 1, 3, 1 };
  const int32_t code[6] = { VG_BC_NONE, VG_BC_NONE, bc,
                            VG_BC_NONE, VG_BC_NONE, VG_BC_NONE };

  add_box(&m, lo, hi, -1, bare, code);
  return m;
}

static void a_cap_is_reported_or_removed(void **state)
{
  struct vg_flow_options o = plain;
  struct vg_mesh m = capped(VG_BC_NONE);
  struct answer a = ask(&m);

  (void)state;
  is_kind(&a, VG_FLOW_EXTERNAL);
  assert_true(a.flow.axis == -1 && a.flow.cap_axis == 1 && a.flow.cap_at == 0);
  assert_int_equal(a.flow.n_cap_tri, 0);
  m = capped(VG_BC_NONE);
  o.half = VG_HALF_Y;
  a = ask_with(&m, &o);
  is_kind(&a, VG_FLOW_EXTERNAL);
  assert_true(a.flow.axis == 1 && a.flow.n_cap_tri > 0);
  m = capped(1); /* a symmetry condition does the same */
  a = ask(&m);
  is_kind(&a, VG_FLOW_EXTERNAL);
  assert_true(a.flow.axis == 1 && a.flow.n_cap_tri > 0);
  m = capped(1);
  o.half = VG_HALF_NO;
  a = ask_with(&m, &o);
  is_kind(&a, VG_FLOW_EXTERNAL);
  assert_int_equal(a.flow.axis, -1);
  add_ball(&m, 0, 0, 0, 1, -1, ""); /* nothing to remove */
  o.half = VG_HALF_Y;
  a = ask_with(&m, &o);
  assert_int_equal(a.st, VG_ERR_INPUT);
}

/* A prism along y over a convex outline in x and z, sheared along x; or a ring,
 * whose hole is a smaller copy of the outline. Normals outward. */
static void add_prism(struct vg_mesh *m, int n, const double (*outline)[2],
                      double shear, double length, double hole)
{
  const uint32_t p = patch_of(m, "", VG_BC_NONE);
  const int n_loop = hole > 0 ? 4 : 2;
  const uint32_t k = (uint32_t)n, first = (uint32_t)m->n_point;

  m->point = realloc(m->point, (m->n_point + 4 * k) * sizeof *m->point);
  m->tri = realloc(m->tri, (m->n_tri + 8 * k) * sizeof *m->tri);
  m->tri_patch = realloc(m->tri_patch,
                         (m->n_tri + 8 * k) * sizeof *m->tri_patch);
  assert_true(m->point && m->tri && m->tri_patch);
  for (int loop = 0; loop < n_loop; loop++) /* root, tip, tip and root inside */
    for (int i = 0; i < n; i++) {
      const double f = loop > 1 ? hole : 1, y = loop % 3 ? length : 0;
      double *x = m->point[m->n_point++];

      x[0] = f * outline[i][0] + shear * y;
      x[1] = y;
      x[2] = f * outline[i][1];
    }
  for (uint32_t i = 0; i < k; i++)
    for (uint32_t loop = 0; loop < (hole > 0 ? 4 : 1); loop++) {
      const uint32_t j = (i + 1) % k, b = (loop + 1) % (uint32_t)n_loop * k;
      const uint32_t v[4] = { first + loop * k + i, first + loop * k + j,
                              first + b + j, first + b + i };
      const uint32_t t[2][3] = { { v[0], v[2], v[1] }, { v[0], v[3], v[2] } };

      memcpy(m->tri[m->n_tri], t, sizeof t);
      m->n_tri += 2;
    }
  for (uint32_t i = 1; i + 1 < k && !(hole > 0); i++) {
    const uint32_t t[2][3] = { { first, first + i, first + i + 1 },
                               { first + k, first + k + i + 1,
                                 first + k + i } };

    memcpy(m->tri[m->n_tri], t, sizeof t);
    m->n_tri += 2;
  }
  for (size_t t = 0; t < m->n_tri; t++) m->tri_patch[t] = p;
}

static const double aerofoil[4][2] = {
  { 0, 0 }, { 0.3, -0.1 }, { 1, 0 }, { 0.3, 0.1 }
};
static const double square[4][2] = {
  { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 }
};

/* The root of a swept wing is one in x = 0 as in y = 0. Bases with a hole, ends
 * of long bars, and feet are not reported. */
static void only_roots_are_reported(void **state)
{
  (void)state;
  for (int way = 0; way < 5; way++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;

    if (way < 2) add_prism(&m, 4, aerofoil, 1, 3, 0);
    if (way == 2) add_prism(&m, 4, square, 0, 1, 0.1);
    if (way == 3) add_prism(&m, 4, square, 0, 9, 0);
    if (way == 4) {
      const double lo[3] = { -9, 1, -9 }, hi[3] = { 9, 2, 9 };

      add_prism(&m, 4, square, 0, 0.5, 0);
      add_box(&m, lo, hi, -1, bare, NULL);
    }
    for (size_t i = 0; i < m.n_point && way == 1; i++) {
      const double x = m.point[i][0];

      m.point[i][0] = m.point[i][1];
      m.point[i][1] = m.point[i][2];
      m.point[i][2] = x + 1;
    }
    a = ask(&m);
    is_kind(&a, VG_FLOW_EXTERNAL);
    assert_int_equal(a.flow.cap_axis, way > 1 ? -1 : !way);
  }
}

/* The root of a swept wing is less than half as wide as the wing. A root that
 * is not quite plane is moved into its plane, but only on demand. */
static void a_given_root_is_removed(void **state)
{
  struct vg_flow_options o = plain;

  (void)state;
  for (int uneven = 0; uneven < 2; uneven++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;

    o.half = VG_HALF_Y;
    add_prism(&m, 4, aerofoil, 1, 3, 0);
    if (uneven) m.point[1][1] = 2e-3;
    a = ask_with(&m, &o);
    is_kind(&a, VG_FLOW_EXTERNAL);
    assert_true(a.flow.axis == 1 && a.flow.at == 0 && a.flow.n_cap_tri == 2);
    assert_true(fabs(a.flow.root_off - 2e-3 * uneven) < 1e-12);
    m = (struct vg_mesh)VG_MESH_INIT;
    add_prism(&m, 4, aerofoil, 1, 3, 0);
    m.point[1][1] = 0.05; /* too far */
    a = ask_with(&m, &o);
    assert_int_equal(a.st, VG_ERR_INPUT);
  }
}

/* A prism whose wall has a row of points at y = row, and whose root is uneven
 * by `off` at one point of its rim. */
static struct vg_mesh with_row(double root, double row, double off)
{
  struct vg_mesh m = VG_MESH_INIT;
  size_t n_tri;

  add_prism(&m, 4, square, 0, 2, 0);
  n_tri = m.n_tri;
  m.point = realloc(m.point, 12 * sizeof *m.point);
  m.tri = realloc(m.tri, (n_tri + 8) * sizeof *m.tri);
  m.tri_patch = realloc(m.tri_patch, (n_tri + 8) * sizeof *m.tri_patch);
  assert_true(m.point && m.tri && m.tri_patch);
  for (size_t i = 0; i < 4; i++) {
    memcpy(m.point[8 + i], m.point[i], sizeof *m.point);
    m.point[8 + i][1] = row;
    m.point[i][1] = root;
  }
  m.point[1][1] += off;
  for (size_t t = 0; t < n_tri; t++) { /* walls begin at the row */
    const uint32_t *v = m.tri[t];
    const int is_wall = (v[0] < 4 || v[1] < 4 || v[2] < 4) &&
                        (v[0] > 3 || v[1] > 3 || v[2] > 3);

    for (int k = 0; k < 3 && is_wall; k++)
      if (m.tri[t][k] < 4) m.tri[t][k] += 8;
  }
  for (uint32_t i = 0; i < 4; i++) {
    const uint32_t j = (i + 1) % 4;
    const uint32_t t[2][3] = { { i, 8 + j, j }, { i, 8 + i, 8 + j } };

    memcpy(m.tri[m.n_tri], t, sizeof t);
    for (int k = 0; k < 2; k++) m.tri_patch[m.n_tri++] = m.tri_patch[0];
  }
  m.n_point = 12;
  return m;
}

/* A row of points next to the root, on either side of 0, does not change the
 * decision; neither does the orientation. */
static void a_row_next_to_the_root_is_no_root(void **state)
{
  static const double row[] = { 1e-3, 1e-4, 1e-5, 1e-7, 1e-9, 0, -5e-5 };
  struct vg_flow_options o = plain;

  (void)state;
  o.half = VG_HALF_Y;
  for (size_t i = 0; i < 2 * sizeof row / sizeof *row; i++) {
    struct vg_mesh m = with_row(-1e-4, row[i / 2], 0);
    struct answer a;

    for (size_t t = 0; t < m.n_tri && i % 2; t++) {
      const uint32_t v = m.tri[t][1];

      m.tri[t][1] = m.tri[t][2];
      m.tri[t][2] = v;
    }
    a = ask_with(&m, &o);
    is_kind(&a, VG_FLOW_EXTERNAL);
    assert_true(a.flow.axis == 1 && a.flow.n_cap_tri == 2);
    assert_true(a.flow.at == (row[i / 2] > 5e-5 ? 0 : -1e-4));
    assert_true(fabs(a.volume / 8 - 1) < 1e-3);
  }
}

/* An uneven cap is removed as a whole, or refused. Its triangle at point 1 is
 * steep, and belongs to the cap if the patch says so. */
static void an_uneven_cap_is_not_removed_in_part(void **state)
{
  static const double thin[4][2] = {
    { 0.9985, -0.0015 }, { 1, 0 }, { 0.9985, 0.0015 }, { -1, 0 }
  };
  struct vg_flow_options o = plain;

  (void)state;
  o.half = VG_HALF_Y;
  for (int way = 0; way < 4; way++) {
    const double off = way < 3 ? 1.9e-3 : 0.03;
    struct vg_mesh m = with_row(0, 0.5, off);
    const uint32_t root = patch_of(&m, "root", VG_BC_NONE);
    struct answer a;

    for (int i = 0; i < 12 && way; i++) {
      m.point[i][0] = thin[i % 4][0];
      m.point[i][2] = thin[i % 4][1];
    }
    for (size_t t = 0; t < m.n_tri && way > 1; t++) {
      const uint32_t *v = m.tri[t];

      if (v[0] < 4 && v[1] < 4 && v[2] < 4) m.tri_patch[t] = root;
    }
    a = ask_with(&m, &o);
    if (way % 2) {
      assert_int_equal(a.st, VG_ERR_INPUT);
      continue;
    }
    is_kind(&a, VG_FLOW_EXTERNAL);
    assert_true(a.flow.axis == 1 && a.flow.at == 0 && a.flow.n_cap_tri == 2);
    assert_true(fabs(a.flow.root_off - off) < 1e-12);
  }
}

/* The eight corners of a tube that is not along the axes are on one sphere. */
static void a_turned_tube_is_a_body(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct answer a;

  (void)state;
  add_prism(&m, 4, square, 0, 3, 0.98);
  for (size_t i = 0; i < m.n_point; i++) {
    const double x = m.point[i][0], y = m.point[i][1], z = m.point[i][2];

    m.point[i][0] = 0.6 * x + 0.8 * y;
    m.point[i][1] = -0.64 * x + 0.48 * y + 0.6 * z;
    m.point[i][2] = 0.48 * x - 0.36 * y + 0.8 * z;
  }
  a = ask(&m);
  is_kind(&a, VG_FLOW_EXTERNAL);
}

/* The symmetry plane of a whole domain is kept. */
static void a_symmetry_plane_of_a_domain_stays(void **state)
{
  static const int32_t code[][6] = { { 3, 3, 1, 3, 3, 3 },
                                     { 102, 101, 6662, 4, 4, 4 } };

  (void)state;
  for (int i = 0; i < 2; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    const double lo[3] = { -1, 0, -1 }, hi[3] = { 1, 2, 1 };
    struct answer a;

    add_box(&m, lo, hi, -1, bare, code[i]);
    a = ask(&m);
    is_kind(&a, VG_FLOW_INTERNAL);
    assert_true(a.flow.axis == -1 && a.flow.n_cap_tri == 0);
    assert_true(fabs(a.volume + 8) < 1e-9);
  }
}

/* An open tube is no half model, and its flow side is not decided. */
static void open_tubes_are_not_decided(void **state)
{
  const double lo[3] = { 0, -1, -1 }, hi[3] = { 5, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct answer a;
  size_t n = 0;

  (void)state;
  add_box(&m, lo, hi, 0, bare, NULL);
  for (size_t t = 0; t < m.n_tri; t++) { /* and at the other end */
    if (m.point[m.tri[t][0]][0] == 5 && m.point[m.tri[t][1]][0] == 5 &&
        m.point[m.tri[t][2]][0] == 5)
      continue;
    memmove(m.tri[n], m.tri[t], sizeof *m.tri);
    m.tri_patch[n++] = m.tri_patch[t];
  }
  m.n_tri = n;
  a = ask(&m);
  assert_int_equal(a.st, VG_OK);
  assert_int_equal(a.flow.kind, VG_FLOW_UNKNOWN);
  assert_int_equal(a.flow.axis, -1);
}

/* --- random search ------------------------------------------------------- */

static uint64_t seed = 88172645463325252u;

static double chance(void)
{
  seed ^= seed << 13;
  seed ^= seed >> 7;
  seed ^= seed << 17;
  return (double)(seed >> 11) / 9007199254740992.0;
}

/* Shells are reversed at random. The result is the surface as built, or a
 * refusal that names both readings: never the inside of a body. */
static void random_surfaces_are_read_or_refused(void **state)
{
  static const int32_t duct[6] = { 102, 101, 4, 4, 4, 4 };
  size_t n_read = 0;

  (void)state;
  for (int i = 0; i < 400; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct answer a;
    const int kind = (int)(5 * chance()), n = 1 + (int)(3 * chance());
    const double size = 1 + 9 * chance();
    int internal = 0, half = chance() < 0.3;
    size_t from = 0;

    if (kind == 1) add_cube(&m, size, bare, chance() < 0.5 ? duct : NULL);
    if (kind == 2) add_cube(&m, size, ends, NULL);
    if (kind == 3) add_ball(&m, 0, 0, 0, 30 * size, -1, "far");
    internal = (kind == 1 && m.patch[0].bc == 102) || kind == 2 || kind == 3;
    if (chance() < 0.5) turn(&m, 0);
    for (int k = 0; k < n; k++) {
      from = m.n_tri;
      add_ball(&m, 0.5 * size * (k - 1), 0, 0,
               0.2 * size * (0.1 + 0.9 * chance()),
               half && (kind == 0 || kind == 4) ? 3 : -1, "");
      if (kind == 4)
        add_ball(&m, 0.5 * size * (k - 1), 0, 0, 1e-3 * size, half ? 3 : -1,
                 "");
      if (chance() < 0.5) turn(&m, from);
    }
    a = ask(&m);
    if (a.st < 0) {
      is_refused(&a);
      assert_true(kind == 1 || kind == 4);
      continue;
    }
    n_read++;
    /* A box without names around small bodies is a domain, too. */
    if (kind != 1)
      assert_int_equal(a.flow.kind,
                       internal ? VG_FLOW_INTERNAL : VG_FLOW_EXTERNAL);
    assert_true(a.flow.kind == VG_FLOW_INTERNAL ? a.volume < 0 : a.volume > 0);
    assert_int_equal(a.flow.n_body, n);
    assert_true(a.flow.n_evidence > 0);
  }
  assert_true(n_read > 100); /* else nothing was tested */
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_body_is_never_meshed_inside),
    cmocka_unit_test(orientation_counts_where_it_is_defined),
    cmocka_unit_test(sealed_cavities_are_dropped),
    cmocka_unit_test(a_tunnel_keeps_its_ball),
    cmocka_unit_test(a_room_keeps_its_block),
    cmocka_unit_test(bubbles_are_left_out),
    cmocka_unit_test(doubtful_contents_are_refused),
    cmocka_unit_test(ducts_are_internal),
    cmocka_unit_test(walls_with_bare_ends_are_refused),
    cmocka_unit_test(engine_faces_do_not_make_a_duct),
    cmocka_unit_test(flush_openings_make_a_room),
    cmocka_unit_test(several_regions_are_refused),
    cmocka_unit_test(open_half_models_are_turned),
    cmocka_unit_test(a_hollow_half_model_loses_its_cavity),
    cmocka_unit_test(a_half_domain_is_internal),
    cmocka_unit_test(half_a_ball_around_half_a_body),
    cmocka_unit_test(a_cap_is_reported_or_removed),
    cmocka_unit_test(only_roots_are_reported),
    cmocka_unit_test(a_given_root_is_removed),
    cmocka_unit_test(a_row_next_to_the_root_is_no_root),
    cmocka_unit_test(an_uneven_cap_is_not_removed_in_part),
    cmocka_unit_test(a_turned_tube_is_a_body),
    cmocka_unit_test(a_symmetry_plane_of_a_domain_stays),
    cmocka_unit_test(open_tubes_are_not_decided),
    cmocka_unit_test(random_surfaces_are_read_or_refused),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
