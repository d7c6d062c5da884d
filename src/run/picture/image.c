/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/picture/image.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/memory.h"

/* A report has a dozen pictures, for which the fastest level is suitable
 * (V3). */
#define LEVEL 1

vg_status vg_image_new(int width, int height, struct vg_image *m,
                       struct vg_error *err)
{
  assert(width > 0 && height > 0 && m);
  m->rgba = vg_calloc((size_t)width * (size_t)height, sizeof *m->rgba);
  if (!m->rgba) return vg_fail_memory(err, "a picture");
  m->width = width;
  m->height = height;
  return VG_OK;
}

void vg_image_release(struct vg_image *m)
{
  free(m->rgba);
  memset(m, 0, sizeof *m);
}

static void put32(uint8_t *to, unsigned long v)
{
  for (int k = 0; k < 4; k++) to[k] = (uint8_t)(v >> (24 - 8 * k));
}

/* Completes a chunk at `to`, whose data already follow the 8 bytes of length
 * and name. */
static size_t seal(uint8_t *to, const char *name, size_t n)
{
  put32(to, n);
  memcpy(to + 4, name, 4);
  put32(to + 8 + n, crc32(crc32(0, NULL, 0), to + 4, (unsigned)n + 4));
  return n + 12;
}

/* --- a palette ----------------------------------------------------------- */

/* Colours are numbers of 18 bits: opacity in quarters, then 5 bits each of red,
 * green and blue. */
enum { COLOURS = 5 << 15, PALETTE = 256 };

static unsigned colour_of(const uint8_t *rgba)
{
  return (unsigned)(rgba[3] + 32) / 64 << 15 | (unsigned)(rgba[0] >> 3) << 10 |
         (unsigned)(rgba[1] >> 3) << 5 | (unsigned)(rgba[2] >> 3);
}

static int part_of(unsigned colour, int k)
{
  return k == 3 ? (int)(colour >> 15) * 8 : (int)(colour >> (10 - 5 * k)) & 31;
}

struct used {
  unsigned colour, count;
};

static int by_count(const void *a, const void *b)
{
  const struct used *x = a, *y = b;

  if (x->count != y->count) return x->count > y->count ? -1 : 1;
  return (x->colour > y->colour) - (x->colour < y->colour);
}

static int nearest(const struct used *palette, unsigned colour)
{
  int best = 0, least = 1 << 30;

  for (int i = 0; i < PALETTE; i++) {
    int sum = 0;

    for (int k = 0; k < 4; k++) {
      int d = part_of(palette[i].colour, k) - part_of(colour, k);

      sum += d * d;
    }
    if (sum >= least) continue;
    least = sum;
    best = i;
  }
  return best;
}

/* Sorts colours by decreasing count, takes the first of them as the palette,
 * and stores the palette index of every colour in use. Returns the size of the
 * palette. */
static size_t find_palette(const struct vg_image *m, uint32_t *table,
                           struct used *used)
{
  size_t n = (size_t)m->width * (size_t)m->height, n_used = 0;

  memset(table, 0, COLOURS * sizeof *table);
  for (size_t i = 0; i < n; i++) table[colour_of(m->rgba[i])]++;
  for (unsigned c = 0; c < COLOURS; c++)
    if (table[c]) used[n_used++] = (struct used){ c, table[c] };
  qsort(used, n_used, sizeof *used, by_count);
  for (size_t i = 0; i < n_used; i++)
    table[used[i].colour] = i < PALETTE
                            ? (uint32_t)i
                            : (uint32_t)nearest(used, used[i].colour);
  return n_used < PALETTE ? n_used : PALETTE;
}

/* --- the file ------------------------------------------------------------ */

static size_t put_head(const struct vg_image *m, size_t n,
                       const struct used *palette, uint8_t *to)
{
  uint8_t *head = memset(to + 8, 0, 13);
  size_t at;

  put32(head, (unsigned long)m->width);
  put32(head + 4, (unsigned long)m->height);
  head[8] = 8; /* Bits of an index into ... */
  head[9] = 3; /* ... a palette. */
  at = seal(to, "IHDR", 13);
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      int v = part_of(palette[i].colour, k);

      to[at + 8 + 3 * i + (size_t)k] = (uint8_t)(v << 3 | v >> 2);
    }
  at += seal(to + at, "PLTE", 3 * n);
  for (size_t i = 0; i < n; i++) {
    int v = (int)(palette[i].colour >> 15) * 64;

    to[at + 8 + i] = (uint8_t)(v > 255 ? 255 : v);
  }
  return at + seal(to + at, "tRNS", n);
}

/* Rows of palette indices, each preceded by the byte of its filter type. */
static void put_rows(const struct vg_image *m, const uint32_t *table,
                     uint8_t *to)
{
  for (int y = 0; y < m->height; y++) {
    const uint8_t(*row)[4] = (const uint8_t(*)[4])m->rgba +
                             (size_t)y * (size_t)m->width;

    *to++ = 0;
    for (int x = 0; x < m->width; x++)
      *to++ = (uint8_t)table[colour_of(row[x])];
  }
}

vg_status vg_image_png(const struct vg_image *m, struct vg_bytes *out,
                       struct vg_error *err)
{
  static const uint8_t signature[8] = "\211PNG\r\n\032\n";
  size_t n = (1 + (size_t)m->width) * (size_t)m->height, at = 8, n_colour;
  uLongf packed = compressBound(n);
  uint8_t *raw = vg_alloc(n, 1), *png = vg_alloc(packed + 2048, 1);
  uint32_t *table = vg_alloc(COLOURS, sizeof *table);
  struct used *used = vg_alloc(COLOURS, sizeof *used);
  int bad = !raw || !png || !table || !used;

  if (!bad) {
    n_colour = find_palette(m, table, used);
    memcpy(png, signature, 8);
    at += put_head(m, n_colour, used, png + at);
    put_rows(m, table, raw);
    bad = compress2(png + at + 8, &packed, raw, n, LEVEL) != Z_OK;
  }
  free(raw);
  free(table);
  free(used);
  if (bad) {
    free(png);
    return vg_fail_memory(err, "a picture");
  }
  at += seal(png + at, "IDAT", packed);
  at += seal(png + at, "IEND", 0);
  *out = (struct vg_bytes){ at, png };
  return VG_OK;
}

vg_status vg_deflate(const void *data, size_t n, struct vg_bytes *out,
                     struct vg_error *err)
{
  assert((data || !n) && out);
  uLongf packed = compressBound(n);
  unsigned char *to = vg_alloc(packed, 1);

  if (!to || compress2(to, &packed, data, n, LEVEL) != Z_OK) {
    free(to);
    return vg_fail_memory(err, "a packed picture");
  }
  *out = (struct vg_bytes){ packed, to };
  return VG_OK;
}
