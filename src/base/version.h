/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/version.h: identification of this program. */
#ifndef VG_BASE_VERSION_H
#define VG_BASE_VERSION_H

/** SHA-256 of all sources in hexadecimal (cmake/source_digest.cmake). Programs
 * with the same digest make the same meshes, however they were compiled. */
extern const char vg_source_digest[];

#endif
