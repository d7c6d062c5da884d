/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/comm_parts.h: declarations shared by the comm*.c files. Private to
 * base. */
#ifndef VG_BASE_COMM_PARTS_H
#define VG_BASE_COMM_PARTS_H

#include <mpi.h>
#include <pthread.h>
#include <stdatomic.h>

#include "base/comm.h"

/* MPICH's MPI_STATUSES_IGNORE is the address 1, at which GCC sees an array
 * without elements. */
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#endif

/* Set of processors, by their numbers; larger than any node. */
struct vg_cores_mask {
  unsigned long word[8192 / (8 * sizeof(long))];
};

/* Tags used on the communicator `all` outside of collectives. */
enum { VG_TAG_EXCHANGE = 1, VG_TAG_PART = 2, VG_TAG_SIZE = 3 /* and 4 */ };

enum { VG_INCOMING_MAX = 64 };

struct vg_wakeup; /* see comm_wake.c */
struct vg_sent;   /* memory of a message being sent, until all its requests are
                     complete */
struct vg_self_message; /* a message from this rank to itself */

struct vg_incoming {
  struct vg_message message;
  MPI_Request one;      /* of a short message */
  MPI_Request *request; /* [n_request] of a long one; else NULL */
  int n_request;
};

struct vg_comm {
  MPI_Comm all;          /* for collectives and parts of long messages */
  MPI_Comm message_comm; /* for messages */
  MPI_Comm node;         /* the ranks of this node */
  int rank, size, node_rank, node_size;
  int owns_mpi; /* MPI was initialised by vg_comm_open */
  int apart;    /* the ranks of this node share no memory */
  size_t chunk; /* largest number of bytes per MPI call, <= INT_MAX */
  int turn;     /* 0 or 1: selects the tag for the sizes of the next exchange */
  struct vg_cores_mask *core; /* [node_size] affinity of each rank when the
                                 job was opened */
  struct vg_shmem wakeups;    /* shared memory that holds `wakeup` */
  struct vg_wakeup *wakeup;   /* [node_size] one for each rank of the node */
  int *wakeup_at;             /* [size] index of each rank's wakeup */

  pthread_mutex_t lock;  /* protects the members from here to `posted` */
  MPI_Request *request;  /* [n_request] unfinished sends */
  struct vg_sent **sent; /* [n_request] message that each request belongs to */
  int *done;             /* [cap_request] */
  int n_request;
  size_t cap_request, cap_sent, cap_done;
  struct vg_self_message *first, **last;
  uint64_t posted; /* messages to other ranks since the job was opened */

  uint64_t received; /* messages from other ranks since then; only used by
                        the polling thread */
  struct vg_incoming incoming[VG_INCOMING_MAX]; /* in order of arrival */
  int n_incoming;
  int has_lost_parts;   /* no memory for a long message */
  struct vg_life *life; /* NULL: no signs of life */
};

/** Ends the signs of life of this rank. */
void vg_comm_watch_end(struct vg_comm *c);

/** Fail with VG_ERR_REMOTE and MPI's description of the error rc. */
vg_status vg_comm_fail(struct vg_error *err, const char *what, int rc);

/** Wait for requests [n], sleeping between polls. brisk: all ranks are known to
 * take part, so poll more often. Returns an MPI error code. */
int vg_comm_wait(int n, MPI_Request *request, int brisk);

/** Sleep briefly after poll number `looks`, when all ranks are known to take
 * part. */
void vg_comm_nap(unsigned looks);

/** Cancel receives [n] that nobody will wait for, before their buffers are
 * freed. Returns 0 if they have ended; otherwise MPI may still write into the
 * buffers, which must be kept. */
int vg_comm_cancel_receives(int n, MPI_Request *request);

/** As vg_comm_agree, among the ranks of a communicator. */
vg_status vg_comm_agree_in(const struct vg_comm *c, MPI_Comm comm,
                           vg_status mine, struct vg_error *err);

/** Gather the CPU affinities of the ranks of the node. Collective. */
vg_status vg_comm_cores_open(struct vg_comm *c, struct vg_error *err);

/** Create the wakeups of the node. Collective. */
vg_status vg_comm_wakeups_open(struct vg_comm *c, struct vg_error *err);
void vg_comm_wakeups_close(struct vg_comm *c);

/** Wake another rank if it is on this node. Threads: safe. */
void vg_comm_wake_rank(struct vg_comm *c, int rank);

/** Receive and drop messages until none is in transit. Collective. */
void vg_comm_drain(struct vg_comm *c);

/** Free the memory of all messages. */
void vg_comm_messages_release(struct vg_comm *c);

#endif
