/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Marching directions: normal to the wall where it is smooth, and visible from
 * all faces at edges and corners. Declared in layers/grow/grow_parts.h. */
#include "layers/grow/direct.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "layers/topology/most_normal.h"

/* L8 */
#define SMOOTH_WALL 0.95 /* Least cosine at which the mean normal is used. */
/* Height of a cap triangle relative to its longest edge. */
#define CAP 0.05
#define NOISE 0.002 /* Relative height below which the normal is noise. */
#define CAP_END 0.1
/* Sine of the angle between two patches below which they count as one. */
#define SAME_PLANE 0.05

int vg_slide_normals(const struct vg_layer_work *w, size_t i, double n[2][3])
{
  assert(i < w->c->n_column);

  const struct vg_column *c = &w->c->column[i];
  int k = 0;

  for (int s = 0; s < 2; s++)
    for (size_t j = 0; j < w->n_slide && c->slide[s] != VG_NO_INDEX; j++)
      if (w->slide[j].patch == c->slide[s])
        vg_slide_normal(&w->slide[j], w->m, c->root, n[k++]);
  return k;
}

static void remove_part(double v[3], const double n[3])
{
  double d = vg_dot(v, n);

  for (int k = 0; k < 3; k++) v[k] = fabs(n[k]) == 1 ? 0 : v[k] - d * n[k];
}

void vg_constrain(int n_slide, double n[2][3], double v[3])
{
  double line[3];

  assert(n_slide >= 0 && n_slide <= 2);
  if (n_slide) remove_part(v, n[0]);
  if (n_slide < 2) return;
  vg_cross(n[0], n[1], line);
  if (vg_unit(line) < SAME_PLANE) return;
  {
    double d = vg_dot(v, line);

    for (int k = 0; k < 3; k++) v[k] = line[k] == 0 ? 0 : d * line[k];
  }
}

/* Whether the normal of face f is meaningful for column i. */
static int counts(const struct vg_layer_work *w, size_t i, uint32_t f)
{
  if (w->c->face_tri[f] == VG_NO_INDEX) return 0;
  if (!(w->cap[f] & VG_CAP_NOISY)) return 1;
  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t o = w->t.corner[j] / 3;

    if (w->c->face_tri[o] != VG_NO_INDEX && !(w->cap[o] & VG_CAP_NOISY))
      return 0;
  }
  return 1;
}

int vg_face_normals(const struct vg_layer_work *w, size_t i, double (*n)[3])
{
  int k = 0;

  assert(i < w->c->n_column);
  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t f = w->t.corner[j] / 3;

    if (counts(w, i, f)) memcpy(n[k++], w->normal[f], sizeof *n);
  }
  return k;
}

double vg_least_visibility(int k, const double (*n)[3], const double v[3])
{
  double least = 1;

  assert(k >= 0 && (n || !k));
  for (int i = 0; i < k; i++) {
    double d = vg_dot(n[i], v);

    if (d < least) least = d;
  }
  return least;
}

enum vg_layer_cause vg_unseen_cause(const struct vg_layer_work *w, size_t i,
                                    double (*n)[3])
{
  double v[3];
  int k;

  assert(i < w->c->n_column && n);
  if (w->c->column[i].slide[0] == VG_NO_INDEX) return VG_CAUSE_VISIBILITY;
  k = vg_face_normals(w, i, n);
  if (!k || !vg_most_normal(k, n, v)) return VG_CAUSE_VISIBILITY;
  vg_unit(v);
  return vg_least_visibility(k, n, v) >= VG_VISIBILITY_MIN
         ? VG_CAUSE_SLIDE
         : VG_CAUSE_VISIBILITY;
}

vg_status vg_dir_sweep_scratch(struct vg_layer_work *w, struct vg_dir_sweep *l,
                               struct vg_error *err)
{
  int threads = w->o->threads > 0 ? w->o->threads : vg_cores();

  l->w = w;
  l->scratch = vg_alloc((size_t)threads * w->max_valence, sizeof *l->scratch);
  return l->scratch ? VG_OK : vg_fail_memory(err, "the marching directions");
}

vg_status vg_dir_sweep_new(const struct vg_layer_work *w,
                           struct vg_dir_sweep *l, struct vg_error *err)
{
  l->from = vg_alloc(w->c->n_column, sizeof *l->from);
  l->to = vg_alloc(w->c->n_column, sizeof *l->to);
  if (!l->from || !l->to) return vg_fail_memory(err, "the directions");
  for (size_t i = 0; i < w->c->n_column; i++)
    memcpy(l->from[i], w->c->column[i].dir, sizeof *l->from);
  memcpy(l->to, l->from, w->c->n_column * sizeof *l->to);
  return VG_OK;
}

void vg_dir_sweep_swap(struct vg_dir_sweep *l)
{
  double(*swap)[3] = l->from;

  l->from = l->to;
  l->to = swap;
}

void vg_dir_sweep_free(struct vg_dir_sweep *t)
{
  free(t->scratch);
  free(t->from);
  free(t->to);
  free(t->moves);
  free(t->moved);
}

/* Weight of a corner: the chord 2 sin(a / 2) of the unit edge vectors, which
 * serves as well as the angle and does not need acos of libm. */
static double corner_weight(const struct vg_mesh *m, const uint32_t *tri, int k)
{
  double a[3], b[3];

  vg_sub(m->point[tri[(k + 1) % 3]], m->point[tri[k]], a);
  vg_sub(m->point[tri[(k + 2) % 3]], m->point[tri[k]], b);
  vg_unit(a);
  vg_unit(b);
  return vg_distance(a, b);
}

static void mean_normal(const struct vg_layer_work *w, size_t i, double v[3])
{
  memset(v, 0, 3 * sizeof *v);
  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t f = w->t.corner[j] / 3, tri = w->c->face_tri[f];
    double a;

    if (!counts(w, i, f)) continue;
    a = corner_weight(w->m, w->m->tri[tri], (int)(w->t.corner[j] % 3));
    for (int k = 0; k < 3; k++) v[k] += a * w->normal[f][k];
  }
}

static void first_direction(struct vg_layer_work *w, size_t i, double (*n)[3])
{
  struct vg_column *c = &w->c->column[i];
  double slide[2][3], v[3], best[3];
  int n_slide = vg_slide_normals(w, i, slide), k = vg_face_normals(w, i, n);

  if (w->t.preset[i]) memcpy(v, c->dir, sizeof v);
  else mean_normal(w, i, v);
  vg_constrain(n_slide, slide, v);
  if (!(vg_unit(v) > 0)) v[0] = v[1] = v[2] = 0;
  w->visibility[i] = vg_least_visibility(k, n, v);
  if (!w->t.preset[i] && w->visibility[i] < SMOOTH_WALL) {
    for (int j = 0; j < k; j++) vg_constrain(n_slide, slide, n[j]);
    if (vg_most_normal(k, n, best)) {
      vg_constrain(n_slide, slide, best);
      vg_unit(best);
      memcpy(v, best, sizeof v);
      k = vg_face_normals(w, i, n);
      w->visibility[i] = vg_least_visibility(k, n, v);
    }
  }
  if (!(w->visibility[i] >= VG_VISIBILITY_MIN)) w->visibility[i] = 0;
  memcpy(c->dir, v, sizeof v);
  memcpy(w->root_dir[i], v, sizeof v);
}

static void first_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_dir_sweep *l = context;

  for (size_t i = first; i < end; i++)
    first_direction(l->w, i, l->scratch + (size_t)worker * l->w->max_valence);
}

/* 1 + the corner that nearly lies on the opposite edge, at less than CAP of its
 * length and well between its ends; 0: none. n2: twice the area. */
static uint8_t cap_corner(const struct vg_mesh *m, const uint32_t *tri,
                          double n2)
{
  for (int k = 0; k < 3; k++) {
    const double *a = m->point[tri[(k + 1) % 3]];
    const double *b = m->point[tri[(k + 2) % 3]];
    double e[3], p[3], l, t;

    vg_sub(b, a, e);
    vg_sub(m->point[tri[k]], a, p);
    l = vg_dot(e, e);
    t = vg_dot(p, e);
    if (n2 < CAP * l && t > CAP_END * l && t < (1 - CAP_END) * l)
      return (uint8_t)((1 + k) | (n2 < NOISE * l ? VG_CAP_NOISY : 0));
  }
  return 0;
}

static void normal_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = ((struct vg_dir_sweep *)context)->w;

  (void)worker;
  for (size_t f = first; f < end; f++) {
    const uint32_t tri = w->c->face_tri[f];
    double a[3], b[3];

    if (tri == VG_NO_INDEX) {
      memset(w->normal[f], 0, sizeof w->normal[f]);
      continue;
    }
    vg_sub(w->m->point[w->m->tri[tri][1]], w->m->point[w->m->tri[tri][0]], a);
    vg_sub(w->m->point[w->m->tri[tri][2]], w->m->point[w->m->tri[tri][0]], b);
    vg_cross(a, b, w->normal[f]);
    w->cap[f] = cap_corner(w->m, w->m->tri[tri], vg_unit(w->normal[f]));
  }
}

vg_status vg_directions_first(struct vg_layer_work *w, struct vg_error *err)
{
  struct vg_dir_sweep l = { 0 };
  vg_status st;

  for (size_t i = 0; i < w->c->n_column; i++)
    if (w->t.first[i + 1] - w->t.first[i] > w->max_valence)
      w->max_valence = w->t.first[i + 1] - w->t.first[i];
  VG_TRY(vg_dir_sweep_scratch(w, &l, err));
  vg_parallel_for(w->o->threads, w->c->n_face, VG_GRAIN, normal_body, &l);
  vg_parallel_for(w->o->threads, w->c->n_column, VG_GRAIN, first_body, &l);
  vg_twins_first(w, l.scratch);
done:
  vg_dir_sweep_free(&l);
  return st;
}
