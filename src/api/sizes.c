/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The caller's sizes: the part of api/vanguard.h before vanguard_mesh. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "api/job.h"
#include "base/memory.h"

void vg_job_forget_sizes(vanguard_job *job)
{
  free(job->size_at);
  free(job->size_of);
  free(job->metric_of);
  vg_mesh_release(&job->background);
  job->size_at = NULL;
  job->size_of = NULL;
  job->metric_of = NULL;
  job->n_size = 0;
  job->size = NULL;
  job->metric = NULL;
}

/* Forget the previous sizes of a job and use the given function. The other one
 * is NULL; both are NULL to use none. */
static vanguard_status use_function(vanguard_job *job,
                                    vanguard_size_function *size,
                                    vanguard_metric_function *metric,
                                    void *user)
{
  VG_JOB_CALL(job);
  vg_status st = vg_job_usable(job);

  assert(!size || !metric);
  if (st < 0) return vg_job_status(st);
  vg_job_forget_sizes(job);
  job->size = size;
  job->metric = metric;
  job->size_user = user;
  return VANGUARD_OK;
}

vanguard_status vanguard_sizes(vanguard_job *job, vanguard_size_function *size,
                               void *user)
{
  return use_function(job, size, NULL, user);
}

vanguard_status vanguard_size_points(vanguard_job *job, size_t n,
                                     const double *xyz, const double *size)
{
  VG_JOB_CALL(job);
  double(*at)[3] = NULL, *of = NULL;
  vg_status st;

  VG_TRY(vg_job_usable(job));
  if (n) VG_TRY(vg_job_needs(job, xyz, "xyz"));
  if (n) VG_TRY(vg_job_needs(job, size, "size"));
  VG_TRY(vg_size_samples_check("size_points", n, (const double(*)[3])xyz, size,
                               &job->err));
  at = vg_alloc(n, sizeof *at);
  of = vg_alloc(n, sizeof *of);
  if (!at || !of) {
    st = vg_fail_memory(&job->err, "the target edge lengths at points");
    goto done;
  }
  if (n) memcpy(at, xyz, n * sizeof *at);
  if (n) memcpy(of, size, n * sizeof *of);
  vg_job_forget_sizes(job);
  job->n_size = n;
  job->size_at = at;
  job->size_of = of;
  at = NULL;
  of = NULL;
done:
  free(at);
  free(of);
  return vg_job_status(st);
}

vanguard_status vanguard_metrics(vanguard_job *job,
                                 vanguard_metric_function *metric, void *user)
{
  return use_function(job, NULL, metric, user);
}

static vg_status copy_tets(struct vg_mesh *m, size_t n, const uint32_t *tet,
                           struct vg_error *err)
{
  for (size_t i = 0; i < 4 * n; i++)
    if (tet[i] >= m->n_point)
      return vg_fail(err, VG_ERR_INPUT,
                     "metric_points: tetrahedron %zu has point %u, but there "
                     "are only %zu points, numbered from 0",
                     i / 4 + 1, tet[i], m->n_point);
  m->tet = vg_alloc(n, sizeof *m->tet);
  if (!m->tet) return vg_fail_memory(err, "the metrics at points");
  if (n) memcpy(m->tet, tet, n * sizeof *m->tet);
  m->n_tet = n;
  return VG_OK;
}

vanguard_status vanguard_metric_points(vanguard_job *job, size_t n,
                                       const double *xyz, const double *metric,
                                       size_t n_tet, const uint32_t *tet)
{
  VG_JOB_CALL(job);
  struct vg_mesh m = VG_MESH_INIT;
  double(*of)[6] = NULL;
  vg_status st;

  VG_TRY(vg_job_usable(job));
  if (n) VG_TRY(vg_job_needs(job, xyz, "xyz"));
  if (n) VG_TRY(vg_job_needs(job, metric, "metric"));
  if (n_tet) VG_TRY(vg_job_needs(job, tet, "tet"));
  of = vg_alloc(n, sizeof *of);
  m.point = vg_alloc(n, sizeof *m.point);
  if (!of || !m.point) {
    st = vg_fail_memory(&job->err, "the metrics at points");
    goto done;
  }
  if (n) memcpy(m.point, xyz, n * sizeof *m.point);
  m.n_point = n;
  VG_TRY(vg_size_metrics_read("metric_points", n, (const double(*)[3])m.point,
                              6, VG_TENSOR_UPPER, metric, of, &job->err));
  VG_TRY(copy_tets(&m, n_tet, tet, &job->err));
  vg_job_forget_sizes(job);
  if (n) {
    vg_mesh_move(&job->background, &m);
    job->metric_of = of;
    of = NULL;
  }
done:
  free(of);
  vg_mesh_release(&m);
  return vg_job_status(st);
}
