/* core/remesh/strips_cut.h: cuts edges of a surface, in which it stays as it
 * is, and marks what is between them. Private to core/remesh. */
#ifndef VG_CORE_REMESH_STRIPS_CUT_H
#define VG_CORE_REMESH_STRIPS_CUT_H

#include "core/remesh/strips.h"

/* Half-edges of triangles that are cut move: where those are now that the
 * surface began with. */
struct vg_strip_cutter {
  struct vg_strips *s;
  size_t cap_point, cap_tri, cap_patch, cap_from, cap_ends, cap_mate, cap_half,
    cap_closed;
  uint32_t *mate;  /* [3 n_tri] */
  uint32_t *where; /* [3 n_tri at the beginning] */
  uint32_t edge;   /* cut last: where[edge] is what is left of it */
  double begun;    /* from there on */
};

/** Begin with the mesh that r was built on. VG_ERR_MEMORY. */
vg_status vg_strip_cutter_begin(struct vg_strip_cutter *c,
                                const struct vg_ref *r, const struct vg_mesh *m,
                                struct vg_error *err);

/** Mark half-edge h of the beginning as closed from t0 to t1 of it: below 0 and
 * above 1 are its ends. Calls for one edge come one after the other, in the
 * order along it. VG_ERR_MEMORY. */
vg_status vg_strip_cut(struct vg_strip_cutter *c, uint32_t h, double t0,
                       double t1, struct vg_error *err);

void vg_strip_cutter_release(struct vg_strip_cutter *c);

#endif
