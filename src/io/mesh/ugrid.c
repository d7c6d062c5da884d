/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reader and writer of the UGRID family; see io/mesh/ugrid.h and formats.md
 * 2. */
#include "io/mesh/ugrid.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "io/mesh/ugrid_put.h"

#define BLOCK 3072 /* a multiple of 3 and 4 */

static const struct {
  const char *name;
  struct vg_ugrid_kind kind;
} kinds[] = {
  { "b8", { 0, 4, 8, 0, 1 } },  { "lb8", { 0, 4, 8, 0, 0 } },
  { "b4", { 0, 4, 4, 0, 1 } },  { "lb4", { 0, 4, 4, 0, 0 } },
  { "r8", { 0, 4, 8, 1, 1 } },  { "lr8", { 0, 4, 8, 1, 0 } },
  { "r4", { 0, 4, 4, 1, 1 } },  { "lr4", { 0, 4, 4, 1, 0 } },
  { "b8l", { 0, 8, 8, 0, 1 } }, { "lb8l", { 0, 8, 8, 0, 0 } },
};
#define N_KIND (sizeof kinds / sizeof kinds[0])

const int vg_ugrid_width[6] = { 3, 4, 4, 5, 6, 8 };
const char *const vg_ugrid_element[6] = { "triangle",    "quadrilateral",
                                          "tetrahedron", "pyramid",
                                          "prism",       "hexahedron" };

/* Start of the last part of a name that ends at `end`: the position after the
 * preceding dot or slash. */
static size_t last_part(const char *name, size_t end)
{
  while (end && name[end - 1] != '.' && name[end - 1] != '/') end--;
  return end;
}

static int part_is(const char *part, size_t len, const char *s)
{
  return strlen(s) == len && !strncasecmp(part, s, len);
}

int vg_ugrid_kind(const char *name, struct vg_ugrid_kind *kind)
{
  static const struct vg_ugrid_kind text = { 1, 8, 8, 0, 0 };
  size_t end = strlen(name), at = last_part(name, end);
  int is_long;

  if (part_is(name + at, end - at, "gz") && at) {
    end = at - 1;
    at = last_part(name, end);
  }
  is_long = part_is(name + at, end - at, "ugrid64");
  if (!is_long && !part_is(name + at, end - at, "ugrid")) return 0;
  *kind = text;
  if (!at) return !is_long;
  end = at - 1;
  at = last_part(name, end);
  for (size_t i = 0; i < N_KIND; i++)
    if (part_is(name + at, end - at, kinds[i].name)) {
      *kind = kinds[i].kind;
      if (is_long) kind->int_size = 8;
      return !is_long || !kind->is_record;
    }
  return !is_long;
}

/* --- does the content match a kind? --- */

uint64_t vg_ugrid_nodes_at(const struct vg_ugrid_kind *kind,
                           const uint64_t count[7], int element)
{
  uint64_t n_int = element > 1 ? count[1] + count[2] : 0;

  for (int k = 0; k < element; k++)
    n_int += count[k + 1] * (uint64_t)vg_ugrid_width[k];
  return 3 * (uint64_t)kind->real_size * count[0] +
         n_int * (uint64_t)kind->int_size;
}

/* Bytes after the header; UINT64_MAX if the counts are impossible. */
static uint64_t body_bytes(const struct vg_ugrid_kind *kind,
                           const uint64_t count[7])
{
  for (int k = 0; k < 7; k++)
    if (count[k] > UINT32_MAX - 2) return UINT64_MAX;
  return vg_ugrid_nodes_at(kind, count, 6);
}

static uint64_t marker_bytes(const struct vg_ugrid_kind *kind, uint64_t body)
{
  if (!kind->is_record) return 0;
  return 8 + vg_record_size(body, VG_RECORD_LIMIT) - body;
}

int vg_ugrid_counts(const struct vg_input *file,
                    const struct vg_ugrid_kind *kind, uint64_t count[7])
{
  struct vg_input in = *file;
  int32_t narrow[7];
  int64_t wide[7];

  in.at = 0;
  vg_input_order(&in, kind->is_big);
  if (kind->is_record) {
    if (vg_input_i32(&in, 1, narrow, "header", NULL) < 0 ||
        narrow[0] != 7 * kind->int_size)
      return 0;
  }
  if (kind->int_size == 8) {
    if (vg_input_i64(&in, 7, wide, "header", NULL) < 0) return 0;
    for (int k = 0; k < 7; k++) count[k] = (uint64_t)wide[k];
  } else {
    if (vg_input_i32(&in, 7, narrow, "header", NULL) < 0) return 0;
    for (int k = 0; k < 7; k++) count[k] = (uint64_t)(int64_t)narrow[k];
  }
  return 1;
}

/* Does the file match this kind? 2: yes, and nothing follows; 1: yes, but more
 * data follow; 0: no. A file without points and faces matches no kind, since
 * zeros are the same in any byte order. */
static int fits(const struct vg_input *in, const struct vg_ugrid_kind *kind)
{
  uint64_t count[7], body, need;

  if (!vg_ugrid_counts(in, kind, count) || !count[0]) return 0;
  body = body_bytes(kind, count);
  if (body == UINT64_MAX) return 0;
  need = 7 * (uint64_t)kind->int_size + body + marker_bytes(kind, body);
  return need > in->size ? 0 : need == in->size ? 2 : 1;
}

static const char *kind_name(const struct vg_ugrid_kind *kind)
{
  for (size_t i = 0; i < N_KIND; i++)
    if (!memcmp(kind, &kinds[i].kind, sizeof *kind)) return kinds[i].name;
  return "ASCII";
}

static const char *order_name(const struct vg_ugrid_kind *kind)
{
  return kind->is_big ? "big-endian" : "little-endian";
}

static vg_status other_kind(const struct vg_input *in,
                            const struct vg_ugrid_kind *kind,
                            const struct vg_ugrid_kind *found,
                            struct vg_error *err)
{
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: is named as %s, %d-byte integers, %d-byte reals%s, but "
                 "looks %s with %d-byte integers, %d-byte reals%s; rename it "
                 "to .%s.ugrid",
                 in->path, order_name(kind), kind->int_size, kind->real_size,
                 kind->is_record ? ", Fortran records" : "", order_name(found),
                 found->int_size, found->real_size,
                 found->is_record ? ", Fortran records" : "", kind_name(found));
}

static vg_status not_fitting(const struct vg_input *in,
                             const struct vg_ugrid_kind *kind,
                             struct vg_error *err)
{
  uint64_t c[7];

  if (vg_input_is_text(in))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: is named as a binary .%s.ugrid but holds text; "
                   "rename it to .ugrid if it is an ASCII UGRID",
                   in->path, kind_name(kind));
  if (!vg_ugrid_counts(in, kind, c))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: there is no %s.ugrid header: the file has %zu "
                   "bytes%s",
                   in->path, kind_name(kind), in->size,
                   kind->is_record ? " or its first Fortran marker is not "
                                     "the length of a header"
                                   : "");
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: truncated, or not a .%s.ugrid: the header announces "
                 "%lld points, %lld triangles, %lld quadrilaterals, %lld "
                 "tetrahedra, %lld pyramids, %lld prisms, %lld hexahedra, "
                 "which %zu bytes cannot hold",
                 in->path, kind_name(kind), (long long)c[0], (long long)c[1],
                 (long long)c[2], (long long)c[3], (long long)c[4],
                 (long long)c[5], (long long)c[6], in->size);
}

vg_status vg_ugrid_check_kind(const struct vg_input *in,
                              const struct vg_ugrid_kind *kind,
                              struct vg_error *err)
{
  int fit = fits(in, kind), loose = -1;

  if (fit == 2) return VG_OK;
  for (size_t i = 0; i < N_KIND; i++) {
    int other = fits(in, &kinds[i].kind);

    if (other == 2) return other_kind(in, kind, &kinds[i].kind, err);
    if (other && loose < 0) loose = (int)i;
  }
  if (fit) return VG_OK;
  if (loose >= 0) return other_kind(in, kind, &kinds[loose].kind, err);
  return not_fitting(in, kind, err);
}

/* --- reading --- */

static vg_status make_room(struct vg_mesh *m, const uint64_t count[7],
                           int32_t **tag, struct vg_error *err)
{
  m->n_point = count[0];
  m->n_tri = count[1];
  m->n_quad = count[2];
  m->n_tet = count[3];
  m->n_pyr = count[4];
  m->n_pri = count[5];
  m->n_hex = count[6];
  m->point = vg_alloc(m->n_point, sizeof *m->point);
  m->tri = vg_alloc(m->n_tri, sizeof *m->tri);
  m->quad = vg_alloc(m->n_quad, sizeof *m->quad);
  m->tet = vg_alloc(m->n_tet, sizeof *m->tet);
  m->pyr = vg_alloc(m->n_pyr, sizeof *m->pyr);
  m->pri = vg_alloc(m->n_pri, sizeof *m->pri);
  m->hex = vg_alloc(m->n_hex, sizeof *m->hex);
  *tag = vg_alloc(m->n_tri + m->n_quad, sizeof **tag);
  if (m->point && m->tri && m->quad && m->tet && m->pyr && m->pri && m->hex &&
      *tag)
    return VG_OK;
  return vg_fail_memory(err, "the mesh of a .ugrid file");
}

static uint32_t *nodes_of(const struct vg_mesh *m, int element)
{
  uint32_t *const list[6] = { (uint32_t *)m->tri, (uint32_t *)m->quad,
                              (uint32_t *)m->tet, (uint32_t *)m->pyr,
                              (uint32_t *)m->pri, (uint32_t *)m->hex };

  return list[element];
}

static size_t count_of(const struct vg_mesh *m, int element)
{
  const size_t list[6] = { m->n_tri, m->n_quad, m->n_tet,
                           m->n_pyr, m->n_pri,  m->n_hex };

  return list[element];
}

vg_status vg_ugrid_ints(struct vg_input *in, int int_size, size_t n, int32_t *v,
                        int32_t odd, const char *what, struct vg_error *err)
{
  int64_t block[BLOCK];

  if (int_size == 4) return vg_input_i32(in, n, v, what, err);
  for (size_t i = 0, m; i < n; i += m) {
    vg_status st;

    m = n - i < BLOCK ? n - i : BLOCK;
    st = vg_input_i64(in, m, block, what, err);
    if (st < 0) return st;
    for (size_t k = 0; k < m; k++)
      v[i + k] = block[k] < INT32_MIN || block[k] > INT32_MAX
                 ? odd
                 : (int32_t)block[k];
  }
  return VG_OK;
}

static vg_status read_nodes(struct vg_input *in,
                            const struct vg_ugrid_kind *kind, struct vg_mesh *m,
                            int element, struct vg_error *err)
{
  size_t n = count_of(m, element);
  int width = vg_ugrid_width[element];
  uint32_t *node = nodes_of(m, element);
  vg_status st = vg_ugrid_ints(in, kind->int_size, n * (size_t)width,
                               (int32_t *)node, 0, vg_ugrid_element[element],
                               err);

  if (st < 0) return st;
  return vg_index_from_file(in->path, vg_ugrid_element[element], n, width,
                            m->n_point, node, err);
}

static vg_status read_body(struct vg_input *in,
                           const struct vg_ugrid_kind *kind, struct vg_mesh *m,
                           int32_t *tag, struct vg_error *err)
{
  size_t n_real = 3 * m->n_point;
  vg_status st = kind->real_size == 8
                 ? vg_input_f64(in, n_real, (double *)m->point, "points", err)
                 : vg_input_f32(in, n_real, (double *)m->point, "points", err);

  if (st == VG_OK) st = read_nodes(in, kind, m, 0, err);
  if (st == VG_OK) st = read_nodes(in, kind, m, 1, err);
  if (st == VG_OK)
    st = vg_ugrid_ints(in, kind->int_size, m->n_tri + m->n_quad, tag, INT32_MAX,
                       "surface tags", err);
  for (int e = 2; e < 6 && st == VG_OK; e++)
    st = read_nodes(in, kind, m, e, err);
  return st;
}

static vg_status read_binary(struct vg_input *in,
                             const struct vg_ugrid_kind *kind,
                             struct vg_mesh *m, int32_t **tag,
                             struct vg_error *err)
{
  struct vg_input body;
  uint64_t count[7];
  vg_status st = vg_ugrid_check_kind(in, kind, err);

  if (st < 0) return st;
  if (!vg_ugrid_counts(in, kind, count)) return not_fitting(in, kind, err);
  st = make_room(m, count, tag, err);
  if (st < 0) return st;
  in->at = 0;
  vg_input_order(in, kind->is_big);
  if (!kind->is_record) {
    in->at = 7 * (size_t)kind->int_size;
    return read_body(in, kind, m, *tag, err);
  }
  st = vg_input_record(in, &body, "the header", err);
  if (st == VG_OK) st = vg_input_record(in, &body, "the mesh", err);
  return st < 0 ? st : read_body(&body, kind, m, *tag, err);
}

static vg_status text_header(struct vg_input *in, uint64_t count[7],
                             struct vg_error *err)
{
  static const char *const name[7] = {
    "number of points",     "number of triangles", "number of quadrilaterals",
    "number of tetrahedra", "number of pyramids",  "number of prisms",
    "number of hexahedra"
  };
  static const struct vg_ugrid_kind smallest = { 1, 2, 2, 0, 0 };
  int64_t v;

  for (int k = 0; k < 7; k++) {
    vg_status st = vg_input_int(in, &v, name[k], err);

    if (st < 0) return st;
    if (v < 0 || v > (int64_t)UINT32_MAX - 2)
      return vg_input_fail(in, err,
                           "the %s is %lld; it must be between 0 and "
                           "4294967293",
                           name[k], (long long)v);
    count[k] = (uint64_t)v;
  }
  /* Each value takes at least two bytes, except that the last may take one. */
  if (body_bytes(&smallest, count) > vg_input_left(in) + 1)
    return vg_input_fail(in, err,
                         "truncated: the counts require more numbers than "
                         "the remaining %zu bytes can hold",
                         vg_input_left(in));
  return VG_OK;
}

static vg_status text_nodes(struct vg_input *in, struct vg_mesh *m, int element,
                            struct vg_error *err)
{
  size_t n = count_of(m, element) * (size_t)vg_ugrid_width[element];
  uint32_t *node = nodes_of(m, element);
  int64_t v;

  for (size_t i = 0; i < n; i++) {
    vg_status st = vg_input_int(in, &v, vg_ugrid_element[element], err);

    if (st < 0) return st;
    if (v < 1 || (uint64_t)v > m->n_point) {
      vg_input_fail(in, err,
                    "%s %zu refers to point %lld; points are numbered 1 to "
                    "%zu",
                    vg_ugrid_element[element],
                    i / (size_t)vg_ugrid_width[element] + 1, (long long)v,
                    m->n_point);
      if (err) err->code = VG_ERR_INPUT;
      return VG_ERR_INPUT;
    }
    node[i] = (uint32_t)(v - 1);
  }
  return VG_OK;
}

static vg_status read_text(struct vg_input *in, struct vg_mesh *m,
                           int32_t **tag, struct vg_error *err)
{
  uint64_t count[7];
  double *x;
  int64_t v;
  vg_status st = text_header(in, count, err);

  if (st == VG_OK) st = make_room(m, count, tag, err);
  if (st < 0) return st;
  x = (double *)m->point;
  for (size_t i = 0; i < 3 * m->n_point; i++)
    if ((st = vg_input_real(in, x + i, "coordinate", err)) < 0) return st;
  if ((st = text_nodes(in, m, 0, err)) < 0) return st;
  if ((st = text_nodes(in, m, 1, err)) < 0) return st;
  for (size_t i = 0; i < m->n_tri + m->n_quad; i++) {
    if ((st = vg_input_int(in, &v, "surface tag", err)) < 0) return st;
    if (v < INT32_MIN || v > INT32_MAX)
      return vg_input_fail(in, err,
                           "surface tag %lld does not fit into 32 bits",
                           (long long)v);
    (*tag)[i] = (int32_t)v;
  }
  for (int e = 2; e < 6; e++)
    if ((st = text_nodes(in, m, e, err)) < 0) return st;
  return VG_OK;
}

vg_status vg_ugrid_parse(struct vg_input *in, const struct vg_ugrid_kind *kind,
                         struct vg_mesh *out, struct vg_turned *turned,
                         struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  int32_t *tag = NULL;
  vg_status st;

  assert(in && kind && out);
  if (kind->is_text) VG_TRY(read_text(in, &m, &tag, err));
  else VG_TRY(read_binary(in, kind, &m, &tag, err));
  VG_TRY(vg_check_points(in->path, m.n_point, m.point, err));
  VG_TRY(vg_patches_from_tags(&m, tag, err));
  VG_TRY(vg_mesh_turn(&m, turned, err));
  vg_mesh_move(out, &m);
done:
  free(tag);
  vg_mesh_release(&m);
  return st;
}

static vg_status not_a_name(const char *path, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: this is not a name of a UGRID file; known suffixes "
                 "are .ugrid (text), .X.ugrid with X of b8 lb8 b4 lb4 r8 "
                 "lr8 r4 lr4 b8l lb8l, and .b8.ugrid64, .lb8.ugrid64",
                 path);
}

vg_status vg_ugrid_read(const char *path, struct vg_mesh *out,
                        struct vg_turned *turned, struct vg_error *err)
{
  struct vg_ugrid_kind kind;
  struct vg_input in = VG_INPUT_INIT;
  vg_status st;

  if (!vg_ugrid_kind(path, &kind)) return not_a_name(path, err);
  VG_TRY(vg_input_open(path, &in, err));
  VG_TRY(vg_ugrid_parse(&in, &kind, out, turned, err));
done:
  vg_input_release(&in);
  return st;
}

vg_status vg_ugrid_peek(const char *path, uint64_t count[7],
                        struct vg_error *err)
{
  struct vg_ugrid_kind kind;
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = VG_OK;
  int64_t v;

  if (!vg_ugrid_kind(path, &kind)) return not_a_name(path, err);
  VG_TRY(vg_input_open_head(path, 65536, &in, err));
  if (kind.is_text) {
    for (int k = 0; k < 7; k++) {
      VG_TRY(vg_input_int(&in, &v, "a count of the header", err));
      count[k] = (uint64_t)v;
    }
  } else if (!vg_ugrid_counts(&in, &kind, count)) {
    st = not_fitting(&in, &kind, err);
  }
done:
  vg_input_release(&in);
  return st;
}

vg_status vg_ugrid_layer_tets(const char *path, int *is_known, size_t *n,
                              struct vg_error *err)
{
  struct vg_ugrid_kind kind;
  struct vg_input in = VG_INPUT_INIT;
  uint64_t count[7], at;
  int32_t narrow = -1;
  int64_t wide = -1;
  vg_status st = VG_OK;

  *is_known = 0;
  if (!vg_ugrid_kind(path, &kind)) return not_a_name(path, err);
  if (kind.is_text) return VG_OK;
  VG_TRY(vg_input_open(path, &in, err));
  if (fits(&in, &kind) != 1) goto done;
  vg_ugrid_counts(&in, &kind, count);
  at = body_bytes(&kind, count);
  at += 7 * (uint64_t)kind.int_size + marker_bytes(&kind, at) +
        (kind.is_record ? 4 : 0); /* record marker of the tail */
  if (at + (uint64_t)kind.int_size > in.size) goto done;
  in.at = (size_t)at;
  vg_input_order(&in, kind.is_big);
  if (kind.int_size == 8) vg_input_i64(&in, 1, &wide, "the tail", NULL);
  else if (vg_input_i32(&in, 1, &narrow, "the tail", NULL) >= 0) wide = narrow;
  *is_known = wide >= 0 && (uint64_t)wide <= count[3];
  if (*is_known) *n = (size_t)wide;
done:
  vg_input_release(&in);
  return st;
}

/* --- writing --- */

static void put_ints(struct vg_output *out, int int_size, size_t n,
                     const int32_t *v)
{
  int64_t wide[BLOCK];

  if (int_size == 4) {
    vg_output_i32(out, n, v);
    return;
  }
  for (size_t k = 0; k < n; k++) wide[k] = (uint32_t)v[k];
  vg_output_i64(out, n, wide);
}

void vg_ugrid_put_nodes(struct vg_output *out, const struct vg_ugrid_kind *kind,
                        size_t n, const uint32_t *node)
{
  int32_t block[BLOCK];

  if (!node) {
    vg_output_skip(out, n * (uint64_t)kind->int_size);
    return;
  }
  for (size_t i = 0, m; i < n; i += m) {
    m = n - i < BLOCK ? n - i : BLOCK;
    for (size_t k = 0; k < m; k++) block[k] = (int32_t)(node[i + k] + 1);
    put_ints(out, kind->int_size, m, block);
  }
}

void vg_ugrid_put_points(struct vg_output *out,
                         const struct vg_ugrid_kind *kind, size_t n,
                         const double (*x)[3])
{
  if (!x) vg_output_skip(out, 3 * (uint64_t)kind->real_size * n);
  else if (kind->real_size == 8) vg_output_f64(out, 3 * n, *x);
  else vg_output_f32(out, 3 * n, *x);
}

static void put_tags(struct vg_output *out, const struct vg_mesh *m,
                     int int_size, size_t n, const uint32_t *patch)
{
  int32_t block[BLOCK];
  int64_t wide[BLOCK];

  for (size_t i = 0, len; i < n; i += len) {
    len = n - i < BLOCK ? n - i : BLOCK;
    for (size_t k = 0; k < len; k++) {
      block[k] = m->patch[patch[i + k]].id;
      wide[k] = block[k];
    }
    if (int_size == 4) vg_output_i32(out, len, block);
    else vg_output_i64(out, len, wide);
  }
}

static void put_body(struct vg_output *out, const struct vg_ugrid_kind *kind,
                     const struct vg_mesh *m)
{
  vg_ugrid_put_points(out, kind, m->n_point, (const double(*)[3])m->point);
  for (int e = 0; e < 6; e++) {
    vg_ugrid_put_nodes(out, kind, count_of(m, e) * (size_t)vg_ugrid_width[e],
                       nodes_of(m, e));
    if (e != 1) continue;
    put_tags(out, m, kind->int_size, m->n_tri, m->tri_patch);
    put_tags(out, m, kind->int_size, m->n_quad, m->quad_patch);
  }
}

/* Write the number of layer tetrahedra, if the file has a tail. */
static void put_tail(struct vg_output *out, const struct vg_ugrid_kind *kind,
                     const size_t *n_layer_tet)
{
  int32_t v;

  if (!n_layer_tet) return;
  if (kind->is_text) {
    vg_output_int(out, (int64_t)*n_layer_tet);
    vg_output_bytes(out, "\n", 1);
    return;
  }
  v = (int32_t)(uint32_t)*n_layer_tet;
  if (kind->is_record) vg_output_record(out, (uint64_t)kind->int_size);
  put_ints(out, kind->int_size, 1, &v);
  if (kind->is_record) vg_output_record_end(out);
}

static void counts_of(const struct vg_mesh *m, uint64_t count[7])
{
  count[0] = m->n_point;
  for (int e = 0; e < 6; e++) count[e + 1] = count_of(m, e);
}

static void put_binary(struct vg_output *out, const struct vg_ugrid_kind *kind,
                       const struct vg_mesh *m)
{
  uint64_t count[7];
  int32_t head[7];

  counts_of(m, count);
  for (int k = 0; k < 7; k++) head[k] = (int32_t)(uint32_t)count[k];
  vg_output_order(out, kind->is_big);
  if (kind->is_record) vg_output_record(out, 7 * (uint64_t)kind->int_size);
  put_ints(out, kind->int_size, 7, head);
  if (kind->is_record) {
    vg_output_record_end(out);
    vg_output_record(out, body_bytes(kind, count));
  }
  put_body(out, kind, m);
  if (kind->is_record) vg_output_record_end(out);
}

static void put_text_rows(struct vg_output *out, size_t n, int width,
                          const uint32_t *node)
{
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < width; k++) {
      vg_output_int(out, (int64_t)node[i * (size_t)width + (size_t)k] + 1);
      vg_output_bytes(out, k + 1 < width ? " " : "\n", 1);
    }
}

static void put_text(struct vg_output *out, const struct vg_mesh *m)
{
  uint64_t count[7];

  counts_of(m, count);
  for (int k = 0; k < 7; k++) {
    vg_output_int(out, (int64_t)count[k]);
    vg_output_bytes(out, k < 6 ? " " : "\n", 1);
  }
  for (size_t i = 0; i < m->n_point; i++)
    for (int k = 0; k < 3; k++) {
      vg_output_real(out, m->point[i][k]);
      vg_output_bytes(out, k < 2 ? " " : "\n", 1);
    }
  for (int e = 0; e < 6; e++) {
    put_text_rows(out, count_of(m, e), vg_ugrid_width[e], nodes_of(m, e));
    if (e != 1) continue;
    for (size_t i = 0; i < m->n_tri + m->n_quad; i++) {
      uint32_t p = i < m->n_tri ? m->tri_patch[i] : m->quad_patch[i - m->n_tri];

      vg_output_int(out, m->patch[p].id);
      vg_output_bytes(out, "\n", 1);
    }
  }
}

vg_status vg_ugrid_check(const char *path, const struct vg_ugrid_kind *kind,
                         const struct vg_mesh *m, const size_t *n_layer_tet,
                         struct vg_error *err)
{
  uint64_t limit = kind->int_size == 4 ? INT32_MAX : UINT32_MAX - 2;
  uint64_t count[7];

  counts_of(m, count);
  for (int k = 0; k < 7; k++)
    if (count[k] > limit)
      return vg_fail(err, VG_ERR_UNSUPPORTED,
                     "%s: %llu points or elements exceed the integers of "
                     "this kind; write .b8l.ugrid",
                     path, (unsigned long long)count[k]);
  if (n_layer_tet && *n_layer_tet > m->n_tet)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: %zu layer tetrahedra were given, but the mesh has "
                   "only %zu tetrahedra",
                   path, *n_layer_tet, m->n_tet);
  return VG_OK;
}

vg_status vg_ugrid_accept(const struct vg_ugrid_kind *kind,
                          const struct vg_narrow *n, struct vg_error *err)
{
  struct vg_ugrid_kind wide = *kind;

  wide.real_size = 8;
  return vg_narrow_accept(n, kind_name(kind), kind_name(&wide), err);
}

/* Check the rounded coordinates of a mesh in one piece. */
static vg_status check_rounded(const struct vg_ugrid_kind *kind,
                               const struct vg_mesh *m, struct vg_error *err)
{
  const double(*x)[3] = (const double(*)[3])m->point;
  struct vg_narrow n = VG_NARROW_INIT;
  double(*rounded)[3];
  vg_status st;

  if (kind->real_size != 4) return VG_OK;
  rounded = vg_alloc(m->n_point, sizeof *rounded);
  if (!rounded) return vg_fail_memory(err, "the points of a file");
  vg_narrow_round(m->n_point, x, rounded);
  for (int e = 2; e < 6; e++)
    vg_narrow_cells(x, (const double(*)[3])rounded, e - 2, count_of(m, e),
                    nodes_of(m, e), 0, &n);
  free(rounded);
  st = vg_narrow_points(m->n_point, x, &n, err);
  return st < 0 ? st : vg_ugrid_accept(kind, &n, err);
}

void vg_ugrid_put(struct vg_output *out, const struct vg_ugrid_kind *kind,
                  const struct vg_mesh *m, const size_t *n_layer_tet)
{
  if (kind->is_text) put_text(out, m);
  else put_binary(out, kind, m);
  put_tail(out, kind, n_layer_tet);
}

void vg_ugrid_seek(struct vg_output *out, const struct vg_ugrid_kind *kind,
                   const uint64_t count[7], int item, uint64_t first)
{
  uint64_t head = 7 * (uint64_t)kind->int_size, at;

  assert(!kind->is_text && (item == 0 || (item >= 3 && item <= 6)));
  if (!item) at = 3 * (uint64_t)kind->real_size * first;
  else
    at = vg_ugrid_nodes_at(kind, count, item - 1) +
         first * (uint64_t)(vg_ugrid_width[item - 1] * kind->int_size);
  vg_output_order(out, kind->is_big);
  if (!kind->is_record) vg_output_seek(out, head + at);
  else
    vg_output_seek_record(out, vg_record_size(head, out->record_limit),
                          body_bytes(kind, count), at);
}

static vg_status write_mesh(const char *path, const struct vg_mesh *m,
                            const size_t *n_layer_tet, struct vg_error *err)
{
  struct vg_ugrid_kind kind;
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st;

  if (!vg_ugrid_kind(path, &kind)) return not_a_name(path, err);
  st = vg_ugrid_check(path, &kind, m, n_layer_tet, err);
  if (st >= 0) st = check_rounded(&kind, m, err);
  if (st >= 0) st = vg_output_open(path, &out, err);
  if (st < 0) return st;
  vg_ugrid_put(&out, &kind, m, n_layer_tet);
  return vg_output_commit(&out, err);
}

vg_status vg_ugrid_write(const char *path, const struct vg_mesh *m,
                         struct vg_error *err)
{
  return write_mesh(path, m, NULL, err);
}

vg_status vg_ugrid_write_tail(const char *path, const struct vg_mesh *m,
                              size_t n_layer_tet, struct vg_error *err)
{
  return write_mesh(path, m, &n_layer_tet, err);
}
