/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/stages/run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/team.h"
#include "base/version.h"
#include "core/mesh/sheets.h"
#include "layers/columns/share.h"
#include "layers/relax/relax.h"
#include "partition/advance/ways.h"
#include "run/input/share.h"
#include "run/input/sizes.h"
#include "run/input/walls.h"
#include "run/report/report.h"
#include "run/settings/plan_options.h"
#include "run/stages/run_parts.h"

uint64_t vg_run_cells(const struct vg_run *r)
{
  uint64_t n = 0;

  for (int k = 0; k < VG_SLICE_KINDS; k++) n += r->slices.n_cell[k];
  return n;
}

/* --- sizing field and layers, on every node ------------------------------ */

/* These steps are done by the first rank of each node, on the cores of all
 * ranks of its node, which sleep meanwhile. */
int vg_run_leads_node(const struct vg_run *r)
{
  return vg_comm_node_rank(r->comm) == 0;
}

int vg_run_node_threads(struct vg_run *r, const struct vg_settings *s)
{
  if (!s->threads) return vg_comm_node_cores(r->comm, 1);
  vg_comm_bind_node(r->comm, 1);
  return (int)s->threads * vg_comm_node_size(r->comm);
}

/* Called on the first rank of a node. */
static vg_status shape_surface(struct vg_run *r, struct vg_problem *p,
                               struct vg_display *show, struct vg_error *err)
{
  const struct vg_shape_options o = {
    .threads = vg_run_node_threads(r, &p->asked),
    .has_maker = r->rank && vg_problem_has_maker(p, r->comm)
  };
  vg_status st = vg_boundary_shape(&p->read, &o, show, &p->boundary, err);

  vg_comm_bind_node(r->comm, 0);
  return st;
}

static vg_status settle_surface(struct vg_run *r, struct vg_problem *p,
                                struct vg_layer_stage *layers,
                                struct vg_display *show, struct vg_error *err)
{
  struct vg_boundary *b = &p->boundary;
  vg_status st;

  b->threads = vg_run_node_threads(r, &p->asked);
  VG_TRY(vg_boundary_close(b, show, err));
  VG_TRY(vg_layer_stage_plan(layers, b, err));
  VG_TRY(vg_boundary_finish_conditions(b, err));
  st = vg_problem_settle(p, layers, err);
done:
  vg_comm_bind_node(r->comm, 0);
  return st;
}

/* Called on the other ranks of a node, which receive the surface. */
static vg_status await_surface(struct vg_problem *p, struct vg_error *err)
{
  vg_problem_forget_sizes(p);
  vg_mesh_release(&p->read.surface);
  return vg_resolve_nothing(&p->read.settings, &p->resolved, err);
}

vg_status vg_run_surface(struct vg_run *r, struct vg_problem *p,
                         struct vg_layer_stage *layers, struct vg_display *show,
                         struct vg_error *err)
{
  struct vg_boundary *b = &p->boundary;
  uint64_t is_on = 0;
  vg_status st = VG_OK;

  VG_TRY(vg_comm_watch(r->comm, p->asked.rank_silence, err));
  VG_TRY(vg_run_helpers(r->comm, err));
  if (vg_run_leads_node(r)) st = shape_surface(r, p, show, err);
  VG_TRY(vg_problem_share(p, r->comm, vg_run_leads_node(r), st, err));
  st = vg_run_leads_node(r) ? settle_surface(r, p, layers, show, err)
                            : await_surface(p, err);
  VG_TRY(vg_comm_agree(r->comm, st, err));
  is_on = (uint64_t)layers->is_on;
  st = vg_surface_share(r->comm, &b->surface, &is_on, &b->common, err);
  layers->is_on = (int)is_on;
  r->common += vg_shared_bytes(&b->common);
  st = vg_comm_agree(r->comm, st, err);
done:
  vg_run_stage_ends(r, VG_STAGE_SURFACE);
  return st;
}

/* Shares the data made by the first rank of the node, with status st, with its
 * other ranks. Collective. layers is NULL without layers. */
vg_status vg_run_share_with_node(struct vg_run *r, vg_status st,
                                 struct vg_layers *layers,
                                 struct vg_display *show,
                                 struct vg_sizing **sizing,
                                 struct vg_error *err)
{
  VG_TRY(vg_comm_agree(r->comm, st, err));
  if (layers) st = vg_layers_share(r->comm, layers, err);
  VG_TRY(vg_comm_agree(r->comm, st, err));
  st = vg_sizing_share(r->comm, sizing, err);
  if (st >= 0) {
    r->common += vg_sizing_shmem(*sizing);
    if (layers) r->common += vg_shared_bytes(&layers->common);
    st = vg_display_stopped(show, err);
  }
  st = vg_comm_agree(r->comm, st, err);
done:
  return st;
}

/* Builds the sizing field over a boundary. */
vg_status vg_run_measure_sizes(struct vg_run *r, const struct vg_problem *p,
                               const struct vg_mesh *boundary,
                               double coarseness, int threads,
                               struct vg_team *team, struct vg_display *show,
                               struct vg_sizing **sizing, struct vg_error *err)
{
  const struct vg_settings *s = &p->resolved.settings;
  struct vg_sizing_options options = vg_boundary_sizing(&p->boundary);
  double t = vg_display_now();
  vg_status st;

  options.threads = threads;
  options.coarseness = coarseness;
  options.team = team;
  vg_display_update(show, "sizing field", 0, 0);
  st = vg_boundary_measure(&p->boundary, &options, s, boundary, sizing, err);
  r->time_size += vg_display_now() - t;
  return st < 0 ? st : vg_display_stopped(show, err);
}

/* Finds the sources without effect, on rank 0. Collective. */
static vg_status find_ineffective_sources(struct vg_run *r,
                                          const struct vg_problem *p,
                                          const struct vg_mesh *front,
                                          const struct vg_sizing *sizing,
                                          struct vg_error *err)
{
  double t = vg_display_now();
  vg_status st = VG_OK;

  if (!r->rank)
    st = vg_boundary_effects(&p->boundary, front, sizing, &r->effects, err);
  r->time_size += vg_display_now() - t;
  return vg_comm_agree(r->comm, st, err);
}

/* --- the run directory --------------------------------------------------- */

static void add_digest(void *user, size_t n, const void *data)
{
  struct vg_digest *d = user;

  *d = vg_digest_of(*d, n, data);
}

/* The outcomes of tasks depend on their input, the program, the settings, the
 * boundary, and sizes that no setting describes. Only rank 0 has resolved
 * settings; the other ranks receive its digest. Collective. */
static vg_status job_digest(const struct vg_run *r, const struct vg_problem *p,
                            const struct vg_mesh *boundary,
                            const struct vg_sizing *sizing,
                            struct vg_digest *out, struct vg_error *err)
{
  const struct vg_settings *s = &p->resolved.settings;
  struct vg_digest d = { { 0, 0 } };
  struct vg_bytes all = { 0, NULL };
  vg_status st = VG_OK;

  if (!r->rank) st = vg_run_settings_digest(s, &d, err);
  VG_TRY(vg_comm_agree(r->comm, st, err));
  if (!r->rank) all = (struct vg_bytes){ sizeof d, (unsigned char *)&d };
  VG_TRY(vg_comm_bcast(r->comm, 0, &all, err));
  if (r->rank) memcpy(&d, all.data, sizeof d);
  d = vg_digest_of(d, strlen(vg_source_digest), vg_source_digest);
  d = vg_digest_of(d, boundary->n_point * sizeof *boundary->point,
                   boundary->point);
  d = vg_digest_of(d, boundary->n_tri * sizeof *boundary->tri, boundary->tri);
  if (*s->sizes || s->gap_edges > 0) vg_sizing_show(sizing, add_digest, &d);
  *out = d;
done:
  if (r->rank) free(all.data);
  return st;
}

vg_status vg_run_resumable(struct vg_run *r, struct vg_error *err)
{
  vg_status st = VG_OK;

  if (!r->options.resume) return VG_OK;
  if (!r->rank) st = vg_store_has_run(r->options.dir, err);
  return vg_comm_agree(r->comm, st, err);
}

static vg_status open_store(struct vg_run *r, const struct vg_problem *p,
                            const struct vg_mesh *boundary,
                            const struct vg_sizing *sizing,
                            struct vg_partition_options *o,
                            struct vg_error *err)
{
  struct vg_store_options s = { .dir = r->options.dir,
                                .resume = r->options.resume,
                                .limit = r->options.limit };
  char what[200], *settings = NULL;
  vg_status st;

  if (!r->options.dir) return VG_OK;
  VG_TRY(job_digest(r, p, boundary, sizing, &o->job, err));
  s.job = o->job;
  snprintf(what, sizeof what, "%s (%zu boundary triangles)",
           p->resolved.settings.title, boundary->n_tri);
  s.what = what;
  s.settings = settings = vg_run_settings(&p->resolved.settings, boundary);
  st = settings ? VG_OK : vg_fail_memory(err, "the settings");
  VG_TRY(vg_comm_agree(r->comm, st, err));
  st = vg_store_open(r->comm, &s, &r->store, err);
done:
  free(settings);
  return st;
}

static vg_status say_stopped(const struct vg_run *r, struct vg_error *err)
{
  if (!r->store)
    return vg_fail(err, VG_ERR_STOPPED,
                   "interrupted; nothing was written "
                   "(with --run-dir a run can be resumed)");
  return vg_fail(err, VG_ERR_STOPPED,
                 "stopped; finished tasks are kept in %s: repeat the command "
                 "with --resume to continue, on any number of ranks",
                 r->options.dir);
}

/* A failure of the machine does not lose finished tasks. */
static vg_status say_kept(const struct vg_run *r, vg_status st,
                          struct vg_error *err)
{
  struct vg_error why = *err;

  if (!r->store || (st != VG_ERR_IO && st != VG_ERR_MEMORY)) return st;
  return vg_fail(err, st,
                 "%.700s; finished tasks are kept in %.200s: repeat the "
                 "command with --resume to continue",
                 why.text, r->options.dir);
}

/* --- the field ----------------------------------------------------------- */

/* Opens the mesher of the leaves if it is not the built-in kernel. */
static vg_status open_mesher(const struct vg_run *r,
                             const struct vg_settings *s,
                             struct vg_mesher_pool **out, struct vg_error *err)
{
  vg_status st = VG_OK;

  if (strcmp(s->mesher, "builtin") != 0)
    st = vg_mesher_open(s->mesher, out, err);
  return vg_comm_agree(r->comm, st, err);
}

/* Number of layer cells; 0 without a limit on cells, which the layers alone may
 * exceed. The same on all ranks. */
static vg_status count_layers(const struct vg_run *r,
                              const struct vg_problem *p,
                              const struct vg_layers *layers, uint64_t *n,
                              struct vg_error *err)
{
  const struct vg_settings *s = &p->resolved.settings;
  vg_status st;

  *n = 0;
  if (!s->max_cells || !layers) return VG_OK;
  st = vg_layers_count(&p->boundary.surface, layers,
                       (enum vg_layer_cells)s->cells, r->threads, n, err);
  if (st >= 0 && *n > (uint64_t)s->max_cells)
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the layers alone have %llu cells, but only %llu are allowed "
                 "(max_cells); use a coarser surface, fewer layers, cells "
                 "mixed, or increase the limit",
                 (unsigned long long)*n, (unsigned long long)s->max_cells);
  return vg_comm_agree(r->comm, st, err);
}

static vg_status fill(struct vg_run *r, const struct vg_problem *p,
                      const struct vg_layers *layers,
                      const struct vg_mesh *boundary,
                      const struct vg_sizing *sizing, struct vg_display *show,
                      struct vg_error *err)
{
  const struct vg_settings *s = &p->resolved.settings;
  struct vg_partition_options o = vg_options_partition(s);
  const struct vg_run_admission admission = {
    .run = r,
    .settings = s,
    .counts = { .triangles = (double)boundary->n_tri,
                .columns = layers ? (double)layers->columns.n_column : 0,
                .leaves = (double)vg_sizing_leaves(sizing),
                .is_stretched = vg_sizing_is_stretched(sizing),
                .has_pictures = r->outputs && s->report_html },
    .is_parted = o.maker != NULL
  };
  double t = vg_display_now();
  vg_status st;

  r->decomposition = vg_ways[s->decompose].name;
  r->cyclic = o.cyclic;
  o.threads = r->threads;
  VG_TRY(count_layers(r, p, layers, &o.layer_cells, err));
  o.shuffle = r->options.shuffle;
  o.fail_leaves = r->options.fail_leaves;
  o.fail_rounds = r->options.fail_rounds;
  o.admit = vg_run_admit;
  o.admit_user = &admission;
  o.progress = (struct vg_progress){ vg_display_update, show };
  o.stop = (struct vg_stop){ vg_display_stop, show };
  VG_TRY(open_mesher(r, s, &o.mesher, err));
  vg_display_update(show, "load estimate", 0, 0);
  VG_TRY(open_store(r, p, boundary, sizing, &o, err));
  o.store = r->store;
  vg_run_measure(r, &p->boundary.surface, layers, sizing);
  vg_run_stage_ends(r, VG_STAGE_SIZES);
  /* The surface and the field needed much more than the fill will. In other
   * fields, the fill is faster in the large pages that are free. */
  if (vg_sizing_is_stretched(sizing)) vg_memory_trim();
  st = vg_partition_grow(r->comm, boundary, sizing, &o, &r->field,
                         &r->partition, &r->spans, err);
  r->time_fill = vg_display_now() - t - r->partition.number;
  t = vg_display_now();
  if (st == VG_OK && r->options.near)
    st = vg_partition_near(r->field, r->comm, &r->near, err);
  r->time_near = vg_display_now() - t;
  if (r->store) vg_store_state(r->store, &r->stored);
  if (st == VG_ERR_STOPPED) st = say_stopped(r, err);
  if (st < 0) st = say_kept(r, st, err);
  if (st >= 0)
    r->n_field_cell = vg_partition_slices(r->field)->n_cell[VG_SLICE_TET];
done:
  vg_run_stage_ends(r, VG_STAGE_FILL);
  vg_memory_trim();
  vg_mesher_close(o.mesher);
  return st;
}

/* Stops between two steps that do not poll. Collective. */
static vg_status stop_here(const struct vg_run *r, struct vg_display *show,
                           struct vg_error *err)
{
  return vg_comm_agree(r->comm, vg_display_stopped(show, err), err);
}

/* --- mesh check ---------------------------------------------------------- */

static vg_status accept(const struct vg_run *r, int has_field,
                        struct vg_error *err)
{
  char faults[300];

  if (r->judge.is_valid && (!has_field || r->field_judge.is_valid))
    return VG_OK;
  vg_report_faults(r->judge.is_valid ? &r->field_judge : &r->judge, faults,
                   sizeof faults);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "the mesh failed the final check (%s) and was not written; "
                 "please report this with the project files",
                 faults);
}

/* Prepares the classification of flat cells outside the layers. */
static vg_status prepare_flat(const struct vg_run *r,
                              const struct vg_mesh *surface,
                              struct vg_flat **out, struct vg_error *err)
{
  const struct vg_flat_boundary b = {
    .n_point = surface->n_point,
    .n_face = surface->n_tri,
    .face = (const uint32_t(*)[3])surface->tri,
    .patch = surface->tri_patch
  };
  vg_status st = VG_OK;

  /* A mesh of a section has no tetrahedra. */
  if (!r->section.solid.n_point)
    st = r->layers ? vg_layer_slices_flat(r->layers, out, err)
                   : vg_flat_new(&b, out, err);
  return vg_comm_agree(r->comm, st, err);
}

struct put {
  struct vg_run *run;
  struct vg_sheet_sides *sides;  /* NULL without sheets */
  struct vg_zone_quality *zones; /* NULL without zones */
  struct vg_display *show;
};

static vg_status put_slice(void *context, const struct vg_slice *slice,
                           struct vg_error *err)
{
  struct put *p = context;
  struct vg_run *r = p->run;
  vg_status st = vg_display_stopped(p->show, err);

  if (st >= 0) vg_sheet_sides_add(p->sides, slice);
  if (st >= 0) st = vg_zone_quality_add(p->zones, slice, err);
  if (st >= 0) st = vg_outputs_put(r->outputs, slice, err);
  return st < 0 ? st : vg_run_pictures_put(&r->pictures, slice, err);
}

/* Every triangle of a sheet must have one cell on each side. */
static vg_status accept_sheets(struct vg_run *r, const struct vg_mesh *surface,
                               const struct put *put, struct vg_error *err)
{
  const struct vg_mesh *m = r->slices.boundary;
  struct vg_mesh s = VG_MESH_INIT;
  vg_status st;

  if (!put->sides) return VG_OK;
  r->sheets = vg_calloc(m->n_sheet, sizeof *r->sheets);
  st = r->sheets ? vg_mesh_copy(&s, surface, err)
                 : vg_fail_memory(err, "the sheets");
  if (st >= 0) st = vg_mesh_part_sheets(&s, err);
  VG_TRY(vg_comm_agree(r->comm, st, err));
  VG_TRY(vg_sheet_sides_sum(r->comm, put->sides, r->sheets, err));
  for (size_t i = 0; i < m->n_sheet; i++)
    r->sheets[i].area = vg_mesh_sheet_area(&s, i);
  for (size_t i = 0; i < m->n_sheet && st >= 0; i++)
    if (r->sheets[i].n_bad)
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "%llu triangles of sheet %d%s%s are not faces between two "
                   "cells, and the mesh was not written; please report this "
                   "with the project files",
                   (unsigned long long)r->sheets[i].n_bad, (int)m->sheet[i].id,
                   *m->sheet[i].name ? " " : "", m->sheet[i].name);
done:
  vg_mesh_release(&s);
  return st;
}

/* Counts the cells across wakes. The lines are the same on all ranks. */
static vg_status measure_wakes(struct vg_run *r, const struct vg_read_wakes *w,
                               struct vg_error *err)
{
  vg_status st = VG_OK;

  if (!w->n_probe) return VG_OK;
  r->probe = vg_alloc(w->n_probe, sizeof *r->probe);
  if (!r->probe) st = vg_fail_memory(err, "the lines across wakes");
  VG_TRY(vg_comm_agree(r->comm, st, err));
  memcpy(r->probe, w->probe, w->n_probe * sizeof *r->probe);
  r->n_probe = w->n_probe;
  st = vg_wake_measure(r->comm, &r->slices, r->threads, r->n_probe, r->probe,
                       err);
done:
  return st;
}

/* Edges are compared with the sizing field only outside the layers, where sizes
 * are isotropic. The file of an invalid mesh is removed. */
vg_status vg_run_judge(struct vg_run *r, const struct vg_problem *p,
                       const struct vg_layers *layers,
                       const struct vg_sizing *sizing, struct vg_display *show,
                       struct vg_error *err)
{
  const int is_section = r->section.solid.n_point > 0;
  size_t front_faces = is_section ? r->section.n_front
                     : layers     ? vg_layer_slices_front(r->layers)
                                  : 0;
  struct put put = { .run = r, .show = show };
  struct vg_flat *flat = NULL;
  double t = vg_display_now();
  vg_status st;

  VG_TRY(vg_run_verify_periodic(r, p, err));
  vg_display_update(show, "mesh check", vg_run_cells(r), 0);
  VG_TRY(vg_run_pictures_plan(&r->pictures, r->comm, &p->boundary.surface,
                              layers ? &layers->columns : NULL, err));
  VG_TRY(prepare_flat(r, &p->boundary.surface, &flat, err));
  r->memory_of.numbers = vg_flat_bytes(flat);
  if (r->layers) r->memory_of.numbers += vg_layer_slices_bytes(r->layers);
  st = vg_sheet_sides_new(r->slices.boundary, &put.sides, err);
  if (st >= 0) st = vg_zone_quality_new(r->slices.boundary, &put.zones, err);
  VG_TRY(vg_comm_agree(r->comm, st, err));
  VG_TRY(vg_outputs_open(r->outputs, p, r->comm, &r->slices, err));
  st = vg_slices_judge_with(r->comm, &r->slices, front_faces, sizing,
                            r->threads, flat, vg_wants_median_dual(&p->asked),
                            put_slice, &put, &r->judge,
                            layers ? &r->field_judge : NULL, err);
  if (st >= 0)
    st = vg_effects_in_mesh(r->comm, &r->slices, r->threads, &r->effects, err);
  if (st >= 0) st = measure_wakes(r, &p->read.wakes, err);
  if (st >= 0) st = accept(r, layers != NULL, err);
  if (st >= 0) st = accept_sheets(r, &p->boundary.surface, &put, err);
  if (st >= 0) st = vg_run_judge_zones(r, put.zones, err);
  if (st >= 0) st = vg_display_stopped(show, err);
  st = vg_outputs_close(r->outputs, st, err);
  st = vg_comm_agree(r->comm, st, err);
  if (st >= 0)
    st = vg_run_pictures_gather(&r->pictures, r->comm,
                                is_section || r->zones
                                  ? &r->slices
                                  : vg_partition_slices(r->field),
                                r->slices.n_layer_cell[VG_SLICE_TET],
                                r->threads,
                                layers ? &r->field_judge : &r->judge, err);
done:
  vg_run_stage_ends(r, VG_STAGE_CHECK);
  vg_flat_free(flat);
  vg_sheet_sides_free(put.sides);
  vg_zone_quality_free(put.zones);
  if (r->outputs)
    r->time_put = 1e-9 * (double)r->outputs->put_time / r->threads;
  r->time_judge += vg_display_now() - t - r->time_put - r->pictures.time;
  return st;
}

/* The boundary of the mesh without sheets, which the field has as patches. */
static vg_status part_sheets(struct vg_run *r, struct vg_error *err)
{
  vg_status st = VG_OK;

  if (!vg_mesh_has_sheets(r->slices.boundary)) return VG_OK;
  VG_TRY(vg_mesh_copy(&r->parted_boundary, r->slices.boundary, err));
  VG_TRY(vg_mesh_part_sheets(&r->parted_boundary, err));
  r->slices.boundary = &r->parted_boundary;
done:
  return st;
}

static vg_status mesh_plain(struct vg_run *r, const struct vg_problem *p,
                            struct vg_display *show, struct vg_error *err)
{
  const struct vg_mesh *surface = &p->boundary.surface;
  struct vg_sizing *sizing = NULL;
  struct vg_team *team;
  vg_status st = vg_team_open(r->comm, &team, err);

  if (st < 0) return st;
  if (vg_run_leads_node(r)) {
    st = vg_run_measure_sizes(r, p, surface, 1,
                              vg_run_node_threads(r, &p->asked), team, show,
                              &sizing, err);
    st = vg_team_close(team, st, err);
    vg_comm_bind_node(r->comm, 0);
  }
  VG_TRY(vg_run_share_with_node(r, st, NULL, show, &sizing, err));
  VG_TRY(vg_run_agree(r->comm, surface, NULL, sizing, r->options.change, err));
  VG_TRY(find_ineffective_sources(r, p, surface, sizing, err));
  VG_TRY(fill(r, p, NULL, surface, sizing, show, err));
  VG_TRY(stop_here(r, show, err));
  r->slices = *vg_partition_slices(r->field);
  VG_TRY(vg_comm_agree(r->comm, part_sheets(r, err), err));
  VG_TRY(vg_run_sort_zones(r, p, err));
  st = vg_run_judge(r, p, NULL, sizing, show, err);
done:
  vg_sizing_free(sizing);
  return st;
}

/* Columns and the front above them, with its sizing field, on the cores of the
 * nodes. */
static vg_status grow_layers(struct vg_run *r, const struct vg_problem *p,
                             struct vg_layer_stage *layers,
                             struct vg_team *team, struct vg_display *show,
                             struct vg_sizing **sizing, struct vg_error *err)
{
  struct vg_mesh view = VG_MESH_INIT, front;
  int threads = vg_run_node_threads(r, &p->asked);
  double t;
  vg_status st;

  VG_TRY(vg_layer_stage_sizes(layers, &p->boundary, &view, err));
  VG_TRY(vg_run_measure_sizes(r, p, &view, VG_LAYERS_COARSENESS, threads, team,
                              show, sizing, err));
  t = vg_display_now();
  layers->options.threads = threads;
  layers->options.team = team;
  VG_TRY(vg_layer_stage_grow(layers, &p->boundary.surface, *sizing, show, err));
  r->time_layers = vg_display_now() - t;
  VG_TRY(vg_display_stopped(show, err));
  vg_sizing_free(*sizing);
  *sizing = NULL;
  front = vg_front_mesh(&layers->layers.front, &p->boundary.surface);
  st = vg_run_measure_sizes(r, p, &front, 1, threads, team, show, sizing, err);
done:
  layers->options.team = NULL;
  st = vg_team_close(team, st, err);
  vg_comm_bind_node(r->comm, 0);
  free(view.tri);
  free(view.tri_patch);
  return st;
}

/* Distributes the slices of the layers by the number of field cells of each
 * rank. */
static vg_status share_layers(struct vg_run *r, struct vg_error *err)
{
  uint64_t *n = vg_calloc((size_t)r->size, sizeof *n);
  vg_status st = n ? VG_OK : vg_fail_memory(err, "the slices of the layers");

  VG_TRY(vg_comm_agree(r->comm, st, err));
  n[r->rank] = vg_partition_slices(r->field)->n_served;
  VG_TRY(vg_comm_sum(r->comm, (size_t)r->size, n, err));
  vg_layer_slices_share(r->layers, n, &r->slices);
done:
  free(n);
  return st;
}

/* Measures the volume ratios between layers and field; rank 0 reports them. */
static vg_status measure_tops(struct vg_run *r, const struct vg_problem *p,
                              struct vg_layer_stage *layers,
                              struct vg_error *err)
{
  size_t n = layers->layers.columns.n_face;
  double t = vg_display_now();
  vg_status st = VG_OK;

  layers->top = vg_alloc(n, sizeof *layers->top);
  if (!layers->top) st = vg_fail_memory(err, "the tops of the layers");
  VG_TRY(vg_comm_agree(r->comm, st, err));
  VG_TRY(vg_layer_slices_tops(r->comm, r->layers, layers->top, err));
  if (!r->rank) st = vg_layer_stage_finish(layers, &p->boundary.surface, err);
  layers->time_measure += vg_display_now() - t;
  st = vg_comm_agree(r->comm, st, err);
done:
  return st;
}

/* Lowers tops of layers under flat cells of the field, and moves points of the
 * field there. */
static vg_status relax_tops(struct vg_run *r, const struct vg_problem *p,
                            struct vg_layer_stage *layers, struct vg_error *err)
{
  double t = vg_display_now();
  struct vg_slices_point *point;
  size_t n_point;
  vg_status st = vg_layers_relax(r->comm, &p->boundary.surface, &layers->layers,
                                 vg_partition_slices(r->field), r->threads,
                                 &n_point, &point, &layers->relax, err);

  if (st < 0) return st;
  vg_partition_move_points(r->field, n_point, point);
  free(point);
  layers->time_relax = vg_display_now() - t;
  if (!layers->relax.n_column) return VG_OK;
  vg_partition_move_front(r->field);
  layers->options.threads = r->threads;
  if (!r->rank) st = vg_layer_stage_relaxed(layers, &p->boundary.surface, err);
  return vg_comm_agree(r->comm, st, err);
}

/* The second sizing field is that of the front, so that the field matches the
 * tops of the layers. */
static vg_status mesh_layers(struct vg_run *r, const struct vg_problem *p,
                             struct vg_layer_stage *layers,
                             struct vg_display *show, struct vg_error *err)
{
  struct vg_sizing *sizing = NULL;
  struct vg_mesh front;
  struct vg_team *team;
  vg_status st = vg_team_open(r->comm, &team, err);

  if (st < 0) return st;
  if (vg_run_leads_node(r))
    st = grow_layers(r, p, layers, team, show, &sizing, err);
  VG_TRY(vg_run_share_with_node(r, st, &layers->layers, show, &sizing, err));
  front = vg_front_mesh(&layers->layers.front, &p->boundary.surface);
  VG_TRY(vg_run_agree(r->comm, &p->boundary.surface, &layers->layers, sizing,
                      r->options.change, err));
  VG_TRY(vg_run_verify_front(r, p, &front, err));
  VG_TRY(find_ineffective_sources(r, p, &front, sizing, err));
  VG_TRY(fill(r, p, &layers->layers, &front, sizing, show, err));
  VG_TRY(stop_here(r, show, err));
  VG_TRY(relax_tops(r, p, layers, err));
  VG_TRY(stop_here(r, show, err));
  st = vg_layer_slices_open(&p->boundary.surface, &layers->layers,
                            vg_partition_slices(r->field),
                            (enum vg_layer_cells)p->resolved.settings.cells,
                            r->rank, r->size, r->threads, &r->slices,
                            &r->layers, &layers->join, err);
  VG_TRY(vg_comm_agree(r->comm, st, err));
  VG_TRY(share_layers(r, err));
  VG_TRY(vg_run_sort_zones(r, p, err));
  VG_TRY(vg_run_judge(r, p, &layers->layers, sizing, show, err));
  st = measure_tops(r, p, layers, err);
done:
  vg_sizing_free(sizing);
  return st;
}

/* Solver partitions of the mesh that is about to be written. */
static vg_status part_for_solver(struct vg_run *r, const struct vg_problem *p,
                                 struct vg_display *show, struct vg_error *err)
{
  struct vg_solver_options o = vg_options_solver(&p->resolved.settings);
  double t = vg_display_now();
  vg_status st;

  if (!o.n_part) return VG_OK;
  vg_display_update(show, "solver partition", vg_run_cells(r), 0);
  o.threads = r->threads;
  st = vg_solver_part_slices(r->comm, &r->slices, &o, &r->parted, &r->parts,
                             &r->solver, err);
  r->time_parts = vg_display_now() - t;
  return st;
}

const struct vg_slices *vg_run_slices(const struct vg_run *r)
{
  return r->parts ? &r->parted : &r->slices;
}

vg_status vg_run_mesh(struct vg_run *r, const struct vg_problem *p,
                      struct vg_layer_stage *layers, struct vg_display *show,
                      struct vg_error *err)
{
  vg_status st;

  r->threads = p->resolved.settings.threads ? (int)p->resolved.settings.threads
                                            : vg_comm_default_threads(r->comm);
  r->pictures.is_on = r->outputs && p->resolved.settings.report_html;
  st = p->read.is_section ? vg_run_section(r, p, layers, show, err)
     : layers->is_on      ? mesh_layers(r, p, layers, show, err)
                          : mesh_plain(r, p, show, err);
  return st < 0 ? st : part_for_solver(r, p, show, err);
}

void vg_run_release(struct vg_run *r, int success)
{
  vg_solver_slices_close(r->parts);
  vg_run_pictures_release(&r->pictures);
  vg_zone_slices_close(r->zones);
  free(r->zone_report);
  free(r->zone_limit);
  vg_layer_slices_close(r->layers);
  vg_section_mesh_release(&r->section);
  vg_mesh_release(&r->parted_boundary);
  free(r->sheets);
  vg_partition_free(r->field);
  vg_effects_release(&r->effects);
  free(r->probe);
  vg_spans_release(&r->spans);
  vg_store_close(r->store, success && !r->options.keep);
}
