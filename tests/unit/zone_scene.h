/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Domains from which separator zones are cut, and their invariants at any
 * moment. Header only: one program per module. */
#ifndef TESTS_UNIT_ZONE_SCENE_H
#define TESTS_UNIT_ZONE_SCENE_H

#include "io_support.h"

#include "fill_shapes.h"
#include "front_parts.h"
#include "zone_support.h"

/* The front of the surface m, which is already in the scene. */
static inline void scene_begin(struct scene *s, double growth, double h_max)
{
  struct vg_front *f = &s->front;

  s->sizing = shape_sizing(&s->m, growth, h_max);
  if (vg_reserve(&f->x, &s->cap_point, s->m.n_point, sizeof *f->x) ||
      vg_reserve(&f->face, &s->cap_face, s->m.n_tri, sizeof *f->face))
    abort();
  memcpy(f->x, s->m.point, s->m.n_point * sizeof *f->x);
  memcpy(f->face, s->m.tri, s->m.n_tri * sizeof *f->face);
  f->n_point = s->m.n_point;
  f->n_face = s->m.n_tri;
  assert_int_equal(vg_front_check(f, NULL), VG_OK);
  assert_int_equal(vg_front_open_edges(f), 0);
  s->volume = vg_front_volume(f);
  assert_true(s->volume > 0);
}

static inline void box_scene(struct scene *s, int n)
{
  memset(s, 0, sizeof *s);
  shape_box(&s->m, n, 0.5);
  scene_begin(s, 1.2, 1.0 / n);
}

static inline void sphere_scene(struct scene *s)
{
  const double centre[3] = { 0.1, 0, 0 };

  memset(s, 0, sizeof *s);
  shape_box(&s->m, 8, 3);
  shape_sphere(&s->m, 8, centre, 1, 7);
  scene_begin(s, 1.3, 0);
}

static inline void scene_end(struct scene *s)
{
  vg_front_release(&s->front);
  free(s->cell);
  vg_sizing_free(s->sizing);
  vg_mesh_release(&s->m);
}

static inline struct vg_region plane_at(int axis, double at)
{
  struct vg_region r = { .n_plane = 1 };

  r.plane[0].normal[axis] = 1;
  r.plane[0].offset = at;
  return r;
}

static inline struct vg_region line_at(int a, double at, int b, double there)
{
  struct vg_region r = { .n_plane = 2, .reach = 1 };

  r.plane[0].normal[a] = 1;
  r.plane[0].offset = at;
  r.plane[1].normal[b] = 1;
  r.plane[1].offset = there;
  return r;
}

/* --- invariants at any moment -------------------------------------------- */

static inline double volume_of_cell(const struct scene *s, size_t c)
{
  const double(*x)[3] = (const double(*)[3])s->front.x;
  const double *a = x[s->cell[c][0]];
  double e[3][3];

  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) e[i][k] = x[s->cell[c][i + 1]][k] - a[k];
  return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
          e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
         6;
}

/* A closed front, positive cells, and together the volume of the domain. */
static inline void is_valid(const struct scene *s)
{
  const struct vg_filled all = { .n_cell = s->n_cell, .cell = s->cell };
  double sum = vg_front_volume(&s->front);

  assert_int_equal(vg_filled_defects(&s->front, &all, 1), 0);
  for (size_t c = 0; c < s->n_cell; c++) sum += volume_of_cell(s, c);
  if (!(fabs(sum - s->volume) < 1e-10 * s->volume))
    fail_msg("volume %.17g instead of %.17g", sum, s->volume);
}

/* Number of components of the front that share no edge. Small components, the
 * cavities left where cells of a zone are badly shaped, are counted
 * separately. */
enum { CRUMB = 20 };

static inline size_t parts_of(const struct vg_front *f, size_t *n_fragment)
{
  uint32_t *part = vg_alloc(f->n_face, sizeof *part);
  size_t n, large = 0, *size;

  assert_non_null(part);
  assert_int_equal(front_parts(f, part, &n, NULL), VG_OK);
  size = vg_calloc(n, sizeof *size);
  assert_non_null(size);
  for (size_t i = 0; i < f->n_face; i++) {
    assert_true(part[i] < n);
    size[part[i]]++;
  }
  for (size_t k = 0; k < n; k++) {
    assert_true(size[k] >= 4);
    large += size[k] > CRUMB;
  }
  *n_fragment = n - large;
  free(part);
  free(size);
  return large;
}

/* Small components: at most one per 200 cells, plus two. */
static inline void parts_are(const struct scene *s, size_t want)
{
  size_t n_fragment, n = parts_of(&s->front, &n_fragment);

  if (n != want || n_fragment > 2 + s->n_cell / 200)
    fail_msg("%zu components and %zu small ones with %zu cells instead of %zu",
             n, n_fragment, s->n_cell, want);
}

/* Fill the remaining void: the result is a mesh of the surface, so no cells
 * overlap. */
static inline void is_filled(struct scene *s)
{
  const struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh all = s->m;
  struct vg_mesh_report r;

  if (zone_take(s, NULL, &options, &err) != VG_OK) fail_msg("%s", err.text);
  assert_int_equal(s->front.n_face, 0);
  all.point = s->front.x;
  all.n_point = s->front.n_point;
  all.tet = s->cell;
  all.n_tet = s->n_cell;
  assert_memory_equal(s->front.x, s->m.point,
                      s->m.n_point * sizeof *s->m.point);
  assert_int_equal(vg_mesh_judge(&all, NULL, &r, NULL), VG_OK);
  assert_int_equal(r.not_positive, 0);
  assert_int_equal(r.open_face + r.crowded_face + r.same_side_face, 0);
  assert_int_equal(r.orphan_boundary + r.outward_boundary, 0);
  assert_int_equal(r.unused_point + r.duplicate_point, 0);
  assert_true(r.is_valid);
  assert_int_equal(r.n_component, 1);
  assert_true(fabs(r.volume - s->volume) < 1e-10 * s->volume);
}

/* One zone; the state must be valid after it. Returns the number of its
 * cells. */
static inline size_t cut(struct scene *s, const struct vg_region *region)
{
  const struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t before = s->n_cell;
  vg_status st = zone_take(s, region, &options, &err);

  if (st != VG_OK) fail_msg("%d: %s", (int)st, err.text);
  is_valid(s);
  return s->n_cell - before;
}

static inline void unit_normal(const double a[3], const double b[3],
                               const double c[3], double n[3])
{
  double u[3], v[3], l;

  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
  }
  for (int k = 0; k < 3; k++)
    n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
  l = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (int k = 0; k < 3; k++) n[k] /= l;
}

/* The smallest dihedral angle of the cells from `first` on, in degrees. */
static inline double smallest_angle(const struct scene *s, size_t first)
{
  static const int face[4][3] = {
    { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 }
  };
  const double(*x)[3] = (const double(*)[3])s->front.x;
  double least = 180;

  for (size_t c = first; c < s->n_cell; c++) {
    const uint32_t *v = s->cell[c];
    double n[4][3];

    for (int i = 0; i < 4; i++)
      unit_normal(x[v[face[i][0]]], x[v[face[i][1]]], x[v[face[i][2]]], n[i]);
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < i; j++) {
        double cosine = -(n[i][0] * n[j][0] + n[i][1] * n[j][1] +
                          n[i][2] * n[j][2]);

        least = fmin(least, acos(fmax(-1, fmin(1, cosine))) * 180 / M_PI);
      }
  }
  return least;
}

#endif
