/* run/picture/image.h: pixels, and a PNG of them. Uses base; the adapter of
 * zlib for pictures. */
#ifndef VG_RUN_PICTURE_IMAGE_H
#define VG_RUN_PICTURE_IMAGE_H

#include <stdint.h>

#include "base/comm.h"
#include "base/status.h"

/** Rows from the top; red, green, blue, opacity. */
struct vg_image {
  int width, height;
  uint8_t (*rgba)[4]; /* [height * width]; owned */
};
#define VG_IMAGE_INIT                                                          \
  {                                                                            \
    0, 0, NULL                                                                 \
  }

/** Clear pixels. *m is empty. VG_ERR_MEMORY. */
vg_status vg_image_new(int width, int height, struct vg_image *m,
                       struct vg_error *err);

void vg_image_release(struct vg_image *m);

/** The picture as a PNG file of at most 256 colours in memory; free(out->data).
 * Brightness is kept to 5 bits and opacity to quarters; where that leaves more
 * than 256 colours the rarest become the nearest of the others. A mesh's thin
 * lines pack to a third of what they would need in full colour. The same
 * pixels make the same bytes with the same zlib. */
vg_status vg_image_png(const struct vg_image *m, struct vg_bytes *out,
                       struct vg_error *err);

/** Bytes as a zlib stream, which browsers unpack; free(out->data). */
vg_status vg_deflate(const void *data, size_t n, struct vg_bytes *out,
                     struct vg_error *err);

#endif
