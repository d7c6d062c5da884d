/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/team.h: loops over the threads of several processes that hold the same
 * data. The members of a team are the first ranks of the nodes, while they
 * compute data that every node needs. Each member processes a part of the
 * items, and all members receive the results of the others. */
#ifndef VG_BASE_TEAM_H
#define VG_BASE_TEAM_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "base/parallel.h"
#include "base/status.h"

struct vg_team; /* NULL: this process alone */

/** An array that a loop writes. For item i it writes the elements begin[i] to
 * begin[i + 1] - 1, begin being [n + 1]. Where begin is NULL, it writes the
 * element i / per. */
struct vg_team_out {
  void *data;
  size_t size; /* bytes of an element */
  size_t per;  /* divides the loop's grain; 0 means 1 */
  const uint32_t *begin;
};

/** Make a team of the first ranks of all nodes. *out is NULL if there is only
 * one node, and on all other ranks. Collective over all ranks. */
vg_status vg_team_open(struct vg_comm *c, struct vg_team **out,
                       struct vg_error *err);

/** End the work of the team. st is the status of this member: if it is a
 * failure, all further joint operations of the other members fail too. Every
 * member calls it once, after its last loop, also after a failure. Returns the
 * status that vg_comm_agree would return. Frees the team. */
vg_status vg_team_close(struct vg_team *t, vg_status st, struct vg_error *err);

/** As vg_parallel_for, using the threads of all members, with the same result.
 * The body may only write to `out` [n_out] or to scratch memory of its worker.
 *
 * All members call it in the same order with the same n and grain. Loops too
 * short to be worth a message are executed completely by every member. Never
 * fails without a team; otherwise it may return VG_ERR_REMOTE, or the failure
 * of a member that has left the team. */
vg_status vg_team_for(struct vg_team *t, int threads, size_t n, size_t grain,
                      vg_loop_body body, void *context, size_t n_out,
                      const struct vg_team_out *out, struct vg_error *err);

/** Set *flag to 1 if it is set on any member. */
vg_status vg_team_any(struct vg_team *t, int *flag, struct vg_error *err);

#endif
