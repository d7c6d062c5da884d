/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/picture/cuts.h: pictures of planes through a mesh that no process holds
 * as a whole. Uses core/mesh/slices.h, run/picture/image.h.
 *
 * Every rank draws the cells that it has in memory into samples of its own. A
 * sample belongs to the cell that contains its centre. If several cells draw
 * into one sample (on a shared edge), the larger code wins, so pictures do not
 * depend on the order of cells, threads and ranks. Memory depends on the
 * samples drawn, not on the number of cells. */
#ifndef VG_RUN_PICTURE_CUTS_H
#define VG_RUN_PICTURE_CUTS_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "run/picture/image.h"

enum { VG_CUTS_MAX = 12, VG_CUT_WIDTH = 864, VG_CUT_HEIGHT = 576 }; /* V2 */

/** A plane and a window in it. */
struct vg_cut {
  int axis;         /* Normal: 0 x, 1 y, 2 z. */
  double at;        /* Coordinate of the plane along the normal. */
  double centre[2]; /* Centre of the window, in the other two axes in ascending
                       order. */
  double width;     /* Width of the window, a length; its height is two thirds
                       of that. */
};

/** Meaning of the colours. */
enum vg_cut_colours {
  VG_CUT_BY_KIND, /* Kinds of cells; layers or field. */
  VG_CUT_BY_PART, /* The subdomain in which a cell was made. */
  VG_CUT_BY_ANGLE /* Smallest dihedral angle of the cells of the field. */
};

/** Bounds of the steps of VG_CUT_BY_ANGLE in degrees, and colours for
 * legends. */
#define VG_CUT_ANGLES 5
extern const int vg_cut_angle[VG_CUT_ANGLES];
extern const uint8_t vg_cut_angle_colour[VG_CUT_ANGLES + 1][3];

/** Colours of VG_CUT_BY_KIND, in the order of enum vg_cut_kind. */
enum vg_cut_kind {
  VG_CUT_FIELD,
  VG_CUT_LAYER_TET,
  VG_CUT_PYRAMID,
  VG_CUT_PRISM,
  VG_CUT_HEXAHEDRON,
  VG_CUT_KINDS
};
extern const uint8_t vg_cut_kind_colour[VG_CUT_KINDS][3];

/** Colour of separator cells in VG_CUT_BY_PART; layers are grey. */
extern const uint8_t vg_cut_zone_colour[3];

struct vg_cuts;

/** @param n    number of cuts, at most VG_CUTS_MAX
 *
 * VG_ERR_MEMORY. */
vg_status vg_cuts_new(size_t n, const struct vg_cut *cut, struct vg_cuts **out,
                      struct vg_error *err);

/** Accepts NULL. */
void vg_cuts_free(struct vg_cuts *c);

/** Draws the cells of a slice; a vg_slice_body, safe for any number of threads.
 * Costs a comparison per point and plane, and the pixels of the cells cut.
 * VG_ERR_MEMORY. */
vg_status vg_cuts_put(void *cuts, const struct vg_slice *slice,
                      struct vg_error *err);

/** Gathers the drawings of all ranks on rank 0. Collective. */
vg_status vg_cuts_gather(struct vg_cuts *c, struct vg_comm *comm,
                         struct vg_error *err);

/** Number of samples of cut i that show cells of subdomains, not of separators
 * or layers. On rank 0, once gathered. */
size_t vg_cuts_in_parts(const struct vg_cuts *c, size_t i);

/** The picture of cut i; transparent where there is no cell. VG_ERR_MEMORY. */
vg_status vg_cuts_image(const struct vg_cuts *c, size_t i,
                        enum vg_cut_colours colours, struct vg_image *out,
                        struct vg_error *err);

#endif
