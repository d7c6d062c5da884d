/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/library.h: names and versions of the third-party libraries in use,
 * provided by the files that adapt them. */
#ifndef VG_BASE_LIBRARY_H
#define VG_BASE_LIBRARY_H

#ifdef __cplusplus
extern "C" {
#endif

/** Name and version in one line, as reported by the library itself at run time
 * where it can. */
struct vg_library {
  const char *name;
  char version[112];
};

#define VG_NOT_IN_BUILD "not in this build"

void vg_library_mpi(struct vg_library *out);   /* base/comm.c */
void vg_library_hwloc(struct vg_library *out); /* base/comm_cores.c */

#ifdef __cplusplus
}
#endif

#endif
