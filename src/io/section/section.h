/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/section/section.h: reads plane sections of aerofoils, text files of
 * coordinates x y (".dat", formats.md 3.4), for meshes in two dimensions. A
 * section has one or several elements. Uses io/stream/stream.h.
 *
 * A line that does not begin with a number is the title of the next element.
 * Two orders of points are in use:
 *
 *   Selig       from the trailing edge along the upper side to the leading
 *               edge and back along the lower side, in one block; either side
 *               may come first
 *   Lednicer    a line with the numbers of points of both sides, then the
 *               upper and the lower side, each from the leading edge
 *
 * The order follows from the content: the line of counts. Blank lines and lines
 * "999 999" separate blocks. In Selig's order each block is an element. */
#ifndef VG_IO_SECTION_SECTION_H
#define VG_IO_SECTION_SECTION_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

#define VG_SECTION_SUFFIX ".dat"

/** A closed curve. Its points run counter-clockwise from the trailing edge and
 * are distinct. The last point is joined to the first one: where the file
 * leaves a gap there, the section has a blunt trailing edge. */
struct vg_section_element {
  char name[VG_NAME_MAX]; /* Title; "" if the file has none. */
  size_t first, n;        /* Its points in the section. */
};

struct vg_section {
  size_t n, cap, n_point, cap_point, cap_line;
  struct vg_section_element *element; /* [n] owned */
  double (*x)[2];                     /* [n_point] owned */
  size_t *line;                       /* [n_point] lines of the file; owned */
};
#define VG_SECTION_INIT                                                        \
  {                                                                            \
    0                                                                          \
  } /* releasing this is a no-op */

void vg_section_release(struct vg_section *s);

/** 1 if the name has the suffix of a section, also compressed (.gz). */
int vg_section_is(const char *path);

/** Length of that suffix; 0: the name is not that of a section. */
size_t vg_section_suffix_length(const char *path);

/** Reads a section into the empty *out, which is unchanged on failure.
 *
 * VG_ERR_FORMAT, with file and line: a line that is no point, NaN, counts that
 * disagree with the points, an order that is not clear (the message names both
 * readings). VG_ERR_GEOMETRY, with the lines and coordinates: repeated points,
 * too few points, open curves, curves that cross themselves or each other, one
 * element inside another. VG_ERR_IO, VG_ERR_MEMORY. O(n log n). */
vg_status vg_section_read(const char *path, struct vg_section *out,
                          struct vg_error *err);
vg_status vg_section_parse(struct vg_input *in, struct vg_section *out,
                           struct vg_error *err);

#endif
