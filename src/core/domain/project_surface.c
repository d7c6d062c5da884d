/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Surface of a project of planar patches. Curves are marched as in VGRID
 * (formats.md 1.7): the step is the spacing at the current point, until it
 * would pass the end; the last three steps are then made equal. */
#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/planar.h"
#include "core/domain/planar_patch.h"
#include "core/geometry/vector.h"

/* A chain of points that turns by more than 30 degrees has a corner there,
 * which becomes a mesh point. */
#define CORNER_COSINE 0.866

struct builder {
  const struct vg_project *project;
  const struct vg_sizing *sizing;
  struct vg_stop stop;
  struct vg_mesh m;
  size_t cap_point;
  uint32_t *corner; /* [project n_point] Mesh point, or UINT32_MAX. */
  struct trace {    /* Mesh points along a curve, ends included. */
    uint32_t *point;
    size_t n, cap;
  } * trace; /* [project n_curve] */
};

static double size_at(void *user, const double x[3])
{
  const struct builder *b = user;
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;

  if (b->sizing) return vg_sizing_at(b->sizing, x);
  o.scale = b->project->ifact;
  return vg_sizing_sources_at(&o, b->project->n_source, b->project->source, x);
}

static uint32_t add_point(struct builder *b, const double x[3])
{
  struct vg_mesh *m = &b->m;

  if (m->n_point >= UINT32_MAX - 1 ||
      vg_reserve(&m->point, &b->cap_point, m->n_point + 1, sizeof *m->point))
    return UINT32_MAX;
  memcpy(m->point[m->n_point], x, sizeof *m->point);
  return (uint32_t)m->n_point++;
}

static int is_corner(const struct vg_project *p, const struct vg_curve *c,
                     size_t i)
{
  const double *x = p->point[c->point[i - 1]], *y = p->point[c->point[i]],
               *z = p->point[c->point[i + 1]];
  double dot = 0;

  for (int k = 0; k < 3; k++) dot += (y[k] - x[k]) * (z[k] - y[k]);
  return dot < CORNER_COSINE * vg_distance(x, y) * vg_distance(y, z);
}

static vg_status check_project(const struct vg_project *p, struct vg_error *err)
{
  if (!p->n_shape || !p->n_curve)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the project has %zu curves and "
                   "%zu patches; a surface needs both, or a .front file",
                   p->name, p->n_curve, p->n_shape);
  for (size_t i = 0; i < p->n_curve; i++) {
    const struct vg_curve *c = &p->curve[i];

    if (c->n < 2)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: curve %" PRId32 " has %zu "
                     "points; it needs at least 2",
                     p->name, c->id, c->n);
    for (size_t k = 0; k < c->n; k++)
      if (c->point[k] >= p->n_point ||
          (k && !(vg_distance(p->point[c->point[k - 1]],
                              p->point[c->point[k]]) > 0)))
        return vg_fail(err, VG_ERR_INPUT,
                       "%s: curve %" PRId32 ": its point %zu does not exist "
                       "or repeats the previous point",
                       p->name, c->id, k + 1);
  }
  for (size_t i = 0; i < p->n_shape; i++)
    for (size_t k = 0; k < p->shape[i].n; k++) {
      const int32_t c = p->shape[i].curve[k];

      if (c == 0 || c == INT32_MIN || (size_t)(c < 0 ? -c : c) > p->n_curve)
        return vg_fail(err, VG_ERR_INPUT,
                       "%s: patch %" PRId32 " names "
                       "curve %" PRId32 " of %zu",
                       p->name, p->shape[i].patch.id, c, p->n_curve);
    }
  return VG_OK;
}

/* Ends and corners of curves become mesh points, in the order of the
 * project. */
static vg_status place_corners(struct builder *b, struct vg_error *err)
{
  const struct vg_project *p = b->project;

  b->corner = vg_alloc(p->n_point, sizeof *b->corner);
  if (!b->corner) return vg_fail_memory(err, "the curves");
  memset(b->corner, 0xff, p->n_point * sizeof *b->corner);
  for (size_t i = 0; i < p->n_curve; i++) {
    const struct vg_curve *c = &p->curve[i];

    b->corner[c->point[0]] = b->corner[c->point[c->n - 1]] = 0;
    for (size_t k = 1; k + 1 < c->n; k++)
      if (is_corner(p, c, k)) b->corner[c->point[k]] = 0;
  }
  for (size_t i = 0; i < p->n_point; i++) {
    if (b->corner[i] == UINT32_MAX) continue;
    b->corner[i] = add_point(b, p->point[i]);
    if (b->corner[i] == UINT32_MAX) return vg_fail_memory(err, "the curves");
  }
  return VG_OK;
}

/* Part of a curve between two fixed points, parametrised by arc length. */
struct run {
  const struct vg_project *p;
  const uint32_t *point; /* [n] */
  const double *along;   /* [n] */
  size_t n, at;          /* `at`: segment of the last look-up. */
};

static void run_point(struct run *r, double s, double x[3])
{
  const double *a, *b;
  double w;

  while (r->at > 0 && s < r->along[r->at]) r->at--;
  while (r->at + 2 < r->n && s > r->along[r->at + 1]) r->at++;
  a = r->p->point[r->point[r->at]];
  b = r->p->point[r->point[r->at + 1]];
  w = (s - r->along[r->at]) / (r->along[r->at + 1] - r->along[r->at]);
  for (int k = 0; k < 3; k++) /* exact if both ends have the same coordinate */
    x[k] = a[k] == b[k] ? a[k] : a[k] + w * (b[k] - a[k]);
}

/* Returns 0; 1: too fine; 2: stopped; or -1. */
static int march(struct builder *b, struct run *r, double **step, size_t *n)
{
  const double len = r->along[r->n - 1];
  size_t cap = 0, keep;
  double s = 0, x[3];

  *step = NULL;
  for (*n = 0; s < len;) {
    double h;

    if (vg_reserve(step, &cap, *n + 4, sizeof **step)) return -1;
    (*step)[(*n)++] = s;
    run_point(r, s, x);
    h = size_at(b, x);
    if (!(h > len * 1e-9)) return 1;
    if (vg_stops(&b->stop)) return 2;
    s += h;
  }
  /* There are *n steps, the last one cut off at the end. */
  keep = *n > 3 ? *n - 3 : 0;
  for (size_t i = keep; i < *n; i++)
    (*step)[i] = (*step)[keep] + (len - (*step)[keep]) *
                                   ((double)(i - keep) / (double)(*n - keep));
  return 0;
}

static vg_status trace_run(struct builder *b, size_t curve, struct run *r,
                           struct vg_error *err)
{
  struct trace *t = &b->trace[curve];
  double *step = NULL;
  size_t n = 0;
  const int bad = march(b, r, &step, &n);
  vg_status st = VG_OK;

  if (bad == 2) st = vg_fail(err, VG_ERR_STOPPED, "interrupted");
  else if (bad > 0)
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: curve %" PRId32 " is more than 1e9 "
                 "times longer than the spacing on it; check the sources",
                 b->project->name, b->project->curve[curve].id);
  else if (bad ||
           vg_reserve(&t->point, &t->cap, t->n + n + 1, sizeof *t->point))
    st = vg_fail_memory(err, "the curves");
  for (size_t i = 1; st == VG_OK && i < n; i++) {
    double x[3];

    run_point(r, step[i], x);
    t->point[t->n] = add_point(b, x);
    if (t->point[t->n++] == UINT32_MAX) st = vg_fail_memory(err, "the curves");
  }
  if (st == VG_OK) t->point[t->n++] = b->corner[r->point[r->n - 1]];
  free(step);
  return st;
}

static vg_status trace_curve(struct builder *b, size_t i, struct vg_error *err)
{
  const struct vg_curve *c = &b->project->curve[i];
  struct trace *t = &b->trace[i];
  double *along = vg_alloc(c->n, sizeof *along);
  size_t from = 0;
  vg_status st = VG_OK;

  if (!along || vg_reserve(&t->point, &t->cap, 1, sizeof *t->point)) {
    free(along);
    return vg_fail_memory(err, "the curves");
  }
  t->point[t->n++] = b->corner[c->point[0]];
  along[0] = 0;
  for (size_t k = 1; st == VG_OK && k < c->n; k++) {
    along[k] = along[k - 1] + vg_distance(b->project->point[c->point[k - 1]],
                                          b->project->point[c->point[k]]);
    if (b->corner[c->point[k]] != UINT32_MAX) {
      struct run r = { b->project, c->point + from, along + from, k - from + 1,
                       0 };

      st = trace_run(b, i, &r, err);
      from = k;
      along[k] = 0;
    }
  }
  free(along);
  return st;
}

static vg_status fill_shape(struct builder *b, size_t i, struct vg_error *err)
{
  const struct vg_patch_shape *shape = &b->project->shape[i];
  const struct vg_size_function law = { size_at, b, b->stop };
  uint32_t(*edge)[2];
  size_t n = 0;
  struct vg_error inner = VG_ERROR_INIT;
  vg_status st;

  for (size_t k = 0; k < shape->n; k++)
    n += b->trace[abs(shape->curve[k]) - 1].n - 1;
  edge = vg_alloc(n, sizeof *edge);
  if (!edge) return vg_fail_memory(err, "a patch boundary");
  n = 0;
  for (size_t k = 0; k < shape->n; k++) {
    const struct trace *t = &b->trace[abs(shape->curve[k]) - 1];

    for (size_t j = 0; j + 1 < t->n; j++, n++) {
      edge[n][shape->curve[k] < 0] = t->point[j];
      edge[n][shape->curve[k] > 0] = t->point[j + 1];
    }
  }
  st = vg_planar_patch(&b->m, n, (const uint32_t(*)[2])edge, &law, (uint32_t)i,
                       &inner);
  free(edge);
  if (st < 0)
    return vg_fail(err, st, "%s: patch %" PRId32 " %s: %s", b->project->name,
                   shape->patch.id, shape->patch.name, inner.text);
  return VG_OK;
}

static vg_status copy_patches(struct builder *b, struct vg_error *err)
{
  const struct vg_project *p = b->project;

  b->m.patch = vg_alloc(p->n_shape, sizeof *b->m.patch);
  b->trace = vg_calloc(p->n_curve, sizeof *b->trace);
  if (!b->m.patch || !b->trace) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < p->n_shape; i++) b->m.patch[i] = p->shape[i].patch;
  b->m.n_patch = p->n_shape;
  return VG_OK;
}

vg_status vg_project_surface(const struct vg_project *project,
                             const struct vg_sizing *sizing,
                             const struct vg_stop *stop, struct vg_mesh *out,
                             struct vg_error *err)
{
  struct builder b = { .project = project, .sizing = sizing };
  vg_status st;

  assert(out);
  if (stop) b.stop = *stop;
  VG_TRY(check_project(project, err));
  VG_TRY(copy_patches(&b, err));
  VG_TRY(place_corners(&b, err));
  for (size_t i = 0; i < project->n_curve; i++) VG_TRY(trace_curve(&b, i, err));
  for (size_t i = 0; i < project->n_shape; i++) VG_TRY(fill_shape(&b, i, err));
  vg_mesh_move(out, &b.m);
done:
  vg_mesh_release(&b.m);
  for (size_t i = 0; b.trace && i < project->n_curve; i++)
    free(b.trace[i].point);
  free(b.trace);
  free(b.corner);
  return st;
}
