/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Swaps and collapses: constructed surfaces with known results, and real ones
 * that must stay valid and improve. */
#include <math.h>

#include "grow.h"
#include "io_support.h"

#include "core/surface/surface_check.h"
#include "core/surface/surface_parts.h"
#include "core/surface/surface_swap.h"
#include "io/mesh/ugrid.h"

/* --- surfaces ------------------------------------------------------------ */

static uint32_t add_point(struct vg_mesh *m, double x, double y, double z)
{
  GROW(m->point, m->n_point);
  m->point[m->n_point][0] = x;
  m->point[m->n_point][1] = y;
  m->point[m->n_point][2] = z;
  return (uint32_t)m->n_point++;
}

static void add_tri(struct vg_mesh *m, uint32_t a, uint32_t b, uint32_t c,
                    uint32_t patch)
{
  GROW(m->tri, m->n_tri);
  GROW(m->tri_patch, m->n_tri);
  m->tri[m->n_tri][0] = a;
  m->tri[m->n_tri][1] = b;
  m->tri[m->n_tri][2] = c;
  m->tri_patch[m->n_tri++] = patch;
}

/* In -0.3 .. 0.3, the same on every run. */
static double shift(uint32_t *state)
{
  *state = *state * 1664525u + 1013904223u;
  return .6 * ((double)(*state >> 8) / 16777216. - .5);
}

/* One side of the unit cube, n by n squares, outward; with `shake` points
 * inside it are moved within its plane. Side s is the end s & 1 of axis s /
 * 2. */
static void add_side(struct vg_mesh *m, int s, uint32_t n, int shake,
                     uint32_t patch, uint32_t *state)
{
  uint32_t first = (uint32_t)m->n_point;
  int axis = s / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;

  for (uint32_t j = 0; j <= n; j++)
    for (uint32_t i = 0; i <= n; i++) {
      int inside = shake && i && j && i < n && j < n;
      double x[3];

      x[axis] = s & 1;
      x[u] = (i + (inside ? shift(state) : 0)) / n;
      x[v] = (j + (inside ? shift(state) : 0)) / n;
      add_point(m, x[0], x[1], x[2]);
    }
  for (uint32_t j = 0; j < n; j++)
    for (uint32_t i = 0; i < n; i++) {
      uint32_t a = first + j * (n + 1) + i, b = a + 1, d = a + n + 1;
      uint32_t c = d + 1;

      add_tri(m, a, s & 1 ? b : c, s & 1 ? c : b, patch);
      add_tri(m, a, s & 1 ? c : d, s & 1 ? d : c, patch);
    }
}

static void make_cube(struct vg_mesh *m, uint32_t n, int shake, int patches)
{
  struct vg_error err = VG_ERROR_INIT;
  uint32_t state = 7;

  for (int s = 0; s < (patches ? 6 : 1); s++)
    vg_mesh_add_patch(m, s + 1, "side");
  for (int s = 0; s < 6; s++)
    add_side(m, s, n, shake, patches ? (uint32_t)s : 0, &state);
  assert_int_equal(vg_surface_weld(m, 0, NULL, NULL, &err), VG_OK);
}

/* A point in triangle t at a + u (b - a) + v (c - a), raised along z. */
static uint32_t split(struct vg_mesh *m, size_t t, double u, double v,
                      double raise)
{
  uint32_t a = m->tri[t][0], b = m->tri[t][1], c = m->tri[t][2], p;
  double x[3];

  for (int k = 0; k < 3; k++)
    x[k] = m->point[a][k] + u * (m->point[b][k] - m->point[a][k]) +
           v * (m->point[c][k] - m->point[a][k]);
  p = add_point(m, x[0], x[1], x[2] + raise);
  m->tri[t][2] = p;
  add_tri(m, b, c, p, m->tri_patch[t]);
  add_tri(m, c, a, p, m->tri_patch[t]);
  return p;
}

/* A drum of 48 sides and 4 rings. Each square of its side has two triangles, in
 * separate patches or not, and a cap on the diagonal. */
static void make_drum(struct vg_mesh *m, int patches)
{
  uint32_t n = 48, rings = 4, low, high;
  size_t n_side;

  for (int i = 0; i < 3; i++) vg_mesh_add_patch(m, i + 1, "drum");
  for (uint32_t j = 0; j <= rings; j++)
    for (uint32_t i = 0; i < n; i++) {
      double angle = 6.283185307179586 * i / n;

      add_point(m, cos(angle), sin(angle), .13 * j);
    }
  for (uint32_t j = 0; j < rings; j++)
    for (uint32_t i = 0; i < n; i++) {
      uint32_t a = j * n + i, b = j * n + (i + 1) % n, c = b + n, d = a + n;

      add_tri(m, c, a, b, 0);
      add_tri(m, a, c, d, patches ? 1 : 0);
    }
  n_side = m->n_tri;
  low = add_point(m, 0, 0, 0);
  high = add_point(m, 0, 0, .13 * rings);
  for (uint32_t i = 0; i < n; i++) {
    add_tri(m, low, (i + 1) % n, i, 2);
    add_tri(m, high, rings * n + i, rings * n + (i + 1) % n, 2);
  }
  for (size_t t = 0; t < n_side; t += 2) split(m, t, .45, 1e-4, 0);
}

/* --- invariants ---------------------------------------------------------- */

static double volume_of(const struct vg_mesh *m)
{
  const double(*x)[3] = (const double(*)[3])m->point;
  double sum = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    const double *a = x[m->tri[t][0]], *b = x[m->tri[t][1]];
    const double *c = x[m->tri[t][2]];

    for (int k = 0; k < 3; k++) {
      int i = (k + 1) % 3, j = (k + 2) % 3;

      sum += a[k] * (b[i] * c[j] - b[j] * c[i]) / 6;
    }
  }
  return sum;
}

static void assert_valid(struct vg_mesh *m)
{
  struct vg_surface_check_options o = { .external = 1, .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_surface_check(m, &o, &r, &err), VG_OK);
  assert_true(r.is_closed);
  for (size_t i = 0; i < r.n_defect; i++)
    if (r.defect[i].kind != VG_DEFECT_SHELL) {
      char text[512];

      vg_defect_text(m, &r.defect[i], text, sizeof text);
      fail_msg("%s", text);
    }
  vg_surface_report_release(&r);
}

/* Swap with the default options, or without collapses. */
static struct vg_swap_report run(struct vg_mesh *m, int with_collapses)
{
  struct vg_swap_options o = VG_SWAP_OPTIONS_INIT;
  struct vg_swap_report r = VG_SWAP_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double volume = volume_of(m);

  o.collapse = with_collapses;
  if (vg_surface_swap(m, &o, &r, &err) != VG_OK) fail_msg("%s", err.text);
  assert_valid(m);
  assert_true(r.moved_relative <= o.distance * (1 + 1e-12));
  assert_true(fabs(volume_of(m) - volume) < 1e-4 * volume);
  return r;
}

/* Angle at the first corner of three. */
static double angle_at(const double *c, const double *a, const double *b)
{
  double u[3], v[3], x = 0, dot = 0;

  for (int k = 0; k < 3; k++) {
    u[k] = a[k] - c[k];
    v[k] = b[k] - c[k];
    dot += u[k] * v[k];
  }
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;

    x += (u[i] * v[j] - u[j] * v[i]) * (u[i] * v[j] - u[j] * v[i]);
  }
  return atan2(sqrt(x), dot);
}

/* Largest sum of the two angles opposite an edge within a patch. */
static double worst_sum(const struct vg_mesh *m)
{
  const double(*x)[3] = (const double(*)[3])m->point;
  struct vg_faces s = VG_FACES_INIT;
  struct vg_edges e = VG_EDGES_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint32_t *same;
  double worst = 0;

  assert_int_equal(vg_points_same(m, &same, &err), VG_OK);
  assert_int_equal(vg_faces_build(&s, m, same, &err), VG_OK);
  assert_int_equal(vg_faces_edges(&s, &e, &err), VG_OK);
  for (size_t i = 0; i < e.n; i++) {
    uint32_t h[2] = { e.half[e.start[i]], e.half[e.start[i] + 1] };
    double sum = 0;

    if (m->tri_patch[h[0] / 3] != m->tri_patch[h[1] / 3]) continue;
    for (int k = 0; k < 2; k++) {
      const uint32_t *n = m->tri[h[k] / 3];

      sum += angle_at(x[n[(h[k] + 2) % 3]], x[n[h[k] % 3]],
                      x[n[(h[k] + 1) % 3]]);
    }
    if (sum > worst) worst = sum;
  }
  free(same);
  vg_faces_release(&s);
  vg_edges_release(&e);
  return worst;
}

/* --- swaps --------------------------------------------------------------- */

static void leaves_a_cube(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
  struct vg_swap_report r;
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  make_cube(&m, 3, 0, 0);
  assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
  r = run(&m, 1);
  assert_int_equal(r.n_swapped + r.n_collapsed + r.n_kept, 0);
  assert_int_equal(r.n_cap[0] + r.n_cap[1] + r.n_needle[0] + r.n_needle[1], 0);
  assert_true(r.moved == 0 && r.moved_relative == 0);
  assert_int_equal(m.n_tri, old.n_tri);
  assert_memory_equal(m.tri, old.tri, m.n_tri * sizeof *m.tri);
  vg_mesh_release(&m);
  vg_mesh_release(&old);
}

/* Swaps that would gain less than 1 % in the square of a sine are not made; in
 * these triangles that permits a sum of angles of 0.06 above pi. */
static void makes_a_plane_delaunay(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_swap_report r;

  (void)unused;
  make_cube(&m, 12, 1, 1);
  assert_true(worst_sum(&m) > 3.6);
  r = run(&m, 0);
  assert_true(r.n_swapped > 100);
  assert_true(worst_sum(&m) < 3.1416 + .06);
  assert_true(r.moved < 1e-15);
  vg_mesh_release(&m);
}

/* One patch only: the edges of the cube are kept because of their angle. */
static void keeps_ridges(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_swap_report r;

  (void)unused;
  make_cube(&m, 9, 1, 0);
  r = run(&m, 1);
  assert_true(r.n_swapped > 50);
  for (size_t t = 0; t < m.n_tri; t++) {
    int in_side = 0;

    for (int k = 0; k < 3; k++) {
      double a = m.point[m.tri[t][0]][k];

      in_side |= (a == 0 || a == 1) && m.point[m.tri[t][1]][k] == a &&
                 m.point[m.tri[t][2]][k] == a;
    }
    assert_true(in_side);
  }
  vg_mesh_release(&m);
}

static void swaps_caps_away(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_swap_report r;

  (void)unused;
  make_drum(&m, 0);
  r = run(&m, 0);
  assert_int_equal(r.n_cap[0], 48 * 4);
  assert_int_equal(r.n_cap[1], 0);
  assert_int_equal(r.n_needle[1], 0);
  assert_true(r.n_swapped >= 48 * 4);
  assert_int_equal(r.n_collapsed, 0);
  assert_int_equal(m.n_point, 48 * 5 + 2 + 48 * 4);
  vg_mesh_release(&m);
}

/* Now the diagonals are between patches, with the caps on one side of them. */
static void keeps_patches(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
  struct vg_swap_report r;
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  make_drum(&m, 1);
  assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
  r = run(&m, 0);
  assert_int_equal(r.n_swapped, 0);
  assert_int_equal(r.n_cap[1], 48 * 4);
  assert_memory_equal(m.tri, old.tri, m.n_tri * sizeof *m.tri);
  r = run(&m, 1); /* but the apexes may be removed */
  assert_int_equal(r.n_collapsed, 48 * 4);
  assert_int_equal(r.n_cap[1], 0);
  assert_int_equal(m.n_point, 48 * 5 + 2);
  vg_mesh_release(&m);
  vg_mesh_release(&old);
}

/* --- collapses ----------------------------------------------------------- */

/* A point 0.3 % of an edge away from a node of each triangle of the cube. */
static void removes_points_that_are_near(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_swap_report r;
  size_t n_tri, n_point;

  (void)unused;
  make_cube(&m, 4, 0, 1);
  n_tri = m.n_tri;
  n_point = m.n_point;
  for (size_t t = 0; t < n_tri; t++) split(&m, t, .003, .003, 0);
  r = run(&m, 1);
  assert_int_equal(r.n_collapsed, n_tri);
  assert_true(r.n_needle[0] + r.n_cap[0] >= n_tri);
  assert_int_equal(r.n_needle[1] + r.n_cap[1], 0);
  assert_int_equal(m.n_tri, n_tri);
  assert_int_equal(m.n_point, n_point);
  assert_true(r.moved < 1e-15);
  vg_mesh_release(&m);
}

/* Points on the edges of a cube, next to its corners, are collapsed along the
 * edges: the corners stay. */
static void removes_points_along_edges(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT;
  size_t n_corner = 0;
  struct vg_swap_report r;

  (void)unused;
  make_cube(&m, 4, 0, 1);
  for (size_t i = 0; i < m.n_point; i++)
    for (int k = 0; k < 3; k++)
      if (m.point[i][k] == .25) m.point[i][k] = .002;
  r = run(&m, 1);
  assert_true(r.n_collapsed > 12);
  for (size_t i = 0; i < m.n_point; i++) {
    int ends = 0;

    for (int k = 0; k < 3; k++)
      ends += m.point[i][k] == 0 || m.point[i][k] == 1;
    n_corner += ends == 3;
  }
  assert_int_equal(n_corner, 8);
  assert_true(fabs(volume_of(&m) - 1) < 1e-12);
  vg_mesh_release(&m);
}

/* --- other parts of the surface ------------------------------------------ */

/* A cap raised slightly above the top of a cube; its swap would lift the top
 * over the tip of a nearby body. */
static void make_tip(struct vg_mesh *m, int with_body)
{
  size_t t = 5 * 2; /* the top, z = 1, with diagonal 0 0 to 1 1 */
  uint32_t a, b, c, d;

  make_cube(m, 1, 0, 1);
  /* first corner, and the last, on the diagonal; cap next to it */
  assert_true(m->point[m->tri[t][1]][2] == 1);
  split(m, t, 1e-4, .5, 3e-4);
  if (!with_body) return;
  a = add_point(m, .499, .501, 1 + 1e-4);
  b = add_point(m, .4, .5, 1.5);
  c = add_point(m, .5, .6, 1.5);
  d = add_point(m, .6, .4, 1.5);
  add_tri(m, a, c, b, 0);
  add_tri(m, a, d, c, 0);
  add_tri(m, a, b, d, 0);
  add_tri(m, b, c, d, 0);
}

static void undoes_swaps_that_cause_intersections(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
  struct vg_swap_report r;
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  make_tip(&m, 0);
  r = run(&m, 0);
  assert_int_equal(r.n_swapped, 1);
  assert_int_equal(r.n_kept, 0);
  assert_true(r.moved > 1e-4 && r.moved < 4e-4);
  vg_mesh_release(&m);

  make_tip(&m, 1);
  assert_valid(&m);
  assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
  r = run(&m, 0);
  assert_int_equal(r.n_swapped, 0);
  assert_true(r.n_kept >= 3);
  assert_memory_equal(m.tri, old.tri, m.n_tri * sizeof *m.tri);
  vg_mesh_release(&m);
  vg_mesh_release(&old);
}

/* --- refusals ------------------------------------------------------------ */

static void refuse(struct vg_mesh *m, const struct vg_swap_options *o,
                   const char *phrase)
{
  struct vg_swap_report r = VG_SWAP_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh old = VG_MESH_INIT;

  assert_int_equal(vg_mesh_copy(&old, m, &err), VG_OK);
  r.n_swapped = 77;
  assert_int_equal(vg_surface_swap(m, o, &r, &err), VG_ERR_INPUT);
  if (!strstr(err.text, phrase)) fail_msg("%s", err.text);
  assert_int_equal(r.n_swapped, 77);
  assert_int_equal(m->n_tri, old.n_tri);
  assert_memory_equal(m->tri, old.tri, m->n_tri * sizeof *m->tri);
  vg_mesh_release(&old);
}

static void refuses_bad_surfaces(void **unused)
{
  static const struct vg_swap_options o = VG_SWAP_OPTIONS_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  uint32_t keep;

  (void)unused;
  make_cube(&m, 2, 0, 1);
  m.n_tri--;
  refuse(&m, &o, "no neighbour");
  m.n_tri++;
  keep = m.tri[5][1];
  m.tri[5][1] = m.tri[5][2];
  m.tri[5][2] = keep;
  refuse(&m, &o, "opposite orientation");
  m.tri[5][2] = m.tri[5][1];
  m.tri[5][1] = keep;
  add_tri(&m, m.tri[0][0], m.tri[0][1], m.tri[0][2], 0);
  refuse(&m, &o, "more than one neighbour");
  m.n_tri--;
  m.tri[7][0] = m.tri[7][1];
  refuse(&m, &o, "a node twice");
  m.tri[7][0] = 9999;
  refuse(&m, &o, "triangle 8 has a node");
  vg_mesh_release(&m);
  make_cube(&m, 2, 0, 1);
  m.point[3][1] = NAN;
  refuse(&m, &o, "not finite");
  vg_mesh_release(&m);
}

static void refuses_other_elements(void **unused)
{
  static const struct vg_swap_options o = VG_SWAP_OPTIONS_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  (void)unused;
  make_cube(&m, 1, 0, 1);
  m.quad = calloc(1, sizeof *m.quad);
  m.quad_patch = calloc(1, sizeof *m.quad_patch);
  m.n_quad = 1;
  refuse(&m, &o, "quadrilateral");
  m.n_quad = 0;
  m.tet = calloc(1, sizeof *m.tet);
  m.n_tet = 1;
  refuse(&m, &o, "cells");
  vg_mesh_release(&m);
}

static void refuses_bad_options(void **unused)
{
  static const struct vg_swap_options bad[] = {
    { -1, 10, 1, .02 },   { NAN, 10, 1, .02 },  { INFINITY, 10, 1, .02 },
    { 1e-3, 90, 1, .02 }, { 1e-3, -1, 1, .02 }, { 1e-3, NAN, 1, .02 },
    { 1e-3, 10, 1, 1 },   { 1e-3, 10, 1, -.1 }, { 1e-3, 10, 1, NAN },
  };
  struct vg_mesh m = VG_MESH_INIT;

  (void)unused;
  make_cube(&m, 1, 0, 1);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    refuse(&m, &bad[i], "must be");
  vg_mesh_release(&m);
}

static void accepts_an_empty_surface(void **unused)
{
  struct vg_swap_options o = VG_SWAP_OPTIONS_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  assert_int_equal(vg_surface_swap(&m, &o, NULL, &err), VG_OK);
  assert_int_equal(m.n_tri, 0);
}

/* --- real surfaces ------------------------------------------------------- */

struct real {
  const char *name;
  double volume;  /* largest relative change of it */
  double slivers; /* largest remaining share of the slivers */
};

/* The volume of the low boom aircraft is of triangles with edges of 1 to 6 m,
 * whose points may move by 1e-3: 1.4e-5 was measured. */
static const struct real real[] = {
  { "supersonic/f16_full.lb8.ugrid.xz", 1e-5, .45 },
  { "supersonic/concorde_full.lb8.ugrid.xz", 1e-5, .45 },
  { "supersonic/low_boom_sst_full.lb8.ugrid.xz", 3e-5, .7 },
  { "supersonic/tnd6480_delta_wing_body.lb8.ugrid.xz", 1e-5, 1 },
  { "bizjet/p180_avanti_full.lb8.ugrid.xz", 1e-5, .3 },
  { "highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz", 1e-5, 1 },
  { "transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz", 1e-5, .8 },
};

static void improve(const struct real *x)
{
  struct vg_surface_check_options o = { .repair = 1,
                                        .external = 1,
                                        .threads = 1 };
  struct vg_surface_report s = VG_SURFACE_REPORT_INIT;
  struct vg_mesh m = VG_MESH_INIT, twin = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_swap_report r;
  const char *path = io_real(x->name);
  double volume;
  size_t n;

  assert_int_equal(vg_ugrid_read(path, &m, NULL, &err), VG_OK);
  remove(path);
  m.n_tet = m.n_pyr = m.n_pri = m.n_hex = 0;
  assert_int_equal(vg_surface_check(&m, &o, &s, &err), VG_OK);
  vg_surface_report_release(&s);
  assert_int_equal(vg_mesh_copy(&twin, &m, &err), VG_OK);
  volume = volume_of(&m);
  n = m.n_point;
  r = run(&m, 1);
  assert_int_equal(m.n_point + r.n_collapsed, n);
  assert_true(fabs(volume_of(&m) - volume) < x->volume * fabs(volume));
  assert_true((double)(r.n_cap[1] + r.n_needle[1]) <=
              x->slivers * (double)(r.n_cap[0] + r.n_needle[0]));
  run(&twin, 1);
  assert_int_equal(m.n_tri, twin.n_tri);
  assert_memory_equal(m.tri, twin.tri, m.n_tri * sizeof *m.tri);
  vg_mesh_release(&m);
  vg_mesh_release(&twin);
}

static void improves_real_surfaces(void **unused)
{
  (void)unused;
  for (size_t i = 0; i < sizeof real / sizeof *real; i++) improve(&real[i]);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(leaves_a_cube),
    cmocka_unit_test(makes_a_plane_delaunay),
    cmocka_unit_test(keeps_ridges),
    cmocka_unit_test(swaps_caps_away),
    cmocka_unit_test(keeps_patches),
    cmocka_unit_test(removes_points_that_are_near),
    cmocka_unit_test(removes_points_along_edges),
    cmocka_unit_test(undoes_swaps_that_cause_intersections),
    cmocka_unit_test(refuses_bad_surfaces),
    cmocka_unit_test(refuses_other_elements),
    cmocka_unit_test(refuses_bad_options),
    cmocka_unit_test(accepts_an_empty_surface),
    cmocka_unit_test(improves_real_surfaces),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
