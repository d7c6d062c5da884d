/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Colours of surface triangles by patch, number of layers and cause, for
 * pictures. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/html/page.h"

/* Index of each wall point in the fields of the layers. */
static const uint32_t *index_points(const struct vg_wall_fields *f, size_t n,
                                    uint32_t *index)
{
  memset(index, 255, n * sizeof *index);
  for (size_t i = 0; i < f->n; i++) index[f->point[i]] = (uint32_t)i;
  return index;
}

static int step_of(double v, double most)
{
  int k = most > 0 ? (int)(LEVEL_COLOURS * v / most) : 0;

  return k < 0 ? 0 : k >= LEVEL_COLOURS ? LEVEL_COLOURS - 1 : k;
}

/* A triangle gets the worst values of its three corners: the fewest levels, the
 * least height, and the cause of the corner with the most missing levels. */
static void colour_layers(const struct vg_wall_fields *f, const uint32_t *at,
                          size_t t, struct walls *w)
{
  int level = f->level[at[0]], lacks = -1, cause = 0, compressed = 0;
  double share = 1;

  for (int k = 0; k < 3; k++) {
    int lack = f->wanted[at[k]] - f->level[at[k]];

    if (f->level[at[k]] < level) level = f->level[at[k]];
    share = fmin(share, f->share[at[k]]);
    if (lack > lacks || (lack == lacks && f->cause[at[k]] > cause)) {
      lacks = lack;
      cause = f->cause[at[k]];
    }
    if (f->compressed[at[k]] > VG_CAUSE_SIZE) compressed = f->compressed[at[k]];
  }
  w->by[BY_LEVEL][t] = (uint8_t)step_of(level, w->level_most + 1);
  w->by_share[t] = (uint8_t)step_of(share, 1);
  if (cause > VG_CAUSE_SIZE) {
    w->by[BY_CAUSE][t] = (uint8_t)cause;
    w->cause[0][cause]++;
  } else if (compressed) {
    w->by[BY_CAUSE][t] = (uint8_t)(VG_CAUSE_N + compressed);
    w->cause[1][compressed]++;
  } else {
    w->by[BY_CAUSE][t] = 0;
  }
}

static void by_layers(const struct page *p, const uint32_t *index,
                      struct walls *w)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  const struct vg_wall_fields *f = &p->h->layers->fields;

  for (size_t i = 0; i < f->n; i++)
    if (f->level[i] > w->level_most) w->level_most = f->level[i];
  for (size_t t = 0; t < m->n_tri; t++) {
    uint32_t at[3];

    for (int k = 0; k < 3; k++) at[k] = index[m->tri[t][k]];
    if (!p->body[m->tri_patch[t]] || at[0] == VG_NO_INDEX ||
        at[1] == VG_NO_INDEX || at[2] == VG_NO_INDEX)
      continue;
    colour_layers(f, at, t, w);
  }
}

/* Mark the patches in the background of the body: symmetry planes and slide
 * patches. */
static void mark_adjacent(const struct page *p, uint8_t *adjacent)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  const struct vg_columns *c = &p->h->layers->layers.columns;

  for (size_t i = 0; i < m->n_patch; i++)
    adjacent[i] = p->body[i] || m->patch[i].bc == 1;
  for (size_t i = 0; p->has_layers && i < c->n_border; i++)
    adjacent[c->border_patch[i]] = 1;
}

vg_status vg_walls_colour(const struct page *p, struct walls *w,
                          struct vg_error *err)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  uint8_t **list[] = { &w->by[BY_PATCH], &w->by[BY_LEVEL], &w->by[BY_CAUSE],
                       &w->by_share, &w->is_seen };
  uint32_t *index = vg_alloc(m->n_point, sizeof *index);
  uint8_t *adjacent = vg_alloc(m->n_patch, 1);
  vg_status st = index && adjacent ? VG_OK
                                   : vg_fail_memory(err, "the pictures");

  memset(w, 0, sizeof *w);
  for (size_t i = 0; i < sizeof list / sizeof *list && st >= 0; i++) {
    *list[i] = vg_alloc(m->n_tri, 1);
    if (!*list[i]) st = vg_fail_memory(err, "the pictures");
    else memset(*list[i], GREY, m->n_tri);
  }
  if (st >= 0) {
    mark_adjacent(p, adjacent);
    for (size_t t = 0; t < m->n_tri; t++) {
      uint32_t patch = m->tri_patch[t];

      w->is_seen[t] = adjacent[patch];
      if (p->body[patch])
        w->by[BY_PATCH][t] = (uint8_t)(patch % VG_PATCH_COLOURS);
    }
    if (p->has_layers)
      by_layers(p, index_points(&p->h->layers->fields, m->n_point, index), w);
  } else {
    vg_walls_release(w);
  }
  free(index);
  free(adjacent);
  return st;
}

void vg_walls_release(struct walls *w)
{
  for (int k = 0; k < BY_N; k++) free(w->by[k]);
  free(w->by_share);
  free(w->is_seen);
  memset(w, 0, sizeof *w);
}
