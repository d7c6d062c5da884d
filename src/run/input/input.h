/* run/input/input.h: finds and reads the files of a project, and checks what
 * they hold, up to the surface that bounds the mesh. */
#ifndef VG_RUN_INPUT_INPUT_H
#define VG_RUN_INPUT_INPUT_H

#include <stdio.h>

#include "base/comm.h"
#include "core/domain/planar.h"
#include "core/domain/project.h"
#include "core/flow/flow.h"
#include "core/remesh/remesh.h"
#include "core/sizing/sizing_map.h"
#include "core/surface/surface_check.h"
#include "io/cad/cad.h"
#include "run/common/progress.h"
#include "run/settings/resolved.h"

/** Paths of what exists; "" where a part is absent. */
struct vg_input_files {
  char *stem; /* folder and project name, no extension */
  char *d3m, *front, *surface, *mapbc, *deck;
  char *tags, *aflr; /* of AFLR: .tags, .bc */
};

/** Notes for the report, in the order in which they came up. */
struct vg_notes {
  size_t n, cap;
  char **text;
};

/** First heights at points of a .surf, by rising x, y, z. */
struct vg_point_heights {
  size_t n;
  struct vg_point_height {
    double x[3], first;
  } * item;
};

/** The height at x, NULL where none is given. O(log n). */
double *vg_point_height(const struct vg_point_heights *h, const double x[3]);

/** A new surface that was put back on the CAD model that it comes from. */
struct vg_put_back {
  int is_done;
  size_t n_cap;                     /* points inside caps, which the model does
                                       not have */
  size_t n_point, n_curve;          /* other points of the surface; of them on
                                       curves */
  size_t n_far, n_refused;          /* that stay: off the model, and since
                                       triangles would fold or meet */
  struct vg_remesh_distance off[2]; /* from the model: of points before, of
                                       points and centroids after */
  double seconds;
};

/** A surface whose triangles were made anew. */
struct vg_remeshing {
  int is_done;
  struct vg_remesh_report report;
  struct vg_remesh_distance off[2]; /* new from given, given from new */
  double *face;                     /* [n_tri] distance of each from given, or
                                       from the CAD model where put back */
  size_t n_patch;                   /* of the surface; a farfield adds others */
  double *area;                     /* [n_patch][2] of patches, before, after */
  double seconds;
  struct vg_put_back back;
  double volume[2]; /* enclosed by the new surface, and by the
                       CAD model as Open CASCADE integrates it;
                       NAN where one of them is not closed */
};

/** 1. The contents of a project's files. Made by vg_problem_read or
 * vg_problem_given; const from then on, but for `surface` and `model`, which
 * the boundary takes over. */
struct vg_read {
  struct vg_input_files files;
  struct vg_settings settings;     /* asked, and sources and layers from files;
                                      numbers in place of names of patches */
  const struct vg_size_map *map;   /* sizes besides sources; NULL: none */
  struct vg_size_samples *samples; /* of the setting `sizes`; NULL */
  struct vg_project project;       /* empty without a .d3m */
  struct vg_mesh surface;
  struct vg_cad_model model; /* of a CAD file whose surface is remeshed,
                                on the first rank; else empty */
  struct vg_point_heights heights;
  enum vg_flow_side side; /* to which the format of the surface has
                             triangles point */
  int has_cells;          /* 1: the surface is the boundary of a volume
                             mesh */
  struct vg_notes *notes; /* of the problem; borrowed */
};

/** 2. The surface, checked, closed and remeshed (vg_boundary_shape), and 3. the
 * boundary of the fluid, which a farfield and a symmetry plane complete
 * (vg_boundary_close). Layers give conditions to its patches. */
struct vg_boundary {
  const struct vg_read *read; /* borrowed */
  struct vg_notes *notes;     /* borrowed */
  int threads;                /* 0: one per core */
  struct vg_mesh surface;
  struct vg_shmem common;        /* memory of its arrays, if the ranks of a
                                    node share them */
  struct vg_cad_model model;     /* as in struct vg_read */
  const struct vg_size_map *map; /* sizes besides sources: those that were
                                    read and those of gaps; NULL: none */
  struct vg_gap_sizes *gaps;     /* of gap_edges; NULL */
  size_t n_welded, n_dropped;    /* by the weld */
  struct vg_surface_report check;
  int require_bc;           /* the input gives conditions */
  int is_remeshed;          /* settings remesh the surface */
  struct vg_flow flow;      /* what was decided of the flow domain */
  double rim_gap;           /* weld tolerance at which open edges find
                               partners; 0: no partners */
  size_t n_given_patch;     /* patches before holes were closed; the caps
                               follow them; 0: none were closed */
  size_t n_row;             /* patches before the domain was completed */
  struct vg_patch_row *row; /* [n_row] owned: their names, conditions and
                               hard borders */
  struct vg_remeshing remeshing;
  struct vg_domain_report domain;
  int is_swapped; /* edges of the surface were swapped */
};

/** The values of a run up to its mesh. All commands and the library make them
 * by the same calls, as far as each one goes:
 *
 *   vg_problem_open      files found, the deck read into `asked`; options of
 *                        the caller go there, too
 *   vg_problem_read      1. read
 *   vg_boundary_shape    2. the surface, from `read`
 *   vg_boundary_close    3. the domain around it
 *   vg_layer_stage_plan  4. what layers ask for (run/input/layers.h)
 *   vg_problem_settle    slivers swapped; resolved settings
 */
struct vg_problem {
  struct vg_settings asked; /* not written after parsing */
  struct vg_read read;
  struct vg_boundary boundary;
  struct vg_resolved resolved;
  struct vg_notes notes; /* of all of them */
};
#define VG_PROBLEM_INIT                                                        \
  {                                                                            \
    .read = { .project = VG_PROJECT_INIT }, .boundary = {                      \
      .flow = VG_FLOW_INIT                                                     \
    }                                                                          \
  }

void vg_problem_release(struct vg_problem *p);

void vg_notes_release(struct vg_notes *notes);

/** Note that STEM.mapbc was not read since Vanguard wrote it. stem: its first
 * n bytes. */
void vg_note_own_mapbc(struct vg_notes *notes, const char *stem, size_t n);

/** Add a line for the report; loses it when memory is refused. */
void vg_note(struct vg_notes *notes, const char *format, ...)
  __attribute__((format(printf, 2, 3)));

/** Find the files of `name`: a stem without extension, or the full name of a
 * surface file. deck: NULL for STEM.deck where that exists.
 * VG_ERR_INPUT when nothing is there, or when two surfaces are. */
vg_status vg_input_find(const char *name, const char *deck,
                        struct vg_input_files *out, struct vg_error *err);

/** Find the files of a project (as vg_input_find) and read its deck into
 * p->asked; the second one reads the deck of files that the caller found. */
vg_status vg_problem_open(struct vg_problem *p, const char *name,
                          const char *deck, struct vg_error *err);
vg_status vg_problem_open_deck(struct vg_problem *p, struct vg_error *err);

/** Read the files that vg_problem_open found, and give the patches their
 * conditions. Collective: the first rank reads CAD, for all to have the same
 * triangles; the same status on all ranks. */
vg_status vg_problem_read(struct vg_problem *p, struct vg_comm *comm,
                          struct vg_display *show, struct vg_error *err);

/** The same of a problem without files: a surface that somebody has made.
 *
 * @param name     for messages
 * @param surface  boundary as core/mesh/mesh.h has it; moved, also on failure
 */
vg_status vg_problem_given(struct vg_problem *p, const char *name,
                           struct vg_mesh *surface, struct vg_error *err);

/** 1 for a CAD file on several ranks, which the first one reads and remeshes
 * for the others. */
int vg_read_is_by_first(const struct vg_read *read, struct vg_comm *comm);

/** Options of sizes: settings and map. */
struct vg_sizing_options vg_boundary_sizing(const struct vg_boundary *b);

struct vg_shape_options {
  int threads;     /* 0: one per core */
  int remesh_open; /* 1: remesh an open surface, too, that is no
                      half model */
  int has_maker;   /* 1: another rank remeshes this surface,
                      which is CAD's (vg_problem_share) */
};

/** Weld, check and repair the surface of `read`, and remesh it where settings
 * ask for it. The triangles and the CAD model of `read` move to `out`.
 *
 * @param out  zeroed, with flow VG_FLOW_INIT; vg_boundary_release. On failure
 *             it has the surface and its check, for reports
 * VG_ERR_GEOMETRY when defects are in the way. */
vg_status vg_boundary_shape(struct vg_read *read,
                            const struct vg_shape_options *o,
                            struct vg_display *show, struct vg_boundary *out,
                            struct vg_error *err);

/** Add farfield and symmetry plane as b->flow asks for, and check the whole
 * boundary. VG_ERR_GEOMETRY when defects remain: b->check lists them. */
vg_status vg_boundary_close(struct vg_boundary *b, struct vg_display *show,
                            struct vg_error *err);

/** The step for a surface that need not bound a domain: VG_ERR_GEOMETRY where
 * it has other defects than open edges. */
vg_status vg_boundary_check(struct vg_boundary *b, struct vg_display *show,
                            struct vg_error *err);

void vg_boundary_release(struct vg_boundary *b);

/** The triangles of the boundary; before vg_boundary_shape those of `read`. */
const struct vg_mesh *vg_problem_surface(const struct vg_problem *p);

/** After vg_boundary_shape on several ranks: what the first one put back on CAD
 * goes to those that have their own (is_maker); nothing happens for other
 * surfaces. st: how this rank fared. Collective. */
vg_status vg_problem_share(struct vg_problem *p, struct vg_comm *comm,
                           int is_maker, vg_status st, struct vg_error *err);

/** A note for settings that were given and had no effect, since the run had
 * nothing that they act on, such as a surface made anew; at its end, once. What
 * such settings act on is in their rows (enum vg_use).
 * @param layers_on  1: layers grow
 * @param judged     bits 1 << enum vg_use of what the command might have had */
#define VG_USE_JUDGED_MESH ((1u << VG_USE_N) - 1)
#define VG_USE_JUDGED_SURFACE (1u << VG_USE_D3M | 1u << VG_USE_CAD)
void vg_problem_note_unused(struct vg_problem *p, int layers_on,
                            unsigned judged);

/** Writers give patches without a condition that of an inviscid wall: a note
 * tells which these are. Once conditions are final. */
void vg_boundary_note_unset(struct vg_boundary *b);

/** All faces with a defect, with the kind as a cell field, into a .vtu. */
vg_status vg_write_defects(const char *path, const struct vg_mesh *m,
                           const struct vg_surface_report *r,
                           struct vg_error *err);

#endif
