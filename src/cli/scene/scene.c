/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "run/common/text.h"
#include "run/picture/image.h"

#define MOST 120000 /* triangles (V1) */

const uint8_t vg_patch_colour[VG_PATCH_COLOURS][3] = {
  { 108, 162, 214 }, { 240, 166, 92 },  { 116, 184, 118 }, { 216, 112, 112 },
  { 164, 140, 206 }, { 186, 148, 122 }, { 228, 144, 194 }, { 186, 186, 84 },
  { 92, 190, 198 },  { 246, 204, 112 }, { 142, 170, 156 }, { 150, 160, 226 }
};

const uint8_t vg_adjacent_colour[3] = { 231, 231, 239 };

void vg_scene_release(struct vg_scene *s)
{
  vg_decimated_release(&s->coarse);
  free(s->first);
  free(s->order);
  s->first = s->order = NULL;
}

static int any_body(const struct vg_mesh *m, const uint8_t *body)
{
  for (size_t t = 0; t < m->n_tri; t++)
    if (body[m->tri_patch[t]]) return 1;
  return 0;
}

static void find_box(const struct vg_mesh *m, const uint8_t *body,
                     struct vg_scene *s)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };
  int all = !any_body(m, body);

  for (size_t t = 0; t < m->n_tri; t++)
    for (int j = 0; j < 9 && (all || body[m->tri_patch[t]]); j++) {
      double v = m->point[m->tri[t][j / 3]][j % 3];

      if (!isfinite(v)) continue;
      lo[j % 3] = fmin(lo[j % 3], v);
      hi[j % 3] = fmax(hi[j % 3], v);
    }
  for (int k = 0; k < 3; k++) {
    if (!(lo[k] <= hi[k])) lo[k] = hi[k] = 0;
    s->centre[k] = (lo[k] + hi[k]) / 2;
    s->half[k] = (hi[k] - lo[k]) / 2;
  }
  s->radius = vg_distance(lo, hi) / 2;
}

static vg_status sort(const struct vg_mesh *m, struct vg_scene *s,
                      struct vg_error *err)
{
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

vg_status vg_scene_make(const struct vg_mesh *m, const uint8_t *body,
                        struct vg_scene *out, struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_decimate(m, MOST, &out->coarse, err));
  VG_TRY(sort(m, out, err));
  find_box(m, body, out);
done:
  return st;
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

vg_status vg_scene_pack(const struct vg_scene *s, size_t n_by,
                        const uint8_t *const *by, struct vg_bytes *out,
                        struct vg_error *err)
{
  const struct vg_decimated *c = &s->coarse;
  size_t n = 12 * c->n_point + (12 + n_by) * c->n_tri;
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
  for (size_t k = 0; k < n_by; k++)
    for (size_t i = 0; i < c->n_tri; i++) *to++ = by[k][c->from[s->order[i]]];
  st = vg_deflate(data, n, out, err);
  free(data);
  return st;
}

/* --- JSON ---------------------------------------------------------------- */

static json_t *vector(const double x[3])
{
  json_t *list = json_array();

  for (int k = 0; k < 3; k++) json_array_append_new(list, json_real(x[k]));
  return list;
}

static json_t *patch_json(const struct vg_scene *s, const struct vg_mesh *m,
                          const uint8_t *body, size_t i)
{
  char name[VG_NAME_MAX + 16], clean[VG_NAME_MAX + 16];
  const uint8_t *rgb = body[i] ? vg_patch_colour[i % VG_PATCH_COLOURS]
                               : vg_adjacent_colour;

  snprintf(name, sizeof name, "%d %s", (int)m->patch[i].id, m->patch[i].name);
  /* "</script>" in a name must not end a script element. */
  vg_text_clean(name, clean, sizeof clean);
  for (char *c = clean; *c; c++)
    if (*c == '<') *c = '(';
  return json_pack("{s:s s:b s:I s:I s:[i,i,i]}", "name", clean, "body",
                   body[i], "first", (json_int_t)s->first[i], "count",
                   (json_int_t)(s->first[i + 1] - s->first[i]), "colour",
                   rgb[0], rgb[1], rgb[2]);
}

json_t *vg_scene_json(const struct vg_scene *s, const struct vg_mesh *m,
                      const uint8_t *body, const double toward[3])
{
  json_t *o = json_object(), *list = json_array();

  for (size_t i = 0; i < m->n_patch; i++)
    json_array_append_new(list, patch_json(s, m, body, i));
  json_object_set_new(o, "points", json_integer((json_int_t)s->coarse.n_point));
  json_object_set_new(o, "triangles",
                      json_integer((json_int_t)s->coarse.n_tri));
  json_object_set_new(o, "merged", json_boolean(s->coarse.step > 0));
  json_object_set_new(o, "radius", json_real(s->radius));
  json_object_set_new(o, "half", vector(s->half));
  json_object_set_new(o, "centre", vector(s->centre));
  json_object_set_new(o, "toward", vector(toward));
  json_object_set_new(o, "patches", list);
  return o;
}
