/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/http/upload.h: uploaded files, one after the other. Each has a
 * temporary name until it is complete, and never overwrites an existing file.
 */
#ifndef VG_CLI_HTTP_UPLOAD_H
#define VG_CLI_HTTP_UPLOAD_H

#include <stdint.h>
#include <stddef.h>

#include "base/status.h"

struct vg_upload {
  int fd;            /* of the current file; -1: none */
  char *name, *path; /* of the current file, or of the last one */
  char *temporary;   /* temporary path; NULL: none */
  uint64_t size;     /* total size of all files */
  int n_whole;       /* number of complete files */
};
#define VG_UPLOAD_INIT                                                         \
  {                                                                            \
    -1, NULL, NULL, NULL, 0, 0                                                 \
  }

/** Commit the current file, if any, and begin a file `name` in the folder
 * `under` below root.
 * VG_ERR_INPUT: folder or name is invalid, or the file already exists. */
vg_status vg_upload_begin(struct vg_upload *u, const char *root,
                          const char *under, const char *name,
                          struct vg_error *err);

/** Append bytes. VG_ERR_INPUT: more than `most` in total; VG_ERR_IO: disk
 * full. */
vg_status vg_upload_put(struct vg_upload *u, const char *data, size_t size,
                        uint64_t most, struct vg_error *err);

/** Rename the current file, if any, to its final name. */
vg_status vg_upload_commit(struct vg_upload *u, struct vg_error *err);

/** Remove a file that is not committed, and free memory. Accepts
 * VG_UPLOAD_INIT. */
void vg_upload_release(struct vg_upload *u);

#endif
