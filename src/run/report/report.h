/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/report/report.h: reports as text for the terminal and as JSON for
 * programs. */
#ifndef VG_RUN_REPORT_REPORT_H
#define VG_RUN_REPORT_REPORT_H

#include <stdio.h>

#include "core/accuracy/accuracy.h"
#include "core/domain/planar.h"
#include "core/fill/fill.h"
#include "core/flow/flow.h"
#include "core/judge/plane_quality.h"
#include "core/judge/quality.h"
#include "core/judge/sheet_sides.h"
#include "core/judge/zone_quality.h"
#include "core/mesh/mesh.h"
#include "core/surface/surface_check.h"
#include "partition/solver/solver.h"
#include "run/common/json_build.h"
#include "run/layers/layers.h"

#define VG_SHOWN_DEFECTS 3   /* defects of a kind listed in the text */
#define VG_LISTED_DEFECTS 20 /* defects of a kind listed in the JSON */
#define VG_SHOWN_ITEMS 20    /* shells, or patch numbers, listed in the text */
#define VG_SHOWN_FACES 3     /* poor triangles listed in the text */

/** Add a failure to a report: `error`, its message, and `error_kind`, the name
 * of its code (vg_status_name). */
void vg_report_error_json(json_t *report, const struct vg_error *err);

/** The notes of a run, as a list of texts. */
json_t *vg_report_notes_json(const struct vg_notes *notes);

/** Counts of a mesh and its bounding box. */
void vg_report_size_text(FILE *to, const struct vg_mesh *m);
json_t *vg_report_size_json(const struct vg_mesh *m);

/** The same for a mesh of which only the counts are known, and its bounding
 * box. */
void vg_report_counts_text(FILE *to, const struct vg_mesh *m,
                           const double lo[3], const double hi[3]);
json_t *vg_report_counts_json(const struct vg_mesh *m, const double lo[3],
                              const double hi[3]);

/** Number, faces, conditions, area, name and bounding box of every patch; the
 * text lists at most VG_SHOWN_PATCHES. */
#define VG_SHOWN_PATCHES 40
vg_status vg_report_patches_text(FILE *to, const struct vg_mesh *m,
                                 struct vg_error *err);
/** NULL if out of memory. */
json_t *vg_report_patches_json(const struct vg_mesh *m);

/** Sheets of m with the findings r [n_sheet]: number, triangles, cells on the
 * side of the normals ("before") and on the other side, area and name. Without
 * sheets, or if r is NULL, the text is empty and the list has no items. */
void vg_report_sheets_text(FILE *to, const struct vg_mesh *m,
                           const struct vg_sheet_report *r);
json_t *vg_report_sheets_json(const struct vg_mesh *m,
                              const struct vg_sheet_report *r);

/** Zones of m with their figures r [n_zone]: number, kind, cells, volume,
 * smallest dihedral angle and name. Without zones, or if r is NULL, the text is
 * empty and the list has no items. */
void vg_report_zones_text(FILE *to, const struct vg_mesh *m,
                          const struct vg_zone_report *r);
json_t *vg_report_zones_json(const struct vg_mesh *m,
                             const struct vg_zone_report *r);

/** Unit of length (enum vg_cad_unit), shells, repairs, triangle quality, and
 * the number of defects of each kind with a description of the first `shown`
 * ones. is_stretched: sizes depend on the direction, so that slivers are no
 * fault and are not listed. */
void vg_report_surface_text(FILE *to, const struct vg_mesh *m,
                            const struct vg_surface_report *r, int unit,
                            int is_stretched, size_t shown);
json_t *vg_report_surface_json(const struct vg_mesh *m,
                               const struct vg_surface_report *r, int unit,
                               size_t shown);

/** The same without the quality of the triangles: of a plane section, those of
 * its strip say nothing. */
json_t *vg_report_defects_json(const struct vg_mesh *m,
                               const struct vg_surface_report *r, int unit,
                               size_t shown);

/** Result of remeshing; prints nothing, or returns null, if the surface was not
 * remeshed. */
void vg_report_remesh_text(FILE *to, const struct vg_remeshing *n);
json_t *vg_report_remesh_json(const struct vg_remeshing *n,
                              const struct vg_mesh *m);

/** Feature curves and corners of a surface as found by vg_remesh_judge, poor
 * triangles by cause; if `fit`, also the edges that match the target edge
 * lengths. */
void vg_report_lines_text(FILE *to, const struct vg_remesh_report *r, int fit);
json_t *vg_report_lines_json(const struct vg_remesh_report *r, int fit);

/** Distances between this surface and the one in `file`, in both directions. */
void vg_report_distances_text(FILE *to, const char *file,
                              const struct vg_remesh_distance d[2]);
json_t *vg_report_distances_json(const char *file,
                                 const struct vg_remesh_distance d[2]);

/** Cells across wake `wake` (index of a row) at a station, over all lines
 * there. NAN: no line, or none that was measured. */
struct vg_wake_count {
  double chords; /* Distance behind the trailing edge. */
  size_t n_line, n_measured;
  double asked, mean, least;
  double stretch; /* Mean edge length along the stream over that across. */
};
struct vg_wake_count vg_report_wake_count(size_t n,
                                          const struct vg_wake_probe *probe,
                                          size_t wake, size_t station);

/** Pairs of periodic patches and their transforms; prints nothing without any.
 * p: [n]; distance: the largest one in the mesh. */
struct vg_periodic;
void vg_report_periodic_text(FILE *to, size_t n, const struct vg_periodic *p,
                             double distance);
json_t *vg_report_periodic_json(size_t n, const struct vg_periodic *p);

/** Cells across all wakes; prints nothing without wakes. probe: [n] measured by
 * vg_wake_measure. */
void vg_report_wakes_text(FILE *to, const struct vg_read_wakes *w, size_t n,
                          const struct vg_wake_probe *probe);
json_t *vg_report_wakes_json(const struct vg_read_wakes *w, size_t n,
                             const struct vg_wake_probe *probe);

/** Validity and quality of a mesh, and the causes of flat cells if there are
 * any and they are classified; if `full`, also histograms and the worst cells.
 */
void vg_report_mesh_text(FILE *to, const struct vg_mesh_report *r, int full);

/** Validity and volume ratios of a mesh with layers: angles say nothing about
 * the quality of its flat layer cells. */
void vg_report_whole_text(FILE *to, const struct vg_mesh_report *r);
/** report_plane.c: cells and angles of a mesh in two dimensions. */
void vg_report_plane_text(FILE *to, const struct vg_plane_report *r);
json_t *vg_report_plane_json(const struct vg_plane_report *r);

/** @param patches  mesh with the patches to which flat cells refer */
json_t *vg_report_mesh_json(const struct vg_mesh_report *r,
                            const struct vg_mesh *patches);

/** Discretisation errors of mesh m; the text lists at most VG_SHOWN_PATCHES
 * walls. */
void vg_report_accuracy_text(FILE *to, const struct vg_accuracy_report *r,
                             const struct vg_mesh *m);
json_t *vg_report_accuracy_json(const struct vg_accuracy_report *r,
                                const struct vg_mesh *m);

/** Describe why a mesh is invalid: "3 cells not positive, ...". */
void vg_report_faults(const struct vg_mesh_report *r, char *text, size_t size);

/** A limit of the settings on the quality of the mesh that is not met. */
struct vg_mesh_limit {
  const char *name, *unit; /* of the setting; static strings */
  double wanted, got;
};
#define VG_MESH_LIMITS 5

/** Do the settings request the median dual, or limit it? */
int vg_wants_median_dual(const struct vg_settings *s);

/** The limits that a whole mesh does not meet; returns their number. */
int vg_mesh_limits_missed(const struct vg_settings *s,
                          const struct vg_mesh_report *r,
                          struct vg_mesh_limit out[VG_MESH_LIMITS]);
void vg_report_mesh_limits_text(FILE *to, const struct vg_settings *s,
                                const struct vg_mesh_report *r);
json_t *vg_report_mesh_limits_json(const struct vg_settings *s,
                                   const struct vg_mesh_report *r);

/** Add the fields of a report (base/entries.h) to o in their order; times go to
 * `seconds`, which may be o. */
void vg_report_entries(json_t *o, json_t *seconds, const struct vg_entries *l,
                       const void *report);

/** Operations and times of the volume fill. */
void vg_report_fill_text(FILE *to, const struct vg_fill_report *r,
                         size_t n_cell);
json_t *vg_report_fill_json(const struct vg_fill_report *r, size_t n_cell);

/** The flow domain with its evidence, the beginning of a report.
 * @param adds_farfield  1: a farfield is or was added */
void vg_report_flow_text(FILE *to, const struct vg_flow *f, int adds_farfield);
json_t *vg_report_flow_json(const struct vg_flow *f, int adds_farfield);

/** Symmetry plane and farfield that were added. */
void vg_report_domain_text(FILE *to, const struct vg_domain_report *r);
json_t *vg_report_domain_json(const struct vg_domain_report *r);

/** Peak memory of this process so far, bytes. */
double vg_report_peak_memory(void);

/** Add a note if whole patches have no layers because the first height is too
 * large for their edges. On rank 0. */
void vg_report_layers_note(const struct vg_layer_stage *s,
                           const struct vg_mesh *surface,
                           struct vg_notes *notes);

/** Tables by patch, causes of missing layers, times and rates. */
void vg_report_layers_text(FILE *to, const struct vg_layer_stage *s,
                           const struct vg_mesh *surface);
json_t *vg_report_layers_json(const struct vg_layer_stage *s,
                              const struct vg_mesh *surface);

/** Solver partition: balance, interfaces, stacks. */
void vg_report_solver_text(FILE *to, const struct vg_solver_report *r);
json_t *vg_report_solver_json(const struct vg_solver_report *r);

/** The limits that are not met, one per line. */
void vg_report_missed_text(FILE *to, const struct vg_layer_stage *s,
                           const struct vg_mesh *surface);

#endif
