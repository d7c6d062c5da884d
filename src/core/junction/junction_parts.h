/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/junction/junction_parts.h: private to core/junction. */
#ifndef VG_CORE_JUNCTION_JUNCTION_PARTS_H
#define VG_CORE_JUNCTION_JUNCTION_PARTS_H

#include "core/junction/junction.h"

#define VG_JUNCTION_NONE UINT32_MAX

/** Index of the edge between points a and b of j->m in j->edge; SIZE_MAX: it is
 * on no junction. */
size_t vg_junction_edge(const struct vg_junctions *j, uint32_t a, uint32_t b);

/** Mark the curves that have edges of a piece. on: [j->n], 0 before. */
void vg_junctions_of(const struct vg_junctions *j, uint32_t piece, uint8_t *on);

/* A piece whose triangles change. Removed triangles have equal corners. */
struct vg_junction_sheet {
  struct vg_mesh *m;
  size_t cap[3];         /* Of point, tri and tri_patch. */
  uint32_t *head, *next; /* [n_point] first corner 3 t + k at each point;
                            [3 n_tri] the next one; VG_JUNCTION_NONE: none */
  size_t cap_head, cap_next;
};

/** Fill the corners of s->m. VG_ERR_MEMORY. */
vg_status vg_junction_sheet_open(struct vg_junction_sheet *s, struct vg_mesh *m,
                                 struct vg_error *err);
void vg_junction_sheet_release(struct vg_junction_sheet *s);

/** Insert a point into the edge from a to b. */
vg_status vg_junction_split(struct vg_junction_sheet *s, uint32_t a, uint32_t b,
                            const double x[3], uint32_t *made,
                            struct vg_error *err);

/** Remove point v from the curve that passes through a, v and b, whose
 * triangles on either side are replaced by others without v. Returns 0, with
 * nothing changed, if the triangles would fold or meet others. */
int vg_junction_drop(struct vg_junction_sheet *s, uint32_t a, uint32_t v,
                     uint32_t b);

#endif
