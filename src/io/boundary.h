/* io/boundary.h: what readers do to the boundary faces of a file to meet the
 * conventions of core/mesh.h, whatever the format. */
#ifndef VG_IO_BOUNDARY_H
#define VG_IO_BOUNDARY_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh.h"

/** Make patches out of face tags: m->patch with ascending ids, nameless, and
 * m->tri_patch, m->quad_patch. m has none of them yet.
 *
 * @param tag  [n_tri + n_quad] triangles first
 * O(n) for few tags, O(n log n) at worst. VG_ERR_MEMORY on refusal. */
vg_status vg_boundary_tag(struct vg_mesh *m, const int32_t *tag,
                          struct vg_error *err);

/** Sort the boundary faces by patch: (*order)[(*start)[p]] up to, excluding,
 * (*order)[(*start)[p + 1]] are those of patch p, in their order in m;
 * triangles are numbered first, quadrilaterals from n_tri on. The caller frees
 * both. O(n). VG_ERR_MEMORY on refusal. */
vg_status vg_boundary_by_patch(const struct vg_mesh *m, size_t **start,
                               size_t **order, struct vg_error *err);

/** What vg_boundary_orient found and did. */
struct vg_orient_report {
  size_t n_cell_turned;     /* cells of negative volume, renumbered */
  size_t n_face_turned;     /* boundary faces that pointed out of their cell */
  size_t n_face_inner;      /* faces between two cells, dropped: interfaces of
                               volume regions bound no fluid */
  size_t n_face_loose;      /* faces of no cell, kept as they are */
};

/** Make the cells of m positive and turn boundary faces into their cell.
 * A mesh without cells is left as it is. All node indices are valid.
 * O(n). VG_ERR_MEMORY leaves a valid mesh. @param report may be NULL. */
vg_status vg_boundary_orient(struct vg_mesh *m, struct vg_orient_report *report,
                             struct vg_error *err);

#endif
