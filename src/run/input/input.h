/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/input.h: finds and reads the files of a project and checks their
 * contents, up to the surface that bounds the mesh. */
#ifndef VG_RUN_INPUT_INPUT_H
#define VG_RUN_INPUT_INPUT_H

#include <stdio.h>

#include "base/comm.h"
#include "core/domain/planar.h"
#include "core/domain/project.h"
#include "core/flow/flow.h"
#include "core/remesh/remesh.h"
#include "core/sizing/sizing_map.h"
#include "core/sizing/sizing_mesh.h"
#include "core/surface/surface_check.h"
#include "core/wake/wake.h"
#include "io/cad/cad.h"
#include "run/common/progress.h"
#include "run/periodic/periodic_pairs.h"
#include "run/settings/resolved.h"

/** Paths of the files that exist; "" for a file that is absent. */
struct vg_input_files {
  char *stem; /* Folder and project name without extension. */
  char *d3m, *front, *surface, *mapbc, *deck;
  char *tags, *aflr; /* AFLR files: .tags and .bc. */
  int is_section;    /* 1: the surface is a plane section. */
};

/** Notes for the report, in the order in which they were added. */
struct vg_notes {
  size_t n, cap;
  char **text;
};

/** First heights at points, sorted by x, y, z: those of a .surf, or those that
 * follow from the wall shear of a solution. */
struct vg_point_heights {
  size_t n;
  struct vg_point_height {
    double x[3], first;
    double friction; /* Skin friction coefficient; negative: not known. */
  } * item;
};

/** Sorts the points, of equal ones the least height first. */
void vg_point_heights_sort(struct vg_point_heights *h);

/** The first height at x; NULL if none is given. O(log n). */
struct vg_point_height *vg_point_height(const struct vg_point_heights *h,
                                        const double x[3]);

/** Result of projecting a remeshed surface back onto its CAD model. */
struct vg_put_back {
  int is_done;
  size_t n_cap;                     /* Points inside caps, which the model does
                                       not have. */
  size_t n_point, n_curve;          /* Other points of the surface, and how many
                                       of them are on curves. */
  size_t n_far, n_refused;          /* Points that were not projected: too far
                                       from the model, or because triangles
                                       would fold or intersect. */
  struct vg_remesh_distance off[2]; /* Distances from the model: of points
                                       before, of points and centroids after. */
  double seconds;
};

/* Where the table `surface` requests edge lengths relative to a wing: at its
 * leading and trailing edges in local chords, at its root and tips in
 * semispans. */
enum vg_spacing_place {
  VG_AT_LEAD,
  VG_AT_TRAIL,
  VG_AT_ROOT,
  VG_AT_TIP,
  VG_SPACING_N
};

/* Edge lengths at such a place, means over the triangles there. n 0: none were
 * requested. */
struct vg_edge_spacing {
  double asked, reached;
  size_t n; /* triangles */
};

/** Result of remeshing the surface. */
struct vg_remeshing {
  int is_done;
  struct vg_remesh_report report;
  struct vg_remesh_distance off[2]; /* Distances of the remeshed surface from
                                       the input surface, and vice versa. */
  double *face;                     /* [n_tri] distance of each triangle from
                                       the input surface, or from the CAD model
                                       if the surface was projected onto it. */
  size_t n_patch;                   /* Patches of the surface; a farfield adds
                                       further ones. */
  double *area;                     /* [n_patch][2] area of each patch before
                                       and after. */
  double seconds;
  struct vg_put_back back;
  struct vg_edge_spacing spacing[VG_SPACING_N]; /* Of all rows. */
  size_t n_row; /* Rows of the table `surface`. */
  struct vg_edge_spacing (*row)[VG_SPACING_N]; /* [n_row] owned */
  double volume[2]; /* Volume enclosed by the remeshed surface, and by the CAD
                       model as Open CASCADE integrates it; NAN if one of them
                       is not closed. */
};

/* Distances behind a trailing edge, in chords, at which cells across wakes are
 * counted. */
enum { VG_WAKE_STATIONS = 3 };
#define VG_WAKE_STATION_CHORDS                                                 \
  {                                                                            \
    0.5, 1, 2                                                                  \
  }

/** The wakes of the table and of the setting `wakes`. */
struct vg_read_wakes {
  size_t n, n_probe, cap_probe;
  struct vg_wake_row *row;     /* [n] owned */
  struct vg_wake_probe *probe; /* [n_probe] owned; by wakes, then by stations */
};

/* Areas of patches by their numbers. */
struct vg_patch_areas {
  size_t n;
  int32_t *id;  /* [n] owned */
  double *area; /* [n] owned */
};

/** 1. The contents of the files of a project. Made by vg_problem_read or
 * vg_problem_given, and const afterwards except for `surface` and `model`,
 * which the boundary takes over. */
struct vg_read {
  struct vg_input_files files;
  int is_cured;                    /* The program chose the setting wrap or
                                      close_holes. */
  struct vg_settings settings;     /* Requested settings, with sources and
                                      layers from files, and with numbers in
                                      place of the names of patches. */
  const struct vg_size_map *map;   /* Sizes in addition to sources; NULL:
                                      none. */
  struct vg_size_samples *samples; /* Sizes of the setting `sizes`; NULL:
                                      none. */
  struct vg_size_mesh *metrics;    /* Metrics of the setting `sizes`; NULL:
                                      none. */
  struct vg_wall_shear *shear;     /* Walls of the setting `first_from`; NULL:
                                      none. */
  struct vg_project project;       /* Empty without a .d3m. */
  struct vg_mesh surface;
  struct vg_cad_model model; /* Model of a CAD file whose surface is remeshed,
                                on rank 0; empty otherwise. */
  struct vg_point_heights heights;
  struct vg_read_wakes wakes; /* Their sources are in `settings`. */
  enum vg_flow_side side; /* Side of the surface to which triangles point in its
                             file format. */
  int unit;               /* Unit of the mesh, enum vg_cad_unit; FILE: not
                             known. */
  int is_section;         /* 1: the surface is the strip of a plane section
                             (run/section/section_surface.h). */
  int has_cells;          /* 1: the surface is the boundary of a volume mesh, or
                             of the volumes that its file names. */
  struct vg_notes *notes; /* Notes of the problem; borrowed. */
};

/** 2. The surface, checked, closed and remeshed (vg_boundary_shape), and 3. the
 * boundary of the fluid, completed by a farfield and a symmetry plane
 * (vg_boundary_close). Layers set conditions of its patches. */
/* Messages on a surface that cannot be repaired name a wrap, unless other
 * tessellations follow. */
enum vg_remedy {
  VG_REMEDY_NOW,   /* They do. */
  VG_REMEDY_LATER, /* They do not. */
  VG_REMEDY_ASKED  /* They do not, but one would have. */
};

/* The settings that remedy a surface which is not valid, if no other reading of
 * the surface is plausible. */
struct vg_cure {
  double wrap;     /* > 0: the setting wrap. */
  int close_holes; /* 1: the setting close_holes. */
};

struct vg_boundary {
  const struct vg_read *read; /* Borrowed. */
  struct vg_notes *notes;     /* Borrowed. */
  int threads;                /* Number of threads; 0: one per core. */
  struct vg_mesh surface;
  struct vg_mesh inner;          /* Triangles of inner surfaces until they are
                                    part of the closed surface; patches are
                                    those of `surface`. */
  struct vg_shmem common;        /* Memory of its arrays if the ranks of a node
                                    share them. */
  struct vg_cad_model model;     /* As in struct vg_read. */
  const struct vg_size_map *map; /* Sizes in addition to sources, from a file
                                    and from gaps; NULL: none. */
  struct vg_gap_sizes *gaps;     /* Sizes of gap_edges; NULL: none. */
  struct vg_pairs pairs;         /* Periodic patches, where the surface was
                                    closed. */
  struct vg_zones *zones;        /* Zones of cells and their sizes, where the
                                    surface was closed; NULL: none. */
  size_t n_welded, n_dropped;    /* Points merged and triangles dropped by the
                                    weld. */
  struct vg_surface_report check;
  int require_bc;           /* The input sets boundary conditions. */
  int is_remeshed;          /* The settings remesh the surface. */
  int is_united;            /* Bodies that meet were united. */
  struct vg_flow flow;      /* The decided flow domain. */
  double rim_gap;           /* Weld tolerance at which open edges find partners;
                               0: they have none. */
  size_t n_given_patch;     /* Patches before holes were closed, followed by the
                               caps; 0: no holes were closed. */
  size_t n_row;             /* Patches before the domain was completed. */
  struct vg_patch_row *row; /* [n_row] owned: their names, conditions and fixed
                               borders. */
  struct vg_remeshing remeshing;
  struct vg_patch_areas given_area; /* Before the first attempt to remesh. */
  struct vg_domain_report domain;
  int is_swapped; /* Edges of the surface were swapped. */
  enum vg_remedy remedy;
  struct vg_cure cure; /* Of the refused surface. */
};

/** The data of a run up to its mesh. All commands and the library create them
 * with these calls, as far as each command goes:
 *
 *   vg_problem_open      finds files and reads the deck into `asked`, which
 *                        also receives options of the caller
 *   vg_problem_read      1. read
 *   vg_boundary_shape    2. the surface, from `read`
 *   vg_boundary_close    3. the domain around it
 *   vg_layer_stage_plan  4. the requested layers (run/layers/layers.h)
 *   vg_problem_settle    swaps slivers; resolved settings */
struct vg_problem {
  struct vg_settings asked; /* Not modified after parsing. */
  struct vg_read read;
  struct vg_boundary boundary;
  struct vg_resolved resolved;
  struct vg_notes notes; /* Notes of all steps. */
};
#define VG_PROBLEM_INIT                                                        \
  {                                                                            \
    .read = { .project = VG_PROJECT_INIT }, .boundary = {                      \
      .flow = VG_FLOW_INIT                                                     \
    }                                                                          \
  }

void vg_problem_release(struct vg_problem *p);

void vg_notes_release(struct vg_notes *notes);

/** Adds the note that STEM.mapbc was not read because Vanguard wrote it. stem:
 * its first n bytes. */
void vg_note_own_mapbc(struct vg_notes *notes, const char *stem, size_t n);

struct vg_mapbc_match;

/** Adds the note that a .mapbc gives patches other names. */
void vg_note_renamed(struct vg_notes *notes,
                     const struct vg_mapbc_match *match);

/** Adds a note for each symmetry plane (USM3D 1) that is nearly normal to an
 * axis but deviates too much to have a code of FUN3D's symmetry (6661 to 6663).
 */
void vg_note_symmetry(struct vg_notes *notes, const struct vg_mesh *m);

/** Adds a line to the report; the line is lost if there is no memory. */
void vg_note(struct vg_notes *notes, const char *format, ...)
  __attribute__((format(printf, 2, 3)));

/** Finds the files of `name`, a stem without extension or the complete name of
 * a surface file. deck: NULL for STEM.deck, if it exists. VG_ERR_INPUT if
 * there is no file, or more than one surface. */
vg_status vg_input_find(const char *name, const char *deck,
                        struct vg_input_files *out, struct vg_error *err);

/** Finds the files of a project (see vg_input_find) and reads its deck into
 * p->asked. The second function reads the deck of files that the caller
 * found. */
vg_status vg_problem_open(struct vg_problem *p, const char *name,
                          const char *deck, struct vg_error *err);
vg_status vg_problem_open_deck(struct vg_problem *p, struct vg_error *err);

/** Reads the files that vg_problem_open found, and sets the conditions of the
 * patches. Collective: rank 0 reads CAD, so that all ranks have the same
 * triangles. Returns the same status on all ranks. */
vg_status vg_problem_read(struct vg_problem *p, struct vg_comm *comm,
                          struct vg_display *show, struct vg_error *err);

/** As vg_problem_read, for a surface of the calling program instead of files.
 *
 * @param name     for messages
 * @param surface  boundary as specified in core/mesh/mesh.h; moved, even on
 *                 failure */
vg_status vg_problem_given(struct vg_problem *p, const char *name,
                           struct vg_mesh *surface, struct vg_error *err);

/** 1 for a CAD file on several ranks, which rank 0 reads and remeshes for
 * all. */
int vg_read_is_by_first(const struct vg_read *read, struct vg_comm *comm);

/** Options of the sizing field: settings and map. */
struct vg_sizing_options vg_boundary_sizing(const struct vg_boundary *b);

/** 1 if sources or the map may request sizes that depend on the direction. */
int vg_boundary_is_stretched(const struct vg_boundary *b);

/** Builds the sizing field of source[n_source] and the map over the surface, to
 * whose edges it does not refer, if its sizes depend on the direction; if not,
 * *field is unchanged. Freed by the caller with vg_sizing_free. */
vg_status vg_boundary_field(const struct vg_boundary *b, size_t n_source,
                            const struct vg_source *source,
                            struct vg_sizing **field, struct vg_error *err);

/** Largest size of a remeshed surface where the setting is h_max, 0: the
 * default. A map that gives a metric at all points requests large sizes, too,
 * so that the default does not apply. */
double vg_boundary_largest_edge(const struct vg_boundary *b, double h_max);

/** As vg_sizing_new, with the sources of s, for a boundary or front m. In a
 * stretched field only those faces request sizes whose edges do not follow the
 * metric; a surface remeshed in the metric requests none, except where its
 * shape required smaller triangles. */
vg_status vg_boundary_measure(const struct vg_boundary *b,
                              const struct vg_sizing_options *options,
                              const struct vg_settings *s,
                              const struct vg_mesh *m, struct vg_sizing **out,
                              struct vg_error *err);

/** The surface of b with its inner surfaces, whose triangles occur once, and
 * without the patches of their backs, as in a surface file. *out is empty
 * before. VG_ERR_MEMORY. */
vg_status vg_boundary_single_sides(const struct vg_boundary *b,
                                   struct vg_mesh *out, struct vg_error *err);

struct vg_shape_options {
  int threads;     /* Number of threads; 0: one per core. */
  int remesh_open; /* 1: also remesh an open surface that is not a half
                      model. */
  int has_maker;   /* 1: another rank remeshes this CAD surface
                      (vg_problem_share). */
};

/** Welds, checks and repairs the surface of `read`, and remeshes it if the
 * settings request it. The triangles and the CAD model of `read` move to
 * `out`.
 *
 * @param out  zeroed, with flow VG_FLOW_INIT; vg_boundary_release. On failure
 *             it has the surface and its check, for reports
 *
 * Returns VG_ERR_GEOMETRY if the surface has defects that prevent it from
 * bounding a mesh. */
vg_status vg_boundary_shape(struct vg_read *read,
                            const struct vg_shape_options *o,
                            struct vg_display *show, struct vg_boundary *out,
                            struct vg_error *err);

/** Adds farfield and symmetry plane as b->flow requests, and checks the
 * complete boundary. VG_ERR_GEOMETRY if defects remain: b->check lists them. */
vg_status vg_boundary_close(struct vg_boundary *b, struct vg_display *show,
                            struct vg_error *err);

/** Alternative step for a surface that need not bound a domain: VG_ERR_GEOMETRY
 * if it has defects other than open edges. */
vg_status vg_boundary_check(struct vg_boundary *b, struct vg_display *show,
                            struct vg_error *err);

void vg_boundary_release(struct vg_boundary *b);

/** Triangles of the boundary, or, before vg_boundary_shape, those of `read`. */
const struct vg_mesh *vg_problem_surface(const struct vg_problem *p);

/** 1 if rank 0 makes the surface for all ranks, since it alone has the CAD
 * model onto which points are projected. */
int vg_problem_has_maker(const struct vg_problem *p, struct vg_comm *comm);

/** Called after vg_boundary_shape on several ranks: sends the surface that rank
 * 0 projected onto CAD to the other ranks, which replace their own (is_maker).
 * Does nothing for other surfaces. st: status of this rank. Collective. */
vg_status vg_problem_share(struct vg_problem *p, struct vg_comm *comm,
                           int is_maker, vg_status st, struct vg_error *err);

/** Adds a note for settings that were given but had no effect because the run
 * lacked the object they apply to, such as a remeshed surface. Called once, at
 * the end. The rows of settings declare that object (enum vg_use).
 * @param layers_on  1: layers grow
 * @param judged     bits 1 << enum vg_use of the objects that the command could
 *                   have */
#define VG_USE_JUDGED_MESH ((1u << VG_USE_VOLUME) - 1)
#define VG_USE_JUDGED_SURFACE                                                  \
  (1u << VG_USE_D3M | 1u << VG_USE_CAD | 1u << VG_USE_VOLUME)
void vg_problem_note_unused(struct vg_problem *p, int layers_on,
                            unsigned judged);

/** Gives inlets and outlets of an internal flow that have no condition, but
 * names by which the flow was recognised, those of inflow and outflow (1001,
 * 1002), and the other patches then that of an inviscid wall, as writers do.
 * Adds a note that lists the patches without a condition. Called once the other
 * conditions are final. */
vg_status vg_boundary_finish_conditions(struct vg_boundary *b,
                                        struct vg_error *err);

/** 1 if the input is a plane section, by its name or the setting cad_section.
 */
int vg_problem_is_section(const struct vg_problem *p);

/** Fills in settings of a plane section that were not given and differ from
 * those of a surface: cells and fan_angle. Does nothing for a surface. */
void vg_section_complete(struct vg_read *read, struct vg_settings *s);

/** VG_ERR_UNSUPPORTED for a plane section, which only vanguard mesh and check
 * take. Called when the settings are complete. */
vg_status vg_problem_refuse_section(const struct vg_problem *p,
                                    struct vg_error *err);

/** Width of the cells of a mesh of a section: section_width or the largest
 * chord. slab: its surface (run/section/section_surface.h), of which the first
 * patches are the elements. */
double vg_section_width(const struct vg_settings *s, const struct vg_mesh *slab,
                        size_t n_element);

/** Writes all faces with a defect to a .vtu, with the kind as a cell field. */
vg_status vg_write_defects(const char *path, const struct vg_mesh *m,
                           const struct vg_surface_report *r,
                           struct vg_error *err);

#endif
