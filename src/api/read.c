/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A mesh from a file: vanguard_read of api/vanguard.h. */
#include <stdio.h>

#include "api/job.h"
#include "base/parallel.h"

static vg_status read_file(vanguard_job *job, const char *file)
{
  struct vg_problem *p = &job->problem;
  struct vg_run *r = &job->run;
  vg_status st;

  if (r->size > 1)
    return vg_fail(&job->err, VG_ERR_UNSUPPORTED,
                   "a job with %d ranks cannot read a mesh: use a job of one "
                   "process",
                   r->size);
  snprintf(p->asked.title, sizeof p->asked.title, "%s", file);
  st = vg_file_mesh_read(file, job->settings.mapbc, &job->file, &p->notes,
                         &job->err);
  if (st < 0) return st;
  r->slices = job->file.slices;
  r->judge = job->file.judge;
  r->threads = job->settings.threads ? (int)job->settings.threads : vg_cores();
  return VG_OK;
}

vanguard_status vanguard_read(vanguard_job *job, const char *file)
{
  VG_JOB_CALL(job);
  vg_status st = vg_job_needs(job, file, "file");

  if (st < 0) return vg_job_status(st);
  vg_job_begin(job, NULL, NULL);
  st = read_file(job, file);
  if (st < 0) vg_job_release_run(job, 1);
  job->is_meshed = st >= 0;
  return vg_job_status(st);
}
