#include "core/remesh/clean_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

#define DEEPEST 0.25      /* S46: of the tolerance: deeper ones are not moved
                             apart */
#define CLEAR 1e-4        /* of the tolerance: how far beyond, at least */

/* Distances of the corners of triangle a from the plane of b; 0 where b has no
 * plane. */
static int heights(const struct vg_mesh *m, size_t a, size_t b, double n[3],
                   double h[3])
{
  const double *o = m->point[m->tri[b][0]];
  double u[3], v[3];

  vg_sub(m->point[m->tri[b][1]], o, u);
  vg_sub(m->point[m->tri[b][2]], o, v);
  vg_cross(u, v, n);
  if (!(vg_unit(n) > 0)) return 0;
  for (int k = 0; k < 3; k++) {
    const uint32_t p = m->tri[a][k];

    vg_sub(m->point[p], o, u);
    h[k] = vg_dot(u, n);
    for (int j = 0; j < 3; j++)
      if (m->tri[b][j] == p) h[k] = 0;
  }
  return 1;
}

/* How far triangle a reaches through the plane of b. */
static double reach(const double h[3])
{
  const double lo = fmin(h[0], fmin(h[1], h[2]));
  const double hi = fmax(h[0], fmax(h[1], h[2]));

  return fmax(0, fmin(-lo, hi));
}

static int is_pair(const struct vg_defect *d)
{
  return d->kind == VG_DEFECT_INTERSECTION && d->face[0] != SIZE_MAX
         && d->face[1] != SIZE_MAX;
}

void vg_clean_depth(const struct vg_mesh *m, const struct vg_surface_report *r,
                    struct vg_clean *c)
{
  c->depth = 0;
  for (size_t i = 0; i < r->n_defect; i++) {
    const struct vg_defect *d = &r->defect[i];
    double n[3], h[3], deep = INFINITY;

    if (!is_pair(d)) continue;
    for (int k = 0; k < 2; k++)
      if (heights(m, d->face[k], d->face[!k], n, h))
        deep = fmin(deep, reach(h));
    if (!(deep < INFINITY)) deep = 0;
    if (i && deep < c->depth) continue;
    c->depth = deep;
    memcpy(c->at, d->at, sizeof c->at);
  }
}

/* Corners of a that are barely on the wrong side of b move over to the other
 * one, where most of a is. */
static void push(const struct vg_mesh *m, size_t a, size_t b, double tolerance,
                 double (*move)[3])
{
  double n[3], h[3], side;

  if (!heights(m, a, b, n, h)) return;
  if (!(reach(h) > 0 && reach(h) < DEEPEST * tolerance)) return;
  side = h[0] + h[1] + h[2] > 0 ? 1 : -1;
  for (int k = 0; k < 3; k++) {
    const uint32_t p = m->tri[a][k];
    double by = fmax(CLEAR * tolerance, -0.5 * side * h[k]) - side * h[k];

    if (!(side * h[k] < 0) || by * by <= vg_dot(move[p], move[p])) continue;
    for (int d = 0; d < 3; d++) move[p][d] = side * by * n[d];
  }
}

vg_status vg_clean_part(struct vg_mesh *m, const struct vg_surface_report *r,
                        double tolerance, size_t *n_moved,
                        struct vg_error *err)
{
  double (*move)[3] = vg_calloc(m->n_point, sizeof *move);

  *n_moved = 0;
  if (!move) return vg_fail_memory(err, "intersections of the surface");
  for (size_t i = 0; i < r->n_defect; i++)
    for (int k = 0; k < 2; k++)
      if (is_pair(&r->defect[i]))
        push(m, r->defect[i].face[k], r->defect[i].face[!k], tolerance, move);
  for (size_t p = 0; p < m->n_point; p++) {
    if (!(vg_dot(move[p], move[p]) > 0)) continue;
    for (int d = 0; d < 3; d++) m->point[p][d] += move[p][d];
    ++*n_moved;
  }
  free(move);
  return VG_OK;
}
