/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/serve/looks.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/common/process.h"
#include "cli/look/look.h"
#include "cli/serve/runs.h"
#include "run/common/json_build.h"
#include "run/common/text.h"
#include "run/settings/deck.h"

#define OUTPUT "output.log"
#define RESULT_MAX (64 << 20) /* bytes of a result */

static const char *const words[VG_SEE_TYPES] = { "view", "check", "plan" };

const char *vg_look_word(enum vg_look_type type)
{
  return words[type];
}

enum vg_look_type vg_look_type_of(const char *word)
{
  int k = 0;

  while (k < VG_SEE_TYPES && strcmp(word, words[k]) != 0) k++;
  return (enum vg_look_type)k;
}

vg_status vg_looks_open(struct vg_looks *l, const char *dir,
                        struct vg_error *err)
{
  struct stat s;

  if (asprintf(&l->dir, "%s/looks", dir) < 0) l->dir = NULL;
  if (!l->dir) return vg_fail_memory(err, "a path");
  if ((mkdir(l->dir, 0777) && errno != EEXIST) || lstat(l->dir, &s) ||
      !S_ISDIR(s.st_mode))
    return vg_fail(err, VG_ERR_IO, "%s: cannot create this folder", l->dir);
  for (int k = 0; k < VG_SEE_TYPES; k++) {
    char **path = &l->item[k].dir;

    if (asprintf(path, "%s/%s", l->dir, words[k]) < 0) *path = NULL;
    if (!*path) return vg_fail_memory(err, "a path");
    if ((mkdir(*path, 0777) && errno != EEXIST) || lstat(*path, &s) ||
        !S_ISDIR(s.st_mode))
      return vg_fail(err, VG_ERR_IO, "%s: cannot create this folder", *path);
  }
  return VG_OK;
}

/* A look has no state to save, so it is killed with all its children. */
static void end(struct vg_look_process *p)
{
  if (p->state != VG_SEE_RUNNING) return;
  kill(-p->pid, SIGKILL);
  while (waitpid(p->pid, NULL, 0) < 0 && errno == EINTR) continue;
  p->state = VG_SEE_FAILED;
  p->pid = 0;
  snprintf(p->note, sizeof p->note, "stopped");
}

void vg_looks_release(struct vg_looks *l)
{
  for (int k = 0; k < VG_SEE_TYPES; k++) {
    end(&l->item[k]);
    free(l->item[k].dir);
  }
  free(l->dir);
  memset(l, 0, sizeof *l);
}

enum vg_look_type vg_looks_find(const struct vg_looks *l, int id)
{
  int k = 0;

  while (k < VG_SEE_TYPES &&
         (l->item[k].id != id || l->item[k].state == VG_SEE_NOTHING))
    k++;
  return (enum vg_look_type)k;
}

void vg_looks_stop(struct vg_looks *l, int id)
{
  enum vg_look_type type = vg_looks_find(l, id);

  if (type < VG_SEE_TYPES) end(&l->item[type]);
}

static char *path_of(const struct vg_look_process *p, const char *name,
                     char path[4096])
{
  snprintf(path, 4096, "%s/%s", p->dir, name);
  return path;
}

/* --- starting ------------------------------------------------------------ */

static vg_status add_project(const struct vg_look_order *o, struct vg_words *w,
                             struct vg_error *err)
{
  size_t n = strlen(o->project);
  char *path;

  if (n > 4 && !strcmp(o->project + n - 4, ".d3m")) n -= 4;
  if (asprintf(&path, "%s/%.*s", o->root, (int)n, o->project) < 0) path = NULL;
  return vg_words_take(w, path, err);
}

static vg_status plan_line(const struct vg_look_order *o, struct vg_words *w,
                           struct vg_error *err)
{
  static const char *const first[] = { "plan", "--json", "--quiet", "--deck",
                                       VG_LOOK_DECK };
  long cores = sysconf(_SC_NPROCESSORS_ONLN);
  int64_t threads = o->s->threads > 0 ? o->s->threads : cores > 0 ? cores : 1;
  vg_status st;

  VG_TRY(vg_words_add(w, o->program, err));
  for (size_t i = 0; i < sizeof first / sizeof *first; i++)
    VG_TRY(vg_words_add(w, first[i], err));
  VG_TRY(vg_words_pair(w, "--ranks", o->ranks, err));
  VG_TRY(vg_words_pair(w, "--ranks-per-node", o->ranks, err));
  VG_TRY(vg_words_pair(w, "--threads", threads, err));
  VG_TRY(vg_words_add(w, "--project", err));
  st = add_project(o, w, err);
done:
  return st;
}

static vg_status look_line(const struct vg_look_order *o, struct vg_words *w,
                           struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_words_add(w, o->own, err));
  VG_TRY(vg_words_add(w, "serve", err));
  VG_TRY(vg_words_add(w, "--look", err));
  VG_TRY(vg_words_add(w, words[o->type], err));
  st = add_project(o, w, err);
done:
  return st;
}

vg_status vg_looks_start(struct vg_looks *l, const struct vg_look_order *o,
                         int *id, struct vg_error *err)
{
  static const char *const files[] = { VG_LOOK_DECK, VG_LOOK_JSON,
                                       VG_LOOK_SCENE, OUTPUT };
  struct vg_look_process *p = &l->item[o->type];
  struct vg_words w = VG_WORDS_INIT;
  char path[4096];
  vg_status st;

  if (!o->may_start)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "this portal starts no processes");
  end(p);
  p->state = VG_SEE_NOTHING;
  for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    unlink(path_of(p, files[i], path));
  VG_TRY(vg_deck_write(path_of(p, VG_LOOK_DECK, path), o->s, NULL, VG_DECK_ALL,
                       err));
  VG_TRY((o->type == VG_SEE_PLAN ? plan_line : look_line)(o, &w, err));
  p->pid = vg_run_spawn(p->dir, w.word, OUTPUT, NULL);
  if (p->pid < 0) {
    st = vg_fail(err, VG_ERR_IO, "cannot start another process: %s",
                 strerror(errno));
    goto done;
  }
  p->id = *id = ++l->n;
  p->state = VG_SEE_RUNNING;
  p->note[0] = 0;
done:
  vg_words_release(&w);
  return st;
}

/* --- ends ---------------------------------------------------------------- */

void vg_looks_watch(struct vg_looks *l)
{
  for (int k = 0; k < VG_SEE_TYPES; k++) {
    struct vg_look_process *p = &l->item[k];
    char path[4096];
    int status;
    pid_t got;

    if (p->state != VG_SEE_RUNNING) continue;
    got = waitpid(p->pid, &status, WNOHANG);
    if (!got || (got < 0 && errno == EINTR)) continue;
    p->pid = 0;
    p->state = got > 0 && WIFEXITED(status) && !WEXITSTATUS(status)
               ? VG_SEE_DONE
               : VG_SEE_FAILED;
    if (p->state == VG_SEE_FAILED)
      vg_failure_note(path_of(p, OUTPUT, path), p->note, sizeof p->note);
  }
}

/* --- results ------------------------------------------------------------- */

/* The result of a forecast: the output of vanguard plan from its first brace
 * on, without the tree, which the page does not show. */
static json_t *plan_result(const char *text, size_t n)
{
  const char *brace = memchr(text, '{', n);
  json_error_t why;
  json_t *o;

  if (!brace) return NULL;
  o = json_loadb(brace, n - (size_t)(brace - text), JSON_DISABLE_EOF_CHECK,
                 &why);
  json_object_del(json_object_get(o, "tree"), "nodes");
  return o;
}

static json_t *result_of(const struct vg_look_process *p,
                         enum vg_look_type type)
{
  const char *name = type == VG_SEE_PLAN ? OUTPUT : VG_LOOK_JSON;
  char path[4096], *text;
  json_error_t why;
  struct stat s;
  int64_t whole;
  json_t *o = NULL;
  size_t n;

  if (lstat(path_of(p, name, path), &s) || s.st_size > RESULT_MAX) return NULL;
  text = malloc((size_t)s.st_size + 1);
  if (!text) return NULL;
  n = vg_file_tail(path, text, (size_t)s.st_size + 1, &whole);
  o = type == VG_SEE_PLAN ? plan_result(text, n) : json_loadb(text, n, 0, &why);
  free(text);
  return o;
}

static void add_progress(const struct vg_look_process *p, json_t *o)
{
  struct vg_tell tell = VG_TELL_INIT;
  char path[4096], text[4096];
  int64_t whole;
  size_t n = vg_file_tail(path_of(p, OUTPUT, path), text, sizeof text, &whole);

  vg_tell_tail(text, n, whole > (int64_t)n, &tell);
  json_object_set_new(o, "stage", vg_text_json(tell.stage));
  json_object_set_new(o, "share",
                      tell.share >= 0 ? json_real(tell.share) : json_null());
}

char *vg_looks_json(const struct vg_looks *l, enum vg_look_type type)
{
  static const char *const states[] = { "none", "running", "done", "failed" };
  const struct vg_look_process *p = &l->item[type];
  enum vg_look_state state = p->state;
  const char *note = p->note;
  json_t *o = json_object(), *result = NULL;
  char *text;

  if (state == VG_SEE_DONE) result = result_of(p, type);
  if (state == VG_SEE_DONE && !result) {
    state = VG_SEE_FAILED;
    note = "the process left no result";
  }
  json_object_set_new(o, "id", json_integer(p->id));
  json_object_set_new(o, "kind", json_string(words[type]));
  json_object_set_new(o, "state", json_string(states[state]));
  if (state == VG_SEE_RUNNING) add_progress(p, o);
  if (state == VG_SEE_FAILED)
    json_object_set_new(o, "error", vg_text_json(note));
  if (result) json_object_set_new(o, "result", result);
  text = json_dumps(o, JSON_COMPACT);
  json_decref(o);
  return text;
}
