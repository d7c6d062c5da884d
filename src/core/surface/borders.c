/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/surface/borders.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"

/* S80 */
#define NARROW 0.05 /* of the size: narrower patches do not keep borders */
#define MOST                                                                   \
  0.2 /* of the edges at the largest size: most edges along the border         \
         of a patch, */
#define FEW 1000 /* which may always be this many */

struct extent {
  double area, border; /* Area, and length of the border to other patches. */
};

static double area_of(const struct vg_mesh *m, size_t t)
{
  return vg_triangle_area(m->point[m->tri[t][0]], m->point[m->tri[t][1]],
                          m->point[m->tri[t][2]]);
}

static void measure(const struct vg_mesh *m, const struct vg_edges *e,
                    struct extent *of)
{
  for (size_t t = 0; t < m->n_tri; t++)
    of[m->tri_patch[t]].area += area_of(m, t);
  for (size_t i = 0; i < e->n; i++) {
    const uint32_t h = e->half[e->start[i]];
    const double length = vg_distance(
      m->point[vg_half_from((const uint32_t(*)[3])m->tri, h)],
      m->point[vg_half_to((const uint32_t(*)[3])m->tri, h)]);
    const uint32_t first = m->tri_patch[h / 3];

    for (uint32_t k = e->start[i]; k < e->start[i + 1]; k++) {
      const uint32_t patch = m->tri_patch[e->half[k] / 3];

      if (vg_edges_count(e, i) > 1 && k == e->start[i]) continue;
      if (patch == first && vg_edges_count(e, i) > 1) continue;
      of[patch].border += length;
      if (patch != first) of[first].border += length;
    }
  }
}

vg_status vg_borders_keep(const struct vg_mesh *m, double size, uint8_t *kept,
                          struct vg_error *err)
{
  struct extent *of = vg_calloc(m->n_patch, sizeof *of);
  struct vg_edges e = VG_EDGES_INIT;
  double whole = 0;
  vg_status st;

  assert(size > 0);
  if (!of) VG_TRY(vg_fail_memory(err, "the borders of the patches"));
  VG_TRY(vg_edges_build(&e, m->n_point, m->n_tri, (const uint32_t(*)[3])m->tri,
                        NULL, 0, err));
  measure(m, &e, of);
  for (size_t i = 0; i < m->n_patch; i++) whole += of[i].area;
  for (size_t i = 0; i < m->n_patch; i++) {
    const double width = of[i].border > 0 ? 2 * of[i].area / of[i].border : 0;
    if (width >= NARROW * size &&
        of[i].border / width <= fmax(FEW, MOST * whole / (size * size)))
      kept[i] = 1;
  }
done:
  vg_edges_release(&e);
  free(of);
  return st;
}
