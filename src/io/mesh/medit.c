/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/medit.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/sheets.h"
#include "core/mesh/zones.h"
#include "io/mesh/gmf.h"
#include "io/stream/convention.h"

/* Sections that are read and written; all others are skipped. */
enum { VERTICES, TRIANGLES, QUADS, TETS, PYRAMIDS, PRISMS, HEXES, N_SECTION };

static const struct section {
  const char *name;
  int code, n_node; /* n_node 0: vertices */
} sections[N_SECTION] = { { "Vertices", 4, 0 },       { "Triangles", 6, 3 },
                          { "Quadrilaterals", 7, 4 }, { "Tetrahedra", 8, 4 },
                          { "Pyramids", 49, 5 },      { "Prisms", 9, 6 },
                          { "Hexahedra", 10, 8 } };

/* Our pyramid has base 0 3 4 1 and apex 2, Medit's base 0 1 2 3 and apex 4:
 * slot k of the file is our node pyramid_slot[k]. */
static const int pyramid_slot[5] = { 0, 3, 4, 1, 2 };

struct reader {
  struct vg_gmf g;
  int seen[N_SECTION];
  struct vg_mesh m;
  int32_t *tag[N_SECTION]; /* references; NULL: none are read */
};

/* --- sections of a mesh --- */

/* Nodes of a section as one flat array, and its number of entities. */
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

/* Allocate a section of n entities. Returns 0, or -1 if there is not enough
 * memory. */
static int section_allocate(struct reader *r, int section, size_t n)
{
  struct vg_mesh *m = &r->m;
#define GIVE(array, count)                                                     \
  (m->array = vg_alloc(n, sizeof *m->array), m->count = m->array ? n : 0,      \
   m->array ? 0 : -1)
  if (section != VERTICES) {
    r->tag[section] = vg_alloc(n, sizeof **r->tag);
    if (!r->tag[section]) return -1;
  }
  switch (section) {
  case TRIANGLES: return GIVE(tri, n_tri);
  case QUADS: return GIVE(quad, n_quad);
  case TETS: return GIVE(tet, n_tet);
  case PYRAMIDS: return GIVE(pyr, n_pyr);
  case PRISMS: return GIVE(pri, n_pri);
  case HEXES: return GIVE(hex, n_hex);
  default: return GIVE(point, n_point);
  }
#undef GIVE
}

/* --- reading, text and binary alike --- */

static vg_status read_vertices(struct reader *r, struct vg_error *err)
{
  for (size_t i = 0; i < r->m.n_point; i++) {
    double *x = r->m.point[i];
    int64_t ref;
    vg_status st = VG_OK;

    if (!r->g.binary)
      for (int k = 0; k < 3 && st == VG_OK; k++)
        st = vg_input_real(r->g.in, &x[k], "a coordinate", err);
    else if (r->g.version == 1)
      st = vg_input_f32(r->g.in, 3, x, "Vertices", err);
    else st = vg_input_f64(r->g.in, 3, x, "Vertices", err);
    if (st == VG_OK)
      st = vg_gmf_ints(&r->g, 1, &ref, "a vertex reference", err);
    if (st < 0) return st;
  }
  return VG_OK;
}

/* Read entities other than vertices. Their node numbers are checked at the end,
 * since the sections may come in any order. */
static vg_status read_entities(struct reader *r, int section,
                               struct vg_error *err)
{
  const struct section *s = sections + section;
  int n_node = s->n_node;
  size_t n;
  uint32_t *node = section_get(&r->m, section, &n);
  int32_t *tag = r->tag[section];

  for (size_t i = 0; i < n; i++, node += n_node) {
    int64_t v[9];
    vg_status st = vg_gmf_ints(&r->g, (size_t)n_node + 1, v, s->name, err);

    if (st < 0) return st;
    for (int k = 0; k < n_node; k++) {
      if (v[k] < 1 || v[k] >= UINT32_MAX)
        return vg_fail(err, VG_ERR_INPUT,
                       "%s: %s number %zu: vertex %lld is out of range",
                       r->g.in->path, s->name, i + 1, (long long)v[k]);
      node[section == PYRAMIDS ? pyramid_slot[k] : k] = (uint32_t)(v[k] - 1);
    }
    if (v[n_node] < -INT32_MAX || v[n_node] > INT32_MAX)
      return vg_fail(err, VG_ERR_UNSUPPORTED,
                     "%s: %s number %zu: reference %lld does not fit into a "
                     "32-bit number of a patch or zone",
                     r->g.in->path, s->name, i + 1, (long long)v[n_node]);
    tag[i] = (int32_t)v[n_node];
  }
  return VG_OK;
}

/* Minimum number of bytes of an entity: in text, a digit and a blank for each
 * number. */
static size_t entity_size(const struct reader *r, int n_node)
{
  size_t size_int = r->g.version == 4 ? 8 : 4;

  if (!r->g.binary) return 2 * (size_t)(n_node ? n_node + 1 : 4);
  if (n_node) return (size_t)(n_node + 1) * size_int;
  return (r->g.version == 1 ? 12 : 24) + size_int;
}

static vg_status read_section(struct reader *r, int section,
                              struct vg_error *err)
{
  const struct section *s = sections + section;
  int64_t n;
  vg_status st;

  if (!r->g.dimension)
    return vg_gmf_fail(&r->g, err, "a section comes before the dimension");
  if (r->seen[section]++)
    return vg_fail(err, VG_ERR_FORMAT, "%s: %s appear twice", r->g.in->path,
                   s->name);
  VG_TRY(vg_gmf_ints(&r->g, 1, &n, "a count", err));
  if (n < 0 || n >= UINT32_MAX)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: %lld %s: the count is negative or beyond 32 bits",
                   r->g.in->path, (long long)n, s->name);
  if (!n) return VG_OK;
  /* The last number of a text needs no blank after it. */
  VG_TRY(vg_input_need(r->g.in,
                       (uint64_t)n * entity_size(r, s->n_node) - !r->g.binary,
                       1, s->name, err));
  if (section_allocate(r, section, (size_t)n))
    return vg_fail_memory(err, s->name);
  st = section == VERTICES ? read_vertices(r, err)
                           : read_entities(r, section, err);
done:
  return st;
}

/* --- text --- */

/* Sections that are skipped hold numbers; they end at the next word. */
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
  /* a spelling that Medit itself once used */
  return vg_token_is(text, len, "Hexaedra") ? HEXES : N_SECTION;
}

static vg_status read_text(struct reader *r, struct vg_error *err)
{
  const char *text;
  size_t len;
  vg_status st = VG_OK;

  while (next_word(r->g.in, &text, &len)) {
    int section = find_word(text, len);

    if (vg_token_is(text, len, "End")) return VG_OK;
    if (section < N_SECTION) {
      VG_TRY(read_section(r, section, err));
    } else if (vg_token_is(text, len, "Dimension")) {
      VG_TRY(vg_gmf_read_dimension(&r->g, err));
    }
  }
  st = vg_gmf_fail(&r->g, err, "truncated: there is no 'End'");
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

static vg_status read_binary(struct reader *r, struct vg_error *err)
{
  int32_t code;
  size_t next = 0;
  vg_status st;

  for (;;) {
    int section;

    VG_TRY(vg_gmf_keyword(&r->g, &code, &next, err));
    if (code == VG_GMF_END) return VG_OK;
    section = find_code(code);
    if (section < N_SECTION) {
      VG_TRY(read_section(r, section, err));
    } else if (code == VG_GMF_DIMENSION) {
      VG_TRY(vg_gmf_read_dimension(&r->g, err));
    }
    if (!next || next == r->g.in->size) return VG_OK;
    if (section < N_SECTION && r->g.in->at > next)
      return vg_gmf_fail(&r->g, err,
                         "a section is longer than its keyword "
                         "says");
    r->g.in->at = next;
  }
done:
  return st;
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
                       "%s: %s number %zu: vertex %lu is out of range: "
                       "there are %zu",
                       r->g.in->path, sections[s].name, i / width + 1,
                       (unsigned long)node[i] + 1, r->m.n_point);
  }
  if (total) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: no triangles, quadrilaterals or cells: there is nothing "
                 "to mesh",
                 r->g.in->path);
}

/* Joins the references of the sections from `first` on, n in total. */
static int32_t *join(struct reader *r, int first, int end, size_t n)
{
  int32_t *tag = vg_alloc(n, sizeof *tag), *to = tag;

  for (int s = first; tag && s < end; s++) {
    section_get(&r->m, s, &n);
    if (n) memcpy(to, r->tag[s], n * sizeof *to);
    to += n;
  }
  return tag;
}

/* Patches from the references of faces, zones from those of cells. */
static vg_status join_tags(struct reader *r, struct vg_error *err)
{
  struct vg_mesh *m = &r->m;
  int32_t *tag = join(r, TRIANGLES, TETS, m->n_tri + m->n_quad);
  vg_status st = tag ? vg_patches_from_tags(m, tag, err)
                     : vg_fail_memory(err, "the patches");

  free(tag);
  if (st < 0) return st;
  tag = join(r, TETS, N_SECTION, vg_mesh_n_cell(m));
  st = tag ? vg_mesh_zones_from_tags(m, tag, 0, err)
           : vg_fail_memory(err, "the zones");
  free(tag);
  return st;
}

vg_status vg_medit_parse(struct vg_input *in, struct vg_mesh *out,
                         struct vg_error *err)
{
  struct reader r = { .g = { .in = in } };
  vg_status st;

  VG_TRY(vg_gmf_open(&r.g, err));
  VG_TRY(r.g.binary ? read_binary(&r, err) : read_text(&r, err));
  VG_TRY(vg_check_points(in->path, r.m.n_point, r.m.point, err));
  VG_TRY(check_nodes(&r, err));
  VG_TRY(join_tags(&r, err));
  VG_TRY(vg_mesh_turn(&r.m, NULL, err));
  vg_mesh_move(out, &r.m);
done:
  vg_mesh_release(&r.m);
  for (int s = 0; s < N_SECTION; s++) free(r.tag[s]);
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
  uint64_t end = 0;
  size_t z = 0;

  for (size_t i = 0; i < n; i++, node += n_node) {
    int32_t ref = section == TRIANGLES ? m->patch[m->tri_patch[i]].id
                : section == QUADS     ? m->patch[m->quad_patch[i]].id
                                       : 0;

    if (section >= TETS && m->n_zone) {
      vg_mesh_zone_walk(m, section - TETS, i, &z, &end);
      ref = m->zone[z].id;
    }

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
  /* Code 1, version, dimension, end. */
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
    put_keyword(w, VG_GMF_DIMENSION, (int64_t)(8 + keyword_size(version) + 4));
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
    else vg_output_format(&w->out, "%s\n", sections[s].name);
    put_int(w, (int64_t)n, 1);
    if (s == VERTICES) put_vertices(w);
    else put_entities(w, s);
  }
  if (w->binary) put_keyword(w, VG_GMF_END, 0);
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

/* version 0: the lowest one that holds the mesh. */
static vg_status write_view(const char *path, const struct vg_mesh *m,
                            int binary, int version, int is_big,
                            struct vg_error *err)
{
  struct vg_mesh view;
  struct writer w = { VG_OUTPUT_INIT, &view, binary, version };
  vg_status st = vg_mesh_sheet_view(m, &view, err);

  if (st < 0) return st;
  if (!version) w.version = 2;
  while (binary && !version && !version_holds(&view, w.version)) w.version++;
  if (version > 4 || (version && !version_holds(&view, version)))
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: .meshb version %d does not exist or cannot hold the "
                 "mesh; use version 4",
                 path, version);
  if (st >= 0) st = write_file(path, &w, is_big, err);
  vg_mesh_sheet_view_release(&view, m);
  return st;
}

vg_status vg_medit_write(const char *path, const struct vg_mesh *m,
                         struct vg_error *err)
{
  const size_t len = strlen(path);

  return write_view(path, m, len >= 6 && !strcmp(path + len - 6, ".meshb"), 0,
                    0, err);
}

vg_status vg_medit_write_binary(const char *path, const struct vg_mesh *m,
                                int version, int big_endian,
                                struct vg_error *err)
{
  /* 5 does not exist either. */
  return write_view(path, m, 1, version < 1 ? 5 : version, big_endian, err);
}
