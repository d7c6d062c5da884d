/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/sol.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "io/mesh/gmf.h"

/* GMF code of SolAtVertices. */
enum { CODE_VERTICES = 62 };
enum { SCALAR = 1, TENSOR = 3 };

struct reader {
  struct vg_gmf g;
  size_t n;
  int components;
  double *value; /* [n][components]; NULL: not read yet */
};

/* In all versions these integers have 4 bytes. */
static vg_status read_int(struct reader *r, int64_t *v, struct vg_error *err)
{
  int32_t narrow;
  vg_status st;

  if (!r->g.binary) return vg_input_int(r->g.in, v, "a kind", err);
  st = vg_input_i32(r->g.in, 1, &narrow, "a kind", err);
  if (st >= 0) *v = narrow;
  return st;
}

/* Number i of a text file; the message of a failure names the vertex. */
static vg_status read_number(struct reader *r, size_t i, struct vg_error *err)
{
  struct vg_error inner = VG_ERROR_INIT;
  const size_t each = (size_t)r->components;
  vg_status st = vg_input_real(r->g.in, &r->value[i], "a value", &inner);

  if (st >= 0) return st;
  return vg_fail(err, st,
                 "%s: number %zu of %zu at vertex %zu of %zu in SolAtVertices",
                 inner.text, i % each + 1, each, i / each + 1, r->n);
}

static vg_status read_values(struct reader *r, struct vg_error *err)
{
  size_t size = r->g.version == 1 ? 4 : 8, n = r->n * (size_t)r->components;
  vg_status st;

  VG_TRY(
    vg_input_need(r->g.in, n, r->g.binary ? size : 2, "SolAtVertices", err));
  r->value = vg_alloc(n, sizeof *r->value);
  if (!r->value) return vg_fail_memory(err, "SolAtVertices");
  if (r->g.binary && size == 4)
    st = vg_input_f32(r->g.in, n, r->value, "SolAtVertices", err);
  else if (r->g.binary)
    st = vg_input_f64(r->g.in, n, r->value, "SolAtVertices", err);
  for (size_t i = 0; i < n && st >= 0; i++) {
    if (!r->g.binary) st = read_number(r, i, err);
    if (st >= 0 && r->components == 1 && !isfinite(r->value[i]))
      st = vg_fail(err, VG_ERR_FORMAT,
                   "%s: the value at vertex %zu is not "
                   "finite",
                   r->g.in->path, i + 1);
  }
done:
  return st;
}

static vg_status read_section(struct reader *r, struct vg_error *err)
{
  int64_t n, n_kind, kind = 0;
  vg_status st;

  if (!r->g.dimension)
    return vg_gmf_fail(&r->g, err, "a section comes before the dimension");
  if (r->value) return vg_gmf_fail(&r->g, err, "SolAtVertices appears twice");
  VG_TRY(vg_gmf_ints(&r->g, 1, &n, "a count", err));
  if (n < 1 || n >= UINT32_MAX)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: %lld vertices: the count is not "
                   "positive or beyond 32 bits",
                   r->g.in->path, (long long)n);
  VG_TRY(read_int(r, &n_kind, err));
  if (n_kind == 1) VG_TRY(read_int(r, &kind, err));
  if (n_kind != 1)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: SolAtVertices has %lld fields; sizes are a file with "
                   "one field, a scalar or a metric per vertex",
                   r->g.in->path, (long long)n_kind);
  if (kind != SCALAR && kind != TENSOR)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: SolAtVertices has a field of kind %lld%s; sizes are a "
                   "scalar (kind 1) or a metric (kind 3) per vertex",
                   r->g.in->path, (long long)kind,
                   kind == 2   ? ", a vector"
                   : kind == 4 ? ", a tensor that is not symmetric"
                               : "");
  r->n = (size_t)n;
  r->components = kind == TENSOR ? 6 : 1;
  st = read_values(r, err);
done:
  return st;
}

/* Sections that are skipped hold numbers; they end at the next word. */
static vg_status read_text(struct reader *r, struct vg_error *err)
{
  const char *text;
  size_t len;
  vg_status st = VG_OK;

  while (vg_input_token(r->g.in, &text, &len)) {
    if (vg_token_is(text, len, "End")) break;
    if (vg_token_is(text, len, "SolAtVertices")) {
      VG_TRY(read_section(r, err));
    } else if (vg_token_is(text, len, "Dimension")) {
      VG_TRY(vg_gmf_read_dimension(&r->g, err));
    }
  }
done:
  return st;
}

static vg_status read_binary(struct reader *r, struct vg_error *err)
{
  int32_t code;
  size_t next;
  vg_status st;

  do {
    VG_TRY(vg_gmf_keyword(&r->g, &code, &next, err));
    if (code == CODE_VERTICES) {
      VG_TRY(read_section(r, err));
    } else if (code == VG_GMF_DIMENSION) {
      VG_TRY(vg_gmf_read_dimension(&r->g, err));
    }
    if (next) r->g.in->at = next;
  } while (next && next < r->g.in->size && code != VG_GMF_END);
done:
  return st;
}

vg_status vg_sol_parse(struct vg_input *in, size_t *n, int *components,
                       double **value, struct vg_error *err)
{
  struct reader r = { .g = { .in = in } };
  vg_status st = vg_gmf_open(&r.g, err);

  assert(in && n && components && value);
  if (st >= 0) st = r.g.binary ? read_binary(&r, err) : read_text(&r, err);
  if (st >= 0 && !r.value)
    st = vg_fail(err, VG_ERR_FORMAT, "%s: the file has no SolAtVertices",
                 in->path);
  if (st < 0) {
    free(r.value);
    return st;
  }
  *n = r.n;
  *components = r.components;
  *value = r.value;
  return VG_OK;
}

vg_status vg_sol_read(const char *path, size_t *n, int *components,
                      double **value, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st >= 0) st = vg_sol_parse(&in, n, components, value, err);
  vg_input_release(&in);
  return st;
}

/* --- writing -------------------------------------------------------------- */

/* Our components in Medit's order xx, xy, yy, xz, yz, zz. */
static const int medit_order[6] = { 0, 1, 3, 2, 4, 5 };

static void put_values(struct vg_output *o, size_t n, const double (*metric)[6],
                       int is_binary)
{
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 6; k++) {
      double v = metric[i][medit_order[k]];

      if (is_binary) {
        vg_output_f64(o, 1, &v);
      } else {
        vg_output_real(o, v);
        vg_output_text(o, k < 5 ? " " : "\n");
      }
    }
}

static void put_text(struct vg_output *o, size_t n, const double (*metric)[6])
{
  vg_output_format(o,
                   "MeshVersionFormatted 2\n\nDimension 3\n\n"
                   "SolAtVertices\n%zu\n1 %d\n\n",
                   n, TENSOR);
  put_values(o, n, metric, 0);
  vg_output_text(o, "\nEnd\n");
}

static void put_keyword(struct vg_output *o, int version, int32_t code,
                        int64_t next)
{
  int32_t narrow = (int32_t)next;

  vg_output_i32(o, 1, &code);
  if (version == 2) vg_output_i32(o, 1, &narrow);
  else vg_output_i64(o, 1, &next);
}

static void put_binary(struct vg_output *o, size_t n, const double (*metric)[6])
{
  const uint64_t data = 48 * (uint64_t)n;
  const int version = data < INT32_MAX - 100 ? 2 : 3;
  const int64_t keyword = version == 2 ? 8 : 12, after = 8 + keyword + 4;
  const int32_t head[2] = { 1, version }, dimension = 3;
  const int32_t count[3] = { (int32_t)n, 1, TENSOR };

  vg_output_order(o, 0);
  vg_output_i32(o, 2, head);
  put_keyword(o, version, VG_GMF_DIMENSION, after);
  vg_output_i32(o, 1, &dimension);
  put_keyword(o, version, CODE_VERTICES,
              after + keyword + (int64_t)sizeof count + (int64_t)data);
  vg_output_i32(o, 3, count);
  put_values(o, n, metric, 1);
  put_keyword(o, version, VG_GMF_END, 0);
}

vg_status vg_sol_write(const char *path, size_t n, const double (*metric)[6],
                       struct vg_error *err)
{
  const size_t len = strlen(path);
  struct vg_output o = VG_OUTPUT_INIT;
  vg_status st;

  assert(metric && n < INT32_MAX);
  VG_TRY(vg_output_open(path, &o, err));
  if (len > 5 && !strcasecmp(path + len - 5, ".solb"))
    put_binary(&o, n, metric);
  else put_text(&o, n, metric);
  st = vg_output_commit(&o, err);
done:
  vg_output_release(&o);
  return st;
}
