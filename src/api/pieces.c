/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The mesh in arrays of the caller and in pieces: a part of api/vanguard.h. */
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "api/job.h"
#include "base/memory.h"

struct arrays {
  double *xyz;
  uint32_t *cell[VG_SLICE_KINDS];
};

static vg_status fill_arrays(void *context, const struct vg_slice *s,
                             struct vg_error *err)
{
  const struct arrays *a = context;

  (void)err;
  for (size_t k = 0; a->xyz && k < s->n_own; k++)
    memcpy(a->xyz + 3 * (s->point_at + k), s->x[s->own[k]], sizeof *s->x);
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    uint32_t *to = a->cell[k];
    size_t n = s->n_cell[k] * vg_slice_width[k];

    if (!to) continue;
    to += s->cell_at[k] * vg_slice_width[k];
    for (size_t i = 0; i < n; i++) to[i] = s->id[s->cell[k][i]];
  }
  return VG_OK;
}

static vanguard_status copy(vanguard_job *job, struct arrays a)
{
  VG_JOB_CALL(job);
  vg_status st = vg_job_meshed(job);

  if (st < 0) return vg_job_status(st);
  if (job->run.size > 1)
    return vg_job_status(vg_fail(&job->err, VG_ERR_UNSUPPORTED,
                                 "no process holds the whole mesh of a job "
                                 "with %d ranks: use vanguard_piece_get or "
                                 "vanguard_write",
                                 job->run.size));
  if (job->run.slices.n_point >= UINT32_MAX)
    return vg_job_status(vg_fail(&job->err, VG_ERR_UNSUPPORTED,
                                 "%llu points cannot be numbered with 32 "
                                 "bits: use vanguard_piece_get, or write "
                                 "b8l.ugrid",
                                 (unsigned long long)job->run.slices.n_point));
  st = vg_slices_each(&job->run.slices, job->run.threads, fill_arrays, &a,
                      &job->err);
  return vg_job_status(st);
}

vanguard_status vanguard_arrays(vanguard_job *job, double *xyz, uint32_t *tet,
                                uint32_t *pyr, uint32_t *pri)
{
  return copy(job, (struct arrays){ xyz, { tet, pyr, pri, NULL } });
}

vanguard_status vanguard_hexahedra(vanguard_job *job, uint32_t *hex)
{
  return copy(job, (struct arrays){ NULL, { NULL, NULL, NULL, hex } });
}

size_t vanguard_pieces(const vanguard_job *job)
{
  VG_JOB_ASK(job, 0);
  return job->is_meshed ? job->run.slices.n_slice : 0;
}

/* The number of a piece shows whether the caller still holds it: no other piece
 * of any job ever has the same number. */
static atomic_uintptr_t last_number;

static struct vg_job_piece *held(struct vg_job_lent *l, uintptr_t number)
{
  size_t lo = 0, hi = l->n;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (l->piece[mid].number < number) lo = mid + 1;
    else hi = mid;
  }
  return lo < l->n && l->piece[lo].number == number && l->piece[lo].slice
         ? &l->piece[lo]
         : NULL;
}

static void take_back(vanguard_job *job, struct vg_job_piece *piece)
{
  job->run.slices.put(&job->run.slices, piece->slice);
  free(piece->slice);
  piece->slice = NULL;
  if (!--job->lent.n_held) job->lent.n = 0;
}

void vg_job_take_back(vanguard_job *job)
{
  for (size_t i = 0; i < job->lent.n; i++)
    if (job->lent.piece[i].slice) take_back(job, &job->lent.piece[i]);
  free(job->lent.piece);
  memset(&job->lent, 0, sizeof job->lent);
}

/* Get the slice of piece i and note that the caller holds it. */
static vg_status lend(vanguard_job *job, size_t i, struct vg_slice **out,
                      uintptr_t *number)
{
  struct vg_job_lent *l = &job->lent;
  struct vg_slice *slice = vg_calloc(1, sizeof *slice);
  vg_status st;

  if (!slice || vg_reserve(&l->piece, &l->cap, l->n + 1, sizeof *l->piece)) {
    free(slice);
    return vg_fail_memory(&job->err, "a piece of the mesh");
  }
  st = job->run.slices.get(&job->run.slices, i, slice, &job->err);
  if (st < 0) {
    free(slice);
    return st;
  }
  *number = atomic_fetch_add(&last_number, 1) + 1;
  l->piece[l->n++] = (struct vg_job_piece){ *number, slice };
  l->n_held++;
  *out = slice;
  return VG_OK;
}

vanguard_status vanguard_piece_get(vanguard_job *job, size_t i,
                                   struct vanguard_piece *out)
{
  VG_JOB_CALL(job);
  const struct vg_slices *s = &job->run.slices;
  struct vanguard_piece p = { .struct_size = sizeof p };
  struct vg_slice *slice = NULL;
  uintptr_t number = 0;
  vg_status st = vg_job_meshed(job);

  if (st >= 0 && i >= s->n_slice)
    st = vg_fail(&job->err, VG_ERR_USAGE,
                 "there is no piece %zu: this rank has %zu", i, s->n_slice);
  if (st < 0) goto done;
  VG_TRY(vg_job_give(job, out, &p, sizeof p));
  VG_TRY(lend(job, i, &slice, &number));
  p.n_point = slice->n_point;
  p.xyz = (const double *)slice->x;
  p.id = slice->id;
  p.own_at = slice->point_at;
  p.n_own = slice->n_own;
  p.own = slice->own;
  p.tet_at = slice->cell_at[VG_SLICE_TET];
  p.pyr_at = slice->cell_at[VG_SLICE_PYR];
  p.pri_at = slice->cell_at[VG_SLICE_PRI];
  p.n_tet = slice->n_cell[VG_SLICE_TET];
  p.n_pyr = slice->n_cell[VG_SLICE_PYR];
  p.n_pri = slice->n_cell[VG_SLICE_PRI];
  p.tet = slice->cell[VG_SLICE_TET];
  p.pyr = slice->cell[VG_SLICE_PYR];
  p.pri = slice->cell[VG_SLICE_PRI];
  p.hex_at = slice->cell_at[VG_SLICE_HEX];
  p.n_hex = slice->n_cell[VG_SLICE_HEX];
  p.hex = slice->cell[VG_SLICE_HEX];
  p.subdomain = slice->domain;
  p.keep = (void *)number;
  st = vg_job_give(job, out, &p, sizeof p);
done:
  return vg_job_status(st);
}

void vanguard_piece_put(vanguard_job *job, struct vanguard_piece *piece)
{
  struct vg_job_piece *found;

  if (!piece || !piece->keep || vg_job_enter(job)) return;
  found = held(&job->lent, (uintptr_t)piece->keep);
  if (found) take_back(job, found);
  piece->keep = NULL;
  vg_job_leave(&(const vanguard_job *){ job });
}
