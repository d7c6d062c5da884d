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

/* Receive the arrays of an answer. */
static vg_status take_cells(struct vg_cdt_job *job, struct vg_link *from,
                            const struct vg_helper_message *a,
                            struct vg_error *err)
{
  double(*added)[3] = vg_link_get_array(from, a->n[0], sizeof *added);
  double(*all)[3] = added ? vg_alloc(job->n + a->n[0], sizeof *all) : NULL;
  uint32_t(*tet)[4] = all ? vg_link_get_array(from, a->n[1], sizeof *tet)
                          : NULL;
  vg_status st = VG_OK;

  if (from->state != VG_LINK_OPEN)
    st = vg_helper_lost(from, 0, "vanguard-tetgen", err);
  else if (!tet) st = vg_fail_memory(err, "the cells of a pocket");
  if (st == VG_OK &&
      are_in_range(a->n[1], (const uint32_t(*)[4])tet, job->n + a->n[0])) {
    memcpy(all, job->x, job->n * sizeof *all);
    if (a->n[0]) memcpy(all + job->n, added, a->n[0] * sizeof *all);
    job->n_all = job->n + a->n[0];
    job->n_tet = a->n[1];
    job->all = all;
    job->tet = tet;
    job->st = VG_OK;
  } else {
    free(tet);
    free(all);
  }
  free(added);
  return st;
}

vg_status vg_cdt_receive(struct vg_cdt_job *job, struct vg_link *from,
                         struct vg_error *err)
{
  struct vg_helper_message a = { .what = 0 };
  int is_there = vg_link_get(from, &a, sizeof a);

  if (is_there && a.what == VG_HELPER_CELLS && a.n[0] <= n_max &&
      a.n[1] <= n_max)
    return take_cells(job, from, &a, err);
  if (is_there && a.what == VG_HELPER_NONE) return VG_BLOCKED;
  if (a.what != VG_HELPER_FAILED) a.option = 0;
  if (a.option == VG_HELPER_CRASHED)
    return job->n_crash++ ? VG_BLOCKED : VG_NOT_BETTER;
  return vg_helper_lost(from, a.option, "vanguard-tetgen", err);
}

/* The jobs from `next` to `end`, with the first set of switches `way`. */
struct jobs {
  struct vg_cdt_job *job;
  size_t next, end;
  uint32_t way;
};

/* Start a helper that works through jobs until one of them ends it. */
static vg_status run_helper(void *user, struct vg_error *err)
{
  struct jobs *j = user;
  struct vg_child c;
  struct vg_link l;
  vg_status st = vg_helper_open(VG_HELPER_TETGEN, NULL, silence, &c, &l, err);

  if (st < 0) return st;
  while (j->next < j->end && st == VG_OK) {
    st = ask(&j->job[j->next], j->way, &l)
         ? vg_cdt_receive(&j->job[j->next], &l, err)
         : vg_helper_lost(&l, 0, "vanguard-tetgen", err);
    if (st == VG_OK || st == VG_BLOCKED) j->next++;
  }
  vg_helper_close(&c);
  return st < 0 ? st : VG_OK;
}

static vg_status run(struct vg_cdt_job *job, size_t next, size_t end,
                     uint32_t way, struct vg_error *err)
{
  struct jobs j = { job, next, end, way };
  vg_status st = VG_OK;

  while (j.next < j.end && st == VG_OK)
    st = vg_helper_repeat(run_helper, &j, NULL, err);
  return st;
}

static vg_status prepare(size_t n_job, struct vg_cdt_job *job,
                         struct vg_error *err)
{
  for (size_t k = 0; k < n_job; k++) {
    job[k].st = VG_ERR_GEOMETRY;
    job[k].n_all = job[k].n_tet = 0;
    job[k].n_crash = 0;
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
  vg_status st;

  VG_TRY(prepare(n_job, job, err));
  vg_helper_find(VG_HELPER_TETGEN, &h);
  if (!h.is_found) {
    st = h.is_unusable ? VG_ERR_IO : VG_BLOCKED;
    vg_fail(err, h.is_unusable ? st : VG_ERR_UNSUPPORTED, "%s", h.why);
    goto done;
  }
  VG_TRY(run(job, 0, n_job, 0, err));
  for (size_t k = 0; k < n_job; k++)
    if (job[k].st != VG_OK) VG_TRY(run(job, k, k + 1, ways - 1, err));
done:
  return st;
}
