/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Surfaces with columns built by hand: one column per wall point, and all
 * layers of equal thickness, so that the height of n layers is n times the
 * thickness. */
#ifndef CLEAR_SHAPES_H
#define CLEAR_SHAPES_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "layers/clear/clear.h"

enum { MAX = 20000, PATCHES = 3 };

/* Surface, columns and topology, growing as patches are added. */
struct shape {
  struct vg_mesh m;
  struct vg_columns c;
  struct vg_topology t;
  struct vg_growth_law law;
  uint32_t of_point[MAX];
  uint8_t is_wall[PATCHES];
};

static void *room(size_t n, size_t size)
{
  void *p = calloc(n, size);

  assert_non_null(p);
  return p;
}

static struct shape *shape_new(double thickness)
{
  struct shape *s = room(1, sizeof *s);

  s->law = (struct vg_growth_law){ thickness, 0, 0, 1.3, VG_LEVELS_MAX };
  s->m.n_patch = PATCHES;
  s->m.patch = room(PATCHES, sizeof *s->m.patch);
  s->m.point = room(MAX, sizeof *s->m.point);
  s->m.tri = room(2 * MAX, sizeof *s->m.tri);
  s->m.tri_patch = room(2 * MAX, sizeof *s->m.tri_patch);
  return s;
}

static void shape_free(struct shape *s)
{
  vg_mesh_release(&s->m);
  s->c.law = NULL;
  vg_columns_release(&s->c);
  free(s->t.first);
  free(s->t.corner);
  free(s);
}

static uint32_t add_point(struct shape *s, double x, double y, double z)
{
  double *p = s->m.point[s->m.n_point];

  assert_true(s->m.n_point < MAX);
  p[0] = x;
  p[1] = y;
  p[2] = z;
  return (uint32_t)s->m.n_point++;
}

static void add_tri(struct shape *s, uint32_t patch, uint32_t a, uint32_t b,
                    uint32_t c)
{
  uint32_t *t = s->m.tri[s->m.n_tri];

  assert_true(s->m.n_tri < 2 * MAX);
  t[0] = a;
  t[1] = b;
  t[2] = c;
  s->m.tri_patch[s->m.n_tri++] = patch;
}

/* n x n squares from o along u and v; the fluid is on the side of u x v. */
static uint32_t add_plate(struct shape *s, uint32_t patch, int n,
                          const double o[3], const double u[3],
                          const double v[3])
{
  uint32_t first = (uint32_t)s->m.n_point, w = (uint32_t)n + 1;

  for (int j = 0; j <= n; j++)
    for (int i = 0; i <= n; i++)
      add_point(s, o[0] + (u[0] * i + v[0] * j) / n,
                o[1] + (u[1] * i + v[1] * j) / n,
                o[2] + (u[2] * i + v[2] * j) / n);
  for (uint32_t j = 0; j + 1 < w; j++)
    for (uint32_t i = 0; i + 1 < w; i++) {
      uint32_t a = first + j * w + i;

      add_tri(s, patch, a, a + 1, a + w + 1);
      add_tri(s, patch, a, a + w + 1, a + w);
    }
  return first;
}

/* A sphere of n by 2n quadrilaterals; the fluid is outside. */
static void add_sphere(struct shape *s, uint32_t patch, int n,
                       const double o[3], double r)
{
  uint32_t w = 2 * (uint32_t)n, first, top, bottom;

  top = add_point(s, o[0], o[1], o[2] + r);
  first = top + 1;
  for (int j = 1; j < n; j++)
    for (int i = 0; i < 2 * n; i++) {
      double a = M_PI * j / n, b = M_PI * i / n;

      add_point(s, o[0] + r * sin(a) * cos(b), o[1] + r * sin(a) * sin(b),
                o[2] + r * cos(a));
    }
  bottom = add_point(s, o[0], o[1], o[2] - r);
  for (uint32_t i = 0; i < w; i++) {
    uint32_t k = (i + 1) % w, last = first + (uint32_t)(n - 2) * w;

    add_tri(s, patch, top, first + i, first + k);
    for (uint32_t j = 0; j + 2 < (uint32_t)n; j++) {
      uint32_t a = first + j * w;

      add_tri(s, patch, a + i, a + w + i, a + w + k);
      add_tri(s, patch, a + i, a + w + k, a + k);
    }
    add_tri(s, patch, last + i, bottom, last + k);
  }
}

static void normal_of(const struct shape *s, const uint32_t t[3], double n[3])
{
  double(*p)[3] = s->m.point, d[3], e[3];

  for (int k = 0; k < 3; k++) {
    d[k] = p[t[1]][k] - p[t[0]][k];
    e[k] = p[t[2]][k] - p[t[0]][k];
  }
  for (int k = 0; k < 3; k++)
    n[k] = d[(k + 1) % 3] * e[(k + 2) % 3] - d[(k + 2) % 3] * e[(k + 1) % 3];
}

static void index_faces(struct shape *s)
{
  struct vg_columns *c = &s->c;
  uint32_t *at;

  s->t.first = room(c->n_column + 2, sizeof *s->t.first);
  s->t.corner = room(3 * c->n_face + 1, sizeof *s->t.corner);
  for (size_t f = 0; f < c->n_face; f++)
    for (int k = 0; k < 3; k++) s->t.first[c->face[f][k] + 1]++;
  for (size_t i = 0; i < c->n_column; i++) s->t.first[i + 1] += s->t.first[i];
  at = room(c->n_column + 1, sizeof *at);
  memcpy(at, s->t.first, c->n_column * sizeof *at);
  for (size_t f = 0; f < c->n_face; f++)
    for (uint32_t k = 0; k < 3; k++)
      s->t.corner[at[c->face[f][k]]++] = (uint32_t)(3 * f) + k;
  free(at);
}

/* A column of n levels on each point of the walls, along the mean normal. */
static void grow(struct shape *s, int n)
{
  struct vg_columns *c = &s->c;
  uint8_t *used = room(MAX, 1);

  c->law = &s->law;
  c->n_law = 1;
  c->column = room(s->m.n_point + 1, sizeof *c->column);
  c->face = room(s->m.n_tri + 1, sizeof *c->face);
  c->face_tri = room(s->m.n_tri + 1, sizeof *c->face_tri);
  for (size_t t = 0; t < s->m.n_tri; t++)
    for (int k = 0; k < 3; k++)
      used[s->m.tri[t][k]] |= s->is_wall[s->m.tri_patch[t]];
  for (size_t p = 0; p < s->m.n_point; p++) {
    if (!used[p]) continue;
    s->of_point[p] = (uint32_t)c->n_column;
    c->column[c->n_column++] = (struct vg_column){ .root = (uint32_t)p,
                                                   .slide = { VG_NO_INDEX,
                                                              VG_NO_INDEX },
                                                   .cap = 1.3,
                                                   .bent = SIZE_MAX,
                                                   .n = (uint16_t)n,
                                                   .n_wanted = (uint16_t)n,
                                                   .n_fit = (uint16_t)n };
  }
  for (size_t t = 0; t < s->m.n_tri; t++) {
    double normal[3];

    if (!s->is_wall[s->m.tri_patch[t]]) continue;
    normal_of(s, s->m.tri[t], normal);
    for (int k = 0; k < 3; k++) {
      uint32_t i = s->of_point[s->m.tri[t][k]];

      c->face[c->n_face][k] = i;
      for (int l = 0; l < 3; l++) c->column[i].dir[l] += normal[l];
    }
    c->face_tri[c->n_face++] = (uint32_t)t;
  }
  for (size_t i = 0; i < c->n_column; i++) {
    double *d = c->column[i].dir;
    double l = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);

    for (int k = 0; k < 3; k++) d[k] /= l;
  }
  index_faces(s);
  free(used);
}

/* Rims: edges of faces whose points all lie in the plane z = at. */
static void add_rims(struct shape *s, uint32_t patch, double at)
{
  struct vg_columns *c = &s->c;

  c->border = room(3 * c->n_face, sizeof *c->border);
  c->border_patch = room(3 * c->n_face, sizeof *c->border_patch);
  for (size_t f = 0; f < c->n_face; f++)
    for (int k = 0; k < 3; k++) {
      uint32_t a = c->face[f][k], b = c->face[f][(k + 1) % 3];

      if (s->m.point[c->column[a].root][2] != at ||
          s->m.point[c->column[b].root][2] != at)
        continue;
      c->column[a].slide[0] = c->column[b].slide[0] = patch;
      c->border[c->n_border][0] = a;
      c->border[c->n_border][1] = b;
      c->border_patch[c->n_border++] = patch;
    }
}

#endif
