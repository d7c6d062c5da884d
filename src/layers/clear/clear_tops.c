/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds tops that collide. Bounding boxes of the tops that may have moved find
 * the candidate pairs, and exact determinants decide. Contact at a shared
 * column, or at a shared root that has no column with a level, is recognised by
 * the numbers of the corners and does not count. */
#include "layers/clear/clear.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/predicates.h"
#include "core/geometry/triangles.h"
#include "core/geometry/vector.h"
#include "core/mesh/copies.h"
#include "layers/clear/clear_parts.h"

enum {
  GRAIN = 2048,
  TOP_NONE = 0,  /* Degenerate (virtual), or without area. */
  TOP_STILL = 1, /* No active column. */
  TOP_ACTIVE = 2
};

struct clear {
  struct vg_tops t;
  const uint8_t *is_slide;
  int has_margin;     /* The points are tops raised by a margin. */
  uint32_t (*tri)[3]; /* [n_face] corners of the tops in t.point. */
  uint8_t *state;     /* [n_face] TOP_NONE, TOP_STILL or TOP_ACTIVE. */
  uint8_t *covered;   /* [surface->n_tri] 1: a face stands on it. */
  uint32_t *active;   /* [n_active] active faces. */
  size_t n_active;
  struct vg_boxes boxes; /* Boxes of active faces. */
};

static const uint32_t one_fan[3] = { 0, 0, 0 };

struct placing {
  const struct vg_tops *t;
  const double *margin; /* [n_column], or NULL: the tops are not raised. */
};

/* --- positions of the tops ----------------------------------------------- */

/* Most neighbouring columns have the same law, so the heights are kept from one
 * column to the next. They equal those of vg_column_top bitwise, since the
 * heights of n levels begin with those of fewer levels. */
struct heights {
  uint32_t law;
  double cap;
  int n;
  double d[VG_LEVELS_MAX + 1];
};

static void top_of(const struct vg_tops *t, size_t i, struct heights *h,
                   double x[3])
{
  const struct vg_column *c = &t->columns->column[i];
  const double *root = t->surface->point[c->root];

  if (c->bent != SIZE_MAX) {
    memcpy(x, t->columns->path[c->bent + c->n], 3 * sizeof *x);
    return;
  }
  if (h->n < c->n || h->law != c->law || h->cap != c->cap) {
    h->law = c->law;
    h->cap = c->cap;
    h->n = c->n;
    vg_growth_law_heights(&t->columns->law[c->law], c->cap, c->n, h->d);
  }
  vg_column_at(c, root, h->d[c->n], x);
}

/* Moves the top x of a column along its direction by its margin, at most by its
 * height: the columns of a gap much narrower than the margin each take a
 * quarter of it. */
static void raise_top(const struct vg_column *c, const double root[3],
                      double margin, double x[3])
{
  double scale = fmin(margin, vg_distance(x, root)) / vg_norm(c->dir);

  for (int k = 0; k < 3; k++) x[k] += scale * c->dir[k];
}

static void place_tops(void *context, size_t first, size_t end, int worker)
{
  const struct placing *p = context;
  const struct vg_tops *t = p->t;
  struct heights h = { 0, 0, -1, { 0 } };

  (void)worker;
  for (size_t i = first; i < end; i++) {
    const struct vg_column *c = &t->columns->column[i];
    double *x = t->point[t->n_point + i];

    t->node[i] = vg_tops_root(t, c->root);
    memcpy(x, t->surface->point[c->root], 3 * sizeof *x);
    if (!c->n) continue;
    top_of(t, i, &h, x);
    if (p->margin) raise_top(c, t->surface->point[c->root], p->margin[i], x);
    if (isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2])) {
      t->node[i] = (uint32_t)(t->n_point + i);
    } else {
      memcpy(x, t->surface->point[c->root], 3 * sizeof *x);
      if (vg_tops_active(t, (uint32_t)i)) vg_tops_mark(t, (uint32_t)i);
    }
  }
}

/* --- classification of the tops ------------------------------------------ */

static void mark_face(const struct clear *x, size_t f)
{
  for (int k = 0; k < 3; k++) vg_tops_mark(&x->t, x->t.columns->face[f][k]);
}

static int is_marked(const struct clear *x, size_t f)
{
  const uint32_t *c = x->t.columns->face[f];

  for (int k = 0; k < 3; k++)
    if (x->t.columns->column[c[k]].n &&
        !__atomic_load_n(&x->t.bad[c[k]], __ATOMIC_RELAXED))
      return 0;
  return 1;
}

static int is_raised(const struct clear *x, const uint32_t t[3])
{
  size_t n = x->t.n_point;

  return t[0] >= n || t[1] >= n || t[2] >= n;
}

static int has_area(const double *a, const double *b, const double *c)
{
  for (int k = 0; k < 3; k++) {
    int i = k, j = (k + 1) % 3;
    double p[2] = { a[i], a[j] }, q[2] = { b[i], b[j] }, r[2] = { c[i], c[j] };

    if (vg_orient2d(p, q, r) != 0) return 1;
  }
  return 0;
}

static void classify_faces(void *context, size_t first, size_t end, int worker)
{
  struct clear *x = context;

  (void)worker;
  for (size_t f = first; f < end; f++) {
    const uint32_t *c = x->t.columns->face[f];
    uint32_t *t = x->tri[f];
    int active = 0;

    for (int k = 0; k < 3; k++) {
      t[k] = x->t.node[c[k]];
      active |= vg_tops_active(&x->t, c[k]);
    }
    x->state[f] = TOP_NONE;
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    if (has_area(x->t.point[t[0]], x->t.point[t[1]], x->t.point[t[2]]))
      x->state[f] = active ? TOP_ACTIVE : TOP_STILL;
    else if (active && !x->has_margin) mark_face(x, f);
  }
}

/* --- pairs --------------------------------------------------------------- */

static void meet_tops(void *context, size_t i, size_t j)
{
  const struct clear *x = context;
  const uint32_t *a = x->boxes.tri[i], *b = x->boxes.tri[j];
  uint32_t f = x->boxes.item[i], g = x->boxes.item[j];

  if (!is_raised(x, a) && !is_raised(x, b)) return;
  if (is_marked(x, f) && is_marked(x, g)) return;
  if (!vg_triangles_meet((const double(*)[3])x->t.point, a, b, one_fan,
                         one_fan))
    return;
  mark_face(x, f);
  mark_face(x, g);
}

/* Tests an active top against top g, which is not active. */
static void meet_still(void *context, size_t i, size_t g)
{
  const struct clear *x = context;
  const uint32_t *a = x->boxes.tri[i], *b = x->tri[g];
  uint32_t f = x->boxes.item[i];

  if (!is_raised(x, a) && !is_raised(x, b)) return;
  if (is_marked(x, f) && is_marked(x, g)) return;
  if (!vg_triangles_meet((const double(*)[3])x->t.point, a, b, one_fan,
                         one_fan))
    return;
  mark_face(x, f);
  mark_face(x, g);
}

static void visit_still(void *context, size_t first, size_t end, int worker)
{
  struct clear *x = context;

  (void)worker;
  for (size_t g = first; g < end; g++)
    if (x->state[g] == TOP_STILL)
      vg_boxes_touch(&x->boxes, (const double(*)[3])x->t.point, x->tri[g],
                     meet_still, x, g);
}

static int slides_in(const struct vg_columns *c, const uint32_t face[3],
                     uint32_t patch)
{
  for (int k = 0; k < 3; k++) {
    const struct vg_column *col = &c->column[face[k]];

    if (col->slide[0] == patch || col->slide[1] == patch) return 1;
  }
  return 0;
}

/* Tests a top against triangle s of the surface, which has no layers. A slide
 * patch is remeshed within itself, so tops without a column that slides in it
 * must not touch it either. */
static void meet_surface(void *context, size_t i, size_t s)
{
  const struct clear *x = context;
  const struct vg_mesh *m = x->t.surface;
  uint32_t f = x->boxes.item[i], patch = m->tri_patch[s], v[3];

  if (!is_raised(x, x->boxes.tri[i]) || is_marked(x, f)) return;
  if (x->is_slide[patch] &&
      slides_in(x->t.columns, x->t.columns->face[f], patch))
    return;
  for (int k = 0; k < 3; k++) v[k] = vg_tops_root(&x->t, m->tri[s][k]);
  if (vg_triangles_meet((const double(*)[3])x->t.point, x->boxes.tri[i], v,
                        one_fan, one_fan))
    mark_face(x, f);
}

static void visit_surface(void *context, size_t first, size_t end, int worker)
{
  struct clear *x = context;
  const struct vg_mesh *m = x->t.surface;

  (void)worker;
  for (size_t s = first; s < end; s++)
    if (!x->covered[s])
      vg_boxes_touch(&x->boxes, (const double(*)[3])m->point, m->tri[s],
                     meet_surface, x, s);
}

/* --- entry point --------------------------------------------------------- */

static void clear_release(struct clear *x)
{
  free(x->t.point);
  free(x->t.node);
  free(x->t.bad);
  free(x->t.first);
  free(x->tri);
  free(x->state);
  free(x->covered);
  free(x->active);
  vg_boxes_release(&x->boxes);
}

static vg_status allocate(struct clear *x, struct vg_error *err)
{
  const struct vg_mesh *m = x->t.surface;
  const struct vg_columns *c = x->t.columns;

  if (m->n_point >= VG_NO_INDEX || c->n_column >= VG_NO_INDEX - m->n_point)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%zu surface points and %zu columns exceed the limit of %u "
                   "points in a mesh: use a coarser surface",
                   m->n_point, c->n_column, VG_NO_INDEX - 1);
  x->t.point = vg_alloc(m->n_point + c->n_column, sizeof *x->t.point);
  x->t.node = vg_alloc(c->n_column, sizeof *x->t.node);
  x->t.bad = vg_calloc(c->n_column, 1);
  x->tri = vg_alloc(c->n_face, sizeof *x->tri);
  x->state = vg_alloc(c->n_face, 1);
  x->covered = vg_calloc(m->n_tri, 1);
  x->active = vg_alloc(c->n_face, sizeof *x->active);
  if (!x->t.point || !x->t.node || !x->t.bad || !x->tri || !x->state ||
      !x->covered || !x->active)
    return vg_fail_memory(err, "the tops of the layers");
  if (m->n_point) memcpy(x->t.point, m->point, m->n_point * sizeof *m->point);
  return vg_mesh_inner_points(m, &x->t.first, err);
}

static void list_faces(struct clear *x)
{
  const struct vg_columns *c = x->t.columns;

  for (size_t f = 0; f < c->n_face; f++) {
    if (c->face_tri[f] != VG_NO_INDEX) x->covered[c->face_tri[f]] = 1;
    if (x->state[f] == TOP_ACTIVE) x->active[x->n_active++] = (uint32_t)f;
  }
}

vg_status vg_clear_tops(const struct vg_mesh *surface,
                        const struct vg_columns *columns,
                        const uint8_t *is_slide, const uint8_t *active,
                        const double *margin, int threads, uint8_t *bad,
                        size_t *n_bad, struct vg_error *err)
{
  assert(is_slide || !surface->n_patch);
  assert(bad || !columns->n_column);
  assert(threads >= 0 && n_bad);

  struct clear x = { .t = { .surface = surface,
                            .columns = columns,
                            .active = active,
                            .n_point = surface->n_point,
                            .threads = threads },
                     .is_slide = is_slide,
                     .has_margin = margin != NULL };
  struct placing placing = { &x.t, margin };
  size_t n_column = columns->n_column, count = 0;
  vg_status st = VG_OK;

  VG_TRY(allocate(&x, err));
  vg_parallel_for(threads, n_column, GRAIN, place_tops, &placing);
  vg_parallel_for(threads, columns->n_face, GRAIN, classify_faces, &x);
  list_faces(&x);
  VG_TRY(vg_boxes_build(&x.boxes, (const double(*)[3])x.t.point,
                        (const uint32_t(*)[3])x.tri, x.n_active, x.active, 0,
                        threads, err));
  vg_boxes_pairs(&x.boxes, threads, meet_tops, &x);
  if (x.n_active && active)
    vg_parallel_for(threads, columns->n_face, GRAIN, visit_still, &x);
  if (x.n_active)
    vg_parallel_for(threads, surface->n_tri, GRAIN, visit_surface, &x);
  if (!margin) VG_TRY(vg_clear_flanks(&x.t, err));
  for (size_t i = 0; i < n_column; i++) {
    bad[i] = x.t.bad[i];
    count += x.t.bad[i];
  }
  *n_bad = count;
done:
  clear_release(&x);
  return st;
}
