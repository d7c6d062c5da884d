/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/columns/layers.h"

#include <string.h>

void vg_layers_release(struct vg_layers *l)
{
  if (!l->common.data) {
    vg_columns_release(&l->columns);
    vg_front_release(&l->front);
    return;
  }
  vg_shmem_release(&l->common);
  memset(l, 0, sizeof *l);
}
