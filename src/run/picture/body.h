/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/picture/body.h: chooses views of a domain. The same on every rank that
 * has the surface and the columns. Uses layers/columns/columns.h,
 * run/picture/cuts.h. */
#ifndef VG_RUN_PICTURE_BODY_H
#define VG_RUN_PICTURE_BODY_H

#include "layers/columns/columns.h"
#include "run/picture/cuts.h"

/** Marks the patches of the body: those with layers, or, without layers, those
 * with a wall condition, or, without any such condition, all patches.
 * @param columns  NULL: no layers
 * @param on       out: [surface->n_patch] */
void vg_body_patches(const struct vg_mesh *surface,
                     const struct vg_columns *columns, uint8_t *on);

/** What a cut shows, for its caption. */
enum vg_cut_view {
  VG_VIEW_BODY,   /* The section of the body. */
  VG_VIEW_DOMAIN, /* The whole domain. */
  VG_VIEW_FIRST,  /* Close to the end of the section with the smallest u. */
  VG_VIEW_LAST,   /* Close to the end with the largest u. */
  VG_VIEW_POOREST /* Where layers lack most of their levels. */
};

struct vg_cut_plan {
  size_t n;
  struct vg_cut cut[VG_CUTS_MAX];
  enum vg_cut_view view[VG_CUTS_MAX];
};

/** Sections of the body normal to y, x and z slightly away from its middle. The
 * first section is also shown for the whole domain and close to both of its
 * ends. If layers lack levels, the worst place is added. VG_ERR_MEMORY.
 * @param is_slab  1: the surface is that of a mesh one cell thick along z, and
 *                 only sections normal to z are shown */
vg_status vg_cut_plan(const struct vg_mesh *surface,
                      const struct vg_columns *columns, int is_slab,
                      struct vg_cut_plan *plan, struct vg_error *err);

#endif
