/* Private to cli/serve: files that a browser brings, one after the other. Each
 * has another name until it is whole, and never takes the place of one that is
 * there. */
#ifndef VG_CLI_SERVE_UPLOAD_H
#define VG_CLI_SERVE_UPLOAD_H

#include <stdint.h>
#include <stddef.h>

#include "base/status.h"

struct vg_upload {
  int fd;            /* of the file under way; -1: none */
  char *name, *path; /* of it, or of the last one */
  char *temporary;   /* what it is called so far; NULL: none */
  uint64_t size;     /* of all files */
  int n_whole;       /* files that are there */
};
#define VG_UPLOAD_INIT                                                         \
  {                                                                            \
    -1, NULL, NULL, NULL, 0, 0                                                 \
  }

/** Begin a file `name` in the folder `under` below root; one that is under way
 * is committed.
 * VG_ERR_INPUT: the folder or name cannot be, or the file is there already. */
vg_status vg_upload_begin(struct vg_upload *u, const char *root,
                          const char *under, const char *name,
                          struct vg_error *err);

/** Add bytes. VG_ERR_INPUT: more than `most` in all; VG_ERR_IO: disk full. */
vg_status vg_upload_put(struct vg_upload *u, const char *data, size_t size,
                        uint64_t most, struct vg_error *err);

/** Give it its name; nothing happens when none is under way. */
vg_status vg_upload_commit(struct vg_upload *u, struct vg_error *err);

/** Drop what is not committed. Accepts VG_UPLOAD_INIT. */
void vg_upload_release(struct vg_upload *u);

#endif
