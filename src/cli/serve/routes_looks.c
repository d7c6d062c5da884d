/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Paths of looks, for the script of the page: POST looks/KIND with a form
 * starts one, GET looks/ID has its state and result, GET looks/ID/scene the 3-D
 * view, POST looks/ID/stop ends it. Declared in cli/serve/portal_parts.h. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>

#include "cli/common/process.h"
#include "cli/look/look.h"
#include "cli/serve/portal_parts.h"
#include "cli/serve/projects.h"
#include "run/common/json_build.h"
#include "run/common/text.h"

static void answer_json(struct vg_reply *a, int status, char *text)
{
  a->status = status;
  a->type = "application/json";
  a->body = text;
  if (text) a->size = strlen(text);
  else vg_reply_text(a, 500, "Out of memory.");
}

/* An object, which is released. */
static void answer_object(struct vg_reply *a, int status, json_t *o)
{
  char *text = o ? json_dumps(o, JSON_COMPACT) : NULL;

  json_decref(o);
  answer_json(a, status, text);
}

/* The look "12" or "12/scene"; VG_SEE_TYPES: there is no such look. */
static enum vg_look_type take_look(const struct vg_portal *p, const char *path,
                                   int *id, const char **rest)
{
  size_t n = strspn(path, "0123456789");

  *rest = path + n;
  if (!n || n > 9 || (path[n] && path[n] != '/')) return VG_SEE_TYPES;
  *id = atoi(path);
  *rest += path[n] == '/';
  return vg_looks_find(&p->looks, *id);
}

void vg_route_look(const struct vg_portal *p, const char *path,
                   struct vg_reply *a)
{
  const char *what;
  int id;
  enum vg_look_type type = take_look(p, path, &id, &what);

  if (type == VG_SEE_TYPES)
    answer_object(a, 404,
                  json_pack("{s:s}", "error",
                            "a newer request has replaced this one"));
  else if (!*what) answer_json(a, 200, vg_looks_json(&p->looks, type));
  else if (!strcmp(what, "scene"))
    vg_reply_bytes(p->looks.item[type].dir, VG_LOOK_SCENE, a);
  else vg_reply_missing(a);
}

/* The settings of a look. The surface of the file is shown whatever is wrong in
 * the form; it then has the settings of the project. */
static vg_status take_settings(const struct vg_portal *p,
                               const struct vg_fields *f,
                               enum vg_look_type type, struct vg_settings *s,
                               struct vg_serve_run *run,
                               struct vg_form_fault *fault,
                               struct vg_error *err)
{
  vg_status st = vg_take_form(p, f, s, run, fault, err);

  if (st >= 0 || type != VG_SEE_VIEW || !*fault->field) return st;
  vg_settings_release(s);
  memset(s, 0, sizeof *s);
  return vg_project_settings(p->root, vg_fields_text(f, "project"), NULL, s,
                             err);
}

static void start(struct vg_portal *p, const struct vg_fields *f,
                  enum vg_look_type type, struct vg_reply *a)
{
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_serve_run run = { 0 };
  struct vg_form_fault fault = VG_FORM_FAULT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char *own = vg_own_path();
  struct vg_look_order order = { .type = type,
                                 .own = own,
                                 .program = p->runs.program,
                                 .root = p->root,
                                 .project = vg_fields_text(f, "project"),
                                 .s = &s,
                                 .may_start = p->o.jobs > 0 };
  int id = 0;
  vg_status st;

  VG_TRY(own ? VG_OK : vg_fail_memory(&err, "a path"));
  VG_TRY(take_settings(p, f, type, &s, &run, &fault, &err));
  order.ranks = run.ranks * (run.is_slurm ? run.nodes : 1);
  st = vg_looks_start(&p->looks, &order, &id, &err);
done:
  if (st < 0)
    answer_object(a, 400,
                  json_pack("{s:o s:s s:i}", "error", vg_text_json(err.text),
                            "field", fault.field, "line", fault.line));
  else answer_object(a, 200, json_pack("{s:i}", "id", id));
  vg_settings_release(&s);
  free(own);
}

void vg_route_to_look(struct vg_portal *p, const struct vg_request *r,
                      const char *path, struct vg_reply *a)
{
  enum vg_look_type type = vg_look_type_of(path);
  const char *what;
  int id;

  if (type < VG_SEE_TYPES) {
    start(p, &r->form, type, a);
    return;
  }
  type = take_look(p, path, &id, &what);
  if (type == VG_SEE_TYPES || strcmp(what, "stop") != 0) {
    vg_reply_missing(a);
    return;
  }
  vg_looks_stop(&p->looks, id);
  answer_json(a, 200, vg_looks_json(&p->looks, type));
}
