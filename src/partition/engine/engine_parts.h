/* partition/engine/engine_parts.h: what the files of the engine share.
 *
 * Threads of a rank: the calling one serves messages (engine_serve.c), the
 * workers do tasks (engine_work.c), and in a job of several ranks a handler
 * calls `done` for outcomes that came from elsewhere while workers are busy.
 * One lock per rank guards all of it; user code runs outside the lock.
 *
 * The schedule, a list of what is ready, lives on rank 0 (engine_schedule.c),
 * guarded by that rank's lock. Its own rank calls it; others send messages:
 *
 *   a home       UPDATE   a task has ended; new ones it led to
 *   a runner     FREE     a worker of mine has ended a task
 *   a runner     MOVED    answer to RECALL
 *   anyone       FAIL     stop everything, and why
 *   anyone       BYE      my last message
 *   list -> home ASSIGN   your task is to be done by rank R (by its worker L)
 *   list -> any  RECALL   give a task that you have not started to rank R
 *   list -> any  DRAIN    start nothing more
 *   list -> any  END      nothing is left; how it went
 *   home -> R    INPUT    the task and its input
 *   R -> home    OUTCOME  what came of it; not of tasks that move
 *
 * So a remote task costs two small messages before its input is on the way,
 * and the update on an outcome carries the new tasks with it: when no task is
 * out, none can appear. Updates of one rank must arrive in the order in which
 * they were posted, as MPI has it; nothing else depends on any order. */
#ifndef VG_PARTITION_ENGINE_ENGINE_PARTS_H
#define VG_PARTITION_ENGINE_ENGINE_PARTS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "partition/engine/engine.h"

enum {
  VG_MSG_UPDATE = 1,
  VG_MSG_FREE,
  VG_MSG_MOVED,
  VG_MSG_FAIL,
  VG_MSG_BYE,
  VG_MSG_ASSIGN,
  VG_MSG_RECALL,
  VG_MSG_DRAIN,
  VG_MSG_END,
  VG_MSG_INPUT,
  VG_MSG_OUTCOME
};

/* --- a heap that needs no memory of its own ------------------------------ */

/* Pairing heap (Fredman et al., 1986): first member of what is in it. A task
 * enters a queue when a message arrives, which cannot fail any more. Heaps of
 * base/heap.h would have to reserve room for all tasks of the rank in each of
 * 2 + threads queues before a task is accepted; this one takes 32 bytes of each
 * task. */
struct vg_heap {
  double key;       /* higher first */
  const char *path; /* lower first, where keys are equal */
  struct vg_heap *child, *next;
};

void vg_heap_push(struct vg_heap **heap, struct vg_heap *item);
struct vg_heap *vg_heap_pop(struct vg_heap **heap);
/** 1 when a comes before b. */
int vg_heap_before(const struct vg_heap *a, const struct vg_heap *b);

/* --- messages ------------------------------------------------------------ */

/* Not dealt to a worker: any of the rank. */
enum { VG_LANE_ANY = -1 };

/* FREE, MOVED, BYE, ASSIGN, RECALL, DRAIN. */
struct vg_msg {
  uint64_t handle; /* ASSIGN: of the task; BYE: as END's sent */
  int32_t to;      /* ASSIGN, RECALL, MOVED: to which rank */
  int32_t lane;    /* ASSIGN: by which worker; VG_LANE_ANY */
  int32_t ok;      /* MOVED: there was one to give */
};

/* UPDATE, followed by `n` notices. */
struct vg_update {
  double weight; /* of the task that ended */
  uint64_t n_cell;
  int32_t ended;   /* 1: of a task; 0: of a rank that begins */
  int32_t threads; /* of that rank */
  uint64_t n;
};

struct vg_task_notice {
  char path[VG_PATH_MAX];
  double key, weight, work;
  uint64_t handle;
  uint64_t pinned;
};

/* FAIL and END. */
struct vg_final_status {
  int32_t status, from;
  uint64_t sent;          /* END: messages sent to this rank, this too */
  char path[VG_PATH_MAX]; /* of the task that failed */
  char text[1024];
};

/* At the end of INPUT, and of OUTCOME: so that what is packed needs no move. */
struct vg_input_trailer {
  char path[VG_PATH_MAX], after[VG_PATH_MAX];
  double key, priority, weight, work;
  uint64_t handle;
  int32_t home, kind, has, moves; /* has: not NULL */
  int32_t lane, unused;           /* 0: sent as bytes */
};

struct vg_outcome_trailer {
  uint64_t handle, n_cell;
  uint64_t has;
};

/* --- state --------------------------------------------------------------- */

/* A task: one at its home until it has ended, another one where it is done.
 * Its way: new -> [schedule] -> queue (or out) -> run -> ended. */
struct vg_task_state {
  struct vg_heap place; /* in queue; must be first */
  struct vg_task task;
  char after[VG_PATH_MAX];
  uint64_t handle; /* its number at home */
  int home, runner, to;
  int lane;   /* the worker it was dealt to, or VG_LANE_ANY */
  int packed; /* bytes hold the input, or the outcome */
  struct vg_bytes bytes;
  void *outcome;
  uint64_t n_cell;
  struct vg_task_state *next; /* in ended, out */
};

struct vg_task_fifo {
  struct vg_task_state *first, *last;
};

/* A task that waits in the schedule. */
struct vg_ready {
  struct vg_heap place; /* must be first */
  char path[VG_PATH_MAX];
  uint64_t handle;
  double work;
  int home;
};

struct vg_schedule {
  struct vg_heap **ready; /* [size] free tasks, by home */
  size_t n_held, cap_held;
  struct vg_ready **held; /* [n_held] to be dealt out */
  int *threads, *load;    /* [size] workers; tasks it has, pinned too */
  unsigned char *asked;   /* [size] see recall */
  size_t n_ready, n_joined;
  size_t n_worker, n_underloaded;  /* workers; ranks with fewer tasks than
                                      workers */
  uint64_t n_known, n_done, n_out; /* out: known to be with some rank */
  double cells, open;              /* done; expected of what is not */
  int draining, ended;
  struct vg_final_status final_status;
};

struct vg_worker {
  struct vg_engine *e;
  int number;
  int unreported;        /* has not said yet that it is free */
  struct vg_heap *dealt; /* jobs that are its own */
  const char *doing;     /* path of its task */
  double loops, helped;  /* s of processor time that its task has had in
                            loops, and of these in other threads */
  int in_loop;           /* a body runs */
  pthread_t thread;
};

struct vg_loop; /* engine_loop.c */

struct vg_engine {
  struct vg_comm *comm;
  int rank, size, threads; /* threads: as started */
  const struct vg_engine_options *options;
  const struct vg_engine_ops *ops;
  void *user;
  double begin; /* s on the monotonic clock */

  pthread_mutex_t lock;
  pthread_cond_t work, handler, serve;
  struct vg_worker *worker; /* [threads], and the handler */
  int handler_index;        /* in worker[]; 0: none, in a job of one rank */
  atomic_int stopping;
  int over;      /* threads are to leave */
  int ending;    /* END has been said (rank 0) or heard */
  int poll_soon; /* something was posted: poll soon */

  struct vg_heap *queue[2];  /* jobs to be done here by any worker: free,
                                pinned */
  struct vg_loop *loops;     /* that workers may help with */
  size_t n_idle;             /* workers that sleep */
  struct vg_task_fifo ended; /* home tasks, for `done` */
  struct vg_task_fifo out;   /* jobs whose input goes to job->to */
  int in_done;               /* a thread is there, or first tasks are made */
  char doing[VG_PATH_MAX];   /* the task whose `done` runs */
  struct vg_task_state **new_task; /* [n_new] submitted, not sent yet */
  size_t n_new, cap_new;
  struct vg_task_notice *notice; /* [cap_notice] for new tasks */
  size_t cap_notice;
  struct vg_task_state **home; /* [n_home] by handle; NULL when ended */
  size_t n_home, cap_home;
  struct vg_spans spans;

  uint64_t *sent, *received; /* [size] messages to and from each rank */
  uint64_t *said;            /* [size] messages a rank says it has sent */
  struct vg_final_status final_status; /* as heard */
  struct vg_schedule schedule;         /* rank 0 */
};

/* All below want the lock to be held, unless said otherwise. */

/* engine.c */
void vg_engine_lock(struct vg_engine *e);
void vg_engine_unlock(struct vg_engine *e);
/* without lock too */
void vg_task_state_free(struct vg_engine *e, struct vg_task_state *j);

/* engine_notify.c: to the schedule, wherever it is; and who serves. */
void vg_engine_wake(struct vg_engine *e);
void vg_engine_post(struct vg_engine *e, int to, int kind, struct vg_bytes *b);
void vg_engine_send(struct vg_engine *e, int to, int kind, struct vg_msg msg);
void vg_notify_update(struct vg_engine *e, const struct vg_task_state *ended);
void vg_notify_dropped(struct vg_engine *e, double weight);
void vg_notify_free(struct vg_engine *e);
void vg_notify_moved(struct vg_engine *e, int to, int ok);
void vg_notify_fail(struct vg_engine *e, vg_status status, const char *path,
                    const struct vg_error *err);

/* engine_work.c */
void vg_work_queue(struct vg_engine *e, struct vg_task_state *j);
void vg_work_end(struct vg_engine *e, struct vg_task_state *j);
void vg_work_drop(struct vg_engine *e, struct vg_task_state *j); /* without
                                                                    lock */
void *vg_work_thread(void *worker);
void *vg_work_handler(void *worker);

/* engine_loop.c */
void vg_loop_enter(struct vg_worker *w); /* without lock: this thread */
int vg_loop_help(struct vg_worker *w);   /* 1: it did; lock left for it */

/* engine_serve.c: what the schedule says, and the loop (without lock). */
void vg_serve_assign(struct vg_engine *e, uint64_t handle, int to, int lane);
void vg_serve_recall(struct vg_engine *e, int to);
void vg_serve_drain(struct vg_engine *e);
void vg_serve(struct vg_engine *e);

/* engine_schedule.c: rank 0. */
vg_status vg_schedule_init(struct vg_schedule *l, int size,
                           struct vg_error *err);
void vg_schedule_release(struct vg_schedule *l, int size);
void vg_schedule_update(struct vg_engine *e, int from,
                        const struct vg_update *update,
                        const struct vg_task_notice *notice);
void vg_schedule_free(struct vg_engine *e, int from);
void vg_schedule_moved(struct vg_engine *e, int from, int to, int ok);
void vg_schedule_fail(struct vg_engine *e, const struct vg_final_status *v);

#endif
