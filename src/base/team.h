/* base/team.h: loops over the threads of several processes that hold the same
 * data: the first ranks of the nodes, while they make what every node needs.
 * Each does a part of the items, and all get what the others wrote. */
#ifndef VG_BASE_TEAM_H
#define VG_BASE_TEAM_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "base/parallel.h"
#include "base/status.h"

struct vg_team; /* NULL: this process alone */

/** What a loop writes into an array: for item i the elements begin[i] to
 * begin[i + 1] - 1 [n + 1]; where begin is NULL, the element i / per. */
struct vg_team_out {
  void *data;
  size_t size; /* bytes of an element */
  size_t per;  /* divides the loop's grain; 0: 1 */
  const uint32_t *begin;
};

/** The first ranks of all nodes. Collective over all ranks; *out is NULL where
 * there is one node only, and on the other ranks. */
vg_status vg_team_open(struct vg_comm *c, struct vg_team **out,
                       struct vg_error *err);

/** The end of what the team does together, with st how this member fared:
 * whatever the others do in the team then fails too, if it failed. To be called
 * once by every member, after its last loop, also after a failure. Returns what
 * vg_comm_agree would. Frees the team. */
vg_status vg_team_close(struct vg_team *t, vg_status st, struct vg_error *err);

/** As vg_parallel_for, by the threads of all members; the same outcome. body
 * writes to `out` [n_out] only, or to scratch of its worker.
 *
 * The members call it in the same order with the same n and grain. Loops too
 * short to be worth a message are done by every member for itself.
 * Without a team it never fails; else VG_ERR_REMOTE, or the failure of a member
 * that left the team. */
vg_status vg_team_for(struct vg_team *t, int threads, size_t n, size_t grain,
                      vg_loop_body body, void *context, size_t n_out,
                      const struct vg_team_out *out, struct vg_error *err);

/** *flag: 1 where it is set with any member. */
vg_status vg_team_any(struct vg_team *t, int *flag, struct vg_error *err);

#endif
