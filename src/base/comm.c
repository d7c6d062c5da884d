/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Joining and leaving a job, and waiting without spinning; see base/comm.h. */
#include "base/comm.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sched.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/comm_parts.h"
#include "base/library.h"
#include "base/memory.h"

#define ABORT_SECONDS 10 /* for MPI to end a job */
/* Bytes per MPI call: far below the 2^31 limit of its counts. */
#define CHUNK ((size_t)1 << 28)

/* Number of open files searched for the launcher's socket. */
#define MOST_SOCKETS 64

/* Duration of the sleep between polls. It is a fixed share of the time waited
 * so far, so a wait lasts at most that share longer, and long waits use no
 * core. While data are being transferred, polling is what moves them, so in
 * that case a rank sleeps only after every LOOKS polls. */
enum {
  NAP_FIRST_NS = 2000,
  NAP_BRISK_NS = 16000,
  NAP_LAST_NS = 2000000,
  NAP_SHARE = 32,
  LOOKS = 64
};

/* Allowed delay of the end of a sleep. The kernel's default of 50 us is as long
 * as most waits. */
enum { SLACK_NS = 1000 };

vg_status vg_comm_fail(struct vg_error *err, const char *what, int rc)
{
  char text[MPI_MAX_ERROR_STRING + 1] = "";
  int n;

  if (MPI_Error_string(rc, text, &n)) text[0] = 0;
  return vg_fail(err, VG_ERR_REMOTE, "MPI: %s: %s", what, text);
}

static void nap(long ns)
{
  const struct timespec t = { 0, ns };

  nanosleep(&t, NULL);
}

static void nap_idle(double waited)
{
  double ns = 1e9 * waited / NAP_SHARE;

  nap(ns < NAP_FIRST_NS  ? NAP_FIRST_NS
      : ns > NAP_LAST_NS ? NAP_LAST_NS
                         : (long)ns);
}

static void nap_brisk(unsigned n)
{
  if (n == LOOKS - 1) nap(NAP_BRISK_NS);
  else sched_yield();
}

void vg_comm_nap(unsigned looks)
{
  nap_brisk(looks % LOOKS);
}

int vg_comm_wait(int n, MPI_Request *request, int brisk)
{
  int done = 0, rc;
  unsigned looks = 0;
  double begun = brisk ? 0 : vg_clock();

  while (!(rc = MPI_Testall(n, request, &done, MPI_STATUSES_IGNORE)) && !done) {
    if (brisk) vg_comm_nap(looks++);
    else nap_idle(vg_clock() - begun);
  }
  return rc;
}

int vg_comm_cancel_receives(int n, MPI_Request *request)
{
  int rc = MPI_SUCCESS;

  for (int i = 0; i < n && !rc; i++)
    if (request[i] != MPI_REQUEST_NULL) rc = MPI_Cancel(&request[i]);
  return rc || MPI_Waitall(n, request, MPI_STATUSES_IGNORE);
}

/* --- launchers ----------------------------------------------------------- */

static long number(const char *name)
{
  const char *text = getenv(name);

  return text ? strtol(text, NULL, 10) : -1;
}

/* Is there a launcher that connects its processes? Detects Open MPI's mpirun,
 * PMI (MPICH, Intel and Cray MPI; srun --mpi=pmi2) and PMIx (prterun, srun
 * --mpi=pmix) by their environment variables. *size is the number of processes
 * if the launcher tells it, else 1. */
static int launched(long *size)
{
  static const char *const sign[] = { "OMPI_COMM_WORLD_SIZE", "PMI_SIZE",
                                      "PMI_RANK", "PMIX_RANK" };
  static const char *const sizes[] = { "OMPI_COMM_WORLD_SIZE", "PMI_SIZE",
                                       "SLURM_STEP_NUM_TASKS" };

  *size = 1;
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes && *size <= 1; i++)
    *size = number(sizes[i]);
  for (size_t i = 0; i < sizeof sign / sizeof *sign; i++)
    if (getenv(sign[i])) return 1;
  return 0;
}

/* Is this a process of a Slurm step that no launcher connects? Each of them
 * would run as a job of one rank, and all would do the same work and write the
 * same files. */
static int is_loose_step(void)
{
  return getenv("SLURM_STEP_ID") && getenv("SLURM_PROCID") &&
         number("SLURM_STEP_NUM_TASKS") > 1;
}

/* Open MPI spends 0.2 s looking for networks, even if all ranks are on one
 * node, which mpirun tells by its variables. In this case we select the
 * transports that it would end up with: shared memory, or sockets where that is
 * refused. Settings of the user take precedence. The corresponding variables of
 * other launchers and libraries are not known. */
static void spare_networks(void)
{
  static const char *const asked[] = { "OMPI_MCA_pml", "OMPI_MCA_btl",
                                       "OMPI_MCA_mtl" };

  if (number("OMPI_COMM_WORLD_SIZE") < 1 ||
      number("OMPI_COMM_WORLD_SIZE") != number("OMPI_COMM_WORLD_LOCAL_SIZE"))
    return;
  for (size_t i = 0; i < sizeof asked / sizeof *asked; i++)
    if (getenv(asked[i])) return;
  setenv(asked[0], "ob1", 0);
  setenv(asked[1], "self,vader,tcp", 0);
}

/* To leave, PMIx sends its launcher four short messages in a row over a local
 * socket. With Nagle's algorithm, all but the first wait for the
 * acknowledgement of the previous one, which is delayed by 40 ms. TCP_NODELAY
 * avoids this. */
static void spare_delays(void)
{
  for (int file = 3; file < MOST_SOCKETS; file++) {
    struct sockaddr_in to;
    socklen_t n = sizeof to;
    int on = 1;

    if (getpeername(file, (struct sockaddr *)&to, &n) ||
        to.sin_family != AF_INET ||
        ntohl(to.sin_addr.s_addr) >> 24 != IN_LOOPBACKNET)
      continue;
    setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
}

/* For communicators of the caller. Most calls of MPI abort the process before
 * its start and after its end. */
static vg_status is_running(struct vg_error *err)
{
  int is_up = 0, is_over = 0;

  MPI_Initialized(&is_up);
  MPI_Finalized(&is_over);
  if (is_up && !is_over) return VG_OK;
  return vg_fail(err, VG_ERR_USAGE,
                 "a communicator is given, but MPI %s; call MPI_Init_thread "
                 "first, or use no communicator",
                 is_up ? "was finalised" : "is not initialised");
}

static vg_status allows_threads(int level, struct vg_error *err)
{
  if (level >= MPI_THREAD_MULTIPLE) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "this MPI library does not support calls from several "
                 "threads (MPI_THREAD_MULTIPLE; it offers level %d); use an "
                 "MPI library that does, or run one rank with --threads and "
                 "without mpirun",
                 level);
}

static vg_status start(struct vg_comm *c, struct vg_error *err)
{
  int is_up, is_over, level, rc;

  if (MPI_Finalized(&is_over) || is_over)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "MPI was finalised and cannot be started again in the "
                   "same process");
  rc = MPI_Initialized(&is_up);
  if (!rc && is_up) rc = MPI_Query_thread(&level);
  else if (!rc) {
    spare_networks();
    rc = MPI_Init_thread(NULL, NULL, MPI_THREAD_MULTIPLE, &level);
    c->owns_mpi = !rc;
    spare_delays();
  }
  if (rc) return vg_comm_fail(err, "cannot start", rc);
  return allows_threads(level, err);
}

static int duplicate(MPI_Comm of, MPI_Comm *to)
{
  int rc = MPI_Comm_dup(of, to);

  return rc ? rc : MPI_Comm_set_errhandler(*to, MPI_ERRORS_RETURN);
}

/* Set up the data that depend on c->node, on all of its ranks. Collective. */
static vg_status settle_node(struct vg_comm *c, struct vg_error *err)
{
  int rc;
  vg_status st;

  if ((rc = MPI_Comm_set_errhandler(c->node, MPI_ERRORS_RETURN)) ||
      (rc = MPI_Comm_rank(c->node, &c->node_rank)) ||
      (rc = MPI_Comm_size(c->node, &c->node_size)))
    return vg_comm_fail(err, "cannot find the ranks of this node", rc);
  VG_TRY(vg_comm_cores_open(c, err));
  st = vg_comm_wakeups_open(c, err);
done:
  return st;
}

static vg_status join(struct vg_comm *c, MPI_Comm of, struct vg_error *err)
{
  int rc;

  if ((rc = duplicate(of, &c->all)) || (rc = duplicate(of, &c->message_comm)) ||
      (rc = MPI_Comm_rank(c->all, &c->rank)) ||
      (rc = MPI_Comm_size(c->all, &c->size)) ||
      (rc = MPI_Comm_split_type(c->all, MPI_COMM_TYPE_SHARED, c->rank,
                                MPI_INFO_NULL, &c->node)))
    return vg_comm_fail(err, "cannot join the job", rc);
  return VG_OK;
}

vg_status vg_comm_take_for_nodes(struct vg_comm *c, int ranks,
                                 struct vg_error *err)
{
  int rc;

  if (!c) return VG_OK;
  vg_comm_wakeups_close(c);
  c->wakeup_at = NULL;
  free(c->core);
  c->core = NULL;
  MPI_Comm_free(&c->node);
  rc = MPI_Comm_split(c->all, c->rank / ranks, c->rank, &c->node);
  if (rc) return vg_comm_fail(err, "cannot split the ranks", rc);
  return settle_node(c, err);
}

static void leave(struct vg_comm *c)
{
  vg_comm_watch_end(c);
  vg_comm_messages_release(c);
  if (c->node != MPI_COMM_NULL) MPI_Comm_free(&c->node);
  if (c->message_comm != MPI_COMM_NULL) MPI_Comm_free(&c->message_comm);
  if (c->all != MPI_COMM_NULL) MPI_Comm_free(&c->all);
  if (c->owns_mpi) MPI_Finalize();
  vg_comm_wakeups_close(c);
  pthread_mutex_destroy(&c->lock);
  free(c->core);
  free(c);
}

static vg_status check_size(const struct vg_comm *c, long announced,
                            struct vg_error *err)
{
  if (c->size > 1 || announced <= 1 || !c->owns_mpi) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the launcher started %ld processes that cannot find each "
                 "other: use the mpirun of the MPI library that this "
                 "program is linked with, or srun --mpi with a plugin that "
                 "this library supports",
                 announced);
}

static struct vg_comm *new_comm(void)
{
  struct vg_comm *c = vg_calloc(1, sizeof *c);

  if (!c) return NULL;
  c->all = c->message_comm = c->node = MPI_COMM_NULL;
  c->chunk = CHUNK;
  c->last = &c->first;
  pthread_mutex_init(&c->lock, NULL);
  return c;
}

vg_status vg_comm_open(struct vg_comm **out, struct vg_error *err)
{
  struct vg_comm *c;
  long announced;
  vg_status st;

  if (!launched(&announced)) {
    if (is_loose_step())
      return vg_fail(err, VG_ERR_UNSUPPORTED,
                     "srun started %ld processes without connecting them; "
                     "use srun --mpi=pmix or --mpi=pmi2 (srun --mpi=list "
                     "shows the plugins available), or mpirun",
                     announced);
    *out = NULL;
    return VG_OK;
  }
  c = new_comm();
  if (!c) return vg_fail_memory(err, "communication");
  /* also holds for threads started later */
  prctl(PR_SET_TIMERSLACK, (unsigned long)SLACK_NS);
  VG_TRY(start(c, err));
  VG_TRY(join(c, MPI_COMM_WORLD, err));
  VG_TRY(check_size(c, announced, err));
  VG_TRY(settle_node(c, err));
  *out = c;
  return VG_OK;
done:
  leave(c);
  return st;
}

vg_status vg_comm_of(const void *mpi, struct vg_comm **out,
                     struct vg_error *err)
{
  struct vg_comm *c = new_comm();
  int level = MPI_THREAD_SINGLE;
  vg_status st;

  if (!c) return vg_fail_memory(err, "communication");
  VG_TRY(is_running(err));
  MPI_Query_thread(&level);
  VG_TRY(allows_threads(level, err));
  VG_TRY(join(c, *(const MPI_Comm *)mpi, err));
  VG_TRY(settle_node(c, err));
  *out = c;
  return VG_OK;
done:
  leave(c);
  return st;
}

vg_status vg_comm_of_fortran(int handle, struct vg_comm **out,
                             struct vg_error *err)
{
  MPI_Comm comm;
  vg_status st = is_running(err);

  if (st < 0) return st;
  comm = MPI_Comm_f2c((MPI_Fint)handle);
  return vg_comm_of(&comm, out, err);
}

void vg_comm_close(struct vg_comm *c)
{
  if (!c) return;
  vg_comm_drain(c);
  leave(c);
}

void vg_comm_abort(struct vg_comm *c, int exit_status, const char *why)
{
  char text[300];
  int is_up = 0;
  int n = c ? snprintf(text, sizeof text, "rank %d: %s\n", c->rank, why)
            : snprintf(text, sizeof text, "%s\n", why);

  if (n >= (int)sizeof text) n = sizeof text - 1;
  while (write(STDERR_FILENO, text, (size_t)n) < 0 && errno == EINTR) {
  }
  alarm(ABORT_SECONDS); /* the launcher may be unreachable */
  MPI_Initialized(&is_up);
  if (is_up) MPI_Abort(c ? c->all : MPI_COMM_WORLD, exit_status);
  _exit(exit_status);
}

int vg_comm_rank(const struct vg_comm *c)
{
  return c ? c->rank : 0;
}

int vg_comm_size(const struct vg_comm *c)
{
  return c ? c->size : 1;
}

int vg_comm_node_rank(const struct vg_comm *c)
{
  return c ? c->node_rank : 0;
}

int vg_comm_node_size(const struct vg_comm *c)
{
  return c ? c->node_size : 1;
}

const void *vg_comm_mpi(const struct vg_comm *c)
{
  return c ? &c->all : NULL;
}

void vg_library_mpi(struct vg_library *out)
{
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int n = 0;

  MPI_Get_library_version(text, &n); /* may be called before MPI is
                                        initialised */
  out->name = "MPI";
  snprintf(out->version, sizeof out->version, "%.100s", text);
}
