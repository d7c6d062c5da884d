/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/common/folder.h: folders for the files of a run. Uses base,
 * run/commit. */
#ifndef VG_RUN_COMMON_FOLDER_H
#define VG_RUN_COMMON_FOLDER_H

#include "base/status.h"

/** Makes a folder and its missing parents, on the disk as well (fsync);
 * succeeds if it exists. */
vg_status vg_make_folder(const char *path, struct vg_error *err);

#endif
