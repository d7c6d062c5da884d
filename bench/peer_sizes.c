/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The sizing field as a background mesh for other programs. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/stream.h"
#include "peers.h"

/* Relative difference below which the field counts as uniform in a cell. */
#define UNIFORM 0.01
#define MAX_LEVEL 20
#define NAME_MAX_LEN 4096

struct sampler {
  const struct vg_sizing *sizing;
  double lo[3], width, cells;
  uint64_t *key; /* corners on the finest grid, 21 bits each */
  size_t n, cap;
  vg_status st;
};

static void add_corner(struct sampler *s, const uint64_t at[3])
{
  if (vg_reserve(&s->key, &s->cap, s->n + 1, sizeof *s->key)) {
    s->st = VG_ERR_MEMORY;
    return;
  }
  s->key[s->n++] = at[0] << 42 | at[1] << 21 | at[2];
}

static double size_at(const struct sampler *s, const uint64_t at[3],
                      uint64_t span, const double part[3])
{
  double x[3], unit = s->width / (double)(1 << MAX_LEVEL);

  for (int k = 0; k < 3; k++)
    x[k] = s->lo[k] + unit * ((double)at[k] + part[k] * (double)span);
  return vg_sizing_at(s->sizing, x);
}

/* A field with bounded gradient has no fine region inside a cell of this many
 * target lengths, so its corners and centre are sufficient. */
static int is_fine(const struct sampler *s, const uint64_t at[3], uint64_t span)
{
  double middle = size_at(s, at, span, (double[3]){ 0.5, 0.5, 0.5 });
  double width = s->width * (double)span / (double)(1 << MAX_LEVEL);

  if (span == 1 || width <= s->cells * middle) return 1;
  if (width > 2 * s->cells * middle) return 0;
  for (int i = 0; i < 8; i++) {
    double part[3] = { i & 1, i >> 1 & 1, i >> 2 };

    if (fabs(size_at(s, at, span, part) - middle) > UNIFORM * middle) return 0;
  }
  return 1;
}

static void divide(struct sampler *s, const uint64_t at[3], uint64_t span)
{
  int fine = is_fine(s, at, span);

  for (uint64_t i = 0; i < 8; i++) {
    uint64_t step = fine ? span : span / 2;
    uint64_t next[3] = { at[0] + (i & 1) * step, at[1] + (i >> 1 & 1) * step,
                         at[2] + (i >> 2) * step };

    if (s->st < 0) return;
    if (fine) add_corner(s, next);
    else divide(s, next, step);
  }
}

static int by_key(const void *a, const void *b)
{
  uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;

  return (p > q) - (p < q);
}

static vg_status evaluate(struct sampler *s, double (**point)[3], double **size)
{
  double unit = s->width / (double)(1 << MAX_LEVEL);
  size_t n = 0;

  qsort(s->key, s->n, sizeof *s->key, by_key);
  for (size_t i = 0; i < s->n; i++)
    if (!n || s->key[i] != s->key[n - 1]) s->key[n++] = s->key[i];
  s->n = n;
  *point = vg_alloc(n, sizeof **point);
  *size = vg_alloc(n, sizeof **size);
  if (!*point || !*size) {
    free(*point);
    free(*size);
    return VG_ERR_MEMORY;
  }
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      (*point)[i][k] = s->lo[k] +
                       unit * (double)(s->key[i] >> (42 - 21 * k) & 0x1FFFFF);
  vg_sizing_eval(s->sizing, n, (const double(*)[3]) * point, *size);
  return VG_OK;
}

vg_status peer_sample(const struct vg_sizing *sizing, const double lo[3],
                      const double hi[3], double cells, size_t *n,
                      double (**point)[3], double **size, struct vg_error *err)
{
  struct sampler s = { .sizing = sizing, .cells = cells };
  const uint64_t origin[3] = { 0, 0, 0 };

  for (int k = 0; k < 3; k++)
    if (hi[k] - lo[k] > s.width) s.width = hi[k] - lo[k];
  s.width *= 1.002;
  for (int k = 0; k < 3; k++) s.lo[k] = (lo[k] + hi[k] - s.width) / 2;
  divide(&s, origin, (uint64_t)1 << MAX_LEVEL);
  if (s.st == VG_OK) s.st = evaluate(&s, point, size);
  *n = s.n;
  free(s.key);
  return s.st < 0 ? vg_fail_memory(err, "the background points") : VG_OK;
}

vg_status peer_write_background(const char *stem, size_t n,
                                const double (*point)[3], const double *size,
                                struct vg_error *err)
{
  char name[NAME_MAX_LEN];
  struct vg_output f = VG_OUTPUT_INIT;
  vg_status st = VG_OK;

  snprintf(name, sizeof name, "%s.b.node", stem);
  VG_TRY(vg_output_open(name, &f, err));
  vg_output_format(&f, "%zu 3 0 0\n", n);
  for (size_t i = 0; i < n; i++) {
    vg_output_format(&f, "%zu", i + 1);
    for (int k = 0; k < 3; k++) {
      vg_output_text(&f, " ");
      vg_output_real(&f, point[i][k]);
    }
    vg_output_text(&f, "\n");
  }
  VG_TRY(vg_output_commit(&f, err));
  snprintf(name, sizeof name, "%s.b.mtr", stem);
  VG_TRY(vg_output_open(name, &f, err));
  vg_output_format(&f, "%zu 1\n", n);
  for (size_t i = 0; i < n; i++) {
    vg_output_real(&f, size[i]);
    vg_output_text(&f, "\n");
  }
  VG_TRY(vg_output_commit(&f, err));
done:
  vg_output_release(&f);
  return st;
}

static vg_status read_sizes(const char *stem, size_t n, double **size,
                            struct vg_error *err)
{
  char name[NAME_MAX_LEN];
  struct vg_input in = VG_INPUT_INIT;
  int64_t count = 0, columns = 0;
  vg_status st = VG_OK;

  snprintf(name, sizeof name, "%s.b.mtr", stem);
  VG_TRY(vg_input_open(name, &in, err));
  VG_TRY(vg_input_int(&in, &count, "count of sizes", err));
  VG_TRY(vg_input_int(&in, &columns, "count of columns", err));
  if ((uint64_t)count != n) {
    st = vg_input_fail(&in, err, "%zu sizes expected", n);
    goto done;
  }
  *size = vg_alloc(n, sizeof **size);
  if (!*size) {
    st = vg_fail_memory(err, "sizes");
    goto done;
  }
  for (size_t i = 0; i < n; i++)
    VG_TRY(vg_input_real(&in, *size + i, "size", err));
done:
  vg_input_release(&in);
  return st;
}

static void write_element(struct vg_output *f, const struct vg_mesh *m,
                          const uint32_t t[4], const double *size)
{
  vg_output_text(f, "SS(");
  for (int i = 0; i < 12; i++) {
    if (i) vg_output_text(f, ",");
    vg_output_real(f, m->point[t[i / 3]][i % 3]);
  }
  vg_output_text(f, "){");
  for (int i = 0; i < 4; i++) {
    if (i) vg_output_text(f, ",");
    vg_output_real(f, size[t[i]]);
  }
  vg_output_text(f, "};\n");
}

vg_status peer_write_view(const char *stem, struct vg_error *err)
{
  char name[NAME_MAX_LEN];
  struct vg_mesh m = VG_MESH_INIT, none = VG_MESH_INIT;
  struct vg_output f = VG_OUTPUT_INIT;
  double *size = NULL;
  vg_status st = VG_OK;

  snprintf(name, sizeof name, "%s.b", stem);
  VG_TRY(peer_read_tetgen(name, &none, &m, err));
  VG_TRY(read_sizes(stem, m.n_point, &size, err));
  snprintf(name, sizeof name, "%s.pos", stem);
  VG_TRY(vg_output_open(name, &f, err));
  vg_output_text(&f, "View \"size\" {\n");
  for (size_t i = 0; i < m.n_tet; i++) write_element(&f, &m, m.tet[i], size);
  vg_output_text(&f, "};\n");
  VG_TRY(vg_output_commit(&f, err));
done:
  vg_output_release(&f);
  vg_mesh_release(&m);
  free(size);
  return st;
}
