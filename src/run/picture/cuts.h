/* run/picture/cuts.h: pictures of planes through a mesh that no process holds
 * as a whole. Uses core/mesh/slices.h, run/picture/image.h.
 *
 * Every rank draws the cells that it has at hand into samples of its own; a
 * sample belongs to the cell that its middle lies in. What several draw into
 * one sample (on a common edge) is settled by the larger code, so pictures are
 * the same for any order of cells, threads and ranks. Memory follows from the
 * samples that are touched, not from cells. */
#ifndef VG_RUN_PICTURE_CUTS_H
#define VG_RUN_PICTURE_CUTS_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "run/picture/image.h"

enum { VG_CUTS_MAX = 12, VG_CUT_WIDTH = 864, VG_CUT_HEIGHT = 576 }; /* V2 */

/** A plane and a window in it. */
struct vg_cut {
  int axis;         /* normal: 0 x, 1 y, 2 z */
  double at;        /* where on it */
  double centre[2]; /* of the window, in the other axes as they rise */
  double width;     /* of the window, length; it is two thirds high */
};

/** What colours tell. */
enum vg_cut_colours {
  VG_CUT_BY_KIND, /* prisms, pyramids, tetrahedra; layers or field */
  VG_CUT_BY_PART, /* the subdomain that a cell was made in */
  VG_CUT_BY_ANGLE /* smallest dihedral angle, of the field's */
};

/** Bounds of the steps of VG_CUT_BY_ANGLE, degrees, and colours for keys. */
#define VG_CUT_ANGLES 5
extern const int vg_cut_angle[VG_CUT_ANGLES];
extern const uint8_t vg_cut_angle_colour[VG_CUT_ANGLES + 1][3];

/** Colours of VG_CUT_BY_KIND, in the order of enum vg_cut_kind. */
enum vg_cut_kind {
  VG_CUT_FIELD,
  VG_CUT_LAYER_TET,
  VG_CUT_PYRAMID,
  VG_CUT_PRISM,
  VG_CUT_KINDS
};
extern const uint8_t vg_cut_kind_colour[VG_CUT_KINDS][3];

/** Colour of cells of zones in VG_CUT_BY_PART; layers are grey. */
extern const uint8_t vg_cut_zone_colour[3];

struct vg_cuts;

/** @param n    of cuts, at most VG_CUTS_MAX
 * VG_ERR_MEMORY. */
vg_status vg_cuts_new(size_t n, const struct vg_cut *cut, struct vg_cuts **out,
                      struct vg_error *err);

/** Accepts NULL. */
void vg_cuts_free(struct vg_cuts *c);

/** Draw the cells of a slice: a vg_slice_body, for any number of threads.
 * Costs a comparison per point and plane, and the pixels of what is cut.
 * VG_ERR_MEMORY. */
vg_status vg_cuts_put(void *cuts, const struct vg_slice *slice,
                      struct vg_error *err);

/** What all ranks have drawn, on rank 0. Collective. */
vg_status vg_cuts_gather(struct vg_cuts *c, struct vg_comm *comm,
                         struct vg_error *err);

/** How many samples of cut i show cells of subdomains, not of zones or layers.
 * On rank 0, once gathered. */
size_t vg_cuts_in_parts(const struct vg_cuts *c, size_t i);

/** The picture of cut i; clear where no cell is. VG_ERR_MEMORY. */
vg_status vg_cuts_image(const struct vg_cuts *c, size_t i,
                        enum vg_cut_colours colours, struct vg_image *out,
                        struct vg_error *err);

#endif
