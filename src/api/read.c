/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A mesh from a file: vanguard_read of api/vanguard.h. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/job.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "core/judge/quality.h"
#include "io/mesh/format.h"

/* The whole mesh is one slice, whose points have their numbers in the mesh. */
static vg_status get_all(const struct vg_slices *s, size_t i,
                         struct vg_slice *out, struct vg_error *err)
{
  const vanguard_job *job = s->user;
  const struct vg_mesh *m = &job->file;

  (void)i, (void)err;
  memset(out, 0, sizeof *out);
  out->n_point = out->n_own = m->n_point;
  out->x = (const double(*)[3])m->point;
  out->id = out->own = job->identity;
  out->n_cell[VG_SLICE_TET] = m->n_tet;
  out->n_cell[VG_SLICE_PYR] = m->n_pyr;
  out->n_cell[VG_SLICE_PRI] = m->n_pri;
  out->cell[VG_SLICE_TET] = (const uint32_t *)m->tet;
  out->cell[VG_SLICE_PYR] = (const uint32_t *)m->pyr;
  out->cell[VG_SLICE_PRI] = (const uint32_t *)m->pri;
  return VG_OK;
}

static void put_all(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s, (void)slice;
}

/* Number of boundary points if they come first, otherwise 0. */
static size_t leading_boundary(const struct vg_mesh *m, uint8_t *on)
{
  size_t n = 0, end = 0;

  for (size_t i = 0; i < 3 * m->n_tri; i++) on[m->tri[i / 3][i % 3]] = 1;
  for (size_t i = 0; i < 4 * m->n_quad; i++) on[m->quad[i / 4][i % 4]] = 1;
  for (size_t p = 0; p < m->n_point; p++) {
    n += on[p];
    if (on[p]) end = p + 1;
  }
  return n == end ? n : 0;
}

static vg_status serve(vanguard_job *job)
{
  const struct vg_mesh *m = &job->file;
  struct vg_slices *s = &job->run.slices;
  uint8_t *on = vg_calloc(m->n_point, 1);

  job->identity = vg_alloc(m->n_point, sizeof *job->identity);
  if (!on || !job->identity) {
    free(on);
    return vg_fail_memory(&job->err, "the mesh");
  }
  for (size_t p = 0; p < m->n_point; p++) job->identity[p] = (uint32_t)p;
  *s = (struct vg_slices){ .n_point = m->n_point,
                           .n_cell = { m->n_tet, m->n_pyr, m->n_pri },
                           .n_boundary_point = leading_boundary(m, on),
                           .boundary = m,
                           .n_slice = 1,
                           .n_served = m->n_tet + m->n_pyr + m->n_pri,
                           .get = get_all,
                           .put = put_all,
                           .user = job };
  job->run.threads = job->settings.threads ? (int)job->settings.threads
                                           : vg_cores();
  free(on);
  return VG_OK;
}

static vg_status read_file(vanguard_job *job, const char *file)
{
  struct vg_read_info info = { .mapbc = job->settings.mapbc };
  struct vg_notes *notes = &job->problem.notes;
  vg_status st;

  if (job->run.size > 1)
    return vg_fail(&job->err, VG_ERR_UNSUPPORTED,
                   "a job with %d ranks cannot read a mesh: use a job of one "
                   "process",
                   job->run.size);
  snprintf(job->problem.asked.title, sizeof job->problem.asked.title, "%s",
           file);
  VG_TRY(vg_mesh_read(file, &job->file, &info, &job->err));
  if (!info.n_cell) {
    st = vg_fail(&job->err, VG_ERR_INPUT,
                 "%s: this is a surface; vanguard_open and vanguard_check read "
                 "surfaces",
                 file);
    goto done;
  }
  job->turned = info.turned;
  if (info.turned.cell)
    vg_note(notes, "%s: cells of negative volume, mirrored on reading: %zu",
            file, info.turned.cell);
  if (info.turned.face)
    vg_note(notes,
            "%s: %zu boundary faces pointed out of their cells; their "
            "orientation was reversed",
            file, info.turned.face);
  VG_TRY(serve(job));
  st = vg_mesh_judge(&job->file, NULL, &job->run.judge, &job->err);
done:
  return st;
}

vanguard_status vanguard_read(vanguard_job *job, const char *file)
{
  VG_JOB_CALL(job);
  vg_status st = vg_job_needs(job, file, "file");

  if (st < 0) return vg_job_status(st);
  vg_job_begin(job, NULL, NULL);
  st = read_file(job, file);
  if (st < 0) {
    vg_job_release_run(job, 1);
    return vg_job_status(st);
  }
  job->is_meshed = 1;
  return VANGUARD_OK;
}
