/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Wakeups; see base/comm.h. MPI has no wait that sleeps, so a polling rank only
 * notices a message at its next poll. Therefore each rank of a node has a word
 * of shared memory on which it sleeps, and which another rank changes after it
 * has posted a message. */
#define _GNU_SOURCE
#include <assert.h>
#include <linux/futex.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "base/comm_parts.h"
#include "base/memory.h"

/* Each wakeup has a cache line of its own. */
struct vg_wakeup {
  atomic_uint count, sleeps;
  char rest[VG_SHMEM_ALIGN - 2 * sizeof(atomic_uint)];
};

/* Set wakeup_at [size] to the index of each rank among the ranks of the node,
 * or MPI_UNDEFINED. Local. */
static int find_neighbours(struct vg_comm *c)
{
  MPI_Group all = MPI_GROUP_NULL, node = MPI_GROUP_NULL;
  int *rank = vg_alloc((size_t)c->size, sizeof *rank), rc;

  if (!rank || !c->wakeup_at) {
    free(rank);
    return MPI_ERR_NO_MEM;
  }
  for (int i = 0; i < c->size; i++) rank[i] = i;
  if (!(rc = MPI_Comm_group(c->all, &all)) &&
      !(rc = MPI_Comm_group(c->node, &node)))
    rc = MPI_Group_translate_ranks(all, c->size, rank, node, c->wakeup_at);
  if (all != MPI_GROUP_NULL) MPI_Group_free(&all);
  if (node != MPI_GROUP_NULL) MPI_Group_free(&node);
  free(rank);
  return rc;
}

vg_status vg_comm_wakeups_open(struct vg_comm *c, struct vg_error *err)
{
  size_t n = (size_t)c->node_size * sizeof *c->wakeup;
  struct vg_bytes none = { n, vg_calloc(n, 1) };
  vg_status st = VG_OK;

  c->wakeup_at = vg_alloc((size_t)c->size, sizeof *c->wakeup_at);
  if (!none.data || find_neighbours(c))
    st = vg_fail_memory(err, "the wakeups of ranks");
  st = vg_comm_agree_in(c, c->all, st, err);
  if (st >= 0) st = vg_comm_node_memory(c, 1, &none, 1, &c->wakeups, err);
  free(none.data);
  if (st >= 0) c->wakeup = (void *)(uintptr_t)c->wakeups.data;
  return vg_comm_agree_in(c, c->all, st, err);
}

void vg_comm_wakeups_close(struct vg_comm *c)
{
  vg_shmem_release(&c->wakeups);
  free(c->wakeup_at);
}

static void wake(struct vg_wakeup *b)
{
  atomic_fetch_add(&b->count, 1);
  if (atomic_load(&b->sleeps))
    syscall(SYS_futex, &b->count, FUTEX_WAKE, 1, NULL, NULL, 0);
}

/* Without shared memory each rank has private copies of all wakeups, of which
 * only its own is used. */
void vg_comm_wake_rank(struct vg_comm *c, int rank)
{
  if (c->wakeup_at[rank] != MPI_UNDEFINED && c->wakeups.is_mapped)
    wake(&c->wakeup[c->wakeup_at[rank]]);
}

void vg_comm_wake(struct vg_comm *c)
{
  wake(&c->wakeup[c->node_rank]);
}

unsigned vg_comm_wake_count(const struct vg_comm *c)
{
  return atomic_load(&c->wakeup[c->node_rank].count);
}

void vg_comm_sleep(struct vg_comm *c, unsigned heard, double seconds)
{
  assert(seconds >= 0);
  struct vg_wakeup *b = &c->wakeup[c->node_rank];
  const struct timespec t = {
    (time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))
  };

  atomic_store(&b->sleeps, 1);
  syscall(SYS_futex, &b->count, FUTEX_WAIT, heard, &t, NULL, 0);
  atomic_store(&b->sleeps, 0);
}
