/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/input/mesh_unit.h"

#include <math.h>
#include <stdio.h>

#include "io/mesh/format.h"
#include "run/settings/length.h"
#include "run/settings/names.h"

static const char *name_of(const struct vg_read *r)
{
  return *r->files.surface ? r->files.surface : r->files.stem;
}

static int is_cad(const struct vg_read *r)
{
  return !*r->files.front && *r->files.surface &&
         vg_format_is_cad(r->files.surface);
}

double vg_units_of_file(const struct vg_read *r, double x)
{
  const struct vg_cad_settings *s = &r->settings.cad;
  double up, down;

  if (!s->file_unit || !s->unit || s->file_unit == s->unit) return x;
  vg_unit_factor(s->file_unit, s->unit, &up, &down);
  return x * up / down;
}

/* A length with a unit means nothing as long as the numbers of the file could
 * be in any. */
static vg_status refuse(const struct vg_read *r, const struct vg_param *p,
                        double value, struct vg_error *err)
{
  char text[VG_LENGTH_TEXT];

  vg_length_format(value, text);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s is %s, but the unit of the mesh is not known, since %s "
                 "states none: add --unit mm if its coordinates are in "
                 "millimetres (%s is then %.10g), --unit m if they are in "
                 "metres (%.10g), or --file-unit and --unit to convert them",
                 p->name, text, name_of(r), p->name,
                 vg_length_in(value, VG_CAD_UNIT_MM),
                 vg_length_in(value, VG_CAD_UNIT_M));
}

/* Converts the lengths of the settings to r->unit. */
static vg_status convert_settings(struct vg_read *r, struct vg_error *err)
{
  double value;

  if (!vg_settings_find_unit(&r->settings, &value)) return VG_OK;
  vg_settings_convert(&r->settings, r->unit);
  return vg_settings_check(&r->settings, err);
}

vg_status vg_units_begin(struct vg_read *r, struct vg_error *err)
{
  const struct vg_cad_settings *s = &r->settings.cad;
  const struct vg_param *p;
  double value;

  if (s->file_unit && is_cad(r))
    return vg_fail(err, VG_ERR_INPUT,
                   "file_unit is %s, but %s is a CAD file; remove file_unit: "
                   "STEP and IGES files state their unit, and the numbers of a "
                   "BREP file are in `unit`",
                   vg_unit_name(s->file_unit), name_of(r));
  if (s->file_unit && s->unit && s->file_unit != s->unit &&
      (*r->files.d3m || *r->files.front))
    return vg_fail(err, VG_ERR_INPUT,
                   "file_unit is %s and unit %s, but %s belongs to a project "
                   "of VGRID, whose lengths cannot be converted; set unit to "
                   "%s",
                   vg_unit_name(s->file_unit), vg_unit_name(s->unit),
                   name_of(r), vg_unit_name(s->file_unit));
  r->unit = vg_settings_unit(&r->settings);
  if (r->unit) return convert_settings(r, err);
  p = vg_settings_find_unit(&r->settings, &value);
  if (!p || (is_cad(r) && !vg_length_has_unit(s->tolerance))) return VG_OK;
  if (!is_cad(r)) return refuse(r, p, value, err);
  return vg_fail(err, VG_ERR_INPUT,
                 "cad_tolerance has a unit, but is needed before the unit of "
                 "%s is known: set `unit`, or give it as a number",
                 name_of(r));
}

static void convert_points(struct vg_read *r)
{
  struct vg_mesh *m = &r->surface;
  const double before = vg_mesh_length(m);

  for (size_t i = 0; i < m->n_point; i++)
    for (int k = 0; k < 3; k++)
      m->point[i][k] = vg_units_of_file(r, m->point[i][k]);
  vg_note(r->notes,
          "the coordinates of %s were converted from %s (file_unit) to %s "
          "(unit): its length %.6g becomes %.6g",
          name_of(r), vg_unit_name(r->settings.cad.file_unit),
          vg_unit_name(r->settings.cad.unit), before, vg_mesh_length(m));
}

/* `scale` is sometimes taken for a factor on the coordinates. */
static void note_scale(struct vg_read *r)
{
  if (r->settings.scale == 1) return;
  vg_note(r->notes,
          "scale %g multiplies target edge lengths, not coordinates: the "
          "surface keeps its length of %.6g; file_unit and unit convert "
          "coordinates",
          r->settings.scale, vg_mesh_length(&r->surface));
}

vg_status vg_units_end(struct vg_read *r, struct vg_comm *comm,
                       struct vg_error *err)
{
  const struct vg_cad_settings *s = &r->settings.cad;
  const struct vg_param *p;
  double unit = r->unit, value;
  vg_status st = vg_comm_max(comm, 1, &unit, err);

  if (st < 0) return st;
  r->unit = (int)unit;
  note_scale(r);
  if (!is_cad(r) && s->file_unit && s->unit && s->file_unit != s->unit)
    convert_points(r);
  else if (!is_cad(r) && r->unit)
    vg_note(r->notes,
            "the coordinates of %s are taken to be in %s (%s), which is the "
            "unit of the mesh",
            name_of(r), vg_unit_name(r->unit),
            s->file_unit ? "file_unit" : "unit");
  p = vg_settings_find_unit(&r->settings, &value);
  if (!p) return VG_OK;
  return r->unit ? convert_settings(r, err) : refuse(r, p, value, err);
}
