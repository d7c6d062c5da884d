/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/plan_options.h: converts settings to the options of the modules
 * of core, layers, partition and io. One function fills each structure. The
 * caller sets the members that are not settings ("unset" below): threads,
 * callbacks, arrays of the surface. Functions for the surface take the settings
 * as read, those for the mesh take resolved settings (run/settings/resolved.h).
 * All are pure and thread-safe. */
#ifndef VG_RUN_SETTINGS_OPTIONS_H
#define VG_RUN_SETTINGS_OPTIONS_H

#include "core/flow/flow.h"
#include "core/remesh/gaps.h"
#include "core/remesh/remesh.h"
#include "core/surface/surface_check.h"
#include "core/wrap/wrap.h"
#include "io/cad/cad.h"
#include "io/slices/slices.h"
#include "layers/columns/layers.h"
#include "partition/cut/partition.h"
#include "partition/solver/solver.h"
#include "run/settings/settings.h"

/* --- the surface --------------------------------------------------------- */

/** The tessellation is finer if the surface is remeshed. Unset: note, stop,
 * user. */
struct vg_cad_options vg_options_cad(const struct vg_settings *s,
                                     int is_remeshed);

/** Unset: require_bc, external, threads, stop. */
struct vg_surface_check_options vg_options_check(const struct vg_settings *s);

/** The flow domain that the settings request, also by their farfield. If
 * `has_cells`, the surface is the boundary of a volume mesh and encloses the
 * fluid unless the settings request otherwise. Unset: side, require_bc,
 * threads, stop. */
struct vg_flow_options vg_options_flow(const struct vg_settings *s,
                                       int has_cells);

/** Unset: keep, empty, stop, progress, user. */
struct vg_wrap_options vg_options_wrap(const struct vg_settings *s);

/** Unset: most_place, threads, stop. */
struct vg_gap_options vg_options_gaps(const struct vg_settings *s,
                                      int is_remeshed);

/** Sources are borrowed from s. Unset: all members that depend on the surface,
 * map, threads, stop. */
struct vg_remesh_options vg_options_remesh(const struct vg_settings *s);

/** Unset: stop, user. */
struct vg_farfield vg_options_farfield(const struct vg_settings *s);

/* --- the mesh ------------------------------------------------------------ */

/** map: target edge lengths in addition to the sources; may be NULL; borrowed.
 * Unset: coarseness, threads, team. */
struct vg_sizing_options vg_options_sizing(const struct vg_settings *s,
                                           const struct vg_size_map *map);

/** Growth of the sizing field around samples (core/sizing/sizing_map.h). */
double vg_options_growth(const struct vg_settings *s);

/** Unset: patch, law_at, progress, team. */
struct vg_layer_options vg_options_layers(const struct vg_settings *s);

/** Unset: members that are not settings, and the cell types of the layers. The
 * maker is that of partition/advance/ways.h. */
struct vg_partition_options vg_options_partition(const struct vg_settings *s);

/** Number of subdomains (0: derived from leaf_cells) and decomposition
 * options. */
struct vg_decomposition_options vg_options_decomposition(
  const struct vg_settings *s);

/** Rule for cut planes; the number of bisections is
 * vg_partition_options.levels. */
struct vg_cut_rule vg_options_cuts(const struct vg_settings *s);

/** Unset: threads. */
struct vg_solver_options vg_options_solver(const struct vg_settings *s);

/** Unset: threads. */
struct vg_slices_options vg_options_slices(const struct vg_settings *s);

#endif
