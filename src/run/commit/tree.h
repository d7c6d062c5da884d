/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/commit/tree.h: folders with their content. Uses base. */
#ifndef VG_RUN_COMMIT_TREE_H
#define VG_RUN_COMMIT_TREE_H

#include <stdint.h>

#include "base/status.h"

/** Removes a file, or a folder with its content. Symbolic links are not
 * followed. An absent path is no failure. Works without memory, so that a run
 * that has none left removes its files. Returns 0, or -1 with errno. */
int vg_tree_remove(const char *path);

/** Bytes of all files in a folder; 0 if it is absent. */
uint64_t vg_tree_bytes(const char *path);

/** fsync of all files and folders in a folder, and of the folder itself. */
vg_status vg_tree_sync(const char *path, struct vg_error *err);

/** fsync of a folder, which makes the names in it durable. A file system that
 * cannot do this is no failure. */
vg_status vg_folder_sync(const char *path, struct vg_error *err);

#endif
