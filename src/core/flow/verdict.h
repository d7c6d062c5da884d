/* core/flow/verdict.h: is an outermost shell a body or an outer boundary?
 * Private to core/flow and its tests. */
#ifndef VG_CORE_FLOW_VERDICT_H
#define VG_CORE_FLOW_VERDICT_H

#include "core/flow/evidence.h"

enum vg_flow_verdict {
  VG_FLOW_BODY,  /* the fluid is outside */
  VG_FLOW_OUTER, /* the fluid is inside */
  VG_FLOW_EITHER /* both readings are plausible */
};

/** Judge one shell. The rules, the first that applies decides:
 *
 *  1. a patch with a farfield condition or name: outer boundary;
 *  2. inlets and outlets, two or more, all flat ends: outer boundary (a duct);
 *     all of them inside the silhouette: body with engine faces; else either;
 *  3. orientation, for formats that define it: inward is an outer boundary;
 *     where the format has exceptions and every patch is a wall: either;
 *  4. one shell shaped as a flow domain, a box or part of a sphere with a
 *     pocket around a body (core/flow/shape.c): outer boundary;
 *  5. shells inside: an enclosure by name is an outer boundary; a shell that
 *     covers little of its hull is a body, so is one that the shells inside
 *     fill by much, and one with bubbles of few triangles; a box with detailed
 *     shells that fill little of it is an outer boundary; else either;
 *  6. named walls with flat ends that have neither condition nor name: either;
 *  7. symmetry conditions on two flat ends or more: either;
 *  8. else: body.
 *
 * @param why  out: [VG_FLOW_TEXT] the evidence; of VG_FLOW_EITHER both readings
 */
enum vg_flow_verdict vg_flow_judge(const struct vg_flow_shell *s,
                                   enum vg_flow_side side, char *why);

#endif
