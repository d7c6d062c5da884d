/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/wakes.h: the table `wakes`, from rows to sources and sheets.
 * Private to run/input, except for the data. Uses core/wake. */
#ifndef VG_RUN_INPUT_WAKES_H
#define VG_RUN_INPUT_WAKES_H

#include "run/input/input.h"

/** Add the patches of the sheets of the table `wakes` to r->surface, still
 * without triangles: wakeN, N: number of the row. Other tables can name them
 * then. VG_ERR_MEMORY. */
vg_status vg_read_add_wake_patches(struct vg_read *r, struct vg_error *err);

/** Replace the rows of the table `wakes`, and the setting `wakes`, in
 * r->settings by sources on the sheets of the wakes, and store the lines on
 * which cells are counted in r->wakes. Rows of kind `sheet` stay in the
 * settings, and their patches get their triangles. A note describes each wake.
 *
 * The trailing edges are those of the surface as it was read, before it is
 * remeshed, for the stream without angles.
 *
 * VG_ERR_INPUT for a patch that the surface lacks or that has no trailing edge,
 * for angles of attack without a known direction that points up, and for more
 * than VG_WAKE_SOURCES sources. VG_ERR_MEMORY. */
#define VG_WAKE_SOURCES 200000
vg_status vg_read_place_wakes(struct vg_read *r, struct vg_error *err);

void vg_read_wakes_release(struct vg_read_wakes *w);

/** 1 for a sheet that the table `wakes` has added to the surface, or that its
 * file marks (vg_read_surf_settings). */
int vg_patch_is_marked_sheet(const struct vg_patch *p);

#endif
