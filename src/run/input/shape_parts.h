/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/shape_parts.h: the steps from the triangles read to the closed
 * boundary of a fluid. Private to run/input. */
#ifndef VG_RUN_INPUT_SHAPE_PARTS_H
#define VG_RUN_INPUT_SHAPE_PARTS_H

#include "core/junction/junction.h"
#include "run/input/input.h"

/* run/input/input.c ------------------------------------------------------ */

/** Sets names and conditions from rows of the table `patches`. VG_ERR_INPUT for
 * a patch that the surface does not have. may_lack 1 is for calls before holes
 * are closed: rows of caps that are made later have no effect. */
vg_status vg_patch_table_apply(size_t n, const struct vg_patch_row *row,
                               int may_lack, struct vg_mesh *surface,
                               struct vg_error *err);

/* run/input/walls.c ------------------------------------------------------ */

/** 1 if patch i of the surface is a cap that closes a hole. */
int vg_boundary_is_cap(const struct vg_boundary *b, size_t i);

/* run/input/section_boundary.c ------------------------------------------- */

/** Reads the strip of a plane section, with the conditions of its patches. */
vg_status vg_read_section(struct vg_read *r, struct vg_display *show,
                          struct vg_error *err);

/** Adds a line of the CAD reader to the notes, `user`. */
void vg_read_note_cad(void *user, const char *text);

/** VG_ERR_INPUT if the settings request a farfield that only sections have. */
vg_status vg_boundary_refuse_plane_farfield(const struct vg_read *r,
                                            struct vg_error *err);

/** Divides the walls of a section into the requested edges. */
vg_status vg_boundary_divide_section(struct vg_boundary *b,
                                     struct vg_display *show,
                                     struct vg_error *err);

/** Adds the farfield and the planes to the walls. */
vg_status vg_boundary_close_section(struct vg_boundary *b,
                                    struct vg_display *show,
                                    struct vg_error *err);

/** Farfield options, with open settings filled in from the decided flow. */
struct vg_farfield vg_boundary_farfield(const struct vg_boundary *b);

/* run/input/inner_surface.c
 * ------------------------------------------------------ */

/** 1 if patches are inner surfaces: by the settings `baffles` and `sheets`, or
 * by the column `role` of the table `patches`. */
int vg_boundary_wants_inner(const struct vg_boundary *b);

/** Why the settings do not allow a surface other than a CAD model to be
 * remeshed or its edges to be swapped: "periodic patches", "inner surfaces";
 * NULL: they do. Static string. */
const char *vg_read_keeps_triangles(const struct vg_read *read);

/** Is the surface that of a CAD file? */
int vg_read_is_cad(const struct vg_read *read);

/** Is it a CAD file whose solids are zones? */
int vg_read_has_solid_zones(const struct vg_read *read);

#define VG_INNER_SOURCE 200

/** Where the inner surfaces are requested, for messages: "baffles fin*, sheets
 * 7, the table patches". Returns text. */
const char *vg_inner_source(const struct vg_settings *s, char *text,
                            size_t size);

/** The roles of the patches of m that are inner surfaces.
 *
 * @param role  out: [m->n_patch] VG_PATCH_AUTO, VG_PATCH_BAFFLE,
 * VG_PATCH_SHEET, VG_PATCH_INTERFACE VG_ERR_INPUT for a patch that the surface
 * does not have, and for a patch with two roles; the message names both
 * requests. VG_ERR_MEMORY. */
vg_status vg_inner_roles(const struct vg_settings *s, const struct vg_mesh *m,
                         uint8_t *role, struct vg_error *err);

/** Clears is_split of both sides of each sheet of m on which the settings
 * request no layers, by the list `walls` or the column `grow`. Items that no
 * patch matches are no error here: vg_walls_find reports them. VG_ERR_MEMORY.
 */
vg_status vg_inner_split(const struct vg_settings *s, struct vg_mesh *m,
                         struct vg_error *err);

/** Moves the triangles of inner surfaces to b->inner, adds patches for their
 * other sides, and resolves the names of these in s, the settings of b->read.
 * VG_ERR_INPUT for patches that the surface does not have, VG_ERR_UNSUPPORTED
 * for settings that change the surface. */
vg_status vg_boundary_take_inner(struct vg_boundary *b, struct vg_settings *s,
                                 struct vg_error *err);

/** out: b->surface with the triangles of b->inner at the end, and points of the
 * same place as one. VG_ERR_MEMORY. */
vg_status vg_boundary_with_inner(const struct vg_boundary *b,
                                 struct vg_mesh *out, struct vg_error *err);

/** Checks the closed surface together with b->inner, which has triangles, and
 * adds both sides of these to the surface. If there are defects, b->check and
 * b->surface have them, for reports. VG_ERR_GEOMETRY for inner surfaces that
 * are not in the fluid. */
vg_status vg_boundary_put_inner(struct vg_boundary *b, struct vg_display *show,
                                struct vg_error *err);

/** Names the patches that are inner surfaces, as a further sentence of a
 * message on an open surface; "" without any. */
void vg_boundary_name_inner(const struct vg_boundary *b, char *text,
                            size_t size);

/** Options of a check of surface and inner surfaces together. */
struct vg_surface_check_options vg_inner_check_options(
  const struct vg_boundary *b, struct vg_display *show);

/* run/input/inner_remesh.c ------------------------------------------------ */

#define VG_INNER_TURNED                                                        \
  "%zu triangles of inner surfaces were turned, the first one near "           \
  "(%g, %g, %g), so that each connected piece of a patch is oriented like "    \
  "its first triangle"

/* The inner surfaces of a boundary while its walls are remeshed. */
struct vg_inner_lines {
  struct vg_mesh all; /* The surface with its inner surfaces. */
  struct vg_junctions junctions;
  double *size;   /* [all.n_point] sizes that the shape of inner surfaces
                     requests; INFINITY elsewhere */
  uint8_t *still; /* [points of the surface] as in vg_remesh_options; NULL: the
                     inner surfaces touch no walls. */
};
#define VG_INNER_LINES_INIT                                                    \
  {                                                                            \
    .all = VG_MESH_INIT, .junctions = VG_JUNCTIONS_INIT                        \
  }

/** Orients the inner surfaces of `all`, which vg_boundary_with_inner made,
 * piece by piece, with a note. VG_ERR_GEOMETRY for one with one side.
 * VG_ERR_MEMORY.
 */
vg_status vg_inner_orient_all(const struct vg_boundary *b, struct vg_mesh *all,
                              struct vg_error *err);

/* Triangles to which others are appended; without patches. */
struct vg_growing_mesh {
  struct vg_mesh m;
  size_t cap[3];
};
#define VG_GROWING_MESH_INIT                                                   \
  {                                                                            \
    .m = VG_MESH_INIT                                                          \
  }

/** Appends points and triangles of m. VG_ERR_MEMORY. */
vg_status vg_grow_mesh(struct vg_growing_mesh *to, const struct vg_mesh *m,
                       struct vg_error *err);

/** Finds the edges that walls share with inner surfaces, if there are any.
 *
 * @param l        VG_INNER_LINES_INIT
 * @param stretch, cap  in/out: as in vg_remesh_options; are allocated if they
 * are NULL VG_ERR_GEOMETRY for an inner surface with one side. VG_ERR_MEMORY.
 */
vg_status vg_inner_lines_find(const struct vg_boundary *b,
                              struct vg_inner_lines *l, double **stretch,
                              double **cap, struct vg_error *err);

/** Remeshes the inner surfaces of b, whose surface is remeshed and was traced
 * (vg_junctions_trace). b->inner is unchanged on failure. Errors of vg_remesh,
 * vg_junctions_piece and vg_junctions_trace. */
vg_status vg_inner_lines_remesh(struct vg_boundary *b, struct vg_inner_lines *l,
                                struct vg_display *show, struct vg_error *err);

void vg_inner_lines_release(struct vg_inner_lines *l);

/** The largest side of the box around the surface of b. O(n). */
double vg_boundary_length(const struct vg_boundary *b);

/* run/input/imprint.c ----------------------------------------------------- */

/** Cuts the inner surfaces of b where they cross walls, each other or the plane
 * of a half model, divides the triangles that are crossed, and removes what is
 * inside bodies or beyond the plane, with a note. The flow must be decided.
 *
 * @param is_cut  out: 0: nothing was changed. 1: the surface must be checked
 *                again
 * VG_ERR_GEOMETRY, with b unchanged: an inner surface is lost as a whole, or
 * enters a body without crossing its surface; VG_ERR_UNSUPPORTED without
 * vanguard-wrap; otherwise as vg_imprint. */
vg_status vg_boundary_imprint(struct vg_boundary *b, int *is_cut,
                              struct vg_display *show, struct vg_error *err);

/* S79: edges around a full circle, and tolerance relative to the diagonal of
 * the domain, when a generated boundary is remeshed. */
#define VG_OUTER_PER_TURN 8
#define VG_OUTER_TOLERANCE 0.01

/** Cuts inner surfaces that cross the outer boundary, the last
 * b->domain.n_added_tri triangles of the surface, removes what is beyond it,
 * with a note, and remeshes both.
 *
 * @param sizing   sizes of the outer boundary; spacing: their largest, 0: none
 * @param is_cut  out: 0: nothing was changed
 * VG_ERR_GEOMETRY, with patch and place: a patch is beyond the outer boundary
 * as a whole, or crosses it and is not remeshed; otherwise as
 * vg_boundary_imprint and vg_remesh. */
vg_status vg_boundary_cut_outer(struct vg_boundary *b,
                                const struct vg_sizing *sizing, double spacing,
                                int *is_cut, struct vg_display *show,
                                struct vg_error *err);

/** Suggests `baffles` for a surface that is closed without the patches that
 * have open edges, as the end of a message: "; if fluid is on both sides of its
 * open sheets, give --baffles 7,8". Returns 0 for other surfaces; text is
 * unchanged. */
int vg_boundary_suggest_inner(const struct vg_boundary *b, char *text,
                              size_t size);

/* run/input/remesh_boundary.c, surface_sizes.c, put_back.c
 * --------------------------- */

/** 1 if this surface is remeshed: `auto` remeshes CAD surfaces, and
 * tessellations (STL, OBJ, Cart3D) of which more than a fifth of the triangles
 * are slivers, unless their triangles must stay (vg_read_keeps_triangles). */
int vg_read_is_remeshed(const struct vg_read *read,
                        const struct vg_mesh *surface);

/** Remeshes the surface, measures distances and adds notes. The surface must be
 * in the state that the check left. VG_ERR_GEOMETRY if the result is not a
 * valid surface. */
vg_status vg_boundary_remesh(struct vg_boundary *b, struct vg_display *show,
                             struct vg_error *err);

/** Target edge lengths from the table `surface`. NULL, NULL: it is empty. */
struct vg_surface_sizes {
  double *cap;     /* [n_point] largest size; INFINITY: no limit. */
  double *across;  /* [n_patch] edges across strips. */
  double *stretch; /* [3 n_tri] as in vg_remesh_options; NULL if nothing is
                      stretched. */
  size_t n_source, cap_source;
  struct vg_source *source; /* [n_source] owned: those of the settings and at
                               the ends of spans. */
  struct vg_sizing *field;  /* Sources and map if their sizes depend on the
                               direction; else NULL. */
};

/** Computes them from the settings for the current surface. VG_ERR_INPUT for
 * patches that it does not have, or two patches that share no edge. O(n log n)
 * for each curve, O(n) for each other row. */
vg_status vg_surface_sizes_make(const struct vg_boundary *b,
                                struct vg_surface_sizes *s,
                                struct vg_error *err);

/** Adds a source. VG_ERR_MEMORY. */
vg_status vg_surface_sizes_add(struct vg_surface_sizes *s,
                               const struct vg_source *source,
                               struct vg_error *err);

void vg_surface_sizes_release(struct vg_surface_sizes *s);

/** Measures the edge lengths of the remeshed surface where the table `surface`
 * requests them: of the equilateral triangles that have the area of the
 * triangles at leading edges, or the height of those at trailing edges, and the
 * extent along the span of the triangles at the root and the tips. Bases of
 * blunt trailing edges and cut tips do not count. O(n) for each row.
 *
 * @param r  out: spacing, all 0 on entry, and row
 * VG_ERR_MEMORY. */
vg_status vg_surface_spacing_measure(const struct vg_boundary *b,
                                     struct vg_remeshing *r,
                                     struct vg_error *err);

/** Adds a note if `auto` remeshes because of slivers, and a warning if slivers
 * remain. */
void vg_boundary_note_slivers(struct vg_boundary *b);

/** Projects the points of a remeshed surface onto b->model unless triangles
 * would fold or intersect; measures distances and adds notes. VG_ERR_GEOMETRY
 * if Open CASCADE fails. */
vg_status vg_boundary_put_back(struct vg_boundary *b, struct vg_display *show,
                               struct vg_error *err);

void vg_remeshing_release(struct vg_remeshing *r);

/** Replaces the surface of a CAD model whose tessellation led to no valid
 * surface by the next tessellation of a fixed sequence, with a note.
 *
 * @param i       0 for the first tessellation after the initial one
 * @param patch   [n_patch] names and conditions as read
 * @param n_note  further notes refer to the previous tessellation and are
 *                removed
 *
 * VG_BLOCKED if there is no further tessellation, or no model; nothing is
 * changed then. */
vg_status vg_boundary_tessellate(struct vg_boundary *b, size_t i,
                                 const struct vg_patch *patch, size_t n_patch,
                                 size_t n_note, struct vg_display *show,
                                 struct vg_error *err);

/* run/input/domain.c ------------------------------------------------------*/

/** Options of the flow decision, from settings and files. */
struct vg_flow_options vg_boundary_flow_options(const struct vg_boundary *b,
                                                struct vg_display *show);

/** Decides which flow the surface bounds, with notes, and stores it in b->flow.
 * b->check must be from vg_surface_check with `external` -1. Errors as
 * vg_flow_settle. */
vg_status vg_boundary_decide(struct vg_boundary *b, struct vg_display *show,
                             struct vg_error *err);

/** Returns VG_ERR_GEOMETRY if all triangles lie in one plane, which no cap
 * closes. */
vg_status vg_boundary_refuse_plane(const struct vg_boundary *b,
                                   struct vg_error *err);

/** Close the rims of m, which is the surface of b or a copy of it.
 *
 * @param report  out
 * Errors are those of vg_sizing_new and vg_domain_close_holes; m is then
 * unchanged. */
vg_status vg_boundary_add_caps(const struct vg_boundary *b, struct vg_mesh *m,
                               struct vg_cap_report *report,
                               struct vg_error *err);

/** Returns VG_ERR_GEOMETRY with a message that lists the rims of an open
 * surface and describes how to close them. */
vg_status vg_boundary_refuse_open(struct vg_boundary *b,
                                  struct vg_display *show,
                                  struct vg_error *err);

/** Adds farfield and symmetry plane as decided. */
vg_status vg_boundary_complete(struct vg_boundary *b, struct vg_display *show,
                               struct vg_error *err);

/* run/input/unite_surface.c ------------------------------------------------*/

/** Unites closed shells that meet, or with --flow internal cuts them out of the
 * largest one, with a note; `auto` then remeshes the surface. The surface must
 * be in the state that the check left. VG_BLOCKED, with nothing changed: no
 * shells meet, or they cannot be united. VG_ERR_INPUT if it is not clear
 * whether a shell is a body or the wall of a tunnel; otherwise as vg_unite. */
vg_status vg_boundary_unite(struct vg_boundary *b, struct vg_display *show,
                            struct vg_error *err);

/* run/input/surface.c -----------------------------------------------------*/

/** Splits each quadrilateral into two triangles. VG_ERR_MEMORY. */
vg_status vg_split_quads(struct vg_mesh *m, struct vg_error *err);

/* run/input/wrap_surface.c ------------------------------------------------*/

/** Wraps the surface with the size of the setting `wrap`; notes describe the
 * result.
 *
 * @param keep  [b->surface.n_tri] 1: the triangle belongs to an outer boundary
 *              and is kept; NULL: no triangle does
 *
 * VG_ERR_INPUT if a patch of `walls` or of the table `layers` is left without
 * triangles; otherwise as vg_wrap. */
vg_status vg_boundary_wrap(struct vg_boundary *b, const uint8_t *keep,
                           struct vg_display *show, struct vg_error *err);

/** Suggests inner surfaces, or a wrap, for a surface that cannot be repaired,
 * as the end of a message: "; --wrap 0.2 puts a closed surface around it". The
 * wrap is tried first, which takes some seconds. text[120]: "" if a wrap does
 * not help. */
void vg_boundary_suggest_wrap(struct vg_boundary *b, struct vg_display *show,
                              char *text, size_t size);

/** Whether open edges are the only defects. */
int vg_is_only_open(const struct vg_surface_report *r);

#endif
