/* core/flow/evidence.h: what speaks for a body or for an outer boundary, shell
 * by shell. Private to core/flow and its tests. */
#ifndef VG_CORE_FLOW_EVIDENCE_H
#define VG_CORE_FLOW_EVIDENCE_H

#include "core/flow/flow.h"

/** What a patch is and where it lies. A patch is an end when it is flat, when
 * the whole shell lies on one side of its plane, and when the rest of the shell
 * meets that plane steeply along its border:
 *
 *        walls                     wall
 *     +----------+            ____________
 *   > | end      | end       |            \
 *     +----------+           |  \ flat, but no end: the engine
 *        a duct              |___/ face of a nacelle */
struct vg_flow_patch {
  enum vg_flow_role role;
  int has_condition; /* its role comes from a condition */
  int is_used;       /* it has triangles */
  int is_flat;
  int is_end;
  uint32_t shell; /* shell of its first triangle */
  double area;
  double normal[3]; /* sum of its triangles' normals, 2 area long */
  double plane;     /* coordinate of the plane along the unit
                       normal; where the patch is flat */
};

/** One outermost shell with everything inside it. Volumes are not signed. */
struct vg_flow_shell {
  uint32_t shell; /* number in the report */
  int is_closed;
  int points_in;            /* its triangles point into it, as read */
  size_t n_inside;          /* shells directly inside it */
  double share;             /* volume of these over its own */
  double detail;            /* triangles of these over its own */
  double covered;           /* share of its hull's silhouette that it
                               covers (core/surface/envelope.h); where
                               n_inside > 0 or the shell stands alone */
  int has_pocket;           /* alone, and a box or part of a sphere with a
                               body standing in it */
  int is_box;               /* nearly all of it lies on its bounding box */
  int is_named_enclosure;   /* one of its patches is named as one */
  size_t n_role[VG_ROLE_N]; /* patches by role */
  size_t n_opening;         /* inlets and outlets that count: those with a
                               condition, and flat ones by name */
  size_t n_opening_end;     /* of them, flat ends of the shell */
  size_t n_symmetry_end;    /* symmetry planes that are flat ends */
  size_t n_plain_end;       /* flat ends without condition and name */
  char openings[120];       /* "1 (inlet), 2 (outlet)" */
  char far[120];            /* patches with a farfield role */
  char plain[120];          /* flat ends without condition and name */
};

struct vg_flow_evidence {
  const struct vg_mesh *m;
  const struct vg_surface_report *r;
  struct vg_flow_patch *patch; /* [m->n_patch] owned */
  size_t n_shell;              /* outermost shells */
  struct vg_flow_shell *shell; /* [n_shell] owned */
  uint32_t *slot;              /* [r->n_shell] index in shell[] of the
                                  outermost shell around each, or of itself;
                                  owned */
  int *depth;                  /* [r->n_shell] 0 outermost; owned */
  uint8_t *in_pocket;          /* [m->n_tri] 1: the triangle belongs to what
                                  stands in an outer boundary of the same
                                  shell; owned; NULL: there is no such shell */
  uint8_t *crossed;            /* [r->n_shell] 1: the shell meets another one,
                                  so that it lies in none; owned */
};

/** Collect the evidence.
 * @param by_box  1: shells that are not closed count as inside a closed one
 *                whose box contains theirs (dirty surfaces)
 * *e is empty before; on failure it stays releasable. O(n log n). */
vg_status vg_flow_collect(const struct vg_mesh *m,
                          const struct vg_surface_report *r, int by_box,
                          struct vg_flow_evidence *e, struct vg_error *err);

void vg_flow_evidence_release(struct vg_flow_evidence *e);

/** core/flow/patches.c: role and place of each patch; the caller frees *out. */
vg_status vg_flow_patches(const struct vg_mesh *m,
                          const struct vg_surface_report *r,
                          struct vg_flow_patch **out, struct vg_error *err);

/** core/flow/shape.c: the members that follow from the shape of the shell.
 * O(n log n). */
vg_status vg_flow_measure_shape(struct vg_flow_evidence *e,
                                struct vg_flow_shell *s, struct vg_error *err);

/** core/flow/roles.c: the name is that of an enclosure, such as a tunnel. */
int vg_flow_is_enclosure(const struct vg_patch *p);

#endif
