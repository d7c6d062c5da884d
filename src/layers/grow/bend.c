/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Bending of directions. Declared in layers/grow/grow_parts.h.
 *
 * Where columns converge (in a concave corner, or at a wall at an acute angle
 * to a slide plane), the directions within BAND heights are relaxed towards the
 * mean of their neighbours as far as necessary, so that the rotation is spread
 * over many columns. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "layers/grow/direct.h"

/* L4 */
/* Faces that would shrink below this share of their area are bent apart. */
#define CONVERGE 0.75
#define BEND_MAX 0.995
#define STILL 1e-3 /* A direction that changes by less has converged. */
#define BAND 2.5   /* Distance in heights that bending reaches. */

static void mean_of_near(const struct vg_layer_work *w, size_t i,
                         double (*from)[3], double v[3])
{
  const double *root = w->m->point[w->c->column[i].root];

  memset(v, 0, 3 * sizeof *v);
  for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++) {
    uint32_t o = w->t.near[j];
    double d = vg_distance(root, w->m->point[w->c->column[o].root]);

    if (!(d > 0)) continue; /* Another column of the same fan. */
    for (int k = 0; k < 3; k++) v[k] += from[o][k] / d;
  }
}

/* Remaining share of the area of a face, projected along its normal, after its
 * columns have grown by h along the unit vectors dir. */
static double top_share(const struct vg_layer_work *w, uint32_t f,
                        double (*dir)[3], double h)
{
  double x[3][3], a[3], b[3], base[3], top[3], n2;

  for (int k = 0; k < 3; k++)
    memcpy(x[k], w->m->point[w->c->column[w->c->face[f][k]].root], sizeof x[k]);
  vg_sub(x[1], x[0], a);
  vg_sub(x[2], x[0], b);
  vg_cross(a, b, base);
  n2 = vg_dot(base, base);
  if (!(n2 > 0)) return 1;
  for (int k = 0; k < 3; k++) {
    const double *v = dir[w->c->face[f][0]];

    a[k] += h * (dir[w->c->face[f][1]][k] - v[k]);
    b[k] += h * (dir[w->c->face[f][2]][k] - v[k]);
  }
  vg_cross(a, b, top);
  return vg_dot(base, top) / n2;
}

static double tallest(const struct vg_layer_work *w, uint32_t f)
{
  const uint32_t *c = w->c->face[f];

  return fmax(w->wanted[c[0]], fmax(w->wanted[c[1]], w->wanted[c[2]]));
}

/* Strength of bending at a column: zero while its faces keep their area up to
 * the tops, full once one of them would shrink to half. Columns far from a
 * corner, and columns on its convex side, therefore stay normal to the wall. */
static double bend_strength(const struct vg_dir_sweep *l, size_t i)
{
  const struct vg_layer_work *w = l->w;
  double least = 1;

  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t f = w->t.corner[j] / 3;

    if (w->c->face_tri[f] != VG_NO_INDEX)
      least = fmin(least, top_share(w, f, l->from, tallest(w, f)));
  }
  return fmax(0, fmin(BEND_MAX, (CONVERGE - least) / (CONVERGE - 0.5)));
}

/* If nothing around column i has moved, it will not move either. */
static int is_still(const struct vg_dir_sweep *l, size_t i)
{
  const struct vg_layer_work *w = l->w;

  if (l->moved[i]) return 0;
  for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++)
    if (l->moved[w->t.near[j]]) return 0;
  return 1;
}

/* One damped Jacobi step. If the new direction loses too much visibility, the
 * step is halved, up to three times. */
static void relax(const struct vg_dir_sweep *l, size_t i, double (*n)[3])
{
  const struct vg_layer_work *w = l->w;
  double slide[2][3], mean[3], step, v[3];
  int n_slide = vg_slide_normals(w, i, slide), k;

  memcpy(l->to[i], l->from[i], sizeof *l->to);
  l->moves[i] = 0;
  if (vg_shares_root(w->c, i) || w->visibility[i] == 0 || is_still(l, i))
    return;
  mean_of_near(w, i, l->from, mean);
  if (!(vg_unit(mean) > 0)) return;
  k = vg_face_normals(w, i, n);
  step = bend_strength(l, i);
  for (int try = 0; try < 4; try++, step *= 0.5) {
    for (int c = 0; c < 3; c++)
      v[c] = l->from[i][c] + step * mean[c] + (1 - step) * w->root_dir[i][c];
    vg_constrain(n_slide, slide, v);
    if (!(vg_unit(v) > 0)) continue;
    if (vg_least_visibility(k, n, v) < VG_VISIBILITY_KEPT * w->visibility[i])
      continue;
    memcpy(l->to[i], v, sizeof v);
    l->moves[i] = vg_distance(v, l->from[i]) > STILL;
    return;
  }
}

static void relax_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_dir_sweep *l = context;

  for (size_t k = first; k < end; k++)
    relax(l, l->list[k], l->scratch + (size_t)worker * l->w->max_valence);
}

static vg_status sweeps(struct vg_layer_work *w, const uint32_t *list, size_t n,
                        struct vg_error *err)
{
  struct vg_dir_sweep l = { .list = list };
  vg_status st;

  VG_TRY(vg_dir_sweep_scratch(w, &l, err));
  VG_TRY(vg_dir_sweep_new(w, &l, err));
  l.moves = vg_calloc(w->c->n_column, 1);
  l.moved = vg_calloc(w->c->n_column, 1);
  if (!l.moves || !l.moved) {
    st = vg_fail_memory(err, "the smoothing");
    goto done;
  }
  for (size_t k = 0; k < n; k++) l.moved[list[k]] = 1;
  for (int s = 0; s < w->o->smooth; s++) {
    uint8_t *swap = l.moves;

    vg_parallel_for(w->o->threads, n, VG_GRAIN / 4, relax_body, &l);
    vg_dir_sweep_swap(&l);
    l.moves = l.moved;
    l.moved = swap;
  }
  for (size_t i = 0; i < w->c->n_column; i++)
    memcpy(w->c->column[i].dir, l.from[i], sizeof *l.from);
  vg_twins_agree(w, NULL, w->root_dir, VG_VISIBILITY_KEPT, l.scratch);
done:
  vg_dir_sweep_free(&l);
  return st;
}

static void converging(const struct vg_layer_work *w, double *reach)
{
  for (uint32_t f = 0; f < w->c->n_face; f++) {
    double h = tallest(w, f);

    if (w->c->face_tri[f] == VG_NO_INDEX ||
        top_share(w, f, w->root_dir, h) >= CONVERGE)
      continue;
    for (int k = 0; k < 3; k++)
      reach[w->c->face[f][k]] = fmax(reach[w->c->face[f][k]], BAND * h);
  }
}

/* Propagates the remaining reach of column i to its neighbour. */
static int carry(struct vg_layer_work *w, void *context, uint32_t i, uint32_t j)
{
  double *reach = context, left;
  uint32_t o = w->t.near[j];

  if (!(reach[i] > reach[o])) return 0;
  left = reach[i] - vg_root_distance(w, i, o);
  if (!(left > reach[o])) return 0;
  reach[o] = left;
  return 1;
}

vg_status vg_directions_smooth(struct vg_layer_work *w, struct vg_error *err)
{
  size_t n = 0;
  double *reach = vg_calloc(w->c->n_column, sizeof *reach);
  uint32_t *list = vg_alloc(w->c->n_column, sizeof *list);
  vg_status st = VG_OK;

  if (!reach || !list) {
    st = vg_fail_memory(err, "the smoothing");
    goto done;
  }
  converging(w, reach);
  VG_TRY(vg_columns_spread(w, carry, reach, err));
  for (uint32_t i = 0; i < w->c->n_column; i++)
    if (reach[i] > 0) list[n++] = i;
  VG_TRY(sweeps(w, list, n, err));
done:
  free(reach);
  free(list);
  return st;
}
