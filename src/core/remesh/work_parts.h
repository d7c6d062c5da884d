/* core/remesh/work_parts.h: checks that the changes of work_change.c share.
 * Private to core/remesh. */
#ifndef VG_CORE_REMESH_WORK_PARTS_H
#define VG_CORE_REMESH_WORK_PARTS_H

#include "core/remesh/work.h"

#define VG_WORK_NEW (VG_WORK_RING + 4)
#define VG_WORK_SAMPLES 4096

/* A part of the surface that is to be replaced. */
struct vg_cavity {
  size_t n_old, n_new, n_sample;
  uint32_t old[VG_WORK_NEW]; /* triangles */
  const struct vg_tris_point *corner[VG_WORK_NEW][3];
  uint8_t edges[VG_WORK_NEW]; /* bit k: edge k is new, and not on a
                                 curve */
  uint16_t was[VG_WORK_NEW];  /* on a curve: of the old ones, that
                                 which the new one takes the place of */
  int on_curve;               /* the triangles are on two sides of it */
  double tolerance, shape;    /* out: of the new ones, the least */
  uint32_t hint;
  struct vg_ref_tri made[VG_WORK_NEW]; /* of the new ones, for samples */
  uint32_t fresh;                      /* sample that a point is which goes;
                                          VG_REF_NONE: none */
  uint32_t sample[VG_WORK_SAMPLES];
  uint16_t goes[VG_WORK_SAMPLES]; /* to which new one */
};

void vg_cavity_begin(const struct vg_tris *w, struct vg_cavity *c,
                     uint32_t point);

/** The tolerance is the least around. */
void vg_cavity_narrow(const struct vg_tris *w, struct vg_cavity *c,
                      uint32_t point);

/** Add a triangle that will be there. */
void vg_cavity_add(struct vg_cavity *c, const struct vg_tris_point *x,
                   const struct vg_tris_point *y, const struct vg_tris_point *z,
                   int edges);

/** Tolerance at points of this size. */
double vg_tris_tolerance(const struct vg_tris *w, double size);

/** Sets c->shape: cheap, before what follows. */
void vg_cavity_measure(const struct vg_tris *w, struct vg_cavity *c);

/** Are the new triangles within the tolerance of the reference, facing its
 * way, and the samples of the old ones within that of the new ones? */
int vg_cavity_fits(const struct vg_tris *w, struct vg_cavity *c);

/** Give the samples to the new triangles, numbers t[n_new]. The old ones'
 * lists are empty afterwards. */
void vg_cavity_settle(struct vg_tris *w, const struct vg_cavity *c,
                      const uint32_t *t);

#endif
