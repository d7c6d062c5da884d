/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* CGNS: written meshes are read back, trees of other programs are read, and
 * invalid ones are refused. */
#include "mixed_support.h"

#ifdef VG_HAS_HDF5
#include <hdf5.h>
#endif

#include "io/cgns/cgns.h"
#include "io/cgns/cgns_put.h"
#include "io/cgns/cgns_tree.h"

/* --- round trips --- */

static void go_round(const struct vg_mesh *m, int is_wide, struct vg_mesh *back)
{
  const struct vg_cgns_options o = { .is_wide = is_wide };
  const char *path = io_temp("round.cgns");
  struct vg_error err = VG_ERROR_INIT;

  if (vg_cgns_write_with(path, m, &o, &err) != VG_OK ||
      vg_cgns_read(path, back, &err) != VG_OK)
    fail_msg("%s", err.text);
  unlink(path);
}

static void all_kinds_come_back(void **state)
{
  static const char *const given[3] = { "ZoneBC", "Zone BC", "" };
  static const char *const name[3] = { "patch_ZoneBC", "Zone_BC", "patch_13" };

  (void)state;
  for (int is_wide = 0; is_wide < 2; is_wide++) {
    struct vg_mesh m = VG_MESH_INIT, back = VG_MESH_INIT;

    mixed_make(&m, 5, 4);
    for (int p = 0; p < 3; p++) strcpy(m.patch[p].name, given[p]);
    m.patch[1].bc = VG_BC_NONE;
    m.patch[1].bc_fun3d = 5000;
    go_round(&m, is_wide, &back);
    mixed_same(&back, &m);
    for (int p = 0; p < 3; p++) {
      assert_int_equal(back.patch[p].id, m.patch[p].id);
      assert_string_equal(back.patch[p].name, name[p]);
    }
    assert_int_equal(back.patch[0].bc, 4);
    assert_int_equal(back.patch[0].bc_fun3d, 4000);
    assert_int_equal(back.patch[1].bc, 3);
    assert_int_equal(back.patch[2].bc, VG_BC_NONE);
    vg_mesh_release(&m);
    vg_mesh_release(&back);
  }
}

/* Numbers that are not the order come back, unless two are the same. */
static void numbers_come_back(void **state)
{
  static const int32_t id[3] = { 7, -2, 2147483647 };

  (void)state;
  for (int twice = 0; twice < 2; twice++) {
    struct vg_mesh m = VG_MESH_INIT, back = VG_MESH_INIT;

    mixed_make(&m, 5, 4);
    for (int p = 0; p < 3; p++) {
      m.patch[p].id = twice && p == 2 ? id[0] : id[p];
      snprintf(m.patch[p].name, sizeof m.patch[p].name, "p%d", p);
    }
    go_round(&m, 0, &back);
    assert_int_equal(back.n_patch, 3);
    for (int p = 0; p < 3; p++)
      assert_int_equal(back.patch[p].id, twice ? p + 1 : id[p]);
    vg_mesh_release(&m);
    vg_mesh_release(&back);
  }
}

static void every_condition_comes_back(void **state)
{
  static const int32_t code[][3] = { /* given; read back: USM3D, FUN3D */
                                     { 4, 4, 4000 },
                                     { 44, 4, 4000 },
                                     { 5, 5, 3000 },
                                     { 1, 1, 6663 },
                                     { 3, 3, 5000 }
  };
  struct vg_mesh m, back = VG_MESH_INIT;

  (void)state;
  io_make_t1(&m, 1);
  for (size_t i = 0; i < sizeof code / sizeof *code; i++) {
    m.patch[0].bc = code[i][0];
    go_round(&m, 0, &back);
    assert_int_equal(back.patch[0].bc, code[i][1]);
    assert_int_equal(back.patch[0].bc_fun3d, code[i][2]);
  }
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

/* The file contains neither times nor paths. */
static void bytes_follow_from_the_mesh(void **state)
{
  const char *path[2] = { io_temp("once.cgns"), io_temp("other_name.cgns") };
  unsigned char *data[2];
  size_t size[2];
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  mixed_make(&m, 3, 2);
  for (int k = 0; k < 2; k++) {
    if (k) sleep(1); /* HDF5 counts seconds */
    assert_int_equal(vg_cgns_write(path[k], &m, NULL), VG_OK);
    data[k] = io_slurp(path[k], &size[k]);
    unlink(path[k]);
  }
  assert_int_equal(size[0], size[1]);
  assert_memory_equal(data[0], data[1], size[0]);
  free(data[0]);
  free(data[1]);
  vg_mesh_release(&m);
}

static void write_errors_are_reported(void **state)
{
  const char *path = io_temp("refused.cgns");
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_make_t1(&m, 0);
  assert_int_equal(vg_cgns_write(path, &m, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "no cells"));
  assert_int_equal(access(path, F_OK), -1);
  vg_mesh_release(&m);
  io_make_t1(&m, 1);
  assert_int_equal(vg_cgns_write("/nowhere/at/all.cgns", &m, &err), VG_ERR_IO);
  assert_non_null(strstr(err.text, "/nowhere/at/all.cgns"));
  vg_mesh_release(&m);
}

/* --- trees of other programs --- */

struct tree {
  struct vg_cgns_store store;
  struct vg_cgns_tree *t;
  int64_t root, base, zone;
};

static int64_t add(struct tree *t, int64_t parent, const char *name,
                   const char *label, const char *type, int n_dim, size_t rows,
                   size_t n, const void *v)
{
  const struct vg_cgns_data d = {
    type, n_dim, { n_dim == 2 ? rows : n, n / rows }, v
  };
  int64_t id;

  assert_int_equal(vg_cgns_tree_add(t->t, parent, name, label, &d, &id, NULL,
                                    NULL),
                   VG_OK);
  return id;
}

static int64_t add_text(struct tree *t, int64_t parent, const char *name,
                        const char *label, const char *text)
{
  return add(t, parent, name, label, "C1", 1, 1, strlen(text), text);
}

static void begin(struct tree *t)
{
  memset(&t->store, 0, sizeof t->store);
  assert_int_equal(vg_cgns_tree_new(&t->store, "t", &t->t, &t->root, NULL),
                   VG_OK);
}

static void start(struct tree *t, int32_t dimension)
{
  const int32_t cell[2] = { dimension, 3 };

  begin(t);
  t->base = add(t, t->root, "wing", "CGNSBase_t", "I4", 1, 1, 2, cell);
}

/* A zone with the points of T1 listed in `which`, [n]. */
static void zone(struct tree *t, const char *name, int n, const int *which)
{
  static const char *const axis[3] = { "CoordinateX", "CoordinateY",
                                       "CoordinateZ" };
  static const double point[4][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
  };
  const int32_t size[3] = { n, 1, 0 };
  int64_t grid;

  t->zone = add(t, t->base, name, "Zone_t", "I4", 2, 1, 3, size);
  add_text(t, t->zone, "ZoneType", "ZoneType_t", "Unstructured");
  grid = add(t, t->zone, "GridCoordinates", "GridCoordinates_t", "MT", 0, 1, 0,
             NULL);
  for (int k = 0; k < 3; k++) {
    float x[4] = { 0 };

    for (int i = 0; i < n; i++) x[i] = (float)point[which[i]][k];
    add(t, grid, axis[k], "DataArray_t", "R4", 1, 1, (size_t)n, x);
  }
}

static int64_t section(struct tree *t, const char *name, int32_t code,
                       int64_t first, int64_t last, size_t n, const int32_t *v)
{
  const int32_t kind[2] = { code, 0 };
  const int64_t range[2] = { first, last };
  int64_t id = add(t, t->zone, name, "Elements_t", "I4", 1, 1, 2, kind);

  add(t, id, "ElementRange", "IndexRange_t", "I8", 1, 1, 2, range);
  add(t, id, "ElementConnectivity", "DataArray_t", "I4", 1, 1, n, v);
  return id;
}

static int64_t condition(struct tree *t, int64_t zone_bc, const char *name,
                         const char *type, const char *at, const char *list,
                         size_t n, const int32_t *v)
{
  int64_t id = add_text(t, zone_bc, name, "BC_t", type);

  add(t, id, list, strstr(list, "Range") ? "IndexRange_t" : "IndexArray_t",
      "I4", 2, 1, n, v);
  if (at) add_text(t, id, "GridLocation", "GridLocation_t", at);
  return id;
}

static int64_t conditions(struct tree *t)
{
  return add(t, t->zone, "ZoneBC", "ZoneBC_t", "MT", 0, 1, 0, NULL);
}

/* Closes the tree and reads it. */
static vg_status read_tree(struct tree *t, struct vg_mesh *m,
                           struct vg_error *err)
{
  unsigned char *data;
  vg_status st;

  assert_int_equal(vg_cgns_tree_close(t->t, NULL), VG_OK);
  data = malloc(t->store.size);
  vg_cgns_store_get(&t->store, 0, t->store.size, data);
  st = io_parse_bytes(vg_cgns_parse, data, t->store.size, m, err);
  free(data);
  vg_cgns_store_release(&t->store);
  return st;
}

static void accept(struct tree *t, struct vg_mesh *m)
{
  struct vg_error err = VG_ERROR_INIT;

  if (read_tree(t, m, &err) != VG_OK) fail_msg("%s", err.text);
}

static void refuse(struct tree *t, vg_status code, const char *phrase)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT, empty = VG_MESH_INIT;
  vg_status st = read_tree(t, &m, &err);

  if (st != code || !strstr(err.text, phrase) || !strstr(err.text, "case"))
    fail_msg("status %d instead of %d, '%s' has no '%s'", st, code, err.text,
             phrase);
  assert_memory_equal(&m, &empty, sizeof m);
}

static const int all[4] = { 0, 1, 2, 3 };
static const int32_t t1_mixed[] = { 3, 1, 2, 5, 1, 2, 3, 5, 1, 4,
                                    2, 5, 1, 3, 4, 5, 2, 4, 3 };

/* Bars and faces in one section, with conditions by family, directly, by range
 * and by list; the last face has none. */
static void boundary_conditions_define_patches(void **state)
{
  static const int32_t second[2] = { 2, 2 }, list[2] = { 3, 4 };
  struct vg_mesh m = VG_MESH_INIT, t1;
  struct tree t;
  int64_t family, bc;

  (void)state;
  start(&t, 3);
  family = add(&t, t.base, "skin", "Family_t", "MT", 0, 1, 0, NULL);
  add_text(&t, family, "FamilyBC", "FamilyBC_t", "BCWallInviscid");
  zone(&t, "Zone 1", 4, all);
  section(&t, "everything", 20, 1, 5, sizeof t1_mixed / 4, t1_mixed);
  bc = conditions(&t);
  add_text(&t,
           condition(&t, bc, "bc-1", "FamilySpecified", "FaceCenter",
                     "PointRange", 2, second),
           "FamilyName", "FamilyName_t", "/wing/skin");
  condition(&t, bc, "far", "BCFarfield", NULL, "ElementList", 2, list);
  accept(&t, &m);
  io_make_t1(&t1, 0);
  assert_int_equal(m.n_point, 4);
  assert_memory_equal(m.tri, t1.tri, 4 * sizeof *m.tri);
  assert_int_equal(m.n_patch, 3);
  assert_string_equal(m.patch[0].name, "skin");
  assert_int_equal(m.patch[0].bc, 5);
  assert_string_equal(m.patch[1].name, "far");
  assert_int_equal(m.patch[1].bc, 3);
  assert_string_equal(m.patch[2].name, "everything");
  assert_int_equal(m.patch[2].bc, VG_BC_NONE);
  for (uint32_t i = 0; i < 4; i++)
    assert_int_equal(m.tri_patch[i], i < 2 ? i : i - 1);
  vg_mesh_release(&m);
  vg_mesh_release(&t1);
}

/* Zones of one face each, as surface programs write them: shared points are
 * merged, and patches are the zones or their families. */
static void zones_are_joined(void **state)
{
  static const int part[2][3] = { { 0, 1, 2 }, { 3, 1, 0 } };
  static const int32_t tri[3] = { 1, 2, 3 };
  struct vg_mesh m = VG_MESH_INIT;
  struct tree t;

  (void)state;
  start(&t, 2);
  zone(&t, "lower", 3, part[0]);
  section(&t, "Tri", 5, 1, 1, 3, tri);
  zone(&t, "dom-2", 3, part[1]);
  section(&t, "Tri", 5, 1, 1, 3, tri);
  add_text(&t, t.zone, "FamilyName", "FamilyName_t", "side");
  accept(&t, &m);
  assert_int_equal(m.n_point, 4);
  assert_int_equal(m.n_tri, 2);
  assert_int_equal(m.tri[1][1], m.tri[0][1]);
  assert_int_equal(m.tri[1][2], m.tri[0][0]);
  assert_int_equal(m.n_patch, 2);
  assert_string_equal(m.patch[0].name, "lower");
  assert_string_equal(m.patch[1].name, "side");
  vg_mesh_release(&m);
}

static void one_face(struct tree *t, int32_t dimension, int32_t code,
                     int64_t last, size_t n, const int32_t *v)
{
  start(t, dimension);
  zone(t, "Zone 1", 4, all);
  section(t, "faces", code, 1, last, n, v);
}

static void refuses_sections(void **state)
{
  static const int32_t tri[6] = { 1, 2, 3, 1, 2, 5 };
  static const int32_t mixed[5] = { 5, 1, 2, 3, 6 };
  struct tree t;

  (void)state;
  one_face(&t, 3, 5, 2, 6, tri);
  refuse(&t, VG_ERR_INPUT, "point 5 of 4");
  one_face(&t, 3, 6, 1, 6, tri);
  refuse(&t, VG_ERR_UNSUPPORTED, "type 6");
  one_face(&t, 3, 22, 1, 6, tri);
  refuse(&t, VG_ERR_UNSUPPORTED, "polygons");
  one_face(&t, 3, 5, INT64_MAX, 6, tri);
  refuse(&t, VG_ERR_FORMAT, "does not match the number");
  one_face(&t, 3, 5, 0, 6, tri);
  refuse(&t, VG_ERR_FORMAT, "not a valid range");
  one_face(&t, 3, 20, 2, 5, mixed);
  refuse(&t, VG_ERR_UNSUPPORTED, "type 6");
  one_face(&t, 3, 20, 2, 4, mixed);
  refuse(&t, VG_ERR_FORMAT, "too few");
  one_face(&t, 3, 20, 1, 5, mixed);
  refuse(&t, VG_ERR_FORMAT, "more nodes");
  one_face(&t, 3, 5, 1, 3, tri);
  section(&t, "again", 5, 1, 1, 3, tri);
  refuse(&t, VG_ERR_FORMAT, "another section");
  one_face(&t, 3, 3, 1, 2, tri);
  refuse(&t, VG_ERR_INPUT, "nothing to mesh");
}

/* --- solutions --- */

/* A solution with an array of four values. */
static void solution(struct tree *t, const char *name, const char *at,
                     const char *array, double first)
{
  const double v[4] = { first, first + 1, first + 2, first + 3 };
  int64_t id = add(t, t->zone, name, "FlowSolution_t", "MT", 0, 1, 0, NULL);

  if (at) add_text(t, id, "GridLocation", "GridLocation_t", at);
  add(t, id, array, "DataArray_t", "R8", 1, 1, 4, v);
}

static const char *asked;
static double *answer;

static vg_status parse_solution(struct vg_input *in, struct vg_mesh *out,
                                struct vg_error *err)
{
  return vg_cgns_solution_parse(in, asked, out, &answer, err);
}

static vg_status read_solution(int n_zone, const char *name,
                               struct vg_error *err)
{
  struct tree t;
  struct vg_mesh m = VG_MESH_INIT;
  unsigned char *data;
  vg_status st;

  start(&t, 3);
  for (int z = 0; z < n_zone; z++) {
    zone(&t, z ? "second" : "first", 4, all);
    section(&t, "cells", 20, 1, 5, sizeof t1_mixed / sizeof *t1_mixed,
            t1_mixed);
    solution(&t, "begin", NULL, "Density", 0);
    solution(&t, "end", "Vertex", "Density", 10);
    solution(&t, "in cells", "CellCenter", "Temperature", 5);
  }
  assert_int_equal(vg_cgns_tree_close(t.t, NULL), VG_OK);
  data = malloc(t.store.size);
  vg_cgns_store_get(&t.store, 0, t.store.size, data);
  asked = name;
  answer = NULL;
  st = io_parse_bytes(parse_solution, data, t.store.size, &m, err);
  free(data);
  vg_cgns_store_release(&t.store);
  vg_mesh_release(&m);
  return st;
}

static void solutions_at_points(void **state)
{
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  if (read_solution(1, "Density", &err) != VG_OK) fail_msg("%s", err.text);
  for (int i = 0; i < 4; i++) assert_true(answer[i] == 10 + i);
  free(answer);
  assert_int_equal(read_solution(1, "Temperature", &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "Vertex"));
  assert_int_equal(read_solution(1, "Mach", &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "points are: Density, Density"));
  assert_int_equal(read_solution(1, "", &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "--field"));
  assert_int_equal(read_solution(2, "Density", &err), VG_ERR_UNSUPPORTED);
  assert_non_null(strstr(err.text, "2 zones"));
  assert_null(answer);
}

static void refuses_trees(void **state)
{
  static const int32_t tri[3] = { 1, 2, 3 }, size[9] = { 2, 2, 2 };
  struct vg_mesh m = VG_MESH_INIT;
  struct tree t;

  (void)state;
  start(&t, 1);
  refuse(&t, VG_ERR_UNSUPPORTED, "of dimension 2");
  begin(&t);
  refuse(&t, VG_ERR_FORMAT, "no base");
  start(&t, 3);
  refuse(&t, VG_ERR_INPUT, "nothing to mesh");
  start(&t, 3);
  add_text(&t, add(&t, t.base, "block", "Zone_t", "I4", 2, 3, 9, size),
           "ZoneType", "ZoneType_t", "UserDefined");
  refuse(&t, VG_ERR_UNSUPPORTED, "neither Structured nor Unstructured");
  start(&t, 3);
  add_text(&t, add(&t, t.base, "empty", "Zone_t", "I4", 2, 1, 3, size),
           "ZoneType", "ZoneType_t", "Unstructured");
  refuse(&t, VG_ERR_FORMAT, "CoordinateX has 0 values");
  one_face(&t, 3, 5, 1, 3, tri);
  condition(&t, conditions(&t), "points", "BCWall", NULL, "PointList", 3, tri);
  refuse(&t, VG_ERR_UNSUPPORTED, "FaceCenter");
  /* the boundaries of a surface are such conditions */
  one_face(&t, 2, 5, 1, 3, tri);
  condition(&t, conditions(&t), "rim", "BCWall", NULL, "PointList", 3, tri);
  accept(&t, &m);
  assert_string_equal(m.patch[0].name, "faces");
  vg_mesh_release(&m);
}

/* --- structured zones --- */

/* Points i j k of a unit cube of n[] points, moved by `at` along x, and the
 * indices permuted so that the first runs along `axis`. If mirrored, they are
 * left-handed. */
struct lattice {
  int n[3], axis, is_mirrored;
  double at;
};

static void lattice_point(const struct lattice *l, const int i[3], double x[3])
{
  for (int k = 0; k < 3; k++) {
    int m = l->n[k] - 1;
    double share = m ? (double)i[k] / m : 0;

    x[(k + l->axis) % 3] = l->is_mirrored && !k ? 1 - share : share;
  }
  x[0] += l->at;
}

static void block(struct tree *t, const char *name, int d,
                  const struct lattice *l)
{
  static const char *const axis[3] = { "CoordinateX", "CoordinateY",
                                       "CoordinateZ" };
  size_t n = (size_t)l->n[0] * (size_t)l->n[1] * (size_t)l->n[2];
  double *x = malloc(3 * n * sizeof *x);
  int32_t size[9] = { 0 };
  int64_t grid;

  for (int k = 0; k < d; k++) {
    size[k] = l->n[k];
    size[d + k] = l->n[k] - 1;
  }
  for (size_t p = 0; p < n; p++) {
    const int i[3] = { (int)p % l->n[0], (int)p / l->n[0] % l->n[1],
                       (int)p / l->n[0] / l->n[1] };
    double to[3];

    lattice_point(l, i, to);
    for (size_t k = 0; k < 3; k++) x[k * n + p] = to[k];
  }
  t->zone = add(t, t->base, name, "Zone_t", "I4", 2, (size_t)d, 3 * (size_t)d,
                size);
  add_text(t, t->zone, "ZoneType", "ZoneType_t", "Structured");
  grid = add(t, t->zone, "GridCoordinates", "GridCoordinates_t", "MT", 0, 1, 0,
             NULL);
  for (size_t k = 0; k < 3; k++)
    add(t, grid, axis[k], "DataArray_t", "R8", 1, 1, n, x + k * n);
  free(x);
}

/* Six times the volume that the triangles enclose, > 0 if their normals point
 * out. */
static double volume6(const struct vg_mesh *m)
{
  double sum = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    const double *a = m->point[m->tri[t][0]], *b = m->point[m->tri[t][1]];
    const double *c = m->point[m->tri[t][2]];

    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) +
           a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum;
}

/* Two zones of a surface share a side: the points of the side are merged, and
 * each zone or its family becomes a patch. */
static void surface_blocks_are_joined(void **state)
{
  const struct lattice left = { { 4, 3, 1 }, 0, 0, 0 };
  const struct lattice right = { { 3, 3, 1 }, 0, 0, 1 };
  static const int32_t side[4] = { 1, 1, 1, 3 }, part[4] = { 1, 1, 2, 3 };
  struct vg_mesh m = VG_MESH_INIT;
  struct tree t;

  (void)state;
  start(&t, 2);
  block(&t, "left", 2, &left);
  /* a condition on an edge does not apply to faces */
  condition(&t, conditions(&t), "edge", "BCWall", NULL, "PointRange", 4, side);
  block(&t, "right", 2, &right);
  condition(&t, conditions(&t), "part", "BCWallInviscid", NULL, "PointRange", 4,
            part);
  add_text(&t, t.zone, "FamilyName", "FamilyName_t", "wing");
  accept(&t, &m);
  assert_int_equal(m.n_point, 12 + 9 - 3);
  assert_int_equal(m.n_tri, 2 * (6 + 4));
  assert_int_equal(m.n_quad, 0);
  assert_int_equal(m.n_patch, 3);
  assert_string_equal(m.patch[0].name, "left");
  assert_string_equal(m.patch[1].name, "part");
  assert_int_equal(m.patch[1].bc, 5);
  assert_string_equal(m.patch[2].name, "wing");
  for (size_t i = 0; i < 20; i++)
    assert_int_equal(m.tri_patch[i], i < 12 ? 0 : i / 2 % 2 ? 2 : 1);
  vg_mesh_release(&m);
}

/* In a base of cells a zone with a single layer of points, along any index, is
 * a surface. */
static void a_layer_of_points_is_a_surface(void **state)
{
  static const int32_t whole[6] = { 1, 1, 1, 1, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct tree t;

  (void)state;
  for (int k = 0; k < 3; k++) {
    struct lattice l = { { 3, 3, 3 }, 0, 0, 0 };
    int32_t range[6];

    l.n[k] = 1;
    for (int i = 0; i < 6; i++) range[i] = i < 3 || i - 3 == k ? 1 : 2;
    start(&t, 3);
    block(&t, "skin", 3, &l);
    condition(&t, conditions(&t), "corner", "BCWall", NULL, "PointRange", 6,
              range);
    accept(&t, &m);
    assert_int_equal(m.n_point, 9);
    assert_int_equal(m.n_tri, 8);
    assert_int_equal(m.n_patch, 2);
    assert_string_equal(m.patch[m.tri_patch[0]].name, "corner");
    assert_string_equal(m.patch[m.tri_patch[2]].name, "skin");
    vg_mesh_release(&m);
  }
  /* the range counts cells of the face: the first one */
  start(&t, 3);
  block(&t, "skin", 3, &(const struct lattice){ { 3, 3, 1 }, 0, 0, 0 });
  condition(&t, conditions(&t), "corner", "BCWall", "KFaceCenter", "PointRange",
            6, whole);
  accept(&t, &m);
  assert_int_equal(m.tri_patch[1], 0);
  assert_int_equal(m.tri_patch[2], 1);
  vg_mesh_release(&m);
}

/* Quadrilaterals are cut along the shorter diagonal; those with equal corners
 * give one triangle, or none. */
static void collapsed_faces_are_dropped(void **state)
{
  static const double x[3][6] = { { 0, 0, 1, 2, 3, 3 },
                                  { 0, 0, 0.25, 0, 0, 0 },
                                  { 0, 0, 0, 0, 0, 0 } };
  static const double y[6] = { 0, 0, 1, 1, 0.5, 0.5 };
  static const char *const axis[3] = { "CoordinateX", "CoordinateY",
                                       "CoordinateZ" };
  static const int32_t size[6] = { 3, 2, 2, 1, 0, 0 };
  double all_x[3][6];
  struct vg_mesh m = VG_MESH_INIT;
  struct tree t;
  int64_t grid;

  (void)state;
  /* lower row: 0 0 1, upper row: 2 3 3; so cells 0 0 3 2 and 0 1 3 3 */
  memcpy(all_x, x, sizeof x);
  for (int i = 3; i < 6; i++) all_x[1][i] = y[i];
  start(&t, 2);
  t.zone = add(&t, t.base, "polar", "Zone_t", "I4", 2, 2, 6, size);
  add_text(&t, t.zone, "ZoneType", "ZoneType_t", "Structured");
  grid = add(&t, t.zone, "Grid", "GridCoordinates_t", "MT", 0, 1, 0, NULL);
  for (int k = 0; k < 3; k++)
    add(&t, grid, axis[k], "DataArray_t", "R8", 1, 1, 6, all_x[k]);
  accept(&t, &m);
  assert_int_equal(m.n_point, 4);
  assert_int_equal(m.n_tri, 2);
  vg_mesh_release(&m);
}

/* A block with cells gives the faces of its conditions. Their normals point
 * into the block for any direction of its indices; points that no face uses are
 * left out. */
static void conditions_of_a_block_make_its_boundary(void **state)
{
  static const int32_t range[6][6] = {
    { 1, 1, 1, 1, 4, 5 }, { 3, 1, 1, 3, 4, 5 }, { 1, 1, 1, 3, 1, 5 },
    { 1, 4, 1, 3, 4, 5 }, { 1, 1, 1, 3, 4, 1 }, { 1, 1, 5, 3, 4, 5 }
  };
  static const int32_t edge[6] = { 1, 1, 1, 3, 1, 1 };
  static const int32_t face[6] = { 1, 1, 5, 2, 3, 5 };
  char name[8];

  (void)state;
  for (int turn = 0; turn < 12; turn++) {
    const struct lattice l = { { 3, 4, 5 }, turn / 2 % 3, turn % 2, 0.5 };
    struct vg_mesh m = VG_MESH_INIT;
    struct tree t;
    int64_t bc;

    start(&t, 3);
    block(&t, "blk-1", 3, &l);
    bc = conditions(&t);
    condition(&t, bc, "line", "BCWall", NULL, "PointRange", 6, edge);
    for (int k = 0; k < 6; k++) {
      snprintf(name, sizeof name, "bc-%d", k);
      if (k == 5 && turn > 5)
        condition(&t, bc, name, "BCFarfield",
                  turn % 2 ? "FaceCenter" : "KFaceCenter", "PointRange", 6,
                  face);
      else
        condition(&t, bc, name, k ? "BCFarfield" : "BCWallViscous",
                  k % 2 ? "Vertex" : NULL, "PointRange", 6, range[k]);
    }
    accept(&t, &m);
    assert_int_equal(m.n_patch, 6);
    assert_int_equal(m.patch[0].bc, 4);
    assert_int_equal(m.n_tet + m.n_hex, 0);
    /* all but the 1 x 2 x 3 interior points */
    assert_int_equal(m.n_point, 60 - 6);
    assert_int_equal(m.n_tri, 4 * (2 * 3 + 3 * 4 + 4 * 2));
    /* a cube of volume 1 seen from inside; its coordinates are rounded */
    assert_true(volume6(&m) < -6 + 1e-12 && volume6(&m) > -6 - 1e-12);
    vg_mesh_release(&m);
  }
}

/* A surface next to cells is not read twice; bases of one kind are joined. */
static void bases_are_joined(void **state)
{
  const struct lattice l = { { 3, 3, 1 }, 0, 0, 0 };
  const struct lattice r = { { 3, 3, 1 }, 0, 0, 1 };
  static const int32_t cells[2] = { 3, 3 }, faces[2] = { 2, 3 };
  static const int part[3] = { 0, 1, 2 };
  static const int32_t tri[3] = { 1, 2, 3 };
  struct vg_mesh m = VG_MESH_INIT;
  struct tree t;

  (void)state;
  start(&t, 2);
  block(&t, "one", 2, &l);
  t.base = add(&t, t.root, "next", "CGNSBase_t", "I4", 1, 1, 2, faces);
  block(&t, "two", 2, &r);
  zone(&t, "three", 3, part);
  section(&t, "Tri", 5, 1, 1, 3, tri);
  accept(&t, &m);
  /* corners of `three` are points of `one` */
  assert_int_equal(m.n_point, 15);
  assert_int_equal(m.n_tri, 17);
  assert_int_equal(m.n_patch, 3);
  vg_mesh_release(&m);
  start(&t, 2);
  block(&t, "copy", 2, &l);
  t.base = add(&t, t.root, "cells", "CGNSBase_t", "I4", 1, 1, 2, cells);
  zone(&t, "Zone 1", 4, all);
  section(&t, "everything", 20, 1, 5, sizeof t1_mixed / 4, t1_mixed);
  accept(&t, &m);
  assert_int_equal(m.n_tri, 4);
  vg_mesh_release(&m);
}

static void one_block(struct tree *t, const char *at, const char *list,
                      size_t n, const int32_t *v)
{
  start(t, 3);
  block(t, "blk-1", 3, &(const struct lattice){ { 3, 3, 3 }, 0, 0, 0 });
  condition(t, conditions(t), "bc-1", "BCWall", at, list, n, v);
}

static void refuses_blocks(void **state)
{
  static const int32_t size[9] = { 2, 2, 0, 1, 1, 1 };
  static const int32_t huge[9] = { 65536, 65536, 65536, 1, 1, 1 };
  static const int32_t out[6] = { 1, 1, 1, 1, 3, 4 };
  static const int32_t zero[6] = { 1, 0, 1, 1, 3, 3 };
  static const int32_t within[6] = { 2, 1, 1, 2, 3, 3 };
  static const int32_t faces[6] = { 1, 1, 1, 1, 3, 2 };
  static const int32_t corner[6] = { 1, 1, 1, 1, 1, 2 };
  const struct lattice l = { { 3, 3, 3 }, 0, 0, 0 };
  struct tree t;

  (void)state;
  start(&t, 3);
  block(&t, "inner", 3, &l);
  refuse(&t, VG_ERR_INPUT, "no BC_t says which faces");
  start(&t, 3);
  block(&t, "flat", 2, &(const struct lattice){ { 3, 3, 1 }, 0, 0, 0 });
  refuse(&t, VG_ERR_FORMAT, "its sizes");
  for (int k = 0; k < 2; k++) {
    start(&t, 3);
    add_text(&t,
             add(&t, t.base, "none", "Zone_t", "I4", 2, 3, 9, k ? huge : size),
             "ZoneType", "ZoneType_t", "Structured");
    refuse(&t, VG_ERR_FORMAT, "not positive, or beyond");
  }
  start(&t, 3);
  add_text(&t,
           add(&t, t.base, "bare", "Zone_t", "I4", 2, 3, 9,
               (const int32_t[9]){ 2, 2, 2, 1, 1, 1 }),
           "ZoneType", "ZoneType_t", "Structured");
  refuse(&t, VG_ERR_FORMAT, "CoordinateX has 0 values for 8 points");
  one_block(&t, NULL, "PointRange", 6, out);
  refuse(&t, VG_ERR_FORMAT, "exceeds the zone");
  one_block(&t, NULL, "PointRange", 6, zero);
  refuse(&t, VG_ERR_FORMAT, "exceeds the zone");
  one_block(&t, "IFaceCenter", "PointRange", 6, faces);
  refuse(&t, VG_ERR_FORMAT, "exceeds the zone");
  one_block(&t, "FaceCenter", "PointRange", 6, corner);
  refuse(&t, VG_ERR_UNSUPPORTED, "write IFaceCenter");
  one_block(&t, NULL, "PointRange", 6, within);
  refuse(&t, VG_ERR_UNSUPPORTED, "inside the block");
  one_block(&t, NULL, "PointRange", 4, out);
  refuse(&t, VG_ERR_UNSUPPORTED, "PointRange of points or faces");
  one_block(&t, NULL, "PointList", 6, out);
  refuse(&t, VG_ERR_UNSUPPORTED, "PointRange of points or faces");
  one_block(&t, "CellCenter", "PointRange", 6, out);
  refuse(&t, VG_ERR_UNSUPPORTED, "PointRange of points or faces");
}

#ifdef VG_HAS_HDF5
/* Data of four integers in another file: a link, external storage, a virtual
 * data set. The other file has a harmless name and need not exist. */
static void put_elsewhere(hid_t node, int how)
{
  const hsize_t n = 4;
  hid_t space = H5Screate_simple(1, &n, NULL);
  hid_t plist = H5Pcreate(H5P_DATASET_CREATE);

  if (how == 0)
    assert_true(H5Lcreate_external("elsewhere.h5", "/data", node, " data",
                                   H5P_DEFAULT, H5P_DEFAULT) >= 0);
  if (how == 1)
    assert_true(H5Pset_external(plist, "elsewhere.bin", 0, 16) >= 0);
  if (how == 2) {
    hid_t file = H5Iget_file_id(node);

    H5Fset_libver_bounds(file, H5F_LIBVER_EARLIEST, H5F_LIBVER_LATEST);
    H5Fclose(file);
    assert_true(H5Pset_virtual(plist, space, "elsewhere.h5", "/data", space) >=
                0);
  }
  if (how)
    H5Dclose(H5Dcreate2(node, " data", H5T_STD_I32LE, space, H5P_DEFAULT, plist,
                        H5P_DEFAULT));
  H5Pclose(plist);
  H5Sclose(space);
}

static void data_in_other_files_are_refused(void **state)
{
  (void)state;
  for (int how = 0; how < 3; how++) {
    static const int32_t kind[2] = { 10, 0 };
    static const int64_t range[2] = { 1, 1 };
    int64_t id;
    struct tree t;

    start(&t, 3);
    zone(&t, "Zone 1", 4, all);
    id = add(&t, t.zone, "cells", "Elements_t", "I4", 1, 1, 2, kind);
    add(&t, id, "ElementRange", "IndexRange_t", "I8", 1, 1, 2, range);
    id = add(&t, id, "ElementConnectivity", "DataArray_t", "I4", 0, 1, 0, NULL);
    put_elsewhere(id, how);
    refuse(&t, VG_ERR_UNSUPPORTED, "the data are in another file");
  }
}
#endif

static void refuses_files_that_are_not_cgns(void **state)
{
  (void)state;
  io_refuse(vg_cgns_parse, "solid x", VG_ERR_FORMAT, "neither HDF5 nor ADF");
  io_refuse(vg_cgns_parse, "@(#)ADF Database Version B02012>",
            VG_ERR_UNSUPPORTED, "convert it with `adf2hdf FILE NEW.cgns`");
  io_refuse(vg_cgns_parse, "\x89HDF\r\n\x1a\n", VG_ERR_FORMAT,
            "cannot open it");
}

/* A file truncated anywhere, or with modified bytes, is refused with a message
 * or read as a consistent mesh, whatever the HDF5 library makes of it. */
static void damage_is_always_reported(void **state)
{
  const char *path = io_temp("damaged.cgns");
  uint32_t random = 1;
  struct vg_mesh m;
  unsigned char *data;
  size_t size;

  (void)state;
  io_make_t1(&m, 1);
  assert_int_equal(vg_cgns_write(path, &m, NULL), VG_OK);
  vg_mesh_release(&m);
  data = io_slurp(path, &size);
  unlink(path);
  for (int turn = 0; turn < 120; turn++) {
    struct vg_error err = VG_ERROR_INIT;
    unsigned char old[4];
    size_t at[4], n = size;
    vg_status st;

    for (int k = 0; k < 4; k++) {
      random = random * 1664525u + 1013904223u;
      at[k] = (random >> 8) % size;
      old[k] = data[at[k]];
      if (turn % 8 && k <= turn % 4) data[at[k]] ^= (unsigned char)random | 1;
    }
    if (turn % 8 == 0) n = at[0];
    st = n ? io_parse_bytes(vg_cgns_parse, data, n, &m, &err) : VG_ERR_FORMAT;
    if (n && st != VG_OK) assert_non_null(strstr(err.text, "case"));
    for (size_t k = 0; st == VG_OK && k < 3 * m.n_tri; k++)
      assert_true(m.tri[k / 3][k % 3] < m.n_point);
    vg_mesh_release(&m);
    for (int k = 3; k >= 0; k--) data[at[k]] = old[k];
  }
  free(data);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(all_kinds_come_back),
    cmocka_unit_test(numbers_come_back),
    cmocka_unit_test(every_condition_comes_back),
    cmocka_unit_test(bytes_follow_from_the_mesh),
    cmocka_unit_test(write_errors_are_reported),
    cmocka_unit_test(boundary_conditions_define_patches),
    cmocka_unit_test(zones_are_joined),
    cmocka_unit_test(refuses_sections),
    cmocka_unit_test(solutions_at_points),
    cmocka_unit_test(refuses_trees),
    cmocka_unit_test(surface_blocks_are_joined),
    cmocka_unit_test(a_layer_of_points_is_a_surface),
    cmocka_unit_test(collapsed_faces_are_dropped),
    cmocka_unit_test(conditions_of_a_block_make_its_boundary),
    cmocka_unit_test(bases_are_joined),
    cmocka_unit_test(refuses_blocks),
#ifdef VG_HAS_HDF5
    cmocka_unit_test(data_in_other_files_are_refused),
#endif
    cmocka_unit_test(refuses_files_that_are_not_cgns),
    cmocka_unit_test(damage_is_always_reported),
  };

  if (!vg_cgns_is_built()) {
    puts("built without HDF5: skipped");
    return 77;
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}
