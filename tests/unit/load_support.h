/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Scenes for the load estimates: a void with its sizes, its load, and the mesh
 * to compare with. */
#ifndef VG_TEST_LOAD_SUPPORT_H
#define VG_TEST_LOAD_SUPPORT_H

#include "io_support.h"

#include <math.h>

#include "cli/examples/demo.h"
#include "fill_support.h"
#include "partition/load/load.h"

struct scene {
  struct vg_mesh m;
  struct vg_front front; /* of m, which keeps its arrays */
  struct vg_sizing *sizing;
  double volume;
};

/* The scene takes m over and leaves it empty. */
static inline void make_sized(struct scene *s, struct vg_mesh *m,
                              const struct vg_sizing_options *o,
                              const struct vg_source *source)
{
  memset(s, 0, sizeof *s);
  assert_int_equal(vg_sizing_new(o, source != NULL, source, m, &s->sizing,
                                 NULL),
                   VG_OK);
  vg_mesh_move(&s->m, m);
  s->front = vg_front_of(&s->m);
  s->volume = vg_front_volume(&s->front);
  assert_true(s->volume > 0);
}

/* even: the uniform edge length; 0: that of the triangles. */
static inline void make_scene(struct scene *s, struct vg_mesh *m, double even)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;

  o.h_max = even;
  o.from_surface = !(even > 0);
  make_sized(s, m, &o, NULL);
}

static inline void make_sourced(struct scene *s, const char *name,
                                size_t n_cell, double growth,
                                const struct vg_source *source)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_demo d = VG_DEMO_INIT;

  o.growth = growth;
  assert_int_equal(vg_demo_make(name, n_cell, &d, NULL), VG_OK);
  make_sized(s, &d.surface, &o, source);
  vg_demo_release(&d);
}

static inline void make_grown(struct scene *s, const char *name, size_t n_cell,
                              double growth)
{
  make_sourced(s, name, n_cell, growth, NULL);
}

static inline void make_demo(struct scene *s, const char *name, size_t n_cell)
{
  make_grown(s, name, n_cell, 1.2);
}

static inline void release_scene(struct scene *s)
{
  vg_mesh_release(&s->m);
  vg_sizing_free(s->sizing);
}

static inline void estimate(const struct scene *s, int threads,
                            struct vg_load *l)
{
  struct vg_error err = VG_ERROR_INIT;

  *l = (struct vg_load)VG_LOAD_INIT;
  if (vg_load_new(&s->front, s->sizing, VG_LOAD_CELLS_PER_CUBE, threads, l,
                  &err) < 0)
    fail_msg("%s", err.text);
}

static inline double volume_of(const struct vg_load_octant *c)
{
  return 8 * pow((double)c->half, 3);
}

/* Volume from the samples alone, before the fit to the exact volume: the fit
 * changes an octant's share by far less than one sample (1/8). */
static inline double sampled(const struct vg_load *l)
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++)
    sum += volume_of(&l->octant[i]) * round(8 * (double)l->octant[i].part) / 8;
  return sum;
}

static inline double fitted(const struct vg_load *l)
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++)
    sum += volume_of(&l->octant[i]) * (double)l->octant[i].part;
  return sum;
}

/* An octant on the wrong side would cost several per cent, and a farfield has
 * few octants. The tolerance is three standard deviations of the samples, where
 * a share is known to about 0.12. */
static inline void check_volume(const struct scene *s, const struct vg_load *l)
{
  double cells = 0, crossed = 0;

  assert_true(l->n > 0);
  for (size_t i = 0; i < l->n; i++)
    if (round(8 * (double)l->octant[i].part) < 8)
      crossed += volume_of(&l->octant[i]) * volume_of(&l->octant[i]);
  if (fabs(sampled(l) - s->volume) > 0.01 * s->volume + 0.36 * sqrt(crossed))
    fail_msg("volume %g of %g", sampled(l), s->volume);
  assert_true(fabs(fitted(l) / s->volume - 1) < 1e-5);
  for (size_t i = 0; i < l->n; i++) cells += (double)l->octant[i].cells;
  assert_true(fabs(cells / l->cells - 1) < 1e-9);
}

static inline void compare_sourced(const char *name, size_t n_cell,
                                   double growth,
                                   const struct vg_source *source, double most)
{
  struct vg_fill_options o = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report r;
  struct vg_mesh out = VG_MESH_INIT;
  struct vg_demo d = VG_DEMO_INIT;
  struct vg_load l;
  struct scene s;
  double ratio;

  make_sourced(&s, name, n_cell, growth, source);
  estimate(&s, 1, &l);
  assert_int_equal(vg_demo_make(name, n_cell, &d, NULL), VG_OK);
  memset(&r, 0, sizeof r);
  assert_int_equal(fill_mesh(&d.surface, s.sizing, &o, &out, &r, NULL), VG_OK);
  ratio = (double)out.n_tet / l.cells;
  print_message("%s: %zu cells made, %.0f expected: %.3f\n", name, out.n_tet,
                l.cells, ratio);
  assert_true(ratio > 1 / most && ratio < most);
  vg_mesh_release(&out);
  vg_demo_release(&d);
  vg_load_release(&l);
  release_scene(&s);
}

static inline void compare_with_mesh(const char *name, size_t n_cell,
                                     double growth, double most)
{
  compare_sourced(name, n_cell, growth, NULL, most);
}

#endif
