/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Projects a surface that was remeshed from CAD back onto its CAD faces and
 * curves.
 *
 * Samples are the points and the centroids of the new triangles. Each sample is
 * near a triangle of the CAD tessellation, which belongs to a face; points on
 * an edge of that triangle that is part of a curve belong to the curve. Points
 * are projected; the distances of the centroids are only measured. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/remesh/put_back.h"
#include "run/input/shape_parts.h"

/* Share of the length of an edge below which a point is on it. */
#define ON_EDGE 1e-6

struct segment {
  uint32_t end[2], curve;
};

struct samples {
  size_t n, n_point;        /* Points come first. */
  double (*x)[3], (*to)[3]; /* Position on the surface, and on the CAD model. */
  uint32_t *tri;            /* Triangle of the CAD tessellation. */
  uint32_t *curve;          /* [n_point] curve; 0: none. */
  double *distance;         /* Distance between `to` and `x`; INFINITY: the
                               sample has no position on the model. */
  uint8_t *stays;           /* [n_point] 1: the point is not moved. */
};

struct range {
  size_t first, end;
};

static void release(struct samples *s)
{
  free(s->x);
  free(s->to);
  free(s->tri);
  free(s->curve);
  free(s->distance);
  free(s->stays);
}

static vg_status start(struct samples *s, const struct vg_mesh *m,
                       struct vg_error *err)
{
  s->n_point = m->n_point;
  s->n = m->n_point + m->n_tri;
  s->x = vg_alloc(s->n, sizeof *s->x);
  s->to = vg_alloc(s->n, sizeof *s->to);
  s->tri = vg_alloc(s->n, sizeof *s->tri);
  s->curve = vg_calloc(s->n_point, sizeof *s->curve);
  s->distance = vg_alloc(s->n, sizeof *s->distance);
  s->stays = vg_calloc(s->n_point, 1);
  if (!s->x || !s->to || !s->tri || !s->curve || !s->distance || !s->stays)
    return vg_fail_memory(err, "the places on the CAD model");
  return VG_OK;
}

static void take_points(struct samples *s, const struct vg_mesh *m)
{
  memcpy(s->x, m->point, s->n_point * sizeof *s->x);
}

static void take_centroids(struct samples *s, const struct vg_mesh *m)
{
  for (size_t t = 0; t < m->n_tri; t++)
    for (int d = 0; d < 3; d++)
      s->x[s->n_point + t][d] = (m->point[m->tri[t][0]][d] +
                                 m->point[m->tri[t][1]][d] +
                                 m->point[m->tri[t][2]][d]) /
                                3;
}

/* --- curves -------------------------------------------------------------- */

static int by_ends(const void *pa, const void *pb)
{
  const struct segment *a = pa, *b = pb;

  for (int k = 0; k < 2; k++)
    if (a->end[k] != b->end[k]) return a->end[k] < b->end[k] ? -1 : 1;
  return 0;
}

static vg_status list_segments(const struct vg_cad_surface *c,
                               struct segment **out, struct vg_error *err)
{
  struct segment *list = vg_alloc(c->n_segment, sizeof *list);

  if (!list) return vg_fail_memory(err, "the curves of the CAD model");
  for (size_t i = 0; i < c->n_segment; i++) {
    uint32_t a = c->segment[i][0], b = c->segment[i][1];

    list[i] = (struct segment){ { a < b ? a : b, a < b ? b : a },
                                c->segment_curve[i] };
  }
  qsort(list, c->n_segment, sizeof *list, by_ends);
  *out = list;
  return VG_OK;
}

static int is_on_edge(const double a[3], const double b[3], const double x[3])
{
  double u[3], d[3], l2, t;

  vg_sub(b, a, u);
  vg_sub(x, a, d);
  l2 = vg_dot(u, u);
  t = l2 > 0 ? fmin(fmax(vg_dot(d, u) / l2, 0), 1) : 0;
  for (int k = 0; k < 3; k++) d[k] -= t * u[k];
  return vg_dot(d, d) <= ON_EDGE * ON_EDGE * l2;
}

static void find_curves(struct samples *s, const struct vg_cad_surface *c,
                        const struct segment *list)
{
  const struct vg_mesh *m = &c->mesh;

  for (size_t p = 0; p < s->n_point; p++)
    for (int k = 0; k < 3 && !s->curve[p]; k++) {
      const uint32_t a = m->tri[s->tri[p]][k];
      const uint32_t b = m->tri[s->tri[p]][(k + 1) % 3];
      struct segment key = { { a < b ? a : b, a < b ? b : a }, 0 }, *found;

      if (!is_on_edge(m->point[a], m->point[b], s->x[p])) continue;
      found = bsearch(&key, list, c->n_segment, sizeof *list, by_ends);
      if (found) s->curve[p] = found->curve;
    }
}

/* --- positions on the model ---------------------------------------------- */

/* Projects the samples on curves, or all others. */
static vg_status ask(struct samples *s, struct vg_cad *cad, struct range of_all,
                     int on_curves, struct vg_error *err)
{
  const size_t most = of_all.end - of_all.first;
  uint32_t *number = vg_alloc(most, sizeof *number);
  size_t *of = vg_alloc(most, sizeof *of), n = 0;
  double(*x)[3] = vg_alloc(most, sizeof *x);
  double *far = vg_alloc(most, sizeof *far);
  vg_status st = VG_OK;

  if (!number || !of || !x || !far)
    VG_TRY(vg_fail_memory(err, "the places on the CAD model"));
  for (size_t i = of_all.first; i < of_all.end; i++) {
    uint32_t curve = i < s->n_point ? s->curve[i] : 0;

    if ((curve > 0) != on_curves || !(s->distance[i] < INFINITY)) continue;
    number[n] = on_curves ? curve : s->tri[i];
    memcpy(x[n], s->x[i], sizeof *x);
    of[n++] = i;
  }
  VG_TRY(vg_cad_project(cad, on_curves ? VG_CAD_ON_CURVES : VG_CAD_ON_TRIANGLES,
                        n, number, x, far, err));
  for (size_t i = 0; i < n; i++) {
    memcpy(s->to[of[i]], x[i], sizeof *x);
    s->distance[of[i]] = far[i];
  }
done:
  free(number);
  free(of);
  free(x);
  free(far);
  return st;
}

static int by_value(const void *pa, const void *pb)
{
  const double *a = pa, *b = pb;

  return (*a > *b) - (*a < *b);
}

static vg_status summarise(const struct samples *s, size_t end,
                           struct vg_remesh_distance *d, struct vg_error *err)
{
  double *sorted = vg_alloc(end, sizeof *sorted);
  size_t n = 0;

  if (!sorted) return vg_fail_memory(err, "the distances");
  memset(d, 0, sizeof *d);
  for (size_t i = 0; i < end; i++) {
    if (!(s->distance[i] < INFINITY)) continue;
    sorted[n++] = s->distance[i];
    if (!(s->distance[i] > d->most)) continue;
    d->most = s->distance[i];
    memcpy(d->at, s->x[i], sizeof d->at);
  }
  qsort(sorted, n, sizeof *sorted, by_value);
  if (n) d->most_99 = sorted[n - 1 - n / 100];
  free(sorted);
  return VG_OK;
}

/* Finds the triangle and curve of each sample. A sample farther than `limit`
 * from all triangles is not part of the model. */
static vg_status locate(struct samples *s, const struct vg_boundary *b,
                        double limit, const struct vg_stop *stop,
                        struct vg_error *err)
{
  const struct vg_cad_surface *c = &b->model.surface;
  struct segment *list = NULL;
  vg_status st;

  VG_TRY(vg_remesh_locate(&c->mesh, s->n, (const double(*)[3])s->x, b->threads,
                          stop, s->tri, s->to, err));
  for (size_t i = 0; i < s->n; i++)
    s->distance[i] = vg_distance(s->x[i], s->to[i]) <= limit ? 0 : INFINITY;
  VG_TRY(list_segments(c, &list, err));
  find_curves(s, c, list);
done:
  free(list);
  return st;
}

/* Finds the positions of the points on the model. */
static vg_status find_places(struct samples *s, struct vg_cad *cad,
                             struct vg_remesh_distance *d, struct vg_error *err)
{
  const struct range points = { 0, s->n_point };
  vg_status st;

  VG_TRY(ask(s, cad, points, 0, err));
  VG_TRY(ask(s, cad, points, 1, err));
  VG_TRY(summarise(s, points.end, d, err));
done:
  return st;
}

/* Distances of the surface after the projection. Points that were not moved
 * keep their distance, and a triangle has a position if all its points have
 * one. */
static vg_status measure(struct samples *s, const struct vg_mesh *m,
                         struct vg_cad *cad, struct vg_remesh_distance *d,
                         struct vg_error *err)
{
  vg_status st;

  for (size_t p = 0; p < s->n_point; p++)
    if (!s->stays[p]) s->distance[p] = 0;
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t *v = m->tri[t];

    s->distance[s->n_point + t] = fmax(s->distance[v[0]],
                                       fmax(s->distance[v[1]],
                                            s->distance[v[2]]));
  }
  take_points(s, m);
  take_centroids(s, m);
  VG_TRY(ask(s, cad, (struct range){ s->n_point, s->n }, 0, err));
  VG_TRY(summarise(s, s->n, d, err));
done:
  return st;
}

/* --- entry point --------------------------------------------------------- */

/* The model has no caps over its holes: points inside caps are not moved and do
 * not count, with distance INFINITY. */
static void leave_caps(struct samples *s, const struct vg_boundary *b,
                       struct vg_put_back *back)
{
  const struct vg_mesh *m = &b->surface;

  if (!b->n_given_patch) return;
  memset(s->stays, 1, s->n_point);
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && !vg_boundary_is_cap(b, m->tri_patch[t]); k++)
      s->stays[m->tri[t][k]] = 0;
  for (size_t i = 0; i < s->n_point; i++)
    if (s->stays[i]) {
      s->distance[i] = INFINITY;
      back->n_cap++;
    }
}

static vg_status move(struct vg_boundary *b, struct samples *s,
                      struct vg_put_back *back, const struct vg_stop *stop,
                      struct vg_error *err)
{
  for (size_t i = 0; i < s->n_point; i++) {
    if (!(s->distance[i] < INFINITY) && !s->stays[i]) back->n_far++;
    if (s->curve[i]) back->n_curve++;
    s->stays[i] = !(s->distance[i] < INFINITY);
  }
  back->n_point = s->n_point - back->n_cap;
  return vg_remesh_put_back(&b->surface, (const double(*)[3])s->to, b->threads,
                            stop, s->stays, &back->n_refused, err);
}

/* Largest distance of the samples of each triangle that has a position. */
static void by_face(const struct samples *s, const struct vg_mesh *m,
                    double *face)
{
  for (size_t t = 0; t < m->n_tri; t++) {
    double most = s->distance[s->n_point + t];

    for (int k = 0; k < 3; k++) most = fmax(most, s->distance[m->tri[t][k]]);
    if (most < INFINITY) face[t] = most;
  }
}

vg_status vg_boundary_put_back(struct vg_boundary *b, struct vg_display *show,
                               struct vg_error *err)
{
  const struct vg_stop stop = { vg_display_stop, show };
  struct vg_remeshing *r = &b->remeshing;
  struct vg_put_back *back = &r->back;
  struct samples s = { 0 };
  double t = vg_display_now();
  vg_status st;

  VG_TRY(start(&s, &b->surface, err));
  take_points(&s, &b->surface);
  take_centroids(&s, &b->surface);
  VG_TRY(locate(&s, b, r->report.tolerance, &stop, err));
  leave_caps(&s, b, back);
  VG_TRY(find_places(&s, b->model.cad, &back->off[0], err));
  VG_TRY(move(b, &s, back, &stop, err));
  VG_TRY(measure(&s, &b->surface, b->model.cad, &back->off[1], err));
  by_face(&s, &b->surface, r->face);
  back->seconds = vg_display_now() - t;
  back->is_done = 1;
  vg_note(
    b->notes,
    "points projected onto the CAD model: %zu, %zu of them onto its curves; "
    "largest distance from the model before: %.3g; centroids of the flat "
    "triangles are still up to %.3g away; points not projected, because "
    "triangles would fold or intersect: %zu",
    back->n_point - back->n_far - back->n_refused, back->n_curve,
    back->off[0].most, back->off[1].most, back->n_refused);
  if (back->n_far)
    vg_note(b->notes,
            "%zu points are farther than %.3g from the CAD model and were not "
            "moved",
            back->n_far, r->report.tolerance);
done:
  release(&s);
  return st;
}
