/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A swept, tapered wing with one section throughout is a cone: all its
 * chords meet at an apex beyond the tip. A cone unrolls into the plane
 * without stretching anything, so the plane mesher makes isotropic triangles
 * of the local spacing on it.
 *
 * Section: NACA 0012 in u, x = u^2, lower side u < 0, upper side u > 0, which
 * is smooth round the nose. Trailing edge: closed, or opened linearly. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/examples/demo_parts.h"
#include "core/domain/planar.h"
#include "core/geometry/graded.h"

/* Lengths in root chords. */
#define SPAN 2.5 /* of one side */
#define TAPER 0.4
#define SWEEP 0.5 /* tangent of the leading edge's sweep: 26.6 deg */
#define THICK 0.12
#define BASE 0.01 /* height of the blunt trailing edge per chord */

/* Spacings at factor 1, per local chord. */
#define H_NOSE 0.006
#define H_TAIL 0.006
#define H_TIP 0.015
#define H_WING 0.04
/* Upper bounds: the nose has a radius of 0.016; triangles of the base are not
 * slivers if an edge is at most three times its height. */
#define H_NOSE_MAX 0.03
#define H_BASE_MAX (3 * BASE)

enum { N_TABLE = 16384 }; /* intervals of the unrolled section */

static double least(double a, double b)
{
  return a < b ? a : b;
}

static void put3(double to[3], double x, double y, double z)
{
  to[0] = x;
  to[1] = y;
  to[2] = z;
}

void vg_demo_wing_law(const struct vg_demo_wing *w, double factor,
                      struct vg_demo_spacing *law)
{
  const double tail = least(factor * H_TAIL, w->is_sharp ? 0.1 : H_BASE_MAX);
  const double nose = least(factor * H_NOSE, H_NOSE_MAX);
  const double tip = least(factor * H_TIP, 0.06) * TAPER;
  const double tip_x = SWEEP * SPAN;
  struct vg_source *s = law->source;

  law->n = 5;
  s[0].kind = s[1].kind = s[2].kind = VG_SOURCE_LINE;
  put3(s[0].p1, tip_x, SPAN, 0); /* leading edge */
  s[0].h0 = nose;
  s[0].h1 = nose * TAPER;
  s[0].r0 = s[0].r1 = 0.01 * TAPER;
  put3(s[1].p0, 1, 0, 0); /* trailing edge */
  put3(s[1].p1, tip_x + TAPER, SPAN, 0);
  s[1].h0 = tail;
  s[1].h1 = tail * TAPER;
  s[1].r0 = s[1].r1 = 0.5 * BASE;
  put3(s[2].p0, tip_x, SPAN, 0); /* tip */
  put3(s[2].p1, tip_x + TAPER, SPAN, 0);
  s[2].h0 = s[2].h1 = tip;
  s[2].r0 = s[2].r1 = 0.25 * THICK * TAPER;
  s[3].kind = s[4].kind = VG_SOURCE_TRIANGLE; /* planform */
  put3(s[3].p1, 1, 0, 0);
  put3(s[3].p2, tip_x + TAPER, SPAN, 0);
  put3(s[4].p1, tip_x + TAPER, SPAN, 0);
  put3(s[4].p2, tip_x, SPAN, 0);
  s[3].h0 = s[4].h0 = least(factor * H_WING, 0.25);
  s[3].r0 = s[4].r0 = 0.5 * THICK;
  if (w->is_half) return;
  for (int i = 0; i < 5; i++) { /* the other side */
    struct vg_source *t = &s[law->n++];

    *t = s[i];
    t->p0[1] = 0 - s[i].p0[1];
    t->p1[1] = 0 - s[i].p1[1];
    t->p2[1] = 0 - s[i].p2[1];
  }
}

/* --- section and cone ---------------------------------------------------- */

static double thickness(int is_sharp, double a) /* a = |u| */
{
  const double x = a * a;
  const double y = 5 * THICK *
                   (0.2969 * a +
                    x * (-0.1260 + x * (-0.3516 + x * (0.2843 - 0.1036 * x))));

  if (a >= 1) return is_sharp ? 0 : 0.5 * BASE;
  return is_sharp ? y : y + 0.5 * BASE * x;
}

int vg_demo_wing_holds(const struct vg_demo_wing *w, const double x[3])
{
  const double y = fabs(x[1]), chord = 1 - (1 - TAPER) * y / SPAN;
  double at;

  if (y > SPAN) return 0;
  at = (x[0] - SWEEP * y) / chord;
  return at > 0 && at < 1 &&
         fabs(x[2]) < chord * thickness(w->is_sharp, sqrt(at));
}

struct cone {
  int is_sharp;
  double apex[3];
  const struct vg_demo_spacing *law;
  double (*w)[2]; /* [N_TABLE + 1] unrolled directions, unit */
};

static double table_u(int i)
{
  return 2.0 * i / N_TABLE - 1;
}

static void root_point(const struct cone *c, double u, double x[3])
{
  const double z = thickness(c->is_sharp, fabs(u));

  put3(x, u * u, 0, u < 0 ? -z : z);
}

/* Point on the ray through the root point u; scale is 1 at the root. */
static void cone_point(const struct cone *c, double u, double scale,
                       double x[3])
{
  root_point(c, u, x);
  for (int k = 0; k < 3; k++) x[k] = c->apex[k] + scale * (x[k] - c->apex[k]);
}

static double ray_length(const struct cone *c, double u)
{
  double x[3], rr = 0;

  root_point(c, u, x);
  for (int k = 0; k < 3; k++) rr += (x[k] - c->apex[k]) * (x[k] - c->apex[k]);
  return sqrt(rr);
}

/* Unroll the cone: rotate from ray to ray by the angle between them,
 * counter-clockwise with increasing u; sine and cosine are computed from
 * products only. */
static int unroll(struct cone *c)
{
  double before[3] = { 0 };

  c->w = vg_alloc(N_TABLE + 1, sizeof *c->w);
  if (!c->w) return -1;
  for (int i = 0; i <= N_TABLE; i++) {
    double d[3], cosine = 0, sine = 0, len;
    double *w = c->w[i];

    root_point(c, table_u(i), d);
    len = ray_length(c, table_u(i));
    for (int k = 0; k < 3; k++) d[k] = (d[k] - c->apex[k]) / len;
    for (int k = 0; k < 3; k++) {
      const int u = (k + 1) % 3, v = (k + 2) % 3;
      const double n = before[u] * d[v] - before[v] * d[u];

      cosine += before[k] * d[k];
      sine += n * n;
    }
    sine = sqrt(sine);
    w[0] = i ? c->w[i - 1][0] * cosine - c->w[i - 1][1] * sine : 1;
    w[1] = i ? c->w[i - 1][0] * sine + c->w[i - 1][1] * cosine : 0;
    len = sqrt(w[0] * w[0] + w[1] * w[1]);
    w[0] /= len;
    w[1] /= len;
    memcpy(before, d, sizeof before);
  }
  return 0;
}

static void to_plane(const struct cone *c, double u, double scale, double p[2])
{
  const double t = 0.5 * (u + 1) * N_TABLE;
  const int i = t >= N_TABLE ? N_TABLE - 1 : (int)t;
  const double f = t - i, r = scale * ray_length(c, u);
  double w[2], len;

  for (int k = 0; k < 2; k++)
    w[k] = c->w[i][k] + f * (c->w[i + 1][k] - c->w[i][k]);
  len = sqrt(w[0] * w[0] + w[1] * w[1]);
  p[0] = r * w[0] / len;
  p[1] = r * w[1] / len;
}

static double turn(const double a[2], const double b[2])
{
  return a[0] * b[1] - a[1] * b[0];
}

static void from_plane(const struct cone *c, const double p[2], double x[3])
{
  int lo = 0, hi = N_TABLE;
  double a, b, u;

  while (hi - lo > 1) {
    const int mid = (lo + hi) / 2;

    if (turn(c->w[mid], p) >= 0) lo = mid;
    else hi = mid;
  }
  a = turn(c->w[lo], p);
  b = turn(p, c->w[hi]);
  u = table_u(lo) + (a / (a + b)) * (2.0 / N_TABLE);
  cone_point(c, u, sqrt(p[0] * p[0] + p[1] * p[1]) / ray_length(c, u), x);
}

static double size_on_cone(void *user, const double p[2])
{
  const struct cone *c = user;
  double x[3];

  from_plane(c, p, x);
  return vg_demo_size((void *)c->law, x);
}

/* --- curves -------------------------------------------------------------- */

/* One side of the section at root or tip, parametrised by arc length. */
struct side {
  const struct cone *c;
  double scale;
  double *along; /* [N_TABLE / 2 + 1] from the tail to the nose */
  int at;
};

static double side_u(const struct side *s, double length)
{
  const int last = N_TABLE / 2;
  struct side *m = (struct side *)s;
  double f;

  while (m->at > 0 && length < s->along[m->at]) m->at--;
  while (m->at + 1 < last && length > s->along[m->at + 1]) m->at++;
  f = (length - s->along[s->at]) / (s->along[s->at + 1] - s->along[s->at]);
  return -table_u(s->at) - f * (2.0 / N_TABLE);
}

static double size_on_side(void *user, double length)
{
  const struct side *s = user;
  double x[3];

  cone_point(s->c, side_u(s, length), s->scale, x);
  return vg_demo_size((void *)s->c->law, x);
}

/* Parameters u > 0 of the points, from 1 at the tail to 0 at the nose; the
 * lower side is the mirror image. */
static vg_status divide_side(const struct cone *c, double scale, size_t *n,
                             double **u, struct vg_error *err)
{
  struct side s = { c, scale, NULL, 0 };
  double before[3], x[3];
  vg_status st;

  s.along = vg_alloc(N_TABLE / 2 + 1, sizeof *s.along);
  if (!s.along) return vg_fail_memory(err, "a wing section");
  s.along[0] = 0;
  cone_point(c, 1, scale, before);
  for (int i = 1; i <= N_TABLE / 2; i++) {
    double rr = 0;

    cone_point(c, -table_u(i), scale, x);
    for (int k = 0; k < 3; k++) rr += (x[k] - before[k]) * (x[k] - before[k]);
    s.along[i] = s.along[i - 1] + sqrt(rr);
    memcpy(before, x, sizeof before);
  }
  st = vg_graded_steps(s.along[N_TABLE / 2], size_on_side, &s, 4, n, u, err);
  for (size_t i = 0; st == VG_OK && i <= *n; i++)
    (*u)[i] = i == 0 ? 1 : i == *n ? 0 : side_u(&s, (*u)[i]);
  free(s.along);
  return st;
}

struct tail {
  const struct cone *c;
  double length; /* of the ray, root to apex */
};

static double size_on_tail(void *user, double s)
{
  const struct tail *t = user;
  double x[3];

  cone_point(t->c, 1, 1 - s / t->length, x);
  return vg_demo_size((void *)t->c->law, x);
}

/* --- assembly ------------------------------------------------------------ */

/* Mesh points on the feature curves of the half wing: sections at root and tip
 * in the order of u from -1 to 1, and trailing edges (lower, upper) from root
 * to tip, ends included. */
struct frame {
  struct cone c;
  struct vg_mesh *m;
  size_t cap, n_side[2], n_tail, n_base;
  double *u[2], *scale;
  uint32_t *curve[2], *lower, *upper, *base[2];
};

static uint32_t add_point(struct frame *f, const double x[3])
{
  if (vg_reserve(&f->m->point, &f->cap, f->m->n_point + 1, sizeof *f->m->point))
    return UINT32_MAX;
  memcpy(f->m->point[f->m->n_point], x, sizeof *f->m->point);
  return (uint32_t)f->m->n_point++;
}

static double curve_u(const struct frame *f, int end, size_t i)
{
  const size_t n = f->n_side[end];

  return i <= n ? -f->u[end][i] : f->u[end][2 * n - i];
}

/* Add the section at root (end 0) or tip (end 1), exactly in its plane. */
static int add_curve(struct frame *f, int end)
{
  const size_t n = 2 * f->n_side[end];

  f->curve[end] = vg_alloc(n + 1, sizeof *f->curve[end]);
  if (!f->curve[end]) return -1;
  for (size_t i = 0; i <= n; i++) {
    double x[3];

    cone_point(&f->c, curve_u(f, end, i), end ? TAPER : 1, x);
    x[1] = end ? SPAN : 0;
    if (i == n && f->c.is_sharp) f->curve[end][i] = f->curve[end][0];
    else f->curve[end][i] = add_point(f, x);
    if (f->curve[end][i] == UINT32_MAX) return -1;
  }
  return 0;
}

static int add_tail(struct frame *f, double u, uint32_t **list)
{
  *list = vg_alloc(f->n_tail + 1, sizeof **list);
  if (!*list) return -1;
  for (size_t i = 0; i <= f->n_tail; i++) {
    const int end = i > 0;
    double x[3];

    if (i == 0 || i == f->n_tail) {
      (*list)[i] = f->curve[end][u < 0 ? 0 : 2 * f->n_side[end]];
      continue;
    }
    cone_point(&f->c, u, f->scale[i], x);
    (*list)[i] = add_point(f, x);
    if ((*list)[i] == UINT32_MAX) return -1;
  }
  return 0;
}

/* Add points across the blunt trailing edge, from upper to lower. */
static int add_base(struct frame *f, int end)
{
  const uint32_t *curve = f->curve[end];
  const uint32_t a = curve[2 * f->n_side[end]], b = curve[0];

  f->base[end] = vg_alloc(f->n_base + 1, sizeof *f->base[end]);
  if (!f->base[end]) return -1;
  for (size_t i = 0; i <= f->n_base; i++) {
    double x[3];

    memcpy(x, f->m->point[a], sizeof x);
    x[2] *= 1 - 2 * ((double)i / (double)f->n_base);
    f->base[end][i] = i == 0 ? a : i == f->n_base ? b : add_point(f, x);
    if (f->base[end][i] == UINT32_MAX) return -1;
  }
  return 0;
}

static vg_status add_edges(struct frame *f, struct vg_error *err)
{
  struct tail t = { &f->c, ray_length(&f->c, 1) };
  vg_status st;
  int bad;

  VG_TRY(divide_side(&f->c, 1, &f->n_side[0], &f->u[0], err));
  VG_TRY(divide_side(&f->c, TAPER, &f->n_side[1], &f->u[1], err));
  VG_TRY(vg_graded_steps(t.length * (1 - TAPER), size_on_tail, &t, 2,
                         &f->n_tail, &f->scale, err));
  for (size_t i = 0; i <= f->n_tail; i++)
    f->scale[i] = 1 - f->scale[i] / t.length;
  bad = add_curve(f, 0) || add_curve(f, 1) || add_tail(f, -1, &f->lower);
  if (!bad && !f->c.is_sharp) {
    f->n_base = (size_t)(BASE / size_on_tail(&t, 0) + 0.5);
    if (f->n_base < 1) f->n_base = 1;
    bad = add_tail(f, 1, &f->upper) || add_base(f, 0) || add_base(f, 1);
  }
  if (bad) st = vg_fail_memory(err, "the edges of the wing");
done:
  return st;
}

/* The boundary of the unrolled wing, counter-clockwise. */
struct outline {
  size_t n;
  double (*p)[2];
  uint32_t *point, (*edge)[2];
};

static void outline_add(struct outline *o, const struct frame *f, double u,
                        double scale, uint32_t point)
{
  to_plane(&f->c, u, scale, o->p[o->n]);
  o->point[o->n] = point;
  o->edge[o->n][0] = (uint32_t)o->n;
  o->edge[o->n][1] = (uint32_t)o->n + 1;
  o->n++;
}

static int make_outline(const struct frame *f, struct outline *o)
{
  const size_t n_root = 2 * f->n_side[0], n_tip = 2 * f->n_side[1];
  const size_t n = n_root + n_tip + 2 * f->n_tail;
  const uint32_t *upper = f->c.is_sharp ? f->lower : f->upper;

  o->p = vg_alloc(n, sizeof *o->p);
  o->point = vg_alloc(n, sizeof *o->point);
  o->edge = vg_alloc(n, sizeof *o->edge);
  if (!o->p || !o->point || !o->edge) return -1;
  for (size_t i = 0; i < n_root; i++)
    outline_add(o, f, curve_u(f, 0, i), 1, f->curve[0][i]);
  for (size_t i = 0; i < f->n_tail; i++)
    outline_add(o, f, 1, f->scale[i], upper[i]);
  for (size_t i = n_tip; i > 0; i--)
    outline_add(o, f, curve_u(f, 1, i), TAPER, f->curve[1][i]);
  for (size_t i = f->n_tail; i > 0; i--)
    outline_add(o, f, -1, f->scale[i], f->lower[i]);
  o->edge[o->n - 1][1] = 0;
  return 0;
}

static vg_status fill_skin(struct frame *f, struct vg_error *err)
{
  struct vg_mesh *m = f->m;
  struct outline o = { 0 };
  size_t n_new = 0, n_tri = 0;
  double(*add)[2] = NULL;
  uint32_t(*tri)[3] = NULL, first;
  const struct vg_planar_law law = { .at = size_on_cone, .user = &f->c };
  vg_status st = VG_OK;

  if (make_outline(f, &o)) {
    st = vg_fail_memory(err, "the wing");
    goto done;
  }
  VG_TRY(vg_planar_mesh(o.n, (const double(*)[2])o.p, o.n,
                        (const uint32_t(*)[2])o.edge, &law, &n_new, &add,
                        &n_tri, &tri, err));
  first = (uint32_t)m->n_point;
  m->tri_patch = vg_calloc(n_tri, sizeof *m->tri_patch);
  if (!m->tri_patch) st = vg_fail_memory(err, "the wing");
  for (size_t i = 0; st == VG_OK && i < n_new; i++) {
    double x[3];

    from_plane(&f->c, add[i], x);
    if (add_point(f, x) == UINT32_MAX) st = vg_fail_memory(err, "the wing");
  }
  for (size_t i = 0; i < 3 * n_tri; i++) {
    uint32_t *v = &tri[i / 3][i % 3];

    *v = *v < o.n ? o.point[*v] : first + (*v - (uint32_t)o.n);
  }
  m->tri = tri;
  m->n_tri = n_tri;
  tri = NULL;
done:
  free(add);
  free(tri);
  free(o.p);
  free(o.point);
  free(o.edge);
  return st;
}

/* Directed edges along the list, reversed if `back` is set. */
static size_t chain(const uint32_t *list, size_t n, int back,
                    uint32_t (*edge)[2])
{
  for (size_t i = 0; i < n; i++) {
    edge[i][back] = list[i];
    edge[i][!back] = list[i + 1];
  }
  return n;
}

/* Triangulate the flat tip and the blunt trailing edge. */
static vg_status fill_caps(struct frame *f, struct vg_error *err)
{
  const struct vg_size_function law = { .at = vg_demo_size,
                                        .user = (void *)f->c.law };
  const size_t room = 2 * f->n_side[1] + 2 * f->n_tail + 2 * f->n_base;
  uint32_t(*edge)[2] = vg_alloc(room, sizeof *edge);
  size_t n;
  vg_status st;

  if (!edge) return vg_fail_memory(err, "the wing tip");
  n = chain(f->curve[1], 2 * f->n_side[1], 0, edge);
  if (!f->c.is_sharp) n += chain(f->base[1], f->n_base, 0, edge + n);
  VG_TRY(vg_planar_patch(f->m, n, (const uint32_t(*)[2])edge, &law, 1, err));
  if (f->c.is_sharp) goto done;
  n = chain(f->lower, f->n_tail, 0, edge);
  n += chain(f->base[1], f->n_base, 1, edge + n);
  n += chain(f->upper, f->n_tail, 1, edge + n);
  n += chain(f->base[0], f->n_base, 0, edge + n);
  st = vg_planar_patch(f->m, n, (const uint32_t(*)[2])edge, &law, 2, err);
done:
  free(edge);
  return st;
}

vg_status vg_demo_mirror(struct vg_mesh *m, struct vg_error *err)
{
  const size_t n = m->n_point, n_tri = m->n_tri;
  uint32_t *other = vg_alloc(n, sizeof *other), *of;
  double(*point)[3] = vg_realloc(m->point, 2 * n, sizeof *point);
  uint32_t(*tri)[3];

  if (point) m->point = point;
  tri = vg_realloc(m->tri, 2 * n_tri, sizeof *tri);
  if (tri) m->tri = tri;
  of = vg_realloc(m->tri_patch, 2 * n_tri, sizeof *of);
  if (of) m->tri_patch = of;
  if (!other || !point || !tri || !of) {
    free(other);
    return vg_fail_memory(err, "the mirror image");
  }
  for (size_t i = 0; i < n; i++) {
    other[i] = (uint32_t)i;
    if (point[i][1] == 0) continue;
    other[i] = (uint32_t)m->n_point;
    put3(point[m->n_point++], point[i][0], -point[i][1], point[i][2]);
  }
  for (size_t i = 0; i < n_tri; i++) {
    for (int k = 0; k < 3; k++)
      tri[n_tri + i][k] = other[tri[i][k ? 3 - k : 0]];
    of[n_tri + i] = of[i];
  }
  m->n_tri = 2 * n_tri;
  free(other);
  return VG_OK;
}

static vg_status add_patches(struct vg_mesh *m, int is_sharp,
                             struct vg_error *err)
{
  static const char *const name[] = { "wing", "tip", "base" };

  for (int i = 0; i < (is_sharp ? 2 : 3); i++) {
    const size_t at = vg_mesh_add_patch(m, i + 1, name[i]);

    if (at == SIZE_MAX) return vg_fail_memory(err, "a patch");
    m->patch[at].bc = m->patch[at].family = 4;
    m->patch[at].bc_fun3d = 4000;
  }
  return VG_OK;
}

vg_status vg_demo_wing_surface(const struct vg_demo_wing *w,
                               const struct vg_demo_spacing *law,
                               struct vg_mesh *out, struct vg_error *err)
{
  const double reach = SPAN / (1 - TAPER);
  struct vg_mesh m = VG_MESH_INIT;
  struct frame f = {
    .c = { w->is_sharp, { SWEEP * reach, reach, 0 }, law, NULL }, .m = &m
  };
  vg_status st;

  VG_TRY(add_patches(&m, w->is_sharp, err));
  if (unroll(&f.c)) {
    st = vg_fail_memory(err, "the wing");
    goto done;
  }
  VG_TRY(add_edges(&f, err));
  VG_TRY(fill_skin(&f, err));
  VG_TRY(fill_caps(&f, err));
  if (!w->is_half) VG_TRY(vg_demo_mirror(&m, err));
  vg_mesh_move(out, &m);
done:
  vg_mesh_release(&m);
  free(f.c.w);
  free(f.scale);
  free(f.lower);
  free(f.upper);
  for (int end = 0; end < 2; end++) {
    free(f.u[end]);
    free(f.curve[end]);
    free(f.base[end]);
  }
  return st;
}
