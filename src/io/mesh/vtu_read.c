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
 * too long. */
static int attribute(const char *tag, const char *end, const char *name,
                     char *out, size_t size)
{
  const char *stop = find(tag, end, ">");
  char word[40];

  snprintf(word, sizeof word, "%s=\"", name);
  for (const char *at = tag; stop && (at = find(at, stop, word)); at++) {
    const char *from = at + strlen(word), *to = find(from, stop, "\"");

    if (!isspace((unsigned char)at[-1])) continue;
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

/* Find an array of a section: the first one, or the one with this name. */
static vg_status find_array(const struct file *f, const char *section,
                            const char *name, int components, struct array *out,
                            struct vg_error *err)
{
  char word[256], close[32];
  const char *at = find_tag(f->text, f->end, section), *end, *stop;
  int64_t n = 1;

  snprintf(close, sizeof close, "</%s", section);
  end = find(at, f->end, close);
  for (at = find_tag(at, end, "DataArray"); at && name;
       at = find_tag(at + 1, end, "DataArray"))
    if (attribute(at, end, "Name", word, sizeof word) && !strcmp(word, name))
      break;
  stop = at ? find(at, end, ">") : NULL;
  if (!stop)
    return vg_fail(err, VG_ERR_FORMAT, "%s: there is no %s%s%s in <%s>",
                   f->in->path, name ? "array '" : "array", name ? name : "",
                   name ? "'" : "", section);
  if (attribute(at, end, "NumberOfComponents", word, sizeof word) &&
      !vg_parse_int(word, strlen(word), &n))
    n = -1;
  if (n != components)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: the array in <%s> has %lld "
                   "components, not %d",
                   f->in->path, section, (long long)n, components);
  if (!attribute(at, end, "type", word, sizeof word)) *word = 0;
  out->width = !strcmp(word, "Float64") ? 8 : !strcmp(word, "Float32") ? 4 : 0;
  if (!out->width)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: the array in <%s> is of type '%.20s'; only Float32 "
                   "and Float64 are supported",
                   f->in->path, section, word);
  out->tag = at;
  out->body = stop + 1;
  out->end = stop[-1] == '/' ? stop + 1 : find(stop, f->end, "</DataArray");
  return out->end ? VG_OK : damaged(f, err, "the end of an array is missing");
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

static vg_status read_text(const struct file *f, const struct array *a,
                           size_t n, double *v, struct vg_error *err)
{
  const char *at = a->body;

  for (size_t i = 0; i < n; i++) {
    const char *to;

    while (at < a->end && isspace((unsigned char)*at)) at++;
    for (to = at; to < a->end && !isspace((unsigned char)*to);) to++;
    if (to == at || !vg_parse_real(at, (size_t)(to - at), &v[i]))
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s: number %zu of %zu of an array is not a number",
                     f->in->path, i + 1, n);
    at = to;
  }
  return VG_OK;
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
  for (size_t i = 0; i < n && !bad; i++) {
    float narrow;

    if (a->width == 8) memcpy(&v[i], raw + 8 * i, 8);
    else memcpy(&narrow, raw + 4 * i, 4), v[i] = (double)narrow;
  }
  free(raw);
  return bad ? damaged(f, err,
                       "truncated or damaged: an array is not as long as "
                       "NumberOfPoints requires")
             : VG_OK;
}

static vg_status read_array(const struct file *f, const struct array *a,
                            size_t n, double *v, struct vg_error *err)
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
  for (size_t i = 0; i < n && st >= 0; i++)
    if (!isfinite(v[i]))
      st = vg_fail(err, VG_ERR_FORMAT,
                   "%s: number %zu of an array is not "
                   "finite",
                   f->in->path, i + 1);
  return st;
}

vg_status vg_vtu_points_parse(struct vg_input *in, const char *name, size_t *n,
                              double (**x)[3], double **value,
                              struct vg_error *err)
{
  struct file f = { .in = in };
  struct array point, scalar;
  double *own[2] = { NULL, NULL };
  size_t count = 0;
  vg_status st;

  assert(in && name && n && x && value);
  VG_TRY(read_head(&f, err));
  VG_TRY(read_piece(&f, &count, err));
  VG_TRY(find_array(&f, "Points", NULL, 3, &point, err));
  VG_TRY(find_array(&f, "PointData", name, 1, &scalar, err));
  own[0] = vg_alloc(count, 3 * sizeof *own[0]);
  own[1] = vg_alloc(count, sizeof *own[1]);
  if (!own[0] || !own[1]) {
    st = vg_fail_memory(err, "the points of a VTK file");
    goto done;
  }
  VG_TRY(read_array(&f, &point, 3 * count, own[0], err));
  VG_TRY(read_array(&f, &scalar, count, own[1], err));
  *n = count;
  *x = (double(*)[3])own[0];
  *value = own[1];
  own[0] = own[1] = NULL;
done:
  free(own[0]);
  free(own[1]);
  return st;
}

vg_status vg_vtu_points_read(const char *path, const char *name, size_t *n,
                             double (**x)[3], double **value,
                             struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st >= 0) st = vg_vtu_points_parse(&in, name, n, x, value, err);
  vg_input_release(&in);
  return st;
}
