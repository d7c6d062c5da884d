/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Edge lengths at the ends of the span of a patch, of the table `surface`.
 *
 *   middle       root                             tip
 *     |           o--------------------------------o
 *     |           |                                |     axis y or z
 *     +-----------o--------------------------------o--->
 *     |<--------------- semispan ----------------->|
 */
#include <math.h>

#include "core/geometry/vector.h"
#include "core/search/box.h"
#include "run/input/cones.h"
#include "run/input/shape_parts.h"

/* Squared cosine between the normal of a triangle and the axis of the span:
 * triangles above are in a cut or a cap, not along the span. */
#define FACES_SPAN2 0.5
/* Of the semispan: distance of the sections from the ends, which need not be in
 * a plane. */
#define INSET 1e-3

/* Distances from `middle` along the axis. */
struct span {
  int axis, crosses; /* 1: the patch is on both sides of the middle. */
  double middle, root, tip;
};

static double distance_along(const struct span *s, const double x[3])
{
  return fabs(x[s->axis] - s->middle);
}

/* The middle of a half model is its symmetry plane; that of others is the
 * middle of the body. */
static double find_middle(const struct vg_boundary *b, int axis)
{
  const struct vg_mesh *m = &b->surface;
  double lo = INFINITY, hi = -INFINITY;

  if (b->flow.axis == axis) return b->flow.at;
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      if (vg_patch_is_outer(&m->patch[m->tri_patch[t]])) break;
      lo = fmin(lo, m->point[m->tri[t][k]][axis]);
      hi = fmax(hi, m->point[m->tri[t][k]][axis]);
    }
  return 0.5 * (lo + hi);
}

/* The span of the patches with mark[patch] 1. */
static struct span find_span(const struct vg_boundary *b, const uint8_t *mark)
{
  const struct vg_mesh *m = &b->surface;
  struct vg_box box = VG_BOX_EMPTY;
  struct span s = { .root = INFINITY };

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && mark[m->tri_patch[t]]; k++)
      vg_box_add(&box, m->point[m->tri[t][k]]);
  s.axis = box.hi[1] - box.lo[1] >= box.hi[2] - box.lo[2] ? 1 : 2;
  s.middle = find_middle(b, s.axis);
  s.tip = fmax(distance_along(&s, box.lo), distance_along(&s, box.hi));
  s.crosses = b->flow.axis != s.axis && box.lo[s.axis] < s.middle &&
              box.hi[s.axis] > s.middle;
  s.root = s.crosses
           ? 0
           : fmin(distance_along(&s, box.lo), distance_along(&s, box.hi));
  return s;
}

/* The point of edge pq in a plane normal to the span. */
static int cut_edge(const struct span *s, double plane, const double *p,
                    const double *q, double x[3])
{
  const double d = p[s->axis] - plane, e = q[s->axis] - plane;

  if ((d < 0) == (e < 0)) return 0;
  for (int k = 0; k < 3; k++) x[k] = p[k] + d / (d - e) * (q[k] - p[k]);
  return 1;
}

/* Lines along the section of the patches in a plane. */
static vg_status add_section(const struct vg_mesh *m, const uint8_t *mark,
                             const struct span *s, double plane, double size,
                             struct vg_surface_sizes *to, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t t = 0; t < m->n_tri && st >= 0; t++) {
    struct vg_source line = { .kind = VG_SOURCE_LINE, .h0 = size, .h1 = size };
    double *const end[] = { line.p0, line.p1 };
    int n = 0;

    if (!mark[m->tri_patch[t]]) continue;
    for (int k = 0; k < 3 && n < 2; k++)
      n += cut_edge(s, plane, m->point[m->tri[t][k]],
                    m->point[m->tri[t][(k + 1) % 3]], end[n]);
    if (n == 2) st = vg_surface_sizes_add(to, &line, err);
  }
  return st;
}

/* Sections at a distance from the middle, on both sides of it. */
static vg_status add_sections(const struct vg_mesh *m, const uint8_t *mark,
                              const struct span *s, double at, double size,
                              struct vg_surface_sizes *to, struct vg_error *err)
{
  vg_status st = add_section(m, mark, s, s->middle + at, size, to, err);

  if (st < 0 || !(at > 0)) return st;
  return add_section(m, mark, s, s->middle - at, size, to, err);
}

vg_status vg_span_sizes(const struct vg_boundary *b, const uint8_t *mark,
                        double root, double tip, struct vg_surface_sizes *to,
                        struct vg_error *err)
{
  const struct span s = find_span(b, mark);
  const double inset = INSET * s.tip;
  vg_status st = VG_OK;

  if (root > 0)
    st = add_sections(&b->surface, mark, &s, s.crosses ? 0 : s.root + inset,
                      root * s.tip, to, err);
  if (tip > 0 && st >= 0)
    st = add_sections(&b->surface, mark, &s, s.tip - inset, tip * s.tip, to,
                      err);
  return st;
}

/* Is triangle t in a cut or a cap? */
static int faces_span(const struct vg_mesh *m, size_t t, const struct span *s)
{
  double u[3], v[3], area[3];

  vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], u);
  vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], v);
  vg_cross(u, v, area);
  return area[s->axis] * area[s->axis] > FACES_SPAN2 * vg_dot(area, area);
}

/* Extent along the span of the triangles of the patches with a point closer to
 * the end than half the requested edge length, over the semispan. */
static void measure(const struct vg_mesh *m, const uint8_t *mark,
                    const struct span *s, double end, double share, int caps,
                    struct vg_edge_spacing *to)
{
  for (size_t t = 0; t < m->n_tri; t++) {
    double lo = INFINITY, hi = 0, least = INFINITY;

    if (!mark[m->tri_patch[t]] || (!caps && faces_span(m, t, s))) continue;
    for (int k = 0; k < 3; k++) {
      const double at = distance_along(s, m->point[m->tri[t][k]]);

      lo = fmin(lo, at);
      hi = fmax(hi, at);
      least = fmin(least, fabs(at - end));
    }
    if (!(least <= 0.5 * share * s->tip)) continue;
    to->asked += share;
    to->reached += (hi - lo) / s->tip;
    to->n++;
  }
}

/* At a round tip all triangles face along the span. */
static void measure_end(const struct vg_mesh *m, const uint8_t *mark,
                        const struct span *s, double end, double share,
                        struct vg_edge_spacing *to)
{
  const size_t n = to->n;

  if (!(share > 0)) return;
  measure(m, mark, s, end, share, 0, to);
  if (to->n == n) measure(m, mark, s, end, share, 1, to);
}

void vg_span_measure(const struct vg_boundary *b, const uint8_t *mark,
                     double root, double tip, struct vg_edge_spacing to[2])
{
  const struct span s = find_span(b, mark);

  measure_end(&b->surface, mark, &s, s.root, root, &to[0]);
  measure_end(&b->surface, mark, &s, s.tip, tip, &to[1]);
}
