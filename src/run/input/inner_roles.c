/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Which patches are inner surfaces: by the lists `baffles` and `sheets`, and by
 * the column `role` of the table `patches`. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/copies.h"
#include "io/cad/cad.h"
#include "run/input/shape_parts.h"
#include "run/input/wakes.h"
#include "run/input/zone_table.h"
#include "run/settings/patch_names.h"

static int has_role(const struct vg_settings *s)
{
  int has = 0;

  for (size_t i = 0; i < s->n_patch; i++)
    has |= s->patch[i].role > VG_PATCH_WALL;
  return has;
}

static int has_wake_sheet(const struct vg_settings *s)
{
  int has = 0;

  for (size_t i = 0; i < s->n_wake; i++)
    has |= s->wake_row[i].kind == VG_WAKE_SHEET;
  return has;
}

/* Sheets of the file, or those made of wakes. */
static int has_sheet(const struct vg_mesh *m)
{
  int has = 0;

  for (size_t i = 0; i < m->n_patch; i++)
    has |= vg_patch_is_marked_sheet(&m->patch[i]);
  return has;
}

static int wants_inner(const struct vg_settings *s)
{
  return *s->baffles || *s->sheets || *s->zone_interfaces || has_role(s) ||
         has_wake_sheet(s);
}

int vg_boundary_wants_inner(const struct vg_boundary *b)
{
  return wants_inner(&b->read->settings) ||
         vg_mesh_has_interfaces(&b->surface) || has_sheet(&b->surface);
}

int vg_read_has_solid_zones(const struct vg_read *r)
{
  return r->settings.cad.solids == VG_CAD_SOLIDS_ZONES && vg_read_is_cad(r);
}

const char *vg_read_keeps_triangles(const struct vg_read *r)
{
  return wants_inner(&r->settings) || vg_read_has_solid_zones(r) ||
             vg_mesh_has_interfaces(&r->surface) || has_sheet(&r->surface)
         ? "inner surfaces"
         : NULL;
}

const char *vg_inner_source(const struct vg_settings *s, char *text,
                            size_t size)
{
  const struct {
    const char *name, *list;
    int is;
  } from[] = {
    { "baffles ", s->baffles, *s->baffles != 0 },
    { "sheets ", s->sheets, *s->sheets != 0 },
    { "zone_interfaces ", s->zone_interfaces, *s->zone_interfaces != 0 },
    { "the table patches", "", has_role(s) },
    { "the table wakes", "", has_wake_sheet(s) },
    { "cad_solids zones", "", s->cad.solids == VG_CAD_SOLIDS_ZONES },
  };
  size_t n = 0;

  *text = 0;
  for (size_t i = 0; i < sizeof from / sizeof *from && n < size; i++)
    if (from[i].is)
      n += (size_t)snprintf(text + n, size - n, "%s%s%.40s", n ? ", " : "",
                            from[i].name, from[i].list);
  if (!n) snprintf(text, size, "the file");
  return text;
}

static const char *const role_name[] = { "auto", "a wall", "a baffle",
                                         "a sheet", "an interface" };

/* Gives the marked patches a role. from: [n_patch] setting that gave a patch
 * its role, or NULL */
static vg_status give(const struct vg_mesh *m, const uint8_t *on, int role,
                      const char *setting, uint8_t *of, const char **from,
                      struct vg_error *err)
{
  for (size_t i = 0; i < m->n_patch; i++) {
    const struct vg_patch *p = &m->patch[i];

    if (!on[i]) continue;
    if (from[i] && of[i] != role)
      return vg_fail(err, VG_ERR_INPUT,
                     "patch %d%s%s is %s by %s, and %s by %s; remove it "
                     "from one of them",
                     (int)p->id, *p->name ? " " : "", p->name, role_name[of[i]],
                     from[i], role_name[role], setting);
    of[i] = (uint8_t)role;
    from[i] = setting;
  }
  return VG_OK;
}

static vg_status give_list(const struct vg_mesh *m, const char *setting,
                           const char *list, int role, uint8_t *on, uint8_t *of,
                           const char **from, struct vg_error *err)
{
  vg_status st;

  memset(on, 0, m->n_patch);
  st = vg_patch_list_mark(setting, list, m, m->n_patch, on, err);
  return st < 0 ? st : give(m, on, role, setting, of, from, err);
}

vg_status vg_inner_roles(const struct vg_settings *s, const struct vg_mesh *m,
                         uint8_t *role, struct vg_error *err)
{
  uint8_t *on = vg_alloc(m->n_patch, 1);
  const char **from = vg_calloc(m->n_patch, sizeof *from);
  vg_status st = on && from ? VG_OK : vg_fail_memory(err, "the patches");

  assert(role || !m->n_patch);
  VG_TRY(st);
  memset(role, VG_PATCH_AUTO, m->n_patch);
  VG_TRY(
    give_list(m, "baffles", s->baffles, VG_PATCH_BAFFLE, on, role, from, err));
  VG_TRY(
    give_list(m, "sheets", s->sheets, VG_PATCH_SHEET, on, role, from, err));
  VG_TRY(give_list(m, "zone_interfaces", s->zone_interfaces, VG_PATCH_INTERFACE,
                   on, role, from, err));
  for (size_t i = 0; i < m->n_patch; i++) on[i] = m->patch[i].is_interface != 0;
  VG_TRY(
    give(m, on, VG_PATCH_INTERFACE, "the zones of the file", role, from, err));
  for (size_t i = 0; i < s->n_patch && st >= 0; i++) {
    const size_t at = vg_mesh_find_patch(m, s->patch[i].id);

    if (s->patch[i].role == VG_PATCH_AUTO || at == SIZE_MAX) continue;
    memset(on, 0, m->n_patch);
    on[at] = 1;
    st = give(m, on, s->patch[i].role, "the table patches", role, from, err);
  }
  for (size_t i = 0; i < m->n_patch; i++) {
    if (role[i] == VG_PATCH_AUTO && vg_patch_is_marked_sheet(&m->patch[i]))
      role[i] = VG_PATCH_SHEET;
    if (role[i] == VG_PATCH_WALL) role[i] = VG_PATCH_AUTO;
  }
done:
  free(on);
  free(from);
  return st;
}

vg_status vg_inner_split(const struct vg_settings *s, struct vg_mesh *m,
                         struct vg_error *err)
{
  uint8_t *on = vg_calloc(m->n_patch, 1);
  struct vg_error why = VG_ERROR_INIT;
  size_t at;

  if (!on) return vg_fail_memory(err, "the patches");
  if (s->layer.grow != VG_ANSWER_NO) {
    (void)vg_patch_list_mark("walls", s->layer.walls, m, m->n_patch, on, &why);
    for (size_t i = 0; i < s->n_layer; i++) {
      at = vg_mesh_find_patch(m, s->layer_row[i].id);
      if (at != SIZE_MAX && s->layer_row[i].grow == VG_ANSWER_YES) on[at] = 1;
    }
  }
  for (size_t i = 0; i < m->n_patch; i++)
    if (m->patch[i].inner == VG_INNER_BACK) {
      struct vg_patch *front = &m->patch[vg_mesh_front_patch(m, i)];

      at = (size_t)(front - m->patch);
      front->is_split = m->patch[i].is_split &= on[i] || on[at];
    }
  free(on);
  return VG_OK;
}
