/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/store/store.h: outcomes of finished tasks, kept in a run
 * directory, so that an interrupted run can be resumed. Uses base only.
 *
 * The key of a record is the digest of everything that the task depends on
 * (its input, the sizing field, the options). A record can therefore never be
 * mistaken for another one, and a run on any number of ranks can use it.
 * Records are written to a temporary file with a checksum and then renamed, so
 * that only complete ones exist. */
#ifndef VG_PARTITION_STORE_STORE_H
#define VG_PARTITION_STORE_STORE_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "base/status.h"
#include "base/library.h"

/* XXH3, 128 bits. Equal digests are taken as equal input: with 10^9 tasks the
 * probability of a collision is below 10^-20. It does not protect against
 * forged records. */
struct vg_digest {
  uint64_t word[2];
};

/** Digest of n bytes, continued from `seed` (zeroed at the start). The split of
 * a sequence into calls matters: "ab" "c" differs from "a" "bc". */
struct vg_digest vg_digest_of(struct vg_digest seed, size_t n,
                              const void *data);

/** XXH3-128 of the rest of a file, as printed by xxhsum -H2, and the number of
 * bytes. Returns 0, or -1 with errno set. Threads: safe. */
int vg_digest_file(int fd, struct vg_digest *d, uint64_t *bytes);

struct vg_store;

struct vg_store_options {
  const char *dir;      /* Run directory, created if absent. */
  struct vg_digest job; /* Digest of input and options of the whole run. */
  /* A line that describes the run for people: kept in the directory, shown
   * in refusals; cut after 199 bytes. */
  const char *what;
  const char *settings; /* Lines of name=value, kept in the directory so that
                           a refusal can list the differences; may be NULL. */
  /* 1: records must exist and match; 0: the directory must hold none, not
   * even of the same job (they may be there by mistake). */
  int resume;
  /* Maximum of bytes kept over all ranks, including existing records;
   * further tasks are not kept; each rank has an equal share; 0: no limit. */
  uint64_t limit;
};

/** Opens or creates the run directory. Collective; rank 0 decides.
 *
 * It refuses the following directories, with the reason and the remedy: one
 * that cannot be written; one that belongs to another job because input or
 * options changed (the message describes both runs and lists the settings that
 * differ); a missing one on resume; one in which a run is active (lock, with
 * host and process); one that not all ranks see. A directory whose run kept
 * nothing is reused, and unrelated files in it stay. On failure everything
 * that was created is removed. */
vg_status vg_store_open(struct vg_comm *comm,
                        const struct vg_store_options *options,
                        struct vg_store **out, struct vg_error *err);

/** Returns VG_ERR_INPUT if the directory holds no run to resume, with the
 * message of vg_store_open. Call it before a long preparation. Not
 * collective. */
vg_status vg_store_has_run(const char *dir, struct vg_error *err);

/** Looks a record up. VG_OK: bytes out; VG_BLOCKED: there is no record, or a
 * damaged one (which is counted and removed). Threads: safe. */
vg_status vg_store_find(struct vg_store *s, struct vg_digest key,
                        struct vg_bytes *out, struct vg_error *err);

/** Keeps a record. A full disk or a reached limit is not a failure: the store
 * keeps no further records, remembers why, and the run continues. Threads:
 * safe. */
void vg_store_keep(struct vg_store *s, struct vg_digest key, size_t n,
                   const void *data);

struct vg_store_report {
  uint64_t n_found, n_kept, n_damaged, bytes_kept; /* Counts of this rank. */
  char stopped[256]; /* Why keeping stopped; "" if it did not. */
};
void vg_store_state(const struct vg_store *s, struct vg_store_report *r);

/** Releases the store. `remove` deletes the records, and the directory if it
 * holds nothing else. Collective. NULL accepted. */
void vg_store_close(struct vg_store *s, int remove);

/** Returns the version of xxHash. */
void vg_library_xxhash(struct vg_library *out);

#endif
