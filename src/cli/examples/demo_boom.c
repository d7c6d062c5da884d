/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A Sears-Haack body, the body of revolution of least wave drag for its length
 * and volume, in a supersonic flow. It is pointed at both ends. Its surface
 * consists of rings; consecutive rings with different numbers of points are
 * joined in the order of their angles. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/examples/demo_parts.h"
#include "core/geometry/graded.h"

/* Lengths in body lengths. */
#define RADIUS 0.05 /* largest of the body */
#define MACH 1.6
#define UPSTREAM 0.5
#define DOWNSTREAM 1.0
#define RADIAL 2.0
#define CAP (0.25 * UPSTREAM) /* radius of the ends of the domain */

/* Spacings at factor 1, and their upper bounds. */
#define H_BODY 0.012
#define H_BODY_MAX 0.03
#define H_TIP 0.003
#define H_TIP_MAX 0.006
#define H_CONE 0.03
#define H_CONE_MAX 0.1
#define STRETCH 10.0
#define MARGIN 0.1 /* of the cones before and behind the body */

#define RIGHT_ANGLE 1.57079632679489661923
#define RING_HEIGHT 0.87 /* of an equilateral triangle */

enum { N_TABLE = 16384 /* steps along the profile */, RING_LEAST = 3 };

static double cot_of_cone(void)
{
  return sqrt((MACH - 1) * (MACH + 1));
}

static double radius_at(double x)
{
  const double q = x > 0 && x < 1 ? 4 * x * (1 - x) : 0, root = sqrt(q);

  return RADIUS * root * sqrt(root);
}

void vg_demo_boom_law(double factor, struct vg_demo_spacing *law)
{
  struct vg_source *s = law->source;

  law->n = 4;
  law->h_max = RADIAL / 4;
  s[0].kind = VG_SOURCE_MACHCONE;
  s[0].mach = MACH;
  s[0].stretch = STRETCH;
  s[0].p0[0] = -MARGIN;
  s[0].p1[0] = 1 + MARGIN;
  s[0].r0 = RADIAL;
  s[0].h0 = s[0].h1 = fmin(factor * H_CONE, H_CONE_MAX);
  s[1].kind = VG_SOURCE_LINE;
  s[1].p1[0] = 1;
  s[1].r0 = s[1].r1 = RADIUS;
  s[1].h0 = s[1].h1 = fmin(factor * H_BODY, H_BODY_MAX);
  s[2].kind = s[3].kind = VG_SOURCE_POINT;
  s[3].p0[0] = 1;
  s[2].h0 = s[3].h0 = s[2].h1 = s[3].h1 = fmin(factor * H_TIP, H_TIP_MAX);
}

struct vg_farfield vg_demo_boom_farfield(void)
{
  struct vg_farfield far = VG_FARFIELD_INIT;

  far.kind = VG_FARFIELD_MACH;
  far.extent.mach = MACH;
  far.extent.upstream = UPSTREAM;
  far.extent.downstream = DOWNSTREAM;
  far.extent.radial = RADIAL;
  return far;
}

void vg_demo_boom_box(int is_half, double lo[3], double hi[3])
{
  lo[0] = -UPSTREAM;
  hi[0] = 1 + DOWNSTREAM + RADIAL * cot_of_cone();
  lo[1] = is_half ? 0 : -RADIAL;
  lo[2] = -RADIAL;
  hi[1] = hi[2] = RADIAL;
}

int vg_demo_boom_holds(const double x[3])
{
  const double r = sqrt(x[1] * x[1] + x[2] * x[2]);
  const double apex = x[0] - fmax(0, r - CAP) * cot_of_cone();

  return r < RADIAL && apex > -UPSTREAM && apex < 1 + DOWNSTREAM &&
         r > radius_at(x[0]);
}

/* --- surface -------------------------------------------------------------- */

struct body {
  const struct vg_demo_spacing *law;
  struct vg_mesh *m;
  double *along; /* [N_TABLE + 1] length of the profile up to table_x(i) */
  int at;        /* interval of the table found last */
};

static double table_x(double i)
{
  const double u = i / N_TABLE;

  return u * u * (3 - 2 * u);
}

static int make_table(struct body *b)
{
  b->along = vg_calloc(N_TABLE + 1, sizeof *b->along);
  for (int i = 1; b->along && i <= N_TABLE; i++) {
    const double dx = table_x(i) - table_x(i - 1);
    const double dr = radius_at(table_x(i)) - radius_at(table_x(i - 1));

    b->along[i] = b->along[i - 1] + sqrt(dx * dx + dr * dr);
  }
  return b->along ? 0 : -1;
}

/* x at a length of the profile. Calls with similar lengths are fast. */
static double x_along(struct body *b, double length)
{
  while (b->at > 0 && length < b->along[b->at]) b->at--;
  while (b->at + 1 < N_TABLE && length > b->along[b->at + 1]) b->at++;
  return table_x(b->at + (length - b->along[b->at]) /
                           (b->along[b->at + 1] - b->along[b->at]));
}

static double size_at(const struct body *b, double x)
{
  const double p[3] = { x, 0, radius_at(x) };

  return vg_demo_size((void *)b->law, p);
}

static double ring_distance(void *user, double length)
{
  struct body *b = user;

  return RING_HEIGHT * size_at(b, x_along(b, length));
}

/* Half a ring at y >= 0, from the upper to the lower end: points first to first
 * + n. A tip is a ring with n = 0. */
struct ring {
  uint32_t first;
  size_t n;
};

static vg_status add_ring(struct body *b, double x, int is_tip,
                          struct ring *ring, struct vg_error *err)
{
  struct vg_mesh *m = b->m;
  const double r = is_tip ? 0 : radius_at(x);
  double(*point)[3];

  ring->first = (uint32_t)m->n_point;
  ring->n = is_tip ? 0 : (size_t)(2 * RIGHT_ANGLE * r / size_at(b, x) + 0.5);
  if (!is_tip && ring->n < RING_LEAST) ring->n = RING_LEAST;
  point = vg_realloc(m->point, m->n_point + ring->n + 1, sizeof *point);
  if (!point) return vg_fail_memory(err, "the body");
  m->point = point;
  for (size_t j = 0; j <= ring->n; j++) {
    const double turn = ring->n ? 2 * ((double)j / (double)ring->n) : 0;
    double s, c, *p = point[m->n_point++];

    vg_quarter_turn(turn <= 1 ? turn : 2 - turn, &s, &c);
    p[0] = x;
    p[1] = j == 0 || j == ring->n ? 0 : r * s;
    p[2] = turn <= 1 ? r * c : -r * c;
  }
  return VG_OK;
}

/* Triangles between two rings, with normals that point out of the body. */
static vg_status join_rings(struct vg_mesh *m, const struct ring *a,
                            const struct ring *b, struct vg_error *err)
{
  uint32_t(*tri)[3] = vg_realloc(m->tri, m->n_tri + a->n + b->n, sizeof *tri);
  size_t i = 0, j = 0;

  if (!tri) return vg_fail_memory(err, "the body");
  m->tri = tri;
  while (i < a->n || j < b->n) {
    /* The ring whose next point has the smaller angle advances. */
    const int first = j == b->n ||
                      (i < a->n && (i + 1) * b->n <= (j + 1) * a->n);
    uint32_t *t = m->tri[m->n_tri++];

    t[0] = a->first + (uint32_t)i;
    t[1] = b->first + (uint32_t)j;
    t[2] = first ? a->first + (uint32_t)++i : b->first + (uint32_t)++j;
  }
  return VG_OK;
}

static vg_status add_rings(struct body *b, struct vg_error *err)
{
  struct ring before = { 0, 0 }, ring = { 0, 0 };
  double *s = NULL;
  size_t n = 0;
  vg_status st;

  VG_TRY(vg_graded_steps(b->along[N_TABLE], ring_distance, b, 8, &n, &s, err));
  for (size_t i = 0; i <= n; i++) {
    const int is_tip = i == 0 || i == n;

    VG_TRY(add_ring(b, i == n ? 1 : x_along(b, s[i]), is_tip, &ring, err));
    if (i) VG_TRY(join_rings(b->m, &before, &ring, err));
    before = ring;
  }
done:
  free(s);
  return st;
}

vg_status vg_demo_boom_surface(int is_half, const struct vg_demo_spacing *law,
                               struct vg_mesh *out, struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct body b = { .law = law, .m = &m };
  vg_status st = VG_OK;

  if (vg_mesh_add_patch(&m, 1, "body") == SIZE_MAX || make_table(&b)) {
    st = vg_fail_memory(err, "the body");
    goto done;
  }
  m.patch[0].bc = m.patch[0].family = 4;
  m.patch[0].bc_fun3d = 4000;
  VG_TRY(add_rings(&b, err));
  m.tri_patch = vg_calloc(m.n_tri, sizeof *m.tri_patch);
  if (!m.tri_patch) VG_TRY(vg_fail_memory(err, "the body"));
  if (!is_half) VG_TRY(vg_demo_mirror(&m, err));
  vg_mesh_move(out, &m);
done:
  vg_mesh_release(&m);
  free(b.along);
  return st;
}
