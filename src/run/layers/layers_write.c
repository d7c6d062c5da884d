/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writes the walls with properties of their layers, for visualisation. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/vtu.h"
#include "run/layers/layers.h"

/* Triangles of the walls. */
struct wall_tris {
  size_t n;
  uint32_t (*tri)[3]; /* Indices into the points of the fields. */
  int32_t *patch;
  double *top; /* Volume ratio across the top; 0: none. */
};

static vg_status write_walls(const struct vg_layer_stage *s,
                             const struct vg_mesh *surface,
                             const struct wall_tris *t, const char *path,
                             struct vg_error *err)
{
  const struct vg_wall_fields *w = &s->fields;
  const struct vg_vtu_field field[] = {
    { "level", VG_VTU_POINT, VG_VTU_INT32, 1, w->level },
    { "level_requested", VG_VTU_POINT, VG_VTU_INT32, 1, w->wanted },
    { "first_height", VG_VTU_POINT, VG_VTU_FLOAT64, 1, w->first },
    { "first_requested", VG_VTU_POINT, VG_VTU_FLOAT64, 1, w->asked },
    { "total", VG_VTU_POINT, VG_VTU_FLOAT64, 1, w->total },
    { "height_over_growth_law", VG_VTU_POINT, VG_VTU_FLOAT64, 1, w->share },
    { "growth", VG_VTU_POINT, VG_VTU_FLOAT64, 1, w->growth },
    { "cause", VG_VTU_POINT, VG_VTU_INT32, 1, w->cause },
    { "compressed", VG_VTU_POINT, VG_VTU_INT32, 1, w->compressed },
    { "patch", VG_VTU_CELL, VG_VTU_INT32, 1, t->patch },
    { "top_volume_ratio", VG_VTU_CELL, VG_VTU_FLOAT64, 1, t->top },
  };
  double(*point)[3] = vg_alloc(w->n, sizeof *point);
  vg_status st;

  if (!point) return vg_fail_memory(err, "the walls");
  for (size_t i = 0; i < w->n; i++)
    memcpy(point[i], surface->point[w->point[i]], sizeof *point);
  st = vg_vtu_write_triangles(path, w->n, (const double(*)[3])point, t->n,
                              (const uint32_t(*)[3])t->tri, field,
                              sizeof field / sizeof *field, err);
  free(point);
  return st;
}

static void list_walls(const struct vg_layer_stage *s,
                       const struct vg_mesh *surface, const uint32_t *index,
                       uint32_t *place, struct wall_tris *t)
{
  const struct vg_columns *c = &s->layers.columns;

  for (size_t i = 0; i < surface->n_tri; i++) {
    const uint32_t of = surface->tri_patch[i];

    if (s->reason[of] == VG_WALL_NOT) continue;
    place[i] = (uint32_t)t->n;
    for (int k = 0; k < 3; k++) t->tri[t->n][k] = index[surface->tri[i][k]];
    t->patch[t->n++] = surface->patch[of].id;
  }
  for (size_t i = 0; i < c->n_face; i++)
    if (c->face_tri[i] != VG_NO_INDEX)
      t->top[place[c->face_tri[i]]] = s->top[i];
}

vg_status vg_layer_stage_write(const struct vg_layer_stage *s,
                               const struct vg_mesh *surface, const char *path,
                               struct vg_error *err)
{
  uint32_t *index = vg_alloc(surface->n_point, sizeof *index);
  uint32_t *place = vg_alloc(surface->n_tri, sizeof *place);
  struct wall_tris t = { .tri = vg_alloc(surface->n_tri, sizeof *t.tri),
                         .patch = vg_alloc(surface->n_tri, sizeof *t.patch),
                         .top = vg_calloc(surface->n_tri, sizeof *t.top) };
  vg_status st;

  if (!index || !place || !t.tri || !t.patch || !t.top) {
    st = vg_fail_memory(err, "the walls");
    goto done;
  }
  for (size_t i = 0; i < s->fields.n; i++)
    index[s->fields.point[i]] = (uint32_t)i;
  list_walls(s, surface, index, place, &t);
  st = write_walls(s, surface, &t, path, err);
done:
  free(index);
  free(place);
  free(t.tri);
  free(t.patch);
  free(t.top);
  return st;
}
