#include "core/remesh/remesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/remesh/reference.h"

#define GRAIN 1024
#define SAMPLES 7         /* of a triangle: corners, middles, centroid */

struct measuring {
  const struct vg_mesh *from;
  const struct vg_ref *to;
  double *d;              /* [SAMPLES n_tri] */
};

static void sample(const struct vg_mesh *m, size_t t, int i, double x[3])
{
  const double *p[3];

  for (int k = 0; k < 3; k++) p[k] = m->point[m->tri[t][k]];
  for (int d = 0; d < 3; d++)
    x[d] = i < 3 ? p[i][d] : i < 6 ? (p[i - 3][d] + p[(i - 2) % 3][d]) / 2
           : (p[0][d] + p[1][d] + p[2][d]) / 3;
}

static void body(void *context, size_t first, size_t end, int worker)
{
  const struct measuring *m = context;
  uint32_t hint = VG_REF_NONE;

  (void)worker;
  for (size_t t = first; t < end; t++)
    for (int i = 0; i < SAMPLES; i++) {
      double x[3], y[3];

      sample(m->from, t, i, x);
      m->d[SAMPLES * t + (size_t)i] = vg_ref_nearest(m->to, x, NULL, &hint,
                                                     y);
    }
}

static int by_value(const void *pa, const void *pb)
{
  const double *a = pa, *b = pb;

  return (*a > *b) - (*a < *b);
}

vg_status vg_remesh_measure(const struct vg_mesh *from,
                            const struct vg_mesh *to, int threads,
                            double *face, struct vg_remesh_distance *d,
                            struct vg_error *err)
{
  struct vg_ref ref = VG_REF_INIT;
  struct measuring m = { from, &ref, NULL };
  const size_t n = SAMPLES * from->n_tri;
  vg_status st = VG_OK;

  memset(d, 0, sizeof *d);
  if (!from->n_tri || !to->n_tri) return VG_OK;
  m.d = vg_alloc(n, sizeof *m.d);
  if (!m.d) return vg_fail_memory(err, "the distances of the surfaces");
  VG_TRY(vg_ref_build(&ref, to, err));
  vg_parallel_for(threads, from->n_tri, GRAIN, body, &m);
  for (size_t i = 0; i < n; i++) {
    double *most = face ? &face[i / SAMPLES] : NULL;

    if (most) *most = i % SAMPLES ? fmax(*most, m.d[i]) : m.d[i];
    if (!(m.d[i] > d->most)) continue;
    d->most = m.d[i];
    sample(from, i / SAMPLES, (int)(i % SAMPLES), d->at);
  }
  qsort(m.d, n, sizeof *m.d, by_value);
  d->most_99 = m.d[n - 1 - n / 100];
done:
  vg_ref_release(&ref);
  free(m.d);
  return st;
}
