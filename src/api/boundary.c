/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The surface of a run, and the report: a part of api/vanguard.h. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>

#include "api/job.h"
#include "base/helper/helper.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "run/common/json_build.h"
#include "run/common/text.h"
#include "run/report/report.h"

/* --- the surface --------------------------------------------------------- */

/* The surface exists once it has been checked, also if it was refused. */
static vg_status checked(vanguard_job *job)
{
  const struct vg_boundary *b = &job->problem.boundary;

  if (job->is_refused) return VG_ERR_USAGE;
  if (b->read && b->check.face_kinds) return VG_OK;
  return vg_fail(&job->err, VG_ERR_USAGE,
                 "there is no surface: vanguard_check, vanguard_forecast, "
                 "vanguard_make_surface or vanguard_mesh has not been called, "
                 "has failed before the surface was checked, or this is not "
                 "the first rank of its node");
}

vanguard_status vanguard_boundary(vanguard_job *job,
                                  struct vanguard_boundary *out)
{
  VG_JOB_CALL(job);
  static const char *const flow[] = { "unknown", "external", "internal" };
  const struct vg_boundary *b = &job->problem.boundary;
  struct vanguard_boundary to = { .struct_size = sizeof to };
  vg_status st = checked(job);

  if (st < 0) return vg_job_status(st);
  to.n_point = b->surface.n_point;
  to.n_tri = b->surface.n_tri;
  to.n_patch = b->surface.n_patch;
  to.flow = flow[b->flow.kind];
  to.n_body = b->flow.n_body;
  to.n_outer = b->flow.n_outer;
  to.n_cavity = b->flow.n_cavity;
  to.half_axis = b->flow.axis;
  to.half_at = b->flow.axis < 0 ? 0 : b->flow.at;
  to.is_remeshed = b->remeshing.is_done;
  to.has_farfield = b->domain.added_farfield;
  to.has_symmetry = b->domain.added_symmetry;
  to.n_defect = b->check.n_defect;
  to.n_open_edge = b->check.count[VG_DEFECT_OPEN_EDGE];
  return vg_job_status(vg_job_give(job, out, &to, sizeof to));
}

vanguard_status vanguard_boundary_patch(vanguard_job *job, size_t i,
                                        struct vanguard_patch *out)
{
  VG_JOB_CALL(job);
  vg_status st = checked(job);

  if (st >= 0)
    st = vg_job_give_patch(job, &job->problem.boundary.surface, i, out);
  return vg_job_status(st);
}

vanguard_status vanguard_boundary_arrays(vanguard_job *job, double *xyz,
                                         uint32_t *tri, uint32_t *patch)
{
  VG_JOB_CALL(job);
  const struct vg_mesh *m = &job->problem.boundary.surface;
  vg_status st = checked(job);

  if (st < 0) return vg_job_status(st);
  if (xyz && m->n_point) memcpy(xyz, m->point, m->n_point * sizeof *m->point);
  if (tri && m->n_tri) memcpy(tri, m->tri, m->n_tri * sizeof *m->tri);
  if (patch && m->n_tri)
    memcpy(patch, m->tri_patch, m->n_tri * sizeof *m->tri_patch);
  return VANGUARD_OK;
}

/* --- the report ---------------------------------------------------------- */

/* The report on a mesh that was read, as that of vanguard check. */
static json_t *file_json(const vanguard_job *job)
{
  const struct vg_mesh *m = &job->file.mesh;

  return json_pack("{s:s s:o s:b s:I s:o s:o s:o}", "vanguard", VG_VERSION,
                   "file", vg_text_json(job->problem.asked.title), "ok",
                   job->run.judge.is_valid, "cells_turned",
                   (json_int_t)job->file.n_turned, "size",
                   vg_report_size_json(m), "patches", vg_report_patches_json(m),
                   "mesh", vg_report_mesh_json(&job->run.judge, m));
}

static struct vg_run_report report_of(const vanguard_job *job)
{
  return (struct vg_run_report){ &job->problem, &job->layers,   &job->run,
                                 NULL,          job->is_meshed, job->times };
}

static char *json_report(const vanguard_job *job)
{
  const struct vg_run_report r = report_of(job);
  json_t *o;
  char *text;

  vg_json_forget();
  o = job->file.identity
      ? file_json(job)
      : vg_run_report_json(&r, job->failure.code >= 0, &job->failure);
  text = o ? json_dumps(o, JSON_INDENT(2)) : NULL;
  json_decref(o);
  return text;
}

static char *text_report(const vanguard_job *job)
{
  const struct vg_run_report r = report_of(job);
  char *text = NULL;
  size_t size;
  FILE *to = vg_text_open(&text, &size);
  int bad = !to;

  if (to && job->file.identity) {
    vg_report_size_text(to, &job->file.mesh);
    bad = vg_report_patches_text(to, &job->file.mesh, NULL) < 0;
    vg_report_mesh_text(to, &job->run.judge, 1);
  } else if (to) {
    vg_run_report_text(to, &r);
    if (job->failure.code < 0) fprintf(to, "\n%s\n", job->failure.text);
  }
  if (to && fclose(to)) bad = 1;
  if (!bad) return text;
  free(text);
  return NULL;
}

static vg_status make_report(vanguard_job *job, int is_json)
{
  void *before = vg_thread_data();

  if (job->is_refused) return VG_ERR_USAGE;
  if (!job->times.start)
    return vg_fail(&job->err, VG_ERR_USAGE,
                   "there is no report: none of vanguard_mesh, "
                   "vanguard_check, vanguard_forecast, vanguard_make_surface "
                   "and vanguard_read has been called");
  free(job->report);
  if (job->run.rank) job->report = strdup("");
  else {
    vg_helper_set_folder(job->problem.asked.helpers);
    job->report = is_json ? json_report(job) : text_report(job);
    vg_thread_data_set(before);
  }
  return job->report ? VG_OK : vg_fail_memory(&job->err, "the report");
}

vanguard_status vanguard_report(vanguard_job *job, const char *form,
                                const char **out)
{
  VG_JOB_CALL(job);
  vg_status st = vg_job_needs(job, out, "out");

  if (st >= 0) st = vg_job_needs(job, form, "form");
  if (st >= 0 && strcmp(form, "json") != 0 && strcmp(form, "text") != 0)
    st = vg_fail(&job->err, VG_ERR_INPUT,
                 "there is no report in the form '%s'; the forms are json and "
                 "text",
                 form);
  if (st >= 0) st = make_report(job, !strcmp(form, "json"));
  if (st >= 0) *out = job->report;
  return vg_job_status(st);
}
