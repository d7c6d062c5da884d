/* docs/pictures/png.h: a picture of samples as a PNG file. */
#ifndef VG_PICTURES_PNG_H
#define VG_PICTURES_PNG_H

#include <stdio.h>
#include <stdlib.h>
#include <zlib.h>

#include "base/memory.h"

static inline void png_put32(unsigned char *to, unsigned long v)
{
  for (int k = 0; k < 4; k++) to[k] = (unsigned char)(v >> (24 - 8 * k));
}

static inline void png_chunk(FILE *f, const char *name,
                             const unsigned char *data, size_t n)
{
  unsigned char word[4];
  unsigned long crc = crc32(0, (const unsigned char *)name, 4);

  if (n) crc = crc32(crc, data, (unsigned)n);
  png_put32(word, n);
  fwrite(word, 1, 4, f);
  fwrite(name, 1, 4, f);
  fwrite(data, 1, n, f);
  png_put32(word, crc);
  fwrite(word, 1, 4, f);
}

/* Mean of the samples of pixel x, y of a picture `width` pixels wide. */
static inline void png_pixel(int samples, int width,
                             const unsigned char (*rgb)[3], int x, int y,
                             unsigned char *to)
{
  for (int k = 0; k < 3; k++) {
    int sum = 0;

    for (int j = 0; j < samples * samples; j++)
      sum += rgb[(size_t)(y * samples + j / samples) *
                 (size_t)(width * samples) +
                 (size_t)(x * samples + j % samples)][k];
    to[k] = (unsigned char)(sum / (samples * samples));
  }
}

/** Write width x height pixels of samples x samples samples each, rows from
 * the top. 0 when all went well. */
static inline int png_write(const char *path, int width, int height,
                            int samples, const unsigned char (*rgb)[3])
{
  size_t row = 1 + 3 * (size_t)width;
  uLongf packed = compressBound(row * (size_t)height);
  unsigned char *raw = vg_calloc(row, (size_t)height);
  unsigned char *out = vg_alloc(packed, 1), head[13] = { 0 };
  FILE *f = fopen(path, "wb");
  int bad = !raw || !out || !f;

  for (int y = 0; !bad && y < height; y++)
    for (int x = 0; x < width; x++)
      png_pixel(samples, width, rgb, x, y,
                raw + (size_t)y * row + 1 + 3 * (size_t)x);
  bad = bad || compress2(out, &packed, raw, row * (size_t)height, 9) != Z_OK;
  if (!bad) {
    png_put32(head, (unsigned long)width);
    png_put32(head + 4, (unsigned long)height);
    head[8] = 8;   /* bits per channel */
    head[9] = 2;   /* RGB */
    fwrite("\211PNG\r\n\032\n", 1, 8, f);
    png_chunk(f, "IHDR", head, sizeof head);
    png_chunk(f, "IDAT", out, packed);
    png_chunk(f, "IEND", NULL, 0);
  }
  if (f && fclose(f)) bad = 1;
  free(raw);
  free(out);
  return bad;
}

#endif
