/* run/input/shape_parts.h: the steps from triangles as read to the closed
 * boundary of a fluid. Private to run/input. */
#ifndef VG_RUN_INPUT_SHAPE_PARTS_H
#define VG_RUN_INPUT_SHAPE_PARTS_H

#include "run/input/input.h"

/* run/input/renew.c -------------------------------------------------------*/

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

/** VG_ERR_GEOMETRY that lists the rims of an open surface and says how they can be
 * closed. */
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
