/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Wakeups and signs of life; see base/comm.h. MPI has no wait that sleeps, so a
 * polling rank only notices a message at its next poll. Therefore each rank of
 * a node has a word of shared memory on which it sleeps, and which another rank
 * changes after it has posted a message. */
#define _GNU_SOURCE
#include <assert.h>
#include <linux/futex.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
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

/* --- signs of life -------------------------------------------------------- */

/* Rank 0 exchanges signs with all other ranks. A thread of its own sends and
 * receives them, so that a rank may compute for as long as it likes. */
struct vg_life {
  MPI_Comm comm;
  int rank, size;
  double limit;         /* seconds */
  double *heard;        /* [size] time of the last sign; vg_clock() */
  char (*host)[64];     /* [size] */
  MPI_Request *request; /* [size] the sign to each rank */
  pthread_t thread;
  pthread_mutex_t lock;
  pthread_cond_t end;
  int is_running, ends;
};

static int is_partner(const struct vg_life *l, int r)
{
  return r != l->rank && (!l->rank || !r);
}

static void hear(struct vg_life *l, double now)
{
  MPI_Message handle;
  MPI_Status status;
  int is_there = 1;
  char sign;

  while (
    !MPI_Improbe(MPI_ANY_SOURCE, 0, l->comm, &is_there, &handle, &status) &&
    is_there) {
    MPI_Mrecv(&sign, 1, MPI_BYTE, &handle, MPI_STATUS_IGNORE);
    l->heard[status.MPI_SOURCE] = now;
  }
}

static void give_signs(struct vg_life *l)
{
  static const char sign = 1;

  for (int r = 0; r < l->size; r++) {
    int is_sent = 1;

    if (!is_partner(l, r)) continue;
    MPI_Test(&l->request[r], &is_sent, MPI_STATUS_IGNORE);
    if (is_sent) MPI_Isend(&sign, 1, MPI_BYTE, r, 0, l->comm, &l->request[r]);
  }
}

static void end_if_silent(const struct vg_life *l, double now)
{
  char why[250];

  for (int r = 0; r < l->size; r++) {
    if (!is_partner(l, r) || now - l->heard[r] < l->limit) continue;
    snprintf(why, sizeof why,
             "rank %d on %s has given no sign of life for %g s, and the job "
             "ends; tasks kept in a run directory (--run-dir) continue with "
             "--resume",
             r, l->host[r], l->limit);
    vg_comm_abort(NULL, 1, why);
  }
}

/* If this process was stopped itself, it forgives the others their silence. */
static void *live(void *user)
{
  struct vg_life *l = user;
  const double period = l->limit / 6;
  double last = vg_clock();

  pthread_mutex_lock(&l->lock);
  while (!l->ends) {
    struct timespec until;
    double now;

    give_signs(l);
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += (time_t)period;
    until.tv_nsec += (long)(1e9 * (period - (double)(time_t)period));
    if (until.tv_nsec >= 1000000000)
      until.tv_sec++, until.tv_nsec -= 1000000000;
    pthread_cond_timedwait(&l->end, &l->lock, &until);
    now = vg_clock();
    for (int r = 0; r < l->size && now - last > 3 * period; r++)
      l->heard[r] = now;
    last = now;
    hear(l, now);
    if (!l->ends) end_if_silent(l, now);
  }
  pthread_mutex_unlock(&l->lock);
  return NULL;
}

static int is_traced(void)
{
  FILE *from = fopen("/proc/self/status", "r");
  char line[256];
  int pid = 0;

  while (from && fgets(line, sizeof line, from))
    if (sscanf(line, "TracerPid: %d", &pid) == 1) break;
  if (from) fclose(from);
  return pid != 0;
}

static void life_free(struct vg_life *l)
{
  if (l->comm != MPI_COMM_NULL) MPI_Comm_free(&l->comm);
  free(l->heard);
  free(l->host);
  free(l->request);
  free(l);
}

static struct vg_life *life_new(const struct vg_comm *c, double limit)
{
  struct vg_life *l = vg_calloc(1, sizeof *l);
  const double now = vg_clock();

  if (!l) return NULL;
  *l = (struct vg_life){
    .comm = MPI_COMM_NULL, .rank = c->rank, .size = c->size, .limit = limit
  };
  l->heard = vg_alloc((size_t)l->size, sizeof *l->heard);
  l->host = vg_calloc((size_t)l->size, sizeof *l->host);
  l->request = vg_alloc((size_t)l->size, sizeof *l->request);
  if (!l->heard || !l->host || !l->request) {
    life_free(l);
    return NULL;
  }
  for (int r = 0; r < l->size; r++) {
    l->heard[r] = now;
    l->request[r] = MPI_REQUEST_NULL;
  }
  gethostname(l->host[l->rank], sizeof *l->host - 1);
  return l;
}

/* The clock of the day may jump while the thread waits. */
static void life_start(struct vg_life *l)
{
  pthread_condattr_t clock;

  pthread_mutex_init(&l->lock, NULL);
  pthread_condattr_init(&clock);
  pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
  pthread_cond_init(&l->end, &clock);
  pthread_condattr_destroy(&clock);
  l->is_running = !pthread_create(&l->thread, NULL, live, l);
}

vg_status vg_comm_watch(struct vg_comm *c, double seconds, struct vg_error *err)
{
  struct vg_life *l;
  uint64_t traced = (uint64_t)is_traced();
  vg_status st;

  assert(seconds >= 0);
  if (!c || c->size == 1 || c->life || !(seconds > 0)) return VG_OK;
  if ((st = vg_comm_sum(c, 1, &traced, err)) < 0 || traced) return st;
  l = life_new(c, seconds);
  st = vg_comm_agree(c, l ? VG_OK : vg_fail_memory(err, "signs of life"), err);
  if (st >= 0 && (MPI_Comm_dup(c->all, &l->comm) ||
                  MPI_Allgather(MPI_IN_PLACE, 0, MPI_BYTE, l->host,
                                sizeof *l->host, MPI_BYTE, l->comm)))
    st = vg_fail(err, VG_ERR_REMOTE, "MPI cannot prepare signs of life");
  if (st >= 0) {
    life_start(l);
    if (!l->is_running) st = vg_fail_memory(err, "a thread");
    c->life = l;
  } else if (l) {
    life_free(l);
  }
  return vg_comm_agree(c, st, err);
}

void vg_comm_watch_end(struct vg_comm *c)
{
  struct vg_life *l = c->life;

  if (!l) return;
  c->life = NULL;
  pthread_mutex_lock(&l->lock);
  l->ends = 1;
  pthread_cond_signal(&l->end);
  pthread_mutex_unlock(&l->lock);
  if (l->is_running) pthread_join(l->thread, NULL);
  pthread_mutex_destroy(&l->lock);
  pthread_cond_destroy(&l->end);
  life_free(l);
}
