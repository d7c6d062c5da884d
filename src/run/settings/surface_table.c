#include "run/settings/surface_table.h"

#include <stddef.h>

#include "core/remesh/remesh.h"

#define AT(field) .offset = offsetof(struct vg_surface_row, field), \
  .size = sizeof ((struct vg_surface_row *)0)->field

static const struct vg_param columns[] = {
  { "patch", AT(patch), .type = VG_PARAM_ID, .lo = INT32_MIN, .hi = INT32_MAX,
    .unit = "", .required = 1, .help = "number of the patch" },
  { "beside", AT(beside), .type = VG_PARAM_ID, .lo = INT32_MIN,
    .hi = INT32_MAX, .optional = 1, .unit = "", .help = "number of another "
    "one: the size holds along the curve between them; -: on all the patch" },
  { "size", AT(size), .type = VG_PARAM_REAL, .hi = 1e60, .unit = "length",
    .help = "largest edge; 0: no limit" },
  { "lead", AT(lead), .type = VG_PARAM_REAL, .hi = 1, .unit = "chords",
    .help = "edge where the patch is foremost along x, over its length along x "
    "there; 0: no limit" },
  { "across", AT(across), .type = VG_PARAM_REAL, .hi = 1000, .unit = "edges",
    .help = "edges across the patch where it is a strip between two lines, "
    "such as a blunt trailing edge; 0: 1" },
  { "stretch", AT(stretch), .type = VG_PARAM_REAL, .hi = VG_REMESH_STRETCH,
    .unit = "times", .help = "edges along the curve between patch and beside, "
    "which stays as a line, over those across it; fades out by growth; 0: 1" },
};

const struct vg_table vg_surface_table = { "surface", "Sizes of a new surface "
  "on patches and along the curves between them.", columns,
  sizeof columns / sizeof *columns, sizeof (struct vg_surface_row) };

vg_status vg_surface_rows_check(const struct vg_settings *s,
                                struct vg_error *err)
{
  for (size_t i = 0; i < s->n_surface; i++) {
    const struct vg_surface_row *r = &s->surface_row[i];

    if (!(r->size > 0 || r->lead > 0 || r->across > 0 || r->stretch > 0))
      return vg_fail(err, VG_ERR_INPUT, "surface: line %zu, patch %d, asks for "
                     "nothing; give size, lead, across or stretch", i + 1,
                     (int)r->patch);
    if (r->beside != VG_BC_NONE && (r->lead > 0 || r->across > 0))
      return vg_fail(err, VG_ERR_INPUT, "surface: the curve between patches %d "
                     "and %d has size and stretch only; give lead and across "
                     "on a line without beside", (int)r->patch, (int)r->beside);
    if (r->beside == VG_BC_NONE && r->stretch > 0)
      return vg_fail(err, VG_ERR_INPUT, "surface: line %zu, patch %d, asks for "
                     "stretch without a curve; give the patch beside", i + 1,
                     (int)r->patch);
    if (r->stretch > 0 && r->stretch < 1)
      return vg_fail(err, VG_ERR_INPUT, "surface: stretch between patches %d "
                     "and %d is %g; it must be at least 1", (int)r->patch,
                     (int)r->beside, r->stretch);
    if (r->across > 0 && r->across < 1)
      return vg_fail(err, VG_ERR_INPUT, "surface: across of patch %d is %g; it "
                     "must be at least 1", (int)r->patch, r->across);
  }
  return VG_OK;
}
