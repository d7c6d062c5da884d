/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/section/section_parts.h: checks of a section. Private to io/section. */
#ifndef VG_IO_SECTION_SECTION_PARTS_H
#define VG_IO_SECTION_SECTION_PARTS_H

#include "io/section/section.h"

/** VG_ERR_GEOMETRY, naming `path`, lines and coordinates, if a curve crosses or
 * touches itself or another one, or if an element is inside another one. */
vg_status vg_section_check(const struct vg_section *s, const char *path,
                           struct vg_error *err);

#endif
