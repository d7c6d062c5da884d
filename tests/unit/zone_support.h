/* A zone taken out of a void, as a task does it for the front of a whole
 * domain. Header only: one program per module. */
#ifndef TESTS_UNIT_ZONE_SUPPORT_H
#define TESTS_UNIT_ZONE_SUPPORT_H

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/fill/grow.h"

/* The part of a void's front that a region needs. */
struct zone_part {
  size_t n_point, n_face;
  double (*x)[3];
  uint32_t *point;           /* [n_point] their numbers in the void */
  uint32_t (*face)[3];
  uint32_t *from;            /* [n_face] likewise */
};

static inline void zone_part_release(struct zone_part *p)
{
  free(p->x);
  free(p->point);
  free(p->face);
  free(p->from);
  memset(p, 0, sizeof *p);
}

static inline void zone_need(const void *p)
{
  if (!p) abort();
}

static inline uint32_t zone_point(struct zone_part *p, const struct vg_void *v,
                                  uint32_t *local, uint32_t at)
{
  if (local[at] == UINT32_MAX) {
    memcpy(p->x[p->n_point], v->x[at], sizeof *p->x);
    p->point[p->n_point] = at;
    local[at] = (uint32_t)p->n_point++;
  }
  return local[at];
}

/* The faces near the region: those, and no other. */
static inline void zone_select(const struct vg_void *v,
                               const struct vg_sizing *sizing,
                               const struct vg_region *r, struct zone_part *p)
{
  uint32_t *local = vg_alloc(v->n_point, sizeof *local);

  memset(p, 0, sizeof *p);
  p->x = vg_alloc(v->n_point, sizeof *p->x);
  p->point = vg_alloc(v->n_point, sizeof *p->point);
  p->face = vg_alloc(v->n_face, sizeof *p->face);
  p->from = vg_alloc(v->n_face, sizeof *p->from);
  zone_need(local);
  zone_need(p->x);
  zone_need(p->point);
  zone_need(p->face);
  zone_need(p->from);
  memset(local, 0xff, v->n_point * sizeof *local);
  for (size_t i = 0; i < v->n_face; i++) {
    const uint32_t *f = v->face[i];

    if (!vg_region_meets(r, sizing, v->x[f[0]], v->x[f[1]], v->x[f[2]],
                         VG_BAND_FRONT))
      continue;
    for (int k = 0; k < 3; k++)
      p->face[p->n_face][k] = zone_point(p, v, local, f[k]);
    p->from[p->n_face++] = (uint32_t)i;
  }
  free(local);
}

static inline vg_status zone_make(const struct zone_part *p,
                                  const struct vg_region *r,
                                  const struct vg_sizing *sizing,
                                  const struct vg_grow_options *options,
                                  struct vg_zone *z,
                                  struct vg_fill_report *report,
                                  struct vg_error *err)
{
  return vg_zone_grow(p->n_point, (const double (*)[3])p->x, p->n_face,
                      (const uint32_t (*)[3])p->face, r, sizing, options, z,
                      report, err);
}

/* Append what was made, and flag the faces that have a cell now: they are
 * removed by zone_compact once all zones of a stage are in. */
static inline void zone_add(struct vg_void *v, const struct zone_part *p,
                            const struct vg_zone *z, uint8_t *is_gone)
{
  size_t base = v->n_point;

  if (vg_reserve(&v->x, &v->cap_point, base + z->n_point, sizeof *v->x) ||
      vg_reserve(&v->cell, &v->cap_cell, v->n_cell + z->n_cell,
                 sizeof *v->cell) ||
      vg_reserve(&v->face, &v->cap_face, v->n_face + z->n_face,
                 sizeof *v->face))
    abort();
  if (z->n_point) memcpy(v->x + base, z->x, z->n_point * sizeof *v->x);
  v->n_point += z->n_point;
  for (size_t c = 0; c < z->n_cell; c++, v->n_cell++)
    for (int k = 0; k < 4; k++) {
      size_t q = z->cell[c][k];

      v->cell[v->n_cell][k] =
          q < p->n_point ? p->point[q] : (uint32_t)(base + q - p->n_point);
    }
  for (size_t i = 0; i < z->n_face; i++, v->n_face++)
    for (int k = 0; k < 3; k++) {
      size_t q = z->face[i][k];

      v->face[v->n_face][k] =
          q < p->n_point ? p->point[q] : (uint32_t)(base + q - p->n_point);
    }
  for (size_t i = 0; i < p->n_face; i++)
    if (z->gone[i]) is_gone[p->from[i]] = 1;
}

/* Remove the faces flagged among the first n. */
static inline void zone_compact(struct vg_void *v, const uint8_t *is_gone,
                                size_t n)
{
  size_t kept = 0;

  for (size_t i = 0; i < v->n_face; i++)
    if (i >= n || !is_gone[i])
      memmove(v->face[kept++], v->face[i], sizeof *v->face);
  v->n_face = kept;
}

/* Grow a region out of v; v is unchanged unless VG_OK is returned. */
static inline vg_status zone_take(struct vg_void *v,
                                  const struct vg_sizing *sizing,
                                  const struct vg_region *r,
                                  const struct vg_grow_options *options,
                                  struct vg_fill_report *report,
                                  struct vg_error *err)
{
  struct vg_zone z = VG_ZONE_INIT;
  struct zone_part p;
  uint8_t *is_gone = vg_calloc(v->n_face, 1);
  size_t n = v->n_face;
  vg_status st;

  zone_need(is_gone);
  zone_select(v, sizing, r, &p);
  st = zone_make(&p, r, sizing, options, &z, report, err);
  if (st == VG_OK) {
    zone_add(v, &p, &z, is_gone);
    zone_compact(v, is_gone, n);
  }
  vg_zone_release(&z);
  zone_part_release(&p);
  free(is_gone);
  return st;
}

#endif
