/* base/comm.h: the ranks of a job. One process without a launcher is a job of
 * one rank and never touches MPI; under mpirun or srun MPI is used, with calls
 * from several threads. Only comm*.c of base see mpi.h.
 *
 * Collectives must be called by all ranks in the same order, each by one
 * thread. While a rank waits in one it sleeps between polls instead of
 * spinning, so that ranks which share cores do not take time from those that
 * work. NULL is a valid job of one rank everywhere. */
#ifndef VG_BASE_COMM_H
#define VG_BASE_COMM_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

struct vg_comm;

/** Bytes with their owner: free(data). */
struct vg_bytes {
  size_t n;
  unsigned char *data;
};

/** Join the job that a launcher started (found by its environment), or be one
 * rank alone. For a program of its own: starts MPI, which is told to use no
 * networks where all ranks are on one node, and shortens this process's naps.
 * Call once, before any thread is started.
 * *out is NULL for a job of one rank without a launcher.
 * VG_ERR_UNSUPPORTED where MPI does not allow calls from several threads, or
 * a launcher started processes that do not find each other. */
vg_status vg_comm_open(struct vg_comm **out, struct vg_error *err);

/** The ranks of a communicator, for a library in somebody's process: nothing
 * is looked for in the environment, and nothing of the process is changed.
 *
 * @param mpi  an MPI_Comm, as a pointer to it; duplicated. MPI has been
 *             started with MPI_THREAD_MULTIPLE and stays when this is closed
 * Collective over it. VG_ERR_UNSUPPORTED as above. */
vg_status vg_comm_of(const void *mpi, struct vg_comm **out,
                     struct vg_error *err);

/** The same by a Fortran handle of it. */
vg_status vg_comm_of_fortran(int handle, struct vg_comm **out,
                             struct vg_error *err);

/** Take so many ranks that follow each other for those of a node, whatever the
 * machine is like (for tests of what happens between nodes): they have memory
 * in common, others have not. Collective; before anything else. NULL: nothing
 * to do. */
vg_status vg_comm_take_for_nodes(struct vg_comm *c, int ranks,
                                 struct vg_error *err);

/** Leave the job; NULL accepted. Collective. */
void vg_comm_close(struct vg_comm *c);

/** End all ranks now, with an exit status: for what no rank can repair. Prints
 * nothing (the launcher may) and flushes nothing. Does not return. */
void vg_comm_abort(struct vg_comm *c, int exit_status)
  __attribute__((noreturn));

int vg_comm_rank(const struct vg_comm *c);
int vg_comm_size(const struct vg_comm *c);

/** Rank and number of ranks among those that share this node's memory. */
int vg_comm_node_rank(const struct vg_comm *c);
int vg_comm_node_size(const struct vg_comm *c);

/** The MPI_Comm, as a pointer to it; NULL in a job without MPI. For adapters
 * that need MPI themselves (io/stream/shared_file.c). */
const void *vg_comm_mpi(const struct vg_comm *c);

/* --- collectives --------------------------------------------------------- */

/** v: [n], replaced by the sum, or the maximum, over all ranks. */
vg_status vg_comm_sum(struct vg_comm *c, size_t n, uint64_t *v,
                      struct vg_error *err);
vg_status vg_comm_max(struct vg_comm *c, size_t n, double *v,
                      struct vg_error *err);

/** The bytes of rank `root` on every rank; elsewhere *b is replaced. Any
 * length. */
vg_status vg_comm_bcast(struct vg_comm *c, int root, struct vg_bytes *b,
                        struct vg_error *err);

/** As vg_comm_bcast among the ranks of a node, from its first. */
vg_status vg_comm_node_bcast(struct vg_comm *c, struct vg_bytes *b,
                             struct vg_error *err);

/** Bytes that the ranks of a node have in common, to be read. */
struct vg_shmem {
  size_t n;
  const unsigned char *data;
  int is_mapped;
};

enum { VG_SHMEM_ALIGN = 64 };

/** From the beginning of a part of n bytes to the next one's. */
static inline size_t vg_shmem_padded(size_t n)
{
  return (n + VG_SHMEM_ALIGN - 1) / VG_SHMEM_ALIGN * VG_SHMEM_ALIGN;
}

/** The parts [n_part] of the first rank of a node on all of its ranks: one
 * behind the other, each from a multiple of VG_SHMEM_ALIGN on. One copy in
 * memory that the ranks have in common, or one on each where the system
 * refuses that. Elsewhere n_part and part are not looked at.
 *
 * @param out  vg_shmem_release; untouched on failure, which all ranks of the
 *             node have. Local from then on: a rank may release it before
 *             others do */
vg_status vg_comm_node_shmem(struct vg_comm *c, size_t n_part,
                             const struct vg_bytes *part, struct vg_shmem *out,
                             struct vg_error *err);

void vg_shmem_release(struct vg_shmem *b);

/** Bytes of it that are in common; 0 where each rank has its copy. */
static inline size_t vg_shared_bytes(const struct vg_shmem *b)
{
  return b->is_mapped ? b->n : 0;
}

/** Bytes of every rank on every rank, in order of ranks: out [size], each to
 * be freed by the caller. */
vg_status vg_comm_allgather(struct vg_comm *c, const struct vg_bytes *mine,
                            struct vg_bytes *out, struct vg_error *err);

/** to: [size] one for each rank, kept by the caller; from: [size] what each
 * rank had for this one, to be freed by the caller. Any length. */
vg_status vg_comm_exchange(struct vg_comm *c, const struct vg_bytes *to,
                           struct vg_bytes *from, struct vg_error *err);

/** Free such a list of n, and what is in it. NULL is accepted. */
void vg_bytes_release(struct vg_bytes *list, size_t n);

/** All ranks take the worst status of all; where that is another rank's, *err
 * becomes its message with "rank N: " before it. So one rank's failure ends a
 * stage on all of them. Of several failures the lowest rank's, one with a
 * cause of its own before VG_ERR_REMOTE; any failure before an outcome > 0.
 * Returns what all return. */
vg_status vg_comm_agree(struct vg_comm *c, vg_status mine,
                        struct vg_error *err);

/** Let this process use the cores of all ranks of its node (on = 1), or its
 * own again: for stages that the first rank of a node does for the others,
 * who wait asleep. It is the calling thread that is bound, and what it starts
 * from then on. Returns the cores at hand, hyperthreads not counted. Local. */
int vg_comm_node_cores(struct vg_comm *c, int on);

/** The same without counting, which takes milliseconds. */
void vg_comm_bind_node(struct vg_comm *c, int on);

/** Threads that suit this rank's binding: the cores (not their hyperthreads)
 * it may use, divided among the ranks of the node that are bound to the same
 * ones; all of them where the launcher binds nothing. At least 1. Local. */
int vg_comm_default_threads(const struct vg_comm *c);

/* --- messages, for one thread that polls --------------------------------- */

struct vg_message {
  int from, kind;
  struct vg_bytes bytes;
};

/** Post a message; takes over b (b->data becomes NULL). Never blocks. A
 * message to oneself arrives like any other. Any length. Those of a rank to
 * another arrive in the order of posting. kind: 0 .. 16383.
 * On failure b stays the caller's, or is NULL. VG_ERR_UNSUPPORTED in a job
 * without MPI. Threads: safe. */
vg_status vg_comm_post(struct vg_comm *c, int to, int kind, struct vg_bytes *b,
                       struct vg_error *err);

/** Take one message that has arrived and free what was sent. VG_OK: *m is
 * the caller's; VG_BLOCKED: none. One thread only. Long messages move only
 * while both sides poll. What is under way when the job is left is dropped. */
vg_status vg_comm_poll(struct vg_comm *c, struct vg_message *m,
                       struct vg_error *err);

/** A count that changes when a rank of this node has posted to this one, or a
 * thread of this one has woken it: to be taken before vg_comm_poll. Messages
 * from other nodes do not count. Not in a job without MPI. */
unsigned vg_comm_wake_count(const struct vg_comm *c);

/** Sleep so long, or until the count is not `heard` any more; it may also
 * return without either. One thread only. */
void vg_comm_sleep(struct vg_comm *c, unsigned heard, double seconds);

/** Wake the thread that sleeps. Threads: safe. */
void vg_comm_wake(struct vg_comm *c);

#endif
