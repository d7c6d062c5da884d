/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/work_parts.h: the checks shared by the changes of work_change.c.
 * Private to core/remesh. */
#ifndef VG_CORE_REMESH_WORK_PARTS_H
#define VG_CORE_REMESH_WORK_PARTS_H

#include "core/remesh/work.h"

#define VG_WORK_NEW (VG_WORK_RING + 4)
#define VG_WORK_SAMPLES 4096

/* A change: the part of the surface that is replaced, and its replacement. */
struct vg_cavity {
  size_t n_old, n_new, n_sample;
  uint32_t old[VG_WORK_NEW]; /* Old triangles. */
  const struct vg_tris_point *corner[VG_WORK_NEW][3];
  uint8_t edges[VG_WORK_NEW]; /* Bit k: edge k is new and not a feature edge. */
  uint16_t was[VG_WORK_NEW];  /* On a curve: index in `old` of the triangle that
                                 the new one replaces. */
  int on_curve;               /* The triangles are on both sides of a feature
                                 curve. */
  double tolerance, shape;    /* Tolerance at its points; out: least shape of
                                 the new triangles. */
  uint32_t hint;
  struct vg_ref_tri made[VG_WORK_NEW]; /* Geometry of the new triangles, for
                                          samples. */
  uint32_t fresh;                      /* Reference point that becomes a sample
                                          by the change; VG_REF_NONE: none. */
  uint32_t sample[VG_WORK_SAMPLES];
  uint16_t goes[VG_WORK_SAMPLES]; /* New triangle of each sample. */
};

void vg_cavity_begin(const struct vg_tris *w, struct vg_cavity *c,
                     uint32_t point);

/** Reduce the tolerance to that of the point. */
void vg_cavity_narrow(const struct vg_tris *w, struct vg_cavity *c,
                      uint32_t point);

/** Add a new triangle. */
void vg_cavity_add(struct vg_cavity *c, const struct vg_tris_point *x,
                   const struct vg_tris_point *y, const struct vg_tris_point *z,
                   int edges);

/** Tolerance for a target length of `size`. */
double vg_tris_tolerance(const struct vg_tris *w, double size);

/** Set c->shape. Cheap; called before vg_cavity_fits. */
void vg_cavity_measure(const struct vg_tris *w, struct vg_cavity *c);

/** Are the new triangles within the tolerance of the reference and oriented
 * like it, and the samples of the old triangles within the tolerance of the new
 * ones? */
int vg_cavity_fits(const struct vg_tris *w, struct vg_cavity *c);

/** Assign the samples to the new triangles t[n_new]. The sample lists of the
 * old triangles are empty afterwards. */
void vg_cavity_settle(struct vg_tris *w, const struct vg_cavity *c,
                      const uint32_t *t);

#endif
