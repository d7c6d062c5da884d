/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The list of runs and their folders. Declared in cli/serve/runs.h. */
#define _GNU_SOURCE
#include "cli/serve/runs.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"

static void release_run(struct vg_serve_run *run)
{
  if (!run) return;
  free(run->dir);
  free(run->project);
  free(run);
}

void vg_runs_release(struct vg_serve_runs *r)
{
  for (size_t i = 0; i < r->n; i++) release_run(r->item[i]);
  free(r->item);
  free(r->dir);
  free(r->program);
  memset(r, 0, sizeof *r);
}

struct vg_serve_run *vg_runs_find(const struct vg_serve_runs *r, int id)
{
  for (size_t i = 0; i < r->n; i++)
    if (r->item[i]->id == id) return r->item[i];
  return NULL;
}

int vg_run_is_active(const struct vg_serve_run *run)
{
  return run->state <= VG_SERVE_STOPPING;
}

int vg_run_can_resume(const struct vg_serve_run *run)
{
  return run->state == VG_SERVE_STOPPED || run->state == VG_SERVE_FAILED;
}

int vg_run_has_kept(const struct vg_serve_run *run)
{
  char path[4096];

  return access(vg_run_path(run, "kept/run.txt", path), F_OK) == 0;
}

const char *vg_run_state_word(enum vg_serve_state state)
{
  static const char *const words[VG_SERVE_STATES] = {
    "queued",  "submitted", "pending", "running", "stopping",
    "stopped", "done",      "limit",   "failed"
  };

  return words[state];
}

char *vg_run_path(const struct vg_serve_run *run, const char *name, char *path)
{
  snprintf(path, 4096, "%s/%s", run->dir, name);
  return path;
}

size_t vg_file_tail(const char *path, char *text, size_t size, int64_t *whole)
{
  int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  struct stat s;
  ssize_t n = 0;

  *whole = 0;
  text[0] = 0;
  if (fd < 0) return 0;
  if (!fstat(fd, &s) && S_ISREG(s.st_mode)) {
    off_t most = (off_t)size - 1;

    *whole = s.st_size;
    n = pread(fd, text, size - 1, s.st_size > most ? s.st_size - most : 0);
  }
  close(fd);
  if (n < 0) n = 0;
  text[n] = 0;
  return (size_t)n;
}

/* --- list ---------------------------------------------------------------- */

static struct vg_serve_run *blank(const struct vg_serve_runs *r, int id)
{
  struct vg_serve_run *run = vg_calloc(1, sizeof *run);

  if (!run) return NULL;
  run->id = id;
  run->ranks = run->nodes = run->cpus = 1;
  run->exit_status = run->output_size = -1;
  run->tell.share = -1;
  run->project = strdup("");
  if (asprintf(&run->dir, "%s/%04d", r->dir, id) < 0) run->dir = NULL;
  if (run->project && run->dir) return run;
  release_run(run);
  return NULL;
}

static vg_status add(struct vg_serve_runs *r, struct vg_serve_run *run,
                     struct vg_error *err)
{
  if (vg_reserve(&r->item, &r->cap, r->n + 1, sizeof *r->item)) {
    release_run(run);
    return vg_fail_memory(err, "the runs");
  }
  r->item[r->n++] = run;
  return VG_OK;
}

vg_status vg_runs_new(struct vg_serve_runs *r, struct vg_serve_run **out,
                      struct vg_error *err)
{
  int id = r->last + 1, n_active = 0;
  struct vg_serve_run *run;
  vg_status st;

  for (size_t i = 0; i < r->n; i++) n_active += vg_run_is_active(r->item[i]);
  if (n_active >= VG_SERVE_ACTIVE_MAX)
    return vg_fail(err, VG_ERR_INPUT,
                   "%d runs are already waiting or running; wait until some "
                   "of them have ended",
                   n_active);
  /* Existing folders are skipped, also if they are not runs. */
  for (; id <= VG_SERVE_RUNS_MAX; id++) {
    run = blank(r, id);
    if (!run) return vg_fail_memory(err, "a run");
    if (!mkdir(run->dir, 0777)) {
      run->created = time(NULL);
      r->last = id;
      st = add(r, run, err);
      if (st >= 0) *out = run;
      return st;
    }
    if (errno != EEXIST) {
      st = vg_fail(err, VG_ERR_IO, "%s: %s", run->dir, strerror(errno));
      release_run(run);
      return st;
    }
    release_run(run);
  }
  return vg_fail(err, VG_ERR_INPUT,
                 "%s has %d runs; move some of them away and restart "
                 "the portal",
                 r->dir, VG_SERVE_RUNS_MAX);
}

static int remove_one(const char *path, const struct stat *s, int type,
                      struct FTW *at)
{
  (void)s, (void)type, (void)at;
  return remove(path);
}

/* The folder first loses its name, so that a folder that is removed in part is
 * no run any more. Links are removed, not followed. */
vg_status vg_runs_remove(struct vg_serve_runs *r, struct vg_serve_run *run,
                         struct vg_error *err)
{
  char gone[4096];
  size_t i = 0;

  if (vg_run_is_active(run))
    return vg_fail(err, VG_ERR_INPUT, "run %d is active; stop it first",
                   run->id);
  snprintf(gone, sizeof gone, "%s/.removed-%04d-%ld", r->dir, run->id,
           (long)time(NULL));
  if (rename(run->dir, gone))
    return vg_fail(err, VG_ERR_IO, "%s: %s", run->dir, strerror(errno));
  while (r->item[i] != run) i++;
  memmove(&r->item[i], &r->item[i + 1], (r->n - i - 1) * sizeof *r->item);
  r->n--;
  release_run(run);
  if (nftw(gone, remove_one, 16, FTW_DEPTH | FTW_PHYS))
    return vg_fail(err, VG_ERR_IO, "%s: %s; remove this folder by hand", gone,
                   strerror(errno));
  return VG_OK;
}

/* --- runs of earlier portals --------------------------------------------- */

static int by_id(const void *a, const void *b)
{
  const struct vg_serve_run *x = *(struct vg_serve_run *const *)a;
  const struct vg_serve_run *y = *(struct vg_serve_run *const *)b;

  return (x->id > y->id) - (x->id < y->id);
}

/* The id of the folder "0012" is 12; 0 for other names. */
static int id_of(const char *name)
{
  return strlen(name) == 4 && strspn(name, "0123456789") == 4 ? atoi(name) : 0;
}

/* Determine the state of a run of an earlier portal. Its process is still alive
 * if one with the same number and start time exists. */
static void take_up(struct vg_serve_run *run)
{
  if (!vg_run_is_active(run) || run->state == VG_SERVE_QUEUED ||
      (run->is_slurm && *run->job))
    return;
  if (run->pid > 0 && run->pid_start &&
      vg_process_start(run->pid) == run->pid_start)
    return;
  if (run->is_slurm) vg_slurm_submitted(run, 0);
  else vg_run_ended(run, -1);
}

static vg_status load(struct vg_serve_runs *r, int id, struct vg_error *err)
{
  struct vg_serve_run *run = blank(r, id);
  struct vg_error why = VG_ERROR_INIT;

  if (!run) return vg_fail_memory(err, "a run");
  if (vg_record_read(run, &why) < 0) { /* not a run, or damaged */
    release_run(run);
    return why.code == VG_ERR_MEMORY ? vg_fail_memory(err, "a run") : VG_OK;
  }
  take_up(run);
  return add(r, run, err);
}

vg_status vg_runs_open(struct vg_serve_runs *r, struct vg_error *err)
{
  DIR *d = opendir(r->dir);
  struct dirent *e;
  vg_status st = VG_OK;

  if (!d) return vg_fail(err, VG_ERR_IO, "%s: %s", r->dir, strerror(errno));
  while (st >= 0 && (e = readdir(d)))
    if (id_of(e->d_name)) st = load(r, id_of(e->d_name), err);
  closedir(d);
  if (r->n) qsort(r->item, r->n, sizeof *r->item, by_id);
  if (r->n) r->last = r->item[r->n - 1]->id;
  return st;
}
