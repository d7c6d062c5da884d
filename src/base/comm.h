/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/comm.h: the ranks of a job. One process without a launcher is a job of
 * one rank and never touches MPI. Under mpirun or srun, MPI is used with calls
 * from several threads. Only the files comm*.c of base include mpi.h.
 *
 * Collectives must be called by all ranks in the same order, each by one
 * thread. A rank that waits in one sleeps between polls instead of spinning, so
 * that it does not take time from working ranks on the same cores. NULL is a
 * valid job of one rank everywhere. */
#ifndef VG_BASE_COMM_H
#define VG_BASE_COMM_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

struct vg_comm;

/** A block of bytes, owned by the holder: free(data). */
struct vg_bytes {
  size_t n;
  unsigned char *data;
};

/** Join the job that a launcher has started (recognised by its environment), or
 * become a job of one rank. For programs that own their process: it initialises
 * MPI, without networks if all ranks are on one node, and reduces the timer
 * slack of this process. Call it once, before any thread is started.
 * *out is NULL for a job of one rank without a launcher.
 * VG_ERR_UNSUPPORTED: MPI does not allow calls from several threads, or the
 * launcher started processes that cannot find each other. */
vg_status vg_comm_open(struct vg_comm **out, struct vg_error *err);

/** Make a job from a communicator, for a library inside another program: it
 * does not read the environment and changes nothing of the process.
 *
 * @param mpi  address of an MPI_Comm, which is duplicated. MPI must have been
 *             initialised with MPI_THREAD_MULTIPLE; closing the job does not
 *             finalise it.
 * Collective over the communicator. VG_ERR_UNSUPPORTED as for vg_comm_open. */
vg_status vg_comm_of(const void *mpi, struct vg_comm **out,
                     struct vg_error *err);

/** As vg_comm_of, with a Fortran handle. */
vg_status vg_comm_of_fortran(int handle, struct vg_comm **out,
                             struct vg_error *err);

/** Treat each group of `ranks` consecutive ranks as a node, whatever the real
 * machine is, to test communication between nodes: only ranks of one group
 * share memory. Call it before any other function. NULL: does nothing.
 * Collective. */
vg_status vg_comm_take_for_nodes(struct vg_comm *c, int ranks,
                                 struct vg_error *err);

/** Leave the job. Accepts NULL. Collective. */
void vg_comm_close(struct vg_comm *c);

/** End all ranks at once with this exit status, after an error that no rank can
 * handle. Writes "rank N: WHY" to standard error, because no caller remains
 * that could, and flushes nothing. Does not return. */
void vg_comm_abort(struct vg_comm *c, int exit_status, const char *why)
  __attribute__((noreturn));

/** From now on until vg_comm_close, every rank gives signs of life to rank 0
 * and rank 0 to every rank. If none arrives for this time, vg_comm_abort ends
 * the rank that waits, and names the silent one. 0, or a debugger at any rank:
 * does nothing. Collective. */
vg_status vg_comm_watch(struct vg_comm *c, double seconds,
                        struct vg_error *err);

int vg_comm_rank(const struct vg_comm *c);
int vg_comm_size(const struct vg_comm *c);

/** Rank and number of ranks among those that share memory on this node. */
int vg_comm_node_rank(const struct vg_comm *c);
int vg_comm_node_size(const struct vg_comm *c);

/** Address of the MPI_Comm; NULL in a job without MPI. For adapters that need
 * MPI themselves (io/stream/shared_file.c). */
const void *vg_comm_mpi(const struct vg_comm *c);

/* --- collectives --------------------------------------------------------- */

/** Replace v [n] by the sum, or the maximum, over all ranks. */
vg_status vg_comm_sum(struct vg_comm *c, size_t n, uint64_t *v,
                      struct vg_error *err);
vg_status vg_comm_max(struct vg_comm *c, size_t n, double *v,
                      struct vg_error *err);

/** Send the bytes of rank `root` to all ranks, where *b is replaced. Any
 * length. */
vg_status vg_comm_bcast(struct vg_comm *c, int root, struct vg_bytes *b,
                        struct vg_error *err);

/** As vg_comm_bcast, from the first rank of a node to the others of that
 * node. */
vg_status vg_comm_node_bcast(struct vg_comm *c, struct vg_bytes *b,
                             struct vg_error *err);

/** Bytes that the ranks of a node share. */
struct vg_shmem {
  size_t n;
  const unsigned char *data;
  int is_mapped;
};

enum { VG_SHMEM_ALIGN = 64 };

/** Distance from the beginning of a part of n bytes to that of the next
 * part. */
static inline size_t vg_shmem_padded(size_t n)
{
  return (n + VG_SHMEM_ALIGN - 1) / VG_SHMEM_ALIGN * VG_SHMEM_ALIGN;
}

/** Make the parts [n_part] of the first rank of a node available on all its
 * ranks, one after the other, each aligned to VG_SHMEM_ALIGN. They are in
 * shared memory, or copied to each rank if the system refuses that. On the
 * other ranks, n_part and part are ignored.
 *
 * @param out  released by vg_shmem_release, which is local: a rank may call it
 *             before the others do. Unchanged on failure, which all ranks of
 *             the node return. Collective over the node. */
vg_status vg_comm_node_shmem(struct vg_comm *c, size_t n_part,
                             const struct vg_bytes *part, struct vg_shmem *out,
                             struct vg_error *err);

/** As vg_comm_node_shmem. With `writes`, ranks may change the memory; where
 * each rank has its own copy (!out->is_mapped), each must make the same
 * changes. Collective over the node. */
vg_status vg_comm_node_memory(struct vg_comm *c, size_t n_part,
                              const struct vg_bytes *part, int writes,
                              struct vg_shmem *out, struct vg_error *err);

void vg_shmem_release(struct vg_shmem *b);

/** Number of shared bytes; 0 if each rank has its own copy. */
static inline size_t vg_shared_bytes(const struct vg_shmem *b)
{
  return b->is_mapped ? b->n : 0;
}

/** Gather the bytes of every rank on every rank, in the order of the ranks. The
 * caller frees each of out [size]. */
vg_status vg_comm_allgather(struct vg_comm *c, const struct vg_bytes *mine,
                            struct vg_bytes *out, struct vg_error *err);

/** Send to[k] to rank k and receive from[k] from it. to: [size], remains the
 * caller's; from: [size], to be freed by the caller. Any length. */
vg_status vg_comm_exchange(struct vg_comm *c, const struct vg_bytes *to,
                           struct vg_bytes *from, struct vg_error *err);

/** Free a list of n blocks, and the blocks. Accepts NULL. */
void vg_bytes_release(struct vg_bytes *list, size_t n);

/** Agree on the worst status of all ranks, so that a failure on one rank ends
 * the stage on all of them. Where the failure occurred on another rank, *err
 * becomes its message preceded by "rank N: ". Of several failures the one on
 * the lowest rank counts, but VG_ERR_REMOTE only if there is no other. Any
 * failure takes precedence over an outcome > 0. All ranks return the same
 * status. */
vg_status vg_comm_agree(struct vg_comm *c, vg_status mine,
                        struct vg_error *err);

/** Allow this process to use the cores of all ranks of its node (on = 1), or
 * only its own again, for stages that the first rank of a node performs while
 * the others sleep. It binds the calling thread and the threads started from it
 * later. Returns the number of available cores, not counting hyperthreads.
 * Local. */
int vg_comm_node_cores(struct vg_comm *c, int on);

/** As vg_comm_node_cores, but without counting cores, which takes
 * milliseconds. */
void vg_comm_bind_node(struct vg_comm *c, int on);

/** Number of threads suitable for this rank: the cores it is bound to (not
 * hyperthreads), divided by the number of the node's ranks that are bound to
 * the same cores. Without binding by the launcher, these are all cores of the
 * node. At least 1. Local. */
int vg_comm_default_threads(const struct vg_comm *c);

/* --- messages, for one thread that polls --------------------------------- */

struct vg_message {
  int from, kind;
  struct vg_bytes bytes;
};

/** Send a message; takes over b (b->data becomes NULL). Never blocks. Messages
 * may be of any length; those from one rank to another arrive in the order in
 * which they were posted. A message to the own rank arrives like any other.
 * kind: 0 .. 16383.
 * On failure b still belongs to the caller, or is NULL. VG_ERR_UNSUPPORTED in a
 * job without MPI. Threads: safe. */
vg_status vg_comm_post(struct vg_comm *c, int to, int kind, struct vg_bytes *b,
                       struct vg_error *err);

/** Receive one message that has arrived, and free the memory of sent ones.
 * VG_OK: *m belongs to the caller; VG_BLOCKED: no message. Only one thread may
 * call it. Long messages advance only while both ranks poll. Messages that have
 * not arrived when the job is left are dropped. */
vg_status vg_comm_poll(struct vg_comm *c, struct vg_message *m,
                       struct vg_error *err);

/** Counter that changes when a rank of this node has posted a message to this
 * rank, or a thread of this rank has called vg_comm_wake. Read it before
 * vg_comm_poll. Messages from other nodes do not change it. Not for jobs
 * without MPI. */
unsigned vg_comm_wake_count(const struct vg_comm *c);

/** Sleep for this many seconds, or until the counter differs from `heard`; may
 * also return early. Only one thread may call it. */
void vg_comm_sleep(struct vg_comm *c, unsigned heard, double seconds);

/** Wake the sleeping thread. Threads: safe. */
void vg_comm_wake(struct vg_comm *c);

#endif
