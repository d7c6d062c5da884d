/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Data of the 3-D view: points, triangles and colours of the surface,
 * compressed; share/html/view.js and report.js draw it. */
#include <stdlib.h>

#include "cli/html/page.h"
#include "cli/scene/scene.h"

/* --- data for the script, as JSON ---------------------------------------- */

static json_t *colours(const uint8_t (*rgb)[3], size_t n)
{
  json_t *list = json_array();

  for (size_t i = 0; i < n; i++)
    json_array_append_new(list, json_pack("[i,i,i]", rgb[i][0], rgb[i][1],
                                          rgb[i][2]));
  return list;
}

static json_t *vector(const double x[3], const double less[3])
{
  json_t *list = json_array();

  for (int k = 0; k < 3; k++)
    json_array_append_new(list, json_real(x[k] - less[k]));
  return list;
}

static json_t *cuts(const struct page *p, const struct vg_scene *s)
{
  const struct vg_cut_plan *plan = &p->h->run->pictures.plan;
  json_t *list = json_array();

  for (size_t i = 0; i < plan->n; i++) {
    const struct vg_cut *c = &plan->cut[i];
    int u = c->axis == 0 ? 1 : 0, v = c->axis == 2 ? 1 : 2;

    if (plan->view[i] != VG_VIEW_BODY) continue;
    json_array_append_new(
      list, json_pack("{s:i s:i s:f s:[f,f] s:[f,f]}", "picture", (int)i,
                      "axis", c->axis, "at", c->at - s->centre[c->axis],
                      "centre", c->centre[0] - s->centre[u],
                      c->centre[1] - s->centre[v], "half", c->width / 2,
                      c->width * VG_CUT_HEIGHT / VG_CUT_WIDTH / 2));
  }
  return list;
}

static json_t *worst(const struct page *p, const struct vg_scene *s)
{
  const struct vg_mesh_report *m = p->has_layers ? &p->h->run->field_judge
                                                 : &p->h->run->judge;
  json_t *list = json_array();

  for (size_t i = 0; i < m->n_worst; i++)
    json_array_append_new(list, vector(m->worst[i].at, s->centre));
  return list;
}

static json_t *facts(const struct page *p, const struct vg_scene *s)
{
  json_t *o = vg_scene_json(s, &p->h->problem->boundary.surface, p->body,
                            p->camera[0].toward);
  json_t *names = json_array();

  for (int c = 0; c < VG_CAUSE_N; c++)
    json_array_append_new(names, json_string(vg_layer_cause_name(
                                   (enum vg_layer_cause)c)));
  json_object_set_new(o, "layers", json_boolean(p->has_layers));
  json_object_set_new(o, "levels", json_integer(p->walls.level_most));
  json_object_set_new(o, "cuts", cuts(p, s));
  json_object_set_new(o, "worst", worst(p, s));
  json_object_set_new(o, "levelColours",
                      colours(vg_level_colour, LEVEL_COLOURS));
  json_object_set_new(o, "causeColours", colours(vg_cause_colour, VG_CAUSE_N));
  json_object_set_new(o, "causes", names);
  return o;
}

/* --- the page ------------------------------------------------------------ */

static void words(struct page *p, const struct vg_scene *s)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;

  vg_page_section(p, "turn", "3-D view");
  vg_page_markup(
    p,
    "<div id=\"view\" hidden>\n<div id=\"controls\"></div>\n"
    "<canvas id=\"canvas\" tabindex=\"0\" role=\"img\" aria-label=\"3-D view "
    "of the surface. The arrow keys rotate it, plus and minus zoom; the "
    "pictures below show the same surface.\"></canvas>\n"
    "</div>\n<p class=\"note\">");
  vg_page_count(p, s->coarse.n_tri);
  if (s->coarse.step > 0) {
    vg_page_markup(p, " triangles, reduced from the ");
    vg_page_count(p, m->n_tri);
    vg_page_markup(p, " of the surface to limit the size of this page (points "
                      "were merged within cubes of width ");
    vg_page_real(p, s->coarse.step, 2);
    vg_page_markup(p, "); the pictures below show the full surface.");
  } else {
    vg_page_markup(p, " triangles, the full surface.");
  }
  vg_page_markup(p, " <span id=\"say\">Without scripts or WebGL this view is "
                    "not shown; the rest of the page is complete.</span></p>"
                    "\n");
  vg_page_end_section(p);
}

vg_status vg_html_scene(struct page *p, struct vg_error *err)
{
  const uint8_t *by[3] = { p->walls.by[BY_LEVEL], p->walls.by_share,
                           p->walls.by[BY_CAUSE] };
  struct vg_scene s = VG_SCENE_INIT;
  struct vg_bytes packed = { 0, NULL };
  json_t *o = NULL;
  char *text = NULL;
  vg_status st;

  VG_TRY(vg_scene_make(&p->h->problem->boundary.surface, p->body, &s, err));
  VG_TRY(vg_scene_pack(&s, 3, by, &packed, err));
  o = facts(p, &s);
  text = json_dumps(o, JSON_COMPACT | JSON_REAL_PRECISION(9));
  if (!text) {
    st = vg_fail_memory(err, "the scene");
    goto done;
  }
  words(p, &s);
  vg_page_markup(p, "<script type=\"application/json\" id=\"facts\">");
  vg_page_markup(p, text);
  vg_page_markup(p, "</script>\n<script type=\"text/plain\" id=\"scene\">");
  vg_page_base64(p, packed.data, packed.n);
  vg_page_markup(p, "</script>\n\n");
done:
  json_decref(o);
  free(text);
  free(packed.data);
  vg_scene_release(&s);
  return st;
}
