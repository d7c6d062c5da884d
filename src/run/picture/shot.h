/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/picture/shot.h: renders a surface: the visible triangle at each sample
 * and its brightness. Colours are applied afterwards, so one shot can be used
 * for several pictures. Uses core/mesh/mesh.h, run/picture/image.h. */
#ifndef VG_RUN_PICTURE_SHOT_H
#define VG_RUN_PICTURE_SHOT_H

#include "core/mesh/mesh.h"
#include "run/picture/image.h"

/** An orthographic view. */
struct vg_camera {
  double right[3], up[3], toward[3]; /* Orthonormal; toward: to the eye. */
  double centre[3];                  /* Centre of the picture. */
  double scale;                      /* Pixels per unit length. */
  int width, height;                 /* Pixels. */
};

/** Aims a camera from the direction `toward` (any length, not along z), with z
 * up, so that the bounding box of the marked triangles just fits.
 * @param is_seen  [m->n_tri] */
void vg_camera_aim(const struct vg_mesh *m, const uint8_t *is_seen,
                   const double toward[3], int width, int height,
                   struct vg_camera *c);

/** Position of a point in pixels from the upper left corner; out[2]: how near
 * it is. */
void vg_camera_see(const struct vg_camera *c, const double x[3], double out[3]);

struct vg_shot {
  int width, height; /* Samples. */
  uint32_t *tri;     /* [height * width] triangle or VG_SHOT_NOTHING. */
  uint8_t *light;    /* [height * width], private to shot.c. */
};
#define VG_SHOT_INIT                                                           \
  {                                                                            \
    0, 0, NULL, NULL                                                           \
  }
#define VG_SHOT_NOTHING UINT32_MAX
#define VG_SHOT_BEHIND 255

/** Draws those marked triangles whose front faces the eye: the outside of a
 * body, or the far side of a domain. *s must be empty. Memory: 9 bytes per
 * sample, 24 per point, 4 per triangle. VG_ERR_MEMORY. */
vg_status vg_shot_take(const struct vg_mesh *m, const uint8_t *is_seen,
                       const struct vg_camera *c, int threads,
                       struct vg_shot *s, struct vg_error *err);

void vg_shot_release(struct vg_shot *s);

/** The picture in which triangle t has colour palette[colour[t]]. Triangles of
 * colour VG_SHOT_BEHIND are background and have uniform brightness.
 * VG_ERR_MEMORY. */
vg_status vg_shot_image(const struct vg_shot *s, const uint8_t *colour,
                        const uint8_t (*palette)[3], struct vg_image *out,
                        struct vg_error *err);

#endif
