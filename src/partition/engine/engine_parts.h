/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/engine/engine_parts.h: declarations shared by the files of the
 * engine.
 *
 * Threads of a rank: the calling thread serves messages (engine_serve.c), the
 * workers execute tasks (engine_work.c), and in a job of several ranks a
 * progress thread (handler) calls `done` for outcomes from other ranks while
 * the workers are busy. One lock per rank guards all engine state; user code
 * runs outside the lock.
 *
 * The schedule, the list of ready tasks, is on rank 0 (engine_schedule.c),
 * guarded by the lock of that rank. Rank 0 calls it directly; other ranks send
 * messages:
 *
 *    home rank       UPDATE   a task has ended; the new tasks it created
 *    executing rank  FREE     one of my workers has ended a task
 *    executing rank  MOVED    answer to RECALL
 *    any rank        FAIL     stop everything, with the reason
 *    any rank        BYE      my last message
 *    list -> home    ASSIGN   rank R will execute your task (by worker L)
 *    list -> any     RECALL   give a task that you have not started to rank R
 *    list -> any     DRAIN    start no further task
 *    list -> any     END      nothing is left; the final status
 *    home -> R       INPUT    the task and its input
 *    R -> home       OUTCOME  the outcome; not sent for tasks that move
 *
 * A remote task costs two small messages before its input is sent. The update
 * after an outcome carries the new tasks, so when no task is out, none can
 * appear. Updates of one rank must arrive in the order in which they were
 * posted, which MPI guarantees; nothing else depends on any order. */
#ifndef VG_PARTITION_ENGINE_ENGINE_PARTS_H
#define VG_PARTITION_ENGINE_ENGINE_PARTS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "partition/engine/engine.h"

/* Why a rank ends the job. */
#define VG_ENGINE_NO_MEMORY                                                    \
  "no memory is left for messages between ranks, and the job ends; use fewer " \
  "ranks per node or more nodes (the next run removes temporary files)"

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

/* --- intrusive heap ------------------------------------------------------ */

/* Pairing heap (Fredman et al., 1986): the first member of its items. A task
 * enters a queue when a message arrives, where a failed allocation could not
 * be handled. With base/heap.h every task would need reserved room in each of
 * the rank's 2 + threads queues before it is accepted; this heap takes 32
 * bytes per task. */
struct vg_heap {
  double key;       /* Higher values first. */
  const char *path; /* Lower paths first where keys are equal. */
  struct vg_heap *child, *next;
};

void vg_heap_push(struct vg_heap **heap, struct vg_heap *item);
struct vg_heap *vg_heap_pop(struct vg_heap **heap);
/** Returns 1 when a comes before b. */
int vg_heap_before(const struct vg_heap *a, const struct vg_heap *b);

/* --- messages ------------------------------------------------------------ */

/* Not assigned to a particular worker: any worker of the rank. */
enum { VG_LANE_ANY = -1 };

/* FREE, MOVED, BYE, ASSIGN, RECALL, DRAIN. */
struct vg_msg {
  uint64_t handle; /* ASSIGN: handle of the task; BYE: number of messages
                      sent, as `sent` of END. */
  int32_t to;      /* ASSIGN, RECALL, MOVED: receiving rank. */
  int32_t lane;    /* ASSIGN: worker or VG_LANE_ANY. */
  int32_t ok;      /* MOVED: 1 if there was a task to give. */
};

/* UPDATE, followed by `n` notices. */
struct vg_update {
  double weight; /* Weight of the task that ended. */
  uint64_t n_cell;
  int32_t ended;   /* 1: a task has ended; 0: a rank starts. */
  int32_t threads; /* Workers of the rank. */
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
  uint64_t sent; /* END: messages sent to this rank, including this one. */
  char path[VG_PATH_MAX]; /* Path of the task that failed. */
  char text[1024];
};

/* Appended to INPUT and OUTCOME messages, at the end so that packed data need
 * not be moved. */
struct vg_input_trailer {
  char path[VG_PATH_MAX], after[VG_PATH_MAX];
  double key, priority, weight, work;
  uint64_t handle;
  int32_t home, kind, has, moves; /* has: 1 if the input is not NULL. */
  int32_t lane, unused; /* unused: 0, since the struct is sent as bytes. */
};

struct vg_outcome_trailer {
  uint64_t handle, n_cell;
  uint64_t has;
};

/* --- state --------------------------------------------------------------- */

/* State of a task: one object on its home rank until the task has ended,
 * another one on the executing rank. Sequence: new -> [schedule] -> queue (or
 * out) -> run -> ended. */
struct vg_task_state {
  struct vg_heap place; /* Node in a queue; must be first. */
  struct vg_task task;
  char after[VG_PATH_MAX];
  uint64_t handle; /* Index of the task in `home` of its home rank. */
  int home, runner, to;
  int lane;   /* Worker it is assigned to, or VG_LANE_ANY. */
  int packed; /* 1: bytes hold the input or the outcome. */
  struct vg_bytes bytes;
  void *outcome;
  uint64_t n_cell;
  struct vg_task_state *next; /* Next in `ended` or `out`. */
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
  struct vg_heap **ready; /* [size] Unassigned ready tasks by home rank. */
  size_t n_held, cap_held;
  struct vg_ready **held; /* [n_held] Tasks to be assigned statically. */
  int *threads, *load;    /* [size] Workers of each rank; tasks it has,
                             including pinned ones. */
  unsigned char *asked;   /* [size] State of a RECALL to each rank, see
                             recall(). */
  size_t n_ready, n_joined;
  size_t n_worker, n_underloaded;  /* All workers; ranks with fewer tasks
                                      than workers. */
  uint64_t n_known, n_done, n_out; /* n_out: tasks that some rank holds. */
  double cells, open; /* Cells done; cells expected of open tasks. */
  int draining, ended;
  struct vg_final_status final_status;
};

struct vg_worker {
  struct vg_engine *e;
  int number;
  int unreported;           /* 1: has not yet reported that it is free. */
  struct vg_heap *assigned; /* Tasks assigned to this worker. */
  const char *doing;        /* Path of its current task. */
  double loops, helped;     /* Processor time in s that its task spent in loops,
                               and the part of it in other threads. */
  int in_loop;              /* 1: a loop body is running. */
  void *data;               /* vg_thread_data of the thread that started it. */
  pthread_t thread;
};

struct vg_loop; /* engine_loop.c */

struct vg_engine {
  struct vg_comm *comm;
  int rank, size, threads; /* threads: number of workers started. */
  const struct vg_engine_options *options;
  const struct vg_engine_ops *ops;
  void *user;
  double begin; /* s on the monotonic clock. */

  pthread_mutex_t lock;
  pthread_cond_t work, handler, serve;
  struct vg_worker *worker; /* [threads] workers, then the progress thread. */
  int handler_index;        /* Index of the progress thread in worker[]; 0:
                               none, in a job of one rank. */
  atomic_int stopping;
  int over;      /* 1: threads must exit. */
  int ending;    /* 1: END was sent (rank 0) or received. */
  int poll_soon; /* 1: something was posted, so poll soon. */

  struct vg_heap *queue[2];  /* Tasks for any worker of this rank:
                                unassigned, pinned. */
  struct vg_loop *loops;     /* Open loops that workers may help with. */
  size_t n_idle;             /* Sleeping workers. */
  struct vg_task_fifo ended; /* Home tasks that wait for `done`. */
  struct vg_task_fifo out;   /* Tasks whose input must be sent to task->to. */
  int in_done;               /* 1: a thread runs `done`, or the first tasks
                                are being created. */
  char doing[VG_PATH_MAX];   /* Path of the task whose `done` runs. */
  struct vg_task_state **new_task; /* [n_new] Submitted, not sent yet. */
  size_t n_new, cap_new;
  struct vg_task_notice *notice; /* [cap_notice] Notices of the new tasks. */
  size_t cap_notice;
  struct vg_task_state **home; /* [n_home] Tasks by handle; NULL when ended. */
  size_t n_home, cap_home;
  struct vg_spans spans;

  uint64_t *sent, *received; /* [size] Messages sent to and received from
                                each rank. */
  uint64_t *said; /* [size] Messages that each rank reports as sent. */
  struct vg_final_status final_status; /* As received with END. */
  struct vg_schedule schedule;         /* Rank 0 only. */
};

/* The caller of the functions below must hold the lock, unless stated
 * otherwise. */

/* engine.c */
void vg_engine_lock(struct vg_engine *e);
void vg_engine_unlock(struct vg_engine *e);
/* With or without the lock. */
void vg_task_state_free(struct vg_engine *e, struct vg_task_state *j);

/* engine_notify.c: messages to the schedule, local or remote, and wake-up of
 * the serving thread. */
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
/* without lock */
void vg_work_drop(struct vg_engine *e, struct vg_task_state *j);
void *vg_work_thread(void *worker);
void *vg_work_handler(void *worker);

/* engine_loop.c */
void vg_loop_enter(struct vg_worker *w); /* without the lock: identifies this
                                            thread */
int vg_loop_help(struct vg_worker *w);   /* 1: it helped; releases the lock
                                            meanwhile */

/* engine_serve.c: actions on behalf of the schedule, and the loop (without the
 * lock). */
void vg_serve_assign(struct vg_engine *e, uint64_t handle, int to, int lane);
void vg_serve_recall(struct vg_engine *e, int to);
void vg_serve_drain(struct vg_engine *e);
void vg_serve(struct vg_engine *e);

/* engine_schedule.c: rank 0 only. */
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
