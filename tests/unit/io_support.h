/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Shared by the tests of readers and writers: the reference mesh T1 of the
 * format notes, files in VG_TMP_DIR, real files of VG_DATA_DIR. */
#ifndef VG_TESTS_IO_SUPPORT_H
#define VG_TESTS_IO_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

typedef vg_status (*io_parse)(struct vg_input *, struct vg_mesh *,
                              struct vg_error *);
typedef vg_status (*io_read)(const char *, struct vg_mesh *, struct vg_error *);

/* Path in the folder for scratch files; valid until the next four calls. */
static inline const char *io_temp(const char *name)
{
  static char path[4][4096];
  static int turn;

  turn = (turn + 1) % 4;
  snprintf(path[turn], sizeof path[turn], "%s/%s", VG_TMP_DIR, name);
  return path[turn];
}

static inline vg_status io_parse_bytes(io_parse parse, const void *data,
                                       size_t size, struct vg_mesh *m,
                                       struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_memory("case", data, size, &in, err);

  if (st == VG_OK) st = parse(&in, m, err);
  vg_input_release(&in);
  return st;
}

/* Parse a text and expect success. */
static inline void io_accept(io_parse parse, const char *text,
                             struct vg_mesh *m)
{
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = io_parse_bytes(parse, text, strlen(text), m, &err);

  if (st != VG_OK) fail_msg("refused: %s", err.text);
}

/* Parse bytes and expect a failure with this code, a message that contains this
 * phrase and the name of the file, and an untouched mesh. */
static inline void io_refuse_bytes(io_parse parse, const void *data,
                                   size_t size, vg_status code,
                                   const char *phrase)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT, empty = VG_MESH_INIT;
  vg_status st = io_parse_bytes(parse, data, size, &m, &err);

  if (st != code || err.code != code || !strstr(err.text, phrase) ||
      !strstr(err.text, "case"))
    fail_msg("status %d instead of %d, '%s' has no '%s'", st, code, err.text,
             phrase);
  assert_memory_equal(&m, &empty, sizeof m);
}

static inline void io_refuse(io_parse parse, const char *text, vg_status code,
                             const char *phrase)
{
  io_refuse_bytes(parse, text, strlen(text), code, phrase);
}

/* The boundary of T1; with is_volume also its tetrahedron. Patches 1..4. */
static inline void io_make_t1(struct vg_mesh *m, int is_volume)
{
  static const double point[4][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
  };
  static const uint32_t tri[4][3] = {
    { 0, 1, 2 }, { 0, 3, 1 }, { 0, 2, 3 }, { 1, 3, 2 }
  };

  memset(m, 0, sizeof *m);
  m->n_point = m->n_tri = 4;
  m->point = malloc(sizeof point);
  m->tri = malloc(sizeof tri);
  m->tri_patch = malloc(4 * sizeof *m->tri_patch);
  memcpy(m->point, point, sizeof point);
  memcpy(m->tri, tri, sizeof tri);
  for (uint32_t i = 0; i < 4; i++) {
    m->tri_patch[i] = i;
    assert_int_equal(vg_mesh_add_patch(m, (int32_t)i + 1, NULL), i);
  }
  if (!is_volume) return;
  m->n_tet = 1;
  m->tet = malloc(sizeof *m->tet);
  for (uint32_t i = 0; i < 4; i++) m->tet[0][i] = i;
}

/* One cell of every kind side by side, with quadrilaterals on two patches: a
 * hexahedron, a prism on its right, a pyramid above it, a tetrahedron on the
 * pyramid. The boundary is not closed; readers do not require it. */
static inline void io_make_mixed(struct vg_mesh *m)
{
  static const double point[13][3] = { { 0, 0, 0 },
                                       { 1, 0, 0 },
                                       { 1, 1, 0 },
                                       { 0, 1, 0 },
                                       { 0, 0, 1 },
                                       { 1, 0, 1 },
                                       { 1, 1, 1 },
                                       { 0, 1, 1 },
                                       { 2, 0.5, 0 },
                                       { 2, 0.5, 1 },
                                       { 0.5, 0.5, 2 },
                                       { 1.5, 0.5, 1.75 },
                                       { 1.0 / 3, -0.1, 1e-7 } };
  static const uint32_t hex[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  static const uint32_t pri[6] = { 1, 8, 2, 5, 9, 6 };
  /* The slots 0 3 4 1 are the quadrilateral 4 5 6 7, counter-clockwise seen
   * from point 10. */
  static const uint32_t pyr[5] = { 4, 7, 10, 5, 6 };
  static const uint32_t tet[4] = { 5, 6, 10, 11 };
  static const uint32_t tri[2][3] = { { 1, 8, 2 }, { 4, 7, 10 } };
  static const uint32_t quad[3][4] = { { 0, 1, 2, 3 },
                                       { 0, 4, 5, 1 },
                                       { 0, 3, 7, 4 } };
  static const uint32_t tri_patch[2] = { 0, 2 }, quad_patch[3] = { 0, 1, 2 };

  memset(m, 0, sizeof *m);
#define FILL(array, from, n)                                                   \
  (m->array = malloc(sizeof from), memcpy(m->array, from, sizeof from),        \
   m->n = sizeof from / (sizeof *m->array))
  FILL(point, point, n_point);
  FILL(hex, hex, n_hex);
  FILL(pri, pri, n_pri);
  FILL(pyr, pyr, n_pyr);
  FILL(tet, tet, n_tet);
  FILL(tri, tri, n_tri);
  FILL(quad, quad, n_quad);
  FILL(tri_patch, tri_patch, n_tri);
  FILL(quad_patch, quad_patch, n_quad);
#undef FILL
  vg_mesh_add_patch(m, -7, "low");
  vg_mesh_add_patch(m, 3, "front side");
  vg_mesh_add_patch(m, 20, "left");
}

static inline void io_same_array(const void *a, const void *b, size_t n,
                                 size_t size)
{
  if (n) assert_memory_equal(a, b, n * size);
}

/* Equal in every bit, except for boundary conditions and, if with_names is 0,
 * names of patches. */
static inline void io_same(const struct vg_mesh *a, const struct vg_mesh *b,
                           int with_names)
{
#define SAME(array, n)                                                         \
  (assert_int_equal(a->n, b->n),                                               \
   io_same_array(a->array, b->array, a->n, sizeof *a->array))
  SAME(point, n_point);
  SAME(tri, n_tri);
  SAME(quad, n_quad);
  SAME(tri_patch, n_tri);
  SAME(quad_patch, n_quad);
  SAME(tet, n_tet);
  SAME(pyr, n_pyr);
  SAME(pri, n_pri);
  SAME(hex, n_hex);
#undef SAME
  assert_int_equal(a->n_patch, b->n_patch);
  for (size_t i = 0; i < a->n_patch; i++) {
    assert_int_equal(a->patch[i].id, b->patch[i].id);
    if (with_names) assert_string_equal(a->patch[i].name, b->patch[i].name);
  }
}

/* Six times the volume enclosed by the triangles, their normals outward. */
static inline double io_volume6(const struct vg_mesh *m)
{
  double sum = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    const double *a = m->point[m->tri[i][0]], *b = m->point[m->tri[i][1]],
                 *c = m->point[m->tri[i][2]];

    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) +
           a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum;
}

static int io_by_edge(const void *a, const void *b)
{
  const uint32_t *x = a, *y = b;

  if (x[0] != y[0]) return x[0] < y[0] ? -1 : 1;
  return x[1] < y[1] ? -1 : x[1] > y[1];
}

/* Edges that do not have one triangle on either side, oppositely directed. */
static inline size_t io_bad_edges(const struct vg_mesh *m)
{
  size_t n = 3 * m->n_tri, bad = 0;
  uint32_t(*e)[3] = malloc(n * sizeof *e);

  for (size_t i = 0; i < n; i++) {
    uint32_t a = m->tri[i / 3][i % 3], b = m->tri[i / 3][(i + 1) % 3];

    e[i][0] = a < b ? a : b;
    e[i][1] = a < b ? b : a;
    e[i][2] = a < b;
  }
  qsort(e, n, sizeof *e, io_by_edge);
  for (size_t i = 0, j; i < n; i = j) {
    size_t up = 0;

    for (j = i; j < n && !io_by_edge(e[i], e[j]); j++) up += e[j][2];
    bad += j - i != 2 || up != 1;
  }
  free(e);
  return bad;
}

/* Path of a real file, unpacked from .xz if needed; skips the test if there is
 * no data folder. */
static inline const char *io_real(const char *name)
{
  char packed[1024], local[256], command[8192];
  const char *plain, *base = strrchr(name, '/');

  snprintf(packed, sizeof packed, "%s/%s", VG_DATA_DIR, name);
  if (!*VG_DATA_DIR || access(packed, R_OK)) {
    print_message("VG_DATA_DIR has no %s: skipped (verification/fetch.md has "
                  "the sources)\n",
                  name);
    skip();
  }
  snprintf(local, sizeof local, "real_%d_%s", (int)getpid(),
           base ? base + 1 : name);
  if (strlen(name) < 3 || strcmp(name + strlen(name) - 3, ".xz")) {
    static char path[1024];

    snprintf(path, sizeof path, "%s", packed);
    return path;
  }
  local[strlen(local) - 3] = 0;
  plain = io_temp(local);
  snprintf(command, sizeof command, "xz -dc '%s' > '%s'", packed, plain);
  assert_int_equal(system(command), 0);
  return plain;
}

static inline void io_write_file(const char *path, const void *data,
                                 size_t size)
{
  FILE *f = fopen(path, "wb");

  assert_non_null(f);
  assert_int_equal(fwrite(data, 1, size, f), size);
  assert_int_equal(fclose(f), 0);
}

static inline void io_write_gzip(const char *path, const void *data,
                                 size_t size)
{
  gzFile f = gzopen(path, "wb");

  assert_non_null(f);
  assert_int_equal(gzwrite(f, data, (unsigned)size), size);
  assert_int_equal(gzclose(f), Z_OK);
}

/* Contents of a file, for comparing bytes; the caller frees it. */
static inline unsigned char *io_slurp(const char *path, size_t *size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  unsigned char *data;

  if (vg_input_open(path, &in, &err) != VG_OK) fail_msg("%s", err.text);
  data = malloc(in.size + 1);
  memcpy(data, in.data, in.size + 1);
  *size = in.size;
  vg_input_release(&in);
  return data;
}

#endif
