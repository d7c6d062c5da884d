/* SPDX-License-Identifier: BSD-2-Clause */
/* A minimal mesher for Vanguard: it adds a point at the centre of the void and
 * connects each triangle of the front to it. This fills only voids that are
 * star-shaped about their centre. For all others it returns an error, and
 * Vanguard's own kernel fills them.
 *
 *   cc -shared -fPIC -I PREFIX/include star.c -o star.so
 *   vanguard mesh -p PROJECT --mesher ./star.so
 */
#include <stdlib.h>
#include <string.h>

#include <vanguard/mesher.h>

static double volume(const double a[3], const double b[3], const double c[3],
                     const double d[3])
{
  double u[3], v[3], w[3];

  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    w[k] = d[k] - a[k];
  }
  return u[0] * (v[1] * w[2] - v[2] * w[1]) +
         u[1] * (v[2] * w[0] - v[0] * w[2]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

static void find_middle(const struct vg_mesher_front *f, double x[3])
{
  memset(x, 0, 3 * sizeof *x);
  for (size_t i = 0; i < f->n_point; i++)
    for (int k = 0; k < 3; k++) x[k] += f->x[i][k] / (double)f->n_point;
}

/* The sizes would guide the placement of points; this mesher ignores them. */
static int fill(const struct vg_mesher_front *f,
                const struct vg_mesher_sizes *sizes,
                struct vg_mesher_cells *out)
{
  (void)sizes;
  out->x = malloc(sizeof *out->x);
  out->cell = malloc(f->n_face * sizeof *out->cell);
  if (!out->x || !out->cell) return 1;
  find_middle(f, out->x[0]);
  out->n_point = 1;
  for (size_t i = 0; i < f->n_face; i++) {
    const uint32_t *v = f->face[i];
    uint32_t *cell = out->cell[out->n_cell++];

    if (!(volume(f->x[v[0]], f->x[v[1]], f->x[v[2]], out->x[0]) > 0))
      return 1; /* triangle not visible from the centre */
    memcpy(cell, v, 3 * sizeof *cell);
    cell[3] = (uint32_t)f->n_point;
  }
  return 0;
}

static void release(struct vg_mesher_cells *cells)
{
  free(cells->x);
  free(cells->cell);
}

const struct vg_mesher *vg_mesher_plugin(void)
{
  static const struct vg_mesher star = { VG_MESHER_VERSION, "star", fill,
                                         release };

  return &star;
}
