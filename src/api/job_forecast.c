/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The forecast of a run: vanguard_forecast of api/vanguard.h. */
#include "api/job.h"
#include "base/parallel.h"
#include "run/common/free_memory.h"

static vg_status check_ranks(vanguard_job *job, int ranks, int threads,
                             struct vanguard_forecast *out)
{
  vg_status st = vg_job_usable(job);

  if (st >= 0) st = vg_job_give(job, out, out, sizeof out->struct_size);
  if (st < 0) return st;
  if (ranks < 1 || threads < 0 ||
      (int64_t)ranks * (threads ? threads : 1) > VG_MODEL_WORKERS_MAX)
    return vg_fail(&job->err, VG_ERR_INPUT,
                   "a forecast for %d ranks with %d threads each: there must "
                   "be 1 to %d ranks with all their threads, and 0 threads are "
                   "those of the setting \"threads\"",
                   ranks, threads, VG_MODEL_WORKERS_MAX);
  if (vg_comm_size(job->comm) > 1)
    return vg_fail(&job->err, VG_ERR_UNSUPPORTED,
                   "a job with %d ranks cannot make a forecast: use a job of "
                   "one process, also for the forecast of several ranks",
                   vg_comm_size(job->comm));
  return VG_OK;
}

static enum vg_memory_stage peak_stage(const struct vg_plan_row *r)
{
  int most = 0;

  for (int i = 1; i < VG_MEMORY_STAGES; i++)
    if (r->stage[i] > r->stage[most]) most = i;
  return (enum vg_memory_stage)most;
}

static struct vanguard_forecast result_of(const struct vg_plan *p)
{
  const struct vg_plan_row *r = p->row;

  return (struct vanguard_forecast){
    .struct_size = sizeof(struct vanguard_forecast),
    .ranks = r->ranks,
    .threads = r->threads,
    .n_cell = p->cell,
    .n_tet = p->tet,
    .n_pri = p->prism,
    .n_point = p->point,
    .n_layer_cell = p->prism > 0 ? p->prism : p->layer_tet,
    .n_layer_point = p->layer_point,
    .n_wall_point = (double)p->n_wall_point,
    .has_grown_layers = p->is_grown,
    .n_subdomain = p->forecast.n_leaf,
    .seconds = r->wall,
    .work = r->wall * r->speedup,
    .memory = r->memory,
    .memory_surface = r->stage[VG_MEMORY_SURFACE],
    .memory_sizes = r->stage[VG_MEMORY_SIZES],
    .memory_fill = r->stage[VG_MEMORY_FILL],
    .memory_check = r->stage[VG_MEMORY_CHECK],
    .memory_shared = p->shared,
    .peak_stage = vg_memory_stage_name(peak_stage(r)),
    .bytes_written = vg_plan_bytes_all(p)
  };
}

static vg_status forecast(vanguard_job *job, int ranks, int threads,
                          vanguard_progress *progress, void *user,
                          struct vanguard_forecast *to)
{
  const int own = (int)job->settings.threads;
  int64_t n_rank = ranks;
  int64_t n_thread = threads ? threads : own ? own : vg_cores();
  double heap;
  const struct vg_plan_request request = { .ranks = { 1, 0, &n_rank },
                                           .threads = { 1, 0, &n_thread },
                                           .machine = VG_MACHINE_INIT,
                                           .serial = -1,
                                           .program = vg_used_memory(&heap),
                                           .workers = own,
                                           .no_leaves = 1 };
  struct vg_plan plan = { .o = &request,
                          .problem = &job->problem,
                          .layers = &job->layers,
                          .show = &job->show };
  vg_status st = vg_job_run(job, VG_JOB_FORECAST, &plan, progress, user);

  if (st >= 0) *to = result_of(&plan);
  vg_plan_release(&plan);
  return st;
}

vanguard_status vanguard_forecast(vanguard_job *job, int ranks, int threads,
                                  vanguard_progress *progress, void *user,
                                  struct vanguard_forecast *out)
{
  VG_JOB_CALL(job);
  struct vanguard_forecast made;
  vg_status st = check_ranks(job, ranks, threads, out);

  if (st >= 0) st = forecast(job, ranks, threads, progress, user, &made);
  if (st >= 0) st = vg_job_give(job, out, &made, sizeof made);
  return vg_job_status(st);
}
