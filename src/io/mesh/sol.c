/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/sol.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
