/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* clang-format off */
/* run/settings/setting_rows.h: one row for each plain setting (one that is not
 * a table).
 *
 * A new setting needs nothing but its row: settings.h takes the members of its
 * structures from the rows, settings.c the defaults and descriptions. The deck,
 * the command line, its help, the log, the digest of a job and the check of a
 * resumed run iterate over the descriptions. This file has no include guard: it
 * is included once for each of these purposes, with different macros.
 *
 *   VG_ROW(TYPE, PLACE, MEMBER, NAME, DEFAULT, DESCRIPTION...)
 *   VG_TEXT_ROW(PLACE, MEMBER, SIZE, NAME, DEFAULT, DESCRIPTION...)
 *
 * TYPE is REAL, COUNT, FLAG or WORD. PLACE is the structure of the member:
 * plain (vg_settings), cad (vg_cad_settings), layer (vg_layer_settings) or
 * limit (vg_layer_limits, whose members are written by hand because the rows of
 * the table `layers` contain them too). DEFAULT may use the local variables of
 * vg_settings_default. DESCRIPTION initialises members of struct vg_param; a
 * setting that does not affect the mesh has .keeps_mesh = 1. .topic is the
 * group of its option in the help; .is_common = 1 puts it into the first group,
 * of the most used options. */
VG_ROW(REAL, plain, scale, "scale", sizing.scale,
  .topic = VG_TOPIC_SIZES, .is_common = 1,
  .hi = HUGE_SIZE, .above_lo = 1, .unit = "", .help = "Factor on all target "
  "edge lengths: those of the sources, of a remeshed surface, of a generated "
  "farfield, hmin and hmax; also applied to growth - 1; > 1 is coarser")
VG_ROW(WORD, layer, scale_rule, "scale_layers", 0,
  .words = rule_words, .unit = "", .help = "Rule for the layers if scale is "
  "not 1. no: unchanged; even: first heights times scale, numbers of constant "
  "layers over scale, and growth ratios to the power of scale; workshop: as "
  "even, but with the growth ratios of the AIAA Drag Prediction Workshop "
  "grids")
VG_ROW(REAL, plain, growth, "growth", sizing.growth,
  .topic = VG_TOPIC_SIZES, .is_common = 1,
  .lo = 1, .hi = 10, .above_lo = 1, .unit = "", .help = "Largest ratio of "
  "neighbouring edges away from the surface and the sources")
VG_ROW(REAL, plain, hmin, "hmin", 0,
  .topic = VG_TOPIC_SIZES,
  LENGTH, .help = "Smallest edge length; 0: no limit")
VG_ROW(REAL, plain, hmax, "hmax", 0,
  .topic = VG_TOPIC_SIZES, .is_common = 1,
  LENGTH, .help = "Largest edge length; 0: the largest edge requested by the "
  "surface (including its farfield) or by a source")
VG_ROW(FLAG, plain, surface_sizes, "surface_sizes", sizing.from_surface,
  .topic = VG_TOPIC_SIZES,
  .unit = "", .help = "Start the sizing field in the volume from the edge "
  "lengths of the surface")
VG_ROW(FLAG, plain, d3m_sources, "d3m_sources", 1,
  .topic = VG_TOPIC_SIZES,
  .use = VG_USE_D3M, .unit = "", .help = "Use the sources and ifact of the "
  ".d3m in addition to the sources given here")
VG_ROW(WORD, plain, wakes, "wakes", 0,
  .topic = VG_TOPIC_SIZES,
  .words = wake_words, .unit = "", .help = "Refine the wakes of all trailing "
  "edges, which are found by geometry; auto: with the defaults of the table "
  "wakes, which also has other sizes, lengths and angles of attack")
VG_TEXT_ROW(plain, sizes, VG_LIST_MAX, "sizes", "",
  .topic = VG_TOPIC_SIZES,
  .unit = "", .argument = "FILE", .help = "Target edge lengths at the points "
  "of a background mesh: a Medit .sol or .solb with its mesh (.meshb, "
  ".b8.ugrid, ...) in the same folder, or the point array `size` of a VTK "
  ".vtu. Metrics, which depend on the direction, are a .sol of kind 3, or the "
  "array `metric`; \"\": none")
VG_ROW(WORD, plain, metric_order, "metric_order", 0,
  .topic = VG_TOPIC_SIZES,
  .words = order_words, .unit = "", .help = "Order of the six components of a "
  "metric in the file of sizes. medit: xx xy yy xz yz zz; upper: xx xy xz yy "
  "yz zz; vtk: xx yy zz xy yz xz; file: medit in a .sol, vtk in a .vtu")
VG_ROW(REAL, plain, aspect_max, "aspect_max", sizing.aspect_max,
  .topic = VG_TOPIC_SIZES,
  .lo = 1, .hi = 1e5, .unit = "", .help = "Largest ratio of two edge lengths "
  "at a point, where metrics or stretched sources request lengths that depend "
  "on the direction; larger lengths are reduced")
VG_TEXT_ROW(plain, mapbc, VG_LIST_MAX, "mapbc", "",
  .topic = VG_TOPIC_SURFACE,
  .unit = "", .argument = "FILE", .help = "Boundary conditions of the "
  "patches; \"\": PROJECT.mapbc if it exists, unless an earlier run of "
  "Vanguard wrote it")
VG_TEXT_ROW(plain, baffles, VG_LIST_MAX, "baffles", "",
  .topic = VG_TOPIC_SURFACE,
  .unit = "", .check = vg_patch_list_check,
  .pattern = vg_patch_list_pattern, .help = "Patches that are inner surfaces: "
  "sheets of zero thickness with fluid on both sides, by number or name, as in "
  "7,fin*; each becomes two patches, NAME and NAME_back")
VG_TEXT_ROW(plain, sheets, VG_LIST_MAX, "sheets", "",
  .topic = VG_TOPIC_SURFACE,
  .unit = "", .check = vg_patch_list_check,
  .pattern = vg_patch_list_pattern, .help = "Patches that become named faces "
  "between cells, through which the mesh continues: actuator disks, wakes, "
  "planes for monitors, by number or name, as in 7,disk*")
VG_TEXT_ROW(plain, zone_interfaces, VG_LIST_MAX, "zone_interfaces", "",
  .topic = VG_TOPIC_SURFACE,
  .unit = "", .check = vg_patch_list_check,
  .pattern = vg_patch_list_pattern, .help = "Sheets that enclose zones of "
  "cells, alone or with walls and other patches, by number or name, as in "
  "7,rotor*; the table zones names the zones")
VG_ROW(WORD, cad, unit, "unit", cad.unit,
  .use = VG_USE_ALWAYS, .words = unit_words, .unit = "", .help = "Unit of "
  "length of the mesh. A CAD model, and a surface with a file_unit, are "
  "converted to it; the coordinates of another surface are taken to be in it; "
  "file: that of the file")
VG_ROW(WORD, cad, file_unit, "file_unit", 0,
  .use = VG_USE_ALWAYS, .words = unit_words, .unit = "", .help = "Unit of "
  "length of a surface file that states none (STL, OBJ, meshes); file: not "
  "known")
VG_ROW(WORD, cad, patches, "cad_patches", cad.patches,
  .words = cad_patch_words, .unit = "", .help = "How the faces of a CAD file "
  "form patches: one patch per face, or one for all faces with the same name, "
  "colour, layer or part")
VG_ROW(WORD, cad, solids, "cad_solids", cad.solids,
  .words = solid_words, .unit = "", .help = "Faces of a CAD file with solids "
  "that are read: only those of solids, all, or auto: all but plane faces that "
  "belong to no solid and touch no other face, such as datum planes. zones: "
  "each solid is a zone of cells, and the faces between two of them are "
  "interfaces")
VG_ROW(REAL, cad, tolerance, "cad_tolerance", cad.tolerance,
  LENGTH, .help = "Largest distance between edges of CAD faces that are sewn "
  "together; 0: 1e-6 of the diagonal of the model")
VG_ROW(REAL, cad, chord, "cad_chord", 0,
  .hi = 0.5, .unit = "", .help = "Chord error of CAD curves and faces, "
  "relative to the size of each curve; 0: 0.0003 if the surface is remeshed, "
  "0.0001 if its edges are also stretched, else 0.002")
VG_ROW(REAL, cad, angle, "cad_angle", 0,
  .hi = 60, .unit = "degrees", .help = "Largest angle by which a CAD curve or "
  "face turns from one edge or triangle to the next (15: 24 edges per full "
  "circle); 0: 8 if the surface is remeshed, else 15")
VG_ROW(REAL, cad, seconds, "cad_seconds", cad.seconds,
  .keeps_mesh = 1, .hi = HUGE_SIZE, .unit = "s", .help = "Time limit for "
  "reading a CAD file; 0: 360 s and 60 s per megabyte of the file")
VG_ROW(REAL, plain, weld, "weld", 0,
  .topic = VG_TOPIC_SURFACE,
  LENGTH, .help = "Merge points that are closer than this distance; 0: merge "
  "identical points only")
VG_ROW(REAL, plain, wrap, "wrap", 0,
  .topic = VG_TOPIC_SURFACE,
  LENGTH, .help = "Shrink-wrap the bodies with a closed surface of about this "
  "edge length that bridges gaps narrower than it; for overlapping parts and "
  "holes that cannot be closed; 0: no wrap")
VG_ROW(FLAG, plain, repair, "repair", 1,
  .topic = VG_TOPIC_SURFACE,
  .unit = "", .help = "Make all unambiguous repairs: orientation, unused and "
                      "duplicate points and faces")
VG_ROW(WORD, plain, flow, "flow", 0,
  .topic = VG_TOPIC_SURFACE,
  .words = flow_words, .unit = "", .help = "Flow domain. external: the "
  "surface consists of bodies, and the fluid is outside; internal: the "
  "surface encloses the fluid; auto: decided from boundary conditions, patch "
  "names, nesting and shape of the shells and, where the format defines it, "
  "their orientation; the report lists the evidence")
VG_ROW(WORD, plain, half, "half", 0,
  .topic = VG_TOPIC_SURFACE,
  .words = half_words, .unit = "", .help = "Half model. x, y, z: the symmetry "
  "plane is normal to this axis, and a flat cap in it is removed; yes: open "
  "edges in one plane x, y or z = constant lie in the symmetry plane; no: the "
  "model is complete, and open edges are holes; auto: detected from open "
  "edges that span a good part of the body and whose plane the surface meets "
  "steeply, or from caps with a symmetry condition")
VG_ROW(WORD, plain, all_regions, "regions", 0,
  .topic = VG_TOPIC_SURFACE,
  .words = region_words, .unit = "", .help = "Regions of fluid to mesh. one: "
  "sealed cavities are ignored, and more than one region is an error; all: "
  "every region is meshed")
VG_ROW(FLAG, plain, close_holes, "close_holes", 0,
  .topic = VG_TOPIC_SURFACE,
  .unit = "", .help = "Close holes of the surface whose rims are nearly "
  "plane; each gets a patch of its own: cap_1, cap_2, ...")
VG_ROW(WORD, plain, swap, "surface_swap", 0,
  .topic = VG_TOPIC_SURFACE,
  .words = answer_words, .unit = "", .help = "Swap and collapse edges of the "
  "surface at poor triangles, without visible change of its shape; auto: if "
  "layers grow and the surface has slivers")
VG_ROW(WORD, plain, remesh, "remesh_surface", 0,
  .topic = VG_TOPIC_REMESH, .is_common = 1,
  .words = answer_words, .unit = "", .help = "Remesh the surface to the "
  "target edge lengths, preserving feature edges, corners and patches; auto: "
  "for surfaces from CAD, where new points are projected onto the CAD faces "
  "and curves")
VG_ROW(REAL, plain, surface_tolerance, "surface_tolerance", 0,
  .use = VG_USE_REMESH, LENGTH, .help = "Largest distance of the remeshed "
  "surface from the input surface; 0: 1e-4 of the body length, or 1/30 of "
  "wrap if that is more; nowhere more than 0.05 of the local edge length")
VG_ROW(REAL, plain, surface_size, "surface_size", 0,
  .is_common = 1,
  .use = VG_USE_REMESH, LENGTH, .help = "Largest edge of the remeshed "
  "surface; 0: hmax, or 0.02 of the body length (for an outer boundary 0.04 "
  "of its own length; for bodies inside it the smaller one)")
VG_ROW(REAL, plain, feature_angle, "feature_angle", remesh.feature_angle,
  .use = VG_USE_REMESH, .lo = 5, .hi = 170, .unit = "degrees",
  .help = "The remeshed surface preserves edges whose two faces differ by "
  "more than this angle")
VG_ROW(REAL, plain, per_turn, "edges_per_turn", remesh.per_turn,
  .use = VG_USE_REMESH, .lo = 3, .hi = 10000, .unit = "edges",
  .help = "Edges per full circle on curved parts of the remeshed surface")
VG_ROW(REAL, plain, nose_spacing, "le_spacing", 0,
  .use = VG_USE_SECTION, .hi = 100, .unit = "%",
  .help = "Edge length at the leading edge, in per cent of the chord; 0: by "
  "the curvature")
VG_ROW(REAL, plain, tail_spacing, "te_spacing", 0.2,
  .use = VG_USE_SECTION, .hi = 100, .unit = "%",
  .help = "Edge length at the trailing edge and other corners, in per cent of "
  "the chord; 0: by the curvature")
VG_ROW(COUNT, plain, tail_cells, "te_cells", 0,
  .use = VG_USE_SECTION, .hi = 10000, .unit = "edges",
  .help = "Number of edges across a blunt trailing edge; 0: as many as "
  "te_spacing gives")
VG_ROW(REAL, plain, section_width, "section_width", 0,
  .use = VG_USE_SECTION, LENGTH, .help = "Width of the cells of a mesh in two "
  "dimensions where it is written one cell thick; 0: the largest chord")
VG_ROW(WORD, plain, section_axis, "section_axis", 0,
  .use = VG_USE_SECTION, .words = axis_words, .unit = "",
  .help = "Axis normal to a mesh in two dimensions where it is written one "
  "cell thick. z: the coordinates of the section are x and y; y: they are x "
  "and z, as FUN3D requires")
VG_ROW(FLAG, plain, cad_section, "cad_section", 0,
  .use = VG_USE_CAD, .unit = "", .help = "The curves of a CAD file are a plane "
  "section, for a mesh in two dimensions: its wires, or the edges of its plane "
  "faces")
VG_ROW(REAL, plain, gap_edges, "gap_edges", 0,
  .topic = VG_TOPIC_REMESH,
  .hi = 1000, .unit = "edges", .help = "Minimum number of edges across the "
  "gap between facing surfaces, on the remeshed surface and in the volume; 0: "
  "no requirement")
VG_ROW(COUNT, plain, optimise, "optimise", fill.sweeps,
  .hi = 100, .unit = "sweeps", .help = "Sweeps of smoothing and swapping "
  "after the volume fill")
VG_ROW(COUNT, plain, max_cells, "max_cells", 0,
  .keeps_mesh = 1, .hi = 9e15, .unit = "cells", .help = "Stop if the "
  "mesh, including its layers, would have more cells than "
        "this; 0: no limit")
VG_ROW(REAL, plain, rank_silence, "rank_silence", 60,
  .keeps_mesh = 1, .hi = HUGE_SIZE, .unit = "s", .help = "End the run if a "
  "rank gives no sign of life for this time, because its node or the network "
  "has failed; 0: never")
VG_ROW(REAL, plain, max_memory, "max_memory", 0,
  .keeps_mesh = 1, .hi = HUGE_SIZE, .unit = "GB", .help = "Memory that all "
  "ranks of a node may use together. The run ends before the fill if its "
  "forecast is higher; 0: the free memory of the node, with a tolerance of a "
  "quarter")
VG_TEXT_ROW(plain, write, VG_WRITE_MAX, "write", "auto",
  .topic = VG_TOPIC_OUTPUT, .is_common = 1,
  .keeps_mesh = 1, .unit = "", .check = vg_write_list_check,
  .pattern = vg_write_list_pattern, .help = "Output formats, separated by "
  "commas; auto: cogsg,b8.ugrid, or b8.ugrid for mixed cells")
VG_ROW(FLAG, plain, report_html, "report_html", 1,
  .topic = VG_TOPIC_OUTPUT,
  .keeps_mesh = 1, .unit = "", .help = "Write PROJECT.report.html, a report "
  "of the run with pictures")
VG_ROW(WORD, plain, cells, "cells", 0,
  .is_common = 1,
  .words = cell_words, .unit = "", .help = "Cell types in the layers: tets; "
  "mixed (prisms, pyramids and tetrahedra); or hex (pairs of wall triangles "
  "become quadrilaterals with hexahedra, the others as with mixed)")
VG_ROW(FLAG, plain, ugrid_tail, "ugrid_tail", 0,
  .topic = VG_TOPIC_OUTPUT,
  .keeps_mesh = 1, .unit = "", .help = "Append the number of layer tetrahedra "
  "after the cells of a .ugrid")
VG_ROW(COUNT, plain, solver_parts, "solver_parts", 0,
  .topic = VG_TOPIC_OUTPUT,
  .keeps_mesh = 1, .hi = 2147483647, .unit = "partitions",
  .help = "Partition the mesh for this many flow-solver processes without "
  "cutting a stack of layer cells: writes PROJECT.part.N, a cell array in a "
  ".vtu and OpenFOAM's cellDecomposition; 0: no partition")
VG_TEXT_ROW(plain, mesher, VG_MESHER_MAX, "mesher", "builtin",
  .unit = "", .argument = "NAME", .check = vg_mesher_name_check,
  .pattern = vg_mesher_name_pattern, .help =
  "Mesh generator that fills the subdomains: builtin, tetgen, hxt (of an "
  "installed Gmsh 4.8), or the path of a plug-in, as in ./mymesher.so; "
  "builtin fills every subdomain that the other one fails to fill")
VG_TEXT_ROW(plain, helpers, VG_LIST_MAX, "helpers", "",
  .keeps_mesh = 1, .unit = "", .argument = "FOLDER", .help =
  "Folder of the helper programs vanguard-tetgen and vanguard-wrap; \"\": that "
  "of the environment variable VANGUARD_HELPERS, or else the folder of the "
  "program or its libexec/vanguard")
VG_ROW(COUNT, plain, leaf_cells, "leaf_cells", VG_LEAF_CELLS,
  .topic = VG_TOPIC_PARALLEL,
  .hi = 9e15, .unit = "cells", .help = "Target number of cells per subdomain; "
  "the space outside the layers is divided into subdomains, which are filled "
  "in parallel; 0: not divided")
VG_ROW(COUNT, plain, bisections, "bisections", 0,
  .use = VG_USE_PLANES, .hi = 30, .unit = "bisections",
  .help = "Number of successive bisections: 2^N subdomains, regardless of "
  "leaf_cells; 0: by leaf_cells")
VG_ROW(COUNT, plain, split_direction, "split_direction", 0,
  .use = VG_USE_PLANES, .hi = 3, .unit = "", .help = "Axis normal to the "
  "first cut: 1: x, 2: y, 3: z; 0: chosen by cost")
VG_ROW(FLAG, plain, constant_direction, "constant_direction", 0,
  .use = VG_USE_PLANES, .unit = "", .help = "Make all cuts normal to "
  "split_direction")
VG_ROW(WORD, plain, decompose, "decompose", 0,
  .topic = VG_TOPIC_PARALLEL,
  .words = decompose_words, .unit = "", .help = "Domain decomposition of the "
  "space outside the layers. advancing: recursive cuts by planes of final "
  "cells; discrete: along the faces of a coarse mesh, whose cells are "
  "assigned to subdomains; octree: by octants away from the layers, assigned "
  "to subdomains, and cut planes near the layers")
VG_ROW(COUNT, plain, subdomains, "subdomains", VG_COUNT_NONE,
  .topic = VG_TOPIC_PARALLEL,
  .lo = 1, .hi = 1e6, .optional = 1, .unit = "subdomains",
  .help = "Number of subdomains. advancing: approximate; octree: octants get a "
  "share of them in proportion to their cells; -: expected number of cells "
  "divided by leaf_cells")
VG_ROW(WORD, plain, partitioner, "partitioner", 0,
  .use = VG_USE_PARTS, .words = partitioner_words, .unit = "",
  .help = "Partitioner that assigns the coarse cells to subdomains: metis, or "
  "rcb (recursive coordinate bisection)")
VG_ROW(REAL, plain, coarsening, "coarsening", 0,
  .use = VG_USE_PARTS, .hi = 100, .unit = "", .help = "Coarseness of the "
  "decomposition. discrete: edge length of the coarse mesh over that of the "
  "final mesh, 1 or more (0: derived from the number of subdomains); octree: "
  "width of the largest octants over the local edge length, 2 or more (0: 4)")
VG_ROW(WORD, plain, h_refine, "interfaces", 0,
  .use = VG_USE_PARTS, .words = interface_words, .unit = "",
  .help = "How interfaces between subdomains are refined to the local edge "
  "length: remesh, or h-refine (bisect their edges)")
VG_ROW(WORD, plain, cyclic, "schedule", 0,
  .topic = VG_TOPIC_PARALLEL,
  .keeps_mesh = 1, .words = schedule_words, .unit = "",
  .help = "Assignment of subdomains to workers. dynamic: an idle worker takes "
  "the next one; cyclic: all are assigned in turn once the last one is known, "
  "for comparison. The mesh does not depend on it")
VG_ROW(COUNT, plain, threads, "threads", 0,
  .topic = VG_TOPIC_PARALLEL, .is_common = 1,
  .keeps_mesh = 1, .hi = 4096, .unit = "threads", .help = "Threads per "
  "process; 0: one per core to which the process is bound; the mesh does not "
  "depend on it")
VG_ROW(WORD, layer, grow, "layers", 0,
  .is_common = 1,
  .topic = VG_TOPIC_LAYERS, .use = VG_USE_ALWAYS,
  .words = answer_words, .unit = "",
  .help = "Grow viscous layers on the walls; auto: if the project requests "
  "them (.d3m, a viscous condition, walls) and the first height is known")
VG_ROW(REAL, layer, first, "first", 0,
  .is_common = 1,
  LENGTH, .help = "Height of the first layer; 0: from y_plus")
VG_ROW(REAL, layer, y_plus, "y_plus", 0,
  .is_common = 1,
  .hi = HUGE_SIZE, .unit = "", .help = "y+ of the first height, from reynolds "
  "and reference_length; 0: first is given")
VG_ROW(REAL, layer, reynolds, "reynolds", 0,
  .is_common = 1,
  .hi = HUGE_SIZE, .unit = "", .help = "Reynolds number based on "
  "reference_length; 0: unknown, y+ is not available")
VG_ROW(REAL, layer, length, "reference_length", 0,
  .is_common = 1,
  LENGTH, .help = "Reference length of the Reynolds number")
VG_TEXT_ROW(layer, first_from, VG_LIST_MAX, "first_from", "",
  .unit = "", .argument = "FILE", .help = "Flow solution on an earlier mesh, "
  "whose wall shear corrects the first height of y_plus at each point of the "
  "walls: a .vtu or .vtp with values at the points, or a folder of them; "
  "\"\": the flat-plate estimate")
VG_TEXT_ROW(layer, first_field, VG_LIST_MAX, "first_field", "",
  .unit = "", .argument = "NAME", .help = "Point array of first_from with the "
  "skin friction coefficient, or a vector whose length it is; \"\": cf, Cf, "
  "skin_friction, Skin_Friction_Coefficient or wallShearStress")
VG_ROW(REAL, layer, first_scale, "first_scale", 0,
  .hi = HUGE_SIZE, .unit = "", .help = "Factor that turns the values of "
  "first_field into a skin friction coefficient, such as 2/U^2 for "
  "OpenFOAM's wallShearStress; 0: 1, except for wallShearStress, which needs "
  "a factor")
VG_ROW(REAL, layer, first_bound, "first_bound", 4,
  .lo = 1, .hi = 1000, .unit = "", .help = "Largest factor by which first_from "
  "raises or lowers a first height")
VG_ROW(REAL, layer, ratio, "ratio", NAN,
  .is_common = 1,
  .lo = 1, .hi = 10, .optional = 1, .unit = "", .help = "Growth ratio: height "
  "of a layer over that of the one below it; -: 1 + rate1, or the ratio that "
  "follows from layer_count and layer_total, or 1.2")
VG_ROW(REAL, layer, rate1, "rate1", NAN,
  .hi = 9, .optional = 1, .unit = "", .help = "VGRID's growth law: the height "
  "of layer j is first * (1 + rate1 (1 + rate2)^(j-1))^(j-1); -: ratio - 1")
VG_ROW(REAL, layer, rate2, "rate2", NAN,
  .hi = 9, .optional = 1, .unit = "", .help = "Second rate of VGRID's growth "
  "law, see rate1; -: 0")
VG_ROW(COUNT, layer, count, "layer_count", 0,
  .is_common = 1,
  .hi = VG_LEVELS_MAX, .unit = "layers", .help = "Number of layers; 0: until "
  "a layer is as high as the local edge length")
VG_ROW(COUNT, layer, most, "layer_max", 0,
  .hi = VG_LEVELS_MAX, .unit = "layers", .help = "Upper limit on the number "
  "of layers, VGRID's nlayr; 0: 250")
VG_ROW(REAL, layer, total, "layer_total", 0,
  LENGTH, .help = "Upper limit on the total height of the layers; 0: no limit")
VG_ROW(COUNT, layer, constant, "constant_layers", 1,
  .lo = 1, .hi = VG_LEVELS_MAX, .unit = "layers", .help = "Number of first "
  "layers of equal height, before growth begins")
VG_ROW(REAL, layer, cap, "layer_cap", NAN,
  .hi = 10, .optional = 1, .unit = "", .help = "Upper limit on the growth "
  "ratio of every layer; 0: none; -: 1.3, or none if the .d3m gives the "
  "growth law")
VG_TEXT_ROW(layer, walls, VG_LIST_MAX, "walls", "",
  .is_common = 1,
  .unit = "", .check = vg_patch_list_check,
  .pattern = vg_patch_list_pattern, .help = "Patches with layers, to "
  "the exclusion of all others, by number or name, as in 3-12,15,wing*; \"\": "
  "by boundary condition")
VG_TEXT_ROW(layer, slip, VG_LIST_MAX, "slip", "",
  .unit = "", .check = vg_patch_list_check,
  .pattern = vg_patch_list_pattern, .help = "Patches without layers "
  "regardless of their boundary condition, as in 4,7-9,flap?")
VG_ROW(REAL, layer, fan_angle, "fan_angle", NAN,
  .lo = 0, .hi = 180, .optional = 1, .unit = "degrees", .help = "Convex edges "
  "that turn by more than this angle get fans (several columns per point, "
  "multiple normals); 0: only points from which no single direction sees all "
  "faces; 180: no fans; -: 60 for a plane section, 0 for tetrahedra, otherwise "
  "0 and chains of sharp edges")
VG_ROW(REAL, layer, gap, "layer_gap", layers.gap,
  .hi = 0.49, .above_lo = 1, .unit = "", .help = "Largest fraction of the "
  "distance to the opposite surface that layers may take up")
VG_ROW(REAL, layer, slope, "layer_slope", layers.slope,
  .hi = 100, .above_lo = 1, .unit = "", .help = "Largest difference between "
  "the layer heights at neighbouring points, over the edge between them")
VG_ROW(REAL, layer, jump, "layer_jump", layers.jump,
  .lo = 1, .hi = 1000, .unit = "", .help = "Volume ratio of the cells on both "
  "sides of the layers' end to aim at. Where the height of the layers is "
  "limited, they get fewer levels, up to the requested growth, until it is "
  "met; 1000 keeps all levels")
VG_ROW(REAL, layer, end, "layer_end", NAN,
  .hi = 100, .above_lo = 1, .optional = 1, .unit = "edges", .help = "Layers "
  "end before one would be higher than this times the local edge length; -: "
  "0.95, or 0.6 with mixed cells")
VG_ROW(COUNT, layer, smooth, "layer_smooth", layers.smooth,
  .hi = 10000, .unit = "sweeps", .help = "Sweeps that smooth the directions "
  "of the layers")
VG_ROW(FLAG, layer, by_source, "layer_sources", 0,
  .unit = "", .help = "Take first heights and rates from the sources (VGRID's "
  "grid 2)")
VG_ROW(FLAG, layer, from_files, "file_layers", 1,
  .topic = VG_TOPIC_LAYERS, .use = VG_USE_ALWAYS,
  .unit = "", .help = "Use the layer settings of a "
  ".d3m, .surf, .tags or AFLR .bc where none are given here")
VG_ROW(REAL, limit, min_full, "min_full", NAN,
  LIMIT(0, 100, "%", "Minimum percentage of the faces of each wall patch with "
  "full layers"))
VG_ROW(REAL, limit, min_any, "min_any", NAN,
  LIMIT(0, 100, "%", "Minimum percentage of the faces of each wall patch with "
  "at least one layer"))
VG_ROW(REAL, limit, min_height, "min_height", NAN,
  LIMIT(0, 100, "%", "Minimum mean layer height of each wall patch, weighted "
  "by area, as a percentage of the total height of the growth law"))
VG_ROW(REAL, limit, max_first_error, "max_first_error", NAN,
  LIMIT(0, 1e9, "%", "Maximum deviation of a first height from the requested "
  "one, in per cent"))
VG_ROW(REAL, limit, max_top_ratio, "max_top_ratio", NAN,
  LIMIT(1, HUGE_SIZE, "", "Largest volume ratio of the cells on either side "
  "of the top of the layers, which at most 5 % of the faces of a wall patch "
  "may exceed"))
VG_ROW(REAL, plain, max_non_orthogonality, "max_non_orthogonality", NAN,
  .topic = VG_TOPIC_LIMITS, .use = VG_USE_VOLUME,
  LIMIT(0, 180, "degrees", "Largest angle between the normal of a face of the "
  "mesh and the line between the centres of its cells"))
VG_ROW(REAL, plain, max_skewness, "max_skewness", NAN,
  .topic = VG_TOPIC_LIMITS, .use = VG_USE_VOLUME,
  LIMIT(0, HUGE_SIZE, "", "Largest skewness of a face of the mesh, as defined "
  "by OpenFOAM"))
VG_ROW(REAL, plain, min_face_weight, "min_face_weight", NAN,
  .topic = VG_TOPIC_LIMITS, .use = VG_USE_VOLUME,
  LIMIT(0, 0.5, "", "Smallest weight of the linear interpolation on a face of "
  "the mesh"))
VG_ROW(REAL, plain, min_orthogonal_quality, "min_orthogonal_quality", NAN,
  .topic = VG_TOPIC_LIMITS, .use = VG_USE_VOLUME,
  LIMIT(0, 1, "", "Smallest orthogonal quality of a cell of the mesh, as "
  "defined by Fluent"))
VG_ROW(FLAG, plain, median_dual, "median_dual", 0,
  .topic = VG_TOPIC_LIMITS, .use = VG_USE_VOLUME, .keeps_mesh = 1,
  .unit = "", .help = "Report the orthogonality of the median dual, for "
  "solvers with unknowns in the points (SU2, FUN3D)")
VG_ROW(REAL, plain, min_dual_orthogonality, "min_dual_orthogonality", NAN,
  .topic = VG_TOPIC_LIMITS, .use = VG_USE_VOLUME,
  LIMIT(-90, 90, "degrees", "Smallest orthogonality of the median dual at a "
  "point, as defined by SU2; 90 is best"))
