/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds the parts to be remeshed: plane patches with columns as a whole, but of
 * curved patches only the area that columns reach and a few edges more. New
 * points lie on the facets of the given surface, so the rest should remain
 * unchanged. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "layers/slide/slide_parts.h"

/* A curved patch is remeshed up to this many edges beyond the tops. */
#define BEYOND 4 /* L15 */
/* part_of[] of triangles within reach, before they are divided into parts. */
#define MARKED (VG_NO_INDEX - 1)

/* Sorts items by class: n_class + 1 offsets and the items of each class, in
 * order. VG_NO_INDEX belongs to no class. */
static vg_status bucket(size_t n, const uint32_t *class_of, size_t n_class,
                        uint32_t **first, uint32_t **item, struct vg_error *err)
{
  size_t total = 0;

  *first = vg_calloc(n_class + 2, sizeof **first);
  for (size_t i = 0; *first && i < n; i++)
    if (class_of[i] != VG_NO_INDEX) {
      (*first)[class_of[i] + 2]++;
      total++;
    }
  *item = vg_alloc(total, sizeof **item);
  if (!*first || !*item) return vg_fail_memory(err, "slide patches");
  for (size_t i = 0; i < n_class; i++) (*first)[i + 2] += (*first)[i + 1];
  for (size_t i = 0; i < n; i++)
    if (class_of[i] != VG_NO_INDEX)
      (*item)[(*first)[class_of[i] + 1]++] = (uint32_t)i;
  return VG_OK;
}

static vg_status sort_half_edges(struct vg_slide_work *w)
{
  const struct vg_mesh *m = w->m;
  uint32_t *class_of = vg_alloc(3 * m->n_tri, sizeof *class_of);
  vg_status st;

  if (!class_of) return vg_fail_memory(w->err, "slide patches");
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    class_of[i] = w->slide_of[m->tri_patch[i / 3]] == VG_NO_INDEX
                  ? VG_NO_INDEX
                  : m->tri[i / 3][i % 3];
  st = bucket(3 * m->n_tri, class_of, m->n_point, &w->first, &w->half, w->err);
  free(class_of);
  return st;
}

static vg_status add_part(struct vg_slide_work *w, const struct vg_slide *s)
{
  if (vg_reserve(&w->part, &w->cap_part, w->n_part + 1, sizeof *w->part))
    return vg_fail_memory(w->err, "slide patches");
  w->part[w->n_part++] = *s;
  return VG_OK;
}

/* Plane patches with at least one column with levels. */
static vg_status plane_parts(struct vg_slide_work *w)
{
  const struct vg_columns *c = w->c;
  uint32_t *part = vg_alloc(w->n_slide, sizeof *part);
  vg_status st = VG_OK;

  if (!part) return vg_fail_memory(w->err, "slide patches");
  for (size_t s = 0; s < w->n_slide; s++) part[s] = VG_NO_INDEX;
  for (size_t i = 0; i < c->n_border; i++) {
    const uint32_t s = w->slide_of[c->border_patch[i]];

    if (s != VG_NO_INDEX && w->slide[s].is_plane &&
        (c->column[c->border[i][0]].n || c->column[c->border[i][1]].n))
      part[s] = 0;
  }
  for (size_t s = 0; s < w->n_slide; s++) {
    if (part[s] == VG_NO_INDEX) continue;
    part[s] = (uint32_t)w->n_part;
    VG_TRY(add_part(w, &w->slide[s]));
  }
  for (size_t t = 0; t < w->m->n_tri; t++) {
    const uint32_t s = w->slide_of[w->m->tri_patch[t]];

    w->part_of[t] = s == VG_NO_INDEX ? s : part[s];
  }
done:
  free(part);
  return st;
}

/* Propagation from columns over curved patches. */
struct spread {
  double *left;   /* [n_point] remaining reach at a point. */
  uint32_t *from; /* [n_point] column with that remaining reach. */
  uint32_t *queue;
  size_t n, cap;
};

/* Marks the triangles at v, which its column reaches, and continues from their
 * points while reach remains. */
static vg_status visit(struct vg_slide_work *w, struct spread *q, uint32_t v)
{
  const struct vg_mesh *m = w->m;
  const uint32_t i = q->from[v];
  const struct vg_column *c = &w->c->column[i];
  const double *root = m->point[c->root], *top = w->x[m->n_point + i];
  const double reach = vg_distance(root, top) +
                       BEYOND * vg_sizing_at(w->sizing, top);

  for (uint32_t j = w->first[v]; j < w->first[v + 1]; j++) {
    const uint32_t t = w->half[j] / 3, patch = m->tri_patch[t];

    if ((patch != c->slide[0] && patch != c->slide[1]) ||
        w->slide[w->slide_of[patch]].is_plane)
      continue;
    w->part_of[t] = MARKED;
    for (int k = 0; k < 3; k++) {
      const uint32_t u = m->tri[t][k];
      const double left = reach - vg_distance(root, m->point[u]);

      if (!(left > q->left[u])) continue;
      q->left[u] = left;
      q->from[u] = i;
      if (vg_reserve(&q->queue, &q->cap, q->n + 1, sizeof *q->queue))
        return vg_fail_memory(w->err, "slide patches");
      q->queue[q->n++] = u;
    }
  }
  return VG_OK;
}

static vg_status spread(struct vg_slide_work *w)
{
  const struct vg_columns *c = w->c;
  struct spread q = { vg_calloc(w->m->n_point, sizeof *q.left),
                      vg_alloc(w->m->n_point, sizeof *q.from), NULL, 0, 0 };
  vg_status st = VG_OK;

  if (!q.left || !q.from) {
    st = vg_fail_memory(w->err, "slide patches");
    goto done;
  }
  for (size_t i = 0; i < c->n_border; i++)
    for (int k = 0; k < 2; k++) {
      const uint32_t j = c->border[i][k], s = w->slide_of[c->border_patch[i]];

      if (!c->column[j].n || s == VG_NO_INDEX || w->slide[s].is_plane) continue;
      q.from[c->column[j].root] = j;
      VG_TRY(visit(w, &q, c->column[j].root));
    }
  for (size_t at = 0; at < q.n; at++) VG_TRY(visit(w, &q, q.queue[at]));
done:
  free(q.left);
  free(q.from);
  free(q.queue);
  return st;
}

/* Triangle across edge k of t, if it is marked and of the same patch. */
static uint32_t neighbour(const struct vg_slide_work *w, uint32_t t, int k)
{
  const uint32_t *v = w->m->tri[t];
  const uint32_t h = vg_slide_twin(w, v[k], v[k < 2 ? k + 1 : 0]);

  if (h == VG_NO_INDEX || w->part_of[h / 3] != MARKED ||
      w->m->tri_patch[h / 3] != w->m->tri_patch[t])
    return VG_NO_INDEX;
  return h / 3;
}

/* Turns connected regions of marked triangles into parts. */
static vg_status split(struct vg_slide_work *w)
{
  uint32_t *stack = vg_alloc(w->m->n_tri, sizeof *stack);
  vg_status st = VG_OK;

  if (!stack) return vg_fail_memory(w->err, "slide patches");
  for (uint32_t seed = 0; seed < w->m->n_tri; seed++) {
    size_t n = 0;

    if (w->part_of[seed] != MARKED) continue;
    w->part_of[seed] = (uint32_t)w->n_part;
    stack[n++] = seed;
    while (n) {
      const uint32_t t = stack[--n];

      for (int k = 0; k < 3; k++) {
        const uint32_t o = neighbour(w, t, k);

        if (o == VG_NO_INDEX) continue;
        w->part_of[o] = (uint32_t)w->n_part;
        stack[n++] = o;
      }
    }
    VG_TRY(add_part(w, &w->slide[w->slide_of[w->m->tri_patch[seed]]]));
  }
done:
  free(stack);
  return st;
}

/* Mean normals of curved parts. A part that closes on itself keeps the normal
 * of its patch. */
static void mean_normals(struct vg_slide_work *w)
{
  for (size_t s = 0; s < w->n_part; s++) {
    double sum[3] = { 0 };

    if (w->part[s].is_plane) continue;
    for (uint32_t i = w->tri_first[s]; i < w->tri_first[s + 1]; i++) {
      const uint32_t *v = w->m->tri[w->tri[i]];
      double a[3], b[3], n[3];

      vg_sub(w->m->point[v[1]], w->m->point[v[0]], a);
      vg_sub(w->m->point[v[2]], w->m->point[v[0]], b);
      vg_cross(a, b, n);
      for (int k = 0; k < 3; k++) sum[k] += n[k];
    }
    if (!(vg_unit(sum) > 0)) continue;
    memcpy(w->part[s].normal, sum, sizeof sum);
    w->part[s].at = vg_dot(sum,
                           w->m->point[w->m->tri[w->tri[w->tri_first[s]]][0]]);
  }
}

/* Part of a boundary edge: that of its triangle or, between columns of one
 * root, that of a triangle of the patch at the root. */
static uint32_t part_of_border(const struct vg_slide_work *w, size_t i)
{
  const struct vg_columns *c = w->c;
  const uint32_t a = c->column[c->border[i][0]].root;
  const uint32_t b = c->column[c->border[i][1]].root;

  if (a != b) {
    const uint32_t h = vg_slide_twin(w, a, b);

    if (h != VG_NO_INDEX && w->m->tri_patch[h / 3] == c->border_patch[i])
      return w->part_of[h / 3];
  }
  for (uint32_t j = w->first[a]; j < w->first[a + 1]; j++)
    if (w->m->tri_patch[w->half[j] / 3] == c->border_patch[i] &&
        w->part_of[w->half[j] / 3] != VG_NO_INDEX)
      return w->part_of[w->half[j] / 3];
  return VG_NO_INDEX;
}

vg_status vg_slide_parts(struct vg_slide_work *w)
{
  uint32_t *class_of = NULL;
  vg_status st;

  w->part_of = vg_alloc(w->m->n_tri, sizeof *w->part_of);
  class_of = vg_alloc(w->c->n_border, sizeof *class_of);
  if (!w->part_of || !class_of) {
    st = vg_fail_memory(w->err, "slide patches");
    goto done;
  }
  VG_TRY(sort_half_edges(w));
  VG_TRY(plane_parts(w));
  VG_TRY(spread(w));
  vg_slide_copy_marks(w);
  VG_TRY(split(w));
  VG_TRY(
    bucket(w->m->n_tri, w->part_of, w->n_part, &w->tri_first, &w->tri, w->err));
  mean_normals(w);
  for (size_t i = 0; i < w->c->n_border; i++)
    class_of[i] = part_of_border(w, i);
  st = bucket(w->c->n_border, class_of, w->n_part, &w->border_first, &w->border,
              w->err);
done:
  free(class_of);
  return st;
}
