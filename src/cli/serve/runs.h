/* Private to cli/serve: the runs of a portal. Each has a folder with all that
 * belongs to it:
 *
 *   run.json     what it is and how it stands, for the next portal
 *   run.deck     its settings
 *   output.log   what the process printed; run.log: what --log writes
 *   mesh/        results; sweep/ of a sweep; kept/: finished tasks (--run-dir)
 *
 * A run is a process in a session of its own, or a job of Slurm. */
#ifndef VG_CLI_SERVE_RUNS_H
#define VG_CLI_SERVE_RUNS_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "cli/serve/portal.h"
#include "cli/serve/tell.h"

enum vg_serve_state {
  VG_SERVE_QUEUED,    /* waits for its turn on this machine */
  VG_SERVE_SUBMITTED, /* sbatch is at work */
  VG_SERVE_PENDING,   /* waits in Slurm's queue */
  VG_SERVE_RUNNING,
  VG_SERVE_STOPPING, /* was told to stop */
  VG_SERVE_STOPPED,
  VG_SERVE_DONE,
  VG_SERVE_LIMIT, /* done, but exit status 4 */
  VG_SERVE_FAILED,
  VG_SERVE_STATES
};

struct vg_serve_run {
  int id;
  char *dir, *project; /* its folder; below the root */
  char title[84];
  int is_sweep, is_slurm;
  int ranks, nodes, cpus; /* cpus and what follows: of Slurm */
  char time[24], partition[64], job[24];
  enum vg_serve_state state;
  pid_t pid;                       /* of the process, or of sbatch; 0: none */
  unsigned long long pid_start;    /* in clock ticks since the system's start */
  int is_child;                    /* of this process: it can be waited for */
  int exit_status;                 /* 128 + n: ended by signal n; -1: none */
  int64_t created, started, ended; /* s since 1970, for people; 0: not yet */
  char note[256];
  /* Not in the record: */
  struct vg_tell tell;
  int64_t output_size; /* of output.log when `tell` was read */
  double told_to_stop; /* by vg_display_now */
  double submitted;
  pid_t helper; /* scancel, until it ends */
};

struct vg_serve_runs {
  const struct vg_portal_options *o;
  const char *root; /* real paths */
  char *dir, *program;
  size_t n, cap;
  struct vg_serve_run **item; /* [n] owned, by rising id */
  pid_t squeue;               /* at work; 0: none */
  double squeue_start;
};

/* Runs of one portal, and of these such as wait or are at work. */
enum { VG_SERVE_RUNS_MAX = 9999, VG_SERVE_ACTIVE_MAX = 200 };

/** Find the runs in r->dir; those that were at work when the last portal closed
 * are at work, or their logs say how they ended. */
vg_status vg_runs_open(struct vg_serve_runs *r, struct vg_error *err);
void vg_runs_release(struct vg_serve_runs *r);

/** Another run with its folder, of state VG_SERVE_QUEUED. VG_ERR_INPUT: there
 * are too many. */
vg_status vg_runs_new(struct vg_serve_runs *r, struct vg_serve_run **out,
                      struct vg_error *err);

/** NULL: there is none. */
struct vg_serve_run *vg_runs_find(const struct vg_serve_runs *r, int id);

/** Whether it waits or is at work; whether it can be started again; whether
 * finished tasks are kept for that. */
int vg_run_is_active(const struct vg_serve_run *run);
int vg_run_can_resume(const struct vg_serve_run *run);
int vg_run_has_kept(const struct vg_serve_run *run);

/** "running", ... */
const char *vg_run_state_word(enum vg_serve_state state);

/** path[4096] of a file of a run. */
char *vg_run_path(const struct vg_serve_run *run, const char *name, char *path);

/** record.c: run.json. vg_record_parse fills all but dir, which stays; *run is
 * untouched on failure. VG_ERR_FORMAT names `name`. */
vg_status vg_record_write(const struct vg_serve_run *run, struct vg_error *err);
vg_status vg_record_parse(const char *name, const char *data, size_t size,
                          struct vg_serve_run *run, struct vg_error *err);
vg_status vg_record_read(struct vg_serve_run *run, struct vg_error *err);

/** launch.c: put a run to work, or into Slurm's queue; with what is kept, if
 * anything is. Its state says what became of that, also where it could not. */
void vg_run_launch(struct vg_serve_runs *r, struct vg_serve_run *run);

/** A process in a session of its own, in the folder dir, that prints into its
 * file `output`. env: NULL-ended "NAME=VALUE", or NULL. -1: refused. */
pid_t vg_run_spawn(const char *dir, char *const *word, const char *output,
                   char *const *env);

/** vg_run_spawn in the folder of the run, as its process: its state is then
 * `state`. VG_ERR_IO: it has none, and keeps its state. */
vg_status vg_run_start(struct vg_serve_run *run, char *const *word,
                       const char *output, char *const *env,
                       enum vg_serve_state state, struct vg_error *err);

/** Start time of a process that is alive, by /proc; 0: it is not. */
unsigned long long vg_process_start(pid_t pid);

/** Tell it to stop, so that it can be resumed; hard: at once. */
void vg_run_stop(struct vg_serve_runs *r, struct vg_serve_run *run, int hard);

/** watch.c: see who has ended and how far the others are, start those whose
 * turn it is. Often. */
void vg_runs_watch(struct vg_serve_runs *r);

/** A process of the run, or its job, is gone: its state by exit status (-1: not
 * known) and log. */
void vg_run_ended(struct vg_serve_run *run, int exit_status);

/** Slurm's squeue has answered: "JOB STATE" lines. Runs whose job is not in it
 * have ended. */
void vg_runs_take_squeue(struct vg_serve_runs *r, const char *data,
                         size_t size);

/** slurm.c: submit the run as a job; take up what sbatch said; tell the job to
 * stop; ask for the states of all jobs now and then. */
vg_status vg_slurm_submit(struct vg_serve_runs *r, struct vg_serve_run *run,
                          struct vg_error *err);
void vg_slurm_submitted(struct vg_serve_run *run, int exit_status);
void vg_slurm_stop(struct vg_serve_run *run, int hard);
void vg_slurm_watch(struct vg_serve_runs *r);

/** The last bytes of a file, at most size - 1, into text[size] with a zero
 * behind; their count, 0 where there is no file. *whole: its size. */
size_t vg_file_tail(const char *path, char *text, size_t size, int64_t *whole);

#endif
