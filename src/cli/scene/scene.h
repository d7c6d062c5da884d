/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/scene/scene.h: a surface for the 3-D view of share/html/view.js, which
 * the report and the portal use. Uses core/mesh/mesh.h,
 * run/picture/decimate.h. */
#ifndef VG_CLI_SCENE_SCENE_H
#define VG_CLI_SCENE_SCENE_H

#include "base/comm.h"
#include "run/common/json_build.h"
#include "run/picture/decimate.h"

/** A decimated surface, sorted by patches. */
struct vg_scene {
  struct vg_decimated coarse;
  size_t *first; /* [n_patch + 1] first triangle of each patch in `order`. */
  size_t *order; /* [coarse.n_tri] triangles of `coarse`, by patch. */
  double centre[3], half[3], radius; /* Bounding box of the body. */
};
#define VG_SCENE_INIT                                                          \
  {                                                                            \
    .first = NULL                                                              \
  }

/** Decimate the triangles of m and find the box of the body.
 * @param body  [m->n_patch] 1 for patches of the body; all patches are taken if
 * no patch is marked
 * @param out   VG_SCENE_INIT; vg_scene_release, also on failure
 * VG_ERR_MEMORY. */
vg_status vg_scene_make(const struct vg_mesh *m, const uint8_t *body,
                        struct vg_scene *out, struct vg_error *err);

/** Accepts VG_SCENE_INIT. */
void vg_scene_release(struct vg_scene *s);

/** Pack points relative to the centre (4-byte reals), then the corners of the
 * triangles, each as the difference to the previous one, which compresses well,
 * then one byte per triangle for each of `n_by` arrays; compressed by zlib.
 * @param by   [n_by][m->n_tri] a byte for each triangle of the surface
 * @param out  free(out->data)
 * VG_ERR_MEMORY. */
vg_status vg_scene_pack(const struct vg_scene *s, size_t n_by,
                        const uint8_t *const *by, struct vg_bytes *out,
                        struct vg_error *err);

/** Counts, box and direction of view of the scene, and its patches with name,
 * colour and triangles, as view.js expects them: {points, triangles, merged,
 * radius, half, centre, toward, patches}. Names contain no '<', so that the
 * text can be part of a page. */
json_t *vg_scene_json(const struct vg_scene *s, const struct vg_mesh *m,
                      const uint8_t *body, const double toward[3]);

/** Colours of patches of the body, in turn, and of all others. */
enum { VG_PATCH_COLOURS = 12 };
extern const uint8_t vg_patch_colour[VG_PATCH_COLOURS][3];
extern const uint8_t vg_adjacent_colour[3];

#endif
