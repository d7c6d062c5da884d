/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Broadcasts rank 0's digest of a mesh. Uses mpi_support.h,
 * unit/advance_support.h. */
#ifndef VG_TESTS_DIGEST_SUPPORT_H
#define VG_TESTS_DIGEST_SUPPORT_H

#include "mpi_support.h"

#include "../unit/advance_support.h"

/* Collective; the other ranks wait for rank 0. */
static inline struct mesh_digest tell(const struct mesh_digest *d)
{
  struct vg_bytes b = { sizeof *d, vg_calloc(1, sizeof *d) };
  struct mesh_digest out;

  assert_non_null(b.data);
  if (vg_comm_rank(job) == 0) memcpy(b.data, d, sizeof *d);
  assert_int_equal(vg_comm_bcast(job, 0, &b, NULL), VG_OK);
  memcpy(&out, b.data, sizeof out);
  free(b.data);
  return out;
}

#endif
