/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/span.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

/* Least area between the rim from point i to point k > i and the chord that
 * joins them, and the third point of the triangle at the chord. */
struct span {
  size_t n;
  const double (*x)[3];
  const uint32_t *rim;
  double *area;    /* [n * n] */
  uint32_t *third; /* [n * n] */
};

static double area_of(const struct span *s, size_t i, size_t j, size_t k)
{
  return vg_triangle_area(s->x[s->rim[i]], s->x[s->rim[j]], s->x[s->rim[k]]);
}

static void find_least(struct span *s)
{
  for (size_t length = 2; length < s->n; length++)
    for (size_t i = 0; i + length < s->n; i++) {
      const size_t k = i + length;
      double best = INFINITY;

      for (size_t j = i + 1; j < k; j++) {
        const double area = s->area[i * s->n + j] + s->area[j * s->n + k] +
                            area_of(s, i, j, k);

        if (!(area < best)) continue;
        best = area;
        s->third[i * s->n + k] = (uint32_t)j;
      }
      s->area[i * s->n + k] = best;
    }
}

/* Store the triangles between points 0 and n - 1. */
static void store(const struct span *s, uint32_t (*todo)[2], uint32_t (*tri)[3])
{
  size_t n_todo = 1, n = 0;

  todo[0][0] = 0;
  todo[0][1] = (uint32_t)(s->n - 1);
  while (n_todo) {
    const uint32_t i = todo[--n_todo][0], k = todo[n_todo][1];
    uint32_t j;

    if (k < i + 2) continue;
    j = s->third[i * s->n + k];
    tri[n][0] = s->rim[i];
    tri[n][1] = s->rim[j];
    tri[n++][2] = s->rim[k];
    todo[n_todo][0] = i;
    todo[n_todo++][1] = j;
    todo[n_todo][0] = j;
    todo[n_todo++][1] = k;
  }
  assert(n == s->n - 2);
}

vg_status vg_span_rim(struct vg_mesh *m, size_t n, const uint32_t *rim,
                      uint32_t patch, struct vg_error *err)
{
  assert(m && rim && patch < m->n_patch);

  struct span s = { n, (const double(*)[3])m->point, rim, NULL, NULL };
  uint32_t(*todo)[2] = NULL, (*tri)[3] = NULL, *of = NULL;
  vg_status st = VG_OK;

  if (n < 3 || n > VG_SPAN_MOST)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "a rim that is not plane can have 3 to %d points",
                   VG_SPAN_MOST);
  s.area = vg_calloc(n * n, sizeof *s.area);
  s.third = vg_calloc(n * n, sizeof *s.third);
  todo = vg_alloc(n, sizeof *todo);
  if (!s.area || !s.third || !todo)
    VG_TRY(vg_fail_memory(err, "the cap of a rim"));
  tri = vg_realloc(m->tri, m->n_tri + n - 2, sizeof *tri);
  if (tri) m->tri = tri;
  of = vg_realloc(m->tri_patch, m->n_tri + n - 2, sizeof *of);
  if (of) m->tri_patch = of;
  if (!tri || !of) VG_TRY(vg_fail_memory(err, "the cap of a rim"));
  find_least(&s);
  store(&s, todo, m->tri + m->n_tri);
  for (size_t i = 0; i < n - 2; i++) m->tri_patch[m->n_tri++] = patch;
done:
  free(s.area);
  free(s.third);
  free(todo);
  return st;
}
