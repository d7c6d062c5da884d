/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/tri.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/convention.h"

/* Contents of the header, and the layout of a binary file. */
struct layout {
  uint64_t n_point, n_tri;
  int is_big, is_record; /* byte order; Fortran records or a bare stream */
  int real_size;         /* 4 or 8 */
  int has_scalars;       /* .triq: a third number in the header */
};

/* Contents of a file, text or binary. */
struct content {
  struct vg_mesh m;
  int32_t *tag; /* [n_tri] component numbers */
};

static vg_status check_counts(const struct vg_input *in, int64_t n_point,
                              int64_t n_tri, struct layout *l,
                              struct vg_error *err)
{
  if (n_point < 1 || n_tri < 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the header announces %lld vertices and %lld "
                   "triangles: there is no surface in it",
                   in->path, (long long)n_point, (long long)n_tri);
  if (n_point >= UINT32_MAX || n_tri >= UINT32_MAX)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: the header announces %lld vertices and %lld "
                   "triangles, which exceeds 32-bit numbers",
                   in->path, (long long)n_point, (long long)n_tri);
  l->n_point = (uint64_t)n_point;
  l->n_tri = (uint64_t)n_tri;
  return VG_OK;
}

static vg_status allocate(struct content *c, const struct layout *l,
                          struct vg_error *err)
{
  c->m.point = vg_alloc(l->n_point, sizeof *c->m.point);
  c->m.tri = vg_alloc(l->n_tri, sizeof *c->m.tri);
  c->tag = vg_alloc(l->n_tri, sizeof *c->tag);
  if (!c->m.point || !c->m.tri || !c->tag)
    return vg_fail_memory(err, "the surface");
  c->m.n_point = l->n_point;
  c->m.n_tri = l->n_tri;
  return VG_OK;
}

static vg_status index_error(const struct vg_input *in, size_t triangle,
                             int64_t node, const struct layout *l,
                             struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: triangle %zu refers to vertex %lld, which is out of "
                 "range: vertices are numbered 1 to %llu",
                 in->path, triangle + 1, (long long)node,
                 (unsigned long long)l->n_point);
}

/* --- text --- */

static vg_status read_text_header(struct vg_input *in, struct layout *l,
                                  struct vg_error *err)
{
  const char *text;
  size_t len;
  int64_t n_point, n_tri;
  vg_status st;

  VG_TRY(vg_input_int(in, &n_point, "the number of vertices", err));
  VG_TRY(vg_input_int(in, &n_tri, "the number of triangles", err));
  l->has_scalars = vg_input_token_in_line(in, &text, &len);
  VG_TRY(check_counts(in, n_point, n_tri, l, err));
  /* Every number takes a digit and a blank: reject impossible counts before
   * allocating memory for them. */
  VG_TRY(
    vg_input_need(in, 3 * (l->n_point + l->n_tri) - 1, 2, "the numbers", err));
done:
  return st;
}

static vg_status read_text_triangles(struct vg_input *in, struct content *c,
                                     const struct layout *l,
                                     struct vg_error *err)
{
  for (size_t i = 0; i < l->n_tri; i++)
    for (int k = 0; k < 3; k++) {
      int64_t node;
      vg_status st = vg_input_int(in, &node, "a vertex number", err);

      if (st < 0) return st;
      if (node < 1 || (uint64_t)node > l->n_point)
        return index_error(in, i, node, l, err);
      c->m.tri[i][k] = (uint32_t)(node - 1);
    }
  return VG_OK;
}

/* Read components, if the file has any. */
static vg_status read_text_tags(struct vg_input *in, struct content *c,
                                const struct layout *l, struct vg_error *err)
{
  const char *text;
  size_t len;

  for (size_t i = 0; i < l->n_tri; i++) {
    int64_t tag;
    vg_status st;

    if (!i && !vg_input_token(in, &text, &len)) {
      for (size_t j = 0; j < l->n_tri; j++) c->tag[j] = 1;
      return VG_OK;
    }
    if (!i) in->at -= len;
    st = vg_input_int(in, &tag, "a component number", err);
    if (st < 0) return st;
    if (tag < -INT32_MAX || tag > INT32_MAX)
      return vg_input_fail(in, err,
                           "component %lld of triangle %zu exceeds 32 bits",
                           (long long)tag, i + 1);
    c->tag[i] = (int32_t)tag;
  }
  return VG_OK;
}

static vg_status read_text(struct vg_input *in, struct content *c,
                           struct vg_error *err)
{
  struct layout l = { .real_size = 8 };
  vg_status st;

  VG_TRY(read_text_header(in, &l, err));
  VG_TRY(allocate(c, &l, err));
  for (size_t i = 0; i < l.n_point; i++)
    for (int k = 0; k < 3; k++)
      VG_TRY(vg_input_real(in, &c->m.point[i][k], "a coordinate", err));
  VG_TRY(read_text_triangles(in, c, &l, err));
  VG_TRY(read_text_tags(in, c, &l, err));
done:
  return st;
}

/* --- binary --- */

static int64_t peek(struct vg_input *in, size_t at)
{
  int32_t v = -1;

  in->at = at;
  if (in->size < at || vg_input_i32(in, 1, &v, "", NULL) < 0) v = -1;
  in->at = 0;
  return v;
}

/* A Fortran file begins with a record of two or three integers, followed by one
 * of 3 n_point reals. */
static int is_record_file(struct vg_input *in, struct layout *l)
{
  int64_t first = peek(in, 0), n_point = peek(in, 4), reals;

  if ((first != 8 && first != 12) || peek(in, 4 + (size_t)first) != first)
    return 0;
  l->is_record = 1;
  l->has_scalars = first == 12;
  l->n_point = n_point > 0 ? (uint64_t)n_point : 0;
  l->n_tri = peek(in, 8) > 0 ? (uint64_t)peek(in, 8) : 0;
  /* The marker of a record in parts is negative and gives no length. Then the
   * size of the file decides: n_tri is about 2 n_point, so a file of real*4
   * with components is shorter than one of real*8. */
  reals = peek(in, 8 + (size_t)first);
  l->real_size = reals == (int64_t)(24 * l->n_point) ||
                     (reals < 0 && in->size > 24 * l->n_point + 12 * l->n_tri)
                 ? 8
                 : 4;
  return 1;
}

/* Without records only the total size distinguishes the layouts; no two of them
 * have the same size for reasonable counts. */
static int is_stream_file(struct vg_input *in, struct layout *l)
{
  int64_t n[3];

  for (int k = 0; k < 3; k++) n[k] = peek(in, 4 * (size_t)k);
  if (n[0] < 1 || n[1] < 1) return 0;
  l->n_point = (uint64_t)n[0];
  l->n_tri = (uint64_t)n[1];
  for (int real = 4; real <= 8; real += 4) {
    uint64_t reals = 3 * (uint64_t)real * l->n_point;
    uint64_t size = 8 + reals + 12 * l->n_tri;
    uint64_t scalars = n[2] > 0 ? (uint64_t)real * l->n_point : 0, sum;

    l->real_size = real;
    l->has_scalars = 0;
    if (in->size == size || in->size == size + 4 * l->n_tri) return 1;
    l->has_scalars = 1;
    if (n[2] > 0 && !__builtin_mul_overflow(scalars, (uint64_t)n[2], &sum) &&
        in->size == size + 4 + 4 * l->n_tri + sum)
      return 1;
  }
  return 0;
}

static int find_layout(struct vg_input *in, struct layout *l)
{
  for (l->is_big = 1; l->is_big >= 0; l->is_big--) {
    vg_input_order(in, l->is_big);
    if (is_record_file(in, l)) return 1;
  }
  for (l->is_big = 1; l->is_big >= 0; l->is_big--) {
    vg_input_order(in, l->is_big);
    if (is_stream_file(in, l)) return 1;
  }
  return 0;
}

/* Open the next section: a record, or the rest of a file without records. */
static vg_status section(struct vg_input *in, const struct layout *l,
                         struct vg_input *part, const char *what,
                         struct vg_error *err)
{
  if (l->is_record) return vg_input_record(in, part, what, err);
  *part = *in;
  part->is_view = 1;
  return VG_OK;
}

static void section_end(struct vg_input *in, const struct layout *l,
                        const struct vg_input *part)
{
  if (!l->is_record) in->at = part->at;
}

static vg_status read_points(struct vg_input *in, struct content *c,
                             const struct layout *l, struct vg_error *err)
{
  struct vg_input part = VG_INPUT_INIT;
  size_t n = 3 * l->n_point;
  double *x;
  vg_status st;

  VG_TRY(section(in, l, &part, "vertices", err));
  VG_TRY(vg_input_need(&part, n, (size_t)l->real_size, "vertices", err));
  /* Check the size before allocating memory for the triangles. */
  VG_TRY(vg_input_need(in, l->n_tri, 12, "triangles", err));
  VG_TRY(allocate(c, l, err));
  x = c->m.point[0];
  if (l->real_size == 8) st = vg_input_f64(&part, n, x, "vertices", err);
  else st = vg_input_f32(&part, n, x, "vertices", err);
  section_end(in, l, &part);
done:
  return st;
}

static vg_status read_triangles(struct vg_input *in, struct content *c,
                                const struct layout *l, struct vg_error *err)
{
  struct vg_input part = VG_INPUT_INIT;
  vg_status st;

  VG_TRY(section(in, l, &part, "triangles", err));
  VG_TRY(vg_input_need(&part, l->n_tri, 12, "triangles", err));
  for (size_t i = 0; i < l->n_tri; i++) {
    int32_t node[3];

    VG_TRY(vg_input_i32(&part, 3, node, "triangles", err));
    for (int k = 0; k < 3; k++) {
      if (node[k] < 1 || (uint64_t)node[k] > l->n_point)
        return index_error(in, i, node[k], l, err);
      c->m.tri[i][k] = (uint32_t)node[k] - 1;
    }
  }
  section_end(in, l, &part);
done:
  return st;
}

static vg_status read_binary(struct vg_input *in, struct content *c,
                             struct vg_error *err)
{
  struct layout l = { .real_size = 4 };
  struct vg_input part = VG_INPUT_INIT;
  vg_status st;

  if (!find_layout(in, &l))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: neither text nor a binary .tri file: it does not "
                   "begin with a Fortran record of two or three integers, "
                   "and its %zu bytes do not match its counts (truncated, "
                   "or another format)",
                   in->path, in->size);
  VG_TRY(check_counts(in, (int64_t)l.n_point, (int64_t)l.n_tri, &l, err));
  VG_TRY(section(in, &l, &part, "the header", err));
  if (!l.is_record) in->at += l.has_scalars ? 12 : 8;
  VG_TRY(read_points(in, c, &l, err));
  VG_TRY(read_triangles(in, c, &l, err));
  if (!vg_input_left(in)) {
    for (size_t i = 0; i < l.n_tri; i++) c->tag[i] = 1;
    goto done;
  }
  VG_TRY(section(in, &l, &part, "components", err));
  VG_TRY(vg_input_i32(&part, l.n_tri, c->tag, "components", err));
done:
  return st;
}

/* --- both --- */

vg_status vg_tri_parse(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err)
{
  struct content c = { VG_MESH_INIT, NULL };
  vg_status st;

  if (vg_input_is_text(in)) st = read_text(in, &c, err);
  else st = read_binary(in, &c, err);
  if (st == VG_OK) st = vg_check_points(in->path, c.m.n_point, c.m.point, err);
  if (st == VG_OK) st = vg_patches_from_tags(&c.m, c.tag, err);
  if (st == VG_OK) vg_mesh_move(out, &c.m);
  vg_mesh_release(&c.m);
  free(c.tag);
  return st;
}

vg_status vg_tri_read(const char *path, struct vg_mesh *out,
                      struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st == VG_OK) st = vg_tri_parse(&in, out, err);
  vg_input_release(&in);
  return st;
}

/* --- writing --- */

/* Triangle j of the boundary when quadrilaterals are split along 0-2. */
static void get_triangle(const struct vg_mesh *m, size_t j, uint32_t node[3],
                         int32_t *id)
{
  const uint32_t *quad;
  size_t i = j - m->n_tri;

  if (j < m->n_tri) {
    memcpy(node, m->tri[j], 3 * sizeof *node);
    *id = m->patch[m->tri_patch[j]].id;
    return;
  }
  quad = m->quad[i / 2];
  node[0] = quad[0];
  node[1] = quad[1 + i % 2];
  node[2] = quad[2 + i % 2];
  *id = m->patch[m->quad_patch[i / 2]].id;
}

static void put_numbers(struct vg_output *o, const int32_t *v, int n)
{
  for (int k = 0; k < n; k++) {
    if (k) vg_output_text(o, " ");
    vg_output_int(o, v[k]);
  }
  vg_output_text(o, "\n");
}

/* Node numbers are written as int32, so both counts must fit. */
static vg_status count(const char *path, const struct vg_mesh *m, size_t *n,
                       struct vg_error *err)
{
  *n = m->n_tri + 2 * m->n_quad;
  if (*n <= INT32_MAX && m->n_point <= INT32_MAX) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: %zu points and %zu triangles exceed the 32-bit "
                 "numbers of a .tri; write another format",
                 path, m->n_point, *n);
}

vg_status vg_tri_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err)
{
  struct vg_output o = VG_OUTPUT_INIT;
  uint32_t node[3];
  int32_t v[3], id;
  size_t n;
  vg_status st;

  VG_TRY(count(path, m, &n, err));
  VG_TRY(vg_output_open(path, &o, err));
  vg_output_format(&o, "%zu %zu\n", m->n_point, n);
  for (size_t i = 0; i < m->n_point; i++)
    for (int k = 0; k < 3; k++) {
      vg_output_real(&o, m->point[i][k]);
      vg_output_text(&o, k < 2 ? " " : "\n");
    }
  for (size_t i = 0; i < n; i++) {
    get_triangle(m, i, node, &id);
    for (int k = 0; k < 3; k++) v[k] = (int32_t)node[k] + 1;
    put_numbers(&o, v, 3);
  }
  for (size_t i = 0; i < n; i++) {
    get_triangle(m, i, node, &id);
    put_numbers(&o, &id, 1);
  }
  st = vg_output_commit(&o, err);
done:
  vg_output_release(&o);
  return st;
}

vg_status vg_tri_write_binary(const char *path, const struct vg_mesh *m,
                              int little, int real_size, struct vg_error *err)
{
  struct vg_output o = VG_OUTPUT_INIT;
  uint32_t node[3];
  int32_t v[3], id;
  size_t n;
  vg_status st;

  assert(real_size == 4 || real_size == 8);
  VG_TRY(count(path, m, &n, err));
  VG_TRY(vg_output_open(path, &o, err));
  vg_output_order(&o, !little);
  v[0] = (int32_t)m->n_point;
  v[1] = (int32_t)n;
  vg_output_record(&o, 8);
  vg_output_i32(&o, 2, v);
  vg_output_record_end(&o);
  vg_output_record(&o, 3 * (uint64_t)m->n_point * (real_size == 8 ? 8 : 4));
  if (m->n_point && real_size == 8)
    vg_output_f64(&o, 3 * m->n_point, m->point[0]);
  else if (m->n_point) vg_output_f32(&o, 3 * m->n_point, m->point[0]);
  vg_output_record_end(&o);
  vg_output_record(&o, 12 * (uint64_t)n);
  for (size_t i = 0; i < n; i++) {
    get_triangle(m, i, node, &id);
    for (int k = 0; k < 3; k++) v[k] = (int32_t)node[k] + 1;
    vg_output_i32(&o, 3, v);
  }
  vg_output_record_end(&o);
  vg_output_record(&o, 4 * (uint64_t)n);
  for (size_t i = 0; i < n; i++) {
    get_triangle(m, i, node, &id);
    vg_output_i32(&o, 1, &id);
  }
  vg_output_record_end(&o);
  st = vg_output_commit(&o, err);
done:
  vg_output_release(&o);
  return st;
}
