/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A .ugrid that is read in slices is the mesh that is read as a whole; files
 * that cannot be read in slices are recognised; the memory is that of a
 * slice. */
#include "mixed_support.h"

#include <sys/wait.h>
#include <unistd.h>

#include "core/mesh/slices.h"
#include "io/mesh/format.h"
#include "io/mesh/ugrid.h"
#include "io/slices/slices.h"
#include "io/slices/ugrid_slices.h"
#include "run/report/report.h"

static uint64_t seed = 7;

static uint32_t pick(size_t n)
{
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)((seed >> 33) % n);
}

/* --- meshes -------------------------------------------------------------- */

/* All kinds of cells; without the hexahedra, some faces of the boundary have no
 * cell. */
static void make_mesh(struct vg_mesh *m, int has_hexahedra)
{
  mixed_make(m, 7, 5);
  if (!has_hexahedra) m->n_hex = 0;
}

static void swap(uint32_t *v, int a, int b)
{
  const uint32_t t = v[a];

  v[a] = v[b];
  v[b] = t;
}

static void renumber(size_t n, uint32_t *node, const uint32_t *to)
{
  for (size_t i = 0; i < n; i++) node[i] = to[node[i]];
}

/* Give the points random numbers. */
static void shuffle(struct vg_mesh *m)
{
  uint32_t *to = malloc(m->n_point * sizeof *to);
  double(*x)[3] = malloc(m->n_point * sizeof *x);

  for (size_t i = 0; i < m->n_point; i++) to[i] = (uint32_t)i;
  for (size_t i = m->n_point; i > 1; i--) swap(to, (int)i - 1, (int)pick(i));
  for (size_t i = 0; i < m->n_point; i++)
    memcpy(x[to[i]], m->point[i], sizeof *x);
  free(m->point);
  m->point = x;
  renumber(3 * m->n_tri, (uint32_t *)m->tri, to);
  renumber(4 * m->n_quad, (uint32_t *)m->quad, to);
  renumber(4 * m->n_tet, (uint32_t *)m->tet, to);
  renumber(5 * m->n_pyr, (uint32_t *)m->pyr, to);
  renumber(6 * m->n_pri, (uint32_t *)m->pri, to);
  renumber(8 * m->n_hex, (uint32_t *)m->hex, to);
  free(to);
}

/* Mirror some cells, and turn some faces. */
static void disorder(struct vg_mesh *m)
{
  for (size_t i = 0; i < m->n_tet; i++)
    if (!pick(3)) swap(m->tet[i], 1, 2);
  for (size_t i = 0; i < m->n_pyr; i++)
    if (!pick(3)) swap(m->pyr[i], 1, 3);
  for (size_t i = 0; i < m->n_pri; i++)
    if (!pick(3)) {
      swap(m->pri[i], 1, 2);
      swap(m->pri[i], 4, 5);
    }
  for (size_t i = 0; i < m->n_hex; i++)
    if (!pick(3)) {
      swap(m->hex[i], 1, 3);
      swap(m->hex[i], 5, 7);
    }
  for (size_t i = 0; i < m->n_tri; i++)
    if (!pick(3)) swap(m->tri[i], 1, 2);
  for (size_t i = 0; i < m->n_quad; i++)
    if (!pick(3)) swap(m->quad[i], 1, 3);
}

static const char *path_of(const char *kind)
{
  char name[64];

  snprintf(name, sizeof name, "slices.%s", kind);
  return io_temp(name);
}

static struct vg_ugrid_slices *open_slices(const char *path, size_t cells,
                                           struct vg_read_info *info)
{
  struct vg_ugrid_slices *u = NULL;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_ugrid_slices_open(path, cells, &u, info, &err) < 0)
    fail_msg("%s", err.text);
  return u;
}

/* --- the same mesh ------------------------------------------------------- */

static void compare(const char *path, size_t cells)
{
  struct vg_mesh whole = VG_MESH_INIT, sliced = VG_MESH_INIT;
  struct vg_read_info a = { 0 }, b = { 0 };
  struct vg_ugrid_slices *u = open_slices(path, cells, &b);
  double lo[2][3], hi[2][3];

  assert_non_null(u);
  assert_int_equal(vg_mesh_read(path, &whole, &a, NULL), VG_OK);
  assert_int_equal(vg_slices_collect(vg_ugrid_slices(u), 2, &sliced, NULL),
                   VG_OK);
  io_same(&whole, &sliced, 1);
  assert_int_equal(a.turned.cell, b.turned.cell);
  assert_int_equal(a.turned.face, b.turned.face);
  assert_int_equal(a.n_cell, b.n_cell);
  assert_int_equal(a.has_mapbc, b.has_mapbc);
  vg_mesh_bounds(&whole, lo[0], hi[0]);
  vg_ugrid_slices_bounds(u, lo[1], hi[1]);
  assert_memory_equal(lo[0], lo[1], sizeof lo[0]);
  assert_memory_equal(hi[0], hi[1], sizeof hi[0]);
  vg_mesh_release(&whole);
  vg_mesh_release(&sliced);
  vg_ugrid_slices_close(u);
}

static void compare_all(int has_hexahedra)
{
  static const char *const kind[] = { "b8.ugrid",    "lb8.ugrid", "lb4.ugrid",
                                      "b8l.ugrid",   "b4.ugrid",  "b8.ugrid64",
                                      "lb8.ugrid64", "lb8l.ugrid" };
  static const size_t cells[] = { 1, 7, 60, 100000 };
  struct vg_mesh m;

  make_mesh(&m, has_hexahedra);
  for (int round = 0; round < 3; round++) {
    if (round == 1) disorder(&m);
    if (round == 2) shuffle(&m);
    for (size_t k = 0; k < sizeof kind / sizeof *kind; k++) {
      assert_int_equal(vg_ugrid_write(path_of(kind[k]), &m, NULL), VG_OK);
      for (size_t i = 0; i < sizeof cells / sizeof *cells; i++)
        compare(path_of(kind[k]), cells[i]);
    }
  }
  vg_mesh_release(&m);
}

static void it_is_the_whole_mesh(void **state)
{
  (void)state;
  compare_all(0);
  compare_all(1);
}

static void it_has_the_layer_tetrahedra(void **state)
{
  struct vg_read_info info = { 0 };
  struct vg_ugrid_slices *u;
  struct vg_mesh m;

  (void)state;
  make_mesh(&m, 1);
  assert_int_equal(vg_ugrid_write_tail(path_of("lb8.ugrid"), &m, m.n_tet / 2,
                                       NULL),
                   VG_OK);
  u = open_slices(path_of("lb8.ugrid"), 9, &info);
  assert_non_null(u);
  assert_int_equal(vg_ugrid_slices(u)->n_layer_cell[VG_SLICE_TET], m.n_tet / 2);
  vg_ugrid_slices_close(u);
  vg_mesh_release(&m);
}

/* --- other files --------------------------------------------------------- */

static void expect_whole(const char *path)
{
  struct vg_read_info info = { 0 };

  assert_null(open_slices(path, 10, &info));
}

static void it_leaves_other_files_alone(void **state)
{
  struct vg_mesh m;
  unsigned char *data;
  size_t size;

  (void)state;
  make_mesh(&m, 1);
  for (int k = 0; k < 2; k++) {
    const char *path = path_of(k ? "ugrid" : "r8.ugrid");

    assert_int_equal(vg_ugrid_write(path, &m, NULL), VG_OK);
    expect_whole(path);
  }
  assert_int_equal(vg_ugrid_write(path_of("lb8.ugrid"), &m, NULL), VG_OK);
  data = io_slurp(path_of("lb8.ugrid"), &size);
  io_write_gzip(path_of("lb8.ugrid.gz"), data, size);
  expect_whole(path_of("lb8.ugrid.gz"));
  io_write_file(path_of("b8.ugrid"), data, size); /* another byte order */
  expect_whole(path_of("b8.ugrid"));
  io_write_file(path_of("lb8.ugrid"), data, size - 1);
  expect_whole(path_of("lb8.ugrid"));
  io_write_file(path_of("lb8.ugrid"), data, 20);
  expect_whole(path_of("lb8.ugrid"));
  memset(data + size - 4, 0x7f, 4); /* the last node of a cell */
  io_write_file(path_of("lb8.ugrid"), data, size);
  expect_whole(path_of("lb8.ugrid"));
  memset(data + 28, 0xff, 8); /* the first coordinate: not a number */
  io_write_file(path_of("lb8.ugrid"), data, size);
  expect_whole(path_of("lb8.ugrid"));
  expect_whole(io_temp("slices.missing.lb8.ugrid"));
  free(data);
  m.n_hex = m.n_tet = m.n_pyr = m.n_pri = 0; /* a surface */
  assert_int_equal(vg_ugrid_write(path_of("lb8.ugrid"), &m, NULL), VG_OK);
  expect_whole(path_of("lb8.ugrid"));
  vg_mesh_release(&m);
}

/* A boundary face between two cells, which vg_mesh_read removes. */
static void a_face_between_cells_needs_the_whole_mesh(void **state)
{
  struct vg_mesh m;

  (void)state;
  make_mesh(&m, 1);
  for (int k = 0; k < 3; k++) m.tri[0][k] = m.tet[0][k]; /* above it: a prism */
  assert_int_equal(vg_ugrid_write(path_of("lb8.ugrid"), &m, NULL), VG_OK);
  expect_whole(path_of("lb8.ugrid"));
  vg_mesh_release(&m);
}

/* --- memory -------------------------------------------------------------- */

/* n cubes in each direction, of six tetrahedra, with a face of each side. */
static void write_cubes(const char *path, uint32_t n)
{
  static const int corner[6][4] = { { 0, 1, 3, 7 }, { 0, 3, 2, 7 },
                                    { 0, 2, 6, 7 }, { 0, 6, 4, 7 },
                                    { 0, 4, 5, 7 }, { 0, 5, 1, 7 } };
  const uint32_t s = n + 1;
  struct vg_mesh m = { .n_tri = 1, .n_point = (size_t)s * s * s };

  m.point = malloc(m.n_point * sizeof *m.point);
  m.tet = malloc(6 * (size_t)n * n * n * sizeof *m.tet);
  m.tri = calloc(1, sizeof *m.tri);
  m.tri_patch = calloc(1, sizeof *m.tri_patch);
  vg_mesh_add_patch(&m, 1, NULL);
  m.tri[0][1] = 1;
  m.tri[0][2] = s + 1;
  for (uint32_t i = 0; i < m.n_point; i++) {
    m.point[i][0] = i % s;
    m.point[i][1] = i / s % s;
    m.point[i][2] = i / s / s;
  }
  for (uint32_t c = 0; c < n * n * n; c++)
    for (int t = 0; t < 6; t++, m.n_tet++)
      for (int k = 0; k < 4; k++) {
        const uint32_t v = (uint32_t)corner[t][k];

        m.tet[m.n_tet][k] = c % n + (v & 1) + s * (c / n % n + (v >> 1 & 1)) +
                            s * s * (c / n / n + (v >> 2));
      }
  assert_int_equal(vg_ugrid_write(path, &m, NULL), VG_OK);
  vg_mesh_release(&m);
}

/* Bytes that a process needs to write the mesh of `path` as .su2. */
static double peak_of(const char *path)
{
  const struct vg_slices_options o = { .threads = 1 };
  double peak = 0;
  int fd[2];
  pid_t child;

  assert_int_equal(pipe(fd), 0);
  child = fork();
  assert_true(child >= 0);
  if (!child) {
    struct vg_read_info info = { 0 };
    struct vg_ugrid_slices *u = NULL;
    vg_status st = vg_ugrid_slices_open(path, 20000, &u, &info, NULL);

    if (st >= 0 && u)
      st = vg_slices_write_with(NULL, vg_ugrid_slices(u), io_temp("cubes"),
                                "su2", &o, NULL);
    vg_ugrid_slices_close(u);
    peak = u && st >= 0 ? vg_report_peak_memory() : 0;
    _exit(write(fd[1], &peak, sizeof peak) != sizeof peak);
  }
  assert_int_equal(read(fd[0], &peak, sizeof peak), sizeof peak);
  assert_int_equal(waitpid(child, NULL, 0), child);
  close(fd[0]);
  close(fd[1]);
  return peak;
}

/* From the first mesh to the second, file and mesh grow by some 50 MB each. */
static void it_needs_the_memory_of_a_slice(void **state)
{
  double peak[2];

  (void)state;
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
  skip(); /* freed memory stays in the process */
#endif
  for (int i = 0; i < 2; i++) {
    const char *path = io_temp(i ? "cubes_2.lb8.ugrid" : "cubes_1.lb8.ugrid");
    pid_t child = fork(); /* The mesh must not count for the next process. */
    int status;

    if (!child) {
      write_cubes(path, i ? 80 : 40);
      _exit(0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    peak[i] = peak_of(path);
    assert_true(peak[i] > 0);
    unlink(path);
  }
  unlink(io_temp("cubes.su2"));
  printf("peaks: %.1f and %.1f MB\n", peak[0] / 1e6, peak[1] / 1e6);
  if (peak[1] > peak[0] + 4e6)
    fail_msg("%.1f MB grow to %.1f MB", peak[0] / 1e6, peak[1] / 1e6);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(it_is_the_whole_mesh),
    cmocka_unit_test(it_has_the_layer_tetrahedra),
    cmocka_unit_test(it_leaves_other_files_alone),
    cmocka_unit_test(a_face_between_cells_needs_the_whole_mesh),
    cmocka_unit_test(it_needs_the_memory_of_a_slice),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
