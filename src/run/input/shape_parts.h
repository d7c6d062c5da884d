/* run/input/shape_parts.h: the steps from triangles as read to the closed
 * boundary of a fluid. Private to run/input. */
#ifndef VG_RUN_INPUT_SHAPE_PARTS_H
#define VG_RUN_INPUT_SHAPE_PARTS_H

#include "run/input/input.h"

/* run/input/input.c ------------------------------------------------------ */

/** Names and conditions of rows of the table `patches`. VG_ERR_INPUT for a
 * patch that the surface lacks; with may_lack 1, before holes are closed, rows
 * of caps that will be made then have no effect. */
vg_status vg_patch_table_apply(size_t n, const struct vg_patch_row *row,
                               int may_lack, struct vg_mesh *surface,
                               struct vg_error *err);

/** 1 when patch i of the surface is a cap that closes a hole. */
int vg_boundary_is_cap(const struct vg_boundary *b, size_t i);

/* run/input/remesh_boundary.c, surface_sizes.c, put_back.c
 * --------------------------- */

/** 1 where settings remesh this surface: `auto` remeshes CAD, and tessellations
 * (STL, OBJ, Cart3D) more than half of whose triangles are slivers. */
int vg_read_is_remeshed(const struct vg_read *read,
                        const struct vg_mesh *surface);

/** Remesh the surface; distances are measured, notes tell. The surface is as
 * the check left it. VG_ERR_GEOMETRY where no sound surface came out. */
vg_status vg_boundary_remesh(struct vg_boundary *b, struct vg_display *show,
                             struct vg_error *err);

/** Sizes by the table `surface`. NULL, NULL: it is empty. */
struct vg_surface_sizes {
  double *cap;     /* [n_point] largest size; INFINITY: none */
  double *across;  /* [n_patch] edges across strips */
  double *stretch; /* [3 n_tri] as vg_remesh_options has it;
                      NULL where nothing is stretched */
};

/** From the settings, for the surface as it is now. VG_ERR_INPUT for patches
 * that it lacks, or two that share no edge. O(n log n) for each curve,
 * O(n) for each other row. */
vg_status vg_surface_sizes_make(const struct vg_boundary *b,
                                struct vg_surface_sizes *s,
                                struct vg_error *err);

void vg_surface_sizes_release(struct vg_surface_sizes *s);

/** A note where `auto` decides by the slivers of the surface, and a warning
 * where slivers stay. */
void vg_boundary_note_slivers(struct vg_boundary *b);

/** Put the points of a remeshed surface back on b->model, as far as
 * no triangle folds or meets another one; distances are measured, notes tell.
 * VG_ERR_GEOMETRY when Open CASCADE fails. */
vg_status vg_boundary_put_back(struct vg_boundary *b, struct vg_error *err);

void vg_remeshing_release(struct vg_remeshing *r);

/** The surface of a CAD model, whose tessellation led to no sound surface, by
 * the next tessellation of a fixed order, with a note.
 *
 * @param i      0 for the first one after that which was read
 * @param patch  [n_patch] names and conditions as they were read
 * @param n_note notes beyond these are of the tessellation before
 * VG_BLOCKED when there is no further one, or no model: nothing happened. */
vg_status vg_boundary_tessellate(struct vg_boundary *b, size_t i,
                                 const struct vg_patch *patch, size_t n_patch,
                                 size_t n_note, struct vg_display *show,
                                 struct vg_error *err);

/* run/input/domain.c ------------------------------------------------------*/

/** What settings and files say of the flow domain. */
struct vg_flow_options vg_boundary_flow_options(const struct vg_boundary *b,
                                                struct vg_display *show);

/** Decide which flow the surface bounds, with notes, into b->flow. b->check is
 * of vg_surface_check with `external` -1.
 * Errors as vg_flow_settle. */
vg_status vg_boundary_decide(struct vg_boundary *b, struct vg_display *show,
                             struct vg_error *err);

/** VG_ERR_GEOMETRY that lists the rims of an open surface and says how they can
 * be closed. */
vg_status vg_boundary_refuse_open(const struct vg_boundary *b,
                                  struct vg_display *show,
                                  struct vg_error *err);

/** Add farfield and symmetry plane as the decision asks for. */
vg_status vg_boundary_complete(struct vg_boundary *b, struct vg_display *show,
                               struct vg_error *err);

/* run/input/wrap_surface.c ------------------------------------------------*/

/** Wrap the surface with the size of the setting `wrap`; notes tell what came
 * out.
 *
 * @param keep  [b->surface.n_tri] 1: the triangle belongs to an outer boundary,
 *              which stays as it is; NULL: none does
 * VG_ERR_INPUT where a patch of `walls` or of the table `layers` is left
 * without triangles; otherwise as vg_wrap. */
vg_status vg_boundary_wrap(struct vg_boundary *b, const uint8_t *keep,
                           struct vg_display *show, struct vg_error *err);

/** What will do for a surface that cannot be repaired, as the end of a message:
 * "; --wrap 0.2 puts a closed surface around it". A wrap is tried for it, which
 * takes some seconds. "" where a wrap is no remedy: text[120] */
void vg_boundary_suggest_wrap(const struct vg_boundary *b,
                              struct vg_display *show, char *text, size_t size);

/** Open edges are the only defects. */
int vg_is_only_open(const struct vg_surface_report *r);

#endif
