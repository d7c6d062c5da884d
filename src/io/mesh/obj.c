/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/obj.h"

#include <stdlib.h>
#include <string.h>

#include "io/stream/boundary.h"
#include "io/stream/convention.h"
#include "io/stream/soup.h"

struct reader {
  struct vg_input *in;
  struct vg_soup s;
  const char *name; /* current group; points into the input */
  size_t name_len;
  uint32_t patch; /* patch of the group; UINT32_MAX: the group has no face
                     yet */
  /* A face may refer to a vertex that follows later, so the highest number is
   * checked at the end. `highest_line` is the line that contains it. */
  uint64_t highest;
  size_t highest_line;
};

/* Next token of a line, which may be continued by a backslash at its end. */
static int next_token(struct vg_input *in, const char **text, size_t *len)
{
  while (vg_input_token_in_line(in, text, len)) {
    if (!vg_token_is(*text, *len, "\\")) return 1;
    vg_input_line(in, text, len);
  }
  return 0;
}

static vg_status read_vertex(struct reader *r, struct vg_error *err)
{
  double x[3];
  uint32_t at;

  for (int k = 0; k < 3; k++) {
    const char *text = "";
    size_t len = 0;

    if (!next_token(r->in, &text, &len) || !vg_parse_real(text, len, &x[k]))
      return vg_input_fail(r->in, err,
                           "vertex %zu needs three finite coordinates, but "
                           "'%.*s' is not one",
                           r->s.m.n_point + 1, (int)(len < 40 ? len : 40),
                           text);
  }
  return vg_soup_point(&r->s, x, &at, err);
}

/* Read the vertex of a corner "a", "a/t", "a//n" or "a/t/n", 0-based. */
static vg_status read_corner(struct reader *r, const char *text, size_t len,
                             uint32_t *node, struct vg_error *err)
{
  const char *slash = memchr(text, '/', len);
  int64_t v;

  if (!vg_parse_int(text, slash ? (size_t)(slash - text) : len, &v) || !v)
    return vg_input_fail(r->in, err, "expected a vertex number, not '%.*s'",
                         (int)(len < 40 ? len : 40), text);
  if (v < 0) v += (int64_t)r->s.m.n_point + 1;
  if (v < 1 || v >= UINT32_MAX)
    return vg_input_fail(r->in, err,
                         "vertex %.*s is out of range: there are %zu so far",
                         (int)(len < 40 ? len : 40), text, r->s.m.n_point);
  if ((uint64_t)v > r->highest) {
    r->highest = (uint64_t)v;
    r->highest_line = r->in->line;
  }
  *node = (uint32_t)(v - 1);
  return VG_OK;
}

static vg_status read_face(struct reader *r, struct vg_error *err)
{
  uint32_t tri[3] = { 0, 0, 0 };
  size_t n = 0, len;
  const char *text;
  vg_status st = VG_OK;

  if (r->patch == UINT32_MAX)
    VG_TRY(vg_soup_named_patch(&r->s, r->name, r->name_len, &r->patch, err));
  for (; next_token(r->in, &text, &len); n++) {
    uint32_t node = 0;

    VG_TRY(read_corner(r, text, len, &node, err));
    if (n > 1) {
      tri[1] = tri[2];
      tri[2] = node;
      VG_TRY(vg_soup_triangle(&r->s, tri, r->patch, err));
    } else {
      tri[n ? 2 : 0] = node;
    }
  }
  if (n < 3)
    st = vg_input_fail(r->in, err,
                       "a face needs three or more corners, not %zu", n);
done:
  return st;
}

static vg_status read_lines(struct reader *r, struct vg_error *err)
{
  struct vg_input *in = r->in;
  const char *text;
  size_t len;
  vg_status st = VG_OK;

  while (st == VG_OK && vg_input_token(in, &text, &len)) {
    if (vg_token_is(text, len, "v")) st = read_vertex(r, err);
    else if (vg_token_is(text, len, "f")) st = read_face(r, err);
    if (st == VG_OK &&
        (vg_token_is(text, len, "g") || vg_token_is(text, len, "o"))) {
      r->name = "";
      r->name_len = 0;
      r->patch = UINT32_MAX;
      vg_input_line(in, &r->name, &r->name_len);
    } else if (st == VG_OK) {
      vg_input_line(in, &text, &len);
    }
  }
  return st;
}

vg_status vg_obj_parse(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err)
{
  struct reader r = { .in = in, .name = "", .patch = UINT32_MAX };
  vg_status st = VG_OK;

  if (!vg_input_is_text(in))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: binary data, but OBJ is a text format; check the "
                   "suffix",
                   in->path);
  in->comment = '#';
  VG_TRY(read_lines(&r, err));
  if (r.highest > r.s.m.n_point)
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s:%zu: vertex %llu is out of range: the file has %zu",
                 in->path, r.highest_line, (unsigned long long)r.highest,
                 r.s.m.n_point);
  else if (!r.s.m.n_tri)
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: no faces ('f' lines): not a surface in OBJ format",
                 in->path);
  else st = vg_check_points(in->path, r.s.m.n_point, r.s.m.point, err);
  if (st == VG_OK) vg_soup_finish(&r.s, out);
done:
  vg_soup_release(&r.s);
  return st;
}

vg_status vg_obj_read(const char *path, struct vg_mesh *out,
                      struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st == VG_OK) st = vg_obj_parse(&in, out, err);
  vg_input_release(&in);
  return st;
}

/* --- writing --- */

static void put_face(struct vg_output *o, const struct vg_mesh *m, size_t i)
{
  const uint32_t *f = i < m->n_tri ? m->tri[i] : m->quad[i - m->n_tri];

  vg_output_text(o, "f");
  for (int k = 0; k < (i < m->n_tri ? 3 : 4); k++) {
    vg_output_text(o, " ");
    vg_output_int(o, (int64_t)f[k] + 1);
  }
  vg_output_text(o, "\n");
}

vg_status vg_obj_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err)
{
  struct vg_output o = VG_OUTPUT_INIT;
  size_t *start = NULL, *order = NULL;
  vg_status st;

  VG_TRY(vg_boundary_by_patch(m, &start, &order, err));
  VG_TRY(vg_output_open(path, &o, err));
  for (size_t i = 0; i < m->n_point; i++) {
    vg_output_text(&o, "v");
    for (int k = 0; k < 3; k++) {
      vg_output_text(&o, " ");
      vg_output_real(&o, m->point[i][k]);
    }
    vg_output_text(&o, "\n");
  }
  for (size_t p = 0; p < m->n_patch; p++) {
    if (start[p] == start[p + 1]) continue;
    if (*m->patch[p].name) vg_output_format(&o, "g %s\n", m->patch[p].name);
    else vg_output_format(&o, "g patch_%d\n", (int)m->patch[p].id);
    for (size_t i = start[p]; i < start[p + 1]; i++) put_face(&o, m, order[i]);
  }
  st = vg_output_commit(&o, err);
done:
  vg_output_release(&o);
  free(start);
  free(order);
  return st;
}
