/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Meshing: vanguard_mesh of api/vanguard.h. */
#define _GNU_SOURCE
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/job.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "run/common/text.h"
#include "run/input/sizes.h"
#include "run/report/report.h"
#include "run/settings/plan_options.h"

void vg_job_release_run(vanguard_job *job, int success)
{
  vg_job_take_back(job);
  vg_run_release(&job->run, success);
  memset(&job->run, 0, sizeof job->run);
  vg_layer_stage_release(&job->layers);
  memset(&job->layers, 0, sizeof job->layers);
  vg_problem_release(&job->problem);
  job->problem = (struct vg_problem)VG_PROBLEM_INIT;
  vg_size_samples_free(job->samples);
  job->samples = NULL;
  vg_size_mesh_free(job->metrics);
  job->metrics = NULL;
  free(job->wall_point);
  job->wall_point = NULL;
  free(job->details);
  job->details = NULL;
  vg_file_mesh_release(&job->file);
  free(job->report);
  job->report = NULL;
  memset(&job->failure, 0, sizeof job->failure);
  memset(&job->times, 0, sizeof job->times);
  job->is_meshed = 0;
}

void vanguard_cancel(vanguard_job *job)
{
  if (job) atomic_store(&job->show.asked, 1);
}

static int tell(void *user, const char *stage, size_t done, size_t expected)
{
  vanguard_job *job = user;

  return job->progress &&
         job->progress(job->progress_user, stage, done, expected);
}

static double size_at(void *user, const double x[3])
{
  const vanguard_job *job = user;

  return job->size(job->size_user, x);
}

static void metric_at(void *user, const double x[3], double m[6])
{
  const vanguard_job *job = user;

  job->metric(job->size_user, x, m);
}

/* Pass the caller's sizes to the run. */
static vg_status use_sizes(vanguard_job *job)
{
  struct vg_problem *p = &job->problem;
  vg_status st = VG_OK;

  if (job->size || job->metric) {
    job->map = (struct vg_size_map){ .at = job->size ? size_at : NULL,
                                     .metric = job->metric ? metric_at : NULL,
                                     .user = job };
    p->read.map = &job->map;
  } else if (job->metric_of) {
    st = vg_size_mesh_new(&job->background, (const double(*)[6])job->metric_of,
                          vg_options_growth(&p->asked), &job->metrics,
                          &job->err);
    if (st < 0) return st;
    p->read.map = vg_size_mesh_map(job->metrics);
    vg_note(&p->notes, "metrics at %zu points were given",
            job->background.n_point);
    vg_note_aspects(&p->notes, job->background.n_point,
                    (const double(*)[6])job->metric_of, p->asked.aspect_max);
  } else if (job->n_size) {
    st = vg_size_samples_new(job->n_size, (const double(*)[3])job->size_at,
                             job->size_of, vg_options_growth(&p->asked),
                             (int)p->asked.threads, &job->samples, &job->err);
    if (st >= 0) p->read.map = vg_size_samples_map(job->samples);
  }
  return st;
}

/* Collect the input on this rank: settings, file names and sizes. A surface
 * given in memory is copied. */
static vg_status take_input(vanguard_job *job, struct vg_mesh *copy)
{
  struct vg_problem *p = &job->problem;
  vg_status st;

  VG_TRY(vg_settings_copy(&p->asked, &job->settings, &job->err));
  VG_TRY(vg_settings_check(&p->asked, &job->err));
  VG_TRY(use_sizes(job));
  if (job->project)
    VG_TRY(vg_input_find(job->project, job->deck, &p->read.files, &job->err));
  else if (job->surface.n_tri)
    st = vg_mesh_copy(copy, &job->surface, &job->err);
  else
    st = vg_fail(&job->err, VG_ERR_USAGE,
                 "no surface: call vanguard_open or "
                 "vanguard_surface before vanguard_mesh");
  if (st >= 0 && job->project) st = vg_problem_refuse_section(p, &job->err);
done:
  return st;
}

static vg_status read_input(vanguard_job *job)
{
  struct vg_problem *p = &job->problem;
  struct vg_mesh copy = VG_MESH_INIT;
  vg_status st = vg_comm_agree(job->comm, take_input(job, &copy), &job->err);

  if (st >= 0 && job->project)
    return vg_problem_read(p, job->comm, &job->show, &job->err);
  if (st >= 0) st = vg_problem_given(p, job->name, &copy, &job->err);
  vg_mesh_release(&copy);
  if (st >= 0) st = vg_display_stopped(&job->show, &job->err);
  return vg_comm_agree(job->comm, st, &job->err);
}

/* Store the report on the surface for vanguard_details, whether or not meshing
 * has succeeded. A run that failed before the surface was checked has none. */
static void describe_surface(vanguard_job *job)
{
  const struct vg_problem *p = &job->problem;
  const struct vg_mesh *m = vg_problem_surface(p);
  size_t size;
  FILE *to;

  if (!p->boundary.read || !m->n_tri || vg_comm_node_rank(job->comm)) return;
  to = vg_text_open(&job->details, &size);
  if (!to) return;
  vg_report_surface_text(to, m, &p->boundary.check, p->read.unit,
                         vg_boundary_is_stretched(&p->boundary),
                         VG_SHOWN_DEFECTS);
  fclose(to);
}

/* The surface without a farfield or symmetry plane, as vanguard surface makes
 * it. */
static vg_status make_surface(vanguard_job *job)
{
  struct vg_problem *p = &job->problem;
  const struct vg_shape_options o = { .threads = (int)p->asked.threads,
                                      .remesh_open = 1 };
  vg_status st;

  if (job->run.size > 1)
    return vg_fail(&job->err, VG_ERR_UNSUPPORTED,
                   "a job with %d ranks cannot make a surface alone: use a job "
                   "of one process",
                   job->run.size);
  VG_TRY(vg_boundary_shape(&p->read, &o, &job->show, &p->boundary, &job->err));
  VG_TRY(vg_boundary_check(&p->boundary, &job->show, &job->err));
  VG_TRY(vg_boundary_finish_conditions(&p->boundary, &job->err));
  vg_problem_note_unused(p, 0, VG_USE_JUDGED_SURFACE);
done:
  return st;
}

static vg_status make_mesh(vanguard_job *job)
{
  struct vg_run *r = &job->run;
  struct vg_problem *p = &job->problem;
  struct vg_mesh front;
  vg_status st;

  VG_TRY(vg_run_mesh(r, p, &job->layers, &job->show, &job->err));
  front = vg_layer_stage_front(&job->layers, &p->boundary.surface);
  vg_effects_note(&r->effects, &front, &p->resolved.settings, &p->notes);
  vg_problem_note_unused(p, job->layers.is_on, VG_USE_JUDGED_MESH);
  if (!r->rank)
    vg_report_layers_note(&job->layers, &p->boundary.surface, &p->notes);
  st = vg_run_memory(r, &job->err);
done:
  return st;
}

static vg_status make_forecast(vanguard_job *job, struct vg_plan *plan)
{
  vg_status st = vg_plan_make(plan, &job->err);

  if (st >= 0)
    st = vg_boundary_finish_conditions(&job->problem.boundary, &job->err);
  return st;
}

/* The surface of a run and, with a plan, the forecast. */
static vg_status make_boundary(vanguard_job *job, enum vg_job_goal goal,
                               struct vg_plan *plan)
{
  switch (goal) {
  case VG_JOB_SURFACE: return make_surface(job);
  case VG_JOB_FORECAST: return make_forecast(job, plan);
  default:
    return vg_run_surface(&job->run, &job->problem, &job->layers, &job->show,
                          &job->err);
  }
}

static vg_status make(vanguard_job *job, enum vg_job_goal goal,
                      struct vg_plan *plan)
{
  double t = vg_display_now();
  vg_status st;

  if (plan) vg_plan_begin(plan);
  vg_display_update(&job->show, "read", 0, 0);
  VG_TRY(read_input(job));
  job->times.read = vg_display_now() - t;
  t = vg_display_now();
  st = make_boundary(job, goal, plan);
  job->times.check = vg_display_now() - t;
  if (st >= 0 && goal == VG_JOB_MESH) st = make_mesh(job);
done:
  return st;
}

void vg_job_begin(vanguard_job *job, vanguard_progress *progress, void *user)
{
  struct vg_run *r = &job->run;

  vg_job_release_run(job, 1);
  job->progress = progress;
  job->progress_user = user;
  memset(&job->show, 0, sizeof job->show);
  job->show.quiet = 1;
  job->show.tell = tell;
  job->show.user = job;
  job->times.start = vg_display_now();
  r->comm = job->comm;
  r->rank = vg_comm_rank(job->comm);
  r->size = vg_comm_size(job->comm);
  r->options.change = VG_AGREE_NOTHING;
}

vg_status vg_job_run(vanguard_job *job, enum vg_job_goal goal,
                     struct vg_plan *plan, vanguard_progress *progress,
                     void *user)
{
  vg_status st = vg_job_usable(job);
  void *before; /* the helpers of this thread: a callback of another job may
                   have called us */

  if (st < 0) return st;
  assert((goal == VG_JOB_FORECAST) == (plan != NULL));
  vg_print_forget();
  vg_job_begin(job, progress, user);
  before = vg_thread_data();
  st = make(job, goal, plan);
  vg_thread_data_set(before);
  describe_surface(job);
  if (st < 0) job->failure = job->err;
  job->times.total = vg_display_now() - job->times.start;
  job->is_meshed = st >= 0 && goal == VG_JOB_MESH;
  return st;
}

vanguard_status vanguard_mesh(vanguard_job *job, vanguard_progress *progress,
                              void *user)
{
  VG_JOB_CALL(job);
  return vg_job_status(vg_job_run(job, VG_JOB_MESH, NULL, progress, user));
}

vanguard_status vanguard_check(vanguard_job *job, vanguard_progress *progress,
                               void *user)
{
  VG_JOB_CALL(job);
  return vg_job_status(vg_job_run(job, VG_JOB_BOUNDARY, NULL, progress, user));
}

vanguard_status vanguard_make_surface(vanguard_job *job,
                                      vanguard_progress *progress, void *user)
{
  VG_JOB_CALL(job);
  return vg_job_status(vg_job_run(job, VG_JOB_SURFACE, NULL, progress, user));
}
