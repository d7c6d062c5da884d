/* partition/cut/select.h: the part of a front that a region needs. Uses
 * core/search/box.h, task_data.h, engine.h. */
#ifndef VG_PARTITION_CUT_SELECT_H
#define VG_PARTITION_CUT_SELECT_H

#include "core/search/box.h"
#include "partition/cut/task_data.h"
#include "partition/engine/engine.h"

enum { VG_SELECT_LEVELS = 12 };

/** Boxes around runs of faces, around runs of these, and so on: what lies far
 * off is passed over in one. This tree grows with the faces that are appended
 * to the front, whereas the one of core/search is built as a whole. */
struct vg_select {
  const struct vg_front *front;   /* borrowed */
  const struct vg_sizing *sizing; /* borrowed */
  size_t n_face;                  /* so many have boxes */
  struct vg_select_level {
    size_t n, cap;
    struct vg_box *box;
  } level[VG_SELECT_LEVELS]; /* from the smallest; the last has one */
};

/** Nothing selected yet. */
void vg_select_init(struct vg_select *s, const struct vg_front *front,
                    const struct vg_sizing *sizing);
void vg_select_release(struct vg_select *s);

/** Look at what was added to the front since the last call: O(added), in
 * loops (e may be NULL). */
vg_status vg_select_update(struct vg_select *s, const struct vg_engine *e,
                           struct vg_error *err);

/** Faces that may lie within VG_BAND_FRONT of the region, with their points;
 * without those that are gone.
 * part out: a front of its own; point, face out: [part->n_point, n_face] which
 * of the whole they are; all to be freed by the caller. Threads: safe.
 * O(part + log front). */
vg_status vg_select_part(const struct vg_select *s,
                         const struct vg_region *region, struct vg_front *part,
                         uint32_t **point, uint32_t **face,
                         struct vg_error *err);

/** As wide as the faces ask for that cross the region's planes: the cells at
 * one that is much longer than the cells around it have corners far from the
 * planes, and can only be kept where the front is known so far. Sets
 * region->wide, and leaves it 0 where no such face is longer than what is known
 * anyway. */
vg_status vg_select_widen(const struct vg_select *s, struct vg_region *region,
                          struct vg_error *err);

/** Of such a part only the faces that vg_region_may_meet stay, with their
 * points; point and face follow. Untouched on failure. O(part). */
vg_status vg_select_near(struct vg_front *part, const struct vg_region *region,
                         const struct vg_sizing *sizing, uint32_t **point,
                         uint32_t **face, struct vg_error *err);

/** Call visit(context, f) for the faces of the front that the triangle x may
 * touch, without those that are gone; stops when it returns other than 0, and
 * returns that. Threads: safe. */
int vg_select_touched(const struct vg_select *s, const double *const x[3],
                      int (*visit)(void *context, uint32_t face),
                      void *context);

/** Put the faces of a front into an order that keeps neighbours together. */
vg_status vg_select_sort(struct vg_front *f, struct vg_error *err);

#endif
