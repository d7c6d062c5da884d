/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Boundary triangles between some of the boundary points. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "partition/repair/repair_parts.h"

static int by_points(const void *a, const void *b)
{
  const uint32_t *s = a, *t = b;

  for (int k = 0; k < 3; k++)
    if (s[k] != t[k]) return s[k] < t[k] ? -1 : 1;
  return 0;
}

/* Corners of triangle k, by first copies. */
static void corners_of(const struct vg_doubled *d, const struct vg_mesh *m,
                       size_t k, uint32_t v[3])
{
  for (int i = 0; i < 3; i++) v[i] = vg_doubled_first(d, m->tri[k][i]);
}

static vg_status list(const struct vg_doubled *d, const struct vg_mesh *m,
                      const uint8_t *in, struct vg_repair_boundary *r)
{
  uint32_t v[3];
  size_t n = 0;

  for (size_t k = 0; k < m->n_tri; k++) {
    corners_of(d, m, k, v);
    n += in[v[0]] && in[v[1]] && in[v[2]];
  }
  r->tri = vg_alloc(n, sizeof *r->tri);
  if (!r->tri) return VG_ERR_MEMORY;
  for (size_t k = 0; k < m->n_tri; k++) {
    corners_of(d, m, k, v);
    if (!in[v[0]] || !in[v[1]] || !in[v[2]]) continue;
    memcpy(r->tri[r->n], v, sizeof *r->tri);
    vg_order3(r->tri[r->n++]);
  }
  if (r->n) qsort(r->tri, r->n, sizeof *r->tri, by_points);
  return VG_OK;
}

vg_status vg_repair_boundary_new(const struct vg_doubled *doubled,
                                 const struct vg_mesh *boundary, size_t n,
                                 const struct vg_cluster_cells *block,
                                 struct vg_repair_boundary *out,
                                 struct vg_error *err)
{
  size_t n_point = boundary ? boundary->n_point : 0;
  uint8_t *in;
  vg_status st = VG_OK;
  int any = 0;

  memset(out, 0, sizeof *out);
  in = vg_calloc(n_point, 1);
  if (!in) return vg_fail_memory(err, "repairs");
  for (size_t k = 0; k < n; k++)
    for (size_t i = 0; i < block[k].n_point; i++)
      if (block[k].name[i] < n_point) any = in[block[k].name[i]] = 1;
  if (any && list(doubled, boundary, in, out) < 0)
    st = vg_fail_memory(err, "repairs");
  free(in);
  return st;
}

void vg_repair_boundary_release(struct vg_repair_boundary *r)
{
  free(r->tri);
  memset(r, 0, sizeof *r);
}

int vg_repair_boundary_has(const struct vg_repair_boundary *r,
                           const uint32_t v[3])
{
  uint32_t key[3] = { v[0], v[1], v[2] };

  assert(v[0] != v[1] && v[1] != v[2] && v[2] != v[0]);
  vg_order3(key);
  return r->n && bsearch(key, r->tri, r->n, sizeof *r->tri, by_points);
}
