/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/store/store_parts.h: declarations shared by the files of the
 * store. The run directory holds run.txt (the job that the records belong to),
 * run.settings, run.lock, and records/XX/KEY, where KEY has 32 hexadecimal
 * digits and XX are its first two. All names are relative to one descriptor of
 * the directory. */
#ifndef VG_PARTITION_STORE_STORE_PARTS_H
#define VG_PARTITION_STORE_STORE_PARTS_H

#include <pthread.h>

#include "partition/store/store.h"

#define VG_STORE_RECORDS "records"
#define VG_STORE_NAME 96  /* room for a name and its ".part" */
#define VG_DIGEST_TEXT 33 /* digest as text with its terminator */

struct vg_store {
  struct vg_comm *comm;
  char *dir;       /* Path, for messages. */
  int fd;          /* Descriptor of the directory. */
  int lock;        /* Lock file of rank 0; -1: none. */
  int made, fresh; /* 1: this process created the directory; the run in it. */
  uint64_t limit;  /* As requested. */
  uint64_t share;  /* Bytes that this rank may keep. */
  pthread_mutex_t mutex; /* Guards all members below. */
  uint64_t used; /* Used part of the share, including records being written. */
  uint64_t n_part; /* Number of temporary names so far. */
  struct vg_store_report report;
};

void vg_digest_text(struct vg_digest d, char text[VG_DIGEST_TEXT]);

/** Returns 1 and *d if text starts with 32 lower-case hexadecimal digits. */
int vg_digest_parse(const char *text, struct vg_digest *d);

/** Reads or writes all n bytes; returns 0 or errno. A file that is too short
 * gives EIO. */
int vg_store_get(int fd, void *data, size_t n);
int vg_store_put(int fd, const void *data, size_t n);

/** Goes through the records and counts them, or removes them and their folders.
 * Remainders of interrupted writes are removed in either case. */
struct vg_store_tally {
  uint64_t n, bytes;
};
struct vg_store_tally vg_store_walk(int dir, int remove);

/** run.txt, which describes the job of the records. VG_BLOCKED: there is no
 * such file. `what` is truncated to fit. */
struct vg_store_run {
  struct vg_digest job;
  char what[200];
};
vg_status vg_store_read_run(const struct vg_store *s, struct vg_store_run *run,
                            struct vg_error *err);
vg_status vg_store_write_run(const struct vg_store *s,
                             const struct vg_store_run *run,
                             struct vg_error *err);
void vg_store_remove_run(const struct vg_store *s);

/** Locks the directory for this process until vg_store_unlock. */
vg_status vg_store_lock(struct vg_store *s, struct vg_error *err);
void vg_store_unlock(struct vg_store *s, int remove);

/** Writes the text (NULL: none) to run.settings; vg_store_remove_run removes
 * it. */
vg_status vg_store_write_settings(const struct vg_store *s, const char *text,
                                  struct vg_error *err);
void vg_store_remove_settings(const struct vg_store *s);

/** Lists the settings of `ours` that differ from the directory: "growth was
 * 1.2, is 1.3; ", as many as fit; "" if no difference is known. size: at least
 * 64. */
void vg_store_compare_settings(const struct vg_store *s, const char *ours,
                               char *out, size_t size);

#endif
