/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/flow/verdict.h: classifies an outermost shell as body or outer boundary.
 * Private to core/flow and its tests. */
#ifndef VG_CORE_FLOW_VERDICT_H
#define VG_CORE_FLOW_VERDICT_H

#include "core/flow/evidence.h"

enum vg_flow_verdict {
  VG_FLOW_BODY,  /* The fluid is outside. */
  VG_FLOW_OUTER, /* The fluid is inside. */
  VG_FLOW_EITHER /* Both readings are plausible. */
};

/** Classify one shell. The first rule that applies decides:
 *
 *  1. a patch with a farfield condition or name: outer boundary;
 *  2. inlets and outlets: if there are at least two and all are flat ends, or
 *     flush with walls on the outermost planes: outer boundary (a duct, a
 *     room); if all are inside the silhouette: body with engine faces; else
 *     either;
 *  3. triangles point inwards, and the format defines their side: outer
 *     boundary; but either, if the format has exceptions and every patch is a
 *     wall;
 *  4. the only shell is shaped like a flow domain, a box or part of a sphere
 *     with a pocket around a body (core/flow/shape.c): outer boundary;
 *  5. there are shells inside: outer boundary if it has the name of an
 *     enclosure; body if it covers little of its hull, if the shells inside
 *     fill much of it, or if they are bubbles of few triangles; outer boundary
 *     if it is a box with detailed shells that fill little of it; else either;
 *  6. named walls, and flat ends with neither condition nor name: either;
 *  7. symmetry conditions on two or more flat ends: either;
 *  8. else: body.
 *
 * @param why  out: [VG_FLOW_TEXT] the evidence; for VG_FLOW_EITHER both
 *             readings */
enum vg_flow_verdict vg_flow_judge(const struct vg_flow_shell *s,
                                   enum vg_flow_side side, char *why);

#endif
