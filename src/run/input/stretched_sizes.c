/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Stretched sizing fields: for remeshing, before the surface has its final
 * edges, and over the boundary. Declared in run/input/input.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "run/input/input.h"
#include "run/settings/plan_options.h"

/* S78: edges of these lengths in the metric follow it. */
#define SHORT 0.5
#define LONG 2.0
#define GRAIN 1024

int vg_boundary_is_stretched(const struct vg_boundary *b)
{
  const struct vg_settings *s = &b->read->settings;

  if (b->map && b->map->metric) return 1;
  for (size_t i = 0; i < s->n_source; i++)
    if (vg_source_is_stretched(&s->source[i])) return 1;
  return 0;
}

vg_status vg_boundary_field(const struct vg_boundary *b, size_t n_source,
                            const struct vg_source *source,
                            struct vg_sizing **field, struct vg_error *err)
{
  struct vg_sizing_options options = vg_boundary_sizing(b);
  struct vg_sizing *made = NULL;
  vg_status st;

  if (!vg_boundary_is_stretched(b)) return VG_OK;
  options.from_surface = 0;
  options.threads = b->threads;
  if (!(options.h_max > 0)) options.h_max = INFINITY;
  st = vg_sizing_new(&options, n_source, source, &b->surface, &made, err);
  if (st < 0) return st;
  if (vg_sizing_is_stretched(made)) *field = made;
  else vg_sizing_free(made);
  return VG_OK;
}

double vg_boundary_largest_edge(const struct vg_boundary *b, double h_max)
{
  double lo[3], hi[3];

  if (h_max > 0 || !b->map || !b->map->metric) return h_max;
  vg_mesh_bounds(&b->surface, lo, hi);
  return vg_distance(lo, hi);
}

/* Faces of m that do not follow the metric. */
struct sieve {
  const struct vg_mesh *m;
  const struct vg_sizing *field;
  double (*metric)[6]; /* [n_point] */
  uint8_t *sized;      /* [n_tri] 1: an edge is too short or too long. */
};

static void find_metrics(void *context, size_t first, size_t end, int worker)
{
  struct sieve *s = context;
  double t[6];

  (void)worker;
  for (size_t p = first; p < end; p++) {
    vg_sizing_stretch_at(s->field, s->m->point[p], t);
    vg_tensor_square(t, s->metric[p]);
  }
}

static void find_sized(void *context, size_t first, size_t end, int worker)
{
  struct sieve *s = context;

  (void)worker;
  for (size_t t = first; t < end; t++)
    for (int k = 0; k < 3; k++) {
      const uint32_t p = s->m->tri[t][k], q = s->m->tri[t][(k + 1) % 3];
      double e[3], l;

      vg_sub(s->m->point[q], s->m->point[p], e);
      l = vg_metric_length(s->metric[p], s->metric[q], e);
      s->sized[t] |= !(l >= SHORT && l <= LONG);
    }
}

/* The mesh `view` shares all arrays of m but the triangles. */
static vg_status take_sized(const struct vg_mesh *m,
                            const struct vg_sizing *field, int threads,
                            struct vg_mesh *view, struct vg_error *err)
{
  struct sieve s = { m, field, vg_alloc(m->n_point, sizeof *s.metric),
                     vg_calloc(m->n_tri, 1) };
  uint32_t(*tri)[3] = vg_alloc(m->n_tri, sizeof *tri);
  vg_status st = VG_OK;

  if (!s.metric || !s.sized || !tri)
    VG_TRY(vg_fail_memory(err, "the sizes of the surface"));
  vg_parallel_for(threads, m->n_point, GRAIN, find_metrics, &s);
  vg_parallel_for(threads, m->n_tri, GRAIN, find_sized, &s);
  *view = *m;
  view->tri = tri;
  view->n_tri = 0;
  for (size_t t = 0; t < m->n_tri; t++)
    if (s.sized[t]) memcpy(tri[view->n_tri++], m->tri[t], sizeof *tri);
  tri = NULL;
done:
  free(s.metric);
  free(s.sized);
  free(tri);
  return st;
}

vg_status vg_boundary_measure(const struct vg_boundary *b,
                              const struct vg_sizing_options *options,
                              const struct vg_settings *s,
                              const struct vg_mesh *m, struct vg_sizing **out,
                              struct vg_error *err)
{
  struct vg_sizing_options o = *options;
  struct vg_sizing *field = NULL;
  struct vg_mesh view = VG_MESH_INIT;
  vg_status st;

  if (!o.from_surface || !vg_boundary_is_stretched(b))
    return vg_sizing_new(&o, s->n_source, s->source, m, out, err);
  o.from_surface = 0;
  VG_TRY(vg_sizing_new(&o, s->n_source, s->source, m, &field, err));
  if (vg_sizing_is_stretched(field))
    VG_TRY(take_sized(m, field, o.threads, &view, err));
  else view = *m;
  if (view.n_tri || view.n_quad) {
    vg_sizing_free(field);
    field = NULL;
    o.from_surface = 1;
    VG_TRY(vg_sizing_new(&o, s->n_source, s->source, &view, &field, err));
  }
  *out = field;
  field = NULL;
done:
  vg_sizing_free(field);
  if (view.tri != m->tri) free(view.tri);
  return st;
}
