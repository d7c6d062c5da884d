/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* docs/pictures/png.h: writes a picture of samples as a PNG file. */
#ifndef VG_PICTURES_PNG_H
#define VG_PICTURES_PNG_H

#include <stdio.h>
#include <stdlib.h>

#include "run/picture/image.h"

/* Mean of the samples of pixel x, y of a picture `width` pixels wide. */
static inline void png_pixel(int samples, int width,
                             const unsigned char (*rgb)[3], int x, int y,
                             uint8_t *to)
{
  for (int k = 0; k < 3; k++) {
    int sum = 0;

    for (int j = 0; j < samples * samples; j++)
      sum +=
        rgb[(size_t)(y * samples + j / samples) * (size_t)(width * samples) +
            (size_t)(x * samples + j % samples)][k];
    to[k] = (uint8_t)(sum / (samples * samples));
  }
  to[3] = 255;
}

/** Write width x height pixels of samples x samples samples each, rows from
 * the top. Returns 0 on success. */
static inline int png_write(const char *path, int width, int height,
                            int samples, const unsigned char (*rgb)[3])
{
  struct vg_image m = VG_IMAGE_INIT;
  struct vg_bytes png = { 0 };
  FILE *f = NULL;
  int bad = vg_image_new(width, height, &m, NULL) < 0;

  for (int y = 0; !bad && y < height; y++)
    for (int x = 0; x < width; x++)
      png_pixel(samples, width, rgb, x, y,
                m.rgba[(size_t)y * (size_t)width + (size_t)x]);
  bad = bad || vg_image_png(&m, &png, NULL) < 0 || !(f = fopen(path, "wb"));
  bad = bad || fwrite(png.data, 1, png.n, f) != png.n;
  if (f && fclose(f)) bad = 1;
  vg_image_release(&m);
  free(png.data);
  return bad;
}

#endif
