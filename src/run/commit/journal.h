/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/commit/journal.h: the list of moves that put a set of files into place,
 * in memory and in a file. Uses base. */
#ifndef VG_RUN_COMMIT_JOURNAL_H
#define VG_RUN_COMMIT_JOURNAL_H

#include <stddef.h>

#include "base/status.h"

enum vg_move_kind {
  VG_MOVE_FILE,   /* A file, which replaces an old one if that exists. */
  VG_MOVE_FOLDER, /* A folder with its content, in the same way. */
  VG_MOVE_REMOVE  /* No new file: the old file or folder is removed. */
};

struct vg_move {
  enum vg_move_kind kind;
  int had_old;            /* 1: the target exists before the commit. */
  unsigned long long ino; /* Inode of the new folder. */
  char *from, *to; /* Paths relative to the folders of new files and of targets;
                      `to` may be absolute. */
};

struct vg_journal {
  size_t n, cap;
  struct vg_move *move;
};

void vg_journal_release(struct vg_journal *j);

/** Appends a move; the paths are copied. */
vg_status vg_journal_add(struct vg_journal *j, enum vg_move_kind kind,
                         const char *from, const char *to,
                         struct vg_error *err);

/** Writes the moves to a file and to the disk (fsync). The file may be
 * incomplete after a failure. */
vg_status vg_journal_write(const struct vg_journal *j, const char *path,
                           struct vg_error *err);

/** Reads a file of vg_journal_write into *j, which is empty. VG_ERR_FORMAT if
 * it is damaged. */
vg_status vg_journal_read(const char *path, struct vg_journal *j,
                          struct vg_error *err);

#endif
