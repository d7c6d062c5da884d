/* base/comm_parts.h: what the files behind base/comm.h share. */
#ifndef VG_BASE_COMM_PARTS_H
#define VG_BASE_COMM_PARTS_H

#include <mpi.h>
#include <pthread.h>
#include <stdatomic.h>

#include "base/comm.h"

/* Sets of processors by their number; more than any node has. */
struct vg_cores_mask {
  unsigned long word[8192 / (8 * sizeof(long))];
};

/* Tags on `all` outside collectives. */
enum { VG_TAG_EXCHANGE = 1, VG_TAG_PART = 2, VG_TAG_SIZE = 3 /* and 4 */ };

enum { VG_INCOMING_MAX = 64 };

struct vg_wakeup;       /* comm_wake.c */
struct vg_sent;         /* memory under way, until all requests are done */
struct vg_self_message; /* a message to oneself */

struct vg_incoming {
  struct vg_message message;
  MPI_Request *request; /* [n_request] */
  int n_request;
};

struct vg_comm {
  MPI_Comm all;          /* collectives, and parts of long messages */
  MPI_Comm message_comm; /* messages */
  MPI_Comm node;         /* ranks of this node */
  int rank, size, node_rank, node_size;
  int owns_mpi;               /* was started here */
  int apart;                  /* ranks of a node have no memory in common */
  size_t chunk;               /* bytes that go in one call of MPI, <= INT_MAX */
  int turn;                   /* 0 or 1: the tag of the next exchange's sizes */
  struct vg_cores_mask *core; /* [node_size], their binding when opened */
  struct vg_shmem wakeups;    /* memory of these: */
  struct vg_wakeup *wakeup;   /* [node_size] */
  int *wakeup_at;             /* [size] which is a rank's */

  pthread_mutex_t lock;  /* of what follows, to `received` */
  MPI_Request *request;  /* [n_request] of sends under way */
  struct vg_sent **sent; /* [n_request] what each of them sends */
  int *done;             /* [cap_request] */
  int n_request;
  size_t cap_request, cap_sent, cap_done;
  struct vg_self_message *first, **last;
  uint64_t posted; /* to others, ever */

  uint64_t received; /* from others, ever; the polling thread's */
  struct vg_incoming incoming[VG_INCOMING_MAX]; /* by time of arrival */
  int n_incoming;
};

/** VG_ERR_REMOTE with MPI's reason. */
vg_status vg_comm_fail(struct vg_error *err, const char *what, int rc);

/** Wait for requests [n] asleep. brisk: all ranks are known to be there, so
 * look more often for the sake of speed. Returns an MPI code. */
int vg_comm_wait(int n, MPI_Request *request, int brisk);

/** Sleep for a moment, between the looks-th look and the next, where all ranks
 * are known to be there. */
void vg_comm_nap(unsigned looks);

/** Cancel receives [n] that nobody will wait for, before their buffers go. 0:
 * they are done with; else MPI may still write, and the buffers must stay. */
int vg_comm_cancel_receives(int n, MPI_Request *request);

/** vg_comm_agree among the ranks of a communicator. */
vg_status vg_comm_agree_in(const struct vg_comm *c, MPI_Comm comm,
                           vg_status mine, struct vg_error *err);

/** Gather the bindings of the ranks of the node. Collective. */
vg_status vg_comm_cores_open(struct vg_comm *c, struct vg_error *err);

/** vg_comm_node_shmem; writes: ranks may change it. */
vg_status vg_comm_node_memory(struct vg_comm *c, size_t n_part,
                              const struct vg_bytes *part, int writes,
                              struct vg_shmem *out, struct vg_error *err);

/** Wakeups of the node. Collective. */
vg_status vg_comm_wakeups_open(struct vg_comm *c, struct vg_error *err);
void vg_comm_wakeups_close(struct vg_comm *c);

/** Wake another rank, if there is a way. Threads: safe. */
void vg_comm_wake_rank(struct vg_comm *c, int rank);

/** Take and drop messages until none is under way. Collective. */
void vg_comm_drain(struct vg_comm *c);

/** Memory of messages. */
void vg_comm_messages_release(struct vg_comm *c);

#endif
