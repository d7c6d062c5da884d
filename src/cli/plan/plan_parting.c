/* The parting of the field that vanguard mesh would begin with: made as it
 * would be, but for sizes that are as coarse as a forecast's. */
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "cli/plan/plan_estimate.h"
#include "partition/advance/ways.h"

static struct vg_void view(const struct vg_front *f)
{
  return (struct vg_void){ .n_point = f->n_point, .x = f->x,
                           .n_face = f->n_face, .face = f->face };
}

/* Cells expected in parts: their sum, the most, of those that are filled as
 * they are. */
static vg_status weigh_parts(const struct vg_plan *p,
                             const struct vg_parting *made,
                             struct vg_plan_parting *to, struct vg_error *err)
{
  struct vg_void *v = vg_calloc(made->n_part, sizeof *v);
  struct vg_load *l = vg_calloc(made->n_part, sizeof *l);
  vg_status st = v && l ? VG_OK : vg_fail_memory(err, "the parts");

  for (size_t k = 0; st == VG_OK && k < made->n_part; k++)
    v[k] = view(&made->part[k].front);
  if (st == VG_OK)
    st = vg_load_split(&p->load, made->n_part, v, 1, NULL, l, err);
  for (size_t k = 0; st == VG_OK && k < made->n_part; k++) {
    if (made->part[k].may_cut) continue;
    to->n_whole++;
    to->cells += l[k].cells;
    if (l[k].cells > to->most) to->most = l[k].cells;
  }
  for (size_t k = 0; l && k < made->n_part; k++) vg_load_release(&l[k]);
  free(l);
  free(v);
  return st;
}

static struct vg_parting_options options_of(const struct vg_plan *p)
{
  const struct vg_settings *s = &p->problem.settings;
  struct vg_parting_options o = VG_PARTING_OPTIONS_INIT;
  double leaf = s->levels ? 0 : (double)s->leaf_cells;

  o.n_part = s->parts == VG_COUNT_NONE ? vg_parting_parts(p->load.cells, leaf)
                                       : (int)s->parts;
  o.partitioner = s->partitioner;
  o.coarsening = s->coarsening;
  o.h_refine = s->h_refine;
  return o;
}

vg_status vg_plan_part(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_way *way = &vg_ways[p->problem.settings.decompose];
  const struct vg_mesh *m = p->front;
  struct vg_front f = { .n_point = m->n_point, .n_face = m->n_tri,
                        .x = m->point, .face = m->tri };
  struct vg_parting made = VG_PARTING_INIT;
  struct vg_parting_options o = options_of(p);
  double t = vg_clock();
  vg_status st;

  if (!way->maker || m == &p->lifted) return VG_OK;
  f.name = vg_alloc(f.n_point, sizeof *f.name);
  if (!f.name) return vg_fail_memory(err, "the front");
  for (size_t k = 0; k < f.n_point; k++) f.name[k] = VG_POINT_NAME(0, k);
  st = way->maker(&f, &p->load, p->sizing, &o, 1, NULL, &made, err);
  if (st == VG_OK) {
    p->parting.n_part = made.n_part;
    p->parting.report = made.report;
    p->parting.seconds = vg_clock() - t;
    st = weigh_parts(p, &made, &p->parting, err);
  }
  free(f.name);
  vg_parting_release(&made);
  return st;
}
