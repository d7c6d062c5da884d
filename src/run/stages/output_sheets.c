/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sheets in the files of a mesh: STEM.sheets for formats without faces between
 * cells. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/mesh/zones.h"
#include "io/mesh/foam.h"
#include "io/mesh/format.h"
#include "io/mesh/su2.h"
#include "io/mesh/ugrid.h"
#include "io/stream/sheet_file.h"
#include "run/input/zone_table.h"
#include "run/stages/output.h"

/* Does STEM.sheets belong to a file in this form? Its points must have the
 * numbers of the mesh, which those of .cogsg and .pvtu do not have. */
static int takes_sheets(const char *form)
{
  struct vg_ugrid_kind kind;

  return vg_ugrid_kind(form, &kind) || !strcmp(form, "su2") ||
         !strcmp(form, "vtu");
}

int vg_outputs_need_sheets(const struct vg_outputs *o)
{
  int needs = 0;

  for (size_t i = 0; i < o->n_item; i++) needs |= takes_sheets(o->item[i]);
  return needs;
}

vg_status vg_outputs_check_zones(const struct vg_outputs *o,
                                 const struct vg_mesh *surface,
                                 struct vg_error *err)
{
  for (size_t i = 0; i < o->n_item && !vg_mesh_has_interfaces(surface); i++)
    if (!strcmp(o->item[i], VG_SU2_ZONES))
      return vg_fail(err, VG_ERR_INPUT,
                     "write: " VG_SU2_ZONES " has a mesh for each zone, and "
                     "no interface makes zones; write su2, or name the "
                     "interfaces in zone_interfaces");
  return VG_OK;
}

vg_status vg_outputs_check_sheets(const struct vg_outputs *o,
                                  const struct vg_settings *s,
                                  struct vg_error *err)
{
  struct vg_foam_options options;
  int wants = *s->sheets || *s->zone_interfaces,
      holds = vg_outputs_need_sheets(o);

  for (size_t i = 0; i < s->n_patch; i++)
    wants |= s->patch[i].role >= VG_PATCH_SHEET;
  for (size_t i = 0; i < o->n_item; i++)
    holds |= vg_foam_word(o->item[i], &options) ||
             vg_format_holds_zones(o->item[i]);
  if (!wants || holds || !o->n_item) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "write: none of these formats holds sheets; add b8.ugrid, "
                 "cgns, msh, meshb, fluent.msh or foam");
}

/* Does this form hold cells, but neither sheets nor a STEM.sheets? */
static int loses_sheets(const char *form)
{
  struct vg_foam_options options;

  return !takes_sheets(form) && !vg_foam_word(form, &options) &&
         !vg_format_holds_sheets(form) && strcmp(form, "mapbc") &&
         strcmp(form, "fun3d.mapbc");
}

void vg_outputs_note_sheets(const struct vg_outputs *o, const struct vg_mesh *m,
                            struct vg_notes *notes)
{
  for (size_t i = 0; i < o->n_item && m->n_zone; i++)
    if (loses_sheets(o->item[i]) && !vg_format_holds_zones(o->item[i]))
      vg_note(notes, ".%s has no zones: all cells are in one zone in it",
              o->item[i]);
  for (size_t i = 0; i < o->n_item; i++) {
    const size_t n = m->n_sheet_tri - (vg_format_holds_zones(o->item[i])
                                         ? vg_mesh_interface_triangles(m)
                                         : 0);

    if (n && loses_sheets(o->item[i]))
      vg_note(notes,
              ".%s has no faces between cells: %zu triangles of sheets are "
              "not in it",
              o->item[i], n);
  }
}

/* Whether STEM.sheets exists, and whether Vanguard wrote it. */
static vg_status look_for_sheets(const struct vg_outputs *o, int *exists,
                                 int *is_own, struct vg_notes *notes,
                                 struct vg_error *err)
{
  char *path = vg_outputs_final(o, VG_SHEET_SUFFIX);

  if (!path) return vg_fail_memory(err, "the output paths");
  *exists = !access(path, F_OK);
  *is_own = vg_sheet_file_is_own(path);
  if (*exists && !*is_own)
    vg_note(notes,
            "%s exists, is not a file of Vanguard, and is neither overwritten "
            "nor removed; remove it or write under another name if it does not "
            "belong to this mesh",
            path);
  free(path);
  return VG_OK;
}

vg_status vg_outputs_sheets(struct vg_outputs *o, const struct vg_mesh *m,
                            uint64_t n_point, uint64_t n_cell,
                            struct vg_notes *notes, struct vg_error *err)
{
  int exists = 0, is_own = 0;
  char *path;
  vg_status st;

  assert(o->temp_dir && !o->is_guest);
  st = look_for_sheets(o, &exists, &is_own, notes, err);
  if (st < 0 || (exists && !is_own)) return st;
  if (!m->n_sheet_tri && !m->n_zone) {
    o->drops_sheets = is_own;
    return VG_OK;
  }
  st = vg_outputs_new(o, VG_SHEET_SUFFIX, &path, err);
  if (st >= 0) st = vg_sheet_file_write(path, m, n_point, n_cell, err);
  free(path);
  return st;
}
