/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/surface/borders.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"

/* S80 */
#define NARROW 0.05 /* of the size: narrower patches share BUDGET */
#define MOST                                                                   \
  0.2 /* of the edges at the largest size: most edges along the border         \
         of a patch, */
#define FEW 1000   /* which may always be this many */
#define BUDGET 2.0 /* of these edges: for all narrow patches together */

struct extent {
  double area, border; /* Area, and length of the border to other patches. */
  double smooth;       /* Length of the border across which the surface is
                          smooth; half of it for each of its two patches. */
};

static const double *corner(const struct vg_mesh *m, uint32_t h)
{
  return m->point[vg_half_from((const uint32_t(*)[3])m->tri, h)];
}

static void normal_of(const struct vg_mesh *m, size_t t, double n[3])
{
  double a[3], b[3];

  vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], a);
  vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], b);
  vg_cross(a, b, n);
}

/* Is the surface smooth across edge i, which borders two triangles? */
static int is_smooth(const struct vg_mesh *m, const struct vg_edges *e,
                     size_t i, double cosine)
{
  const uint32_t *h = &e->half[e->start[i]];
  double a[3], b[3];

  if (vg_edges_count(e, i) != 2) return 0;
  normal_of(m, h[0] / 3, a);
  normal_of(m, h[1] / 3, b);
  return vg_dot(a, b) >= cosine * vg_norm(a) * vg_norm(b);
}

static void measure(const struct vg_mesh *m, const struct vg_edges *e,
                    double cosine, struct extent *of)
{
  for (size_t t = 0; t < m->n_tri; t++) {
    double n[3];

    normal_of(m, t, n);
    of[m->tri_patch[t]].area += vg_norm(n) / 2;
  }
  for (size_t i = 0; i < e->n; i++) {
    const uint32_t *h = &e->half[e->start[i]];
    const double length = vg_distance(corner(m, h[0]),
                                      corner(m, vg_half_next(h[0])));
    const double smooth = is_smooth(m, e, i, cosine) ? length / 2 : 0;
    const uint32_t first = m->tri_patch[h[0] / 3], n = vg_edges_count(e, i);

    if (n == 1) of[first].border += length;
    for (uint32_t k = 1; k < n; k++) {
      const uint32_t patch = m->tri_patch[h[k] / 3];

      if (patch == first) continue;
      of[patch].border += length;
      of[first].border += length;
      of[patch].smooth += smooth;
      of[first].smooth += smooth;
    }
  }
}

/* Keep narrow patches with few edges along smooth borders first. Other borders
 * are feature edges anyway. */
static vg_status keep_narrow(size_t n, const struct extent *of,
                             const double *width, double budget, uint8_t *kept,
                             struct vg_error *err)
{
  struct vg_key *key = vg_alloc(n, sizeof *key);
  double sum = 0;
  vg_status st;

  if (!key) return vg_fail_memory(err, "the borders of the patches");
  for (size_t i = 0; i < n; i++) {
    const double edges = width[i] > 0 ? of[i].smooth / width[i] : INFINITY;

    memcpy(&key[i].key, &edges, sizeof edges); /* sorts like the value */
    key[i].index = (uint32_t)i;
  }
  VG_TRY(vg_sort_keys(n, key, err));
  for (size_t i = 0; i < n; i++) {
    const uint32_t patch = key[i].index;

    if (kept[patch]) continue;
    sum += of[patch].smooth / width[patch];
    if (!(sum <= budget)) break;
    kept[patch] = 1;
  }
done:
  free(key);
  return st;
}

vg_status vg_borders_keep(const struct vg_mesh *m, double size, double cosine,
                          uint8_t *kept, double *width, struct vg_error *err)
{
  struct extent *of = vg_calloc(m->n_patch, sizeof *of);
  struct vg_edges e = VG_EDGES_INIT;
  double whole = 0;
  vg_status st;

  assert(size > 0);
  if (!of) VG_TRY(vg_fail_memory(err, "the borders of the patches"));
  VG_TRY(vg_edges_build(&e, m->n_point, m->n_tri, (const uint32_t(*)[3])m->tri,
                        NULL, 0, err));
  measure(m, &e, cosine, of);
  for (size_t i = 0; i < m->n_patch; i++) whole += of[i].area;
  whole /= size * size;
  for (size_t i = 0; i < m->n_patch; i++) {
    width[i] = of[i].border > 0 ? 2 * of[i].area / of[i].border : INFINITY;
    if (width[i] >= NARROW * size &&
        of[i].border / width[i] <= fmax(FEW, MOST * whole))
      kept[i] = 1;
  }
  VG_TRY(keep_narrow(m->n_patch, of, width, BUDGET * whole, kept, err));
done:
  vg_edges_release(&e);
  free(of);
  return st;
}
