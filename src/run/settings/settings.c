#include "run/settings/settings.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/fill/fill.h"
#include "core/flow/flow.h"
#include "core/remesh/remesh.h"
#include "io/cad/cad.h"
#include "layers/columns/law.h"
#include "layers/expand/join.h"
#include "partition/cut/partition.h"
#include "run/settings/lists.h"
#include "run/settings/patch_names.h"
#include "run/settings/surface_table.h"

#define HUGE_SIZE 1e60 /* beyond this the predicates are not safe */

static const char *const domain_words[] = { "auto", "none", "sphere", "box",
                                            NULL };
/* In the order of enum vg_flow_kind, enum vg_flow_half. */
static const char *const flow_words[] = { "auto", "external", "internal",
                                          NULL };
static const char *const half_words[] = { "auto", "no", "yes", "x", "y", "z",
                                          NULL };
static const char *const region_words[] = { "one", "all", NULL };
static const char *const answer_words[] = { "auto", "no", "yes", NULL };
/* In the order of enum vg_cad_unit, of enum vg_cad_patches. */
static const char *const unit_words[] = { "file", "mm", "cm", "m", "km",
                                          "inch", "foot", NULL };
static const char *const cad_patch_words[] = { "face", "name", "colour",
                                               "layer", "part", NULL };
/* In the order of enum vg_layer_cells. */
static const char *const cell_words[] = { "tets", "mixed", NULL };
/* In the order of enum vg_decomposition, enum vg_partitioner. */
static const char *const decompose_words[] = { "advancing", "discrete",
  "octree", NULL };
static const char *const partitioner_words[] = { "metis", "rcb", NULL };
/* In the order of enum vg_law_rule. */
static const char *const rule_words[] = { "no", "even", "workshop", NULL };
static const char *const interface_words[] = { "remesh", "h-refine", NULL };
static const char *const schedule_words[] = { "dynamic", "cyclic", NULL };
/* In the order of enum vg_source_kind. */
static const char *const source_words[] = {
  "vgrid_node", "vgrid_line", "point", "line", "triangle", "box", "sphere",
  "cylinder", NULL };

#define AT(field) .offset = offsetof(struct vg_settings, field), \
  .size = sizeof ((struct vg_settings *)0)->field
#define REAL .type = VG_PARAM_REAL, .hi = HUGE_SIZE
#define LENGTH REAL, .unit = "length"
#define LIMIT(name, least, most, units, about) \
  { #name, AT(layer.limit.name), .type = VG_PARAM_REAL, .lo = least, \
    .hi = most, .optional = 1, .unit = units, .help = about ", else exit " \
    "status 4; -: no limit" }

static const struct vg_param params[] = {
  { "scale", AT(scale), REAL, .above_lo = 1, .unit = "",
    .help = "factor on all sizes: of sources, of a new surface, on a farfield "
            "made here, hmin and hmax; and on growth - 1; > 1 is coarser" },
  { "scale_layers", AT(layer.scale_rule), .type = VG_PARAM_WORD,
    .words = rule_words, .unit = "", .help = "whether scale acts on layers: "
    "first heights times it, constant layers over it, and growth to its power "
    "(even) or as the Drag Prediction Workshops have it" },
  { "growth", AT(growth), .type = VG_PARAM_REAL, .lo = 1, .hi = 10,
    .above_lo = 1, .unit = "",
    .help = "largest ratio of neighbouring edges away from surface and "
            "sources" },
  { "hmin", AT(hmin), LENGTH, .help = "smallest edge; 0: no limit" },
  { "hmax", AT(hmax), LENGTH, .help = "largest edge; 0: the largest that the "
    "surface (with its farfield) or a source asks for" },
  { "surface_sizes", AT(surface_sizes), .type = VG_PARAM_FLAG, .unit = "",
    .help = "edges of the surface grow into the volume" },
  { "d3m_sources", AT(d3m_sources), .use = VG_USE_D3M, .type = VG_PARAM_FLAG,
    .unit = "",
    .help = "use sources and ifact of the .d3m besides those given here" },
  { "sizes", AT(sizes), .type = VG_PARAM_TEXT, .unit = "",
    .argument = "FILE", .help = "edge lengths at the points of a mesh, from "
    "which sizes grow: Medit's .sol or .solb, with the mesh (.meshb, "
    ".b8.ugrid, ...) beside it, or a point array `size` of VTK's .vtu; \"\": "
    "none" },
  { "mapbc", AT(mapbc), .type = VG_PARAM_TEXT, .unit = "",
    .argument = "FILE", .help = "boundary conditions of the patches; \"\": "
    "PROJECT.mapbc where it exists, unless an earlier run of Vanguard wrote "
    "it" },
  { "unit", AT(cad.unit), .type = VG_PARAM_WORD, .words = unit_words,
    .unit = "", .help = "unit of length of the surface of a CAD file, and so "
    "of the mesh; file: as the file has it" },
  { "cad_patches", AT(cad.patches), .type = VG_PARAM_WORD,
    .words = cad_patch_words, .unit = "", .help = "what of a CAD file makes a "
    "patch: each face, or all faces of one name, colour, layer or part" },
  { "cad_tolerance", AT(cad.tolerance), LENGTH, .help = "faces of a CAD file "
    "are sewn along edges that are no farther apart; 0: 1e-6 of its "
    "diagonal" },
  { "cad_chord", AT(cad.chord), .type = VG_PARAM_REAL, .hi = 0.5,
    .unit = "", .help = "distance of the triangles from the curves of a CAD "
    "file, over the size of each curve; 0: 0.0003 where the surface is made "
    "anew, 0.0001 where edges of it are stretched, else 0.002" },
  { "cad_angle", AT(cad.angle), .type = VG_PARAM_REAL, .hi = 60,
    .unit = "degrees", .help = "turn of a CAD curve or face from one edge or "
    "triangle to the next; 15: 24 edges a turn; 0: 8 where the surface is "
    "made anew, else 15" },
  { "cad_seconds", AT(cad.seconds), REAL, .unit = "s",
    .help = "time after which reading CAD is given up; 0: none" },
  { "weld", AT(weld), LENGTH,
    .help = "merge points closer than this; 0: only equal ones" },
  { "wrap", AT(wrap), LENGTH, .help = "put a closed surface around the bodies "
    "that bridges gaps narrower than this and has edges of about this length, "
    "where parts overlap or holes cannot be closed; 0: none" },
  { "repair", AT(repair), .type = VG_PARAM_FLAG, .unit = "",
    .help = "mend what needs no guess: orientation, unused and duplicate "
            "items" },
  { "flow", AT(flow), .type = VG_PARAM_WORD, .words = flow_words, .unit = "",
    .help = "external: the surface is bodies, and the fluid is outside; "
    "internal: the surface bounds the fluid inside it; auto: decided by "
    "conditions and names of patches, nesting and shape of shells, and "
    "orientation where the format defines it; the report lists the evidence" },
  { "half", AT(half), .type = VG_PARAM_WORD, .words = half_words, .unit = "",
    .help = "half models. x, y, z: the symmetry plane lies across this axis, "
    "and a flat cap in it is removed; yes: open edges in one plane x, y or z = "
    "constant lie in the symmetry plane; no: the model is whole, and open "
    "edges are holes; auto: open edges, if the surface meets their plane "
    "steeply and they span a good part of the body, and caps with a symmetry "
    "condition" },
  { "regions", AT(all_regions), .type = VG_PARAM_WORD, .words = region_words,
    .unit = "", .help = "one: sealed cavities are left out, and several "
    "regions of fluid are an error; all: every region of fluid is meshed" },
  { "close_holes", AT(close_holes), .type = VG_PARAM_FLAG, .unit = "",
    .help = "close holes of the surface whose rims are nearly plane; each gets "
    "a patch of its own: cap_1, cap_2, ..." },
  { "surface_swap", AT(swap), .type = VG_PARAM_WORD, .words = answer_words,
    .unit = "", .help = "swap and collapse edges of the surface where its "
    "triangles are bad, without moving it visibly; auto: where layers grow "
    "and there are slivers" },
  { "remesh_surface", AT(remesh), .type = VG_PARAM_WORD,
    .words = answer_words, .unit = "", .help = "make the triangles of the "
    "surface anew to size; ridges, corners and patches stay; auto: those of "
    "CAD, whose faces and curves the new points are put back on" },
  { "surface_tolerance", AT(surface_tolerance), .use = VG_USE_REMESH, LENGTH,
    .help = "largest distance of a new surface from the one given; 0: 1e-4 of "
    "the body's length, or 1/30 of wrap if that is more; nowhere more than "
    "0.05 of the edges" },
  { "surface_size", AT(surface_size), .use = VG_USE_REMESH, LENGTH,
    .help = "largest edge of a new surface; 0: hmax, or 0.02 of the body's "
    "length (of an outer boundary, 0.04 of its own)" },
  { "ridge_angle", AT(ridge_angle), .use = VG_USE_REMESH,
    .type = VG_PARAM_REAL, .lo = 5,
    .hi = 170, .unit = "degrees", .help = "a new surface keeps edges whose "
    "faces differ by this" },
  { "edges_per_turn", AT(per_turn), .use = VG_USE_REMESH,
    .type = VG_PARAM_REAL, .lo = 3,
    .hi = 10000, .unit = "edges", .help = "edges of a new surface around a "
    "full circle" },
  { "gap_edges", AT(gap_edges), .type = VG_PARAM_REAL, .hi = 1000,
    .unit = "edges", .help = "at least so many across the gap between surfaces "
    "that face each other, on a new surface and in space; 0: no matter" },
  { "optimise", AT(optimise), .type = VG_PARAM_COUNT, .hi = 100,
    .unit = "sweeps", .help = "sweeps of smoothing and swapping after the "
                              "fill" },
  { "max_cells", AT(max_cells), .type = VG_PARAM_COUNT, .hi = 9e15,
    .unit = "cells", .help = "stop rather than make more, layers "
    "included; 0: no limit" },
  { "write", AT(write), .type = VG_PARAM_TEXT, .unit = "",
    .check = vg_write_list_check,
    .help = "files to write, separated by commas; auto: cogsg,b8.ugrid, for "
            "mixed cells b8.ugrid" },
  { "report_html", AT(report_html), .type = VG_PARAM_FLAG, .unit = "",
    .help = "write PROJECT.report.html, the run as a page with pictures" },
  { "cells", AT(cells), .type = VG_PARAM_WORD, .words = cell_words,
    .unit = "", .help = "cells of the layers: tets, or mixed (prisms, "
                        "pyramids and tetrahedra)" },
  { "ugrid_tail", AT(ugrid_tail), .type = VG_PARAM_FLAG, .unit = "",
    .help = "number of layer tetrahedra behind the cells of a .ugrid" },
  { "solver_parts", AT(solver_parts), .type = VG_PARAM_COUNT,
    .hi = 2147483647, .unit = "parts", .help = "share the cells out to so many "
    "processes of a solver, no stack of layer cells cut: PROJECT.part.N, and "
    "with the mesh in .vtu and OpenFOAM's cellDecomposition; 0: not" },
  { "mesher", AT(mesher), .type = VG_PARAM_TEXT, .unit = "",
    .check = vg_mesher_name_check, .help = "what fills these parts: builtin, "
    "tetgen, hxt (of gmsh 4.8, where it is installed), or the path of a "
    "plug-in, as in ./it.so; what it does not fill as it should, builtin "
    "fills" },
  { "leaf_cells", AT(leaf_cells), .type = VG_PARAM_COUNT, .hi = 9e15,
    .unit = "cells", .help = "the space outside the layers is cut into parts "
    "of about so many cells, filled in parallel; 0: not at all" },
  { "levels", AT(levels), .use = VG_USE_PLANES, .type = VG_PARAM_COUNT,
    .hi = 30,
    .unit = "bisections", .help = "cut everywhere alike, into 2^levels "
    "parts, instead of by leaf_cells; 0: by leaf_cells" },
  { "split_direction", AT(split_direction), .use = VG_USE_PLANES,
    .type = VG_PARAM_COUNT, .hi = 3,
    .unit = "", .help = "first cut across x (1), y (2) or z (3); 0: where it "
                        "costs least" },
  { "constant_direction", AT(constant_direction), .use = VG_USE_PLANES,
    .type = VG_PARAM_FLAG,
    .unit = "", .help = "all cuts across split_direction" },
  { "decompose", AT(decompose), .type = VG_PARAM_WORD,
    .words = decompose_words, .unit = "", .help = "how the space outside the "
    "layers is parted: advancing: cut by planes of finished cells; discrete: "
    "by the faces of a coarse mesh, dealt out to parts; octree: by octants off "
    "the layers, dealt out to parts, and planes at the layers" },
  { "parts", AT(parts), .type = VG_PARAM_COUNT, .lo = 1, .hi = 1e6,
    .optional = 1, .unit = "parts", .help = "to be filled; advancing: about so "
    "many; octree: those off the layers get their share; -: as many as there "
    "are leaf_cells in the cells expected" },
  { "partitioner", AT(partitioner), .use = VG_USE_PARTS, .type = VG_PARAM_WORD,
    .words = partitioner_words, .unit = "", .help = "who deals out coarse "
    "cells to parts: metis, or rcb (recursive coordinate bisection)" },
  { "coarsening", AT(coarsening), .use = VG_USE_PARTS, .type = VG_PARAM_REAL,
    .hi = 100,
    .unit = "", .help = "sizes of the coarse mesh over those of the mesh, 1 "
    "or more, 0: by the number of parts; octree: widest octants in sizes, 2 or "
    "more, 0: 4" },
  { "interfaces", AT(h_refine), .use = VG_USE_PARTS, .type = VG_PARAM_WORD,
    .words = interface_words, .unit = "", .help = "how faces between parts "
    "get the local size: remesh, or h-refine (edges are halved)" },
  { "schedule", AT(cyclic), .type = VG_PARAM_WORD, .words = schedule_words,
    .unit = "", .help = "who fills which part: dynamic: who is idle takes the "
    "next one; cyclic: all are dealt out in turn when the last one is known, "
    "for comparison; results do not depend on it" },
  { "threads", AT(threads), .type = VG_PARAM_COUNT, .hi = 4096,
    .unit = "threads", .help = "threads of each process; 0: one per core "
    "that it is bound to; results do not depend on it" },
  { "layers", AT(layer.grow), .use = VG_USE_ALWAYS, .type = VG_PARAM_WORD,
    .words = answer_words,
    .unit = "", .help = "viscous layers on the walls; auto: where the project "
    "asks for them (.d3m, a viscous condition, walls) and the first height "
    "is known" },
  { "first", AT(layer.first), LENGTH,
    .help = "height of the first layer; 0: by y_plus" },
  { "y_plus", AT(layer.y_plus), REAL, .unit = "",
    .help = "y+ of the first height, by reynolds and reference_length; 0: "
            "first is given" },
  { "reynolds", AT(layer.reynolds), REAL, .unit = "",
    .help = "Reynolds number of reference_length; 0: unknown, no y+" },
  { "reference_length", AT(layer.length), LENGTH,
    .help = "length to which reynolds refers" },
  { "ratio", AT(layer.ratio), .type = VG_PARAM_REAL, .lo = 1, .hi = 10,
    .optional = 1, .unit = "", .help = "thickness of a layer over that of "
    "the one below; -: 1 + rate1, or what layer_count and layer_total lead "
    "to, or 1.2" },
  { "rate1", AT(layer.rate1), .type = VG_PARAM_REAL, .hi = 9, .optional = 1,
    .unit = "", .help = "VGRID's law, layer j is first * (1 + rate1 (1 + "
    "rate2)^(j-1))^(j-1) thick; -: ratio - 1" },
  { "rate2", AT(layer.rate2), .type = VG_PARAM_REAL, .hi = 9, .optional = 1,
    .unit = "", .help = "the same; -: 0" },
  { "layer_count", AT(layer.count), .type = VG_PARAM_COUNT,
    .hi = VG_LEVELS_MAX, .unit = "layers",
    .help = "number of layers; 0: until they are as thick as the local "
            "edge" },
  { "layer_max", AT(layer.most), .type = VG_PARAM_COUNT, .hi = VG_LEVELS_MAX,
    .unit = "layers", .help = "never more layers than this, VGRID's nlayr; "
                              "0: 250" },
  { "layer_total", AT(layer.total), LENGTH,
    .help = "no layers higher than this together; 0: no limit" },
  { "constant_layers", AT(layer.constant), .type = VG_PARAM_COUNT, .lo = 1,
    .hi = VG_LEVELS_MAX, .unit = "layers",
    .help = "first layers of one thickness, before the growth begins" },
  { "layer_cap", AT(layer.cap), .type = VG_PARAM_REAL, .hi = 10,
    .optional = 1, .unit = "", .help = "largest growth of any layer; 0: "
    "none; -: 1.3, none where the .d3m gives the law" },
  { "walls", AT(layer.walls), .type = VG_PARAM_TEXT, .unit = "",
    .check = vg_patch_list_check,
    .help = "patches with layers, and no others, by number or name, as in "
            "3-12,15,wing*; \"\": by their conditions" },
  { "slip", AT(layer.slip), .type = VG_PARAM_TEXT, .unit = "",
    .check = vg_patch_list_check,
    .help = "patches without layers whatever their condition, as in "
            "4,7-9,flap?" },
  { "fan_angle", AT(layer.fan_angle), .type = VG_PARAM_REAL, .lo = 0,
    .hi = 180, .unit = "degrees", .help = "convex edges that turn by more "
    "than this get several columns per point, fans; 0: only points that no one "
    "direction sees; 180: none" },
  { "layer_gap", AT(layer.gap), .type = VG_PARAM_REAL, .hi = 0.49,
    .above_lo = 1, .unit = "", .help = "share of the distance to a surface "
    "in front that layers may take" },
  { "layer_slope", AT(layer.slope), .type = VG_PARAM_REAL, .hi = 100,
    .above_lo = 1, .unit = "", .help = "by how much the heights of layers at "
    "two neighbours may differ, over the edge between them" },
  { "layer_end", AT(layer.end), .type = VG_PARAM_REAL, .hi = 100,
    .above_lo = 1, .unit = "edges", .help = "layers end before one would be "
    "thicker than this times the local edge" },
  { "layer_smooth", AT(layer.smooth), .type = VG_PARAM_COUNT, .hi = 10000,
    .unit = "sweeps", .help = "sweeps that smooth the directions of the "
                              "layers" },
  { "layer_sources", AT(layer.by_source), .type = VG_PARAM_FLAG, .unit = "",
    .help = "first height and rates from the sources (VGRID's grid 2)" },
  { "file_layers", AT(layer.from_files), .use = VG_USE_ALWAYS,
    .type = VG_PARAM_FLAG, .unit = "",
    .help = "use the layer settings of a .d3m, .surf, .tags or AFLR .bc "
            "where none are given here" },
  LIMIT(min_full, 0, 100, "%", "% of the faces of each wall patch that must "
        "have all layers"),
  LIMIT(min_any, 0, 100, "%", "% of the faces of each wall patch that must "
        "have a layer"),
  LIMIT(min_height, 0, 100, "%", "% of the law's total height that the layers "
        "of each wall patch must reach, in the mean by area"),
  LIMIT(max_first_error, 0, 1e9, "%", "% by which a first height may differ "
        "from what is asked"),
  LIMIT(max_top_ratio, 1, HUGE_SIZE, "", "volume ratio of the cells on both "
        "sides of the layers' end that at most 5 % of the faces of a wall "
        "patch may exceed"),
};

#undef AT
#define AT(field) .offset = offsetof(struct vg_farfield_row, field), \
  .size = sizeof ((struct vg_farfield_row *)0)->field
#define POINT(name, field, k, about) \
  { name, AT(field[k]), \
    .type = VG_PARAM_REAL, .lo = -HUGE_SIZE, .hi = HUGE_SIZE, .optional = 1, \
    .unit = "length", .help = about }

static const struct vg_param farfield_columns[] = {
  { "kind", AT(kind), .use = VG_USE_ALWAYS, .type = VG_PARAM_WORD,
    .words = domain_words, .unit = "", .required = 1,
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
  { "id", AT(id), VG_PATCH_COLUMN(struct vg_patch_row, id_name), .required = 1,
    .help = "patch: its number in the surface file, or its name there (* and "
            "? stand for characters)" },
  { "bc", AT(bc), .type = VG_PARAM_ID, .lo = -9999, .hi = 99999,
    .optional = 1, .unit = "", .help = "boundary condition, USM3D code (0 "
    "freestream, 1 symmetry, 3 farfield, 4 viscous wall, 5 inviscid wall) or "
    "FUN3D code (3000 to 7999, or below 0); -: as the input says" },
  { "name", AT(name), .type = VG_PARAM_TEXT, .unit = "",
    .help = "name; \"\": as the input says" },
  { "hard", AT(hard), .type = VG_PARAM_FLAG, .unit = "", .help = "a surface "
    "that is made anew keeps the borders of this patch" },
};

#undef AT
#define AT(field) .offset = offsetof(struct vg_layer_row, field), \
  .size = sizeof ((struct vg_layer_row *)0)->field
#define OWN(name, field, least, most, above, units, about) \
  { name, AT(field), .type = VG_PARAM_REAL, .lo = least, .hi = most, \
    .above_lo = above, .optional = 1, .unit = units, .help = about }

static const struct vg_param layer_columns[] = {
  { "id", AT(id), VG_PATCH_COLUMN(struct vg_layer_row, id_name), .required = 1,
    .help = "number of the patch, or its name (* and ? stand for characters)" },
  { "grow", AT(grow), .type = VG_PARAM_WORD, .words = answer_words,
    .unit = "", .help = "layers on this patch; auto: by its condition" },
  OWN("first", first, 0, HUGE_SIZE, 1, "length", "as the setting"),
  OWN("y_plus", y_plus, 0, HUGE_SIZE, 1, "", "as the setting"),
  OWN("ratio", ratio, 1, 10, 0, "", "as the setting"),
  OWN("rate1", rate1, 0, 9, 0, "", "as the setting"),
  OWN("rate2", rate2, 0, 9, 0, "", "as the setting"),
  { "count", AT(count), .type = VG_PARAM_COUNT, .hi = VG_LEVELS_MAX,
    .optional = 1, .unit = "layers", .help = "as layer_count" },
  OWN("total", total, 0, HUGE_SIZE, 0, "length", "as layer_total"),
  { "constant", AT(constant), .type = VG_PARAM_COUNT, .lo = 1,
    .hi = VG_LEVELS_MAX, .optional = 1, .unit = "layers",
    .help = "as constant_layers" },
  OWN("cap", cap, 0, 10, 0, "", "as layer_cap"),
  OWN("min_full", limit.min_full, 0, 100, 0, "%", "as the setting"),
  OWN("min_any", limit.min_any, 0, 100, 0, "%", "as the setting"),
  OWN("min_height", limit.min_height, 0, 100, 0, "%", "as the setting"),
  OWN("max_first_error", limit.max_first_error, 0, 1e9, 0, "%",
      "as the setting"),
  OWN("max_top_ratio", limit.max_top_ratio, 1, HUGE_SIZE, 0, "",
      "as the setting"),
};

#undef AT
#undef OWN
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

#undef AT
#define AT(field) .offset = offsetof(struct vg_sweep_row, field), \
  .size = sizeof ((struct vg_sweep_row *)0)->field
#define LIST(name, field, about) \
  { name, AT(field), .type = VG_PARAM_TEXT, .unit = "", .help = about }

static const struct vg_param sweep_columns[] = {
  LIST("ranks", ranks, "numbers of ranks, as in 1,2,4 or 1:64:x2; \"\": 1"),
  LIST("threads", threads, "threads of each rank; \"\": 1"),
  LIST("levels", levels, "levels of bisection; \"\": none"),
  LIST("leaf_cells", leaf_cells, "cells to a leaf; both lists make cases of "
       "their own; \"\": as the setting"),
  LIST("decompose", decompose, "ways to decompose, as in advancing,discrete; "
       "each with all parts, beside cases of the other lists; \"\": as the "
       "setting"),
  LIST("parts", parts, "numbers of parts; \"\": as the setting"),
  LIST("family", family, "levels of a grid family; \"\": none"),
  { "repeat", AT(repeat), .type = VG_PARAM_COUNT, .hi = 1000,
    .unit = "times", .help = "runs of each case; 0: one" },
};

#define COUNT(a) (sizeof (a) / sizeof *(a))

static const struct vg_table tables[VG_TABLE_N] = {
  [VG_TABLE_FARFIELD] = { "farfield", "The outer boundary. One line.",
    farfield_columns, COUNT(farfield_columns),
    sizeof (struct vg_farfield_row) },
  [VG_TABLE_PATCHES] = { "patches", "Names and boundary conditions; they win "
    "over the .mapbc file.", patch_columns, COUNT(patch_columns),
    sizeof (struct vg_patch_row) },
  [VG_TABLE_LAYERS] = { "layers", "Layers of single patches. - or "
    "no column: the global one.", layer_columns,
    COUNT(layer_columns), sizeof (struct vg_layer_row) },
  [VG_TABLE_SOURCES] = { "sources", "Spacing in the volume. - or no "
    "column: the default.", source_columns,
    COUNT(source_columns), sizeof (struct vg_source) },
  [VG_TABLE_SWEEP] = { "sweep", "What vanguard sweep runs, of which other "
    "commands take no notice. One line.", sweep_columns,
    COUNT(sweep_columns), sizeof (struct vg_sweep_row) },
};

const struct vg_param *vg_settings_params(size_t *n)
{
  *n = COUNT(params);
  return params;
}

const struct vg_table *vg_settings_table(enum vg_table_kind kind)
{
  return kind == VG_TABLE_SURFACE ? &vg_surface_table : &tables[kind];
}

void vg_settings_row_default(enum vg_table_kind kind, void *row)
{
  struct vg_farfield_row far = { .kind = VG_DOMAIN_AUTO, .lengths = 20 };
  struct vg_patch_row patch = { .bc = VG_BC_NONE };
  struct vg_layer_row layer = { 0, VG_ANSWER_AUTO, NAN, NAN, NAN, NAN, NAN,
                                VG_COUNT_NONE, VG_COUNT_NONE, NAN, NAN,
                                VG_NO_LIMITS, "" };
  struct vg_surface_row surface = { .beside = VG_BC_NONE };
  struct vg_source source = { .kind = VG_SOURCE_POINT, .an = 1 };
  struct vg_sweep_row sweep = { .repeat = 0 };

  for (int k = 0; k < 3; k++)
    far.centre[k] = far.lo[k] = far.hi[k] = NAN;
  switch (kind) {
  case VG_TABLE_FARFIELD: memcpy(row, &far, sizeof far); break;
  case VG_TABLE_PATCHES: memcpy(row, &patch, sizeof patch); break;
  case VG_TABLE_LAYERS: memcpy(row, &layer, sizeof layer); break;
  case VG_TABLE_SURFACE: memcpy(row, &surface, sizeof surface); break;
  case VG_TABLE_SOURCES: memcpy(row, &source, sizeof source); break;
  case VG_TABLE_SWEEP: memcpy(row, &sweep, sizeof sweep); break;
  case VG_TABLE_N: break;
  }
}

static void default_layers(struct vg_layer_settings *l)
{
  const struct vg_layer_options o = VG_LAYER_OPTIONS_INIT;

  l->ratio = l->rate1 = l->rate2 = l->cap = NAN;
  l->limit = VG_NO_LIMITS;
  l->constant = 1;
  l->fan_angle = o.fan_angle;
  l->gap = o.gap;
  l->end = o.end;
  l->slope = o.slope;
  l->smooth = o.smooth;
  l->from_files = 1;
}

void vg_settings_default(struct vg_settings *s)
{
  const struct vg_sizing_options sizing = VG_SIZING_OPTIONS_INIT;
  const struct vg_fill_options fill = VG_FILL_OPTIONS_INIT;
  const struct vg_cad_options cad = VG_CAD_OPTIONS_INIT;
  const struct vg_remesh_options remesh = VG_REMESH_OPTIONS_INIT;

  memset(s, 0, sizeof *s);
  s->scale = sizing.scale;
  s->growth = sizing.growth;
  s->surface_sizes = sizing.from_surface;
  s->d3m_sources = 1;
  s->cad = (struct vg_cad_settings){ cad.unit, cad.patches, cad.tolerance,
                                     0, 0, cad.seconds };
  s->repair = 1;
  s->ridge_angle = remesh.ridge_angle;
  s->per_turn = remesh.per_turn;
  s->optimise = fill.sweeps;
  s->leaf_cells = VG_LEAF_CELLS;
  s->report_html = 1;
  s->parts = VG_COUNT_NONE;
  snprintf(s->title, sizeof s->title, "untitled");
  snprintf(s->write, sizeof s->write, "auto");
  snprintf(s->mesher, sizeof s->mesher, "builtin");
  default_layers(&s->layer);
  vg_settings_row_default(VG_TABLE_FARFIELD, &s->farfield);
}

void vg_settings_release(struct vg_settings *s)
{
  free(s->source);
  free(s->patch);
  free(s->layer_row);
  free(s->surface_row);
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
  case VG_TABLE_LAYERS:
    refused = vg_reserve(&s->layer_row, &s->cap_layer, s->n_layer + 1,
                         sizeof *s->layer_row);
    if (!refused)
      memcpy(&s->layer_row[s->n_layer++], row, sizeof *s->layer_row);
    break;
  case VG_TABLE_SURFACE:
    refused = vg_reserve(&s->surface_row, &s->cap_surface, s->n_surface + 1,
                         sizeof *s->surface_row);
    if (!refused)
      memcpy(&s->surface_row[s->n_surface++], row, sizeof *s->surface_row);
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
  case VG_TABLE_SWEEP:
    memcpy(&s->sweep, row, sizeof s->sweep);
    s->n_sweep = 1;
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
  if (kind == VG_TABLE_SWEEP) return &s->sweep;
  if (kind == VG_TABLE_PATCHES) return &s->patch[i];
  if (kind == VG_TABLE_LAYERS) return &s->layer_row[i];
  if (kind == VG_TABLE_SURFACE) return &s->surface_row[i];
  return &s->source[i];
}

size_t vg_settings_rows(const struct vg_settings *s, enum vg_table_kind kind)
{
  if (kind == VG_TABLE_FARFIELD) return 1;
  if (kind == VG_TABLE_SWEEP) return s->n_sweep;
  if (kind == VG_TABLE_LAYERS) return s->n_layer;
  if (kind == VG_TABLE_SURFACE) return s->n_surface;
  return kind == VG_TABLE_PATCHES ? s->n_patch : s->n_source;
}

void vg_settings_write(struct vg_settings *s)
{
  if (strcmp(s->write, "auto") != 0) return;
  snprintf(s->write, sizeof s->write, "%s",
           s->cells == VG_LAYER_MIXED ? "b8.ugrid" : "cogsg,b8.ugrid");
}

void vg_settings_override(struct vg_settings *s, const struct vg_param *set)
{
  struct vg_layer_settings *l = &s->layer;
  const void *at = (const char *)s + set->offset;

  if (at == &l->first) l->y_plus = 0;
  if (at == &l->y_plus) l->first = 0;
  if (at == &s->leaf_cells) s->levels = 0;
  if (at == &l->ratio) l->rate1 = l->rate2 = NAN;
  if (at == &l->rate1 || at == &l->rate2) l->ratio = NAN;
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
  f.spacing = row->spacing * s->scale;
  f.symmetry = s->half == VG_HALF_AUTO ? 0 : s->half == VG_HALF_NO ? -1 : 1;
  f.has_centre = f.has_box = 1;
  for (int k = 0; k < 3; k++) {
    f.has_centre &= !isnan(row->centre[k]);
    f.has_box &= !isnan(row->lo[k]);
  }
  for (int k = 0; k < 3; k++) {
    f.centre[k] = f.has_centre ? row->centre[k] : 0;
    f.lo[k] = f.has_box ? row->lo[k] : 0;
    f.hi[k] = f.has_box ? row->hi[k] : 0;
  }
  return f;
}
