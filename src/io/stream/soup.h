/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/soup.h: a surface that grows while a file without counts (STL, OBJ)
 * is read: points, which may be merged if all their bits are equal, triangles
 * and named patches. */
#ifndef VG_IO_STREAM_SOUP_H
#define VG_IO_STREAM_SOUP_H

#include <stddef.h>
#include <stdint.h>

#include "base/table.h"
#include "core/mesh/mesh.h"

struct vg_soup {
  struct vg_mesh m; /* surface collected so far; always valid */
  size_t cap_point, cap_tri, cap_tri_patch, cap_patch;
  struct vg_table weld;  /* points added by vg_soup_weld */
  struct vg_table named; /* patches added by vg_soup_named_patch */
};
#define VG_SOUP_INIT                                                           \
  {                                                                            \
    .cap_point = 0                                                             \
  }

void vg_soup_release(struct vg_soup *s);

/** Append a point; -0 becomes 0. `*at` is its index. All functions that append
 * return VG_ERR_MEMORY, or VG_ERR_UNSUPPORTED beyond 2^32 - 2 items, and leave
 * the soup valid. */
vg_status vg_soup_point(struct vg_soup *s, const double x[3], uint32_t *at,
                        struct vg_error *err);

/** Find the point with exactly these coordinates that this function has
 * appended before, or append it. O(1). */
vg_status vg_soup_weld(struct vg_soup *s, const double x[3], uint32_t *at,
                       struct vg_error *err);

/** Append a triangle of an existing patch. Its nodes may be points that are
 * appended later; the caller checks that they have been. */
vg_status vg_soup_triangle(struct vg_soup *s, const uint32_t node[3],
                           uint32_t patch, struct vg_error *err);

/** Append a patch with id = number of patches + 1. White space at the ends of
 * the name is removed, control characters become '_', and a name that is too
 * long is shortened. */
vg_status vg_soup_patch(struct vg_soup *s, const char *name, size_t len,
                        uint32_t *at, struct vg_error *err);

/** Find the patch with this name, or append it. Must not be combined with
 * vg_soup_patch. O(1). */
vg_status vg_soup_named_patch(struct vg_soup *s, const char *name, size_t len,
                              uint32_t *at, struct vg_error *err);

/** Move the surface to *out, without unused memory; the soup is empty
 * afterwards. */
void vg_soup_finish(struct vg_soup *s, struct vg_mesh *out);

#endif
