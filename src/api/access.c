/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Access to a finished mesh: the last part of api/vanguard.h. */
#include <stdlib.h>
#include <string.h>

#include "api/job.h"
#include "base/helper/helper.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "core/mesh/zones.h"

vg_status vg_job_meshed(vanguard_job *job)
{
  if (job->is_refused) return VG_ERR_USAGE;
  if (job->is_meshed) return VG_OK;
  return vg_fail(&job->err, VG_ERR_USAGE,
                 "there is no mesh: vanguard_mesh has "
                 "not been called, or has failed");
}

const char *vanguard_details(const vanguard_job *job)
{
  VG_JOB_ASK(job, "");
  return job->details ? job->details : "";
}

const char *vanguard_note(const vanguard_job *job, size_t i)
{
  VG_JOB_ASK(job, NULL);
  const struct vg_notes *notes = &job->problem.notes;

  return i < notes->n ? notes->text[i] : NULL;
}

vanguard_status vanguard_count(vanguard_job *job, struct vanguard_counts *out)
{
  VG_JOB_CALL(job);
  const struct vg_slices *s = &job->run.slices;
  struct vanguard_counts n = { .struct_size = sizeof n };
  vg_status st = vg_job_meshed(job);

  if (st < 0) return vg_job_status(st);
  n.n_point = s->n_point;
  n.n_tet = s->n_cell[VG_SLICE_TET];
  n.n_pyr = s->n_cell[VG_SLICE_PYR];
  n.n_pri = s->n_cell[VG_SLICE_PRI];
  n.n_tri = s->boundary->n_tri;
  n.n_quad = s->boundary->n_quad;
  n.n_boundary_point = s->n_boundary_point;
  n.n_layer_point = job->layers.is_on ? s->n_layer_point : 0;
  n.n_layer_tet = s->n_layer_cell[VG_SLICE_TET];
  n.n_layer_pyr = s->n_layer_cell[VG_SLICE_PYR];
  n.n_layer_pri = s->n_layer_cell[VG_SLICE_PRI];
  n.n_patch = s->boundary->n_patch;
  n.n_hex = s->n_cell[VG_SLICE_HEX];
  n.n_layer_hex = s->n_layer_cell[VG_SLICE_HEX];
  n.n_sheet_tri = s->boundary->n_sheet_tri;
  n.n_sheet = s->boundary->n_sheet;
  n.n_zone = s->boundary->n_zone;
  return vg_job_status(vg_job_give(job, out, &n, sizeof n));
}

vg_status vg_job_give_patch(vanguard_job *job, const struct vg_mesh *m,
                            size_t i, struct vanguard_patch *out)
{
  struct vanguard_patch p = { .struct_size = sizeof p };

  if (i >= m->n_patch)
    return vg_fail(&job->err, VG_ERR_USAGE,
                   "there is no patch %zu: there are %zu, numbered from 0", i,
                   m->n_patch);
  p.id = m->patch[i].id;
  p.bc = m->patch[i].bc;
  p.bc_fun3d = m->patch[i].bc_fun3d;
  p.name = m->patch[i].name;
  return vg_job_give(job, out, &p, sizeof p);
}

vanguard_status vanguard_patch(vanguard_job *job, size_t i,
                               struct vanguard_patch *out)
{
  VG_JOB_CALL(job);
  vg_status st = vg_job_meshed(job);

  if (st >= 0) st = vg_job_give_patch(job, job->run.slices.boundary, i, out);
  return vg_job_status(st);
}

static const struct vg_mesh *boundary_of(const vanguard_job *job)
{
  static const struct vg_mesh none = VG_MESH_INIT;

  return job->is_meshed ? job->run.slices.boundary : &none;
}

const uint32_t *vanguard_triangles(const vanguard_job *job)
{
  VG_JOB_ASK(job, NULL);
  return (const uint32_t *)boundary_of(job)->tri;
}

const uint32_t *vanguard_triangle_patches(const vanguard_job *job)
{
  VG_JOB_ASK(job, NULL);
  return boundary_of(job)->tri_patch;
}

const uint32_t *vanguard_quads(const vanguard_job *job)
{
  VG_JOB_ASK(job, NULL);
  return (const uint32_t *)boundary_of(job)->quad;
}

const uint32_t *vanguard_quad_patches(const vanguard_job *job)
{
  VG_JOB_ASK(job, NULL);
  return boundary_of(job)->quad_patch;
}

vanguard_status vanguard_sheet(vanguard_job *job, size_t i,
                               struct vanguard_patch *out)
{
  VG_JOB_CALL(job);
  struct vg_mesh sheets = VG_MESH_INIT;
  vg_status st = vg_job_meshed(job);

  if (st < 0) return vg_job_status(st);
  sheets.n_patch = job->run.slices.boundary->n_sheet;
  sheets.patch = job->run.slices.boundary->sheet;
  return vg_job_status(vg_job_give_patch(job, &sheets, i, out));
}

const uint32_t *vanguard_sheet_triangles(const vanguard_job *job)
{
  VG_JOB_ASK(job, NULL);
  return (const uint32_t *)boundary_of(job)->sheet_tri;
}

const uint32_t *vanguard_sheet_numbers(const vanguard_job *job)
{
  VG_JOB_ASK(job, NULL);
  return boundary_of(job)->sheet_of;
}

vanguard_status vanguard_zone(vanguard_job *job, size_t i,
                              struct vanguard_zone *out)
{
  VG_JOB_CALL(job);
  struct vanguard_zone z = { .struct_size = sizeof z };
  vg_status st = vg_job_meshed(job);
  const struct vg_mesh *m;

  if (st < 0) return vg_job_status(st);
  m = job->run.slices.boundary;
  if (i >= m->n_zone)
    return vg_job_status(vg_fail(&job->err, VG_ERR_USAGE,
                                 "zone %zu was asked for; the mesh has %zu", i,
                                 m->n_zone));
  z.id = m->zone[i].id;
  z.name = m->zone[i].name;
  z.kind = vg_zone_kind_word[m->zone[i].kind];
  z.n_tet = m->zone[i].n_cell[VG_SLICE_TET];
  z.n_pyr = m->zone[i].n_cell[VG_SLICE_PYR];
  z.n_pri = m->zone[i].n_cell[VG_SLICE_PRI];
  z.n_hex = m->zone[i].n_cell[VG_SLICE_HEX];
  return vg_job_status(vg_job_give(job, out, &z, sizeof z));
}

/* --- figures ------------------------------------------------------------- */

vanguard_status vanguard_measure(vanguard_job *job,
                                 struct vanguard_quality *out)
{
  VG_JOB_CALL(job);
  const struct vg_mesh_report *field = job->run.layers ? &job->run.field_judge
                                                       : &job->run.judge;
  struct vanguard_quality q = { .struct_size = sizeof q };
  vg_status st = vg_job_meshed(job);

  if (st < 0) return vg_job_status(st);
  q.volume = job->run.judge.volume;
  q.angle_min = field->angle_min;
  q.angle_max = field->angle_max;
  q.angle_min_p1 = field->angle_min_p1;
  q.radius_ratio_min = field->radius_ratio_min;
  q.radius_ratio_mean = field->radius_ratio_mean;
  q.volume_ratio_p95 = field->volume_ratio[1];
  q.volume_ratio_max = field->volume_ratio[2];
  q.edge_within = field->edge_within;
  q.is_valid = job->run.judge.is_valid;
  return vg_job_status(vg_job_give(job, out, &q, sizeof q));
}

static size_t n_walls(const vanguard_job *job)
{
  return job->is_meshed && !job->run.rank ? job->layers.n_wall : 0;
}

size_t vanguard_walls(const vanguard_job *job)
{
  VG_JOB_ASK(job, 0);
  return n_walls(job);
}

static void put_range(double to[3], const struct vg_range *r)
{
  to[0] = r->min;
  to[1] = r->mean;
  to[2] = r->max;
}

vanguard_status vanguard_wall(vanguard_job *job, size_t i,
                              struct vanguard_wall *out)
{
  VG_JOB_CALL(job);
  struct vanguard_wall w = { .struct_size = sizeof w };
  const struct vg_patch_layers *from;
  vg_status st = vg_job_meshed(job);

  if (st >= 0 && (!n_walls(job) || i > job->layers.n_wall))
    st = vg_fail(&job->err, VG_ERR_USAGE,
                 "there is no wall %zu: this rank has %zu", i, n_walls(job));
  if (st < 0) return vg_job_status(st);
  from = i < job->layers.n_wall ? &job->layers.wall[i] : &job->layers.all;
  w.patch = i < job->layers.n_wall ? from->patch : SIZE_MAX;
  w.n_face = from->n_face;
  w.n_point = from->n_point;
  w.full = from->full;
  w.any = from->any;
  put_range(w.first, &from->first);
  put_range(w.asked, &from->asked);
  put_range(w.level, &from->level);
  put_range(w.total, &from->total);
  put_range(w.growth, &from->growth);
  put_range(w.y_plus, &from->y_plus);
  w.share = from->share_mean;
  w.first_error = from->first_error;
  memcpy(w.top_ratio, from->top_ratio, sizeof w.top_ratio);
  return vg_job_status(vg_job_give(job, out, &w, sizeof w));
}

/* Numbers of the wall points in the mesh; NULL if there is not enough
 * memory. */
static const uint32_t *wall_points(vanguard_job *job)
{
  const struct vg_wall_fields *w = &job->layers.fields;
  const uint32_t *root = vg_layer_slices_roots(job->run.layers);

  if (job->wall_point) return job->wall_point;
  job->wall_point = vg_alloc(w->n, sizeof *job->wall_point);
  for (size_t i = 0; job->wall_point && i < w->n; i++)
    job->wall_point[i] = root[w->point[i]];
  return job->wall_point;
}

vanguard_status vanguard_wall_points(vanguard_job *job,
                                     struct vanguard_wall_points *out)
{
  VG_JOB_CALL(job);
  struct vanguard_wall_points p = { .struct_size = sizeof p };
  const struct vg_wall_fields *w = &job->layers.fields;
  vg_status st = vg_job_meshed(job);

  if (st >= 0 && n_walls(job)) {
    p.n_point = w->n;
    p.point = wall_points(job);
    p.level = w->level;
    p.wanted = w->wanted;
    p.first = w->first;
    p.asked = w->asked;
    p.total = w->total;
    p.share = w->share;
    p.growth = w->growth;
    p.cause = w->cause;
    p.compressed = w->compressed;
    if (!p.point) st = vg_fail_memory(&job->err, "the points of the walls");
  }
  if (st < 0) return vg_job_status(st);
  return vg_job_status(vg_job_give(job, out, &p, sizeof p));
}

const char *vanguard_cause(int32_t cause)
{
  return cause >= 0 && cause < VG_CAUSE_N
         ? vg_layer_cause_name((enum vg_layer_cause)cause)
         : NULL;
}

/* --- files --------------------------------------------------------------- */

/* Plan the output files: the stem and the forms are those of the caller, all
 * other settings those of the run. */
static vg_status plan_files(vanguard_job *job, const char *stem,
                            const char *forms, struct vg_outputs *o)
{
  /* shares the tables of `asked`; must not be released */
  struct vg_settings view = job->problem.asked;
  size_t n = forms ? strlen(forms) : 0;
  char list[VG_WRITE_MAX];

  if (n >= sizeof view.write)
    return vg_fail(&job->err, VG_ERR_INPUT,
                   "the list of forms has %zu characters; the limit is %zu", n,
                   sizeof view.write - 1);
  if (forms) memcpy(view.write, forms, n + 1);
  vg_resolve_write(&view, list);
  return vg_outputs_plan(&job->problem, stem, NULL, list, o, &job->err);
}

/* The slices of the mesh, for as long as nobody calls vanguard_cancel. */
static vg_status get_unless_stopped(const struct vg_slices *s, size_t i,
                                    struct vg_slice *out, struct vg_error *err)
{
  vanguard_job *job = s->user;
  const struct vg_slices *mesh = &job->run.slices;
  vg_status st = vg_display_stopped(&job->show, err);

  return st < 0 ? st : mesh->get(mesh, i, out, err);
}

static void put_slice(const struct vg_slices *s, struct vg_slice *slice)
{
  const vanguard_job *job = s->user;

  job->run.slices.put(&job->run.slices, slice);
}

static vg_status put_files(vanguard_job *job, struct vg_outputs *o)
{
  struct vg_run *r = &job->run;
  struct vg_slices mesh = r->slices;
  vg_status st;

  mesh.get = get_unless_stopped;
  mesh.put = put_slice;
  mesh.user = job;

  VG_TRY(vg_outputs_check(&job->problem, o, &job->err));
  VG_TRY(vg_outputs_open(o, &job->problem, r->comm, &mesh, &job->err));
  st = o->n_open
       ? vg_slices_each(&mesh, r->threads, vg_outputs_put, o, &job->err)
       : VG_OK;
  VG_TRY(vg_outputs_close(o, st, &job->err));
  VG_TRY(vg_outputs_mesh(o, &job->problem, &job->layers, r->comm, &mesh,
                         r->threads, &job->err));
  st = vg_comm_agree(r->comm, vg_display_stopped(&job->show, &job->err),
                     &job->err);
  if (st >= 0 && !r->rank) st = vg_outputs_commit(o, &job->err);
done:
  return st;
}

vanguard_status vanguard_write(vanguard_job *job, const char *stem,
                               const char *forms)
{
  VG_JOB_CALL(job);
  struct vg_outputs o = VG_OUTPUTS_INIT;
  vg_status st = vg_job_meshed(job);

  if (st >= 0) st = vg_job_needs(job, stem, "stem");
  if (st >= 0 && job->file.identity)
    st = vg_fail(&job->err, VG_ERR_USAGE,
                 "the mesh was read from a file: vanguard_write writes meshes "
                 "of vanguard_mesh only");
  if (st < 0) return vg_job_status(st);
  atomic_store(&job->show.asked, 0);
  st = plan_files(job, stem, forms, &o);
  if (st >= 0 && !job->run.rank)
    st = vg_outputs_claim(&o, &job->problem.notes, &job->err);
  st = vg_comm_agree(job->comm, st, &job->err);
  if (st >= 0) {
    void *before = vg_thread_data();

    vg_helper_set_folder(job->problem.asked.helpers);
    st = vg_comm_agree(job->comm, put_files(job, &o), &job->err);
    vg_thread_data_set(before);
  }
  vg_outputs_release(&o);
  return vg_job_status(st);
}
