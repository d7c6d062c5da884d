/* core/remesh/stretch.h: lines of a surface along which edges are longer than
 * across them, and the tensors around these. Private to core/remesh.
 *
 * On a line, edges along it are asked for that are a number of times as long as
 * its sizes say, but no longer than a chord within the tolerance is. Away from
 * it that length falls by growth - 1 per length, while sizes grow, until both
 * are the same. The nearest place of a line decides; where several lines ask
 * for other directions, they take from one another, so that edges across
 * a corner of two are as long in both. */
#ifndef VG_CORE_REMESH_STRETCH_H
#define VG_CORE_REMESH_STRETCH_H

#include "core/remesh/work.h"
#include "core/search/box_tree.h"

struct vg_stretch_place {
  double x[3], way[3]; /* a place on a line, its direction there */
  double at, along;    /* length of the curve; edges asked for */
};

struct vg_stretch_run {    /* along a curve, between places one another */
  size_t first, n;         /* its places; at least 2 */
  struct vg_box_tree tree; /* of the pieces between its places, in order */
  double by, most;         /* times; largest `along` */
};

struct vg_stretch {
  const double *by; /* [3 n_tri] borrowed: along half-edges of the
                       reference, on both sides of an edge; 1 or less:
                       not */
  double slope, h_max;
  size_t n_run, cap_run, n_place, cap_place;
  struct vg_stretch_run *run;
  struct vg_stretch_place *place;
};

/** From s->by, along lines of w, which has sizes and lines. O(n).
 * VG_ERR_INPUT, VG_ERR_MEMORY. */
vg_status vg_stretch_make(struct vg_stretch *s, const struct vg_tris *w,
                          struct vg_error *err);

void vg_stretch_release(struct vg_stretch *s);

/** As vg_tris.form, of a struct vg_stretch. O(log n) for each run near x. */
void vg_stretch_form(const void *stretch, const double x[3], double size,
                     double form[6]);

#endif
