#include "cli/settings.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/fill.h"

#define HUGE_SIZE 1e60 /* beyond this the predicates are not safe */

static const char *const domain_words[] = { "auto", "none", "sphere", "box",
                                            NULL };
/* In the order of enum vg_source_kind. */
static const char *const source_words[] = {
  "vgrid_node", "vgrid_line", "point", "line", "triangle", "box", "sphere",
  "cylinder", NULL };

#define AT(field) .offset = offsetof(struct vg_settings, field), \
  .size = sizeof ((struct vg_settings *)0)->field
#define REAL .type = VG_PARAM_REAL, .hi = HUGE_SIZE
#define LENGTH REAL, .unit = "length"

static const struct vg_param params[] = {
  { "scale", AT(scale), REAL, .above_lo = 1, .unit = "",
    .help = "factor on the spacing of every source; > 1 is coarser" },
  { "growth", AT(growth), .type = VG_PARAM_REAL, .lo = 1, .hi = 10,
    .above_lo = 1, .unit = "",
    .help = "largest ratio of neighbouring edges away from surface and "
            "sources" },
  { "hmin", AT(hmin), LENGTH, .help = "smallest edge; 0: no limit" },
  { "hmax", AT(hmax), LENGTH, .help = "largest edge; 0: the largest that the "
    "surface (with its farfield) or a source asks for" },
  { "surface_sizes", AT(surface_sizes), .type = VG_PARAM_FLAG, .unit = "",
    .help = "edges of the surface grow into the volume" },
  { "d3m_sources", AT(d3m_sources), .type = VG_PARAM_FLAG, .unit = "",
    .help = "use sources and ifact of the .d3m besides those given here" },
  { "weld", AT(weld), LENGTH,
    .help = "merge points closer than this; 0: only equal ones" },
  { "repair", AT(repair), .type = VG_PARAM_FLAG, .unit = "",
    .help = "mend what needs no guess: orientation, unused and duplicate "
            "items" },
  { "optimise", AT(optimise), .type = VG_PARAM_COUNT, .hi = 100,
    .unit = "sweeps", .help = "sweeps of smoothing and swapping after the "
                              "fill" },
  { "max_cells", AT(max_cells), .type = VG_PARAM_COUNT, .hi = 9e15,
    .unit = "cells", .help = "stop rather than make more; 0: no limit" },
  { "write", AT(write), .type = VG_PARAM_TEXT, .unit = "",
    .help = "files to write, separated by commas" },
};

#undef AT
#define AT(field) .offset = offsetof(struct vg_farfield_row, field), \
  .size = sizeof ((struct vg_farfield_row *)0)->field
#define POINT(name, field, k, about) \
  { name, AT(field[k]), \
    .type = VG_PARAM_REAL, .lo = -HUGE_SIZE, .hi = HUGE_SIZE, .optional = 1, \
    .unit = "length", .help = about }

static const struct vg_param farfield_columns[] = {
  { "kind", AT(kind), .type = VG_PARAM_WORD, .words = domain_words,
    .unit = "", .required = 1,
    .help = "auto (only around a body that stands alone), none, sphere or "
            "box" },
  { "lengths", AT(lengths), REAL, .above_lo = 1, .unit = "body lengths",
    .help = "radius, or half width of the box" },
  { "size", AT(size), LENGTH, .help = "the same as a length; 0: by lengths" },
  { "spacing", AT(spacing), LENGTH,
    .help = "edge on the farfield; 0: what growth from the body gives" },
  POINT("x", centre, 0, "centre; -: that of the body"),
  POINT("y", centre, 1, "centre"), POINT("z", centre, 2, "centre"),
  POINT("xlo", lo, 0, "lower corner of a box given outright"),
  POINT("ylo", lo, 1, "lower corner"), POINT("zlo", lo, 2, "lower corner"),
  POINT("xhi", hi, 0, "upper corner"), POINT("yhi", hi, 1, "upper corner"),
  POINT("zhi", hi, 2, "upper corner"),
};

#undef AT
#define AT(field) .offset = offsetof(struct vg_patch_row, field), \
  .size = sizeof ((struct vg_patch_row *)0)->field

static const struct vg_param patch_columns[] = {
  { "id", AT(id), .type = VG_PARAM_ID, .lo = INT32_MIN, .hi = INT32_MAX,
    .unit = "", .required = 1, .help = "number of the patch in the surface "
                                       "file" },
  { "bc", AT(bc), .type = VG_PARAM_ID, .lo = -9999, .hi = 99999,
    .optional = 1, .unit = "", .help = "boundary condition, USM3D code (0 "
    "freestream, 1 symmetry, 3 farfield, 4 viscous wall, 5 inviscid wall) or "
    "FUN3D code (3000 to 7999, or below 0); -: as the input says" },
  { "name", AT(name), .type = VG_PARAM_TEXT, .unit = "",
    .help = "name; \"\": as the input says" },
};

#undef AT
#undef POINT
#define AT(field) .offset = offsetof(struct vg_source, field), \
  .size = sizeof ((struct vg_source *)0)->field
#define ANY(name, field, units, about) \
  { name, AT(field), .type = VG_PARAM_REAL, .lo = -HUGE_SIZE, \
    .hi = HUGE_SIZE, .unit = units, .help = about }

static const struct vg_param source_columns[] = {
  { "kind", AT(kind), .type = VG_PARAM_WORD, .words = source_words,
    .unit = "", .required = 1, .help = "vgrid_node and vgrid_line follow "
    "VGRID's inverse-square law; point, line, triangle, box, sphere and "
    "cylinder (a cone where r0 and r1 differ) grow at a bounded rate" },
  ANY("x0", p0[0], "length", "first point, centre or lower corner"),
  ANY("y0", p0[1], "length", "first point"),
  ANY("z0", p0[2], "length", "first point"),
  ANY("x1", p1[0], "length", "second point (line, triangle, cylinder) or "
                             "upper corner (box)"),
  ANY("y1", p1[1], "length", "second point"),
  ANY("z1", p1[2], "length", "second point"),
  ANY("x2", p2[0], "length", "third point (triangle)"),
  ANY("y2", p2[1], "length", "third point"),
  ANY("z2", p2[2], "length", "third point"),
  { "h0", AT(h0), LENGTH, .above_lo = 1, .required = 1,
    .help = "edge at the first point, or inside the shape" },
  { "h1", AT(h1), LENGTH, .help = "edge at the second point; 0: as h0" },
  { "r0", AT(r0), LENGTH, .help = "radius in which h0 holds" },
  { "r1", AT(r1), LENGTH, .help = "radius at the second point (cylinder)" },
  { "growth", AT(growth), .type = VG_PARAM_REAL, .hi = 10, .unit = "",
    .help = "growth of this source, > 1; 0: the global one" },
  ANY("an", an, "", "weight of a vgrid source"),
  ANY("bn", bn, "", "VGRID: bias intensity, kept as read"),
  ANY("alpha", alpha, "", "VGRID: directional bias, kept as read"),
  ANY("stretch", stretch, "", "VGRID: stretching flag, kept as read"),
  ANY("sp0", sp0, "length", "VGRID: second spacing at point 1, as read"),
  ANY("sp1", sp1, "length", "VGRID: second spacing at point 2, as read"),
  ANY("ux", u[0], "", "VGRID: bias vector, as read"),
  ANY("uy", u[1], "", "VGRID: bias vector, as read"),
  ANY("uz", u[2], "", "VGRID: bias vector, as read"),
  ANY("px", p[0], "", "VGRID: stretching vector, as read"),
  ANY("py", p[1], "", "VGRID: stretching vector, as read"),
  ANY("pz", p[2], "", "VGRID: stretching vector, as read"),
  ANY("delta1_0", layer0[0], "length", "first layer at point 1, as read"),
  ANY("rate1_0", layer0[1], "", "layer rate 1 at point 1, as read"),
  ANY("rate2_0", layer0[2], "", "layer rate 2 at point 1, as read"),
  ANY("delta1_1", layer1[0], "length", "first layer at point 2, as read"),
  ANY("rate1_1", layer1[1], "", "layer rate 1 at point 2, as read"),
  ANY("rate2_1", layer1[2], "", "layer rate 2 at point 2, as read"),
  { "group", AT(group), .type = VG_PARAM_TEXT, .unit = "",
    .help = "name of the group, for people" },
};

#define COUNT(a) (sizeof (a) / sizeof *(a))

static const struct vg_table tables[VG_TABLE_N] = {
  [VG_TABLE_FARFIELD] = { "farfield", "The outer boundary. One line.",
    farfield_columns, COUNT(farfield_columns),
    sizeof (struct vg_farfield_row) },
  [VG_TABLE_PATCHES] = { "patches", "Names and boundary conditions; they win "
    "over the .mapbc file.", patch_columns, COUNT(patch_columns),
    sizeof (struct vg_patch_row) },
  [VG_TABLE_SOURCES] = { "sources", "Spacing in the volume. - or no "
    "column: the default.", source_columns,
    COUNT(source_columns), sizeof (struct vg_source) },
};

const struct vg_param *vg_settings_params(size_t *n)
{
  *n = COUNT(params);
  return params;
}

const struct vg_table *vg_settings_table(enum vg_table_kind kind)
{
  return &tables[kind];
}

void vg_settings_row_default(enum vg_table_kind kind, void *row)
{
  struct vg_farfield_row far = { .kind = VG_DOMAIN_AUTO, .lengths = 20 };
  struct vg_patch_row patch = { .bc = VG_BC_NONE };
  struct vg_source source = { .kind = VG_SOURCE_POINT, .an = 1 };

  for (int k = 0; k < 3; k++)
    far.centre[k] = far.lo[k] = far.hi[k] = NAN;
  switch (kind) {
  case VG_TABLE_FARFIELD: memcpy(row, &far, sizeof far); break;
  case VG_TABLE_PATCHES: memcpy(row, &patch, sizeof patch); break;
  case VG_TABLE_SOURCES: memcpy(row, &source, sizeof source); break;
  case VG_TABLE_N: break;
  }
}

void vg_settings_default(struct vg_settings *s)
{
  const struct vg_sizing_options sizing = VG_SIZING_OPTIONS_INIT;
  const struct vg_fill_options fill = VG_FILL_OPTIONS_INIT;

  memset(s, 0, sizeof *s);
  s->scale = sizing.scale;
  s->growth = sizing.growth;
  s->surface_sizes = sizing.from_surface;
  s->d3m_sources = 1;
  s->repair = 1;
  s->optimise = fill.optimise;
  snprintf(s->title, sizeof s->title, "untitled");
  snprintf(s->write, sizeof s->write, "cogsg,b8.ugrid");
  vg_settings_row_default(VG_TABLE_FARFIELD, &s->farfield);
}

void vg_settings_release(struct vg_settings *s)
{
  free(s->source);
  free(s->patch);
  memset(s, 0, sizeof *s);
}

vg_status vg_settings_add(struct vg_settings *s, enum vg_table_kind kind,
                          const void *row, struct vg_error *err)
{
  int refused = 0;

  switch (kind) {
  case VG_TABLE_FARFIELD:
    memcpy(&s->farfield, row, sizeof s->farfield);
    break;
  case VG_TABLE_PATCHES:
    refused = vg_reserve(&s->patch, &s->cap_patch, s->n_patch + 1,
                         sizeof *s->patch);
    if (!refused) memcpy(&s->patch[s->n_patch++], row, sizeof *s->patch);
    break;
  case VG_TABLE_SOURCES:
    refused = vg_reserve(&s->source, &s->cap_source, s->n_source + 1,
                         sizeof *s->source);
    if (refused) break;
    memcpy(&s->source[s->n_source], row, sizeof *s->source);
    if (s->source[s->n_source].h1 == 0)
      s->source[s->n_source].h1 = s->source[s->n_source].h0;
    s->n_source++;
    break;
  case VG_TABLE_N:
    break;
  }
  return refused ? vg_fail_memory(err, "the settings") : VG_OK;
}

const void *vg_settings_row(const struct vg_settings *s,
                            enum vg_table_kind kind, size_t i)
{
  if (kind == VG_TABLE_FARFIELD) return &s->farfield;
  if (kind == VG_TABLE_PATCHES) return &s->patch[i];
  return &s->source[i];
}

size_t vg_settings_rows(const struct vg_settings *s, enum vg_table_kind kind)
{
  if (kind == VG_TABLE_FARFIELD) return 1;
  return kind == VG_TABLE_PATCHES ? s->n_patch : s->n_source;
}

static int n_given(const double v[3])
{
  return !isnan(v[0]) + !isnan(v[1]) + !isnan(v[2]);
}

static int compare_id(const void *a, const void *b)
{
  int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;

  return (x > y) - (x < y);
}

static vg_status check_patches(const struct vg_settings *s,
                               struct vg_error *err)
{
  int32_t *id = vg_alloc(s->n_patch, sizeof *id), twice = 0;
  int found = 0;

  if (!id) return vg_fail_memory(err, "the patch table");
  for (size_t i = 0; i < s->n_patch; i++) id[i] = s->patch[i].id;
  qsort(id, s->n_patch, sizeof *id, compare_id);
  for (size_t i = 1; i < s->n_patch && !found; i++)
    if (id[i] == id[i - 1]) found = 1, twice = id[i];
  free(id);
  if (!found) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "patches: patch %d is listed twice; "
                 "remove one of its lines", (int)twice);
}

vg_status vg_settings_check(const struct vg_settings *s, struct vg_error *err)
{
  const struct vg_farfield_row *f = &s->farfield;
  int centre = n_given(f->centre), lo = n_given(f->lo), hi = n_given(f->hi);

  if (s->hmin > 0 && s->hmax > 0 && s->hmin > s->hmax)
    return vg_fail(err, VG_ERR_INPUT, "hmin %g is larger than hmax %g; "
                   "swap them or set one to 0", s->hmin, s->hmax);
  if (centre % 3)
    return vg_fail(err, VG_ERR_INPUT, "farfield: x, y and z belong together; "
                   "give all three or none");
  if (lo != hi || lo % 3)
    return vg_fail(err, VG_ERR_INPUT, "farfield: the corners xlo ylo zlo and "
                   "xhi yhi zhi belong together; give all six or none");
  for (int k = 0; lo && k < 3; k++)
    if (!(f->lo[k] < f->hi[k]))
      return vg_fail(err, VG_ERR_INPUT, "farfield: the lower corner must be "
                     "below the upper one in %c", "xyz"[k]);
  if (lo && f->kind != VG_DOMAIN_BOX)
    return vg_fail(err, VG_ERR_INPUT, "farfield: corners are given, but kind "
                   "is %s; set kind to box", domain_words[f->kind]);
  for (size_t i = 0; i < s->n_source; i++)
    if (s->source[i].growth != 0 && !(s->source[i].growth > 1))
      return vg_fail(err, VG_ERR_INPUT, "sources: growth of source %zu is %g; "
                     "it must be above 1, or 0 for the global one", i + 1,
                     s->source[i].growth);
  return s->n_patch ? check_patches(s, err) : VG_OK;
}

struct vg_sizing_options vg_settings_sizing(const struct vg_settings *s)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;

  o.h_min = s->hmin;
  o.h_max = s->hmax;
  o.growth = s->growth;
  o.scale = s->scale;
  o.from_surface = s->surface_sizes;
  return o;
}

struct vg_farfield vg_settings_farfield(const struct vg_settings *s)
{
  const struct vg_farfield_row *row = &s->farfield;
  struct vg_farfield f = VG_FARFIELD_INIT;

  f.kind = row->kind == VG_DOMAIN_NONE ? VG_FARFIELD_NONE
         : row->kind == VG_DOMAIN_BOX ? VG_FARFIELD_BOX : VG_FARFIELD_SPHERE;
  f.lengths = row->lengths;
  f.size = row->size;
  f.spacing = row->spacing;
  f.has_centre = n_given(row->centre) == 3;
  f.has_box = n_given(row->lo) == 3;
  for (int k = 0; k < 3; k++) {
    f.centre[k] = f.has_centre ? row->centre[k] : 0;
    f.lo[k] = f.has_box ? row->lo[k] : 0;
    f.hi[k] = f.has_box ? row->hi[k] : 0;
  }
  return f;
}
