/* Data of the 3-D view: points, triangles and colours of the surface,
 * compressed; share/html/report.js draws it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/html/page.h"
#include "core/geometry/vector.h"
#include "run/common/text.h"
#include "run/picture/decimate.h"

#define MOST 120000 /* triangles (V1) */

/* The decimated surface. order[first[i]] .. order[first[i + 1] - 1] are the
 * triangles of patch i. */
struct scene {
  struct vg_decimated coarse;
  size_t *first, *order;             /* [n_patch + 1], [n_tri] */
  double centre[3], half[3], radius; /* of the bounding box of the body */
};

static void release(struct scene *s)
{
  vg_decimated_release(&s->coarse);
  free(s->first);
  free(s->order);
}

static void find_box(const struct page *p, struct scene *s)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (size_t t = 0; t < m->n_tri; t++)
    for (int j = 0; j < 9 && p->body[m->tri_patch[t]]; j++) {
      double v = m->point[m->tri[t][j / 3]][j % 3];

      lo[j % 3] = fmin(lo[j % 3], v);
      hi[j % 3] = fmax(hi[j % 3], v);
    }
  for (int k = 0; k < 3; k++) {
    s->centre[k] = (lo[k] + hi[k]) / 2;
    s->half[k] = (hi[k] - lo[k]) / 2;
  }
  s->radius = vg_distance(lo, hi) / 2;
}

static vg_status sort(const struct page *p, struct scene *s,
                      struct vg_error *err)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  const struct vg_decimated *c = &s->coarse;
  size_t *next = vg_calloc(m->n_patch + 1, sizeof *next);

  s->first = vg_calloc(m->n_patch + 1, sizeof *s->first);
  s->order = vg_alloc(c->n_tri, sizeof *s->order);
  if (!next || !s->first || !s->order) {
    free(next);
    return vg_fail_memory(err, "the scene");
  }
  for (size_t t = 0; t < c->n_tri; t++)
    s->first[m->tri_patch[c->from[t]] + 1]++;
  for (size_t i = 0; i < m->n_patch; i++) {
    s->first[i + 1] += s->first[i];
    next[i] = s->first[i];
  }
  for (size_t t = 0; t < c->n_tri; t++)
    s->order[next[m->tri_patch[c->from[t]]]++] = t;
  free(next);
  return VG_OK;
}

/* Little-endian, as on all machines that show such pages. */
static void put32(uint8_t **to, uint32_t v)
{
  for (int k = 0; k < 4; k++) *(*to)++ = (uint8_t)(v >> 8 * k);
}

static void put_float(uint8_t **to, double v)
{
  float f = (float)v;
  uint32_t bits;

  memcpy(&bits, &f, sizeof bits);
  put32(to, bits);
}

/* Pack points relative to the centre, then corners of triangles, each as the
 * difference to the previous one (which compresses well), then one byte per
 * triangle each for number of layers, height and cause. */
static vg_status pack(const struct page *p, const struct scene *s,
                      struct vg_bytes *out, struct vg_error *err)
{
  const struct vg_decimated *c = &s->coarse;
  const uint8_t *by[3] = { p->walls.by[BY_LEVEL], p->walls.by_share,
                           p->walls.by[BY_CAUSE] };
  size_t n = 12 * c->n_point + 15 * c->n_tri;
  uint8_t *data = vg_alloc(n, 1), *to = data;
  uint32_t last = 0;
  vg_status st;

  if (!data) return vg_fail_memory(err, "the scene");
  for (size_t i = 0; i < c->n_point; i++)
    for (int k = 0; k < 3; k++) put_float(&to, c->point[i][k] - s->centre[k]);
  for (size_t i = 0; i < c->n_tri; i++)
    for (int k = 0; k < 3; k++) {
      put32(&to, c->tri[s->order[i]][k] - last);
      last = c->tri[s->order[i]][k];
    }
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < c->n_tri; i++) *to++ = by[k][c->from[s->order[i]]];
  st = vg_deflate(data, n, out, err);
  free(data);
  return st;
}

/* --- data for the script, as JSON ---------------------------------------- */

static json_t *colours(const uint8_t (*rgb)[3], size_t n)
{
  json_t *list = json_array();

  for (size_t i = 0; i < n; i++)
    json_array_append_new(list, json_pack("[i,i,i]", rgb[i][0], rgb[i][1],
                                          rgb[i][2]));
  return list;
}

static json_t *vector(const double x[3], const double *less)
{
  json_t *list = json_array();

  for (int k = 0; k < 3; k++)
    json_array_append_new(list, json_real(x[k] - (less ? less[k] : 0)));
  return list;
}

static json_t *patches(const struct page *p, const struct scene *s)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  json_t *list = json_array();

  for (size_t i = 0; i < m->n_patch; i++) {
    char name[VG_NAME_MAX + 16], clean[VG_NAME_MAX + 16];
    const uint8_t *rgb = p->body[i] ? vg_patch_colour[i % PATCH_COLOURS]
                                    : vg_adjacent_colour;

    snprintf(name, sizeof name, "%d %s", (int)m->patch[i].id, m->patch[i].name);
    /* "</script>" in a name must not end the script element. */
    vg_text_clean(name, clean, sizeof clean);
    for (char *c = clean; *c; c++)
      if (*c == '<') *c = '(';
    json_array_append_new(list,
                          json_pack("{s:s s:b s:I s:I s:[i,i,i]}", "name",
                                    clean, "body", p->body[i], "first",
                                    (json_int_t)s->first[i], "count",
                                    (json_int_t)(s->first[i + 1] - s->first[i]),
                                    "colour", rgb[0], rgb[1], rgb[2]));
  }
  return list;
}

static json_t *cuts(const struct page *p, const struct scene *s)
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

static json_t *worst(const struct page *p, const struct scene *s)
{
  const struct vg_mesh_report *m = p->has_layers ? &p->h->run->field_judge
                                                 : &p->h->run->judge;
  json_t *list = json_array();

  for (size_t i = 0; i < m->n_worst; i++)
    json_array_append_new(list, vector(m->worst[i].at, s->centre));
  return list;
}

static json_t *facts(const struct page *p, const struct scene *s)
{
  json_t *o = json_object(), *names = json_array();

  for (int c = 0; c < VG_CAUSE_N; c++)
    json_array_append_new(names, json_string(vg_layer_cause_name(
                                   (enum vg_layer_cause)c)));
  json_object_set_new(o, "points", json_integer((json_int_t)s->coarse.n_point));
  json_object_set_new(o, "triangles",
                      json_integer((json_int_t)s->coarse.n_tri));
  json_object_set_new(o, "merged", json_boolean(s->coarse.step > 0));
  json_object_set_new(o, "layers", json_boolean(p->has_layers));
  json_object_set_new(o, "levels", json_integer(p->walls.level_most));
  json_object_set_new(o, "radius", json_real(s->radius));
  json_object_set_new(o, "half", vector(s->half, NULL));
  json_object_set_new(o, "toward", vector(p->camera[0].toward, NULL));
  json_object_set_new(o, "patches", patches(p, s));
  json_object_set_new(o, "cuts", cuts(p, s));
  json_object_set_new(o, "worst", worst(p, s));
  json_object_set_new(o, "levelColours",
                      colours(vg_level_colour, LEVEL_COLOURS));
  json_object_set_new(o, "causeColours", colours(vg_cause_colour, VG_CAUSE_N));
  json_object_set_new(o, "causes", names);
  return o;
}

/* --- the page ------------------------------------------------------------ */

static void words(struct page *p, const struct scene *s)
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
  struct scene s = { .first = NULL };
  struct vg_bytes packed = { 0, NULL };
  json_t *o = NULL;
  char *text = NULL;
  vg_status st;

  VG_TRY(vg_decimate(&p->h->problem->boundary.surface, MOST, &s.coarse, err));
  VG_TRY(sort(p, &s, err));
  find_box(p, &s);
  VG_TRY(pack(p, &s, &packed, err));
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
  release(&s);
  return st;
}
