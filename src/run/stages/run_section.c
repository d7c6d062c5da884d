/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The mesh of a plane section, from its slab to slices. */
#include <math.h>
#include <stdlib.h>

#include "base/team.h"
#include "run/section/section_surface.h"
#include "run/stages/run_parts.h"

/* Sizing field and layers of a slab, on the cores of the node. */
static vg_status grow_section(struct vg_run *r, const struct vg_problem *p,
                              struct vg_layer_stage *layers,
                              struct vg_team *team, struct vg_display *show,
                              struct vg_sizing **sizing, struct vg_error *err)
{
  const struct vg_mesh *slab = &p->boundary.surface;
  const int threads = vg_run_node_threads(r, &p->asked);
  struct vg_mesh view = VG_MESH_INIT;
  double t;
  vg_status st;

  VG_TRY(vg_section_sizes(slab, &view, err));
  VG_TRY(
    vg_run_measure_sizes(r, p, &view, 1, threads, team, show, sizing, err));
  t = vg_display_now();
  layers->options.threads = threads;
  layers->options.team = team;
  if (layers->is_on) st = vg_layer_stage_grow(layers, slab, *sizing, show, err);
  r->time_layers = vg_display_now() - t;
done:
  layers->options.team = NULL;
  st = vg_team_close(team, st, err);
  vg_comm_bind_node(r->comm, 0);
  free(view.point);
  free(view.tri);
  free(view.tri_patch);
  return st;
}

static vg_status finish_section(struct vg_run *r, const struct vg_problem *p,
                                struct vg_layer_stage *layers,
                                struct vg_error *err)
{
  const struct vg_mesh *slab = &p->boundary.surface;
  vg_status st = vg_section_tops(slab, &layers->layers, &r->section.plane,
                                 r->section.top, &layers->top, err);

  if (st >= 0 && !r->rank) st = vg_layer_stage_finish(layers, slab, err);
  return vg_comm_agree(r->comm, st, err);
}

/* The limit on cells, for the mesh in the plane. */
static vg_status check_cells(const struct vg_settings *s,
                             const struct vg_plane_mesh *m,
                             struct vg_error *err)
{
  const uint64_t n = (uint64_t)m->n_tri + m->n_quad;

  if (!s->max_cells || n <= (uint64_t)s->max_cells) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the mesh in the plane has %llu cells, %llu of them in the "
                 "layers, but only %llu are allowed (max_cells); use a coarser "
                 "spacing, fewer layers, or increase the limit",
                 (unsigned long long)n,
                 (unsigned long long)(m->n_layer_tri + m->n_quad),
                 (unsigned long long)s->max_cells);
}

vg_status vg_run_section(struct vg_run *r, const struct vg_problem *p,
                         struct vg_layer_stage *layers, struct vg_display *show,
                         struct vg_error *err)
{
  const struct vg_settings *s = &p->resolved.settings;
  const struct vg_mesh *slab = &p->boundary.surface;
  struct vg_layers *grown = layers->is_on ? &layers->layers : NULL;
  double width;
  struct vg_sizing *sizing = NULL;
  struct vg_team *team;
  vg_status st = vg_team_open(r->comm, &team, err);

  if (st < 0) return st;
  if (vg_run_leads_node(r))
    st = grow_section(r, p, layers, team, show, &sizing, err);
  VG_TRY(vg_run_share_with_node(r, st, grown, show, &sizing, err));
  VG_TRY(vg_run_agree(r->comm, slab, grown, sizing, r->options.change, err));
  width = vg_section_width(s, slab, p->boundary.n_row);
  st = vg_section_mesh_new(slab, grown, s->section_axis ? 1 : 2, width,
                           &r->section, err);
  if (st >= 0) st = check_cells(s, &r->section.plane, err);
  VG_TRY(vg_comm_agree(r->comm, st, err));
  r->spans.n_rank = r->size;
  r->spans.n_thread = r->threads;
  vg_section_mesh_slices(&r->section, !r->rank, &r->slices);
  if (r->outputs) r->outputs->plane = &r->section.plane;
  r->pictures.axis = s->section_axis ? 1 : 2;
  r->pictures.at = 0.5 * width;
  r->n_field_cell = r->section.plane.n_tri - r->section.plane.n_layer_tri;
  VG_TRY(vg_run_judge(r, p, grown, sizing, show, err));
  /* Every cell has faces in the planes, which do not count. */
  r->judge.solver.determinant_min = r->field_judge.solver.determinant_min = NAN;
  r->judge.solver.n_determinant = r->field_judge.solver.n_determinant = 0;
  st = vg_plane_judge(&r->section.plane, &r->plane, err);
  VG_TRY(vg_comm_agree(r->comm, st, err));
  if (grown) st = finish_section(r, p, layers, err);
done:
  vg_sizing_free(sizing);
  return st;
}
