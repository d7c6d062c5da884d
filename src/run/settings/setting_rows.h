/* clang-format off */
/* run/settings/setting_rows.h: the settings that are no tables, one row each.
 *
 * A row is all that a setting needs: settings.h takes the members of its
 * structures from the rows, settings.c their defaults and descriptions. Deck,
 * command line, help, log, the digest of a job and the check of a resumed run
 * walk the descriptions. This file has no guard: it is included once for each
 * of these purposes, with other macros.
 *
 *   VG_ROW(TYPE, PLACE, MEMBER, NAME, DEFAULT, DESCRIPTION...)
 *   VG_TEXT_ROW(PLACE, MEMBER, SIZE, NAME, DEFAULT, DESCRIPTION...)
 *
 * TYPE is REAL, COUNT, FLAG or WORD. PLACE is the structure of the member:
 * plain (vg_settings), cad (vg_cad_settings), layer (vg_layer_settings) or
 * limit (vg_layer_limits, whose members are written by hand because a row of
 * the table `layers` has them, too). DEFAULT may use the local options of
 * vg_settings_default. DESCRIPTION initialises members of struct vg_param; a
 * setting on which the mesh does not depend has .keeps_mesh = 1. */
VG_ROW(REAL, plain, scale, "scale", sizing.scale,
  .hi = HUGE_SIZE, .above_lo = 1, .unit = "", .help = "factor on all sizes: "
  "of sources, of a new surface, on a farfield made here, hmin and hmax; and "
  "on growth - 1; > 1 is coarser")
VG_ROW(WORD, layer, scale_rule, "scale_layers", 0,
  .words = rule_words, .unit = "", .help = "whether scale acts on layers: "
  "first heights times it, constant layers over it, and growth to its power "
  "(even) or as the Drag Prediction Workshops have it")
VG_ROW(REAL, plain, growth, "growth", sizing.growth,
  .lo = 1, .hi = 10, .above_lo = 1, .unit = "", .help = "largest ratio of "
  "neighbouring edges away from surface and sources")
VG_ROW(REAL, plain, hmin, "hmin", 0,
  LENGTH, .help = "smallest edge; 0: no limit")
VG_ROW(REAL, plain, hmax, "hmax", 0,
  LENGTH, .help = "largest edge; 0: the largest that the surface (with its "
  "farfield) or a source asks for")
VG_ROW(FLAG, plain, surface_sizes, "surface_sizes", sizing.from_surface,
  .unit = "", .help = "edges of the surface grow into the volume")
VG_ROW(FLAG, plain, d3m_sources, "d3m_sources", 1,
  .use = VG_USE_D3M, .unit = "", .help = "use sources and ifact of the .d3m "
  "besides those given here")
VG_TEXT_ROW(plain, sizes, VG_LIST_MAX, "sizes", "",
  .unit = "", .argument = "FILE", .help = "edge lengths at the points of a "
  "mesh, from which sizes grow: Medit's .sol or .solb, with the mesh (.meshb, "
  ".b8.ugrid, ...) beside it, or a point array `size` of VTK's .vtu; \"\": "
  "none")
VG_TEXT_ROW(plain, mapbc, VG_LIST_MAX, "mapbc", "",
  .unit = "", .argument = "FILE", .help = "boundary conditions of the "
  "patches; \"\": PROJECT.mapbc where it exists, unless an earlier run of "
  "Vanguard wrote it")
VG_ROW(WORD, cad, unit, "unit", cad.unit,
  .words = unit_words, .unit = "", .help = "unit of length of the surface of "
  "a CAD file, and so of the mesh; file: as the file has it")
VG_ROW(WORD, cad, patches, "cad_patches", cad.patches,
  .words = cad_patch_words, .unit = "", .help = "what of a CAD file makes a "
  "patch: each face, or all faces of one name, colour, layer or part")
VG_ROW(REAL, cad, tolerance, "cad_tolerance", cad.tolerance,
  LENGTH, .help = "faces of a CAD file are sewn along edges that are no "
  "farther apart; 0: 1e-6 of its diagonal")
VG_ROW(REAL, cad, chord, "cad_chord", 0,
  .hi = 0.5, .unit = "", .help = "distance of the triangles from the curves "
  "of a CAD file, over the size of each curve; 0: 0.0003 where the surface is "
  "made anew, 0.0001 where edges of it are stretched, else 0.002")
VG_ROW(REAL, cad, angle, "cad_angle", 0,
  .hi = 60, .unit = "degrees", .help = "turn of a CAD curve or face from one "
  "edge or triangle to the next; 15: 24 edges a turn; 0: 8 where the surface "
  "is made anew, else 15")
VG_ROW(REAL, cad, seconds, "cad_seconds", cad.seconds,
  .keeps_mesh = 1, .hi = HUGE_SIZE, .unit = "s", .help = "time after which "
  "reading CAD is given up; 0: none")
VG_ROW(REAL, plain, weld, "weld", 0,
  LENGTH, .help = "merge points closer than this; 0: only equal ones")
VG_ROW(REAL, plain, wrap, "wrap", 0,
  LENGTH, .help = "put a closed surface around the bodies that bridges gaps "
  "narrower than this and has edges of about this length, where parts overlap "
  "or holes cannot be closed; 0: none")
VG_ROW(FLAG, plain, repair, "repair", 1,
  .unit = "", .help = "mend what needs no guess: orientation, unused and "
  "duplicate items")
VG_ROW(WORD, plain, flow, "flow", 0,
  .words = flow_words, .unit = "", .help = "external: the surface is bodies, "
  "and the fluid is outside; internal: the surface bounds the fluid inside "
  "it; auto: decided by conditions and names of patches, nesting and shape of "
  "shells, and orientation where the format defines it; the report lists the "
  "evidence")
VG_ROW(WORD, plain, half, "half", 0,
  .words = half_words, .unit = "", .help = "half models. x, y, z: the "
  "symmetry plane lies across this axis, and a flat cap in it is removed; "
  "yes: open edges in one plane x, y or z = constant lie in the symmetry "
  "plane; no: the model is whole, and open edges are holes; auto: open edges, "
  "if the surface meets their plane steeply and they span a good part of the "
  "body, and caps with a symmetry condition")
VG_ROW(WORD, plain, all_regions, "regions", 0,
  .words = region_words, .unit = "", .help = "one: sealed cavities are left "
  "out, and several regions of fluid are an error; all: every region of fluid "
  "is meshed")
VG_ROW(FLAG, plain, close_holes, "close_holes", 0,
  .unit = "", .help = "close holes of the surface whose rims are nearly "
  "plane; each gets a patch of its own: cap_1, cap_2, ...")
VG_ROW(WORD, plain, swap, "surface_swap", 0,
  .words = answer_words, .unit = "", .help = "swap and collapse edges of the "
  "surface where its triangles are bad, without moving it visibly; auto: "
  "where layers grow and there are slivers")
VG_ROW(WORD, plain, remesh, "remesh_surface", 0,
  .words = answer_words, .unit = "", .help = "make the triangles of the "
  "surface anew to size; ridges, corners and patches stay; auto: those of "
  "CAD, whose faces and curves the new points are put back on")
VG_ROW(REAL, plain, surface_tolerance, "surface_tolerance", 0,
  .use = VG_USE_REMESH, LENGTH, .help = "largest distance of a new surface "
  "from the one given; 0: 1e-4 of the body's length, or 1/30 of wrap if that "
  "is more; nowhere more than 0.05 of the edges")
VG_ROW(REAL, plain, surface_size, "surface_size", 0,
  .use = VG_USE_REMESH, LENGTH, .help = "largest edge of a new surface; 0: "
  "hmax, or 0.02 of the body's length (of an outer boundary, 0.04 of its own)")
VG_ROW(REAL, plain, feature_angle, "feature_angle", remesh.feature_angle,
  .use = VG_USE_REMESH, .lo = 5, .hi = 170, .unit = "degrees",
  .help = "a new surface keeps edges whose faces differ by this")
VG_ROW(REAL, plain, per_turn, "edges_per_turn", remesh.per_turn,
  .use = VG_USE_REMESH, .lo = 3, .hi = 10000, .unit = "edges",
  .help = "edges of a new surface around a full circle")
VG_ROW(REAL, plain, gap_edges, "gap_edges", 0,
  .hi = 1000, .unit = "edges", .help = "at least so many across the gap "
  "between surfaces that face each other, on a new surface and in space; 0: "
  "no matter")
VG_ROW(COUNT, plain, optimise, "optimise", fill.sweeps,
  .hi = 100, .unit = "sweeps", .help = "sweeps of smoothing and swapping "
  "after the fill")
VG_ROW(COUNT, plain, max_cells, "max_cells", 0,
  .keeps_mesh = 1, .hi = 9e15, .unit = "cells", .help = "stop rather than "
  "make more, layers included; 0: no limit")
VG_TEXT_ROW(plain, write, VG_WRITE_MAX, "write", "auto",
  .keeps_mesh = 1, .unit = "", .check = vg_write_list_check,
  .help = "files to write, separated by commas; auto: cogsg,b8.ugrid, for "
  "mixed cells b8.ugrid")
VG_ROW(FLAG, plain, report_html, "report_html", 1,
  .keeps_mesh = 1, .unit = "", .help = "write PROJECT.report.html, the run as "
  "a page with pictures")
VG_ROW(WORD, plain, cells, "cells", 0,
  .words = cell_words, .unit = "", .help = "cells of the layers: tets, or "
  "mixed (prisms, pyramids and tetrahedra)")
VG_ROW(FLAG, plain, ugrid_tail, "ugrid_tail", 0,
  .keeps_mesh = 1, .unit = "", .help = "number of layer tetrahedra behind the "
  "cells of a .ugrid")
VG_ROW(COUNT, plain, solver_parts, "solver_parts", 0,
  .keeps_mesh = 1, .hi = 2147483647, .unit = "parts",
  .help = "share the cells out to so many processes of a solver, no stack of "
  "layer cells cut: PROJECT.part.N, and with the mesh in .vtu and OpenFOAM's "
  "cellDecomposition; 0: not")
VG_TEXT_ROW(plain, mesher, VG_MESHER_MAX, "mesher", "builtin",
  .unit = "", .check = vg_mesher_name_check, .help = "what fills these parts: "
  "builtin, tetgen, hxt (of gmsh 4.8, where it is installed), or the path of "
  "a plug-in, as in ./it.so; what it does not fill as it should, builtin "
  "fills")
VG_ROW(COUNT, plain, leaf_cells, "leaf_cells", VG_LEAF_CELLS,
  .hi = 9e15, .unit = "cells", .help = "the space outside the layers is cut "
  "into parts of about so many cells, filled in parallel; 0: not at all")
VG_ROW(COUNT, plain, levels, "levels", 0,
  .use = VG_USE_PLANES, .hi = 30, .unit = "bisections",
  .help = "cut everywhere alike, into 2^levels parts, instead of by "
  "leaf_cells; 0: by leaf_cells")
VG_ROW(COUNT, plain, split_direction, "split_direction", 0,
  .use = VG_USE_PLANES, .hi = 3, .unit = "", .help = "first cut across x (1), "
  "y (2) or z (3); 0: where it costs least")
VG_ROW(FLAG, plain, constant_direction, "constant_direction", 0,
  .use = VG_USE_PLANES, .unit = "", .help = "all cuts across split_direction")
VG_ROW(WORD, plain, decompose, "decompose", 0,
  .words = decompose_words, .unit = "", .help = "how the space outside the "
  "layers is parted: advancing: cut by planes of finished cells; discrete: by "
  "the faces of a coarse mesh, dealt out to parts; octree: by octants off the "
  "layers, dealt out to parts, and planes at the layers")
VG_ROW(COUNT, plain, parts, "parts", VG_COUNT_NONE,
  .lo = 1, .hi = 1e6, .optional = 1, .unit = "parts",
  .help = "to be filled; advancing: about so many; octree: those off the "
  "layers get their share; -: as many as there are leaf_cells in the cells "
  "expected")
VG_ROW(WORD, plain, partitioner, "partitioner", 0,
  .use = VG_USE_PARTS, .words = partitioner_words, .unit = "",
  .help = "who deals out coarse cells to parts: metis, or rcb (recursive "
  "coordinate bisection)")
VG_ROW(REAL, plain, coarsening, "coarsening", 0,
  .use = VG_USE_PARTS, .hi = 100, .unit = "", .help = "sizes of the coarse "
  "mesh over those of the mesh, 1 or more, 0: by the number of parts; octree: "
  "widest octants in sizes, 2 or more, 0: 4")
VG_ROW(WORD, plain, h_refine, "interfaces", 0,
  .use = VG_USE_PARTS, .words = interface_words, .unit = "",
  .help = "how faces between parts get the local size: remesh, or h-refine "
  "(edges are halved)")
VG_ROW(WORD, plain, cyclic, "schedule", 0,
  .keeps_mesh = 1, .words = schedule_words, .unit = "",
  .help = "who fills which part: dynamic: who is idle takes the next one; "
  "cyclic: all are dealt out in turn when the last one is known, for "
  "comparison; results do not depend on it")
VG_ROW(COUNT, plain, threads, "threads", 0,
  .keeps_mesh = 1, .hi = 4096, .unit = "threads", .help = "threads of each "
  "process; 0: one per core that it is bound to; results do not depend on it")
VG_ROW(WORD, layer, grow, "layers", 0,
  .use = VG_USE_ALWAYS, .words = answer_words, .unit = "",
  .help = "viscous layers on the walls; auto: where the project asks for them "
  "(.d3m, a viscous condition, walls) and the first height is known")
VG_ROW(REAL, layer, first, "first", 0,
  LENGTH, .help = "height of the first layer; 0: by y_plus")
VG_ROW(REAL, layer, y_plus, "y_plus", 0,
  .hi = HUGE_SIZE, .unit = "", .help = "y+ of the first height, by reynolds "
  "and reference_length; 0: first is given")
VG_ROW(REAL, layer, reynolds, "reynolds", 0,
  .hi = HUGE_SIZE, .unit = "", .help = "Reynolds number of reference_length; "
  "0: unknown, no y+")
VG_ROW(REAL, layer, length, "reference_length", 0,
  LENGTH, .help = "length to which reynolds refers")
VG_ROW(REAL, layer, ratio, "ratio", NAN,
  .lo = 1, .hi = 10, .optional = 1, .unit = "", .help = "thickness of a layer "
  "over that of the one below; -: 1 + rate1, or what layer_count and "
  "layer_total lead to, or 1.2")
VG_ROW(REAL, layer, rate1, "rate1", NAN,
  .hi = 9, .optional = 1, .unit = "", .help = "VGRID's law, layer j is first "
  "* (1 + rate1 (1 + rate2)^(j-1))^(j-1) thick; -: ratio - 1")
VG_ROW(REAL, layer, rate2, "rate2", NAN,
  .hi = 9, .optional = 1, .unit = "", .help = "the same; -: 0")
VG_ROW(COUNT, layer, count, "layer_count", 0,
  .hi = VG_LEVELS_MAX, .unit = "layers", .help = "number of layers; 0: until "
  "they are as thick as the local edge")
VG_ROW(COUNT, layer, most, "layer_max", 0,
  .hi = VG_LEVELS_MAX, .unit = "layers", .help = "never more layers than "
  "this, VGRID's nlayr; 0: 250")
VG_ROW(REAL, layer, total, "layer_total", 0,
  LENGTH, .help = "no layers higher than this together; 0: no limit")
VG_ROW(COUNT, layer, constant, "constant_layers", 1,
  .lo = 1, .hi = VG_LEVELS_MAX, .unit = "layers", .help = "first layers of "
  "one thickness, before the growth begins")
VG_ROW(REAL, layer, cap, "layer_cap", NAN,
  .hi = 10, .optional = 1, .unit = "", .help = "largest growth of any layer; "
  "0: none; -: 1.3, none where the .d3m gives the law")
VG_TEXT_ROW(layer, walls, VG_LIST_MAX, "walls", "",
  .unit = "", .check = vg_patch_list_check, .help = "patches with layers, and "
  "no others, by number or name, as in 3-12,15,wing*; \"\": by their "
  "conditions")
VG_TEXT_ROW(layer, slip, VG_LIST_MAX, "slip", "",
  .unit = "", .check = vg_patch_list_check, .help = "patches without layers "
  "whatever their condition, as in 4,7-9,flap?")
VG_ROW(REAL, layer, fan_angle, "fan_angle", layers.fan_angle,
  .lo = 0, .hi = 180, .unit = "degrees", .help = "convex edges that turn by "
  "more than this get several columns per point, fans; 0: only points that no "
  "one direction sees; 180: none")
VG_ROW(REAL, layer, gap, "layer_gap", layers.gap,
  .hi = 0.49, .above_lo = 1, .unit = "", .help = "share of the distance to a "
  "surface in front that layers may take")
VG_ROW(REAL, layer, slope, "layer_slope", layers.slope,
  .hi = 100, .above_lo = 1, .unit = "", .help = "by how much the heights of "
  "layers at two neighbours may differ, over the edge between them")
VG_ROW(REAL, layer, end, "layer_end", layers.end,
  .hi = 100, .above_lo = 1, .unit = "edges", .help = "layers end before one "
  "would be thicker than this times the local edge")
VG_ROW(COUNT, layer, smooth, "layer_smooth", layers.smooth,
  .hi = 10000, .unit = "sweeps", .help = "sweeps that smooth the directions "
  "of the layers")
VG_ROW(FLAG, layer, by_source, "layer_sources", 0,
  .unit = "", .help = "first height and rates from the sources (VGRID's grid "
  "2)")
VG_ROW(FLAG, layer, from_files, "file_layers", 1,
  .use = VG_USE_ALWAYS, .unit = "", .help = "use the layer settings of a "
  ".d3m, .surf, .tags or AFLR .bc where none are given here")
VG_ROW(REAL, limit, min_full, "min_full", NAN,
  LIMIT(0, 100, "%", "% of the faces of each wall patch that must "
  "have all layers"))
VG_ROW(REAL, limit, min_any, "min_any", NAN,
  LIMIT(0, 100, "%", "% of the faces of each wall patch that must "
  "have a layer"))
VG_ROW(REAL, limit, min_height, "min_height", NAN,
  LIMIT(0, 100, "%", "% of the law's total height that the layers "
  "of each wall patch must reach, in the mean by area"))
VG_ROW(REAL, limit, max_first_error, "max_first_error", NAN,
  LIMIT(0, 1e9, "%", "% by which a first height may differ "
  "from what is asked"))
VG_ROW(REAL, limit, max_top_ratio, "max_top_ratio", NAN,
  LIMIT(1, HUGE_SIZE, "", "volume ratio of the cells on both "
  "sides of the layers' end that at most 5 % of the faces of a wall "
  "patch may exceed"))
