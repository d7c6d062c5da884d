/* run/common/folder.h: folders for files of a run. Uses base. */
#ifndef VG_RUN_COMMON_FOLDER_H
#define VG_RUN_COMMON_FOLDER_H

#include "base/status.h"

/** Make a folder and those above it; one that exists is fine. */
vg_status vg_make_folder(const char *path, struct vg_error *err);

#endif
