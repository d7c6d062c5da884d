/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Volume ratios between layers and field, by patch. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "layers/measure/measure.h"

struct top {
  uint32_t patch, face;
  double ratio;
};

/* Sorts by patch, then by ratio. */
static int by_patch(const void *a, const void *b)
{
  const struct top *s = a, *t = b;

  if (s->patch != t->patch) return s->patch < t->patch ? -1 : 1;
  if (s->ratio < t->ratio || s->ratio > t->ratio)
    return s->ratio < t->ratio ? -1 : 1;
  return (s->face > t->face) - (s->face < t->face);
}

/* Statistics of n > 0 tops sorted by ratio. */
static void describe(const struct vg_mesh *surface, const struct vg_columns *c,
                     const struct top *top, size_t n, struct vg_patch_layers *w)
{
  const uint32_t *f = c->face[top[n - 1].face];

  w->n_top = n;
  w->top_ratio[0] = top[n / 2 + n % 2 - 1].ratio;
  w->top_ratio[1] = top[n - n / 20 - 1].ratio;
  w->top_ratio[2] = top[n - 1].ratio;
  for (int k = 0; k < 3; k++) {
    w->top_at[k] = 0;
    for (int i = 0; i < 3; i++)
      w->top_at[k] += surface->point[c->column[f[i]].root][k] / 3;
  }
}

vg_status vg_layers_tops(const struct vg_mesh *surface,
                         const struct vg_columns *c, const double *ratio,
                         size_t n, struct vg_patch_layers *wall,
                         struct vg_patch_layers *all, struct vg_error *err)
{
  assert(ratio || !c->n_face);
  assert(wall || !n);

  struct top *top = vg_alloc(c->n_face, sizeof *top);
  size_t n_top = 0, at = 0;

  if (!top) return vg_fail_memory(err, "the tops of the layers");
  for (size_t i = 0; i < c->n_face; i++) {
    uint32_t of = c->face_tri[i];

    if (!(ratio[i] > 0)) continue;
    top[n_top].patch = of == VG_NO_INDEX ? of : surface->tri_patch[of];
    top[n_top].face = (uint32_t)i;
    top[n_top++].ratio = ratio[i];
  }
  if (n_top) qsort(top, n_top, sizeof *top, by_patch);
  for (size_t i = 0; i < n; i++) {
    size_t first;

    while (at < n_top && top[at].patch < wall[i].patch) at++;
    for (first = at; at < n_top && top[at].patch == wall[i].patch;) at++;
    if (at > first) describe(surface, c, top + first, at - first, &wall[i]);
  }
  for (size_t i = 0; i < n_top; i++) top[i].patch = 0;
  if (n_top) qsort(top, n_top, sizeof *top, by_patch);
  if (n_top) describe(surface, c, top, n_top, all);
  free(top);
  return VG_OK;
}
