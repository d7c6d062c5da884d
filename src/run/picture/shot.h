/* run/picture/shot.h: a surface seen from somewhere: which triangle shows at
 * each sample, and how bright; colours come afterwards, so one shot makes
 * several pictures. Uses core/mesh/mesh.h, run/picture/image.h. */
#ifndef VG_RUN_PICTURE_SHOT_H
#define VG_RUN_PICTURE_SHOT_H

#include "core/mesh/mesh.h"
#include "run/picture/image.h"

/** An orthographic view. */
struct vg_camera {
  double right[3], up[3], toward[3]; /* orthonormal; toward: to the eye */
  double centre[3];                  /* of the picture */
  double scale;                      /* pixels per length */
  int width, height;                 /* pixels */
};

/** Look from `toward` (any length, not along z), z up, at the box of the
 * points of the marked triangles, which just fits.
 * @param is_seen  [m->n_tri] */
void vg_camera_aim(const struct vg_mesh *m, const uint8_t *is_seen,
                   const double toward[3], int width, int height,
                   struct vg_camera *c);

/** Where a point is, pixels from the upper left corner; out[2]: how near. */
void vg_camera_see(const struct vg_camera *c, const double x[3], double out[3]);

struct vg_shot {
  int width, height; /* samples */
  uint32_t *tri;     /* [height * width] or VG_SHOT_NOTHING */
  uint8_t *light;    /* [height * width], private to shot.c */
};
#define VG_SHOT_INIT                                                           \
  {                                                                            \
    0, 0, NULL, NULL                                                           \
  }
#define VG_SHOT_NOTHING UINT32_MAX
#define VG_SHOT_BEHIND 255

/** Draw the marked triangles, those that turn their front to the eye only: of
 * a body from outside it shows the skin, of a domain what is at its back.
 * *s: empty. Memory: 9 bytes per sample, 24 per point, 4 per triangle.
 * VG_ERR_MEMORY. */
vg_status vg_shot_take(const struct vg_mesh *m, const uint8_t *is_seen,
                       const struct vg_camera *c, int threads,
                       struct vg_shot *s, struct vg_error *err);

void vg_shot_release(struct vg_shot *s);

/** The picture in which triangle t has colour palette[colour[t]]; colour
 * VG_SHOT_BEHIND is of what stands behind: it is evenly bright.
 * VG_ERR_MEMORY. */
vg_status vg_shot_image(const struct vg_shot *s, const uint8_t *colour,
                        const uint8_t (*palette)[3], struct vg_image *out,
                        struct vg_error *err);

#endif
