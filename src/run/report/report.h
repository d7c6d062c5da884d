/* run/report/report.h: findings as text for a person and as JSON for a program.
 * */
#ifndef VG_RUN_REPORT_REPORT_H
#define VG_RUN_REPORT_REPORT_H

#include <jansson.h>
#include <stdio.h>

#include "core/domain/planar.h"
#include "core/fill/fill.h"
#include "core/flow/flow.h"
#include "core/judge/quality.h"
#include "core/mesh/mesh.h"
#include "core/surface/surface_check.h"
#include "partition/solver/solver.h"
#include "run/input/layers.h"

#define VG_SHOWN_DEFECTS 3   /* first ones of a kind, for a person */
#define VG_LISTED_DEFECTS 20 /* first ones of a kind, for a program */
#define VG_SHOWN_ITEMS 20    /* shells, or numbers of patches, in one list */
#define VG_SHOWN_FACES 3     /* as much of bad triangles */

/** Counts of a mesh, its box and its patches. */
void vg_report_size_text(FILE *to, const struct vg_mesh *m);
json_t *vg_report_size_json(const struct vg_mesh *m);

/** Number, faces, conditions, area, name and box of every patch; on screen at
 * most VG_SHOWN_PATCHES. */
#define VG_SHOWN_PATCHES 40
vg_status vg_report_patches_text(FILE *to, const struct vg_mesh *m,
                                 struct vg_error *err);
json_t *vg_report_patches_json(const struct vg_mesh *m);

/** Every kind of defect counted, the first `shown` of each in words, shells,
 * and what the repair did. */
void vg_report_surface_text(FILE *to, const struct vg_mesh *m,
                            const struct vg_surface_report *r, size_t shown);
json_t *vg_report_surface_json(const struct vg_mesh *m,
                               const struct vg_surface_report *r, size_t shown);

/** A surface that was made anew; nothing, or null, where none was. */
void vg_report_remesh_text(FILE *to, const struct vg_remeshing *n);
json_t *vg_report_remesh_json(const struct vg_remeshing *n,
                              const struct vg_mesh *m);

/** Lines and corners of a surface as vg_remesh_judge found them, bad triangles
 * by cause; fit: edges against the sizes asked for, too. */
void vg_report_lines_text(FILE *to, const struct vg_remesh_report *r, int fit);
json_t *vg_report_lines_json(const struct vg_remesh_report *r, int fit);

/** Distances from the surface in a file, and of it from this one. */
void vg_report_distances_text(FILE *to, const char *file,
                              const struct vg_remesh_distance d[2]);
json_t *vg_report_distances_json(const char *file,
                                 const struct vg_remesh_distance d[2]);

/** Validity, then quality; `full`: with histograms and the worst cells. */
void vg_report_mesh_text(FILE *to, const struct vg_mesh_report *r, int full);

/** The same of a mesh with layers, whose flat cells have no angles to be
 * judged by: validity and volumes. */
void vg_report_whole_text(FILE *to, const struct vg_mesh_report *r);
json_t *vg_report_mesh_json(const struct vg_mesh_report *r);

/** What is wrong with an invalid mesh: "3 cells not positive, ...". */
void vg_report_faults(const struct vg_mesh_report *r, char *text, size_t size);

/** Add the fields of a report (base/entries.h) to o in their order; times to
 * seconds, which may be o. */
void vg_report_entries(json_t *o, json_t *seconds, const struct vg_entries *l,
                       const void *report);

/** What the fill did and how fast. */
void vg_report_fill_text(FILE *to, const struct vg_fill_report *r,
                         size_t n_cell);
json_t *vg_report_fill_json(const struct vg_fill_report *r, size_t n_cell);

/** The flow domain with its evidence, as the head of a report.
 * @param adds_farfield  1: a farfield is added, or was */
void vg_report_flow_text(FILE *to, const struct vg_flow *f, int adds_farfield);
json_t *vg_report_flow_json(const struct vg_flow *f, int adds_farfield);

/** What was added around the body. */
void vg_report_domain_text(FILE *to, const struct vg_domain_report *r);
json_t *vg_report_domain_json(const struct vg_domain_report *r);

/** Largest memory of this process so far, bytes. */
double vg_report_peak_memory(void);

/** A note where whole patches stay without layers since
 * the first height is larger than their edges allow. On rank 0. */
void vg_report_layers_note(const struct vg_layer_stage *s,
                           const struct vg_mesh *surface,
                           struct vg_notes *notes);

/** Tables by patch, causes in words, times and rates. */
void vg_report_layers_text(FILE *to, const struct vg_layer_stage *s,
                           const struct vg_mesh *surface);
json_t *vg_report_layers_json(const struct vg_layer_stage *s,
                              const struct vg_mesh *surface);

/** Parts for the solver: balance, borders, stacks. */
void vg_report_solver_text(FILE *to, const struct vg_solver_report *r);
json_t *vg_report_solver_json(const struct vg_solver_report *r);

/** Limits that are not met, one line each. */
void vg_report_missed_text(FILE *to, const struct vg_layer_stage *s,
                           const struct vg_mesh *surface);

#endif
