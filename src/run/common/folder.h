/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/common/folder.h: folders for the files of a run. Uses base,
 * run/commit. */
#ifndef VG_RUN_COMMON_FOLDER_H
#define VG_RUN_COMMON_FOLDER_H

#include "base/status.h"

/** Makes a folder and its missing parents, on the disk as well (fsync);
 * succeeds if it exists. */
vg_status vg_make_folder(const char *path, struct vg_error *err);

/** FOLDER/NAME in *out, owned by the caller; NULL on VG_ERR_MEMORY. */
vg_status vg_folder_path(const char *folder, const char *name, char **out,
                         struct vg_error *err);

#endif
