/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/http/archive.h: the files of a folder as one download, a tar file that is
 * made while it is sent, so that it needs neither memory nor disk. */
#ifndef VG_CLI_HTTP_ARCHIVE_H
#define VG_CLI_HTTP_ARCHIVE_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "base/status.h"

/* Limits of an archive: files, and levels of folders. */
enum { VG_ARCHIVE_FILES = 20000, VG_ARCHIVE_DEPTH = 8 };

struct vg_archive;

/** List the regular files below `dir`; links and hidden files are skipped.
 * @param prefix  folder of all files within the archive
 * @param skip    name of a folder in `dir` that is left out, or NULL
 * VG_ERR_INPUT: too many files. */
vg_status vg_archive_open(const char *dir, const char *prefix, const char *skip,
                          struct vg_archive **out, struct vg_error *err);

/** Size of the archive, bytes. */
uint64_t vg_archive_size(const struct vg_archive *a);

/** The next bytes, at most `most`; 0 at the end, -1 if a file has become
 * shorter or cannot be read. */
ssize_t vg_archive_read(struct vg_archive *a, char *to, size_t most);

/** Accepts NULL. */
void vg_archive_free(struct vg_archive *a);

#endif
