/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/cut/select.h: selection of the faces of a front that a region
 * needs. Uses core/search/box.h, task_data.h, engine.h. */
#ifndef VG_PARTITION_CUT_SELECT_H
#define VG_PARTITION_CUT_SELECT_H

#include "core/search/box.h"
#include "partition/cut/task_data.h"
#include "partition/engine/engine.h"

enum { VG_SELECT_LEVELS = 12 };

/** Hierarchy of boxes: around runs of faces, around runs of these boxes, and
 * so on, so that distant faces are skipped together. The tree grows as
 * faces are appended to the front, whereas the tree of core/search is built
 * as a whole. */
struct vg_select {
  const struct vg_front *front;   /* borrowed */
  const struct vg_sizing *sizing; /* borrowed */
  size_t n_face;                  /* Number of faces that have boxes. */
  struct vg_select_level {
    size_t n, cap;
    struct vg_box *box;
  } level[VG_SELECT_LEVELS]; /* From the smallest boxes up; the last level
                                has one box. */
};

/** Initialises an empty selection. */
void vg_select_init(struct vg_select *s, const struct vg_front *front,
                    const struct vg_sizing *sizing);
void vg_select_release(struct vg_select *s);

/** Adds boxes for faces appended to the front since the last call: O(added), in
 * loops (e may be NULL). */
vg_status vg_select_update(struct vg_select *s, const struct vg_engine *e,
                           struct vg_error *err);

/** Selects the faces that may be within VG_BAND_FRONT of the region, with their
 * points; faces that are gone are skipped.
 * part out: a front of its own; point, face out: [part->n_point, n_face]
 * indices in the whole front; all freed by the caller. Threads: safe. O(part +
 * log front). */
vg_status vg_select_part(const struct vg_select *s,
                         const struct vg_region *region, struct vg_front *part,
                         uint32_t **point, uint32_t **face,
                         struct vg_error *err);

/** Sets region->wide from the faces that cross the region's planes. The cells
 * at a face much longer than the cells around it have corners far from the
 * planes, and can only be kept if the front is known that far. region->wide
 * stays 0 if no such face is longer than the known band. */
vg_status vg_select_widen(const struct vg_select *s, struct vg_region *region,
                          struct vg_error *err);

/** Keeps, of a selected part, only the faces that vg_region_may_meet, with
 * their points; point and face are updated. Untouched on failure. O(part). */
vg_status vg_select_near(struct vg_front *part, const struct vg_region *region,
                         const struct vg_sizing *sizing, uint32_t **point,
                         uint32_t **face, struct vg_error *err);

/** Calls visit(context, f) for the faces of the front that the triangle x may
 * touch, except faces that are gone. Stops when it returns a value other than
 * 0, and returns that value. Threads: safe. */
int vg_select_touched(const struct vg_select *s, const double *const x[3],
                      int (*visit)(void *context, uint32_t face),
                      void *context);

/** Sorts the faces of a front so that neighbours are close in memory. */
vg_status vg_select_sort(struct vg_front *f, struct vg_error *err);

#endif
