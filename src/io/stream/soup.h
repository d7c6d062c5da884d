/* io/stream/soup.h: a surface that grows while a file without counts is read
 * (STL, OBJ): points, optionally welded by their bits, triangles, named
 * patches. */
#ifndef VG_IO_STREAM_SOUP_H
#define VG_IO_STREAM_SOUP_H

#include <stddef.h>
#include <stdint.h>

#include "base/table.h"
#include "core/mesh/mesh.h"

struct vg_soup {
  struct vg_mesh m; /* what has been collected; valid at any time */
  size_t cap_point, cap_tri, cap_tri_patch, cap_patch;
  struct vg_table weld;  /* points of vg_soup_weld */
  struct vg_table named; /* patches of vg_soup_named_patch */
};
#define VG_SOUP_INIT                                                           \
  {                                                                            \
    .cap_point = 0                                                             \
  }

void vg_soup_release(struct vg_soup *s);

/** Append a point; -0 becomes 0. `*at` is its index.
 * All appending functions return VG_ERR_MEMORY, or VG_ERR_UNSUPPORTED beyond
 * 2^32 - 2 items, and leave the soup valid. */
vg_status vg_soup_point(struct vg_soup *s, const double x[3], uint32_t *at,
                        struct vg_error *err);

/** Find the point that an earlier call of this function appended with exactly
 * these coordinates, or append it. O(1). */
vg_status vg_soup_weld(struct vg_soup *s, const double x[3], uint32_t *at,
                       struct vg_error *err);

/** Append a triangle of an existing patch. Its nodes may be points that come
 * later: the caller checks that they came. */
vg_status vg_soup_triangle(struct vg_soup *s, const uint32_t node[3],
                           uint32_t patch, struct vg_error *err);

/** Append a patch with id = number of patches + 1. The name loses white
 * space at its ends and what does not fit; control characters become '_'. */
vg_status vg_soup_patch(struct vg_soup *s, const char *name, size_t len,
                        uint32_t *at, struct vg_error *err);

/** The patch of that name, appended when new; not to be mixed with
 * vg_soup_patch. O(1). */
vg_status vg_soup_named_patch(struct vg_soup *s, const char *name, size_t len,
                              uint32_t *at, struct vg_error *err);

/** Move the surface to *out, without spare room; the soup is left empty. */
void vg_soup_finish(struct vg_soup *s, struct vg_mesh *out);

#endif
