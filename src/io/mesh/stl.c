/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/stl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/geometry/vector.h"
#include "io/stream/boundary.h"
#include "io/stream/convention.h"
#include "io/stream/soup.h"

#define HEADER 84
#define FACET 50

static uint32_t little32(const unsigned char *b)
{
  return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 |
         (uint32_t)b[3] << 24;
}

/* --- binary --- */

static vg_status read_binary(struct vg_input *in, uint32_t n, struct vg_soup *s,
                             struct vg_error *err)
{
  uint32_t patch, node[3];
  vg_status st = vg_soup_patch(s, "", 0, &patch, err);

  vg_input_order(in, 0);
  in->at = HEADER;
  for (uint32_t i = 0; i < n && st == VG_OK; i++) {
    double v[12];

    st = vg_input_f32(in, 12, v, "facets", err);
    for (int k = 3; k < 12 && st == VG_OK; k++)
      if (!isfinite(v[k]))
        st = vg_fail(err, VG_ERR_INPUT,
                     "%s: facet %lu, vertex %d: a coordinate is not a finite "
                     "number; export the surface again",
                     in->path, (unsigned long)i + 1, k / 3);
    for (int k = 0; k < 3 && st == VG_OK; k++)
      st = vg_soup_weld(s, v + 3 + 3 * k, &node[k], err);
    if (st == VG_OK) st = vg_soup_triangle(s, node, patch, err);
    if (st == VG_OK) st = vg_input_skip(in, 2, "facets", err);
  }
  return st;
}

/* --- text --- */

/* Some programs write keywords in capital letters. */
static int is_word(const char *text, size_t len, const char *word)
{
  if (strlen(word) != len) return 0;
  for (size_t i = 0; i < len; i++) {
    char c = text[i];

    if (c >= 'A' && c <= 'Z') c = (char)(c - 'A' + 'a');
    if (c != word[i]) return 0;
  }
  return 1;
}

static vg_status expect(struct vg_input *in, const char *word,
                        struct vg_error *err)
{
  const char *text;
  size_t len;

  if (!vg_input_token(in, &text, &len))
    return vg_input_fail(in, err,
                         "truncated: the file ends where '%s' was expected",
                         word);
  if (is_word(text, len, word)) return VG_OK;
  if (is_word(text, len, "vertex"))
    return vg_input_fail(in, err,
                         "a facet has more than three vertices, but STL "
                         "holds triangles only");
  return vg_input_fail(in, err, "expected '%s', not '%.*s'", word,
                       (int)(len < 40 ? len : 40), text);
}

/* Read the facet after its keyword. The three numbers of the normal are
 * skipped: where a normal is needed it is recomputed, and files with "nan" for
 * a facet without area are common. */
static vg_status read_facet(struct vg_input *in, struct vg_soup *s,
                            uint32_t patch, struct vg_error *err)
{
  const char *text;
  size_t len;
  uint32_t node[3];
  vg_status st = VG_OK;

  VG_TRY(expect(in, "normal", err));
  for (int k = 0; k < 3; k++)
    if (!vg_input_token(in, &text, &len))
      return vg_input_fail(in, err, "truncated: the file ends within a normal");
  VG_TRY(expect(in, "outer", err));
  VG_TRY(expect(in, "loop", err));
  for (int k = 0; k < 3; k++) {
    double x[3];

    VG_TRY(expect(in, "vertex", err));
    for (int j = 0; j < 3; j++)
      VG_TRY(vg_input_real(in, &x[j], "a coordinate", err));
    VG_TRY(vg_soup_weld(s, x, &node[k], err));
  }
  VG_TRY(expect(in, "endloop", err));
  VG_TRY(expect(in, "endfacet", err));
  st = vg_soup_triangle(s, node, patch, err);
done:
  return st;
}

/* Read the solid after its keyword. A solid without facets does not become a
 * patch. */
static vg_status read_solid(struct vg_input *in, struct vg_soup *s,
                            struct vg_error *err)
{
  const char *name = "", *text;
  size_t name_len = 0, len;
  uint32_t patch = UINT32_MAX;
  vg_status st = VG_OK;

  vg_input_line(in, &name, &name_len);
  while (vg_input_token(in, &text, &len)) {
    if (is_word(text, len, "endsolid")) {
      vg_input_line(in, &text, &len);
      return VG_OK;
    }
    if (!is_word(text, len, "facet"))
      return vg_input_fail(in, err,
                           "expected 'facet' or 'endsolid', not '%.*s'",
                           (int)(len < 40 ? len : 40), text);
    if (patch == UINT32_MAX)
      VG_TRY(vg_soup_patch(s, name, name_len, &patch, err));
    VG_TRY(read_facet(in, s, patch, err));
  }
  return vg_input_fail(in, err,
                       "truncated: the file ends before 'endsolid'; export "
                       "the surface again");
done:
  return st;
}

static vg_status read_text(struct vg_input *in, struct vg_soup *s,
                           struct vg_error *err)
{
  const char *text;
  size_t len;
  vg_status st = VG_OK;

  while (st == VG_OK && vg_input_token(in, &text, &len)) {
    if (!is_word(text, len, "solid"))
      return vg_input_fail(in, err, "expected 'solid', not '%.*s'",
                           (int)(len < 40 ? len : 40), text);
    st = read_solid(in, s, err);
  }
  return st;
}

/* --- both --- */

vg_status vg_stl_parse(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err)
{
  struct vg_soup s = VG_SOUP_INIT;
  uint32_t n = in->size >= HEADER ? little32(in->data + HEADER - 4) : 0;
  vg_status st;

  if (in->size >= HEADER && in->size == HEADER + (uint64_t)FACET * n)
    st = read_binary(in, n, &s, err);
  else if (vg_input_is_text(in)) st = read_text(in, &s, err);
  else
    st = vg_fail(err, VG_ERR_FORMAT,
                 "%s: neither text nor binary STL: its %zu bytes are not 84 "
                 "+ 50 x %lu, the number of facets in its header "
                 "(truncated, or another format)",
                 in->path, in->size, (unsigned long)n);
  if (st == VG_OK && !s.m.n_tri)
    st = vg_fail(err, VG_ERR_INPUT, "%s: the surface has no facets", in->path);
  if (st == VG_OK) st = vg_check_points(in->path, s.m.n_point, s.m.point, err);
  if (st == VG_OK) vg_soup_finish(&s, out);
  vg_soup_release(&s);
  return st;
}

vg_status vg_stl_read(const char *path, struct vg_mesh *out,
                      struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st == VG_OK) st = vg_stl_parse(&in, out, err);
  vg_input_release(&in);
  return st;
}

/* --- writing --- */

/* Unit normal to six decimals, which is more than any reader uses; zero for a
 * triangle without area, as the format requires. */
static void normal_of(const double *a, const double *b, const double *c,
                      double normal[3])
{
  double u[3], v[3], size = 0, length;

  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    size = fmax(size, fmax(fabs(u[k]), fabs(v[k])));
  }
  for (int k = 0; k < 3 && size > 0; k++) {
    u[k] /= size;
    v[k] /= size;
  }
  vg_cross(u, v, normal);
  length = vg_norm(normal);
  for (int k = 0; k < 3; k++)
    normal[k] = length > 0 ? floor(1e6 * normal[k] / length + 0.5) / 1e6 : 0;
}

static void put_facet(struct vg_output *o, const struct vg_mesh *m, uint32_t a,
                      uint32_t b, uint32_t c, int binary)
{
  const double *p[3] = { m->point[a], m->point[b], m->point[c] };
  double normal[3];

  normal_of(p[0], p[1], p[2], normal);
  if (binary) {
    vg_output_f32(o, 3, normal);
    for (int k = 0; k < 3; k++) vg_output_f32(o, 3, p[k]);
    vg_output_bytes(o, "\0", 2);
    return;
  }
  vg_output_text(o, " facet normal");
  for (int k = 0; k < 3; k++) {
    vg_output_text(o, " ");
    vg_output_real(o, normal[k]);
  }
  vg_output_text(o, "\n  outer loop\n");
  for (int k = 0; k < 3; k++) {
    vg_output_text(o, "   vertex");
    for (int j = 0; j < 3; j++) {
      vg_output_text(o, " ");
      vg_output_real(o, p[k][j]);
    }
    vg_output_text(o, "\n");
  }
  vg_output_text(o, "  endloop\n endfacet\n");
}

/* Write face i of the boundary: triangles come first, then quadrilaterals,
 * which are split in two. */
static void put_face(struct vg_output *o, const struct vg_mesh *m, size_t i,
                     int binary)
{
  const uint32_t *f;

  if (i < m->n_tri) {
    f = m->tri[i];
    put_facet(o, m, f[0], f[1], f[2], binary);
    return;
  }
  f = m->quad[i - m->n_tri];
  put_facet(o, m, f[0], f[1], f[2], binary);
  put_facet(o, m, f[0], f[2], f[3], binary);
}

vg_status vg_stl_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err)
{
  struct vg_output o = VG_OUTPUT_INIT;
  size_t *start = NULL, *order = NULL;
  vg_status st;

  VG_TRY(vg_boundary_by_patch(m, &start, &order, err));
  VG_TRY(vg_output_open(path, &o, err));
  for (size_t p = 0; p < m->n_patch; p++) {
    const char *name = m->patch[p].name;

    if (start[p] == start[p + 1]) continue;
    vg_output_format(&o, "solid%s%s\n", *name ? " " : "", name);
    for (size_t i = start[p]; i < start[p + 1]; i++)
      put_face(&o, m, order[i], 0);
    vg_output_format(&o, "endsolid%s%s\n", *name ? " " : "", name);
  }
  st = vg_output_commit(&o, err);
done:
  vg_output_release(&o);
  free(start);
  free(order);
  return st;
}

vg_status vg_stl_write_binary(const char *path, const struct vg_mesh *m,
                              struct vg_error *err)
{
  static const char header[80] = "binary STL written by vanguard";
  struct vg_output o = VG_OUTPUT_INIT;
  uint64_t n = (uint64_t)m->n_tri + 2 * (uint64_t)m->n_quad;
  int32_t count = (int32_t)(uint32_t)n;
  vg_status st;

  if (n > UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: %llu facets exceed the limit of binary STL; write "
                   "another format",
                   path, (unsigned long long)n);
  VG_TRY(vg_output_open(path, &o, err));
  vg_output_order(&o, 0);
  vg_output_bytes(&o, header, sizeof header);
  vg_output_i32(&o, 1, &count);
  for (size_t i = 0; i < m->n_tri + m->n_quad; i++) put_face(&o, m, i, 1);
  st = vg_output_commit(&o, err);
done:
  vg_output_release(&o);
  return st;
}
