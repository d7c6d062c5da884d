/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The second patch of a periodic pair: curves, columns and triangles are the
 * images of those of the first one. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "layers/slide/slide_parts.h"

static size_t n_pair(const struct vg_slide_work *w)
{
  return w->twins ? w->twins->n : 0;
}

int vg_slide_is_image(const struct vg_slide_work *w, uint32_t patch)
{
  return n_pair(w) && vg_twins_image(w->twins, patch) < w->twins->n;
}

vg_status vg_slide_images_open(struct vg_slide_work *w)
{
  if (!n_pair(w)) return VG_OK;
  w->image = vg_calloc(n_pair(w), sizeof *w->image);
  return w->image ? VG_OK : vg_fail_memory(w->err, "periodic patches");
}

void vg_slide_images_release(struct vg_slide_work *w)
{
  for (size_t p = 0; w->image && p < n_pair(w); p++) free(w->image[p].of);
  free(w->image);
}

/* Index of a new point among those of the work. */
static size_t index_of(const struct vg_slide_work *w, uint32_t v)
{
  return v - (w->m->n_point + w->c->n_column);
}

vg_status vg_slide_set_image(struct vg_slide_work *w, size_t p, uint32_t v,
                             uint32_t is)
{
  struct vg_slide_images *l = &w->image[p];
  const size_t i = index_of(w, v);

  if (v < w->m->n_point + w->c->n_column) return VG_OK;
  if (vg_reserve(&l->of, &l->cap, i + 1, sizeof *l->of))
    return vg_fail_memory(w->err, "periodic patches");
  for (; l->n <= i; l->n++) l->of[l->n] = VG_NO_INDEX;
  l->of[i] = is;
  return VG_OK;
}

vg_status vg_slide_image(struct vg_slide_work *w, size_t p, uint32_t v,
                         uint32_t *is)
{
  const size_t n_m = w->m->n_point, n_c = w->c->n_column;
  double x[3];

  if (v < n_m) {
    *is = w->twins->match[p].point[v];
  } else if (v < n_m + n_c) {
    *is = w->twins->column[p][v - n_m];
    if (*is != VG_NO_INDEX) *is += (uint32_t)n_m;
  } else if (index_of(w, v) < w->image[p].n &&
             w->image[p].of[index_of(w, v)] != VG_NO_INDEX) {
    *is = w->image[p].of[index_of(w, v)];
  } else {
    vg_periodic_image(&w->twins->pair[p], w->x[v], x);
    if (vg_slide_add_point(w, x, is)) return VG_ERR_MEMORY;
    return vg_slide_set_image(w, p, v, *is);
  }
  assert(*is != VG_NO_INDEX);
  return VG_OK;
}

/* Moves the top of each twin to its place. */
static void copy_top(struct vg_slide_work *w, size_t p, uint32_t i, uint32_t k)
{
  const size_t n_m = w->m->n_point;

  vg_periodic_image(&w->twins->pair[p], w->x[n_m + i], w->x[n_m + k]);
}

static vg_status bend_as(struct vg_slide_work *w, uint32_t i,
                         const double (*x)[3])
{
  struct vg_columns *c = w->c;
  struct vg_column *k = &c->column[i];

  if (k->bent == SIZE_MAX) {
    if (vg_reserve(&c->path, &w->cap_path, c->n_path + k->n + 1,
                   sizeof *c->path))
      return vg_fail_memory(w->err, "bent columns");
    k->bent = c->n_path;
    c->n_path += (size_t)k->n + 1;
  }
  memcpy(c->path[k->bent], w->m->point[k->root], sizeof *c->path);
  memcpy(c->path[k->bent + 1], x + 1, k->n * sizeof *c->path);
  memcpy(w->x[w->m->n_point + i], x[k->n], sizeof x[0]);
  return VG_OK;
}

/* Bends column i as it is, and its twin k to the image. */
static vg_status copy_path(struct vg_slide_work *w, size_t p, uint32_t i,
                           uint32_t k)
{
  double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3];
  vg_status st;

  assert(w->c->column[i].n == w->c->column[k].n);
  vg_column_points(w->c, w->m, i, d, x);
  VG_TRY(bend_as(w, i, (const double(*)[3])x));
  for (int l = 1; l <= w->c->column[i].n; l++) {
    double y[3];

    vg_periodic_image(&w->twins->pair[p], x[l], y);
    memcpy(x[l], y, sizeof y);
  }
  st = bend_as(w, k, (const double(*)[3])x);
done:
  return st;
}

static vg_status each_twin(struct vg_slide_work *w, int is_path)
{
  for (size_t p = 0; p < n_pair(w); p++)
    for (uint32_t i = 0; i < w->c->n_column; i++) {
      const uint32_t k = w->twins->column[p][i];

      if (k == VG_NO_INDEX || k == i || !w->c->column[i].n) continue;
      if (!is_path) copy_top(w, p, i, k);
      else if (copy_path(w, p, i, k)) return VG_ERR_MEMORY;
    }
  return VG_OK;
}

void vg_slide_copy_tops(struct vg_slide_work *w)
{
  (void)each_twin(w, 0);
}

vg_status vg_slide_copy_paths(struct vg_slide_work *w)
{
  return each_twin(w, 1);
}

void vg_slide_copy_marks(struct vg_slide_work *w)
{
  for (size_t p = 0; p < n_pair(w); p++) {
    const uint32_t patch = w->twins->patch[p][0], s = w->slide_of[patch];

    if (s == VG_NO_INDEX || w->slide[s].is_plane) continue;
    for (size_t t = 0; t < w->m->n_tri; t++)
      if (w->m->tri_patch[t] == patch)
        w->part_of[w->twins->match[p].face[t]] = w->part_of[t];
  }
}

vg_status vg_slide_copy_faces(struct vg_slide_work *w)
{
  for (size_t p = 0; p < n_pair(w); p++) {
    const size_t n = w->n_new;

    for (size_t t = 0; t < n; t++) {
      uint32_t v[3];

      if (w->new_patch[t] != w->twins->patch[p][0]) continue;
      for (int k = 0; k < 3; k++)
        if (vg_slide_image(w, p, w->new_tri[t][k], &v[2 - k]))
          return VG_ERR_MEMORY;
      if (vg_reserve(&w->new_tri, &w->cap_new, w->n_new + 1,
                     sizeof *w->new_tri) ||
          vg_reserve(&w->new_patch, &w->cap_new_patch, w->n_new + 1,
                     sizeof *w->new_patch))
        return vg_fail_memory(w->err, "periodic patches");
      memcpy(w->new_tri[w->n_new], v, sizeof v);
      w->new_patch[w->n_new++] = w->twins->patch[p][1];
    }
  }
  return VG_OK;
}
