/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "io/mesh/vtu_read.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/memory.h"

/* Best compression ratio of zlib: 1032 to 1. A count that implies a higher one
 * is wrong. */
#define MOST_PACKED 1100

struct file {
  struct vg_input *in;
  const char *text, *end; /* the XML, without the appended data */
  const char *appended;   /* start of the appended data, after its '_'; NULL:
                             the file has no appended data */
  int is_base64;          /* encoding of the appended data */
  int swaps, is_packed;
  size_t head; /* size of the integers that precede the data: 4 or 8 bytes */
};

struct array {
  const char *tag, *body, *end; /* positions of "<DataArray", after its '>',
                                   and of "</DataArray" */
  size_t width;                 /* size of a value in bytes */
  char kind;                    /* 'f' real, 'i' signed, 'u' unsigned */
  int components;
  char type[20]; /* as in the file, for messages */
  char name[40]; /* of the array, or of its section if it has none */
};

/* --- the necessary part of XML --- */

static const char *find(const char *from, const char *end, const char *word)
{
  return from && from < end
         ? memmem(from, (size_t)(end - from), word, strlen(word))
         : NULL;
}

/* Position of the '<' of the next tag with this name. */
static const char *find_tag(const char *from, const char *end, const char *name)
{
  size_t len = strlen(name);

  for (; (from = find(from, end, "<")); from++)
    if ((size_t)(end - from) > len + 1 && !memcmp(from + 1, name, len) &&
        !isalnum((unsigned char)from[len + 1]))
      return from;
  return NULL;
}

/* Copy an attribute of the tag at `tag` to out; returns 0 if it is absent or
 * too long. XML allows both kinds of quotes; foamToVTK writes single ones. */
static int attribute(const char *tag, const char *end, const char *name,
                     char *out, size_t size)
{
  const char *stop = find(tag, end, ">");
  char word[40];

  snprintf(word, sizeof word, "%s=", name);
  for (const char *at = tag; stop && (at = find(at, stop, word)); at++) {
    const char *from = at + strlen(word) + 1, *to;

    if (!isspace((unsigned char)at[-1]) || from >= stop) continue;
    if (from[-1] != '"' && from[-1] != '\'') continue;
    to = memchr(from, from[-1], (size_t)(stop - from));
    if (!to || (size_t)(to - from) >= size) return 0;
    memcpy(out, from, (size_t)(to - from));
    out[to - from] = 0;
    return 1;
  }
  return 0;
}

static vg_status damaged(const struct file *f, struct vg_error *err,
                         const char *what)
{
  return vg_fail(err, VG_ERR_FORMAT, "%s: %s", f->in->path, what);
}

static vg_status read_head(struct file *f, struct vg_error *err)
{
  const char *data = (const char *)f->in->data, *end = data + f->in->size;
  const char *tag = find_tag(data, end, "VTKFile"), *append;
  char word[64];

  f->text = data;
  append = find_tag(data, end, "AppendedData");
  f->end = append ? append : end;
  if (!tag || tag >= f->end)
    return damaged(f, err, "not a VTK file in XML: there is no <VTKFile>");
  f->head = attribute(tag, f->end, "header_type", word, sizeof word) &&
                !strcmp(word, "UInt64")
            ? 8
            : 4;
  f->swaps = attribute(tag, f->end, "byte_order", word, sizeof word) &&
                 !strcmp(word, "BigEndian")
             ? vg_host_is_little()
             : !vg_host_is_little();
  f->is_packed = attribute(tag, f->end, "compressor", word, sizeof word);
  if (f->is_packed && strcmp(word, "vtkZLibDataCompressor") != 0)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: compressed with %s, but only zlib is supported; "
                   "write it with zlib or uncompressed",
                   f->in->path, word);
  if (!append) return VG_OK;
  f->is_base64 = attribute(append, end, "encoding", word, sizeof word) &&
                 !strcmp(word, "base64");
  append = find(append, end, ">");
  for (append = append ? append + 1 : end; append < end && *append != '_';)
    append++;
  f->appended = append < end ? append + 1 : NULL;
  return VG_OK;
}

/* Read the number of points of the only piece. */
static vg_status read_piece(const struct file *f, size_t *n,
                            struct vg_error *err)
{
  const char *piece = find_tag(f->text, f->end, "Piece");
  char word[32];
  int64_t v = 0;

  if (!piece) return damaged(f, err, "there is no <Piece>");
  if (find_tag(piece + 1, f->end, "Piece"))
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: the file has several pieces; merge them into one",
                   f->in->path);
  if (!attribute(piece, f->end, "NumberOfPoints", word, sizeof word) ||
      !vg_parse_int(word, strlen(word), &v) || v < 1 || v >= UINT32_MAX)
    return damaged(f, err, "NumberOfPoints is not a number from 1 to 2^32 - 2");
  if ((uint64_t)v > (uint64_t)f->in->size * MOST_PACKED / 4)
    return damaged(f, err,
                   "truncated: NumberOfPoints is more than the file "
                   "can hold");
  *n = (size_t)v;
  return VG_OK;
}

/* Type of the values: Float64, Int32, UInt8, ... */
static void read_type(const char *word, struct array *out)
{
  static const char *const bits[] = { "8", "16", "32", "64" };
  const char *number = word + strcspn(word, "0123456789");

  out->kind = !strncmp(word, "Float", 5) ? 'f'
            : !strncmp(word, "Int", 3)   ? 'i'
            : !strncmp(word, "UInt", 4)  ? 'u'
                                         : 0;
  out->width = 0;
  for (int k = 0; k < 4 && out->kind; k++)
    if (!strcmp(number, bits[k])) out->width = (size_t)1 << k;
  if (out->kind == 'f' && out->width < 4) out->width = 0;
}

/* The array of a section with this name, or the first one. Returns NULL if
 * the section has no such array. */
static const char *seek_array(const struct file *f, const char *section,
                              const char *name, const char **section_end)
{
  char word[256], close[32];
  const char *at = find_tag(f->text, f->end, section), *end;

  snprintf(close, sizeof close, "</%s", section);
  *section_end = end = find(at, f->end, close);
  for (at = find_tag(at, end, "DataArray"); at && name;
       at = find_tag(at + 1, end, "DataArray"))
    if (attribute(at, end, "Name", word, sizeof word) && !strcmp(word, name))
      break;
  return at;
}

/* Find an array of a section. */
static vg_status find_array(const struct file *f, const char *section,
                            const char *name, struct array *out,
                            struct vg_error *err)
{
  const char *end, *at = seek_array(f, section, name, &end);
  const char *stop = at ? find(at, end, ">") : NULL;
  char word[64];
  int64_t n = 1;

  if (!stop)
    return vg_fail(err, VG_ERR_FORMAT, "%s: there is no %s%s%s in <%s>",
                   f->in->path, name ? "array '" : "array", name ? name : "",
                   name ? "'" : "", section);
  if (attribute(at, end, "NumberOfComponents", word, sizeof word) &&
      (!vg_parse_int(word, strlen(word), &n) || n < 1 || n > 1000))
    n = -1;
  if (!attribute(at, end, "type", word, sizeof word)) *word = 0;
  snprintf(out->type, sizeof out->type, "%.19s", word);
  read_type(word, out);
  snprintf(out->name, sizeof out->name, "%.39s", name ? name : section);
  out->components = (int)n;
  out->tag = at;
  out->body = stop + 1;
  out->end = stop[-1] == '/' ? stop + 1 : find(stop, f->end, "</DataArray");
  return out->end ? VG_OK : damaged(f, err, "the end of an array is missing");
}

/* Refuse an array of another type or number of components. */
static vg_status check_array(const struct file *f, const char *section,
                             const struct array *a, int components, int is_real,
                             struct vg_error *err)
{
  if (a->components != components)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: the array in <%s> has %d "
                   "components, not %d",
                   f->in->path, section, a->components, components);
  if (a->width && (a->kind == 'f') == is_real) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: the array in <%s> is of type '%s'; only %s are supported",
                 f->in->path, section, a->type,
                 is_real ? "Float32 and Float64" : "integers");
}

/* --- data bytes, raw or in base64 --- */

struct source {
  const char *at, *end;
  int is_base64;
};

static int digit(char c)
{
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* Decode the first n bytes of data that were encoded as a unit; with `moves`,
 * advance past the unit. Returns -1 if there are fewer bytes. */
static int take(struct source *s, size_t n, int moves, unsigned char *out)
{
  const char *at = s->at;
  size_t done = 0;

  if (!s->is_base64) {
    if ((size_t)(s->end - at) < n) return -1;
    memcpy(out, at, n);
    if (moves) s->at = at + n;
    return 0;
  }
  while (done < n) {
    uint32_t bits = 0;
    int k = 0, pad = 0;

    for (; k < 4; at++) {
      if (at >= s->end) return -1;
      if (isspace((unsigned char)*at)) continue;
      if (*at == '=') pad++;
      else if (pad || digit(*at) < 0) return -1;
      bits = bits << 6 | (*at == '=' ? 0 : (uint32_t)digit(*at));
      k++;
    }
    if (pad > 2) return -1;
    for (k = 0; k < 3 - pad && done < n; k++)
      out[done++] = (unsigned char)(bits >> (16 - 8 * k));
    if (pad && done < n) return -1;
  }
  if (moves) s->at = at;
  return 0;
}

static void swap(unsigned char *v, size_t n, size_t width)
{
  for (; n; n--, v += width)
    for (size_t k = 0; k < width / 2; k++) {
      unsigned char c = v[k];

      v[k] = v[width - 1 - k];
      v[width - 1 - k] = c;
    }
}

static uint64_t number(const struct file *f, unsigned char *v)
{
  uint64_t wide;
  uint32_t narrow;

  if (f->swaps) swap(v, 1, f->head);
  memcpy(&wide, v, f->head);
  memcpy(&narrow, v, 4);
  return f->head == 8 ? wide : narrow;
}

/* Read a byte count and that many bytes, encoded as one unit. */
static int take_plain(const struct file *f, struct source *s, size_t bytes,
                      unsigned char *out)
{
  unsigned char head[8], *both;
  int bad;

  if (take(s, f->head, !s->is_base64, head) || number(f, head) != bytes)
    return -1;
  if (!s->is_base64) return take(s, bytes, 1, out);
  both = vg_alloc(bytes + f->head, 1);
  bad = !both || take(s, bytes + f->head, 1, both);
  if (!bad) memcpy(out, both + f->head, bytes);
  free(both);
  return bad ? -1 : 0;
}

/* Unpack the blocks in sequence from `packed`, which has n_packed bytes. */
static int unpack(const struct file *f, unsigned char *head, uint64_t n,
                  const unsigned char *packed, size_t n_packed,
                  unsigned char *out, size_t bytes)
{
  uint64_t block = number(f, head + f->head);
  uint64_t last = number(f, head + 2 * f->head);
  size_t done = 0, at = 0;

  for (uint64_t i = 0; i < n; i++) {
    uint64_t size, want = i + 1 < n || !last ? block : last;
    uLongf got = (uLongf)want;

    size = number(f, head + (3 + i) * f->head);
    if (size > n_packed - at || want > bytes - done ||
        uncompress(out + done, &got, packed + at, (uLong)size) != Z_OK ||
        got != want)
      return -1;
    done += (size_t)want;
    at += (size_t)size;
  }
  return done == bytes ? 0 : -1;
}

/* Read compressed data: first, as one unit, the number of blocks, their size,
 * the size of the last block (0: it is full) and the packed size of each; then
 * all blocks, as another unit. */
static int take_packed(const struct file *f, struct source *s, size_t bytes,
                       unsigned char *out)
{
  unsigned char first[8], *head = NULL, *packed = NULL;
  uint64_t n, sum = 0;
  int bad;

  if (take(s, f->head, 0, first)) return -1;
  n = number(f, first);
  if (n > bytes || n > f->in->size) return -1;
  head = vg_alloc((size_t)n + 3, f->head);
  bad = !head || take(s, ((size_t)n + 3) * f->head, 1, head);
  for (uint64_t i = 0; i < n && !bad; i++) {
    unsigned char size[8];

    memcpy(size, head + (3 + i) * f->head, f->head);
    sum += number(f, size);
    bad = sum > f->in->size;
  }
  packed = bad ? NULL : vg_alloc((size_t)sum, 1);
  bad = !packed || take(s, (size_t)sum, 1, packed) ||
        unpack(f, head, n, packed, (size_t)sum, out, bytes);
  free(head);
  free(packed);
  return bad ? -1 : 0;
}

/* Number i of the n numbers of an array: a component of a value. */
static vg_status refuse_number(const struct file *f, const struct array *a,
                               size_t i, size_t n, const char *what,
                               struct vg_error *err)
{
  const size_t each = (size_t)a->components;
  char component[40] = "";

  if (each > 1)
    snprintf(component, sizeof component, "component %zu of ", i % each + 1);
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: array '%s': %svalue %zu of %zu is not %s", f->in->path,
                 a->name, component, i / each + 1, n / each, what);
}

static vg_status read_text(const struct file *f, const struct array *a,
                           size_t n, double *v, struct vg_error *err)
{
  const char *at = a->body;

  for (size_t i = 0; i < n; i++) {
    const char *to;

    while (at < a->end && isspace((unsigned char)*at)) at++;
    for (to = at; to < a->end && !isspace((unsigned char)*to);) to++;
    if (to == at || !vg_parse_real(at, (size_t)(to - at), &v[i]))
      return refuse_number(f, a, i, n, "a number", err);
    at = to;
  }
  while (at < a->end && isspace((unsigned char)*at)) at++;
  if (at < a->end && *at != '<')
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: array '%s' has more than %zu numbers; check its "
                   "NumberOfComponents",
                   f->in->path, a->name, n);
  return VG_OK;
}

static double value_at(const struct array *a, const unsigned char *raw)
{
  union {
    double f64;
    float f32;
    int8_t i8;
    int16_t i16;
    int32_t i32;
    int64_t i64;
    uint8_t u8;
    uint16_t u16;
    uint32_t u32;
    uint64_t u64;
  } v;

  memcpy(&v, raw, a->width);
  if (a->kind == 'f') return a->width == 8 ? v.f64 : (double)v.f32;
  if (a->kind == 'i' && a->width == 8) return (double)v.i64;
  if (a->kind == 'i')
    return a->width == 4 ? v.i32 : a->width == 2 ? v.i16 : v.i8;
  if (a->width == 8) return (double)v.u64;
  return a->width == 4 ? v.u32 : (double)(a->width == 2 ? v.u16 : v.u8);
}

static vg_status read_bytes(const struct file *f, const struct array *a,
                            struct source *s, size_t n, double *v,
                            struct vg_error *err)
{
  unsigned char *raw = vg_alloc(n, a->width);
  int bad;

  if (!raw) return vg_fail_memory(err, "an array of a VTK file");
  bad = f->is_packed ? take_packed(f, s, n * a->width, raw)
                     : take_plain(f, s, n * a->width, raw);
  if (!bad && f->swaps) swap(raw, n, a->width);
  for (size_t i = 0; i < n && !bad; i++) v[i] = value_at(a, raw + i * a->width);
  free(raw);
  return bad ? damaged(f, err,
                       "truncated or damaged: an array is not as long as "
                       "the number of points or cells requires")
             : VG_OK;
}

/* Values that need not be finite. */
static vg_status read_any(const struct file *f, const struct array *a, size_t n,
                          double *v, struct vg_error *err)
{
  const char *data_end = (const char *)f->in->data + f->in->size;
  struct source s = { a->body, a->end, 1 };
  char word[32];
  int64_t offset;
  vg_status st;

  if (!attribute(a->tag, a->end, "format", word, sizeof word))
    return damaged(f, err, "an array has no format");
  if (!strcmp(word, "ascii")) {
    st = read_text(f, a, n, v, err);
  } else if (!strcmp(word, "binary")) {
    st = read_bytes(f, a, &s, n, v, err);
  } else {
    if (strcmp(word, "appended") != 0 || !f->appended ||
        !attribute(a->tag, a->end, "offset", word, sizeof word) ||
        !vg_parse_int(word, strlen(word), &offset) || offset < 0 ||
        offset > data_end - f->appended)
      return damaged(f, err, "the data of an array are missing");
    s = (struct source){ f->appended + offset, data_end, f->is_base64 };
    st = read_bytes(f, a, &s, n, v, err);
  }
  return st;
}

static vg_status read_array(const struct file *f, const struct array *a,
                            size_t n, double *v, struct vg_error *err)
{
  vg_status st = read_any(f, a, n, v, err);

  for (size_t i = 0; i < n && st >= 0; i++)
    if (!isfinite(v[i])) st = refuse_number(f, a, i, n, "finite", err);
  return st;
}

/* --- values with cells ---------------------------------------------------- */

/* VTK's cells with volume and its faces: type, number of nodes, and our index
 * of each node (formats.md 2.3). */
static const struct cell {
  int type, n, node[8];
} cells[] = {
  { 10, 4, { 0, 1, 2, 3 } },       { 14, 5, { 1, 0, 3, 4, 2 } },
  { 13, 6, { 1, 0, 2, 4, 3, 5 } }, { 12, 8, { 0, 1, 2, 3, 4, 5, 6, 7 } },
  { 5, 3, { 0, 1, 2 } },           { 9, 4, { 0, 1, 2, 3 } }
};
enum { KINDS = sizeof cells / sizeof *cells };

/* Arrays of the cells: the type of each, the end of its nodes, and the nodes of
 * all cells. */
struct grid {
  size_t n, n_node;
  double *type, *end, *node;
};

static vg_status read_integers(const struct file *f, const char *section,
                               const char *name, size_t n, double **out,
                               struct vg_error *err)
{
  struct array a;
  vg_status st = find_array(f, section, name, &a, err);

  if (st >= 0) st = check_array(f, section, &a, 1, 0, err);
  if (st < 0) return st;
  if (n > f->in->size * MOST_PACKED)
    return damaged(f, err,
                   "truncated: there are more cells than the file can "
                   "hold");
  *out = vg_alloc(n, sizeof **out);
  if (!*out) return vg_fail_memory(err, "the cells of a VTK file");
  return read_array(f, &a, n, *out, err);
}

/* The types of polygons follow from their numbers of nodes; 7: a polygon. */
static vg_status set_types(struct grid *g, size_t n, struct vg_error *err)
{
  g->type = vg_alloc(n, sizeof *g->type);
  if (!g->type) return vg_fail_memory(err, "the cells of a VTK file");
  for (size_t i = 0; i < n; i++) {
    const double size = g->end[i] - (i ? g->end[i - 1] : 0);

    g->type[i] = size == 3 ? 5 : size == 4 ? 9 : 7;
  }
  return VG_OK;
}

/* Cells of a .vtu, or polygons of a .vtp. */
static vg_status read_grid(const struct file *f, struct grid *g,
                           struct vg_error *err)
{
  const char *piece = find_tag(f->text, f->end, "Piece"), *in = "Cells";
  char word[32];
  int64_t n = 0;
  vg_status st = VG_OK;

  if (!attribute(piece, f->end, "NumberOfCells", word, sizeof word)) {
    in = "Polys";
    if (!attribute(piece, f->end, "NumberOfPolys", word, sizeof word))
      return VG_OK;
  }
  if (!vg_parse_int(word, strlen(word), &n) || n < 0 || n >= UINT32_MAX)
    return damaged(f, err,
                   "NumberOfCells (or NumberOfPolys) is not a number from 0 to "
                   "2^32 - 2");
  if (!n || !find_tag(f->text, f->end, in)) return VG_OK;
  VG_TRY(read_integers(f, in, "offsets", (size_t)n, &g->end, err));
  for (int64_t i = 0; i < n; i++)
    if (!(g->end[i] >= (i ? g->end[i - 1] : 0)) || g->end[i] > 8e15)
      return damaged(f, err, "the offsets of the cells are not ascending");
  g->n = (size_t)n;
  g->n_node = (size_t)g->end[n - 1];
  if (*in == 'C') VG_TRY(read_integers(f, in, "types", g->n, &g->type, err));
  else VG_TRY(set_types(g, g->n, err));
  VG_TRY(read_integers(f, in, "connectivity", g->n_node, &g->node, err));
done:
  return st;
}

/* Kind of cell i; KINDS: another one. */
static int kind_of(const struct grid *g, size_t i)
{
  int k = 0;

  while (k < KINDS && cells[k].type != (int)g->type[i]) k++;
  return k;
}

static vg_status make_room(const struct grid *g, struct vg_mesh *m,
                           struct vg_error *err)
{
  size_t n[KINDS + 1] = { 0 };

  for (size_t i = 0; i < g->n; i++) n[kind_of(g, i)]++;
  m->tet = vg_alloc(n[0], sizeof *m->tet);
  m->pyr = vg_alloc(n[1], sizeof *m->pyr);
  m->pri = vg_alloc(n[2], sizeof *m->pri);
  m->hex = vg_alloc(n[3], sizeof *m->hex);
  m->tri = vg_alloc(n[4], sizeof *m->tri);
  m->quad = vg_alloc(n[5], sizeof *m->quad);
  return m->tet && m->pyr && m->pri && m->hex && m->tri && m->quad
         ? VG_OK
         : vg_fail_memory(err, "the cells of a VTK file");
}

static uint32_t *next_cell(struct vg_mesh *m, int kind)
{
  switch (kind) {
  case 0: return m->tet[m->n_tet++];
  case 1: return m->pyr[m->n_pyr++];
  case 2: return m->pri[m->n_pri++];
  case 3: return m->hex[m->n_hex++];
  case 4: return m->tri[m->n_tri++];
  case 5: return m->quad[m->n_quad++];
  default: return NULL;
  }
}

static vg_status put_cells(const struct file *f, const struct grid *g,
                           struct vg_mesh *m, struct vg_error *err)
{
  vg_status st = make_room(g, m, err);

  if (st < 0) return st;
  for (size_t i = 0; i < g->n; i++) {
    int kind = kind_of(g, i);
    size_t from = i ? (size_t)g->end[i - 1] : 0;
    uint32_t *to = next_cell(m, kind);

    if (!to) continue;
    if ((size_t)g->end[i] - from != (size_t)cells[kind].n)
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s: cell %zu of type %d has %zu nodes, not %d",
                     f->in->path, i + 1, cells[kind].type,
                     (size_t)g->end[i] - from, cells[kind].n);
    for (int k = 0; k < cells[kind].n; k++) {
      double v = g->node[from + (size_t)k];

      if (!(v >= 0 && v < (double)m->n_point))
        return vg_fail(err, VG_ERR_FORMAT,
                       "%s: cell %zu uses point %.0f, but there are %zu points",
                       f->in->path, i + 1, v + 1, m->n_point);
      to[cells[kind].node[k]] = (uint32_t)v;
    }
  }
  return VG_OK;
}

static vg_status read_points(const struct file *f, struct vg_mesh *m,
                             struct vg_error *err)
{
  struct array point;
  vg_status st;

  VG_TRY(read_piece(f, &m->n_point, err));
  VG_TRY(find_array(f, "Points", NULL, &point, err));
  VG_TRY(check_array(f, "Points", &point, 3, 1, err));
  m->point = vg_alloc(m->n_point, sizeof *m->point);
  if (!m->point) return vg_fail_memory(err, "the points of a VTK file");
  st = read_array(f, &point, 3 * m->n_point, m->point[0], err);
done:
  return st;
}

/* The n values of an array of "PointData" or "CellData". */
static vg_status read_values(const struct file *f, const char *section,
                             const char *name, size_t n, int *components,
                             double **value, struct vg_error *err)
{
  struct array a;
  vg_status st;

  VG_TRY(find_array(f, section, name, &a, err));
  *components = a.components;
  VG_TRY(check_array(f, section, &a, a.components, 1, err));
  if (*components < 1 || *components > 9)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: the array '%s' has %d components; sizes have 1, a "
                   "metric 6 or 9",
                   f->in->path, name, *components);
  *value = vg_alloc(n, (size_t)*components * sizeof **value);
  if (!*value) return vg_fail_memory(err, "the values of a VTK file");
  st = read_any(f, &a, n * (size_t)*components, *value, err);
done:
  return st;
}

/* Values of all cells [g->n] as those of the cells of the mesh, by kind. */
static vg_status sort_values(const struct grid *g, const struct vg_mesh *m,
                             int components, double **value,
                             struct vg_error *err)
{
  const size_t n[4] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  const size_t width = (size_t)components;
  size_t at[4] = { 0, n[0], n[0] + n[1], n[0] + n[1] + n[2] };
  double *sorted = vg_alloc(at[3] + n[3], width * sizeof *sorted);

  if (!sorted) return vg_fail_memory(err, "the values of a VTK file");
  for (size_t i = 0; i < g->n; i++) {
    const int k = kind_of(g, i);

    if (k < 4)
      memcpy(sorted + width * at[k]++, *value + width * i,
             width * sizeof *sorted);
  }
  free(*value);
  *value = sorted;
  return VG_OK;
}

/* Without the end tag, messages about the array that is missing or short would
 * mislead. */
static vg_status explain(const struct vg_input *in, vg_status st,
                         struct vg_error *err)
{
  static const char end[] = "</VTKFile>";
  const size_t n = sizeof end - 1;
  const char *data = (const char *)in->data;

  if (st != VG_ERR_FORMAT || !memmem(data, in->size, "<VTKFile", 8)) return st;
  for (size_t i = in->size; i-- > 0 && in->size - i < 200;)
    if (in->size - i >= n && !memcmp(data + i, end, n)) return st;
  return vg_fail(err, st, "%s: truncated: the file does not end with %s",
                 in->path, end);
}

int vg_vtu_has_array(struct vg_input *in, const char *section, const char *name)
{
  struct vg_error err = VG_ERROR_INIT;
  struct file f = { .in = in };
  const char *end;

  return read_head(&f, &err) >= 0 && seek_array(&f, section, name, &end);
}

void vg_vtu_array_names(struct vg_input *in, const char *section, char *out,
                        size_t size)
{
  struct vg_error err = VG_ERROR_INIT;
  struct file f = { .in = in };
  const char *end, *at;
  char name[256];
  size_t n = 0;

  assert(size > 8);
  *out = 0;
  if (read_head(&f, &err) < 0) return;
  for (at = seek_array(&f, section, NULL, &end); at;
       at = find_tag(at + 1, end, "DataArray")) {
    size_t len;

    if (!attribute(at, end, "Name", name, sizeof name)) continue;
    len = strlen(name);
    if (n + len + 6 > size) {
      snprintf(out + n, size - n, "%s...", n ? ", " : "");
      return;
    }
    n += (size_t)snprintf(out + n, size - n, "%s%s", n ? ", " : "", name);
  }
}

vg_status vg_vtu_values_parse(struct vg_input *in, const char *section,
                              const char *name, struct vg_mesh *out,
                              int *components, double **value,
                              struct vg_error *err)
{
  assert(in && name && out && components && value);

  struct file f = { .in = in };
  struct vg_mesh m = VG_MESH_INIT;
  struct grid g = { 0, 0, NULL, NULL, NULL };
  const int in_cells = *section == 'C';
  double *own = NULL;
  int n = 0;
  vg_status st;

  VG_TRY(read_head(&f, err));
  VG_TRY(read_points(&f, &m, err));
  if (!in_cells)
    VG_TRY(read_values(&f, section, name, m.n_point, &n, &own, err));
  VG_TRY(read_grid(&f, &g, err));
  VG_TRY(put_cells(&f, &g, &m, err));
  if (in_cells) {
    VG_TRY(read_values(&f, section, name, g.n, &n, &own, err));
    VG_TRY(sort_values(&g, &m, n, &own, err));
  }
  *out = m;
  *components = n;
  *value = own;
  m = (struct vg_mesh)VG_MESH_INIT;
  own = NULL;
done:
  st = explain(in, st, err);
  free(g.type);
  free(g.end);
  free(g.node);
  free(own);
  vg_mesh_release(&m);
  return st;
}
