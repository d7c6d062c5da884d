/* Marching directions: normal to the wall where it is smooth, in view of all
 * faces at edges and corners, and bent apart where columns would converge.
 * Declared in layers/work.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "layers/gram.h"
#include "layers/vector.h"
#include "layers/work.h"

#define GRAIN 2048
#define SMOOTH_WALL 0.95   /* least cosine at which the mean normal will do */
#define VIEW_KEPT 0.6      /* share of the first view that smoothing leaves */
#define VIEW_LEAST 0.2     /* the same, where cells would be lost otherwise */
#define CONVERGE 0.75      /* an edge that would shrink to less is bent apart */
#define BEND_FROM CONVERGE
#define BEND_MAX 0.995
#define STILL 1e-3         /* a direction that changes by less has settled */
#define CAP 0.05           /* height of a triangle over its longest edge */
#define NOISE 0.002        /* the same, where the normal says nothing */
#define NOISY 4            /* bit of vg_layer_work.cap */
#define CAP_END 0.1
#define CAP_SWEEPS 8       /* caps lie in chains */
#define SAME_PLANE 0.05    /* sine between two patches that are as good as one */
#define BAND 2.5           /* heights that bending reaches to */

struct loop {
  struct vg_layer_work *w;
  double (*scratch)[3];     /* [worker][max_valence] */
  double (*from)[3], (*to)[3];
  const uint32_t *list;     /* columns to treat, NULL: all */
  uint8_t *stirs, *stirred; /* [n_column] moves in this sweep, in the last */
};

/* Slide normals at a column; their number. */
static int slide_normals(const struct vg_layer_work *w, size_t i,
                         double n[2][3])
{
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

  for (int k = 0; k < 3; k++)
    v[k] = fabs(n[k]) == 1 ? 0 : v[k] - d * n[k];
}

/* Into the slide plane, or along the curve of two: zero components stay zero
 * to the last bit for planes normal to an axis. */
static void constrain(int n_slide, double n[2][3], double v[3])
{
  double line[3];

  if (n_slide) remove_part(v, n[0]);
  if (n_slide < 2) return;
  vg_cross(n[0], n[1], line);
  if (vg_unit(line) < SAME_PLANE) return;
  {
    double d = vg_dot(v, line);

    for (int k = 0; k < 3; k++) v[k] = line[k] == 0 ? 0 : d * line[k];
  }
}

/* A face that says where the wall at column i looks: no virtual one, and no
 * cap where there is anything better. */
static int counts(const struct vg_layer_work *w, size_t i, uint32_t f)
{
  if (w->c->face_tri[f] == VG_NO_INDEX) return 0;
  if (!(w->cap[f] & NOISY)) return 1;
  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t o = w->t.corner[j] / 3;

    if (w->c->face_tri[o] != VG_NO_INDEX && !(w->cap[o] & NOISY)) return 0;
  }
  return 1;
}

static int real_normals(const struct vg_layer_work *w, size_t i,
                        double (*n)[3])
{
  int k = 0;

  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t f = w->t.corner[j] / 3;

    if (counts(w, i, f)) memcpy(n[k++], w->normal[f], sizeof *n);
  }
  return k;
}

static double least_view(int k, const double (*n)[3], const double v[3])
{
  double least = 1;

  for (int i = 0; i < k; i++) {
    double d = vg_dot(n[i], v);

    if (d < least) least = d;
  }
  return least;
}

/* Angle between two edges without libm's acos: the chord 2 sin(a / 2) of unit
 * vectors serves as weight just as well. */
static double corner_weight(const struct vg_mesh *m, const uint32_t *tri,
                            int k)
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

static void first_direction(struct vg_layer_work *w, size_t i,
                            double (*n)[3])
{
  struct vg_column *c = &w->c->column[i];
  double slide[2][3], v[3], best[3];
  int n_slide = slide_normals(w, i, slide), k = real_normals(w, i, n);

  if (w->t.preset[i]) memcpy(v, c->dir, sizeof v);
  else mean_normal(w, i, v);
  constrain(n_slide, slide, v);
  if (!(vg_unit(v) > 0)) v[0] = v[1] = v[2] = 0;
  w->view[i] = least_view(k, n, v);
  if (!w->t.preset[i] && w->view[i] < SMOOTH_WALL) {
    for (int j = 0; j < k; j++) constrain(n_slide, slide, n[j]);
    if (vg_most_normal(k, n, best)) {
      constrain(n_slide, slide, best);
      vg_unit(best);
      memcpy(v, best, sizeof v);
      k = real_normals(w, i, n);
      w->view[i] = least_view(k, n, v);
    }
  }
  if (!(w->view[i] >= VG_VIEW_MIN)) w->view[i] = 0;
  memcpy(c->dir, v, sizeof v);
  memcpy(w->root_dir[i], v, sizeof v);
}

static void first_body(void *context, size_t first, size_t end, int worker)
{
  struct loop *l = context;

  for (size_t i = first; i < end; i++)
    first_direction(l->w, i,
                    l->scratch + (size_t)worker * l->w->max_valence);
}

/* 1 + the corner that lies on the edge across, by less than CAP of its
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
      return (uint8_t)((1 + k) | (n2 < NOISE * l ? NOISY : 0));
  }
  return 0;
}

static void normal_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = ((struct loop *)context)->w;

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

static vg_status scratch_new(struct vg_layer_work *w, struct loop *l,
                             struct vg_error *err)
{
  int threads = w->o->threads > 0 ? w->o->threads : vg_cores();

  l->w = w;
  l->scratch = vg_alloc((size_t)threads * w->max_valence, sizeof *l->scratch);
  return l->scratch ? VG_OK : vg_fail_memory(err, "the marching directions");
}

vg_status vg_directions_first(struct vg_layer_work *w, struct vg_error *err)
{
  struct loop l = { 0 };
  vg_status st;

  for (size_t i = 0; i < w->c->n_column; i++)
    if (w->t.first[i + 1] - w->t.first[i] > w->max_valence)
      w->max_valence = w->t.first[i + 1] - w->t.first[i];
  VG_TRY(scratch_new(w, &l, err));
  vg_parallel_for(w->o->threads, w->c->n_face, GRAIN, normal_body, &l);
  vg_parallel_for(w->o->threads, w->c->n_column, GRAIN, first_body, &l);
done:
  free(l.scratch);
  return st;
}

double vg_edge_change(const struct vg_layer_work *w, uint32_t i, uint32_t j,
                      double h_i, double h_j)
{
  const struct vg_column *a = &w->c->column[i], *b = &w->c->column[j];
  double e[3], l, sum = 0;

  vg_sub(w->m->point[b->root], w->m->point[a->root], e);
  l = vg_dot(e, e);
  if (!(l > 0)) return 0;
  for (int k = 0; k < 3; k++)
    sum += (h_j * b->dir[k] - h_i * a->dir[k]) * e[k];
  return sum / l;
}

/* Distance of the unit vector v at corner k of a triangle with unit normal n
 * from the triangle, which goes on for ever. */
static double off_triangle(const struct vg_mesh *m, const uint32_t *tri, int k,
                           const double n[3], const double v[3])
{
  double edge[2][3], in[3], side[2], least = 1;

  for (int s = 0; s < 2; s++) {
    vg_sub(m->point[tri[(k + 1 + s) % 3]], m->point[tri[k]], edge[s]);
    vg_unit(edge[s]);
  }
  vg_cross(n, edge[0], in);
  side[0] = vg_dot(v, in);
  vg_cross(edge[1], n, in);
  side[1] = vg_dot(v, in);
  if (side[0] >= 0 && side[1] >= 0) return vg_dot(v, n);
  for (int s = 0; s < 2; s++) {   /* beside it: its edges */
    double along = vg_dot(v, edge[s]);
    double off = along > 0 ? sqrt(fmax(0, 1 - along * along)) : 1;

    if (off < least) least = off;
  }
  return least;
}

/* How far a small step of length 1 along v gets away from the wall: from the
 * triangles at the root, whichever columns of a fan they belong to. */
static double gain(const struct vg_layer_work *w, uint32_t i,
                   const double v[3])
{
  uint32_t first, end;
  double least = 1;

  vg_root_range(w->c, i, &first, &end);
  for (uint32_t j = w->t.first[first]; j < w->t.first[end]; j++) {
    uint32_t f = w->t.corner[j] / 3, tri = w->c->face_tri[f];
    double d;

    if (tri == VG_NO_INDEX) continue;
    d = off_triangle(w->m, w->m->tri[tri], (int)(w->t.corner[j] % 3),
                     w->normal[f], v);
    if (d < least) least = d;
  }
  return least;
}

static void scale_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = ((struct loop *)context)->w;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    double d = gain(w, (uint32_t)i, w->c->column[i].dir);
    double length = fmin(1 / d, VG_FACTOR_WHOLE);

    if (d * VG_FACTOR_MAX < 1) w->view[i] = 0;
    else
      for (int k = 0; k < 3; k++) w->c->column[i].dir[k] *= length;
  }
}

/* Columns of a fan keep their directions: cells between them are sound only
 * as they were spread. */
static int in_fan(const struct vg_layer_work *w, size_t i)
{
  const struct vg_column *c = w->c->column;

  return (i > 0 && c[i - 1].root == c[i].root) ||
         (i + 1 < w->c->n_column && c[i + 1].root == c[i].root);
}

static int same_slides(const struct vg_column *a, const struct vg_column *b)
{
  return a->slide[0] == b->slide[0] && a->slide[1] == b->slide[1];
}

/* Mean over the caps of which i is the apex, of what the ends of the edges
 * say: a flat triangle stays flat, instead of turning over. */
static void follow(const struct loop *l, uint32_t i, double (*normal)[3])
{
  const struct vg_layer_work *w = l->w;
  double sum[3] = { 0, 0, 0 };
  int n = 0;

  memcpy(l->to[i], l->from[i], sizeof *l->to);
  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t f = w->t.corner[j] / 3, k = w->t.corner[j] % 3;
    uint32_t a = w->c->face[f][(k + 1) % 3], b = w->c->face[f][(k + 2) % 3];
    const double *p = w->m->point[w->c->column[a].root];
    double e[3], x[3], t;

    if ((w->cap[f] & 3) != 1 + k || w->view[a] == 0 || w->view[b] == 0) continue;
    if (w->c->column[i].slide[0] != VG_NO_INDEX &&
        !(same_slides(&w->c->column[i], &w->c->column[a]) &&
          same_slides(&w->c->column[i], &w->c->column[b]))) continue;
    vg_sub(w->m->point[w->c->column[b].root], p, e);
    vg_sub(w->m->point[w->c->column[i].root], p, x);
    t = vg_dot(x, e) / vg_dot(e, e);
    for (int c = 0; c < 3; c++)
      sum[c] += (1 - t) * l->from[a][c] + t * l->from[b][c];
    n++;
  }
  if (!n) return;
  for (int c = 0; c < 3; c++) sum[c] /= n;
  if (least_view(real_normals(w, i, normal), normal, sum) >=
      VIEW_KEPT * w->view[i] * vg_norm(sum))
    memcpy(l->to[i], sum, sizeof sum);
}

static void follow_body(void *context, size_t first, size_t end, int worker)
{
  struct loop *l = context;

  for (size_t i = first; i < end; i++)
    if (l->w->view[i] > 0 && !in_fan(l->w, i))
      follow(l, (uint32_t)i,
             l->scratch + (size_t)worker * l->w->max_valence);
    else memcpy(l->to[i], l->from[i], sizeof *l->to);
}

static vg_status pair_new(const struct vg_layer_work *w, struct loop *l,
                          struct vg_error *err)
{
  l->from = vg_alloc(w->c->n_column, sizeof *l->from);
  l->to = vg_alloc(w->c->n_column, sizeof *l->to);
  if (!l->from || !l->to) return vg_fail_memory(err, "the directions");
  for (size_t i = 0; i < w->c->n_column; i++)
    memcpy(l->from[i], w->c->column[i].dir, sizeof *l->from);
  memcpy(l->to, l->from, w->c->n_column * sizeof *l->to);
  return VG_OK;
}

static void pair_swap(struct loop *l)
{
  double (*swap)[3] = l->from;

  l->from = l->to;
  l->to = swap;
}

/* Along dir, or, where that leaves the first point no room, along the
 * direction from before smoothing. */
static void shift_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = ((struct loop *)context)->w;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_column *c = &w->c->column[i];
    double v[3], delta1 = w->c->law[c->law].delta1, d;

    memset(c->shift, 0, sizeof c->shift);
    if (w->view[i] == 0) continue;
    memcpy(v, c->dir, sizeof v);
    vg_unit(v);
    d = gain(w, (uint32_t)i, v);
    if (d * VG_FACTOR_MAX < 1) {
      memcpy(v, w->root_dir[i], sizeof v);
      d = gain(w, (uint32_t)i, v);
    }
    if (d * VG_FACTOR_MAX < 1) w->view[i] = 0;
    else if (fabs(d * vg_norm(c->dir) - 1) > 1e-9)
      for (int k = 0; k < 3; k++)
        c->shift[k] = delta1 * (v[k] / d - c->dir[k]);
  }
}

vg_status vg_directions_shift(struct vg_layer_work *w, struct vg_error *err)
{
  struct loop l = { .w = w };

  (void)err;
  vg_parallel_for(w->o->threads, w->c->n_column, GRAIN, shift_body, &l);
  return VG_OK;
}

vg_status vg_directions_scale(struct vg_layer_work *w, struct vg_error *err)
{
  struct loop l = { .w = w };
  vg_status st;

  vg_parallel_for(w->o->threads, w->c->n_column, GRAIN, scale_body, &l);
  VG_TRY(scratch_new(w, &l, err));
  VG_TRY(pair_new(w, &l, err));
  for (int s = 0; s < CAP_SWEEPS; s++) {
    vg_parallel_for(w->o->threads, w->c->n_column, GRAIN, follow_body, &l);
    pair_swap(&l);
  }
  for (size_t i = 0; i < w->c->n_column; i++)
    memcpy(w->c->column[i].dir, l.from[i], sizeof *l.from);
done:
  free(l.from);
  free(l.to);
  free(l.scratch);
  return st;
}

/* Smoothing ----------------------------------------------------------------
 *
 * Where columns converge (a concave corner, a wall at an acute angle to a
 * slide plane), directions within BAND heights are relaxed towards the mean
 * of their neighbours as far as it takes, so that the turn is spread. */

static void mean_of_near(const struct vg_layer_work *w, size_t i,
                         double (*from)[3], double v[3])
{
  const double *root = w->m->point[w->c->column[i].root];

  memset(v, 0, 3 * sizeof *v);
  for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++) {
    uint32_t o = w->t.near[j];
    double d = vg_distance(root, w->m->point[w->c->column[o].root]);

    if (!(d > 0)) continue;   /* another column of the same fan */
    for (int k = 0; k < 3; k++) v[k] += from[o][k] / d;
  }
}

/* What is left of the area of a face, seen along its normal, when its columns
 * have risen by h along the unit vectors dir. */
static double top_share(const struct vg_layer_work *w, uint32_t f,
                        double (*dir)[3], double h)
{
  double x[3][3], a[3], b[3], base[3], top[3], n2;

  for (int k = 0; k < 3; k++)
    memcpy(x[k], w->m->point[w->c->column[w->c->face[f][k]].root],
           sizeof x[k]);
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

/* How strongly a column is bent: not at all while its faces keep their area
 * up to the tops, wholly once one would shrink to half. So columns far from a
 * corner, and those on its convex side, stay normal to the wall. */
static double urge(const struct loop *l, size_t i)
{
  const struct vg_layer_work *w = l->w;
  double least = 1;

  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t f = w->t.corner[j] / 3;

    if (w->c->face_tri[f] != VG_NO_INDEX)
      least = fmin(least, top_share(w, f, l->from, tallest(w, f)));
  }
  return fmax(0, fmin(BEND_MAX, (BEND_FROM - least) / (BEND_FROM - 0.5)));
}

/* Nothing has moved around column i, so it will not move either. */
static int is_still(const struct loop *l, size_t i)
{
  const struct vg_layer_work *w = l->w;

  if (l->stirred[i]) return 0;
  for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++)
    if (l->stirred[w->t.near[j]]) return 0;
  return 1;
}

/* One damped Jacobi step; where the mean loses the faces from view, half of
 * the way to it, and so on. */
static void relax(const struct loop *l, size_t i, double (*n)[3])
{
  const struct vg_layer_work *w = l->w;
  double slide[2][3], mean[3], step, v[3];
  int n_slide = slide_normals(w, i, slide), k;

  memcpy(l->to[i], l->from[i], sizeof *l->to);
  l->stirs[i] = 0;
  if (in_fan(w, i) || w->view[i] == 0 || is_still(l, i)) return;
  mean_of_near(w, i, l->from, mean);
  if (!(vg_unit(mean) > 0)) return;
  k = real_normals(w, i, n);
  step = urge(l, i);
  for (int try = 0; try < 4; try++, step *= 0.5) {
    for (int c = 0; c < 3; c++)
      v[c] = l->from[i][c] + step * mean[c] +
             (1 - step) * w->root_dir[i][c];
    constrain(n_slide, slide, v);
    if (!(vg_unit(v) > 0)) continue;
    if (least_view(k, n, v) < VIEW_KEPT * w->view[i]) continue;
    memcpy(l->to[i], v, sizeof v);
    l->stirs[i] = vg_distance(v, l->from[i]) > STILL;
    return;
  }
}

static void relax_body(void *context, size_t first, size_t end, int worker)
{
  struct loop *l = context;

  for (size_t k = first; k < end; k++)
    relax(l, l->list[k], l->scratch + (size_t)worker * l->w->max_valence);
}

static vg_status sweeps(struct vg_layer_work *w, const uint32_t *list,
                        size_t n, struct vg_error *err)
{
  struct loop l = { .list = list };
  vg_status st;

  VG_TRY(scratch_new(w, &l, err));
  VG_TRY(pair_new(w, &l, err));
  l.stirs = vg_calloc(w->c->n_column, 1);
  l.stirred = vg_calloc(w->c->n_column, 1);
  if (!l.stirs || !l.stirred) {
    st = vg_fail_memory(err, "the smoothing");
    goto done;
  }
  for (size_t k = 0; k < n; k++) l.stirred[list[k]] = 1;
  for (int s = 0; s < w->o->smooth; s++) {
    uint8_t *swap = l.stirs;

    vg_parallel_for(w->o->threads, n, GRAIN / 4, relax_body, &l);
    pair_swap(&l);
    l.stirs = l.stirred;
    l.stirred = swap;
  }
  for (size_t i = 0; i < w->c->n_column; i++)
    memcpy(w->c->column[i].dir, l.from[i], sizeof *l.from);
done:
  free(l.from);
  free(l.to);
  free(l.stirs);
  free(l.stirred);
  free(l.scratch);
  return st;
}

static void converging(const struct vg_layer_work *w, double (*dir)[3],
                       double *reach, uint32_t *queue, size_t *n_queue)
{
  for (uint32_t f = 0; f < w->c->n_face; f++) {
    double h = tallest(w, f);

    if (w->c->face_tri[f] == VG_NO_INDEX ||
        top_share(w, f, dir, h) >= CONVERGE) continue;
    for (int k = 0; k < 3; k++)
      reach[w->c->face[f][k]] = fmax(reach[w->c->face[f][k]], BAND * h);
  }
  for (uint32_t i = 0; i < w->c->n_column; i++)
    if (reach[i] > 0) queue[(*n_queue)++] = i;
}

/* reach[i] = max over paths of what is left of the reach at their start: the
 * least fixed point, whatever the order. Rings of the queue. */
static vg_status spread(const struct vg_layer_work *w, double *reach,
                        struct vg_error *err)
{
  size_t n = w->c->n_column, n_now = 0, n_next;
  uint32_t *now = vg_alloc(n, sizeof *now), *next = vg_alloc(n, sizeof *next);
  uint8_t *queued = vg_calloc(n, 1);
  vg_status st = VG_OK;

  if (!now || !next || !queued) {
    st = vg_fail_memory(err, "the smoothing");
    goto done;
  }
  converging(w, w->root_dir, reach, now, &n_now);
  for (; n_now; n_now = n_next) {
    uint32_t *swap = now;

    n_next = 0;
    for (size_t k = 0; k < n_now; k++) queued[now[k]] = 0;
    for (size_t k = 0; k < n_now; k++) {
      uint32_t i = now[k];

      for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++) {
        uint32_t o = w->t.near[j];
        double left = reach[i] -
          vg_distance(w->m->point[w->c->column[i].root],
                      w->m->point[w->c->column[o].root]);

        if (!(left > reach[o])) continue;
        reach[o] = left;
        if (!queued[o]) queued[o] = 1, next[n_next++] = o;
      }
    }
    now = next;
    next = swap;
  }
done:
  free(now);
  free(next);
  free(queued);
  return st;
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
  VG_TRY(spread(w, reach, err));
  for (uint32_t i = 0; i < w->c->n_column; i++)
    if (reach[i] > 0) list[n++] = i;
  VG_TRY(sweeps(w, list, n, err));
done:
  free(reach);
  free(list);
  return st;
}

/* Half of the way to the mean over the faces to turn, or less. */
static int even(struct vg_layer_work *w, size_t i, const uint8_t *turn,
                double (*from)[3], double (*n)[3], double v[3])
{
  double slide[2][3], mean[3] = { 0, 0, 0 }, step = 0.5;
  int n_slide = slide_normals(w, i, slide), n_mean = 0, k;

  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t f = w->t.corner[j] / 3;

    for (int c = 0; turn[f] && c < 3; c++) {
      for (int x = 0; x < 3; x++) mean[x] += from[w->c->face[f][c]][x];
      n_mean++;
    }
  }
  if (!n_mean || w->view[i] == 0 || in_fan(w, i)) return 0;
  k = real_normals(w, i, n);
  for (int try = 0; try < 4; try++, step *= 0.5) {
    for (int x = 0; x < 3; x++)
      v[x] = (1 - step) * from[i][x] + step * mean[x] / n_mean;
    constrain(n_slide, slide, v);
    if (least_view(k, n, v) >= VIEW_LEAST * w->view[i] * vg_norm(v)) return 1;
  }
  return 0;
}

vg_status vg_directions_even(struct vg_layer_work *w, const uint8_t *turn,
                             uint8_t *turned, struct vg_error *err)
{
  struct loop l = { 0 };
  vg_status st;

  VG_TRY(scratch_new(w, &l, err));
  VG_TRY(pair_new(w, &l, err));
  for (size_t i = 0; i < w->c->n_column; i++)
    if (even(w, i, turn, l.from, l.scratch, l.to[i])) {
      memcpy(w->c->column[i].dir, l.to[i], sizeof *l.to);
      turned[i] = 1;
    }
  VG_TRY(vg_directions_shift(w, err));
  for (size_t i = 0; i < w->c->n_column; i++)
    if (w->view[i] == 0 && w->room[i] > 0) {
      vg_heights_lower(w, i, 0, VG_CAUSE_NO_VIEW);
      turned[i] = 1;
    }
done:
  free(l.from);
  free(l.to);
  free(l.scratch);
  return st;
}
