#include "io/mesh/medit.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/convention.h"

/* GMF codes outside the table of sections. */
#define CODE_DIMENSION 3
#define CODE_END 54

/* The sections that are read and written; all others are skipped. */
enum { VERTICES, TRIANGLES, QUADS, TETS, PYRAMIDS, PRISMS, HEXES, N_SECTION };

static const struct section {
  const char *name;
  int code, n_node;         /* n_node 0: vertices */
} sections[N_SECTION] = {
  { "Vertices", 4, 0 },      { "Triangles", 6, 3 }, { "Quadrilaterals", 7, 4 },
  { "Tetrahedra", 8, 4 },    { "Pyramids", 49, 5 }, { "Prisms", 9, 6 },
  { "Hexahedra", 10, 8 }
};

/* Our pyramid has base ring 0 3 4 1 and apex 2, Medit's ring 0 1 2 3 and apex
 * 4: slot k of the file is our node pyramid_slot[k]. */
static const int pyramid_slot[5] = { 0, 3, 4, 1, 2 };

struct reader {
  struct vg_input *in;
  int binary, version;
  int dimension;            /* 0: not seen yet */
  int seen[N_SECTION];
  struct vg_mesh m;
  int32_t *tri_tag, *quad_tag;
};

/* --- sections of a mesh --- */

/* Nodes of a section as one flat array, and how many entities it has. */
static uint32_t *section_get(const struct vg_mesh *m, int section, size_t *n)
{
  switch (section) {
  case TRIANGLES: *n = m->n_tri; return m->tri ? m->tri[0] : NULL;
  case QUADS: *n = m->n_quad; return m->quad ? m->quad[0] : NULL;
  case TETS: *n = m->n_tet; return m->tet ? m->tet[0] : NULL;
  case PYRAMIDS: *n = m->n_pyr; return m->pyr ? m->pyr[0] : NULL;
  case PRISMS: *n = m->n_pri; return m->pri ? m->pri[0] : NULL;
  case HEXES: *n = m->n_hex; return m->hex ? m->hex[0] : NULL;
  default: *n = m->n_point; return NULL;
  }
}

/* Allocate a section of n entities. 0, or -1 when refused. */
static int section_allocate(struct reader *r, int section, size_t n)
{
  struct vg_mesh *m = &r->m;
#define GIVE(array, count) \
  (m->array = vg_alloc(n, sizeof *m->array), m->count = m->array ? n : 0, \
   m->array ? 0 : -1)
  switch (section) {
  case TRIANGLES:
    r->tri_tag = vg_alloc(n, sizeof *r->tri_tag);
    return r->tri_tag ? GIVE(tri, n_tri) : -1;
  case QUADS:
    r->quad_tag = vg_alloc(n, sizeof *r->quad_tag);
    return r->quad_tag ? GIVE(quad, n_quad) : -1;
  case TETS: return GIVE(tet, n_tet);
  case PYRAMIDS: return GIVE(pyr, n_pyr);
  case PRISMS: return GIVE(pri, n_pri);
  case HEXES: return GIVE(hex, n_hex);
  default: return GIVE(point, n_point);
  }
#undef GIVE
}

/* --- reading, text and binary alike --- */

static vg_status fail_at(const struct reader *r, struct vg_error *err,
                         const char *text)
{
  if (!r->binary) return vg_input_fail(r->in, err, "%s", text);
  return vg_fail(err, VG_ERR_FORMAT, "%s: %s (near byte %zu)", r->in->path,
                 text, r->in->at);
}

static vg_status set_dimension(struct reader *r, int64_t v,
                               struct vg_error *err)
{
  if (v == 2)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: a plane mesh (dimension 2); only three dimensions are "
                   "meshed", r->in->path);
  if (v != 3) return fail_at(r, err, "the dimension is neither 2 nor 3");
  r->dimension = 3;
  return VG_OK;
}

static vg_status set_version(struct reader *r, int64_t v, struct vg_error *err)
{
  if (v < 1 || v > 4)
    return fail_at(r, err, "unknown version: MeshVersionFormatted must be 1 "
                   "to 4");
  r->version = (int)v;
  return VG_OK;
}

/* n integers of the file's width. */
static vg_status read_ints(struct reader *r, int n, int64_t *v,
                           const char *what, struct vg_error *err)
{
  int32_t narrow[9];
  vg_status st = VG_OK;

  if (!r->binary) {
    for (int k = 0; k < n && st == VG_OK; k++)
      st = vg_input_int(r->in, &v[k], what, err);
    return st;
  }
  if (r->version == 4) return vg_input_i64(r->in, (size_t)n, v, what, err);
  st = vg_input_i32(r->in, (size_t)n, narrow, what, err);
  for (int k = 0; k < n && st == VG_OK; k++) v[k] = narrow[k];
  return st;
}

static vg_status read_vertices(struct reader *r, struct vg_error *err)
{
  for (size_t i = 0; i < r->m.n_point; i++) {
    double *x = r->m.point[i];
    int64_t ref;
    vg_status st = VG_OK;

    if (!r->binary)
      for (int k = 0; k < 3 && st == VG_OK; k++)
        st = vg_input_real(r->in, &x[k], "a coordinate", err);
    else if (r->version == 1) st = vg_input_f32(r->in, 3, x, "Vertices", err);
    else st = vg_input_f64(r->in, 3, x, "Vertices", err);
    if (st == VG_OK) st = read_ints(r, 1, &ref, "a vertex reference", err);
    if (st < 0) return st;
  }
  return VG_OK;
}

/* Entities other than vertices. Node numbers are compared with the number of
 * vertices at the end: the sections may come in any order. */
static vg_status read_entities(struct reader *r, int section,
                               struct vg_error *err)
{
  const struct section *s = sections + section;
  int n_node = s->n_node;
  size_t n;
  uint32_t *node = section_get(&r->m, section, &n);
  int32_t *tag = section == TRIANGLES ? r->tri_tag
                 : section == QUADS ? r->quad_tag : NULL;

  for (size_t i = 0; i < n; i++, node += n_node) {
    int64_t v[9];
    vg_status st = read_ints(r, n_node + 1, v, s->name, err);

    if (st < 0) return st;
    for (int k = 0; k < n_node; k++) {
      if (v[k] < 1 || v[k] >= UINT32_MAX)
        return vg_fail(err, VG_ERR_INPUT,
                       "%s: %s, number %zu: vertex %lld is out of range",
                       r->in->path, s->name, i + 1, (long long)v[k]);
      node[section == PYRAMIDS ? pyramid_slot[k] : k] = (uint32_t)(v[k] - 1);
    }
    if (!tag) continue;
    if (v[n_node] < -INT32_MAX || v[n_node] > INT32_MAX)
      return vg_fail(err, VG_ERR_UNSUPPORTED,
                     "%s: %s, number %zu: reference %lld does not fit a patch "
                     "number of 32 bits", r->in->path, s->name, i + 1,
                     (long long)v[n_node]);
    tag[i] = (int32_t)v[n_node];
  }
  return VG_OK;
}

/* Least bytes of an entity: in text, a digit and a blank for each number. */
static size_t entity_size(const struct reader *r, int n_node)
{
  size_t size_int = r->version == 4 ? 8 : 4;

  if (!r->binary) return 2 * (size_t)(n_node ? n_node + 1 : 4);
  if (n_node) return (size_t)(n_node + 1) * size_int;
  return (r->version == 1 ? 12 : 24) + size_int;
}

static vg_status read_section(struct reader *r, int section,
                              struct vg_error *err)
{
  const struct section *s = sections + section;
  int64_t n;
  vg_status st;

  if (!r->dimension)
    return fail_at(r, err, "a section stands before the dimension");
  if (r->seen[section]++)
    return vg_fail(err, VG_ERR_FORMAT, "%s: %s appear twice", r->in->path,
                   s->name);
  VG_TRY(read_ints(r, 1, &n, "a count", err));
  if (n < 0 || n >= UINT32_MAX)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: %lld %s: the count is negative or beyond 32 bits",
                   r->in->path, (long long)n, s->name);
  if (!n) return VG_OK;
  /* The last number of a text needs no blank behind it. */
  VG_TRY(vg_input_need(r->in, (uint64_t)n * entity_size(r, s->n_node) -
                       !r->binary, 1, s->name, err));
  if (section_allocate(r, section, (size_t)n))
    return vg_fail_memory(err, s->name);
  st = section == VERTICES ? read_vertices(r, err)
                           : read_entities(r, section, err);
done:
  return st;
}

/* --- text --- */

/* Sections that are not ours hold numbers; a word ends them. */
static int next_word(struct vg_input *in, const char **text, size_t *len)
{
  while (vg_input_token(in, text, len))
    if ((**text >= 'A' && **text <= 'Z') || (**text >= 'a' && **text <= 'z'))
      return 1;
  return 0;
}

static int find_word(const char *text, size_t len)
{
  for (int i = 0; i < N_SECTION; i++)
    if (vg_token_is(text, len, sections[i].name)) return i;
  /* As Medit itself once spelled it. */
  return vg_token_is(text, len, "Hexaedra") ? HEXES : N_SECTION;
}

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
  VG_TRY(set_version(r, v, err));
  while (next_word(r->in, &text, &len)) {
    int section = find_word(text, len);

    if (vg_token_is(text, len, "End")) return VG_OK;
    if (section < N_SECTION) {
      VG_TRY(read_section(r, section, err));
    } else if (vg_token_is(text, len, "Dimension")) {
      VG_TRY(vg_input_int(r->in, &v, "the dimension", err));
      VG_TRY(set_dimension(r, v, err));
    }
  }
  st = fail_at(r, err, "truncated: there is no 'End'");
done:
  return st;
}

/* --- binary --- */

static int find_code(int code)
{
  for (int i = 0; i < N_SECTION; i++)
    if (sections[i].code == code) return i;
  return N_SECTION;
}

/* Code of the next keyword and where the one behind it starts. */
static vg_status read_keyword(struct reader *r, int32_t *code, size_t *next,
                              struct vg_error *err)
{
  size_t start = r->in->at;
  int64_t position;
  int32_t narrow = 0;
  vg_status st;

  VG_TRY(vg_input_i32(r->in, 1, code, "a keyword", err));
  if (r->version >= 3) {
    VG_TRY(vg_input_i64(r->in, 1, &position, "a position", err));
  } else {
    VG_TRY(vg_input_i32(r->in, 1, &narrow, "a position", err));
    position = narrow;
  }
  /* Zero stands behind the last keyword. Positions must advance, or a
   * damaged file could be read for ever. */
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
  int32_t code, version, value;
  size_t next = 0;
  vg_status st;

  r->binary = 1;
  r->in->at = 4;
  VG_TRY(vg_input_i32(r->in, 1, &version, "the version", err));
  VG_TRY(set_version(r, version, err));
  for (;;) {
    int section;

    VG_TRY(read_keyword(r, &code, &next, err));
    if (code == CODE_END) return VG_OK;
    section = find_code(code);
    if (section < N_SECTION) {
      VG_TRY(read_section(r, section, err));
    } else if (code == CODE_DIMENSION) {
      VG_TRY(vg_input_i32(r->in, 1, &value, "the dimension", err));
      VG_TRY(set_dimension(r, value, err));
    }
    if (!next || next == r->in->size) return VG_OK;
    if (section < N_SECTION && r->in->at > next)
      return fail_at(r, err, "a section is longer than its keyword says");
    r->in->at = next;
  }
done:
  return st;
}

/* A binary file begins with an int32 one, in its own byte order. */
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

/* --- finishing --- */

static vg_status check_nodes(const struct reader *r, struct vg_error *err)
{
  size_t total = 0;

  for (int s = TRIANGLES; s < N_SECTION; s++) {
    size_t n, width = (size_t)sections[s].n_node;
    const uint32_t *node = section_get(&r->m, s, &n);

    total += n;
    for (size_t i = 0; i < n * width; i++)
      if (node[i] >= r->m.n_point)
        return vg_fail(err, VG_ERR_INPUT,
                       "%s: %s, number %zu: vertex %lu is out of range: there "
                       "are %zu", r->in->path, sections[s].name,
                       i / width + 1, (unsigned long)node[i] + 1,
                       r->m.n_point);
  }
  if (total) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: no triangles, quadrilaterals or cells: there is nothing "
                 "to mesh", r->in->path);
}

static vg_status join_tags(struct reader *r, struct vg_error *err)
{
  size_t n_tri = r->m.n_tri, n_quad = r->m.n_quad;
  int32_t *tag = vg_realloc(r->tri_tag, n_tri + n_quad, sizeof *tag);

  if (!tag) return vg_fail_memory(err, "the patches");
  r->tri_tag = tag;
  if (n_quad) memcpy(tag + n_tri, r->quad_tag, n_quad * sizeof *tag);
  return vg_patches_from_tags(&r->m, tag, err);
}

vg_status vg_medit_parse(struct vg_input *in, struct vg_mesh *out,
                         struct vg_error *err)
{
  struct reader r = { .in = in };
  vg_status st;

  if (is_binary(in)) {
    VG_TRY(read_binary(&r, err));
  } else if (vg_input_is_text(in)) {
    VG_TRY(read_text(&r, err));
  } else {
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: neither text nor binary Medit: a binary file begins "
                   "with the number 1", in->path);
  }
  VG_TRY(vg_check_points(in->path, r.m.n_point, r.m.point, err));
  VG_TRY(check_nodes(&r, err));
  VG_TRY(join_tags(&r, err));
  VG_TRY(vg_mesh_turn(&r.m, NULL, err));
  vg_mesh_move(out, &r.m);
done:
  vg_mesh_release(&r.m);
  free(r.tri_tag);
  free(r.quad_tag);
  return st;
}

vg_status vg_medit_read(const char *path, struct vg_mesh *out,
                        struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st == VG_OK) st = vg_medit_parse(&in, out, err);
  vg_input_release(&in);
  return st;
}

/* --- writing --- */

struct writer {
  struct vg_output out;
  const struct vg_mesh *m;
  int binary, version;
};

static void put_int(struct writer *w, int64_t v, int last)
{
  int32_t narrow = (int32_t)v;

  if (!w->binary) {
    vg_output_int(&w->out, v);
    vg_output_text(&w->out, last ? "\n" : " ");
  } else if (w->version == 4) {
    vg_output_i64(&w->out, 1, &v);
  } else {
    vg_output_i32(&w->out, 1, &narrow);
  }
}

static void put_vertices(struct writer *w)
{
  for (size_t i = 0; i < w->m->n_point; i++) {
    const double *x = w->m->point[i];

    for (int k = 0; k < 3 && !w->binary; k++) {
      vg_output_real(&w->out, x[k]);
      vg_output_text(&w->out, " ");
    }
    if (w->binary && w->version == 1) vg_output_f32(&w->out, 3, x);
    else if (w->binary) vg_output_f64(&w->out, 3, x);
    put_int(w, 0, 1);
  }
}

static void put_entities(struct writer *w, int section)
{
  const struct vg_mesh *m = w->m;
  int n_node = sections[section].n_node;
  size_t n;
  const uint32_t *node = section_get(m, section, &n);

  for (size_t i = 0; i < n; i++, node += n_node) {
    int32_t ref = section == TRIANGLES ? m->patch[m->tri_patch[i]].id
                  : section == QUADS ? m->patch[m->quad_patch[i]].id : 0;

    for (int k = 0; k < n_node; k++)
      put_int(w, (int64_t)node[section == PYRAMIDS ? pyramid_slot[k] : k] + 1,
              0);
    put_int(w, ref, 1);
  }
}

static uint64_t keyword_size(int version)
{
  return version >= 3 ? 12 : 8;
}

static uint64_t section_size(const struct vg_mesh *m, int section, int version)
{
  uint64_t size_int = version == 4 ? 8 : 4, size;
  int n_node = sections[section].n_node;
  size_t n;

  section_get(m, section, &n);
  if (!n) return 0;
  size = n_node ? (uint64_t)(n_node + 1) * size_int
                : (version == 1 ? 12 : 24) + size_int;
  return keyword_size(version) + size_int + n * size;
}

static uint64_t file_size(const struct vg_mesh *m, int version)
{
  /* Cookie, version, dimension, end. */
  uint64_t size = 8 + keyword_size(version) + 4 + keyword_size(version);

  for (int s = 0; s < N_SECTION; s++) size += section_size(m, s, version);
  return size;
}

static int version_holds(const struct vg_mesh *m, int version)
{
  if (version < 4)
    for (int s = 0; s < N_SECTION; s++) {
      size_t n;

      section_get(m, s, &n);
      if (n > INT32_MAX) return 0;
    }
  return version >= 3 || file_size(m, version) <= INT32_MAX;
}

static void put_keyword(struct writer *w, int32_t code, int64_t next)
{
  int32_t narrow = (int32_t)next;

  vg_output_i32(&w->out, 1, &code);
  if (w->version >= 3) vg_output_i64(&w->out, 1, &next);
  else vg_output_i32(&w->out, 1, &narrow);
}

static void put_all(struct writer *w)
{
  static const int32_t one = 1, three = 3;
  int32_t version = w->version;

  if (w->binary) {
    vg_output_i32(&w->out, 1, &one);
    vg_output_i32(&w->out, 1, &version);
    put_keyword(w, CODE_DIMENSION,
                (int64_t)(8 + keyword_size(version) + 4));
    vg_output_i32(&w->out, 1, &three);
  } else {
    vg_output_text(&w->out, "MeshVersionFormatted 2\nDimension 3\n");
  }
  for (int s = 0; s < N_SECTION; s++) {
    size_t n;

    section_get(w->m, s, &n);
    if (!n) continue;
    if (w->binary)
      put_keyword(w, sections[s].code,
                  (int64_t)(w->out.written + section_size(w->m, s, version)));
    else
      vg_output_format(&w->out, "%s\n", sections[s].name);
    put_int(w, (int64_t)n, 1);
    if (s == VERTICES) put_vertices(w);
    else put_entities(w, s);
  }
  if (w->binary) put_keyword(w, CODE_END, 0);
  else vg_output_text(&w->out, "End\n");
}

static vg_status write_file(const char *path, struct writer *w, int is_big,
                            struct vg_error *err)
{
  vg_status st = vg_output_open(path, &w->out, err);

  if (st < 0) return st;
  vg_output_order(&w->out, is_big);
  put_all(w);
  return vg_output_commit(&w->out, err);
}

vg_status vg_medit_write(const char *path, const struct vg_mesh *m,
                         struct vg_error *err)
{
  struct writer w = { VG_OUTPUT_INIT, m, 0, 2 };
  size_t len = strlen(path);

  if (len < 6 || strcmp(path + len - 6, ".meshb"))
    return write_file(path, &w, 0, err);
  w.binary = 1;
  while (!version_holds(m, w.version)) w.version++;
  return write_file(path, &w, 0, err);
}

vg_status vg_medit_write_binary(const char *path, const struct vg_mesh *m,
                                int version, int big_endian,
                                struct vg_error *err)
{
  struct writer w = { VG_OUTPUT_INIT, m, 1, version };

  if (version < 1 || version > 4 || !version_holds(m, version))
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: .meshb version %d does not exist or cannot hold the "
                   "mesh; use version 4", path, version);
  return write_file(path, &w, big_endian, err);
}
