/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/project.h"

#include <stdlib.h>
#include <string.h>

void vg_project_release(struct vg_project *p)
{
  for (size_t i = 0; i < p->n_curve; i++) free(p->curve[i].point);
  for (size_t i = 0; i < p->n_shape; i++) free(p->shape[i].curve);
  free(p->point);
  free(p->curve);
  free(p->shape);
  free(p->source);
  memset(p, 0, sizeof *p);
  p->ifact = p->vfact = 1;
}
