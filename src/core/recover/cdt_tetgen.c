/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/recover/cdt_tetgen.h"

#include <stdlib.h>
#include <string.h>

#include "base/helper/helper.h"
#include "base/memory.h"

static const uint64_t n_max = 1u << 31; /* TetGen's indices are int */

static const uint32_t ways = 2; /* number of sets of switches to try */

/* The helper limits the work of a job by a count. These limits, in seconds
 * without any message, only end helpers that never answer. */
static const double silence = 6000, silence_per_triangle = 0.5;

static int ask(const struct vg_cdt_job *job, uint32_t way, struct vg_link *to)
{
  const struct vg_helper_message q = { .what = VG_HELPER_RECOVER,
                                       .option = way,
                                       .n = { job->n, job->n_tri } };

  to->silence = silence + silence_per_triangle * (double)job->n_tri;
  return vg_link_put(to, &q, sizeof q) &&
         vg_link_put(to, job->x, job->n * sizeof *job->x) &&
         vg_link_put(to, job->tri, job->n_tri * sizeof *job->tri);
}

static int are_in_range(size_t n_tet, const uint32_t (*tet)[4], size_t n)
{
  for (size_t i = 0; i < n_tet; i++)
    for (int k = 0; k < 4; k++)
      if (tet[i][k] >= n) return 0;
  return 1;
}

int vg_cdt_receive(struct vg_cdt_job *job, struct vg_link *from)
{
  struct vg_helper_message a;
  double(*added)[3] = NULL, (*all)[3] = NULL;
  uint32_t(*tet)[4] = NULL;

  if (!vg_link_get(from, &a, sizeof a) || a.what != VG_HELPER_CELLS ||
      a.n[0] > n_max || a.n[1] > n_max)
    return 0;
  added = vg_link_get_array(from, a.n[0], sizeof *added);
  if (added) tet = vg_link_get_array(from, a.n[1], sizeof *tet);
  if (tet && are_in_range(a.n[1], (const uint32_t(*)[4])tet, job->n + a.n[0]))
    all = vg_alloc(job->n + a.n[0], sizeof *all);
  if (all) {
    memcpy(all, job->x, job->n * sizeof *all);
    if (a.n[0]) memcpy(all + job->n, added, a.n[0] * sizeof *all);
    job->n_all = job->n + a.n[0];
    job->n_tet = a.n[1];
    job->all = all;
    job->tet = tet;
    job->st = VG_OK;
  } else {
    free(tet);
  }
  free(added);
  return all != NULL;
}

/* Start a helper that works through the jobs until one of them ends it. done
 * out: number of jobs that need not be tried again in this way. */
static vg_status run_helper(size_t n_job, struct vg_cdt_job *job, uint32_t way,
                            size_t *done, struct vg_error *err)
{
  struct vg_child c;
  struct vg_link l;
  vg_status st = vg_helper_open(VG_HELPER_TETGEN, NULL, silence, &c, &l, err);

  *done = 0;
  if (st < 0) return st;
  while (*done < n_job && ask(&job[*done], way, &l) &&
         vg_cdt_receive(&job[*done], &l))
    ++*done;
  /* The job is at fault, unless the child ended with its server. */
  if (*done < n_job && (c.pid || vg_child_server_is_alive())) ++*done;
  vg_helper_close(&c);
  return VG_OK;
}

static vg_status prepare(size_t n_job, struct vg_cdt_job *job,
                         struct vg_error *err)
{
  for (size_t k = 0; k < n_job; k++) {
    job[k].st = VG_ERR_GEOMETRY;
    job[k].n_all = job[k].n_tet = 0;
    job[k].all = NULL;
    job[k].tet = NULL;
  }
  for (size_t k = 0; k < n_job; k++)
    if (job[k].n > 100000000 || job[k].n_tri > 200000000)
      return vg_fail(err, VG_ERR_UNSUPPORTED,
                     "boundary recovery of %zu points "
                     "exceeds the range of TetGen's indices",
                     job[k].n);
  return VG_OK;
}

vg_status vg_cdt_tetgen(size_t n_job, struct vg_cdt_job *job,
                        struct vg_error *err)
{
  struct vg_helper h;
  size_t done = 0;
  vg_status st;

  VG_TRY(prepare(n_job, job, err));
  vg_helper_find(VG_HELPER_TETGEN, &h);
  if (!h.is_found) {
    vg_fail(err, VG_ERR_UNSUPPORTED, "%s", h.why);
    st = VG_BLOCKED;
    goto done;
  }
  for (size_t next = 0; next < n_job; next += done)
    VG_TRY(run_helper(n_job - next, job + next, 0, &done, err));
  for (size_t k = 0; k < n_job; k += done) {
    done = 1;
    if (job[k].st != VG_OK)
      VG_TRY(run_helper(1, job + k, ways - 1, &done, err));
  }
done:
  return st;
}
