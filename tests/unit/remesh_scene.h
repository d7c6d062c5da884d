/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A surface being remeshed, for the tests of core/remesh's changes. */
#ifndef VG_TESTS_REMESH_SCENE_H
#define VG_TESTS_REMESH_SCENE_H

#include "remesh_shapes.h"

#include "core/remesh/work.h"

struct scene {
  struct vg_mesh m;
  struct vg_ref ref;
  struct vg_curves curves;
  struct vg_tris w;
};

static inline void scene_set(struct scene *s, double tolerance, double size)
{
  struct vg_error err = VG_ERROR_INIT;
  const struct vg_curves_options o = { .angle = 40,
                                       .tolerance = tolerance,
                                       .tri_patch = s->m.tri_patch,
                                       .patch = s->m.patch };

  if (vg_ref_build(&s->ref, &s->m, NULL, &err) < 0) fail_msg("%s", err.text);
  if (vg_curves_find(&s->curves, &s->ref, &o, &err) < 0)
    fail_msg("%s", err.text);
  s->ref.size = malloc(s->m.n_point * sizeof *s->ref.size);
  for (size_t p = 0; p < s->m.n_point; p++) s->ref.size[p] = size;
  s->ref.slope = 0.2;
  vg_ref_sizes(&s->ref);
  s->w = (struct vg_tris){ .ref = &s->ref,
                           .curves = &s->curves,
                           .tolerance = tolerance,
                           .relative = 1,
                           .h_min = size,
                           .h_max = size };
  if (vg_tris_begin(&s->w, &err) < 0) fail_msg("%s", err.text);
}

static inline void scene_release(struct scene *s)
{
  vg_tris_release(&s->w);
  vg_curves_release(&s->curves);
  vg_ref_release(&s->ref);
  vg_mesh_release(&s->m);
}

static inline double scene_drawn(uint32_t *state)
{
  *state = *state * 1664525u + 1013904223u;
  return (double)(*state >> 8) / 16777216.;
}

/* Mates are symmetric, feature edges cover their curves, the Euler
 * characteristic is 2, no two edges have the same ends, and every sample of the
 * reference surface is assigned to exactly one triangle. */
static inline void scene_expect_whole(const struct scene *s)
{
  const struct vg_tris *w = &s->w;
  size_t n_tri = 0, n_point = 0, n_edge = 0, n_sample = 0, n_listed = 0;
  double length = 0;

  for (uint32_t h = 0; h < 3 * w->n_tri; h++) {
    uint32_t g = w->mate[h];

    if (vg_tris_removed(w, h / 3)) continue;
    n_tri += h % 3 == 0;
    assert_int_equal(w->mate[g], h);
    assert_int_equal(vg_tris_from(w, g), vg_tris_to(w, h));
    assert_int_equal(w->edge[g], w->edge[h]);
    n_edge += h < g;
    if (h < g && w->edge[h])
      length += w->line[w->edge[h] - 1].at[1] - w->line[w->edge[h] - 1].at[0];
    for (uint32_t i = h % 3 ? VG_REF_NONE : w->first[h / 3]; i != VG_REF_NONE;
         i = w->follow[i])
      n_listed++;
  }
  for (size_t p = 0; p < w->n_point; p++) {
    uint32_t h = w->point[p].half, ring[VG_WORK_RING];
    size_t n;
    int open;

    if (h == VG_REF_NONE) continue;
    n_point++;
    assert_false(vg_tris_removed(w, h / 3));
    assert_int_equal(vg_tris_from(w, h), p);
    n = vg_tris_ring(w, (uint32_t)p, ring, &open);
    for (size_t i = 0; i < n; i++)
      for (size_t k = 0; k < i; k++)
        assert_int_not_equal(vg_tris_to(w, ring[i]), vg_tris_to(w, ring[k]));
  }
  for (size_t p = 0; p < w->ref->n_point; p++) n_sample += w->is_sample[p];
  assert_int_equal(n_sample, n_listed);
  assert_int_equal(n_point + n_tri, n_edge + 2);
  assert_float_equal(length, s->curves.length, 1e-9);
}

static inline void scene_expect_near(const struct scene *s, double tolerance)
{
  for (size_t p = 0; p < s->w.n_point; p++) {
    uint32_t hint = VG_REF_NONE;
    double y[3];

    if (s->w.point[p].half == VG_REF_NONE) continue;
    assert_true(vg_ref_nearest(&s->ref, s->w.point[p].x, NULL, &hint, y) <=
                tolerance);
  }
}

/* Try one random change; returns 1 if it was made. */
static inline int scene_change(struct vg_tris *w, uint32_t *state)
{
  uint32_t h = (uint32_t)(scene_drawn(state) * 3 * (double)w->n_tri);
  int kind = (int)(scene_drawn(state) * 5);
  double before, x[3];
  size_t t = h / 3;

  if (vg_tris_removed(w, t)) return 0;
  if (kind == 0) return vg_tris_split(w, h, NULL) != VG_REF_NONE;
  if (kind == 1) return vg_tris_collapse(w, h, 1e9, 0.01);
  if (kind == 2) {
    size_t other = w->mate[h] == VG_REF_NONE ? t : w->mate[h] / 3;

    before = fmin(vg_tris_tri_shape(w, t), vg_tris_tri_shape(w, other));
    if (!vg_tris_swap(w, h)) return 0;
    assert_true(vg_tris_tri_shape(w, t) > before);
    assert_true(vg_tris_tri_shape(w, other) > before);
    return 1;
  }
  if (kind == 3) {
    struct vg_tris_span s;

    return vg_tris_span(w, vg_tris_from(w, h), &s) &&
           vg_tris_slide(w, vg_tris_from(w, h),
                         s.lo + scene_drawn(state) * (s.hi - s.lo), 0.01);
  }
  for (int k = 0; k < 3; k++)
    x[k] = vg_tris_at(w, vg_tris_from(w, h))[k] +
           0.1 * (scene_drawn(state) - 0.5);
  return vg_tris_move(w, vg_tris_from(w, h), x, 0.01);
}

#endif
