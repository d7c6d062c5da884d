/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/farfield.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/farfield_parts.h"
#include "core/domain/planar.h"
#include "core/geometry/graded.h"

void vg_border_release(struct vg_border *r)
{
  free(r->edge);
  memset(r, 0, sizeof *r);
}

vg_status vg_border_add(struct vg_border *r, uint32_t a, uint32_t b,
                        struct vg_error *err)
{
  assert(r && a != b);
  if (vg_reserve(&r->edge, &r->cap, r->n + 1, sizeof *r->edge))
    return vg_fail_memory(err, "the rim of a patch");
  r->edge[r->n][0] = a;
  r->edge[r->n++][1] = b;
  return VG_OK;
}

vg_status vg_farfield_points(struct vg_mesh *m, size_t n, struct vg_error *err)
{
  double(*point)[3];

  if (n > UINT32_MAX - 1 - m->n_point)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "surface: too many points");
  point = vg_realloc(m->point, m->n_point + n, sizeof *point);
  if (!point) return vg_fail_memory(err, "the farfield");
  m->point = point;
  return VG_OK;
}

vg_status vg_farfield_divide(double len, double (*size)(void *user, double s),
                             void *user, const struct vg_size_function *law,
                             size_t least, size_t *n, double **s,
                             struct vg_error *err)
{
  vg_status st = vg_graded_steps(len, size, user, least, n, s, err);

  if (st < 0 && vg_stops(&law->stop))
    st = vg_fail(err, VG_ERR_STOPPED, "interrupted");
  return st;
}

void vg_on_circle(double turn, double p[2])
{
  const int quarter = turn < 4 ? (int)turn : 0;
  double s, c;

  assert(turn >= 0 && turn <= 4);
  vg_quarter_turn(turn < 4 ? turn - quarter : 0, &s, &c);
  p[0] = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
  p[1] = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
}

vg_status vg_farfield_chart(struct vg_mesh *m, const struct vg_chart *chart,
                            size_t n, const double (*loop)[2],
                            const uint32_t *id, int swap, uint32_t patch,
                            struct vg_error *err)
{
  size_t n_new = 0, n_tri = 0;
  double(*add)[2] = NULL;
  uint32_t(*edge)[2] = vg_alloc(n, sizeof *edge), (*tri)[3] = NULL;
  uint32_t(*list)[3], *of, base;
  vg_status st = VG_OK;

  if (!edge) {
    st = vg_fail_memory(err, "the farfield");
    goto done;
  }
  for (uint32_t i = 0; i < n; i++) {
    edge[i][0] = i;
    edge[i][1] = i + 1 < n ? i + 1 : 0;
  }
  VG_TRY(vg_planar_mesh(n, loop, n, (const uint32_t(*)[2])edge, &chart->law,
                        &n_new, &add, &n_tri, &tri, err));
  VG_TRY(vg_farfield_points(m, n_new, err));
  list = vg_realloc(m->tri, m->n_tri + n_tri, sizeof *list);
  if (list) m->tri = list;
  of = vg_realloc(m->tri_patch, m->n_tri + n_tri, sizeof *of);
  if (of) m->tri_patch = of;
  if (!list || !of) {
    st = vg_fail_memory(err, "the farfield");
    goto done;
  }
  base = (uint32_t)m->n_point;
  for (size_t i = 0; i < n_new; i++)
    chart->to_space(chart->law.user, add[i], m->point[base + i]);
  for (size_t i = 0; i < n_tri; i++) {
    for (int k = 0; k < 3; k++) {
      const uint32_t v = tri[i][swap && k ? 3 - k : k];

      list[m->n_tri + i][k] = v < n ? id[v] : base + (v - (uint32_t)n);
    }
    of[m->n_tri + i] = patch;
  }
  m->n_point += n_new;
  m->n_tri += n_tri;
done:
  free(edge);
  free(add);
  free(tri);
  return st;
}

/* --- sphere ---------------------------------------------------------------
 * A half sphere is the stereographic image of the unit disc. The map is
 * conformal and maps circles to circles. A good Delaunay triangulation of the
 * disc, with sizes divided by the local scale, is therefore a good one of the
 * half sphere. */

struct half_sphere {
  const double *centre;
  double radius;
  int axis, iu, iv, side; /* Side: +1 or -1. */
  const struct vg_size_function *size;
};

static void to_sphere(void *user, const double p[2], double x[3])
{
  const struct half_sphere *s = user;
  const double rr = p[0] * p[0] + p[1] * p[1], f = s->radius / (1 + rr);

  x[s->axis] = s->centre[s->axis] + s->side * f * (1 - rr);
  x[s->iu] = s->centre[s->iu] + 2 * f * p[0];
  x[s->iv] = s->centre[s->iv] + 2 * f * p[1];
}

static double size_on_disc(void *user, const double p[2])
{
  const struct half_sphere *s = user;
  double x[3];

  to_sphere((void *)s, p, x);
  return s->size->at(s->size->user, x) * (1 + p[0] * p[0] + p[1] * p[1]) /
         (2 * s->radius);
}

static double size_on_circle(void *user, double turn)
{
  const struct half_sphere *s = user;
  double p[2], x[3];

  if (vg_stops(&s->size->stop)) return 0;
  vg_on_circle(turn, p);
  to_sphere((void *)s, p, x);
  return s->size->at(s->size->user, x) / (s->radius * 1.57079632679489662);
}

/* Add the equator, counter-clockwise about +axis: points first .. first + n -
 * 1. */
static vg_status add_equator(struct vg_mesh *m, const struct half_sphere *s,
                             double (**disc)[2], size_t *n,
                             struct vg_error *err)
{
  double *turn = NULL;
  vg_status st;

  VG_TRY(vg_farfield_divide(4, size_on_circle, (void *)s, s->size, 8, n, &turn,
                            err));
  *disc = vg_alloc(*n, sizeof **disc);
  if (!*disc) {
    st = vg_fail_memory(err, "the farfield");
    goto done;
  }
  VG_TRY(vg_farfield_points(m, *n, err));
  for (size_t i = 0; i < *n; i++) {
    double *x = m->point[m->n_point++];

    vg_on_circle(turn[i], (*disc)[i]);
    to_sphere((void *)s, (*disc)[i], x);
    x[s->axis] = s->centre[s->axis];
  }
done:
  free(turn);
  return st;
}

static vg_status add_half(struct vg_mesh *m, const struct half_sphere *s,
                          size_t n, const double (*disc)[2], uint32_t first,
                          int inward, uint32_t patch, struct vg_error *err)
{
  const struct vg_chart chart = {
    { .at = size_on_disc, .user = (void *)s, .stop = s->size->stop }, to_sphere
  };
  const int swap = inward ? s->side > 0 : s->side < 0;
  uint32_t *id = vg_alloc(n, sizeof *id);
  vg_status st;

  if (!id) return vg_fail_memory(err, "the farfield");
  for (size_t i = 0; i < n; i++) id[i] = first + (uint32_t)i;
  st = vg_farfield_chart(m, &chart, n, disc, id, swap, patch, err);
  free(id);
  return st;
}

vg_status vg_add_sphere(struct vg_mesh *m, const double centre[3],
                        double radius, int half, int inward,
                        const struct vg_size_function *size, uint32_t patch,
                        struct vg_border *border, struct vg_error *err)
{
  assert(radius > 0 && half >= -1 && half < 6);
  assert(patch < m->n_patch && (border || half < 0));

  const int axis = half < 0 ? 2 : half / 2;
  const uint32_t first = (uint32_t)m->n_point;
  struct half_sphere s = { centre,
                           radius,
                           axis,
                           (axis + 1) % 3,
                           (axis + 2) % 3,
                           half >= 0 && half % 2 == 0 ? -1 : 1,
                           size };
  double(*disc)[2] = NULL;
  size_t n = 0;
  vg_status st;

  VG_TRY(add_equator(m, &s, &disc, &n, err));
  VG_TRY(
    add_half(m, &s, n, (const double(*)[2])disc, first, inward, patch, err));
  if (half < 0) {
    s.side = -s.side;
    st = add_half(m, &s, n, (const double(*)[2])disc, first, inward, patch,
                  err);
    goto done;
  }
  for (uint32_t i = 0; i < n; i++) {
    const uint32_t a = first + i, b = first + (i + 1 < n ? i + 1 : 0);
    const int back = inward ? s.side < 0 : s.side > 0;

    VG_TRY(vg_border_add(border, back ? b : a, back ? a : b, err));
  }
done:
  free(disc);
  return st;
}

/* --- box ----------------------------------------------------------------- */

struct line {
  const double *a;
  double len;
  int axis;
  const struct vg_size_function *size;
};

static double size_on_line(void *user, double s)
{
  const struct line *l = user;
  double x[3] = { l->a[0], l->a[1], l->a[2] };

  if (vg_stops(&l->size->stop)) return 0;
  x[l->axis] += s;
  return l->size->at(l->size->user, x);
}

/* Points of one edge of the box from corner a along `axis`, including its
 * ends. */
struct box_edge {
  size_t n;
  uint32_t *point;
};

static vg_status add_edge(struct vg_mesh *m, uint32_t a, uint32_t b, int axis,
                          const struct vg_size_function *size,
                          struct box_edge *e, struct vg_error *err)
{
  double from[3];
  struct line l = { from, m->point[b][axis] - m->point[a][axis], axis, size };
  double *s = NULL;
  size_t n = 0;
  vg_status st;

  memcpy(from, m->point[a], sizeof from);
  VG_TRY(vg_farfield_divide(l.len, size_on_line, &l, size, 1, &n, &s, err));
  e->point = vg_alloc(n + 1, sizeof *e->point);
  if (!e->point) {
    st = vg_fail_memory(err, "the farfield");
    goto done;
  }
  VG_TRY(vg_farfield_points(m, n, err));
  e->n = n + 1;
  e->point[0] = a;
  e->point[n] = b;
  for (size_t i = 1; i < n; i++) {
    e->point[i] = (uint32_t)m->n_point;
    memcpy(m->point[m->n_point], from, sizeof from);
    m->point[m->n_point++][axis] += s[i];
  }
done:
  free(s);
  return st;
}

/* Corner c has the upper bound in axis k if bit k is set. The edge from corner
 * c along axis k (bit k of c clear) has number 4 k + rest, where rest consists
 * of the other two bits of c, lower axis first. */
static int edge_number(int c, int k)
{
  const int a = k == 0 ? 1 : 0, b = k == 2 ? 1 : 2;

  return 4 * k + (c >> a & 1) + 2 * (c >> b & 1);
}

static vg_status walk_edge(struct vg_border *r, const struct box_edge *e,
                           int back, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; st == VG_OK && i + 1 < e->n; i++)
    st = back ? vg_border_add(r, e->point[i + 1], e->point[i], err)
              : vg_border_add(r, e->point[i], e->point[i + 1], err);
  return st;
}

/* Append the loop around face 2 * axis + side, counter-clockwise as seen from
 * inside. */
static vg_status face_loop(struct vg_border *r, const struct box_edge edge[12],
                           int face, struct vg_error *err)
{
  const int k = face / 2, u = (k + 1) % 3, v = (k + 2) % 3;
  const int base = face % 2 ? 1 << k : 0, up = face % 2;
  vg_status st;

  /* u, then v, turns counter-clockwise about +k, as seen from inside at a lower
   * face; the loop of an upper face runs the other way. */
  VG_TRY(walk_edge(r, &edge[edge_number(base, u)], up, err));
  VG_TRY(walk_edge(r, &edge[edge_number(base | 1 << u, v)], up, err));
  VG_TRY(walk_edge(r, &edge[edge_number(base | 1 << v, u)], !up, err));
  VG_TRY(walk_edge(r, &edge[edge_number(base, v)], !up, err));
done:
  return st;
}

vg_status vg_add_box(struct vg_mesh *m, const double lo[3], const double hi[3],
                     int open, const struct vg_size_function *size,
                     const uint32_t patch[6], struct vg_border *border,
                     struct vg_error *err)
{
  assert(lo[0] < hi[0] && lo[1] < hi[1] && lo[2] < hi[2]);
  assert(open >= -1 && open < 6 && (border || open < 0));

  const uint32_t first = (uint32_t)m->n_point;
  struct box_edge edge[12] = { { 0 } };
  struct vg_border loop = VG_BORDER_INIT;
  vg_status st;

  VG_TRY(vg_farfield_points(m, 8, err));
  for (int c = 0; c < 8; c++) {
    for (int k = 0; k < 3; k++)
      m->point[m->n_point][k] = c >> k & 1 ? hi[k] : lo[k];
    m->n_point++;
  }
  for (uint32_t c = 0; c < 8; c++)
    for (int k = 0; k < 3; k++)
      if (!(c >> k & 1))
        VG_TRY(add_edge(m, first + c, first + (c | 1u << k), k, size,
                        &edge[edge_number((int)c, k)], err));
  for (int face = 0; face < 6; face++) {
    loop.n = 0;
    VG_TRY(face_loop(&loop, edge, face, err));
    for (size_t i = 0; face == open && i < loop.n; i++)
      VG_TRY(vg_border_add(border, loop.edge[i][0], loop.edge[i][1], err));
    if (face != open)
      VG_TRY(vg_planar_patch(m, loop.n, (const uint32_t(*)[2])loop.edge, size,
                             patch[face], err));
  }
done:
  for (int i = 0; i < 12; i++) free(edge[i].point);
  vg_border_release(&loop);
  return st;
}
