/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "run/section/section_mesh.h"
#include "run/section/section_surface.h"

/* An edge of a triangle of the field, or of the last cell of a stack. */
struct side {
  uint64_t key;
  double area;
};

static int by_key(const void *a, const void *b)
{
  const struct side *p = a, *q = b;

  return (p->key > q->key) - (p->key < q->key);
}

static double area_of(const struct vg_plane_mesh *m, const uint32_t *v, int n)
{
  double sum = 0;

  for (int k = 1; k + 1 < n; k++) {
    const double *o = m->x[v[0]], *p = m->x[v[k]], *q = m->x[v[k + 1]];

    sum += (p[0] - o[0]) * (q[1] - o[1]) - (q[0] - o[0]) * (p[1] - o[1]);
  }
  return 0.5 * sum;
}

static void add_sides(const struct vg_plane_mesh *m, const uint32_t *v, int n,
                      struct side *side, size_t *n_side)
{
  const double area = area_of(m, v, n);

  for (int k = 0; k < n; k++)
    side[(*n_side)++] = (struct side){ vg_edge_key(v[k], v[(k + 1) % n]),
                                       area };
}

/* Ratio across the edge with this key, which has a layer cell and a cell of the
 * field. */
static double ratio_at(const struct side *side, size_t n, uint64_t key)
{
  const struct side wanted = { key, 0 };
  const struct side *at = n ? bsearch(&wanted, side, n, sizeof *side, by_key)
                            : NULL;
  const struct side *other = NULL;

  if (!at) return 0;
  if (at > side && at[-1].key == key) other = at - 1;
  else if (at + 1 < side + n && at[1].key == key) other = at + 1;
  if (!other || !(at->area > 0) || !(other->area > 0)) return 0;
  return fmax(at->area / other->area, other->area / at->area);
}

vg_status vg_section_tops(const struct vg_mesh *slab,
                          const struct vg_layers *layers,
                          const struct vg_plane_mesh *m, const uint32_t *top,
                          double **ratio, struct vg_error *err)
{
  const struct vg_columns *c = &layers->columns;
  const uint32_t back = (uint32_t)slab->n_patch - 2;
  struct side *side = vg_alloc(3 * m->n_tri + 4 * m->n_quad, sizeof *side);
  double *of_edge = vg_calloc(vg_section_points(slab), sizeof *of_edge);
  double *out = vg_calloc(c->n_face, sizeof *out);
  size_t n = 0;
  vg_status st = VG_OK;

  if (!side || !of_edge || !out) {
    st = vg_fail_memory(err, "the tops of the layers");
    goto done;
  }
  for (size_t i = 0; i < m->n_tri; i++) add_sides(m, m->tri[i], 3, side, &n);
  for (size_t i = 0; i < m->n_quad; i++) add_sides(m, m->quad[i], 4, side, &n);
  if (n) qsort(side, n, sizeof *side, by_key);
  for (size_t i = 0; i < c->n_border; i++) {
    const uint32_t a = c->border[i][0], b = c->border[i][1];

    if (c->border_patch[i] == back && c->column[a].root != c->column[b].root &&
        c->column[a].n + c->column[b].n > 0)
      of_edge[c->column[a].root] = ratio_at(side, n,
                                            vg_edge_key(top[a], top[b]));
  }
  /* Triangles 2 k and 2 k + 1 of a strip are on the edge from point k. */
  for (size_t f = 0; f < c->n_face; f++)
    if (c->face_tri[f] != VG_NO_INDEX) out[f] = of_edge[c->face_tri[f] / 2];
  *ratio = out;
  out = NULL;
done:
  free(side);
  free(of_edge);
  free(out);
  return st;
}
