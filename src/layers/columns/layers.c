#include "layers/columns/layers.h"

#include <stdlib.h>
#include <string.h>

void vg_layer_front_release(struct vg_layer_front *f)
{
  vg_mesh_release(&f->mesh);
  free(f->column);
  free(f->point);
  free(f->face);
  f->column = f->point = f->face = NULL;
}

void vg_layers_release(struct vg_layers *l)
{
  if (!l->common.data) {
    vg_columns_release(&l->columns);
    vg_layer_front_release(&l->front);
    return;
  }
  vg_shmem_release(&l->common);
  memset(l, 0, sizeof *l);
}
