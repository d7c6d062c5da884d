/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/settings/surface_table.h"

#include <stddef.h>

#include "core/remesh/remesh.h"

#define AT(field)                                                              \
  .offset = offsetof(struct vg_surface_row, field),                            \
  .size = sizeof((struct vg_surface_row *)0)->field

static const struct vg_param columns[] = {
  { "patch", AT(patch), VG_PATCH_COLUMN(struct vg_surface_row, patch_name),
    .required = 1,
    .help = "Number or name of the patch (* and ? are wildcards)" },
  { "adjacent", AT(adjacent),
    VG_PATCH_COLUMN(struct vg_surface_row, adjacent_name), .optional = 1,
    .help = "Adjacent patch: the row applies to the curve between the two "
            "patches; -: to the whole patch" },
  { "size", AT(size), .type = VG_PARAM_REAL, .hi = 1e60, .unit = "length",
    .help = "Largest edge; 0: no limit" },
  { "lead", AT(lead), .type = VG_PARAM_REAL, .hi = 1, .unit = "chords",
    .help = "Edge length at the leading edge of the patch (its foremost points "
            "along x), over the local length of the patch along x; "
            "0: no limit" },
  { "trail", AT(trail), .type = VG_PARAM_REAL, .hi = 1, .unit = "chords",
    .help = "Edge length at the trailing edges of the patch, which are found "
            "as for wakes with the stream along x, over their local chord; "
            "0: no limit" },
  { "root", AT(root), .type = VG_PARAM_REAL, .hi = 1, .unit = "semispans",
    .help = "Edge length at the root of the patch over the distance of its tip "
            "from the symmetry plane, or from the middle of a complete body; "
            "0: no limit" },
  { "tip", AT(tip), .type = VG_PARAM_REAL, .hi = 1, .unit = "semispans",
    .help = "Edge length at the tips of the patch, in the same unit; 0: no "
            "limit" },
  { "across", AT(across), .type = VG_PARAM_REAL, .hi = 1000, .unit = "edges",
    .help = "Number of edges across the patch where it is a narrow strip "
            "between two feature curves, such as a blunt trailing edge; "
            "0: 1" },
  { "stretch", AT(stretch), .type = VG_PARAM_REAL, .hi = VG_REMESH_STRETCH,
    .unit = "times",
    .help = "Aspect ratio of the triangles at the curve between the two "
            "patches, which is preserved: length of edges along it over that "
            "of edges across it; decreases with distance by growth; 0: 1" },
};

const struct vg_setting_table vg_surface_table = {
  "surface",
  "Edge lengths of the remeshed surface "
  "on patches and along the curves between them.",
  columns, sizeof columns / sizeof *columns, sizeof(struct vg_surface_row)
};

int vg_surface_row_has_adjacent(const struct vg_surface_row *r)
{
  return r->adjacent != VG_BC_NONE || *r->adjacent_name;
}

/* Reject a row without any request, and values that contradict each other. */
static vg_status check_row(const struct vg_surface_row *r, size_t line,
                           struct vg_error *err)
{
  const int adjacent = vg_surface_row_has_adjacent(r);
  const int of_patch = r->lead > 0 || r->trail > 0 || r->root > 0 ||
                       r->tip > 0 || r->across > 0;
  char one[2 * VG_NAME_MAX + 4], two[2 * VG_NAME_MAX + 4];

  vg_param_format(&columns[0], r, one, sizeof one);
  vg_param_format(&columns[1], r, two, sizeof two);
  if (!(r->size > 0 || of_patch || r->stretch > 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "surface: line %zu, patch %s, has no "
                   "request; give size, lead, trail, root, tip, across or "
                   "stretch",
                   line, one);
  if (adjacent && of_patch)
    return vg_fail(err, VG_ERR_INPUT,
                   "surface: only size and stretch apply to the curve between "
                   "patches %s and %s; give lead, trail, root, tip "
                   "and across on a line without `adjacent`",
                   one, two);
  if (!adjacent && r->stretch > 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "surface: line %zu, patch %s, has stretch, which needs a "
                   "curve; name the adjacent patch in the column `adjacent`",
                   line, one);
  if (r->stretch > 0 && r->stretch < 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "surface: stretch between patches %s "
                   "and %s is %g; it must be at least 1",
                   one, two, r->stretch);
  if (r->across > 0 && r->across < 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "surface: across of patch %s is %g; it "
                   "must be at least 1",
                   one, r->across);
  return VG_OK;
}

vg_status vg_surface_rows_check(const struct vg_settings *s,
                                struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < s->n_surface && st >= 0; i++)
    st = check_row(&s->surface_row[i], i + 1, err);
  return st;
}
