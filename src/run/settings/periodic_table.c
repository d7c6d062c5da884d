/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/settings/periodic_table.h"

#include <math.h>
#include <stddef.h>

#define SIZE_MOST 1e60

/* In the order of enum vg_periodic_kind. */
static const char *const kind_words[] = { "auto", "translation", "rotation",
                                          NULL };

#define AT(field)                                                              \
  .offset = offsetof(struct vg_periodic_row, field),                           \
  .size = sizeof((struct vg_periodic_row *)0)->field
#define REAL(name, field, most, of, about)                                     \
  {                                                                            \
    name, AT(field), .type = VG_PARAM_REAL, .lo = -(most), .hi = most,         \
                     .optional = 1, .unit = of, .help = about                  \
  }

static const struct vg_param columns[] = {
  { "patch", AT(patch), VG_PATCH_COLUMN(struct vg_periodic_row, patch_name),
    .required = 1, .help = "Number or name of the first patch of the pair" },
  { "image", AT(image), VG_PATCH_COLUMN(struct vg_periodic_row, image_name),
    .required = 1,
    .help = "The second patch, whose points are moved to the images of those "
            "of the first" },
  { "kind", AT(kind), .type = VG_PARAM_WORD, .words = kind_words, .unit = "",
    .help = "Transform that takes patch to image; auto: found from the areas "
            "and centroids of the patches, unless it is given" },
  REAL("tx", t[0], SIZE_MOST, "length", "Translation, x; -: found"),
  REAL("ty", t[1], SIZE_MOST, "length", "Translation, y"),
  REAL("tz", t[2], SIZE_MOST, "length", "Translation, z"),
  REAL("angle", angle, 180, "degrees",
       "Angle of a rotation, right-handed about its axis; within 0.001 degrees "
       "of 360/n it is that fraction of a turn; -: found"),
  REAL("x", centre[0], SIZE_MOST, "length", "Point on the axis, x; -: 0"),
  REAL("y", centre[1], SIZE_MOST, "length", "Point on the axis, y; -: 0"),
  REAL("z", centre[2], SIZE_MOST, "length", "Point on the axis, z; -: 0"),
  REAL("ux", axis[0], SIZE_MOST, "", "Direction of the axis, x"),
  REAL("uy", axis[1], SIZE_MOST, "", "Direction of the axis, y"),
  REAL("uz", axis[2], SIZE_MOST, "", "Direction of the axis, z"),
};

const struct vg_setting_table vg_periodic_table = {
  "periodic",
  "Pairs of patches, of which the second is the image of the first.", columns,
  sizeof columns / sizeof *columns, sizeof(struct vg_periodic_row)
};

void vg_periodic_row_default(struct vg_periodic_row *row)
{
  *row = (struct vg_periodic_row){ .patch = VG_BC_NONE,
                                   .image = VG_BC_NONE,
                                   .angle = NAN };
  for (int k = 0; k < 3; k++) row->t[k] = row->centre[k] = row->axis[k] = NAN;
}

/* Number of the three values that are given. */
static int n_given(const double v[3])
{
  return !isnan(v[0]) + !isnan(v[1]) + !isnan(v[2]);
}

static int is_zero(const double v[3])
{
  return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/* The fault of a row, as the end of a message; NULL: it has none. */
static const char *fault_of(const struct vg_periodic_row *r)
{
  const int shift = n_given(r->t), axis = n_given(r->axis);
  const int turn = !isnan(r->angle);

  if (shift % 3) return "tx, ty and tz must be given together";
  if (axis % 3) return "ux, uy and uz must be given together";
  if (shift && is_zero(r->t)) return "the translation is 0; change tx, ty, tz";
  if (axis && is_zero(r->axis))
    return "the direction ux uy uz of the axis is 0";
  if (turn && r->angle == 0) return "the angle is 0; give an angle, or -";
  if (shift && (turn || axis || n_given(r->centre)))
    return "a translation and a rotation are given; remove one of them";
  if (turn != (axis > 0) || (!turn && n_given(r->centre)))
    return "a rotation needs angle and ux, uy, uz; give both, or none of the "
           "columns of a rotation to have it found";
  if (shift && r->kind == VG_PERIODIC_ROTATION)
    return "kind is rotation, but a translation is given";
  if (turn && r->kind == VG_PERIODIC_TRANSLATION)
    return "kind is translation, but a rotation is given";
  return NULL;
}

vg_status vg_periodic_rows_check(const struct vg_settings *s,
                                 struct vg_error *err)
{
  for (size_t i = 0; i < s->n_periodic; i++) {
    const char *fault = fault_of(&s->periodic_row[i]);

    if (fault)
      return vg_fail(err, VG_ERR_INPUT, "periodic: line %zu: %s", i + 1, fault);
  }
  return VG_OK;
}
