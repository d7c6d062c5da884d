/* Domains that zones are cut out of, and what must hold at any moment. Header
 * only: one program per module. */
#ifndef TESTS_UNIT_ZONE_SCENE_H
#define TESTS_UNIT_ZONE_SCENE_H

#include "io_support.h"

#include "fill_shapes.h"
#include "front_parts.h"
#include "partition/cut/task_data.h"
#include "zone_support.h"

struct scene {
  struct vg_mesh m;
  struct vg_sizing *sizing;
  struct vg_void v;
  struct vg_fill_report report;
  double volume;
};

static inline double volume_of_front(const struct vg_void *v)
{
  struct vg_front f = { .n_point = v->n_point, .n_face = v->n_face,
                        .x = v->x, .face = v->face };

  return v->n_face ? vg_front_volume(&f) : 0;
}

static inline void scene_void(struct scene *s, double growth, double h_max)
{
  s->v = (struct vg_void)VG_VOID_INIT;
  memset(&s->report, 0, sizeof s->report);
  s->sizing = shape_sizing(&s->m, growth, h_max);
  assert_int_equal(vg_void_from_mesh(&s->v, &s->m, NULL), VG_OK);
  assert_int_equal(vg_void_defects(&s->v), 0);
  s->volume = volume_of_front(&s->v);
  assert_true(s->volume > 0);
}

static inline void box_scene(struct scene *s, int n)
{
  memset(&s->m, 0, sizeof s->m);
  shape_box(&s->m, n, 0.5);
  scene_void(s, 1.2, 1.0 / n);
}

static inline void sphere_scene(struct scene *s)
{
  const double centre[3] = {0.1, 0, 0};

  memset(&s->m, 0, sizeof s->m);
  shape_box(&s->m, 8, 3);
  shape_sphere(&s->m, 8, centre, 1, 7);
  scene_void(s, 1.3, 0);
}

static inline void scene_end(struct scene *s)
{
  vg_void_release(&s->v);
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

/* --- what must hold at any moment ---------------------------------------- */

static inline double volume_of_cell(const struct vg_void *v, size_t c)
{
  const double *a = v->x[v->cell[c][0]];
  double e[3][3];

  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) e[i][k] = v->x[v->cell[c][i + 1]][k] - a[k];
  return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
          e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) / 6;
}

/* A closed front, positive cells, and together the volume of the domain. */
static inline void is_valid(const struct scene *s)
{
  double sum = volume_of_front(&s->v);

  assert_int_equal(vg_void_defects(&s->v), 0);
  for (size_t c = 0; c < s->v.n_cell; c++) sum += volume_of_cell(&s->v, c);
  if (!(fabs(sum - s->volume) < 1e-10 * s->volume))
    fail_msg("volume %.17g instead of %.17g", sum, s->volume);
}

/* Parts of the front that share no edge: how many, fragments apart, the small
 * cavities left where cells of a zone are not well shaped. */
enum { CRUMB = 20 };

static inline size_t parts_of(const struct vg_void *v, size_t *n_fragment)
{
  struct vg_front f = { .n_point = v->n_point, .n_face = v->n_face,
                        .x = v->x, .face = v->face };
  uint32_t *part = vg_alloc(v->n_face, sizeof *part);
  size_t n, large = 0, *size;

  assert_non_null(part);
  assert_int_equal(front_parts(&f, part, &n, NULL), VG_OK);
  size = vg_calloc(n, sizeof *size);
  assert_non_null(size);
  for (size_t i = 0; i < v->n_face; i++) {
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

/* Fragments: at most one to 200 cells made, and two. */
static inline void parts_are(const struct scene *s, size_t want)
{
  size_t n_fragment, n = parts_of(&s->v, &n_fragment);

  if (n != want || n_fragment > 2 + s->v.n_cell / 200)
    fail_msg("%zu parts and %zu fragments of %zu cells instead of %zu parts", n,
             n_fragment, s->v.n_cell, want);
}

/* The rest is filled: what was made is a mesh of the surface, so no cell
 * overlaps another. */
static inline void is_filled(struct scene *s)
{
  struct vg_grow_options options = VG_GROW_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh all = s->m;
  struct vg_mesh_report r;

  if (vg_grow(&s->v, s->sizing, &options, &s->report, &err) != VG_OK)
    fail_msg("%s", err.text);
  assert_int_equal(s->v.n_face, 0);
  all.point = s->v.x;
  all.n_point = s->v.n_point;
  all.tet = s->v.cell;
  all.n_tet = s->v.n_cell;
  assert_memory_equal(s->v.x, s->m.point, s->m.n_point * sizeof *s->m.point);
  assert_int_equal(vg_mesh_judge(&all, NULL, &r, NULL), VG_OK);
  assert_int_equal(r.not_positive, 0);
  assert_int_equal(r.open_face + r.crowded_face + r.same_side_face, 0);
  assert_int_equal(r.orphan_boundary + r.outward_boundary, 0);
  assert_int_equal(r.unused_point + r.duplicate_point, 0);
  assert_true(r.is_valid);
  assert_int_equal(r.n_component, 1);
  assert_true(fabs(r.volume - s->volume) < 1e-10 * s->volume);
}

/* One zone; the state must be valid after it. Returns the cells it made. */
static inline size_t cut(struct scene *s, const struct vg_region *region)
{
  struct vg_grow_options options = VG_GROW_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t before = s->v.n_cell;
  vg_status st = zone_take(&s->v, s->sizing, region, &options, &s->report,
                           &err);

  if (st != VG_OK) fail_msg("%d: %s", (int)st, err.text);
  is_valid(s);
  return s->v.n_cell - before;
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
static inline double smallest_angle(const struct vg_void *v, size_t first)
{
  static const int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  double least = 180;

  for (size_t c = first; c < v->n_cell; c++) {
    double n[4][3];

    for (int i = 0; i < 4; i++)
      unit_normal(v->x[v->cell[c][face[i][0]]], v->x[v->cell[c][face[i][1]]],
                  v->x[v->cell[c][face[i][2]]], n[i]);
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
