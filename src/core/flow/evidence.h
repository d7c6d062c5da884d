/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/flow/evidence.h: evidence for a body or for an outer boundary, shell by
 * shell. Private to core/flow and its tests. */
#ifndef VG_CORE_FLOW_EVIDENCE_H
#define VG_CORE_FLOW_EVIDENCE_H

#include "core/flow/flow.h"

/** Role and location of a patch. A patch is an end if it is flat, the whole
 * shell is on one side of its plane, and the rest of the shell meets that plane
 * steeply along the border of the patch:
 *
 *       walls                     wall
 *    +----------+            ____________
 *  > | end      | end       |            \
 *    +----------+           |  \ flat, but no end: the engine
 *       a duct              |___/ face of a nacelle */
struct vg_flow_patch {
  enum vg_flow_role role;
  int has_condition; /* 1: the role follows from a boundary condition. */
  int is_used;       /* 1: the patch has triangles. */
  int is_flat;
  int is_end;
  int is_flush;   /* 1: flat, on the outermost plane of its shell, and the walls
                     around it lie in the same plane. */
  uint32_t shell; /* Shell of its first triangle. */
  double area;
  double normal[3]; /* Sum of the normals of its triangles; its length is twice
                       the area. */
  double plane;     /* If the patch is flat: coordinate of its plane along the
                       unit normal. */
};

/** One outermost shell and the shells inside it. Volumes are unsigned. */
struct vg_flow_shell {
  uint32_t shell; /* Number in the report. */
  int is_closed;
  int points_in;            /* 1: its triangles point into it, as read. */
  size_t n_inside;          /* Number of shells directly inside it. */
  double share;             /* Volume of these relative to its own. */
  double detail;            /* Number of triangles of these relative to its
                               own. */
  double covered;           /* Fraction of its hull's silhouette that it covers
                               (core/surface/envelope.h); set if n_inside > 0 or
                               the shell is the only one. */
  int has_pocket;           /* 1: the only shell, and a box or part of a sphere
                               with a body inside that is connected to it. */
  int is_box;               /* 1: nearly all of it is on its bounding box. */
  int is_named_enclosure;   /* 1: one of its patches has the name of an
                               enclosure. */
  size_t n_role[VG_ROLE_N]; /* Number of patches by role. */
  size_t n_opening;         /* Relevant inlets and outlets: those with a
                               condition, and flat ones by name. */
  size_t n_opening_end;     /* Those of n_opening that are flat ends of the
                               shell. */
  size_t n_opening_flush;   /* Those of n_opening that are flush. */
  size_t n_symmetry_end;    /* Symmetry planes that are flat ends. */
  size_t n_plain_end;       /* Flat ends without condition and name. */
  char openings[120];       /* Text of the openings: "1 (inlet), 2 (outlet)". */
  char far[120];            /* Patches with a farfield role. */
  char plain[120];          /* Flat ends without condition and name. */
};

struct vg_flow_evidence {
  const struct vg_mesh *m;
  const struct vg_surface_report *r;
  struct vg_flow_patch *patch; /* [m->n_patch] Owned. */
  size_t n_shell;              /* Number of outermost shells. */
  struct vg_flow_shell *shell; /* [n_shell] Owned. */
  uint32_t *slot;              /* [r->n_shell] Index in shell[] of the outermost
                                  shell around each shell, or of the shell
                                  itself; owned. */
  int *depth;                  /* [r->n_shell] Depth of each shell; 0:
                                  outermost. Owned. */
  uint8_t *in_pocket;          /* [m->n_tri] 1: the triangle belongs to a body
                                  inside an outer boundary of the same shell;
                                  owned; NULL: there is no such shell. */
  uint8_t *crossed;            /* [r->n_shell] 1: the shell intersects another
                                  one, so that its nesting is undefined;
                                  owned. */
};

/** Collect the evidence on the surface m with report r.
 *
 * @param by_box  1: shells that are not closed count as inside a closed shell
 *                whose box contains their box (for dirty surfaces)
 * *e is empty on entry; on failure it can be released. O(n log n). */
vg_status vg_flow_collect(const struct vg_mesh *m,
                          const struct vg_surface_report *r, int by_box,
                          struct vg_flow_evidence *e, struct vg_error *err);

void vg_flow_evidence_release(struct vg_flow_evidence *e);

/** core/flow/patches.c: role and location of each patch. The caller frees
 * *out. */
vg_status vg_flow_patches(const struct vg_mesh *m,
                          const struct vg_surface_report *r,
                          struct vg_flow_patch **out, struct vg_error *err);

/** core/flow/shape.c: set the members that depend on the shape of the shell.
 * O(n log n). */
vg_status vg_flow_measure_shape(struct vg_flow_evidence *e,
                                struct vg_flow_shell *s, struct vg_error *err);

/** core/flow/roles.c: does the patch have the name of an enclosure, such as a
 * tunnel? */
int vg_flow_is_enclosure(const struct vg_patch *p);

#endif
