/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Buffered output to a temporary file name, Fortran records and numbers; see
 * io/stream/stream.h. */
#define _GNU_SOURCE
#include "io/stream/stream.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/markup.h"
#include "base/memory.h"
#include "io/stream/shared_file.h"

#define CAPACITY ((size_t)1 << 20)
#define BLOCK 2048

char *vg_output_part(const char *path)
{
  char *part;

  return asprintf(&part, "%s.part", path) < 0 ? NULL : part;
}

void vg_output_release(struct vg_output *out)
{
  const struct vg_output empty = VG_OUTPUT_INIT;

  if (out->fd >= 0) {
    close(out->fd);
    unlink(out->part);
  }
  free(out->path);
  free(out->part);
  free(out->buffer);
  *out = empty;
}

vg_status vg_output_open(const char *path, struct vg_output *out,
                         struct vg_error *err)
{
  struct vg_output made = VG_OUTPUT_INIT;
  vg_status st;

  assert(path && out);
  made.record_limit = out->record_limit;
  made.path = strdup(path);
  made.part = vg_output_part(path);
  made.buffer = vg_alloc(CAPACITY, 1);
  if (!made.path || !made.part || !made.buffer) {
    st = vg_fail_memory(err, "a write buffer");
    vg_output_release(&made);
    return st;
  }
  made.fd = open(made.part, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (made.fd < 0) {
    st = vg_fail(err, VG_ERR_IO, "%s: cannot write: %s", path, strerror(errno));
    vg_output_release(&made);
    return st;
  }
  *out = made;
  return VG_OK;
}

vg_status vg_output_shared(struct vg_shared_file *file, struct vg_output *out,
                           struct vg_error *err)
{
  out->buffer = vg_alloc(CAPACITY, 1);
  if (!out->buffer) return vg_fail_memory(err, "a write buffer");
  out->shared = file;
  return VG_OK;
}

static void flush_shared(struct vg_output *out)
{
  if (out->shared && out->n && !out->error &&
      vg_shared_write(out->shared, out->at, out->n, out->buffer, &out->failed) <
        0)
    out->error = EIO;
  out->at += out->n;
  out->n = 0;
}

static void flush(struct vg_output *out)
{
  size_t at = 0;

  if (out->fd < 0) {
    flush_shared(out);
    return;
  }

  while (at < out->n && !out->error) {
    ssize_t put = write(out->fd, out->buffer + at, out->n - at);

    if (put >= 0) at += (size_t)put;
    else if (errno != EINTR) out->error = errno;
  }
  out->n = 0;
}

static vg_status write_error(const struct vg_output *out, struct vg_error *err)
{
  if (out->failed.code) {
    if (err) *err = out->failed;
    return out->failed.code;
  }
  return vg_fail(err, VG_ERR_IO, "%s: cannot write: %s",
                 out->path ? out->path : "output", strerror(out->error));
}

vg_status vg_output_flush(struct vg_output *out, struct vg_error *err)
{
  flush(out);
  return out->error ? write_error(out, err) : VG_OK;
}

vg_status vg_output_commit(struct vg_output *out, struct vg_error *err)
{
  vg_status st = VG_OK;

  flush(out);
  /* A file that replaces another one is on the disk before it does. */
  if (!out->error && !access(out->path, F_OK) && fsync(out->fd))
    out->error = errno;
  if (close(out->fd) && !out->error) out->error = errno;
  out->fd = -1;
  if (!out->error && rename(out->part, out->path)) out->error = errno;
  if (out->error) {
    st = write_error(out, err);
    unlink(out->part);
  }
  vg_output_release(out);
  return st;
}

void vg_output_order(struct vg_output *out, int is_big)
{
  out->swap = (is_big != 0) == vg_host_is_little();
}

/* data NULL: others write these bytes. */
static void put_raw(struct vg_output *out, const void *data, size_t n)
{
  const unsigned char *from = data;

  out->written += n;
  if (!data && n) {
    flush(out);
    out->at += n;
    if (out->fd >= 0 && !out->error) out->error = EPROTO;
    return;
  }
  while (n) {
    size_t room = CAPACITY - out->n, m = n < room ? n : room;

    memcpy(out->buffer + out->n, from, m);
    out->n += m;
    from += m;
    n -= m;
    if (out->n == CAPACITY) flush(out);
  }
}

static void put_marker(struct vg_output *out, uint32_t n, int is_negative)
{
  uint32_t word = is_negative ? 0 - n : n;

  if (out->swap) word = __builtin_bswap32(word);
  put_raw(out, out->no_markers ? NULL : &word, sizeof word);
}

/* The signs of the markers follow formats.md 1.1. */
static void open_part(struct vg_output *out)
{
  int more = out->record_left > out->record_limit;

  out->part_len = more ? out->record_limit : (uint32_t)out->record_left;
  out->part_left = out->part_len;
  put_marker(out, out->part_len, more);
}

static void close_part(struct vg_output *out)
{
  put_marker(out, out->part_len, !out->part_first);
  out->part_first = 0;
}

void vg_output_record(struct vg_output *out, uint64_t bytes)
{
  assert(!out->record_open);
  out->record_open = out->part_first = 1;
  out->record_left = bytes;
  open_part(out);
}

/* A record with more or fewer bytes than announced is an error of the writer
 * and must not produce a file. */
void vg_output_record_end(struct vg_output *out)
{
  assert(out->record_open);
  if (out->record_left && !out->error) out->error = EPROTO;
  close_part(out);
  out->record_open = 0;
}

void vg_output_bytes(struct vg_output *out, const void *data, size_t n)
{
  const unsigned char *from = data;

  assert(data || out->fd < 0 || !n);
  if (!out->record_open) {
    put_raw(out, data, n);
    return;
  }
  while (n) {
    size_t m;

    if (!out->part_left) {
      if (!out->record_left) {
        if (!out->error) out->error = EPROTO;
        return;
      }
      close_part(out);
      open_part(out);
    }
    m = n < out->part_left ? n : out->part_left;
    put_raw(out, from, m);
    if (from) from += m;
    n -= m;
    out->part_left -= (uint32_t)m;
    out->record_left -= m;
  }
}

void vg_output_skip(struct vg_output *out, uint64_t n)
{
  assert(out->fd < 0 || !n);
  vg_output_bytes(out, NULL, n);
}

void vg_output_seek(struct vg_output *out, uint64_t at)
{
  assert(out->fd < 0);
  flush(out);
  out->at = at;
  out->record_open = out->no_markers = 0;
}

void vg_output_seek_record(struct vg_output *out, uint64_t at, uint64_t bytes,
                           uint64_t offset)
{
  uint64_t limit = out->record_limit, part = offset / limit;
  uint64_t left = bytes - part * limit;

  vg_output_seek(out, at + 4 + offset + 8 * part);
  out->record_open = out->no_markers = 1;
  out->part_first = !part;
  out->record_left = bytes - offset;
  out->part_len = (uint32_t)(left < limit ? left : limit);
  out->part_left = (uint32_t)(part * limit + out->part_len - offset);
}

uint64_t vg_record_size(uint64_t bytes, uint32_t limit)
{
  assert(limit > 0);
  return bytes + 8 * (bytes ? (bytes - 1) / limit + 1 : 1);
}

/* Values pass through a block that stays in the cache, where they are converted
 * and byte-swapped. */
#define WRITE_ARRAY(type, word, bswap)                                         \
  word block[BLOCK];                                                           \
  for (size_t i = 0, m; i < n; i += m) {                                       \
    m = n - i < BLOCK ? n - i : BLOCK;                                         \
    for (size_t k = 0; k < m; k++) {                                           \
      type value = (type)v[i + k];                                             \
      memcpy(&block[k], &value, sizeof value);                                 \
    }                                                                          \
    if (out->swap)                                                             \
      for (size_t k = 0; k < m; k++) block[k] = bswap(block[k]);               \
    vg_output_bytes(out, block, m * sizeof(word));                             \
  }

void vg_output_i32(struct vg_output *out, size_t n, const int32_t *v)
{
  assert(v || !n);
  WRITE_ARRAY(int32_t, uint32_t, __builtin_bswap32)
}

void vg_output_i64(struct vg_output *out, size_t n, const int64_t *v)
{
  assert(v || !n);
  WRITE_ARRAY(int64_t, uint64_t, __builtin_bswap64)
}

void vg_output_f64(struct vg_output *out, size_t n, const double *v)
{
  assert(v || !n);
  WRITE_ARRAY(double, uint64_t, __builtin_bswap64)
}

void vg_output_f32(struct vg_output *out, size_t n, const double *v)
{
  assert(v || !n);
  WRITE_ARRAY(float, uint32_t, __builtin_bswap32)
}

/* --- text --- */

void vg_output_text(struct vg_output *out, const char *s)
{
  assert(s);
  vg_output_bytes(out, s, strlen(s));
}

void vg_output_markup(struct vg_output *out, const char *s)
{
  for (; *s; s++) {
    const char *entity = vg_markup_entity(*s);

    if (entity) vg_output_text(out, entity);
    else vg_output_bytes(out, s, 1);
  }
}

void vg_output_format(struct vg_output *out, const char *format, ...)
{
  assert(format);
  char text[1024];
  va_list args;
  int n;

  va_start(args, format);
  n = vsnprintf(text, sizeof text, format, args);
  va_end(args);
  if (n < 0 || (size_t)n >= sizeof text) {
    if (!out->error) out->error = EOVERFLOW;
    return;
  }
  vg_output_bytes(out, text, (size_t)n);
}

static size_t format_unsigned(uint64_t v, char *text)
{
  char digit[20];
  size_t n = 0;

  do {
    digit[n++] = (char)('0' + v % 10);
    v /= 10;
  } while (v);
  for (size_t i = 0; i < n; i++) text[i] = digit[n - 1 - i];
  return n;
}

void vg_output_int(struct vg_output *out, int64_t v)
{
  char text[24];
  size_t n = 0;

  if (v < 0) text[n++] = '-';
  n += format_unsigned(v < 0 ? 0 - (uint64_t)v : (uint64_t)v, text + n);
  vg_output_bytes(out, text, n);
}

/* printf writes the decimal point of the locale, which is replaced by '.'. */
static size_t format_slow(double v, char *text)
{
  double back;
  int n = snprintf(text, 32, "%.15g", v);

  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < n; i++) {
      char c = text[i];

      if ((c < '0' || c > '9') && c != '-' && c != '+' && c != 'e')
        text[i] = '.';
    }
    if (pass || (vg_parse_real(text, (size_t)n, &back) && back == v)) break;
    n = snprintf(text, 32, "%.17g", v);
  }
  return (size_t)n;
}

/* Compute x = digits * 10^-scale with 17 digits, correctly rounded. Returns 0
 * if extended precision cannot decide the last digit. */
static int seventeen_digits(double x, uint64_t *digits, int *scale)
{
#if LDBL_MANT_DIG == 64
  static const long double power[28] = {
    1e0L,  1e1L,  1e2L,  1e3L,  1e4L,  1e5L,  1e6L,  1e7L,  1e8L,  1e9L,
    1e10L, 1e11L, 1e12L, 1e13L, 1e14L, 1e15L, 1e16L, 1e17L, 1e18L, 1e19L,
    1e20L, 1e21L, 1e22L, 1e23L, 1e24L, 1e25L, 1e26L, 1e27L
  };
  int k = 16;
  long double y, part;

  while (x < 1 && k < 21 && x * (double)power[k] < 1e16) k++;
  while (x >= 10 && k > 0 && x * (double)power[k] >= 1e17) k--;
  y = (long double)x * power[k];
  if (y < 1e16L || y >= 1e17L - 1) return 0;
  *digits = (uint64_t)y;
  part = y - (long double)*digits;
  /* y has been rounded once: its error is at most 2^-8 at 1e17. */
  if (part > 0.49L && part < 0.51L) return 0;
  *digits += part > 0.5L;
  *scale = k;
  return 1;
#else
  (void)x;
  (void)digits;
  (void)scale;
  return 0;
#endif
}

/* Write digits * 10^-scale without an exponent and without trailing zeros. */
static size_t format_fixed(uint64_t digits, int scale, char *text)
{
  char digit[24];
  size_t n, at = 0, whole;

  while (scale > 0 && digits % 10 == 0) {
    digits /= 10;
    scale--;
  }
  n = format_unsigned(digits, digit);
  whole = n > (size_t)scale ? n - (size_t)scale : 0;
  if (!whole) text[at++] = '0';
  memcpy(text + at, digit, whole);
  at += whole;
  if (!scale) return at;
  text[at++] = '.';
  for (size_t i = n; i < (size_t)scale; i++) text[at++] = '0';
  memcpy(text + at, digit + whole, n - whole);
  return at + n - whole;
}

size_t vg_format_real(double v, char *text)
{
  static const double power10[23] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,
                                      1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                      1e12, 1e13, 1e14, 1e15, 1e16, 1e17,
                                      1e18, 1e19, 1e20, 1e21, 1e22 };
  double x = v < 0 ? -v : v;
  uint64_t digits, fewer;
  size_t at = 0;
  int scale;

  if (v == 0) {
    if (__builtin_signbit(v)) text[at++] = '-';
    text[at++] = '0';
    return at;
  }
  if (!(x >= 1e-4 && x < 1e15)) return format_slow(v, text);
  if (v < 0) text[at++] = '-';
  if (x == (double)(uint64_t)x)
    return at + format_unsigned((uint64_t)x, text + at);
  if (!seventeen_digits(x, &digits, &scale)) return format_slow(v, text);
  fewer = (digits + 50) / 100;
  if (scale >= 2 && (double)fewer / power10[scale - 2] == x)
    return at + format_fixed(fewer, scale - 2, text + at);
  return at + format_fixed(digits, scale, text + at);
}

void vg_output_real(struct vg_output *out, double v)
{
  char text[32];

  vg_output_bytes(out, text, vg_format_real(v, text));
}
