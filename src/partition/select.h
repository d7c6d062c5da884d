/* partition/select.h: the part of a front that a region needs. Uses job.h. */
#ifndef VG_PARTITION_SELECT_H
#define VG_PARTITION_SELECT_H

#include "partition/job.h"

/** Boxes around runs of faces: what lies far off is passed over in one. */
struct vg_select {
  const struct vg_front *front;   /* borrowed */
  const struct vg_sizing *sizing; /* borrowed */
  size_t n_box;
  struct vg_select_box { double lo[3], hi[3]; } *box;
  uint32_t *local;           /* [front->n_point] scratch, all UINT32_MAX */
};

vg_status vg_select_open(struct vg_select *s, const struct vg_front *front,
                         const struct vg_sizing *sizing,
                         struct vg_error *err);
void vg_select_close(struct vg_select *s);

/** Faces within VG_BAND_FRONT of the region, with their points.
 * part out: a front of its own; point, face out: [part->n_point, n_face] which
 * of the whole they are; all to be freed by the caller. */
vg_status vg_select_part(struct vg_select *s, const struct vg_region *region,
                         struct vg_front *part, uint32_t **point,
                         uint32_t **face, struct vg_error *err);

/** Put the faces of a front into an order that keeps neighbours together. */
vg_status vg_select_sort(struct vg_front *f, struct vg_error *err);

#endif
