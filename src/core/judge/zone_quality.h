/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/zone_quality.h: figures of the zones of a mesh, and whether
 * interfaces separate them. Uses core/mesh. */
#ifndef VG_CORE_JUDGE_ZONE_QUALITY_H
#define VG_CORE_JUDGE_ZONE_QUALITY_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "core/mesh/zones.h"

/** Figures of a zone. */
struct vg_zone_report {
  uint64_t n_cell;
  double volume;
  double angle_min; /* smallest dihedral angle of its tetrahedra, degrees; 180
                       without tetrahedra */
  /* Edges of its tetrahedra: the mean over the cells of their mean edge, and
   * the largest one; 0 without tetrahedra. */
  double edge_mean, edge_max;
};

struct vg_zone_quality;

/** m: its zones stay in use until vg_zone_quality_free. *out is NULL without
 * zones. VG_ERR_MEMORY. */
vg_status vg_zone_quality_new(const struct vg_mesh *m,
                              struct vg_zone_quality **out,
                              struct vg_error *err);

/** Add the cells of a slice. q may be NULL. Threads: any number at once.
 * VG_ERR_MEMORY. */
vg_status vg_zone_quality_add(struct vg_zone_quality *q,
                              const struct vg_slice *slice,
                              struct vg_error *err);

/** After all slices. Volumes and edges are exact sums, so that they depend
 * neither on slices nor on ranks. Collective.
 * @param report  out: [n_zone], the same on all ranks */
vg_status vg_zone_quality_sum(struct vg_comm *comm,
                              const struct vg_zone_quality *q,
                              struct vg_zone_report *report,
                              struct vg_error *err);

/** Accepts NULL. */
void vg_zone_quality_free(struct vg_zone_quality *q);

/** Triangles of interfaces that do not lie between two zones: *n of them; the
 * first one is at x. O(n). VG_ERR_MEMORY. */
vg_status vg_interfaces_judge(const struct vg_mesh *m, size_t *n, double x[3],
                              struct vg_error *err);

/** Faces between cells of two zones that are in no interface, although an
 * interface lies between these zones: *n of them; the first one is at x
 * (zone_faces.c). Zones without an interface between them may touch, as in
 * files of other programs. O(n + k log k) with k faces whose points are in
 * several zones. VG_ERR_MEMORY. */
vg_status vg_zone_faces_judge(const struct vg_mesh *m, size_t *n, double x[3],
                              struct vg_error *err);

/** Figures of the zones of a whole mesh.
 * @param report  out: [n_zone], to be freed; NULL without zones
 * VG_ERR_MEMORY. */
vg_status vg_zone_quality_judge(const struct vg_mesh *m,
                                struct vg_zone_report **report,
                                struct vg_error *err);

#endif
