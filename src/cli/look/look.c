/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/look/look.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/common/cli.h"
#include "cli/scene/scene.h"
#include "io/stream/stream.h"
#include "run/common/json_file.h"
#include "run/common/text.h"
#include "run/picture/body.h"
#include "run/report/report.h"

/* Direction of the first view, as in the report: from the front and above. */
static const double toward[3] = { -0.62, -0.55, 0.56 };

struct look {
  struct vg_problem problem;
  struct vg_layer_stage layers;
  struct vg_scene scene;
  uint8_t *body; /* [n_patch] patches of the body */
  uint8_t *kind; /* [n_tri] first kind of defect, or VG_LOOK_SOUND */
  json_t *out;
};

static void release(struct look *l)
{
  vg_layer_stage_release(&l->layers);
  vg_problem_release(&l->problem);
  vg_scene_release(&l->scene);
  free(l->body);
  free(l->kind);
  json_decref(l->out);
}

/* Settings that change the shape of the surface, and take long, are for the
 * check. The domain is still completed, so that all patches are visible. */
static void keep_as_read(struct vg_settings *s)
{
  s->remesh = VG_ANSWER_NO;
  s->wrap = 0;
  s->gap_edges = 0;
}

/* Checks the surface, completes the domain and finds the walls. On failure the
 * surface and its check are still there. */
static vg_status examine(struct look *l, struct vg_display *show,
                         struct vg_error *err)
{
  const struct vg_shape_options o = {
    .threads = (int)l->problem.asked.threads
  };
  struct vg_boundary *b = &l->problem.boundary;
  vg_status st;

  VG_TRY(vg_boundary_shape(&l->problem.read, &o, show, b, err));
  VG_TRY(vg_boundary_close(b, show, err));
  st = vg_layer_stage_plan(&l->layers, b, err);
done:
  return st;
}

/* Patches of the body: not those that closing the domain has added, and not
 * farfields and symmetry planes of the file. */
static vg_status find_body(struct look *l, const struct vg_mesh *m,
                           struct vg_error *err)
{
  size_t n_own = l->problem.boundary.n_row;

  l->body = vg_calloc(m->n_patch + 1, 1);
  if (!l->body) return vg_fail_memory(err, "the patches");
  vg_body_patches(m, NULL, l->body);
  if (n_own)
    for (size_t i = n_own; i < m->n_patch; i++) l->body[i] = 0;
  return VG_OK;
}

static vg_status find_kinds(struct look *l, const struct vg_mesh *m,
                            const struct vg_surface_report *r,
                            struct vg_error *err)
{
  l->kind = vg_alloc(m->n_tri + 1, 1);
  if (!l->kind) return vg_fail_memory(err, "the defects");
  memset(l->kind, VG_LOOK_SOUND, m->n_tri + 1);
  for (size_t t = 0; r->face_kinds && t < m->n_tri; t++)
    for (int k = VG_DEFECT_N; k-- > 0;)
      if (r->face_kinds[t] >> k & 1) l->kind[t] = (uint8_t)k;
  return VG_OK;
}

static vg_status write_scene(struct look *l, const struct vg_mesh *m,
                             struct vg_error *err)
{
  const uint8_t *const by[1] = { l->kind };
  struct vg_bytes packed = { 0, NULL };
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st;

  VG_TRY(vg_scene_make(m, l->body, &l->scene, err));
  VG_TRY(vg_scene_pack(&l->scene, 1, by, &packed, err));
  VG_TRY(vg_output_open(VG_LOOK_SCENE, &out, err));
  vg_output_bytes(&out, packed.data, packed.n);
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  free(packed.data);
  return st;
}

/* --- result -------------------------------------------------------------- */

/* 1 for a patch that closing the domain has added, which no deck can name. */
static int is_added(const struct look *l, size_t i)
{
  size_t n_own = l->problem.boundary.n_row;

  return n_own && i >= n_own;
}

/* The patches, with walls and layers where these are known. */
static json_t *patches(const struct look *l, const struct vg_mesh *m)
{
  json_t *list = vg_report_patches_json(m), *one;
  size_t i;

  json_array_foreach(list, i, one)
  {
    int known = l->layers.reason && i < l->layers.n_patch;

    json_object_set_new(one, "body", json_boolean(l->body[i]));
    json_object_set_new(one, "added", json_boolean(is_added(l, i)));
    json_object_set_new(one, "layers",
                        known ? json_boolean(l->layers.is_on &&
                                             l->layers.reason[i] != VG_WALL_NOT)
                              : json_null());
    json_object_set_new(one, "reason",
                        known ? json_string(
                                  vg_wall_reason_name(l->layers.reason[i]))
                              : json_null());
  }
  return list;
}

/* Names of the kinds of defects, by which the bytes of the scene count. */
static json_t *kinds(void)
{
  json_t *list = json_array();

  for (int k = 0; k < VG_DEFECT_N; k++)
    json_array_append_new(list, json_string(
                                  vg_defect_heading((enum vg_defect_kind)k)));
  return list;
}

static void describe(struct look *l, const struct vg_mesh *m, vg_status st,
                     const struct vg_error *err)
{
  const struct vg_boundary *b = &l->problem.boundary;
  json_t *o = l->out;

  json_object_set_new(o, "ok", json_boolean(st >= 0));
  json_object_set_new(o, "error",
                      st < 0 ? vg_text_json(err->text) : json_null());
  json_object_set_new(o, "flow",
                      vg_report_flow_json(&b->flow,
                                          b->flow.kind == VG_FLOW_EXTERNAL &&
                                            b->read->settings.farfield.kind !=
                                              VG_DOMAIN_NONE));
  json_object_set_new(o, "surface",
                      vg_report_surface_json(m, &b->check, b->read->unit,
                                             VG_LISTED_DEFECTS));
  json_object_set_new(o, "remesh", vg_report_remesh_json(&b->remeshing, m));
  json_object_set_new(o, "size", vg_report_size_json(m));
  json_object_set_new(o, "patches", patches(l, m));
  json_object_set_new(o, "layers", json_boolean(l->layers.is_on));
  json_object_set_new(o, "notes", vg_report_notes_json(&l->problem.notes));
  json_object_set_new(o, "kinds", kinds());
  json_object_set_new(o, "scene", vg_scene_json(&l->scene, m, l->body, toward));
}

/* Messages begin with the path of the project; the page shows its name. */
static void shorten(const char *project, struct vg_error *err)
{
  const char *slash = strrchr(project, '/');
  size_t n = slash ? (size_t)(slash - project) + 1 : 0;

  if (n && !strncmp(err->text, project, n))
    memmove(err->text, err->text + n, strlen(err->text + n) + 1);
}

static vg_status look(struct look *l, enum vg_look_kind kind,
                      const char *project, struct vg_display *show,
                      struct vg_error *err)
{
  struct vg_problem *p = &l->problem;
  struct vg_error why = VG_ERROR_INIT;
  const struct vg_mesh *m;
  vg_status st, found;

  l->out = json_object();
  VG_TRY(vg_problem_open(p, project, VG_LOOK_DECK, err));
  if (kind == VG_LOOK_VIEW) keep_as_read(&p->asked);
  VG_TRY(vg_problem_read(p, NULL, show, err));
  found = examine(l, show, &why);
  m = &p->boundary.surface;
  if (found < 0 && !m->n_tri) { /* there is nothing to show */
    st = vg_fail(err, found, "%s", why.text);
    goto done;
  }
  shorten(project, &why);
  VG_TRY(find_body(l, m, err));
  VG_TRY(find_kinds(l, m, &p->boundary.check, err));
  VG_TRY(write_scene(l, m, err));
  describe(l, m, found, &why);
  st = vg_json_write(VG_LOOK_JSON, l->out, "the result", err);
done:
  return st;
}

int vg_look(enum vg_look_kind kind, const char *project)
{
  struct look l = { .problem = VG_PROBLEM_INIT,
                    .layers = VG_LAYER_STAGE_INIT,
                    .scene = VG_SCENE_INIT };
  struct vg_error err = VG_ERROR_INIT;
  struct vg_display show;
  vg_status st;

  vg_display_init(&show, 0);
  vg_display_end_at_once(1); /* the files appear only when complete */
  show.every = 0.5;
  vg_display_update(&show, "read", 0, 0);
  st = look(&l, kind, project, &show, &err);
  vg_display_clear(&show);
  release(&l);
  shorten(project, &err);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
