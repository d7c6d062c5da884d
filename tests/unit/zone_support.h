/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A domain that is filled piece by piece, as in the advancing partition: the
 * kernel fills regions of its void, one after the other, and finally the whole
 * remaining void. Header only: one program per module. */
#ifndef TESTS_UNIT_ZONE_SUPPORT_H
#define TESTS_UNIT_ZONE_SUPPORT_H

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/fill/fill.h"

struct scene {
  struct vg_mesh m; /* The surface of the domain. */
  struct vg_sizing *sizing;
  struct vg_front front; /* The front of the remaining void, with all points:
                            those of m, then new ones. */
  size_t cap_point, cap_face;
  size_t n_cell, cap_cell;
  uint32_t (*cell)[4]; /* [n_cell] The cells made so far. */
  struct vg_fill_report report;
  double volume; /* The volume of the domain. */
};

/* The part of a scene's front that a region needs. */
struct zone_part {
  struct vg_front front;
  uint32_t *point; /* [front.n_point] Points of the scene's front. */
  uint32_t *from;  /* [front.n_face] Faces of the scene's front. */
};

static inline void zone_part_release(struct zone_part *p)
{
  vg_front_release(&p->front);
  free(p->point);
  free(p->from);
  memset(p, 0, sizeof *p);
}

static inline void zone_need(const void *p)
{
  if (!p) abort();
}

static inline uint32_t zone_point(struct zone_part *p, const struct scene *s,
                                  uint32_t *local, uint32_t at)
{
  if (local[at] == UINT32_MAX) {
    memcpy(p->front.x[p->front.n_point], s->front.x[at], sizeof *p->front.x);
    p->point[p->front.n_point] = at;
    local[at] = (uint32_t)p->front.n_point++;
  }
  return local[at];
}

/* Exactly the faces near the region; all faces if there is no region. Points
 * that no face uses are left out: the kernel refuses them. */
static inline void zone_select(const struct scene *s, const struct vg_region *r,
                               struct zone_part *p)
{
  const struct vg_front *f = &s->front;
  uint32_t *local = vg_alloc(f->n_point, sizeof *local);

  memset(p, 0, sizeof *p);
  p->front.x = vg_alloc(f->n_point, sizeof *p->front.x);
  p->front.face = vg_alloc(f->n_face, sizeof *p->front.face);
  p->point = vg_alloc(f->n_point, sizeof *p->point);
  p->from = vg_alloc(f->n_face, sizeof *p->from);
  zone_need(local);
  zone_need(p->front.x);
  zone_need(p->front.face);
  zone_need(p->point);
  zone_need(p->from);
  memset(local, 0xff, f->n_point * sizeof *local);
  for (size_t i = 0; i < f->n_face; i++) {
    const uint32_t *v = f->face[i];

    if (r && !vg_region_meets(r, s->sizing, f->x[v[0]], f->x[v[1]], f->x[v[2]],
                              VG_BAND_FRONT))
      continue;
    for (int k = 0; k < 3; k++)
      p->front.face[p->front.n_face][k] = zone_point(p, s, local, v[k]);
    p->from[p->front.n_face++] = (uint32_t)i;
  }
  free(local);
}

static inline vg_status zone_make(struct scene *s, const struct zone_part *p,
                                  const struct vg_region *r,
                                  const struct vg_fill_options *options,
                                  struct vg_filled *made, struct vg_error *err)
{
  return vg_fill_front(&p->front, r, s->sizing, options, made, &s->report, err);
}

/* Indices in the scene of n corners, whose new points begin at `base`. */
static inline void zone_number(const struct zone_part *p, size_t base, size_t n,
                               const uint32_t *from, uint32_t *to)
{
  for (size_t i = 0; i < n; i++)
    to[i] = from[i] < p->front.n_point
            ? p->point[from[i]]
            : (uint32_t)(base + from[i] - p->front.n_point);
}

/* Append the result, and flag the consumed faces: zone_compact removes them
 * after all zones of a stage have been added. */
static inline void zone_add(struct scene *s, const struct zone_part *p,
                            const struct vg_filled *made, uint8_t *is_gone)
{
  struct vg_front *f = &s->front;
  size_t base = f->n_point;

  if (vg_reserve(&f->x, &s->cap_point, base + made->n_point, sizeof *f->x) ||
      vg_reserve(&f->face, &s->cap_face, f->n_face + made->n_face,
                 sizeof *f->face) ||
      vg_reserve(&s->cell, &s->cap_cell, s->n_cell + made->n_cell,
                 sizeof *s->cell))
    abort();
  if (made->n_point) memcpy(f->x + base, made->x, made->n_point * sizeof *f->x);
  if (made->n_face)
    zone_number(p, base, 3 * made->n_face, made->face[0], f->face[f->n_face]);
  if (made->n_cell)
    zone_number(p, base, 4 * made->n_cell, made->cell[0], s->cell[s->n_cell]);
  for (size_t i = 0; i < made->n_consumed; i++)
    is_gone[p->from[made->consumed[i]]] = 1;
  f->n_point += made->n_point;
  f->n_face += made->n_face;
  s->n_cell += made->n_cell;
}

/* Remove the faces flagged among the first n. */
static inline void zone_compact(struct vg_front *f, const uint8_t *is_gone,
                                size_t n)
{
  size_t kept = 0;

  for (size_t i = 0; i < f->n_face; i++)
    if (i >= n || !is_gone[i])
      memmove(f->face[kept++], f->face[i], sizeof *f->face);
  f->n_face = kept;
}

/* Fill a region, or the whole remaining void if r is NULL. The scene is
 * unchanged unless VG_OK is returned. */
static inline vg_status zone_take(struct scene *s, const struct vg_region *r,
                                  const struct vg_fill_options *options,
                                  struct vg_error *err)
{
  struct vg_filled made = VG_FILLED_INIT;
  size_t n = s->front.n_face;
  uint8_t *is_gone = vg_calloc(n, 1);
  struct zone_part p;
  vg_status st;

  zone_need(is_gone);
  zone_select(s, r, &p);
  st = zone_make(s, &p, r, options, &made, err);
  if (st == VG_OK) {
    if (!r) memset(is_gone, 1, n);
    zone_add(s, &p, &made, is_gone);
    zone_compact(&s->front, is_gone, n);
  }
  vg_filled_release(&made);
  zone_part_release(&p);
  free(is_gone);
  return st;
}

#endif
