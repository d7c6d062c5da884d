/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Plane patches over which the layers of a wall continue. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"
#include "layers/slide/slide.h"

/* L21 */
#define FLAT 0.95 /* Least cosine of the turn at a flat edge. */
#define SHARE 0.1 /* Least share of flat edges. */

/* Edges between one patch without layers and walls. */
struct border {
  double flat, all; /* Lengths. */
  uint32_t wall;    /* First wall that shares a flat edge. */
};

static void normal_of(const struct vg_mesh *m, uint32_t t, double n[3])
{
  double a[3], b[3];

  vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], a);
  vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], b);
  vg_cross(a, b, n);
  vg_unit(n);
}

static void add_edge(const struct vg_mesh *m, uint32_t h, uint32_t wall_h,
                     struct border *border)
{
  struct border *b = &border[m->tri_patch[h / 3]];
  uint32_t wall = m->tri_patch[wall_h / 3];
  double n[2][3], length = vg_distance(
                    m->point[vg_half_from((const uint32_t(*)[3])m->tri, h)],
                    m->point[vg_half_to((const uint32_t(*)[3])m->tri, h)]);

  normal_of(m, h / 3, n[0]);
  normal_of(m, wall_h / 3, n[1]);
  b->all += length;
  if (vg_dot(n[0], n[1]) < FLAT) return;
  b->flat += length;
  if (wall < b->wall) b->wall = wall;
}

static void measure(const struct vg_mesh *m, const struct vg_edges *e,
                    const uint8_t *is_wall, struct border *border)
{
  for (size_t p = 0; p < m->n_patch; p++)
    border[p] = (struct border){ 0, 0, VG_NO_INDEX };
  for (size_t i = 0; i < e->n; i++) {
    const uint32_t *h = vg_edges_at(e, i);

    if (vg_edges_count(e, i) != 2) continue;
    for (int k = 0; k < 2; k++)
      if (!is_wall[m->tri_patch[h[k] / 3]] &&
          is_wall[m->tri_patch[h[1 - k] / 3]])
        add_edge(m, h[k], h[1 - k], border);
  }
}

/* One round: patches that touch the walls found so far. */
static vg_status extend(const struct vg_mesh *m, const struct vg_edges *e,
                        const uint8_t *may, uint8_t *is_wall,
                        struct border *border, uint32_t *from, size_t *n_new,
                        struct vg_error *err)
{
  struct vg_slide *slide = NULL;
  size_t n_slide;
  vg_status st = vg_slides_find(m, is_wall, &n_slide, &slide, err);

  *n_new = 0;
  if (st < 0) return st;
  measure(m, e, is_wall, border);
  for (size_t i = 0; i < n_slide; i++) {
    uint32_t p = slide[i].patch, wall = border[p].wall;

    if (!may[p] || !slide[i].is_plane || wall == VG_NO_INDEX ||
        border[p].flat < SHARE * border[p].all)
      continue;
    from[p] = from[wall] == VG_NO_INDEX ? wall : from[wall];
    is_wall[p] = 1;
    ++*n_new;
  }
  free(slide);
  return VG_OK;
}

vg_status vg_slides_extend(const struct vg_mesh *surface,
                           const uint8_t *is_wall, const uint8_t *may,
                           uint32_t *from, struct vg_error *err)
{
  struct vg_edges e = VG_EDGES_INIT;
  uint8_t *now = vg_alloc(surface->n_patch, 1);
  struct border *border = vg_alloc(surface->n_patch, sizeof *border);
  size_t n_new = 1;
  vg_status st;

  assert((is_wall && may && from) || !surface->n_patch);
  if (!now || !border) {
    st = vg_fail_memory(err, "slide patches");
    goto done;
  }
  memcpy(now, is_wall, surface->n_patch);
  for (size_t p = 0; p < surface->n_patch; p++) from[p] = VG_NO_INDEX;
  VG_TRY(vg_edges_build(&e, surface->n_point, surface->n_tri,
                        (const uint32_t(*)[3])surface->tri, NULL, 0, err));
  while (n_new)
    VG_TRY(extend(surface, &e, may, now, border, from, &n_new, err));
done:
  vg_edges_release(&e);
  free(now);
  free(border);
  return st;
}
