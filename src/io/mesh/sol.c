#include "io/mesh/sol.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* GMF codes. */
enum { CODE_DIMENSION = 3, CODE_END = 54, CODE_VERTICES = 62 };
enum { SCALAR = 1 };

struct reader {
  struct vg_input *in;
  int binary, version;
  int dimension;            /* 0: not seen yet */
  size_t n;
  double *value;            /* [n]; NULL: not seen yet */
};

static vg_status fail_at(const struct reader *r, struct vg_error *err,
                         const char *text)
{
  if (!r->binary) return vg_input_fail(r->in, err, "%s", text);
  return vg_fail(err, VG_ERR_FORMAT, "%s: %s (near byte %zu)", r->in->path,
                 text, r->in->at);
}

static vg_status set_head(struct reader *r, int64_t version, int64_t dimension,
                          struct vg_error *err)
{
  if (version && (version < 1 || version > 4))
    return fail_at(r, err, "unknown version: MeshVersionFormatted must be 1 "
                   "to 4");
  if (dimension && dimension != 3)
    return fail_at(r, err, "the dimension is not 3");
  if (version) r->version = (int)version;
  if (dimension) r->dimension = (int)dimension;
  return VG_OK;
}

/* A count, which is wider from version 4 on. */
static vg_status read_count(struct reader *r, int64_t *v, struct vg_error *err)
{
  int32_t narrow;
  vg_status st;

  if (!r->binary) return vg_input_int(r->in, v, "a count", err);
  if (r->version == 4) return vg_input_i64(r->in, 1, v, "a count", err);
  st = vg_input_i32(r->in, 1, &narrow, "a count", err);
  if (st >= 0) *v = narrow;
  return st;
}

static vg_status read_int(struct reader *r, int64_t *v, struct vg_error *err)
{
  int32_t narrow;
  vg_status st;

  if (!r->binary) return vg_input_int(r->in, v, "a kind", err);
  st = vg_input_i32(r->in, 1, &narrow, "a kind", err);
  if (st >= 0) *v = narrow;
  return st;
}

static vg_status read_values(struct reader *r, struct vg_error *err)
{
  size_t size = r->version == 1 ? 4 : 8;
  vg_status st;

  VG_TRY(vg_input_need(r->in, r->n, r->binary ? size : 2, "SolAtVertices",
                       err));
  r->value = vg_alloc(r->n, sizeof *r->value);
  if (!r->value) return vg_fail_memory(err, "SolAtVertices");
  if (r->binary)
    st = size == 4 ? vg_input_f32(r->in, r->n, r->value, "SolAtVertices", err)
                   : vg_input_f64(r->in, r->n, r->value, "SolAtVertices", err);
  for (size_t i = 0; i < r->n && st >= 0; i++) {
    if (!r->binary) st = vg_input_real(r->in, &r->value[i], "a value", err);
    if (st >= 0 && !isfinite(r->value[i]))
      st = vg_fail(err, VG_ERR_FORMAT, "%s: the value at vertex %zu is not "
                   "finite", r->in->path, i + 1);
  }
done:
  return st;
}

static vg_status read_section(struct reader *r, struct vg_error *err)
{
  int64_t n, n_kind, kind = 0;
  vg_status st;

  if (!r->dimension)
    return fail_at(r, err, "a section stands before the dimension");
  if (r->value) return fail_at(r, err, "SolAtVertices appears twice");
  VG_TRY(read_count(r, &n, err));
  if (n < 1 || n >= UINT32_MAX)
    return vg_fail(err, VG_ERR_FORMAT, "%s: %lld vertices: the count is not "
                   "positive or beyond 32 bits", r->in->path, (long long)n);
  VG_TRY(read_int(r, &n_kind, err));
  if (n_kind == 1) VG_TRY(read_int(r, &kind, err));
  if (n_kind != 1 || kind != SCALAR)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "%s: SolAtVertices must have one "
                   "scalar per vertex (1 1), not %lld fields, the first of "
                   "kind %lld", r->in->path, (long long)n_kind,
                   (long long)kind);
  r->n = (size_t)n;
  st = read_values(r, err);
done:
  return st;
}

/* Sections that are not ours hold numbers; a word ends them. */
static vg_status read_text(struct reader *r, struct vg_error *err)
{
  const char *text;
  size_t len;
  int64_t v;
  vg_status st = VG_OK;

  r->in->comment = '#';
  if (!vg_input_token(r->in, &text, &len) ||
      !vg_token_is(text, len, "MeshVersionFormatted"))
    return fail_at(r, err, "not a Medit file: it does not begin with "
                   "'MeshVersionFormatted'");
  VG_TRY(vg_input_int(r->in, &v, "the version", err));
  VG_TRY(set_head(r, v ? v : -1, 0, err));
  while (vg_input_token(r->in, &text, &len)) {
    if (vg_token_is(text, len, "End")) break;
    if (vg_token_is(text, len, "SolAtVertices")) {
      VG_TRY(read_section(r, err));
    } else if (vg_token_is(text, len, "Dimension")) {
      VG_TRY(vg_input_int(r->in, &v, "the dimension", err));
      VG_TRY(set_head(r, 0, v ? v : -1, err));
    }
  }
done:
  return st;
}

/* Where the next keyword stands; 0: there is none. Positions must advance, or
 * a damaged file could be read for ever. */
static vg_status read_position(struct reader *r, size_t start, size_t *next,
                               struct vg_error *err)
{
  int64_t position;
  int32_t narrow = 0;
  vg_status st;

  if (r->version >= 3) {
    VG_TRY(vg_input_i64(r->in, 1, &position, "a position", err));
  } else {
    VG_TRY(vg_input_i32(r->in, 1, &narrow, "a position", err));
    position = narrow;
  }
  if (position && (position < 0 || (uint64_t)position > r->in->size))
    st = fail_at(r, err, "truncated: a section is said to end beyond the end "
                 "of the file");
  else if (position && (uint64_t)position <= start)
    st = fail_at(r, err, "a section is said to end before it begins");
  *next = position > 0 ? (size_t)position : 0;
done:
  return st;
}

static vg_status read_binary(struct reader *r, struct vg_error *err)
{
  int32_t code, v;
  size_t next;
  vg_status st;

  r->binary = 1;
  r->in->at = 4;
  VG_TRY(vg_input_i32(r->in, 1, &v, "the version", err));
  VG_TRY(set_head(r, v ? v : -1, 0, err));
  do {
    size_t start = r->in->at;

    VG_TRY(vg_input_i32(r->in, 1, &code, "a keyword", err));
    VG_TRY(read_position(r, start, &next, err));
    if (code == CODE_VERTICES) {
      VG_TRY(read_section(r, err));
    } else if (code == CODE_DIMENSION) {
      VG_TRY(vg_input_i32(r->in, 1, &v, "the dimension", err));
      VG_TRY(set_head(r, 0, v ? v : -1, err));
    }
    if (next) r->in->at = next;
  } while (next && next < r->in->size && code != CODE_END);
done:
  return st;
}

vg_status vg_sol_parse(struct vg_input *in, size_t *n, double **value,
                       struct vg_error *err)
{
  const unsigned char mark[2][4] = { { 1, 0, 0, 0 }, { 0, 0, 0, 1 } };
  struct reader r = { .in = in };
  vg_status st;

  if (in->size >= 4 && !memcmp(in->data, mark[0], 4)) {
    vg_input_order(in, 0);
    st = read_binary(&r, err);
  } else if (in->size >= 4 && !memcmp(in->data, mark[1], 4)) {
    vg_input_order(in, 1);
    st = read_binary(&r, err);
  } else {
    st = read_text(&r, err);
  }
  if (st >= 0 && !r.value)
    st = vg_fail(err, VG_ERR_FORMAT, "%s: there is no SolAtVertices in it",
                 in->path);
  if (st < 0) {
    free(r.value);
    return st;
  }
  *n = r.n;
  *value = r.value;
  return VG_OK;
}

vg_status vg_sol_read(const char *path, size_t *n, double **value,
                      struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st >= 0) st = vg_sol_parse(&in, n, value, err);
  vg_input_release(&in);
  return st;
}
