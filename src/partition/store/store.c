/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "partition/store/store.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "partition/store/store_parts.h"

/* --- on rank 0 ----------------------------------------------------------- */

/* Creates the folder and its parents. Returns 0 or errno; *made: 1 if this
 * call created it. */
static int make_folders(const char *dir, int *made)
{
  char *path = strdup(dir);
  int error = path ? 0 : ENOMEM;

  for (char *at = path; !error && at && *at;) {
    at = strchr(at + 1, '/');
    if (at) *at = 0;
    *made = !mkdir(path, 0777);
    /* an existing or unwritable parent shows up in a later step */
    if (!*made && errno != EEXIST && !at) error = errno;
    if (at) *at = '/';
  }
  free(path);
  return error;
}

static int open_directory(struct vg_store *s)
{
  s->fd = open(s->dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  return s->fd < 0 ? errno : 0;
}

static vg_status enter(struct vg_store *s, int resume, struct vg_error *err)
{
  char text[64];
  int error = open_directory(s);

  if (error == ENOENT && resume)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: this run directory does not exist, so there "
                   "is nothing to resume; check its name, or start without "
                   "resuming",
                   s->dir);
  if (error == ENOENT) {
    error = make_folders(s->dir, &s->made);
    if (!error) error = open_directory(s);
  }
  if (!error) return VG_OK;
  return vg_fail(err, VG_ERR_IO,
                 "%s: cannot be used as a run directory: %s; "
                 "choose another one",
                 s->dir, strerror_r(error, text, sizeof text));
}

static vg_status no_run(const struct vg_store *s, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: the directory holds no run to resume; "
                 "check its name, or start without resuming",
                 s->dir);
}

vg_status vg_store_has_run(const char *dir, struct vg_error *err)
{
  struct vg_store s = { .dir = (char *)dir };
  struct vg_store_run run;
  vg_status st = enter(&s, 1, err);

  if (st < 0) return st;
  st = vg_store_read_run(&s, &run, err);
  close(s.fd);
  return st == VG_BLOCKED ? no_run(&s, err) : st;
}

/* Compares the run in the directory with the requested one. */
static vg_status compare(const struct vg_store *s,
                         const struct vg_store_options *o,
                         const struct vg_store_run *there,
                         const struct vg_store_run *ours, uint64_t n_record,
                         struct vg_error *err)
{
  int same = !memcmp(&there->job, &ours->job, sizeof ours->job);
  char differ[400] = "";

  if (o->resume && same) return VG_OK;
  if (!same) vg_store_compare_settings(s, o->settings, differ, sizeof differ);
  if (o->resume)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: cannot be resumed: input or "
                   "options have changed; its run was: %s; this one "
                   "is: %s; %srestore the old values, or start without "
                   "resuming in another directory",
                   s->dir, there->what, ours->what, differ);
  if (!n_record) return VG_OK; /* nothing would be lost */
  if (same)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: holds %llu finished tasks of this "
                   "same run (%s); resume it, remove the directory to start "
                   "again, or choose another one",
                   s->dir, (unsigned long long)n_record, there->what);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: holds %llu finished tasks of another "
                 "run; it was: %s; this one is: %s; %schoose another "
                 "directory, or remove this one",
                 s->dir, (unsigned long long)n_record, there->what, ours->what,
                 differ);
}

static struct vg_store_run run_of(const struct vg_store_options *o)
{
  struct vg_store_run run = { .job = o->job };

  snprintf(run.what, sizeof run.what, "%s", o->what ? o->what : "");
  for (char *c = run.what; *c; c++)
    if ((unsigned char)*c < ' ') *c = ' ';
  return run;
}

static vg_status claim(struct vg_store *s, const struct vg_store_options *o,
                       struct vg_store_tally *tally, struct vg_error *err)
{
  struct vg_store_run ours = run_of(o), there;
  vg_status st = vg_store_read_run(s, &there, err);

  if (st < 0) return st;
  if (st == VG_BLOCKED && o->resume) return no_run(s, err);
  *tally = vg_store_walk(s->fd, 0);
  if (st == VG_OK) {
    st = compare(s, o, &there, &ours, tally->n, err);
    if (st < 0) return st;
  } else if (tally->n) {
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: holds %llu finished tasks, but no run.txt that "
                   "says which run they belong to; remove the directory or "
                   "choose another one",
                   s->dir, (unsigned long long)tally->n);
  }
  st = vg_store_write_settings(s, o->settings, err);
  return st < 0 ? st : vg_store_write_run(s, &ours, err);
}

static vg_status take(struct vg_store *s, const struct vg_store_options *o,
                      uint64_t *bytes, struct vg_error *err)
{
  struct vg_store_tally tally = { 0, 0 };
  struct vg_store_run there;
  vg_status st = enter(s, o->resume, err);

  if (st == VG_OK) st = vg_store_lock(s, err);
  if (st == VG_OK) {
    s->fresh = vg_store_read_run(s, &there, NULL) == VG_BLOCKED;
    st = claim(s, o, &tally, err);
  }
  *bytes = tally.bytes;
  return st;
}

/* Restores the directory to its previous state after a failure. */
static void withdraw(struct vg_store *s)
{
  if (s->lock >= 0 && s->fresh) {
    vg_store_remove_run(s);
    vg_store_unlock(s, 1);
  }
  if (s->made) rmdir(s->dir);
}

/* --- on all ranks -------------------------------------------------------- */

/* Checks that this rank sees the directory: one on a local disk of rank 0's
 * node is not visible on other nodes. */
static vg_status follow(struct vg_store *s, const struct vg_store_options *o,
                        struct vg_error *err)
{
  struct vg_store_run there;

  if (!open_directory(s) && vg_store_read_run(s, &there, NULL) == VG_OK &&
      !memcmp(&there.job, &o->job, sizeof o->job))
    return VG_OK;
  return vg_fail(err, VG_ERR_IO,
                 "%s: this rank does not see the run "
                 "directory that rank 0 created; choose one on a file "
                 "system that all nodes share",
                 s->dir);
}

/* Divides the limit among the ranks; existing records count. */
static vg_status divide(struct vg_store *s, uint64_t there,
                        struct vg_error *err)
{
  vg_status st = vg_comm_sum(s->comm, 1, &there, err);

  if (st < 0) return st;
  s->share = UINT64_MAX;
  if (s->limit)
    s->share = there < s->limit
               ? (s->limit - there) / (uint64_t)vg_comm_size(s->comm)
               : 0;
  return VG_OK;
}

static void release(struct vg_store *s)
{
  vg_store_unlock(s, 0);
  if (s->fd >= 0) close(s->fd);
  pthread_mutex_destroy(&s->mutex);
  free(s->dir);
  free(s);
}

static struct vg_store *store_new(struct vg_comm *comm,
                                  const struct vg_store_options *o)
{
  struct vg_store *s = vg_calloc(1, sizeof *s);

  if (!s) return NULL;
  s->comm = comm;
  s->fd = s->lock = -1;
  s->limit = o->limit;
  s->dir = strdup(o->dir);
  if (s->dir && !pthread_mutex_init(&s->mutex, NULL)) return s;
  free(s->dir);
  free(s);
  return NULL;
}

vg_status vg_store_open(struct vg_comm *comm,
                        const struct vg_store_options *options,
                        struct vg_store **out, struct vg_error *err)
{
  assert(options->dir && out);

  struct vg_store *s = store_new(comm, options);
  int rank = vg_comm_rank(comm);
  uint64_t there = 0;
  vg_status st = s ? VG_OK : vg_fail_memory(err, "the run directory");

  if (s && !rank) st = take(s, options, &there, err);
  st = vg_comm_agree(comm, st, err);
  if (st >= 0) {
    if (rank) st = follow(s, options, err);
    st = vg_comm_agree(comm, st, err);
  }
  if (st >= 0) st = divide(s, there, err);
  if (st >= 0) {
    *out = s;
    return VG_OK;
  }
  if (s) {
    withdraw(s);
    release(s);
  }
  return st;
}

void vg_store_close(struct vg_store *s, int remove)
{
  struct vg_error err;

  if (!s) return;
  /* no rank may still be writing a record */
  if (vg_comm_agree(s->comm, VG_OK, &err) < 0) remove = 0;
  if (remove && !vg_comm_rank(s->comm)) {
    vg_store_walk(s->fd, 1);
    vg_store_remove_run(s);
    vg_store_unlock(s, 1);
    rmdir(s->dir); /* fails while the directory holds other files */
  }
  release(s);
}
