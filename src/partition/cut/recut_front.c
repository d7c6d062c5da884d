/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The front of a void from the cells that were made in it: the faces that only
 * one cell has. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "core/delaunay/tets.h"
#include "partition/cut/node.h"

/* A face by its corners, ascending; sense: 1 or -1, the parity of the sort. */
struct side {
  uint32_t v[3];
  int32_t sense;
};

static struct side side_of(const uint32_t v[3])
{
  struct side s = { { v[0], v[1], v[2] }, 1 };

  if (vg_order3(s.v)) s.sense = -1;
  return s;
}

static int by_corners(const void *a, const void *b)
{
  const struct side *s = a, *t = b;

  for (int k = 0; k < 3; k++)
    if (s->v[k] != t->v[k]) return s->v[k] < t->v[k] ? -1 : 1;
  return 0;
}

static void put_face(struct vg_front *f, size_t at, const struct side *s,
                     int sense)
{
  f->face[at][0] = s->v[0];
  f->face[at][1] = s->v[sense > 0 ? 1 : 2];
  f->face[at][2] = s->v[sense > 0 ? 2 : 1];
}

/* Is this face of the front in an inner surface? */
static int is_inner(const struct vg_doubled *d, const struct vg_front *f,
                    const struct side *s)
{
  uint32_t v[3];

  if (!d->first) return 0;
  for (int k = 0; k < 3; k++) {
    const uint64_t id = f->id[s->v[k]];

    if (id >> 32) return 0;
    v[k] = (uint32_t)id;
  }
  return vg_doubled_has(d, v);
}

/* Removes faces that occur in both orientations, which are between two cells,
 * unless they are the sides of an inner surface; the others stay, ascending.
 * VG_ERR_GEOMETRY if one occurs twice in the same orientation. */
static vg_status cancel(const struct vg_doubled *d, struct vg_front *f,
                        struct vg_error *err)
{
  struct side *s = vg_alloc(f->n_face, sizeof *s);
  size_t left = 0;
  vg_status st = s ? VG_OK : vg_fail_memory(err, "a front");

  for (size_t k = 0; s && k < f->n_face; k++) s[k] = side_of(f->face[k]);
  if (s && f->n_face) qsort(s, f->n_face, sizeof *s, by_corners);
  for (size_t k = 0, end; st == VG_OK && k < f->n_face; k = end) {
    int sum = 0;

    for (end = k; end < f->n_face && !by_corners(&s[k], &s[end]); end++)
      sum += s[end].sense;
    if (!sum && !is_inner(d, f, &s[k])) continue;
    if (abs(sum) > 1 || (!sum && end - k > 2))
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "the front of a void that was cut contains a "
                   "face twice");
    put_face(f, left++, &s[k], sum ? sum : 1);
    if (!sum) put_face(f, left++, &s[k], -1);
  }
  if (st == VG_OK) f->n_face = left;
  free(s);
  return st;
}

struct spot {
  double x[3];
  uint64_t id;
  uint32_t was;
};

/* Sorts by coordinates, because ids depend on timing. No two points coincide,
 * except for boundary points, whose ids do not depend on timing. */
static int by_place(const void *a, const void *b)
{
  const struct spot *s = a, *t = b;

  for (int k = 0; k < 3; k++)
    if (s->x[k] != t->x[k]) return s->x[k] < t->x[k] ? -1 : 1;
  return s->id < t->id ? -1 : s->id > t->id;
}

/* Keeps only points that faces use, sorted by coordinates. to: [f->n_point]
 * scratch. */
static void place_points(struct vg_front *f, struct spot *s, uint32_t *to)
{
  size_t n = 0;

  memset(to, 0xff, f->n_point * sizeof *to);
  for (size_t k = 0; k < f->n_face; k++)
    for (int i = 0; i < 3; i++) {
      uint32_t v = f->face[k][i];

      if (to[v] != UINT32_MAX) continue;
      to[v] = 0;
      s[n] = (struct spot){ .id = f->id[v], .was = v };
      memcpy(s[n++].x, f->x[v], sizeof s->x);
    }
  if (n) qsort(s, n, sizeof *s, by_place);
  for (size_t k = 0; k < n; k++) {
    to[s[k].was] = (uint32_t)k;
    memcpy(f->x[k], s[k].x, sizeof *f->x);
    f->id[k] = s[k].id;
  }
  f->n_point = n;
  for (size_t k = 0; k < f->n_face; k++)
    for (int i = 0; i < 3; i++) f->face[k][i] = to[f->face[k][i]];
}

vg_status vg_recut_settle(const struct vg_doubled *d, struct vg_front *f,
                          struct vg_error *err)
{
  struct spot *s = vg_alloc(f->n_point, sizeof *s);
  uint32_t *to = vg_alloc(f->n_point, sizeof *to);
  vg_status st = s && to ? cancel(d, f, err) : vg_fail_memory(err, "a front");

  assert(f->id || !f->n_point);
  if (st == VG_OK) place_points(f, s, to);
  free(s);
  free(to);
  /* faces in the order of their new corners */
  return st == VG_OK ? cancel(d, f, err) : st;
}

vg_status vg_recut_front(const struct vg_doubled *d, const struct vg_piece *q,
                         struct vg_front *f, struct vg_error *err)
{
  assert(!f->n_point && !f->n_face && !f->x && !f->id && !f->face);
  f->n_point = q->n_in + q->n_point;
  f->n_face = 4 * q->n_cell;
  f->x = vg_alloc(f->n_point, sizeof *f->x);
  f->id = vg_alloc(f->n_point, sizeof *f->id);
  f->face = vg_alloc(f->n_face, sizeof *f->face);
  if (!f->x || !f->id || !f->face) return vg_fail_memory(err, "a front");
  memcpy(f->x, q->x, f->n_point * sizeof *f->x);
  for (size_t k = 0; k < f->n_point; k++)
    f->id[k] = k < q->n_in ? q->in[k] : VG_POINT_ID(q->serial, k - q->n_in);
  for (size_t k = 0; k < f->n_face; k++) {
    uint32_t v[4];

    vg_piece_cell(q, k / 4, v);
    for (int i = 0; i < 3; i++) f->face[k][i] = v[vg_face[k % 4][i]];
  }
  return vg_recut_settle(d, f, err);
}
