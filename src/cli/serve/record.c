/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run.json: parameters and state of a run, for the next portal. Declared in
 * cli/serve/runs.h. */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/serve/runs.h"
#include "run/common/json_build.h"
#include "run/common/json_file.h"
#include "run/common/text.h"

#define RECORD_MAX 65536

static json_t *record_of(const struct vg_serve_run *run)
{
  json_t *o = json_object();

  json_object_set_new(o, "state", json_string(vg_run_state_word(run->state)));
  json_object_set_new(o, "project", vg_text_json(run->project));
  json_object_set_new(o, "title", vg_text_json(run->title));
  json_object_set_new(o, "sweep", json_boolean(run->is_sweep));
  json_object_set_new(o, "slurm", json_boolean(run->is_slurm));
  json_object_set_new(o, "ranks", json_integer(run->ranks));
  json_object_set_new(o, "nodes", json_integer(run->nodes));
  json_object_set_new(o, "cpus", json_integer(run->cpus));
  json_object_set_new(o, "time", vg_text_json(run->time));
  json_object_set_new(o, "partition", vg_text_json(run->partition));
  json_object_set_new(o, "job", vg_text_json(run->job));
  json_object_set_new(o, "pid", json_integer(run->pid));
  json_object_set_new(o, "pid_start", json_integer((json_int_t)run->pid_start));
  json_object_set_new(o, "exit_status", json_integer(run->exit_status));
  json_object_set_new(o, "created", json_integer(run->created));
  json_object_set_new(o, "started", json_integer(run->started));
  json_object_set_new(o, "ended", json_integer(run->ended));
  json_object_set_new(o, "note", vg_text_json(run->note));
  return o;
}

vg_status vg_record_write(const struct vg_serve_run *run, struct vg_error *err)
{
  json_t *o = record_of(run);
  char path[4096];
  vg_status st = vg_json_write(vg_run_path(run, "run.json", path), o,
                               "the record of a run", err);

  json_decref(o);
  return st;
}

/* --- reading ------------------------------------------------------------- */

static int take_text(const json_t *o, const char *key, char *to, size_t size)
{
  const char *text = json_string_value(json_object_get(o, key));

  if (!text || strlen(text) >= size) return 0;
  strcpy(to, text);
  return 1;
}

static int take_number(const json_t *o, const char *key, int64_t lo, int64_t hi,
                       int64_t *to)
{
  const json_t *v = json_object_get(o, key);

  if (!json_is_integer(v) || json_integer_value(v) < lo ||
      json_integer_value(v) > hi)
    return 0;
  *to = json_integer_value(v);
  return 1;
}

static int take_state(const json_t *o, struct vg_serve_run *run)
{
  const char *word = json_string_value(json_object_get(o, "state"));

  for (int k = 0; word && k < VG_SERVE_STATES; k++)
    if (!strcmp(word, vg_run_state_word((enum vg_serve_state)k))) {
      run->state = (enum vg_serve_state)k;
      return 1;
    }
  return 0;
}

static int take_numbers(const json_t *o, struct vg_serve_run *run)
{
  int64_t ranks, nodes, cpus, pid, pid_start, exit_status;

  if (!take_number(o, "ranks", 1, 1000000, &ranks) ||
      !take_number(o, "nodes", 1, 1000000, &nodes) ||
      !take_number(o, "cpus", 1, 100000, &cpus) ||
      !take_number(o, "pid", 0, INT32_MAX, &pid) ||
      !take_number(o, "pid_start", 0, INT64_MAX, &pid_start) ||
      !take_number(o, "exit_status", -1, 255, &exit_status) ||
      !take_number(o, "created", 0, INT64_MAX, &run->created) ||
      !take_number(o, "started", 0, INT64_MAX, &run->started) ||
      !take_number(o, "ended", 0, INT64_MAX, &run->ended))
    return 0;
  run->ranks = (int)ranks;
  run->nodes = (int)nodes;
  run->cpus = (int)cpus;
  run->pid = (pid_t)pid;
  run->pid_start = (unsigned long long)pid_start;
  run->exit_status = (int)exit_status;
  return 1;
}

/* A job number, which is passed to scancel: digits, or "12_3" of a job array.
 */
static int is_job(const char *job)
{
  return strspn(job, "0123456789_") == strlen(job) && *job != '_';
}

vg_status vg_record_parse(const char *name, const char *data, size_t size,
                          struct vg_serve_run *run, struct vg_error *err)
{
  struct vg_serve_run to = *run;
  json_error_t why;
  json_t *o = json_loadb(data, size, JSON_REJECT_DUPLICATES, &why);
  const char *project = json_string_value(json_object_get(o, "project"));
  char *copy = NULL;
  int ok = project && take_state(o, &to) && take_numbers(o, &to) &&
           take_text(o, "title", to.title, sizeof to.title) &&
           take_text(o, "time", to.time, sizeof to.time) &&
           take_text(o, "partition", to.partition, sizeof to.partition) &&
           take_text(o, "job", to.job, sizeof to.job) && is_job(to.job) &&
           take_text(o, "note", to.note, sizeof to.note);

  to.is_sweep = json_is_true(json_object_get(o, "sweep"));
  to.is_slurm = json_is_true(json_object_get(o, "slurm"));
  if (ok) copy = strdup(project);
  json_decref(o);
  if (!ok)
    return vg_fail(err, VG_ERR_FORMAT, "%s: not the record of a run", name);
  if (!copy) return vg_fail_memory(err, "the record of a run");
  free(run->project);
  to.project = copy;
  *run = to;
  return VG_OK;
}

vg_status vg_record_read(struct vg_serve_run *run, struct vg_error *err)
{
  char path[4096], *text = malloc(RECORD_MAX);
  int64_t whole;
  size_t n;
  vg_status st;

  if (!text) return vg_fail_memory(err, "the record of a run");
  n = vg_file_tail(vg_run_path(run, "run.json", path), text, RECORD_MAX,
                   &whole);
  st = n && whole == (int64_t)n
       ? vg_record_parse(path, text, n, run, err)
       : vg_fail(err, VG_ERR_FORMAT, "%s: not the record of a run", path);
  free(text);
  return st;
}
