/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Discretisation errors of the mesh that is checked. */
#include "cli/commands/check_accuracy.h"

#include <stdlib.h>

#include "base/memory.h"
#include "run/input/walls.h"
#include "run/settings/patch_names.h"
#include "run/settings/resolved.h"

static vg_status find_walls(const struct vg_settings *s,
                            const struct vg_mesh *m, uint8_t *is_wall,
                            uint8_t *is_slip, struct vg_error *err)
{
  const struct vg_layer_settings *l = &s->layer;
  vg_status st;

  VG_TRY(vg_patch_list_mark("walls", l->walls, m, m->n_patch, is_wall, err));
  VG_TRY(vg_patch_list_mark("slip", l->slip, m, m->n_patch, is_slip, err));
  for (size_t i = 0; i < m->n_patch; i++) {
    if (!*l->walls) is_wall[i] = (uint8_t)vg_is_viscous(&m->patch[i]);
    if (is_slip[i]) is_wall[i] = 0;
  }
done:
  return st;
}

/* The wall distance of y+ 1; 0: not known. */
static double viscous_length(const struct vg_layer_settings *l)
{
  const double by_flow = vg_settings_first(l, 0, 1);

  return by_flow > 0 ? by_flow : l->first;
}

vg_status vg_check_accuracy(const struct vg_settings *s,
                            const struct vg_mesh *m,
                            struct vg_accuracy_report *r, struct vg_error *err)
{
  uint8_t *is_wall = vg_calloc(2 * m->n_patch, 1);
  const struct vg_accuracy_options o = { .is_wall = is_wall,
                                         .viscous_length = viscous_length(
                                           &s->layer),
                                         .with_reference = 1 };
  vg_status st;

  if (!is_wall) return vg_fail_memory(err, "the walls");
  VG_TRY(find_walls(s, m, is_wall, is_wall + m->n_patch, err));
  st = vg_accuracy_measure(m, &o, r, err);
done:
  free(is_wall);
  return st;
}
