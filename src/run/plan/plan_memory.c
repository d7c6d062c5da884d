/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Memory of a rank in each stage of a run, from the counts of the forecast. */
#include <assert.h>

#include "run/plan/run_plan_parts.h"

static struct vg_memory_counts counts_of(const struct vg_plan *p)
{
  return (struct vg_memory_counts){
    .triangles = (double)p->front->n_tri,
    .columns = (double)p->n_wall_point,
    .leaves = (double)vg_sizing_leaves(p->sizing) * p->finer,
    .is_stretched = vg_sizing_is_stretched(p->sizing),
    .cells = p->load.cells,
    .has_pictures = p->problem->resolved.settings.report_html
  };
}

double vg_plan_shared(const struct vg_plan *p)
{
  const struct vg_memory_counts c = counts_of(p);

  return vg_memory_shared(&c);
}

/* The forecast itself goes through the stage of the surface. */
void vg_plan_memory(const struct vg_plan *p, const struct vg_forecast *o,
                    int ranks, int threads, double stage[VG_MEMORY_STAGES])
{
  const double mpi = ranks > 1 ? VG_MEMORY_MPI : 0;
  struct vg_memory_counts c = counts_of(p);

  vg_memory_of_tasks(o, &c);
  vg_memory_stages(&c, ranks, threads, stage);
  for (int i = 0; i < VG_MEMORY_STAGES; i++)
    stage[i] += p->o->program + mpi + p->shared;
  stage[VG_MEMORY_SURFACE] = p->surface_peak + mpi;
}
