/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Triangles of a patch as the images of others. Declared in
 * core/periodic/copy.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/periodic/copy_parts.h"

#define NONE VG_PERIODIC_NONE

void vg_periodic_copied_release(struct vg_periodic_copied *c)
{
  free(c->origin);
  *c = (struct vg_periodic_copied)VG_PERIODIC_COPIED_INIT;
}

/* --- the border ----------------------------------------------------------- */

struct copy {
  const struct vg_mesh *m;
  const struct vg_periodic *p;
  struct vg_border_strip strip;
  uint32_t *image; /* [m->n_point] number of the image of each point */
  struct vg_periodic_copied *out;
};

/* Inserts the images of a piece without a point of the border, between the
 * points that the border has. */
static vg_status insert(struct copy *c, const struct vg_border_point *q,
                        size_t n, struct vg_error *err)
{
  uint32_t u = q[0].b, v;
  vg_status st = VG_OK;

  for (size_t i = 1; i < n; i++) {
    double x[3];
    size_t k = i;

    if (q[i].b != NONE) {
      u = q[i].b;
      continue;
    }
    while (q[k].b == NONE) k++;
    v = q[k].b;
    vg_periodic_image(c->p, c->m->point[q[i].a], x);
    VG_TRY(vg_strip_insert(&c->strip, u, v, x, err));
    u = c->image[q[i].a] = (uint32_t)c->strip.n_point - 1;
    c->out->n_inserted++;
  }
done:
  return st;
}

/* Removes points of the border of which the piece has no image. A point whose
 * neighbours must go first waits. */
static vg_status take_away(struct copy *c, const struct vg_border_point *q,
                           size_t n, struct vg_error *err)
{
  uint32_t *list = vg_alloc(n, sizeof *list);
  uint8_t *goes = vg_alloc(n, 1);
  size_t left = n, before = 0;
  vg_status st = VG_OK;

  if (!list || !goes) VG_TRY(vg_fail_memory(err, "the periodic patches"));
  for (size_t i = 0; i < n; i++) {
    goes[i] = q[i].a == NONE;
    list[i] = goes[i] ? q[i].b : c->image[q[i].a];
  }
  while (left != before) {
    size_t k = 0;

    before = left;
    for (size_t i = 0; i < left; i++) {
      if (goes[i] &&
          vg_strip_remove(&c->strip, list[k - 1], list[i], list[i + 1])) {
        c->out->n_removed++;
        continue;
      }
      list[k] = list[i];
      goes[k++] = goes[i];
    }
    left = k;
  }
  for (size_t i = 0; i < left && st >= 0; i++)
    if (goes[i])
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "periodic: the triangles at the border of patch %d cannot "
                   "follow those of patch %d at (%.6g, %.6g, %.6g); request "
                   "smaller edges there (surface_size, sources)",
                   (int)c->p->image, (int)c->p->patch, c->m->point[list[i]][0],
                   c->m->point[list[i]][1], c->m->point[list[i]][2]);
done:
  free(list);
  free(goes);
  return st;
}

static vg_status change_border(struct copy *c,
                               const struct vg_border_pieces *pieces,
                               struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < pieces->n; i++) {
    const struct vg_border_point *q = &pieces->point[i];
    double x[3];

    if (q->a == NONE || q->b == NONE || c->image[q->a] != NONE) continue;
    c->image[q->a] = q->b;
    c->out->n_joined++;
    if (q->a == q->b) continue;
    vg_periodic_image(c->p, c->m->point[q->a], x);
    memcpy(c->strip.point[q->b], x, sizeof x);
  }
  for (size_t i = 0, first = 0; i < pieces->n_piece; i++) {
    const struct vg_border_point *q = &pieces->point[first];
    const size_t n = pieces->end[i] - first;

    VG_TRY(insert(c, q, n, err));
    VG_TRY(take_away(c, q, n, err));
    first = pieces->end[i];
  }
done:
  return st;
}

/* --- the new surface ------------------------------------------------------ */

/* Gives the points inside the patch their images. */
static vg_status add_inside(struct copy *c, uint32_t patch,
                            struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t t = 0; t < c->m->n_tri; t++)
    for (int k = 0; k < 3 && c->m->tri_patch[t] == patch; k++) {
      const uint32_t i = c->m->tri[t][k];
      double x[3];

      if (c->image[i] != NONE) continue;
      vg_periodic_image(c->p, c->m->point[i], x);
      VG_TRY(vg_strip_insert(&c->strip, i, i, x, err));
      c->image[i] = (uint32_t)c->strip.n_point - 1;
    }
done:
  return st;
}

struct lists {
  double (*point)[3];
  uint32_t (*tri)[3], *patch, *origin, *number;
  size_t n_point, n_tri;
};

static void add_face(struct lists *l, const uint32_t v[3], uint32_t patch,
                     uint32_t origin)
{
  memcpy(l->tri[l->n_tri], v, sizeof *l->tri);
  l->patch[l->n_tri] = patch;
  l->origin[l->n_tri++] = origin;
}

/* Drops points without triangles. */
static void number(struct lists *l, const struct vg_border_strip *s)
{
  for (size_t i = 0; i < s->n_point; i++) l->number[i] = NONE;
  for (size_t t = 0; t < l->n_tri; t++)
    for (int k = 0; k < 3; k++) l->number[l->tri[t][k]] = 0;
  for (size_t i = 0; i < s->n_point; i++) {
    if (l->number[i] == NONE) continue;
    memcpy(l->point[l->n_point], s->point[i], sizeof *l->point);
    l->number[i] = (uint32_t)l->n_point++;
  }
  for (size_t t = 0; t < l->n_tri; t++)
    for (int k = 0; k < 3; k++) l->tri[t][k] = l->number[l->tri[t][k]];
}

static vg_status compose(struct copy *c, struct vg_mesh *m, uint32_t patch,
                         uint32_t image, struct vg_error *err)
{
  const struct vg_border_strip *s = &c->strip;
  const size_t most = s->n_tri + m->n_tri;
  struct lists l = { .point = vg_alloc(s->n_point, sizeof *l.point),
                     .tri = vg_alloc(most, sizeof *l.tri),
                     .patch = vg_alloc(most, sizeof *l.patch),
                     .origin = vg_alloc(most, sizeof *l.origin),
                     .number = vg_alloc(s->n_point, sizeof *l.number) };

  if (!l.point || !l.tri || !l.patch || !l.origin || !l.number) {
    free(l.point);
    free(l.tri);
    free(l.patch);
    free(l.origin);
    free(l.number);
    return vg_fail_memory(err, "the periodic patches");
  }
  for (size_t t = 0; t < s->n_tri; t++)
    if (!s->tri[t].is_gone)
      add_face(&l, s->tri[t].point, s->tri[t].patch, s->tri[t].origin);
  for (uint32_t t = 0; t < m->n_tri; t++) {
    const uint32_t *v = m->tri[t];

    if (m->tri_patch[t] == patch)
      add_face(&l,
               (uint32_t[3]){ c->image[v[0]], c->image[v[2]], c->image[v[1]] },
               image, t);
  }
  number(&l, s);
  free(l.number);
  free(m->point);
  free(m->tri);
  free(m->tri_patch);
  m->point = l.point;
  m->tri = l.tri;
  m->tri_patch = l.patch;
  m->n_point = l.n_point;
  m->n_tri = l.n_tri;
  c->out->origin = l.origin;
  return VG_OK;
}

vg_status vg_periodic_copy(struct vg_mesh *m, const struct vg_periodic *p,
                           double tolerance, struct vg_periodic_copied *out,
                           struct vg_error *err)
{
  const uint32_t patch = (uint32_t)vg_mesh_find_patch(m, p->patch);
  const uint32_t image = (uint32_t)vg_mesh_find_patch(m, p->image);
  struct copy c = { .m = m, .p = p, .out = out };
  struct vg_border_pieces pieces = { 0 };
  struct vg_borders b = { .m = m };
  vg_status st;

  vg_periodic_copied_release(out);
  VG_TRY(vg_borders_find(m, p, &b, err));
  VG_TRY(vg_borders_pair(&b, tolerance, 1, err));
  VG_TRY(vg_borders_divide(&b, &pieces, err));
  c.image = vg_alloc(m->n_point, sizeof *c.image);
  if (!c.image) VG_TRY(vg_fail_memory(err, "the periodic patches"));
  memset(c.image, 0xff, m->n_point * sizeof *c.image);
  VG_TRY(vg_strip_start(&c.strip, m, image, err));
  VG_TRY(change_border(&c, &pieces, err));
  VG_TRY(add_inside(&c, patch, err));
  VG_TRY(compose(&c, m, patch, image, err));
done:
  free(pieces.point);
  free(pieces.end);
  free(c.image);
  vg_strip_release(&c.strip);
  vg_borders_release(&b);
  return st;
}

/* --- the transform from corners ------------------------------------------- */

vg_status vg_periodic_find_corners(const struct vg_mesh *m,
                                   struct vg_periodic *p, int *is_found,
                                   struct vg_error *err)
{
  struct vg_borders b = { .m = m };
  struct vg_periodic_match match = VG_PERIODIC_MATCH_INIT;
  vg_status st;

  *is_found = vg_periodic_find(m, p);
  if (!*is_found) return VG_OK;
  VG_TRY(vg_borders_find(m, p, &b, err));
  VG_TRY(
    vg_borders_pair(&b, VG_PERIODIC_ROUGH * vg_periodic_extent(m, p), 0, err));
  match.point = b.to;
  for (size_t i = 0; i < m->n_point; i++) match.n_point[0] += b.to[i] != NONE;
  VG_TRY(vg_periodic_refine(m, p, &match, err));
  vg_periodic_refine_turn(m, p, &match);
done:
  vg_borders_release(&b);
  return st;
}
