/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Slide patches: how they are found, their normals, and the front around
 * columns. Columns are made here from point normals, one per wall point. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"
#include "core/geometry/vector.h"
#include "core/surface/surface_check.h"
#include "fill_shapes.h"
#include "layers/slide/slide.h"

/* Surfaces ----------------------------------------------------------------*/

struct grid {
  struct vg_mesh m;
  size_t cap_point, cap_tri, cap_patch;
};

static uint32_t add_point(struct grid *g, double x, double y, double z)
{
  assert_int_equal(vg_reserve(&g->m.point, &g->cap_point, g->m.n_point + 1,
                              sizeof *g->m.point),
                   0);
  g->m.point[g->m.n_point][0] = x;
  g->m.point[g->m.n_point][1] = y;
  g->m.point[g->m.n_point][2] = z;
  return (uint32_t)g->m.n_point++;
}

static void add_tri(struct grid *g, uint32_t a, uint32_t b, uint32_t c,
                    uint32_t patch)
{
  const size_t t = g->m.n_tri;

  assert_int_equal(vg_reserve(&g->m.tri, &g->cap_tri, t + 1, sizeof *g->m.tri),
                   0);
  assert_int_equal(vg_reserve(&g->m.tri_patch, &g->cap_patch, t + 1,
                              sizeof *g->m.tri_patch),
                   0);
  g->m.tri[t][0] = a;
  g->m.tri[t][1] = b;
  g->m.tri[t][2] = c;
  g->m.tri_patch[t] = patch;
  g->m.n_tri++;
}

/* Two triangles, counter-clockwise a b c d. */
static void add_quad(struct grid *g, uint32_t a, uint32_t b, uint32_t c,
                     uint32_t d, uint32_t patch)
{
  add_tri(g, a, b, c, patch);
  add_tri(g, a, c, d, patch);
}

static void add_patches(struct grid *g, int n)
{
  for (int i = 0; i < n; i++)
    assert_int_equal(vg_mesh_add_patch(&g->m, i + 1, "part"), i);
}

/* The inside of the unit cube, n cells along each edge, through `map`. Patches:
 * 0 z=0, 1 z=1, 2 y=0, 3 y=1, 4 x=0, 5 x=1; merged: all sides 2. */
static void make_box(struct grid *g, int n, int merged,
                     void (*map)(double x[3]))
{
  const int s = n + 1;
  uint32_t *at = vg_alloc((size_t)(s * s * s), sizeof *at);

  memset(g, 0, sizeof *g);
  for (int i = 0; i < s * s * s; i++) {
    const int c[3] = { i % s, i / s % s, i / s / s };
    double x[3];
    int border = 0;

    for (int k = 0; k < 3; k++) {
      x[k] = (double)c[k] / n;
      border |= c[k] == 0 || c[k] == n;
    }
    if (!border) continue;
    if (map) map(x);
    at[i] = add_point(g, x[0], x[1], x[2]);
  }
  for (int f = 0; f < 6; f++) {
    static const int axis[6] = { 2, 2, 1, 1, 0, 0 };
    const int w = axis[f], u = (w + 1) % 3, v = (w + 2) % 3;
    const int step[3] = { 1, s, s * s };

    for (int j = 0; j < n; j++)
      for (int i = 0; i < n; i++) {
        const int o = (f % 2 ? n : 0) * step[w] + i * step[u] + j * step[v];
        const uint32_t a = at[o], b = at[o + step[u]];
        const uint32_t c = at[o + step[u] + step[v]], d = at[o + step[v]];
        const uint32_t patch = merged && f > 2 ? 2 : (uint32_t)f;

        if (f % 2) add_quad(g, a, d, c, b, patch);
        else add_quad(g, a, b, c, d, patch);
      }
  }
  add_patches(g, merged ? 3 : 6);
  free(at);
}

/* A body along y from 0 to 1 with radius r0 at y = 0 and r1 at y = 1, in a
 * square duct of half width 4. Patches: 0 body, 1 y=0, 2 y=1, 3 duct. */
static void make_duct(struct grid *g, double r0, double r1, int n, int n_y)
{
  enum { N_RING = 9 };
  uint32_t *plane[2], *body, *duct;

  memset(g, 0, sizeof *g);
  for (int e = 0; e < 2; e++) plane[e] = vg_alloc((size_t)n * N_RING, 4);
  body = vg_alloc((size_t)(n * (n_y + 1)), sizeof *body);
  duct = vg_alloc((size_t)(n * (n_y + 1)), sizeof *duct);
  for (int e = 0; e < 2; e++)
    for (int j = 0; j < N_RING; j++)
      for (int i = 0; i < n; i++) {
        const double a = 2 * M_PI * i / n, c = cos(a), s = sin(a);
        const double far = 4 / fmax(fabs(c), fabs(s)), near = e ? r1 : r0;
        const double t = pow((double)j / (N_RING - 1), 1.5);
        const double r = near + t * (far - near);

        plane[e][j * n + i] = add_point(g, r * c, e, r * s);
      }
  for (int j = 0; j <= n_y; j++)
    for (int i = 0; i < n; i++) {
      const double y = (double)j / n_y, a = 2 * M_PI * i / n;
      const double c = cos(a), s = sin(a), r = r0 + y * (r1 - r0);
      const double far = 4 / fmax(fabs(c), fabs(s));
      const int e = j ? 1 : 0, is_end = j == 0 || j == n_y;

      body[j * n + i] = is_end ? plane[e][i] : add_point(g, r * c, y, r * s);
      duct[j * n + i] = is_end ? plane[e][(N_RING - 1) * n + i]
                               : add_point(g, far * c, y, far * s);
    }
  for (int i = 0; i < n; i++) {
    const int k = (i + 1) % n;

    for (int j = 0; j + 1 < N_RING; j++) {
      add_quad(g, plane[0][j * n + i], plane[0][j * n + k],
               plane[0][(j + 1) * n + k], plane[0][(j + 1) * n + i], 1);
      add_quad(g, plane[1][j * n + i], plane[1][(j + 1) * n + i],
               plane[1][(j + 1) * n + k], plane[1][j * n + k], 2);
    }
    for (int j = 0; j < n_y; j++) {
      add_quad(g, body[j * n + i], body[(j + 1) * n + i], body[(j + 1) * n + k],
               body[j * n + k], 0);
      add_quad(g, duct[j * n + i], duct[j * n + k], duct[(j + 1) * n + k],
               duct[(j + 1) * n + i], 3);
    }
  }
  add_patches(g, 4);
  for (int e = 0; e < 2; e++) free(plane[e]);
  free(body);
  free(duct);
}

/* Half a sphere (patch 0, radius 1) on the plane z = 0 (patch 1) inside half a
 * sphere of radius 8 (patch 2). */
static void make_dome(struct grid *g, int n, int n_up, int n_out)
{
  uint32_t *ring[3], top;

  memset(g, 0, sizeof *g);
  for (int f = 0; f < 3; f++)
    ring[f] = vg_alloc((size_t)(n * (n_up + n_out + 1)), sizeof *ring[f]);
  for (int j = 0; j <= n_out; j++)
    for (int i = 0; i < n; i++) {
      const double a = 2 * M_PI * i / n, r = pow(8, (double)j / n_out);

      ring[1][j * n + i] = add_point(g, r * cos(a), r * sin(a), 0);
    }
  for (int f = 0; f < 3; f += 2) {
    const double r = f ? 8 : 1;

    for (int j = 0; j < n_up; j++)
      for (int i = 0; i < n; i++) {
        const double a = 2 * M_PI * i / n, b = M_PI / 2 * j / n_up;

        ring[f][j * n + i] = j == 0
                             ? ring[1][(f ? n_out : 0) * n + i]
                             : add_point(g, r * cos(a) * cos(b),
                                         r * sin(a) * cos(b), r * sin(b));
      }
    top = add_point(g, 0, 0, r);
    for (int i = 0; i < n; i++) {
      const int k = (i + 1) % n;
      const uint32_t *u = ring[f] + (n_up - 1) * n;

      for (int j = 0; j + 1 < n_up; j++) {
        const uint32_t *l = ring[f] + j * n;

        if (f) add_quad(g, l[i], l[n + i], l[n + k], l[k], 2);
        else add_quad(g, l[i], l[k], l[n + k], l[n + i], 0);
      }
      if (f) add_tri(g, u[i], top, u[k], 2);
      else add_tri(g, u[i], u[k], top, 0);
    }
  }
  for (int j = 0; j < n_out; j++)
    for (int i = 0; i < n; i++) {
      const int k = (i + 1) % n;
      const uint32_t *l = ring[1] + j * n;

      add_quad(g, l[i], l[n + i], l[n + k], l[k], 1);
    }
  add_patches(g, 3);
  for (int f = 0; f < 3; f++) free(ring[f]);
}

/* Columns -----------------------------------------------------------------*/

struct made {
  struct grid g;
  uint8_t is_wall[8];
  size_t n_slide;
  struct vg_slide *slide;
  struct vg_columns c;
  struct vg_sizing *sizing;
  struct vg_front front;
  struct vg_slide_failure failure;
  struct vg_error err;
};

static void release(struct made *a)
{
  vg_mesh_release(&a->g.m);
  free(a->slide);
  vg_columns_release(&a->c);
  vg_sizing_free(a->sizing);
  vg_front_release(&a->front);
  free(a->failure.column);
}

/* Project v to the patches with normals n[0 .. k - 1] in which it slides. */
static void constrain(int k, double n[2][3], double v[3])
{
  if (k == 2) {
    double line[3], d;

    vg_cross(n[0], n[1], line);
    vg_unit(line);
    d = vg_dot(v, line);
    for (int j = 0; j < 3; j++) v[j] = line[j] == 0 ? 0 : d * line[j];
  } else if (k == 1) {
    const double d = vg_dot(v, n[0]);

    for (int j = 0; j < 3; j++)
      v[j] = fabs(n[0][j]) == 1 ? 0 : v[j] - d * n[0][j];
  }
}

static void find_rims(struct made *a, const uint32_t *column_of)
{
  const struct vg_mesh *m = &a->g.m;
  struct vg_columns *c = &a->c;

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && a->is_wall[m->tri_patch[t]]; k++)
      for (size_t u = 0; u < m->n_tri; u++)
        for (int l = 0; l < 3 && !a->is_wall[m->tri_patch[u]]; l++) {
          const uint32_t p = m->tri[t][k], q = m->tri[t][(k + 1) % 3];

          if (m->tri[u][l] != q || m->tri[u][(l + 1) % 3] != p) continue;
          c->border[c->n_border][0] = column_of[p];
          c->border[c->n_border][1] = column_of[q];
          c->border_patch[c->n_border++] = m->tri_patch[u];
          for (int e = 0; e < 2; e++) {
            uint32_t *s = c->column[column_of[e ? p : q]].slide;

            if (s[0] == m->tri_patch[u]) continue;
            if (s[0] == VG_NO_INDEX) s[0] = m->tri_patch[u];
            else s[1] = m->tri_patch[u];
          }
        }
}

static void add_faces(struct made *a, const uint32_t *column_of)
{
  const struct vg_mesh *m = &a->g.m;
  struct vg_columns *c = &a->c;

  for (size_t t = 0; t < m->n_tri; t++) {
    double u[3], v[3], n[3];

    if (!a->is_wall[m->tri_patch[t]]) continue;
    vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], u);
    vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], v);
    vg_cross(u, v, n);
    c->face_tri[c->n_face] = (uint32_t)t;
    for (int k = 0; k < 3; k++) {
      c->face[c->n_face][k] = column_of[m->tri[t][k]];
      for (int j = 0; j < 3; j++)
        c->column[column_of[m->tri[t][k]]].dir[j] += n[j];
    }
    c->n_face++;
  }
}

/* Columns of n levels, the first 0.01 high, growing by 1.2. */
static void make_columns(struct made *a, int n)
{
  const struct vg_mesh *m = &a->g.m;
  struct vg_columns *c = &a->c;
  uint32_t *column_of = vg_calloc(m->n_point, sizeof *column_of);

  assert_int_equal(vg_slides_find(m, a->is_wall, &a->n_slide, &a->slide,
                                  &a->err),
                   VG_OK);
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && a->is_wall[m->tri_patch[t]]; k++)
      column_of[m->tri[t][k]] = 1;
  c->column = vg_calloc(m->n_point, sizeof *c->column);
  c->face = vg_calloc(m->n_tri, sizeof *c->face);
  c->face_tri = vg_calloc(m->n_tri, sizeof *c->face_tri);
  c->border = vg_calloc(3 * m->n_tri, sizeof *c->border);
  c->border_patch = vg_calloc(3 * m->n_tri, sizeof *c->border_patch);
  c->law = vg_calloc(1, sizeof *c->law);
  c->law[0] = (struct vg_growth_law){ 0.01, 0.2, 0, 1.3, 1 };
  c->n_law = 1;
  for (uint32_t p = 0; p < m->n_point; p++) {
    struct vg_column *col = &c->column[c->n_column];

    if (!column_of[p]) continue;
    col->root = p;
    col->slide[0] = col->slide[1] = VG_NO_INDEX;
    col->cap = 1.3;
    col->bent = SIZE_MAX;
    col->n = col->n_wanted = col->n_fit = (uint16_t)n;
    column_of[p] = (uint32_t)c->n_column++;
  }
  add_faces(a, column_of);
  find_rims(a, column_of);
  for (size_t i = 0; i < c->n_column; i++) {
    struct vg_column *col = &c->column[i];
    double normal[2][3];
    int k = 0;

    for (int e = 0; e < 2; e++)
      for (size_t s = 0; s < a->n_slide; s++)
        if (a->slide[s].patch == col->slide[e])
          vg_slide_normal(&a->slide[s], m, col->root, normal[k++]);
    constrain(k, normal, col->dir);
    vg_unit(col->dir);
  }
  free(column_of);
}

static void grow(struct made *a, uint32_t wall, uint32_t wall2, int n)
{
  const struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;

  a->is_wall[wall] = a->is_wall[wall2] = 1;
  make_columns(a, n);
  assert_int_equal(vg_sizing_new(&o, 0, NULL, &a->g.m, &a->sizing, &a->err),
                   VG_OK);
}

static vg_status front(struct made *a)
{
  return vg_slide_front(&a->g.m, a->n_slide, a->slide, NULL, &a->c, a->sizing,
                        &a->front, &a->failure, &a->err);
}

/* Checks ------------------------------------------------------------------*/

static void save(const struct vg_mesh *m, const char *name)
{
  char path[256];
  FILE *f;

  if (!getenv("VG_SLIDE_SAVE")) return;
  snprintf(path, sizeof path, "%s/%s.obj", getenv("VG_SLIDE_SAVE"), name);
  f = fopen(path, "w");
  if (!f) return;
  for (size_t i = 0; i < m->n_point; i++)
    fprintf(f, "v %.17g %.17g %.17g\n", m->point[i][0], m->point[i][1],
            m->point[i][2]);
  for (size_t i = 0; i < m->n_tri; i++)
    fprintf(f, "f %u %u %u\n", m->tri[i][0] + 1, m->tri[i][1] + 1,
            m->tri[i][2] + 1);
  fclose(f);
}

static void assert_sound(struct made *a)
{
  const struct vg_surface_check_options o = { .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  char text[200];

  assert_int_equal(vg_surface_check(FRONT_MESH(&a->front, &a->g.m), &o, &r,
                                    &a->err),
                   VG_OK);
  for (size_t i = 0; i < r.n_defect && i < 4; i++) {
    vg_defect_text(FRONT_MESH(&a->front, &a->g.m), &r.defect[i], text,
                   sizeof text);
    print_message("%s\n", text);
  }
  assert_int_equal(r.n_defect, 0);
  assert_true(r.is_closed);
  vg_surface_report_release(&r);
}

static void triangle(const struct vg_mesh *m, size_t t, double n[3])
{
  double u[3], v[3];

  vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], u);
  vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], v);
  vg_cross(u, v, n);
  for (int k = 0; k < 3; k++) n[k] /= 2;
}

static double least_angle(const struct vg_mesh *m, size_t t)
{
  double least = M_PI;

  for (int k = 0; k < 3; k++) {
    const double *o = m->point[m->tri[t][k]];
    double u[3], v[3], c[3];

    vg_sub(m->point[m->tri[t][(k + 1) % 3]], o, u);
    vg_sub(m->point[m->tri[t][(k + 2) % 3]], o, v);
    vg_cross(u, v, c);
    least = fmin(least, atan2(vg_norm(c), vg_dot(u, v)));
  }
  return least * 180 / M_PI;
}

/* The patch of slide s in the front is in its plane to the last bit, correctly
 * oriented, and has well-shaped triangles; its area and that of the side faces
 * add up to the original area. */
static void assert_plane(struct made *a, size_t s, double min_angle)
{
  const struct vg_slide *sl = &a->slide[s];
  const struct vg_mesh *m = FRONT_MESH(&a->front, &a->g.m), *o = &a->g.m;
  double area = 0, before = 0, n[3], least = 180;

  assert_true(sl->is_plane);
  for (size_t t = 0; t < m->n_tri; t++) {
    if (m->tri_patch[t] != sl->patch) continue;
    for (int k = 0; k < 3 && sl->axis >= 0; k++)
      assert_true(m->point[m->tri[t][k]][sl->axis] ==
                  sl->at * sl->normal[sl->axis]);
    triangle(m, t, n);
    assert_true(vg_dot(n, sl->normal) > 0);
    area += vg_dot(n, sl->normal);
    least = fmin(least, least_angle(m, t));
    assert_int_equal(a->front.face_id[t], VG_NO_INDEX);
  }
  if (least < min_angle) print_message("least angle %.3f\n", least);
  assert_true(least >= min_angle);
  for (size_t t = 0; t < o->n_tri; t++) {
    if (o->tri_patch[t] != sl->patch) continue;
    triangle(o, t, n);
    before += vg_dot(n, sl->normal);
  }
  for (size_t i = 0; i < a->c.n_border; i++) {
    const uint32_t *r = a->c.border[i];
    const double *x = o->point[a->c.column[r[0]].root];
    const double *y = o->point[a->c.column[r[1]].root];
    double p[3], q[3], u[3], v[3], w[3];

    if (a->c.border_patch[i] != sl->patch) continue;
    vg_column_top(&a->c, o, r[0], p);
    vg_column_top(&a->c, o, r[1], q);
    vg_sub(q, x, u);
    vg_sub(p, y, v);
    vg_cross(v, u, w);
    area += vg_dot(w, sl->normal) / 2;
  }
  assert_true(fabs(area - before) <= 1e-10 * before);
}

/* Every top is at its column's end; points of the surface keep their ids. */
static void assert_points(const struct made *a)
{
  const struct vg_front *f = &a->front;

  for (size_t i = 0; i < f->n_point; i++) {
    uint32_t column = vg_layer_column_of(f->id[i]);
    uint32_t point = vg_layer_point_of(f->id[i]);
    double x[3];

    if (column != VG_NO_INDEX) {
      assert_true(a->c.column[column].n > 0);
      vg_column_top(&a->c, &a->g.m, column, x);
      assert_memory_equal(x, f->x[i], sizeof x);
      assert_int_equal(point, VG_NO_INDEX);
    } else if (point != VG_NO_INDEX) {
      assert_memory_equal(a->g.m.point[point], f->x[i], sizeof x);
    }
    if (i && point != VG_NO_INDEX) assert_true(f->id[i - 1] < f->id[i]);
  }
}

static void assert_same_again(struct made *a)
{
  struct vg_front first = a->front;

  a->front = (struct vg_front)VG_FRONT_INIT;
  assert_int_equal(front(a), VG_OK);
  assert_int_equal(first.n_face, a->front.n_face);
  assert_int_equal(first.n_point, a->front.n_point);
  assert_memory_equal(first.x, a->front.x, first.n_point * sizeof *first.x);
  assert_memory_equal(first.face, a->front.face,
                      first.n_face * sizeof *first.face);
  vg_front_release(&first);
}

/* Tests -------------------------------------------------------------------*/

static void finds_planes_and_normals(void **state)
{
  struct made a = { 0 };
  double n[3];

  (void)state;
  make_dome(&a.g, 24, 6, 10);
  a.is_wall[0] = 1;
  assert_int_equal(vg_slides_find(&a.g.m, a.is_wall, &a.n_slide, &a.slide,
                                  &a.err),
                   VG_OK);
  assert_int_equal(a.n_slide, 1);
  assert_int_equal(a.slide[0].patch, 1);
  assert_true(a.slide[0].is_plane);
  assert_int_equal(a.slide[0].axis, 2);
  assert_true(a.slide[0].normal[2] == 1 && a.slide[0].at == 0);
  free(a.slide);
  a.slide = NULL;
  /* The body as slide patch of the plane: curved, normals outward from the
   * axis. */
  a.is_wall[0] = 0;
  a.is_wall[1] = 1;
  assert_int_equal(vg_slides_find(&a.g.m, a.is_wall, &a.n_slide, &a.slide,
                                  &a.err),
                   VG_OK);
  assert_int_equal(a.n_slide, 2);
  assert_false(a.slide[0].is_plane);
  for (uint32_t p = 0; p < 24; p++) {
    struct vg_slide bare = a.slide[0];
    double again[3];

    vg_slide_normal(&a.slide[0], &a.g.m, p, n);
    bare.n_vertex = 0;
    vg_slide_normal(&bare, &a.g.m, p, again);
    for (int k = 0; k < 3; k++) assert_true(fabs(n[k] - again[k]) < 1e-14);
    /* Half a strip of 15 degrees leans inward by 7.5, no more. */
    assert_true(vg_dot(n, a.g.m.point[p]) > 0.98);
  }
  release(&a);
}

/* The same square twice: a corner cut into 1 or 4 triangles has one normal. */
static void normals_are_weighted_by_angle(void **state)
{
  struct grid g = { 0 };
  struct vg_slide s = { .patch = 0, .axis = -1, .normal = { 0, 0, 1 } };
  double n[3];

  (void)state;
  add_point(&g, 0, 0, 0);
  for (int i = 0; i <= 4; i++)
    add_point(&g, cos(M_PI / 8 * i), sin(M_PI / 8 * i), 0);
  add_point(&g, 0, 0, 3);
  for (uint32_t i = 1; i < 5; i++) add_tri(&g, 0, i, i + 1, 0);
  add_tri(&g, 0, 6, 1, 0);
  add_tri(&g, 0, 5, 6, 0);
  add_patches(&g, 1);
  vg_slide_normal(&s, &g.m, 0, n);
  for (int k = 0; k < 3; k++) assert_true(fabs(n[k] - 1 / sqrt(3)) < 1e-12);
  vg_mesh_release(&g.m);
}

static void noise_is_still_a_plane(void **state)
{
  struct made a = { 0 };

  (void)state;
  make_box(&a.g, 6, 0, NULL);
  a.is_wall[0] = 1;
  for (size_t i = 0; i < a.g.m.n_point; i++)
    if (a.g.m.point[i][0] == 0)
      a.g.m.point[i][0] = 2e-7 * (double)((int)(i * 7 % 5) - 2);
  assert_int_equal(vg_slides_find(&a.g.m, a.is_wall, &a.n_slide, &a.slide,
                                  &a.err),
                   VG_OK);
  assert_int_equal(a.n_slide, 4);
  assert_int_equal(a.slide[2].patch, 4);
  assert_true(a.slide[2].is_plane);
  assert_int_equal(a.slide[2].axis, -1);
  assert_true(a.slide[2].normal[0] == 1);
  assert_int_equal(a.slide[3].axis, 0);
  release(&a);
}

static void dome_on_a_plane(void **state)
{
  struct made a = { 0 };

  (void)state;
  make_dome(&a.g, 32, 8, 14);
  grow(&a, 0, 0, 15);
  assert_int_equal(front(&a), VG_OK);
  save(FRONT_MESH(&a.front, &a.g.m), "dome");
  assert_sound(&a);
  assert_points(&a);
  assert_plane(&a, 0, 15);
  assert_same_again(&a);
  release(&a);
}

static void body_between_planes(void **state)
{
  static const double r[3][2] = { { 1, 1 }, { 1.2, 0.6227 }, { 0.6, 1.55 } };

  (void)state;
  for (int i = 0; i < 3; i++) { /* met at 90, 60 and 120, 136 and 44 */
    struct made a = { 0 };

    make_duct(&a.g, r[i][0], r[i][1], 36, 6);
    grow(&a, 0, 0, i == 2 ? 8 : 12);
    for (size_t j = 0; j < a.c.n_column; j++) { /* along the planes */
      a.c.column[j].dir[1] = 0;
      vg_unit(a.c.column[j].dir);
    }
    assert_int_equal(front(&a), VG_OK);
    save(FRONT_MESH(&a.front, &a.g.m), "duct");
    assert_sound(&a);
    assert_points(&a);
    assert_plane(&a, 0, 15);
    assert_plane(&a, 1, 15);
    assert_same_again(&a);
    release(&a);
  }
}

/* Every other wedge of the body has no layers: the tops along boundary edges
 * rise and fall. */
static void levels_rise_from_zero_and_fall(void **state)
{
  struct made a = { 0 };
  size_t n_wall = 0;

  (void)state;
  make_duct(&a.g, 1, 1, 36, 6);
  grow(&a, 0, 0, 0);
  for (size_t i = 0; i < a.c.n_column; i++) {
    const double *x = a.g.m.point[a.c.column[i].root];
    const int sector = (int)lround(atan2(x[2], x[0]) * 18 / M_PI);

    a.c.column[i].n = (uint16_t)(sector > 0 ? sector > 9 ? 18 - sector : sector
                                            : 0);
  }
  assert_int_equal(front(&a), VG_OK);
  assert_sound(&a);
  assert_points(&a);
  assert_plane(&a, 0, 8);
  for (size_t t = 0; t < a.front.n_face; t++)
    n_wall += a.front.patch[t] == 0 && a.front.face_id[t] == VG_NO_INDEX;
  assert_true(n_wall > 36 * 6 / 2);
  release(&a);
}

static void nothing_grows_nothing_changes(void **state)
{
  struct made a = { 0 };

  (void)state;
  make_box(&a.g, 5, 0, NULL);
  grow(&a, 0, 0, 0);
  assert_int_equal(front(&a), VG_OK);
  assert_int_equal(a.front.n_face, a.g.m.n_tri);
  assert_memory_equal(a.front.face, a.g.m.tri, a.g.m.n_tri * sizeof *a.g.m.tri);
  release(&a);
}

/* A floor with four sides: the corner columns follow the vertical edges. */
static void floor_with_four_sides(void **state)
{
  (void)state;
  for (int n = 1; n < 14; n += 6) {
    struct made a = { 0 };

    make_box(&a.g, 10, 0, NULL);
    grow(&a, 0, 0, n);
    assert_int_equal(front(&a), VG_OK);
    save(FRONT_MESH(&a.front, &a.g.m), "box");
    assert_sound(&a);
    assert_points(&a);
    for (size_t s = 0; s < 4; s++) assert_plane(&a, s, 15);
    assert_same_again(&a);
    release(&a);
  }
}

static void tilt(double x[3])
{
  const double y = x[1], z = x[2];

  x[1] = 0.8 * y - 0.6 * z;
  x[2] = 0.6 * y + 0.8 * z;
}

/* Planes that are not normal to an axis. */
static void tilted_floor(void **state)
{
  struct made a = { 0 };

  (void)state;
  make_box(&a.g, 10, 0, tilt);
  grow(&a, 0, 0, 10);
  assert_int_equal(a.slide[0].axis, -1);
  assert_int_equal(front(&a), VG_OK);
  assert_sound(&a);
  assert_points(&a);
  for (size_t s = 0; s < 4; s++) assert_plane(&a, s, 15);
  release(&a);
}

/* Floor and roof: both ends of the vertical edges are covered by layers. */
static void floor_and_roof(void **state)
{
  static const int n[3] = { 3, 10, 14 }; /* heights 0.04, 0.26, 0.59 */

  (void)state;
  for (int i = 0; i < 3; i++) {
    struct made a = { 0 };
    vg_status st;

    make_box(&a.g, 10, 0, NULL);
    grow(&a, 0, 1, n[i]);
    st = front(&a);
    assert_int_equal(st, i < 2 ? VG_OK : VG_BLOCKED);
    if (i < 2) {
      assert_sound(&a);
      for (size_t s = 0; s < 4; s++) assert_plane(&a, s, 15);
    } else {
      assert_true(a.failure.n >= 8);
      assert_true(a.failure.text[0] != 0);
      assert_null(a.front.x);
    }
    release(&a);
  }
}

/* Columns that leave the box are reported; after lowering them the front is
 * valid. */
static void columns_that_leave_the_box_are_reported(void **state)
{
  struct made a = { 0 };

  (void)state;
  make_duct(&a.g, 1, 1, 36, 6);
  grow(&a, 0, 0, 10);
  for (size_t i = 0; i < a.c.n_column; i++) {
    const double *x = a.g.m.point[a.c.column[i].root];

    if (x[0] > 0.99 && x[1] == 0) a.c.column[i].n = 30; /* 11.8 high */
  }
  assert_int_equal(front(&a), VG_BLOCKED);
  assert_true(a.failure.n > 0 && a.failure.n < 10);
  for (size_t i = 0; i < a.failure.n; i++) {
    assert_true(!i || a.failure.column[i - 1] < a.failure.column[i]);
    a.c.column[a.failure.column[i]].n = 10;
  }
  free(a.failure.column);
  assert_int_equal(front(&a), VG_OK);
  assert_sound(&a);
  release(&a);
}

static void bulge(double x[3])
{
  const double b = -0.6 * x[1] * (1 - x[1]) * (1 + x[2]);

  x[0] += (1 - x[0]) * b;
}

/* Side x = 0 bulges, more so towards the roof. */
static void gently_curved_side(void **state)
{
  struct made a = { 0 };
  size_t n_bent = 0;

  (void)state;
  make_box(&a.g, 12, 0, bulge);
  grow(&a, 0, 0, 10);
  assert_int_equal(a.n_slide, 4);
  assert_false(a.slide[2].is_plane);
  assert_int_equal(front(&a), VG_OK);
  save(FRONT_MESH(&a.front, &a.g.m), "bulge");
  assert_sound(&a);
  assert_points(&a);
  for (size_t i = 0; i < a.c.n_column; i++) {
    const struct vg_column *c = &a.c.column[i];
    const double(*x)[3];

    if (c->slide[0] != 4 && c->slide[1] != 4) continue;
    n_bent += c->bent != SIZE_MAX;
    if (c->bent == SIZE_MAX) continue;
    x = (const double(*)[3])(a.c.path + c->bent);
    assert_memory_equal(x[0], a.g.m.point[c->root], sizeof *x);
    assert_true(fabs(vg_distance(x[1], x[0]) - 0.01) < 1e-8);
  }
  assert_int_equal(n_bent, 13);
  /* New points are on facets with edges 1/12: within their sagitta. */
  for (size_t t = 0; t < a.front.n_face; t++)
    for (int k = 0; k < 3 && a.front.patch[t] == 4; k++) {
      const double *p = a.front.x[a.front.face[t][k]];
      const double b = -0.6 * p[1] * (1 - p[1]) * (1 + p[2]);

      assert_true(fabs(p[0] - b) < 0.003);
    }
  assert_plane(&a, 3, 15);
  assert_same_again(&a);
  release(&a);
}

static void a_tunnel_is_not_a_height_field(void **state)
{
  struct made a = { 0 };

  (void)state;
  make_box(&a.g, 8, 1, NULL);
  grow(&a, 0, 0, 5);
  assert_int_equal(a.n_slide, 1);
  assert_false(a.slide[0].is_plane);
  assert_int_equal(front(&a), VG_BLOCKED);
  assert_int_equal(a.failure.n, 4 * 8);
  for (size_t i = 0; i < a.failure.n; i++) {
    assert_true(a.failure.never[i]);
    a.c.column[a.failure.column[i]].n = 0;
  }
  free(a.failure.column);
  for (size_t i = 0; i < a.c.n_column; i++)
    if (a.c.column[i].n) a.c.column[i].n = 1;
  assert_int_equal(front(&a), VG_OK);
  assert_sound(&a);
  release(&a);
}

/* One plane in two patches, divided by a line that starts at the body: columns
 * there slide in both, though not along the line. */
static void plane_in_two_patches(void **state)
{
  struct made a = { 0 };

  (void)state;
  make_duct(&a.g, 1, 1, 36, 6);
  add_patches(&a.g, 5);
  for (size_t t = 0; t < a.g.m.n_tri; t++) {
    double z = 0;

    for (int k = 0; k < 3; k++) z += a.g.m.point[a.g.m.tri[t][k]][2];
    if (a.g.m.tri_patch[t] == 1 && z < 0) a.g.m.tri_patch[t] = 4;
  }
  grow(&a, 0, 0, 12);
  for (size_t i = 0; i < a.c.n_column; i++) {
    struct vg_column *c = &a.c.column[i];
    const double *x = a.g.m.point[c->root];

    /* Tilted, so that tops are not on the dividing line. */
    c->dir[0] = x[0] - 0.2 * x[2];
    c->dir[1] = 0;
    c->dir[2] = x[2] + 0.2 * x[0];
    vg_unit(c->dir);
  }
  assert_int_equal(front(&a), VG_OK);
  save(FRONT_MESH(&a.front, &a.g.m), "split");
  assert_sound(&a);
  assert_points(&a);
  assert_plane(&a, 1, 15);
  assert_same_again(&a);
  release(&a);
}

/* Where a body's edge turns in the plane, three columns stand on one point: the
 * virtual faces between them end in boundary edges. */
static void fan_at_the_plane(void **state)
{
  struct made a = { 0 };
  struct vg_columns *c = &a.c;
  uint32_t first = 0, n_border;
  size_t n;

  (void)state;
  make_duct(&a.g, 1, 1, 36, 1);
  grow(&a, 0, 0, 8);
  n = c->n_column;
  /* Columns 0 and 36 stand at angle 0, one on each plane; double both. */
  c->face = vg_realloc(c->face, c->n_face + 2, sizeof *c->face);
  c->face_tri = vg_realloc(c->face_tri, c->n_face + 2, sizeof *c->face_tri);
  {
    struct vg_column *more = vg_calloc(n + 2, sizeof *more);
    uint32_t *to = vg_alloc(n, sizeof *to);

    for (uint32_t i = 0; i < n; i++) {
      to[i] = first;
      more[first++] = c->column[i];
      if (i % 36 == 0) more[first++] = c->column[i];
    }
    /* The lower of each pair leans to negative angles and takes that side. */
    for (int e = 0; e < 2; e++) {
      more[to[36 * e]].dir[2] = -0.3;
      more[to[36 * e] + 1].dir[2] = 0.3;
    }
    for (size_t f = 0; f < c->n_face; f++) {
      double z = 0;

      for (int k = 0; k < 3; k++)
        z += a.g.m.point[c->column[c->face[f][k]].root][2];
      for (int k = 0; k < 3; k++)
        c->face[f][k] = to[c->face[f][k]] + (c->face[f][k] % 36 == 0 && z > 0);
    }
    for (size_t i = 0; i < c->n_border; i++) {
      double z = 0;

      for (int k = 0; k < 2; k++)
        z += a.g.m.point[c->column[c->border[i][k]].root][2];
      for (int k = 0; k < 2; k++)
        c->border[i][k] = to[c->border[i][k]] +
                          (c->border[i][k] % 36 == 0 && z > 0);
    }
    free(c->column);
    c->column = more;
    c->n_column = n + 2;
    free(to);
  }
  /* Counter-clockwise from outside: up y, then towards negative angles. */
  memcpy(c->face[c->n_face], (uint32_t[]){ 1, 0, 37 }, sizeof *c->face);
  memcpy(c->face[c->n_face + 1], (uint32_t[]){ 1, 37, 38 }, sizeof *c->face);
  c->face_tri[c->n_face] = c->face_tri[c->n_face + 1] = VG_NO_INDEX;
  c->n_face += 2;
  n_border = (uint32_t)c->n_border;
  memcpy(c->border[n_border], (uint32_t[]){ 1, 0 }, sizeof *c->border);
  memcpy(c->border[n_border + 1], (uint32_t[]){ 37, 38 }, sizeof *c->border);
  c->border_patch[n_border] = 1;
  c->border_patch[n_border + 1] = 2;
  c->n_border += 2;
  assert_int_equal(front(&a), VG_OK);
  save(FRONT_MESH(&a.front, &a.g.m), "fan");
  assert_sound(&a);
  assert_points(&a);
  assert_plane(&a, 0, 15);
  assert_plane(&a, 1, 15);
  /* Without levels the fan is one point and its faces vanish. */
  for (size_t i = 0; i < c->n_column; i++) c->column[i].n = 0;
  vg_front_release(&a.front);
  assert_int_equal(front(&a), VG_OK);
  assert_sound(&a);
  assert_int_equal(a.front.n_face, a.g.m.n_tri);
  release(&a);
}

/* Sides of a box in which the floor's columns slide, except one that is
 * excluded: side faces there would not be attached to anything. */
static void border_without_columns_fails(void **state)
{
  struct made a = { 0 };

  (void)state;
  make_box(&a.g, 6, 0, NULL);
  grow(&a, 0, 0, 5);
  for (size_t i = 0, n = a.c.n_border; i < n; i++)
    if (a.c.border_patch[i] == 5) {
      a.c.n_border--;
      memmove(a.c.border + i, a.c.border + i + 1,
              (n - i - 1) * sizeof *a.c.border);
      memmove(a.c.border_patch + i, a.c.border_patch + i + 1,
              (n - i - 1) * sizeof *a.c.border_patch);
      i--, n--;
    }
  assert_int_equal(front(&a), VG_BLOCKED);
  assert_int_equal(a.failure.n, 7);
  for (size_t i = 0; i < a.failure.n; i++) {
    struct vg_column *c = &a.c.column[a.failure.column[i]];

    assert_true(a.g.m.point[c->root][0] == 1);
    c->n = 0;
  }
  free(a.failure.column);
  assert_int_equal(front(&a), VG_OK);
  assert_sound(&a);
  release(&a);
}

/* Floor and roof with a curved side between them. */
static void curved_side_from_both_ends(void **state)
{
  struct made a = { 0 };

  (void)state;
  make_box(&a.g, 12, 0, bulge);
  grow(&a, 0, 1, 8);
  assert_int_equal(front(&a), VG_OK);
  save(FRONT_MESH(&a.front, &a.g.m), "bulge2");
  assert_sound(&a);
  assert_points(&a);
  release(&a);
}

/* A column that leaves the plane's region at once can have no levels. */
static void backward_columns_get_no_levels(void **state)
{
  struct made a = { 0 };
  size_t n_never = 0;

  (void)state;
  make_duct(&a.g, 1, 1, 36, 6);
  grow(&a, 0, 0, 6);
  for (size_t i = 0; i < a.c.n_column; i++) {
    const double *x = a.g.m.point[a.c.column[i].root];

    if (x[0] > 0.99 && x[1] == 0) a.c.column[i].dir[0] = -1;
  }
  assert_int_equal(front(&a), VG_BLOCKED);
  for (size_t i = 0; i < a.failure.n; i++) {
    struct vg_column *c = &a.c.column[a.failure.column[i]];

    assert_int_equal(a.failure.never[i], c->dir[0] == -1);
    n_never += a.failure.never[i];
    if (a.failure.never[i]) c->n = 0;
  }
  assert_int_equal(n_never, 1);
  free(a.failure.column);
  assert_int_equal(front(&a), VG_OK);
  assert_sound(&a);
  release(&a);
}

#define WRAP 3.0

static void wrap(double x[3])
{
  const double a = x[0] / WRAP, r = WRAP + x[1];

  x[0] = r * sin(a);
  x[1] = r * cos(a);
}

/* A strut between two cylinders that turn by 153 degrees: as a whole they are
 * not graphs over a plane, but near the strut they are. Their other parts are
 * unchanged. */
static void only_the_surroundings(void **state)
{
  struct made a = { 0 };
  size_t n_same = 0, n_patch = 0;

  (void)state;
  make_duct(&a.g, 0.7, 0.7, 36, 8);
  for (size_t i = 0; i < a.g.m.n_point; i++) wrap(a.g.m.point[i]);
  grow(&a, 0, 0, 8);
  assert_int_equal(a.n_slide, 2);
  assert_false(a.slide[0].is_plane);
  assert_int_equal(front(&a), VG_OK);
  save(FRONT_MESH(&a.front, &a.g.m), "wrap");
  assert_sound(&a);
  assert_points(&a);
  for (size_t t = 0; t < a.g.m.n_tri; t++) {
    const uint32_t *v = a.g.m.tri[t];

    if (a.g.m.tri_patch[t] != 1) continue;
    n_patch++;
    for (size_t u = 0; u < a.front.n_face; u++) {
      const uint32_t *f = a.front.face[u];

      n_same += a.front.id[f[0]] == v[0] && a.front.id[f[1]] == v[1] &&
                a.front.id[f[2]] == v[2];
    }
  }
  assert_true(n_same > n_patch / 10 && n_same < n_patch);
  for (size_t u = 0; u < a.front.n_face; u++)
    for (int k = 0; k < 3 && a.front.patch[u] == 1; k++) {
      const double *x = a.front.x[a.front.face[u][k]];

      /* Sagitta of edges of 0.8 on a radius of 3. */
      assert_true(fabs(hypot(x[0], x[1]) - WRAP) < 0.03);
    }
  assert_same_again(&a);
  release(&a);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(finds_planes_and_normals),
    cmocka_unit_test(normals_are_weighted_by_angle),
    cmocka_unit_test(noise_is_still_a_plane),
    cmocka_unit_test(dome_on_a_plane),
    cmocka_unit_test(body_between_planes),
    cmocka_unit_test(levels_rise_from_zero_and_fall),
    cmocka_unit_test(nothing_grows_nothing_changes),
    cmocka_unit_test(floor_with_four_sides),
    cmocka_unit_test(tilted_floor),
    cmocka_unit_test(floor_and_roof),
    cmocka_unit_test(columns_that_leave_the_box_are_reported),
    cmocka_unit_test(gently_curved_side),
    cmocka_unit_test(a_tunnel_is_not_a_height_field),
    cmocka_unit_test(plane_in_two_patches),
    cmocka_unit_test(fan_at_the_plane),
    cmocka_unit_test(border_without_columns_fails),
    cmocka_unit_test(curved_side_from_both_ends),
    cmocka_unit_test(only_the_surroundings),
    cmocka_unit_test(backward_columns_get_no_levels),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
