/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/stretch.h"
#include "core/remesh/work_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"

#define TRIFLE 1e-4 /* of the squared tolerance: on the reference */
#define ON 0.04     /* of the squared tolerance: as good as on a triangle */
#define FLAT 1e-3   /* S33: tolerances: lower triangles may face any way */
#define SWEEPS 8    /* sweeps that pass sizes to neighbours */

/* --- construction --------------------------------------------------------- */

static vg_status make_lines(struct vg_tris *w, struct vg_error *err)
{
  const struct vg_curves *c = w->curves;
  size_t n = 0;

  for (size_t i = 0; i < c->n_curve; i++) n += c->curve[i].n - 1;
  w->line = vg_alloc(n, sizeof *w->line);
  if (!w->line) return vg_fail_memory(err, "the curves of the surface");
  w->cap_line = n;
  for (size_t i = 0; i < c->n_curve; i++) {
    size_t k = c->curve[i].first;

    for (; k + 1 < c->curve[i].first + c->curve[i].n; k++)
      w->line[w->n_line++] = (struct vg_tris_line){
        (uint32_t)i,
        { c->point[k], c->point[k + 1] },
        { c->at[k], c->at[k + 1] }
      };
  }
  memcpy(w->edge, c->line, 3 * w->n_tri * sizeof *w->edge);
  return VG_OK;
}

vg_status vg_tris_status(const struct vg_tris *w, struct vg_error *err)
{
  if (w->failed) return vg_fail_memory(err, "the remeshed surface");
  return w->ends && !w->is_over ? vg_stopped(&w->stop, err) : VG_OK;
}

static double bounded(const struct vg_tris *w, const double x[3], double h)
{
  if (w->other_size) h = fmin(h, w->other_size(w->user, x));
  return fmin(w->h_max, fmax(w->h_min, h));
}

double vg_tris_size(const struct vg_tris *w, const double x[3], uint32_t *by)
{
  return bounded(w, x, vg_ref_size(w->ref, x, INFINITY, by));
}

double vg_tris_size_near(const struct vg_tris *w, const double x[3],
                         uint32_t home, size_t n, const uint32_t *point,
                         uint32_t *by)
{
  double h = vg_ref_size_by(w->ref, home, x);
  uint32_t last = home, found = home;

  for (size_t i = 0; i < n; i++) {
    uint32_t t = w->point[point[i]].by;
    double asked;

    if (t == last) continue;
    last = t;
    asked = vg_ref_size_by(w->ref, t, x);
    if (asked < h) h = asked, found = t;
  }
  *by = found;
  return bounded(w, x, h);
}

/* Pass triangles that determine a smaller size than a point's own one from
 * neighbour to neighbour. The result is almost exact where sizes grow along the
 * surface, so that searches in the tree are short. */
static void pass_sizes_on(struct vg_tris *w)
{
  const uint32_t n = (uint32_t)(3 * w->n_tri);
  int changed = 1;

  for (int sweep = 0; changed && sweep < SWEEPS && !vg_stops(&w->stop);
       sweep++) {
    changed = 0;
    for (uint32_t i = 0; i < n; i++) {
      uint32_t h = sweep % 2 ? n - 1 - i : i;
      const struct vg_tris_point *a = &w->point[vg_tris_from(w, h)];
      struct vg_tris_point *b = &w->point[vg_tris_to(w, h)];
      double gap = b->asked.size - a->asked.size, asked;

      if (!(gap > 0) ||
          gap * gap <= w->ref->slope * w->ref->slope * vg_distance2(a->x, b->x))
        continue;
      asked = vg_ref_size_by(w->ref, a->by, b->x);
      if (!(asked < b->asked.size)) continue;
      b->asked.size = asked;
      b->by = a->by;
      changed = 1;
    }
  }
}

static void find_sizes(void *context, size_t first, size_t end, int worker)
{
  struct vg_tris *w = context;

  (void)worker;
  if (vg_stops(&w->stop)) return;
  for (size_t p = first; p < end; p++) {
    struct vg_tris_point *q = &w->point[p];

    q->by = q->home;
    vg_tris_ask(w, q,
                bounded(w, q->x,
                        vg_ref_size(w->ref, q->x, q->asked.size, &q->by)));
  }
}

static vg_status make_points(struct vg_tris *w, struct vg_error *err)
{
  const struct vg_ref *r = w->ref;

  for (size_t p = 0; p < w->n_point; p++) {
    struct vg_tris_point *q = &w->point[p];

    memcpy(q->x, r->point[p], sizeof q->x);
    q->half = q->home = VG_REF_NONE;
    q->given = (uint32_t)p;
    q->kept = w->keep ? w->keep[p] : 0;
    q->changed = 1;
  }
  for (uint32_t h = 0; h < 3 * w->n_tri; h++) {
    struct vg_tris_point *q = &w->point[vg_tris_from(w, h)];

    if (q->half == VG_REF_NONE) q->half = h, q->home = h / 3;
    if (w->edge[h]) {
      q->kind = VG_WORK_CURVE;
      w->point[vg_tris_to(w, h)].kind = VG_WORK_CURVE;
    }
  }
  for (size_t p = 0; p < w->n_point; p++) {
    if (w->curves->corner[p]) w->point[p].kind = VG_WORK_CORNER;
    if (w->point[p].half == VG_REF_NONE)
      return vg_fail(err, VG_ERR_INPUT,
                     "point %zu of the surface belongs to no triangle; "
                     "repair the surface",
                     p + 1);
    w->point[p].by = w->point[p].home;
    w->point[p].asked.size = r->size[p];
  }
  pass_sizes_on(w);
  vg_parallel_for(w->threads, w->n_point, 1024, find_sizes, w);
  return vg_stopped(&w->stop, err);
}

static void ask_again(void *context, size_t first, size_t end, int worker)
{
  struct vg_tris *w = context;

  (void)worker;
  for (size_t p = first; p < end && !vg_stops(&w->stop); p++) {
    struct vg_tris_point *q = &w->point[p];

    if (q->half == VG_REF_NONE) continue;
    vg_tris_ask(w, q, vg_tris_size(w, q->x, &q->by));
  }
}

vg_status vg_tris_set_level(struct vg_tris *w, double factor,
                            struct vg_error *err)
{
  assert(w->field && factor >= 1);

  w->coarse = factor;
  vg_parallel_for(w->threads, w->n_point, 1024, ask_again, w);
  w->clock++;
  for (size_t p = 0; p < w->n_point; p++) w->point[p].changed = w->clock;
  for (size_t t = 0; t < w->n_tri; t++) w->stamp[t] = w->clock;
  return vg_stopped(&w->stop, err);
}

/* No point is a sample yet: all points of the reference are points of the
 * surface. */
static vg_status make_samples(struct vg_tris *w, struct vg_error *err)
{
  const size_t n = w->ref->n_point;

  w->follow = vg_alloc(n, sizeof *w->follow);
  w->is_sample = vg_calloc(n, 1);
  return w->follow && w->is_sample
         ? VG_OK
         : vg_fail_memory(err, "the samples of the surface");
}

vg_status vg_tris_room(struct vg_tris *w, size_t n, struct vg_error *err)
{
  w->n_tri = w->cap_tri = w->cap_first = w->cap_stamp = n;
  w->cap_mate = w->cap_edge = 3 * n;
  w->tri = vg_alloc(n, sizeof *w->tri);
  w->mate = vg_alloc(3 * n, sizeof *w->mate);
  w->edge = vg_calloc(3 * n, sizeof *w->edge);
  w->stamp = vg_calloc(n, sizeof *w->stamp);
  w->first = vg_alloc(n, sizeof *w->first);
  return w->tri && w->mate && w->edge && w->stamp && w->first
         ? VG_OK
         : vg_fail_memory(err, "the remeshed surface");
}

vg_status vg_tris_begin(struct vg_tris *w, struct vg_error *err)
{
  assert(w->ref && w->curves && w->h_min > 0 && w->h_max >= w->h_min);

  const struct vg_ref *r = w->ref;
  vg_status st;

  w->clock = 1;
  VG_TRY(vg_tris_room(w, r->n_tri, err));
  w->n_point = w->cap_point = r->n_point;
  w->point = vg_calloc(w->n_point, sizeof *w->point);
  if (!w->point) return vg_fail_memory(err, "the remeshed surface");
  memcpy(w->tri, r->tri, w->n_tri * sizeof *w->tri);
  memcpy(w->mate, r->mate, 3 * w->n_tri * sizeof *w->mate);
  memset(w->first, 0xff, w->n_tri * sizeof *w->first);
  for (size_t t = 0; t < w->n_tri; t++) w->stamp[t] = 1;
  VG_TRY(vg_stopped(&w->stop, err));
  VG_TRY(make_lines(w, err));
  if (w->stretch) {
    VG_TRY(vg_stretch_make(w->stretch, w, err));
    w->form = vg_stretch_form;
    w->of_form = w->stretch;
  }
  VG_TRY(vg_stopped(&w->stop, err));
  VG_TRY(make_points(w, err));
  VG_TRY(make_samples(w, err));
  VG_TRY(vg_stopped(&w->stop, err));
done:
  return st;
}

void vg_tris_free_arrays(struct vg_tris *w)
{
  free(w->point);
  free(w->tri);
  free(w->mate);
  free(w->edge);
  free(w->stamp);
  free(w->first);
  free(w->line);
  w->point = NULL;
  w->tri = NULL;
  w->mate = w->edge = w->first = NULL;
  w->stamp = NULL;
  w->line = NULL;
}

void vg_tris_release(struct vg_tris *w)
{
  vg_tris_free_arrays(w);
  if (!w->is_block) {
    free(w->follow);
    free(w->is_sample);
  }
  free(w->spare);
  memset(w, 0, sizeof *w);
}

/* --- queries -------------------------------------------------------------- */

size_t vg_tris_ring(const struct vg_tris *w, uint32_t p, uint32_t *half,
                    int *open)
{
  assert(p < w->n_point && half && open);

  uint32_t h = w->point[p].half, first = h;
  size_t n = 0;

  *open = 0;
  /* Go to the rim, if there is one. */
  while (w->mate[h] != VG_REF_NONE) {
    h = vg_half_next(w->mate[h]);
    if (h == first) break;
    if (++n > VG_WORK_RING) return 0;
  }
  *open = w->mate[h] == VG_REF_NONE;
  first = h;
  n = 0;
  do {
    if (n == VG_WORK_RING) return 0;
    half[n++] = h;
    h = w->mate[vg_half_prev(h)];
  } while (h != VG_REF_NONE && h != first);
  return n;
}

int vg_tris_is_kept_side(const struct vg_tris *w, uint32_t h)
{
  for (int side = 0; side < 2 && h != VG_REF_NONE; side++, h = w->mate[h])
    if (w->point[vg_tris_from(w, vg_half_prev(h))].kept) return 1;
  return 0;
}

double vg_tris_ratio(const struct vg_tris *w, uint32_t h)
{
  return vg_tris_length(w, &w->point[vg_tris_from(w, h)],
                        &w->point[vg_tris_to(w, h)]);
}

double vg_tris_shape(const struct vg_tris *w, const struct vg_tris_point *a,
                     const struct vg_tris_point *b,
                     const struct vg_tris_point *c)
{
  double form[6];

  if (!vg_tris_is_stretched(w)) return vg_form_shape(NULL, a->x, b->x, c->x);
  if (w->field) {
    double u[3], v[3], n[3];

    vg_sub(b->x, a->x, u);
    vg_sub(c->x, a->x, v);
    vg_cross(u, v, n);
    return vg_form_mean(a->asked.form, b->asked.form, c->asked.form, n, form)
           ? vg_form_shape(form, a->x, b->x, c->x)
           : 0;
  }
  for (int k = 0; k < 6; k++)
    form[k] = (a->asked.form[k] + b->asked.form[k] + c->asked.form[k]) / 3;
  return vg_form_shape(form, a->x, b->x, c->x);
}

double vg_tris_tri_shape(const struct vg_tris *w, size_t t)
{
  return vg_tris_shape(w, &w->point[w->tri[t][0]], &w->point[w->tri[t][1]],
                       &w->point[w->tri[t][2]]);
}

void vg_tris_stretch(const struct vg_tris *w, const double x[3],
                     const double *n, struct vg_metric *m)
{
  assert(vg_tris_is_stretched(w));
  if (w->form) w->form(w->of_form, x, m->size, m->form);
  if (w->field) vg_follow_field(w->field, x, n, w->coarse, w->form != NULL, m);
}

double vg_tris_tolerance(const struct vg_tris *w, double size)
{
  if (w->far > 0 && size > w->far) return w->relative * size;
  return fmin(w->tolerance, w->relative * size);
}

/* Tolerance that the patches at p permit. */
static double fine_at(const struct vg_ref *r, const struct vg_tris_point *p)
{
  const uint32_t *q = r->tri[p->home];

  if (!r->fine) return INFINITY;
  if (p->kind == VG_WORK_FACE) return r->fine[p->home];
  return fmin(r->fine_at[q[0]], fmin(r->fine_at[q[1]], r->fine_at[q[2]]));
}

void vg_tris_find_room(const struct vg_tris *w, struct vg_tris_point *p)
{
  assert(p->asked.size > 0);

  const struct vg_ref *r = w->ref;
  double size = p->asked.size;

  /* In a metric, edges in its long direction deviate most. */
  if (w->field) size = vg_tris_largest(w, p);
  p->room = w->tolerance;
  if (r->strip && r->strip[p->home] == VG_REF_CLOSED) return;
  if (r->strip && r->strip[p->by]) {
    const uint32_t *q = r->tri[p->home];

    size = fmax(size,
                fmin(r->plain[q[0]], fmin(r->plain[q[1]], r->plain[q[2]])));
  }
  p->room = fmin(vg_tris_tolerance(w, size), fine_at(r, p));
}

/* --- cavities ------------------------------------------------------------- */

void vg_cavity_begin(const struct vg_tris *w, struct vg_cavity *c,
                     uint32_t point)
{
  c->n_old = c->n_new = c->n_sample = 0;
  c->on_curve = 0;
  c->fresh = VG_REF_NONE;
  c->hint = w->point[point].home;
  c->tolerance = w->point[point].room;
}

void vg_cavity_narrow(const struct vg_tris *w, struct vg_cavity *c,
                      uint32_t point)
{
  c->tolerance = fmin(c->tolerance, w->point[point].room);
}

void vg_cavity_add(struct vg_cavity *c, const struct vg_tris_point *x,
                   const struct vg_tris_point *y, const struct vg_tris_point *z,
                   int edges)
{
  c->corner[c->n_new][0] = x;
  c->corner[c->n_new][1] = y;
  c->corner[c->n_new][2] = z;
  c->edges[c->n_new++] = (uint8_t)edges;
}

void vg_cavity_measure(const struct vg_tris *w, struct vg_cavity *c)
{
  c->shape = 1;
  for (size_t i = 0; i < c->n_new; i++) {
    double s = vg_tris_shape(w, c->corner[i][0], c->corner[i][1],
                             c->corner[i][2]);

    if (s < c->shape) c->shape = s;
  }
}

/* Is x within the tolerance of the sheet of the reference that is oriented like
 * n, and clearly nearer to it than to a sheet of opposite orientation? */
static int sample_near(const struct vg_tris *w, struct vg_cavity *c,
                       const double x[3], const double n[3])
{
  const double back[3] = { -n[0], -n[1], -n[2] };
  const int near = c->tolerance <= w->tolerance ? VG_REF_THIN : VG_REF_THIN_FAR;
  double d2, o2, y[3];
  uint32_t other = VG_REF_NONE;

  if (!vg_ref_within(w->ref, x, n, c->tolerance, &c->hint, &d2)) return 0;
  if (w->ref->thin && !(w->ref->thin[c->hint] & near)) return 1;
  if (d2 <= TRIFLE * c->tolerance * c->tolerance ||
      !vg_ref_within(w->ref, x, back, VG_WORK_NEARER * sqrt(d2), &other, &o2))
    return 1;
  /* The triangle found need not be the nearest one. */
  d2 = vg_ref_nearest(w->ref, x, n, &c->hint, y);
  other = VG_REF_NONE;
  return !vg_ref_within(w->ref, x, back, VG_WORK_NEARER * d2, &other, &o2);
}

static int tri_fits(const struct vg_tris *w, struct vg_cavity *c, size_t i)
{
  const struct vg_tris_point *const *p = c->corner[i];
  const double *n = c->made[i].n;
  double x[3];

  for (int k = 0; k < 3; k++) x[k] = (p[0]->x[k] + p[1]->x[k] + p[2]->x[k]) / 3;
  if (!sample_near(w, c, x, n)) return 0;
  for (int e = 0; e < 3; e++) {
    const double *a = p[e]->x, *b = p[(e + 1) % 3]->x;

    if (!(c->edges[i] >> e & 1)) continue;
    for (int k = 0; k < 3; k++) x[k] = (a[k] + b[k]) / 2;
    if (!sample_near(w, c, x, n)) return 0;
  }
  return 1;
}

/* Where new edges cross those of the reference, they may be farther from it
 * than at their midpoints. */
static int crossings_fit(const struct vg_tris *w, struct vg_cavity *c, size_t i)
{
  const struct vg_tris_point *const *p = c->corner[i];
  const double *n = c->made[i].n;
  double x[3];

  for (int e = 0; e < 3; e++)
    if (c->edges[i] >> e & 1 &&
        vg_ref_leaves(w->ref, p[e]->x, p[(e + 1) % 3]->x, n, c->tolerance,
                      p[e]->home, x) &&
        !sample_near(w, c, x, n))
      return 0;
  return 1;
}

/* Assign sample s to the nearest of the new triangles, or to the first that is
 * practically at zero distance. The search starts at the triangle that replaces
 * triangle `old`. */
static int sample_fits(const struct vg_tris *w, struct vg_cavity *c, uint32_t s,
                       size_t old)
{
  const double most = c->tolerance * c->tolerance;
  double best = INFINITY;
  size_t i = old < c->n_new ? old : 0;

  if (c->n_sample == VG_WORK_SAMPLES) return 0;
  for (size_t n = 0; n < c->n_new && best > ON * most; n++) {
    double u, v, d2 = vg_ref_tri_nearest(&c->made[i], w->ref->point[s], &u, &v);

    if (d2 < best) best = d2, c->goes[c->n_sample] = (uint16_t)i;
    if (++i == c->n_new) i = 0;
  }
  c->sample[c->n_sample++] = s;
  return best <= most;
}

/* Set c->made with unit normals, and sum to their sum weighted by area. Returns
 * 0 if a triangle has no normal. */
static int make_triangles(struct vg_cavity *c, double sum[3])
{
  memset(sum, 0, 3 * sizeof *sum);
  for (size_t i = 0; i < c->n_new; i++) {
    struct vg_ref_tri *t = &c->made[i];

    vg_ref_tri_make(t, c->corner[i][0]->x, c->corner[i][1]->x,
                    c->corner[i][2]->x);
    vg_cross(t->u, t->v, t->n);
    for (int k = 0; k < 3; k++) sum[k] += t->n[k];
    if (!(vg_unit(t->n) > 0)) return 0;
  }
  return 1;
}

/* Unit normal n of a triangle of the current surface. Returns its height above
 * the longer edge at its first corner. */
static double facing(const struct vg_tris *w, uint32_t t, double n[3])
{
  const double *a = vg_tris_at(w, w->tri[t][0]);
  double u[3], v[3], l;

  vg_sub(vg_tris_at(w, w->tri[t][1]), a, u);
  vg_sub(vg_tris_at(w, w->tri[t][2]), a, v);
  l = sqrt(fmax(vg_dot(u, u), vg_dot(v, v)));
  vg_cross(u, v, n);
  return l > 0 ? vg_unit(n) / l : 0;
}

/* On a curve: does each new triangle face the same way as the one it
 * replaces? */
static int faces_as_before(const struct vg_tris *w, const struct vg_cavity *c)
{
  for (size_t i = 0; i < c->n_new; i++) {
    double n[3];

    if (facing(w, c->old[c->was[i]], n) > FLAT * c->tolerance &&
        !(vg_dot(c->made[i].n, n) > 0))
      return 0;
  }
  return 1;
}

/* The new triangles have the same rim as the old ones and so the same mean
 * normal. No triangle may face away from it unless an old one does so more. */
static int is_unfolded(const struct vg_tris *w, const struct vg_cavity *c,
                       const double sum[3])
{
  double least = INFINITY, before = INFINITY;

  if (c->on_curve) return faces_as_before(w, c);
  for (size_t i = 0; i < c->n_new; i++)
    least = fmin(least, vg_dot(c->made[i].n, sum));
  if (least > 0) return 1;
  for (size_t i = 0; i < c->n_old; i++) {
    double n[3];

    if (facing(w, c->old[i], n) > 0) before = fmin(before, vg_dot(n, sum));
  }
  return least > before;
}

int vg_cavity_fits(const struct vg_tris *w, struct vg_cavity *c)
{
  double sum[3];

  if (!make_triangles(c, sum) || !is_unfolded(w, c, sum)) return 0;
  if (c->fresh != VG_REF_NONE && !sample_fits(w, c, c->fresh, 0)) return 0;
  for (size_t i = 0; i < c->n_old; i++)
    for (uint32_t s = w->first[c->old[i]]; s != VG_REF_NONE; s = w->follow[s])
      if (!sample_fits(w, c, s, i)) return 0;
  for (size_t i = 0; i < c->n_new; i++)
    if (!tri_fits(w, c, i)) return 0;
  for (size_t i = 0; i < c->n_new; i++)
    if (!crossings_fit(w, c, i)) return 0;
  return 1;
}

void vg_cavity_settle(struct vg_tris *w, const struct vg_cavity *c,
                      const uint32_t *t)
{
  for (size_t i = 0; i < c->n_old; i++) w->first[c->old[i]] = VG_REF_NONE;
  for (size_t i = 0; i < c->n_sample; i++) {
    uint32_t *first = &w->first[t[c->goes[i]]];

    w->is_sample[c->sample[i]] = 1;
    w->follow[c->sample[i]] = *first;
    *first = c->sample[i];
  }
}
