/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: curves are divided, then the patches between them are triangulated
 * separately and numbered in their order. */
#include <assert.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/planar.h"
#include "core/geometry/graded.h"
#include "partition/engine/engine.h"
#include "partition/octree/octree_parts.h"

/* State of a curve or a patch in a loop. */
struct piece {
  size_t n_step;          /* Curves: number of steps. */
  double *step;           /* [n_step + 1] */
  size_t at;              /* Index of its first point among all points. */
  size_t n, n_new, n_tri; /* Patches: points on the border, new points,
                             triangles. */
  uint32_t *point;        /* [n] Points on its border, ascending. */
  double (*add)[2];
  uint32_t (*tri)[3];
};

struct mesher {
  const struct vg_octants *t;
  const struct vg_patches *p;
  const struct vg_sizing *sizing;
  const struct vg_engine *engine;
  struct vg_interfaces *out;
  struct piece *curve, *patch;
  pthread_mutex_t lock; /* Guards the members below. */
  size_t failed;        /* First item of the loop that failed. */
  vg_status st;
  struct vg_error err;
};

void vg_interfaces_release(struct vg_interfaces *i)
{
  free(i->x);
  free(i->begin);
  free(i->tri);
  memset(i, 0, sizeof *i);
}

static int stops(const struct mesher *m)
{
  return m->engine && vg_engine_stopping(m->engine);
}

/* Notes the failure of the first failed item, so that messages are
 * reproducible. */
static void note(struct mesher *m, size_t item, vg_status st,
                 const struct vg_error *why)
{
  if (st >= 0) return;
  pthread_mutex_lock(&m->lock);
  if (m->st == VG_OK || item < m->failed) {
    m->failed = item;
    m->st = st;
    m->err = *why;
  }
  pthread_mutex_unlock(&m->lock);
}

static vg_status outcome(const struct mesher *m, struct vg_error *err)
{
  if (m->st == VG_OK) return VG_OK;
  if (stops(m)) return VG_ERR_STOPPED;
  return vg_fail(err, m->st, "an interface: %s", m->err.text);
}

/* --- curves -------------------------------------------------------------- */

struct line {
  const struct mesher *m;
  double from[3];
  int axis;
};

static double size_on_line(void *user, double s)
{
  const struct line *l = user;
  double x[3] = { l->from[0], l->from[1], l->from[2] };

  x[l->axis] += s;
  return vg_sizing_at(l->m->sizing, x);
}

static void place_corner(const struct mesher *m, uint32_t corner, double x[3])
{
  for (int k = 0; k < 3; k++)
    x[k] = vg_octants_place(m->t, k, m->p->corner[corner][k]);
}

static void divide_curves(void *context, size_t first, size_t end, int worker)
{
  struct mesher *m = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    const struct vg_patch_curve *c = &m->p->curve[i];
    struct line l = { .m = m, .axis = c->axis };
    struct piece *q = &m->curve[i];
    struct vg_error why = VG_ERROR_INIT;
    double to[3];

    place_corner(m, c->end[0], l.from);
    place_corner(m, c->end[1], to);
    note(m, i,
         vg_graded_steps(to[c->axis] - l.from[c->axis], size_on_line, &l, 1,
                         &q->n_step, &q->step, &why),
         &why);
  }
}

/* Adds room for more points to the list of all points. */
static vg_status add_room(struct vg_interfaces *out, size_t more,
                          struct vg_error *err)
{
  double(*x)[3];

  if (out->n_point + more >= UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "interfaces of more than %u points",
                   UINT32_MAX - 1);
  x = vg_realloc(out->x, out->n_point + more, sizeof *x);
  if (!x) return vg_fail_memory(err, "the interfaces");
  out->x = x;
  return VG_OK;
}

static vg_status place_curves(struct mesher *m, struct vg_error *err)
{
  const struct vg_patches *p = m->p;
  struct vg_interfaces *out = m->out;
  size_t more = p->n_corner;
  vg_status st;

  st = outcome(m, err);
  if (st != VG_OK) return st;
  for (size_t i = 0; i < p->n_curve; i++) more += m->curve[i].n_step - 1;
  st = add_room(out, more, err);
  if (st < 0) return st;
  for (size_t i = 0; i < p->n_corner; i++)
    place_corner(m, (uint32_t)i, out->x[out->n_point++]);
  for (size_t i = 0; i < p->n_curve; i++) {
    struct piece *q = &m->curve[i];

    q->at = out->n_point;
    for (size_t s = 1; s < q->n_step; s++) {
      double *x = out->x[out->n_point++];

      place_corner(m, p->curve[i].end[0], x);
      x[p->curve[i].axis] += q->step[s];
    }
  }
  return VG_OK;
}

/* Point k of a curve, from its lower end. */
static uint32_t on_curve(const struct mesher *m, size_t curve, size_t k)
{
  const struct piece *q = &m->curve[curve];

  if (!k) return m->p->curve[curve].end[0];
  if (k == q->n_step) return m->p->curve[curve].end[1];
  return (uint32_t)(q->at + k - 1);
}

/* --- patches ------------------------------------------------------------- */

struct plane {
  const struct mesher *m;
  const struct vg_plane_patch *patch;
  double at;
};

static void to_space(const struct plane *p, const double y[2], double x[3])
{
  x[p->patch->axis] = p->at;
  x[(p->patch->axis + 1) % 3] = y[0];
  x[(p->patch->axis + 2) % 3] = y[1];
}

static double size_in_plane(void *user, const double y[2])
{
  const struct plane *p = user;
  double x[3];

  to_space(p, y, x);
  return vg_sizing_at(p->m->sizing, x);
}

static int by_number(const void *p, const void *q)
{
  const uint32_t a = *(const uint32_t *)p, b = *(const uint32_t *)q;

  return (a > b) - (a < b);
}

static uint32_t number_of(const struct piece *q, uint32_t point)
{
  const uint32_t *at = bsearch(&point, q->point, q->n, sizeof *q->point,
                               by_number);

  return (uint32_t)(at - q->point);
}

/* Segments of the border, in the numbering of all points; counter-clockwise. */
static size_t walk_border(const struct mesher *m, size_t patch,
                          uint32_t (*edge)[2])
{
  const struct vg_patches *p = m->p;
  size_t n = 0;

  for (size_t b = p->begin[patch]; b < p->begin[patch + 1]; b++) {
    const size_t c = p->border[b] >> 1;
    const int right = p->border[b] & 1;

    for (size_t k = 0; k < m->curve[c].n_step; k++, n++) {
      if (!edge) continue;
      edge[n][right] = on_curve(m, c, k);
      edge[n][!right] = on_curve(m, c, k + 1);
    }
  }
  return n;
}

static vg_status fill_patch(const struct mesher *m, size_t i, struct piece *q,
                            struct vg_error *err)
{
  struct plane pl = { m, &m->p->patch[i],
                      vg_octants_place(m->t, m->p->patch[i].axis,
                                       m->p->patch[i].at) };
  const struct vg_planar_law law = { .at = size_in_plane,
                                     .user = &pl,
                                     .stop = vg_engine_stop(m->engine) };
  const size_t n = walk_border(m, i, NULL);
  uint32_t(*edge)[2] = vg_alloc(n, sizeof *edge);
  double(*y)[2] = vg_alloc(2 * n, sizeof *y);
  vg_status st = VG_OK;

  q->point = vg_alloc(2 * n, sizeof *q->point);
  if (!edge || !y || !q->point) {
    st = vg_fail_memory(err, "an interface");
  } else {
    walk_border(m, i, edge);
    memcpy(q->point, edge, n * sizeof *edge);
    qsort(q->point, 2 * n, sizeof *q->point, by_number);
    for (size_t k = 0; k < 2 * n; k++)
      if (!k || q->point[k] != q->point[q->n - 1])
        q->point[q->n++] = q->point[k];
    for (size_t k = 0; k < q->n; k++)
      for (int d = 0; d < 2; d++)
        y[k][d] = m->out->x[q->point[k]][(pl.patch->axis + 1 + d) % 3];
    for (size_t k = 0; k < n; k++)
      for (int d = 0; d < 2; d++) edge[k][d] = number_of(q, edge[k][d]);
    st = vg_planar_mesh(q->n, (const double(*)[2])y, n,
                        (const uint32_t(*)[2])edge, &law, &q->n_new, &q->add,
                        &q->n_tri, &q->tri, err);
  }
  free(edge);
  free(y);
  return st;
}

static void fill_patches(void *context, size_t first, size_t end, int worker)
{
  struct mesher *m = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_error why = VG_ERROR_INIT;

    note(m, i, fill_patch(m, i, &m->patch[i], &why), &why);
  }
}

static vg_status place_patches(struct mesher *m, struct vg_error *err)
{
  const struct vg_patches *p = m->p;
  struct vg_interfaces *out = m->out;
  size_t more = 0, n_tri = 0;
  vg_status st;

  st = outcome(m, err);
  if (st != VG_OK) return st;
  for (size_t i = 0; i < p->n; i++) {
    more += m->patch[i].n_new;
    n_tri += m->patch[i].n_tri;
  }
  st = add_room(out, more, err);
  if (st < 0) return st;
  out->begin = vg_alloc(p->n + 1, sizeof *out->begin);
  out->tri = vg_alloc(n_tri, sizeof *out->tri);
  if (!out->begin || !out->tri) return vg_fail_memory(err, "the interfaces");
  out->begin[0] = 0;
  for (size_t i = 0; i < p->n; i++) {
    struct piece *q = &m->patch[i];
    struct plane pl = {
      m, &p->patch[i], vg_octants_place(m->t, p->patch[i].axis, p->patch[i].at)
    };
    uint32_t(*tri)[3] = out->tri + out->begin[i];

    for (size_t k = 0; k < q->n_tri; k++)
      for (int j = 0; j < 3; j++) {
        const uint32_t v = q->tri[k][j];

        tri[k][j] = v < q->n ? q->point[v]
                             : (uint32_t)(out->n_point + v - q->n);
      }
    for (size_t k = 0; k < q->n_new; k++)
      to_space(&pl, q->add[k], out->x[out->n_point++]);
    out->begin[i + 1] = out->begin[i] + q->n_tri;
  }
  return VG_OK;
}

static void pieces_free(struct piece *q, size_t n)
{
  for (size_t i = 0; q && i < n; i++) {
    free(q[i].step);
    free(q[i].point);
    free(q[i].add);
    free(q[i].tri);
  }
  free(q);
}

vg_status vg_interfaces_make(const struct vg_octants *t,
                             const struct vg_patches *p,
                             const struct vg_sizing *sizing,
                             const struct vg_engine *e,
                             struct vg_interfaces *out, struct vg_error *err)
{
  struct mesher m = {
    .t = t, .p = p, .sizing = sizing, .engine = e, .out = out
  };
  vg_status st;

  assert(t && p && (p->patch || !p->n) && out);
  memset(out, 0, sizeof *out);
  pthread_mutex_init(&m.lock, NULL);
  m.curve = vg_calloc(p->n_curve, sizeof *m.curve);
  m.patch = vg_calloc(p->n, sizeof *m.patch);
  if (!m.curve || !m.patch) {
    st = vg_fail_memory(err, "the interfaces");
    goto done;
  }
  vg_engine_loop(e, p->n_curve, 64, divide_curves, &m);
  st = place_curves(&m, err);
  if (st != VG_OK) goto done;
  vg_engine_loop(e, p->n, 1, fill_patches, &m);
  st = place_patches(&m, err);
done:
  pieces_free(m.curve, p->n_curve);
  pieces_free(m.patch, p->n);
  pthread_mutex_destroy(&m.lock);
  return st;
}
