#include "core/region.h"

#include <math.h>

/* Rings of cells, in target edges, placed beyond a slab so that the cells
 * which cross it have their final shape. */
static const double margin = 3;

static double side(const struct vg_slab *s, const double x[3])
{
  return s->normal[0] * x[0] + s->normal[1] * x[1] + s->normal[2] * x[2] -
         s->offset;
}

int vg_region_has_cell(const struct vg_region *r, const double a[3],
                       const double b[3], const double c[3],
                       const double d[3])
{
  for (int i = 0; i < r->n_slab; i++) {
    const double *corner[4] = {a, b, c, d};
    int above = 0, below = 0;

    for (int k = 0; k < 4; k++) {
      double s = side(&r->slab[i], corner[k]);

      above |= s >= -r->slab[i].reach;
      below |= s <= r->slab[i].reach;
    }
    if (!above || !below) return 0;
  }
  return 1;
}

int vg_region_near(const struct vg_region *r, const double x[3], double h)
{
  for (int i = 0; i < r->n_slab; i++)
    if (fabs(side(&r->slab[i], x)) > r->slab[i].reach + margin * h) return 0;
  return 1;
}
