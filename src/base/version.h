/* base/version.h: which program this is. */
#ifndef VG_BASE_VERSION_H
#define VG_BASE_VERSION_H

/** SHA-256 of all sources, as hexadecimal digits (cmake/source_digest.cmake):
 * programs of the same digest make the same meshes, however they were
 * compiled. */
extern const char vg_source_digest[];

#endif
