/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/remesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/hilbert.h"
#include "core/remesh/reference.h"

#define GRAIN 1024
#define PER_FACE 3 /* samples per face: midpoints of its edges */

/* One direction. Samples are the points, followed by those of each triangle. */
struct measuring {
  const struct vg_mesh *from;
  struct vg_ref ref; /* Faces of the other surface. */
  const struct vg_ref *to;
  uint32_t *by;    /* [from->n_point] Triangle that measures at the point;
                      VG_REF_NONE if the point has no triangle. */
  uint32_t *order; /* [from->n_tri] Triangles in spatial order. */
  double *d;       /* [n_point + PER_FACE n_tri] Distance at each sample. */
  double *face;    /* [n_tri] Largest distance at each face; may be NULL. */
  struct vg_remesh_distance *out;
  const struct vg_stop *stop;
  vg_status st;
  struct vg_error err;
};

static void face_sample(const struct vg_mesh *m, size_t t, int i, double x[3])
{
  const double *a = m->point[m->tri[t][i]];
  const double *b = m->point[m->tri[t][(i + 1) % 3]];

  for (int d = 0; d < 3; d++) x[d] = (a[d] + b[d]) / 2;
}

/* Sample number of the midpoint of edge i of triangle t. */
static size_t slot_of(const struct vg_mesh *m, size_t t, size_t i)
{
  return m->n_point + PER_FACE * t + i;
}

/* A sample shared by several triangles is measured by the first of them. */
static void at_face(const struct measuring *m, size_t t, uint32_t *hint)
{
  const struct vg_mesh *from = m->from;
  double x[VG_REF_GROUP][3], d[VG_REF_GROUP];
  size_t slot[VG_REF_GROUP], n = 0;

  for (int k = 0; k < 3; k++) {
    uint32_t p = from->tri[t][k];

    if (m->by[p] != t) continue;
    memcpy(x[n], from->point[p], sizeof *x);
    slot[n++] = p;
  }
  for (int i = 0; i < PER_FACE; i++) {
    if (m->ref.mate[3 * t + (size_t)i] < 3 * t) continue;
    face_sample(from, t, i, x[n]);
    slot[n++] = slot_of(from, t, (size_t)i);
  }
  vg_ref_distances(m->to, n, (const double(*)[3])x, hint, d);
  for (size_t i = 0; i < n; i++) m->d[slot[i]] = d[i];
}

static void at_faces(void *context, size_t first, size_t end, int worker)
{
  const struct measuring *m = context;
  uint32_t hint = VG_REF_NONE;

  (void)worker;
  if (vg_stops(m->stop)) return;
  for (size_t i = first; i < end; i++) at_face(m, m->order[i], &hint);
}

/* Order the triangles as in the search tree. The first triangle of a point
 * measures there. */
static void arrange(struct measuring *m)
{
  const struct vg_mesh *from = m->from;
  size_t n = 0;

  memset(m->by, 0xff, from->n_point * sizeof *m->by);
  memset(m->d, 0, from->n_tri * sizeof *m->d); /* 1: triangle already listed */
  for (size_t i = 0; i < m->ref.tree.n; i++) {
    uint32_t t = m->ref.tree.item[i];

    if (m->d[t] > 0) continue;
    m->d[t] = 1;
    m->order[n++] = t;
    for (int k = 0; k < 3; k++)
      if (m->by[from->tri[t][k]] == VG_REF_NONE) m->by[from->tri[t][k]] = t;
  }
  memset(m->d, 0, from->n_tri * sizeof *m->d);
}

static void share(const struct measuring *m)
{
  for (size_t h = 0; h < 3 * m->from->n_tri; h++) {
    size_t g = m->ref.mate[h];

    if (g < h)
      m->d[slot_of(m->from, h / 3, h % 3)] =
        m->d[slot_of(m->from, g / 3, g % 3)];
  }
}

/* The 99th percentile of n values. The bit patterns of positive doubles sort
 * like their values. */
static vg_status find_99(size_t n, const double *d, double *out,
                         struct vg_error *err)
{
  struct vg_key *key = vg_alloc(n, sizeof *key);
  vg_status st;

  if (!key) return vg_fail_memory(err, "the distances of the surfaces");
  for (size_t i = 0; i < n; i++) {
    memcpy(&key[i].key, &d[i], sizeof key[i].key);
    key[i].index = 0;
  }
  st = vg_sort_keys(n, key, err);
  if (st >= 0) memcpy(out, &key[n - 1 - n / 100].key, sizeof *out);
  free(key);
  return st;
}

static void find_most(const struct measuring *m)
{
  const struct vg_mesh *from = m->from;
  struct vg_remesh_distance *d = m->out;

  for (size_t t = 0; t < from->n_tri; t++) {
    double most = -1;

    for (int i = 0; i < 3 + PER_FACE; i++) {
      size_t s = i < 3 ? from->tri[t][i]
                       : from->n_point + PER_FACE * t + (size_t)i - 3;

      most = fmax(most, m->d[s]);
      if (!(m->d[s] > d->most)) continue;
      d->most = m->d[s];
      if (i < 3) memcpy(d->at, from->point[s], sizeof d->at);
      else face_sample(from, t, i - 3, d->at);
    }
    if (m->face) m->face[t] = most;
  }
}

static size_t n_samples(const struct measuring *m)
{
  return m->from->n_point + PER_FACE * m->from->n_tri;
}

static vg_status begin(struct measuring *m, struct vg_error *err)
{
  vg_status st;

  m->d = vg_calloc(n_samples(m), sizeof *m->d);
  m->by = vg_alloc(m->from->n_point, sizeof *m->by);
  m->order = vg_alloc(m->from->n_tri, sizeof *m->order);
  if (!m->d || !m->by || !m->order)
    return vg_fail_memory(err, "the distances of the surfaces");
  VG_TRY(vg_ref_build_sparse(&m->ref, m->from, m->stop, err));
  arrange(m);
done:
  return st;
}

static void begin_both(void *context, size_t first, size_t end, int worker)
{
  struct measuring *m = context;

  (void)worker;
  for (size_t i = first; i < end; i++) m[i].st = begin(&m[i], &m[i].err);
}

static void end_both(void *context, size_t first, size_t end, int worker)
{
  struct measuring *m = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    share(&m[i]);
    find_most(&m[i]);
    m[i].st = find_99(n_samples(&m[i]), m[i].d, &m[i].out->most_99, &m[i].err);
  }
}

static vg_status run(struct measuring m[2], int threads, vg_loop_body body,
                     struct vg_error *err)
{
  vg_parallel_for(threads, 2, 1, body, m);
  for (int i = 0; i < 2; i++)
    if (m[i].st < 0) {
      if (err) *err = m[i].err;
      return m[i].st;
    }
  return VG_OK;
}

vg_status vg_remesh_measure(const struct vg_mesh *a, const struct vg_mesh *b,
                            int threads, const struct vg_stop *stop,
                            double *face, struct vg_remesh_distance d[2],
                            struct vg_error *err)
{
  struct measuring m[2] = {
    { .from = a,
      .face = face,
      .out = &d[0],
      .stop = stop,
      .err = VG_ERROR_INIT },
    { .from = b, .out = &d[1], .stop = stop, .err = VG_ERROR_INIT }
  };
  vg_status st;

  memset(d, 0, 2 * sizeof *d);
  if (!a->n_tri || !b->n_tri) return VG_OK;
  VG_TRY(run(m, threads, begin_both, err));
  VG_TRY(vg_stopped(stop, err));
  for (int i = 0; i < 2; i++) {
    m[i].to = &m[!i].ref;
    vg_parallel_for(threads, m[i].from->n_tri, GRAIN, at_faces, &m[i]);
  }
  VG_TRY(vg_stopped(stop, err));
  VG_TRY(run(m, threads, end_both, err));
done:
  for (int i = 0; i < 2; i++) {
    vg_ref_release(&m[i].ref);
    free(m[i].order);
    free(m[i].by);
    free(m[i].d);
  }
  return st;
}

/* --- arrangement along a Hilbert curve ------------------------------------ */

struct arranging {
  double (*middle)[3]; /* [n_tri] */
  uint32_t *order;     /* [n_tri] */
  uint32_t (*tri)[3];
  uint32_t *patch;
  double (*point)[3];
  uint32_t *number; /* [n_point] New number of each point. */
};

static void release_arranging(struct arranging *a)
{
  free(a->middle);
  free(a->order);
  free(a->tri);
  free(a->patch);
  free(a->point);
  free(a->number);
}

static void put_point(struct arranging *a, const struct vg_mesh *m, uint32_t p,
                      uint32_t *n)
{
  if (a->number[p] != UINT32_MAX) return;
  memcpy(a->point[*n], m->point[p], sizeof *a->point);
  a->number[p] = (*n)++;
}

/* Write triangles in the new order, and points in the order of their first
 * use. */
static void put(struct arranging *a, struct vg_mesh *m)
{
  uint32_t n = 0;

  memset(a->number, 0xff, m->n_point * sizeof *a->number);
  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t t = a->order[i];

    for (int k = 0; k < 3; k++) {
      put_point(a, m, m->tri[t][k], &n);
      a->tri[i][k] = a->number[m->tri[t][k]];
    }
    a->patch[i] = m->tri_patch[t];
  }
  for (uint32_t p = 0; p < m->n_point; p++) put_point(a, m, p, &n);
  memcpy(m->point, a->point, m->n_point * sizeof *m->point);
  memcpy(m->tri, a->tri, m->n_tri * sizeof *m->tri);
  memcpy(m->tri_patch, a->patch, m->n_tri * sizeof *m->tri_patch);
}

vg_status vg_remesh_arrange(struct vg_mesh *m, struct vg_error *err)
{
  struct arranging a = { 0 };
  vg_status st = VG_OK;

  a.middle = vg_alloc(m->n_tri, sizeof *a.middle);
  a.order = vg_alloc(m->n_tri, sizeof *a.order);
  a.tri = vg_alloc(m->n_tri, sizeof *a.tri);
  a.patch = vg_alloc(m->n_tri, sizeof *a.patch);
  a.point = vg_alloc(m->n_point, sizeof *a.point);
  a.number = vg_alloc(m->n_point, sizeof *a.number);
  if (!a.middle || !a.order || !a.tri || !a.patch || !a.point || !a.number)
    VG_TRY(vg_fail_memory(err, "the order of the surface"));
  for (size_t t = 0; t < m->n_tri; t++)
    for (int d = 0; d < 3; d++)
      a.middle[t][d] = (m->point[m->tri[t][0]][d] + m->point[m->tri[t][1]][d] +
                        m->point[m->tri[t][2]][d]) /
                       3;
  VG_TRY(
    vg_hilbert_order(m->n_tri, (const double(*)[3])a.middle, a.order, err));
  put(&a, m);
done:
  release_arranging(&a);
  return st;
}
