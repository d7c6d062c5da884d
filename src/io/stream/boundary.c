/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/stream/boundary.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"

/* Stable counting sort; start[] is shifted by one patch while it is filled. */
vg_status vg_boundary_by_patch(const struct vg_mesh *m, size_t **start,
                               size_t **order, struct vg_error *err)
{
  assert(start && order);

  size_t n = m->n_tri + m->n_quad;
  size_t *s = vg_calloc(m->n_patch + 2, sizeof *s);
  size_t *o = vg_alloc(n, sizeof *o);

  if (!s || !o) {
    free(s);
    free(o);
    return vg_fail_memory(err, "the boundary faces sorted by patch");
  }
#define PATCH(i)                                                               \
  ((i) < m->n_tri ? m->tri_patch[i] : m->quad_patch[(i)-m->n_tri])
  for (size_t i = 0; i < n; i++) s[PATCH(i) + 2]++;
  for (size_t p = 2; p < m->n_patch + 2; p++) s[p] += s[p - 1];
  for (size_t i = 0; i < n; i++) o[s[PATCH(i) + 1]++] = i;
#undef PATCH
  *start = s;
  *order = o;
  return VG_OK;
}
