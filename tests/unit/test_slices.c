/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Meshes in slices: the files equal those of the writers of whole meshes, byte
 * for byte. */
#define _GNU_SOURCE
#include "mixed_cut.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "core/judge/quality.h"
#include "io/cgns/cgns.h"
#include "io/mesh/fluent.h"
#include "io/mesh/gmsh.h"
#include "io/mesh/su2.h"
#include "io/slices/slices.h"
#include "io/slices/slices_parts.h"
#include "io/vgrid/mapbc.h"

#define N_SLICE 23

/* Meshes of the tests: tetrahedra, mixed, with hexahedra. */
enum { N_MESH = 3 };
static struct vg_mesh mesh[N_MESH];
static struct vg_join_info info[N_MESH];

static int make_meshes(void **state)
{
  (void)state;
  cut_mesh(&mesh[0], &info[0], VG_LAYER_TETS);
  cut_mesh(&mesh[1], &info[1], VG_LAYER_MIXED);
  mixed_cut_mesh(&mesh[2], &info[2]);
  return 0;
}

static int release_meshes(void **state)
{
  (void)state;
  for (int k = 0; k < N_MESH; k++) vg_mesh_release(&mesh[k]);
  return 0;
}

/* File names of the writers of whole meshes, and of those of slices. */
static const char *whole_file(void)
{
  static char path[4096];

  snprintf(path, sizeof path, "%s/slices_whole", VG_TMP_DIR);
  return path;
}

static const char *cut_file(const char *suffix)
{
  char name[128];

  snprintf(name, sizeof name, "slices_cut.%s", suffix);
  return io_temp(name);
}

/* The name gives the kind. */
static const char *ugrid_file(const char *kind)
{
  static char path[4200];

  snprintf(path, sizeof path, "%s.%s", whole_file(), kind);
  return path;
}

static void same_file(const char *a, const char *b)
{
  size_t n, m;
  unsigned char *x = io_slurp(a, &n), *y = io_slurp(b, &m);

  if (n != m || memcmp(x, y, n)) {
    size_t i = 0;

    while (i < n && i < m && x[i] == y[i]) i++;
    fail_msg("%s (%zu bytes) and %s (%zu) differ at byte %zu", a, n, b, m, i);
  }
  free(x);
  free(y);
}

static int exists(const char *path)
{
  return !access(path, F_OK);
}

/* Neither the file nor its temporary name exists. */
static void assert_absent(const char *path)
{
  char part[4300];

  snprintf(part, sizeof part, "%s.part", path);
  if (exists(path)) fail_msg("%s is there", path);
  if (exists(part)) fail_msg("%s is there", part);
}

static void write_slices(struct cut *c, const char *form,
                         const struct vg_slices_options *o)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_slices_write_with(NULL, &c->s, io_temp("slices_cut"), form, o, &err) !=
      VG_OK)
    fail_msg("%s: %s", form, err.text);
}

static void collect_is_the_mesh(void **state)
{
  (void)state;
  for (int k = 0; k < N_MESH; k++)
    for (int threads = 1; threads < 4; threads++) {
      struct vg_mesh back = VG_MESH_INIT;
      struct vg_error err = VG_ERROR_INIT;
      struct cut c;

      cut_make(&c, &mesh[k], N_SLICE, 0, &info[k], 1);
      assert_int_equal(vg_slices_collect(&c.s, threads, &back, &err), VG_OK);
      io_same(&mesh[k], &back, 1);
      c.bad = 5;
      assert_int_equal(vg_slices_collect(&c.s, threads, &back, &err),
                       VG_ERR_IO);
      assert_string_equal(err.text, "slice 5 is bad");
      io_same(&mesh[k], &back, 1);
      vg_mesh_release(&back);
      cut_release(&c);
    }
}

static void every_kind_of_ugrid(void **state)
{
  static const char *const form[] = {
    "b8.ugrid",  "lb8.ugrid",  "b4.ugrid",   "lb4.ugrid",
    "r8.ugrid",  "lr8.ugrid",  "r4.ugrid",   "lr4.ugrid",
    "b8l.ugrid", "lb8l.ugrid", "b8.ugrid64", "lb8.ugrid64"
  };

  (void)state;
  for (size_t i = 0; i < N_MESH * sizeof form / sizeof *form; i++) {
    struct vg_slices_options o = { .threads = (int)(i / N_MESH % 3) + 1 };
    const char *f = form[i / N_MESH], *whole = ugrid_file(f);
    int k = i % N_MESH;
    struct cut c;

    cut_make(&c, &mesh[k], N_SLICE, 0, &info[k], i);
    assert_true(vg_slices_can_write(f));
    assert_int_equal(vg_ugrid_write(whole, &mesh[k], NULL), VG_OK);
    write_slices(&c, f, &o);
    same_file(whole, cut_file(f));
    o.tail = 1;
    assert_int_equal(vg_ugrid_write_tail(whole, &mesh[k], info[k].n_layer_tet,
                                         NULL),
                     VG_OK);
    write_slices(&c, f, &o);
    same_file(whole, cut_file(f));
    unlink(whole);
    unlink(cut_file(f));
    cut_release(&c);
  }
}

static void others_are_those_of_the_whole_mesh(void **state)
{
  static const struct {
    const char *form;
    vg_status (*write)(const char *path, const struct vg_mesh *m,
                       struct vg_error *err);
  } other[] = { { "su2", vg_su2_write },
                { "msh", vg_gmsh_write },
                { "fluent.msh", vg_fluent_write },
                { "cgns", vg_cgns_write } };
  const char *whole = whole_file();

  (void)state;
  for (size_t i = 0; i < N_MESH * sizeof other / sizeof *other; i++) {
    const struct vg_slices_options o = { .threads = 1 + i % 2 };
    const size_t at = i / N_MESH, k = i % N_MESH;
    const char *form = other[at].form;
    size_t n_quad;
    struct cut c;

    if (other[at].write == vg_cgns_write && !vg_cgns_is_built()) continue;
    n_quad = k == 1 ? cut_close(&mesh[k], form) : mesh[k].n_quad;
    assert_int_equal(other[at].write(whole, &mesh[k], NULL), VG_OK);
    cut_make(&c, &mesh[k], N_SLICE, 0, &info[k], 5);
    write_slices(&c, form, &o);
    same_file(whole, cut_file(form));
    unlink(whole);
    unlink(cut_file(form));
    cut_release(&c);
    mesh[k].n_quad = n_quad;
  }
}

/* The message expected for a kind of 4-byte reals, by the mesh check of the
 * rounded mesh. */
static void rounded_message(const struct vg_mesh *m, char *text, size_t size)
{
  struct vg_mesh_report r;
  struct vg_mesh copy = VG_MESH_INIT;

  memset(&r, 0, sizeof r);
  assert_int_equal(vg_mesh_copy(&copy, m, NULL), VG_OK);
  for (size_t i = 0; i < 3 * m->n_point; i++)
    copy.point[i / 3][i % 3] = (double)(float)m->point[i / 3][i % 3];
  assert_int_equal(vg_mesh_judge(&copy, NULL, &r, NULL), VG_OK);
  assert_true(r.not_positive > 1);
  snprintf(text, size, "would have %zu flat or inverted cells, the first",
           r.not_positive);
  vg_mesh_release(&copy);
}

/* A valid mesh so far from the origin that its cells are flat in 4-byte reals:
 * reported with their number, equally by both writers, and no file is left.
 * With 8 bytes it is written as usual. */
static void rounding_that_spoils_cells_is_refused(void **state)
{
  static const char *const form[] = { "b4.ugrid", "lb4.ugrid", "r4.ugrid",
                                      "lr4.ugrid" };

  (void)state;
  for (size_t i = 0; i < 8; i++) {
    struct vg_slices_options o = { .threads = (int)(i % 3) + 1 };
    const char *f = form[i / 2];
    struct vg_error err = VG_ERROR_INIT, whole = VG_ERROR_INIT;
    struct vg_mesh far = VG_MESH_INIT;
    char want[200], instead[24];
    struct cut c;

    assert_int_equal(vg_mesh_copy(&far, &mesh[i % 2], NULL), VG_OK);
    for (size_t k = 0; k < far.n_point; k++) far.point[k][i % 3] += 1e6;
    rounded_message(&far, want, sizeof want);
    cut_make(&c, &far, N_SLICE, 0, &info[i % 2], i);
    assert_int_equal(vg_slices_write_with(NULL, &c.s, io_temp("slices_cut"), f,
                                          &o, &err),
                     VG_ERR_GEOMETRY);
    assert_non_null(strstr(err.text, want));
    snprintf(instead, sizeof instead, "as in .%.*s8.", (int)strlen(f) - 7, f);
    assert_non_null(strstr(err.text, instead));
    assert_absent(cut_file(f));
    assert_int_equal(vg_ugrid_write(ugrid_file(f), &far, &whole),
                     VG_ERR_GEOMETRY);
    assert_memory_equal(whole.text, err.text,
                        (size_t)(strstr(err.text, ")") - err.text));
    assert_absent(ugrid_file(f));
    assert_int_equal(vg_slices_write_with(NULL, &c.s, io_temp("slices_cut"),
                                          "lb8.ugrid", &o, &err),
                     VG_OK);
    unlink(cut_file("lb8.ugrid"));
    cut_release(&c);
    vg_mesh_release(&far);
  }
}

/* Both sides of a thin body: cells stay positive, but points coincide. Points
 * that already coincided before are no fault of the file. */
static void rounding_that_joins_points_is_refused(void **state)
{
  static const uint32_t face[4][3] = {
    { 0, 1, 2 }, { 0, 3, 1 }, { 1, 3, 2 }, { 0, 2, 3 }
  };

  (void)state;
  for (int thin = 0; thin < 2; thin++) {
    double x[8][3] = { { 0, 0, 1 }, { 1, 0, 1 }, { 0, 1, 1 }, { 0, 0, 2 },
                       { 0, 0, 1 }, { 0, 1, 1 }, { 1, 0, 1 }, { 0, 0, 0 } };
    uint32_t tet[2][4] = { { 0, 1, 2, 3 }, { 4, 5, 6, 7 } }, tri[8][3];
    uint32_t of[8] = { 0 };
    struct vg_patch patch = { .id = 1 };
    struct vg_mesh m = { .n_point = 8,
                         .point = x,
                         .n_tet = 2,
                         .tet = tet,
                         .n_tri = 8,
                         .tri = tri,
                         .tri_patch = of,
                         .n_patch = 1,
                         .patch = &patch };
    const struct vg_slices_options o = { .threads = 1 };
    struct vg_join_info none = { 0 };
    struct vg_error err = VG_ERROR_INIT;
    struct cut c;

    for (uint32_t i = 0; i < 24; i++)
      tri[i / 3][i % 3] = face[i / 3 % 4][i % 3] + (i < 12 ? 0 : 4);
    for (int i = 4; thin && i < 7; i++) x[i][2] -= 1e-9;
    cut_make(&c, &m, 2, 0, &none, 1);
    c.s.n_boundary_point = 8;
    assert_int_equal(vg_slices_write_with(NULL, &c.s, io_temp("slices_cut"),
                                          "lb4.ugrid", &o, &err),
                     thin ? VG_ERR_GEOMETRY : VG_OK);
    assert_true(exists(cut_file("lb4.ugrid")) == !thin);
    if (thin)
      assert_non_null(strstr(err.text, "would have 3 coincident points, "
                                       "the first 5 (0, 0, 0.999999999)"));
    assert_int_equal(vg_ugrid_write(cut_file("lb4.ugrid"), &m, &err),
                     thin ? VG_ERR_GEOMETRY : VG_OK);
    unlink(cut_file("lb4.ugrid"));
    cut_release(&c);
  }
}

/* Lengths that make slices end before, on and after markers. */
static void records_in_parts(void **state)
{
  static const uint32_t limit[] = { 64, 100, 1000, 1001, 4096, 100000 };
  static const char *const form[] = { "r8.ugrid", "lr4.ugrid" };

  (void)state;
  for (size_t i = 0; i < N_MESH * sizeof limit / sizeof *limit; i++) {
    const struct vg_slices_options o = { 2, 1, limit[i / N_MESH], 0, 0, NULL };
    const char *f = form[i % 2], *path = ugrid_file(f);
    const size_t k = i % N_MESH;
    struct vg_output out = VG_OUTPUT_INIT;
    struct vg_ugrid_kind kind;
    struct cut c;

    assert_true(vg_ugrid_kind(path, &kind));
    out.record_limit = o.record_limit;
    assert_int_equal(vg_output_open(path, &out, NULL), VG_OK);
    vg_ugrid_put(&out, &kind, &mesh[k], &info[k].n_layer_tet);
    assert_int_equal(vg_output_commit(&out, NULL), VG_OK);
    cut_make(&c, &mesh[k], N_SLICE, 0, &info[k], i);
    write_slices(&c, f, &o);
    same_file(path, cut_file(f));
    unlink(path);
    unlink(cut_file(f));
    cut_release(&c);
  }
}

/* Skipping and seeking in a record of 7 GB must lead to the same position;
 * nothing is written. */
static void places_beyond_two_gigabytes(void **state)
{
  const uint64_t bytes = 7000000000u;

  (void)state;
  for (uint64_t part = 0; part < 4; part++)
    for (int off = part ? -3 : 0; off < 4; off++) {
      uint64_t offset = part * VG_RECORD_LIMIT + (uint64_t)off;
      struct vg_output a = VG_OUTPUT_INIT, b = VG_OUTPUT_INIT;

      assert_int_equal(vg_output_shared(NULL, &a, NULL), VG_OK);
      assert_int_equal(vg_output_shared(NULL, &b, NULL), VG_OK);
      vg_output_record(&a, bytes);
      vg_output_skip(&a, offset);
      vg_output_bytes(&a, "", 1);
      vg_output_seek_record(&b, 0, bytes, offset);
      vg_output_bytes(&b, "", 1);
      assert_true(a.at + a.n == b.at + b.n);
      assert_true(b.at + b.n == 5 + offset + 8 * (offset / VG_RECORD_LIMIT));
      vg_output_skip(&a, bytes - offset - 1);
      vg_output_skip(&b, bytes - offset - 1);
      vg_output_record_end(&a);
      vg_output_record_end(&b);
      assert_int_equal(vg_output_flush(&a, NULL), VG_OK);
      assert_int_equal(vg_output_flush(&b, NULL), VG_OK);
      assert_true(a.at == b.at && a.written == a.at);
      assert_true(a.at == vg_record_size(bytes, VG_RECORD_LIMIT));
      vg_output_release(&a);
      vg_output_release(&b);
    }
}

/* The .mapbc has the stem in its title: two folders, one name. */
static void cogsg_case(const struct vg_mesh *m, const struct vg_join_info *in,
                       uint32_t limit, uint64_t seed)
{
  static const char *const part[] = { "cogsg", "bc", "mapbc" };
  const struct vg_slices_options o = { 2, 0, limit, 0, 0, NULL };
  struct vg_cogsg_info head = VG_COGSG_INFO_INIT;
  char whole[4096], sliced[4096];
  struct vg_error err = VG_ERROR_INIT;
  struct cut c;

  head.n_layer_point = in->n_layer_point;
  head.n_layer_cell = in->n_layer_tet;
  snprintf(whole, sizeof whole, "%s/mesh", io_temp("slices_a"));
  snprintf(sliced, sizeof sliced, "%s/mesh", io_temp("slices_b"));
  mkdir(io_temp("slices_a"), 0777);
  mkdir(io_temp("slices_b"), 0777);
  cut_make(&c, m, N_SLICE, 0, in, seed);
  assert_int_equal(vg_cogsg_write(whole, m, &head, limit, NULL, NULL), VG_OK);
  if (vg_slices_write_with(NULL, &c.s, sliced, "cogsg", &o, &err) != VG_OK)
    fail_msg("%s", err.text);
  for (int i = 0; i < 3; i++) {
    char a[4200], b[4200];

    snprintf(a, sizeof a, "%s.%s", whole, part[i]);
    snprintf(b, sizeof b, "%s.%s", sliced, part[i]);
    same_file(a, b);
    unlink(a);
    unlink(b);
  }
  rmdir(io_temp("slices_a"));
  rmdir(io_temp("slices_b"));
  cut_release(&c);
}

static void cogsg_and_what_belongs_to_it(void **state)
{
  static const uint32_t limit[] = { 0, 64, 100, 1000, 1004, 65536 };
  uint32_t *new_to_old, *old_to_new;
  size_t n_curve, n_boundary;

  (void)state;
  /* VGRID's order differs from the mesh's here ... */
  assert_int_equal(vg_vgrid_order(&mesh[0], &new_to_old, &old_to_new, &n_curve,
                                  &n_boundary, NULL),
                   VG_OK);
  assert_non_null(new_to_old);
  free(new_to_old);
  free(old_to_new);
  for (size_t i = 0; i < sizeof limit / sizeof *limit; i++)
    cogsg_case(&mesh[0], &info[0], limit[i], i);
  /* ... and equals it if there is one patch. */
  memset(mesh[0].tri_patch, 0, mesh[0].n_tri * sizeof *mesh[0].tri_patch);
  assert_int_equal(vg_vgrid_order(&mesh[0], &new_to_old, &old_to_new, &n_curve,
                                  &n_boundary, NULL),
                   VG_OK);
  assert_null(new_to_old);
  cogsg_case(&mesh[0], &info[0], 0, 9);
}

static void one_vtu(void **state)
{
  (void)state;
  for (int k = 0; k < N_MESH; k++) {
    const struct vg_slices_options o = { .threads = 2 };
    const char *whole = whole_file();
    float *angle = vg_alloc(mesh[k].n_tet, sizeof *angle);
    float *ratio = vg_alloc(mesh[k].n_tet, sizeof *ratio);
    const struct vg_vtu_field field[] = {
      { "angle_min", VG_VTU_CELL, VG_VTU_FLOAT32, 1, angle },
      { "radius_ratio", VG_VTU_CELL, VG_VTU_FLOAT32, 1, ratio },
    };
    struct cut c;

    vg_mesh_cell_quality(&mesh[k], angle, ratio);
    assert_int_equal(vg_vtu_write(whole, &mesh[k], field, k ? 0 : 2, NULL),
                     VG_OK);
    cut_make(&c, &mesh[k], N_SLICE, 0, &info[k], 3);
    write_slices(&c, "vtu", &o);
    same_file(whole, cut_file("vtu"));
    unlink(whole);
    unlink(cut_file("vtu"));
    cut_release(&c);
    free(angle);
    free(ratio);
  }
}

static void boundary_files_equal_those_of_the_whole_mesh(void **state)
{
  const struct vg_slices_options o = { .threads = 2 };
  const char *whole = whole_file();
  struct cut c;

  (void)state;
  cut_make(&c, &mesh[1], N_SLICE, 0, &info[1], 4);
  write_slices(&c, "surface.vtu", &o);
  write_slices(&c, "fun3d.mapbc", &o);
  write_slices(&c, "mapbc", &o);
  assert_int_equal(vg_vtu_write_boundary(whole, &mesh[1], NULL, 0, NULL),
                   VG_OK);
  same_file(whole, cut_file("surface.vtu"));
  assert_int_equal(vg_mapbc_write(whole, &mesh[1], VG_MAPBC_FUN3D, NULL, NULL,
                                  NULL),
                   VG_OK);
  same_file(whole, cut_file("fun3d.mapbc"));
  assert_int_equal(vg_mapbc_write_output(whole, &mesh[1], "slices_cut", NULL,
                                         NULL),
                   VG_OK);
  same_file(whole, cut_file("mapbc"));
  unlink(whole);
  unlink(cut_file("surface.vtu"));
  unlink(cut_file("fun3d.mapbc"));
  unlink(cut_file("mapbc"));
  cut_release(&c);
}

/* Data of the n-th array of a .vtu, aligned; to be freed. */
static void *array_of(const unsigned char *data, size_t size, int n,
                      uint64_t *bytes)
{
  const char *at = (const char *)data;
  const unsigned char *base = memmem(data, size, "<AppendedData", 13);
  void *copy;

  assert_non_null(base);
  base = (unsigned char *)strchr((const char *)base, '_') + 1;
  for (int i = 0; i <= n; i++) at = strstr(at, " offset=\"") + 9;
  base += strtoull(at, NULL, 10);
  memcpy(bytes, base, sizeof *bytes);
  copy = vg_alloc(*bytes, 1);
  assert_true(*bytes <= size);
  memcpy(copy, base + sizeof *bytes, *bytes);
  return copy;
}

/* VTK's slots of our nodes. */
static const int to_vtk[4][8] = { { 0, 1, 2, 3 },
                                  { 1, 0, 3, 4, 2 },
                                  { 1, 0, 2, 4, 3, 5 },
                                  { 0, 1, 2, 3, 4, 5, 6, 7 } };

/* The cells of slices g and on, as far as they are in this piece, must have the
 * coordinates of those of the mesh. Returns the next slice. */
static size_t check_piece(const struct cut *c, const char *path, size_t g)
{
  static const int width[4] = { 4, 5, 6, 8 }, type[4] = { 10, 14, 13, 12 };
  size_t size, n = 0;
  uint64_t b;
  unsigned char *data = io_slurp(path, &size);
  double(*x)[3] = array_of(data, size, 0, &b);
  int64_t *first = array_of(data, size, 1, &b), *node = first;
  int64_t *end = array_of(data, size, 2, &b);
  unsigned char *types = array_of(data, size, 3, &b);
  int32_t *domain = array_of(data, size, 4, &b);
  int32_t *kinds = array_of(data, size, 5, &b);
  size_t n_cell = b / 4;

  for (; g < c->n && n < n_cell; g++)
    for (int k = 0; k < 4; k++)
      for (size_t i = g ? c->end[g - 1][k + 1] : 0; i < c->end[g][k + 1];
           i++, n++) {
        const uint32_t *cell = cut_cells(c->mesh, k) + i * (size_t)width[k];

        assert_true(n < n_cell);
        for (int j = 0; j < width[k]; j++)
          assert_memory_equal(x[node[j]], c->mesh->point[cell[to_vtk[k][j]]],
                              sizeof *x);
        node += width[k];
        assert_true(end[n] == node - first);
        assert_int_equal(types[n], type[k]);
        assert_int_equal(domain[n], g * 7 % 13);
        assert_int_equal(kinds[n], g % 4);
      }
  assert_int_equal(n, n_cell);
  free(x);
  free(first);
  free(end);
  free(types);
  free(domain);
  free(kinds);
  free(data);
  return g;
}

static void pieces_are_the_mesh(void **state)
{
  (void)state;
  for (int k = 0; k < N_MESH; k++) {
    const struct vg_slices_options o = { .threads = 2, .piece_cells = 400 };
    char *path, *text;
    size_t g = 0, n = 0, size;
    struct cut c;

    cut_make(&c, &mesh[k], N_SLICE, 0, &info[k], 5);
    write_slices(&c, "pvtu", &o);
    text = (char *)io_slurp(cut_file("pvtu"), &size);
    for (const char *at = text; (at = strstr(at, "<Piece ")); at++) {
      char name[64];

      snprintf(name, sizeof name, "Source=\"slices_cut_%zu.vtu\"", n);
      assert_non_null(strstr(at, name));
      path = vg_slices_piece(io_temp("slices_cut"), n++);
      g = check_piece(&c, path, g);
      unlink(path);
      free(path);
    }
    assert_true(n > 2);
    while (g < c.n) /* empty ones at the end */
      for (int i = 1; i < 5 && g < c.n; i++) {
        assert_int_equal(c.end[g][i], c.end[c.n - 1][i]);
        if (i == 4) g++;
      }
    free(text);
    unlink(cut_file("pvtu"));
    cut_release(&c);
  }
}

static const char *const all_forms[] = { "b8.ugrid", "r8.ugrid",   "cogsg",
                                         "vtu",      "pvtu",       "su2",
                                         "msh",      "fluent.msh", "cgns" };
/* the last needs HDF5 */
#define N_FORM (sizeof all_forms / sizeof *all_forms - !vg_cgns_is_built())

static void expect_failure(struct cut *c, const char *stem, const char *form,
                           const char *phrase)
{
  static const char *const made[] = { "bc", "mapbc" };
  const struct vg_slices_options o = { .threads = 2, .piece_cells = 400 };
  struct vg_error err = VG_ERROR_INIT;
  char path[4200];

  if (vg_slices_write_with(NULL, &c->s, stem, form, &o, &err) != VG_ERR_IO)
    fail_msg("%s: %s", form, err.text);
  if (!strstr(err.text, phrase)) fail_msg("%s: %s", form, err.text);
  snprintf(path, sizeof path, "%s.%s", stem, form);
  assert_absent(path);
  for (size_t i = 0; i < 10; i++) {
    char *piece = vg_slices_piece(stem, i);

    assert_absent(piece);
    free(piece);
  }
  for (int i = 0; i < 2; i++) {
    snprintf(path, sizeof path, "%s.%s", stem, made[i]);
    assert_absent(path);
  }
}

static void failures_leave_nothing(void **state)
{
  struct rlimit old, small;
  struct cut c;

  (void)state;
  cut_make(&c, &mesh[0], N_SLICE, 0, &info[0], 6);
  for (size_t i = 0; i < N_FORM; i++)
    expect_failure(&c, io_temp("no_such_folder/x"), all_forms[i],
                   "no_such_folder");
  /* like a full disk, but for one process only */
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
  small = old;
  small.rlim_cur = 30000;
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  for (size_t i = 0; i < N_FORM; i++)
    expect_failure(&c, io_temp("slices_cut"), all_forms[i], "slices_cut");
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
  c.bad = 17;
  for (size_t i = 0; i < N_FORM; i++)
    expect_failure(&c, io_temp("slices_cut"), all_forms[i], "slice 17 is bad");
  cut_release(&c);
}

static void refuses_values_that_a_form_cannot_store(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct cut c;

  (void)state;
  cut_make(&c, &mesh[1], N_SLICE, 0, &info[1], 7);
  assert_false(vg_slices_can_write("ugrid"));
  assert_false(vg_slices_can_write("foam"));
  assert_false(vg_slices_can_write(""));
  assert_int_equal(vg_slices_write(NULL, &c.s, io_temp("slices_cut"), "ugrid",
                                   1, &err),
                   VG_ERR_UNSUPPORTED);
  assert_int_equal(vg_slices_write(NULL, &c.s, io_temp("slices_cut"), "cogsg",
                                   1, &err),
                   VG_ERR_UNSUPPORTED);
  c.s.n_point = (uint64_t)1 << 31;
  assert_int_equal(vg_slices_write(NULL, &c.s, io_temp("slices_cut"),
                                   "b8.ugrid", 1, &err),
                   VG_ERR_UNSUPPORTED);
  assert_non_null(strstr(err.text, "b8l.ugrid"));
  assert_absent(cut_file("b8.ugrid"));
  assert_absent(cut_file("cogsg"));
  cut_release(&c);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(collect_is_the_mesh),
    cmocka_unit_test(every_kind_of_ugrid),
    cmocka_unit_test(others_are_those_of_the_whole_mesh),
    cmocka_unit_test(rounding_that_spoils_cells_is_refused),
    cmocka_unit_test(rounding_that_joins_points_is_refused),
    cmocka_unit_test(records_in_parts),
    cmocka_unit_test(places_beyond_two_gigabytes),
    cmocka_unit_test(one_vtu),
    cmocka_unit_test(boundary_files_equal_those_of_the_whole_mesh),
    cmocka_unit_test(pieces_are_the_mesh),
    cmocka_unit_test(failures_leave_nothing),
    cmocka_unit_test(refuses_values_that_a_form_cannot_store),
    cmocka_unit_test(cogsg_and_what_belongs_to_it),
  };

  return cmocka_run_group_tests(tests, make_meshes, release_meshes);
}
