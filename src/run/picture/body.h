/* run/picture/body.h: what of a domain one wants to look at, and from where.
 * The same on every rank that has the surface and the columns. Uses
 * layers/columns/columns.h, run/picture/cuts.h. */
#ifndef VG_RUN_PICTURE_BODY_H
#define VG_RUN_PICTURE_BODY_H

#include "layers/columns/columns.h"
#include "run/picture/cuts.h"

/** Mark the patches of the body: those with layers; without such, those with
 * the condition of a wall; without such, all.
 * @param columns  NULL: no layers
 * @param on       out: [surface->n_patch] */
void vg_body_patches(const struct vg_mesh *surface,
                     const struct vg_columns *columns, uint8_t *on);

/** What a cut shows, for its words. */
enum vg_cut_view {
  VG_VIEW_BODY,   /* the body's section */
  VG_VIEW_DOMAIN, /* the whole domain */
  VG_VIEW_FIRST,  /* close to the section's end of least u */
  VG_VIEW_LAST,   /* ... of largest u */
  VG_VIEW_POOREST /* where layers lack most of their levels */
};

struct vg_cut_plan {
  size_t n;
  struct vg_cut cut[VG_CUTS_MAX];
  enum vg_cut_view view[VG_CUTS_MAX];
};

/** Sections of the body across y, x and z a little off its middle, the first
 * of them for the whole domain too and close to both of its ends, and where
 * layers are poorest, if they are somewhere. VG_ERR_MEMORY. */
vg_status vg_cut_plan(const struct vg_mesh *surface,
                      const struct vg_columns *columns,
                      struct vg_cut_plan *plan, struct vg_error *err);

#endif
