/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/settings/settings.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/fill/fill.h"
#include "core/flow/flow.h"
#include "core/mesh/zones.h"
#include "core/remesh/remesh.h"
#include "io/cad/cad.h"
#include "layers/columns/growth_law.h"
#include "layers/expand/join.h"
#include "partition/cut/partition.h"
#include "run/settings/lists.h"
#include "run/settings/patch_names.h"
#include "run/settings/surface_table.h"
#include "run/settings/periodic_table.h"
#include "run/settings/wake_table.h"

#define MACH_MAX 100   /* beyond all flows of continua */
#define HUGE_SIZE 1e60 /* its cube is finite */

static const char *const domain_words[] = { "auto", "none", "sphere", "box",
                                            "mach", "c",    "tunnel", NULL };
/* In the order of enum vg_flow_kind, enum vg_flow_half. */
static const char *const flow_words[] = { "auto", "external", "internal",
                                          NULL };
static const char *const half_words[] = { "auto", "no", "yes", "x",
                                          "y",    "z",  NULL };
/* The axes 2 and 1. */
static const char *const axis_words[] = { "z", "y", NULL };
static const char *const region_words[] = { "one", "all", NULL };
static const char *const wake_words[] = { "no", "auto", NULL };
static const char *const answer_words[] = { "auto", "no", "yes", NULL };
/* In the order of enum vg_cad_unit, of enum vg_cad_patches. */
static const char *const unit_words[] = { "file", "mm",   "cm",   "m",
                                          "km",   "inch", "foot", NULL };
/* In the order of enum vg_tensor_order. */
static const char *const order_words[] = { "file", "medit", "upper", "vtk",
                                           NULL };
static const char *const cad_patch_words[] = { "face",  "name", "colour",
                                               "layer", "part", NULL };
/* In the order of enum vg_cad_solids. */
static const char *const solid_words[] = { "auto", "only", "all", "zones",
                                           NULL };
/* In the order of enum vg_layer_cells. */
static const char *const cell_words[] = { "tets", "mixed", "hex", NULL };
/* In the order of enum vg_decomposition_method, enum vg_partitioner. */
static const char *const decompose_words[] = { "advancing", "discrete",
                                               "octree", NULL };
static const char *const partitioner_words[] = { "metis", "rcb", NULL };
/* In the order of enum vg_growth_law_rule. */
static const char *const rule_words[] = { "no", "even", "workshop", NULL };
static const char *const interface_words[] = { "remesh", "h-refine", NULL };
static const char *const schedule_words[] = { "dynamic", "cyclic", NULL };
/* In the order of enum vg_source_kind. */
static const char *const source_words[] = {
  "vgrid_node", "vgrid_line", "point",    "line",     "triangle",
  "box",        "sphere",     "cylinder", "machcone", NULL
};

#define VG_AT_plain
#define VG_AT_cad cad.
#define VG_AT_layer layer.
#define VG_AT_limit layer.limit.
#define AT(field)                                                              \
  .offset = offsetof(struct vg_settings, field),                               \
  .size = sizeof((struct vg_settings *)0)->field
#define LENGTH .hi = HUGE_SIZE, .unit = "length"
#define LIMIT(least, most, units, about)                                       \
  .keeps_mesh = 1, .lo = least, .hi = most, .optional = 1, .unit = units,      \
  .help = about "; exit status 4 if violated; -: no limit"
#define VG_ROW(type_, place, member, name_, initial, ...)                      \
  { .name = name_,                                                             \
    AT(VG_AT_##place member),                                                  \
    .type = VG_PARAM_##type_,                                                  \
    __VA_ARGS__ },
#define VG_TEXT_ROW(place, member, size_, name_, initial, ...)                 \
  VG_ROW(TEXT, place, member, name_, initial, __VA_ARGS__)

static const struct vg_param params[] = {
#include "run/settings/setting_rows.h"
};
#undef VG_ROW
#undef VG_TEXT_ROW

#undef AT
#define AT(field)                                                              \
  .offset = offsetof(struct vg_farfield_row, field),                           \
  .size = sizeof((struct vg_farfield_row *)0)->field
#define POINT(name, field, k, about)                                           \
  {                                                                            \
    name, AT(field[k]), .type = VG_PARAM_REAL, .lo = -HUGE_SIZE,               \
                        .hi = HUGE_SIZE, .optional = 1, .unit = "length",      \
                        .help = about                                          \
  }

#define EXTENT(name, field, about)                                             \
  {                                                                            \
    name, AT(field), .type = VG_PARAM_REAL, .hi = HUGE_SIZE, .above_lo = 1,    \
                     .optional = 1, .unit = "body lengths", .help = about      \
  }
#define FLOW(name, k, about)                                                   \
  {                                                                            \
    name, AT(flow[k]), .type = VG_PARAM_REAL, .lo = -HUGE_SIZE,                \
                       .hi = HUGE_SIZE, .optional = 1, .unit = "",             \
                       .help = about                                           \
  }

static const struct vg_param farfield_columns[] = {
  { "kind", AT(kind), .use = VG_USE_ALWAYS, .is_common = 1,
    .type = VG_PARAM_WORD, .words = domain_words, .unit = "", .required = 1,
    .help = "Shape of the generated outer boundary: auto (a sphere, only "
            "if the surface has no outer boundary), none, sphere, box, or mach "
            "(swept along the Mach cone, for sonic booms). Of plane sections "
            "also c (half circle upstream, straight downstream) and tunnel (a "
            "box with walls below and above)" },
  { "lengths", AT(lengths), .type = VG_PARAM_REAL, .hi = HUGE_SIZE,
    .above_lo = 1, .unit = "body lengths",
    .help = "Radius of the farfield sphere, or half width of the box or "
            "tunnel" },
  { "size", AT(size), .type = VG_PARAM_REAL, LENGTH,
    .help = "Radius or half width of the farfield as an absolute length; "
            "0: in body lengths" },
  { "spacing", AT(spacing), .type = VG_PARAM_REAL, LENGTH,
    .help = "Edge length on the farfield; 0: the edge length that growth "
            "from the body leads to" },
  POINT("x", centre, 0,
        "Centre of the farfield, or a point of the axis of "
        "kind mach, x; -: centre of the body"),
  POINT("y", centre, 1, "Centre, y"),
  POINT("z", centre, 2, "Centre, z"),
  POINT("xlo", lo, 0, "Lower corner of a box given by its corners, x"),
  POINT("ylo", lo, 1, "Lower corner, y"),
  POINT("zlo", lo, 2, "Lower corner, z"),
  POINT("xhi", hi, 0, "Upper corner, x"),
  POINT("yhi", hi, 1, "Upper corner, y"),
  POINT("zhi", hi, 2, "Upper corner, z"),
  { "mach", AT(mach), .type = VG_PARAM_REAL, .lo = 1, .hi = MACH_MAX,
    .above_lo = 1, .optional = 1, .unit = "",
    .help = "Mach number of the flow, for kind mach" },
  EXTENT("upstream", upstream,
         "Distance of the upstream end of kind mach from the foremost point of "
         "the body; -: 0.5"),
  EXTENT("downstream", downstream,
         "Distance of the downstream end of kind mach from the rearmost point "
         "of the body, on the axis; -: 1"),
  EXTENT("radial", radial, "Radius of kind mach; -: 5"),
  FLOW("ux", 0,
       "Direction of the flow for kind mach, x (any length); -: "
       "along x"),
  FLOW("uy", 1, "Direction of the flow, y"),
  FLOW("uz", 2, "Direction of the flow, z"),
};
#undef EXTENT
#undef FLOW

#undef AT
#define AT(field)                                                              \
  .offset = offsetof(struct vg_patch_row, field),                              \
  .size = sizeof((struct vg_patch_row *)0)->field

static const char *const role_words[] = { "auto",  "wall",      "baffle",
                                          "sheet", "interface", NULL };

static const struct vg_param patch_columns[] = {
  { "id", AT(id), VG_PATCH_COLUMN(struct vg_patch_row, id_name), .required = 1,
    .help = "Number or name of the patch in the surface file (* and ? are "
            "wildcards)" },
  { "bc", AT(bc), .type = VG_PARAM_ID, .lo = -9999, .hi = 99999, .optional = 1,
    .unit = "",
    .help =
      "Boundary condition, as a USM3D code (0 "
      "freestream, 1 symmetry, 3 farfield, 4 viscous wall, 5 inviscid wall) or "
      "a FUN3D code (3000 to 7999, or negative); -: as in the input" },
  { "name", AT(name), .type = VG_PARAM_TEXT, .unit = "",
    .help = "New name of the patch; \"\": as in the input" },
  { "hard", AT(hard), .type = VG_PARAM_FLAG, .unit = "",
    .help = "Keep the borders of this patch when the surface is remeshed" },
  { "role", AT(role), .type = VG_PARAM_WORD, .words = role_words, .unit = "",
    .help =
      "wall: fluid on one side; baffle, sheet, interface: an inner "
      "surface, as in the settings baffles, sheets and zone_interfaces; auto: "
      "by these settings" },
};

#undef AT
#define AT(field)                                                              \
  .offset = offsetof(struct vg_zone_row, field),                               \
  .size = sizeof((struct vg_zone_row *)0)->field
#define SEED(name, k)                                                          \
  {                                                                            \
    name, AT(seed[k]), .type = VG_PARAM_REAL, .lo = -HUGE_SIZE,                \
                       .hi = HUGE_SIZE, .unit = "length", .optional = 1,       \
                       .help = "A point in the zone, " name "; -: by the "     \
                               "name of a solid, with cad_solids zones"        \
  }

static const struct vg_param zone_columns[] = {
  { "name", AT(name), .type = VG_PARAM_TEXT, .unit = "", .required = 1,
    .help = "Name of the zone" },
  SEED("x", 0),
  SEED("y", 1),
  SEED("z", 2),
  { "kind", AT(kind), .type = VG_PARAM_WORD, .words = vg_zone_kind_word,
    .unit = "",
    .help = "fluid, rotating, porous or solid: for formats that have kinds of "
            "zones, and for reports" },
  { "hmax", AT(hmax), .type = VG_PARAM_REAL, LENGTH,
    .help = "Largest edge length in the zone; 0: as elsewhere" },
  { "mesh", AT(mesh), .type = VG_PARAM_WORD, .words = answer_words, .unit = "",
    .help = "no: the zone has no cells, and its interfaces are walls of the "
            "others; auto: no for a solid" },
};
#undef SEED

#undef AT
#define AT(field)                                                              \
  .offset = offsetof(struct vg_layer_row, field),                              \
  .size = sizeof((struct vg_layer_row *)0)->field
#define OWN(name, field, least, most, above, units, about)                     \
  {                                                                            \
    name, AT(field), .type = VG_PARAM_REAL, .lo = least, .hi = most,           \
                     .above_lo = above, .optional = 1, .unit = units,          \
                     .help = about                                             \
  }
#define OWN_LIMIT(member, least, most, units)                                  \
  {                                                                            \
#member, AT(limit.member),                                                 \
      .type = VG_PARAM_REAL, .keeps_mesh = 1, .lo = least, .hi = most,         \
      .optional = 1, .unit = units, .help = "As the setting of this name"      \
  }

static const struct vg_param layer_columns[] = {
  { "id", AT(id), VG_PATCH_COLUMN(struct vg_layer_row, id_name), .required = 1,
    .help = "Number or name of the patch (* and ? are wildcards)" },
  { "grow", AT(grow), .type = VG_PARAM_WORD, .words = answer_words, .unit = "",
    .help = "Grow layers on this patch; auto: by its boundary condition" },
  OWN("first", first, 0, HUGE_SIZE, 1, "length", "As the setting of this name"),
  OWN("y_plus", y_plus, 0, HUGE_SIZE, 1, "", "As the setting of this name"),
  OWN("ratio", ratio, 1, 10, 0, "", "As the setting of this name"),
  OWN("rate1", rate1, 0, 9, 0, "", "As the setting of this name"),
  OWN("rate2", rate2, 0, 9, 0, "", "As the setting of this name"),
  { "count", AT(count), .type = VG_PARAM_COUNT, .hi = VG_LEVELS_MAX,
    .optional = 1, .unit = "layers", .help = "As layer_count" },
  OWN("total", total, 0, HUGE_SIZE, 0, "length", "As layer_total"),
  { "constant", AT(constant), .type = VG_PARAM_COUNT, .lo = 1,
    .hi = VG_LEVELS_MAX, .optional = 1, .unit = "layers",
    .help = "As constant_layers" },
  OWN("cap", cap, 0, 10, 0, "", "As layer_cap"),
  OWN_LIMIT(min_full, 0, 100, "%"),
  OWN_LIMIT(min_any, 0, 100, "%"),
  OWN_LIMIT(min_height, 0, 100, "%"),
  OWN_LIMIT(max_first_error, 0, 1e9, "%"),
  OWN_LIMIT(max_top_ratio, 1, HUGE_SIZE, ""),
};

#undef AT
#undef OWN
#undef OWN_LIMIT
#undef POINT
#define AT(field)                                                              \
  .offset = offsetof(struct vg_source, field),                                 \
  .size = sizeof((struct vg_source *)0)->field
#define ANY(name, field, units, about)                                         \
  {                                                                            \
    name, AT(field), .type = VG_PARAM_REAL, .lo = -HUGE_SIZE, .hi = HUGE_SIZE, \
                     .unit = units, .help = about                              \
  }
/* Members of a source that affect neither the sizing field nor the layers. */
#define AS_READ(name, field, units, about)                                     \
  {                                                                            \
    name, AT(field), .type = VG_PARAM_REAL, .keeps_mesh = 1, .lo = -HUGE_SIZE, \
                     .hi = HUGE_SIZE, .unit = units, .help = about             \
  }

static const struct vg_param source_columns[] = {
  { "kind", AT(kind), .type = VG_PARAM_WORD, .words = source_words, .unit = "",
    .required = 1,
    .help =
      "Shape of the source. vgrid_node and vgrid_line follow "
      "VGRID's inverse-square law; around a point, line, triangle, box, "
      "sphere or cylinder (a cone if r0 and r1 differ) the spacing grows at a "
      "bounded rate. machcone: along the Mach cones of the body, with apexes "
      "from the first to the second point (both 0: those of the body)" },
  ANY("x0", p0[0], "length", "First point, centre or lower corner, x"),
  ANY("y0", p0[1], "length", "First point, y"),
  ANY("z0", p0[2], "length", "First point, z"),
  ANY("x1", p1[0], "length",
      "Second point (line, triangle, cylinder) or "
      "upper corner (box), x"),
  ANY("y1", p1[1], "length", "Second point, y"),
  ANY("z1", p1[2], "length", "Second point, z"),
  ANY("x2", p2[0], "length", "Third point (triangle), x"),
  ANY("y2", p2[1], "length", "Third point, y"),
  ANY("z2", p2[2], "length", "Third point, z"),
  { "h0", AT(h0), .type = VG_PARAM_REAL, LENGTH, .above_lo = 1, .required = 1,
    .help = "Spacing at the first point, or inside the shape" },
  { "h1", AT(h1), .type = VG_PARAM_REAL, LENGTH,
    .help =
      "Spacing at the second point, or at the radius r0 (machcone); 0: as "
      "h0" },
  { "r0", AT(r0), .type = VG_PARAM_REAL, LENGTH,
    .help = "Radius within which the spacing is h0, or at which Mach cones end "
            "(0: that of the farfield)" },
  { "r1", AT(r1), .type = VG_PARAM_REAL, LENGTH,
    .help = "Radius at the second point (cylinder)" },
  { "growth", AT(growth), .type = VG_PARAM_REAL, .hi = 10, .unit = "",
    .help = "Growth around this source, > 1; 0: the global growth" },
  { "mach", AT(mach), .type = VG_PARAM_REAL, .hi = MACH_MAX, .unit = "",
    .help =
      "Mach number of the cones (machcone), > 1; 0: that of the farfield" },
  ANY("an", an, "", "Weight of a VGRID source"),
  AS_READ("bn", bn, "", "VGRID bias intensity; stored, not used"),
  AS_READ("alpha", alpha, "", "VGRID directional bias; stored, not used"),
  ANY("stretch", stretch, "",
      "Edge length along ux uy uz over that across it, which is h0: above 1 "
      "needles, below 1 thin cells; 0 and 1: none. 1 in a VGRID source: its "
      "stretching flag, with sp0, sp1 along px py pz"),
  ANY("sp0", sp0, "length",
      "Spacing of a VGRID source along px py pz at point 1"),
  ANY("sp1", sp1, "length",
      "Spacing of a VGRID source along px py pz at point 2"),
  ANY("ux", u[0], "", "Direction of stretch, x (of VGRID: bias, not used)"),
  ANY("uy", u[1], "", "Direction of stretch, y"),
  ANY("uz", u[2], "", "Direction of stretch, z"),
  ANY("px", p[0], "", "Stretching vector of a VGRID source, x"),
  ANY("py", p[1], "", "Stretching vector of a VGRID source, y"),
  ANY("pz", p[2], "", "Stretching vector of a VGRID source, z"),
  ANY("delta1_0", layer0[0], "length",
      "First layer height at point 1 (with layer_sources)"),
  ANY("rate1_0", layer0[1], "", "Layer rate 1 at point 1"),
  ANY("rate2_0", layer0[2], "", "Layer rate 2 at point 1"),
  ANY("delta1_1", layer1[0], "length",
      "First layer height at point 2 (with layer_sources)"),
  ANY("rate1_1", layer1[1], "", "Layer rate 1 at point 2"),
  ANY("rate2_1", layer1[2], "", "Layer rate 2 at point 2"),
  { "group", AT(group), .type = VG_PARAM_TEXT, .keeps_mesh = 1, .unit = "",
    .help = "Name of a group of sources, used in messages only" },
};

#undef AT
#define AT(field)                                                              \
  .offset = offsetof(struct vg_sweep_row, field),                              \
  .size = sizeof((struct vg_sweep_row *)0)->field
#define LIST(name, field, about)                                               \
  {                                                                            \
    name, AT(field), .type = VG_PARAM_TEXT, .keeps_mesh = 1, .unit = "",       \
                     .help = about                                             \
  }

static const struct vg_param sweep_columns[] = {
  LIST("ranks", ranks, "Numbers of ranks, as in 1,2,4 or 1:64:x2; \"\": 1"),
  LIST("threads", threads, "Numbers of threads per rank; \"\": 1"),
  LIST("bisections", bisections,
       "Numbers of successive bisections; \"\": none"),
  LIST("leaf_cells", leaf_cells,
       "Cells per subdomain; these cases are run in addition to those of "
       "levels; \"\": as the setting"),
  LIST(
    "decompose", decompose,
    "Decomposition methods, as in advancing,discrete; each is run with "
    "every entry of subdomains, in addition to the cases of the other lists; "
    "\"\": as the setting"),
  LIST("subdomains", subdomains, "Numbers of subdomains; \"\": as the setting"),
  LIST("family", family,
       "Levels of a grid family, as in 1:3, dpw:1-6 or hlpw:A-F; \"\": none"),
  { "repeat", AT(repeat), .type = VG_PARAM_COUNT, .keeps_mesh = 1, .hi = 1000,
    .unit = "times", .help = "Number of runs of each case; 0: one" },
};

#undef AT
#define AT(field)                                                              \
  .offset = offsetof(struct vg_adapt_row, field),                              \
  .size = sizeof((struct vg_adapt_row *)0)->field
#define REAL(name, field, of, about)                                           \
  {                                                                            \
    name, AT(field), .type = VG_PARAM_REAL, .keeps_mesh = 1, .optional = 1,    \
                     .hi = 1e300, .unit = of, .help = about                    \
  }

static const struct vg_param adapt_columns[] = {
  LIST("solver", solver,
       "Program that computes the flow on the mesh of a cycle, and its "
       "arguments, separated by blanks; required"),
  LIST("field", field,
       "Fields of the solution that the metric resolves, separated by commas; "
       "\"\": no metric, only first heights follow the solution"),
  LIST("norm", norm, "Norm L^P of the error, 1 to 16 or max; \"\": 2"),
  { "cycles", AT(cycles), .type = VG_PARAM_COUNT, .keeps_mesh = 1, .hi = 1000,
    .unit = "cycles", .help = "Number of meshes and solutions; 0: 4" },
  REAL("cells", cells, "cells",
       "Number of cells outside of layers of the second mesh; -: that of the "
       "first mesh"),
  REAL("cells_ratio", cells_ratio, "",
       "Factor on this number from cycle to cycle; -: 2"),
  REAL("growth", growth, "", "Growth of the metric; -: 1.5"),
  REAL("h_min", h_min, "length", "Least edge length; -: none"),
  REAL("h_max", h_max, "length",
       "Largest edge length; -: the diagonal of the mesh"),
  REAL("aspect_max", aspect_max, "",
       "Largest ratio of two edge lengths at a point; -: 100"),
};
#undef REAL

#define COUNT(a) (sizeof(a) / sizeof *(a))

static const struct vg_setting_table tables[VG_TABLE_N] = {
  [VG_TABLE_FARFIELD] = { "farfield", "The outer boundary. One line.",
                          farfield_columns, COUNT(farfield_columns),
                          sizeof(struct vg_farfield_row) },
  [VG_TABLE_PATCHES] = { "patches",
                         "Names and boundary conditions, which override "
                         "those of the .mapbc file.",
                         patch_columns, COUNT(patch_columns),
                         sizeof(struct vg_patch_row) },
  [VG_TABLE_LAYERS] = { "layers",
                        "Layers of individual patches. - or a missing "
                        "column: the global setting.",
                        layer_columns, COUNT(layer_columns),
                        sizeof(struct vg_layer_row) },
  [VG_TABLE_ZONES] = { "zones", "Zones of cells, which interfaces enclose.",
                       zone_columns, COUNT(zone_columns),
                       sizeof(struct vg_zone_row) },
  [VG_TABLE_SOURCES] = { "sources",
                         "Sources of spacing in the volume. - or a missing "
                         "column: the default.",
                         source_columns, COUNT(source_columns),
                         sizeof(struct vg_source) },
  [VG_TABLE_SWEEP] = { "sweep",
                       "Cases that vanguard sweep runs; other commands "
                       "ignore this table. One line.",
                       sweep_columns, COUNT(sweep_columns),
                       sizeof(struct vg_sweep_row) },
  [VG_TABLE_ADAPT] = { "adapt",
                       "The loop of mesh, flow solver and metric that "
                       "vanguard adapt runs; other commands ignore this "
                       "table. One line.",
                       adapt_columns, COUNT(adapt_columns),
                       sizeof(struct vg_adapt_row) },
};

const struct vg_param *vg_settings_params(size_t *n)
{
  *n = COUNT(params);
  return params;
}

const struct vg_setting_table *vg_settings_table(enum vg_table_kind kind)
{
  assert(kind < VG_TABLE_N);
  if (kind == VG_TABLE_SURFACE) return &vg_surface_table;
  if (kind == VG_TABLE_PERIODIC) return &vg_periodic_table;
  return kind == VG_TABLE_WAKES ? &vg_wake_table : &tables[kind];
}

void vg_settings_row_default(enum vg_table_kind kind, void *row)
{
  struct vg_farfield_row far = { .kind = VG_DOMAIN_AUTO, .lengths = 20 };
  struct vg_patch_row patch = { .bc = VG_BC_NONE };
  struct vg_layer_row layer = {
    0,   VG_ANSWER_AUTO, NAN,           NAN, NAN, NAN,
    NAN, VG_COUNT_NONE,  VG_COUNT_NONE, NAN, NAN, VG_NO_LIMITS,
    ""
  };
  struct vg_surface_row surface = { .adjacent = VG_BC_NONE };
  struct vg_zone_row zone = { .seed = { NAN, NAN, NAN },
                              .kind = VG_ZONE_FLUID };
  struct vg_source source = { .kind = VG_SOURCE_POINT, .an = 1 };
  struct vg_sweep_row sweep = { .repeat = 0 };
  struct vg_adapt_row adapt = { "", "", "", 0, NAN, NAN, NAN, NAN, NAN, NAN };

  assert(kind < VG_TABLE_N && row);
  far.mach = far.upstream = far.downstream = far.radial = NAN;
  for (int k = 0; k < 3; k++)
    far.centre[k] = far.lo[k] = far.hi[k] = far.flow[k] = NAN;
  switch (kind) {
  case VG_TABLE_FARFIELD: memcpy(row, &far, sizeof far); break;
  case VG_TABLE_PATCHES: memcpy(row, &patch, sizeof patch); break;
  case VG_TABLE_LAYERS: memcpy(row, &layer, sizeof layer); break;
  case VG_TABLE_SURFACE: memcpy(row, &surface, sizeof surface); break;
  case VG_TABLE_WAKES: vg_wake_row_default(row); break;
  case VG_TABLE_ZONES: memcpy(row, &zone, sizeof zone); break;
  case VG_TABLE_PERIODIC: vg_periodic_row_default(row); break;
  case VG_TABLE_SOURCES: memcpy(row, &source, sizeof source); break;
  case VG_TABLE_SWEEP: memcpy(row, &sweep, sizeof sweep); break;
  case VG_TABLE_ADAPT: memcpy(row, &adapt, sizeof adapt); break;
  case VG_TABLE_N: break;
  }
}

#define VG_ROW(type, place, member, name, initial, ...)                        \
  s->VG_AT_##place member = initial;
#define VG_TEXT_ROW(place, member, size, name, initial, ...)                   \
  snprintf(s->VG_AT_##place member, size, "%s", initial);

void vg_settings_default(struct vg_settings *s)
{
  const struct vg_sizing_options sizing = VG_SIZING_OPTIONS_INIT;
  const struct vg_fill_options fill = VG_FILL_OPTIONS_INIT;
  const struct vg_cad_options cad = VG_CAD_OPTIONS_INIT;
  const struct vg_remesh_options remesh = VG_REMESH_OPTIONS_INIT;
  const struct vg_layer_options layers = VG_LAYER_OPTIONS_INIT;

  memset(s, 0, sizeof *s);
#include "run/settings/setting_rows.h"
  snprintf(s->title, sizeof s->title, "untitled");
  vg_settings_row_default(VG_TABLE_FARFIELD, &s->farfield);
  vg_settings_row_default(VG_TABLE_ADAPT, &s->adapt);
}

#undef VG_ROW
#undef VG_TEXT_ROW

void vg_settings_release(struct vg_settings *s)
{
  free(s->source);
  free(s->patch);
  free(s->layer_row);
  free(s->surface_row);
  free(s->wake_row);
  free(s->zone);
  free(s->periodic_row);
  memset(s, 0, sizeof *s);
}

/* Append *row to a list of s. */
#define APPEND(list, n, cap)                                                   \
  refused = vg_reserve(&s->list, &s->cap, s->n + 1, sizeof *s->list);          \
  if (!refused) memcpy(&s->list[s->n++], row, sizeof *s->list)

vg_status vg_settings_add(struct vg_settings *s, enum vg_table_kind kind,
                          const void *row, struct vg_error *err)
{
  int refused = 0;

  assert(kind < VG_TABLE_N && row);
  switch (kind) {
  case VG_TABLE_FARFIELD: memcpy(&s->farfield, row, sizeof s->farfield); break;
  case VG_TABLE_PATCHES: APPEND(patch, n_patch, cap_patch); break;
  case VG_TABLE_LAYERS: APPEND(layer_row, n_layer, cap_layer); break;
  case VG_TABLE_SURFACE: APPEND(surface_row, n_surface, cap_surface); break;
  case VG_TABLE_WAKES: APPEND(wake_row, n_wake, cap_wake); break;
  case VG_TABLE_ZONES: APPEND(zone, n_zone, cap_zone); break;
  case VG_TABLE_PERIODIC: APPEND(periodic_row, n_periodic, cap_periodic); break;
  case VG_TABLE_SOURCES:
    APPEND(source, n_source, cap_source);
    if (refused) break;
    if (s->source[s->n_source - 1].h1 == 0)
      s->source[s->n_source - 1].h1 = s->source[s->n_source - 1].h0;
    break;
  case VG_TABLE_SWEEP:
    memcpy(&s->sweep, row, sizeof s->sweep);
    s->n_sweep = 1;
    break;
  case VG_TABLE_ADAPT:
    memcpy(&s->adapt, row, sizeof s->adapt);
    s->n_adapt = 1;
    break;
  case VG_TABLE_N: break;
  }
  return refused ? vg_fail_memory(err, "the settings") : VG_OK;
}
#undef APPEND

const void *vg_settings_row(const struct vg_settings *s,
                            enum vg_table_kind kind, size_t i)
{
  assert(i < vg_settings_rows(s, kind));
  if (kind == VG_TABLE_FARFIELD) return &s->farfield;
  if (kind == VG_TABLE_SWEEP) return &s->sweep;
  if (kind == VG_TABLE_ADAPT) return &s->adapt;
  if (kind == VG_TABLE_PATCHES) return &s->patch[i];
  if (kind == VG_TABLE_LAYERS) return &s->layer_row[i];
  if (kind == VG_TABLE_SURFACE) return &s->surface_row[i];
  if (kind == VG_TABLE_WAKES) return &s->wake_row[i];
  if (kind == VG_TABLE_ZONES) return &s->zone[i];
  if (kind == VG_TABLE_PERIODIC) return &s->periodic_row[i];
  return &s->source[i];
}

size_t vg_settings_rows(const struct vg_settings *s, enum vg_table_kind kind)
{
  assert(kind < VG_TABLE_N);
  if (kind == VG_TABLE_FARFIELD) return 1;
  if (kind == VG_TABLE_SWEEP) return s->n_sweep;
  if (kind == VG_TABLE_ADAPT) return s->n_adapt;
  if (kind == VG_TABLE_LAYERS) return s->n_layer;
  if (kind == VG_TABLE_SURFACE) return s->n_surface;
  if (kind == VG_TABLE_WAKES) return s->n_wake;
  if (kind == VG_TABLE_ZONES) return s->n_zone;
  if (kind == VG_TABLE_PERIODIC) return s->n_periodic;
  return kind == VG_TABLE_PATCHES ? s->n_patch : s->n_source;
}

/* Pairs of settings of which one replaces the other. */
static const size_t pairs[][2] = {
  { offsetof(struct vg_settings, layer.first),
    offsetof(struct vg_settings, layer.y_plus) },
  { offsetof(struct vg_settings, leaf_cells),
    offsetof(struct vg_settings, bisections) },
  { offsetof(struct vg_settings, layer.ratio),
    offsetof(struct vg_settings, layer.rate1) },
  { offsetof(struct vg_settings, layer.ratio),
    offsetof(struct vg_settings, layer.rate2) }
};

int vg_settings_exclude(const struct vg_param *a, const struct vg_param *b)
{
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
    if ((a->offset == pairs[i][0] && b->offset == pairs[i][1]) ||
        (a->offset == pairs[i][1] && b->offset == pairs[i][0]))
      return 1;
  return 0;
}

void vg_settings_override(struct vg_settings *s, const struct vg_param *set)
{
  struct vg_layer_settings *l = &s->layer;
  const void *at = (const char *)s + set->offset;

  assert(set->offset < sizeof *s);
  if (at == &l->first) l->y_plus = 0;
  if (at == &l->y_plus) l->first = 0;
  if (at == &s->leaf_cells) s->bisections = 0;
  if (at == &l->ratio) l->rate1 = l->rate2 = NAN;
  if (at == &l->rate1 || at == &l->rate2) l->ratio = NAN;
}
