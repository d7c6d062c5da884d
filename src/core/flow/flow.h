/* core/flow/flow.h: on which side of a surface is the fluid, and which parts of
 * the surface bound it?
 *
 * The question has one answer, given here once, before the surface is wrapped,
 * remeshed or completed. The evidence is collected shell by shell
 * (core/flow/evidence.h), each outermost shell is judged by itself
 * (core/flow/verdict.h), and the verdicts are combined:
 *
 *      external flow                        internal flow
 *   . . . . . . . . . . . .             +-----------------------+
 *   .   +------------+    .             |  outer boundary       |
 *   .   | body       |    .             |      +---------+      |
 *   .   |   +----+   |    .             |      | body    |      |
 *   .   |   |//// sealed  .             |      |   +--+  |      |
 *   .   |   +----+ cavity .             |      |   |//| cavity  |
 *   .   +------------+    .             |      |   +--+  |      |
 *   . . . . farfield  . . .             |      +---------+      |
 *                                       +-----------------------+
 *
 * Sealed cavities are dropped. A half model, open along a coordinate plane, is
 * judged as the whole that it makes with its mirror image. Where the evidence
 * supports two readings, the answer is an error that names both.
 * Uses core/surface, core/domain. */
#ifndef VG_CORE_FLOW_FLOW_H
#define VG_CORE_FLOW_FLOW_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"
#include "core/surface/surface_check.h"

enum vg_flow_kind {
  VG_FLOW_UNKNOWN,  /* asked: find out; found: it cannot be known */
  VG_FLOW_EXTERNAL, /* bodies in a fluid that has no given end */
  VG_FLOW_INTERNAL  /* the surface is the whole boundary */
};

/** Half models: the words of the setting `half`. */
enum vg_flow_half {
  VG_HALF_AUTO, /* open rims, and conditions, decide */
  VG_HALF_NO,   /* the model is whole */
  VG_HALF_YES,  /* open rims lie in the symmetry plane */
  VG_HALF_X,
  VG_HALF_Y,
  VG_HALF_Z /* symmetry plane across this axis; a flat
         cap in it is removed */
};

/** The side to which triangles point, as the format of the input defines it. */
enum vg_flow_side {
  VG_SIDE_FREE,   /* nothing, or files are found both ways */
  VG_SIDE_USUAL,  /* into the fluid, with exceptions (UGRID,
                     AFLR) */
  VG_SIDE_DEFINED /* into the fluid (VGRID, this interface) */
};

struct vg_flow_options {
  enum vg_flow_kind kind; /* the reading that the user asked for */
  const char *asked_by;   /* option that asks for it, as "--flow
                             internal"; NULL when kind is UNKNOWN */
  enum vg_flow_half half;
  enum vg_flow_side side; /* of the format of the input */
  int all_regions;        /* 1: mesh every region of fluid, sealed
                             cavities too */
  int repair;             /* 1: shells may be turned */
  int require_bc;         /* as in vg_surface_check_options */
  int threads;            /* 0: one per core; the same answer for any */
  struct vg_stop stop;
};

#define VG_FLOW_EVIDENCE 12 /* lines of evidence at most */
#define VG_FLOW_TEXT 320    /* bytes of each */

/** The answer. Texts are complete English phrases without a full stop. */
struct vg_flow {
  enum vg_flow_kind kind;
  int axis;                 /* half model: axis of its plane; -1: whole */
  double at;                /* coordinate of that plane */
  size_t n_body;            /* closed (or cut) bodies in the fluid */
  size_t n_outer;           /* outer boundaries: regions of fluid */
  size_t n_cavity;          /* sealed cavities, dropped */
  double cavity_volume;     /* of all of them */
  double cavity_at[3];      /* a point of the largest one */
  size_t n_inlet, n_outlet; /* patches by condition or name */
  int cap_axis;             /* a flat cap that may close a half model: axis
                               of its plane; -1: none */
  double cap_at;            /* coordinate of that plane */
  size_t n_cap_tri;         /* triangles of a cap that was removed */
  uint8_t *on_outer;        /* [n_patch] 1: the patch belongs to an outer
                               boundary; owned; NULL while kind is UNKNOWN
                               */
  int n_evidence;
  char evidence[VG_FLOW_EVIDENCE][VG_FLOW_TEXT];
};
#define VG_FLOW_INIT                                                           \
  {                                                                            \
    .axis = -1, .cap_axis = -1                                                 \
  }

void vg_flow_release(struct vg_flow *f);

/** Decide which flow the surface bounds, and prepare the surface for it: shells
 * point into the fluid, sealed cavities and the cap of a half model are gone.
 *
 * @param m  triangles; on success only dropped and turned
 * @param r  in: report of vg_surface_check with `external` -1 on m; out: report
 *           on m as it is now
 * A surface with open rims that are not those of a half model, or with other
 * defects, is classified as far as its closed shells permit, and is turned
 * only where it has no other defects than open edges: the caller refuses it.
 * VG_ERR_INPUT where the evidence supports two readings or contradicts the
 * options: the message names both readings and the options that select them.
 * *out is released first, and untouched on failure; m and r may have changed
 * then. O(n log n). */
vg_status vg_flow_settle(struct vg_mesh *m, struct vg_surface_report *r,
                         const struct vg_flow_options *o, struct vg_flow *out,
                         struct vg_error *err);

/** Which triangles belong to outer boundaries, so that a wrap of the bodies
 * leaves them alone. Also for dirty surfaces: shells that are not closed count
 * as inside a shell whose box contains theirs.
 * @param outer  out: [m->n_tri]
 * @param n      out: number of outer boundaries
 * Errors as vg_flow_settle. */
vg_status vg_flow_outer(const struct vg_mesh *m,
                        const struct vg_surface_report *r,
                        const struct vg_flow_options *o, uint8_t *outer,
                        size_t *n, struct vg_error *err);

/** "External flow around 2 closed bodies; farfield added". out[VG_FLOW_TEXT].
 * @param adds_farfield  1: the program completes the domain */
void vg_flow_statement(const struct vg_flow *f, int adds_farfield, char *out);

/** What a patch is by its condition or, where it has none, by its name. */
enum vg_flow_role {
  VG_ROLE_NONE, /* neither condition nor name says anything */
  VG_ROLE_WALL,
  VG_ROLE_SYMMETRY,
  VG_ROLE_FARFIELD,
  VG_ROLE_INLET,
  VG_ROLE_OUTLET,
  VG_ROLE_OTHER, /* a condition or name, of other meaning */
  VG_ROLE_N
};

/** Codes of USM3D and FUN3D count alike. O(length of the name). */
enum vg_flow_role vg_flow_role_of(const struct vg_patch *p);

#endif
