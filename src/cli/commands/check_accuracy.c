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

/* *s: a copy of `asked` with lengths in the unit of the mesh. */
static vg_status settle_unit(const struct vg_settings *asked,
                             struct vg_settings *s, struct vg_error *err)
{
  const int unit = vg_settings_unit(asked);
  const struct vg_param *p;
  double value;
  vg_status st = vg_settings_copy(s, asked, err);

  if (st < 0 || !(p = vg_settings_find_unit(s, &value))) return st;
  if (!unit)
    return vg_fail(
      err, VG_ERR_INPUT,
      "%s is a length with a unit, but the unit of the mesh is not "
      "known: add --unit mm if its coordinates are in "
      "millimetres, --unit m if they are in metres",
      p->name);
  vg_settings_convert(s, unit);
  return vg_settings_check(s, err);
}

vg_status vg_check_accuracy(const struct vg_settings *asked,
                            const struct vg_mesh *m,
                            struct vg_accuracy_report *r, struct vg_error *err)
{
  uint8_t *is_wall = vg_calloc(2 * m->n_patch, 1);
  struct vg_accuracy_options o = { .is_wall = is_wall, .with_reference = 1 };
  struct vg_settings s = VG_SETTINGS_INIT;
  vg_status st;

  if (!is_wall) return vg_fail_memory(err, "the walls");
  VG_TRY(settle_unit(asked, &s, err));
  VG_TRY(find_walls(&s, m, is_wall, is_wall + m->n_patch, err));
  o.viscous_length = viscous_length(&s.layer);
  st = vg_accuracy_measure(m, &o, r, err);
done:
  vg_settings_release(&s);
  free(is_wall);
  return st;
}
