/* partition/store/store.h: outcomes of finished tasks, kept in a run directory,
 * so that an interrupted run can go on. Uses base only.
 *
 * A record is found by the digest of what the task was given (its input, the
 * size field, the options), so it can never be mistaken for another, and a run
 * on any number of ranks can use it. Records are written aside, checksummed
 * and renamed: there are whole ones only. */
#ifndef VG_PARTITION_STORE_STORE_H
#define VG_PARTITION_STORE_STORE_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "base/status.h"
#include "base/library.h"

/* XXH3, 128 bits. Equal digests are taken as equal input: among 10^9 tasks the
 * chance of an accident is below 10^-20. It is no defence against records that
 * somebody forges. */
struct vg_digest {
  uint64_t word[2];
};

/** Digest of n bytes, continuing from `seed` (zeroed at the start). Where a
 * chain is cut into calls counts: "ab" "c" differs from "a" "bc". */
struct vg_digest vg_digest_of(struct vg_digest seed, size_t n,
                              const void *data);

/** XXH3-128 of what is left in a file, as xxhsum -H2 prints it, and the number
 * of bytes. 0, or -1 with errno set. Threads: safe. */
int vg_digest_file(int fd, struct vg_digest *d, uint64_t *bytes);

struct vg_store;

struct vg_store_options {
  const char *dir;      /* the run directory, made when absent */
  struct vg_digest job; /* of input and options of the whole run */
  const char *what;     /* a line that says what the run is, for people:
                           kept in the directory, shown in refusals; cut
                           after 199 bytes */
  const char *settings; /* lines of name=value, kept in the directory, so
                           that a refusal can say what differs; may be
                           NULL */
  int resume;           /* 1: records must be there and fit; 0: the
                           directory must hold none, not even of the same
                           job (they might be there by mistake) */
  uint64_t limit;       /* bytes to keep at most, over all ranks, with
                           what is there; tasks beyond it are not kept;
                           each rank has an equal share; 0: no limit */
};

/** Open or make the run directory. Collective; rank 0 decides.
 *
 * Refuses, with the reason and the remedy: a directory that cannot be written;
 * one that belongs to another job (changed input or options: says which of
 * both runs it was, and which settings differ); a resume without a directory; a
 * run that is under way in it (lock, with host and process); one that not all
 * ranks see. A directory whose run kept nothing is taken over, its files of
 * other names stay. What was made is removed again on failure. */
vg_status vg_store_open(struct vg_comm *comm,
                        const struct vg_store_options *options,
                        struct vg_store **out, struct vg_error *err);

/** VG_ERR_INPUT where the directory holds no run to be resumed, as opening it
 * would say; to be asked before a long preparation. Not collective. */
vg_status vg_store_has_run(const char *dir, struct vg_error *err);

/** Look a record up. VG_OK: bytes out; VG_BLOCKED: there is none, or a damaged
 * one (which is counted and removed). Threads: safe. */
vg_status vg_store_find(struct vg_store *s, struct vg_digest key,
                        struct vg_bytes *out, struct vg_error *err);

/** Keep a record. A full disk or a limit reached is no failure: the store
 * stops keeping, remembers why, and the run goes on. Threads: safe. */
void vg_store_keep(struct vg_store *s, struct vg_digest key, size_t n,
                   const void *data);

struct vg_store_report {
  uint64_t n_found, n_kept, n_damaged, bytes_kept; /* of this rank */
  char stopped[256]; /* why keeping stopped; "" if it did not */
};
void vg_store_state(const struct vg_store *s, struct vg_store_report *r);

/** Release; `remove` deletes the records, and the directory if nothing else is
 * in it. Collective. NULL accepted. */
void vg_store_close(struct vg_store *s, int remove);

/** Which xxHash this is. */
void vg_library_xxhash(struct vg_library *out);

#endif
