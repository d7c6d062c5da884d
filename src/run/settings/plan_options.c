/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/settings/plan_options.h"

#include <assert.h>
#include <math.h>

#include "layers/expand/join.h"
#include "partition/advance/ways.h"

/* Defaults and bounds of struct vg_cad_options for every scale. */
#define FINE_CHORD 3e-4 /* S15: for a surface that is remeshed */
#define FINEST_CHORD                                                           \
  1e-4 /* S45: at which triangles of thin tips do not                          \
          intersect yet */
#define FINE_ANGLE 8.0
#define CHORD_MOST 0.5
#define ANGLE_LEAST 1.0
#define ANGLE_MOST 60.0

#define MOST_TRI 1e8 /* S60: triangles of a remeshed surface in gaps */

/* --- the surface --------------------------------------------------------- */

/* Triangles along a stretched curve are compared with the facets next to it, so
 * these must be finer. */
static int is_stretched(const struct vg_settings *s)
{
  for (size_t i = 0; i < s->n_surface; i++)
    if (s->surface_row[i].stretch > 1) return 1;
  return 0;
}

struct vg_cad_options vg_options_cad(const struct vg_settings *s,
                                     int is_remeshed)
{
  const struct vg_cad_options plain = VG_CAD_OPTIONS_INIT;
  const double scale2 = s->scale * s->scale;
  /* If an edge is longer by a factor S, its arc turns by an angle larger by S
   * and has a rise larger by S * S. */
  double chord = (s->cad.chord > 0 ? s->cad.chord : plain.chord) * scale2;
  double angle = (s->cad.angle > 0 ? s->cad.angle : plain.angle) * s->scale;

  if (is_remeshed && !(s->cad.chord > 0))
    chord = is_stretched(s) ? FINEST_CHORD
                            : fmax(FINEST_CHORD, FINE_CHORD * fmin(scale2, 1));
  if (is_remeshed && !(s->cad.angle > 0)) angle = FINE_ANGLE;
  return (
    struct vg_cad_options){ .unit = s->cad.unit,
                            .solids = s->cad.solids,
                            .patches = s->cad.patches,
                            .is_section = s->cad_section,
                            .tolerance = s->cad.tolerance,
                            .chord = fmin(chord, CHORD_MOST),
                            .angle = fmin(fmax(angle, ANGLE_LEAST), ANGLE_MOST),
                            .seconds = s->cad.seconds };
}

struct vg_surface_check_options vg_options_check(const struct vg_settings *s)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;

  o.repair = s->repair;
  return o;
}

struct vg_flow_options vg_options_flow(const struct vg_settings *s,
                                       int has_cells)
{
  struct vg_flow_options o = { .kind = (enum vg_flow_kind)s->flow,
                               .half = (enum vg_flow_half)s->half,
                               .all_regions = s->all_regions,
                               .repair = s->repair };

  if (o.kind == VG_FLOW_EXTERNAL) {
    o.asked_by = "flow external";
  } else if (o.kind == VG_FLOW_INTERNAL) {
    o.asked_by = "flow internal";
  } else if (s->farfield.kind == VG_DOMAIN_NONE) {
    o.kind = VG_FLOW_INTERNAL;
    o.asked_by = "farfield none";
  } else if (s->farfield.kind != VG_DOMAIN_AUTO) {
    o.kind = VG_FLOW_EXTERNAL;
    o.asked_by = s->farfield.kind == VG_DOMAIN_BOX    ? "farfield box"
               : s->farfield.kind == VG_DOMAIN_MACH   ? "farfield mach"
               : s->farfield.kind == VG_DOMAIN_C      ? "farfield c"
               : s->farfield.kind == VG_DOMAIN_TUNNEL ? "farfield tunnel"
                                                      : "farfield sphere";
  } else if (has_cells) {
    o.kind = VG_FLOW_INTERNAL;
    o.asked_by = "flow internal (implied by a volume mesh as input)";
  }
  return o;
}

struct vg_wrap_options vg_options_wrap(const struct vg_settings *s)
{
  return (struct vg_wrap_options){ .size = s->wrap };
}

/* The largest edge of a remeshed surface; 0: not given. */
static double largest_edge(const struct vg_settings *s)
{
  return s->surface_size > 0 && !(s->hmax > 0 && s->hmax < s->surface_size)
         ? s->surface_size
         : s->hmax;
}

/* A surface with more triangles than the permitted number of cells is rejected
 * before it is remeshed. */
static double most_triangles(const struct vg_settings *s, int is_remeshed)
{
  if (!is_remeshed) return 0;
  return s->max_cells ? fmin((double)s->max_cells, MOST_TRI) : MOST_TRI;
}

struct vg_gap_options vg_options_gaps(const struct vg_settings *s,
                                      int is_remeshed)
{
  return (struct vg_gap_options){ .edges = s->gap_edges / s->scale,
                                  .h_min = s->hmin * s->scale,
                                  .h_max = largest_edge(s) * s->scale,
                                  .most_tri = most_triangles(s, is_remeshed) };
}

struct vg_remesh_options vg_options_remesh(const struct vg_settings *s)
{
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;

  o.tolerance = s->surface_tolerance;
  o.accuracy = s->wrap * VG_WRAP_OFFSET;
  o.feature_angle = s->feature_angle;
  o.per_turn = s->per_turn;
  o.h_min = s->hmin;
  o.h_max = largest_edge(s);
  o.is_requested = s->surface_size > 0;
  o.growth = s->growth;
  o.scale = s->scale;
  o.most_tri = (double)s->max_cells;
  o.n_source = s->n_source;
  o.source = s->source;
  return o;
}

struct vg_farfield vg_options_farfield(const struct vg_settings *s)
{
  const struct vg_farfield_row *row = &s->farfield;
  struct vg_farfield f = VG_FARFIELD_INIT;

  f.kind = row->kind == VG_DOMAIN_NONE ? VG_FARFIELD_NONE
         : row->kind == VG_DOMAIN_BOX  ? VG_FARFIELD_BOX
         : row->kind == VG_DOMAIN_MACH ? VG_FARFIELD_MACH
                                       : VG_FARFIELD_SPHERE;
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
  if (f.kind == VG_FARFIELD_MACH)
    f.extent = (struct vg_mach_extent){ .mach = row->mach,
                                        .flow = { row->flow[0], row->flow[1],
                                                  row->flow[2] },
                                        .upstream = row->upstream,
                                        .downstream = row->downstream,
                                        .radial = row->radial };
  return f;
}

/* --- the mesh ------------------------------------------------------------ */

struct vg_sizing_options vg_options_sizing(const struct vg_settings *s,
                                           const struct vg_size_map *map)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;

  o.h_min = s->hmin;
  o.h_max = s->hmax;
  o.growth = s->growth;
  o.scale = s->scale;
  o.from_surface = s->surface_sizes;
  o.aspect_max = s->aspect_max;
  o.map = map;
  /* A cell has about a fifth of a point. A hundred times the limit is certainly
   * refused by the forecast, also if the box is larger than the domain. */
  o.most_points = 20 * (double)s->max_cells;
  return o;
}

double vg_options_growth(const struct vg_settings *s)
{
  return vg_scaled_growth(s->growth, s->scale);
}

struct vg_layer_options vg_options_layers(const struct vg_settings *s)
{
  struct vg_layer_options o = VG_LAYER_OPTIONS_INIT;

  if (!isnan(s->layer.fan_angle)) o.fan_angle = s->layer.fan_angle;
  else if (s->cells != VG_LAYER_TETS) o.fan_angle = VG_FANS_SHARP;
  if (!isnan(s->layer.end)) o.end = s->layer.end;
  else if (s->cells != VG_LAYER_TETS) o.end = VG_LAYER_END_MIXED;
  o.gap = s->layer.gap;
  o.slope = s->layer.slope;
  o.jump = s->layer.jump;
  o.smooth = (int)s->layer.smooth;
  o.threads = (int)s->threads;
  return o;
}

struct vg_cut_rule vg_options_cuts(const struct vg_settings *s)
{
  return (struct vg_cut_rule){ .leaf_cells = s->bisections
                                             ? 0
                                             : (double)s->leaf_cells,
                               .first_axis = (int)s->split_direction - 1,
                               .constant = s->constant_direction };
}

struct vg_decomposition_options vg_options_decomposition(
  const struct vg_settings *s)
{
  struct vg_decomposition_options o = VG_DECOMPOSITION_OPTIONS_INIT;

  o.n_part = s->subdomains == VG_COUNT_NONE ? 0 : (int)s->subdomains;
  o.partitioner = s->partitioner;
  o.coarsening = s->coarsening;
  o.h_refine = s->h_refine;
  return o;
}

struct vg_partition_options vg_options_partition(const struct vg_settings *s)
{
  struct vg_partition_options o = VG_PARTITION_OPTIONS_INIT;

  assert(s->decompose >= 0 && s->decompose < VG_DECOMPOSITIONS);
  o.rule = vg_options_cuts(s);
  o.levels = (int)s->bisections;
  o.maker = vg_ways[s->decompose].maker;
  o.decomposition = vg_options_decomposition(s);
  o.cyclic = s->cyclic;
  o.sweeps = (int)s->optimise;
  o.max_cells = (uint64_t)s->max_cells;
  return o;
}

struct vg_solver_options vg_options_solver(const struct vg_settings *s)
{
  struct vg_solver_options o = VG_SOLVER_OPTIONS_INIT;

  o.n_part = (uint64_t)s->solver_parts;
  return o;
}

struct vg_slices_options vg_options_slices(const struct vg_settings *s)
{
  return (struct vg_slices_options){ .tail = s->ugrid_tail };
}
