/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/gmf.h"

#include <assert.h>

vg_status vg_gmf_fail(const struct vg_gmf *g, struct vg_error *err,
                      const char *text)
{
  if (!g->binary) return vg_input_fail(g->in, err, "%s", text);
  return vg_fail(err, VG_ERR_FORMAT, "%s: %s (near byte %zu)", g->in->path,
                 text, g->in->at);
}

static vg_status set_version(struct vg_gmf *g, int64_t v, struct vg_error *err)
{
  if (v < 1 || v > 4)
    return vg_gmf_fail(g, err,
                       "unknown version: MeshVersionFormatted must be "
                       "1 to 4");
  g->version = (int)v;
  return VG_OK;
}

/* A binary file begins with an int32 of 1 in its own byte order. */
static int is_binary(struct vg_input *in)
{
  for (int big = 0; big < 2; big++) {
    int32_t one = 0;

    vg_input_order(in, big);
    in->at = 0;
    if (vg_input_i32(in, 1, &one, "", NULL) == VG_OK && one == 1) return 1;
  }
  in->at = 0;
  return 0;
}

static vg_status open_text(struct vg_gmf *g, struct vg_error *err)
{
  const char *text;
  size_t len;
  int64_t v;
  vg_status st;

  g->in->comment = '#';
  if (!vg_input_token(g->in, &text, &len) ||
      !vg_token_is(text, len, "MeshVersionFormatted"))
    return vg_gmf_fail(g, err,
                       "not a Medit file: it does not begin with "
                       "'MeshVersionFormatted'");
  st = vg_input_int(g->in, &v, "the version", err);
  return st < 0 ? st : set_version(g, v, err);
}

vg_status vg_gmf_open(struct vg_gmf *g, struct vg_error *err)
{
  int32_t version;
  vg_status st;

  g->version = g->dimension = 0;
  g->binary = is_binary(g->in);
  if (!g->binary && !vg_input_is_text(g->in))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: neither text nor binary Medit: a binary file begins "
                   "with the number 1",
                   g->in->path);
  if (!g->binary) return open_text(g, err);
  st = vg_input_i32(g->in, 1, &version, "the version", err);
  return st < 0 ? st : set_version(g, version, err);
}

vg_status vg_gmf_read_dimension(struct vg_gmf *g, struct vg_error *err)
{
  int64_t v = 0;
  int32_t narrow = 0;
  vg_status st;

  if (g->binary) {
    st = vg_input_i32(g->in, 1, &narrow, "the dimension", err);
    v = narrow;
  } else {
    st = vg_input_int(g->in, &v, "the dimension", err);
  }
  if (st < 0) return st;
  if (v == 2)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: a plane mesh (dimension 2); only three-dimensional "
                   "meshes are read",
                   g->in->path);
  if (v != 3) return vg_gmf_fail(g, err, "the dimension is neither 2 nor 3");
  g->dimension = 3;
  return VG_OK;
}

vg_status vg_gmf_ints(struct vg_gmf *g, size_t n, int64_t *v, const char *what,
                      struct vg_error *err)
{
  int32_t narrow[VG_GMF_INTS];
  vg_status st = VG_OK;

  assert(n <= VG_GMF_INTS && v);
  if (!g->binary) {
    for (size_t k = 0; k < n && st == VG_OK; k++)
      st = vg_input_int(g->in, &v[k], what, err);
    return st;
  }
  if (g->version == 4) return vg_input_i64(g->in, n, v, what, err);
  st = vg_input_i32(g->in, n, narrow, what, err);
  for (size_t k = 0; k < n && st == VG_OK; k++) v[k] = narrow[k];
  return st;
}

vg_status vg_gmf_keyword(struct vg_gmf *g, int32_t *code, size_t *next,
                         struct vg_error *err)
{
  size_t start = g->in->at;
  int64_t position;
  int32_t narrow = 0;
  vg_status st;

  VG_TRY(vg_input_i32(g->in, 1, code, "a keyword", err));
  if (g->version >= 3) {
    VG_TRY(vg_input_i64(g->in, 1, &position, "a position", err));
  } else {
    VG_TRY(vg_input_i32(g->in, 1, &narrow, "a position", err));
    position = narrow;
  }
  /* 0 marks the last keyword */
  if (position && (position < 0 || (uint64_t)position > g->in->size))
    st = vg_gmf_fail(g, err,
                     "truncated: a section ends beyond the end of the file");
  else if (position && (uint64_t)position <= start)
    st = vg_gmf_fail(g, err, "a section ends before it begins");
  *next = position > 0 ? (size_t)position : 0;
done:
  return st;
}
