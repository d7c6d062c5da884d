/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <assert.h>
#include <stdlib.h>

#include "base/comm_parts.h"
#include "base/memory.h"
#include "base/team.h"

/* A loop with fewer chunks than this per member is executed by every member. */
enum { WORTH = 4 };

struct vg_team {
  struct vg_comm *c;
  MPI_Comm comm;
  int rank, size;
  int is_broken;   /* a member has failed, and all members know it */
  int *count, *at; /* [size] arguments of MPI calls */
};

static void team_free(struct vg_team *t)
{
  if (!t) return;
  if (t->comm != MPI_COMM_NULL) MPI_Comm_free(&t->comm);
  free(t->count);
  free(t->at);
  free(t);
}

static vg_status fill_team(struct vg_team *t, struct vg_error *err)
{
  int rc = MPI_Comm_set_errhandler(t->comm, MPI_ERRORS_RETURN);

  if (!rc) rc = MPI_Comm_rank(t->comm, &t->rank);
  if (!rc) rc = MPI_Comm_size(t->comm, &t->size);
  if (rc) return vg_comm_fail(err, "cannot find the nodes", rc);
  t->count = vg_alloc((size_t)t->size, sizeof *t->count);
  t->at = vg_alloc((size_t)t->size, sizeof *t->at);
  return t->count && t->at ? VG_OK : vg_fail_memory(err, "a team of nodes");
}

vg_status vg_team_open(struct vg_comm *c, struct vg_team **out,
                       struct vg_error *err)
{
  struct vg_team *t = NULL;
  vg_status st = VG_OK;
  int leads = vg_comm_node_rank(c) == 0, rc;

  *out = NULL;
  if (!c) return VG_OK;
  t = vg_calloc(1, sizeof *t);
  st = vg_comm_agree(c, t ? VG_OK : vg_fail_memory(err, "a team of nodes"),
                     err);
  if (st < 0) {
    free(t);
    return st;
  }
  t->c = c;
  t->comm = MPI_COMM_NULL;
  rc = MPI_Comm_split(c->all, leads ? 0 : MPI_UNDEFINED, c->rank, &t->comm);
  if (rc) st = vg_comm_fail(err, "cannot find the nodes", rc);
  else if (leads) st = fill_team(t, err);
  st = vg_comm_agree(c, st, err);
  if (st >= 0 && leads && t->size > 1) *out = t;
  else team_free(t);
  return st;
}

/* Agree before each joint operation whether a member has left the team. */
static vg_status meet(struct vg_team *t, vg_status mine, struct vg_error *err)
{
  vg_status st;

  if (t->is_broken)
    return mine < 0 ? mine : vg_fail(err, VG_ERR_REMOTE, "another node failed");
  st = vg_comm_agree_in(t->c, t->comm, mine, err);
  if (st < 0) t->is_broken = 1;
  return st;
}

vg_status vg_team_close(struct vg_team *t, vg_status st, struct vg_error *err)
{
  if (!t) return st;
  st = meet(t, st, err);
  team_free(t);
  return st;
}

/* First chunk of member m. */
static size_t part_of(const struct vg_team *t, size_t n_chunk, int m)
{
  return n_chunk / (size_t)t->size * (size_t)m +
         n_chunk % (size_t)t->size * (size_t)m / (size_t)t->size;
}

/* First array element of item i. */
static size_t element_of(const struct vg_team_out *o, size_t i)
{
  size_t per = o->per ? o->per : 1;

  return o->begin ? o->begin[i] : (i + per - 1) / per;
}

/* Gather in rounds, so that no MPI call exceeds its size limit. */
static vg_status gather(struct vg_team *t, size_t n, size_t grain,
                        size_t n_chunk, const struct vg_team_out *o,
                        struct vg_error *err)
{
  size_t most = t->c->chunk / o->size / (size_t)t->size, done = 0, left = 1;
  MPI_Datatype element;
  int rc = MPI_Type_contiguous((int)o->size, MPI_BYTE, &element);

  if (!rc) rc = MPI_Type_commit(&element);
  if (rc) return vg_comm_fail(err, "cannot gather among the nodes", rc);
  if (!most) most = 1;
  while (!rc && left) {
    size_t base = 0;
    MPI_Request request;

    left = 0;
    for (int m = 0; m < t->size; m++) {
      size_t i = part_of(t, n_chunk, m) * grain;
      size_t j = part_of(t, n_chunk, m + 1) * grain;
      size_t first = element_of(o, i < n ? i : n) + done;
      size_t end = element_of(o, j < n ? j : n);
      size_t some = first < end ? end - first : 0;

      if (!m) base = first;
      if (some > most) some = most;
      if (first + some < end) left = 1;
      t->count[m] = (int)some;
      t->at[m] = some ? (int)(first - base) : 0;
      if (some && first - base > INT32_MAX) rc = MPI_ERR_COUNT;
    }
    if (!rc)
      rc = MPI_Iallgatherv(MPI_IN_PLACE, 0, element,
                           (char *)o->data + base * o->size, t->count, t->at,
                           element, t->comm, &request);
    if (!rc) rc = vg_comm_wait(1, &request, 1);
    done += most;
  }
  MPI_Type_free(&element);
  return rc ? vg_comm_fail(err, "cannot gather among the nodes", rc) : VG_OK;
}

/* The loop over this member's items, numbered as in the whole loop. */
struct part {
  vg_loop_body body;
  void *context;
  size_t first;
};

static void part_body(void *context, size_t first, size_t end, int worker)
{
  const struct part *p = context;

  p->body(p->context, p->first + first, p->first + end, worker);
}

vg_status vg_team_for(struct vg_team *t, int threads, size_t n, size_t grain,
                      vg_loop_body body, void *context, size_t n_out,
                      const struct vg_team_out *out, struct vg_error *err)
{
  size_t n_chunk, end;
  struct part p = { body, context, 0 };
  vg_status st;

  assert(grain > 0 && body);
  assert(out || !n_out);
  if (!grain) grain = 1;
  n_chunk = (n + grain - 1) / grain;
  if (!t || n_chunk < (size_t)(WORTH * t->size)) {
    vg_parallel_for(threads, n, grain, body, context);
    return VG_OK;
  }
  st = meet(t, VG_OK, err);
  if (st < 0) return st;
  p.first = part_of(t, n_chunk, t->rank) * grain;
  end = part_of(t, n_chunk, t->rank + 1) * grain;
  if (end > n) end = n;
  vg_parallel_for(threads, end - p.first, grain, part_body, &p);
  for (size_t k = 0; st >= 0 && k < n_out; k++)
    st = gather(t, n, grain, n_chunk, &out[k], err);
  if (st < 0) t->is_broken = 1;
  return st;
}

vg_status vg_team_any(struct vg_team *t, int *flag, struct vg_error *err)
{
  MPI_Request request;
  vg_status st;
  int rc;

  assert(flag);
  if (!t) return VG_OK;
  st = meet(t, VG_OK, err);
  if (st < 0) return st;
  rc = MPI_Iallreduce(MPI_IN_PLACE, flag, 1, MPI_INT, MPI_LOR, t->comm,
                      &request);
  if (!rc) rc = vg_comm_wait(1, &request, 1);
  if (rc) t->is_broken = 1;
  return rc ? vg_comm_fail(err, "cannot agree among the nodes", rc) : VG_OK;
}
