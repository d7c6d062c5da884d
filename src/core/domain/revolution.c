/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Each line of the profile, revolved by half a turn, is a chart: a half disc, a
 * sector of an unrolled cone, or a rectangle. Charts share the points of
 * circles ("rims") at the corners of the profile and of the profile itself
 * ("seams"), at turns 0 and 2 in quarters of the circle. */
#include "core/domain/revolution.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/farfield_parts.h"
#include "core/geometry/vector.h"

#define RIGHT_ANGLE 1.57079632679489661923
/* Smallest ratio of radius to slant for which a line is unrolled as a cone. */
#define CONE_LEAST 1e-3

enum { LEAST_STEPS = 4 }; /* of half a rim */

/* --- frame ---------------------------------------------------------------- */

void vg_revolution_frame(struct vg_revolution *r, int half)
{
  int k = half / 2;
  double len, along;

  assert(half >= -1 && half < 6 && (half < 0 || r->axis[half / 2] == 0));
  r->half = half;
  if (half < 0) {
    k = fabs(r->axis[1]) <= fabs(r->axis[2]) ? 1 : 2;
    if (fabs(r->axis[0]) < fabs(r->axis[k])) k = 0;
  }
  for (int i = 0; i < 3; i++) r->v[i] = 0;
  r->v[k] = half >= 0 && half % 2 == 0 ? -1 : 1;
  along = vg_dot(r->v, r->axis);
  if (along != 0) {
    for (int i = 0; i < 3; i++) r->v[i] -= along * r->axis[i];
    len = sqrt(vg_dot(r->v, r->v));
    for (int i = 0; i < 3; i++) r->v[i] /= len;
  }
  vg_cross(r->v, r->axis, r->u);
}

void vg_revolution_locate(const struct vg_revolution *r, const double x[3],
                          double *z, double *radius)
{
  double d[3];

  vg_sub(x, r->origin, d);
  *z = vg_dot(d, r->axis);
  for (int k = 0; k < 3; k++) d[k] -= *z * r->axis[k];
  *radius = sqrt(vg_dot(d, d));
}

static void to_space(const struct vg_revolution *r, double z, double radius,
                     double turn, double x[3])
{
  const int on_plane = turn == 0 || turn == 2 || turn == 4;
  double c[2];

  vg_on_circle(turn, c);
  for (int k = 0; k < 3; k++)
    x[k] = r->origin[k] + z * r->axis[k] +
           radius * (c[0] * r->u[k] + c[1] * r->v[k]);
  if (r->half >= 0 && (on_plane || radius == 0))
    x[r->half / 2] = r->origin[r->half / 2];
}

/* --- curves --------------------------------------------------------------- */

/* Points of a rim or seam, both ends included. */
struct curve {
  size_t n;
  uint32_t *point;
  double *at; /* Turn of a rim; fraction of the line of a seam. */
};

struct surface {
  struct vg_mesh *m;
  const struct vg_revolution *shape;
  const struct vg_size_function *size;
  int n_half;
  struct curve (*rim)[2];  /* [n] turns 0 to 2 and 2 to 4. */
  struct curve (*seam)[2]; /* [n - 1] at turns 0 and 2. */
};

/* The curve whose size is asked for. */
struct on_curve {
  const struct surface *s;
  size_t corner; /* First corner of a seam. */
  double turn;   /* Turn of a seam; first turn of a rim. */
  double len;    /* Of a seam. */
};

static double size_at(const struct surface *s, const double x[3])
{
  return vg_stops(&s->size->stop) ? 0 : s->size->at(s->size->user, x);
}

static double size_on_rim(void *user, double turn)
{
  const struct on_curve *c = user;
  const double *p = c->s->shape->profile[c->corner];
  double x[3];

  to_space(c->s->shape, p[0], p[1], c->turn + turn, x);
  return size_at(c->s, x) / (p[1] * RIGHT_ANGLE);
}

static void on_seam(const struct on_curve *c, double t, double x[3])
{
  const double(*p)[2] = c->s->shape->profile + c->corner;

  to_space(c->s->shape, p[0][0] + t * (p[1][0] - p[0][0]),
           p[0][1] + t * (p[1][1] - p[0][1]), c->turn, x);
}

static double size_on_seam(void *user, double along)
{
  const struct on_curve *c = user;
  double x[3];

  on_seam(c, along / c->len, x);
  return size_at(c->s, x);
}

static vg_status make_room(struct curve *c, size_t n, struct vg_error *err)
{
  c->n = n;
  c->point = vg_alloc(n, sizeof *c->point);
  if (!c->at) c->at = vg_calloc(n, sizeof *c->at);
  return c->point && c->at ? VG_OK : vg_fail_memory(err, "the farfield");
}

/* The point of the profile's corner i on the axis, as curves of one point. */
static vg_status add_pole(struct surface *s, size_t i, struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_farfield_points(s->m, 1, err));
  to_space(s->shape, s->shape->profile[i][0], 0, 0, s->m->point[s->m->n_point]);
  for (int h = 0; h < s->n_half; h++) {
    VG_TRY(make_room(&s->rim[i][h], 1, err));
    s->rim[i][h].point[0] = (uint32_t)s->m->n_point;
  }
  s->m->n_point++;
done:
  return st;
}

/* Add half h of the rim at corner i. The second half ends in the first point
 * of the first half. */
static vg_status add_rim(struct surface *s, size_t i, int h,
                         struct vg_error *err)
{
  const double *p = s->shape->profile[i];
  struct on_curve on = { s, i, 2 * h, 0 };
  struct curve *c = &s->rim[i][h];
  size_t n;
  vg_status st;

  VG_TRY(vg_farfield_divide(2, size_on_rim, &on, s->size, LEAST_STEPS, &n,
                            &c->at, err));
  VG_TRY(make_room(c, n + 1, err));
  VG_TRY(vg_farfield_points(s->m, n + 1, err));
  for (size_t j = 0; j <= n; j++) {
    c->at[j] = j < n ? c->at[j] : 2;
    if (h && (j == 0 || j == n)) {
      const struct curve *first = &s->rim[i][0];

      c->point[j] = first->point[j ? 0 : first->n - 1];
      continue;
    }
    c->point[j] = (uint32_t)s->m->n_point;
    to_space(s->shape, p[0], p[1], 2 * h + c->at[j],
             s->m->point[s->m->n_point++]);
  }
done:
  return st;
}

/* Add the seam from corner i to the next one, at turn 0 (side 0) or 2. */
static vg_status add_seam(struct surface *s, size_t i, int side,
                          struct vg_error *err)
{
  const double(*p)[2] = s->shape->profile + i;
  const double dz = p[1][0] - p[0][0], dr = p[1][1] - p[0][1];
  struct on_curve on = { s, i, 2 * side, sqrt(dz * dz + dr * dr) };
  const struct curve *from = &s->rim[i][0], *to = &s->rim[i + 1][0];
  struct curve *c = &s->seam[i][side];
  size_t n;
  vg_status st;

  VG_TRY(
    vg_farfield_divide(on.len, size_on_seam, &on, s->size, 1, &n, &c->at, err));
  VG_TRY(make_room(c, n + 1, err));
  VG_TRY(vg_farfield_points(s->m, n, err));
  for (size_t j = 0; j <= n; j++) {
    c->at[j] = j < n ? c->at[j] / on.len : 1;
    if (j == 0) c->point[j] = from->point[side ? from->n - 1 : 0];
    else if (j == n) c->point[j] = to->point[side ? to->n - 1 : 0];
    else {
      c->point[j] = (uint32_t)s->m->n_point;
      on_seam(&on, c->at[j], s->m->point[s->m->n_point++]);
    }
  }
done:
  return st;
}

static vg_status add_curves(struct surface *s, struct vg_error *err)
{
  const size_t n = s->shape->n;
  vg_status st = VG_OK;

  for (size_t i = 0; i < n; i++)
    if (s->shape->profile[i][1] == 0) VG_TRY(add_pole(s, i, err));
    else
      for (int h = 0; h < s->n_half; h++) VG_TRY(add_rim(s, i, h, err));
  for (size_t i = 0; i + 1 < n; i++)
    for (int side = 0; side < 2; side++) VG_TRY(add_seam(s, i, side, err));
done:
  return st;
}

/* --- charts --------------------------------------------------------------- */

/* One line of the profile, revolved by half a turn from turn 2 h. */
struct sheet {
  const struct surface *s;
  int h;
  double z0, r0, dz, dr, len;
  double sine; /* Of the angle between line and axis; 0: unrolled as a
                  cylinder. */
};

static struct sheet sheet_of(const struct surface *s, size_t i, int h)
{
  const double(*p)[2] = s->shape->profile + i;
  struct sheet c = {
    s, h, p[0][0], p[0][1], p[1][0] - p[0][0], p[1][1] - p[0][1], 0, 0
  };

  c.len = sqrt(c.dz * c.dz + c.dr * c.dr);
  c.sine = fabs(c.dr) / c.len;
  if (c.sine < CONE_LEAST) c.sine = 0;
  return c;
}

/* Point of the plane for a fraction t of the line and a turn in 0..2. A line
 * that approaches the axis is mirrored, so that line and turn always have the
 * orientation of the plane's axes. */
static void to_plane(const struct sheet *c, double t, double turn, double p[2])
{
  const double r = c->r0 + t * c->dr;

  if (c->sine == 0) {
    p[0] = t * c->len;
    p[1] = turn * RIGHT_ANGLE * (c->r0 + 0.5 * c->dr);
    return;
  }
  vg_on_circle(turn * c->sine, p);
  p[0] *= r / c->sine;
  p[1] *= c->dr > 0 ? r / c->sine : -r / c->sine;
}

/* The turn in 0..2 of a unit vector in the upper half plane, by Newton's method
 * with a cubic arcsine. The first value is off by less than 0.05. */
static double turn_of(const double d[2])
{
  double turn = d[0] >= 0 ? d[1] / (d[0] + d[1]) : 1 - d[0] / (d[1] - d[0]);

  for (int i = 0; i < 2; i++) {
    double c[2], sine;

    vg_on_circle(turn, c);
    sine = c[0] * d[1] - c[1] * d[0];
    turn += sine * (1 + sine * sine / 6) / RIGHT_ANGLE;
    turn = turn < 0 ? 0 : turn > 2 ? 2 : turn;
  }
  return turn;
}

static void from_plane(void *user, const double p[2], double x[3])
{
  const struct sheet *c = user;
  double t, turn;

  if (c->sine == 0) {
    t = p[0] / c->len;
    turn = p[1] / (RIGHT_ANGLE * (c->r0 + 0.5 * c->dr));
  } else {
    const double far = sqrt(p[0] * p[0] + p[1] * p[1]);
    const double up = c->dr > 0 ? p[1] : -p[1];
    const double d[2] = { far > 0 ? p[0] / far : 1,
                          far > 0 && up > 0 ? up / far : 0 };

    t = (far * c->sine - c->r0) / c->dr;
    turn = turn_of(d) / c->sine;
  }
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  turn = turn < 0 ? 0 : turn > 2 ? 2 : turn;
  to_space(c->s->shape, c->z0 + t * c->dz, c->r0 + t * c->dr, 2 * c->h + turn,
           x);
}

static double size_in_plane(void *user, const double p[2])
{
  const struct sheet *c = user;
  double x[3];

  from_plane(user, p, x);
  return c->s->size->at(c->s->size->user, x);
}

struct loop {
  size_t n;
  double (*p)[2];
  uint32_t *id;
};

static void put(struct loop *l, const struct sheet *c, double t, double turn,
                uint32_t point)
{
  to_plane(c, t, turn, l->p[l->n]);
  l->id[l->n++] = point;
}

/* The loop runs along the profile and back, counter-clockwise in the plane. */
static vg_status add_sheet(struct surface *s, size_t i, int h, uint32_t patch,
                           struct vg_error *err)
{
  const struct curve *out = &s->seam[i][h], *back = &s->seam[i][!h];
  const struct curve *rim0 = &s->rim[i][h], *rim1 = &s->rim[i + 1][h];
  const size_t room = out->n + back->n + rim0->n + rim1->n;
  struct sheet c = sheet_of(s, i, h);
  const struct vg_chart chart = {
    { .at = size_in_plane, .user = &c, .stop = s->size->stop }, from_plane
  };
  struct loop l = { 0, vg_alloc(room, sizeof *l.p),
                    vg_alloc(room, sizeof *l.id) };
  vg_status st = VG_OK;

  if (!l.p || !l.id) {
    st = vg_fail_memory(err, "the farfield");
    goto done;
  }
  for (size_t j = 0; j + 1 < out->n; j++)
    put(&l, &c, out->at[j], 0, out->point[j]);
  for (size_t j = 0; j + 1 < rim1->n; j++)
    put(&l, &c, 1, rim1->at[j], rim1->point[j]);
  for (size_t j = back->n; j-- > 1;)
    put(&l, &c, back->at[j], 2, back->point[j]);
  for (size_t j = rim0->n; j-- > 1;)
    put(&l, &c, 0, rim0->at[j], rim0->point[j]);
  VG_TRY(vg_farfield_chart(s->m, &chart, l.n, (const double(*)[2])l.p, l.id, 0,
                           patch, err));
done:
  free(l.p);
  free(l.id);
  return st;
}

/* --- surface -------------------------------------------------------------- */

/* The sheets run up the seam at turn 0 and down that at turn 2; the closing
 * surface runs the other way. */
static vg_status add_border(const struct surface *s, struct vg_border *border,
                            struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i + 1 < s->shape->n; i++)
    for (int side = 0; side < 2; side++) {
      const struct curve *c = &s->seam[i][side];

      for (size_t j = 0; j + 1 < c->n; j++)
        VG_TRY(vg_border_add(border, c->point[side ? j : j + 1],
                             c->point[side ? j + 1 : j], err));
    }
done:
  return st;
}

static void release(struct surface *s)
{
  for (size_t i = 0; i < s->shape->n; i++)
    for (int k = 0; k < 2; k++) {
      if (s->rim) free(s->rim[i][k].point);
      if (s->rim) free(s->rim[i][k].at);
      if (s->seam) free(s->seam[i][k].point);
      if (s->seam) free(s->seam[i][k].at);
    }
  free(s->rim);
  free(s->seam);
}

vg_status vg_add_revolution(struct vg_mesh *m, const struct vg_revolution *r,
                            const struct vg_size_function *size, uint32_t patch,
                            struct vg_border *border, struct vg_error *err)
{
  assert(r->n >= 3 && r->profile[0][1] == 0 && r->profile[r->n - 1][1] == 0);
  assert(patch < m->n_patch && (border || r->half < 0));

  struct surface s = { m,
                       r,
                       size,
                       r->half < 0 ? 2 : 1,
                       vg_calloc(r->n, sizeof *s.rim),
                       vg_calloc(r->n, sizeof *s.seam) };
  const size_t n_tri = m->n_tri;
  vg_status st = VG_OK;

  if (!s.rim || !s.seam) {
    st = vg_fail_memory(err, "the farfield");
    goto done;
  }
  VG_TRY(add_curves(&s, err));
  for (size_t i = 0; i + 1 < r->n; i++)
    for (int h = 0; h < s.n_half; h++) VG_TRY(add_sheet(&s, i, h, patch, err));
  if (r->half >= 0) VG_TRY(add_border(&s, border, err));
done:
  if (st < 0) m->n_tri = n_tri;
  release(&s);
  return st;
}
