/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/flow/flow.h: determines on which side of a surface the fluid is, and
 * which parts of the surface bound it.
 *
 * The decision is made once, before the surface is wrapped, remeshed or
 * completed. Evidence is collected shell by shell (core/flow/evidence.h), each
 * outermost shell is classified by itself (core/flow/verdict.h), and the
 * verdicts are combined:
 *
 *     external flow                        internal flow
 *  . . . . . . . . . . . .             +-----------------------+
 *  .   +------------+    .             |  outer boundary       |
 *  .   | body       |    .             |      +---------+      |
 *  .   |   +----+   |    .             |      | body    |      |
 *  .   |   |//// sealed  .             |      |   +--+  |      |
 *  .   |   +----+ cavity .             |      |   |//| cavity  |
 *  .   +------------+    .             |      |   +--+  |      |
 *  . . . . farfield  . . .             |      +---------+      |
 *                                      +-----------------------+
 *
 * Sealed cavities are dropped. A half model, open along a coordinate plane, is
 * classified together with its mirror image. If the evidence supports two
 * readings, the result is an error that names both. Uses core/surface,
 * core/domain. */
#ifndef VG_CORE_FLOW_FLOW_H
#define VG_CORE_FLOW_FLOW_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"
#include "core/surface/surface_check.h"

enum vg_flow_kind {
  VG_FLOW_UNKNOWN,  /* As option: to be determined; as result: undecidable. */
  VG_FLOW_EXTERNAL, /* Bodies in a fluid without a given outer boundary. */
  VG_FLOW_INTERNAL  /* The surface is the whole boundary. */
};

/** Half models: the values of the setting `half`. */
enum vg_flow_half {
  VG_HALF_AUTO, /* From open rims and conditions. */
  VG_HALF_NO,   /* The model is whole. */
  VG_HALF_YES,  /* Open rims are in the symmetry plane. */
  VG_HALF_X,
  VG_HALF_Y,
  VG_HALF_Z /* The symmetry plane is normal to this axis; a flat cap in it is
               removed. */
};

/** The side to which triangles point, as defined by the format of the input. */
enum vg_flow_side {
  VG_SIDE_FREE,   /* Undefined, or files of both kinds exist. */
  VG_SIDE_USUAL,  /* Into the fluid, with exceptions (UGRID, AFLR). */
  VG_SIDE_DEFINED /* Into the fluid (VGRID, this interface). */
};

struct vg_flow_options {
  enum vg_flow_kind kind; /* The reading that the user requested. */
  const char *asked_by;   /* Option that requests it, as "--flow internal"; NULL
                             if kind is UNKNOWN. */
  enum vg_flow_half half;
  enum vg_flow_side side; /* Defined by the format of the input. */
  int all_regions;        /* 1: mesh every region of fluid, including sealed
                             cavities. */
  int repair;             /* 1: shells may be turned. */
  int require_bc;         /* As in vg_surface_check_options. */
  int threads;            /* 0: one per core. The result does not depend on
                             it. */
  struct vg_stop stop;
};

#define VG_FLOW_EVIDENCE 12 /* most lines of evidence */
#define VG_FLOW_TEXT 320    /* bytes per line */

/** The result. Texts are complete English phrases without a full stop. */
struct vg_flow {
  enum vg_flow_kind kind;
  int axis;                 /* Half model: axis of its symmetry plane; -1: whole
                               model. */
  double at;                /* Coordinate of that plane. */
  double root_off;          /* Largest distance by which points of the root were
                               moved into that plane; 0: it was flat. */
  size_t n_body;            /* Closed (or cut) bodies in the fluid. */
  size_t n_outer;           /* Outer boundaries: the number of fluid regions. */
  size_t n_cavity;          /* Sealed cavities that were dropped. */
  double cavity_volume;     /* Total volume of the sealed cavities. */
  double cavity_at[3];      /* Centre of the box of the largest one. */
  size_t n_inlet, n_outlet; /* Patches by condition or name. */
  int cap_axis;             /* Axis of the plane of a flat cap that may close a
                               half model; -1: none. */
  double cap_at;            /* Coordinate of that plane. */
  size_t n_cap_tri;         /* Triangles of the cap if it was removed. */
  uint8_t *on_outer;        /* [n_patch] 1: the patch belongs to an outer
                               boundary; owned; NULL while kind is UNKNOWN. */
  int n_evidence;
  char evidence[VG_FLOW_EVIDENCE][VG_FLOW_TEXT];
};
#define VG_FLOW_INIT                                                           \
  {                                                                            \
    .axis = -1, .cap_axis = -1                                                 \
  }

void vg_flow_release(struct vg_flow *f);

/** Decide which flow the surface bounds, and prepare the surface for it: shells
 * point into the fluid, sealed cavities and the cap of a half model are
 * removed.
 *
 * @param m  triangles; on success only dropped and turned, and the points of
 *           the root of a half model moved into its plane
 * @param r  in: report of vg_surface_check on m with `external` -1; out: report
 *           on the changed m
 * A surface with open rims that are not those of a half model, or with other
 * defects, is classified as far as its closed shells permit, and turned only if
 * open edges are its only defects; the caller refuses it. VG_ERR_INPUT if the
 * evidence supports two readings or contradicts the options: the message names
 * both readings and the options that select them. *out is released first, and
 * untouched on failure; m and r may then have changed. O(n log n). */
vg_status vg_flow_settle(struct vg_mesh *m, struct vg_surface_report *r,
                         const struct vg_flow_options *o, struct vg_flow *out,
                         struct vg_error *err);

/** Find the triangles that belong to outer boundaries, so that a wrap of the
 * bodies excludes them. This also works for dirty surfaces: shells that are not
 * closed count as inside a shell whose box contains their box.
 *
 * @param outer  out: [m->n_tri]
 * @param n      out: number of outer boundaries
 * Errors as for vg_flow_settle. */
vg_status vg_flow_outer(const struct vg_mesh *m,
                        const struct vg_surface_report *r,
                        const struct vg_flow_options *o, uint8_t *outer,
                        size_t *n, struct vg_error *err);

/** Summarise the result: "External flow around 2 closed bodies; farfield
 * added".
 *
 * @param adds_farfield  1: the program completes the domain
 * @param out            out: [VG_FLOW_TEXT] */
void vg_flow_statement(const struct vg_flow *f, int adds_farfield, char *out);

/** The role of a patch by its condition or, if it has none, by its name. */
enum vg_flow_role {
  VG_ROLE_NONE, /* Neither condition nor name determines a role. */
  VG_ROLE_WALL,
  VG_ROLE_SYMMETRY,
  VG_ROLE_FARFIELD,
  VG_ROLE_INLET,
  VG_ROLE_OUTLET,
  VG_ROLE_OTHER, /* A condition or name with another meaning. */
  VG_ROLE_N
};

/** Role of a patch. Codes of USM3D and FUN3D are equivalent. O(length of the
 * name). */
enum vg_flow_role vg_flow_role_of(const struct vg_patch *p);

#endif
