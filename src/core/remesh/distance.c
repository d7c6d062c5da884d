#include "core/remesh/remesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/hilbert.h"
#include "core/remesh/reference.h"

#define GRAIN 1024
#define PER_FACE 4        /* samples: middles of edges, centroid */

/* Samples are the points, then those of each triangle. */
struct measuring {
  const struct vg_mesh *from;
  const struct vg_ref *to;
  uint32_t *hint;         /* [from->n_point] triangle near it; VG_REF_NONE: of
                             none of the triangles */
  double *d;              /* [n_point + PER_FACE n_tri] */
};

static void face_sample(const struct vg_mesh *m, size_t t, int i, double x[3])
{
  const double *p[3];

  for (int k = 0; k < 3; k++) p[k] = m->point[m->tri[t][k]];
  for (int d = 0; d < 3; d++)
    x[d] = i < 3 ? (p[i][d] + p[(i + 1) % 3][d]) / 2
           : (p[0][d] + p[1][d] + p[2][d]) / 3;
}

static void at_points(void *context, size_t first, size_t end, int worker)
{
  const struct measuring *m = context;

  (void)worker;
  for (size_t p = first; p < end; p++) {
    uint32_t hint = VG_REF_NONE;
    double y[3];

    if (m->hint[p] == VG_REF_NONE) continue;
    m->d[p] = vg_ref_nearest(m->to, m->from->point[p], NULL, &hint, y);
    m->hint[p] = hint;
  }
}

static void at_faces(void *context, size_t first, size_t end, int worker)
{
  const struct measuring *m = context;

  (void)worker;
  for (size_t t = first; t < end; t++) {
    uint32_t hint = m->hint[m->from->tri[t][0]];

    for (int i = 0; i < PER_FACE; i++) {
      size_t s = m->from->n_point + PER_FACE * t + (size_t)i;
      double x[3], y[3];

      face_sample(m->from, t, i, x);
      m->d[s] = vg_ref_nearest(m->to, x, NULL, &hint, y);
    }
  }
}

/* The value that 99 % of n are not above: of positive doubles the bits rise
 * with the values. */
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

static void find_most(const struct measuring *m, double *face,
                      struct vg_remesh_distance *d)
{
  const struct vg_mesh *from = m->from;

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
    if (face) face[t] = most;
  }
}

vg_status vg_remesh_measure(const struct vg_mesh *from,
                            const struct vg_mesh *to, int threads,
                            double *face, struct vg_remesh_distance *d,
                            struct vg_error *err)
{
  struct vg_ref ref = VG_REF_INIT;
  struct measuring m = { .from = from, .to = &ref };
  const size_t n = from->n_point + PER_FACE * from->n_tri;
  vg_status st = VG_OK;

  memset(d, 0, sizeof *d);
  if (!from->n_tri || !to->n_tri) return VG_OK;
  m.d = vg_calloc(n, sizeof *m.d);
  m.hint = vg_alloc(from->n_point, sizeof *m.hint);
  if (!m.d || !m.hint)
    VG_TRY(vg_fail_memory(err, "the distances of the surfaces"));
  memset(m.hint, 0xff, from->n_point * sizeof *m.hint);
  for (size_t i = 0; i < 3 * from->n_tri; i++)
    m.hint[from->tri[i / 3][i % 3]] = 0;
  VG_TRY(vg_ref_build(&ref, to, err));
  vg_parallel_for(threads, from->n_point, GRAIN, at_points, &m);
  vg_parallel_for(threads, from->n_tri, GRAIN, at_faces, &m);
  find_most(&m, face, d);
  VG_TRY(find_99(n, m.d, &d->most_99, err));
done:
  vg_ref_release(&ref);
  free(m.hint);
  free(m.d);
  return st;
}
