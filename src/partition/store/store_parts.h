/* partition/store/store_parts.h: what the files of the store share. In the run
 * directory lie run.txt (whose records these are), run.settings, run.lock, and
 * records/XX/KEY with KEY in 32 hexadecimal digits, XX its first two. All
 * names are relative to one descriptor of the directory. */
#ifndef VG_PARTITION_STORE_STORE_PARTS_H
#define VG_PARTITION_STORE_STORE_PARTS_H

#include <pthread.h>

#include "partition/store/store.h"

#define VG_STORE_RECORDS "records"
#define VG_STORE_NAME 96  /* room for a name and its ".part" */
#define VG_DIGEST_TEXT 33 /* a digest as text, with its end */

struct vg_store {
  struct vg_comm *comm;
  char *dir;             /* for messages */
  int fd;                /* the directory */
  int lock;              /* of rank 0; -1: none */
  int made, fresh;       /* 1: the directory, the run in it was
                            not there before */
  uint64_t limit;        /* as asked for */
  uint64_t share;        /* bytes that this rank may keep */
  pthread_mutex_t mutex; /* for all below */
  uint64_t used;         /* of the share, with what is being
                            written */
  uint64_t n_part;       /* temporary names so far */
  struct vg_store_report report;
};

void vg_digest_text(struct vg_digest d, char text[VG_DIGEST_TEXT]);

/** 1 and *d when text starts with 32 lower-case hexadecimal digits. */
int vg_digest_parse(const char *text, struct vg_digest *d);

/** Read or write all n bytes; returns 0, or errno; the end of a file that is
 * too short is EIO. */
int vg_store_get(int fd, void *data, size_t n);
int vg_store_put(int fd, const void *data, size_t n);

/** Go through the records: count them, or remove them and their folders.
 * What an interrupted write left is removed in either case. */
struct vg_store_tally {
  uint64_t n, bytes;
};
struct vg_store_tally vg_store_walk(int dir, int remove);

/** run.txt: whose records these are. VG_BLOCKED: there is none. `what` is cut
 * to fit. */
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

/** The directory is this process's until vg_store_unlock. */
vg_status vg_store_lock(struct vg_store *s, struct vg_error *err);
void vg_store_unlock(struct vg_store *s, int remove);

/** run.settings: its text (NULL: none) in the directory; gone with
 * vg_store_remove_run. */
vg_status vg_store_write_settings(const struct vg_store *s, const char *text,
                                  struct vg_error *err);
void vg_store_remove_settings(const struct vg_store *s);

/** What of `ours` is not as in the directory: "growth was 1.2, is 1.3; ", as
 * many as fit; "" where nothing is known to differ. size: 64 at least. */
void vg_store_compare_settings(const struct vg_store *s, const char *ours,
                               char *out, size_t size);

#endif
