/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Files of a mesh in two dimensions. */
#include <assert.h>
#include <stdlib.h>

#include "io/plane/plane.h"
#include "run/stages/output.h"

int vg_outputs_has_plane(const struct vg_outputs *o, const char *item)
{
  return o->plane && vg_plane_can_write(item);
}

vg_status vg_outputs_plane(struct vg_outputs *o, struct vg_comm *comm,
                           const char *item, struct vg_error *err)
{
  char *path;
  vg_status st = vg_outputs_new(o, item, &path, err);

  assert(vg_outputs_has_plane(o, item));
  if (st >= 0 && !o->is_guest) st = vg_plane_write(path, item, o->plane, err);
  free(path);
  return vg_comm_agree(comm, st, err);
}
