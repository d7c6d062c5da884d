/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Complete files in memory, binary values and Fortran records; see
 * io/stream/stream.h. */
#include "io/stream/stream.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "base/memory.h"

#define CHUNK ((size_t)1 << 20)
#define WHOLE (SIZE_MAX / 4)

/* Compressed data that exceed both this size and this ratio when unpacked are
 * taken for a decompression bomb. */
#define BOMB_SIZE ((size_t)1 << 28)
#define BOMB_RATIO 200
#define EXPLODES 100 /* in addition to zlib's error codes */

int vg_host_is_little(void)
{
  const uint16_t one = 1;
  unsigned char first;

  memcpy(&first, &one, 1);
  return first;
}

static char *copy_string(const char *s)
{
  size_t n = strlen(s) + 1;
  char *to = vg_alloc(n, 1);

  if (to) memcpy(to, s, n);
  return to;
}

/* Append the contents of fd, up to `limit` bytes. Also works for pipes, whose
 * size is not known in advance. */
static vg_status read_all(int fd, const char *path, size_t expected,
                          size_t limit, unsigned char **data, size_t *size,
                          struct vg_error *err)
{
  size_t cap = (expected < limit ? expected : limit) + 2, n = 0;
  unsigned char *block = vg_alloc(cap, 1), *more;

  if (!block) return vg_fail_memory(err, path);
  for (;;) {
    ssize_t got;

    if (n + 1 >= cap) {
      more = vg_realloc(block, cap + cap / 2 + CHUNK, 1);
      if (!more) {
        free(block);
        return vg_fail_memory(err, path);
      }
      block = more;
      cap += cap / 2 + CHUNK;
    }
    got = read(fd, block + n, cap - 1 - n);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      free(block);
      return vg_fail(err, VG_ERR_IO, "%s: cannot read: %s", path,
                     strerror(errno));
    }
    n += (size_t)got;
    if (!got || n >= limit) break;
  }
  block[n] = 0;
  *data = block;
  *size = n;
  return VG_OK;
}

static vg_status gzip_error(const char *path, int code, size_t at,
                            struct vg_error *err)
{
  if (code == Z_MEM_ERROR) return vg_fail_memory(err, path);
  if (code == EXPLODES)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: gzip data that expand to more than %d times their "
                   "size; if this is intended, unpack the file with gunzip",
                   path, BOMB_RATIO);
  if (code == Z_BUF_ERROR)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: truncated gzip data: the file ends before its "
                   "compressed stream does; copy the file again",
                   path);
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: damaged gzip data near byte %zu; copy the file again",
                 path, at);
}

/* Inflate the members of a gzip file one after the other. Zero bytes after the
 * last member are padding, as for gzip(1). */
static int inflate_members(z_stream *z, const unsigned char *from, size_t size,
                           unsigned char **data, size_t *n)
{
  size_t cap = 0, at = 0;
  int code = Z_OK;

  while (code != Z_STREAM_END || at < size) {
    size_t feed = size - at < CHUNK ? size - at : CHUNK, room;

    if (code == Z_STREAM_END) {
      if (from[at] != 0x1f) break;
      inflateReset(z);
    }
    if (vg_reserve(data, &cap, *n + CHUNK + 1, 1) < 0) return Z_MEM_ERROR;
    room = CHUNK;
    z->next_in = (unsigned char *)from + at;
    z->avail_in = (uInt)feed;
    z->next_out = *data + *n;
    z->avail_out = (uInt)room;
    code = inflate(z, Z_NO_FLUSH);
    at += feed - z->avail_in;
    *n += room - z->avail_out;
    if (code == Z_OK && z->avail_out && at >= size) return Z_BUF_ERROR;
    if (code != Z_OK && code != Z_STREAM_END) return code;
    if (*n > BOMB_SIZE && *n / BOMB_RATIO > at) return EXPLODES;
  }
  return Z_OK;
}

static vg_status unpack(const char *path, int is_head, unsigned char **data,
                        size_t *size, struct vg_error *err)
{
  z_stream z = { 0 };
  unsigned char *plain = NULL;
  size_t n = 0;
  int code;

  if (*size < 2 || (*data)[0] != 0x1f || (*data)[1] != 0x8b) return VG_OK;
  if (inflateInit2(&z, 15 + 16) != Z_OK) return vg_fail_memory(err, path);
  code = inflate_members(&z, *data, *size, &plain, &n);
  inflateEnd(&z);
  if (is_head && code == Z_BUF_ERROR && n) code = Z_OK;
  if (code != Z_OK) {
    free(plain);
    return gzip_error(path, code, (size_t)z.total_in, err);
  }
  free(*data);
  plain[n] = 0;
  *data = plain;
  *size = n;
  return VG_OK;
}

/* A text file may begin with U+FEFF in UTF-8, as written by some Windows
 * editors. In a binary file these bytes are data. */
static void drop_byte_order_mark(struct vg_input *in)
{
  static const unsigned char mark[3] = { 0xef, 0xbb, 0xbf };

  if (in->size < sizeof mark || memcmp(in->data, mark, sizeof mark) ||
      !vg_input_is_text(in))
    return;
  in->size -= sizeof mark;
  memmove(in->data, in->data + sizeof mark, in->size + 1);
}

/* A repository cloned without Git LFS has a few lines of text in place of each
 * large file. */
static vg_status refuse_pointer(const char *path, const unsigned char *data,
                                size_t size, struct vg_error *err)
{
  static const char start[] = "version https://git-lfs.github.com/spec/";
  const size_t n = sizeof start - 1;

  if (size < n || memcmp(data, start, n)) return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s is a Git LFS pointer, not the file "
                 "itself; run `git lfs pull` in its repository",
                 path);
}

/* Takes ownership of `data`. */
static vg_status adopt(const char *path, int is_head, unsigned char *data,
                       size_t size, struct vg_input *in, struct vg_error *err)
{
  struct vg_input made = VG_INPUT_INIT;
  vg_status st = unpack(path, is_head, &data, &size, err);

  made.data = data;
  made.size = size;
  if (st == VG_OK) drop_byte_order_mark(&made);
  if (st == VG_OK && !made.size)
    st = vg_fail(err, VG_ERR_FORMAT, "%s: the file is empty", path);
  if (st == VG_OK) st = refuse_pointer(path, made.data, made.size, err);
  if (st == VG_OK && !(made.path = copy_string(path)))
    st = vg_fail_memory(err, path);
  if (st != VG_OK) {
    free(data);
    return st;
  }
  *in = made;
  return VG_OK;
}

static vg_status open_file(const char *path, size_t limit, struct vg_input *in,
                           struct vg_error *err)
{
  unsigned char *data = NULL;
  size_t size = 0, expected = 0;
  struct stat s;
  vg_status st;
  int fd = open(path, O_RDONLY | O_CLOEXEC);

  if (fd < 0)
    return vg_fail(err, VG_ERR_IO, "%s: cannot open: %s", path,
                   strerror(errno));
  if (!fstat(fd, &s)) {
    if (S_ISDIR(s.st_mode)) {
      close(fd);
      return vg_fail(err, VG_ERR_IO, "%s: is a folder, not a file", path);
    }
    if (S_ISCHR(s.st_mode) || S_ISBLK(s.st_mode)) {
      close(fd);
      return vg_fail(err, VG_ERR_IO, "%s: is a device, not a file", path);
    }
    if (S_ISREG(s.st_mode) && s.st_size > 0) expected = (size_t)s.st_size;
  }
  st = read_all(fd, path, expected, limit, &data, &size, err);
  close(fd);
  return st < 0 ? st : adopt(path, limit < WHOLE, data, size, in, err);
}

vg_status vg_input_open(const char *path, struct vg_input *in,
                        struct vg_error *err)
{
  assert(path && !in->data);
  return open_file(path, WHOLE, in, err);
}

vg_status vg_input_open_head(const char *path, size_t limit,
                             struct vg_input *in, struct vg_error *err)
{
  return open_file(path, limit, in, err);
}

vg_status vg_input_memory(const char *name, const void *data, size_t size,
                          struct vg_input *in, struct vg_error *err)
{
  unsigned char *block = NULL;

  assert(name && (data || !size) && !in->data);
  if (size < SIZE_MAX) block = vg_alloc(size + 1, 1);
  if (!block) return vg_fail_memory(err, name);
  if (size) memcpy(block, data, size);
  block[size] = 0;
  return adopt(name, 0, block, size, in, err);
}

void vg_input_release(struct vg_input *in)
{
  const struct vg_input empty = VG_INPUT_INIT;

  if (!in->is_view) {
    free(in->path);
    free(in->data);
  }
  *in = empty;
}

void vg_input_order(struct vg_input *in, int is_big)
{
  in->swap = (is_big != 0) == vg_host_is_little();
}

size_t vg_input_left(const struct vg_input *in)
{
  assert(in->at <= in->size);
  return in->size - in->at;
}

vg_status vg_input_need(const struct vg_input *in, uint64_t n, size_t size,
                        const char *what, struct vg_error *err)
{
  assert(what);

  uint64_t left = vg_input_left(in), bytes;

  if (!__builtin_mul_overflow(n, (uint64_t)size, &bytes) && bytes <= left)
    return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: truncated: %s need %llu x %zu bytes at byte %zu, but "
                 "only %llu are left",
                 in->path, what, (unsigned long long)n, size, in->at,
                 (unsigned long long)left);
}

/* Written so that compilers vectorise each loop. */
static void load32(const unsigned char *from, size_t n, uint32_t *to, int swap)
{
  memcpy(to, from, n * sizeof *to);
  if (swap)
    for (size_t i = 0; i < n; i++) to[i] = __builtin_bswap32(to[i]);
}

static void load64(const unsigned char *from, size_t n, uint64_t *to, int swap)
{
  memcpy(to, from, n * sizeof *to);
  if (swap)
    for (size_t i = 0; i < n; i++) to[i] = __builtin_bswap64(to[i]);
}

/* Blocks of fixed size stay in the cache and avoid type punning. */
#define BLOCK 2048

#define READ_ARRAY(type, word, load)                                           \
  vg_status st = vg_input_need(in, n, sizeof(word), what, err);                \
  word block[BLOCK];                                                           \
  if (st < 0) return st;                                                       \
  for (size_t i = 0, m; i < n; i += m) {                                       \
    m = n - i < BLOCK ? n - i : BLOCK;                                         \
    load(in->data + in->at, m, block, in->swap);                               \
    in->at += m * sizeof(word);                                                \
    for (size_t k = 0; k < m; k++) {                                           \
      type value;                                                              \
      memcpy(&value, &block[k], sizeof value);                                 \
      v[i + k] = value;                                                        \
    }                                                                          \
  }                                                                            \
  return VG_OK

vg_status vg_input_i32(struct vg_input *in, size_t n, int32_t *v,
                       const char *what, struct vg_error *err)
{
  assert((v || !n) && what);
  READ_ARRAY(int32_t, uint32_t, load32);
}

vg_status vg_input_i64(struct vg_input *in, size_t n, int64_t *v,
                       const char *what, struct vg_error *err)
{
  assert((v || !n) && what);
  READ_ARRAY(int64_t, uint64_t, load64);
}

vg_status vg_input_f32(struct vg_input *in, size_t n, double *v,
                       const char *what, struct vg_error *err)
{
  assert((v || !n) && what);
  READ_ARRAY(float, uint32_t, load32);
}

vg_status vg_input_f64(struct vg_input *in, size_t n, double *v,
                       const char *what, struct vg_error *err)
{
  assert((v || !n) && what);
  READ_ARRAY(double, uint64_t, load64);
}

vg_status vg_input_skip(struct vg_input *in, size_t bytes, const char *what,
                        struct vg_error *err)
{
  vg_status st = vg_input_need(in, bytes, 1, what, err);

  if (st == VG_OK) in->at += bytes;
  return st;
}

static vg_status read_marker(struct vg_input *in, int64_t *v, const char *what,
                             struct vg_error *err)
{
  int32_t narrow;
  vg_status st;

  if (in->marker8) return vg_input_i64(in, 1, v, what, err);
  st = vg_input_i32(in, 1, &narrow, what, err);
  if (st == VG_OK) *v = narrow;
  return st;
}

static vg_status marker_error(const struct vg_input *in, const char *what,
                              size_t at, int64_t first, int64_t last,
                              struct vg_error *err)
{
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: the Fortran record of %s at byte %zu has markers %lld "
                 "and %lld, which do not match its length or each other "
                 "(wrong byte order or a damaged file)",
                 in->path, what, at, (long long)first, (long long)last);
}

/* Read one subrecord: move its bytes to *to and advance *to. The signs of the
 * markers follow formats.md 1.1: the leading one is negative if another
 * subrecord follows, the trailing one if another precedes. */
static vg_status read_part(struct vg_input *in, int is_first, size_t *to,
                           int *more, const char *what, struct vg_error *err)
{
  size_t at = in->at;
  int64_t first, last = 0;
  uint64_t n;
  vg_status st = read_marker(in, &first, what, err);

  if (st < 0) return st;
  *more = first < 0;
  n = first < 0 ? 0 - (uint64_t)first : (uint64_t)first;
  if (n > vg_input_left(in)) {
    in->at = at;
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: the Fortran record of %s at byte %zu should have "
                   "%llu bytes, but the file ends before (truncated, wrong "
                   "byte order, or not a Fortran file)",
                   in->path, what, at, (unsigned long long)n);
  }
  if (is_first) *to = in->at;
  else memmove(in->data + *to, in->data + in->at, n);
  in->at += n;
  st = read_marker(in, &last, what, err);
  if (st == VG_OK && last != (int64_t)(is_first ? n : 0 - n))
    st = marker_error(in, what, at, first, last, err);
  if (st == VG_OK) *to += n;
  return st;
}

vg_status vg_input_record(struct vg_input *in, struct vg_input *record,
                          const char *what, struct vg_error *err)
{
  assert(record && what);

  size_t start = in->at + (in->marker8 ? 8 : 4), to = 0;
  int is_first = 1, more = 1;

  while (more) {
    vg_status st = read_part(in, is_first, &to, &more, what, err);

    if (st < 0) return st;
    is_first = 0;
  }
  *record = *in;
  record->is_view = 1;
  record->at = start;
  record->size = to;
  return VG_OK;
}

vg_status vg_input_fail(const struct vg_input *in, struct vg_error *err,
                        const char *format, ...)
{
  char text[768];
  va_list args;

  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  return vg_fail(err, VG_ERR_FORMAT, "%s:%zu: %s", in->path, in->line, text);
}

void vg_library_zlib(struct vg_library *out)
{
  out->name = "zlib";
  snprintf(out->version, sizeof out->version, "%s", zlibVersion());
}
