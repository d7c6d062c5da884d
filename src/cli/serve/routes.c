/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Answers requests by method and path. Declared in cli/serve/portal_parts.h. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/scene/assets.h"
#include "cli/http/archive.h"
#include "cli/serve/assets.h"
#include "cli/serve/figures.h"
#include "cli/serve/form.h"
#include "cli/serve/page_markup.h"
#include "cli/serve/portal_parts.h"
#include "cli/serve/projects.h"
#include "run/common/json_build.h"
#include "run/settings/deck.h"

/* Split "12/log" into 12 and "log"; 0: no number. */
static int take_id(const char *path, const char **rest)
{
  size_t n = strspn(path, "0123456789");

  if (!n || n > 4 || path[n] != '/') return 0;
  *rest = path + n + 1;
  return atoi(path);
}

static void answer_bytes(struct vg_reply *a, const char *type,
                         const unsigned char *data, size_t size)
{
  a->type = type;
  a->body = malloc(size + 1);
  if (!a->body) {
    vg_reply_text(a, 500, "Out of memory.");
    return;
  }
  memcpy(a->body, data, size);
  a->size = size;
}

/* Answer with the page or, without a view, with the list of runs. */
static void answer_page(const struct vg_portal *p, const struct vg_page_view *v,
                        int status, struct vg_reply *a)
{
  FILE *to = vg_text_open(&a->body, &a->size);

  a->status = status;
  if (to) {
    if (v) vg_page(p, v, to);
    else vg_page_runs(p, to);
  }
  if (!to || fclose(to)) vg_reply_text(a, 500, "Out of memory.");
}

/* Files of share/html. */
static const struct asset {
  const char *name, *type;
  const unsigned char *data;
  const size_t *size;
} assets[] = {
#define CSS "text/css; charset=utf-8"
#define JS "text/javascript; charset=utf-8"
  { "portal.css", CSS, vg_asset_portal_css, &vg_asset_portal_css_size },
  { "portal.js", JS, vg_asset_portal_js, &vg_asset_portal_js_size },
  { "view.js", JS, vg_asset_view_js, &vg_asset_view_js_size },
  { "form.js", JS, vg_asset_form_js, &vg_asset_form_js_size },
  { "case.js", JS, vg_asset_case_js, &vg_asset_case_js_size },
#undef CSS
#undef JS
};

/* --- GET ----------------------------------------------------------------- */

static struct vg_serve_run *run_of(const struct vg_portal *p, const char *id)
{
  return id && strlen(id) < 5 ? vg_runs_find(&p->runs, atoi(id)) : NULL;
}

/* The runs of "?compare=3&compare=5"; further ones are ignored. */
static void find_compared(const struct vg_portal *p, const struct vg_fields *f,
                          struct vg_compared *c)
{
  for (size_t i = 0; i < f->n && c->n < VG_COMPARED_MAX; i++) {
    const struct vg_serve_run *run;
    size_t k = 0;

    if (strcmp(f->item[i].name, "compare") != 0) continue;
    run = run_of(p, f->item[i].value);
    while (k < c->n && c->run[k] != run) k++;
    if (run && k == c->n && !run->is_sweep && !vg_run_is_active(run))
      c->run[c->n++] = run;
  }
}

static void get_page(const struct vg_portal *p, const struct vg_request *r,
                     struct vg_reply *a)
{
  const char *report = vg_fields_get(&r->query, "report");
  const char *sweep = vg_fields_get(&r->query, "sweep");
  struct vg_compared compared = { 0, { NULL } };
  struct vg_page_view v = { .project = vg_fields_get(&r->query, "project") };

  v.uploaded = vg_fields_get(&r->query, "uploaded");
  v.from = run_of(p, vg_fields_get(&r->query, "from"));
  if (v.from) v.project = v.from->project;
  v.report = run_of(p, report);
  v.sweep = run_of(p, sweep);
  if ((report && !v.report) || (sweep && !(v.sweep && v.sweep->is_sweep))) {
    vg_reply_missing(a);
    return;
  }
  if (vg_fields_get(&r->query, "compare")) {
    find_compared(p, &r->query, &compared);
    v.compared = &compared;
  }
  answer_page(p, &v, 200, a);
}

static void get_json(const struct vg_portal *p, struct vg_reply *a)
{
  a->type = "application/json";
  a->body = vg_page_runs_json(p);
  if (a->body) a->size = strlen(a->body);
  else vg_reply_text(a, 500, "Out of memory.");
}

/* The files of a run as one download; kept tasks are of no use elsewhere. */
static void get_archive(const struct vg_serve_run *run, struct vg_reply *a)
{
  struct vg_error err = VG_ERROR_INIT;
  char prefix[32];

  if (vg_run_is_active(run)) {
    vg_reply_text(a, 409, "This run is active; its files are incomplete.");
    return;
  }
  snprintf(prefix, sizeof prefix, "vanguard-%04d", run->id);
  if (vg_archive_open(run->dir, prefix, "kept", &a->archive, &err) < 0) {
    vg_reply_text(a, 500, err.text);
    return;
  }
  a->type = "application/x-tar";
  if (asprintf(&a->download, "%s.tar", prefix) < 0) a->download = NULL;
}

/* Paths below runs/: 12/log, 12/output, 12/deck, 12/archive.tar, 12/picture/0,
 * 12/file/mesh/wing.vtu. */
static void get_of_run(const struct vg_portal *p, const char *path,
                       struct vg_reply *a)
{
  static const char *const names[][2] = { { "log", "run.log" },
                                          { "output", "output.log" },
                                          { "deck", "run.deck" } };
  const char *what = "";
  const struct vg_serve_run *run = vg_runs_find(&p->runs, take_id(path, &what));

  if (!run) {
    vg_reply_missing(a);
    return;
  }
  if (!strncmp(what, "file/", 5)) {
    vg_reply_file(run, what + 5, a);
    return;
  }
  if (!strcmp(what, "archive.tar")) {
    get_archive(run, a);
    return;
  }
  if (!strcmp(what, "picture/0") || !strcmp(what, "picture/1")) {
    vg_reply_picture(run, what[8] - '0', a);
    return;
  }
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (!strcmp(what, names[i][0])) {
      vg_reply_file(run, names[i][1], a);
      return;
    }
  vg_reply_missing(a);
}

static int get_asset(const char *path, struct vg_reply *a)
{
  for (size_t i = 0; i < sizeof assets / sizeof *assets; i++)
    if (!strcmp(path, assets[i].name)) {
      answer_bytes(a, assets[i].type, assets[i].data, *assets[i].size);
      return 1;
    }
  return 0;
}

static void get(const struct vg_portal *p, const struct vg_request *r,
                const char *path, struct vg_reply *a)
{
  if (!*path) get_page(p, r, a);
  else if (!strcmp(path, "runs")) answer_page(p, NULL, 200, a);
  else if (!strcmp(path, "runs.json")) get_json(p, a);
  else if (!strncmp(path, "runs/", 5)) get_of_run(p, path + 5, a);
  else if (!strncmp(path, "looks/", 6)) vg_route_look(p, path + 6, a);
  else if (!get_asset(path, a)) vg_reply_missing(a);
}

/* --- POST ---------------------------------------------------------------- */

vg_status vg_take_form(const struct vg_portal *p, const struct vg_fields *f,
                       struct vg_settings *s, struct vg_serve_run *run,
                       struct vg_form_fault *fault, struct vg_error *err)
{
  vg_status st;

  VG_TRY(
    vg_project_settings(p->root, vg_fields_text(f, "project"), NULL, s, err));
  VG_TRY(vg_form_settings(f, p->root, s, fault, err));
  VG_TRY(vg_form_run(f, run, fault, err));
  strcpy(fault->field, "where");
  if (run->is_slurm && !p->has_slurm)
    st = vg_fail(err, VG_ERR_INPUT,
                 "Slurm is not available: sbatch and squeue "
                 "are not in the PATH of the portal");
done:
  return st;
}

/* Create a queued run with its folder and deck. */
static vg_status make_run(struct vg_portal *p, const struct vg_fields *f,
                          struct vg_serve_run **out,
                          struct vg_form_fault *fault, struct vg_error *err)
{
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_serve_run given = { 0 }, *run;
  const char *project = vg_fields_text(f, "project");
  char path[4096], *name = NULL;
  vg_status st;

  VG_TRY(vg_take_form(p, f, &s, &given, fault, err));
  fault->field[0] = 0;
  name = strdup(project);
  if (!name) {
    st = vg_fail_memory(err, "a run");
    goto done;
  }
  VG_TRY(vg_runs_new(&p->runs, &run, err));
  free(run->project);
  run->project = name;
  name = NULL;
  snprintf(run->title, sizeof run->title, "%s", s.title);
  run->is_sweep = given.is_sweep;
  run->is_slurm = given.is_slurm;
  run->ranks = given.ranks;
  run->nodes = given.nodes;
  run->cpus = given.is_slurm ? given.cpus : s.threads > 0 ? (int)s.threads : 1;
  strcpy(run->time, given.time);
  strcpy(run->partition, given.partition);
  st = vg_deck_write(vg_run_path(run, "run.deck", path), &s, NULL, VG_DECK_ALL,
                     err);
  if (st >= 0) st = vg_record_write(run, err);
  if (st < 0) { /* the run stays in the list, with the reason */
    run->state = VG_SERVE_FAILED;
    snprintf(run->note, sizeof run->note, "%.250s", err->text);
  }
  *out = run;
done:
  free(name);
  vg_settings_release(&s);
  return st;
}

static void go_to_run(const struct vg_portal *p, const struct vg_serve_run *run,
                      struct vg_reply *a)
{
  char to[32];

  snprintf(to, sizeof to, "#run-%d", run->id);
  vg_reply_go(p, a, to);
}

/* fault: the field to which the message belongs, or NULL. */
static void refuse(const struct vg_portal *p, const struct vg_request *r,
                   const char *message, const struct vg_form_fault *fault,
                   struct vg_reply *a)
{
  struct vg_page_view v = { .project = vg_fields_get(&r->form, "project"),
                            .message = message,
                            .posted = &r->form,
                            .fault = fault };

  answer_page(p, &v, 400, a);
}

static void post_run(struct vg_portal *p, struct vg_request *r,
                     struct vg_reply *a)
{
  struct vg_form_fault fault = VG_FORM_FAULT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_serve_run *run = NULL;

  if (make_run(p, &r->form, &run, &fault, &err) < 0) {
    refuse(p, r, err.text, &fault, a);
    return;
  }
  if (run->is_slurm) vg_run_launch(&p->runs, run);
  else vg_runs_watch(&p->runs); /* starts it at once if possible */
  go_to_run(p, run, a);
}

static void resume(struct vg_portal *p, struct vg_serve_run *run)
{
  struct vg_error err;

  if (!vg_run_can_resume(run)) return;
  if (run->is_slurm) {
    vg_run_launch(&p->runs, run);
    return;
  }
  run->state = VG_SERVE_QUEUED;
  run->note[0] = 0;
  vg_record_write(run, &err);
  vg_runs_watch(&p->runs);
}

static void remove_run(struct vg_portal *p, struct vg_serve_run *run,
                       struct vg_reply *a)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_runs_remove(&p->runs, run, &err) < 0)
    vg_reply_text(a, err.code == VG_ERR_INPUT ? 409 : 500, err.text);
  else vg_reply_go(p, a, "#runs");
}

/* Paths runs/12/stop, kill, resume, delete. A request that no longer applies is
 * not an error, since the page may be older than the state of the run. */
static void post_to_run(struct vg_portal *p, const char *path,
                        struct vg_reply *a)
{
  const char *what = "";
  struct vg_serve_run *run = vg_runs_find(&p->runs, take_id(path, &what));

  if (!run) {
    vg_reply_missing(a);
    return;
  }
  if (!strcmp(what, "stop")) vg_run_stop(&p->runs, run, 0);
  else if (!strcmp(what, "kill")) vg_run_stop(&p->runs, run, 1);
  else if (!strcmp(what, "resume")) resume(p, run);
  else if (!strcmp(what, "delete")) {
    remove_run(p, run, a);
    return;
  } else {
    vg_reply_missing(a);
    return;
  }
  go_to_run(p, run, a);
}

static void post_upload(struct vg_portal *p, struct vg_request *r,
                        struct vg_reply *a)
{
  const char *under = vg_fields_text(&r->form, "folder");
  struct vg_error err = VG_ERROR_INIT;
  FILE *to;
  char *address = NULL;
  size_t size;

  if (vg_upload_commit(&r->upload, &err) < 0) {
    refuse(p, r, err.text, NULL, a);
    return;
  }
  if (!r->upload.n_whole) {
    refuse(p, r, "no file was selected", NULL, a);
    return;
  }
  to = vg_text_open(&address, &size);
  if (to) {
    fputs(vg_projects_is_name(r->upload.name) ? "?project=" : "?uploaded=", to);
    vg_markup_path(to, under);
    if (*under) fputs("/", to);
    vg_markup_path(to, r->upload.name);
    fclose(to);
  }
  vg_reply_go(p, a, address ? address : "");
  free(address);
}

static void post(struct vg_portal *p, struct vg_request *r, const char *path,
                 struct vg_reply *a)
{
  if (r->body < 0 && strcmp(path, "upload") != 0)
    vg_reply_text(a, 400, r->error.text);
  else if (r->body < 0) refuse(p, r, r->error.text, NULL, a);
  else if (!strcmp(path, "runs")) post_run(p, r, a);
  else if (!strcmp(path, "upload")) post_upload(p, r, a);
  else if (!strncmp(path, "runs/", 5)) post_to_run(p, path + 5, a);
  else if (!strncmp(path, "looks/", 6)) vg_route_to_look(p, r, path + 6, a);
  else vg_reply_missing(a);
}

void vg_route(struct vg_portal *p, struct vg_request *r, const char *rest,
              struct vg_reply *a)
{
  vg_json_forget();
  if (!*rest) vg_reply_go(p, a, ""); /* relative URLs need the '/' */
  else if (!strcmp(r->method, "POST")) post(p, r, rest + 1, a);
  else get(p, r, rest + 1, a);
}
