/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/picture/image.h: pixels, and their conversion to PNG. Uses base; the
 * adapter of zlib for pictures. */
#ifndef VG_RUN_PICTURE_IMAGE_H
#define VG_RUN_PICTURE_IMAGE_H

#include <stdint.h>

#include "base/comm.h"
#include "base/status.h"

/** Rows from the top; red, green, blue, opacity. */
struct vg_image {
  int width, height;
  uint8_t (*rgba)[4]; /* [height * width]; owned. */
};
#define VG_IMAGE_INIT                                                          \
  {                                                                            \
    0, 0, NULL                                                                 \
  }

/** Transparent pixels. *m must be empty. VG_ERR_MEMORY. */
vg_status vg_image_new(int width, int height, struct vg_image *m,
                       struct vg_error *err);

void vg_image_release(struct vg_image *m);

/** Converts the picture to a PNG file in memory with at most 256 colours;
 * free(out->data). Colours are reduced to 5 bits per channel and opacity to
 * quarters. If more than 256 colours remain, the rarest are replaced by the
 * nearest of the others. The thin lines of a mesh then compress to a third of
 * the size in full colour. The same pixels give the same bytes with the same
 * zlib. */
vg_status vg_image_png(const struct vg_image *m, struct vg_bytes *out,
                       struct vg_error *err);

/** Compresses bytes to a zlib stream, which browsers can decompress;
 * free(out->data). */
vg_status vg_deflate(const void *data, size_t n, struct vg_bytes *out,
                     struct vg_error *err);

#endif
