/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A passage of a turbine: one blade in a sector of an annulus about the x axis,
 * with a gap at the casing. The flow enters along the axis and leaves at 45
 * degrees; the sides follow the camber line, half a pitch off.
 *
 * Cylindrical coordinates are (x, angle, r): y = r sin(angle), z = r
 * cos(angle). Each face that is not plane is unrolled into a plane, where the
 * plane mesher makes triangles of the local spacing; the lengths there are true
 * within the ratio of the radii. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/examples/demo_parts.h"
#include "core/domain/planar.h"
#include "core/geometry/graded.h"

/* Lengths in axial chords. The blade is at 0 <= x <= 1. */
#define X_IN (-0.6)
#define X_OUT 1.6
#define R_HUB 2.5
#define R_MEAN 2.8
#define R_CASING 3.1
#define GAP 0.03
#define R_TIP (R_CASING - GAP)
#define N_BLADE 22
#define THICK 0.18 /* of the blade, across the camber line */
#define SLIM 0.3   /* part of that which is lost to the trailing edge */
#define HALF_PI 1.57079632679489661923
#define HALF_PITCH (2 * HALF_PI / N_BLADE) /* angle */

/* Spacings at factor 1, and the largest ones that resolve the edges of the
 * blade and the gap. */
#define H_NOSE 0.008
#define H_TAIL 0.006
#define H_TIP 0.012
#define H_FIELD 0.06
#define H_NOSE_MAX 0.014
#define H_TAIL_MAX 0.01
#define H_TIP_MAX 0.03
#define H_FIELD_MAX 0.15

enum { N_TABLE = 4096 }; /* intervals along curves */
enum { N_TIP = 4 };      /* sources along the tip */

enum { HUB, CASING, BLADE, TIP, INFLOW, OUTFLOW, LO, HI };

static double least(double a, double b)
{
  return a < b ? a : b;
}

/* Angle of the camber line, which has the slopes 0 ahead of the blade and 1
 * behind it at the mean radius. */
static double camber(double x)
{
  return (x <= 0 ? 0 : x < 1 ? 0.5 * x * x : x - 0.5) / R_MEAN;
}

/* Sine and cosine of an angle of less than a quarter turn. */
static void turn(double angle, double *sine, double *cosine)
{
  vg_quarter_turn(fabs(angle) / HALF_PI, sine, cosine);
  if (angle < 0) *sine = -*sine;
}

static void to_space(const double q[3], double x[3])
{
  double sine, cosine;

  turn(q[1], &sine, &cosine);
  x[0] = q[0];
  x[1] = q[2] * sine;
  x[2] = q[2] * cosine;
}

/* Half of the blade's thickness at x, over the mean radius: an angle. side: the
 * sine of the angle that is 0 at the trailing and 180 degrees at the leading
 * edge. */
static double half_thickness(double x, double side)
{
  return 0.5 * THICK * side * (1 - SLIM * x) / R_MEAN;
}

static void put_source(struct vg_demo_spacing *law, const double p[3],
                       const double q[3], double h, double r)
{
  struct vg_source *s = &law->source[law->n++];

  s->kind = VG_SOURCE_LINE;
  to_space(p, s->p0);
  to_space(q, s->p1);
  s->h0 = s->h1 = h;
  s->r0 = s->r1 = r;
}

void vg_demo_passage_law(double factor, struct vg_demo_spacing *law)
{
  const double nose[2][3] = { { 0, 0, R_HUB }, { 0, 0, R_TIP } };
  const double tail[2][3] = { { 1, camber(1), R_HUB },
                              { 1, camber(1), R_TIP } };

  law->n = 0;
  law->h_max = least(factor * H_FIELD, H_FIELD_MAX);
  put_source(law, nose[0], nose[1], least(factor * H_NOSE, H_NOSE_MAX), 0.01);
  put_source(law, tail[0], tail[1], least(factor * H_TAIL, H_TAIL_MAX), 0.01);
  for (int i = 0; i < N_TIP; i++) {
    const double x0 = (double)i / N_TIP, x1 = (double)(i + 1) / N_TIP;
    const double p[3] = { x0, camber(x0), R_TIP + 0.5 * GAP };
    const double q[3] = { x1, camber(x1), R_TIP + 0.5 * GAP };

    put_source(law, p, q, least(factor * H_TIP, H_TIP_MAX), 0.5 * THICK);
  }
}

void vg_demo_passage_box(double lo[3], double hi[3])
{
  const double q[4][3] = { { X_IN, -HALF_PITCH, R_CASING },
                           { X_OUT, camber(X_OUT) + HALF_PITCH, R_HUB },
                           { X_OUT, camber(X_OUT) + HALF_PITCH, R_CASING } };
  double x[3][3];

  for (int i = 0; i < 3; i++) to_space(q[i], x[i]);
  lo[0] = X_IN;
  hi[0] = X_OUT;
  lo[1] = x[0][1];
  hi[1] = x[2][1];
  lo[2] = x[1][2];
  hi[2] = R_CASING;
}

int vg_demo_passage_holds(const double x[3])
{
  const double rr = x[1] * x[1] + x[2] * x[2];
  double sine, cosine, y, z, most_sine, most_cosine;

  if (x[0] < X_IN || x[0] > X_OUT || rr < R_HUB * R_HUB ||
      rr > R_CASING * R_CASING)
    return 0;
  turn(camber(x[0]), &sine, &cosine);
  y = fabs(x[1] * cosine - x[2] * sine);
  z = x[2] * cosine + x[1] * sine;
  turn(HALF_PITCH, &most_sine, &most_cosine);
  if (y * most_cosine > z * most_sine) return 0;
  if (x[0] < 0 || x[0] > 1 || rr > R_TIP * R_TIP) return 1;
  return y > z * half_thickness(x[0], 2 * sqrt(x[0] * (1 - x[0])));
}

/* --- unrolled faces ----------------------------------------------------- */

/* A face in its plane: coordinates (x, r angle) of a cylinder of radius r,
 * (length, r) along the camber line of the first side or around the blade. The
 * blade begins and ends at the trailing edge, counter-clockwise. */
enum face_kind { CYLINDER, SIDE, SECTION };

struct face {
  enum face_kind kind;
  double r;           /* of a cylinder, else 1 */
  double (*along)[3]; /* [N_TABLE + 1] else: length, x, angle */
  const struct vg_demo_spacing *law;
};

static void face_point(const struct face *f, const double p[2], double q[3])
{
  int lo = 0, hi = N_TABLE;
  double share;

  q[0] = p[0];
  q[1] = p[1] / f->r;
  q[2] = f->r;
  if (f->kind == CYLINDER) return;
  while (hi - lo > 1) {
    const int mid = (lo + hi) / 2;

    if (f->along[mid][0] <= p[0]) lo = mid;
    else hi = mid;
  }
  share = (p[0] - f->along[lo][0]) / (f->along[hi][0] - f->along[lo][0]);
  for (int k = 0; k < 2; k++)
    q[k] = f->along[lo][k + 1] +
           share * (f->along[hi][k + 1] - f->along[lo][k + 1]);
  q[2] = p[1];
}

static double face_size(void *user, const double p[2])
{
  const struct face *f = user;
  double q[3], x[3];

  face_point(f, p, q);
  to_space(q, x);
  return vg_demo_size((void *)f->law, x);
}

static void side_at(double t, double row[3])
{
  row[1] = X_IN + (X_OUT - X_IN) * t;
  row[2] = camber(row[1]) - HALF_PITCH;
}

static void section_at(double t, double row[3])
{
  const double at = t <= 0.5 ? 2 * t : 2 - 2 * t; /* in half turns */
  double sine, cosine;

  turn(HALF_PI * (at <= 0.5 ? 2 * at : 2 - 2 * at), &sine, &cosine);
  row[1] = 0.5 * (at <= 0.5 ? 1 + cosine : 1 - cosine);
  row[2] = camber(row[1]) + half_thickness(row[1], t <= 0.5 ? sine : -sine);
}

static int make_table(struct face *f)
{
  f->along = vg_alloc(N_TABLE + 1, sizeof *f->along);
  if (!f->along) return -1;
  for (int i = 0; i <= N_TABLE; i++) {
    double *row = f->along[i], dx, dt;

    (f->kind == SIDE ? side_at : section_at)((double)i / N_TABLE, row);
    row[0] = 0;
    if (!i) continue;
    dx = row[1] - row[-2];
    dt = R_MEAN * (row[2] - row[-1]);
    row[0] = row[-3] + sqrt(dx * dx + dt * dt);
  }
  return 0;
}

/* --- curves ------------------------------------------------------------- */

/* A straight line in the plane of a face, divided. */
struct curve {
  const struct face *face;
  double from[2], to[2];
  size_t n;        /* edges */
  double (*p)[2];  /* [n + 1] in the plane */
  double (*q)[3];  /* [n + 1] cylindrical coordinates */
  uint32_t *point; /* [n + 1] in the surface */
};

/* The curves; 0, 1: at the hub and at the casing or tip, or the inflow and the
 * outflow. */
struct frame {
  struct vg_mesh *m;
  size_t cap_point, cap_tri, cap_patch;
  struct face side, section, cylinder[3]; /* hub, casing, tip */
  struct curve lo[2], lo_end[2];          /* of the first side */
  struct curve hi[2], hi_end[2];          /* their images */
  struct curve arc[2][2];                 /* [inflow, outflow][hub, casing] */
  struct curve loop[2], seam;             /* of the blade */
};

static uint32_t add_point(struct frame *f, const double q[3])
{
  struct vg_mesh *m = f->m;

  if (vg_reserve(&m->point, &f->cap_point, m->n_point + 1, sizeof *m->point))
    return UINT32_MAX;
  to_space(q, m->point[m->n_point]);
  return (uint32_t)m->n_point++;
}

static double curve_length(const struct curve *c)
{
  return fabs(c->to[0] - c->from[0]) + fabs(c->to[1] - c->from[1]);
}

static void curve_at(const struct curve *c, double share, double p[2])
{
  for (int k = 0; k < 2; k++)
    p[k] = share == 1 ? c->to[k] : c->from[k] + share * (c->to[k] - c->from[k]);
}

static double curve_size(void *user, double s)
{
  const struct curve *c = user;
  double p[2];

  curve_at(c, s / curve_length(c), p);
  return face_size((void *)c->face, p);
}

static int curve_room(struct curve *c)
{
  c->p = vg_alloc(c->n + 1, sizeof *c->p);
  c->q = vg_alloc(c->n + 1, sizeof *c->q);
  c->point = vg_alloc(c->n + 1, sizeof *c->point);
  return c->p && c->q && c->point ? 0 : -1;
}

/* Divides the curve. Its ends are the points first and last, or new ones if
 * these are UINT32_MAX. */
static vg_status divide(struct frame *f, struct curve *c, uint32_t first,
                        uint32_t last, struct vg_error *err)
{
  const double length = curve_length(c);
  double *s = NULL;
  vg_status st;

  VG_TRY(vg_graded_steps(length, curve_size, c, 2, &c->n, &s, err));
  if (curve_room(c)) st = vg_fail_memory(err, "the passage");
  for (size_t i = 0; st == VG_OK && i <= c->n; i++) {
    curve_at(c, s[i] / length, c->p[i]);
    face_point(c->face, c->p[i], c->q[i]);
    c->point[i] = i == 0 ? first : i == c->n ? last : UINT32_MAX;
    if (c->point[i] == UINT32_MAX) c->point[i] = add_point(f, c->q[i]);
    if (c->point[i] == UINT32_MAX) st = vg_fail_memory(err, "the passage");
  }
done:
  free(s);
  return st;
}

/* Adds the image of a point of the first side. */
static uint32_t add_image(struct frame *f, const double q[3])
{
  const double image[3] = { q[0], q[1] + 2 * HALF_PITCH, q[2] };

  return add_point(f, image);
}

/* Sets *c to the image of a curve of the first side; first, last: as in
 * divide. */
static vg_status divide_image(struct frame *f, const struct curve *from,
                              struct curve *c, uint32_t first, uint32_t last,
                              struct vg_error *err)
{
  c->face = from->face;
  c->n = from->n;
  if (curve_room(c)) return vg_fail_memory(err, "the passage");
  for (size_t i = 0; i <= c->n; i++) {
    memcpy(c->p[i], from->p[i], sizeof *c->p);
    memcpy(c->q[i], from->q[i], sizeof *c->q);
    c->q[i][1] += 2 * HALF_PITCH;
    c->point[i] = i == 0 ? first : i == c->n ? last : UINT32_MAX;
    if (c->point[i] == UINT32_MAX) c->point[i] = add_image(f, from->q[i]);
    if (c->point[i] == UINT32_MAX) return vg_fail_memory(err, "the passage");
  }
  return VG_OK;
}

static void set_curve(struct curve *c, const struct face *face, double u0,
                      double v0, double u1, double v1)
{
  c->face = face;
  c->from[0] = u0;
  c->from[1] = v0;
  c->to[0] = u1;
  c->to[1] = v1;
}

/* The curves of the sides, and the arcs between them. */
static vg_status add_sides(struct frame *f, struct vg_error *err)
{
  const double length = f->side.along[N_TABLE][0];
  const double r[2] = { R_HUB, R_CASING }, end[2] = { X_IN, X_OUT };
  const uint32_t none = UINT32_MAX;
  vg_status st;

  for (int k = 0; k < 2; k++) {
    set_curve(&f->lo[k], &f->side, 0, r[k], length, r[k]);
    VG_TRY(divide(f, &f->lo[k], none, none, err));
    VG_TRY(divide_image(f, &f->lo[k], &f->hi[k], none, none, err));
  }
  for (int e = 0; e < 2; e++) {
    const size_t at[2] = { e ? f->lo[0].n : 0, e ? f->lo[1].n : 0 };
    const double middle = camber(end[e]);

    set_curve(&f->lo_end[e], &f->side, e ? length : 0, R_HUB, e ? length : 0,
              R_CASING);
    VG_TRY(divide(f, &f->lo_end[e], f->lo[0].point[at[0]],
                  f->lo[1].point[at[1]], err));
    VG_TRY(divide_image(f, &f->lo_end[e], &f->hi_end[e], f->hi[0].point[at[0]],
                        f->hi[1].point[at[1]], err));
    for (int k = 0; k < 2; k++) {
      set_curve(&f->arc[e][k], &f->cylinder[k], end[e],
                r[k] * (middle - HALF_PITCH), end[e],
                r[k] * (middle + HALF_PITCH));
      VG_TRY(divide(f, &f->arc[e][k], f->lo[k].point[at[k]],
                    f->hi[k].point[at[k]], err));
    }
  }
done:
  return st;
}

static vg_status add_blade(struct frame *f, struct vg_error *err)
{
  const double length = f->section.along[N_TABLE][0];
  const double r[2] = { R_HUB, R_TIP };
  uint32_t tail[2];
  vg_status st = VG_OK;

  for (int k = 0; k < 2; k++) {
    const double q[3] = { 1, camber(1), r[k] };

    tail[k] = add_point(f, q);
    if (tail[k] == UINT32_MAX) return vg_fail_memory(err, "the blade");
    set_curve(&f->loop[k], &f->section, 0, r[k], length, r[k]);
    VG_TRY(divide(f, &f->loop[k], tail[k], tail[k], err));
  }
  set_curve(&f->seam, &f->section, 0, R_HUB, 0, R_TIP);
  VG_TRY(divide(f, &f->seam, tail[0], tail[1], err));
done:
  return st;
}

/* --- faces -------------------------------------------------------------- */

/* The outline of a face, with the face on its left. */
struct outline {
  size_t n, cap[3];
  double (*p)[2];
  uint32_t *point, (*edge)[2];
  size_t first; /* of the loop that is not closed yet */
};

/* Adds the points of a curve but its last one; back: from its end, without its
 * first one. shift is added to the first coordinate; on a cylinder, the points
 * are where the cylinder has them. */
static int trace(struct outline *o, const struct face *face,
                 const struct curve *c, int back, double shift)
{
  if (vg_reserve(&o->p, &o->cap[0], o->n + c->n, sizeof *o->p) ||
      vg_reserve(&o->point, &o->cap[1], o->n + c->n, sizeof *o->point) ||
      vg_reserve(&o->edge, &o->cap[2], o->n + c->n, sizeof *o->edge))
    return -1;
  for (size_t i = 0; i < c->n; i++, o->n++) {
    const size_t at = back ? c->n - i : i;

    o->p[o->n][0] = c->p[at][0] + shift;
    o->p[o->n][1] = c->p[at][1];
    if (face->kind == CYLINDER) {
      o->p[o->n][0] = c->q[at][0];
      o->p[o->n][1] = face->r * c->q[at][1];
    }
    o->point[o->n] = c->point[at];
    o->edge[o->n][0] = (uint32_t)o->n;
    o->edge[o->n][1] = (uint32_t)o->n + 1;
  }
  return 0;
}

static void close_loop(struct outline *o)
{
  o->edge[o->n - 1][1] = (uint32_t)o->first;
  o->first = o->n;
}

static void outline_release(struct outline *o)
{
  free(o->p);
  free(o->point);
  free(o->edge);
}

static vg_status add_triangle(struct frame *f, uint32_t patch, int flip,
                              const uint32_t v[3], struct vg_error *err)
{
  struct vg_mesh *m = f->m;

  if (vg_reserve(&m->tri, &f->cap_tri, m->n_tri + 1, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &f->cap_patch, m->n_tri + 1,
                 sizeof *m->tri_patch))
    return vg_fail_memory(err, "the passage");
  for (int k = 0; k < 3; k++) m->tri[m->n_tri][k] = v[flip && k ? 3 - k : k];
  m->tri_patch[m->n_tri++] = patch;
  return VG_OK;
}

/* Adds the triangles with points given by number[]. */
static vg_status add_triangles(struct frame *f, uint32_t patch, int flip,
                               size_t n, const uint32_t (*tri)[3],
                               const uint32_t *number, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < n && st == VG_OK; i++) {
    const uint32_t v[3] = { number[tri[i][0]], number[tri[i][1]],
                            number[tri[i][2]] };

    st = add_triangle(f, patch, flip, v, err);
  }
  return st;
}

/* Fills the outline, with normals that point to the viewer of the plane, or
 * away from it (flip). image: the outline of the second side, which gets the
 * images of the points and triangles, or NULL. */
static vg_status fill(struct frame *f, const struct face *face,
                      const struct outline *o, uint32_t patch, int flip,
                      const struct outline *image, struct vg_error *err)
{
  const struct vg_planar_law law = { .at = face_size, .user = (void *)face };
  size_t n_new = 0, n_tri = 0;
  double(*add)[2] = NULL;
  uint32_t(*tri)[3] = NULL, *number[2] = { NULL, NULL };
  vg_status st;

  VG_TRY(vg_planar_mesh(o->n, (const double(*)[2])o->p, o->n,
                        (const uint32_t(*)[2])o->edge, &law, &n_new, &add,
                        &n_tri, &tri, err));
  for (int k = 0; k < (image ? 2 : 1); k++) {
    number[k] = vg_alloc(o->n + n_new, sizeof **number);
    if (!number[k]) st = vg_fail_memory(err, "the passage");
    if (!number[k]) goto done;
    memcpy(number[k], k ? image->point : o->point, o->n * sizeof **number);
    for (size_t i = 0; i < n_new; i++) {
      double q[3];

      face_point(face, add[i], q);
      number[k][o->n + i] = k ? add_image(f, q) : add_point(f, q);
      if (number[k][o->n + i] == UINT32_MAX)
        st = vg_fail_memory(err, "the passage");
    }
    if (st == VG_OK)
      st = add_triangles(f, k ? HI : patch, k ? !flip : flip, n_tri,
                         (const uint32_t(*)[3])tri, number[k], err);
    if (st < 0) goto done;
  }
done:
  free(add);
  free(tri);
  for (int k = 0; k < 2; k++) free(number[k]);
  return st;
}

/* Hub (0) or casing (1): the hub has the hole of the blade. */
static vg_status fill_wall(struct frame *f, int k, struct vg_error *err)
{
  const struct face *face = &f->cylinder[k];
  struct outline o = { 0 };
  vg_status st;

  if (trace(&o, face, &f->lo[k], 0, 0) ||
      trace(&o, face, &f->arc[1][k], 0, 0) ||
      trace(&o, face, &f->hi[k], 1, 0) ||
      trace(&o, face, &f->arc[0][k], 1, 0)) {
    st = vg_fail_memory(err, "the passage");
    goto done;
  }
  close_loop(&o);
  if (k == 0) {
    if (trace(&o, face, &f->loop[0], 1, 0)) {
      st = vg_fail_memory(err, "the passage");
      goto done;
    }
    close_loop(&o);
  }
  st = fill(f, face, &o, k ? CASING : HUB, k, NULL, err);
done:
  outline_release(&o);
  return st;
}

static vg_status fill_blade(struct frame *f, struct vg_error *err)
{
  const struct face *face = &f->section, *tip = &f->cylinder[2];
  const double length = face->along[N_TABLE][0];
  struct outline o = { 0 }, cap = { 0 };
  vg_status st;

  if (trace(&o, face, &f->loop[0], 0, 0) ||
      trace(&o, face, &f->seam, 0, length) ||
      trace(&o, face, &f->loop[1], 1, 0) || trace(&o, face, &f->seam, 1, 0) ||
      trace(&cap, tip, &f->loop[1], 0, 0)) {
    st = vg_fail_memory(err, "the blade");
    goto done;
  }
  close_loop(&o);
  close_loop(&cap);
  VG_TRY(fill(f, face, &o, BLADE, 0, NULL, err));
  st = fill(f, tip, &cap, TIP, 0, NULL, err);
done:
  outline_release(&o);
  outline_release(&cap);
  return st;
}

static vg_status fill_sides(struct frame *f, struct vg_error *err)
{
  const struct curve *const c[2][4] = {
    { &f->lo[0], &f->lo_end[1], &f->lo[1], &f->lo_end[0] },
    { &f->hi[0], &f->hi_end[1], &f->hi[1], &f->hi_end[0] }
  };
  struct outline o[2] = { { 0 }, { 0 } };
  vg_status st = VG_OK;

  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < 4; i++)
      if (trace(&o[k], &f->side, c[k][i], i > 1, 0))
        st = vg_fail_memory(err, "the passage");
    if (st < 0) goto done;
    close_loop(&o[k]);
  }
  st = fill(f, &f->side, &o[0], LO, 1, &o[1], err);
done:
  for (int k = 0; k < 2; k++) outline_release(&o[k]);
  return st;
}

/* Inflow (0) or outflow (1). */
static vg_status fill_end(struct frame *f, int e, struct vg_error *err)
{
  const struct curve *const c[4] = { &f->arc[e][0], &f->hi_end[e],
                                     &f->arc[e][1], &f->lo_end[e] };
  const struct vg_size_function law = { .at = vg_demo_size,
                                        .user = (void *)f->side.law };
  uint32_t(*edge)[2] = NULL;
  size_t n = 0;
  vg_status st;

  for (int i = 0; i < 4; i++) n += c[i]->n;
  edge = vg_alloc(n, sizeof *edge);
  if (!edge) return vg_fail_memory(err, "the passage");
  n = 0;
  for (int i = 0; i < 4; i++)
    for (size_t k = 0; k < c[i]->n; k++, n++) {
      edge[n][(i > 1) ^ e] = c[i]->point[k];
      edge[n][!((i > 1) ^ e)] = c[i]->point[k + 1];
    }
  st = vg_planar_patch(f->m, n, (const uint32_t(*)[2])edge, &law,
                       e ? OUTFLOW : INFLOW, err);
  free(edge);
  return st;
}

static vg_status add_patches(struct vg_mesh *m, struct vg_error *err)
{
  static const struct {
    const char *name;
    int32_t bc, fun3d;
  } patch[] = { { "hub", 4, 4000 },       { "casing", 4, 4000 },
                { "blade", 4, 4000 },     { "tip", 4, 4000 },
                { "inflow", 1001, 7011 }, { "outflow", 1002, 5051 },
                { "lo", 6100, 6100 },     { "hi", 6100, 6100 } };

  for (int i = 0; i <= HI; i++) {
    const size_t at = vg_mesh_add_patch(m, i + 1, patch[i].name);

    if (at == SIZE_MAX) return vg_fail_memory(err, "a patch");
    m->patch[at].bc = m->patch[at].family = patch[i].bc;
    m->patch[at].bc_fun3d = patch[i].fun3d;
  }
  return VG_OK;
}

static void frame_release(struct frame *f)
{
  struct curve *const c[] = { &f->lo[0],     &f->lo[1],     &f->lo_end[0],
                              &f->lo_end[1], &f->hi[0],     &f->hi[1],
                              &f->hi_end[0], &f->hi_end[1], &f->arc[0][0],
                              &f->arc[0][1], &f->arc[1][0], &f->arc[1][1],
                              &f->loop[0],   &f->loop[1],   &f->seam };

  for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
    free(c[i]->p);
    free(c[i]->q);
    free(c[i]->point);
  }
  free(f->side.along);
  free(f->section.along);
}

vg_status vg_demo_passage_surface(const struct vg_demo_spacing *law,
                                  struct vg_mesh *out, struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct frame f = { .m = &m,
                     .side = { SIDE, 1, NULL, law },
                     .section = { SECTION, 1, NULL, law },
                     .cylinder = { { CYLINDER, R_HUB, NULL, law },
                                   { CYLINDER, R_CASING, NULL, law },
                                   { CYLINDER, R_TIP, NULL, law } } };
  vg_status st;

  VG_TRY(add_patches(&m, err));
  if (make_table(&f.side) || make_table(&f.section)) {
    st = vg_fail_memory(err, "the passage");
    goto done;
  }
  VG_TRY(add_sides(&f, err));
  VG_TRY(add_blade(&f, err));
  for (int k = 0; k < 2; k++) VG_TRY(fill_wall(&f, k, err));
  VG_TRY(fill_blade(&f, err));
  VG_TRY(fill_sides(&f, err));
  /* These reallocate to the exact numbers: they come last. */
  for (int e = 0; e < 2; e++) VG_TRY(fill_end(&f, e, err));
  vg_mesh_move(out, &m);
done:
  vg_mesh_release(&m);
  frame_release(&f);
  return st;
}
