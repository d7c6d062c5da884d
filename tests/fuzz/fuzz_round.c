/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include <unistd.h>

#include "io/mesh/medit.h"
#include "io/mesh/obj.h"
#include "io/mesh/stl.h"
#include "io/mesh/tri.h"

/* Write, read, compare: any mesh that a reader makes of the data must survive
 * our own writers, bit by bit where the format permits. */

typedef vg_status (*write_mesh)(const char *, const struct vg_mesh *,
                                struct vg_error *);
typedef vg_status (*read_mesh)(const char *, struct vg_mesh *,
                               struct vg_error *);

static char path[] = "/tmp/fuzz_round.XXXXXX";

static void remove_file(void)
{
  unlink(path);
}

/* One name for all runs of a process; writers rename over it. */
static void make_path(void)
{
  static int made;
  int fd;

  if (made) return;
  made = 1;
  fd = mkstemp(path);
  fuzz_expect(fd >= 0 && !close(fd) && !atexit(remove_file), "a scratch file");
}

static void go_round(write_mesh put, read_mesh get, const struct vg_mesh *m,
                     struct vg_mesh *back)
{
  struct vg_error err = VG_ERROR_INIT;

  if (put(path, m, &err) != VG_OK || get(path, back, &err) != VG_OK) {
    fprintf(stderr, "%s\n", err.text);
    fuzz_expect(0, "a written file can be read");
  }
  fuzz_check_mesh(back);
}

static void same_array(const void *a, const void *b, size_t n, size_t size,
                       const char *what)
{
  fuzz_expect(!n || !memcmp(a, b, n * size), what);
}

static void same_points(const struct vg_mesh *a, const struct vg_mesh *b)
{
  fuzz_expect(a->n_point == b->n_point, "same number of points");
  for (size_t i = 0; i < a->n_point; i++)
    for (int k = 0; k < 3; k++) /* == since -0 may become 0 */
      fuzz_expect(a->point[i][k] == b->point[i][k], "same coordinates");
}

static vg_status put_binary(const char *to, const struct vg_mesh *m,
                            struct vg_error *err)
{
  return vg_medit_write_binary(to, m, 4, 1, err);
}

static void round_medit(write_mesh put, const struct vg_mesh *m)
{
  struct vg_mesh back = VG_MESH_INIT;

  go_round(put, vg_medit_read, m, &back);
  same_points(m, &back);
#define SAME(array, n)                                                         \
  fuzz_expect(m->n == back.n, "same number: " #array);                         \
  same_array(m->array, back.array, m->n, sizeof *m->array, #array)
  SAME(tri, n_tri);
  SAME(quad, n_quad);
  SAME(tet, n_tet);
  SAME(pyr, n_pyr);
  SAME(pri, n_pri);
  SAME(hex, n_hex);
#undef SAME
  for (size_t i = 0; i < m->n_tri; i++)
    fuzz_expect(m->patch[m->tri_patch[i]].id ==
                  back.patch[back.tri_patch[i]].id,
                "same patch numbers");
  vg_mesh_release(&back);
}

static void round_surface(write_mesh put, read_mesh get,
                          const struct vg_mesh *m, int keeps_points)
{
  struct vg_mesh back = VG_MESH_INIT;

  if (!m->n_tri && !m->n_quad) return;
  go_round(put, get, m, &back);
  if (keeps_points) same_points(m, &back);
  fuzz_expect(back.n_tri == m->n_tri + 2 * m->n_quad,
              "expected number of triangles");
  fuzz_expect(back.n_patch <= m->n_patch, "no patch is added");
  vg_mesh_release(&back);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_input_memory("FUZZ", data, size, &in, &err);

  if (st == VG_OK && (*in.data == 'M' || *in.data < 2))
    st = vg_medit_parse(&in, &m, &err);
  else if (st == VG_OK) st = vg_obj_parse(&in, &m, &err);
  if (st == VG_OK) {
    make_path();
    round_medit(vg_medit_write, &m);
    round_medit(put_binary, &m);
    round_surface(vg_tri_write, vg_tri_read, &m, 1);
    round_surface(vg_obj_write, vg_obj_read, &m, 1);
    round_surface(vg_stl_write, vg_stl_read, &m, 0);
  }
  vg_mesh_release(&m);
  vg_input_release(&in);
  return 0;
}
